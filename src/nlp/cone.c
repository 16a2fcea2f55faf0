/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "nlp/cone.h"

#include <math.h>
#include <string.h>

#include "linalg/dense.h"

enum { ATOMS_MOST = 64, STEPS_MOST = 400 };
/* A column or an atom that would lower |z|^2 by less than this part of |g| |z| is no help. */
static const double HELPS = 1e-10;
/* Columns shorter than this part of the longest are zero by rounding. */
static const double SHORT = 1e-12;

/* Columns of unit length, and which of them take part (Lawson and Hanson's passive set). */
typedef struct columns {
    const mt_cone *c;
    mt_arena *mem;
    int n;
    int count;
    double *a;      /* n x capacity */
    double *length; /* [capacity] before it was made 1; 0: no column */
    double *x;      /* [capacity] */
    double *v;      /* atoms: vectors, r_most x capacity */
    int *block;     /* [capacity] -1: a row */
    bool *free_sign;
    bool *in;
    double *p; /* n x capacity: those that take part */
    double *y; /* [capacity] */
    int *which;
    double size; /* |g| */
} columns;

static void add_column(columns *w, bool free_sign, int block)
{
    double *const a = w->a + (ptrdiff_t)w->count * w->n;
    const double length = mt_norm2(w->n, a);
    w->length[w->count] = length;
    for (int j = 0; j < w->n && length > 0; j++) {
        a[j] /= length;
    }
    w->free_sign[w->count] = free_sign;
    w->in[w->count] = free_sign && length > 0;
    w->block[w->count] = block;
    w->x[w->count++] = 0;
}

/* The atom v v^T of a block as a column: v^T dB_j v. */
static void add_atom(columns *w, int block, int r_most, const double *v)
{
    const mt_cone_block *const b = &w->c->blocks[block];
    double *const a = w->a + (ptrdiff_t)w->count * w->n;
    memcpy(w->v + (ptrdiff_t)w->count * r_most, v, (size_t)b->r * sizeof *v);
    for (int j = 0; j < w->n; j++) {
        const double *const g = b->g + (ptrdiff_t)j * b->r * b->r;
        a[j] = 0;
        for (int k = 0; k < b->r; k++) {
            a[j] += v[k] * mt_dot(b->r, g + (ptrdiff_t)k * b->r, v);
        }
    }
    add_column(w, false, block);
}

/* Least squares over the passive columns: y in their places, z the residual. */
static mt_status solve_passive_columns(columns *w, double *z, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(w->mem);
    int k = 0;
    for (int i = 0; i < w->count; i++) {
        if (w->in[i]) {
            memcpy(w->p + (ptrdiff_t)k * w->n, w->a + (ptrdiff_t)i * w->n,
                   (size_t)w->n * sizeof *w->p);
            w->which[k++] = i;
        }
    }
    double *const y = mt_arena_f64(w->mem, (size_t)k, 1);
    mt_qr qr;
    MT_TRY(mt_arena_check(w->mem, err));
    MT_TRY(mt_qr_factor(w->n, k, w->p, w->n, HELPS, w->mem, &qr, err));
    MT_TRY(mt_qr_solve(&qr, 1, w->c->gradient, y, w->mem, err));
    memcpy(z, w->c->gradient, (size_t)w->n * sizeof *z);
    memset(w->y, 0, (size_t)w->count * sizeof *w->y);
    for (int i = 0; i < k; i++) {
        w->y[w->which[i]] = y[i];
        mt_axpy(w->n, -y[i], w->a + (ptrdiff_t)w->which[i] * w->n, z);
    }
    mt_arena_rewind(w->mem, mark);
    return MT_OK;
}

/* Steps from x towards y as far as the signs allow; columns that reach 0 leave. True: the full
 * step. */
static bool advance_within_signs(columns *w)
{
    double part = 1;
    for (int i = 0; i < w->count; i++) {
        if (w->in[i] && !w->free_sign[i] && w->y[i] <= 0) {
            part = fmin(part, w->x[i] / fmax(w->x[i] - w->y[i], 1e-300));
        }
    }
    const bool all = part >= 1;
    for (int i = 0; i < w->count; i++) {
        w->x[i] += part * (w->y[i] - w->x[i]);
        if (!all && w->in[i] && !w->free_sign[i] && w->y[i] <= 0 &&
            w->x[i] <= SHORT * w->size) {
            w->in[i] = false;
            w->x[i] = 0;
        }
    }
    return all;
}

/* The column that reduces |z| most; -1: none does. */
static int helper(const columns *w, const double *z)
{
    double most = HELPS * w->size;
    int best = -1;
    for (int i = 0; i < w->count; i++) {
        const double s = w->length[i] > 0 ? mt_dot(w->n, w->a + (ptrdiff_t)i * w->n, z) : 0;
        if (!w->in[i] && s > most) {
            most = s;
            best = i;
        }
    }
    return best;
}

static mt_status least_squares(columns *w, double *z, mt_err *err)
{
    for (int step = 0; step < STEPS_MOST; step++) {
        MT_TRY(solve_passive_columns(w, z, err));
        if (!advance_within_signs(w)) {
            continue;
        }
        const int next = helper(w, z);
        if (next < 0) {
            return MT_OK;
        }
        w->in[next] = true;
    }
    return MT_OK;
}

/* Adds, for every block, the atom that reduces |z| most. *added: there was one. */
static mt_status add_atoms(columns *w, int r_most, const double *z, bool *added, mt_err *err)
{
    *added = false;
    for (int b = 0; b < w->c->n_blocks; b++) {
        const mt_cone_block *const block = &w->c->blocks[b];
        const int r = block->r;
        const mt_arena_mark mark = mt_arena_get_mark(w->mem);
        double *const s = mt_arena_f64(w->mem, (size_t)r, (size_t)r);
        double *const e = mt_arena_f64(w->mem, (size_t)r, 1);
        MT_TRY(mt_arena_check(w->mem, err));
        double scale = 0;
        for (int j = 0; j < w->n; j++) {
            const double *const g = block->g + (ptrdiff_t)j * r * r;
            mt_axpy(r * r, z[j], g, s);
            scale = fmax(scale, mt_max_abs((ptrdiff_t)r * r, g));
        }
        MT_TRY(mt_eig_sym(r, s, e, true, w->mem, err));
        if (e[r - 1] > 1e3 * HELPS * w->size * scale) {
            add_atom(w, b, r_most, s + (ptrdiff_t)(r - 1) * r);
            *added = true;
        }
        mt_arena_rewind(w->mem, mark);
    }
    return MT_OK;
}

static void store_multipliers(const columns *w, int r_most, mt_cone *c)
{
    double scale = w->size;
    for (int b = 0; b < c->n_blocks; b++) {
        const size_t r = (size_t)c->blocks[b].r;
        memset(c->blocks[b].u, 0, r * r * sizeof *c->blocks[b].u);
    }
    for (int i = 0; i < w->count; i++) {
        const double x = w->length[i] > 0 ? w->x[i] / w->length[i] : 0;
        scale = fmax(scale, fabs(w->x[i]));
        if (w->block[i] < 0) {
            c->x[i] = x;
            continue;
        }
        const mt_cone_block *const b = &c->blocks[w->block[i]];
        const double *const v = w->v + (ptrdiff_t)i * r_most;
        for (int k = 0; k < b->r; k++) {
            mt_axpy(b->r, x * v[k], v, b->u + (ptrdiff_t)k * b->r);
        }
    }
    c->kkt = scale > 0 ? mt_norm2(c->n, c->z) / scale : 0;
}

mt_status mt_cone_residual(mt_cone *c, mt_arena *scratch, mt_err *err)
{
    int r_most = 1;
    int first = 0;
    for (int b = 0; b < c->n_blocks; b++) {
        r_most = c->blocks[b].r > r_most ? c->blocks[b].r : r_most;
        first += c->blocks[b].r;
    }
    const size_t n = (size_t)c->n;
    const size_t most = (size_t)c->n_rows + (size_t)first + (size_t)ATOMS_MOST;
    columns w = {.c = c,
                 .mem = scratch,
                 .n = c->n,
                 .a = mt_arena_f64(scratch, n, most),
                 .length = mt_arena_f64(scratch, most, 1),
                 .x = mt_arena_f64(scratch, most, 1),
                 .v = mt_arena_f64(scratch, (size_t)r_most, most),
                 .block = mt_arena_int(scratch, most),
                 .free_sign = mt_arena_alloc(scratch, most, sizeof(bool)),
                 .in = mt_arena_alloc(scratch, most, sizeof(bool)),
                 .p = mt_arena_f64(scratch, n, most),
                 .y = mt_arena_f64(scratch, most, 1),
                 .which = mt_arena_int(scratch, most),
                 .size = mt_norm2(c->n, c->gradient)};
    double *const unit = mt_arena_f64(scratch, (size_t)r_most, 1);
    MT_TRY(mt_arena_check(scratch, err));
    for (int i = 0; i < c->n_rows; i++) {
        memcpy(w.a + (ptrdiff_t)i * c->n, c->rows + (ptrdiff_t)i * c->n, n * sizeof *w.a);
        add_column(&w, c->free_sign[i], -1);
    }
    for (int b = 0; b < c->n_blocks; b++) {
        for (int k = 0; k < c->blocks[b].r; k++) {
            memset(unit, 0, (size_t)r_most * sizeof *unit);
            unit[k] = 1;
            add_atom(&w, b, r_most, unit);
        }
    }
    bool more = true;
    while (more) {
        MT_TRY(least_squares(&w, c->z, err));
        more = false;
        if (w.count + c->n_blocks <= (int)most) {
            MT_TRY(add_atoms(&w, r_most, c->z, &more, err));
        }
    }
    store_multipliers(&w, r_most, c);
    return MT_OK;
}
