/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/read_units.h"

#include "base/format.h"

const char *const mt_length_names[MT_LENGTH_NAMES] = {"m", "mm", "cm", "in", "ft"};
const char *const mt_angle_names[MT_ANGLE_NAMES] = {"rad", "deg"};
const char *const mt_speed_names[MT_SPEED_NAMES] = {"Hz", "rpm"};

/* The unit of a dimension that the text names; NULL where absent or wrong (noted). */
static const mt_unit *read_unit(mt_reader *r, mt_addr value, mt_dimension dimension)
{
    int n = 0;
    const mt_unit *const all = mt_units(&n);
    const char *names[MT_MAX_KEYS] = {NULL};
    int n_names = 0;
    const char *const text = value == MT_NO_ADDR ? NULL : mt_json_string(r->doc, value);
    const mt_unit *const meant = text == NULL ? NULL : mt_unit_find(text);
    for (int i = 0; i < n; i++) {
        if (all[i].dimension == dimension && mt_unit_is_common(&all[i])) {
            names[n_names++] = all[i].name;
        }
    }
    if (meant != NULL && !mt_unit_is_common(meant)) {
        mt_diag_structure(
            r->diags, value,
            "\"%s\" is a unit of a parameter's number only: write \"%s\" or \"%s\"", text,
            names[0], names[1]);
        return NULL;
    }
    if (meant != NULL && meant->dimension != dimension) {
        mt_diag_structure(r->diags, value,
                          "\"%s\" is a unit of %s, not of %s: write \"%s\" or \"%s\"", text,
                          mt_dimension_text(meant->dimension), mt_dimension_text(dimension),
                          names[0], names[1]);
        return NULL;
    }
    char what[MT_KIND_TEXT];
    (void)mt_snprintf(what, sizeof what, "unit of %s", mt_dimension_text(dimension));
    const int which = mt_reader_choice(r, value, what, names, n_names);
    return which == MT_ABSENT ? NULL : mt_unit_find(names[which]);
}

void mt_read_units(mt_reader *r, mt_addr value, const mt_key_table *table,
                   const mt_unit *units[MT_DIMENSION_COUNT])
{
    mt_addr at[MT_DIMENSION_COUNT];
    (void)mt_reader_object(r, value, table, at);
    for (int d = 0; d < MT_DIMENSION_COUNT; d++) {
        units[d] = read_unit(r, at[d], (mt_dimension)d);
    }
}

bool mt_reader_expr_in(mt_reader *r, mt_addr value, const mt_unit *unit, mt_expr *out)
{
    if (unit == NULL || value == MT_NO_ADDR ||
        mt_json_type_of(r->doc, value) != MT_JSON_NUMBER) {
        return mt_reader_expr(r, value, out);
    }
    const double number = mt_unit_to_si(unit, mt_json_number(r->doc, value));
    if (mt_expr_number(number, r->mem, out, NULL) != MT_OK) {
        *out = (mt_expr){0};
        return false;
    }
    return true;
}

void mt_reader_check_kind(mt_reader *r, mt_addr value, const mt_expr *e, const mt_unit *unit)
{
    char text[MT_KIND_TEXT];
    if (value != MT_NO_ADDR && e->length > 0 && r->kinds != NULL &&
        mt_json_type_of(r->doc, value) == MT_JSON_STRING &&
        mt_kind_complaint(e, unit, r->kinds, r->context, text, sizeof text)) {
        mt_diag_error(r->diags, value, "%s", text);
    }
}
