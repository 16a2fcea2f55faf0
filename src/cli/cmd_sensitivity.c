/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune sensitivity: how far one per cent more of a parameter moves each frequency. */
#include <string.h>

#include "base/format.h"
#include "base/number.h"
#include "cli/cli.h"
#include "inspect/sensitivity.h"
#include "report/table.h"

enum { DIGITS = 4, HZ_DIGITS = 6, HEADING_TEXT = 40, NAME_TEXT = 128 };

static const double MILLIMETRE = 1e-3;

static const char *parameter_name(const mt_sensitivity_view *v, int k)
{
    return v->s->model->parameters[v->parameter[k]].name.s;
}

/* True where the change for 1 % more of parameter k is shown. For a coordinate at or below 0 it
 * is that for 1 mm more. */
static bool has_percent(const mt_sensitivity_view *v, int k)
{
    const char *const unit = v->s->model->parameters[v->parameter[k]].unit;
    return v->value[k] > 0.0 || unit == NULL || strcmp(unit, "m") != 0;
}

/* The shown change [Hz], with rounding as 0. */
static double sensitivity_shown(const mt_sensitivity_view *v, int i, int k)
{
    const double per_unit = v->per_unit[i + ((ptrdiff_t)k * v->room)];
    const double more =
        has_percent(v, k) ? mt_slope_row_of(v, i, k).hz_per_percent : MILLIMETRE * per_unit;
    return mt_without_noise(more, MT_SLOPE_NOISE * v->hz[i]);
}

/* The unit in which its value is shown; NULL: SI. */
static const mt_unit *shown_parameter_unit(const mt_sensitivity_view *v, int k)
{
    return v->s->model->parameters[v->parameter[k]].written;
}

#define THIS mt_slope_row
static const mt_record_column slope_columns[] = {
    MT_R_COLUMN(parameter, "parameter", 0, MT_IN_CSV),
    MT_R_COLUMN(value, "value", HZ_DIGITS, MT_IN_CSV),
    MT_R_COLUMN(hz_per_percent, "Hz per %", DIGITS, MT_IN_CSV),
    MT_R_COLUMN(hz_per_unit, "Hz per unit", DIGITS, MT_IN_CSV),
    MT_R_COLUMN(unit, "unit", 0, MT_IN_CSV),
};
static const mt_record_table slope_rows = MT_R_TABLE_OF(mt_slope_record, slope_columns);
#undef THIS

#define THIS mt_sensitive_mode_row
static const mt_record_column mode_columns[] = {
    MT_R_COLUMN(index, "mode", 0, MT_IN_CSV),
    MT_R_COLUMN(hz, "frequency [Hz]", HZ_DIGITS, MT_IN_CSV),
    MT_R_COLUMN(repeated, "repeated", 0, MT_IN_CSV),
};
static const mt_record_table mode_rows = MT_R_TABLE_OF(mt_sensitive_mode_record, mode_columns);
#undef THIS

static mt_table csv_table(void)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, "configuration", "configuration", MT_ALIGN_LEFT);
    mt_table_record_columns(&t, &mode_rows, MT_IN_CSV);
    mt_table_record_columns(&t, &slope_rows, MT_IN_CSV);
    return t;
}

static void fill_csv(mt_table *t, const mt_sensitivity_view *v)
{
    for (int i = 0; i < v->modes; i++) {
        const mt_sensitive_mode_row mode = mt_sensitive_mode_row_of(v, i);
        for (int k = 0; k < v->n; k++) {
            const mt_slope_row row = mt_slope_row_of(v, i, k);
            mt_table_text(t, mt_loaded_model_configuration(v->s, v->c));
            mt_table_record_row(t, &mode_rows, MT_IN_CSV, &mode);
            mt_table_record_row(t, &slope_rows, MT_IN_CSV, &row);
        }
    }
}

static void write_notes(mt_text *out, const mt_sensitivity_view *v, bool repeated,
                        bool coordinates, bool overridden)
{
    if (coordinates) {
        mt_text_add(out,
                    "  (1 mm): for one millimetre more; of a coordinate at or below 0 one per "
                    "cent means nothing.\n");
    }
    if (repeated) {
        mt_text_add(out,
                    "  * Repeated modes: none of them has a derivative of its own; these are "
                    "the values along\n    the directions into which each parameter splits "
                    "them, lowest first.\n");
    }
    for (int k = 0; k < v->n; k++) {
        if (mt_sensitivity_has_none(v, k)) {
            mt_text_addf(out, "  No derivative by %s: joints %s %s.\n", parameter_name(v, k),
                         v->independence[k].joints.text,
                         v->independence[k].opens
                             ? "could not stay closed at any other value"
                             : "are redundant at this value only and block a motion at any "
                               "other");
        }
    }
    if (overridden) {
        mt_text_add(out,
                    "  Parameters with a value of this configuration's own have no influence "
                    "here.\n");
    }
    if (v->way != MT_LOWEST_NONE) {
        mt_text_addf(out, "  The lowest modes of %s of %d bodies (%s).\n",
                     v->way == MT_LOWEST_TREE ? "a tree" : "a mechanism", v->bodies,
                     v->way == MT_LOWEST_TREE ? "joint coordinates" : "sparse factor");
    }
    if (v->unstable > 0) {
        mt_text_add(out, "  UNSTABLE: this position does not hold.\n");
    }
    mt_text_add(out, "\n");
}

static void write_sensitivity_text(mt_text *out, const mt_sensitivity_view *v)
{
    mt_table t = mt_table_default();
    bool repeated = false;
    bool overridden = false;
    bool coordinates = false;
    mt_table_column(&t, "parameter", "parameter", MT_ALIGN_LEFT);
    mt_table_column(&t, "value", "value", MT_ALIGN_POINT);
    mt_table_column(&t, "unit", "unit", MT_ALIGN_LEFT);
    for (int i = 0; i < v->modes; i++) {
        char heading[HEADING_TEXT];
        (void)mt_snprintf(heading, sizeof heading, "%d%s (%.5g Hz)", i + 1,
                          v->repeated[i] ? "*" : "", v->hz[i]);
        mt_table_column(&t, heading, heading, MT_ALIGN_POINT);
        repeated = repeated || v->repeated[i];
    }
    for (int k = 0; k < v->n; k++) {
        const bool percent = has_percent(v, k);
        char name[NAME_TEXT];
        (void)mt_snprintf(name, sizeof name, "%s (1 mm)", parameter_name(v, k));
        mt_table_text(&t, percent ? parameter_name(v, k) : name);
        coordinates = coordinates || !percent;
        mt_table_number(&t, mt_unit_from_si(shown_parameter_unit(v, k), v->value[k]),
                        HZ_DIGITS);
        mt_table_text(&t, mt_unit_name(shown_parameter_unit(v, k),
                                       v->s->model->parameters[v->parameter[k]].unit));
        for (int i = 0; i < v->modes; i++) {
            mt_table_change(&t, sensitivity_shown(v, i, k), DIGITS);
        }
        overridden = overridden || v->overridden[k];
    }
    mt_text_addf(out, "%s: Hz for one per cent more of each parameter, by mode\n",
                 mt_loaded_model_configuration(v->s, v->c));
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_table_free(&t);
    write_notes(out, v, repeated, coordinates, overridden);
}

typedef struct sink {
    const mt_args *args;
    mt_sensitivity_question question;
    mt_text *out;
    mt_json_writer w;
    mt_table table; /* CSV */
} sink;

static mt_status show_configuration_slopes(void *context, mt_loaded_model *s, int c,
                                           mt_cli_shown *shown, mt_err *err)
{
    (void)shown;
    sink *const to = context;
    mt_sensitivity_view v = {.s = NULL};
    mt_status rc = mt_sensitivity_view_take(s, c, &to->question, &v, err);
    if (rc == MT_OK) {
        switch (to->args->format) {
        case MT_FORMAT_JSON:
            rc = mt_sensitivity_put(&v, &to->w, err);
            break;
        case MT_FORMAT_CSV:
            fill_csv(&to->table, &v);
            break;
        case MT_FORMAT_HTML:  /* of report alone */
        case MT_FORMAT_SARIF: /* of check alone */
        case MT_FORMAT_TEXT:
            write_sensitivity_text(to->out, &v);
            mt_loaded_model_note_links(s, c, to->out);
            break;
        }
    }
    mt_sensitivity_view_free(&v);
    return rc;
}

static int run_sensitivity(const mt_args *args, mt_text *out)
{
    mt_loaded_model s = {.model = NULL};
    mt_err err = {.code = MT_OK};
    sink to = {.args = args,
               .question = {.parameters = args->value[MT_OPT_PARAMETERS],
                            .modes = args->count > 0 ? args->count : MT_SENSITIVITY_MODES},
               .out = out,
               .w = mt_json_writer_default(out),
               .table = csv_table()};
    int code =
        mt_loaded_model_load(args, args->operands[0], args->value[MT_OPT_CONFIGURATION], &s);
    if (code != MT_EXIT_DONE) {
        goto done;
    }
    const mt_status rc = mt_sensitivity_question_admit(&s, &to.question, &err);
    if (rc != MT_OK) {
        code = mt_cli_failed(rc, &err);
        goto done;
    }
    code = mt_cli_each(args, &s, &to.w, show_configuration_slopes, &to);
    if (args->format == MT_FORMAT_CSV) {
        mt_table_csv(&to.table, out);
    }
done:
    mt_table_free(&to.table);
    mt_loaded_model_free(&s);
    return code;
}

const mt_command mt_command_sensitivity = {
    .name = "sensitivity",
    .operands = "MODEL",
    .least = 1,
    .most = 1,
    .summary = "change of each frequency per per cent of each parameter",
    .details = "Prints exact derivatives of the first natural frequencies (default: 6): the "
               "change in Hz for 1 % more of a parameter. Repeated modes have directional "
               "derivatives, given as a set.",
    .answer = {&mt_sensitivity_record, MT_ANSWER_CONFIGURATIONS},
    .run = run_sensitivity,
};
