/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_FORCES_H
#define MECHANICS_FORCES_H

#include "mechanics/data.h"

/* Visit one force: c times the gradient of a measure of these bodies is its contribution to the
 * gradient of the potential, c times the Hessian that to the geometric stiffness; noise:
 * rounding error of c. False ends the visits. */
typedef bool (*mt_force_visit)(void *context, const int body[2], double c, double noise,
                               const mt_jet *jet);

/* Visit every load, and every spring with a free length or preload, at the given poses; needs
 * the rest values. True where all were visited. O(loads + springs). */
bool mt_forces_each(const mt_data *d, const mt_pose *pose, mt_force_visit visit, void *context);
/* Visit every load and spring at an equilibrium: the forces are those after the motion left[nq]
 * from the rounded position to the balance, known to within open[nq]. */
bool mt_forces_at(const mt_data *d, const mt_placement *at, const double *left,
                  const double *open, mt_force_visit visit, void *context);

#endif
