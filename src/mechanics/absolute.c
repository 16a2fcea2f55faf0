/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Absolute coordinates of groups of bodies. */
#include "mechanics/absolute.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/format.h"
#include "base/run.h"
#include "linalg/dense.h"
#include "mechanics/lagrangian.h"
#include "mechanics/rows.h"

/* Groups, springs and masses. */

/* A gap below this times the model length is rounding of the drawing's own numbers. */
static const double DRAWN_CLOSED = 1e-13;

/* Rows of one term, at most: two bars and two deflections of a beam. */
enum { MOST_ROWS = 16 };

/* Bodies that fixed joints hold together move as the first of them; those that they hold to the
 * ground do not. */
typedef struct groups {
    const mt_system *sys;
    const mt_placement *at;
    double *arm; /* 3 x bodies */
    int *with;   /* [bodies] as of mt_absolute */
    int *body;   /* [nq] of a state */
    int *which;  /* [nq] 0 .. 5 */
    int *place;  /* [nq] */
    int *part;   /* [nq] of a coordinate */
    int n;
    int n_parts;
} groups;

static int first_of(const groups *g, int b)
{
    while (b != MT_GROUND && g->with[b] != b) {
        const int next = g->with[b];
        g->with[b] = next == MT_GROUND ? next : g->with[next]; /* half the way for the next */
        b = next;
    }
    return b;
}

/* The measures of a fixed joint are those of two bodies that turn. */
static bool turns(const mt_system *sys, int b)
{
    return b == MT_GROUND || sys->bodies[b].dof[5] >= 0;
}

static mt_status group(groups *g, mt_arena *mem, mt_arena *scratch, mt_err *err)
{
    const mt_system *const sys = g->sys;
    const size_t nq = (size_t)sys->nq;
    g->with = mt_arena_int(mem, (size_t)sys->n_bodies);
    g->place = mt_arena_int(mem, nq);
    g->part = mt_arena_int(mem, nq);
    g->body = mt_arena_int(scratch, nq);
    g->which = mt_arena_int(scratch, nq);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_arena_check(scratch, err));
    for (int b = 0; b < sys->n_bodies; b++) {
        g->with[b] = b;
    }
    for (int i = 0; i < sys->n_joints; i++) {
        const mt_system_joint *const j = &sys->joints[i];
        if (j->type != MT_JOINT_FIXED || !turns(sys, j->body[0]) || !turns(sys, j->body[1])) {
            continue;
        }
        const int a = first_of(g, j->body[0]);
        const int b = first_of(g, j->body[1]);
        if (a != b && (a == MT_GROUND || (b != MT_GROUND && a < b))) {
            g->with[b] = a;
        } else if (a != b) {
            g->with[a] = b;
        }
    }
    for (int b = 0; b < sys->n_bodies; b++) {
        const int first = first_of(g, b);
        for (int k = 0; k < 6; k++) {
            const int dof = sys->bodies[b].dof[k];
            if (dof >= 0) {
                g->body[dof] = b;
                g->which[dof] = k;
                g->place[dof] = -1;
            }
            if (dof >= 0 && first == b) {
                g->part[g->n] = g->n_parts;
                g->place[dof] = g->n++;
            }
        }
        g->n_parts += first == b ? 1 : 0;
        g->with[b] = first;
    }
    return MT_OK;
}

/* Vector to each body from the first body of its group. */
static mt_status measure_arms(groups *g, mt_arena *mem, mt_err *err)
{
    g->arm = mt_arena_f64(mem, 3, (size_t)g->sys->n_bodies);
    MT_TRY(mt_arena_check(mem, err));
    for (int b = 0; b < g->sys->n_bodies; b++) {
        for (int k = 0; k < 3 && g->with[b] != MT_GROUND; k++) {
            g->arm[(3 * b) + k] =
                creal(g->at->pose[b].x[k]) - creal(g->at->pose[g->with[b]].x[k]);
        }
    }
    return MT_OK;
}

static void add_entry(const groups *g, int dof, double value, mt_sparse_row *row)
{
    int at = 0;
    if (dof < 0 || value == 0.0) {
        return;
    }
    while (at < row->n && row->dof[at] != g->place[dof]) {
        at++;
    }
    if (at == row->n) {
        row->dof[at] = g->place[dof];
        row->a[row->n++] = 0.0;
    }
    row->a[at] += value;
}

/* value times the motion along state dof: of the first body of its group, dx_k + (theta x r)_k,
 * r from that body's centre. */
static void add_motion(const groups *g, int dof, double value, mt_sparse_row *row)
{
    const int b = g->body[dof];
    const int first = g->with[b];
    const int k = g->which[dof];
    if (first == MT_GROUND) {
        return;
    }
    const int *const to = g->sys->bodies[first].dof;
    add_entry(g, to[k], value, row);
    if (k < 3 && first != b) {
        const double *const r = g->arm + ((ptrdiff_t)3 * b);
        const int next = (k + 1) % 3;
        const int last = (k + 2) % 3;
        add_entry(g, to[3 + next], value * r[last], row);
        add_entry(g, to[3 + last], -value * r[next], row);
    }
}

/* True where these bodies (n, or MT_GROUND) are in one group. */
static bool absolute_together(const mt_absolute *o, const int *body, int n)
{
    const int first = body[0] == MT_GROUND ? MT_GROUND : o->with[body[0]];
    for (int i = 1; i < n; i++) {
        if ((body[i] == MT_GROUND ? MT_GROUND : o->with[body[i]]) != first) {
            return false;
        }
    }
    return true;
}

static void push_row(const mt_sparse_row *from, int row, mt_rows *out)
{
    for (int k = 0; k < from->n; k++) {
        if (from->a[k] != 0.0) {
            mt_rows_push(out, row, from->dof[k], from->a[k]);
        }
    }
    mt_rows_end(out, row);
}

/* x + sign y, over the freedoms of a term's bodies. */
static void push_term(const groups *g, const mt_term *t, const mt_cx *x, const mt_cx *y,
                      double sign, int row, mt_rows *out)
{
    mt_sparse_row sum = {.n = 0};
    for (int k = 0; k < MT_LOCAL; k++) {
        const double value = creal(x[k]) + (y == NULL ? 0.0 : sign * creal(y[k]));
        const int dof = mt_local_dof(g->sys, t->body, k);
        if (dof >= 0 && value != 0.0) {
            add_motion(g, dof, value, &sum);
        }
    }
    push_row(&sum, row, out);
}

/* c (x y^T + y x^T)/2 = c/4 ((x + y)(x + y)^T - (x - y)(x - y)^T). */
static mt_status squares_of(const mt_data *d, const mt_absolute *o, const groups *g,
                            mt_term_kind kind, const mt_term_list *list, mt_arena *mem,
                            mt_squares *out, mt_err *err)
{
    mt_cx rows[MOST_ROWS * MT_LOCAL];
    double *const c = mt_arena_f64(mem, (size_t)list->n_rows, 1);
    mt_rows_begin(&out->row, list->n_rows, (size_t)list->n_rows * MT_LOCAL, mem);
    MT_TRY(mt_arena_check(mem, err));
    out->c = c;
    for (int i = 0; i < list->n_terms; i++) {
        const mt_term *const t = &list->terms[i];
        /* a spring between bodies that move together has no strain but rounding */
        const bool inner = kind == MT_TERM_STIFFNESS && absolute_together(o, t->body, 2);
        const double value = inner ? 0.0 : d->value[t->coefficient];
        if (t->count > MOST_ROWS) {
            return mt_fail(err, MT_E_INTERNAL, "a term of %d rows", t->count);
        }
        mt_term_rows(d, kind, t, g->at->pose, rows);
        for (int r = 0; r < t->count; r++) {
            const mt_cx *const row = rows + ((ptrdiff_t)r * MT_LOCAL);
            const double sign = r == 0 ? 1.0 : -1.0;
            c[t->first + r] = t->pair ? 0.25 * sign * value : value;
            push_term(g, t, t->pair ? rows : row, t->pair ? rows + MT_LOCAL : NULL, sign,
                      t->first + r, &out->row);
        }
    }
    return MT_OK;
}

/* True where the bodies of constraint i of the system are in one group; it then has no rows in
 * a. */
static bool absolute_holds_already(const mt_absolute *o, int i)
{
    const mt_constraint_def *const c = &o->sys->constraints[i];
    int body[4] = {MT_GROUND, MT_GROUND, MT_GROUND, MT_GROUND};
    for (int k = 0; k < 2 * c->terms; k++) {
        body[k] = o->sys->measures[c->measure[k / 2]].body[k % 2];
    }
    return absolute_together(o, body, 2 * c->terms);
}

/* Rows of the constraints' Jacobian; *closed: they hold in the drawn position. */
static mt_status constrain(const mt_data *d, mt_absolute *o, const groups *g, mt_arena *mem,
                           mt_arena *scratch, bool *closed, char *why, mt_err *err)
{
    const mt_system *const sys = d->sys;
    const size_t m = (size_t)sys->n_constraints;
    int n = 0;
    mt_lagrangian l;
    MT_TRY(mt_lagrangian_init_rows(&l, sys, scratch, err));
    mt_lagrangian_eval(d, MT_ENERGY_PHYSICAL, g->at->pose, g->at, (int)m, NULL,
                       MT_CURVATURE_NONE, &l);
    *closed = true;
    for (size_t i = 0; i < m && *closed; i++) {
        n += absolute_holds_already(o, (int)i) ? 0 : 1;
        *closed = fabs(l.c[i]) <= DRAWN_CLOSED * sys->length_m;
        if (!*closed) {
            (void)mt_snprintf(why, MT_ABSOLUTE_WHY,
                              "joint \"%s\" is not closed in the reference "
                              "position",
                              sys->joints[sys->constraints[i].joint].name);
        }
    }
    mt_rows_begin(&o->a, n, (size_t)n * 2 * MT_LOCAL, mem);
    MT_TRY(mt_arena_check(mem, err));
    n = 0;
    for (int i = 0; i < (int)m && *closed; i++) {
        mt_sparse_row row = {.n = 0};
        for (int k = 0; k < l.row[i].n; k++) {
            add_motion(g, l.row[i].dof[k], l.row[i].a[k], &row);
        }
        if (!absolute_holds_already(o, i)) {
            push_row(&row, n++, &o->a);
        }
    }
    return MT_OK;
}

/* The unit of each state, and the total mass, from the motion along x. */
static mt_status set_state_units(mt_absolute *o, const groups *g, mt_arena *mem,
                                 mt_arena *scratch, mt_err *err)
{
    const mt_system *const sys = o->sys;
    double *const along = mt_arena_f64(scratch, (size_t)o->n, 1);
    o->unit = mt_arena_f64(mem, (size_t)o->n, 1);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_arena_check(scratch, err));
    for (int dof = 0; dof < sys->nq; dof++) {
        if (g->place[dof] >= 0) {
            o->unit[g->place[dof]] = g->which[dof] < 3 ? 1.0 : 1.0 / sys->length_m;
            along[g->place[dof]] = g->which[dof] == 0 ? 1.0 : 0.0;
        }
    }
    for (int r = 0; r < o->m.row.n_rows; r++) {
        const double part = mt_rows_dot(&o->m.row, r, along);
        o->mass_kg += o->m.c[r] * part * part;
    }
    return MT_OK;
}

mt_status mt_absolute_stand(const mt_system *sys, const mt_state *settled, const double *inputs,
                            mt_data *data, mt_placement *at, mt_arena *mem, mt_err *err)
{
    double *const value = mt_arena_f64(mem, (size_t)sys->program.count, 1);
    MT_TRY(mt_data_init(data, sys, mem, err));
    MT_TRY(mt_placement_init(at, sys, mem, err));
    MT_TRY(mt_program_eval(&sys->program, inputs, value, NULL, err));
    data->value = value;
    mt_data_vecs(data);
    mt_data_targets(data);
    if (settled == NULL) {
        mt_data_drawn(data, at->pose);
        mt_data_rest(data, at->pose);
    } else {
        mt_placement_copy(sys, &settled->at, at);
        mt_data_rest(data, settled->reference.pose);
    }
    return MT_OK;
}

static mt_status make_absolute(mt_absolute *o, const double *inputs, mt_arena *mem,
                               mt_arena *scratch, bool *is, char *why, mt_err *err)
{
    const mt_system *const sys = o->sys;
    mt_data data;
    mt_placement at;
    mt_term_list list[MT_TERM_KINDS];
    MT_TRY(mt_terms_new(sys, scratch, list, err));
    MT_TRY(mt_absolute_stand(sys, o->settled, inputs, &data, &at, scratch, err));
    MT_TRY(mt_interrupt_check(sys->run->interrupt, err));
    *is = !sys->driven;
    if (!*is) {
        (void)mt_snprintf(why, MT_ABSOLUTE_WHY, "a joint is driven");
        return MT_OK;
    }
    groups g = {.sys = sys, .at = &at};
    MT_TRY(group(&g, mem, scratch, err));
    MT_TRY(measure_arms(&g, mem, err));
    o->n = g.n;
    o->with = g.with;
    o->place = g.place;
    o->part = g.part;
    o->arm = g.arm;
    MT_TRY(constrain(&data, o, &g, mem, scratch, is, why, err));
    MT_TRY(mt_interrupt_check(sys->run->interrupt, err));
    if (*is) {
        MT_TRY(squares_of(&data, o, &g, MT_TERM_STIFFNESS, &list[MT_TERM_STIFFNESS], mem, &o->k,
                          err));
        MT_TRY(mt_interrupt_check(sys->run->interrupt, err));
        MT_TRY(squares_of(&data, o, &g, MT_TERM_MASS, &list[MT_TERM_MASS], mem, &o->m, err));
        MT_TRY(set_state_units(o, &g, mem, scratch, err));
    }
    return mt_interrupt_check(sys->run->interrupt, err);
}

mt_status mt_absolute_new(const mt_system *sys, const double *inputs, const mt_state *settled,
                          mt_arena *mem, mt_absolute *out, bool *is, char why[MT_ABSOLUTE_WHY],
                          mt_err *err)
{
    mt_arena scratch = {.first = NULL};
    *out = (mt_absolute){.sys = sys, .settled = settled};
    *is = false;
    why[0] = '\0';
    mt_status rc = mt_arena_init(&scratch, 0, err);
    rc = rc == MT_OK ? make_absolute(out, inputs, mem, &scratch, is, why, err) : rc;
    mt_arena_free(&scratch);
    return rc;
}

/*
 * Loads on a mechanism at rest. Of V and of mu times the constraints, measure by
 * measure with the force c, gradient c g and Hessian c h over the motions (dx, theta) of two
 * bodies. A body with the arm r from the first of its group moves by theta and
 *     dx = dx_1 + theta x r + theta x (theta x r)/2,
 * so that in the group's motions, dx = T x to first order,
 *     c T^T g    and    c T^T h T + S,  S = (f r^T + r f^T)/2 - (f . r) I on its rotations,
 * f the part of c g on dx. What acts between bodies of one group does nothing.
 */

enum { L = MT_LOCAL };

/* Forces that do not balance, relative to all those that meet there: beyond rounding, the
 * drawing is not at rest. */
static const double NOT_AT_REST = 1e-11;
/* What Newton's method leaves unbalanced, in what rounding of the positions may be of it. */
static const double ROOM = 8.0;
/* Roundings of an entry's terms. */
static const double TERM_ULPS = 16.0;

typedef struct entry {
    int col;
    int row;
    int order;
    double value;
    double noise;
} entry;

typedef struct work {
    const mt_absolute *o;
    mt_data data;
    mt_placement at;
    double *g;     /* [n] gradient */
    double *push;  /* [n] of all forces that meet at a body, at its coordinates */
    double *round; /* [n] of that, what rounding of the positions leaves open */
    /* [nq] of a place where it settled: the motion to where the forces balance, and what is
     * open of that */
    double *left;
    double *more;
    entry *list; /* NULL: counted alone */
    size_t n;
} work;

/* One measure over the coordinates of its bodies. */
typedef struct patch {
    int place[L]; /* -1: none */
    double g[L];
    double h[L * L];
    double size[L * L]; /* magnitudes of the terms of h */
} patch;

/* a := T^T a T, or with magnitudes for its entries. */
static void carry(double *const arm[2], bool size, double *a)
{
    for (int side = 0; side < 2; side++) {
        const int first = 6 * side;
        for (int k = 0; k < 3 && arm[side] != NULL; k++) {
            const int next = (k + 1) % 3;
            const int last = (k + 2) % 3;
            const double up = size ? fabs(arm[side][last]) : arm[side][last];
            const double down = size ? fabs(arm[side][next]) : -arm[side][next];
            for (int i = 0; i < L; i++) {
                a[i + (L * (first + 3 + next))] += up * a[i + (L * (first + k))];
                a[i + (L * (first + 3 + last))] += down * a[i + (L * (first + k))];
            }
        }
        for (int k = 0; k < 3 && arm[side] != NULL; k++) {
            const int next = (k + 1) % 3;
            const int last = (k + 2) % 3;
            const double up = size ? fabs(arm[side][last]) : arm[side][last];
            const double down = size ? fabs(arm[side][next]) : -arm[side][next];
            for (int j = 0; j < L; j++) {
                a[first + 3 + next + (L * j)] += up * a[first + k + (L * j)];
                a[first + 3 + last + (L * j)] += down * a[first + k + (L * j)];
            }
        }
    }
}

/* S, and its terms' magnitudes. */
static void add_turning(const double *f, const double *r, int first, patch *p)
{
    double dot = 0.0;
    double dot_size = 0.0;
    for (int k = 0; k < 3; k++) {
        dot += f[k] * r[k];
        dot_size += fabs(f[k] * r[k]);
    }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            const int at = first + 3 + i + (L * (first + 3 + j));
            p->h[at] += 0.5 * ((f[i] * r[j]) + (r[i] * f[j])) - (i == j ? dot : 0.0);
            p->size[at] += 0.5 * (fabs(f[i] * r[j]) + fabs(r[i] * f[j]));
            p->size[at] += i == j ? dot_size : 0.0;
        }
    }
}

/* Fill p with its coordinates, and c times the measure's derivatives by their states. */
static void fill_patch(const work *w, const int body[2], double c, const mt_jet *jet, patch *p)
{
    const mt_absolute *const o = w->o;
    const mt_system *const sys = o->sys;
    for (int k = 0; k < L; k++) {
        const int b = body[k / 6];
        const int first = b == MT_GROUND ? MT_GROUND : o->with[b];
        const int dof = first == MT_GROUND ? -1 : sys->bodies[first].dof[k % 6];
        const bool moves = mt_local_dof(sys, body, k) >= 0;
        p->place[k] = dof < 0 ? -1 : o->place[dof];
        p->g[k] = moves ? c * creal(jet->g[k]) : 0.0;
        for (int j = 0; j < L && moves; j++) {
            if (mt_local_dof(sys, body, j) >= 0) {
                p->h[j + (L * k)] = c * creal(jet->h[j + (L * k)]);
                p->size[j + (L * k)] = fabs(p->h[j + (L * k)]);
            }
        }
    }
}

/* Lengths in rotations are differences of coordinates: of this size. */
static double reach_of(const work *w, const int body[2])
{
    double reach = 0.0;
    for (int k = 0; k < 6; k++) {
        const int b = body[k / 3];
        reach = b == MT_GROUND ? reach : fmax(reach, fabs(creal(w->at.pose[b].x[k % 3])));
    }
    return reach;
}

static void make_patch(const work *w, const int body[2], double c, const mt_jet *jet, patch *p)
{
    const mt_absolute *const o = w->o;
    const double reach = reach_of(w, body);
    double *arm[2] = {NULL, NULL};
    *p = (patch){.place = {0}};
    fill_patch(w, body, c, jet, p);
    for (int side = 0; side < 2; side++) {
        const ptrdiff_t first = (ptrdiff_t)6 * side;
        const int b = body[side];
        if (b == MT_GROUND || o->with[b] == MT_GROUND) {
            continue;
        }
        for (ptrdiff_t i = first + 3; i < first + 6; i++) {
            p->size[i * (L + 1)] +=
                reach * (fabs(p->g[first]) + fabs(p->g[first + 1]) + fabs(p->g[first + 2]));
        }
        arm[side] = o->with[b] == b ? NULL : o->arm + ((ptrdiff_t)3 * b);
    }
    carry(arm, false, p->h);
    carry(arm, true, p->size);
    for (int side = 0; side < 2; side++) {
        double *const g = p->g + (ptrdiff_t)6 * side;
        const double *const r = arm[side];
        if (r != NULL) {
            add_turning(g, r, 6 * side, p);
            for (int k = 0; k < 3; k++) { /* r x f */
                g[3 + k] +=
                    (r[(k + 1) % 3] * g[(k + 2) % 3]) - (r[(k + 2) % 3] * g[(k + 1) % 3]);
            }
        }
    }
}

/* Add the entries of p. open: relative error of their terms. */
static void add_entries(work *w, double open, const patch *p)
{
    for (int k = 0; k < L; k++) {
        for (int j = 0; j < L; j++) {
            if (p->place[k] < 0 || p->place[j] < p->place[k] || p->size[j + (L * k)] == 0.0) {
                continue;
            }
            if (w->list != NULL) {
                w->list[w->n] =
                    (entry){.col = p->place[k],
                            .row = p->place[j],
                            .order = (int)w->n,
                            .value = p->h[j + (L * k)],
                            .noise = ((TERM_ULPS * DBL_EPSILON) + open) * p->size[j + (L * k)]};
            }
            w->n++;
        }
    }
}

/* Largest entry of the forces on a side, in units. */
static double largest_force(const work *w, const patch *p, int side)
{
    double most = 0.0;
    for (int k = 6 * side; k < 6 + (6 * side); k++) {
        if (p->place[k] >= 0) {
            most = fmax(most, fabs(p->g[k]) * w->o->unit[p->place[k]]);
        }
    }
    return most;
}

/* A force that is known to within `noise`. */
static void add_uncertain_force(work *w, const int body[2], double c, double noise,
                                const mt_jet *jet, patch *p)
{
    const double size = fmax(fabs(c), noise);
    make_patch(w, body, c, jet, p);
    if (size > fabs(c)) {
        patch whole;
        make_patch(w, body, size, jet, &whole);
        memcpy(p->size, whole.size, sizeof whole.size);
    }
    add_entries(w, size > 0.0 ? noise / size : 0.0, p);
    for (int k = 0; k < L && w->list == NULL; k++) {
        if (p->place[k] >= 0) {
            w->g[p->place[k]] += p->g[k];
            w->push[p->place[k]] += largest_force(w, p, k / 6);
        }
    }
}

static bool add_force(void *context, const int body[2], double c, double noise,
                      const mt_jet *jet)
{
    work *const w = context;
    patch p;
    if (absolute_together(w->o, body, 2)) {
        return true;
    }
    add_uncertain_force(w, body, c, noise, jet, &p);
    if (noise > 0.0 && w->list == NULL) {
        make_patch(w, body, noise, jet, &p);
        for (int k = 0; k < L; k++) {
            if (p.place[k] >= 0) {
                w->round[p.place[k]] += largest_force(w, &p, k / 6);
            }
        }
    }
    return true;
}

/* Constraints with their forces: mu over the rows of the absolute's a. */
static void add_constraints(work *w, const double *mu, const double *open)
{
    const mt_system *const sys = w->o->sys;
    for (int i = 0, j = 0; i < sys->n_constraints; i++) {
        const mt_constraint_def *const c = &sys->constraints[i];
        if (absolute_holds_already(w->o, i)) {
            continue;
        }
        for (int t = 0; t < c->terms; t++) {
            const mt_measure_def *const def = &sys->measures[c->measure[t]];
            const mt_measure_data measure = mt_data_measure(&w->data, def);
            const double factor = creal(mt_data_scalar(&w->data, c->coefficient[t], 1.0));
            mt_jet jet;
            patch p;
            mt_measure_eval(&measure, mt_pose_of(w->at.pose, def->body[0]),
                            mt_pose_of(w->at.pose, def->body[1]), true, NULL, &jet);
            add_uncertain_force(w, def->body, factor * mu[j], fabs(factor) * open[j], &jet, &p);
        }
        j++;
    }
}

static int by_place(const void *a, const void *b)
{
    const entry *const x = a;
    const entry *const y = b;
    const int col = (x->col > y->col) - (x->col < y->col);
    const int row = (x->row > y->row) - (x->row < y->row);
    return col != 0 ? col : row != 0 ? row : (x->order > y->order) - (x->order < y->order);
}

/* The sorted entries as a matrix. */
static mt_status sum_entries(work *w, mt_arena *mem, mt_absolute_load *out, mt_err *err)
{
    const size_t n = (size_t)w->o->n;
    out->g = (mt_lower){.n = w->o->n, .start = mt_arena_int(mem, n + 1)};
    out->g.row = mt_arena_int(mem, w->n);
    out->g.value = mt_arena_f64(mem, w->n, 1);
    out->noise = mt_arena_f64(mem, w->n, 1);
    MT_TRY(mt_arena_check(mem, err));
    qsort(w->list, w->n, sizeof *w->list, by_place);
    int at = -1;
    for (size_t k = 0; k < w->n; k++) {
        const entry *const e = &w->list[k];
        if (k == 0 || e->col != e[-1].col || e->row != e[-1].row) {
            out->g.row[++at] = e->row;
            out->g.start[e->col + 1]++;
        }
        out->g.value[at] += e->value;
        out->noise[at] += e->noise;
    }
    for (size_t j = 0; j < n; j++) {
        out->g.start[j + 1] += out->g.start[j];
    }
    return MT_OK;
}

static mt_status open_at(work *w, const double *inputs, mt_arena *scratch, mt_err *err)
{
    const mt_state *const settled = w->o->settled;
    w->push = mt_arena_f64(scratch, (size_t)w->o->n, 1);
    w->round = mt_arena_f64(scratch, (size_t)w->o->n, 1);
    MT_TRY(mt_absolute_stand(w->o->sys, settled, inputs, &w->data, &w->at, scratch, err));
    if (settled == NULL) {
        return MT_OK;
    }
    w->left = mt_arena_f64(scratch, (size_t)w->o->sys->nq, 1);
    w->more = mt_arena_f64(scratch, (size_t)w->o->sys->nq, 1);
    MT_TRY(mt_arena_check(scratch, err));
    return mt_position_balance(settled, &w->data, w->left, w->more, scratch, err);
}

/* Add the forces of loads and springs. */
static void add_forces(work *w)
{
    if (w->o->settled == NULL) {
        (void)mt_forces_each(&w->data, w->at.pose, add_force, w);
    } else {
        (void)mt_forces_at(&w->data, &w->at, w->left, w->more, add_force, w);
    }
}

mt_status mt_absolute_forces(const mt_absolute *o, const double *inputs, double *f,
                             mt_arena *scratch, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    work w = {.o = o, .g = f};
    MT_TRY(open_at(&w, inputs, scratch, err));
    memset(f, 0, (size_t)o->n * sizeof *f);
    add_forces(&w);
    for (int j = 0; j < o->n; j++) {
        f[j] = -f[j];
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}

/* True where the forces of loads and joints balance. */
static bool is_at_rest(const work *w, char *why)
{
    const mt_system *const sys = w->o->sys;
    for (int dof = 0; dof < sys->nq; dof++) {
        const int j = w->o->place[dof];
        if (j < 0 || fabs(w->g[j]) * w->o->unit[j] <=
                         (NOT_AT_REST * w->push[j]) + (ROOM * w->round[j])) {
            continue;
        }
        for (int b = 0; b < sys->n_bodies; b++) {
            for (int k = 0; k < 6; k++) {
                if (sys->bodies[b].dof[k] == dof) {
                    (void)mt_snprintf(
                        why, MT_ABSOLUTE_WHY,
                        w->o->settled == NULL
                            ? "\"%s\" is not drawn at rest under its load"
                            : "forces on \"%s\" cancel beyond rounding where it has settled",
                        sys->bodies[b].name);
                }
            }
        }
        return false;
    }
    return true;
}

mt_status mt_absolute_load_new(const mt_absolute *o, const double *inputs, mt_arena *mem,
                               mt_absolute_load *out, bool *at_rest, char why[MT_ABSOLUTE_WHY],
                               mt_err *err)
{
    mt_arena scratch = {.first = NULL};
    work w = {.o = o};
    mt_status rc = mt_arena_init(&scratch, 0, err);
    w.g = mt_arena_f64(&scratch, (size_t)o->n, 1);
    rc = rc == MT_OK ? open_at(&w, inputs, &scratch, err) : rc;
    rc = rc == MT_OK ? mt_arena_check(&scratch, err) : rc;
    for (int round = 0; round < 2 && rc == MT_OK; round++) {
        const size_t n = w.n;
        w.n = 0;
        w.list = round == 0 ? NULL : mt_arena_alloc(&scratch, n, sizeof *w.list);
        rc = mt_arena_check(&scratch, err);
        rc = rc == MT_OK ? mt_interrupt_check(o->sys->run->interrupt, err) : rc;
        if (rc == MT_OK) {
            add_forces(&w);
            add_constraints(&w, out->mu, out->open);
        }
    }
    *at_rest = rc == MT_OK && is_at_rest(&w, why);
    rc = rc == MT_OK && *at_rest ? sum_entries(&w, mem, out, err) : rc;
    mt_arena_free(&scratch);
    return rc;
}

/*
 * In coordinates x of the groups of bodies phi = T x, and T is geometry, too: with the rows f
 * of springs and masses over the states of their bodies, s = f . T x,
 *     s' = f' . phi + f . T' x,    and of a constraint's row a alike;
 * by K x + A^T mu = lambda M x, A x = 0, x^T M x = 1, the slope is
 *     lambda' = sum over springs of k' s^2 + 2 k s s', less lambda times the same of masses,
 *               plus sum over constraints of 2 mu (a . T x)',
 * which for two modes of one lambda is a symmetric form. Every sum is over what there is, term
 * by term; nothing is factored and no null space has a derivative.
 */

/* A gap's derivative below this part of the drawing's own is rounding. */
static const double SLOPE_DRAWN_CLOSED = 1e-10;

typedef struct slope_work {
    const mt_absolute *o;
    const mt_absolute_modes *modes;
    mt_data data;
    mt_placement at;
    mt_term_list list[MT_TERM_KINDS];
    double *arm;      /* 3 x bodies: derivative of the absolute's */
    double *phi;      /* nq x modes */
    double *moved;    /* nq x modes: T' x */
    double *s;        /* [2 MOST_ROWS x modes]: s, then s' of each row */
    double *form;     /* [n_pairs] of the present input */
    mt_sparse_row *a; /* [constraints] rows, and their derivatives */
    mt_sparse_row *da;
    double *c;      /* [constraints] derivatives of the gaps */
    double *forces; /* [nq] work */
    double *trim;   /* [nq] work */
} slope_work;

/* phi[nq] := the motion of the bodies' groups; without `whole` only the part of the given
 * arms. */
static void expand_mode(const mt_absolute *o, const double *x, const double *arm, bool whole,
                        double *phi)
{
    const mt_system *const sys = o->sys;
    memset(phi, 0, (size_t)sys->nq * sizeof *phi);
    for (int b = 0; b < sys->n_bodies; b++) {
        const int first = o->with[b];
        if (first == MT_GROUND) {
            continue;
        }
        const double *const r = arm + ((ptrdiff_t)3 * b);
        double v[6];
        for (int k = 0; k < 6; k++) {
            const int dof = sys->bodies[first].dof[k];
            v[k] = dof < 0 ? 0.0 : x[o->place[dof]];
        }
        for (int k = 0; k < 6; k++) {
            const int dof = sys->bodies[b].dof[k];
            const int next = (k + 1) % 3;
            const int last = (k + 2) % 3;
            if (dof >= 0) {
                phi[dof] = whole ? v[k] : 0.0;
                phi[dof] += k < 3 ? (v[3 + next] * r[last]) - (v[3 + last] * r[next]) : 0.0;
            }
        }
    }
}

void mt_absolute_shape(const mt_absolute *o, const double *x, double *phi)
{
    expand_mode(o, x, o->arm, true, phi);
}

void mt_absolute_push(const mt_absolute *o, const double *force, double *f)
{
    const mt_system *const sys = o->sys;
    memset(f, 0, (size_t)o->n * sizeof *f);
    for (int b = 0; b < sys->n_bodies; b++) {
        const int first = o->with[b];
        if (first == MT_GROUND) {
            continue;
        }
        const double *const r = o->arm + ((ptrdiff_t)3 * b);
        double g[6];
        for (int k = 0; k < 6; k++) {
            const int dof = sys->bodies[b].dof[k];
            g[k] = dof < 0 ? 0.0 : force[dof];
        }
        for (int k = 0; k < 3; k++) { /* r x force */
            const int next = (k + 1) % 3;
            const int last = (k + 2) % 3;
            g[3 + k] += (r[next] * g[last]) - (r[last] * g[next]);
        }
        for (int k = 0; k < 6; k++) {
            const int dof = sys->bodies[first].dof[k];
            f[dof < 0 ? 0 : o->place[dof]] += dof < 0 ? 0.0 : g[k];
        }
    }
}

mt_status mt_absolute_sense(const mt_system *sys, const mt_state *settled, const double *inputs,
                            int n, const double *phi, double *value, mt_arena *scratch,
                            mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    mt_data d;
    mt_placement at;
    MT_TRY(mt_absolute_stand(sys, settled, inputs, &d, &at, scratch, err));
    for (int i = 0; i < sys->n_channels; i++) {
        const int *const body = sys->channels[i].body;
        const mt_term term = {
            .coefficient = MT_NO_NODE, .count = 1, .body = {body[0], body[1]}, .source = i};
        mt_cx row[MT_LOCAL];
        mt_term_rows(&d, MT_TERM_CHANNEL, &term, at.pose, row);
        for (int a = 0; a < n; a++) {
            double sum = 0.0;
            for (int k = 0; k < MT_LOCAL; k++) {
                const int q = mt_local_dof(sys, body, k);
                sum += q < 0 ? 0.0 : creal(row[k]) * phi[q + ((ptrdiff_t)sys->nq * a)];
            }
            value[i + ((ptrdiff_t)sys->n_channels * a)] = sum;
        }
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}

/* s and s' of each row of a term and each mode. */
static void project_term_rows(slope_work *w, const mt_term *t, const mt_cx *rows)
{
    const mt_system *const sys = w->o->sys;
    for (int a = 0; a < w->modes->n; a++) {
        const double *const phi = w->phi + ((ptrdiff_t)sys->nq * a);
        const double *const moved = w->moved + ((ptrdiff_t)sys->nq * a);
        double *const s = w->s + ((ptrdiff_t)2 * MOST_ROWS * a);
        memset(s, 0, (size_t)2 * MOST_ROWS * sizeof *s);
        for (int k = 0; k < MT_LOCAL; k++) {
            const int dof = mt_local_dof(sys, t->body, k);
            for (int r = 0; r < t->count && dof >= 0; r++) {
                const mt_cx f = rows[k + ((ptrdiff_t)MT_LOCAL * r)];
                s[r] += creal(f) * phi[dof];
                s[MOST_ROWS + r] += (cx_derivative(f) * phi[dof]) + (creal(f) * moved[dof]);
            }
        }
    }
}

/* form += sign times that of (c f f^T)', or of (c (f g^T + g f^T)/2)'. */
static void add_form_derivative(slope_work *w, const mt_term *t, double c, double dc,
                                double sign)
{
    for (int k = 0; k < w->modes->n_pairs; k++) {
        const double *const a = w->s + ((ptrdiff_t)2 * MOST_ROWS * w->modes->pair[k][0]);
        const double *const b = w->s + ((ptrdiff_t)2 * MOST_ROWS * w->modes->pair[k][1]);
        const double *const da = a + MOST_ROWS;
        const double *const db = b + MOST_ROWS;
        double sum = 0.0;
        for (int r = 0; r < t->count; r++) {
            const int q = t->pair ? 1 - r : r;
            sum += (dc * a[r] * b[q]) + (c * ((da[r] * b[q]) + (a[r] * db[q])));
        }
        w->form[k] += sign * (t->pair ? 0.5 : 1.0) * sum;
    }
}

static void add_terms(slope_work *w, mt_term_kind kind)
{
    const mt_system *const sys = w->o->sys;
    const mt_term_list *const list = &w->list[kind];
    mt_cx rows[MOST_ROWS * MT_LOCAL];
    for (int i = 0; i < list->n_terms; i++) {
        const mt_term *const t = &list->terms[i];
        const double c = w->data.value[t->coefficient];
        const double dc =
            w->data.grad[((ptrdiff_t)t->coefficient * sys->n_inputs) + w->data.input];
        const bool inner = kind == MT_TERM_STIFFNESS && absolute_together(w->o, t->body, 2);
        if (inner || (dc == 0.0 && (c == 0.0 || sys->geometry_fixed))) {
            continue;
        }
        mt_term_rows(&w->data, kind, t, w->at.pose, rows);
        project_term_rows(w, t, rows);
        if (kind == MT_TERM_STIFFNESS) {
            add_form_derivative(w, t, c, dc, 1.0);
        } else { /* one lambda for both of a pair */
            for (int k = 0; k < w->modes->n * 2 * MOST_ROWS; k++) {
                w->s[k] *= sqrt(w->modes->lambda[k / (2 * MOST_ROWS)]);
            }
            add_form_derivative(w, t, c, dc, -1.0);
        }
    }
}

static double row_dot_motion(const mt_sparse_row *row, const double *phi)
{
    double sum = 0.0;
    for (int k = 0; k < row->n; k++) {
        sum += row->a[k] * phi[row->dof[k]];
    }
    return sum;
}

/* 2 mu (a . T x)'. */
static void add_constraint_slopes(slope_work *w)
{
    const mt_absolute *const o = w->o;
    const mt_absolute_modes *const m = w->modes;
    const ptrdiff_t nq = o->sys->nq;
    for (int i = 0, j = 0; i < o->sys->n_constraints; i++) {
        if (absolute_holds_already(o, i)) {
            continue;
        }
        for (int a = 0; a < m->n; a++) {
            w->s[a] = row_dot_motion(&w->da[i], w->phi + (nq * a)) +
                      row_dot_motion(&w->a[i], w->moved + (nq * a));
        }
        for (int k = 0; k < m->n_pairs; k++) {
            const int a = m->pair[k][0];
            const int b = m->pair[k][1];
            w->form[k] += (m->mu[j + ((ptrdiff_t)o->a.n_rows * a)] * w->s[b]) +
                          (m->mu[j + ((ptrdiff_t)o->a.n_rows * b)] * w->s[a]);
        }
        j++;
    }
}

/* Rows of the constraints, or their derivatives and those of the gaps. */
static void equations(slope_work *w, bool slope)
{
    mt_lagrangian l = {.slope = slope, .g = w->forces, .trim = w->trim, .c = w->c};
    l.row = slope ? w->da : w->a;
    mt_lagrangian_eval(&w->data, MT_ENERGY_PHYSICAL, w->at.pose, &w->at,
                       w->o->sys->n_constraints, NULL, MT_CURVATURE_NONE, &l);
}

/* True where the joints stay closed in the drawn position. */
static bool stays_closed(const slope_work *w)
{
    const mt_system *const sys = w->o->sys;
    double most = 0.0;
    for (int i = 0; i < sys->n_vecs; i++) {
        for (int k = 0; k < 3; k++) {
            most = fmax(most, fabs(cx_derivative(w->data.vec[i][k])));
        }
    }
    for (int i = 0; i < sys->n_constraints && !sys->drawn_closed; i++) {
        if (!(fabs(w->c[i]) <=
              SLOPE_DRAWN_CLOSED * fmax(most, fabs(cx_derivative(w->data.target[i]))))) {
            return false;
        }
    }
    return true;
}

static void refuse_parameter(const slope_work *w, char *why, const char *text)
{
    const mt_system *const sys = w->o->sys;
    (void)mt_snprintf(why, MT_ABSOLUTE_WHY, "by parameter \"%s\" %s",
                      sys->model->parameters[sys->inputs[w->data.input]].name.s, text);
}

/* The data, poses and T' along input p. */
static void turn_to(slope_work *w, int p)
{
    const mt_absolute *const o = w->o;
    w->data.input = p;
    mt_data_vecs(&w->data);
    mt_data_targets(&w->data);
    mt_data_drawn(&w->data, w->at.pose);
    mt_data_rest(&w->data, w->at.pose);
    for (int b = 0; b < o->sys->n_bodies; b++) {
        const int first = o->with[b];
        for (int k = 0; k < 3 && first != MT_GROUND; k++) {
            w->arm[(3 * b) + k] =
                cx_derivative(w->at.pose[b].x[k]) - cx_derivative(w->at.pose[first].x[k]);
        }
    }
    for (int a = 0; a < w->modes->n; a++) {
        expand_mode(o, w->modes->x + ((ptrdiff_t)o->n * a), w->arm, false,
                    w->moved + ((ptrdiff_t)o->sys->nq * a));
    }
}

static mt_status init_slopes(slope_work *w, const double *inputs, mt_arena *mem, mt_err *err)
{
    const mt_system *const sys = w->o->sys;
    const size_t nq = (size_t)sys->nq;
    const size_t n = (size_t)w->modes->n;
    const size_t m = (size_t)sys->n_constraints;
    const size_t nodes = (size_t)sys->program.count;
    double *const value = mt_arena_f64(mem, nodes, 1);
    double *const grad = mt_arena_f64(mem, nodes, (size_t)sys->n_inputs);
    w->arm = mt_arena_f64(mem, 3, (size_t)sys->n_bodies);
    w->phi = mt_arena_f64(mem, nq, n);
    w->moved = mt_arena_f64(mem, nq, n);
    w->s = mt_arena_f64(mem, (size_t)2 * MOST_ROWS, n);
    w->a = mt_arena_alloc(mem, m, sizeof *w->a);
    w->da = mt_arena_alloc(mem, m, sizeof *w->da);
    w->c = mt_arena_f64(mem, m, 1);
    w->forces = mt_arena_f64(mem, nq, 1);
    w->trim = mt_arena_f64(mem, nq, (size_t)sys->n_trims);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_data_init(&w->data, sys, mem, err));
    MT_TRY(mt_placement_init(&w->at, sys, mem, err));
    MT_TRY(mt_terms_new(sys, mem, w->list, err));
    MT_TRY(mt_program_gradient(&sys->program, inputs, value, grad, NULL, err));
    w->data.value = value;
    w->data.grad = grad;
    for (size_t a = 0; a < n; a++) {
        mt_absolute_shape(w->o, w->modes->x + ((size_t)w->o->n * a), w->phi + (nq * a));
    }
    return MT_OK;
}

mt_status mt_absolute_slopes(const mt_absolute *o, const double *inputs,
                             const mt_absolute_modes *modes, double *slope,
                             char why[MT_ABSOLUTE_WHY], mt_arena *scratch, mt_err *err)
{
    const mt_system *const sys = o->sys;
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    slope_work w = {.o = o, .modes = modes};
    why[0] = '\0';
    if (sys->loaded) {
        (void)mt_snprintf(
            why, MT_ABSOLUTE_WHY,
            "the forces of its joints change with it, which is computed only for trees");
        return MT_OK;
    }
    memset(slope, 0, (size_t)modes->n_pairs * (size_t)sys->n_inputs * sizeof *slope);
    MT_TRY(init_slopes(&w, inputs, scratch, err));
    for (int p = 0; p < sys->n_inputs && why[0] == '\0'; p++) {
        MT_TRY(mt_interrupt_check(sys->run->interrupt, err));
        w.form = slope + ((ptrdiff_t)modes->n_pairs * p);
        turn_to(&w, p);
        add_terms(&w, MT_TERM_STIFFNESS);
        add_terms(&w, MT_TERM_MASS);
        if (sys->geometry_fixed) {
            continue;
        }
        if (p == 0) {
            equations(&w, false);
        }
        equations(&w, true);
        if (!stays_closed(&w)) {
            refuse_parameter(&w, why, "a joint opens that is closed in the reference position");
        } else if (modes->dependent) {
            refuse_parameter(&w, why,
                             "equations of joints that follow from others may cease to do so");
        }
        add_constraint_slopes(&w);
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}
