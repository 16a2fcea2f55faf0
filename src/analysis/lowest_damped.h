/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANALYSIS_LOWEST_DAMPED_H
#define ANALYSIS_LOWEST_DAMPED_H

#include "analysis/lowest.h"
#include "modal/damped.h"

enum { MT_LOWEST_DAMPED_WHY = 200 };

typedef struct mt_lowest_damped {
    /* rigid-body modes, then roots by ascending |s|; shapes NULL. A real root is listed up to
     * the last oscillating one. */
    mt_damped_modes modes;
    double *error; /* [modes.count] bound of |ds|/|s|, of first order in the residual */
    int shapes;    /* coordinates besides the undamped modes */
    double limit;  /* [rad/s] no root above this is listed */
    bool enough;   /* `count` oscillating roots lie below `limit`, or there are no more */
} mt_lowest_damped;

/**
 * Damped modes of a large mechanism (modal/damped.h): the `count` lowest oscillating ones and
 * the real roots between them, into which damping turns its lowest undamped modes. With C and H
 * as sums over dampers and springs, at O(bodies) and two solutions with the factor of K for
 * each shape that damping adds. After mt_lowest_new with shapes, for more modes than `count`.
 * Results in mem.
 * @param[out] why  the reason where *is is false: no method applies, or the residuals stay
 *                  above ten digits of a root
 * Fails: as mt_lowest_open_forced, mt_modal_damped, MT_E_INTERRUPTED, MT_E_MEMORY.
 */
mt_status mt_lowest_damped_modes(mt_lowest *l, int count, mt_arena *mem, mt_lowest_damped *out,
                                 bool *is, char why[MT_LOWEST_DAMPED_WHY], mt_err *err);

#endif
