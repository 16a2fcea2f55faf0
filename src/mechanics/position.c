/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mechanics/position.h"

#include <math.h>
#include <string.h>

#include "base/format.h"
#include "base/number.h"
#include "base/text.h"
#include "mechanics/drive.h"
#include "mechanics/newton_tangent.h"

/* Constraints of the plain assembly: all but the drive's. */
static int assembly_constraints(const mt_system *sys)
{
    return sys->driven ? sys->n_constraints - 1 : sys->n_constraints;
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
                                       .m = p->sys->n_constraints,
                                       .trim = p->sys->trim,
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
enum { PLACE_SIZE = 320 };

/*
 * The force tau of a trimmed spring acts along the gradient t of its elongation. Along v =
 * dq/ds, the motion of the driven joint with nothing else held, equilibrium requires v . (g +
 * tau t) = 0: where v . t = 0 no force of the spring satisfies it. Reports that instead of the
 * failure rc of the search.
 */
static mt_status explain_trim(mt_state *p, const mt_data *data, mt_status rc, mt_arena *mem,
                              mt_err *err)
{
    const mt_system *const sys = p->sys;
    const mt_model *const m = sys->model;
    const int measure = sys->springs[sys->trim_spring].measure[0];
    const double unit = sys->joints[sys->drive_joint].angle ? 1.0 : sys->length_m;
    const double stretch =
        sys->measures[measure].kind == MT_MEASURE_ANGLE ? 1.0 : sys->length_m;
    double *const rate = mt_arena_f64(mem, (size_t)sys->nq, 1);
    double size = 0.0;
    bool held = false;
    MT_TRY(mt_arena_check(mem, err));
    mt_status own = mt_drive_motion(data, &p->driven, rate, &size, &held, mem, NULL);
    if (own != MT_OK || held || !(size > 0.0) ||
        !(fabs(mt_drive_rate(data, measure, p->driven.pose, rate)) * unit / stretch <=
          TRIM_LEAST * size)) {
        return own == MT_E_MEMORY ? mt_fail_memory(err) : rc;
    }
    const mt_configuration *const c = &m->configurations[sys->configuration];
    const char *const spring = sys->springs[sys->trim_spring].name;
    const char *const joint = sys->joints[sys->drive_joint].name;
    int line = 0;
    int column = 0;
    const bool known = c->drive.trim && strcmp(c->drive.trim_name.s, spring) == 0 &&
                       m->path != NULL &&
                       mt_model_locate(m, c->drive.trim_name.addr, &line, &column);
    char place[PLACE_SIZE] = "";
    if (known) {
        (void)mt_snprintf(place, sizeof place, " (%s:%d:%d)", mt_text_base_name(m->path), line,
                          column);
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
    MT_TRY(mt_drive_solve(data, brief, &p->driven, &p->iterations, mem, err));
    mt_placement_copy(p->sys, &p->driven, &p->at);
    const mt_status rc = find_equilibrium(p, data, mem, err);
    if (rc != MT_OK) {
        return rc == MT_E_EQUILIBRIUM && p->sys->trim ? explain_trim(p, data, rc, mem, err)
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
    MT_TRY(
        mt_newton_tangent(&problem, &p->reference, &p->closure, p->d_reference, scratch, err));
    mt_poses_tangent(sys, p->reference.pose, p->d_reference, work);
    mt_data_rest(data, work);
    memcpy(p->d_pose, p->d_reference, (size_t)sys->nq * sizeof *p->d_pose);
    if (sys->driven) {
        problem.m = sys->n_constraints;
        MT_TRY(mt_newton_tangent(&problem, &p->at, &p->anchored, p->d_pose, scratch, err));
    }
    if (p->equilibrium.active) {
        problem.energy = MT_ENERGY_PHYSICAL;
        problem.m = sys->n_constraints;
        problem.trim = sys->trim;
        MT_TRY(mt_newton_tangent(&problem, &p->at, &p->equilibrium, p->d_pose, scratch, err));
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}
