/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A few lowest modes against those of all by the factor, with their bounds: random chains of
 * many elements, soft and stiff hinges beside each other, hanging, standing or unloaded,
 * pinned or free, where matrices alone leave less than is promised. Frequencies to the bounds
 * of both, slopes to what errors of the shapes make of their terms.
 */
#include <stdlib.h>

#include "linalg/dense.h"
#include "mechanics/mech.h"
#include "support/mt_random.h"

enum { LEAST = 33, MOST = 90, TRIALS = 27, TRIALS_ALL = 80, TEXT = 8192, MODES = 8 };

/* What is promised of a frequency's square. */
static const double FINE = 1e-9;
/* Shapes, where quotients of energies reach that by their square. */
static const double SHAPES = 1e-4;

typedef struct chain {
    char text[TEXT];
    int n;
    bool pinned;
} chain;

/* A link of n elements that stands or hangs, with a spring at its end. */
static void make(mt_random *g, chain *c)
{
    const double height = mt_random_in(g, 0.5, 2.0) * (mt_random_int(g, 2) == 0 ? 1.0 : -1.0);
    const double spread = mt_random_in(g, 0.0, 2.0);
    const double gravity = mt_random_int(g, 2) == 0 ? 0.0 : -9.81;
    c->n = LEAST + mt_random_int(g, MOST - LEAST);
    c->pinned = mt_random_int(g, 2) == 0;
    size_t used = (size_t)snprintf(
        c->text, sizeof c->text,
        "{\"format\": \"modetune-model/1\", \"name\": \"chain\", \"dimension\": 2,"
        "\"gravity_m_per_s2\": [0, %g], \"parameters\": {\"m\": {\"value\": %g,"
        "\"unit\": \"kg\"}, \"k\": {\"value\": %g, \"unit\": \"N m/rad\"},"
        "\"ground\": {\"value\": %g, \"unit\": \"N/m\"}},"
        "\"points\": {\"root\": [0, 0], \"tip\": [0, %g]},"
        "\"joints\": [{\"name\": \"pin\", \"type\": \"revolute\", \"in\": [\"pinned\"],"
        "\"bodies\": [\"ground\", \"L.start\"], \"at\": \"root\"}],"
        "\"springs\": [{\"name\": \"side\", \"type\": \"axial\", \"bodies\": [\"ground\","
        "\"L.end\"], \"at\": [[1, %g], \"tip\"], \"stiffness_n_per_m\": \"ground\"}],"
        "\"configurations\": {\"pinned\": {}, \"free\": {\"gravity_m_per_s2\": [0, 0]}},"
        "\"links\": [{\"name\": \"L\", \"from\": \"root\", \"to\": \"tip\", \"elements\": %d,"
        "\"mass_kg\": \"m\", \"stiffness_n_m_per_rad\": [",
        gravity, mt_random_in(g, 0.5, 2.0), pow(10.0, mt_random_in(g, 1.0, 4.0)),
        pow(10.0, mt_random_in(g, 2.0, 4.0)), height, height, c->n);
    for (int i = 1; i < c->n; i++) {
        used += (size_t)snprintf(c->text + used, sizeof c->text - used, "%s\"k*%.4g\"",
                                 i > 1 ? ", " : "",
                                 c->n * pow(10.0, spread * mt_random_in(g, -1.0, 1.0)));
    }
    (void)snprintf(c->text + used, sizeof c->text - used, "]}]}");
}

/* Slopes of the mode at pos of both; its shapes may differ by `share` of themselves. */
static void compare_slopes(mt_test *t, mech *few, mech *all, int pos, double share)
{
    const int n = all->a->modes.n;
    double got[MECH_INPUTS];
    double want[MECH_INPUTS];
    CHECK_INT(t, mt_analysis_dlambda_raw(few->a, pos, got, NULL), MT_OK);
    CHECK_INT(t, mt_analysis_dlambda_raw(all->a, pos, want, NULL), MT_OK);
    CHECK_INT(t, mt_analysis_products(all->a, pos, NULL), MT_OK);
    const double size = mt_norm2(n, mt_modal_shape(&all->a->modes, pos));
    for (int i = 0; i < all->n; i++) {
        const double terms =
            mt_norm2(n, all->a->dky + ((ptrdiff_t)i * n)) +
            (all->a->modes.lambda[pos] * mt_norm2(n, all->a->dmy + ((ptrdiff_t)i * n)));
        CHECK_NEAR_ABS(t, got[i], want[i], share * size * terms);
    }
}

/* *judged: how often the factor was not needed although all by themselves need it. */
static void compare(mt_test *t, mech *few, mech *all, bool gradient, long *judged)
{
    const mt_modes *const part = &few->a->modes;
    const mt_modes *const whole = &all->a->modes;
    CHECK_INT(t, part->count, whole->count);
    CHECK_INT(t, part->n_rigid, whole->n_rigid);
    CHECK_INT(t, part->n_unstable, whole->n_unstable);
    CHECK_INT(t, part->n_undecided, whole->n_undecided);
    *judged += whole->from_factor && !part->from_factor ? 1 : 0;
    for (int k = 1; k <= MODES && mt_modal_indexed(whole); k++) {
        const int pos = mt_modal_flexible(whole, k);
        if (!CHECK_INT(t, mt_modal_flexible(part, k), pos) || pos < 0) {
            break;
        }
        int size = 1;
        (void)mt_modal_cluster(whole, pos, &size);
        CHECK_NEAR_ABS(t, part->lambda[pos], whole->lambda[pos],
                       part->error[pos] + whole->error[pos]);
        CHECK(t, part->from_factor || part->error[pos] < FINE * part->lambda[pos]);
        if (gradient && size == 1) {
            compare_slopes(t, few, all, pos, SHAPES);
        }
    }
}

static void few__are_the_modes_that_all_have(mt_test *t)
{
    mt_random g = mt_random_seed(77);
    static chain c;
    long judged = 0;
    const int trials = getenv("MT_EVERY") != NULL ? TRIALS_ALL : TRIALS;
    for (int trial = 0; trial < trials; trial++) {
        mech all = {.model = NULL};
        mech few = {.model = NULL};
        make(&g, &c);
        const char *const name = c.pinned ? "pinned" : "free";
        mt_test_row(t, "trial %d, %d elements, %s", trial, c.n, name);
        if (mech_open(t, mech_parse(t, c.text), name, "m k ground", &all) &&
            mech_open(t, mech_parse(t, c.text), name, "m k ground", &few)) {
            mt_analysis_options opt = mt_analysis_options_default();
            double x[MECH_INPUTS];
            for (int i = 0; i < all.n; i++) {
                x[i] = all.at[i] * mt_random_in(&g, 0.8, 1.25);
            }
            opt.gradient = true;
            const mt_status rc = mt_analysis_solve(all.a, x, &opt, NULL);
            opt.bounds = false;
            opt.check = false;
            opt.gradient = mt_random_int(&g, 2) == 0;
            opt.vectors = mt_random_int(&g, 2) == 0;
            opt.shapes.first = MODES;
            if (CHECK_INT(t, mt_analysis_solve(few.a, x, &opt, NULL), rc) && rc == MT_OK) {
                compare(t, &few, &all, opt.gradient, &judged);
            }
        }
        mech_free(&all);
        mech_free(&few);
    }
    CHECK(t, judged > trials / 4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {MT_TEST(few__are_the_modes_that_all_have)};
    return cmocka_run_group_tests_name(__FILE__, tests, NULL, NULL);
}
