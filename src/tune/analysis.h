/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TUNE_ANALYSIS_H
#define TUNE_ANALYSIS_H

#include "mechanics/linear.h"
#include "modal/modal.h"

/*
 * Modes of one configuration as functions of the inputs: mechanics and modal put together, with all memory kept between calls. One analysis, one worker.
 */
typedef struct mt_analysis {
    mt_system *sys; /* owned */
    mt_linear *lin; /* owned */
    mt_arena mass_mem;
    mt_arena mem; /* of the last solve */
    mt_mass_factor mass;
    unsigned long mass_version; /* of the factor; 0: none */
    mt_modes modes;
    int n_rigid; /* fixed at the original design by mt_analysis_new; -1 before */
    bool with_gradient;
    double *dky; /* work, n x n_inputs */
    double *dmy;
    long solves;
} mt_analysis;

typedef struct mt_analysis_options {
    bool gradient; /* derivatives will be asked for */
    bool vectors;
    bool accuracy; /* use the stiffness factor where the plain method would lose digits */
    bool check;    /* residual and orthogonality of each mode */
} mt_analysis_options;
mt_analysis_options mt_analysis_options_default(
    void); /* vectors, accuracy, check; no gradient */

/* Make the system of a configuration and solve it once at the original design at[n_inputs] (which fixes the number of rigid-body modes).
 * The model must outlive the analysis. Fails as mt_system_new, mt_linear_update, mt_modal_solve; texts name the configuration. */
mt_status mt_analysis_new(const mt_model *model, int configuration, int n_inputs,
                          const int *inputs, const double *at, mt_analysis **out, mt_err *err);
/* The same with a drive whose position is one more input, the last (mt_system_new_driven): at[n_inputs + 1]. drive NULL: mt_analysis_new. */
mt_status mt_analysis_new_driven(const mt_model *model, int configuration,
                                 const mt_system_drive *drive, int n_inputs, const int *inputs,
                                 const double *at, mt_analysis **out, mt_err *err);
void mt_analysis_delete(mt_analysis *a);
/* Modes at inputs[n_inputs] (a->modes, valid until the next call). */
mt_status mt_analysis_solve(mt_analysis *a, const double *inputs,
                            const mt_analysis_options *opt, mt_err *err);
/* dlambda[n_inputs] of the mode at position pos of a->modes; NaN and *repeated (may be NULL) where it belongs to a cluster. After a solve with gradient. */
mt_status mt_analysis_dlambda(mt_analysis *a, int pos, double *dlambda, bool *repeated,
                              mt_err *err);
/* y^T (dK - lambda dM) y of the mode at pos whatever its neighbours: not a derivative where the mode is repeated, but its mean over a cluster is that of the mean. */
mt_status mt_analysis_dlambda_raw(mt_analysis *a, int pos, double *dlambda, mt_err *err);
/* Shape of the mode at position pos at channels: s[ns]; ds (may be NULL; needs gradient and a simple mode): ns x n_inputs. Mass-normalised, sign of the vector held. */
mt_status mt_analysis_shape(mt_analysis *a, int pos, int ns, const int *channel, double *s,
                            double *ds, mt_err *err);
/* Name of a massless direction etc. are in err's text already. */
const char *mt_analysis_configuration(const mt_analysis *a);

#endif
