/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune sensitivity: how far one per cent more of a parameter moves each frequency. */

#include "base/format.h"
#include "cli/sensitivity_table.h"
#include "report/table.h"

enum { DEFAULT_MODES = 6, DIGITS = 4, HZ_DIGITS = 6, HEADING_TEXT = 40, NAME_TEXT = 128 };

static const char *parameter_si_unit(const mt_sensitivity_table *v, int k)
{
    return v->s->model->parameters[v->parameter[k]].unit;
}

/* The unit in which its value is shown; NULL: SI. */
static const mt_unit *shown_parameter_unit(const mt_sensitivity_table *v, int k)
{
    return v->s->model->parameters[v->parameter[k]].written;
}

static const char *parameter_name(const mt_sensitivity_table *v, int k)
{
    return v->s->model->parameters[v->parameter[k]].name.s;
}

static bool has_none(const mt_sensitivity_table *v, int k)
{
    return v->independence[k].opens || v->independence[k].blocks;
}

static void json_no_derivatives(mt_json_writer *w, const mt_sensitivity_table *v)
{
    mt_json_open(w, "no_derivatives", '[');
    for (int k = 0; k < v->n; k++) {
        if (has_none(v, k)) {
            mt_json_open(w, NULL, '{');
            mt_json_put_string(w, "parameter", parameter_name(v, k));
            mt_json_put_string(w, "reason",
                               v->independence[k].opens ? "opens_joints" : "blocks_motion");
            mt_cli_json_joints(w, "joints", &v->independence[k].joints);
            mt_json_close(w);
        }
    }
    mt_json_close(w);
}

static void write_sensitivity_json(mt_json_writer *w, const mt_sensitivity_table *v)
{
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "configuration", mt_loaded_model_configuration(v->s, v->c));
    mt_json_put_string(w, "method", mt_cli_method(v->way));
    mt_json_open(w, "modes", '[');
    for (int i = 0; i < v->modes; i++) {
        mt_json_open(w, NULL, '{');
        mt_json_put_integer(w, "index", i + 1);
        mt_json_put_number(w, "frequency_hz", v->hz[i]);
        mt_json_put_bool(w, "repeated", v->repeated[i]);
        mt_json_open(w, "sensitivities", '[');
        for (int k = 0; k < v->n; k++) {
            mt_json_open(w, NULL, '{');
            mt_json_put_string(w, "parameter", parameter_name(v, k));
            mt_json_put_string(w, "unit", parameter_si_unit(v, k));
            mt_json_put_number(w, "value", v->value[k]);
            mt_json_put_number(w, "hz_per_percent", mt_sensitivity_table_per_percent(v, i, k));
            mt_json_put_number(w, "hz_per_unit", v->per_unit[i + ((ptrdiff_t)k * v->room)]);
            mt_json_close(w);
        }
        mt_json_close(w);
        mt_json_close(w);
    }
    mt_json_close(w);
    json_no_derivatives(w, v);
    mt_json_close(w);
}

static mt_table csv_table(void)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, "configuration", "configuration", MT_ALIGN_LEFT);
    mt_table_column(&t, "mode", "index", MT_ALIGN_RIGHT);
    mt_table_column(&t, "frequency [Hz]", "frequency_hz", MT_ALIGN_POINT);
    mt_table_column(&t, "repeated", "repeated", MT_ALIGN_LEFT);
    mt_table_column(&t, "parameter", "parameter", MT_ALIGN_LEFT);
    mt_table_column(&t, "value", "value", MT_ALIGN_POINT);
    mt_table_column(&t, "Hz per %", "hz_per_percent", MT_ALIGN_POINT);
    mt_table_column(&t, "Hz per unit", "hz_per_unit", MT_ALIGN_POINT);
    mt_table_column(&t, "unit", "unit", MT_ALIGN_LEFT);
    return t;
}

static void fill_csv(mt_table *t, const mt_sensitivity_table *v)
{
    for (int i = 0; i < v->modes; i++) {
        for (int k = 0; k < v->n; k++) {
            mt_table_text(t, mt_loaded_model_configuration(v->s, v->c));
            mt_table_integer(t, i + 1);
            mt_table_number(t, v->hz[i], HZ_DIGITS);
            mt_table_text(t, v->repeated[i] ? "true" : "false");
            mt_table_text(t, parameter_name(v, k));
            mt_table_number(t, v->value[k], HZ_DIGITS);
            mt_table_number(t, mt_sensitivity_table_per_percent(v, i, k), DIGITS);
            mt_table_number(t, v->per_unit[i + ((ptrdiff_t)k * v->room)], DIGITS);
            mt_table_text(t, parameter_si_unit(v, k));
        }
    }
}

static void write_notes(mt_text *out, const mt_sensitivity_table *v, bool repeated,
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
        if (has_none(v, k)) {
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

static void write_sensitivity_text(mt_text *out, const mt_sensitivity_table *v)
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
        const bool percent = mt_sensitivity_table_has_percent(v, k);
        char name[NAME_TEXT];
        (void)mt_snprintf(name, sizeof name, "%s (1 mm)", parameter_name(v, k));
        mt_table_text(&t, percent ? parameter_name(v, k) : name);
        coordinates = coordinates || !percent;
        mt_table_number(&t, mt_unit_from_si(shown_parameter_unit(v, k), v->value[k]),
                        HZ_DIGITS);
        mt_table_text(&t, mt_unit_name(shown_parameter_unit(v, k), parameter_si_unit(v, k)));
        for (int i = 0; i < v->modes; i++) {
            mt_table_change(&t, mt_sensitivity_table_shown(v, i, k), DIGITS);
        }
        overridden = overridden || v->overridden[k];
    }
    mt_text_addf(out, "%s: Hz for one per cent more of each parameter, by mode\n",
                 mt_loaded_model_configuration(v->s, v->c));
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_table_free(&t);
    write_notes(out, v, repeated, coordinates, overridden);
}

/* One configuration; *wrong: true where unknown parameters were requested. */
static mt_status show_configuration_slopes(const mt_args *args, const mt_loaded_model *s, int c,
                                           mt_json_writer *w, mt_table *t, mt_text *out,
                                           bool *wrong, mt_err *err)
{
    mt_sensitivity_table v = {.s = NULL};
    const int modes = args->count > 0 ? args->count : DEFAULT_MODES;
    const mt_status rc =
        mt_sensitivity_table_take(s, c, args->value[MT_OPT_PARAMETERS], modes, &v, err);
    if (rc == MT_OK) {
        switch (args->format) {
        case MT_FORMAT_JSON:
            write_sensitivity_json(w, &v);
            break;
        case MT_FORMAT_CSV:
            fill_csv(t, &v);
            break;
        case MT_FORMAT_HTML:  /* of report alone */
        case MT_FORMAT_SARIF: /* of check alone */
        case MT_FORMAT_TEXT:
            write_sensitivity_text(out, &v);
            mt_loaded_model_note_links(s, c, out);
            break;
        }
    }
    *wrong = rc == MT_E_USAGE && v.value == NULL;
    mt_sensitivity_table_free(&v);
    return rc;
}

int mt_cmd_sensitivity(const mt_args *args, mt_text *out)
{
    mt_loaded_model s = {.model = NULL};
    mt_json_writer w = mt_json_writer_default(out);
    mt_table t = csv_table();
    const bool json = args->format == MT_FORMAT_JSON;
    const bool list = json && !args->given[MT_OPT_CONFIGURATION];
    int code =
        mt_loaded_model_load(args, args->operands[0], args->value[MT_OPT_CONFIGURATION], &s);
    if (code != MT_EXIT_DONE) {
        goto done;
    }
    if (list) {
        mt_json_open(&w, NULL, '[');
    }
    for (int i = 0; i < s.n_configurations; i++) {
        mt_err err = {.code = MT_OK};
        mt_loaded_model_warn_overridden(&s, s.configurations[i]);
        bool wrong = false;
        const mt_status rc =
            show_configuration_slopes(args, &s, s.configurations[i], &w, &t, out, &wrong, &err);
        if (rc != MT_OK) {
            code = mt_exit_worse(code, mt_cli_failed(rc, &err));
        }
        if (wrong) {
            break; /* the same for every configuration */
        }
        if (rc != MT_OK && json) {
            mt_cli_json_failed(&w, mt_loaded_model_configuration(&s, s.configurations[i]),
                               &err);
        }
    }
    if (list) {
        mt_json_close(&w);
    }
    if (json && w.out->length > 0) {
        code = mt_exit_worse(code, mt_cli_json_done(&w));
    }
    if (args->format == MT_FORMAT_CSV) {
        mt_table_csv(&t, out);
    }
done:
    mt_table_free(&t);
    mt_loaded_model_free(&s);
    return code;
}
