/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * With A Z = 0 and a particular x_p, A x_p = b, both from one pivoted QR of A^T,
 *     x = x_p + Z y,   (Z^T M Z) y = Z^T (f - M x_p):
 * the formula's pseudo-inverses are not formed, and M need not be regular, Z^T M Z alone has to
 * be. lambda: A^T lambda = M x - f.
 *
 * With an inverse B of the matrix K of both equations, x and lambda at once, at an earlier
 * position, x <- x + B (rhs - K x) contracts by |1 - B K|, which is about what the position has
 * changed by; the limit is that of K, to what rounding leaves of rhs - K x.
 */
#include "simulate/accelerate.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* A direction whose mass is below this times the largest is one without mass: what rounding
 * leaves of none. */
static const double MASSLESS = 1e3 * DBL_EPSILON;
/* Such a direction is not pushed where the force along it is below this times the magnitudes
 * that cancel in it, or in another one. */
static const double UNPUSHED = 1e-9;
/* So many unknowns have an inverse: for fewer an elimination takes no longer, and what it
 * rounds is less where forces are large against accelerations; more would take 8 MB. */
enum { INVERSE_LEAST = 16, INVERSE_MOST = 1000 };
/* An inverse serves while each correction is at most this part of the one before, and few are
 * enough. */
static const double CONTRACTION = 0.1;
enum { CORRECTIONS = 10 };
/* Corrections below this part of the solution that shrink no more are rounding. */
static const double ROUNDED = 1e-13;
/* Of the equations that have an inverse: what is left of its digits makes up for it. */
static const double REGULAR = 1e-10;
/* An inverse that has served so often was worth its while: it is ten eliminations. */
enum { WORTH = 20 };

/* Z^T M Z = V diag(w) V^T with eigenvalues of 0: y = sum over the others of v (v . r)/w. size:
 * of the terms that r is the sum of. */
static mt_status solve_singular(int n, double *mass, double size, double *r, mt_arena *mem,
                                mt_err *err)
{
    double *const w = mt_arena_f64(mem, (size_t)n, 1);
    double *const along = mt_arena_f64(mem, (size_t)n, 1);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_eig_sym(n, mass, w, true, mem, err));
    mt_gemv(true, n, n, 1.0, mass, n, r, 0.0, along);
    for (int i = 0; i < n; i++) {
        const bool massless = !(w[i] > MASSLESS * w[n - 1]);
        if (massless && fabs(along[i]) > UNPUSHED * size) {
            return mt_fail(err, MT_E_SINGULAR,
                           "a direction without mass is pushed: mass and joints do not "
                           "determine its acceleration");
        }
        along[i] = massless ? 0.0 : along[i] / w[i];
    }
    mt_gemv(false, n, n, 1.0, mass, n, along, 0.0, r);
    return MT_OK;
}

/* r := (Z^T M Z)^-1 r. */
static mt_status solve_reduced(int n, double *mass, double size, double *r, mt_arena *mem,
                               mt_err *err)
{
    double *const l = mt_arena_f64(mem, (size_t)n, (size_t)n);
    MT_TRY(mt_arena_check(mem, err));
    double least = 1.0;
    memcpy(l, mass, (size_t)n * (size_t)n * sizeof *l);
    const mt_status rc = mt_cholesky(n, l, NULL, NULL);
    if (rc == MT_E_MEMORY) {
        return mt_fail_memory(err);
    }
    for (ptrdiff_t i = 0; i < n && rc == MT_OK; i++) {
        /* what a pivot has left of its diagonal entry */
        least = fmin(least, l[i + (i * n)] * l[i + (i * n)] / mass[i + (i * n)]);
    }
    if (rc != MT_OK || !(least > MASSLESS)) {
        return solve_singular(n, mass, size, r, mem, err);
    }
    mt_tri_solve(false, n, 1, l, r, n);
    mt_tri_solve(true, n, 1, l, r, n);
    return MT_OK;
}

/* Largest sum of magnitudes of the terms of Z^T f. */
static double size_of_terms(const mt_elimination *e, const double *f)
{
    double most = 0.0;
    for (ptrdiff_t i = 0; i < e->n; i++) {
        double sum = 0.0;
        for (ptrdiff_t k = 0; k < e->nq; k++) {
            sum += fabs(e->z[k + (i * e->nq)] * f[k]);
        }
        most = fmax(most, sum);
    }
    return most;
}

static mt_status solve_accelerations(const mt_system *sys, const mt_gauss *g, double *x,
                                     double *lambda, int *rank, mt_arena *mem, mt_err *err)
{
    const int nq = sys->nq;
    mt_elimination e;
    MT_TRY(mt_eliminate(sys, g->m, g->a, mem, &e, err));
    double *const mz = mt_arena_f64(mem, (size_t)nq, (size_t)e.n);
    double *const mass = mt_arena_f64(mem, (size_t)e.n, (size_t)e.n);
    double *const left = mt_arena_f64(mem, (size_t)nq, 1);
    double *const y = mt_arena_f64(mem, (size_t)e.n, 1);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_eliminate_particular(&e, g->b, x, mem, err));
    memcpy(left, g->force, (size_t)nq * sizeof *left);
    mt_gemv(false, nq, nq, -1.0, g->mass, nq, x, 1.0, left);
    if (e.n > 0) {
        mt_gemm(false, false, nq, e.n, nq, 1.0, g->mass, nq, e.z, nq, 0.0, mz, nq);
        mt_gemm(true, false, e.n, e.n, nq, 1.0, e.z, nq, mz, nq, 0.0, mass, e.n);
        mt_eliminate_project(&e, left, y);
        MT_TRY(solve_reduced(e.n, mass, size_of_terms(&e, left), y, mem, err));
        mt_eliminate_expand(&e, y, left);
        mt_axpy(nq, 1.0, left, x);
    }
    if (rank != NULL) {
        *rank = e.qr.rank;
    }
    if (lambda != NULL && g->m > 0) {
        memcpy(left, g->force, (size_t)nq * sizeof *left);
        mt_gemv(false, nq, nq, 1.0, g->mass, nq, x, -1.0, left);
        MT_TRY(mt_eliminate_multipliers(&e, left, lambda, mem, err));
    }
    return mt_all_finite(nq, x) ? MT_OK
                                : mt_fail(err, MT_E_DOMAIN, "an acceleration is not finite");
}

mt_status mt_gauss_solve(const mt_system *sys, const mt_gauss *g, double *x, double *lambda,
                         int *rank, mt_arena *mem, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    const mt_status rc = solve_accelerations(sys, g, x, lambda, rank, mem, err);
    mt_arena_rewind(mem, mark);
    return rc;
}

mt_status mt_gauss_near_init(mt_gauss_near *o, const mt_system *sys, int m, mt_arena *mem,
                             mt_err *err)
{
    const int n = sys->nq + m;
    *o = (mt_gauss_near){.n = n >= INVERSE_LEAST && n <= INVERSE_MOST ? n : 0};
    o->inverse = mt_arena_f64(mem, (size_t)o->n, (size_t)o->n);
    o->scale = mt_arena_f64(mem, (size_t)o->n, 1);
    o->x = mt_arena_f64(mem, (size_t)o->n, 1);
    o->rest = mt_arena_f64(mem, (size_t)o->n, 1);
    o->step = mt_arena_f64(mem, (size_t)o->n, 1);
    return mt_arena_check(mem, err);
}

/* Scales by which masses are at most 1 and the rows of A have length 1; angles count as
 * displacements at the model length. */
static void find_scale(const mt_system *sys, const mt_gauss *g, double *scale)
{
    const ptrdiff_t nq = sys->nq;
    double most = 0.0;
    for (int b = 0; b < sys->n_bodies; b++) {
        for (int k = 0; k < 6; k++) {
            const int dof = sys->bodies[b].dof[k];
            if (dof >= 0) {
                scale[dof] = k < 3 ? 1.0 : 1.0 / sys->length_m;
            }
        }
    }
    for (ptrdiff_t j = 0; j < nq; j++) {
        most = fmax(most, scale[j] * g->mass[j + (j * nq)] * scale[j]);
    }
    for (ptrdiff_t i = 0; i < g->m; i++) {
        double squares = 0.0;
        for (ptrdiff_t j = 0; j < nq; j++) {
            const double a = scale[j] * g->a[i + (j * g->m)];
            squares += a * a;
        }
        scale[nq + i] = squares > 0.0 && most > 0.0 ? sqrt(most / squares) : 1.0;
    }
}

/* The inverse at a position; o->known: the equations are regular. */
static mt_status make_inverse(mt_gauss_near *o, const mt_system *sys, const mt_gauss *g,
                              mt_arena *mem, mt_err *err)
{
    const ptrdiff_t n = o->n;
    const ptrdiff_t nq = sys->nq;
    double rcond = 0.0;
    double *const k = mt_arena_f64(mem, (size_t)n, (size_t)n);
    MT_TRY(mt_arena_check(mem, err));
    find_scale(sys, g, o->scale);
    for (ptrdiff_t j = 0; j < nq; j++) {
        for (ptrdiff_t i = 0; i < nq; i++) {
            k[i + (j * n)] = o->scale[i] * g->mass[i + (j * nq)] * o->scale[j];
        }
        for (ptrdiff_t i = 0; i < g->m; i++) {
            const double a = o->scale[nq + i] * g->a[i + (j * g->m)] * o->scale[j];
            k[nq + i + (j * n)] = a;
            k[j + ((nq + i) * n)] = -a;
        }
    }
    memset(o->inverse, 0, (size_t)(n * n) * sizeof *o->inverse);
    for (ptrdiff_t i = 0; i < n; i++) {
        o->inverse[i + (i * n)] = 1.0;
    }
    const mt_status rc = mt_lu_solve(o->n, k, o->n, o->inverse, &rcond, mem, NULL);
    o->known = rc == MT_OK && rcond > REGULAR;
    o->served = 0;
    return rc == MT_E_MEMORY ? mt_fail_memory(err) : MT_OK;
}

/* o->rest := S (rhs - K x). */
static void find_rest(mt_gauss_near *o, int nq, const mt_gauss *g)
{
    double *const force = o->rest;
    double *const gap = o->rest + nq;
    memcpy(force, g->force, (size_t)nq * sizeof *force);
    memcpy(gap, g->b, (size_t)g->m * sizeof *gap);
    mt_gemv(false, nq, nq, -1.0, g->mass, nq, o->x, 1.0, force);
    if (g->m > 0) {
        mt_gemv(true, g->m, nq, 1.0, g->a, g->m, o->x + nq, 1.0, force);
        mt_gemv(false, g->m, nq, -1.0, g->a, g->m, o->x, 1.0, gap);
    }
    for (int i = 0; i < o->n; i++) {
        o->rest[i] *= o->scale[i];
    }
}

/* Refine o->x, the last solution, until the corrections are rounding; false: they do not
 * converge, and o->x is 0. */
static bool correct(mt_gauss_near *o, int nq, const mt_gauss *g)
{
    double before = 0.0;
    for (int it = 0; it < CORRECTIONS; it++) {
        double size = 0.0;
        double moved = 0.0;
        find_rest(o, nq, g);
        mt_gemv(false, o->n, o->n, 1.0, o->inverse, o->n, o->rest, 0.0, o->step);
        for (int i = 0; i < o->n; i++) {
            const double step = fabs(o->step[i]);
            moved = !(step <= moved) ? step : moved; /* NaN is kept */
            o->x[i] += o->scale[i] * o->step[i];
            size = fmax(size, fabs(o->x[i]) / o->scale[i]);
        }
        const bool first = it == 0;
        const double part = first || before == 0.0 ? 0.0 : moved / before;
        if (moved == 0.0 || (!first && part * moved <= 0.5 * DBL_EPSILON * size) ||
            (moved <= ROUNDED * size && part > CONTRACTION)) {
            return true;
        }
        if (!(moved < HUGE_VAL) || part > CONTRACTION) {
            break;
        }
        before = moved;
    }
    memset(o->x, 0, (size_t)o->n * sizeof *o->x);
    return false;
}

mt_status mt_gauss_solve_near(mt_gauss_near *o, const mt_system *sys, const mt_gauss *g,
                              double *x, double *lambda, mt_arena *mem, mt_err *err)
{
    const int nq = sys->nq;
    if (o->known && correct(o, nq, g)) {
        o->served++;
        memcpy(x, o->x, (size_t)nq * sizeof *x);
        if (lambda != NULL) {
            memcpy(lambda, o->x + nq, (size_t)g->m * sizeof *lambda);
        }
        return MT_OK;
    }
    MT_TRY(mt_gauss_solve(sys, g, x, lambda, NULL, mem, err));
    if (o->known) { /* it serves no more */
        o->known = false;
        o->patience = o->served >= WORTH ? 0 : (2 * o->patience) + 1;
        o->wait = o->patience;
    }
    if (o->n > 0 && --o->wait < 0) {
        const mt_arena_mark mark = mt_arena_get_mark(mem);
        MT_TRY(make_inverse(o, sys, g, mem, err));
        mt_arena_rewind(mem, mark);
        if (!o->known) {
            o->patience = (2 * o->patience) + WORTH;
            o->wait = o->patience;
        }
    }
    return MT_OK;
}
