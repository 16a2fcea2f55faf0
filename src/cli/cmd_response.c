/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune response: how forces and a moving ground shake a mechanism. */
#include <math.h>
#include <string.h>

#include "base/format.h"
#include "cli/response.h"
#include "cli/vibrated.h"

enum { DEFAULT_POINTS = 50, DEFAULT_MODES = 6 };

static const double TWO_PI = 6.283185307179586477;
static const double PER_CENT = 0.01;
/* The range that is looked at by default, in parts of its vibration modes' frequencies. */
static const double BELOW_FIRST = 0.25;
static const double ABOVE_LAST = 2.0;
/* How many modes of a large mechanism are found at first, and at most, and how far they have to
 * go above the range. */
enum { WHY_SIZE = MT_LOWEST_WHY + 100 };
enum { FIRST_MODES = 24, MOST_MODES = 400 };
static const double ABOVE_RANGE = 2.0;
/* Where those that are left out have a damping ratio, which nothing but modes shows in full:
 * how far above, in how many modes at most. */
enum { MOST_WITH_RATIO = 100 };
static const double ABOVE_WITH_RATIO = 20.0;

/* One configuration at work. */
typedef struct job {
    const mt_args *args;
    const mt_vibration *profile; /* --vibration; NULL */
    mt_loaded_model *s;
    int c;
    mt_analysis *a; /* NULL: of the lowest modes */
    mt_lowest *l;   /* NULL: of all of them */
    const mt_modes *modes;
    mt_response_request request;
    mt_response r;
    mt_profiled profiled;
    mt_curve curve;
    mt_response_view v;
} job;

static mt_response_request request_of(const mt_args *args)
{
    return (mt_response_request){.n_in = args->all[MT_OPT_INPUT].n,
                                 .inputs = args->all[MT_OPT_INPUT].value,
                                 .n_out = args->all[MT_OPT_SEEN].n,
                                 .outputs = args->all[MT_OPT_SEEN].value,
                                 .direct = args->given[MT_OPT_DIRECT],
                                 .modes = args->keep};
}

/* `part` of the frequency of vibration mode `index` [Hz]; NaN where there is none. */
static double by_mode(const job *j, int index, double part)
{
    const int at = mt_modal_flexible(j->modes, index);
    return at < 0 ? nan("") : part * mt_modal_hz(j->modes, at);
}

/* An end of the range: of its option, or the default [Hz]. */
static mt_status range_end(job *j, int option, double hz, double *w, mt_err *err)
{
    const char *const name = mt_options[option].name;
    const char *const text = j->args->value[option];
    if (text != NULL) {
        MT_TRY(mt_loaded_model_number(j->s, name, NULL, text, strlen(text), &hz, err));
    }
    if (!(hz > 0.0 && isfinite(TWO_PI * hz))) {
        return text == NULL ? mt_fail(err, MT_E_USAGE,
                                      "there is no vibration mode from which to choose "
                                      "frequencies: give --%s",
                                      name)
                            : mt_fail(err, MT_E_USAGE, "--%s: %s is not a frequency above 0",
                                      name, text);
    }
    *w = TWO_PI * hz;
    return MT_OK;
}

static mt_status choose_range(job *j, mt_err *err)
{
    const int count = mt_modal_vibrations(j->modes);
    const int last = count < DEFAULT_MODES ? count : DEFAULT_MODES;
    mt_curve_options *const opt = &j->v.opt;
    *opt = (mt_curve_options){.points = j->args->points > 0 ? j->args->points : DEFAULT_POINTS,
                              .log = j->args->given[MT_OPT_LOG]};
    double hz[2] = {by_mode(j, 1, BELOW_FIRST), by_mode(j, last, ABOVE_LAST)};
    if (j->profile != NULL) {
        mt_vibration_range(j->profile, true, true, hz);
        hz[1] = hz[1] > hz[0] ? hz[1] : ABOVE_LAST * hz[1]; /* one tone */
    }
    MT_TRY(range_end(j, MT_OPT_FROM, hz[0], &opt->from, err));
    MT_TRY(range_end(j, MT_OPT_TO, hz[1], &opt->to, err));
    if (!(opt->to > opt->from)) {
        return mt_fail(err, MT_E_USAGE, "--to: %g Hz is not above --from, %g Hz",
                       opt->to / TWO_PI, opt->from / TWO_PI);
    }
    return opt->points < 2 ? mt_fail(err, MT_E_USAGE, "--points: a grid has at least 2 points")
                           : MT_OK;
}

/* Inputs of --set, and the parameter among them: its place in *slot. */
static mt_status inputs_with(const job *j, int parameter, mt_arena *mem, int *n, int **inputs,
                             double **at, int *slot, mt_err *err)
{
    const size_t room = (size_t)j->s->n_inputs + 1;
    *inputs = mt_arena_int(mem, room);
    *at = mt_arena_f64(mem, room, 1);
    MT_TRY(mt_arena_check(mem, err));
    *n = j->s->n_inputs;
    *slot = *n;
    for (int i = 0; i < *n; i++) {
        (*inputs)[i] = j->s->inputs[i];
        (*at)[i] = j->s->at[i];
        *slot = (*inputs)[i] == parameter ? i : *slot;
    }
    if (*slot == *n) {
        (*inputs)[*n] = parameter;
        (*at)[*n] = j->s->values[parameter];
        (*n)++;
    }
    return MT_OK;
}

/* Derivatives of |H| at its extremes by an input, equal to those at fixed frequency:
 * to[n_extremes]. */
static mt_status slopes_with(job *j, mt_analysis *a, mt_response *r, int slot, double value,
                             double *to, mt_err *err)
{
    MT_TRY(mt_response_open(a, &j->request, r, err));
    const ptrdiff_t pairs = (ptrdiff_t)r->ports.n_in * r->ports.n_out;
    double complex *const dh =
        mt_arena_alloc(&r->mem, (size_t)(pairs * a->sys->n_inputs), sizeof *dh);
    MT_TRY(mt_arena_check(&r->mem, err));
    for (int e = 0; e < j->curve.n_extremes; e++) {
        const mt_extreme *const x = &j->curve.extremes[e];
        to[e] = nan("");
        if (x->infinite || !(cabs(x->h) > x->error)) { /* 0, which has no slope */
            continue;
        }
        MT_TRY(mt_response_slopes_at(r, x->w, dh, err));
        const double complex slope = dh[x->pair + (slot * pairs)];
        to[e] = PER_CENT * value * creal(conj(x->h) * slope) / cabs(x->h);
    }
    return MT_OK;
}

static mt_status sensitivity(job *j, int parameter, double *value, double *to, mt_err *err)
{
    mt_analysis *a = NULL;
    mt_response r = {.a = NULL};
    int n = 0;
    int slot = 0;
    int *inputs = NULL;
    double *at = NULL;
    MT_TRY(inputs_with(j, parameter, &j->r.mem, &n, &inputs, &at, &slot, err));
    mt_analysis_options opt = mt_analysis_options_default();
    opt.gradient = true;
    const mt_system_def def = mt_loaded_model_system(j->s, j->c, n, inputs, at);
    mt_status rc = mt_analysis_new_of(&def, 0, &a, err);
    rc = rc == MT_OK ? mt_analysis_solve(a, at, &opt, err) : rc;
    if (rc == MT_OK) {
        *value = mt_linear_value(a->lin, a->sys->parameters[parameter]);
        rc = slopes_with(j, a, &r, slot, *value, to, err);
    }
    mt_response_free(&r);
    mt_analysis_delete(a);
    return rc;
}

static mt_status sensitivities(job *j, mt_err *err)
{
    const char *const list = j->args->value[MT_OPT_SENSITIVITY];
    int *parameter = NULL;
    if (list == NULL) {
        return MT_OK;
    }
    MT_TRY(mt_loaded_model_parameters(j->s, "sensitivity", list, &j->r.mem, &j->v.n, &parameter,
                                      err));
    const size_t n = (size_t)j->v.n;
    double *const value = mt_arena_f64(&j->r.mem, n, 1);
    double *const percent = mt_arena_f64(&j->r.mem, (size_t)j->curve.n_extremes, n);
    MT_TRY(mt_arena_check(&j->r.mem, err));
    for (int k = 0; k < j->v.n; k++) {
        MT_TRY(sensitivity(j, parameter[k], &value[k],
                           percent + ((ptrdiff_t)k * j->curve.n_extremes), err));
    }
    j->v.parameter = parameter;
    j->v.value = value;
    j->v.percent = percent;
    return MT_OK;
}

/* Find the sums of poles; that there is none is part of the answer. */
static mt_status poles(job *j, mt_err *err)
{
    if (!j->args->given[MT_OPT_POLES]) {
        return MT_OK;
    }
    mt_err own = {.code = MT_OK};
    const size_t pairs = (size_t)j->r.ports.n_in * (size_t)j->r.ports.n_out;
    mt_pole_sum *const sums = mt_arena_alloc(&j->r.mem, pairs, sizeof *sums);
    MT_TRY(mt_arena_check(&j->r.mem, err));
    const mt_status rc = mt_response_sums(&j->r, sums, &own);
    if (rc != MT_OK && rc != MT_E_SINGULAR) {
        return mt_fail(err, rc, "%s", own.text);
    }
    j->v.sums = rc == MT_OK ? sums : NULL;
    j->v.no_sums = rc == MT_OK ? NULL : mt_arena_strdup(&j->r.mem, own.text);
    return mt_arena_check(&j->r.mem, err);
}

/* The vibration under the profile, where one is given. */
static mt_status shake(job *j, mt_err *err)
{
    if (j->profile != NULL) {
        MT_TRY(mt_profiled_find(&j->r, j->profile, &j->profiled, err));
        j->v.profiled = &j->profiled;
    }
    return MT_OK;
}

static mt_status request_ports(job *j, const mt_system *sys, mt_err *err)
{
    j->request = request_of(j->args);
    return j->profile == NULL
               ? MT_OK
               : mt_profiled_ports(j->profile, sys, &j->s->mem, &j->request, err);
}

static mt_status open_response(job *j, const char *why, mt_err *err)
{
    MT_TRY(mt_loaded_model_admit_dense(j->s, j->c, why, err));
    MT_TRY(mt_loaded_model_analyse(j->s, j->c, 0, &j->a, err));
    j->modes = &j->a->modes;
    MT_TRY(request_ports(j, j->a->sys, err));
    MT_TRY(mt_response_open(j->a, &j->request, &j->r, err));
    MT_TRY(mt_response_admit(&j->r, err));
    MT_TRY(shake(j, err));
    return choose_range(j, err);
}

/* True where the lowest modes may suffice. */
static bool may_be_large(const job *j, char *why)
{
    static const int WHOLE[] = {MT_OPT_DIRECT, MT_OPT_POLES, MT_OPT_SENSITIVITY, MT_OPT_KEEP};
    for (int i = 0; i < MT_COUNT(WHOLE); i++) {
        if (j->args->given[WHOLE[i]]) {
            (void)mt_snprintf(why, WHY_SIZE, "--%s needs all modes", mt_options[WHOLE[i]].name);
            return false;
        }
    }
    return mt_lowest_bodies(j->s->model, j->c) >= MT_LOWEST_BODIES;
}

/* The response by the lowest `count` modes; *enough: true where they reach so far above the
 * range that the omitted ones are within little more than rounding. */
static mt_status try_large(job *j, int count, bool *is, bool *enough, char *why, mt_err *err)
{
    const mt_lowest_want want = {.count = count, .shapes = true};
    mt_err own = {.code = MT_OK};
    mt_lowest_delete(j->l);
    j->l = NULL;
    const mt_system_def def =
        mt_loaded_model_system(j->s, j->c, j->s->n_inputs, j->s->inputs, j->s->at);
    const mt_status rc = mt_lowest_new(&def, want, &j->l, &own);
    if (mt_is_final(rc) || rc == MT_E_INTERRUPTED) {
        return mt_fail(err, rc, "%s", own.text);
    }
    *is = rc == MT_OK && j->l->way != MT_LOWEST_NONE;
    *enough = true;
    if (rc != MT_OK) {
        (void)mt_snprintf(why, WHY_SIZE, "its lowest modes alone: %s", own.text);
        return MT_OK;
    }
    if (!*is) {
        (void)mt_snprintf(why, WHY_SIZE,
                          "the method for large trees does not apply, because %s", j->l->why);
        return MT_OK;
    }
    j->modes = &j->l->found.modes;
    MT_TRY(request_ports(j, j->l->sys, err));
    MT_TRY(choose_range(j, err));
    const bool ratio = j->l->sys->damping.ratio != MT_NO_NODE && 2 * count <= MOST_WITH_RATIO;
    const double above = (ratio ? ABOVE_WITH_RATIO : ABOVE_RANGE) * j->v.opt.to;
    *enough = j->l->found.tau >= above * above || j->l->found.below == j->modes->all;
    if (!*enough) {
        return MT_OK;
    }
    mt_response_free(&j->r);
    char what[MT_LARGE_WHY] = "";
    MT_TRY(mt_response_open_large(j->l, &j->request, j->v.opt.to, &j->r, is, what, err));
    if (!*is) {
        (void)mt_snprintf(why, WHY_SIZE, "a response by its lowest modes: %s", what);
    }
    return MT_OK;
}

/* *is false: all modes have to be found. */
static mt_status open_large(job *j, bool *is, char *why, mt_err *err)
{
    bool enough = false;
    *is = may_be_large(j, why);
    for (int count = FIRST_MODES; *is && !enough; count *= 2) {
        *is = count <= MOST_MODES;
        if (*is) {
            MT_TRY(try_large(j, count, is, &enough, why, err));
        } else {
            (void)mt_snprintf(why, WHY_SIZE,
                              "a response so far up needs more than its %d lowest modes",
                              count / 2);
        }
    }
    if (!*is) {
        return MT_OK;
    }
    MT_TRY(mt_response_admit(&j->r, err));
    return shake(j, err);
}

static mt_status open_either(job *j, mt_err *err)
{
    char why[WHY_SIZE] = "a response needs all modes";
    bool is = false;
    MT_TRY(open_large(j, &is, why, err));
    if (is) {
        return MT_OK;
    }
    mt_response_free(&j->r);
    mt_lowest_delete(j->l);
    j->l = NULL;
    return open_response(j, why, err);
}

static mt_status compute_response(job *j, mt_err *err)
{
    mt_status rc = open_either(j, err);
    rc = rc == MT_OK ? mt_response_curve(&j->r, &j->v.opt, &j->curve, err) : rc;
    rc = rc == MT_OK ? poles(j, err) : rc;
    rc = rc == MT_OK ? sensitivities(j, err) : rc;
    return mt_err_in(err, rc, "%s: configuration \"%s\"", j->s->path, j->v.configuration);
}

typedef struct sink {
    const mt_args *args;
    mt_vibration *profile; /* owned; NULL */
    mt_text *out;
    mt_json_writer w;
    mt_table table; /* CSV */
} sink;

static int show_configuration_response(sink *to, mt_loaded_model *s, int c)
{
    job j = {.args = to->args, .profile = to->profile, .s = s, .c = c};
    mt_err err = {.code = MT_OK};
    j.v = (mt_response_view){.configuration = mt_loaded_model_configuration(s, c),
                             .s = s,
                             .r = &j.r,
                             .curve = &j.curve,
                             .direct = to->args->given[MT_OPT_DIRECT]};
    mt_loaded_model_warn_overridden(s, c);
    const mt_status rc = compute_response(&j, &err);
    if (rc == MT_OK) {
        switch (to->args->format) {
        case MT_FORMAT_JSON:
            mt_response_json(&j.v, &to->w);
            break;
        case MT_FORMAT_CSV:
            mt_response_csv_rows(&j.v, &to->table);
            break;
        case MT_FORMAT_HTML:  /* of report alone */
        case MT_FORMAT_SARIF: /* of check alone */
        case MT_FORMAT_TEXT:
            mt_response_print(&j.v, to->out);
            mt_loaded_model_note_links(s, c, to->out);
            break;
        }
    } else if (to->args->format == MT_FORMAT_JSON) {
        mt_cli_json_failed(&to->w, j.v.configuration, &err);
    }
    mt_response_free(&j.r);
    mt_analysis_delete(j.a);
    mt_lowest_delete(j.l);
    return rc == MT_OK ? MT_EXIT_DONE : mt_cli_failed(rc, &err);
}

/* Load the profile of --vibration; without one an input is required. */
static int load_response_profile(sink *to)
{
    const char *const name = to->args->value[MT_OPT_VIBRATION];
    mt_diagnostics messages = {.count = 0};
    mt_err err = {.code = MT_OK};
    if (name != NULL) {
        const mt_status rc = mt_vibrated_load(to->args, name, &to->profile, &messages, &err);
        return mt_cli_loaded(rc, &messages, &err);
    }
    return to->args->all[MT_OPT_INPUT].n > 0
               ? MT_EXIT_DONE
               : mt_cli_failed(mt_fail(&err, MT_E_USAGE,
                                       "\"response\" needs --input, what shakes the "
                                       "mechanism, or --vibration, a profile"),
                               &err);
}

int mt_cmd_response(const mt_args *args, mt_text *out)
{
    mt_loaded_model s = {.model = NULL};
    sink to = {.args = args,
               .out = out,
               .w = mt_json_writer_default(out),
               .table = mt_response_csv_table(args->given[MT_OPT_VIBRATION])};
    const bool json = args->format == MT_FORMAT_JSON;
    const bool list = json && !args->given[MT_OPT_CONFIGURATION];
    int code =
        mt_loaded_model_load(args, args->operands[0], args->value[MT_OPT_CONFIGURATION], &s);
    code = code == MT_EXIT_DONE ? load_response_profile(&to) : code;
    if (code != MT_EXIT_DONE) {
        goto done;
    }
    if (list) {
        mt_json_open(&to.w, NULL, '[');
    }
    for (int i = 0; i < s.n_configurations; i++) {
        code = mt_exit_worse(code, show_configuration_response(&to, &s, s.configurations[i]));
    }
    if (list) {
        mt_json_close(&to.w);
    }
    if (json) {
        code = mt_exit_worse(code, mt_cli_json_done(&to.w));
    }
    if (args->format == MT_FORMAT_CSV) {
        mt_table_csv(&to.table, out);
    }
done:
    mt_vibration_delete(to.profile);
    mt_table_free(&to.table);
    mt_loaded_model_free(&s);
    return code;
}
