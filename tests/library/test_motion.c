/* SPDX-License-Identifier: GPL-3.0-or-later */
/* mt_mechanism_motion by closed forms: 2 kg on 200 N/m, damped by 4 N s/m, along x. */
#include "modetune/motion.h"

#include <gsl/gsl_errno.h>
#include <math.h>
#include <string.h>

#include "mt_refusals.h"
#include "mt_test.h"

static const mt_file_text FILES[] = {
    {"one.json",
     "{\"format\": \"modetune-model/1\", \"dimension\": 2, \"parameters\": {\"c\": 4}, "
     "\"bodies\": "
     "[{\"name\": \"a\", \"mass_kg\": 2, \"inertia_kg_m2\": 1, \"centre\": [1, 0]}], "
     "\"joints\": "
     "[{\"name\": \"j\", \"type\": \"prismatic\", \"bodies\": [\"ground\", \"a\"], \"at\": [1, "
     "0], "
     "\"axis\": [1, 0]}], \"springs\": [{\"name\": \"s\", \"type\": \"axial\", \"bodies\": "
     "[\"ground\", \"a\"], \"at\": [[0, 0], [1, 0]], \"stiffness_n_per_m\": 200}], "
     "\"dampers\": "
     "[{\"name\": \"d\", \"type\": \"axial\", \"bodies\": [\"ground\", \"a\"], \"at\": [[0, "
     "0], [1, "
     "0]], \"damping_n_s_per_m\": \"c\"}], \"sensors\": [{\"name\": \"a\", \"on\": \"a\", "
     "\"directions\": [\"x\"]}]}"},
    {"shaker.json", "{\"format\": \"modetune-profile/1\", \"axis\": \"x\", \"random\": "
                    "{\"psd_m2_per_s3\": [[0.5, 0.2], [9, 0.2]]}, \"tones\": "
                    "[{\"frequency_hz\": [2, 3], \"acceleration_m_per_s2\": 3}]}"}};
static const char *const OUTPUTS[] = {"a.x", "a.x:velocity", "j:acceleration"};
static const double TWO_PI = 6.28318530717958647693;
enum { ROOM = 3 * 64 };

typedef struct rig {
    mt_model *model;
    mt_vibration *profile;
    mt_mechanism *m;
} rig;

static mt_status rig_make(rig *r)
{
    static const char *const names[] = {"c"};
    const mt_read_options opt = {
        .size = sizeof opt, .files = FILES, .n_files = 2, .files_only = 1};
    *r = (rig){.model = NULL};
    mt_status rc = mt_model_read("one.json", &opt, &r->model, NULL);
    rc = rc == MT_OK ? mt_vibration_read("shaker.json", &opt, &r->profile, NULL) : rc;
    return rc == MT_OK ? mt_mechanism_new(r->model, NULL, 1, names, &r->m, NULL) : rc;
}

static void rig_free(rig *r)
{
    mt_mechanism_delete(r->m);
    mt_vibration_delete(r->profile);
    mt_model_delete(r->model);
}

/* x'' + 2 x' + 100 x = 0 from x = 0.1 with x' = v0. */
static void motion__a_mass_that_is_let_go_rings(mt_test *t)
{
    const mt_motion_joint start = {"j", 0.1};
    const mt_motion_joint rate = {"j", 0.5};
    const mt_motion_options opt = {.size = sizeof opt,
                                   .duration_s = 2.0,
                                   .sample_s = 0.05,
                                   .n_starts = 1,
                                   .starts = &start,
                                   .n_rates = 1,
                                   .rates = &rate};
    double values[ROOM];
    mt_motion_told told;
    rig r;
    REQUIRE(t, rig_make(&r) == MT_OK);
    CHECK_INT(t, mt_mechanism_motion(r.m, &opt, 3, OUTPUTS, ROOM, values, &told, NULL), MT_OK);
    CHECK_INT(t, told.samples, 41);
    CHECK(t, told.energy_error_j <= 1e-9 * told.energy_scale_j);
    const double w = sqrt(99.0);
    for (ptrdiff_t i = 0; i < told.samples; i++) {
        const double time = 0.05 * (double)i;
        const double b = (0.5 + 0.1) / w;
        const double decay = exp(-time);
        const double x = decay * ((0.1 * cos(w * time)) + (b * sin(w * time)));
        const double v = decay * w * ((b * cos(w * time)) - (0.1 * sin(w * time))) - x;
        mt_test_row(t, "%g s", time);
        CHECK_NEAR_ABS(t, values[3 * i], x, 1e-10);
        CHECK_NEAR_ABS(t, values[(3 * i) + 1], v, 1e-9);
        CHECK_NEAR_ABS(t, values[(3 * i) + 2], (-2.0 * v) - (100.0 * x), 1e-8);
    }
    rig_free(&r);
}

/* After its ringing has died away it has the steady motion of mt_mechanism_response. */
static void motion__under_a_sine_it_settles_to_its_response(mt_test *t)
{
    static const char *const port[] = {"a.x", "base.x"};
    for (int k = 0; k < 2; k++) {
        const mt_motion_sine sine = {port[k], 3.0, 1.25, 0.4};
        const mt_ports ports = {1, &port[k], 1,
                                (const char *const[]){"a.x:relative_displacement"}};
        const mt_motion_options opt = {.size = sizeof opt,
                                       .duration_s = 28.0,
                                       .sample_s = 0.5,
                                       .n_sines = 1,
                                       .sines = &sine};
        const double hz = 1.25;
        double values[ROOM];
        double re[2];
        double im[2];
        mt_motion_told told;
        rig r;
        mt_test_row(t, "%s", port[k]);
        REQUIRE(t, rig_make(&r) == MT_OK);
        CHECK_INT(t, mt_mechanism_motion(r.m, &opt, 1, OUTPUTS, ROOM, values, &told, NULL),
                  MT_OK);
        CHECK_INT(t, mt_mechanism_response(r.m, &ports, 1, &hz, re, im, NULL, NULL), MT_OK);
        for (int i = 54; i < told.samples; i++) {
            const double angle = (TWO_PI * hz * 0.5 * i) + 0.4;
            CHECK_NEAR_ABS(t, values[i], 3.0 * ((re[0] * sin(angle)) + (im[0] * cos(angle))),
                           1e-9);
        }
        rig_free(&r);
    }
}

static void motion__a_profile_is_that_of_its_seed(mt_test *t)
{
    double values[3][ROOM];
    mt_motion_told told;
    rig r;
    REQUIRE(t, rig_make(&r) == MT_OK);
    for (int i = 0; i < 3; i++) {
        const mt_motion_options opt = {.size = sizeof opt,
                                       .duration_s = 1.0,
                                       .sample_s = 0.1,
                                       .seed = i / 2,
                                       .vibration = r.profile,
                                       .along = i == 1 ? "base.x" : NULL};
        CHECK_INT(t, mt_mechanism_motion(r.m, &opt, 1, OUTPUTS, ROOM, values[i], &told, NULL),
                  MT_OK);
    }
    const size_t bytes = (size_t)told.samples * sizeof values[0][0];
    CHECK(t, memcmp(values[0], values[1], bytes) == 0);
    CHECK(t, memcmp(values[0], values[2], bytes) != 0);
    rig_free(&r);
}

static void motion__wrong_options_are_refused(mt_test *t)
{
    static const mt_motion_joint nowhere = {"k", 0.1};
    static const mt_motion_sine sines[] = {
        {"a.q", 1.0, 1.0, 0.0}, {"a.x", 1.0, 0.0, 0.0}, {NULL, 1.0, 1.0, 0.0}};
    const mt_motion_options good = {.size = sizeof good, .duration_s = 1.0, .sample_s = 0.5};
    static const char *const wrong = "a.x:speed";
    double values[ROOM];
    mt_err err = {MT_OK, ""};
    rig r;
    REQUIRE(t, rig_make(&r) == MT_OK);
    for (int i = 0; i < 10; i++) {
        mt_motion_options opt = good;
        opt.duration_s = i == 0 ? -1.0 : i == 1 ? nan("") : 1.0;
        opt.sample_s = i == 2 ? 0.0 : 0.5;
        opt.n_starts = i == 3 ? 1 : 0;
        opt.n_rates = i == 4 ? -1 : 0;
        opt.starts = &nowhere;
        opt.n_sines = i >= 5 && i < 8 ? 1 : 0;
        opt.sines = i >= 5 && i < 8 ? &sines[i - 5] : NULL;
        opt.vibration = i == 8 ? r.profile : NULL;
        opt.along = "base.x:velocity";
        opt.tolerance = i == 9 ? 2.0 : 0.0;
        mt_test_row(t, "options %d", i);
        CHECK_INT(t, mt_mechanism_motion(r.m, &opt, 1, OUTPUTS, ROOM, values, NULL, &err),
                  MT_E_USAGE);
        CHECK(t, strstr(err.text, "mt_mechanism_motion") == err.text);
    }
    mt_test_row(t, "outputs");
    CHECK_INT(t, mt_mechanism_motion(r.m, &good, 1, &wrong, ROOM, values, NULL, &err),
              MT_E_USAGE);
    CHECK_INT(t, mt_mechanism_motion(r.m, &good, 1, OUTPUTS, 2, values, NULL, &err),
              MT_E_USAGE);
    CHECK_INT(t, mt_mechanism_motion(r.m, &good, 0, OUTPUTS, ROOM, values, NULL, &err),
              MT_E_USAGE);
    rig_free(&r);
}

static mt_status move_once(mt_test *t, const void *context)
{
    (void)t;
    (void)context;
    const mt_motion_joint start = {"j", 0.1};
    const mt_motion_sine sine = {"a.x", 1.0, 1.0, 0.0};
    double values[ROOM];
    rig r;
    mt_status rc = rig_make(&r);
    const mt_motion_options opt = {.size = sizeof opt,
                                   .duration_s = 0.02,
                                   .sample_s = 0.01,
                                   .n_starts = 1,
                                   .starts = &start,
                                   .n_sines = 1,
                                   .sines = &sine,
                                   .vibration = r.profile};
    rc =
        rc == MT_OK ? mt_mechanism_motion(r.m, &opt, 3, OUTPUTS, ROOM, values, NULL, NULL) : rc;
    rig_free(&r);
    return rc;
}

static void motion__every_failing_allocation_is_survived(mt_test *t)
{
    gsl_error_handler_t *const theirs = gsl_set_error_handler_off();
    CHECK_INT(t, move_once(t, NULL), MT_OK); /* libraries claim what they keep */
    CHECK(t, mt_refuse_each(t, "move_once", move_once, NULL, MT_OK) > 10 || !mt_alloc_works());
    (void)gsl_set_error_handler(theirs);
}

MT_TEST_MAIN(MT_TEST(motion__a_mass_that_is_let_go_rings),
             MT_TEST(motion__under_a_sine_it_settles_to_its_response),
             MT_TEST(motion__a_profile_is_that_of_its_seed),
             MT_TEST(motion__wrong_options_are_refused),
             MT_TEST(motion__every_failing_allocation_is_survived))
