/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Of a goal of forced vibration
 *     e(s) = max(ln(q(s) / at_most), ln(at_least / q(s)))
 * at the positions s between those that are given, q no less than a small part of a limit.
 * Between two samples a and b the lines through each and its other neighbour, or at an end
 * through what the next two intervals say of the slope there, meet above a maximum that is
 * smooth, and below one that is the peak of a resonance: an interval is halved while three
 * halves of the height where they meet, above the higher of a and b, reach further than the
 * worst so far, or while e differs by more than 1/2 between its ends. Around the worst a
 * parabola then says where the maximum is.
 */
#include "search/motion_shaken.h"

#include <math.h>
#include <string.h>

#include "base/spent.h"
#include "problem/goal.h"

static const double CLOSER = 1e-5;   /* of e: what is not worth a position */
static const double STEEP = 0.5;     /* of e, between two positions */
static const double BEYOND = 1.5;    /* of what lines say */
static const double SHORTEST = 1e-7; /* of the motion */
enum { POLISH = 3, SAMPLES_MOST = 400 };

typedef struct sample {
    double at;
    double off; /* NaN: it has none */
} sample;

typedef struct walk {
    mt_workspace *ws;
    const mt_demand *d;
    mt_analysis *a;
    mt_arena *mem;
    double *inputs; /* [n + 1] */
    double unit;
    double shortest;
    int most;
    int n;
    sample *samples; /* of one way, ascending */
    mt_shaken_motion *out;
} walk;

static double off_of(const mt_goal *g, const mt_shaken_value *v)
{
    double worst = -HUGE_VAL;
    if (!v->finite) {
        return v->end == MT_FORCED_INFINITE ? HUGE_VAL : nan("");
    }
    worst = MT_HAS(g->at_most) ? log(fmax(v->value / g->at_most, MT_SHAKEN_FLOOR)) : worst;
    return MT_HAS(g->at_least)
               ? fmax(worst, -log(fmax(v->value / g->at_least, MT_SHAKEN_FLOOR)))
               : worst;
}

static mt_status note_break(walk *w, double at, mt_motion_end end, const char *why, mt_err *err)
{
    if (w->out->why == NULL) {
        w->out->broken_at = at;
        w->out->end = end;
        w->out->why = mt_arena_strdup(w->mem, why);
    }
    return mt_arena_check(w->mem, err);
}

/* What the goal finds at a position; v->value NaN: nothing. */
static mt_status find(walk *w, double at, mt_shaken_value *v, mt_err *err)
{
    const mt_analysis_options opt = mt_view_asks(w->ws, &w->ws->views[w->d->view], false);
    mt_err why = {.code = MT_OK};
    *v = (mt_shaken_value){.value = nan(""), .end = MT_FORCED_UNSTABLE};
    w->out->positions++;
    mt_spent_note(w->ws->p->study->model->spent, MT_SPENT_POSITIONS, 1);
    w->inputs[w->ws->p->n] = at;
    mt_status rc = mt_analysis_solve(w->a, w->inputs, &opt, &why);
    if (rc == MT_OK && !mt_modal_indexed(&w->a->modes)) {
        return note_break(w, at, MT_MOTION_UNSTABLE, "it is unstable there", err);
    }
    rc = rc == MT_OK ? mt_shaken_look_at(w->ws, w->d, w->a, v, &why) : rc;
    if (mt_is_final(rc) || rc == MT_E_INTERRUPTED) {
        return mt_fail(err, rc, "%s", why.text);
    }
    if (rc != MT_OK) {
        v->finite = false;
        v->end = MT_FORCED_UNSTABLE;
        return note_break(w, at, MT_MOTION_BROKEN, why.text, err);
    }
    return MT_OK;
}

/* One more position, which becomes sample i of the way. */
static mt_status look(walk *w, int i, double at, bool given, mt_err *err)
{
    mt_shaken_motion *const out = w->out;
    mt_shaken_value v;
    MT_TRY(find(w, at, &v, err));
    const double off = off_of(w->d->goal, &v);
    memmove(&w->samples[i + 1], &w->samples[i], (size_t)(w->n - i) * sizeof *w->samples);
    w->samples[i] = (sample){at, off};
    w->n++;
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
static double slope_after(const walk *w, int i)
{
    const sample *const s = &w->samples[i];
    return i < 0 || i + 1 >= w->n ? nan("") : (s[1].off - s[0].off) / (s[1].at - s[0].at);
}

/* How high e may be within the interval after sample i. */
static double height(const walk *w, int i)
{
    const sample *const a = &w->samples[i];
    const sample *const b = a + 1;
    const double h = b->at - a->at;
    const double top = fmax(a->off, b->off);
    const double own = slope_after(w, i);
    const double before = slope_after(w, i - 1);
    const double after = slope_after(w, i + 1);
    const double left = isfinite(before) ? before : isfinite(after) ? own + (own - after) : own;
    const double right = isfinite(after)    ? -after
                         : isfinite(before) ? (before - own) - own
                                            : -own;
    const double x = (b->off - a->off + (right * h)) / (left + right);
    if (!(left + right > 0.0) || !(x > 0.0 && x < h)) {
        return top;
    }
    return top + (BEYOND * (a->off + (left * x) - top));
}

static bool needs_more(const walk *w, int i)
{
    const sample *const a = &w->samples[i];
    if (!isfinite(a[0].off) || !isfinite(a[1].off) || !(a[1].at - a[0].at > w->shortest)) {
        return false;
    }
    return fabs(a[1].off - a[0].off) > STEEP || height(w, i) > w->out->off + CLOSER;
}

/* Halve the highest interval that needs it, until none does. */
static mt_status refine(walk *w, mt_err *err)
{
    for (;;) {
        int best = -1;
        double most = -HUGE_VAL;
        for (int i = 0; i + 1 < w->n; i++) {
            const double high = needs_more(w, i) ? height(w, i) : -HUGE_VAL;
            best = high > most ? i : best;
            most = high > most ? high : most;
        }
        if (best < 0) {
            return MT_OK;
        }
        if (w->n >= w->most) {
            w->out->end = w->out->end == MT_MOTION_WHOLE ? MT_MOTION_CAPPED : w->out->end;
            return MT_OK;
        }
        const sample *const a = &w->samples[best];
        MT_TRY(look(w, best + 1, 0.5 * (a[0].at + a[1].at), false, err));
    }
}

/* The top of the parabola through the highest sample within the way and its neighbours. */
static mt_status polish(walk *w, mt_err *err)
{
    for (int round = 0; round < POLISH && w->n < w->most; round++) {
        int i = 0;
        for (int k = 1; k < w->n; k++) {
            i = w->samples[k].off > w->samples[i].off ? k : i;
        }
        const double left = slope_after(w, i - 1);
        const double right = slope_after(w, i);
        const sample *const s = &w->samples[i];
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
        MT_TRY(look(w, at > s->at ? i + 1 : i, at, false, err));
    }
    return MT_OK;
}

static mt_status follow_way(walk *w, double left, double right, mt_err *err)
{
    const int pieces = mt_motion_pieces(right - left, w->unit, w->most);
    w->n = 0;
    for (int i = 0; i <= pieces; i++) {
        const double u = (double)i / (double)pieces;
        const bool given = i == 0 || i == pieces;
        const double at = i == pieces ? right : ((1.0 - u) * left) + (u * right);
        MT_TRY(look(w, i, at, given, err));
    }
    MT_TRY(refine(w, err));
    return polish(w, err);
}

/* Distinct positions of the goal's configurations in the family, and what samples need. */
static mt_status prepare(walk *w, int family, double **list, int *n, mt_err *err)
{
    mt_shaken_motion *const out = w->out;
    const mt_problem *const p = w->ws->p;
    const mt_system *const sys = w->ws->views[w->d->view].analysis->sys;
    const size_t most = (size_t)p->families[family].n;
    double *const all = mt_arena_f64(w->mem, most, 1);
    *list = mt_arena_f64(w->mem, most, 1);
    out->way_at = mt_arena_f64(w->mem, most, 1);
    out->way_off = mt_arena_f64(w->mem, most, 1);
    w->samples = mt_arena_alloc(w->mem, SAMPLES_MOST + 1, sizeof *w->samples);
    w->inputs = mt_arena_f64(w->mem, (size_t)p->n + 1, 1);
    MT_TRY(mt_arena_check(w->mem, err));
    memcpy(w->inputs, w->ws->x, (size_t)p->n * sizeof *w->inputs);
    int given = 0;
    for (int i = 0; i < p->n_demands; i++) {
        const mt_demand *const d = &p->demands[i];
        if (d->goal_index == w->d->goal_index && mt_family_of(p, d->view) == family) {
            all[given++] = mt_family_position(w->ws->views[d->view].analysis);
        }
    }
    w->unit = p->families[family].angle ? 1.0 : sys->length_m;
    *n = mt_motion_distinct(given, all, w->unit, *list);
    out->from = (*list)[0];
    out->to = (*list)[*n - 1];
    w->shortest = SHORTEST * (out->to - out->from);
    const int share = mt_motion_of_way(w->ws->c, *n - 1);
    w->most = share < SAMPLES_MOST ? share : SAMPLES_MOST;
    return MT_OK;
}

mt_status mt_motion_shaken(mt_workspace *ws, const mt_demand *d, mt_arena *mem,
                           mt_shaken_motion *out, mt_err *err)
{
    const int family = mt_family_of(ws->p, d->view);
    double *list = NULL;
    int n = 0;
    mt_err why = {.code = MT_OK};
    *out = (mt_shaken_motion){.end = MT_MOTION_WHOLE,
                              .off = nan(""),
                              .at = nan(""),
                              .broken_at = nan(""),
                              .worst = {.value = nan(""), .error = nan(""), .omega = nan("")}};
    walk w = {.ws = ws, .d = d, .mem = mem, .out = out};
    MT_TRY(prepare(&w, family, &list, &n, err));
    if (n < 2) {
        out->end = MT_MOTION_NONE;
        return MT_OK;
    }
    const mt_status rc = mt_motion_open(ws, family, &why);
    if (mt_is_final(rc) || rc == MT_E_INTERRUPTED) {
        return mt_fail(err, rc, "%s", why.text);
    }
    if (rc != MT_OK) {
        return note_break(&w, out->from, MT_MOTION_BROKEN, why.text, err);
    }
    w.a = ws->driven[family];
    mt_linear_follow(w.a->lin, true); /* from the reference position on */
    for (int i = 0; i + 1 < n; i++) {
        out->n_ways = i + 1;
        out->way_at[i] = nan("");
        out->way_off[i] = -HUGE_VAL;
        MT_TRY(follow_way(&w, list[i], list[i + 1], err));
    }
    return MT_OK;
}
