/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numbers of a study that are values of the model's parameters, or are held against
 * expressions of them: in which unit they are. */
#include "study/read_priv.h"

#include <math.h>

#include "io/read_units.h"

static int parameter_of(const mt_study_reader *s, const char *name)
{
    const mt_model *const m = s->study->model;
    return m == NULL || name == NULL ? MT_ABSENT : mt_model_find_parameter(m, name);
}

const mt_unit *mt_read_study_unit(const mt_study_reader *s, const char *parameter)
{
    const int p = parameter_of(s, parameter);
    return p == MT_ABSENT ? NULL : mt_study_unit(s->study, p);
}

static bool is_bare(const mt_study_reader *s, mt_addr value)
{
    return value != MT_NO_ADDR && mt_json_type_of(s->r.doc, value) == MT_JSON_NUMBER &&
           mt_json_number(s->r.doc, value) != 0.0;
}

/* True where the study gives units other than SI. */
static bool says_units(const mt_study *study)
{
    bool says = false;
    for (int d = 0; d < MT_DIMENSION_COUNT; d++) {
        says = says || (study->units[d] != NULL && !mt_unit_is_si(study->units[d]));
    }
    return says;
}

/* Note a bare number for a parameter of unknown unit: it is not known whether the study's units
 * apply to it. */
static void check_known(mt_study_reader *s, mt_addr value, int parameter)
{
    const mt_parameter *const p = &s->study->model->parameters[parameter];
    if (p->unit == NULL && says_units(s->study) && is_bare(s, value)) {
        mt_diag_error(s->r.diags, value,
                      "the model does not say which unit \"%s\" has, so that it is not known "
                      "whether \"units\" hold for this number: say it there (\"1\": none), or "
                      "write the number as an expression, \"%.10g\", which is in SI units",
                      p->name.s, mt_json_number(s->r.doc, value));
    }
}

double mt_read_study_value(mt_study_reader *s, mt_addr value, const char *parameter)
{
    const int p = parameter_of(s, parameter);
    const double number = mt_read_study_number(s, value);
    if (p == MT_ABSENT || !MT_HAS(number)) {
        return number;
    }
    const mt_unit *const unit = mt_study_unit(s->study, p);
    if (mt_json_type_of(s->r.doc, value) == MT_JSON_NUMBER) {
        check_known(s, value, p);
        return mt_unit_to_si(unit, number);
    }
    mt_expr e = {0};
    if (mt_reader_expr(&s->r, value, &e)) {
        mt_reader_check_kind(&s->r, value, &e, unit);
    }
    return number;
}

void mt_read_study_check_requirement(mt_study_reader *s, const mt_expr *of, mt_addr value)
{
    const mt_unit *const unit =
        s->study->model == NULL ? NULL : mt_study_requirement_unit(s->study, of);
    if (unit == NULL || value == MT_NO_ADDR) {
        return;
    }
    if (is_bare(s, value)) {
        char text[MT_KIND_TEXT];
        mt_kind_bare_text(mt_json_number(s->r.doc, value), unit,
                          "expressions and what they are held against", text, sizeof text);
        mt_diag_error(s->r.diags, value, "%s", text);
        return;
    }
    mt_expr e = {0};
    if (mt_json_type_of(s->r.doc, value) == MT_JSON_STRING &&
        mt_reader_expr(&s->r, value, &e)) {
        mt_reader_check_kind(&s->r, value, &e, unit);
    }
}
