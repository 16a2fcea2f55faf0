/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Loads on a mechanism at rest. Of V and of mu times the constraints, measure by
 * measure with the force c, gradient c g and Hessian c h over the motions (dx, theta) of two
 * bodies. A body with the arm r from the first of its group moves by theta and
 *     dx = dx_1 + theta x r + theta x (theta x r)/2,
 * so that in the group's motions, dx = T x to first order,
 *     c T^T g    and    c T^T h T + S,  S = (f r^T + r f^T)/2 - (f . r) I on its rotations,
 * f the part of c g on dx. What acts between bodies of one group does nothing.
 */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/format.h"
#include "base/run.h"
#include "linalg/dense.h"
#include "mechanics/absolute.h"
#include "mechanics/element_forces.h"
#include "mechanics/forces.h"

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
    /* [nq] of a place where it settled: the motion to where the forces balance, what is open of
     * that, and what was unbalanced before */
    double *left;
    double *more;
    double *unbalanced;
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
    if (mt_absolute_together(w->o, body, 2)) {
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
        if (mt_absolute_holds_already(w->o, i)) {
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

/* c g, over the states. */
static bool add_gradient(void *context, const int body[2], double c, double noise,
                         const mt_jet *jet)
{
    const work *const w = context;
    (void)noise;
    for (int k = 0; k < L; k++) {
        const int dof = mt_local_dof(w->o->sys, body, k);
        if (dof >= 0) {
            w->unbalanced[dof] += c * creal(jet->g[k]);
        }
    }
    return true;
}

/*
 * Rounding of positions may change a stiff spring's force by far more than the rounding of the
 * forces themselves: Newton's step that was not taken leads to the balance. A second step
 * estimates the error of the first.
 */
static mt_status find_motion_to_balance(work *w, mt_arena *scratch, mt_err *err)
{
    const mt_system *const sys = w->o->sys;
    const mt_stage *const stage = &w->o->settled->equilibrium;
    const size_t nq = (size_t)sys->nq;
    w->left = mt_arena_f64(scratch, nq, 1);
    w->more = mt_arena_f64(scratch, nq, 1);
    w->unbalanced = mt_arena_f64(scratch, nq, 1);
    double *const lambda = mt_arena_f64(scratch, (size_t)sys->n_constraints, 1);
    mt_lagrangian l;
    MT_TRY(mt_lagrangian_init_rows(&l, sys, scratch, err));
    memcpy(w->left, stage->left.q, nq * sizeof *w->left);
    (void)mt_forces_at(&w->data, &w->at, w->left, w->more, add_gradient, w);
    mt_lagrangian_eval(&w->data, MT_ENERGY_NONE, NULL, &w->at, sys->n_constraints, NULL,
                       MT_CURVATURE_NONE, &l);
    memcpy(lambda, stage->lambda, (size_t)sys->n_constraints * sizeof *lambda);
    mt_axpy(sys->n_constraints, 1.0, stage->left.lambda, lambda);
    mt_lagrangian_pull(&l, sys->n_constraints, lambda, w->unbalanced);
    for (size_t j = 0; j < nq; j++) {
        w->unbalanced[j] = -w->unbalanced[j];
    }
    MT_TRY(mt_saddle_solve(&stage->solver.saddle, w->unbalanced, NULL, w->more, NULL, scratch,
                           err));
    mt_axpy(sys->nq, 1.0, w->more, w->left);
    return MT_OK;
}

static mt_status open_at(work *w, const double *inputs, mt_arena *scratch, mt_err *err)
{
    const mt_state *const settled = w->o->settled;
    w->push = mt_arena_f64(scratch, (size_t)w->o->n, 1);
    w->round = mt_arena_f64(scratch, (size_t)w->o->n, 1);
    MT_TRY(mt_absolute_stand(w->o->sys, settled, inputs, &w->data, &w->at, scratch, err));
    return settled == NULL ? MT_OK : find_motion_to_balance(w, scratch, err);
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
