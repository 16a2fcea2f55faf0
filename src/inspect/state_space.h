/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef INSPECT_STATE_SPACE_H
#define INSPECT_STATE_SPACE_H

#include "response/response.h"
#include "result/record.h"

/* A mechanism between ports as x' = A x + B u, y = C x + D u: what `response --state-space`
 * writes, as a record. */

/* A row of a matrix. */
typedef struct mt_matrix_row {
    double *value;
    int n;
    int step; /* from one to the next */
} mt_matrix_row;

typedef struct mt_state_space_row {
    int modes;
    int residual_shapes;
    const char **states;
    int n_states;
    mt_port *inputs;
    int n_inputs;
    mt_port *outputs;
    int n_outputs;
    mt_matrix_row *a; /* [n_states] */
    mt_matrix_row *b;
    mt_matrix_row *c; /* [n_outputs] */
    mt_matrix_row *d;
    bool viscous_for_loss_factors;
    double from_hz; /* where it was compared */
    double to_hz;
    int compared;
    double largest_difference_percent; /* NaN: nowhere compared */
} mt_state_space_row;

extern const mt_record mt_state_space_record;

/* The lowest `modes` modes (0: of those up to `to`), compared between `from` and `to` [rad/s]
 * with the responses of the matrices themselves; texts and lists are in r->mem. Fails: as
 * mt_response_state_space. */
mt_status mt_state_space_row_of(mt_response *r, int modes, double from, double to,
                                mt_state_space_row *out, mt_err *err);

#endif
