/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What is met early is searched before the proof, which changes nothing of the answer: kinds of
 * design of the row of six masses clear of bands drawn at random, against designs drawn at
 * random, for proofs that end and proofs that do not, for one worker and for several; and who
 * interrupts the proof has a design.
 */
#include "nlp/nlp.h"
#include "problem/evaluate.h"
#include "prove/certify.h"
#include "search/mode_placements.h"
#include "study_fixture.h"
#include "support/mt_random.h"

enum { WORKERS = 2, BANDS = 7, SAMPLES = 1000, PLACES = 2 };
static const double SAME = 1e-6;
/* More than what comes before the first search, and less than these proofs take. */
static const double LITTLE = 3e8;

typedef struct row {
    study_case c;
    mt_arena mem;
    mt_problem *p;
    mt_workspace *workers[WORKERS];
} row;

/* Bands of 4 to 9 % over the range of the modes of the row. */
static bool open_row(mt_test *t, mt_random *r, row *s)
{
    char bands[512] = "";
    char members[1024];
    double at = 5.0;
    size_t used = 0;
    bool good = true;
    *s = (row){0};
    for (int i = 0; i < BANDS; i++) {
        const double lower = at * mt_random_in(r, 1.0, 1.1);
        const double upper = lower * mt_random_in(r, 1.04, 1.09);
        used += (size_t)snprintf(bands + used, sizeof bands - used, "%s[%.4f, %.4f]",
                                 i > 0 ? ", " : "", lower, upper);
        at *= 1.3;
    }
    (void)snprintf(members, sizeof members,
                   "'variables': [{'parameter': 'x1', 'lower': -0.65, 'upper': 0.65},"
                   "{'parameter': 'x2', 'lower': -0.65, 'upper': 0.65},"
                   "{'parameter': 'x3', 'lower': -0.65, 'upper': 0.65},"
                   "{'parameter': 'x4', 'lower': -0.65, 'upper': 0.65},"
                   "{'parameter': 'x5', 'lower': -0.65, 'upper': 0.65},"
                   "{'parameter': 'x6', 'lower': -0.65, 'upper': 0.65}],"
                   "'goals': [{'type': 'avoid', 'bands_hz': [%s]}], 'search': {'starts': 3},"
                   "'recommendations': 1000",
                   bands);
    good = CHECK_INT(t, mt_arena_init(&s->mem, 0, NULL), MT_OK) &&
           study_load(t, "six_masses", members, &s->c) &&
           CHECK_INT(t, mt_problem_new(s->c.study, NULL, &s->p, &s->c.err), MT_OK);
    for (int i = 0; i < WORKERS && good; i++) {
        good = CHECK_INT(t, mt_workspace_new(s->p, &s->workers[i], &s->c.err), MT_OK);
    }
    return good;
}

static void close_row(row *s)
{
    for (int i = 0; i < WORKERS; i++) {
        mt_workspace_delete(s->workers[i]);
    }
    mt_problem_delete(s->p);
    mt_arena_free(&s->mem);
    study_free(&s->c);
}

static void solve(mt_test *t, row *s, int workers, double work, mt_mode_placement_result *out)
{
    mt_subproblem *const c = mt_arena_alloc(&s->mem, 1, sizeof *c);
    *c = s->p->whole;
    c->proof_work = work;
    for (int i = 0; i < workers; i++) {
        CHECK_INT(t, mt_workspace_use(s->workers[i], c, &s->c.err), MT_OK);
    }
    CHECK_INT(t, mt_mode_placements_solve(s->workers, workers, NULL, &s->mem, out, &s->c.err),
              MT_OK);
}

static const mt_mode_placement_solution *kind_of(const mt_mode_placement_result *g,
                                                 const int *below)
{
    for (int i = 0; i < g->n_solutions && !g->compromise; i++) {
        if (memcmp(g->solutions[i].below, below, BANDS * sizeof *below) == 0) {
            return &g->solutions[i];
        }
    }
    return NULL;
}

/* A design that is clear is of one of the kinds, and no better than the best of it; how many
 * were. */
static int samples_hold(mt_test *t, row *s, const mt_mode_placement_result *g)
{
    mt_workspace *const w = s->workers[0];
    mt_nlp nlp = mt_workspace_nlp(w);
    mt_nlp_values v;
    int below[BANDS];
    int avoidance = 0;
    nlp.n = s->p->n;
    const double *const x = mt_nlp_starts(&nlp, 5, SAMPLES, &s->mem);
    CHECK_INT(t, mt_subproblem_values_init(w->c, &s->mem, &v, &s->c.err), MT_OK);
    for (int k = 0; k < SAMPLES; k++) {
        const double *const at = x + ((ptrdiff_t)k * s->p->n);
        double violation = 0.0;
        CHECK_INT(t, mt_mode_placement_assignment(w, at, below, &violation, &s->c.err), MT_OK);
        if (violation > 0.0) {
            continue;
        }
        const mt_mode_placement_solution *const kind = kind_of(g, below);
        avoidance++;
        CHECK_INT(t, mt_workspace_eval(w, at, false, &v, &s->c.err), MT_OK);
        if (CHECK(t, kind != NULL)) {
            CHECK(t, kind->found->f <= v.f + (SAME * (1.0 + v.f)));
        }
    }
    return avoidance;
}

/* To the byte. */
static void same(mt_test *t, const row *s, const mt_mode_placement_result *a,
                 const mt_mode_placement_result *b)
{
    CHECK_INT(t, a->n_solutions, b->n_solutions);
    CHECK(t, a->evals == b->evals && a->boxes == b->boxes);
    for (int i = 0; i < a->n_solutions && i < b->n_solutions; i++) {
        CHECK(t, memcmp(a->solutions[i].found->t, b->solutions[i].found->t,
                        (size_t)s->p->n * sizeof(double)) == 0);
    }
}

static void kinds__are_those_of_samples(mt_test *t)
{
    const int count = getenv("MT_EVERY") != NULL ? 6 : 1; /* one is a second */
    mt_random r = mt_random_seed(11);
    int avoidance = 0;
    int shorter = 0;
    for (int k = 0; k < count; k++) {
        row s;
        mt_mode_placement_result all;
        mt_mode_placement_result few;
        mt_mode_placement_result many;
        mt_test_row(t, "row %d", k);
        if (open_row(t, &r, &s)) {
            solve(t, &s, 1, LITTLE, &few);
            solve(t, &s, WORKERS, LITTLE, &many);
            same(t, &s, &few, &many);
            solve(t, &s, 1, MT_CERTIFY_WORK, &all);
            CHECK(t, all.proven && few.boxes <= all.boxes);
            shorter += few.boxes < all.boxes ? 1 : 0;
            CHECK(t, few.compromise || few.n_solutions <= all.n_solutions);
            for (int i = 0; i < few.n_solutions && !few.compromise; i++) {
                const mt_mode_placement_solution *const a =
                    kind_of(&all, few.solutions[i].below);
                if (CHECK(t, a != NULL)) {
                    CHECK_NEAR(t, few.solutions[i].found->f, a->found->f, SAME);
                }
            }
            avoidance += samples_hold(t, &s, &all);
        }
        close_row(&s);
    }
    CHECK(t, avoidance > 0 && shorter > 0);
}

/* Answers yes from a question on. */
typedef struct moment {
    long asked;
    long at;
} moment;

static int request(void *context)
{
    moment *const m = context;
    m->asked++;
    return m->at > 0 && m->asked >= m->at ? MT_STOP_REQUEST_FINISH : MT_STOP_REQUEST_NONE;
}

/* More than half of the questions whether to stop are those of the proof's boxes. */
static void an_interrupt__finds_a_design(mt_test *t)
{
    mt_random r = mt_random_seed(11);
    row s;
    if (open_row(t, &r, &s)) {
        moment m = {0};
        mt_solve_options opt = {.size = sizeof opt, .stop = request, .stop_context = &m};
        mt_result *whole = NULL;
        CHECK_INT(t, mt_study_solve(s.c.study, &opt, &whole, &s.c.err), MT_OK);
        const long questions = m.asked;
        const int places =
            getenv("MT_EVERY") != NULL && getenv("MT_INSTRUMENTED") == NULL ? PLACES : 1;
        for (int i = 0; i < places && whole != NULL; i++) {
            mt_result *out = NULL;
            m = (moment){.at = questions * (i + 2) / (PLACES + 2)};
            mt_test_row(t, "question %ld of %ld", m.at, questions);
            if (CHECK_INT(t, mt_study_solve(s.c.study, &opt, &out, &s.c.err), MT_OK)) {
                CHECK_INT(t, out->status, MT_RESULT_INTERRUPTED);
                CHECK(t, out->n_recommendations > 0 && out->recommendations[0].feasible);
            }
            mt_result_delete(out);
        }
        mt_result_delete(whole);
    }
    close_row(&s);
}

MT_TEST_MAIN(MT_TEST(an_interrupt__finds_a_design), MT_TEST(kinds__are_those_of_samples))
