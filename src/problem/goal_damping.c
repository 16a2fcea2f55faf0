/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * "damping": q = the damping ratio of a complex mode, zeta = -sigma/|s| of s = sigma + i omega,
 *     dzeta = omega (sigma domega - omega dsigma) / |s|^3
 * An index counts the oscillating motions by |s|; a name means the one that has most of the
 * undamped mode in its shape.
 */
#include <math.h>

#include "analysis/damping.h"
#include "problem/goal.h"

static mt_status find_damped_mode(mt_workspace *w, const mt_requirement *d, int pos, int *at,
                                  mt_err *err)
{
    mt_analysis *const a = w->views[d->view].analysis;
    const mt_damped_modes *damped = NULL;
    MT_TRY(mt_analysis_damped(a, &damped, err));
    *at = mt_damped_oscillating(damped, d->mode > 0 ? d->mode : 1);
    if (d->mode == 0 && *at >= 0) {
        MT_TRY(mt_analysis_damped_of(a, pos, at, err));
    }
    return *at >= 0 ? MT_OK
                    : mt_fail(err, MT_E_DOMAIN,
                              "configuration \"%s\" has no such motion that oscillates: it is "
                              "overdamped, or another is unstable",
                              mt_analysis_configuration(a));
}

static mt_status evaluate_damping(mt_workspace *w, const mt_requirement *d, int pos, double *q,
                                  double *slope, mt_err *err)
{
    mt_analysis *const a = w->views[d->view].analysis;
    const mt_damped_modes *damped = NULL;
    bool repeated = false;
    int at = -1;
    MT_TRY(find_damped_mode(w, d, pos, &at, err));
    MT_TRY(mt_analysis_damped(a, &damped, err));
    *q = mt_damped_ratio(damped, at);
    if (slope == NULL) {
        return MT_OK;
    }
    MT_TRY(mt_analysis_dpole(a, at, slope, w->work, &repeated, err));
    if (repeated) {
        return mt_fail(err, MT_E_SINGULAR,
                       "configuration \"%s\": two motions have one root, which has no slope",
                       mt_analysis_configuration(a));
    }
    const double re = damped->re[at];
    const double im = damped->im[at];
    const double size = hypot(re, im);
    for (int k = 0; k < w->p->n; k++) {
        const double turn = ((re / size) * w->work[k]) - ((im / size) * slope[k]);
        slope[k] = mt_workspace_dx_dt(w, k) * (im / size) * turn / size;
    }
    return MT_OK;
}

static const char *damping_subject(const mt_requirement *d, const char *what, mt_arena *mem)
{
    (void)d;
    return mt_arena_printf(mem, "%s: damping ratio", what);
}

const mt_goal_ops mt_goal_damping = {.quantity = MT_QUANTITY_OTHER,
                                     .needs_vectors = true,
                                     .value = evaluate_damping,
                                     .subject = damping_subject,
                                     .number = "damping ratio",
                                     .equals = "at"};
