/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Slopes of eigenvalues, a dash being the derivative by an input. With constraints A phi = 0
 * and K phi - lambda M phi + A^T mu = 0,
 *     lambda' = phi^T (K' - lambda M') phi + 2 mu^T A' phi,    phi^T M phi = 1.
 * A measure of an edge has the gradient f over the motion of its body and -X^T f over that of
 * the body before, so with w_i = v_i - X_i v_before, which the recursion knows without
 * cancellation,
 *     f . w' = f' . w_i - f . X' v_before.
 * All that an edge transmits, of springs (k s f, s = f . w) and joints (mu f), balances what
 * is beyond it, P_i = sum of (K_g - lambda M) v: the last terms of an edge make P_i . X'
 * v_before. An edge thus gives
 *     sum over springs of k' s^2 + 2 k s f' . w,    over equations of 2 mu f' . w,
 *     and 2 P . X' v_before,
 * each a sum over what the input touches. Of repeated modes the same as a symmetric form.
 */
#include <float.h>
#include <math.h>
#include <string.h>

#include "base/format.h"
#include "base/run.h"
#include "linalg/dense.h"
#include "mechanics/rows.h"
#include "tree/tree.h"

typedef struct tree_slope {
    const mt_tree *t;
    const mt_system *sys;
    const mt_tree_modes *modes;
    mt_data data;         /* along the current input */
    mt_pose *pose;        /* [bodies] along the current input */
    uint64_t *vec_inputs; /* [n_vecs x words] bit set of the inputs of each vector */
    double *within;       /* s n x modes: w of mt_tree_within */
    double *transport;    /* s n x modes: P of mt_tree_transport */
    double *force;        /* springs x modes: k times the mode's elongation of the spring */
    double *mu;           /* constraints x modes: multiplier of each equation in the mode */
    /* n_pairs x constraints: phi_a^T H phi_b; NULL without loads */
    double *geometric_stiffness;
    double *projected; /* [2 x modes] work */
    double *energy;    /* [n_pairs] work */
    double *slope;     /* n_pairs x n_inputs */
    char *why;
    mt_arena *scratch;
} tree_slope;

/* Column of body i in mode a of `of`: within or transport. */
static inline const double *tree_slope_at(const tree_slope *w, const double *of, int i, int a)
{
    return of + ((ptrdiff_t)w->t->s * (i + ((ptrdiff_t)w->t->n * a)));
}

static void tree_slope_form(const tree_slope *w, const int body[2], const mt_jet *jet,
                            bool derivative, double *form);
static mt_status tree_slope_loads(tree_slope *w, mt_err *err);

enum { MOST = MT_TREE_MOTION, MOST_ROWS = 16 };

/* Rounding of a row's product with the basis, in units of its terms. */
static const double ROW_ULPS = 16.0;
/* A gap's derivative below this part of the drawing's own is rounding. */
static const double DRAWN_CLOSED = 1e-10;

static bool vec_moves(const tree_slope *w, int vec, int p)
{
    enum { BITS = 64 };
    const ptrdiff_t words = w->sys->program.words;
    return vec >= 0 && p >= 0 &&
           ((w->vec_inputs[(words * vec) + (p / BITS)] >> (unsigned)(p % BITS)) & 1U) != 0U;
}

/* The inputs of each vector; operands come first. */
static void find_inputs(tree_slope *w)
{
    const mt_program *const program = &w->sys->program;
    const ptrdiff_t words = program->words;
    for (int i = 0; i < w->sys->n_vecs; i++) {
        const mt_vec_def *const def = &w->sys->vecs[i];
        uint64_t *const set = w->vec_inputs + (words * i);
        const bool nodes = def->kind == MT_VEC_NODES || def->kind == MT_VEC_UNIT;
        for (int k = 0; k < 3 && nodes; k++) {
            mt_program_include_inputs(program, def->node[k], set);
        }
        for (ptrdiff_t k = 0; k < words && !nodes; k++) {
            const bool both = def->kind == MT_VEC_CROSS || def->kind == MT_VEC_ACROSS;
            set[k] = w->vec_inputs[(words * def->axis) + k] |
                     (both ? w->vec_inputs[(words * def->helper) + k] : 0);
        }
    }
}

/* The data and poses along input p; -1: values alone. */
static void turn_to(tree_slope *w, int p)
{
    const int last = w->data.input;
    w->data.input = p;
    for (int i = 0; i < w->sys->n_vecs; i++) {
        if (vec_moves(w, i, p) || vec_moves(w, i, last)) {
            mt_data_vec(&w->data, i);
        }
    }
    for (int b = 0; b < w->sys->n_bodies; b++) {
        const int centre = w->sys->bodies[b].centre;
        if (vec_moves(w, centre, p) || vec_moves(w, centre, last)) {
            memcpy(w->pose[b].x, w->data.vec[centre], sizeof w->pose[b].x);
        }
    }
}

/* Derivative of a node by the current input. */
static double tree_slope_of(const tree_slope *w, mt_node node)
{
    const int p = w->data.input;
    return node == MT_NO_NODE || p < 0 ? 0.0
                                       : w->data.grad[((ptrdiff_t)node * w->sys->n_inputs) + p];
}

static bool tree_slope_moves_vec(const tree_slope *w, int vec)
{
    return vec_moves(w, vec, w->data.input);
}

static bool centre_moves(const tree_slope *w, int body)
{
    return body != MT_GROUND && vec_moves(w, w->sys->bodies[body].centre, w->data.input);
}

/* True where the measure (the vector) depends on the current input. */
static bool tree_slope_moves(const tree_slope *w, const mt_measure_def *def)
{
    const int p = w->data.input;
    bool moves = centre_moves(w, def->body[0]) || centre_moves(w, def->body[1]);
    for (int k = 0; k < 2; k++) {
        moves = moves || vec_moves(w, def->point[k], p);
    }
    for (int k = 0; k < 3; k++) {
        moves = moves || vec_moves(w, def->dir[k], p);
    }
    for (int k = 0; k < MT_BEAM_NUMBERS && def->kind == MT_MEASURE_BEAM; k++) {
        moves = moves || tree_slope_of(w, def->beam[k]) != 0.0;
    }
    return moves;
}

static void tree_slope_jet(const tree_slope *w, const mt_measure_def *def, bool second,
                           mt_jet *jet)
{
    const mt_measure_data measure = mt_data_measure(&w->data, def);
    mt_measure_eval(&measure, mt_pose_of(w->pose, def->body[0]),
                    mt_pose_of(w->pose, def->body[1]), second, NULL, jet);
}

/* Gradient of the measure over the motion of body i, row[s], and its derivative by the current
 * input, drow[s]. */
static void tree_slope_row(const tree_slope *w, const mt_measure_def *def, int i,
                           const mt_jet *jet, double *row, double *drow)
{
    const mt_tree *const t = w->t;
    const int side = def->body[1] == t->body[i] ? 1 : 0;
    for (int k = 0; k < t->s; k++) {
        const int local = mt_tree_freedom(t, k);
        const mt_cx g =
            w->sys->bodies[t->body[i]].dof[local] >= 0 ? jet->g[(6 * side) + local] : 0.0;
        row[k] = creal(g);
        drow[k] = cx_derivative(g);
    }
}

/* Motion of two bodies in mode a: phi[12], 0 for constrained freedoms. */
static void tree_slope_pair(const tree_slope *w, int a, const int body[2], double *phi)
{
    const mt_tree *const t = w->t;
    memset(phi, 0, MT_LOCAL * sizeof *phi);
    for (int side = 0; side < 2; side++) {
        if (body[side] == MT_GROUND) {
            continue;
        }
        const double *const v = tree_slope_at(w, w->modes->v, t->place[body[side]], a);
        for (int k = 0; k < t->s; k++) {
            const int local = mt_tree_freedom(t, k);
            phi[(6 * side) + local] = w->sys->bodies[body[side]].dof[local] >= 0 ? v[k] : 0.0;
        }
    }
}

/* Slope by the present input += the symmetric form of left[a] and right[b]. */
static void add_form(tree_slope *w, const double *left, const double *right)
{
    const mt_tree_modes *const m = w->modes;
    double *const slope = w->slope + ((ptrdiff_t)m->n_pairs * w->data.input);
    for (int k = 0; k < m->n_pairs; k++) {
        const int a = m->pair[k][0];
        const int b = m->pair[k][1];
        slope[k] += (left[a] * right[b]) + (left[b] * right[a]);
    }
}

/* Report that there are no slopes: reason `text` for the current input. */
static void tree_slope_refuse(const tree_slope *w, const char *text)
{
    const int parameter = w->sys->inputs[w->data.input];
    (void)mt_snprintf(w->why, MT_TREE_WHY, "by %s%s%s %s",
                      parameter < 0 ? "the driven position" : "parameter \"",
                      parameter < 0 ? "" : w->sys->model->parameters[parameter].name.s,
                      parameter < 0 ? "" : "\"", text);
}

/* True where some input moves this node. */
static bool varies(const tree_slope *w, mt_node node)
{
    const double *const g = w->data.grad + ((ptrdiff_t)node * w->sys->n_inputs);
    bool any = false;
    for (int p = 0; p < w->sys->n_inputs; p++) {
        any = any || g[p] != 0.0;
    }
    return any;
}

/* Slopes by all inputs += sign times their share of the coefficient times the energies. */
static void add_energies(tree_slope *w, double sign, mt_node coefficient)
{
    const int np = w->sys->n_inputs;
    const double *const g = w->data.grad + ((ptrdiff_t)coefficient * np);
    for (int p = 0; p < np; p++) {
        if (g[p] != 0.0) {
            mt_axpy(w->modes->n_pairs, sign * g[p], w->energy,
                    w->slope + ((ptrdiff_t)w->modes->n_pairs * p));
        }
    }
}

/* energy += the form of rows projected[2 a], projected[2 a + 1] of each mode a. */
static void add_products(tree_slope *w, bool pair)
{
    const mt_tree_modes *const m = w->modes;
    for (int k = 0; k < m->n_pairs; k++) {
        const double *const a = w->projected + ((ptrdiff_t)2 * m->pair[k][0]);
        const double *const b = w->projected + ((ptrdiff_t)2 * m->pair[k][1]);
        w->energy[k] += pair ? 0.5 * ((a[0] * b[1]) + (a[1] * b[0])) : a[0] * b[0];
    }
}

/* Energies of a term with rows over both bodies. */
static void term_energies(tree_slope *w, mt_term_kind kind, const mt_term *term)
{
    mt_cx rows[MOST_ROWS * MT_LOCAL];
    mt_term_rows(&w->data, kind, term, w->pose, rows);
    memset(w->energy, 0, (size_t)w->modes->n_pairs * sizeof *w->energy);
    for (int r = 0; r < (term->pair ? 1 : term->count); r++) {
        for (int a = 0; a < w->modes->n; a++) {
            double phi[MT_LOCAL];
            double sum[2] = {0.0, 0.0};
            tree_slope_pair(w, a, term->body, phi);
            for (int k = 0; k < MT_LOCAL; k++) {
                sum[0] += creal(rows[k + (MT_LOCAL * r)]) * phi[k];
                sum[1] += term->pair ? creal(rows[k + MT_LOCAL]) * phi[k] : 0.0;
            }
            double *const projected = w->projected + ((ptrdiff_t)2 * a);
            projected[0] = sum[0];
            projected[1] = sum[1];
        }
        add_products(w, term->pair);
    }
}

/* Elongation of a spring of edge i in mode a: from the coordinates x and r without loads, where
 * the products with the row are exact zeros or well above rounding; otherwise from the
 * motion. */
static double stretch(const tree_slope *w, int i, int a, const double *row,
                      const double *product)
{
    const mt_tree *const t = w->t;
    if (t->transport != NULL) {
        return mt_dot(t->s, row, tree_slope_at(w, w->within, i, a));
    }
    const int n_y = t->y_at[i + 1] - t->y_at[i];
    const int free_dofs = t->free_dof_at[i + 1] - t->free_dof_at[i];
    const double *const x = w->modes->x + ((ptrdiff_t)t->n_x * a) + t->y_at[i];
    const double *const r = w->modes->r + ((ptrdiff_t)t->n_rigid * a) + t->free_dof_at[i];
    return mt_dot(n_y, product, x) + mt_dot(free_dofs, product + n_y, r);
}

static void spring_of_edge(tree_slope *w, int q, int i)
{
    const mt_tree *const t = w->t;
    const mt_spring_def *const def = &w->sys->springs[q];
    const mt_measure_def *const measure = &w->sys->measures[def->measure[0]];
    const double k = w->data.value[def->stiffness];
    const int first = t->y_at[i] + t->free_dof_at[i];
    const int d = t->y_at[i + 1] + t->free_dof_at[i + 1] - first;
    double row[MOST];
    double drow[MOST];
    double product[MOST];
    mt_jet jet;
    tree_slope_jet(w, measure, false, &jet);
    tree_slope_row(w, measure, i, &jet, row, drow);
    for (int c = 0; c < d; c++) {
        const double *const b = t->basis + ((ptrdiff_t)t->s * (first + c));
        double size = 0.0;
        product[c] = 0.0;
        for (int l = 0; l < t->s; l++) {
            product[c] += row[l] * b[l];
            size += fabs(row[l] * b[l]);
        }
        product[c] = fabs(product[c]) <= ROW_ULPS * DBL_EPSILON * size ? 0.0 : product[c];
    }
    for (int a = 0; a < w->modes->n; a++) {
        const double s = stretch(w, i, a, row, product);
        w->projected[(ptrdiff_t)2 * a] = s;
        w->force[q + ((ptrdiff_t)w->sys->n_springs * a)] = k * s;
    }
    if (varies(w, def->stiffness)) {
        memset(w->energy, 0, (size_t)w->modes->n_pairs * sizeof *w->energy);
        add_products(w, false);
        add_energies(w, 1.0, def->stiffness);
    }
}

/* Derivatives of stiffnesses and masses at constant geometry; spring forces of the modes. */
static void coefficients(tree_slope *w)
{
    const mt_system *const sys = w->sys;
    const mt_tree *const t = w->t;
    for (int i = 0; i < t->n; i++) {
        for (int q = t->first_spring[i]; q >= 0; q = t->next_spring[q]) {
            if (w->data.value[sys->springs[q].stiffness] != 0.0) {
                spring_of_edge(w, q, i);
            }
        }
    }
    for (int q = 0; q < sys->n_springs; q++) { /* no edge, as it has no stiffness yet */
        const mt_spring_def *const s = &sys->springs[q];
        if (!s->damper && w->data.value[s->stiffness] == 0.0 && varies(w, s->stiffness)) {
            const bool pair = s->measure[0] != s->measure[1];
            const int *const body = sys->measures[s->measure[0]].body;
            const mt_term term = {.coefficient = s->stiffness,
                                  .count = pair ? 2 : 1,
                                  .pair = pair,
                                  .body = {body[0], body[1]},
                                  .source = q};
            term_energies(w, MT_TERM_STIFFNESS, &term);
            add_energies(w, 1.0, s->stiffness);
        }
    }
    for (int i = 0; i < sys->n_inertias; i++) {
        const mt_term term = mt_term_of_inertia(sys, i);
        if (varies(w, term.coefficient)) {
            term_energies(w, MT_TERM_MASS, &term);
            for (int k = 0; k < w->modes->n_pairs; k++) {
                w->energy[k] *= w->modes->lambda[w->modes->pair[k][0]];
            }
            add_energies(w, -1.0, term.coefficient);
        }
    }
}

/* Joint forces of mode a at edge i: A^T mu = -(P + sum of k s f). */
static mt_status joint_forces_of_mode(tree_slope *w, int i, mt_err *err)
{
    const mt_tree *const t = w->t;
    const mt_system *const sys = w->sys;
    double row[MOST * MOST] = {0.0};
    double drow[MOST];
    double spring[MT_TREE_EDGE_ROWS * MOST];
    double g[MOST];
    double mu[MOST];
    mt_jet jet;
    mt_tree_held held;
    int c = 0;
    int n = 0;
    for (int k = t->first_constraint[i]; k >= 0; k = t->next_constraint[k], c++) {
        const mt_measure_def *const def = &sys->measures[sys->constraints[k].measure[0]];
        tree_slope_jet(w, def, w->geometric_stiffness != NULL, &jet);
        tree_slope_row(w, def, i, &jet, row + ((ptrdiff_t)t->s * c), drow);
        if (w->geometric_stiffness != NULL) {
            tree_slope_form(w, def->body, &jet, false,
                            w->geometric_stiffness + ((ptrdiff_t)w->modes->n_pairs * k));
        }
    }
    for (int q = t->first_spring[i]; q >= 0 && c > 0; q = t->next_spring[q], n++) {
        const mt_measure_def *const def = &sys->measures[sys->springs[q].measure[0]];
        tree_slope_jet(w, def, false, &jet);
        tree_slope_row(w, def, i, &jet, spring + ((ptrdiff_t)t->s * n), drow);
    }
    MT_TRY(mt_tree_hold(t, c, row, &held, err));
    for (int a = 0; a < w->modes->n && c > 0; a++) {
        memcpy(g, tree_slope_at(w, w->transport, i, a), (size_t)t->s * sizeof *g);
        n = 0;
        for (int q = t->first_spring[i]; q >= 0; q = t->next_spring[q], n++) {
            mt_axpy(t->s, w->force[q + ((ptrdiff_t)sys->n_springs * a)],
                    spring + ((ptrdiff_t)t->s * n), g);
        }
        mt_tree_multipliers(t, &held, g, mu);
        c = 0;
        for (int k = t->first_constraint[i]; k >= 0; k = t->next_constraint[k], c++) {
            w->mu[k + ((ptrdiff_t)sys->n_constraints * a)] = mu[c];
        }
    }
    return MT_OK;
}

/* slope += f' . w of a measure of edge i times the force that it transmits, of[list a +
 * which]. */
static void add_row_slope(tree_slope *w, int i, const mt_measure_def *def, const double *of,
                          ptrdiff_t list)
{
    double row[MOST];
    double drow[MOST];
    mt_jet jet;
    if (!tree_slope_moves(w, def)) {
        return;
    }
    double *const moved = w->projected + w->modes->n;
    tree_slope_jet(w, def, false, &jet);
    tree_slope_row(w, def, i, &jet, row, drow);
    for (int a = 0; a < w->modes->n; a++) {
        w->projected[a] = of[list * a];
        moved[a] = mt_dot(w->t->s, drow, tree_slope_at(w, w->within, i, a));
    }
    add_form(w, w->projected, moved);
}

/* P . X' v_before: X' v = theta x a', a the arm. */
static void add_arm(tree_slope *w, int i)
{
    const mt_tree *const t = w->t;
    const mt_tree_modes *const m = w->modes;
    const int p = t->before[i];
    if (p < 0 || !(centre_moves(w, t->body[i]) || centre_moves(w, t->body[p]))) {
        return;
    }
    double a[3];
    double *const slope = w->slope + ((ptrdiff_t)m->n_pairs * w->data.input);
    for (int k = 0; k < 3; k++) {
        a[k] = cx_derivative(w->pose[t->body[i]].x[k] - w->pose[t->body[p]].x[k]);
    }
    for (int k = 0; k < 2 * m->n_pairs; k++) {
        const double *const f = tree_slope_at(w, w->transport, i, m->pair[k / 2][k % 2]);
        const double *const v = tree_slope_at(w, m->v, p, m->pair[k / 2][1 - (k % 2)]);
        if (t->s == 3) {
            slope[k / 2] += v[2] * ((f[1] * a[0]) - (f[0] * a[1]));
        } else {
            const double *const u = v + 3;
            slope[k / 2] += (f[0] * ((u[1] * a[2]) - (u[2] * a[1]))) +
                            (f[1] * ((u[2] * a[0]) - (u[0] * a[2]))) +
                            (f[2] * ((u[0] * a[1]) - (u[1] * a[0])));
        }
    }
}

static bool inertia_moves(const tree_slope *w, const mt_inertia_def *def)
{
    const int p = w->data.input;
    bool moves = centre_moves(w, def->body[0]) || centre_moves(w, def->body[1]);
    for (int k = 0; k < 2; k++) {
        moves =
            moves || vec_moves(w, def->point[k], p) || tree_slope_of(w, def->shape[k]) != 0.0;
    }
    for (int k = 0; k < 3; k++) {
        moves = moves || vec_moves(w, def->dir[k], p);
    }
    return moves;
}

/* slope -= lambda m (g . v)' of a mass whose rows move. */
static void add_inertia(tree_slope *w, int i)
{
    const mt_tree_modes *const m = w->modes;
    const mt_term term = mt_term_of_inertia(w->sys, i);
    const double c = w->data.value[term.coefficient];
    double *const moved = w->projected + m->n;
    mt_cx rows[MOST_ROWS * MT_LOCAL];
    if (c == 0.0 || !inertia_moves(w, &w->sys->inertias[i])) {
        return;
    }
    mt_term_rows(&w->data, MT_TERM_MASS, &term, w->pose, rows);
    for (int r = 0; r < term.count; r++) {
        const mt_cx *const row = rows + ((ptrdiff_t)MT_LOCAL * r);
        const mt_cx *const other = term.pair ? rows + ((ptrdiff_t)MT_LOCAL * (1 - r)) : row;
        for (int a = 0; a < m->n; a++) {
            double phi[MT_LOCAL];
            tree_slope_pair(w, a, term.body, phi);
            w->projected[a] = 0.0;
            moved[a] = 0.0;
            for (int k = 0; k < MT_LOCAL; k++) {
                w->projected[a] += creal(other[k]) * phi[k];
                moved[a] += cx_derivative(row[k]) * phi[k];
            }
            w->projected[a] *= -m->lambda[a] * c * (term.pair ? 0.5 : 1.0);
        }
        add_form(w, w->projected, moved);
    }
}

/* True where the joints stay closed in the drawn position. */
static bool stays_closed(tree_slope *w)
{
    const mt_system *const sys = w->sys;
    double most = 0.0;
    if (sys->drawn_closed) {
        return true;
    }
    mt_data_targets(&w->data);
    for (int i = 0; i < sys->n_vecs; i++) {
        for (int k = 0; k < 3; k++) {
            most = fmax(most, fabs(cx_derivative(w->data.vec[i][k])));
        }
    }
    for (int i = 0; i < sys->n_constraints; i++) {
        const mt_measure_def *const def = &sys->measures[sys->constraints[i].measure[0]];
        const mt_measure_data measure = mt_data_measure(&w->data, def);
        const mt_cx value = mt_measure_value(&measure, mt_pose_of(w->pose, def->body[0]),
                                             mt_pose_of(w->pose, def->body[1]), NULL);
        if (!(fabs(cx_derivative(value - w->data.target[i])) <=
              DRAWN_CLOSED * fmax(most, fabs(cx_derivative(w->data.target[i]))))) {
            tree_slope_refuse(w, "a joint opens that is closed in the reference position");
            return false;
        }
    }
    return true;
}

/* Slopes from the geometry that depends on the present input. */
static void add_shape(tree_slope *w)
{
    const mt_tree *const t = w->t;
    const mt_system *const sys = w->sys;
    for (int i = 0; i < t->n; i++) {
        add_arm(w, i);
        for (int k = t->first_constraint[i]; k >= 0; k = t->next_constraint[k]) {
            add_row_slope(w, i, &sys->measures[sys->constraints[k].measure[0]], w->mu + k,
                          sys->n_constraints);
        }
        for (int q = t->first_spring[i]; q >= 0; q = t->next_spring[q]) {
            add_row_slope(w, i, &sys->measures[sys->springs[q].measure[0]], w->force + q,
                          sys->n_springs);
        }
    }
    for (int i = 0; i < sys->n_inertias; i++) {
        add_inertia(w, i);
    }
}

static mt_status init_tree_slope(tree_slope *w, const double *inputs, mt_err *err)
{
    const mt_system *const sys = w->sys;
    const size_t motions = (size_t)w->t->n * (size_t)w->t->s;
    const size_t modes = (size_t)w->modes->n;
    const size_t nodes = (size_t)sys->program.count;
    mt_arena *const mem = w->scratch;
    double *const value = mt_arena_f64(mem, nodes, 1);
    double *const grad = mt_arena_f64(mem, nodes, (size_t)sys->n_inputs);
    w->pose = mt_arena_alloc(mem, (size_t)sys->n_bodies, sizeof *w->pose);
    w->vec_inputs = mt_arena_alloc(mem, (size_t)sys->n_vecs * (size_t)sys->program.words,
                                   sizeof *w->vec_inputs);
    w->within = mt_arena_f64(mem, motions, modes);
    w->transport = mt_arena_f64(mem, motions, modes);
    w->force = mt_arena_f64(mem, (size_t)sys->n_springs, modes);
    w->mu = mt_arena_f64(mem, (size_t)sys->n_constraints, modes);
    w->projected = mt_arena_f64(mem, 2, modes);
    w->geometric_stiffness =
        w->t->geometric_stiffness == NULL
            ? NULL
            : mt_arena_f64(mem, (size_t)w->modes->n_pairs, (size_t)sys->n_constraints);
    w->energy = mt_arena_f64(mem, (size_t)w->modes->n_pairs, 1);
    MT_TRY(mt_data_init(&w->data, sys, mem, err));
    MT_TRY(mt_program_gradient(&sys->program, inputs, value, grad, NULL, err));
    w->data.value = value;
    w->data.grad = grad;
    find_inputs(w);
    mt_data_vecs(&w->data);
    mt_data_drawn(&w->data, w->pose);
    return MT_OK;
}

static mt_status carry_out(tree_slope *w, mt_err *err)
{
    const mt_tree *const t = w->t;
    const mt_tree_modes *const m = w->modes;
    const bool shaped = !w->sys->geometry_fixed || t->geometric_stiffness != NULL;
    for (int a = 0; a < m->n; a++) {
        const ptrdiff_t at = (ptrdiff_t)t->s * t->n * a;
        mt_tree_within(t, m->x + ((ptrdiff_t)t->n_x * a), m->r + ((ptrdiff_t)t->n_rigid * a),
                       m->v + at, w->within + at);
        if (shaped) {
            mt_tree_transport(t, m->lambda[a], m->v + at, w->transport + at);
        }
        MT_TRY(mt_interrupt_check(w->sys->run->interrupt, err));
    }
    coefficients(w);
    for (int i = 0; i < t->n && shaped; i++) {
        MT_TRY(joint_forces_of_mode(w, i, err));
    }
    for (int p = 0; p < w->sys->n_inputs && shaped; p++) {
        MT_TRY(mt_interrupt_check(w->sys->run->interrupt, err));
        turn_to(w, p);
        if (!stays_closed(w)) {
            return MT_OK;
        }
        add_shape(w);
        if (t->geometric_stiffness != NULL) {
            MT_TRY(tree_slope_loads(w, err));
        }
        if (w->why[0] != '\0') {
            return MT_OK;
        }
    }
    return MT_OK;
}

mt_status mt_tree_slopes(const mt_tree *t, const double *inputs, const mt_tree_modes *modes,
                         double *slope, char why[MT_TREE_WHY], mt_arena *scratch, mt_err *err)
{
    tree_slope w = {
        .t = t, .sys = t->sys, .modes = modes, .slope = slope, .why = why, .scratch = scratch};
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    why[0] = '\0';
    memset(slope, 0, (size_t)modes->n_pairs * (size_t)t->sys->n_inputs * sizeof *slope);
    MT_TRY(init_tree_slope(&w, inputs, err));
    MT_TRY(carry_out(&w, err));
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}

/*
 * Slopes of the geometric stiffness, c H of every measure that bears a force c, along one
 * input: phi^T (c' H + c H') phi. What loads and springs bear is known by itself; of the
 * joints the balance of tree.c is differentiated, from the leaves on,
 *     N^T (G' + A'^T lambda) = 0,    A^T lambda' = -(G' + A'^T lambda),
 *     G_before' += X^T G' + X'^T G.
 * Where the first does not hold, the drawing comes to rest elsewhere.
 */

/* As for the loads in tree.c, of derivatives. */
static const double NOT_AT_REST = 1e-9;

typedef struct along {
    tree_slope *w;
    double *g;    /* s x n: G' */
    double *size; /* [n] of all that G' is the sum of */
} along;

static double unit_of(const mt_tree *t, int k)
{
    return mt_tree_freedom(t, k) >= 3 ? t->sys->length_m : 1.0;
}

/* phi_a^T H phi_b of a jet over two bodies, for each pair, into form[n_pairs]; derivative: of
 * the derivative of H by the current input. */
static void tree_slope_form(const tree_slope *w, const int body[2], const mt_jet *jet,
                            bool derivative, double *form)
{
    const mt_tree_modes *const m = w->modes;
    for (int k = 0; k < m->n_pairs; k++) {
        double phi[2][MT_LOCAL];
        form[k] = 0.0;
        tree_slope_pair(w, m->pair[k][0], body, phi[0]);
        tree_slope_pair(w, m->pair[k][1], body, phi[1]);
        for (int c = 0; c < MT_LOCAL; c++) {
            for (int r = 0; r < MT_LOCAL && phi[1][c] != 0.0; r++) {
                const mt_cx h = jet->h[r + (MT_LOCAL * c)];
                form[k] += phi[0][r] * (derivative ? cx_derivative(h) : creal(h)) * phi[1][c];
            }
        }
    }
}

/* Slope by the present input += scale times a form. */
static void add_load_form(tree_slope *w, double scale, const double *form)
{
    mt_axpy(w->modes->n_pairs, scale, form,
            w->slope + ((ptrdiff_t)w->modes->n_pairs * w->data.input));
}

/* Add the contribution of a force c along a measure with this jet to G' and to the slope. */
static void add_force(const along *l, const int body[2], mt_cx c, const mt_jet *jet)
{
    const mt_tree *const t = l->w->t;
    for (int side = 0; side < 2; side++) {
        const int at = body[side] == MT_GROUND ? -1 : t->place[body[side]];
        for (int k = 0; k < t->s && at >= 0; k++) {
            const int local = mt_tree_freedom(t, k);
            if (t->sys->bodies[body[side]].dof[local] >= 0) {
                const double f = cx_derivative(cx_mul(c, jet->g[(6 * side) + local]));
                l->g[k + ((ptrdiff_t)t->s * at)] += f;
                l->size[at] += fabs(f) / unit_of(t, k);
            }
        }
    }
    tree_slope_form(l->w, body, jet, false, l->w->energy);
    add_load_form(l->w, cx_derivative(c), l->w->energy);
    tree_slope_form(l->w, body, jet, true, l->w->energy);
    add_load_form(l->w, creal(c), l->w->energy);
}

static void add_spring_slope(const along *l, const mt_spring_def *s)
{
    const mt_data *const d = &l->w->data;
    const mt_measure_def *const def = &l->w->sys->measures[s->measure[0]];
    const bool moves =
        tree_slope_moves(l->w, def) || tree_slope_of(l->w, s->stiffness) != 0.0 ||
        tree_slope_of(l->w, s->free) != 0.0 || tree_slope_of(l->w, s->preload) != 0.0;
    if (s->damper || (s->free == MT_NO_NODE && s->preload == MT_NO_NODE) || !moves) {
        return;
    }
    mt_jet jet;
    tree_slope_jet(l->w, def, true, &jet);
    mt_cx c = mt_data_scalar(d, s->preload, 0.0);
    if (s->free != MT_NO_NODE) {
        c += cx_mul(mt_data_scalar(d, s->stiffness, 0.0),
                    jet.value - mt_data_scalar(d, s->free, 0.0));
    }
    add_force(l, def->body, c, &jet);
}

static void add_load(const along *l, const mt_load_def *load)
{
    const mt_data *const d = &l->w->data;
    mt_jet jet;
    if (load->measure >= 0) {
        const mt_measure_def *const def = &l->w->sys->measures[load->measure];
        if (tree_slope_moves(l->w, def) || tree_slope_of(l->w, load->size) != 0.0) {
            tree_slope_jet(l->w, def, true, &jet);
            add_force(l, def->body, -mt_data_scalar(d, load->size, 0.0), &jet);
        }
        return;
    }
    const int body[2] = {load->body, MT_GROUND};
    mt_cx f[3];
    bool moves = tree_slope_moves_vec(l->w, load->point);
    for (int k = 0; k < 3; k++) {
        f[k] = mt_data_scalar(d, load->force[k], 0.0);
        moves = moves || tree_slope_of(l->w, load->force[k]) != 0.0;
    }
    if (!moves) {
        return;
    }
    mt_measure_point(load->point < 0 ? NULL : d->vec[load->point], f,
                     mt_pose_of(l->w->pose, load->body), true, &jet);
    add_force(l, body, -1.0, &jet);
}

/* True where the residual is balanced along the free motions of the edge. */
static bool stays_at_rest(const along *l, int i, const double *g)
{
    const mt_tree *const t = l->w->t;
    for (int c = t->y_at[i] + t->free_dof_at[i]; c < t->y_at[i + 1] + t->free_dof_at[i + 1];
         c++) {
        const double *const b = t->basis + ((ptrdiff_t)t->s * c);
        double most = 0.0;
        for (int k = 0; k < t->s; k++) {
            most = fmax(most, fabs(b[k]) * unit_of(t, k));
        }
        if (!(fabs(mt_dot(t->s, b, g)) <= NOT_AT_REST * most * l->size[i])) {
            tree_slope_refuse(l->w, "the equilibrium is not the reference position");
            return false;
        }
    }
    return true;
}

/* G' of the body before: X^T G' + X'^T G, the latter a' x force. */
static void hand_on(const along *l, int i)
{
    const mt_tree *const t = l->w->t;
    const int p = t->before[i];
    if (p < 0) {
        return;
    }
    const double *const f = t->pushed + ((ptrdiff_t)t->s * i);
    double *const g = l->g + ((ptrdiff_t)t->s * p);
    double a[3];
    for (int k = 0; k < 3; k++) {
        a[k] = cx_derivative(l->w->pose[t->body[i]].x[k] - l->w->pose[t->body[p]].x[k]);
        l->size[p] += fabs(a[k]) * t->force[i] / t->sys->length_m;
    }
    mt_tree_carry_back(t, i, l->g + ((ptrdiff_t)t->s * i), g);
    l->size[p] += l->size[i];
    if (t->s == 3) {
        g[2] += (a[0] * f[1]) - (a[1] * f[0]);
    } else {
        g[3] += (a[1] * f[2]) - (a[2] * f[1]);
        g[4] += (a[2] * f[0]) - (a[0] * f[2]);
        g[5] += (a[0] * f[1]) - (a[1] * f[0]);
    }
}

/* Derivative of the forces that the joints of edge i hold. False: not in equilibrium. */
static mt_status joint_force_slope(const along *l, int i, bool *rests, mt_err *err)
{
    tree_slope *const w = l->w;
    const mt_tree *const t = w->t;
    double row[MOST * MOST];
    double drow[MOST];
    double g[MOST];
    double slope[MOST];
    mt_jet jet;
    mt_tree_held held;
    int c = 0;
    memcpy(g, l->g + ((ptrdiff_t)t->s * i), (size_t)t->s * sizeof *g);
    for (int k = t->first_constraint[i]; k >= 0; k = t->next_constraint[k], c++) {
        const mt_measure_def *const def = &w->sys->measures[w->sys->constraints[k].measure[0]];
        const bool moves = tree_slope_moves(w, def);
        tree_slope_jet(w, def, moves, &jet);
        tree_slope_row(w, def, i, &jet, row + ((ptrdiff_t)t->s * c), drow);
        if (moves) {
            tree_slope_form(w, def->body, &jet, true, w->energy);
            add_load_form(w, t->held[k], w->energy);
            mt_axpy(t->s, t->held[k], drow, g);
        }
        for (int r = 0; r < t->s && moves; r++) {
            l->size[i] += fabs(t->held[k] * drow[r]) / unit_of(t, r);
        }
    }
    *rests = stays_at_rest(l, i, g);
    MT_TRY(mt_tree_hold(t, c, row, &held, err));
    mt_tree_multipliers(t, &held, g, slope);
    c = 0;
    for (int k = t->first_constraint[i]; k >= 0; k = t->next_constraint[k], c++) {
        add_load_form(w, slope[c], w->geometric_stiffness + ((ptrdiff_t)w->modes->n_pairs * k));
    }
    hand_on(l, i);
    return MT_OK;
}

/* Contribution of the loads along the current input. Fails: MT_E_NOT_SPD. */
static mt_status tree_slope_loads(tree_slope *w, mt_err *err)
{
    const mt_tree *const t = w->t;
    const mt_arena_mark mark = mt_arena_get_mark(w->scratch);
    const along l = {.w = w,
                     .g = mt_arena_f64(w->scratch, (size_t)t->n, (size_t)t->s),
                     .size = mt_arena_f64(w->scratch, (size_t)t->n, 1)};
    bool rests = true;
    MT_TRY(mt_arena_check(w->scratch, err));
    for (int i = 0; i < w->sys->n_loads; i++) {
        add_load(&l, &w->sys->loads[i]);
    }
    for (int i = 0; i < w->sys->n_springs; i++) {
        add_spring_slope(&l, &w->sys->springs[i]);
    }
    for (int i = t->n - 1; i >= 0 && rests; i--) {
        MT_TRY(joint_force_slope(&l, i, &rests, err));
    }
    mt_arena_rewind(w->scratch, mark);
    return MT_OK;
}
