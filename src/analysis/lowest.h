/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANALYSIS_LOWEST_H
#define ANALYSIS_LOWEST_H

#include "mechanics/absolute.h"
#include "modal/sparse.h"
#include "tree/tree.h"

/* Method by which the modes were found; NONE: none applies. */
typedef enum mt_lowest_method {
    MT_LOWEST_NONE,
    MT_LOWEST_TREE,
    MT_LOWEST_SPARSE
} mt_lowest_method;
enum { MT_LOWEST_WHY = MT_TREE_WHY + MT_ABSOLUTE_WHY + 100 };

typedef struct mt_lowest_want {
    int count;   /* vibration modes, at least 1 */
    bool shapes; /* shapes or their derivatives are wanted */
    bool tree;   /* only by the tree method */
    /* only in equilibrium in the drawn position, which derivatives and scenes require */
    bool drawn;
} mt_lowest_want;

/*
 * The lowest modes of one configuration of a mechanism of any size: a tree (tree/tree.h) in
 * coordinates of its joints, O(bodies) in time and memory; otherwise in coordinates of its
 * bodies (modal/sparse.h), at the cost of the fill-in of a factor. One worker.
 */
typedef struct mt_lowest {
    mt_arena mem;
    mt_system *sys; /* owned */
    mt_lowest_method way;
    mt_tree *tree;             /* NULL: the configuration is not such a tree */
    mt_absolute bodies;        /* for the sparse method, like the next three */
    mt_sparse_problem problem; /* without `check` */
    mt_sparse_solver *solver;  /* for forces */
    double *work;              /* [coordinates] */
    mt_state position;         /* equilibrium position; sys NULL: the drawn position */
    bool sought;               /* for that, found or not */
    double *mu;                /* constraint forces of the modes (mt_modal_sparse) */
    char why[MT_LOWEST_WHY];   /* why no method applies */
    double mass_kg;
    int equations; /* of joints, possibly dependent; 0: a tree */
    mt_lowest_modes found;
    double *at;                            /* [inputs of sys] */
    struct mt_lowest_operation *operation; /* operator for Lanczos' method */
} mt_lowest;

/* From this number of bodies on this method is used where only the lowest modes are wanted: all
 * modes of 200 bodies take a second. */
enum { MT_LOWEST_BODIES = 100 };

/* Approximate number of bodies of a configuration. */
double mt_lowest_bodies(const mt_model *model, int configuration);

/**
 * @param[out] out  owned by the caller (mt_lowest_delete); NULL on failure
 * Inputs as for mt_analysis_new. Fails: as mt_system_new, mt_tree_new, mt_absolute_new and
 * mt_modal_sparse (but its MT_E_NO_CONVERGENCE means that no method applies), the text naming
 * the configuration.
 */
mt_status mt_lowest_new(const mt_system_def *def, mt_lowest_want want, mt_lowest **out,
                        mt_err *err);
/* Equilibrium position under loads; NULL: the drawn position. */
const mt_state *mt_lowest_settled(const mt_lowest *l);
/* After shapes were wanted: shapes of the first n positions over all states (nq of the system),
 * unit mass, sign by mt_modal_fix_sign: phi nq x n, zeroed on entry. Fails: MT_E_INTERRUPTED,
 * MT_E_MEMORY. */
mt_status mt_lowest_shapes(mt_lowest *l, int n, double *phi, mt_err *err);
/* The same shapes at the channels: value n_channels x n. */
mt_status mt_lowest_sense(mt_lowest *l, int n, double *value, mt_err *err);
/**
 * Derivatives of the frequencies of the first n vibration modes by every input.
 * @param[out] hz_per_unit  n x n_inputs; repeated modes as in mt_analysis_sensitivity
 * @param[out] why          "", or why there are none, as mt_tree_slopes and
 *   mt_absolute_slopes
 * Fails: as these.
 */
mt_status mt_lowest_sensitivity(mt_lowest *l, int n, double *hz_per_unit, char why[MT_TREE_WHY],
                                mt_err *err);
/* Accepts NULL. */
void mt_lowest_delete(mt_lowest *l);

/*
 * Forces and motions of a large mechanism in the coordinates of its mode search: x and the
 * amplitudes a of its rigid-body modes, in which
 *     K = diag(H - s H A, 0),    M = diag(H A, I).
 * For a tree H is the identity, s is 0, and A costs O(bodies). Otherwise H = K + s M of the
 * bodies, on the motions that the joints allow, and A = H^-1 M is one solve with its factor; s
 * is 0 where K itself is regular. Sizes are in the norm of H.
 */

/* Prepare, after mt_lowest_new with shapes. *is false: double precision does not resolve the
 * motions. Fails: as mt_sparse_solver_new. */
mt_status mt_lowest_open_forced(mt_lowest *l, bool *is, mt_err *err);
int mt_lowest_coordinates(const mt_lowest *l); /* number of x */
int mt_lowest_free(const mt_lowest *l);        /* number of a */
double mt_lowest_shift(const mt_lowest *l);    /* s [rad^2/s^2] */
/* x of vibration mode i, of arbitrary size. */
const double *mt_lowest_mode(const mt_lowest *l, int i);
/* H x, in work[coordinates] or x itself. */
const double *mt_lowest_dual(const mt_lowest *l, const double *x, double *work);

/* The response of x and a to a force. */
typedef struct mt_lowest_push {
    double *x;    /* [coordinates] H^-1 times the force */
    double *dual; /* [coordinates] the force by its work on x; NULL: equal to x */
    double *a;    /* [free] */
    double size;  /* |x| before the part of the rigid-body modes is subtracted */
    double noise; /* rounding of x in the norm of H, and of its products with modes */
    double loose; /* rounding of a */
} mt_lowest_push;

/* Allocate the arrays in mem; the arena notes a shortage. */
void mt_lowest_push_init(const mt_lowest *l, mt_arena *mem, mt_lowest_push *p);
/* Of the force[nq] on all states. Fails: MT_E_INTERRUPTED. */
mt_status mt_lowest_force(const mt_lowest *l, const double *force, mt_lowest_push *p,
                          mt_err *err);
/* x := its projection, in the norm of H, on the motions that the joints allow, without
 * rigid-body modes: differences of large motions may leave them by rounding. */
mt_status mt_lowest_admit(const mt_lowest *l, double *x, mt_err *err);
/* y := A x. Fails: MT_E_INTERRUPTED. */
mt_status mt_lowest_mass(const mt_lowest *l, const double *x, double *y, mt_err *err);
/* y := H A x. */
mt_status mt_lowest_momentum(const mt_lowest *l, const double *x, double *y, mt_err *err);

/* Work arrays of the tree method. */
struct mt_lowest_operation {
    const mt_tree *tree;
    bool told;     /* progress is reported */
    double *v;     /* motion of all bodies */
    double *f;     /* work */
    double *r;     /* [n_rigid] */
    double *along; /* [n_rigid] rigid-body motion that follows x */
    double *left;  /* [n_rigid] work */
    double *m_yr;  /* n_x x n_rigid */
    double *m_rr;  /* its Cholesky factor */
    mt_arena *scratch;
};

#endif
