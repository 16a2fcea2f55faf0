/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What is not computed again: an analysis that has seen many designs against one that has seen
 * none but the original, to the bit, for every model and configuration of the tests and random
 * sequences of designs in which some inputs move and some come back; the first few modes, where
 * no more are asked for, against these of all; configurations that share a geometry against
 * these by themselves; and how often each stage was done.
 */
#include <dirent.h>
#include <math.h>
#include <stdlib.h>

#include "linalg/dense.h"
#include "mechanics/mech.h"
#include "support/mt_random.h"

enum { STEPS = 3, STEPS_ALL = 5, DESIGNS = 4 };

/* Of slopes: of their terms, and in errors over gaps. */
static const double FINE = 1e-10;
static const double SHAPES = 10.0;
/* Inputs move by at most this part of themselves. */
static const double MOVES = 0.03;

typedef struct session {
    mech s;
    const mt_model *model;
    int configuration;
    int parameter[MECH_INPUTS];
    double design[DESIGNS][MECH_INPUTS]; /* seen so far */
} session;

/* Designs of each configuration; MT_EVERY=1: more; MT_STAGE_STEPS: so many. */
static int steps(void)
{
    const char *const given = getenv("MT_STAGE_STEPS");
    if (given != NULL) {
        return (int)strtol(given, NULL, 10);
    }
    return getenv("MT_EVERY") != NULL ? STEPS_ALL : STEPS;
}

static bool same_bytes(const double *a, const double *b, size_t n)
{
    return memcmp(a, b, n * sizeof *a) == 0;
}

/* Everything that a solve left. */
static void compare(mt_test *t, mt_analysis *a, mt_analysis *b, bool gradient, int n_inputs)
{
    const mt_reduced r = mt_linear_reduced(a->lin);
    const mt_reduced q = mt_linear_reduced(b->lin);
    const size_t n = (size_t)r.n;
    const size_t c = (size_t)a->modes.count;
    if (!CHECK_INT(t, r.n, q.n) || !CHECK_INT(t, a->modes.count, b->modes.count) ||
        !CHECK_INT(t, a->modes.shaped, b->modes.shaped)) {
        return;
    }
    CHECK(t, same_bytes(r.k, q.k, n * n));
    CHECK(t, same_bytes(r.m, q.m, n * n));
    CHECK(t, same_bytes(r.b, q.b, n * (size_t)r.rows));
    CHECK(t, same_bytes(r.c, q.c, (size_t)r.rows));
    CHECK(t, same_bytes(a->modes.lambda, b->modes.lambda, c));
    CHECK(t, same_bytes(a->modes.error, b->modes.error, c));
    CHECK(t, memcmp(a->modes.kind, b->modes.kind, c * sizeof *a->modes.kind) == 0);
    CHECK(t, (a->modes.y == NULL) == (b->modes.y == NULL));
    if (a->modes.y != NULL && b->modes.y != NULL) {
        CHECK(t, same_bytes(a->modes.y, b->modes.y, n * (size_t)a->modes.shaped));
    }
    for (int i = a->modes.shaped; i < a->modes.count && gradient; i++) {
        double ignored[MECH_INPUTS];
        CHECK_INT(t, mt_analysis_dlambda_raw(a, i, ignored, NULL), MT_E_INTERNAL);
        CHECK_INT(t, mt_analysis_products(a, i, NULL), MT_E_INTERNAL);
    }
    for (int i = 0; i < a->modes.shaped && gradient; i++) {
        double sa[MECH_INPUTS] = {0.0};
        double sb[MECH_INPUTS] = {0.0};
        CHECK_INT(t, mt_analysis_dlambda_raw(a, i, sa, NULL), MT_OK);
        CHECK_INT(t, mt_analysis_dlambda_raw(b, i, sb, NULL), MT_OK);
        CHECK(t, same_bytes(sa, sb, (size_t)n_inputs));
        CHECK_INT(t, mt_analysis_products(a, i, NULL), MT_OK);
        CHECK_INT(t, mt_analysis_products(b, i, NULL), MT_OK);
        CHECK(t, same_bytes(a->dky, b->dky, n * (size_t)n_inputs));
        CHECK(t, same_bytes(a->dmy, b->dmy, n * (size_t)n_inputs));
    }
}

/* The first modes by themselves against these of all. */
static void compare_part(mt_test *t, const mt_modes *part, const mt_modes *whole, int first)
{
    const int there = mt_modal_vibrations(whole);
    CHECK_INT(t, mt_modal_vibrations(part), there);
    CHECK_INT(t, part->n_rigid, whole->n_rigid);
    CHECK_INT(t, part->n_unstable, whole->n_unstable);
    CHECK_INT(t, part->n_undecided, whole->n_undecided);
    for (int i = 1; i <= first && i <= there; i++) {
        const int a = mt_modal_flexible(part, i);
        const int b = mt_modal_flexible(whole, i);
        int size[2] = {1, 1};
        if (!CHECK_INT(t, a, b) || a < 0) {
            break;
        }
        CHECK_NEAR_ABS(t, part->lambda[a], whole->lambda[b], part->error[a] + whole->error[b]);
        CHECK_INT(t, mt_modal_cluster(part, a, &size[0]), mt_modal_cluster(whole, b, &size[1]));
        CHECK_INT(t, size[0], size[1]);
    }
}

/* Distance of a mode to its neighbours. */
static double gap_beside(const mt_modes *modes, int i)
{
    const double below =
        i > 0 ? modes->lambda[i] - modes->lambda[i - 1] - modes->error[i - 1] : HUGE_VAL;
    const double above = i + 1 < modes->count
                             ? modes->lambda[i + 1] - modes->lambda[i] - modes->error[i + 1]
                             : HUGE_VAL;
    return fmax(fmin(below, above), 0.0);
}

/* Slopes of simple modes whose shapes were asked for, where those of all were: to the part of
 * their terms that the shapes' errors make, error / gap. */
static void compare_slopes(mt_test *t, mt_analysis *part, mt_analysis *whole, int first,
                           int n_inputs)
{
    for (int i = 1; i <= first && part->with_gradient; i++) {
        const int a = mt_modal_flexible(&part->modes, i);
        const int b = mt_modal_flexible(&whole->modes, i);
        double sa[MECH_INPUTS] = {0.0};
        double sb[MECH_INPUTS] = {0.0};
        int size = 1;
        if (a < 0 || b < 0) {
            break;
        }
        (void)mt_modal_cluster(&whole->modes, b, &size);
        if (!CHECK_INT(t, mt_analysis_dlambda_raw(part, a, sa, NULL), MT_OK) || size > 1) {
            continue;
        }
        CHECK_INT(t, mt_analysis_dlambda_raw(whole, b, sb, NULL), MT_OK);
        CHECK_INT(t, mt_analysis_products(whole, b, NULL), MT_OK);
        const int n = whole->modes.n;
        const double size_y = mt_norm2(n, mt_modal_shape(&whole->modes, b));
        const double error = part->modes.error[a] + whole->modes.error[b];
        const double share = FINE + (SHAPES * error / gap_beside(&whole->modes, b));
        for (int k = 0; k < n_inputs; k++) {
            const double terms =
                mt_norm2(n, whole->dky + ((ptrdiff_t)k * n)) +
                (whole->modes.lambda[b] * mt_norm2(n, whole->dmy + ((ptrdiff_t)k * n)));
            CHECK_NEAR_ABS(t, sa[k], sb[k], share * size_y * terms);
        }
    }
}

/* Some inputs move, none does, or an earlier design comes back. */
static void next_design(mt_random *g, session *s, double *x)
{
    const int kind = mt_random_int(g, 4);
    if (kind == 0) {
        memcpy(x, s->design[mt_random_int(g, DESIGNS)], sizeof s->design[0]);
    } else if (kind < 3 && s->s.n > 0) {
        for (int k = 0; k < kind; k++) {
            const int i = mt_random_int(g, s->s.n);
            x[i] = s->s.at[i] * (1.0 + (MOVES * mt_random_in(g, -1.0, 1.0)));
        }
    }
    memcpy(s->design[mt_random_int(g, DESIGNS)], x, sizeof s->design[0]);
}

static void run(mt_test *t, mt_random *g, session *s, int n_steps)
{
    double x[MECH_INPUTS];
    memcpy(x, s->s.at, sizeof x);
    for (int step = 0; step < n_steps; step++) {
        mt_analysis_options opt = mt_analysis_options_default();
        mt_analysis *fresh = NULL;
        mt_err err = {.text = ""};
        mt_err other = {.text = ""};
        next_design(g, s, x);
        opt.gradient = mt_random_int(g, 2) == 0;
        opt.vectors = mt_random_int(g, 2) == 0;
        opt.check = mt_random_int(g, 2) == 0;
        opt.modes.first = mt_random_int(g, 2) == 0 ? 0 : 1 + mt_random_int(g, 8);
        opt.shapes.first = mt_random_int(g, 2) == 0 ? 0 : 1 + mt_random_int(g, 8);
        mt_test_row(t, "%s, step %d", mt_analysis_configuration(s->s.a), step);
        if (!CHECK_INT(t,
                       mt_analysis_new(s->model, s->configuration, s->s.n, s->parameter,
                                       s->s.at, &fresh, &err),
                       MT_OK)) {
            continue;
        }
        const mt_status had = mt_analysis_solve(s->s.a, x, &opt, &err);
        if (CHECK_INT(t, mt_analysis_solve(fresh, x, &opt, &other), had) && had == MT_OK) {
            compare(t, s->s.a, fresh, opt.gradient, s->s.n);
            const int first = opt.modes.first;
            const int shaped = opt.shapes.first;
            opt.modes.first = 0;
            opt.shapes.first = 0;
            if (CHECK_INT(t, mt_analysis_solve(fresh, x, &opt, &other), MT_OK)) {
                compare_part(t, &s->s.a->modes, &fresh->modes, first);
                compare_slopes(t, s->s.a, fresh, shaped > 0 ? shaped : first, s->s.n);
            }
        }
        CHECK(t, had == MT_OK || strcmp(err.text, other.text) == 0);
        mt_analysis_delete(fresh);
    }
}

/* Inputs: the parameters that are plain numbers. False: not to be analysed at all. */
static bool begin(const mt_model *model, int configuration, session *s)
{
    *s = (session){.model = model, .configuration = configuration};
    for (int i = 0; i < model->n_parameters && s->s.n < MECH_INPUTS; i++) {
        const double value = mech_value(model, i);
        if (value == value) {
            s->parameter[s->s.n] = i;
            s->s.at[s->s.n++] = value;
        }
    }
    return mt_analysis_new(model, configuration, s->s.n, s->parameter, s->s.at, &s->s.a,
                           NULL) == MT_OK;
}

/* An analysis that is asked for a few modes from the start against the one of all: the same
 * counts, the same modes, and no more than those with all of the last one's cluster; or all,
 * where a judged mode is no vibration any more and another one takes its place. *fewer: how
 * often they were fewer. */
static void ask_for_few(mt_test *t, const session *s, int first, long *fewer)
{
    const mt_analysis *const all = s->s.a;
    mt_analysis *few = NULL;
    const mt_status rc = mt_analysis_new_of(&(mt_system_def){.model = s->model,
                                                             .configuration = s->configuration,
                                                             .n_inputs = s->s.n,
                                                             .inputs = s->parameter,
                                                             .at = s->s.at},
                                            first, &few, NULL);
    mt_test_row(t, "configuration %d, first %d", s->configuration, first);
    CHECK_INT(t, rc, MT_OK);
    if (all != NULL && few != NULL) {
        const mt_modes *const whole = &all->modes;
        const int last = mt_modal_flexible(whole, first);
        int size = 0;
        const int from = last < 0 ? whole->count : mt_modal_cluster(whole, last, &size);
        CHECK_INT(t, few->n_rigid, all->n_rigid);
        CHECK_INT(t, few->n_null, all->n_null);
        CHECK_INT(t, few->n_most, all->n_most);
        CHECK(t, few->modes.count == from + size || few->modes.count == whole->count);
        *fewer += few->modes.count < whole->count ? 1 : 0;
        compare_part(t, &few->modes, whole, first);
    }
    mt_analysis_delete(few);
}

static void model_file(mt_test *t, const char *path, mt_random *g, long *solved, long *fewer)
{
    mt_model *model = NULL;
    if (mt_model_load(path, NULL, &model, NULL, NULL) != MT_OK) {
        return; /* no model: a catalogue, a reference */
    }
    for (int c = 0; c < model->n_configurations; c++) {
        session s;
        if (begin(model, c, &s)) {
            for (int first = 1; first <= 9; first += 4) {
                ask_for_few(t, &s, first, fewer);
            }
            for (int i = 0; i < DESIGNS; i++) {
                memcpy(s.design[i], s.s.at, sizeof s.s.at);
            }
            run(t, g, &s, steps());
            (*solved)++;
        }
        mt_analysis_delete(s.s.a);
    }
    mt_model_delete(model);
}

typedef void each_model(mt_test *t, const char *path, mt_random *g, long *first, long *second);

static void all_models(mt_test *t, each_model *look, mt_random *g, long *first, long *second)
{
    static const char *const folders[] = {"tests/models", "problems"};
    for (int f = 0; f < 2; f++) {
        char path[MECH_PATH];
        struct dirent **list = NULL;
        (void)snprintf(path, sizeof path, "%s/%s", MT_TEST_SOURCE_DIR, folders[f]);
        const int n = scandir(path, &list, NULL, alphasort);
        for (int i = 0; i < n; i++) {
            if (strstr(list[i]->d_name, ".json") != NULL) {
                (void)snprintf(path, sizeof path, "%s/%s/%s", MT_TEST_SOURCE_DIR, folders[f],
                               list[i]->d_name);
                look(t, path, g, first, second);
            }
            free(list[i]);
        }
        free((void *)list);
    }
}

static void stages__leave_the_same_bits_whatever_was_seen_before(mt_test *t)
{
    mt_random g = mt_random_seed(5);
    long solved = 0;
    long fewer = 0;
    all_models(t, model_file, &g, &solved, &fewer);
    CHECK(t, solved > 40);
    CHECK(t, fewer > solved);
}

/* With the first of the n sessions that has the same shape. */
static bool share_one(mt_test *t, const session *s, const session *with, int n)
{
    bool shared = false;
    for (int i = 0; i < n && !shared && s->s.a != NULL; i++) {
        if (with[i].s.a != NULL) {
            CHECK_INT(t, mt_linear_share(s->s.a->lin, with[i].s.a->lin, &shared, NULL), MT_OK);
        }
    }
    return shared;
}

static long shared_stages(const session *s)
{
    const mt_stage_counts *const counts = &mt_linear_stages(s->s.a->lin)->counts;
    return counts->shared[MT_STAGE_GEOMETRY] + counts->shared[MT_STAGE_TANGENT];
}

enum { SHARING = 12 };

/* All of them at designs of their own and at those that another one was at, in any order; half
 * way the first one goes. *had: how often something was taken from another one. */
static void walk_together(mt_test *t, mt_random *g, session *all, int n, long *had)
{
    for (int round = 0; round < steps(); round++) {
        for (int k = 0; k < n; k++) {
            session *const s = &all[mt_random_int(g, n)];
            if (s->s.a != NULL) {
                memcpy(s->design, all[0].design, sizeof s->design);
                const long before = shared_stages(s);
                run(t, g, s, 2);
                memcpy(all[0].design, s->design, sizeof s->design);
                *had += shared_stages(s) - before;
            }
        }
        if (round == steps() / 2) {
            mt_analysis_delete(all[0].s.a);
            all[0].s.a = NULL;
        }
    }
}

static void model_together(mt_test *t, const char *path, mt_random *g, long *joined, long *had)
{
    mt_model *model = NULL;
    session all[SHARING];
    int n = 0;
    long here = 0;
    if (mt_model_load(path, NULL, &model, NULL, NULL) != MT_OK) {
        return;
    }
    for (int c = 0; c < model->n_configurations && n < SHARING; c++) {
        (void)begin(model, c, &all[n]);
        here += share_one(t, &all[n], all, n) ? 1 : 0;
        n++;
    }
    for (int i = 0; i < DESIGNS && n > 0; i++) {
        memcpy(all[0].design[i], all[0].s.at, sizeof all[0].s.at);
    }
    if (here > 0) {
        walk_together(t, g, all, n, had);
    }
    *joined += here;
    for (int i = 0; i < n; i++) {
        mt_analysis_delete(all[i].s.a);
    }
    mt_model_delete(model);
}

static void stages__that_are_shared_leave_the_same_bits(mt_test *t)
{
    mt_random g = mt_random_seed(7);
    long joined = 0;
    long had = 0;
    all_models(t, model_together, &g, &joined, &had);
    CHECK(t, joined >= 5);
    CHECK(t, STEPS_ALL * had > 2 * joined * steps());
}

typedef struct want {
    const char *what;
    int moves; /* input; -1: none */
    bool gradient;
    long done[MT_STAGES]; /* in the order of the stages */
} want;

static void check_counts(mt_test *t, mech *s, const want *rows, int n)
{
    mt_stages *const st = mt_linear_stages(s->a->lin);
    double x[MECH_INPUTS];
    const mt_analysis_options first = mt_analysis_options_default();
    memcpy(x, s->at, sizeof x);
    CHECK_INT(t, mt_analysis_solve(s->a, x, &first, NULL), MT_OK); /* counted as it is now */
    for (int i = 0; i < n; i++) {
        const mt_stage_counts before = st->counts;
        mt_analysis_options opt = mt_analysis_options_default();
        opt.gradient = rows[i].gradient;
        if (rows[i].moves >= 0) {
            x[rows[i].moves] = (1.01 * x[rows[i].moves]) + 1e-3;
        }
        CHECK_INT(t, mt_analysis_solve(s->a, x, &opt, NULL), MT_OK);
        for (int stage = 0; stage < MT_STAGES; stage++) {
            const long done = st->counts.done[stage] - before.done[stage];
            const long skipped = st->counts.skipped[stage] - before.skipped[stage];
            mt_test_row(t, "%s, %s", rows[i].what, mt_stage_name((mt_stage_id)stage));
            CHECK_INT(t, done, rows[i].done[stage]);
            CHECK_INT(t, done + skipped, stage == MT_STAGE_TANGENT ? done + skipped : 1);
        }
    }
}

/* Geometry that no input moves: springs of a chain. */
static void stages__of_a_fixed_geometry_are_sums_alone(mt_test *t)
{
    static const want rows[] = {
        {"as it was", -1, false, {0, 0, 0, 0, 0, 0, 0}},
        {"gradient", -1, true, {1, 0, 0, 0, 0, 0, 0}},
        {"gradient again", -1, true, {0, 0, 0, 0, 0, 0, 0}},
        {"a spring", 0, false, {1, 0, 0, 0, 1, 0, 1}},
        {"another, with gradient", 1, true, {1, 0, 0, 0, 1, 0, 1}},
    };
    mech s;
    if (mech_must(t, mech_load(t, "six_masses"), NULL, "x2 x5", &s)) {
        check_counts(t, &s, rows, (int)(sizeof rows / sizeof *rows));
    }
    mech_free(&s);
}

/* a moves the joints, k is a spring, m_c a mass, by which pivots are chosen. */
static void stages__of_a_loop_follow_what_moves(mt_test *t)
{
    static const want rows[] = {
        {"as it was", -1, false, {0, 0, 0, 0, 0, 0, 0}},
        {"gradient", -1, true, {1, 0, 1, 0, 0, 0, 0}},
        {"gradient again", -1, true, {0, 0, 0, 0, 0, 0, 0}},
        {"a spring", 1, true, {1, 0, 0, 0, 1, 0, 1}},
        {"a mass", 2, true, {1, 0, 0, 1, 1, 1, 1}},
        {"a length", 0, false, {1, 1, 0, 1, 1, 1, 1}},
        {"a length, with gradient", 0, true, {1, 1, 1, 1, 1, 1, 1}},
    };
    mech s;
    if (mech_must(t, mech_load(t, "four_bar"), "still", "a k m_c", &s)) {
        check_counts(t, &s, rows, (int)(sizeof rows / sizeof *rows));
    }
    mech_free(&s);
}

/* An arm on a spring. */
static const char ARM[] =
    "{\"format\": \"modetune-model/1\", \"name\": \"arm\", \"dimension\": 2,"
    "\"parameters\": {\"a\": 0.3, \"k\": 20, \"m\": 2, \"b\": 0.1},"
    "\"bodies\": [{\"name\": \"arm\", \"mass_kg\": \"m\", \"inertia_kg_m2\": 0.01,"
    "\"centre\": [\"a\", 0]}],"
    "\"joints\": [{\"name\": \"pin\", \"type\": \"revolute\", \"bodies\": [\"ground\", "
    "\"arm\"],"
    "\"at\": [\"b\", 0]}],"
    "\"springs\": [{\"name\": \"coil\", \"type\": \"torsion\", \"joint\": \"pin\","
    "\"stiffness_n_m_per_rad\": \"k\"}],"
    "\"configurations\": {\"soft\": {}, \"stiff\": {\"parameters\": {\"k\": 80, \"m\": 1}},"
    "\"moved\": {\"parameters\": {\"b\": 0.2}},"
    "\"heavy\": {\"gravity_m_per_s2\": [0, -9.81]}}}";

typedef struct pair_want {
    const char *what;
    int moves[2]; /* input of each; -1: none */
    long done[2]; /* how often each made the geometry */
    long shared[2];
} pair_want;

/* One degree of freedom: omega^2 = k/(J + m (a - b)^2), of both, whoever made the geometry. */
static void stages__of_one_geometry_are_done_once(mt_test *t)
{
    static const pair_want rows[] = {
        {"as they were", {-1, -1}, {0, 0}, {0, 0}},
        {"a length", {0, 0}, {1, 0}, {0, 1}},
        {"a spring", {1, 1}, {0, 0}, {0, 0}},
        {"a length of the second", {-1, 0}, {0, 1}, {0, 0}},
        {"the first comes after", {0, -1}, {0, 0}, {1, 0}},
    };
    static const int parameters[] = {0, 1, 2};
    static const double at[] = {0.3, 20.0, 2.0};
    double x[2][3] = {{0.3, 20.0, 2.0}, {0.3, 20.0, 2.0}};
    mt_model *const model = mech_parse(t, ARM);
    mt_analysis *a[4] = {NULL};
    bool shared[4] = {false};
    for (int c = 0; c < 4; c++) {
        CHECK_INT(t, mt_analysis_new(model, c, 3, parameters, at, &a[c], NULL), MT_OK);
        if (c > 0) {
            CHECK_INT(t, mt_linear_share(a[c]->lin, a[0]->lin, &shared[c], NULL), MT_OK);
        }
    }
    CHECK(t, shared[1] && !shared[2] && !shared[3]);
    for (int i = 0; i < (int)(sizeof rows / sizeof *rows); i++) {
        mt_test_row(t, "%s", rows[i].what);
        for (int k = 0; k < 2; k++) {
            const mt_stage_counts *const now = &mt_linear_stages(a[k]->lin)->counts;
            const mt_stage_counts before = *now;
            const mt_analysis_options opt = mt_analysis_options_default();
            if (rows[i].moves[k] >= 0) {
                x[k][rows[i].moves[k]] *= 1.25;
            }
            CHECK_INT(t, mt_analysis_solve(a[k], x[k], &opt, NULL), MT_OK);
            const int g = MT_STAGE_GEOMETRY;
            CHECK_INT(t, now->done[g] - before.done[g], rows[i].done[k]);
            CHECK_INT(t, now->shared[g] - before.shared[g], rows[i].shared[k]);
            const double m = k == 0 ? x[k][2] : 1.0;
            const double arm = x[k][0] - 0.1;
            const double lambda = (k == 0 ? x[k][1] : 80.0) / (0.01 + (m * arm * arm));
            CHECK_NEAR_ABS(t, a[k]->modes.lambda[0], lambda, 1e-13 * lambda);
        }
    }
    for (int c = 0; c < 4; c++) {
        mt_analysis_delete(a[c]);
    }
    mt_model_delete(model);
}

/* The equilibrium moves with everything. */
static void stages__of_a_loaded_loop_stand_still_only_where_all_does(mt_test *t)
{
    static const want rows[] = {
        {"as it was", -1, false, {0, 0, 0, 0, 0, 0, 0}},
        {"gradient", -1, true, {1, 0, 1, 0, 0, 0, 0}},
        {"a spring", 1, true, {1, 1, 1, 1, 1, 1, 1}},
        {"a mass", 2, false, {1, 1, 0, 1, 1, 1, 1}},
    };
    mech s;
    if (mech_must(t, mech_load(t, "four_bar"), "loaded", "a k m_c", &s)) {
        check_counts(t, &s, rows, (int)(sizeof rows / sizeof *rows));
    }
    mech_free(&s);
}

/* What evaluators did is added where somebody asks, when they go. */
static double one_second(void)
{
    return 1.0;
}

static void stages__are_told_to_who_asks(mt_test *t)
{
    mech s;
    mt_profile profile;
    mt_profile_init(&profile, one_second);
    mt_model *const model = mech_load(t, "six_masses");
    if (model == NULL) {
        return;
    }
    if (mech_must(t, model, NULL, "x2 x5", &s)) {
        const mt_analysis_options opt = mt_analysis_options_default();
        const mt_run run = {.profile = &profile};
        const mt_system_def def = {.model = model,
                                   .run = &run,
                                   .n_inputs = s.n,
                                   .inputs = s.a->sys->inputs,
                                   .at = s.at};
        mt_analysis *a = NULL;
        CHECK_INT(t, mt_analysis_new_of(&def, 0, &a, NULL), MT_OK);
        CHECK_INT(t, mt_analysis_solve(a, s.at, &opt, NULL), MT_OK);
        mt_analysis_delete(a);
    }
    mech_free(&s);
    for (int stage = 0; stage < MT_STAGES; stage++) {
        const bool none = stage == MT_STAGE_TANGENT;
        mt_test_row(t, "%s", mt_stage_name((mt_stage_id)stage));
        const bool twice = stage == MT_STAGE_MODES; /* the count was open the first time */
        CHECK_INT(t, atomic_load(&profile.done[stage]), none ? 0 : 1 + (int)twice);
        CHECK_INT(t, atomic_load(&profile.skipped[stage]), none || twice ? 0 : 1);
        CHECK_INT(t, atomic_load(&profile.nanoseconds[stage]), 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        MT_TEST(stages__leave_the_same_bits_whatever_was_seen_before),
        MT_TEST(stages__that_are_shared_leave_the_same_bits),
        MT_TEST(stages__of_one_geometry_are_done_once),
        MT_TEST(stages__of_a_fixed_geometry_are_sums_alone),
        MT_TEST(stages__of_a_loop_follow_what_moves),
        MT_TEST(stages__of_a_loaded_loop_stand_still_only_where_all_does),
        MT_TEST(stages__are_told_to_who_asks),
    };
    return cmocka_run_group_tests_name(__FILE__, tests, NULL, NULL) != 0;
}
