/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SIMULATE_ODE_H
#define SIMULATE_ODE_H

#include "base/base.h"

/*
 * Steps of an ordinary differential equation y' = f(t, y): Prince and Dormand's explicit
 * Runge-Kutta pair of the orders eight and seven, thirteen evaluations a step (GSL's).
 */
typedef struct mt_ode mt_ode;

/* out[n] = f(t, y[n]). Its failure ends the step, which fails with the same status. */
typedef mt_status (*mt_ode_slope)(void *context, double t, const double *y, double *out,
                                  mt_err *err);

enum { MT_ODE_ORDER = 8 };

/* *out is the caller's. Fails: MT_E_MEMORY, provided that the process has called
 * gsl_set_error_handler_off (a decision of the program); else GSL ends the process. */
mt_status mt_ode_new(int n, mt_ode_slope slope, void *context, mt_ode **out, mt_err *err);
void mt_ode_delete(mt_ode *ode); /* accepts NULL */
/* Replace y[n] at t by y at t + h; error[n]: the difference of the two orders; slope_in[n]: the
 * known f(t, y). On failure y is unchanged. No heap. Fails as f; MT_E_DOMAIN: a number is not
 * finite. */
mt_status mt_ode_step(mt_ode *ode, double t, double h, double *y, const double *slope_in,
                      double *error, mt_err *err);

#endif
