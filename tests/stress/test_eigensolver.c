/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The kinds of matrices of LAPACK's own tests of symmetric eigenproblems (DCHKST, DDRVST,
 * DLATMS: given spectra, graded, clustered, near over- and underflow) through our doors to it,
 * against 113 bits. MT_STRESS_ROUNDS=N: N times as many, of other numbers. Prints a table.
 */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "linalg/dense.h"
#include "modal/modal.h"
#include "stress/matrices.h"
#include "stress/table.h"
#include "support/mt_test.h"
#include "support/solve_pair.h"

enum { ROWS = 28 };

/* Of n eps max |w|: a quarter of what modal counts on (MT_MODAL_NOISE_ULPS), which leaves the
 * rest to how matrices are made. LAPACK's own tests allow 50. */
static const double PROMISED = 4.0;
/* Relative, of the lowest eigenvalue that the data determine. */
static const double WANTED = 1e-10;

/* A line of the table. */
typedef struct line {
    const char *name;
    int cases;
    double error; /* relative */
    double share; /* of what is promised */
    clock_t began;
} line;

static line start(const char *name)
{
    return (line){.name = name, .began = clock()};
}

static void finish(const line *l)
{
    printf("%-34s %5d cases  error %8.1e  error/bound %8.1e  %6.3f s\n", l->name, l->cases,
           l->error, l->share, (double)(clock() - l->began) / CLOCKS_PER_SEC);
}

/* Under valgrind: OpenBLAS sums squares in the range of x87, which valgrind has not. */
static bool plain_range(void)
{
    return getenv("MT_TEST_LAUNCHED") != NULL;
}

/* Equation and orthogonality of the first `count` vectors. */
static void judge_vectors(mt_test *t, int n, int count, const double *a, const double *w,
                          const double *v, double unit)
{
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < n; k++) {
            quad equation = -(quad)w[i] * (quad)v[k + (i * n)];
            quad product = i == k ? -1 : 0;
            for (int j = 0; j < n; j++) {
                equation += (quad)a[k + (j * n)] * (quad)v[j + (i * n)];
                product += k < count ? (quad)v[j + (k * n)] * (quad)v[j + (i * n)] : 0;
            }
            CHECK(t, (double)quad_abs(equation) <= PROMISED * unit);
            CHECK(t, (double)quad_abs(product) <= PROMISED * n * DBL_EPSILON);
        }
    }
}

/* The same in two steps, for a part of the vectors. */
static void judge_part(mt_test *t, int n, int count, const double *a, const double *whole,
                       double unit)
{
    double v[MOST * MOST] = {0.0};
    double w[MOST];
    double low[MOST * MOST];
    mt_tridiagonal later;
    const mt_arena_mark mark = mt_arena_get_mark(&table_mem);
    memcpy(low, a, (size_t)(n * n) * sizeof *low);
    if (CHECK_INT(t, mt_eig_sym_values(n, low, w, &table_mem, &later, NULL), MT_OK) &&
        CHECK_INT(t, mt_eig_sym_lowest(&later, count, w, v, &table_mem, NULL), MT_OK)) {
        for (int i = 0; i < n; i++) {
            CHECK(t, fabs(w[i] - whole[i]) <= PROMISED * unit);
        }
        judge_vectors(t, n, count, a, w, v, unit);
    }
    mt_arena_rewind(&table_mem, mark);
}

/* The parts of n eps |w| that eigenvalues, equation and orthogonality are off. */
static void judge_solution(mt_test *t, int n, const double *a, const quad *want, line *l)
{
    double v[MOST * MOST];
    double w[MOST];
    double only[MOST];
    double low[MOST * MOST];
    memcpy(v, a, (size_t)(n * n) * sizeof *v);
    memcpy(low, a, (size_t)(n * n) * sizeof *low);
    if (!CHECK_INT(t, mt_eig_sym(n, v, w, true, &table_mem, NULL), MT_OK) ||
        !CHECK_INT(t, mt_eig_sym(n, low, only, false, &table_mem, NULL), MT_OK)) {
        return;
    }
    const double largest =
        (double)(quad_abs(want[0]) > quad_abs(want[n - 1]) ? quad_abs(want[0])
                                                           : quad_abs(want[n - 1]));
    const double unit = n * DBL_EPSILON * largest;
    for (int i = 0; i < n && largest > 0.0; i++) {
        const double off = (double)quad_abs((quad)w[i] - want[i]);
        const double off_only = (double)quad_abs((quad)only[i] - want[i]);
        l->error = fmax(l->error, off / largest);
        l->share = fmax(l->share, fmax(off, off_only) / (PROMISED * unit));
        CHECK(t, off <= PROMISED * unit && off_only <= PROMISED * unit);
    }
    if (largest > 0.0) {
        judge_vectors(t, n, n, a, w, v, unit);
        judge_part(t, n, n - (n / 3), a, w, unit);
    }
    l->cases++;
}

static void eigensolver__given_spectra(mt_test *t)
{
    static const int orders[] = {1, 2, 3, 5, 8, MOST};
    static const double ends[] = {0.5, 1e-6, 1e-12, DBL_EPSILON};
    static const double scales[] = {1.0, 1e138, 1e-138, 1e290, 1e-280};
    const int n_scales = MT_COUNT(scales) - (plain_range() ? 3 : 0);
    mt_random r = mt_random_seed(1);
    for (int kind = 0; kind < SPECTRA; kind++) {
        line l = start(spectrum_names[kind]);
        for (int k = 0; k < MT_COUNT(orders) * MT_COUNT(ends) * rounds(); k++) {
            const int n = orders[k % MT_COUNT(orders)];
            const double e = ends[(k / MT_COUNT(orders)) % MT_COUNT(ends)];
            const double scale = scales[mt_random_int(&r, n_scales)];
            quad d[MOST];
            quad want[MOST] = {0};
            quad exact[MOST * MOST];
            double a[MOST * MOST];
            mt_test_row(t, "%s to %g, n = %d, times %g", spectrum_names[kind], e, n, scale);
            make_spectrum((spectrum)kind, n, e, mt_random_int(&r, 2) == 0, &r, d);
            make_matrix(n, d, scale, &r, a, exact);
            quad_eigenvalues(n, exact, want);
            judge_solution(t, n, a, want, &l);
        }
        finish(&l);
    }
}

static void eigensolver__matrices_of_a_name(mt_test *t)
{
    line l = start("matrices of a name");
    for (int which = 0; which < MT_COUNT(named); which++) {
        for (int n = 1; n <= MOST; n++) {
            double a[MOST * MOST] = {0.0};
            quad exact[MOST * MOST];
            quad want[MOST] = {0};
            mt_test_row(t, "%s, n = %d", named[which].name, n);
            for (int j = 0; j < n; j++) {
                for (int i = 0; i < n; i++) {
                    a[i + (j * n)] = named[which].entry(n, i >= j ? i : j, abs(i - j));
                    exact[i + (j * n)] = (quad)a[i + (j * n)];
                }
            }
            quad_eigenvalues(n, exact, want);
            judge_solution(t, n, a, want, &l);
        }
    }
    finish(&l);
}

/* Counts are right at every shift that is further from all eigenvalues than rounding. */
static void eigensolver__counts_of_eigenvalues(mt_test *t)
{
    line l = start("counts below shifts");
    mt_random r = mt_random_seed(2);
    for (int k = 0; k < 60 * rounds(); k++) {
        const int n = 2 + mt_random_int(&r, MOST - 2);
        quad d[MOST];
        quad want[MOST] = {0};
        quad exact[MOST * MOST];
        double a[MOST * MOST];
        make_spectrum((spectrum)(k % SPECTRA), n, 1e-8, true, &r, d);
        make_matrix(n, d, 1.0, &r, a, exact);
        quad_eigenvalues(n, exact, want);
        for (int i = 0; i + 1 < n; i++) {
            const double shift = (double)((want[i] + want[i + 1]) / 2);
            const quad room = want[i + 1] - want[i];
            int count[3];
            if (room < (quad)(100.0 * n * DBL_EPSILON)) {
                continue;
            }
            mt_test_row(t, "%s, n = %d, above %d", spectrum_names[k % SPECTRA], n, i + 1);
            CHECK_INT(t, mt_inertia(n, a, NULL, shift, count, NULL, &table_mem, NULL), MT_OK);
            CHECK_INT(t, count[0], i + 1);
            CHECK_INT(t, count[2], n - 1 - i);
            l.cases++;
        }
    }
    finish(&l);
}

/* A structure of springs: K = B^T diag(c) B + G, M. */
typedef struct springs {
    int n;
    int rows;
    double b[ROWS * MOST];
    double c[ROWS];
    double g[MOST * MOST];
    double k[MOST * MOST];
    double m[MOST * MOST];
} springs;

static void assemble(springs *s)
{
    for (int j = 0; j < s->n; j++) {
        for (int i = 0; i < s->n; i++) {
            quad sum = (quad)s->g[i + (j * s->n)];
            for (int q = 0; q < s->rows; q++) {
                sum += (quad)s->c[q] * (quad)s->b[q + (i * s->rows)] *
                       (quad)s->b[q + (j * s->rows)];
            }
            s->k[i + (j * s->n)] = (double)sum;
        }
    }
}

/* Springs over `decades` of stiffness and masses over `masses`: in a row, or any; as many as
 * freedoms or more. */
static void make_springs(mt_random *r, double decades, double masses, springs *s)
{
    const bool row = mt_random_int(r, 2) == 0;
    memset(s, 0, sizeof *s);
    s->n = 2 + mt_random_int(r, 9);
    s->rows = s->n + (row ? 0 : mt_random_int(r, s->n));
    for (int q = 0; q < s->rows; q++) {
        s->c[q] = pow(10.0, mt_random_in(r, 0.0, decades));
        for (int i = 0; i < s->n; i++) {
            s->b[q + (i * s->rows)] = !row         ? mt_random_in(r, -1.0, 1.0)
                                      : i == q     ? 1.0
                                      : i == q - 1 ? -1.0
                                                   : 0.0;
        }
    }
    for (int i = 0; i < s->n; i++) {
        s->m[i + (i * s->n)] = pow(10.0, mt_random_in(r, 0.0, masses));
    }
    assemble(s);
}

/* want[n]: squares of the singular values of diag(sqrt c) B M^-1/2, M diagonal. */
static void exact_springs(const springs *s, quad *want)
{
    static quad x[ROWS * MOST];
    for (int i = 0; i < s->n; i++) {
        const quad mass = quad_root((quad)s->m[i + (i * s->n)]);
        for (int q = 0; q < s->rows; q++) {
            x[q + (i * s->rows)] =
                quad_root((quad)s->c[q]) * (quad)s->b[q + (i * s->rows)] / mass;
        }
    }
    quad_squares(s->rows, s->n, x, want);
}

/* want[n] of K as it is, M diagonal. */
static void exact_pencil(const springs *s, quad *want)
{
    static quad x[MOST * MOST];
    for (int j = 0; j < s->n; j++) {
        for (int i = 0; i < s->n; i++) {
            quad sum = (quad)s->g[i + (j * s->n)];
            for (int q = 0; q < s->rows; q++) {
                sum += (quad)s->c[q] * (quad)s->b[q + (i * s->rows)] *
                       (quad)s->b[q + (j * s->rows)];
            }
            x[i + (j * s->n)] = sum / quad_root((quad)s->m[i + (i * s->n)]) /
                                quad_root((quad)s->m[j + (j * s->n)]);
        }
    }
    quad_eigenvalues(s->n, x, want);
}

/* What the rounding of entries of B may do to lambda of shape y: of two stiff springs that are
 * almost parallel it is the difference that counts. */
static double open_by_rows(const springs *s, const double *y)
{
    quad sum = 0;
    for (int q = 0; q < s->rows; q++) {
        quad stretch = 0;
        quad terms = 0;
        for (int i = 0; i < s->n; i++) {
            stretch += (quad)s->b[q + (i * s->rows)] * (quad)y[i];
            terms += quad_abs((quad)s->b[q + (i * s->rows)] * (quad)y[i]);
        }
        sum += 2 * (quad)s->c[q] * quad_abs(stretch) * terms;
    }
    return (double)sum * DBL_EPSILON;
}

/* Errors against the bounds that are told; the lowest also against what is wanted. */
static void judge_modes(mt_test *t, const springs *s, const mt_modes *modes, const quad *want,
                        bool lowest, line *l)
{
    for (int i = 0; i < modes->count; i++) {
        const double off = (double)quad_abs((quad)modes->lambda[i] - want[i]);
        const double bound = modes->error[i] + open_by_rows(s, mt_modal_shape(modes, i));
        CHECK(t, off <= bound);
        l->share = off > 0.0 ? fmax(l->share, off / bound) : l->share;
    }
    if (lowest) {
        const double off = (double)(quad_abs((quad)modes->lambda[0] - want[0]) / want[0]);
        l->error = fmax(l->error, off);
        CHECK(t, off <= WANTED);
    }
    l->cases++;
}

static void eigensolver__springs_far_apart(mt_test *t)
{
    static const double ranges[][2] = {{12.0, 0.0}, {0.0, 9.0}, {12.0, 9.0}};
    static const char *const names[] = {"stiffnesses 1:1e12", "masses 1:1e9", "both"};
    mt_random r = mt_random_seed(3);
    for (int which = 0; which < MT_COUNT(ranges); which++) {
        line l = start(names[which]);
        for (int k = 0; k < 40 * rounds(); k++) {
            static springs s;
            quad want[MOST] = {0};
            mt_modes modes;
            mt_modal_options opt = mt_modal_options_default();
            make_springs(&r, ranges[which][0], ranges[which][1], &s);
            mt_test_row(t, "%s, case %d, n = %d", names[which], k, s.n);
            const mt_stiffness_factor factor = {.rows = s.rows, .b = s.b, .c = s.c};
            opt.accuracy = MT_MODAL_ACCURACY;
            exact_springs(&s, want);
            const mt_arena_mark mark = mt_arena_get_mark(&table_mem);
            if (CHECK_INT(t, solve_pair(s.n, s.k, s.m, &factor, &opt, &table_mem, &modes, NULL),
                          MT_OK)) {
                judge_modes(t, &s, &modes, want, true, &l);
            }
            mt_arena_rewind(&table_mem, mark);
        }
        finish(&l);
    }
}

/* A load of the size of the softest springs, that pulls or pushes. */
static void eigensolver__loads_on_springs_far_apart(mt_test *t)
{
    line l = start("loads on stiffnesses 1:1e12");
    mt_random r = mt_random_seed(4);
    for (int k = 0; k < 60 * rounds(); k++) {
        static springs s;
        quad want[MOST] = {0};
        mt_modes modes;
        mt_modal_options opt = mt_modal_options_default();
        make_springs(&r, 12.0, 0.0, &s);
        for (int j = 0; j < s.n; j++) {
            for (int i = j; i < s.n; i++) {
                s.g[i + (j * s.n)] = mt_random_in(&r, -0.1, 0.1);
                s.g[j + (i * s.n)] = s.g[i + (j * s.n)];
            }
        }
        assemble(&s);
        mt_test_row(t, "case %d, n = %d", k, s.n);
        const mt_stiffness_factor factor = {.rows = s.rows, .b = s.b, .c = s.c, .g = s.g};
        opt.accuracy = MT_MODAL_ACCURACY;
        exact_pencil(&s, want);
        const mt_arena_mark mark = mt_arena_get_mark(&table_mem);
        if (CHECK_INT(t, solve_pair(s.n, s.k, s.m, &factor, &opt, &table_mem, &modes, NULL),
                      MT_OK)) {
            judge_modes(t, &s, &modes, want, false, &l);
        }
        mt_arena_rewind(&table_mem, mark);
    }
    finish(&l);
}

/* Without factor: K of a given spectrum, some of it negative, units far from one. */
static void eigensolver__stiffness_as_a_matrix(mt_test *t)
{
    static const double units[] = {1.0, 1e-30, 1e100, 1e-150};
    const int n_units = MT_COUNT(units) - (plain_range() ? 1 : 0);
    line l = start("stiffness as a matrix");
    mt_random r = mt_random_seed(5);
    for (int k = 0; k < 60 * rounds(); k++) {
        static springs s;
        quad d[MOST];
        quad exact[MOST * MOST];
        quad want[MOST] = {0};
        mt_modes modes;
        memset(&s, 0, sizeof s);
        s.n = 2 + mt_random_int(&r, 9);
        make_spectrum((spectrum)(k % SPECTRA), s.n, 1e-10, k % 3 == 0, &r, d);
        make_matrix(s.n, d, units[mt_random_int(&r, n_units)], &r, s.k, exact);
        memcpy(s.g, s.k, sizeof s.g);
        const double unit = units[mt_random_int(&r, n_units)];
        for (int i = 0; i < s.n; i++) {
            s.m[i + (i * s.n)] =
                unit * pow(10.0, mt_random_in(&r, 0.0, k % 2 == 0 ? 9.0 : 0.0));
        }
        mt_test_row(t, "%s, case %d, n = %d", spectrum_names[k % SPECTRA], k, s.n);
        exact_pencil(&s, want);
        const mt_arena_mark mark = mt_arena_get_mark(&table_mem);
        if (CHECK_INT(t, solve_pair(s.n, s.k, s.m, NULL, NULL, &table_mem, &modes, NULL),
                      MT_OK)) {
            judge_modes(t, &s, &modes, want, false, &l);
        }
        mt_arena_rewind(&table_mem, mark);
    }
    finish(&l);
}

/* The checks themselves: an eigenvalue that is off by four times what is promised, and a bound
 * of nothing, are seen. */
static void eigensolver__wrong_answers_are_seen(mt_test *t)
{
    static springs s;
    mt_random r = mt_random_seed(6);
    quad want[MOST] = {0};
    mt_modes modes;
    line l = start("wrong");
    mt_test wrong = mt_test_begin();
    make_springs(&r, 2.0, 0.0, &s);
    exact_pencil(&s, want);
    want[0] += (quad)(4.0 * PROMISED * s.n * DBL_EPSILON) * want[s.n - 1];
    for (int i = 0; i < s.n; i++) {
        s.m[i + (i * s.n)] = 1.0;
    }
    wrong.quiet = true;
    judge_solution(&wrong, s.n, s.k, want, &l);
    CHECK(t, !mt_test_passed(&wrong));
    wrong = mt_test_begin();
    wrong.quiet = true;
    exact_pencil(&s, want);
    const mt_arena_mark mark = mt_arena_get_mark(&table_mem);
    REQUIRE(t, solve_pair(s.n, s.k, s.m, NULL, NULL, &table_mem, &modes, NULL) == MT_OK);
    judge_modes(t, &s, &modes, want, false, &l);
    modes.lambda[0] += 2.0 * modes.error[0];
    judge_modes(&wrong, &s, &modes, want, true, &l);
    CHECK(t, !mt_test_passed(&wrong));
    mt_arena_rewind(&table_mem, mark);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        MT_TEST(eigensolver__given_spectra),
        MT_TEST(eigensolver__matrices_of_a_name),
        MT_TEST(eigensolver__counts_of_eigenvalues),
        MT_TEST(eigensolver__springs_far_apart),
        MT_TEST(eigensolver__loads_on_springs_far_apart),
        MT_TEST(eigensolver__stiffness_as_a_matrix),
        MT_TEST(eigensolver__wrong_answers_are_seen),
    };
    return cmocka_run_group_tests_name(__FILE__, tests, prepare, release) != 0;
}
