/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What holds between the positions of a drive: mode placements, how far samples may be
 * apart, and limits of other goals. */
#include "search/drive_path.h"

#include <math.h>
#include <string.h>

#include "base/number.h"
#include "base/run.h"
#include "mechanics/forcing.h"
#include "mechanics/products.h"
#include "problem/avoidance.h"
#include "problem/configuration.h"
#include "problem/goals.h"
#include "problem/requirement.h"

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

/* Opens the worker's own analysis of the drive's mechanism, ws->driven[drive_positions]. Fails:
 * MT_E_DOMAIN where there is none, as mt_analysis_new. */
static mt_status drive_path_open(mt_workspace *ws, int drive_positions, mt_err *err)
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

/* rate: d ln f / d position of the mode at pos of a driven analysis, solved with gradient; NaN
 * for a repeated mode or 0 Hz. Fails: as mt_linear_products. */
static mt_status drive_path_rate(mt_analysis *a, int pos, double *rate, mt_err *err)
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
            MT_TRY(drive_path_rate(w->a, pos, &s->slope[i], err));
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

/* Initial number of subintervals of an interval of length `way`. */
static int drive_path_pieces(double way, double unit, int most)
{
    const double wanted = ceil(way / (STEP * unit));
    const double asked = fmin(fmax(wanted, INTERVALS_AT_FIRST), INTERVALS_MOST_AT_FIRST);
    return (int)fmin(asked, most - 1);
}

/* The first positions of a way, evenly spread. */
static mt_status place_first_positions(walk *w, double left, double right, mt_err *err)
{
    const int pieces = drive_path_pieces(right - left, w->unit, w->most);
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

/* list: the distinct positions, ascending. Returns their number. */
static int drive_path_distinct(int n_positions, const double *positions, double unit,
                               double *list)
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

/* Maximum number of samples in each of n intervals. */
static int drive_path_of_band(const mt_subproblem *c, int n)
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
        sum += f->banded ? (long)(f->n - 1) * drive_path_of_band(c, f->n - 1) : 0;
    }
    for (int i = 0; i < c->p->n_requirements && c->search.max_positions > 0; i++) {
        const mt_requirement *const d = &c->p->requirements[i];
        if (mt_drive_positions_limits_first(c->p, d)) {
            const int ways = c->p->families[mt_drive_positions_of(c->p, d->view)].n - 1;
            sum += (long)ways * drive_path_of_band(c, ways);
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
        positions[k] = mt_drive_positions_position(f, w->ws->views[f->view[k]].analysis);
    }
    mt_drive_path *const out = w->out;
    const int n = drive_path_distinct(f->n, positions, w->unit, list);
    out->from = list[0];
    out->to = list[n - 1];
    out->way_at = mt_arena_f64(w->mem, (size_t)n, 1);
    out->way_margin = mt_arena_f64(w->mem, (size_t)n, 1);
    MT_TRY(mt_arena_check(w->mem, err));
    w->shortest = SHORTEST * (out->to - out->from);
    w->most = drive_path_of_band(w->ws->c, n - 1);
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
    const double first = mt_drive_positions_position(f, ws->views[f->view[0]].analysis);
    mt_err why = {.code = MT_OK};
    *out = (mt_drive_path){.end = MT_MOTION_NONE,
                           .room = HUGE_VAL,
                           .percent = nan(""),
                           .margin_percent = nan(""),
                           .at = nan(""),
                           .hz = nan(""),
                           .broken_at = nan("")};
    walk w = {.ws = ws, .mem = mem, .out = out};
    const mt_status rc = drive_path_open(ws, drive_positions, &why);
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

/*
 * The cubic through a, b with slopes a', b' at the part u of an interval of length h is
 *     (1 + 2 u)(1 - u)^2 a + u (1 - u)^2 h a' + u^2 (3 - 2 u) b - u^2 (1 - u) h b'.
 */

/* Greatest turn between two positions [rad], which a spring that passes its own other end at a
 * distance d does within a third of d. */
static const double TURN = 0.35;
static const double GUARD_PART = 0.25; /* of a clearance, between two positions */
static const double NEAR = 0.02;       /* clearances (ln) below it count as it */
/* What a cubic may be wrong by: of a clearance, and of those that are nearer (ln). */
static const double ASTRAY = 0.02;
static const double ASTRAY_NEAR = 2e-3;

/* Modes beside a range that may come into it, modes and frequencies that are looked at. */
enum { BESIDE = 3, MODES_MOST = 24, EDGES_MOST = 32 };

typedef struct edges {
    int n;
    double hz[EDGES_MOST];
} edges;

static void add_edge(edges *e, double hz)
{
    for (int i = 0; i < e->n; i++) {
        if (e->hz[i] == hz) {
            return;
        }
    }
    if (hz > 0.0 && isfinite(hz) && e->n < EDGES_MOST) {
        e->hz[e->n++] = hz;
    }
}

/* Ends of the range that a forced vibration is looked for in, and of its tones. */
static void add_range(const mt_response_limit *s, edges *e)
{
    double hz[2] = {s->lower_hz, s->upper_hz};
    if (s->profile != NULL) {
        mt_vibration_range(s->profile, true, true, hz);
    }
    add_edge(e, hz[0]);
    add_edge(e, hz[1]);
    for (int i = 0; s->profile != NULL && i < s->profile->n_tones; i++) {
        add_edge(e, s->profile->tones[i].lower_hz);
        add_edge(e, s->profile->tones[i].upper_hz);
    }
}

/* Vibration modes below a frequency. */
static int count_below(const mt_modes *modes, double hz)
{
    int n = 0;
    for (int i = 0; i < modes->count; i++) {
        n += modes->kind[i] == MT_MODE_FLEXIBLE && mt_modal_hz(modes, i) < hz ? 1 : 0;
    }
    return n;
}

/* Modes within the range of a forced vibration, and a few next to it. */
static void choose_modes(const mt_modes *modes, const edges *e, mt_guards *g)
{
    double low = HUGE_VAL;
    double high = 0.0;
    for (int i = 0; i < e->n; i++) {
        low = fmin(low, e->hz[i]);
        high = fmax(high, e->hz[i]);
    }
    const int first = count_below(modes, low) + 1 - BESIDE;
    const int last = count_below(modes, high) + BESIDE;
    g->first = first > 1 ? first : 1;
    g->last = last < g->first + MODES_MOST ? last : g->first + MODES_MOST - 1;
}

/* Adds to opt the modes that a goal and its guards need. */
static void guards_query(const mt_requirement *d, mt_analysis_options *opt)
{
    const int most = (d->mode > d->of.mode ? d->mode : d->of.mode) + 1;
    opt->gradient = true;
    opt->modes.first =
        opt->modes.first > 0 && opt->modes.first < most ? most : opt->modes.first;
    opt->shapes.first =
        opt->shapes.first > 0 && opt->shapes.first < most ? most : opt->shapes.first;
}

/* Modes are sorted: where two cross, both are others. */
static void add_neighbours(mt_guards *g, int mode)
{
    g->items[g->n++] = (mt_guard){.mode = mode + 1, .beside = mode};
    g->last = mode + 1 > g->last ? mode + 1 : g->last;
    if (mode > 1) {
        g->items[g->n++] = (mt_guard){.mode = mode, .beside = mode - 1};
        g->first = mode - 1 < g->first ? mode - 1 : g->first;
    }
}

/* Guards of a requirement, for the modes of the solved analysis. Fails: MT_E_MEMORY. */
static mt_status guards_init(const mt_requirement *d, const mt_analysis *a, mt_arena *mem,
                             mt_guards *out, mt_err *err)
{
    edges e = {.n = 0};
    const int other = d->of.mode > 0 ? d->of.mode : d->mode;
    *out = (mt_guards){.sys = a->sys,
                       .first = d->mode < other ? d->mode : other,
                       .last = d->mode > other ? d->mode : other};
    if (d->goal->response_limit != NULL) {
        add_range(d->goal->response_limit, &e);
        choose_modes(&a->modes, &e, out);
    } else if (d->quantity == MT_QUANTITY_FREQUENCY) {
        add_edge(&e, d->goal->at_least);
        add_edge(&e, d->goal->at_most);
    }
    const int n_modes = out->last - out->first + 1;
    out->items = mt_arena_alloc(mem, ((size_t)n_modes * (size_t)e.n) + 4, sizeof *out->items);
    out->log_hz = mt_arena_f64(mem, (size_t)n_modes + 2, 1);
    out->rate = mt_arena_f64(mem, (size_t)n_modes + 2, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int mode = out->first; mode <= out->last; mode++) {
        for (int i = 0; i < e.n; i++) {
            out->items[out->n++] = (mt_guard){.mode = mode, .log_edge = log(e.hz[i])};
        }
    }
    if (d->goal->response_limit == NULL) {
        add_neighbours(out, d->mode);
        if (other != d->mode) {
            add_neighbours(out, other);
        }
    }
    return MT_OK;
}

/* Reads the guards after a solve with gradient. Fails: MT_E_MEMORY, as drive_path_rate. */
static mt_status guards_read(const mt_guards *g, mt_analysis *a, mt_arena *mem,
                             mt_guard_sample *out, mt_err *err)
{
    *out = (mt_guard_sample){.avoidance = mt_arena_f64(mem, (size_t)g->n, 1),
                             .rate = mt_arena_f64(mem, (size_t)g->n, 1),
                             .directions =
                                 mt_arena_f64(mem, (size_t)mt_directions_count(g->sys), 1)};
    MT_TRY(mt_arena_check(mem, err));
    mt_directions_read(a->lin, out->directions);
    for (int mode = g->first; mode <= g->last; mode++) {
        const int pos = mt_modal_flexible(&a->modes, mode);
        const int at = mode - g->first;
        g->log_hz[at] = pos < 0 ? HUGE_VAL : log(mt_modal_hz(&a->modes, pos));
        g->rate[at] = 0.0;
        MT_TRY(pos < 0 ? MT_OK : drive_path_rate(a, pos, &g->rate[at], err));
    }
    for (int i = 0; i < g->n; i++) {
        const mt_guard *const item = &g->items[i];
        const int own = item->mode - g->first;
        const int other = item->beside - g->first;
        const bool pair = item->beside > 0;
        out->avoidance[i] = g->log_hz[own] - (pair ? g->log_hz[other] : item->log_edge);
        out->rate[i] = g->rate[own] - (pair ? g->rate[other] : 0.0);
    }
    return MT_OK;
}

static double most_known(double a, double b)
{
    return MT_HAS(b) ? fmax(a, fabs(b)) : a;
}

bool mt_guards_keep_distance(const mt_guards *g, const mt_guard_sample *a,
                             const mt_guard_sample *b, double h)
{
    for (int i = 0; i < g->n; i++) {
        if (!isfinite(a->avoidance[i]) || !isfinite(b->avoidance[i])) {
            continue;
        }
        const double avoidance = fmin(fabs(a->avoidance[i]), fabs(b->avoidance[i]));
        double moved = fabs(b->avoidance[i] - a->avoidance[i]);
        moved = most_known(moved, h * a->rate[i]);
        moved = most_known(moved, h * b->rate[i]);
        if (moved > GUARD_PART * fmax(avoidance, NEAR)) {
            return true;
        }
    }
    return mt_directions_turn(g->sys, a->directions, b->directions) > TURN;
}

bool mt_guards_astray(const mt_guards *g, const mt_guard_sample *a, double before,
                      const mt_guard_sample *middle, double after, const mt_guard_sample *b)
{
    const double h = before + after;
    const double u = before / h;
    const double v = after / h;
    for (int i = 0; i < g->n; i++) {
        const double from =
            ((1.0 + (2.0 * u)) * v * v * a->avoidance[i]) + (u * v * v * h * a->rate[i]);
        const double to =
            (u * u * (1.0 + (2.0 * v)) * b->avoidance[i]) - (u * u * v * h * b->rate[i]);
        const double off = fabs(from + to - middle->avoidance[i]);
        if (off > fmax(ASTRAY * fabs(middle->avoidance[i]), ASTRAY_NEAR) && isfinite(off)) {
            return true;
        }
    }
    return false;
}

/*
 * Of a goal with limits
 *     e(s) = what its number q(s) exceeds a limit by, as its kind measures it (requirement.h)
 * at the positions s between those that are given. An interval between two samples is halved
 *   - while its ends are too far apart for what lies between to be told from them, or one of
 * them is not where its neighbours have it, or e differs by more than 1/2
 *     between them: longest intervals first;
 *   - then while e may be higher within than anywhere so far. The lines through each end
 *     and its other neighbour, or at an end through what the next two intervals say of the
 *     slope there, meet above a maximum that is smooth, and below one that is the peak of a
 *     resonance: three halves of the height where they meet, above the higher end, must not
 *     reach the worst.
 * Around the worst a parabola then says where the maximum is.
 */

static const double LIMIT_CLOSER = 1e-5;   /* of e: what is not worth a position */
static const double STEEP = 0.5;           /* of e, between two positions */
static const double BENT = 0.1;            /* of e, beside the line between two others */
static const double BEYOND = 1.5;          /* of what lines say */
static const double LIMIT_SHORTEST = 1e-7; /* of the motion */
enum { POLISH = 3, SAMPLES_MOST = 400 };

typedef struct limit_sample {
    double at;
    double off;   /* NaN: it has none */
    bool guarded; /* `guard` is there */
    bool apart;   /* too far from the next one */
    bool astray;  /* not where its neighbours have it */
    mt_guard_sample guard;
} limit_sample;

typedef struct limit_walk {
    mt_workspace *ws;
    const mt_requirement *d;
    mt_analysis *a;
    mt_arena *mem;
    double *inputs; /* [n + 1] */
    double unit;
    double shortest;
    int most;
    int n;
    limit_sample *samples; /* of one way, ascending */
    bool has_guards;       /* of this way */
    mt_guards guards;
    mt_limit_drive_path *out;
} limit_walk;

static double off_of(const mt_requirement *d, const mt_forced_response_value *v)
{
    if (v->finite || isinf(v->value)) {
        return mt_requirement_over(d, v->value);
    }
    return v->end == MT_FORCED_INFINITE ? HUGE_VAL : nan("");
}

static mt_status limit_note_break(limit_walk *w, double at, mt_drive_path_end end,
                                  const char *why, mt_err *err)
{
    if (w->out->why == NULL) {
        w->out->broken_at = at;
        w->out->end = end;
        w->out->why = mt_arena_strdup(w->mem, why);
    }
    return mt_arena_check(w->mem, err);
}

/* Signs that the value may differ next to this position. */
static mt_status guard(limit_walk *w, limit_sample *s, mt_err *err)
{
    if (!w->has_guards) {
        MT_TRY(guards_init(w->d, w->a, w->mem, &w->guards, err));
        w->has_guards = true;
    }
    MT_TRY(guards_read(&w->guards, w->a, w->mem, &s->guard, err));
    s->guarded = true;
    return MT_OK;
}

/* Value of the goal at a position; v->value NaN: none. */
static mt_status evaluate_goal_at_position(limit_walk *w, limit_sample *s,
                                           mt_forced_response_value *v, mt_err *err)
{
    mt_analysis_options opt = mt_configuration_queries(w->ws, &w->ws->views[w->d->view], false);
    mt_err why = {.code = MT_OK};
    guards_query(w->d, &opt);
    *v = (mt_forced_response_value){.value = nan(""), .end = MT_FORCED_UNSTABLE};
    w->out->positions++;
    mt_work_counters_note(w->ws->p->run->work, MT_WORK_POSITIONS, 1);
    mt_problem_note_modal(w->ws->p, 1);
    w->inputs[w->ws->p->n] = s->at;
    mt_status rc = mt_analysis_solve(w->a, w->inputs, &opt, &why);
    if (rc == MT_OK && !mt_modal_indexed(&w->a->modes)) {
        return limit_note_break(w, s->at, MT_MOTION_UNSTABLE, "it is unstable there", err);
    }
    rc = rc == MT_OK ? mt_requirement_find_peak(w->ws, w->d, w->a, v, &why) : rc;
    rc = rc == MT_OK ? guard(w, s, &why) : rc;
    if (mt_is_final(rc) || rc == MT_E_INTERRUPTED) {
        return mt_fail(err, rc, "%s", why.text);
    }
    if (rc != MT_OK) {
        *v = (mt_forced_response_value){.value = nan(""), .end = MT_FORCED_UNSTABLE};
        return limit_note_break(w, s->at, MT_MOTION_BROKEN, why.text, err);
    }
    return MT_OK;
}

static bool is_apart(const limit_walk *w, const limit_sample *a)
{
    const limit_sample *const b = a + 1;
    return a->guarded && b->guarded &&
           mt_guards_keep_distance(&w->guards, &a->guard, &b->guard, b->at - a->at);
}

static bool is_astray(const limit_walk *w, const limit_sample *s)
{
    const limit_sample *const a = s - 1;
    const limit_sample *const b = s + 1;
    const double before = s->at - a->at;
    const double after = b->at - s->at;
    if (!a->guarded || !s->guarded || !b->guarded) {
        return false;
    }
    const double line = ((after * a->off) + (before * b->off)) / (before + after);
    return fabs(s->off - line) > BENT ||
           mt_guards_astray(&w->guards, &a->guard, before, &s->guard, after, &b->guard);
}

/* Updates the estimates of sample i and its neighbours. */
static void verify_neighbours(limit_walk *w, int i)
{
    for (int k = i > 0 ? i - 1 : 0; k <= i && k + 1 < w->n; k++) {
        w->samples[k].apart = is_apart(w, &w->samples[k]);
    }
    for (int k = i > 1 ? i - 1 : 1; k <= i + 1 && k + 1 < w->n; k++) {
        w->samples[k].astray = is_astray(w, &w->samples[k]);
    }
}

/* Inserts a position as sample i of the interval. */
static mt_status insert_position_sample(limit_walk *w, int i, double at, bool given,
                                        mt_err *err)
{
    mt_limit_drive_path *const out = w->out;
    mt_forced_response_value v;
    limit_sample fresh = {.at = at};
    MT_TRY(evaluate_goal_at_position(w, &fresh, &v, err));
    const double off = off_of(w->d, &v);
    fresh.off = off;
    memmove(&w->samples[i + 1], &w->samples[i], (size_t)(w->n - i) * sizeof *w->samples);
    w->samples[i] = fresh;
    w->n++;
    verify_neighbours(w, i);
    if (!given && MT_HAS(off) && !(off <= out->way_off[out->n_ways - 1])) {
        out->way_off[out->n_ways - 1] = off;
        out->way_at[out->n_ways - 1] = at;
    }
    if (MT_HAS(off) && !(off <= out->off)) {
        out->off = off;
        out->at = at;
        out->given = given;
        out->worst = v;
    }
    return MT_OK;
}

/* Slope of e from sample i to the next; NaN: there is none. */
static double slope_after(const limit_walk *w, int i)
{
    if (i < 0 || i + 1 >= w->n) {
        return nan("");
    }
    const limit_sample *const s = &w->samples[i];
    return (s[1].off - s[0].off) / (s[1].at - s[0].at);
}

/* Upper estimate of e within the interval after sample i. */
static double height(const limit_walk *w, int i)
{
    const limit_sample *const a = &w->samples[i];
    const limit_sample *const b = a + 1;
    const double h = b->at - a->at;
    const double top = fmax(a->off, b->off);
    const double own = slope_after(w, i);
    const double before = slope_after(w, i - 1);
    const double after = slope_after(w, i + 1);
    const double left = isfinite(before) ? before : isfinite(after) ? own + (own - after) : own;
    const double right = isfinite(after)    ? -after
                         : isfinite(before) ? (before - own) - own
                                            : -own;
    if (!(left + right > 0.0)) {
        return top;
    }
    const double x = (b->off - a->off + (right * h)) / (left + right);
    if (!(x > 0.0 && x < h)) {
        return top;
    }
    return top + (BEYOND * (a->off + (left * x) - top));
}

/* True where e may be arbitrary between sample i and the next. */
static bool is_open(const limit_walk *w, int i)
{
    const limit_sample *const a = &w->samples[i];
    const limit_sample *const b = a + 1;
    const bool good = isfinite(a->off) && isfinite(b->off);
    return good && b->at - a->at > w->shortest &&
           (a->apart || a->astray || b->astray || fabs(b->off - a->off) > STEEP);
}

/* True where it may exceed the largest value so far. */
static bool is_high(const limit_walk *w, int i)
{
    const limit_sample *const a = &w->samples[i];
    const bool good = isfinite(a[0].off) && isfinite(a[1].off);
    return good && a[1].at - a[0].at > w->shortest && height(w, i) > w->out->off + LIMIT_CLOSER;
}

/* The interval to halve next: the longest open one, else the highest; -1: none. */
static int choose_interval(const limit_walk *w)
{
    int best = -1;
    double most = 0.0;
    for (int i = 0; i + 1 < w->n; i++) {
        const double length = w->samples[i + 1].at - w->samples[i].at;
        if (length > most && is_open(w, i)) {
            best = i;
            most = length;
        }
    }
    most = -HUGE_VAL;
    for (int i = 0, none = best < 0; none && i + 1 < w->n; i++) {
        const double high = is_high(w, i) ? height(w, i) : -HUGE_VAL;
        best = high > most ? i : best;
        most = high > most ? high : most;
    }
    return best;
}

static mt_status halve_open_intervals(limit_walk *w, mt_err *err)
{
    for (int best = choose_interval(w); best >= 0; best = choose_interval(w)) {
        if (w->n >= w->most) {
            w->out->end = w->out->end == MT_MOTION_WHOLE ? MT_MOTION_CAPPED : w->out->end;
            return MT_OK;
        }
        const limit_sample *const a = &w->samples[best];
        MT_TRY(insert_position_sample(w, best + 1, 0.5 * (a[0].at + a[1].at), false, err));
    }
    return MT_OK;
}

/* The top of the parabola through the highest sample within the way and its neighbours. */
static mt_status polish(limit_walk *w, mt_err *err)
{
    for (int round = 0; round < POLISH && w->n < w->most; round++) {
        int i = 0;
        for (int k = 1; k < w->n; k++) {
            i = w->samples[k].off > w->samples[i].off ? k : i;
        }
        const double left = slope_after(w, i - 1);
        const double right = slope_after(w, i);
        const limit_sample *const s = &w->samples[i];
        if (!isfinite(left) || !isfinite(right) || !(left > right)) {
            return MT_OK;
        }
        /* the slopes belong to the middles of the intervals */
        const double from = 0.5 * (s[-1].at + s[0].at);
        const double at = from + (0.5 * (s[1].at - s[-1].at) * left / (left - right));
        const double near = w->shortest;
        if (!(fabs(at - s->at) > near) || !(at > s[-1].at + near) || !(at < s[1].at - near)) {
            return MT_OK;
        }
        MT_TRY(insert_position_sample(w, at > s->at ? i + 1 : i, at, false, err));
    }
    return MT_OK;
}

static mt_status follow_way(limit_walk *w, double left, double right, mt_err *err)
{
    const int pieces = drive_path_pieces(right - left, w->unit, w->most);
    w->n = 0;
    w->has_guards = false;
    for (int i = 0; i <= pieces; i++) {
        const double u = (double)i / (double)pieces;
        const bool given = i == 0 || i == pieces;
        const double at = i == pieces ? right : ((1.0 - u) * left) + (u * right);
        MT_TRY(insert_position_sample(w, i, at, given, err));
    }
    MT_TRY(halve_open_intervals(w, err));
    return polish(w, err);
}

/* Distinct positions of the goal's configurations in the family, and what samples need. */
static mt_status list_goal_positions(limit_walk *w, int drive_positions, double **list, int *n,
                                     mt_err *err)
{
    mt_limit_drive_path *const out = w->out;
    const mt_problem *const p = w->ws->p;
    const mt_system *const sys = w->ws->views[w->d->view].analysis->sys;
    const size_t most = (size_t)p->families[drive_positions].n;
    double *const all = mt_arena_f64(w->mem, most, 1);
    *list = mt_arena_f64(w->mem, most, 1);
    out->way_at = mt_arena_f64(w->mem, most, 1);
    out->way_off = mt_arena_f64(w->mem, most, 1);
    w->samples = mt_arena_alloc(w->mem, SAMPLES_MOST + 1, sizeof *w->samples);
    w->inputs = mt_arena_f64(w->mem, (size_t)p->n + 1, 1);
    MT_TRY(mt_arena_check(w->mem, err));
    memcpy(w->inputs, w->ws->x, (size_t)p->n * sizeof *w->inputs);
    int given = 0;
    for (int i = 0; i < p->n_requirements; i++) {
        const mt_requirement *const d = &p->requirements[i];
        if (mt_drive_positions_same_limit(d, w->d) &&
            mt_drive_positions_of(p, d->view) == drive_positions) {
            all[given++] = mt_drive_positions_position(&p->families[drive_positions],
                                                       w->ws->views[d->view].analysis);
        }
    }
    w->unit = p->families[drive_positions].angle ? 1.0 : sys->length_m;
    *n = drive_path_distinct(given, all, w->unit, *list);
    out->from = (*list)[0];
    out->to = (*list)[*n - 1];
    w->shortest = LIMIT_SHORTEST * (out->to - out->from);
    const int share = drive_path_of_band(w->ws->c, *n - 1);
    w->most = share < SAMPLES_MOST ? share : SAMPLES_MOST;
    return MT_OK;
}

mt_status mt_drive_path_limit(mt_workspace *ws, const mt_requirement *d, mt_arena *mem,
                              mt_limit_drive_path *out, mt_err *err)
{
    const int drive_positions = mt_drive_positions_of(ws->p, d->view);
    double *list = NULL;
    int n = 0;
    mt_err why = {.code = MT_OK};
    *out =
        (mt_limit_drive_path){.end = MT_MOTION_WHOLE,
                              .off = nan(""),
                              .at = nan(""),
                              .broken_at = nan(""),
                              .worst = {.value = nan(""), .error = nan(""), .omega = nan("")}};
    limit_walk w = {.ws = ws, .d = d, .mem = mem, .out = out};
    MT_TRY(list_goal_positions(&w, drive_positions, &list, &n, err));
    if (n < 2) {
        out->end = MT_MOTION_NONE;
        return MT_OK;
    }
    const mt_status rc = drive_path_open(ws, drive_positions, &why);
    if (mt_is_final(rc) || rc == MT_E_INTERRUPTED) {
        return mt_fail(err, rc, "%s", why.text);
    }
    if (rc != MT_OK) {
        return limit_note_break(&w, out->from, MT_MOTION_BROKEN, why.text, err);
    }
    w.a = ws->driven[drive_positions];
    mt_linear_follow(w.a->lin, true); /* from the reference position on */
    for (int i = 0; i + 1 < n; i++) {
        out->n_ways = i + 1;
        out->way_at[i] = nan("");
        out->way_off[i] = -HUGE_VAL;
        MT_TRY(follow_way(&w, list[i], list[i + 1], err));
    }
    return MT_OK;
}
