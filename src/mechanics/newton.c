/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * One stage of the position analysis from start to verdict. Plain Newton (newton_step.c) finds
 * any stationary point of the energy, a saddle as well as a minimum. What is drawn in
 * equilibrium stays there, stable or not. Else it settles: where Newton does not converge, ends
 * uphill, or in a saddle that the drawing lies beside (its distance has a part along directions
 * of negative curvature), the energy is followed downhill from the drawing and out of such
 * saddles, and Newton finishes. A saddle that the drawing lies straight above (a column beyond
 * its buckling load, compressed along its axis) is an equilibrium that does not say which way
 * it falls: it stands, and is told as unstable.
 */
#include "mechanics/newton_priv.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "mechanics/singular.h"

enum { NEWTON_LIMIT = 60, WHERE_SIZE = 300 };
/* Saddles that the way downhill may lead into. */
enum { SADDLES = 12 };
/* Energies differ by rounding below this part of them. */
static const double ENERGY_ROUNDING = 1e-12;

/* What the step last found, w->step and trim, would change: with r = g + A^T lambda + t trim +
 * H step unbalanced, A^T lambda' = -r. */
static mt_status keep_step(const mt_newton_work *w, const mt_elimination *e, double trim,
                           mt_arena *mem, mt_step_left *left, mt_err *err)
{
    const int nq = w->sys->nq;
    const int m = w->p->m;
    left->trim = w->p->trim ? trim : 0.0;
    left->q = mt_arena_f64(mem, (size_t)nq, 1);
    left->lambda = mt_arena_f64(mem, (size_t)m, 1);
    double *const r = mt_arena_f64(mem, (size_t)nq, 1);
    if (left->q == NULL || left->lambda == NULL || r == NULL) {
        return mt_fail_memory(err);
    }
    memcpy(left->q, w->step, (size_t)nq * sizeof *left->q);
    for (ptrdiff_t j = 0; j < nq; j++) {
        r[j] = -w->g[j] - (left->trim * w->trim[j]) - mt_dot(m, w->a + (j * m), w->lambda);
    }
    mt_gemv(false, nq, nq, -1.0, w->h, nq, w->step, 1.0, r);
    return mt_eliminate_multipliers(e, r, left->lambda, mem, err);
}

/* tau: of the trimmed spring, before the last step. */
static mt_status keep(mt_newton_work *w, const mt_elimination *e, double *inverse, double tau,
                      mt_arena *mem, mt_state *report, mt_stage *stage, mt_err *err)
{
    MT_TRY(keep_step(w, e, w->tau - tau, mem, &stage->left, err));
    w->tau = tau;
    const size_t nq = (size_t)w->sys->nq;
    const size_t m = (size_t)w->p->m;
    stage->active = true;
    stage->m = w->p->m;
    stage->e = *e;
    stage->order = e->n + (w->p->trim ? 1 : 0);
    stage->inverse = inverse;
    stage->null_freedoms = w->null_freedoms;
    stage->lambda = mt_arena_f64(mem, m, 1);
    stage->h = mt_arena_f64(mem, nq, nq);
    stage->a = mt_arena_f64(mem, m, nq);
    stage->trim = mt_arena_f64(mem, nq, 1);
    if (stage->lambda == NULL || stage->h == NULL || stage->a == NULL || stage->trim == NULL) {
        return mt_fail_memory(err);
    }
    memcpy(stage->lambda, w->lambda, m * sizeof *stage->lambda);
    memcpy(stage->h, w->h, nq * nq * sizeof *stage->h);
    memcpy(stage->a, w->a, m * nq * sizeof *stage->a);
    memcpy(stage->trim, w->trim, nq * sizeof *stage->trim);
    if (w->p->energy == MT_ENERGY_PHYSICAL) {
        report->residual = w->residual;
        report->trim_force = w->tau;
    }
    return MT_OK;
}

/* Plain Newton from the present position; *done tells whether it converged. */
static mt_status iterate(mt_newton_work *w, mt_pose *poses, mt_arena *mem, mt_state *report,
                         mt_stage *stage, bool *done, mt_err *err)
{
    double previous = HUGE_VAL;
    double unbalanced = HUGE_VAL;
    *done = false;
    for (int it = 0; it < NEWTON_LIMIT; it++) {
        const mt_arena_mark mark = mt_arena_get_mark(mem);
        mt_elimination e;
        double *inverse = NULL;
        const double tau = w->tau;
        MT_TRY(mt_newton_linearise(w, poses, mem, &e, &inverse, err));
        if (it == 0 && w->p->energy == MT_ENERGY_PHYSICAL && w->gap <= MT_STEP_DONE) {
            /* several ways lead on */
            MT_TRY(mt_singular_refuse(w->p->data, poses, &e, mem, err));
        }
        report->iterations++;
        if (it == 0 && w->watch && w->gap <= MT_STEP_DONE && w->moved > MT_DRAWN &&
            w->residual > MT_FORCE_DONE + (MT_NOISE_ROOM * w->noise)) {
            bool falls = false;
            MT_TRY(mt_newton_falls(w, &e, w->step, &falls, mem, err));
            if (falls) {
                return MT_OK;
            }
        }
        /* stop where the step is rounding: small, and no longer shrinking or negligible */
        const bool small = w->moved <= MT_STEP_DONE &&
                           (w->moved >= 0.25 * previous || w->moved <= 8.0 * DBL_EPSILON);
        const bool rests = small && w->gap <= MT_STEP_DONE;
        if (rests && w->residual <= MT_FORCE_DONE + (MT_NOISE_ROOM * w->noise)) {
            const mt_status rc = keep(w, &e, inverse, tau, mem, report, stage, err);
            *done = rc == MT_OK;
            return rc;
        }
        if (rests && (!w->p->trim || w->residual >= 0.25 * unbalanced)) {
            return MT_OK; /* something pushes along a freedom without stiffness */
        }                 /* else the force of the trimmed spring is still settling */
        previous = w->moved;
        unbalanced = w->residual;
        mt_newton_take_step(w, poses, MT_STEP_LIMIT);
        mt_newton_follow(w, poses);
        mt_arena_rewind(mem, mark);
        if (!(w->moved < HUGE_VAL)) {
            return MT_OK;
        }
    }
    return MT_OK;
}

/* A position that is not a number ends the iteration, not the analysis: the start may be
 * bad. */
static mt_status attempt(mt_newton_work *w, mt_pose *poses, mt_arena *mem, mt_state *report,
                         mt_stage *stage, bool *done, mt_err *err)
{
    const mt_status rc = iterate(w, poses, mem, report, stage, done, err);
    return rc == MT_E_DOMAIN || rc == MT_E_NO_CONVERGENCE ? MT_OK : rc;
}

/* poses: where the search ended; closed, where the stage began closed. */
static mt_status refuse(mt_newton_work *w, const mt_pose *poses, bool closed, mt_arena *mem,
                        const mt_state *report, mt_err *err)
{
    mt_elimination e;
    double *inverse = NULL;
    memset(w->lambda, 0, (size_t)w->p->m * sizeof *w->lambda);
    mt_newton_evaluate(w, poses, false);
    MT_TRY(mt_eliminate(w->sys, w->p->m, w->a, mem, &e, err));
    if (!closed && !(mt_newton_gap_of(w) <= MT_STEP_DONE)) {
        return mt_newton_open_loop(w->p, poses, &e, mem, err);
    }
    MT_TRY(mt_newton_linearise(w, poses, mem, &e, &inverse, err));
    char where[WHERE_SIZE];
    mt_eliminate_project(&e, w->g, w->reduced);
    mt_position_name_motion(w->sys, &e, w->reduced, where, sizeof where);
    return mt_fail(err, MT_E_EQUILIBRIUM,
                   "no equilibrium found after %d iterations: %.3g of the forces at work stay "
                   "unbalanced on %s (free to move under load?)",
                   report->iterations, w->residual, where);
}

/* Is the stationary point that was last evaluated a saddle, with the drive held, that the way
 * from the start leads down from? That direction goes into w->step. */
static mt_status find_saddle(mt_newton_work *w, const mt_pose *start, const mt_pose *poses,
                             const mt_stage *stage, bool *saddle, mt_arena *mem, mt_err *err)
{
    mt_elimination held;
    const mt_elimination *e = &stage->e;
    double *const way = mt_arena_f64(mem, (size_t)w->sys->nq, 1);
    if (way == NULL) {
        return mt_fail_memory(err);
    }
    if (w->p->trim) {
        MT_TRY(mt_eliminate(w->sys, w->p->m, w->a, mem, &held, err));
        e = &held;
    }
    mt_newton_way(w->sys, start, poses, way);
    return mt_newton_falls(w, e, way, saddle, mem, err);
}

/* What is kept of the better of two ends. */
typedef struct ending {
    bool done;
    bool saddle;
    double energy;
    double before; /* the energy where the stage began */
} ending;

static mt_status judge(mt_newton_work *w, const mt_pose *start, const mt_pose *poses,
                       const mt_stage *stage, ending *end, mt_arena *mem, mt_err *err)
{
    end->saddle = false;
    if (end->done) {
        MT_TRY(find_saddle(w, start, poses, stage, &end->saddle, mem, err));
        end->energy = mt_energy_value(w->p->data, poses, w->tau);
    }
    return MT_OK;
}

/* A position with its whole turns. */
typedef struct place {
    mt_pose *pose;
    double *turn;
} place;

static mt_status note(const mt_newton_work *w, const mt_pose *poses, place *out, mt_arena *mem,
                      mt_err *err)
{
    const size_t n = (size_t)w->sys->n_bodies;
    const size_t turns = (size_t)w->sys->n_measures;
    out->pose = mt_arena_alloc(mem, n, sizeof *out->pose);
    out->turn = mt_arena_f64(mem, turns, 1);
    if (out->pose == NULL || out->turn == NULL) {
        return mt_fail_memory(err);
    }
    memcpy(out->pose, poses, n * sizeof *poses);
    memcpy(out->turn, w->p->data->turn, turns * sizeof *out->turn);
    return MT_OK;
}

static void go_back(const mt_newton_work *w, const place *to, mt_pose *poses)
{
    memcpy(poses, to->pose, (size_t)w->sys->n_bodies * sizeof *poses);
    memcpy(w->p->data->turn, to->turn, (size_t)w->sys->n_measures * sizeof *to->turn);
}

/* Downhill from poses, and out of every saddle on the way. */
static mt_status settle(mt_newton_work *w, const mt_pose *start, mt_pose *poses, mt_arena *mem,
                        mt_state *report, mt_stage *stage, ending *end, mt_err *err)
{
    const size_t size = (size_t)w->sys->n_bodies * sizeof *poses;
    mt_pose *const low = mt_arena_alloc(mem, (size_t)w->sys->n_bodies, sizeof *low);
    if (low == NULL) {
        return mt_fail_memory(err);
    }
    bool on = true;
    for (int i = 0; i < SADDLES && on; i++) {
        MT_TRY(mt_newton_descend(w, poses, mem, err));
        memcpy(low, poses, size);
        MT_TRY(attempt(w, poses, mem, report, stage, &end->done, err));
        MT_TRY(judge(w, start, poses, stage, end, mem, err));
        on = end->saddle;
        if (on) {
            MT_TRY(mt_newton_leave_saddle(w, poses, &on, mem, err));
        }
    }
    if (!end->done) {
        memcpy(poses, low, size);
    }
    return MT_OK;
}

/* With trim: the stationary point with the joint locked is where the trimmed one begins. */
static mt_status lock_first(const mt_newton_work *w, mt_pose *poses, mt_arena *mem,
                            mt_state *report, mt_err *err)
{
    mt_newton_problem locked = *w->p;
    mt_stage stage = {.active = false};
    mt_state other = *report;
    place before;
    locked.trim = false;
    MT_TRY(note(w, poses, &before, mem, err));
    const mt_status rc = mt_newton_solve(&locked, poses, mem, &other, &stage, NULL);
    report->iterations = other.iterations;
    if (rc != MT_OK) {
        go_back(w, &before, poses);
    }
    return rc == MT_E_MEMORY ? mt_fail_memory(err) : MT_OK;
}

/* A physical stage whose plain Newton ended as `end` says: downhill from the start, unless it
 * may stay. */
static mt_status go_on(mt_newton_work *w, const place *start, mt_pose *poses, mt_arena *mem,
                       mt_state *report, mt_stage *stage, ending *end, mt_err *err)
{
    MT_TRY(judge(w, start->pose, poses, stage, end, mem, err));
    const double rounding = ENERGY_ROUNDING * (fabs(end->before) + fabs(end->energy));
    const bool uphill = !w->p->trim && end->done && end->energy > end->before + rounding;
    const bool settled = !end->saddle && !uphill;
    if (end->done && (settled || mt_newton_distance(w->sys, start->pose, poses) <= MT_DRAWN)) {
        return MT_OK;
    }
    const mt_stage first_stage = *stage;
    const mt_state first_report = *report;
    const bool found = end->done;
    place first;
    MT_TRY(note(w, poses, &first, mem, err));
    w->watch = false;
    go_back(w, start, poses);
    w->tau = 0.0;
    if (w->p->trim && found) {
        MT_TRY(lock_first(w, poses, mem, report, err));
        MT_TRY(attempt(w, poses, mem, report, stage, &end->done, err));
    } else {
        MT_TRY(settle(w, start->pose, poses, mem, report, stage, end, err));
    }
    if (found && !end->done) { /* nothing lower holds it: the saddle stands, told as unstable */
        end->done = true;
        *stage = first_stage;
        *report = first_report;
        go_back(w, &first, poses);
    }
    return MT_OK;
}

mt_status mt_newton_solve(const mt_newton_problem *problem, mt_pose *poses, mt_arena *mem,
                          mt_state *report, mt_stage *stage, mt_err *err)
{
    mt_newton_work w;
    ending end = {.done = false};
    place start;
    MT_TRY(mt_newton_work_init(&w, problem, mem, err));
    MT_TRY(note(&w, poses, &start, mem, err));
    mt_newton_evaluate(&w, poses, false);
    const bool closed = mt_newton_gap_of(&w) <= MT_STEP_DONE;
    end.before = mt_energy_value(problem->data, poses, 0.0);
    w.watch = problem->energy == MT_ENERGY_PHYSICAL && !problem->trim;
    MT_TRY(attempt(&w, poses, mem, report, stage, &end.done, err));
    if (problem->energy == MT_ENERGY_PHYSICAL) {
        MT_TRY(go_on(&w, &start, poses, mem, report, stage, &end, err));
    }
    return end.done ? MT_OK : refuse(&w, poses, closed, mem, report, err);
}

mt_status mt_newton_gap(const mt_newton_problem *problem, const mt_pose *poses, mt_arena *mem,
                        double *gap_m, mt_err *err)
{
    mt_newton_work w;
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    MT_TRY(mt_newton_work_init(&w, problem, mem, err));
    mt_newton_evaluate(&w, poses, false);
    *gap_m = mt_newton_gap_of(&w) * w.sys->length_m;
    mt_arena_rewind(mem, mark);
    return MT_OK;
}
