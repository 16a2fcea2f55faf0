/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a result says of its own making, and the texts that it must own: it may outlive study
 * and problem. */
#include "modetune/version.h"

#include <string.h>

#include "describe/describe.h"
#include "linalg/blas.h"
#include "nlp/libraries.h"

enum { VERSION_SIZE = 16 };

mt_status mt_describe_run(const mt_study *study, mt_result *result, mt_err *err)
{
    mt_result_run *const run = &result->run;
    mt_arena *const mem = &result->mem;
    const size_t n_inputs = (size_t)study->n_inputs;
    const size_t n = (size_t)study->n_variables;
    char nlopt[VERSION_SIZE];
    mt_nlopt_version(nlopt);
    run->modetune_version = MT_VERSION_STRING;
    run->blas = mt_arena_strdup(mem, mt_blas_description());
    run->nlopt_version = mt_arena_strdup(mem, nlopt);
    run->gsl_version = mt_arena_strdup(mem, mt_gsl_version());
    run->seed = study->search.seed;
    run->input_names = mt_arena_alloc(mem, n_inputs, sizeof *run->input_names);
    run->input_sha256 = mt_arena_alloc(mem, n_inputs, sizeof *run->input_sha256);
    result->variables = mt_arena_alloc(mem, n, sizeof *result->variables);
    if (run->blas == NULL || run->nlopt_version == NULL || run->gsl_version == NULL ||
        run->input_names == NULL || run->input_sha256 == NULL || result->variables == NULL) {
        return mt_fail_memory(err);
    }
    run->n_inputs = study->n_inputs;
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

/* Replace a borrowed text by a copy of its own. */
static mt_status own(mt_result *result, const char **text, mt_err *err)
{
    if (*text == NULL) {
        return MT_OK;
    }
    *text = mt_arena_strdup(&result->mem, *text);
    return *text == NULL ? mt_fail_memory(err) : MT_OK;
}

static mt_status own_design(mt_result *result, mt_recommendation *r, mt_err *err)
{
    for (int i = 0; i < r->n_parameters; i++) {
        MT_TRY(own(result, &r->parameters[i].name, err));
        MT_TRY(own(result, &r->parameters[i].unit, err));
    }
    for (int i = 0; i < r->n_frequencies; i++) {
        MT_TRY(own(result, &r->frequencies[i].configuration, err));
        MT_TRY(own(result, &r->frequencies[i].name, err));
        MT_TRY(own(result, &r->frequencies[i].reference, err));
    }
    for (int i = 0; i < r->n_clearances; i++) {
        MT_TRY(own(result, &r->clearances[i].configuration, err));
    }
    for (int i = 0; i < r->n_gaps; i++) {
        MT_TRY(own(result, &r->gaps[i].configuration, err));
    }
    return MT_OK;
}

static mt_status own_names(const mt_study *study, mt_result *result, mt_err *err)
{
    const char *const slash = study->path == NULL ? NULL : strrchr(study->path, '/');
    result->study_name = study->name;
    result->study_file = slash != NULL ? slash + 1 : study->path;
    result->model_name = study->model->name;
    result->model_file = study->model_path.s;
    MT_TRY(own(result, &result->study_name, err));
    MT_TRY(own(result, &result->study_file, err));
    MT_TRY(own(result, &result->model_name, err));
    return own(result, &result->model_file, err);
}

mt_status mt_describe_own(const mt_study *study, mt_result *result, mt_err *err)
{
    MT_TRY(own_names(study, result, err));
    MT_TRY(own_design(result, &result->baseline, err));
    for (int i = 0; i < result->n_recommendations; i++) {
        MT_TRY(own_design(result, &result->recommendations[i], err));
    }
    for (int i = 0; i < result->n_undetermined; i++) {
        MT_TRY(own(result, &result->undetermined[i].text, err));
    }
    for (int i = 0; i < result->n_published; i++) {
        MT_TRY(own(result, &result->published[i].label, err));
        MT_TRY(own(result, &result->published[i].source, err));
        MT_TRY(own(result, &result->published[i].published_text, err));
    }
    for (int i = 0; i < result->n_variables; i++) {
        MT_TRY(own(result, &result->variables[i], err));
    }
    for (int i = 0; i < result->run.n_inputs; i++) {
        MT_TRY(own(result, &result->run.input_names[i], err));
        MT_TRY(own(result, &result->run.input_sha256[i], err));
    }
    return MT_OK;
}
