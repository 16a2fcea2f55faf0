/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A mechanism, as a stranger's program uses it, against closed forms. */
#include "modetune/mechanism.h"

#include <math.h>

#include "base/workers.h"
#include "mt_refusals.h"
#include "mt_test.h"

#define MODELS MT_TEST_SOURCE_DIR "/tests/models/"

static const double PI = 3.14159265358979323846;

/* Two masses m in a row, ground - k1 - a - k2 - b: omega^2 m = s -+ sqrt(s^2 - k1 k2),
 * s = k1/2 + k2; "free" without k1. */
static const mt_file_text two_masses = {
    "two.json",
    "{\"format\": \"modetune-model/1\", \"dimension\": 2,\n"
    " \"parameters\": {\"k1\": 3, \"k2\": 1, \"m\": 1, \"both\": \"k1+k2\"},\n"
    " \"bodies\": [\n"
    "  {\"name\": \"a\", \"mass_kg\": \"m\", \"inertia_kg_m2\": 1, \"centre\": [1, 0]},\n"
    "  {\"name\": \"b\", \"mass_kg\": \"m\", \"inertia_kg_m2\": 1, \"centre\": [2, 0]}],\n"
    " \"joints\": [\n"
    "  {\"name\": \"ra\", \"type\": \"prismatic\", \"bodies\": [\"ground\", \"a\"],\n"
    "   \"at\": [1, 0], \"axis\": [1, 0]},\n"
    "  {\"name\": \"rb\", \"type\": \"prismatic\", \"bodies\": [\"ground\", \"b\"],\n"
    "   \"at\": [2, 0], \"axis\": [1, 0]}],\n"
    " \"springs\": [\n"
    "  {\"name\": \"s1\", \"type\": \"axial\", \"bodies\": [\"ground\", \"a\"],\n"
    "   \"at\": [[0, 0], [1, 0]], \"stiffness_n_per_m\": \"k1\", \"in\": [\"held\"]},\n"
    "  {\"name\": \"s2\", \"type\": \"axial\", \"bodies\": [\"a\", \"b\"],\n"
    "   \"stiffness_n_per_m\": \"k2\"}],\n"
    " \"sensors\": [{\"name\": \"a\", \"on\": \"a\", \"directions\": [\"x\"]},\n"
    "  {\"name\": \"b\", \"on\": \"b\", \"directions\": [\"x\"]}],\n"
    " \"configurations\": {\"held\": {}, \"free\": {}}}\n"};

/* Two springs at right angles hold a mass: its modes are repeated, and each moves one of
 * them. */
static const mt_file_text cross = {
    "cross.json", "{\"format\": \"modetune-model/1\", \"dimension\": 2,\n"
                  " \"parameters\": {\"kx\": 100, \"ky\": 100},\n"
                  " \"bodies\": [{\"name\": \"p\", \"mass_kg\": 1, \"centre\": [0, 0]}],\n"
                  " \"springs\": [\n"
                  "  {\"name\": \"sx\", \"type\": \"axial\", \"bodies\": [\"ground\", \"p\"],\n"
                  "   \"at\": [[-1, 0], [0, 0]], \"stiffness_n_per_m\": \"kx\"},\n"
                  "  {\"name\": \"sy\", \"type\": \"axial\", \"bodies\": [\"ground\", \"p\"],\n"
                  "   \"at\": [[0, -1], [0, 0]], \"stiffness_n_per_m\": \"ky\"}]}\n"};

static mt_model *from_text(mt_test *t, const mt_file_text *file)
{
    const mt_read_options opt = {
        .size = sizeof opt, .files = file, .n_files = 1, .files_only = 1};
    mt_model *model = NULL;
    mt_err err = {MT_OK, ""};
    CHECK_INT(t, mt_model_read(file->path, &opt, &model, &err), MT_OK);
    CHECK_STR(t, err.text, "");
    return model;
}

static double two_masses_hz(double k1, double k2, double m, int mode)
{
    const double s = (k1 / 2.0) + k2;
    const double root = sqrt((s * s) - (k1 * k2));
    return sqrt((mode == 1 ? s - root : s + root) / m) / (2.0 * PI);
}

static void mechanism__frequencies_are_those_of_the_closed_form(mt_test *t)
{
    static const char *const names[] = {"k1", "k2", "m"};
    static const double rows[][3] = {
        {3.0, 1.0, 1.0}, {1e-6, 1.0, 2.0}, {1e9, 2.0, 3.0}, {3.0, 1e8, 1e-3}};
    mt_model *const model = from_text(t, &two_masses);
    mt_mechanism *m = NULL;
    CHECK_INT(t, mt_mechanism_new(model, "held", 3, names, &m, NULL), MT_OK);
    REQUIRE(t, m != NULL);
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "k1 %g, k2 %g, m %g", rows[i][0], rows[i][1], rows[i][2]);
        CHECK_INT(t, mt_mechanism_evaluate(m, rows[i], NULL), MT_OK);
        CHECK_INT(t, mt_mechanism_vibration_modes(m), 2);
        CHECK_INT(t, mt_mechanism_rigid_body_modes(m), 0);
        for (int mode = 1; mode <= 2; mode++) {
            const double want = two_masses_hz(rows[i][0], rows[i][1], rows[i][2], mode);
            /* the closed form loses digits of the lower one by its difference */
            const double noise = mode == 1 ? 1e-16 * rows[i][1] / rows[i][0] : 0.0;
            const double wide = mode == 1 ? 1e-16 * rows[i][0] / rows[i][1] : 0.0;
            CHECK_NEAR(t, mt_mechanism_hz(m, mode), want, 1e-12 + (4.0 * (noise + wide)));
            CHECK(t, mt_mechanism_error_hz(m, mode) < 1e-9 * want);
            CHECK_INT(t, mt_mechanism_multiplicity(m, mode), 1);
        }
        CHECK(t, isnan(mt_mechanism_hz(m, 0)) && isnan(mt_mechanism_hz(m, 3)));
        CHECK(t, mt_mechanism_value(m, "both") == rows[i][0] + rows[i][1]);
    }
    mt_mechanism_delete(m);
    mt_model_delete(model);
}

static void mechanism__kinds_of_modes_are_counted(mt_test *t)
{
    mt_model *const masses = from_text(t, &two_masses);
    mt_model *pendulum = NULL;
    mt_mechanism *m = NULL;
    CHECK_INT(t, mt_mechanism_new(masses, "free", 0, NULL, &m, NULL), MT_OK);
    CHECK_INT(t, mt_mechanism_evaluate(m, NULL, NULL), MT_OK);
    CHECK_INT(t, mt_mechanism_rigid_body_modes(m), 1);
    CHECK_INT(t, mt_mechanism_vibration_modes(m), 1);
    CHECK_NEAR(t, mt_mechanism_hz(m, 1), sqrt(2.0) / (2.0 * PI), 1e-12);
    mt_mechanism_delete(m);
    mt_model_delete(masses);
    REQUIRE(t, mt_model_read(MODELS "pendulum.json", NULL, &pendulum, NULL) == MT_OK);
    CHECK_INT(t, mt_mechanism_new(pendulum, "upside_down", 0, NULL, &m, NULL), MT_OK);
    CHECK_INT(t, mt_mechanism_unstable_modes(m), 1);
    CHECK_INT(t, mt_mechanism_undecided_modes(m), 0);
    CHECK(t, isnan(mt_mechanism_hz(m, 1)) && isnan(mt_mechanism_error_hz(m, 1)));
    CHECK_INT(t, mt_mechanism_multiplicity(m, 1), 0);
    mt_mechanism_delete(m);
    mt_model_delete(pendulum);
}

/* Where a stiffness reaches 0 a design has a rigid-body mode that its neighbours have not: each
 * is counted by itself. */
static void mechanism__evaluations_do_not_know_each_other(mt_test *t)
{
    static const char *const names[] = {"k1", "m"};
    static const double rows[][2] = {{3.0, 1.0}, {0.0, 1.0}, {5.0, 2.0}, {-1.0, 1.0}};
    mt_model *const model = from_text(t, &two_masses);
    mt_mechanism *m = NULL;
    double alone[MT_COUNT(rows)][2];
    double slope[4];
    int rigid[MT_COUNT(rows)] = {0};
    for (int i = 0; i < MT_COUNT(rows); i++) {
        CHECK_INT(t, mt_mechanism_new(model, "held", 2, names, &m, NULL), MT_OK);
        (void)mt_mechanism_evaluate(m, rows[i], NULL);
        rigid[i] = mt_mechanism_rigid_body_modes(m);
        for (int mode = 1; mode <= 2; mode++) {
            alone[i][mode - 1] = mt_mechanism_hz(m, mode);
        }
        mt_mechanism_delete(m);
    }
    CHECK(t, rigid[0] == 0 && rigid[1] == 1);
    CHECK(t, isfinite(alone[0][1]) && isnan(alone[1][1]) && isnan(alone[3][0]));
    REQUIRE(t, mt_mechanism_new(model, "held", 2, names, &m, NULL) == MT_OK);
    for (int k = 0; k < 20; k++) {
        const int i = (k * k) % MT_COUNT(rows);
        mt_test_row(t, "evaluation %d, of row %d", k, i);
        (void)mt_mechanism_evaluate(m, rows[i], NULL);
        CHECK_INT(t, mt_mechanism_rigid_body_modes(m), rigid[i]);
        for (int mode = 1; mode <= 2; mode++) {
            const double hz = mt_mechanism_hz(m, mode);
            CHECK(t, hz == alone[i][mode - 1] || isnan(hz));
            CHECK_INT(t, isnan(hz), isnan(alone[i][mode - 1]));
        }
        if (k % 3 == 0 && rigid[i] == 0 && isfinite(alone[i][0])) {
            CHECK_INT(t, mt_mechanism_sensitivities(m, 2, slope, NULL), MT_OK);
            const double hz = mt_mechanism_hz(m, 1);
            CHECK(t, hz == alone[i][0]);
        }
    }
    mt_mechanism_delete(m);
    mt_model_delete(model);
}

static void mechanism__what_is_no_mechanism_is_refused(mt_test *t)
{
    static const char *const names[] = {"m"};
    static const char *const wrong[] = {"mm"};
    static const char *const twice[] = {"m", "m"};
    static const char *const missing[] = {"m", NULL};
    const double rows[] = {-1.0, nan(""), HUGE_VAL};
    mt_model *const model = from_text(t, &two_masses);
    mt_mechanism *m = NULL;
    mt_err err = {MT_OK, ""};
    CHECK_INT(t, mt_mechanism_new(model, "hold", 0, NULL, &m, &err), MT_E_USAGE);
    CHECK_STR(t, err.text, "no configuration is called \"hold\"; did you mean \"held\"?");
    CHECK_INT(t, mt_mechanism_new(model, NULL, 0, NULL, &m, &err), MT_E_USAGE);
    CHECK_STR(t, err.text, "the model has 2 configurations: say which (\"held\", \"free\")");
    CHECK_INT(t, mt_mechanism_new(model, "held", 1, wrong, &m, &err), MT_E_USAGE);
    CHECK_STR(t, err.text, "no parameter is called \"mm\"; did you mean \"m\"?");
    CHECK_INT(t, mt_mechanism_new(model, "held", 2, twice, &m, &err), MT_E_USAGE);
    CHECK_STR(t, err.text, "parameter \"m\" is given twice");
    CHECK_INT(t, mt_mechanism_new(model, "held", 2, missing, &m, &err), MT_E_USAGE);
    CHECK_INT(t, mt_mechanism_new(model, NULL, -1, names, &m, &err), MT_E_USAGE);
    CHECK(t, m == NULL);
    REQUIRE(t, mt_mechanism_new(model, "held", 1, names, &m, NULL) == MT_OK);
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "m %g", rows[i]);
        CHECK_INT(t, mt_mechanism_evaluate(m, &rows[i], &err), MT_E_USAGE);
        CHECK_INT(t, mt_mechanism_vibration_modes(m), 0);
        CHECK(t, isnan(mt_mechanism_hz(m, 1)) && isnan(mt_mechanism_value(m, "m")));
        double shape[2];
        CHECK_INT(t, mt_mechanism_shape(m, 1, shape, &err), MT_E_USAGE);
        CHECK_INT(t, mt_mechanism_sensitivities(m, 1, shape, &err), MT_E_USAGE);
        CHECK_INT(t, mt_mechanism_mac(m, 1, m, 1, shape, &err), MT_E_USAGE);
    }
    const double one = 1.0;
    CHECK_INT(t, mt_mechanism_evaluate(m, &one, &err), MT_OK);
    CHECK_NEAR(t, mt_mechanism_hz(m, 1), two_masses_hz(3.0, 1.0, 1.0, 1), 1e-12);
    mt_mechanism_delete(m);
    mt_model_delete(model);
}

/* Shapes of equal masses are orthogonal, and of the length 1/sqrt(m): (K - m omega^2) s = 0. */
static void mechanism__shapes_solve_the_equations(mt_test *t)
{
    static const char *const names[] = {"k1", "k2", "m"};
    static const double at[] = {5.0, 2.0, 0.5};
    mt_model *const model = from_text(t, &two_masses);
    mt_mechanism *m = NULL;
    double s[2][2];
    double mac[4];
    REQUIRE(t, mt_mechanism_new(model, "held", 3, names, &m, NULL) == MT_OK);
    CHECK_INT(t, mt_mechanism_evaluate(m, at, NULL), MT_OK);
    CHECK_INT(t, mt_mechanism_channels(m), 2);
    CHECK_STR(t, mt_mechanism_channel(m, 0), "a.x");
    CHECK_STR(t, mt_mechanism_channel(m, 1), "b.x");
    CHECK(t, mt_mechanism_channel(m, 2) == NULL && mt_mechanism_channel(m, -1) == NULL);
    for (int mode = 1; mode <= 2; mode++) {
        double *const x = s[mode - 1];
        mt_test_row(t, "mode %d", mode);
        CHECK_INT(t, mt_mechanism_shape(m, mode, x, NULL), MT_OK);
        const double lambda = pow(2.0 * PI * mt_mechanism_hz(m, mode), 2.0);
        CHECK_NEAR(t, (at[0] + at[1]) * x[0], (at[1] * x[1]) + (at[2] * lambda * x[0]), 1e-12);
        CHECK_NEAR(t, at[1] * (x[1] - x[0]), at[2] * lambda * x[1], 1e-12);
        CHECK_NEAR(t, at[2] * ((x[0] * x[0]) + (x[1] * x[1])), 1.0, 1e-12);
    }
    CHECK_INT(t, mt_mechanism_mac(m, 2, m, 2, mac, NULL), MT_OK);
    CHECK(t, fabs(mac[0] - 1.0) < 1e-14 && fabs(mac[3] - 1.0) < 1e-14);
    CHECK(t, mac[1] < 1e-20 && mac[2] < 1e-20);
    mt_mechanism_delete(m);
    mt_model_delete(model);
}

/* MAC between two designs, column-major, against its definition from the shapes. */
static void mechanism__mac_compares_two_designs(mt_test *t)
{
    mt_model *const model = from_text(t, &two_masses);
    static const char *const names[] = {"k2"};
    const double stiff = 40.0;
    mt_mechanism *a = NULL;
    mt_mechanism *b = NULL;
    double mac[2];
    REQUIRE(t, mt_mechanism_new(model, "held", 1, names, &a, NULL) == MT_OK);
    REQUIRE(t, mt_mechanism_new(model, "free", 0, NULL, &b, NULL) == MT_OK);
    CHECK_INT(t, mt_mechanism_evaluate(a, &stiff, NULL), MT_OK);
    CHECK_INT(t, mt_mechanism_mac(a, 2, b, 1, mac, NULL), MT_OK);
    for (int i = 0; i < 2; i++) {
        double x[2];
        mt_test_row(t, "mode %d", i + 1);
        CHECK_INT(t, mt_mechanism_shape(a, i + 1, x, NULL), MT_OK);
        const double want = pow(x[0] - x[1], 2.0) / 2.0 / ((x[0] * x[0]) + (x[1] * x[1]));
        CHECK_NEAR(t, mac[i], want, 1e-12);
    }
    CHECK_INT(t, mt_mechanism_mac(a, 2, b, 2, mac, NULL), MT_E_USAGE); /* b has one */
    mt_mechanism_delete(a);
    mt_mechanism_delete(b);
    mt_model_delete(model);
}

static void mechanism__sensitivities_are_those_of_the_closed_form(mt_test *t)
{
    static const char *const names[] = {"m", "k2", "k1"};
    static const double at[] = {2.0, 1.5, 4.0};
    mt_model *const model = from_text(t, &two_masses);
    mt_mechanism *m = NULL;
    double slope[6];
    REQUIRE(t, mt_mechanism_new(model, "held", 3, names, &m, NULL) == MT_OK);
    CHECK_INT(t, mt_mechanism_evaluate(m, at, NULL), MT_OK);
    CHECK_INT(t, mt_mechanism_sensitivities(m, 2, slope, NULL), MT_OK);
    for (int mode = 1; mode <= 2; mode++) {
        const double f = two_masses_hz(at[2], at[1], at[0], mode);
        const double s = (at[2] / 2.0) + at[1];
        const double root = sqrt((s * s) - (at[2] * at[1]));
        const double sign = mode == 1 ? -1.0 : 1.0;
        /* of s -+ root = m omega^2 by k2 and k1; f = sqrt(that / m) / (2 pi) */
        const double by_k2 = 1.0 + (sign * ((2.0 * s) - at[2]) / (2.0 * root));
        const double by_k1 = 0.5 + (sign * (s - at[1]) / (2.0 * root));
        const double per = 1.0 / (8.0 * PI * PI * f * at[0]);
        mt_test_row(t, "mode %d", mode);
        CHECK_NEAR(t, slope[mode - 1], -f / (2.0 * at[0]), 1e-12);
        CHECK_NEAR(t, slope[2 + mode - 1], by_k2 * per, 1e-12);
        CHECK_NEAR(t, slope[4 + mode - 1], by_k1 * per, 1e-12);
    }
    mt_mechanism_delete(m);
    mt_model_delete(model);
}

static void mechanism__repeated_modes_split_along_directions(mt_test *t)
{
    static const char *const names[] = {"ky"};
    mt_model *const model = from_text(t, &cross);
    mt_mechanism *m = NULL;
    double slope[2];
    REQUIRE(t, mt_mechanism_new(model, NULL, 1, names, &m, NULL) == MT_OK);
    CHECK_INT(t, mt_mechanism_multiplicity(m, 1), 2);
    CHECK_INT(t, mt_mechanism_sensitivities(m, 2, slope, NULL), MT_OK);
    CHECK_NEAR_ABS(t, slope[0], 0.0, 1e-15);
    CHECK_NEAR(t, slope[1], mt_mechanism_hz(m, 1) / 200.0, 1e-12); /* f/(2k) */
    mt_mechanism_delete(m);
    mt_model_delete(model);
}

/* The first mass pushed: H_aa = (k2 - m w^2)/det, H_ba = k2/det, and their slopes by k2. */
static void mechanism__responses_are_those_of_the_closed_form(mt_test *t)
{
    static const char *const names[] = {"k2"};
    static const char *const input = "a.x";
    static const mt_ports ports = {.n_inputs = 1, .inputs = &input};
    static const double HZ[] = {0.05, 0.2, 0.7};
    mt_model *const model = from_text(t, &two_masses);
    mt_mechanism *m = NULL;
    double re[6];
    double im[6];
    double error[6];
    REQUIRE(t, mt_mechanism_new(model, "held", 1, names, &m, NULL) == MT_OK);
    CHECK_INT(t, mt_mechanism_response(m, &ports, 3, HZ, re, im, error, NULL), MT_OK);
    for (ptrdiff_t i = 0; i < 3; i++) {
        const double x = 4.0 * PI * PI * HZ[i] * HZ[i];
        const double det = ((4.0 - x) * (1.0 - x)) - 1.0;
        const double ddet = (1.0 - x) + (4.0 - x) - 2.0;
        double slope[2];
        double slope_im[2];
        mt_test_row(t, "%g Hz", HZ[i]);
        CHECK_NEAR(t, re[2 * i], (1.0 - x) / det, 1e-12);
        CHECK_NEAR(t, re[(2 * i) + 1], 1.0 / det, 1e-12);
        CHECK_NEAR_ABS(t, im[2 * i], 0.0, 0.0);
        CHECK(t, error[2 * i] > 0.0 && error[2 * i] < 1e-12);
        CHECK_INT(t, mt_mechanism_response_slopes(m, &ports, HZ[i], slope, slope_im, NULL),
                  MT_OK);
        CHECK_NEAR(t, slope[0], (1.0 / det) - ((1.0 - x) * ddet / (det * det)), 1e-11);
        CHECK_NEAR(t, slope[1], (1.0 / det) - (ddet / (det * det)), 1e-11);
    }
    mt_err err = {MT_OK, ""};
    const double zero = 0.0;
    CHECK_INT(t, mt_mechanism_response(m, &ports, 1, &zero, re, im, NULL, &err), MT_E_USAGE);
    static const mt_ports none = {.n_inputs = 1};
    CHECK_INT(t, mt_mechanism_response(m, &none, 1, HZ, re, im, NULL, &err), MT_E_USAGE);
    mt_mechanism_delete(m);
    mt_model_delete(model);
}

/* A mass of 2 kg on a spring and a damper, its ground shaken by white noise of 0.5
 * (m/s^2)^2/Hz: RMS^2 = pi/2 f Q S (1 + 4 zeta^2), less what lies beyond the band; then at its
 * resonance. */
static const mt_file_text one_mass = {
    "one.json",
    "{\"format\": \"modetune-model/1\", \"dimension\": 2, \"parameters\": {\"f\": 20, "
    "\"zeta\": 0.05}, \"bodies\": [{\"name\": \"a\", \"mass_kg\": 2, \"inertia_kg_m2\": 1, "
    "\"centre\": [1, 0]}], \"joints\": [{\"name\": \"j\", \"type\": \"prismatic\", "
    "\"bodies\": [\"ground\", \"a\"], \"at\": [1, 0], \"axis\": [1, 0]}], \"springs\": "
    "[{\"name\": \"s\", \"type\": \"axial\", \"bodies\": [\"ground\", \"a\"], \"at\": [[0, 0], "
    "[1, 0]], \"stiffness_n_per_m\": \"2*(2*pi*f)^2\"}], \"dampers\": [{\"name\": \"d\", "
    "\"type\": \"axial\", \"bodies\": [\"ground\", \"a\"], \"at\": [[0, 0], [1, 0]], "
    "\"damping_n_s_per_m\": \"8*pi*zeta*f\"}], \"sensors\": [{\"name\": \"a\", \"on\": \"a\", "
    "\"directions\": [\"x\"]}]}"};
static const mt_file_text white = {
    "white.json", "{\"format\": \"modetune-profile/1\", \"axis\": \"x\", \"random\": "
                  "{\"psd_m2_per_s3\": [[1e-9, 0.5], [1e9, 0.5]]}, \"tones\": "
                  "[{\"frequency_hz\": [1, 2], \"acceleration_m_per_s2\": 3}]}"};

static void mechanism__shaken_by_a_profile_has_its_closed_form(mt_test *t)
{
    static const char *const names[] = {"zeta"};
    const mt_read_options opt = {
        .size = sizeof opt, .files = &white, .n_files = 1, .files_only = 1};
    mt_model *const model = from_text(t, &one_mass);
    mt_vibration *profile = NULL;
    mt_mechanism *m = NULL;
    mt_vibration_answer a = {.rms = 0.0};
    mt_err err = {MT_OK, ""};
    REQUIRE(t, mt_vibration_read("white.json", &opt, &profile, NULL) == MT_OK);
    CHECK_NEAR(t, mt_vibration_rms(profile), sqrt(0.5e9), 1e-14);
    REQUIRE(t, mt_mechanism_new(model, NULL, 1, names, &m, NULL) == MT_OK);
    for (int i = 0; i < 4; i++) {
        static const double ZETA[] = {0.05, 0.3, 1.0, 0.0};
        const double z = ZETA[i];
        mt_test_row(t, "damping ratio %g", z);
        CHECK_INT(t, mt_mechanism_evaluate(m, &z, NULL), MT_OK);
        CHECK_INT(t, mt_mechanism_vibration(m, NULL, profile, 1, &a, NULL), MT_OK);
        if (z == 0.0) {
            CHECK_INT(t, a.end, MT_VIBRATION_INFINITE);
            CHECK(t, isnan(a.rms) && isnan(a.peak));
            continue;
        }
        const double beyond = 4.0 * z * z * 400.0 / 1e9;
        const double rms =
            sqrt(0.5 * ((0.5 * PI * 20.0 / (2.0 * z) * (1.0 + (4.0 * z * z))) - beyond));
        const double r = 0.1; /* 2 Hz of 20 */
        const double tone = 3.0 * hypot(1.0, 2.0 * z * r) / hypot(1.0 - (r * r), 2.0 * z * r);
        CHECK_INT(t, a.end, MT_VIBRATION_FINITE);
        CHECK_INT(t, a.proven, z == 1.0 ? 0 : 1);
        CHECK_NEAR(t, a.rms, rms, 1e-9);
        CHECK(t, a.rms_error <= 1e-9 * rms);
        CHECK_NEAR(t, a.tones, tone, 1e-12);
        CHECK_NEAR(t, a.peak, (3.0 * a.rms) + a.tones, 1e-15);
    }
    CHECK_INT(t, mt_mechanism_vibration(m, NULL, profile, 0, &a, &err), MT_E_USAGE);
    static const char *const push = "a.x";
    static const mt_ports force = {.n_inputs = 1, .inputs = &push};
    CHECK_INT(t, mt_mechanism_vibration(m, &force, profile, 1, &a, &err), MT_E_USAGE);
    mt_mechanism_delete(m);
    mt_vibration_delete(profile);
    mt_model_delete(model);
}

/* Reading from memory, making, evaluating, and asking for everything, with the k-th allocation
 * refused. */
static mt_status use_everything(mt_test *t, const void *context)
{
    (void)t;
    (void)context;
    static const char *const names[] = {"k1", "both"};
    static const double at[] = {2.0, 3.0};
    const mt_read_options given = {
        .size = sizeof given, .files = &two_masses, .n_files = 1, .files_only = 1};
    mt_read_options opt = given;
    mt_model *model = NULL;
    mt_mechanism *m = NULL;
    double room[8];
    mt_status rc = mt_diagnostics_new(&opt.diagnostics, NULL);
    rc = rc == MT_OK ? mt_model_read("two.json", &opt, &model, NULL) : rc;
    rc = rc == MT_OK ? mt_mechanism_new(model, "held", 2, names, &m, NULL) : rc;
    rc = rc == MT_OK ? mt_mechanism_evaluate(m, at, NULL) : rc;
    rc = rc == MT_OK ? mt_mechanism_shape(m, 1, room, NULL) : rc;
    rc = rc == MT_OK ? mt_mechanism_mac(m, 2, m, 2, room, NULL) : rc;
    rc = rc == MT_OK ? mt_mechanism_sensitivities(m, 2, room, NULL) : rc;
    static const char *const input = "a.x";
    static const mt_ports ports = {.n_inputs = 1, .inputs = &input};
    rc = rc == MT_OK ? mt_mechanism_response(m, &ports, 1, at, room, room + 2, NULL, NULL) : rc;
    rc = rc == MT_OK ? mt_mechanism_response_slopes(m, &ports, 2.0, room, room + 4, NULL) : rc;
    mt_vibration *profile = NULL;
    mt_vibration_answer answers[2];
    const mt_read_options other = {
        .size = sizeof other, .files = &white, .n_files = 1, .files_only = 1};
    rc = rc == MT_OK ? mt_vibration_read("white.json", &other, &profile, NULL) : rc;
    rc = rc == MT_OK ? mt_mechanism_vibration(m, NULL, profile, 2, answers, NULL) : rc;
    mt_vibration_delete(profile);
    mt_mechanism_delete(m);
    mt_model_delete(model);
    mt_diagnostics_delete(opt.diagnostics);
    return rc;
}

static void mechanism__every_failing_allocation_is_survived(mt_test *t)
{
    CHECK_INT(t, use_everything(t, NULL), MT_OK); /* libraries claim what they keep */
    CHECK(t, mt_refuse_each(t, "use_everything", use_everything, NULL, MT_OK) > 10 ||
                 !mt_alloc_works());
}

enum { TASKS = 64, THREADS = 4 };
typedef struct share {
    mt_mechanism *of[THREADS];
    double hz[TASKS];
} share;

static mt_status one_task(void *context, int worker, int task, mt_task_path *own, mt_err *err)
{
    (void)own;
    share *const s = context;
    const double at[] = {1.0 + (0.1 * task)};
    const mt_status rc = mt_mechanism_evaluate(s->of[worker], at, err);
    s->hz[task] = mt_mechanism_hz(s->of[worker], 2);
    return rc;
}

/* Any number of mechanisms of one model at once, one thread each. */
static void mechanism__threads_share_a_model(mt_test *t)
{
    static const char *const names[] = {"k1"};
    mt_model *const model = from_text(t, &two_masses);
    share s[2];
    for (int i = 0; i < THREADS; i++) {
        REQUIRE(t, mt_mechanism_new(model, "held", 1, names, &s[0].of[i], NULL) == MT_OK);
        s[1].of[i] = s[0].of[i];
    }
    const mt_tasks many = {TASKS, one_task, NULL, &s[0], "tasks"};
    const mt_tasks alone = {TASKS, one_task, NULL, &s[1], "tasks"};
    CHECK_INT(t, mt_workers_run(THREADS, NULL, &many, NULL), MT_OK);
    CHECK_INT(t, mt_workers_run(1, NULL, &alone, NULL), MT_OK);
    for (int k = 0; k < TASKS; k++) {
        CHECK(t, s[0].hz[k] == s[1].hz[k]);
    }
    CHECK_NEAR(t, s[0].hz[20], two_masses_hz(3.0, 1.0, 1.0, 2), 1e-12);
    for (int i = 0; i < THREADS; i++) {
        mt_mechanism_delete(s[0].of[i]);
    }
    mt_model_delete(model);
}

MT_TEST_MAIN(MT_TEST(mechanism__frequencies_are_those_of_the_closed_form),
             MT_TEST(mechanism__kinds_of_modes_are_counted),
             MT_TEST(mechanism__evaluations_do_not_know_each_other),
             MT_TEST(mechanism__what_is_no_mechanism_is_refused),
             MT_TEST(mechanism__shapes_solve_the_equations),
             MT_TEST(mechanism__mac_compares_two_designs),
             MT_TEST(mechanism__sensitivities_are_those_of_the_closed_form),
             MT_TEST(mechanism__shaken_by_a_profile_has_its_closed_form),
             MT_TEST(mechanism__responses_are_those_of_the_closed_form),
             MT_TEST(mechanism__repeated_modes_split_along_directions),
             MT_TEST(mechanism__every_failing_allocation_is_survived),
             MT_TEST(mechanism__threads_share_a_model))
