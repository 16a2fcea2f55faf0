/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANALYSIS_LOWEST_H
#define ANALYSIS_LOWEST_H

#include "mechanics/absolute.h"
#include "modal/sparse.h"
#include "tree/tree.h"

/* Which way they were found; NONE: there is no way. */
typedef enum mt_lowest_method {
    MT_LOWEST_NONE,
    MT_LOWEST_TREE,
    MT_LOWEST_SPARSE
} mt_lowest_method;
enum { MT_LOWEST_WHY = MT_TREE_WHY + MT_ABSOLUTE_WHY + 100 };

typedef struct mt_lowest_want {
    int count;   /* vibration modes, at least 1 */
    bool shapes; /* or slopes of them */
    bool tree;   /* only as a tree */
    bool drawn;  /* only where it rests as drawn: slopes and scenes have no others */
} mt_lowest_want;

/*
 * The lowest modes of one configuration of a mechanism of any size: of a tree (tree/tree.h) in
 * coordinates of its joints, O(bodies) in time and memory; else in those of its bodies
 * (modal/sparse.h), as the fill of a factor costs. One worker.
 */
typedef struct mt_lowest {
    mt_arena mem;
    mt_system *sys; /* owned */
    mt_lowest_method way;
    mt_tree *tree;             /* NULL: the configuration is no such tree */
    mt_absolute bodies;        /* of the sparse way */
    mt_sparse_problem problem; /* its, without `check` */
    mt_sparse_solver *solver;  /* of forces on it: lowest_forced.h */
    double *work;              /* [coordinates] its */
    mt_state position;         /* where loads bring it; sys NULL: as drawn */
    double *mu;                /* of that, forces of its constraints: mt_modal_sparse */
    char why[MT_LOWEST_WHY];   /* why there is no way */
    double mass_kg;
    int equations; /* of joints, of which some may follow from others; 0: of a tree */
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
 * @param[out] out  owned by the caller (mt_lowest_delete); NULL on failure
 * Inputs as of mt_analysis_new. Fails: as mt_system_new, mt_tree_new, mt_absolute_new and
 * mt_modal_sparse (but MT_E_NO_CONVERGENCE of that is no way), the text naming the
 * configuration.
 */
mt_status mt_lowest_new(const mt_model *model, int configuration, int n_inputs,
                        const int *inputs, const double *at, mt_lowest_want want,
                        mt_lowest **out, mt_err *err);
/* Where loads have brought it; NULL: it is told as drawn. */
const mt_state *mt_lowest_settled(const mt_lowest *l);
/* Where shapes were wanted, as what follows: those of the first n positions over all states (nq
 * of the system), of unit mass, sign by mt_modal_fix_sign: phi nq x n, zeroed. Fails:
 * MT_E_INTERRUPTED, MT_E_MEMORY. */
mt_status mt_lowest_shapes(mt_lowest *l, int n, double *phi, mt_err *err);
/* The same at its channels: value n_channels x n. */
mt_status mt_lowest_sense(mt_lowest *l, int n, double *value, mt_err *err);
/**
 * How far every input moves the frequencies of the first n vibration modes.
 * @param[out] hz_per_unit  n x n_inputs; of repeated modes as mt_analysis_sensitivity gives
 * @param[out] why          "", or why there are none, as mt_tree_slopes and
 *   mt_absolute_slopes say
 * Fails: as these.
 */
mt_status mt_lowest_sensitivity(mt_lowest *l, int n, double *hz_per_unit, char why[MT_TREE_WHY],
                                mt_err *err);
/* Accepts NULL. */
void mt_lowest_delete(mt_lowest *l);

#endif
