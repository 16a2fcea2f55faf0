/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The cubic through a, b with slopes a', b' at the part u of an interval of length h is
 *     (1 + 2 u)(1 - u)^2 a + u (1 - u)^2 h a' + u^2 (3 - 2 u) b - u^2 (1 - u) h b'.
 */
#include "search/drive_path_guard.h"

#include <math.h>

#include "problem/goals.h"
#include "search/drive_path.h"

/* Greatest turn between two positions [rad], which a spring that passes its own other end at a
 * distance d does within a third of d. */
static const double TURN = 0.35;
static const double PART = 0.25; /* of a clearance, between two positions */
static const double NEAR = 0.02; /* clearances (ln) below it count as it */
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

void mt_guards_query(const mt_requirement *d, mt_analysis_options *opt)
{
    const int most = d->mode + 1;
    opt->gradient = true;
    opt->modes.first =
        opt->modes.first > 0 && opt->modes.first < most ? most : opt->modes.first;
    opt->shapes.first =
        opt->shapes.first > 0 && opt->shapes.first < most ? most : opt->shapes.first;
}

mt_status mt_guards_init(const mt_requirement *d, const mt_analysis *a, mt_arena *mem,
                         mt_guards *out, mt_err *err)
{
    edges e = {.n = 0};
    *out = (mt_guards){.sys = a->sys, .first = d->mode, .last = d->mode};
    if (d->goal->response_limit != NULL) {
        add_range(d->goal->response_limit, &e);
        choose_modes(&a->modes, &e, out);
    } else if (d->quantity == MT_QUANTITY_FREQUENCY) {
        add_edge(&e, d->goal->at_least);
        add_edge(&e, d->goal->at_most);
    }
    const int n_modes = out->last - out->first + 1;
    out->items = mt_arena_alloc(mem, ((size_t)n_modes * (size_t)e.n) + 2, sizeof *out->items);
    out->log_hz = mt_arena_f64(mem, (size_t)n_modes + 2, 1);
    out->rate = mt_arena_f64(mem, (size_t)n_modes + 2, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int mode = out->first; mode <= out->last; mode++) {
        for (int i = 0; i < e.n; i++) {
            out->items[out->n++] = (mt_guard){.mode = mode, .log_edge = log(e.hz[i])};
        }
    }
    if (d->goal->response_limit ==
        NULL) { /* modes are sorted: where two cross, both are others */
        out->items[out->n++] = (mt_guard){.mode = d->mode + 1, .beside = d->mode};
        out->last = d->mode + 1;
        if (d->mode > 1) {
            out->items[out->n++] = (mt_guard){.mode = d->mode, .beside = d->mode - 1};
            out->first = d->mode - 1;
        }
    }
    return MT_OK;
}

mt_status mt_guards_read(const mt_guards *g, mt_analysis *a, mt_arena *mem,
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
        MT_TRY(pos < 0 ? MT_OK : mt_drive_path_rate(a, pos, &g->rate[at], err));
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
        if (moved > PART * fmax(avoidance, NEAR)) {
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
