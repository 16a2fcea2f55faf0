/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mechanics/absolute.h"

#include <math.h>
#include <string.h>

#include "base/format.h"
#include "base/run.h"
#include "mechanics/rows.h"

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

bool mt_absolute_together(const mt_absolute *o, const int *body, int n)
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
        const bool inner = kind == MT_TERM_STIFFNESS && mt_absolute_together(o, t->body, 2);
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

bool mt_absolute_holds_already(const mt_absolute *o, int i)
{
    const mt_constraint_def *const c = &o->sys->constraints[i];
    int body[4] = {MT_GROUND, MT_GROUND, MT_GROUND, MT_GROUND};
    for (int k = 0; k < 2 * c->terms; k++) {
        body[k] = o->sys->measures[c->measure[k / 2]].body[k % 2];
    }
    return mt_absolute_together(o, body, 2 * c->terms);
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
        n += mt_absolute_holds_already(o, (int)i) ? 0 : 1;
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
        if (!mt_absolute_holds_already(o, i)) {
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

mt_status mt_absolute_shift(const mt_absolute *o, const double *inputs, int axis, double *f,
                            mt_arena *scratch, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    mt_data data;
    mt_placement at;
    mt_term_list list[MT_TERM_KINDS];
    mt_cx rows[MOST_ROWS * MT_LOCAL];
    MT_TRY(mt_terms_new(o->sys, scratch, list, err));
    MT_TRY(mt_absolute_stand(o->sys, o->settled, inputs, &data, &at, scratch, err));
    memset(f, 0, (size_t)o->n * sizeof *f);
    for (int i = 0; i < list[MT_TERM_MASS].n_terms; i++) {
        const mt_term *const t = &list[MT_TERM_MASS].terms[i];
        double along[MOST_ROWS] = {0.0};
        mt_term_rows(&data, MT_TERM_MASS, t, at.pose, rows);
        for (int k = axis; k < MT_LOCAL; k += 6) {
            for (int r = 0; r < t->count && mt_local_dof(o->sys, t->body, k) >= 0; r++) {
                along[r] += creal(rows[(r * MT_LOCAL) + k]);
            }
        }
        for (int r = 0; r < t->count; r++) { /* as squares_of takes pairs apart */
            const double sum = !t->pair ? along[r]
                               : r == 0 ? along[0] + along[1]
                                        : along[0] - along[1];
            mt_rows_axpy(&o->m.row, t->first + r, o->m.c[t->first + r] * sum, f);
        }
    }
    mt_arena_rewind(scratch, mark);
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
