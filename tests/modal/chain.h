/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Masses on a line, joined by springs: systems with closed forms. Upper triangles are NaN:
 * whoever reads them is caught. */
#ifndef CHAIN_H
#define CHAIN_H

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "linalg/dense.h"

enum { CHAIN_MOST = 16, GROUND = -1 };

typedef struct chain {
    int n;
    int springs;
    double m[CHAIN_MOST * CHAIN_MOST];
    double k[CHAIN_MOST * CHAIN_MOST];
    double b[2 * CHAIN_MOST * CHAIN_MOST]; /* springs x n, for chain_factor */
    double c[2 * CHAIN_MOST];
    int ends[2 * CHAIN_MOST][2];
} chain;

/* n equal masses, no springs. */
static inline void chain_start(chain *s, int n, double mass)
{
    s->n = n;
    s->springs = 0;
    for (int j = 0; j < n; j++) {
        for (int i = 0; i < n; i++) {
            s->m[i + j * n] = i == j ? mass : (i > j ? 0.0 : nan(""));
            s->k[i + j * n] = i >= j ? 0.0 : nan("");
        }
    }
}

static inline void chain_spring(chain *s, int from, int to, double stiffness)
{
    const int n = s->n;
    const int ends[2] = {from, to};
    for (int e = 0; e < 2; e++) {
        s->ends[s->springs][e] = ends[e];
        if (ends[e] != GROUND) {
            s->k[ends[e] + ends[e] * n] += stiffness;
        }
    }
    if (from != GROUND && to != GROUND) {
        const int low = from > to ? from : to;
        const int high = from > to ? to : from;
        s->k[low + high * n] -= stiffness;
    }
    s->c[s->springs] = stiffness;
    s->springs++;
}

/* Springs of one stiffness between neighbours and, where asked, to walls at both ends. */
static inline void chain_line(chain *s, int n, double mass, double stiffness, int walls)
{
    chain_start(s, n, mass);
    for (int i = walls > 0 ? -1 : 0; i < (walls > 1 ? n : n - 1); i++) {
        chain_spring(s, i, i + 1 < n ? i + 1 : GROUND, stiffness);
    }
}

/* K -> X^T K X, M -> X^T M X: the same modes in oblique coordinates, no zero on any diagonal.
 */
static inline void chain_oblique(chain *s, const double *x)
{
    const int n = s->n;
    double full[CHAIN_MOST * CHAIN_MOST];
    double ax[CHAIN_MOST * CHAIN_MOST];
    double *const both[2] = {s->k, s->m};
    for (int k = 0; k < 2; k++) {
        memcpy(full, both[k], sizeof full);
        mt_symm(n, n, full, x, ax);
        mt_gemm(true, false, n, n, n, 1.0, x, n, ax, n, 0.0, both[k], n);
        for (int j = 0; j < n; j++) {
            for (int i = 0; i < j; i++) {
                both[k][i + j * n] = nan("");
            }
        }
    }
}

/* Fill b: one row per spring. */
static inline void chain_factor(chain *s)
{
    for (int r = 0; r < s->springs; r++) {
        for (int i = 0; i < s->n; i++) {
            const double from = s->ends[r][0] == i ? -1.0 : 0.0;
            s->b[r + i * s->springs] = s->ends[r][1] == i ? 1.0 : from;
        }
    }
}

#endif
