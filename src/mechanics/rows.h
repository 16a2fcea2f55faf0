/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_ROWS_H
#define MECHANICS_ROWS_H

#include "linalg/sparse.h"
#include "mechanics/data.h"

/*
 * Stiffness, damping, mass and sensors as sparse rows over the states of (at most) two bodies:
 *     K = sum_t k_t f_t f_t^T (+ geometric part),   M = sum_t m_t sum_i f_ti f_ti^T,
 *     C = sum_t c_t f_t f_t^T,   H = sum_t eta_t k_t f_t f_t^T,   sensor = f . dq.
 * A term's coefficient is one node of the program, its rows are geometry. So repeated
 * evaluation at constant geometry is a short sum, derivatives and interval bounds of K and M
 * are available term by term, and badly scaled models keep the factor of K.
 */
typedef enum mt_term_kind {
    MT_TERM_STIFFNESS,
    MT_TERM_DAMPING,
    MT_TERM_MASS,
    MT_TERM_CHANNEL,
    MT_TERM_KINDS
} mt_term_kind;

typedef struct mt_term {
    mt_node coefficient; /* MT_NO_NODE for channels */
    /* of a spring: its part of the structural damping H is loss * coefficient; MT_NO_NODE: 0 */
    mt_node loss;
    int first; /* rows first .. first + count - 1 */
    int count;
    bool pair;   /* two rows a, b: coefficient * (a b^T + b a^T)/2; else a sum of squares */
    bool varies; /* the coefficient depends on an input */
    int body[2];
    int source; /* spring, inertia or channel it comes from */
} mt_term;

typedef struct mt_term_list {
    mt_term *terms;
    int n_terms;
    int n_rows;
    int *row_term; /* [n_rows] */
} mt_term_list;

/* The terms of a system (topology only). lists[MT_TERM_KINDS]. */
mt_status mt_terms_new(const mt_system *sys, mt_arena *mem, mt_term_list *lists, mt_err *err);
/* The loss factor that most terms of the list have; any one's where none has a majority. */
double mt_terms_common_loss(const mt_data *d, const mt_term_list *list);
/* The term of one inertia, without its rows in a list. */
mt_term mt_term_of_inertia(const mt_system *sys, int i);
/* Rows of one term at given poses: rows[12 * count], entry k of a row belongs to local freedom
 * k of the term's bodies; all rows of one kind: rows[12 * n_rows]. */
void mt_term_rows(const mt_data *d, mt_term_kind kind, const mt_term *t, const mt_pose *poses,
                  mt_cx *rows);
void mt_rows_eval(const mt_data *d, mt_term_kind kind, const mt_term_list *list,
                  const mt_pose *poses, mt_cx *rows);
/* Nonzero entries of such rows (real) by state. A failure is the arena's. */
void mt_rows_over_states(const mt_system *sys, const mt_term_list *list, const double *rows,
                         mt_arena *mem, mt_rows *out);

/* Shared by the files rows*.c. */
enum { MT_BAR_ROWS = 2, MT_DEFLECTION_ROWS = 4, MT_ROTARY_ROWS = 3 };

/* A beam element at its present position: frame of its chord, distance of its nodes, 1/(1 +
 * Phi) for bending about e2, e3. */
typedef struct mt_beam_geometry {
    mt_cx e[3][3];
    mt_cx length;
    mt_cx shape[2];
} mt_beam_geometry;

/* shape is set to 1. */
void mt_beam_frame(const mt_data *d, const int body[2], const int dir[3], const mt_pose *poses,
                   mt_beam_geometry *out);

#endif
