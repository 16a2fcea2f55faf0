/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANALYSIS_ANALYSIS_H
#define ANALYSIS_ANALYSIS_H

#include "mechanics/linear.h"
#include "modal/modal.h"

/*
 * Modes of one configuration as functions of the inputs: mechanics and modal put together, with
 * all memory kept between calls. One analysis, one worker.
 *
 * How vibration modes are counted. A design has as many rigid-body modes as K has null
 * directions, and where a stiffness reaches 0 it may gain one. Were that one left out of the
 * count there, every index, and every number of modes below a frequency, would jump. So a
 * family of designs (those of a study) is counted with ONE number: the least number of null
 * directions that any of them has, which almost all of them have (mt_count_box). The others
 * have vibration modes of 0 Hz. Then indices and counts are continuous over the family.
 */
typedef struct mt_analysis {
    const mt_system *sys;
    mt_system *own_sys; /* owned; NULL: sys is that of another analysis */
    mt_linear *lin;     /* owned */
    mt_arena mass_mem;
    mt_arena mem;              /* of the last solve */
    mt_arena_mark after_modes; /* in mem */
    mt_mass_factor mass;
    unsigned long mass_version; /* of the factor; 0: none */
    mt_modes modes;
    struct mt_modes_key { /* what they were made of */
        unsigned long stiffness_version;
        unsigned long mass_version;
        int n_rigid; /* as it was asked for */
        mt_modal_part modes;
        mt_modal_part shapes;
        bool recount;
        bool vectors;
        double accuracy;
        bool check;
        bool bounds;
    } key;
    /* rigid-body modes that are counted: those at the first design, unless mt_analysis_count
     * said otherwise; -1 before */
    int n_rigid;
    int n_null; /* null directions at the first design itself */
    /* modes that a design has at most, rigid-body ones included: a direction whose mass reaches
     * 0 loses its mode, the highest, to infinity */
    int n_most;
    /* where fewer directions are free than n_rigid says, count that design by itself; else that
     * is MT_E_DOMAIN */
    bool recount;
    /* the matrices alone were not enough at the first design: some stiffness lies far above the
     * lowest modes */
    bool graded;
    bool with_gradient;
    double *dky; /* work, n x n_inputs, after a solve with gradient */
    double *dmy;
    /* n_inputs x modes: derivatives of the eigenvalues that were asked for since that solve */
    double *slopes;
    bool *sloped; /* [modes] which of them were */
    mt_arena first_mem;
    /* [damping.n_named of sys] weighed shapes at the first design of the modes that damping
     * ratios name; NULL where there is no such mode */
    const double **named_shape;
    mt_arena damping_mem;
    struct mt_damping_work *damping; /* of the last solve (damping.c); NULL: not asked for */
    long solves;
} mt_analysis;

typedef struct mt_analysis_options {
    mt_modal_part modes;  /* which are asked for */
    mt_modal_part shapes; /* of which shapes and slopes are, or frequencies to the last digit */
    bool gradient;        /* derivatives will be asked for (vectors come with them) */
    bool vectors;         /* shapes will be asked for */
    double accuracy;      /* mt_modal_options */
    bool check;           /* residual and orthogonality of each mode */
    /* the error of each mode is asked for (with vectors): without this it leaves out what
     * rounding has made of the rows that K and M are sums of, which counts next to dead centres
     * and where joints almost depend on each other */
    bool bounds;
} mt_analysis_options;
/* Vectors, accuracy, check and bounds; no gradient. */
mt_analysis_options mt_analysis_options_default(void);

/* More bodies than this are not analysed as a whole: the matrices alone take gigabytes. */
enum { MT_ANALYSIS_BODIES = 5000 };

/*
 * Make the system of a configuration and solve it once, with default options, at the original
 * design at[n_inputs], which fixes the number of rigid-body modes (see mt_analysis_count) and
 * every discrete choice (helper axes, the model's length). The model must outlive the analysis;
 * *out is the caller's. Fails as mt_system_new, mt_linear_update and mt_modal_solve, the text
 * naming the configuration; MT_E_MASSLESS names the bodies that nothing holds. A configuration
 * with unstable modes is no failure. MT_E_INPUT: it has too many bodies.
 */
mt_status mt_analysis_new(const mt_model *model, int configuration, int n_inputs,
                          const int *inputs, const double *at, mt_analysis **out, mt_err *err);
/* The same within a run, with a drive (mt_system_new_of). first > 0: only the `first` lowest
 * vibration modes are computed (mt_analysis_options), for an analysis that is solved once; 0:
 * all. */
mt_status mt_analysis_new_of(const mt_system_def *def, int first, mt_analysis **out,
                             mt_err *err);
/* Another one of the same system, which `like` lends: it has to outlive this one. Solved at
 * at[n_inputs], too, and counted as that design is alone. Any number of workers may share a
 * system. Fails as mt_linear_update and mt_modal_solve, MT_E_MEMORY. */
mt_status mt_analysis_new_like(const mt_analysis *like, const double *at, mt_analysis **out,
                               mt_err *err);
/* Accepts NULL. */
void mt_analysis_delete(mt_analysis *a);
/* Modes at inputs[n_inputs] [the parameters' units] into a->modes, valid until the next call;
 * opt is required. Nothing is done again that would give the same bits (base/profile.h): where
 * no input moved that K and M depend on, a->modes stay. O(n^3); no heap after the first calls.
 * Fails as above and with MT_E_DOMAIN
 * where stiffness holds a direction that is counted as free (unless a->recount); then a->modes
 * is void. */
mt_status mt_analysis_solve(mt_analysis *a, const double *inputs,
                            const mt_analysis_options *opt, mt_err *err);
/*
 * After a solve with gradient, of the mode at position pos of a->modes [rad^2/s^2 per unit of
 * the input], dlambda[n_inputs]: its derivative; NaN, and *repeated (may be NULL), where it
 * belongs to a cluster, which has none for a single mode. Fails: MT_E_INTERNAL (no gradient, or
 * its shape was not asked for), as mt_linear_products.
 */
mt_status mt_analysis_dlambda(mt_analysis *a, int pos, double *dlambda, bool *repeated,
                              mt_err *err);
/* y^T (dK - lambda dM) y whatever its neighbours: not a derivative where the mode is repeated,
 * but its mean over a cluster is that of the mean. */
mt_status mt_analysis_dlambda_raw(mt_analysis *a, int pos, double *dlambda, mt_err *err);
/* After a solve with gradient: a->dky, a->dmy := dK y, dM y for every input, y the mode at
 * pos. */
mt_status mt_analysis_products(mt_analysis *a, int pos, mt_err *err);
/*
 * Shape of the mode at position pos at channels channel[ns] of the system: s[ns] [a length or
 * an angle, mass-normalised: per sqrt(kg) of modal mass]. ds (may be NULL): ns x n_inputs, its
 * derivatives with the sign held, after a solve with gradient. Fails: MT_E_SINGULAR (ds of a
 * repeated mode), MT_E_MEMORY, MT_E_INTERNAL.
 */
mt_status mt_analysis_shape(mt_analysis *a, int pos, int ns, const int *channel, double *s,
                            double *ds, mt_err *err);
/* The configuration's name, as long as the model lives. */
const char *mt_analysis_configuration(const mt_analysis *a);

#endif
