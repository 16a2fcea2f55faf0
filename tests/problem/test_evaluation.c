/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One evaluation of a study as the search makes it: once warm it takes nothing from the
 * heap. */
#include <math.h>
#include <stdio.h>

#include "io/options.h"
#include "problem/evaluate.h"
#include "problem/workspace.h"
#include "study/read.h"
#include "support/mt_alloc.h"
#include "support/mt_test.h"

enum { PATH_LENGTH = 512, WARM = 6, COUNTED = 6 };

static const double SPREAD = 1e-3;

typedef struct compiled {
    mt_study *study;
    mt_problem *p;
    mt_workspace *w;
    mt_arena mem;
    mt_nlp_values out;
    double *t;
} compiled;

static bool open_study(mt_test *t, const char *name, compiled *s)
{
    char path[PATH_LENGTH];
    mt_err err = {.text = ""};
    const mt_io_options opt = {.root = MT_TEST_SOURCE_DIR};
    *s = (compiled){.study = NULL};
    (void)snprintf(path, sizeof path, "%s/studies/%s.json", MT_TEST_SOURCE_DIR, name);
    if (!CHECK_INT(t, mt_arena_init(&s->mem, 0, NULL), MT_OK) ||
        !CHECK_INT(t, mt_study_load(path, &opt, &s->study, NULL, &err), MT_OK) ||
        !CHECK_INT(t, mt_problem_new(s->study, NULL, &s->p, &err), MT_OK) ||
        !CHECK_INT(t, mt_workspace_new(s->p, &s->w, &err), MT_OK)) {
        return false;
    }
    s->t = mt_arena_f64(&s->mem, (size_t)mt_workspace_nlp(s->w).n, 1);
    return CHECK_INT(t, mt_subproblem_values_init(s->w->c, &s->mem, &s->out, &err), MT_OK);
}

static void close_study(compiled *s)
{
    mt_workspace_delete(s->w);
    mt_problem_delete(s->p);
    mt_study_delete(s->study);
    mt_arena_free(&s->mem);
}

static mt_status evaluate(compiled *s, int call, bool with_gradient)
{
    const mt_nlp nlp = mt_workspace_nlp(s->w);
    for (int i = 0; i < nlp.n; i++) {
        const double room = fmin(nlp.upper[i] - nlp.origin[i], nlp.origin[i] - nlp.lower[i]);
        const double step = fmin(SPREAD, fmax(room, 0.0));
        s->t[i] = nlp.origin[i] + (step * sin((double)call * (double)(i + 1)));
    }
    return mt_workspace_eval(s->w, s->t, with_gradient, &s->out, NULL);
}

static void evaluation__takes_nothing_from_the_heap(mt_test *t)
{
    static const char *const studies[] = {
        "beam_identification",     "truss_10bar_E68_9",  "truss_72bar",    "six_masses_bands",
        "inceptor_identification", "inceptor_stick_mac", "inceptor_rotor", "engine_orders"};
    const bool counted = mt_alloc_works();
    for (int i = 0; i < MT_COUNT(studies); i++) {
        compiled s;
        if (open_study(t, studies[i], &s)) {
            for (int call = 0; call < WARM; call++) {
                CHECK_INT(t, evaluate(&s, call, call % 2 == 0), MT_OK);
            }
            const long warm = mt_alloc_count();
            for (int call = WARM; call < WARM + COUNTED; call++) {
                mt_test_row(t, "%s, call %d", studies[i], call);
                CHECK_INT(t, evaluate(&s, call, call % 2 == 0), MT_OK);
                CHECK(t, !counted || mt_alloc_count() == warm);
            }
        }
        close_study(&s);
    }
}

MT_TEST_MAIN(MT_TEST(evaluation__takes_nothing_from_the_heap))
