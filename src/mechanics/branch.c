/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * With A the gradients of independent equations (all that the joints hold, the walk's own
 * included), the set of positions that they allow is smooth where A has full rank, and on a
 * short step within one branch
 *     det(A_1 C^2 A_0^T) > 0,      C: rotations as arcs of the model length,
 * as it is at A_1 = A_0 and changes sign only where A_1 loses rank beside A_0. A step that
 * jumps over a position where branches meet, or nearly meet (links of a loop in line), ends in
 * the other assembly with the other sign, and its correction may be as small as that of a good
 * one: both branches look like the one straight line across.
 */
#include "mechanics/branch.h"

#include <math.h>
#include <string.h>

#include "linalg/dense.h"

/* O(n^3) for each step of a walk: below a millisecond. */
enum { EQUATIONS_MOST = 150 };

mt_status mt_branch_init(mt_branch *b, const mt_system *sys, int m, mt_arena *mem, mt_err *err)
{
    *b = (mt_branch){.sys = sys, .most = m <= EQUATIONS_MOST ? m : 0};
    const size_t n = (size_t)b->most;
    b->row = mt_arena_alloc(mem, n, sizeof *b->row);
    b->a = mt_arena_f64(mem, n, (size_t)sys->nq);
    b->to = mt_arena_f64(mem, n, (size_t)sys->nq);
    b->b = mt_arena_f64(mem, n, n);
    return mt_arena_check(mem, err);
}

/* The rows of `a` that count, rotations as arcs, each of length 1. */
static void take_rows(const mt_branch *b, int m, const double *a, double *out)
{
    for (int body = 0; body < b->sys->n_bodies; body++) {
        for (int k = 0; k < 6; k++) {
            const ptrdiff_t j = b->sys->bodies[body].dof[k];
            const double arc = k < 3 ? 1.0 : 1.0 / b->sys->length_m;
            for (ptrdiff_t i = 0; j >= 0 && i < b->n; i++) {
                out[i + (j * b->n)] = a[b->row[i] + (j * m)] * arc;
            }
        }
    }
    for (ptrdiff_t i = 0; i < b->n; i++) {
        double square = 0.0;
        for (ptrdiff_t j = 0; j < b->sys->nq; j++) {
            square += out[i + (j * b->n)] * out[i + (j * b->n)];
        }
        for (ptrdiff_t j = 0; j < b->sys->nq && square > 0.0; j++) {
            out[i + (j * b->n)] /= sqrt(square);
        }
    }
}

void mt_branch_stand(mt_branch *b, int m, const double *a, const mt_elimination *e)
{
    b->n = b->most == 0 ? 0 : e == NULL ? m : e->qr.rank;
    for (int i = 0; i < b->n; i++) {
        b->row[i] = e == NULL ? i : e->qr.perm[i];
    }
    take_rows(b, m, a, b->a);
}

mt_status mt_branch_kept(mt_branch *b, int m, const double *a, bool *kept, mt_arena *scratch,
                         mt_err *err)
{
    int sign = 1;
    take_rows(b, m, a, b->to);
    mt_gemm(false, true, b->n, b->n, b->sys->nq, 1.0, b->to, b->n, b->a, b->n, 0.0, b->b, b->n);
    MT_TRY(mt_lu_sign(b->n, b->b, &sign, scratch, err));
    *kept = sign > 0;
    return MT_OK;
}
