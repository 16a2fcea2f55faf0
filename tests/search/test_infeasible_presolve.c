/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What is told to be hopeless with little work is so: windows of frequencies and bands drawn at
 * random about the row of six masses, of which no sample may have a design where that is said,
 * and a requirement left out is none that counts.
 */
#include "mt_writer.h"
#include "nlp/merit.h"
#include "nlp/nlp.h"
#include "problem/evaluate.h"
#include "search/mode_placements.h"
#include "search/proof.h"
#include "study_fixture.h"
#include "support/mt_random.h"

enum { ROWS = 60, SAMPLES = 400, BANDS_MOST = 8, LIMITS = 3 };

#define SPRINGS                                                                            \
    "'variables': [{'parameter': 'x1', 'lower': -0.7, 'upper': 0.7}, {'parameter': 'x2', " \
    "'lower': -0.7, 'upper': 0.7}, {'parameter': 'x3', 'lower': -0.7, 'upper': 0.7}],"     \
    "'objective': {'minimise': 'change'},"

static const double MODES_HZ[] = {4.3, 8.6, 17.2, 34.4};

/* A window about a mode, near or far; every other row has a band to avoid. */
static void draw(mt_random *r, int row, mt_writer *w)
{
    mt_write(w, "%s'goals': [", SPRINGS);
    for (int i = 0; i < LIMITS; i++) {
        const int mode = mt_random_int(r, MT_COUNT(MODES_HZ));
        const double at = MODES_HZ[mode] * mt_random_in(r, 0.55, 1.8);
        const double wide = mt_random_in(r, 1.05, 1.6);
        mt_write(w,
                 "%s{'type': 'frequency', 'mode': %d, 'at_least_hz': %.6g, "
                 "'at_most_hz': %.6g}",
                 i == 0 ? "" : ", ", mode + 1, at / wide, at * wide);
    }
    if (row % 2 == 1) {
        const double at = MODES_HZ[1] * mt_random_in(r, 0.8, 1.2);
        mt_write(w, ", {'type': 'avoid', 'bands_hz': [[%.6g, %.6g]]}", at,
                 at * mt_random_in(r, 1.02, 1.5));
    }
    mt_write(w, "]");
}

/* Is the design at t[n] one that meets limits and bands? */
static bool is_design(mt_test *t, mt_workspace *w, const double *at, mt_nlp_values *v)
{
    int below[BANDS_MOST];
    double violation = 0.0;
    CHECK_INT(t, mt_workspace_eval(w, at, false, v, NULL), MT_OK);
    const mt_missed missed = mt_subproblem_missed(w->c, v);
    CHECK_INT(t, mt_mode_placement_assignment(w, at, below, &violation, NULL), MT_OK);
    return mt_is_met(missed.violation, 1.0) && violation == 0.0;
}

static int designs(mt_test *t, mt_workspace *w, mt_arena *mem)
{
    mt_nlp nlp = mt_workspace_nlp(w);
    mt_nlp_values v;
    int count = 0;
    nlp.n = w->p->n;
    const double *const x = mt_nlp_starts(&nlp, 3, SAMPLES, mem);
    CHECK_INT(t, mt_subproblem_values_init(w->c, mem, &v, NULL), MT_OK);
    for (int k = 0; k < SAMPLES; k++) {
        count += is_design(t, w, x + ((ptrdiff_t)k * w->p->n), &v) ? 1 : 0;
    }
    return count;
}

typedef struct tally {
    int presolve;
    int possible; /* a sample is a design */
    int without;  /* hopeless, but not without one requirement */
} tally;

static void judge(mt_test *t, const mt_problem *p, mt_workspace *w, mt_arena *mem, tally *n)
{
    mt_infeasible_presolve_question q = {.c = &p->whole, .but = -1, .bands = true};
    bool all = false;
    CHECK_INT(t, mt_infeasible_presolve(&q, mem, &all, NULL), MT_OK);
    const int found = designs(t, w, mem);
    CHECK(t, !(all && found > 0));
    n->presolve += all ? 1 : 0;
    n->possible += found > 0 ? 1 : 0;
    bool any = false;
    for (q.but = 0; q.but < p->n_requirements; q.but++) {
        bool rest = false;
        CHECK_INT(t, mt_infeasible_presolve(&q, mem, &rest, NULL), MT_OK);
        CHECK(t, !(rest && found > 0)); /* it is proven without this requirement already */
        any = any || (all && !rest);
    }
    n->without += any ? 1 : 0;
    mt_subproblem none = p->whole;
    none.proof_work = 0.0;
    q = (mt_infeasible_presolve_question){.c = &none, .but = -1, .bands = true};
    CHECK_INT(t, mt_infeasible_presolve(&q, mem, &all, NULL), MT_OK);
    CHECK(t, !all); /* nothing is proven where no proof is asked for */
}

static void hopeless__no_sample_is_a_design(mt_test *t)
{
    mt_random r = mt_random_seed(11);
    tally n = {0};
    for (int row = 0; row < ROWS; row++) {
        char members[1024];
        study_case c;
        mt_arena mem;
        mt_problem *p = NULL;
        mt_workspace *w = NULL;
        mt_writer text = {members, sizeof members, 0};
        draw(&r, row, &text);
        mt_test_row(t, "%s", members);
        CHECK_INT(t, mt_arena_init(&mem, 0, NULL), MT_OK);
        if (study_load(t, "six_masses", members, &c) &&
            CHECK_INT(t, mt_problem_new(c.study, NULL, &p, &c.err), MT_OK) &&
            CHECK_INT(t, mt_workspace_new(p, &w, &c.err), MT_OK)) {
            judge(t, p, w, &mem, &n);
        }
        mt_workspace_delete(w);
        mt_problem_delete(p);
        mt_arena_free(&mem);
        study_free(&c);
    }
    CHECK(t, n.presolve > ROWS / 6 && n.possible > ROWS / 6 && n.without > 0);
}

/* One mode at sqrt(k)/(2 pi), and a tolerance of 5 %: what lies beyond an edge by 2 or 3 % is a
 * design, by 8 or 9 % none, which is proven. */
static void hopeless__tolerances_of_goals_are_granted(mt_test *t)
{
    static const struct {
        const char *name;
        const char *goal;
        double from_hz;
        bool possible;
    } rows[] = {
        {"lower edge", "'avoid', 'bands_hz': [[10, 20]]", 10.2, true},
        {"upper edge", "'avoid', 'bands_hz': [[10, 20]]", 19.4, true},
        {"beyond the lower edge", "'avoid', 'bands_hz': [[10, 20]]", 10.8, false},
        {"beyond the upper edge", "'avoid', 'bands_hz': [[10, 20]]", 18.2, false},
        {"at most", "'frequency', 'mode': 1, 'at_most_hz': 10", 10.2, true},
        {"beyond at most", "'frequency', 'mode': 1, 'at_most_hz': 10", 10.8, false},
        {"at least", "'frequency', 'mode': 1, 'at_least_hz': 20", 19.4, true},
        {"beyond at least", "'frequency', 'mode': 1, 'at_least_hz': 20", 18.2, false},
    };
    static const double WIDE = 1.01; /* of the range of frequencies */
    for (int i = 0; i < MT_COUNT(rows); i++) {
        const double lower = pow(2.0 * STUDY_PI * rows[i].from_hz, 2.0);
        char members[400];
        study_case c;
        (void)snprintf(members, sizeof members,
                       "'variables': [{'parameter': 'k', 'lower': %.17g, 'upper': %.17g}],"
                       "'goals': [{'type': %s, 'tolerance_percent': 5}]",
                       lower, lower * WIDE * WIDE, rows[i].goal);
        mt_test_row(t, "%s", rows[i].name);
        if (study_solve(t,
                        "{'format': 'modetune-model/1', 'dimension': 2, 'parameters': {'k': "
                        "4000}, 'bodies': [{'name': 'm', 'mass_kg': 1, 'inertia_kg_m2': 1, "
                        "'centre': [1, 0]}], 'joints': [{'name': 'j', 'type': 'prismatic', "
                        "'bodies': ['ground', 'm'], 'at': [1, 0], 'axis': [1, 0]}], 'springs': "
                        "[{'name': 's', 'type': 'axial', 'joint': 'j', 'stiffness_n_per_m': "
                        "'k'}]}",
                        members, &c)) {
            CHECK_INT(t, c.result->status,
                      rows[i].possible ? MT_RESULT_SOLVED : MT_RESULT_INFEASIBLE);
            bool none = false;
            for (int k = 0; k < c.result->n_certificates; k++) {
                const mt_certificate *const told = &c.result->certificates[k];
                none = none || (told->proven && strncmp(told->text, "No design", 9) == 0);
            }
            CHECK(t, !(none && rows[i].possible));
        }
        study_free(&c);
    }
}

MT_TEST_MAIN(MT_TEST(hopeless__no_sample_is_a_design),
             MT_TEST(hopeless__tolerances_of_goals_are_granted))
