/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/read_study_priv.h"

#define VARIABLE_KEYS(X)                                             \
    X(VARIABLE_PARAMETER, "parameter", MT_KEY_TEXT, true)            \
    X(VARIABLE_LOWER, "lower", MT_KEY_NUMBER, false)                 \
    X(VARIABLE_UPPER, "upper", MT_KEY_NUMBER, false)                 \
    X(VARIABLE_CATALOGUE, "catalogue", MT_KEY_LIST, false)           \
    X(VARIABLE_WEIGHT, "weight", MT_KEY_NUMBER, false)               \
    X(VARIABLE_SCALE, "scale", MT_KEY_NUMBER, false)                 \
    X(VARIABLE_TOLERANCE, "tolerance_percent", MT_KEY_NUMBER, false) \
    X(VARIABLE_DESCRIPTION, "description", MT_KEY_TEXT, false)       \
    X(VARIABLE_SOURCE, "source", MT_KEY_TEXT, false)
enum { VARIABLE_KEYS(MT_STUDY_KEY_ENUM) VARIABLE_KEY_COUNT };
static const mt_key KEYS[] = {VARIABLE_KEYS(MT_STUDY_KEY)};
const mt_key_table mt_study_variable_keys = {"variable", KEYS, VARIABLE_KEY_COUNT};

static void read_catalogue(mt_study_reader *s, mt_addr list, mt_variable *v)
{
    if (list == MT_NO_ADDR) {
        return;
    }
    if (mt_json_count(s->r.doc, list) == 0) {
        mt_diag_structure(s->r.diags, list, "the catalogue is empty");
    }
    v->catalogue = mt_read_study_list(s, list, sizeof *v->catalogue);
    if (v->catalogue == NULL) {
        return;
    }
    for (mt_addr at = mt_json_first(s->r.doc, list); at != MT_NO_ADDR;
         at = mt_json_next(s->r.doc, at)) {
        const double value = mt_read_study_number(s, at);
        if (MT_HAS(value)) {
            v->catalogue[v->n_catalogue++] = value;
        }
    }
}

static void read_variable(mt_study_reader *s, mt_addr value, mt_variable *v)
{
    mt_study_object o;
    *v = mt_variable_default(value);
    if (!mt_read_study_object(s, value, &mt_study_variable_keys, &o)) {
        return;
    }
    v->parameter_name = mt_reader_ref(&s->r, o.found[VARIABLE_PARAMETER]);
    v->lower = mt_read_study_member(s, &o, VARIABLE_LOWER, &v->lower_addr);
    v->upper = mt_read_study_member(s, &o, VARIABLE_UPPER, &v->upper_addr);
    v->catalogue_addr = mt_read_study_place(s, &o, VARIABLE_CATALOGUE);
    read_catalogue(s, o.found[VARIABLE_CATALOGUE], v);
    const double weight = mt_read_study_member(s, &o, VARIABLE_WEIGHT, &v->weight_addr);
    v->weight = MT_HAS(weight) ? weight : v->weight;
    v->scale = mt_read_study_member(s, &o, VARIABLE_SCALE, &v->scale_addr);
    v->tolerance_percent = mt_read_study_member(s, &o, VARIABLE_TOLERANCE, &v->tolerance_addr);
}

void mt_read_study_variables(mt_study_reader *s, mt_addr list)
{
    mt_study *const study = s->study;
    study->variables = mt_read_study_list(s, list, sizeof *study->variables);
    if (list == MT_NO_ADDR || study->variables == NULL) {
        return;
    }
    for (mt_addr at = mt_json_first(s->r.doc, list); at != MT_NO_ADDR;
         at = mt_json_next(s->r.doc, at)) {
        if (mt_reader_type(&s->r, at, MT_KEY_OBJECT)) {
            read_variable(s, at, &study->variables[study->n_variables++]);
        }
    }
}
