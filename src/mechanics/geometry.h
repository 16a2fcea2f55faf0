/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_GEOMETRY_H
#define MECHANICS_GEOMETRY_H

#include "mechanics/system.h"

/*
 * *same: two configurations of one model are the same mechanism except for the position of one
 * driven joint, *joint (of the system's joints; -1: all positions are the same). Bodies,
 * joints, springs, inertias and loads are the same, number by number as expressions of the same
 * inputs; both drive the same joints and hold them the same way, or one of them has no drive
 * and no loads, and a trimmed spring holds the one driven joint of the other: it then is that
 * mechanism in its reference position. False for two configurations without a drive. Fails:
 * MT_E_MEMORY.
 */
mt_status mt_system_same_drive(const mt_system *a, const mt_system *b, bool *same, int *joint,
                               mt_err *err);

/*
 * *same: two configurations of one model have the same geometry at every design, and rows of K,
 * C, M and the sensors in the same positions. As mt_system_same_drive, but coefficients of
 * springs, dampers and inertias, preload and free lengths may differ; without drive and loads.
 * Fails: MT_E_MEMORY.
 */
mt_status mt_system_same_shape(const mt_system *a, const mt_system *b, bool *same, mt_err *err);

#endif
