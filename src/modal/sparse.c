/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * One matrix is factored, H = K + s M + A^T Gamma A, Gamma = diag(gamma): that is what becomes
 * of [K + s M, A^T; A, -Gamma^-1] when its last rows are eliminated, and the iteration
 *     dx = H^-1 (f - (K + s M) x - A^T mu - A^T Gamma A x),   dmu = Gamma A (x + dx)
 * solves (K + s M) x + A^T mu = f, A x = 0 (augmented Lagrangian; Hestenes 1969). It refines
 * what rounding did to the factor as well. Rows of A that depend on others change nothing.
 *     Residuals are taken from strains: K x = sum k b (b^T x). A strain's rounding is delta =
 * eps |b|^T |x|, and as b^T H^-1 b <= 1/k, what all of them make of the energy's norm of x is
 * at most N = (sum k delta^2)^(1/2): with E = x^T K x the quotient is off by 2 N E^(-1/2). That
 * is the whole of the condition of K as it is felt by one mode.
 *     H - (tau + s) M has no fewer negative eigenvalues than there are modes below tau: if it
 * has as many as were found, none is missing.
 */
#include "modal/sparse.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/format.h"
#include "linalg/dense.h"
#include "linalg/kernels.h"

/* gamma over the largest stiffness: a constraint's own flexibility is gone after two or three
 * iterations (of loops of thousands with the second), and eps gamma cond K is well below 1. */
static const double STIFFER[] = {1e6, 1e8};
/* Relative pivots: below the first a matrix is singular; below the second the sign of one is
 * by chance. */
static const double REGULAR = 1e-15;
static const double CERTAIN = 64.0 * DBL_EPSILON;
/* Below this the factor's rounding is refined away in each product. */
static const double WELL = 1e-7;
/* The first shift, in the largest K_ii/M_ii; and the least and most that it should be of the
 * lowest mode: far above it the modes stand close together in what is iterated, and below it a
 * rigid-body mode's rounding there is large against all that the others are. */
static const double FIRST_SHIFT = 1e-8;
static const double MOST_SHIFT = 100.0;
static const double LEAST_SHIFT = 0.25;
/* Steps of a solution: most of them, and when it is one. */
enum { MOST_STEPS = 30, SHIFTS = 2, ROUNDS = 4 };
static const double SOLVED = 1e-16;
/* A factor that leaves more than this of a solution is not that of its matrix: where that is
 * singular but for rounding, no step comes nearer. */
static const double SOUND = 1e-6;
static const double GOLDEN = 0.61803398874989485;
/* Roundings of a strain, and strains so many times their rounding that are none. */
static const double STRAIN_ULPS = 4.0;
static const double RIGID = 1e3;
/* Of everything else in a quotient. */
static const double OTHER_ULPS = 64.0;
/* Squares of singular values of A, in scaled rows, below this are 0. */
static const double DEPENDENT = 1e-9;

typedef struct sparse {
    const mt_sparse_problem *p;
    double shift;
    double *gamma;      /* [rows of A] */
    double stiffer;     /* one of STIFFER */
    double stiffest;    /* that times the largest stiffness */
    mt_rows columns[3]; /* of K's, M's and A's rows: by state, (row, value) */
    mt_lower h;         /* pattern of all, values of what is factored */
    double *k;          /* values in that pattern: K + A^T Gamma A */
    double *m;
    mt_factor held;            /* H */
    mt_factor count;           /* of counts */
    int freedoms;              /* states less independent rows of A */
    bool refined;              /* is a product refined? */
    bool sound;                /* was the last step of a solution a small part of it? */
    double *x, *f, *r, *s, *w; /* [n] */
    double *mu;                /* [rows of A] */
    double *gap;               /* A x + A dx */
    mt_arena *mem;
} sparse;

/* One column of the lower triangles that is being summed. */
typedef struct column {
    int n;
    int *list; /* [n] rows that were met */
    int *mark; /* of each row: last column that met it, and 1 */
    double *k;
    double *m;
} column;

static void meet(column *c, int i, int j)
{
    if (c->mark[i] != j + 1) {
        c->mark[i] = j + 1;
        c->list[c->n++] = i;
        c->k[i] = 0.0;
        c->m[i] = 0.0;
    }
}

static void add_squares(column *c, const mt_rows *rows, const double *weight,
                        const mt_rows *columns, int j, double *sum)
{
    for (int t = columns->start[j]; t < columns->start[j + 1]; t++) {
        const int r = columns->index[t];
        const double part = weight[r] * columns->value[t];
        for (int q = rows->start[r]; q < rows->start[r + 1]; q++) {
            const int i = rows->index[q];
            if (i >= j) {
                meet(c, i, j);
                sum[i] += part * rows->value[q];
            }
        }
    }
}

static void sum_column(const sparse *s, int j, column *c)
{
    const mt_sparse_problem *const p = s->p;
    c->n = 0;
    meet(c, j, j);
    add_squares(c, &p->k.row, p->k.c, &s->columns[0], j, c->k);
    add_squares(c, &p->m.row, p->m.c, &s->columns[1], j, c->m);
    add_squares(c, &p->a, s->gamma, &s->columns[2], j, c->k);
    for (int q = p->g != NULL ? p->g->start[j] : 0; p->g != NULL && q < p->g->start[j + 1];
         q++) {
        meet(c, p->g->row[q], j);
        c->k[p->g->row[q]] += p->g->value[q];
    }
}

static int ascending(const void *a, const void *b)
{
    const int x = *(const int *)a;
    const int y = *(const int *)b;
    return (x > y) - (x < y);
}

/* The pattern of all, and in it K + A^T Gamma A and M. */
static mt_status assemble(sparse *s, mt_err *err)
{
    const mt_sparse_problem *const p = s->p;
    const size_t n = (size_t)p->n;
    column c = {.list = mt_arena_int(s->mem, n), .mark = mt_arena_int(s->mem, n)};
    c.k = mt_arena_f64(s->mem, n, 1);
    c.m = mt_arena_f64(s->mem, n, 1);
    s->h = (mt_lower){.n = p->n, .start = mt_arena_int(s->mem, n + 1)};
    MT_TRY(mt_arena_check(s->mem, err));
    double size = 0.0;
    for (int j = 0; j < p->n; j++) {
        sum_column(s, j, &c);
        size += c.n;
        if (size > INT_MAX) {
            return mt_fail_memory(err);
        }
        s->h.start[j + 1] = s->h.start[j] + c.n;
    }
    const size_t all = (size_t)s->h.start[p->n];
    s->h.row = mt_arena_int(s->mem, all);
    s->h.value = mt_arena_f64(s->mem, all, 1);
    s->k = mt_arena_f64(s->mem, all, 1);
    s->m = mt_arena_f64(s->mem, all, 1);
    MT_TRY(mt_arena_check(s->mem, err));
    memset(c.mark, 0, n * sizeof *c.mark);
    for (int j = 0; j < p->n; j++) {
        const int first = s->h.start[j];
        sum_column(s, j, &c);
        qsort(c.list, (size_t)c.n, sizeof *c.list, ascending);
        for (int q = 0; q < c.n; q++) {
            s->h.row[first + q] = c.list[q];
            s->k[first + q] = c.k[c.list[q]];
            s->m[first + q] = c.m[c.list[q]];
        }
    }
    return MT_OK;
}

/* y := M x. */
static void metric(void *context, const double *x, double *y)
{
    const sparse *const s = context;
    memset(y, 0, (size_t)s->p->n * sizeof *y);
    for (int j = 0; j < s->p->n; j++) {
        const int first = s->h.start[j];
        double sum = s->m[first] * x[j]; /* the diagonal comes first */
        for (int q = first + 1; q < s->h.start[j + 1]; q++) {
            y[s->h.row[q]] += s->m[q] * x[j];
            sum += s->m[q] * x[s->h.row[q]];
        }
        y[j] += sum;
    }
}

/* y -= K x, strain by strain. */
static void subtract_force(const sparse *s, const double *x, double *y)
{
    const mt_sparse_problem *const p = s->p;
    for (int r = 0; r < p->k.row.n_rows; r++) {
        mt_rows_axpy(&p->k.row, r, -p->k.c[r] * mt_rows_dot(&p->k.row, r, x), y);
    }
    for (int j = 0; p->g != NULL && j < p->n; j++) {
        for (int q = p->g->start[j]; q < p->g->start[j + 1]; q++) {
            const int i = p->g->row[q];
            y[i] -= p->g->value[q] * x[j];
            y[j] -= i == j ? 0.0 : p->g->value[q] * x[i];
        }
    }
}

/* x, s->mu with (K + s M) x + A^T mu = f, A x = 0, to a part `close` of its energy, or as close
 * as rounding lets it come. */
static mt_status solve(sparse *s, const double *f, double close, double *x, mt_err *err)
{
    const mt_sparse_problem *const p = s->p;
    const size_t size = (size_t)p->n * sizeof *x;
    double before = HUGE_VAL;
    memset(x, 0, size);
    memset(s->mu, 0, (size_t)p->a.n_rows * sizeof *s->mu);
    for (int step = 0; step < MOST_STEPS; step++) {
        MT_TRY(p->check != NULL ? p->check(p->context, err) : MT_OK);
        memcpy(s->r, f, size);
        if (step > 0) {
            metric(s, x, s->w);
            mt_axpy(p->n, -s->shift, s->w, s->r);
            subtract_force(s, x, s->r);
        }
        for (int r = 0; r < p->a.n_rows; r++) {
            s->gap[r] = step > 0 ? mt_rows_dot(&p->a, r, x) : 0.0;
            mt_rows_axpy(&p->a, r, -s->mu[r] - (s->gamma[r] * s->gap[r]), s->r);
        }
        memcpy(s->s, s->r, size);
        mt_factor_solve(&s->held, s->s);
        const double change = sqrt(fmax(mt_dot(p->n, s->s, s->r), 0.0));
        const double whole = sqrt(fmax(mt_dot(p->n, x, f), 0.0));
        s->sound = step > 0 && change <= SOUND * whole;
        if (step > 1 && !(change < 0.5 * before)) {
            return MT_OK; /* what is left is rounding */
        }
        before = change;
        mt_axpy(p->n, 1.0, s->s, x);
        for (int r = 0; r < p->a.n_rows; r++) {
            s->mu[r] += s->gamma[r] * (s->gap[r] + mt_rows_dot(&p->a, r, s->s));
        }
        if ((step > 0 && change <= close * whole) || !isfinite(change)) {
            return MT_OK;
        }
    }
    return MT_OK;
}

static mt_status apply(void *context, const double *x, double *y, mt_err *err)
{
    sparse *const s = context;
    metric(s, x, s->f);
    if (s->refined) {
        return solve(s, s->f, SOLVED, y, err);
    }
    MT_TRY(s->p->check != NULL ? s->p->check(s->p->context, err) : MT_OK);
    memcpy(y, s->f, (size_t)s->p->n * sizeof *y);
    mt_factor_solve(&s->held, y);
    return MT_OK;
}

/* A sum of squares at x, and of the squares of its strains' roundings. */
static double energy(const mt_squares *of, const double *x, double *noise)
{
    double sum = 0.0;
    *noise = 0.0;
    for (int r = 0; r < of->row.n_rows; r++) {
        double strain = 0.0;
        double size = 0.0;
        for (int q = of->row.start[r]; q < of->row.start[r + 1]; q++) {
            const double part = of->row.value[q] * x[of->row.index[q]];
            strain += part;
            size += fabs(part);
        }
        const double delta = STRAIN_ULPS * DBL_EPSILON * size;
        sum += of->c[r] * strain * strain;
        *noise += fabs(of->c[r]) * delta * delta;
    }
    return sum;
}

static mt_status refine(void *context, const double *x, double *y, mt_lowest_quotient *q,
                        mt_err *err)
{
    sparse *const s = context;
    const mt_sparse_problem *const p = s->p;
    double k_noise = 0.0;
    double m_noise = 0.0;
    metric(s, x, s->f);
    MT_TRY(solve(s, s->f, SOLVED, y, err));
    double k = energy(&p->k, y, &k_noise);
    const double m = energy(&p->m, y, &m_noise);
    double other = 0.0;
    for (int j = 0; p->g != NULL && j < p->n; j++) {
        for (int i = p->g->start[j]; i < p->g->start[j + 1]; i++) {
            const double twice = p->g->row[i] == j ? 1.0 : 2.0;
            const double part = twice * p->g->value[i] * y[j] * y[p->g->row[i]];
            k += part;
            other += STRAIN_ULPS * DBL_EPSILON * fabs(part);
        }
    }
    /* what y leaves open of the constraints, their forces pay for */
    for (int r = 0; r < p->a.n_rows; r++) {
        double gap = 0.0;
        double size = 0.0;
        for (int i = p->a.start[r]; i < p->a.start[r + 1]; i++) {
            const double part = p->a.value[i] * y[p->a.index[i]];
            gap += part;
            size += fabs(part);
        }
        k += 2.0 * s->mu[r] * gap;
        other += 2.0 * fabs(s->mu[r]) * STRAIN_ULPS * DBL_EPSILON * size;
    }
    q->lambda = k / m;
    q->rigid = fabs(k) <= RIGID * ((RIGID * k_noise) + other) ||
               fabs(q->lambda) <= DBL_EPSILON * s->shift;
    const double size = fmax(fabs(k), DBL_MIN);
    q->noise = (2.0 * sqrt(k_noise / size)) + ((k_noise + other) / size) +
               (2.0 * sqrt(m_noise / m)) + (OTHER_ULPS * DBL_EPSILON);
    return MT_OK;
}

/* values of K + A^T Gamma A + c M into the pattern. */
static void combine(const sparse *s, double c)
{
    for (int q = 0; q < s->h.start[s->h.n]; q++) {
        s->h.value[q] = s->k[q] + (c * s->m[q]);
    }
}

static mt_status below(void *context, double tau, int *n, bool *certain, mt_err *err)
{
    sparse *const s = context;
    MT_TRY(s->p->check != NULL ? s->p->check(s->p->context, err) : MT_OK);
    combine(s, -tau);
    const mt_status rc = mt_factor_make(&s->count, &s->h, s->mem, NULL);
    *n = s->count.negative;
    *certain = rc == MT_OK && s->count.least > CERTAIN;
    return rc == MT_E_DOMAIN ? MT_OK : (rc == MT_OK ? MT_OK : mt_fail(err, rc, "count"));
}

/* H with this shift; *sound: positive, and it solves. */
static mt_status factor(sparse *s, double shift, bool *sound, mt_err *err)
{
    s->shift = shift;
    combine(s, shift);
    const mt_status rc = mt_factor_make(&s->held, &s->h, s->mem, NULL);
    *sound = rc == MT_OK && s->held.negative == 0 && s->held.least > REGULAR;
    if (rc != MT_OK && rc != MT_E_DOMAIN) {
        return mt_fail(err, rc, "factor");
    }
    if (*sound) { /* some motion of everything */
        for (int j = 0; j < s->p->n; j++) {
            s->x[j] = (1.0 + fmod(GOLDEN * (j + 1), 1.0)) * s->p->unit[j];
        }
        metric(s, s->x, s->f);
        MT_TRY(solve(s, s->f, SOLVED, s->x, err));
        *sound = s->sound;
    }
    return MT_OK;
}

/* Constraints in units of the largest stiffness: gamma[rows of A]. */
static void scale_constraints(sparse *s)
{
    const mt_sparse_problem *const p = s->p;
    double most = 0.0;
    memset(s->x, 0, (size_t)p->n * sizeof *s->x);
    for (int r = 0; r < p->k.row.n_rows; r++) {
        for (int q = p->k.row.start[r]; q < p->k.row.start[r + 1]; q++) {
            s->x[p->k.row.index[q]] += fabs(p->k.c[r]) * p->k.row.value[q] * p->k.row.value[q];
        }
    }
    for (int j = 0; p->g != NULL && j < p->n; j++) {
        for (int q = p->g->start[j]; q < p->g->start[j + 1]; q++) {
            s->x[j] += p->g->row[q] == j ? fabs(p->g->value[q]) : 0.0;
        }
    }
    for (int j = 0; j < p->n; j++) {
        most = fmax(most, s->x[j] * p->unit[j] * p->unit[j]);
    }
    s->stiffest = s->stiffer * most;
    for (int r = 0; r < p->a.n_rows; r++) {
        double square = 0.0;
        for (int q = p->a.start[r]; q < p->a.start[r + 1]; q++) {
            const double part = p->a.value[q] * p->unit[p->a.index[q]];
            square += part * part;
        }
        s->gamma[r] = square > 0.0 ? s->stiffest / square : 0.0;
    }
}

/* Freedoms: states less independent rows of A. */
static mt_status count_freedoms(sparse *s, mt_err *err)
{
    s->freedoms = s->p->n;
    if (s->p->a.n_rows == 0) {
        return MT_OK;
    }
    /* D A^T A D - c I has one positive eigenvalue for each */
    column c = {.list = mt_arena_int(s->mem, (size_t)s->p->n),
                .mark = mt_arena_int(s->mem, (size_t)s->p->n)};
    c.k = mt_arena_f64(s->mem, (size_t)s->p->n, 1);
    c.m = mt_arena_f64(s->mem, (size_t)s->p->n, 1);
    MT_TRY(mt_arena_check(s->mem, err));
    for (int j = 0; j < s->p->n; j++) {
        c.n = 0;
        add_squares(&c, &s->p->a, s->gamma, &s->columns[2], j, c.k);
        for (int q = s->h.start[j]; q < s->h.start[j + 1]; q++) {
            const int i = s->h.row[q];
            const double sum = c.mark[i] == j + 1 ? c.k[i] : 0.0;
            s->h.value[q] = sum * s->p->unit[i] * s->p->unit[j] / s->stiffest;
            s->h.value[q] -= i == j ? DEPENDENT : 0.0;
        }
    }
    const mt_status rc = mt_factor_make(&s->count, &s->h, s->mem, NULL);
    s->freedoms = s->count.negative;
    return rc == MT_OK || rc == MT_E_DOMAIN ? MT_OK : mt_fail(err, rc, "rank");
}

/* The largest K_ii/M_ii. */
static double highest(const sparse *s)
{
    double most = 0.0;
    for (int j = 0; j < s->p->n; j++) {
        const double m = s->m[s->h.start[j]];
        most = m > 0.0 ? fmax(most, s->x[j] / m) : most;
    }
    return most;
}

/* H, with a shift where K alone may be singular. */
static mt_status hold(sparse *s, bool *held, char *why, mt_err *err)
{
    double shift = FIRST_SHIFT * highest(s);
    *held = s->stiffest > 0.0;
    if (!*held) {
        (void)mt_snprintf(why, MT_SPARSE_WHY, "nothing in it has a stiffness");
        return MT_OK;
    }
    MT_TRY(factor(s, 0.0, held, err));
    for (int i = 0; i < SHIFTS && !*held && shift > 0.0; i++) {
        MT_TRY(factor(s, shift, held, err));
        shift *= 100.0;
    }
    if (!*held) {
        (void)mt_snprintf(why, MT_SPARSE_WHY,
                          "a motion without stiffness has no mass, it is not stable, or "
                          "sixteen digits do not hold all of its motions");
    }
    return MT_OK;
}

/* The first mode that is no rigid-body one; 0: none. */
static double first_lambda(const mt_modes *m)
{
    return m->n_rigid < m->count ? m->lambda[m->n_rigid] : 0.0;
}

static mt_status find(sparse *s, mt_arena *mem, mt_lowest_modes *out, bool *stable, mt_err *err)
{
    const mt_sparse_problem *const p = s->p;
    for (int round = 0;; round++) {
        const mt_arena_mark mark = mt_arena_get_mark(mem);
        const mt_lowest_problem problem = {.n = p->n,
                                           .most = s->freedoms,
                                           .count = p->count,
                                           .shift = s->shift,
                                           .apply = apply,
                                           .metric = metric,
                                           .refine = refine,
                                           .below = below,
                                           .context = s};
        s->refined = p->a.n_rows > 0 || s->held.least < WELL;
        MT_TRY(mt_modal_lowest(&problem, mem, out, err));
        const double first = first_lambda(&out->modes);
        *stable = first >= 0.0;
        const bool apart = s->shift > MOST_SHIFT * first || s->shift < LEAST_SHIFT * first;
        if (round == ROUNDS || s->shift == 0.0 || !(first > 0.0 && apart)) {
            return MT_OK;
        }
        const double was = s->shift;
        bool sound = false;
        MT_TRY(factor(s, first, &sound, err));
        if (!sound) {
            return factor(s, was, &sound, err);
        }
        mt_arena_rewind(mem, mark);
    }
}

static mt_status prepare(sparse *s, mt_err *err)
{
    const mt_sparse_problem *const p = s->p;
    const size_t n = (size_t)p->n;
    const size_t m = (size_t)p->a.n_rows;
    double **const vectors[] = {&s->x, &s->f, &s->r, &s->s, &s->w};
    for (int i = 0; i < MT_COUNT(vectors); i++) {
        *vectors[i] = mt_arena_f64(s->mem, n, 1);
    }
    s->gamma = mt_arena_f64(s->mem, m, 1);
    s->mu = mt_arena_f64(s->mem, m, 1);
    s->gap = mt_arena_f64(s->mem, m, 1);
    mt_rows_transpose(&p->k.row, p->n, s->mem, &s->columns[0]);
    mt_rows_transpose(&p->m.row, p->n, s->mem, &s->columns[1]);
    mt_rows_transpose(&p->a, p->n, s->mem, &s->columns[2]);
    MT_TRY(mt_arena_check(s->mem, err));
    scale_constraints(s);
    MT_TRY(assemble(s, err));
    mt_factor_pattern *pattern = NULL;
    MT_TRY(mt_factor_analyse(&s->h, s->mem, &pattern, err));
    mt_factor_init(pattern, s->mem, &s->held);
    mt_factor_init(pattern, s->mem, &s->count);
    return mt_arena_check(s->mem, err);
}

/* v := v Q, n x count. */
static void turn(int n, int count, const double *q, double *v, double *row)
{
    for (ptrdiff_t i = 0; i < n; i++) {
        for (int k = 0; k < count; k++) {
            row[k] = v[i + ((ptrdiff_t)n * k)];
        }
        for (int k = 0; k < count; k++) {
            v[i + ((ptrdiff_t)n * k)] = mt_dot(count, row, q + ((ptrdiff_t)count * k));
        }
    }
}

/* One more step of inverse iteration, (K + s M) Y + A^T N = M X, and among the vibration modes
 * the Ritz vectors: of X^T M Y, X being orthonormal. x := y, mu := nu, both over the size of
 * y. */
static mt_status shape(sparse *s, mt_arena *mem, const mt_lowest_modes *out, double **mu,
                       mt_err *err)
{
    const int n = s->p->n;
    const int rows = s->p->a.n_rows;
    const int first = out->modes.n_rigid;
    const int count = out->modes.count - first;
    double *const x = out->x + ((ptrdiff_t)n * first);
    double *const y = mt_arena_f64(s->mem, (size_t)n, (size_t)count);
    double *const h = mt_arena_f64(s->mem, (size_t)count, (size_t)count);
    double *const theta = mt_arena_f64(s->mem, (size_t)count, 1);
    *mu = mt_arena_f64(mem, (size_t)rows, (size_t)out->modes.count);
    double *const force = *mu + ((ptrdiff_t)rows * first);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_arena_check(s->mem, err));
    for (int i = 0; i < count; i++) {
        double *const to = y + ((ptrdiff_t)n * i);
        metric(s, x + ((ptrdiff_t)n * i), s->f);
        MT_TRY(solve(s, s->f, SOLVED, to, err));
        memcpy(force + ((ptrdiff_t)rows * i), s->mu, (size_t)rows * sizeof *force);
        metric(s, to, s->f);
        for (int k = 0; k < count; k++) {
            h[k + ((ptrdiff_t)count * i)] = -mt_dot(n, x + ((ptrdiff_t)n * k), s->f);
        }
    }
    MT_TRY(mt_eig_sym(count, h, theta, true, s->mem, err)); /* of -A: lowest modes first */
    turn(n, count, h, y, theta);
    turn(rows, count, h, force, theta);
    for (int i = 0; i < count; i++) {
        double *const from = y + ((ptrdiff_t)n * i);
        metric(s, from, s->f);
        const double size = sqrt(mt_dot(n, from, s->f));
        for (int j = 0; j < n; j++) {
            x[j + ((ptrdiff_t)n * i)] = from[j] / size;
        }
        for (int j = 0; j < rows; j++) {
            force[j + ((ptrdiff_t)rows * i)] /= size;
        }
    }
    return MT_OK;
}

mt_status mt_modal_sparse(const mt_sparse_problem *p, mt_arena *mem, mt_lowest_modes *out,
                          double **mu, bool *answered, char why[MT_SPARSE_WHY], mt_err *err)
{
    mt_arena work = {.first = NULL};
    sparse s = {.p = p};
    *answered = false;
    *mu = NULL;
    *out = (mt_lowest_modes){.below = 0};
    mt_status rc = mt_arena_init(&work, 0, err);
    for (int i = 0; i < MT_COUNT(STIFFER) && rc == MT_OK && !*answered; i++) {
        mt_arena_clear(&work);
        s = (sparse){.p = p, .mem = &work, .stiffer = STIFFER[i]};
        rc = prepare(&s, err);
        rc = rc == MT_OK ? hold(&s, answered, why, err) : rc;
    }
    rc = rc == MT_OK && *answered ? count_freedoms(&s, err) : rc;
    if (rc == MT_OK && *answered) {
        rc = find(&s, mem, out, answered, err);
        if (!*answered) {
            (void)mt_snprintf(why, MT_SPARSE_WHY, "it is not stable");
        }
        rc = rc == MT_OK && *answered && p->shapes ? shape(&s, mem, out, mu, err) : rc;
    }
    mt_arena_free(&work);
    return rc;
}
