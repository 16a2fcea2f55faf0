/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A study answered in phases. Each may be cut by the caller's wish to stop. Which ones were is
 * told by the interrupt itself, which every unit of work passes (base/run.h): no phase
 * hands it up, so none can forget to. What a phase that was cut has written is taken back, and
 * those that need what it would have found are not begun.
 */
#include "answer/solve.h"

#include "answer/solve_priv.h"

#include <math.h>

#include "answer/weight_sensitivity.h"
#include "base/base.h"
#include "base/workers.h"
#include "describe/describe.h"

/* True where the study requests what this phase writes. */
static bool is_asked(const mt_answer *a, mt_phase which)
{
    switch (which) {
    case MT_PHASE_WEIGHT_SENSITIVITY:
        return a->searched && mt_weight_sensitivity_is_asked(a->p);
    case MT_PHASE_PUBLISHED:
        return a->study->n_published > 0;
    case MT_PHASE_TRADE:
        return a->study->trade.n_vary > 0;
    case MT_PHASE_SEARCH:
    case MT_PHASE_RECOMMENDATIONS:
    case MT_PHASE_CERTIFICATES:
    case MT_PHASE_RELAXATIONS:
        return a->searched;
    case MT_PHASE_BASELINE:
    case MT_PHASE_COUNT:
        break;
    }
    return true;
}

/* True where the phase lacks its input: a search that was cut, or a recommendation that was not
 * found. */
static bool is_groundless(const mt_answer *a, mt_phase which)
{
    const mt_interrupt *const i = a->interrupt;
    const bool cut = mt_interrupt_is_cut(i, MT_PHASE_SEARCH) ||
                     mt_interrupt_is_cut(i, MT_PHASE_RECOMMENDATIONS);
    if (which == MT_PHASE_RECOMMENDATIONS) {
        return false;
    }
    if (which == MT_PHASE_PUBLISHED) {
        return cut && a->result->n_recommendations == 0;
    }
    return cut || (which == MT_PHASE_TRADE && mt_interrupt_any(i));
}

/* "k = 1200 N/m, m = 2 kg", with all digits. */
static const char *values_text(const mt_problem *p, const double *x, mt_arena *mem)
{
    const char *text = "";
    for (int k = 0; k < p->n; k++) {
        const mt_variable *const v = &p->study->variables[k];
        text = mt_arena_printf(mem, "%s%s%s = %.17g%s%s", text, k > 0 ? ", " : "",
                               v->parameter_name.s, mt_unit_written(v->shown, x[k]),
                               v->shown == NULL ? "" : " ", mt_unit_name(v->shown, ""));
    }
    return text;
}

/* The values of designs that were not re-checked before the time ran out: hours of search may
 * be in them. */
static mt_status report_undescribed(const mt_answer *a, mt_err *err)
{
    mt_result *const r = a->result;
    const mt_problem *const p = a->p;
    const int asked = a->study->recommendations;
    const int last = a->found.n_solutions < asked ? a->found.n_solutions : asked;
    const int first = r->n_recommendations;
    const int n = last > first ? last - first : 0;
    r->unchecked = mt_arena_alloc(&r->mem, (size_t)n, sizeof *r->unchecked);
    MT_TRY(mt_arena_check(&r->mem, err));
    for (int i = 0; i < n; i++) {
        mt_unchecked *const u = &r->unchecked[i];
        u->values = mt_arena_f64(&r->mem, (size_t)p->n, 1);
        MT_TRY(mt_arena_check(&r->mem, err));
        mt_subproblem_x(&a->asked, a->found.solutions[first + i].t, u->values);
        u->text = values_text(p, u->values, &r->mem);
        r->n_unchecked++;
    }
    return mt_arena_check(&r->mem, err);
}

/* Result of a phase that was cut. */
static mt_status leave(mt_answer *a, mt_phase which, mt_err *err)
{
    mt_result_take_back(a->result, &a->mark);
    if (which == MT_PHASE_SEARCH) {
        /* nothing counts but the designs that it met: they are judged anew */
        a->found.stop = MT_STOP_USER;
        a->found.n_unidentifiable = 0;
        a->found.n_once = 0;
        a->found.missing = nan("");
        a->why = (mt_err){.code = MT_OK};
        a->result->run.distinct_designs = -1;
        a->result->run.singletons = -1;
        a->result->run.estimated_unseen = nan("");
        a->result->run.n_history = 0;
    } else if (which == MT_PHASE_RECOMMENDATIONS) {
        return report_undescribed(a, err);
    } else if (which == MT_PHASE_CERTIFICATES) {
        a->infeasible = false;
        a->impossible = false;
    }
    return MT_OK;
}

static mt_status phase(mt_answer *a, mt_phase which, mt_err *err)
{
#define MT_PHASE_WORK(id, name, makes_ready, work) {name, makes_ready, work},
    static const struct {
        const char *name;
        bool makes_ready;
        mt_status (*work)(mt_answer *a, mt_err *err);
    } phases[] = {MT_PHASE_LIST(MT_PHASE_WORK)};
#undef MT_PHASE_WORK
    mt_err own = {.code = MT_OK};
    if (!is_asked(a, which)) {
        return MT_OK;
    }
    if (is_groundless(a, which)) {
        mt_interrupt_cut(a->interrupt, (int)which);
        return MT_OK;
    }
    a->mark = mt_result_get_mark(a->result);
    a->task_path = mt_task_path_enter(a->whole, phases[which].name);
    mt_interrupt_enter(a->interrupt, (int)which, phases[which].makes_ready);
    a->spent->phase = (int)which;
    mt_progress_phase(a->p->run->progress, phases[which].name, which == MT_PHASE_SEARCH);
    const mt_status rc = phases[which].work(a, &own);
    const bool cut = mt_interrupt_is_cut(a->interrupt, (int)which);
    if (rc != MT_OK && !(cut && !mt_is_final(rc))) {
        return mt_fail(err, rc, "%s", own.text);
    }
    return cut ? leave(a, which, err) : MT_OK;
}

/* A design may take so much of a budget on its way along one drive. */
enum { OF_BUDGET = 10 };

static int positions_of(long most)
{
    const long part = most / OF_BUDGET;
    return most <= 0 ? 0 : part < 1 ? 1 : part < INT_MAX ? (int)part : INT_MAX;
}

long mt_question_left(const mt_question *q)
{
    const mt_search *const s = &q->p->whole.search;
    const long spent = mt_work_counters_of(&q->spent, MT_WORK_DESIGNS) +
                       mt_work_counters_of(&q->spent, MT_WORK_POSITIONS);
    const long left = s->max_evaluations <= 0      ? LONG_MAX
                      : spent < s->max_evaluations ? s->max_evaluations - spent
                                                   : 0;
    if (s->solutions_each <= 0) {
        return left;
    }
    const long solved = mt_work_counters_of(&q->spent, MT_WORK_MODAL);
    const long other = solved < s->max_modal_solutions
                           ? (s->max_modal_solutions - solved) / s->solutions_each
                           : 0;
    return other < left ? other : left;
}

/* The study's budget; one of modal solutions in evaluations. */
static void set_budget(mt_question *q)
{
    mt_search *const s = &q->p->whole.search;
    if (s->max_modal_solutions > 0) {
        const long each = mt_subproblem_solutions(&q->p->whole);
        s->solutions_each = each > 1 ? each : 1;
        const long n = s->max_modal_solutions / s->solutions_each;
        s->by_solutions = s->max_evaluations <= 0 || n < s->max_evaluations;
        s->max_evaluations = s->by_solutions ? (n > 1 ? n : 1) : s->max_evaluations;
    }
    s->max_positions = positions_of(s->max_evaluations);
}

/* Analyses the original design, which every part of the answer needs. */
static mt_status end_at_once(const mt_question *q, mt_status rc, const mt_err *own, mt_err *err)
{
    if (mt_interrupt_is_cut(&q->interrupt, MT_PHASE_BASELINE) && !mt_is_final(rc)) {
        return mt_fail(err, MT_E_INTERRUPTED,
                       "interrupted before the original design was analysed");
    }
    return rc == MT_OK ? MT_OK : mt_fail(err, rc, "%s", own->text);
}

mt_status mt_question_init(mt_question *q, const mt_study *study, const mt_run *run,
                           const mt_solve_options *opt, mt_err *err)
{
    const mt_run *const whole = mt_run_or_none(run);
    mt_err own = {.code = MT_OK};
    mt_interrupt_init(&q->interrupt, opt->stop, opt->stop_context, whole->interrupt);
    q->interrupt.cause = opt->cause;
    mt_interrupt_enter(&q->interrupt, MT_PHASE_BASELINE, true);
    mt_work_counters_init(&q->spent);
    q->study = study;
    q->run = (mt_run){.interrupt = &q->interrupt,
                      .progress = whole->progress,
                      .work = &q->spent,
                      .profile = whole->profile};
    const mt_status rc = mt_problem_new(study, &q->run, &q->p, &own);
    if (rc == MT_OK) {
        set_budget(q);
    }
    return end_at_once(q, rc, &own, err);
}

void mt_question_free(mt_question *q)
{
    mt_problem_delete(q->p);
    q->p = NULL;
}

/*
 * What eigenvalues may lose while designs are looked for: nothing that a goal would feel. A
 * polish takes second derivatives by differences of slopes and wants more than goals do.
 * Numbers of a result are computed anew, to MT_MODAL_ACCURACY.
 */
static const double SEARCH_ACCURACY = 1e-10;
static const double OF_TOLERANCE = 1e-3;

static double search_accuracy(const mt_problem *p)
{
    double least = SEARCH_ACCURACY;
    for (int i = 0; i < p->n_requirements; i++) {
        least = fmin(least, OF_TOLERANCE * p->requirements[i].tolerance);
    }
    for (int i = 0; i < p->n_avoidances; i++) {
        least = fmin(least, OF_TOLERANCE * p->avoidances[i].tolerance);
    }
    return fmax(least, MT_MODAL_ACCURACY);
}

/* A workspace for each worker. */
static mt_status open_workers(mt_answer *a, int threads, mt_err *err)
{
    const bool alone = threads < 1 || a->study->n_variables == 0;
    const int n = alone ? 1 : threads < MT_WORKERS_MOST ? threads : MT_WORKERS_MOST;
    a->asked = a->p->whole;
    a->workers = mt_arena_alloc(&a->mem, (size_t)n, sizeof(mt_workspace *));
    MT_TRY(mt_arena_check(&a->mem, err));
    for (int i = 0; i < n; i++) {
        MT_TRY(mt_workspace_new(a->p, &a->workers[i], err));
        a->workers[i]->accuracy = search_accuracy(a->p);
        /* tasks have places of their own */
        a->workers[i]->task_path = i == 0 ? &a->task_path : NULL;
        mt_workspace_back(a->workers[i], &a->asked);
        a->n_workers = i + 1;
    }
    return MT_OK;
}

/* The caller's design as one more start of every search. */
static mt_status take_hint(mt_answer *a, const double *hint, mt_err *err)
{
    const mt_problem *const p = a->p;
    double *const t = mt_arena_f64(&a->mem, (size_t)p->n + 1, 1);
    MT_TRY(mt_arena_check(&a->mem, err));
    for (int i = 0; i < p->n; i++) {
        t[i] = mt_problem_t(p, i, hint[i]); /* the search brings it within the bounds */
    }
    a->asked.hint = t;
    return MT_OK;
}

/* Workers, and the original design, without which there is nothing to tell. */
static mt_status start_workers_and_baseline(mt_answer *a, const mt_solve_options *opt,
                                            mt_err *err)
{
    mt_err own = {.code = MT_OK};
    mt_interrupt_enter(a->interrupt, MT_PHASE_BASELINE, true);
    a->spent->phase = MT_PHASE_BASELINE;
    mt_status rc = open_workers(a, opt->threads, &own);
    rc = rc == MT_OK ? mt_answer_baseline(a, &own) : rc;
    MT_TRY(end_at_once(a->q, rc, &own, err));
    a->workers[0]->progress = opt->progress; /* the first worker's: one line at a time */
    a->workers[0]->progress_context = opt->progress_context;
    a->searched = a->p->n > 0 && (a->p->n_requirements > 0 || a->p->n_avoidances > 0);
    if (a->searched && opt->progress != NULL) { /* however few designs its worker evaluates */
        opt->progress(opt->progress_context, "searching: the first designs are evaluated");
    }
    return opt->hint != NULL ? take_hint(a, opt->hint, err) : MT_OK;
}

/* A list that a phase did not get to is NULL, one that it found nothing for is empty. */
static void *kept(const mt_answer *a, mt_phase which, void *list, int n)
{
    const bool cut = mt_interrupt_is_cut(a->interrupt, (int)which);
    if (list == NULL && !cut) {
        return mt_arena_alloc(&a->result->mem, 0, 1);
    }
    return n == 0 && cut ? NULL : list;
}

static mt_status report_cut_lists(mt_answer *a, mt_err *err)
{
    mt_result *const r = a->result;
    r->unidentifiable = kept(a, MT_PHASE_SEARCH, r->unidentifiable, r->n_unidentifiable);
    r->weight_sensitivity =
        kept(a, MT_PHASE_WEIGHT_SENSITIVITY, r->weight_sensitivity, r->n_weight_sensitivity);
    r->certificates = kept(a, MT_PHASE_CERTIFICATES, r->certificates, r->n_certificates);
    r->relaxations = kept(a, MT_PHASE_RELAXATIONS, r->relaxations, r->n_relaxations);
    r->published = kept(a, MT_PHASE_PUBLISHED, r->published, r->n_published);
    return mt_arena_check(&r->mem, err);
}

/* A run for a part of the work: the tasks that need no result of other parts. Their results are
 * in the store; the answer, of what is known, is cut. */
static mt_status conduct_part(mt_answer *a, mt_err *err)
{
    static const mt_phase lists[] = {MT_PHASE_SEARCH, MT_PHASE_TRADE};
    for (int i = 0; i < MT_COUNT(lists) && !mt_interrupt_any(a->interrupt); i++) {
        mt_err own = {.code = MT_OK};
        const mt_status rc = phase(a, lists[i], &own);
        if (rc != MT_OK && rc != MT_E_INTERRUPTED) {
            return mt_fail(err, rc, "%s", own.text);
        }
    }
    return MT_OK;
}

/* All that follows a search. */
static mt_status conclude(mt_answer *a, mt_err *err)
{
    MT_TRY(phase(a, MT_PHASE_RECOMMENDATIONS, err));
    MT_TRY(phase(a, MT_PHASE_WEIGHT_SENSITIVITY, err));
    MT_TRY(phase(a, MT_PHASE_CERTIFICATES, err));
    if (mt_describe_is_doubted(a->result)) {
        MT_TRY(mt_describe_withdraw(a->result, err));
    }
    MT_TRY(phase(a, MT_PHASE_RELAXATIONS, err));
    MT_TRY(mt_answer_warn(a, err));
    a->result->run.starts = a->found.starts;
    MT_TRY(mt_answer_set_status(a, err));
    MT_TRY(phase(a, MT_PHASE_PUBLISHED, err));
    MT_TRY(report_cut_lists(a, err));
    MT_TRY(mt_describe_own(a->study, a->result, err));
    MT_TRY(phase(a, MT_PHASE_TRADE, err));
    mt_answer_note_work_counters(a);
    return mt_answer_note_cuts(a, err);
}

static mt_status incumbent_result(mt_answer *now, mt_err *err)
{
    now->spent->phase = MT_PHASE_BASELINE;
    MT_TRY(mt_answer_baseline(now, err));
    MT_TRY(mt_answer_take_placements(now, err));
    now->found.n_solutions = 1;
    now->mark = mt_result_get_mark(now->result);
    mt_interrupt_cut(now->interrupt, MT_PHASE_SEARCH);
    MT_TRY(leave(now, MT_PHASE_SEARCH, err));
    return conclude(now, err);
}

mt_status mt_answer_incumbent(void *answer, const mt_mode_placement_result *found, mt_err *err)
{
    const mt_answer *const a = answer;
    mt_interrupt own;       /* the whole is not cut by what this leaves out */
    mt_work_counters spent; /* nor does it pay for what is told early */
    mt_answer now = *a;
    mt_interrupt_init(&own, a->interrupt->request, a->interrupt->context, NULL);
    now.interrupt = &own;
    mt_work_counters_copy(a->spent, &spent);
    now.spent = &spent;
    a->q->run.work = &spent;
    now.mem = (mt_arena){.first = NULL};
    now.placements = *found;
    now.result = NULL;
    mt_status rc = mt_arena_init(&now.mem, 0, err);
    rc = rc == MT_OK ? mt_result_new(&now.result, err) : rc;
    rc = rc == MT_OK ? incumbent_result(&now, err) : rc;
    a->q->run.work = a->spent;
    if (!mt_interrupted(a->interrupt)) { /* else that brings it about */
        rc = rc == MT_OK ? a->incumbent->tell(a->incumbent->context, now.result, err) : rc;
    } else if (!mt_is_final(rc)) {
        rc = MT_OK;
    }
    mt_result_delete(now.result);
    mt_arena_free(&now.mem);
    return rc;
}

static mt_status conduct(mt_answer *a, mt_err *err)
{
    if (a->whole != NULL && a->whole->store != NULL && a->whole->store->parts > 0 &&
        !a->whole->inner) {
        return conduct_part(a, err);
    }
    MT_TRY(phase(a, MT_PHASE_SEARCH, err));
    return conclude(a, err);
}

mt_status mt_question_answer(mt_question *q, const mt_solve_options *opt,
                             const mt_task_path *task_path,
                             const mt_incumbent_callback *incumbent, mt_result **out,
                             mt_err *err)
{
    mt_answer a = {.q = q, .study = q->study, .p = q->p, .interrupt = &q->interrupt};
    a.spent = &q->spent;
    a.threads = opt->threads;
    a.whole = task_path;
    a.incumbent = incumbent;
    *out = NULL;
    mt_status rc = mt_arena_init(&a.mem, 0, err);
    rc = rc == MT_OK ? mt_result_new(&a.result, err) : rc;
    rc = rc == MT_OK ? start_workers_and_baseline(&a, opt, err) : rc;
    rc = rc == MT_OK ? conduct(&a, err) : rc;
    for (int i = 0; i < a.n_workers; i++) {
        mt_workspace_delete(a.workers[i]);
    }
    mt_arena_free(&a.mem);
    if (rc != MT_OK) {
        mt_result_delete(a.result);
        return rc;
    }
    *out = a.result;
    return MT_OK;
}

mt_status mt_study_solve(const mt_study *study, const mt_solve_options *opt, mt_result **out,
                         mt_err *err)
{
    return mt_study_solve_with(study, opt, NULL, NULL, out, err);
}

mt_status mt_study_solve_with(const mt_study *study, const mt_solve_options *opt,
                              const mt_run *run, const mt_incumbent_callback *incumbent,
                              mt_result **out, mt_err *err)
{
    mt_solve_options use;
    mt_question q = {.p = NULL};
    MT_NOT_NULL(out, err);
    *out = NULL;
    MT_NOT_NULL(study, err);
    MT_TRY(MT_OPTIONS_TAKE(opt, &use, err));
    run = mt_run_or_none(run);
    mt_progress_phase(run->progress, "baseline", false);
    for (int i = 0; use.hint != NULL && i < study->n_variables; i++) {
        if (!isfinite(use.hint[i])) {
            return mt_fail(err, MT_E_USAGE, "mt_study_solve: hint[%d] is not finite", i);
        }
    }
    mt_status rc = mt_question_init(&q, study, run, &use, err);
    const mt_task_path whole = {.store = run->tasks != NULL ? run->tasks->store : NULL,
                                .interrupt = &q.interrupt,
                                .progress = run->progress};
    rc = rc == MT_OK ? mt_question_answer(&q, &use, &whole, incumbent, out, err) : rc;
    mt_question_free(&q);
    return rc;
}
