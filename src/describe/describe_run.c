/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a result says of its own making, and the texts that it must own: it may outlive study
 * and problem. */
#include "modetune/version.h"

#include <string.h>

#include "base/base.h"
#include "base/text.h"
#include "describe/describe.h"
#include "linalg/dense.h"
#include "nlp/libraries.h"

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
