/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_DIRECTIONS_H
#define MECHANICS_DIRECTIONS_H

#include "mechanics/linear.h"

/*
 * How a mechanism lies at the position of the last update, as numbers that turn when it does:
 * of each distance between two points (axial springs, dampers, bars) its unit vector and the
 * logarithm of its length, of each body the axes of its frame, of each angle of a joint the
 * turns that it has made. K, C and M follow from these, and from nothing else that moves but
 * the places of points: a spring whose ends pass each other closely turns by half a turn while
 * its stiffness comes and goes.
 */
int mt_directions_count(const mt_system *sys);
/* out[mt_directions_count]. */
void mt_directions_read(const mt_linear *lin, double *out);
/* The most that any of them differs by between two positions, about an angle [rad]. */
double mt_directions_turn(const mt_system *sys, const double *a, const double *b);

#endif
