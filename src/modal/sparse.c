/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Every state held by a spring of one stiffness, K = D^-2 with D the units: then K x + A^T mu =
 * f, A x = 0 has one x, what of f the constraints do not hold, in units, is least, and it is 0
 * where they hold it all. What a second solution, with f - A^T mu for f, makes of mu tells what
 * the first one left open of it, by the condition of A as this f feels it.
 */
#include "modal/sparse.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/format.h"
#include "linalg/dense.h"

/* Right-hand sides per solve: ten modes and two beyond the last. */
enum { SPARSE_COLUMNS = 12 };

/* H = K + s M + A^T Gamma A of a sparse problem, factored, and work arrays of its solves. */
typedef struct sparse {
    const mt_sparse_problem *p;
    double shift;
    double blocked;   /* a lower shift, at which the factor was not sound; 0: none */
    double *gamma;    /* [rows of A] */
    double stiffer;   /* a factor of STIFFER */
    bool outweigh;    /* gamma outweighs G in each constrained state */
    double stiffest;  /* `stiffer` times the largest stiffness */
    mt_rows by_state; /* transpose of A: by state, (row, value) */
    mt_lower k;       /* K + A^T Gamma A, with places for M */
    mt_lower m;
    mt_factor factor; /* of H, or of the last matrix counted: there is room for one */
    bool holds;       /* `factor` is that of H */
    double least;     /* of the factor of H */
    int freedoms;     /* states less independent rows of A */
    bool refined;     /* products are refined iteratively */
    bool sound;       /* the last steps of a solution were small relative to it */
    double *x, *w;    /* [n] */
    double *f, *r;    /* n x SPARSE_COLUMNS: right-hand sides, residuals */
    double *s;        /* as r: the step */
    double *mu;       /* rows of A x SPARSE_COLUMNS */
    double *gap;      /* the same: A x + A dx */
    mt_arena *mem;
} sparse;

/* Below this part of the terms whose difference it is, the sign of a pivot is uncertain. */
static const double SPARSE_CERTAIN = 64.0 * DBL_EPSILON;
/* `close` of sparse_solve: to rounding. */
static const double SPARSE_SOLVED = 1e-16;

static mt_status sparse_prepare(sparse *s, mt_err *err);
static mt_status sparse_factor(sparse *s, double shift, bool *sound, mt_err *err);
static mt_status sparse_hold(sparse *s, mt_err *err);
static mt_status sparse_solve(sparse *s, int count, const double *f, double close, double *x,
                              mt_err *err);

/* A constraint's stiffness over that of a state: forces that add up along some hundred thousand
 * joints converge still, and eps times this is well below 1. */
static const double BALANCE_STIFFER = 1e12;

/* D^-2. */
static mt_status springs(const mt_sparse_problem *of, mt_arena *mem, mt_squares *out,
                         mt_err *err)
{
    const size_t n = (size_t)of->n;
    double *const c = mt_arena_f64(mem, n, 1);
    mt_rows_begin(&out->row, of->n, n, mem);
    MT_TRY(mt_arena_check(mem, err));
    out->c = c;
    for (int j = 0; j < of->n; j++) {
        c[j] = 1.0;
        mt_rows_push(&out->row, j, j, 1.0 / of->unit[j]);
        mt_rows_end(&out->row, j);
    }
    return MT_OK;
}

static mt_status find_balancing_multipliers(const mt_sparse_problem *of, const double *f,
                                            double *mu, double *open, bool *found,
                                            mt_arena *mem, mt_err *err)
{
    const int rows = of->a.n_rows;
    mt_sparse_problem p = {.n = of->n,
                           .a = of->a,
                           .part = of->part,
                           .unit = of->unit,
                           .check = of->check,
                           .context = of->context};
    double *const left = mt_arena_f64(mem, (size_t)of->n, 1);
    MT_TRY(springs(of, mem, &p.k, err));
    p.m = p.k;
    sparse s = {.p = &p, .mem = mem, .stiffer = BALANCE_STIFFER};
    MT_TRY(sparse_prepare(&s, err));
    /* where the constraints leave no motion x is rounding, and this no matter */
    bool sound = false;
    MT_TRY(sparse_factor(&s, 0.0, &sound, err));
    *found = s.factor.negative == 0 && s.least > 0.0;
    if (!*found) {
        return MT_OK;
    }
    memcpy(left, f, (size_t)of->n * sizeof *left);
    MT_TRY(sparse_solve(&s, 1, left, SPARSE_SOLVED, s.x, err));
    memcpy(mu, s.mu, (size_t)rows * sizeof *mu);
    for (int r = 0; r < rows; r++) {
        mt_rows_axpy(&of->a, r, -mu[r], left);
    }
    MT_TRY(sparse_solve(&s, 1, left, SPARSE_SOLVED, s.x, err));
    for (int r = 0; r < rows; r++) {
        mu[r] += s.mu[r];
        open[r] = fabs(s.mu[r]);
    }
    return MT_OK;
}

mt_status mt_modal_balance(const mt_sparse_problem *p, const double *f, double *mu,
                           double *open, bool *found, mt_err *err)
{
    mt_arena work = {.first = NULL};
    *found = false;
    mt_status rc = mt_arena_init(&work, 0, err);
    rc = rc == MT_OK ? find_balancing_multipliers(p, f, mu, open, found, &work, err) : rc;
    mt_arena_free(&work);
    return rc;
}

/* Assembles and factors H, and solves with it: the iteration is derived below. */

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
    const sparse *s;
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
    const sparse *const s = from->s;
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

/* Column by column, once for the pattern. inner (NULL): has places of the sum alone; where
 * these are all of them, the pattern is shared. */
static mt_status assemble_lower(const sums *from, void (*sum)(const sums *, int, column *),
                                column *c, const mt_lower *inner, mt_lower *out, mt_err *err)
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
    const bool same = inner != NULL && inner->start[n] == out->start[n];
    out->row = same ? inner->row : mt_arena_int(mem, (size_t)out->start[n]);
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
static mt_status assemble_both(sparse *s, mt_arena *scratch, mt_err *err)
{
    const mt_sparse_problem *const p = s->p;
    sums from = {.s = s, .part = 1.0};
    column c;
    mt_rows_transpose(&p->k.row, p->n, scratch, &from.k);
    mt_rows_transpose(&p->m.row, p->n, scratch, &from.m);
    MT_TRY(column_init(&c, p->n, scratch, err));
    MT_TRY(assemble_lower(&from, sum_mass, &c, NULL, &s->m, err));
    return assemble_lower(&from, sum_stiffness, &c, &s->m, &s->k, err);
}

/* y := M x. */
static void sparse_metric(void *context, const double *x, double *y)
{
    const mt_lower *const m = &((const sparse *)context)->m;
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

/* y -= K x, strain by strain. */
static void sparse_subtract(const sparse *s, const double *x, double *y)
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
static void leave(sparse *s, bool first, const double *f, const double *x, const double *mu,
                  double *r, double *gap)
{
    const mt_sparse_problem *const p = s->p;
    memcpy(r, f, (size_t)p->n * sizeof *r);
    if (!first) {
        sparse_metric(s, x, s->w);
        mt_axpy(p->n, -s->shift, s->w, r);
        sparse_subtract(s, x, r);
    }
    for (int i = 0; i < p->a.n_rows; i++) {
        gap[i] = first ? 0.0 : mt_rows_dot(&p->a, i, x);
        mt_rows_axpy(&p->a, i, -mu[i] - (s->gamma[i] * gap[i]), r);
    }
}

/* x += dx, mu += Gamma A (x + dx). */
static void advance(const sparse *s, const double *dx, const double *gap, double *x, double *mu)
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
    int column[SPARSE_COLUMNS];
    double before[SPARSE_COLUMNS]; /* last step, in the energy's norm */
    bool sound[SPARSE_COLUMNS];
} pending;

/* Take the step s->s in the open columns; converged columns are removed from o. */
static void step_all(sparse *s, int step, const double *f, double close, double *x, pending *o)
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

/* X, s->mu with (K + s M) X + A^T mu = F, A X = 0, n x count, at most SPARSE_COLUMNS
 * columns, each to a fraction `close` of its energy, or as accurately as rounding allows. F
 * must not be s->r. */
static mt_status sparse_solve(sparse *s, int count, const double *f, double close, double *x,
                              mt_err *err)
{
    const mt_sparse_problem *const p = s->p;
    const ptrdiff_t n = p->n;
    const ptrdiff_t rows = p->a.n_rows;
    pending o = {.n = count};
    MT_TRY(sparse_hold(s, err));
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
static mt_status make_factor(sparse *s, const mt_lower *h, double c, const mt_lower *m,
                             bool *regular, mt_err *err)
{
    const mt_status rc = mt_factor_make(&s->factor, h, c, m, s->mem, NULL);
    s->holds = false;
    *regular = rc == MT_OK;
    return rc == MT_OK || rc == MT_E_DOMAIN ? MT_OK : mt_fail(err, rc, "factor");
}

/* Factor H with its shift again if another matrix was factored since. */
static mt_status sparse_hold(sparse *s, mt_err *err)
{
    if (!s->holds) {
        MT_TRY(make_factor(s, &s->k, s->shift, &s->m, &s->holds, err));
    }
    return MT_OK;
}

/* The values of K + part A^T Gamma A, in the places of H. */
static mt_status stiffen(const sparse *s, double part, mt_arena *scratch, mt_lower *h,
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

/* Factor K + part A^T Gamma A + c M; `factor` is then not that of H. */
static mt_status sparse_inertia(sparse *s, double part, double c, int *negative, double *least,
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

/* Factor H with this shift; *sound: positive definite, and its solutions are accurate. */
static mt_status sparse_factor(sparse *s, double shift, bool *sound, mt_err *err)
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
        sparse_metric(s, s->x, s->f);
        MT_TRY(sparse_solve(s, 1, s->f, SPARSE_SOLVED, s->x, err));
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
static mt_status square_constraints(sparse *s, mt_arena *scratch, mt_lower *h, double *norm,
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
static mt_status rank_of_constraints(sparse *s, mt_arena *scratch, mt_err *err)
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
        certain = (regular && s->factor.least > SPARSE_CERTAIN) || !(c < DEPENDENT);
        was = c;
        c *= RAISED;
    }
    return MT_OK;
}

/* Set s->freedoms: states less independent rows of A. `factor` is then not that of H. */
static mt_status sparse_freedoms(sparse *s, mt_err *err)
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

/* Prepare everything but the values of the factor; s is zeroed except for p, mem, stiffer and
 * outweigh. */
static mt_status sparse_prepare(sparse *s, mt_err *err)
{
    const size_t n = (size_t)s->p->n;
    const size_t m = (size_t)s->p->a.n_rows;
    mt_arena scratch = {.first = NULL};
    s->x = mt_arena_f64(s->mem, n, 1);
    s->w = mt_arena_f64(s->mem, n, 1);
    s->f = mt_arena_f64(s->mem, n, SPARSE_COLUMNS);
    s->r = mt_arena_f64(s->mem, n, SPARSE_COLUMNS);
    s->s = mt_arena_f64(s->mem, n, SPARSE_COLUMNS);
    s->gamma = mt_arena_f64(s->mem, m, 1);
    s->mu = mt_arena_f64(s->mem, m, SPARSE_COLUMNS);
    s->gap = mt_arena_f64(s->mem, m, SPARSE_COLUMNS);
    mt_rows_transpose(&s->p->a, s->p->n, s->mem, &s->by_state);
    MT_TRY(mt_arena_check(s->mem, err));
    scale_constraints(s);
    mt_status rc = mt_arena_init(&scratch, 0, err);
    rc = rc == MT_OK ? assemble_both(s, &scratch, err) : rc;
    mt_arena_free(&scratch);
    mt_factor_pattern *pattern = NULL;
    MT_TRY(rc);
    MT_TRY(mt_factor_analyse(&s->k, s->p->part, s->mem, &pattern, err));
    mt_factor_init(pattern, SPARSE_COLUMNS, s->mem, &s->factor);
    return mt_arena_check(s->mem, err);
}

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

/* gamma over the largest stiffness: a constraint's own flexibility is gone after two or three
 * iterations (of loops of thousands with the second), and eps gamma cond K is well below 1. The
 * third is for what is so much larger than its parts that stiffnesses against turns, over the
 * square of the whole length, are nothing: a ring of 20,000 hinged bars. */
static const double STIFFER[] = {1e6, 1e8, 1e12};
enum { OF_LOADED = 2 /* of them, where gamma may have to outweigh G */ };
/* The same of a count that says more than was found, in that. */
static const double COUNTED[] = {1e3, 1e6};
/* Below this the factor's rounding is refined away in each product. */
static const double WELL = 1e-7;
/* The first shift, in the largest K_ii/M_ii; and the least and most that it should be of the
 * lowest mode: far above it the modes stand close together in what is iterated, and below it a
 * rigid-body mode's rounding there is large against all that the others are. */
static const double FIRST_SHIFT = 1e-8;
static const double MOST_SHIFT = 100.0;
static const double LEAST_SHIFT = 0.25;
/* Tries of a first shift, and of a better one. */
enum { SHIFTS = 2, ROUNDS = 4 };
/* A subspace that a first shift is lowered by: the motions of a free body and two more, so many
 * times. What it finds below RESOLVED of the shift may be a rigid-body mode, solved to ROUGHLY:
 * a step lowers the shift to some tenth of it. */
enum { SUBSPACE = 8, LOWERINGS = 20 };
static const double RESOLVED = 3e-2;
static const double ROUGHLY = 1e-6;
/* A lambda that one more step changes by no more than this is the lowest one. */
static const double SETTLED = 0.05;
/* Columns of Lanczos' method at a time. */
enum { BLOCK = 4 };
/* Roundings of a strain, and strains so many times their rounding that are none. */
static const double STRAIN_ULPS = 4.0;
static const double RIGID = 1e3;
/* Of everything else in a quotient. */
static const double OTHER_ULPS = 64.0;

static mt_status apply_inverse_iteration(void *context, int count, const double *x, double *y,
                                         mt_err *err)
{
    sparse *const s = context;
    const ptrdiff_t n = s->p->n;
    double *const to = s->refined ? s->f : y;
    for (int c = 0; c < count; c++) {
        sparse_metric(s, x + (n * c), to + (n * c));
    }
    if (s->refined) {
        return sparse_solve(s, count, s->f, SPARSE_SOLVED, y, err);
    }
    MT_TRY(s->p->check != NULL ? s->p->check(s->p->context, err) : MT_OK);
    MT_TRY(sparse_hold(s, err));
    mt_factor_solve(&s->factor, count, y);
    return MT_OK;
}

/* A sum of squares at x, and of the squares of its strains' roundings. */
static double sparse_energy(const mt_squares *of, const double *x, double *noise)
{
    double sum = 0.0;
    *noise = 0.0;
    for (int r = 0; r < of->row.n_rows; r++) {
        double size = 0.0;
        const double here = mt_rows_dot_size(&of->row, r, x, &size);
        const double delta = STRAIN_ULPS * DBL_EPSILON * size;
        sum += of->c[r] * here * here;
        *noise += fabs(of->c[r]) * delta * delta;
    }
    return sum;
}

/* *k += x^T G x, *noise += its rounding. */
static void add_load(const mt_sparse_problem *p, const double *x, double *k, double *noise)
{
    for (int j = 0; p->g != NULL && j < p->n; j++) {
        for (int i = p->g->start[j]; i < p->g->start[j + 1]; i++) {
            const double twice = p->g->row[i] == j ? 1.0 : 2.0;
            const double part = twice * p->g->value[i] * x[j] * x[p->g->row[i]];
            *k += part;
            *noise += STRAIN_ULPS * DBL_EPSILON * fabs(part);
            *noise += twice * p->g_noise[i] * fabs(x[j] * x[p->g->row[i]]);
        }
    }
}

/* Rounding of x^T G x, including errors of G. */
static double sparse_load_noise(const sparse *s, const double *x)
{
    double k = 0.0;
    double noise = 0.0;
    add_load(s->p, x, &k, &noise);
    return noise;
}

/* The quotient of y, whose constraints' forces are mu. */
static void quotient_of_vector(const sparse *s, const double *y, const double *mu,
                               mt_lowest_quotient *q)
{
    const mt_sparse_problem *const p = s->p;
    double k_noise = 0.0;
    double m_noise = 0.0;
    double k = sparse_energy(&p->k, y, &k_noise);
    const double m = sparse_energy(&p->m, y, &m_noise);
    double other = 0.0;
    add_load(p, y, &k, &other);
    /* what y leaves open of the constraints, their forces pay for */
    for (int r = 0; r < p->a.n_rows; r++) {
        double size = 0.0;
        const double gap = mt_rows_dot_size(&p->a, r, y, &size);
        k += 2.0 * mu[r] * gap;
        other += 2.0 * fabs(mu[r]) * STRAIN_ULPS * DBL_EPSILON * size;
    }
    q->lambda = k / m;
    q->rigid = fabs(k) <= RIGID * ((RIGID * k_noise) + other) ||
               fabs(q->lambda) <= DBL_EPSILON * s->shift;
    const double size = fmax(fabs(k), DBL_MIN);
    q->noise = (2.0 * sqrt(k_noise / size)) + ((k_noise + other) / size) +
               (2.0 * sqrt(m_noise / m)) + (OTHER_ULPS * DBL_EPSILON);
}

/* Columns from first on that are solved for together. */
static int some(int first, int count)
{
    return count - first < SPARSE_COLUMNS ? count - first : SPARSE_COLUMNS;
}

static mt_status refine_vectors(void *context, int count, const double *x, double *y,
                                mt_lowest_quotient *q, mt_err *err)
{
    sparse *const s = context;
    const ptrdiff_t n = s->p->n;
    const ptrdiff_t rows = s->p->a.n_rows;
    for (int first = 0; first < count; first += SPARSE_COLUMNS) {
        const int here = some(first, count);
        double *const to = y + (n * first);
        for (int c = 0; c < here; c++) {
            sparse_metric(s, x + (n * (first + c)), s->f + (n * c));
        }
        MT_TRY(sparse_solve(s, here, s->f, SPARSE_SOLVED, to, err));
        for (int c = 0; c < here; c++) {
            quotient_of_vector(s, to + (n * c), s->mu + (rows * c), q + first + c);
        }
    }
    return MT_OK;
}

/* Every count is a bound from above: a chain of many bodies has modes of its constraints' own
 * flexibility, which are gone where these are stiffer. */
static mt_status count_modes_below(void *context, double tau, int known, int *n, bool *certain,
                                   mt_err *err)
{
    sparse *const s = context;
    double least = 0.0;
    *certain = false;
    for (int i = 0; i <= MT_COUNT(COUNTED) && !(*certain && *n <= known); i++) {
        int here = 0;
        if (i > 0 && s->p->a.n_rows == 0) {
            break;
        }
        MT_TRY(s->p->check != NULL ? s->p->check(s->p->context, err) : MT_OK);
        MT_TRY(sparse_inertia(s, i == 0 ? 1.0 : COUNTED[i - 1], -tau, &here, &least, err));
        if (least > SPARSE_CERTAIN && (!*certain || here < *n)) {
            *n = here;
            *certain = true;
        }
    }
    return MT_OK;
}

/* The largest K_ii/M_ii. */
static double highest(const sparse *s)
{
    double most = 0.0;
    for (int j = 0; j < s->p->n; j++) {
        const double m = s->m.value[s->m.start[j]];
        most = m > 0.0 ? fmax(most, s->x[j] / m) : most;
    }
    return most;
}

/* H, with a shift where K alone may be singular. */
static mt_status factor_stiffness(sparse *s, bool *held, char *why, mt_err *err)
{
    double shift = FIRST_SHIFT * highest(s);
    *held = s->stiffest > 0.0;
    if (!*held) {
        (void)mt_snprintf(why, MT_SPARSE_WHY, "nothing in it has a stiffness");
        return MT_OK;
    }
    MT_TRY(sparse_freedoms(s, err));
    MT_TRY(sparse_factor(s, 0.0, held, err));
    for (int i = 0; i < SHIFTS && !*held && shift > 0.0; i++) {
        MT_TRY(sparse_factor(s, shift, held, err));
        shift *= 100.0;
    }
    if (!*held) {
        (void)mt_snprintf(why, MT_SPARSE_WHY,
                          "a motion without stiffness has no mass, the mechanism is unstable, "
                          "or sixteen digits do not resolve all of its motions");
    }
    return MT_OK;
}

/* lambda of the lowest mode that is not a rigid-body mode, negative where it is unstable (it
 * comes before the rigid-body ones, in the order of 1/(lambda + s)); 0: none. */
static double lowest_lambda(const mt_modes *m)
{
    double lowest = HUGE_VAL;
    for (int i = 0; i < m->count; i++) {
        lowest = m->kind[i] == MT_MODE_FLEXIBLE ? fmin(lowest, m->lambda[i]) : lowest;
    }
    return lowest < HUGE_VAL ? lowest : 0.0;
}

/* Columns orthonormal in M, n x count; false where they are dependent but for rounding. */
static bool orthonormalise(sparse *s, int count, double *x)
{
    static const double DEPENDENT_VECTORS = 1e-10;
    const int n = s->p->n;
    for (int c = 0; c < count; c++) {
        double *const own = x + ((ptrdiff_t)n * c);
        sparse_metric(s, own, s->w);
        const double whole = mt_dot(n, own, s->w);
        for (int pass = 0; pass < 2; pass++) {
            for (int b = 0; b < c; b++) {
                const double *const before = x + ((ptrdiff_t)n * b);
                mt_axpy(n, -mt_dot(n, before, s->w), before, own);
            }
            sparse_metric(s, own, s->w);
        }
        const double square = mt_dot(n, own, s->w);
        if (!(square > DEPENDENT_VECTORS * DEPENDENT_VECTORS * whole)) {
            return false;
        }
        for (int j = 0; j < n; j++) {
            own[j] /= sqrt(square);
        }
    }
    return true;
}

/* y := (K + s M)^-1 M x, and the lowest lambda above RESOLVED s of its Ritz values; infinite
 * where there is none. With H = K + s M, y^T H y = x^T M y = V theta V^T, and phi the
 * eigenvalues of theta^-1/2 V^T (y^T M y) V theta^-1/2, lambda = 1/phi - s. */
static mt_status find_lowest_ritz(sparse *s, int count, const double *x, double *y,
                                  double *lowest, mt_err *err)
{
    const ptrdiff_t n = s->p->n;
    double v[SUBSPACE * SUBSPACE] = {0.0};
    double mass[SUBSPACE * SUBSPACE] = {0.0};
    double turned[SUBSPACE * SUBSPACE] = {0.0};
    double theta[SUBSPACE] = {0.0};
    double phi[SUBSPACE] = {0.0};
    *lowest = HUGE_VAL;
    for (int c = 0; c < count; c++) {
        sparse_metric(s, x + (n * c), s->f + (n * c));
    }
    MT_TRY(sparse_solve(s, count, s->f, ROUGHLY, y, err));
    for (int c = 0; c < count; c++) {
        sparse_metric(s, y + (n * c), s->w);
        for (int r = 0; r < count; r++) {
            v[r + (count * c)] = mt_dot((int)n, s->f + (n * r), y + (n * c));
            mass[r + (count * c)] = mt_dot((int)n, s->w, y + (n * r));
        }
    }
    MT_TRY(mt_eig_sym(count, v, theta, true, s->mem, err));
    if (!(theta[0] > 0.0)) {
        return MT_OK;
    }
    mt_gemm(false, false, count, count, count, 1.0, mass, count, v, count, 0.0, turned, count);
    mt_gemm(true, false, count, count, count, 1.0, v, count, turned, count, 0.0, mass, count);
    for (int c = 0; c < count; c++) {
        for (int r = 0; r < count; r++) {
            mass[r + (count * c)] /= sqrt(theta[r] * theta[c]);
        }
    }
    MT_TRY(mt_eig_sym(count, mass, phi, false, s->mem, err));
    for (int c = 0; c < count; c++) {
        const double lambda = phi[c] > 0.0 ? (1.0 / phi[c]) - s->shift : HUGE_VAL;
        *lowest = lambda > RESOLVED * s->shift ? fmin(*lowest, lambda) : *lowest;
    }
    return MT_OK;
}

/*
 * Far above the lowest modes a shift leaves their 1/(lambda + s) so close together that
 * Lanczos' method takes some (s/lambda)^(1/2) steps, and the largest K_ii/M_ii, of which the
 * first shift is a part, grows with the fourth power of a ring's bodies. Each step of a
 * subspace's iteration shows a lower lambda, which is the next shift, but where a step more
 * shows the same one, and the shift fits that.
 */
static mt_status lower_shift(sparse *s, mt_err *err)
{
    const size_t n = (size_t)s->p->n;
    const int count = s->freedoms < SUBSPACE ? s->freedoms : SUBSPACE;
    const mt_arena_mark mark = mt_arena_get_mark(s->mem);
    double *x = mt_arena_f64(s->mem, n, (size_t)count);
    double *y = mt_arena_f64(s->mem, n, (size_t)count);
    uint32_t state = 1;
    bool moved = false;
    MT_TRY(mt_arena_check(s->mem, err));
    for (size_t i = 0; i < n * (size_t)count; i++) {
        state = (state * 1664525U) + 1013904223U;
        x[i] = (((double)(state >> 8U) / 8388608.0) - 1.0) * s->p->unit[i % n];
    }
    bool on = orthonormalise(s, count, x);
    double before = HUGE_VAL;
    for (int i = 0; i < LOWERINGS && on; i++) {
        const double was = s->shift;
        double lowest = HUGE_VAL;
        MT_TRY(find_lowest_ritz(s, count, x, y, &lowest, err));
        const bool settled = fabs(before - lowest) <= SETTLED * lowest;
        const bool fits = was <= MOST_SHIFT * lowest && was >= LEAST_SHIFT * lowest;
        const bool below = (settled || moved) && was < LEAST_SHIFT * lowest;
        const bool move = i > 0 && lowest < HUGE_VAL && (was > lowest || below);
        before = lowest;
        on = (i == 0 || move) && !(settled && fits) && orthonormalise(s, count, y);
        if (on && move) {
            moved = true;
            MT_TRY(sparse_factor(s, lowest, &on, err));
        }
        if (!on && s->shift != was) {
            bool sound = false;
            s->blocked = s->shift;
            MT_TRY(sparse_factor(s, was, &sound, err));
        }
        double *const swap = x;
        x = y;
        y = swap;
    }
    mt_arena_rewind(s->mem, mark);
    return MT_OK;
}

static mt_status find_sparse_modes(sparse *s, mt_arena *mem, mt_lowest_modes *out, bool *stable,
                                   mt_err *err)
{
    const mt_sparse_problem *const p = s->p;
    for (int round = 0;; round++) {
        const mt_arena_mark mark = mt_arena_get_mark(mem);
        const mt_lowest_problem problem = {.n = p->n,
                                           .most = s->freedoms,
                                           .count = p->count,
                                           .block = BLOCK,
                                           .shift = s->shift,
                                           .shapes = p->shapes,
                                           .apply = apply_inverse_iteration,
                                           .metric = sparse_metric,
                                           .refine = refine_vectors,
                                           .below = count_modes_below,
                                           .context = s};
        s->refined = p->a.n_rows > 0 || s->least < WELL;
        MT_TRY(mt_modal_lowest(&problem, mem, out, err));
        const double first = lowest_lambda(&out->modes);
        *stable = first >= 0.0;
        const bool apart = s->shift > MOST_SHIFT * first || s->shift < LEAST_SHIFT * first;
        if (round == ROUNDS || s->shift == 0.0 || !(first > 0.0 && apart)) {
            return MT_OK;
        }
        const double was = s->shift;
        bool sound = false;
        MT_TRY(sparse_factor(s, first, &sound, err));
        if (!sound) {
            return sparse_factor(s, was, &sound, err);
        }
        mt_arena_rewind(mem, mark);
    }
}

/* y := y - X X^T M y with the first i columns, and its forces nu with theirs (rigid-body modes
 * have none): inverse iteration has made the rounding of M y larger by the quotient of their
 * eigenvalues. */
static void clear_of_softer(sparse *s, int i, const double *x, const double *forces, double *y,
                            double *nu)
{
    const int n = s->p->n;
    const int rows = s->p->a.n_rows;
    sparse_metric(s, y, s->f);
    for (int j = 0; j < i; j++) {
        const double *const softer = x + ((ptrdiff_t)n * j);
        const double part = -mt_dot(n, softer, s->f);
        mt_axpy(n, part, softer, y);
        mt_axpy(rows, part, forces + ((ptrdiff_t)rows * j), nu);
    }
}

/* One more step of inverse iteration, (K + s M) Y + A^T N = M X, and among the vibration modes
 * the Ritz vectors: of X^T M Y, X being orthonormal. x := y, mu := nu, both over the size of
 * y. */
static mt_status refine_shapes(sparse *s, mt_arena *mem, const mt_lowest_modes *out,
                               double **mu, mt_err *err)
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
    for (int i = 0; i < count; i += SPARSE_COLUMNS) {
        const int here = some(i, count);
        for (int c = 0; c < here; c++) {
            sparse_metric(s, x + ((ptrdiff_t)n * (i + c)), s->f + ((ptrdiff_t)n * c));
        }
        MT_TRY(sparse_solve(s, here, s->f, SPARSE_SOLVED, y + ((ptrdiff_t)n * i), err));
        memcpy(force + ((ptrdiff_t)rows * i), s->mu,
               (size_t)rows * (size_t)here * sizeof *force);
    }
    for (int i = 0; i < count; i++) {
        sparse_metric(s, y + ((ptrdiff_t)n * i), s->f);
        for (int k = 0; k <= i; k++) { /* the smaller image: its rounding is the smaller one */
            h[i + ((ptrdiff_t)count * k)] = mt_dot(n, x + ((ptrdiff_t)n * k), s->f);
        }
    }
    MT_TRY(mt_eig_graded(count, h, theta, s->mem, err));
    mt_turn_columns(n, count, count, h, count, y, theta);
    mt_turn_columns(rows, count, count, h, count, force, theta);
    for (int i = 0; i < count; i++) {
        double *const to = y + ((ptrdiff_t)n * i);
        double *const nu = force + ((ptrdiff_t)rows * i);
        clear_of_softer(s, first + i, out->x, *mu, to, nu);
        sparse_metric(s, to, s->f);
        const double size = sqrt(mt_dot(n, to, s->f));
        for (int j = 0; j < n; j++) {
            x[j + ((ptrdiff_t)n * i)] = to[j] / size;
        }
        for (int j = 0; j < rows; j++) {
            nu[j] /= size;
        }
    }
    return MT_OK;
}

/* Number of constraint stiffnesses to try, and try i of them, ready to be prepared. */
/* Without constraints, or stiffnesses, all of STIFFER are one. */
static int sparse_tries(const mt_sparse_problem *p)
{
    return p->a.n_rows == 0 ? 1 : p->g == NULL ? MT_COUNT(STIFFER) : 2 * OF_LOADED;
}

static sparse sparse_try(const mt_sparse_problem *p, int i, mt_arena *mem)
{
    return (sparse){.p = p,
                    .mem = mem,
                    .stiffer = STIFFER[p->g == NULL ? i : i % OF_LOADED],
                    .outweigh = p->g != NULL && i >= OF_LOADED};
}

/* A stiffness of constraints that a high first shift asks for may be too much for the lower one
 * that it led to: with that, from the least stiffness on. tried: of `s`, which keeps what it
 * has where none is better. */
static mt_status soften_constraints(const mt_sparse_problem *p, int tried, sparse *s,
                                    mt_err *err)
{
    const sparse was = *s;
    bool sound = was.blocked == 0.0;
    for (int i = 0; i <= tried && !sound; i++) {
        mt_arena_clear(was.mem);
        *s = sparse_try(p, i, was.mem);
        MT_TRY(sparse_prepare(s, err));
        s->freedoms = was.freedoms;
        MT_TRY(sparse_factor(s, i < tried ? was.blocked : was.shift, &sound, err));
    }
    return sound && s->stiffer < was.stiffer ? lower_shift(s, err) : MT_OK;
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
    bool more = true;
    int tried = 0;
    for (int i = 0; i < sparse_tries(p) && rc == MT_OK && more; i++) {
        mt_arena_clear(&work);
        tried = i;
        s = sparse_try(p, i, &work);
        rc = sparse_prepare(&s, err);
        rc = rc == MT_OK ? factor_stiffness(&s, answered, why, err) : rc;
        more = !*answered && s.stiffest > 0.0;
    }
    if (rc == MT_OK && *answered && s.shift > 0.0) {
        rc = lower_shift(&s, err);
        rc = rc == MT_OK ? soften_constraints(p, tried, &s, err) : rc;
    }
    if (rc == MT_OK && *answered) {
        rc = find_sparse_modes(&s, mem, out, answered, err);
        if (!*answered) {
            (void)mt_snprintf(why, MT_SPARSE_WHY, "the mechanism is unstable");
        }
        rc = rc == MT_OK && *answered && p->shapes ? refine_shapes(&s, mem, out, mu, err) : rc;
    }
    mt_arena_free(&work);
    return rc;
}

/*
 * With E = x^T (K + s M) x, what the roundings delta of the strains of x make of it is at most
 * (sum k delta^2)^(1/2) in the norm E^(1/2) (sparse.c); what x leaves open of the constraints
 * their forces pay for.
 */

struct mt_sparse_solver {
    mt_sparse_problem p;
    sparse s;
    mt_arena *mem;
};

/* The factor with a shift, from the least stiffness of constraints on. */
static mt_status factor_with_shift(mt_sparse_solver *o, double shift, bool *sound, mt_err *err)
{
    const int tries = sparse_tries(&o->p);
    *sound = false;
    for (int i = 0; i < tries && !*sound; i++) {
        const mt_arena_mark mark = mt_arena_get_mark(o->mem);
        o->s = sparse_try(&o->p, i, o->mem);
        MT_TRY(sparse_prepare(&o->s, err));
        MT_TRY(sparse_factor(&o->s, shift, sound, err));
        if (!*sound) {
            mt_arena_rewind(o->mem, mark);
        }
    }
    return MT_OK;
}

mt_status mt_sparse_solver_new(const mt_sparse_problem *p, bool held, double lambda,
                               mt_arena *mem, mt_sparse_solver **out, mt_err *err)
{
    mt_sparse_solver *const o = mt_arena_alloc(mem, 1, sizeof *o);
    bool sound = false;
    *out = NULL;
    MT_TRY(mt_arena_check(mem, err));
    *o = (mt_sparse_solver){.p = *p, .mem = mem};
    if (held) {
        MT_TRY(factor_with_shift(o, 0.0, &sound, err));
    }
    if (!sound) {
        MT_TRY(factor_with_shift(o, lambda, &sound, err));
    }
    *out = sound ? o : NULL;
    return MT_OK;
}

double mt_sparse_solver_shift(const mt_sparse_solver *o)
{
    return o->s.shift;
}

void mt_sparse_solver_mass(mt_sparse_solver *o, const double *x, double *y)
{
    sparse_metric(&o->s, x, y);
}

void mt_sparse_solver_stiffness(mt_sparse_solver *o, const double *x, double *y)
{
    sparse_metric(&o->s, x, y);
    for (int j = 0; j < o->p.n; j++) {
        y[j] *= -o->s.shift;
    }
    sparse_subtract(&o->s, x, y);
    for (int j = 0; j < o->p.n; j++) {
        y[j] = -y[j];
    }
}

mt_status mt_sparse_solver_solve(mt_sparse_solver *o, const double *f, double *x, double *noise,
                                 mt_err *err)
{
    sparse *const s = &o->s;
    const mt_sparse_problem *const p = &o->p;
    double k_noise = 0.0;
    double m_noise = 0.0;
    MT_TRY(sparse_solve(s, 1, f, SPARSE_SOLVED, x, err));
    if (noise == NULL) {
        return MT_OK;
    }
    const double size = sqrt(fmax(mt_dot(p->n, x, f), 0.0));
    double other = sparse_load_noise(s, x);
    (void)sparse_energy(&p->k, x, &k_noise);
    (void)sparse_energy(&p->m, x, &m_noise);
    for (int r = 0; r < p->a.n_rows; r++) {
        other += fabs(s->mu[r] * mt_rows_dot(&p->a, r, x));
    }
    *noise = sqrt(k_noise + (s->shift * m_noise)) + (OTHER_ULPS * DBL_EPSILON * size) +
             (size > 0.0 ? other / size : 0.0);
    return MT_OK;
}
