/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A parameter that is made of others ("EI": "E*I") must not be an input together with them, or
 * it would no longer follow: it gets an analysis of its own.
 */
#include "cli/sensitivity_table.h"

#include <string.h>

#include "analysis/sensitivity.h"
#include "base/number.h"
#include "model/values.h"

static const double PER_CENT = 0.01;
static const double MILLIMETRE = 1e-3;

static bool is_overridden(const mt_sensitivity_table *v, int parameter)
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
static mt_status choose_modes(mt_sensitivity_table *v, const mt_modes *m, int wanted,
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
typedef struct question {
    int wanted; /* modes */
    int n;
    const int *entry; /* [n] of the survey */
    int *slot;        /* [n] input of each */
    int count;        /* inputs */
    int *inputs;
    double *at;
} question;

static mt_status list_question_inputs(mt_sensitivity_table *v, question *q, mt_err *err)
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

static mt_status answer_by_all(mt_sensitivity_table *v, const question *q, mt_err *err)
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
static mt_status answer_by_lowest(mt_sensitivity_table *v, const question *q, bool *done,
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

static mt_status analyse(mt_sensitivity_table *v, int n, const int *entry, int wanted,
                         mt_err *err)
{
    question q = {.wanted = wanted, .n = n, .entry = entry};
    bool done = false;
    MT_TRY(list_question_inputs(v, &q, err));
    MT_TRY(answer_by_lowest(v, &q, &done, err));
    return done ? MT_OK : answer_by_all(v, &q, err);
}

/* What the parameters are in this configuration, its own overrides included. */
static mt_status find_values(mt_sensitivity_table *v, mt_err *err)
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

static mt_status carry_out(mt_sensitivity_table *v, int wanted, mt_err *err)
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

mt_status mt_sensitivity_table_take(const mt_loaded_model *s, int c, const char *parameters,
                                    int modes, mt_sensitivity_table *v, mt_err *err)
{
    v->s = s;
    v->c = c;
    MT_TRY(mt_arena_init(&v->mem, 0, err));
    MT_TRY(mt_loaded_model_parameters(s, "parameters", parameters, &v->mem, &v->n,
                                      &v->parameter, err));
    MT_TRY(find_values(v, err));
    return carry_out(v, modes, err);
}

void mt_sensitivity_table_free(mt_sensitivity_table *v)
{
    mt_arena_free(&v->mem);
    memset(v, 0, sizeof *v);
}

double mt_sensitivity_table_per_percent(const mt_sensitivity_table *v, int i, int k)
{
    return PER_CENT * v->value[k] * v->per_unit[i + ((ptrdiff_t)k * v->room)];
}

bool mt_sensitivity_table_has_percent(const mt_sensitivity_table *v, int k)
{
    const char *const unit = v->s->model->parameters[v->parameter[k]].unit;
    return v->value[k] > 0.0 || unit == NULL || strcmp(unit, "m") != 0;
}

double mt_sensitivity_table_shown(const mt_sensitivity_table *v, int i, int k)
{
    const double per_unit = v->per_unit[i + ((ptrdiff_t)k * v->room)];
    const double more = mt_sensitivity_table_has_percent(v, k)
                            ? mt_sensitivity_table_per_percent(v, i, k)
                            : MILLIMETRE * per_unit;
    return mt_without_noise(more, MT_SLOPE_NOISE * v->hz[i]);
}
