/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Springs that are 0 in the original, or within the bounds: one count of vibration modes for
 * all designs of a study. Two masses in a row,
 *     m x1'' = -k1 x1 + k2 (x2 - x1),   m x2'' = -k2 (x2 - x1),
 * have lambda as an eigenvalue where (k1 + k2 - lambda m)(k2 - lambda m) = k2^2, hence
 *     k1 = k2^2 / (k2 - lambda m) - k2 + lambda m,
 * and at k1 = 0 lambda = 0, 2 k2 / m.
 */
#include "describe/describe.h"
#include "prove/box.h"
#include "prove/enclosure.h"
#include "study_fixture.h"

static const double K2 = 1000.0;
static const double UPPER = 400.0;
#define ADDED     STUDY_TWO_MASSES("'m': 1, 'k1': 0, 'k2': 1000", "")
#define K1_TO_400 "'variables': [{'parameter': 'k1', 'lower': 0, 'upper': 400}], "

/* The added spring that brings the lower mode to hz. */
static double spring_for(double hz)
{
    const double lambda = 4.0 * STUDY_PI * STUDY_PI * hz * hz;
    return (K2 * K2 / (K2 - lambda)) - K2 + lambda;
}

static double lower_hz(double k1)
{
    return study_hz(study_two_lambda(k1, K2, 1.0, -1));
}

static void rank__an_added_spring_is_sized_from_zero(mt_test *t)
{
    static const struct {
        const char *name;
        const char *goal;
        double hz; /* that mode 1 comes to */
    } rows[] = {
        {"target", "{'type': 'frequency', 'mode': 1, 'target_hz': 1.5}", 1.5},
        {"at least", "{'type': 'frequency', 'mode': 1, 'at_least_hz': 1.25}", 1.25},
        {"low target", "{'type': 'frequency', 'mode': 1, 'target_hz': 0.001}", 0.001},
        {"from 0 Hz", "{'type': 'avoid', 'bands_hz': [[0, 1.75]]}", 1.75},
        {"two demands", "{'type': 'frequency', 'mode': 1, 'at_least_hz': 1, 'at_most_hz': 2}",
         1.0},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        char members[STUDY_PATH];
        study_case c;
        mt_test_row(t, "%s", rows[i].name);
        (void)snprintf(members, sizeof members, K1_TO_400 "'goals': [%s]", rows[i].goal);
        if (study_solve(t, ADDED, members, &c)) {
            CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
            CHECK_NEAR(t, study_value(&c, 1, "k1"), spring_for(rows[i].hz), 1e-4);
            CHECK_NEAR(t, study_frequency(&c, 1, "default", 1), rows[i].hz, 1e-6);
            CHECK_NEAR(t, study_frequency(&c, 0, "default", 1), 0.0, 0.0);
            CHECK_NEAR(t, study_frequency(&c, 0, "default", 2), study_hz(2.0 * K2), 1e-9);
            CHECK(t, !c.result->baseline.feasible);
            CHECK(t, study_gives(&c.result->baseline,
                                 "mode 1 is at 0 Hz: nothing holds it at this design (the "
                                 "stiffness of \"s1\" is 0)"));
            CHECK(t, c.result->n_warnings == 0);
        }
        study_free(&c);
    }
}

static void rank__a_band_sees_the_mode_that_the_spring_brings(mt_test *t)
{
    /* mode 1 rises to 2.08 Hz at most: it cannot pass the band, and stays below with k1 small
     * enough */
    study_case c;
    if (study_solve(t, ADDED,
                    "'variables': [{'parameter': 'k1', 'lower': 50, 'upper': 400}], 'goals': "
                    "[{'type': 'avoid', 'bands_hz': [[1.2, 3]]}]",
                    &c)) {
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        CHECK_INT(t, c.result->n_recommendations, 1);
        CHECK_INT(t, c.result->recommendations[0].placements[0].modes_below, 1);
        CHECK(t, study_value(&c, 1, "k1") < spring_for(1.2) + 1e-3);
    }
    study_free(&c);
    mt_test_row(t, "no room");
    if (study_solve(t, ADDED,
                    "'variables': [{'parameter': 'k1', 'lower': 150, 'upper': 400}], 'goals': "
                    "[{'type': 'avoid', 'bands_hz': [[1.2, 3]]}]",
                    &c)) {
        CHECK(t, lower_hz(150.0) > 1.2 && lower_hz(UPPER) < 3.0);
        CHECK_INT(t, c.result->status, MT_RESULT_INFEASIBLE);
        CHECK(t, c.result->certificates[0].proven);
    }
    study_free(&c);
}

static void rank__what_a_spring_can_do_is_not_called_impossible(mt_test *t)
{
    study_case c;
    char members[STUDY_PATH];
    (void)snprintf(members, sizeof members,
                   K1_TO_400
                   "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': %.17g}]",
                   lower_hz(0.999 * UPPER));
    if (study_solve(t, ADDED, members, &c)) {
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
    }
    study_free(&c);
    mt_test_row(t, "beyond the bounds");
    (void)snprintf(members, sizeof members,
                   K1_TO_400
                   "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': %.17g}]",
                   lower_hz(1.001 * UPPER));
    if (study_solve(t, ADDED, members, &c)) {
        CHECK_INT(t, c.result->status, MT_RESULT_INFEASIBLE);
        CHECK(t, study_says(1, &c.result->certificates[0].text, "stays between 0 and"));
    }
    study_free(&c);
}

static void rank__catalogues_may_hold_no_spring(mt_test *t)
{
    static const struct {
        const char *goal;
        int solutions; /* of 0, 100, 200: 0, 1.11 and 1.55 Hz */
        double best;
    } rows[] = {
        {"{'type': 'frequency', 'mode': 1, 'at_least_hz': 1}", 2, 100.0},
        {"{'type': 'frequency', 'mode': 1, 'at_most_hz': 1}", 1, 0.0},
        {"{'type': 'avoid', 'bands_hz': [[0, 1.2]]}", 1, 200.0},
        {"{'type': 'avoid', 'bands_hz': [[1.0, 1.2]]}", 2, 0.0},
        {"{'type': 'frequency', 'mode': 1, 'at_least_hz': 2}", 0, 200.0},
        {"{'type': 'frequency', 'mode': 2, 'at_least_hz': 1}", 3, 0.0},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        char members[STUDY_PATH];
        study_case c;
        mt_test_row(t, "%s", rows[i].goal);
        (void)snprintf(
            members, sizeof members,
            "'variables': [{'parameter': 'k1', 'catalogue': [0, 100, 200]}], 'goals': [%s],"
            "'recommendations': 3",
            rows[i].goal);
        if (study_solve(t, ADDED, members, &c)) {
            CHECK_INT(t, c.result->status == MT_RESULT_SOLVED, rows[i].solutions > 0);
            CHECK(t,
                  rows[i].solutions == 0 || c.result->n_recommendations == rows[i].solutions);
            CHECK_NEAR(t, study_value(&c, 1, "k1"), rows[i].best, 0.0);
        }
        study_free(&c);
    }
}

static void rank__corners_of_tolerances_count_alike(mt_test *t)
{
    study_case c;
    if (study_solve(t, ADDED,
                    "'variables': [{'parameter': 'k1', 'lower': 0, 'upper': 400, "
                    "'tolerance_percent': 10}], 'goals': [{'type': 'frequency', 'mode': 1, "
                    "'at_least_hz': 1.5}]",
                    &c)) {
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        CHECK_NEAR(t, 0.9 * study_value(&c, 1, "k1"), spring_for(1.5), 1e-3);
    }
    study_free(&c);
}

/* Over the upper bound of the spring, and over a spring that is no variable: at every point
 * index 1 is the mode that k1 holds. */
static void rank__points_of_a_trade_study_count_alike(mt_test *t)
{
    study_case c;
    if (study_solve(t, ADDED,
                    K1_TO_400
                    "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': 1.5}], "
                    "'trade': {'vary': [{'variable': 'k1', 'bound': 'upper', "
                    "'values': [1, 100, 150, 200, 300]}]}",
                    &c)) {
        CHECK_INT(t, c.result->trade->n_points, 5);
        for (int i = 0; i < c.result->trade->n_points; i++) {
            CHECK_INT(t, c.result->trade->points[i].best.feasible, i >= 3);
        }
    }
    study_free(&c);
    mt_test_row(t, "a parameter");
    if (study_solve(t, ADDED,
                    "'variables': [{'parameter': 'k2', 'lower': 500, 'upper': 2000}], "
                    "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': 1.5}], "
                    "'trade': {'vary': [{'parameter': 'k1', 'values': [0, 100, 200]}]}",
                    &c)) {
        for (int i = 0; i < c.result->trade->n_points; i++) {
            CHECK_INT(t, c.result->trade->points[i].best.feasible, i == 2);
        }
    }
    study_free(&c);
}

/* The model names "coupled" as its mode 1, counted at its own design, where the added spring is
 * 0. */
static void rank__a_named_mode_is_the_models(mt_test *t)
{
    study_case c;
    if (study_solve(t,
                    STUDY_TWO_MASSES("'m': 1, 'k1': 0, 'k2': 1000",
                                     ", 'modes': {'coupled': {'configuration': 'default', "
                                     "'index': 1}}"),
                    K1_TO_400 "'goals': [{'type': 'frequency', 'configuration': 'default', "
                              "'mode': 'coupled', 'target_hz': 7.2}], 'published': "
                              "[{'frequency': {'configuration': 'default', 'mode': 'coupled'}, "
                              "'value': 7.2, 'tolerance': 1e-4}]",
                    &c)) {
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        CHECK_NEAR(t, study_frequency(&c, 1, "default", 2), 7.2, 1e-4);
        CHECK(t, c.result->n_published == 1 && c.result->published[0].holds);
    }
    study_free(&c);
}

/* A mass that is 0 in the original: its mode comes down from infinity. With k1 = 500, k2 =
 * 1000, m1 = 1 and lambda given, m2 lambda (K11 - lambda) = det K - k2 lambda. */
static void rank__an_added_mass_is_sized_from_zero(mt_test *t)
{
    static const char *const model =
        "{'format': 'modetune-model/1', 'name': 'two masses', 'dimension': 2, 'parameters': "
        "{'m': 1, "
        "'m2': 0, 'k1': 500, 'k2': 1000}, 'bodies': [{'name': 'm1', 'mass_kg': 'm', 'centre': "
        "[1, 0]}, {'name': 'm2', 'mass_kg': 'm2', 'centre': [2, 0]}], 'joints': ["
        "{'name': 'r1', 'type': 'pin-in-slot', 'bodies': ['ground', 'm1'], 'at': [1, 0], "
        "'axis': "
        "[1, 0]}, {'name': 'r2', 'type': 'pin-in-slot', 'bodies': ['ground', 'm2'], 'at': [2, "
        "0], 'axis': [1, 0]}], 'springs': [{'name': 's1', 'type': 'axial', 'bodies': "
        "['ground', "
        "'m1'], 'at': [[0, 0], [1, 0]], 'stiffness_n_per_m': 'k1'}, {'name': 's2', 'type': "
        "'axial', 'bodies': ['m1', 'm2'], 'at': [[1, 0], [2, 0]], 'stiffness_n_per_m': 'k2'}]}";
    static const struct {
        const char *name;
        const char *goal;
        double hz; /* of the mode that decides */
    } rows[] = {
        {"mode 1", "{'type': 'frequency', 'mode': 1, 'target_hz': 3}", 3.0},
        {"mode 2 by a target", "{'type': 'frequency', 'mode': 2, 'target_hz': 8}", 8.0},
        {"mode 2 by a limit", "{'type': 'frequency', 'mode': 2, 'at_most_hz': 8}", 8.0},
        {"mode 1 by a band", "{'type': 'avoid', 'bands_hz': [[3, 6]]}", 3.0},
        {"mode 2 is far above", "{'type': 'frequency', 'mode': 2, 'at_least_hz': 8}", 0.0},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        const double lambda = 4.0 * STUDY_PI * STUDY_PI * rows[i].hz * rows[i].hz;
        const double k1 = 500.0;
        const double want = rows[i].hz > 0.0
                                ? ((k1 * K2) - (K2 * lambda)) / (lambda * (k1 + K2 - lambda))
                                : 0.0;
        char members[STUDY_PATH];
        study_case c;
        mt_test_row(t, "%s", rows[i].name);
        (void)snprintf(
            members, sizeof members,
            "'variables': [{'parameter': 'm2', 'lower': 0, 'upper': 3}], 'goals': [%s]",
            rows[i].goal);
        if (study_solve(t, model, members, &c)) {
            CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
            CHECK_NEAR(t, study_value(&c, 1, "m2"), want, 1e-5);
            CHECK_INT(t, c.result->n_warnings, 0);
        }
        study_free(&c);
    }
}

typedef struct opened {
    study_case c;
    mt_arena mem;
    mt_problem *p;
    mt_workspace *w;
} opened;

static bool open_problem(mt_test *t, const char *model, const char *members, opened *o)
{
    mt_err err = {0};
    *o = (opened){.p = NULL};
    return study_load(t, model, members, &o->c) &&
           CHECK_INT(t, mt_arena_init(&o->mem, 0, &err), MT_OK) &&
           CHECK_INT(t, mt_problem_new(o->c.study, NULL, &o->p, &err), MT_OK) &&
           CHECK_INT(t, mt_workspace_new(o->p, &o->w, &err), MT_OK);
}

static void close_problem(opened *o)
{
    mt_workspace_delete(o->w);
    mt_problem_delete(o->p);
    mt_arena_free(&o->mem);
    study_free(&o->c);
}

/* Which designs of a box free how many directions, whatever the expressions. */
static void rank__the_count_is_the_least_of_the_box(mt_test *t)
{
    static const struct {
        const char *name;
        const char *k1; /* an expression of a, which is 0 at first and at most 10 */
        int rigid;
    } rows[] = {
        {"added", "'a'", 0},
        {"nothing to add", "'0*a'", 1},
        {"only in a corner", "'max(0, a - 9.9)'", 0},
        {"out of reach", "'max(0, a - 11)'", 1},
        {"there at the original", "'7 + a'", 0},
        {"gone at the other end", "'10 - a'", 0},
        {"sum of two", "'a*a + 3*a'", 0},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        char model[8 * STUDY_PATH];
        opened o;
        mt_test_row(t, "%s", rows[i].name);
        (void)snprintf(model, sizeof model,
                       "{'format': 'modetune-model/1', 'name': 'two masses', 'dimension': 2,"
                       "'parameters': {'a': 0, 'm': 1, 'k1': %s, 'k2': 1000},%s}",
                       rows[i].k1, STUDY_TWO_MASSES_ROW);
        if (open_problem(t, model,
                         "'variables': [{'parameter': 'a', 'lower': 0, 'upper': 10}], 'goals': "
                         "[{'type': 'frequency', 'mode': 1, 'at_least_hz': 0.1}]",
                         &o)) {
            CHECK_INT(t, o.w->views[0].analysis->n_rigid, rows[i].rigid);
        }
        close_problem(&o);
    }
}

/* A coordinate that is held by nothing but what is 0 in the original: a spring of any kind. k
 * rises to 50. */
static void rank__every_kind_of_spring_counts(mt_test *t)
{
#define PLANE \
    "{'format': 'modetune-model/1', 'name': 'kinds', 'dimension': 2, 'parameters': {'k': 0}, "
#define WHEEL                                                                           \
    "'bodies': [{'name': 'w', 'mass_kg': 1, 'inertia_kg_m2': 0.5, 'centre': [0, 0]}], " \
    "'joints': [{'name': 'p', 'type': 'revolute', 'bodies': ['ground', 'w'], 'at': [0, 0]}], "
#define BLOCK \
    "'bodies': [{'name': 'w', 'mass_kg': 2, 'inertia_kg_m2': 0.5, 'centre': [0, 0]}], "
    static const struct {
        const char *name;
        const char *model;
        int held;  /* directions that k holds */
        double hz; /* of mode 1 at k = 50 */
    } rows[] = {
        {"torsion",
         PLANE WHEEL "'springs': [{'name': 's', 'type': 'torsion', 'joint': 'p', "
                     "'stiffness_n_m_per_rad': 'k'}]}",
         1, 1.5915494309189535},
        {"bushing",
         PLANE BLOCK "'springs': [{'name': 's', 'type': 'bushing', 'bodies': "
                     "['ground', 'w'], 'at': [0, 0], 'stiffness_n_per_m': ['2*k', "
                     "'8*k'], 'stiffness_n_m_per_rad': '2*k'}]}",
         3, 1.1253953951963827},
        /* E A / l = 50 of a bar of length 1 without mass; 'k' is its area */
        {"bar",
         PLANE "'bodies': [{'name': 'w', 'mass_kg': 0.5, 'centre': [1, 0]}], 'joints': "
               "[{'name': 'r', 'type': 'pin-in-slot', 'bodies': ['ground', 'w'], 'at': "
               "[1, 0], 'axis': [1, 0]}], 'springs': [{'name': 's', 'type': 'bar', "
               "'bodies': ['ground', 'w'], 'at': [[0, 0], [1, 0]], "
               "'youngs_modulus_pa': 1, 'area_m2': 'k', 'density_kg_per_m3': 0.03}]}",
         1, 1.1253953951963827},
        {"hinge of a link",
         PLANE "'points': {'a': [0, 0], 'b': [2, 0]}, 'links': [{'name': 'l', "
               "'from': 'a', 'to': 'b', 'elements': 2, 'mass_kg': 6, "
               "'stiffness_n_m_per_rad': ['k']}], 'joints': [{'name': 'f', "
               "'type': 'fixed', 'bodies': ['ground', 'l.start'], 'at': "
               "'a'}]}",
         1, 1.1253953951963827},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        opened o;
        mt_err err = {0};
        const double most = 50.0;
        const mt_analysis_options opt = mt_analysis_options_default();
        mt_test_row(t, "%s", rows[i].name);
        if (open_problem(t, rows[i].model,
                         "'variables': [{'parameter': 'k', 'lower': 0, 'upper': 50}], 'goals': "
                         "[{'type': 'frequency', 'mode': 1, 'at_least_hz': 0.1}]",
                         &o)) {
            mt_analysis *const a = o.w->views[0].analysis;
            CHECK_INT(t, a->n_null, rows[i].held);
            CHECK_INT(t, a->n_rigid, 0);
            CHECK_INT(t, mt_analysis_solve(a, &most, &opt, &err), MT_OK);
            CHECK_NEAR(t, mt_modal_hz(&a->modes, 0), rows[i].hz, 1e-9);
        }
        close_problem(&o);
    }
}

/* Gravity loads the pendulum, so that designs are sampled: without its mass nothing brings it
 * back. */
static void rank__loaded_configurations_are_counted_over_designs(mt_test *t)
{
    opened o;
    if (open_problem(
            t,
            "{'format': 'modetune-model/1', 'name': 'pendulum', 'dimension': 2, "
            "'gravity_m_per_s2': [0, -9.81], 'parameters': {'k': 0, 'g': 0}, 'bodies': ["
            "{'name': 'a', 'mass_kg': 1, 'inertia_kg_m2': 0.1, 'centre': [0, -1]}, "
            "{'name': 'w', 'mass_kg': 1, 'inertia_kg_m2': 0.2, 'centre': [1, 0]}], 'joints': ["
            "{'name': 'p', 'type': 'revolute', 'bodies': ['ground', 'a'], 'at': [0, 0]}, "
            "{'name': 'q', 'type': 'revolute', 'bodies': ['ground', 'w'], 'at': [1, 0]}], "
            "'springs': [{'name': 's', 'type': 'torsion', 'joint': 'q', "
            "'stiffness_n_m_per_rad': 'k'}]}",
            "'variables': [{'parameter': 'k', 'lower': 0, 'upper': 50}], 'goals': [{'type': "
            "'frequency', 'mode': 1, 'at_least_hz': 0.1}]",
            &o)) {
        CHECK_INT(t, o.w->views[0].analysis->n_null, 1);
        CHECK_INT(t, o.w->views[0].analysis->n_rigid, 0);
    }
    close_problem(&o);
}

/* An analysis without a box counts as its first design does. Elsewhere it fails, or counts
 * anew, but never drops a mode; and no enclosure rests on it. */
static void rank__a_count_that_does_not_hold_is_noticed(mt_test *t)
{
    study_case c;
    mt_analysis *a = NULL;
    mt_enclosure *e = NULL;
    char reason[MT_REASON_SIZE];
    const double zero = 0.0;
    const double some = 200.0;
    const double most = UPPER;
    const mt_analysis_options opt = mt_analysis_options_default();
    if (study_load(t, ADDED, K1_TO_400 "'goals': []", &c)) {
        const int input = c.study->variables[0].parameter;
        CHECK_INT(t, mt_analysis_new(c.study->model, 0, 1, &input, &zero, &a, &c.err), MT_OK);
    }
    if (CHECK(t, a != NULL)) {
        CHECK_INT(t, a->n_rigid, 1);
        CHECK_INT(t, mt_enclosure_new(a, &zero, &most, &e, reason, &c.err), MT_OK);
        CHECK(t, e == NULL && strstr(reason, "may be held by a spring") != NULL);
        CHECK_INT(t, mt_enclosure_new(a, &zero, &zero, &e, reason, &c.err), MT_OK);
        if (CHECK(t, e != NULL)) { /* its box must not leave what it was made for */
            CHECK(t, mt_enclosure_set(e, &zero, &zero));
            CHECK(t, !mt_enclosure_set(e, &zero, &some));
        }
        CHECK_INT(t, mt_analysis_solve(a, &some, &opt, &c.err), MT_E_DOMAIN);
        CHECK(t, strstr(c.err.text, "counted as rigid-body modes") != NULL);
        a->recount = true;
        CHECK_INT(t, mt_analysis_solve(a, &some, &opt, &c.err), MT_OK);
        CHECK_INT(t, a->modes.n_rigid, 0);
    }
    mt_enclosure_delete(e);
    mt_analysis_delete(a);
    study_free(&c);
}

/* A stiffness that falls to 0 ends a tolerance box: there the design gains a rigid-body
 * mode. */
static void rank__a_tolerance_box_ends_where_a_spring_lets_go(mt_test *t)
{
    study_case c;
    if (study_solve(t, STUDY_TWO_MASSES("'m': 1, 'a': 4, 'k1': 'a - 3', 'k2': 1000", ""),
                    "'variables': [{'parameter': 'a', 'lower': 3, 'upper': 100}], 'goals': "
                    "[{'type': 'avoid', 'bands_hz': [[3, 4]]}]",
                    &c)) {
        const mt_tolerance_box *const box = c.result->recommendations[0].tolerance_box;
        if (CHECK(t, box != NULL)) {
            CHECK_NEAR(t, box->all_percent, 25.0, 0.01);
            CHECK(t, box->edge != NULL && strstr(box->edge, "positive") != NULL);
        }
    }
    study_free(&c);
}

/* A reading that a fresh analysis does not share is planted: nothing of it may stand. */
static void rank__a_fresh_analysis_decides(mt_test *t)
{
    static const struct {
        const char *name;
        double factor; /* of the mode's lambda */
        int rigid;     /* more of them than there are */
        bool doubted;
    } rows[] = {
        {"as it is", 1.0, 0, false},
        {"within rounding", 1.0 + 1e-14, 0, false},
        {"another frequency", 1.0 + 1e-6, 0, true},
        {"a mode not counted", 1.0, 1, true},
        {"a mode taken for 0", 0.0, 0, true},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        opened o;
        mt_result *result = NULL;
        mt_recommendation rec = mt_recommendation_default();
        double motion_room = 0.0;
        mt_err err = {0};
        mt_test_row(t, "%s", rows[i].name);
        if (open_problem(t, STUDY_TWO_MASSES("'m': 1, 'k1': 100, 'k2': 1000", ""),
                         K1_TO_400
                         "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': 1}]",
                         &o) &&
            CHECK_INT(t, mt_result_new(&result, &err), MT_OK)) {
            const mt_design design = {.t = o.p->whole.origin_t};
            CHECK_INT(t, mt_describe_goals(o.w, &design, result, &rec, &motion_room, &err),
                      MT_OK);
            mt_modes *const modes = &o.w->views[0].analysis->modes;
            CHECK(t, rec.feasible);
            modes->lambda[0] *= rows[i].factor;
            if (rows[i].rigid > 0) {
                modes->kind[0] = MT_MODE_RIGID_BODY;
                modes->n_rigid = 1;
                modes->lambda[0] = 0.0;
            }
            CHECK_INT(t, mt_describe_frequencies(o.w, &design, NULL, result, &rec, &err),
                      MT_OK);
            CHECK_INT(t, rec.disagreement != NULL, rows[i].doubted);
            /* what the answer makes of it */
            mt_certificate certificate = mt_certificate_default();
            mt_tolerance_box box = mt_tolerance_box_default();
            certificate.proven = true;
            certificate.text = "all is well";
            result->certificates = &certificate;
            result->n_certificates = 1;
            rec.tolerance_box = &box;
            rec.grade = "feasible and proven";
            result->recommendations = &rec;
            result->n_recommendations = 1;
            CHECK_INT(t, mt_describe_is_doubted(result), rows[i].doubted);
            if (rows[i].doubted) {
                CHECK_INT(t, mt_describe_withdraw(result, &err), MT_OK);
                CHECK(t, rec.tolerance_box == NULL && !certificate.proven);
                CHECK_STR(t, rec.grade, "not verified");
                CHECK(t, strstr(certificate.text, "Withdrawn") != NULL);
            }
        }
        mt_result_delete(result);
        close_problem(&o);
    }
}

#define NEGATIVE(bodies, springs)                                                           \
    "{'format': 'modetune-model/1', 'dimension': 3, 'parameters': {'k': 1000},"             \
    "'bodies': [{'name': 'm', 'mass_kg': 2, 'inertia_kg_m2': [1, 1, 1], 'centre': [1, 0, "  \
    "0]}" bodies "], 'joints': [{'name': 'r', 'type': 'prismatic', 'bodies': ['ground', "   \
    "'m'], 'at': [1, 0, 0], 'axis': [1, 0, 0]}], 'springs': [{'name': 's', 'type': "        \
    "'axial', 'bodies': ['ground', 'm'], 'at': [[0, 0, 0], [1, 0, 0]], "                    \
    "'stiffness_n_per_m': 'k'}, {'name': 'n', 'type': 'axial', 'bodies': ['ground', 'm'], " \
    "'at': [[0, 0, 0], [1, 0, 0]], 'stiffness_n_per_m': -1000}" springs "]}"

/* Beside a spring of -1000 N/m the other one is worth what it has above that: at the original
 * design nothing is left, and mode 1 is at 0 Hz, where it still counts. */
static void rank__a_negative_spring_does_not_take_a_mode(mt_test *t)
{
    /* the second body's springs couple its directions: stiffness is no sum of squares then */
    static const char *const negative[] = {
        NEGATIVE("", ""),
        NEGATIVE(
            ", {'name': 'b', 'mass_kg': 1, 'inertia_kg_m2': [1, 1, 1], 'centre': [2, 0, 0]}",
            ", {'name': 'c', 'type': 'bushing', 'bodies': ['ground', 'b'], 'at': [2, 0, 0], "
            "'stiffness_matrix': [[1e5, 2e4, 0, 0, 0, 0], [2e4, 1e5, 0, 0, 0, 0], [0, 0, "
            "1e5, 0, 0, 0], [0, 0, 0, 1e5, 0, 0], [0, 0, 0, 0, 1e5, 0], [0, 0, 0, 0, 0, "
            "1e5]]}")};
    static const struct {
        const char *goal;
        double hz;
    } rows[] = {{"{'type': 'frequency', 'mode': 1, 'at_least_hz': 1.25}", 1.25},
                {"{'type': 'frequency', 'mode': 1, 'target_hz': 2}", 2.0}};
    for (int i = 0; i < 2 * MT_COUNT(rows); i++) {
        char members[STUDY_PATH];
        study_case c;
        const char *const goal = rows[i / 2].goal;
        const double hz = rows[i / 2].hz;
        const double w = 2.0 * STUDY_PI * hz;
        mt_test_row(t, "%s%s", goal, i % 2 == 0 ? "" : ", beside a coupling");
        (void)snprintf(members, sizeof members,
                       "'variables': [{'parameter': 'k', 'lower': 1000, 'upper': 2000}], "
                       "'goals': [%s]",
                       goal);
        if (study_solve(t, negative[i % 2], members, &c)) {
            CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
            CHECK_NEAR(t, study_value(&c, 1, "k"), 1000.0 + (2.0 * w * w), 1e-6);
            CHECK_NEAR(t, study_frequency(&c, 1, "default", 1), hz, 1e-6);
        }
        study_free(&c);
    }
}

MT_TEST_MAIN(MT_TEST(rank__an_added_spring_is_sized_from_zero),
             MT_TEST(rank__a_negative_spring_does_not_take_a_mode),
             MT_TEST(rank__a_band_sees_the_mode_that_the_spring_brings),
             MT_TEST(rank__what_a_spring_can_do_is_not_called_impossible),
             MT_TEST(rank__catalogues_may_hold_no_spring),
             MT_TEST(rank__corners_of_tolerances_count_alike),
             MT_TEST(rank__points_of_a_trade_study_count_alike),
             MT_TEST(rank__a_named_mode_is_the_models),
             MT_TEST(rank__an_added_mass_is_sized_from_zero),
             MT_TEST(rank__the_count_is_the_least_of_the_box),
             MT_TEST(rank__every_kind_of_spring_counts),
             MT_TEST(rank__loaded_configurations_are_counted_over_designs),
             MT_TEST(rank__a_count_that_does_not_hold_is_noticed),
             MT_TEST(rank__a_tolerance_box_ends_where_a_spring_lets_go),
             MT_TEST(rank__a_fresh_analysis_decides))
