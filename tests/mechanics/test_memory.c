/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Memory: every allocation may fail, and once warm an update takes none. */
#include "mechanics/mech.h"
#include "mechanics/motion.h"
#include "support/mt_alloc.h"

static const struct {
    const char *file;
    const char *configuration;
    const char *inputs;
} CASES[] = {
    {"ring", NULL, "k m"},
    {"pendulum", "twice", "m L"},
    {"four_bar", "trimmed", "a k"},
    {"driven_rod", "locked", "angle L"},
    {"massless", "sprung", "k1"},
    {"space_stick", "geared", "tilt ratio"},
    {"space_frame", "loaded", "h x"},
    {"pendulum", "drawn_horizontal", "m"},
    {"rods", "bodies", "h m"},
    {"loads", "trimmed", "F to"},
    {"space_couplings", "loaded", "tilt r"},
};

static void memory__failing_allocations_are_errors(mt_test *t)
{
    const bool works = mt_alloc_works();
    CHECK(t, true);
    for (int i = 0; i < MT_COUNT(CASES) && works; i++) {
        mech s;
        mt_analysis_options opt = mt_analysis_options_default();
        mt_test_row(t, "%s", CASES[i].file);
        opt.gradient = true;
        if (!mech_must(t, mech_load(t, CASES[i].file), CASES[i].configuration, CASES[i].inputs,
                       &s)) {
            mech_free(&s);
            continue;
        }
        const int c = s.a->sys->configuration;
        int inputs[MECH_INPUTS];
        memcpy(inputs, s.a->sys->inputs, (size_t)s.n * sizeof *inputs);
        const long before = mt_alloc_live();
        for (long nth = 0;; nth++) {
            mt_analysis *a = NULL;
            mt_alloc_fail_after(nth);
            mt_status rc = mt_analysis_new(s.model, c, s.n, inputs, s.at, &a, &s.err);
            if (rc == MT_OK) {
                rc = mt_analysis_solve(a, s.at, &opt, &s.err);
            }
            mt_alloc_fail_after(-1);
            if (a != NULL && rc != MT_OK) { /* an analysis outlives a shortage */
                CHECK_INT(t, mt_analysis_solve(a, s.at, &opt, &s.err), MT_OK);
            }
            mt_analysis_delete(a);
            CHECK_INT(t, mt_alloc_live(), before);
            if (rc == MT_OK) {
                break;
            }
            CHECK(t, rc == MT_E_MEMORY);
        }
        mech_free(&s);
    }
}

static void memory__warm_updates_take_none(mt_test *t)
{
    CHECK(t, true);
    for (int i = 0; i < MT_COUNT(CASES) && mt_alloc_works(); i++) {
        mech s;
        double slopes[MECH_INPUTS];
        mt_analysis_options opt = mt_analysis_options_default();
        mt_test_row(t, "%s", CASES[i].file);
        opt.gradient = true;
        if (mech_must(t, mech_load(t, CASES[i].file), CASES[i].configuration, CASES[i].inputs,
                      &s)) {
            double x[MECH_INPUTS];
            memcpy(x, s.at, sizeof x);
            long warm = 0;
            for (int round = 0; round < 8; round++) {
                warm = round == 3 ? mt_alloc_count() : warm;
                x[0] = s.at[0] * (1.0 + 1e-3 * (round % 4));
                CHECK(t, mt_analysis_solve(s.a, x, &opt, &s.err) == MT_OK);
                CHECK(t, mt_analysis_dlambda(s.a, 0, slopes, NULL, &s.err) == MT_OK);
            }
            CHECK_INT(t, mt_alloc_count(), warm);
        }
        mech_free(&s);
    }
}

MT_TEST_MAIN(MT_TEST(memory__failing_allocations_are_errors),
             MT_TEST(memory__warm_updates_take_none))
