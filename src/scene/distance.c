/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The point q of the solid |q_i / a_i|^2 <= 1 next to x outside satisfies, with a multiplier
 * t >= 0,
 *     q_i = a_i^2 x_i / (a_i^2 + t),   F(t) = sum_i (a_i x_i / (a_i^2 + t))^2 = 1,
 * of which each term falls with t and is 0 where a_i is: F is below 1 at t = |(a_i x_i)|, and
 * where it is below 1 at t -> 0 already, only the directions without extent are outside.
 */
#include "scene/distance.h"

#include <math.h>
#include <stddef.h>

/* Halvings of the interval of t: to the last bit of a double. */
enum { HALVINGS = 200 };

double mt_distance_points(const double a[3], const double b[3])
{
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

double mt_distance_segment(const double a[3], const double b[3], const double x[3],
                           double nearest[3])
{
    double dd = 0.0;
    double dx = 0.0;
    double at[3];
    for (int k = 0; k < 3; k++) {
        dd += (b[k] - a[k]) * (b[k] - a[k]);
        dx += (b[k] - a[k]) * (x[k] - a[k]);
    }
    const double part = dd > 0.0 ? fmin(fmax(dx / dd, 0.0), 1.0) : 0.0;
    for (int k = 0; k < 3; k++) {
        at[k] = a[k] + (part * (b[k] - a[k]));
        if (nearest != NULL) {
            nearest[k] = at[k];
        }
    }
    return mt_distance_points(at, x);
}

/* F(t); radii without extent have no part in it. */
static double level(const double radii[3], const double x[3], double t)
{
    double sum = 0.0;
    for (int i = 0; i < 3; i++) {
        const double whole = (radii[i] * radii[i]) + t;
        const double part = radii[i] > 0.0 ? radii[i] * x[i] / whole : 0.0;
        sum += part * part;
    }
    return sum;
}

double mt_distance_ellipsoid(const double radii[3], const double x[3])
{
    const double weighted[3] = {radii[0] * x[0], radii[1] * x[1], radii[2] * x[2]};
    double low = 0.0;
    double high = hypot(hypot(weighted[0], weighted[1]), weighted[2]);
    double q[3];
    if (level(radii, x, 0.0) <= 1.0) {
        high = 0.0;
    }
    for (int i = 0; i < HALVINGS && high > 0.0; i++) {
        const double middle = low + (0.5 * (high - low));
        if (level(radii, x, middle) > 1.0) {
            low = middle;
        } else {
            high = middle;
        }
    }
    for (int i = 0; i < 3; i++) {
        const double square = radii[i] * radii[i];
        q[i] = radii[i] > 0.0 ? square * x[i] / (square + high) : 0.0;
    }
    return mt_distance_points(q, x);
}
