/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Equations of the joints with those of the coordinates that are given below them,
 *     [A; G] dq = -[c; s - s_given],
 * solved by least-norm steps until they hold; and the velocities of least energy,
 *     min 1/2 v^T M v   under   [A; G] v = [drive; rates].
 * A walk takes short steps and stays on its branch (mechanics/position.h).
 *     An equilibrium may be in another assembly of the loops than the drawing, where loads have
 * pulled links through a line. Joints are moved from the drawing, then; what they leave free
 * goes to where it stands when they are moved from the equilibrium, if with them held there a
 * way leads there.
 */
#include "simulate/start.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "mechanics/position.h"
#include "simulate/accelerate.h"

/* A walk goes so far in one step [rad, model lengths]. */
static const double STRIDE = 0.05;
enum { STRIDES_MOST = 100000, NEWTON_STEPS = 30 };
/* Strides shorter than this are not tried; links that miss being in line by less are in line
 * (mechanics/position.c) [rad, model lengths]. */
static const double SHORTEST = 1e-3;
/* Places are the same below this, and a way on which a stride gains less than this part of it
 * leads elsewhere. */
static const double ARRIVED = 1e-6;
static const double GAIN = 1e-3;
/* Equations hold to so many rounding errors [model lengths]. */
static const double HOLDS = 64.0 * DBL_EPSILON;
/* A step of Newton's method beyond this [rad, model lengths] has left the branch. */
static const double ASTRAY = 1.0;
/* Rates hold to this part of the largest velocity. */
static const double RATES_HOLD = 1e-9;

/* The equations at a place. */
typedef struct augmented {
    mt_linear *lin;
    const mt_system *sys;
    mt_motion motion;
    int m; /* of the joints */
    int n; /* with the coordinates */
    double *a;
    double *c;
    double *v;
    mt_gauge_motion gauge;
    mt_branch branch;
    mt_placement before; /* where a stride begins */
} augmented;

static mt_status augmented_init(augmented *g, mt_linear *lin, int n, mt_arena *mem, mt_err *err)
{
    *g = (augmented){.lin = lin, .sys = mt_linear_system(lin)};
    const size_t nq = (size_t)g->sys->nq;
    MT_TRY(mt_motion_init(&g->motion, lin, mem, err));
    g->m = g->motion.m;
    g->n = g->m + n;
    g->a = mt_arena_f64(mem, (size_t)g->n, nq);
    g->c = mt_arena_f64(mem, (size_t)g->n, 1);
    g->v = mt_arena_f64(mem, nq, 1);
    g->gauge.row = mt_arena_f64(mem, nq, 1);
    MT_TRY(mt_branch_init(&g->branch, g->sys, g->n, mem, err));
    MT_TRY(mt_placement_init(&g->before, g->sys, mem, err));
    return mt_arena_check(mem, err);
}

/* A, G and the residual of the equations, with velocities v. */
static void augmented_eval(augmented *g, const mt_placement *at, const double *v, int n,
                           const mt_sim_joint *joints)
{
    mt_motion_eval(&g->motion, at, v);
    for (ptrdiff_t j = 0; j < g->sys->nq; j++) {
        for (ptrdiff_t i = 0; i < g->m; i++) {
            g->a[i + (j * g->n)] = g->motion.a[i + (j * g->m)];
        }
    }
    memcpy(g->c, g->motion.gap, (size_t)g->m * sizeof *g->c);
    for (ptrdiff_t k = 0; k < n; k++) {
        const mt_gauge gauge = {.channel = -1, .joint = joints[k].joint};
        mt_motion_gauge(&g->motion, at, v, gauge, &g->gauge);
        for (ptrdiff_t j = 0; j < g->sys->nq; j++) {
            g->a[g->m + k + (j * g->n)] = g->gauge.row[j];
        }
        g->c[g->m + k] = g->gauge.value - joints[k].value;
    }
}

/* Newton's method with least-norm steps at `at`. *holds false: it does not converge. */
static mt_status close_all(augmented *g, mt_placement *at, int n, const mt_sim_joint *joints,
                           bool *holds, mt_arena *mem, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    double *const dq = mt_arena_f64(mem, (size_t)g->sys->nq, 1);
    double before = HUGE_VAL;
    MT_TRY(mt_arena_check(mem, err));
    *holds = g->n == 0;
    for (int i = 0; i < NEWTON_STEPS && !*holds; i++) {
        mt_elimination e;
        double gap = 0.0;
        double largest = 0.0;
        augmented_eval(g, at, g->v, n, joints);
        MT_TRY(mt_eliminate_factor(g->sys, g->n, g->a, mem, &e, err));
        for (int k = 0; k < g->n; k++) {
            const double d = fabs(g->c[k]) * e.dr[k] / g->sys->length_m;
            gap = !(d <= gap) ? d : gap;
        }
        *holds = gap <= HOLDS || (gap >= before && before <= HOLDS * NEWTON_STEPS);
        before = gap;
        if (*holds) {
            break;
        }
        MT_TRY(mt_eliminate_particular(&e, g->c, dq, mem, err));
        for (int k = 0; k < g->sys->nq; k++) {
            largest = fmax(largest, fabs(dq[k]) / e.dc[k] / g->sys->length_m);
            dq[k] = -dq[k];
        }
        if (!(largest <= ASTRAY)) {
            break;
        }
        mt_poses_move(g->sys, at->pose, dq);
    }
    mt_arena_rewind(mem, mark);
    return MT_OK;
}

mt_status mt_start_rest(mt_linear *lin, mt_arena *mem, mt_sim_start *out, mt_err *err)
{
    const mt_system *const sys = mt_linear_system(lin);
    MT_TRY(mt_placement_init(&out->at, sys, mem, err));
    out->v = mt_arena_f64(mem, (size_t)sys->nq, 1);
    MT_TRY(mt_arena_check(mem, err));
    mt_placement_copy(sys, &mt_linear_position(lin)->at, &out->at);
    return MT_OK;
}

/* Read the present coordinates of the joints. */
static void read_joints(augmented *g, const mt_placement *at, int n, mt_sim_joint *joints)
{
    augmented_eval(g, at, g->v, n, joints);
    for (int k = 0; k < n; k++) {
        joints[k].value += g->c[g->m + k];
    }
}

/* Keep the position to return to after a failed stride. */
static mt_status stand(augmented *g, const mt_placement *at, int n, const mt_sim_joint *joints,
                       mt_arena *mem, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    mt_elimination e;
    augmented_eval(g, at, g->v, n, joints);
    MT_TRY(mt_eliminate_factor(g->sys, g->n, g->a, mem, &e, err));
    mt_branch_stand(&g->branch, g->n, g->a, &e);
    mt_placement_copy(g->sys, at, &g->before);
    mt_arena_rewind(mem, mark);
    return MT_OK;
}

/* Close `at`, which was moved from the position of the walk, on its branch, or (straight) on
 * another branch that meets it. On failure restore the position of the walk. */
static mt_status stride(augmented *g, mt_placement *at, int n, const mt_sim_joint *to,
                        bool straight, bool *good, mt_arena *mem, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    MT_TRY(close_all(g, at, n, to, good, mem, err));
    if (*good && !straight) {
        augmented_eval(g, at, g->v, n, to);
        MT_TRY(mt_branch_kept(&g->branch, g->n, g->a, good, mem, err));
    }
    if (*good) {
        mt_motion_turns(&g->motion, at);
    } else {
        mt_placement_copy(g->sys, &g->before, at);
    }
    mt_arena_rewind(mem, mark);
    return MT_OK;
}

static mt_status refuse_walk(const augmented *g, const mt_sim_joint *joint, double at,
                             mt_err *err)
{
    const mt_system_joint *const j = &g->sys->joints[joint->joint];
    return mt_fail(err, MT_E_ASSEMBLY,
                   "the mechanism cannot reach that: from the reference position its joints "
                   "stay closed up to joint \"%s\" at %.6g %s",
                   j->name, at, j->angle ? "rad" : "m");
}

/* Move the joints from their values at `at` in proportion. */
static mt_status move_joints_in_strides(augmented *g, int n, const mt_sim_joint *joints,
                                        mt_placement *at, mt_arena *mem, mt_err *err)
{
    mt_sim_joint *const from = mt_arena_alloc(mem, (size_t)n, sizeof *from);
    mt_sim_joint *const to = mt_arena_alloc(mem, (size_t)n, sizeof *to);
    MT_TRY(mt_arena_check(mem, err));
    double most = 0.0;
    memcpy(from, joints, (size_t)n * sizeof *from);
    memcpy(to, joints, (size_t)n * sizeof *to);
    read_joints(g, at, n, from);
    for (int k = 0; k < n; k++) {
        const mt_system_joint *const j = &g->sys->joints[joints[k].joint];
        const double way = fabs(joints[k].value - from[k].value);
        most = fmax(most, j->angle ? way : way / g->sys->length_m);
    }
    if (!(most <= STRIDES_MOST * STRIDE)) {
        return mt_fail(err, MT_E_ASSEMBLY, "the joints are too far from where they start");
    }
    double done = 0.0; /* of `most` */
    double next = STRIDE;
    for (bool arrived = false; !arrived;) {
        bool good = false;
        arrived = done + next >= most;
        const double share = arrived ? 1.0 : (done + next) / most;
        for (int k = 0; k < n; k++) {
            to[k].value = arrived ? joints[k].value
                                  : from[k].value + (share * (joints[k].value - from[k].value));
        }
        MT_TRY(stand(g, at, n, to, mem, err));
        const bool straight = next <= SHORTEST;
        MT_TRY(stride(g, at, n, to, straight, &good, mem, err));
        if (!good && straight) {
            return refuse_walk(
                g, &joints[0],
                from[0].value + (done / most * (joints[0].value - from[0].value)), err);
        }
        arrived = arrived && good;
        done += good ? next : 0.0;
        next = good ? fmin(2.0 * next, STRIDE) : 0.5 * next;
    }
    return MT_OK;
}

/* *there: true where, with the joints held, a path leads from `from`, which moves along it, to
 * `to`. */
static mt_status leads(augmented *g, int n, const mt_sim_joint *joints, mt_placement *from,
                       const mt_placement *to, bool *there, mt_arena *mem, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    double *const way = mt_arena_f64(mem, (size_t)g->sys->nq, 1);
    double left = HUGE_VAL;
    bool good = true;
    MT_TRY(mt_arena_check(mem, err));
    while (good) {
        const double before = left;
        left = mt_poses_distance(g->sys, from->pose, to->pose);
        good = left > ARRIVED && left < (1.0 - GAIN) * before;
        if (good) {
            mt_poses_increment(g->sys, from->pose, to->pose, way);
            for (int j = 0; j < g->sys->nq; j++) {
                way[j] *= fmin(1.0, STRIDE / left);
            }
            MT_TRY(stand(g, from, n, joints, mem, err));
            mt_poses_move(g->sys, from->pose, way);
            MT_TRY(stride(g, from, n, joints, false, &good, mem, err));
        }
    }
    *there = left <= ARRIVED;
    mt_arena_rewind(mem, mark);
    return MT_OK;
}

mt_status mt_start_joints(mt_linear *lin, int n, const mt_sim_joint *joints, mt_arena *mem,
                          mt_sim_start *start, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    const mt_system *const sys = mt_linear_system(lin);
    const mt_state *const p = mt_linear_position(lin);
    augmented g;
    mt_placement drawn;
    bool there = false;
    MT_TRY(augmented_init(&g, lin, n, mem, err));
    MT_TRY(mt_placement_init(&drawn, sys, mem, err));
    mt_placement_copy(sys, sys->driven ? &p->driven : &p->reference, &drawn);
    const bool settled = mt_poses_distance(sys, drawn.pose, start->at.pose) > 0.0;
    MT_TRY(move_joints_in_strides(&g, n, joints, &drawn, mem, err));
    const mt_status rc =
        settled ? move_joints_in_strides(&g, n, joints, &start->at, mem, NULL) : MT_E_ASSEMBLY;
    if (rc == MT_E_MEMORY) {
        return mt_fail_memory(err);
    }
    if (rc == MT_OK) {
        mt_placement way;
        MT_TRY(mt_placement_init(&way, sys, mem, err));
        mt_placement_copy(sys, &drawn, &way);
        MT_TRY(leads(&g, n, joints, &way, &start->at, &there, mem, err));
    }
    if (!there) {
        mt_placement_copy(sys, &drawn, &start->at);
    }
    mt_arena_rewind(mem, mark);
    return MT_OK;
}

mt_status mt_start_along(mt_linear *lin, const double *dq, mt_arena *mem, mt_sim_start *start,
                         mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    augmented g;
    bool holds = false;
    MT_TRY(augmented_init(&g, lin, 0, mem, err));
    mt_poses_move(g.sys, start->at.pose, dq);
    MT_TRY(close_all(&g, &start->at, 0, NULL, &holds, mem, err));
    if (!holds) {
        return mt_fail(err, MT_E_ASSEMBLY,
                       "the mechanism does not close at such a displacement");
    }
    mt_motion_turns(&g.motion, &start->at);
    mt_arena_rewind(mem, mark);
    return MT_OK;
}

mt_status mt_start_from(mt_linear *lin, const mt_linear *from, mt_sim_start *start, mt_err *err)
{
    const mt_system *const to = mt_linear_system(lin);
    const mt_system *const other = mt_linear_system(from);
    const mt_placement *const at = &mt_linear_position(from)->at;
    if (to->nq != other->nq || to->n_bodies != other->n_bodies ||
        to->n_measures != other->n_measures) {
        return mt_fail(err, MT_E_INTERNAL, "systems of other states");
    }
    const mt_placement own = start->at;
    mt_placement_copy(to, at, &start->at);
    memcpy(start->at.drive, own.drive, sizeof own.drive);
    return MT_OK;
}

mt_status mt_start_rates(mt_linear *lin, int n, const mt_sim_joint *rates, const double *drive,
                         mt_arena *mem, mt_sim_start *start, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    augmented g;
    MT_TRY(augmented_init(&g, lin, n, mem, err));
    const mt_system *const sys = g.sys;
    double *const b = mt_arena_f64(mem, (size_t)g.n, 1);
    double *const none = mt_arena_f64(mem, (size_t)sys->nq, 1);
    MT_TRY(mt_arena_check(mem, err));
    augmented_eval(&g, &start->at, g.v, n, rates);
    for (int k = 0; k < n; k++) {
        b[g.m + k] = rates[k].value;
    }
    for (int i = 0; i < sys->n_drives - sys->n_trims; i++) {
        b[sys->drives[i].constraint] = drive == NULL ? 0.0 : drive[i];
    }
    const mt_gauss gauss = {.m = g.n, .mass = g.motion.mass, .force = none, .a = g.a, .b = b};
    MT_TRY(mt_gauss_solve(sys, &gauss, start->v, NULL, NULL, mem, err));
    memcpy(g.c, b, (size_t)g.n * sizeof *b);
    mt_gemv(false, g.n, sys->nq, 1.0, g.a, g.n, start->v, -1.0, g.c);
    for (int k = 0; k < n; k++) {
        if (!(fabs(g.c[g.m + k]) <= RATES_HOLD * mt_max_abs(g.n, b))) {
            return mt_fail(err, MT_E_INPUT,
                           "joint \"%s\" cannot turn or slide at %.6g as the joints stand",
                           sys->joints[rates[k].joint].name, rates[k].value);
        }
    }
    mt_arena_rewind(mem, mark);
    return MT_OK;
}
