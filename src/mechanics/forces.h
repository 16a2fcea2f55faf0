/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_FORCES_H
#define MECHANICS_FORCES_H

#include "mechanics/data.h"

/* A force at work: c times the gradient of a measure of these bodies is its part of that of the
 * potential, and c times the Hessian its part of the geometric stiffness; noise: what rounding
 * of positions may be of c. False: no more. */
typedef bool (*mt_force_visit)(void *context, const int body[2], double c, double noise,
                               const mt_jet *jet);

/* Every load, and every spring that is not as long as it would be; rest values loaded. Returns
 * whether all were visited. O(loads + springs). */
bool mt_forces_each(const mt_data *d, const mt_pose *pose, mt_force_visit visit, void *context);
/* Every load and spring at a place where the mechanism has settled, likewise: from there, which
 * is rounded, by the motion left[nq] to where the forces balance, which is known to within
 * open[nq]. */
bool mt_forces_at(const mt_data *d, const mt_placement *at, const double *left,
                  const double *open, mt_force_visit visit, void *context);

#endif
