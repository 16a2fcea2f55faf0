/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Kernels of measure.h: values against independent formulas, gradients and Hessians against
 * slopes in the exponential chart, derivatives by complex step against slopes. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "base/base.h"
#include "mechanics/data.h"
#include "support/mt_random.h"
#include "support/mt_slope.h"
#include "support/mt_test.h"

static const double STEP = 1e-2; /* the kernels bend on the scale of 1 */
static const double NOISE = 1e-15;
static const double PI = 3.14159265358979323846;

/* each strain of a beam in space, and those of one in the plane, counts as a kind */
static const mt_beam_strain IN_PLANE[] = {MT_BEAM_STRETCH, MT_BEAM_BEND_3, MT_BEAM_SWAY_3};
enum {
    IN_SPACE = MT_MEASURE_BEAM + MT_BEAM_STRAINS,
    KINDS = IN_SPACE + MT_COUNT(IN_PLANE),
    VECTORS = 7
};
static const char *const NAMES[KINDS] = {"plane",
                                         "dot",
                                         "distance",
                                         "angle",
                                         "rotation",
                                         "stretch",
                                         "twist",
                                         "bend 2",
                                         "bend 3",
                                         "sway 2",
                                         "sway 3",
                                         "stretch in the plane",
                                         "bend in the plane",
                                         "sway in the plane"};

typedef struct scene {
    mt_measure_data m;
    mt_cx v[VECTORS][3]; /* points 2, directions 3, numbers of a beam 2 */
    mt_pose pose[2];
    int entry; /* of the gradient, in slopes of it */
} scene;

static void random_unit(mt_random *r, double *v)
{
    double n = 0.0;
    do {
        mt_random_fill(r, 3, v);
        n = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    } while (!(n > 0.1));
    for (int i = 0; i < 3; i++) {
        v[i] /= n;
    }
}

/* Turned by `angle` about a random axis, somewhere in the unit cube. */
static mt_pose random_pose(mt_random *r, double angle)
{
    mt_pose p = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}};
    double x[3];
    double axis[3];
    mt_random_fill(r, 3, x);
    random_unit(r, axis);
    for (int i = 0; i < 3; i++) {
        axis[i] *= angle;
    }
    mt_pose_move(&p, x, axis);
    return p;
}

static void cross(const double *a, const double *b, double *c)
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

/* The measure sees the vectors of its scene. */
static void point_at_own(scene *s)
{
    for (int i = 0; i < 2; i++) {
        s->m.point[i] = s->v[i];
        s->m.beam.shape[i] = s->v[6][i];
    }
    for (int i = 0; i < 3; i++) {
        s->m.dir[i] = s->v[2 + i];
    }
    s->m.beam.length = s->v[5][0];
    s->m.beam.polar = s->v[5][1];
}

/* A random measure of the kind; body b turned by `angle` against body a. */
static void make(mt_random *r, int kind, double angle, scene *s)
{
    double e[3][3];
    double x[3];
    memset(s, 0, sizeof *s);
    random_unit(r, e[0]);
    random_unit(r, x);
    cross(e[0], x, e[1]);
    const double n = sqrt(e[1][0] * e[1][0] + e[1][1] * e[1][1] + e[1][2] * e[1][2]);
    for (int i = 0; i < 3; i++) {
        e[1][i] /= n;
    }
    cross(e[0], e[1], e[2]);
    for (int k = 0; k < VECTORS; k++) {
        mt_random_fill(r, 3, x);
        for (int i = 0; i < 3; i++) {
            s->v[k][i] = k >= 2 && k < 5 ? e[k - 2][i] : x[i];
        }
    }
    s->pose[0] = random_pose(r, mt_random_in(r, 0.0, 3.0));
    s->pose[1] = s->pose[0];
    const mt_pose other = random_pose(r, angle);
    for (int c = 0; c < 3; c++) {
        cx_rotate3(other.r, s->pose[0].r + (ptrdiff_t)3 * c, s->pose[1].r + (ptrdiff_t)3 * c);
        s->pose[1].x[c] = other.x[c] + 2.0;
    }
    s->v[5][0] = 1.0 + (0.5 * s->v[5][0]);
    s->m = (mt_measure_data){.kind = (mt_measure_kind)kind, .component = mt_random_int(r, 3)};
    if (kind >= MT_MEASURE_BEAM) {
        s->m.kind = MT_MEASURE_BEAM;
        s->m.beam.plane = kind >= IN_SPACE;
        s->m.component =
            kind >= IN_SPACE ? (int)IN_PLANE[kind - IN_SPACE] : kind - MT_MEASURE_BEAM;
    }
    point_at_own(s);
}

/* Poses moved by x[12] in the exponential chart. */
static void displaced(const scene *s, const double *x, mt_pose p[2])
{
    for (int b = 0; b < 2; b++) {
        p[b] = s->pose[b];
        const double *const dx = x + (ptrdiff_t)6 * b;
        mt_pose_move(&p[b], dx, dx + 3);
    }
}

static double value_at(const void *ctx, int n, const double *x)
{
    const scene *const s = ctx;
    mt_pose p[2];
    (void)n;
    displaced(s, x, p);
    return creal(mt_measure_value(&s->m, &p[0], &p[1], NULL)) + 1.0; /* rounding: of size one */
}

/* Slope along direction `entry` of the value at x: by its fourth-order difference, exact to
 * 1e-12. */
static double inner_slope(const void *ctx, int n, const double *x)
{
    static const double AT[] = {-3.0, -2.0, -1.0, 1.0, 2.0, 3.0};
    static const double WEIGHT[] = {-1.0 / 60.0, 9.0 / 60.0,  -45.0 / 60.0,
                                    45.0 / 60.0, -9.0 / 60.0, 1.0 / 60.0};
    const scene *const s = ctx;
    const double h = 5e-3;
    double y[MT_LOCAL];
    double d = 0.0;
    memcpy(y, x, sizeof y);
    for (int k = 0; k < 6; k++) {
        y[s->entry] = x[s->entry] + AT[k] * h;
        d += WEIGHT[k] / h * value_at(ctx, n, y);
    }
    return d + 1.0;
}

static void check_gradient(mt_test *t, scene *s, const char *name, double angle)
{
    /* near half a turn kernels bend more */
    const double step = angle > 2.0 ? 0.1 * STEP : STEP;
    double x[MT_LOCAL] = {0.0};
    mt_jet jet;
    mt_measure_eval(&s->m, &s->pose[0], &s->pose[1], false, NULL, &jet);
    CHECK_NEAR_ABS(t, creal(jet.value) + 1.0, value_at(s, MT_LOCAL, x), 1e-15);
    for (int i = 0; i < MT_LOCAL; i++) {
        mt_test_row(t, "%s, %g rad, gradient %d", name, angle, i);
        CHECK(t, mt_slope_agrees(value_at, s, MT_LOCAL, x, i, creal(jet.g[i]), step, NOISE));
    }
}

/* The Hessian of the chart off its diagonal: mixed slopes of the value itself. */
static void check_hessian(mt_test *t, scene *s, const char *name, double angle)
{
    static const double INNER_NOISE = 1e-12;
    double x[MT_LOCAL] = {0.0};
    mt_jet jet;
    mt_measure_eval(&s->m, &s->pose[0], &s->pose[1], true, NULL, &jet);
    for (int i = 0; i < MT_LOCAL; i++) {
        s->entry = i;
        for (int k = 0; k < MT_LOCAL; k++) {
            const double h = creal(jet.h[i + (MT_LOCAL * k)]);
            mt_test_row(t, "%s, %g rad, Hessian %d %d", name, angle, i, k);
            CHECK_NEAR_ABS(t, creal(jet.h[k + (MT_LOCAL * i)]), h, 1e-14 * (1.0 + fabs(h)));
            if (i != k) {
                CHECK(t, mt_slope_agrees(inner_slope, s, MT_LOCAL, x, k, h, STEP, INNER_NOISE));
            }
        }
    }
}

static void measure__gradient_and_hessian_agree_with_slopes(mt_test *t)
{
    static const double ANGLES[] = {0.0, 1e-6, 0.1, 0.2, 1.2, 2.5, 3.0};
    mt_random r = mt_random_seed(7);
    for (int kind = 0; kind < KINDS; kind++) {
        for (int a = 0; a < MT_COUNT(ANGLES); a++) {
            scene s;
            make(&r, kind, ANGLES[a], &s);
            check_gradient(t, &s, NAMES[kind], ANGLES[a]);
            if (ANGLES[a] < 2.0) {
                check_hessian(t, &s, NAMES[kind], ANGLES[a]);
            }
        }
    }
}

/* Second slope along one direction: f'' = (f(h) - 2 f(0) + f(-h))/h^2. */
static void measure__diagonal_of_the_hessian_agrees_with_second_differences(mt_test *t)
{
    mt_random r = mt_random_seed(8);
    for (int kind = 0; kind < KINDS; kind++) {
        for (int k = 0; k < MT_LOCAL; k++) {
            const double h = 2e-3;
            scene s;
            mt_jet jet;
            double x[MT_LOCAL] = {0.0};
            double f[5];
            make(&r, kind, 0.9, &s);
            mt_measure_eval(&s.m, &s.pose[0], &s.pose[1], true, NULL, &jet);
            for (int i = 0; i < 5; i++) {
                x[k] = (i - 2) * h;
                f[i] = value_at(&s, MT_LOCAL, x);
            }
            const double second =
                (16.0 * (f[1] + f[3]) - f[0] - f[4] - 30.0 * f[2]) / (12.0 * h * h);
            mt_test_row(t, "%s, %d", NAMES[kind], k);
            CHECK_NEAR_ABS(t, creal(jet.h[k + (MT_LOCAL * k)]), second, 1e-8);
        }
    }
}

/* In two dimensions a fourth of the entries is made, and these are those of three. */
static void measure__the_plane_has_the_entries_of_space(mt_test *t)
{
    mt_random r = mt_random_seed(10);
    for (int kind = 0; kind < KINDS; kind++) {
        scene s;
        mt_jet space;
        mt_jet plane;
        make(&r, kind, 0.9, &s);
        mt_measure_eval(&s.m, &s.pose[0], &s.pose[1], true, NULL, &space);
        memset(&plane, 0xff, sizeof plane); /* NaN */
        s.m.plane = true;
        mt_measure_eval(&s.m, &s.pose[0], &s.pose[1], true, NULL, &plane);
        for (int k = 0; k < MT_LOCAL * MT_LOCAL; k++) {
            const int row = (k % MT_LOCAL) % 6;
            const int column = (k / MT_LOCAL) % 6;
            const bool in = (row < 2 || row == 5) && (column < 2 || column == 5);
            mt_test_row(t, "%s, entry %d", NAMES[kind], k);
            CHECK(t, plane.h[k] == (in ? space.h[k] : 0.0));
        }
        for (int k = 0; k < MT_LOCAL; k++) {
            CHECK(t, plane.g[k] == space.g[k]);
        }
        CHECK(t, plane.value == space.value);
    }
}

static void measure__a_wrong_gradient_is_caught(mt_test *t)
{
    mt_random r = mt_random_seed(9);
    for (int kind = 0; kind < KINDS; kind++) {
        scene s;
        mt_jet jet;
        double x[MT_LOCAL] = {0.0};
        make(&r, kind, 0.8, &s);
        mt_measure_eval(&s.m, &s.pose[0], &s.pose[1], false, NULL, &jet);
        mt_test_row(t, "%s", NAMES[kind]);
        CHECK(t, !mt_slope_agrees(value_at, &s, MT_LOCAL, x, 3, creal(jet.g[3]) + 1e-6, 1e-4,
                                  NOISE));
    }
}

/* All data carry a derivative along a line parameter; the imaginary part must be the slope
 * along it. */
typedef struct line {
    scene s;
    double v[VECTORS][3]; /* direction of each vector */
    double q[MT_LOCAL];
} line;

static double along(const void *ctx, int n, const double *x)
{
    const line *const l = ctx;
    scene s = l->s;
    double q[MT_LOCAL];
    mt_pose p[2];
    (void)n;
    for (int k = 0; k < VECTORS; k++) {
        for (int i = 0; i < 3; i++) {
            s.v[k][i] = l->s.v[k][i] + x[0] * l->v[k][i];
        }
    }
    point_at_own(&s);
    for (int i = 0; i < MT_LOCAL; i++) {
        q[i] = x[0] * l->q[i];
    }
    displaced(&s, q, p);
    return creal(mt_measure_value(&s.m, &p[0], &p[1], NULL));
}

static void measure__complex_step_carries_derivatives(mt_test *t)
{
    mt_random r = mt_random_seed(10);
    for (int kind = 0; kind < KINDS; kind++) {
        line l;
        mt_pose p[2];
        double x[1] = {0.0};
        make(&r, kind, 0.15, &l.s);
        mt_random_fill(&r, 3 * VECTORS, &l.v[0][0]);
        mt_random_fill(&r, MT_LOCAL, l.q);
        if (kind >= MT_MEASURE_ROTATION) {
            memset(l.v[2], 0, 9 * sizeof(double)); /* a triad stays one */
        }
        line c = l;
        for (int k = 0; k < VECTORS; k++) {
            for (int i = 0; i < 3; i++) {
                c.s.v[k][i] = cx_make(creal(l.s.v[k][i]), l.v[k][i]);
            }
        }
        for (int i = 0; i < 2; i++) {
            p[i] = l.s.pose[i];
            mt_pose_tangent(&p[i], l.q + (ptrdiff_t)6 * i, l.q + (ptrdiff_t)6 * i + 3);
        }
        point_at_own(&c.s);
        const mt_cx value = mt_measure_value(&c.s.m, &p[0], &p[1], NULL);
        mt_test_row(t, "%s", NAMES[kind]);
        CHECK(t, mt_slope_agrees(along, &l, 1, x, 0, cx_derivative(value), STEP, NOISE));
    }
}

/* Body b turned by theta about a unit axis against body a. */
static void rotation_vector(double angle, const double *axis, double xi[3])
{
    mt_pose a = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}};
    mt_pose b = a;
    static const double none[3] = {0.0, 0.0, 0.0};
    static const mt_cx e[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    const double theta[3] = {angle * axis[0], angle * axis[1], angle * axis[2]};
    mt_pose_move(&b, none, theta);
    for (int k = 0; k < 3; k++) {
        const mt_measure_data m = {
            .kind = MT_MEASURE_ROTATION, .component = k, .dir = {e[0], e[1], e[2]}};
        xi[k] = creal(mt_measure_value(&m, &a, &b, NULL));
    }
}

static void measure__rotation_vector_is_that_of_the_turn(mt_test *t)
{
    /* around the switch from series to closed form (1 - cos = 0.01 at 0.1415 rad) and near
     * pi */
    static const double ANGLES[] = {0.0,    1e-300, 1e-12, 1e-8,   1e-4, 0.1, 0.1414,
                                    0.1416, 0.5,    1.0,   PI / 2, 2.0,  2.9, 3.0};
    mt_random r = mt_random_seed(11);
    for (int i = 0; i < MT_COUNT(ANGLES); i++) {
        double axis[3];
        double xi[3];
        random_unit(&r, axis);
        rotation_vector(ANGLES[i], axis, xi);
        mt_test_row(t, "%g rad", ANGLES[i]);
        for (int k = 0; k < 3; k++) {
            /* near pi the sine loses digits: eps/(pi - angle) */
            CHECK_NEAR_ABS(t, xi[k], ANGLES[i] * axis[k],
                           8.0 * DBL_EPSILON * ANGLES[i] / (1.0 - ANGLES[i] / PI) +
                               1e-16 * ANGLES[i]);
        }
    }
}

/* Body b at (1, 2, 0) turned by 0.3 about z; a at the origin. */
static void measure__values_match_plane_geometry(mt_test *t)
{
    mt_pose a = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}};
    mt_pose b = a;
    static const double x[3] = {1.0, 2.0, 0.0};
    static const double turn[3] = {0.0, 0.0, 0.3};
    static const mt_cx ex[3] = {1.0, 0.0, 0.0};
    static const mt_cx ey[3] = {0.0, 1.0, 0.0};
    static const mt_cx p[3] = {0.5, 0.0, 0.0};
    mt_measure_data m = {.kind = MT_MEASURE_PLANE, .point = {p, p}, .dir = {ey, ex, NULL}};
    mt_pose_move(&b, x, turn);
    CHECK_NEAR(t, creal(mt_measure_value(&m, &a, &b, NULL)), 2.0 + 0.5 * sin(0.3), 1e-15);
    m.kind = MT_MEASURE_DISTANCE;
    CHECK_NEAR(t, creal(mt_measure_value(&m, &a, &b, NULL)),
               hypot(0.5 + 0.5 * cos(0.3), 2.0 + 0.5 * sin(0.3)), 1e-15);
    m.kind = MT_MEASURE_DOT; /* ey . (R ex) */
    CHECK_NEAR(t, creal(mt_measure_value(&m, &a, &b, NULL)), sin(0.3), 1e-15);
    m = (mt_measure_data){.kind = MT_MEASURE_ANGLE, .dir = {ex, ey, NULL}};
    CHECK_NEAR(t, creal(mt_measure_value(&m, &a, &b, NULL)), 0.3, 1e-15);
    mt_jet jet; /* work of a force at a point of b */
    static const mt_cx f[3] = {3.0, -2.0, 0.0};
    mt_measure_point(p, f, &b, true, &jet);
    CHECK_NEAR(t, creal(jet.value), 3.0 * (1.0 + 0.5 * cos(0.3)) - 2.0 * (2.0 + 0.5 * sin(0.3)),
               1e-14);
    CHECK_NEAR(t, creal(jet.g[5]), -3.0 * 0.5 * sin(0.3) - 2.0 * 0.5 * cos(0.3), 1e-15);
    CHECK_NEAR(t, creal(jet.h[5 + (MT_LOCAL * 5)]),
               -3.0 * 0.5 * cos(0.3) + 2.0 * 0.5 * sin(0.3), 1e-15);
}

MT_TEST_MAIN(MT_TEST(measure__gradient_and_hessian_agree_with_slopes),
             MT_TEST(measure__diagonal_of_the_hessian_agrees_with_second_differences),
             MT_TEST(measure__the_plane_has_the_entries_of_space),
             MT_TEST(measure__a_wrong_gradient_is_caught),
             MT_TEST(measure__complex_step_carries_derivatives),
             MT_TEST(measure__rotation_vector_is_that_of_the_turn),
             MT_TEST(measure__values_match_plane_geometry))
