/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Douglas and Peucker's choice of points, the farthest first (The Canadian Cartographer 10
 * (1973) 112-122): between two points that are kept a picture has ln |H| and the phase (turned
 * on, not wrapped) straight over x = ln w, and the point in between that lies farthest from
 * that,
 *     d = hypot(ln |H| - line, arg H - line) ~ |H - drawn| / |H|,
 * is kept next, until none is farther than DRAWN.
 */
#include <math.h>
#include <string.h>

#include "response/curve.h"

/* Of |H|: two thirds of a line's width where a decade is 2 cm. */
static const double DRAWN = 0.02;
static const double TURN = 6.283185307179586477;

typedef struct span {
    int a; /* kept neighbours, by their places in the list of usable points */
    int b;
    int worst; /* in between; -1: none beyond DRAWN */
    double off;
} span;

typedef struct thinning {
    int n; /* usable points */
    int *index;
    double *x;
    double *y;     /* ln |H| */
    double *phase; /* turned on */
    bool *keep;
} thinning;

static span find_worst_point(const thinning *t, int a, int b)
{
    span s = {.a = a, .b = b, .worst = -1, .off = DRAWN};
    const double l = t->x[b] - t->x[a];
    for (int i = a + 1; i < b && l > 0.0; i++) {
        const double part = (t->x[i] - t->x[a]) / l;
        const double y = t->y[a] + (part * (t->y[b] - t->y[a]));
        const double phase = t->phase[a] + (part * (t->phase[b] - t->phase[a]));
        const double off = hypot(t->y[i] - y, t->phase[i] - phase);
        if (off > s.off) {
            s.off = off;
            s.worst = i;
        }
    }
    return s;
}

static void list_points(const mt_curve *c, int pair, int pairs, thinning *t)
{
    for (int i = 0; i < c->n; i++) {
        const double complex h = c->h[pair + ((ptrdiff_t)i * pairs)];
        const double size = cabs(h);
        if (!isfinite(size) || !(size > 0.0)) {
            continue;
        }
        const int k = t->n++;
        t->index[k] = i;
        t->x[k] = log(c->w[i]);
        t->y[k] = log(size);
        t->phase[k] = carg(h);
        if (k > 0) {
            t->phase[k] -= TURN * round((t->phase[k] - t->phase[k - 1]) / TURN);
        }
    }
}

/* Ends, peaks and antiresonances, and both neighbours of what has no value. */
static void keep_fixed(const mt_curve *c, int pair, thinning *t)
{
    for (int k = 0; k < t->n; k++) {
        t->keep[k] = k == 0 || k == t->n - 1 || t->index[k + 1] != t->index[k] + 1 ||
                     t->index[k - 1] != t->index[k] - 1;
    }
    for (int e = 0; e < c->n_extremes; e++) {
        const mt_extreme *const x = &c->extremes[e];
        for (int k = 0; k < t->n && x->pair == pair; k++) {
            const bool next =
                k + 1 < t->n && c->w[t->index[k]] < x->w && c->w[t->index[k + 1]] > x->w;
            t->keep[k] = t->keep[k] || c->w[t->index[k]] == x->w || (x->infinite && next);
            if (x->infinite && next) {
                t->keep[k + 1] = true;
            }
        }
    }
}

static void divide(thinning *t, int n_spans, span *spans, int most)
{
    for (int kept = n_spans + 1; kept < most; kept++) {
        int which = 0;
        for (int i = 1; i < n_spans; i++) {
            which = spans[i].off > spans[which].off ? i : which;
        }
        const span s = spans[which];
        if (n_spans == 0 || s.worst < 0) {
            return;
        }
        t->keep[s.worst] = true;
        spans[which] = find_worst_point(t, s.a, s.worst);
        spans[n_spans++] = find_worst_point(t, s.worst, s.b);
    }
}

mt_status mt_curve_thin(const mt_curve *c, int pair, int pairs, int most, mt_arena *mem, int *n,
                        int **kept, mt_err *err)
{
    const size_t room = (size_t)c->n + 1;
    thinning t = {.index = mt_arena_int(mem, room),
                  .x = mt_arena_f64(mem, room, 1),
                  .y = mt_arena_f64(mem, room, 1),
                  .phase = mt_arena_f64(mem, room, 1),
                  .keep = mt_arena_alloc(mem, room, sizeof *t.keep)};
    span *const spans = mt_arena_alloc(mem, room + (size_t)most, sizeof *spans);
    *kept = mt_arena_int(mem, room);
    *n = 0;
    MT_TRY(mt_arena_check(mem, err));
    list_points(c, pair, pairs, &t);
    keep_fixed(c, pair, &t);
    int n_spans = 0;
    for (int k = 1, last = 0; k < t.n; k++) {
        if (t.keep[k]) {
            spans[n_spans++] = find_worst_point(&t, last, k);
            last = k;
        }
    }
    divide(&t, n_spans, spans, most);
    for (int k = 0; k < t.n; k++) {
        if (t.keep[k]) {
            (*kept)[(*n)++] = t.index[k];
        }
    }
    return MT_OK;
}
