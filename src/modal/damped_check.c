/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Residuals of damped modes, as check.c judges undamped ones: in coordinates in which m_ii = 1,
 * in units of n eps. First each s is refined by the Rayleigh functional: the matrices are
 * symmetric, so y is its left eigenvector, too, and the root of
 *     (y^T M y) s^2 + (y^T C y) s + y^T (K + i H) y = 0
 * next to s has an error of second order in that of y. That matters for the slow root of a
 * heavily overdamped motion, which the eigensolver knows to n eps of the fast one. What has the
 * smaller residual stands.
 */
#include "modal/damped_priv.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "linalg/dense.h"

/* Frobenius norm of D A D, A lower; NULL: identity. */
static double scaled_norm(int n, const double *a, const double *d)
{
    double sum = 0.0;
    for (ptrdiff_t j = 0; j < n; j++) {
        for (ptrdiff_t i = j; i < n; i++) {
            const double e = d[i] * d[j] * (a == NULL ? (i == j ? 1.0 : 0.0) : a[i + (j * n)]);
            sum += (i == j ? 1.0 : 2.0) * e * e;
        }
    }
    return sqrt(sum);
}

/* f += alpha A x, A lower; NULL: identity. */
static void add_lower_product(int n, double alpha, const double *a, const double *x,
                              double *work, double *f)
{
    if (a == NULL) {
        mt_axpy(n, alpha, x, f);
        return;
    }
    mt_symm(n, 1, a, x, work);
    mt_axpy(n, alpha, work, f);
}

typedef struct checker {
    const mt_damped_problem *p;
    const double *matrix[4]; /* K, C, M, H */
    double norm[4];
    int n_matrices; /* 3 without H */
    double *d;
    double *f[2]; /* real and imaginary part of the residual */
    double *work;
} checker;

static double residual_of_damped(const checker *c, const mt_damped_modes *out, int i, double re,
                                 double im)
{
    const int n = c->p->n;
    const double factor[4][2] = {
        {1.0, 0.0}, {re, im}, {(re * re) - (im * im), 2.0 * re * im}, {0.0, 1.0}};
    const double *const y[2] = {out->y_re + ((ptrdiff_t)i * n), out->y_im + ((ptrdiff_t)i * n)};
    const double size = hypot(re, im);
    double force = 0.0;
    double motion = 0.0;
    for (int j = 0; j < n; j++) {
        c->f[0][j] = 0.0;
        c->f[1][j] = 0.0;
    }
    for (int k = 0; k < c->n_matrices; k++) {
        add_lower_product(n, factor[k][0], c->matrix[k], y[0], c->work, c->f[0]);
        add_lower_product(n, -factor[k][1], c->matrix[k], y[1], c->work, c->f[0]);
        add_lower_product(n, factor[k][0], c->matrix[k], y[1], c->work, c->f[1]);
        add_lower_product(n, factor[k][1], c->matrix[k], y[0], c->work, c->f[1]);
    }
    for (int j = 0; j < n; j++) {
        force = hypot(force, c->d[j] * hypot(c->f[0][j], c->f[1][j]));
        motion = hypot(motion, hypot(y[0][j], y[1][j]) / c->d[j]);
    }
    const double terms =
        c->norm[0] + (size * c->norm[1]) + (size * size * c->norm[2]) + c->norm[3];
    const double unit = terms * motion * n * DBL_EPSILON;
    return !(force > 0.0) ? 0.0 : unit > 0.0 ? force / unit : HUGE_VAL;
}

/* y^T A y, not conjugated. */
static double complex form(const checker *c, const double *a, const double *re,
                           const double *im)
{
    const int n = c->p->n;
    double *const f = c->f[0];
    double part[3];
    for (int k = 0; k < 3; k++) { /* re re, re im, im im */
        memset(f, 0, (size_t)n * sizeof *f);
        add_lower_product(n, 1.0, a, k == 0 ? re : im, c->work, f);
        part[k] = mt_dot(n, k == 2 ? im : re, f);
    }
    return mt_complex(part[0] - part[2], 2.0 * part[1]);
}

/* The root of a s^2 + b s + k next to s, both roots without cancellation. */
static double complex nearest_root(double complex a, double complex b, double complex k,
                                   double complex s)
{
    const double complex root = csqrt((b * b) - (4.0 * a * k));
    const double complex plus = -0.5 * (b + root);
    const double complex minus = -0.5 * (b - root);
    const double complex q = cabs(plus) >= cabs(minus) ? plus : minus;
    if (cabs(q) == 0.0 || cabs(a) == 0.0) { /* both roots are 0, or one is: no better than s */
        return cabs(q) == 0.0 ? s : k / q;
    }
    const double complex s1 = q / a;
    const double complex s2 = k / q;
    return cabs(s1 - s) <= cabs(s2 - s) ? s1 : s2;
}

static void refine_eigenvalue(const checker *c, mt_damped_modes *out, int i)
{
    const ptrdiff_t at = (ptrdiff_t)i * c->p->n;
    double complex part[4] = {0.0};
    out->residual[i] = residual_of_damped(c, out, i, out->re[i], out->im[i]);
    for (int k = 0; k < c->n_matrices; k++) {
        part[k] = form(c, c->matrix[k], out->y_re + at, out->y_im + at);
    }
    const double complex s =
        nearest_root(part[2], part[1], part[0] + (mt_complex(0.0, 1.0) * part[3]),
                     mt_complex(out->re[i], out->im[i]));
    const double im = out->im[i] > 0.0 ? cimag(s) : 0.0; /* a real root stays real */
    const double better = residual_of_damped(c, out, i, creal(s), im);
    if (better < out->residual[i] && !(im < 0.0)) {
        out->re[i] = creal(s);
        out->im[i] = im;
        out->residual[i] = better;
    }
}

mt_status mt_damped_check(const mt_damped_problem *p, mt_damped_modes *out, mt_arena *mem,
                          mt_err *err)
{
    const size_t n = (size_t)p->n;
    checker c = {
        .p = p, .matrix = {p->k, p->c, p->mass->m, p->h}, .n_matrices = p->h == NULL ? 3 : 4};
    c.d = mt_arena_f64(mem, n, 1);
    c.f[0] = mt_arena_f64(mem, n, 1);
    c.f[1] = mt_arena_f64(mem, n, 1);
    c.work = mt_arena_f64(mem, n, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (size_t i = 0; i < n;
         i++) { /* as check.c: without mass, what the stiffness scale would give it */
        const double kii = fabs(p->k[i + (i * n)]);
        const double scale = p->modes->scale;
        const double other = kii > 0.0 && scale > 0.0 ? fmax(sqrt(scale / kii), DBL_MIN) : 1.0;
        c.d[i] = p->mass->d[i] > 0.0 ? p->mass->d[i] : other;
    }
    for (int k = 0; k < c.n_matrices; k++) {
        c.norm[k] = scaled_norm(p->n, c.matrix[k], c.d);
    }
    for (int i = 0; i < out->count; i++) {
        if (out->kind[i] != MT_DAMPED_RIGID_BODY) {
            refine_eigenvalue(&c, out, i);
        }
    }
    return MT_OK;
}
