/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Slopes of the geometric stiffness, c H of every measure that bears a force c, along one
 * input: phi^T (c' H + c H') phi. What loads and springs bear is known by itself; of the
 * joints the balance of tree_load.c is differentiated, from the leaves on,
 *     N^T (G' + A'^T lambda) = 0,    A^T lambda' = -(G' + A'^T lambda),
 *     G_before' += X^T G' + X'^T G.
 * Where the first does not hold, the drawing comes to rest elsewhere.
 */
#include "tree/tree_slope_priv.h"

#include <math.h>
#include <string.h>

#include "linalg/dense.h"

enum { MOST = MT_TREE_MOTION };

/* As in tree_load.c, of derivatives. */
static const double NOT_AT_REST = 1e-9;

typedef struct along {
    mt_tree_slope *w;
    double *g;    /* s x n: G' */
    double *size; /* [n] of all that G' is the sum of */
} along;

static double unit_of(const mt_tree *t, int k)
{
    return mt_tree_freedom(t, k) >= 3 ? t->sys->length_m : 1.0;
}

void mt_tree_slope_form(const mt_tree_slope *w, const int body[2], const mt_jet *jet,
                        bool derivative, double *form)
{
    const mt_tree_modes *const m = w->modes;
    for (int k = 0; k < m->n_pairs; k++) {
        double phi[2][MT_LOCAL];
        form[k] = 0.0;
        mt_tree_slope_pair(w, m->pair[k][0], body, phi[0]);
        mt_tree_slope_pair(w, m->pair[k][1], body, phi[1]);
        for (int c = 0; c < MT_LOCAL; c++) {
            for (int r = 0; r < MT_LOCAL && phi[1][c] != 0.0; r++) {
                const mt_cx h = jet->h[r + (MT_LOCAL * c)];
                form[k] += phi[0][r] * (derivative ? cx_derivative(h) : creal(h)) * phi[1][c];
            }
        }
    }
}

/* Slope by the present input += scale times a form. */
static void add_form(mt_tree_slope *w, double scale, const double *form)
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
    mt_tree_slope_form(l->w, body, jet, false, l->w->energy);
    add_form(l->w, cx_derivative(c), l->w->energy);
    mt_tree_slope_form(l->w, body, jet, true, l->w->energy);
    add_form(l->w, creal(c), l->w->energy);
}

static void add_spring_slope(const along *l, const mt_spring_def *s)
{
    const mt_data *const d = &l->w->data;
    const mt_measure_def *const def = &l->w->sys->measures[s->measure[0]];
    const bool moves =
        mt_tree_slope_moves(l->w, def) || mt_tree_slope_of(l->w, s->stiffness) != 0.0 ||
        mt_tree_slope_of(l->w, s->free) != 0.0 || mt_tree_slope_of(l->w, s->preload) != 0.0;
    if (s->damper || (s->free == MT_NO_NODE && s->preload == MT_NO_NODE) || !moves) {
        return;
    }
    mt_jet jet;
    mt_tree_slope_jet(l->w, def, true, &jet);
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
        if (mt_tree_slope_moves(l->w, def) || mt_tree_slope_of(l->w, load->size) != 0.0) {
            mt_tree_slope_jet(l->w, def, true, &jet);
            add_force(l, def->body, -mt_data_scalar(d, load->size, 0.0), &jet);
        }
        return;
    }
    const int body[2] = {load->body, MT_GROUND};
    mt_cx f[3];
    bool moves = mt_tree_slope_moves_vec(l->w, load->point);
    for (int k = 0; k < 3; k++) {
        f[k] = mt_data_scalar(d, load->force[k], 0.0);
        moves = moves || mt_tree_slope_of(l->w, load->force[k]) != 0.0;
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
            mt_tree_slope_refuse(l->w, "the equilibrium is not the reference position");
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
    mt_tree_slope *const w = l->w;
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
        const bool moves = mt_tree_slope_moves(w, def);
        mt_tree_slope_jet(w, def, moves, &jet);
        mt_tree_slope_row(w, def, i, &jet, row + ((ptrdiff_t)t->s * c), drow);
        if (moves) {
            mt_tree_slope_form(w, def->body, &jet, true, w->energy);
            add_form(w, t->held[k], w->energy);
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
        add_form(w, slope[c], w->geometric_stiffness + ((ptrdiff_t)w->modes->n_pairs * k));
    }
    hand_on(l, i);
    return MT_OK;
}

mt_status mt_tree_slope_loads(mt_tree_slope *w, mt_err *err)
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
