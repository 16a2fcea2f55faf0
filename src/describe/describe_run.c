/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How the search came to its designs. */
#include "modetune/version.h"

#include <math.h>
#include <string.h>

#include "base/base.h"
#include "base/text.h"
#include "describe/describe.h"
#include "linalg/dense.h"
#include "nlp/merit.h"
#include "nlp/nlp.h"
#include "problem/objective.h"

static double finite_or_none(double x)
{
    return isfinite(x) ? x : nan("");
}

mt_status mt_describe_history(const mt_problem *p, const mt_nlp_result *found, int stage,
                              mt_result *result, mt_err *err)
{
    mt_result_run *const run = &result->run;
    mt_steps steps = found->steps;
    if (found->n_solutions > 0) {
        const mt_nlp_solution *const s = &found->solutions[0];
        const mt_step end = {found->evals, stage, 0, s->f, s->violation, s->squares};
        mt_steps_settle(&steps, &end);
    }
    run->history = mt_arena_alloc(&result->mem, (size_t)steps.n, sizeof *run->history);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int i = 0; i < steps.n; i++) {
        const mt_step *const s = &steps.at[i];
        const bool none = p->n_stages == 0;
        run->history[run->n_history++] = (mt_result_step){
            .objective = s->stage + 1,
            .round = s->round + 1,
            .evaluations = s->evals,
            .value = none
                         ? nan("")
                         : finite_or_none(mt_objective_stage_shown(&p->stages[s->stage], s->f)),
            .violation = finite_or_none(s->violation),
            .feasible = mt_is_held(s->violation),
        };
    }
    return MT_OK;
}

/* What a fresh analysis that disagrees makes of a result. */

static bool doubted(const mt_recommendation *rec)
{
    return rec->disagreement != NULL;
}

bool mt_describe_is_doubted(const mt_result *result)
{
    bool any = doubted(&result->baseline);
    for (int i = 0; i < result->n_recommendations; i++) {
        any = any || doubted(&result->recommendations[i]);
    }
    return any;
}

/* Withdraw the proven grade of a design: its proof rests on results that disagree, at any
 * design of the study. */
static void disgrade(mt_recommendation *rec)
{
    rec->tolerance_box = NULL;
    rec->worst_case = rec->worst_case == NULL ? NULL : "sampled";
    if (doubted(rec)) {
        rec->grade = "not verified";
    } else if (rec->feasible && rec->grade != NULL &&
               strcmp(rec->grade, "feasible and proven") == 0) {
        rec->grade = "feasible";
    }
}

mt_status mt_describe_withdraw(mt_result *result, mt_err *err)
{
    disgrade(&result->baseline);
    for (int i = 0; i < result->n_recommendations; i++) {
        disgrade(&result->recommendations[i]);
    }
    for (int i = 0; i < result->n_certificates; i++) {
        mt_certificate *const c = &result->certificates[i];
        c->proven = false;
        c->text = mt_arena_printf(
            &result->mem,
            "Withdrawn, because recomputed values differ from those it rests on: %s", c->text);
    }
    return mt_arena_check(&result->mem, err);
}

/* What a result says of its own making, and the texts that it must own: it may outlive study
 * and problem. */

enum { VERSION_SIZE = 16 };

/* "mass of bar*, rod" */
static const char *objective_text(const mt_objective *o, mt_arena *mem)
{
    const char *text =
        o->expression_text != NULL ? o->expression_text : mt_objective_kind_of(o->type)->name;
    for (int i = 0; i < o->of.count; i++) {
        text = mt_arena_printf(mem, "%s%s%s", text, i == 0 ? " of " : ", ", o->of.items[i].s);
    }
    return text;
}

static mt_status describe_objectives(const mt_study *study, mt_result *result, mt_err *err)
{
    result->objectives =
        mt_arena_alloc(&result->mem, (size_t)study->n_objectives, sizeof *result->objectives);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int i = 0; i < study->n_objectives; i++) {
        const mt_objective *const o = &study->objectives[i];
        const mt_objective_kind *const kind = mt_objective_kind_of(o->type);
        result->objectives[result->n_objectives++] =
            (mt_result_objective){kind->name, objective_text(o, &result->mem),
                                  o->expression_text != NULL ? NULL : kind->unit};
    }
    return mt_arena_check(&result->mem, err);
}

static bool is_variable(const mt_study *study, int parameter)
{
    for (int i = 0; i < study->n_variables; i++) {
        if (study->variables[i].parameter == parameter) {
            return true;
        }
    }
    return false;
}

/* List the values that the model marks as assumed, on which the answer depends. */
static mt_status describe_assumptions(const mt_study *study, mt_result *result, mt_err *err)
{
    const mt_model *const m = study->model;
    result->assumptions =
        mt_arena_alloc(&result->mem, (size_t)m->n_parameters, sizeof *result->assumptions);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int i = 0; i < m->n_parameters; i++) {
        const mt_parameter *const p = &m->parameters[i];
        if (p->origin == MT_ORIGIN_ASSUMED) {
            result->assumptions[result->n_assumptions++] = (mt_result_assumption){
                .parameter = p->name.s,
                .unit = p->unit,
                .display_unit = mt_unit_name(p->written, NULL),
                .display_factor = mt_unit_display(p->written),
                .value = study->original[i],
                .source = p->source,
                .variable = is_variable(study, i),
            };
        }
    }
    return MT_OK;
}

mt_status mt_describe_run(const mt_study *study, mt_result *result, mt_err *err)
{
    mt_result_run *const run = &result->run;
    mt_arena *const mem = &result->mem;
    const size_t n = (size_t)study->n_variables;
    char nlopt[VERSION_SIZE];
    mt_nlopt_version(nlopt);
    run->modetune_version = MT_VERSION_STRING;
    run->build = (mt_result_build){mt_build_commit(), mt_build_compiler()};
    run->blas = mt_arena_strdup(mem, mt_blas_description());
    run->nlopt_version = mt_arena_strdup(mem, nlopt);
    run->gsl_version = mt_arena_strdup(mem, mt_gsl_version());
    run->seed = (long)study->search.seed;
    run->inputs = mt_arena_alloc(mem, (size_t)study->n_inputs, sizeof *run->inputs);
    run->overrides = mt_arena_alloc(mem, (size_t)study->n_asked, sizeof *run->overrides);
    result->variables = mt_arena_alloc(mem, n, sizeof *result->variables);
    MT_TRY(mt_arena_check(mem, err));
    run->n_inputs = study->n_inputs;
    for (int i = 0; i < study->n_inputs; i++) {
        run->inputs[i] = (mt_result_digest){study->inputs[i].name, study->inputs[i].sha256};
    }
    run->n_overrides = study->n_asked;
    for (int i = 0; i < study->n_asked; i++) {
        const mt_requested_number *const a = &study->asked[i];
        run->overrides[i] = (mt_result_override){
            .kind = a->kind,
            .name = a->name,
            .unit = a->unit,
            .display_unit = mt_unit_name(a->shown, NULL),
            .display_factor = mt_unit_display(a->shown),
            .value = a->value,
            .original = a->original,
        };
    }
    result->n_variables = study->n_variables;
    for (int i = 0; i < study->n_variables; i++) {
        result->variables[i] = study->variables[i].parameter_name.s;
    }
    MT_TRY(describe_assumptions(study, result, err));
    return describe_objectives(study, result, err);
}

mt_status mt_describe_own(const mt_study *study, mt_result *result, mt_err *err)
{
    result->study = (mt_result_study){study->name, mt_text_base_name(study->path),
                                      study->author, study->revision, study->date};
    result->model.name = study->model->name;
    result->model.file = study->model_path.s;
    return mt_result_own(result, err);
}
