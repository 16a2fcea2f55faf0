/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Long loaded mechanisms: what their equilibria cost, counted, and what comes out. */
#include "analysis/analysis.h"
#include "mechanics/linear.h"
#include "mechanics/mech.h"
#include "mt_writer.h"
#include "support/mt_alloc.h"

enum { LINKS = 60, TEXT = 65536 };

static const double G_M_PER_S2 = 9.81;
/* What sixty links may cost in a first frequency, and in its slope. */
static const double TOL = 1e-11;
/* Where the chain is drawn to end: some fifteen degrees off. */
static const double X = 0.25;
static const double Y = -0.9;
/* Of plain Newton from there. */
enum { MOST_ITERATIONS = 8 };
/* Of these, those after a short step: it tells the multipliers, and one factor does. */
enum { FOLLOWING = 2 };
/* Beside the solution, with the factor of an earlier position. */
enum { EARLIER = 1 };

/* Equal masses l apart on rods without mass, hung at the ground and drawn at a slant. */
static mt_model *hanging(mt_test *t, const char *drive)
{
    static char text[TEXT];
    const double x = X / LINKS;
    const double y = Y / LINKS;
    mt_writer w = {text, TEXT, 0};
    mt_write(&w,
             "{\"format\": \"modetune-model/1\", \"dimension\": 2,"
             "\"parameters\": {\"g\": {\"value\": %.17g}},"
             "\"gravity_m_per_s2\": [0, \"-g\"], \"bodies\": [",
             G_M_PER_S2);
    for (int i = 0; i < LINKS; i++) {
        mt_write(&w,
                 "%s{\"name\": \"b%d\", \"mass_kg\": 1, \"inertia_kg_m2\": 0,"
                 "\"centre\": [%.17g, %.17g]}",
                 i > 0 ? "," : "", i, x * (i + 1), y * (i + 1));
    }
    mt_write(&w, "], \"joints\": [");
    for (int i = 0; i < LINKS; i++) {
        char above[16] = "ground";
        (void)snprintf(above, sizeof above, i > 0 ? "b%d" : "ground", i - 1);
        mt_write(&w,
                 "%s{\"name\": \"j%d\", \"type\": \"revolute\","
                 "\"bodies\": [\"%s\", \"b%d\"], \"at\": [%.17g, %.17g]}",
                 i > 0 ? "," : "", i, above, i, x * i, y * i);
    }
    mt_write(&w, "], \"configurations\": {\"only\": {%s}}}", drive);
    return mech_parse(t, text);
}

/* omega^2 = (g/l) x with the smallest zero x of the Laguerre polynomial of order n: bisection
 * on the recursion (k + 1) L_(k+1) = (2k + 1 - x) L_k - k L_(k-1). */
static double first_zero(int n)
{
    long double low = 0.0L;
    long double high = 3.0L / n;
    for (int step = 0; step < 100; step++) {
        const long double x = 0.5L * (low + high);
        long double before = 1.0L;
        long double now = 1.0L - x;
        for (int k = 1; k < n; k++) {
            const long double next = (((2 * k + 1) - x) * now - k * before) / (k + 1);
            before = now;
            now = next;
        }
        if (now > 0.0L) {
            low = x;
        } else {
            high = x;
        }
    }
    return (double)low;
}

static void newton__a_long_chain_takes_one_or_two_factorisations_a_step_and_no_memory(
    mt_test *t)
{
    mech s;
    mt_analysis_options opt = mt_analysis_options_default();
    opt.gradient = true;
    if (mech_must(t, hanging(t, ""), NULL, "g", &s)) {
        const mt_stage *const stage = &mt_linear_position(s.a->lin)->equilibrium;
        const double length = sqrt((X * X) + (Y * Y)) / LINKS;
        double slope[1];
        for (int i = 0; i < 6; i++) {
            const long before = mt_alloc_count();
            const double at = s.at[0] * (1.0 + (0.1 * (i % 2)));
            CHECK_INT(t, mt_analysis_solve(s.a, &at, &opt, &s.err), MT_OK);
            const long after = mt_alloc_count();
            CHECK(t, i < 3 || after == before || !mt_alloc_works());
            CHECK(t, stage->solver.sparse);
            CHECK(t, stage->iterations <= MOST_ITERATIONS);
            CHECK_INT(t, stage->factors, (2 * (stage->iterations - EARLIER)) - FOLLOWING);
            const double exact = sqrt(at / length * first_zero(LINKS)) / (2.0 * MECH_PI);
            CHECK_NEAR(t, mech_hz(&s, 1), exact, TOL);
            const int first = 0;
            mt_independence why;
            CHECK_INT(
                t, mt_analysis_sensitivity(s.a, 0, 1, &first, &s.a->mem, slope, &why, &s.err),
                MT_OK);
            CHECK_NEAR(t, slope[0], exact / (2.0 * at), TOL);
        }
    }
    mech_free(&s);
}

/* A driven chain: each step of the walk, and the equilibrium at its end. */
static void newton__a_driven_chain_takes_no_memory(mt_test *t)
{
    mech s;
    mt_analysis_options opt = mt_analysis_options_default();
    if (mech_must(t,
                  hanging(t, "\"drive\": {\"joint\": \"j0\", \"position_rad\": \"0.3*g/9.81\","
                             "\"hold\": \"lock\"}"),
                  NULL, "g", &s)) {
        const mt_state *const p = mt_linear_position(s.a->lin);
        for (int i = 0; i < 6; i++) {
            const double at = s.at[0] * (1.0 + (0.1 * (i % 2)));
            const long before = mt_alloc_count();
            CHECK_INT(t, mt_analysis_solve(s.a, &at, &opt, &s.err), MT_OK);
            const long after = mt_alloc_count();
            CHECK(t, i < 3 || after == before || !mt_alloc_works());
            CHECK(t, p->equilibrium.solver.sparse);
        }
    }
    mech_free(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        MT_TEST(newton__a_long_chain_takes_one_or_two_factorisations_a_step_and_no_memory),
        MT_TEST(newton__a_driven_chain_takes_no_memory),
    };
    return cmocka_run_group_tests_name(__FILE__, tests, NULL, NULL) != 0;
}
