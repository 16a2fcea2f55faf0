/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How a study runs: the same bytes every time and for any number of workers, budgets,
 * interruption, shortage of memory, and the comparison with a fresh analysis. */
#include <gsl/gsl_errno.h>
#include <pthread.h>

#include "answer/solve.h"
#include "describe/describe.h"
#include "mt_alloc.h"
#include "result/write.h"
#include "study_fixture.h"

#define MODEL STUDY_TWO_MASSES("'k1': 2.9, 'k2': 1.05, 'm': 1", "")
#define SPRINGS                                                     \
    "'variables': [{'parameter': 'k1', 'lower': 0.5, 'upper': 10}," \
    " {'parameter': 'k2', 'lower': 0.5, 'upper': 10}],"
#define TARGETS                                             \
    "'references': {'test': {'modes': [{'frequency_hz': 1," \
    " 'shape': {'p1.x': 1, 'p2.x': 2}}]}},"                 \
    "'goals': [{'type': 'frequency', 'mode': 1,"            \
    " 'target_hz': 'sqrt((5 - sqrt(13))/2)/(2*pi)'},"       \
    "{'type': 'frequency', 'mode': 2,"                      \
    " 'target_hz': 'sqrt((5 + sqrt(13))/2)/(2*pi)'}]"

/* The result as its file would be; the caller frees it. NULL where solving failed. */
static char *answer(mt_test *t, const study_case *c, const mt_solve_options *opt)
{
    mt_result *result = NULL;
    mt_text text = {0};
    if (CHECK_INT(t, mt_study_solve(c->study, opt, &result, NULL), MT_OK)) {
        CHECK_INT(t, mt_result_write(result, &text, NULL), MT_OK);
    }
    mt_result_delete(result);
    return text.s;
}

static void same_study__gives_the_same_bytes_for_any_workers(mt_test *t)
{
    study_case c;
    if (study_load(t, MODEL, SPRINGS TARGETS ", 'search': {'seed': 7}", &c)) {
        char *const first = answer(t, &c, NULL);
        for (int threads = 1; threads <= 3; threads++) {
            mt_solve_options opt = {.size = sizeof opt};
            opt.threads = threads;
            mt_test_row(t, "%d workers", threads);
            char *const again = answer(t, &c, &opt);
            CHECK(t, first != NULL && again != NULL && strcmp(first, again) == 0);
            free(again);
        }
        free(first);
    }
    study_free(&c);
}

/* One of several runs of one study at once. */
typedef struct one_run {
    const mt_study *study;
    mt_progress progress;
    mt_profile profile;
    mt_status rc;
    mt_text text;
} one_run;

static double no_clock(void)
{
    return 0.0;
}

static void *answer_in_a_run(void *context)
{
    one_run *const o = context;
    mt_solve_options opt = {.size = sizeof opt};
    const mt_run run = {.progress = &o->progress, .profile = &o->profile};
    mt_result *result = NULL;
    opt.threads = 2;
    o->rc = mt_study_solve_with(o->study, &opt, &run, NULL, &result, NULL);
    o->rc = o->rc == MT_OK ? mt_result_write(result, &o->text, NULL) : o->rc;
    mt_result_delete(result);
    return NULL;
}

/* A study is only read: two threads answer it at once, each in a run of its own, which counts
 * its own work alone. (The thread sanitizer runs this, too.) */
static void const_study__is_answered_by_two_threads_at_once(mt_test *t)
{
    study_case c;
    if (study_load(t, MODEL, SPRINGS TARGETS ", 'search': {'seed': 7}", &c)) {
        char *const alone = answer(t, &c, NULL);
        one_run runs[2] = {{.study = c.study}, {.study = c.study}};
        pthread_t thread[MT_COUNT(runs)];
        for (int i = 0; i < MT_COUNT(runs); i++) {
            mt_profile_init(&runs[i].profile, no_clock);
            REQUIRE(t, mt_progress_init(&runs[i].progress, NULL) == MT_OK);
            REQUIRE(t, pthread_create(&thread[i], NULL, answer_in_a_run, &runs[i]) == 0);
        }
        for (int i = 0; i < MT_COUNT(runs); i++) {
            REQUIRE(t, pthread_join(thread[i], NULL) == 0);
        }
        const mt_progress_view first = mt_progress_read(&runs[0].progress);
        CHECK(t, first.evaluations > 0 && first.solutions > 0);
        for (int i = 0; i < MT_COUNT(runs); i++) {
            const mt_progress_view view = mt_progress_read(&runs[i].progress);
            mt_test_row(t, "run %d", i);
            CHECK_INT(t, runs[i].rc, MT_OK);
            CHECK(t, alone != NULL && runs[i].text.s != NULL &&
                         strcmp(alone, runs[i].text.s) == 0);
            CHECK(t, view.evaluations == first.evaluations);
            CHECK(t, view.solutions == first.solutions);
            CHECK(t, atomic_load(&runs[i].profile.done[MT_STAGE_MODES]) > 0);
            free(runs[i].text.s);
            mt_progress_free(&runs[i].progress);
        }
        free(alone);
    }
    study_free(&c);
}

static void spent_budget__is_said(mt_test *t)
{
    study_case c;
    if (study_solve(t, MODEL,
                    SPRINGS TARGETS ", 'search': {'starts': 4, 'max_evaluations': 12}", &c)) {
        CHECK(t,
              study_warns(
                  &c, "the budget of evaluations ran out (8 of 12 were made in the search)"));
        CHECK_INT(t, (int)c.result->run.spent.search, 8);
        CHECK_INT(t, (int)c.result->run.spent.descriptions,
                  2 + 2 * c.result->n_recommendations);
        CHECK_INT(t, (int)c.result->run.evaluations, 12);
    }
    study_free(&c);
}

/* Two objectives spend one budget. */
static void spent_budget__ends_the_list_of_objectives(mt_test *t)
{
    study_case c;
    if (study_solve(t, MODEL,
                    SPRINGS "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': 0.13}],"
                            "'objective': [{'minimise': 'change'}, {'minimise': 'k1'}],"
                            "'search': {'starts': 2, 'max_evaluations': 60}",
                    &c)) {
        CHECK(t, c.result->run.evaluations <= 60);
    }
    study_free(&c);
}

typedef struct interruption {
    int request;
    int calls;
} interruption;

static int wish_of(void *context)
{
    return ((interruption *)context)->request;
}

static void interrupt(void *context, const char *text)
{
    interruption *const i = context;
    i->calls++;
    i->request =
        text[0] != '\0' && i->calls > 1 ? MT_STOP_REQUEST_FINISH : MT_STOP_REQUEST_NONE;
}

/* The second progress line comes in the middle of the search, and stops it there. */
static void interruption__keeps_what_was_found(mt_test *t)
{
    study_case c;
    interruption i = {0, 0};
    if (study_load(t, MODEL, SPRINGS TARGETS ", 'search': {'starts': 300}", &c)) {
        mt_solve_options opt = {.size = sizeof opt};
        opt.stop = wish_of;
        opt.stop_context = &i;
        opt.progress = interrupt;
        opt.progress_context = &i;
        if (CHECK_INT(t, mt_study_solve(c.study, &opt, &c.result, NULL), MT_OK)) {
            CHECK_INT(t, i.calls, 2);
            CHECK_INT(t, c.result->status, MT_RESULT_INTERRUPTED);
            CHECK(t, c.result->n_recommendations >= 1);
            CHECK_NEAR(t, study_frequency(&c, 1, "default", 1),
                       study_hz(0.5 * (5.0 - sqrt(13.0))), 1e-6);
        }
    }
    study_free(&c);
}

static void stop_before_the_first_design__is_an_answer_too(mt_test *t)
{
    study_case c;
    interruption i = {MT_STOP_REQUEST_FINISH, 0};
    mt_err err = {.text = ""};
    if (study_load(t, MODEL, SPRINGS TARGETS, &c)) {
        mt_solve_options opt = {.size = sizeof opt};
        opt.stop = wish_of;
        opt.stop_context = &i;
        if (CHECK_INT(t, mt_study_solve(c.study, &opt, &c.result, NULL), MT_OK)) {
            CHECK_INT(t, c.result->status, MT_RESULT_INTERRUPTED);
            CHECK_INT(t, c.result->n_recommendations, 0);
            CHECK_NEAR(t, study_value(&c, 0, "k1"), 2.9, 0.0); /* the baseline is there */
        }
        mt_result *none = NULL;
        i.request = MT_STOP_REQUEST_END; /* and where it is not, there is no answer */
        CHECK_INT(t, mt_study_solve(c.study, &opt, &none, &err), MT_E_INTERRUPTED);
        CHECK(t, none == NULL && strstr(err.text, "before the original design") != NULL);
    }
    study_free(&c);
}

/* A search that says something else of a design than what comes out there is found out. */
static void fresh_analysis_that_differs__is_a_warning(mt_test *t)
{
    study_case c;
    mt_arena mem;
    mt_problem *p = NULL;
    mt_result *result = NULL;
    mt_recommendation rec;
    if (study_load(t, MODEL, SPRINGS TARGETS, &c) &&
        CHECK_INT(t, mt_arena_init(&mem, 0, NULL), MT_OK)) {
        CHECK_INT(t, mt_result_new(&result, NULL), MT_OK);
        if (CHECK_INT(t, mt_problem_new(c.study, NULL, &p, NULL), MT_OK)) {
            const double at[2] = {log(3.0), log(1.0)};
            const double d[2] = {log(3.0 / 2.9), log(1.0 / 1.05)};
            mt_nlp_solution found = {.f = 0.5 * ((d[0] * d[0]) + (d[1] * d[1]))};
            const mt_design design = {.t = at, .found = &found, .rank = 1};
            CHECK_INT(t, mt_describe_design(p, &design, NULL, result, &rec, NULL), MT_OK);
            CHECK_INT(t, result->n_warnings, 0);
            found.f *= 1.0 + 1e-5;
            CHECK_INT(t, mt_describe_design(p, &design, NULL, result, &rec, NULL), MT_OK);
            if (CHECK_INT(t, result->n_warnings, 1)) {
                CHECK(t, strstr(result->warnings[0], "recomputed it is") != NULL);
            }
        }
        mt_problem_delete(p);
        mt_result_delete(result);
        mt_arena_free(&mem);
    }
    study_free(&c);
}

/* A result may outlive its study. Freed memory is poisoned under AddressSanitizer, and
 * overwritten here in any build. */
static void result__owns_its_texts(mt_test *t)
{
    study_case c;
    mt_text text = {0};
    if (study_solve(t, MODEL,
                    SPRINGS TARGETS ", 'published': [{'parameter': 'k1', 'value': 3,"
                                    " 'tolerance': 1, 'source': 'nowhere'}]",
                    &c)) {
        char *const before = answer(t, &c, NULL);
        mt_study_delete(c.study);
        c.study = NULL;
        CHECK_INT(t, mt_result_write(c.result, &text, NULL), MT_OK);
        CHECK(t, before != NULL && text.s != NULL && strcmp(before, text.s) == 0);
        free(before);
    }
    mt_text_free(&text);
    study_free(&c);
}

/* What a program that uses the library may have GSL do; by default it ends the process. */
static int complaints;
static void complain(const char *reason, const char *file, int line, int code)
{
    (void)reason;
    (void)file;
    (void)line;
    (void)code;
    complaints++;
}

/* Every allocation fails in turn (from the thousandth on, every 37th): solving gives the answer
 * or says that memory is out, and gives everything back; GSL's error handler, which is the
 * whole process's, is neither called nor another one afterwards. */
static void shortage_of_memory__is_reported_and_leaks_nothing(mt_test *t)
{
    study_case c;
    enum { EACH = 1000, STRIDE = 37 };
    if (!mt_alloc_works()) {
        CHECK(t, true); /* another allocator is in place: nothing can be failed */
        return;
    }
    if (study_load(t, MODEL,
                   SPRINGS TARGETS ", 'search': {'starts': 2}, 'published':"
                                   " [{'mac': {'mode': 1, 'reference': 'test'},"
                                   " 'at_least': 0.1}, {'status': 'solved'}]",
                   &c)) {
        free(answer(t, &c, NULL)); /* libraries that allocate once have done so */
        const long before = mt_alloc_live();
        gsl_error_handler_t *const theirs = gsl_set_error_handler(complain);
        for (long nth = 0;; nth += nth < EACH ? 1 : STRIDE) {
            mt_result *result = NULL;
            mt_err err = {.text = ""};
            mt_alloc_fail_after(nth);
            const mt_status rc = mt_study_solve(c.study, NULL, &result, &err);
            mt_alloc_fail_after(-1);
            mt_test_row(t, "allocation %ld", nth);
            if (rc == MT_OK) {
                CHECK_INT(t, result->status, MT_RESULT_SOLVED);
                CHECK_INT(t, result->n_recommendations, 2);
            } else {
                CHECK_INT(t, rc, MT_E_MEMORY);
                CHECK(t, result == NULL);
            }
            mt_result_delete(result);
            CHECK_INT(t, mt_alloc_live(), before);
            if (rc == MT_OK || !mt_test_passed(t)) {
                break;
            }
        }
        CHECK(t, gsl_set_error_handler(theirs) == complain);
        CHECK_INT(t, complaints, 0);
    }
    study_free(&c);
}

MT_TEST_MAIN(MT_TEST(same_study__gives_the_same_bytes_for_any_workers),
             MT_TEST(const_study__is_answered_by_two_threads_at_once),
             MT_TEST(spent_budget__is_said), MT_TEST(spent_budget__ends_the_list_of_objectives),
             MT_TEST(interruption__keeps_what_was_found),
             MT_TEST(stop_before_the_first_design__is_an_answer_too),
             MT_TEST(fresh_analysis_that_differs__is_a_warning),
             MT_TEST(result__owns_its_texts),
             MT_TEST(shortage_of_memory__is_reported_and_leaks_nothing))
