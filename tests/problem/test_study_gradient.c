/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The whole callback of the search against central differences: every row of every kind of
 * goal, every objective, every coordinate. */
#include "mt_slope.h"
#include "problem/evaluate.h"
#include "problem/objective.h"
#include "problem/workspace.h"
#include "study_fixture.h"

/* One evaluation is good to some n eps of the eigenvalues, more where shapes enter. */
static const double NOISE = 1e-13;
static const double STEP = 1e-3;

/* A study compiled. */
typedef struct compiled {
    study_case c;
    mt_arena mem;
    mt_problem *p;
    mt_workspace *w;
} compiled;

static bool compile(mt_test *t, const char *model, const char *members, compiled *s)
{
    *s = (compiled){.p = NULL};
    return study_load(t, model, members, &s->c) &&
           CHECK_INT(t, mt_arena_init(&s->mem, 0, NULL), MT_OK) &&
           CHECK_INT(t, mt_problem_new(s->c.study, NULL, &s->p, &s->c.err), MT_OK) &&
           CHECK_INT(t, mt_workspace_new(s->p, &s->w, &s->c.err), MT_OK);
}

static void compiled_free(compiled *s)
{
    mt_workspace_delete(s->w);
    mt_problem_delete(s->p);
    mt_arena_free(&s->mem);
    study_free(&s->c);
}

enum { VARIABLES = 8, POINTS = 1 + (4 * VARIABLES) };

/* What all rows are at the designs of their slopes, which they have in common. */
typedef struct seen {
    mt_workspace *w;
    mt_arena *mem;
    int n;
    double t[POINTS][VARIABLES];
    mt_nlp_values v[POINTS];
} seen;

/* NULL: no answer, or more designs than slopes take. */
static const mt_nlp_values *values_at(seen *s, int n, const double *t)
{
    const size_t size = (size_t)n * sizeof *t;
    for (int i = 0; i < s->n; i++) {
        if (memcmp(s->t[i], t, size) == 0) {
            return &s->v[i];
        }
    }
    if (n > VARIABLES || s->n == POINTS ||
        mt_subproblem_values_init(s->w->c, s->mem, &s->v[s->n], NULL) != MT_OK ||
        mt_workspace_eval(s->w, t, false, &s->v[s->n], NULL) != MT_OK) {
        return NULL;
    }
    memcpy(s->t[s->n], t, size);
    return &s->v[s->n++];
}

typedef enum kind { OBJECTIVE, RESIDUAL, EQUALITY, INEQUALITY } kind;

static const double *rows_of(const mt_nlp_values *v, kind k)
{
    return k == OBJECTIVE ? &v->f : k == RESIDUAL ? v->r : k == EQUALITY ? v->eq : v->in;
}

/* The entry that is looked at. */
typedef struct probe {
    seen *s;
    kind kind;
    int row;
} probe;

/* Plus one: rows that are held are 0 here, and their noise is that of the residuals, which are
 * of order one. */
static double entry(const void *context, int n, const double *t)
{
    const probe *const q = context;
    const mt_nlp_values *const v = values_at(q->s, n, t);
    return v != NULL ? 1.0 + rows_of(v, q->kind)[q->row] : nan("");
}

/* slope: rows x n. */
static void check_rows(mt_test *t, seen *s, double *at, kind k, int rows, const double *slope)
{
    static const char *const NAMES[] = {"objective", "residual", "equality", "inequality"};
    const mt_nlp nlp = mt_workspace_nlp(s->w);
    for (int row = 0; row < rows; row++) {
        const probe q = {.s = s, .kind = k, .row = row};
        for (int i = 0; i < nlp.n; i++) {
            mt_test_row(t, "stage %d, %s %d, variable %d", s->w->c->stage, NAMES[k], row, i);
            CHECK(t, mt_slope_agrees(entry, &q, nlp.n, at, i,
                                     slope[row + ((ptrdiff_t)i * rows)], STEP, NOISE));
        }
    }
}

/* All slopes of the present stage at t. */
static void check_stage(mt_test *t, mt_workspace *w, double *at, mt_arena *mem)
{
    const mt_nlp nlp = mt_workspace_nlp(w);
    seen s = {.w = w, .mem = mem};
    mt_nlp_values g;
    CHECK_INT(t, mt_subproblem_values_init(w->c, mem, &g, NULL), MT_OK);
    if (CHECK_INT(t, mt_workspace_eval(w, at, true, &g, NULL), MT_OK)) {
        check_rows(t, &s, at, OBJECTIVE, 1, g.df);
        check_rows(t, &s, at, RESIDUAL, nlp.n_res, g.dr);
        check_rows(t, &s, at, EQUALITY, nlp.n_eq, g.deq);
        check_rows(t, &s, at, INEQUALITY, nlp.n_in, g.din);
    }
}

/* The four-bar under gravity (loops, equilibrium) beside the same without gravity; logarithmic
 * and linear variables; every goal and objective there is. */
static const char *const EVERYTHING =
    "'variables': [{'parameter': 'a', 'lower': 0.1, 'upper': 0.2},"
    " {'parameter': 'm_c', 'lower': 1, 'upper': 4, 'weight': 2},"
    " {'parameter': 'alpha', 'lower': -1, 'upper': 2}],"
    "'references': {'test': {'modes': [{'frequency_hz': 2.0,"
    " 'shape': {'tip.x': 1, 'tip.y': -0.4, 'crank.r': 0.5, 'mid.y': 2}}]}},"
    "'goals': ["
    "{'type': 'frequency', 'configuration': 'loaded', 'mode': 1, 'target_hz': 2.1},"
    "{'type': 'frequency', 'configuration': 'still', 'mode': 1, 'at_least_hz': 1,"
    " 'at_most_hz': 3},"
    "{'type': 'frequency', 'configuration': 'trimmed', 'mode': 1, 'reference': 'test'},"
    "{'type': 'frequency', 'configuration': 'loaded', 'mode': 1, 'reference': 'test',"
    " 'weight': 3},"
    "{'type': 'shape', 'configuration': 'loaded', 'mode': 1, 'reference': 'test',"
    " 'weight': 0.7},"
    "{'type': 'shape', 'configuration': 'still', 'mode': 1, 'reference': 'test', 'weight': 1},"
    "{'type': 'mac', 'configuration': 'loaded', 'mode': 1, 'reference': 'test',"
    " 'at_least': 0.5},"
    "{'type': 'limit', 'expression': 'm_c*a', 'at_least': 0.1, 'at_most': 1},"
    "{'type': 'limit', 'expression': 'alpha + a', 'equals': 1.2},"
    "{'type': 'limit', 'expression': 'alpha', 'at_most': 0}],"
    "'objective': [{'minimise': 'misfit'}, {'minimise': 'mass', 'of': ['c*']},"
    " {'minimise': 'm_c^2*exp(alpha)/a'}, {'minimise': 'change'}]";

static void callback__has_exact_gradients(mt_test *t)
{
    compiled s;
    if (compile(t, "four_bar", EVERYTHING, &s)) {
        double at[3] = {log(0.16), log(2.3), 0.9 / 3.0};
        CHECK_INT(t, s.p->whole.rows.eq.n, 3);
        CHECK_INT(t, s.p->whole.rows.of_kind[MT_ROW_GOAL].n, 6);
        CHECK_INT(t, s.p->whole.rows.res.n, 9);
        CHECK_INT(t, s.p->n_stages, 4);
        double f[4] = {0.0};
        mt_subproblem later;
        CHECK_INT(t, mt_subproblem_for_stages(&s.p->whole, &s.mem, &later, NULL), MT_OK);
        CHECK_INT(t, mt_workspace_use(s.w, &later, NULL), MT_OK);
        for (int k = 0; k < s.p->n_stages; k++) {
            mt_objectives_hold(&later, s.w, k, f);
            check_stage(t, s.w, at, &s.mem);
            f[k] = 1.01 * mt_objective_stage_value(s.w, k, NULL);
        }
    }
    compiled_free(&s);
}

/* Named modes, and the mean of a repeated pair that no variable splits. */
static void named_and_repeated_modes__have_exact_gradients(mt_test *t)
{
    compiled s;
    if (compile(t,
                "{'format': 'modetune-model/1', 'dimension': 2,"
                "'parameters': {'k': 4, 'ka': 1, 'kc': 0.3, 'm': 1},"
                "'bodies': [{'name': 'm1', 'mass_kg': 'm', 'centre': [1, 0]},"
                " {'name': 'm2', 'mass_kg': 'm', 'centre': [2, 0]}],"
                "'springs': [{'name': 'x1', 'type': 'axial', 'bodies': ['ground', 'm1'],"
                " 'at': [[0, 0], [1, 0]], 'stiffness_n_per_m': 'k'},"
                "{'name': 'y1', 'type': 'axial', 'bodies': ['ground', 'm1'],"
                " 'at': [[1, 1], [1, 0]], 'stiffness_n_per_m': 'k'},"
                "{'name': 'x2', 'type': 'axial', 'bodies': ['ground', 'm2'],"
                " 'at': [[3, 0], [2, 0]], 'stiffness_n_per_m': 'ka'},"
                "{'name': 'y2', 'type': 'axial', 'bodies': ['ground', 'm2'],"
                " 'at': [[2, 1], [2, 0]], 'stiffness_n_per_m': 'ka + kc'}],"
                "'modes': {'second': {'configuration': 'default', 'index': 2}}}",
                "'variables': [{'parameter': 'k', 'lower': 1, 'upper': 9},"
                " {'parameter': 'ka', 'lower': 0.1, 'upper': 9},"
                " {'parameter': 'm', 'lower': 0.1, 'upper': 9}],"
                "'goals': [{'type': 'frequency', 'mode': 'second', 'target_hz': 0.2},"
                "{'type': 'frequency', 'mode': 3, 'target_hz': 0.3},"
                "{'type': 'frequency', 'mode': 4, 'at_least_hz': 0.3}]",
                &s)) {
        double at[3] = {log(4.5), log(1.2), log(1.1)};
        int size = 0;
        check_stage(t, s.w, at, &s.mem);
        (void)mt_modal_cluster(&s.w->views[0].analysis->modes, 2, &size);
        CHECK_INT(t, size, 2); /* modes 3 and 4 are one pair */
    }
    compiled_free(&s);
}

/* Ratios and distances by index and by name, in one configuration and between two; of names one
 * that is in order and one that is not. */
static void frequencies_of_two_modes__have_exact_gradients(mt_test *t)
{
    compiled s;
    if (compile(t,
                STUDY_TWO_MASSES("'k1': '2*p*q', 'k2': 1, 'm': 1, 'p': 2, 'q': 1",
                                 ", 'configurations': {'bare': {}, 'soft': {'parameters': "
                                 "{'p': 3}}}, 'modes': {'low': {'configuration': "
                                 "'bare', 'index': 1}, 'high': {'configuration': 'bare', "
                                 "'index': 2}}"),
                "'variables': [{'parameter': 'q', 'lower': 0.1, 'upper': 9},"
                " {'parameter': 'k2', 'lower': 0.1, 'upper': 9},"
                " {'parameter': 'm', 'lower': 0.1, 'upper': 9}],"
                "'goals': [{'type': 'ratio', 'configuration': 'bare', 'mode': 2,"
                " 'of': {'mode': 1}, 'target': 3},"
                "{'type': 'ratio', 'configuration': 'bare', 'mode': 'low',"
                " 'of': {'mode': 2, 'configuration': 'soft'}, 'at_least': 0.2, 'at_most': 1},"
                "{'type': 'ratio', 'configurations': ['bare', 'soft'], 'mode': 1,"
                " 'of': {'mode': 2}, 'target': 0.4, 'weight': 2},"
                "{'type': 'apart', 'configuration': 'bare', 'modes': [1, 2],"
                " 'at_least_percent': 40},"
                "{'type': 'apart', 'configuration': 'soft', 'up_to_mode': 2,"
                " 'at_least_hz': 0.1},"
                "{'type': 'apart', 'configuration': 'bare', 'modes': ['high', 'low'],"
                " 'at_least_hz': 0.1},"
                "{'type': 'apart', 'configuration': 'bare', 'modes': ['low', 'high'],"
                " 'at_least_percent': 50}],"
                "'objective': {'minimise': 'misfit'}",
                &s)) {
        double at[3] = {log(1.3), log(1.2), log(1.1)};
        CHECK_INT(t, s.p->whole.rows.eq.n, 1);
        CHECK_INT(t, s.p->whole.rows.in.n, 6);
        CHECK_INT(t, s.p->whole.rows.res.n, 2);
        check_stage(t, s.w, at, &s.mem);
    }
    compiled_free(&s);
}

#define MET(name, x, y)                                                                      \
    "{'name': 's" name "', 'type': 'axial', 'bodies': ['ground', 'm'], 'at': [['" x "', '" y \
    "', 0], [0, 0, 0]], 'stiffness_n_per_m': 'k" name "'}"
/* Three equal springs in a plane, their doubled angles a third of a turn apart: with v a change
 * of ln k, both eigenvalues are 3 k / 2 and part by |sum k v_i exp(2 i theta_i)|, at most k
 * sqrt(3/2) |v|. */
static void modes_that_meet__have_a_slope_that_parts_them(mt_test *t)
{
    static const double STEP_APART = 1e-5;
    compiled s;
    if (compile(
            t,
            "{'format': 'modetune-model/1', 'dimension': 3, 'parameters': {'ka': 1, "
            "'kb': 1, 'kc': 1}, 'bodies': [{'name': 'm', 'mass_kg': 1, 'centre': [0, 0, "
            "0]}], 'springs': [" MET("a", "1", "0") "," MET("b", "0.5", "sqrt(0.75)") "," MET(
                "c", "-0.5",
                "sqrt(0.75)") ", {'name': 'across', 'type': 'axial', "
                              "'bodies': ['ground', 'm'], 'at': [[0, 0, 1], [0, 0, 0]], "
                              "'stiffness_n_per_m': 100}]}",
            "'variables': [{'parameter': 'ka', 'lower': 0.1, 'upper': 9},"
            " {'parameter': 'kb', 'lower': 0.1, 'upper': 9},"
            " {'parameter': 'kc', 'lower': 0.1, 'upper': 9}],"
            "'goals': [{'type': 'apart', 'modes': [1, 2], 'at_least_percent': 10},"
            "{'type': 'apart', 'modes': [1, 2], 'at_least_hz': 0.01}]",
            &s)) {
        double at[3] = {0.0, 0.0, 0.0};
        const double hz = study_hz(1.5);
        const double most[] = {100.0 * sqrt(1.5) / 3.0 / 10.0, hz * sqrt(1.5) / 3.0 / 0.01};
        double slope[2][3];
        double met[2];
        mt_nlp_values v;
        CHECK_INT(t, mt_subproblem_values_init(s.w->c, &s.mem, &v, NULL), MT_OK);
        CHECK_INT(t, mt_workspace_eval(s.w, at, true, &v, NULL), MT_OK);
        for (int i = 0; i < 6; i++) {
            slope[i % 2][i / 2] = v.din[i];
        }
        memcpy(met, v.in, sizeof met);
        for (int row = 0; row < 2; row++) {
            mt_test_row(t, "row %d", row);
            const double size = mt_norm2(3, slope[row]);
            CHECK_NEAR(t, size, most[row], 1e-9);
            CHECK_NEAR(t, met[row], -1.0, 1e-9);
            for (int side = -1; side <= 1; side += 2) { /* it parts them on both sides */
                for (int i = 0; i < 3; i++) {
                    at[i] = (double)side * STEP_APART * slope[row][i] / size;
                }
                CHECK_INT(t, mt_workspace_eval(s.w, at, false, &v, NULL), MT_OK);
                CHECK_NEAR(t, (v.in[row] + 1.0) / STEP_APART, size, 1e-4);
            }
        }
    }
    compiled_free(&s);
}

/* Damping ratios by index, by name and as a residual, of loops under load, of everything that
 * damps. */
static void damping__has_exact_gradients(mt_test *t)
{
    compiled s;
    if (compile(t, "damped_linkage",
                "'variables': [{'parameter': 'a', 'lower': 0.12, 'upper': 0.18},"
                " {'parameter': 'k', 'lower': 10, 'upper': 40},"
                " {'parameter': 'c', 'lower': 0, 'upper': 2},"
                " {'parameter': 'eta', 'lower': 0.01, 'upper': 0.3},"
                " {'parameter': 'zeta', 'lower': 0.001, 'upper': 0.1}],"
                "'goals': ["
                "{'type': 'damping', 'configuration': 'all', 'mode': 1, 'at_least': 0.05,"
                " 'at_most': 0.2},"
                "{'type': 'damping', 'configuration': 'all', 'mode': 4, 'target': 0.06},"
                "{'type': 'damping', 'configuration': 'named', 'mode': 'swing',"
                " 'at_least': 0.03},"
                "{'type': 'damping', 'configurations': ['named', 'driven'], 'mode': 2,"
                " 'target': 0.04, 'weight': 2}],"
                "'objective': {'minimise': 'misfit'}",
                &s)) {
        double at[5] = {log(0.155), log(21.0), log(0.4), log(0.09), log(0.03)};
        CHECK_INT(t, s.p->whole.rows.eq.n, 1);
        CHECK_INT(t, s.p->whole.rows.of_kind[MT_ROW_GOAL].n, 3);
        CHECK_INT(t, s.p->whole.rows.res.n, 2);
        check_stage(t, s.w, at, &s.mem);
    }
    compiled_free(&s);
}

/* Ports of loops under load: a band whose parts have their peaks within, at moving ends and at
 * those of the band; one frequency; and all that profiles make of a response. */
#define SHAKEN_VARIABLES                                                                    \
    "'variables': [{'parameter': 'a', 'lower': 0.12, 'upper': 0.18}, {'parameter': 'k', "   \
    "'lower': 10, 'upper': 40}, {'parameter': 'c', 'lower': 0, 'upper': 2}, {'parameter': " \
    "'eta', 'lower': 0.01, 'upper': 0.3}, {'parameter': 'zeta', 'lower': 0.001, 'upper': "  \
    "0.1}],"

static void shaken_goals__have_exact_gradients(mt_test *t)
{
    compiled s;
    if (compile(t, "damped_linkage",
                SHAKEN_VARIABLES
                "'goals': ["
                "{'type': 'response', 'configuration': 'all', 'input': 'base.x',"
                " 'output': 'spring.rail', 'band_hz': [0.4, 9], 'at_most': 3},"
                "{'type': 'response', 'configuration': 'named', 'input': 'base.y:displacement',"
                " 'output': 'damper.strut', 'at_hz': 1.7, 'target': 0.01},"
                "{'type': 'response', 'configuration': 'all', 'input': 'base.y',"
                " 'output': 'spring.coil', 'at_hz': 0.7, 'target': 0.01, 'weight': 2},"
                "{'type': 'vibration', 'configuration': 'all', 'profile': 'truck_vertical',"
                " 'input': 'base.y', 'output': 'spring.servo', 'at_most': 3, 'at_least': 1},"
                "{'type': 'vibration', 'configuration': 'all', 'quantity': 'sine',"
                " 'profile': 'helicopter_sine_on_random', 'input': 'base.y',"
                " 'output': 'spring.rail', 'at_most': 3},"
                "{'type': 'vibration', 'configuration': 'named', 'quantity': 'peak',"
                " 'profile': 'helicopter_sine_on_random', 'input': 'base.x',"
                " 'output': 'damper.oil', 'at_most': 3}],"
                "'objective': {'minimise': 'misfit'}",
                &s)) {
        double at[5] = {log(0.155), log(21.0), log(0.4), log(0.09), log(0.03)};
        CHECK_INT(t, s.p->whole.rows.eq.n, 1);
        CHECK_INT(t, s.p->whole.rows.res.n, 1);
        CHECK(t, s.p->requirements[0].n_parts > 2);
        CHECK_INT(t, s.p->whole.rows.of_kind[MT_ROW_GOAL].n, s.p->requirements[0].n_parts + 4);
        check_stage(t, s.w, at, &s.mem);
    }
    compiled_free(&s);
}

/* With its coordinate above what all rows ask for, and without. */
static void shaken_objective__has_an_exact_gradient(mt_test *t)
{
    compiled s;
    if (compile(t, "damped_linkage",
                SHAKEN_VARIABLES
                "'goals': ["
                "{'type': 'frequency', 'configuration': 'all', 'mode': 1, 'at_least_hz': 0.1},"
                "{'type': 'response', 'configuration': 'all', 'input': 'base.x',"
                " 'output': 'spring.rail', 'band_hz': [0.4, 9], 'at_most': 3},"
                "{'type': 'vibration', 'configuration': 'all', 'profile': 'truck_vertical',"
                " 'input': 'base.y', 'output': 'spring.servo', 'at_most': 3}],"
                "'objective': [{'minimise': 'vibration'}, {'minimise': 'change'}]",
                &s)) {
        double at[6] = {log(0.155), log(21.0), log(0.4), log(0.09), log(0.03), 51.5};
        double f[4] = {0.0};
        mt_subproblem later;
        mt_nlp_values v;
        CHECK_INT(t, s.p->whole.rows.of_kind[MT_ROW_GOAL].n, 1);
        CHECK_INT(t, s.p->whole.rows.of_kind[MT_ROW_VIBRATION].n,
                  s.p->requirements[1].n_parts + 1);
        CHECK_INT(t, mt_subproblem_for_stages(&s.p->whole, &s.mem, &later, NULL), MT_OK);
        CHECK_INT(t, mt_workspace_use(s.w, &later, NULL), MT_OK);
        for (int k = 0; k < s.p->n_stages; k++) {
            mt_objectives_hold(&later, s.w, k, f);
            check_stage(t, s.w, at, &s.mem);
            f[k] = 1.01 * mt_objective_stage_value(s.w, k, NULL);
        }
        mt_objectives_hold(&later, s.w, 0, f);
        at[5] = 0.0; /* not given: looked up */
        CHECK_INT(t, mt_subproblem_values_init(s.w->c, &s.mem, &v, NULL), MT_OK);
        CHECK_INT(t, mt_workspace_eval(s.w, at, false, &v, NULL), MT_OK);
        CHECK(t, isfinite(s.w->worst));
        CHECK_NEAR(t, mt_objective_stage_value(s.w, 0, NULL), s.w->worst, 0.0);
    }
    compiled_free(&s);
}

/* What loops under load do at rest: motions, forces of springs and joints, a locked and a
 * trimmed drive, differences of configurations, compliances. */
static void goals_at_rest__have_exact_gradients(mt_test *t)
{
    compiled s;
    if (compile(t, "four_bar",
                "'variables': [{'parameter': 'a', 'lower': 0.1, 'upper': 0.2},"
                " {'parameter': 'm_c', 'lower': 1, 'upper': 4},"
                " {'parameter': 'k', 'lower': 10, 'upper': 40},"
                " {'parameter': 'alpha', 'lower': 0.5, 'upper': 2}],"
                "'goals': ["
                "{'type': 'static', 'configurations': ['loaded', 'trimmed'],"
                " 'output': 'tip.y', 'at_least': -0.02},"
                "{'type': 'static', 'configuration': 'loaded', 'output': 'crank.r',"
                " 'target': -0.1, 'weight': 2},"
                "{'type': 'static', 'configurations': ['loaded', 'locked'],"
                " 'output': 'spring.coil', 'at_most': 0.5, 'at_least': 0},"
                "{'type': 'static', 'configurations': ['loaded', 'locked', 'trimmed'],"
                " 'output': 'joint.jB.x', 'at_most': 9},"
                "{'type': 'static', 'configuration': 'locked', 'output': 'joint.jA.rz',"
                " 'at_most': 3},"
                "{'type': 'static', 'configuration': 'locked', 'output': 'joint.jA.hold',"
                " 'target': 3},"
                "{'type': 'static', 'configuration': 'trimmed', 'output': 'spring.servo',"
                " 'at_most': 3},"
                "{'type': 'static', 'configuration': 'trimmed', 'output': 'joint.jD.y',"
                " 'against': 'loaded', 'at_most': 3},"
                "{'type': 'static', 'configuration': 'loaded', 'output': 'tip.y',"
                " 'input': 'tip.x', 'at_most': 3},"
                "{'type': 'static', 'configuration': 'still', 'output': 'tip.y',"
                " 'input': 'tip.y', 'target': 1, 'weight': 0.5},"
                "{'type': 'static', 'configuration': 'loaded', 'output': 'crank.r',"
                " 'input': 'crank.r', 'quantity': 'stiffness', 'at_least': 3}],"
                "'objective': {'minimise': 'misfit'}",
                &s)) {
        double at[4] = {log(0.16), log(2.3), log(22.0), log(1.1)};
        CHECK_INT(t, s.p->whole.rows.eq.n, 1);
        CHECK_INT(t, s.p->whole.rows.res.n, 2);
        CHECK_INT(t, s.p->whole.rows.of_kind[MT_ROW_GOAL].n, 14);
        check_stage(t, s.w, at, &s.mem);
    }
    compiled_free(&s);
}

/* Logarithms of responses over measured ones, magnitude and phase, through loops under load. */
static void measured_responses__have_exact_gradients(mt_test *t)
{
    compiled s;
    if (compile(t, "damped_linkage",
                "'variables': [{'parameter': 'a', 'lower': 0.12, 'upper': 0.18},"
                " {'parameter': 'k', 'lower': 10, 'upper': 40},"
                " {'parameter': 'c', 'lower': 0, 'upper': 2},"
                " {'parameter': 'eta', 'lower': 0.01, 'upper': 0.3},"
                " {'parameter': 'alpha', 'lower': -1, 'upper': 2}],"
                "'measurements': {'shaker': {'file': '" MT_TEST_SOURCE_DIR
                "/tests/documents/wrong/parts/measured.csv'}},"
                "'goals': ["
                "{'type': 'frequency_response', 'configurations': ['all', 'still'],"
                " 'input': 'base.x', 'output': 'spring.coil', 'measurement': 'shaker',"
                " 'coherence': true, 'weight': 2},"
                "{'type': 'frequency_response', 'configuration': 'dampers',"
                " 'input': 'base.y:displacement', 'output': 'damper.strut',"
                " 'measurement': 'shaker', 'band_hz': [1.5, 4], 'weight': 0.5}],"
                "'objective': {'minimise': 'misfit'}",
                &s)) {
        double at[5] = {log(0.155), log(21.0), log(0.4), log(0.09), 0.9 / 3.0};
        CHECK_INT(t, s.p->whole.rows.res.n, 2 * (3 + 3 + 2));
        check_stage(t, s.w, at, &s.mem);
    }
    compiled_free(&s);
}

/* Shares of bodies, a flexible link and springs, by index, name and of the mode with most. */
static void energies__have_exact_gradients(mt_test *t)
{
    compiled s;
    if (compile(t, "damped_linkage",
                "'variables': [{'parameter': 'a', 'lower': 0.12, 'upper': 0.18},"
                " {'parameter': 'k', 'lower': 10, 'upper': 40},"
                " {'parameter': 'm_c', 'lower': 1, 'upper': 4},"
                " {'parameter': 'alpha', 'lower': -1, 'upper': 2}],"
                "'goals': ["
                "{'type': 'energy', 'configurations': ['all', 'driven'], 'mode': 'most',"
                " 'body': 'coupler', 'directions': ['x', 'rz'], 'about': 'B',"
                " 'at_least_percent': 5, 'at_most_percent': 95},"
                "{'type': 'energy', 'configuration': 'all', 'mode': 3, 'body': 'whip',"
                " 'at_most_percent': 50},"
                "{'type': 'energy', 'configuration': 'named', 'mode': 'swing',"
                " 'spring': 'servo', 'at_least_percent': 10},"
                "{'type': 'energy', 'configuration': 'all', 'mode': 2, 'spring': 'whip',"
                " 'at_most_percent': 0}],"
                "'objective': {'minimise': 'change'}",
                &s)) {
        double at[4] = {log(0.155), log(21.0), log(2.2), 0.9 / 3.0};
        CHECK_INT(t, s.p->n_requirements, 7);
        CHECK_INT(t, s.p->whole.rows.in.n, (2 * 2 * 2) + 1 + 1 + 1);
        check_stage(t, s.w, at, &s.mem);
    }
    compiled_free(&s);
}

MT_TEST_MAIN(MT_TEST(frequencies_of_two_modes__have_exact_gradients),
             MT_TEST(modes_that_meet__have_a_slope_that_parts_them),
             MT_TEST(callback__has_exact_gradients), MT_TEST(damping__has_exact_gradients),
             MT_TEST(energies__have_exact_gradients),
             MT_TEST(shaken_goals__have_exact_gradients),
             MT_TEST(goals_at_rest__have_exact_gradients),
             MT_TEST(measured_responses__have_exact_gradients),
             MT_TEST(shaken_objective__has_an_exact_gradient),
             MT_TEST(named_and_repeated_modes__have_exact_gradients))
