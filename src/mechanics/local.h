/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_LOCAL_H
#define MECHANICS_LOCAL_H

#include "mechanics/eliminate.h"

/*
 * Replace the orthonormal basis of an elimination by one local to the bodies, with one column
 * for each coordinate chosen as free. a: m x nq as in mt_eliminate; mass[nq]: diagonal of the
 * mass matrix [kg; kg m^2]; extent: the largest coordinate [m], for the rounding of arms. e->z
 * keeps size and span; error: nq x n, bounds of its entries' errors; scratch from mem is
 * returned. Where the equations leave only rounding to choose from, the orthonormal basis is
 * kept. O(rank^2 nq) at most; chains cost O(rank nq).
 */
mt_status mt_eliminate_local(const double *a, const double *mass, double extent, mt_arena *mem,
                             mt_elimination *e, double *error, mt_err *err);

#endif
