/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_LINEAR_H
#define MECHANICS_LINEAR_H

#include "mechanics/position.h"
#include "mechanics/rows.h"
#include "mechanics/singular.h"

/*
 * A system linearised at one design: positions, reduced stiffness and mass, exact derivatives
 * with respect to the inputs. All that moves is here, one per worker; the system is shared.
 *
 *     q = Z y,  A Z = 0,   K_r = Z^T K Z,  M_r = Z^T M Z
 *         (n x n, column-major, both triangles filled)
 *
 * What does not change is not computed again: where the geometry is fixed and nothing loads the
 * mechanism, an update is the evaluation of the program and a sum of reduced terms; where no
 * mass depends on an input, M_r is left alone (mass_version tells).
 */
typedef struct mt_linear_tangent mt_linear_tangent;

/* Does the spring that a term of K comes from couple its measures (a bushing's matrix), and
 * does any of its terms depend on an input? */
typedef enum mt_coupling {
    MT_COUPLING_NONE,
    MT_COUPLING_WHOLE,
    MT_COUPLING_VARIES
} mt_coupling;

typedef struct mt_linear {
    const mt_system *sys;
    mt_arena base;     /* lives as long as this */
    mt_arena geometry; /* rewound when the geometry changes */
    mt_arena scratch;
    double *value; /* [program.count] */
    double *grad;  /* [program.count x n_inputs], after an update with gradients */
    mt_term_list list[MT_TERM_KINDS];
    mt_coupling *coupling; /* of the terms of K (couplings.h) */
    bool *squared; /* of the terms of K: their spring with couplings is a sum of squares */
    mt_data data;  /* real */
    mt_data dual;  /* with derivative */
    mt_state position;
    /* a driven joint begins where the last update left it, instead of at the reference
     * position: for sweeps */
    bool follow;
    mt_placement last; /* where it left the driven joint */
    bool has_last;
    int first_input;  /* derivatives are asked for from this input on; 0: of all of them */
    mt_elimination e; /* at the final position, constraints of the linearised system */
    double *z_error;  /* nq x n: bounds of the errors of e.z */
    int m;            /* constraints in force */
    double *a;        /* m x nq */
    int n;            /* freedoms */
    int n_idle; /* spins without mass, stiffness or joint, left out of the freedoms (idle.h) */
    bool *idle; /* [bodies] takes part in one */
    int n_pieces;                   /* of pieces */
    double *rows[MT_TERM_KINDS];    /* 12 x n_rows, local freedoms */
    double *reduced[MT_TERM_KINDS]; /* n x n_rows: Z^T row, rounding made 0 (reduce.h) */
    bool *blocked[MT_TERM_KINDS];   /* [n_rows]: the joints block it, the reduced row is 0 */
    double *noise;    /* n x n_rows: bounds of the errors of reduced[MT_TERM_STIFFNESS] */
    double *kg;       /* nq x nq geometric stiffness; NULL where nothing loads */
    mt_piece *pieces; /* [n_pieces] of the forces that make kg */
    double *kg_terms; /* nq x nq: magnitudes of the terms that kg is the sum of */
    double *k;        /* n x n */
    double *m_r;      /* n x n */
    double *k_fixed;  /* part of K_r from terms without inputs (and Kg) */
    double *m_fixed;
    double *g_fixed;  /* part of factor_g from Kg */
    double *factor_b; /* list[STIFFNESS].n_rows x n: B */
    double *factor_c;
    double *factor_noise; /* bounds of the errors of factor_b's entries */
    /* n x n: what is no sum of squares: geometric stiffness, indefinite couplings, negative
     * coefficients; K_r = B^T diag(c) B + G */
    double *factor_g;
    bool has_factor_g;          /* is there such a part? */
    unsigned long mass_version; /* changes when M_r does */
    unsigned long geometry_version;
    bool unstressed;  /* driven to its place with no spring stretched: as good as unloaded */
    bool idle_varies; /* whether there are idle spins depends on inputs */
    bool built;
    bool with_gradient;
    mt_linear_tangent *tangent; /* [n_inputs], where geometry or position depend on inputs */
} mt_linear;

mt_status mt_linear_new(const mt_system *sys, mt_linear **out, mt_err *err);
void mt_linear_delete(mt_linear *lin);
/* Evaluate at inputs[n_inputs]. Fails as mt_position_solve, MT_E_DEAD_CENTRE, MT_E_DOMAIN
 * (names the number by its address in the text). No heap after the first calls. */
mt_status mt_linear_update(mt_linear *lin, const double *inputs, bool with_gradient,
                           mt_err *err);
/*
 * Equations of joints that are redundant here need not be so at other values of input p. With w
 * a left null vector of A, a dot the derivative along p and the motion that it causes,
 *     w^T c. != 0         the joints do not stay closed: the position has no derivative
 *     w^T A. Z y != 0
 *         the motion y, free here, is blocked at any other value of p: so is the number of
 *         freedoms, and the mode y has no derivative.
 */
typedef struct mt_independence {
    bool opens;            /* the first */
    bool blocks;           /* the second, for some motion */
    mt_joint_names joints; /* whose equations they are */
} mt_independence;
/* After an update with gradients; names are in mem. Costs nothing where no equation is
 * redundant or p moves nothing. */
mt_status mt_linear_independence(mt_linear *lin, int p, mt_arena *mem, mt_independence *out,
                                 mt_err *err);
/* blocked[cols]: which of the motions y (n x cols) are. */
mt_status mt_linear_blocked(mt_linear *lin, int p, int cols, const double *y, bool *blocked,
                            mt_err *err);
/* phi = Z y: y n x cols, phi nq x cols. */
void mt_linear_expand(const mt_linear *lin, int cols, const double *y, double *phi);
/* dky = (dK_r/dp) y and dmy = (dM_r/dp) y for input p, with all that depends on it (geometry,
 * constraints, equilibrium); n x cols. dm_zero (may be NULL): dmy is zero. After an update with
 * gradients. */
mt_status mt_linear_products(mt_linear *lin, int p, int cols, const double *y, double *dky,
                             double *dmy, bool *dm_zero, mt_err *err);
/* Values of channels channel[ns] for shapes y (n x cols): s ns x cols. */
mt_status mt_linear_sense(mt_linear *lin, int ns, const int *channel, int cols, const double *y,
                          double *s, mt_err *err);
/* Their derivative with respect to input p, given dy = dy/dp (n x cols): ds ns x cols. */
mt_status mt_linear_sense_derivative(mt_linear *lin, int p, int ns, const int *channel,
                                     int cols, const double *y, const double *dy, double *ds,
                                     mt_err *err);
/* Number of redundant equations (m - rank) and, for set k, its joints' names, in mem. */
int mt_linear_redundant(const mt_linear *lin);
mt_status mt_linear_redundant_set(mt_linear *lin, int k, mt_arena *mem, mt_joint_names *out,
                                  mt_err *err);
/* How near the position is to one where equations depend on each other there only (singular.h).
 * After an update; names are in mem. */
mt_status mt_linear_nearness(mt_linear *lin, mt_arena *mem, mt_nearness *out, mt_err *err);
/* Names of the bodies and directions that dominate a direction y in the freedoms: "bob
 * (rotation)", for messages. Buffer of size bytes. */
void mt_linear_name_direction(const mt_linear *lin, const double *y, char *text, size_t size);
/* w = M Z y over all states, nq (mass-weighted shape, for correlation with shapes at other
 * designs). */
mt_status mt_linear_mass_product(mt_linear *lin, const double *y, double *w, mt_err *err);
/* Reduced damping matrix Z^T C Z (n x n) into c. */
void mt_linear_damping(const mt_linear *lin, double *c);

#endif
