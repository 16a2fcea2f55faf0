/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reference, driven position and equilibrium, and their derivatives. */
#include "mechanics/position.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/format.h"
#include "base/number.h"
#include "base/run.h"
#include "base/text.h"
#include "linalg/dense.h"
#include "mechanics/newton.h"
#include "mechanics/singular.h"

/*
 * Derivative of a stage's solution (q, lambda, tau) with respect to one input, by the implicit
 * function theorem. With d the motion that the input causes already (drawn positions, earlier
 * stages) and a dot the derivative along (input, d) at fixed lambda and tau:
 *     v = -A^+ c.,   K eta = -Z^T ((grad L). + H v),   q' = d + v + Z eta,
 *         A^T lambda' = -(grad L). - H (v + Z eta) - t tau',
 * K the reduced Hessian of newton.c with the border of the trimmed springs. The chart moves
 * with the position; that adds nothing, because grad L = 0 there.
 */

/* (grad L). into w->g and -c. into w->c. */
static mt_status differentiate(mt_newton_work *w, const mt_placement *at, const mt_stage *stage,
                               const double *d, mt_arena *scratch, mt_err *err)
{
    const int m = w->p->m;
    mt_lagrangian *const l = stage->solver.sparse ? &w->sparse : &w->l;
    mt_placement moved = *at;
    moved.pose = mt_arena_alloc(scratch, (size_t)w->sys->n_bodies, sizeof *moved.pose);
    MT_TRY(mt_arena_check(scratch, err));
    mt_poses_tangent(w->sys, at->pose, d, moved.pose);
    l->slope = true;
    l->trim_force = stage->trim_force;
    mt_lagrangian_eval(w->p->data, w->p->energy, w->p->drawn, &moved, m, NULL,
                       MT_CURVATURE_NONE, l);
    for (int i = 0; i < m && l->row != NULL; i++) {
        for (int k = 0; k < l->row[i].n; k++) {
            w->g[l->row[i].dof[k]] += l->row[i].a[k] * stage->lambda[i];
        }
    }
    if (l->a != NULL) {
        mt_gemv(true, m, w->sys->nq, 1.0, l->a, m, stage->lambda, 1.0, w->g);
    }
    for (int i = 0; i < m; i++) {
        w->c[i] = -w->c[i];
    }
    return MT_OK;
}

/* d += v + Z eta; d_lambda [m] and d_trim follow. */
static mt_status respond(mt_newton_work *w, const mt_stage *stage, double *d, double *d_lambda,
                         mt_trim_forces *d_trim, mt_arena *scratch, mt_err *err)
{
    const int nq = w->sys->nq;
    const ptrdiff_t m = w->p->m;
    const mt_elimination *const e = &stage->solver.e;
    const int trims = mt_newton_trims(w->p);
    const int order = e->n + trims;
    double *const eta = mt_arena_f64(scratch, (size_t)order + 1, 1);
    MT_TRY(mt_arena_check(scratch, err));
    MT_TRY(mt_eliminate_particular(e, w->c, w->v, scratch, err));
    mt_gemv(false, nq, nq, 1.0, stage->h, nq, w->v, 1.0, w->g);
    mt_eliminate_project(e, w->g, w->reduced);
    for (int i = 0; i < e->n; i++) {
        w->reduced[i] = -w->reduced[i];
    }
    for (ptrdiff_t t = 0; t < trims; t++) {
        const ptrdiff_t at = m - trims + t;
        double row = w->c[at];
        for (int j = 0; j < nq; j++) {
            row -= stage->a[at + (j * m)] * w->v[j];
        }
        w->reduced[e->n + t] = row;
    }
    mt_gemv(false, order, order, 1.0, stage->solver.inverse, order, w->reduced, 0.0, eta);
    mt_eliminate_expand(e, eta, w->step);
    mt_gemv(false, nq, nq, 1.0, stage->h, nq, w->step, 1.0, w->g);
    for (ptrdiff_t t = 0; t < trims; t++) {
        d_trim->of[t] = eta[e->n + t];
        mt_axpy(nq, eta[e->n + t], stage->trim + (t * nq), w->g);
    }
    for (int j = 0; j < nq; j++) {
        w->g[j] = -w->g[j];
    }
    mt_axpy(nq, 1.0, w->v, d);
    mt_axpy(nq, 1.0, w->step, d);
    return mt_eliminate_multipliers(e, w->g, d_lambda, scratch, err);
}

/* The same at once: H x + A^T lambda' + t tau' = -(grad L)., A x = -c. */
static mt_status respond_sparse(mt_newton_work *w, const mt_stage *stage, double *d,
                                double *d_lambda, mt_trim_forces *d_trim, mt_arena *scratch,
                                mt_err *err)
{
    const int nq = w->sys->nq;
    const mt_newton_solver *const solver = &stage->solver;
    for (int j = 0; j < nq; j++) {
        w->g[j] = -w->g[j];
    }
    MT_TRY(mt_newton_trims(w->p) > 0
               ? mt_border_solve(&solver->border, w->g, w->c, w->step, d_lambda, d_trim->of,
                                 scratch, err)
               : mt_saddle_solve(&solver->saddle, w->g, w->c, w->step, d_lambda, scratch, err));
    mt_axpy(nq, 1.0, w->step, d);
    return MT_OK;
}

/* Derivative of a solved stage by data->input: d[nq] (in: the motion of earlier stages, out: of
 * the solution); sets d_lambda and d_trim_force for the physical energy. No effect where the
 * stage did not run. */
static mt_status newton_tangent(const mt_newton_problem *problem, const mt_placement *at,
                                mt_stage *stage, double *d, mt_arena *scratch, mt_err *err)
{
    if (!stage->active) {
        return MT_OK;
    }
    mt_newton_work w;
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    MT_TRY(mt_newton_work_init(&w, problem, scratch, err));
    double *const d_lambda = mt_arena_f64(scratch, (size_t)problem->m, 1);
    mt_trim_forces d_trim = {{0.0}};
    if (!stage->solver.sparse) {
        MT_TRY(mt_newton_dense(&w, scratch, err));
    }
    MT_TRY(mt_arena_check(scratch, err));
    MT_TRY(differentiate(&w, at, stage, d, scratch, err));
    MT_TRY(stage->solver.sparse ? respond_sparse(&w, stage, d, d_lambda, &d_trim, scratch, err)
                                : respond(&w, stage, d, d_lambda, &d_trim, scratch, err));
    if (problem->energy == MT_ENERGY_PHYSICAL) {
        memcpy(stage->d_lambda, d_lambda, (size_t)problem->m * sizeof *d_lambda);
        stage->d_trim_force = d_trim;
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}

/*
 * Back to the constraints by the smallest steps, and nothing else: with c and A at q
 *     v = -A^+ c,      q <- q (+) v,
 * which converges quadratically where A has full rank. The end is next to the start to first
 * order, and no multiplier, no curvature and no second factor is needed: a third of the work of
 * a step of newton.c.
 */

/* Beside a regular position the second step is rounding already. */
enum { CLOSE_LIMIT = 8 };
/* Each step leaves at most this part of the gap: towards a dead centre it leaves a quarter. */
static const double CONTRACTION = 0.1;
/* A gap of that many eps is none, model lengths. */
static const double NO_GAP = 8.0;

/* Evaluate w->c and the Jacobian for a step. */
static mt_status evaluate_constraints(mt_newton_work *w, const mt_placement *at, bool dense,
                                      mt_arena *mem, mt_err *err)
{
    if (dense) {
        MT_TRY(mt_newton_dense(w, mem, err));
    }
    mt_lagrangian_eval(w->p->data, MT_ENERGY_NONE, NULL, at, w->p->m, NULL, MT_CURVATURE_NONE,
                       dense ? &w->l : &w->sparse);
    return MT_OK;
}

/* w->step := -A^+ c. Sparse, *sure: no equation depends on others; dense, where some do: the
 * step of the independent ones, which closes all where they agree. */
static mt_status step_back(mt_newton_work *w, bool dense, mt_arena *mem, bool *sure,
                           mt_err *err)
{
    for (int i = 0; i < w->p->m; i++) {
        w->turn[i] = -w->c[i];
    }
    if (dense) {
        mt_elimination e;
        *sure = true;
        MT_TRY(mt_eliminate_factor(w->sys, w->p->m, w->a, mem, &e, err));
        return mt_eliminate_particular(&e, w->turn, w->step, mem, err);
    }
    mt_saddle least;
    MT_TRY(mt_newton_least_squares(w, false, mem, &least, sure, err));
    return *sure ? mt_saddle_solve(&least, NULL, w->turn, w->step, NULL, mem, err) : MT_OK;
}

mt_status mt_newton_close(const mt_newton_problem *problem, double enough, mt_placement *at,
                          int *iterations, bool *closed, mt_arena *mem, mt_err *err)
{
    mt_newton_work w;
    double before = HUGE_VAL;
    *closed = false;
    MT_TRY(mt_newton_work_init(&w, problem, mem, err));
    bool dense = w.least == NULL;
    w.turn = mt_arena_f64(mem, (size_t)problem->m, 1);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(evaluate_constraints(&w, at, dense, mem, err));
    for (int it = 0; it < CLOSE_LIMIT; it++) {
        const double gap = mt_newton_gap_of(&w);
        const bool shrinks = gap <= CONTRACTION * before;
        *closed = gap <= fmax(enough, NO_GAP * DBL_EPSILON) ||
                  (gap <= MT_STEP_DONE && before <= MT_STEP_DONE && !shrinks);
        if (*closed || !(shrinks || gap <= MT_STEP_DONE)) {
            return MT_OK;
        }
        const mt_arena_mark mark = mt_arena_get_mark(mem);
        bool sure = false;
        MT_TRY(step_back(&w, dense, mem, &sure, err));
        mt_arena_rewind(mem, mark);
        if (!sure) {
            dense = true;
            MT_TRY(evaluate_constraints(&w, at, dense, mem, err));
            MT_TRY(step_back(&w, dense, mem, &sure, err));
        }
        ++*iterations;
        w.moved = mt_newton_scaled_norm(&w, w.step);
        if (!(w.moved <= MT_STEP_LIMIT)) {
            return MT_OK;
        }
        mt_newton_take_step(&w, at, MT_STEP_LIMIT);
        MT_TRY(evaluate_constraints(&w, at, dense, mem, err));
        before = gap;
    }
    return MT_OK;
}

/*
 * With A the gradients of independent equations (all that the joints hold, the walk's own
 * included), the set of positions that they allow is smooth where A has full rank, and on a
 * short step within one branch
 *     det(A_1 C^2 A_0^T) > 0,      C: rotations as arcs of the model length,
 * as it is at A_1 = A_0 and changes sign only where A_1 loses rank beside A_0. A step that
 * jumps over a position where branches meet, or nearly meet (links of a loop in line), ends in
 * the other assembly with the other sign, and its correction may be as small as that of a good
 * one: both branches look like the one straight line across.
 */

/* O(n^3) for each step of a walk: below a millisecond. */
enum { EQUATIONS_MOST = 150 };

mt_status mt_branch_init(mt_branch *b, const mt_system *sys, int m, mt_arena *mem, mt_err *err)
{
    *b = (mt_branch){.sys = sys, .most = m <= EQUATIONS_MOST ? m : 0};
    const size_t n = (size_t)b->most;
    b->row = mt_arena_alloc(mem, n, sizeof *b->row);
    b->a = mt_arena_f64(mem, n, (size_t)sys->nq);
    b->to = mt_arena_f64(mem, n, (size_t)sys->nq);
    b->b = mt_arena_f64(mem, n, n);
    return mt_arena_check(mem, err);
}

/* The rows of `a` that count, rotations as arcs, each of length 1. */
static void take_rows(const mt_branch *b, int m, const double *a, double *out)
{
    for (int body = 0; body < b->sys->n_bodies; body++) {
        for (int k = 0; k < 6; k++) {
            const ptrdiff_t j = b->sys->bodies[body].dof[k];
            const double arc = k < 3 ? 1.0 : 1.0 / b->sys->length_m;
            for (ptrdiff_t i = 0; j >= 0 && i < b->n; i++) {
                out[i + (j * b->n)] = a[b->row[i] + (j * m)] * arc;
            }
        }
    }
    for (ptrdiff_t i = 0; i < b->n; i++) {
        double square = 0.0;
        for (ptrdiff_t j = 0; j < b->sys->nq; j++) {
            square += out[i + (j * b->n)] * out[i + (j * b->n)];
        }
        for (ptrdiff_t j = 0; j < b->sys->nq && square > 0.0; j++) {
            out[i + (j * b->n)] /= sqrt(square);
        }
    }
}

void mt_branch_stand(mt_branch *b, int m, const double *a, const mt_elimination *e)
{
    b->n = b->most == 0 ? 0 : e == NULL ? m : e->qr.rank;
    for (int i = 0; i < b->n; i++) {
        b->row[i] = e == NULL ? i : e->qr.perm[i];
    }
    take_rows(b, m, a, b->a);
}

mt_status mt_branch_kept(mt_branch *b, int m, const double *a, bool *kept, mt_arena *scratch,
                         mt_err *err)
{
    int sign = 1;
    take_rows(b, m, a, b->to);
    mt_gemm(false, true, b->n, b->n, b->sys->nq, 1.0, b->to, b->n, b->a, b->n, 0.0, b->b, b->n);
    MT_TRY(mt_lu_sign(b->n, b->b, &sign, scratch, err));
    *kept = sign > 0;
    return MT_OK;
}

/*
 * Continuation in the position s of the driven joint. Several joints are driven together, each
 * in proportion, on the straight line between their positions: s is then that of the leading
 * one, which has the longest way, and e_d has the part of each in its row. At a closed
 * position, with A the Jacobian of all constraints and e_d the drive's row,
 *     v     = A^+ e_d                            the smallest motion that drives the joint
 *     dq/ds = v - Z (Z^T K Z)^+ Z^T K v          the one that strains the springs least (K:
 *                                                their elastic stiffness), so that what hangs
 *                                                on springs comes along, by
 *     [K A^T; A 0] [dq/ds; .] = [0; e_d]         where that is regular beyond doubt;
 * a step h goes to q (+) h dq/ds and is closed again by Newton from there (briefly: by the
 * smallest steps, where they converge as they should). The correction is of
 * order h^2 on a smooth branch; where it is not small beside the step, or Newton does not
 * close the mechanism, or the equations turn over, the step is halved, so that the
 * way never leaves its branch. Towards a
 * limit position (a toggle) s -> s*, |dq/ds| grows as (s* - s)^-1/2: no step closes beyond it,
 * and halving closes in on it geometrically.
 */

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
    int lead;    /* of the drives */
    int row;     /* of its constraint */
    double unit; /* of its coordinate: 1 rad, or the model length [m] */
    double goal; /* position of it that is asked for */
    double from; /* where it stood */
    struct {     /* of all drives, in their order */
        double from;
        double goal;
        double part; /* motion per motion of the leading one */
    } drive[MT_DRIVES_MOST];
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

/* 1 rad, or the model length [m]. */
static double drive_unit(const mt_system *sys, int drive)
{
    return sys->joints[sys->drives[drive].joint].angle ? 1.0 : sys->length_m;
}

/* Sets out from the current position; lead: of the drives, -1: the one with the longest way. */
static void set_out(walk *w, int lead)
{
    const mt_system *const sys = w->sys;
    double longest = -1.0;
    w->lead = lead < 0 ? 0 : lead;
    for (int i = 0; i < sys->n_drives; i++) {
        w->drive[i].from = w->at->drive[i];
        w->drive[i].goal = creal(mt_data_scalar(w->data, sys->drives[i].position, 0.0));
        const double way = fabs(w->drive[i].goal - w->drive[i].from) / drive_unit(sys, i);
        if (lead < 0 && !(way <= longest)) {
            longest = way;
            w->lead = i;
        }
    }
    w->row = sys->drives[w->lead].constraint;
    w->unit = drive_unit(sys, w->lead);
    w->goal = w->drive[w->lead].goal;
    w->from = w->drive[w->lead].from;
    for (int i = 0; i < sys->n_drives; i++) {
        const double way = w->drive[i].goal - w->drive[i].from;
        const bool moves = lead < 0 && way != 0.0; /* then the leading one does */
        w->drive[i].part = i == w->lead ? 1.0 : moves ? way / (w->goal - w->from) : 0.0;
    }
}

/* out := positions of all drives, the leading one at s. */
static void drives_at(const walk *w, double s, double *out)
{
    for (int i = 0; i < w->sys->n_drives; i++) {
        out[i] = i == w->lead   ? s
                 : s == w->goal ? w->drive[i].goal
                                : w->drive[i].from + (w->drive[i].part * (s - w->from));
    }
}

/* Where the leading one stands. */
static double stands_at(const walk *w)
{
    return w->at->drive[w->lead];
}

/* e_d [constraints] */
static void set_drive_rows(const walk *w, double *c)
{
    memset(c, 0, (size_t)w->sys->n_constraints * sizeof *c);
    for (int i = 0; i < w->sys->n_drives; i++) {
        c[w->sys->drives[i].constraint] = w->drive[i].part;
    }
}

static mt_status walk_init(walk *w, int lead, mt_err *err)
{
    const mt_system *const sys = w->sys;
    const size_t n = (size_t)sys->n_bodies;
    set_out(w, lead);
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

/* Largest |A rate - e_d| in rows scaled as the elimination does; c: e_d, row: the leading
 * one. */
static double misfit(const mt_elimination *e, const double *a, const double *c, int row,
                     const double *rate)
{
    double worst = 0.0;
    for (int i = 0; i < e->m; i++) {
        double s = -c[i];
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
    set_drive_rows(w, work->c);
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
    set_drive_rows(w, work->c);
    MT_TRY(mt_eliminate_particular(&e, work->c, work->v, w->mem, err));
    w->held = !(misfit(&e, work->a, work->c, w->row, work->v) <= HELD);
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
    mt_placement trial = {.pose = w->trial, .turn = w->at->turn};
    drives_at(w, to, trial.drive);
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
    const double way = w->goal - stands_at(w);
    const bool last = step >= fabs(way) - (SHORTEST * DRIVE_STEP * w->unit);
    return last ? w->goal : stands_at(w) + copysign(step, way);
}

static void take_drive_position(walk *w, const mt_pose *poses, double to)
{
    memcpy(w->at->pose, poses, (size_t)w->sys->n_bodies * sizeof *poses);
    mt_data_turns(w->data, w->at);
    drives_at(w, to, w->at->drive);
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
    const double way = w->goal - stands_at(w);
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
            w->motion[j] = (to - stands_at(w)) * w->rate[j];
        }
        memcpy(w->guess, w->at->pose, (size_t)sys->n_bodies * sizeof *w->guess);
        mt_poses_move(sys, w->guess, w->motion);
        MT_TRY(try_step(w, to, step * size / w->unit, &good, &turned, err));
        if (turned) {
            note_turned(w, to);
        }
        if (!good && w->beyond.known &&
            fabs(w->beyond.turned - stands_at(w)) <= 2.0 * MEETING * w->unit) {
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

/* The joint that turns or slides furthest along dq/ds, other than driven ones; -1: none. */
static int fastest_joint(const walk *w, double *ratio)
{
    const mt_system *const sys = w->sys;
    int best = -1;
    double most = 0.0;
    for (int i = 0; i < sys->n_joints; i++) {
        const mt_system_joint *const joint = &sys->joints[i];
        if (joint->coordinate < 0 || mt_system_drive_of(sys, i) >= 0) {
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

static const char *drive_unit_name(const mt_system *sys, int drive)
{
    return sys->joints[sys->drives[drive].joint].angle ? "rad" : "m";
}

enum { PLACE_SIZE = 320 };

/* joint "a", or joints "a", "b" where several are on their way. */
static const char *name_driven(const walk *w)
{
    const mt_system *const sys = w->sys;
    const char *out = "";
    int n = 0;
    for (int i = 0; i < sys->n_drives; i++) {
        n += w->drive[i].part != 0.0 ? 1 : 0;
    }
    for (int i = 0, told = 0; i < sys->n_drives; i++) {
        if (w->drive[i].part != 0.0) {
            const char *const before = told++ > 0 ? ", " : n > 1 ? "joints " : "joint ";
            out = mt_arena_printf(w->mem, "%s%s\"%s\"", out, before,
                                  sys->joints[sys->drives[i].joint].name);
        }
    }
    return out;
}

/* Where they stand, or the positions asked for. */
static const char *name_positions(const walk *w, bool goal)
{
    const char *out = "";
    for (int i = 0; i < w->sys->n_drives; i++) {
        if (w->drive[i].part != 0.0) {
            out = mt_arena_printf(
                w->mem, goal ? "%s%s%g %s" : "%s%s%.6g %s", out, out[0] != '\0' ? ", " : "",
                goal ? w->drive[i].goal : w->at->drive[i], drive_unit_name(w->sys, i));
        }
    }
    return out;
}

static mt_status refuse_drive_position(walk *w, mt_err *err)
{
    const mt_system *const sys = w->sys;
    const char *const which = name_driven(w);
    const char *const where = name_positions(w, false);
    double size = 0.0;
    double ratio = 0.0;
    MT_TRY(mt_arena_check(w->mem, err));
    MT_TRY(find_rate(w, &size, err));
    if (!(size > 0.0)) {
        return mt_fail(
            err, MT_E_ASSEMBLY,
            "%s cannot be driven: the other joints hold it where it is (or it stands "
            "at a limit position)",
            which);
    }
    const int fast = fastest_joint(w, &ratio);
    if (w->held || size >= LIMIT_RATIO) {
        return fast < 0 ? mt_fail(err, MT_E_ASSEMBLY,
                                  "%s cannot be driven beyond %s: limit position, where the "
                                  "mechanism moves without it",
                                  which, where)
                        : mt_fail(err, MT_E_ASSEMBLY,
                                  "%s cannot be driven beyond %s: limit position, where joint "
                                  "\"%s\" moves without it (%.2g %s per %s just before)",
                                  which, where, sys->joints[fast].name, ratio,
                                  sys->joints[fast].angle ? "rad" : "m",
                                  drive_unit_name(sys, w->lead));
    }
    return mt_fail(err, MT_E_ASSEMBLY, "%s cannot be driven beyond %s: %s", which, where,
                   w->why.text[0] != '\0' ? w->why.text
                                          : "singular position, where the motion can branch");
}

/* " (file:line:column)" of an address of the model's file, or "". */
static void name_place(const mt_model *m, mt_addr addr, char *out, size_t size)
{
    int line = 0;
    int column = 0;
    out[0] = '\0';
    if (m->path != NULL && mt_model_locate(m, addr, &line, &column)) {
        (void)mt_snprintf(out, size, " (%s:%d:%d)", mt_text_base_name(m->path), line, column);
    }
}

/* The configuration's own drive of this joint; NULL: none. */
static const mt_drive *own_drive(const mt_system *sys, const char *joint)
{
    const mt_configuration *const c = &sys->model->configurations[sys->configuration];
    for (int i = 0; i < c->n_drives; i++) {
        if (strcmp(c->drives[i].joint_name.s, joint) == 0) {
            return &c->drives[i];
        }
    }
    return NULL;
}

/* Entries of the combination of other equations that a drive's equation is, its largest 1,
 * below this are rounding. */
static const double IN_THE_SET = 1e-6;

/*
 * Drive d has an equation a_d that those of the joints and of the drives before it already
 * contain: a_d = A^T w. Where w has a part in the rows of other drives, these drive the same
 * freedom.
 */
static mt_status refuse_dependent_drive(const walk *w, const mt_elimination *e, int d,
                                        const double *gradient, mt_err *err)
{
    const mt_system *const sys = w->sys;
    const char *const joint = sys->joints[sys->drives[d].joint].name;
    double *const weight = mt_arena_f64(w->mem, (size_t)e->m, 1);
    MT_TRY(mt_arena_check(w->mem, err));
    MT_TRY(mt_eliminate_multipliers(e, gradient, weight, w->mem, err));
    const double most = mt_max_abs(e->m, weight);
    int other = -1;
    for (int i = 0; i < d && other < 0; i++) {
        const double part = fabs(weight[sys->drives[i].constraint]);
        other = part > IN_THE_SET * most ? i : -1;
    }
    if (other < 0) {
        return mt_fail(err, MT_E_ASSEMBLY,
                       "joint \"%s\" cannot be driven: the other joints hold it where it is "
                       "(or it stands at a limit position)",
                       joint);
    }
    mt_joint_names names;
    char place[PLACE_SIZE] = "";
    const mt_drive *const own = own_drive(sys, joint);
    MT_TRY(mt_name_joints(sys, e->m, weight, w->mem, &names, err));
    if (own != NULL) {
        name_place(sys->model, own->addr, place, sizeof place);
    }
    return mt_fail(err, MT_E_INPUT,
                   "joints \"%s\" and \"%s\" cannot both be driven%s: they are one freedom of "
                   "the loop of joints %s, and driving one moves the other",
                   sys->joints[sys->drives[other].joint].name, joint, place, names.text);
}

/* Each drive must have a freedom of its own where the way begins. */
static mt_status refuse_dependent_drives(walk *w, mt_err *err)
{
    const mt_system *const sys = w->sys;
    const mt_arena_mark mark = mt_arena_get_mark(w->mem);
    const ptrdiff_t all = sys->n_constraints;
    const ptrdiff_t nq = sys->nq;
    const mt_newton_problem problem = problem_here(w, sys->n_constraints);
    double *const a = mt_arena_f64(w->mem, (size_t)all, (size_t)nq);
    double *const gradient = mt_arena_f64(w->mem, (size_t)nq, 1);
    mt_newton_work work;
    MT_TRY(mt_arena_check(w->mem, err));
    MT_TRY(mt_newton_work_init(&work, &problem, w->mem, err));
    MT_TRY(mt_newton_dense(&work, w->mem, err));
    mt_newton_evaluate(&work, w->at, false);
    int before = -1;
    for (int d = 0; d <= sys->n_drives; d++) {
        const ptrdiff_t m = all - sys->n_drives + d;
        mt_elimination e;
        for (ptrdiff_t j = 0; j < nq; j++) {
            memcpy(a + (j * m), work.a + (j * all), (size_t)m * sizeof *a);
        }
        const bool same = before >= 0;
        MT_TRY(mt_eliminate(sys, (int)m, a, w->mem, &e, err));
        if (same && e.qr.rank == before) { /* the last one added nothing */
            for (ptrdiff_t j = 0; j < nq; j++) {
                memcpy(a + (j * (m - 1)), work.a + (j * all), (size_t)(m - 1) * sizeof *a);
                gradient[j] = work.a[m - 1 + (j * all)];
            }
            MT_TRY(mt_eliminate(sys, (int)m - 1, a, w->mem, &e, err));
            return refuse_dependent_drive(w, &e, d - 1, gradient, err);
        }
        before = e.qr.rank;
    }
    mt_arena_rewind(w->mem, mark);
    return MT_OK;
}

/* From a dead centre of the other joints several ways lead on. */
static mt_status refuse_dead_centre(walk *w, mt_err *err)
{
    const mt_system *const sys = w->sys;
    const mt_arena_mark mark = mt_arena_get_mark(w->mem);
    const mt_newton_problem problem = problem_here(w, sys->n_constraints - sys->n_drives);
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
static mt_status refuse_steps(walk *w, mt_err *err)
{
    const char *const which = name_driven(w);
    const char *const where = name_positions(w, false);
    const char *const goal = name_positions(w, true);
    MT_TRY(mt_arena_check(w->mem, err));
    return mt_fail(err, MT_E_ASSEMBLY,
                   "%s reached %s in %d steps, not %s: other parts would have to move too far",
                   which, where, (int)MOST_STEPS, goal);
}

static mt_status refuse_far(const walk *w, int drive, mt_err *err)
{
    const mt_system *const sys = w->sys;
    const int joint = sys->drives[drive].joint;
    return mt_fail(err, MT_E_ASSEMBLY,
                   "joint \"%s\" cannot be driven to %g %s: at most %g %s from the reference "
                   "position",
                   sys->joints[joint].name, w->drive[drive].goal, drive_unit_name(sys, drive),
                   mt_drive_reach(sys, joint), drive_unit_name(sys, drive));
}

/* True where all joints stand as they are asked to. */
static bool has_arrived(const walk *w)
{
    bool there = true;
    for (int i = 0; i < w->sys->n_drives; i++) {
        there = there && w->at->drive[i] == w->drive[i].goal;
    }
    return there;
}

static bool is_at_reference(const walk *w)
{
    bool there = true;
    for (int i = 0; i < w->sys->n_drives; i++) {
        there = there && w->at->drive[i] == 0.0;
    }
    return there;
}

/*
 * Move the driven joints from their positions in `at` to their targets, together, by
 * continuation on the present branch; at: in, out. The result is closed, with the springs
 * strained about as little as possible. Angles are followed over whole turns. On failure
 * at->drive is the position reached; Newton iterations are added to *iterations. Fails:
 * MT_E_ASSEMBLY beyond mt_drive_reach, where MOST_STEPS are not enough, at a limit position, in
 * a position that the other joints hold, and where they do not stay closed; MT_E_DEAD_CENTRE
 * where the drawn position is one; MT_E_MEMORY.
 *
 * brief: the mechanism is closed by the smallest steps, not nearest to the predicted position:
 * a different position to second order, on the same branch, for a quarter of the work.
 */
static mt_status drive_solve(const mt_data *data, bool brief, mt_placement *at, int *iterations,
                             mt_arena *mem, mt_err *err)
{
    walk w = {
        .sys = data->sys, .data = data, .at = at, .brief = brief, .growth = 1.0, .mem = mem};
    MT_TRY(walk_init(&w, -1, err));
    for (int i = 0; i < w.sys->n_drives; i++) {
        if (!(fabs(w.drive[i].goal) <= mt_drive_reach(w.sys, w.sys->drives[i].joint))) {
            return refuse_far(&w, i, err);
        }
    }
    if (!has_arrived(&w) && is_at_reference(&w)) {
        MT_TRY(refuse_dead_centre(&w, err));
    }
    if (w.sys->n_drives > 1 && is_at_reference(&w)) {
        MT_TRY(refuse_dependent_drives(&w, err));
    }
    double h = DRIVE_STEP * w.unit;
    int steps = 0;
    for (; !has_arrived(&w) && h > 0.0 && steps < MOST_STEPS; steps++) {
        MT_TRY(mt_interrupt_check(w.sys->run->interrupt, err));
        MT_TRY(advance(&w, &h, err));
    }
    *iterations += w.iterations;
    return has_arrived(&w) ? MT_OK
           : h > 0.0       ? refuse_steps(&w, err)
                           : refuse_drive_position(&w, err);
}

/* The motion dq/ds of a driven joint at `at`, the other driven joints held: rate[nq]; *size:
 * how far it moves bodies [model lengths, rad] per rad or model length of the joint; *held:
 * there is none, because the other joints hold it. Fails: as Newton's steps, MT_E_MEMORY. */
static mt_status drive_motion(const mt_data *data, int drive, mt_placement *at, double *rate,
                              double *size, bool *held, mt_arena *mem, mt_err *err)
{
    walk w = {.sys = data->sys, .data = data, .at = at, .growth = 1.0, .mem = mem};
    MT_TRY(walk_init(&w, drive, err));
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

/* Reference and equilibrium. */

/* Constraints of the plain assembly: all but those of drives. */
static int assembly_constraints(const mt_system *sys)
{
    return sys->n_constraints - sys->n_drives;
}

/* Constraint violations at the drawing below this times the model length are rounding of the
 * drawing's own numbers: it closes as it is. */
static const double DRAWN_CLOSED = 1e-13;

static mt_status close_loops(mt_state *p, const mt_data *data, mt_arena *mem, mt_err *err)
{
    const mt_system *const sys = p->sys;
    const mt_newton_problem problem = {.data = data,
                                       .energy = MT_ENERGY_ANCHOR,
                                       .drawn = p->drawn,
                                       .m = assembly_constraints(sys),
                                       .trim = false,
                                       .sparse = p->sparse};
    double gap = 0.0;
    memcpy(p->reference.pose, p->drawn, (size_t)sys->n_bodies * sizeof *p->drawn);
    if (sys->drawn_closed) {
        return MT_OK; /* and the drawing's motion is the reference's */
    }
    MT_TRY(mt_newton_gap(&problem, &p->reference, mem, &gap, err));
    if (gap <= DRAWN_CLOSED * sys->length_m && sys->geometry_fixed) {
        /* where inputs shape the geometry the stage is needed for its derivative, even if
         * nothing moves now */
        return MT_OK;
    }
    return mt_newton_solve(&problem, &p->reference, mem, &p->closure, err);
}

static mt_status find_equilibrium(mt_state *p, const mt_data *data, mt_arena *mem, mt_err *err)
{
    const mt_newton_problem problem = {.data = data,
                                       .energy = MT_ENERGY_PHYSICAL,
                                       .drawn = p->drawn,
                                       .rest = p->reference.pose,
                                       .m = p->sys->n_constraints,
                                       .trim = p->sys->n_trims > 0,
                                       .sparse = p->sparse};
    return mt_newton_solve(&problem, &p->at, mem, &p->equilibrium, err);
}

/*
 * Only the path of the drive determines the position of a freedom without stiffness. Start
 * again from the closure nearest to the drawing: the result is then a function of the design
 * alone, with a derivative. Where that closure or the equilibrium from there fails (far from
 * the drawing the anchor has no effect), the first result is kept.
 */
static mt_status anchor_loose_freedoms(mt_state *p, const mt_data *data, bool *anchored,
                                       mt_arena *mem, mt_err *err)
{
    const mt_newton_problem problem = {.data = data,
                                       .energy = MT_ENERGY_ANCHOR,
                                       .drawn = p->drawn,
                                       .m = p->sys->n_constraints,
                                       .trim = false};
    mt_state other = *p;
    MT_TRY(mt_placement_init(&other.at, p->sys, mem, err));
    mt_placement_copy(p->sys, &p->driven, &other.at);
    mt_status rc = mt_newton_solve(&problem, &other.at, mem, &other.anchored, NULL);
    if (rc == MT_OK) {
        rc = find_equilibrium(&other, data, mem, NULL);
    }
    *anchored = rc == MT_OK;
    if (rc == MT_OK) {
        *p = other;
    }
    return rc == MT_E_MEMORY ? mt_fail_memory(err) : MT_OK;
}

/* Of an equilibrium that does not depend on where exactly the walk came to: plain Newton finds
 * it in so few iterations, no further than one of its steps may be from there [model lengths,
 * rad]. */
enum { DIRECT_ITERATIONS = 12 };
static const double DIRECT = 0.3;

/* Eigenvalues of Z^T H Z below this part of the largest, of all that the joints and the drive
 * leave free, are not told from 0. */
static const double CONVEX = 1e-10;

/* *minimum: the equilibrium, with the driven joint locked where it is, is a minimum of the
 * energy but for the freedoms without stiffness. The Hessian and all gradients are those of the
 * stage. */
static mt_status is_minimum_locked(const mt_state *p, bool *minimum, mt_arena *mem, mt_err *err)
{
    const mt_stage *const stage = &p->equilibrium;
    const int nq = p->sys->nq;
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    mt_elimination e;
    MT_TRY(mt_eliminate(p->sys, stage->m, stage->a, mem, &e, err));
    double *const hz = mt_arena_f64(mem, (size_t)nq, (size_t)e.n);
    double *const k = mt_arena_f64(mem, (size_t)e.n, (size_t)e.n);
    double *const values = mt_arena_f64(mem, (size_t)e.n, 1);
    MT_TRY(mt_arena_check(mem, err));
    mt_gemm(false, false, nq, e.n, nq, 1.0, stage->h, nq, e.z, nq, 0.0, hz, nq);
    mt_gemm(true, false, e.n, e.n, nq, 1.0, e.z, nq, hz, nq, 0.0, k, e.n);
    MT_TRY(mt_eig_sym(e.n, k, values, false, mem, err));
    const double noise = e.n > 0 ? CONVEX * values[e.n - 1] : 0.0;
    int loose = 0;
    while (loose < e.n && values[loose] <= noise) {
        loose++;
    }
    *minimum = loose == stage->null_freedoms && (e.n == 0 || values[0] >= -noise);
    mt_arena_rewind(mem, mark);
    return MT_OK;
}

/* *direct: a minimum of the energy without freedoms without stiffness, or with them anchored,
 * found directly from the driven position. */
static mt_status is_direct(const mt_state *p, bool anchored, bool *direct, mt_arena *mem,
                           mt_err *err)
{
    const mt_stage *const stage = &p->equilibrium;
    *direct = stage->active && (stage->null_freedoms == 0 || anchored) &&
              stage->iterations <= DIRECT_ITERATIONS &&
              mt_poses_distance(p->sys, p->driven.pose, p->at.pose) <= DIRECT;
    if (*direct && stage->solver.sparse) {
        *direct = mt_saddle_convex(&stage->solver.saddle);
        return MT_OK;
    }
    return *direct ? is_minimum_locked(p, direct, mem, err) : MT_OK;
}

/* A spring that is trimmed by less than this part of how far the mechanism moves does no work
 * on the motion of the driven joint: what is left is rounding of the walk. */
static const double TRIM_LEAST = 1e-7;

/* *works: some trimmed spring works on the motion of this driven joint, or that is not known.
 * */
static mt_status is_worked_on(mt_state *p, const mt_data *data, int drive, bool *works,
                              mt_arena *mem, mt_err *err)
{
    const mt_system *const sys = p->sys;
    const double unit = drive_unit(sys, drive);
    double *const rate = mt_arena_f64(mem, (size_t)sys->nq, 1);
    double size = 0.0;
    bool held = false;
    MT_TRY(mt_arena_check(mem, err));
    const mt_status rc = drive_motion(data, drive, &p->driven, rate, &size, &held, mem, NULL);
    *works = rc != MT_OK || held || !(size > 0.0);
    for (int t = sys->n_drives - sys->n_trims; t < sys->n_drives && !*works; t++) {
        const int measure = sys->springs[sys->drives[t].spring].measure[0];
        const bool turns = sys->measures[measure].kind == MT_MEASURE_ANGLE;
        const double stretch = turns ? 1.0 : sys->length_m;
        const double by = fabs(mt_drive_rate(data, measure, p->driven.pose, rate));
        *works = !(by * unit / stretch <= TRIM_LEAST * size);
    }
    return rc == MT_E_MEMORY ? mt_fail_memory(err) : MT_OK;
}

/*
 * The forces tau of trimmed springs act along the gradients t of their elongations. Along v =
 * dq/ds, the motion of one driven joint with no other spring or load at work and the other
 * driven joints held, equilibrium requires v . (g + t tau) = 0: where v . t = 0 for all of them
 * no forces of the springs satisfy it. Reports that instead of the failure rc of the search.
 */
static mt_status explain_trim(mt_state *p, const mt_data *data, mt_status rc, mt_arena *mem,
                              mt_err *err)
{
    const mt_system *const sys = p->sys;
    int d = sys->n_drives - sys->n_trims;
    for (; d < sys->n_drives; d++) {
        bool works = true;
        MT_TRY(is_worked_on(p, data, d, &works, mem, err));
        if (!works) {
            break;
        }
    }
    if (d == sys->n_drives) {
        return rc;
    }
    const char *const spring = sys->springs[sys->drives[d].spring].name;
    const char *const joint = sys->joints[sys->drives[d].joint].name;
    const mt_drive *const own = own_drive(sys, joint);
    char place[PLACE_SIZE] = "";
    if (own != NULL && own->trim && strcmp(own->trim_name.s, spring) == 0) {
        name_place(sys->model, own->trim_name.addr, place, sizeof place);
    }
    return mt_fail(err, MT_E_INPUT,
                   "trim: spring \"%s\" cannot hold \"%s\": its force does no work when \"%s\" "
                   "moves%s; name a spring that \"%s\" strains, or lock it",
                   spring, joint, joint, place, joint);
}

/* From `from` to the driven position, and to the equilibrium next to it. */
static mt_status drive(mt_state *p, const mt_data *data, const mt_placement *from, bool brief,
                       bool *anchored, mt_arena *mem, mt_err *err)
{
    *anchored = false;
    mt_placement_copy(p->sys, from, &p->driven);
    MT_TRY(drive_solve(data, brief, &p->driven, &p->iterations, mem, err));
    mt_placement_copy(p->sys, &p->driven, &p->at);
    const mt_status rc = find_equilibrium(p, data, mem, err);
    if (rc != MT_OK) {
        return rc == MT_E_EQUILIBRIUM && p->sys->n_trims > 0
                   ? explain_trim(p, data, rc, mem, err)
                   : rc;
    }
    return p->equilibrium.null_freedoms > 0 ? anchor_loose_freedoms(p, data, anchored, mem, err)
                                            : MT_OK;
}

/* An equilibrium further than this from where another design was driven to is looked for from
 * its own way there [model lengths, rad]. */
static const double AGAIN = 0.03;

/* *near: the equilibrium is direct from `home`, and next to it. Else nothing has changed. */
static mt_status drive_again(mt_state *p, const mt_data *data, const mt_placement *home,
                             bool *near, mt_arena *mem, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    const mt_state before = *p;
    mt_err own = {0};
    bool anchored = false;
    mt_status rc = drive(p, data, home, true, &anchored, mem, &own);
    rc = rc == MT_OK && !anchored ? is_direct(p, false, near, mem, &own) : rc;
    if (rc == MT_E_INTERRUPTED || mt_is_final(rc)) {
        return mt_fail(err, rc, "%s", own.text);
    }
    *near = *near && rc == MT_OK && p->equilibrium.null_freedoms == 0 &&
            mt_poses_distance(p->sys, p->driven.pose, p->at.pose) <= AGAIN;
    if (!*near) {
        mt_arena_rewind(mem, mark);
        *p = before;
    }
    p->direct = *near;
    return MT_OK;
}

/*
 * The brief path is sufficient where the equilibrium is direct: it is then the same from any
 * start next to it on the same branch. All other results (saddles, freedoms without stiffness
 * that nothing anchors, energies followed downhill, and failures) may depend on the start, and
 * are computed with the exact path.
 */
static mt_status drive_from(mt_state *p, const mt_data *data, const mt_placement *from,
                            mt_arena *mem, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    const mt_state before = *p;
    mt_err own = {0};
    bool anchored = false;
    bool direct = false;
    mt_status rc = drive(p, data, from, true, &anchored, mem, &own);
    rc = rc == MT_OK ? is_direct(p, anchored, &direct, mem, &own) : rc;
    if (rc == MT_OK && direct) {
        p->direct = true;
        return MT_OK;
    }
    if (rc == MT_E_INTERRUPTED || mt_is_final(rc)) {
        return mt_fail(err, rc, "%s", own.text);
    }
    mt_arena_rewind(mem, mark);
    *p = before; /* what was anchored stood in memory that is gone */
    return drive(p, data, from, false, &anchored, mem, err);
}

/* Angle of R0^T R: sin from its skew part, cos from its trace. */
static double turn_between(const mt_pose *from, const mt_pose *to)
{
    double r[3][3];
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            r[i][k] = 0.0;
            for (int j = 0; j < 3; j++) {
                r[i][k] += creal(from->r[j + (3 * i)]) * creal(to->r[j + (3 * k)]);
            }
        }
    }
    const double axis[3] = {r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]};
    return atan2(mt_norm2(3, axis), r[0][0] + r[1][1] + r[2][2] - 1.0);
}

/* The bodies with the largest motion and rotation, the first of equal ones. */
static void measure_motion(mt_state *p)
{
    const mt_pose *const from = p->sys->driven ? p->driven.pose : p->drawn;
    p->moved_body = -1;
    p->turned_body = -1;
    for (int i = 0; i < p->sys->n_bodies; i++) {
        double way[3];
        for (int k = 0; k < 3; k++) {
            way[k] = creal(p->at.pose[i].x[k]) - creal(from[i].x[k]);
        }
        const double moved = mt_norm2(3, way);
        const double turned = turn_between(&from[i], &p->at.pose[i]);
        if (mt_exceeds(moved, p->moved_m)) {
            p->moved_m = moved;
            p->moved_body = i;
        }
        if (mt_exceeds(turned, p->turned_rad)) {
            p->turned_rad = turned;
            p->turned_body = i;
        }
    }
}

static mt_status state_init(mt_state *p, const mt_system *sys, mt_arena *mem, mt_err *err)
{
    *p = (mt_state){.sys = sys};
    MT_TRY(mt_placement_init(&p->reference, sys, mem, err));
    MT_TRY(mt_placement_init(&p->driven, sys, mem, err));
    MT_TRY(mt_placement_init(&p->at, sys, mem, err));
    p->drawn = mt_arena_alloc(mem, (size_t)sys->n_bodies, sizeof *p->drawn);
    p->d_reference = mt_arena_f64(mem, (size_t)sys->nq, 1);
    p->d_pose = mt_arena_f64(mem, (size_t)sys->nq, 1);
    return mt_arena_check(mem, err);
}

mt_status mt_position_solve(const mt_system *sys, mt_data *data, const mt_placement *start,
                            mt_position_method way, mt_arena *mem, mt_state *out, mt_err *err)
{
    MT_TRY(state_init(out, sys, mem, err));
    out->sparse = way == MT_POSITION_SPARSE;
    mt_data_drawn(data, out->drawn);
    mt_data_targets(data);
    MT_TRY(close_loops(out, data, mem, err));
    mt_data_rest(data, out->reference.pose);
    mt_placement_copy(sys, &out->reference, &out->at);
    if (sys->driven) {
        const bool again = way == MT_POSITION_AGAIN;
        const mt_placement *const from = start != NULL && !again ? start : &out->reference;
        bool anchored = false;
        bool near = false;
        if (again) {
            MT_TRY(drive_again(out, data, start, &near, mem, err));
        }
        if (!near) {
            MT_TRY(way == MT_POSITION_EXACT ? drive(out, data, from, false, &anchored, mem, err)
                                            : drive_from(out, data, from, mem, err));
        }
    } else if (sys->loaded) {
        MT_TRY(find_equilibrium(out, data, mem, err));
    }
    out->iterations += out->closure.iterations + out->anchored.iterations;
    out->iterations += out->equilibrium.iterations;
    measure_motion(out);
    if (sys->drawn_closed && !sys->driven && !sys->loaded) {
        return MT_OK; /* nothing was moved: no gap */
    }
    const mt_newton_problem check = {.data = data,
                                     .energy = MT_ENERGY_ANCHOR,
                                     .drawn = out->drawn,
                                     .m = sys->n_constraints,
                                     .trim = false};
    return mt_newton_gap(&check, &out->at, mem, &out->gap_m, err);
}

typedef struct balance {
    const mt_system *sys;
    double *unbalanced; /* [nq] */
} balance;

/* c g, over the states. */
static bool add_gradient(void *context, const int body[2], double c, double noise,
                         const mt_jet *jet)
{
    const balance *const b = context;
    (void)noise;
    for (int k = 0; k < MT_LOCAL; k++) {
        const int dof = mt_local_dof(b->sys, body, k);
        if (dof >= 0) {
            b->unbalanced[dof] += c * creal(jet->g[k]);
        }
    }
    return true;
}

mt_status mt_position_balance(const mt_state *p, const mt_data *data, double *left,
                              double *open, mt_arena *scratch, mt_err *err)
{
    const mt_system *const sys = p->sys;
    const mt_stage *const stage = &p->equilibrium;
    const size_t nq = (size_t)sys->nq;
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    balance b = {.sys = sys, .unbalanced = mt_arena_f64(scratch, nq, 1)};
    double *const lambda = mt_arena_f64(scratch, (size_t)sys->n_constraints, 1);
    mt_lagrangian l;
    MT_TRY(mt_lagrangian_init_rows(&l, sys, scratch, err));
    memcpy(left, stage->left.q, nq * sizeof *left);
    memset(open, 0, nq * sizeof *open);
    (void)mt_forces_at(data, &p->at, left, open, add_gradient, &b);
    mt_lagrangian_eval(data, MT_ENERGY_NONE, NULL, &p->at, sys->n_constraints, NULL,
                       MT_CURVATURE_NONE, &l);
    memcpy(lambda, stage->lambda, (size_t)sys->n_constraints * sizeof *lambda);
    mt_axpy(sys->n_constraints, 1.0, stage->left.lambda, lambda);
    mt_lagrangian_pull(&l, sys->n_constraints, lambda, b.unbalanced);
    for (size_t j = 0; j < nq; j++) {
        b.unbalanced[j] = -b.unbalanced[j];
    }
    MT_TRY(
        mt_saddle_solve(&stage->solver.saddle, b.unbalanced, NULL, open, NULL, scratch, err));
    mt_axpy(sys->nq, 1.0, open, left);
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}

mt_status mt_position_tangent(mt_state *p, mt_data *data, mt_arena *scratch, mt_err *err)
{
    const mt_system *const sys = p->sys;
    const size_t n = (size_t)sys->n_bodies;
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    mt_pose *const drawn = mt_arena_alloc(scratch, n, sizeof *drawn);
    mt_pose *const work = mt_arena_alloc(scratch, n, sizeof *work);
    MT_TRY(mt_arena_check(scratch, err));
    mt_data_vecs(data);
    mt_data_targets(data);
    mt_data_drawn(data, drawn);
    /* the drawn centres move with the geometry; where no loop had to be closed that is the
     * whole motion unless the constraints open */
    for (int i = 0; i < sys->n_bodies; i++) {
        for (int k = 0; k < 3; k++) {
            const int dof = sys->bodies[i].dof[k];
            if (dof >= 0) {
                p->d_reference[dof] = cx_derivative(drawn[i].x[k]);
            }
        }
        for (int k = 3; k < 6; k++) {
            const int dof = sys->bodies[i].dof[k];
            if (dof >= 0) {
                p->d_reference[dof] = 0.0;
            }
        }
    }
    mt_newton_problem problem = {.data = data,
                                 .energy = MT_ENERGY_ANCHOR,
                                 .drawn = drawn,
                                 .m = assembly_constraints(sys),
                                 .trim = false};
    MT_TRY(newton_tangent(&problem, &p->reference, &p->closure, p->d_reference, scratch, err));
    mt_poses_tangent(sys, p->reference.pose, p->d_reference, work);
    mt_data_rest(data, work);
    memcpy(p->d_pose, p->d_reference, (size_t)sys->nq * sizeof *p->d_pose);
    if (sys->driven) {
        problem.m = sys->n_constraints;
        MT_TRY(newton_tangent(&problem, &p->at, &p->anchored, p->d_pose, scratch, err));
    }
    if (p->equilibrium.active) {
        problem.energy = MT_ENERGY_PHYSICAL;
        problem.m = sys->n_constraints;
        problem.trim = sys->n_trims > 0;
        MT_TRY(newton_tangent(&problem, &p->at, &p->equilibrium, p->d_pose, scratch, err));
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}
