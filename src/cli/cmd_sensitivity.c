/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A parameter that is made of others ("EI": "E*I") must not be an input together with them, or
 * it would no longer follow: it gets an analysis of its own.
 */
#include <string.h>

#include "analysis/analysis.h"
#include "base/format.h"
#include "base/number.h"
#include "cli/cli.h"
#include "mechanics/products.h"
#include "model/values.h"
#include "report/table.h"

/*
 * The sensitivities of the frequencies of one configuration to parameters: exact derivatives of
 * the first vibration modes. A single repeated mode has no derivative; directional values are
 * given instead (eigenvalues of Y^T (dK - lambda dM) Y over the cluster), ascending.
 */
typedef struct sensitivity_table {
    const mt_loaded_model *s;
    int c;
    mt_arena mem;
    mt_lowest_method way; /* NONE: by all modes */
    int bodies;           /* else */
    int n;                /* parameters */
    int *parameter;       /* [n] */
    double *value;        /* [n] in this configuration */
    bool *overridden;     /* [n] overridden by the configuration: no influence */
    int modes;            /* number of vibration modes */
    int unstable;         /* unstable modes of the configuration */
    int *position;        /* [modes] */
    double *hz;           /* [modes] */
    bool *repeated;       /* [modes] */
    int room;             /* leading dimension of per_unit */
    /* room x n: Hz per unit of the parameter; NaN where it has no derivative */
    double *per_unit;
    mt_independence *independence; /* [n] reason for no derivative */
} sensitivity_table;

static const double PER_CENT = 0.01;
static const double MILLIMETRE = 1e-3;

static bool is_overridden(const sensitivity_table *v, int parameter)
{
    const mt_configuration *const conf = &v->s->model->configurations[v->c];
    for (int k = 0; k < conf->n_overrides; k++) {
        if (conf->overrides[k].parameter == parameter) {
            return true;
        }
    }
    return false;
}

/* Choose the modes once; later analyses use the same ones. */
static mt_status choose_modes(sensitivity_table *v, const mt_modes *m, int wanted, mt_err *err)
{
    if (v->position != NULL) {
        return MT_OK;
    }
    const size_t most = (size_t)m->count;
    v->room = m->count;
    v->unstable = m->n_unstable;
    v->position = mt_arena_int(&v->mem, most);
    v->hz = mt_arena_f64(&v->mem, most, 1);
    v->repeated = mt_arena_alloc(&v->mem, most, sizeof *v->repeated);
    v->per_unit = mt_arena_f64(&v->mem, most, (size_t)v->n);
    MT_TRY(mt_arena_check(&v->mem, err));
    for (int i = 0; i < m->count && v->modes < wanted; i++) {
        int size = 1;
        if (m->kind[i] == MT_MODE_FLEXIBLE) {
            (void)mt_modal_cluster(m, i, &size);
            v->position[v->modes] = i;
            v->hz[v->modes] = mt_modal_hz(m, i);
            v->repeated[v->modes] = size > 1;
            v->modes++;
        }
    }
    return MT_OK;
}

/* Parameters of the survey to look at together, beside the inputs of --set. */
typedef struct question {
    int wanted; /* modes */
    int n;
    const int *entry; /* [n] of the survey */
    int *slot;        /* [n] input of each */
    int count;        /* inputs */
    int *inputs;
    double *at;
} question;

static mt_status list_question_inputs(sensitivity_table *v, question *q, mt_err *err)
{
    const mt_loaded_model *const s = v->s;
    const size_t room = (size_t)s->n_inputs + (size_t)q->n;
    q->inputs = mt_arena_int(&v->mem, room);
    q->slot = mt_arena_int(&v->mem, room);
    q->at = mt_arena_f64(&v->mem, room, 1);
    MT_TRY(mt_arena_check(&v->mem, err));
    for (int i = 0; i < s->n_inputs; i++) {
        q->inputs[q->count] = s->inputs[i];
        q->at[q->count++] = s->at[i];
    }
    for (int i = 0; i < q->n; i++) {
        const int parameter = v->parameter[q->entry[i]];
        q->slot[i] = q->count;
        for (int k = 0; k < s->n_inputs; k++) {
            q->slot[i] = s->inputs[k] == parameter ? k : q->slot[i];
        }
        if (q->slot[i] == q->count) {
            q->inputs[q->count] = parameter;
            q->at[q->count++] = v->value[q->entry[i]];
        }
    }
    return MT_OK;
}

static mt_status answer_by_all(sensitivity_table *v, const question *q, mt_err *err)
{
    mt_analysis *a = NULL;
    mt_analysis_options opt = mt_analysis_options_default();
    opt.gradient = true;
    opt.modes.first = q->wanted;
    const mt_system_def def = mt_loaded_model_system(v->s, v->c, q->count, q->inputs, q->at);
    mt_status rc = mt_analysis_new_of(&def, q->wanted, &a, err);
    rc = rc == MT_OK ? mt_analysis_solve(a, q->at, &opt, err) : rc;
    rc = rc == MT_OK ? choose_modes(v, &a->modes, q->wanted, err) : rc;
    for (int i = 0; rc == MT_OK && i < q->n; i++) {
        rc = mt_analysis_sensitivity(a, q->slot[i], v->modes, v->position, &v->mem,
                                     v->per_unit + ((ptrdiff_t)q->entry[i] * v->room),
                                     &v->independence[q->entry[i]], err);
    }
    mt_analysis_delete(a);
    return mt_err_in(err, rc, "%s", v->s->path);
}

/* *done false: the method is not available. */
static mt_status answer_by_lowest(sensitivity_table *v, const question *q, bool *done,
                                  mt_err *err)
{
    char why[MT_TREE_WHY] = "";
    const mt_lowest_want want = {.count = q->wanted, .shapes = true, .drawn = true};
    mt_lowest *l = NULL;
    double *slope = NULL;
    mt_status rc =
        mt_loaded_model_lowest(v->s, v->c, q->count, q->inputs, q->at, want, &l, err);
    *done = rc == MT_OK && l != NULL;
    if (!*done) {
        return rc;
    }
    rc = choose_modes(v, &l->found.modes, q->wanted, err);
    if (rc == MT_OK) {
        slope = mt_arena_f64(&v->mem, (size_t)v->modes, (size_t)q->count);
        rc = mt_arena_check(&v->mem, err);
    }
    rc = rc == MT_OK ? mt_lowest_sensitivity(l, v->modes, slope, why, err) : rc;
    *done = why[0] == '\0';
    v->way = *done ? l->way : MT_LOWEST_NONE;
    v->bodies = l->sys->n_bodies;
    for (int i = 0; rc == MT_OK && *done && i < q->n; i++) {
        memcpy(v->per_unit + ((ptrdiff_t)q->entry[i] * v->room),
               slope + ((ptrdiff_t)q->slot[i] * v->modes), (size_t)v->modes * sizeof *slope);
    }
    mt_lowest_delete(l);
    rc = mt_err_in(err, rc, "%s", v->s->path);
    return rc == MT_OK && !*done ? mt_loaded_model_admit_dense(v->s, v->c, why, err) : rc;
}

static mt_status analyse(sensitivity_table *v, int n, const int *entry, int wanted, mt_err *err)
{
    question q = {.wanted = wanted, .n = n, .entry = entry};
    bool done = false;
    MT_TRY(list_question_inputs(v, &q, err));
    MT_TRY(answer_by_lowest(v, &q, &done, err));
    return done ? MT_OK : answer_by_all(v, &q, err);
}

/* What the parameters are in this configuration, its own overrides included. */
static mt_status find_values(sensitivity_table *v, mt_err *err)
{
    const mt_loaded_model *const s = v->s;
    double *const all = mt_arena_f64(&v->mem, (size_t)s->model->n_parameters, 1);
    v->overridden = mt_arena_alloc(&v->mem, (size_t)v->n, sizeof *v->overridden);
    v->independence = mt_arena_alloc(&v->mem, (size_t)v->n, sizeof *v->independence);
    v->value = mt_arena_f64(&v->mem, (size_t)v->n, 1);
    MT_TRY(mt_arena_check(&v->mem, err));
    const mt_status rc =
        mt_model_parameters(s->model, v->c, s->n_inputs, s->inputs, s->at, &v->mem, all, err);
    for (int k = 0; k < v->n && rc == MT_OK; k++) {
        v->value[k] = all[v->parameter[k]];
        v->overridden[k] = is_overridden(v, v->parameter[k]);
    }
    return mt_err_in(err, rc, "%s: configuration \"%s\"", s->path,
                     mt_loaded_model_configuration(s, v->c));
}

static mt_status carry_out(sensitivity_table *v, int wanted, mt_err *err)
{
    int *const together = mt_arena_int(&v->mem, (size_t)v->n);
    int n = 0;
    MT_TRY(mt_arena_check(&v->mem, err));
    for (int k = 0; k < v->n; k++) {
        if (mt_model_parameter_follows(v->s->model, v->parameter[k]) == 0) {
            together[n++] = k;
        }
    }
    if (n > 0) {
        MT_TRY(analyse(v, n, together, wanted, err));
    }
    for (int k = 0; k < v->n; k++) {
        if (mt_model_parameter_follows(v->s->model, v->parameter[k]) != 0) {
            MT_TRY(analyse(v, 1, &k, wanted, err));
        }
    }
    return MT_OK;
}

/* Compute the table. `parameters`: "A,B", or NULL for all that are not expressions of others. v
 * zeroed before; sensitivity_table_free in any case. */
static mt_status sensitivity_table_take(const mt_loaded_model *s, int c, const char *parameters,
                                        int modes, sensitivity_table *v, mt_err *err)
{
    v->s = s;
    v->c = c;
    MT_TRY(mt_arena_init(&v->mem, 0, err));
    MT_TRY(mt_loaded_model_parameters(s, "parameters", parameters, &v->mem, &v->n,
                                      &v->parameter, err));
    MT_TRY(find_values(v, err));
    return carry_out(v, modes, err);
}

static void sensitivity_table_free(sensitivity_table *v)
{
    mt_arena_free(&v->mem);
    memset(v, 0, sizeof *v);
}

/* Change in Hz of mode i for one per cent more of parameter k. */
static double sensitivity_table_per_percent(const sensitivity_table *v, int i, int k)
{
    return PER_CENT * v->value[k] * v->per_unit[i + ((ptrdiff_t)k * v->room)];
}

/* True where the change for 1 % more of parameter k is shown. For a coordinate at or below 0 it
 * is that for 1 mm more. */
static bool sensitivity_table_has_percent(const sensitivity_table *v, int k)
{
    const char *const unit = v->s->model->parameters[v->parameter[k]].unit;
    return v->value[k] > 0.0 || unit == NULL || strcmp(unit, "m") != 0;
}

/* The shown change [Hz], with rounding as 0. */
static double sensitivity_table_shown(const sensitivity_table *v, int i, int k)
{
    const double per_unit = v->per_unit[i + ((ptrdiff_t)k * v->room)];
    const double more = sensitivity_table_has_percent(v, k)
                            ? sensitivity_table_per_percent(v, i, k)
                            : MILLIMETRE * per_unit;
    return mt_without_noise(more, MT_SLOPE_NOISE * v->hz[i]);
}

/* modetune sensitivity: how far one per cent more of a parameter moves each frequency. */

enum { DEFAULT_MODES = 6, DIGITS = 4, HZ_DIGITS = 6, HEADING_TEXT = 40, NAME_TEXT = 128 };

static const char *parameter_si_unit(const sensitivity_table *v, int k)
{
    return v->s->model->parameters[v->parameter[k]].unit;
}

/* The unit in which its value is shown; NULL: SI. */
static const mt_unit *shown_parameter_unit(const sensitivity_table *v, int k)
{
    return v->s->model->parameters[v->parameter[k]].written;
}

static const char *parameter_name(const sensitivity_table *v, int k)
{
    return v->s->model->parameters[v->parameter[k]].name.s;
}

static bool has_none(const sensitivity_table *v, int k)
{
    return v->independence[k].opens || v->independence[k].blocks;
}

/* What one parameter does to one mode. */
typedef struct slope_row {
    const char *parameter;
    const char *unit;
    double value;
    double hz_per_percent;
    double hz_per_unit;
} slope_row;

#define THIS slope_row
static const mt_field slope_fields[] = {
    MT_F_TEXT("parameter", parameter, "Its name."),
    MT_F_TEXT_OR_NULL("unit", unit, "SI unit of its value; null: none given."),
    MT_F_NUMBER("value", value,
                "Its value in this configuration, in the unit that `unit` names."),
    MT_F_NUMBER_OR_NULL("hz_per_percent", hz_per_percent,
                        "Change of the frequency for one per cent more of it; null: it has no "
                        "derivative [Hz/%]."),
    MT_F_NUMBER_OR_NULL(
        "hz_per_unit", hz_per_unit,
        "Derivative of the frequency: Hz for one of its unit; null: it has none "
        "[Hz per unit]."),
};
static const mt_record slope_record =
    MT_F_RECORD_OF(slope_fields, "slope", "What one parameter does to one mode.");
static const mt_record_column slope_columns[] = {
    MT_R_COLUMN(parameter, "parameter", 0, MT_IN_CSV),
    MT_R_COLUMN(value, "value", HZ_DIGITS, MT_IN_CSV),
    MT_R_COLUMN(hz_per_percent, "Hz per %", DIGITS, MT_IN_CSV),
    MT_R_COLUMN(hz_per_unit, "Hz per unit", DIGITS, MT_IN_CSV),
    MT_R_COLUMN(unit, "unit", 0, MT_IN_CSV),
};
static const mt_record_table slope_rows = MT_R_TABLE_OF(slope_record, slope_columns);
#undef THIS

/* A mode, with what all parameters do to it. */
typedef struct mode_row {
    int index;
    double hz;
    bool repeated;
    slope_row *slopes;
    int n;
} mode_row;

#define THIS mode_row
static const mt_field mode_fields[] = {
    MT_F_COUNT("index", index, 1, "Number among the vibration modes, from 1."),
    MT_F_NUMBER("frequency_hz", hz, "Natural frequency."),
    MT_F_FLAG("repeated", repeated,
              "Other modes share its frequency: none of them has a derivative of its own, and "
              "the values are those along the directions into which a parameter splits them, "
              "ascending."),
    MT_F_LIST("sensitivities", slopes, n, slope_row, slope_record, "One of each parameter."),
};
static const mt_record mode_record = MT_F_RECORD_OF(mode_fields, "mode", "A vibration mode.");
static const mt_record_column mode_columns[] = {
    MT_R_COLUMN(index, "mode", 0, MT_IN_CSV),
    MT_R_COLUMN(hz, "frequency [Hz]", HZ_DIGITS, MT_IN_CSV),
    MT_R_COLUMN(repeated, "repeated", 0, MT_IN_CSV),
};
static const mt_record_table mode_rows = MT_R_TABLE_OF(mode_record, mode_columns);
#undef THIS

typedef struct no_derivative_row {
    const char *parameter;
    const char *reason;
    mt_joints_row joints;
} no_derivative_row;

#define THIS no_derivative_row
static const char *const reasons[] = {"opens_joints", "blocks_motion"};
static const mt_field no_derivative_fields[] = {
    MT_F_TEXT("parameter", parameter, "Its name."),
    MT_F_CHOICE("reason", reason, reasons,
                "\"opens_joints\": the joints could not stay closed at any other value; "
                "\"blocks_motion\": they are redundant at this value only, and block a motion "
                "at any other."),
    MT_F_TEXTS("joints", joints.name, joints.n, "These joints.", .flat = true),
};
static const mt_record no_derivative_record =
    MT_F_RECORD_OF(no_derivative_fields, "no_derivative", "A parameter without derivative.");
#undef THIS

typedef struct configuration_row {
    const char *configuration;
    mt_lowest_method method;
    mode_row *modes;
    int n_modes;
    no_derivative_row *without;
    int n_without;
} configuration_row;

#define THIS configuration_row
static const mt_field configuration_fields[] = {
    MT_F_TEXT("configuration", configuration, "Its name."),
    MT_F_ENUM("method", method, mt_lowest_method, mt_lowest_method_names,
              "\"dense\": by all modes; \"tree\", \"sparse\": by the lowest ones of a large "
              "mechanism."),
    MT_F_LIST("modes", modes, n_modes, mode_row, mode_record,
              "The lowest vibration modes, as many as --count says."),
    MT_F_LIST("no_derivatives", without, n_without, no_derivative_row, no_derivative_record,
              "Parameters by which no frequency has a derivative."),
};
static const mt_record configuration_record =
    MT_F_RECORD_OF(configuration_fields, "configuration", "A configuration, answered.");
#undef THIS

static slope_row slope_row_of(const sensitivity_table *v, int i, int k)
{
    return (slope_row){
        .parameter = parameter_name(v, k),
        .unit = parameter_si_unit(v, k),
        .value = v->value[k],
        .hz_per_percent = sensitivity_table_per_percent(v, i, k),
        .hz_per_unit = v->per_unit[i + ((ptrdiff_t)k * v->room)],
    };
}

/* Without slopes. */
static mode_row mode_row_of(const sensitivity_table *v, int i)
{
    return (mode_row){.index = i + 1, .hz = v->hz[i], .repeated = v->repeated[i]};
}

static mt_status configuration_row_of(sensitivity_table *v, configuration_row *out, mt_err *err)
{
    const size_t n = (size_t)v->n;
    *out = (configuration_row){
        .configuration = mt_loaded_model_configuration(v->s, v->c),
        .method = v->way,
        .modes = mt_arena_alloc(&v->mem, (size_t)v->modes, sizeof *out->modes),
        .n_modes = v->modes,
        .without = mt_arena_alloc(&v->mem, n, sizeof *out->without),
    };
    MT_TRY(mt_arena_check(&v->mem, err));
    for (int i = 0; i < v->modes; i++) {
        mode_row *const row = &out->modes[i];
        *row = mode_row_of(v, i);
        row->slopes = mt_arena_alloc(&v->mem, n, sizeof *row->slopes);
        MT_TRY(mt_arena_check(&v->mem, err));
        for (row->n = 0; row->n < v->n; row->n++) {
            row->slopes[row->n] = slope_row_of(v, i, row->n);
        }
    }
    for (int k = 0; k < v->n; k++) {
        if (has_none(v, k)) {
            out->without[out->n_without++] = (no_derivative_row){
                .parameter = parameter_name(v, k),
                .reason = reasons[v->independence[k].opens ? 0 : 1],
                .joints = mt_joints_row_of(&v->independence[k].joints, &v->mem),
            };
        }
    }
    return mt_arena_check(&v->mem, err);
}

static mt_status write_sensitivity_json(mt_json_writer *w, sensitivity_table *v, mt_err *err)
{
    configuration_row row;
    MT_TRY(configuration_row_of(v, &row, err));
    mt_record_put_object(w, NULL, &configuration_record, &row, 0, NULL);
    return MT_OK;
}

static mt_table csv_table(void)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, "configuration", "configuration", MT_ALIGN_LEFT);
    mt_table_record_columns(&t, &mode_rows, MT_IN_CSV);
    mt_table_record_columns(&t, &slope_rows, MT_IN_CSV);
    return t;
}

static void fill_csv(mt_table *t, const sensitivity_table *v)
{
    for (int i = 0; i < v->modes; i++) {
        const mode_row mode = mode_row_of(v, i);
        for (int k = 0; k < v->n; k++) {
            const slope_row row = slope_row_of(v, i, k);
            mt_table_text(t, mt_loaded_model_configuration(v->s, v->c));
            mt_table_record_row(t, &mode_rows, MT_IN_CSV, &mode);
            mt_table_record_row(t, &slope_rows, MT_IN_CSV, &row);
        }
    }
}

static void write_notes(mt_text *out, const sensitivity_table *v, bool repeated,
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

static void write_sensitivity_text(mt_text *out, const sensitivity_table *v)
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
        const bool percent = sensitivity_table_has_percent(v, k);
        char name[NAME_TEXT];
        (void)mt_snprintf(name, sizeof name, "%s (1 mm)", parameter_name(v, k));
        mt_table_text(&t, percent ? parameter_name(v, k) : name);
        coordinates = coordinates || !percent;
        mt_table_number(&t, mt_unit_from_si(shown_parameter_unit(v, k), v->value[k]),
                        HZ_DIGITS);
        mt_table_text(&t, mt_unit_name(shown_parameter_unit(v, k), parameter_si_unit(v, k)));
        for (int i = 0; i < v->modes; i++) {
            mt_table_change(&t, sensitivity_table_shown(v, i, k), DIGITS);
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
    sensitivity_table v = {.s = NULL};
    const int modes = args->count > 0 ? args->count : DEFAULT_MODES;
    mt_status rc = sensitivity_table_take(s, c, args->value[MT_OPT_PARAMETERS], modes, &v, err);
    if (rc == MT_OK) {
        switch (args->format) {
        case MT_FORMAT_JSON:
            rc = write_sensitivity_json(w, &v, err);
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
    sensitivity_table_free(&v);
    return rc;
}

static int run_sensitivity(const mt_args *args, mt_text *out)
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

const mt_command mt_command_sensitivity = {
    .name = "sensitivity",
    .operands = "MODEL",
    .least = 1,
    .most = 1,
    .summary = "change of each frequency per per cent of each parameter",
    .details = "Prints exact derivatives of the first natural frequencies (default: 6): the "
               "change in Hz for 1 % more of a parameter. Repeated modes have directional "
               "derivatives, given as a set.",
    .answer = {&configuration_record, MT_ANSWER_CONFIGURATIONS},
    .run = run_sensitivity,
};
