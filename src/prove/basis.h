/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROVE_BASIS_H
#define PROVE_BASIS_H

#include "prove/enclosure.h"

/* Compute the fixed matrices and parts in coordinates in which M at the low end of the bounds
 * is the identity. *ok is false, with the reason, where massless freedoms or an instability
 * prevent it. */
mt_status mt_enclosure_reduce(mt_enclosure *e, const mt_linear *lin, bool *ok, char *reason,
                              mt_err *err);

#endif
