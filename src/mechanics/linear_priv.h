/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_LINEAR_PRIV_H
#define MECHANICS_LINEAR_PRIV_H

#include "mechanics/couplings.h"
#include "mechanics/linear.h"

typedef struct mt_linear_tangent mt_linear_tangent;

/*
 * Results of the stages geometry and tangent at one design. Configurations of one shape
 * (mt_system_same_shape) at the same design compute them once: linearised systems that share
 * use one object, and a system that moves to another design leaves it to the others. There are
 * as many objects as systems, so a free one always exists.
 */
typedef struct mt_geometry {
    mt_arena mem;
    int users;              /* systems that use it */
    const mt_linear *maker; /* whose factors may point into its system */
    bool made;              /* valid for the inputs `at` */
    bool sloped;            /* derivatives are valid as well */
    mt_state position;
    mt_elimination e; /* without z, which belongs to the reduction */
    double *a;
    double *rows[MT_TERM_KINDS];
    mt_rows full[MT_TERM_KINDS];
    mt_arena_mark before_tangent;
    mt_linear_tangent *tangent;
    double at[]; /* [n_inputs] */
} mt_geometry;

typedef struct mt_geometries {
    int n;
    mt_linear **systems;
    int n_all; /* geometries, at least n */
    mt_geometry **all;
} mt_geometries;

/* Data of a linearised system, shared by the files of this room. */
typedef struct mt_section_slopes mt_section_slopes; /* equilibrium_slopes.c */

struct mt_linear {
    const mt_system *sys;
    mt_arena base;         /* freed with this */
    mt_geometries *pool;   /* geometries of the systems that share; owned by all of them */
    mt_geometry *geometry; /* of the stages geometry and tangent */
    mt_arena reduced_mem;  /* of the stage reduction and of the matrices */
    mt_arena scratch;
    mt_stages stages;
    double *value; /* [program.count] */
    double *grad;  /* [program.count x n_inputs], after an update with gradients */
    mt_term_list list[MT_TERM_KINDS];
    mt_coupling *coupling; /* of the terms of K (couplings.h) */
    bool *squared;         /* of the terms of K: the coupled spring is a sum of squares */
    mt_data data;          /* real */
    mt_newton_start start; /* of equilibria, kept from design to design */
    mt_data dual;          /* with derivative */
    mt_state position;
    mt_placement last; /* position of the driven joint at the last update */
    /* position of the driven joint at the first update, of inputs home_at, where it was
     * direct */
    mt_placement home;
    double *home_at;
    bool has_home;
    bool had_first;   /* there was an update */
    int first_input;  /* derivatives are wanted from this input on; 0: for all */
    mt_elimination e; /* at the final position, constraints of the linearised system */
    double *z_error;  /* nq x n: bounds of the errors of e.z */
    int m;            /* constraints in force */
    double *a;        /* m x nq */
    int n;            /* freedoms */
    /* spins without inertia, stiffness or joint, left out of the freedoms (free_spin.h) */
    int n_free_spins;
    bool *free_spins;                  /* [bodies] takes part in one */
    int n_pieces;                      /* of pieces */
    double *rows[MT_TERM_KINDS];       /* 12 x n_rows, local freedoms */
    mt_rows full[MT_TERM_KINDS];       /* the same over the states, by local freedom */
    double *full_error[MT_TERM_KINDS]; /* bounds of the errors of their entries */
    double *reduced[MT_TERM_KINDS];    /* n x n_rows: Z^T row, rounding made 0 (linear.h) */
    mt_rows entries[MT_TERM_KINDS];    /* nonzero entries of reduced; none in a blocked row */
    double *noise;    /* n x n_rows: bounds of the errors of reduced[MT_TERM_STIFFNESS] */
    double *kg;       /* nq x nq geometric stiffness; NULL without loads */
    mt_rows kg_rows;  /* the same, its entries that are not 0 */
    mt_piece *pieces; /* [n_pieces] the forces; NULL without loads */
    double *push;     /* [bodies] magnitudes of all forces on each */
    double *kg_terms; /* nq x nq: sums of magnitudes of the terms of kg */
    double *k;        /* n x n */
    double *m_r;      /* n x n */
    double *k_fixed;  /* part of K_r from terms without inputs (and Kg) */
    double *m_fixed;
    double *g_fixed;  /* part of factor_g from Kg */
    double *factor_b; /* list[STIFFNESS].n_rows x n: B */
    double *factor_c;
    double *factor_noise; /* bounds of the errors of factor_b's entries */
    /* n x n: the part that is not a sum of squares: geometric stiffness, indefinite couplings,
     * negative coefficients; K_r = B^T diag(c) B + G */
    double *factor_g;
    unsigned long stiffness_version; /* changes when K_r is computed again */
    unsigned long mass_version;      /* changes when M_r is computed again */
    bool unstressed;                 /* driven with no spring stretched: treated as unloaded */
    bool has_factor_g;               /* there is a factor_g */
    bool graded;                     /* grad belongs to value */
    bool started;                    /* value has the nodes without inputs */
    /* a driven joint starts at its position of the last update, not at the reference position:
     * for sweeps */
    bool follow;
    bool has_last;              /* `last` is valid */
    bool free_spin_varies;      /* the existence of free spins depends on inputs */
    mt_linear_tangent *tangent; /* [n_inputs], where geometry or position depend on inputs */
    /* the inputs that act through the equilibrium's forces alone, where there are several:
     * slopes of eigenvalues by them need no tangent (equilibrium_slopes.h) */
    uint64_t *forced;
    bool by_adjoint;             /* there are some */
    bool due;                    /* and nobody has asked for their tangents yet */
    mt_section_slopes *sections; /* NULL: not yet */
};

/* out[nq] += scale Kg phi; nothing without loads. */
void mt_linear_add_load(const mt_linear *lin, double scale, const double *phi, double *out);
/* Contribution of a term to H: loss * coefficient; 0 without a loss factor. */
double mt_linear_loss(const mt_linear *lin, const mt_term *t);

#endif
