/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Over all states, with the equations of the joints beside them:
 *     [D A^T; A 0] (q; l) = (f; 0),        H = sigma . q - t . l + d,
 *     [D A^T; A 0] (e; m) = (sigma; -t),   the adjoint,
 *     dH = d(sigma) . q - d(t) . l + e . df - e . dD q - (dA e) . l - m . (dA q),
 * a d being the derivative with respect to one input, geometry and equilibrium with it. With x
 * and y of the reduced problem q = Z x and e = Z y - v, A v = t; l and m balance what is left.
 * d of the ground's own motion does not depend on any input: a rigid translation moves every
 * sensor by 1.
 */
#include "response/slopes.h"

#include <math.h>
#include <string.h>

#include "linalg/dense.h"
#include "mechanics/independence.h"

/* A complex vector. */
typedef struct pair {
    double *part[2];
} pair;

/* One input or output at work. */
typedef struct side {
    pair states; /* q, or e */
    pair forces; /* l, or m */
} side;

typedef struct work {
    const mt_slope_problem *p;
    mt_linear *lin;
    mt_arena *mem;
    int nq;
    int m;
    double w;
    double complex power[3]; /* s^k */
    side *in;                /* [n_in] */
    side *out;               /* [n_out] */
    double *shift;           /* [nq] */
} work;

static pair new_pair(mt_arena *mem, int n)
{
    return (pair){{mt_arena_f64(mem, (size_t)n, 1), mt_arena_f64(mem, (size_t)n, 1)}};
}

/* Terms of D over the states with their factors: K + s C + s^2 M. */
static const mt_term_kind KINDS[3] = {MT_TERM_STIFFNESS, MT_TERM_DAMPING, MT_TERM_MASS};

/* to += f x, f complex, x real. */
static void add_real(int n, double complex f, const double *x, pair *to)
{
    mt_axpy(n, creal(f), x, to->part[0]);
    mt_axpy(n, cimag(f), x, to->part[1]);
}

/* to -= D x over the states. */
static mt_status subtract_d(work *k, const pair *x, pair *to, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(k->mem);
    double *const product = mt_arena_f64(k->mem, (size_t)k->nq, 1);
    MT_TRY(mt_arena_check(k->mem, err));
    for (int kind = 0; kind < 3; kind++) {
        for (int part = 0; part < 2; part++) {
            memset(product, 0, (size_t)k->nq * sizeof *product);
            mt_linear_whole_product(k->lin, KINDS[kind], x->part[part], product);
            add_real(k->nq, -k->power[kind] * cx_pair(1 - part, part), product, to);
        }
    }
    mt_arena_rewind(k->mem, mark);
    return MT_OK;
}

/* What the joints carry: A^T forces ~ w. */
static mt_status balance(work *k, const pair *w, pair *forces, mt_err *err)
{
    for (int part = 0; part < 2; part++) {
        MT_TRY(mt_linear_multipliers(k->lin, w->part[part], forces->part[part], err));
    }
    return MT_OK;
}

/* states := Z x. */
static mt_status expand(work *k, const double complex *x, pair *states, mt_err *err)
{
    const int n = mt_linear_freedoms(k->lin);
    const mt_arena_mark mark = mt_arena_get_mark(k->mem);
    double *const part = mt_arena_f64(k->mem, (size_t)n, 1);
    MT_TRY(mt_arena_check(k->mem, err));
    for (int i = 0; i < n; i++) {
        part[i] = creal(x[i]);
    }
    mt_linear_expand(k->lin, 1, part, states->part[0]);
    for (int i = 0; i < n; i++) {
        part[i] = cimag(x[i]);
    }
    mt_linear_expand(k->lin, 1, part, states->part[1]);
    mt_arena_rewind(k->mem, mark);
    return MT_OK;
}

static int channel_row(const work *k, const mt_port *port)
{
    return mt_linear_terms(k->lin, MT_TERM_CHANNEL)->terms[port->index].first;
}

static mt_status open_input(work *k, int i, const double complex *x, mt_err *err)
{
    const mt_port *const port = &k->p->ports->in[i];
    side *const s = &k->in[i];
    *s = (side){new_pair(k->mem, k->nq), new_pair(k->mem, k->m)};
    pair w = new_pair(k->mem, k->nq);
    double *const f = mt_arena_f64(k->mem, (size_t)k->nq, 1);
    MT_TRY(mt_arena_check(k->mem, err));
    MT_TRY(expand(k, x, &s->states, err));
    if (port->kind == MT_PORT_BASE) {
        mt_linear_shift(k->lin, port->index, k->shift);
        mt_linear_states_product(k->lin, MT_TERM_MASS, -1.0, k->shift, f);
    } else {
        mt_linear_row_add(k->lin, MT_TERM_CHANNEL, channel_row(k, port), 1.0, f);
    }
    add_real(k->nq, k->power[port->kind == MT_PORT_BASE ? 2 - port->motion : 0], f, &w);
    MT_TRY(subtract_d(k, &s->states, &w, err));
    return balance(k, &w, &s->forces, err);
}

/* Row, kind of terms and factor of an output that is one row's. */
static double complex row_of(const work *k, const mt_port *port, int *row, mt_term_kind *kind,
                             const mt_term **term)
{
    *term = NULL;
    if (port->kind == MT_PORT_SENSOR) {
        *kind = MT_TERM_CHANNEL;
        *row = channel_row(k, port);
        return k->power[port->motion];
    }
    *kind = port->kind == MT_PORT_DAMPER ? MT_TERM_DAMPING : MT_TERM_STIFFNESS;
    return mt_response_spring(k->p->a, port, row, term) *
           k->power[port->kind == MT_PORT_DAMPER ? 1 : 0];
}

static mt_status open_output(work *k, int o, const double complex *y, mt_err *err)
{
    const mt_port *const port = &k->p->ports->out[o];
    side *const s = &k->out[o];
    *s = (side){new_pair(k->mem, k->nq), new_pair(k->mem, k->m)};
    pair w = new_pair(k->mem, k->nq);
    double *const sigma = mt_arena_f64(k->mem, (size_t)k->nq, 1);
    MT_TRY(mt_arena_check(k->mem, err));
    MT_TRY(expand(k, y, &s->states, err));
    if (port->kind == MT_PORT_JOINT) {
        mt_axpy(k->nq, -1.0, k->p->ways->joint[o].v, s->states.part[0]);
    } else {
        int row = -1;
        mt_term_kind kind = MT_TERM_CHANNEL;
        const mt_term *term = NULL;
        const double complex factor = row_of(k, port, &row, &kind, &term);
        if (row >= 0) {
            mt_linear_row_add(k->lin, kind, row, 1.0, sigma);
            add_real(k->nq, factor, sigma, &w);
        }
    }
    MT_TRY(subtract_d(k, &s->states, &w, err));
    return balance(k, &w, &s->forces, err);
}

/* a . b, both complex; no conjugate. */
static double complex dot(int n, const pair *a, const pair *b)
{
    return cx_pair(mt_dot(n, a->part[0], b->part[0]) - mt_dot(n, a->part[1], b->part[1]),
                   mt_dot(n, a->part[0], b->part[1]) + mt_dot(n, a->part[1], b->part[0]));
}

/* e . dD q. */
static double complex between(const work *k, int p, const pair *e, const pair *q)
{
    double complex sum = 0.0;
    for (int kind = 0; kind < 3; kind++) {
        double part[2][2];
        for (int at = 0; at < 4; at++) {
            part[at / 2][at % 2] = mt_linear_between_slope(k->lin, p, KINDS[kind],
                                                           e->part[at / 2], q->part[at % 2]);
        }
        sum += k->power[kind] * cx_pair(part[0][0] - part[1][1], part[0][1] + part[1][0]);
    }
    return sum;
}

/* A real function of both parts. */
static double complex row_slope(const work *k, int p, mt_term_kind kind, int row, const pair *x)
{
    return cx_pair(mt_linear_row_dot_slope(k->lin, p, kind, row, x->part[0]),
                   mt_linear_row_dot_slope(k->lin, p, kind, row, x->part[1]));
}

/* e . df. */
static double complex force_slope(work *k, int p, int i, const pair *e)
{
    const mt_port *const port = &k->p->ports->in[i];
    if (port->kind == MT_PORT_SENSOR) {
        return row_slope(k, p, MT_TERM_CHANNEL, channel_row(k, port), e);
    }
    mt_linear_shift(k->lin, port->index, k->shift);
    const double re = mt_linear_between_slope(k->lin, p, MT_TERM_MASS, e->part[0], k->shift);
    const double im = mt_linear_between_slope(k->lin, p, MT_TERM_MASS, e->part[1], k->shift);
    return -k->power[2 - port->motion] * cx_pair(re, im);
}

/* d(sigma) . q - d(t) . l. */
static double complex output_slope(const work *k, int p, int o, const side *in)
{
    const mt_port *const port = &k->p->ports->out[o];
    if (port->kind == MT_PORT_JOINT) {
        return -cx_pair(
            mt_linear_joint_slope(k->lin, p, port->index, port->axis, in->forces.part[0]),
            mt_linear_joint_slope(k->lin, p, port->index, port->axis, in->forces.part[1]));
    }
    int row = -1;
    mt_term_kind kind = MT_TERM_CHANNEL;
    const mt_term *term = NULL;
    const double complex factor = row_of(k, port, &row, &kind, &term);
    if (row < 0) {
        return 0.0;
    }
    double complex sum = factor * row_slope(k, p, kind, row, &in->states);
    if (term != NULL) {
        const double slope = mt_linear_slope(k->lin, term->coefficient, p);
        sum += slope * k->power[port->kind == MT_PORT_DAMPER ? 1 : 0] *
               cx_pair(mt_linear_row_dot(k->lin, kind, row, in->states.part[0]),
                       mt_linear_row_dot(k->lin, kind, row, in->states.part[1]));
    }
    return sum;
}

static mt_status jacobian(const work *k, int p, const pair *x, pair *out, mt_err *err)
{
    *out = new_pair(k->mem, k->m);
    MT_TRY(mt_arena_check(k->mem, err));
    for (int part = 0; part < 2; part++) {
        mt_linear_jacobian_slope(k->lin, p, x->part[part], out->part[part]);
    }
    return MT_OK;
}

static mt_status slope(work *k, int p, int o, int i, double complex *out, mt_err *err)
{
    const side *const in = &k->in[i];
    const side *const side_out = &k->out[o];
    const mt_arena_mark mark = mt_arena_get_mark(k->mem);
    pair moved_out;
    pair moved_in;
    MT_TRY(jacobian(k, p, &side_out->states, &moved_out, err));
    MT_TRY(jacobian(k, p, &in->states, &moved_in, err));
    *out = output_slope(k, p, o, in) + force_slope(k, p, i, &side_out->states) -
           between(k, p, &side_out->states, &in->states) - dot(k->m, &moved_out, &in->forces) -
           dot(k->m, &side_out->forces, &moved_in);
    mt_arena_rewind(k->mem, mark);
    return MT_OK;
}

static mt_status admit(const mt_slope_problem *p, mt_err *err)
{
    if (!p->a->with_gradient) {
        return mt_fail(err, MT_E_INTERNAL,
                       "derivatives asked for after a solve without gradient");
    }
    for (int o = 0; o < p->t->n_out; o++) {
        if (p->ports->out[o].kind == MT_PORT_JOINT && p->ways->joint[o].geometric != NULL) {
            return mt_fail(err, MT_E_USAGE,
                           "%s: a loaded joint's force has no derivatives here",
                           p->ports->out[o].name);
        }
    }
    return MT_OK;
}

/* Solutions and adjoints of all ports; *singular: there are none. */
static mt_status open_ports(work *k, bool *singular, mt_err *err)
{
    const mt_transfer *const t = k->p->t;
    const size_t n = (size_t)t->n;
    double complex *const x = mt_arena_alloc(k->mem, n * (size_t)t->n_in, sizeof *x);
    double complex *const y = mt_arena_alloc(k->mem, n * (size_t)t->n_out, sizeof *y);
    k->in = mt_arena_alloc(k->mem, (size_t)t->n_in, sizeof *k->in);
    k->out = mt_arena_alloc(k->mem, (size_t)t->n_out, sizeof *k->out);
    k->shift = mt_arena_f64(k->mem, (size_t)k->nq, 1);
    MT_TRY(mt_arena_check(k->mem, err));
    MT_TRY(mt_transfer_solve(t, k->w, x, y, singular, k->mem, err));
    for (int i = 0; i < t->n_in && !*singular; i++) {
        MT_TRY(open_input(k, i, x + ((ptrdiff_t)i * t->n), err));
    }
    for (int o = 0; o < t->n_out && !*singular; o++) {
        MT_TRY(open_output(k, o, y + ((ptrdiff_t)o * t->n), err));
    }
    return MT_OK;
}

/* Of all pairs with respect to input p. */
static mt_status slopes_by(work *k, int p, double complex *dh, mt_err *err)
{
    const int n_out = k->p->t->n_out;
    for (int at = 0; at < k->p->t->n_in * n_out; at++) {
        MT_TRY(slope(k, p, at % n_out, at / n_out, dh + at, err));
    }
    return MT_OK;
}

static mt_status slopes(work *k, double complex *dh, mt_err *err)
{
    const ptrdiff_t pairs = (ptrdiff_t)k->p->t->n_in * k->p->t->n_out;
    const int n_inputs = k->p->a->sys->n_inputs;
    bool singular = false;
    MT_TRY(open_ports(k, &singular, err));
    for (ptrdiff_t at = 0; at < pairs * n_inputs; at++) {
        dh[at] = nan("");
    }
    for (int p = 0; p < n_inputs; p++) {
        mt_independence why = {.opens = false};
        MT_TRY(mt_linear_independence(k->lin, p, k->mem, &why, err));
        if (!singular && !why.opens && !why.blocks) {
            MT_TRY(slopes_by(k, p, dh + (p * pairs), err));
        }
    }
    return MT_OK;
}

mt_status mt_response_slopes(const mt_slope_problem *p, double w, double complex *dh,
                             mt_arena *scratch, mt_err *err)
{
    work k = {.p = p,
              .lin = p->a->lin,
              .mem = scratch,
              .nq = p->a->sys->nq,
              .m = mt_linear_equations(p->a->lin),
              .w = w,
              .power = {1.0, cx_pair(0.0, w), -w * w}};
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    MT_TRY(admit(p, err));
    const mt_status rc = slopes(&k, dh, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}
