/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODAL_BALANCE_H
#define MODAL_BALANCE_H

#include "modal/sparse.h"

/**
 * The forces with which constraints hold a load: mu[rows of A] with A^T mu = f[n], least in
 * themselves where there are many, f - A^T mu least where there are none. Of p: n, a, unit and
 * check.
 * @param[out] open   [rows of A] about what rounding leaves open of each
 * @param[out] found  false: sixteen digits do not hold them
 * Fails: as mt_factor_make, MT_E_MEMORY, what `check` fails with.
 */
mt_status mt_modal_balance(const mt_sparse_problem *p, const double *f, double *mu,
                           double *open, bool *found, mt_err *err);

#endif
