/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODAL_BALANCE_H
#define MODAL_BALANCE_H

#include "modal/sparse.h"

/**
 * Constraint forces that balance a load: mu[rows of A] with A^T mu = f[n], of least norm where
 * there are many, least-squares where there are none. Uses n, a, unit and check of p.
 * @param[out] open   [rows of A] about the rounding error of each
 * @param[out] found  false: double precision is not enough
 * Fails: as mt_factor_make, MT_E_MEMORY, as `check`.
 */
mt_status mt_modal_balance(const mt_sparse_problem *p, const double *f, double *mu,
                           double *open, bool *found, mt_err *err);

#endif
