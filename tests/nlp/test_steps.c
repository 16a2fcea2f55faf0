/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How a search came to its answer: the steps themselves, on tape, and of a search whose minimum
 * is known. */
#include <math.h>

#include "nlp_problem.h"

static mt_step step(long evals, double f, double violation)
{
    return (mt_step){.evals = evals, .f = f, .violation = violation, .squares = violation};
}

static void steps__keep_what_is_better_alone(mt_test *t)
{
    mt_arena mem;
    CHECK(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    mt_steps s = mt_steps_new(8, &mem);
    const mt_step all[] = {step(1, 9.0, 4.0),        step(2, 1.0, 5.0), step(3, 9.5, 3.0),
                           step(4, 8.0, 0.5),        step(5, 8.5, 0.0), step(6, 7.0, 2.0),
                           step(7, 8.0 - 1e-9, 0.0), step(8, 7.5, 1.0)};
    for (int i = 0; i < MT_COUNT(all); i++) {
        mt_steps_add(&s, &all[i]);
    }
    static const long kept[] = {1, 3, 4, 8};
    CHECK(t, s.n == MT_COUNT(kept));
    for (int i = 0; i < s.n && i < MT_COUNT(kept); i++) {
        CHECK_INT(t, s.at[i].evals, kept[i]);
    }
    mt_step end = step(20, 7.5, 0.0);
    mt_steps_settle(&s, &end); /* the same */
    CHECK(t, s.n == 5 && s.at[4].round == 0 && s.at[4].evals == 20);
    end.f = 7.6;
    mt_steps_settle(&s, &end); /* did not hold */
    CHECK(t, s.n == 6 && s.at[5].round == 1);
    mt_arena_free(&mem);
}

/* However many there are: the first, the last, in order, and better and better. */
static void steps__are_thinned_between_their_ends(mt_test *t)
{
    for (int n = 1; n <= 300; n += 13) {
        mt_arena mem;
        CHECK(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
        mt_steps s = mt_steps_new(MT_STEPS_OF_TASK, &mem);
        for (int i = 0; i < n; i++) {
            const mt_step one = step(i + 1, (double)(n - i), 0.0);
            mt_steps_add(&s, &one);
        }
        CHECK(t, s.n <= MT_STEPS_OF_TASK && s.n >= (n < 8 ? n : 8));
        CHECK(t, s.at[0].evals == 1 && s.at[s.n - 1].evals == n);
        for (int i = 1; i < s.n; i++) {
            CHECK(t, s.at[i].evals > s.at[i - 1].evals && s.at[i].f < s.at[i - 1].f);
        }
        mt_arena_free(&mem);
    }
}

/* Each kind once: there is always room for the next. */
static void steps__of_more_kinds_than_there_is_room_for(mt_test *t)
{
    mt_arena mem;
    CHECK(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    mt_steps s = mt_steps_new(8, &mem);
    for (int i = 0; i < 50; i++) {
        mt_step one = step(i + 1, 1.0, 0.0);
        one.stage = i;
        mt_steps_add(&s, &one);
        CHECK(t, s.n <= 8 && s.at[s.n - 1].stage == i);
    }
    mt_arena_free(&mem);
}

static void steps__come_back_from_tape_as_they_were(mt_test *t)
{
    mt_arena mem;
    CHECK(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    mt_steps s = mt_steps_new(8, &mem);
    const mt_step one = step(3, 0x1.23456789abcdep-7, HUGE_VAL);
    const mt_step two = step(7, -0.0, 0.25);
    mt_steps_add(&s, &one);
    mt_steps_add(&s, &two);
    mt_serializer written = {.words = NULL};
    mt_steps_serialize(&s, &written);
    for (size_t cut = 0; cut <= written.n; cut++) {
        mt_serializer read = mt_serializer_of(written.words, cut);
        mt_steps got = mt_steps_new(8, &mem);
        mt_steps_serialize(&got, &read);
        const bool whole = cut == written.n;
        CHECK(t, mt_serializer_is_read(&read) == whole && got.n == (whole ? 2 : 0));
        CHECK(t, !whole || same_bytes(got.at, s.at, 2 * sizeof *s.at));
    }
    mt_serializer few = mt_serializer_of(written.words, written.n);
    mt_steps none = mt_steps_new(8, &mem);
    none.most = 1; /* more than there is room for is no record */
    mt_steps_serialize(&none, &few);
    CHECK(t, few.failed && none.n == 0);
    mt_serializer_free(&written);
    mt_arena_free(&mem);
}

/* Least t0^2 + t1^2 with t0 t1 >= 1: f = 2 at (1, 1) and (-1, -1). */
static void hyperbola(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    (void)c;
    out->f = t[0] * t[0] + t[1] * t[1];
    out->df[0] = 2.0 * t[0];
    out->df[1] = 2.0 * t[1];
    out->in[0] = t[0] * t[1] - 1.0;
    out->din[0] = t[1];
    out->din[1] = t[0];
}

static void steps__of_a_search_lead_to_its_best_design(mt_test *t)
{
    nlp_case c = {.calls = 0};
    mt_nlp_options opt = mt_nlp_options_default();
    opt.starts = 12;
    opt.least_change = false;
    mt_step first[MT_STEPS_MOST] = {{.evals = 0}};
    int n = 0;
    for (int workers = 1; workers <= 4; workers++) {
        void *contexts[] = {&c, &c, &c, &c};
        case_begin(&c, 2, hyperbola, -5.0, 5.0);
        c.origin[0] = 4.0;
        c.origin[1] = 3.0;
        c.nlp.n_in = 1;
        c.nlp.n_workers = workers;
        c.nlp.contexts = contexts;
        CHECK(t, case_solve(&c, &opt) == MT_OK && c.result.n_solutions > 0);
        const mt_steps *const s = &c.result.steps;
        CHECK(t, s->n > 1 && s->n <= MT_STEPS_MOST);
        CHECK(t, s->at[0].evals == 1 && s->at[0].f == 25.0); /* the original design */
        CHECK_NEAR(t, s->at[s->n - 1].f, 2.0, 1e-5);
        CHECK(t, s->at[s->n - 1].evals <= c.result.evals && s->at[s->n - 1].violation <= 1.0);
        if (workers == 1) {
            n = s->n;
            memcpy(first, s->at, (size_t)n * sizeof *first);
        }
        CHECK(t, s->n == n && same_bytes(first, s->at, (size_t)n * sizeof *first));
    }
    mt_arena_free(&c.mem);
}

MT_TEST_MAIN(MT_TEST(steps__keep_what_is_better_alone),
             MT_TEST(steps__are_thinned_between_their_ends),
             MT_TEST(steps__of_more_kinds_than_there_is_room_for),
             MT_TEST(steps__come_back_from_tape_as_they_were),
             MT_TEST(steps__of_a_search_lead_to_its_best_design))
