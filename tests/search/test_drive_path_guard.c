/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * When two positions of a drive are too far from each other to know what is between, of numbers
 * alone: a clearance c = ln f over what it is compared with, and its slope, which are the
 * guards' own. Apart: c moves, as it turned out or by either slope, by more than a fourth of
 * the nearer clearance (of 0.02 at least). Astray: the middle one is off the cubic through both
 * neighbours by more than 2 % of itself (0.002 at least).
 */
#include <math.h>

#include "mechanics/system.h"
#include "search/drive_path.h"
#include "support/mt_test.h"

static const mt_system NOTHING; /* no body and no spring that could turn */
static const mt_guards ONE = {.n = 1, .sys = &NOTHING};

typedef struct sample {
    double avoidance;
    double rate;
} sample;

static mt_guard_sample of(sample *s)
{
    return (mt_guard_sample){.avoidance = &s->avoidance, .rate = &s->rate};
}

static void guards__apart_by_what_moves_most(mt_test *t)
{
    static const double none = (double)NAN;
    static const double far = (double)INFINITY;
    static const struct {
        const char *name;
        sample a;
        sample b;
        double h;
        bool apart;
    } rows[] = {
        {"nothing moves", {0.4, 0.0}, {0.4, 0.0}, 1.0, false},
        {"by less than a fourth", {0.4, 0.0}, {0.495, 0.0}, 1.0, false},
        {"by more than a fourth", {0.4, 0.0}, {0.505, 0.0}, 1.0, true},
        {"by a fourth of the farther", {0.52, 0.0}, {0.4, 0.0}, 1.0, true},
        {"away, on the other side", {-0.4, 0.0}, {-0.505, 0.0}, 1.0, true},
        {"through 0", {0.004, 0.0}, {-0.0005, 0.0}, 1.0, false},
        {"through 0, farther", {0.004, 0.0}, {-0.0015, 0.0}, 1.0, true},
        {"next to 0, by less", {0.01, 0.0}, {0.0145, 0.0}, 1.0, false},
        {"next to 0, by more", {0.01, 0.0}, {0.0155, 0.0}, 1.0, true},
        {"the first slope", {0.4, 0.22}, {0.4, 0.0}, 0.5, true},
        {"the first slope, less", {0.4, 0.18}, {0.4, 0.0}, 0.5, false},
        {"the first slope, downwards", {0.4, -0.22}, {0.4, 0.0}, 0.5, true},
        {"the second slope", {0.4, 0.0}, {0.4, 0.22}, 0.5, true},
        {"the second slope, less", {0.4, 0.0}, {0.4, 0.18}, 0.5, false},
        {"the second slope, downwards", {0.4, 0.0}, {0.4, -0.22}, 0.5, true},
        {"a large slope, then none known", {0.4, 5.0}, {0.4, none}, 0.5, true},
        {"none known, then a large slope", {0.4, none}, {0.4, 5.0}, 0.5, true},
        {"no slope known", {0.4, none}, {0.4, none}, 0.5, false},
        {"no slope known, moved", {0.4, none}, {0.6, none}, 0.5, true},
        {"small slopes after a large move", {0.4, 0.01}, {0.6, 0.01}, 0.5, true},
        {"no such mode", {far, 0.0}, {0.4, 5.0}, 0.5, false},
        {"no such mode any more", {0.4, 5.0}, {far, 0.0}, 0.5, false},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        sample a = rows[i].a;
        sample b = rows[i].b;
        const mt_guard_sample first = of(&a);
        const mt_guard_sample second = of(&b);
        mt_test_row(t, "%s", rows[i].name);
        CHECK_INT(t, mt_guards_keep_distance(&ONE, &first, &second, rows[i].h), rows[i].apart);
        /* the same from the other side */
        CHECK_INT(t, mt_guards_keep_distance(&ONE, &second, &first, rows[i].h), rows[i].apart);
    }
}

/* c = k0 + k1 s + k2 s^2 + k3 s^3 */
static sample cubic(const double *k, double s)
{
    return (sample){k[0] + (s * (k[1] + (s * (k[2] + (s * k[3]))))),
                    k[1] + (s * ((2.0 * k[2]) + (3.0 * s * k[3])))};
}

static void guards__astray_by_what_a_cubic_is_not(mt_test *t)
{
    static const double cubics[][4] = {{0.5, 0.0, 0.0, 0.0},
                                       {0.5, 0.1, 0.0, 0.0},
                                       {0.5, -0.1, 0.3, 0.0},
                                       {-0.8, 0.2, -0.1, 0.7},
                                       {0.05, 0.0, 0.01, -0.01}};
    static const double places[][3] = {
        {0.0, 0.5, 1.0}, {0.0, 0.25, 1.0}, {-1.0, 0.3, 0.4}, {2.0, 2.2, 2.3}};
    for (int i = 0; i < MT_COUNT(cubics) * MT_COUNT(places); i++) {
        const double *const at = places[i % MT_COUNT(places)];
        const double *const k = cubics[i / MT_COUNT(places)];
        sample a = cubic(k, at[0]);
        const sample exact = cubic(k, at[1]);
        sample b = cubic(k, at[2]);
        const double open = fmax(0.02 * fabs(exact.avoidance), 0.002);
        for (int side = -1; side <= 1; side += 2) {
            for (int off = 0; off < 3; off++) {
                /* of what is open, which is 2 % of what it comes to itself */
                static const double parts[] = {0.0, 0.95, 1.1};
                sample m = {exact.avoidance + (side * parts[off] * open), exact.rate};
                const mt_guard_sample first = of(&a);
                const mt_guard_sample middle = of(&m);
                const mt_guard_sample last = of(&b);
                mt_test_row(t, "cubic %d, places %d, off by %g", i / MT_COUNT(places),
                            i % MT_COUNT(places), side * parts[off]);
                CHECK_INT(t,
                          mt_guards_astray(&ONE, &first, at[1] - at[0], &middle, at[2] - at[1],
                                           &last),
                          off == 2);
            }
        }
    }
}

MT_TEST_MAIN(MT_TEST(guards__apart_by_what_moves_most),
             MT_TEST(guards__astray_by_what_a_cubic_is_not))
