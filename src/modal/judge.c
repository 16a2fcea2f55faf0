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

/* Of the error of either, gaps below this leave less than three digits of r^2 / gap. */
static const double CLOSE = 1e3;
enum { GROUP = 8 };

/* Distance between neighbours beyond their errors; at most 0: they may be the same. */
static double gap_between(const mt_modes *modes, int i, int k)
{
    const double far = fabs(modes->lambda[k] - modes->lambda[i]);
    return far - modes->error[k] - modes->error[i];
}

static bool is_close(const mt_modes *modes, int i)
{
    return !(gap_between(modes, i, i + 1) > CLOSE * fmax(modes->error[i], modes->error[i + 1]));
}

int mt_modal_groups(const mt_modes *modes, int count, int *group)
{
    int pairs = 0;
    for (int i = 0, end; i < count; i = end) {
        for (end = i + 1; end < count && is_close(modes, end - 1); end++) {
        }
        const int size = end - i;
        for (int k = i; k < end; k++) {
            group[k] = size <= GROUP ? i : k;
        }
        pairs += size <= GROUP ? size * (size - 1) / 2 : 0;
    }
    return pairs;
}

void mt_modal_pair_shapes(const mt_modes *modes, int count, const int *group, double *y)
{
    const double half = sqrt(0.5);
    for (int i = 0; i < count; i++) {
        for (int k = i + 1; k < count && group[k] == group[i]; k++, y += modes->n) {
            for (int j = 0; j < modes->n; j++) {
                y[j] = half * (mt_modal_shape(modes, i)[j] + mt_modal_shape(modes, k)[j]);
            }
        }
    }
}

/* |y_i^T (K - lambda M) y_k| at most, from the shape of the pair at `pair`. */
static double coupling(const mt_mode_energies *e, double lambda, int i, int k, int pair)
{
    const double stiffness = e->stiffness[pair] - (0.5 * (e->stiffness[i] + e->stiffness[k]));
    const double mass = e->mass[pair] - (0.5 * (e->mass[i] + e->mass[k]));
    const double stiffness_noise =
        e->stiffness_noise[pair] + (0.5 * (e->stiffness_noise[i] + e->stiffness_noise[k]));
    const double mass_noise =
        e->mass_noise[pair] + (0.5 * (e->mass_noise[i] + e->mass_noise[k]));
    return fabs(stiffness - (lambda * mass)) + stiffness_noise + (fabs(lambda) * mass_noise);
}

/* lambda[end - first] of the modes first .. end - 1, whose pairs start at *pair; returns their
 * error. */
static double quotients(const mt_modes *modes, const mt_mode_energies *e, int first, int end,
                        int *pair, double *lambda)
{
    const double shape = SHAPE_ULPS * DBL_EPSILON;
    double coupled[GROUP] = {0.0};
    double noise = 0.0;
    double r = 0.0;
    double most = 0.0;
    for (int i = first; i < end; i++) {
        const double rho = e->stiffness[i] / e->mass[i];
        const double own =
            (e->stiffness_noise[i] + (fabs(rho) * e->mass_noise[i])) / e->mass[i];
        lambda[i - first] = rho;
        noise = fmax(noise, isfinite(rho + own) ? own : HUGE_VAL);
        r = fmax(r, modes->error[i]);
        for (int k = i + 1; k < end; k++, (*pair)++) {
            const double c = coupling(e, rho, i, k, *pair) / fmin(e->mass[i], e->mass[k]);
            coupled[i - first] += c;
            coupled[k - first] += c;
        }
    }
    for (int i = first; i < end; i++) {
        most = fmax(most, coupled[i - first]);
    }
    r *= sqrt(end - first);
    const double below = first > 0 ? gap_between(modes, first - 1, first) : HUGE_VAL;
    const double above = end < modes->all ? gap_between(modes, end - 1, end) : HUGE_VAL;
    const double gap = fmin(below, above);
    const double mixed = gap > r ? r * (r / gap) : r;
    return noise + most + mixed + shape * shape * modes->scale;
}

static void swap_numbers(double *a, double *b)
{
    const double keep = *a;
    *a = *b;
    *b = keep;
}

/* Quotients of neighbours may pass each other, and so may a mode that becomes a rigid body's,
 * at 0, and one before it that is undecided. */
static void sort_modes(mt_modes *modes, bool *strained)
{
    for (int i = 1; i < modes->count; i++) {
        for (int k = i; k > 0 && modes->lambda[k] < modes->lambda[k - 1]; k--) {
            const bool keep = strained[k];
            strained[k] = strained[k - 1];
            strained[k - 1] = keep;
            const mt_mode_kind kind = modes->kind[k];
            modes->kind[k] = modes->kind[k - 1];
            modes->kind[k - 1] = kind;
            swap_numbers(&modes->lambda[k], &modes->lambda[k - 1]);
            swap_numbers(&modes->error[k], &modes->error[k - 1]);
            if (modes->residual != NULL && k < modes->shaped) {
                swap_numbers(&modes->residual[k], &modes->residual[k - 1]);
                swap_numbers(&modes->orthogonality[k], &modes->orthogonality[k - 1]);
            }
            for (int j = 0; j < modes->n && k < modes->shaped; j++) {
                double *const at = modes->y + j + (ptrdiff_t)k * modes->n;
                swap_numbers(at, at - modes->n);
            }
        }
    }
}

int mt_modal_doubtful(const mt_modes *modes)
{
    int count = 0;
    const bool exact = modes->from_factor && modes->error_bound == 0.0;
    for (int i = 0; i < modes->count; i++) {
        const bool rough = modes->kind[i] == MT_MODE_FLEXIBLE
                               ? !(modes->error[i] < FINE * fabs(modes->lambda[i]))
                               : !exact;
        count = rough ? i + 1 : count;
    }
    return count;
}

bool mt_modal_rough(const mt_modes *modes)
{
    bool rough = false;
    for (int i = 0; i < modes->shaped; i++) {
        rough = rough || (modes->kind[i] == MT_MODE_FLEXIBLE &&
                          !(modes->error[i] < FINE * modes->lambda[i]));
    }
    return rough;
}

/* Take the quotients where they are more accurate, group by group, with the errors and gaps
 * before the change. */
static void take_quotients(mt_mode_energies *e, mt_modes *modes)
{
    for (int i = 0; i < e->count; i++) {
        modes->error[i] += e->given_noise[i] / e->mass[i];
    }
    for (int i = 0, end, pair = e->count; i < e->count; i = end) {
        double lambda[GROUP];
        for (end = i + 1; e->group != NULL && end < e->count && e->group[end] == i; end++) {
        }
        const double error = quotients(modes, e, i, end, &pair, lambda);
        for (int k = i; k < end; k++) {
            const bool surer = error < modes->error[k];
            e->stiffness[k] = surer ? lambda[k - i] : modes->lambda[k];
            e->mass[k] = surer ? error : modes->error[k];
        }
    }
    /* those that have no shape stay behind those that have one */
    const double next = modes->shaped < modes->count ? modes->lambda[modes->shaped] : HUGE_VAL;
    for (int i = 0; i < e->count; i++) {
        const double beyond = fmax(e->stiffness[i] - next, 0.0);
        modes->lambda[i] = beyond > 0.0 ? next : e->stiffness[i];
        modes->error[i] = e->mass[i] + beyond;
    }
}

void mt_modal_judge(mt_mode_energies *e, int n_rigid, mt_modes *modes)
{
    const bool exact = modes->from_factor && modes->error_bound == 0.0;
    const int held = modes->n_held;
    take_quotients(e, modes);
    for (int i = e->count; i < modes->count; i++) {
        e->strained[i] = true;
    }
    sort_modes(modes, e->strained);
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
    sort_modes(modes, e->strained);
    mt_modal_find_clusters(modes);
}
