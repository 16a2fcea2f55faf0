/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_INFO_H
#define MECHANICS_INFO_H

#include "mechanics/linear.h"

/* Mass and mobility of a configuration at the position where it is linearised. */
typedef struct mt_info {
    int states;         /* coordinates of all bodies */
    int equations;      /* of joints, links' hinges and the locked drive */
    int freedoms;       /* states less independent equations (mobility), less free spins */
    int free_spins;     /* spins without inertia and resistance (free_spin.h) */
    int redundant;      /* equations less independent ones; names: mt_linear_redundant_set */
    double mass_kg;     /* everything with mass, fixed or moving */
    double centre_m[3]; /* of mass, global; NaN where there is no mass */
    /* about the centre, global axes: xx yy zz xy xz yz as in the tensor (xy = -sum m x y); in
     * two dimensions zz alone, the others 0 */
    double inertia_kg_m2[6];
    double residual; /* of the equilibrium, relative to the forces at work */
    double gap_m;    /* largest violation of a joint */
    int dampers;
    double least_loss; /* loss factors of springs and links that have one; NaN: none */
    double most_loss;
} mt_info;

/* After mt_linear_update. Exact for consistent bars and beams as well. Fails: MT_E_INTERNAL
 * before an update. */
mt_status mt_info_fill(const mt_linear *lin, mt_info *out, mt_err *err);

#endif
