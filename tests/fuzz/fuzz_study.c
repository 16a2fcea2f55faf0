/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Any bytes as a study, the whole way: file, one evaluation with gradient, a search on a tiny
 * budget, the result as JSON, tables, text and page, and the JSON read back. Behind a NUL may
 * stand the study's own model, which it calls "model.json"; the shipped models are where the
 * shipped studies look for them.
 */
#include <math.h>
#include <signal.h>
#include <string.h>
#include <sys/time.h>

#include "common/fuzz.h"
#include "io/options.h"
#include "linalg/dense.h"
#include "problem/evaluate.h"
#include "problem/workspace.h"
#include "report/page.h"
#include "report/summary.h"
#include "result/read.h"
#include "result/result.h"
#include "result/write.h"
#include "study/read.h"
#include "study/study.h"

enum {
    MOST_VARIABLES = 6,
    MOST_GOALS = 12,
    MOST_PARTS = 40,
    MOST_ELEMENTS = 12,
    MOST_POINTS = 4,
    EVALUATIONS = 25,
    MICROSECONDS = 40000 /* of CPU time, then the search is told to stop, wherever it is */
};

static volatile sig_atomic_t stop;

static int request(void *unused)
{
    (void)unused;
    return stop != 0 ? MT_STOP_REQUEST_FINISH : MT_STOP_REQUEST_NONE;
}

static void tell_to_stop(int signal_number)
{
    (void)signal_number;
    stop = 1;
}

static void hear_progress(void *context, const char *text)
{
    (void)context;
    DEMAND(text != NULL && text[0] != '\0');
}

/* libFuzzer has the other clock. The handler stays: signal() would take it away with the first
 * alarm, and one that comes late, while the next clock is started, would let that one kill. */
static void start_clock(void)
{
    const struct itimerval once = {.it_value = {.tv_usec = MICROSECONDS}};
    struct sigaction stay = {.sa_flags = SA_RESTART};
    stay.sa_handler = tell_to_stop;
    stop = 0;
    DEMAND(sigaction(SIGVTALRM, &stay, NULL) == 0);
    DEMAND(setitimer(ITIMER_VIRTUAL, &once, NULL) == 0);
}

static bool is_small(const mt_study *s)
{
    const mt_model *const m = s->model;
    int elements = 0;
    int points = 1;
    int bands = 0;
    for (int i = 0; i < m->n_links; i++) {
        elements += m->links[i].elements < MOST_ELEMENTS ? m->links[i].elements : MOST_ELEMENTS;
    }
    for (int i = 0; i < s->trade.n_vary; i++) {
        points *= s->trade.vary[i].n_values < MOST_POINTS ? s->trade.vary[i].n_values + 1
                                                          : MOST_POINTS + 1;
    }
    for (int i = 0; i < s->n_goals; i++) {
        bands += s->goals[i].avoid == NULL ? 0 : s->goals[i].n_configurations;
    }
    return m->n_bodies + m->n_joints + m->n_springs <= 2 * MOST_PARTS &&
           m->n_bodies <= MOST_PARTS && elements < MOST_ELEMENTS && points <= MOST_POINTS + 1 &&
           s->n_variables <= MOST_VARIABLES && s->n_goals <= MOST_GOALS && bands <= MOST_POINTS;
}

static void requirement_failed(mt_status rc, const mt_err *err)
{
    DEMAND(fuzz_is_refusal(rc));
    DEMAND(err->code == rc && err->text[0] != '\0');
}

static void evaluate(const mt_problem *p)
{
    mt_nlp_values v;
    mt_workspace *w = NULL;
    mt_err err = {.code = MT_OK};
    mt_status rc = mt_workspace_new(p, &w, &err);
    if (rc == MT_OK) {
        const mt_nlp nlp = mt_workspace_nlp(w);
        DEMAND(mt_subproblem_values_init(w->c, &w->mem, &v, &err) == MT_OK);
        for (int i = 0; i < nlp.n; i++) {
            DEMAND(!isnan(nlp.lower[i]) && !isnan(nlp.upper[i]) &&
                   nlp.lower[i] <= nlp.upper[i]);
        }
        rc = mt_workspace_eval(w, w->c->origin_t, true, &v, &err);
    }
    if (rc != MT_OK) {
        requirement_failed(rc, &err);
    }
    mt_workspace_delete(w);
}

static void compile(const mt_study *study)
{
    mt_problem *p = NULL;
    mt_err err = {.code = MT_OK};
    const mt_status rc = mt_problem_new(study, NULL, &p, &err);
    if (rc == MT_OK) {
        evaluate(p);
    } else {
        requirement_failed(rc, &err);
    }
    mt_problem_delete(p);
}

static void requirement_table(mt_table t, const uint8_t *data, size_t size)
{
    mt_text said = {0};
    mt_table_print(&t, 0, 0, &said);
    mt_table_csv(&t, &said);
    DEMAND(!t.failed && !said.failed);
    fuzz_requirement_finite_words(&said, data, size);
    mt_text_free(&said);
    mt_table_free(&t);
}

static void requirement_told(const mt_result *r, const uint8_t *data, size_t size)
{
    mt_text said = {0};
    mt_err err = {.code = MT_OK};
    mt_result *again = NULL;
    mt_diagnostics messages = {.count = 0};
    DEMAND(mt_result_write(r, &said, &err) == MT_OK);
    const char *const path = fuzz_write("result.json", (const uint8_t *)said.s, said.length);
    DEMAND(mt_result_load(path, NULL, &again, &messages, &err) == MT_OK);
    DEMAND(again->status == r->status && again->n_recommendations == r->n_recommendations);
    mt_result_delete(again);
    mt_diagnostics_free(&messages);
    mt_text_free(&said);
    mt_report_summary(r, true, 0, &said);
    DEMAND(!said.failed);
    fuzz_requirement_finite_words(&said, data, size);
    mt_text_free(&said);
    mt_report_html_told(r, &said);
    DEMAND(!said.failed);
    fuzz_requirement_finite_words(&said, data, size);
    mt_text_free(&said);
    requirement_table(mt_report_designs(r), data, size);
    requirement_table(mt_report_published(r), data, size);
    requirement_table(mt_report_trade(r), data, size);
}

static void answer(mt_study *study, const uint8_t *data, size_t size)
{
    mt_result *result = NULL;
    mt_err err = {.code = MT_OK};
    mt_solve_options opt = {.size = sizeof opt};
    opt.stop = request;
    opt.progress = hear_progress;
    study->search.starts = 1;
    study->search.max_evaluations = EVALUATIONS;
    study->recommendations = 1;
    study->weight_sensitivity.factor =
        study->n_variables > 2 ? nan("") : study->weight_sensitivity.factor;
    start_clock();
    const mt_status rc = mt_study_solve(study, &opt, &result, &err);
    if (rc != MT_OK) {
        DEMAND(result == NULL);
        requirement_failed(rc, &err);
        return;
    }
    requirement_told(result, data, size);
    mt_result_delete(result);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const uint8_t *const nul = size == 0 ? NULL : memchr(data, 0, size);
    const size_t first = nul == NULL ? size : (size_t)(nul - data);
    mt_study *study = NULL;
    mt_diagnostics said = {.count = 0};
    mt_err err = {.code = MT_OK};
    mt_io_options opt = {.root = "/"};
    mt_blas_set_threads(1);
    (void)fuzz_write("model.json", nul == NULL ? data : nul + 1,
                     nul == NULL ? 0 : size - first - 1);
    const mt_status rc =
        mt_study_load(fuzz_write("study.json", data, first), &opt, &study, &said, &err);
    if (rc != MT_OK) {
        DEMAND(rc == MT_E_INPUT && study == NULL && err.text[0] != '\0');
        DEMAND(mt_hostile_diagnosed(said.lines.s, said.lines.length));
    } else if (is_small(study)) {
        compile(study);
        answer(study, data, size);
    }
    mt_diagnostics_free(&said);
    mt_study_delete(study);
    return 0;
}
