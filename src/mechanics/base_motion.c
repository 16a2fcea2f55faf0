/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rigid motions of the ground: momenta of the mechanism, and what modes have of them. */
#include "mechanics/base_motion.h"

#include <complex.h>
#include <float.h>
#include <math.h>

#include "linalg/dense.h"
#include "mechanics/absolute.h"
#include "mechanics/lagrangian.h"
#include "mechanics/rows.h"

const char *mt_base_motion_name(int axis)
{
    static const char *const names[MT_BASE_MOTIONS] = {"x", "y", "z", "rx", "ry", "rz"};
    return names[axis];
}

/* Rows of one term of the mass: a beam in space has most. */
enum { MOST_ROWS = 16 };

static int count_dofs(const mt_system *sys, int body)
{
    int n = 0;
    for (int d = 0; d < MT_BASE_MOTIONS; d++) {
        n += sys->bodies[body].dof[d] >= 0 ? 1 : 0;
    }
    return n;
}

/* Equations of a joint, with that of its locked drive. */
static int count_equations(const mt_system *sys, int joint)
{
    const int drive = mt_system_drive_of(sys, joint);
    const bool locked = drive >= 0 && sys->drives[drive].spring < 0;
    return sys->joints[joint].count + (locked ? 1 : 0);
}

/* True where the joint holds a body that nothing held yet. */
static bool spread(const mt_system *sys, int joint, bool *held)
{
    const int *const body = sys->joints[joint].body;
    for (int side = 0; side < 2; side++) {
        const int own = body[side];
        const int other = body[1 - side];
        const bool still = other == MT_GROUND || held[other];
        if (own != MT_GROUND && !held[own] && still &&
            count_equations(sys, joint) >= count_dofs(sys, own)) {
            held[own] = true;
            return true;
        }
    }
    return false;
}

/* held[bodies]: fixed to the ground, by itself or through others; joints in both orders, as a
 * row of fixed bodies may be listed from either end. */
static void find_held(const mt_system *sys, bool *held)
{
    bool more = true;
    while (more) {
        more = false;
        for (int i = 0; i < 2 * sys->n_joints; i++) {
            const int joint = i < sys->n_joints ? i : (2 * sys->n_joints) - 1 - i;
            more = spread(sys, joint, held) || more;
        }
    }
}

/* Component `axis` (0..5) of the rigid motion along direction d, of a body at x. */
static double component(int axis, int d, const double about[3], const mt_pose *pose)
{
    if (axis >= 3 || d < 3) {
        return axis == d ? 1.0 : 0.0;
    }
    /* e_(d - 3) x (x - about) */
    const int e = d - 3;
    const int other = 3 - axis - e;
    if (axis == e) {
        return 0.0;
    }
    const double arm = creal(pose->x[other]) - about[other];
    return (e + 1) % 3 == other ? arm : -arm;
}

/* A row of a term along all directions: along[n]. */
static void row_along(const mt_base_motion *b, const mt_term *t, const mt_pose *poses,
                      const mt_cx *row, double *along)
{
    for (int k = 0; k < b->n; k++) {
        along[k] = 0.0;
        for (int i = 0; i < MT_LOCAL; i++) {
            const mt_pose *const pose = mt_pose_of(poses, t->body[i / 6]);
            along[k] += creal(row[i]) * component(i % 6, b->axis[k], b->about_m, pose);
        }
    }
}

static bool is_held(const mt_term *t, const bool *held)
{
    const bool first = t->body[0] == MT_GROUND || held[t->body[0]];
    return first && (t->body[1] == MT_GROUND || held[t->body[1]]);
}

/* Adds coefficient times a row times its partner along all directions to the momenta, and to
 * the totals where the term moves. */
static void add_rows(const mt_system *sys, const mt_term *t, double c, const mt_cx *row,
                     const double *own, const double *partner, bool moves, mt_base_motion *b)
{
    for (int k = 0; k < b->n; k++) {
        for (int i = 0; i < MT_LOCAL; i++) {
            const int dof = mt_local_dof(sys, t->body, i);
            if (dof >= 0) {
                b->momentum[dof + ((ptrdiff_t)k * sys->nq)] += c * creal(row[i]) * partner[k];
            }
        }
        b->total[k] += moves ? c * own[k] * partner[k] : 0.0;
    }
}

/* One term, c sum f f^T, or of a pair c (f g^T + g f^T) / 2. */
static void add_term(const mt_data *data, const mt_term *t, const mt_pose *poses, bool moves,
                     mt_base_motion *b)
{
    mt_cx rows[MOST_ROWS * MT_LOCAL];
    double along[MOST_ROWS][MT_BASE_MOTIONS];
    const double c = data->value[t->coefficient] * (t->pair ? 0.5 : 1.0);
    mt_term_rows(data, MT_TERM_MASS, t, poses, rows);
    for (int r = 0; r < t->count; r++) {
        row_along(b, t, poses, rows + ((ptrdiff_t)r * MT_LOCAL), along[r]);
    }
    for (int r = 0; r < t->count; r++) {
        const double *const partner = along[t->pair ? 1 - r : r];
        add_rows(data->sys, t, c, rows + ((ptrdiff_t)r * MT_LOCAL), along[r], partner, moves,
                 b);
    }
}

mt_status mt_base_motion_new(const mt_system *sys, const mt_state *settled,
                             const double *inputs, const double about[3], mt_arena *mem,
                             mt_base_motion *out, mt_err *err)
{
    mt_data data;
    mt_placement at;
    *out = (mt_base_motion){.n = 0};
    for (int axis = 0; axis < MT_BASE_MOTIONS; axis++) {
        if (sys->dimension == 3 || axis < 2 || axis == MT_BASE_MOTIONS - 1) {
            out->axis[out->n++] = axis;
        }
    }
    for (int i = 0; i < 3; i++) {
        out->about_m[i] = about[i];
    }
    bool *const held = mt_arena_alloc(mem, (size_t)sys->n_bodies, sizeof *held);
    out->momentum = mt_arena_f64(mem, (size_t)sys->nq, (size_t)out->n);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_absolute_stand(sys, settled, inputs, &data, &at, mem, err));
    find_held(sys, held);
    for (int i = 0; i < sys->n_inertias; i++) {
        const mt_term t = mt_term_of_inertia(sys, i);
        if (t.count > MOST_ROWS) {
            return mt_fail(err, MT_E_INTERNAL, "a mass of %d rows", t.count);
        }
        add_term(&data, &t, at.pose, !is_held(&t, held), out);
    }
    return MT_OK;
}

/* A factor below this part of the square root of the total is rounding of its sum. */
static const double ROUNDING = 64.0 * DBL_EPSILON;

void mt_base_motion_participation(const mt_base_motion *b, int nq, const double *phi,
                                  double *gamma)
{
    for (int k = 0; k < b->n; k++) {
        const double own = mt_dot(nq, phi, b->momentum + ((ptrdiff_t)k * nq));
        gamma[k] = fabs(own) <= ROUNDING * sqrt(fmax(b->total[k], 0.0)) ? 0.0 : own;
    }
}
