/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANALYSIS_ANALYSIS_H
#define ANALYSIS_ANALYSIS_H

#include "mechanics/linear.h"
#include "mechanics/products.h"
#include "modal/modal.h"

/*
 * Modes of one configuration as functions of the inputs: combines mechanics and modal; all
 * memory is kept between calls. One analysis per worker.
 *
 * Counting of vibration modes. A design has as many rigid-body modes as K has null directions,
 * and gains one where a stiffness reaches 0. If that design were counted by itself, every index
 * and every number of modes below a frequency would jump. So a family of designs (those of a
 * study) is counted with ONE number: the least number of null directions of any of its designs,
 * which almost all of them have (mt_count_box). Designs with more have vibration modes of 0 Hz.
 * Indices and counts are then continuous over the family.
 */
typedef struct mt_analysis {
    const mt_system *sys;
    mt_system *own_sys; /* owned; NULL: sys belongs to another analysis */
    mt_linear *lin;     /* owned */
    mt_arena mass_mem;
    mt_arena mem;              /* of the last solve */
    mt_arena_mark after_modes; /* in mem */
    mt_mass_factor mass;
    unsigned long mass_version; /* of the factored mass; 0: none */
    mt_modes modes;
    struct mt_modes_key { /* versions and options that `modes` was solved with */
        unsigned long stiffness_version;
        unsigned long mass_version;
        int n_rigid; /* as requested */
        mt_modal_part modes;
        mt_modal_part shapes;
        bool recount;
        bool vectors;
        double accuracy;
        bool check;
        bool bounds;
    } key;
    /* number of rigid-body modes: that of the first design, unless mt_analysis_count changed
     * it; -1 before */
    int n_rigid;
    int n_null; /* null directions at the first design */
    /* greatest number of modes of a design, including rigid-body ones: a direction whose mass
     * reaches 0 loses its mode, the highest, to infinity */
    int n_most;
    /* where fewer directions are free than n_rigid, count that design by itself; otherwise that
     * is MT_E_DOMAIN */
    bool recount;
    /* the matrices alone were not accurate enough at the first design: some stiffness is far
     * above the lowest modes */
    bool graded;
    bool with_gradient;
    double *dky; /* work, n x n_inputs, after a solve with gradient */
    double *dmy;
    /* n_inputs x modes: derivatives of eigenvalues computed since that solve */
    double *slopes;
    bool *sloped; /* [modes] derivatives computed */
    mt_arena first_mem;
    /* [damping.n_named of sys] weighed shapes at the first design of the modes that damping
     * ratios name; NULL where there is no such mode */
    const double **named_shape;
    mt_arena damping_mem;
    struct mt_damping_work *damping; /* of the last solve (damping.c); NULL: not computed */
    long solves;
} mt_analysis;

typedef struct mt_analysis_options {
    mt_modal_part modes;  /* modes wanted */
    mt_modal_part shapes; /* those with shapes and slopes, or frequencies to the last digit */
    bool gradient;        /* derivatives are wanted (implies vectors) */
    bool vectors;         /* shapes are wanted */
    double accuracy;      /* mt_modal_options */
    bool check;           /* residual and orthogonality of each mode */
    /* the error of each mode is wanted (with vectors): otherwise it leaves out the rounding of
     * the rows that K and M are sums of, which matters near dead centres and where joints are
     * almost dependent */
    bool bounds;
} mt_analysis_options;
/* Vectors, check and bounds on, accuracy MT_MODAL_ACCURACY; no gradient. */
mt_analysis_options mt_analysis_options_default(void);

/* Configurations with more bodies are not analysed as a whole: the matrices alone take
 * gigabytes. */
enum { MT_ANALYSIS_BODIES = 5000 };

/*
 * Make the system of a configuration and solve it once, with default options, at the original
 * design at[n_inputs], which fixes the number of rigid-body modes (see mt_analysis_count) and
 * every discrete choice (helper axes, the model's length). The model must outlive the analysis;
 * *out is owned by the caller. Fails as mt_system_new, mt_linear_update and mt_modal_solve, the
 * text naming the configuration; MT_E_MASSLESS names the bodies that nothing holds. A
 * configuration with unstable modes is not a failure. MT_E_INPUT: too many bodies.
 */
mt_status mt_analysis_new(const mt_model *model, int configuration, int n_inputs,
                          const int *inputs, const double *at, mt_analysis **out, mt_err *err);
/* As mt_analysis_new within a run, with a drive (mt_system_new_of). first > 0: only the `first`
 * lowest vibration modes are computed (mt_analysis_options), for an analysis that is solved
 * once; 0: all. */
mt_status mt_analysis_new_of(const mt_system_def *def, int first, mt_analysis **out,
                             mt_err *err);
/* Another analysis of the system of `like`, which must outlive it. Solved at at[n_inputs] and
 * counted by that design alone. Any number of workers may share a system. Fails as
 * mt_linear_update and mt_modal_solve, MT_E_MEMORY. */
mt_status mt_analysis_new_like(const mt_analysis *like, const double *at, mt_analysis **out,
                               mt_err *err);
/* Accepts NULL. */
void mt_analysis_delete(mt_analysis *a);
/* Modes at inputs[n_inputs] [the parameters' units] into a->modes, valid until the next call;
 * opt is required. Stages with unchanged inputs are skipped (base/run.h): where no input of
 * K and M changed, a->modes is kept. O(n^3); no heap after the first calls. Fails as above and
 * with MT_E_DOMAIN where stiffness resists a direction that is counted as free (unless
 * a->recount); a->modes is then void. */
mt_status mt_analysis_solve(mt_analysis *a, const double *inputs,
                            const mt_analysis_options *opt, mt_err *err);
/*
 * After a solve with gradient: derivative of the eigenvalue at position pos of a->modes,
 * dlambda[n_inputs] [rad^2/s^2 per unit of the input]. NaN, and *repeated (may be NULL), for a
 * mode of a cluster, whose single modes have none. Fails: MT_E_INTERNAL (no gradient, or the
 * shape was not wanted), as mt_linear_products.
 */
mt_status mt_analysis_dlambda(mt_analysis *a, int pos, double *dlambda, bool *repeated,
                              mt_err *err);
/* y^T (dK - lambda dM) y for any mode: not a derivative where the mode is repeated, but its
 * mean over a cluster is the derivative of the cluster's mean. */
mt_status mt_analysis_dlambda_raw(mt_analysis *a, int pos, double *dlambda, mt_err *err);
/* After a solve with gradient: a->dky, a->dmy := dK y, dM y for every input, y the mode at
 * pos. */
mt_status mt_analysis_products(mt_analysis *a, int pos, mt_err *err);
/*
 * Shape of the mode at position pos at channels channel[ns] of the system: s[ns] [a length or
 * an angle, mass-normalised: per sqrt(kg) of modal mass]. ds (may be NULL): ns x n_inputs, its
 * derivatives with constant sign, after a solve with gradient. Fails: MT_E_SINGULAR (ds of a
 * repeated mode), MT_E_MEMORY, MT_E_INTERNAL.
 */
mt_status mt_analysis_shape(mt_analysis *a, int pos, int ns, const int *channel, double *s,
                            double *ds, mt_err *err);
/* The configuration's name, valid while the model exists. */
const char *mt_analysis_configuration(const mt_analysis *a);

/* Channels whose names two analyses share: their indices in each, in the order of a. */
typedef struct mt_common_channels {
    int n;
    int *a; /* [n] */
    int *b; /* [n] */
} mt_common_channels;

/* O(channels of a times those of b). Fails: MT_E_MEMORY. */
mt_status mt_analysis_common_channels(const mt_analysis *a, const mt_analysis *b, mt_arena *mem,
                                      mt_common_channels *out, mt_err *err);

/* Weights of channels with displacements and angles: 1, or the length [m] that turns an angle
 * into an arc, in mem; *scale is NULL where all are of one kind. Fails: MT_E_MEMORY. */
mt_status mt_channels_scale(const mt_system *sys, int n, const int *channels, double length,
                            mt_arena *mem, double **scale, mt_err *err);
/* Multiply the rows of shapes[n x columns] by scale; NULL: unchanged. */
void mt_channels_weigh(int n, const double *scale, int columns, double *shapes);

/**
 * Derivatives of the frequencies of vibration modes by input p, after a solve with gradient.
 * @param[in]  position  [n] of the first n flexible modes, ascending
 * @param[out] hz_per_unit [n] Hz per unit of the input. Repeated modes have no derivatives:
 *   directional values (eigenvalues of Y^T (dK - lambda dM) Y over the
 *   cluster), ascending. NaN where there is none: at 0 Hz, and by mt_linear_independence
 * @param[out] why  the joints that cause it; names are in mem
 * Scratch from mem. Fails: as mt_linear_products and mt_linear_independence, MT_E_MEMORY.
 */
mt_status mt_analysis_sensitivity(mt_analysis *a, int p, int n, const int *position,
                                  mt_arena *mem, double *hz_per_unit, mt_independence *why,
                                  mt_err *err);

#endif
