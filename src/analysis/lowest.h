/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANALYSIS_LOWEST_H
#define ANALYSIS_LOWEST_H

#include "modal/lowest.h"
#include "tree/tree.h"

/*
 * The lowest modes of one configuration of a mechanism that is a tree (tree/tree.h), of
 * any size: O(bodies) in time and memory. One worker.
 */
typedef struct mt_lowest {
    mt_arena mem;
    mt_system *sys;        /* owned */
    mt_tree *tree;         /* NULL: the configuration is no such tree */
    char why[MT_TREE_WHY]; /* then the reason */
    mt_lowest_modes found;
    double *at;                            /* [inputs of sys] */
    struct mt_lowest_operation *operation; /* what Lanczos' method is given */
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
/* Shapes of the first n positions over all states (nq of the system), of unit mass, sign by
 * mt_modal_fix_sign: phi nq x n, zeroed. Fails: MT_E_INTERRUPTED, MT_E_MEMORY. */
mt_status mt_lowest_shapes(mt_lowest *l, int n, double *phi, mt_err *err);
/* The same at its channels: value n_channels x n. */
mt_status mt_lowest_sense(mt_lowest *l, int n, double *value, mt_err *err);
/**
 * How far every input moves the frequencies of the first n vibration modes.
 * @param[out] hz_per_unit  n x n_inputs; of repeated modes as mt_analysis_sensitivity gives
 * @param[out] why          "", or why there are none, as mt_tree_slopes says
 * Fails: as mt_tree_slopes, MT_E_MEMORY.
 */
mt_status mt_lowest_sensitivity(mt_lowest *l, int n, double *hz_per_unit, char why[MT_TREE_WHY],
                                mt_err *err);
/* Accepts NULL. */
void mt_lowest_delete(mt_lowest *l);

#endif
