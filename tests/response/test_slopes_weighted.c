/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Weighted sums of derivatives over many frequencies, against the sum of them one by one, and
 * in closed form. */
#include "response_fixture.h"

enum { GRID = 300 };

static void fill_grid(double lower, double upper, double *w)
{
    for (int i = 0; i < GRID; i++) {
        w[i] = lower * pow(upper / lower, i / (GRID - 1.0));
    }
}

/* A body on rails with a massless bar between two springs, ground and body; one more body on
 * rails beside it; parts in other words of what there is: masses, dampers, loss factors. */
#define ROW(first, second, damping)                                                         \
    "{ \"format\": \"modetune-model/1\", \"name\": \"r\", \"dimension\": 2,"                \
    "  \"parameters\": { \"m\": 2, \"k\": 60, \"eta\": 0.05, \"c\": 0.3, \"z\": 0.02 },"    \
    "  \"bodies\": [ { \"name\": \"a\", \"mass_kg\": " first                                \
    ", \"inertia_kg_m2\": 0.1, \"centre\": [0, 0] },"                                       \
    "                { \"name\": \"b\", \"mass_kg\": \"m\", \"inertia_kg_m2\": 0.1,"        \
    "                  \"centre\": [1, 0] } ],"                                             \
    "  \"joints\": [ { \"name\": \"ja\", \"type\": \"prismatic\", \"bodies\": [\"ground\"," \
    "                  \"a\"], \"at\": [0, 0], \"axis\": [1, 0] },"                         \
    "                { \"name\": \"jb\", \"type\": \"prismatic\", \"bodies\": [\"ground\"," \
    "                  \"b\"], \"at\": [1, 0], \"axis\": [1, 0] } ],"                       \
    "  \"springs\": [ { \"name\": \"s\", \"type\": \"axial\", \"bodies\": [\"ground\","     \
    "                   \"a\"], \"at\": [[-1, 0], [0, 0]],"                                 \
    "                   \"stiffness_n_per_m\": \"k\", \"loss_factor\": \"eta\" },"          \
    "                 { \"name\": \"v\", \"type\": \"axial\", \"bodies\": [\"a\", \"b\"],"  \
    "                   \"at\": [[0, 0], [1, 0]],"                                          \
    "                   \"stiffness_n_per_m\": 40 } ],"                                     \
    "  \"dampers\": [ { \"name\": \"d\", \"type\": \"axial\", \"bodies\": [" second         \
    "                   \"b\"],"                                                            \
    "                   \"at\": [[0, 0], [1, 0]],"                                          \
    "                   \"damping_n_s_per_m\": \"c\" } ],"                                  \
    "  \"sensors\": [ { \"name\": \"e\", \"on\": \"b\", \"at\": [1, 0] },"                  \
    "                 { \"name\": \"f\", \"on\": \"a\", \"at\": [0, 0] } ],"                \
    "  \"damping\": {" damping "}, \"configurations\": { \"c\": {} } }"

static void over_grid(mt_test *t, const sloped *s, int modes)
{
    double w[GRID];
    asked q = {.rc = MT_OK};
    mt_model *const model = s->text != NULL ? mech_parse(t, s->text) : mech_load(t, s->file);
    const mt_analysis_options opt = all_modes(true);
    mt_err err = {.text = ""};
    fill_grid(0.5, 400.0, w);
    if (mech_must(t, model, s->configuration, s->parameters, &q.m) &&
        CHECK(t, mt_analysis_solve(q.m.a, q.m.at, &opt, &err) == MT_OK) &&
        ask_modes(t, &q, s->inputs, s->outputs, modes)) {
        check_weighted(t, &q, w, GRID);
    }
    done(&q);
}

/* Massless bodies with and without a damper, loss factors, ratios, dampers; the last with one
 * mode kept: the sum is that of all of them nevertheless. */
static void weighted__sums_are_those_of_single_slopes(mt_test *t)
{
    static const char *const ROWS[] = {
        ROW("0", "\"ground\",", ""),
        ROW("0", "\"a\",", ""),
        ROW("\"m/3\"", "\"a\",", "\"mass_per_s\": 0.1, \"stiffness_s\": \"z/10\""),
        ROW("1", "\"ground\",", "\"ratio\": \"z\""),
    };
    for (int i = 0; i < 4; i++) {
        for (int modes = 0; modes < 2; modes++) {
            over_grid(t,
                      &(const sloped){ROWS[i], NULL, "c", "m k eta c z", "e.x f.x base.x",
                                      "e.x:velocity f.x spring.s spring.v damper.d "
                                      "joint.jb.y joint.ja.y"},
                      modes);
        }
    }
    static const char *const CONFIGURATIONS[2] = {"all", "driven"};
    for (int c = 0; c < 2; c++) {
        over_grid(t,
                  &(const sloped){NULL, "damped_linkage", CONFIGURATIONS[c],
                                  "a k m_c alpha c eta zeta rate lag", "base.x base.y",
                                  "spring.coil damper.strut damper.oil joint.jA.x joint.jB.y "
                                  "joint.jS.x"},
                  0);
    }
}

#define ONE                                                                                 \
    "{ \"format\": \"modetune-model/1\", \"name\": \"o\", \"dimension\": 2,"                \
    "  \"parameters\": { \"m\": 2, \"k\": 800, \"c\": 0 },"                                 \
    "  \"bodies\": [ { \"name\": \"a\", \"mass_kg\": \"m\", \"inertia_kg_m2\": 0.1,"        \
    "                  \"centre\": [0, 0] } ],"                                             \
    "  \"joints\": [ { \"name\": \"ja\", \"type\": \"prismatic\", \"bodies\": [\"ground\"," \
    "                  \"a\"], \"at\": [0, 0], \"axis\": [1, 0] } ],"                       \
    "  \"springs\": [ { \"name\": \"s\", \"type\": \"axial\", \"bodies\": [\"ground\","     \
    "                   \"a\"], \"at\": [[-1, 0], [0, 0]],"                                 \
    "                   \"stiffness_n_per_m\": \"k\" } ],"                                  \
    "  \"dampers\": [ { \"name\": \"d\", \"type\": \"axial\", \"bodies\": [\"ground\","     \
    "                   \"a\"], \"at\": [[-1, 0], [0, 0]],"                                 \
    "                   \"damping_n_s_per_m\": \"c\" } ],"                                  \
    "  \"sensors\": [ { \"name\": \"e\", \"on\": \"a\", \"at\": [0, 0] } ],"                \
    "  \"configurations\": { \"c\": {} } }"

/* H = 1/D, D = k + s c - w^2 m: dH = -(1, s, -w^2)/D^2 by k, c and m. And where nothing damps
 * its resonance there is none. */
static void weighted__one_mass_matches_its_closed_form(mt_test *t)
{
    double w[GRID];
    double complex weight[GRID];
    double want[3] = {0.0};
    double size[3] = {0.0};
    double got[3] = {0.0};
    asked q = {.rc = MT_OK};
    const mt_analysis_options opt = all_modes(true);
    mt_err err = {.text = ""};
    fill_grid(1.0, 300.0, w);
    for (int i = 0; i < GRID; i++) {
        const double complex d = 800.0 - (2.0 * w[i] * w[i]) + mt_complex(0.0, 3.0 * w[i]);
        const double complex by[3] = {1.0, mt_complex(0.0, w[i]), -w[i] * w[i]};
        weight[i] = weight_of(i);
        for (int p = 0; p < 3; p++) {
            want[p] -= creal(weight[i] * by[p] / (d * d));
            size[p] += cabs(by[p] * weight[i] / (d * d));
        }
    }
    if (!mech_must(t, mech_parse(t, ONE), "c", "k c m", &q.m)) {
        done(&q);
        return;
    }
    q.m.at[1] = 3.0;
    CHECK(t, mt_analysis_solve(q.m.a, q.m.at, &opt, &err) == MT_OK);
    if (ask(t, &q, "e.x", "e.x")) {
        CHECK(t, mt_response_weighted_slopes(&q.r, 0, 0, GRID, w, weight, got, &err) == MT_OK);
        for (int p = 0; p < 3; p++) {
            mt_test_row(t, "parameter %d", p);
            CHECK_NEAR_ABS(t, got[p], want[p], 1e-13 * size[p]);
        }
        CHECK(t, mt_response_weighted_slopes(&q.r, 0, 0, 0, w, weight, got, &err) == MT_OK);
        CHECK(t, got[0] == 0.0 && got[1] == 0.0 && got[2] == 0.0);
    }
    mt_response_free(&q.r);
    q.m.at[1] = 0.0;
    CHECK(t, mt_analysis_solve(q.m.a, q.m.at, &opt, &err) == MT_OK);
    if (ask(t, &q, "e.x", "e.x")) {
        w[GRID / 2] = 20.0;
        CHECK(t, mt_response_weighted_slopes(&q.r, 0, 0, GRID, w, weight, got, &err) == MT_OK);
        CHECK(t, isnan(got[0]) && isnan(got[1]) && isnan(got[2]));
    }
    done(&q);
}

MT_TEST_MAIN(MT_TEST(weighted__one_mass_matches_its_closed_form),
             MT_TEST(weighted__sums_are_those_of_single_slopes))
