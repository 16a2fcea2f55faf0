/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A = L^-1 K L^-T (or T^T K T, or the condensed matrix), A Q = Q Lambda by mt_eig_sym, or in
 * two steps where few columns of Q are wanted; Y = L^-T Q (or T1 Q). Absolute error of each
 * lambda: about n eps s. */
#include "modal/modal_priv.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "linalg/dense.h"

/* s = max(|lambda|max, max |K_ii| (M^-1)_ii). */
static double stiffness_scale(const double *k, const mt_mass_factor *mass,
                              const mt_modes *modes)
{
    double s = mt_max_abs(modes->all, modes->lambda);
    for (int i = 0; i < mass->n; i++) {
        s = fmax(s, fabs(k[i + (ptrdiff_t)i * mass->n]) * mass->w[i]);
    }
    return s;
}

/* Regular M: q := A, lower; a and q n x n, the same where mass->t is NULL. */
static void standard(const double *k, const mt_mass_factor *mass, double *a, double *q)
{
    const int n = mass->n;
    if (mass->t != NULL) {
        mt_symm(n, n, k, mass->t, a);
        mt_gemm(true, false, n, n, n, 1.0, mass->t, n, a, n, 0.0, q, n);
    } else {
        for (int j = 0; j < n; j++) {
            const ptrdiff_t jj = j + (ptrdiff_t)j * n;
            memcpy(a + jj, k + jj, (size_t)(n - j) * sizeof *a);
        }
        if (mass->l != NULL) {
            mt_congruence_inverse(n, mass->l, a);
        }
    }
}

/* a: n x n, of which Y is made where vectors are wanted at once. */
static mt_status regular(const double *k, const mt_mass_factor *mass, double *a,
                         mt_arena *scratch, mt_modes *out, mt_tridiagonal *later, mt_err *err)
{
    const int n = mass->n;
    double *q = a;
    if (mass->t != NULL) {
        q = mt_arena_f64(scratch, (size_t)n, (size_t)n);
        MT_TRY(mt_arena_check(scratch, err));
    }
    standard(k, mass, a, q);
    if (later != NULL) {
        return mt_eig_sym_values(n, q, out->lambda, scratch, later, err);
    }
    MT_TRY(mt_eig_sym(n, q, out->lambda, out->y != NULL, scratch, err));
    if (out->y != NULL) {
        mt_modal_back(mass, n, q, a);
    }
    return MT_OK;
}

mt_status mt_modal_plain_lowest(const double *k, const mt_mass_factor *mass,
                                const mt_tridiagonal *later, mt_arena *scratch, mt_modes *out,
                                mt_err *err)
{
    const size_t n = (size_t)mass->n;
    double *q = out->y;
    if (mass->t != NULL) {
        q = mt_arena_f64(scratch, n, n);
        MT_TRY(mt_arena_check(scratch, err));
    }
    mt_err why = {.text = ""};
    const bool few = out->shaped <= mass->rank / MT_MODAL_PART;
    const mt_status rc =
        few ? mt_eig_sym_lowest(later, out->shaped, out->lambda, q, scratch, &why)
            : MT_E_NO_CONVERGENCE;
    if (rc != MT_OK && rc != MT_E_NO_CONVERGENCE) {
        return mt_fail(err, rc, "%s", why.text);
    }
    if (rc == MT_E_NO_CONVERGENCE) { /* more than a few, or inverse iteration failed */
        double *const w = mt_arena_f64(scratch, n, 1);
        MT_TRY(mt_arena_check(scratch, err));
        standard(k, mass, out->y, q);
        MT_TRY(mt_eig_sym(mass->n, q, w, true, scratch, err));
    }
    mt_modal_back(mass, out->shaped, q, out->y);
    return MT_OK;
}

static mt_status condensed(const double *k, const mt_mass_factor *mass, mt_arena *scratch,
                           mt_modes *out, mt_err *err)
{
    const int n = mass->n;
    const int r = mass->rank;
    const bool vectors = out->y != NULL;
    double *const a = mt_arena_f64(scratch, (size_t)r, (size_t)r);
    double *const t1 = mt_arena_f64(scratch, (size_t)n, (size_t)r);
    MT_TRY(mt_arena_check(scratch, err));
    MT_TRY(mt_modal_condense(k, mass, scratch, a, t1, out, err));
    MT_TRY(mt_eig_sym(r, a, out->lambda, vectors, scratch, err));
    if (vectors) {
        mt_gemm(false, false, n, r, r, 1.0, t1, n, a, r, 0.0, out->y, n);
    }
    return MT_OK;
}

mt_status mt_modal_plain(const double *k, const mt_mass_factor *mass, mt_arena *scratch,
                         mt_modes *out, mt_tridiagonal *later, mt_err *err)
{
    const int n = mass->n;
    mt_tridiagonal *const apart = later != NULL && mass->rank == n ? later : NULL;
    if (!mt_lower_finite(n, k)) {
        return mt_fail(err, MT_E_DOMAIN, "stiffness matrix: an entry is not a finite number");
    }
    if (mass->rank < n) {
        MT_TRY(condensed(k, mass, scratch, out, err));
    } else {
        double *const a = out->y != NULL && apart == NULL
                              ? out->y
                              : mt_arena_f64(scratch, (size_t)n, (size_t)n);
        MT_TRY(mt_arena_check(scratch, err));
        MT_TRY(regular(k, mass, a, scratch, out, apart, err));
    }
    out->scale = stiffness_scale(k, mass, out);
    out->error_bound = mt_modal_tolerance(n) * out->scale;
    out->error_relative = mt_modal_relative(n) * fmin(mass->kept, 1.0 / DBL_EPSILON);
    return MT_OK;
}
