/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Quotients of energies. A solve with matrices returns shapes whose residual is at most r_i
 * (its backward error); the eigenvalue that goes with a shape is then known to r_i, but the
 * quotient
 *     rho_i = y^T K y / y^T M y
 * is known to r_i^2 / gap_i, gap_i being the distance to the other eigenvalues: an error of the
 * shape enters twice. What remains is the rounding of the quotient itself, and that is small
 * where it is summed term by term, for there no stiff spring meets a soft one before its (tiny)
 * elongation is squared. Shapes are known to p eps at best, which stiff springs of the scale s
 * answer with (p eps)^2 s.
 */
#include "modal/judge.h"

#include "modal/modal_priv.h"

#include <float.h>
#include <math.h>

#include "linalg/dense.h"

/* An error below this part of lambda is nobody's concern: results are promised to that. */
static const double FINE = 1e-9;
/* p of the above. */
static const double SHAPE_ULPS = 16.0;

/* Distance of lambda_i to its neighbours beyond their errors; at most 0: one of them may be the
 * same. */
static double gap_of(const mt_modes *modes, int i)
{
    double gap = HUGE_VAL;
    for (int side = -1; side <= 1; side += 2) {
        const int k = i + side;
        if (k >= 0 && k < modes->all) {
            const double far = fabs(modes->lambda[k] - modes->lambda[i]);
            gap = fmin(gap, far - modes->error[k] - modes->error[i]);
        }
    }
    return gap;
}

typedef struct verdict {
    double lambda;
    double error;
} verdict;

static verdict quotient(const mt_modes *modes, const mt_mode_energies *e, int i)
{
    const double lambda = e->stiffness[i] / e->mass[i];
    const double r = modes->error[i];
    const double gap = gap_of(modes, i);
    const double shape = SHAPE_ULPS * DBL_EPSILON;
    const double noise = (e->stiffness_noise[i] + fabs(lambda) * e->mass_noise[i]) / e->mass[i];
    const double mixed = gap > r ? r * (r / gap) : r;
    return (verdict){.lambda = lambda, .error = noise + mixed + shape * shape * modes->scale};
}

static void swap(double *a, double *b)
{
    const double keep = *a;
    *a = *b;
    *b = keep;
}

/* Quotients of neighbours may pass each other, and so may a mode that becomes a rigid body's,
 * at 0, and one before it that is undecided. */
static void sort(mt_modes *modes, bool *strained)
{
    for (int i = 1; i < modes->count; i++) {
        for (int k = i; k > 0 && modes->lambda[k] < modes->lambda[k - 1]; k--) {
            const bool keep = strained[k];
            strained[k] = strained[k - 1];
            strained[k - 1] = keep;
            const mt_mode_kind kind = modes->kind[k];
            modes->kind[k] = modes->kind[k - 1];
            modes->kind[k - 1] = kind;
            swap(&modes->lambda[k], &modes->lambda[k - 1]);
            swap(&modes->error[k], &modes->error[k - 1]);
            if (modes->residual != NULL) {
                swap(&modes->residual[k], &modes->residual[k - 1]);
                swap(&modes->orthogonality[k], &modes->orthogonality[k - 1]);
            }
            for (int j = 0; j < modes->n; j++) {
                double *const at = modes->y + j + (ptrdiff_t)k * modes->n;
                swap(at, at - modes->n);
            }
        }
    }
}

int mt_modal_doubtful(const mt_modes *modes)
{
    int count = 0;
    const bool exact = modes->from_factor && modes->error_bound == 0.0;
    for (int i = 0; i < modes->count; i++) {
        const bool doubt = modes->kind[i] == MT_MODE_FLEXIBLE
                               ? !(modes->error[i] < FINE * fabs(modes->lambda[i]))
                               : !exact;
        count = doubt ? i + 1 : count;
    }
    return count;
}

void mt_modal_judge(mt_mode_energies *e, int n_rigid, mt_modes *modes)
{
    const bool exact = modes->from_factor && modes->error_bound == 0.0;
    const int held = modes->n_held;
    for (int i = 0; i < e->count; i++) {
        modes->error[i] += e->given_noise[i] / e->mass[i];
    }
    for (int i = 0; i < e->count; i++) {
        const verdict v = quotient(modes, e, i);
        const bool surer = v.error < modes->error[i];
        e->stiffness[i] = surer ? v.lambda : modes->lambda[i];
        e->mass[i] = surer ? v.error : modes->error[i];
    }
    for (int i = 0; i < e->count; i++) {
        modes->lambda[i] = e->stiffness[i];
        modes->error[i] = e->mass[i];
    }
    for (int i = e->count; i < modes->count; i++) {
        e->strained[i] = true;
    }
    sort(modes, e->strained);
    for (int i = 0; i < modes->count; i++) {
        e->mass[i] = fabs(modes->lambda[i]);
    }
    if (exact) { /* the rank has decided */
        (void)mt_modal_classify(modes, modes->n_rigid, NULL, NULL);
    } else {
        (void)mt_modal_classify(modes, n_rigid, modes->error, e->strained);
    }
    modes->n_held = 0;
    for (int i = 0; i < modes->count; i++) {
        const bool rigid = n_rigid >= 0 && modes->kind[i] == MT_MODE_RIGID_BODY;
        modes->error[i] += modes->lambda[i] == 0.0 ? e->mass[i] : 0.0;
        modes->n_held += rigid && e->mass[i] > MT_MODAL_HELD * modes->error[i] ? 1 : 0;
    }
    modes->n_held = exact ? held : modes->n_held;
    sort(modes, e->strained);
    mt_modal_find_clusters(modes);
}
