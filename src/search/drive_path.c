/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Room of an edge at frequency f_e with margin, of the mode f that the assignment keeps on one
 * side of it:
 *     r(s) = ln(f / f_e)  above,   ln(f_e / f)  below,      dr/ds = +- lambda' / (2 lambda),
 *         lambda' = y^T (dK/ds - lambda dM/ds) y.
 * Modes are sorted, so of each band with k modes below it mode k and mode k + 1 are enough. An
 * interval [a, b] of neighbouring positions is fine where for every edge
 *     max(|r(b) - r(a)|, (b - a)|r'(a)|,
 *         (b - a)|r'(b)|) <= 1/10 max(min(|c(a)|, |c(b)|), 1e-3),
 * c: the room without the margin; else its middle is looked at. The cubic with these values and
 * slopes has its least value within the interval at a root of a quadratic; where that is below
 * the least room so far, it is the next position: the least room is then known to the fourth
 * order of the step.
 */
#include "search/drive_path.h"

#include <math.h>
#include <string.h>

#include "base/number.h"
#include "base/run.h"
#include "mechanics/products.h"
#include "problem/configuration.h"

static const double PART = 0.1;     /* of a clearance, between two positions */
static const double NEAREST = 1e-3; /* clearances (ln) below it count as it */
/* an improvement of the least room (ln) that is not worth a position */
static const double CLOSER = 1e-8;
/* Rooms that differ by less are equal: what searches and rounding leave open. */
static const double EQUAL_ROOM = MT_RATIO_NOISE;
static const double SHORTEST = 1e-7; /* of the motion: intervals that are not halved */
/* a new position keeps this part of the interval from its ends */
static const double AWAY = 0.05;
static const double STEP = 0.05;  /* longest interval at first [rad, model lengths] */
static const double SAME = 1e-12; /* positions nearer than this [rad, model lengths] are one */
enum { INTERVALS_AT_FIRST = 8, INTERVALS_MOST_AT_FIRST = 64, POSITIONS_MOST = 2000 };
/* Of a way whatever the budget: its ends and one between. */
enum { POSITIONS_LEAST = 3 };

typedef struct edge {
    int mode;
    bool above;
    double sign;
    double log_hz;      /* ln of the edge with margin */
    double log_base_hz; /* without */
    const mt_band_along_path *band;
} edge;

typedef struct sample {
    double at;
    int next;
    bool good;
    double *room;  /* [n_edges] */
    double *slope; /* [n_edges] NaN: a repeated mode, or one of 0 Hz */
} sample;

typedef struct walk {
    mt_workspace *ws;
    mt_analysis *a;
    mt_arena *mem;
    double *inputs; /* [n + 1] */
    double unit;    /* 1 rad, or the model length */
    double shortest;
    int n_edges;
    edge *edges;
    int highest;     /* mode of an edge */
    sample *samples; /* of one way */
    int n;
    int most; /* positions of one way */
    mt_drive_path *out;
    int way;
} walk;

static bool ends(mt_status rc)
{
    return mt_is_final(rc) || rc == MT_E_INTERRUPTED;
}

const char *mt_drive_path_grade(mt_drive_path_end end)
{
    switch (end) {
    case MT_MOTION_WHOLE:
    case MT_MOTION_NONE:
        break;
    case MT_MOTION_CAPPED:
        return "sampled coarsely";
    case MT_MOTION_BROKEN:
        return "incomplete";
    case MT_MOTION_UNSTABLE:
        return "unstable";
    }
    return "sampled";
}

mt_status mt_drive_path_open(mt_workspace *ws, int drive_positions, mt_err *err)
{
    const mt_drive_positions *const f = &ws->p->families[drive_positions];
    if (f->moving.original == NULL) {
        return mt_fail(err, MT_E_DOMAIN, "%s", f->why);
    }
    if (ws->driven[drive_positions] == NULL) {
        MT_TRY(mt_configuration_analyse(&f->moving, f->moving_at, &ws->driven[drive_positions],
                                        err));
        /* the only slope that is asked for */
        mt_linear_first_input(ws->driven[drive_positions]->lin, ws->p->n);
    }
    return MT_OK;
}

mt_status mt_drive_path_rate(mt_analysis *a, int pos, double *rate, mt_err *err)
{
    const int n = mt_linear_freedoms(a->lin);
    const double *const y = mt_modal_shape(&a->modes, pos);
    int size = 1;
    (void)mt_modal_cluster(&a->modes, pos, &size);
    *rate = nan("");
    if (size > 1 || !(a->modes.lambda[pos] > 0.0)) {
        return MT_OK;
    }
    MT_TRY(mt_linear_products(a->lin, a->sys->n_inputs - 1, 1, y, a->dky, a->dmy, err));
    const double lambda = a->modes.lambda[pos];
    *rate = (mt_dot(n, y, a->dky) - (lambda * mt_dot(n, y, a->dmy))) / (2.0 * lambda);
    return MT_OK;
}

static double base_margin(const edge *e, double room)
{
    return room + (e->sign * (e->log_hz - e->log_base_hz));
}

/* True where `room` at a position is less than the least so far. Of equal margins (both ends of
 * a symmetric travel) the lower position counts, then the first edge. */
static bool is_less(double room, double at, double least, double least_at)
{
    const bool equal = fabs(room - least) <= EQUAL_ROOM;
    return equal ? at < least_at : !(room >= least);
}

static void keep_least(walk *w, const edge *e, double at, double room)
{
    mt_drive_path *const out = w->out;
    const bool named = at == w->samples[0].at || at == w->samples[1].at;
    if (!(room >= out->way_margin[w->way])) {
        out->way_margin[w->way] = room;
        out->way_at[w->way] = named ? nan("") : at;
    }
    if (!is_less(room, at, out->room, out->at)) {
        return;
    }
    const mt_band *const band = &e->band->band;
    const double edge_hz = exp(e->log_base_hz);
    out->room = room;
    out->tolerance = e->band->tolerance;
    out->at = at;
    out->mode = e->mode;
    out->above = e->above;
    out->tie = e->band->tie;
    out->band = *band;
    out->hz = exp(e->log_hz + (e->sign * room));
    out->percent = mt_edge_clearance_percent(edge_hz, e->sign < 0.0, out->hz);
    out->percent = mt_without_noise(out->percent, MT_PERCENT_NOISE);
    out->margin_percent = mt_edge_clearance_percent(edge_hz, e->sign < 0.0, exp(e->log_hz));
}

static mt_status note_break(walk *w, double at, mt_drive_path_end end, const char *why,
                            mt_err *err)
{
    mt_drive_path *const out = w->out;
    if (out->why == NULL) {
        out->broken_at = at;
        out->end = end;
        out->why = mt_arena_strdup(w->mem, why);
    }
    return mt_arena_check(w->mem, err);
}

static mt_status measure_edge_margins(walk *w, sample *s, mt_err *err)
{
    for (int i = 0; i < w->n_edges; i++) {
        const edge *const e = &w->edges[i];
        const int pos = mt_modal_flexible(&w->a->modes, e->mode);
        s->room[i] = HUGE_VAL; /* there is no such mode: nothing to keep on that side */
        s->slope[i] = 0.0;
        if (pos >= 0) {
            s->room[i] = e->sign * (log(mt_modal_hz(&w->a->modes, pos)) - e->log_hz);
            MT_TRY(mt_drive_path_rate(w->a, pos, &s->slope[i], err));
            s->slope[i] *= e->sign;
            keep_least(w, e, s->at, s->room[i]);
        }
    }
    return MT_OK;
}

/* Adds a sample; its index is w->n - 1. A value of 0 within the rounding of its path is set to
 * 0: far closer than samples come to each other. */
static mt_status add_path_sample(walk *w, double position, int next, mt_err *err)
{
    const double travel = fabs(w->samples[1].at - w->samples[0].at);
    const double at = mt_without_noise(position, MT_RATIO_NOISE * travel);
    const mt_analysis_options opt = {.shapes = {.first = w->highest},
                                     .gradient = true,
                                     .vectors = true,
                                     .accuracy = MT_MODAL_ACCURACY};
    sample *const s = &w->samples[w->n++];
    mt_err why = {.code = MT_OK};
    *s = (sample){.at = at,
                  .next = next,
                  .room = mt_arena_f64(w->mem, (size_t)w->n_edges, 1),
                  .slope = mt_arena_f64(w->mem, (size_t)w->n_edges, 1)};
    MT_TRY(mt_arena_check(w->mem, err));
    w->out->positions++;
    mt_work_counters_note(w->ws->p->run->work, MT_WORK_POSITIONS, 1);
    mt_problem_note_modal(w->ws->p, 1);
    w->inputs[w->ws->p->n] = at;
    mt_status rc = mt_analysis_solve(w->a, w->inputs, &opt, &why);
    if (rc == MT_OK && w->a->modes.n_unstable > 0) {
        return note_break(w, at, MT_MOTION_UNSTABLE, "it is unstable there", err);
    }
    if (rc == MT_OK && w->a->modes.n_undecided > 0) {
        return note_break(w, at, MT_MOTION_BROKEN, "rounding hides whether it is stable there",
                          err);
    }
    rc = rc == MT_OK ? measure_edge_margins(w, s, &why) : rc;
    if (rc != MT_OK) {
        return ends(rc) ? mt_fail(err, rc, "%s", why.text)
                        : note_break(w, at, MT_MOTION_BROKEN, why.text, err);
    }
    s->good = true;
    return MT_OK;
}

static double fmax_known(double a, double b)
{
    return MT_HAS(b) ? fmax(a, fabs(b)) : a;
}

/* Least value of the cubic on [0, 1] with values a, b and slopes da, db per unit, strictly
 * inside; *at where. */
static double cubic_least(double a, double da, double b, double db, double *at)
{
    double least = fmin(a, b);
    const double c3 = (2.0 * (a - b)) + da + db;
    const double c2 = (3.0 * (b - a)) - (2.0 * da) - db;
    const double root = (c2 * c2) - (3.0 * c3 * da);
    *at = -1.0;
    if (!(root >= 0.0)) {
        return least;
    }
    /* u = (-c2 + sqrt(root)) / (3 c3) is the minimum; written so that nothing cancels */
    const double q = c2 >= 0.0 ? c2 + sqrt(root) : c2 - sqrt(root);
    const double u = c2 >= 0.0 ? -da / q : -q / (3.0 * c3);
    if (u > 0.0 && u < 1.0) {
        const double value = a + (u * (da + (u * (c2 + (u * c3)))));
        if (value < least) {
            least = value;
            *at = u;
        }
    }
    return least;
}

/* True where the interval from i to its neighbour needs one more position; *at: where. */
static bool needs_more(const walk *w, int i, double *at)
{
    const sample *const a = &w->samples[i];
    const sample *const b = &w->samples[a->next];
    const double h = b->at - a->at;
    double deepest = w->out->room - CLOSER;
    bool found = false;
    if (!(h > w->shortest)) {
        return false;
    }
    for (int k = 0; k < w->n_edges; k++) {
        const edge *const e = &w->edges[k];
        if (!isfinite(a->room[k]) || !isfinite(b->room[k])) {
            continue;
        }
        const double avoidance =
            fmin(fabs(base_margin(e, a->room[k])), fabs(base_margin(e, b->room[k])));
        double moved = fabs(b->room[k] - a->room[k]);
        moved = fmax_known(moved, h * a->slope[k]);
        moved = fmax_known(moved, h * b->slope[k]);
        if (moved > PART * fmax(avoidance, NEAREST)) {
            *at = 0.5 * (a->at + b->at);
            return true;
        }
        double u = -1.0;
        const bool known = MT_HAS(a->slope[k]) && MT_HAS(b->slope[k]);
        const double least =
            known ? cubic_least(a->room[k], h * a->slope[k], b->room[k], h * b->slope[k], &u)
                  : HUGE_VAL;
        if (u > 0.0 && least < deepest) {
            deepest = least;
            *at = a->at + (h * fmin(fmax(u, AWAY), 1.0 - AWAY));
            found = true;
        }
    }
    return found;
}

static mt_status refine_path_samples(walk *w, mt_err *err)
{
    int i = 0;
    while (w->samples[i].next >= 0) {
        const int next = w->samples[i].next;
        double at = 0.0;
        const bool good = w->samples[i].good && w->samples[next].good;
        if (!good || !needs_more(w, i, &at)) {
            i = next;
            continue;
        }
        if (w->n >= w->most) {
            w->out->end = w->out->end == MT_MOTION_WHOLE ? MT_MOTION_CAPPED : w->out->end;
            return MT_OK;
        }
        MT_TRY(add_path_sample(w, at, next, err));
        w->samples[i].next = w->n - 1;
    }
    return MT_OK;
}

/* Edges of the bands with their modes: the mode below and the mode above each band. */
static mt_status list_edges(walk *w, const int *below, const mt_band_along_path *bands, int n,
                            mt_err *err)
{
    w->n_edges = 0;
    w->highest = 0;
    w->edges = mt_arena_alloc(w->mem, 2 * (size_t)n, sizeof *w->edges);
    MT_TRY(mt_arena_check(w->mem, err));
    for (int i = 0; i < n; i++) {
        const mt_band *const b = &bands[i].band;
        const int k = below[bands[i].tie];
        w->highest = k + 1 > w->highest ? k + 1 : w->highest;
        if (k > 0 && b->lower_hz > 0.0) {
            w->edges[w->n_edges++] =
                (edge){k, false, -1.0, log(b->lower_hz), log(b->base_lower_hz), &bands[i]};
        }
        w->edges[w->n_edges++] =
            (edge){k + 1, true, 1.0, log(b->upper_hz), log(b->base_upper_hz), &bands[i]};
    }
    return MT_OK;
}

int mt_drive_path_pieces(double way, double unit, int most)
{
    const double wanted = ceil(way / (STEP * unit));
    const double asked = fmin(fmax(wanted, INTERVALS_AT_FIRST), INTERVALS_MOST_AT_FIRST);
    return (int)fmin(asked, most - 1);
}

/* The first positions of a way, evenly spread. */
static mt_status place_first_positions(walk *w, double left, double right, mt_err *err)
{
    const int pieces = mt_drive_path_pieces(right - left, w->unit, w->most);
    w->n = 0;
    w->samples = mt_arena_alloc(w->mem, POSITIONS_MOST, sizeof *w->samples);
    MT_TRY(mt_arena_check(w->mem, err));
    w->samples[1].at = right; /* both ends are known before the first is looked at */
    w->samples[0].at = left;
    MT_TRY(add_path_sample(w, left, pieces > 1 ? 2 : 1, err));
    MT_TRY(add_path_sample(w, right, -1, err));
    for (int i = 1; i < pieces; i++) {
        const double u = (double)i / (double)pieces;
        const double at = ((1.0 - u) * left) + (u * right);
        const bool zero = fabs(at) <= SAME * w->unit; /* the drawing itself */
        MT_TRY(add_path_sample(w, zero ? 0.0 : at, i + 1 < pieces ? w->n + 1 : 1, err));
    }
    return MT_OK;
}

int mt_drive_path_distinct(int n_positions, const double *positions, double unit, double *list)
{
    int n = 0;
    for (int k = 0; k < n_positions; k++) {
        const double at = positions[k];
        bool known = false;
        for (int i = 0; i < n; i++) {
            known = known || fabs(list[i] - at) <= SAME * unit;
        }
        int to = known ? n : n++;
        for (; !known && to > 0 && list[to - 1] > at; to--) {
            list[to] = list[to - 1];
        }
        if (!known) {
            list[to] = at;
        }
    }
    return n;
}

int mt_drive_path_of_band(const mt_subproblem *c, int n)
{
    const int share = c->search.max_positions / (n > 0 ? n : 1);
    const int least = share > POSITIONS_LEAST ? share : POSITIONS_LEAST;
    return c->search.max_positions <= 0 || least > POSITIONS_MOST ? POSITIONS_MOST : least;
}

long mt_drive_path_most(const mt_subproblem *c)
{
    long sum = 0;
    for (int i = 0; i < c->p->n_families && c->search.max_positions > 0; i++) {
        const mt_drive_positions *const f = &c->p->families[i];
        sum += f->banded ? (long)(f->n - 1) * mt_drive_path_of_band(c, f->n - 1) : 0;
    }
    for (int i = 0; i < c->p->n_requirements && c->search.max_positions > 0; i++) {
        const mt_requirement *const d = &c->p->requirements[i];
        if (mt_drive_positions_limits_first(c->p, d)) {
            const int ways = c->p->families[mt_drive_positions_of(c->p, d->view)].n - 1;
            sum += (long)ways * mt_drive_path_of_band(c, ways);
        }
    }
    return sum;
}

static mt_status follow_drive_path(walk *w, const mt_drive_positions *f, const int *below,
                                   mt_err *err)
{
    double *const list = mt_arena_f64(w->mem, (size_t)f->n, 1);
    double *const positions = mt_arena_f64(w->mem, (size_t)f->n, 1);
    MT_TRY(mt_arena_check(w->mem, err));
    for (int k = 0; k < f->n; k++) {
        positions[k] = mt_drive_positions_position(w->ws->views[f->view[k]].analysis);
    }
    mt_drive_path *const out = w->out;
    const int n = mt_drive_path_distinct(f->n, positions, w->unit, list);
    out->from = list[0];
    out->to = list[n - 1];
    out->way_at = mt_arena_f64(w->mem, (size_t)n, 1);
    out->way_margin = mt_arena_f64(w->mem, (size_t)n, 1);
    MT_TRY(mt_arena_check(w->mem, err));
    w->shortest = SHORTEST * (out->to - out->from);
    w->most = mt_drive_path_of_band(w->ws->c, n - 1);
    for (int i = 0; i + 1 < n; i++) {
        mt_band_along_paths bands = {0};
        MT_TRY(mt_drive_positions_bands(w->ws->p, f, positions, list[i], list[i + 1], w->mem,
                                        &bands, err));
        w->way = i;
        out->n_ways = i + 1;
        out->way_at[i] = nan("");
        out->way_margin[i] = HUGE_VAL;
        if (bands.n == 0) {
            continue;
        }
        out->end = out->end == MT_MOTION_NONE ? MT_MOTION_WHOLE : out->end;
        MT_TRY(list_edges(w, below, bands.items, bands.n, err));
        MT_TRY(place_first_positions(w, list[i], list[i + 1], err));
        MT_TRY(refine_path_samples(w, err));
    }
    return MT_OK;
}

mt_status mt_drive_path_follow(mt_workspace *ws, int drive_positions, const int *below,
                               mt_arena *mem, mt_drive_path *out, mt_err *err)
{
    const mt_drive_positions *const f = &ws->p->families[drive_positions];
    const double first = mt_drive_positions_position(ws->views[f->view[0]].analysis);
    mt_err why = {.code = MT_OK};
    *out = (mt_drive_path){.end = MT_MOTION_NONE,
                           .room = HUGE_VAL,
                           .percent = nan(""),
                           .margin_percent = nan(""),
                           .at = nan(""),
                           .hz = nan(""),
                           .broken_at = nan("")};
    walk w = {.ws = ws, .mem = mem, .out = out};
    const mt_status rc = mt_drive_path_open(ws, drive_positions, &why);
    if (rc != MT_OK) {
        return ends(rc) ? mt_fail(err, rc, "%s", why.text)
                        : note_break(&w, first, MT_MOTION_BROKEN, why.text, err);
    }
    w.a = ws->driven[drive_positions];
    mt_linear_follow(w.a->lin, true); /* from the reference position on */
    w.unit = f->angle ? 1.0 : w.a->sys->length_m;
    w.inputs = mt_arena_f64(mem, (size_t)ws->p->n + 1, 1);
    MT_TRY(mt_arena_check(mem, err));
    memcpy(w.inputs, ws->x, (size_t)ws->p->n * sizeof *w.inputs);
    return follow_drive_path(&w, f, below, err);
}

mt_status mt_drive_path_kept(mt_workspace *ws, const int *below, mt_arena *mem, bool *kept,
                             long *positions, mt_err *err)
{
    *kept = true;
    for (int i = 0; i < ws->p->n_families && *kept; i++) {
        mt_drive_path m = {.room = 0.0};
        if (ws->p->families[i].banded) {
            MT_TRY(mt_drive_path_follow(ws, i, below, mem, &m, err));
            *positions += m.positions;
            *kept = m.end != MT_MOTION_UNSTABLE && m.room >= -m.tolerance;
        }
    }
    return MT_OK;
}
