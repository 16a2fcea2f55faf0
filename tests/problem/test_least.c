/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The least that an objective may be over a box, which branch and bound and proofs cut by:
 * never above what 113 bits make of a design of the box, and, where the objective only rises or
 * falls, what it is at the corner.
 */
#include <float.h>

#include "expr/exact.h"
#include "problem/objective.h"
#include "problem/workspace.h"
#include "search/proof.h"
#include "study_fixture.h"
#include "support/mt_random.h"

enum { VARIABLES = 4, BOXES = 200, SAMPLES = 12 };

typedef struct range {
    double lower;
    double upper;
    double original;
} range;

/* k1, k2 logarithmic, m with a floor (its lower bound is 0), s linear (its bounds have two
 * signs); the weights differ. */
static const range ranges[VARIABLES] = {
    {0.5, 8.0, 2.0}, {0.1, 3.0, 1.0}, {0.0, 4.0, 1.0}, {-2.0, 3.0, 0.5}};

static const char *const MODEL =
    "{'format': 'modetune-model/1', 'name': 'two masses', 'dimension': 2,"
    "'parameters': {'k1': 2, 'k2': 1, 'm': 1, 's': 0.5},"
    "'bodies': [{'name': 'm1', 'mass_kg': 'm', 'centre': [1, 0]},"
    " {'name': 'm2', 'mass_kg': 'm + 0.1*k1 + 0.01*s^2', 'centre': [2, 0]}],"
    "'joints': [{'name': 'r1', 'type': 'pin-in-slot', 'bodies': ['ground', 'm1'],"
    " 'at': [1, 0], 'axis': [1, 0]}, {'name': 'r2', 'type': 'pin-in-slot',"
    " 'bodies': ['ground', 'm2'], 'at': [2, 0], 'axis': [1, 0]}],"
    "'springs': [{'name': 's1', 'type': 'axial', 'bodies': ['ground', 'm1'],"
    " 'at': [[0, 0], [1, 0]], 'stiffness_n_per_m': 'k1'},"
    "{'name': 's2', 'type': 'axial', 'bodies': ['m1', 'm2'], 'at': [[1, 0], [2, 0]],"
    " 'stiffness_n_per_m': 'k2'}]}";
#define STUDY(objective)                                            \
    "'variables': [{'parameter': 'k1', 'lower': 0.5, 'upper': 8}, " \
    "{'parameter': 'k2', 'lower': 0.1, 'upper': 3, 'weight': 2}, "  \
    "{'parameter': 'm', 'lower': 0, 'upper': 4, 'weight': 0.5}, "   \
    "{'parameter': 's', 'lower': -2, 'upper': 3, 'weight': 3}], "   \
    "'objective': {'minimise': '" objective "'}, "                  \
    "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': 0.01}]"

typedef struct rig {
    study_case c;
    mt_arena mem;
    mt_problem *p;
    mt_workspace *w;
    mt_proof_cap cap;
} rig;

static bool begin(mt_test *t, const char *study, rig *g)
{
    *g = (rig){.p = NULL};
    return study_load(t, MODEL, study, &g->c) &&
           CHECK_INT(t, mt_arena_init(&g->mem, 0, NULL), MT_OK) &&
           CHECK_INT(t, mt_problem_new(g->c.study, NULL, &g->p, &g->c.err), MT_OK) &&
           CHECK_INT(t, mt_workspace_new(g->p, &g->w, &g->c.err), MT_OK) &&
           CHECK_INT(t, mt_proof_cap_init(&g->cap, g->p, &g->mem, &g->c.err), MT_OK) &&
           CHECK(t, g->cap.known);
}

static void end(rig *g)
{
    mt_workspace_delete(g->w);
    mt_problem_delete(g->p);
    mt_arena_free(&g->mem);
    study_free(&g->c);
}

static double least_of(const rig *g, const double *lo, const double *hi)
{
    return g->cap.cap.least(g->cap.cap.context, lo, hi) * g->p->stages[0].size;
}

/* The coordinate in which changes count. */
static quad coordinate(const mt_problem *p, int i, double x)
{
    const quad floor = (quad)p->floor[i];
    return MT_HAS(p->scale[i]) ? (quad)x / (quad)p->scale[i]
           : (quad)x < floor   ? exact_log(floor) + (((quad)x - floor) / floor)
                               : exact_log((quad)x);
}

static quad exact_change(const mt_problem *p, const double *x)
{
    static const double weights[VARIABLES] = {1.0, 2.0, 0.5, 3.0};
    quad f = 0;
    for (int i = 0; i < VARIABLES; i++) {
        const quad d = coordinate(p, i, x[i]) - coordinate(p, i, ranges[i].original);
        f += (quad)weights[i] * d * d / 2;
    }
    return f;
}

/* Both bodies. The model's 0.1 and 0.01 are these doubles. */
static quad exact_mass(const mt_problem *p, const double *x)
{
    (void)p;
    return (2 * (quad)x[2]) + ((quad)0.1 * (quad)x[0]) + ((quad)0.01 * (quad)x[3] * (quad)x[3]);
}

static quad exact_sum(const mt_problem *p, const double *x)
{
    (void)p;
    return ((quad)x[0] / (quad)x[1]) - (quad)x[2] + (2 * (quad)x[3]);
}

static quad exact_waves(const mt_problem *p, const double *x)
{
    (void)p;
    return ((quad)x[1] * exact_sin(2 * (quad)x[0])) + quad_abs((quad)x[3]) -
           exact_cos((quad)x[2]);
}

/* Used twice: its interval alone is wide. */
static quad exact_twice(const mt_problem *p, const double *x)
{
    (void)p;
    return (quad)x[0] * (3 - (quad)x[0]) + ((quad)x[3] * (quad)x[3] * (quad)x[3]);
}

typedef quad exact(const mt_problem *p, const double *x);

static const struct {
    const char *name;
    const char *study;
    exact *f;
    /* where each variable makes f least: -1 at its low end, 1 at its high end, 0 next to its
     * original value; NULL: not at a corner */
    const int *corner;
} rows[] = {
    {"change", STUDY("change"), exact_change, (const int[]){0, 0, 0, 0}},
    {"mass", STUDY("mass"), exact_mass, NULL},
    {"k1/k2 - m + 2*s", STUDY("k1/k2 - m + 2*s"), exact_sum, (const int[]){-1, 1, 1, -1}},
    {"waves", STUDY("k2*sin(2*k1) + abs(s) - cos(m)"), exact_waves, NULL},
    {"twice", STUDY("k1*(3 - k1) + s^3"), exact_twice, NULL},
};

/* Narrow and wide boxes, now and then one design, now and then with the original value inside
 * or on an end. */
static void any_box(mt_random *r, double *lo, double *hi)
{
    static const double widths[] = {0.0, 1e-9, 1e-3, 0.1, 1.0};
    for (int i = 0; i < VARIABLES; i++) {
        const range *const at = &ranges[i];
        const double width =
            (at->upper - at->lower) * widths[mt_random_int(r, MT_COUNT(widths))];
        lo[i] = mt_random_in(r, at->lower, at->upper - width);
        hi[i] = fmin(lo[i] + width, at->upper);
        const int where = mt_random_int(r, 8);
        if (where == 0 && lo[i] <= at->original) {
            hi[i] = at->original;
        } else if (where == 1 && hi[i] >= at->original) {
            lo[i] = at->original;
        } else if (where == 2) { /* next to it, where differences lose digits */
            lo[i] = at->original * (1.0 + pow(10.0, mt_random_in(r, -15.0, -2.0)));
            hi[i] = fmin(lo[i] + width, at->upper);
        }
    }
}

static void least_corner(const int *corner, const double *lo, const double *hi, double *x)
{
    for (int i = 0; i < VARIABLES; i++) {
        x[i] = corner[i] < 0   ? lo[i]
               : corner[i] > 0 ? hi[i]
                               : fmin(fmax(ranges[i].original, lo[i]), hi[i]);
    }
}

static void least__is_below_every_design_of_a_box(mt_test *t)
{
    for (int row = 0; row < MT_COUNT(rows); row++) {
        mt_random r = mt_random_seed(300 + (uint64_t)row);
        rig g;
        const bool ok = begin(t, rows[row].study, &g);
        for (int k = 0; ok && k < BOXES; k++) {
            double lo[VARIABLES];
            double hi[VARIABLES];
            double x[VARIABLES];
            any_box(&r, lo, hi);
            const double least = least_of(&g, lo, hi);
            mt_test_row(t, "%s, box %d", rows[row].name, k);
            for (int s = 0; s < SAMPLES; s++) {
                mt_random_in_box(&r, 2, VARIABLES, lo, hi, x);
                CHECK(t, (quad)least <= rows[row].f(g.p, x));
            }
            if (rows[row].corner != NULL) {
                least_corner(rows[row].corner, lo, hi, x);
                const quad want = rows[row].f(g.p, x);
                CHECK(t, (quad)least <= want);
                /* roundings of some terms of the order of 10 */
                CHECK_NEAR_ABS(t, least, (double)want,
                               2.0 * MT_OBJECTIVE_ULPS * VARIABLES * DBL_EPSILON *
                                   (10.0 + fabs((double)want)));
            }
        }
        end(&g);
    }
}

/* Of one design the least is its value, so that a cap at the value of the best one cuts off
 * what equals it, and one next above does not. */
static void least__of_one_design_is_its_value(mt_test *t)
{
    static const double x[VARIABLES] = {3.0, 0.7, 1.3, -0.4};
    for (int row = 0; row < MT_COUNT(rows); row++) {
        rig g;
        mt_test_row(t, "%s", rows[row].name);
        if (begin(t, rows[row].study, &g)) {
            const double least = least_of(&g, x, x);
            const double want = (double)rows[row].f(g.p, x);
            CHECK(t, least <= want + (1e-15 * fabs(want)));
            CHECK_NEAR(t, least, want, 1e-12);
        }
        end(&g);
    }
}

MT_TEST_MAIN(MT_TEST(least__is_below_every_design_of_a_box),
             MT_TEST(least__of_one_design_is_its_value))
