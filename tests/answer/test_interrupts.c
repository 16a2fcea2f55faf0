/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A study that is interrupted says what of its answer is missing, and what it does say is what
 * it says when it is left alone. Moments are counted, not timed: a solve asks whether to stop
 * before every unit of work, always in the same order; it is told to at fifty of these
 * questions, spread evenly over all of them.
 *
 * MT_INTERRUPT_PLACES=50 takes that many moments of every study of the tree (minutes); without
 * it, those that ask often are interrupted fewer times, and the longest once, near their
 * beginning.
 */
#include <glob.h>

#include "describe/describe.h"
#include "result/write.h"
#include "study_kinds.h"

enum { PLACES = 50, PATH_SIZE = 600 };
/* The short form. A study that asks more than this is interrupted there alone; of others, so
 * many questions are gone through on the way to all their places, of which each has
 * PLACES_LEAST. */
typedef struct effort {
    long once_after; /* 0: never */
    long questions;
} effort;
static const effort KINDS = {5000, 8000};
static const effort KINDS_ALL = {0, 20000}; /* with MT_EVERY=1 */
static const effort TREE = {600, 1200};
static const effort TREE_ALL = {2000, 4000};
enum { PLACES_LEAST = 2 };
/* Numbers of one design, analysed twice. */
static const double SAME = 1e-9;

typedef struct moment {
    long asked;
    long at;    /* from this question on; 0: never */
    long later; /* from this many questions later on at once; 0: never */
} moment;

static int request(void *context)
{
    moment *const m = context;
    m->asked++;
    if (m->at == 0 || m->asked < m->at) {
        return MT_STOP_REQUEST_NONE;
    }
    return m->later > 0 && m->asked - m->at >= m->later - 1 ? MT_STOP_REQUEST_END
                                                            : MT_STOP_REQUEST_FINISH;
}

static mt_status solve(const mt_study *study, moment *m, mt_result **out, mt_err *err)
{
    mt_solve_options opt = {.size = sizeof opt};
    m->asked = 0;
    opt.stop = request;
    opt.stop_context = m;
    return mt_study_solve(study, &opt, out, err);
}

static bool is_cut(const mt_result *r, const char *name)
{
    for (int i = 0; i < r->run.n_incomplete; i++) {
        if (strcmp(r->run.incomplete[i], name) == 0) {
            return true;
        }
    }
    return false;
}

/* As its file would be; the caller frees it. */
static char *text_of(mt_test *t, const mt_result *r)
{
    mt_text text = {0};
    CHECK_INT(t, mt_result_write(r, &text, NULL), MT_OK);
    return text.s;
}

static void same_text(mt_test *t, const mt_result *a, const mt_result *b)
{
    char *const one = text_of(t, a);
    char *const other = text_of(t, b);
    if (!CHECK(t, one != NULL && other != NULL && strcmp(one, other) == 0) && one != NULL &&
        other != NULL) {
        size_t i = 0;
        while (one[i] != '\0' && one[i] == other[i]) {
            i++;
        }
        const size_t from = i > 100 ? i - 100 : 0;
        (void)fprintf(stderr, "  ...%.160s\n  ...%.160s\n", one + from, other + from);
    }
    free(one);
    free(other);
}

/* What is not named as incomplete is the same to the byte; what is, is not there, but for
 * designs and points of a trade study, which are judged below. */
static void rest_is_whole(mt_test *t, const mt_result *whole, const mt_result *r)
{
    mt_result expected = *whole;
    expected.status = r->status;
    expected.status_text = r->status_text;
    expected.warnings = r->warnings;
    expected.n_warnings = r->n_warnings;
    expected.run = r->run;
    if (is_cut(r, "search")) {
        expected.recommendations = r->recommendations;
        expected.n_unidentifiable = 0;
        expected.unidentifiable = NULL; /* not computed, which is not the same as none */
    }
    expected.unchecked = r->unchecked;
    expected.n_unchecked = r->n_unchecked;
    expected.n_recommendations = is_cut(r, "recommendations") || is_cut(r, "search")
                                     ? r->n_recommendations
                                     : whole->n_recommendations;
    expected.n_weight_sensitivity = is_cut(r, "spread") ? 0 : whole->n_weight_sensitivity;
    expected.weight_sensitivity = is_cut(r, "spread") ? NULL : whole->weight_sensitivity;
    expected.n_certificates = is_cut(r, "certificates") ? 0 : whole->n_certificates;
    expected.certificates = is_cut(r, "certificates") ? NULL : whole->certificates;
    expected.n_relaxations = is_cut(r, "relaxations") ? 0 : whole->n_relaxations;
    expected.relaxations = is_cut(r, "relaxations") ? NULL : whole->relaxations;
    expected.n_published = is_cut(r, "published") ? 0 : whole->n_published;
    expected.published = is_cut(r, "published") ? NULL : whole->published;
    if (is_cut(r, "search") && !is_cut(r, "published")) { /* of another design */
        expected.published = r->published;
        expected.n_published = r->n_published;
    }
    expected.trade = is_cut(r, "trade") ? r->trade : whole->trade;
    CHECK(t, expected.n_recommendations <= whole->n_recommendations || is_cut(r, "search"));
    same_text(t, &expected, r);
    const int untold = r->n_unchecked;
    for (int i = 0; i < r->n_warnings; i++) {
        CHECK(t, is_cut(r, "search") ||
                     study_says(whole->n_warnings, whole->warnings, r->warnings[i]));
    }
    /* no design that was found is lost */
    CHECK(t, is_cut(r, "recommendations") || untold == 0);
    if (!is_cut(r, "search")) {
        CHECK_INT(t, r->n_recommendations + untold, whole->n_recommendations);
    }
    CHECK(t, r->n_recommendations > 0 || strstr(r->status_text, "Solved") == NULL ||
                 whole->n_recommendations == 0);
}

static void same_goals(mt_test *t, const mt_recommendation *a, const mt_recommendation *b)
{
    CHECK_INT(t, a->n_goals, b->n_goals);
    for (int i = 0; i < a->n_goals && i < b->n_goals; i++) {
        CHECK(t, a->goals[i].met == b->goals[i].met);
    }
}

/* The best so far of a search that was cut, against the same design described at leisure. */
static void designs_hold(mt_test *t, const mt_study *study, const mt_result *r)
{
    mt_arena mem;
    mt_problem *p = NULL;
    mt_result *own = NULL;
    mt_err err = {.text = ""};
    if (!CHECK_INT(t, mt_arena_init(&mem, 0, NULL), MT_OK)) {
        return;
    }
    mt_status rc = mt_problem_new(study, NULL, &p, &err);
    rc = rc == MT_OK ? mt_result_new(&own, &err) : rc;
    for (int k = 0; k < r->n_recommendations && rc == MT_OK; k++) {
        const mt_recommendation *const rec = &r->recommendations[k];
        double *const x = mt_arena_f64(&mem, (size_t)p->n + 1, 1);
        mt_nlp_solution found = {.t = x};
        const mt_design design = {.t = x, .found = &found, .rank = k + 1, .cut = true};
        mt_recommendation fresh;
        for (int i = 0; i < p->n && x != NULL; i++) {
            x[i] = mt_problem_t(p, i, rec->parameters[i].recommended);
        }
        rc = mt_describe_design(p, &design, &own->baseline, own, &fresh, &err);
        if (CHECK_INT(t, rc, MT_OK)) {
            CHECK(t, rec->feasible == fresh.feasible);
            CHECK(t, strcmp(rec->grade, fresh.grade) == 0);
            CHECK_NEAR(t, rec->change, fresh.change, SAME * (1.0 + fresh.change));
            same_goals(t, rec, &fresh);
        }
        CHECK(t, isnan(rec->kkt_residual) && !rec->singular); /* known of a whole search only */
    }
    CHECK_INT(t, rc, MT_OK);
    mt_result_delete(own);
    mt_problem_delete(p);
    mt_arena_free(&mem);
}

/* A point that was answered is answered as well as in the whole study, but for what its
 * neighbours had known better. */
static void points_hold(mt_test *t, const mt_trade_result *whole, const mt_trade_result *cut)
{
    CHECK_INT(t, cut->n_points, whole->n_points);
    for (int i = 0; i < cut->n_points; i++) {
        const mt_trade_point *const p = &cut->points[i];
        CHECK(t, p->status == MT_RESULT_INTERRUPTED || p->status == whole->points[i].status ||
                     whole->points[i].status == MT_RESULT_SOLVED);
        CHECK(t, p->status != MT_RESULT_SOLVED || p->best.feasible);
    }
}

static void judge(mt_test *t, const mt_study *study, const mt_result *whole, const mt_result *r)
{
    if (r->status != MT_RESULT_INTERRUPTED) {
        CHECK_INT(t, r->run.n_incomplete, 0);
        same_text(t, whole, r);
        return;
    }
    CHECK(t, r->run.n_incomplete > 0);
    CHECK(t, strstr(r->status_text, "Interrupted") != NULL);
    rest_is_whole(t, whole, r);
    if (is_cut(r, "search")) {
        designs_hold(t, study, r);
    }
    if (is_cut(r, "trade") && r->trade != NULL) {
        points_hold(t, whole->trade, r->trade);
    }
}

/* 0: as the short form does. */
static int places_wanted(void)
{
    const char *const text = getenv("MT_INTERRUPT_PLACES");
    return text != NULL ? (int)strtol(text, NULL, 10) : 0;
}

static int places_of(long questions, long most)
{
    const int wanted = places_wanted();
    const long n = questions > 0 ? 2L * most / questions : 0;
    if (wanted > 0) {
        return questions < wanted ? (int)questions : wanted;
    }
    const int some = n < PLACES_LEAST ? (int)PLACES_LEAST : n < PLACES ? (int)n : (int)PLACES;
    return questions < some ? (int)questions : some;
}

/* Counts how often each phase was cut, so that a test knows what it has tested. */
typedef struct tally {
    int cut;
    int none;
    int equal;
    int by_phase[8];
} tally;

static const char *const phases[] = {"search",      "recommendations", "spread", "certificates",
                                     "relaxations", "published",       "trade"};

static void count(tally *n, const mt_result *r)
{
    if (r == NULL) {
        n->none++;
        return;
    }
    n->equal += r->run.n_incomplete == 0 ? 1 : 0;
    n->cut += r->run.n_incomplete > 0 ? 1 : 0;
    for (int k = 0; k < MT_COUNT(phases); k++) {
        n->by_phase[k] +=
            r->run.n_incomplete > 0 && strcmp(r->run.incomplete[0], phases[k]) == 0;
    }
}

/* Interrupt a study, whose whole answer takes so many questions, at many places, on the way to
 * which it asks `most`: to finish, at once, and to finish and a little later at once. */
static void disturb(mt_test *t, const char *name, const mt_study *study, const mt_result *whole,
                    long questions, long most, tally *n)
{
    mt_err err = {.text = ""};
    moment m = {0};
    const int places = places_of(questions, most);
    CHECK(t, questions > 0);
    for (int i = 0; i < places; i++) {
        static const long later[] = {0, 1, 7};
        mt_result *r = NULL;
        m.at = 1 + (long)((double)questions * ((double)i + 0.5) / (double)places);
        m.later = later[i % MT_COUNT(later)];
        mt_test_row(t, "%s: question %ld (%ld) of %ld", name, m.at, m.later, questions);
        const mt_status rc = solve(study, &m, &r, &err);
        CHECK(t, rc == MT_OK || (rc == MT_E_INTERRUPTED && r == NULL && m.later > 0));
        if (rc != MT_OK && rc != MT_E_INTERRUPTED) {
            (void)fprintf(stderr, "%s: %s\n", mt_status_name(rc), err.text);
        }
        if (r != NULL) {
            judge(t, study, whole, r);
        }
        count(n, r);
        mt_result_delete(r);
    }
}

/* Of a study that is told to stop from one question on, or never. NULL: there is none, and why
 * is said. */
static mt_result *answer_of(mt_test *t, const char *name, const mt_study *study, moment *m)
{
    mt_err err = {.text = ""};
    mt_result *r = NULL;
    if (!CHECK_INT(t, solve(study, m, &r, &err), MT_OK)) {
        (void)fprintf(stderr, "%s: %s\n", name, err.text);
    }
    return r;
}

/* Of a study that asks often, the best so far; others are disturbed. */
static void disturb_one(mt_test *t, const char *name, const mt_study *study, effort most,
                        tally *n)
{
    moment m = {.at = places_wanted() > 0 ? 0 : most.once_after};
    mt_result *const r = answer_of(t, name, study, &m);
    if (r != NULL && r->status == MT_RESULT_INTERRUPTED) {
        CHECK(t, !is_cut(r, "baseline"));
        if (is_cut(r, "search")) {
            designs_hold(t, study, r);
        }
        count(n, r);
    } else if (r != NULL) {
        disturb(t, name, study, r, m.asked, most.questions, n);
    }
    mt_result_delete(r);
}

static void every_kind__says_what_is_missing(mt_test *t)
{
    const bool all = getenv("MT_EVERY") != NULL;
    tally n = {0};
    for (int i = 0; i < MT_COUNT(study_kinds); i++) {
        study_case c;
        mt_test_row(t, "%s", study_kinds[i].name);
        if (study_load(t, study_kinds[i].model, study_kinds[i].members, &c)) {
            disturb_one(t, study_kinds[i].name, c.study, all ? KINDS_ALL : KINDS, &n);
        }
        study_free(&c);
    }
    mt_test_row(t, "all");
    for (int k = 0; k < MT_COUNT(phases); k++) {
        mt_test_row(t, "%s is cut %d times", phases[k], n.by_phase[k]);
        CHECK(t, n.by_phase[k] > 0);
    }
    CHECK(t, n.none > 0);
}

static void every_study_of_the_tree__says_what_is_missing(mt_test *t)
{
    const bool all = getenv("MT_EVERY") != NULL;
    glob_t list;
    tally n = {0};
    if (!CHECK_INT(t, glob(MT_TEST_SOURCE_DIR "/studies/*.json", 0, NULL, &list), 0)) {
        return;
    }
    for (size_t i = 0; i < list.gl_pathc; i++) {
        mt_study *study = NULL;
        mt_err err = {.text = ""};
        mt_test_row(t, "%s", list.gl_pathv[i]);
        if (CHECK_INT(t, mt_study_read(list.gl_pathv[i], NULL, &study, &err), MT_OK)) {
            disturb_one(t, strrchr(list.gl_pathv[i], '/') + 1, study, all ? TREE_ALL : TREE,
                        &n);
        }
        mt_study_delete(study);
    }
    CHECK(t, n.cut > 0);
    globfree(&list);
}

MT_TEST_MAIN(MT_TEST(every_kind__says_what_is_missing),
             MT_TEST(every_study_of_the_tree__says_what_is_missing))
