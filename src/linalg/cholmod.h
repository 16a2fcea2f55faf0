/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_CHOLMOD_H
#define LINALG_CHOLMOD_H

#include <suitesparse/cholmod.h>

#include "base/base.h"

/* What is used of CHOLMOD; include/suitesparse/cholmod_core.h has the contracts. */
typedef struct mt_cholmod {
    int (*start)(cholmod_common *c);
    cholmod_factor *(*analyze)(cholmod_sparse *a, cholmod_common *c);
    cholmod_factor *(*analyze_p)(cholmod_sparse *a, int *perm, int *set, size_t size,
                                 cholmod_common *c);
    int (*free_factor)(cholmod_factor **l, cholmod_common *c);
    int (*finish)(cholmod_common *c);
} mt_cholmod;

/**
 * The library, loaded when it is first asked for: with METIS and what else it needs it takes a
 * fifth of the time in which a program starts, and only large mechanisms ask. It stays loaded.
 * Fails: MT_E_MEMORY; MT_E_INTERNAL where it is not installed.
 */
mt_status mt_cholmod_load(mt_cholmod *cholmod, mt_err *err);

#endif
