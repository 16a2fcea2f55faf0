/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Continuation in the position s of the driven joint. At a closed position, with A the Jacobian
 * of all constraints and e_d the drive's row,
 *     v     = A^+ e_d                            the smallest motion that drives the joint
 *     dq/ds = v - Z (Z^T K Z)^+ Z^T K v          the one that strains the springs least (K:
 *                                                their elastic stiffness), so that what hangs
 *                                                on springs comes along, by
 *     [K A^T; A 0] [dq/ds; .] = [0; e_d]         where that is regular beyond doubt;
 * a step h goes to q (+) h dq/ds and is closed again by Newton from there (briefly: by the
 * smallest steps, where they converge as they should, newton_close.c). The correction is of
 * order h^2 on a smooth branch; where it is not small beside the step, or Newton does not
 * close the mechanism, or the equations turn over (branch.c), the step is halved, so that the
 * way never leaves its branch. Towards a
 * limit position (a toggle) s -> s*, |dq/ds| grows as (s* - s)^-1/2: no step closes beyond it,
 * and halving closes in on it geometrically.
 */
#include "mechanics/drive.h"

#include <math.h>
#include <string.h>

#include "base/run.h"
#include "mechanics/branch.h"
#include "mechanics/newton_step.h"
#include "mechanics/singular.h"

/* Longest step of the driven joint's coordinate [rad or model lengths], and of any body. */
static const double DRIVE_STEP = 0.1;
static const double BODY_STEP = 0.3;
/* A brief walk's steps grow from there as long as corrections stay below this part of them, and
 * it is seen that the equations do not turn over: a rotor behind gears turns far, and straight
 * along dq/ds. The most keeps the angle between two bodies below half a turn. */
static const double STRAIGHT = 0.02;
static const double DRIVE_STEP_MOST = 0.4;
static const double BODY_STEP_MOST = 1.2;
static const double GROWTH = 4.0;
/* A step is taken where the way back to the constraints is at most this part of it: on one
 * branch it is about h |q''| / (2 |q'|) of it, beside what a closure leaves to rounding. */
static const double CORRECTION = 0.3;
/* Links that miss being in line by so little [rad, model lengths] are in line: a drawing has
 * six digits of their lengths, whose square root this is. The way goes straight on there. */
static const double MEETING = 1e-3;
/* Gap [model lengths] that may be left where the walk only passes: far below the corrections
 * that tell a branch, and the next closure takes it away. */
static const double PASSING = 1e-6;
/* Steps shorter than this part of DRIVE_STEP are not tried, and none is left for the last: the
 * limit is then known to 1e-8 rad. */
static const double SHORTEST = 1e-7;
/* Rows of A dq/ds = e_d that fail by more than this say that the other joints hold the driven
 * one; at the shortest step before a limit the ratio is still below 1/this. */
static const double HELD = 1e-6;
/* Bodies that move this many times further than the driven joint (model lengths, rad): a limit
 * position is near. */
static const double LIMIT_RATIO = 100.0;

/* Steps of one walk: MT_DRIVE_REACH takes half of them, where no body moves three times as far
 * as the joint. */
enum { MOST_STEPS = 20000 };

typedef struct walk {
    const mt_system *sys;
    const mt_data *data;
    mt_placement *at; /* where it stands */
    bool brief;       /* closures by the smallest steps */
    double growth;    /* of the longest step */
    int iterations;
    mt_arena *mem;
    int row;        /* of the drive */
    double unit;    /* of the joint's coordinate: 1 rad, or the model length [m] */
    double goal;    /* position of the joint that is asked for */
    mt_pose *trial; /* [bodies] */
    mt_pose *guess; /* [bodies] */
    double *rate;   /* [nq] dq/ds */
    double *motion; /* [nq] */
    bool held;      /* by the other joints, where the walk stands */
    mt_branch branch;
    /* over a position where branches meet or nearly do: the first step that turned the
     * equations over, and where the last one that did ended */
    struct {
        bool known;
        double to;
        double turned;
        mt_pose *pose; /* [bodies] */
    } beyond;
    mt_lagrangian equations; /* of their gradients alone, where few enough are held */
    mt_err why;              /* what the last closure that failed said */
} walk;

static mt_status walk_init(walk *w, mt_err *err)
{
    const mt_system *const sys = w->sys;
    const size_t n = (size_t)sys->n_bodies;
    w->row = sys->drive_constraint;
    w->unit = sys->joints[sys->drive_joint].angle ? 1.0 : sys->length_m;
    w->goal = creal(mt_data_scalar(w->data, sys->drive, 0.0));
    w->trial = mt_arena_alloc(w->mem, n, sizeof *w->trial);
    w->guess = mt_arena_alloc(w->mem, n, sizeof *w->guess);
    w->beyond.pose = mt_arena_alloc(w->mem, n, sizeof *w->beyond.pose);
    w->rate = mt_arena_f64(w->mem, (size_t)sys->nq, 1);
    w->motion = mt_arena_f64(w->mem, (size_t)sys->nq, 1);
    MT_TRY(mt_branch_init(&w->branch, sys, sys->n_constraints, w->mem, err));
    if (w->branch.most > 0) {
        MT_TRY(mt_lagrangian_init(&w->equations, sys, false, w->mem, err));
    }
    return mt_arena_check(w->mem, err);
}

/* Largest |A rate - e_d| in rows scaled as the elimination does. */
static double misfit(const mt_elimination *e, const double *a, int row, const double *rate)
{
    double worst = 0.0;
    for (int i = 0; i < e->m; i++) {
        double s = i == row ? -1.0 : 0.0;
        for (ptrdiff_t j = 0; j < e->nq; j++) {
            s += a[i + (j * e->m)] * rate[j];
        }
        worst = fmax(worst, fabs(s) * (i == row ? 1.0 : e->dr[i] / e->dr[row]));
    }
    return worst;
}

/* work->v := v - Z (Z^T K Z)^+ Z^T K v. */
static mt_status relax(walk *w, mt_newton_work *work, const mt_elimination *e, mt_err *err)
{
    const int nq = e->nq;
    double *inverse = NULL;
    double *const eta = mt_arena_f64(w->mem, (size_t)e->n, 1);
    MT_TRY(mt_arena_check(w->mem, err));
    mt_lagrangian_eval(w->data, MT_ENERGY_PHYSICAL, w->at->pose, w->at, work->p->m, NULL,
                       MT_CURVATURE_ELASTIC, &work->l);
    MT_TRY(mt_newton_invert(work, e, w->mem, &inverse, err));
    mt_gemv(false, nq, nq, -1.0, work->h, nq, work->v, 0.0, work->g);
    mt_eliminate_project(e, work->g, work->reduced);
    mt_gemv(false, e->n, e->n, 1.0, inverse, e->n, work->reduced, 0.0, eta);
    mt_eliminate_expand(e, eta, work->step);
    mt_axpy(nq, 1.0, work->step, work->v);
    return MT_OK;
}

/* The first m equations at the current position. */
static mt_newton_problem problem_here(const walk *w, int m)
{
    return (mt_newton_problem){
        .data = w->data, .energy = MT_ENERGY_NONE, .m = m, .trim = false};
}

/* work->v := dq/ds, sparse; *sure: it is that. */
static mt_status relax_sparse(walk *w, mt_newton_work *work, bool *sure, mt_err *err)
{
    const int m = work->p->m;
    mt_saddle saddle;
    mt_lagrangian_eval(w->data, MT_ENERGY_PHYSICAL, w->at->pose, w->at, m, NULL,
                       MT_CURVATURE_ELASTIC, &work->sparse);
    MT_TRY(mt_saddle_factor(w->sys, m, &work->sparse, MT_SADDLE_REGULAR, work->sparse.h, w->mem,
                            &saddle, err));
    *sure = saddle.whole;
    if (*sure) {
        MT_TRY(mt_newton_is_firm(&saddle, w->mem, sure, err));
    }
    memset(work->c, 0, (size_t)m * sizeof *work->c);
    work->c[w->row] = 1.0;
    return *sure ? mt_saddle_solve(&saddle, NULL, work->c, work->v, NULL, w->mem, err) : MT_OK;
}

/* The gradients of all equations at a place. */
static const double *gradients(walk *w, const mt_placement *at)
{
    mt_lagrangian_eval(w->data, MT_ENERGY_NONE, NULL, at, w->sys->n_constraints, NULL,
                       MT_CURVATURE_NONE, &w->equations);
    return w->equations.a;
}

/* Set the branch to the current position. e: its elimination; NULL: the equations are
 * independent. */
static void stand(walk *w, const mt_elimination *e)
{
    if (w->branch.most > 0) {
        mt_branch_stand(&w->branch, w->sys->n_constraints, gradients(w, w->at), e);
    }
}

/* work->v := dq/ds in a basis of the freedoms, unless the other joints hold the driven one. */
static mt_status relax_dense(walk *w, mt_newton_work *work, mt_err *err)
{
    mt_elimination e;
    MT_TRY(mt_newton_dense(work, w->mem, err));
    mt_newton_evaluate(work, w->at, false);
    MT_TRY(mt_eliminate(w->sys, work->p->m, work->a, w->mem, &e, err));
    memset(work->c, 0, (size_t)work->p->m * sizeof *work->c);
    work->c[w->row] = 1.0;
    MT_TRY(mt_eliminate_particular(&e, work->c, work->v, w->mem, err));
    w->held = !(misfit(&e, work->a, w->row, work->v) <= HELD);
    stand(w, &e);
    return w->held ? MT_OK : relax(w, work, &e, err);
}

/* dq/ds at the current position, and its size in model lengths per unit of the coordinate.
 * Held: the old rate is kept. */
static mt_status find_rate(walk *w, double *size, mt_err *err)
{
    const mt_system *const sys = w->sys;
    const mt_arena_mark mark = mt_arena_get_mark(w->mem);
    const mt_newton_problem problem = problem_here(w, sys->n_constraints);
    mt_newton_work work;
    bool sure = false;
    MT_TRY(mt_newton_work_init(&work, &problem, w->mem, err));
    if (work.least != NULL) {
        MT_TRY(relax_sparse(w, &work, &sure, err));
    }
    w->held = false;
    if (sure) {
        stand(w, NULL);
    } else {
        MT_TRY(relax_dense(w, &work, err));
    }
    if (!w->held) {
        memcpy(w->rate, work.v, (size_t)sys->nq * sizeof *w->rate);
    }
    *size = mt_newton_scaled_norm(&work, w->rate) * w->unit;
    mt_arena_rewind(w->mem, mark);
    return MT_OK;
}

/* Close the mechanism with the joint at `to`, from the guess; *good: closed, and still on the
 * branch; *turned: closed, but the equations have turned over. */
static mt_status try_step(walk *w, double to, double length, bool *good, bool *turned,
                          mt_err *err)
{
    const mt_system *const sys = w->sys;
    const mt_arena_mark mark = mt_arena_get_mark(w->mem);
    mt_stage stage = {.active = false};
    mt_placement trial = {.pose = w->trial, .turn = w->at->turn, .drive = to};
    memcpy(w->trial, w->guess, (size_t)sys->n_bodies * sizeof *w->trial);
    const mt_newton_problem problem = {.data = w->data,
                                       .energy = MT_ENERGY_ANCHOR,
                                       .drawn = w->guess,
                                       .m = sys->n_constraints,
                                       .trim = false};
    bool closed = false;
    mt_status rc = MT_OK;
    if (w->brief) {
        rc = mt_newton_close(&problem, to == w->goal ? 0.0 : PASSING, &trial, &w->iterations,
                             &closed, w->mem, &w->why);
    }
    if (!closed && !mt_is_final(rc)) {
        memcpy(w->trial, w->guess, (size_t)sys->n_bodies * sizeof *w->trial);
        rc = mt_newton_solve(&problem, &trial, w->mem, &stage, &w->why);
    }
    w->iterations += stage.iterations;
    mt_arena_rewind(w->mem, mark);
    if (mt_is_final(rc)) {
        return mt_fail(err, rc, "%s", w->why.text);
    }
    *good = rc == MT_OK &&
            mt_poses_distance(sys, w->trial, w->guess) <= (CORRECTION * length) + MT_STEP_DONE;
    *turned = false;
    if (*good && w->branch.most > 0) {
        MT_TRY(mt_branch_kept(&w->branch, sys->n_constraints, gradients(w, &trial), good,
                              w->mem, err));
        *turned = !*good;
    }
    return MT_OK;
}

/* End of a step towards the goal, without a tiny last step. */
static double step_end(const walk *w, double step)
{
    const double way = w->goal - w->at->drive;
    const bool last = step >= fabs(way) - (SHORTEST * DRIVE_STEP * w->unit);
    return last ? w->goal : w->at->drive + copysign(step, way);
}

static void take_drive_position(walk *w, const mt_pose *poses, double to)
{
    memcpy(w->at->pose, poses, (size_t)w->sys->n_bodies * sizeof *poses);
    mt_data_turns(w->data, w->at);
    w->at->drive = to;
    if (fabs(w->goal - to) <= fabs(w->goal - w->beyond.to)) {
        w->beyond.known = false; /* passed on the branch */
    }
}

/* The step to `to` has turned the equations over, w->trial is where it ended. */
static void note_turned(walk *w, double to)
{
    w->beyond.turned = to;
    if (!w->beyond.known) {
        w->beyond.known = true;
        w->beyond.to = to;
        memcpy(w->beyond.pose, w->trial, (size_t)w->sys->n_bodies * sizeof *w->trial);
    }
}

/* Where branches meet only a long step passes, and both sides look like one straight line: the
 * first step that passed is taken. */
static void go_straight(walk *w)
{
    take_drive_position(w, w->beyond.pose, w->beyond.to);
}

/* After a step whose correction was this part of it. */
static double next_growth(const walk *w, double part)
{
    const double most = DRIVE_STEP_MOST / DRIVE_STEP;
    const bool straight = w->brief && w->branch.most > 0 && part <= STRAIGHT;
    const double by = part > 0.0 ? fmin(STRAIGHT / part, GROWTH) : GROWTH;
    return straight ? fmin(w->growth * by, most) : 1.0;
}

/* One step of at most *h towards the goal, halved until it succeeds. *h: the next step to try;
 * 0: no step succeeds. */
static mt_status advance(walk *w, double *h, mt_err *err)
{
    const mt_system *const sys = w->sys;
    const double way = w->goal - w->at->drive;
    double size = 0.0;
    bool good = false;
    MT_TRY(find_rate(w, &size, err));
    if (!(size > 0.0)) { /* held from the start: there is no way to go */
        *h = 0.0;
        return MT_OK;
    }
    const double body = fmin(w->growth * BODY_STEP, BODY_STEP_MOST);
    double step = fmin(fmin(*h, fabs(way)), body * w->unit / size);
    *h = 0.0; /* also where bodies move so far that no step is long enough to be tried */
    while (!good && step >= fmin(SHORTEST * DRIVE_STEP * w->unit, fabs(way))) {
        bool turned = false;
        const double to = step_end(w, step);
        for (int j = 0; j < sys->nq; j++) {
            w->motion[j] = (to - w->at->drive) * w->rate[j];
        }
        memcpy(w->guess, w->at->pose, (size_t)sys->n_bodies * sizeof *w->guess);
        mt_poses_move(sys, w->guess, w->motion);
        MT_TRY(try_step(w, to, step * size / w->unit, &good, &turned, err));
        if (turned) {
            note_turned(w, to);
        }
        if (!good && w->beyond.known &&
            fabs(w->beyond.turned - w->at->drive) <= 2.0 * MEETING * w->unit) {
            go_straight(w);
            *h = step;
            break;
        }
        const double part =
            mt_poses_distance(sys, w->trial, w->guess) * w->unit / (step * size);
        w->growth = good ? next_growth(w, part) : 1.0;
        *h = good ? fmax(2.0, w->growth) * step : 0.0;
        step = good ? step : 0.5 * step;
        if (good) {
            take_drive_position(w, w->trial, to);
        }
    }
    *h = fmin(*h, fmin(w->growth * DRIVE_STEP, DRIVE_STEP_MOST) * w->unit);
    return MT_OK;
}

/* The joint that turns or slides furthest along dq/ds, other than the driven one; -1: none. */
static int fastest_joint(const walk *w, double *ratio)
{
    const mt_system *const sys = w->sys;
    int best = -1;
    double most = 0.0;
    for (int i = 0; i < sys->n_joints; i++) {
        const mt_system_joint *const joint = &sys->joints[i];
        if (joint->coordinate < 0 || i == sys->drive_joint) {
            continue;
        }
        const double rate = mt_drive_rate(w->data, joint->coordinate, w->at->pose, w->rate);
        const double scaled = fabs(rate) / (joint->angle ? 1.0 : sys->length_m);
        if (scaled > most) {
            most = scaled;
            best = i;
            *ratio = rate;
        }
    }
    return best;
}

static mt_status refuse_drive_position(walk *w, mt_err *err)
{
    const mt_system *const sys = w->sys;
    const mt_system_joint *const joint = &sys->joints[sys->drive_joint];
    const char *const unit = joint->angle ? "rad" : "m";
    double size = 0.0;
    double ratio = 0.0;
    MT_TRY(find_rate(w, &size, err));
    if (!(size > 0.0)) {
        return mt_fail(err, MT_E_ASSEMBLY,
                       "joint \"%s\" cannot be driven: the other joints hold it where it is "
                       "(or it stands at a limit position)",
                       joint->name);
    }
    const int fast = fastest_joint(w, &ratio);
    if (w->held || size >= LIMIT_RATIO) {
        return fast < 0 ? mt_fail(err, MT_E_ASSEMBLY,
                                  "joint \"%s\" cannot be driven beyond %.6g %s: limit "
                                  "position, where the mechanism moves without it",
                                  joint->name, w->at->drive, unit)
                        : mt_fail(err, MT_E_ASSEMBLY,
                                  "joint \"%s\" cannot be driven beyond %.6g %s: limit "
                                  "position, where joint \"%s\" moves without it (%.2g %s per "
                                  "%s just before)",
                                  joint->name, w->at->drive, unit, sys->joints[fast].name,
                                  ratio, sys->joints[fast].angle ? "rad" : "m", unit);
    }
    return mt_fail(err, MT_E_ASSEMBLY, "joint \"%s\" cannot be driven beyond %.6g %s: %s",
                   joint->name, w->at->drive, unit,
                   w->why.text[0] != '\0' ? w->why.text
                                          : "singular position, where the motion can branch");
}

/* From a dead centre of the other joints several ways lead on. */
static mt_status refuse_dead_centre(walk *w, mt_err *err)
{
    const mt_system *const sys = w->sys;
    const mt_arena_mark mark = mt_arena_get_mark(w->mem);
    const mt_newton_problem problem = problem_here(w, sys->n_constraints - 1);
    mt_newton_work work;
    mt_elimination e;
    mt_saddle least;
    bool apart = false;
    MT_TRY(mt_newton_work_init(&work, &problem, w->mem, err));
    if (work.least != NULL) {
        mt_lagrangian_eval(w->data, MT_ENERGY_PHYSICAL, w->at->pose, w->at, problem.m, NULL,
                           MT_CURVATURE_NONE, &work.sparse);
        MT_TRY(mt_newton_least_squares(&work, true, w->mem, &least, &apart, err));
    }
    if (apart) {
        mt_arena_rewind(w->mem, mark);
        return MT_OK;
    }
    MT_TRY(mt_newton_dense(&work, w->mem, err));
    mt_newton_evaluate(&work, w->at, false);
    MT_TRY(mt_eliminate(w->sys, problem.m, work.a, w->mem, &e, err));
    const mt_status rc = mt_singular_refuse(w->data, w->at, &e, w->mem, err);
    MT_TRY(mt_err_in(err, rc, "the position that it is driven from"));
    mt_arena_rewind(w->mem, mark);
    return MT_OK;
}

double mt_drive_reach(const mt_system *sys, int joint)
{
    return MT_DRIVE_REACH * (sys->joints[joint].angle ? 1.0 : sys->length_m);
}

/* Bodies that move much further than the joint make steps short. */
static mt_status refuse_steps(const walk *w, mt_err *err)
{
    const mt_system *const sys = w->sys;
    const mt_system_joint *const joint = &sys->joints[sys->drive_joint];
    return mt_fail(err, MT_E_ASSEMBLY,
                   "joint \"%s\" reached %g %s in %d steps, not %g %s: other parts would have "
                   "to move too far",
                   joint->name, w->at->drive, joint->angle ? "rad" : "m", (int)MOST_STEPS,
                   w->goal, joint->angle ? "rad" : "m");
}

static mt_status refuse_far(const walk *w, mt_err *err)
{
    const mt_system *const sys = w->sys;
    const mt_system_joint *const joint = &sys->joints[sys->drive_joint];
    return mt_fail(err, MT_E_ASSEMBLY,
                   "joint \"%s\" cannot be driven to %g %s: at most %g %s from the reference "
                   "position",
                   joint->name, w->goal, joint->angle ? "rad" : "m",
                   mt_drive_reach(sys, sys->drive_joint), joint->angle ? "rad" : "m");
}

mt_status mt_drive_solve(const mt_data *data, bool brief, mt_placement *at, int *iterations,
                         mt_arena *mem, mt_err *err)
{
    walk w = {
        .sys = data->sys, .data = data, .at = at, .brief = brief, .growth = 1.0, .mem = mem};
    MT_TRY(walk_init(&w, err));
    if (!(fabs(w.goal) <= mt_drive_reach(w.sys, w.sys->drive_joint))) {
        return refuse_far(&w, err);
    }
    if (at->drive != w.goal && at->drive == 0.0) {
        MT_TRY(refuse_dead_centre(&w, err));
    }
    double h = DRIVE_STEP * w.unit;
    int steps = 0;
    for (; at->drive != w.goal && h > 0.0 && steps < MOST_STEPS; steps++) {
        MT_TRY(mt_interrupt_check(w.sys->run->interrupt, err));
        MT_TRY(advance(&w, &h, err));
    }
    *iterations += w.iterations;
    return at->drive == w.goal ? MT_OK
           : h > 0.0           ? refuse_steps(&w, err)
                               : refuse_drive_position(&w, err);
}

mt_status mt_drive_motion(const mt_data *data, mt_placement *at, double *rate, double *size,
                          bool *held, mt_arena *mem, mt_err *err)
{
    walk w = {.sys = data->sys, .data = data, .at = at, .growth = 1.0, .mem = mem};
    MT_TRY(walk_init(&w, err));
    MT_TRY(find_rate(&w, size, err));
    memcpy(rate, w.rate, (size_t)w.sys->nq * sizeof *rate);
    *held = w.held;
    return MT_OK;
}

double mt_drive_rate(const mt_data *data, int measure, const mt_pose *poses, const double *rate)
{
    const mt_measure_def *const def = &data->sys->measures[measure];
    const mt_measure_data m = mt_data_measure(data, def);
    mt_jet jet;
    mt_measure_eval(&m, mt_pose_of(poses, def->body[0]), mt_pose_of(poses, def->body[1]), false,
                    NULL, &jet);
    return mt_jet_along(data->sys, def->body, &jet, rate);
}
