/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What moves between the nodes of a beam element, in the frame of its chord (length l, as it is
 * now): e1 along the chord, e2 and e3 halfway between those of the two nodes. In one plane of
 * bending, with the nodes' deflections w_A, w_B and the rotations t_A, t_B of their sections,
 * and
 *     psi = (w_B - w_A)/l,   kappa = t_B - t_A,   s = t_A + t_B - 2 psi,   mu = 1/(1 + Phi)
 *         (1: Euler-Bernoulli),
 * the static solution is, in Legendre polynomials of y = 2 x/l - 1,
 *     w     = [(w_A + w_B)/2 - l kappa/12] P0 + l [psi/2 - mu s/20] P1 + l kappa/12 P2 + l mu
 *         s/20 P3
 *     theta = [psi + (1 - mu) s/2] P0 + kappa/2 P1 + mu s/2 P2,
 * and because the integral of P_i P_j over the element is l/(2 i + 1) for i = j, else 0, the
 * consistent masses m/l int w^2 and J/l int theta^2 are sums of squares of these brackets over
 * sqrt(2 i + 1). (mu = 1: Archer's 1/420 [156 22 54 -13; ...].) A bar's, linear, is one of two
 * squares.
 */
#include "mechanics/rows_priv.h"

#include <math.h>

static const mt_cx CENTRE[3] = {0.0, 0.0, 0.0};

void mt_beam_frame(const mt_data *d, const int body[2], const int dir[3], const mt_pose *poses,
                   mt_beam_geometry *out)
{
    const mt_pose *const a = mt_pose_of(poses, body[0]);
    const mt_pose *const b = mt_pose_of(poses, body[1]);
    mt_cx half[2][3];
    cx_rotate3(a->r, d->vec[dir[1]], half[0]);
    cx_rotate3(b->r, d->vec[dir[1]], half[1]);
    mt_cx *const e1 = out->e[0];
    mt_cx *const e2 = out->e[1];
    for (int i = 0; i < 3; i++) {
        e1[i] = b->x[i] - a->x[i];
        e2[i] = half[0][i] + half[1][i];
    }
    out->length = cx_norm3(e1);
    cx_unit3(e1);
    const mt_cx along = cx_dot3(e1, e2);
    for (int i = 0; i < 3; i++) {
        e2[i] -= cx_mul(along, e1[i]);
    }
    cx_unit3(e2);
    cx_cross3(e1, e2, out->e[2]);
    for (int k = 0; k < 2; k++) {
        out->shape[k] = 1.0;
    }
}

/* row += w_A by[0] + l t_A by[1] + w_B by[2] + l t_B by[3], in the plane of bending about e2 (k
 * = 0: deflection along e3, t = -theta2) or e3 (k = 1). */
static void add_plane(mt_cx *row, const mt_beam_geometry *g, int k, const mt_cx by[4])
{
    const mt_cx *const u = g->e[k == 0 ? 2 : 1];
    const mt_cx *const t = g->e[1 + k];
    const double sign = k == 0 ? -1.0 : 1.0;
    for (int side = 0; side < 2; side++) {
        const mt_cx *const own = side == 0 ? by : by + 2;
        mt_row_add_point(row, side, CENTRE, u, own[0]);
        mt_row_add_turn(row, side, t, sign * cx_mul(g->length, own[1]));
    }
}

/* by += scale (l kappa), by += scale (l s). */
static void add_kappa(mt_cx by[4], mt_cx scale)
{
    by[1] -= scale;
    by[3] += scale;
}

static void add_sway(mt_cx by[4], mt_cx scale)
{
    by[0] += 2.0 * scale;
    by[1] += scale;
    by[2] -= 2.0 * scale;
    by[3] += scale;
}

void mt_beam_deflection_rows(const mt_beam_geometry *g, int k, mt_cx *rows)
{
    const mt_cx mu = g->shape[k];
    mt_cx by[MT_DEFLECTION_ROWS][4] = {{0.5, 0.0, 0.5, 0.0}, {-0.5, 0.0, 0.5, 0.0}};
    add_kappa(by[0], -1.0 / 12.0);
    add_sway(by[1], -mu / 20.0);
    add_kappa(by[2], 1.0 / 12.0);
    add_sway(by[3], mu / 20.0);
    for (int i = 0; i < MT_DEFLECTION_ROWS; i++) {
        for (int j = 0; j < 4; j++) {
            by[i][j] /= sqrt((2.0 * i) + 1.0);
        }
        add_plane(rows + ((ptrdiff_t)i * MT_LOCAL), g, k, by[i]);
    }
}

void mt_beam_rotary_rows(const mt_beam_geometry *g, int k, mt_cx *rows)
{
    const mt_cx mu = g->shape[k];
    mt_cx by[MT_ROTARY_ROWS][4] = {{-1.0, 0.0, 1.0, 0.0}};
    add_sway(by[0], 0.5 * (1.0 - mu));
    add_kappa(by[1], 0.5);
    add_sway(by[2], 0.5 * mu);
    for (int i = 0; i < MT_ROTARY_ROWS; i++) {
        for (int j = 0; j < 4; j++) {
            by[i][j] = cx_div(by[i][j], g->length) / sqrt((2.0 * i) + 1.0);
        }
        add_plane(rows + ((ptrdiff_t)i * MT_LOCAL), g, k, by[i]);
    }
}

void mt_beam_bar_rows(const mt_beam_geometry *g, bool turn, mt_cx *rows)
{
    for (int i = 0; i < MT_BAR_ROWS; i++) {
        mt_cx *const row = rows + ((ptrdiff_t)i * MT_LOCAL);
        for (int side = 0; side < 2; side++) {
            const double by = i == 0 ? 0.5 : (side == 0 ? -0.5 : 0.5) / sqrt(3.0);
            if (turn) {
                mt_row_add_turn(row, side, g->e[0], by);
            } else {
                mt_row_add_point(row, side, CENTRE, g->e[0], by);
            }
        }
    }
}

void mt_beam_deflection_at(const mt_beam_geometry *g, int k, mt_cx x, mt_cx weight, mt_cx *row)
{
    const mt_cx bow = cx_mul(x, x) - x;
    const mt_cx wave = -cx_mul(bow, 1.0 - (2.0 * x));
    mt_cx by[4] = {1.0 - x, 0.0, x, 0.0};
    add_kappa(by, 0.5 * bow);
    add_sway(by, 0.5 * cx_mul(g->shape[k], wave));
    for (int j = 0; j < 4; j++) {
        by[j] = cx_mul(weight, by[j]);
    }
    add_plane(row, g, k, by);
}

void mt_beam_slope_at(const mt_beam_geometry *g, int k, mt_cx x, mt_cx weight, mt_cx *row)
{
    const mt_cx mu = g->shape[k];
    const mt_cx p2 = 1.0 + (6.0 * (cx_mul(x, x) - x));
    mt_cx by[4] = {-1.0, 0.0, 1.0, 0.0};
    add_kappa(by, x - 0.5);
    add_sway(by, 0.5 * (cx_mul(mu, p2) + 1.0 - mu));
    for (int j = 0; j < 4; j++) {
        by[j] = cx_div(cx_mul(weight, by[j]), g->length);
    }
    add_plane(row, g, k, by);
}
