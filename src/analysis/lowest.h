/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANALYSIS_LOWEST_H
#define ANALYSIS_LOWEST_H

#include "mechanics/tree.h"
#include "modal/lowest.h"

/*
 * The lowest modes of one configuration of a mechanism that is a tree (mechanics/tree.h), of
 * any size: O(bodies) in time and memory. One worker.
 */
typedef struct mt_lowest {
    mt_arena mem;
    mt_system *sys;        /* owned */
    mt_tree *tree;         /* NULL: the configuration is no such tree */
    char why[MT_TREE_WHY]; /* then the reason */
    mt_lowest_modes found;
} mt_lowest;

/* From so many bodies on this is the way to go where only the lowest modes are wanted: all
 * modes of 200 bodies take a second. */
enum { MT_LOWEST_BODIES = 100 };

/* About how many bodies a configuration has. */
double mt_lowest_bodies(const mt_model *model, int configuration);

/**
 * @param[in]  count  vibration modes wanted, at least 1
 * @param[out] out    owned by the caller (mt_lowest_delete); NULL on failure
 * Inputs as of mt_analysis_new. Fails: as mt_system_new, mt_tree_new and mt_modal_lowest, the
 * text naming the configuration.
 */
mt_status mt_lowest_new(const mt_model *model, int configuration, int n_inputs,
                        const int *inputs, const double *at, int count, mt_lowest **out,
                        mt_err *err);
/* Accepts NULL. */
void mt_lowest_delete(mt_lowest *l);

#endif
