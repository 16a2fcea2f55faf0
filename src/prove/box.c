/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * One box: bounds of the coefficients, corner matrices, inertia counts.
 *
 * A count is the number of negative pivots of A - sigma M = L D L^T without pivoting, which
 * keeps chains and bands sparse. What is computed is the exact factorisation of a matrix that
 * differs by E, |E| <= g |L||D||L|^T, g = (n + 1) eps (Higham, Accuracy and Stability of
 * Numerical Algorithms, 2002, ch. 10), so that
 *     ||E||_2 <= g trace(|L||D||L|^T) = g sum_k |d_k| (1 + sum_i l_ik^2),
 * which costs nothing to sum up: growth is seen, not assumed. Since M >= mu I, shifting sigma
 * by e / mu in the safe direction makes the count a bound as long as ||E|| <= e. Where growth
 * is larger, pivoting decides (mt_inertia); where its gap is at rounding level too, nothing is
 * said.
 *
 * e = slack_k + slack_m lambda, at least HARMLESS lambda.
 */
#include "prove/box.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "linalg/dense.h"
#include "prove/enclosure.h"

/* A shift of lambda by this share moves a frequency by half of it: far below the 1e-6 within
 * which goals are met, and room for the growth of a factorisation without pivoting in all but
 * one case in a thousand or so. */
static const double HARMLESS = 1e-9;
/* The part of the slack that rounding of A and M itself is given; the rest is for the
 * factorisation. */
static const double SHARE_OF_DATA = 0.5;
/* Below this share of n eps a pivot ratio says nothing (mt_inertia's gap). */
static const double UNSURE_ULPS = 16.0;
/* What an entry copied and a node enclosed cost, in multiplications of a factorisation. */
static const double COPY = 1.0;
static const double NODE = 50.0;

double mt_enclosure_lambda(double hz)
{
    static const double TWO_PI = 6.283185307179586476925;
    return (TWO_PI * hz) * (TWO_PI * hz);
}

static void add_parts(mt_enclosure *e, mt_enclosure_matrix m, mt_side side)
{
    double *const out = e->at[m][side];
    memcpy(out, e->fixed[m], (size_t)e->n * (size_t)e->n * sizeof *out);
    e->operations += COPY * (double)e->n * (double)e->n;
    for (int i = 0; i < e->n_coefficients; i++) {
        const mt_enclosure_part *const p = &e->coefficients[i].part[m];
        const double c = e->value[side][i];
        for (int k = 0; k < p->count; k++) {
            out[p->at[k]] += c * p->value[k];
        }
        e->operations += p->count;
    }
}

static mt_side other(mt_side side)
{
    return side == MT_LOW ? MT_HIGH : MT_LOW;
}

/* Both matrices of a corner of the current box. */
static void assemble_corner(mt_enclosure *e, mt_side side)
{
    if (!e->assembled[side]) {
        add_parts(e, MT_STIFFNESS, side);
        if (e->mass_varies) {
            add_parts(e, MT_MASS, other(side));
        }
        e->assembled[side] = true;
    }
}

int mt_enclosure_corner_key(const mt_enclosure *e, mt_side side)
{
    uint64_t key = 1;
    for (int i = 0; i < e->n_coefficients; i++) {
        for (mt_enclosure_matrix m = MT_STIFFNESS; m <= MT_MASS; m++) {
            if (e->coefficients[i].part[m].count > 0) {
                uint64_t bits = 0;
                memcpy(&bits, &e->value[m == MT_STIFFNESS ? side : other(side)][i],
                       sizeof bits);
                key = (key ^ bits) * 0x9E3779B97F4A7C15U; /* 2^64 / golden ratio */
                key ^= key >> 32;
            }
        }
    }
    return (int)(key >> 33);
}

/* mu: M at the box's low end is at least mu times M at that of the bounds (the identity); 0
 * where it may not be. */
static double least_mass_share(const mt_enclosure *e)
{
    double mu = 1.0;
    for (int i = 0; i < e->n_coefficients; i++) {
        const mt_enclosure_coefficient *const c = &e->coefficients[i];
        if (c->part[MT_MASS].count > 0 && e->value[MT_LOW][i] < c->least) {
            mu = fmin(mu, e->value[MT_LOW][i] / c->least);
        }
    }
    return mu;
}

static bool moves_geometry(const mt_enclosure *e, const double *lo, const double *hi)
{
    bool moved = false;
    for (int i = 0; i < e->n_inputs; i++) {
        moved = moved || (e->frozen[i] && (lo[i] != e->lower[i] || hi[i] != e->upper[i]));
    }
    return moved;
}

bool mt_enclosure_set(mt_enclosure *e, const double *lo, const double *hi)
{
    double k_scale = e->fixed_norm;
    double m_scale = 0.0;
    bool within = true; /* the bounds */
    if (mt_interrupted(e->interrupt) || moves_geometry(e, lo, hi)) {
        return false;
    }
    mt_enclosure_bounds(e, lo, hi);
    e->operations += NODE * (double)e->program.count;
    for (int i = 0; i < e->n_coefficients; i++) {
        const bool either = e->coefficients[i].required != MT_SIGN_POSITIVE;
        const bool freed = e->coefficients[i].most <= DBL_MIN && e->value[MT_HIGH][i] > DBL_MIN;
        if (!(either ? isfinite(e->value[MT_LOW][i]) : e->value[MT_LOW][i] >= 0.0) ||
            !isfinite(e->value[MT_HIGH][i]) || (freed && !either)) {
            return false;
        }
        within = within && e->value[MT_LOW][i] >= e->coefficients[i].least;
        k_scale += fmax(fabs(e->value[MT_LOW][i]), fabs(e->value[MT_HIGH][i])) *
                   e->coefficients[i].part[MT_STIFFNESS].trace;
        m_scale += e->value[MT_HIGH][i] * e->coefficients[i].part[MT_MASS].trace;
    }
    if (!e->squares && !within) {
        return false;
    }
    const double mu = least_mass_share(e);
    if (!(mu > 0.0)) {
        return false;
    }
    for (ptrdiff_t i = 0; i < e->n; i++) {
        m_scale += e->mass_varies ? e->fixed[MT_MASS][i * (e->n + 1)] : 0.0;
    }
    e->assembled[MT_LOW] = false;
    e->assembled[MT_HIGH] = false;
    e->slack_k = e->roundoff * k_scale / mu;
    e->slack_m = e->roundoff * (e->mass_varies ? m_scale : 1.0) / mu;
    return true;
}

/* w (lower) := A - sigma M. */
static void shifted(const mt_enclosure *e, const double *k, const double *m, double sigma,
                    double *w)
{
    const ptrdiff_t n = e->n;
    for (ptrdiff_t j = 0; j < n; j++) {
        if (m != NULL) {
            for (ptrdiff_t i = j; i < n; i++) {
                w[i + (j * n)] = k[i + (j * n)] - (sigma * m[i + (j * n)]);
            }
        } else {
            memcpy(w + j + (j * n), k + j + (j * n), (size_t)(n - j) * sizeof *w);
            w[j + (j * n)] -= sigma;
        }
    }
}

/* Negative pivots of w (destroyed); growth: trace(|L||D||L|^T). A zero pivot counts as tiny and
 * negative; the growth then tells. */
static int negative_pivots(ptrdiff_t n, double *w, double *growth, double *operations)
{
    int negative = 0;
    double sum = 0.0;
    ptrdiff_t done = 0;
    for (ptrdiff_t k = 0; k < n; k++) {
        double *const col = w + (k * n);
        const double d = col[k] == 0.0 ? -DBL_MIN : col[k];
        const double inverse = 1.0 / d;
        double squares = 0.0;
        negative += d < 0.0 ? 1 : 0;
        for (ptrdiff_t j = k + 1; j < n; j++) {
            if (col[j] == 0.0) {
                continue;
            }
            const double l = col[j] * inverse;
            double *const target = w + (j * n);
            squares += col[j] * l;
            done += n - j;
            for (ptrdiff_t i = j; i < n; i++) {
                target[i] -= col[i] * l;
            }
        }
        sum += fabs(d) + fabs(squares);
    }
    *growth = sum;
    *operations += (double)done;
    return negative;
}

/* Modes below sigma at a corner, rigid-body modes included; -1: unsure. room: how far E may
 * go. */
static int count_below(mt_enclosure *e, mt_side side, double sigma, double room)
{
    const double *const k = e->at[MT_STIFFNESS][side];
    const double *const m = e->mass_varies ? e->at[MT_MASS][other(side)] : NULL;
    const double g = (double)(e->n + 2) * DBL_EPSILON;
    double growth = 0.0;
    e->counts++;
    assemble_corner(e, side);
    shifted(e, k, m, sigma, e->work);
    e->operations += COPY * (double)e->n * (double)e->n;
    const int negative = negative_pivots(e->n, e->work, &growth, &e->operations);
    if (g * growth <= room) { /* false for NaN */
        return negative;
    }
    int count[3];
    double gap = 0.0;
    e->fallbacks++;
    e->operations += (double)e->n * (double)e->n * (double)e->n;
    const mt_status rc = mt_inertia(e->n, k, m, sigma, count, &gap, &e->scratch, NULL);
    const bool sure = rc == MT_OK && gap > UNSURE_ULPS * (double)e->n * DBL_EPSILON;
    return sure ? count[0] : -1;
}

static double slack(const mt_enclosure *e, double lambda)
{
    return fmax(e->slack_k + (e->slack_m * lambda), HARMLESS * lambda);
}

static int vibrating(const mt_enclosure *e, int count)
{
    const int n = count - e->n_rigid;
    return n < 0 ? 0 : (n > e->n_modes ? e->n_modes : n);
}

int mt_enclosure_most_below(mt_enclosure *e, double lambda)
{
    const double shift = slack(e, lambda);
    const int count = count_below(e, MT_LOW, lambda + shift, SHARE_OF_DATA * shift);
    return count < 0 ? e->n_modes : vibrating(e, count);
}

int mt_enclosure_least_below(mt_enclosure *e, double lambda)
{
    const double shift = slack(e, lambda);
    if (!(lambda - shift > 0.0)) {
        return 0;
    }
    const int count = count_below(e, MT_HIGH, lambda - shift, SHARE_OF_DATA * shift);
    return count < 0 ? 0 : vibrating(e, count);
}

/* Eigenvalues of a corner into lambda; *error: slack_k + slack_m |lambda| and the solver's
 * own. */
static mt_status solve_corner(mt_enclosure *e, mt_side side, mt_modes *modes, mt_err *err)
{
    mt_mass_factor mass;
    *modes = (mt_modes){0};
    assemble_corner(e, side);
    MT_TRY(e->mass_varies ? mt_modal_factor_mass(e->n, e->at[MT_MASS][other(side)], &e->scratch,
                                                 &mass, err)
                          : mt_modal_identity_mass(e->n, &e->scratch, &mass, err));
    mt_modal_options opt = mt_modal_options_default();
    opt.n_rigid = e->n_rigid;
    opt.vectors = false;
    opt.check = false;
    return mt_modal_solve(e->at[MT_STIFFNESS][side], &mass, NULL, &opt, &e->scratch, modes,
                          err);
}

static double hz_of(double lambda)
{
    static const double TWO_PI = 6.283185307179586476925;
    return lambda > 0.0 ? sqrt(lambda) / TWO_PI : 0.0;
}

/* Widening of a frequency for the square root and division above. */
static const double HZ_ULPS = 4.0;

static mt_status ranges(mt_enclosure *e, double *low, double *high, mt_err *err)
{
    mt_modes modes;
    for (mt_side s = MT_LOW; s <= MT_HIGH; s++) {
        MT_TRY(solve_corner(e, s, &modes, err));
        for (int k = 0; k < e->n_modes; k++) {
            const double lambda = modes.lambda[e->n_rigid + k];
            const double error = modes.error_bound + e->slack_k +
                                 ((modes.error_relative + e->slack_m) * fabs(lambda));
            const double ulps = HZ_ULPS * DBL_EPSILON;
            if (s == MT_LOW) {
                low[k] = hz_of(lambda - error) * (1.0 - ulps);
            } else {
                high[k] = hz_of(lambda + error) * (1.0 + ulps);
            }
        }
    }
    return MT_OK;
}

mt_status mt_enclosure_ranges(mt_enclosure *e, double *low, double *high, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    const mt_status rc = ranges(e, low, high, err);
    mt_arena_rewind(&e->scratch, mark);
    return rc;
}
