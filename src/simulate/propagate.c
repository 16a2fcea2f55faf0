/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * States, with w_j = sqrt|lambda_j| (of a rigid-body mode: 1/h):
 *     a_j = w_j e_j,  a_j' = w_j b_j;   b_j = e_j',
 *     b' = -diag(lambda/w) a - C b + sum b_i u_i,
 * so that frequencies that lie far apart do not meet in one entry, and those of the inputs
 * (propagate_inputs.c).
 *     Work of inputs and dampers is the integral of z^T P z, of inputs sum_i u_i b_i . b, of
 * dampers -b . C b: energy balances if the exponential and its quadratic form, two sums, agree.
 *     Where a fitted input is coarse, all begins again with steps in halves.
 */
#include "simulate/propagate_priv.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/interrupt.h"

enum { STATES_MOST = 1000, FIT_HALVINGS = 12, CHECKS = 8 };
/* Lengths of steps are the same within this part of the time. */
static const double ROUNDED = 4.0 * DBL_EPSILON;
/* Of the state that may bring a distance to 0 */
static const double HALF_WAY = 0.5;
/* Samples nearer to the end than this part of their distance are at the end. */
static const double SAME_TIME = 1e-6;
/* Steps in which turning points are looked for are at most this over the highest frequency. */
static const double TURN_STEP = 0.25;
enum { TURN_HALVINGS = 30 };
/* Pieces of an input beyond which it is integrated like any other. */
enum { PIECES_MOST = 20000 };

static mt_status allocate_propagation(mt_propagation *r, mt_err *err)
{
    const size_t n = (size_t)r->n;
    const size_t most = (2 * n) + ((size_t)r->opt->n_inputs *
                                   (MT_FORM_DEGREE + 1 + ((size_t)2 * MT_FORM_WAVES)));
    const size_t gauges = (size_t)r->opt->n_gauges;
    double **const states[] = {&r->z, &r->begin, &r->inner, &r->rate, &r->work};
    for (int i = 0; i < MT_COUNT(states); i++) {
        *states[i] = mt_arena_f64(r->mem, most, 1);
    }
    r->w = mt_arena_f64(r->mem, n, 1);
    r->turn_weight = mt_arena_f64(r->mem, (size_t)r->o.nq, 1);
    r->u = mt_arena_f64(r->mem, (size_t)r->opt->n_inputs, 1);
    r->speed = mt_arena_f64(r->mem, gauges, 1);
    r->input = mt_arena_alloc(r->mem, (size_t)r->opt->n_inputs, sizeof *r->input);
    r->checked = mt_arena_f64(r->mem, CHECKS, (3 * n) + (size_t)r->opt->n_inputs);
    r->weight = mt_arena_f64(r->mem, CHECKS, 1);
    return mt_arena_check(r->mem, err);
}

/* Make A, P and the rows of the gauges' accelerations. */
static mt_status make_matrices(mt_propagation *r, double h, mt_err *err)
{
    const int n = r->n;
    int nz = 2 * n;
    for (int i = 0; i < r->opt->n_inputs; i++) {
        r->input[i].first = nz;
        nz += r->input[i].degree + 1 + (2 * r->input[i].form.n);
    }
    r->nz = nz;
    r->known = r->known && nz <= STATES_MOST;
    r->has_whole = false;
    if (!r->known) {
        return MT_OK;
    }
    mt_arena_clear(&r->own);
    r->a = mt_arena_f64(&r->own, (size_t)nz, (size_t)nz);
    r->p = mt_arena_f64(&r->own, (size_t)nz, (size_t)nz);
    r->see = mt_arena_f64(&r->own, (size_t)r->opt->n_gauges, (size_t)nz);
    MT_TRY(mt_arena_check(&r->own, err));
    for (int j = 0; j < n; j++) {
        const double *const c = r->o.damping + ((ptrdiff_t)j * n);
        mt_propagation_add(r, j, n + j, r->w[j]);
        mt_propagation_add(r, n + j, j, -r->o.lambda[j] / r->w[j]);
        for (int i = 0; i < n; i++) {
            mt_propagation_add(r, n + i, n + j, -c[i]);
            r->p[n + i + ((ptrdiff_t)(n + j) * nz)] -= c[i];
        }
    }
    for (int i = 0; i < r->opt->n_inputs; i++) {
        mt_propagation_couple(r, i, h);
    }
    mt_gemm(false, false, r->opt->n_gauges, nz, n, 1.0, r->o.gauge, r->opt->n_gauges, r->a + n,
            nz, 0.0, r->see, r->opt->n_gauges);
    return MT_OK;
}

static double kinetic(const mt_propagation *r)
{
    return 0.5 * mt_dot(r->n, r->z + r->n, r->z + r->n);
}

static double potential(const mt_propagation *r)
{
    double sum = 0.0;
    for (int j = 0; j < r->n; j++) {
        const double e = r->z[j] / r->w[j];
        sum += 0.5 * r->o.lambda[j] * e * e;
    }
    return sum;
}

static void note_energy(mt_propagation *r)
{
    const double k = kinetic(r);
    const double v = potential(r);
    const double left = (k + v) - (r->energy0 + r->done);
    r->out->energy_error_j = fmax(r->out->energy_error_j, fabs(left));
    r->out->energy_scale_j = fmax(r->out->energy_scale_j, k);
    r->out->energy_scale_j = fmax(r->out->energy_scale_j, fabs(v - r->potential0));
}

/* Acceleration of the ground along an axis. */
static double ground(const mt_propagation *r, int axis)
{
    double sum = 0.0;
    for (int i = 0; i < r->opt->n_inputs; i++) {
        const mt_sim_input *const in = &r->opt->inputs[i];
        sum += in->push == MT_SIM_BASE && in->at == axis ? r->u[i] : 0.0;
    }
    return sum;
}

/* True where distances stay above 0, also within a step h: by |row . e|^2 <= (sum (row/w)^2)
 * (sum a^2 + b^2), or one by one. */
static bool keeps_lengths(const mt_propagation *r, double h)
{
    const ptrdiff_t lengths = r->o.affine.n_lengths;
    const double state = mt_norm2(2 * r->n, r->z);
    if (state <= HALF_WAY * r->free_state) {
        return true;
    }
    bool keeps = true;
    for (ptrdiff_t i = 0; i < lengths && keeps; i++) {
        const double rest = r->o.affine.length[i].rest_m;
        double at = rest;
        double rate = 0.0;
        double bound = 0.0;
        for (ptrdiff_t j = 0; j < r->n; j++) {
            const double a = r->z[j];
            const double b = r->z[r->n + j];
            const double row = r->o.length[i + (j * lengths)];
            at += row * a / r->w[j];
            rate += row * b;
            bound += fabs(row) * sqrt((a * a) + (b * b)) / r->w[j];
        }
        keeps = at > 0.0 && fmax(at - (h * fabs(rate)), rest - bound) > 0.0;
    }
    return keeps;
}

/* Keep the state of the largest energy of each part of the duration, to be checked. */
static void note_check(mt_propagation *r)
{
    const int n = r->n;
    const int last = r->room > 1 ? r->room - 1 : 1;
    const int part = (int)((double)r->out->n / last * CHECKS);
    const int k = part < CHECKS ? part : CHECKS - 1;
    const double size = kinetic(r) + fabs(potential(r));
    if (r->weight[k] > 0.0 && !(size > r->weight[k])) {
        return;
    }
    double *const to = r->checked + ((ptrdiff_t)k * ((3 * n) + r->opt->n_inputs));
    r->weight[k] = fmax(size, DBL_MIN);
    mt_gemv(false, r->nz, r->nz, 1.0, r->a, r->nz, r->z, 0.0, r->rate);
    for (int j = 0; j < n; j++) {
        to[j] = r->z[j] / r->w[j];
        to[n + j] = r->z[n + j];
        to[(2 * n) + j] = r->rate[n + j];
    }
    memcpy(to + ((ptrdiff_t)3 * n), r->u, (size_t)r->opt->n_inputs * sizeof *to);
}

/* Store a sample at r->t, where the inputs are set. */
static void store_sample(mt_propagation *r)
{
    mt_sim_result *const out = r->out;
    const ptrdiff_t i = out->n;
    for (int g = 0; g < out->n_gauges; g++) {
        const ptrdiff_t at = g + (i * out->n_gauges);
        const int channel = r->opt->gauges[g].channel;
        double read[3];
        mt_propagation_see(r, g, read);
        if (channel >= 0 && !mt_channel_turns(r->o.sys->channels[channel].kind)) {
            read[2] += ground(r, r->o.sys->channels[channel].axis);
        }
        out->value[at] = read[0];
        out->speed[at] = read[1];
        out->acceleration[at] = read[2];
    }
    out->t[i] = r->t;
    out->kinetic[i] = kinetic(r);
    out->potential[i] = potential(r);
    out->work[i] = r->done;
    note_check(r);
    out->n++;
}

/* Step from r->t by `length`, for which the exponential was made. */
static mt_status go_by(mt_propagation *r, const mt_exponential *e, double length, mt_err *err)
{
    const int j = r->halvings;
    const double h = ldexp(length, -j);
    const double from = r->t;
    for (int i = 0; i < 1 << j && !r->coarse; i++) {
        const double t = from + (i * h);
        MT_TRY(mt_propagation_set(r, t, h, err));
        memcpy(r->begin, r->z, (size_t)r->nz * sizeof *r->z);
        r->done += mt_exponential_integral(e, j, r->z, r->work);
        mt_exponential_step(e, j, r->z, r->work);
        r->set_at = nan("");
        r->out->steps++;
        if (r->opt->turning) {
            MT_TRY(mt_propagation_turnings(r, e, j, t, err));
        }
        note_energy(r);
    }
    return MT_OK;
}

/* Step to `until`, or to the end of the piece. */
static mt_status step_to(mt_propagation *r, double until, mt_err *err)
{
    const double end = fmin(until, r->until);
    const double length = end - r->t;
    const double h = r->opt->sample_s;
    mt_exponential_of of = {r->nz, r->a, r->p, h};
    if (end == until && fabs(length - h) <= ROUNDED * until) {
        if (!r->has_whole) {
            MT_TRY(mt_exponential_make(&of, r->halvings, r->opt->turning, &r->own, &r->whole,
                                       err));
            r->has_whole = true;
        }
        MT_TRY(go_by(r, &r->whole, h, err));
    } else {
        const mt_arena_mark mark = mt_arena_get_mark(&r->own);
        mt_exponential part;
        of.h = length;
        MT_TRY(mt_exponential_make(&of, r->halvings, r->opt->turning, &r->own, &part, err));
        MT_TRY(go_by(r, &part, length, err));
        mt_arena_rewind(&r->own, mark);
    }
    r->t = end;
    return MT_OK;
}

/* Begin another piece of the inputs at r->t. */
static mt_status turn_page(mt_propagation *r, mt_err *err)
{
    bool changed = false;
    MT_TRY(mt_propagation_forms(r, &changed, err));
    r->set_at = nan("");
    r->known = r->known && ++r->pieces <= PIECES_MOST;
    return changed && r->known ? make_matrices(r, r->opt->sample_s, err) : MT_OK;
}

/* Step to the sample at `until`, while the inputs have known forms and no step is too
 * coarse. */
static mt_status go_until(mt_propagation *r, double until, mt_err *err)
{
    while (r->t < until) {
        if (r->t >= r->until) {
            MT_TRY(turn_page(r, err));
        }
        if (!r->known || r->coarse) {
            return MT_OK;
        }
        MT_TRY(step_to(r, until, err));
    }
    return MT_OK;
}

static mt_status sample_to_end(mt_propagation *r, mt_err *err)
{
    const mt_sim_options *const opt = r->opt;
    const double step = ldexp(opt->sample_s, -r->halvings);
    while (r->out->n < r->room && r->t < opt->duration_s) {
        const double next = r->out->n * opt->sample_s;
        const double until =
            next < opt->duration_s - (SAME_TIME * opt->sample_s) ? next : opt->duration_s;
        if (mt_interrupted(r->o.sys->run->interrupt)) {
            r->out->stop = MT_SIM_INTERRUPTED;
            return MT_OK;
        }
        MT_TRY(go_until(r, until, err));
        if (r->t < until) {
            return MT_OK;
        }
        MT_TRY(mt_propagation_set(r, r->t, r->t < opt->duration_s ? step : -step, err));
        r->known = keeps_lengths(r, opt->sample_s);
        store_sample(r);
    }
    return MT_OK;
}

/* Run from the start with 2^halvings parts per step. */
static mt_status run_propagation(mt_propagation *r, const mt_sim_start *start, mt_err *err)
{
    mt_sim_result *const out = r->out;
    double *const e = r->begin;
    double *const rate = r->begin + r->n;
    r->t = 0.0;
    r->done = 0.0;
    r->coarse = false;
    r->pieces = 0;
    out->n = 0;
    out->steps = 0;
    out->energy_error_j = 0.0;
    out->energy_scale_j = 0.0;
    out->fit.input_error = 0.0;
    memset(r->weight, 0, CHECKS * sizeof *r->weight);
    MT_TRY(mt_oscillators_start(&r->o, start, e, rate, &r->known));
    for (int j = 0; j < r->n; j++) {
        r->z[j] = r->w[j] * e[j];
        r->z[r->n + j] = rate[j];
    }
    if (r->known) {
        MT_TRY(turn_page(r, err));
    }
    if (!r->known) {
        return MT_OK;
    }
    MT_TRY(mt_propagation_set(r, 0.0, ldexp(r->opt->sample_s, -r->halvings), err));
    r->energy0 = kinetic(r) + potential(r);
    r->potential0 = potential(r);
    for (int g = 0; g < out->n_gauges; g++) {
        double read[3];
        mt_propagation_see(r, g, read);
        r->speed[g] = read[1];
    }
    r->known = keeps_lengths(r, r->opt->sample_s);
    note_energy(r);
    store_sample(r);
    return sample_to_end(r, err);
}

/* True where the motion satisfies the full equations. */
static mt_status check_full_equations(mt_propagation *r, mt_err *err)
{
    const int n = r->n;
    mt_oscillators_fit fit = {.independent = true};
    for (ptrdiff_t k = 0; k < CHECKS; k++) {
        const double *const at = r->checked + (k * ((3 * n) + r->opt->n_inputs));
        if (r->weight[k] > 0.0) {
            MT_TRY(mt_oscillators_check(&r->o, at, at + n, at + (ptrdiff_t)2 * n,
                                        at + (ptrdiff_t)3 * n, &r->own, &fit, err));
            r->out->fit.checks++;
        }
    }
    r->out->evaluations = r->out->fit.checks;
    r->out->fit.residual = fit.size > 0.0 ? fit.residual / fit.size : fit.residual;
    r->out->gap_m = fit.gap_m;
    r->out->left_m = fit.gap_m;
    r->known = mt_oscillators_fits(&fit);
    return MT_OK;
}

/* Compute the frequencies, and the halvings required for turning points. */
static void find_steps(mt_propagation *r)
{
    double highest = 0.0;
    for (int j = 0; j < r->n; j++) {
        const double w = sqrt(fabs(r->o.lambda[j]));
        r->w[j] = w > 0.0 ? w : 1.0 / r->opt->sample_s;
        highest = fmax(highest, w);
    }
    while (r->opt->turning && r->halvings < TURN_HALVINGS &&
           ldexp(highest * r->opt->sample_s, -r->halvings) > TURN_STEP) {
        r->halvings++;
    }
    r->free_state = HUGE_VAL;
    for (ptrdiff_t i = 0; i < r->o.affine.n_lengths; i++) {
        double square = 0.0;
        for (ptrdiff_t j = 0; j < r->n; j++) {
            const double row = r->o.length[i + (j * r->o.affine.n_lengths)] / r->w[j];
            square += row * row;
        }
        if (square > 0.0) {
            r->free_state = fmin(r->free_state, r->o.affine.length[i].rest_m / sqrt(square));
        }
    }
    for (int b = 0; b < r->o.sys->n_bodies; b++) {
        for (int k = 0; k < 6; k++) {
            const int dof = r->o.sys->bodies[b].dof[k];
            if (dof >= 0) {
                r->turn_weight[dof] = k < 3 ? 1.0 : r->o.sys->length_m;
            }
        }
    }
}

static mt_status propagate(mt_propagation *r, const mt_sim_start *start, mt_err *err)
{
    MT_TRY(mt_oscillators_make(r->o.lin, r->opt, r->mem, &r->o, &r->known, err));
    if (!r->known) {
        return MT_OK;
    }
    r->n = r->o.n;
    MT_TRY(allocate_propagation(r, err));
    find_steps(r);
    const int most = r->halvings + FIT_HALVINGS;
    MT_TRY(run_propagation(r, start, err));
    while (r->coarse && r->known && r->halvings < most) {
        r->halvings++;
        r->a = NULL;
        MT_TRY(run_propagation(r, start, err));
    }
    r->known = r->known && !r->coarse;
    if (!r->known) {
        return MT_OK;
    }
    MT_TRY(check_full_equations(r, err));
    r->out->method = MT_SIM_EXACT;
    for (int i = 0; i < r->opt->n_inputs; i++) {
        r->out->method = r->input[i].fitted ? MT_SIM_FITTED : r->out->method;
    }
    if (r->opt->end != NULL && r->known) {
        for (int j = 0; j < r->n; j++) {
            r->begin[j] = r->z[j] / r->w[j];
        }
        mt_oscillators_position(&r->o, r->begin, r->z + r->n, &r->opt->end->at, r->opt->end->v);
    }
    return MT_OK;
}

mt_status mt_propagate(mt_linear *lin, const mt_sim_start *start, const mt_sim_options *opt,
                       int room, mt_arena *mem, mt_sim_result *out, bool *done, mt_err *err)
{
    mt_propagation r = {.opt = opt, .mem = mem, .out = out, .room = room, .set_at = nan("")};
    r.o.lin = lin;
    mt_status rc = mt_arena_init(&r.own, 0, err);
    rc = rc == MT_OK ? propagate(&r, start, err) : rc;
    *done = rc == MT_OK && r.known;
    mt_arena_free(&r.own);
    return rc;
}
