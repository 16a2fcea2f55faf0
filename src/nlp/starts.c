/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Where the local searches begin: the original design, then a low-discrepancy sequence over the
 * bounds, turned by a shift modulo 1 that depends on the seed (Cranley and Patterson 1976; seed
 * 0 and 1: the sequence as it is). GSL's Sobol generator knows 40 dimensions and is silent
 * beyond; its reverse Halton knows 1229; past that, pseudo-random numbers are as good.
 *
 * The state of a generator lies in an arena: of what gsl_qrng_alloc and _free would do, only
 * the shortage of memory calls GSL's error handler, which belongs to the whole process. So
 * nothing here calls it, whatever a program has it do, and any number of threads may be here at
 * once.
 */
#include "nlp/starts.h"

#include <gsl/gsl_qrng.h>
#include <math.h>
#include <string.h>

#include "nlp/engine.h"

enum { SOBOL_MOST = 40, HALTON_MOST = 1229 };

/* splitmix64 (Steele, Lea, Flood 2014): one step, a number in [0, 1). */
static double next_uniform(uint64_t *state)
{
    *state += UINT64_C(0x9E3779B97F4A7C15);
    uint64_t z = *state;
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    z ^= z >> 31;
    return (double)(z >> 11) * 0x1p-53;
}

/* The sequence of d dimensions at its start; without a type where there is none. */
static gsl_qrng sequence(int d, mt_arena *mem)
{
    gsl_qrng q = {.dimension = (unsigned)d};
    if (d >= 1 && d <= HALTON_MOST) {
        q.type = d <= SOBOL_MOST ? gsl_qrng_sobol : gsl_qrng_reversehalton;
        q.state_size = q.type->state_size(q.dimension);
        q.state = mt_arena_alloc(mem, 1, q.state_size);
    }
    if (q.state != NULL) {
        gsl_qrng_init(&q);
    }
    return q;
}

/* The next point u[d] of the unit cube. */
static void next_point(gsl_qrng *q, uint64_t *state, int d, const double *shift, double *u)
{
    if (q->type != NULL) {
        (void)gsl_qrng_get(q, u);
    }
    for (int j = 0; j < d; j++) {
        const double x = q->type != NULL ? u[j] : next_uniform(state);
        u[j] = x + shift[j] - floor(x + shift[j]);
    }
}

double *mt_nlp_starts(const mt_nlp *nlp, unsigned long seed, int starts, mt_arena *mem)
{
    int d = 0;
    for (int j = 0; j < nlp->n; j++) {
        d += nlp->lower[j] < nlp->upper[j];
    }
    double *const t = mt_arena_f64(mem, (size_t)nlp->n, (size_t)starts);
    double *const shift = mt_arena_f64(mem, (size_t)d, 1);
    double *const u = mt_arena_f64(mem, (size_t)d, 1);
    gsl_qrng q = sequence(d, mem);
    if (mt_arena_failed(mem)) {
        return NULL;
    }
    uint64_t state = seed;
    for (int j = 0; j < d && seed > 1; j++) {
        shift[j] = next_uniform(&state);
    }
    for (int k = 0; k < starts; k++) {
        const bool hint = k == 1 && nlp->hint != NULL;
        if (k > 0 && !hint) {
            next_point(&q, &state, d, shift, u);
        }
        for (int j = 0, i = 0; j < nlp->n; j++) {
            const double width = nlp->upper[j] - nlp->lower[j];
            const bool moves = k > 0 && !hint && width > 0;
            const double at = moves  ? nlp->lower[j] + u[i++] * width
                              : hint ? nlp->hint[j]
                                     : nlp->origin[j];
            t[j + (ptrdiff_t)k * nlp->n] = mt_nlp_clamp(nlp, j, at);
        }
    }
    return t;
}
