/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The coordinates q of the basis at each frequency by themselves; then all at once
 *     x = X q + U u,    u = sum_p s^p u_p - W q    (basis.h), and likewise y. */
#include "response/solutions.h"

#include <string.h>

#include "linalg/dense.h"

mt_status mt_solutions_open(const mt_basis *basis, int out, int in, mt_arena *mem,
                            mt_solutions *s, mt_err *err)
{
    const mt_transfer *const t = &basis->t;
    *s = (mt_solutions){.basis = basis, .one = *t, .in = in, .out = out};
    s->one.n_in = 1;
    s->one.n_out = 1;
    for (int p = 0; p < MT_REST_POWERS; p++) {
        s->one.rest[p] =
            t->rest[p] == NULL ? NULL : t->rest[p] + out + ((ptrdiff_t)in * t->n_out);
    }
    for (int p = 0; p < MT_FORCED_POWERS; p++) {
        if (t->beta[p] != NULL) {
            s->one.beta[p] = t->beta[p] + ((ptrdiff_t)in * t->n);
        }
        if (t->sigma[p] != NULL) {
            double complex *const row = mt_arena_alloc(mem, (size_t)t->n, sizeof *row);
            MT_TRY(mt_arena_check(mem, err));
            for (ptrdiff_t j = 0; j < t->n; j++) {
                row[j] = t->sigma[p][out + (j * t->n_out)];
            }
            s->one.sigma[p] = row;
        }
    }
    return MT_OK;
}

/* Both parts of numbers that are complex, apart. */
static void split_complex(ptrdiff_t n, const double complex *z, double *const to[2],
                          ptrdiff_t at)
{
    for (ptrdiff_t j = 0; j < n; j++) {
        to[0][at + j] = creal(z[j]);
        to[1][at + j] = cimag(z[j]);
    }
}

/* u := sum_p s^p given_p - W q. */
static void follow_coordinates(const mt_basis *b, double w, const double complex *const *given,
                               int column, const double complex *q, double complex *u)
{
    const ptrdiff_t n = b->n_follow;
    double complex power = 1.0;
    memset(u, 0, (size_t)n * sizeof *u);
    for (int p = 0; p < MT_FORCED_POWERS; p++) {
        for (ptrdiff_t i = 0; i < n && given[p] != NULL; i++) {
            u[i] += power * given[p][i + (column * n)];
        }
        power *= mt_complex(0.0, w);
    }
    for (ptrdiff_t j = 0; j < b->t.n; j++) {
        for (ptrdiff_t i = 0; i < n; i++) {
            u[i] -= b->w[i + (j * n)] * q[j];
        }
    }
}

/* to[n] := X q + U u, u given as by `follow_coordinates`. */
static void back_one(const mt_basis *b, const double complex *q, const double complex *u,
                     double complex *to)
{
    const ptrdiff_t n = b->f->n;
    memset(to, 0, (size_t)n * sizeof *to);
    for (ptrdiff_t j = 0; j < b->t.n; j++) {
        for (ptrdiff_t i = 0; i < n; i++) {
            to[i] += b->x[i + (j * n)] * q[j];
        }
    }
    for (ptrdiff_t j = 0; j < b->n_follow; j++) {
        for (ptrdiff_t i = 0; i < n; i++) {
            to[i] += b->follow[i + (j * n)] * u[j];
        }
    }
}

mt_status mt_basis_solve(const mt_basis *b, double w, double complex *x, double complex *y,
                         bool *singular, mt_arena *scratch, mt_err *err)
{
    const ptrdiff_t n = b->t.n;
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double complex *const q = mt_arena_alloc(scratch, (size_t)(n * b->t.n_in), sizeof *q);
    double complex *const a = mt_arena_alloc(scratch, (size_t)(n * b->t.n_out), sizeof *a);
    double complex *const u = mt_arena_alloc(scratch, (size_t)b->n_follow, sizeof *u);
    MT_TRY(mt_arena_check(scratch, err));
    MT_TRY(mt_transfer_solve(&b->t, w, q, a, NULL, singular, scratch, err));
    for (int i = 0; i < b->t.n_in && !*singular; i++) {
        follow_coordinates(b, w, b->follow_b, i, q + (i * n), u);
        back_one(b, q + (i * n), u, x + ((ptrdiff_t)i * b->f->n));
    }
    for (int o = 0; o < b->t.n_out && !*singular; o++) {
        follow_coordinates(b, w, b->follow_s, o, a + (o * n), u);
        back_one(b, a + (o * n), u, y + ((ptrdiff_t)o * b->f->n));
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}

mt_status mt_solutions_one(const mt_solutions *s, double w, double complex *x,
                           double complex *y, double complex *h, bool *singular,
                           mt_arena *scratch, mt_err *err)
{
    const mt_basis *const b = s->basis;
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double complex *const q = mt_arena_alloc(scratch, 2 * (size_t)b->t.n, sizeof *q);
    double complex *const u = mt_arena_alloc(scratch, (size_t)b->n_follow, sizeof *u);
    MT_TRY(mt_arena_check(scratch, err));
    double complex *const a = q + b->t.n;
    MT_TRY(mt_transfer_solve(&s->one, w, q, a, h, singular, scratch, err));
    if (!*singular) {
        follow_coordinates(b, w, b->follow_b, s->in, q, u);
        back_one(b, q, u, x);
        follow_coordinates(b, w, b->follow_s, s->out, a, u);
        back_one(b, a, u, y);
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}

/* One side, x or y, of all frequencies in coordinates of the basis. */
typedef struct side {
    double *q[2]; /* stay x count */
    double *u[2]; /* follow x count */
} side;

static side new_side(const mt_solutions *s, int count, mt_arena *mem)
{
    const size_t stay = (size_t)s->one.n * (size_t)count;
    const size_t more = (size_t)s->basis->n_follow * (size_t)count;
    return (side){{mt_arena_f64(mem, stay, 1), mt_arena_f64(mem, stay, 1)},
                  {mt_arena_f64(mem, more, 1), mt_arena_f64(mem, more, 1)}};
}

/* to := X q + U u. */
static void back(const mt_solutions *s, int count, const side *from, double *const to[2])
{
    const mt_basis *const b = s->basis;
    const int n = b->f->n;
    for (int i = 0; i < 2; i++) {
        mt_gemm(false, false, n, count, s->one.n, 1.0, b->x, n, from->q[i], s->one.n, 0.0,
                to[i], n);
        if (b->n_follow > 0) {
            mt_gemm(false, false, n, count, b->n_follow, 1.0, b->follow, n, from->u[i],
                    b->n_follow, 1.0, to[i], n);
        }
    }
}

static mt_status solve_at_frequencies(const mt_solutions *s, int count, const double *w,
                                      const mt_solved *out, bool *singular, mt_arena *mem,
                                      mt_err *err)
{
    const ptrdiff_t n = s->one.n;
    const ptrdiff_t more = s->basis->n_follow;
    double complex *const q = mt_arena_alloc(mem, (size_t)(n + more), sizeof *q);
    double complex *const a = mt_arena_alloc(mem, (size_t)(n + more), sizeof *a);
    const side x = new_side(s, count, mem);
    const side y = new_side(s, count, mem);
    MT_TRY(mt_arena_check(mem, err));
    for (ptrdiff_t i = 0; i < count; i++) {
        MT_TRY(mt_transfer_solve(&s->one, w[i], q, a, NULL, singular, mem, err));
        if (*singular) {
            return MT_OK;
        }
        split_complex(n, q, x.q, i * n);
        split_complex(n, a, y.q, i * n);
        follow_coordinates(s->basis, w[i], s->basis->follow_b, s->in, q, q + n);
        follow_coordinates(s->basis, w[i], s->basis->follow_s, s->out, a, a + n);
        split_complex(more, q + n, x.u, i * more);
        split_complex(more, a + n, y.u, i * more);
    }
    back(s, count, &x, out->x);
    back(s, count, &y, out->y);
    return MT_OK;
}

mt_status mt_solutions_at(const mt_solutions *s, int count, const double *w,
                          const mt_solved *out, bool *singular, mt_arena *scratch, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    *singular = false;
    const mt_status rc = solve_at_frequencies(s, count, w, out, singular, scratch, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}
