/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A tuned mass damper on an undamped machine: M = 1, K = 1, an absorber mu with k and c. The
 * least possible peak of the machine's displacement under a force on it has a closed form,
 *     f    = 2/(1 + mu) sqrt(2 a / (3 b)),   a = 16 + 23 mu + 9 mu^2 + 2 (2 + mu) r,
 *     zeta = sqrt((8 + 9 mu - 4 r) / (1 + mu)) / 4,
 *     b = 64 + 80 mu + 27 mu^2,   r = sqrt(4 + 3 mu)
 * (Nishihara and Asami, Journal of Vibration and Acoustics 124, 2002), k = mu f^2 and
 * c = 2 zeta mu f; both peaks are equal there. Den Hartog's tuning f = 1/(1 + mu) is close.
 */
#include <complex.h>

#include "study_fixture.h"

#define MU 0.05
#define ABSORBER(k, c)                                                                     \
    "{'format': 'modetune-model/1', 'dimension': 2,"                                       \
    "'parameters': {'k': " k ", 'c': " c "},"                                              \
    "'bodies': [{'name': 'main', 'mass_kg': 1, 'inertia_kg_m2': 1, 'centre': [1, 0]},"     \
    " {'name': 'absorber', 'mass_kg': 0.05, 'inertia_kg_m2': 1, 'centre': [2, 0]}],"       \
    "'joints': [{'name': 's', 'type': 'prismatic', 'bodies': ['ground', 'main'],"          \
    " 'at': [1, 0], 'axis': [1, 0]}, {'name': 't', 'type': 'prismatic',"                   \
    " 'bodies': ['main', 'absorber'], 'at': [2, 0], 'axis': [1, 0]}],"                     \
    "'springs': [{'name': 'k', 'type': 'axial', 'joint': 's', 'stiffness_n_per_m': 1},"    \
    " {'name': 'k2', 'type': 'axial', 'joint': 't', 'stiffness_n_per_m': 'k'}],"           \
    "'dampers': [{'name': 'c', 'type': 'axial', 'joint': 't', 'damping_n_s_per_m': 'c'}]," \
    "'sensors': [{'name': 'main', 'on': 'main', 'at': [1, 0], 'directions': ['x']}]}"
#define BAND "'band_hz': [0.016, 1.6]"
#define LEAST_PEAK                                                                \
    "'variables': [{'parameter': 'k', 'lower': 1e-4, 'upper': 10},"               \
    " {'parameter': 'c', 'lower': 0, 'upper': 10}],"                              \
    "'goals': [{'type': 'response', 'input': 'main.x', 'output': 'main.x', " BAND \
    ", 'at_most': 1}], 'objective': {'minimise': 'vibration'}"

/* |H| of the machine at w. */
static double magnitude(double k, double c, double w)
{
    const double complex z = k + (w * c * (double complex)I);
    const double s = w * w;
    const double complex absorber = (z * (MU * s)) / (z - (MU * s));
    return 1.0 / cabs(1.0 - s - absorber);
}

/* The largest between two frequencies by golden section. */
static double peak(double k, double c, double from, double to)
{
    static const double GOLDEN = 0.6180339887498949;
    for (int i = 0; i < 200; i++) {
        const double a = to - (GOLDEN * (to - from));
        const double b = from + (GOLDEN * (to - from));
        if (magnitude(k, c, a) > magnitude(k, c, b)) {
            to = b;
        } else {
            from = a;
        }
    }
    return magnitude(k, c, from);
}

static void tuned(double *k, double *c)
{
    const double r = sqrt(4.0 + (3.0 * MU));
    const double f =
        2.0 / (1.0 + MU) *
        sqrt(2.0 * (16.0 + (23.0 * MU) + (9.0 * MU * MU) + (2.0 * (2.0 + MU) * r)) /
             (3.0 * (64.0 + (80.0 * MU) + (27.0 * MU * MU))));
    const double zeta = 0.25 * sqrt((8.0 + (9.0 * MU) - (4.0 * r)) / (1.0 + MU));
    *k = MU * f * f;
    *c = 2.0 * zeta * MU * f;
}

static void absorber__is_tuned_from_ten_times_off(mt_test *t)
{
    static const char *const models[] = {ABSORBER("0.45", "0.12"), ABSORBER("0.0045", "0.12"),
                                         ABSORBER("0.45", "0.0013"),
                                         ABSORBER("0.0045", "0.0013"), ABSORBER("0.0045", "0")};
    double k = 0.0;
    double c = 0.0;
    tuned(&k, &c);
    const double least = peak(k, c, 0.7, 0.95);
    CHECK_NEAR(t, peak(k, c, 0.95, 1.2), least, 1e-12 * least); /* both peaks are equal */
    for (size_t i = 0; i < sizeof models / sizeof models[0]; i++) {
        study_case s;
        mt_test_row(t, "start %d", (int)i);
        if (study_solve(t, models[i], LEAST_PEAK, &s) &&
            CHECK(t, s.result->n_recommendations > 0)) {
            const mt_recommendation *const rec = &s.result->recommendations[0];
            const double own_k = study_value(&s, 1, "k");
            const double own_c = study_value(&s, 1, "c");
            CHECK_INT(t, s.result->status, MT_RESULT_SOLVED);
            CHECK_NEAR(t, own_k, k, 1e-7 * k);
            CHECK_NEAR(t, own_c, c, 1e-6 * c);
            CHECK_NEAR(t, rec->score, 100.0 * least, 1e-9 * 100.0 * least);
            CHECK_NEAR(t, peak(own_k, own_c, 0.7, 0.95), peak(own_k, own_c, 0.95, 1.2), 1e-7);
            CHECK_INT(t, rec->n_responses, 1);
            CHECK_NEAR(t, rec->responses[0].value, least, 1e-9 * least);
            CHECK(t, strcmp(rec->responses[0].grade, "proven") == 0 &&
                         rec->responses[0].error < 1e-6 * least);
            CHECK(t, rec->goals[0].weighted);
        }
        study_free(&s);
    }
}

/* Where vibration is made least, a limit that the least peak keeps within the tolerance of a
 * goal, 1e-6 of it, is told as kept. */
static void limit__beside_the_least_peak_is_told_as_kept(mt_test *t)
{
    static const struct {
        double limit; /* in parts of the least peak */
        bool kept;
    } rows[] = {{1.0 + 2e-6, true},  {1.0 + 5e-7, true},  {1.0, true},       {1.0 - 5e-7, true},
                {1.0 - 2e-6, false}, {1.0 - 1e-4, false}, {1.0 + 1e-4, true}};
    double k = 0.0;
    double c = 0.0;
    tuned(&k, &c);
    const double least = peak(k, c, 0.7, 0.95);
    for (int i = 0; i < MT_COUNT(rows); i++) {
        study_case s;
        char members[1024];
        mt_test_row(t, "limit %.9g times the least peak", rows[i].limit);
        (void)snprintf(members, sizeof members,
                       "'variables': [{'parameter': 'k', 'lower': 0.01, 'upper': 0.1},"
                       " {'parameter': 'c', 'lower': 0.002, 'upper': 0.05}],"
                       "'goals': [{'type': 'response', 'input': 'main.x', 'output': 'main.x', "
                       "" BAND ", 'at_most': %.17g}], 'objective': {'minimise': 'vibration'}",
                       rows[i].limit * least);
        if (study_solve(t, ABSORBER("0.045", "0.012"), members, &s)) {
            const char *const none = "no recommendation keeps all limits of vibration";
            CHECK(t, (strstr(s.result->status_text, none) == NULL) == rows[i].kept);
            CHECK(t, !rows[i].kept || strstr(s.result->status_text, " kept") != NULL);
        }
        study_free(&s);
    }
}

/* The least change that keeps a limit ends at it, whichever peak is the larger; below the least
 * possible peak there is no design, and the relaxation is that peak. */
static void limit__is_held_or_relaxed_to_the_least_peak(mt_test *t)
{
#define LIMITED(most)                                                             \
    "'variables': [{'parameter': 'k', 'lower': 1e-4, 'upper': 10},"               \
    " {'parameter': 'c', 'lower': 1e-4, 'upper': 10}],"                           \
    "'goals': [{'type': 'response', 'input': 'main.x', 'output': 'main.x', " BAND \
    ", 'at_most': " most "}]"
    study_case s;
    if (study_solve(t, ABSORBER("0.0045", "0.12"), LIMITED("8"), &s)) {
        const double k = study_value(&s, 1, "k");
        const double c = study_value(&s, 1, "c");
        CHECK_INT(t, s.result->status, MT_RESULT_SOLVED);
        CHECK_NEAR(t, fmax(peak(k, c, 0.5, 0.95), peak(k, c, 0.95, 1.3)), 8.0, 1e-5);
    }
    study_free(&s);
    if (study_solve(t, ABSORBER("0.0045", "0.12"), LIMITED("6"), &s)) {
        bool told = false;
        CHECK(t, s.result->status != MT_RESULT_SOLVED);
        for (int i = 0; i < s.result->n_relaxations; i++) {
            const mt_relaxation *const r = &s.result->relaxations[i];
            if (strcmp(r->kind, "goal") == 0) {
                told = true;
                CHECK_NEAR(t, r->to, 6.40792, 1e-4);
            }
        }
        CHECK(t, told);
    }
    study_free(&s);
}

/* A mass on a spring k without damping: a resonance in the band has no bound, and the search
 * leaves the band; with a dashpot that begins at 0 it may damp instead. */
#define MASS(damping)                                                                      \
    "{'format': 'modetune-model/1', 'dimension': 2,"                                       \
    "'parameters': {'k': 400, 'c': " damping "},"                                          \
    "'bodies': [{'name': 'm', 'mass_kg': 1, 'inertia_kg_m2': 1, 'centre': [1, 0]}],"       \
    "'joints': [{'name': 's', 'type': 'prismatic', 'bodies': ['ground', 'm'],"             \
    " 'at': [1, 0], 'axis': [1, 0]}],"                                                     \
    "'springs': [{'name': 'k', 'type': 'axial', 'joint': 's', 'stiffness_n_per_m': 'k'}]," \
    "'dampers': [{'name': 'c', 'type': 'axial', 'joint': 's', 'damping_n_s_per_m': 'c'}]," \
    "'sensors': [{'name': 'm', 'on': 'm', 'at': [1, 0], 'directions': ['x']}]}"

static void resonance__without_damping_is_left(mt_test *t)
{
    study_case s;
    if (study_solve(t, MASS("0"),
                    "'variables': [{'parameter': 'k', 'lower': 100, 'upper': 1e5}],"
                    "'goals': [{'type': 'response', 'input': 'base.x',"
                    " 'output': 'm.x:acceleration', 'band_hz': [2, 5], 'at_most': 1.5}]",
                    &s)) {
        const double w = 2.0 * STUDY_PI * 5.0;
        CHECK_INT(t, s.result->status, MT_RESULT_SOLVED);
        CHECK(t, strcmp(s.result->baseline.responses[0].end, "infinite") == 0 &&
                     !s.result->baseline.goals[0].met);
        /* k / (k - w^2) = 1.5 */
        CHECK_NEAR(t, study_value(&s, 1, "k"), 3.0 * w * w, 1e-2);
        CHECK(t, s.result->recommendations[0].responses[0].at_edge);
    }
    study_free(&s);
    if (study_solve(t, MASS("0"),
                    "'variables': [{'parameter': 'c', 'lower': 0, 'upper': 40, 'scale': 1}],"
                    "'goals': [{'type': 'response', 'input': 'base.x',"
                    " 'output': 'm.x:acceleration', 'band_hz': [2, 5], 'at_most': 3}]",
                    &s)) {
        CHECK_INT(t, s.result->status, MT_RESULT_SOLVED);
        CHECK_NEAR(t, s.result->recommendations[0].responses[0].value, 3.0, 1e-4);
    }
    study_free(&s);
}

/* White noise on the base of one mass: the displacement as seen from the base has
 *     RMS^2 = G/(4 w_n^3 2 zeta) = G m^2/(4 k c)   (one-sided G per Hz, over all frequencies);
 * what lies outside of the profile's 0.01 Hz to 1 MHz is 1e-3 of it at most below. The absolute
 * acceleration has pi/2 f_n Q (1 + 4 zeta^2) G. */
static void rms__under_white_noise_has_its_closed_form(mt_test *t)
{
    static const double G = 9.80665 * 9.80665;
    study_case s;
    if (study_solve(t, MASS("2"),
                    "'variables': [{'parameter': 'c', 'lower': 0.1, 'upper': 40}],"
                    "'goals': [{'type': 'vibration', 'profile': 'white', 'input': 'base.x',"
                    " 'output': 'm.x:acceleration', 'target': 150}]",
                    &s)) {
        const double c = study_value(&s, 1, "c");
        const double w = 20.0;
        const double zeta = 0.5 * c / w;
        const double hz = w / (2.0 * STUDY_PI);
        const double all = 0.5 * STUDY_PI * hz / (2.0 * zeta) * (1.0 + (4.0 * zeta * zeta)) * G;
        /* |H|^2 is 1 below 0.01 Hz and (2 zeta f_n / f)^2 above 1 MHz */
        const double outside = G * (0.01 + (4.0 * zeta * zeta * hz * hz / 1e6));
        CHECK_INT(t, s.result->status, MT_RESULT_SOLVED);
        CHECK_NEAR(t, sqrt(all - outside), 150.0, 1e-4);
        CHECK(t, strcmp(s.result->recommendations[0].responses[0].unit, "m/s^2") == 0);
    }
    study_free(&s);
}

/* A mass that is critically damped at the original design has a double pole: no sum, and so
 * samples. |H|^2 = (1 + 4 r^2) / (1 + r^2)^2 of the absolute acceleration, r = w / 20, whose
 * largest value 4/3 is at r^2 = 1/2; of white noise as above with zeta = 1. The search goes on
 * from there. */
static void double_pole__is_sampled(mt_test *t)
{
    study_case s;
    if (study_solve(t, MASS("40"),
                    "'variables': [{'parameter': 'c', 'lower': 1, 'upper': 80}],"
                    "'goals': [{'type': 'response', 'input': 'base.x',"
                    " 'output': 'm.x:acceleration', 'band_hz': [0.1, 50], 'at_most': 1.2},"
                    "{'type': 'vibration', 'profile': 'white', 'input': 'base.x',"
                    " 'output': 'm.x:acceleration', 'at_most': 1e4}]",
                    &s)) {
        const mt_result_response *const r = s.result->baseline.responses;
        const double hz = 20.0 / (2.0 * STUDY_PI);
        const double all = 0.25 * STUDY_PI * hz * 5.0;
        const double outside = 0.01 + (4.0 * hz * hz / 1e6);
        CHECK(t, strcmp(r[0].grade, "sampled") == 0 && !MT_HAS(r[0].error));
        CHECK_NEAR(t, r[0].value, sqrt(4.0 / 3.0), 1e-12);
        CHECK_NEAR(t, r[0].frequency_hz, hz * sqrt(0.5), 1e-6);
        CHECK(t, strcmp(r[1].grade, "sampled") == 0 && r[1].error < 1e-9 * r[1].value);
        CHECK_NEAR(t, r[1].value, 9.80665 * sqrt(all - outside), 1e-6);
        /* all is in proportion to 1 / zeta + 4 zeta, zeta = c / 40, outside to nothing */
        const double *const slope = s.result->baseline.goals[1].sensitivity;
        if (CHECK(t, slope != NULL)) {
            CHECK_NEAR(t, slope[0], 0.5 * 9.80665 * (0.6 * all / 40.0) / sqrt(all - outside),
                       1e-5 * r[1].value);
        }
        CHECK_INT(t, s.result->status, MT_RESULT_SOLVED);
    }
    study_free(&s);
    if (study_solve(t, MASS("40"),
                    "'variables': [{'parameter': 'c', 'lower': 1, 'upper': 80}],"
                    "'goals': [{'type': 'response', 'input': 'base.x',"
                    " 'output': 'm.x:acceleration', 'band_hz': [0.1, 50], 'at_most': 1.12}]",
                    &s)) {
        CHECK_INT(t, s.result->status, MT_RESULT_SOLVED);
        CHECK_NEAR(t, s.result->recommendations[0].responses[0].value, 1.12, 1e-5);
        CHECK(t, strcmp(s.result->recommendations[0].responses[0].grade, "proven") == 0);
    }
    study_free(&s);
}

/* Over a catalogue of both the best combination is that of the least peak, looked up. */
static void catalogue__of_absorbers_is_judged_by_the_peak(mt_test *t)
{
    static const double SPRINGS[] = {0.04, 0.0453, 0.05};
    static const double DASHPOTS[] = {0.005, 0.0127, 0.03};
    double least = HUGE_VAL;
    int best[2] = {0, 0};
    study_case s;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            const double own = fmax(peak(SPRINGS[i], DASHPOTS[j], 0.5, 0.95),
                                    peak(SPRINGS[i], DASHPOTS[j], 0.95, 1.3));
            best[0] = own < least ? i : best[0];
            best[1] = own < least ? j : best[1];
            least = fmin(own, least);
        }
    }
    if (study_solve(
            t, ABSORBER("0.0045", "0.12"),
            "'variables': [{'parameter': 'k', 'catalogue': [0.04, 0.0453, 0.05]},"
            " {'parameter': 'c', 'catalogue': [0.005, 0.0127, 0.03]}],"
            "'goals': [{'type': 'response', 'input': 'main.x', 'output': 'main.x', " BAND
            ", 'at_most': 1}], 'objective': {'minimise': 'vibration'}",
            &s)) {
        CHECK_INT(t, s.result->status, MT_RESULT_SOLVED);
        CHECK_NEAR(t, study_value(&s, 1, "k"), SPRINGS[best[0]], 0.0);
        CHECK_NEAR(t, study_value(&s, 1, "c"), DASHPOTS[best[1]], 0.0);
        CHECK_NEAR(t, s.result->recommendations[0].score, 100.0 * least, 1e-8 * least);
        CHECK_INT(t, s.result->n_unidentifiable, 0);
    }
    study_free(&s);
}

/* More room for the dashpot costs change and saves vibration until the optimum is within: a
 * front with two sides, beside bands that the second mode keeps clear of. */
static void vibration__is_one_side_of_a_front(mt_test *t)
{
    study_case s;
    if (study_solve(
            t, ABSORBER("0.0453", "0.001"),
            "'variables': [{'parameter': 'k', 'lower': 1e-3, 'upper': 1},"
            " {'parameter': 'c', 'lower': 1e-4, 'upper': 0.005}],"
            "'goals': [{'type': 'response', 'input': 'main.x', 'output': 'main.x', " BAND
            ", 'at_most': 1}, {'type': 'avoid', 'bands_hz': [[0.2, 0.3]]}],"
            "'objective': {'minimise': 'vibration'},"
            "'trade': {'vary': [{'variable': 'c', 'bound': 'upper',"
            " 'values': [0.004, 0.008, 0.016]}], 'objectives': ['vibration', 'change']}",
            &s) &&
        CHECK_INT(t, s.result->trade->n_points, 3)) {
        const mt_trade_point *const p = s.result->trade->points;
        for (int i = 0; i < 3; i++) {
            mt_test_row(t, "point %d", i);
            CHECK(t, p[i].pareto && p[i].best.feasible);
            CHECK(t, i == 0 || (p[i].best.score < p[i - 1].best.score &&
                                p[i].best.change > p[i - 1].best.change));
        }
    }
    study_free(&s);
}

/* Least change within a limit that varies: the part that the peak has of the study's own limit
 * is the other side, whatever a point is given. A point whose limit the original keeps is the
 * original itself. */
static void vibration__is_told_where_change_is_made_least(mt_test *t)
{
    static const double LIMITS[] = {1e4, 12.0, 9.0, 7.0};
    study_case s;
    if (study_solve(
            t, ABSORBER("0.0453", "0.001"),
            "'variables': [{'parameter': 'k', 'lower': 1e-3, 'upper': 1},"
            " {'parameter': 'c', 'lower': 1e-4, 'upper': 0.1}],"
            "'goals': [{'type': 'response', 'input': 'main.x', 'output': 'main.x', " BAND
            ", 'at_most': 10}], 'objective': {'minimise': 'change'},"
            "'trade': {'vary': [{'goal': 0, 'member': 'at_most', 'values': [10000, 12, 9, 7]}],"
            " 'objectives': ['change', 'vibration']}",
            &s) &&
        CHECK_INT(t, s.result->trade->n_points, 4)) {
        const mt_trade_point *const p = s.result->trade->points;
        CHECK_NEAR_ABS(t, p[0].best.change, 0.0, 1e-9);
        for (int i = 0; i < 4; i++) {
            mt_test_row(t, "limit %g", LIMITS[i]);
            CHECK(t, p[i].pareto && p[i].best.feasible);
            CHECK(t, i == 0 || p[i].best.change > p[i - 1].best.change);
            CHECK(t, i == 0 || fabs(p[i].best.responses[0].value / LIMITS[i] - 1.0) < 1e-5);
        }
    }
    study_free(&s);
}

#define HELD(k, c)                                                                           \
    "{'format': 'modetune-model/1', 'dimension': 2, 'parameters': {'k': " k ", 'c': " c "}," \
    "'bodies': [{'name': 'main', 'mass_kg': 1, 'inertia_kg_m2': 1, 'centre': [1, 0]}],"      \
    "'joints': [{'name': 's', 'type': 'prismatic', 'bodies': ['ground', 'main'],"            \
    " 'at': [1, 0], 'axis': [1, 0]}],"                                                       \
    "'springs': [{'name': 'k', 'type': 'axial', 'joint': 's', 'stiffness_n_per_m': 'k'}],"   \
    "'dampers': [{'name': 'c', 'type': 'axial', 'joint': 's', 'damping_n_s_per_m': 'c'}],"   \
    "'sensors': [{'name': 'main', 'on': 'main', 'at': [1, 0], 'directions': ['x']}]}"

/* |H| = 1/k far below the resonance, with limits ten decades apart: half of the lower one is
 * missed by 50 %, and the least change to it is ln 2. */
static void response__has_two_limits_however_far_apart(mt_test *t)
{
    study_case s;
    if (study_solve(t, HELD("2e10", "1"),
                    "'variables': [{'parameter': 'k', 'lower': 1e9, 'upper': 1e11}],"
                    "'goals': [{'type': 'response', 'input': 'main.x', 'output': 'main.x',"
                    " 'at_hz': 1, 'at_least': 1e-10, 'at_most': 1}]",
                    &s)) {
        CHECK_NEAR(t, s.result->baseline.goals[0].violation_percent, 50.0, 1e-4);
        CHECK(t, !s.result->baseline.goals[0].met);
        CHECK_NEAR(t, study_value(&s, 1, "k"), 1e10, 1e-5 * 1e10);
        CHECK_NEAR(t, s.result->recommendations[0].change, log(2.0), 1e-5);
    }
    study_free(&s);
}

/* What has no value at the original design has none there in the objective either: a negative
 * spring has no response. The least has k as large as may be: 1/(c w) at its resonance. */
static void objective__of_a_response_that_is_not_there_has_no_value(mt_test *t)
{
    study_case s;
    if (study_solve(t, HELD("-100", "1"),
                    "'variables': [{'parameter': 'k', 'lower': -200, 'upper': 400}],"
                    "'goals': [{'type': 'response', 'input': 'main.x', 'output': 'main.x',"
                    " 'band_hz': [0.1, 10], 'at_most': 1}],"
                    "'objective': {'minimise': 'vibration'}",
                    &s)) {
        const double peak = 1.0 / sqrt(400.0 - 0.25); /* c = m = 1 */
        CHECK(t, isnan(s.result->baseline.goals[0].value));
        CHECK(t, isnan(s.result->baseline.objectives[0].recommended));
        CHECK(t, isnan(s.result->baseline.score));
        CHECK_NEAR(t, study_value(&s, 1, "k"), 400.0, 1e-6);
        CHECK_NEAR(t, s.result->recommendations[0].score, 100.0 * peak, 1e-6 * 100.0 * peak);
    }
    study_free(&s);
}

/* Without a damper the response in the band of the resonance has no end, and neither has the
 * largest part of a limit, whichever goal stands first. */
static void objective__of_two_responses_has_no_value_where_one_has_none(mt_test *t)
{
#define IN_BAND                                                                     \
    "{'type': 'response', 'input': 'main.x', 'output': 'main.x', 'band_hz': [0.1, " \
    "10], 'at_most': 1}"
#define STATIC                                                                               \
    "{'type': 'response', 'input': 'main.x', 'output': 'main.x', 'at_hz': 1e-6, 'at_most': " \
    "1}"
    static const char *const goals[] = {IN_BAND ", " STATIC, STATIC ", " IN_BAND};
    for (int i = 0; i < MT_COUNT(goals); i++) {
        char members[700];
        study_case s;
        (void)snprintf(members, sizeof members,
                       "'variables': [{'parameter': 'c', 'lower': 0, 'upper': 2}],"
                       "'goals': [%s], 'objective': {'minimise': 'vibration'}",
                       goals[i]);
        mt_test_row(t, "%s", goals[i]);
        if (study_solve(t, HELD("400", "0"), members, &s)) {
            const mt_recommendation *const b = &s.result->baseline;
            const double peak = 1.0 / (2.0 * sqrt(400.0 - 1.0)); /* c = 2 */
            CHECK(t, isnan(b->goals[i].value));
            CHECK_NEAR(t, b->goals[1 - i].value, 1.0 / 400.0, 1e-9);
            CHECK(t, isnan(b->objectives[0].recommended) && isnan(b->score));
            CHECK_NEAR(t, s.result->recommendations[0].score, 100.0 * peak,
                       1e-6 * 100.0 * peak);
        }
        study_free(&s);
    }
}

/* What a study cannot mean is refused in words where it stands. */
static void ports__that_are_not_there_are_told(mt_test *t)
{
    static const struct {
        const char *goal;
        const char *text;
    } rows[] = {
        {"'type': 'response', 'input': 'mm.x', 'output': 'm.x', 'at_hz': 1, 'at_most': 1",
         "/goals/0/input: no input is called \"mm.x\"; did you mean \"m.x\"?"},
        {"'type': 'response', 'input': 'm.x', 'output': 'm.y', 'at_hz': 1, 'at_most': 1",
         "/goals/0/output: no output is called \"m.y\"; did you mean \"m.x\"?"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        char members[STUDY_PATH];
        study_case s;
        mt_test_row(t, "%s", rows[i].goal);
        (void)snprintf(members, sizeof members,
                       "'variables': [{'parameter': 'k', 'lower': 1, 'upper': 900}],"
                       "'goals': [{%s}]",
                       rows[i].goal);
        CHECK(t, !study_try(t, MASS("1"), members, &s));
        CHECK_STR(t, s.err.text, rows[i].text);
        CHECK_INT(t, s.rc, MT_E_INPUT);
        study_free(&s);
    }
}

MT_TEST_MAIN(MT_TEST(absorber__is_tuned_from_ten_times_off),
             MT_TEST(limit__beside_the_least_peak_is_told_as_kept),
             MT_TEST(limit__is_held_or_relaxed_to_the_least_peak),
             MT_TEST(resonance__without_damping_is_left),
             MT_TEST(rms__under_white_noise_has_its_closed_form),
             MT_TEST(double_pole__is_sampled),
             MT_TEST(catalogue__of_absorbers_is_judged_by_the_peak),
             MT_TEST(vibration__is_one_side_of_a_front),
             MT_TEST(vibration__is_told_where_change_is_made_least),
             MT_TEST(response__has_two_limits_however_far_apart),
             MT_TEST(objective__of_a_response_that_is_not_there_has_no_value),
             MT_TEST(objective__of_two_responses_has_no_value_where_one_has_none),
             MT_TEST(ports__that_are_not_there_are_told))
