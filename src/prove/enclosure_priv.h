/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROVE_ENCLOSURE_PRIV_H
#define PROVE_ENCLOSURE_PRIV_H

#include "prove/enclosure.h"

/* enclosure_check.c: is the analysis one that can be enclosed? False with the reason. */
bool mt_enclosure_admits(const mt_analysis *a, char *reason);

/* enclosure_program.c: coefficients of all terms that vary, each node once, with a program of
 * their own, and what is known of them over the bounds. *ok is false with the reason where one
 * may be negative there. */
mt_status mt_enclosure_collect(mt_enclosure *e, const mt_linear *lin, bool *ok, char *reason,
                               mt_err *err);
/* enclosure_terms.c: coefficients (without their nodes) and pieces of all terms that vary. */
mt_status mt_enclosure_list_terms(mt_enclosure *e, const mt_linear *lin, mt_err *err);
/* Bounds of all coefficients over the box into value[2]. */
void mt_enclosure_bounds(mt_enclosure *e, const double *lo, const double *hi);

/* enclosure_basis.c: fixed matrices and parts in coordinates in which M at the low end of the
 * bounds is the identity. *ok is false with the reason where massless freedoms or an
 * instability are in the way. */
mt_status mt_enclosure_reduce(mt_enclosure *e, const mt_linear *lin, bool *ok, char *reason,
                              mt_err *err);

#endif
