/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Where a length is held at samples, the gap assignments that the other variables can have are
 * all found: levers between masses clear of bands drawn at random. Each that is listed comes
 * with a design that has it, and no design drawn at random at one of these lengths has another.
 */
#include "mt_writer.h"
#include "nlp/nlp.h"
#include "problem/evaluate.h"
#include "search/mode_placements.h"
#include "search/proof.h"
#include "study_fixture.h"
#include "support/mt_random.h"

enum { ROWS = 20, BANDS = 3, SLICES = 16, SAMPLES = 60, PLACE_L = 0 };

#define LEVER                                                                                \
    "{'format': 'modetune-model/1', 'name': 'lever and two masses', 'dimension': 2,"         \
    "'parameters': {'L': 0.2, 'k1': 4000, 'k2': 9000, 'k3': 2000, 'm1': 1, 'm2': 2},"        \
    "'bodies': [{'name': 'lever', 'mass_kg': 1, 'inertia_kg_m2': 0.05, 'centre': [0, 0]},"   \
    "{'name': 'a', 'mass_kg': 'm1', 'inertia_kg_m2': 1, 'centre': [1, 0]},"                  \
    "{'name': 'b', 'mass_kg': 'm2', 'centre': [2, 0]}],"                                     \
    "'joints': [{'name': 'hinge', 'type': 'revolute', 'bodies': ['ground', 'lever'],"        \
    "'at': [0, 0]}, {'name': 'ra', 'type': 'prismatic', 'bodies': ['ground', 'a'],"          \
    "'at': [1, 0], 'axis': [1, 0]}, {'name': 'rb', 'type': 'pin-in-slot', 'bodies': "        \
    "['ground', 'b'], 'at': [2, 0], 'axis': [1, 0]}],"                                       \
    "'springs': [{'name': 'twist', 'type': 'torsion', 'bodies': ['ground', 'lever'],"        \
    "'stiffness_n_m_per_rad': 100%s}, {'name': 's1', 'type': 'axial', 'bodies': ['lever',"   \
    "'a'], 'at': [[0, 'L'], [1, 'L']], 'stiffness_n_per_m': 'k1'},"                          \
    "{'name': 's2', 'type': 'axial', 'bodies': ['a', 'b'], 'at': [[1, 0], [2, 0]],"          \
    "'stiffness_n_per_m': 'k2'}, {'name': 's3', 'type': 'axial', 'bodies': ['b', 'ground']," \
    "'at': [[2, 0], [3, 0]], 'stiffness_n_per_m': 'k3'}], 'configurations': {'one': {}}}"

typedef struct rig {
    study_case c;
    mt_arena mem;
    mt_problem *p;
    mt_workspace *w;
} rig;

static bool open_rig(mt_test *t, const char *more, const char *members, rig *r)
{
    char model[2048];
    *r = (rig){0};
    (void)snprintf(model, sizeof model, LEVER, more);
    return CHECK_INT(t, mt_arena_init(&r->mem, 0, NULL), MT_OK) &&
           study_load(t, model, members, &r->c) &&
           CHECK_INT(t, mt_problem_new(r->c.study, NULL, &r->p, &r->c.err), MT_OK) &&
           CHECK_INT(t, mt_workspace_new(r->p, &r->w, &r->c.err), MT_OK) &&
           CHECK_INT(t, mt_workspace_use(r->w, &r->p->whole, &r->c.err), MT_OK);
}

static void close_rig(rig *r)
{
    mt_workspace_delete(r->w);
    mt_problem_delete(r->p);
    mt_arena_free(&r->mem);
    study_free(&r->c);
}

static void draw(mt_random *r, mt_writer *w)
{
    double at = mt_random_in(r, 3.0, 8.0);
    mt_write(
        w, "'variables': [{'parameter': 'L', 'lower': 0.05, 'upper': 0.6}, {'parameter': 'k1', "
           "'lower': 1000, 'upper': 16000}, {'parameter': 'm2', 'lower': 0.5, 'upper': 4}],"
           "'goals': [{'type': 'avoid', 'bands_hz': [");
    for (int i = 0; i < BANDS; i++) {
        const double upper = at * mt_random_in(r, 1.1, 1.6);
        mt_write(w, "%s[%.4f, %.4f]", i > 0 ? ", " : "", at, upper);
        at = upper * mt_random_in(r, 1.02, 1.5);
    }
    mt_write(w, "]}]");
}

static bool is_listed(const mt_sampled_bounds *s, const int *below)
{
    for (int k = 0; k < s->n_found; k++) {
        if (memcmp(s->found + ((ptrdiff_t)k * BANDS), below, BANDS * sizeof *below) == 0) {
            return true;
        }
    }
    return false;
}

static void each_has_its_design(mt_test *t, rig *r, const mt_sampled_bounds *s)
{
    for (int k = 0; k < s->n_found; k++) {
        int below[BANDS];
        double violation = 1.0;
        CHECK_INT(t,
                  mt_mode_placement_assignment(r->w, s->at + ((ptrdiff_t)k * r->p->n), below,
                                               &violation, &r->c.err),
                  MT_OK);
        CHECK(t, violation <= 1e-9);
        CHECK(t, memcmp(below, s->found + ((ptrdiff_t)k * BANDS), sizeof below) == 0);
    }
}

/* Designs at the slices' lengths that are clear; none of another kind. */
static int samples_hold(mt_test *t, rig *r, const mt_sampled_bounds *s)
{
    int avoidance = 0;
    mt_nlp nlp = mt_workspace_nlp(r->w);
    nlp.n = r->p->n;
    const double *const sampled_bounds =
        mt_nlp_starts(&nlp, r->w->c->search.seed, s->n, &r->mem);
    double *const x = mt_nlp_starts(&nlp, 7, s->n * SAMPLES, &r->mem);
    for (int k = 0; k < s->n * SAMPLES; k++) {
        double *const at = x + ((ptrdiff_t)k * r->p->n);
        int below[BANDS];
        double violation = 1.0;
        at[PLACE_L] = sampled_bounds[PLACE_L + ((ptrdiff_t)(k / SAMPLES) * r->p->n)];
        CHECK_INT(t, mt_mode_placement_assignment(r->w, at, below, &violation, &r->c.err),
                  MT_OK);
        if (violation <= 0.0) {
            avoidance++;
            CHECK(t, is_listed(s, below));
        }
    }
    return avoidance;
}

static void slices__list_what_designs_have_there(mt_test *t)
{
    const int fewer = getenv("MT_INSTRUMENTED") != NULL ? 4 : 1;
    const int rows = getenv("MT_EVERY") != NULL ? 20 * ROWS : ROWS / fewer;
    mt_random random = mt_random_seed(5);
    int avoidance = 0;
    int kinds = 0;
    for (int i = 0; i < rows; i++) {
        char members[1024];
        rig r;
        mt_sampled_bounds s;
        mt_test_row(t, "row %d", i);
        mt_writer w = {members, sizeof members, 0};
        draw(&random, &w);
        if (open_rig(t, "", members, &r) &&
            CHECK_INT(t, mt_sampled_bounds_search(r.w, &r.mem, &s, &r.c.err), MT_OK) &&
            CHECK_INT(t, s.n, SLICES) && CHECK_INT(t, s.n_settled, SLICES)) {
            each_has_its_design(t, &r, &s);
            avoidance += samples_hold(t, &r, &s);
            kinds += s.n_found;
        }
        close_rig(&r);
    }
    CHECK(t, avoidance > 100 * rows && kinds > 2 * rows); /* or it shows nothing */
}

/* None where nothing shapes the geometry, where more than that is in the way, and where no
 * proof is asked for. */
static void slices__there_are_none(mt_test *t)
{
#define BAND "'goals': [{'type': 'avoid', 'bands_hz': [[9, 10]]}]"
    static const struct {
        const char *more;
        const char *members;
    } rows[] = {
        {"", "'variables': [{'parameter': 'k1', 'lower': 1000, 'upper': 9000}]," BAND},
        {", 'preload_n_m': 'L'",
         "'variables': [{'parameter': 'L', 'lower': 0.1, 'upper': 0.5}]," BAND},
        {"", "'variables': [{'parameter': 'L', 'lower': 0.1, 'upper': 0.5}], 'search': "
             "{'proof_s': 0}," BAND},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        rig r;
        mt_sampled_bounds s = {.n = 1};
        mt_test_row(t, "row %d", i);
        if (open_rig(t, rows[i].more, rows[i].members, &r)) {
            CHECK_INT(t, mt_sampled_bounds_search(r.w, &r.mem, &s, &r.c.err), MT_OK);
            CHECK(t, s.n == 0 && s.n_found == 0);
        }
        close_rig(&r);
    }
}

MT_TEST_MAIN(MT_TEST(slices__list_what_designs_have_there), MT_TEST(slices__there_are_none))
