/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Modal assurance criterion, for single shapes and for subspaces. Shapes are scaled by their
 * largest entry first, so squares neither over- nor underflow. */
#include "modal/mac.h"

#include "modal/modal_priv.h"

#include <math.h>
#include <string.h>

#include "linalg/dense.h"

/* cos^2 of the angle between a and b. */
static double mac_pair(int ns, const double *a, const double *b)
{
    const double size_a = mt_max_abs(ns, a);
    const double size_b = mt_max_abs(ns, b);
    if (!(size_a > 0.0 && size_b > 0.0 && isfinite(size_a) && isfinite(size_b))) {
        return nan("");
    }
    double ab = 0.0;
    double aa = 0.0;
    double bb = 0.0;
    for (int i = 0; i < ns; i++) {
        const double x = a[i] / size_a;
        const double z = b[i] / size_b;
        ab += x * z;
        aa += x * x;
        bb += z * z;
    }
    return fmin(ab * ab / (aa * bb), 1.0);
}

void mt_mac_matrix(int ns, int ra, const double *a, int rb, const double *b, double *mac)
{
    for (int j = 0; j < rb; j++) {
        for (int i = 0; i < ra; i++) {
            mac[i + (ptrdiff_t)j * ra] =
                mac_pair(ns, a + (ptrdiff_t)i * ns, b + (ptrdiff_t)j * ns);
        }
    }
}

mt_status mt_mac_pair(int ra, int rb, const double *mac, int *pair, mt_arena *scratch,
                      mt_err *err)
{
    return mt_assign(ra, rb, mac, pair, scratch, err);
}

/* Orthonormal basis of span(a) in u (ns x min(ns, r)), leading *rank columns. */
static mt_status basis(int ns, int r, const double *a, double *u, int *rank, mt_arena *scratch,
                       mt_err *err)
{
    const int least = ns < r ? ns : r;
    double *const copy = mt_arena_f64(scratch, (size_t)ns, (size_t)r);
    double *const s = mt_arena_f64(scratch, (size_t)least, 1);
    MT_TRY(mt_arena_check(scratch, err));
    for (int j = 0; j < r; j++) { /* each shape has its own scale: none may hide another */
        const double size = mt_max_abs(ns, a + (ptrdiff_t)j * ns);
        for (int i = 0; i < ns; i++) {
            const ptrdiff_t ij = i + (ptrdiff_t)j * ns;
            copy[ij] = size > 0.0 ? a[ij] / size : a[ij];
        }
    }
    MT_TRY(mt_svd(ns, r, copy, s, u, NULL, scratch, err));
    *rank = 0;
    while (*rank < least && s[*rank] > mt_modal_tolerance(ns > r ? ns : r) * s[0]) {
        (*rank)++;
    }
    return MT_OK;
}

static mt_status subspace(int ns, int ra, const double *a, int rb, const double *b,
                          double *cos2, mt_arena *scratch, mt_err *err)
{
    double *const ua = mt_arena_f64(scratch, (size_t)ns, (size_t)ra);
    double *const ub = mt_arena_f64(scratch, (size_t)ns, (size_t)rb);
    double *const c = mt_arena_f64(scratch, (size_t)ra, (size_t)rb);
    MT_TRY(mt_arena_check(scratch, err));
    int rank_a = 0;
    int rank_b = 0;
    MT_TRY(basis(ns, ra, a, ua, &rank_a, scratch, err));
    MT_TRY(basis(ns, rb, b, ub, &rank_b, scratch, err));
    mt_gemm(true, false, rank_a, rank_b, ns, 1.0, ua, ns, ub, ns, 0.0, c, rank_a);
    MT_TRY(mt_svd(rank_a, rank_b, c, cos2, NULL, NULL, scratch, err));
    const int least = rank_a < rank_b ? rank_a : rank_b;
    const int wanted = ra < rb ? ra : rb;
    for (int i = 0; i < wanted; i++) {
        cos2[i] = i < least ? fmin(cos2[i] * cos2[i], 1.0) : nan("");
    }
    return MT_OK;
}

mt_status mt_mac_subspace(int ns, int ra, const double *a, int rb, const double *b,
                          double *cos2, mt_arena *scratch, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = subspace(ns, ra, a, rb, b, cos2, scratch, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}

double mt_mac_derivative(int ns, const double *a, const double *da, const double *b)
{
    const double ab = mt_dot(ns, a, b);
    const double aa = mt_dot(ns, a, a);
    const double bb = mt_dot(ns, b, b);
    const double mac = ab * ab / (aa * bb);
    return 2.0 * ab * mt_dot(ns, da, b) / (aa * bb) - 2.0 * mac * mt_dot(ns, a, da) / aa;
}
