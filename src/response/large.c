/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The forced problem of a large mechanism in few coordinates. */
#include "response/large.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/format.h"
#include "linalg/dense.h"
#include "mechanics/absolute.h"
#include "mechanics/rows.h"

/* A generalised force on the bodies, and its projections. */
typedef struct force {
    mt_lowest_push push;
    double *in_all; /* [n] in the coordinates of the problem */
    mt_left_part left;
} force;

typedef struct side {
    force f;
    double damping;
    double structural;
    int partner; /* the side paired with this one; may be itself */
} side;

/* A part of an output: s^power (re + i im) times a force; im of power 0 alone. */
typedef struct out_term {
    int of; /* output */
    int f;  /* of outs */
    int power;
    double re;
    double im;
} out_term;
/* Forces that an output consists of, and its terms, at most: those of a joint (below). */
enum { OUT_FORCES = 4, OUT_TERMS = 6 };

/* A joint's force on a motion of what hangs on it. */
typedef struct cut {
    int output; /* -1: none */
    int mass;   /* of outs: M v */
    double kg;  /* v^T M v */
    double *d;  /* [n_in] the force that inputs pass on: of the power of the input's own */
} cut;

typedef struct work {
    mt_lowest *l;
    const mt_port_set *ports;
    mt_arena *mem;
    mt_arena *scratch;
    mt_large *out;
    char *why;
    mt_data d;
    mt_placement at;
    mt_term_list list[MT_TERM_KINDS];
    int n_x;
    int free;
    int kept;     /* vibration modes */
    int size;     /* columns of x */
    int most;     /* capacity of x, columns */
    double *x;    /* n_x x most, orthonormal */
    double *ax;   /* H A times each column: x^T A x in the norm of H is x^T ax */
    double *dual; /* [n_x] work */
    double to;
    double shift;
    double alpha;
    double beta;
    double loss; /* common to all springs */
    force *in;
    force *outs;
    int n_outs;
    out_term *term;
    int n_terms;
    cut *cuts; /* [n_out] */
    side *sides;
    int n_sides;
    double *states; /* [nq] */
    double *theta;
    double *z;
} work;

/* What pushes, what is seen and what damps locally, each as a force in the coordinates of the
 * search for modes. */

/* What damps locally is a force of its own: with more of them a dense way costs less. */
enum { MOST_SIDES = 24 };
/* Rows of a term. */
enum { MOST_ROWS = 16 };

/* Sets the reason of a refusal; returns false. */
static bool large_refuse(work *k, const char *why)
{
    (void)mt_snprintf(k->why, MT_LARGE_WHY, "%s", why);
    return false;
}

/* Value of a node; 0 where there is none. */
static double large_value(const work *k, mt_node node)
{
    return creal(mt_data_scalar(&k->d, node, 0.0));
}

static mt_status new_force(const work *k, force *f, mt_err *err)
{
    mt_lowest_push_init(k->l, k->scratch, &f->push);
    return mt_arena_check(k->scratch, err);
}

/* k->states += factor times a row over the freedoms of a term's bodies. */
static void add_term_row(work *k, const mt_term *t, const mt_cx *row, double factor)
{
    for (int i = 0; i < MT_LOCAL; i++) {
        const int q = mt_local_dof(k->l->sys, t->body, i);
        if (q >= 0) {
            k->states[q] += factor * creal(row[i]);
        }
    }
}

static void clear(work *k)
{
    memset(k->states, 0, (size_t)k->l->sys->nq * sizeof *k->states);
}

/* Writes the row of a sensor's direction into k->states. */
static void large_sensor_row(work *k, int channel)
{
    const mt_term *const t = &k->list[MT_TERM_CHANNEL].terms[channel];
    mt_cx row[MT_LOCAL];
    mt_term_rows(&k->d, MT_TERM_CHANNEL, t, k->at.pose, row);
    clear(k);
    add_term_row(k, t, row, 1.0);
}

/* k->states := force of the ground's acceleration by 1 along an axis: that of the masses on a
 * translation of all bodies, and of the ground where it holds a bar's end. */
static void large_base_force(work *k, int axis)
{
    mt_cx rows[MOST_ROWS * MT_LOCAL];
    clear(k);
    for (int i = 0; i < k->list[MT_TERM_MASS].n_terms; i++) {
        const mt_term *const t = &k->list[MT_TERM_MASS].terms[i];
        const double c = large_value(k, t->coefficient) * (t->pair ? 0.5 : 1.0);
        mt_term_rows(&k->d, MT_TERM_MASS, t, k->at.pose, rows);
        for (int r = 0; r < t->count; r++) {
            const mt_cx *const other = rows + ((ptrdiff_t)MT_LOCAL * (t->pair ? 1 - r : r));
            const double way = creal(other[axis]) + creal(other[(MT_LOCAL / 2) + axis]);
            add_term_row(k, t, rows + ((ptrdiff_t)MT_LOCAL * r), -c * way);
        }
    }
}

static mt_status open_inputs(work *k, mt_err *err)
{
    k->in = mt_arena_alloc(k->scratch, (size_t)k->ports->n_in, sizeof *k->in);
    MT_TRY(mt_arena_check(k->scratch, err));
    for (int i = 0; i < k->ports->n_in; i++) {
        const mt_port *const port = &k->ports->in[i];
        MT_TRY(new_force(k, &k->in[i], err));
        if (port->kind == MT_PORT_BASE) {
            large_base_force(k, port->index);
        } else {
            large_sensor_row(k, port->index);
        }
        MT_TRY(mt_lowest_force(k->l, k->states, &k->in[i].push, err));
    }
    return MT_OK;
}

/* Power of s of an output. */
static int large_power(const mt_port *out)
{
    return out->kind == MT_PORT_SENSOR ? out->motion : out->kind == MT_PORT_DAMPER ? 1 : 0;
}

/* The force in a spring or damper, in k->states; *one: all of it has one loss factor, *loss. */
static void force_row(work *k, const mt_port *port, bool *one, double *loss)
{
    const mt_term_kind kind =
        port->kind == MT_PORT_DAMPER ? MT_TERM_DAMPING : MT_TERM_STIFFNESS;
    mt_cx rows[MOST_ROWS * MT_LOCAL];
    mt_force_part part[MT_FORCE_PARTS];
    const int n = mt_response_force_among(k->l->sys, &k->list[kind], port, part);
    *one = true;
    clear(k);
    for (int i = 0; i < n; i++) {
        const mt_term *const t = part[i].term;
        const double lost = kind == MT_TERM_DAMPING ? 0.0 : large_value(k, t->loss);
        *one = *one && t->count <= MOST_ROWS && (i == 0 || lost == *loss);
        if (*one) {
            *loss = lost;
            mt_term_rows(&k->d, kind, t, k->at.pose, rows);
            add_term_row(k, t, rows + ((ptrdiff_t)(part[i].row - t->first) * MT_LOCAL),
                         part[i].share * large_value(k, t->coefficient));
        }
    }
}

/* Adds the force of k->states to the outputs', as the term t. */
static mt_status add_output_force(work *k, out_term t, mt_err *err)
{
    t.f = k->n_outs++;
    k->term[k->n_terms++] = t;
    MT_TRY(new_force(k, &k->outs[t.f], err));
    return mt_lowest_force(k->l, k->states, &k->outs[t.f].push, err);
}

/* The same of the last force. */
static void add_output_term(work *k, out_term t)
{
    if (t.re != 0.0) {
        t.f = k->n_outs - 1;
        k->term[k->n_terms++] = t;
    }
}

/*
 * The force of a joint. Where it is the only joint between two parts, let v be the translation
 * of one of them, so that A v has entries in this joint's equations alone. Then, A^T lambda
 * being the joints' forces, the force along v is
 *     v . (M q'' + C q' + (K + i H) q - f)
 * (mechanics/forcing.h). With the coordinates of the bodies v is made smooth, v - K^-1 K v, so
 * that K v does no work where the joints hold; else springs between the parts have a K v. Modal
 * damping ratios act as (M Phi) F (M Phi)^T.
 */

/* Index of a body, or behind all of them that of the ground. */
static int index_of_body(const mt_system *sys, int body)
{
    return body == MT_GROUND ? sys->n_bodies : body;
}

/* Joins the parts of two bodies; the greater index names them, so that of the ground is its
 * own. */
static void join_parts(int *part, int a, int b)
{
    while (part[a] != a) {
        a = part[a];
    }
    while (part[b] != b) {
        part[b] = part[part[b]];
        b = part[b];
    }
    part[a < b ? a : b] = a < b ? b : a;
}

/* part[n_bodies + 1]: that of each body, and of the ground, where all joints hold but one. */
static void find_parts(const mt_system *sys, int joint, int *part)
{
    for (int b = 0; b <= sys->n_bodies; b++) {
        part[b] = b;
    }
    for (int i = 0; i < sys->n_constraints; i++) {
        const mt_constraint_def *const c = &sys->constraints[i];
        const int first = index_of_body(sys, sys->measures[c->measure[0]].body[0]);
        for (int e = 1; e < 2 * c->terms && c->joint != joint; e++) {
            const int body = sys->measures[c->measure[e / 2]].body[e % 2];
            join_parts(part, first, index_of_body(sys, body));
        }
    }
    for (int b = sys->n_bodies; b >= 0; b--) {
        part[b] = part[part[b]];
    }
}

/* v[nq] := the motion of that part which the force of a joint's first body on its second works
 * on; moved[n_bodies + 1]. False: the joint is not the only one between two parts. */
static bool cut_at_joint(work *k, const mt_port *port, int *moved, double *v)
{
    const mt_system *const sys = k->l->sys;
    const mt_system_joint *const j = &sys->joints[port->index];
    const int ground = sys->n_bodies;
    find_parts(sys, port->index, moved);
    const int one = moved[index_of_body(sys, j->body[0])];
    const int two = moved[index_of_body(sys, j->body[1])];
    const bool second = two != moved[ground];
    const int part = second ? two : one;
    if (one == two || part == moved[ground]) {
        return false;
    }
    memset(v, 0, (size_t)sys->nq * sizeof *v);
    for (int b = 0; b <= ground; b++) {
        moved[b] = moved[b] == part ? 1 : 0;
        if (moved[b] == 1 && sys->bodies[b].dof[port->axis] >= 0) {
            v[sys->bodies[b].dof[port->axis]] = second ? 1.0 : -1.0;
        }
    }
    return true;
}

/* What of the terms' coefficients is meant: times their loss factor less a common one, or all
 * of it. */
typedef struct coefficient {
    bool lossy;
    double less;
} coefficient;

/* k->states += c times a term's rows' products with v. */
static void add_term_product(work *k, mt_term_kind kind, const mt_term *t, double c,
                             const double *v)
{
    mt_cx rows[MOST_ROWS * MT_LOCAL];
    double dot[MOST_ROWS] = {0.0};
    mt_term_rows(&k->d, kind, t, k->at.pose, rows);
    for (int r = 0; r < t->count; r++) {
        for (int q = 0; q < MT_LOCAL; q++) {
            const int dof = mt_local_dof(k->l->sys, t->body, q);
            dot[r] += dof < 0 ? 0.0 : creal(rows[(r * MT_LOCAL) + q]) * v[dof];
        }
    }
    for (int r = 0; r < t->count; r++) {
        add_term_row(k, t, rows + ((ptrdiff_t)r * MT_LOCAL), c * dot[t->pair ? 1 - r : r]);
    }
}

/* k->states := the matrix of the terms of a kind times v; moved (NULL: all terms): only those
 * between bodies that are moved and others. *is false: a term of too many rows. */
static void multiply_terms(work *k, mt_term_kind kind, const int *moved, coefficient of,
                           const double *v, bool *is)
{
    const mt_system *const sys = k->l->sys;
    clear(k);
    for (int i = 0; i < k->list[kind].n_terms; i++) {
        const mt_term *const t = &k->list[kind].terms[i];
        const bool counts = moved == NULL || moved[index_of_body(sys, t->body[0])] !=
                                                 moved[index_of_body(sys, t->body[1])];
        const double by = of.lossy ? large_value(k, t->loss) - of.less : 1.0;
        const double c = by * large_value(k, t->coefficient) * (t->pair ? 0.5 : 1.0);
        *is = *is && (!counts || t->count <= MOST_ROWS);
        if (*is && counts && c != 0.0) {
            add_term_product(k, kind, t, c, v);
        }
    }
}

/* What inputs pass on, -v . f; k->states is overwritten. */
static void pass_inputs(work *k, const double *v, double *d)
{
    for (int i = 0; i < k->ports->n_in; i++) {
        const mt_port *const port = &k->ports->in[i];
        if (port->kind == MT_PORT_BASE) {
            large_base_force(k, port->index);
        } else {
            large_sensor_row(k, port->index);
        }
        d[i] = -mt_dot(k->l->sys->nq, v, k->states);
    }
}

/* v -= K^-1 K v, K v being k->states. */
static mt_status smooth_cut(work *k, double *v, mt_err *err)
{
    const size_t nq = (size_t)k->l->sys->nq;
    const mt_arena_mark mark = mt_arena_get_mark(k->scratch);
    double *const phi = mt_arena_f64(k->scratch, nq, 1);
    mt_lowest_push push;
    mt_lowest_push_init(k->l, k->scratch, &push);
    MT_TRY(mt_arena_check(k->scratch, err));
    MT_TRY(mt_lowest_force(k->l, k->states, &push, err));
    mt_absolute_shape(&k->l->bodies, push.x, phi);
    mt_axpy((int)nq, -1.0, phi, v);
    mt_arena_rewind(k->scratch, mark);
    return MT_OK;
}

/* K v + i H v of springs, C v and M v as forces of output o. */
static mt_status open_joint_forces(work *k, int o, const int *moved, double *v, bool *is,
                                   mt_err *err)
{
    const mt_system *const sys = k->l->sys;
    const bool smooth = k->l->way == MT_LOWEST_SPARSE && k->shift == 0.0;
    const coefficient whole = {.lossy = false};
    const coefficient lossy = {
        .lossy = true,
        .less = smooth ? mt_terms_common_loss(&k->d, &k->list[MT_TERM_STIFFNESS]) : 0.0};
    cut *const own = &k->cuts[o];
    multiply_terms(k, MT_TERM_STIFFNESS, moved, whole, v, is);
    if (*is && smooth) {
        MT_TRY(smooth_cut(k, v, err));
        moved = NULL;
    } else if (*is && mt_max_abs(sys->nq, k->states) > 0.0) {
        MT_TRY(add_output_force(k, (out_term){.of = o, .re = 1.0}, err));
        add_output_term(
            k, (out_term){.of = o, .power = 1, .re = large_value(k, sys->damping.stiffness)});
    }
    multiply_terms(k, MT_TERM_STIFFNESS, moved, lossy, v, is);
    if (*is && mt_max_abs(sys->nq, k->states) > 0.0) {
        MT_TRY(add_output_force(k, (out_term){.of = o, .im = 1.0}, err));
    }
    multiply_terms(k, MT_TERM_DAMPING, moved, whole, v, is);
    if (*is && mt_max_abs(sys->nq, k->states) > 0.0) {
        MT_TRY(add_output_force(k, (out_term){.of = o, .power = 1, .re = 1.0}, err));
    }
    multiply_terms(k, MT_TERM_MASS, NULL, whole, v, is);
    if (!*is) {
        *is = large_refuse(k, "a spring or damper of so many rows needs all modes");
        return MT_OK;
    }
    own->output = o;
    own->mass = k->n_outs;
    own->kg = mt_dot(sys->nq, v, k->states);
    MT_TRY(add_output_force(k, (out_term){.of = o, .power = 2, .re = 1.0}, err));
    add_output_term(k,
                    (out_term){.of = o, .power = 1, .re = large_value(k, sys->damping.mass)});
    return MT_OK;
}

static mt_status open_joint_output(work *k, int o, bool *is, mt_err *err)
{
    const mt_system *const sys = k->l->sys;
    int *const moved = mt_arena_int(k->scratch, (size_t)sys->n_bodies + 1);
    double *const v = mt_arena_f64(k->scratch, (size_t)sys->nq, 1);
    cut *const own = &k->cuts[o];
    own->d = mt_arena_f64(k->mem, (size_t)k->ports->n_in, 1);
    MT_TRY(mt_arena_check(k->scratch, err));
    MT_TRY(mt_arena_check(k->mem, err));
    if (sys->loaded) {
        *is = large_refuse(k, "forces in joints under a load need all modes");
    } else if (!cut_at_joint(k, &k->ports->out[o], moved, v)) {
        *is = large_refuse(k, "the force of a joint in a loop of joints needs all modes");
    } else {
        MT_TRY(open_joint_forces(k, o, moved, v, is, err));
    }
    if (*is) {
        pass_inputs(k, v, own->d);
    }
    return MT_OK;
}

static mt_status open_outputs(work *k, bool *is, mt_err *err)
{
    const size_t n = (size_t)k->ports->n_out;
    k->outs = mt_arena_alloc(k->scratch, n * OUT_FORCES, sizeof *k->outs);
    k->term = mt_arena_alloc(k->scratch, n * OUT_TERMS, sizeof *k->term);
    k->cuts = mt_arena_alloc(k->scratch, n, sizeof *k->cuts);
    MT_TRY(mt_arena_check(k->scratch, err));
    for (int o = 0; o < k->ports->n_out && *is; o++) {
        const mt_port *const port = &k->ports->out[o];
        out_term t = {.of = o, .power = large_power(port), .re = 1.0};
        bool one = true;
        k->cuts[o] = (cut){.output = -1};
        if (port->kind == MT_PORT_JOINT) {
            MT_TRY(open_joint_output(k, o, is, err));
            continue;
        }
        if (port->kind == MT_PORT_SENSOR) {
            large_sensor_row(k, port->index);
        } else {
            force_row(k, port, &one, &t.im);
        }
        if (!one) {
            *is = large_refuse(k, "the force of a spring with several loss factors needs "
                                  "all modes");
            return MT_OK;
        }
        MT_TRY(add_output_force(k, t, err));
    }
    return MT_OK;
}

/* Adds one damping row. */
static mt_status add_side(work *k, const mt_term *t, const mt_cx *row, double damping,
                          double structural, int partner, mt_err *err)
{
    side *const s = &k->sides[k->n_sides];
    *s = (side){.damping = damping, .structural = structural, .partner = k->n_sides + partner};
    MT_TRY(new_force(k, &s->f, err));
    clear(k);
    add_term_row(k, t, row, 1.0);
    MT_TRY(mt_lowest_force(k->l, k->states, &s->f.push, err));
    k->n_sides++;
    return MT_OK;
}

/* Rows of all terms of a kind that damp more than all springs alike. */
static mt_status add_terms(work *k, mt_term_kind kind, bool *is, mt_err *err)
{
    mt_cx rows[MOST_ROWS * MT_LOCAL];
    for (int i = 0; i < k->list[kind].n_terms && *is; i++) {
        const mt_term *const t = &k->list[kind].terms[i];
        const double c = large_value(k, t->coefficient);
        const double by = kind == MT_TERM_DAMPING ? c : c * (large_value(k, t->loss) - k->loss);
        if (by == 0.0) {
            continue;
        }
        if (k->n_sides + t->count > MOST_SIDES || t->count > MOST_ROWS) {
            *is = large_refuse(k,
                               "so many springs and dampers that damp each in its own way need "
                               "all modes");
            return MT_OK;
        }
        mt_term_rows(&k->d, kind, t, k->at.pose, rows);
        for (int r = 0; r < t->count; r++) {
            const double part = t->pair ? 0.5 * by : by;
            MT_TRY(add_side(
                k, t, rows + ((ptrdiff_t)r * MT_LOCAL), kind == MT_TERM_DAMPING ? part : 0.0,
                kind == MT_TERM_DAMPING ? 0.0 : part, t->pair ? 1 - (2 * r) : 0, err));
        }
    }
    return MT_OK;
}

static mt_status open_sides(work *k, bool *is, mt_err *err)
{
    const mt_damping_def *const d = &k->l->sys->damping;
    k->alpha = large_value(k, d->mass);
    k->beta = large_value(k, d->stiffness);
    k->loss = mt_terms_common_loss(&k->d, &k->list[MT_TERM_STIFFNESS]);
    k->sides = mt_arena_alloc(k->scratch, MOST_SIDES, sizeof *k->sides);
    MT_TRY(mt_arena_check(k->scratch, err));
    if (k->loss != 0.0 && k->l->sys->loaded) {
        *is = large_refuse(k, "loss factors under a load need all modes");
    } else if (d->n_named > 0) {
        *is = large_refuse(k, "damping ratios of named modes need all modes");
    }
    if (*is) {
        MT_TRY(add_terms(k, MT_TERM_DAMPING, is, err));
    }
    return *is ? add_terms(k, MT_TERM_STIFFNESS, is, err) : MT_OK;
}

/* Forces of all inputs, outputs and local dampers. *is false: refused. Fails: MT_E_MEMORY. */
static mt_status large_forces(work *k, bool *is, mt_err *err)
{
    MT_TRY(mt_terms_new(k->l->sys, k->scratch, k->list, err));
    MT_TRY(mt_absolute_stand(k->l->sys, mt_lowest_settled(k->l), k->l->at, &k->d, &k->at,
                             k->scratch, err));
    MT_TRY(open_inputs(k, err));
    MT_TRY(open_outputs(k, is, err));
    return *is ? open_sides(k, is, err) : MT_OK;
}

/*
 * With X the coordinates (X^T H X = I), of M_r = X^T H A X = Z theta Z^T the problem has unit
 * mass in columns u_j = X z_j theta_j^(-1/2), with lambda_j = 1/theta_j - s, those of the exact
 * modes being known better; of a force f it is theta_j^(-1/2) z_j^T X^T f. Nothing else of size
 * n is formed: H is the identity then, and rows of dampers are forces, too.
 */

/* Shapes of one force, and below what part of it the next one is not worth having. */
enum { MOST_SHAPES = 10 };
static const double NEGLIGIBLE = 1e-9;
/* What is left of a shape beside the others, below which it is one of them. */
static const double DEPENDENT = 1e-8;

/* x -= columns of the first n of k->x. */
static void clear_of(const work *k, int n, double *x)
{
    const double *const dual = mt_lowest_dual(k->l, x, k->dual);
    for (int i = 0; i < n; i++) {
        const double *const own = k->x + ((ptrdiff_t)k->n_x * i);
        mt_axpy(k->n_x, -mt_dot(k->n_x, own, dual), own, x);
    }
}

/* In the norm of H. */
static double dual_norm(const work *k, const double *x)
{
    const double *const dual = mt_lowest_dual(k->l, x, k->dual);
    return dual == x ? mt_norm2(k->n_x, x) : sqrt(fmax(mt_dot(k->n_x, x, dual), 0.0));
}

/* Adds x (overwritten) and its image to the coordinates. */
static mt_status admit_vector(work *k, double *x, mt_err *err)
{
    const double was = dual_norm(k, x);
    double size = was;
    for (int round = 0; round < 2 && size > 0.0; round++) {
        clear_of(k, k->size, x);
        MT_TRY(round == 0 ? mt_lowest_admit(k->l, x, err) : MT_OK);
        size = dual_norm(k, x);
    }
    if (!(size > DEPENDENT * was)) {
        return MT_OK;
    }
    double *const to = k->x + ((ptrdiff_t)k->n_x * k->size);
    for (int j = 0; j < k->n_x; j++) {
        to[j] = x[j] / size;
    }
    MT_TRY(mt_lowest_momentum(k->l, to, k->ax + ((ptrdiff_t)k->n_x * k->size), err));
    k->size++;
    return MT_OK;
}

/* Adds the shapes of one force. */
static mt_status add_shapes(work *k, force *f, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(k->scratch);
    double *const x = mt_arena_f64(k->scratch, (size_t)k->n_x, 3);
    MT_TRY(mt_arena_check(k->scratch, err));
    double *const copy = x + k->n_x;
    double *const next = copy + k->n_x;
    const double m = (k->to * hypot(k->to, k->alpha)) + k->shift;
    memcpy(x, f->push.x, (size_t)k->n_x * sizeof *x);
    clear_of(k, k->kept, x);
    clear_of(k, k->kept, x);
    f->left = (mt_left_part){.size = dual_norm(k, x),
                             .open = dual_norm(k, x),
                             .noise = f->push.noise,
                             .loose = f->push.loose};
    while (f->left.order < MOST_SHAPES &&
           pow(m, f->left.order) * f->left.open > NEGLIGIBLE * f->push.size) {
        memcpy(copy, x, (size_t)k->n_x * sizeof *copy);
        MT_TRY(admit_vector(k, copy, err));
        MT_TRY(mt_lowest_mass(k->l, x, next, err));
        memcpy(x, next, (size_t)k->n_x * sizeof *x);
        clear_of(k, k->kept, x);
        f->left.open = dual_norm(k, x);
        f->left.order++;
    }
    mt_arena_rewind(k->scratch, mark);
    return MT_OK;
}

/* All modes below the first that is left out, which lies above *lambda. */
static bool keep_modes(work *k, double *lambda)
{
    const mt_lowest_modes *const found = &k->l->found;
    const mt_modes *const m = &found->modes;
    for (int i = m->n_rigid; i < m->count; i++) {
        if (m->kind[i] != MT_MODE_FLEXIBLE) {
            return large_refuse(k,
                                "a motion without stiffness is none of its rigid-body modes");
        }
    }
    k->kept = m->count - k->free;
    *lambda = k->kept == m->all - k->free ? HUGE_VAL
              : found->below > m->count   ? m->lambda[m->count - 1]
                                          : found->tau;
    return k->kept > 0 ? true : large_refuse(k, "it has no vibration modes");
}

/* Cancellation leaves the coordinates not quite orthonormal: returns a bound of the norm of X^T
 * H X - I, the relative error of a solution in them, as a part of its force. */
static mt_status find_skew(work *k, double *skew, mt_err *err)
{
    double *const dual = mt_arena_f64(k->scratch, (size_t)k->n_x, 1);
    double *const row = mt_arena_f64(k->scratch, (size_t)k->size, 1);
    MT_TRY(mt_arena_check(k->scratch, err));
    *skew = 0.0;
    for (int i = 0; i < k->size; i++) {
        const double *const x = k->x + ((ptrdiff_t)k->n_x * i);
        const double *const own = mt_lowest_dual(k->l, x, dual);
        double sum = 0.0;
        if (own == x) {
            return MT_OK; /* the recursion's own rounding is in the forces' */
        }
        mt_gemv(true, k->n_x, k->size, 1.0, k->x, k->n_x, own, 0.0, row);
        row[i] -= 1.0;
        for (int j = 0; j < k->size; j++) {
            sum += fabs(row[j]);
        }
        *skew = fmax(*skew, sum);
    }
    return MT_OK;
}

/* Force i of all: inputs, then outputs, then what damps locally. */
static force *nth_force(const work *k, int i)
{
    const int o = i - k->ports->n_in;
    const int s = o - k->n_outs;
    return o < 0 ? &k->in[i] : s < 0 ? &k->outs[o] : &k->sides[s].f;
}

static mt_status make_basis(work *k, mt_err *err)
{
    const int forces = k->ports->n_in + k->n_outs + k->n_sides;
    const size_t n_x = (size_t)k->n_x;
    k->most = k->kept + (forces * MOST_SHAPES);
    k->x = mt_arena_f64(k->scratch, n_x, (size_t)k->most);
    k->ax = mt_arena_f64(k->scratch, n_x, (size_t)k->most);
    k->dual = mt_arena_f64(k->scratch, n_x, 1);
    double *const copy = mt_arena_f64(k->scratch, n_x, 1);
    MT_TRY(mt_arena_check(k->scratch, err));
    for (int i = 0; i < k->kept; i++) {
        memcpy(copy, mt_lowest_mode(k->l, i), n_x * sizeof *copy);
        MT_TRY(admit_vector(k, copy, err));
    }
    for (int i = 0; i < forces; i++) {
        MT_TRY(add_shapes(k, nth_force(k, i), err));
    }
    double skew = 0.0;
    MT_TRY(find_skew(k, &skew, err));
    for (int i = 0; i < forces; i++) {
        force *const f = nth_force(k, i);
        f->left.noise += skew * f->push.size;
    }
    return MT_OK;
}

/* f->in_all, of rigid-body modes first. */
static mt_status reduce_force(const work *k, force *f, mt_err *err)
{
    const int n = k->size;
    f->in_all = mt_arena_f64(k->scratch, (size_t)k->free + (size_t)n, 1);
    double *const by = mt_arena_f64(k->scratch, (size_t)n, 1);
    MT_TRY(mt_arena_check(k->scratch, err));
    memcpy(f->in_all, f->push.a, (size_t)k->free * sizeof *f->push.a);
    mt_gemv(true, k->n_x, n, 1.0, k->x, k->n_x, f->push.dual != NULL ? f->push.dual : f->push.x,
            0.0, by);
    mt_gemv(true, n, n, 1.0, k->z, n, by, 0.0, f->in_all + k->free);
    for (int j = 0; j < n; j++) {
        f->in_all[k->free + j] /= sqrt(k->theta[j]);
    }
    return MT_OK;
}

/* Modes of the few coordinates: the exact ones are known better. */
static mt_status find_modes(work *k, bool *is, mt_err *err)
{
    mt_modes *const m = &k->out->modes;
    const mt_modes *const exact = &k->l->found.modes;
    const int n = k->free + k->size;
    const size_t all = (size_t)n;
    k->z = mt_arena_f64(k->scratch, (size_t)k->size, (size_t)k->size);
    k->theta = mt_arena_f64(k->scratch, (size_t)k->size, 1);
    *m = (mt_modes){.n = n, .all = n, .count = n, .shaped = n, .n_rigid = k->free};
    m->lambda = mt_arena_f64(k->mem, all, 1);
    m->error = mt_arena_f64(k->mem, all, 1);
    m->y = mt_arena_f64(k->mem, all, all);
    m->kind = mt_arena_alloc(k->mem, all, sizeof *m->kind);
    m->cluster = mt_arena_int(k->mem, all);
    MT_TRY(mt_arena_check(k->scratch, err));
    MT_TRY(mt_arena_check(k->mem, err));
    mt_gemm(true, false, k->size, k->size, k->n_x, 1.0, k->x, k->n_x, k->ax, k->n_x, 0.0, k->z,
            k->size);
    const mt_status rc = mt_eig_graded(k->size, k->z, k->theta, k->scratch, err);
    if (rc == MT_E_NOT_SPD) {
        *is = large_refuse(k, "sixteen digits do not resolve what its modes leave out");
        return MT_OK;
    }
    MT_TRY(rc);
    for (int i = 0; i < n; i++) {
        const int j = i - k->free;
        m->y[(ptrdiff_t)i * (n + 1)] = 1.0;
        m->kind[i] = i < k->free ? MT_MODE_RIGID_BODY : MT_MODE_FLEXIBLE;
        m->cluster[i] = i;
        if (j >= 0) {
            m->lambda[i] = j < k->kept ? exact->lambda[i] : (1.0 / k->theta[j]) - k->shift;
            m->error[i] =
                j < k->kept ? exact->error[i] : (double)n * DBL_EPSILON * m->lambda[i];
        }
    }
    return MT_OK;
}

/* What modal damping ratios make of c at coordinate i, 2 zeta omega. */
static double rate_of_ratio(const work *k, ptrdiff_t i)
{
    const mt_damping_def *const d = &k->l->sys->damping;
    const mt_modes *const m = &k->out->modes;
    const ptrdiff_t index = i - m->n_rigid;
    if (!d->modal || index < 0) {
        return 0.0;
    }
    const double ratio = large_value(k, index < d->n_ratios ? d->ratios[index] : d->ratio);
    return 2.0 * ratio * sqrt(m->lambda[i]);
}

/* f.c and f.h in the few coordinates. */
static mt_status damp(work *k, mt_err *err)
{
    const mt_modes *const m = &k->out->modes;
    const ptrdiff_t n = m->n;
    double *const c = mt_arena_f64(k->mem, (size_t)n, (size_t)n);
    double *const h = mt_arena_f64(k->mem, (size_t)n, (size_t)n);
    MT_TRY(mt_arena_check(k->mem, err));
    for (ptrdiff_t i = 0; i < n; i++) {
        c[i * (n + 1)] = k->alpha + (k->beta * m->lambda[i]) + rate_of_ratio(k, i);
        h[i * (n + 1)] = k->loss * m->lambda[i];
    }
    for (int s = 0; s < k->n_sides; s++) {
        const side *const own = &k->sides[s];
        const double *const left = own->f.in_all;
        const double *const right = k->sides[own->partner].f.in_all;
        for (ptrdiff_t at = 0; at < n * n; at++) {
            c[at] += own->damping * left[at % n] * right[at / n];
            h[at] += own->structural * left[at % n] * right[at / n];
        }
    }
    k->out->f.c = mt_max_abs(n * n, c) > 0.0 ? c : NULL;
    k->out->f.h = mt_max_abs(n * n, h) > 0.0 ? h : NULL;
    return MT_OK;
}

/* The forced problem while it is filled. */
typedef struct filling {
    double *b[MT_FORCED_POWERS];
    double *s[MT_FORCED_POWERS];
    double *d[MT_FORCED_POWERS];
    double *s_im;
    double *e[2];
} filling;

static double *ensure(const work *k, double **m, int rows, int cols)
{
    if (*m == NULL) {
        *m = mt_arena_f64(k->mem, (size_t)rows, (size_t)cols);
    }
    return *m;
}

/* Adds the ground motion to a sensor's motion in space. */
static mt_status add_ground(work *k, int o, filling *f, mt_err *err)
{
    const mt_port *const out = &k->ports->out[o];
    const mt_system *const sys = k->l->sys;
    large_sensor_row(k, out->index);
    for (int i = 0; i < k->ports->n_in && !out->relative; i++) {
        const mt_port *const in = &k->ports->in[i];
        if (in->kind != MT_PORT_BASE) {
            continue;
        }
        const int power = out->motion - in->motion;
        double *const to = ensure(k, power >= 0 ? &f->d[power] : &f->e[-power - 1],
                                  k->ports->n_out, k->ports->n_in);
        MT_TRY(mt_arena_check(k->mem, err));
        double sum = 0.0;
        for (int b = 0; b < sys->n_bodies; b++) {
            const int q = sys->bodies[b].dof[in->index];
            sum += q >= 0 ? k->states[q] : 0.0;
        }
        to[o + ((ptrdiff_t)i * k->ports->n_out)] = sum;
    }
    return MT_OK;
}

/* What inputs pass on to a joint's force, and modal damping ratios do to it. */
static mt_status fill_cut(work *k, const cut *own, filling *f, mt_err *err)
{
    const int n = k->out->modes.n;
    const ptrdiff_t n_out = k->ports->n_out;
    double *const s = ensure(k, &f->s[1], n, k->ports->n_out);
    MT_TRY(mt_arena_check(k->mem, err));
    for (ptrdiff_t j = 0; j < n; j++) {
        s[j + ((ptrdiff_t)own->output * n)] +=
            rate_of_ratio(k, j) * k->outs[own->mass].in_all[j];
    }
    for (int i = 0; i < k->ports->n_in; i++) {
        double *const d = ensure(k, &f->d[mt_response_power(&k->ports->in[i])], k->ports->n_out,
                                 k->ports->n_in);
        MT_TRY(mt_arena_check(k->mem, err));
        d[own->output + (i * n_out)] = own->d[i];
    }
    return MT_OK;
}

static mt_status fill_reduced_problem(work *k, mt_err *err)
{
    const int n = k->out->modes.n;
    const size_t bytes = (size_t)n * sizeof(double);
    const mt_port_set *const ports = k->ports;
    filling f = {.b = {NULL}};
    double *const stiffness = mt_arena_f64(k->mem, (size_t)n, (size_t)n);
    MT_TRY(mt_arena_check(k->mem, err));
    for (ptrdiff_t i = 0; i < n; i++) {
        stiffness[i * (n + 1)] = k->out->modes.lambda[i];
    }
    for (int i = 0; i < ports->n_in; i++) {
        double *const b = ensure(k, &f.b[mt_response_power(&ports->in[i])], n, ports->n_in);
        MT_TRY(mt_arena_check(k->mem, err));
        memcpy(b + ((ptrdiff_t)i * n), k->in[i].in_all, bytes);
    }
    for (int t = 0; t < k->n_terms; t++) {
        const out_term *const own = &k->term[t];
        const double *const in_all = k->outs[own->f].in_all;
        double *const s = ensure(k, &f.s[own->power], n, ports->n_out);
        MT_TRY(mt_arena_check(k->mem, err));
        mt_axpy(n, own->re, in_all, s + ((ptrdiff_t)own->of * n));
        if (own->im != 0.0) {
            double *const im = ensure(k, &f.s_im, n, ports->n_out);
            MT_TRY(mt_arena_check(k->mem, err));
            mt_axpy(n, own->im, in_all, im + ((ptrdiff_t)own->of * n));
        }
    }
    for (int o = 0; o < ports->n_out; o++) {
        if (ports->out[o].kind == MT_PORT_SENSOR) {
            MT_TRY(add_ground(k, o, &f, err));
        } else if (k->cuts[o].output >= 0) {
            MT_TRY(fill_cut(k, &k->cuts[o], &f, err));
        }
    }
    mt_forced *const to = &k->out->f;
    to->n = n;
    to->k = stiffness;
    to->m = k->out->modes.y; /* the identity */
    to->n_in = ports->n_in;
    to->n_out = ports->n_out;
    for (int p = 0; p < MT_FORCED_POWERS; p++) {
        to->b[p] = f.b[p];
        to->s[p] = f.s[p];
        to->d[p] = f.d[p];
    }
    to->s_im = f.s_im;
    to->e[0] = f.e[0];
    to->e[1] = f.e[1];
    return MT_OK;
}

/* Largest damping ratio of the modes left out. */
static double ratio_left(const work *k)
{
    const mt_damping_def *const d = &k->l->sys->damping;
    double most = d->modal ? large_value(k, d->ratio) : 0.0;
    for (int i = k->kept; d->modal && i < d->n_ratios; i++) {
        most = fmax(most, large_value(k, d->ratios[i]));
    }
    return most;
}

/* 4 zeta (v^T M v of the modes left out)^(1/2), of the motion of a cut. */
static double rate_left(const work *k, const cut *own)
{
    double kg = own->kg;
    for (int j = 0; j < k->free + k->kept; j++) {
        const double part = k->outs[own->mass].in_all[j];
        kg -= part * part;
    }
    /* the shapes beside the modes diminish it, but their damping is that of no mode */
    return 4.0 * ratio_left(k) * sqrt(fmax(kg, 0.0));
}

static mt_status note_left(work *k, double lambda, mt_err *err)
{
    const mt_port_set *const ports = k->ports;
    const size_t n = (size_t)k->out->modes.n;
    const size_t sides = (size_t)k->n_sides;
    mt_left_out *const left = mt_arena_alloc(k->mem, 1, sizeof *left);
    const size_t terms = (size_t)k->n_terms;
    mt_left_part *const part =
        mt_arena_alloc(k->mem, (size_t)ports->n_in + terms + sides, sizeof *part);
    double *const power = mt_arena_f64(k->mem, (size_t)ports->n_in + terms, 1);
    double *const rate = mt_arena_f64(k->mem, (size_t)ports->n_out, 1);
    int *const of = mt_arena_int(k->mem, terms);
    double *const row = mt_arena_f64(k->mem, n, sides);
    double *const damping = mt_arena_f64(k->mem, sides, 2);
    double *const root = mt_arena_f64(k->mem, n, 1);
    MT_TRY(mt_arena_check(k->mem, err));
    mt_left_part *const out = part + ports->n_in;
    mt_left_part *const side_of = out + terms;
    for (int i = 0; i < ports->n_in; i++) {
        part[i] = k->in[i].left;
        power[i] = mt_response_power(&ports->in[i]);
    }
    for (int t = 0; t < k->n_terms; t++) {
        const out_term *const own = &k->term[t];
        const double by = hypot(own->re, own->im);
        out[t] = k->outs[own->f].left;
        out[t].size *= by;
        out[t].open *= by;
        out[t].noise *= by;
        out[t].loose *= by;
        of[t] = own->of;
        power[ports->n_in + t] = own->power;
    }
    for (int o = 0; o < ports->n_out; o++) {
        rate[o] = k->cuts[o].output < 0 ? 0.0 : rate_left(k, &k->cuts[o]);
    }
    for (size_t s = 0; s < sides; s++) {
        const side *const own = &k->sides[s];
        side_of[s] = k->sides[own->partner].f.left;
        damping[s] = own->damping;
        damping[sides + s] = own->structural;
        memcpy(row + (s * n), own->f.in_all, n * sizeof *row);
    }
    for (size_t j = 0; j < n; j++) {
        root[j] = j < (size_t)k->free ? 0.0 : sqrt(k->out->modes.lambda[j] + k->shift);
    }
    *left = (mt_left_out){.lambda = lambda,
                          .shift = k->shift,
                          .root = root,
                          .alpha = k->alpha,
                          .beta = k->beta,
                          .loss = fabs(k->loss),
                          .ratio = ratio_left(k),
                          .in = part,
                          .n_out = k->n_terms,
                          .out = out,
                          .out_of = of,
                          .out_rate = rate,
                          .n_side = k->n_sides,
                          .side = side_of,
                          .row = row,
                          .damping = damping,
                          .structural = damping + sides,
                          .in_power = power,
                          .out_power = power + ports->n_in};
    k->out->left = left;
    k->out->shapes = k->size - k->kept;
    return MT_OK;
}

static mt_status reduce_all(const work *k, mt_err *err)
{
    for (int i = 0; i < k->ports->n_in; i++) {
        MT_TRY(reduce_force(k, &k->in[i], err));
    }
    for (int o = 0; o < k->n_outs; o++) {
        MT_TRY(reduce_force(k, &k->outs[o], err));
    }
    for (int s = 0; s < k->n_sides; s++) {
        MT_TRY(reduce_force(k, &k->sides[s].f, err));
    }
    return MT_OK;
}

static mt_status make_reduced_problem(work *k, bool *is, mt_err *err)
{
    const mt_system *const sys = k->l->sys;
    double lambda = 0.0;
    k->states = mt_arena_f64(k->scratch, (size_t)sys->nq, 1);
    MT_TRY(mt_arena_check(k->scratch, err));
    *is = keep_modes(k, &lambda);
    if (!*is) {
        return MT_OK;
    }
    MT_TRY(large_forces(k, is, err));
    if (!*is) {
        return MT_OK;
    }
    MT_TRY(make_basis(k, err));
    MT_TRY(find_modes(k, is, err));
    if (!*is) {
        return MT_OK;
    }
    MT_TRY(reduce_all(k, err));
    MT_TRY(damp(k, err));
    MT_TRY(fill_reduced_problem(k, err));
    return note_left(k, lambda, err);
}

mt_status mt_large_make(mt_lowest *l, const mt_port_set *ports, double to, mt_arena *mem,
                        mt_large *out, bool *is, char why[MT_LARGE_WHY], mt_err *err)
{
    mt_arena scratch;
    *out = (mt_large){.shapes = 0};
    *is = false;
    why[0] = '\0';
    MT_TRY(mt_lowest_open_forced(l, is, err));
    if (!*is) {
        (void)mt_snprintf(why, MT_LARGE_WHY, "sixteen digits do not resolve its motions");
        return MT_OK;
    }
    MT_TRY(mt_arena_init(&scratch, 0, err));
    work k = {.l = l,
              .ports = ports,
              .mem = mem,
              .scratch = &scratch,
              .out = out,
              .why = why,
              .n_x = mt_lowest_coordinates(l),
              .free = mt_lowest_free(l),
              .to = to,
              .shift = mt_lowest_shift(l)};
    const mt_status rc = make_reduced_problem(&k, is, err);
    mt_arena_free(&scratch);
    return rc;
}
