/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_CONSTRAINT_H
#define MECHANICS_CONSTRAINT_H

#include "mechanics/data.h"

/* Values and curvature of the equations of joints, without anything else. */

/* Part to subtract from `value` of constraint i: whole turns of an angle, so that it is nearest
 * to its target; of a gear's two angles the one without a ratio (term 0) may turn on, the other
 * stays within half a turn. */
double mt_constraint_turns(const mt_data *d, int i, double value);
/* c[m]: values of the constraints. */
void mt_constraint_values(const mt_data *d, const mt_placement *at, int m, double *c);
/* Term t of constraint i along the motion phi[nq]: b[12] = c'' phi over the local freedoms of
 * the term's bodies. Returns the Frobenius norm of c'' with rows and columns scaled by
 * scale[nq]. */
double mt_constraint_curve(const mt_data *d, const mt_pose *poses, int i, int t,
                           const double *phi, const double *scale, double b[MT_LOCAL]);

#endif
