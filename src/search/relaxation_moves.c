/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What can be moved, which rows that concerns, and how far it has to go at a design. */
#include <math.h>
#include <string.h>

#include "nlp/merit.h"
#include "problem/avoidance.h"
#include "problem/evaluate.h"
#include "problem/objective.h"
#include "problem/requirement.h"
#include "problem/tolerance.h"
#include "search/relaxation.h"

static void append_move(mt_moves *out, mt_move move)
{
    out->items[out->n++] = move;
}

static void add_goal_moves(const mt_problem *p, mt_moves *out)
{
    for (int i = 0; i < p->n_requirements; i++) {
        const mt_requirement *const d = &p->requirements[i];
        const mt_goal *const g = d->goal;
        mt_move m = {.kind = MT_MOVE_GOAL, .requirement = i};
        if (d->role != MT_ROLE_LIMIT && d->role != MT_ROLE_TARGET) { /* no constraint */
            continue;
        }
        if (d->role == MT_ROLE_TARGET) {
            m.target = true;
            m.from = d->equals;
            append_move(out, m);
            continue;
        }
        if (MT_HAS(g->at_least)) {
            m.from = g->at_least;
            append_move(out, m);
        }
        if (MT_HAS(g->at_most)) {
            m.upper = true;
            m.from = g->at_most;
            append_move(out, m);
        }
    }
}

static void add_edge_moves(const mt_problem *p, mt_moves *out)
{
    for (int i = 0; i < p->n_avoidances; i++) {
        for (int b = 0; b < p->avoidances[i].bands.n; b++) {
            const mt_band *const band = &p->avoidances[i].bands.items[b];
            mt_move m = {
                .kind = MT_MOVE_EDGE, .avoidance = i, .band = b, .from = band->lower_hz};
            if (band->lower_hz > 0.0) {
                append_move(out, m);
            }
            m.upper = true;
            m.from = band->upper_hz;
            append_move(out, m);
        }
    }
}

mt_status mt_relaxation_moves(const mt_subproblem *c, mt_arena *mem, mt_moves *out, mt_err *err)
{
    const mt_problem *const p = c->p;
    const size_t most = 2 * ((size_t)p->n + (size_t)p->n_bands + (size_t)p->n_requirements);
    *out = (mt_moves){.items = mt_arena_alloc(mem, most, sizeof *out->items)};
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < p->n; i++) {
        const bool open = p->study->variables[i].n_catalogue == 0;
        for (int side = 0; side < 2 && open; side++) {
            append_move(out, (mt_move){.kind = MT_MOVE_BOUND,
                                       .variable = i,
                                       .upper = side == 1,
                                       .from = side == 1 ? c->upper[i] : c->lower[i]});
        }
    }
    add_edge_moves(p, out);
    add_goal_moves(p, out);
    for (int i = 0; i < out->n; i++) {
        out->items[i].order = i;
        out->items[i].x = mt_arena_f64(mem, (size_t)p->n, 1);
        MT_TRY(mt_arena_check(mem, err));
    }
    return MT_OK;
}

/* A bound moves by a factor of ten at most, or by the range where its sign may change; a bound
 * of 0 stays, since values beyond it have another meaning. */
static double far_bound(const mt_subproblem *c, int i, bool upper)
{
    static const double FACTOR = 10.0;
    const double range = c->upper[i] - c->lower[i];
    const double from = upper ? c->upper[i] : c->lower[i];
    if (upper) {
        return from > 0.0 ? FACTOR * from : from < 0.0 ? from + range : 0.0;
    }
    return from > 0.0 ? from / FACTOR : from < 0.0 ? from - range : 0.0;
}

mt_status mt_relaxation_subproblem(const mt_subproblem *from, const mt_move *m, mt_workspace *w,
                                   mt_arena *mem, mt_subproblem *out, bool *useful, mt_err *err)
{
    static const mt_objective_stage CHANGE = {.type = MT_OBJECTIVE_CHANGE,
                                              .ops = &mt_objective_change,
                                              .size = 1.0,
                                              .node = MT_NO_NODE};
    *useful = true;
    MT_TRY(mt_subproblem_copy(from, mem, out, err));
    out->n_stages = 1;
    out->stages = &CHANGE;
    if (m->kind == MT_MOVE_BOUND) {
        const int i = m->variable;
        const double to = far_bound(from, i, m->upper);
        *useful = m->upper ? to > from->upper[i] : to < from->lower[i];
        mt_subproblem_bound(out, i, m->upper ? from->lower[i] : to,
                            m->upper ? to : from->upper[i]);
    }
    return *useful ? mt_subproblem_lay_out(out, NULL, 0, NULL, w, mem, err) : MT_OK;
}

/* Modes above a band are held by its upper edge. */
bool mt_relaxation_is_row(const mt_move *m, const mt_row *row)
{
    if (m->kind == MT_MOVE_GOAL) {
        const mt_row_sense sense = m->target ? MT_EQUAL : m->upper ? MT_AT_MOST : MT_AT_LEAST;
        return row->requirement == m->requirement && row->sense == sense;
    }
    return m->kind == MT_MOVE_EDGE && row->avoidance == m->avoidance && row->band == m->band &&
           (row->sense == MT_AT_LEAST) == m->upper;
}

/* How the number that moves is measured: edges of bands as frequencies are. */
static mt_goal_measure measure_of(const mt_problem *p, const mt_move *m)
{
    return m->kind == MT_MOVE_GOAL ? p->requirements[m->requirement].measure : MT_MEASURE_RATIO;
}

/* Where the number must be for a row of value `row` (relaxed: what is missing is made up for)
 * to be 0. */
/* Divisor of a difference from the moved number. */
static double unit_of(const mt_problem *p, const mt_move *m)
{
    return m->kind == MT_MOVE_GOAL
               ? mt_requirement_unit(&p->requirements[m->requirement], m->from)
               : 1.0;
}

static double moved(const mt_problem *p, const mt_move *m, double row)
{
    const mt_goal_measure measure = measure_of(p, m);
    const bool lower_edge = m->kind == MT_MOVE_EDGE && !m->upper;
    const bool at_most = m->kind == MT_MOVE_GOAL && m->upper;
    const double sign = lower_edge || at_most ? -1.0 : 1.0;
    return measure == MT_MEASURE_RATIO ? m->from * exp(sign * row)
                                       : m->from + (sign * row * unit_of(p, m));
}

double mt_relaxation_value(const mt_workspace *w, const mt_move *m, const mt_nlp_values *v)
{
    const mt_row_table *const rows = &w->c->rows;
    double worst = m->target ? 0.0 : HUGE_VAL;
    for (int i = 0; i < rows->eq.n; i++) {
        if (mt_relaxation_is_row(m, &rows->eq.rows[i])) {
            worst = v->eq[i];
        } else if (!mt_is_met(fabs(v->eq[i]), rows->eq.tol[i])) {
            return nan("");
        }
    }
    for (int i = 0; i < rows->in.n; i++) {
        if (mt_relaxation_is_row(m, &rows->in.rows[i])) {
            worst = fmin(worst, v->in[i]);
        } else if (!mt_is_met(-v->in[i], rows->in.tol[i])) {
            return nan("");
        }
    }
    return m->kind == MT_MOVE_BOUND ? w->x[m->variable] : moved(w->p, m, worst);
}

double mt_relaxation_size(const mt_problem *p, const mt_move *m, double to)
{
    const bool goal = m->kind == MT_MOVE_GOAL;
    const mt_goal_measure measure = measure_of(p, m);
    const double s =
        measure == MT_MEASURE_RATIO ? log(to / m->from) : (to - m->from) / unit_of(p, m);
    /* a lower limit gives way downwards, an upper edge too */
    const bool down = goal ? !m->upper : m->upper;
    const bool right = m->target ? fabs(s) > 0.0 : (down ? -s : s) > 0.0;
    return right && fabs(s) <= MT_RELAXATION_MOST ? fabs(s) : nan("");
}

bool mt_relaxation_is_less(const mt_move *m, double size, double change)
{
    if (!m->found) {
        return true;
    }
    const int order = mt_compare(size, m->size, MT_EQUAL_FOUND);
    return order < 0 || (order == 0 && mt_compare(change, m->change, MT_EQUAL_FOUND) < 0);
}

void mt_relaxation_keep(mt_move *m, double size, double change, double to, const double *x,
                        int n)
{
    /* of equal sizes the least stays what others are compared with */
    const bool equal = m->found && mt_compare(size, m->size, MT_EQUAL_FOUND) == 0;
    m->size = equal ? fmin(size, m->size) : size;
    m->change = change;
    m->to = to;
    m->found = true;
    memcpy(m->x, x, (size_t)n * sizeof *m->x);
}

void mt_relaxation_merge(mt_moves *to, const mt_moves *from, int n)
{
    for (int i = 0; i < from->n; i++) {
        const mt_move *const m = &from->items[i];
        for (int k = 0; k < to->n && m->found; k++) {
            mt_move *const own = &to->items[k];
            if (own->order == m->order && mt_relaxation_is_less(own, m->size, m->change)) {
                mt_relaxation_keep(own, m->size, m->change, m->to, m->x, n);
            }
        }
    }
}

/* True where a precedes b: by size, equal sizes in the order of the study. */
static bool is_before(const mt_move *a, const mt_move *b, bool equal)
{
    return equal ? a->order < b->order : a->size < b->size;
}

/* By insertion, stable. */
static void sort(mt_move *items, int n, bool equal)
{
    for (int i = 1; i < n; i++) {
        const mt_move m = items[i];
        int at = i;
        for (; at > 0 && is_before(&m, &items[at - 1], equal); at--) {
            items[at] = items[at - 1];
        }
        items[at] = m;
    }
}

void mt_relaxation_rank(mt_moves *moves)
{
    int kept = 0;
    for (int i = 0; i < moves->n; i++) {
        if (moves->items[i].found) {
            moves->items[kept++] = moves->items[i];
        }
    }
    moves->n = kept;
    sort(moves->items, kept, false);
    for (int first = 0, end = 0; first < kept; first = end) {
        const double size = moves->items[first].size;
        while (end < kept && mt_compare(moves->items[end].size, size, MT_EQUAL_FOUND) == 0) {
            end++;
        }
        sort(moves->items + first, end - first, true);
    }
}
