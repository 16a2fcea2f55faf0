/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Assembles and factors H, and solves with it: the iteration is derived in sparse.c. */
#include "modal/sparse_priv.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "linalg/kernels.h"

/* Relative pivots: below this a matrix is singular. */
static const double REGULAR = 1e-15;
/* Steps of a solution, at most. */
enum { MOST_STEPS = 30 };
/* A factor that leaves more than this of a solution is not that of its matrix: where that is
 * singular but for rounding, no step comes nearer. */
static const double SOUND = 1e-6;
static const double GOLDEN = 0.61803398874989485;
/* Squares of singular values of A, in scaled rows, below this are 0. */
static const double DEPENDENT = 1e-9;

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

static void sum_column(const mt_sparse *s, int j, column *c)
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
static mt_status assemble(mt_sparse *s, mt_err *err)
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
void mt_sparse_metric(void *context, const double *x, double *y)
{
    const mt_sparse *const s = context;
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
static void subtract_force(const mt_sparse *s, const double *x, double *y)
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
mt_status mt_sparse_solve(mt_sparse *s, const double *f, double close, double *x, mt_err *err)
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
            mt_sparse_metric(s, x, s->w);
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

/* values of K + A^T Gamma A + c M into the pattern. */
void mt_sparse_combine(const mt_sparse *s, double c)
{
    for (int q = 0; q < s->h.start[s->h.n]; q++) {
        s->h.value[q] = s->k[q] + (c * s->m[q]);
    }
}

/* H with this shift; *sound: positive, and it solves. */
mt_status mt_sparse_factor(mt_sparse *s, double shift, bool *sound, mt_err *err)
{
    s->shift = shift;
    mt_sparse_combine(s, shift);
    const mt_status rc = mt_factor_make(&s->held, &s->h, s->mem, NULL);
    *sound = rc == MT_OK && s->held.negative == 0 && s->held.least > REGULAR;
    if (rc != MT_OK && rc != MT_E_DOMAIN) {
        return mt_fail(err, rc, "factor");
    }
    if (*sound) { /* some motion of everything */
        for (int j = 0; j < s->p->n; j++) {
            s->x[j] = (1.0 + fmod(GOLDEN * (j + 1), 1.0)) * s->p->unit[j];
        }
        mt_sparse_metric(s, s->x, s->f);
        MT_TRY(mt_sparse_solve(s, s->f, MT_SPARSE_SOLVED, s->x, err));
        *sound = s->sound;
    }
    return MT_OK;
}

/* Constraints in units of the largest stiffness: gamma[rows of A]. */
static void scale_constraints(mt_sparse *s)
{
    const mt_sparse_problem *const p = s->p;
    double most = 0.0;
    memset(s->x, 0, (size_t)p->n * sizeof *s->x);
    for (int r = 0; r < p->k.row.n_rows; r++) {
        for (int q = p->k.row.start[r]; q < p->k.row.start[r + 1]; q++) {
            s->x[p->k.row.index[q]] += fabs(p->k.c[r]) * p->k.row.value[q] * p->k.row.value[q];
        }
    }
    /* what may be negative the constraints have to outweigh in each state that they hold */
    for (int r = 0; r < p->a.n_rows; r++) {
        double square = 0.0;
        for (int q = p->a.start[r]; q < p->a.start[r + 1]; q++) {
            const double part = p->a.value[q] * p->unit[p->a.index[q]];
            square += part * part;
        }
        s->gamma[r] = square;
        for (int q = p->a.start[r]; q < p->a.start[r + 1] && square > 0.0; q++) {
            s->f[p->a.index[q]] += p->a.value[q] * p->a.value[q] / square;
        }
    }
    for (int j = 0; p->g != NULL && j < p->n; j++) {
        for (int q = p->g->start[j]; q < p->g->start[j + 1]; q++) {
            const double here = p->g->row[q] == j ? fabs(p->g->value[q]) : 0.0;
            s->x[j] += here;
            most = s->outweigh && s->f[j] > 0.0 ? fmax(most, here / s->f[j]) : most;
        }
    }
    for (int j = 0; j < p->n; j++) {
        most = fmax(most, s->x[j] * p->unit[j] * p->unit[j]);
    }
    s->stiffest = s->stiffer * most;
    for (int r = 0; r < p->a.n_rows; r++) {
        s->gamma[r] = s->gamma[r] > 0.0 ? s->stiffest / s->gamma[r] : 0.0;
    }
}

/* Freedoms: states less independent rows of A. */
mt_status mt_sparse_freedoms(mt_sparse *s, mt_err *err)
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

mt_status mt_sparse_prepare(mt_sparse *s, mt_err *err)
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
