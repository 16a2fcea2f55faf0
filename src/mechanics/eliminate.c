/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The freedoms that constraints leave, and the joints and motions by name. */
#include "mechanics/eliminate.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/format.h"
#include "linalg/dense.h"

/* Names. */

/* Entries of a left null vector (largest 1) above this belong to the dependent set. */
static const double IN_THE_SET = 1e-6;

mt_status mt_name_joints(const mt_system *sys, int m, const double *w, mt_arena *mem,
                         mt_joint_names *out, mt_err *err)
{
    const double least = IN_THE_SET * mt_max_abs(m, w);
    const char **const name = mt_arena_alloc(mem, (size_t)m, sizeof *name);
    const char *text = "";
    int n = 0;
    for (int i = 0; i < m && name != NULL; i++) {
        const int joint = sys->constraints[i].joint;
        const char *const of = joint >= 0 ? sys->joints[joint].name : NULL;
        bool in = joint >= 0 && fabs(w[i]) > least;
        for (int k = 0; k < n && in; k++) {
            in = name[k] != of;
        }
        if (in) {
            text = mt_arena_printf(mem, "%s%s\"%s\"", text, n == 0 ? "" : ", ", of);
            name[n++] = of;
        }
    }
    *out = (mt_joint_names){.n = n, .name = name, .text = text};
    return mt_arena_check(mem, err);
}

/* Freedoms that move more than this fraction of the largest motion are named. */
static const double NAMED = 0.3;

void mt_name_motion(const mt_system *sys, const mt_elimination *e, const double *y, char *text,
                    size_t size)
{
    static const char *const MOTION[6] = {"along x",          "along y",
                                          "along z",          "rotation about x",
                                          "rotation about y", "rotation about z"};
    double largest = 0.0;
    size_t used = 0;
    text[0] = '\0';
    for (int i = 0; i < 12 * sys->n_bodies; i++) { /* all bodies for the largest, then again */
        const int b = i % (6 * sys->n_bodies) / 6;
        const int k = i % 6;
        const int dof = sys->bodies[b].dof[k];
        double s = 0.0;
        for (int c = 0; c < e->n && dof >= 0; c++) {
            s += e->z[dof + ((ptrdiff_t)c * e->nq)] * y[c];
        }
        s = fabs(s) * (k < 3 ? 1.0 : sys->length_m);
        if (i < 6 * sys->n_bodies) {
            largest = fmax(largest, s);
        } else if (s > NAMED * largest && used < size) {
            const char *const motion = sys->dimension == 2 && k == 5 ? "rotation" : MOTION[k];
            const int n = mt_snprintf(text + used, size - used, "%s\"%s\" (%s)",
                                      used == 0 ? "" : ", ", sys->bodies[b].name, motion);
            used += n > 0 ? (size_t)n : 0;
        }
    }
}

/* Elimination by a pivoted QR. */

/* Relative size below which a diagonal entry of R counts as zero: rounding leaves about nq eps
 * ~ 1e-14, real mechanisms next to a singular position 1e-6 and more; the gap is reported
 * (qr.kept, qr.dropped). */
static const double RANK_TOLERANCE = 1e-9;

mt_status mt_eliminate_factor(const mt_system *sys, int m, const double *a, mt_arena *mem,
                              mt_elimination *out, mt_err *err)
{
    const int nq = sys->nq;
    double *const at = mt_arena_f64(mem, (size_t)nq, (size_t)m);
    *out = (mt_elimination){.m = m, .nq = nq};
    out->dr = mt_arena_f64(mem, (size_t)m, 1);
    out->dc = mt_arena_f64(mem, (size_t)nq, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int b = 0; b < sys->n_bodies; b++) {
        for (int k = 0; k < 6; k++) {
            if (sys->bodies[b].dof[k] >= 0) {
                out->dc[sys->bodies[b].dof[k]] = k < 3 ? 1.0 : 1.0 / sys->length_m;
            }
        }
    }
    for (int i = 0; i < m; i++) {
        double *const row = at + ((ptrdiff_t)i * nq);
        for (int j = 0; j < nq; j++) {
            row[j] = a[i + ((ptrdiff_t)j * m)] * out->dc[j];
        }
        const double norm = mt_norm2(nq, row);
        out->dr[i] = norm > 0.0 ? 1.0 / norm : 1.0;
        for (int j = 0; j < nq; j++) {
            row[j] *= out->dr[i];
        }
    }
    MT_TRY(mt_qr_factor(nq, m, at, nq, RANK_TOLERANCE, mem, &out->qr, err));
    out->n = nq - out->qr.rank;
    return MT_OK;
}

mt_status mt_eliminate_basis(mt_elimination *e, mt_arena *scratch, mt_err *err)
{
    MT_TRY(mt_qr_q(&e->qr, e->qr.rank, e->z, scratch, err));
    for (int c = 0; c < e->n; c++) {
        for (int j = 0; j < e->nq; j++) {
            e->z[j + ((ptrdiff_t)c * e->nq)] *= e->dc[j];
        }
    }
    return MT_OK;
}

mt_status mt_eliminate(const mt_system *sys, int m, const double *a, mt_arena *mem,
                       mt_elimination *out, mt_err *err)
{
    MT_TRY(mt_eliminate_factor(sys, m, a, mem, out, err));
    out->z = mt_arena_f64(mem, (size_t)out->nq, (size_t)out->n);
    MT_TRY(mt_arena_check(mem, err));
    return mt_eliminate_basis(out, mem, err);
}

mt_status mt_eliminate_particular(const mt_elimination *e, const double *b, double *v,
                                  mt_arena *scratch, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double *const scaled = mt_arena_f64(scratch, (size_t)e->m, 1);
    MT_TRY(mt_arena_check(scratch, err));
    for (int i = 0; i < e->m; i++) {
        scaled[i] = e->dr[i] * b[i];
    }
    MT_TRY(mt_qr_solve_transposed(&e->qr, 1, scaled, v, scratch, err));
    for (int j = 0; j < e->nq; j++) {
        v[j] *= e->dc[j];
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}

mt_status mt_eliminate_multipliers(const mt_elimination *e, const double *g, double *lambda,
                                   mt_arena *scratch, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double *const scaled = mt_arena_f64(scratch, (size_t)e->nq, 1);
    MT_TRY(mt_arena_check(scratch, err));
    for (int j = 0; j < e->nq; j++) {
        scaled[j] = e->dc[j] * g[j];
    }
    MT_TRY(mt_qr_solve(&e->qr, 1, scaled, lambda, scratch, err));
    for (int i = 0; i < e->m; i++) {
        lambda[i] *= e->dr[i];
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}

void mt_eliminate_project(const mt_elimination *e, const double *g, double *out)
{
    mt_gemv(true, e->nq, e->n, 1.0, e->z, e->nq, g, 0.0, out);
}

void mt_eliminate_expand(const mt_elimination *e, const double *y, double *out)
{
    mt_gemv(false, e->nq, e->n, 1.0, e->z, e->nq, y, 0.0, out);
}

/* Column rank + k of A_s^T P is a combination of the first rank columns: R11 x = R12(:, k), so
 * (x, -1) is the null vector. */
mt_status mt_eliminate_left_null(const mt_elimination *e, int k, double *w, mt_arena *scratch,
                                 mt_err *err)
{
    return mt_eliminate_left_vector(e, e->qr.rank, k, w, scratch, err);
}

mt_status mt_eliminate_left_vector(const mt_elimination *e, int rank, int k, double *w,
                                   mt_arena *scratch, mt_err *err)
{
    const double *const r = e->qr.qr;
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double *const x = mt_arena_f64(scratch, (size_t)rank, 1);
    MT_TRY(mt_arena_check(scratch, err));
    for (int i = rank - 1; i >= 0; i--) {
        double s = r[i + ((ptrdiff_t)(rank + k) * e->nq)];
        for (int j = i + 1; j < rank; j++) {
            s -= r[i + ((ptrdiff_t)j * e->nq)] * x[j];
        }
        x[i] = s / r[i + ((ptrdiff_t)i * e->nq)];
    }
    double largest = 1.0;
    for (int i = 0; i < e->m; i++) {
        w[i] = 0.0;
    }
    for (int i = 0; i < rank; i++) {
        w[e->qr.perm[i]] = x[i];
        largest = fmax(largest, fabs(x[i]));
    }
    w[e->qr.perm[rank + k]] = -1.0;
    for (int i = 0; i < e->m; i++) {
        w[i] /= largest;
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}

/*
 * All matrices stand transposed, T = A_d^-T, so that rows of the equations are contiguous:
 *     X^T = A_f^T T,   refined once by the residual,   X^T += (A_f^T - X^T A_d^T) T,
 * after which what is left of it is what its own evaluation leaves, k + 1 roundings of each of
 * the k terms of an equation. These join E. The second order, E_d dX, is less than a part of
 * the first:
 *     rho = || |A_d^-1| E_d ||_inf < 1,   dX / (1 - rho).
 */

/* Above this rho nothing is known of A_d^-1. */
static const double MOST_OPEN = 0.5;

typedef struct work {
    int rank;
    int n;
    int *place; /* [nq] of a coordinate among those that follow, or among the free ones */
    double *t;  /* rank x rank: T */
    double *r;  /* n x rank: A_f^T, the residual, then E_d |X| + E_f */
    double *s;  /* [rank] sums of the rows of E_d */
} work;

static mt_status claim_followers(mt_follow *f, work *w, mt_arena *mem, mt_err *err)
{
    const size_t rank = (size_t)w->rank;
    f->x = mt_arena_f64(mem, (size_t)w->n, rank);
    f->dx = mt_arena_f64(mem, (size_t)w->n, rank);
    w->place = mt_arena_int(mem, (size_t)f->nq);
    w->t = mt_arena_f64(mem, rank, rank);
    w->r = mt_arena_f64(mem, (size_t)w->n, rank);
    w->s = mt_arena_f64(mem, rank, 1);
    MT_TRY(mt_arena_check(mem, err));
    int count[2] = {0, 0};
    for (int j = 0; j < f->nq; j++) {
        w->place[j] = count[f->follows[j] ? 1 : 0]++;
    }
    return MT_OK;
}

static mt_status invert(const mt_follow *f, work *w, mt_arena *mem, mt_err *err)
{
    const ptrdiff_t rank = w->rank;
    double *const a = mt_arena_f64(mem, (size_t)rank, (size_t)rank);
    MT_TRY(mt_arena_check(mem, err));
    for (ptrdiff_t i = 0; i < rank; i++) {
        const double *const g = f->g + (i * f->nq);
        for (int j = 0; j < f->nq; j++) {
            if (f->follows[j]) {
                a[w->place[j] + (i * rank)] = g[j];
            }
        }
        w->t[i + (i * rank)] = 1.0;
    }
    return mt_lu_solve(w->rank, a, w->rank, w->t, NULL, mem, err);
}

/* r := A_f^T - X^T A_d^T. */
static void find_residual(const mt_follow *f, work *w)
{
    const ptrdiff_t n = w->n;
    memset(w->r, 0, (size_t)n * (size_t)w->rank * sizeof *w->r);
    for (ptrdiff_t i = 0; i < w->rank; i++) {
        const double *const g = f->g + (i * f->nq);
        double *const r = w->r + (i * n);
        for (int j = 0; j < f->nq; j++) {
            if (g[j] != 0.0 && f->follows[j]) {
                mt_axpy(w->n, -g[j], f->x + (w->place[j] * n), r);
            } else if (g[j] != 0.0) {
                r[w->place[j]] += g[j];
            }
        }
    }
}

/* x += (A_f^T - X^T A_d^T) T. */
static void correct(const mt_follow *f, work *w)
{
    find_residual(f, w);
    mt_gemm(false, false, w->n, w->rank, w->rank, 1.0, w->r, w->n, w->t, w->rank, 1.0, f->x,
            w->n);
}

/* r := E_d |X| + E_f, transposed, and s. */
static void find_open(const mt_follow *f, work *w)
{
    const ptrdiff_t n = w->n;
    memset(w->r, 0, (size_t)n * (size_t)w->rank * sizeof *w->r);
    for (ptrdiff_t i = 0; i < w->rank; i++) {
        const double *const g = f->g + (i * f->nq);
        const double *const e = f->e + (i * f->nq);
        double *const r = w->r + (i * n);
        double roundings = 1.0;
        for (int j = 0; j < f->nq; j++) {
            roundings += g[j] != 0.0 ? 1.0 : 0.0;
        }
        for (int j = 0; j < f->nq; j++) {
            const double open = e[j] + (roundings * DBL_EPSILON * fabs(g[j]));
            const double *const x = f->x + (w->place[j] * n);
            if (open == 0.0) {
                continue;
            }
            if (!f->follows[j]) {
                r[w->place[j]] += open;
                continue;
            }
            w->s[i] += open;
            for (ptrdiff_t c = 0; c < n; c++) {
                r[c] += open * fabs(x[c]);
            }
        }
    }
}

/* t := |T|; returns rho. */
static double find_rho(work *w)
{
    const ptrdiff_t rank = w->rank;
    double rho = 0.0;
    for (ptrdiff_t k = 0; k < rank; k++) {
        double sum = 0.0;
        for (ptrdiff_t i = 0; i < rank; i++) {
            double *const t = w->t + i + (k * rank);
            *t = fabs(*t);
            sum += *t * w->s[i];
        }
        rho = !(sum <= rho) ? sum : rho; /* NaN is kept */
    }
    return rho;
}

mt_status mt_follow_find(mt_follow *f, mt_arena *mem, bool *holds, mt_err *err)
{
    work w = {.rank = f->rank, .n = f->nq - f->rank};
    *holds = false;
    MT_TRY(claim_followers(f, &w, mem, err));
    const mt_status rc = invert(f, &w, mem, err);
    if (rc == MT_E_SINGULAR) {
        return MT_OK;
    }
    MT_TRY(rc);
    correct(f, &w); /* of 0 */
    correct(f, &w);
    find_open(f, &w);
    const double rho = find_rho(&w);
    if (!(rho < MOST_OPEN)) {
        return MT_OK;
    }
    mt_gemm(false, false, w.n, w.rank, w.rank, 1.0 / (1.0 - rho), w.r, w.n, w.t, w.rank, 0.0,
            f->dx, w.n);
    for (ptrdiff_t k = 0; k < (ptrdiff_t)w.n * w.rank; k++) {
        f->dx[k] += DBL_EPSILON * fabs(f->x[k]);
    }
    *holds = true;
    return MT_OK;
}

/*
 * A basis of the freedoms that stays with the bodies. An orthonormal basis of A dq = 0 mixes
 * all of them: what stands still moves by a rounding of what moves most, and a mass or spring
 * that is 1e16 times the others makes that rounding the answer. Instead some coordinates f are
 * chosen as free, the others d follow,
 *     dq_d = -A_d^-1 A_f dq_f,        Z = [-A_d^-1 A_f; I],
 * by Gaussian elimination that touches only what is coupled, so that what does not move with a
 * free coordinate has an entry of exactly 0. Three things decide the pivots:
 *   - of the coordinates of an equation the light ones follow the heavy ones: pivots are the
 *     largest of |A_ij| / sqrt(m_j), as in complete pivoting of A M^-1/2. The entries of
 *     M^1/2 Z M_f^-1/2 are then of size one, and Z^T M Z, scaled to unit diagonal, stays well
 *         conditioned whatever the masses are;
 *   - no pivot is small in its own equation, whatever the masses;
 *   - what is left of a difference is 0 where it is within the rounding of its terms, which are
 *     carried along (running error analysis).
 *
 * Errors carried along grow with the sizes of all steps, whatever their signs: from one storey
 * of a long stack to the next as |T| |T| |T| ... does, which may be 1e30 where T T T ... is 1.
 * Where they have grown, nothing is made 0 by them; they only chose what follows, and Z and
 * what is open of it come from A_d^-1.
 * See Golub and Van Loan, Matrix Computations, 3.4 (complete pivoting); Demmel et al., Linear
 * Algebra Appl. 299 (1999) (elimination of graded matrices keeps relative accuracy).
 */

/* A pivot is at least this part of the largest entry of its equation: errors grow by no more
 * than its inverse. */
static const double SMALLEST_PIVOT = 0.1;
/* Rounding of an entry of A, and of one operation. */
static const double ENTRY_ULPS = 4.0;
/* A coordinate without mass counts as this part of the heaviest one: it follows whenever it
 * can. */
static const double MASSLESS = 1e-60;
/* Errors that are carried along have grown where they are this many times those of the entries
 * of A. Those of a few dozen bodies have not. */
static const double GROWN = 1e3;

typedef struct local_work {
    int rank;
    int nq;
    double *g;      /* rank x nq, row-major: the independent equations, equilibrated */
    double *e;      /* bounds of the errors of g */
    double entry;   /* the largest of the entries of A */
    double most;    /* the largest of all so far */
    bool carried;   /* errors are carried along */
    double *weight; /* [nq] 1 / sqrt(mass) */
    int *pivot;     /* [rank] column of the equation's pivot; -1: to come */
    int *order;     /* [rank] equations in the order of elimination */
    bool *follows;  /* [nq] chosen as a pivot */
    int *best;      /* [rank] column of the best pivot in sight */
    double *score;  /* [rank] its size */
    int n_open;
    int *open;    /* [n_open] columns that are no pivots yet, ascending */
    int *list;    /* [nq] columns of one row */
    int *found;   /* rank x (nq - rank): those of the rows that are substituted */
    int *n_found; /* [rank] how many */
} local_work;

static mt_status claim_elimination_work(local_work *w, mt_arena *mem, mt_err *err)
{
    const size_t rank = (size_t)w->rank;
    const size_t nq = (size_t)w->nq;
    w->g = mt_arena_f64(mem, rank, nq);
    w->e = mt_arena_f64(mem, rank, nq);
    w->weight = mt_arena_f64(mem, nq, 1);
    w->pivot = mt_arena_int(mem, rank);
    w->order = mt_arena_int(mem, rank);
    w->follows = mt_arena_alloc(mem, nq, sizeof *w->follows);
    w->best = mt_arena_int(mem, rank);
    w->score = mt_arena_f64(mem, rank, 1);
    w->open = mt_arena_int(mem, nq);
    w->list = mt_arena_int(mem, nq);
    w->found = mt_arena_int(mem, rank * (nq - rank));
    w->n_found = mt_arena_int(mem, rank);
    return mt_arena_check(mem, err);
}

/* mass[nq]: diagonal of M; weights in the elimination's coordinates. */
static void weigh_columns(local_work *w, const mt_elimination *e, const double *mass)
{
    double most = 0.0;
    for (int j = 0; j < w->nq; j++) {
        most = fmax(most, mass[j] * e->dc[j] * e->dc[j]);
    }
    for (int j = 0; j < w->nq; j++) {
        const double m = mass[j] * e->dc[j] * e->dc[j];
        w->weight[j] = most > 0.0 ? 1.0 / sqrt(fmax(m / most, MASSLESS)) : 1.0;
    }
}

/* The best pivot of equation i. */
static void find_best_pivot(local_work *w, int i)
{
    const double *const g = w->g + ((ptrdiff_t)i * w->nq);
    double most = 0.0;
    w->best[i] = -1;
    w->score[i] = 0.0;
    for (int k = 0; k < w->n_open; k++) {
        const double size = fabs(g[w->open[k]]);
        most = size > most ? size : most;
    }
    for (int k = 0; k < w->n_open; k++) {
        const int j = w->open[k];
        const double size = fabs(g[j]);
        if (size > 0.0 && size >= SMALLEST_PIVOT * most && size * w->weight[j] > w->score[i]) {
            w->score[i] = size * w->weight[j];
            w->best[i] = j;
        }
    }
}

static void open_columns(local_work *w)
{
    w->n_open = 0;
    for (int j = 0; j < w->nq; j++) {
        if (!w->follows[j]) {
            w->open[w->n_open++] = j;
        }
    }
}

static void load_scaled_equations(local_work *w, const mt_elimination *e, const double *a,
                                  double extent)
{
    w->entry = 0.0;
    open_columns(w);
    for (int i = 0; i < w->rank; i++) {
        const int row = e->qr.perm[i];
        for (ptrdiff_t j = 0; j < w->nq; j++) {
            const ptrdiff_t at = j + ((ptrdiff_t)i * w->nq);
            w->g[at] = e->dr[row] * a[row + (j * e->m)] * e->dc[j];
            w->e[at] = 0.0;
            if (w->g[at] == 0.0) {
                continue;
            }
            const double arm = e->dc[j] == 1.0 ? 0.0 : e->dr[row] * extent * e->dc[j];
            w->e[at] = ENTRY_ULPS * DBL_EPSILON * (fabs(w->g[at]) + arm);
            w->entry = w->e[at] > w->entry ? w->e[at] : w->entry;
            if (fabs(w->g[at]) <= w->e[at]) {
                w->g[at] = 0.0;
            }
        }
        w->pivot[i] = -1;
        find_best_pivot(w, i);
    }
    w->most = w->entry;
}

static bool is_grown(const local_work *w)
{
    return w->most > GROWN * w->entry;
}

/* to -= factor * from at the n columns listed. */
static void subtract(local_work *w, int n, const int *list, double factor, double factor_error,
                     int from, int to)
{
    const double *const g = w->g + ((ptrdiff_t)from * w->nq);
    const double *const e = w->e + ((ptrdiff_t)from * w->nq);
    double *const gt = w->g + ((ptrdiff_t)to * w->nq);
    double *const et = w->e + ((ptrdiff_t)to * w->nq);
    for (int k = 0; k < n; k++) {
        const int j = list[k];
        const double part = factor * g[j];
        const double rounding = DBL_EPSILON * (fabs(gt[j]) + fabs(part));
        if (w->carried) {
            et[j] += (fabs(factor) * e[j]) + (factor_error * fabs(g[j])) + rounding;
            w->most = et[j] > w->most ? et[j] : w->most;
        }
        gt[j] -= part;
        if (fabs(gt[j]) <= (w->carried ? et[j] : ENTRY_ULPS * rounding)) {
            gt[j] = 0.0;
        }
    }
}

/* Columns with an entry in equation i that are not pivots yet, into list; returns their
 * number. */
static int list_open(const local_work *w, int i, int *list)
{
    const double *const g = w->g + ((ptrdiff_t)i * w->nq);
    const double *const e = w->e + ((ptrdiff_t)i * w->nq);
    int n = 0;
    for (int k = 0; k < w->n_open; k++) {
        const int j = w->open[k];
        if (g[j] != 0.0 || e[j] != 0.0) {
            list[n++] = j;
        }
    }
    return n;
}

/* The open equation with the best pivot in sight. */
static int next_equation(const local_work *w)
{
    int row = -1;
    for (int i = 0; i < w->rank; i++) {
        if (w->pivot[i] < 0 && (row < 0 || w->score[i] > w->score[row])) {
            row = i;
        }
    }
    return row;
}

/* Forward elimination; false where an equation has nothing left that is more than rounding, or
 * errors have grown. */
static bool eliminate_forward(local_work *w)
{
    const ptrdiff_t nq = w->nq;
    for (int step = 0; step < w->rank && !is_grown(w); step++) {
        const int row = next_equation(w);
        const int column = w->best[row];
        if (column < 0) {
            return false;
        }
        w->pivot[row] = column;
        w->order[step] = row;
        w->follows[column] = true;
        open_columns(w);
        const int n = list_open(w, row, w->list);
        const double p = w->g[column + (row * nq)];
        const double dp = w->e[column + (row * nq)] / fabs(p);
        for (int i = 0; i < w->rank; i++) {
            const double x = w->g[column + (i * nq)];
            if (w->pivot[i] >= 0 || (x == 0.0 && w->e[column + (i * nq)] == 0.0)) {
                continue;
            }
            const double factor = x / p;
            const double error = (w->e[column + (i * nq)] / fabs(p)) + (fabs(factor) * dp);
            w->g[column + (i * nq)] = 0.0;
            w->e[column + (i * nq)] = 0.0;
            if (x != 0.0) {
                subtract(w, n, w->list, factor, error, row, i);
            }
            find_best_pivot(w, i);
        }
        for (int i = 0; i < w->rank; i++) { /* a pivot in sight is taken */
            if (w->pivot[i] < 0 && w->best[i] == column) {
                find_best_pivot(w, i);
            }
        }
    }
    return !is_grown(w);
}

/* Back substitution: each equation in its pivot and free columns alone. */
static void substitute(local_work *w)
{
    const ptrdiff_t nq = w->nq;
    const ptrdiff_t free = nq - w->rank;
    for (int step = w->rank - 1; step >= 0; step--) {
        const int i = w->order[step];
        for (int later = step + 1; later < w->rank; later++) {
            const int from = w->order[later];
            const int column = w->pivot[from];
            const double x = w->g[column + (i * nq)];
            if (x != 0.0) {
                const double error = w->e[column + (i * nq)];
                w->g[column + (i * nq)] = 0.0;
                subtract(w, w->n_found[from], w->found + (from * free), x, error, from, i);
            }
        }
        const double p = w->g[w->pivot[i] + (i * nq)];
        const double dp = w->e[w->pivot[i] + (i * nq)] / fabs(p);
        int *const found = w->found + (i * free);
        w->n_found[i] = list_open(w, i, found);
        for (int k = 0; k < w->n_found[i]; k++) {
            double *const x = &w->g[found[k] + (i * nq)];
            double *const ex = &w->e[found[k] + (i * nq)];
            *x /= p;
            *ex = (*ex / fabs(p)) + (fabs(*x) * (dp + DBL_EPSILON));
        }
        w->g[w->pivot[i] + (i * nq)] = 1.0;
    }
}

/* z := [-X; I], error: bounds. */
static void fill_null_basis(const local_work *w, mt_elimination *e, double *error)
{
    const ptrdiff_t nq = w->nq;
    int c = 0;
    for (ptrdiff_t j = 0; j < nq; j++) {
        if (w->follows[j]) {
            continue;
        }
        double *const z = e->z + (c * nq);
        double *const dz = error + (c * nq);
        for (ptrdiff_t k = 0; k < nq; k++) {
            z[k] = 0.0;
            dz[k] = 0.0;
        }
        z[j] = e->dc[j];
        for (int i = 0; i < w->rank; i++) {
            const int k = w->pivot[i];
            z[k] = -w->g[j + (i * nq)] * e->dc[k];
            dz[k] = w->e[j + (i * nq)] * e->dc[k];
        }
        c++;
    }
}

/* As fill_null_basis, from X and its error bounds: an entry within its bound is set to 0. */
static void fill_found(const mt_follow *f, mt_elimination *e, double *error)
{
    const ptrdiff_t nq = f->nq;
    const ptrdiff_t n = f->nq - f->rank;
    ptrdiff_t row = 0;
    ptrdiff_t free = 0;
    for (ptrdiff_t k = 0; k < nq; k++) {
        for (ptrdiff_t c = 0; c < n; c++) {
            e->z[k + (c * nq)] = 0.0;
            error[k + (c * nq)] = 0.0;
        }
        if (!f->follows[k]) {
            e->z[k + (free++ * nq)] = e->dc[k];
            continue;
        }
        for (ptrdiff_t c = 0; c < n; c++) {
            const double x = f->x[c + (row * n)];
            const double dx = f->dx[c + (row * n)];
            e->z[k + (c * nq)] = fabs(x) <= dx ? 0.0 : -x * e->dc[k];
            error[k + (c * nq)] = dx * e->dc[k];
        }
        row++;
    }
}

/* Choose the dependent coordinates again, without errors, and compute X; false where it is not
 * determined. */
static mt_status choose_and_find(local_work *w, const double *a, double extent, mt_arena *mem,
                                 mt_elimination *e, double *error, bool *found, mt_err *err)
{
    mt_follow f = {.rank = w->rank, .nq = w->nq, .g = w->g, .e = w->e, .follows = w->follows};
    memset(w->follows, 0, (size_t)w->nq * sizeof *w->follows);
    load_scaled_equations(w, e, a, extent);
    memset(w->e, 0, (size_t)w->rank * (size_t)w->nq * sizeof *w->e);
    w->carried = false;
    *found = eliminate_forward(w);
    if (*found) {
        load_scaled_equations(w, e, a, extent);
        MT_TRY(mt_follow_find(&f, mem, found, err));
    }
    if (*found) {
        fill_found(&f, e, error);
    }
    return MT_OK;
}

/* Error bound of the orthonormal basis: about nq eps / kept for all columns. */
static void bound_orthonormal(const mt_elimination *e, double extent, double *error)
{
    const double unit = ENTRY_ULPS * (double)e->nq * DBL_EPSILON / e->qr.kept;
    for (ptrdiff_t c = 0; c < e->n; c++) {
        for (ptrdiff_t j = 0; j < e->nq; j++) {
            const double far = e->dc[j] == 1.0 ? 1.0 : extent * e->dc[j];
            error[j + (c * e->nq)] = unit * fmax(far, 1.0) * e->dc[j];
        }
    }
}

mt_status mt_eliminate_local(const double *a, const double *mass, double extent, mt_arena *mem,
                             mt_elimination *e, double *error, mt_err *err)
{
    local_work w = {.rank = e->qr.rank, .nq = e->nq, .carried = true};
    bool found = false;
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    MT_TRY(claim_elimination_work(&w, mem, err));
    weigh_columns(&w, e, mass);
    load_scaled_equations(&w, e, a, extent);
    if (eliminate_forward(&w)) {
        substitute(&w);
        found = !is_grown(&w);
    }
    if (found) {
        fill_null_basis(&w, e, error);
    } else if (is_grown(&w)) {
        MT_TRY(choose_and_find(&w, a, extent, mem, e, error, &found, err));
    }
    if (!found) {
        MT_TRY(mt_eliminate_basis(e, mem, err));
        bound_orthonormal(e, extent, error);
    }
    mt_arena_rewind(mem, mark);
    return MT_OK;
}
