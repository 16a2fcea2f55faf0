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
#include "stress/quad.h"
#include "support/mt_random.h"
#include "support/mt_test.h"
#include "support/solve_pair.h"

enum { MOST = 14, ROWS = 28 };

/* Of n eps max |w|: "about n eps" in the promise of mt_eig_sym. */
static const double PROMISED = 2.0;
/* Relative, of the lowest eigenvalue that the data determine. */
static const double WANTED = 1e-10;

static mt_arena mem;

typedef enum spectrum {
    ALL_EQUAL,  /* 1 1 1 ... */
    ONE_LARGE,  /* 1 e e e ... */
    ONE_SMALL,  /* 1 1 1 ... e */
    GEOMETRIC,  /* 1 ... e */
    ARITHMETIC, /* 1 ... e */
    DECADES,    /* anything between, evenly in the logarithm */
    UNIFORM,    /* anything in (-1, 1) */
    PAIRS,      /* 1 and its neighbour, e and its neighbour */
    SPECTRA
} spectrum;

static const char *const spectrum_names[SPECTRA] = {"all equal", "one large",  "one small",
                                                    "geometric", "arithmetic", "decades",
                                                    "uniform",   "pairs"};

/* d[n], from 1 to e. */
static void make_spectrum(spectrum kind, int n, double e, bool signs, mt_random *r, quad *d)
{
    const double last = n > 1 ? (double)(n - 1) : 1.0;
    for (int i = 0; i < n; i++) {
        const double part = (double)i / last;
        double x = 1.0;
        switch (kind) {
        case ALL_EQUAL:
            break;
        case ONE_LARGE:
            x = i == 0 ? 1.0 : e;
            break;
        case ONE_SMALL:
            x = i == n - 1 ? e : 1.0;
            break;
        case GEOMETRIC:
            x = pow(e, part);
            break;
        case ARITHMETIC:
            x = 1.0 - (part * (1.0 - e));
            break;
        case DECADES:
            x = pow(e, mt_random_in(r, 0.0, 1.0));
            break;
        case UNIFORM:
            x = mt_random_in(r, -1.0, 1.0);
            break;
        case PAIRS:
            x = (i < n / 2 ? 1.0 : e) * (1.0 + (DBL_EPSILON * (i % 2)));
            break;
        case SPECTRA:
            break;
        }
        d[i] = (quad)(signs && mt_random_int(r, 2) == 0 ? -x : x);
    }
}

/* x := H x H for random reflections H, as many as there are coordinates. */
static void mix(int n, mt_random *r, quad *x)
{
    quad v[MOST];
    for (int k = 0; k < n; k++) {
        quad norm = 0;
        for (int i = 0; i < n; i++) {
            v[i] = (quad)mt_random_in(r, -1.0, 1.0);
            norm += v[i] * v[i];
        }
        for (int side = 0; side < 2; side++) {
            for (int j = 0; j < n; j++) {
                const int step = side == 0 ? 1 : n;
                quad *const at = x + (side == 0 ? j * n : j);
                quad dot = 0;
                for (int i = 0; i < n; i++) {
                    dot += v[i] * at[i * step];
                }
                for (int i = 0; i < n; i++) {
                    at[i * step] -= 2 * dot / norm * v[i];
                }
            }
        }
    }
}

/* a: the matrix of that spectrum, rounded to doubles, times scale; exact: the same. */
static void make_matrix(int n, const quad *d, double scale, mt_random *r, double *a,
                        quad *exact)
{
    quad x[MOST * MOST] = {0};
    for (int i = 0; i < n; i++) {
        x[i + (i * n)] = d[i];
    }
    mix(n, r, x);
    for (int j = 0; j < n; j++) {
        for (int i = 0; i < n; i++) {
            const int at = i >= j ? i + (j * n) : j + (i * n);
            a[i + (j * n)] = (double)x[at] * scale;
            exact[i + (j * n)] = (quad)a[i + (j * n)];
        }
    }
}

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

static int rounds(void)
{
    const char *const text = getenv("MT_STRESS_ROUNDS");
    return text != NULL ? atoi(text) : 1;
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
    if (!CHECK_INT(t, mt_eig_sym(n, v, w, true, &mem, NULL), MT_OK) ||
        !CHECK_INT(t, mt_eig_sym(n, low, only, false, &mem, NULL), MT_OK)) {
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
        for (int k = 0; k < n; k++) {
            quad equation = -(quad)w[i] * (quad)v[k + (i * n)];
            quad product = i == k ? -1 : 0;
            for (int j = 0; j < n; j++) {
                equation += (quad)a[k + (j * n)] * (quad)v[j + (i * n)];
                product += (quad)v[j + (k * n)] * (quad)v[j + (i * n)];
            }
            CHECK(t, (double)quad_abs(equation) <= 2.0 * PROMISED * unit);
            CHECK(t, (double)quad_abs(product) <= 2.0 * PROMISED * n * DBL_EPSILON);
        }
    }
    l->cases++;
}

static void eigensolver__given_spectra(mt_test *t)
{
    static const int orders[] = {1, 2, 3, 5, 8, MOST};
    static const double ends[] = {0.5, 1e-6, 1e-12, DBL_EPSILON};
    static const double scales[] = {1.0, 1e138, 1e-138, 1e290, 1e-280};
    mt_random r = mt_random_seed(1);
    for (int kind = 0; kind < SPECTRA; kind++) {
        line l = start(spectrum_names[kind]);
        for (int k = 0; k < MT_COUNT(orders) * MT_COUNT(ends) * rounds(); k++) {
            const int n = orders[k % MT_COUNT(orders)];
            const double e = ends[(k / MT_COUNT(orders)) % MT_COUNT(ends)];
            const double scale = scales[mt_random_int(&r, MT_COUNT(scales))];
            quad d[MOST];
            quad want[MOST];
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

/* Entry i, j (i >= j) of matrices of a name. */
static double named(int which, int n, int i, int j)
{
    const int far = i - j;
    switch (which) {
    case 0:
        return 0.0; /* nothing */
    case 1:
        return far == 0 ? abs(n / 2 - i) : far == 1 ? 1.0 : 0.0; /* Wilkinson's W+ */
    case 2:
        return far == 0 ? 2.0 : far == 1 ? -1.0 : 0.0; /* second difference */
    case 3:
        return far == 1 ? sqrt((double)(i * (n - i))) : 0.0; /* Kac: -n+1 ... n-1 */
    case 4:
        return 1.0 / (i + j + 1); /* Hilbert */
    case 5:
        return far == 0 ? 1.0 : far == 1 ? 1e-9 : 0.0; /* almost equal */
    case 6:
        return pow(10.0, -i) * pow(10.0, -j) * (far == 0 ? 1.0 : 0.3); /* graded down */
    case 7:
        return pow(10.0, i - n) * pow(10.0, j - n) * (far == 0 ? 1 : .3); /* graded up */
    case 8:                                                               /* glued W+ */
        return far == 0   ? abs((n / 2) / 2 - (i % ((n / 2) + 1)))
               : far == 1 ? (i == (n / 2) + 1 ? 1e-8 : 1.0)
                          : 0.0;
    default:
        return (i == n - 1) != (j == n - 1) ? 1e-3 : far == 0 ? 1.0 : 0.0; /* arrow */
    }
}

static void eigensolver__matrices_of_a_name(mt_test *t)
{
    line l = start("matrices of a name");
    for (int which = 0; which < 10; which++) {
        for (int n = 1; n <= MOST; n++) {
            double a[MOST * MOST];
            quad exact[MOST * MOST];
            quad want[MOST];
            mt_test_row(t, "matrix %d, n = %d", which, n);
            for (int j = 0; j < n; j++) {
                for (int i = 0; i < n; i++) {
                    a[i + (j * n)] = i >= j ? named(which, n, i, j) : named(which, n, j, i);
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
        quad want[MOST];
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
            CHECK_INT(t, mt_inertia(n, a, NULL, shift, count, NULL, &mem, NULL), MT_OK);
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
            quad want[MOST];
            mt_modes modes;
            mt_modal_options opt = mt_modal_options_default();
            make_springs(&r, ranges[which][0], ranges[which][1], &s);
            mt_test_row(t, "%s, case %d, n = %d", names[which], k, s.n);
            const mt_stiffness_factor factor = {.rows = s.rows, .b = s.b, .c = s.c};
            opt.need_accuracy = true;
            exact_springs(&s, want);
            const mt_arena_mark mark = mt_arena_get_mark(&mem);
            if (CHECK_INT(t, solve_pair(s.n, s.k, s.m, &factor, &opt, &mem, &modes, NULL),
                          MT_OK)) {
                judge_modes(t, &s, &modes, want, true, &l);
            }
            mt_arena_rewind(&mem, mark);
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
        quad want[MOST];
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
        opt.need_accuracy = true;
        exact_pencil(&s, want);
        const mt_arena_mark mark = mt_arena_get_mark(&mem);
        if (CHECK_INT(t, solve_pair(s.n, s.k, s.m, &factor, &opt, &mem, &modes, NULL), MT_OK)) {
            judge_modes(t, &s, &modes, want, false, &l);
        }
        mt_arena_rewind(&mem, mark);
    }
    finish(&l);
}

/* Without factor: K of a given spectrum, some of it negative, units far from one. */
static void eigensolver__stiffness_as_a_matrix(mt_test *t)
{
    static const double units[] = {1.0, 1e-150, 1e100, 1e-30};
    line l = start("stiffness as a matrix");
    mt_random r = mt_random_seed(5);
    for (int k = 0; k < 60 * rounds(); k++) {
        static springs s;
        quad d[MOST];
        quad exact[MOST * MOST];
        quad want[MOST];
        mt_modes modes;
        memset(&s, 0, sizeof s);
        s.n = 2 + mt_random_int(&r, 9);
        make_spectrum((spectrum)(k % SPECTRA), s.n, 1e-10, k % 3 == 0, &r, d);
        make_matrix(s.n, d, units[mt_random_int(&r, MT_COUNT(units))], &r, s.k, exact);
        memcpy(s.g, s.k, sizeof s.g);
        const double unit = units[mt_random_int(&r, MT_COUNT(units))];
        for (int i = 0; i < s.n; i++) {
            s.m[i + (i * s.n)] =
                unit * pow(10.0, mt_random_in(&r, 0.0, k % 2 == 0 ? 9.0 : 0.0));
        }
        mt_test_row(t, "%s, case %d, n = %d", spectrum_names[k % SPECTRA], k, s.n);
        exact_pencil(&s, want);
        const mt_arena_mark mark = mt_arena_get_mark(&mem);
        if (CHECK_INT(t, solve_pair(s.n, s.k, s.m, NULL, NULL, &mem, &modes, NULL), MT_OK)) {
            judge_modes(t, &s, &modes, want, false, &l);
        }
        mt_arena_rewind(&mem, mark);
    }
    finish(&l);
}

static int prepare(void **state)
{
    (void)state;
    return mt_arena_init(&mem, (size_t)1 << 20, NULL) == MT_OK ? 0 : 1;
}

static int release(void **state)
{
    (void)state;
    mt_arena_free(&mem);
    return 0;
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
    };
    return cmocka_run_group_tests_name(__FILE__, tests, prepare, release) != 0;
}
