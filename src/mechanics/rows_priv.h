/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_ROWS_PRIV_H
#define MECHANICS_ROWS_PRIV_H

#include "mechanics/rows.h"

/* Shared by the files rows*.c. */
enum { MT_BAR_ROWS = 2, MT_DEFLECTION_ROWS = 4, MT_ROTARY_ROWS = 3 };

/* row += scale * displacement along unit vector e of the point s from the centre, in the local
 * freedoms of side 0 or 1; the same for the rotation about e. */
void mt_row_add_point(mt_cx *row, int side, const mt_cx *s, const mt_cx *e, mt_cx scale);
void mt_row_add_turn(mt_cx *row, int side, const mt_cx *e, mt_cx scale);

/* A beam element at its present position: frame of its chord, distance of its nodes, 1/(1 +
 * Phi) for bending about e2, e3. */
typedef struct mt_beam_geometry {
    mt_cx e[3][3];
    mt_cx length;
    mt_cx shape[2];
} mt_beam_geometry;

/* shape is set to 1. */
void mt_beam_frame(const mt_data *d, const int body[2], const int dir[3], const mt_pose *poses,
                   mt_beam_geometry *out);
/* Consistent mass of bending about e2 (k = 0) or e3 (k = 1), of unit mass:
 * rows[MT_DEFLECTION_ROWS]. */
void mt_beam_deflection_rows(const mt_beam_geometry *g, int k, mt_cx *rows);
/* The same for the rotation of the sections in bending, of unit moment of inertia:
 * rows[MT_ROTARY_ROWS]. */
void mt_beam_rotary_rows(const mt_beam_geometry *g, int k, mt_cx *rows);
/* The same for displacement along, or rotation about, e1: rows[MT_BAR_ROWS]. */
void mt_beam_bar_rows(const mt_beam_geometry *g, bool turn, mt_cx *rows);
/* row += weight * deflection, or rotation of the section (theta3; for k = 0 -theta2), at the
 * fraction x of the element. */
void mt_beam_deflection_at(const mt_beam_geometry *g, int k, mt_cx x, mt_cx weight, mt_cx *row);
void mt_beam_slope_at(const mt_beam_geometry *g, int k, mt_cx x, mt_cx weight, mt_cx *row);

#endif
