/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TREE_TREE_SLOPE_PRIV_H
#define TREE_TREE_SLOPE_PRIV_H

#include "tree/tree_priv.h"

#include "mechanics/rows.h"

/* Shared by the files tree_slope*.c. */
typedef struct mt_tree_slope {
    const mt_tree *t;
    const mt_system *sys;
    const mt_tree_modes *modes;
    mt_data data;         /* along the current input */
    mt_pose *pose;        /* [bodies] along the current input */
    uint64_t *vec_inputs; /* [n_vecs x words] bit set of the inputs of each vector */
    double *within;       /* s n x modes: w of mt_tree_within */
    double *transport;    /* s n x modes: P of mt_tree_transport */
    double *force;        /* springs x modes: k times the mode's elongation of the spring */
    double *mu;           /* constraints x modes: multiplier of each equation in the mode */
    /* n_pairs x constraints: phi_a^T H phi_b; NULL without loads */
    double *geometric_stiffness;
    double *projected; /* [2 x modes] work */
    double *energy;    /* [n_pairs] work */
    double *slope;     /* n_pairs x n_inputs */
    char *why;
    mt_arena *scratch;
} mt_tree_slope;

/* True where the measure (the vector) depends on the current input. */
bool mt_tree_slope_moves(const mt_tree_slope *w, const mt_measure_def *def);
bool mt_tree_slope_moves_vec(const mt_tree_slope *w, int vec);
/* Derivative of a node by the current input. */
double mt_tree_slope_of(const mt_tree_slope *w, mt_node node);
void mt_tree_slope_jet(const mt_tree_slope *w, const mt_measure_def *def, bool second,
                       mt_jet *jet);
/* Gradient of the measure over the motion of body i, row[s], and its derivative by the current
 * input, drow[s]. */
void mt_tree_slope_row(const mt_tree_slope *w, const mt_measure_def *def, int i,
                       const mt_jet *jet, double *row, double *drow);
/* Motion of two bodies in mode a: phi[12], 0 for constrained freedoms. */
void mt_tree_slope_pair(const mt_tree_slope *w, int a, const int body[2], double *phi);
/* Column of body i in mode a of `of`: within or transport. */
static inline const double *mt_tree_slope_at(const mt_tree_slope *w, const double *of, int i,
                                             int a)
{
    return of + ((ptrdiff_t)w->t->s * (i + ((ptrdiff_t)w->t->n * a)));
}
/* phi_a^T H phi_b of a jet over two bodies, for each pair, into form[n_pairs]; derivative: of
 * the derivative of H by the current input. */
void mt_tree_slope_form(const mt_tree_slope *w, const int body[2], const mt_jet *jet,
                        bool derivative, double *form);
/* Report that there are no slopes: reason `text` for the current input. */
void mt_tree_slope_refuse(const mt_tree_slope *w, const char *text);
/* Contribution of the loads along the current input. Fails: MT_E_NOT_SPD. */
mt_status mt_tree_slope_loads(mt_tree_slope *w, mt_err *err);

#endif
