/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Numbers in groups of four, of which the first three are a vector: (u, ln L) of a distance,
 * (axis, 0) three times of a body, (0, angle) of an angle. Two positions differ by the largest
 * of |vector_a - vector_b| and |number_a - number_b|.
 */
#include "mechanics/forcing.h"

#include "mechanics/linear_priv.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "mechanics/tangent.h"
#include "model/model.h"

enum { GROUP = 4, AXES = 3 };

/* Of the model's length: shorter distances have this one and no direction. */
static const double LEAST_LENGTH = 1e-12;

static bool is_counted(const mt_measure_def *def)
{
    return def->kind == MT_MEASURE_DISTANCE || def->kind == MT_MEASURE_ANGLE;
}

int mt_directions_count(const mt_system *sys)
{
    int groups = AXES * sys->n_bodies;
    for (int i = 0; i < sys->n_measures; i++) {
        groups += is_counted(&sys->measures[i]) ? 1 : 0;
    }
    return GROUP * groups;
}

/* x + R s of a body's point. */
static void place_point(const mt_pose *pose, const mt_cx *s, double *out)
{
    for (int i = 0; i < AXES; i++) {
        out[i] = creal(pose->x[i]);
        for (int k = 0; k < AXES && s != NULL; k++) {
            out[i] += creal(pose->r[i + (AXES * k)]) * creal(s[k]);
        }
    }
}

static void read_distance(const mt_linear *lin, const mt_measure_def *def, double *out)
{
    const mt_pose *const poses = lin->position.at.pose;
    const mt_measure_data m = mt_data_measure(&lin->data, def);
    double ends[2][AXES];
    double square = 0.0;
    for (int k = 0; k < 2; k++) {
        place_point(mt_pose_of(poses, def->body[k]), m.point[k], ends[k]);
    }
    for (int i = 0; i < AXES; i++) {
        out[i] = ends[1][i] - ends[0][i];
        square += out[i] * out[i];
    }
    const double least = LEAST_LENGTH * lin->sys->length_m;
    const double length = fmax(sqrt(square), least);
    for (int i = 0; i < AXES; i++) {
        out[i] /= length;
    }
    out[AXES] = log(length);
}

void mt_directions_read(const mt_linear *lin, double *out)
{
    const mt_system *const sys = lin->sys;
    const mt_placement *const at = &lin->position.at;
    double *to = out;
    for (int i = 0; i < sys->n_bodies; i++) {
        for (int k = 0; k < AXES; k++, to += GROUP) {
            for (int j = 0; j < AXES; j++) {
                to[j] = creal(at->pose[i].r[j + (AXES * k)]);
            }
            to[AXES] = 0.0;
        }
    }
    for (int i = 0; i < sys->n_measures; i++) {
        if (!is_counted(&sys->measures[i])) {
            continue;
        }
        to[0] = to[1] = to[2] = 0.0;
        to[AXES] = at->turn[i];
        if (sys->measures[i].kind == MT_MEASURE_DISTANCE) {
            read_distance(lin, &sys->measures[i], to);
        }
        to += GROUP;
    }
}

double mt_directions_turn(const mt_system *sys, const double *a, const double *b)
{
    const int n = mt_directions_count(sys);
    double most = 0.0;
    for (int i = 0; i < n; i += GROUP) {
        double square = 0.0;
        for (int k = 0; k < AXES; k++) {
            square += (a[i + k] - b[i + k]) * (a[i + k] - b[i + k]);
        }
        most = fmax(most, fmax(sqrt(square), fabs(a[i + AXES] - b[i + AXES])));
    }
    return most;
}

/* Inputs and joint forces over all states. */

/* A v - t of a joint whose force is determined, in parts of t's largest entry and equations of
 * unit length. */
static const double DETERMINED = 1e-9;

/* The body whose equations give the force, and its sign: the second, or the first where that is
 * the ground. */
static int side_of(const mt_system *sys, int joint, double *sign)
{
    const int second = sys->joints[joint].body[1];
    *sign = second == MT_GROUND ? -1.0 : 1.0;
    return second == MT_GROUND ? sys->joints[joint].body[0] : second;
}

/* out += rows of the geometric stiffness of the joint's equations; true where any entry is not
 * 0. */
static bool add_geometric(const mt_linear *lin, int joint, int dof, double sign, double *out)
{
    bool any = false;
    for (int i = 0; i < lin->n_pieces && lin->kg != NULL; i++) {
        const mt_piece *const piece = &lin->pieces[i];
        if (piece->equation < 0 || lin->sys->constraints[piece->equation].joint != joint) {
            continue;
        }
        for (int r = 0; r < MT_LOCAL; r++) {
            for (int c = 0; c < MT_LOCAL && piece->dof[r] == dof; c++) {
                const double add = sign * piece->force * mt_piece_entry(piece, r, c);
                if (piece->dof[c] >= 0 && add != 0.0) {
                    out[piece->dof[c]] += add;
                    any = true;
                }
            }
        }
    }
    return any;
}

mt_status mt_linear_joint_force(mt_linear *lin, int joint, int axis, mt_arena *mem,
                                mt_joint_force *out, bool *unique, mt_err *err)
{
    const mt_system *const sys = lin->sys;
    double sign = 1.0;
    const int body = side_of(sys, joint, &sign);
    if (mt_joint_kind_of(sys->joints[joint].type)->couples || body == MT_GROUND) {
        return mt_fail(err, MT_E_USAGE, "joint \"%s\" has no bodies of its own, and no force",
                       sys->joints[joint].name);
    }
    const ptrdiff_t m = lin->m;
    const int dof = sys->bodies[body].dof[axis];
    double *const t = mt_arena_f64(mem, (size_t)m, 1);
    double *const v = mt_arena_f64(mem, (size_t)sys->nq, 1);
    double *const geometric = mt_arena_f64(mem, (size_t)sys->nq, 1);
    double *const back = mt_arena_f64(mem, (size_t)m, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (ptrdiff_t i = 0; i < m && dof >= 0; i++) {
        t[i] = sys->constraints[i].joint == joint ? sign * lin->a[i + (dof * m)] : 0.0;
    }
    MT_TRY(mt_eliminate_particular(&lin->e, t, v, &lin->scratch, err));
    memcpy(back, t, (size_t)m * sizeof *back);
    mt_gemv(false, lin->m, sys->nq, 1.0, lin->a, lin->m, v, -1.0, back);
    double size = 0.0;
    double off = 0.0;
    for (ptrdiff_t i = 0; i < m; i++) {
        size = fmax(size, lin->e.dr[i] * fabs(t[i]));
        off = fmax(off, lin->e.dr[i] * fabs(back[i]));
    }
    *unique = off <= DETERMINED * size;
    *out = (mt_joint_force){.v = v, .t = t};
    out->geometric =
        dof >= 0 && add_geometric(lin, joint, dof, sign, geometric) ? geometric : NULL;
    return MT_OK;
}

void mt_linear_shift(const mt_linear *lin, int axis, double *r)
{
    memset(r, 0, (size_t)lin->sys->nq * sizeof *r);
    for (int b = 0; b < lin->sys->n_bodies; b++) {
        if (lin->sys->bodies[b].dof[axis] >= 0) {
            r[lin->sys->bodies[b].dof[axis]] = 1.0;
        }
    }
}

static bool is_moved(const mt_linear *lin, int p)
{
    assert(lin->tangent == NULL || !lin->due);
    return lin->tangent != NULL && lin->tangent[p].moves;
}

/* What the joints block has no part in K, C and M (products.c), but the ground's motion has
 * one in its row: the joints carry that mass, and as they turn they let it go. */
static bool is_blocked(const mt_linear *lin, int row, const mt_term *t)
{
    return mt_rows_empty(&lin->entries[MT_TERM_MASS], row) && !t->pair;
}

/* A row of the masses where all bodies and the ground move by 1 along an axis. */
static double carried(const mt_linear *lin, int row, int axis)
{
    const double *const own = lin->rows[MT_TERM_MASS] + ((ptrdiff_t)row * MT_LOCAL);
    return own[axis] + own[(MT_LOCAL / 2) + axis];
}

/* Its derivative. Masses that the ground holds are bars, along whose rows translations have
 * constant parts. */
static double carried_slope(const mt_linear *lin, const mt_rows *drows, const mt_term *t,
                            int row, int axis)
{
    double sum = 0.0;
    for (int k = drows->start[row]; k < drows->start[row + 1]; k++) {
        for (int side = 0; side < (t->body[0] == t->body[1] ? 1 : 2); side++) {
            const int body = t->body[side];
            const bool along =
                body != MT_GROUND && lin->sys->bodies[body].dof[axis] == drows->index[k];
            sum += along ? drows->value[k] : 0.0;
        }
    }
    return sum;
}

/* The row that row i of a term is multiplied with. */
static int partner(const mt_term *t, int i)
{
    return t->pair ? (2 * t->first) + 1 - i : i;
}

static void add_base_rows(const mt_linear *lin, int axis, bool blocked, double *f)
{
    const mt_term_list *const list = &lin->list[MT_TERM_MASS];
    for (int i = 0; i < list->n_rows; i++) {
        const mt_term *const t = &list->terms[list->row_term[i]];
        const double way = carried(lin, partner(t, i), axis);
        if (way != 0.0 && is_blocked(lin, i, t) == blocked) {
            const double c = -lin->value[t->coefficient] * (t->pair ? 0.5 : 1.0);
            mt_rows_axpy(&lin->full[MT_TERM_MASS], i, c * way, f);
        }
    }
}

void mt_linear_base_force(const mt_linear *lin, int axis, double *f, double *reduced)
{
    add_base_rows(lin, axis, false, f);
    if (reduced != NULL) {
        mt_linear_project(lin, f, reduced);
    }
    add_base_rows(lin, axis, true, f);
}

double mt_linear_base_slope(const mt_linear *lin, int p, int axis, const double *e)
{
    const mt_term_list *const list = &lin->list[MT_TERM_MASS];
    const mt_rows *const rows = &lin->full[MT_TERM_MASS];
    const mt_rows *const drows = is_moved(lin, p) ? &lin->tangent[p].rows[MT_TERM_MASS] : NULL;
    double sum = 0.0;
    for (int i = 0; i < list->n_rows; i++) {
        const mt_term *const t = &list->terms[list->row_term[i]];
        const int other = partner(t, i);
        const double part = t->pair ? 0.5 : 1.0;
        const double way = carried(lin, other, axis);
        const double own = mt_rows_dot(rows, i, e);
        sum -= part * mt_linear_slope(lin, t->coefficient, p) * own * way;
        if (drows != NULL) {
            sum -= part * lin->value[t->coefficient] *
                   ((mt_rows_dot(drows, i, e) * way) +
                    (own * carried_slope(lin, drows, t, other, axis)));
        }
    }
    return sum;
}

void mt_linear_project(const mt_linear *lin, const double *w, double *out)
{
    mt_eliminate_project(&lin->e, w, out);
}

double mt_linear_row_dot(const mt_linear *lin, mt_term_kind kind, int row, const double *phi)
{
    return mt_rows_dot(&lin->full[kind], row, phi);
}

void mt_linear_row_add(const mt_linear *lin, mt_term_kind kind, int row, double factor,
                       double *out)
{
    mt_rows_axpy(&lin->full[kind], row, factor, out);
}

double mt_linear_row_dot_slope(const mt_linear *lin, int p, mt_term_kind kind, int row,
                               const double *phi)
{
    return is_moved(lin, p) ? mt_rows_dot(&lin->tangent[p].rows[kind], row, phi) : 0.0;
}

void mt_linear_jacobian_slope(const mt_linear *lin, int p, const double *phi, double *out)
{
    memset(out, 0, (size_t)lin->m * sizeof *out);
    if (is_moved(lin, p)) {
        mt_gemv(false, lin->m, lin->sys->nq, 1.0, lin->tangent[p].a, lin->m, phi, 0.0, out);
    }
}

double mt_linear_jacobian_contract(const mt_linear *lin, int p, const double *lambda)
{
    double sum = 0.0;
    for (ptrdiff_t j = 0; j < lin->sys->nq && is_moved(lin, p); j++) {
        sum += mt_dot(lin->m, lin->tangent[p].a + (j * lin->m), lambda + (j * lin->m));
    }
    return sum;
}

mt_status mt_linear_multipliers(mt_linear *lin, const double *w, double *lambda, mt_err *err)
{
    return mt_eliminate_multipliers(&lin->e, w, lambda, &lin->scratch, err);
}

double mt_linear_joint_slope(const mt_linear *lin, int p, int joint, int axis,
                             const double *lambda)
{
    double sign = 1.0;
    const int dof = lin->sys->bodies[side_of(lin->sys, joint, &sign)].dof[axis];
    double sum = 0.0;
    for (ptrdiff_t i = 0; i < lin->m && dof >= 0 && is_moved(lin, p); i++) {
        if (lin->sys->constraints[i].joint == joint) {
            sum += sign * lambda[i] * lin->tangent[p].a[i + ((ptrdiff_t)dof * lin->m)];
        }
    }
    return sum;
}

/* out (nq x nq) := derivative of the contribution of one joint's equations to Kg; 0 without
 * loads. */
static mt_status tangent_of_joint(mt_linear *lin, int p, int joint, double *out, mt_err *err)
{
    const mt_system *const sys = lin->sys;
    const size_t size = (size_t)sys->nq * (size_t)sys->nq;
    const mt_linear_tangent *const t = lin->tangent == NULL ? NULL : &lin->tangent[p];
    memset(out, 0, size * sizeof *out);
    if (t == NULL || t->lambda == NULL) {
        return MT_OK;
    }
    mt_lagrangian l;
    mt_placement at = lin->position.at;
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    MT_TRY(mt_lagrangian_init(&l, sys, true, &lin->scratch, err));
    mt_cx *const own = mt_arena_alloc(&lin->scratch, (size_t)sys->n_constraints, sizeof *own);
    MT_TRY(mt_arena_check(&lin->scratch, err));
    for (int i = 0; i < sys->n_constraints; i++) {
        own[i] = sys->constraints[i].joint == joint ? t->lambda[i] : 0.0;
    }
    at.pose = t->pose;
    l.slope = true;
    lin->dual.input = p;
    mt_data_vecs(&lin->dual);
    mt_lagrangian_curve(&lin->dual, &at, sys->n_constraints, own, &l);
    memcpy(out, l.h, size * sizeof *out);
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}

mt_status mt_linear_joint_geometric_slope(mt_linear *lin, int p, int joint, int axis,
                                          double *out, mt_err *err)
{
    double sign = 1.0;
    const ptrdiff_t nq = lin->sys->nq;
    const int dof = lin->sys->bodies[side_of(lin->sys, joint, &sign)].dof[axis];
    memset(out, 0, (size_t)nq * sizeof *out);
    if (dof < 0 || lin->kg == NULL) {
        return MT_OK;
    }
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    double *const h = mt_arena_f64(&lin->scratch, (size_t)nq, (size_t)nq);
    MT_TRY(mt_arena_check(&lin->scratch, err));
    MT_TRY(mt_tangent_complete(lin, err));
    MT_TRY(tangent_of_joint(lin, p, joint, h, err));
    for (ptrdiff_t c = 0; c < nq; c++) {
        out[c] = sign * h[dof + (c * nq)];
    }
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}
