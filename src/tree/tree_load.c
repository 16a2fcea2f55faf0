/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Loads on a tree that is drawn at rest. With g the gradient of the potential V, body by body,
 * the forces of a body and of all that hangs on it balance in the directions that its edge
 * leaves free, and the joints of the edge hold the rest:
 *     N_i^T G_i = 0,    A_i^T lambda_i = -G_i,    G_before += X_i^T G_i.
 * The geometric stiffness is that of V and of lambda times the equations: blocks of the same
 * bodies as the masses have.
 */
#include "tree/tree_priv.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/format.h"
#include "linalg/dense.h"
#include "mechanics/forces.h"

enum { MOST = MT_TREE_MOTION };

/* Forces that do not balance, relative to all those that meet there: beyond rounding, the
 * drawing is not at rest. */
static const double NOT_AT_REST = 1e-11;

typedef struct loading {
    mt_tree_maker *m;
    double *g; /* s x n: G */
} loading;

static double local_component(const mt_tree *t, const mt_cx *local, int side, int k)
{
    return creal(local[(6 * side) + mt_tree_freedom(t, k)]);
}

static bool is_free(const mt_tree *t, int body, int k)
{
    return body != MT_GROUND && t->sys->bodies[body].dof[mt_tree_freedom(t, k)] >= 0;
}

/* += c times the Hessian of a measure of two bodies (MT_GROUND: the ground); false where both
 * are bodies of no edge. */
static bool add_curvature(const mt_tree_maker *m, const int body[2], double c,
                          const mt_jet *jet)
{
    mt_tree *const t = m->t;
    const ptrdiff_t square = (ptrdiff_t)t->s * t->s;
    for (int side = 0; side < 2; side++) {
        const int at = body[side] == MT_GROUND ? -1 : t->place[body[side]];
        for (int k = 0; k < t->s * t->s && at >= 0; k++) {
            const int row = k % t->s;
            const int col = k / t->s;
            if (is_free(t, body[side], row) && is_free(t, body[side], col)) {
                t->geometric_stiffness[k + (square * at)] +=
                    c * local_component(t,
                                        jet->h + ((ptrdiff_t)MT_LOCAL *
                                                  ((6 * side) + mt_tree_freedom(t, col))),
                                        side, row);
            }
        }
    }
    if (body[0] == MT_GROUND || body[1] == MT_GROUND) {
        return true;
    }
    const int first = t->before[t->place[body[1]]] == t->place[body[0]] ? 0 : 1;
    const int at = t->place[body[1 - first]];
    if (t->before[at] != t->place[body[first]]) {
        return false;
    }
    for (int k = 0; k < t->s * t->s; k++) {
        const int row = k % t->s;
        const int col = k / t->s;
        if (is_free(t, body[first], row) && is_free(t, body[1 - first], col)) {
            t->geometric_stiffness_shared[k + (square * at)] +=
                c * local_component(t,
                                    jet->h + ((ptrdiff_t)MT_LOCAL *
                                              ((6 * (1 - first)) + mt_tree_freedom(t, col))),
                                    first, row);
        }
    }
    return true;
}

/* A force that a potential -c times the measure makes. */
static bool add_force(void *context, const int body[2], double c, double noise,
                      const mt_jet *jet)
{
    (void)noise; /* as drawn there is none */
    const loading *const l = context;
    const mt_tree *const t = l->m->t;
    for (int side = 0; side < 2; side++) {
        const int at = body[side] == MT_GROUND ? -1 : t->place[body[side]];
        for (int k = 0; k < t->s && at >= 0; k++) {
            if (is_free(t, body[side], k)) {
                const double f = c * local_component(t, jet->g, side, k);
                l->g[k + ((ptrdiff_t)t->s * at)] += f;
                l->m->t->force[at] +=
                    fabs(f) / (mt_tree_freedom(t, k) >= 3 ? t->sys->length_m : 1.0);
            }
        }
    }
    return add_curvature(l->m, body, c, jet);
}

/* True where G_i is balanced along the free motions of the edge. */
static bool is_at_rest(const loading *l, int i)
{
    const mt_tree *const t = l->m->t;
    const double *const g = l->g + ((ptrdiff_t)t->s * i);
    const ptrdiff_t first = t->y_at[i] + t->free_dof_at[i];
    const ptrdiff_t end = t->y_at[i + 1] + t->free_dof_at[i + 1];
    for (ptrdiff_t c = first; c < end; c++) {
        const double *const b = t->basis + (t->s * c);
        double power = 0.0;
        double most = 0.0;
        for (int k = 0; k < t->s; k++) {
            power += b[k] * g[k];
            most =
                fmax(most, fabs(b[k]) * (mt_tree_freedom(t, k) >= 3 ? t->sys->length_m : 1.0));
        }
        if (!(fabs(power) <= NOT_AT_REST * most * l->m->t->force[i])) {
            (void)mt_snprintf(l->m->why, MT_TREE_WHY,
                              "\"%s\" is not drawn at rest under its load",
                              t->sys->bodies[t->body[i]].name);
            return false;
        }
    }
    return true;
}

mt_status mt_tree_hold(const mt_tree *t, int c, const double *row, mt_tree_held *h, mt_err *err)
{
    const double length = t->sys->length_m;
    h->c = c;
    for (int i = 0; i < c; i++) {
        for (int k = 0; k < t->s; k++) {
            h->row[k + (i * t->s)] =
                row[k + (i * t->s)] / (mt_tree_freedom(t, k) >= 3 ? length : 1.0);
        }
        h->scale[i] = 1.0 / mt_norm2(t->s, h->row + ((ptrdiff_t)i * t->s));
    }
    for (int i = 0; i < c; i++) {
        for (int j = 0; j < c; j++) {
            h->gram[i + (j * c)] =
                h->scale[i] * h->scale[j] *
                mt_dot(t->s, h->row + ((ptrdiff_t)i * t->s), h->row + ((ptrdiff_t)j * t->s));
        }
    }
    return c == 0 ? MT_OK : mt_cholesky(c, h->gram, NULL, err);
}

void mt_tree_multipliers(const mt_tree *t, const mt_tree_held *h, const double *g,
                         double *lambda)
{
    const double length = t->sys->length_m;
    for (int i = 0; i < h->c; i++) {
        lambda[i] = 0.0;
        for (int k = 0; k < t->s; k++) {
            lambda[i] -= h->scale[i] * h->row[k + (i * t->s)] * g[k] /
                         (mt_tree_freedom(t, k) >= 3 ? length : 1.0);
        }
        for (int j = 0; j < i; j++) { /* L^-1 */
            lambda[i] -= h->gram[i + (j * h->c)] * lambda[j];
        }
        lambda[i] /= h->gram[i + (i * h->c)];
    }
    for (int i = h->c - 1; i >= 0; i--) { /* L^-T */
        for (int j = i + 1; j < h->c; j++) {
            lambda[i] -= h->gram[j + (i * h->c)] * lambda[j];
        }
        lambda[i] /= h->gram[i + (i * h->c)];
    }
    for (int i = 0; i < h->c; i++) {
        lambda[i] *= h->scale[i];
    }
}

/* Multipliers of the joints of edge i that balance G_i: adds their curvature, and adds G_i to
 * the parent's G. */
static mt_status balance_edge_joints(const loading *l, int i, mt_err *err)
{
    const mt_tree_maker *const m = l->m;
    const mt_tree *const t = m->t;
    const mt_system *const sys = t->sys;
    double row[MOST * MOST];
    double lambda[MOST] = {0.0};
    mt_tree_held held;
    mt_jet jet[MOST];
    int c = 0;
    const double *const g = l->g + ((ptrdiff_t)t->s * i);
    for (int k = t->first_constraint[i]; k >= 0; k = t->next_constraint[k], c++) {
        const mt_measure_def *const def = &sys->measures[sys->constraints[k].measure[0]];
        const mt_measure_data measure = mt_data_measure(&m->data, def);
        const int side = def->body[1] == t->body[i] ? 1 : 0;
        mt_measure_eval(&measure, mt_pose_of(m->pose, def->body[0]),
                        mt_pose_of(m->pose, def->body[1]), true, NULL, &jet[c]);
        for (int r = 0; r < t->s; r++) {
            row[r + (c * t->s)] =
                is_free(t, t->body[i], r) ? local_component(t, jet[c].g, side, r) : 0.0;
        }
    }
    MT_TRY(mt_tree_hold(t, c, row, &held, err));
    mt_tree_multipliers(t, &held, g, lambda);
    c = 0;
    for (int k = t->first_constraint[i]; k >= 0; k = t->next_constraint[k], c++) {
        const mt_measure_def *const def = &sys->measures[sys->constraints[k].measure[0]];
        t->held[k] = lambda[c];
        (void)add_curvature(m, def->body, lambda[c], &jet[c]);
    }
    if (t->before[i] >= 0) {
        mt_tree_carry_back(t, i, g, l->g + ((ptrdiff_t)t->s * t->before[i]));
        l->m->t->force[t->before[i]] += l->m->t->force[i];
    }
    return MT_OK;
}

mt_status mt_tree_loads(mt_tree_maker *m, mt_arena *mem, bool *is_tree, mt_err *err)
{
    mt_tree *const t = m->t;
    const size_t n = (size_t)t->n;
    const size_t s = (size_t)t->s;
    t->pushed = mt_arena_f64(mem, s, n);
    t->held = mt_arena_f64(mem, (size_t)t->sys->n_constraints, 1);
    loading l = {.m = m, .g = t->pushed};
    t->force = mt_arena_f64(mem, n, 1);
    t->geometric_stiffness = mt_arena_f64(mem, n * s, s);
    t->geometric_stiffness_shared = mt_arena_f64(mem, n * s, s);
    MT_TRY(mt_arena_check(mem, err));
    *is_tree = mt_forces_each(&m->data, m->pose, add_force, &l);
    if (!*is_tree) {
        (void)mt_snprintf(m->why, MT_TREE_WHY,
                          "a load acts between bodies that hang on others");
    }
    for (int i = t->n - 1; i >= 0 && *is_tree; i--) {
        *is_tree = is_at_rest(&l, i);
        if (*is_tree) {
            MT_TRY(balance_edge_joints(&l, i, err));
        }
    }
    return MT_OK;
}
