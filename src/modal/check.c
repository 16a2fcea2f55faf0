/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Residual and orthogonality, judged as LAPACK's own tests judge them: in units of n eps, so
 * that O(1) is perfect. Rows of K may have different units, so vectors and forces are measured
 * in coordinates in which m_ii = 1, D = diag(m_ii)^-1/2:
 *     ||D (K y - lambda M y)|| / ((||D K D|| + |lambda| ||D M D||) ||D^-1 y|| n eps).
 * A coordinate without mass takes the mass that would move it at the stiffness scale s, which
 * is |k_ii| / s.
 */
#include "modal/modal_priv.h"

#include <float.h>
#include <math.h>

#include "linalg/dense.h"

/* Frobenius norm of D A D, A lower; A NULL: identity. */
static double scaled_norm(int n, const double *a, const double *d)
{
    double sum = 0.0;
    for (int j = 0; j < n; j++) {
        const double *const aj = a == NULL ? NULL : a + (ptrdiff_t)j * n;
        const double diagonal = (a == NULL ? 1.0 : aj[j]) * d[j];
        double below = 0.0;
        for (int i = j + 1; i < n && a != NULL; i++) {
            const double e = d[i] * aj[i];
            below += e * e;
        }
        sum += d[j] * d[j] * (2.0 * below + diagonal * diagonal);
    }
    return sqrt(sum);
}

typedef struct checker {
    int n;
    double *d;  /* [n] */
    double *ky; /* n x count */
    double *my; /* n x count; Y itself where M is the identity */
    double k_norm;
    double m_norm;
} checker;

static double residual_of_mode(const checker *c, const mt_modes *modes, int i)
{
    const ptrdiff_t at = (ptrdiff_t)i * c->n;
    const double lambda = modes->lambda[i];
    double force = 0.0;
    double size = 0.0;
    for (int j = 0; j < c->n; j++) {
        const double f = c->d[j] * (c->ky[at + j] - lambda * c->my[at + j]);
        const double v = modes->y[at + j] / c->d[j];
        force += f * f;
        size += v * v;
    }
    const double unit =
        (c->k_norm + fabs(lambda) * c->m_norm) * sqrt(size) * c->n * DBL_EPSILON;
    if (!(force > 0.0)) {
        return 0.0 * unit; /* NaN stays NaN */
    }
    return unit > 0.0 ? sqrt(force) / unit : HUGE_VAL;
}

static void orthogonality(const checker *c, double *gram, mt_modes *modes)
{
    const int r = modes->shaped;
    mt_gemm(true, false, r, r, c->n, 1.0, modes->y, c->n, c->my, c->n, 0.0, gram, r);
    for (int i = 0; i < r; i++) {
        gram[i + (ptrdiff_t)i * r] -= 1.0;
        modes->orthogonality[i] =
            mt_max_abs(r, gram + (ptrdiff_t)i * r) / ((double)c->n * DBL_EPSILON);
    }
}

mt_status mt_modal_check(const double *k, const mt_mass_factor *mass, mt_arena *scratch,
                         mt_modes *modes, mt_err *err)
{
    const int n = mass->n;
    const size_t r = (size_t)modes->shaped;
    checker c = {.n = n};
    c.d = mt_arena_f64(scratch, (size_t)n, 1);
    c.ky = mt_arena_f64(scratch, (size_t)n, r);
    c.my = mass->m == NULL ? modes->y : mt_arena_f64(scratch, (size_t)n, r);
    double *const gram = mt_arena_f64(scratch, r, r);
    MT_TRY(mt_arena_check(scratch, err));
    for (int i = 0; i < n; i++) {
        const double kii = fabs(k[i + (ptrdiff_t)i * n]);
        const double virtual_d =
            kii > 0.0 && modes->scale > 0.0 ? fmax(sqrt(modes->scale / kii), DBL_MIN) : 1.0;
        c.d[i] = mass->d[i] > 0.0 ? mass->d[i] : virtual_d;
    }
    c.k_norm = scaled_norm(n, k, c.d);
    c.m_norm = scaled_norm(n, mass->m, c.d);
    mt_symm(n, modes->shaped, k, modes->y, c.ky);
    if (mass->m != NULL) {
        mt_symm(n, modes->shaped, mass->m, modes->y, c.my);
    }
    for (int i = 0; i < modes->shaped; i++) {
        modes->residual[i] = residual_of_mode(&c, modes, i);
    }
    orthogonality(&c, gram, modes);
    return MT_OK;
}
