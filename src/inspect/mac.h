/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef INSPECT_MAC_H
#define INSPECT_MAC_H

#include "inspect/loaded_model.h"
#include "io/write_json.h"

/* Two sets of modes, paired and correlated at the sensors of both models: what `mac` tells, as
 * records. */

/* A mode of A and the mode of B that it is paired with. */
typedef struct mt_mac_pair_row {
    int a;
    int b;
    double mac;
    double a_hz;
    double b_hz;
    double difference_percent;
} mt_mac_pair_row;

extern const mt_record mt_mac_pair_record;

/* A row of the matrix: a mode of A with each of B. */
typedef struct mt_mac_matrix_row {
    double *mac;
    int n;
} mt_mac_matrix_row;

/* Repeated modes of A against the modes of B that they are paired with. */
typedef struct mt_mac_subspace_row {
    int first_a;
    int modes;
    double *cos2;
    int n;
} mt_mac_subspace_row;

/* The answer. */
typedef struct mt_mac_row {
    mt_mac_pair_row *pairs;
    int n_pairs;
    mt_mac_matrix_row *matrix;
    int n_matrix;
    mt_mac_subspace_row *subspaces;
    int n_subspaces;
    double *vibration_modes;
    int n_sides;
    const char **channels;
    int n_channels;
    const char **notes;
    int n_notes;
} mt_mac_row;

extern const mt_record mt_mac_record;

/* One of the two sides. */
typedef struct mt_mac_side {
    const char *letter;
    mt_loaded_model s; /* the caller's, of one configuration */
    mt_analysis *a;
    int *channels; /* [ns] the common ones, in this system */
    int n;         /* vibration modes compared */
    int *position; /* [n] */
    double *shape; /* ns x n */
} mt_mac_side;

typedef struct mt_mac_view {
    mt_mac_side a;
    mt_mac_side b;
    int ns;
    double *scale; /* [ns] of displacements and angles together; NULL: of one kind */
    double *mac;   /* a.n x b.n */
    int *pair;     /* [a.n] */
    mt_arena mem;
    mt_mac_row row; /* the answer */
} mt_mac_view;

/* Compare `count` vibration modes of each (0: as many as there are common channels). Before:
 * v->a.s and v->b.s, the rest zeroed; mt_mac_view_free in any case, which leaves these two.
 * Fails: MT_E_INPUT (no sensor and direction in common), as mt_analysis_new, MT_E_MEMORY. */
mt_status mt_mac_view_take(mt_mac_view *v, int count, mt_err *err);
void mt_mac_view_free(mt_mac_view *v);
void mt_mac_put(const mt_mac_view *v, mt_json_writer *w);

#endif
