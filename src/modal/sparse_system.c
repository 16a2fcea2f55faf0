/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Assembles and factors H, and solves with it: the iteration is derived in sparse.c. */
#include "modal/sparse_priv.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "linalg/dense.h"

/* Relative pivots: below this a matrix is singular. */
static const double REGULAR = 1e-15;
/* Steps of a solution, at most. */
enum { MOST_STEPS = 30 };
/* A factor that leaves more than this of a solution is not that of its matrix: where that is
 * singular but for rounding, no step comes nearer. */
static const double SOUND = 1e-6;
static const double GOLDEN = 0.61803398874989485;
/* Squares of singular values of A, in scaled rows, are 0 below what rounding makes of 0: so
 * many roundings of the largest, more by RAISED each time that a pivot's sign may be chance, up
 * to DEPENDENT. */
static const double RANK_ULPS = 64.0;
static const double RAISED = 8.0;
static const double DEPENDENT = 1e-9;

/* One column of a lower triangle that is being summed. */
typedef struct column {
    int n;
    int *list; /* [n] rows that were met */
    int *mark; /* of each row: last column that met it, and 1 */
    double *sum;
} column;

static mt_status column_init(column *c, int n, mt_arena *mem, mt_err *err)
{
    *c = (column){.list = mt_arena_int(mem, (size_t)n), .mark = mt_arena_int(mem, (size_t)n)};
    c->sum = mt_arena_f64(mem, (size_t)n, 1);
    return mt_arena_check(mem, err);
}

static void clear_column(column *c)
{
    c->n = 0;
}

static void add_to_column(column *c, int i, int j, double value)
{
    if (c->mark[i] != j + 1) {
        c->mark[i] = j + 1;
        c->list[c->n++] = i;
        c->sum[i] = 0.0;
    }
    c->sum[i] += value;
}

static void add_squares(column *c, const mt_rows *rows, const double *weight,
                        const mt_rows *columns, int j, double scale)
{
    for (int t = columns->start[j]; t < columns->start[j + 1]; t++) {
        const int r = columns->index[t];
        const double part = scale * weight[r] * columns->value[t];
        for (int q = rows->start[r]; q < rows->start[r + 1]; q++) {
            const int i = rows->index[q];
            if (i >= j) {
                add_to_column(c, i, j, part * rows->value[q]);
            }
        }
    }
}

/* What is summed, by states. */
typedef struct sums {
    const mt_sparse *s;
    mt_rows k;
    mt_rows m;
    double part; /* of Gamma */
} sums;

static void sum_mass(const sums *from, int j, column *c)
{
    clear_column(c);
    add_to_column(c, j, j, 0.0);
    add_squares(c, &from->s->p->m.row, from->s->p->m.c, &from->m, j, 1.0);
}

/* Places of M are there, too. */
static void sum_stiffness(const sums *from, int j, column *c)
{
    const mt_sparse *const s = from->s;
    const mt_sparse_problem *const p = s->p;
    const mt_lower *const g = p->g;
    clear_column(c);
    for (int q = s->m.start[j]; q < s->m.start[j + 1]; q++) {
        add_to_column(c, s->m.row[q], j, 0.0);
    }
    add_squares(c, &p->k.row, p->k.c, &from->k, j, 1.0);
    add_squares(c, &p->a, s->gamma, &s->by_state, j, from->part);
    for (int q = g != NULL ? g->start[j] : 0; g != NULL && q < g->start[j + 1]; q++) {
        add_to_column(c, g->row[q], j, g->value[q]);
    }
}

static int ascending(const void *a, const void *b)
{
    const int x = *(const int *)a;
    const int y = *(const int *)b;
    return (x > y) - (x < y);
}

/* Column by column, once for the pattern. */
static mt_status assemble_lower(const sums *from, void (*sum)(const sums *, int, column *),
                                column *c, mt_lower *out, mt_err *err)
{
    const int n = from->s->p->n;
    mt_arena *const mem = from->s->mem;
    double size = 0.0;
    *out = (mt_lower){.n = n, .start = mt_arena_int(mem, (size_t)n + 1)};
    MT_TRY(mt_arena_check(mem, err));
    memset(c->mark, 0, (size_t)n * sizeof *c->mark);
    for (int j = 0; j < n; j++) {
        sum(from, j, c);
        size += c->n;
        if (size > INT_MAX) {
            return mt_fail_memory(err);
        }
        out->start[j + 1] = out->start[j] + c->n;
    }
    out->row = mt_arena_int(mem, (size_t)out->start[n]);
    out->value = mt_arena_f64(mem, (size_t)out->start[n], 1);
    MT_TRY(mt_arena_check(mem, err));
    memset(c->mark, 0, (size_t)n * sizeof *c->mark);
    for (int j = 0; j < n; j++) {
        const int first = out->start[j];
        sum(from, j, c);
        qsort(c->list, (size_t)c->n, sizeof *c->list, ascending);
        for (int q = 0; q < c->n; q++) {
            out->row[first + q] = c->list[q];
            out->value[first + q] = c->sum[c->list[q]];
        }
    }
    return MT_OK;
}

/* M, and K + A^T Gamma A. */
static mt_status assemble_both(mt_sparse *s, mt_arena *scratch, mt_err *err)
{
    const mt_sparse_problem *const p = s->p;
    sums from = {.s = s, .part = 1.0};
    column c;
    mt_rows_transpose(&p->k.row, p->n, scratch, &from.k);
    mt_rows_transpose(&p->m.row, p->n, scratch, &from.m);
    MT_TRY(column_init(&c, p->n, scratch, err));
    MT_TRY(assemble_lower(&from, sum_mass, &c, &s->m, err));
    return assemble_lower(&from, sum_stiffness, &c, &s->k, err);
}

/* y := M x. */
void mt_sparse_metric(void *context, const double *x, double *y)
{
    const mt_lower *const m = &((const mt_sparse *)context)->m;
    memset(y, 0, (size_t)m->n * sizeof *y);
    for (int j = 0; j < m->n; j++) {
        const int first = m->start[j];
        double sum = m->value[first] * x[j]; /* the diagonal comes first */
        for (int q = first + 1; q < m->start[j + 1]; q++) {
            y[m->row[q]] += m->value[q] * x[j];
            sum += m->value[q] * x[m->row[q]];
        }
        y[j] += sum;
    }
}

void mt_sparse_subtract(const mt_sparse *s, const double *x, double *y)
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

/* r := f - (K + s M) x - A^T (mu + Gamma A x), gap := A x; of x = 0 at the first step. */
static void leave(mt_sparse *s, bool first, const double *f, const double *x, const double *mu,
                  double *r, double *gap)
{
    const mt_sparse_problem *const p = s->p;
    memcpy(r, f, (size_t)p->n * sizeof *r);
    if (!first) {
        mt_sparse_metric(s, x, s->w);
        mt_axpy(p->n, -s->shift, s->w, r);
        mt_sparse_subtract(s, x, r);
    }
    for (int i = 0; i < p->a.n_rows; i++) {
        gap[i] = first ? 0.0 : mt_rows_dot(&p->a, i, x);
        mt_rows_axpy(&p->a, i, -mu[i] - (s->gamma[i] * gap[i]), r);
    }
}

/* x += dx, mu += Gamma A (x + dx). */
static void advance(const mt_sparse *s, const double *dx, const double *gap, double *x,
                    double *mu)
{
    const mt_rows *const a = &s->p->a;
    mt_axpy(s->p->n, 1.0, dx, x);
    for (int i = 0; i < a->n_rows; i++) {
        mu[i] += s->gamma[i] * (gap[i] + mt_rows_dot(a, i, dx));
    }
}

/* What of the columns is not done yet. */
typedef struct pending {
    int n;
    int column[MT_SPARSE_COLUMNS];
    double before[MT_SPARSE_COLUMNS]; /* last step, in the energy's norm */
    bool sound[MT_SPARSE_COLUMNS];
} pending;

/* Take the step s->s in the open columns; converged columns are removed from o. */
static void step_all(mt_sparse *s, int step, const double *f, double close, double *x,
                     pending *o)
{
    const ptrdiff_t n = s->p->n;
    const ptrdiff_t rows = s->p->a.n_rows;
    int left = 0;
    for (int i = 0; i < o->n; i++) {
        const int c = o->column[i];
        const double *const dx = s->s + (n * i);
        double *const to = x + (n * c);
        const double change = sqrt(fmax(mt_dot((int)n, dx, s->r + (n * i)), 0.0));
        const double whole = sqrt(fmax(mt_dot((int)n, to, f + (n * c)), 0.0));
        o->sound[c] = step > 0 && change <= SOUND * whole;
        if (step > 1 && !(change < 0.5 * o->before[c])) {
            continue; /* what is left is rounding */
        }
        o->before[c] = change;
        advance(s, dx, s->gap + (rows * i), to, s->mu + (rows * c));
        if (!((step > 0 && change <= close * whole) || !isfinite(change))) {
            o->column[left++] = c;
        }
    }
    o->n = left;
}

mt_status mt_sparse_solve(mt_sparse *s, int count, const double *f, double close, double *x,
                          mt_err *err)
{
    const mt_sparse_problem *const p = s->p;
    const ptrdiff_t n = p->n;
    const ptrdiff_t rows = p->a.n_rows;
    pending o = {.n = count};
    MT_TRY(mt_sparse_hold(s, err));
    memset(x, 0, (size_t)(n * count) * sizeof *x);
    memset(s->mu, 0, (size_t)(rows * count) * sizeof *s->mu);
    for (int c = 0; c < count; c++) {
        o.column[c] = c;
        o.before[c] = HUGE_VAL;
    }
    for (int step = 0; step < MOST_STEPS && o.n > 0; step++) {
        MT_TRY(p->check != NULL ? p->check(p->context, err) : MT_OK);
        for (int i = 0; i < o.n; i++) {
            const int c = o.column[i];
            leave(s, step == 0, f + (n * c), x + (n * c), s->mu + (rows * c), s->r + (n * i),
                  s->gap + (rows * i));
        }
        memcpy(s->s, s->r, (size_t)(n * o.n) * sizeof *s->s);
        mt_factor_solve(&s->factor, o.n, s->s);
        step_all(s, step, f, close, x, &o);
    }
    s->sound = true;
    for (int c = 0; c < count; c++) {
        s->sound = s->sound && o.sound[c];
    }
    return MT_OK;
}

/* *regular: no pivot is 0. */
static mt_status make_factor(mt_sparse *s, const mt_lower *h, double c, const mt_lower *m,
                             bool *regular, mt_err *err)
{
    const mt_status rc = mt_factor_make(&s->factor, h, c, m, s->mem, NULL);
    s->holds = false;
    *regular = rc == MT_OK;
    return rc == MT_OK || rc == MT_E_DOMAIN ? MT_OK : mt_fail(err, rc, "factor");
}

mt_status mt_sparse_hold(mt_sparse *s, mt_err *err)
{
    if (!s->holds) {
        MT_TRY(make_factor(s, &s->k, s->shift, &s->m, &s->holds, err));
    }
    return MT_OK;
}

/* The values of K + part A^T Gamma A, in the places of H. */
static mt_status stiffen(const mt_sparse *s, double part, mt_arena *scratch, mt_lower *h,
                         mt_err *err)
{
    sums from = {.s = s, .part = part};
    column c;
    *h = s->k;
    h->value = mt_arena_f64(scratch, (size_t)h->start[h->n], 1);
    MT_TRY(column_init(&c, h->n, scratch, err));
    mt_rows_transpose(&s->p->k.row, h->n, scratch, &from.k);
    MT_TRY(mt_arena_check(scratch, err));
    for (int j = 0; j < h->n; j++) {
        sum_stiffness(&from, j, &c);
        for (int q = h->start[j]; q < h->start[j + 1]; q++) {
            h->value[q] = c.sum[h->row[q]];
        }
    }
    return MT_OK;
}

mt_status mt_sparse_inertia(mt_sparse *s, double part, double c, int *negative, double *least,
                            mt_err *err)
{
    mt_arena scratch = {.first = NULL};
    mt_lower h = s->k;
    bool regular = false;
    mt_status rc = part == 1.0 ? MT_OK : mt_arena_init(&scratch, 0, err);
    rc = rc == MT_OK && part != 1.0 ? stiffen(s, part, &scratch, &h, err) : rc;
    rc = rc == MT_OK ? make_factor(s, &h, c, &s->m, &regular, err) : rc;
    mt_arena_free(&scratch);
    MT_TRY(rc);
    *negative = s->factor.negative;
    *least = regular ? s->factor.least : 0.0;
    return MT_OK;
}

mt_status mt_sparse_factor(mt_sparse *s, double shift, bool *sound, mt_err *err)
{
    bool regular = false;
    s->shift = shift;
    MT_TRY(make_factor(s, &s->k, shift, &s->m, &regular, err));
    s->holds = true;
    s->least = s->factor.least;
    *sound = regular && s->factor.negative == 0 && s->least > REGULAR;
    if (*sound) { /* some motion of everything */
        for (int j = 0; j < s->p->n; j++) {
            s->x[j] = (1.0 + fmod(GOLDEN * (j + 1), 1.0)) * s->p->unit[j];
        }
        mt_sparse_metric(s, s->x, s->f);
        MT_TRY(mt_sparse_solve(s, 1, s->f, MT_SPARSE_SOLVED, s->x, err));
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

/* D A^T A D in the places of H, *norm a bound of its largest eigenvalue: the largest sum of
 * magnitudes in a row. */
static mt_status square_constraints(mt_sparse *s, mt_arena *scratch, mt_lower *h, double *norm,
                                    mt_err *err)
{
    const mt_sparse_problem *const p = s->p;
    column c;
    *h = s->k;
    h->value = mt_arena_f64(scratch, (size_t)h->start[h->n], 1);
    double *const sum = mt_arena_f64(scratch, (size_t)p->n, 1);
    MT_TRY(column_init(&c, p->n, scratch, err));
    for (int j = 0; j < p->n; j++) {
        clear_column(&c);
        add_squares(&c, &p->a, s->gamma, &s->by_state, j, 1.0);
        for (int q = h->start[j]; q < h->start[j + 1]; q++) {
            const int i = h->row[q];
            const double here = c.mark[i] == j + 1 ? c.sum[i] : 0.0;
            h->value[q] = here * p->unit[i] * p->unit[j] / s->stiffest;
            sum[i] += fabs(h->value[q]);
            sum[j] += i == j ? 0.0 : fabs(h->value[q]);
        }
    }
    *norm = mt_max_abs(p->n, sum);
    return MT_OK;
}

/*
 * D A^T A D - c I has one positive eigenvalue for each independent row. The unpivoted factor of
 * what is semidefinite but for c does not grow: it is that of a matrix which is off by some
 * roundings of the norm, so that c need be no more than these. The joints of a chain of n
 * bodies are 1/n from dependent, their square some 2/n^2.
 */
static mt_status rank_of_constraints(mt_sparse *s, mt_arena *scratch, mt_err *err)
{
    mt_lower h;
    double norm = 0.0;
    bool certain = false;
    MT_TRY(square_constraints(s, scratch, &h, &norm, err));
    double c = RANK_ULPS * DBL_EPSILON * norm;
    double was = 0.0;
    while (!certain) {
        bool regular = false;
        for (int j = 0; j < h.n; j++) { /* the diagonal comes first */
            h.value[h.start[j]] -= c - was;
        }
        MT_TRY(make_factor(s, &h, 0.0, NULL, &regular, err));
        s->freedoms = s->factor.negative;
        certain = (regular && s->factor.least > MT_SPARSE_CERTAIN) || !(c < DEPENDENT);
        was = c;
        c *= RAISED;
    }
    return MT_OK;
}

mt_status mt_sparse_freedoms(mt_sparse *s, mt_err *err)
{
    mt_arena scratch = {.first = NULL};
    s->freedoms = s->p->n;
    if (s->p->a.n_rows == 0) {
        return MT_OK;
    }
    mt_status rc = mt_arena_init(&scratch, 0, err);
    rc = rc == MT_OK ? rank_of_constraints(s, &scratch, err) : rc;
    mt_arena_free(&scratch);
    return rc;
}

mt_status mt_sparse_prepare(mt_sparse *s, mt_err *err)
{
    const size_t n = (size_t)s->p->n;
    const size_t m = (size_t)s->p->a.n_rows;
    mt_arena scratch = {.first = NULL};
    s->x = mt_arena_f64(s->mem, n, 1);
    s->w = mt_arena_f64(s->mem, n, 1);
    s->f = mt_arena_f64(s->mem, n, MT_SPARSE_COLUMNS);
    s->r = mt_arena_f64(s->mem, n, MT_SPARSE_COLUMNS);
    s->s = mt_arena_f64(s->mem, n, MT_SPARSE_COLUMNS);
    s->gamma = mt_arena_f64(s->mem, m, 1);
    s->mu = mt_arena_f64(s->mem, m, MT_SPARSE_COLUMNS);
    s->gap = mt_arena_f64(s->mem, m, MT_SPARSE_COLUMNS);
    mt_rows_transpose(&s->p->a, s->p->n, s->mem, &s->by_state);
    MT_TRY(mt_arena_check(s->mem, err));
    scale_constraints(s);
    mt_status rc = mt_arena_init(&scratch, 0, err);
    rc = rc == MT_OK ? assemble_both(s, &scratch, err) : rc;
    mt_arena_free(&scratch);
    mt_factor_pattern *pattern = NULL;
    MT_TRY(rc);
    MT_TRY(mt_factor_analyse(&s->k, s->p->part, s->mem, &pattern, err));
    mt_factor_init(pattern, MT_SPARSE_COLUMNS, s->mem, &s->factor);
    return mt_arena_check(s->mem, err);
}
