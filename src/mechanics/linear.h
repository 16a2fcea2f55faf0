/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_LINEAR_H
#define MECHANICS_LINEAR_H

#include "base/run.h"
#include "mechanics/position.h"
#include "mechanics/rows.h"
#include "mechanics/singular.h"

/*
 * Inputs that each stage of a linearised system depends on, by the structure of its program,
 * and their values at its last computation. Sets of inputs are bit sets, as in the program.
 */
typedef struct mt_stages {
    int n_inputs;
    int words;
    uint64_t *loaded;    /* `shape` and `forces` of the system (system.h) */
    uint64_t *stiffness; /* coefficients of K */
    uint64_t *mass;      /* coefficients of M */
    uint64_t *all;
    uint64_t *none;
    double *at[MT_STAGES]; /* [n_inputs] */
    bool valid[MT_STAGES]; /* the results of the stage are valid for the inputs `at` */
    mt_stage_counts counts;
    double started_s;    /* start of the current stage */
    mt_profile *profile; /* NULL: not reported; not owned */
} mt_stages;
/* True where the stage has to be computed, if it depends on the inputs of `set` only. Bits are
 * compared. A stage to be computed is not valid until mt_stages_done; another one is counted as
 * skipped. */
bool mt_stages_begin(mt_stages *s, mt_stage_id stage, const uint64_t *set,
                     const double *inputs);
void mt_stages_done(mt_stages *s, mt_stage_id stage, const double *inputs);
bool mt_stages_has(const uint64_t *set, int input);

/*
 * A system linearised at one design: positions, reduced stiffness and mass, exact derivatives
 * by the inputs. All mutable data is here, one object per worker; the system is shared.
 *
 *     q = Z y,  A Z = 0,   K_r = Z^T K Z,  M_r = Z^T M Z
 *         (n x n, column-major, both triangles filled)
 *
 * A stage (base/run.h) is computed again only where an input that it depends on has other
 * bits than at its last computation, or where an earlier stage was computed.
 * Skipping does not change results: they depend on the inputs alone, and on the first update,
 * whose masses choose the basis of a geometry that no input moves, and from whose driven
 * position those begin that differ in neither drawing nor drive (MT_POSITION_AGAIN).
 */
typedef struct mt_linear mt_linear;

mt_status mt_linear_new(const mt_system *sys, mt_linear **out, mt_err *err);
void mt_linear_delete(mt_linear *lin);
/* Evaluate at inputs[n_inputs]. Fails as mt_position_solve, MT_E_DEAD_CENTRE, MT_E_DOMAIN
 * (names the number by its address in the text). No heap after the first calls. */
mt_status mt_linear_update(mt_linear *lin, const double *inputs, bool with_gradient,
                           mt_err *err);
/* Position only, for drawings: mt_linear_position has it, everything else is void until the
 * next update. */
mt_status mt_linear_set_inputs(mt_linear *lin, const double *inputs, mt_err *err);
/* on: a driven joint starts at its position of the last update, not at the reference position,
 * for sweeps; the first update after this call starts at the reference position. Off: every
 * update does. */
void mt_linear_follow(mt_linear *lin, bool on);
/* Derivatives are wanted only from this input on; 0: for all. Not for a system that shares. */
void mt_linear_first_input(mt_linear *lin, int first);

/* lin, which shares with none yet, and `with`, of the same worker, compute the stages geometry
 * and tangent once for designs at which both are updated; results are the same to the bit.
 * *shared false: they do not have one shape (mt_system_same_shape), or are loaded or driven, or
 * no input moves the geometry. Either may be deleted first. Fails: MT_E_MEMORY. */
mt_status mt_linear_share(mt_linear *lin, mt_linear *with, bool *shared, mt_err *err);

/* Results of an update, read-only and valid until the next one. */
const mt_system *mt_linear_system(const mt_linear *lin);
/* Counts of the stages, to which the caller adds later ones (modes). */
mt_stages *mt_linear_stages(mt_linear *lin);
const mt_state *mt_linear_position(const mt_linear *lin);
int mt_linear_freedoms(const mt_linear *lin);  /* n */
int mt_linear_equations(const mt_linear *lin); /* m: constraints in force */

/* K_r and M_r, and K_r = B^T diag(c) B + G with the springs as squares where possible. */
typedef struct mt_reduced {
    int n;
    const double *k; /* n x n [N/m, N, N m] */
    const double *m; /* n x n [kg, kg m, kg m^2] */
    /* changes whenever k or its factor is computed again */
    unsigned long stiffness_version;
    unsigned long mass_version; /* the same for m */
    bool loaded;                /* K_r has a geometric part */
    int rows;
    const double *b;     /* rows x n */
    const double *c;     /* [rows] */
    const double *noise; /* rows x n: bounds of the errors of b's entries */
    /* n x n: geometric stiffness, indefinite couplings, negative coefficients; NULL: none */
    const double *g;
} mt_reduced;
mt_reduced mt_linear_reduced(const mt_linear *lin);

/* K_r and M_r as sums of terms: a term of the list has the coefficient mt_linear_value, and row
 * i is the n entries of Z^T f_i (n x n_rows in all, rounding made 0). */
const mt_term_list *mt_linear_terms(const mt_linear *lin, mt_term_kind kind);
const double *mt_linear_row(const mt_linear *lin, mt_term_kind kind, int row);
/* n x n: the part of K_r (with its geometric part) or M_r from terms without inputs. */
const double *mt_linear_fixed(const mt_linear *lin, mt_term_kind kind);
/* Value of a node of the program; its derivative, after an update with gradients. */
double mt_linear_value(const mt_linear *lin, mt_node node);
double mt_linear_slope(const mt_linear *lin, mt_node node, int input);
/* free_spins[bodies] (may be NULL): bodies that spin without inertia, stiffness or joint and
 * are left out of the freedoms (free_spin.h). Returns the number of such spins. */
int mt_linear_free_spins(const mt_linear *lin, const bool **free_spins);

/* phi = Z y: y n x cols, phi nq x cols. */
void mt_linear_expand(const mt_linear *lin, int cols, const double *y, double *phi);
/* c := reduced damping matrix Z^T C Z of the dampers (n x n, both triangles). */
void mt_linear_damping(const mt_linear *lin, double *c);
/* h := reduced structural damping H of the springs' loss factors (n x n; NULL: not wanted): the
 * dynamic stiffness is K + i H for motions with e^{i w t}. Loads and preload, whose geometric
 * stiffness belongs to no spring, do not contribute. True where any term is not 0. */
bool mt_linear_structural(const mt_linear *lin, double *h);

/* Results of the elimination at the linearised position, in names of the model. After an
 * update. */

/* Number of redundant equations (m - rank); names of the joints of set k, in mem. */
int mt_linear_redundant(const mt_linear *lin);
mt_status mt_linear_redundant_set(mt_linear *lin, int k, mt_arena *mem, mt_joint_names *out,
                                  mt_err *err);
/* Distance to a position where equations are dependent there only (singular.h). Names are in
 * mem. */
mt_status mt_linear_nearness(mt_linear *lin, mt_arena *mem, mt_nearness *out, mt_err *err);
/* Names of the bodies and directions that dominate a direction y in the freedoms, "bob
 * (rotation)", for messages, in text[size]. */
void mt_linear_name_direction(const mt_linear *lin, const double *y, char *text, size_t size);

#endif
