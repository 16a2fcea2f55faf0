/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What frequencies and expressions do over the tolerances of one design.
 *
 * The least and greatest of numbers over a box, where nothing is known of them but values and
 * slopes: the corners, points spread over the box, and from the best of these, for each number
 * and side, steps of Frank and Wolfe: to the corner that the slopes point at, or as far towards
 * it as it helps; where that gains nothing, along one input after the other and to points
 * around. A monotone number is settled by the corners, one with its extreme inside by the
 * steps; a number with many extremes may hide one.
 */
#include <math.h>
#include <string.h>

#include "nlp/nlp.h"
#include "problem/configuration.h"
#include "problem/tolerance.h"
#include "prove/enclosure.h"

enum {
    /* inputs of which all corners are tried; of more, the two of all low and all high, and each
     * alone against the others */
    CORNERS_MOST = 6,
    SPREAD_PER_INPUT = 24,
    SPREAD_MOST = 192,
    ROUNDS_MOST = 3,
    MOVES_MOST = 4,
    AROUND_PER_INPUT = 8,
    HALVINGS = 9,  /* of the boxes about the best so far: to a thousandth */
    SECTIONS = 14, /* of a line: to some thousandth of its length */
    /* at a corner from which every slope leads to worse: near it there is nothing better */
    HALVINGS_AT_CORNER = 2,
    SECTIONS_AT_CORNER = 2,
    /* of numbers that nobody limits */
    HALVINGS_COARSE = 3,
    ROUNDS_COARSE = 1
};
/* A step that gains less, relatively, has arrived. */
static const double GAIN = 1e-9;

mt_status mt_tolerance_range_init(int n, mt_arena *mem, mt_tolerance_range *out, mt_err *err)
{
    *out = (mt_tolerance_range){.value = {HUGE_VAL, -HUGE_VAL}};
    for (int side = 0; side < MT_TOLERANCE_SIDES; side++) {
        out->at[side] = mt_arena_f64(mem, (size_t)n, 1);
        MT_TRY(mt_arena_check(mem, err));
    }
    return MT_OK;
}

/* What does not exist somewhere is the least and the greatest there is. */
/* Updates out[m] with value[m] at x. */
static void update_ranges(const mt_tolerance_probe *q, const double *x, const double *value,
                          mt_tolerance_range *out)
{
    for (int k = 0; k < q->m; k++) {
        for (int side = 0; side < MT_TOLERANCE_SIDES; side++) {
            double *const best = &out[k].value[side];
            const bool beyond = side == MT_LOWEST ? value[k] < *best : value[k] > *best;
            if (MT_HAS(*best) && (beyond || !MT_HAS(value[k]))) {
                *best = value[k];
                memcpy(out[k].at[side], x, (size_t)q->n * sizeof *x);
            }
        }
    }
}

typedef struct sampler {
    const mt_tolerance_probe *q;
    mt_tolerance_range *out;
    double *value; /* [m] */
    double *x;     /* [n] work */
    double *from;
    double *to;
    double *slope;
    int n_free;     /* inputs whose interval is not a point */
    bool at_corner; /* the last step began at a corner from which every slope leads to worse */
    int halvings;   /* elsewhere */
    int rounds;     /* of all kinds of moves */
    bool is_coarse; /* the number is one that nobody limits */
    int n_spread;
    const double *spread; /* n x n_spread, the first in the middle */
    /* n x n_explored: corners about which all numbers are known already */
    double *explored;
    int n_explored;
} sampler;

/* Values at x, noted; NaN where there are none. */
static mt_status evaluate_sample(sampler *s, const double *x, bool with_gradient, mt_err *err)
{
    mt_err own = {0};
    const mt_status rc = s->q->eval(s->q->context, x, with_gradient, s->value, &own);
    if (mt_is_final(rc)) {
        return mt_fail(err, rc, "%s", own.text);
    }
    for (int k = 0; k < s->q->m && rc != MT_OK; k++) {
        s->value[k] = nan("");
    }
    update_ranges(s->q, x, s->value, s->out);
    return MT_OK;
}

static bool is_free(const mt_tolerance_probe *q, int i)
{
    return q->lo[i] < q->hi[i];
}

static mt_status visit_corners(sampler *s, mt_err *err)
{
    const int n_free = s->n_free;
    const int most = n_free <= CORNERS_MOST ? 1 << n_free : 2 * (n_free + 1);
    for (int c = 0; c < most; c++) {
        int j = 0;
        for (int i = 0; i < s->q->n; i++) {
            const bool bit = ((c >> (j < CORNERS_MOST ? j : 0)) & 1) != 0;
            const bool alone = c >= 2 && j == (c - 2) / 2;
            const bool high = n_free <= CORNERS_MOST ? bit : ((c & 1) != 0) != alone;
            s->x[i] = high ? s->q->hi[i] : s->q->lo[i];
            j += is_free(s->q, i) ? 1 : 0;
        }
        MT_TRY(evaluate_sample(s, s->x, false, err));
    }
    return MT_OK;
}

/* Points as those that searches start from. */
static mt_status place_sample_points(sampler *s, mt_arena *mem, mt_err *err)
{
    const mt_tolerance_probe *const q = s->q;
    const int wanted = SPREAD_PER_INPUT * s->n_free;
    for (int i = 0; i < q->n; i++) {
        s->x[i] = 0.5 * (q->lo[i] + q->hi[i]);
    }
    const mt_nlp box = {.n = q->n, .lower = q->lo, .upper = q->hi, .origin = s->x};
    s->n_spread = wanted < SPREAD_MOST ? wanted : SPREAD_MOST;
    s->spread = mt_nlp_starts(&box, 0, s->n_spread, mem);
    return mt_arena_check(mem, err);
}

static mt_status visit_spread(sampler *s, mt_err *err)
{
    for (int c = 0; c < s->n_spread; c++) {
        MT_TRY(evaluate_sample(s, s->spread + ((ptrdiff_t)c * s->q->n), false, err));
    }
    return MT_OK;
}

static mt_status visit_between(sampler *s, double part, mt_err *err)
{
    for (int i = 0; i < s->q->n; i++) {
        s->x[i] = part < 1.0 ? s->from[i] + (part * (s->to[i] - s->from[i])) : s->to[i];
    }
    return evaluate_sample(s, s->x, false, err);
}

/* Golden section between from and to, and both. */
static mt_status search_line(sampler *s, int k, mt_tolerance_side side, mt_err *err)
{
    const double golden = 0.5 * (sqrt(5.0) - 1.0);
    const double sign = side == MT_LOWEST ? 1.0 : -1.0;
    double end[2] = {0.0, 1.0};
    double value[2];
    double at[2] = {1.0 - golden, golden};
    for (int i = 0; i < 2; i++) {
        MT_TRY(visit_between(s, at[i], err));
        value[i] = sign * s->value[k];
    }
    const int sections = s->at_corner ? SECTIONS_AT_CORNER : SECTIONS;
    for (int turn = 0; turn < sections; turn++) {
        const int which = value[0] < value[1] ? 0 : 1;
        const int other = 1 - which;
        end[other] = at[other];
        at[other] = at[which];
        value[other] = value[which];
        const double part = golden * (end[1] - end[0]);
        at[which] = which == 0 ? end[1] - part : end[0] + part;
        MT_TRY(visit_between(s, at[which], err));
        value[which] = sign * s->value[k];
    }
    MT_TRY(visit_between(s, 0.0, err));
    return visit_between(s, 1.0, err);
}

/* *changes: value k changes along input i, through its best point, by more than rounding;
 * tested at the ends of i where its slope is 0. */
static mt_status changes_along(sampler *s, int k, int i, double value, bool *changes,
                               mt_err *err)
{
    const mt_tolerance_probe *const q = s->q;
    *changes = false;
    for (int end = 0; end < 2; end++) {
        memcpy(s->x, s->from, (size_t)q->n * sizeof *s->x);
        s->x[i] = end == 0 ? q->lo[i] : q->hi[i];
        MT_TRY(evaluate_sample(s, s->x, false, err));
        *changes = *changes || !(fabs(s->value[k] - value) <= GAIN * fabs(value));
    }
    return MT_OK;
}

/* The slope along input i over its interval. */
static double across(const sampler *s, int i)
{
    return fabs(s->slope[i]) * (s->q->hi[i] - s->q->lo[i]);
}

/* One step from where number k is best so far. */
static mt_status step_to_extreme(sampler *s, int k, mt_tolerance_side side, mt_err *err)
{
    const mt_tolerance_probe *const q = s->q;
    const double before = s->out[k].value[side];
    bool flat = false;
    s->at_corner = false;
    memcpy(s->from, s->out[k].at[side], (size_t)q->n * sizeof *s->from);
    MT_TRY(evaluate_sample(s, s->from, true, err));
    if (!MT_HAS(s->value[k])) {
        return MT_OK;
    }
    mt_err own = {0};
    const mt_status rc = q->slope(q->context, k, s->slope, &own);
    if (rc != MT_OK) {
        return mt_pass_final(rc, &own, err);
    }
    double most = 0.0;
    for (int i = 0; i < q->n; i++) {
        most = fmax(most, across(s, i));
    }
    for (int i = 0; i < q->n; i++) {
        const bool down = (s->slope[i] > 0.0) == (side == MT_LOWEST);
        const bool moves = across(s, i) > GAIN * most;
        bool changes = false;
        s->to[i] = !moves ? s->from[i] : down ? q->lo[i] : q->hi[i];
        if (is_free(q, i) && !moves) {
            MT_TRY(changes_along(s, k, i, before, &changes, err));
        }
        flat = flat || changes;
    }
    if (memcmp(s->from, s->to, (size_t)q->n * sizeof *s->from) == 0) {
        s->at_corner = !flat;
        return MT_OK;
    }
    MT_TRY(evaluate_sample(s, s->to, false, err));
    return s->out[k].value[side] == before ? search_line(s, k, side, err) : MT_OK;
}

/* Sample points in boxes about the best point of value k, each half as wide as the one before:
 * this crosses ridges, where frequencies meet and neither slopes nor axes lead on. */
static mt_status step_around(sampler *s, int k, mt_tolerance_side side, mt_err *err)
{
    const mt_tolerance_probe *const q = s->q;
    double part = 1.0;
    const int halvings = s->at_corner ? HALVINGS_AT_CORNER : s->halvings;
    for (int turn = 0; turn < halvings; turn++) {
        part *= 0.5;
        memcpy(s->from, s->out[k].at[side], (size_t)q->n * sizeof *s->from);
        for (int c = 1; c <= AROUND_PER_INPUT * s->n_free && c < s->n_spread; c++) {
            const double *const to = s->spread + ((ptrdiff_t)c * q->n);
            for (int i = 0; i < q->n; i++) {
                const double x = s->from[i] + (part * (to[i] - s->from[i]));
                s->x[i] = fmin(fmax(x, q->lo[i]), q->hi[i]);
            }
            MT_TRY(evaluate_sample(s, s->x, false, err));
        }
    }
    return MT_OK;
}

/* Each input alone from one end of its interval to the other. */
static mt_status step_along_inputs(sampler *s, int k, mt_tolerance_side side, mt_err *err)
{
    const size_t size = (size_t)s->q->n * sizeof *s->from;
    for (int i = 0; i < s->q->n; i++) {
        if (is_free(s->q, i)) {
            memcpy(s->from, s->out[k].at[side], size);
            memcpy(s->to, s->from, size);
            s->from[i] = s->q->lo[i];
            s->to[i] = s->q->hi[i];
            MT_TRY(search_line(s, k, side, err));
        }
    }
    return MT_OK;
}

typedef mt_status (*move)(sampler *s, int k, mt_tolerance_side side, mt_err *err);

/* One kind of move while it gains. */
static mt_status repeat(sampler *s, move step_of, int k, mt_tolerance_side side, mt_err *err)
{
    const double *const best = &s->out[k].value[side];
    double gain = HUGE_VAL;
    for (int n = 0; n < MOVES_MOST && gain > GAIN * fabs(*best); n++) {
        const double before = *best;
        MT_TRY(step_of(s, k, side, err));
        gain = fabs(*best - before);
    }
    return MT_OK;
}

/* True where another value's search has sampled around the corner where value k is best: all
 * values are recorded at every sample. */
static bool is_explored(const sampler *s, const double *at)
{
    const size_t n = (size_t)s->q->n;
    bool known = false;
    for (int i = 0; i < s->n_explored && !known; i++) {
        known = memcmp(s->explored + ((size_t)i * n), at, n * sizeof *at) == 0;
    }
    return known;
}

static void note_explored(sampler *s, const double *at)
{
    if (s->at_corner && !is_explored(s, at)) {
        memcpy(s->explored + ((ptrdiff_t)s->n_explored++ * s->q->n), at,
               (size_t)s->q->n * sizeof *at);
    }
}

/* True where value k, of values that ascend, meets its neighbours at no sample: it has no
 * ridge, and what slopes call its worst corner is that, but for a second valley. */
static bool is_apart(const sampler *s, int k)
{
    const mt_tolerance_range *const r = s->out;
    const bool below = k == 0 || r[k - 1].value[MT_HIGHEST] < r[k].value[MT_LOWEST];
    const bool above = k + 1 == s->q->m || r[k].value[MT_HIGHEST] < r[k + 1].value[MT_LOWEST];
    return below && above;
}

/* All kinds of moves, until none gains. */
static mt_status descend(sampler *s, int k, mt_tolerance_side side, mt_err *err)
{
    const double *const best = &s->out[k].value[side];
    const double *const at = s->out[k].at[side];
    double gain = HUGE_VAL;
    for (int turn = 0; turn < s->rounds && gain > GAIN * fabs(*best); turn++) {
        const double before = *best;
        MT_TRY(repeat(s, step_to_extreme, k, side, err));
        const bool settled = s->is_coarse && is_apart(s, k);
        if (s->at_corner && (settled || is_explored(s, at))) {
            return MT_OK;
        }
        note_explored(s, at);
        MT_TRY(repeat(s, step_along_inputs, k, side, err));
        MT_TRY(repeat(s, step_around, k, side, err));
        gain = fabs(*best - before);
    }
    return MT_OK;
}

mt_status mt_tolerance_sample(const mt_tolerance_probe *q, mt_arena *mem,
                              mt_tolerance_range *out, mt_err *err)
{
    const size_t n = (size_t)q->n;
    const int n_descend = q->m < q->n_descend ? q->m : q->n_descend;
    const size_t corners = (size_t)ROUNDS_MOST * MT_TOLERANCE_SIDES * (size_t)n_descend;
    sampler s = {.q = q,
                 .out = out,
                 .value = mt_arena_f64(mem, (size_t)q->m, 1),
                 .x = mt_arena_f64(mem, n, 1),
                 .from = mt_arena_f64(mem, n, 1),
                 .to = mt_arena_f64(mem, n, 1),
                 .slope = mt_arena_f64(mem, n, 1),
                 .explored = mt_arena_f64(mem, n, corners)};
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < q->n; i++) {
        s.n_free += is_free(q, i) ? 1 : 0;
    }
    MT_TRY(place_sample_points(&s, mem, err));
    MT_TRY(visit_corners(&s, err));
    MT_TRY(visit_spread(&s, err));
    for (int i = 0; i < MT_TOLERANCE_SIDES * n_descend; i++) {
        const mt_tolerance_side side = (mt_tolerance_side)(i % MT_TOLERANCE_SIDES);
        const int k = i / MT_TOLERANCE_SIDES;
        const mt_tolerance_descent how =
            q->descents == NULL ? MT_DESCENT_FINE : q->descents[k][side];
        s.halvings = how == MT_DESCENT_FINE ? HALVINGS : HALVINGS_COARSE;
        s.rounds = how == MT_DESCENT_FINE ? ROUNDS_MOST : ROUNDS_COARSE;
        s.is_coarse = how == MT_DESCENT_COARSE;
        MT_TRY(how != MT_DESCENT_NONE && MT_HAS(out[k].value[side]) ? descend(&s, k, side, err)
                                                                    : MT_OK);
    }
    return MT_OK;
}

/* Modes of a view that are followed to their worst beside those that goals name: the frequency
 * table lists them. */
enum { FIRST_MODES = 4 };

/* The tolerances of the design at w->x. */
typedef struct box {
    mt_workspace *w;
    mt_arena *mem;
    double *lo; /* [n] */
    double *hi;
    double *soft; /* work */
    double *stiff;
    int *effects;
    bool of_rows; /* descent only to what rows limit */
    mt_ranges *out;
} box;

static mt_status make_box(mt_workspace *w, mt_arena *mem, mt_ranges *out, box *b, mt_err *err)
{
    const size_t n = (size_t)w->p->n;
    *b = (box){.w = w,
               .mem = mem,
               .lo = mt_arena_f64(mem, n, 1),
               .hi = mt_arena_f64(mem, n, 1),
               .soft = mt_arena_f64(mem, n, 1),
               .stiff = mt_arena_f64(mem, n, 1),
               .effects = mt_arena_int(mem, n),
               .out = out};
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < w->p->n; i++) {
        const double half = mt_tolerance_of_variable(w->p, i) * fabs(w->x[i]);
        b->lo[i] = w->x[i] - half;
        b->hi[i] = w->x[i] + half;
    }
    return MT_OK;
}

/* The corners of the lowest and the highest value, from the effect of raising each input;
 * false: an input has both effects. */
static bool find_corners(const box *b)
{
    const double *const x = b->w->x;
    for (int i = 0; i < b->w->p->n; i++) {
        if (b->effects[i] == (MT_STIFFENS | MT_SOFTENS) && b->lo[i] < b->hi[i]) {
            return false;
        }
        const bool falls = b->effects[i] == MT_SOFTENS;
        b->soft[i] = b->effects[i] == 0 ? x[i] : falls ? b->hi[i] : b->lo[i];
        b->stiff[i] = b->effects[i] == 0 ? x[i] : falls ? b->lo[i] : b->hi[i];
    }
    return true;
}

/* Values at the two corners, which are the range. */
static mt_status evaluate_corners(const mt_tolerance_probe *q, const box *b, double *value,
                                  mt_tolerance_range *out, mt_err *err)
{
    for (int side = 0; side < MT_TOLERANCE_SIDES; side++) {
        const double *const x = side == MT_LOWEST ? b->soft : b->stiff;
        MT_TRY(q->eval(q->context, x, false, value, err));
        for (int k = 0; k < q->m; k++) {
            out[k].value[side] = value[k];
            out[k].proven = true;
            memcpy(out[k].at[side], x, (size_t)q->n * sizeof *x);
        }
    }
    return MT_OK;
}

static mt_status range_of(const box *b, mt_tolerance_probe *q, bool proven,
                          mt_tolerance_range *out, mt_err *err)
{
    double *const value = mt_arena_f64(b->mem, (size_t)q->m, 1);
    MT_TRY(mt_arena_check(b->mem, err));
    q->lo = b->lo;
    q->hi = b->hi;
    for (int k = 0; k < q->m; k++) {
        MT_TRY(mt_tolerance_range_init(b->w->p->n, b->mem, &out[k], err));
    }
    return proven && find_corners(b) ? evaluate_corners(q, b, value, out, err)
                                     : mt_tolerance_sample(q, b->mem, out, err);
}

typedef struct modes_of {
    const mt_problem *p;
    mt_analysis *a;
    int m;
    int sloped; /* of which slopes are asked for */
    long *solutions;
} modes_of;

static mt_status eval_modes(void *context, const double *x, bool with_gradient, double *value,
                            mt_err *err)
{
    const modes_of *const c = context;
    const mt_analysis_options opt = {.shapes = {.first = c->sloped},
                                     .gradient = with_gradient,
                                     .vectors = with_gradient,
                                     .accuracy = MT_MODAL_ACCURACY};
    mt_problem_note_modal(c->p, 1);
    ++*c->solutions;
    MT_TRY(mt_analysis_solve(c->a, x, &opt, err));
    for (int k = 0; k < c->m; k++) {
        const int pos = mt_modal_flexible(&c->a->modes, k + 1);
        value[k] = pos >= 0 ? mt_modal_hz(&c->a->modes, pos) : nan("");
    }
    return MT_OK;
}

static mt_status slope_modes(void *context, int k, double *slope, mt_err *err)
{
    const modes_of *const c = context;
    const int pos = mt_modal_flexible(&c->a->modes, k + 1);
    return pos >= 0 ? mt_analysis_dlambda_raw(c->a, pos, slope, err)
                    : mt_fail(err, MT_E_DOMAIN, "no such mode");
}

/* Accuracy of the descent: full for values that a row limits, `others` for the rest:
 * [modes][side]. */
static void choose_descents(const mt_workspace *w, int view, int modes,
                            mt_tolerance_descent others,
                            mt_tolerance_descent (*descents)[MT_TOLERANCE_SIDES])
{
    const mt_subproblem *const c = w->c;
    /* without an assignment bands have no rows yet, and limit all modes up to theirs */
    const int reach = c->below == NULL ? mt_avoidances_reach(w, view) : 0;
    for (int i = 0; i < MT_TOLERANCE_SIDES * modes; i++) {
        const bool reached = reach > 0 && i / MT_TOLERANCE_SIDES <= reach;
        descents[i / MT_TOLERANCE_SIDES][i % MT_TOLERANCE_SIDES] =
            reached ? MT_DESCENT_FINE : others;
    }
    for (int k = mt_tolerance_next_row(c, 0); k >= 0; k = mt_tolerance_next_row(c, k + 1)) {
        const mt_row *const row = &c->rows.in.rows[k];
        if (row->view == view && row->mode >= 1 && row->mode <= modes) {
            descents[row->mode - 1][row->sense] = MT_DESCENT_FINE;
        }
    }
}

typedef mt_tolerance_descent sides_descent[MT_TOLERANCE_SIDES];

static mt_status range_of_modes(const box *b, int view, int modes, mt_analysis *a, mt_err *err)
{
    char reason[MT_REASON_SIZE] = "";
    mt_enclosure *e = NULL;
    sides_descent *const descents = mt_arena_alloc(b->mem, (size_t)modes, sizeof *descents);
    MT_TRY(mt_arena_check(b->mem, err));
    choose_descents(b->w, view, modes, b->of_rows ? MT_DESCENT_NONE : MT_DESCENT_COARSE,
                    descents);
    modes_of c = {.p = b->w->p,
                  .a = a,
                  .m = b->out->n[view],
                  .sloped = modes,
                  .solutions = &b->out->solutions};
    mt_tolerance_probe q = {.n = b->w->p->n,
                            .m = c.m,
                            .n_descend = modes,
                            .descents =
                                (const mt_tolerance_descent(*)[MT_TOLERANCE_SIDES])descents,
                            .context = &c,
                            .eval = eval_modes,
                            .slope = slope_modes};
    MT_TRY(mt_enclosure_new(a, b->lo, b->hi, &e, reason, err));
    if (e != NULL) {
        mt_enclosure_effects(e, b->lo, b->hi, b->effects);
    }
    const bool enclosed = e != NULL;
    mt_enclosure_delete(e);
    return range_of(b, &q, enclosed, b->out->hz[view], err);
}

static mt_status range_view(const box *b, int view, int modes, mt_err *err)
{
    mt_ranges *const r = b->out;
    mt_analysis *a = NULL;
    mt_problem_note_modal(b->w->p, 1);
    r->solutions++;
    mt_status rc = mt_configuration_analyse(b->w->views[view].of, b->w->x, &a, err);
    const int all = rc == MT_OK ? mt_modal_vibrations(&a->modes) : 0;
    r->hz[view] = mt_arena_alloc(b->mem, (size_t)all, sizeof *r->hz[view]);
    r->n[view] = r->hz[view] == NULL ? 0 : all;
    rc = rc == MT_OK ? mt_arena_check(b->mem, err) : rc;
    rc = rc == MT_OK ? range_of_modes(b, view, modes, a, err) : rc;
    mt_analysis_delete(a);
    return rc;
}

typedef struct number_of {
    mt_workspace *w;
    mt_node node;
} number_of;

static mt_status eval_number(void *context, const double *x, bool with_gradient, double *value,
                             mt_err *err)
{
    const number_of *const c = context;
    mt_tolerance_work *const r = c->w->tolerance_box;
    mt_node bad = MT_NO_NODE;
    mt_err own = {0};
    const mt_status rc =
        with_gradient ? mt_program_gradient(&c->w->p->program, x, r->value, r->grad, &bad, &own)
                      : mt_program_eval(&c->w->p->program, x, r->value, &bad, &own);
    *value = r->value[c->node];
    return rc == MT_OK || (rc == MT_E_DOMAIN && bad > c->node)
               ? MT_OK
               : mt_fail(err, rc, "%s", own.text);
}

static mt_status slope_number(void *context, int k, double *slope, mt_err *err)
{
    const number_of *const c = context;
    (void)k;
    (void)err;
    memcpy(slope, c->w->tolerance_box->grad + ((ptrdiff_t)c->node * c->w->p->n),
           (size_t)c->w->p->n * sizeof *slope);
    return MT_OK;
}

/* All limits on expressions, of which one interval evaluation encloses all slopes. */
static mt_status range_numbers(const box *b, mt_err *err)
{
    const mt_problem *const p = b->w->p;
    const size_t n = (size_t)p->n;
    const size_t count = (size_t)p->program.count;
    double *const lo = mt_arena_f64(b->mem, count, 1);
    double *const hi = mt_arena_f64(b->mem, count, 1);
    double *const dlo = mt_arena_f64(b->mem, count, n);
    double *const dhi = mt_arena_f64(b->mem, count, n);
    MT_TRY(mt_arena_check(b->mem, err));
    mt_program_interval_gradient(&p->program, b->lo, b->hi, lo, hi, dlo, dhi);
    for (int k = 0; k < p->n_requirements; k++) {
        const mt_requirement *const d = &p->requirements[k];
        number_of c = {.w = b->w, .node = d->node};
        mt_tolerance_probe q = {.n = p->n,
                                .m = 1,
                                .n_descend = 1,
                                .context = &c,
                                .eval = eval_number,
                                .slope = slope_number};
        if (d->quantity != MT_QUANTITY_EXPRESSION) {
            continue;
        }
        for (int i = 0; i < p->n; i++) {
            const size_t at = ((size_t)d->node * n) + (size_t)i;
            b->effects[i] =
                (dhi[at] > 0.0 ? MT_STIFFENS : 0) | (dlo[at] < 0.0 ? MT_SOFTENS : 0);
        }
        MT_TRY(range_of(b, &q, true, &b->out->number[k], err));
    }
    return MT_OK;
}

/* Number of modes wanted of each configuration; 0: not used. */
static void count_modes(const mt_workspace *w, int *modes)
{
    const mt_problem *const p = w->p;
    for (int i = 0; i < p->n_requirements; i++) {
        const mt_requirement *const d = &p->requirements[i];
        if (d->view >= 0) {
            const int most = d->mode > FIRST_MODES ? d->mode : FIRST_MODES;
            modes[d->view] = most > modes[d->view] ? most : modes[d->view];
        }
    }
    for (int i = 0; i < p->n_avoidances; i++) {
        const int view = p->avoidances[i].view;
        const int reach = mt_avoidances_reach(w, view) + 1;
        const int most = reach > FIRST_MODES ? reach : FIRST_MODES;
        modes[view] = most > modes[view] ? most : modes[view];
    }
}

/* True where a row evaluated at sampled corners limits a mode of the configuration. */
static bool is_sampled_view(const mt_subproblem *c, int view)
{
    bool any = false;
    const bool exact = c->tolerance_box->views[view].exact;
    for (int k = mt_tolerance_next_row(c, 0); k >= 0 && !exact;
         k = mt_tolerance_next_row(c, k + 1)) {
        any = any || view == c->rows.in.rows[k].view;
    }
    return any;
}

static mt_status find_ranges(mt_workspace *w, bool of_rows, const bool *leave, mt_arena *mem,
                             mt_ranges *out, mt_err *err)
{
    const mt_problem *const p = w->p;
    const size_t n_views = (size_t)p->n_views;
    box b;
    int *const modes = mt_arena_int(mem, n_views);
    *out = (mt_ranges){.n_views = p->n_views,
                       .n_limits = p->n_requirements,
                       .n = mt_arena_int(mem, n_views),
                       .hz = mt_arena_alloc(mem, n_views, sizeof(mt_tolerance_range *)),
                       .number =
                           mt_arena_alloc(mem, (size_t)p->n_requirements, sizeof *out->number)};
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(make_box(w, mem, out, &b, err));
    b.of_rows = of_rows;
    count_modes(w, modes);
    for (int i = 0; i < p->n_views; i++) {
        const bool left = leave != NULL && leave[i];
        if (modes[i] > 0 && !left && (!of_rows || is_sampled_view(w->c, i))) {
            MT_TRY(range_view(&b, i, modes[i], err));
        }
    }
    return range_numbers(&b, err);
}

mt_status mt_tolerance_ranges(mt_workspace *w, mt_arena *mem, mt_ranges *out, mt_err *err)
{
    return find_ranges(w, false, NULL, mem, out, err);
}

mt_status mt_tolerance_ranges_of_rows(mt_workspace *w, const bool *leave, mt_arena *mem,
                                      mt_ranges *out, mt_err *err)
{
    return find_ranges(w, true, leave, mem, out, err);
}
