/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/study.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "io/json_print.h"

enum { DEFAULT_RECOMMENDATIONS = 5, DEFAULT_SEED = 1 };

mt_status mt_study_new(mt_study **out, mt_err *err)
{
    *out = NULL;
    mt_study *const study = calloc(1, sizeof *study);
    if (study == NULL) {
        return mt_fail_memory(err);
    }
    const mt_status rc = mt_arena_init(&study->mem, 0, err);
    if (rc != MT_OK) {
        free(study);
        return rc;
    }
    study->warning_list = mt_warning_list_default(&study->mem);
    study->recommendations = DEFAULT_RECOMMENDATIONS;
    study->search = (mt_search){.seed = DEFAULT_SEED, .proof_s = nan("")};
    study->weight_sensitivity = (mt_weight_sensitivity){.factor = nan(""), .addr = MT_NO_ADDR};
    *out = study;
    return MT_OK;
}

void mt_study_delete(mt_study *study)
{
    if (study == NULL) {
        return;
    }
    for (int i = 0; i < study->n_models; i++) {
        mt_model_delete(study->models[i]);
    }
    for (int i = 0; i < study->n_profiles; i++) {
        mt_vibration_delete(study->profiles[i].profile);
    }
    mt_json_delete(study->document);
    mt_arena_free(&study->mem);
    free(study);
}

bool mt_study_has_bands(const mt_study *study)
{
    for (int g = 0; g < study->n_goals; g++) {
        if (study->goals[g].avoid != NULL) {
            return true;
        }
    }
    return false;
}

bool mt_study_has_limits(const mt_study *study)
{
    for (int g = 0; g < study->n_goals; g++) {
        if (mt_goal_is_limit(&study->goals[g])) {
            return true;
        }
    }
    return false;
}

bool mt_study_is_scale(const mt_study *study, const mt_goal *goal)
{
    const bool shakes =
        study->n_objectives > 0 && mt_objective_is(study->objectives[0].type, MT_SHAKES);
    return shakes && mt_goal_is_limit(goal);
}

bool mt_study_asks(const mt_study *study, int configuration)
{
    for (int g = 0; g < study->n_goals; g++) {
        for (int k = 0; k < study->goals[g].n_configurations; k++) {
            if (study->goals[g].configurations[k] == configuration) {
                return true;
            }
        }
    }
    return false;
}

const mt_unit *mt_study_unit(const mt_study *study, int parameter)
{
    const mt_parameter *const p = &study->model->parameters[parameter];
    const mt_unit *const si = mt_parameter_si(p);
    const mt_unit *const said = si == NULL ? NULL : study->units[si->dimension];
    const mt_unit *const unit = said == NULL ? p->written : said;
    return unit == NULL || mt_unit_is_si(unit) ? NULL : unit;
}

const mt_unit *mt_study_shown(const mt_study *study, mt_dimension dimension)
{
    const mt_unit *const unit = study->units[dimension];
    return unit == NULL          ? mt_model_shown(study->model, dimension)
           : mt_unit_is_si(unit) ? NULL
                                 : unit;
}

const mt_unit *mt_study_requirement_unit(const mt_study *study, const mt_expr *e)
{
    const mt_kind kind =
        e->length == 0 ? MT_KIND_UNKNOWN : mt_expr_kind(e, mt_model_kind, study->model).kind;
    for (int i = 0; i < e->length; i++) {
        const mt_unit *const unit =
            e->code[i].op == MT_OP_PARAM ? mt_study_unit(study, e->code[i].param) : NULL;
        const bool alone = e->length == 1; /* of whatever */
        if (unit != NULL && (alone || (unit->dimension != MT_OTHER &&
                                       mt_kind_of_dimension(unit->dimension) == kind))) {
            return unit;
        }
    }
    for (int d = 0; d < MT_DIMENSION_COUNT; d++) {
        const mt_unit *const unit = study->units[d];
        if (kind == mt_kind_of_dimension((mt_dimension)d) && unit != NULL &&
            !mt_unit_is_si(unit)) {
            return unit;
        }
    }
    return NULL;
}

const char *mt_study_goal_unit(const mt_study *study, const mt_goal *goal)
{
    const mt_unit *const other = mt_study_requirement_unit(study, &goal->expression);
    if (goal->response_limit != NULL) {
        return goal->response_limit->unit;
    }
    return other != NULL ? other->si : mt_goal_kind_of(goal->type)->unit;
}

int mt_study_find_reference(const mt_study *study, const char *name)
{
    for (int i = 0; i < study->n_references; i++) {
        if (strcmp(study->references[i].name.s, name) == 0) {
            return i;
        }
    }
    return MT_ABSENT;
}

mt_addr mt_study_member(const mt_study *study, mt_addr object, const char *member)
{
    return study->document == NULL
               ? object
               : mt_diag_member(mt_json_diags(study->document), object, member);
}

void mt_study_place_warning(const mt_study *study, mt_arena *mem, mt_warning *warning)
{
    mt_text pointer = {.s = NULL};
    if (study->document == NULL || warning->line != 0 || warning->addr == MT_NO_ADDR) {
        return;
    }
    mt_json_locate(study->document, warning->addr, &warning->line, &warning->column);
    mt_json_pointer(study->document, warning->addr, &pointer);
    warning->pointer = mt_arena_strdup(mem, pointer.s == NULL ? "" : pointer.s);
    if (pointer.failed) {
        mt_arena_fail(mem);
    }
    mt_text_free(&pointer);
}

bool mt_study_locate(const mt_study *study, const char *text, int *line, int *column)
{
    const mt_addr at = study->document == NULL || *text != '/'
                           ? MT_NO_ADDR
                           : mt_json_find(study->document, text, strcspn(text, ":"));
    if (at != MT_NO_ADDR) {
        mt_json_locate(study->document, at, line, column);
    }
    return at != MT_NO_ADDR;
}

mt_variable mt_variable_default(mt_addr addr)
{
    return (mt_variable){
        .parameter = MT_ABSENT,
        .lower = nan(""),
        .upper = nan(""),
        .weight = 1.0,
        .scale = nan(""),
        .range = nan(""),
        .tolerance_percent = nan(""),
        .original = nan(""),
        .addr = addr,
    };
}

mt_vary mt_vary_default(mt_vary_kind kind, mt_addr addr)
{
    return (mt_vary){
        .kind = kind,
        .variable = MT_ABSENT,
        .parameter = MT_ABSENT,
        .goal = MT_ABSENT,
        .addr = addr,
    };
}

mt_published mt_published_default(mt_published_kind kind, mt_addr addr)
{
    return (mt_published){
        .kind = kind,
        .parameter = MT_ABSENT,
        .configuration = MT_ABSENT,
        .mode = {.named = MT_ABSENT},
        .reference = MT_ABSENT,
        .value = nan(""),
        .tolerance = nan(""),
        .tolerance_percent = nan(""),
        .at_least = nan(""),
        .at_most = nan(""),
        .role = MT_ROLE_VERIFIES,
        .addr = addr,
    };
}

#define NAME_CASE(id, name) \
    case id:                \
        return name;

const char *mt_role_name(mt_role role)
{
    switch (role) {
        MT_ROLE_LIST(NAME_CASE)
    case MT_ROLE_COUNT:
        break;
    }
    return "unknown";
}

const char *mt_published_kind_name(mt_published_kind kind)
{
    switch (kind) {
        MT_PUBLISHED_LIST(NAME_CASE)
    case MT_PUBLISHED_KIND_COUNT:
        break;
    }
    return "unknown";
}

bool mt_study_is_fit(const mt_study *study)
{
    bool fit = study->n_goals > 0 && study->n_objectives > 0 &&
               mt_objective_is(study->objectives[0].type, MT_RESIDUALS);
    for (int i = 0; i < study->n_goals; i++) {
        fit = fit && MT_HAS(study->goals[i].weight);
    }
    return fit;
}

/* a study that was interrupted says nothing that could be published */
#define STATUS_NAME(id, name) name,
const char *const mt_study_status_names[] = {MT_RESULT_STATUS_LIST(STATUS_NAME)};

const char *mt_search_budget(const mt_search *s)
{
    return s->by_solutions ? "max_modal_solutions" : "max_evaluations";
}
