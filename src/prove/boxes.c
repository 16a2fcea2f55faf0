/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stack of boxes. */
#include "prove/boxes.h"

#include <math.h>
#include <string.h>

#include "prove/box.h"

/* A variable is bisected this often at most: 2^-40 of the bounds, far below any tolerance. */
enum { MOST_DEPTH = 40 };

/* True where input i enters K or M. */
static bool enters(const mt_enclosure *e, int i)
{
    return e->in[MT_STIFFNESS][i] || e->in[MT_MASS][i];
}

static bool depends(const mt_certify *c, int i, bool loose_only, const bool *bound)
{
    bool any = !loose_only && bound[i];
    for (int v = 0; v < c->n_views; v++) {
        any = any || (loose_only ? mt_enclosure_loose(c->views[v], i) : enters(c->views[v], i));
    }
    return any;
}

static mt_status alloc_box_stack(mt_boxes *b, mt_arena *mem, mt_err *err)
{
    const size_t n = (size_t)b->n;
    const size_t most = (size_t)b->capacity;
    b->lo = mt_arena_f64(mem, most, n);
    b->hi = mt_arena_f64(mem, most, n);
    b->depth = mt_arena_alloc(mem, most, n);
    b->active = mt_arena_alloc(mem, n, sizeof(bool));
    b->logarithmic = mt_arena_alloc(mem, n, sizeof(bool));
    b->known = mt_arena_alloc(mem, most * ((size_t)b->n_known + 1), sizeof *b->known);
    b->now_known = mt_arena_int(mem, (size_t)b->n_known + 1);
    b->now_lo = mt_arena_f64(mem, n, 1);
    b->now_hi = mt_arena_f64(mem, n, 1);
    b->now_depth = mt_arena_alloc(mem, n, sizeof(signed char));
    b->split = mt_arena_f64(mem, n, 1);
    b->middle = mt_arena_f64(mem, n, 1);
    b->beyond = mt_arena_f64(mem, n, 1);
    return mt_arena_check(mem, err);
}

mt_status mt_boxes_init(mt_boxes *b, const mt_certify *c, bool loose_only, int n_known,
                        mt_arena *mem, mt_err *err)
{
    *b = (mt_boxes){.n = c->n,
                    .capacity = (MOST_DEPTH * c->n) + 2,
                    .n_known = n_known,
                    .n_catalogue = loose_only ? NULL : c->n_catalogue,
                    .catalogue = c->catalogue,
                    .n_rows = loose_only ? 0 : c->n_rows,
                    .rows = c->rows};
    MT_TRY(alloc_box_stack(b, mem, err));
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    bool *const bound = mt_arena_alloc(mem, (size_t)c->n, sizeof *bound);
    bool *const one = mt_arena_alloc(mem, (size_t)c->n, sizeof *one);
    MT_TRY(mt_arena_check(mem, err));
    for (int k = 0; k < c->n_bounds; k++) {
        mt_program_depends(c->program, c->bounds[k].node, one);
        for (int i = 0; i < c->n; i++) {
            bound[i] = bound[i] || one[i];
        }
    }
    for (int i = 0; i < c->n; i++) {
        b->active[i] = (c->cap != NULL && !loose_only) || depends(c, i, loose_only, bound);
        b->logarithmic[i] = c->scale == NULL || isnan(c->scale[i]);
    }
    mt_arena_rewind(mem, mark);
    return MT_OK;
}

static bool is_discrete(const mt_boxes *b, int i)
{
    return b->n_catalogue != NULL && b->n_catalogue[i] > 0;
}

/* Number of values of input i's catalogue below x (all: or equal to it). */
static int rank_of(const mt_boxes *b, int i, double x, bool or_equal)
{
    const double *const v = b->catalogue[i];
    int low = 0;
    int high = b->n_catalogue[i];
    while (low < high) {
        const int middle = low + ((high - low) / 2);
        if (v[middle] < x || (or_equal && v[middle] == x)) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

void mt_boxes_start(mt_boxes *b, const double *lower, const double *upper, const int *known)
{
    b->count = 1;
    memcpy(b->known, known, (size_t)b->n_known * sizeof *known);
    for (int i = 0; i < b->n; i++) {
        b->lo[i] = lower[i];
        b->hi[i] = upper[i];
        b->depth[i] = 0;
        if (is_discrete(b, i)) {
            const int first = rank_of(b, i, lower[i], false);
            const int end = rank_of(b, i, upper[i], true);
            b->count = first < end ? b->count : 0;
            b->lo[i] = first < end ? b->catalogue[i][first] : lower[i];
            b->hi[i] = first < end ? b->catalogue[i][end - 1] : upper[i];
        }
    }
}

/* The point at which the popped box is halved. */
static void find_middle(mt_boxes *b, int i)
{
    if (is_discrete(b, i)) {
        const int first = rank_of(b, i, b->now_lo[i], false);
        const int last = rank_of(b, i, b->now_hi[i], false);
        const int middle = first + ((last - first) / 2);
        b->split[i] = b->catalogue[i][middle];
        b->beyond[i] = middle < last ? b->catalogue[i][middle + 1] : b->split[i];
        return;
    }
    const double lo = b->now_lo[i];
    const double hi = b->now_hi[i];
    const double m =
        b->logarithmic[i] && lo > 0.0 ? sqrt(lo) * sqrt(hi) : lo + (0.5 * (hi - lo));
    b->split[i] = fmin(fmax(m, lo), hi);
    b->beyond[i] = b->split[i];
}

static bool is_within(const mt_certify_rows *r, const double *row, const double *lo,
                      const double *hi)
{
    bool within = true;
    for (int k = 0; k < r->n && within; k++) {
        within = row[k] >= lo[r->first + k] && row[k] <= hi[r->first + k];
    }
    return within;
}

/* Closes the popped box around the rows within it; false: there is none. */
static bool close_around_rows(mt_boxes *b, const mt_certify_rows *r)
{
    double *const lo = b->now_lo + r->first;
    double *const hi = b->now_hi + r->first;
    bool any = false;
    for (int i = 0; i < r->n_rows; i++) {
        const double *const row = r->value + ((ptrdiff_t)i * r->n);
        if (!is_within(r, row, b->now_lo, b->now_hi)) {
            continue;
        }
        for (int k = 0; k < r->n; k++) {
            b->middle[r->first + k] = any ? fmin(b->middle[r->first + k], row[k]) : row[k];
            b->split[r->first + k] = any ? fmax(b->split[r->first + k], row[k]) : row[k];
        }
        any = true;
    }
    for (int k = 0; k < r->n && any; k++) {
        lo[k] = b->middle[r->first + k];
        hi[k] = b->split[r->first + k];
    }
    return any;
}

/* The row nearest to where the box is halved, in parts of its widths; the first of equal
 * ones. */
static void find_middle_row(mt_boxes *b, const mt_certify_rows *r)
{
    double least = HUGE_VAL;
    for (int i = 0; i < r->n_rows; i++) {
        const double *const row = r->value + ((ptrdiff_t)i * r->n);
        double away = 0.0;
        for (int k = 0; k < r->n; k++) {
            const double width = b->now_hi[r->first + k] - b->now_lo[r->first + k];
            away += width > 0.0 ? fabs(row[k] - b->split[r->first + k]) / width : 0.0;
        }
        if (away < least && is_within(r, row, b->now_lo, b->now_hi)) {
            least = away;
            memcpy(b->middle + r->first, row, (size_t)r->n * sizeof *row);
        }
    }
}

static int *known_of(const mt_boxes *b, int box)
{
    return b->known + ((ptrdiff_t)box * b->n_known);
}

/* The last box of the stack; false: there is none. */
static bool take_box(mt_boxes *b)
{
    const size_t n = (size_t)b->n;
    if (b->count == 0) {
        return false;
    }
    b->count--;
    const size_t at = (size_t)b->count * n;
    memcpy(b->now_known, known_of(b, b->count), (size_t)b->n_known * sizeof *b->known);
    if (n == 0) {
        return true;
    }
    memcpy(b->now_lo, b->lo + at, n * sizeof *b->lo);
    memcpy(b->now_hi, b->hi + at, n * sizeof *b->hi);
    memcpy(b->now_depth, b->depth + at, n);
    return true;
}

bool mt_boxes_pop(mt_boxes *b)
{
    bool empty = true;
    while (empty && take_box(b)) {
        empty = false;
        for (int k = 0; k < b->n_rows && !empty; k++) {
            empty = !close_around_rows(b, &b->rows[k]);
        }
    }
    for (int i = 0; i < b->n && !empty; i++) {
        find_middle(b, i);
        b->middle[i] = b->split[i];
    }
    for (int k = 0; k < b->n_rows && !empty; k++) {
        find_middle_row(b, &b->rows[k]);
    }
    return !empty;
}

static void push_half(mt_boxes *b, int split, bool upper_half)
{
    const size_t n = (size_t)b->n;
    const size_t at = (size_t)b->count * n;
    memcpy(b->lo + at, b->now_lo, n * sizeof *b->lo);
    memcpy(b->hi + at, b->now_hi, n * sizeof *b->hi);
    memcpy(b->depth + at, b->now_depth, n);
    memcpy(known_of(b, b->count), b->now_known, (size_t)b->n_known * sizeof *b->known);
    if (upper_half) {
        b->lo[at + (size_t)split] = b->beyond[split];
    } else {
        b->hi[at + (size_t)split] = b->split[split];
    }
    b->depth[at + (size_t)split]++;
    b->count++;
}

bool mt_boxes_split(mt_boxes *b)
{
    int widest = -1;
    for (int i = 0; i < b->n; i++) {
        const bool inside = b->now_lo[i] < b->split[i] && b->split[i] < b->now_hi[i];
        const bool values = is_discrete(b, i) && b->now_lo[i] < b->now_hi[i];
        const bool can = b->active[i] && b->now_depth[i] < MOST_DEPTH && (values || inside);
        if (can && (widest < 0 || b->now_depth[i] < b->now_depth[widest])) {
            widest = i;
        }
    }
    if (widest < 0 || b->count + 2 > b->capacity) {
        return false;
    }
    push_half(b, widest, true);
    push_half(b, widest, false);
    return true;
}

bool mt_certify_set(const mt_certify *c, const double *lo, const double *hi)
{
    bool known = true;
    for (int v = 0; v < c->n_views && known; v++) {
        known = mt_enclosure_set(c->views[v], lo, hi);
    }
    return known;
}
