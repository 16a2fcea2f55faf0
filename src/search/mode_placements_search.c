/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The search of one gap assignment: what its clearance says, then rounds of cuts. */
#include "search/mode_placements_search.h"

#include <math.h>
#include <string.h>

#include "nlp/merit.h"
#include "problem/avoidance.h"
#include "problem/evaluate.h"
#include "problem/objective.h"
#include "problem/tolerance.h"
#include "search/drive_path.h"
#include "search/mode_placements.h"

/*
 * The least clearance z is free to be negative, so that a search can start anywhere; a design
 * that ends with z < 0 has a mode on the wrong side of an edge: it is not of this kind, and
 * misses the bands by -z, which is f.
 */

/* Add a violation of `short_of` to a design. */
static void mode_placement_refuse(mt_nlp_solution *best, double short_of, double tolerance)
{
    mt_missed m = {best->violation, best->squares};
    mt_miss(&m, short_of, tolerance);
    best->feasible = false;
    best->squares = m.squares;
    best->violation = m.violation;
}

static double least_tolerance(const mt_subproblem *c)
{
    double tolerance = HUGE_VAL;
    for (int i = 0; i < c->n_avoidances; i++) {
        tolerance = fmin(tolerance, c->avoidances[i].tolerance);
    }
    return tolerance;
}

void mt_mode_placement_refuse_step(const mt_subproblem *c, mt_step *s)
{
    const double tolerance = least_tolerance(c);
    if (s->f > tolerance) {
        mt_missed m = {s->violation, s->squares};
        mt_miss(&m, s->f, tolerance);
        s->violation = m.violation;
        s->squares = m.squares;
    }
}

static void mode_placement_verify_clearance(const mt_subproblem *c, mt_nlp_result *found)
{
    const double tolerance = least_tolerance(c);
    for (int i = 0; i < found->n_solutions && c->clearance; i++) {
        mt_nlp_solution *const s = &found->solutions[i];
        const double z = s->t[c->p->n];
        if (z < -tolerance) {
            mode_placement_refuse(s, -z, tolerance);
        }
    }
    found->compromise = found->n_solutions > 0 && !found->solutions[0].feasible;
}

/*
 * The search of one gap assignment. Where configurations are positions of one drive, its best
 * design is followed from position to position (motion.h); where a mode crosses an edge on the
 * way, the position of the worst crossing becomes one more configuration that has to keep the
 * assignment, and the search begins again from there (a cutting plane: what it removes
 * crosses). A few rounds end it, as each begins next to its answer; a design that still crosses
 * then is no design of that assignment.
 */

/* Rounds of cuts, and starts of the later ones, which begin next to their answer. */
enum { CUT_ROUNDS = 12, CUTS_MOST = 32, CUT_STARTS = 6 };

/* The caller's design where it has this placement, else the candidate's own; NULL: none. */
static const double *hint_of(const mt_mode_placement_job *j, int k)
{
    const size_t size = (size_t)j->p->n_bands * sizeof(int);
    const int *const below = j->candidates->below + ((ptrdiff_t)k * j->p->n_bands);
    if (j->hint_below != NULL && memcmp(below, j->hint_below, size) == 0) {
        return j->c->hint;
    }
    const double *const at =
        j->candidates->at == NULL ? NULL : j->candidates->at + ((ptrdiff_t)k * j->p->n);
    return at == NULL || j->p->n == 0 || isnan(at[0]) ? NULL : at;
}

/* The objectives in order, each with those before it held (search.h). */
static mt_status search_in_order(mt_workspace *w, mt_mode_placement_slot *s, mt_err *err)
{
    int stage = 0;
    mt_err why = {0};
    mt_nlp_values v;
    MT_TRY(mt_search_designs(&w, 1, &s->mem, &s->found, &stage, &why, err));
    if (s->found.n_solutions == 0 || s->found.compromise || s->found.stop == MT_STOP_USER) {
        return MT_OK;
    }
    /* all of them at the best solution, by which the candidates are ranked */
    s->stages = mt_arena_f64(&s->mem, (size_t)w->c->n_stages, 1);
    MT_TRY(mt_arena_check(&s->mem, err));
    MT_TRY(mt_subproblem_values_init(w->c, &s->mem, &v, err));
    MT_TRY(mt_workspace_eval(w, s->found.solutions[0].t, false, &v, err));
    s->evals++;
    for (int k = 0; k < w->c->n_stages; k++) {
        s->stages[k] = mt_objective_stage_value(w, k, NULL);
    }
    s->found.solutions[0].f = s->stages[w->c->n_stages - 1];
    return MT_OK;
}

/* Adds one cut for each interval of a drive in which the margin is below `room`: *added of
 * them. */
static mt_status add_cuts(mt_mode_placement_slot *s, const mt_problem *p, int drive_positions,
                          const mt_drive_path *m, double room, int *added, mt_err *err)
{
    for (int i = 0; i < m->n_ways && p->families[drive_positions].fixed; i++) {
        if (m->way_margin[i] < room - m->tolerance && MT_HAS(m->way_at[i]) &&
            s->n_cuts < CUTS_MOST) {
            MT_TRY(mt_cut_init(p, drive_positions, m->way_at[i], &s->cuts[s->n_cuts], err));
            s->n_cuts++;
            (*added)++;
        }
    }
    return MT_OK;
}

/* Follow the best design, which has been evaluated, over the range of motion. *added: cuts to
 * search again with; with none a design that crosses is refused. *room: down to the least on
 * the way. */
static mt_status follow_best(mt_mode_placement_slot *s, mt_workspace *w, bool last, int *added,
                             double *room, mt_err *err)
{
    mt_nlp_solution *const best = &s->found.solutions[0];
    const double wanted = w->c->clearance ? best->t[w->p->n] : 0.0;
    double short_of = 0.0;
    double tolerance = 1.0;
    *added = 0;
    for (int i = 0; i < w->p->n_families; i++) {
        mt_drive_path m = {.room = 0.0};
        if (!w->p->families[i].banded) {
            continue;
        }
        MT_TRY(mt_drive_path_follow(w, i, w->c->below, &s->mem, &m, err));
        s->evals += m.positions;
        *room = fmin(*room, m.room);
        MT_TRY(last ? MT_OK : add_cuts(s, w->p, i, &m, wanted, added, err));
        if (m.end == MT_MOTION_UNSTABLE || m.room < -m.tolerance) {
            const double here = m.end == MT_MOTION_UNSTABLE ? 1.0 : -m.room;
            tolerance = here > short_of && m.tolerance > 0.0 ? m.tolerance : tolerance;
            short_of = fmax(short_of, here);
        }
    }
    if (*added == 0 && short_of > 0.0) {
        mode_placement_refuse(best, short_of, tolerance);
    }
    return MT_OK;
}

/* A search finds z within the tolerance of a band, which differs between placements: the best
 * design is ranked by its actual clearance. */
static void report_clearance(mt_mode_placement_slot *s, double room, int n_stages)
{
    if (n_stages == 1) {
        s->found.solutions[0].f = -room;
    } else if (s->stages != NULL) {
        s->stages[0] = -room;
    }
}

/* The best design over the range of motion and over its tolerances; *again: with one more cut
 * at least. */
static mt_status verify_best(mt_mode_placement_slot *s, mt_workspace *w, bool last, bool *again,
                             mt_err *err)
{
    mt_nlp_solution *const best = &s->found.solutions[0];
    mt_nlp_values v;
    int added = 0;
    bool worse = false;
    double room = HUGE_VAL;
    if (best->feasible && (w->c->clearance || mt_drive_positions_any(w->p))) {
        MT_TRY(mt_subproblem_values_init(w->c, &s->mem, &v, err));
        MT_TRY(mt_workspace_eval(w, best->t, false, &v, err));
        s->evals++;
        room = mt_avoidances_margin(w);
    }
    if (best->feasible && mt_drive_positions_any(w->p)) {
        MT_TRY(follow_best(s, w, last, &added, &room, err));
    }
    if (best->feasible && mt_search_has_positions(w->c)) {
        MT_TRY(mt_search_verify_positions(w, best->t, last, &s->mem, &s->at_position, err));
        s->evals += s->at_position.evals;
        added += s->at_position.added;
    }
    if (best->feasible && mt_tolerance_is_sampled(w->c)) {
        MT_TRY(mt_search_verify(w, last, &s->mem, &s->corners, best, &worse, err));
        s->evals += 1 + mt_subproblem_worth(w->c, s->corners.solutions);
        /* the worst within the tolerances, where they were looked at for it */
        room = fmin(room, s->corners.band_margin);
    }
    if (best->feasible && w->c->clearance && isfinite(room)) {
        report_clearance(s, room, w->c->n_stages);
    }
    *again = added > 0 || worse;
    return MT_OK;
}

/* True while enough of a candidate's share is left for one more round. */
static bool has_round(const mt_mode_placement_job *j, long evals)
{
    const long most = j->options.max_evals;
    return most <= 0 || most - evals >= mt_mode_placement_verdict(j->c) + MT_GAP_SEARCH_LEAST;
}

/* *out: first[n], then the cuts, which keep their memory, for mt_subproblem_lay_out. Fails:
 * MT_E_MEMORY. */
static mt_status join_cuts(const mt_at_position_cuts *cuts, int n, const mt_cut *first,
                           mt_arena *mem, mt_cut **out, mt_err *err)
{
    *out = mt_arena_alloc(mem, (size_t)n + (size_t)cuts->n, sizeof **out);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < n; i++) {
        (*out)[i] = first[i];
    }
    for (int i = 0; i < cuts->n; i++) {
        (*out)[n + i] = cuts->items[i];
    }
    return MT_OK;
}

/* out->held: the rows with a nonzero multiplier, in a solution of subproblem c, of cuts that
 * its problem does not have. In mem. Fails: MT_E_MEMORY. */
static mt_status hold_active_limits(const mt_subproblem *c, const mt_cut *cuts,
                                    const mt_nlp_solution *s, mt_arena *mem,
                                    mt_mode_placement_solution *out, mt_err *err)
{
    const mt_row_span bands = c->rows.of_kind[MT_ROW_BAND];
    mt_mode_placement_held *const held = mt_arena_alloc(mem, (size_t)bands.n, sizeof *held);
    MT_TRY(mt_arena_check(mem, err));
    out->held = held;
    out->n_held = 0;
    for (int i = bands.first; i < bands.first + bands.n && s->mult_in != NULL; i++) {
        const mt_row *const row = &c->rows.in.rows[i];
        /* cuts come behind the problem's own */
        const int k = row->avoidance - c->p->n_avoidances;
        const double multiplier = s->mult_in[i];
        if (k >= 0 && multiplier > 0.0) {
            held[out->n_held++] = (mt_mode_placement_held){
                .drive_positions = cuts[k].drive_positions,
                .position = cuts[k].position,
                .mode = row->mode,
                .above = row->sense == MT_AT_LEAST,
                .band = c->avoidances[row->avoidance].bands.items[row->band].label,
                .multiplier = multiplier};
        }
    }
    return MT_OK;
}

/* One search of candidate k with the cuts so far, from `from` (NULL: no hint). *again: a cut
 * was added. */
static mt_status search_round(const mt_mode_placement_job *j, mt_workspace *w,
                              mt_mode_placement_slot *s, int k, int round, const double *from,
                              bool *again, mt_err *why)
{
    const int *const below = j->candidates->below + ((ptrdiff_t)k * j->p->n_bands);
    mt_nlp_options options = j->options;
    mt_subproblem c;
    *again = false;
    mt_subproblem held = *j->c;
    if (s->corners.n > 0) {
        MT_TRY(mt_tolerance_add_cuts(j->c, &s->corners, &s->mem, &held.tolerance_box, why));
    }
    if (options.max_evals > 0) {
        const long left = options.max_evals - s->evals - mt_mode_placement_verdict(j->c);
        options.max_evals = left > 1 ? mt_subproblem_afford(&held, left) : 1;
        held.search.max_evaluations = options.max_evals;
    }
    mt_cut *cuts = NULL;
    MT_TRY(join_cuts(&s->at_position, s->n_cuts, s->cuts, &s->mem, &cuts, why));
    MT_TRY(mt_subproblem_in_placement(&held, below, s->n_cuts + s->at_position.n, cuts, w,
                                      &s->mem, &c, why));
    options.starts =
        round > 1 && options.starts > CUT_STARTS ? (int)CUT_STARTS : options.starts;
    options.starts = j->few && from != NULL && options.starts < 2 ? 2 : options.starts;
    c.search.starts = j->few ? 0 : c.search.starts;
    c.starts = options.starts;
    s->n_t = c.n_t;
    double *const hint = mt_arena_f64(&s->mem, (size_t)c.n_t, 1);
    MT_TRY(mt_arena_check(&s->mem, why));
    if (from != NULL) {
        memcpy(hint, from, (size_t)j->p->n * sizeof *hint);
    }
    c.hint = from != NULL ? hint : NULL;
    const mt_nlp nlp = mt_workspace_nlp(w);
    mt_status rc = c.n_stages > 1
                       ? search_in_order(w, s, why)
                       : mt_workspace_solve(w, &nlp, &options, &s->mem, &s->found, why);
    if (rc == MT_OK && c.n_stages == 1) {
        rc = mt_search_repeated_eigenvalues(w, options.max_evals, &s->mem, &s->found, why);
    }
    if (rc == MT_OK) {
        mode_placement_verify_clearance(&c, &s->found);
    }
    if (rc == MT_OK && c.n_stages == 1) {
        rc = mt_search_nearest(w, options.max_evals, NULL, NULL, &s->mem, &s->found, why);
    }
    s->begun = s->evals;
    s->evals += mt_subproblem_counted(&c, s->found.evals);
    s->starts += s->found.starts;
    if (rc == MT_OK && s->found.n_solutions > 0) {
        rc = hold_active_limits(&c, s->cuts, &s->found.solutions[0], &s->mem, &s->held, why);
    }
    if (rc == MT_OK && s->found.n_solutions > 0 && s->found.stop != MT_STOP_USER) {
        const long judged = s->evals + mt_mode_placement_verdict(j->c); /* at most */
        const bool last = round + 1 == CUT_ROUNDS || !has_round(j, judged);
        rc = verify_best(s, w, last, again, why);
    }
    return rc;
}

bool mt_mode_placement_is_met(const mt_mode_placement_slot *s)
{
    return s->found.n_solutions > 0 && s->found.solutions[0].feasible;
}

mt_status mt_mode_placement_search_candidate(void *context, int worker, int k,
                                             mt_task_path *own, mt_err *err)
{
    mt_mode_placement_job *const j = context;
    k += j->from;
    mt_mode_placement_slot *const s = &j->slots[k];
    mt_workspace *const w = j->workers[worker];
    mt_task_path *const before = w->task_path;
    mt_err why = {0};
    bool again = true;
    if (s->carried || k >= j->most || mt_interrupted(j->p->run->interrupt)) {
        s->found.stop = !s->carried && k >= j->most ? MT_STOP_MAX_EVALS : s->found.stop;
        return MT_OK;
    }
    MT_TRY(mt_arena_init(&s->mem, 0, err));
    s->cuts = mt_arena_alloc(&s->mem, CUTS_MOST, sizeof *s->cuts);
    MT_TRY(mt_arena_check(&s->mem, err));
    w->task_path = own;
    for (int round = 0; again && round < CUT_ROUNDS; round++) {
        const bool known = round > 0 && s->found.n_solutions > 0;
        s->rc = search_round(j, w, s, k, round, known ? s->found.solutions[0].t : hint_of(j, k),
                             &again, &why);
    }
    if (s->rc != MT_OK) { /* perhaps on the way from position to position: nothing is known */
        s->found.n_solutions = 0;
        s->found.stop = s->rc == MT_E_INTERRUPTED ? MT_STOP_USER : s->found.stop;
    }
    w->task_path = before;
    mt_workspace_back(w, j->c); /* the candidate's case goes, and its cuts */
    if (mt_mode_placement_is_met(s)) {
        mt_workspace_judged(w, s->stages != NULL ? s->stages[0] : s->found.solutions[0].f);
    }
    for (int i = 0; i < s->n_cuts; i++) {
        mt_cut_free(&s->cuts[i]);
    }
    mt_at_position_cuts_free(&s->at_position);
    const bool fatal = mt_is_final(s->rc);
    return fatal ? mt_fail(err, s->rc, "%s", why.text) : MT_OK;
}
