/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Where a gauge turns back: by halves of a step while its velocity keeps its sign, then, within
 * |A h| < 1/2, by Newton's method on the velocity, each step by Taylor's series.
 */
#include "simulate/propagate_priv.h"

#include <math.h>
#include <string.h>

/* A Newton step below this part of the last half is the last one. */
static const double TURN_FOUND = 1e-15;
enum { TURN_STEPS = 6, TURN_TERMS = 20 };

void mt_propagation_see(const mt_propagation *r, int g, double out[3])
{
    const ptrdiff_t gauges = r->opt->n_gauges;
    out[0] = r->o.still[g];
    out[1] = 0.0;
    out[2] = 0.0;
    for (ptrdiff_t j = 0; j < r->n; j++) {
        const double row = r->o.gauge[g + (j * gauges)];
        out[0] += row * (r->z[j] / r->w[j]);
        out[1] += row * r->z[r->n + j];
    }
    for (ptrdiff_t j = 0; j < r->nz; j++) {
        out[2] += r->see[g + (j * gauges)] * r->z[j];
    }
}

/* Find where gauge g turns within the step of e->f[from] from t, which begins at r->z. */
static mt_status find_turning(mt_propagation *r, const mt_exponential *e, int from, double t,
                              int g, mt_err *err)
{
    const double sign = r->speed[g];
    double h = ldexp(e->h, -from);
    double read[3];
    for (int j = from + 1; j <= e->kept; j++) {
        memcpy(r->rate, r->z, (size_t)r->nz * sizeof *r->z);
        h *= 0.5;
        mt_exponential_step(e, j, r->z, r->work);
        mt_propagation_see(r, g, read);
        if (read[1] * sign < 0.0) {
            memcpy(r->z, r->rate, (size_t)r->nz * sizeof *r->z);
        } else {
            t += h;
        }
    }
    double left = h;
    for (int i = 0; i < TURN_STEPS && fabs(left) > TURN_FOUND * h; i++) {
        mt_propagation_see(r, g, read);
        left = read[2] != 0.0 ? fmin(fmax(-read[1] / read[2], -h), h) : 0.0;
        memcpy(r->rate, r->z, (size_t)r->nz * sizeof *r->z);
        for (int k = 1; k <= TURN_TERMS; k++) {
            mt_gemv(false, r->nz, r->nz, left / k, r->a, r->nz, r->rate, 0.0, r->work);
            memcpy(r->rate, r->work, (size_t)r->nz * sizeof *r->z);
            mt_axpy(r->nz, 1.0, r->rate, r->z);
        }
        t += left;
    }
    mt_propagation_see(r, g, read);
    mt_turnings *const list = &r->out->turnings[g];
    list->at = mt_arena_grow(r->mem, list->at, list->n, &list->room, sizeof *list->at);
    MT_TRY(mt_arena_check(r->mem, err));
    list->at[list->n++] = (mt_turning){.t = t, .value = read[0], .highest = sign > 0.0};
    return MT_OK;
}

mt_status mt_propagation_turnings(mt_propagation *r, const mt_exponential *e, int j, double t,
                                  mt_err *err)
{
    double *const end = r->z;
    for (int k = 0; k < r->o.nq; k++) {
        double v = 0.0;
        for (ptrdiff_t i = 0; i < r->n; i++) {
            v += r->o.phi[k + (i * r->o.nq)] * end[r->n + i];
        }
        r->fast = fmax(r->fast, r->turn_weight[k] * fabs(v));
    }
    for (int g = 0; g < r->opt->n_gauges; g++) {
        double read[3];
        mt_propagation_see(r, g, read);
        const double least = r->opt->tolerance * r->fast;
        const double from = r->speed[g];
        if (from * read[1] < 0.0 && fmax(fabs(from), fabs(read[1])) > least) {
            memcpy(r->inner, r->begin, (size_t)r->nz * sizeof *r->z);
            r->z = r->inner;
            const mt_status rc = find_turning(r, e, j, t, g, err);
            r->z = end;
            MT_TRY(rc);
        }
        r->speed[g] = read[1];
    }
    return MT_OK;
}
