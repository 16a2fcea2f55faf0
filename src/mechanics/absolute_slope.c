/* SPDX-License-Identifier: GPL-3.0-or-later */
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
#include <float.h>
#include <math.h>
#include <string.h>

#include "base/format.h"
#include "base/run.h"
#include "linalg/dense.h"
#include "mechanics/absolute.h"
#include "mechanics/lagrangian.h"
#include "mechanics/rows.h"

/* A gap's derivative below this part of the drawing's own is rounding. */
static const double DRAWN_CLOSED = 1e-10;

enum { MOST_ROWS = 16 };

typedef struct work {
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
} work;

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
static void project_term_rows(work *w, const mt_term *t, const mt_cx *rows)
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
static void add_form_derivative(work *w, const mt_term *t, double c, double dc, double sign)
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

static void add_terms(work *w, mt_term_kind kind)
{
    const mt_system *const sys = w->o->sys;
    const mt_term_list *const list = &w->list[kind];
    mt_cx rows[MOST_ROWS * MT_LOCAL];
    for (int i = 0; i < list->n_terms; i++) {
        const mt_term *const t = &list->terms[i];
        const double c = w->data.value[t->coefficient];
        const double dc =
            w->data.grad[((ptrdiff_t)t->coefficient * sys->n_inputs) + w->data.input];
        const bool inner = kind == MT_TERM_STIFFNESS && mt_absolute_together(w->o, t->body, 2);
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
static void add_constraints(work *w)
{
    const mt_absolute *const o = w->o;
    const mt_absolute_modes *const m = w->modes;
    const ptrdiff_t nq = o->sys->nq;
    for (int i = 0, j = 0; i < o->sys->n_constraints; i++) {
        if (mt_absolute_holds_already(o, i)) {
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
static void equations(work *w, bool slope)
{
    mt_lagrangian l = {.slope = slope, .g = w->forces, .trim = w->trim, .c = w->c};
    l.row = slope ? w->da : w->a;
    mt_lagrangian_eval(&w->data, MT_ENERGY_PHYSICAL, w->at.pose, &w->at,
                       w->o->sys->n_constraints, NULL, MT_CURVATURE_NONE, &l);
}

/* True where the joints stay closed in the drawn position. */
static bool stays_closed(const work *w)
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
              DRAWN_CLOSED * fmax(most, fabs(cx_derivative(w->data.target[i]))))) {
            return false;
        }
    }
    return true;
}

static void refuse_parameter(const work *w, char *why, const char *text)
{
    const mt_system *const sys = w->o->sys;
    (void)mt_snprintf(why, MT_ABSOLUTE_WHY, "by parameter \"%s\" %s",
                      sys->model->parameters[sys->inputs[w->data.input]].name.s, text);
}

/* The data, poses and T' along input p. */
static void turn_to(work *w, int p)
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

static mt_status init_slopes(work *w, const double *inputs, mt_arena *mem, mt_err *err)
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
    w->trim = mt_arena_f64(mem, nq, 1);
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
    work w = {.o = o, .modes = modes};
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
        add_constraints(&w);
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}
