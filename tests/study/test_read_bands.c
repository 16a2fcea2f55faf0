/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A study with bands, rotors, catalogues by rule and a trade section: every member arrives,
 * aircraft are looked up, bands are made. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "environment/aircraft.h"
#include "io/options.h"
#include "mt_refusals.h"
#include "study/read.h"

#define FULL     MT_TEST_SOURCE_DIR "/tests/documents/good/study_bands.json"
#define MODEL    MT_TEST_SOURCE_DIR "/tests/documents/wrong/parts/model.json"
#define AIRCRAFT MT_TEST_SOURCE_DIR "/problems/aircraft.json"

static const double TOL = 1e-14; /* a few roundings: products of four numbers */

static mt_study *load_full(mt_test *t, mt_diagnostics *messages)
{
    mt_study *s = NULL;
    mt_err err = {.text = ""};
    CHECK_INT(t, mt_study_load(FULL, NULL, &s, messages, &err), MT_OK);
    CHECK_STR(t, err.text, "");
    return s;
}

/* A study of the model with one variable and one goal of type "avoid" with these members, in a
 * file of its own. */
static mt_study *load_goal(mt_test *t, const char *members, const char *goal)
{
    char folder[] = "/tmp/mt_bands_XXXXXX";
    char path[64];
    mt_study *s = NULL;
    mt_diagnostics messages = {.count = 0};
    const mt_io_options opt = {.root = "/"};
    if (!CHECK(t, mkdtemp(folder) != NULL)) {
        return NULL;
    }
    (void)snprintf(path, sizeof path, "%s/study.json", folder);
    FILE *const f = fopen(path, "w");
    if (CHECK(t, f != NULL)) {
        (void)fprintf(f,
                      "{\"format\": \"modetune-study/1\", \"model\": \"%s\"%s,\n\"variables\": "
                      "[{\"parameter\": \"k1\", \"lower\": 1, \"upper\": 10}],\n\"goals\": "
                      "[{\"type\": \"avoid\", \"configuration\": \"bare\", %s}]}",
                      MODEL, members, goal);
        CHECK_INT(t, fclose(f), 0);
        if (!CHECK_INT(t, mt_study_load(path, &opt, &s, &messages, NULL), MT_OK)) {
            (void)fprintf(stderr, "%s", mt_diagnostics_text(&messages));
        }
    }
    (void)unlink(path);
    (void)rmdir(folder);
    mt_diagnostics_free(&messages);
    return s;
}

static void check_band(mt_test *t, const mt_band *band, const double edges[4],
                       const char *label)
{
    mt_test_row(t, "%s", label);
    CHECK_NEAR(t, band->lower_hz, edges[0], TOL);
    CHECK_NEAR(t, band->base_lower_hz, edges[1], TOL);
    CHECK_NEAR(t, band->base_upper_hz, edges[2], TOL);
    CHECK_NEAR(t, band->upper_hz, edges[3], TOL);
    CHECK_STR(t, band->label, label);
}

static void check_avoid(mt_test *t, const mt_study *s)
{
    const mt_goal *const g = &s->goals[0];
    CHECK_INT(t, g->type, MT_GOAL_AVOID);
    CHECK_INT(t, g->n_configurations, 2);
    CHECK_INT(t, g->configurations[1], mt_model_find_configuration(s->model, "heavy"));
    CHECK_NEAR(t, g->tolerance_percent, 0.01, TOL);
    CHECK_STR(t, g->description, "everything");
    CHECK(t, !MT_HAS(g->weight));
    if (!CHECK(t, g->avoid != NULL) || !CHECK_INT(t, g->avoid->source.n_rotors, 1)) {
        return;
    }
    CHECK_INT(t, g->avoid->cluster, 3);
    CHECK_NEAR(t, g->avoid->source.up_to_hz, 65.0, TOL);
    const mt_rotor *const r = &g->avoid->source.rotors[0];
    CHECK_NEAR(t, r->speed_hz, 5.0, TOL);
    CHECK_INT(t, r->blades, 4);
    CHECK_NEAR(t, r->tail_speed_hz, 20.0, TOL);
    CHECK_INT(t, r->tail_blades, 2);
    CHECK_INT(t, r->n_harmonics, 4);
    if (!CHECK_INT(t, g->avoid->bands.n, 4)) {
        return;
    }
    const mt_band *const b = g->avoid->bands.items;
    check_band(t, &b[0], (const double[]){4.05, 4.5, 5.5, 6.05}, "1P of the dragon");
    check_band(t, &b[1], (const double[]){16.2, 18.0, 22.0, 24.2}, "nP + 1T of the dragon");
    /* nT reaches from 32.4 to 48.4 Hz, 40 to 50 Hz from 38 to 52.5 Hz */
    check_band(t, &b[2], (const double[]){32.4, 36.0, 50.0, 52.5},
               "nT of the dragon + 40 to 50 Hz");
    check_band(t, &b[3], (const double[]){57.0, 60.0, 65.0, 65.0}, "60 to 70 Hz");
}

static void check_rotors(mt_test *t, const mt_study *s)
{
    static const struct {
        double hz;
        double margin; /* of 1 */
        const char *label;
    } rows[] = {
        {110.0, 0.02, "1T of rotor 1"},
        {150.0, 0.01, "1P of rotor 2"},
        {300.0, 0.02, "nP of rotor 1"},
        {400.0, 0.01, "1T of rotor 2"},
    };
    const mt_avoid *const avoid = s->goals[1].avoid;
    if (!CHECK(t, avoid != NULL) || !CHECK_INT(t, avoid->bands.n, MT_COUNT(rows))) {
        return;
    }
    CHECK_INT(t, avoid->cluster, 2);
    for (int i = 0; i < MT_COUNT(rows); i++) {
        const double hz = rows[i].hz;
        check_band(
            t, &avoid->bands.items[i],
            (const double[]){hz * (1.0 - rows[i].margin), hz, hz, hz * (1.0 + rows[i].margin)},
            rows[i].label);
    }
}

/* An engine of 10 to 11 turns per second with two gears, 10 %; and one without a name, 2 % of
 * the list. */
static void check_machines(mt_test *t, const mt_study *s)
{
    static const struct {
        double lower; /* base */
        double upper;
        double margin; /* of 1 */
        const char *label;
    } rows[] = {
        {5.0, 5.5, 0.1, "0.5E of engine"},
        {22.5, 27.5, 0.1, "0.125G-1 of pinion + 2.50E of engine"},
        {37.5, 41.25, 0.1, "0.125G of pinion"},
        {52.5, 57.75, 0.1, "0.125G+1 of pinion"},
        {285.0, 346.5, 0.1, "1G-1 + 1G + 1G+1 of pinion"},
        {1010.0, 1111.0, 0.1, "1G of engine"},
        {2000.0, 2000.0, 0.02, "1E of machine 2"},
    };
    const mt_avoid *const avoid = s->goals[2].avoid;
    const mt_avoid *const other = s->goals[3].avoid;
    mt_test_row(t, "machines");
    if (!CHECK(t, avoid != NULL && other != NULL) ||
        !CHECK_INT(t, avoid->bands.n, MT_COUNT(rows)) || !CHECK_INT(t, other->bands.n, 1)) {
        return;
    }
    for (int i = 0; i < MT_COUNT(rows); i++) {
        check_band(t, &avoid->bands.items[i],
                   (const double[]){rows[i].lower * (1.0 - rows[i].margin), rows[i].lower,
                                    rows[i].upper, rows[i].upper * (1.0 + rows[i].margin)},
                   rows[i].label);
    }
    check_band(t, &other->bands.items[0], (const double[]){2e3, 2e3, 5e3, 5e3},
               "2E of machine");
    const mt_machine *const m = &avoid->source.machines[0];
    mt_test_row(t, "machine");
    CHECK_NEAR(t, m->lower_hz, 10.0, TOL);
    CHECK_NEAR(t, m->upper_hz, 11.0, TOL);
    CHECK_INT(t, m->n_orders, 2);
    CHECK_INT(t, m->orders[1].thousandths, 2500);
    CHECK_INT(t, m->gears[0].sidebands, 1);
    CHECK_NEAR(t, m->gears[0].ratio, 1.5, TOL);
    CHECK_INT(t, m->gears[1].teeth, 101);
    CHECK_INT(t, m->gears[1].n_orders, 0);
}

static void check_catalogues(mt_test *t, const mt_study *s)
{
    static const double springs[] = {0.56, 0.68, 0.82, 1.0, 1.2, 1.5, 1.8, 2.2, 2.7, 3.3};
    static const double masses[] = {1.0, 1.25, 1.5, 1.75, 2.0};
    mt_test_row(t, "catalogues");
    if (CHECK_INT(t, s->variables[1].n_catalogue, MT_COUNT(springs))) {
        for (int i = 0; i < MT_COUNT(springs); i++) {
            CHECK(t, s->variables[1].catalogue[i] == springs[i]);
        }
        CHECK(t, s->variables[1].lower == 0.56 && s->variables[1].upper == 3.3);
    }
    if (CHECK_INT(t, s->variables[2].n_catalogue, MT_COUNT(masses))) {
        for (int i = 0; i < MT_COUNT(masses); i++) {
            CHECK(t, s->variables[2].catalogue[i] == masses[i]);
        }
    }
}

static void check_trade(mt_test *t, const mt_study *s)
{
    const mt_trade *const trade = &s->trade;
    mt_test_row(t, "trade");
    CHECK_INT(t, trade->n_objectives, 2);
    CHECK_INT(t, trade->objectives[0], MT_OBJECTIVE_CHANGE);
    CHECK_INT(t, trade->objectives[1], MT_OBJECTIVE_CLEARANCE);
    if (!CHECK_INT(t, trade->n_vary, 2)) {
        return;
    }
    const mt_vary *const v = trade->vary;
    CHECK_INT(t, v[0].kind, MT_VARY_BOUND);
    CHECK_INT(t, v[0].variable, 0);
    CHECK(t, v[0].upper);
    CHECK_STR(t, v[0].text, "upper bound of k1");
    if (CHECK_INT(t, v[0].n_values, 3)) { /* in the order given */
        CHECK(t, v[0].values[0] == 10.0 && v[0].values[1] == 12.0 && v[0].values[2] == 8.0);
    }
    CHECK_INT(t, v[1].kind, MT_VARY_GOAL);
    CHECK_INT(t, v[1].goal, 0);
    CHECK_INT(t, v[1].slot, MT_SLOT_MARGIN);
    CHECK_STR(t, v[1].text, "margin_percent of /goals/0");
    for (int i = 0; i < 5 && CHECK_INT(t, v[1].n_values, 5); i++) {
        CHECK_NEAR_ABS(t, v[1].values[i], 5.0 * (double)i, TOL);
    }
}

static void check_warnings(mt_test *t, const mt_study *s)
{
    static const char *const want[] = {
        "Dragonfly: the tail rotor's speed (20 Hz) is unconfirmed (source needed: hearsay)",
        "/goals/0: nP + 1T of the dragon overlap: merged into one band, 18 to 22 Hz, with its "
        "margin "
        "16.2 to 24.2 Hz",
        "/goals/0: nT of the dragon + 40 to 50 Hz overlap: merged into one band, 36 to 50 "
        "Hz, with its margin 32.4 to 52.5 Hz",
        "/goals/2: 0.125G-1 of pinion + 2.50E of engine overlap: merged into one band, 22.5 to "
        "27.5 Hz, with its margin 20.25 to 30.25 Hz",
        "/goals/2: 1G-1 + 1G + 1G+1 of pinion overlap: merged into one band, 285 to 346.5 Hz, "
        "with its margin 256.5 to 381.15 Hz",
    };
    mt_test_row(t, "warnings");
    if (CHECK_INT(t, s->n_warnings, MT_COUNT(want))) {
        for (int i = 0; i < MT_COUNT(want); i++) {
            CHECK_STR(t, s->warnings[i], want[i]);
        }
    }
}

static void bands_study__every_member_arrives(mt_test *t)
{
    mt_diagnostics messages = {.count = 0};
    mt_study *const s = load_full(t, &messages);
    REQUIRE(t, s != NULL);
    /* the tail rotor's speed is hearsay; the last line says no more */
    CHECK(t,
          messages.lines.s != NULL &&
              strstr(messages.lines.s, "warning: /goals/0/rotor/aircraft: Dragonfly: the tail "
                                       "rotor's speed (20 Hz) is unconfirmed\n") != NULL);
    if (CHECK_INT(t, s->n_goals, 5)) {
        check_avoid(t, s);
        check_rotors(t, s);
        check_machines(t, s);
        check_catalogues(t, s);
        check_trade(t, s);
        check_warnings(t, s);
    }
    CHECK_INT(t, s->objectives[0].type, MT_OBJECTIVE_CLEARANCE);
    if (CHECK_INT(t, s->n_inputs, 3)) {
        CHECK_STR(t, s->inputs[2].name, "../wrong/parts/aircraft.json");
        CHECK_INT(t, strlen(s->inputs[2].sha256), 64);
    }
    mt_study_delete(s);
    mt_diagnostics_free(&messages);
}

/* Only what the harmonics use is asked for. */
static void bands_study__confirmed_values_need_no_warning(mt_test *t)
{
    static const struct {
        const char *aircraft;
        const char *harmonics;
        int warnings;
    } rows[] = {
        {"AH-64", "[\"1P\", \"nP\", \"1T\"]", 0},
        {"CH-47", "[\"nP\"]", 0},
        {"UH-60", "[\"1P\", \"nP\"]", 1}, /* its speed */
        {"UH-60", "[\"1P\", \"nT\"]", 3}, /* and both numbers of the tail rotor */
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        char goal[128];
        mt_test_row(t, "%s %s", rows[i].aircraft, rows[i].harmonics);
        (void)snprintf(goal, sizeof goal,
                       "\"rotor\": {\"aircraft\": \"%s\", \"harmonics\": %s, "
                       "\"margin_percent\": 5}",
                       rows[i].aircraft, rows[i].harmonics);
        mt_study *const s = load_goal(t, ", \"aircraft\": \"" AIRCRAFT "\"", goal);
        CHECK_INT(t, s == NULL ? -1 : s->n_warnings, rows[i].warnings);
        mt_study_delete(s);
    }
}

static void bands_study__the_catalogue_beside_the_model_is_the_default(mt_test *t)
{
    static const char goal[] = "\"rotor\": {\"aircraft\": \"Dragonfly\", \"harmonics\": "
                               "[\"1P\"], \"margin_percent\": 5}";
    mt_study *s = load_goal(t, "", goal);
    if (s != NULL && CHECK_INT(t, s->n_inputs, 3)) {
        CHECK_STR(t, s->inputs[2].name,
                  MT_TEST_SOURCE_DIR "/tests/documents/wrong/parts/aircraft.json");
        CHECK_STR(t, s->goals[0].avoid->bands.items[0].label, "1P of Dragonfly");
    }
    mt_study_delete(s);
    s = load_goal(t, "", "\"bands_hz\": [[1, 2]]"); /* nobody asks for it */
    CHECK_INT(t, s == NULL ? -1 : s->n_inputs, 2);
    mt_study_delete(s);
}

static void bands_study__every_aircraft_of_the_catalogue_can_be_used(mt_test *t)
{
    mt_arena mem = {0};
    mt_aircraft_list list = {0};
    mt_diagnostics messages = {.count = 0};
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    CHECK_INT(t, mt_aircraft_load(AIRCRAFT, NULL, &mem, &list, &messages, NULL), MT_OK);
    CHECK_STR(t, messages.lines.s, NULL);
    CHECK(t, list.n >= 10);
    for (int i = 0; i < list.n; i++) {
        const mt_aircraft *const a = &list.items[i];
        mt_test_row(t, "%s", a->name.s);
        /* tip speeds and sizes of helicopters keep the speeds within these */
        CHECK(t, a->main_rotor.speed.value > 2.0 && a->main_rotor.speed.value < 10.0);
        CHECK(t, a->main_rotor.blades.value >= 2.0 && a->main_rotor.blades.value <= 8.0);
        CHECK(t, !a->has_tail || a->tail_rotor.speed.value > 3.0 * a->main_rotor.speed.value);
        CHECK(t, a->main_rotor.speed.source != NULL && *a->main_rotor.speed.source != '\0');
    }
    mt_diagnostics_free(&messages);
    mt_arena_free(&mem);
}

static mt_status load_once(mt_test *t, const void *context)
{
    mt_study *s = NULL;
    mt_diagnostics messages = {.count = 0};
    const mt_status rc = mt_study_load(FULL, NULL, &s, &messages, NULL);
    (void)context;
    CHECK(t, (rc == MT_OK) == (s != NULL));
    mt_study_delete(s);
    mt_diagnostics_free(&messages);
    return rc;
}

static void bands_study__every_failing_allocation_is_survived(mt_test *t)
{
    mt_refuse_each(t, "load_once", load_once, NULL, MT_OK);
}

MT_TEST_MAIN(MT_TEST(bands_study__every_member_arrives),
             MT_TEST(bands_study__confirmed_values_need_no_warning),
             MT_TEST(bands_study__the_catalogue_beside_the_model_is_the_default),
             MT_TEST(bands_study__every_aircraft_of_the_catalogue_can_be_used),
             MT_TEST(bands_study__every_failing_allocation_is_survived))
