/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TESTS_SOLVE_PAIR_H
#define TESTS_SOLVE_PAIR_H

#include "modal/mass.h"
#include "modal/solve.h"

/* Modes of K and M as matrices: the mass is factored here. */
static inline mt_status solve_pair(int n, const double *k, const double *m,
                                   const mt_stiffness_factor *factor,
                                   const mt_modal_options *opt, mt_arena *mem, mt_modes *out,
                                   mt_err *err)
{
    mt_mass_factor mass;
    *out = (mt_modes){.n = n};
    MT_TRY(mt_modal_factor_mass(n, m, mem, &mass, err));
    return mt_modal_solve(k, &mass, factor, opt, mem, out, err);
}

#endif
