/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A part of the modes against all of them, for random systems of orders on both sides of the
 * one where another method takes over: rigid-body modes, clusters and repeated modes of any
 * place and size, systems that fall apart (matrices with rows of zeros), stiffnesses far apart,
 * masses that are the identity, a diagonal, or full.
 */
#include <math.h>

#include "linalg/dense.h"
#include "modal/modal.h"
#include "support/mt_alloc.h"
#include "support/mt_random.h"
#include "support/mt_test.h"

enum { LEAST = 24, MOST = 60, TRIALS = 300 };

/* A good solver stays below one, LAPACK's own tests ask for 30. */
static const double RATIO = 5.0;

static mt_arena mem;

typedef struct system {
    int n;
    double k[MOST * MOST];
    double m[MOST * MOST];
    double q[MOST * MOST];
    double work[MOST * MOST];
} system;

/* a := X^T a X, all of it. */
static void turn(system *s, const double *x, double *a)
{
    mt_gemm(false, false, s->n, s->n, s->n, 1.0, a, s->n, x, s->n, 0.0, s->work, s->n);
    mt_gemm(true, false, s->n, s->n, s->n, 1.0, x, s->n, s->work, s->n, 0.0, a, s->n);
    for (int j = 0; j < s->n; j++) {
        for (int i = j + 1; i < s->n; i++) {
            a[j + (i * s->n)] = a[i + (j * s->n)];
        }
    }
}

/* Eigenvalues: some zero, then groups of equal ones, steps of any size. */
static void spectrum(mt_random *g, system *s)
{
    double lambda = 0.0;
    int left = mt_random_int(g, 4);
    const double wide = mt_random_in(g, 0.0, 3.0);
    for (int i = 0; i < s->n; i++) {
        if (left == 0) {
            left = 1 + (mt_random_int(g, 4) == 0 ? mt_random_int(g, 6) : 0);
            lambda = (lambda + mt_random_in(g, 0.1, 1.0)) *
                     pow(10.0, mt_random_in(g, 0.0, wide) / 8.0);
        }
        s->k[i + (i * s->n)] = lambda;
        left--;
    }
}

/* Householder's reflection of the coordinates from `from` on. */
static void reflect(mt_random *g, system *s, int from)
{
    double v[MOST] = {0.0};
    mt_random_fill(g, s->n - from, v + from);
    const double norm = mt_norm2(s->n, v);
    for (int j = 0; j < s->n; j++) {
        for (int i = 0; i < s->n; i++) {
            s->q[i + (j * s->n)] = (i == j ? 1.0 : 0.0) - (2.0 * v[i] * v[j] / (norm * norm));
        }
    }
}

static void make(mt_random *g, system *s)
{
    *s = (system){.n = LEAST + mt_random_int(g, MOST - LEAST + 1)};
    spectrum(g, s);
    for (int i = 0; i < s->n; i++) {
        s->m[i + (i * s->n)] = 1.0;
    }
    /* up to three reflections; none, or of a part: the system falls apart */
    for (int turns = mt_random_int(g, 4); turns > 0; turns--) {
        reflect(g, s, mt_random_int(g, 2) * mt_random_int(g, LEAST - 1));
        turn(s, s->q, s->k);
    }
    /* other coordinates: diagonal ones, or full */
    const int kind = mt_random_int(g, 3);
    for (int j = 0; j < s->n && kind > 0; j++) {
        for (int i = 0; i < s->n; i++) {
            const double beside =
                kind > 1 ? 0.3 * mt_random_in(g, -1.0, 1.0) / sqrt(s->n) : 0.0;
            s->q[i + (j * s->n)] = i == j ? mt_random_in(g, 0.5, 2.0) : beside;
        }
    }
    if (kind > 0) {
        turn(s, s->q, s->k);
        turn(s, s->q, s->m);
    }
}

static bool solve_with(mt_test *t, const system *s, const mt_modal_options *opt, mt_modes *out)
{
    mt_mass_factor mass;
    mt_err err = {.text = ""};
    return CHECK_INT(t, mt_modal_factor_mass(s->n, s->m, &mem, &mass, &err), MT_OK) &&
           CHECK_INT(t, mt_modal_solve(s->k, &mass, NULL, opt, &mem, out, &err), MT_OK);
}

static bool solve(mt_test *t, const system *s, int first, bool vectors, mt_modes *out)
{
    mt_modal_options opt = mt_modal_options_default();
    opt.modes.first = first;
    opt.vectors = vectors;
    return solve_with(t, s, &opt, out);
}

static void compare(mt_test *t, const mt_modes *part, const mt_modes *whole, int first)
{
    int flexible = 0;
    CHECK_INT(t, part->all, whole->count);
    CHECK_INT(t, part->n_rigid, whole->n_rigid);
    CHECK_INT(t, mt_modal_vibrations(part), mt_modal_vibrations(whole));
    for (int i = 0; i < part->count; i++) {
        CHECK_NEAR_ABS(t, part->lambda[i], whole->lambda[i], part->error[i] + whole->error[i]);
        CHECK_INT(t, part->kind[i], whole->kind[i]);
        CHECK_INT(t, part->cluster[i], whole->cluster[i]);
        flexible += part->kind[i] == MT_MODE_FLEXIBLE ? 1 : 0;
        if (part->y != NULL) {
            CHECK(t, part->residual[i] <= RATIO * t->tol_scale);
            CHECK(t, part->orthogonality[i] <= RATIO * t->tol_scale);
        }
    }
    const int there = mt_modal_vibrations(whole);
    CHECK(t, flexible >= (first < there ? first : there));
    /* no cluster is cut, and no more is given than was asked for */
    const int end = part->count;
    CHECK(t, end == whole->count || whole->cluster[end] != whole->cluster[end - 1]);
    int size = 0;
    const int last = mt_modal_flexible(whole, first);
    const int begin = last < 0 ? 0 : mt_modal_cluster(whole, last, &size);
    CHECK(t, last < 0 || end == begin + size);
}

static void modal__a_part_is_what_the_whole_has(mt_test *t)
{
    mt_random g = mt_random_seed(41);
    static system s;
    for (int trial = 0; trial < TRIALS; trial++) {
        mt_modes whole;
        mt_modes part;
        make(&g, &s);
        const int first = 1 + mt_random_int(&g, mt_random_int(&g, 4) == 0 ? MOST : 12);
        const bool vectors = mt_random_int(&g, 4) > 0;
        const mt_arena_mark mark = mt_arena_get_mark(&mem);
        mt_test_row(t, "trial %d, n = %d, first %d", trial, s.n, first);
        if (solve(t, &s, 0, true, &whole) && solve(t, &s, first, vectors, &part)) {
            CHECK(t, (part.y != NULL) == vectors);
            compare(t, &part, &whole, first);
        }
        mt_arena_rewind(&mem, mark);
    }
}

/* How many of the lowest hold all of a part: with all of its last cluster. */
static int end_of(const mt_modes *whole, mt_modal_part part)
{
    int end = 0;
    for (int i = 0, seen = 0; i < whole->count; i++) {
        const bool flexible = whole->kind[i] == MT_MODE_FLEXIBLE;
        seen += flexible ? 1 : 0;
        const bool asked = seen <= part.first || whole->lambda[i] <= part.up_to;
        end = !flexible || asked ? i + 1 : end;
    }
    while (end > 0 && end < whole->count && whole->cluster[end] == whole->cluster[end - 1]) {
        end++;
    }
    return end;
}

/* None, or one between modes that are not repeated: which side each is on is sure. */
static double any_frequency(mt_random *g, const mt_modes *whole)
{
    int i = mt_random_int(g, whole->count);
    while (i + 1 < whole->count && whole->cluster[i + 1] == whole->cluster[i]) {
        i++;
    }
    const double next = i + 1 < whole->count ? whole->lambda[i + 1] : 2.0 * whole->lambda[i];
    return mt_random_int(g, 4) == 0 ? 0.0 : 0.5 * (whole->lambda[i] + next);
}

static void modal__shapes_of_a_part_stand_beside_all_frequencies(mt_test *t)
{
    mt_random g = mt_random_seed(43);
    static system s;
    long fewer = 0;
    for (int trial = 0; trial < TRIALS; trial++) {
        mt_modal_options opt = mt_modal_options_default();
        mt_modes whole;
        mt_modes part;
        make(&g, &s);
        const mt_arena_mark mark = mt_arena_get_mark(&mem);
        mt_test_row(t, "trial %d, n = %d", trial, s.n);
        if (!solve_with(t, &s, &opt, &whole)) {
            continue;
        }
        opt.shapes.first = mt_random_int(&g, 2) * mt_random_int(&g, MOST / 2);
        opt.shapes.up_to = any_frequency(&g, &whole);
        const bool all = opt.shapes.first == 0 && opt.shapes.up_to == 0.0;
        if (solve_with(t, &s, &opt, &part)) {
            const int end = all ? whole.count : end_of(&whole, opt.shapes);
            CHECK_INT(t, part.count, whole.count);
            CHECK_INT(t, part.shaped, end);
            CHECK(t, part.shaped == part.count || mt_modal_shape(&part, part.shaped) == NULL);
            for (int i = 0; i < part.count; i++) {
                CHECK_NEAR_ABS(t, part.lambda[i], whole.lambda[i],
                               part.error[i] + whole.error[i]);
                CHECK_INT(t, part.kind[i], whole.kind[i]);
            }
            for (int i = 0; i < part.shaped; i++) {
                CHECK(t, part.residual[i] <= RATIO * t->tol_scale);
                CHECK(t, part.orthogonality[i] <= RATIO * t->tol_scale);
            }
            fewer += part.shaped < part.count ? 1 : 0;
        }
        mt_arena_rewind(&mem, mark);
    }
    CHECK(t, fewer > TRIALS / 2);
}

/* Solves of a part, memory failing at the nth request or never. */
static mt_status solve_quietly(const system *s, mt_arena *from)
{
    mt_modal_options opt = mt_modal_options_default();
    mt_mass_factor mass;
    mt_modes modes;
    opt.modes.first = 5;
    MT_TRY(mt_modal_factor_mass(s->n, s->m, from, &mass, NULL));
    return mt_modal_solve(s->k, &mass, NULL, &opt, from, &modes, NULL);
}

static void modal__a_part_needs_no_heap_and_reports_failing_memory(mt_test *t)
{
    enum { BLOCK = 64, SOLVES = 5 }; /* blocks so small that nearly each request needs one */
    mt_random g = mt_random_seed(42);
    static system s;
    do {
        make(&g, &s);
    } while (s.n < MOST - LEAST);
    if (!mt_alloc_works()) {
        CHECK(t, !mt_alloc_works()); /* a sanitizer has the allocator */
        return;
    }
    const mt_arena_mark mark = mt_arena_get_mark(&mem);
    long before = 0;
    for (int i = 0; i < SOLVES; i++) {
        before = i == 1 ? mt_alloc_count() : before; /* the first call may fill the arena */
        CHECK_INT(t, solve_quietly(&s, &mem), MT_OK);
        mt_arena_rewind(&mem, mark);
    }
    CHECK_INT(t, mt_alloc_count() - before, 0);
    mt_status rc = MT_E_MEMORY;
    for (long nth = 0; rc != MT_OK && nth < 1000; nth++) {
        mt_arena tiny;
        mt_test_row(t, "allocation %ld", nth);
        REQUIRE(t, mt_arena_init(&tiny, BLOCK, NULL) == MT_OK);
        mt_alloc_fail_after(nth);
        rc = solve_quietly(&s, &tiny);
        mt_alloc_fail_after(-1);
        mt_arena_free(&tiny);
        CHECK(t, rc == MT_E_MEMORY || (rc == MT_OK && nth > 10));
    }
    CHECK_INT(t, rc, MT_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        MT_TEST(modal__a_part_is_what_the_whole_has),
        MT_TEST(modal__shapes_of_a_part_stand_beside_all_frequencies),
        MT_TEST(modal__a_part_needs_no_heap_and_reports_failing_memory)};
    const int failed = mt_arena_init(&mem, 0, NULL) != MT_OK
                           ? 1
                           : cmocka_run_group_tests_name(__FILE__, tests, NULL, NULL);
    mt_arena_free(&mem);
    return failed != 0;
}
