/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The least move of one number that makes a study without designs possible. */
#include "search/relaxation.h"

#include <limits.h>
#include <math.h>
#include <string.h>

#include "base/workers.h"
#include "nlp/merit.h"
#include "problem/avoidance.h"
#include "problem/evaluate.h"
#include "problem/frequency.h"
#include "problem/objective.h"
#include "problem/requirement.h"
#include "problem/tolerance.h"
#include "problem/tolerance_cut.h"
#include "search/catalogue_search.h"
#include "search/drive_path.h"
#include "search/mode_placements.h"
#include "search/proof.h"

/* The design that misses one mode placement by the least, as far as
 * known. */
typedef struct near_miss {
    const int *below;
    const double *t;
    /* [moves] the move's row is active at t; where not, the move changes nothing there */
    bool *presses;
} near_miss;

typedef struct near_misses {
    int n_bands;
    int n;
    near_miss *items;
} near_misses;
/* Largest useful move: a factor of ten (ln 10), or 2.3 times the limit itself where it has no
 * logarithm. */
static const double RELAXATION_MOST = 2.302585092994046;

/* What can be moved, which rows that concerns, and how far it has to go at a design. */

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

/* All possible moves of the study, none tried yet. Fails: MT_E_MEMORY. */
static mt_status relaxation_moves(const mt_subproblem *c, mt_arena *mem, mt_moves *out,
                                  mt_err *err)
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
    out->n_listed = out->n;
    out->useless = mt_arena_alloc(mem, (size_t)out->n, sizeof *out->useless);
    return mt_arena_check(mem, err);
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

/* The subproblem in which the move's bound is removed and the objective is the total change; w
 * is set to it. *useful false, and nothing laid out: no possible move. */
static mt_status relaxation_subproblem(const mt_subproblem *from, const mt_move *m,
                                       mt_workspace *w, mt_arena *mem, mt_subproblem *out,
                                       bool *useful, mt_err *err)
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

/* True where this row of `in` (of the equalities, where eq) is the move's. */
/* Modes above a band are held by its upper edge. */
static bool relaxation_is_row(const mt_move *m, const mt_row *row)
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
        if (relaxation_is_row(m, &rows->eq.rows[i])) {
            worst = v->eq[i];
        } else if (!mt_is_met(fabs(v->eq[i]), rows->eq.tol[i])) {
            return nan("");
        }
    }
    for (int i = 0; i < rows->in.n; i++) {
        if (relaxation_is_row(m, &rows->in.rows[i])) {
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
    return right && fabs(s) <= RELAXATION_MOST ? fabs(s) : nan("");
}

/* True where a move of this size and total change precedes the one found for m: by size or,
 * where sizes are equal, by total change. */
static bool relaxation_is_less(const mt_move *m, double size, double change)
{
    if (!m->found) {
        return true;
    }
    const int order = mt_compare(size, m->size, MT_EQUAL_FOUND);
    return order < 0 || (order == 0 && mt_compare(change, m->change, MT_EQUAL_FOUND) < 0);
}

/* Stores the move to `to` with the design x[n] in m where it precedes the one found. */
static void relaxation_keep(mt_move *m, double size, double change, double to, const double *x,
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

mt_status mt_moves_copy(const mt_moves *from, int n_variables, mt_arena *mem, mt_moves *out,
                        mt_err *err)
{
    const size_t n = (size_t)n_variables;
    *out = *from;
    out->items = mt_arena_alloc(mem, (size_t)from->n, sizeof *out->items);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < from->n; i++) {
        out->items[i] = from->items[i];
        out->items[i].x = mt_arena_f64(mem, n, 1);
        MT_TRY(mt_arena_check(mem, err));
        memcpy(out->items[i].x, from->items[i].x, n * sizeof(double));
    }
    out->useless = mt_arena_alloc(mem, (size_t)from->n_listed, sizeof *out->useless);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < from->n_listed; i++) {
        out->useless[i] = from->useless[i];
    }
    return MT_OK;
}

void mt_relaxation_merge(mt_moves *to, const mt_moves *from, int n)
{
    for (int i = 0; i < from->n; i++) {
        const mt_move *const m = &from->items[i];
        for (int k = 0; k < to->n && m->found; k++) {
            mt_move *const own = &to->items[k];
            if (own->order == m->order && relaxation_is_less(own, m->size, m->change)) {
                relaxation_keep(own, m->size, m->change, m->to, m->x, n);
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

/* Keeps found moves only, smallest first, ties in the order of the study. */
static void relaxation_rank(mt_moves *moves)
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

/*
 * Which moves can help, from the nearest misses. A miss is a stationary point of what the goals
 * fall short by; a row that it does not press against has no multiplier there, and the same
 * point stays stationary, and short of the same goals, however far that row is moved. So a move
 * is worth a search in an assignment only where the miss that is known there presses against
 * its number.
 */

/* A row this far from its limit (0.1 %, as misfits are measured) is not pressed against. */
static const double SLACK = 1e-3;

static bool presses_row(const mt_subproblem *c, const mt_move *m, const mt_nlp_values *v)
{
    for (int i = 0; i < c->rows.eq.n; i++) {
        if (relaxation_is_row(m, &c->rows.eq.rows[i])) {
            return true;
        }
    }
    for (int i = 0; i < c->rows.in.n; i++) {
        if (relaxation_is_row(m, &c->rows.in.rows[i]) && !(v->in[i] > SLACK)) {
            return true;
        }
    }
    return false;
}

static bool presses(const mt_subproblem *c, const mt_move *m, const double *t,
                    const mt_nlp_values *v)
{
    if (m->kind != MT_MOVE_BOUND) {
        return presses_row(c, m, v);
    }
    const int i = m->variable;
    return m->upper ? c->upper_t[i] - t[i] <= SLACK : t[i] - c->lower_t[i] <= SLACK;
}

/* At one miss; all moves are worth it where nothing can be said. */
static mt_status find_pressing_moves(mt_workspace *w, const mt_mode_placement_solution *s,
                                     const mt_moves *moves, mt_arena *mem, near_miss *out,
                                     mt_err *err)
{
    const mt_subproblem *const plain = w->c;
    mt_subproblem c;
    mt_nlp_values v;
    mt_err own = {0};
    out->below = s->below;
    out->t = s->found->t;
    out->presses = mt_arena_alloc(mem, (size_t)moves->n, sizeof *out->presses);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_subproblem_in_placement(plain, s->below, 0, NULL, w, mem, &c, err));
    mt_status rc = mt_subproblem_values_init(&c, mem, &v, &own);
    rc = rc == MT_OK ? mt_workspace_eval(w, out->t, false, &v, &own) : rc;
    for (int k = 0; k < moves->n; k++) {
        out->presses[k] = rc != MT_OK || presses(&c, &moves->items[k], out->t, &v);
    }
    mt_workspace_back(w, plain);
    return mt_pass_final(rc, &own, err);
}

/* Nearest misses; w: set to a subproblem without a placement. placements may be NULL: none. One
 * evaluation each. Fails: MT_E_MEMORY, MT_E_INTERNAL. */
static mt_status relaxation_misses(mt_workspace *w, const mt_mode_placement_result *placements,
                                   const mt_moves *moves, mt_arena *mem, near_misses *out,
                                   mt_err *err)
{
    *out = (near_misses){.n_bands = w->c->n_bands};
    /* of an interrupted search they may be anywhere; of worst corners the rows are not here */
    if (placements == NULL || placements->stop != MT_STOP_DONE ||
        mt_tolerance_is_sampled(w->c)) {
        return MT_OK;
    }
    out->items = mt_arena_alloc(mem, (size_t)placements->n_solutions, sizeof *out->items);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < placements->n_solutions; i++) {
        MT_TRY(find_pressing_moves(w, &placements->solutions[i], moves, mem,
                                   &out->items[out->n], err));
        out->n++;
    }
    return MT_OK;
}

/* The miss of placement below[n_bands]; NULL: none is known. */
static const near_miss *relaxation_miss(const near_misses *misses, const int *below)
{
    const size_t row = (size_t)misses->n_bands * sizeof *below;
    for (int i = 0; i < misses->n; i++) {
        if (memcmp(misses->items[i].below, below, row) == 0) {
            return &misses->items[i];
        }
    }
    return NULL;
}

/*
 * The search for one move. In the coordinates t of the study, with one more, s:
 *     minimise 1/2 s^2   subject to   in_i(t) + s >= 0 (i: rows of the moved number),
 *         eq_i(t) - s = 0,   all other rows as they are;
 * for a bound there is no s: its variable may leave it, and 1/2 (t_j - bound)^2 beyond it is
 * minimised. That says how far, s*, but seldom where: two limits that meet on one frequency
 * leave all designs of that frequency. So once more, from the design that was found and from
 * the original one,
 *     minimise the change 1/2 sum w_i (t_i - t_i(original))^2
 *         subject to the same rows with s = s* + SLACK (the bound beyond by as much),
 * where the slack gives the designs that are left an interior, and their least change one
 * place.
 */

/* Local searches of one move in one assignment, those that are enough where they end at one
 * design (from the original, from what came nearest, and from afar), and what each may cost. */
enum { STARTS = 6, AGREE = 3, EVALUATIONS = 200, ASSIGNMENTS = 6 };
/* Where the study sets a budget: what a search of one move needs at least of it. */
enum { BUDGET_LEAST = 2 * EVALUATIONS };
/* A move smaller than this is none: then a design exists without it, and the search has missed
 * it. */
static const double LEAST = 1e-9;
/* Rounds of cuts of the tolerances, which end where a move that is needed is greater than the
 * one found by no more than rows are kept to. */
enum { ROUNDS = 8 };
static const double ENOUGH = MT_DEFAULT_TOLERANCE_PERCENT / 100.0;
/* Searches for the least change, and the part of a budget that is kept for them. */
enum { STARTS_CHANGE = 2, PART_CHANGE = 4 };
/* Far above what a move is known to (its square root is by how much a design that is the only
 * one moves), and below a digit that is shown of a number, and what rows are kept to. */
static const double RELAXATION_SLACK = 1e-7;

typedef struct relaxed {
    mt_workspace *w;
    const mt_move *move;
    double bound_t; /* of a bound that is moved */
    bool settled;   /* how far is known: the change is minimised */
} relaxed;

typedef struct task_result {
    mt_arena mem;
    long evals;
    int starts;
    bool stopped;
    bool one; /* as of an answer */
} task_result;

typedef struct job {
    mt_workspace *const *workers;
    const mt_subproblem *c;
    mt_moves *moves;
    const double *near;
    const mt_moves_known *known; /* of other studies, or NULL */
    bool sizes; /* of each move how far is sought alone: the least one's design comes after */
    near_misses misses;
    mt_mode_placement_candidates assignments; /* to look into for moves of no bound */
    long budget;                              /* evaluations of each move */
    task_result *results;
} job;

/* 1/2 (distance beyond the old bound)^2. */
static void beyond_bound(const relaxed *r, const double *t, bool with_gradient,
                         mt_nlp_values *out)
{
    const int j = r->move->variable;
    const double d =
        r->move->upper ? fmax(t[j] - r->bound_t, 0.0) : fmin(t[j] - r->bound_t, 0.0);
    out->f = 0.5 * d * d;
    if (with_gradient) {
        memset(out->df, 0, (size_t)r->w->p->n * sizeof *out->df);
        out->df[j] = d;
    }
}

static void relaxation_rows(const relaxed *r, double s, bool with_gradient, mt_nlp_values *out)
{
    const mt_row_table *const rows = &r->w->c->rows;
    const ptrdiff_t n = r->w->p->n;
    const int n_in = rows->in.n;
    const int n_eq = rows->eq.n;
    if (!r->settled) {
        out->f = 0.5 * s * s;
    }
    if (with_gradient && !r->settled) {
        memset(out->df, 0, (size_t)n * sizeof *out->df);
    }
    if (with_gradient) {
        out->df[n] = r->settled ? 0.0 : s;
        memset(out->din + (n * n_in), 0, (size_t)n_in * sizeof *out->din);
        memset(out->deq + (n * n_eq), 0, (size_t)n_eq * sizeof *out->deq);
    }
    for (int i = 0; i < n_in; i++) {
        if (relaxation_is_row(r->move, &rows->in.rows[i])) {
            out->in[i] += s;
            if (with_gradient) {
                out->din[i + (n * n_in)] = 1.0;
            }
        }
    }
    for (int i = 0; i < n_eq; i++) {
        if (relaxation_is_row(r->move, &rows->eq.rows[i])) {
            out->eq[i] -= s;
            if (with_gradient) {
                out->deq[i + (n * n_eq)] = -1.0;
            }
        }
    }
}

static mt_status evaluate_relaxed(void *context, const double *t, bool with_gradient,
                                  mt_nlp_values *out, mt_err *err)
{
    const relaxed *const r = context;
    MT_TRY(mt_workspace_eval_uncounted(r->w, t, with_gradient, out, err));
    if (r->move->kind != MT_MOVE_BOUND) {
        relaxation_rows(r, t[r->w->p->n], with_gradient, out);
    } else if (!r->settled) {
        beyond_bound(r, t, with_gradient, out);
    }
    return MT_OK;
}

/* *kept: over all drives the design stays outside its bands, within their tolerance, and is
 * stable. *positions is increased by the number of samples. Fails: as mt_drive_path_follow. */
static mt_status keeps_drive_paths(mt_workspace *ws, const int *below, mt_arena *mem,
                                   bool *kept, long *positions, mt_err *err)
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

/* A design found with the move: what a workspace made anew says of it. */
typedef struct answer {
    mt_arena *mem;
    const double *near;     /* [n] where the search begins; NULL: nowhere */
    const mt_move *known;   /* the same of another study, or NULL */
    bool one;               /* all searches for how far ended at one design */
    double *x;              /* [n] */
    double value;           /* that the number must have there; NaN: it does not do */
    long evals;             /* of its confirmations */
    mt_tolerance_cuts cuts; /* so far */
} answer;

/* The number that the move needs at the design t, over its tolerances, too. */
static mt_status confirm(mt_workspace *w, const mt_move *m, const double *t, answer *a,
                         mt_err *err)
{
    mt_nlp_values v;
    mt_err own = {0};
    MT_TRY(mt_subproblem_values_init(w->c, a->mem, &v, err));
    mt_status rc = mt_workspace_eval(w, t, false, &v, &own);
    a->evals++;
    rc = rc == MT_OK ? mt_tolerance_lower(w, &v, a->mem, &a->cuts, &own) : rc;
    if (rc != MT_OK) {
        return mt_pass_final(rc, &own, err);
    }
    a->value = mt_relaxation_value(w, m, &v);
    memcpy(a->x, w->x, (size_t)w->p->n * sizeof *a->x);
    /* The design has to hold between the positions of its drives, too. An edge is moved in one
     * position only, which says nothing of the others. */
    if (mt_drive_positions_any(w->p) && w->c->below != NULL) {
        bool kept = m->kind != MT_MOVE_EDGE;
        MT_TRY(kept ? keeps_drive_paths(w, w->c->below, a->mem, &kept, &a->evals, err) : MT_OK);
        a->value = kept ? a->value : nan("");
    }
    return MT_OK;
}

/* Keeps the design t of a move of that size where it precedes the one found and a new workspace
 * confirms it. *again: the move does not suffice for the worst within the tolerances, and a cut
 * was added. */
static mt_status keep_confirmed_move(const mt_subproblem *c, mt_move *m, double size,
                                     const double *t, answer *a, bool *again, mt_err *err)
{
    mt_workspace *fresh = NULL;
    const double change = mt_subproblem_change(c, t);
    a->value = nan("");
    a->cuts.added = 0;
    *again = false;
    if (!relaxation_is_less(m, size, change)) {
        return MT_OK;
    }
    MT_TRY(mt_workspace_new(c->p, &fresh, err));
    mt_status rc = mt_workspace_use(fresh, c, err);
    rc = rc == MT_OK ? confirm(fresh, m, t, a, err) : rc;
    mt_workspace_delete(fresh);
    MT_TRY(rc);
    if (mt_tolerance_is_sampled(c)) {
        const double needed =
            MT_HAS(a->value) ? mt_relaxation_size(c->p, m, a->value) : HUGE_VAL;
        *again = a->cuts.added > 0 && !(needed <= size + ENOUGH);
        size = needed > size + RELAXATION_SLACK ? needed : size;
    }
    if (MT_HAS(a->value) && relaxation_is_less(m, size, change)) {
        relaxation_keep(m, size, change, a->value, a->x, c->p->n);
    }
    return MT_OK;
}

static mt_nlp nlp_of(relaxed *r, mt_subproblem *c, const double *near, double *hint)
{
    const mt_move *const m = r->move;
    const int n = c->p->n;
    mt_nlp nlp = mt_workspace_nlp(r->w);
    nlp.eval = evaluate_relaxed;
    nlp.n_next = 0; /* they follow from rows that may be moved */
    nlp.context = r;
    nlp.hint = NULL;
    if (near != NULL) {
        memcpy(hint, near, (size_t)n * sizeof *hint);
        nlp.hint = hint;
    }
    if (m->kind == MT_MOVE_BOUND) {
        r->bound_t = mt_problem_t(c->p, m->variable, m->from);
        return nlp;
    }
    /* a case keeps room for one more coordinate */
    nlp.n = n + 1;
    c->lower_t[n] = m->target ? -RELAXATION_MOST : 0.0;
    c->upper_t[n] = RELAXATION_MOST;
    c->origin_t[n] = 0.0;
    hint[n] = 0.5 * RELAXATION_MOST;
    return nlp;
}

/* Evaluations left for the move, without those of its confirmations and of following drives. */
static long left_of(const job *j, const mt_subproblem *c, const task_result *out,
                    const answer *a)
{
    return j->budget - out->evals - a->evals - (2 * (1 + mt_drive_path_most(c)));
}

/* nlp and opt: of the search for how far. */
static mt_status solve_move_size(mt_workspace *w, const mt_nlp *nlp, const mt_nlp_options *opt,
                                 task_result *out, mt_nlp_result *found, mt_err *err)
{
    mt_err why = {0};
    const mt_status own = mt_workspace_solve(w, nlp, opt, &out->mem, found, &why);
    out->evals += found->evals;
    out->starts += found->starts;
    out->stopped = out->stopped || found->stop == MT_STOP_USER;
    if (own != MT_OK) {
        found->n_solutions = 0;
    }
    return mt_pass_final(own, &why, err);
}

/* Searches the least total change with the move found; *to: its end, NULL: none found or no
 * budget. one: all searches ended at one design, so the slack allows only designs around it. */
static mt_status search_least_change(mt_nlp nlp, mt_nlp_options opt, const double *found,
                                     bool one, long left, task_result *out, const double **to,
                                     mt_err *err)
{
    relaxed *const r = nlp.context;
    const int k = r->move->kind == MT_MOVE_BOUND ? r->move->variable : nlp.n - 1;
    const bool down = r->move->kind == MT_MOVE_BOUND ? !r->move->upper : found[k] < 0.0;
    const double most = found[k] + (down ? -RELAXATION_SLACK : RELAXATION_SLACK);
    const size_t size = (size_t)nlp.n * sizeof *found;
    double *const lower = mt_arena_f64(&out->mem, (size_t)nlp.n, 1);
    double *const upper = mt_arena_f64(&out->mem, (size_t)nlp.n, 1);
    mt_nlp_result least = {0};
    *to = NULL;
    MT_TRY(mt_arena_check(&out->mem, err));
    if (left <= 0 || out->stopped) {
        return MT_OK;
    }
    memcpy(lower, nlp.lower, size);
    memcpy(upper, nlp.upper, size);
    lower[k] = r->move->kind == MT_MOVE_BOUND && !down ? lower[k] : fmax(most, lower[k]);
    upper[k] = r->move->kind == MT_MOVE_BOUND && down ? upper[k] : fmin(most, upper[k]);
    nlp.lower = lower;
    nlp.upper = upper;
    nlp.hint = found;
    opt.starts = STARTS_CHANGE;
    opt.skip = one ? STARTS_CHANGE - 1 : 0;
    opt.agree = 0;
    opt.max_evals =
        left < (long)STARTS_CHANGE * EVALUATIONS ? left : (long)STARTS_CHANGE * EVALUATIONS;
    r->settled = true;
    MT_TRY(solve_move_size(r->w, &nlp, &opt, out, &least, err));
    *to = least.n_solutions > 0 && least.solutions[0].feasible ? least.solutions[0].t : NULL;
    return MT_OK;
}

/* The move of the same number that another study has; NULL: it has none. */
static const mt_move *find_known_move(const mt_moves_known *known, const mt_move *m)
{
    for (int i = 0; i < known->moves->n; i++) {
        const mt_move *const k = &known->moves->items[i];
        if (k->kind == m->kind && k->upper == m->upper && k->variable == m->variable &&
            k->avoidance == m->avoidance && k->band == m->band &&
            k->requirement == m->requirement && k->target == m->target) {
            return k;
        }
    }
    return NULL;
}

/* The coordinates of a design that goes with s, into out[n + 1]. */
static void coordinates_of(const mt_problem *p, const mt_move *m, double s, double *out)
{
    for (int i = 0; i < p->n; i++) {
        out[i] = mt_problem_t(p, i, m->x[i]);
    }
    out[p->n] = m->target && m->to < m->from ? -s : s;
}

/* How far, from the design of the other study's move alone. *enough: the search ended at a
 * local minimum. */
static mt_status search_from_known(mt_nlp nlp, mt_nlp_options opt, const mt_move *known,
                                   task_result *out, mt_nlp_result *found, bool *enough,
                                   mt_err *err)
{
    const relaxed *const r = nlp.context;
    const mt_problem *const p = r->w->p;
    double *const hint = mt_arena_f64(&out->mem, (size_t)p->n + 1, 1);
    MT_TRY(mt_arena_check(&out->mem, err));
    const double size = mt_relaxation_size(p, r->move, known->to);
    coordinates_of(p, known, MT_HAS(size) ? size : known->size, hint);
    nlp.hint = hint;
    opt.starts = 2;
    opt.skip = 1;
    opt.agree = 0;
    opt.no_compromise = true;
    MT_TRY(solve_move_size(r->w, &nlp, &opt, out, found, err));
    *enough = found->n_solutions > 0 && found->solutions[0].feasible &&
              !(found->solutions[0].kkt > MT_STATIONARY);
    return MT_OK;
}

/* One search in subproblem c, to which w is set. */
static mt_status search_once(const job *j, mt_subproblem *c, mt_workspace *w, mt_move *m,
                             task_result *out, answer *a, bool *again, mt_err *err)
{
    relaxed r = {.w = w, .move = m};
    mt_nlp_result found = {0};
    mt_nlp_options opt = mt_nlp_options_default();
    opt.seed = c->search.seed;
    opt.starts = STARTS;
    const long most = (long)STARTS * EVALUATIONS;
    long left = left_of(j, c, out, a);
    left -= left / PART_CHANGE;
    *again = false;
    if (left <= 0) {
        return MT_OK;
    }
    opt.max_evals = left < most ? left : most;
    opt.agree = AGREE;
    opt.max_solutions = 1;
    opt.least_change = false;
    double *const hint = mt_arena_f64(&out->mem, (size_t)c->p->n + 1, 1);
    MT_TRY(mt_arena_check(&out->mem, err));
    const mt_nlp nlp = nlp_of(&r, c, a->near, hint);
    bool enough = false;
    if (a->known != NULL) {
        MT_TRY(search_from_known(nlp, opt, a->known, out, &found, &enough, err));
    }
    MT_TRY(enough ? MT_OK : solve_move_size(w, &nlp, &opt, out, &found, err));
    if (found.n_solutions == 0) {
        return MT_OK;
    }
    const mt_nlp_solution *const s = &found.solutions[0];
    const double size = sqrt(2.0 * s->f);
    if (!(size > LEAST) || !s->feasible || !relaxation_is_less(m, size, 0.0)) {
        return MT_OK;
    }
    const double *least = NULL;
    a->value = nan("");
    a->one = enough || (found.starts == AGREE && s->hits == AGREE);
    MT_TRY(j->sizes ? MT_OK
                    : search_least_change(nlp, opt, s->t, a->one, left_of(j, c, out, a), out,
                                          &least, err));
    MT_TRY(least != NULL ? keep_confirmed_move(c, m, size, least, a, again, err) : MT_OK);
    return MT_HAS(a->value) || *again ? MT_OK
                                      : keep_confirmed_move(c, m, size, s->t, a, again, err);
}

/* Search in subproblem c, to which w is set; afterwards in that with cuts, to which w is then
 * set. */
static mt_status search_in(const job *j, mt_subproblem *c, mt_workspace *w, mt_move *m,
                           const double *near, task_result *out, mt_err *err)
{
    mt_arena *const mem = &out->mem;
    answer a = {.mem = mem, .near = near, .x = mt_arena_f64(mem, (size_t)c->p->n, 1)};
    for (const mt_moves_known *o = j->known; o != NULL && a.known == NULL; o = o->next) {
        a.known = c->p->n_avoidances == 0 ? find_known_move(o, m) : NULL;
    }
    bool again = true;
    MT_TRY(mt_arena_check(mem, err));
    mt_status rc = search_once(j, c, w, m, out, &a, &again, err);
    for (int round = 1; again && round < ROUNDS && rc == MT_OK; round++) {
        mt_subproblem *const held = mt_arena_alloc(mem, 1, sizeof *held);
        MT_TRY(mt_arena_check(mem, err));
        MT_TRY(mt_subproblem_copy(c, mem, held, err));
        MT_TRY(mt_tolerance_add_cuts(c, &a.cuts, mem, &held->tolerance_box, err));
        MT_TRY(mt_subproblem_lay_out(held, c->below, 0, NULL, w, mem, err));
        rc = search_once(j, held, w, m, out, &a, &again, err);
    }
    out->evals += a.evals;
    out->one = a.one;
    return rc;
}

/* With bands: search in each placement that samples come nearest to, except where the move
 * cannot help the known miss. (A bound at which no miss stands may still open a way: in five of
 * 56 random studies with an answer it does.) Samples within the study's own bounds are the same
 * for all moves. */
static mt_status search_placements(const job *j, const mt_subproblem *plain, mt_workspace *w,
                                   int move, task_result *out, mt_err *err)
{
    mt_move *const m = &j->moves->items[move];
    mt_mode_placement_candidates near = j->assignments;
    mt_status rc = MT_OK;
    if (m->kind == MT_MOVE_BOUND) {
        rc = mt_mode_placement_candidates_near(w, ASSIGNMENTS, 0, &out->mem, &near, err);
        out->evals += near.evals;
    }
    for (int k = 0; k < near.n && rc == MT_OK && !out->stopped; k++) {
        mt_subproblem c;
        const int *const below = near.below + ((ptrdiff_t)k * plain->n_bands);
        const near_miss *const miss = relaxation_miss(&j->misses, below);
        if (miss != NULL && !miss->presses[move] && m->kind != MT_MOVE_BOUND) {
            continue;
        }
        rc = mt_subproblem_in_placement(plain, below, 0, NULL, w, &out->mem, &c, err);
        rc = rc == MT_OK ? search_in(j, &c, w, m, miss != NULL ? miss->t : j->near, out, err)
                         : rc;
        mt_workspace_back(w, plain);
    }
    return rc;
}

/* True where a short proof shows that no such move makes a design feasible, in its subproblem
 * c. For a bound only the range between the old and the new one is examined. */
static mt_status is_useless(const job *j, const mt_subproblem *c, const mt_move *m,
                            mt_arena *mem, bool *useless, mt_err *err)
{
    const int i = m->variable;
    mt_subproblem beyond = *c;
    if (m->kind == MT_MOVE_BOUND) {
        MT_TRY(mt_subproblem_copy(c, mem, &beyond, err));
        mt_subproblem_bound(&beyond, i, m->upper ? j->c->upper[i] : c->lower[i],
                            m->upper ? c->upper[i] : j->c->lower[i]);
    }
    const mt_infeasible_presolve_question q = {.c = &beyond,
                                               .but = m->kind == MT_MOVE_GOAL ? m->requirement
                                                                              : -1,
                                               .bands = m->kind != MT_MOVE_EDGE,
                                               .counted = true};
    return mt_infeasible_presolve(&q, mem, useless, err);
}

/* True where the studies differ in nothing but the number that moves: what remains without it
 * is the same. */
static bool is_the_difference(const job *j, const mt_vary *v, const mt_move *m)
{
    const mt_problem *const p = j->c->p;
    int of_goal = 0;
    if (v->kind != MT_VARY_GOAL || m->kind != MT_MOVE_GOAL || m->target ||
        v->slot != (m->upper ? MT_SLOT_AT_MOST : MT_SLOT_AT_LEAST) ||
        measure_of(p, m) != MT_MEASURE_RATIO) {
        return false;
    }
    for (int i = 0; i < p->n_requirements; i++) {
        of_goal += p->requirements[i].goal_index == v->goal;
    }
    return of_goal == 1 && p->requirements[m->requirement].goal_index == v->goal;
}

/* Takes the other study's design, w being set to c; as far as the number is farther from it. */
static mt_status take_known(mt_workspace *w, const mt_move *known, mt_move *m, task_result *out,
                            mt_err *err)
{
    const mt_problem *const p = w->p;
    answer a = {.mem = &out->mem, .x = mt_arena_f64(&out->mem, (size_t)p->n, 1)};
    double *const t = mt_arena_f64(&out->mem, (size_t)p->n + 1, 1);
    const double size = known->size + (mt_relaxation_size(p, m, known->to) -
                                       mt_relaxation_size(p, known, known->to));
    bool again = false;
    MT_TRY(mt_arena_check(&out->mem, err));
    if (!(size > LEAST)) {
        return MT_OK;
    }
    coordinates_of(p, known, size, t);
    MT_TRY(keep_confirmed_move(w->c, m, size, t, &a, &again, err));
    out->evals += a.evals;
    m->least_change = m->found && known->least_change;
    return MT_OK;
}

/* True where the move is useless in a study that has all designs of this one, however far it
 * goes from where its number is there. */
static bool is_known_useless(const mt_moves_known *o, const mt_move *m)
{
    const mt_vary *const v = o->number;
    const bool own = v->kind == MT_VARY_BOUND && m->kind == MT_MOVE_BOUND;
    return o->looser && !own && m->order < o->moves->n_listed && o->moves->useless[m->order];
}

/* Searches move k for the study's rows, which w is set to. */
static mt_status search_useful(const job *j, mt_subproblem *c, mt_workspace *w, int k,
                               task_result *out, mt_err *err)
{
    mt_move *const m = &j->moves->items[k];
    bool *const useless = &j->moves->useless[k];
    for (const mt_moves_known *o = j->known; o != NULL && j->sizes && !m->found; o = o->next) {
        const mt_move *const known = find_known_move(o, m);
        if (known != NULL && is_the_difference(j, o->number, m)) {
            MT_TRY(take_known(w, known, m, out, err));
        }
        *useless = *useless || is_known_useless(o, m);
    }
    if (!m->found && !*useless) {
        MT_TRY(is_useless(j, c, m, &out->mem, useless, err));
    }
    if (m->found || *useless) {
        return MT_OK;
    }
    return w->p->n_avoidances > 0 ? search_placements(j, c, w, k, out, err)
                                  : search_in(j, c, w, m, j->near, out, err);
}

/* The design of least change of the least move, of which only how far is known. */
static mt_status search_least_of_all(job *j, mt_move *m, mt_err *err)
{
    mt_workspace *const w = j->workers[0];
    task_result *const out = &j->results[m->order];
    const mt_problem *const p = w->p;
    relaxed r = {.w = w, .move = m};
    answer a = {.mem = &out->mem, .x = mt_arena_f64(&out->mem, (size_t)p->n, 1)};
    double *const found = mt_arena_f64(&out->mem, (size_t)p->n + 1, 1);
    double *const hint = mt_arena_f64(&out->mem, (size_t)p->n + 1, 1);
    const double *least = NULL;
    mt_subproblem c;
    bool useful = false;
    bool again = false;
    MT_TRY(mt_arena_check(&out->mem, err));
    mt_status rc = relaxation_subproblem(j->c, m, w, &out->mem, &c, &useful, err);
    if (rc == MT_OK && useful) {
        mt_nlp_options opt = mt_nlp_options_default();
        opt.seed = c.search.seed;
        opt.max_solutions = 1;
        opt.least_change = false;
        coordinates_of(p, m, m->size, found);
        const mt_nlp nlp = nlp_of(&r, &c, NULL, hint);
        rc = search_least_change(nlp, opt, found, out->one, LONG_MAX, out, &least, err);
    }
    rc = rc == MT_OK && least != NULL
             ? keep_confirmed_move(&c, m, m->size, least, &a, &again, err)
             : rc;
    out->evals += a.evals;
    m->least_change = true;
    mt_workspace_back(w, j->c);
    return rc;
}

static mt_status search_move(void *context, int worker, int k, mt_task_path *own, mt_err *err)
{
    const job *const j = context;
    mt_workspace *const w = j->workers[worker];
    mt_task_path *const before = w->task_path;
    mt_move *const m = &j->moves->items[k];
    task_result *const out = &j->results[k];
    mt_subproblem c;
    bool useful = false;
    MT_TRY(mt_arena_init(&out->mem, 0, err));
    w->task_path = own;
    mt_status rc = relaxation_subproblem(j->c, m, w, &out->mem, &c, &useful, err);
    if (rc == MT_OK && useful) {
        rc = search_useful(j, &c, w, k, out, err);
    }
    w->task_path = before;
    mt_workspace_back(w, j->c);
    return rc;
}

/* With bands: the nearest misses, found before any move is tried. */
static mt_status look_around(job *j, const mt_mode_placement_result *placements, mt_arena *mem,
                             mt_moves *out, mt_err *err)
{
    mt_workspace *const w = j->workers[0];
    MT_TRY(relaxation_misses(w, placements, out, mem, &j->misses, err));
    MT_TRY(mt_mode_placement_candidates_near(w, ASSIGNMENTS, 0, mem, &j->assignments, err));
    out->evals += j->misses.n + j->assignments.evals;
    return MT_OK;
}

mt_status mt_relaxation_solve(mt_workspace *const *workers, int n_workers,
                              const mt_nlp_result *search,
                              const mt_mode_placement_result *placements,
                              const mt_moves_known *known, mt_arena *mem, mt_moves *out,
                              mt_err *err)
{
    const mt_subproblem *const c = workers[0]->c;
    MT_TRY(relaxation_moves(c, mem, out, err));
    const long most = c->search.max_evaluations; /* if the study sets one: an equal share */
    const long left = most - search->evals;
    job j = {.workers = workers,
             .c = c,
             .moves = out,
             .near = search->n_solutions > 0 ? search->solutions[0].t : NULL,
             .known = known,
             .sizes = c->p->study->examined && most <= 0 && c->n_avoidances == 0 &&
                      !mt_tolerance_is_sampled(c),
             .budget = most > 0 && out->n > 0 ? left / out->n : LONG_MAX,
             .results = mt_arena_alloc(mem, (size_t)out->n, sizeof *j.results)};
    const int n = out->n;
    const int least = c->n_avoidances > 0 ? BUDGET_LEAST + MT_GAP_SAMPLES_NEAR : BUDGET_LEAST;
    MT_TRY(mt_arena_check(mem, err));
    out->short_of_budget = j.budget < least;
    if (out->short_of_budget) {
        out->n = 0;
        return MT_OK;
    }
    if (c->n_avoidances > 0) {
        MT_TRY(look_around(&j, placements, mem, out, err));
        j.budget = most > 0 ? (left - out->evals) / out->n : LONG_MAX;
    }
    const mt_tasks tasks = {n, search_move, NULL, &j, "changes of the question"};
    mt_status rc = mt_workers_run(n_workers, workers[0]->task_path, &tasks, err);
    relaxation_rank(out);
    for (int k = 0; k < n; k++) {
        out->stopped = out->stopped || j.results[k].stopped;
    }
    if (rc == MT_OK && j.sizes && out->n > 0 && !out->items[0].least_change && !out->stopped) {
        rc = search_least_of_all(&j, &out->items[0], err);
    }
    for (int k = 0; k < n; k++) {
        out->evals += j.results[k].evals;
        out->starts += j.results[k].starts;
        mt_arena_free(&j.results[k].mem);
    }
    return rc;
}

/*
 * The same question where variables come from catalogues. Without continuous variables every
 * combination is a design, and all are looked at: a move is possible where its rows, and
 * nothing else, are in the way, and it has to go as far as they say. That is exact. With
 * continuous variables the combinations that came nearest are closed on their values and
 * searched as in relaxation.c.
 */

/* Combinations in one task; combinations that came nearest which are looked at where there are
 * continuous variables. */
enum { PER_TASK = 256, NEAREST = 4 };

typedef struct enumeration {
    mt_workspace *const *workers;
    mt_nlp_values *values; /* [n_workers] */
    int total;
    mt_moves *tasks; /* [n_tasks] the least of each among a task's combinations */
    bool *stopped;   /* [n_tasks] */
} enumeration;

/* Coordinates of combination k: the last catalogue varies fastest. */
static void set_combination(const mt_problem *p, int k, double *t)
{
    int left = k;
    for (int c = p->n_choices - 1; c >= 0; c--) {
        const mt_choice *const own = &p->choices[c];
        const double *const row = mt_choice_row(own, left % own->n_rows);
        for (int j = 0; j < own->n; j++) {
            t[own->first + j] = mt_problem_t(p, own->first + j, row[j]);
        }
        left /= own->n_rows;
    }
}

/* Frequency to which the edge of a band must move for the modes inside it to be outside; 0
 * where none is inside. NaN: unstable, or undecided. */
static double let_through(const mt_band *band, const mt_modes *modes, bool upper)
{
    double hz = mt_modal_indexed(modes) ? 0.0 : nan("");
    for (int i = 0; i < modes->count; i++) {
        const double f = modes->kind[i] == MT_MODE_FLEXIBLE ? mt_modal_hz(modes, i) : 0.0;
        if (f > band->lower_hz && f < band->upper_hz && MT_HAS(hz)) {
            /* the modes inside then lie above the upper edge, or below the lower one */
            hz = upper ? (hz > 0.0 ? fmin(hz, f) : f) : fmax(hz, f);
        }
    }
    return hz;
}

static const mt_modes *modes_of(const mt_workspace *w, int avoidance)
{
    return &w->views[w->c->avoidances[avoidance].view].analysis->modes;
}

/* Bands with a mode inside (beyond the tolerance), but the move's own. */
static bool other_bands_hold(const mt_workspace *w, const mt_move *m)
{
    for (int i = 0; i < w->c->n_avoidances; i++) {
        const mt_avoidance *const c = &w->c->avoidances[i];
        const int own = m->kind == MT_MOVE_EDGE && m->avoidance == i ? m->band : -1;
        mt_mode_band_pair p = mt_mode_band_pairs_all(modes_of(w, i), &c->bands);
        while (mt_mode_band_pairs_next(&p)) {
            if (p.b != own && mt_band_margin(p.band, p.hz, p.hz) < -c->tolerance) {
                return false;
            }
        }
        if (!mt_modal_indexed(p.modes)) {
            return false;
        }
    }
    return true;
}

/* Where the move's number has to be at the design just evaluated; NaN where that is not
 * enough. */
static double needed(const mt_workspace *w, const mt_move *m, const mt_nlp_values *v)
{
    const double rows = mt_relaxation_value(w, m, v);
    if (!MT_HAS(rows) || !other_bands_hold(w, m)) {
        return nan("");
    }
    if (m->kind != MT_MOVE_EDGE) {
        return rows;
    }
    if (w->c->tolerance_box != NULL) {
        return nan(""); /* the modes at hand are not those of the worst corner */
    }
    const mt_band *const band = &w->c->avoidances[m->avoidance].bands.items[m->band];
    const double f = let_through(band, modes_of(w, m->avoidance), m->upper);
    return f > 0.0 ? f : nan("");
}

static void record_needed_moves(const mt_workspace *w, const mt_nlp_values *v, mt_moves *moves)
{
    const double change = mt_subproblem_change(w->c, w->t);
    for (int k = 0; k < moves->n; k++) {
        mt_move *const m = &moves->items[k];
        const double to = needed(w, m, v);
        const double size = mt_relaxation_size(w->p, m, to);
        if (size > 0.0 && relaxation_is_less(m, size, change)) {
            relaxation_keep(m, size, change, to, w->x, w->p->n);
        }
    }
}

static mt_status look_at_some(void *context, int worker, int task, mt_task_path *place,
                              mt_err *err)
{
    (void)place;
    const enumeration *const e = context;
    mt_workspace *const w = e->workers[worker];
    const int end = (task + 1) * PER_TASK < e->total ? (task + 1) * PER_TASK : e->total;
    mt_nlp_values *const v = &e->values[worker];
    for (int k = task * PER_TASK; k < end && !e->stopped[task]; k++) {
        mt_err own = {0};
        set_combination(w->p, k, w->work);
        const mt_status rc = mt_workspace_eval(w, w->work, false, v, &own);
        if (mt_is_final(rc)) {
            return mt_fail(err, rc, "%s", own.text);
        }
        e->stopped[task] = rc == MT_E_INTERRUPTED;
        if (rc == MT_OK) {
            record_needed_moves(w, v, &e->tasks[task]);
        }
    }
    return MT_OK;
}

static mt_status enumerate(mt_workspace *const *workers, int n_workers, int total,
                           mt_arena *mem, mt_moves *out, mt_err *err)
{
    const int n_tasks = (total + PER_TASK - 1) / PER_TASK;
    enumeration e = {.workers = workers, .total = total};
    const size_t n = (size_t)workers[0]->p->n;
    const size_t n_moves = (size_t)out->n;
    e.values = mt_arena_alloc(mem, (size_t)n_workers, sizeof *e.values);
    e.tasks = mt_arena_alloc(mem, (size_t)n_tasks, sizeof *e.tasks);
    e.stopped = mt_arena_alloc(mem, (size_t)n_tasks, sizeof *e.stopped);
    double *const x = mt_arena_f64(mem, n * n_moves, (size_t)n_tasks); /* the tasks' designs */
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < n_workers; i++) {
        MT_TRY(mt_subproblem_values_init(workers[i]->c, mem, &e.values[i], err));
    }
    /* each task's own list of moves */
    for (int i = 0; i < n_tasks; i++) {
        mt_moves *const own = &e.tasks[i];
        *own = *out;
        own->items = mt_arena_alloc(mem, n_moves, sizeof *own->items);
        MT_TRY(mt_arena_check(mem, err));
        memcpy(own->items, out->items, n_moves * sizeof *own->items);
        for (size_t k = 0; k < n_moves; k++) {
            own->items[k].x = x + ((((size_t)i * n_moves) + k) * n);
        }
    }
    const mt_tasks tasks = {n_tasks, look_at_some, NULL, &e, "lots of combinations"};
    MT_TRY(mt_workers_run(n_workers, workers[0]->task_path, &tasks, err));
    for (int i = 0; i < n_tasks; i++) {
        out->stopped = out->stopped || e.stopped[i];
        mt_relaxation_merge(out, &e.tasks[i], workers[0]->p->n);
    }
    out->evals += total;
    return MT_OK;
}

/* With the catalogues closed on the values of design s. */
static mt_status relaxation_near(mt_workspace *const *workers, int n_workers,
                                 const mt_nlp_solution *s, long spent, mt_arena *mem,
                                 mt_moves *out, mt_err *err)
{
    const mt_subproblem *const whole = workers[0]->c;
    mt_subproblem closed;
    mt_moves found = {0};
    mt_nlp_solution near = *s;
    const mt_nlp_result from = {.n_solutions = 1, .solutions = &near, .evals = spent};
    double *const x = mt_arena_f64(mem, (size_t)whole->p->n, 1);
    MT_TRY(mt_arena_check(mem, err));
    mt_subproblem_x(whole, s->t, x);
    mt_status rc = mt_catalogue_search_close(whole, x, workers[0], mem, &closed, err);
    for (int i = 1; i < n_workers && rc == MT_OK; i++) {
        rc = mt_workspace_use(workers[i], &closed, err);
    }
    rc = rc == MT_OK
             ? mt_relaxation_solve(workers, n_workers, &from, NULL, NULL, mem, &found, err)
             : rc;
    for (int i = 0; i < n_workers; i++) {
        mt_workspace_back(workers[i], whole);
    }
    if (rc == MT_OK) {
        mt_relaxation_merge(out, &found, whole->p->n);
        out->evals += found.evals;
        out->starts += found.starts;
        out->stopped = out->stopped || found.stopped;
        out->short_of_budget = out->short_of_budget || found.short_of_budget;
    }
    return rc;
}

mt_status mt_relaxation_catalogue(mt_workspace *const *workers, int n_workers,
                                  const mt_nlp_result *search, mt_arena *mem, mt_moves *out,
                                  mt_err *err)
{
    const mt_problem *const p = workers[0]->p;
    const long most = workers[0]->c->search.max_evaluations;
    double total = 1.0;
    bool mixed = false;
    for (int i = 0; i < p->n; i++) {
        mixed = mixed || p->study->variables[i].n_catalogue == 0;
    }
    for (int k = 0; k < p->n_choices; k++) {
        total *= (double)p->choices[k].n_rows;
    }
    MT_TRY(relaxation_moves(workers[0]->c, mem, out, err));
    if (mixed) {
        const int n = search->n_solutions < NEAREST ? search->n_solutions : NEAREST;
        for (int i = 0; i < n && !out->stopped; i++) {
            MT_TRY(relaxation_near(workers, n_workers, &search->solutions[i],
                                   search->evals + out->evals, mem, out, err));
        }
    } else {
        out->short_of_budget = total > (double)MT_CATALOGUE_SEARCH_MOST ||
                               (most > 0 && total > (double)(most - search->evals));
        if (!out->short_of_budget) {
            MT_TRY(enumerate(workers, n_workers, (int)total, mem, out, err));
        }
    }
    relaxation_rank(out);
    return MT_OK;
}
