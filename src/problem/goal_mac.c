/* SPDX-License-Identifier: GPL-3.0-or-later */
/* "mac": q = MAC of the mode's shape at the sensors with that of a reference. */
#include "problem/goal.h"

static mt_status evaluate_mac(mt_workspace *w, const mt_requirement *d, int pos, double *q,
                              double *slope, mt_err *err)
{
    const int ns = d->shape.ns;
    double norm = 0.0;
    MT_TRY(mt_goal_sense(w, d, pos, slope != NULL, &norm, err));
    mt_mac_matrix(ns, 1, w->shape, 1, d->shape.shape, q);
    for (int k = 0; k < w->p->n && slope != NULL; k++) {
        const double *const ds = w->dshape + ((ptrdiff_t)k * ns);
        slope[k] =
            mt_workspace_dx_dt(w, k) * mt_mac_derivative(ns, w->shape, ds, d->shape.shape);
    }
    return MT_OK;
}

static const char *mac_subject(const mt_requirement *d, const char *what, mt_arena *mem)
{
    return mt_arena_printf(mem, "%s: MAC with mode %d of \"%s\"", what, d->shape.mode,
                           d->shape.reference);
}

const mt_goal_ops mt_goal_mac = {.quantity = MT_QUANTITY_OTHER,
                                 .needs_vectors = true,
                                 .compile = mt_goal_compile_shape,
                                 .value = evaluate_mac,
                                 .subject = mac_subject,
                                 .number = "MAC",
                                 .equals = "at"};
