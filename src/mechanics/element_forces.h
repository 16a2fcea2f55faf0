/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_ELEMENT_FORCES_H
#define MECHANICS_ELEMENT_FORCES_H

#include "mechanics/data.h"

/* The forces at a position, one by one, and the rounding errors of their measures. */

/* One force and the curvature of its work: gradient and Hessian of its measure over the
 * freedoms dof (-1: none). */
typedef struct mt_piece {
    int dof[MT_LOCAL];
    double g[MT_LOCAL];
    double h[MT_RELATIVE_PAIRS]; /* of relative motions, as in mt_relative_jet */
    const mt_relative_list *filled;
    double force; /* Kg is the sum of force h */
    double size;  /* magnitude of the terms of the force, for its rounding */
    /* of a spring: derivative of its force by the measure of the piece at offset `partner` (0:
     * its own; half of the spring's stiffness where it couples two); otherwise 0 */
    double stiffness;
    int partner;
    bool trimmed;              /* the force is an unknown, whatever its stiffness */
    int equation;              /* equation whose multiplier the force is; -1: none */
    double factor;             /* coefficient of the measure in it */
    const mt_measure_def *def; /* the measure; NULL: of the load of a point */
    int spring;                /* whose force it is, with its measure number `side`; -1: none */
    int side;
    int load;       /* -1: none */
    double stretch; /* of a spring: the measure less its rest value */
    /* rounding error of the measure less its rest value, from rounded positions; both are
     * rounded alike where nothing has moved */
    double roundness;
} mt_piece;

/* Column of q for local freedom k (0..11) of a pair of bodies; -1: none. */
static inline int mt_local_dof(const mt_system *sys, const int body[2], int k)
{
    const int b = body[k / 6];
    return b == MT_GROUND ? -1 : sys->bodies[b].dof[k % 6];
}
/* Change of a measure with this jet along a motion of the states. */
double mt_jet_along(const mt_system *sys, const int body[2], const mt_jet *jet,
                    const double *motion);
/* True for an angle or a cosine, false for a length. */
bool mt_piece_is_angle(const mt_measure_def *def);
/* Rounding error of a measure: positions are known to eps of the coordinates that they are the
 * difference of, angles to eps, the slope of a beam element's chord to eps of the coordinates
 * over its length. */
double mt_piece_roundness(const mt_data *d, const mt_measure_def *def, const mt_pose *poses);
/* True where the bodies of a measure have the same poses as in `rest`, to the bit. */
bool mt_piece_is_still(const mt_measure_def *def, const mt_pose *poses, const mt_pose *rest);
/* What a motion of the states is to a piece, 0 where it has none. */
static inline void mt_piece_motion(const mt_piece *p, const double *way, double local[MT_LOCAL])
{
    for (int k = 0; k < MT_LOCAL; k++) {
        local[k] = p->dof[k] >= 0 ? way[p->dof[k]] : 0.0;
    }
}
/* The same as a relative motion. */
static inline void mt_piece_relative(const mt_piece *p, const double *way,
                                     double relative[MT_RELATIVE])
{
    double local[MT_LOCAL];
    mt_piece_motion(p, way, local);
    for (int k = 0; k < 3; k++) {
        relative[k] = local[6 + k] - local[k];
        relative[3 + k] = local[3 + k];
        relative[6 + k] = local[9 + k];
    }
}
/* out[MT_RELATIVE] = H x of such motions; h: packed, of which `filled` is not 0. */
static inline void mt_piece_product(const mt_relative_list *filled, const double *h,
                                    const double *x, double *out)
{
    for (int i = 0; i < MT_RELATIVE; i++) {
        out[i] = 0.0;
    }
    for (int ii = 0; ii < filled->n; ii++) {
        const int i = filled->at[ii];
        const double *const row = h + mt_relative_row(i);
        double sum = row[i] * x[i];
        for (int kk = 0; kk < ii; kk++) {
            const int k = filled->at[kk];
            sum += row[k] * x[k];
            out[k] += row[k] * x[i];
        }
        out[i] += sum;
    }
}
/* Entry of H for two local freedoms. */
static inline double mt_piece_entry(const mt_piece *p, int r, int c)
{
    return mt_relative_sign(r) * mt_relative_sign(c) * p->h[mt_relative_pair(r, c)];
}
/* g . way. */
double mt_piece_work(const mt_piece *p, const double *way);
/* out[MT_LOCAL] = H phi, of which what belongs to no state is for nobody; returns
 * phi^T H phi. */
double mt_piece_bend(const mt_piece *p, const double *phi, double *out);
/* to[nq] += c local. */
void mt_piece_add(const mt_piece *p, double c, const double *local, double *to);
/* Fill a piece with this jet; spring and equation are set later. terms (nq x nq) += size
 * |jet.h|, and force times the coordinates' size: lengths that cancel in an entry between
 * rotations are differences of coordinates. */
void mt_piece_fill(const mt_data *d, const mt_measure_def *def, const mt_pose *poses,
                   const mt_relative_jet *jet, const double size_force[2], double *terms,
                   mt_piece *out);

#endif
