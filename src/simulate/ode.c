/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "simulate/ode.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/arena.h"

struct mt_ode {
    int n;
    mt_ode_slope slope;
    void *context;
    gsl_odeiv2_step *step;
    gsl_odeiv2_system system;
    double *before; /* [n] */
    mt_status rc;   /* of the last evaluation that failed */
    mt_err *err;
};

static int evaluate_slope(double t, const double y[], double out[], void *context)
{
    mt_ode *const ode = context;
    ode->rc = ode->slope(ode->context, t, y, out, ode->err);
    return ode->rc == MT_OK ? GSL_SUCCESS : GSL_EBADFUNC;
}

mt_status mt_ode_new(int n, mt_ode_slope slope, void *context, mt_ode **out, mt_err *err)
{
    mt_ode *const ode = calloc(1, sizeof *ode);
    *out = NULL;
    if (ode == NULL) {
        return mt_fail_memory(err);
    }
    ode->n = n;
    ode->slope = slope;
    ode->context = context;
    ode->before = calloc((size_t)n, sizeof *ode->before);
    ode->step = gsl_odeiv2_step_alloc(gsl_odeiv2_step_rk8pd, (size_t)n);
    ode->system = (gsl_odeiv2_system){evaluate_slope, NULL, (size_t)n, ode};
    if (ode->before == NULL || ode->step == NULL) {
        mt_ode_delete(ode);
        return mt_fail_memory(err);
    }
    *out = ode;
    return MT_OK;
}

void mt_ode_delete(mt_ode *ode)
{
    if (ode != NULL) {
        if (ode->step != NULL) {
            gsl_odeiv2_step_free(ode->step);
        }
        free(ode->before);
        free(ode);
    }
}

static bool all_finite(int n, const double *x)
{
    bool finite = true;
    for (int i = 0; i < n; i++) {
        finite = finite && isfinite(x[i]);
    }
    return finite;
}

mt_status mt_ode_step(mt_ode *ode, double t, double h, double *y, const double *slope_in,
                      double *error, mt_err *err)
{
    const size_t size = (size_t)ode->n * sizeof *y;
    memcpy(ode->before, y, size);
    ode->rc = MT_OK;
    ode->err = err;
    const int status =
        gsl_odeiv2_step_apply(ode->step, t, h, y, error, slope_in, NULL, &ode->system);
    ode->err = NULL;
    if (status == GSL_SUCCESS && all_finite(ode->n, y) && all_finite(ode->n, error)) {
        return MT_OK;
    }
    memcpy(y, ode->before, size);
    return ode->rc != MT_OK ? ode->rc
                            : mt_fail(err, MT_E_DOMAIN, "the motion has no finite value");
}
