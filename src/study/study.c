/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/study.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "io/json.h"

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

const char *mt_search_budget(const mt_search *s)
{
    return s->by_solutions ? "max_modal_solutions" : "max_evaluations";
}

/* What users of the library read. */

static const mt_variable *variable(const mt_study *study, int i)
{
    return study != NULL && i >= 0 && i < study->n_variables ? &study->variables[i] : NULL;
}

const char *mt_study_title(const mt_study *study)
{
    return study == NULL ? NULL : study->name;
}

const mt_model *mt_study_model(const mt_study *study)
{
    return study == NULL ? NULL : study->model;
}

int mt_study_variable_count(const mt_study *study)
{
    return study == NULL ? 0 : study->n_variables;
}

const char *mt_study_variable_name(const mt_study *study, int i)
{
    const mt_variable *const v = variable(study, i);
    return v == NULL ? NULL : v->parameter_name.s;
}

double mt_study_variable_original(const mt_study *study, int i)
{
    const mt_variable *const v = variable(study, i);
    return v == NULL ? nan("") : v->original;
}

double mt_study_variable_lower(const mt_study *study, int i)
{
    const mt_variable *const v = variable(study, i);
    return v == NULL ? nan("") : v->n_catalogue > 0 ? v->catalogue[0] : v->lower;
}

double mt_study_variable_upper(const mt_study *study, int i)
{
    const mt_variable *const v = variable(study, i);
    return v == NULL            ? nan("")
           : v->n_catalogue > 0 ? v->catalogue[v->n_catalogue - 1]
                                : v->upper;
}
