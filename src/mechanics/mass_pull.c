/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A row r of M is made of vectors that turn with something: of a body its axes, of a bar the
 * arms of its ends, of a beam element its frame e and its length L (rows_beam.c). As that turns
 * by omega, a block b of r (displacement or rotation of one body) changes by omega x b, and
 *     (r . phi)' = omega . sum b x phi_b;
 * an arm s of a block s x e by omega x s, and (r . phi)' = omega . (s x (e x phi_theta)). In
 * rows of deflection the blocks of rotations are in proportion to L, in those of rotary inertia
 * the blocks of displacements to 1/L. With d = x_B - x_A = L e1, h = h_A + h_B the halves of
 * the frame's second axis, n = h - (h . e1) e1 = |n| e2,
 *     e1' = (d' - e1 e1 . d')/L,   omega = e1 x e1' + e1 (e3 . h' - (h . e1) e3 . e1')/|n|,
 *     h' = theta_A x h_A + theta_B x h_B,   L' = e1 . d'.
 */
#include "mechanics/mass_pull.h"

#include "mechanics/rows_priv.h"

static void add3(double c, const double *v, double *to)
{
    for (int k = 0; k < 3; k++) {
        to[k] += c * v[k];
    }
}

static double dot3(const double *a, const double *b)
{
    return (a[0] * b[0]) + (a[1] * b[1]) + (a[2] * b[2]);
}

/* A vector of a body's drawing as the body stands now; -1: none. */
static void turned(const mt_linear *lin, int body, int vec, double out[3])
{
    const mt_pose *const pose = mt_pose_of(lin->position.at.pose, body);
    for (int i = 0; i < 3; i++) {
        out[i] = 0.0;
        for (int k = 0; k < 3 && vec >= 0; k++) {
            out[i] += creal(pose->r[i + (3 * k)]) * creal(lin->data.vec[vec][k]);
        }
    }
}

/* What pulls at a beam element's frame: moment, and force that lengthens. */
typedef struct frame_pull {
    double moment[3];
    double length;
} frame_pull;

/* on[MT_LOCAL] += c times the derivative of r . phi, of a row that turns with its body or with
 * the arms of a bar's ends. */
static void pull_row(const mt_linear *lin, const mt_inertia_def *def, double c,
                     const double *row, const double *phi, double *on)
{
    for (int side = 0; side < 2; side++) {
        const double *const block = row + ((ptrdiff_t)6 * side);
        const double *const turn = phi + ((ptrdiff_t)6 * side) + 3;
        double s[3];
        double v[3];
        double w[3];
        if (def->kind == MT_INERTIA_ROTATION) {
            mt_cross3(block + 3, turn, v);
            add3(c, v, on + ((ptrdiff_t)6 * side) + 3);
        } else {
            turned(lin, def->body[side], def->point[side], s);
            mt_cross3(block, turn, v);
            mt_cross3(s, v, w);
            add3(c, w, on + ((ptrdiff_t)6 * side) + 3);
        }
    }
}

/* The same of a beam element's row. per_length: the power of L that it has, +1 in rotations, -1
 * in displacements, 0: none. */
static void pull_frame(double c, int per_length, const double *row, const double *phi,
                       frame_pull *on)
{
    double sized = 0.0;
    for (int b = 0; b < 4; b++) {
        double v[3];
        mt_cross3(row + ((ptrdiff_t)3 * b), phi + ((ptrdiff_t)3 * b), v);
        add3(c, v, on->moment);
        if (per_length == (b % 2 == 1 ? 1 : -1)) {
            sized += dot3(row + ((ptrdiff_t)3 * b), phi + ((ptrdiff_t)3 * b));
        }
    }
    on->length += c * per_length * sized;
}

static int power_of_length(const mt_inertia_def *def, int row)
{
    if (def->kind == MT_INERTIA_BEAM_ROTARY) {
        return -1;
    }
    return def->kind == MT_INERTIA_BEAM && row >= MT_BAR_ROWS ? 1 : 0;
}

/* on[MT_LOCAL] += what pulls at the frame, as forces on the two nodes. */
static void spread_frame(const mt_linear *lin, const mt_inertia_def *def,
                         const frame_pull *frame, double *on)
{
    mt_beam_geometry g = {.shape = {1.0, 1.0}};
    double e[3][3];
    double h[2][3];
    double chord[3];
    double v[3];
    mt_beam_frame(&lin->data, def->body, def->dir, lin->position.at.pose, &g);
    for (int i = 0; i < 9; i++) {
        e[i / 3][i % 3] = creal(g.e[i / 3][i % 3]);
    }
    const double length = creal(g.length);
    for (int side = 0; side < 2; side++) {
        turned(lin, def->body[side], def->dir[1], h[side]);
    }
    const double along = dot3(h[0], e[0]) + dot3(h[1], e[0]);
    const double across = dot3(h[0], e[1]) + dot3(h[1], e[1]); /* |n| */
    const double twist = dot3(frame->moment, e[0]) / across;
    mt_cross3(frame->moment, e[0], chord);
    for (int k = 0; k < 3; k++) {
        chord[k] = ((chord[k] - (twist * along * e[2][k])) / length) +
                   (frame->length / length * e[0][k]);
    }
    add3(-1.0, chord, on);
    add3(1.0, chord, on + 6);
    for (int side = 0; side < 2; side++) {
        mt_cross3(h[side], e[2], v);
        add3(twist, v, on + ((ptrdiff_t)6 * side) + 3);
    }
}

static bool has_frame(const mt_inertia_def *def)
{
    return def->kind == MT_INERTIA_BEAM || def->kind == MT_INERTIA_BEAM_TWIST ||
           def->kind == MT_INERTIA_BEAM_ROTARY;
}

/* The motion that row r of a term is multiplied with; 0 where joints block it. */
static double partner_motion(const mt_linear *lin, const mt_term *t, int r, const double *phi)
{
    const int row = t->pair ? (2 * t->first) + 1 - r : r;
    const bool blocked = !t->pair && mt_rows_empty(&lin->entries[MT_TERM_MASS], row);
    return blocked ? 0.0 : mt_rows_dot(&lin->full[MT_TERM_MASS], row, phi);
}

static void pull_term(const mt_linear *lin, const mt_term *t, double scale, const double *phi,
                      double *to)
{
    const mt_inertia_def *const def = &lin->sys->inertias[t->source];
    const bool framed = has_frame(def);
    const double c = scale * lin->value[t->coefficient] * (t->pair ? 1.0 : 2.0);
    double way[MT_LOCAL];
    double on[MT_LOCAL] = {0.0};
    frame_pull frame = {.length = 0.0};
    for (int k = 0; k < MT_LOCAL; k++) {
        const int dof = mt_local_dof(lin->sys, t->body, k);
        way[k] = dof >= 0 ? phi[dof] : 0.0;
    }
    for (int r = t->first; r < t->first + t->count; r++) {
        const double *const row = lin->rows[MT_TERM_MASS] + ((ptrdiff_t)r * MT_LOCAL);
        const double by = c * partner_motion(lin, t, r, phi);
        if (framed) {
            pull_frame(by, power_of_length(def, r - t->first), row, way, &frame);
        } else {
            pull_row(lin, def, by, row, way, on);
        }
    }
    if (framed) {
        spread_frame(lin, def, &frame, on);
    }
    for (int k = 0; k < MT_LOCAL; k++) {
        const int dof = mt_local_dof(lin->sys, t->body, k);
        if (dof >= 0) {
            to[dof] += on[k];
        }
    }
}

void mt_mass_pull(const mt_linear *lin, double scale, const double *phi, double *to)
{
    const mt_term_list *const list = &lin->list[MT_TERM_MASS];
    for (int i = 0; i < list->n_terms; i++) {
        const mt_term *const t = &list->terms[i];
        if (lin->sys->inertias[t->source].kind != MT_INERTIA_TRANSLATION) {
            pull_term(lin, t, scale, phi, to);
        }
    }
}
