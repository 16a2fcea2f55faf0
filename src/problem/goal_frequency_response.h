/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_GOAL_FREQUENCY_RESPONSE_H
#define PROBLEM_GOAL_FREQUENCY_RESPONSE_H

#include <complex.h>

#include "problem/workspace.h"
#include "response/response.h"

/* A measured response that a model's is compared with: the lines within the goal's band. */
typedef struct mt_fit {
    mt_port_set ports; /* one input, one output, of the view's system */
    const mt_measured_response *measured;
    int n;
    double *w;         /* [n] [rad/s] */
    double complex *h; /* [n] measured, in SI; not 0 */
    double *level;     /* [n] ln |h| */
    double *phase;     /* [n] arg h [rad] */
    double *share;     /* [n] of the goal's weight; sum 1 */
    int *line;         /* [n] of the file */
} mt_fit;

/* True where it is such a requirement; then its line of the greatest residual at the last
 * evaluation: its frequency [Hz], and ln(H/H_measured) there. NaN where it has no value. */
bool mt_fit_worst(const mt_workspace *w, const mt_requirement *d, double *hz,
                  double complex *off);

/* By how much [rad] the measured phase rises through its highest peak, and the peak's frequency
 * [Hz], where it rises: of a damped mechanism it falls, so that the data look conjugated. 0:
 * it falls, or there is no peak that lines resolve. */
double mt_fit_rise(const mt_requirement *d, double *hz);

/* True where the squares of the phases' residuals at the last evaluation would be less than
 * half if the measured response had the other sign. Lines between a peak and the model's speak
 * against it, at both signs. */
bool mt_fit_is_reversed(const mt_workspace *w, const mt_requirement *d);

#endif
