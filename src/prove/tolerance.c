/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * How far a design may stray: the largest percentage whose box is proven, by bisection. Boxes
 * are nested and enclosures inclusion monotone, so what is proven for a percentage is proven
 * for all below. Where an input enters K and M, the test may halve its box along such inputs; a
 * half whose very middle fails ends that.
 */
#include "prove/tolerance.h"

#include <math.h>
#include <string.h>

#include "prove/box.h"
#include "prove/boxes.h"

enum { DEFAULT_BOXES = 64, MOST_STEPS = 40 };

/* Bisection ends when the percentage is known to this share of itself, or is below
 * NEARLY_NOTHING. */
static const double RESOLUTION = 1e-4;
static const double NEARLY_NOTHING = 1e-7;

typedef struct tolerance {
    const mt_certify *c;
    const mt_tolerance_question *q;
    int n_edges;
    mt_certify_edge *edges;
    double *lo;
    double *hi;
    bool loose;
    mt_boxes boxes;
    mt_tolerance_end end; /* why the last test failed */
    int open;             /* the edge that it failed at */
    double before;        /* operations */
} tolerance;

static void add_edge(mt_certify_edge *out, int *n, const mt_certify_edge *edge)
{
    if (edge->mode >= 1 && !isnan(edge->hz)) {
        out[(*n)++] = *edge;
    }
}

/* Edges of an assignment and of the limits, without their tolerances: out[2 (n_bands +
 * n_limits)]. Returns their number. */
static int list_edges(const mt_certify *c, const int *assignment, mt_certify_edge *out)
{
    int n = 0;
    for (int i = 0; i < c->n_bands; i++) {
        const mt_certify_band *const band = &c->bands[i];
        mt_certify_edge edge = {band->view, i, -1, assignment[i], band->lower_hz, false};
        add_edge(out, &n, &edge);
        edge.mode++;
        edge.hz = band->upper_hz;
        edge.above = true;
        add_edge(out, &n, &edge);
    }
    for (int i = 0; i < c->n_limits; i++) {
        const mt_certify_limit *const l = &c->limits[i];
        mt_certify_edge edge = {l->view, -1, i, l->mode, l->at_most_hz, false};
        add_edge(out, &n, &edge);
        edge.hz = l->at_least_hz;
        edge.above = true;
        add_edge(out, &n, &edge);
    }
    return n;
}

/* First edge that is not proven to be kept all over the box that is set; -1: all are. */
static int first_open(const mt_certify *c, int n_edges, const mt_certify_edge *edges)
{
    for (int i = 0; i < n_edges; i++) {
        const mt_certify_edge *const edge = &edges[i];
        mt_enclosure *const e = c->views[edge->view];
        const double lambda = mt_enclosure_lambda(edge->hz);
        const bool kept = edge->above ? mt_enclosure_most_below(e, lambda) < edge->mode
                                      : mt_enclosure_least_below(e, lambda) >= edge->mode;
        if (!kept) {
            return i;
        }
    }
    return -1;
}

static double operations(const mt_certify *c)
{
    double sum = 0.0;
    for (int v = 0; v < c->n_views; v++) {
        sum += c->views[v]->operations;
    }
    return sum;
}

static bool spent(const tolerance *t)
{
    const double most = t->c->max_work > 0.0 ? t->c->max_work : MT_CERTIFY_WORK;
    return operations(t->c) - t->before >= most;
}

/* Store which stiffnesses are positive all over the current box. */
static void note_held(mt_enclosure *e)
{
    for (int i = 0; i < e->n_coefficients; i++) {
        e->coefficients[i].held =
            e->coefficients[i].part[MT_STIFFNESS].count > 0 && e->value[MT_LOW][i] > 0.0;
    }
}

/* True where those are positive all over the box set later. Where one is not, a design of that
 * box may have an additional rigid-body mode. */
static bool keeps_held(const mt_enclosure *e)
{
    bool keeps = true;
    for (int i = 0; i < e->n_coefficients; i++) {
        keeps = keeps && (!e->coefficients[i].held || e->value[MT_LOW][i] > 0.0);
    }
    return keeps;
}

/* True where the box is set and every edge kept over it. Notes why not. */
static bool box_holds(tolerance *t, const double *lo, const double *hi)
{
    if (spent(t)) {
        t->end = MT_TOLERANCE_BUDGET;
        return false;
    }
    bool set = mt_certify_set(t->c, lo, hi);
    for (int v = 0; v < t->c->n_views; v++) { /* every stiffness is still there all over it */
        set = set && keeps_held(t->c->views[v]);
    }
    if (!set) {
        t->end = MT_TOLERANCE_DOMAIN;
        return false;
    }
    t->open = first_open(t->c, t->n_edges, t->edges);
    t->end = MT_TOLERANCE_EDGE;
    return t->open < 0;
}

static bool holds(tolerance *t, double percent, int alone)
{
    const mt_tolerance_question *const q = t->q;
    const long most = q->boxes_per_test > 0 ? q->boxes_per_test : DEFAULT_BOXES;
    for (int i = 0; i < t->c->n; i++) {
        const double half =
            alone >= 0 && alone != i
                ? 0.0
                : percent / 100.0 * fabs(q->unit == NULL ? q->x[i] : q->unit[i]);
        t->lo[i] = q->x[i] - half;
        t->hi[i] = q->x[i] + half;
    }
    if (box_holds(t, t->lo, t->hi)) {
        return true;
    }
    if (!t->loose || t->end != MT_TOLERANCE_EDGE) {
        return false;
    }
    mt_boxes_start(&t->boxes, t->lo, t->hi, t->boxes.now_known);
    for (long n = 0; mt_boxes_pop(&t->boxes); n++) {
        if (box_holds(t, t->boxes.now_lo, t->boxes.now_hi)) {
            continue;
        }
        const int open = t->open;
        if (n >= most || !box_holds(t, t->boxes.middle, t->boxes.middle)) {
            return false;
        }
        if (!mt_boxes_split(&t->boxes)) {
            t->open = open;
            return false;
        }
    }
    return true;
}

/* known: a percentage that is proven already. */
static mt_tolerance bisect_tolerance(tolerance *t, int alone, double known)
{
    mt_tolerance out = {.percent = t->q->most_percent, .end = MT_TOLERANCE_MOST};
    if (known >= t->q->most_percent || holds(t, t->q->most_percent, alone)) {
        return out;
    }
    double low = 0.0;
    double high = t->q->most_percent;
    out.end = t->end;
    out.edge = t->end == MT_TOLERANCE_EDGE ? t->edges[t->open] : out.edge;
    bool at_all = known > 0.0 || holds(t, 0.0, alone);
    if (!at_all) {
        high = 0.0;
        out.end = t->end;
        out.edge = t->end == MT_TOLERANCE_EDGE ? t->edges[t->open] : out.edge;
    }
    for (int i = 0; i < MOST_STEPS && high - low > RESOLUTION * high && high > NEARLY_NOTHING;
         i++) {
        const double middle = 0.5 * (low + high);
        if (middle <= known || holds(t, middle, alone)) {
            low = middle;
            continue;
        }
        high = middle;
        out.end = t->end;
        out.edge = t->end == MT_TOLERANCE_EDGE ? t->edges[t->open] : out.edge;
    }
    out.percent = low;
    return out;
}

static mt_status find_tolerances(const mt_certify *c, const mt_tolerance_question *q,
                                 mt_arena *scratch, mt_tolerance *all, mt_tolerance *each,
                                 mt_err *err)
{
    tolerance t = {.c = c, .q = q, .open = -1, .before = operations(c)};
    t.edges = mt_arena_alloc(scratch, 2 * ((size_t)c->n_bands + (size_t)c->n_limits) + 1,
                             sizeof *t.edges);
    t.lo = mt_arena_f64(scratch, (size_t)c->n, 1);
    t.hi = mt_arena_f64(scratch, (size_t)c->n, 1);
    MT_TRY(mt_arena_check(scratch, err));
    t.n_edges = list_edges(c, q->assignment, t.edges);
    MT_TRY(mt_boxes_init(&t.boxes, c, true, 0, scratch, err));
    for (int i = 0; i < c->n; i++) {
        t.loose = t.loose || t.boxes.active[i];
    }
    if (mt_certify_set(c, q->x, q->x)) {
        for (int v = 0; v < c->n_views; v++) {
            note_held(c->views[v]);
        }
    }
    *all = bisect_tolerance(&t, -1, 0.0);
    for (int i = 0; i < c->n && each != NULL; i++) {
        each[i] = bisect_tolerance(&t, i, all->percent); /* its box lies in that of all */
    }
    return MT_OK;
}

mt_status mt_certify_tolerance(const mt_certify *c, const mt_tolerance_question *q,
                               mt_arena *scratch, mt_tolerance *all, mt_tolerance *each,
                               mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = find_tolerances(c, q, scratch, all, each, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}
