/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Damped modes, and what grows by itself. */
#include "modal/damped.h"

#include <complex.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "linalg/dense.h"
#include "modal/modes.h"

/* Matrices of the states. r modes with mass, z directions without, of which zd are damped and
 * zu are not. */
typedef struct damped_parts {
    const mt_damped_problem *p;
    mt_arena *mem;
    int n;
    int r;
    int z;
    int zd;
    int zu;
    double *y; /* n x r, rigid-body modes turned so that their damping is diagonal */
    double *t; /* n x z: the directions without mass, its first zu columns the undamped ones */
    double *b; /* n x zd: columns of y for unit b_D, including the static response of U */
    double *omega; /* [r] signed: S Omega */
    double *caa;   /* r x r */
    double *cda;   /* zd x r */
    double *mu;    /* [zd] */
    double *kd;    /* zd x zd */
    int *x_of;     /* [r] state of x; -1: none */
    int *v_of;     /* [r] state of v; -1: none */
    int order;     /* states */
    double tol;    /* 16 n eps */
} damped_parts;

static mt_status damped_sandwich(const damped_parts *s, const double *b, int ra,
                                 const double *a, int rc, const double *c, double *out,
                                 mt_err *err);
static mt_damped_kind damped_kind_of(double re, double im, double noise);
static void damped_scale(int n, double *y_re, double *y_im);
static mt_status damped_claim(mt_damped_modes *out, int n, int count, mt_arena *mem,
                              mt_err *err);

/* What grows. */

/* Of a pole's size, or of the largest eigenvalue times the order: what rounding may leave of a
 * damping that is 0. */
static const double ULPS = 64.0;

/* *negative is set where the symmetric matrix has a negative direction, else left. NULL: 0. */
static mt_status find_negative(int n, const double *a, mt_arena *mem, bool *negative,
                               mt_err *err)
{
    if (a == NULL || n == 0) {
        return MT_OK;
    }
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    double *const copy = mt_arena_f64(mem, (size_t)n, (size_t)n);
    double *const w = mt_arena_f64(mem, (size_t)n, 1);
    mt_status rc = mt_arena_check(mem, err);
    if (rc == MT_OK) {
        memcpy(copy, a, (size_t)n * (size_t)n * sizeof *copy);
        rc = mt_eig_sym(n, copy, w, false, mem, err);
    }
    if (rc == MT_OK) {
        const double most = fmax(fabs(w[0]), fabs(w[n - 1]));
        *negative = *negative || w[0] < -ULPS * DBL_EPSILON * n * most;
    }
    mt_arena_rewind(mem, mark);
    return rc;
}

int mt_modal_growing_pole(int n, const double complex *s, double rounding)
{
    int growing = -1;
    for (int k = 0; k < n; k++) {
        const double least = fmax(ULPS * DBL_EPSILON * cabs(s[k]), rounding);
        const bool right = cimag(s[k]) >= 0.0 && creal(s[k]) > least;
        if (right && (growing < 0 || creal(s[k]) > creal(s[growing]))) {
            growing = k;
        }
    }
    return growing;
}

mt_status mt_modal_is_passive(int n, const double *c, const double *h, mt_arena *mem,
                              bool *passive, mt_err *err)
{
    bool negative = false;
    MT_TRY(find_negative(n, c, mem, &negative, err));
    MT_TRY(find_negative(n, h, mem, &negative, err));
    *passive = !negative;
    return MT_OK;
}

/*
 * Residuals of damped modes, as solve.c judges undamped ones: in coordinates in which m_ii = 1,
 * in units of n eps. First each s is refined by the Rayleigh functional: the matrices are
 * symmetric, so y is its left eigenvector, too, and the root of
 *     (y^T M y) s^2 + (y^T C y) s + y^T (K + i H) y = 0
 * next to s has an error of second order in that of y. That matters for the slow root of a
 * heavily overdamped motion, which the eigensolver knows to n eps of the fast one. What has the
 * smaller residual stands.
 */

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

/* Refine s and fill the residual of damped modes. */
static mt_status damped_check(const mt_damped_problem *p, mt_damped_modes *out, mt_arena *mem,
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
         i++) { /* as in solve.c: without mass, what the stiffness scale would give it */
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

/*
 * Structural damping. In the coordinates of the states below, y = Y a + B b_D + T_U b_U,
 * the directions U without mass and damping follow statically, now with H:
 *     b_U = -i W (a, b_D),    W = (K_UU + i H_UU)^-1 [H_Ua H_UD]        (K_Ua = K_UD = 0)
 * What is left has the complex symmetric stiffness of w = (a, b_D)
 *     G = diag(Lambda, K_D) + i [Y B]^T H [Y B] + [H_Ua H_UD]^T W
 * and with x = scale a (scale = |Lambda|^1/2, or what G gives it where Lambda is 0) obeys
 *     x' = scale v
 *     b' = -mu^-1 (C_Da v + G_Da a + G_DD b)
 *     v' = -Caa v - C_aD b' - G_aa a - G_aD b,
 * a complex standard eigenproblem. A rigid-body mode whose row of G is 0 has no x, as there.
 */

typedef struct structural {
    const damped_parts *s;
    int nw;            /* r + zd */
    double complex *g; /* nw x nw: G */
    double complex *w; /* zu x nw: W */
    double *scale;     /* [r] 0: no state x */
    int *x_of;         /* [r] state of x; -1: none */
    int *v_of;         /* [r] state of v; -1: none */
    int order;         /* states */
} structural;

/* [Y B]: n x nw. */
static mt_status shapes(const damped_parts *s, double **out, mt_err *err)
{
    const size_t n = (size_t)s->n;
    *out = mt_arena_f64(s->mem, n, (size_t)s->r + (size_t)s->zd);
    MT_TRY(mt_arena_check(s->mem, err));
    memcpy(*out, s->y, n * (size_t)s->r * sizeof **out);
    if (s->zd > 0) {
        memcpy(*out + (n * (size_t)s->r), s->b, n * (size_t)s->zd * sizeof **out);
    }
    return MT_OK;
}

/* W by the real system [K -H; H K] [Re W; Im W] = [H_Uw; 0]. */
static mt_status solve_massless_directions(structural *c, const double *huw, mt_err *err)
{
    const damped_parts *const s = c->s;
    const ptrdiff_t u = s->zu;
    double rcond = 1.0;
    double *const kuu = mt_arena_f64(s->mem, (size_t)u, (size_t)u);
    double *const huu = mt_arena_f64(s->mem, (size_t)u, (size_t)u);
    double *const both = mt_arena_f64(s->mem, 2 * (size_t)u, 2 * (size_t)u);
    double *const x = mt_arena_f64(s->mem, 2 * (size_t)u, (size_t)c->nw);
    MT_TRY(mt_arena_check(s->mem, err));
    MT_TRY(damped_sandwich(s, s->p->k, s->zu, s->t, s->zu, s->t, kuu, err));
    MT_TRY(damped_sandwich(s, s->p->h, s->zu, s->t, s->zu, s->t, huu, err));
    for (ptrdiff_t j = 0; j < u; j++) {
        for (ptrdiff_t i = 0; i < u; i++) {
            both[i + (j * 2 * u)] = kuu[i + (j * u)];
            both[u + i + ((u + j) * 2 * u)] = kuu[i + (j * u)];
            both[u + i + (j * 2 * u)] = huu[i + (j * u)];
            both[i + ((u + j) * 2 * u)] = -huu[i + (j * u)];
        }
    }
    for (ptrdiff_t j = 0; j < c->nw; j++) {
        for (ptrdiff_t i = 0; i < u; i++) {
            x[i + (j * 2 * u)] = huw[i + (j * u)];
        }
    }
    MT_TRY(mt_lu_solve(2 * s->zu, both, c->nw, x, &rcond, s->mem, err));
    if (!(rcond > s->tol)) {
        return mt_fail(err, MT_E_SINGULAR,
                       "a direction without mass or damping is held by no stiffness");
    }
    for (ptrdiff_t j = 0; j < c->nw; j++) {
        for (ptrdiff_t i = 0; i < u; i++) {
            c->w[i + (j * u)] = mt_complex(x[i + (j * 2 * u)], x[u + i + (j * 2 * u)]);
        }
    }
    return MT_OK;
}

static mt_status stiffness(structural *c, mt_err *err)
{
    const damped_parts *const s = c->s;
    const ptrdiff_t nw = c->nw;
    const ptrdiff_t u = s->zu;
    double *yb = NULL;
    double *const h = mt_arena_f64(s->mem, (size_t)nw, (size_t)nw);
    double *const huw = mt_arena_f64(s->mem, (size_t)u, (size_t)nw);
    MT_TRY(mt_arena_check(s->mem, err));
    MT_TRY(shapes(s, &yb, err));
    MT_TRY(damped_sandwich(s, s->p->h, c->nw, yb, c->nw, yb, h, err));
    if (u > 0) {
        MT_TRY(damped_sandwich(s, s->p->h, s->zu, s->t, c->nw, yb, huw, err));
        MT_TRY(solve_massless_directions(c, huw, err));
    }
    for (ptrdiff_t j = 0; j < nw; j++) {
        for (ptrdiff_t i = 0; i < nw; i++) {
            double complex g = mt_complex(0.0, h[i + (j * nw)]);
            for (ptrdiff_t k = 0; k < u; k++) {
                g += huw[k + (i * u)] * c->w[k + (j * u)];
            }
            if (i >= s->r && j >= s->r) {
                g += s->kd[i - s->r + ((j - s->r) * s->zd)];
            } else if (i == j) {
                g += copysign(s->omega[i] * s->omega[i], s->omega[i]);
            }
            c->g[i + (j * nw)] = g;
        }
    }
    return MT_OK;
}

/* Count the states x and v that exist. */
static void count_states(structural *c)
{
    const damped_parts *const s = c->s;
    const ptrdiff_t nw = c->nw;
    const double most = mt_max_abs(2 * nw * nw, (const double *)c->g);
    for (int i = 0; i < s->r; i++) {
        double row = 0.0;
        for (ptrdiff_t j = 0; j < nw && s->omega[i] == 0.0; j++) {
            row = fmax(row, cabs(c->g[i + (j * nw)]));
        }
        c->scale[i] = row > s->tol * most ? sqrt(row) : fabs(s->omega[i]);
        c->x_of[i] = c->scale[i] == 0.0 ? -1 : c->order++;
        c->v_of[i] = c->scale[i] == 0.0 && s->v_of[i] < 0 ? -1 : c->order++;
    }
    c->order += s->zd;
}

/* Rates caused by the force f[nw] of a unit state: b' = -mu^-1 f_D, v' = -f_a - C_aD b'. */
static void write_rates_column(const structural *c, const double complex *f,
                               double complex *column)
{
    const damped_parts *const s = c->s;
    const int first = c->order - s->zd;
    for (int d = 0; d < s->zd; d++) {
        column[first + d] = -f[s->r + d] / s->mu[d];
    }
    for (int i = 0; i < s->r; i++) {
        double complex rate = -f[i];
        for (int d = 0; d < s->zd; d++) {
            rate -= s->cda[d + ((ptrdiff_t)i * s->zd)] * column[first + d];
        }
        if (c->v_of[i] >= 0) {
            column[c->v_of[i]] = rate;
        }
    }
}

/* The matrix of the states, order x order; f[nw] is work. */
static void assemble_structural(const structural *c, double complex *f, double complex *a)
{
    const damped_parts *const s = c->s;
    const ptrdiff_t order = c->order;
    const ptrdiff_t nw = c->nw;
    const int first = c->order - s->zd;
    for (ptrdiff_t j = 0; j < s->r; j++) {
        if (c->v_of[j] >= 0) {
            for (int i = 0; i < s->r; i++) {
                f[i] = s->caa[i + (j * s->r)];
            }
            for (int d = 0; d < s->zd; d++) {
                f[s->r + d] = s->cda[d + (j * s->zd)];
            }
            write_rates_column(c, f, a + (c->v_of[j] * order));
        }
        if (c->x_of[j] >= 0) {
            for (ptrdiff_t i = 0; i < nw; i++) {
                f[i] = c->g[i + (j * nw)] / c->scale[j];
            }
            write_rates_column(c, f, a + (c->x_of[j] * order));
            a[c->x_of[j] + (c->v_of[j] * order)] = c->scale[j];
        }
    }
    for (ptrdiff_t d = 0; d < s->zd; d++) {
        write_rates_column(c, c->g + ((s->r + d) * nw), a + ((first + d) * order));
    }
}

/* y += z times column j of the n x ... matrix. */
static void add_scaled_column(int n, double complex z, const double *matrix, int j,
                              double *y_re, double *y_im)
{
    mt_axpy(n, creal(z), matrix + ((ptrdiff_t)j * n), y_re);
    mt_axpy(n, cimag(z), matrix + ((ptrdiff_t)j * n), y_im);
}

/* One eigenvector in the caller's coordinates, root y (velocities): Y v + root (B b + T_U b_U),
 * root b_U = -i W (v, root b). */
static void write_structural_vector(const structural *c, const double complex *state,
                                    double complex root, double *y_re, double *y_im)
{
    const damped_parts *const s = c->s;
    const int first = c->order - s->zd;
    for (int j = 0; j < s->r; j++) {
        if (c->v_of[j] >= 0) {
            add_scaled_column(s->n, state[c->v_of[j]], s->y, j, y_re, y_im);
        }
    }
    for (int d = 0; d < s->zd; d++) {
        add_scaled_column(s->n, root * state[first + d], s->b, d, y_re, y_im);
    }
    for (int k = 0; k < s->zu; k++) {
        double complex own = 0.0;
        for (int j = 0; j < s->r; j++) {
            own += c->v_of[j] < 0 ? 0.0 : c->w[k + ((ptrdiff_t)j * s->zu)] * state[c->v_of[j]];
        }
        for (int d = 0; d < s->zd; d++) {
            own += c->w[k + ((ptrdiff_t)(s->r + d) * s->zu)] * root * state[first + d];
        }
        add_scaled_column(s->n, mt_complex(0.0, -1.0) * own, s->t, k, y_re, y_im);
    }
    damped_scale(s->n, y_re, y_im);
}

/* Those with Im s > 0, and real ones, ascending by |s|. perm: positions in w. */
static int order_structural_roots(const double complex *w, int order, double noise, int *perm)
{
    int count = 0;
    for (int i = 0; i < order; i++) {
        if (cimag(w[i]) < -noise) {
            continue;
        }
        int at = count++;
        for (; at > 0 && cabs(w[perm[at - 1]]) > cabs(w[i]); at--) {
            perm[at] = perm[at - 1];
        }
        perm[at] = i;
    }
    return count;
}

static mt_status solve_structural_modes(const structural *c, mt_damped_modes *out, mt_err *err)
{
    const damped_parts *const s = c->s;
    const size_t order = (size_t)c->order;
    const size_t size = sizeof(double complex);
    int rigid = 0;
    double complex *const a = mt_arena_alloc(s->mem, order * order, size);
    double complex *const vr = mt_arena_alloc(s->mem, order * order, size);
    double complex *const w = mt_arena_alloc(s->mem, order, size);
    double complex *const f = mt_arena_alloc(s->mem, (size_t)c->nw, size);
    int *const perm = mt_arena_int(s->mem, order);
    MT_TRY(mt_arena_check(s->mem, err));
    assemble_structural(c, f, a);
    const double noise = s->tol * mt_max_abs(2 * (ptrdiff_t)(order * order), (double *)a);
    MT_TRY(mt_eig_complex(c->order, a, w, vr, s->mem, err));
    for (int j = 0; j < s->r; j++) {
        rigid += c->x_of[j] < 0 ? 1 : 0;
    }
    const int roots = order_structural_roots(w, c->order, noise, perm);
    MT_TRY(damped_claim(out, s->n, rigid + roots, s->mem, err));
    for (int i = 0; i < rigid; i++) {
        out->kind[i] = MT_DAMPED_RIGID_BODY;
    }
    for (int i = 0; i < roots; i++) {
        const double complex root = w[perm[i]];
        const ptrdiff_t to = rigid + i;
        out->re[to] = creal(root);
        out->im[to] = cimag(root) > noise ? cimag(root) : 0.0;
        out->kind[to] = damped_kind_of(out->re[to], out->im[to], noise);
        write_structural_vector(c, vr + ((size_t)perm[i] * order), root,
                                out->y_re + (to * s->n), out->y_im + (to * s->n));
    }
    return MT_OK;
}

/* Roots and shapes with structural damping. */
static mt_status damped_structural(const damped_parts *s, mt_damped_modes *out, mt_err *err)
{
    structural c = {.s = s, .nw = s->r + s->zd};
    const size_t nw = (size_t)c.nw;
    c.g = mt_arena_alloc(s->mem, nw * nw, sizeof *c.g);
    c.w = mt_arena_alloc(s->mem, (size_t)s->zu * nw, sizeof *c.w);
    c.scale = mt_arena_f64(s->mem, (size_t)s->r, 1);
    c.x_of = mt_arena_int(s->mem, (size_t)s->r);
    c.v_of = mt_arena_int(s->mem, (size_t)s->r);
    MT_TRY(mt_arena_check(s->mem, err));
    MT_TRY(stiffness(&c, err));
    count_states(&c);
    return solve_structural_modes(&c, out, err);
}

/*
 * State form in the undamped modes. With all undamped shapes Y (Y^T M Y = I, Y^T K Y = Lambda)
 * and a basis T0 of the directions without mass (M T0 = 0), y = Y a + T0 b splits the
 * stiffness, since Y follows statically there (Y^T K T0 = 0):
 *     a'' + Caa a' + Cab b' + Lambda a = 0,        Cba a' + Cbb b' + Kbb b = 0.
 * Directions of b without damping follow statically (b_U = -K_UU^-1 K_UD b_D); the others have
 * Cbb = diag(mu):
 *     b_D' = -mu^-1 (C_Da a' + K_D b_D),           K_D = K_DD - K_DU K_UU^-1 K_UD.
 * With Omega = |Lambda|^1/2, S = sign Lambda and x = Omega a the states (x, v = a', b_D) obey
 *     x' =  Omega v
 *     v' = -S Omega x - (Caa - C_aD mu^-1 C_Da) v + C_aD mu^-1 K_D b_D
 *     b' = -mu^-1 C_Da v - mu^-1 K_D b_D.
 * Without damping that is skew-symmetric: eigenvalues to n eps of the largest, no defective
 * pair at zero. A rigid-body mode has no x (Omega = 0: its zero eigenvalue is split off
 * exactly), and no v either where nothing damps it. Nothing here is infinite, so that a
 * standard eigenproblem (dgeev, which balances) does.
 */

static const double TWO_PI = 6.283185307179586477;

/* out := A^T B C, A n x ra, C n x rc, B symmetric n x n. */
static mt_status damped_sandwich(const damped_parts *s, const double *b, int ra,
                                 const double *a, int rc, const double *c, double *out,
                                 mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(s->mem);
    double *const bc = mt_arena_f64(s->mem, (size_t)s->n, (size_t)rc);
    MT_TRY(mt_arena_check(s->mem, err));
    mt_symm(s->n, rc, b, c, bc);
    mt_gemm(true, false, ra, rc, s->n, 1.0, a, s->n, bc, s->n, 0.0, out, ra);
    mt_arena_rewind(s->mem, mark);
    return MT_OK;
}

/* Rigid-body modes (repeated, so any basis of them does) turned so that their own damping is
 * diagonal. */
static mt_status turn_rigid(damped_parts *s, mt_err *err)
{
    const mt_modes *const m = s->p->modes;
    int count = 0;
    double *const old = mt_arena_f64(s->mem, (size_t)s->n, (size_t)m->n_rigid);
    double *const c = mt_arena_f64(s->mem, (size_t)m->n_rigid, (size_t)m->n_rigid);
    double *const mu = mt_arena_f64(s->mem, (size_t)m->n_rigid, 1);
    double *const turned = mt_arena_f64(s->mem, (size_t)s->n, (size_t)m->n_rigid);
    MT_TRY(mt_arena_check(s->mem, err));
    for (int i = 0; i < s->r; i++) {
        if (m->kind[i] == MT_MODE_RIGID_BODY) {
            memcpy(old + ((ptrdiff_t)count++ * s->n), s->y + ((ptrdiff_t)i * s->n),
                   (size_t)s->n * sizeof *old);
        }
    }
    MT_TRY(damped_sandwich(s, s->p->c, count, old, count, old, c, err));
    MT_TRY(mt_eig_sym(count, c, mu, true, s->mem, err));
    mt_gemm(false, false, s->n, count, count, 1.0, old, s->n, c, count, 0.0, turned, s->n);
    count = 0;
    for (int i = 0; i < s->r; i++) {
        if (m->kind[i] == MT_MODE_RIGID_BODY) {
            memcpy(s->y + ((ptrdiff_t)i * s->n), turned + ((ptrdiff_t)count++ * s->n),
                   (size_t)s->n * sizeof *turned);
        }
    }
    return MT_OK;
}

/* Columns of T0 in the order undamped, damped directions: those are eigenvectors of Cbb, T0
 * scaled to |Kbb| = 1 on the diagonal. *u: how many are undamped. */
static mt_status split_massless(damped_parts *s, double *t, double *mu, int *u, mt_err *err)
{
    const int n = s->n;
    const int z = s->z;
    double *const scaled = mt_arena_f64(s->mem, (size_t)n, (size_t)z);
    double *const c = mt_arena_f64(s->mem, (size_t)z, (size_t)z);
    MT_TRY(mt_arena_check(s->mem, err));
    for (int j = 0; j < z; j++) {
        double kjj = 0.0;
        const double *const tj = s->p->mass->t + ((ptrdiff_t)(s->r + j) * n);
        MT_TRY(damped_sandwich(s, s->p->k, 1, tj, 1, tj, &kjj, err));
        mt_axpy(n, kjj != 0.0 ? 1.0 / sqrt(fabs(kjj)) : 1.0, tj, scaled + ((ptrdiff_t)j * n));
    }
    MT_TRY(damped_sandwich(s, s->p->c, z, scaled, z, scaled, c, err));
    MT_TRY(mt_eig_sym(z, c, mu, true, s->mem, err));
    mt_gemm(false, false, n, z, z, 1.0, scaled, n, c, z, 0.0, t, n);
    for (*u = 0; *u < z && !(mu[*u] > s->tol * mu[z - 1]); (*u)++) {
    }
    return MT_OK;
}

/* b, mu, kd: the damped directions without mass, with the undamped ones condensed. */
static mt_status massless(damped_parts *s, mt_err *err)
{
    const int n = s->n;
    int u = 0;
    double rcond = 1.0;
    double *const t = mt_arena_f64(s->mem, (size_t)n, (size_t)s->z);
    double *const mu = mt_arena_f64(s->mem, (size_t)s->z, 1);
    MT_TRY(mt_arena_check(s->mem, err));
    MT_TRY(split_massless(s, t, mu, &u, err));
    const int zd = s->z - u;
    s->zd = zd;
    s->zu = u;
    s->t = t;
    s->mu = mu + u;
    s->b = t + ((ptrdiff_t)u * n);
    s->kd = mt_arena_f64(s->mem, (size_t)zd, (size_t)zd);
    double *const kuu = mt_arena_f64(s->mem, (size_t)u, (size_t)u);
    double *const kud = mt_arena_f64(s->mem, (size_t)u, (size_t)zd);
    MT_TRY(mt_arena_check(s->mem, err));
    if (zd > 0 && u > 0) {
        MT_TRY(damped_sandwich(s, s->p->k, u, t, u, t, kuu, err));
        MT_TRY(damped_sandwich(s, s->p->k, u, t, zd, s->b, kud, err));
        MT_TRY(mt_lu_solve(u, kuu, zd, kud, &rcond, s->mem, err));
        if (!(rcond > s->tol)) {
            return mt_fail(err, MT_E_SINGULAR,
                           "a direction without mass or damping is held by no stiffness");
        }
        mt_gemm(false, false, n, zd, u, -1.0, t, n, kud, u, 1.0, s->b, n);
    }
    return damped_sandwich(s, s->p->k, zd, s->b, zd, s->b, s->kd, err);
}

static mt_status prepare_states(damped_parts *s, mt_err *err)
{
    const mt_modes *const m = s->p->modes;
    const size_t n = (size_t)s->n;
    const size_t r = (size_t)s->r;
    s->y = mt_arena_f64(s->mem, n, r);
    s->omega = mt_arena_f64(s->mem, r, 1);
    s->caa = mt_arena_f64(s->mem, r, r);
    s->x_of = mt_arena_int(s->mem, r);
    s->v_of = mt_arena_int(s->mem, r);
    MT_TRY(mt_arena_check(s->mem, err));
    memcpy(s->y, m->y, n * r * sizeof *s->y);
    MT_TRY(turn_rigid(s, err));
    MT_TRY(massless(s, err));
    s->cda = mt_arena_f64(s->mem, (size_t)s->zd, r);
    MT_TRY(mt_arena_check(s->mem, err));
    MT_TRY(damped_sandwich(s, s->p->c, s->r, s->y, s->r, s->y, s->caa, err));
    MT_TRY(damped_sandwich(s, s->p->c, s->zd, s->b, s->r, s->y, s->cda, err));
    const double most = mt_max_abs((ptrdiff_t)s->r * s->r, s->caa);
    for (int i = 0; i < s->r; i++) {
        const bool rigid = m->kind[i] == MT_MODE_RIGID_BODY;
        const double own = mt_max_abs(s->r, s->caa + ((ptrdiff_t)i * s->r));
        s->omega[i] = rigid ? 0.0 : copysign(sqrt(fabs(m->lambda[i])), m->lambda[i]);
        s->x_of[i] = s->omega[i] == 0.0 ? -1 : s->order++;
        s->v_of[i] = rigid && own <= s->tol * most ? -1 : s->order++;
    }
    s->order += s->zd;
    return MT_OK;
}

/* The matrix of the states, order x order. */
static void assemble_states(const damped_parts *s, double *a)
{
    const ptrdiff_t order = s->order;
    const int first = s->order - s->zd;
    for (int j = 0; j < s->r; j++) {
        const int v = s->v_of[j];
        if (v < 0) {
            continue;
        }
        if (s->x_of[j] >= 0) {
            a[s->x_of[j] + (v * order)] = fabs(s->omega[j]);
            a[v + (s->x_of[j] * order)] = -s->omega[j];
        }
        for (int i = 0; i < s->r; i++) {
            double c = s->caa[i + ((ptrdiff_t)j * s->r)];
            for (int d = 0; d < s->zd; d++) {
                c -= s->cda[d + ((ptrdiff_t)i * s->zd)] * s->cda[d + ((ptrdiff_t)j * s->zd)] /
                     s->mu[d];
            }
            if (s->v_of[i] >= 0) {
                a[s->v_of[i] + (v * order)] = -c;
            }
        }
        for (int d = 0; d < s->zd; d++) {
            a[first + d + (v * order)] = -s->cda[d + ((ptrdiff_t)j * s->zd)] / s->mu[d];
        }
    }
    for (int e = 0; e < s->zd; e++) {
        for (int d = 0; d < s->zd; d++) {
            const double k = s->kd[d + ((ptrdiff_t)e * s->zd)] / s->mu[d];
            a[first + d + ((first + e) * order)] = -k;
            for (int i = 0; i < s->r; i++) {
                if (s->v_of[i] >= 0) {
                    a[s->v_of[i] + ((first + e) * order)] +=
                        s->cda[d + ((ptrdiff_t)i * s->zd)] * k;
                }
            }
        }
    }
}

/* Divide a shape by its largest entry. */
static void damped_scale(int n, double *y_re, double *y_im)
{
    int at = 0;
    for (int i = 0; i < n; i++) {
        at = hypot(y_re[i], y_im[i]) > hypot(y_re[at], y_im[at]) ? i : at;
    }
    const double p = y_re[at];
    const double q = y_im[at];
    const double size = (p * p) + (q * q);
    for (int i = 0; i < n && size > 0.0; i++) {
        const double x = y_re[i];
        y_re[i] = ((x * p) + (y_im[i] * q)) / size;
        y_im[i] = ((y_im[i] * p) - (x * q)) / size;
    }
}

/* One eigenvector in the caller's coordinates, s y (velocities): Y v + B s b_D; part 0 real, 1
 * imaginary, of states u + i w. */
static void write_eigenvector(const damped_parts *s, const double *u, const double *w,
                              double re, double im, double *y_re, double *y_im)
{
    const int first = s->order - s->zd;
    for (int j = 0; j < s->r; j++) {
        if (s->v_of[j] >= 0) {
            mt_axpy(s->n, u[s->v_of[j]], s->y + ((ptrdiff_t)j * s->n), y_re);
            mt_axpy(s->n, w == NULL ? 0.0 : w[s->v_of[j]], s->y + ((ptrdiff_t)j * s->n), y_im);
        }
    }
    for (int d = 0; d < s->zd; d++) {
        const double b_re = u[first + d];
        const double b_im = w == NULL ? 0.0 : w[first + d];
        mt_axpy(s->n, (re * b_re) - (im * b_im), s->b + ((ptrdiff_t)d * s->n), y_re);
        mt_axpy(s->n, (re * b_im) + (im * b_re), s->b + ((ptrdiff_t)d * s->n), y_im);
    }
    damped_scale(s->n, y_re, y_im);
}

/* Kind of a root s = re + i im, im >= 0, with rounding error `noise`. */
static mt_damped_kind damped_kind_of(double re, double im, double noise)
{
    const double complex s = re + (im * (double complex)I);
    if (mt_modal_growing_pole(1, &s, noise) == 0) {
        return MT_DAMPED_UNSTABLE;
    }
    return im > 0.0 ? MT_DAMPED_OSCILLATING : MT_DAMPED_OVERDAMPED;
}

/* Eigenvalues by |s|, rigid-body modes before them. perm: positions in wr, those with wi < 0
 * left out. */
static int order_roots(const double *wr, const double *wi, int order, int *perm)
{
    int count = 0;
    for (int i = 0; i < order; i++) {
        if (wi[i] < 0.0) {
            continue;
        }
        int at = count++;
        for (; at > 0 && hypot(wr[perm[at - 1]], wi[perm[at - 1]]) > hypot(wr[i], wi[i]);
             at--) {
            perm[at] = perm[at - 1];
        }
        perm[at] = i;
    }
    return count;
}

/* Allocate the results. */
static mt_status damped_claim(mt_damped_modes *out, int n, int count, mt_arena *mem,
                              mt_err *err)
{
    const size_t m = (size_t)count;
    *out = (mt_damped_modes){.n = n, .count = count};
    out->kind = mt_arena_alloc(mem, m, sizeof *out->kind);
    out->re = mt_arena_f64(mem, m, 1);
    out->im = mt_arena_f64(mem, m, 1);
    out->residual = mt_arena_f64(mem, m, 1);
    out->y_re = mt_arena_f64(mem, (size_t)n, m);
    out->y_im = mt_arena_f64(mem, (size_t)n, m);
    return mt_arena_check(mem, err);
}

static mt_status solve_damped_modes(const damped_parts *s, mt_damped_modes *out, mt_err *err)
{
    const size_t order = (size_t)s->order;
    const int rigid = s->p->modes->n_rigid;
    double *const a = mt_arena_f64(s->mem, order, order);
    double *const vr = mt_arena_f64(s->mem, order, order);
    double *const wr = mt_arena_f64(s->mem, order, 1);
    double *const wi = mt_arena_f64(s->mem, order, 1);
    int *const perm = mt_arena_int(s->mem, order);
    MT_TRY(mt_arena_check(s->mem, err));
    assemble_states(s, a);
    const double noise = s->tol * mt_max_abs((ptrdiff_t)(order * order), a);
    MT_TRY(mt_eig_general(s->order, a, wr, wi, vr, s->mem, err));
    const int roots = order_roots(wr, wi, s->order, perm);
    MT_TRY(damped_claim(out, s->n, rigid + roots, s->mem, err));
    for (int i = 0; i < rigid; i++) {
        out->kind[i] = MT_DAMPED_RIGID_BODY;
    }
    for (int i = 0; i < roots; i++) {
        const int at = perm[i];
        const int to = rigid + i;
        const double *const u = vr + ((ptrdiff_t)at * s->order);
        out->re[to] = wr[at];
        out->im[to] = wi[at];
        out->kind[to] = damped_kind_of(wr[at], wi[at], noise);
        write_eigenvector(s, u, wi[at] > 0.0 ? u + s->order : NULL, wr[at], wi[at],
                          out->y_re + ((ptrdiff_t)to * s->n),
                          out->y_im + ((ptrdiff_t)to * s->n));
    }
    return MT_OK;
}

/* |s|^2 up to which a root belongs to an undecided mode: the greatest possible eigenvalue, and
 * a few times more for the effect of dampers. */
static double undecided_square(const mt_modes *modes)
{
    static const double times = 4.0;
    double most = -1.0;
    for (int i = 0; i < modes->count; i++) {
        if (modes->kind[i] == MT_MODE_UNDECIDED) {
            most = fmax(most, times * (fabs(modes->lambda[i]) + modes->error[i]));
        }
    }
    return most;
}

/* Final kinds, after the refinement of the roots. At a stable position, growing roots of a
 * passive system are rounding. */
static mt_status settle_kinds(const mt_damped_problem *p, mt_damped_modes *out, mt_arena *mem,
                              mt_err *err)
{
    const double undecided = undecided_square(p->modes);
    bool passive = false;
    bool grows = false;
    for (int i = 0; i < out->count; i++) {
        grows = grows || out->kind[i] == MT_DAMPED_UNSTABLE;
    }
    if (grows && p->modes->n_unstable == 0) {
        MT_TRY(mt_modal_is_passive(p->n, p->c, p->h, mem, &passive, err));
    }
    for (int i = p->modes->n_rigid; i < out->count; i++) {
        const double re = out->re[i];
        const double im = out->im[i];
        if ((re * re) + (im * im) <= undecided) {
            out->kind[i] = MT_DAMPED_UNDECIDED;
        } else if (out->kind[i] != MT_DAMPED_UNSTABLE || passive) {
            out->kind[i] = im > 0.0 ? MT_DAMPED_OSCILLATING : MT_DAMPED_OVERDAMPED;
        }
    }
    return MT_OK;
}

mt_status mt_modal_damped(const mt_damped_problem *p, mt_arena *mem, mt_damped_modes *out,
                          mt_err *err)
{
    damped_parts s = {.p = p,
                      .mem = mem,
                      .n = p->n,
                      .r = p->modes->count,
                      .z = p->n - p->mass->rank,
                      .tol = mt_modal_tolerance(p->n)};
    *out = (mt_damped_modes){.n = p->n};
    if (p->modes->shaped < p->modes->all) {
        return mt_fail(err, MT_E_USAGE, "damped modes need the undamped shapes");
    }
    MT_TRY(prepare_states(&s, err));
    MT_TRY(p->h == NULL ? solve_damped_modes(&s, out, err) : damped_structural(&s, out, err));
    MT_TRY(damped_check(p, out, mem, err));
    return settle_kinds(p, out, mem, err);
}

bool mt_damped_indexed(const mt_damped_modes *d)
{
    for (int i = 0; i < d->count; i++) {
        if (d->kind[i] == MT_DAMPED_UNDECIDED) {
            return false;
        }
    }
    return true;
}

double mt_damped_natural_hz(const mt_damped_modes *d, int i)
{
    return hypot(d->re[i], d->im[i]) / TWO_PI;
}

double mt_damped_hz(const mt_damped_modes *d, int i)
{
    return d->im[i] / TWO_PI;
}

double mt_damped_ratio(const mt_damped_modes *d, int i)
{
    const double size = hypot(d->re[i], d->im[i]);
    return size > 0.0 ? -d->re[i] / size : nan("");
}
