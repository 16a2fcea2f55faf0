/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which corners of the tolerances may be the worst, which goals can be judged there, and their
 * rows. */
#include "problem/robust.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "prove/enclosure.h"

/* All combinations of so many variables whose sign is not known; of more: all low, all high,
 * and each alone against the others. */
enum { COMBINED_MOST = 5 };
/* A target's range is kept within this, relatively. */
static const double ROW_TOLERANCE = MT_DEFAULT_TOLERANCE_PERCENT / 100.0;

/* What raising a variable does. */
enum { FALLS = -1, NOTHING, RISES, UNKNOWN };

double mt_robust_tolerance(const mt_problem *p, int i)
{
    const double percent = p->study->variables[i].tolerance_percent;
    return MT_HAS(percent) ? percent / 100.0 : 0.0;
}

static bool any_tolerance(const mt_problem *p)
{
    for (int i = 0; i < p->n; i++) {
        if (mt_robust_tolerance(p, i) > 0.0) {
            return true;
        }
    }
    return false;
}

bool mt_robust_is_range(const mt_problem *p, const mt_demand *d)
{
    return any_tolerance(p) && MT_HAS(d->equals) && d->goal->tolerance_addr != d->goal->addr;
}

/* The bounds, wider by the tolerances. */
static void widen(const mt_problem *p, double *lower, double *upper)
{
    for (int i = 0; i < p->n; i++) {
        const mt_variable *const v = &p->study->variables[i];
        const double tolerance = mt_robust_tolerance(p, i);
        lower[i] = v->lower - (tolerance * fabs(v->lower));
        upper[i] = v->upper + (tolerance * fabs(v->upper));
    }
}

/* Factor of input i where it is low (side -1), high (1) or does not matter (0). */
static double factor_of(const mt_problem *p, int i, int side)
{
    const double sign = p->study->variables[i].upper > 0.0 ? 1.0 : -1.0;
    return 1.0 + (sign * (double)side * mt_robust_tolerance(p, i));
}

/* Is the j-th of n variables of unknown sign high in combination c? */
static bool is_high(int c, int j, int n)
{
    if (n <= COMBINED_MOST) {
        return ((c >> j) & 1) != 0;
    }
    return c < 2 ? c == 1 : ((c & 1) != 0) != (j == (c - 2) / 2);
}

/* Corner c of sides * combinations: which side, and which combination of the variables of
 * unknown sign. */
static mt_status make_corner(mt_problem *p, const int *signs, int sides, int unknown, int c,
                             mt_corner *out, mt_err *err)
{
    const int side = c % sides;
    int j = 0;
    *out =
        (mt_corner){.factor = mt_arena_f64(&p->mem, (size_t)p->n, 1),
                    .may = {sides == 1 || side == MT_LOWEST, sides == 1 || side == MT_HIGHEST}};
    if (out->factor == NULL) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < p->n; i++) {
        int at = side == MT_LOWEST ? -signs[i] : signs[i];
        if (signs[i] == UNKNOWN) {
            at = is_high(c / sides, j++, unknown) ? 1 : -1;
        }
        out->factor[i] = factor_of(p, i, at);
    }
    return MT_OK;
}

/* The corners that signs[n] leave, without analyses; at least the design itself, where a range
 * has no other rows. */
static mt_status make_corners(mt_problem *p, const int *signs, bool ranged, mt_corner_set *out,
                              mt_err *err)
{
    int known = 0;
    int unknown = 0;
    for (int i = 0; i < p->n; i++) {
        known += signs[i] == RISES || signs[i] == FALLS ? 1 : 0;
        unknown += signs[i] == UNKNOWN ? 1 : 0;
    }
    *out = (mt_corner_set){.exact = unknown == 0};
    if (known + unknown == 0 && !ranged) {
        return MT_OK;
    }
    const int sides = known > 0 ? MT_ROBUST_SIDES : 1;
    const int n = sides * (unknown <= COMBINED_MOST ? 1 << unknown : 2 * (unknown + 1));
    out->corners = mt_arena_alloc(&p->mem, (size_t)n, sizeof *out->corners);
    if (out->corners == NULL) {
        return mt_fail_memory(err);
    }
    for (; out->n < n; out->n++) {
        MT_TRY(make_corner(p, signs, sides, unknown, out->n, &out->corners[out->n], err));
    }
    return MT_OK;
}

/* Bounds on both sides of 0 turn the ends of a relative tolerance over: no sign then says which
 * end is the soft one. */
static int sign_of(const mt_problem *p, int i, bool rises, bool falls)
{
    const mt_variable *const v = &p->study->variables[i];
    const bool turns = v->lower < 0.0 && v->upper > 0.0;
    if (!(mt_robust_tolerance(p, i) > 0.0) || (!rises && !falls)) {
        return NOTHING;
    }
    return turns || (rises && falls) ? UNKNOWN : rises ? RISES : FALLS;
}

/* Signs over the whole box of all variables. */
static mt_status signs_of_view(mt_problem *p, int view, int *signs, mt_err *err)
{
    char reason[MT_REASON_SIZE] = "";
    mt_enclosure *e = NULL;
    MT_TRY(mt_enclosure_new(p->views[view].analysis, p->robust->lower, p->robust->upper, &e,
                            reason, err));
    if (e != NULL) {
        mt_enclosure_effects(e, p->robust->lower, p->robust->upper, signs);
    }
    for (int i = 0; i < p->n; i++) {
        const int effect = e == NULL ? MT_STIFFENS | MT_SOFTENS : signs[i];
        signs[i] = sign_of(p, i, (effect & MT_STIFFENS) != 0, (effect & MT_SOFTENS) != 0);
    }
    mt_enclosure_delete(e);
    return MT_OK;
}

static bool has_range(const mt_problem *p, int view)
{
    bool any = false;
    for (int i = 0; i < p->n_demands; i++) {
        any = any || (p->demands[i].view == view && p->demands[i].ranged);
    }
    return any;
}

static mt_status init_view(mt_problem *p, int view, mt_err *err)
{
    mt_corner_set *const set = &p->robust->views[view];
    int *const signs = mt_arena_int(&p->mem, (size_t)p->n);
    if (signs == NULL) {
        return mt_fail_memory(err);
    }
    MT_TRY(signs_of_view(p, view, signs, err));
    MT_TRY(make_corners(p, signs, has_range(p, view), set, err));
    for (int c = 0; c < set->n; c++) {
        MT_TRY(
            mt_view_analyse(p, &p->views[view], p->original, &set->corners[c].analysis, err));
    }
    return MT_OK;
}

static mt_status check_demand(const mt_demand *d, mt_err *err)
{
    if (d->row_res >= 0) {
        return MT_OK;
    }
    if (d->quantity == MT_QUANTITY_OTHER) {
        return mt_fail(err, MT_E_INPUT,
                       "/goals/%d: a goal of type \"%s\" is not judged over "
                       "\"tolerance_percent\": give it a weight, or the variables no tolerance",
                       d->goal_index, mt_goal_kind_of(d->goal->type)->name);
    }
    return d->mode > 0 ? MT_OK
                       : mt_fail(err, MT_E_INPUT,
                                 "/goals/%d: with \"tolerance_percent\" a mode is meant by its "
                                 "index, as frequencies keep their order over the tolerances: "
                                 "name its number instead of \"%s\"",
                                 d->goal_index, d->goal->mode.mode_name.s);
}

static mt_status init_views(mt_problem *p, mt_err *err)
{
    int *const wanted = mt_arena_int(&p->mem, (size_t)p->n_views + 1);
    if (wanted == NULL) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < p->n_demands; i++) {
        const mt_demand *const d = &p->demands[i];
        if (d->view >= 0) {
            MT_TRY(check_demand(d, err));
            const bool held = d->row_in >= 0 || d->ranged;
            wanted[d->view] = wanted[d->view] || held;
        }
    }
    for (int i = 0; i < p->n_clears; i++) {
        wanted[p->clears[i].view] = 1;
    }
    for (int i = 0; i < p->n_views; i++) {
        if (wanted[i]) {
            MT_TRY(init_view(p, i, err));
        }
    }
    return MT_OK;
}

/* Signs of the expressions' slopes over the bounds decide their corners. */
static mt_status init_limits(mt_problem *p, mt_err *err)
{
    const size_t n = (size_t)p->n;
    const size_t count = (size_t)p->program.count;
    int *const signs = mt_arena_int(&p->mem, n);
    double *const lo = mt_arena_f64(&p->mem, count, 1);
    double *const hi = mt_arena_f64(&p->mem, count, 1);
    double *const dlo = mt_arena_f64(&p->mem, count, n);
    double *const dhi = mt_arena_f64(&p->mem, count, n);
    if (signs == NULL || lo == NULL || hi == NULL || dlo == NULL || dhi == NULL) {
        return mt_fail_memory(err);
    }
    mt_program_interval_gradient(&p->program, p->robust->lower, p->robust->upper, lo, hi, dlo,
                                 dhi);
    for (int k = 0; k < p->n_demands; k++) {
        const mt_demand *const d = &p->demands[k];
        const bool held = d->row_in >= 0 || d->ranged;
        if (d->quantity != MT_QUANTITY_EXPRESSION || !held) {
            continue;
        }
        const size_t row = (size_t)d->node * n;
        for (int i = 0; i < p->n; i++) {
            signs[i] = sign_of(p, i, dhi[row + (size_t)i] > 0.0, dlo[row + (size_t)i] < 0.0);
        }
        MT_TRY(make_corners(p, signs, d->ranged, &p->robust->limits[k], err));
    }
    return MT_OK;
}

/* Rows of one limit at all corners of its side. The worst corner takes the place of the
 * design's own row `own`; where the corners are samples, or there is no such row (-1), they
 * come on top. */
static void list_rows(mt_problem *p, const mt_corner_set *set, const mt_robust_row *what,
                      int own, mt_robust_row *rows)
{
    mt_robust *const r = p->robust;
    for (int c = 0; c < set->n; c++) {
        if (!set->corners[c].may[what->side]) {
            continue;
        }
        if (rows != NULL) {
            rows[r->n_rows] = *what;
            rows[r->n_rows].corner = c;
            rows[r->n_rows].row = set->exact && own >= 0 ? own : p->n_in;
        }
        p->n_in += set->exact && own >= 0 ? 0 : 1;
        r->n_rows++;
    }
}

static void list_demand(mt_problem *p, int demand, mt_robust_row *rows)
{
    const mt_demand *const d = &p->demands[demand];
    const mt_corner_set *const set =
        d->view >= 0 ? &p->robust->views[d->view] : &p->robust->limits[demand];
    const bool target = d->ranged;
    const bool asked[MT_ROBUST_SIDES] = {MT_HAS(d->goal->at_least), MT_HAS(d->goal->at_most)};
    int own = d->row_in;
    for (int side = 0; side < MT_ROBUST_SIDES; side++) {
        if (target || (d->row_in >= 0 && asked[side])) {
            const mt_robust_row what = {.demand = demand,
                                        .side = (mt_robust_side)side,
                                        .tolerance = target ? ROW_TOLERANCE : d->tolerance};
            list_rows(p, set, &what, target ? -1 : own++, rows);
        }
    }
}

static void list_all(mt_problem *p, mt_robust_row *rows)
{
    mt_clear_row at;
    p->robust->n_rows = 0;
    for (int i = 0; i < p->n_demands; i++) {
        list_demand(p, i, rows);
    }
    for (int k = 0; p->below != NULL && mt_clear_row_at(p, p->below, k, &at); k++) {
        const mt_clear *const c = &p->clears[at.clear];
        const mt_robust_row what = {.demand = -1,
                                    .at = at,
                                    .side = at.above ? MT_LOWEST : MT_HIGHEST,
                                    .tolerance = c->tolerance};
        list_rows(p, &p->robust->views[c->view], &what, p->clears[0].row_in + k, rows);
    }
}

/* Number the rows, once to count them and once to keep them, and make room for their
 * tolerances. */
static mt_status init_rows(mt_problem *p, mt_err *err)
{
    mt_robust *const r = p->robust;
    const int before = p->n_in;
    list_all(p, NULL);
    r->rows = mt_arena_alloc(&p->mem, (size_t)r->n_rows, sizeof *r->rows);
    double *const tolerances =
        mt_arena_f64(&p->mem, (size_t)p->n_in + (size_t)p->study->n_objectives, 1);
    if (r->rows == NULL || tolerances == NULL) {
        return mt_fail_memory(err);
    }
    if (before > 0) {
        memcpy(tolerances, p->in_tol, (size_t)before * sizeof *tolerances);
    }
    p->n_in = before;
    list_all(p, r->rows);
    for (int i = 0; i < r->n_rows; i++) {
        tolerances[r->rows[i].row] = r->rows[i].tolerance;
    }
    p->in_tol = tolerances;
    p->n_corner_rows = p->n_in - before;
    return MT_OK;
}

static mt_status claim(mt_problem *p, mt_robust *r, mt_err *err)
{
    const size_t n = (size_t)p->n;
    const size_t count = (size_t)p->program.count;
    const size_t views = (size_t)p->n_views;
    const size_t demands = (size_t)p->n_demands;
    *r = (mt_robust){.views = mt_arena_alloc(&p->mem, views, sizeof *r->views),
                     .limits = mt_arena_alloc(&p->mem, demands, sizeof *r->limits),
                     .n_views = p->n_views,
                     .lower = mt_arena_f64(&p->mem, n, 1),
                     .upper = mt_arena_f64(&p->mem, n, 1),
                     .x = mt_arena_f64(&p->mem, n, 1),
                     .slope = mt_arena_f64(&p->mem, n, 1),
                     .value = mt_arena_f64(&p->mem, count, 1),
                     .grad = mt_arena_f64(&p->mem, count, n),
                     .n_ranges = mt_arena_int(&p->mem, views),
                     .hz = mt_arena_alloc(&p->mem, views, sizeof(mt_robust_range *)),
                     .number = mt_arena_alloc(&p->mem, demands, sizeof *r->number)};
    const bool bad = r->views == NULL || r->limits == NULL || r->lower == NULL ||
                     r->upper == NULL || r->x == NULL || r->slope == NULL || r->value == NULL ||
                     r->grad == NULL || r->n_ranges == NULL || r->hz == NULL ||
                     r->number == NULL;
    return bad ? mt_fail_memory(err) : MT_OK;
}

mt_status mt_robust_init(mt_problem *p, mt_err *err)
{
    if (!any_tolerance(p)) {
        return MT_OK;
    }
    mt_robust *const r = mt_arena_alloc(&p->mem, 1, sizeof *r);
    if (r == NULL) {
        return mt_fail_memory(err);
    }
    MT_TRY(claim(p, r, err));
    widen(p, r->lower, r->upper);
    p->robust = r;
    MT_TRY(init_views(p, err));
    MT_TRY(init_limits(p, err));
    return init_rows(p, err);
}

const mt_robust_row *mt_robust_corner_row(const mt_problem *p, int row)
{
    for (int k = 0;
         p->robust != NULL && row >= p->n_in - p->n_corner_rows && k < p->robust->n_rows; k++) {
        if (p->robust->rows[k].row == row) {
            return &p->robust->rows[k];
        }
    }
    return NULL;
}

void mt_robust_free(mt_robust *r)
{
    for (int i = 0; r != NULL && i < r->n_views; i++) {
        for (int c = 0; c < r->views[i].n; c++) {
            mt_analysis_delete(r->views[i].corners[c].analysis);
        }
    }
}
