/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * How far parameters move frequencies, as records. A parameter that is made of others
 * ("EI": "E*I") must not be an input together with them, or it would no longer follow: it gets
 * an analysis of its own.
 */
#include "inspect/sensitivity.h"

#include "modetune/model.h"

#include <string.h>

#include "base/format.h"
#include "mechanics/products.h"
#include "model/values.h"
#include "result/write.h"

static const double PER_CENT = 0.01;

static bool is_overridden(const mt_sensitivity_view *v, int parameter)
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
static mt_status choose_modes(mt_sensitivity_view *v, const mt_modes *m, int wanted,
                              mt_err *err)
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
typedef struct inputs_question {
    int wanted; /* modes */
    int n;
    const int *entry; /* [n] of the survey */
    int *slot;        /* [n] input of each */
    int count;        /* inputs */
    int *inputs;
    double *at;
} inputs_question;

static mt_status list_questioninputs(mt_sensitivity_view *v, inputs_question *q, mt_err *err)
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

static mt_status answer_by_all(mt_sensitivity_view *v, const inputs_question *q, mt_err *err)
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
static mt_status answer_by_lowest(mt_sensitivity_view *v, const inputs_question *q, bool *done,
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

static mt_status analyse(mt_sensitivity_view *v, int n, const int *entry, int wanted,
                         mt_err *err)
{
    inputs_question q = {.wanted = wanted, .n = n, .entry = entry};
    bool done = false;
    MT_TRY(list_questioninputs(v, &q, err));
    MT_TRY(answer_by_lowest(v, &q, &done, err));
    return done ? MT_OK : answer_by_all(v, &q, err);
}

/* What the parameters are in this configuration, its own overrides included. */
static mt_status find_values(mt_sensitivity_view *v, mt_err *err)
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

static mt_status carry_out(mt_sensitivity_view *v, int wanted, mt_err *err)
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

mt_status mt_sensitivity_question_admit(mt_loaded_model *s, const mt_sensitivity_question *q,
                                        mt_err *err)
{
    int n = 0;
    int *parameter = NULL;
    return q->parameters == NULL ? MT_OK
                                 : mt_loaded_model_parameters(s, "parameters", q->parameters,
                                                              &s->mem, &n, &parameter, err);
}

mt_status mt_sensitivity_view_take(const mt_loaded_model *s, int c,
                                   const mt_sensitivity_question *question,
                                   mt_sensitivity_view *v, mt_err *err)
{
    v->s = s;
    v->c = c;
    MT_TRY(mt_arena_init(&v->mem, 0, err));
    MT_TRY(mt_loaded_model_parameters(s, "parameters", question->parameters, &v->mem, &v->n,
                                      &v->parameter, err));
    MT_TRY(find_values(v, err));
    return carry_out(v, question->modes, err);
}

void mt_sensitivity_view_free(mt_sensitivity_view *v)
{
    mt_arena_free(&v->mem);
    memset(v, 0, sizeof *v);
}

/* Change in Hz of mode i for one per cent more of parameter k. */
static double per_percent(const mt_sensitivity_view *v, int i, int k)
{
    return PER_CENT * v->value[k] * v->per_unit[i + ((ptrdiff_t)k * v->room)];
}

static const char *parameter_si_unit(const mt_sensitivity_view *v, int k)
{
    return v->s->model->parameters[v->parameter[k]].unit;
}

static const char *parameter_name(const mt_sensitivity_view *v, int k)
{
    return v->s->model->parameters[v->parameter[k]].name.s;
}

bool mt_sensitivity_has_none(const mt_sensitivity_view *v, int k)
{
    return v->independence[k].opens || v->independence[k].blocks;
}

#define THIS mt_slope_row
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
const mt_record mt_slope_record =
    MT_F_RECORD_OF(slope_fields, "slope", "What one parameter does to one mode.");
#undef THIS

#define THIS mt_sensitive_mode_row
static const mt_field mode_fields[] = {
    MT_F_COUNT("index", index, 1, "Number among the vibration modes, from 1."),
    MT_F_NUMBER("frequency_hz", hz, "Natural frequency."),
    MT_F_FLAG("repeated", repeated,
              "Other modes share its frequency: none of them has a derivative of its own, and "
              "the values are those along the directions into which a parameter splits them, "
              "ascending."),
    MT_F_LIST("sensitivities", slopes, n, mt_slope_row, mt_slope_record,
              "One of each parameter."),
};
const mt_record mt_sensitive_mode_record =
    MT_F_RECORD_OF(mode_fields, "mode", "A vibration mode.");
#undef THIS

#define THIS mt_no_derivative_row
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

#define THIS mt_sensitivity_row
static const mt_field configuration_fields[] = {
    MT_F_TEXT("configuration", configuration, "Its name."),
    MT_F_ENUM("method", method, mt_lowest_method, mt_lowest_method_names,
              "\"dense\": by all modes; \"tree\", \"sparse\": by the lowest ones of a large "
              "mechanism."),
    MT_F_LIST("modes", modes, n_modes, mt_sensitive_mode_row, mt_sensitive_mode_record,
              "The lowest vibration modes, as many as --count says."),
    MT_F_LIST("no_derivatives", without, n_without, mt_no_derivative_row, no_derivative_record,
              "Parameters by which no frequency has a derivative."),
};
const mt_record mt_sensitivity_record =
    MT_F_RECORD_OF(configuration_fields, "configuration", "A configuration, answered.");
#undef THIS

mt_slope_row mt_slope_row_of(const mt_sensitivity_view *v, int i, int k)
{
    return (mt_slope_row){
        .parameter = parameter_name(v, k),
        .unit = parameter_si_unit(v, k),
        .value = v->value[k],
        .hz_per_percent = per_percent(v, i, k),
        .hz_per_unit = v->per_unit[i + ((ptrdiff_t)k * v->room)],
    };
}

mt_sensitive_mode_row mt_sensitive_mode_row_of(const mt_sensitivity_view *v, int i)
{
    return (mt_sensitive_mode_row){.index = i + 1, .hz = v->hz[i], .repeated = v->repeated[i]};
}

static mt_status sensitivity_row_of(mt_sensitivity_view *v, mt_sensitivity_row *out,
                                    mt_err *err)
{
    const size_t n = (size_t)v->n;
    *out = (mt_sensitivity_row){
        .configuration = mt_loaded_model_configuration(v->s, v->c),
        .method = v->way,
        .modes = mt_arena_alloc(&v->mem, (size_t)v->modes, sizeof *out->modes),
        .n_modes = v->modes,
        .without = mt_arena_alloc(&v->mem, n, sizeof *out->without),
    };
    MT_TRY(mt_arena_check(&v->mem, err));
    for (int i = 0; i < v->modes; i++) {
        mt_sensitive_mode_row *const row = &out->modes[i];
        *row = mt_sensitive_mode_row_of(v, i);
        row->slopes = mt_arena_alloc(&v->mem, n, sizeof *row->slopes);
        MT_TRY(mt_arena_check(&v->mem, err));
        for (row->n = 0; row->n < v->n; row->n++) {
            row->slopes[row->n] = mt_slope_row_of(v, i, row->n);
        }
    }
    for (int k = 0; k < v->n; k++) {
        if (mt_sensitivity_has_none(v, k)) {
            out->without[out->n_without++] = (mt_no_derivative_row){
                .parameter = parameter_name(v, k),
                .reason = reasons[v->independence[k].opens ? 0 : 1],
                .joints = mt_joints_row_of(&v->independence[k].joints, &v->mem),
            };
        }
    }
    return mt_arena_check(&v->mem, err);
}

mt_status mt_sensitivity_put(mt_sensitivity_view *v, mt_json_writer *w, mt_err *err)
{
    mt_sensitivity_row row;
    MT_TRY(sensitivity_row_of(v, &row, err));
    mt_record_put_object(w, NULL, &mt_sensitivity_record, &row, 0, NULL);
    return MT_OK;
}
