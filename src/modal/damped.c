/* SPDX-License-Identifier: GPL-3.0-or-later */
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
#include "modal/damped.h"

#include "modal/damped_priv.h"

#include <math.h>
#include <string.h>

#include "linalg/dense.h"
#include "modal/growth.h"

static const double TWO_PI = 6.283185307179586477;

mt_status mt_damped_sandwich(const mt_damped_parts *s, const double *b, int ra, const double *a,
                             int rc, const double *c, double *out, mt_err *err)
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
static mt_status turn_rigid(mt_damped_parts *s, mt_err *err)
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
    MT_TRY(mt_damped_sandwich(s, s->p->c, count, old, count, old, c, err));
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
static mt_status split_massless(mt_damped_parts *s, double *t, double *mu, int *u, mt_err *err)
{
    const int n = s->n;
    const int z = s->z;
    double *const scaled = mt_arena_f64(s->mem, (size_t)n, (size_t)z);
    double *const c = mt_arena_f64(s->mem, (size_t)z, (size_t)z);
    MT_TRY(mt_arena_check(s->mem, err));
    for (int j = 0; j < z; j++) {
        double kjj = 0.0;
        const double *const tj = s->p->mass->t + ((ptrdiff_t)(s->r + j) * n);
        MT_TRY(mt_damped_sandwich(s, s->p->k, 1, tj, 1, tj, &kjj, err));
        mt_axpy(n, kjj != 0.0 ? 1.0 / sqrt(fabs(kjj)) : 1.0, tj, scaled + ((ptrdiff_t)j * n));
    }
    MT_TRY(mt_damped_sandwich(s, s->p->c, z, scaled, z, scaled, c, err));
    MT_TRY(mt_eig_sym(z, c, mu, true, s->mem, err));
    mt_gemm(false, false, n, z, z, 1.0, scaled, n, c, z, 0.0, t, n);
    for (*u = 0; *u < z && !(mu[*u] > s->tol * mu[z - 1]); (*u)++) {
    }
    return MT_OK;
}

/* b, mu, kd: the damped directions without mass, with the undamped ones condensed. */
static mt_status massless(mt_damped_parts *s, mt_err *err)
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
        MT_TRY(mt_damped_sandwich(s, s->p->k, u, t, u, t, kuu, err));
        MT_TRY(mt_damped_sandwich(s, s->p->k, u, t, zd, s->b, kud, err));
        MT_TRY(mt_lu_solve(u, kuu, zd, kud, &rcond, s->mem, err));
        if (!(rcond > s->tol)) {
            return mt_fail(err, MT_E_SINGULAR,
                           "a direction without mass or damping is held by no stiffness");
        }
        mt_gemm(false, false, n, zd, u, -1.0, t, n, kud, u, 1.0, s->b, n);
    }
    return mt_damped_sandwich(s, s->p->k, zd, s->b, zd, s->b, s->kd, err);
}

static mt_status prepare_states(mt_damped_parts *s, mt_err *err)
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
    MT_TRY(mt_damped_sandwich(s, s->p->c, s->r, s->y, s->r, s->y, s->caa, err));
    MT_TRY(mt_damped_sandwich(s, s->p->c, s->zd, s->b, s->r, s->y, s->cda, err));
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
static void assemble_states(const mt_damped_parts *s, double *a)
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

void mt_damped_scale(int n, double *y_re, double *y_im)
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
static void write_eigenvector(const mt_damped_parts *s, const double *u, const double *w,
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
    mt_damped_scale(s->n, y_re, y_im);
}

mt_damped_kind mt_damped_kind_of(double re, double im, double noise)
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

mt_status mt_damped_claim(mt_damped_modes *out, int n, int count, mt_arena *mem, mt_err *err)
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

static mt_status solve_damped_modes(const mt_damped_parts *s, mt_damped_modes *out, mt_err *err)
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
    MT_TRY(mt_damped_claim(out, s->n, rigid + roots, s->mem, err));
    for (int i = 0; i < rigid; i++) {
        out->kind[i] = MT_DAMPED_RIGID_BODY;
    }
    for (int i = 0; i < roots; i++) {
        const int at = perm[i];
        const int to = rigid + i;
        const double *const u = vr + ((ptrdiff_t)at * s->order);
        out->re[to] = wr[at];
        out->im[to] = wi[at];
        out->kind[to] = mt_damped_kind_of(wr[at], wi[at], noise);
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
    mt_damped_parts s = {.p = p,
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
    MT_TRY(p->h == NULL ? solve_damped_modes(&s, out, err)
                        : mt_damped_structural(&s, out, err));
    MT_TRY(mt_damped_check(p, out, mem, err));
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
