/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef EXPR_INTERPOLANT_H
#define EXPR_INTERPOLANT_H

#include "base/arena.h"
#include "expr/interval.h"

/*
 * A curve through measured points, for interp(): piecewise cubics with a continuous slope,
 *   y = y_k + t (s_k + t (c_k + t d_k)),  t = x - x_k,  x_k <= x < x_{k+1}  (the last includes
 * its end), that rise where their points rise, fall where they fall, and lie between them, so
 * nothing is made up between two points. Two points are joined by a line. Slopes s_k at the
 * points: Steffen, "A simple method for monotonic interpolation in one dimension", Astronomy
 * and Astrophysics 239 (1990) 443-450, eq. 11, and those of the chords at both ends.
 * Nothing is outside of the points.
 */
struct mt_interpolant {
    const char *name;
    int n;           /* at least 2 */
    const double *x; /* [n] ascending */
    const double *y; /* [n] */
    const double *s; /* [n] slope at each point */
    const double *c; /* [n - 1] of each piece */
    const double *d; /* [n - 1] */
};

/* The number of points that a curve may have. */
enum { MT_INTERPOLANT_MOST = 10000 };

/* A curve through n >= 2 points of ascending, finite x and finite y, which are kept, not
 * copied; s, c and d are made in mem. O(n). Fails: MT_E_INPUT ("the curve is too steep") where
 * a slope is not finite; MT_E_MEMORY. */
mt_status mt_interpolant_init(mt_interpolant *curve, const char *name, int n, const double *x,
                              const double *y, mt_arena *mem, mt_err *err);
/* Value, slope and second derivative at x; NaN outside of the points, but for rounding of their
 * ends. O(log n). */
void mt_interpolant_at(const mt_interpolant *curve, double where, double out[3]);
/* Encloses all values, and all slopes, for x within `of`, exact and rounded (interval.h): the
 * whole line where it is not within the points. What is NULL is not asked for. O(log n + points
 * within it). */
void mt_interpolant_enclose(const mt_interpolant *curve, mt_interval of, mt_interval *values,
                            mt_interval *slopes);

#endif
