/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_DATA_H
#define MECHANICS_DATA_H

#include "mechanics/pose.h"

/*
 * All numbers of a system at one design, for the complex kernels: values alone (input < 0), or
 * values with the derivative by one input.
 */
typedef struct mt_data {
    const mt_system *sys;
    const double *value; /* [program.count] */
    const double *grad;  /* [program.count x n_inputs]; may be NULL where input < 0 */
    int input;           /* -1: no derivative */
    mt_cx (*vec)[3];     /* [n_vecs] */
    mt_cx (*rest)[2];    /* [n_springs] rest values of the two measures of each spring */
    mt_cx *target;       /* [n_constraints]; that of the drive at the joint's position */
} mt_data;

mt_status mt_data_init(mt_data *d, const mt_system *sys, mt_arena *mem, mt_err *err);
/* Compute vector i from earlier vectors and the nodes. */
void mt_data_vec(mt_data *d, int i);
/* Compute all vectors; all targets, from the drawn position. */
void mt_data_vecs(mt_data *d);
void mt_data_targets(mt_data *d);
/* Compute rest values and the target of the drive at the reference position (poses may have
 * derivatives). */
void mt_data_rest(mt_data *d, const mt_pose *reference);
/* Update the whole turns of the angles in at->turn; each angle is less than half a turn from
 * its last value. */
void mt_data_turns(const mt_data *d, mt_placement *at);
/* Target of constraint i with the driven joint at its position in `at`. */
mt_cx mt_data_target(const mt_data *d, int i, const mt_placement *at);
/* A node as a complex number; MT_NO_NODE gives `otherwise`. */
mt_cx mt_data_scalar(const mt_data *d, mt_node node, double otherwise);
/* The measure with its vectors; an angle takes the value nearest to 0. */
mt_measure_data mt_data_measure(const mt_data *d, const mt_measure_def *def);
/* Its value at a position, an angle with its whole turns. */
mt_cx mt_data_value(const mt_data *d, const mt_measure_def *def, const mt_placement *at,
                    mt_beam_parts *kept);
/* The same with derivatives, as mt_measure_eval. */
void mt_data_eval(const mt_data *d, const mt_measure_def *def, const mt_placement *at,
                  bool second, mt_beam_parts *kept, mt_jet *out);
void mt_data_relative(const mt_data *d, const mt_measure_def *def, const mt_placement *at,
                      bool second, mt_beam_parts *kept, mt_relative_jet *out);
/* Drawn positions (with their derivative); poses[n_bodies]. */
void mt_data_drawn(const mt_data *d, mt_pose *poses);

#endif
