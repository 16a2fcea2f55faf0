/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Named modes along sweeps of a parameter. Two oscillators of unit mass, k1 and k2 to the
 * ground and c between them:
 *     K = [k1 + c, -c; -c, k2 + c],   tan 2 theta = -2 c / (k2 - k1),
 * where theta is the angle of the modes to the masses. A name that was given at theta_0 has the
 * share cos^2(theta - theta_0) of the mode that turned with it: everything below is that closed
 * form.
 */
#include "problem/configuration.h"
#include "problem/evaluate.h"
#include "problem/workspace.h"
#include "study_fixture.h"
#include "support/mt_random.h"

#define TWO_OSCILLATORS                                                                   \
    "{'format': 'modetune-model/1', 'name': 'two oscillators', 'dimension': 2,"           \
    "'parameters': {'k1': {'value': 1}, 'k2': {'value': 2}, 'c': {'value': 0}},"          \
    "'bodies': [{'name': 'm1', 'mass_kg': 1, 'centre': [1, 0]},"                          \
    " {'name': 'm2', 'mass_kg': 1, 'centre': [2, 0]}],"                                   \
    "'joints': ["                                                                         \
    "{'name': 'r1', 'type': 'pin-in-slot', 'bodies': ['ground', 'm1'], 'at': [1, 0],"     \
    " 'axis': [1, 0]},"                                                                   \
    "{'name': 'r2', 'type': 'pin-in-slot', 'bodies': ['ground', 'm2'], 'at': [2, 0],"     \
    " 'axis': [1, 0]}],"                                                                  \
    "'springs': ["                                                                        \
    "{'name': 's1', 'type': 'axial', 'bodies': ['ground', 'm1'], 'at': [[0, 0], [1, 0]]," \
    " 'stiffness_n_per_m': 'k1'},"                                                        \
    "{'name': 's2', 'type': 'axial', 'bodies': ['ground', 'm2'], 'at': [[0, 0], [2, 0]]," \
    " 'stiffness_n_per_m': 'k2'},"                                                        \
    "{'name': 's12', 'type': 'axial', 'bodies': ['m1', 'm2'], 'at': [[1, 0], [2, 0]],"    \
    " 'stiffness_n_per_m': 'c'}],"                                                        \
    "'modes': {'first': {'configuration': 'held', 'index': 1},"                           \
    " 'second': {'configuration': 'held', 'index': 2}},"                                  \
    "'configurations': {'held': {'parameters': {'c': %s}}}}"

static const char *const VARY_K1 =
    "'name': 'two', 'variables': [{'parameter': 'k1', 'lower': 0.5, 'upper': 8}],"
    "'goals': [{'type': 'frequency', 'mode': 'first', 'at_least_hz': 0.01}]";

/* Angle of the lower mode to mass 1. */
static double angle(double k1, double k2, double c)
{
    return 0.5 * atan2(2.0 * c, k2 - k1);
}

/* Omega^2 of the mode at this angle (exactly: both modes' angles differ by a right one). */
static double lambda_at(double theta, double k1, double k2, double c)
{
    const double a = cos(theta);
    const double b = sin(theta);
    return (a * a * (k1 + c)) + (b * b * (k2 + c)) - (2.0 * a * b * c);
}

static const mt_configuration_work *track_at(mt_workspace *w, double k1, mt_err *err)
{
    const double t = mt_problem_t(w->p, 0, k1);
    mt_configuration_work *const view = &w->views[0];
    const bool ok = mt_workspace_place(w, &t, false, err) == MT_OK &&
                    mt_configuration_solve(w, view, false, err) == MT_OK &&
                    mt_configuration_track(w, view, err) == MT_OK;
    return ok ? view : NULL;
}

typedef struct sweep_count {
    int tracked;
    int ambiguous;
    int swapped; /* the name "first" is on the upper branch */
} sweep_count;

/* The names at one point of the sweep against the closed form. */
static void check_point(mt_test *t, const mt_configuration_work *view, double k1, double c,
                        double start, sweep_count *count)
{
    const double theta = angle(k1, 2.0, c);
    const double stays = pow(cos(theta - start), 2.0);
    const bool lower = stays > 0.5;
    const double share = lower ? stays : 1.0 - stays;
    const bool equal = c == 0.0 && fabs(k1 - 2.0) < 1e-9;
    const bool told = !equal && 1.0 - share <= MT_TRACK_RIVAL * share;
    const mt_track *const first = &view->track[0];
    CHECK_INT(t, (int)first->state, (int)(told ? MT_TRACKED : MT_TRACK_AMBIGUOUS));
    count->tracked += told ? 1 : 0;
    count->ambiguous += told ? 0 : 1;
    count->swapped += told && !lower ? 1 : 0;
    if (told) {
        const double want = lambda_at(lower ? theta : theta + (STUDY_PI / 2.0), k1, 2.0, c);
        /* two correctly rounded solves of order 2 */
        CHECK_NEAR(t, view->analysis->modes.lambda[first->pos], want, 1e-12);
        CHECK_NEAR_ABS(t, first->share, share, 1e-9);
        CHECK_INT(t, view->track[1].pos, 1 - first->pos);
    }
}

/* Every point of a sweep of k1 from 1 to 4 with k2 = 2 against the closed form. */
static void sweep(mt_test *t, const char *coupling, sweep_count *count)
{
    char model[4096];
    study_case s;
    mt_arena mem = {0};
    mt_problem *p = NULL;
    mt_workspace *w = NULL;
    const double c = strtod(coupling, NULL);
    enum { POINTS = 301 };
    (void)snprintf(model, sizeof model, TWO_OSCILLATORS, coupling);
    *count = (sweep_count){0};
    if (!study_load(t, model, VARY_K1, &s)) {
        return;
    }
    CHECK_INT(t, mt_arena_init(&mem, 0, NULL), MT_OK);
    if (CHECK_INT(t, mt_problem_new(s.study, NULL, &p, NULL), MT_OK) &&
        CHECK_INT(t, mt_workspace_new(p, &w, NULL), MT_OK)) {
        const double start = angle(1.0, 2.0, c);
        for (int i = 0; i < POINTS; i++) {
            const double k1 = 1.0 + (3.0 * i / (POINTS - 1));
            mt_err err = {0};
            const mt_configuration_work *const view = track_at(w, k1, &err);
            mt_test_row(t, "c = %s, k1 = %g", coupling, k1);
            if (CHECK(t, view != NULL)) {
                check_point(t, view, k1, c, start, count);
            }
        }
    }
    mt_workspace_delete(w);
    mt_problem_delete(p);
    mt_arena_free(&mem);
    study_free(&s);
}

static void tracking__a_crossing_keeps_the_names(mt_test *t)
{
    sweep_count n;
    sweep(t, "0", &n);
    CHECK_INT(t, n.ambiguous, 1); /* where both frequencies are equal */
    CHECK_INT(t, n.swapped, 200); /* k1 above 2 */
}

static void tracking__a_veering_hands_the_names_over(mt_test *t)
{
    sweep_count n;
    sweep(t, "0.001", &n);
    CHECK(t, n.ambiguous == 1); /* narrower than a step of the sweep */
    CHECK_INT(t, n.swapped, 200);
    sweep(t, "0.05", &n);
    CHECK(t, n.ambiguous > 3 && n.ambiguous < 20); /* 35 to 55 degrees: |k1 - k2| < 0.7 c */
    CHECK(t, n.swapped > 150);
}

/* Both frequencies are equal, the shapes any: the name cannot be told, but its frequency
 * can. */
static void tracking__equal_frequencies_are_ambiguous(mt_test *t)
{
    char model[4096];
    study_case s;
    (void)snprintf(model, sizeof model, TWO_OSCILLATORS, "0");
    REQUIRE(t, study_solve(t, model,
                           "'name': 'equal', 'variables': [{'parameter': 'k1', 'lower': 0.5,"
                           " 'upper': 8}], 'goals': [{'type': 'frequency', 'mode': 'first',"
                           " 'target_hz': 'sqrt(2)/(2*pi)'}]",
                           &s));
    const mt_recommendation *const best = &s.result->recommendations[0];
    CHECK_NEAR(t, best->parameters[0].recommended, 2.0, 1e-6);
    bool seen = false;
    for (int i = 0; i < best->n_frequencies; i++) {
        const mt_result_frequency *const f = &best->frequencies[i];
        if (f->name != NULL && strcmp(f->name, "first") == 0) {
            seen = true;
            CHECK_STR(t, f->identity, "ambiguous");
        }
    }
    CHECK(t, seen);
    CHECK(t, best->feasible); /* whichever it is, it has the frequency */
    CHECK(t, s.result->n_warnings > 0 &&
                 strstr(s.result->warnings[0], "ambiguous between modes 1 and 2") != NULL);
    study_free(&s);
}

/* Half way through a veering the named mode is either of two: a target met there by number is
 * no answer. */
static void tracking__a_goal_inside_a_veering_is_not_met(mt_test *t)
{
    char model[4096];
    study_case s;
    (void)snprintf(model, sizeof model, TWO_OSCILLATORS, "0.05");
    REQUIRE(t, study_solve(t, model,
                           "'name': 'inside', 'goals': [{'type': 'frequency', 'mode': 'first',"
                           " 'at_least_hz': 0.01}],"
                           "'variables': [{'parameter': 'k1', 'lower': 1.99, 'upper': 2.01}]",
                           &s));
    const mt_recommendation *const best = &s.result->recommendations[0];
    REQUIRE(t, s.result->n_recommendations > 0 && best->n_goals == 1);
    CHECK(t, !best->goals[0].met && best->goals[0].doubtful && !best->feasible);
    CHECK(t, strstr(best->goals[0].text, "ambiguous between modes 1 and 2") != NULL);
    CHECK_INT(t, (int)s.result->status, (int)MT_RESULT_COMPROMISE);
    study_free(&s);
}

/* k1 is to bring the mode of mass 1 from 1 to 3 rad^2/s^2, past the other at 2: it is then the
 * second mode. */
static void tracking__a_named_goal_is_solved_through_a_swap(mt_test *t)
{
    static const char *const couplings[] = {"0", "0.001", "0.01"};
    for (int i = 0; i < MT_COUNT(couplings); i++) {
        char model[4096];
        study_case s;
        const double c = strtod(couplings[i], NULL);
        mt_test_row(t, "c = %s", couplings[i]);
        (void)snprintf(model, sizeof model, TWO_OSCILLATORS, couplings[i]);
        if (!CHECK(t,
                   study_solve(t, model,
                               "'name': 'swap', 'variables': [{'parameter': 'k1', 'lower': 0.5,"
                               " 'upper': 8}], 'goals': [{'type': 'frequency', 'mode': 'first',"
                               " 'target_hz': 'sqrt(3)/(2*pi)'}]",
                               &s))) {
            continue;
        }
        const mt_recommendation *const best = &s.result->recommendations[0];
        /* (k1 + c - 3)(k2 + c - 3) = c^2 */
        const double want = 3.0 - c + (c * c / (2.0 + c - 3.0));
        CHECK_INT(t, (int)s.result->status, (int)MT_RESULT_SOLVED);
        CHECK_NEAR(t, best->parameters[0].recommended, want, 1e-5);
        for (int k = 0; k < best->n_frequencies; k++) {
            const mt_result_frequency *const f = &best->frequencies[k];
            if (f->name != NULL && strcmp(f->name, "first") == 0) {
                CHECK_INT(t, f->mode, 2);
                CHECK_STR(t, f->identity, "tracked");
            }
        }
        study_free(&s);
    }
}

/* A row of six unit masses, every mode named, as a model; k_1..k_6 from 1/20 to 20. */
static void write_row(mt_text *model, mt_text *study)
{
    enum { N = 6 };
    mt_text_add(model, "{'format': 'modetune-model/1', 'dimension': 2, 'parameters': {");
    mt_text_add(study, "'name': 'row', 'variables': [");
    for (int i = 1; i <= N; i++) {
        mt_text_addf(model, "%s'k_%d': %d", i > 1 ? ", " : "", i, i);
        mt_text_addf(study, "%s{'parameter': 'k_%d', 'lower': 0.05, 'upper': 20}",
                     i > 1 ? ", " : "", i);
    }
    mt_text_add(model, "}, 'bodies': [");
    for (int i = 1; i <= N; i++) {
        mt_text_addf(model, "%s{'name': 'm%d', 'mass_kg': 1, 'centre': [%d, 0]}",
                     i > 1 ? ", " : "", i, i);
    }
    mt_text_add(model, "], 'joints': [");
    for (int i = 1; i <= N; i++) {
        mt_text_addf(model,
                     "%s{'name': 'r%d', 'type': 'pin-in-slot', 'bodies': ['ground', 'm%d'],"
                     " 'at': [%d, 0], 'axis': [1, 0]}",
                     i > 1 ? ", " : "", i, i, i);
    }
    mt_text_add(model, "], 'springs': [");
    for (int i = 1; i <= N; i++) {
        mt_text_addf(model, "%s{'name': 's%d', 'type': 'axial', 'bodies': ['",
                     i > 1 ? ", " : "", i);
        mt_text_addf(model, i > 1 ? "m%d" : "ground", i - 1);
        mt_text_addf(model, "', 'm%d'], 'at': [[%d, 0], [%d, 0]], 'stiffness_n_per_m': 'k_%d'}",
                     i, i - 1, i, i);
    }
    mt_text_add(model, "], 'modes': {");
    for (int i = 1; i <= N; i++) {
        mt_text_addf(model, "%s'n%d': {'configuration': 'default', 'index': %d}",
                     i > 1 ? ", " : "", i, i);
    }
    mt_text_add(model, "}}");
    mt_text_add(study,
                "], 'goals': [{'type': 'frequency', 'mode': 'n1', 'at_least_hz': 0.001}]");
}

/*
 * Shapes that dissolve. The frequencies of a row never cross (its matrix is tridiagonal with
 * couplings that never vanish), so by continuity the i-th named mode is the i-th mode wherever
 * no veering narrower than the resolution was leapt over. Of designs drawn at random the walk
 * must reach many, and what it reaches must be that mode in nearly all of them: nearly, because
 * rows with soft springs do have narrow veerings.
 */
static void tracking__dissolved_shapes_are_followed(mt_test *t)
{
    enum { DESIGNS = 200, N = 6 };
    mt_text model = {0};
    mt_text study = {0};
    study_case s;
    mt_arena mem = {0};
    mt_problem *p = NULL;
    mt_workspace *w = NULL;
    mt_random random = mt_random_seed(7);
    int dissolved = 0;
    int reached = 0;
    int right = 0;
    write_row(&model, &study);
    REQUIRE(t, model.s != NULL && study.s != NULL && study_load(t, model.s, study.s, &s));
    CHECK_INT(t, mt_arena_init(&mem, 0, NULL), MT_OK);
    CHECK_INT(t, mt_problem_new(s.study, NULL, &p, NULL), MT_OK);
    CHECK_INT(t, mt_workspace_new(p, &w, NULL), MT_OK);
    for (int d = 0; d < DESIGNS && w != NULL; d++) {
        double x[N];
        double now[N];
        mt_track direct[N];
        mt_configuration_work *const view = &w->views[0];
        for (int i = 0; i < N; i++) {
            x[i] = log((i + 1.0) * exp(mt_random_in(&random, -1.2, 1.2)));
        }
        mt_test_row(t, "design %d", d);
        CHECK_INT(t, mt_workspace_place(w, x, false, NULL), MT_OK);
        CHECK_INT(t, mt_configuration_solve(w, view, false, NULL), MT_OK);
        CHECK_INT(t, mt_track_match(view->analysis, N, view->of->shape, direct, NULL), MT_OK);
        memcpy(now, view->analysis->modes.lambda, sizeof now);
        CHECK_INT(t, mt_configuration_track(w, view, NULL), MT_OK);
        for (int i = 0; i < N; i++) {
            CHECK(t, now[i] == view->analysis->modes.lambda[i]);
        }
        for (int i = 0; i < N; i++) {
            const bool several = direct[i].state != MT_TRACKED &&
                                 direct[i].share + direct[i].rival_share < MT_TRACK_EXCHANGE;
            const bool told = several && view->track[i].state == MT_TRACKED;
            dissolved += several ? 1 : 0;
            reached += told ? 1 : 0;
            right += told && view->track[i].pos == i ? 1 : 0;
            if (direct[i].state == MT_TRACKED) {
                CHECK_INT(t, view->track[i].pos, direct[i].pos);
            }
        }
    }
    mt_test_row(t, "%d dissolved, %d reached, %d right", dissolved, reached, right);
    CHECK(t, dissolved > 50);
    CHECK(t, reached > dissolved / 2);
    CHECK(t, 50 * right >= 49 * reached);
    mt_workspace_delete(w);
    mt_problem_delete(p);
    mt_arena_free(&mem);
    mt_text_free(&model);
    mt_text_free(&study);
    study_free(&s);
}

/* A way to a design whose last part, from the share `before` of it on, lies in a gap, where
 * designs have no value: over that no step that keeps shapes leads, only a leap. */
typedef struct gap_way {
    mt_workspace *w;
    const double *origin;
    const double *to;
    double before;
    double from; /* of the gap */
    double end;
} gap_way;

static mt_status solve_beside_gap(void *context, double s, mt_analysis **out, mt_err *err)
{
    enum { N = 6 };
    const gap_way *const way = context;
    mt_configuration_work *const view = &way->w->views[0];
    const double part = s < way->end ? way->before * s / way->from : 1.0;
    double t[N];
    if (s > way->from && s < way->end) {
        return mt_fail(err, MT_E_DOMAIN, "in the gap");
    }
    for (int i = 0; i < N; i++) {
        t[i] = way->origin[i] + (part * (way->to[i] - way->origin[i]));
    }
    *out = view->analysis;
    MT_TRY(mt_workspace_place(way->w, t, false, err));
    return mt_configuration_solve(way->w, view, false, err);
}

/* How many modes are told beyond a gap of so many shortest steps that ends so many before the
 * design, which w stands at. */
static int told_beyond(mt_test *t, const mt_workspace *w, gap_way *way, double wide,
                       double left, mt_arena *mem)
{
    enum { N = 6, STEPS = 64 };
    const mt_configuration_work *const view = &w->views[0];
    const mt_track_way path = {
        .solve = solve_beside_gap, .context = way, .resolution = 1.0 / STEPS};
    mt_track tracks[N];
    int told = 0;
    way->end = 1.0 - (left / STEPS);
    way->from = way->end - (wide / STEPS);
    CHECK_INT(t, mt_track_follow(&path, N, view->of->shape, view->analysis, mem, tracks, NULL),
              MT_OK);
    for (int i = 0; i < N; i++) {
        told += tracks[i].state == MT_TRACKED;
    }
    return told;
}

/* Shortest steps between a gap and the design. */
static const double LEFT[] = {0.1, 0.5, 0.9, 1.5, 2.2, 5.0, 16.4, 48.0};

/* Does a leap tell all half way, where no other step does? Then leapt[k]: it does at LEFT[k].
 */
static bool leap_gaps(mt_test *t, mt_workspace *w, gap_way *way, mt_arena *mem, int *leapt)
{
    enum { N = 6 };
    static const double narrow = 2.5;
    static const double wide = 5.0;
    CHECK_INT(t, mt_workspace_place(w, way->to, false, NULL), MT_OK);
    CHECK_INT(t, mt_configuration_solve(w, &w->views[0], false, NULL), MT_OK);
    const bool half_way = told_beyond(t, w, way, narrow, 32.0, mem) == N &&
                          told_beyond(t, w, way, wide, 32.0, mem) < N;
    for (int k = 0; half_way && k < MT_COUNT(LEFT); k++) {
        leapt[k] += told_beyond(t, w, way, narrow, LEFT[k], mem) == N;
    }
    return half_way;
}

/* What leaps do half way they do anywhere, up to the end; nearly: where a shape keeps just what
 * a step must, it depends on where the steps are. */
static void tracking__a_gap_of_less_than_three_steps_is_leapt(mt_test *t)
{
    enum { DESIGNS = 60, N = 6 };
    mt_text model = {0};
    mt_text study = {0};
    study_case s;
    mt_arena mem = {0};
    mt_problem *p = NULL;
    mt_workspace *w[2] = {NULL, NULL};
    mt_random random = mt_random_seed(7);
    int checked = 0;
    int leapt[MT_COUNT(LEFT)] = {0};
    write_row(&model, &study);
    REQUIRE(t, model.s != NULL && study.s != NULL && study_load(t, model.s, study.s, &s));
    CHECK_INT(t, mt_arena_init(&mem, 0, NULL), MT_OK);
    CHECK_INT(t, mt_problem_new(s.study, NULL, &p, NULL), MT_OK);
    CHECK_INT(t, mt_workspace_new(p, &w[0], NULL), MT_OK);
    CHECK_INT(t, mt_workspace_new(p, &w[1], NULL), MT_OK);
    for (int d = 0; d < DESIGNS && w[1] != NULL; d++) {
        double origin[N];
        double to[N];
        for (int i = 0; i < N; i++) {
            origin[i] = log1p(i);
            to[i] = log((i + 1.0) * exp(mt_random_in(&random, -1.0, 1.0)));
        }
        for (int k = 0; k < 5; k++) {
            gap_way way = {.w = w[1], .origin = origin, .to = to, .before = 0.5 + (0.1 * k)};
            mt_test_row(t, "design %d, %g of the way before the gap", d, way.before);
            checked += leap_gaps(t, w[0], &way, &mem, leapt);
        }
    }
    CHECK(t, checked > 20);
    for (int k = 0; k < MT_COUNT(LEFT); k++) {
        mt_test_row(t, "%g steps left: %d of %d", LEFT[k], leapt[k], checked);
        CHECK(t, 10 * leapt[k] >= 9 * checked);
    }
    mt_workspace_delete(w[0]);
    mt_workspace_delete(w[1]);
    mt_problem_delete(p);
    mt_arena_free(&mem);
    mt_text_free(&model);
    mt_text_free(&study);
    study_free(&s);
}

/* The only mode has no rival, and a mode that is lost has none either. */
static void tracking__without_another_mode_there_is_no_rival(mt_test *t)
{
    study_case s;
    mt_arena mem = {0};
    mt_problem *p = NULL;
    mt_workspace *w = NULL;
    mt_err err = {.text = ""};
    if (!study_load(t,
                    "{'format': 'modetune-model/1', 'dimension': 2, 'parameters': {'k': 1000}, "
                    "'bodies': [{'name': 'm1', 'mass_kg': 1, 'centre': [1, 0]}], 'joints': "
                    "[{'name': 'r1', 'type': 'pin-in-slot', 'bodies': ['ground', 'm1'], 'at': "
                    "[1, 0], 'axis': [1, 0]}], 'springs': [{'name': 's1', 'type': 'axial', "
                    "'bodies': ['ground', 'm1'], 'at': [[0, 0], [1, 0]], 'stiffness_n_per_m': "
                    "'k'}], 'modes': {'only': {'configuration': 'default', 'index': 1}}}",
                    "'variables': [{'parameter': 'k', 'lower': -100, 'upper': 2000}], 'goals': "
                    "[{'type': 'frequency', 'mode': 'only', 'at_least_hz': 1}]",
                    &s)) {
        return;
    }
    CHECK_INT(t, mt_arena_init(&mem, 0, NULL), MT_OK);
    if (CHECK_INT(t, mt_problem_new(s.study, NULL, &p, &err), MT_OK) &&
        CHECK_INT(t, mt_workspace_new(p, &w, &err), MT_OK)) {
        static const double stiffness[] = {1000.0, 2000.0, 500.0};
        for (int i = 0; i < MT_COUNT(stiffness); i++) {
            const mt_configuration_work *const view = track_at(w, stiffness[i], &err);
            mt_test_row(t, "k = %g", stiffness[i]);
            if (CHECK(t, view != NULL)) {
                CHECK_INT(t, (int)view->track[0].state, (int)MT_TRACKED);
                CHECK_INT(t, view->track[0].pos, 0);
                CHECK_INT(t, view->track[0].rival, -1);
                CHECK(t, view->track[0].rival_share == 0.0);
            }
        }
        const mt_configuration_work *const unstable = track_at(w, -100.0, &err);
        mt_test_row(t, "k = -100");
        if (CHECK(t, unstable != NULL)) {
            CHECK_INT(t, (int)unstable->track[0].state, (int)MT_TRACK_LOST_STATE);
            CHECK_INT(t, unstable->track[0].pos, -1);
            CHECK_INT(t, unstable->track[0].rival, -1);
        }
    }
    mt_workspace_delete(w);
    mt_problem_delete(p);
    mt_arena_free(&mem);
    study_free(&s);
}

MT_TEST_MAIN(MT_TEST(tracking__a_crossing_keeps_the_names),
             MT_TEST(tracking__a_veering_hands_the_names_over),
             MT_TEST(tracking__dissolved_shapes_are_followed),
             MT_TEST(tracking__without_another_mode_there_is_no_rival),
             MT_TEST(tracking__a_gap_of_less_than_three_steps_is_leapt),
             MT_TEST(tracking__equal_frequencies_are_ambiguous),
             MT_TEST(tracking__a_goal_inside_a_veering_is_not_met),
             MT_TEST(tracking__a_named_goal_is_solved_through_a_swap))
