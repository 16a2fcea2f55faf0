/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Profiles of vibration as they are read: levels, slopes, tones, marks. */
#include <math.h>
#include <string.h>

#include "environment/vibration.h"
#include "io/options.h"
#include "mt_refusals.h"

#define GOOD MT_TEST_SOURCE_DIR "/tests/documents/good/profile.json"
#define G    MT_STANDARD_GRAVITY

static mt_vibration *load(mt_test *t, const char *path, mt_diagnostics *said)
{
    mt_vibration *v = NULL;
    CHECK_INT(t, mt_vibration_load(path, NULL, &v, said, NULL), MT_OK);
    return v;
}

/* A profile from its text alone, where no catalogue lies beside it. */
static mt_vibration *load_text(mt_test *t, const char *text)
{
    const mt_file_text file = {.path = "alone.json", .text = text};
    const mt_io_options opt = {.files = {.given = &file, .n = 1, .only = true}};
    mt_diagnostics said = {.count = 0};
    mt_vibration *v = NULL;
    CHECK_INT(t, mt_vibration_load("alone.json", &opt, &v, &said, NULL), MT_OK);
    mt_diagnostics_free(&said);
    return v;
}

static void profile__says_what_the_file_says(mt_test *t)
{
    mt_diagnostics said = {.count = 0};
    mt_vibration *const v = load(t, GOOD, &said);
    REQUIRE(t, v != NULL);
    CHECK_STR(t, v->name, "Every member");
    CHECK_INT(t, v->axis, 2);
    CHECK_INT(t, v->n_random, 2);
    CHECK_INT(t, v->n_tones, 9);
    CHECK(t, v->sigma == 2.5 && v->rule == MT_TONES_ROOT);
    /* slopes: 3 dB/octave from 20 Hz down to 10, 6 on to 5; -3 from 100 up to 400 */
    const mt_vibration_random *const r = &v->random[0];
    REQUIRE(t, r->psd.n == 6);
    CHECK_NEAR(t, r->level_g[1], 0.01 * pow(10.0, -0.3), 1e-14);
    CHECK_NEAR(t, r->level_g[0], 0.01 * pow(10.0, -0.9), 1e-14);
    CHECK_NEAR(t, r->level_g[5], 0.04 * pow(10.0, -0.6), 1e-14);
    CHECK(t, r->level_g[2] == 0.01);
    CHECK_NEAR(t, r->psd.level[2], 0.01 * G * G, 1e-15);
    CHECK_NEAR(t, r->published_rms, 2.54 * G, 1e-15);
    CHECK(t, v->random[1].psd.level[0] == 2.5);
    CHECK_NEAR(t, v->random[1].level_g[1], 2.5 / (G * G), 1e-15);
    CHECK_NEAR(t, v->random[1].rms, sqrt(12.5), 1e-15);
    CHECK_NEAR(t, mt_vibration_rms(v), hypot(r->rms, sqrt(12.5)), 1e-15);
    static const struct {
        const char *label;
        double lower_hz;
        double upper_hz;
        double level;
    } tones[] = {
        {"1P of Dragonfly", 4.5, 5.5, 0.5 * G},
        {"nP of Dragonfly", 18.0, 22.0, 0.5 * G},
        {"2T of Dragonfly", 36.9, 45.1, 0.5 * G},
        {"nP of fan", 20.0, 20.0, 3.5},
        {"nT of fan", 40.0, 40.0, 3.5},
        {"3P of rotor", 21.0, 21.0, 0.25 * G},
        {"1T of rotor", 15.0, 15.0, 0.25 * G},
        {"48 to 52 Hz", 48.0, 52.0, G},
        {"60 Hz", 60.0, 60.0, G},
    };
    for (int i = 0; i < MT_COUNT(tones); i++) {
        mt_test_row(t, "%s", tones[i].label);
        CHECK_STR(t, v->tones[i].label, tones[i].label);
        CHECK_NEAR(t, v->tones[i].lower_hz, tones[i].lower_hz, 1e-15);
        CHECK_NEAR(t, v->tones[i].upper_hz, tones[i].upper_hz, 1e-15);
        CHECK_NEAR(t, v->tones[i].level, tones[i].level, 1e-15);
    }
    REQUIRE(t, v->n_marks == 2);
    CHECK(t, strstr(v->marks[0], "Dragonfly: the tail rotor's speed (20.5 Hz)") != NULL);
    CHECK_STR(t, v->marks[1], "the level of 1P, nP, 2T of Dragonfly is assumed (a guess)");
    CHECK_INT(t, said.count, 2);
    CHECK_INT(t, (int)strlen(v->sha256), 64);
    mt_diagnostics_free(&said);
    mt_vibration_delete(v);
}

static void profile__has_the_program_s_own_catalogue_where_there_is_none(mt_test *t)
{
    mt_vibration *const v = load_text(
        t, "{\"format\": \"modetune-profile/1\", \"tones\": [{\"rotor\": {\"aircraft\": "
           "\"CH-47\", \"harmonics\": [\"nP\"]}, \"acceleration_g\": 1}]}");
    REQUIRE(t, v != NULL);
    CHECK_NEAR(t, v->tones[0].lower_hz, 11.25, 1e-15); /* 225 rpm, 3 blades, both confirmed */
    CHECK_INT(t, v->n_marks, 0);
    CHECK(t, v->sigma == 3.0 && v->rule == MT_TONES_SUM && v->axis == MT_ABSENT);
    CHECK_INT(t, v->n_random, 0);
    mt_vibration_delete(v);
}

static void profile__compares_with_the_published_rms(mt_test *t)
{
    static const struct {
        const char *name;
        const char *rms;
        bool warned;
    } rows[] = {{"as printed", "1", false},
                {"rounded", "1.009", false},
                {"off", "1.02", true},
                {"in another unit", "9.8", true}};
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_text text = {0};
        mt_diagnostics said = {.count = 0};
        mt_vibration *v = NULL;
        mt_text_addf(&text,
                     "{\"format\": \"modetune-profile/1\", \"random\": {\"psd_g2_per_hz\": "
                     "[[1, 1], [2, 1]], \"published_rms_g\": %s}}",
                     rows[i].rms);
        const mt_file_text file = {.path = "p.json", .text = text.s};
        const mt_io_options opt = {.files = {.given = &file, .n = 1, .only = true}};
        mt_test_row(t, "%s", rows[i].name);
        CHECK_INT(t, mt_vibration_load("p.json", &opt, &v, &said, NULL), MT_OK);
        CHECK_INT(t, said.count, rows[i].warned ? 1 : 0);
        mt_vibration_delete(v);
        mt_diagnostics_free(&said);
        mt_text_free(&text);
    }
}

static mt_status load_once(mt_test *t, const void *context)
{
    mt_diagnostics said = {.count = 0};
    mt_vibration *v = NULL;
    const mt_status rc = mt_vibration_load(GOOD, NULL, &v, &said, NULL);
    (void)context;
    CHECK(t, (rc == MT_OK) == (v != NULL));
    mt_vibration_delete(v);
    mt_diagnostics_free(&said);
    return rc;
}

static void profile__every_failing_allocation_is_survived(mt_test *t)
{
    mt_refuse_each(t, "load_once", load_once, NULL, MT_OK);
}

MT_TEST_MAIN(MT_TEST(profile__says_what_the_file_says),
             MT_TEST(profile__has_the_program_s_own_catalogue_where_there_is_none),
             MT_TEST(profile__compares_with_the_published_rms),
             MT_TEST(profile__every_failing_allocation_is_survived))
