/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Eigenvalues in more than thirty digits, for small symmetric pencils: bisection on the inertia
 * of K - x M (Sylvester), by L D L^T without pivoting. */
#ifndef MT_QUAD_H
#define MT_QUAD_H

#include <float.h>
#include <stddef.h>

#if LDBL_MANT_DIG >= 106
typedef long double mt_quad;
#else
__extension__ typedef __float128 mt_quad;
#endif

enum { MT_QUAD_MOST = 420, MT_QUAD_BAND = 16, MT_QUAD_STEPS = 220 };

/* K and M by their lower bands: entry (i, i - d) at [i][d], d = 0 .. band. */
typedef struct mt_quad_pencil {
    int n;
    int band;
    mt_quad k[MT_QUAD_MOST][MT_QUAD_BAND];
    mt_quad m[MT_QUAD_MOST][MT_QUAD_BAND];
} mt_quad_pencil;

/* a += c f f^T, f given by its entries at columns at[count] (below 0: left out). */
static inline void mt_quad_add(mt_quad (*a)[MT_QUAD_BAND], mt_quad c, int count, const int *at,
                               const mt_quad *f)
{
    for (int i = 0; i < count; i++) {
        for (int j = 0; j < count; j++) {
            if (at[j] >= 0 && at[i] >= at[j]) {
                a[at[i]][at[i] - at[j]] += c * f[i] * f[j];
            }
        }
    }
}

/* How many eigenvalues lie below x. */
static inline int mt_quad_below(const mt_quad_pencil *p, mt_quad x)
{
    static mt_quad l[MT_QUAD_MOST][MT_QUAD_BAND];
    static mt_quad d[MT_QUAD_MOST];
    int count = 0;
    for (int i = 0; i < p->n; i++) {
        const int first = i > p->band ? i - p->band : 0;
        for (int j = first; j <= i; j++) {
            mt_quad s = p->k[i][i - j] - x * p->m[i][i - j];
            for (int k = first > j - p->band ? first : j - p->band; k < j; k++) {
                s -= l[i][i - k] * d[k] * l[j][j - k];
            }
            if (j == i) {
                d[i] = s;
            } else {
                l[i][i - j] = s / d[j];
            }
        }
        count += d[i] < 0 ? 1 : 0;
    }
    return count;
}

/* Eigenvalue `index` (from 0, ascending). */
static inline mt_quad mt_quad_eigenvalue(const mt_quad_pencil *p, int index)
{
    /* no small number: a pivot of exactly 0 would stop the elimination */
    mt_quad low = (mt_quad)-1.0371;
    mt_quad high = (mt_quad)1.0623;
    while (mt_quad_below(p, low) > index) {
        low *= 4;
    }
    while (mt_quad_below(p, high) <= index) {
        high *= 4;
    }
    for (int i = 0; i < MT_QUAD_STEPS; i++) {
        const mt_quad x = (low + high) / 2;
        if (mt_quad_below(p, x) > index) {
            high = x;
        } else {
            low = x;
        }
    }
    return (low + high) / 2;
}

#endif
