/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Structural damping. In the coordinates of damped.c, y = Y a + B b_D + T_U b_U, the directions
 * U without mass and damping follow statically, now with H:
 *     b_U = -i W (a, b_D),    W = (K_UU + i H_UU)^-1 [H_Ua H_UD]        (K_Ua = K_UD = 0)
 * What is left has the complex symmetric stiffness of w = (a, b_D)
 *     G = diag(Lambda, K_D) + i [Y B]^T H [Y B] + [H_Ua H_UD]^T W
 * and with x = scale a (scale = |Lambda|^1/2, or what G gives it where Lambda is 0) obeys
 *     x' = scale v
 *     b' = -mu^-1 (C_Da v + G_Da a + G_DD b)
 *     v' = -Caa v - C_aD b' - G_aa a - G_aD b,
 * a complex standard eigenproblem. A rigid-body mode whose row of G is 0 has no x, as there.
 */
#include "modal/damped_priv.h"

#include <math.h>
#include <string.h>

typedef struct structural {
    const mt_damped_parts *s;
    int nw;            /* r + zd */
    double complex *g; /* nw x nw: G */
    double complex *w; /* zu x nw: W */
    double *scale;     /* [r] 0: no state x */
    int *x_of;         /* [r] state of x; -1: none */
    int *v_of;         /* [r] state of v; -1: none */
    int order;         /* states */
} structural;

/* [Y B]: n x nw. */
static mt_status shapes(const mt_damped_parts *s, double **out, mt_err *err)
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
    const mt_damped_parts *const s = c->s;
    const ptrdiff_t u = s->zu;
    double rcond = 1.0;
    double *const kuu = mt_arena_f64(s->mem, (size_t)u, (size_t)u);
    double *const huu = mt_arena_f64(s->mem, (size_t)u, (size_t)u);
    double *const both = mt_arena_f64(s->mem, 2 * (size_t)u, 2 * (size_t)u);
    double *const x = mt_arena_f64(s->mem, 2 * (size_t)u, (size_t)c->nw);
    MT_TRY(mt_arena_check(s->mem, err));
    MT_TRY(mt_damped_sandwich(s, s->p->k, s->zu, s->t, s->zu, s->t, kuu, err));
    MT_TRY(mt_damped_sandwich(s, s->p->h, s->zu, s->t, s->zu, s->t, huu, err));
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
    const mt_damped_parts *const s = c->s;
    const ptrdiff_t nw = c->nw;
    const ptrdiff_t u = s->zu;
    double *yb = NULL;
    double *const h = mt_arena_f64(s->mem, (size_t)nw, (size_t)nw);
    double *const huw = mt_arena_f64(s->mem, (size_t)u, (size_t)nw);
    MT_TRY(mt_arena_check(s->mem, err));
    MT_TRY(shapes(s, &yb, err));
    MT_TRY(mt_damped_sandwich(s, s->p->h, c->nw, yb, c->nw, yb, h, err));
    if (u > 0) {
        MT_TRY(mt_damped_sandwich(s, s->p->h, s->zu, s->t, c->nw, yb, huw, err));
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
    const mt_damped_parts *const s = c->s;
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
    const mt_damped_parts *const s = c->s;
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
    const mt_damped_parts *const s = c->s;
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
    const mt_damped_parts *const s = c->s;
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
    mt_damped_scale(s->n, y_re, y_im);
}

/* Those with Im s > 0, and real ones, ascending by |s|. perm: positions in w. */
static int order_roots(const double complex *w, int order, double noise, int *perm)
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
    const mt_damped_parts *const s = c->s;
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
    const int roots = order_roots(w, c->order, noise, perm);
    MT_TRY(mt_damped_claim(out, s->n, rigid + roots, s->mem, err));
    for (int i = 0; i < rigid; i++) {
        out->kind[i] = MT_DAMPED_RIGID_BODY;
    }
    for (int i = 0; i < roots; i++) {
        const double complex root = w[perm[i]];
        const ptrdiff_t to = rigid + i;
        out->re[to] = creal(root);
        out->im[to] = cimag(root) > noise ? cimag(root) : 0.0;
        out->kind[to] = mt_damped_kind_of(out->re[to], out->im[to], noise);
        write_structural_vector(c, vr + ((size_t)perm[i] * order), root,
                                out->y_re + (to * s->n), out->y_im + (to * s->n));
    }
    return MT_OK;
}

mt_status mt_damped_structural(const mt_damped_parts *s, mt_damped_modes *out, mt_err *err)
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
