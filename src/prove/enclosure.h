/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROVE_ENCLOSURE_H
#define PROVE_ENCLOSURE_H

#include "analysis/analysis.h"
#include "base/run.h"

/*
 * Proven bounds of the modes of one configuration while the inputs stay within a box.
 *
 * At fixed geometry and without loads,
 *     K(x) = K0 + sum_i c_i(x) P_i,   M(x) = M0 + sum_i c_i(x) Q_i,
 *         P_i, Q_i positive semidefinite,
 * so bounds of the coefficients c_i over the box (interval arithmetic) are bounds of K and M in
 * the order of symmetric matrices: soft corner (K low, M high), stiff corner (K high, M low).
 * For every lambda >= 0
 *     K_low - lambda M_high  <=  K(x) - lambda M(x)  <=  K_high - lambda M_low,
 * hence the number of modes below lambda (the number of negative eigenvalues, Sylvester) lies
 * between that of the stiff corner and that of the soft one, and so does each eigenvalue
 * between theirs (Courant and Fischer). Exact where each input enters K alone or M alone, valid
 * but not tight for an input in both (a bar's area).
 *
 * These bounds hold under conditions that mt_enclosure_new checks. An input that shapes the
 * geometry changes the rows of P_i and Q_i: modes are enclosed over the other inputs, with each
 * such input fixed. An enclosure stores the current box and serves one worker. The rows of K
 * and M are taken as computed; their rounding is within the slack.
 */
enum { MT_REASON_SIZE = 256 };

typedef enum mt_side { MT_LOW, MT_HIGH } mt_side;
typedef enum mt_enclosure_matrix { MT_STIFFNESS, MT_MASS, MT_MATRICES } mt_enclosure_matrix;

/* A positive semidefinite matrix by its nonzero entries of the lower triangle. */
typedef struct mt_enclosure_part {
    int count; /* entries; 0: no part in this matrix */
    int *at;   /* [count] i + j n */
    double *value;
    double trace;
} mt_enclosure_part;

/* The sign required of a coefficient over the bounds. A coupling of two rows has two
 * coefficients of any sign: its own and its negative. */
typedef enum mt_sign { MT_SIGN_POSITIVE, MT_SIGN_ANY, MT_SIGN_NEGATED } mt_sign;

typedef struct mt_enclosure_coefficient {
    mt_node node;     /* of the enclosure's program */
    const char *name; /* "spring \"k1\"", "mass of \"bob\"" */
    bool mass;        /* first seen in the mass matrix */
    mt_sign required;
    bool dependent; /* an input occurs twice in it: interval arithmetic alone is not tight */
    bool open; /* work: its bound at a corner is still to be found; shares: is at this one */
    bool shares;
    /* [n_inputs] sign of the derivative over the bounds; 0: zero, or it changes */
    signed char *sign;
    bool monotone; /* monotone in all its inputs over the bounds */
    /* a stiffness that was positive over the box that was noted (tolerance.c) */
    bool held;
    double least; /* minimum over the bounds */
    /* maximum over the bounds; where it is 0, a box beyond the bounds in which the coefficient
     * is positive may have fewer rigid-body modes */
    double most;
    mt_enclosure_part part[MT_MATRICES];
} mt_enclosure_coefficient;

/* The contribution of a term of the system to the parts of a coefficient, with its rows r, or a
 * and b, and its factor. */
typedef enum mt_enclosure_form {
    MT_FORM_ROWS,      /* factor sum r r^T */
    MT_FORM_PAIR,      /* factor (a b^T + b a^T) / 2 */
    MT_FORM_SUM,       /* v v^T / 4, v = factor a + b / factor */
    MT_FORM_DIFFERENCE /* v v^T / 4, v = factor a - b / factor */
} mt_enclosure_form;

typedef struct mt_enclosure_piece {
    mt_enclosure_matrix matrix;
    int term;
    int coefficient;
    mt_enclosure_form form;
    double factor;
} mt_enclosure_piece;

typedef struct mt_enclosure {
    mt_arena mem;
    mt_arena scratch;
    int n_inputs;
    double *lower; /* [n_inputs] bounds that the conditions were checked for */
    double *upper;
    bool *frozen; /* [n_inputs] shapes the geometry: the enclosure holds for its value only */
    int n; /* order of the matrices below, in which M at the bounds' low end is the identity */
    /* rigid-body modes counted by the analysis: every design within the bounds has at least as
     * many null directions */
    int n_rigid;
    int n_modes;        /* vibration modes: n - n_rigid */
    mt_program program; /* of the coefficients alone */
    int n_coefficients;
    mt_node *sources; /* [n_coefficients] their nodes in the system's program */
    int n_pieces;
    mt_enclosure_piece *pieces;
    int *of_term[MT_MATRICES]; /* coefficient of each term; -1: it does not vary */
    /* name of a spring or body whose coupling may have any sign; NULL: none */
    const char *coupled;
    bool coupled_mass;
    mt_enclosure_coefficient *coefficients;
    bool bounded; /* least and most are known and hold in every box within the bounds */
    bool mass_varies;
    bool assembled[2];          /* corners of the current box: K at the side, M at the other */
    bool squares;               /* K0 and M0 are sums of squares: boxes may exceed the bounds */
    double *fixed[MT_MATRICES]; /* n x n, lower */
    double fixed_norm;          /* of K0 */
    double roundoff;            /* relative slack: see box.c */
    bool *in[MT_MATRICES];      /* [n_inputs] the input enters this matrix */
    /* of the current box */
    double *value[2];           /* [n_coefficients] */
    double *node[2];            /* [program.count] work */
    double *dnode[2];           /* [program.count x n_inputs] work */
    double *corner_x[2];        /* [n_inputs] work */
    unsigned char *corner;      /* [n_inputs] work */
    double *at[MT_MATRICES][2]; /* n x n, lower; mass: NULL where it does not vary */
    double *work;               /* n x n */
    double slack_k;             /* slack of an eigenvalue: slack_k + slack_m lambda */
    double slack_m;
    long counts;             /* inertia counts so far */
    long fallbacks;          /* of these, by pivoting */
    double operations;       /* approximate multiplications of boxes and counts so far */
    mt_interrupt *interrupt; /* of the analysis' model */
} mt_enclosure;

/*
 * Enclose the modes of an analysis (which has been solved at least once) over lower <= x <=
 * upper [n_inputs]. An input that shapes the geometry must have lower = upper, and the last
 * solve of the analysis must be at that value. Where a condition fails, the call succeeds with
 * *out NULL, and reason[MT_REASON_SIZE] names the condition, as a sentence after "no
 * certificate: ". Only names, which belong to the model, are borrowed. Fails: MT_E_MEMORY,
 * numerical failures of LAPACK.
 */
mt_status mt_enclosure_new(const mt_analysis *a, const double *lower, const double *upper,
                           mt_enclosure **out, char *reason, mt_err *err);
void mt_enclosure_delete(mt_enclosure *e);

/*
 * The two corners of a box at which all modes are lowest and highest: soft[n_inputs],
 * stiff[n_inputs]; an input without influence stays in the middle. False where they do not
 * exist: an input with lo < hi (named in reason) stiffens in one part of the box and softens in
 * another, or adds both stiffness and mass.
 */
bool mt_enclosure_corners(mt_enclosure *e, const mt_model *model, const int *inputs,
                          const double *lo, const double *hi, double *soft, double *stiff,
                          char *reason);
/*
 * The effect of raising each input on the modes over the box lo <= x <= hi, for any values of
 * the other inputs: effects[n_inputs]. MT_STIFFENS alone: no frequency falls; MT_SOFTENS alone:
 * none rises; both: neither is shown; 0: no influence. The derivative of every coefficient is
 * enclosed over the whole box.
 */
enum { MT_STIFFENS = 1, MT_SOFTENS = 2 };
void mt_enclosure_effects(mt_enclosure *e, const double *lo, const double *hi, int *effects);
/* True where input i enters both K and M (only smaller boxes then make the enclosure
 * tight). */
bool mt_enclosure_loose(const mt_enclosure *e, int i);

/* found[n_inputs]: true for inputs that shape the geometry of stiffness and mass. */
void mt_enclosure_shaping(const mt_analysis *a, bool *found);

/* Bounds of all coefficients over the box into value[2]. */
void mt_enclosure_bounds(mt_enclosure *e, const double *lo, const double *hi);

#endif
