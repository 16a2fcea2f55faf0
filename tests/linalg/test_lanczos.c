/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Largest eigenvalues by Lanczos' method. The operator is H D H, H a reflection, so that all
 * eigenvectors are known: the columns of H. Spectra: falling fast (one sweep), dense
 * (restarts), repeated (found once, and again among what is left; in blocks at once), of low
 * rank, and of no size at all. Blocks that are as wide as what is wanted, or as the whole
 * space.
 */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "linalg/dense.h"
#include "linalg/lanczos.h"
#include "mt_test.h"

enum { MOST = 400, WANTED = 8 };

typedef struct operator_ {
    int n;
    double d[MOST];
    double u[MOST]; /* H = I - 2 u u^T */
    double work[MOST];
    long calls;
    long fail_at; /* 0: never */
} operator_;

static void reflect(const operator_ *o, const double *x, double *y)
{
    const double s = 2.0 * mt_dot(o->n, o->u, x);
    for (int i = 0; i < o->n; i++) {
        y[i] = x[i] - (s * o->u[i]);
    }
}

static mt_status apply(void *context, int count, const double *x, double *y, mt_err *err)
{
    operator_ *const o = context;
    if (++o->calls == o->fail_at) {
        return mt_fail(err, MT_E_INTERRUPTED, "enough");
    }
    for (int c = 0; c < count; c++) {
        const ptrdiff_t at = (ptrdiff_t)c * o->n;
        reflect(o, x + at, o->work);
        for (int i = 0; i < o->n; i++) {
            o->work[i] *= o->d[i];
        }
        reflect(o, o->work, y + at);
    }
    return MT_OK;
}

typedef double (*spectrum)(int i, int n);

static double falling(int i, int n)
{
    (void)n;
    return pow((double)i + 1.0, -4.0);
}

static double dense(int i, int n)
{
    return 2.0 - ((double)i / (double)n);
}

static double twice(int i, int n)
{
    (void)n;
    const int pair = i / 2;
    return 1.0 / (1.0 + (double)pair);
}

static double low_rank(int i, int n)
{
    (void)n;
    return i < 3 ? 3.0 - (double)i : 0.0;
}

static double none(int i, int n)
{
    (void)i;
    (void)n;
    return 0.0;
}

static void fill(operator_ *o, int n, spectrum of)
{
    *o = (operator_){.n = n};
    for (int i = 0; i < n; i++) {
        o->d[i] = of(i, n);
        o->u[i] = sin(1.0 + (double)i);
    }
    const double length = mt_norm2(n, o->u);
    for (int i = 0; i < n && length > 0.0; i++) {
        o->u[i] /= length;
    }
}

/* Every column is an eigenvector of one of the eigenvalues from `first` on, in order. */
static void check_columns(mt_test *t, operator_ *o, int found, const double *x, spectrum of,
                          int step)
{
    static double y[MOST];
    for (int j = 0; j < found; j++) {
        const double *const xj = x + ((ptrdiff_t)j * o->n);
        const double theta = of(step * j, o->n);
        (void)apply(o, 1, xj, y, NULL);
        mt_axpy(o->n, -theta, xj, y);
        CHECK_NEAR(t, mt_norm2(o->n, xj), 1.0, 1e-13);
        CHECK(t, mt_norm2(o->n, y) <= 2e-9 * theta + 1e-13);
        for (int k = 0; k < j; k++) {
            CHECK(t, fabs(mt_dot(o->n, xj, x + ((ptrdiff_t)k * o->n))) <= 1e-12);
        }
    }
}

static void lanczos__finds_the_largest(mt_test *t)
{
    static const struct {
        const char *name;
        spectrum of;
        int n;
        int found;
    } rows[] = {
        {"falling", falling, 300, WANTED},
        {"dense, restarted", dense, 400, WANTED},
        {"smaller than room", dense, 20, WANTED},
        {"as small as wanted", falling, WANTED, WANTED},
        {"smaller than wanted", falling, 5, 5},
        {"one", falling, 1, 1},
        {"rank three", low_rank, 100, 3},
        {"nothing at all", none, 50, 0},
        {"order 0", none, 0, 0},
    };
    static const int blocks[] = {0, 2, 4, 5, WANTED, 30};
    static operator_ o;
    static double x[MOST * WANTED];
    static double again[MOST * WANTED];
    for (int k = 0; k < MT_COUNT(rows) * MT_COUNT(blocks); k++) {
        const int i = k / MT_COUNT(blocks);
        const int block = blocks[k % MT_COUNT(blocks)];
        mt_arena mem = {.first = NULL};
        int found = -1;
        mt_test_row(t, "%s, block %d", rows[i].name, block);
        fill(&o, rows[i].n, rows[i].of);
        mt_lanczos p = {.n = o.n,
                        .wanted = WANTED,
                        .block = block,
                        .seed = 1,
                        .apply = apply,
                        .context = &o};
        CHECK_INT(t, mt_lanczos_largest(&p, &mem, x, &found, NULL), MT_OK);
        CHECK_INT(t, found, rows[i].found);
        check_columns(t, &o, found, x, rows[i].of, 1);
        CHECK_INT(t, mt_lanczos_largest(&p, &mem, again, &found, NULL), MT_OK);
        CHECK(t, memcmp(x, again, (size_t)o.n * (size_t)found * sizeof *x) == 0);
        CHECK_INT(t, mem.used, 0);
        mt_arena_free(&mem);
    }
}

/* A Krylov space holds one direction of each eigenspace; the other is in the complement. */
static void lanczos__finds_repeated_ones_among_what_is_left(mt_test *t)
{
    static operator_ o;
    static double x[MOST * 2 * WANTED];
    mt_arena mem = {.first = NULL};
    int first = 0;
    int second = 0;
    fill(&o, 200, twice);
    mt_lanczos p = {.n = o.n, .wanted = 4, .seed = 1, .apply = apply, .context = &o};
    CHECK_INT(t, mt_lanczos_largest(&p, &mem, x, &first, NULL), MT_OK);
    p.n_locked = first;
    p.locked = x;
    CHECK_INT(t, mt_lanczos_largest(&p, &mem, x + ((ptrdiff_t)first * o.n), &second, NULL),
              MT_OK);
    CHECK_INT(t, first + second, 8);
    double theta[2 * WANTED];
    static double y[MOST];
    for (int j = 0; j < first + second; j++) {
        const double *const xj = x + ((ptrdiff_t)j * o.n);
        (void)apply(&o, 1, xj, y, NULL);
        theta[j] = mt_dot(o.n, xj, y);
        for (int k = 0; k < j; k++) {
            CHECK(t, fabs(mt_dot(o.n, xj, x + ((ptrdiff_t)k * o.n))) <= 1e-12);
        }
    }
    double sum = 0.0;
    for (int j = 0; j < first + second; j++) {
        sum += theta[j];
    }
    CHECK_NEAR(t, sum, 2.0 * (1.0 + 0.5 + (1.0 / 3.0) + 0.25), 1e-12);
    mt_arena_free(&mem);
}

/* As many directions of each as a block has columns; products are counted by the block. */
static void lanczos__finds_repeated_ones_in_blocks(mt_test *t)
{
    static operator_ o;
    static double x[MOST * WANTED];
    static const double theta[] = {1.0, 1.0, 0.5, 0.5, 1.0 / 3.0, 1.0 / 3.0};
    long calls = 0;
    for (int block = 2; block <= 4; block++) {
        mt_arena mem = {.first = NULL};
        int found = 0;
        mt_test_row(t, "block %d", block);
        fill(&o, 200, twice);
        mt_lanczos p = {.n = o.n,
                        .wanted = MT_COUNT(theta),
                        .block = block,
                        .seed = 1,
                        .apply = apply,
                        .context = &o};
        CHECK_INT(t, mt_lanczos_largest(&p, &mem, x, &found, NULL), MT_OK);
        CHECK_INT(t, found, MT_COUNT(theta));
        CHECK(t, block == 2 || o.calls < calls);
        calls = o.calls;
        for (int j = 0; j < found; j++) {
            const double *const xj = x + ((ptrdiff_t)j * o.n);
            static double y[MOST];
            (void)apply(&o, 1, xj, y, NULL);
            CHECK_NEAR(t, mt_dot(o.n, xj, y), theta[j], 1e-13);
        }
        mt_arena_free(&mem);
    }
}

static void lanczos__hands_failures_on(mt_test *t)
{
    static operator_ o;
    static double x[MOST * WANTED];
    mt_arena mem = {.first = NULL};
    mt_err err = {.text = ""};
    int found = 0;
    fill(&o, 100, dense);
    o.fail_at = 12;
    mt_lanczos p = {.n = o.n, .wanted = WANTED, .seed = 1, .apply = apply, .context = &o};
    CHECK_INT(t, mt_lanczos_largest(&p, &mem, x, &found, &err), MT_E_INTERRUPTED);
    CHECK_STR(t, err.text, "enough");
    fill(&o, 100, dense);
    o.d[3] = nan("");
    CHECK_INT(t, mt_lanczos_largest(&p, &mem, x, &found, &err), MT_E_DOMAIN);
    mt_arena_free(&mem);
}

MT_TEST_MAIN(MT_TEST(lanczos__finds_the_largest),
             MT_TEST(lanczos__finds_repeated_ones_among_what_is_left),
             MT_TEST(lanczos__finds_repeated_ones_in_blocks),
             MT_TEST(lanczos__hands_failures_on))
