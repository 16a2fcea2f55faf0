/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_CX_H
#define MECHANICS_CX_H

#include <complex.h>
#include <math.h>

#include "base/base.h"

/*
 * Complex-step arithmetic. All geometry kernels are written once, analytically, in complex
 * numbers: a real number x is passed as x, a number with derivative x' (by any variable) as x +
 * i h x' with h = 2^-300. The real part of a result is then its value and imag/h its
 * derivative, exact to rounding: the next term of the series is h^2 = 2^-600 smaller and
 * nothing is subtracted (Squire and Trapp, SIAM Review 40 (1998) 110-112). h is a power of two,
 * so scaling by it is exact. Only analytic operations are allowed: no cabs, no conj, no
 * comparison of anything but real parts.
 */
typedef double complex mt_cx;

#define MT_CX_STEP 0x1p-300

/* CMPLX of C11, which clang does not offer with this C library. */
static inline mt_cx cx_pair(double re, double im)
{
    const union {
        double part[2];
        mt_cx z;
    } u = {{re, im}};
    return u.z;
}

static inline mt_cx cx_make(double value, double derivative)
{
    return cx_pair(value, derivative * MT_CX_STEP);
}

static inline double cx_derivative(mt_cx a)
{
    return cimag(a) / MT_CX_STEP;
}

/* a b without C's Annex G recovery of infinities, which costs a library call. */
static inline mt_cx cx_mul(mt_cx a, mt_cx b)
{
    return cx_pair((creal(a) * creal(b)) - (cimag(a) * cimag(b)),
                   (creal(a) * cimag(b)) + (cimag(a) * creal(b)));
}

/* Where geometry degenerates (a hinge without a direction, the angle of a zero vector) a kernel
 * returns infinite and NaN values and derivatives; equations and derivatives are checked before
 * they are used. */

/* The imaginary part of a divisor is h times its derivative, so |b|^2 = (re b)^2 to the last
 * bit. */
MT_DIVIDES_BY_ZERO
static inline mt_cx cx_div(mt_cx a, mt_cx b)
{
    const double value = creal(a) / creal(b);
    return cx_pair(value, (cimag(a) - (value * cimag(b))) / creal(b));
}

MT_DIVIDES_BY_ZERO
static inline mt_cx cx_sqrt(mt_cx a)
{
    const double root = sqrt(creal(a));
    return cx_pair(root, cimag(a) / (2.0 * root));
}

/* atan2(s, c): d = (c ds - s dc) / (s^2 + c^2). */
MT_DIVIDES_BY_ZERO
static inline mt_cx cx_atan2(mt_cx s, mt_cx c)
{
    const double q = (creal(s) * creal(s)) + (creal(c) * creal(c));
    return cx_pair(atan2(creal(s), creal(c)),
                   ((creal(c) * cimag(s)) - (creal(s) * cimag(c))) / q);
}

static inline mt_cx cx_dot3(const mt_cx *a, const mt_cx *b)
{
    return cx_mul(a[0], b[0]) + cx_mul(a[1], b[1]) + cx_mul(a[2], b[2]);
}

static inline void cx_cross3(const mt_cx *a, const mt_cx *b, mt_cx *out)
{
    const mt_cx x = cx_mul(a[1], b[2]) - cx_mul(a[2], b[1]);
    const mt_cx y = cx_mul(a[2], b[0]) - cx_mul(a[0], b[2]);
    const mt_cx z = cx_mul(a[0], b[1]) - cx_mul(a[1], b[0]);
    out[0] = x;
    out[1] = y;
    out[2] = z;
}

/* Squares of components between 2^-400 and 2^400, their sums and their derivatives neither
 * under- nor overflow. */
#define MT_CX_SAFE 0x1p400

/* Exponent of the power of two by which the components of v are divided before they are
 * squared: 0 unless they are very small or very large. */
static inline int cx_exponent3(const mt_cx *v)
{
    const double largest = fmax(fmax(fabs(creal(v[0])), fabs(creal(v[1]))), fabs(creal(v[2])));
    int exponent = 0;
    if (isfinite(largest) && !(largest > 1.0 / MT_CX_SAFE && largest < MT_CX_SAFE)) {
        (void)frexp(largest, &exponent);
    }
    return exponent;
}

/* a 2^exponent, exactly. */
static inline mt_cx cx_scale(mt_cx a, int exponent)
{
    return exponent == 0 ? a : cx_pair(ldexp(creal(a), exponent), ldexp(cimag(a), exponent));
}

/* |v| for components of any size. */
static inline mt_cx cx_norm3(const mt_cx *v)
{
    const int e = cx_exponent3(v);
    const mt_cx w[3] = {cx_scale(v[0], -e), cx_scale(v[1], -e), cx_scale(v[2], -e)};
    return cx_scale(cx_sqrt(cx_dot3(w, w)), e);
}

/* v /= |v| for components of any size; NaN where |v| is 0. */
static inline void cx_unit3(mt_cx *v)
{
    const int e = cx_exponent3(v);
    for (int k = 0; k < 3; k++) {
        v[k] = cx_scale(v[k], -e);
    }
    const mt_cx length = cx_sqrt(cx_dot3(v, v));
    for (int k = 0; k < 3; k++) {
        v[k] = cx_div(v[k], length);
    }
}

/* out = R v, R 3 x 3 column-major. out may not alias v. */
static inline void cx_rotate3(const mt_cx *r, const mt_cx *v, mt_cx *out)
{
    for (int i = 0; i < 3; i++) {
        out[i] = cx_mul(r[i], v[0]) + cx_mul(r[i + 3], v[1]) + cx_mul(r[i + 6], v[2]);
    }
}

#endif
