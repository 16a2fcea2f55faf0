/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Are these derivatives those of that function? A single step cannot tell a wrong derivative
 * from a bad step; the order of agreement can. With the central difference
 *     D(h) = (f(x + h) - f(x - h)) / 2h = f'(x) + f'''(x) h^2 / 6 + O(h^4) + O(eps |f| / h)
 * the error against the true slope falls by 4 from h to h/2, down to rounding; against a slope
 * that is wrong by d it stays at d.
 */
#ifndef MT_SLOPE_H
#define MT_SLOPE_H

#include <stdbool.h>

/* f(x) of n unknowns; what it needs besides is in ctx. May return NaN: then the check fails. */
typedef double mt_slope_function(const void *ctx, int n, const double *x);

/**
 * Is slope the partial derivative of f to x[i] at x?
 * @param[in]     f, ctx  the function
 * @param[in]     n       number of unknowns, x of that length
 * @param[in,out] x       changed at entry i during the call, and put back
 * @param[in]     step    h [unit of x[i]]; try 1e-3 times the scale on which f bends
 * @param[in]     noise   error of one evaluation of f relative to |f|; DBL_EPSILON at best.
 *                        Errors of
 *                        D below 100 noise (|f| + |h slope|) / h count as agreement.
 * @return true when D(h) and D(h/2) differ from slope by rounding, or by a ratio in [3.5, 4.5].
 *   Five
 *         evaluations. False for NaN.
 */
bool mt_slope_agrees(mt_slope_function *f, const void *ctx, int n, double *x, int i,
                     double slope, double step, double noise);

#endif
