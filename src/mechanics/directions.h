/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_DIRECTIONS_H
#define MECHANICS_DIRECTIONS_H

#include "mechanics/linear.h"

/*
 * Directions of a mechanism at the position of the last update: for each distance between two
 * points (axial springs, dampers, bars) its unit vector and the logarithm of its length, for
 * each body the axes of its frame, for each joint angle its whole turns. Apart from positions
 * of points, K, C and M depend on these alone: a spring whose ends pass each other closely
 * turns by half a turn while its stiffness comes and goes.
 */
int mt_directions_count(const mt_system *sys);
/* out[mt_directions_count]. */
void mt_directions_read(const mt_linear *lin, double *out);
/* Largest difference of any of them between two positions, as an angle [rad]. */
double mt_directions_turn(const mt_system *sys, const double *a, const double *b);

#endif
