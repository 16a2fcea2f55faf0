/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Kinds and clusters of computed eigenvalues. */
#include "modal/modal_priv.h"

#include <float.h>
#include <math.h>

/*
 * Neighbours closer than CLUSTER_GAP of their size are one cluster. The eigenvector of a single
 * mode, and with it any gradient that uses it, describes the system for relative parameter
 * changes up to about the gap only; sqrt(eps) is the smallest step that a search with 16 digits
 * can make and judge, so a gap below that is a repeated mode to every user of these numbers.
 * Mirror modes of a symmetrical structure agree to rounding, 1e-14 or so; distinct modes as
 * close as this have not been met. Eigenvalues that differ by less than their error bound
 * cannot be told apart either.
 */
static const double CLUSTER_GAP = 1.5e-8;

/* First of the n_rigid consecutive values with the smallest magnitudes (lambda ascends, so they
 * are consecutive). */
static int first_rigid(const mt_modes *modes, int n_rigid)
{
    int first = 0;
    while (first + n_rigid < modes->count &&
           fabs(modes->lambda[first + n_rigid]) < fabs(modes->lambda[first])) {
        first++;
    }
    return first;
}

static mt_mode_kind kind_of_mode(double lambda, double noise, bool strained, bool decide)
{
    if (lambda < -noise) {
        return MT_MODE_UNSTABLE;
    }
    if (lambda <= noise && strained) {
        return MT_MODE_UNDECIDED;
    }
    return decide && lambda <= noise ? MT_MODE_RIGID_BODY : MT_MODE_FLEXIBLE;
}

double mt_modal_classify(mt_modes *modes, int n_rigid, const double *noise,
                         const bool *strained)
{
    double rigid_most = 0.0;
    const bool decide = n_rigid < 0;
    const int rigid = decide || n_rigid <= modes->count ? n_rigid : modes->count;
    const int first = decide ? modes->count : first_rigid(modes, rigid);
    modes->n_rigid = 0;
    modes->n_held = 0;
    modes->n_undecided = 0;
    modes->n_unstable = modes->n_unstable_condensed;
    for (int i = 0; i < modes->count; i++) {
        const double zero = noise == NULL ? modes->error_bound : noise[i];
        const bool moves = strained != NULL && strained[i];
        const bool given = !decide && i >= first && i < first + rigid;
        const mt_mode_kind kind =
            given ? MT_MODE_RIGID_BODY : kind_of_mode(modes->lambda[i], zero, moves, decide);
        modes->kind[i] = kind;
        modes->n_rigid += kind == MT_MODE_RIGID_BODY ? 1 : 0;
        if (given) {
            rigid_most = fmax(rigid_most, fabs(modes->lambda[i]));
            modes->n_held += fabs(modes->lambda[i]) > zero ? 1 : 0;
        }
        modes->n_unstable += kind == MT_MODE_UNSTABLE ? 1 : 0;
        modes->n_undecided += kind == MT_MODE_UNDECIDED ? 1 : 0;
        if (kind == MT_MODE_RIGID_BODY ||
            (kind == MT_MODE_FLEXIBLE && modes->lambda[i] < 0.0)) {
            modes->lambda[i] = 0.0;
        }
    }
    return rigid_most;
}

void mt_modal_find_clusters(mt_modes *modes)
{
    int number = 0;
    for (int i = 0; i < modes->count; i++) {
        if (i > 0) {
            const double a = modes->lambda[i - 1];
            const double b = modes->lambda[i];
            const double noise =
                fmin(modes->error_bound, fmax(modes->error[i - 1], modes->error[i]));
            const double tol = CLUSTER_GAP * fmax(fabs(a), fabs(b)) + noise;
            number += b - a <= tol ? 0 : 1;
        }
        modes->cluster[i] = number;
    }
}
