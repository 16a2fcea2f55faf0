/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Energies of a mode by body and by spring. Along a direction of a body the energy is the
 * product of two linear forms,
 *     q = (g . phi) (h . M phi),
 * g of the motion and h of the momentum, each of six numbers on the body's states: with the arm
 * r and an axis e, as e . (omega x r) = omega . (r x e),
 *     along e:   g = (e, r x e),   h = (e, 0)
 *     about e:   g = (0, e),       h = (r x e, e)      (L - r x p) . e = L . e + p . (r x e).
 *
 * Arm and axes are carried by the body: r = R a with a from the centre to the point as drawn,
 * e = R u with u from the moments of inertia J as drawn; with the turn theta' of the body by an
 * input,
 *     r' = theta' x r + R a',   e' = theta' x e + R u',
 *     principal:     J u_i = j_i u_i,   u_i' = sum_k u_k (u_k . J' u_i) / (j_i - j_k)
 *     torque roll:   u_1 = d / |d|, J d = t,   d' = -J^-1 J' d.
 */
#include "mechanics/energy_share.h"

#include "mechanics/linear_priv.h"

#include <math.h>
#include <string.h>

#include "base/number.h"
#include "linalg/dense.h"
#include "mechanics/products.h"
#include "mechanics/tangent.h"

#define NAME(id, name) name,
const char *const mt_energy_axes_names[] = {MT_ENERGY_AXES_LIST(NAME)};
#undef NAME
const char *const mt_energy_directions[] = {"x", "y", "z", "rx", "ry", "rz"};

/* Owners */

/* Bodies of the system that a link has. */
static int bodies_of_link(const mt_link *link)
{
    return link->kind == MT_LINK_BEAM ? link->elements + 1 : link->elements;
}

static mt_status find_bodies(const mt_system *sys, mt_arena *mem, mt_energy_owners *out,
                             mt_err *err)
{
    const mt_model *const model = sys->model;
    int at = 0;
    out->bodies = mt_arena_alloc(mem, (size_t)model->n_bodies + (size_t)model->n_links,
                                 sizeof *out->bodies);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < model->n_bodies; i++) {
        const mt_body *const b = &model->bodies[i];
        if (mt_model_present(&b->in, sys->configuration)) {
            out->bodies[out->n_bodies++] =
                (mt_energy_owner){.name = b->name.s, .first = at++, .count = 1};
        }
    }
    for (int i = 0; i < model->n_links; i++) {
        const mt_link *const l = &model->links[i];
        if (mt_model_present(&l->in, sys->configuration)) {
            const int count = bodies_of_link(l);
            out->bodies[out->n_bodies++] =
                (mt_energy_owner){.name = l->name.s, .first = at, .count = count, .link = true};
            at += count;
        }
    }
    return MT_OK;
}

/* The link whose element or hinge a spring of the system is, by its name ("beam.e3",
 * "beam.k1"); NULL: a spring or a joint of the model. */
static const mt_link *link_of_spring(const mt_system *sys, const mt_spring_def *s)
{
    for (int i = 0; i < sys->model->n_links; i++) {
        const char *const name = sys->model->links[i].name.s;
        const size_t length = strlen(name);
        if (strncmp(s->name, name, length) == 0 && s->name[length] == '.') {
            return &sys->model->links[i];
        }
    }
    return NULL;
}

/* The spring of the model that a spring of the system is part of; NULL: an element's. */
static const mt_spring *spring_of(const mt_system *sys, const mt_spring_def *s)
{
    for (int i = 0; i < sys->model->n_springs; i++) {
        if (sys->model->springs[i].name.s == s->name) {
            return &sys->model->springs[i];
        }
    }
    return NULL;
}

static mt_status find_springs(const mt_system *sys, mt_arena *mem, mt_energy_owners *out,
                              mt_err *err)
{
    out->springs = mt_arena_alloc(mem, (size_t)sys->n_springs, sizeof *out->springs);
    for (int i = 0; i < sys->n_springs && out->springs != NULL; i++) {
        const mt_spring_def *const s = &sys->springs[i];
        const mt_spring *const spring = spring_of(sys, s);
        const mt_link *const link = spring == NULL ? link_of_spring(sys, s) : NULL;
        const char *const name = spring != NULL ? spring->name.s
                                 : link != NULL ? link->name.s
                                                : s->name;
        mt_energy_owner *const last =
            out->n_springs > 0 ? &out->springs[out->n_springs - 1] : NULL;
        if (s->damper) {
            continue;
        }
        if (last != NULL && last->name == name && last->first + last->count == i) {
            last->count++;
            continue;
        }
        out->springs[out->n_springs++] =
            (mt_energy_owner){.name = name,
                              .first = i,
                              .count = 1,
                              .link = link != NULL,
                              .bushing = spring != NULL && spring->type == MT_SPRING_BUSHING};
    }
    return mt_arena_check(mem, err);
}

mt_status mt_energy_owners_find(const mt_system *sys, mt_arena *mem, mt_energy_owners *out,
                                mt_err *err)
{
    *out = (mt_energy_owners){.n_bodies = 0};
    MT_TRY(find_bodies(sys, mem, out, err));
    return find_springs(sys, mem, out, err);
}

int mt_energy_owner_named(int n, const mt_energy_owner *owners, const char *name)
{
    for (int i = 0; i < n; i++) {
        if (strcmp(owners[i].name, name) == 0) {
            return i;
        }
    }
    return MT_ABSENT;
}

/* Parts */

static mt_status point_numbers(const mt_model *model, int configuration, int point,
                               mt_arena *mem, mt_numbers *out, mt_err *err)
{
    mt_number numbers[3];
    int *const all = mt_arena_int(mem, (size_t)model->n_parameters);
    int n = 0;
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < model->n_parameters; i++) {
        all[i] = i;
    }
    for (int i = 0; i < model->dimension; i++) {
        numbers[n++] = model->nums[model->points[point].x[i]];
    }
    return mt_numbers_new(model, configuration, model->n_parameters, all, n, numbers, mem, out,
                          err);
}

mt_status mt_energy_part_init(const mt_system *sys, mt_energy_kind kind,
                              const mt_energy_owner *owner, int direction,
                              const mt_energy_about *about, mt_arena *mem, mt_energy_part *out,
                              mt_err *err)
{
    *out = (mt_energy_part){.kind = kind, .direction = direction};
    if (owner != NULL) {
        out->first = owner->first;
        out->count = owner->count;
    }
    if (about == NULL || owner == NULL || owner->link) {
        return MT_OK;
    }
    out->axes = about->axes;
    out->pointed = kind == MT_ENERGY_MOTION && about->point != MT_ABSENT;
    return out->pointed ? point_numbers(sys->model, sys->configuration, about->point, mem,
                                        &out->point, err)
                        : MT_OK;
}

/* Small vectors; matrices are column-major, 3 x 3. */

static double dot3(const double *a, const double *b)
{
    return (a[0] * b[0]) + (a[1] * b[1]) + (a[2] * b[2]);
}

static void times3(const double *m, const double *v, double *out)
{
    for (int i = 0; i < 3; i++) {
        out[i] = (m[i] * v[0]) + (m[3 + i] * v[1]) + (m[6 + i] * v[2]);
    }
}

/* v / |v|, and its derivative for that of v. */
static void unit3(double v[3], double dv[3])
{
    const double length = sqrt(dot3(v, v));
    const double along = dot3(v, dv) / (length * length);
    for (int i = 0; i < 3; i++) {
        dv[i] = (dv[i] - (along * v[i])) / length;
        v[i] /= length;
    }
}

/* Axes as drawn. */

/* Moments of inertia J of body b as drawn, along the global axes, and their derivative by input
 * p (-1: none). False: it has none. */
static bool inertia_of(mt_linear *lin, int b, int p, double j[9], double dj[9])
{
    const mt_system *const sys = lin->sys;
    bool any = false;
    memset(j, 0, 9 * sizeof *j);
    memset(dj, 0, 9 * sizeof *dj);
    lin->dual.input = p;
    mt_data_vecs(&lin->dual);
    for (int i = 0; i < sys->n_inertias; i++) {
        const mt_inertia_def *const d = &sys->inertias[i];
        if (d->kind != MT_INERTIA_ROTATION || d->body[0] != b) {
            continue;
        }
        const mt_cx c = mt_data_scalar(&lin->dual, d->coefficient, 0.0);
        const mt_cx *const u = lin->dual.vec[d->dir[0]];
        const mt_cx *const v = lin->dual.vec[d->dir[1]];
        for (int k = 0; k < 9; k++) {
            const mt_cx both = cx_mul(u[k % 3], v[k / 3]) + cx_mul(v[k % 3], u[k / 3]);
            const mt_cx term = cx_mul(c, 0.5 * both);
            j[k] += creal(term);
            dj[k] += p < 0 ? 0.0 : cx_derivative(term);
        }
        any = true;
    }
    return any;
}

/* Moments closer than this, relative to their sum, are equal: rounding decides their axes. */
static const double EQUAL_MOMENTS = 1e-10;

/* Columns of u in the order next to x, y, z. */
static void order_axes(double u[9], double moments[3])
{
    static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                     {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    int best = 0;
    double most = -1.0;
    double was[9];
    const double had[3] = {moments[0], moments[1], moments[2]};
    memcpy(was, u, sizeof was);
    for (int o = 0; o < 6; o++) {
        double sum = 0.0;
        for (int i = 0; i < 3; i++) {
            const double part = u[i + (3 * orders[o][i])];
            sum += part * part;
        }
        best = mt_exceeds(sum, most) ? o : best;
        most = fmax(sum, most);
    }
    for (int i = 0; i < 3; i++) {
        memcpy(u + (ptrdiff_t)(3 * i), was + (ptrdiff_t)(3 * orders[best][i]),
               sizeof(double[3]));
        moments[i] = had[orders[best][i]];
    }
}

static mt_status principal_axes(mt_linear *lin, int b, const double j[9], const double dj[9],
                                double u[9], double du[9], mt_err *err)
{
    double moments[3];
    memcpy(u, j, 9 * sizeof *u);
    memset(du, 0, 9 * sizeof *du);
    MT_TRY(mt_eig_sym(3, u, moments, true, &lin->scratch, err));
    order_axes(u, moments);
    const double size = EQUAL_MOMENTS * (fabs(j[0]) + fabs(j[4]) + fabs(j[8]));
    const double turning =
        EQUAL_MOMENTS * sqrt(dot3(dj, dj) + dot3(dj + 3, dj + 3) + dot3(dj + 6, dj + 6));
    for (int i = 0; i < 3; i++) {
        double way[3];
        times3(dj, u + (ptrdiff_t)(3 * i), way);
        for (int k = 0; k < 3; k++) {
            const double gap = moments[i] - moments[k];
            const double part = k == i ? 0.0 : dot3(u + (ptrdiff_t)(3 * k), way);
            if (!(fabs(part) > turning)) {
                continue;
            }
            if (!(fabs(gap) > size)) {
                return mt_fail(err, MT_E_DOMAIN,
                               "two principal moments of inertia of \"%s\" are equal: their "
                               "axes have no derivative",
                               lin->sys->bodies[b].name);
            }
            for (int x = 0; x < 3; x++) {
                du[x + (3 * i)] += u[x + (3 * k)] * part / gap;
            }
        }
    }
    return MT_OK;
}

/* J d = t and d' = -J^-1 J' d; the axes across are those next to the other global ones. */
static mt_status roll_axes(mt_linear *lin, int b, int axis, const double j[9],
                           const double dj[9], double u[9], double du[9], mt_err *err)
{
    double d[3] = {0.0, 0.0, 0.0};
    double dd[3];
    double factor[9];
    double rcond = 0.0;
    d[axis] = 1.0;
    memcpy(factor, j, sizeof factor);
    mt_status rc = mt_lu_solve(3, factor, 1, d, &rcond, &lin->scratch, err);
    times3(dj, d, dd);
    memcpy(factor, j, sizeof factor);
    rc = rc == MT_OK ? mt_lu_solve(3, factor, 1, dd, &rcond, &lin->scratch, err) : rc;
    if (rc == MT_E_SINGULAR) {
        return mt_fail(err, MT_E_DOMAIN,
                       "\"%s\" has a direction without moment of inertia, and so no torque "
                       "roll axis",
                       lin->sys->bodies[b].name);
    }
    MT_TRY(rc);
    for (int i = 0; i < 3; i++) {
        dd[i] = -dd[i];
    }
    unit3(d, dd);
    const int next = (axis + 1) % 3;
    double v[3];
    double dv[3];
    for (int i = 0; i < 3; i++) {
        v[i] = (i == next ? 1.0 : 0.0) - (d[next] * d[i]);
        dv[i] = -(dd[next] * d[i]) - (d[next] * dd[i]);
    }
    unit3(v, dv);
    double turn[3];
    const ptrdiff_t last = (ptrdiff_t)3 * ((axis + 2) % 3);
    memcpy(u + (ptrdiff_t)(3 * axis), d, sizeof d);
    memcpy(du + (ptrdiff_t)(3 * axis), dd, sizeof dd);
    memcpy(u + (ptrdiff_t)(3 * next), v, sizeof v);
    memcpy(du + (ptrdiff_t)(3 * next), dv, sizeof dv);
    mt_cross3(d, v, u + last);
    mt_cross3(dd, v, du + last);
    mt_cross3(d, dv, turn);
    for (int i = 0; i < 3; i++) {
        du[last + i] += turn[i];
    }
    return MT_OK;
}

/* Axes as drawn, columns of u, and their derivative by input p (-1: none). */
static mt_status drawn_axes(mt_linear *lin, const mt_energy_part *part, int b, int p,
                            double u[9], double du[9], mt_err *err)
{
    double j[9];
    double dj[9];
    memset(u, 0, 9 * sizeof *u);
    memset(du, 0, 9 * sizeof *du);
    u[0] = 1.0;
    u[4] = 1.0;
    u[8] = 1.0;
    if (part->axes == MT_ENERGY_AXES_GLOBAL || lin->sys->dimension == 2 ||
        !inertia_of(lin, b, p, j, dj)) {
        return MT_OK;
    }
    return part->axes == MT_ENERGY_AXES_PRINCIPAL
               ? principal_axes(lin, b, j, dj, u, du, err)
               : roll_axes(lin, b, (int)part->axes - (int)MT_ENERGY_AXES_TORQUE_ROLL_X, j, dj,
                           u, du, err);
}

/* The arm to the point as drawn, and its derivative by input p (-1: none). */
static mt_status drawn_arm(mt_linear *lin, const mt_energy_part *part, int b, int p,
                           double a[3], double da[3], mt_err *err)
{
    const mt_system *const sys = lin->sys;
    const size_t n = (size_t)sys->model->n_parameters;
    const mt_program *const program = &part->point.program;
    memset(a, 0, 3 * sizeof *a);
    memset(da, 0, 3 * sizeof *da);
    if (!part->pointed) {
        return MT_OK;
    }
    double *const at = mt_arena_f64(&lin->scratch, n, 1);
    double *const value = mt_arena_f64(&lin->scratch, (size_t)program->count, 1);
    double *const grad = mt_arena_f64(&lin->scratch, (size_t)program->count, n);
    MT_TRY(mt_arena_check(&lin->scratch, err));
    for (size_t k = 0; k < n; k++) {
        at[k] = lin->value[sys->parameters[k]];
    }
    MT_TRY(p < 0 ? mt_program_eval(program, at, value, NULL, err)
                 : mt_program_gradient(program, at, value, grad, NULL, err));
    for (int i = 0; i < part->point.n; i++) {
        const mt_node node = part->point.nodes[i];
        const mt_node centre = sys->vecs[sys->bodies[b].centre].node[i];
        a[i] = value[node] - lin->value[centre];
        for (size_t k = 0; k < n && p >= 0; k++) {
            const double by = grad[((size_t)node * n) + k];
            da[i] += by == 0.0 ? 0.0 : by * mt_linear_slope(lin, sys->parameters[k], p);
        }
        da[i] -= p < 0 ? 0.0 : mt_linear_slope(lin, centre, p);
    }
    return MT_OK;
}

/* Arm and axes of a body at the position. */
typedef struct frame {
    double r[3];
    double e[9];
} frame;

/* out = R v, dout = theta' x R v + R v'. */
static void turn_with(const double rotation[9], const double turn[3], const double *v,
                      const double *dv, double *out, double *dout)
{
    double moved[3];
    times3(rotation, v, out);
    times3(rotation, dv, dout);
    mt_cross3(turn, out, moved);
    for (int i = 0; i < 3; i++) {
        dout[i] += moved[i];
    }
}

static mt_status frame_of(mt_linear *lin, const mt_energy_part *part, int b, int p, frame *f,
                          frame *df, mt_err *err)
{
    double a[3];
    double da[3];
    double u[9];
    double du[9];
    double rotation[9];
    double turn[3] = {0.0, 0.0, 0.0};
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    if (part->axes == MT_ENERGY_AXES_GLOBAL && !part->pointed) {
        *f = (frame){.e = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}};
        *df = (frame){.r = {0.0}};
        return MT_OK;
    }
    MT_TRY(drawn_arm(lin, part, b, p, a, da, err));
    MT_TRY(drawn_axes(lin, part, b, p, u, du, err));
    mt_arena_rewind(&lin->scratch, mark);
    for (int k = 0; k < 9; k++) {
        rotation[k] = creal(lin->position.at.pose[b].r[k]);
    }
    if (p >= 0 && lin->tangent != NULL && lin->tangent[p].moved != NULL) {
        double motion[6];
        mt_pose_motion(lin->sys, b, lin->tangent[p].moved, motion);
        memcpy(turn, motion + 3, sizeof turn);
    }
    turn_with(rotation, turn, a, da, f->r, df->r);
    for (int k = 0; k < 9; k += 3) {
        if (part->axes == MT_ENERGY_AXES_GLOBAL) {
            memcpy(f->e + k, u + k, sizeof(double[3]));
            memcpy(df->e + k, du + k, sizeof(double[3]));
        } else {
            turn_with(rotation, turn, u + k, du + k, f->e + k, df->e + k);
        }
    }
    return MT_OK;
}

/* g and h of a direction, and their derivatives. */
typedef struct forms {
    double g[6];
    double h[6];
    double dg[6];
    double dh[6];
} forms;

static void forms_of(const frame *f, const frame *df, int direction, forms *out)
{
    const double *const e = f->e + (ptrdiff_t)(3 * (direction % 3));
    const double *const de = df->e + (ptrdiff_t)(3 * (direction % 3));
    double arm[3];
    double darm[3];
    double turn[3];
    mt_cross3(f->r, e, arm);
    mt_cross3(df->r, e, darm);
    mt_cross3(f->r, de, turn);
    *out = (forms){.g = {0.0}};
    for (int i = 0; i < 3; i++) {
        darm[i] += turn[i];
        if (direction < 3) {
            out->g[i] = e[i];
            out->dg[i] = de[i];
            out->g[3 + i] = arm[i];
            out->dg[3 + i] = darm[i];
            out->h[i] = e[i];
            out->dh[i] = de[i];
        } else {
            out->g[3 + i] = e[i];
            out->dg[3 + i] = de[i];
            out->h[i] = arm[i];
            out->dh[i] = darm[i];
            out->h[3 + i] = e[i];
            out->dh[3 + i] = de[i];
        }
    }
}

static double dot6(const double *a, const double *b)
{
    return dot3(a, b) + dot3(a + 3, b + 3);
}

/* out += factor f on the states of body b. */
static void add_on_body(const mt_system *sys, int b, double factor, const double f[6],
                        double *out)
{
    for (int k = 0; k < 6; k++) {
        if (sys->bodies[b].dof[k] >= 0) {
            out[sys->bodies[b].dof[k]] += factor * f[k];
        }
    }
}

/* Energies of motion */

static mt_status motion_value(mt_linear *lin, const mt_energy_part *part, const double *phi,
                              const double *w, double *q, double *gradient, mt_err *err)
{
    const mt_system *const sys = lin->sys;
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    const size_t nq = (size_t)sys->nq;
    double *const momentum = mt_arena_f64(&lin->scratch, gradient == NULL ? 0 : nq, 1);
    const int first = part->direction < 0 ? 0 : part->direction;
    const int end = part->direction < 0 ? MT_ENERGY_DIRECTIONS : first + 1;
    mt_status rc = mt_arena_check(&lin->scratch, err);
    for (int b = part->first; b < part->first + part->count && rc == MT_OK; b++) {
        frame f;
        frame df;
        double v[6];
        double p[6];
        rc = frame_of(lin, part, b, -1, &f, &df, err);
        mt_pose_motion(sys, b, phi, v);
        mt_pose_motion(sys, b, w, p);
        for (int k = first; k < end && rc == MT_OK; k++) {
            forms l;
            forms_of(&f, &df, k, &l);
            const double way = dot6(l.g, v);
            const double impulse = dot6(l.h, p);
            *q += way * impulse;
            if (gradient != NULL) {
                add_on_body(sys, b, impulse, l.g, gradient);
                add_on_body(sys, b, way, l.h, momentum);
            }
        }
    }
    if (rc == MT_OK && gradient != NULL) {
        mt_linear_states_product(lin, MT_MATRIX_MASS, 1.0, momentum, gradient);
    }
    mt_arena_rewind(&lin->scratch, mark);
    return rc;
}

static mt_status motion_slope(mt_linear *lin, const mt_energy_part *part, int p,
                              const double *phi, const double *w, double *slope, mt_err *err)
{
    const mt_system *const sys = lin->sys;
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    double *const dw = mt_arena_f64(&lin->scratch, (size_t)sys->nq, 1);
    const int first = part->direction < 0 ? 0 : part->direction;
    const int end = part->direction < 0 ? MT_ENERGY_DIRECTIONS : first + 1;
    mt_status rc = mt_arena_check(&lin->scratch, err);
    if (rc == MT_OK) {
        mt_linear_states_slope(lin, p, MT_MATRIX_MASS, phi, dw);
    }
    for (int b = part->first; b < part->first + part->count && rc == MT_OK; b++) {
        frame f;
        frame df;
        double v[6];
        double m[6];
        double dm[6];
        rc = frame_of(lin, part, b, p, &f, &df, err);
        mt_pose_motion(sys, b, phi, v);
        mt_pose_motion(sys, b, w, m);
        mt_pose_motion(sys, b, dw, dm);
        for (int k = first; k < end && rc == MT_OK; k++) {
            forms l;
            forms_of(&f, &df, k, &l);
            *slope += (dot6(l.dg, v) * dot6(l.h, m)) +
                      (dot6(l.g, v) * (dot6(l.dh, m) + dot6(l.h, dm)));
        }
    }
    mt_arena_rewind(&lin->scratch, mark);
    return rc;
}

/* Energies of strain */

/* The component of a bushing that a measure is. */
static int component_of(const mt_measure_def *m)
{
    return m->component + (m->kind == MT_MEASURE_ROTATION ? 3 : 0);
}

/* Row i of a term, the row it is multiplied with, and its part of the energy. */
typedef struct piece {
    const mt_term *term;
    int row;
    int other;
    double half;
} piece;

/* The next row of the part's terms from term *t, row *i of it on. Rows that the joints block
 * are rounding. */
static bool next_row(const mt_linear *lin, const mt_energy_part *part, int *t, int *i,
                     piece *out)
{
    const mt_term_list *const list = &lin->list[MT_TERM_STIFFNESS];
    for (; *t < list->n_terms; ++*t, *i = 0) {
        const mt_term *const term = &list->terms[*t];
        if (term->source < part->first || term->source >= part->first + part->count) {
            continue;
        }
        const mt_spring_def *const s = &lin->sys->springs[term->source];
        for (; *i < term->count; ++*i) {
            const int row = term->first + *i;
            const bool blocked =
                mt_rows_empty(&lin->entries[MT_TERM_STIFFNESS], row) && !term->pair;
            const int component = component_of(&lin->sys->measures[s->measure[*i]]);
            if (!blocked && (part->direction < 0 || component == part->direction)) {
                *out = (piece){.term = term,
                               .row = row,
                               .other = term->pair ? (2 * term->first) + 1 - row : row,
                               .half = term->pair ? 0.5 : 1.0};
                ++*i;
                return true;
            }
        }
    }
    return false;
}

static void strain_value(const mt_linear *lin, const mt_energy_part *part, const double *phi,
                         double *q, double *gradient)
{
    const mt_rows *const rows = &lin->full[MT_TERM_STIFFNESS];
    int t = 0;
    int i = 0;
    piece k;
    while (next_row(lin, part, &t, &i, &k)) {
        const double c = k.half * lin->value[k.term->coefficient];
        const double own = mt_rows_dot(rows, k.row, phi);
        const double other = mt_rows_dot(rows, k.other, phi);
        *q += c * own * other;
        if (gradient != NULL) {
            mt_rows_axpy(rows, k.row, c * other, gradient);
            mt_rows_axpy(rows, k.other, c * own, gradient);
        }
    }
}

static double strain_slope(const mt_linear *lin, const mt_energy_part *part, int p,
                           const double *phi)
{
    const mt_rows *const rows = &lin->full[MT_TERM_STIFFNESS];
    const bool moves = lin->tangent != NULL && lin->tangent[p].moves;
    const mt_rows *const drows = moves ? &lin->tangent[p].rows[MT_TERM_STIFFNESS] : NULL;
    double slope = 0.0;
    int t = 0;
    int i = 0;
    piece k;
    while (next_row(lin, part, &t, &i, &k)) {
        const double c = k.half * lin->value[k.term->coefficient];
        const double dc = k.half * mt_linear_slope(lin, k.term->coefficient, p);
        const double own = mt_rows_dot(rows, k.row, phi);
        const double other = mt_rows_dot(rows, k.other, phi);
        slope += dc * own * other;
        if (drows != NULL) {
            slope += c * ((mt_rows_dot(drows, k.row, phi) * other) +
                          (own * mt_rows_dot(drows, k.other, phi)));
        }
    }
    return slope;
}

/* Any part */

mt_status mt_energy_part_value(mt_linear *lin, const mt_energy_part *part, const double *phi,
                               const double *w, double *q, double *gradient, mt_err *err)
{
    const int nq = lin->sys->nq;
    *q = 0.0;
    if (gradient != NULL) {
        memset(gradient, 0, (size_t)nq * sizeof *gradient);
    }
    if (part->kind == MT_ENERGY_MOTION) {
        return motion_value(lin, part, phi, w, q, gradient, err);
    }
    if (part->kind == MT_ENERGY_STRAIN) {
        strain_value(lin, part, phi, q, gradient);
        return MT_OK;
    }
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    double *const force = mt_arena_f64(&lin->scratch, (size_t)nq, 1);
    MT_TRY(mt_arena_check(&lin->scratch, err));
    mt_linear_add_load(lin, 1.0, phi, force);
    *q = mt_dot(nq, phi, force);
    for (int i = 0; i < nq && gradient != NULL; i++) {
        gradient[i] = 2.0 * force[i];
    }
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}

mt_status mt_energy_part_slope(mt_linear *lin, const mt_energy_part *part, int p,
                               const double *phi, const double *w, double *slope, mt_err *err)
{
    const ptrdiff_t nq = lin->sys->nq;
    *slope = 0.0;
    MT_TRY(mt_linear_complete(lin, err));
    if (part->kind == MT_ENERGY_MOTION) {
        return motion_slope(lin, part, p, phi, w, slope, err);
    }
    if (part->kind == MT_ENERGY_STRAIN) {
        *slope = strain_slope(lin, part, p, phi);
        return MT_OK;
    }
    const bool moves = lin->tangent != NULL && lin->tangent[p].moves && lin->kg != NULL;
    for (ptrdiff_t c = 0; c < nq && moves; c++) {
        *slope += phi[c] * mt_dot((int)nq, lin->tangent[p].kg + (c * nq), phi);
    }
    return MT_OK;
}
