/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mechanics/element_forces.h"

#include <float.h>
#include <math.h>

/* The slope of a beam element's chord: coordinates over its length. */
static bool is_chord(const mt_measure_def *def)
{
    return def->kind == MT_MEASURE_BEAM && def->component >= MT_BEAM_SWAY_2;
}

bool mt_piece_is_angle(const mt_measure_def *def)
{
    return def->kind == MT_MEASURE_ANGLE || def->kind == MT_MEASURE_ROTATION ||
           def->kind == MT_MEASURE_DOT ||
           (def->kind == MT_MEASURE_BEAM && def->component != MT_BEAM_STRETCH &&
            !is_chord(def));
}

/* Largest coordinate of the two bodies, the scale of the rounding of their positions. */
static double extent_of(const mt_pose *poses, const int body[2])
{
    double extent = 0.0;
    for (int side = 0; side < 2; side++) {
        const mt_pose *const pose = mt_pose_of(poses, body[side]);
        for (int k = 0; k < 3; k++) {
            extent = fmax(extent, fabs(creal(pose->x[k])));
        }
    }
    return extent;
}

double mt_jet_along(const mt_system *sys, const int body[2], const mt_jet *jet,
                    const double *motion)
{
    double sum = 0.0;
    for (int k = 0; k < MT_LOCAL; k++) {
        const int dof = mt_local_dof(sys, body, k);
        sum += dof >= 0 ? creal(jet->g[k]) * motion[dof] : 0.0;
    }
    return sum;
}

double mt_piece_roundness(const mt_data *d, const mt_measure_def *def, const mt_pose *poses)
{
    double extent =
        mt_piece_is_angle(def) ? 1.0 : fmax(d->sys->length_m, extent_of(poses, def->body));
    if (is_chord(def)) {
        extent /= creal(mt_data_scalar(d, def->beam[MT_BEAM_LENGTH], 1.0));
    }
    return DBL_EPSILON * extent;
}

double mt_piece_work(const mt_piece *p, const double *way)
{
    double local[MT_LOCAL];
    double sum = 0.0;
    mt_piece_motion(p, way, local);
    for (int k = 0; k < MT_LOCAL; k++) {
        sum += p->g[k] * local[k];
    }
    return sum;
}

double mt_piece_bend(const mt_piece *p, const double *phi, double *out)
{
    double way[MT_RELATIVE];
    double bent[MT_RELATIVE];
    double energy = 0.0;
    mt_piece_relative(p, phi, way);
    mt_piece_product(p->filled, p->h, way, bent);
    for (int k = 0; k < MT_RELATIVE; k++) {
        energy += way[k] * bent[k];
    }
    for (int k = 0; k < MT_LOCAL; k++) {
        out[k] = mt_relative_sign(k) * bent[mt_relative_of(k)];
    }
    return energy;
}

void mt_piece_add(const mt_piece *p, double c, const double *local, double *to)
{
    for (int k = 0; k < MT_LOCAL && c != 0.0; k++) {
        if (p->dof[k] >= 0) {
            to[p->dof[k]] += c * local[k];
        }
    }
}

static void add_entry(ptrdiff_t nq, const mt_piece *p, int r, int c, double add, double *terms)
{
    const ptrdiff_t i = p->dof[r];
    const ptrdiff_t j = p->dof[c];
    if (i >= 0 && j >= 0) {
        terms[i + (j * nq)] += add;
        terms[j + (i * nq)] += r == c ? 0.0 : add;
    }
}

/* terms += size |h|, and `turns` between rotations. */
static void add_piece_terms(ptrdiff_t nq, double size, double turns, const mt_piece *p,
                            double *terms)
{
    for (int c = 0; c < MT_LOCAL && size > 0.0; c++) {
        for (int r = c; r < MT_LOCAL; r++) {
            const double h = p->h[mt_relative_pair(r, c)];
            if (h != 0.0) {
                add_entry(nq, p, r, c, size * fabs(h), terms);
            }
        }
    }
    for (int c = 3; c < MT_LOCAL && turns > 0.0; c += c == 5 ? 4 : 1) {
        for (int r = c; r < MT_LOCAL; r += r == 5 ? 4 : 1) {
            add_entry(nq, p, r, c, turns, terms);
        }
    }
}

void mt_piece_fill(const mt_data *d, const mt_measure_def *def, const mt_pose *poses,
                   const mt_relative_jet *jet, const double size_force[2], double *terms,
                   mt_piece *out)
{
    double extent = mt_piece_is_angle(def) ? 0.0 : extent_of(poses, def->body);
    *out = (mt_piece){.size = size_force[0],
                      .equation = -1,
                      .factor = 1.0,
                      .def = def,
                      .spring = -1,
                      .load = -1,
                      .roundness = mt_piece_roundness(d, def, poses)};
    if (is_chord(def)) {
        extent /= creal(mt_data_scalar(d, def->beam[MT_BEAM_LENGTH], 1.0));
    }
    for (int k = 0; k < MT_LOCAL; k++) {
        out->dof[k] = mt_local_dof(d->sys, def->body, k);
        out->g[k] = mt_relative_sign(k) * creal(jet->g[mt_relative_of(k)]);
    }
    out->filled = mt_relative_filled(jet->second, jet->span);
    for (int ii = 0; ii < out->filled->n; ii++) {
        const int row = mt_relative_row(out->filled->at[ii]);
        for (int kk = 0; kk <= ii; kk++) {
            const int at = row + out->filled->at[kk];
            out->h[at] = creal(jet->h[at]);
        }
    }
    add_piece_terms(d->sys->nq, size_force[0], size_force[1] * extent, out, terms);
}

static bool is_pose(const mt_pose *a, const mt_pose *b)
{
    bool same = true;
    for (int k = 0; k < 3; k++) {
        same = same && a->x[k] == b->x[k];
    }
    for (int k = 0; k < 9; k++) {
        same = same && a->r[k] == b->r[k];
    }
    return same;
}

bool mt_piece_is_still(const mt_measure_def *def, const mt_pose *poses, const mt_pose *rest)
{
    bool still = true;
    for (int side = 0; side < 2; side++) {
        const int b = def->body[side];
        still = still && (b == MT_GROUND || is_pose(&poses[b], &rest[b]));
    }
    return still;
}
