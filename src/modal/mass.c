/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The mass matrix, factored. Rows of M may have different units, so questions of rank are asked
 * of the scaled matrix S = D M D with D = diag(m_ii)^-1/2, whose diagonal is one and whose
 * eigenvalues say which part of its own mass a direction keeps.
 *
 * Usual case: Cholesky, M = L L^T. With W = M^-1 (from L^-1) the numbers m_ii W_ii are the
 * diagonal of S^-1, hence
 *     1 / (n max_i m_ii W_ii)  <=  lambda_min(S)  <=  1 / max_i m_ii W_ii,
 * a two-sided bound that costs n^3/3: where even the lower one is above the tolerance, M is
 * regular for certain. Cholesky does not mind scaling, so S is never formed.
 *
 * Else the eigenvectors V of S split the space: T1 = D V1 e1^-1/2 has mass (T1^T M T1 = I),
 * T0 = D V0 has none.
 */
#include "modal/mass.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "linalg/dense.h"
#include "modal/modes.h"

/* See mt_modal_relative: twice what was met. */
static const double ASSEMBLY_ULPS = 64.0;

double mt_modal_tolerance(int n)
{
    return MT_MODAL_NOISE_ULPS * (double)n * DBL_EPSILON;
}

double mt_modal_relative(int n)
{
    return mt_modal_tolerance(n) + ASSEMBLY_ULPS * DBL_EPSILON;
}

/* d_i = 1/sqrt(m_ii), 0 for coordinates without mass. False where there are such. Fails on a
 * negative mass. */
static mt_status scaling(int n, const double *m, double *d, bool *all, mt_err *err)
{
    const double tol = mt_modal_tolerance(n);
    double most = 0.0;
    for (int i = 0; i < n; i++) {
        most = fmax(most, fabs(m[i + (ptrdiff_t)i * n]));
    }
    const double floor = tol * tol * most;
    *all = true;
    for (int i = 0; i < n; i++) {
        const double mii = m[i + (ptrdiff_t)i * n];
        if (mii < -floor) {
            return mt_fail(err, MT_E_NOT_SPD, "mass matrix: negative mass %g at coordinate %d",
                           mii, i + 1);
        }
        d[i] = mii > floor ? 1.0 / sqrt(mii) : 0.0;
        *all = *all && d[i] > 0.0;
    }
    return MT_OK;
}

/* w_i = (M^-1)_ii and the largest m_ii w_i. */
static double inverse_diagonal(int n, const double *linv, const double *d, double *w)
{
    double condition = 1.0;
    for (int i = 0; i < n; i++) {
        double sum = 0.0;
        for (int r = i; r < n; r++) {
            const double e = linv[r + (ptrdiff_t)i * n];
            sum += e * e;
        }
        w[i] = sum;
        condition = fmax(condition, sum / (d[i] * d[i]));
    }
    return condition;
}

/* A positive semidefinite matrix has |m_ij|^2 <= m_ii m_jj: a coordinate without mass couples
 * with none. */
static mt_status check_coupling(int n, const double *m, const double *d, mt_err *err)
{
    double most = 0.0;
    for (int i = 0; i < n; i++) {
        most = fmax(most, m[i + (ptrdiff_t)i * n]);
    }
    const double tol = 2.0 * mt_modal_tolerance(n);
    for (int j = 0; j < n; j++) {
        for (int i = j + 1; i < n; i++) {
            const double mij = m[i + (ptrdiff_t)j * n];
            const double mass = fmax(m[i + (ptrdiff_t)i * n], m[j + (ptrdiff_t)j * n]);
            const bool checked = !(d[i] > 0.0) || !(d[j] > 0.0);
            if (checked && fabs(mij) > tol * sqrt(most * fmax(mass, tol * tol * most))) {
                return mt_fail(
                    err, MT_E_NOT_SPD,
                    "mass matrix: coordinate %d or %d has no mass but is coupled (%g)", i + 1,
                    j + 1, mij);
            }
        }
    }
    return MT_OK;
}

/* Try M = L L^T; *regular: M is regular enough. */
static mt_status by_cholesky(mt_mass_factor *f, double *l, const double *d, double *w,
                             mt_arena *scratch, bool *regular, mt_err *err)
{
    const int n = f->n;
    memcpy(l, f->m, (size_t)n * (size_t)n * sizeof *l);
    *regular = false;
    const mt_status rc = mt_cholesky(n, l, NULL, NULL);
    if (rc == MT_E_NOT_SPD) {
        return MT_OK;
    }
    if (rc != MT_OK) {
        return mt_fail(err, rc, "mass matrix: %s", mt_status_text(rc));
    }
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double *const linv = mt_arena_f64(scratch, (size_t)n, (size_t)n);
    MT_TRY(mt_arena_check(scratch, err));
    mt_tri_inverse(n, l, linv);
    f->condition = inverse_diagonal(n, linv, d, w);
    mt_arena_rewind(scratch, mark);
    *regular = f->condition * (double)n * mt_modal_tolerance(n) < 1.0;
    return MT_OK;
}

static void scaled_mass(int n, const double *m, const double *d, double *s)
{
    for (int j = 0; j < n; j++) {
        for (int i = j; i < n; i++) {
            s[i + (ptrdiff_t)j * n] = d[i] * m[i + (ptrdiff_t)j * n] * d[j];
        }
    }
}

/* v: eigenvectors of S with ascending eigenvalues e. t := [T1 T0], w := diag(T1 T1^T). */
static void fill_basis(mt_mass_factor *f, const double *v, const double *e, double *t,
                       double *w)
{
    const int n = f->n;
    const int massless = n - f->rank;
    for (int j = 0; j < n; j++) {
        const bool has_mass = j >= massless;
        const double factor = has_mass ? 1.0 / sqrt(e[j]) : 1.0;
        const int column = has_mass ? j - massless : f->rank + j;
        double *const tj = t + (ptrdiff_t)column * n;
        for (int i = 0; i < n; i++) {
            const double di = f->d[i] > 0.0 ? f->d[i] : 1.0;
            /* a coordinate without mass is no part of T1 */
            const double mass_row = f->d[i] > 0.0 ? 1.0 : 0.0;
            tj[i] = di * v[i + (ptrdiff_t)j * n] * factor * (has_mass ? mass_row : 1.0);
            w[i] += has_mass ? tj[i] * tj[i] : 0.0;
        }
    }
}

static mt_status by_split(mt_mass_factor *f, double *t, double *w, mt_arena *scratch,
                          mt_err *err)
{
    const int n = f->n;
    const double tol = mt_modal_tolerance(n);
    double *const v = mt_arena_f64(scratch, (size_t)n, (size_t)n);
    double *const e = mt_arena_f64(scratch, (size_t)n, 1);
    MT_TRY(mt_arena_check(scratch, err));
    scaled_mass(n, f->m, f->d, v);
    MT_TRY(mt_eig_sym(n, v, e, true, scratch, err));
    int massless = 0;
    while (massless < n && e[massless] <= tol) {
        massless++;
    }
    if (n > 0 && e[0] < -tol) {
        return mt_fail(err, MT_E_NOT_SPD,
                       "mass matrix: a direction has negative mass (%g of its own)", e[0]);
    }
    f->rank = n - massless;
    memset(w, 0, (size_t)n * sizeof *w);
    fill_basis(f, v, e, t, w);
    f->condition = massless > 0 ? HUGE_VAL : 1.0 / e[0];
    f->kept = massless < n ? 1.0 / e[massless] : 1.0;
    return MT_OK;
}

mt_status mt_modal_factor_mass(int n, const double *m, mt_arena *mem, mt_mass_factor *out,
                               mt_err *err)
{
    *out = (mt_mass_factor){.n = n, .rank = n, .m = m, .condition = 1.0, .kept = 1.0};
    double *const l = mt_arena_f64(mem, (size_t)n, (size_t)n);
    double *const d = mt_arena_f64(mem, (size_t)n, 1);
    double *const w = mt_arena_f64(mem, (size_t)n, 1);
    MT_TRY(mt_arena_check(mem, err));
    if (n == 0) {
        return MT_OK;
    }
    if (!mt_lower_finite(n, m)) {
        return mt_fail(err, MT_E_DOMAIN, "mass matrix: an entry is not a finite number");
    }
    out->d = d;
    out->w = w;
    bool regular = false;
    MT_TRY(scaling(n, m, d, &regular, err));
    if (regular) {
        MT_TRY(by_cholesky(out, l, d, w, mem, &regular, err));
    }
    if (regular) {
        out->l = l;
        out->kept = out->condition;
        return MT_OK;
    }
    MT_TRY(check_coupling(n, m, d, err));
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    const mt_status rc = by_split(out, l, w, mem, err);
    mt_arena_rewind(mem, mark);
    out->t = l;
    return rc;
}

mt_status mt_modal_identity_mass(int n, mt_arena *mem, mt_mass_factor *out, mt_err *err)
{
    *out = (mt_mass_factor){.n = n, .rank = n, .condition = 1.0, .kept = 1.0};
    double *const ones = mt_arena_f64(mem, (size_t)n, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < n; i++) {
        ones[i] = 1.0;
    }
    out->d = ones;
    out->w = ones;
    return MT_OK;
}

void mt_modal_back(const mt_mass_factor *mass, int count, const double *q, double *y)
{
    const int n = mass->n;
    if (mass->t != NULL) {
        mt_gemm(false, false, n, count, n, 1.0, mass->t, n, q, n, 0.0, y, n);
        return;
    }
    if (y != q) {
        memcpy(y, q, (size_t)n * (size_t)count * sizeof *y);
    }
    if (mass->l != NULL) {
        mt_tri_solve(true, n, count, mass->l, y, n);
    }
}
