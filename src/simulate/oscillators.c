/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Coordinates of modes, because frequencies may lie far apart: lambda then has the digits that
 * the springs have (modal/graded.c), which sums of their matrices lose.
 *     A check puts a state into the whole equations, with positions, angles and velocity terms:
 * along phi, which the forces of joints do no work on,
 *     r = phi^T (M q'' - f(g, v) - inputs)
 * is 0 but for rounding. Of positions of size l, that is eps l times what a spring makes of it,
 * sum |k_t| |f_t| |f_t phi|; of the terms of r, eps of the largest.
 */
#include "simulate/oscillators.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "mechanics/eliminate.h"
#include "modal/modal.h"

/* Rounding errors that a residual may have, of its largest term, and of positions. */
static const double FITS = 1e-10;
static const double ROUNDING = 64.0 * DBL_EPSILON;
/* A start is one of the linear motion to this part of its size and the model's length. */
static const double STARTS = 1e-12;

static mt_status allocate_oscillators(mt_oscillators *o, mt_arena *mem, mt_err *err)
{
    const size_t nq = (size_t)o->nq;
    const size_t n = (size_t)o->n;
    MT_TRY(mt_motion_init(&o->motion, o->lin, mem, err));
    MT_TRY(mt_placement_init(&o->at, o->sys, mem, err));
    o->phi = mt_arena_f64(mem, nq, n);
    o->damping = mt_arena_f64(mem, n, n);
    o->input = mt_arena_f64(mem, n, (size_t)o->opt->n_inputs);
    o->gauge = mt_arena_f64(mem, (size_t)o->opt->n_gauges, n);
    o->still = mt_arena_f64(mem, (size_t)o->opt->n_gauges, 1);
    o->length = mt_arena_f64(mem, (size_t)o->affine.n_lengths, n);
    o->noise = mt_arena_f64(mem, n, 1);
    o->row = mt_arena_f64(mem, nq, 1);
    for (int i = 0; i < MT_COUNT(o->work); i++) {
        o->work[i] = mt_arena_f64(mem, nq, 1);
    }
    return mt_arena_check(mem, err);
}

/* Modes with all shapes; *good false: a direction without mass, or they do not converge. */
static mt_status find_modes(mt_oscillators *o, mt_arena *mem, bool *good, mt_err *err)
{
    const mt_reduced r = mt_linear_reduced(o->lin);
    mt_mass_factor *const mass = mt_arena_alloc(mem, 1, sizeof *mass);
    mt_modes modes;
    MT_TRY(mt_arena_check(mem, err));
    mt_status rc = mt_modal_factor_mass(r.n, r.m, mem, mass, NULL);
    *good = rc == MT_OK && mass->rank == r.n;
    if (*good) {
        const mt_stiffness_factor factor = {
            .rows = r.rows, .b = r.b, .c = r.c, .noise = r.noise, .g = r.g};
        mt_modal_options options = mt_modal_options_default();
        options.accuracy = MT_MODAL_ACCURACY;
        rc = mt_modal_solve(r.k, mass, &factor, &options, mem, &modes, NULL);
        *good = rc == MT_OK && modes.shaped == r.n;
    }
    if (rc == MT_E_MEMORY) {
        return mt_fail_memory(err);
    }
    if (*good) {
        o->lambda = modes.lambda;
        o->y = modes.y;
    }
    return MT_OK;
}

/* C = y^T (Z^T C Z) y. */
static mt_status find_damping(mt_oscillators *o, mt_arena *mem, mt_err *err)
{
    const int n = o->n;
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    double *const c = mt_arena_f64(mem, (size_t)n, (size_t)n);
    double *const cy = mt_arena_f64(mem, (size_t)n, (size_t)n);
    MT_TRY(mt_arena_check(mem, err));
    mt_linear_damping(o->lin, c);
    mt_gemm(false, false, n, n, n, 1.0, c, n, o->y, n, 0.0, cy, n);
    mt_gemm(true, false, n, n, n, 1.0, o->y, n, cy, n, 0.0, o->damping, n);
    mt_arena_rewind(mem, mark);
    return MT_OK;
}

/* noise: sum over springs of |k| |f| |f phi|, f as the rows over the freedoms. */
static void find_noise(mt_oscillators *o)
{
    const mt_term_list *const list = mt_linear_terms(o->lin, MT_TERM_STIFFNESS);
    double *const along = o->work[0];
    for (int i = 0; i < list->n_rows; i++) {
        const mt_term *const t = &list->terms[list->row_term[i]];
        const double *const f = mt_linear_row(o->lin, MT_TERM_STIFFNESS, i);
        const double k = fabs(mt_linear_value(o->lin, t->coefficient));
        mt_gemv(true, o->n, o->n, k * mt_norm2(o->n, f), o->y, o->n, f, 0.0, along);
        for (int j = 0; j < o->n; j++) {
            o->noise[j] += fabs(along[j]) * ROUNDING * o->sys->length_m;
        }
    }
}

/* The force of input i at rest along all states, into o->row. */
static void input_row(mt_oscillators *o, const mt_sim_input *in, mt_gauge_motion *gauge)
{
    if (in->push == MT_SIM_FORCE) {
        const mt_gauge g = {.channel = in->at, .joint = -1};
        mt_motion_gauge(&o->motion, &o->at, o->work[0], g, gauge);
        return;
    }
    memset(o->row, 0, (size_t)o->nq * sizeof *o->row);
    for (int b = 0; b < o->sys->n_bodies; b++) {
        const int dof = o->sys->bodies[b].dof[in->at];
        if (dof >= 0) {
            mt_axpy(o->nq, -1.0, o->motion.mass + ((ptrdiff_t)dof * o->nq), o->row);
        }
    }
}

/* Rows of inputs, gauges and lengths, all at rest. */
static void find_rows(mt_oscillators *o)
{
    mt_gauge_motion gauge = {.row = o->row};
    memset(o->work[0], 0, (size_t)o->nq * sizeof *o->work[0]);
    for (int i = 0; i < o->opt->n_inputs; i++) {
        input_row(o, &o->opt->inputs[i], &gauge);
        mt_gemv(true, o->nq, o->n, 1.0, o->phi, o->nq, o->row, 0.0,
                o->input + ((ptrdiff_t)i * o->n));
    }
    for (ptrdiff_t g = 0; g < o->opt->n_gauges; g++) {
        mt_motion_gauge(&o->motion, &o->at, o->work[0], o->opt->gauges[g], &gauge);
        o->still[g] = mt_motion_has_value(o->sys, o->opt->gauges[g]) ? gauge.value : 0.0;
        for (ptrdiff_t j = 0; j < o->n; j++) {
            o->gauge[g + (j * o->opt->n_gauges)] = mt_dot(o->nq, o->row, o->phi + (j * o->nq));
        }
    }
    for (ptrdiff_t i = 0; i < o->affine.n_lengths; i++) {
        for (ptrdiff_t j = 0; j < o->n; j++) {
            o->length[i + (j * o->affine.n_lengths)] =
                mt_dot(o->n, o->affine.length[i].slope, o->y + (j * o->n));
        }
    }
}

/* True where inputs and gauges are linear. */
static bool has_linear_ports(const mt_oscillators *o)
{
    bool linear = true;
    for (int i = 0; i < o->opt->n_inputs; i++) {
        const mt_sim_input *const in = &o->opt->inputs[i];
        const mt_gauge g = {.channel = in->at, .joint = -1};
        linear = linear && in->push != MT_SIM_MOVE &&
                 (in->push != MT_SIM_FORCE || mt_affine_gauge(o->lin, &o->affine, g));
    }
    for (int i = 0; i < o->opt->n_gauges; i++) {
        linear = linear && mt_affine_gauge(o->lin, &o->affine, o->opt->gauges[i]);
    }
    return linear;
}

mt_status mt_oscillators_make(mt_linear *lin, const mt_sim_options *opt, mt_arena *mem,
                              mt_oscillators *out, bool *linear, mt_err *err)
{
    *out = (mt_oscillators){.lin = lin, .sys = mt_linear_system(lin), .opt = opt};
    MT_TRY(mt_affine_make(lin, mem, &out->affine, err));
    out->nq = out->sys->nq;
    out->n = out->affine.n;
    *linear = out->affine.linear && out->n > 0 && has_linear_ports(out);
    if (!*linear) {
        return MT_OK;
    }
    MT_TRY(find_modes(out, mem, linear, err));
    if (!*linear) {
        return MT_OK;
    }
    MT_TRY(allocate_oscillators(out, mem, err));
    mt_linear_expand(lin, out->n, out->y, out->phi);
    mt_placement_copy(out->sys, &mt_linear_position(lin)->at, &out->at);
    mt_motion_eval(&out->motion, &out->at, out->work[0]);
    MT_TRY(find_damping(out, mem, err));
    find_noise(out);
    find_rows(out);
    return MT_OK;
}

/* out[n] = phi^T M q; returns true where phi out is q. */
static bool project_on_modes(mt_oscillators *o, const double *q, double scale, double *out)
{
    double *const mq = o->work[1];
    mt_gemv(false, o->nq, o->nq, 1.0, o->motion.mass, o->nq, q, 0.0, mq);
    mt_gemv(true, o->nq, o->n, 1.0, o->phi, o->nq, mq, 0.0, out);
    memcpy(mq, q, (size_t)o->nq * sizeof *mq);
    const double size = mt_max_abs(o->nq, q);
    mt_gemv(false, o->nq, o->n, -1.0, o->phi, o->nq, out, 1.0, mq);
    return mt_max_abs(o->nq, mq) <= STARTS * (size + scale);
}

mt_status mt_oscillators_start(mt_oscillators *o, const mt_sim_start *start, double *e,
                               double *rate, bool *linear)
{
    const mt_placement *const rest = &mt_linear_position(o->lin)->at;
    double *const way = o->work[0];
    mt_placement_copy(o->sys, rest, &o->at);
    memset(way, 0, (size_t)o->nq * sizeof *way);
    mt_motion_eval(&o->motion, &o->at, way);
    mt_poses_increment(o->sys, rest->pose, start->at.pose, way);
    *linear = project_on_modes(o, way, o->sys->length_m, e);
    *linear = project_on_modes(o, start->v, 0.0, rate) && *linear;
    /* whole turns are no part of the way */
    mt_oscillators_position(o, e, rate, &o->at, way);
    for (int i = 0; i < o->sys->n_measures; i++) {
        const double off = o->at.turn[i] - start->at.turn[i];
        *linear = *linear && (o->sys->measures[i].kind != MT_MEASURE_ANGLE || fabs(off) < 1.0);
    }
    return MT_OK;
}

void mt_oscillators_position(mt_oscillators *o, const double *e, const double *rate,
                             mt_placement *at, double *v)
{
    double *const y = o->work[1];
    mt_gemv(false, o->n, o->n, 1.0, o->y, o->n, e, 0.0, y);
    mt_affine_position(o->lin, &o->affine, y, o->work[2], at);
    mt_gemv(false, o->nq, o->n, 1.0, o->phi, o->nq, rate, 0.0, v);
}

mt_status mt_oscillators_check(mt_oscillators *o, const double *e, const double *rate,
                               const double *second, const double *u, mt_arena *scratch,
                               mt_oscillators_fit *fit, mt_err *err)
{
    const int n = o->n;
    const int rank = o->nq - n;
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double *const f = mt_arena_f64(scratch, (size_t)o->nq, 1);
    double *const r = mt_arena_f64(scratch, (size_t)n, 1);
    double *const damped = mt_arena_f64(scratch, (size_t)n, 1);
    mt_elimination joints;
    MT_TRY(mt_arena_check(scratch, err));
    mt_oscillators_position(o, e, rate, &o->at, o->row);
    mt_motion_eval(&o->motion, &o->at, o->row);
    MT_TRY(mt_eliminate_factor(o->sys, o->motion.m, o->motion.a, scratch, &joints, err));
    for (int i = 0; i < o->motion.m; i++) {
        const double gap = fabs(o->motion.gap[i]) * joints.dr[i];
        fit->gap_m = !(gap <= fit->gap_m) ? gap : fit->gap_m;
    }
    mt_gemv(true, o->nq, n, -1.0, o->phi, o->nq, o->motion.force, 0.0, r);
    mt_gemv(false, n, n, 1.0, o->damping, n, rate, 0.0, damped);
    mt_gemv(false, o->nq, n, 1.0, o->phi, o->nq, second, 0.0, o->row);
    mt_gemv(false, o->nq, o->nq, 1.0, o->motion.mass, o->nq, o->row, 0.0, f);
    mt_gemv(true, o->nq, n, 1.0, o->phi, o->nq, f, 1.0, r);
    fit->independent = fit->independent && joints.qr.rank == rank;
    for (int j = 0; j < n; j++) {
        fit->size = fmax(fit->size, fabs(second[j]));
        fit->size = fmax(fit->size, fabs(o->lambda[j] * e[j]));
        fit->size = fmax(fit->size, fabs(damped[j]));
    }
    for (int i = 0; i < o->opt->n_inputs; i++) {
        const double *const b = o->input + ((ptrdiff_t)i * n);
        mt_axpy(n, -u[i], b, r);
        fit->size = fmax(fit->size, fabs(u[i]) * mt_max_abs(n, b));
    }
    for (int j = 0; j < n; j++) {
        const double excess = fabs(r[j]) - o->noise[j];
        fit->residual = fmax(fit->residual, fabs(r[j]));
        fit->excess = !(excess <= fit->excess) ? excess : fit->excess;
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}

bool mt_oscillators_fits(const mt_oscillators_fit *fit)
{
    return fit->independent && fit->excess <= FITS * fit->size;
}
