/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_CHOLMOD_H
#define LINALG_CHOLMOD_H

#include <suitesparse/cholmod.h>

#include "base/base.h"

/* The functions of CHOLMOD in use; include/suitesparse/cholmod_core.h has the contracts. */
typedef struct mt_cholmod {
    int (*start)(cholmod_common *c);
    cholmod_factor *(*analyze)(cholmod_sparse *a, cholmod_common *c);
    cholmod_factor *(*analyze_p)(cholmod_sparse *a, int *perm, int *set, size_t size,
                                 cholmod_common *c);
    int (*free_factor)(cholmod_factor **l, cholmod_common *c);
    int (*finish)(cholmod_common *c);
} mt_cholmod;

/**
 * Load the library at the first call: with METIS and its other dependencies that takes a fifth
 * of the start-up time of the program, and only large mechanisms need it. It stays loaded.
 * Fails: MT_E_MEMORY; MT_E_INTERNAL where it is not installed.
 */
mt_status mt_cholmod_load(mt_cholmod *cholmod, mt_err *err);

#endif
