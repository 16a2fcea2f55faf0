/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * One stage of the position analysis from start to verdict. Plain Newton (newton_step.c) finds
 * any stationary point of the energy, a saddle as well as a minimum. Where a drive has brought
 * the mechanism beside a trimmed equilibrium the way back begins with the elastic stiffness
 * alone: what the way has strained pushes with forces that are gone at its end, and their
 * geometric stiffness leads astray. What is drawn in
 * equilibrium, to the rounding of its forces, stays there, stable or not, and though a step
 * against what hardly holds it would lead far. Else it settles: where Newton does not converge,
 * ends uphill, or in a saddle that the drawing lies beside (its distance has a part along
 * directions of negative curvature), the energy is followed downhill from the drawing and out
 * of such saddles, and Newton finishes. A saddle that the drawing lies straight above (a column
 * beyond its buckling load, compressed along its axis) is an equilibrium that does not say
 * which way it falls: it stands, and is told as unstable.
 */
#include "mechanics/newton.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "mechanics/names.h"
#include "mechanics/newton_descent.h"
#include "mechanics/newton_step.h"
#include "mechanics/singular.h"

enum { NEWTON_LIMIT = 60, WHERE_SIZE = 300 };
/* Saddles that the way downhill may lead into. */
enum { SADDLES = 12 };
/* Energies differ by rounding below this part of them. */
static const double ENERGY_ROUNDING = 1e-12;
/* Entries of a left null vector (largest 1) above this belong to the dependent set. */
static const double IN_THE_SET = 1e-6;

/* Store the last step, w->step and trim, and the change of the multipliers: with r = g + A^T
 * lambda + t trim + H step unbalanced, A^T lambda' = -r. */
static mt_status keep_step(const mt_newton_work *w, const mt_newton_solver *solver, double trim,
                           mt_arena *mem, mt_newton_residual *left, mt_err *err)
{
    const int nq = w->sys->nq;
    const int m = w->p->m;
    left->trim = w->p->trim ? trim : 0.0;
    left->q = mt_arena_f64(mem, (size_t)nq, 1);
    left->lambda = mt_arena_f64(mem, (size_t)m, 1);
    double *const r = mt_arena_f64(mem, (size_t)nq, 1);
    MT_TRY(mt_arena_check(mem, err));
    memcpy(left->q, w->step, (size_t)nq * sizeof *left->q);
    if (solver->sparse) {
        memcpy(left->lambda, w->turn, (size_t)m * sizeof *left->lambda);
        return MT_OK;
    }
    for (ptrdiff_t j = 0; j < nq; j++) {
        r[j] = -w->g[j] - (left->trim * w->trim[j]) - mt_dot(m, w->a + (j * m), w->lambda);
    }
    mt_gemv(false, nq, nq, -1.0, w->h, nq, w->step, 1.0, r);
    return mt_eliminate_multipliers(&solver->e, r, left->lambda, mem, err);
}

/* tau: of the trimmed spring, before the last step. */
static mt_status keep_solution(mt_newton_work *w, const mt_newton_solver *solver, double tau,
                               mt_arena *mem, mt_stage *stage, mt_err *err)
{
    MT_TRY(keep_step(w, solver, w->tau - tau, mem, &stage->left, err));
    w->tau = tau;
    const size_t nq = (size_t)w->sys->nq;
    const size_t m = (size_t)w->p->m;
    stage->active = true;
    stage->m = w->p->m;
    stage->solver = *solver;
    stage->null_freedoms = w->null_freedoms;
    stage->lambda = mt_arena_f64(mem, m, 1);
    stage->h = solver->sparse ? NULL : mt_arena_f64(mem, nq, nq);
    stage->a = solver->sparse ? NULL : mt_arena_f64(mem, m, nq);
    stage->trim = mt_arena_f64(mem, nq, 1);
    stage->d_lambda = mt_arena_f64(mem, m, 1);
    MT_TRY(mt_arena_check(mem, err));
    memcpy(stage->lambda, w->lambda, m * sizeof *stage->lambda);
    memcpy(stage->trim, w->trim, nq * sizeof *stage->trim);
    stage->solver.border.along = solver->border.along == NULL ? NULL : stage->trim;
    if (!solver->sparse) {
        memcpy(stage->h, w->h, nq * nq * sizeof *stage->h);
        memcpy(stage->a, w->a, m * nq * sizeof *stage->a);
    }
    stage->residual = w->residual;
    stage->trim_force = w->tau;
    return MT_OK;
}

/* True where a plain Newton iteration ends: the step is rounding, no longer shrinking or
 * negligible, and the constraints are closed. */
static bool rests(const mt_newton_work *w, double previous)
{
    const bool small = w->moved <= MT_STEP_DONE &&
                       (w->moved >= 0.25 * previous || w->moved <= 8.0 * DBL_EPSILON);
    return small && w->gap <= MT_STEP_DONE;
}

static bool balanced(const mt_newton_work *w)
{
    return w->residual <= MT_FORCE_DONE + (MT_NOISE_ROOM * w->noise);
}

/*
 * The equations at a position, sparse where they are safely regular, otherwise dense. first: of
 * the stage; the dense method then checks for several continuations, and *falls: energy
 * decreases elsewhere.
 */
static mt_status linearise(mt_newton_work *w, const mt_placement *at, bool first, mt_arena *mem,
                           mt_newton_solver *solver, bool *falls, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    const double tau = w->tau;
    bool sure = false;
    if (w->least != NULL) {
        const bool physical = w->p->energy == MT_ENERGY_PHYSICAL;
        MT_TRY(mt_newton_linearise_sparse(w, at, first && physical, mem, solver, &sure, err));
        if (sure && !w->p->sparse && w->gap <= MT_STEP_DONE &&
            balanced(w)) { /* the step is rounding, or none */
            MT_TRY(mt_newton_is_firm(&solver->saddle, mem, &sure, err));
        }
    }
    if (sure) {
        return MT_OK;
    }
    mt_arena_rewind(mem, mark);
    w->tau = tau;
    MT_TRY(mt_newton_dense(w, mem, err));
    MT_TRY(mt_newton_linearise(w, at, mem, solver, err));
    if (!first || w->gap > MT_STEP_DONE) {
        return MT_OK;
    }
    if (w->p->energy == MT_ENERGY_PHYSICAL) {
        MT_TRY(mt_singular_refuse(w->p->data, at, &solver->e, mem, err));
    }
    if (w->watch && w->moved > MT_DRAWN && !balanced(w)) {
        MT_TRY(mt_newton_falls(w, &solver->e, w->step, falls, mem, err));
    }
    return MT_OK;
}

/* Steps that are longer than this are of the elastic stiffness alone [model lengths]. */
static const double NEAR = 1e-3;

/* True where the step that was found with the elastic stiffness alone is to be taken;
 * w->elastic: the next one is of that kind, too. Freedoms that only forces hold have no part in
 * it. */
static bool use_elastic(mt_newton_work *w, double previous)
{
    const bool shrinks = w->moved <= 0.5 * previous;
    w->elastic = shrinks && w->moved > NEAR;
    return shrinks;
}

/* The error of multipliers that a Newton step updates is of second order in the step, as is
 * that of a least-squares fit at its end. After longer steps they are fitted
 * [model lengths]. */
static const double FOLLOWS = 1e-2;

/* Set the step to zero where a stage begins in equilibrium, however weakly held. */
static void stay_at_rest(mt_newton_work *w, const mt_newton_solver *solver)
{
    if (w->watch && !solver->sparse && mt_newton_at_rest(w, &solver->e)) {
        memset(w->step, 0, (size_t)w->sys->nq * sizeof *w->step);
        w->moved = 0.0;
    }
}

/* Take the computed step and update the multipliers. */
static void move_by_newton_step(mt_newton_work *w, mt_placement *at,
                                const mt_newton_solver *solver)
{
    w->followed = solver->sparse && !w->p->sparse && w->moved <= FOLLOWS;
    mt_newton_take_step(w, at, MT_STEP_LIMIT);
    mt_newton_follow(w, at);
}

/* Plain Newton from the present position; *done: converged. */
static mt_status iterate_newton(mt_newton_work *w, mt_placement *at, mt_arena *mem,
                                mt_stage *stage, bool *done, mt_err *err)
{
    double previous = HUGE_VAL;
    double unbalanced = HUGE_VAL;
    *done = false;
    w->followed = false;
    w->elastic = w->p->trim && w->p->energy == MT_ENERGY_PHYSICAL;
    for (int it = 0; it < NEWTON_LIMIT; it++) {
        const mt_arena_mark mark = mt_arena_get_mark(mem);
        const bool dense = w->h != NULL;
        mt_newton_solver solver;
        const double tau = w->tau;
        const bool followed = w->followed;
        bool falls = false;
        MT_TRY(linearise(w, at, it == 0, mem, &solver, &falls, err));
        stage->iterations++;
        if (falls) {
            return MT_OK;
        }
        if (it == 0) {
            stay_at_rest(w, &solver);
        }
        if (w->elastic) {
            if (!use_elastic(w, previous)) {
                w->tau = tau;
                previous = HUGE_VAL;
                continue;
            }
            previous = w->moved;
            move_by_newton_step(w, at, &solver);
            continue;
        }
        const bool rest = rests(w, previous);
        if (rest && balanced(w)) {
            const mt_status rc = keep_solution(w, &solver, tau, mem, stage, err);
            *done = rc == MT_OK;
            return rc;
        }
        if (rest && followed && solver.sparse) {
            w->tau = tau; /* what is unbalanced may be the multipliers' own error */
            mt_arena_rewind(mem, mark);
            continue;
        }
        if (rest && (!w->p->trim || w->residual >= 0.25 * unbalanced)) {
            return MT_OK; /* something pushes along a freedom without stiffness */
        }                 /* else the force of the trimmed spring is still settling */
        previous = w->moved;
        unbalanced = w->residual;
        move_by_newton_step(w, at, &solver);
        if (dense == (w->h != NULL)) { /* else there is room for dense matrices from here on */
            mt_arena_rewind(mem, mark);
        }
        if (!(w->moved < HUGE_VAL)) {
            return MT_OK;
        }
    }
    return MT_OK;
}

/* A position that is not a number ends the iteration, not the analysis: the start may be
 * bad. */
static mt_status attempt(mt_newton_work *w, mt_placement *at, mt_arena *mem, mt_stage *stage,
                         bool *done, mt_err *err)
{
    const mt_status rc = iterate_newton(w, at, mem, stage, done, err);
    return rc == MT_E_DOMAIN || rc == MT_E_NO_CONVERGENCE ? MT_OK : rc;
}

/* Name joints: those in the left null vectors of A along which the gap lies (they contradict
 * each other), otherwise the one with the largest gap. */
static mt_status say_open(const mt_newton_work *w, const mt_elimination *e, mt_arena *mem,
                          mt_err *err)
{
    int worst = 0;
    double gap = 0.0;
    for (int i = 0; i < w->p->m; i++) {
        if (!(fabs(w->c[i]) <= gap)) {
            gap = fabs(w->c[i]);
            worst = i;
        }
    }
    const mt_constraint_def *const c = &w->sys->constraints[worst];
    const mt_measure_kind kind = w->sys->measures[c->measure[0]].kind;
    const bool length = kind == MT_MEASURE_PLANE || kind == MT_MEASURE_DISTANCE;
    const char *const unit = length ? "m" : "(cosine or rad)";
    double *const null = mt_arena_f64(mem, (size_t)w->p->m, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int k = 0; k < e->m - e->qr.rank; k++) {
        MT_TRY(mt_eliminate_left_null(e, k, null, mem, err));
        if (fabs(null[worst]) > IN_THE_SET) {
            mt_joint_names names;
            MT_TRY(mt_name_joints(w->sys, w->p->m, null, mem, &names, err));
            return mt_fail(err, MT_E_ASSEMBLY,
                           "joints %s contradict each other: a gap of %.6g %s is left",
                           names.text, gap, unit);
        }
    }
    return mt_fail(err, MT_E_ASSEMBLY,
                   "the mechanism cannot be assembled: joint \"%s\" stays open by %.6g %s",
                   w->sys->joints[c->joint].name, gap, unit);
}

/* at: where the search ended; closed, where the stage began closed. */
static mt_status refuse_not_converged(mt_newton_work *w, const mt_placement *at, bool closed,
                                      mt_arena *mem, const mt_stage *stage, mt_err *err)
{
    mt_elimination e;
    mt_newton_solver solver;
    MT_TRY(mt_newton_dense(w, mem, err));
    memset(w->lambda, 0, (size_t)w->p->m * sizeof *w->lambda);
    mt_newton_evaluate(w, at, false);
    MT_TRY(mt_eliminate(w->sys, w->p->m, w->a, mem, &e, err));
    if (!closed && !(mt_newton_gap_of(w) <= MT_STEP_DONE)) {
        return say_open(w, &e, mem, err);
    }
    MT_TRY(mt_newton_linearise(w, at, mem, &solver, err));
    char where[WHERE_SIZE];
    mt_eliminate_project(&solver.e, w->g, w->reduced);
    mt_name_motion(w->sys, &solver.e, w->reduced, where, sizeof where);
    return mt_fail(err, MT_E_EQUILIBRIUM,
                   "no equilibrium found after %d iterations: %.3g of the forces at work stay "
                   "unbalanced on %s (free to move under load?)",
                   stage->iterations, w->residual, where);
}

/* What is kept of the better of two ends. */
typedef struct ending {
    bool done;
    bool saddle;
    double energy;
    double before; /* the energy where the stage began */
} ending;

/* end->saddle: the stationary point last evaluated is, with the drive held, a saddle from which
 * the way from the start leads down. That direction is stored in w->step. */
static mt_status check_for_saddle(mt_newton_work *w, const mt_placement *start,
                                  const mt_placement *at, const mt_stage *stage, ending *end,
                                  mt_arena *mem, mt_err *err)
{
    mt_elimination held;
    mt_newton_solver solver = stage->solver;
    const mt_elimination *e = &solver.e;
    end->saddle = false;
    if (!end->done) {
        return MT_OK;
    }
    end->energy = mt_energy_value(w->p->data, at, w->tau);
    if (solver.sparse && mt_saddle_convex(&solver.saddle)) {
        return MT_OK;
    }
    double *const way = mt_arena_f64(mem, (size_t)w->sys->nq, 1);
    MT_TRY(mt_arena_check(mem, err));
    if (solver.sparse) {
        const double tau = w->tau;
        MT_TRY(mt_newton_dense(w, mem, err));
        MT_TRY(mt_newton_linearise(w, at, mem, &solver, err));
        w->tau = tau;
    }
    if (w->p->trim) {
        MT_TRY(mt_eliminate(w->sys, w->p->m, w->a, mem, &held, err));
        e = &held;
    }
    mt_poses_increment(w->sys, start->pose, at->pose, way);
    return mt_newton_falls(w, e, way, &end->saddle, mem, err);
}

static mt_status copy_placement(const mt_newton_work *w, const mt_placement *at,
                                mt_placement *out, mt_arena *mem, mt_err *err)
{
    MT_TRY(mt_placement_init(out, w->sys, mem, err));
    mt_placement_copy(w->sys, at, out);
    return MT_OK;
}

/* Descend from `at`, and leave every saddle on the way. */
static mt_status descend_to_minimum(mt_newton_work *w, const mt_placement *start,
                                    mt_placement *at, mt_arena *mem, mt_stage *stage,
                                    ending *end, mt_err *err)
{
    bool on = true;
    mt_placement low;
    MT_TRY(mt_placement_init(&low, w->sys, mem, err));
    for (int i = 0; i < SADDLES && on; i++) {
        MT_TRY(mt_newton_descend(w, at, mem, err));
        mt_placement_copy(w->sys, at, &low);
        MT_TRY(attempt(w, at, mem, stage, &end->done, err));
        MT_TRY(check_for_saddle(w, start, at, stage, end, mem, err));
        on = end->saddle;
        if (on) {
            MT_TRY(mt_newton_leave_saddle(w, at, &on, mem, err));
        }
    }
    if (!end->done) {
        mt_placement_copy(w->sys, &low, at);
    }
    return MT_OK;
}

/* With trim: the stationary point with the joint locked is where the trimmed one begins. */
static mt_status lock_first(const mt_newton_work *w, mt_placement *at, mt_arena *mem,
                            mt_stage *stage, mt_err *err)
{
    mt_newton_problem locked = *w->p;
    mt_stage other = {.iterations = stage->iterations};
    mt_placement before;
    locked.trim = false;
    MT_TRY(copy_placement(w, at, &before, mem, err));
    const mt_status rc = mt_newton_solve(&locked, at, mem, &other, NULL);
    stage->iterations = other.iterations;
    if (rc != MT_OK) {
        mt_placement_copy(w->sys, &before, at);
    }
    return rc == MT_E_MEMORY ? mt_fail_memory(err) : MT_OK;
}

/* After plain Newton of a physical stage ended as `end`: accept its result, or descend from the
 * start. */
static mt_status accept_or_descend(mt_newton_work *w, const mt_placement *start,
                                   mt_placement *at, mt_arena *mem, mt_stage *stage,
                                   ending *end, mt_err *err)
{
    MT_TRY(check_for_saddle(w, start, at, stage, end, mem, err));
    const double rounding = ENERGY_ROUNDING * (fabs(end->before) + fabs(end->energy));
    const bool uphill = !w->p->trim && end->done && end->energy > end->before + rounding;
    const bool settled = !end->saddle && !uphill;
    if (end->done &&
        (settled || mt_poses_distance(w->sys, start->pose, at->pose) <= MT_DRAWN)) {
        return MT_OK;
    }
    const mt_stage first_stage = *stage;
    const bool found = end->done;
    mt_placement first;
    MT_TRY(copy_placement(w, at, &first, mem, err));
    w->watch = false;
    mt_placement_copy(w->sys, start, at);
    w->tau = 0.0;
    if (w->p->trim && found) {
        MT_TRY(lock_first(w, at, mem, stage, err));
        MT_TRY(attempt(w, at, mem, stage, &end->done, err));
    } else {
        MT_TRY(descend_to_minimum(w, start, at, mem, stage, end, err));
    }
    if (found && !end->done) { /* nothing lower holds it: the saddle stands, told as unstable */
        end->done = true;
        *stage = first_stage;
        mt_placement_copy(w->sys, &first, at);
    }
    return MT_OK;
}

mt_status mt_newton_solve(const mt_newton_problem *problem, mt_placement *at, mt_arena *mem,
                          mt_stage *stage, mt_err *err)
{
    mt_newton_work w;
    ending end = {.done = false};
    mt_placement start;
    MT_TRY(mt_newton_work_init(&w, problem, mem, err));
    MT_TRY(copy_placement(&w, at, &start, mem, err));
    const bool closed = mt_newton_gap_at(&w, at) <= MT_STEP_DONE;
    end.before = mt_energy_value(problem->data, at, 0.0);
    w.watch = problem->energy == MT_ENERGY_PHYSICAL && !problem->trim;
    MT_TRY(attempt(&w, at, mem, stage, &end.done, err));
    if (problem->energy == MT_ENERGY_PHYSICAL) {
        MT_TRY(accept_or_descend(&w, &start, at, mem, stage, &end, err));
    }
    stage->factors += w.factors;
    return end.done ? MT_OK : refuse_not_converged(&w, at, closed, mem, stage, err);
}

mt_status mt_newton_gap(const mt_newton_problem *problem, const mt_placement *at, mt_arena *mem,
                        double *gap_m, mt_err *err)
{
    const mt_system *const sys = problem->data->sys;
    mt_newton_work w = {.p = problem, .sys = sys};
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    w.c = mt_arena_f64(mem, (size_t)sys->n_constraints, 1);
    MT_TRY(mt_arena_check(mem, err));
    *gap_m = mt_newton_gap_at(&w, at) * sys->length_m;
    mt_arena_rewind(mem, mark);
    return MT_OK;
}
