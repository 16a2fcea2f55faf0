/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The coordinates q of the basis at each frequency by themselves; then all at once
 *     x = X q + U u,    u = sum_p s^p u_p - W q    (basis.h), and likewise y. */
#include "response/slopes.h"

#include <math.h>
#include <string.h>

#include "analysis/damping.h"
#include "linalg/dense.h"
#include "mechanics/products.h"

mt_status mt_solutions_open(const mt_basis *basis, int out, int in, mt_arena *mem,
                            mt_solutions *s, mt_err *err)
{
    const mt_transfer *const t = &basis->t;
    *s = (mt_solutions){.basis = basis, .one = *t, .in = in, .out = out};
    s->one.n_in = 1;
    s->one.n_out = 1;
    for (int p = 0; p < MT_REST_POWERS; p++) {
        s->one.rest[p] =
            t->rest[p] == NULL ? NULL : t->rest[p] + out + ((ptrdiff_t)in * t->n_out);
    }
    for (int p = 0; p < MT_FORCED_POWERS; p++) {
        if (t->beta[p] != NULL) {
            s->one.beta[p] = t->beta[p] + ((ptrdiff_t)in * t->n);
        }
        if (t->sigma[p] != NULL) {
            double complex *const row = mt_arena_alloc(mem, (size_t)t->n, sizeof *row);
            MT_TRY(mt_arena_check(mem, err));
            for (ptrdiff_t j = 0; j < t->n; j++) {
                row[j] = t->sigma[p][out + (j * t->n_out)];
            }
            s->one.sigma[p] = row;
        }
    }
    return MT_OK;
}

/* Both parts of numbers that are complex, apart. */
static void split_complex(ptrdiff_t n, const double complex *z, double *const to[2],
                          ptrdiff_t at)
{
    for (ptrdiff_t j = 0; j < n; j++) {
        to[0][at + j] = creal(z[j]);
        to[1][at + j] = cimag(z[j]);
    }
}

/* u := sum_p s^p given_p - W q. */
static void follow_coordinates(const mt_basis *b, double w, const double complex *const *given,
                               int column, const double complex *q, double complex *u)
{
    const ptrdiff_t n = b->n_follow;
    double complex power = 1.0;
    memset(u, 0, (size_t)n * sizeof *u);
    for (int p = 0; p < MT_FORCED_POWERS; p++) {
        for (ptrdiff_t i = 0; i < n && given[p] != NULL; i++) {
            u[i] += power * given[p][i + (column * n)];
        }
        power *= mt_complex(0.0, w);
    }
    for (ptrdiff_t j = 0; j < b->t.n; j++) {
        for (ptrdiff_t i = 0; i < n; i++) {
            u[i] -= b->w[i + (j * n)] * q[j];
        }
    }
}

/* to[n] := X q + U u, u given as by `follow_coordinates`. */
static void back_one(const mt_basis *b, const double complex *q, const double complex *u,
                     double complex *to)
{
    const ptrdiff_t n = b->f->n;
    memset(to, 0, (size_t)n * sizeof *to);
    for (ptrdiff_t j = 0; j < b->t.n; j++) {
        for (ptrdiff_t i = 0; i < n; i++) {
            to[i] += b->x[i + (j * n)] * q[j];
        }
    }
    for (ptrdiff_t j = 0; j < b->n_follow; j++) {
        for (ptrdiff_t i = 0; i < n; i++) {
            to[i] += b->follow[i + (j * n)] * u[j];
        }
    }
}

mt_status mt_basis_solve(const mt_basis *b, double w, double complex *x, double complex *y,
                         bool *singular, mt_arena *scratch, mt_err *err)
{
    const ptrdiff_t n = b->t.n;
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double complex *const q = mt_arena_alloc(scratch, (size_t)(n * b->t.n_in), sizeof *q);
    double complex *const a = mt_arena_alloc(scratch, (size_t)(n * b->t.n_out), sizeof *a);
    double complex *const u = mt_arena_alloc(scratch, (size_t)b->n_follow, sizeof *u);
    MT_TRY(mt_arena_check(scratch, err));
    MT_TRY(mt_transfer_solve(&b->t, w, q, a, NULL, singular, scratch, err));
    for (int i = 0; i < b->t.n_in && !*singular; i++) {
        follow_coordinates(b, w, b->follow_b, i, q + (i * n), u);
        back_one(b, q + (i * n), u, x + ((ptrdiff_t)i * b->f->n));
    }
    for (int o = 0; o < b->t.n_out && !*singular; o++) {
        follow_coordinates(b, w, b->follow_s, o, a + (o * n), u);
        back_one(b, a + (o * n), u, y + ((ptrdiff_t)o * b->f->n));
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}

mt_status mt_solutions_one(const mt_solutions *s, double w, double complex *x,
                           double complex *y, double complex *h, bool *singular,
                           mt_arena *scratch, mt_err *err)
{
    const mt_basis *const b = s->basis;
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double complex *const q = mt_arena_alloc(scratch, 2 * (size_t)b->t.n, sizeof *q);
    double complex *const u = mt_arena_alloc(scratch, (size_t)b->n_follow, sizeof *u);
    MT_TRY(mt_arena_check(scratch, err));
    double complex *const a = q + b->t.n;
    MT_TRY(mt_transfer_solve(&s->one, w, q, a, h, singular, scratch, err));
    if (!*singular) {
        follow_coordinates(b, w, b->follow_b, s->in, q, u);
        back_one(b, q, u, x);
        follow_coordinates(b, w, b->follow_s, s->out, a, u);
        back_one(b, a, u, y);
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}

/* One side, x or y, of all frequencies in coordinates of the basis. */
typedef struct solution_side {
    double *q[2]; /* stay x count */
    double *u[2]; /* follow x count */
} solution_side;

static solution_side new_solution_side(const mt_solutions *s, int count, mt_arena *mem)
{
    const size_t stay = (size_t)s->one.n * (size_t)count;
    const size_t more = (size_t)s->basis->n_follow * (size_t)count;
    return (solution_side){{mt_arena_f64(mem, stay, 1), mt_arena_f64(mem, stay, 1)},
                           {mt_arena_f64(mem, more, 1), mt_arena_f64(mem, more, 1)}};
}

/* to := X q + U u. */
static void back(const mt_solutions *s, int count, const solution_side *from,
                 double *const to[2])
{
    const mt_basis *const b = s->basis;
    const int n = b->f->n;
    for (int i = 0; i < 2; i++) {
        mt_gemm(false, false, n, count, s->one.n, 1.0, b->x, n, from->q[i], s->one.n, 0.0,
                to[i], n);
        if (b->n_follow > 0) {
            mt_gemm(false, false, n, count, b->n_follow, 1.0, b->follow, n, from->u[i],
                    b->n_follow, 1.0, to[i], n);
        }
    }
}

static mt_status solve_at_frequencies(const mt_solutions *s, int count, const double *w,
                                      const mt_solved *out, bool *singular, mt_arena *mem,
                                      mt_err *err)
{
    const ptrdiff_t n = s->one.n;
    const ptrdiff_t more = s->basis->n_follow;
    double complex *const q = mt_arena_alloc(mem, (size_t)(n + more), sizeof *q);
    double complex *const a = mt_arena_alloc(mem, (size_t)(n + more), sizeof *a);
    const solution_side x = new_solution_side(s, count, mem);
    const solution_side y = new_solution_side(s, count, mem);
    MT_TRY(mt_arena_check(mem, err));
    for (ptrdiff_t i = 0; i < count; i++) {
        MT_TRY(mt_transfer_solve(&s->one, w[i], q, a, NULL, singular, mem, err));
        if (*singular) {
            return MT_OK;
        }
        split_complex(n, q, x.q, i * n);
        split_complex(n, a, y.q, i * n);
        follow_coordinates(s->basis, w[i], s->basis->follow_b, s->in, q, q + n);
        follow_coordinates(s->basis, w[i], s->basis->follow_s, s->out, a, a + n);
        split_complex(more, q + n, x.u, i * more);
        split_complex(more, a + n, y.u, i * more);
    }
    back(s, count, &x, out->x);
    back(s, count, &y, out->y);
    return MT_OK;
}

mt_status mt_solutions_at(const mt_solutions *s, int count, const double *w,
                          const mt_solved *out, bool *singular, mt_arena *scratch, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    *singular = false;
    const mt_status rc = solve_at_frequencies(s, count, w, out, singular, scratch, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}

/*
 * Over all states, with the equations of the joints beside them:
 *     [D A^T; A 0] (q; l) = (f; 0),        H = sigma . q - t . l + d,
 *     [D A^T; A 0] (e; m) = (sigma; -t),   the adjoint,
 *     dH = d(sigma) . q - d(t) . l + e . df - e . dD q - (dA e) . l - m . (dA q),
 * a d being the derivative with respect to one input, geometry and equilibrium with it. With x
 * and y of the reduced problem q = Z x and e = Z y - v, A v = t; l and m balance what is left.
 * A standing force that turns with a joint's bodies is a part of sigma. Modal ratios are the
 * matrix M Phi F Phi^T M of D over all states, whose derivative is (damping.c)
 *     e . d(ratios) q = e . dM psi_q + psi_e . dM q + a . Q b - (dA psi_q) . P M e
 *                       - (dA psi_e) . P M q,
 *     b = Phi^T M q, psi_q = Phi F b,  a = Phi^T M e, psi_e = Phi F a,  P w: what balances w.
 * d of the ground's own motion does not depend on any input: a rigid translation moves every
 * sensor by 1.
 */

/* A complex vector. */
typedef struct pair {
    double *part[2];
} pair;

/* One input or output at work. */
typedef struct side {
    pair states; /* q, or e */
    pair forces; /* l, or m */
    /* with modal ratios */
    double complex *coefficient; /* [r] b, or a */
    pair turned;                 /* psi */
    pair carried;                /* P M q, or P M e */
} side;

typedef struct work {
    const mt_slope_problem *p;
    mt_linear *lin;
    mt_arena *mem;
    int nq;
    int m;
    double w;
    double complex power[3];  /* s^k */
    double complex factor[4]; /* of D's matrices */
    const double complex *x;  /* n x n_in: the solutions in the freedoms */
    const double complex *y;  /* n x n_out */
    side *in;                 /* [n_in] */
    side *out;                /* [n_out] */
    mt_ratio_modes ratio;
    double *q;          /* r x r: Q of one input */
    double **geometric; /* [n_out][nq]: slope of what stands in a joint, of one input; NULL */
} work;

enum { MATRICES = MT_SLOPE_MATRICES };

static pair new_pair(mt_arena *mem, int n)
{
    return (pair){{mt_arena_f64(mem, (size_t)n, 1), mt_arena_f64(mem, (size_t)n, 1)}};
}

void mt_slope_matrices(const mt_analysis *a, mt_slope_factor *d)
{
    const mt_damping_def *const def = &a->sys->damping;
    const double beta = mt_response_node(a, def->stiffness);
    const double alpha = mt_response_node(a, def->mass);
    d[MT_MATRIX_STIFFNESS] = (mt_slope_factor){{1.0, beta, 0.0}};
    d[MT_MATRIX_LOSS] = (mt_slope_factor){{mt_complex(0.0, 1.0), 0.0, 0.0}};
    d[MT_MATRIX_DAMPERS] = (mt_slope_factor){{0.0, 1.0, 0.0}};
    d[MT_MATRIX_MASS] = (mt_slope_factor){{0.0, alpha, 1.0}};
}

static double complex factor_value(const work *k, mt_slope_factor f)
{
    return f.c[0] + (f.c[1] * k->power[1]) + (f.c[2] * k->power[2]);
}

static void factors_of(work *k)
{
    mt_slope_factor d[MATRICES];
    mt_slope_matrices(k->p->a, d);
    for (int m = 0; m < MATRICES; m++) {
        k->factor[m] = factor_value(k, d[m]);
    }
}

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
    for (int m = 0; m < MATRICES; m++) {
        for (int part = 0; part < 2; part++) {
            memset(product, 0, (size_t)k->nq * sizeof *product);
            mt_linear_states_product(k->lin, (mt_linear_matrix)m, 1.0, x->part[part], product);
            add_real(k->nq, -k->factor[m] * mt_complex(1 - part, part), product, to);
        }
    }
    mt_arena_rewind(k->mem, mark);
    return MT_OK;
}

/* Joint forces: A^T forces ~ w. */
static mt_status solve_joint_forces(work *k, const pair *w, pair *forces, mt_err *err)
{
    for (int part = 0; part < 2; part++) {
        MT_TRY(mt_linear_multipliers(k->lin, w->part[part], forces->part[part], err));
    }
    return MT_OK;
}

/* states := Z x. */
static mt_status expand_to_states(work *k, const double complex *x, pair *states, mt_err *err)
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

int mt_slope_channel(const mt_linear *lin, const mt_port *port)
{
    return mt_linear_terms(lin, MT_TERM_CHANNEL)->terms[port->index].first;
}

void mt_slope_push(const mt_linear *lin, const mt_port *in, double *f)
{
    if (in->kind == MT_PORT_BASE) {
        mt_linear_base_force(lin, in->index, f, NULL);
    } else {
        mt_linear_row_add(lin, MT_TERM_CHANNEL, mt_slope_channel(lin, in), 1.0, f);
    }
}

mt_status mt_slope_motions(const mt_linear *lin, int nq, int n, const double *v, double *e,
                           mt_arena *mem, mt_err *err)
{
    const size_t order = (size_t)n;
    double *const unit = mt_arena_f64(mem, order, order);
    MT_TRY(mt_arena_check(mem, err));
    for (size_t j = 0; j < order; j++) {
        unit[j * (order + 1)] = 1.0;
    }
    mt_linear_expand(lin, n, unit, e);
    if (v != NULL) {
        mt_axpy(nq, -1.0, v, e + ((ptrdiff_t)n * nq));
    }
    return MT_OK;
}

/* psi, P M q and b of one side. */
static mt_status open_ratios(work *k, side *s, mt_err *err)
{
    const int n = mt_linear_freedoms(k->lin);
    const int r = k->ratio.r;
    s->coefficient = mt_arena_alloc(k->mem, (size_t)r, sizeof *s->coefficient);
    s->turned = new_pair(k->mem, k->nq);
    s->carried = new_pair(k->mem, k->m);
    double *const product = mt_arena_f64(k->mem, (size_t)k->nq, 1);
    double *const part = mt_arena_f64(k->mem, (size_t)(n > r ? n : r), 2);
    MT_TRY(mt_arena_check(k->mem, err));
    double *const other = part + (n > r ? n : r);
    for (int i = 0; i < 2; i++) {
        memset(product, 0, (size_t)k->nq * sizeof *product);
        mt_linear_states_product(k->lin, MT_MATRIX_MASS, 1.0, s->states.part[i], product);
        MT_TRY(mt_linear_multipliers(k->lin, product, s->carried.part[i], err));
        mt_linear_project(k->lin, product, part);
        mt_gemv(true, n, r, 1.0, k->ratio.y, n, part, 0.0, other);
        for (int j = 0; j < r; j++) {
            s->coefficient[j] += mt_complex(1 - i, i) * other[j];
            other[j] *= k->ratio.f[j];
        }
        mt_gemv(false, n, r, 1.0, k->ratio.y, n, other, 0.0, part);
        mt_linear_expand(k->lin, 1, part, s->turned.part[i]);
    }
    return MT_OK;
}

/* Completes l or m; w: its part other than D. */
static mt_status close_side(work *k, side *s, pair *w, mt_err *err)
{
    MT_TRY(subtract_d(k, &s->states, w, err));
    if (k->ratio.r == 0) {
        return solve_joint_forces(k, w, &s->forces, err);
    }
    MT_TRY(open_ratios(k, s, err));
    double *const product = mt_arena_f64(k->mem, (size_t)k->nq, 1);
    MT_TRY(mt_arena_check(k->mem, err));
    for (int i = 0; i < 2; i++) {
        memset(product, 0, (size_t)k->nq * sizeof *product);
        mt_linear_states_product(k->lin, MT_MATRIX_MASS, 1.0, s->turned.part[i], product);
        add_real(k->nq, -k->power[1] * mt_complex(1 - i, i), product, w);
    }
    return solve_joint_forces(k, w, &s->forces, err);
}

static mt_status open_input(work *k, int i, const double complex *x, mt_err *err)
{
    const mt_port *const port = &k->p->ports->in[i];
    side *const s = &k->in[i];
    *s = (side){.states = new_pair(k->mem, k->nq), .forces = new_pair(k->mem, k->m)};
    pair w = new_pair(k->mem, k->nq);
    double *const f = mt_arena_f64(k->mem, (size_t)k->nq, 1);
    MT_TRY(mt_arena_check(k->mem, err));
    MT_TRY(expand_to_states(k, x, &s->states, err));
    mt_slope_push(k->lin, port, f);
    add_real(k->nq, k->power[mt_response_power(port)], f, &w);
    return close_side(k, s, &w, err);
}

/* coefficient (1 + i loss), or s coefficient of a damper. */
static mt_slope_factor force_of(mt_term_kind kind, double coefficient, double lossy)
{
    return kind == MT_TERM_DAMPING
               ? (mt_slope_factor){{0.0, coefficient, 0.0}}
               : (mt_slope_factor){{mt_complex(coefficient, lossy), 0.0, 0.0}};
}

int mt_slope_parts(const mt_analysis *a, const mt_port *port, mt_slope_part *part)
{
    if (port->kind == MT_PORT_SENSOR) {
        part[0] =
            (mt_slope_part){.row = mt_slope_channel(a->lin, port), .kind = MT_TERM_CHANNEL};
        part[0].factor.c[port->motion] = 1.0;
        return 1;
    }
    mt_force_part force[MT_FORCE_PARTS];
    const int n = mt_response_force(a, port, force);
    const mt_term_kind kind =
        port->kind == MT_PORT_DAMPER ? MT_TERM_DAMPING : MT_TERM_STIFFNESS;
    for (int i = 0; i < n; i++) {
        const double c = force[i].share * mt_linear_value(a->lin, force[i].term->coefficient);
        part[i] = (mt_slope_part){
            .row = force[i].row,
            .kind = kind,
            .factor = force_of(kind, c, c * mt_response_node(a, force[i].term->loss)),
            .force = force[i]};
    }
    return n;
}

mt_slope_factor mt_slope_turn(const mt_analysis *a, int p, const mt_slope_part *part)
{
    const mt_term *const term = part->force.term;
    if (term == NULL) {
        return (mt_slope_factor){{0.0}};
    }
    const double share = part->force.share;
    const double c = share * mt_linear_value(a->lin, term->coefficient);
    const double turn = share * mt_linear_slope(a->lin, term->coefficient, p);
    return force_of(part->kind, turn,
                    (turn * mt_response_node(a, term->loss)) +
                        (c * mt_slope_node(a, p, term->loss)));
}

static mt_status open_output(work *k, int o, const double complex *y, mt_err *err)
{
    const mt_port *const port = &k->p->ports->out[o];
    side *const s = &k->out[o];
    *s = (side){.states = new_pair(k->mem, k->nq), .forces = new_pair(k->mem, k->m)};
    pair w = new_pair(k->mem, k->nq);
    double *const sigma = mt_arena_f64(k->mem, (size_t)k->nq, 1);
    MT_TRY(mt_arena_check(k->mem, err));
    MT_TRY(expand_to_states(k, y, &s->states, err));
    if (port->kind == MT_PORT_JOINT) {
        mt_axpy(k->nq, -1.0, k->p->ways->joint[o].v, s->states.part[0]);
        if (k->p->ways->joint[o].geometric != NULL) {
            mt_axpy(k->nq, -1.0, k->p->ways->joint[o].geometric, w.part[0]);
        }
    } else {
        mt_slope_part part[MT_FORCE_PARTS];
        const int n = mt_slope_parts(k->p->a, port, part);
        for (int i = 0; i < n; i++) {
            memset(sigma, 0, (size_t)k->nq * sizeof *sigma);
            mt_linear_row_add(k->lin, part[i].kind, part[i].row, 1.0, sigma);
            add_real(k->nq, factor_value(k, part[i].factor), sigma, &w);
        }
    }
    return close_side(k, s, &w, err);
}

/* a . b, both complex; no conjugate. */
static double complex dot(int n, const pair *a, const pair *b)
{
    return mt_complex(mt_dot(n, a->part[0], b->part[0]) - mt_dot(n, a->part[1], b->part[1]),
                      mt_dot(n, a->part[0], b->part[1]) + mt_dot(n, a->part[1], b->part[0]));
}

double mt_slope_node(const mt_analysis *a, int p, mt_node node)
{
    return node == MT_NO_NODE ? 0.0 : mt_linear_slope(a->lin, node, p);
}

/* e . (matrix or its derivative) q. */
static double complex between_one(const work *k, int p, mt_linear_matrix m, const pair *e,
                                  const pair *q)
{
    double part[2][2];
    for (int at = 0; at < 4; at++) {
        part[at / 2][at % 2] =
            mt_linear_between_slope(k->lin, p, m, e->part[at / 2], q->part[at % 2]);
    }
    return mt_complex(part[0][0] - part[1][1], part[0][1] + part[1][0]);
}

/* e . M q. */
static mt_status product_with(work *k, mt_linear_matrix m, const pair *e, const pair *q,
                              double complex *out, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(k->mem);
    pair w = new_pair(k->mem, k->nq);
    MT_TRY(mt_arena_check(k->mem, err));
    mt_linear_states_product(k->lin, m, 1.0, q->part[0], w.part[0]);
    mt_linear_states_product(k->lin, m, 1.0, q->part[1], w.part[1]);
    *out = dot(k->nq, e, &w);
    mt_arena_rewind(k->mem, mark);
    return MT_OK;
}

/* (dA/dp) x; a shortage is the arena's. */
static pair jacobian(const work *k, int p, const pair *x)
{
    const pair out = new_pair(k->mem, k->m);
    for (int part = 0; part < 2 && !mt_arena_failed(k->mem); part++) {
        mt_linear_jacobian_slope(k->lin, p, x->part[part], out.part[part]);
    }
    return out;
}

/* e . d(ratios) q. */
static mt_status ratios(work *k, int p, int o, int i, double complex *out, mt_err *err)
{
    const side *const e = &k->out[o];
    const side *const q = &k->in[i];
    const ptrdiff_t r = k->ratio.r;
    const mt_arena_mark mark = mt_arena_get_mark(k->mem);
    const pair by_q = jacobian(k, p, &q->turned);
    const pair by_e = jacobian(k, p, &e->turned);
    MT_TRY(mt_arena_check(k->mem, err));
    *out = between_one(k, p, MT_MATRIX_MASS, &e->states, &q->turned) +
           between_one(k, p, MT_MATRIX_MASS, &e->turned, &q->states) -
           dot(k->m, &by_q, &e->carried) - dot(k->m, &by_e, &q->carried);
    for (ptrdiff_t c = 0; c < r; c++) {
        for (ptrdiff_t a = 0; a < r; a++) {
            *out += e->coefficient[a] * k->q[a + (c * r)] * q->coefficient[c];
        }
    }
    mt_arena_rewind(k->mem, mark);
    return MT_OK;
}

/* e . dD q. */
static mt_status slope_between_states(work *k, int p, int o, int i, double complex *out,
                                      mt_err *err)
{
    const mt_damping_def *const d = &k->p->a->sys->damping;
    const pair *const e = &k->out[o].states;
    const pair *const q = &k->in[i].states;
    double complex sum = 0.0;
    double complex part = 0.0;
    for (int m = 0; m < MATRICES; m++) {
        sum += k->factor[m] * between_one(k, p, (mt_linear_matrix)m, e, q);
    }
    if (mt_slope_node(k->p->a, p, d->mass) != 0.0) {
        MT_TRY(product_with(k, MT_MATRIX_MASS, e, q, &part, err));
        sum += k->power[1] * mt_slope_node(k->p->a, p, d->mass) * part;
    }
    if (mt_slope_node(k->p->a, p, d->stiffness) != 0.0) {
        MT_TRY(product_with(k, MT_MATRIX_STIFFNESS, e, q, &part, err));
        sum += k->power[1] * mt_slope_node(k->p->a, p, d->stiffness) * part;
    }
    if (k->ratio.r > 0) {
        MT_TRY(ratios(k, p, o, i, &part, err));
        sum += k->power[1] * part;
    }
    *out = sum;
    return MT_OK;
}

/* A real function of both parts. */
static double complex row_slope(const work *k, int p, mt_term_kind kind, int row, const pair *x)
{
    return mt_complex(mt_linear_row_dot_slope(k->lin, p, kind, row, x->part[0]),
                      mt_linear_row_dot_slope(k->lin, p, kind, row, x->part[1]));
}

/* e . df. */
static double complex force_slope(work *k, int p, int i, const pair *e)
{
    const mt_port *const port = &k->p->ports->in[i];
    if (port->kind == MT_PORT_SENSOR) {
        return row_slope(k, p, MT_TERM_CHANNEL, mt_slope_channel(k->lin, port), e);
    }
    const double re = mt_linear_base_slope(k->lin, p, port->index, e->part[0]);
    const double im = mt_linear_base_slope(k->lin, p, port->index, e->part[1]);
    return k->power[mt_response_power(port)] * mt_complex(re, im);
}

/* d(sigma) . q - d(t) . l. */
static double complex output_slope(const work *k, int p, int o, const side *in)
{
    const mt_port *const port = &k->p->ports->out[o];
    if (port->kind == MT_PORT_JOINT) {
        double part[2];
        for (int c = 0; c < 2; c++) {
            part[c] =
                mt_linear_joint_slope(k->lin, p, port->index, port->axis, in->forces.part[c]) +
                mt_dot(k->nq, k->geometric[o], in->states.part[c]);
        }
        return -mt_complex(part[0], part[1]);
    }
    mt_slope_part part[MT_FORCE_PARTS];
    const int n = mt_slope_parts(k->p->a, port, part);
    double complex sum = 0.0;
    for (int i = 0; i < n; i++) {
        const mt_slope_part *const own = &part[i];
        sum +=
            (factor_value(k, own->factor) * row_slope(k, p, own->kind, own->row, &in->states)) +
            (factor_value(k, mt_slope_turn(k->p->a, p, own)) *
             mt_complex(mt_linear_row_dot(k->lin, own->kind, own->row, in->states.part[0]),
                        mt_linear_row_dot(k->lin, own->kind, own->row, in->states.part[1])));
    }
    return sum;
}

static mt_status slope(work *k, int p, int o, int i, double complex *out, mt_err *err)
{
    const side *const in = &k->in[i];
    const side *const side_out = &k->out[o];
    const mt_arena_mark mark = mt_arena_get_mark(k->mem);
    const pair moved_out = jacobian(k, p, &side_out->states);
    const pair moved_in = jacobian(k, p, &in->states);
    MT_TRY(mt_arena_check(k->mem, err));
    double complex turned = 0.0;
    MT_TRY(slope_between_states(k, p, o, i, &turned, err));
    *out = output_slope(k, p, o, in) + force_slope(k, p, i, &side_out->states) - turned -
           dot(k->m, &moved_out, &in->forces) - dot(k->m, &side_out->forces, &moved_in);
    mt_arena_rewind(k->mem, mark);
    return MT_OK;
}

mt_status mt_slope_admit(const mt_slope_problem *p, mt_err *err)
{
    return p->a->with_gradient
               ? MT_OK
               : mt_fail(err, MT_E_INTERNAL,
                         "derivatives asked for after a solve without gradient");
}

static mt_status open_work(work *k, mt_err *err)
{
    const int n_out = k->p->basis->f->n_out;
    if (k->p->a->sys->damping.modal) {
        MT_TRY(mt_analysis_ratio_modes(k->p->a, &k->ratio, err));
    }
    k->q = mt_arena_f64(k->mem, (size_t)k->ratio.r, (size_t)k->ratio.r);
    k->geometric = mt_arena_alloc(k->mem, (size_t)n_out, sizeof *k->geometric);
    MT_TRY(mt_arena_check(k->mem, err));
    for (int o = 0; o < n_out; o++) {
        k->geometric[o] = mt_arena_f64(k->mem, (size_t)k->nq, 1);
    }
    return mt_arena_check(k->mem, err);
}

/* Solutions and adjoints of all ports; *singular: there are none. */
static mt_status open_ports(work *k, bool *singular, mt_err *err)
{
    const mt_forced *const f = k->p->basis->f;
    const size_t n = (size_t)f->n;
    double complex *const x = mt_arena_alloc(k->mem, n * (size_t)f->n_in, sizeof *x);
    double complex *const y = mt_arena_alloc(k->mem, n * (size_t)f->n_out, sizeof *y);
    k->x = x;
    k->y = y;
    k->in = mt_arena_alloc(k->mem, (size_t)f->n_in, sizeof *k->in);
    k->out = mt_arena_alloc(k->mem, (size_t)f->n_out, sizeof *k->out);
    MT_TRY(mt_arena_check(k->mem, err));
    MT_TRY(mt_basis_solve(k->p->basis, k->w, x, y, singular, k->mem, err));
    for (int i = 0; i < f->n_in && !*singular; i++) {
        MT_TRY(open_input(k, i, x + ((ptrdiff_t)i * f->n), err));
    }
    for (int o = 0; o < f->n_out && !*singular; o++) {
        MT_TRY(open_output(k, o, y + ((ptrdiff_t)o * f->n), err));
    }
    return MT_OK;
}

/* Of all pairs with respect to input p. */
static mt_status slopes_by(work *k, int p, double complex *dh, mt_err *err)
{
    const int n_out = k->p->basis->f->n_out;
    if (k->ratio.r > 0) {
        MT_TRY(mt_analysis_ratio_slope(k->p->a, p, k->q, err));
    }
    for (int o = 0; o < n_out; o++) {
        const mt_port *const port = &k->p->ports->out[o];
        if (port->kind == MT_PORT_JOINT) {
            MT_TRY(mt_linear_joint_geometric_slope(k->lin, p, port->index, port->axis,
                                                   k->geometric[o], err));
        }
    }
    for (int at = 0; at < k->p->basis->f->n_in * n_out; at++) {
        MT_TRY(slope(k, p, at % n_out, at / n_out, dh + at, err));
    }
    return MT_OK;
}

static mt_status response_slopes(work *k, double complex *dh, mt_err *err)
{
    const ptrdiff_t pairs = (ptrdiff_t)k->p->basis->f->n_in * k->p->basis->f->n_out;
    const int n_inputs = k->p->a->sys->n_inputs;
    bool singular = false;
    MT_TRY(mt_linear_complete(k->lin, err));
    MT_TRY(open_work(k, err));
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
              .power = {1.0, mt_complex(0.0, w), -w * w}};
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    MT_TRY(mt_slope_admit(p, err));
    factors_of(&k);
    const mt_status rc = response_slopes(&k, dh, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}
