/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Singular values and eigenvalues of general matrices through our doors to LAPACK, against 113
 * bits: the kinds of its own tests (DCHKBD, DDRVBD, DDRVEV: given spectra, graded, of less than
 * full rank, defective), and those of damped structures. MT_STRESS_ROUNDS=N: N times as many.
 */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "linalg/dense.h"
#include "stress/matrices.h"
#include "stress/table.h"
#include "support/mt_test.h"

/* Of the order times eps times the norm. LAPACK's own tests allow 50. */
static const double PROMISED = 4.0;
/* The same of a singular value itself, where the matrix is graded by rows alone. */
static const double GRADED = 16.0;

enum { PLACES = MOST * MOST, EMBEDDED = 4 * PLACES };

typedef struct line {
    const char *name;
    int cases;
    double share; /* of what is promised, at worst */
} line;

static void finish(const line *l)
{
    printf("%-34s %5d cases  error/bound %8.1e\n", l->name, l->cases, l->share);
}

static void within(mt_test *t, quad off, quad bound, line *l)
{
    const double size = (double)quad_abs(off);
    CHECK(t, size <= (double)bound);
    l->share = size > 0.0 ? fmax(l->share, size / (double)bound) : l->share;
}

/* want[min(m, n)]: singular values of a, descending. */
static void exact_values(int m, int n, const double *a, quad *want)
{
    static quad x[PLACES];
    const int r = m < n ? m : n;
    const int rows = m < n ? n : m;
    quad squares[MOST] = {0};
    for (int j = 0; j < n; j++) {
        for (int i = 0; i < m; i++) {
            x[m < n ? j + (i * rows) : i + (j * rows)] = (quad)a[i + (j * m)];
        }
    }
    quad_squares(rows, r, x, squares);
    for (int i = 0; i < r; i++) {
        want[i] = quad_root(squares[r - 1 - i]);
    }
}

/* x^T x = 1 of the columns of x (m x r) with these steps from row to row, column to column. */
static void judge_columns(mt_test *t, int m, int r, const double *x, const int step[2], line *l)
{
    for (int k = 0; k < r; k++) {
        for (int j = 0; j <= k; j++) {
            quad product = j == k ? -1 : 0;
            for (int i = 0; i < m; i++) {
                product += (quad)x[(i * step[0]) + (j * step[1])] *
                           (quad)x[(i * step[0]) + (k * step[1])];
            }
            within(t, product, (quad)(PROMISED * MOST * DBL_EPSILON), l);
        }
    }
}

static void judge_svd(mt_test *t, int m, int n, const double *a, line *l)
{
    const int r = m < n ? m : n;
    double copy[PLACES];
    double only[MOST];
    double s[MOST];
    double u[PLACES];
    double vt[PLACES];
    quad want[MOST] = {0};
    exact_values(m, n, a, want);
    const quad unit = (quad)(PROMISED * MOST * DBL_EPSILON) * want[0];
    memcpy(copy, a, sizeof copy);
    REQUIRE(t, mt_svd(m, n, copy, only, NULL, NULL, &table_mem, NULL) == MT_OK);
    memcpy(copy, a, sizeof copy);
    REQUIRE(t, mt_svd(m, n, copy, s, u, vt, &table_mem, NULL) == MT_OK);
    for (int i = 0; i < r && want[0] > 0; i++) {
        within(t, (quad)s[i] - want[i], unit, l);
        within(t, (quad)only[i] - want[i], unit, l);
    }
    judge_columns(t, m, r, u, (const int[]){1, m}, l);
    judge_columns(t, n, r, vt, (const int[]){r, 1}, l);
    for (int j = 0; j < n && want[0] > 0; j++) {
        for (int i = 0; i < m; i++) {
            quad off = -(quad)a[i + (j * m)];
            for (int k = 0; k < r; k++) {
                off += (quad)u[i + (k * m)] * (quad)s[k] * (quad)vt[k + (j * r)];
            }
            within(t, off, unit, l);
        }
    }
    l->cases++;
}

/* m x n of the singular values d[min(m, n)]: rows and columns of a larger one. */
static void make_rectangle(int m, int n, const quad *d, mt_random *r, double *a)
{
    static quad x[PLACES];
    const int most = m < n ? n : m;
    quad left[PLACES] = {0};
    quad right[PLACES] = {0};
    for (int i = 0; i < most; i++) {
        left[i + (i * most)] = 1;
        right[i + (i * most)] = i % 2 == 0 ? 1 : -1;
    }
    mix(most, r, left); /* H H = 1: signs make a reflection of it */
    mix(most, r, right);
    for (int j = 0; j < most; j++) {
        for (int i = 0; i < most; i++) {
            x[i + (j * most)] = 0;
            for (int k = 0; k < (m < n ? m : n); k++) {
                const quad across = m < n ? left[i + (k * most)] : right[i + (k * most)];
                const quad along = m < n ? right[j + (k * most)] : left[j + (k * most)];
                x[i + (j * most)] += across * d[k] * along;
            }
        }
    }
    memset(a, 0, PLACES * sizeof *a);
    for (int j = 0; j < n; j++) {
        for (int i = 0; i < m; i++) {
            a[i + (j * m)] = (double)x[i + (j * most)];
        }
    }
}

static void general__singular_values_of_given_spectra(mt_test *t)
{
    static const double ends[] = {0.5, 1e-6, 1e-12, DBL_EPSILON, 0.0};
    mt_random r = mt_random_seed(11);
    for (int kind = 0; kind < SPECTRA; kind++) {
        line l = {.name = spectrum_names[kind]};
        for (int k = 0; k < 20 * rounds(); k++) {
            const double e = ends[k % MT_COUNT(ends)];
            const int m = 1 + mt_random_int(&r, MOST);
            const int n = k % 3 == 0 ? m : 1 + mt_random_int(&r, MOST);
            quad d[MOST];
            double a[PLACES];
            mt_test_row(t, "%s to %g, %d x %d", spectrum_names[kind], e, m, n);
            make_spectrum((spectrum)kind, m < n ? m : n, e, true, &r, d);
            make_rectangle(m, n, d, &r, a);
            judge_svd(t, m, n, a, &l);
        }
        finish(&l);
    }
}

/* Columns that repeat, columns of nothing, and nothing at all. */
static void general__singular_values_of_less_rank(mt_test *t)
{
    line l = {.name = "of less than full rank"};
    mt_random r = mt_random_seed(12);
    for (int k = 0; k < 60 * rounds(); k++) {
        const int n = 2 + mt_random_int(&r, MOST - 1);
        const int rank = mt_random_int(&r, n);
        double a[PLACES] = {0.0};
        mt_test_row(t, "rank %d of %d", rank, n);
        for (int j = 0; j < n; j++) {
            for (int i = 0; i < n; i++) {
                a[i + (j * n)] = j < rank                 ? (double)mt_random_int(&r, 9) - 4.0
                                 : rank > 0 && j % 2 == 0 ? a[i + ((j % rank) * n)]
                                                          : 0.0;
            }
        }
        judge_svd(t, n, n, a, &l);
    }
    finish(&l);
}

/* A = D C, D over 1e0 to 1e-15, C of condition 2: every value to a few roundings of itself. */
static void general__graded_singular_values_are_right_to_themselves(mt_test *t)
{
    line l = {.name = "graded by rows"};
    mt_random r = mt_random_seed(13);
    for (int k = 0; k < 60 * rounds(); k++) {
        const int n = 1 + mt_random_int(&r, 10);
        const int m = n + mt_random_int(&r, MOST - n + 1);
        quad d[MOST];
        quad want[MOST] = {0};
        double a[PLACES];
        double s[MOST];
        double v[PLACES];
        make_spectrum(UNIFORM, n, 1.0, false, &r, d);
        for (int i = 0; i < n; i++) {
            d[i] = 1 + (quad_abs(d[i]) / 2);
        }
        make_rectangle(m, n, d, &r, a);
        for (int i = 0; i < m && m == n; i++) {
            const double scale = pow(10.0, mt_random_in(&r, -15.0, 0.0));
            for (int j = 0; j < n; j++) {
                a[i + (j * m)] *= scale;
            }
        }
        mt_test_row(t, "%d x %d, case %d", m, n, k);
        exact_values(m, n, a, want);
        REQUIRE(t, mt_svd_jacobi(m, n, a, s, v, &table_mem, NULL) == MT_OK);
        for (int i = 0; i < n; i++) {
            within(t, (quad)s[i] - want[i], (quad)(GRADED * n * DBL_EPSILON) * want[i], &l);
        }
        judge_columns(t, n, n, v, (const int[]){1, n}, &l);
        l.cases++;
    }
    finish(&l);
}

/* Blocks on a diagonal, of which the eigenvalues are known, in coordinates of no block. */
typedef struct blocks {
    int n;
    int count;
    int first[MOST];
    int size[MOST];
    quad exact[PLACES]; /* the blocks */
    double a[PLACES];
} blocks;

static quad *place(blocks *b, int block, int i, int j)
{
    return &b->exact[b->first[block] + i + ((b->first[block] + j) * b->n)];
}

static int add_block(blocks *b, int size)
{
    b->first[b->count] = b->n;
    b->size[b->count] = size;
    b->n += size;
    return b->count++;
}

static void turn(blocks *b, mt_random *r)
{
    quad x[PLACES];
    memcpy(x, b->exact, sizeof x);
    mix(b->n, r, x);
    for (int i = 0; i < b->n * b->n; i++) {
        b->a[i] = (double)x[i];
    }
}

/* Least singular value of a block less w: by how little it would have to change to have w as an
 * eigenvalue. Of a complex number it is that of [P Q; -Q P]. */
static quad backward_error(blocks *b, int block, double wr, double wi)
{
    static quad x[EMBEDDED];
    const int k = b->size[block];
    const int order = 2 * k;
    quad squares[2 * MOST] = {0};
    memset(x, 0, sizeof x);
    for (int j = 0; j < k; j++) {
        for (int i = 0; i < k; i++) {
            const quad p = *place(b, block, i, j) - (i == j ? (quad)wr : 0);
            x[i + (j * order)] = p;
            x[k + i + ((k + j) * order)] = p;
        }
        x[k + j + (j * order)] = (quad)wi;
        x[j + ((k + j) * order)] = -(quad)wi;
    }
    quad_squares(order, order, x, squares);
    return quad_root(squares[0]);
}

/* Every eigenvalue is one of a matrix next to this one; so are sum and sum of squares; and each
 * has its vector. Blocks that stand at right angles: the error is the least over them. */
static void judge_general(mt_test *t, blocks *b, line *l)
{
    const int n = b->n;
    double copy[PLACES];
    double wr[MOST];
    double wi[MOST];
    double v[PLACES];
    quad norm = 0;
    quad trace[2] = {0, 0};
    for (int i = 0; i < n * n; i++) {
        norm += (quad)b->a[i] * (quad)b->a[i];
        trace[1] -= (quad)b->a[i] * (quad)b->a[(i / n) + ((i % n) * n)];
    }
    norm = quad_root(norm);
    const quad unit = (quad)(PROMISED * n * DBL_EPSILON) * norm;
    memcpy(copy, b->a, sizeof copy);
    REQUIRE(t, mt_eig_general(n, copy, wr, wi, v, &table_mem, NULL) == MT_OK);
    for (int i = 0; i < n; i++) {
        quad least = norm;
        trace[0] += (quad)wr[i] - (quad)b->a[i + (i * n)];
        trace[1] += ((quad)wr[i] * (quad)wr[i]) - ((quad)wi[i] * (quad)wi[i]);
        for (int k = 0; k < b->count && least > unit; k++) {
            const quad here = backward_error(b, k, wr[i], wi[i]);
            least = here < least ? here : least;
        }
        within(t, least, unit, l);
        const double *const x = v + ((ptrdiff_t)(wi[i] < 0.0 ? i - 1 : i) * n);
        quad off = 0;
        for (int k = 0; k < n; k++) { /* real part of A v - w v; the other is its partner's */
            quad row = -(quad)wr[i] * (quad)x[k];
            row += wi[i] != 0.0 ? quad_abs((quad)wi[i]) * (quad)x[k + n] : 0;
            for (int j = 0; j < n; j++) {
                row += (quad)b->a[k + (j * n)] * (quad)x[j];
            }
            off += row * row;
        }
        within(t, quad_root(off), unit, l);
    }
    within(t, trace[0], (quad)n * unit, l);
    within(t, trace[1], (quad)(2 * n) * norm * unit, l);
    l->cases++;
}

/* q'' + 2 zeta w q' + w^2 q = 0 for each mode: far below, next to, at and beyond critical. */
static void general__damped_modes(mt_test *t)
{
    static const double kinds[] = {0.0, 1e-8, 0.05, 1.0 - 1e-12, 1.0, 1.0 + 1e-12, 30.0};
    line l = {.name = "damped modes"};
    mt_random r = mt_random_seed(14);
    for (int k = 0; k < 40 * rounds(); k++) {
        static blocks b;
        const int modes = 1 + mt_random_int(&r, MOST / 2);
        memset(&b, 0, sizeof b);
        b.n = 2 * modes; /* the leading dimension, as blocks are filled */
        for (int i = 0; i < modes; i++) {
            const double w = pow(10.0, mt_random_in(&r, -1.0, 1.0));
            b.first[i] = 2 * i;
            b.size[i] = 2;
            *place(&b, i, 0, 1) = (quad)w;
            *place(&b, i, 1, 0) = -(quad)w;
            *place(&b, i, 1, 1) =
                -2 * (quad)kinds[mt_random_int(&r, MT_COUNT(kinds))] * (quad)w;
        }
        b.count = modes;
        mt_test_row(t, "case %d, %d modes", k, modes);
        turn(&b, &r);
        judge_general(t, &b, &l);
    }
    finish(&l);
}

/* Jordan's blocks, and such that miss one by 1e-4 to 1e-16. */
static void general__defective_matrices(mt_test *t)
{
    line l = {.name = "defective and almost so"};
    mt_random r = mt_random_seed(15);
    for (int k = 0; k < 30 * rounds(); k++) {
        static blocks b;
        memset(&b, 0, sizeof b);
        while (b.n < 3 + (k % 6)) {
            (void)add_block(&b, 1 + mt_random_int(&r, 4));
        }
        for (int i = 0; i < b.count; i++) {
            const double centre = mt_random_in(&r, -1.0, 1.0);
            const double miss = k % 2 == 0 ? 0.0 : pow(10.0, mt_random_in(&r, -16.0, -4.0));
            for (int j = 0; j < b.size[i]; j++) {
                *place(&b, i, j, j) = (quad)(centre + (j * miss));
                if (j > 0) {
                    *place(&b, i, j - 1, j) = 1;
                }
            }
        }
        mt_test_row(t, "case %d, n = %d, %d blocks", k, b.n, b.count);
        turn(&b, &r);
        judge_general(t, &b, &l);
    }
    finish(&l);
}

/* An eigenvalue, a singular value that is off by a few times what is promised. */
static void general__wrong_answers_are_seen(mt_test *t)
{
    static blocks b;
    mt_random r = mt_random_seed(16);
    mt_test wrong = mt_test_begin();
    line l = {.name = "wrong"};
    wrong.quiet = true;
    memset(&b, 0, sizeof b);
    for (int i = 0; i < 4; i++) {
        (void)add_block(&b, 1);
    }
    for (int i = 0; i < 4; i++) {
        *place(&b, i, 0, 0) = (quad)(i + 1);
    }
    turn(&b, &r);
    judge_general(t, &b, &l);
    *place(&b, 2, 0, 0) += (quad)(100.0 * PROMISED * 4.0 * DBL_EPSILON);
    judge_general(&wrong, &b, &l);
    CHECK(t, !mt_test_passed(&wrong));
    wrong = mt_test_begin();
    wrong.quiet = true;
    within(&wrong, (quad)nan(""), 1, &l);
    CHECK(t, !mt_test_passed(&wrong));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        MT_TEST(general__singular_values_of_given_spectra),
        MT_TEST(general__singular_values_of_less_rank),
        MT_TEST(general__graded_singular_values_are_right_to_themselves),
        MT_TEST(general__damped_modes),
        MT_TEST(general__defective_matrices),
        MT_TEST(general__wrong_answers_are_seen),
    };
    return cmocka_run_group_tests_name(__FILE__, tests, prepare, release) != 0;
}
