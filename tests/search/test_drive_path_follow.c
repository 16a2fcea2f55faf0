/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A drive followed from its first to its last position, in closed form: a mass on an arm, k1
 * along the arm, k2 across the ground, has (2 pi f)^2 m = k1 + k2 cos(theta)^2, which is
 * highest at theta = 0.
 */
#include "mt_writer.h"
#include "problem/evaluate.h"
#include "problem/problem.h"
#include "problem/workspace.h"
#include "search/drive_path.h"
#include "study_fixture.h"

enum { TEXT = 4096, MOST = 4 };

static const double M = 2.0;
static const double K1 = 20000.0;
static const double K2 = 5000.0;
static const double EDGE_HZ = 20.0; /* above all frequencies */

static double hz_at(double theta)
{
    return study_hz((K1 + (K2 * cos(theta) * cos(theta))) / M);
}

static void put_model(const double *at, int n, mt_writer *w)
{
    mt_write(
        w,
        "{'format': 'modetune-model/1', 'dimension': 2, 'parameters': {'k1': 20000}, 'bodies': "
        "[{'name': 'arm', 'mass_kg': 1, 'inertia_kg_m2': 0.1, 'centre': [0.5, 0]}, {'name': "
        "'slider', 'mass_kg': 2, 'inertia_kg_m2': 0.01, 'centre': [1, 0]}], 'joints': "
        "[{'name': "
        "'pivot', 'type': 'revolute', 'bodies': ['ground', 'arm'], 'at': [0, 0]}, {'name': "
        "'slide', 'type': 'prismatic', 'bodies': ['arm', 'slider'], 'at': [1, 0], 'axis': [1, "
        "0]}], 'springs': [{'name': 'along', 'type': 'bushing', 'bodies': ['arm', 'slider'], "
        "'at': [1, 0], 'stiffness_n_per_m': ['k1', 0], 'stiffness_n_m_per_rad': 0}, {'name': "
        "'across', 'type': 'bushing', 'bodies': ['ground', 'slider'], 'at': [1, 0], "
        "'stiffness_n_per_m': [5000, 0], 'stiffness_n_m_per_rad': 0}], 'configurations': {");
    for (int i = 0; i < n; i++) {
        mt_write(w,
                 "%s'p%d': {'drive': {'joint': 'pivot', 'position_rad': %.17g, 'hold': "
                 "'lock'}}",
                 i == 0 ? "" : ", ", i, at[i]);
    }
    mt_write(w, "}}");
}

static const struct {
    int n;
    double at[MOST]; /* in any order, some of them twice */
    double from;
    double to;
    double nearest; /* to theta = 0 on the way */
} rows[] = {
    {2, {0.1, 1.3}, 0.1, 1.3, 0.1},          {2, {1.3, 0.1}, 0.1, 1.3, 0.1},
    {2, {-0.6, 0.9}, -0.6, 0.9, 0.0},        {3, {0.2, -0.4, 0.9}, -0.4, 0.9, 0.0},
    {3, {0.9, 0.5, 0.7}, 0.5, 0.9, 0.5},     {4, {-0.9, -0.3, -1.2, -0.3}, -1.2, -0.3, 0.3},
    {4, {0.3, 0.9, 0.9, 0.4}, 0.3, 0.9, 0.3}};

static void follow__goes_from_the_first_position_to_the_last(mt_test *t)
{
    for (int i = 0; i < MT_COUNT(rows); i++) {
        char model[TEXT];
        study_case c;
        mt_arena mem = {0};
        mt_problem *p = NULL;
        mt_workspace *w = NULL;
        mt_err err = {.text = ""};
        static const char *const names[] = {"", "", "'p0', 'p1'", "'p0', 'p1', 'p2'",
                                            "'p0', 'p1', 'p2', 'p3'"};
        char members[512];
        mt_test_row(t, "row %d", i);
        mt_writer text = {model, sizeof model, 0};
        put_model(rows[i].at, rows[i].n, &text);
        (void)snprintf(members, sizeof members,
                       "'variables': [{'parameter': 'k1', 'lower': 1000, 'upper': 50000}], "
                       "'goals': [{'type': 'avoid', 'configurations': [%s], 'bands_hz': [[20, "
                       "25]], 'margin_percent': 0}]",
                       names[rows[i].n]);
        if (CHECK_INT(t, mt_arena_init(&mem, 0, NULL), MT_OK) &&
            study_load(t, model, members, &c) &&
            CHECK_INT(t, mt_problem_new(c.study, NULL, &p, &err), MT_OK) &&
            CHECK_INT(t, mt_workspace_new(p, &w, &err), MT_OK) &&
            CHECK_INT(t, p->n_families, 1)) {
            static const int below[2 * MOST] = {1, 1, 1, 1, 1, 1, 1, 1};
            const double at = mt_problem_t(p, 0, K1);
            mt_drive_path m;
            CHECK_INT(t, mt_workspace_place(w, &at, false, &err), MT_OK);
            for (int v = 0; v < w->n_views; v++) {
                CHECK_INT(t, mt_configuration_solve(w, &w->views[v], false, &err), MT_OK);
            }
            if (CHECK_INT(t, mt_drive_path_follow(w, 0, below, &mem, &m, &err), MT_OK)) {
                CHECK_NEAR(t, m.from, rows[i].from, 1e-12);
                CHECK_NEAR(t, m.to, rows[i].to, 1e-12);
                CHECK_NEAR(t, m.room, log(EDGE_HZ / hz_at(rows[i].nearest)), 1e-5);
                CHECK(t, m.positions >= 2);
            }
        }
        mt_workspace_delete(w);
        mt_problem_delete(p);
        study_free(&c);
        mt_arena_free(&mem);
    }
}

/* A band that the mode comes into within the bounds of k1, wherever it stands, and is above all
 * of from where k1 makes it so at theta = 0.9. The bound may move so far; an edge is of one
 * position, which says nothing of what is between. */
static void follow__bounds_move_by_what_the_whole_way_asks(mt_test *t)
{
    static const double at[] = {-0.6, 0.9};
    static const double above = 23000.0;
    static const double below_hz = 16.0;
    char model[TEXT];
    char members[512];
    study_case c;
    const double cosine = cos(0.9);
    const double above_hz = study_hz((above + (K2 * cosine * cosine)) / M);
    double to = nan("");
    mt_writer w = {model, sizeof model, 0};
    put_model(at, 2, &w);
    (void)snprintf(
        members, sizeof members,
        "'variables': [{'parameter': 'k1', 'lower': 19000, 'upper': 21000}], 'goals': "
        "[{'type': 'avoid', 'configurations': ['p0', 'p1'], 'bands_hz': [[%.17g, "
        "%.17g]], 'margin_percent': 0}]",
        below_hz, above_hz);
    if (study_solve(t, model, members, &c)) {
        CHECK(t, c.result->status != MT_RESULT_SOLVED);
        for (int i = 0; i < c.result->n_relaxations; i++) {
            const mt_relaxation *const r = &c.result->relaxations[i];
            to = strstr(r->what, "upper bound of k1") != NULL ? r->to : to;
            CHECK(t, strstr(r->what, "edge") == NULL);
        }
        CHECK_NEAR(t, to, above, 1e-5);
    }
    study_free(&c);
}

MT_TEST_MAIN(MT_TEST(follow__bounds_move_by_what_the_whole_way_asks),
             MT_TEST(follow__goes_from_the_first_position_to_the_last))
