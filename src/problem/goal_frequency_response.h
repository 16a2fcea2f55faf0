/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_GOAL_FREQUENCY_RESPONSE_H
#define PROBLEM_GOAL_FREQUENCY_RESPONSE_H

#include <complex.h>

#include "problem/workspace.h"
#include "response/response.h"

/* A measured response to be fitted: the lines within the goal's band. */
typedef struct mt_fit {
    mt_port_set ports; /* one input and one output, of the configuration's system */
    const mt_measured_response *measured;
    int n;
    double *w;         /* [n] [rad/s] */
    double complex *h; /* [n] measured, in SI; not 0 */
    double *level;     /* [n] ln |h| */
    double *phase;     /* [n] arg h [rad] */
    double *share;     /* [n] of the goal's weight; sum 1 */
    int *line;         /* [n] line in the file */
} mt_fit;

/* For a requirement with a fit (else false): frequency [Hz] of the line with the largest
 * residual at the last evaluation, and ln(H/H_measured) there. NaN where it has no value. */
bool mt_fit_worst(const mt_workspace *w, const mt_requirement *d, double *hz,
                  double complex *off);

/* Rise of the measured phase through its highest peak [rad], and the peak's frequency [Hz]. The
 * phase of a damped mechanism falls, so a rise means that the data are probably conjugated. 0:
 * it falls, or no peak is resolved by lines. */
double mt_fit_rise(const mt_requirement *d, double *hz);

/* True where the sum of squares of the phase residuals at the last evaluation would be less
 * than half with the opposite sign of the measured response. Lines between a measured peak and
 * the model's disagree with either sign. */
bool mt_fit_is_reversed(const mt_workspace *w, const mt_requirement *d);

#endif
