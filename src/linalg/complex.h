/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_COMPLEX_H
#define LINALG_COMPLEX_H

#include <complex.h>

/* re + i im: CMPLX of C11, which clang does not offer with this C library. */
static inline double complex mt_complex(double re, double im)
{
    const union {
        double part[2]; /* cppcheck-suppress unusedStructMember */
        double complex z;
    } u = {{re, im}};
    return u.z;
}

/* a b for finite a and b, without C's checks for infinities. */
static inline double complex mt_times(double complex a, double complex b)
{
    return mt_complex((creal(a) * creal(b)) - (cimag(a) * cimag(b)),
                      (creal(a) * cimag(b)) + (cimag(a) * creal(b)));
}

#endif
