/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Limits that a search meets by cuts: at positions of a drive, and over tolerances. */
#include <math.h>

#include "nlp/merit.h"
#include "problem/drive_positions.h"
#include "problem/evaluate.h"
#include "problem/tolerance_cut.h"
#include "search/drive_path.h"
#include "search/search.h"

/*
 * Limits between the positions of a drive that a goal names: where a design
 * misses one most within a way between two of them, that position is one more row of the limit
 * (problem/drive_positions.h), for all designs.
 */

enum { CUTS_MOST = 32 };

/* Positions nearer than this part of the range are one. */
static const double SAME = 1e-7;

/* True where the limit is verified between positions; limits that scale the objective
 * "vibration" are not. */
static bool is_asked(const mt_problem *p, int requirement)
{
    return p->requirements[requirement].role == MT_ROLE_LIMIT &&
           mt_drive_positions_limits_first(p, &p->requirements[requirement]);
}

bool mt_search_has_positions(const mt_subproblem *c)
{
    for (int i = 0; i < c->p->n_requirements; i++) {
        if (is_asked(c->p, i)) {
            return true;
        }
    }
    return false;
}

static bool is_known_cut(const mt_at_position_cuts *cuts, int requirement, double at,
                         double near)
{
    for (int i = 0; i < cuts->n; i++) {
        if (cuts->items[i].requirement == requirement &&
            fabs(cuts->items[i].position - at) <= near) {
            return true;
        }
    }
    return false;
}

static mt_status add_position_cuts(const mt_problem *p, int requirement,
                                   const mt_limit_drive_path *m, mt_at_position_cuts *cuts,
                                   mt_err *err)
{
    const int drive_positions = mt_drive_positions_of(p, p->requirements[requirement].view);
    const double near = SAME * (m->to - m->from);
    for (int i = 0; i < m->n_ways && p->families[drive_positions].fixed; i++) {
        if (mt_is_met(m->way_off[i], p->requirements[requirement].tolerance) ||
            !MT_HAS(m->way_at[i]) || cuts->n == CUTS_MOST ||
            is_known_cut(cuts, requirement, m->way_at[i], near)) {
            continue;
        }
        mt_cut *const cut = &cuts->items[cuts->n];
        MT_TRY(mt_cut_init(p, drive_positions, m->way_at[i], cut, err));
        cut->requirement = requirement;
        cuts->n++;
        cuts->added++;
    }
    return MT_OK;
}

mt_status mt_search_verify_positions(mt_workspace *w, const double *t, bool last, mt_arena *mem,
                                     mt_at_position_cuts *cuts, mt_err *err)
{
    mt_nlp_values v;
    cuts->added = 0;
    cuts->holds = true;
    cuts->evals = 1;
    if (cuts->items == NULL) {
        cuts->items = mt_arena_alloc(mem, CUTS_MOST, sizeof *cuts->items);
    }
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_subproblem_values_init(w->c, mem, &v, err));
    MT_TRY(mt_workspace_eval(w, t, false, &v, err));
    for (int i = 0; i < w->p->n_requirements; i++) {
        mt_limit_drive_path m;
        if (!is_asked(w->p, i)) {
            continue;
        }
        MT_TRY(mt_drive_path_limit(w, &w->p->requirements[i], mem, &m, err));
        cuts->evals += m.positions;
        if (m.end == MT_MOTION_NONE) {
            continue;
        }
        cuts->holds =
            cuts->holds && m.why == NULL && mt_is_met(m.off, w->p->requirements[i].tolerance);
        MT_TRY(last ? MT_OK : add_position_cuts(w->p, i, &m, cuts, err));
    }
    return MT_OK;
}

void mt_at_position_cuts_free(mt_at_position_cuts *cuts)
{
    for (int i = 0; i < cuts->n; i++) {
        mt_cut_free(&cuts->items[i]);
    }
    cuts->n = 0;
}

/*
 * Designs over their tolerances, by cutting planes. Where the corners that a search holds are
 * samples,
 *     g(t, c) <= 0    for all corners c of C,
 * its design t may miss a goal at some other point c' of its tolerances. With c' in C as well
 * the search goes on from t. The worst within moves as t does, and where it lies inside, its
 * value by the square of that: a few rounds end it. Then a few starts are searched with the C
 * there is by then, for optima that were none without it. All designs are held at the same C.
 * So it is with limits over the positions of a drive, c being one.
 */

enum { ROUNDS = 12, STARTS = 6, STARTS_ALONE = 3 };
/* Of a budget, for judging what a search ends with: so many evaluations, or one in so many. */
enum { JUDGED = 16, PART = 4 };

/* How far a design is verified over its tolerances: wherever its limits could be missed, or at
 * the corners that slopes name, which is enough where its search goes on in any case. */
typedef enum verification { VERIFY_ALL, VERIFY_BY_SLOPES } verification;

static mt_status verify_tolerances(mt_workspace *w, verification how, bool last, mt_arena *mem,
                                   mt_tolerance_cuts *cuts, mt_nlp_solution *s, bool *again,
                                   mt_err *err)
{
    *again = false;
    MT_TRY(how == VERIFY_ALL ? mt_tolerance_verify(w, s->t, mem, cuts, err)
                             : mt_tolerance_verify_by_slopes(w, s->t, mem, cuts, err));
    const mt_missed *const m = &cuts->missed;
    *again = !last && cuts->added > 0;
    if (!*again && !mt_is_met(m->violation, 1.0)) {
        s->feasible = false;
        s->squares += m->squares;
        s->violation = s->violation > m->violation ? s->violation : m->violation;
    }
    return MT_OK;
}

mt_status mt_search_verify(mt_workspace *w, bool last, mt_arena *mem, mt_tolerance_cuts *cuts,
                           mt_nlp_solution *s, bool *again, mt_err *err)
{
    return verify_tolerances(w, VERIFY_ALL, last, mem, cuts, s, again, err);
}

/* Directions that the goals do not settle at the design t. */
typedef struct directions {
    const double *t;
    int n;
    double *unidentifiable;
    double *effect;
} directions;

typedef struct rounds {
    mt_workspace *ws;
    const mt_subproblem *c; /* the caller's */
    mt_arena *mem;
    mt_nlp_result *out;
    int *stage;
    int round;
    bool *open; /* [n_solutions] not judged, or missed at a point that is a cut since */
    mt_tolerance_cuts cuts;
    int n_added; /* to the cuts that were known */
    bool over_tolerances;
    bool over_positions;
    long judgement; /* most evaluations that a design takes over the positions */
    mt_at_position_cuts at_position;
    bool *kept;       /* [n_solutions] the limits over the positions, when last judged */
    directions first; /* of the best design of the search, */
    directions again; /* and of that with the cuts */
    const mt_at_position_price *prices;
} rounds;

static directions directions_of(const mt_nlp_result *found)
{
    return (directions){found->solutions[0].t, found->n_unidentifiable, found->unidentifiable,
                        found->unidentifiable_effect};
}

/* True where the budget has less than `evals` left. */
static bool lacks(const rounds *r, long evals)
{
    const long most = r->c->search.max_evaluations;
    return most > 0 && most - r->out->evals < evals;
}

/* True where the nearest of the designs that are as good as solution i is still to be sought:
 * the first search leaves that to the one with the cuts. */
static bool is_to_be_nearer(const rounds *r, int i, bool last)
{
    return r->out->solutions[i].flat && r->over_tolerances && !r->c->as_found &&
           r->round == 1 && !last;
}

/* Verifies solution i over its tolerances and positions. */
static mt_status verify_solution(rounds *r, int i, bool last, mt_err *err)
{
    mt_nlp_solution *const s = &r->out->solutions[i];
    const verification how = is_to_be_nearer(r, i, last) ? VERIFY_BY_SLOPES : VERIFY_ALL;
    r->open[i] = false;
    if (r->over_tolerances && lacks(r, 1 + r->c->search.judged_as)) {
        s->feasible = false; /* not known */
        r->out->stop = r->out->stop == MT_STOP_DONE ? MT_STOP_MAX_EVALS : r->out->stop;
        return MT_OK;
    }
    if (r->over_tolerances) {
        MT_TRY(verify_tolerances(r->ws, how, last, r->mem, &r->cuts, s, &r->open[i], err));
        r->out->evals += 1 + mt_subproblem_worth(r->c, r->cuts.solutions);
        r->n_added += r->cuts.added;
    }
    if (r->over_positions && s->feasible && !lacks(r, r->judgement)) {
        MT_TRY(mt_search_verify_positions(r->ws, s->t, last, r->mem, &r->at_position, err));
        r->kept[i] = r->at_position.holds;
        r->out->evals += r->at_position.evals;
        r->open[i] = r->open[i] || r->at_position.added > 0;
    }
    return MT_OK;
}

/* Verifies open solutions; *any: some are still open. */
static mt_status verify_open(rounds *r, bool last, bool *any, mt_err *err)
{
    *any = false;
    for (int i = 0; i < r->out->n_solutions; i++) {
        if (r->open[i]) {
            MT_TRY(verify_solution(r, i, last, err));
        }
        const mt_nlp_solution *const s = &r->out->solutions[i];
        const bool holds = s->feasible && !r->open[i];
        r->open[i] = r->open[i] || (holds && is_to_be_nearer(r, i, last));
        *any = *any || r->open[i];
        if (r->c->best_alone && r->round == 1 && holds) {
            r->out->n_solutions = i + 1; /* what the search ranked behind it is worse */
        }
    }
    return MT_OK;
}

/* Multipliers of the limits between positions for a solution that was searched with them. */
static mt_status note_prices(rounds *r, const mt_nlp_solution *s, mt_err *err)
{
    const mt_subproblem *const c = r->ws->c;
    for (int i = 0; i < c->n_requirements - c->p->n_requirements && s->mult_in != NULL; i++) {
        const mt_row_span rows = c->rows.of[c->p->n_requirements + i];
        double multiplier = 0.0;
        for (int k = rows.first; k < rows.first + rows.n; k++) {
            multiplier += fmax(s->mult_in[k], 0.0);
        }
        if (!(multiplier > 0.0)) {
            continue;
        }
        mt_at_position_price *const price = mt_arena_alloc(r->mem, 1, sizeof *price);
        MT_TRY(mt_arena_check(r->mem, err));
        *price = (mt_at_position_price){.next = r->prices,
                                        .t = s->t,
                                        .requirement = r->at_position.items[i].requirement,
                                        .position = r->at_position.items[i].position,
                                        .multiplier = multiplier};
        r->prices = price;
    }
    return MT_OK;
}

/* Evaluations left for a search with the cuts; 0: none. */
static long left_for(const rounds *r, const mt_subproblem *held)
{
    const long most = r->c->search.max_evaluations;
    return most <= 0 ? 0 : mt_subproblem_afford(held, most - r->out->evals - r->judgement);
}

/* Searches from solution i in the subproblem with the cuts, to which the workspace is set. */
static mt_status continue_with_cuts(rounds *r, int i, mt_err *err)
{
    mt_nlp_solution *const s = &r->out->solutions[i];
    mt_nlp_result next = {0};
    int stage = 0;
    const mt_status rc = mt_search_from(r->ws, s->t, r->mem, &next, &stage, err);
    mt_steps_append(&r->out->steps, &next.steps, r->out->evals, 0, r->round);
    r->out->evals += mt_subproblem_counted(r->ws->c, next.evals);
    r->out->stop = next.stop > r->out->stop ? next.stop : r->out->stop;
    if (rc != MT_OK || next.n_solutions == 0 || next.compromise) {
        return rc; /* it stands as it is, and is judged so */
    }
    const mt_nlp_solution old = *s;
    *s = next.solutions[0];
    s->singular = s->singular || old.singular;
    s->continuum = old.continuum;
    s->start = old.start;
    s->hits = old.hits;
    *r->stage = stage;
    r->first = old.t == r->first.t ? directions_of(&next) : r->first;
    r->again = old.t == r->again.t ? directions_of(&next) : r->again;
    return note_prices(r, s, err);
}

/* True where the budget is spent or a stop was requested. */
static bool is_used_up(rounds *r)
{
    const bool spent = lacks(r, 1 + r->judgement);
    r->out->stop = spent && r->out->stop == MT_STOP_DONE ? MT_STOP_MAX_EVALS : r->out->stop;
    return spent || r->out->stop == MT_STOP_USER;
}

/* The subproblem with the cuts so far, to which the workspace is set. */
static mt_status hold_cuts(rounds *r, mt_subproblem *held, mt_err *err)
{
    MT_TRY(mt_subproblem_copy(r->c, r->mem, held, err));
    if (r->over_tolerances) {
        MT_TRY(mt_tolerance_add_cuts(r->c, &r->cuts, r->mem, &held->tolerance_box, err));
    }
    return mt_subproblem_lay_out(held, NULL, r->at_position.n, r->at_position.items, r->ws,
                                 r->mem, err);
}

/* Searches again from all open solutions, with the cuts so far. */
static mt_status search_again(rounds *r, mt_err *err)
{
    const mt_subproblem *const c = r->c;
    mt_subproblem held;
    MT_TRY(hold_cuts(r, &held, err));
    mt_status rc = MT_OK;
    for (int i = 0; i < r->out->n_solutions && rc == MT_OK; i++) {
        if (r->open[i] && !is_used_up(r)) {
            held.search.max_evaluations = left_for(r, &held);
            rc = continue_with_cuts(r, i, err);
        }
    }
    mt_workspace_back(r->ws, c);
    return rc;
}

static mt_status open_all(rounds *r, mt_err *err)
{
    const size_t n = (size_t)r->out->n_solutions;
    r->first = directions_of(r->out);
    r->open = mt_arena_alloc(r->mem, n, sizeof *r->open);
    r->kept = mt_arena_alloc(r->mem, n, sizeof *r->kept);
    MT_TRY(mt_arena_check(r->mem, err));
    for (size_t i = 0; i < n; i++) {
        r->open[i] = true;
        r->kept[i] = true;
    }
    return MT_OK;
}

/* Verifies, and searches again with the cuts, until nothing is open. *cut: cuts were added. */
static mt_status go_round(rounds *r, bool *cut, mt_err *err)
{
    bool any = true;
    for (int round = 0; round < ROUNDS && any; round++) {
        /* with more cuts less is feasible: what was better counts no more */
        r->round++;
        MT_TRY(verify_open(r, round + 1 == ROUNDS || is_used_up(r), &any, err));
        *cut = *cut || r->n_added > 0 || r->at_position.n > 0;
        MT_TRY(any ? search_again(r, err) : MT_OK);
    }
    return MT_OK;
}

static bool any_feasible(const rounds *r)
{
    bool any = false;
    for (int i = 0; i < r->out->n_solutions; i++) {
        any = any || r->out->solutions[i].feasible;
    }
    return any;
}

/* True where a design that was verified makes it needless to verify s: it is the same design,
 * or only the best is wanted and s is not better. */
static bool is_needless(const rounds *r, const mt_nlp_solution *s)
{
    const mt_subproblem *const c = r->c;
    const mt_merit new = {s->feasible, s->squares, 1, &s->f};
    bool needless = false;
    for (int i = 0; i < r->out->n_solutions && !needless; i++) {
        mt_nlp_solution *const old = &r->out->solutions[i];
        const mt_merit known = {old->feasible, old->squares, 1, &old->f};
        const bool ranked = c->best_alone && c->as_found && c->n_stages == 1;
        if (old->feasible && r->kept[i]) {
            needless = mt_search_same(c->p->n, old->t, s->t) ||
                       (ranked && !mt_merit_before(&new, &known, MT_EQUAL_FOUND));
            old->continuum = old->continuum || (needless && s->continuum);
        }
    }
    return needless;
}

/* Adds the designs of a further search; those that meet nothing are dropped. */
static mt_status add_searched_designs(rounds *r, const mt_nlp_result *more, mt_err *err)
{
    mt_nlp_result *const out = r->out;
    const bool any = any_feasible(r);
    const int old = any ? out->n_solutions : 0;
    const size_t n = (size_t)old + (size_t)more->n_solutions;
    mt_nlp_solution *const all = mt_arena_alloc(r->mem, n, sizeof *all);
    bool *const open = mt_arena_alloc(r->mem, n, sizeof *open);
    bool *const kept = mt_arena_alloc(r->mem, n, sizeof *kept);
    MT_TRY(mt_arena_check(r->mem, err));
    for (int i = 0; i < old; i++) {
        all[i] = out->solutions[i];
        kept[i] = r->kept[i];
    }
    int n_all = old;
    for (int i = 0; i < more->n_solutions; i++) {
        if (old == 0 || !is_needless(r, &more->solutions[i])) {
            all[n_all] = more->solutions[i];
            open[n_all] = true;
            kept[n_all++] = true;
        }
    }
    for (int i = 0; i < old; i++) {
        all[i].continuum = out->solutions[i].continuum;
    }
    r->again = directions_of(more);
    out->solutions = all;
    out->n_solutions = n_all;
    r->open = open;
    r->kept = kept;
    return MT_OK;
}

/* The first search ignores the cuts: with them there may be other designs, not connected to its
 * own, such as one on each side of the excluded range. So the search is repeated from a few of
 * its starts; from all where it has no design, or where it knew of no corner and found several:
 * these are designs of the nominal question, and tolerances may prefer another. *found: there
 * are designs to verify. */
static mt_status start_again(rounds *r, bool *found, mt_err *err)
{
    const mt_subproblem *const c = r->c;
    mt_nlp_result next = {0};
    mt_err why = {.code = MT_OK};
    mt_subproblem held;
    int stage = 0;
    *found = false;
    MT_TRY(hold_cuts(r, &held, err));
    held.search.max_evaluations = left_for(r, &held);
    const bool nominal = r->cuts.alone && r->c->cuts_known == NULL;
    if (any_feasible(r) && !(nominal && r->out->n_solutions > 1)) {
        const int few = r->c->best_alone ? STARTS_ALONE : STARTS;
        held.search.starts = r->out->starts > 0 && r->out->starts < few ? r->out->starts : few;
    }
    const mt_status rc = mt_search_designs(&r->ws, 1, r->mem, &next, &stage, &why, err);
    mt_workspace_back(r->ws, c);
    MT_TRY(rc);
    mt_steps_append(&r->out->steps, &next.steps, r->out->evals, 0, r->round);
    r->out->evals += mt_subproblem_counted(&held, next.evals);
    r->out->stop = next.stop > r->out->stop ? next.stop : r->out->stop;
    if (next.n_solutions == 0 || next.compromise || stage != *r->stage) {
        return MT_OK;
    }
    *found = true;
    return add_searched_designs(r, &next, err);
}

/* Drops designs that violate limits between the positions where others do not; where all do,
 * they count by their values at the named positions. */
static void drop_broken(rounds *r)
{
    mt_nlp_result *const out = r->out;
    int n = 0;
    for (int i = 0; i < out->n_solutions; i++) {
        n += out->solutions[i].feasible && r->kept[i] ? 1 : 0;
    }
    if (!r->over_positions || n == 0) {
        return;
    }
    n = 0;
    for (int i = 0; i < out->n_solutions; i++) {
        if (r->kept[i]) {
            out->solutions[n++] = out->solutions[i];
        }
    }
    out->n_solutions = n;
}

/* Drops designs that violate something where another meets everything. */
static mt_status sort_out(rounds *r, mt_err *err)
{
    mt_nlp_result *const out = r->out;
    const int before = out->n_solutions;
    int n = 0;
    drop_broken(r);
    MT_TRY(mt_search_rank(r->ws, *r->stage, r->mem, out, err));
    while (n < out->n_solutions && out->solutions[n].feasible) {
        n++;
    }
    out->compromise = n == 0;
    out->n_solutions = n > 0 ? n : out->n_solutions;
    const double *const best = out->solutions[0].t;
    const directions known = best == r->first.t   ? r->first
                             : best == r->again.t ? r->again
                                                  : (directions){.n = 0};
    out->n_unidentifiable = known.n;
    out->unidentifiable = known.unidentifiable;
    out->unidentifiable_effect = known.effect;
    if (out->n_solutions == before) {
        return MT_OK;
    }
    out->n_found = out->n_solutions;
    out->n_once = 0;
    for (int i = 0; i < out->n_solutions; i++) {
        out->n_once += out->solutions[i].hits == 1 ? 1 : 0;
    }
    out->missing = nan("");
    return MT_OK;
}

/* True where the hint is a design that a search from many starts found over its tolerances, and
 * the nearest of those as good as it is wanted. */
static bool is_known(const mt_subproblem *c)
{
    return c->best_alone && !c->as_found && c->hint != NULL;
}

/* True where the first search leaves sampled corners out: an analysis of each configuration is
 * enough for it, and the corners that turn out to matter, which are few, come as cuts. A budget
 * would be spent before these, and where one design is wanted the second search costs more than
 * the first one saves, unless the cuts are known or of use to others. */
static bool leaves_corners_out(const mt_subproblem *c)
{
    const bool pays = !c->best_alone || c->cuts_known != NULL || c->cuts_found != NULL;
    return pays && c->search.max_evaluations <= 0 && mt_tolerance_is_sampled(c);
}

/* The search begins with these cuts. */
static mt_status use_known_cuts(rounds *r, const mt_tolerance_cuts *known, mt_err *err)
{
    r->cuts.n = known->n;
    r->cuts.room = known->n;
    r->cuts.items = mt_arena_alloc(r->mem, (size_t)known->n, sizeof *r->cuts.items);
    MT_TRY(mt_arena_check(r->mem, err));
    for (int i = 0; i < known->n; i++) {
        r->cuts.items[i] = known->items[i];
    }
    return MT_OK;
}

/* The designs, within what the budget leaves besides their verification. */
static mt_status search_first(rounds *r, mt_workspace *const *workers, int n_workers,
                              mt_err *why, mt_err *err)
{
    const long most = r->c->search.max_evaluations;
    const long wanted = JUDGED + r->c->search.judged_as;
    const long part = most / PART < wanted ? most / PART : wanted;
    mt_subproblem less = *r->c;
    if (r->cuts.alone) {
        MT_TRY(hold_cuts(r, &less, err));
    }
    less.search.max_evaluations -= r->over_tolerances ? part : 0;
    /* of equal designs the nearest is sought with the cuts */
    less.as_found = r->c->as_found || r->over_tolerances;
    for (int i = 0; i < n_workers; i++) {
        mt_workspace_back(workers[i], &less);
    }
    const bool known = r->cuts.n > 0 && is_known(r->c);
    const mt_status rc =
        known ? mt_search_from(r->ws, r->c->hint, r->mem, r->out, r->stage, err)
              : mt_search_designs(workers, n_workers, r->mem, r->out, r->stage, why, err);
    for (int i = 0; i < n_workers; i++) {
        mt_workspace_back(workers[i], r->c);
    }
    return rc;
}

/* Verifies what the first search found, in rounds of cuts, and starts again with these. */
static mt_status verify_and_cut(rounds *r, const mt_at_position_price **prices, mt_err *err)
{
    mt_nlp_result *const out = r->out;
    bool cut = false;
    bool again = false;
    MT_TRY(open_all(r, err));
    mt_status rc = go_round(r, &cut, err);
    const bool known = is_known(r->c) && any_feasible(r);
    if (rc == MT_OK && r->n_added > 0 && !known && !is_used_up(r)) {
        rc = start_again(r, &again, err);
        rc = rc == MT_OK && again ? go_round(r, &cut, err) : rc;
    }
    mt_at_position_cuts_free(&r->at_position); /* no case with them is left */
    if (prices != NULL) {
        *prices = r->prices;
    }
    if (rc == MT_E_INTERRUPTED) {
        out->stop = MT_STOP_USER;
        return MT_OK;
    }
    bool missed = false;
    for (int i = 0; i < out->n_solutions; i++) {
        missed = missed || !out->solutions[i].feasible || !r->kept[i];
    }
    return rc == MT_OK && (cut || missed) ? sort_out(r, err) : rc;
}

static mt_status search_and_verify(rounds *r, mt_workspace *const *workers, int n_workers,
                                   const mt_at_position_price **prices, mt_err *why,
                                   mt_err *err)
{
    const mt_nlp_result *const out = r->out;
    MT_TRY(search_first(r, workers, n_workers, why, err));
    const bool judged = r->over_tolerances || r->over_positions;
    const bool any = out->n_solutions > 0 && !out->compromise && out->stop != MT_STOP_USER;
    return judged && any ? verify_and_cut(r, prices, err) : MT_OK;
}

mt_status mt_search_over_tolerances(mt_workspace *const *workers, int n_workers, mt_arena *mem,
                                    mt_nlp_result *out, int *stage,
                                    const mt_at_position_price **prices, mt_err *why,
                                    mt_err *err)
{
    rounds r = {.ws = workers[0], .c = workers[0]->c, .mem = mem, .out = out};
    r.stage = stage;
    r.over_tolerances = mt_tolerance_is_sampled(r.c);
    r.over_positions = mt_search_has_positions(r.c);
    r.judgement = (r.over_tolerances ? 1 + r.c->search.judged_as : 0) +
                  (r.over_positions ? 2 + mt_drive_path_most(r.c) : 0);
    rounds all = r; /* with all corners from the beginning */
    r.cuts.alone = leaves_corners_out(r.c);
    /* workspaces have room for the subproblem's own corners; hold_cuts makes it in the first */
    if (r.cuts.alone && r.c->cuts_known != NULL && n_workers == 1) {
        MT_TRY(use_known_cuts(&r, r.c->cuts_known, err));
    }
    MT_TRY(search_and_verify(&r, workers, n_workers, prices, why, err));
    if (out->n_solutions > 0 && !out->compromise) {
        if (r.c->cuts_found != NULL) {
            *r.c->cuts_found = r.cuts;
        }
        return MT_OK;
    }
    if (!r.cuts.alone || r.c->cuts_known != NULL || out->stop != MT_STOP_DONE) {
        return MT_OK;
    }
    /* the nearest miss is one over the tolerances */
    const mt_nlp_result before = *out;
    mt_steps steps = before.steps;
    MT_TRY(search_and_verify(&all, workers, n_workers, prices, why, err));
    mt_steps_append(&steps, &out->steps, before.evals, 0, r.round + 1);
    out->steps = steps;
    out->evals += before.evals;
    return MT_OK;
}
