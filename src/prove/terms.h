/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROVE_TERMS_H
#define PROVE_TERMS_H

#include "prove/enclosure.h"

/* List the coefficients (without their nodes) and pieces of all varying terms. */
mt_status mt_enclosure_list_terms(mt_enclosure *e, const mt_linear *lin, mt_err *err);

#endif
