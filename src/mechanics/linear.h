/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_LINEAR_H
#define MECHANICS_LINEAR_H

#include "mechanics/position.h"
#include "mechanics/rows.h"
#include "mechanics/stages.h"

/*
 * A system linearised at one design: positions, reduced stiffness and mass, exact derivatives
 * with respect to the inputs. All that moves is here, one per worker; the system is shared.
 *
 *     q = Z y,  A Z = 0,   K_r = Z^T K Z,  M_r = Z^T M Z
 *         (n x n, column-major, both triangles filled)
 *
 * What does not change is not computed again: a stage (base/profile.h) is done where an input
 * that it depends on has other bits than when it was done last, or where one before it was done
 * (stages.h). Skipping is invisible: what an update leaves depends on the inputs alone, and on
 * the first update, whose masses choose the basis of a geometry that no input moves.
 */
typedef struct mt_linear mt_linear;

mt_status mt_linear_new(const mt_system *sys, mt_linear **out, mt_err *err);
void mt_linear_delete(mt_linear *lin);
/* Evaluate at inputs[n_inputs]. Fails as mt_position_solve, MT_E_DEAD_CENTRE, MT_E_DOMAIN
 * (names the number by its address in the text). No heap after the first calls. */
mt_status mt_linear_update(mt_linear *lin, const double *inputs, bool with_gradient,
                           mt_err *err);
/* Of an update the position alone, for who only draws it: mt_linear_position has it, all else
 * is void until the next update. */
mt_status mt_linear_set_inputs(mt_linear *lin, const double *inputs, mt_err *err);
/* From now on a driven joint begins where the last update left it, instead of at the reference
 * position: for sweeps. The first update after this call begins at the reference position; so
 * do all of them after `on` false. */
void mt_linear_follow(mt_linear *lin, bool on);
/* Derivatives will be asked for from this input on alone; 0: of all of them. Not of a system
 * that shares. */
void mt_linear_first_input(mt_linear *lin, int first);

/* From now on lin, which shares with none yet, and `with`, of the same worker, make the stages
 * geometry and tangent once for designs that both are updated at: what an update leaves is the
 * same to the bit. *shared false: they are not of one shape (mt_system_same_shape), or loaded,
 * driven, or none of their inputs moves it. Either may be deleted first. Fails: MT_E_MEMORY. */
mt_status mt_linear_share(mt_linear *lin, mt_linear *with, bool *shared, mt_err *err);

/* What an update left, read-only and until the next one. */
const mt_system *mt_linear_system(const mt_linear *lin);
/* What was done of the stages, to which the caller adds those that follow (modes). */
mt_stages *mt_linear_stages(mt_linear *lin);
const mt_state *mt_linear_position(const mt_linear *lin);
int mt_linear_freedoms(const mt_linear *lin);  /* n */
int mt_linear_equations(const mt_linear *lin); /* m: constraints in force */

/* K_r and M_r, and K_r = B^T diag(c) B + G with the springs as squares where they are some. */
typedef struct mt_reduced {
    int n;
    const double *k; /* n x n [N/m, N, N m] */
    const double *m; /* n x n [kg, kg m, kg m^2] */
    /* changes whenever k, or anything of its factor, is made again */
    unsigned long stiffness_version;
    unsigned long mass_version; /* likewise of m */
    bool loaded;                /* K_r has a geometric part */
    int rows;
    const double *b;     /* rows x n */
    const double *c;     /* [rows] */
    const double *noise; /* rows x n: bounds of the errors of b's entries */
    /* n x n: geometric stiffness, indefinite couplings, negative coefficients; NULL: none */
    const double *g;
} mt_reduced;
mt_reduced mt_linear_reduced(const mt_linear *lin);

/* The same as sums of terms: a term of the list has the coefficient mt_linear_value, and of row
 * i the n entries of Z^T f_i (n x n_rows in all, rounding made 0). */
const mt_term_list *mt_linear_terms(const mt_linear *lin, mt_term_kind kind);
const double *mt_linear_row(const mt_linear *lin, mt_term_kind kind, int row);
/* n x n: the part of K_r (with its geometric part) or M_r from terms that depend on no
 * input. */
const double *mt_linear_fixed(const mt_linear *lin, mt_term_kind kind);
/* Value of a node of the program; its derivative, after an update with gradients. */
double mt_linear_value(const mt_linear *lin, mt_node node);
double mt_linear_slope(const mt_linear *lin, mt_node node, int input);
/* idle[bodies] (may be NULL): which spin without mass, stiffness or joint, and are left out of
 * the freedoms (free_spin.h). Returns how many such spins there are. */
int mt_linear_free_spins(const mt_linear *lin, const bool **free_spins);

/* phi = Z y: y n x cols, phi nq x cols. */
void mt_linear_expand(const mt_linear *lin, int cols, const double *y, double *phi);
/* Reduced damping matrix Z^T C Z (n x n, both triangles) of the dampers into c. */
void mt_linear_damping(const mt_linear *lin, double *c);
/* Structural damping H of the springs' loss factors likewise, into h (NULL: not wanted): the
 * dynamic stiffness is K + i H for motions with e^{i w t}. Loads and preload, whose geometric
 * stiffness is no spring's, have no part in it. Returns whether any term is not 0. */
bool mt_linear_structural(const mt_linear *lin, double *h);

#endif
