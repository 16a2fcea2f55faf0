/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The way out of the infinite: undamped poles within [lower, upper] leave it by their nearer
 * end, or are damped. */
#include <math.h>

#include "analysis/damping.h"
#include "problem/forced_response.h"
#include "problem/goal_frequency.h"

/* ln of what the infinite is off by, above MT_MOST_INSIDE: no damping that counts for a search
 * leaves a resonance that much above its limit. */
static const double BEYOND = 16.0;
/* A damping ratio of this is worth as much as leaving the range by a factor of e. */
static const double DAMPED = 1e-3;
/* An undamped pole is a mode that dampers do not touch: the same frequency, to rounding. */
static const double SAME = 1e-9;

static const double TWO_PI = 6.283185307179586476925;

/* Adds the slope of the damping ratio of the mode at omega with the variables, where it has
 * none. */
static mt_status add_damping(mt_workspace *w, mt_analysis *a, double omega, double *slope,
                             mt_err *err)
{
    const mt_damped_modes *damped = NULL;
    bool repeated = false;
    mt_err own = {.code = MT_OK};
    mt_status rc = mt_analysis_damped(a, &damped, &own);
    for (int i = 0; rc == MT_OK && i < damped->count; i++) {
        if (damped->kind[i] == MT_DAMPED_OSCILLATING &&
            fabs(damped->im[i] - omega) <= SAME * omega &&
            fabs(damped->re[i]) <= SAME * omega) {
            rc = mt_analysis_dpole(a, i, w->work, w->dshape, &repeated, &own);
            for (int k = 0; k < w->p->n && rc == MT_OK && !repeated; k++) {
                slope[k] += mt_workspace_dx_dt(w, k) * w->work[k] / (omega * DAMPED);
            }
            break;
        }
    }
    return mt_pass_final(rc, &own, err);
}

mt_status mt_forced_response_lead(mt_workspace *w, const mt_requirement *d, double lower,
                                  double upper, double *slope, mt_err *err)
{
    mt_analysis *const a = w->views[d->view].analysis;
    const mt_modes *const modes = &a->modes;
    int nearest = -1;
    double least = HUGE_VAL;
    double sign = 0.0;
    for (int i = 0; i < modes->count; i++) {
        const double omega = TWO_PI * mt_modal_hz(modes, i);
        if (modes->kind[i] != MT_MODE_FLEXIBLE || !(omega >= lower && omega <= upper)) {
            continue;
        }
        const double down = log(omega / lower);
        const double up = log(upper / omega);
        if (fmin(down, up) < least) {
            least = fmin(down, up);
            nearest = i;
            sign = down < up ? 1.0 : -1.0;
        }
    }
    w->beyond = BEYOND + (nearest < 0 ? 0.0 : least);
    for (int k = 0; k < w->p->n && slope != NULL; k++) {
        slope[k] = 0.0;
    }
    if (nearest < 0 || slope == NULL) {
        return MT_OK;
    }
    MT_TRY(mt_problem_dln_frequency(w, a, nearest, 0.0, slope, err));
    for (int k = 0; k < w->p->n; k++) {
        slope[k] *= sign;
    }
    return add_damping(w, a, TWO_PI * mt_modal_hz(modes, nearest), slope, err);
}
