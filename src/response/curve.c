/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * With x = w or log w and g = d log |H| / dx = Re(H'/H) dw/dx at both ends of an interval of
 * length l, the cubic that has values and slopes there leaves the straight line by at most
 * about
 *     l |g_a - g_b| / 8        (bent)
 *     l |(y_b - y_a)/l - (g_a + g_b)/2| / 8    (bent to and fro),
 * so that nothing has to be computed to know that an interval is fine. Where g changes its sign
 * there is a maximum or minimum between: a root of Re(conj(H) H'), which is smooth also where H
 * goes through 0.
 */
#include "response/curve.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;
static const double HALF_TURN_DEG = 180.0;
/* What a straight line in log |H| may be off by. */
static const double BENT = 0.01;
/* Intervals are not divided below this part of their frequency: at an undamped pole or zero log
 * |H| has no bottom. */
static const double FINEST = 1e-5;
/* Steps about a pole, in half widths; one without width is looked at from this part of its
 * frequency on. */
static const double FIRST_STEP = 0.5;
static const double STEP_FACTOR = 2.0;
static const double NO_WIDTH = 1e-6;
enum { PASSES = 40, ROOT_STEPS = 100 };

typedef struct point {
    double w;
    mt_sample at;
} point;

typedef struct trace {
    const mt_transfer *t;
    const mt_curve_options *opt;
    mt_arena *mem;
    ptrdiff_t pairs;
    int n;
    int room;
    point *points;
    int n_extremes;
    int extreme_room;
    mt_extreme *extremes;
} trace;

static mt_status add_point(trace *c, double w, mt_err *err)
{
    if (!(w >= c->opt->from && w <= c->opt->to)) {
        return MT_OK;
    }
    c->points = mt_arena_grow(c->mem, c->points, c->n, &c->room, sizeof *c->points);
    const size_t pairs = (size_t)c->pairs;
    const point p = {.w = w,
                     .at = {.h = mt_arena_alloc(c->mem, pairs, sizeof *p.at.h),
                            .dh = mt_arena_alloc(c->mem, pairs, sizeof *p.at.dh),
                            .error = mt_arena_f64(c->mem, pairs, 1)}};
    MT_TRY(mt_arena_check(c->mem, err));
    MT_TRY(mt_interrupt_check(c->opt->interrupt, err));
    MT_TRY(mt_transfer_at(c->t, w, &p.at, c->mem, err));
    c->points[c->n++] = p;
    return MT_OK;
}

static int by_w(const void *a, const void *b)
{
    const double left = ((const point *)a)->w;
    const double right = ((const point *)b)->w;
    return (left > right) - (left < right);
}

/* Ascending, no two alike. */
static void tidy(trace *c)
{
    int kept = 0;
    if (c->n > 0) {
        qsort(c->points, (size_t)c->n, sizeof *c->points, by_w);
    }
    for (int i = 0; i < c->n; i++) {
        if (kept == 0 || c->points[i].w > c->points[kept - 1].w) {
            c->points[kept++] = c->points[i];
        }
    }
    c->n = kept;
}

double mt_phase_deg(double complex h)
{
    const double size = cabs(h);
    return isfinite(size) && size > 0.0 ? carg(h) / PI * HALF_TURN_DEG : nan("");
}

double mt_curve_grid(const mt_curve_options *opt, int i)
{
    const double part = (double)i / (double)(opt->points - 1);
    if (i == 0 || i == opt->points - 1) {
        return i == 0 ? opt->from : opt->to;
    }
    return opt->log ? opt->from * pow(opt->to / opt->from, part)
                    : opt->from + (part * (opt->to - opt->from));
}

static mt_status add_grid(trace *c, mt_err *err)
{
    for (int i = 0; i < c->opt->points; i++) {
        MT_TRY(add_point(c, mt_curve_grid(c->opt, i), err));
    }
    return MT_OK;
}

/* Points about a pole, by its width. */
static mt_status add_pole(trace *c, double complex s, mt_err *err)
{
    const double w = fabs(cimag(s));
    const double half = fmax(fabs(creal(s)), NO_WIDTH * w);
    if (!(cimag(s) > 0.0) || half > w || w - half > c->opt->to || w + half < c->opt->from) {
        return MT_OK;
    }
    if (half > NO_WIDTH * w) {
        MT_TRY(add_point(c, w, err));
    }
    double step = FIRST_STEP * half;
    while (step < 0.5 * w) {
        MT_TRY(add_point(c, w - step, err));
        MT_TRY(add_point(c, w + step, err));
        step *= STEP_FACTOR;
    }
    return MT_OK;
}

static bool is_known_response(const mt_sample *s, ptrdiff_t pair)
{
    const double size = cabs(s->h[pair]);
    return isfinite(size) && size > s->error[pair];
}

static bool is_infinite(const mt_sample *s, ptrdiff_t pair)
{
    return isinf(creal(s->h[pair])) != 0;
}

/* d log |H| / dw. */
static double slope_of(const mt_sample *s, ptrdiff_t pair)
{
    return creal(s->dh[pair] / s->h[pair]);
}

static bool is_bent(const trace *c, const point *a, const point *b)
{
    const double l = c->opt->log ? log(b->w / a->w) : b->w - a->w;
    for (ptrdiff_t p = 0; p < c->pairs; p++) {
        if (!is_known_response(&a->at, p) || !is_known_response(&b->at, p)) {
            continue;
        }
        const double ga = slope_of(&a->at, p) * (c->opt->log ? a->w : 1.0);
        const double gb = slope_of(&b->at, p) * (c->opt->log ? b->w : 1.0);
        const double rise = log(cabs(b->at.h[p]) / cabs(a->at.h[p]));
        const double off = (fabs(ga - gb) + fabs((rise / l) - (0.5 * (ga + gb)))) * 0.125 * l;
        if (off > BENT) {
            return true;
        }
    }
    return false;
}

/* Halves once every interval that needs it. */
static mt_status halve(trace *c, mt_err *err)
{
    const int had = c->n;
    for (int i = 0; i + 1 < had && c->n < MT_CURVE_MOST; i++) {
        const double a = c->points[i].w;
        const double b = c->points[i + 1].w;
        if (b - a > FINEST * b && is_bent(c, &c->points[i], &c->points[i + 1])) {
            MT_TRY(add_point(c, c->opt->log ? sqrt(a * b) : 0.5 * (a + b), err));
        }
    }
    return MT_OK;
}

static mt_status refine_curve(trace *c, mt_err *err)
{
    int had = 0;
    for (int pass = 0; pass < PASSES && c->n > had && c->n < MT_CURVE_MOST; pass++) {
        had = c->n;
        MT_TRY(halve(c, err));
        tidy(c);
    }
    return MT_OK;
}

/* Re(conj(H) H'): half the slope of |H|^2. */
static double rise_of(const mt_sample *s, ptrdiff_t pair)
{
    return (creal(s->h[pair]) * creal(s->dh[pair])) + (cimag(s->h[pair]) * cimag(s->dh[pair]));
}

/* The undamped pole between a and b; 0: none. */
static double infinite_between(const trace *c, double a, double b)
{
    for (int k = 0; k < c->opt->n_poles; k++) {
        const double complex s = c->opt->poles[k];
        if (fabs(creal(s)) <= DBL_EPSILON * cabs(s) && cimag(s) > a && cimag(s) < b) {
            return cimag(s);
        }
    }
    return 0.0;
}

/* Root of rise_of between a and b, with values fa and fb of opposite signs: regula falsi that
 * halves the value of an end that stays (Illinois), bisection where that is slow. */
static mt_status polish(trace *c, ptrdiff_t pair, double ends[2], double rise[2], mt_sample *at,
                        double *w, mt_err *err)
{
    int side = -1;
    for (int step = 0; step < ROOT_STEPS; step++) {
        double x = ((ends[0] * rise[1]) - (ends[1] * rise[0])) / (rise[1] - rise[0]);
        if (!(x > ends[0] && x < ends[1]) || step % 3 == 2) {
            x = 0.5 * (ends[0] + ends[1]);
        }
        *w = x;
        MT_TRY(mt_transfer_at(c->t, x, at, c->mem, err));
        const double f = rise_of(at, pair);
        if (!(ends[1] - ends[0] > 2.0 * DBL_EPSILON * x) || f == 0.0 || !isfinite(f)) {
            return MT_OK;
        }
        const int which = (f > 0.0) == (rise[0] > 0.0) ? 0 : 1;
        ends[which] = x;
        rise[which] = f;
        rise[1 - which] *= side == which ? 0.5 : 1.0;
        side = which;
    }
    return MT_OK;
}

static mt_status append_extreme(trace *c, const mt_extreme *e, mt_err *err)
{
    c->extremes = mt_arena_grow(c->mem, c->extremes, c->n_extremes, &c->extreme_room,
                                sizeof *c->extremes);
    MT_TRY(mt_arena_check(c->mem, err));
    c->extremes[c->n_extremes++] = *e;
    return MT_OK;
}

/* True for a minimum next to a zero. There H is about linear, |H| at an end of the interval
 * about |H'| times how far it is; where H turns round instead, H' is small. */
static bool is_zero(const mt_extreme *e, const point *a, const point *b, double complex dh)
{
    const point *const far = b->w - e->w > e->w - a->w ? b : a;
    const double rise = cabs(far->at.h[e->pair]) - cabs(e->h);
    return cabs(e->h) <= e->error || cabs(dh) * fabs(far->w - e->w) > 0.5 * rise;
}

static mt_status extreme(trace *c, const point *a, const point *b, ptrdiff_t pair, mt_err *err)
{
    const bool at_pole = is_infinite(&a->at, pair) || is_infinite(&b->at, pair);
    if (at_pole || (!is_known_response(&a->at, pair) && !is_known_response(&b->at, pair))) {
        return MT_OK;
    }
    double rise[2] = {rise_of(&a->at, pair), rise_of(&b->at, pair)};
    if (!((rise[0] > 0.0 && rise[1] < 0.0) || (rise[0] < 0.0 && rise[1] > 0.0))) {
        return MT_OK;
    }
    mt_extreme e = {.pair = (int)pair, .peak = rise[0] > 0.0};
    const double pole = infinite_between(c, a->w, b->w);
    if (e.peak && pole > 0.0) {
        e.infinite = true;
        e.w = pole;
        return append_extreme(c, &e, err);
    }
    const size_t pairs = (size_t)c->pairs;
    const mt_arena_mark mark = mt_arena_get_mark(c->mem);
    mt_sample at = {.h = mt_arena_alloc(c->mem, pairs, sizeof *at.h),
                    .dh = mt_arena_alloc(c->mem, pairs, sizeof *at.dh),
                    .error = mt_arena_f64(c->mem, pairs, 1)};
    double ends[2] = {a->w, b->w};
    MT_TRY(mt_arena_check(c->mem, err));
    MT_TRY(polish(c, pair, ends, rise, &at, &e.w, err));
    e.h = at.h[pair];
    e.error = at.error[pair];
    e.antiresonance = !e.peak && is_zero(&e, a, b, at.dh[pair]);
    mt_arena_rewind(c->mem, mark);
    return append_extreme(c, &e, err);
}

static int by_extreme(const void *a, const void *b)
{
    const mt_extreme *const l = a;
    const mt_extreme *const r = b;
    return l->pair != r->pair ? (l->pair > r->pair) - (l->pair < r->pair)
                              : (l->w > r->w) - (l->w < r->w);
}

/* Of one pair: between points, and points that are resonances themselves. */
static mt_status extremes_of(trace *c, ptrdiff_t pair, int n, mt_err *err)
{
    for (int i = 0; i < n; i++) {
        const mt_extreme own = {
            .pair = (int)pair, .peak = true, .infinite = true, .w = c->points[i].w};
        if (is_infinite(&c->points[i].at, pair)) {
            MT_TRY(append_extreme(c, &own, err));
        }
        if (i + 1 < n) {
            MT_TRY(extreme(c, &c->points[i], &c->points[i + 1], pair, err));
        }
    }
    return MT_OK;
}

static mt_status find_extremes(trace *c, mt_err *err)
{
    const int n = c->n;
    for (ptrdiff_t p = 0; p < c->pairs; p++) {
        MT_TRY(mt_interrupt_check(c->opt->interrupt, err));
        MT_TRY(extremes_of(c, p, n, err));
    }
    if (c->n_extremes > 0) {
        qsort(c->extremes, (size_t)c->n_extremes, sizeof *c->extremes, by_extreme);
    }
    for (int k = 0; k < c->n_extremes && !c->opt->grid && c->n < MT_CURVE_MOST; k++) {
        if (!c->extremes[k].infinite) {
            MT_TRY(add_point(c, c->extremes[k].w, err));
        }
    }
    tidy(c);
    return MT_OK;
}

static mt_status hand_out(const trace *c, mt_curve *out, mt_err *err)
{
    const size_t n = (size_t)c->n;
    const size_t pairs = (size_t)c->pairs;
    *out = (mt_curve){.n = c->n,
                      .w = mt_arena_f64(c->mem, n, 1),
                      .h = mt_arena_alloc(c->mem, n * pairs, sizeof *out->h),
                      .error = mt_arena_f64(c->mem, n, pairs),
                      .n_extremes = c->n_extremes,
                      .extremes = c->extremes,
                      .complete = c->n < MT_CURVE_MOST};
    MT_TRY(mt_arena_check(c->mem, err));
    for (ptrdiff_t i = 0; i < c->n; i++) {
        out->w[i] = c->points[i].w;
        for (ptrdiff_t p = 0; p < c->pairs; p++) {
            out->h[p + (i * c->pairs)] = c->points[i].at.h[p];
            out->error[p + (i * c->pairs)] = c->points[i].at.error[p];
        }
    }
    return MT_OK;
}

mt_status mt_curve_trace(const mt_transfer *t, const mt_curve_options *opt, mt_arena *mem,
                         mt_curve *out, mt_err *err)
{
    trace c = {.t = t, .opt = opt, .mem = mem, .pairs = (ptrdiff_t)t->n_in * t->n_out};
    MT_TRY(add_grid(&c, err));
    for (int k = 0; k < opt->n_poles && !opt->grid; k++) {
        MT_TRY(add_pole(&c, opt->poles[k], err));
    }
    tidy(&c);
    if (!opt->grid) {
        MT_TRY(refine_curve(&c, err));
    }
    MT_TRY(find_extremes(&c, err));
    return hand_out(&c, out, err);
}

/*
 * Douglas and Peucker's choice of points, the farthest first (The Canadian Cartographer 10
 * (1973) 112-122): between two points that are kept a picture has ln |H| and the phase (turned
 * on, not wrapped) straight over x = ln w, and the point in between that lies farthest from
 * that,
 *     d = hypot(ln |H| - line, arg H - line) ~ |H - drawn| / |H|,
 * is kept next, until none is farther than DRAWN.
 */

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
