/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A port is a column or a row over the states (mechanics/forcing.h); Z^T of it is that of the
 * freedoms. The force of a joint, v . (M q'' + C q' + K q - f) - geometric . q with q = Z x, is
 *     S_0 = Z^T (K v + i H v - geometric),   S_1 = Z^T C v,   S_2 = Z^T M v,   D = -v . f.
 * Modal damping ratios belong to motions that the joints allow; what they do to v is that of
 * the matrix (M Phi) F (M Phi)^T over all states.
 */
#include "response/problem.h"

#include <string.h>

#include "analysis/damping.h"
#include "linalg/dense.h"

static const char AXIS_NAMES[] = "xyz";

typedef struct build {
    mt_analysis *a;
    mt_arena *mem;
    int n;
    int nq;
    int n_in;
    int n_out;
    const mt_port *in;
    const mt_port *out;
    mt_response_ways *ways;
    double *b[MT_FORCED_POWERS];
    double *s[MT_FORCED_POWERS];
    double *s_im;
    double *d[MT_FORCED_POWERS];
    double *e[2];
    double *b_full; /* nq x n_in: the force itself, of the power below */
    int *power;     /* [n_in] */
    double *w;      /* [nq] */
} build;

static double *ensure(build *k, double **x, int rows, int columns)
{
    if (*x == NULL) {
        *x = mt_arena_f64(k->mem, (size_t)rows, (size_t)columns);
    }
    return *x;
}

/* Damping matrices of the last solve; either NULL: 0. */
static mt_status damping_of(mt_analysis *a, mt_arena *mem, double **c, double **h, mt_err *err)
{
    const size_t n = (size_t)mt_linear_freedoms(a->lin);
    bool structural = false;
    *c = mt_arena_f64(mem, n, n);
    *h = mt_arena_f64(mem, n, n);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_analysis_damping(a, *c, *h, &structural, err));
    *c = mt_max_abs((ptrdiff_t)(n * n), *c) == 0.0 ? NULL : *c;
    *h = structural ? *h : NULL;
    return MT_OK;
}

double mt_response_node(const mt_analysis *a, mt_node node)
{
    return node == MT_NO_NODE ? 0.0 : mt_linear_value(a->lin, node);
}

/* Component of a bushing that a measure is. */
static int component_of(const mt_measure_def *m)
{
    return m->component + (m->kind == MT_MEASURE_ROTATION ? 3 : 0);
}

int mt_response_force(const mt_analysis *a, const mt_port *port, mt_force_part *part)
{
    return mt_response_force_among(a->sys,
                                   mt_linear_terms(a->lin, port->kind == MT_PORT_DAMPER
                                                               ? MT_TERM_DAMPING
                                                               : MT_TERM_STIFFNESS),
                                   port, part);
}

int mt_response_force_among(const mt_system *sys, const mt_term_list *list, const mt_port *port,
                            mt_force_part *part)
{
    const mt_spring_def *const own = &sys->springs[port->index];
    int n = 0;
    for (int i = 0; i < list->n_terms; i++) {
        const mt_term *const t = &list->terms[i];
        const mt_spring_def *const s = &sys->springs[t->source];
        const bool together = s->name != NULL && strcmp(s->name, own->name) == 0;
        for (int side = 0; side < (t->pair ? 2 : 1) && together && n < MT_FORCE_PARTS; side++) {
            if (port->axis < 0 ||
                component_of(&sys->measures[s->measure[side]]) == port->axis) {
                part[n++] = (mt_force_part){.row = t->first + (t->pair ? 1 - side : 0),
                                            .term = t,
                                            .share = t->pair ? 0.5 : 1.0};
            }
        }
    }
    return n;
}

int mt_response_power(const mt_port *in)
{
    return in->kind == MT_PORT_BASE ? 2 - in->motion : 0;
}

static mt_status add_input(build *k, int i, mt_err *err)
{
    const mt_port *const port = &k->in[i];
    double *const full = k->b_full + ((ptrdiff_t)i * k->nq);
    const int power = mt_response_power(port);
    k->power[i] = power;
    double *const b = ensure(k, &k->b[power], k->n, k->n_in);
    MT_TRY(mt_arena_check(k->mem, err));
    double *const column = b + ((ptrdiff_t)i * k->n);
    if (port->kind == MT_PORT_SENSOR) {
        const int row = mt_linear_terms(k->a->lin, MT_TERM_CHANNEL)->terms[port->index].first;
        mt_linear_row_add(k->a->lin, MT_TERM_CHANNEL, row, 1.0, full);
        memcpy(column, mt_linear_row(k->a->lin, MT_TERM_CHANNEL, row),
               (size_t)k->n * sizeof *column);
        return MT_OK;
    }
    mt_linear_base_force(k->a->lin, port->index, full, column);
    return MT_OK;
}

/* Ground motion in a sensor's motion in space. */
static mt_status add_ground(build *k, int o, int row, mt_err *err)
{
    for (int i = 0; i < k->n_in; i++) {
        if (k->in[i].kind != MT_PORT_BASE) {
            continue;
        }
        const int power = k->out[o].motion - k->in[i].motion;
        double *const to =
            ensure(k, power >= 0 ? &k->d[power] : &k->e[-power - 1], k->n_out, k->n_in);
        MT_TRY(mt_arena_check(k->mem, err));
        mt_linear_shift(k->a->lin, k->in[i].index, k->w);
        to[o + ((ptrdiff_t)i * k->n_out)] =
            mt_linear_row_dot(k->a->lin, MT_TERM_CHANNEL, row, k->w);
    }
    return MT_OK;
}

static mt_status add_motion(build *k, int o, mt_err *err)
{
    const mt_port *const port = &k->out[o];
    const int row = mt_linear_terms(k->a->lin, MT_TERM_CHANNEL)->terms[port->index].first;
    double *const s = ensure(k, &k->s[port->motion], k->n, k->n_out);
    MT_TRY(mt_arena_check(k->mem, err));
    memcpy(s + ((ptrdiff_t)o * k->n), mt_linear_row(k->a->lin, MT_TERM_CHANNEL, row),
           (size_t)k->n * sizeof *s);
    return port->relative ? MT_OK : add_ground(k, o, row, err);
}

static mt_status add_spring_output(build *k, int o, mt_err *err)
{
    const mt_port *const port = &k->out[o];
    const bool damper = port->kind == MT_PORT_DAMPER;
    mt_force_part part[MT_FORCE_PARTS];
    const int n = mt_response_force(k->a, port, part);
    double *const s = ensure(k, &k->s[damper ? 1 : 0], k->n, k->n_out);
    MT_TRY(mt_arena_check(k->mem, err));
    for (int i = 0; i < n; i++) {
        const double *const own =
            mt_linear_row(k->a->lin, damper ? MT_TERM_DAMPING : MT_TERM_STIFFNESS, part[i].row);
        const double c = part[i].share * mt_linear_value(k->a->lin, part[i].term->coefficient);
        const double loss = damper ? 0.0 : mt_response_node(k->a, part[i].term->loss);
        mt_axpy(k->n, c, own, s + ((ptrdiff_t)o * k->n));
        if (loss != 0.0) {
            double *const im = ensure(k, &k->s_im, k->n, k->n_out);
            MT_TRY(mt_arena_check(k->mem, err));
            mt_axpy(k->n, c * loss, own, im + ((ptrdiff_t)o * k->n));
        }
    }
    return MT_OK;
}

/* Row of output o in *s: += Z^T of w. */
static mt_status add_projected_row(build *k, int o, double **s, const double *w, mt_err *err)
{
    double *const row = mt_arena_f64(k->mem, (size_t)k->n, 1);
    double *const to = ensure(k, s, k->n, k->n_out);
    MT_TRY(mt_arena_check(k->mem, err));
    mt_linear_project(k->a->lin, w, row);
    mt_axpy(k->n, 1.0, row, to + ((ptrdiff_t)o * k->n));
    return MT_OK;
}

/* Z^T (K + i H) v, Z^T C v and Z^T M v of one joint's motion v. */
static mt_status resist(build *k, int o, const mt_joint_force *force, mt_err *err)
{
    const mt_damping_def *const d = &k->a->sys->damping;
    double *const kv = mt_arena_f64(k->mem, (size_t)k->nq, 1);
    double *const mv = mt_arena_f64(k->mem, (size_t)k->nq, 1);
    double *const cv = mt_arena_f64(k->mem, (size_t)k->nq, 1);
    double *const hv = mt_arena_f64(k->mem, (size_t)k->nq, 1);
    double *const reduced = mt_arena_f64(k->mem, (size_t)k->n, 1);
    MT_TRY(mt_arena_check(k->mem, err));
    mt_linear_states_product(k->a->lin, MT_MATRIX_STIFFNESS, 1.0, force->v, kv);
    mt_linear_states_product(k->a->lin, MT_MATRIX_MASS, 1.0, force->v, mv);
    mt_linear_states_product(k->a->lin, MT_MATRIX_DAMPERS, 1.0, force->v, cv);
    mt_linear_states_product(k->a->lin, MT_MATRIX_LOSS, 1.0, force->v, hv);
    mt_axpy(k->nq, mt_response_node(k->a, d->mass), mv, cv);
    mt_axpy(k->nq, mt_response_node(k->a, d->stiffness), kv, cv);
    if (force->geometric != NULL) {
        mt_axpy(k->nq, -1.0, force->geometric, kv);
    }
    MT_TRY(add_projected_row(k, o, &k->s[0], kv, err));
    MT_TRY(add_projected_row(k, o, &k->s[1], cv, err));
    MT_TRY(add_projected_row(k, o, &k->s[2], mv, err));
    MT_TRY(add_projected_row(k, o, &k->s_im, hv, err));
    mt_linear_project(k->a->lin, mv, reduced);
    return mt_analysis_ratio_force(k->a, reduced, k->s[1] + ((ptrdiff_t)o * k->n), err);
}

static mt_status add_joint(build *k, int o, mt_err *err)
{
    const mt_port *const port = &k->out[o];
    mt_joint_force *const force = &k->ways->joint[o];
    bool unique = false;
    MT_TRY(
        mt_linear_joint_force(k->a->lin, port->index, port->axis, k->mem, force, &unique, err));
    if (!unique) {
        return mt_fail(err, MT_E_USAGE,
                       "joint \"%s\" is redundant with others along %c: its force there is "
                       "not determined",
                       k->a->sys->joints[port->index].name, AXIS_NAMES[port->axis]);
    }
    MT_TRY(resist(k, o, force, err));
    for (int i = 0; i < k->n_in; i++) {
        double *const d = ensure(k, &k->d[k->power[i]], k->n_out, k->n_in);
        MT_TRY(mt_arena_check(k->mem, err));
        d[o + ((ptrdiff_t)i * k->n_out)] =
            -mt_dot(k->nq, force->v, k->b_full + ((ptrdiff_t)i * k->nq));
    }
    return MT_OK;
}

static mt_status add_output(build *k, int o, mt_err *err)
{
    switch (k->out[o].kind) {
    case MT_PORT_SENSOR:
        return add_motion(k, o, err);
    case MT_PORT_SPRING:
    case MT_PORT_DAMPER:
        return add_spring_output(k, o, err);
    case MT_PORT_JOINT:
        return add_joint(k, o, err);
    case MT_PORT_BASE:
        break;
    }
    return mt_fail(err, MT_E_INTERNAL, "the ground is not an output");
}

/* Refuses a position that is not a stable equilibrium. */
static mt_status admit(const mt_modes *m, mt_err *err)
{
    if (m->n_unstable > 0) {
        return mt_fail(err, MT_E_EQUILIBRIUM,
                       "the position is unstable: nothing vibrates about it");
    }
    if (m->n_undecided > 0) {
        return mt_fail(
            err, MT_E_EQUILIBRIUM,
            "rounding hides whether the position is stable, so no response can be trusted");
    }
    return MT_OK;
}

static mt_status fill_problem(build *k, mt_err *err)
{
    k->b_full = mt_arena_f64(k->mem, (size_t)k->nq, (size_t)k->n_in);
    k->power = mt_arena_int(k->mem, (size_t)k->n_in);
    k->w = mt_arena_f64(k->mem, (size_t)k->nq, 1);
    k->ways->joint = mt_arena_alloc(k->mem, (size_t)k->n_out, sizeof *k->ways->joint);
    MT_TRY(mt_arena_check(k->mem, err));
    MT_TRY(damping_of(k->a, k->mem, &k->ways->c, &k->ways->h, err));
    for (int i = 0; i < k->n_in; i++) {
        MT_TRY(add_input(k, i, err));
    }
    for (int o = 0; o < k->n_out; o++) {
        MT_TRY(add_output(k, o, err));
    }
    return MT_OK;
}

mt_status mt_response_problem(mt_analysis *a, const mt_port_set *ports, mt_arena *mem,
                              mt_forced *f, mt_response_ways *ways, mt_err *err)
{
    const mt_reduced r = mt_linear_reduced(a->lin);
    build k = {.a = a,
               .mem = mem,
               .n = r.n,
               .nq = a->sys->nq,
               .n_in = ports->n_in,
               .n_out = ports->n_out,
               .in = ports->in,
               .out = ports->out,
               .ways = ways};
    MT_TRY(admit(&a->modes, err));
    MT_TRY(fill_problem(&k, err));
    *f = (mt_forced){.n = r.n,
                     .k = r.k,
                     .m = r.m,
                     .c = ways->c,
                     .h = ways->h,
                     .n_in = k.n_in,
                     .n_out = k.n_out,
                     .s_im = k.s_im,
                     .e = {k.e[0], k.e[1]}};
    for (int p = 0; p < MT_FORCED_POWERS; p++) {
        f->b[p] = k.b[p];
        f->s[p] = k.s[p];
        f->d[p] = k.d[p];
    }
    return MT_OK;
}
