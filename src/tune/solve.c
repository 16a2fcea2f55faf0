/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tune/solve.h"

#include "modetune/version.h"

#include <math.h>
#include <string.h>

#include "base/workers.h"
#include "linalg/blas.h"
#include "tune/describe.h"
#include "tune/libraries.h"

mt_solve_options mt_solve_options_default(void)
{
    const mt_solve_options opt = {.threads = 1};
    return opt;
}

static mt_status describe_run(const mt_study *study, mt_result *result, mt_err *err)
{
    mt_result_run *const run = &result->run;
    run->modetune_version = MT_VERSION_STRING;
    run->blas = mt_arena_strdup(&result->mem, mt_blas_description());
    char nlopt[16];
    mt_nlopt_version(nlopt);
    run->nlopt_version = mt_arena_strdup(&result->mem, nlopt);
    run->gsl_version = mt_arena_strdup(&result->mem, mt_gsl_version());
    run->seed = study->search.seed;
    run->n_inputs = study->n_inputs;
    run->input_names =
        mt_arena_alloc(&result->mem, (size_t)study->n_inputs, sizeof *run->input_names);
    run->input_sha256 =
        mt_arena_alloc(&result->mem, (size_t)study->n_inputs, sizeof *run->input_sha256);
    result->variables =
        mt_arena_alloc(&result->mem, (size_t)study->n_variables, sizeof *result->variables);
    if (run->blas == NULL || run->nlopt_version == NULL || run->gsl_version == NULL ||
        run->input_names == NULL || run->input_sha256 == NULL || result->variables == NULL) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < study->n_inputs; i++) {
        run->input_names[i] = study->inputs[i].name;
        run->input_sha256[i] = study->inputs[i].sha256;
    }
    result->n_variables = study->n_variables;
    for (int i = 0; i < study->n_variables; i++) {
        result->variables[i] = study->variables[i].parameter_name.s;
    }
    return MT_OK;
}

/* Names of the result must not outlive the study: copy every text that the problem lent. */
static mt_status own_text(mt_result *result, const char **text, mt_err *err)
{
    if (*text == NULL) {
        return MT_OK;
    }
    *text = mt_arena_strdup(&result->mem, *text);
    return *text == NULL ? mt_fail_memory(err) : MT_OK;
}

static mt_status own_recommendation(mt_result *result, mt_recommendation *r, mt_err *err)
{
    for (int i = 0; i < r->n_parameters; i++) {
        MT_TRY(own_text(result, &r->parameters[i].name, err));
        MT_TRY(own_text(result, &r->parameters[i].unit, err));
    }
    for (int i = 0; i < r->n_frequencies; i++) {
        MT_TRY(own_text(result, &r->frequencies[i].configuration, err));
        MT_TRY(own_text(result, &r->frequencies[i].name, err));
        MT_TRY(own_text(result, &r->frequencies[i].reference, err));
    }
    for (int i = 0; i < r->n_goals; i++) {
        MT_TRY(own_text(result, &r->goals[i].text, err));
    }
    return MT_OK;
}

static mt_status own_texts(const mt_study *study, mt_result *result, mt_err *err)
{
    result->study_name = study->name;
    result->study_file = study->path != NULL && strrchr(study->path, '/') != NULL
                             ? strrchr(study->path, '/') + 1
                             : study->path;
    result->model_name = study->model->name;
    result->model_file = study->model_path.s;
    MT_TRY(own_text(result, &result->study_name, err));
    MT_TRY(own_text(result, &result->study_file, err));
    MT_TRY(own_text(result, &result->model_name, err));
    MT_TRY(own_text(result, &result->model_file, err));
    MT_TRY(own_recommendation(result, &result->baseline, err));
    for (int i = 0; i < result->n_recommendations; i++) {
        MT_TRY(own_recommendation(result, &result->recommendations[i], err));
    }
    for (int i = 0; i < result->n_published; i++) {
        MT_TRY(own_text(result, &result->published[i].label, err));
        MT_TRY(own_text(result, &result->published[i].source, err));
        MT_TRY(own_text(result, &result->published[i].published_text, err));
    }
    for (int i = 0; i < result->n_variables; i++) {
        MT_TRY(own_text(result, &result->variables[i], err));
    }
    for (int i = 0; i < result->run.n_inputs; i++) {
        MT_TRY(own_text(result, &result->run.input_names[i], err));
        MT_TRY(own_text(result, &result->run.input_sha256[i], err));
    }
    return MT_OK;
}

/* Entries of a direction below this part of the largest are rounding. */
static const double PART_OF_DIRECTION = 1e-3;

/* "K_T2", or "0.71 ln a - 0.71 ln b". */
static const char *direction_text(const mt_problem *p, const double *v, mt_arena *mem)
{
    double largest = 0.0;
    int parts = 0;
    char *text = mt_arena_strdup(mem, "");
    for (int i = 0; i < p->n; i++) {
        largest = fmax(largest, fabs(v[i]));
    }
    for (int i = 0; i < p->n; i++) {
        parts += fabs(v[i]) > PART_OF_DIRECTION * largest ? 1 : 0;
    }
    for (int i = 0; i < p->n && text != NULL; i++) {
        const char *const name = p->study->variables[i].parameter_name.s;
        if (!(fabs(v[i]) > PART_OF_DIRECTION * largest)) {
            continue;
        }
        if (parts == 1) {
            return mt_arena_strdup(mem, name);
        }
        const char *const sign =
            v[i] < 0.0 ? (text[0] == '\0' ? "-" : " - ") : (text[0] == '\0' ? "" : " + ");
        text = mt_arena_printf(mem, "%s%s%.2g %s%s", text, sign, fabs(v[i]),
                               MT_HAS(p->scale[i]) ? "" : "ln ", name);
    }
    return text;
}

static mt_status describe_undetermined(const mt_problem *p, const mt_nlp_result *found,
                                       mt_result *result, mt_err *err)
{
    double tolerance = 1e-6;
    for (int i = 0; i < p->n_demands; i++) {
        tolerance = fmax(tolerance, p->demands[i].tolerance);
    }
    result->n_undetermined = found->n_undetermined;
    result->undetermined = mt_arena_alloc(&result->mem, (size_t)found->n_undetermined,
                                          sizeof *result->undetermined);
    if (result->undetermined == NULL) {
        return mt_fail_memory(err);
    }
    for (int k = 0; k < found->n_undetermined; k++) {
        mt_undetermined *const u = &result->undetermined[k];
        u->n = p->n;
        u->direction = mt_arena_f64(&result->mem, (size_t)p->n, 1);
        u->text = direction_text(p, found->undetermined + ((ptrdiff_t)k * p->n), &result->mem);
        u->effect_percent = 100.0 * tolerance * found->undetermined_effect[k];
        if (u->direction == NULL || u->text == NULL) {
            return mt_fail_memory(err);
        }
        memcpy(u->direction, found->undetermined + ((ptrdiff_t)k * p->n),
               (size_t)p->n * sizeof *u->direction);
    }
    return MT_OK;
}

static mt_status describe_solutions(mt_problem *p, const mt_nlp_result *found,
                                    mt_result *result, mt_err *err)
{
    const int most = p->study->recommendations;
    const int n = found->n_solutions < most ? found->n_solutions : most;
    result->recommendations =
        mt_arena_alloc(&result->mem, (size_t)n, sizeof *result->recommendations);
    if (result->recommendations == NULL) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < n; i++) {
        const mt_design design = {
            .t = found->solutions[i].t, .found = &found->solutions[i], .rank = i + 1};
        mt_recommendation *const rec = &result->recommendations[i];
        MT_TRY(mt_describe_design(p, &design, &result->baseline, result, rec, err));
        MT_TRY(mt_describe_reasons(p, &design, found, result, rec, err));
        result->n_recommendations++;
    }
    if (found->n_solutions > n) {
        MT_TRY(mt_describe_warn(result, err,
                                "%d more distinct designs were found; \"recommendations\" in "
                                "the study says how many to report",
                                found->n_solutions - n));
    }
    return describe_undetermined(p, found, result, err);
}

static mt_status set_status(const mt_problem *p, const mt_nlp_result *found, mt_result *result,
                            mt_err *err)
{
    const bool interrupted = found != NULL && found->stop == MT_STOP_USER;
    const mt_recommendation *const best =
        result->n_recommendations > 0 ? &result->recommendations[0] : &result->baseline;
    const int goals = best->n_goals;
    result->status = interrupted ? MT_RESULT_INTERRUPTED
                                 : (best->feasible ? MT_RESULT_SOLVED : MT_RESULT_COMPROMISE);
    if (interrupted) {
        result->status_text = "Interrupted: the best designs found so far.";
    } else if (goals == 0) {
        result->status_text = "No goals: the model as it is, against published values.";
    } else if (p->n == 0) {
        result->status_text = best->feasible ? "The original design meets all goals."
                                             : "The original design does not meet all goals.";
    } else if (best->feasible) {
        result->status_text =
            mt_arena_printf(&result->mem, "Solved: %d distinct design%s all goals.",
                            found->n_solutions, found->n_solutions == 1 ? " meets" : "s meet");
    } else {
        result->status_text =
            mt_arena_printf(&result->mem,
                            "Compromise: no design found within the bounds meets all goals; "
                            "the nearest misses by %.3g %% at most (sampled, not proven).",
                            best->violation_percent);
    }
    return result->status_text == NULL ? mt_fail_memory(err) : MT_OK;
}

/* One problem for each worker: worker 0 has the caller's, the others their own, made alike. */
typedef struct crew {
    int n;
    mt_problem **problems;
    void **contexts;
} crew;

static void crew_free(crew *c)
{
    for (int i = 1; i < c->n; i++) {
        mt_problem_delete(c->problems[i]);
    }
}

static mt_status crew_init(crew *c, mt_problem *p, int workers, mt_arena *mem, mt_err *err)
{
    const int most = workers > MT_WORKERS_MOST ? MT_WORKERS_MOST : workers;
    c->problems = mt_arena_alloc(mem, (size_t)most + 1, sizeof(mt_problem *));
    c->contexts = mt_arena_alloc(mem, (size_t)most + 1, sizeof(void *));
    if (c->problems == NULL || c->contexts == NULL) {
        return mt_fail_memory(err);
    }
    c->problems[0] = p;
    c->contexts[0] = p;
    c->n = 1;
    while (c->n < most) {
        MT_TRY(mt_problem_new(p->study, p->references, &c->problems[c->n], err));
        c->problems[c->n]->stop = p->stop;
        c->contexts[c->n] = c->problems[c->n];
        c->n++;
    }
    return MT_OK;
}

static mt_status search(mt_problem *p, int workers, mt_arena *mem, mt_nlp_result *found,
                        mt_err *err)
{
    mt_nlp nlp = mt_problem_nlp(p);
    mt_nlp_options options = mt_nlp_options_default();
    crew c = {0};
    options.seed = p->study->search.seed;
    options.starts = p->study->search.starts;
    options.max_evals = p->study->search.max_evaluations;
    options.least_change = p->objective == MT_OBJECTIVE_CHANGE;
    mt_status rc = crew_init(&c, p, workers, mem, err);
    if (rc == MT_OK) {
        nlp.n_workers = c.n;
        nlp.contexts = c.contexts;
        rc = mt_nlp_solve(&nlp, &options, mem, found, err);
    }
    crew_free(&c);
    return rc;
}

static mt_status answer(const mt_study *study, const mt_solve_options *opt, mt_problem *p,
                        mt_arena *mem, mt_result *result, mt_err *err)
{
    mt_nlp_result found = {0};
    const mt_design original = {.t = p->origin_t, .found = NULL, .rank = 0};
    const bool any = p->n > 0 && p->n_demands > 0;
    double *const x = mt_arena_f64(mem, (size_t)p->n, 1);
    p->stop = opt->stop;
    if (x == NULL) {
        return mt_fail_memory(err);
    }
    MT_TRY(describe_run(study, result, err));
    MT_TRY(mt_describe_design(p, &original, NULL, result, &result->baseline, err));
    if (any) {
        MT_TRY(search(p, opt->threads, mem, &found, err));
        MT_TRY(describe_solutions(p, &found, result, err));
    }
    if (found.stop == MT_STOP_MAX_EVALS) {
        MT_TRY(mt_describe_warn(
            result, err,
            "the budget of evaluations ran out after %ld: more starts may find more",
            found.evals));
    }
    result->run.evaluations = found.evals;
    result->run.starts = found.starts;
    MT_TRY(set_status(p, any ? &found : NULL, result, err));
    const bool recommended = found.n_solutions > 0;
    if (recommended) {
        mt_problem_x(p, found.solutions[0].t, x);
    }
    MT_TRY(mt_describe_published(p, p->original, recommended ? x : NULL, result, err));
    return own_texts(study, result, err);
}

mt_status mt_study_solve(const mt_study *study, const mt_solve_options *opt, mt_result **out,
                         mt_err *err)
{
    mt_problem *p = NULL;
    mt_result *result = NULL;
    mt_arena mem = {0};
    mt_reference_cache references = {0};
    const mt_solve_options defaults = mt_solve_options_default();
    *out = NULL;
    mt_status rc = mt_arena_init(&mem, 0, err);
    rc = rc == MT_OK ? mt_result_new(&result, err) : rc;
    rc = rc == MT_OK ? mt_reference_cache_init(&references, study, &mem, err) : rc;
    rc = rc == MT_OK ? mt_problem_new(study, &references, &p, err) : rc;
    rc = rc == MT_OK ? answer(study, opt != NULL ? opt : &defaults, p, &mem, result, err) : rc;
    mt_problem_delete(p);
    mt_reference_cache_free(&references);
    mt_arena_free(&mem);
    if (rc != MT_OK) {
        mt_result_delete(result);
        return rc;
    }
    *out = result;
    return MT_OK;
}
