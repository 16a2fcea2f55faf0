/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROVE_COEFFICIENTS_H
#define PROVE_COEFFICIENTS_H

#include "prove/enclosure.h"

/* Collect the coefficients of all varying terms, each node once, with a program of their own
 * and their bounds over the enclosure's bounds. *ok is false, with the reason, where one may be
 * negative there. */
mt_status mt_enclosure_collect(mt_enclosure *e, const mt_linear *lin, bool *ok, char *reason,
                               mt_err *err);
/* Bounds of all coefficients over the box into value[2]. */
void mt_enclosure_bounds(mt_enclosure *e, const double *lo, const double *hi);

#endif
