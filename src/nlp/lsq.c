/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Least squares within bounds: Levenberg-Marquardt with a projected active set.
 *
 *     minimise 1/2 |R(t)|^2,  lower <= t <= upper
 *
 * A step solves min |R + J s|^2 + mu |s|^2 over the variables that are free (not at a bound
 * which the gradient pushes them through), by QR of the stacked matrix, so that the condition
 * is not squared. Variables that would cross a bound are put on it and the others solved again:
 * near a solution the right bounds are active at once. Towards mu = infinity the step is the
 * projected gradient, a descent direction, so a reduction is always found. With mu -> 0 the
 * steps are Gauss-Newton's of least norm: directions without influence do not move at all.
 * (GSL's multifit has no bounds.)
 *
 * It goes on until nothing improves, not until a tolerance is met: at a double root R is
 * quadratic in the error, |R| = 1e-6 leaves an error of 1e-3, and the convergence is only by
 * halves.
 */
#include "nlp/lsq.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { ITERATIONS = 150, REJECTIONS = 25, REJECTIONS_EXACT = 3, STAGNATIONS = 3 };
/* mu relative to the largest column norm of J, squared: the first value (the usual choice) and
 * the least (its root is far above the rounding of J, so that rounding never makes a step). */
static const double MU_FIRST = 1e-3;
static const double MU_LEAST = 1e-16;
/* Gain ratios (actual over predicted reduction) for accepting a step and for trusting the model
 * much more. */
static const double GAIN_ACCEPT = 1e-4;
static const double GAIN_GOOD = 0.75;
/* |R| of this size is the rounding of a few operations on numbers near 1 (R is
 * dimensionless). */
static const double R_EXACT = 16 * DBL_EPSILON;
/* A relative reduction of |R|^2 smaller than this is rounding. */
static const double STAGNATION = 64 * DBL_EPSILON;

/* Violations this far below their tolerances need no stubborn search for a further
 * reduction. */
static const double VIOLATION_EXACT = 1e-3;
/* Squares of violations above so many tolerances, where a minimum is no root: it is reached
 * where the step that was taken gains no more than this part of them, and the slope along no
 * variable is more than that part of |R| and of its column; where a longer step was refused, of
 * SHORT of the longest column. (What is left of t is about that part: the slope is the
 * curvature that R has, times it; Newton's method does the rest.) */
static const double NO_ROOT = 100.0;
static const double LITTLE = 1e-7;
static const double UPRIGHT = 1e-5;
static const double SHORT = 0.1;

typedef struct lsq {
    mt_nlp_engine *e;
    mt_nlp_stage stage;
    int m;
    double *R;  /* [m] */
    double *J;  /* m x n */
    double *s;  /* [n] step */
    double *A;  /* (m + n) x n stacked matrix of the free variables */
    double *b;  /* [m + n] */
    double *x;  /* [n] */
    bool *free; /* [n] */
    int *index; /* [n] */
} lsq;

/* R and J of the stage at p; satisfied inequalities are zero rows. */
static void linearise(lsq *w, const mt_nlp_point *p)
{
    const mt_nlp *const q = w->e->nlp;
    const ptrdiff_t m = w->m;
    if (w->stage == MT_NLP_RESIDUALS) {
        memcpy(w->R, p->r, (size_t)m * sizeof *w->R);
        memcpy(w->J, p->dr, (size_t)m * (size_t)w->e->n * sizeof *w->J);
        return;
    }
    memcpy(w->R, p->eq, (size_t)q->n_eq * sizeof *w->R);
    for (int i = 0; i < q->n_in; i++) {
        w->R[q->n_eq + i] = fmin(p->in[i], 0);
    }
    for (int j = 0; j < w->e->n; j++) {
        double *const Jj = w->J + j * m;
        memcpy(Jj, p->deq + (ptrdiff_t)j * q->n_eq, (size_t)q->n_eq * sizeof *Jj);
        for (int i = 0; i < q->n_in; i++) {
            Jj[q->n_eq + i] = p->in[i] < 0 ? p->din[i + (ptrdiff_t)j * q->n_in] : 0;
        }
    }
}

static double half_squares(const lsq *w, const mt_nlp_point *p)
{
    return w->stage == MT_NLP_RESIDUALS ? p->f : 0.5 * p->squares;
}

/* Free variables: not held, not on a bound that the gradient pushes through. Returns the
 * greatest column norm of J. */
static double choose_free(lsq *w, const mt_nlp_point *p)
{
    const mt_nlp *const q = w->e->nlp;
    double largest = 0;
    for (int j = 0; j < w->e->n; j++) {
        const double *const Jj = w->J + (ptrdiff_t)j * w->m;
        const double g = mt_dot(w->m, Jj, w->R);
        const bool stuck =
            (p->t[j] <= q->lower[j] && g > 0) || (p->t[j] >= q->upper[j] && g < 0);
        w->free[j] = !w->e->held[j] && !stuck;
        if (w->free[j]) {
            largest = fmax(largest, mt_norm2(w->m, Jj));
        }
    }
    return largest;
}

/* True where R, which is no root and was reduced by `less`, is orthogonal to the columns of all
 * free variables. least: smallest length that a column counts with. */
static bool is_least(const lsq *w, const mt_nlp_point *p, double less, double least)
{
    bool upright = w->stage == MT_NLP_SQUARES && p->violation > NO_ROOT &&
                   less <= LITTLE * (half_squares(w, p) + less);
    const double size = mt_norm2(w->m, w->R);
    for (int j = 0; j < w->e->n && upright; j++) {
        const double *const Jj = w->J + (ptrdiff_t)j * w->m;
        const double column = fmax(mt_norm2(w->m, Jj), least);
        upright = !w->free[j] || fabs(mt_dot(w->m, Jj, w->R)) <= UPRIGHT * size * column;
    }
    return upright;
}

/* Solves for the step of the free variables with the others' steps in s given. */
static bool solve_free(lsq *w, double mu)
{
    const int m = w->m;
    int k = 0;
    memset(w->b, 0, (size_t)(m + w->e->n) * sizeof *w->b);
    for (int i = 0; i < m; i++) {
        w->b[i] = -w->R[i];
    }
    for (int j = 0; j < w->e->n; j++) {
        if (w->free[j]) {
            w->index[k++] = j;
        } else if (w->s[j] != 0) {
            mt_axpy(m, -w->s[j], w->J + (ptrdiff_t)j * m, w->b);
        }
    }
    const ptrdiff_t ld = m + k;
    memset(w->A, 0, (size_t)ld * (size_t)k * sizeof *w->A);
    for (int c = 0; c < k; c++) {
        memcpy(w->A + c * ld, w->J + (ptrdiff_t)w->index[c] * m, (size_t)m * sizeof *w->A);
        w->A[m + c + c * ld] = sqrt(mu);
    }
    mt_arena *const mem = &w->e->scratch;
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    mt_qr qr;
    mt_status rc = mt_qr_factor((int)ld, k, w->A, (int)ld, 0.0, mem, &qr, w->e->err);
    if (rc == MT_OK) {
        rc = mt_qr_solve(&qr, 1, w->b, w->x, mem, w->e->err);
    }
    mt_arena_rewind(mem, mark);
    if (!mt_nlp_ok(w->e, rc)) {
        return false;
    }
    for (int c = 0; c < k; c++) {
        w->s[w->index[c]] = w->x[c];
    }
    return true;
}

/* The step s from p within the bounds. */
static bool bounded_step(lsq *w, const mt_nlp_point *p, double mu)
{
    const mt_nlp *const q = w->e->nlp;
    memset(w->s, 0, (size_t)w->e->n * sizeof *w->s);
    (void)choose_free(w, p);
    for (bool again = true; again;) {
        if (!solve_free(w, mu)) {
            return false;
        }
        again = false;
        for (int j = 0; j < w->e->n; j++) {
            const double low = q->lower[j] - p->t[j];
            const double high = q->upper[j] - p->t[j];
            if (w->free[j] && (w->s[j] < low || w->s[j] > high)) {
                w->s[j] = w->s[j] < low ? low : high;
                w->free[j] = false;
                again = true;
            }
        }
    }
    return true;
}

/* Evaluate at p + s; the gain ratio, or -1 where there is no value. */
static double try_step(lsq *w, const mt_nlp_point *p, mt_nlp_point *trial)
{
    for (int j = 0; j < w->e->n; j++) {
        w->x[j] = p->t[j] + w->s[j];
    }
    if (!mt_nlp_evaluate(w->e, w->x, true, trial)) {
        return -1;
    }
    memcpy(w->b, w->R, (size_t)w->m * sizeof *w->b);
    mt_gemv(false, w->m, w->e->n, 1.0, w->J, w->m, w->s, 1.0, w->b);
    /* |R|^2/2 - |R + J s|^2/2 */
    const double model = 0.5 * (mt_dot(w->m, w->R, w->R) - mt_dot(w->m, w->b, w->b));
    const double actual = half_squares(w, p) - half_squares(w, trial);
    return model > 0 ? actual / model : -1;
}

/* mu after a step with this gain ratio. */
static double next_mu(double mu, double gain)
{
    return fmax(MU_LEAST, gain > GAIN_GOOD ? mu / 100 : (gain > 0.25 ? mu / 4 : mu * 2));
}

static void iterate_least_squares(lsq *w, mt_nlp_point *p, mt_nlp_point *a, mt_nlp_point *b)
{
    mt_nlp_point *cur = a;
    mt_nlp_point *trial = b;
    mt_nlp_point_copy(w->e, cur, p);
    linearise(w, cur);
    double scale = choose_free(w, cur);
    double mu = MU_FIRST;
    double grow = 2;
    int rejected = 0;
    int stagnant = 0;
    for (int it = 0; it < ITERATIONS && stagnant < STAGNATIONS && scale > 0; it++) {
        const double before = half_squares(w, cur);
        if (sqrt(2 * before) <= R_EXACT || !bounded_step(w, cur, mu * scale * scale)) {
            break;
        }
        const double gain = try_step(w, cur, trial);
        if (gain > GAIN_ACCEPT && half_squares(w, trial) < before) {
            mt_nlp_point_swap(&cur, &trial);
            linearise(w, cur);
            scale = choose_free(w, cur);
            const double less = before - half_squares(w, cur);
            if (is_least(w, cur, less, rejected > 0 ? SHORT * scale : 0.0)) {
                break;
            }
            stagnant += less <= STAGNATION * before;
            mu = next_mu(mu, gain);
            grow = 2;
            rejected = 0;
            continue;
        }
        const bool exact = w->stage == MT_NLP_SQUARES && cur->violation <= VIOLATION_EXACT;
        if (w->e->ended || ++rejected > (exact ? REJECTIONS_EXACT : REJECTIONS)) {
            break;
        }
        mu = fmax(mu * grow, MU_FIRST * 1e-6);
        grow *= 2;
    }
    mt_nlp_point_copy(w->e, p, cur);
}

void mt_nlp_least_squares(mt_nlp_engine *e, mt_nlp_stage stage, mt_nlp_point *p)
{
    const mt_nlp *const q = e->nlp;
    mt_arena *const mem = &e->scratch;
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    const int rows = stage == MT_NLP_RESIDUALS ? q->n_res : q->n_eq + q->n_in;
    const size_t n = (size_t)e->n;
    const size_t m = (size_t)rows;
    lsq w = {.e = e,
             .stage = stage,
             .m = rows,
             .R = mt_arena_f64(mem, m, 1),
             .J = mt_arena_f64(mem, m, n),
             .s = mt_arena_f64(mem, n, 1),
             .A = mt_arena_f64(mem, m + n, n),
             .b = mt_arena_f64(mem, m + n, 1),
             .x = mt_arena_f64(mem, n, 1),
             .free = mt_arena_alloc(mem, n, sizeof *w.free),
             .index = mt_arena_int(mem, n)};
    mt_nlp_point *const a = mt_nlp_point_new(e, mem);
    mt_nlp_point *const b = mt_nlp_point_new(e, mem);
    if (rows > 0 && e->n > 0 && mt_nlp_has_room(e, mem)) {
        iterate_least_squares(&w, p, a, b);
    }
    mt_arena_rewind(mem, mark);
}
