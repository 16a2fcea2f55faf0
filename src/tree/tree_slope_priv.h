/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TREE_TREE_SLOPE_PRIV_H
#define TREE_TREE_SLOPE_PRIV_H

#include "tree/tree_priv.h"

#include "mechanics/rows.h"

/* What the files tree_slope*.c share. */
typedef struct mt_tree_slope {
    const mt_tree *t;
    const mt_system *sys;
    const mt_tree_modes *modes;
    mt_data data;         /* along one input after the other */
    mt_pose *pose;        /* [bodies] likewise */
    uint64_t *vec_inputs; /* [n_vecs x words] inputs of each vector, as bits */
    double *within;       /* s n x modes: w of mt_tree_within */
    double *transport;    /* s n x modes: P of mt_tree_transport */
    double *force;        /* springs x modes: k times how far the mode stretches it */
    double *mu;           /* constraints x modes: what the mode makes each equation hold */
    /* n_pairs x constraints: phi_a^T H phi_b, where something loads */
    double *geometric_stiffness;
    double *projected; /* [2 x modes] work */
    double *energy;    /* [n_pairs] work */
    double *slope;     /* n_pairs x n_inputs */
    char *why;
    mt_arena *scratch;
} mt_tree_slope;

/* Whether the present input moves what the measure is made of. */
bool mt_tree_slope_moves(const mt_tree_slope *w, const mt_measure_def *def);
bool mt_tree_slope_moves_vec(const mt_tree_slope *w, int vec);
/* Derivative of a node by the present input. */
double mt_tree_slope_of(const mt_tree_slope *w, mt_node node);
void mt_tree_slope_jet(const mt_tree_slope *w, const mt_measure_def *def, bool second,
                       mt_jet *jet);
/* The measure's gradient over the motion of body i itself, row[s], and its derivative
 * drow[s]. */
void mt_tree_slope_row(const mt_tree_slope *w, const mt_measure_def *def, int i,
                       const mt_jet *jet, double *row, double *drow);
/* Motion of two bodies in mode a: phi[12], 0 where there is no freedom. */
void mt_tree_slope_pair(const mt_tree_slope *w, int a, const int body[2], double *phi);
/* Motion of body i within its edge in mode a; what its edge carries. */
static inline const double *mt_tree_slope_at(const mt_tree_slope *w, const double *of, int i,
                                             int a)
{
    return of + ((ptrdiff_t)w->t->s * (i + ((ptrdiff_t)w->t->n * a)));
}
/* phi_a^T H phi_b of a jet over two bodies, for each pair, into form[n_pairs]; of the
 * derivative of H where that is asked for. */
void mt_tree_slope_form(const mt_tree_slope *w, const int body[2], const mt_jet *jet,
                        bool derivative, double *form);
/* No slopes, as of the present input what `text` says. */
void mt_tree_slope_refuse(const mt_tree_slope *w, const char *text);
/* What the loads make of it, along the present input. Fails: MT_E_NOT_SPD. */
mt_status mt_tree_slope_loads(mt_tree_slope *w, mt_err *err);

#endif
