/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODAL_DERIVATIVE_H
#define MODAL_DERIVATIVE_H

#include "base/arena.h"
#include "modal/modes.h"

/*
 * Derivatives. For a parameter p the caller gives products with the chosen modes: dky = (dK/dp)
 * y_i, dmy = (dM/dp) y_i, one column of n entries per mode. dmy may be NULL everywhere: M does
 * not depend on p.
 */
/* For a cluster: the symmetric r x r matrix Y^T (dK - lambda dM) Y (lambda: mean of the
 * cluster), whose eigenvalues are the directional derivatives of the cluster. first: its first
 * position, r its size; dky, dmy n x r. Fails: MT_E_MEMORY. */
mt_status mt_modal_dcluster(const mt_modes *modes, int first, int r, const double *dky,
                            const double *dmy, double *out, mt_arena *scratch, mt_err *err);

/* np parameters at one mode: column p is the product of dK/dp_p (dM/dp_p) with that mode. */
typedef struct mt_directions {
    int np;
    const double *dky; /* n x np */
    const double *dmy; /* n x np or NULL */
} mt_directions;

/*
 * Derivatives of the mass-normalised vector of a simple mode with constant sign: dy n x np,
 * dlambda np (may be NULL).
 *
 * Expansion in all other modes (Fox and Kapoor 1968; exact with all modes): two small products
 * per mode, the fastest method when a solve has given all vectors. Fails: MT_E_SINGULAR at a
 * mode of a cluster (dy is NaN then), MT_E_USAGE without vectors or with condensed directions.
 */
mt_status mt_modal_dvector_by_modes(const mt_modes *modes, int i, const mt_directions *dir,
                                    double *dy, double *dlambda, mt_arena *scratch,
                                    mt_err *err);

#endif
