/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A placement asks of each mode that its frequency stay below some bands and above others,
 *
 *     least_j <= ln f_j <= most_j.
 *
 * To first order, ln f_j = ln f_j(original) + g_j u, the change is |u|, and the least one
 *
 *     minimise 1/2 |u|^2   subject to   least_j <= ln f_j(original) + g_j u <= most_j
 *
 * a quadratic program whose dual is ascended coordinate by coordinate (Hildreth 1957): with the
 * multipliers m >= 0 of the rows a_k u >= b_k,
 *
 *     u = sum m_k a_k,   m_k <- max(0, m_k + (b_k - a_k u) / |a_k|^2),
 *
 * and sum m_k b_k - 1/2 |u|^2 rises to the least change. Some sweeps are enough for an order.
 */
#include "search/mode_placements_estimates.h"

#include <math.h>
#include <string.h>

enum { SWEEPS = 30 };
/* Step of the differences, in t. */
static const double STEP = 1e-3;

/* ln of the frequencies at the point x. */
static mt_status find_frequencies(const mt_proof *proof, const double *x, double *out,
                                  mt_arena *mem, mt_err *err)
{
    for (int v = 0; v < proof->question.n_views; v++) {
        mt_enclosure *const e = proof->views[v];
        const size_t n = (size_t)e->n_modes;
        double *const low = mt_arena_f64(mem, n, 1);
        double *const high = mt_arena_f64(mem, n, 1);
        MT_TRY(mt_arena_check(mem, err));
        const bool known = mt_enclosure_set(e, x, x);
        MT_TRY(known ? mt_enclosure_ranges(e, low, high, err) : MT_OK);
        for (size_t j = 0; j < n; j++) {
            const double hz = 0.5 * (low[j] + high[j]);
            *out++ = known && hz > 0.0 ? log(hz) : nan("");
        }
    }
    return MT_OK;
}

static mt_status find_gradient(mt_mode_placement_estimates *e, mt_arena *mem, mt_err *err)
{
    const mt_subproblem *const c = e->c;
    const size_t n = (size_t)c->p->n;
    const size_t n_modes = (size_t)e->n_modes;
    double *const t = mt_arena_f64(mem, n, 1);
    double *const x = mt_arena_f64(mem, n, 1);
    double *const moved = mt_arena_f64(mem, n_modes, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (size_t i = 0; i < n; i++) {
        t[i] = fmin(fmax(c->origin_t[i], c->lower_t[i]), c->upper_t[i]);
    }
    mt_subproblem_x(c, t, x);
    MT_TRY(find_frequencies(e->proof, x, e->ln_f, mem, err));
    for (size_t i = 0; i < n; i++) {
        const double at = t[i];
        const double room = c->upper_t[i] - c->lower_t[i];
        const double size = fmin(STEP, 0.5 * room);
        const double step = at + size <= c->upper_t[i] ? size : -size;
        const double unit = step * sqrt(c->p->study->variables[i].weight);
        if (!(room > 0.0)) {
            continue;
        }
        t[i] = at + step;
        mt_subproblem_x(c, t, x);
        t[i] = at;
        MT_TRY(find_frequencies(e->proof, x, moved, mem, err));
        for (size_t j = 0; j < n_modes; j++) {
            const double slope = (moved[j] - e->ln_f[j]) / unit;
            e->gradient[(j * n) + i] = isfinite(slope) ? slope : 0.0;
        }
    }
    return MT_OK;
}

mt_status mt_mode_placement_estimates_make(const mt_subproblem *c, const mt_proof *proof,
                                           mt_arena *mem, mt_mode_placement_estimates *out,
                                           mt_err *err)
{
    const size_t n = (size_t)c->p->n;
    *out = (mt_mode_placement_estimates){.c = c, .proof = proof};
    for (int v = 0; v < proof->question.n_views; v++) {
        out->n_modes += proof->views[v]->n_modes;
    }
    const size_t n_modes = (size_t)out->n_modes;
    out->ln_f = mt_arena_f64(mem, n_modes, 1);
    out->gradient = mt_arena_f64(mem, n_modes, n);
    out->u = mt_arena_f64(mem, n, 1);
    out->least = mt_arena_f64(mem, n_modes, 1);
    out->most = mt_arena_f64(mem, n_modes, 1);
    out->multiplier = mt_arena_f64(mem, n_modes, 2);
    MT_TRY(mt_arena_check(mem, err));
    return find_gradient(out, mem, err);
}

/* What the placement asks of each mode. */
static void find_limits(const mt_mode_placement_estimates *e, const int *below)
{
    const mt_proof *const proof = e->proof;
    int first = 0;
    for (int j = 0; j < e->n_modes; j++) {
        e->least[j] = -HUGE_VAL;
        e->most[j] = HUGE_VAL;
    }
    for (int v = 0; v < proof->question.n_views; v++) {
        const int n = proof->views[v]->n_modes;
        for (int i = 0; i < proof->question.n_bands; i++) {
            const mt_certify_band *const b = &proof->bands[i];
            const int k = below[i];
            if (b->view == v && k > 0 && k <= n && b->lower_hz > 0.0) {
                double *const most = &e->most[first + k - 1];
                *most = fmin(*most, log(b->lower_hz));
            }
            if (b->view == v && k < n) {
                double *const least = &e->least[first + k];
                *least = fmax(*least, log(b->upper_hz));
            }
        }
        first += n;
    }
}

/* One step of the dual for the row sign (g u - b) >= 0; returns its part of sum m b. */
static double ascend(const mt_mode_placement_estimates *e, int mode, double sign, double b,
                     double *multiplier)
{
    const int n = e->c->p->n;
    const double *const g = e->gradient + ((ptrdiff_t)mode * n);
    double square = 0.0;
    double value = 0.0;
    if (!isfinite(b)) {
        return 0.0;
    }
    for (int i = 0; i < n; i++) {
        square += g[i] * g[i];
        value += g[i] * e->u[i];
    }
    if (!(square > 0.0)) {
        return 0.0;
    }
    const double before = *multiplier;
    *multiplier = fmax(0.0, before + (sign * (b - value) / square));
    for (int i = 0; i < n; i++) {
        e->u[i] += (*multiplier - before) * sign * g[i];
    }
    return *multiplier * sign * b;
}

double mt_mode_placement_estimate(const mt_mode_placement_estimates *e, const int *below)
{
    const int n = e->c->p->n;
    double linear = 0.0;
    double square = 0.0;
    find_limits(e, below);
    memset(e->u, 0, (size_t)n * sizeof *e->u);
    memset(e->multiplier, 0, 2 * (size_t)e->n_modes * sizeof *e->multiplier);
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        linear = 0.0;
        for (int j = 0; j < e->n_modes; j++) {
            double *const m = e->multiplier + (2 * (ptrdiff_t)j);
            linear += ascend(e, j, 1.0, e->least[j] - e->ln_f[j], &m[0]);
            linear += ascend(e, j, -1.0, e->most[j] - e->ln_f[j], &m[1]);
        }
    }
    for (int i = 0; i < n; i++) {
        square += e->u[i] * e->u[i];
    }
    return fmax(linear - (0.5 * square), 0.0);
}
