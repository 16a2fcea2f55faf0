/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SIMULATE_ODE_H
#define SIMULATE_ODE_H

#include "base/base.h"

/*
 * Steps of an ordinary differential equation y' = f(t, y): Prince and Dormand's explicit
 * Runge-Kutta pair of the orders eight and seven, thirteen evaluations a step (GSL's).
 */
typedef struct mt_ode mt_ode;

/* out[n] = f(t, y[n]). What it fails with ends the step and is what the step fails with. */
typedef mt_status (*mt_ode_slope)(void *context, double t, const double *y, double *out,
                                  mt_err *err);

enum { MT_ODE_ORDER = 8 };

/* *out is the caller's. Fails: MT_E_MEMORY; unless the process has turned off GSL's way with
 * errors (gsl_set_error_handler_off, which is a program's choice), GSL then ends it. */
mt_status mt_ode_new(int n, mt_ode_slope slope, void *context, mt_ode **out, mt_err *err);
void mt_ode_delete(mt_ode *ode); /* accepts NULL */
/* y[n] at t becomes y at t + h; error[n]: the difference of the two orders. slope_in[n]: f(t,
 * y), known. Where it fails y is as it was. No heap. Fails as f; MT_E_DOMAIN: a number is not
 * finite. */
mt_status mt_ode_step(mt_ode *ode, double t, double h, double *y, const double *slope_in,
                      double *error, mt_err *err);

#endif
