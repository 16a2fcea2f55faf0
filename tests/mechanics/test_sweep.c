/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Joints driven through their range, against closed forms of linkages. */
#include <float.h>
#include <stdlib.h>

#include "mechanics/mech.h"
#include "mechanics/sweep.h"
#include "support/mt_alloc.h"

enum { POINTS = 101 };

/* Positions repeat to rounding of lengths times the worst ratio of the linkage (about 10). */
static const double TOL = 1e-12;
/* A limit position is located to 1e-7 of the longest step. */
static const double LIMIT_TOL = 1e-7;

/* A sweep with all it needs. */
typedef struct run {
    mt_model *model; /* owned */
    mt_system *sys;
    mt_linear *lin;
    mt_arena mem;
    mt_sweep sweep;
    mt_status rc;
    mt_err err;
} run;

static void run_free(run *r)
{
    mt_linear_delete(r->lin);
    mt_system_delete(r->sys);
    mt_arena_free(&r->mem);
    mt_model_delete(r->model);
    *r = (run){0};
}

/* Takes the model. */
static bool run_sweep(mt_test *t, mt_model *model, const char *configuration,
                      const mt_system_drive *drive, const double range[2], int n, run *r)
{
    double positions[POINTS];
    double input[1] = {0.0};
    *r = (run){.model = model};
    if (model == NULL || !CHECK(t, mt_arena_init(&r->mem, 0, &r->err) == MT_OK)) {
        return false;
    }
    const int c = configuration == NULL ? 0 : mt_model_find_configuration(model, configuration);
    mt_sweep_range(range[0], range[1], n, positions);
    r->rc = mt_system_new_of(
        &(mt_system_def){.model = model, .configuration = c, .drive = drive, .at = input},
        &r->sys, &r->err);
    if (r->rc == MT_OK) {
        r->rc = mt_linear_new(r->sys, &r->lin, &r->err);
    }
    if (r->rc == MT_OK) {
        r->rc = mt_sweep_run(r->lin, NULL, &(mt_sweep_plan){.n = n, .positions = positions},
                             NULL, &r->mem, &r->sweep, &r->err);
    }
    return r->rc == MT_OK;
}

static const mt_sweep_point *reached(mt_test *t, const run *r, int i)
{
    const mt_sweep_point *const p = &r->sweep.points[i];
    mt_test_row(t, "point %d, at %.6g", i, p->drive[0]);
    if (!CHECK(t, p->status == MT_OK)) {
        (void)fprintf(stderr, "%s\n", p->why);
        return NULL;
    }
    return p;
}

static int joint(const run *r, const char *name)
{
    return mt_system_find_joint(r->sys, name);
}

/* x without whole turns. */
static double within_turn(double x)
{
    return x - 2.0 * MECH_PI * round(x / (2.0 * MECH_PI));
}

/* The linkage of tests/models/four_bar.json, for a crank at angle t2: rocker by Freudenstein's
 * equation
 *     K1 cos t4 - K2 cos t2 + K3 = cos(t2 - t4),
 * in half angles, and coupler from the positions of its ends. */
typedef struct four_bar {
    double a;
    double b;
    double c;
    double d;
} four_bar;

static void four_bar_angles(const four_bar *f, double t2, double *t3, double *t4)
{
    const double k1 = f->d / f->a;
    const double k2 = f->d / f->c;
    const double k3 =
        (f->a * f->a - f->b * f->b + f->c * f->c + f->d * f->d) / (2.0 * f->a * f->c);
    const double p = cos(t2) - k1 - k2 * cos(t2) + k3;
    const double q = -2.0 * sin(t2);
    const double s = k1 - (k2 + 1.0) * cos(t2) + k3;
    *t4 = 2.0 * atan2(-q - sqrt(q * q - 4.0 * p * s), 2.0 * p);
    *t3 = atan2(f->c * sin(*t4) - f->a * sin(t2), f->d + f->c * cos(*t4) - f->a * cos(t2));
}

static void sweep__four_bar_obeys_freudenstein(mt_test *t)
{
    const four_bar f = {0.15, hypot(0.35 - 0.15 * cos(1.0), 0.25 - 0.15 * sin(1.0)),
                        hypot(0.05, 0.25), 0.4};
    const mt_system_drive drive = {.joint = "jA"};
    double t30 = 0.0;
    double t40 = 0.0;
    run r;
    four_bar_angles(&f, 1.0, &t30, &t40);
    CHECK_NEAR(t, within_turn(t40), atan2(0.25, -0.05), TOL); /* the branch that is drawn */
    if (CHECK(t, run_sweep(t, mech_load(t, "four_bar"), "still", &drive,
                           (const double[]){-4.0 * MECH_PI, 7.0}, POINTS, &r))) {
        for (int i = 0; i < POINTS; i++) {
            const mt_sweep_point *const p = reached(t, &r, i);
            if (p == NULL) {
                continue;
            }
            const double t2 = 1.0 + p->drive[0];
            double t3 = 0.0;
            double t4 = 0.0;
            four_bar_angles(&f, t2, &t3, &t4);
            const double coupler =
                p->coordinate[joint(&r, "jA")] + p->coordinate[joint(&r, "jB")];
            const double w3 = f.a * sin(t4 - t2) / (f.b * sin(t3 - t4));
            const double w4 = f.a * sin(t2 - t3) / (f.c * sin(t4 - t3));
            const double worst = fmax(1.0, fmax(fabs(w3), fabs(w4)));
            CHECK_NEAR_ABS(t, p->coordinate[joint(&r, "jA")], p->drive[0], TOL);
            CHECK_NEAR_ABS(t, within_turn(p->coordinate[joint(&r, "jD")] - t4 + t40), 0.0, TOL);
            CHECK_NEAR_ABS(t, within_turn(coupler - t3 + t30), 0.0, TOL);
            CHECK_NEAR_ABS(t, p->ratio[joint(&r, "jD")], w4, 10.0 * TOL * worst * worst);
            CHECK_NEAR_ABS(t, p->ratio[joint(&r, "jB")], w3 - 1.0, 10.0 * TOL * worst * worst);
            /* the rocker swings, it does not go round: the crank does */
            CHECK(t, fabs(p->coordinate[joint(&r, "jD")]) < MECH_PI);
            CHECK(t, p->gap_m <= TOL);
        }
    }
    run_free(&r);
}

static void sweep__ratio_is_the_slope_of_the_coordinate(mt_test *t)
{
    static const char *const configurations[] = {"still", "loaded", "trimmed"};
    const mt_system_drive drives[] = {
        {.joint = "jA"}, {.joint = "jD"}, {.joint = "jA", .spring = "servo"}};
    const double h = 1e-4;
    for (int k = 0; k < MT_COUNT(drives); k++) {
        run r;
        if (CHECK(t, run_sweep(t, mech_load(t, "four_bar"), configurations[k], &drives[k],
                               (const double[]){0.3 - h, 0.3 + h}, 3, &r))) {
            const mt_sweep_point *const p = r.sweep.points;
            for (int j = 0; j < r.sweep.n_joints; j++) {
                mt_test_row(t, "%s, %s", configurations[k], r.sys->joints[j].name);
                CHECK_NEAR_ABS(t, p[1].ratio[j],
                               (p[2].coordinate[j] - p[0].coordinate[j]) / (2.0 * h), 1e-6);
            }
        }
        run_free(&r);
    }
}

/* Crank 0.1 m at 60 degrees, rod 0.3 m, slider along x. */
#define SLIDER_CRANK                                                                           \
    "{ \"format\": \"modetune-model/1\", \"name\": \"slider-crank\", \"dimension\": 2,"        \
    "  \"points\": { \"B\": [\"0.1*cos(pi/3)\", \"0.1*sin(pi/3)\"],"                           \
    "    \"C\": [\"0.1*cos(pi/3)+sqrt(0.09-(0.1*sin(pi/3))^2)\", 0] },"                        \
    "  \"bodies\": ["                                                                          \
    "    { \"name\": \"crank\", \"mass_kg\": 1, \"inertia_kg_m2\": 1e-3, \"centre\": [0, 0] "  \
    "},"                                                                                       \
    "    { \"name\": \"rod\", \"mass_kg\": 1, \"inertia_kg_m2\": 1e-2, \"centre\": \"B\" },"   \
    "    { \"name\": \"piston\", \"mass_kg\": 1, \"inertia_kg_m2\": 1e-3, \"centre\": \"C\" "  \
    "} ],"                                                                                     \
    "  \"joints\": ["                                                                          \
    "    { \"name\": \"shaft\", \"type\": \"revolute\", \"bodies\": [\"ground\", \"crank\"], " \
    "\"at\": [0, 0] },"                                                                        \
    "    { \"name\": \"big_end\", \"type\": \"revolute\", \"bodies\": [\"crank\", \"rod\"], "  \
    "\"at\": \"B\" },"                                                                         \
    "    { \"name\": \"small_end\", \"type\": \"revolute\", \"bodies\": [\"rod\", "            \
    "\"piston\"], \"at\": \"C\" },"                                                            \
    "    { \"name\": \"bore\", \"type\": \"prismatic\", \"bodies\": [\"ground\", "             \
    "\"piston\"], \"at\": \"C\", \"axis\": [1, 0] } ] }"

/* The point lies beyond the limit of the slider, which is named. */
static void expect_limit(mt_test *t, const mt_sweep_point *p, double limit)
{
    static const char begin[] = "joint \"bore\" cannot be driven beyond ";
    CHECK(t, p->status == MT_E_ASSEMBLY);
    if (CHECK(t, p->why != NULL && strncmp(p->why, begin, sizeof begin - 1) == 0)) {
        CHECK_NEAR_ABS(t, strtod(p->why + sizeof begin - 1, NULL), limit, 1e-6);
        CHECK(t, strstr(p->why, " m: limit position, where joint \"") != NULL);
    }
}

static void sweep__slider_crank_stops_at_its_limit_positions(mt_test *t)
{
    const mt_system_drive drive = {.joint = "bore"};
    const double x0 = 0.05 + sqrt(0.09 - 0.0075);
    run r;
    if (CHECK(t, run_sweep(t, mech_parse(t, SLIDER_CRANK), NULL, &drive,
                           (const double[]){-0.3, 0.3}, 61, &r))) {
        CHECK_INT(t, r.sweep.n_reached, 20); /* from -0.13 m to 0.06 m, by 10 mm */
        for (int i = 0; i < 61; i++) {
            const mt_sweep_point *const p = &r.sweep.points[i];
            const double x = x0 + p->drive[0];
            mt_test_row(t, "slider at %g", x);
            if (x > 0.2 && x < 0.4) {
                const double cosine = (x * x + 0.01 - 0.09) / (2.0 * 0.1 * x);
                CHECK(t, p->status == MT_OK);
                CHECK_NEAR_ABS(t, p->coordinate[joint(&r, "shaft")],
                               acos(cosine) - MECH_PI / 3.0, 100.0 * TOL);
            } else {
                expect_limit(t, p, (p->drive[0] > 0.0 ? 0.4 : 0.2) - x0);
            }
        }
    }
    run_free(&r);
}

static void sweep__the_crank_of_a_slider_crank_goes_round(mt_test *t)
{
    const mt_system_drive drive = {.joint = "shaft"};
    const double x0 = 0.05 + sqrt(0.09 - 0.0075);
    run r;
    if (CHECK(t, run_sweep(t, mech_parse(t, SLIDER_CRANK), NULL, &drive,
                           (const double[]){-10.0, 20.0}, POINTS, &r))) {
        for (int i = 0; i < POINTS; i++) {
            const mt_sweep_point *const p = reached(t, &r, i);
            if (p != NULL) {
                const double a = MECH_PI / 3.0 + p->drive[0];
                const double root = sqrt(0.09 - 0.01 * sin(a) * sin(a));
                CHECK_NEAR_ABS(t, p->coordinate[joint(&r, "shaft")], p->drive[0], 10.0 * TOL);
                CHECK_NEAR_ABS(t, p->coordinate[joint(&r, "bore")], 0.1 * cos(a) + root - x0,
                               TOL);
                CHECK_NEAR_ABS(t, p->ratio[joint(&r, "bore")],
                               -0.1 * sin(a) * (1.0 + 0.1 * cos(a) / root), TOL);
                /* the rod's own angle stays small: its joint turns back against the crank */
                CHECK_NEAR_ABS(t, p->coordinate[joint(&r, "big_end")] + p->drive[0], 0.0, 0.7);
            }
        }
    }
    run_free(&r);
}

/* Positions that differ by rounding only: what a closure corrects is longer than the way. */
static void sweep__the_last_digit_of_a_position_is_reached(mt_test *t)
{
    static const double start[] = {-7.1, -0.1, 0.1, 0.3, 1.0, 9.8};
    const mt_system_drive drive = {.joint = "shaft"};
    for (size_t k = 0; k < sizeof start / sizeof *start; k++) {
        const double end = start[k] + (100.0 * DBL_EPSILON);
        run r;
        mt_test_row(t, "from %g", start[k]);
        if (CHECK(t, run_sweep(t, mech_parse(t, SLIDER_CRANK), NULL, &drive,
                               (const double[]){start[k], end}, POINTS, &r))) {
            CHECK_INT(t, r.sweep.n_reached, POINTS);
            for (int i = 0; i < POINTS; i++) {
                const mt_sweep_point *const p = reached(t, &r, i);
                if (p != NULL) {
                    CHECK_NEAR_ABS(t, p->coordinate[joint(&r, "shaft")], start[k], TOL);
                }
            }
        }
        run_free(&r);
    }
}

static void sweep__limit_is_located(mt_test *t)
{
    const mt_system_drive drive = {.joint = "bore"};
    const double x0 = 0.05 + sqrt(0.09 - 0.0075);
    run r;
    if (CHECK(t, run_sweep(t, mech_parse(t, SLIDER_CRANK), NULL, &drive,
                           (const double[]){0.2, 0.2}, 1, &r))) {
        CHECK_INT(t, r.sweep.n_reached, 0);
        CHECK_NEAR_ABS(t, mt_linear_position(r.lin)->driven.drive[0], 0.4 - x0, LIMIT_TOL);
        CHECK(t, mt_linear_position(r.lin)->driven.drive[0] <= 0.4 - x0);
    }
    run_free(&r);
}

/* A servo shaft about z with a crank arm, a rod between two ball joints, a stick about an
 * oblique axis: with P on the crank and Q on the stick, |P - Q|^2 = L^2 is A cos f + B sin f =
 * C. The rod's idle spin is free. */
#define SERVO_STICK                                                                            \
    "{ \"format\": \"modetune-model/1\", \"name\": \"servo and stick\", \"dimension\": 3,"     \
    "  \"points\": { \"O\": [0, 0, 0], \"P\": [0.05, 0, 0.02], \"Q\": [0.1, 0.2, 0.1], "       \
    "\"S\": [0.1, 0.2, 0.3] },"                                                                \
    "  \"bodies\": ["                                                                          \
    "    { \"name\": \"crank\", \"mass_kg\": 0.2, \"inertia_kg_m2\": [1e-4, 1e-4, 2e-4], "     \
    "\"centre\": \"O\" },"                                                                     \
    "    { \"name\": \"rod\", \"mass_kg\": 0.1, \"inertia_kg_m2\": [1e-4, 2e-4, 3e-4, 1e-5, "  \
    "0, 0], \"centre\": [0.075, 0.1, 0.06] },"                                                 \
    "    { \"name\": \"stick\", \"mass_kg\": 1, \"inertia_kg_m2\": [0.01, 0.01, 0.002], "      \
    "\"centre\": [0.1, 0.2, 0.35] } ],"                                                        \
    "  \"joints\": ["                                                                          \
    "    { \"name\": \"shaft\", \"type\": \"revolute\", \"bodies\": [\"ground\", \"crank\"], " \
    "\"at\": \"O\", \"axis\": [0, 0, 1] },"                                                    \
    "    { \"name\": \"port\", \"type\": \"spherical\", \"bodies\": [\"crank\", \"rod\"], "    \
    "\"at\": \"P\" },"                                                                         \
    "    { \"name\": \"starboard\", \"type\": \"spherical\", \"bodies\": [\"rod\", "           \
    "\"stick\"], \"at\": \"Q\" },"                                                             \
    "    { \"name\": \"pivot\", \"type\": \"revolute\", \"bodies\": [\"ground\", \"stick\"], " \
    "\"at\": \"S\", \"axis\": [3, 0, 4] } ],"                                                  \
    "  \"springs\": [ { \"name\": \"servo\", \"type\": \"torsion\", \"joint\": \"shaft\", "    \
    "\"stiffness_n_m_per_rad\": 50 } ],"                                                       \
    "  \"configurations\": { \"still\": {}, \"heavy\": { \"gravity_m_per_s2\": [0, 0, -9.81] " \
    "} } }"

/* v turned by angle about the unit axis n. */
static void turn(const double n[3], double angle, const double v[3], double out[3])
{
    const double dot = n[0] * v[0] + n[1] * v[1] + n[2] * v[2];
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3;
        const int j = (k + 2) % 3;
        out[k] = v[k] * cos(angle) + (n[i] * v[j] - n[j] * v[i]) * sin(angle) +
                 n[k] * dot * (1.0 - cos(angle));
    }
}

static double dot3(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Stick angle for shaft angle s, on the branch next to `near`; *ratio its derivative. */
static double stick_angle(double s, double near, double *ratio)
{
    static const double axis[3] = {0.6, 0.0, 0.8};
    static const double z[3] = {0.0, 0.0, 1.0};
    static const double p0[3] = {0.05, 0.0, 0.02};
    static const double pivot[3] = {0.1, 0.2, 0.3};
    static const double arm[3] = {0.0, 0.0, -0.2}; /* Q - S */
    const double length2 = 0.05 * 0.05 + 0.2 * 0.2 + 0.08 * 0.08;
    double p[3];
    double w[3];     /* S - P */
    double cross[3]; /* axis x arm */
    double q[3];
    double link[3];
    turn(z, s, p0, p);
    turn(axis, MECH_PI / 2.0, arm, cross);
    const double along = dot3(axis, arm);
    for (int k = 0; k < 3; k++) {
        cross[k] -= axis[k] * along; /* turn by 90 degrees keeps the axial part */
        w[k] = pivot[k] - p[k];
    }
    /* |w + arm(f)|^2 = w.w + arm.arm + 2 w.arm(f) */
    const double a = dot3(w, arm) - dot3(w, axis) * along;
    const double b = dot3(w, cross);
    const double c = 0.5 * (length2 - dot3(w, w) - dot3(arm, arm)) - dot3(w, axis) * along;
    const double middle = atan2(b, a);
    const double half = acos(c / hypot(a, b));
    const double f1 = within_turn(middle + half);
    const double f2 = within_turn(middle - half);
    const double f = fabs(f1 - near) < fabs(f2 - near) ? f1 : f2;
    turn(axis, f, arm, q);
    const double dp[3] = {-p[1], p[0], 0.0};
    const double dq[3] = {axis[1] * q[2] - axis[2] * q[1], axis[2] * q[0] - axis[0] * q[2],
                          axis[0] * q[1] - axis[1] * q[0]};
    for (int k = 0; k < 3; k++) {
        link[k] = w[k] + q[k];
    }
    *ratio = dot3(dp, link) / dot3(dq, link);
    return f;
}

static void sweep__servo_moves_the_stick_in_space(mt_test *t)
{
    static const char *const configurations[] = {"still", "heavy"};
    const mt_system_drive drives[] = {{.joint = "shaft"},
                                      {.joint = "shaft", .spring = "servo"}};
    for (int k = 0; k < MT_COUNT(drives); k++) {
        run r;
        double near = 0.0;
        if (CHECK(t, run_sweep(t, mech_parse(t, SERVO_STICK), configurations[k], &drives[k],
                               (const double[]){0.0, 2.0 * MECH_PI}, 61, &r))) {
            for (int i = 0; i < 61; i++) {
                const mt_sweep_point *const p = reached(t, &r, i);
                double ratio = 0.0;
                near = stick_angle(p == NULL ? 0.0 : p->drive[0], near, &ratio);
                if (p != NULL) {
                    CHECK_NEAR_ABS(t, p->coordinate[joint(&r, "pivot")], near, 10.0 * TOL);
                    CHECK_NEAR_ABS(t, p->ratio[joint(&r, "pivot")], ratio, 100.0 * TOL);
                    CHECK(t, isnan(p->ratio[joint(&r, "port")]));
                }
            }
        }
        run_free(&r);
    }
}

static void sweep__a_locked_rod_is_held_by_its_moment(mt_test *t)
{
    /* V = k a^2/2 - (m/2 + m_d) g L cos a, wound up twice */
    const mt_system_drive drives[] = {{.joint = "pivot"},
                                      {.joint = "pivot", .spring = "servo"}};
    for (int k = 0; k < MT_COUNT(drives); k++) {
        run r;
        if (CHECK(t, run_sweep(t, mech_load(t, "driven_rod"), "sprung", &drives[k],
                               (const double[]){-13.0, 13.0}, 53, &r))) {
            for (int i = 0; i < 53; i++) {
                const mt_sweep_point *const p = reached(t, &r, i);
                if (p != NULL) {
                    const double weight = (1.0 + 0.5) * 9.81 * 0.8 * sin(p->drive[0]);
                    const double want = k == 0 ? 40.0 * p->drive[0] + weight : -weight;
                    CHECK_NEAR_ABS(t, p->hold[0], want, 1e-9);
                    CHECK_NEAR_ABS(t, p->coordinate[joint(&r, "axle")], 0.0, 1e-11);
                }
            }
        }
        run_free(&r);
    }
}

static void sweep__meets_the_configuration_that_drives_the_same(mt_test *t)
{
    const mt_system_drive drives[] = {{.joint = "pivot"},
                                      {.joint = "pivot", .spring = "servo"}};
    static const char *const configurations[] = {"locked", "trimmed"};
    mt_model *const model = mech_load(t, "driven_rod");
    for (int k = 0; k < MT_COUNT(drives) && model != NULL; k++) {
        mt_analysis *own = NULL;
        mt_analysis *outside = NULL;
        mt_err err = {.text = ""};
        const double at[] = {0.5235987755982988};
        mt_test_row(t, "%s", configurations[k]);
        const int c = mt_model_find_configuration(model, configurations[k]);
        if (CHECK(t, mt_analysis_new(model, c, 0, NULL, at, &own, &err) == MT_OK) &&
            CHECK(t, mt_analysis_new_of(
                         &(mt_system_def){.model = model, .drive = &drives[k], .at = at}, 0,
                         &outside, &err) == MT_OK)) {
            CHECK_INT(t, outside->modes.count, own->modes.count);
            for (int i = 0; i < own->modes.count; i++) {
                CHECK_NEAR(t, outside->modes.lambda[i], own->modes.lambda[i], TOL);
            }
        }
        mt_analysis_delete(own);
        mt_analysis_delete(outside);
    }
    mt_model_delete(model);
}

static void sweep__refuses_in_words(mt_test *t)
{
    static const struct {
        const char *file;
        const char *configuration;
        mt_system_drive drive;
        const char *text;
    } rows[] = {
        {"driven_rod",
         "sprung",
         {.joint = "pivat", .spring = NULL},
         "drive: there is no joint \"pivat\" in configuration \"sprung\"; did you mean "
         "\"pivot\"?"},
        {"driven_rod",
         "sprung",
         {.joint = "pivot", .spring = "serve"},
         "drive: there is no spring \"serve\" to hold it in configuration \"sprung\""},
        {"space_body",
         "ball",
         {.joint = "ball", .spring = NULL},
         "drive: joint \"ball\" (spherical) has no coordinate to drive"},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        run r;
        mt_test_row(t, "%s", rows[i].text);
        CHECK(t, !run_sweep(t, mech_load(t, rows[i].file), rows[i].configuration,
                            &rows[i].drive, (const double[]){0.0, 1.0}, 2, &r));
        CHECK(t, r.rc == MT_E_INPUT);
        CHECK_STR(t, r.err.text, rows[i].text);
        run_free(&r);
    }
}

/* The arm of driven_arm.json at s and e: k w + g h r cos(s + e + w) = 0 at the wrist, and what
 * the locks hold, the springs of their joints included. */
static void check_arm_point(mt_test *t, const run *r, const mt_sweep_point *p)
{
    const double arms[] = {0.5 * (1.0 + 1.2 + 0.5), 0.4 * (0.6 + 0.5), 0.1 * 0.5};
    const double s = p->drive[0];
    const double e = p->drive[1];
    const int wrist = joint(r, "wrist");
    double w = 0.0;
    for (int i = 0; i < 60; i++) {
        w = -9.81 * arms[2] * cos(s + e + w) / 60.0;
    }
    const double down = 9.81 * arms[2] * sin(s + e + w);
    const double fore = 9.81 * (arms[1] * cos(s + e) + arms[2] * cos(s + e + w));
    CHECK_NEAR_ABS(t, p->coordinate[wrist], w, TOL);
    CHECK_NEAR_ABS(t, p->coordinate[joint(r, "shoulder")], s, TOL);
    CHECK_NEAR_ABS(t, p->coordinate[joint(r, "elbow")], e, TOL);
    for (int d = 0; d < 2; d++) {
        CHECK_NEAR_ABS(t, p->ratio[wrist + (d * r->sweep.n_joints)], down / (60.0 - down), TOL);
    }
    CHECK_NEAR_ABS(t, p->hold[0], 900.0 * s + 9.81 * arms[0] * cos(s) + fore, 1e-9);
    CHECK_NEAR_ABS(t, p->hold[1], 400.0 * e + fore, 1e-9);
}

static void sweep__two_joints_go_a_path_or_over_a_grid(mt_test *t)
{
    enum { SIDE = 4 };
    const mt_system_drive drives[] = {{.joint = "shoulder"}, {.joint = "elbow"}};
    for (int grid = 0; grid < 2; grid++) {
        const int n = grid == 1 ? SIDE * SIDE : SIDE;
        double positions[2 * SIDE * SIDE];
        run r = {.model = mech_load(t, "driven_arm")};
        for (ptrdiff_t i = 0; i < n; i++) {
            positions[2 * i] = -0.5 + (0.4 * (double)(grid == 1 ? i / SIDE : i));
            positions[(2 * i) + 1] = 2.0 - (0.9 * (double)(i % SIDE));
        }
        const mt_system_def def = {.model = r.model,
                                   .configuration =
                                       mt_model_find_configuration(r.model, "drawn"),
                                   .drive = drives,
                                   .n_drives = 2,
                                   .at = positions};
        const mt_sweep_plan plan = {
            .n = n, .n_drives = 2, .line = grid == 1 ? SIDE : 0, .positions = positions};
        r.rc = mt_arena_init(&r.mem, 0, &r.err);
        r.rc = r.rc == MT_OK ? mt_system_new_of(&def, &r.sys, &r.err) : r.rc;
        r.rc = r.rc == MT_OK ? mt_linear_new(r.sys, &r.lin, &r.err) : r.rc;
        r.rc = r.rc == MT_OK ? mt_sweep_run(r.lin, NULL, &plan, NULL, &r.mem, &r.sweep, &r.err)
                             : r.rc;
        if (CHECK(t, r.rc == MT_OK && r.sweep.n_reached == n)) {
            for (int i = 0; i < n; i++) {
                mt_test_row(t, "%s, point %d", grid == 1 ? "grid" : "path", i);
                check_arm_point(t, &r, &r.sweep.points[i]);
            }
        }
        run_free(&r);
    }
}

/* Crank and rocker of a four-bar: one freedom. */
static void sweep__two_drives_of_one_freedom_are_named(mt_test *t)
{
    const mt_system_drive drives[] = {{.joint = "jA"}, {.joint = "jD"}};
    const double at[] = {0.0, 0.0};
    run r = {.model = mech_load(t, "four_bar")};
    const mt_system_def def = {.model = r.model, .drive = drives, .n_drives = 2, .at = at};
    r.rc = mt_arena_init(&r.mem, 0, &r.err);
    r.rc = r.rc == MT_OK ? mt_system_new_of(&def, &r.sys, &r.err) : r.rc;
    r.rc = r.rc == MT_OK ? mt_linear_new(r.sys, &r.lin, &r.err) : r.rc;
    if (CHECK(t, r.rc == MT_OK)) {
        CHECK(t, mt_linear_update(r.lin, at, false, &r.err) == MT_E_INPUT);
        CHECK_STR(t, r.err.text,
                  "joints \"jA\" and \"jD\" cannot both be driven: they are one freedom of the "
                  "loop of joints \"jA\", \"jB\", \"jC\", \"jD\", and driving one moves the "
                  "other");
    }
    run_free(&r);
}

static void sweep__a_joint_that_others_hold_is_named(mt_test *t)
{
    const mt_system_drive drive = {.joint = "left"};
    run r;
    if (CHECK(t, run_sweep(t,
                           mech_parse(t, "{ \"format\": \"modetune-model/1\", \"name\": "
                                         "\"triangle\", \"dimension\": 2,"
                                         "  \"bodies\": [ { \"name\": \"a\", \"mass_kg\": 1, "
                                         "\"inertia_kg_m2\": 1, \"centre\": [0, 1] },"
                                         "    { \"name\": \"b\", \"mass_kg\": 1, "
                                         "\"inertia_kg_m2\": 1, \"centre\": [2, 1] } ],"
                                         "  \"joints\": ["
                                         "    { \"name\": \"left\", \"type\": \"revolute\", "
                                         "\"bodies\": [\"ground\", \"a\"], \"at\": [0, 0] },"
                                         "    { \"name\": \"right\", \"type\": \"revolute\", "
                                         "\"bodies\": [\"ground\", \"b\"], \"at\": [2, 0] },"
                                         "    { \"name\": \"top\", \"type\": \"revolute\", "
                                         "\"bodies\": [\"a\", \"b\"], \"at\": [1, 2] } ] }"),
                           NULL, &drive, (const double[]){0.0, 0.1}, 2, &r))) {
        CHECK_STR(t, r.sweep.points[1].why,
                  "joint \"left\" cannot be driven: the other joints hold it where it is (or "
                  "it stands at a limit position)");
    }
    run_free(&r);
}

static void sweep__failing_allocations_are_errors(mt_test *t)
{
    const mt_system_drive drive = {.joint = "shaft", .spring = "servo"};
    mt_model *const model = mech_parse(t, SERVO_STICK);
    CHECK(t, model != NULL);
    for (long nth = 0; model != NULL && mt_alloc_works(); nth++) {
        const double positions[] = {-0.2, 0.1, 0.3};
        const double at[] = {0.0};
        run r = {.rc = MT_OK};
        const long before = mt_alloc_live();
        mt_alloc_fail_after(nth);
        r.rc = mt_arena_init(&r.mem, 0, &r.err);
        if (r.rc == MT_OK) {
            r.rc = mt_system_new_of(&(mt_system_def){.model = model, .drive = &drive, .at = at},
                                    &r.sys, &r.err);
        }
        if (r.rc == MT_OK) {
            r.rc = mt_linear_new(r.sys, &r.lin, &r.err);
        }
        if (r.rc == MT_OK) {
            r.rc = mt_sweep_run(r.lin, NULL, &(mt_sweep_plan){.n = 3, .positions = positions},
                                NULL, &r.mem, &r.sweep, &r.err);
        }
        mt_alloc_fail_after(-1);
        const mt_status rc = r.rc;
        CHECK(t, rc == MT_E_MEMORY || (rc == MT_OK && r.sweep.n_reached == 3));
        run_free(&r);
        CHECK_INT(t, mt_alloc_live(), before);
        if (rc == MT_OK) {
            break;
        }
    }
    mt_model_delete(model);
}

MT_TEST_MAIN(MT_TEST(sweep__failing_allocations_are_errors),
             MT_TEST(sweep__four_bar_obeys_freudenstein),
             MT_TEST(sweep__ratio_is_the_slope_of_the_coordinate),
             MT_TEST(sweep__slider_crank_stops_at_its_limit_positions),
             MT_TEST(sweep__the_crank_of_a_slider_crank_goes_round),
             MT_TEST(sweep__the_last_digit_of_a_position_is_reached),
             MT_TEST(sweep__limit_is_located), MT_TEST(sweep__servo_moves_the_stick_in_space),
             MT_TEST(sweep__a_locked_rod_is_held_by_its_moment),
             MT_TEST(sweep__meets_the_configuration_that_drives_the_same),
             MT_TEST(sweep__refuses_in_words),
             MT_TEST(sweep__two_joints_go_a_path_or_over_a_grid),
             MT_TEST(sweep__two_drives_of_one_freedom_are_named),
             MT_TEST(sweep__a_joint_that_others_hold_is_named))
