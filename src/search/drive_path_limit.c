/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Of a goal with limits
 *     e(s) = what its number q(s) exceeds a limit by, as its kind measures it (requirement.h)
 * at the positions s between those that are given. An interval between two samples is halved
 *   - while its ends are too far apart for what lies between to be told from them, or one of
 * them is not where its neighbours have it (drive_path_guard.h), or e differs by more than 1/2
 *     between them: longest intervals first;
 *   - then while e may be higher within than anywhere so far. The lines through each end
 *     and its other neighbour, or at an end through what the next two intervals say of the
 *     slope there, meet above a maximum that is smooth, and below one that is the peak of a
 *     resonance: three halves of the height where they meet, above the higher end, must not
 *     reach the worst.
 * Around the worst a parabola then says where the maximum is.
 */
#include "search/drive_path_limit.h"

#include <math.h>
#include <string.h>

#include "base/run.h"
#include "problem/avoidance.h"
#include "problem/configuration.h"
#include "problem/requirement.h"
#include "search/drive_path_guard.h"

static const double CLOSER = 1e-5;   /* of e: what is not worth a position */
static const double STEEP = 0.5;     /* of e, between two positions */
static const double BENT = 0.1;      /* of e, beside the line between two others */
static const double BEYOND = 1.5;    /* of what lines say */
static const double SHORTEST = 1e-7; /* of the motion */
enum { POLISH = 3, SAMPLES_MOST = 400 };

typedef struct sample {
    double at;
    double off;   /* NaN: it has none */
    bool guarded; /* `guard` is there */
    bool apart;   /* too far from the next one */
    bool astray;  /* not where its neighbours have it */
    mt_guard_sample guard;
} sample;

typedef struct walk {
    mt_workspace *ws;
    const mt_requirement *d;
    mt_analysis *a;
    mt_arena *mem;
    double *inputs; /* [n + 1] */
    double unit;
    double shortest;
    int most;
    int n;
    sample *samples; /* of one way, ascending */
    bool has_guards; /* of this way */
    mt_guards guards;
    mt_limit_drive_path *out;
} walk;

static double off_of(const mt_requirement *d, const mt_forced_response_value *v)
{
    if (v->finite || isinf(v->value)) {
        return mt_requirement_over(d, v->value);
    }
    return v->end == MT_FORCED_INFINITE ? HUGE_VAL : nan("");
}

static mt_status note_break(walk *w, double at, mt_drive_path_end end, const char *why,
                            mt_err *err)
{
    if (w->out->why == NULL) {
        w->out->broken_at = at;
        w->out->end = end;
        w->out->why = mt_arena_strdup(w->mem, why);
    }
    return mt_arena_check(w->mem, err);
}

/* Signs that the value may differ next to this position. */
static mt_status guard(walk *w, sample *s, mt_err *err)
{
    if (!w->has_guards) {
        MT_TRY(mt_guards_init(w->d, w->a, w->mem, &w->guards, err));
        w->has_guards = true;
    }
    MT_TRY(mt_guards_read(&w->guards, w->a, w->mem, &s->guard, err));
    s->guarded = true;
    return MT_OK;
}

/* Value of the goal at a position; v->value NaN: none. */
static mt_status evaluate_goal_at_position(walk *w, sample *s, mt_forced_response_value *v,
                                           mt_err *err)
{
    mt_analysis_options opt = mt_configuration_queries(w->ws, &w->ws->views[w->d->view], false);
    mt_err why = {.code = MT_OK};
    mt_guards_query(w->d, &opt);
    *v = (mt_forced_response_value){.value = nan(""), .end = MT_FORCED_UNSTABLE};
    w->out->positions++;
    mt_work_counters_note(w->ws->p->run->work, MT_WORK_POSITIONS, 1);
    mt_problem_note_modal(w->ws->p, 1);
    w->inputs[w->ws->p->n] = s->at;
    mt_status rc = mt_analysis_solve(w->a, w->inputs, &opt, &why);
    if (rc == MT_OK && !mt_modal_indexed(&w->a->modes)) {
        return note_break(w, s->at, MT_MOTION_UNSTABLE, "it is unstable there", err);
    }
    rc = rc == MT_OK ? mt_requirement_find_peak(w->ws, w->d, w->a, v, &why) : rc;
    rc = rc == MT_OK ? guard(w, s, &why) : rc;
    if (mt_is_final(rc) || rc == MT_E_INTERRUPTED) {
        return mt_fail(err, rc, "%s", why.text);
    }
    if (rc != MT_OK) {
        *v = (mt_forced_response_value){.value = nan(""), .end = MT_FORCED_UNSTABLE};
        return note_break(w, s->at, MT_MOTION_BROKEN, why.text, err);
    }
    return MT_OK;
}

static bool is_apart(const walk *w, const sample *a)
{
    const sample *const b = a + 1;
    return a->guarded && b->guarded &&
           mt_guards_keep_distance(&w->guards, &a->guard, &b->guard, b->at - a->at);
}

static bool is_astray(const walk *w, const sample *s)
{
    const sample *const a = s - 1;
    const sample *const b = s + 1;
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
static void verify_neighbours(walk *w, int i)
{
    for (int k = i > 0 ? i - 1 : 0; k <= i && k + 1 < w->n; k++) {
        w->samples[k].apart = is_apart(w, &w->samples[k]);
    }
    for (int k = i > 1 ? i - 1 : 1; k <= i + 1 && k + 1 < w->n; k++) {
        w->samples[k].astray = is_astray(w, &w->samples[k]);
    }
}

/* Inserts a position as sample i of the interval. */
static mt_status insert_position_sample(walk *w, int i, double at, bool given, mt_err *err)
{
    mt_limit_drive_path *const out = w->out;
    mt_forced_response_value v;
    sample fresh = {.at = at};
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
static double slope_after(const walk *w, int i)
{
    if (i < 0 || i + 1 >= w->n) {
        return nan("");
    }
    const sample *const s = &w->samples[i];
    return (s[1].off - s[0].off) / (s[1].at - s[0].at);
}

/* Upper estimate of e within the interval after sample i. */
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
static bool is_open(const walk *w, int i)
{
    const sample *const a = &w->samples[i];
    const sample *const b = a + 1;
    const bool good = isfinite(a->off) && isfinite(b->off);
    return good && b->at - a->at > w->shortest &&
           (a->apart || a->astray || b->astray || fabs(b->off - a->off) > STEEP);
}

/* True where it may exceed the largest value so far. */
static bool is_high(const walk *w, int i)
{
    const sample *const a = &w->samples[i];
    const bool good = isfinite(a[0].off) && isfinite(a[1].off);
    return good && a[1].at - a[0].at > w->shortest && height(w, i) > w->out->off + CLOSER;
}

/* The interval to halve next: the longest open one, else the highest; -1: none. */
static int choose_interval(const walk *w)
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

static mt_status halve_open_intervals(walk *w, mt_err *err)
{
    for (int best = choose_interval(w); best >= 0; best = choose_interval(w)) {
        if (w->n >= w->most) {
            w->out->end = w->out->end == MT_MOTION_WHOLE ? MT_MOTION_CAPPED : w->out->end;
            return MT_OK;
        }
        const sample *const a = &w->samples[best];
        MT_TRY(insert_position_sample(w, best + 1, 0.5 * (a[0].at + a[1].at), false, err));
    }
    return MT_OK;
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
        MT_TRY(insert_position_sample(w, at > s->at ? i + 1 : i, at, false, err));
    }
    return MT_OK;
}

static mt_status follow_way(walk *w, double left, double right, mt_err *err)
{
    const int pieces = mt_drive_path_pieces(right - left, w->unit, w->most);
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
static mt_status list_goal_positions(walk *w, int drive_positions, double **list, int *n,
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
            all[given++] = mt_drive_positions_position(w->ws->views[d->view].analysis);
        }
    }
    w->unit = p->families[drive_positions].angle ? 1.0 : sys->length_m;
    *n = mt_drive_path_distinct(given, all, w->unit, *list);
    out->from = (*list)[0];
    out->to = (*list)[*n - 1];
    w->shortest = SHORTEST * (out->to - out->from);
    const int share = mt_drive_path_of_band(w->ws->c, *n - 1);
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
    walk w = {.ws = ws, .d = d, .mem = mem, .out = out};
    MT_TRY(list_goal_positions(&w, drive_positions, &list, &n, err));
    if (n < 2) {
        out->end = MT_MOTION_NONE;
        return MT_OK;
    }
    const mt_status rc = mt_drive_path_open(ws, drive_positions, &why);
    if (mt_is_final(rc) || rc == MT_E_INTERRUPTED) {
        return mt_fail(err, rc, "%s", why.text);
    }
    if (rc != MT_OK) {
        return note_break(&w, out->from, MT_MOTION_BROKEN, why.text, err);
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
