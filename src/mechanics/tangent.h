/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_TANGENT_H
#define MECHANICS_TANGENT_H

#include "mechanics/linear_priv.h"

/* Derivatives by one input beyond the coefficients: geometry, position, constraint forces. */
struct mt_linear_tangent {
    bool moves;                  /* something below is not 0 */
    mt_rows rows[MT_TERM_KINDS]; /* derivative of lin->full */
    double *a;                   /* m x nq, derivative of the constraint Jacobian */
    /* [m] derivative of the constraints along the motion of the position: 0 where it stays
     * closed */
    double *c;
    double terms;  /* largest sum of |terms| of an entry of c, in rows of unit length */
    double motion; /* length of the motion that the input causes, in scaled coordinates */
    double *moved; /* [nq] that motion; NULL: no tangent */
    double *kg;    /* nq x nq; NULL without loads */
    mt_pose *pose; /* [bodies] with their derivatives; NULL without loads */
    mt_cx *lambda; /* [all constraints] with their derivatives; NULL without loads */
};

/* Fill lin->tangent for the inputs in the set `moves`; the others have no effect here. Those
 * that act through forces alone are left due, where there are several. */
mt_status mt_tangent_update(mt_linear *lin, const uint64_t *moves, mt_err *err);
/* Fill those that are due. */
mt_status mt_tangent_complete(mt_linear *lin, mt_err *err);

#endif
