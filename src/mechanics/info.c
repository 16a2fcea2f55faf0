/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Mass properties from the kinetic energy of the six rigid-body motions of everything together:
 * with R = [translations, rotations about the origin],
 *     R^T M R = [ m I     -m [c]x          ]        [c]x v = c x v,
 *               [ m [c]x   J - m [c]x [c]x ]
 * which holds for points, bodies, and consistent bars and beams alike.
 */
#include "mechanics/info.h"

#include "mechanics/linear_priv.h"

#include <math.h>

#include "mechanics/linear.h"

enum { MOTIONS = 6 };

/* The third axis beside two different ones. */
static const int THIRD[3][3] = {{0, 2, 1}, {2, 1, 0}, {1, 0, 2}};

/* Component of a row of a mass term along motion k of the whole: translation along axis k, or
 * rotation about axis k - 3 through the origin. */
static double row_of_motion(const mt_linear *lin, const mt_term *t, const double *row, int k)
{
    double sum = 0.0;
    for (int i = 0; i < MT_LOCAL; i++) {
        const mt_pose *const pose = mt_pose_of(lin->position.at.pose, t->body[i / 6]);
        const int axis = i % 6;
        double v = axis == k ? 1.0 : 0.0;
        if (axis < 3 && k >= 3 && axis != k - 3) { /* e_(k-3) x r */
            const int other = THIRD[axis][k - 3];
            v = ((k - 2) % 3 == other ? 1.0 : -1.0) * creal(pose->x[other]);
        }
        sum += row[i] * v;
    }
    return sum;
}

/* g = R^T M R, summed row by row: so the ends of bars that the ground holds count as well. */
static void rigid_energy(const mt_linear *lin, double g[MOTIONS][MOTIONS])
{
    const mt_term_list *const list = &lin->list[MT_TERM_MASS];
    for (int r = 0; r < list->n_rows; r++) {
        const mt_term *const t = &list->terms[list->row_term[r]];
        const int other = t->pair ? (2 * t->first) + 1 - r : r;
        const double c = lin->value[t->coefficient] * (t->pair ? 0.5 : 1.0);
        const double *const rows = lin->rows[MT_TERM_MASS];
        for (int i = 0; i < MOTIONS; i++) {
            const double a = row_of_motion(lin, t, rows + ((ptrdiff_t)r * MT_LOCAL), i);
            for (int j = 0; j < MOTIONS; j++) {
                g[i][j] +=
                    c * a * row_of_motion(lin, t, rows + ((ptrdiff_t)other * MT_LOCAL), j);
            }
        }
    }
}

static void from_energy(const double g[MOTIONS][MOTIONS], int dimension, mt_info *out)
{
    static const int PAIR[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
    const double m = g[0][0];
    /* a rotation about axis a has the momentum m e_a x c */
    const double c[3] = {m > 0.0 ? g[5][1] / m : 0.0, m > 0.0 ? -g[5][0] / m : 0.0,
                         m > 0.0 && dimension == 3 ? g[4][0] / m : 0.0};
    out->mass_kg = m;
    const double cc = (c[0] * c[0]) + (c[1] * c[1]) + (c[2] * c[2]);
    for (int k = 0; k < 6; k++) {
        const int i = PAIR[k][0];
        const int j = PAIR[k][1];
        const double steiner = (i == j ? cc : 0.0) - (c[i] * c[j]);
        const bool there = dimension == 3 || k == 2;
        out->inertia_kg_m2[k] = there ? g[3 + i][3 + j] - (m * steiner) : 0.0;
    }
    for (int k = 0; k < 3; k++) {
        out->centre_m[k] = m > 0.0 && isfinite(c[k]) ? c[k] : nan("");
    }
}

/* Dampers, each once (a bushing's directions are consecutive), and the range of loss
 * factors. */
static void count_damping(const mt_linear *lin, mt_info *out)
{
    const mt_system *const sys = lin->sys;
    const char *last = NULL;
    out->least_loss = nan("");
    out->most_loss = nan("");
    for (int i = 0; i < sys->n_springs; i++) {
        const mt_spring_def *const s = &sys->springs[i];
        if (s->damper) {
            out->dampers += s->name == last ? 0 : 1;
            last = s->name;
        } else if (s->loss != MT_NO_NODE) {
            out->least_loss = fmin(out->least_loss, lin->value[s->loss]);
            out->most_loss = fmax(out->most_loss, lin->value[s->loss]);
        }
    }
}

mt_status mt_info_fill(const mt_linear *lin, mt_info *out, mt_err *err)
{
    if (!lin->stages.valid[MT_STAGE_REDUCTION]) {
        return mt_fail(err, MT_E_INTERNAL, "mass properties asked for before an update");
    }
    double g[MOTIONS][MOTIONS] = {{0.0}};
    *out = (mt_info){.states = lin->sys->nq,
                     .equations = lin->m,
                     .freedoms = lin->n,
                     .free_spins = lin->n_free_spins,
                     .redundant = mt_linear_redundant(lin),
                     .residual = lin->position.equilibrium.residual,
                     .gap_m = lin->position.gap_m};
    count_damping(lin, out);
    rigid_energy(lin, g);
    from_energy((const double(*)[MOTIONS])g, lin->sys->dimension, out);
    return MT_OK;
}
