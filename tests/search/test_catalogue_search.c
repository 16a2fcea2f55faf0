/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Catalogues against brute force: every combination judged by the modes alone. */
#include "search/catalogue_search.h"
#include "six.h"
#include "study_fixture.h"

/* The change is the same sum in another order; ln of k exp(x) is x to rounding. */
static const double ROUNDING = 1e-12;
/* Two searches of one continuous optimum. */
static const double SAME_OPTIMUM = 1e-6;

enum { VALUES = 4, ALL = 4096 };
static const double LN[VALUES] = {-0.6, -0.2, 0.2, 0.6};

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return x < y ? -1 : x > y ? 1 : 0;
}

/* Changes of all feasible combinations, ascending; their number. */
static int brute_force(six *s, double change[ALL])
{
    int n = 0;
    for (int c = 0; c < ALL; c++) {
        double x[SIX];
        for (int i = 0, rest = c; i < SIX; i++, rest /= VALUES) {
            x[i] = s->catalogue[i][rest % VALUES];
        }
        if (six_clear(s, x, 0.0)) {
            change[n++] = six_change(s, x);
        }
    }
    qsort(change, (size_t)n, sizeof *change, ascending);
    return n;
}

static const mt_certificate *certificate(const mt_result *r, const char *kind)
{
    for (int i = 0; i < r->n_certificates; i++) {
        if (strcmp(r->certificates[i].kind, kind) == 0) {
            return &r->certificates[i];
        }
    }
    return NULL;
}

static const mt_certificate *enumeration(const mt_result *r)
{
    return certificate(r, "enumeration");
}

static bool proves(const mt_result *r, const char *kind)
{
    const mt_certificate *const c = certificate(r, kind);
    return c != NULL && c->proven;
}

static void check_members(mt_test *t, const six *s, const mt_recommendation *r)
{
    for (int i = 0; i < SIX; i++) {
        const mt_variable *const v = &s->study->variables[i];
        bool member = v->n_catalogue == 0;
        for (int k = 0; k < v->n_catalogue; k++) {
            member = member || v->catalogue[k] == r->parameters[i].recommended;
        }
        mt_test_row(t, "recommendation %d, %s", r->rank, r->parameters[i].name);
        CHECK(t, member);
    }
}

static void discrete__enumeration_agrees_with_brute_force(mt_test *t)
{
    static double change[ALL];
    six s;
    REQUIRE(t, six_begin(t, &s));
    for (int i = 0; i < SIX; i++) {
        six_catalogue(&s, i, VALUES, LN);
    }
    const int n = brute_force(&s, change);
    mt_result *const r = six_same_bytes(t, s.study);
    CHECK(t, n > 7);
    if (r != NULL && CHECK_INT(t, r->n_recommendations, 7)) {
        for (int i = 0; i < 7; i++) {
            mt_test_row(t, "recommendation %d", i + 1);
            CHECK_NEAR(t, r->recommendations[i].change, change[i], ROUNDING);
            CHECK(t, r->recommendations[i].feasible);
            check_members(t, &s, &r->recommendations[i]);
        }
        const mt_certificate *const c = enumeration(r);
        CHECK(t, c != NULL && c->proven);
        CHECK_INT(t, r->status, MT_RESULT_SOLVED);
    }
    mt_result_delete(r);
    six_end(&s);
}

static void discrete__no_combination_is_listed_twice(mt_test *t)
{
    six s;
    REQUIRE(t, six_begin(t, &s));
    for (int i = 0; i < SIX; i++) {
        six_catalogue(&s, i, VALUES, LN);
    }
    s.study->recommendations = 40;
    mt_result *const r = six_solve(t, s.study, 1);
    CHECK(t, r != NULL && r->n_recommendations > 16);
    for (int i = 0; r != NULL && i < r->n_recommendations; i++) {
        for (int k = 0; k < i; k++) {
            double apart = 0.0;
            for (int v = 0; v < SIX; v++) {
                apart += fabs(r->recommendations[i].parameters[v].recommended -
                              r->recommendations[k].parameters[v].recommended);
            }
            mt_test_row(t, "%d and %d", i, k);
            CHECK(t, apart > 0.0);
        }
    }
    mt_result_delete(r);
    six_end(&s);
}

static void discrete__that_no_combination_works_is_proven(mt_test *t)
{
    static const double near[] = {-0.05, 0.0, 0.05};
    six s;
    REQUIRE(t, six_begin(t, &s));
    for (int i = 0; i < SIX; i++) {
        six_catalogue(&s, i, MT_COUNT(near), near);
    }
    mt_result *const r = six_solve(t, s.study, 1);
    if (r != NULL) {
        const mt_certificate *const c = enumeration(r);
        CHECK_INT(t, r->status, MT_RESULT_INFEASIBLE);
        CHECK(t, c != NULL && c->proven);
        CHECK(t, r->n_recommendations > 0 && !r->recommendations[0].feasible);
    }
    mt_result_delete(r);
    six_end(&s);
}

/* Each value of the catalogue as a study of its own, with that spring fixed. */
static double best_of_fixed(mt_test *t, six *s)
{
    mt_variable *const v = &s->study->variables[1];
    double best = HUGE_VAL;
    v->n_catalogue = 0;
    for (int k = 0; k < 2; k++) {
        v->lower = s->catalogue[1][k];
        v->upper = v->lower;
        mt_result *const r = six_solve(t, s->study, 1);
        if (r != NULL && r->n_recommendations > 0 && r->recommendations[0].feasible) {
            best = fmin(best, r->recommendations[0].change);
        }
        mt_result_delete(r);
    }
    return best;
}

static void discrete__mixed_agrees_with_every_value_on_its_own(mt_test *t)
{
    six s;
    REQUIRE(t, six_begin(t, &s));
    six_catalogue(&s, 1, 2, LN + 1);
    mt_result *const r = six_same_bytes(t, s.study);
    const double want = best_of_fixed(t, &s);
    six_catalogue(&s, 1, 2, LN + 1);
    if (r != NULL && CHECK(t, r->n_recommendations > 0)) {
        const mt_certificate *const c = enumeration(r);
        CHECK_NEAR(t, r->recommendations[0].change, want, SAME_OPTIMUM);
        check_members(t, &s, &r->recommendations[0]);
        CHECK(t, c != NULL && !c->proven);
        CHECK(t, proves(r, "gap_assignments")); /* and that within 1 % none is better */
        CHECK(t, proves(r, "optimal"));
        CHECK(t, certificate(r, "infeasible") == NULL);
    }
    mt_result_delete(r);
    six_end(&s);
}

/* Springs within 5 %, three of them in steps: the bands stay occupied, whatever the others
 * do. */
static void discrete__that_no_combination_with_others_beside_works_is_proven(mt_test *t)
{
    static const double near[] = {-0.05, 0.01, 0.05};
    six s;
    REQUIRE(t, six_begin(t, &s));
    for (int i = 0; i < SIX; i++) {
        if (i < 3) {
            six_catalogue(&s, i, MT_COUNT(near), near);
        } else {
            s.study->variables[i].lower = 0.95 * s.k[i];
            s.study->variables[i].upper = 1.05 * s.k[i];
        }
    }
    mt_result *const r = six_same_bytes(t, s.study);
    if (r != NULL) {
        CHECK_INT(t, r->status, MT_RESULT_INFEASIBLE);
        CHECK(t, proves(r, "infeasible"));
        CHECK(t, r->n_recommendations > 0 && !r->recommendations[0].feasible);
    }
    mt_result_delete(r);
    six_end(&s);
}

/* 27^6 combinations within 7 %: not one is enumerated, all are excluded. */
static void discrete__that_none_of_too_many_combinations_works_is_proven(mt_test *t)
{
    double fine[27];
    six s;
    REQUIRE(t, six_begin(t, &s));
    for (int k = 0; k < 27; k++) {
        fine[k] = 0.005 * (k - 13);
    }
    for (int i = 0; i < SIX; i++) {
        six_catalogue(&s, i, MT_COUNT(fine), fine);
    }
    mt_result *const r = six_solve(t, s.study, 1);
    if (r != NULL) {
        CHECK_INT(t, r->status, MT_RESULT_INFEASIBLE);
        CHECK(t, proves(r, "infeasible"));
        CHECK(t, !proves(r, "enumeration"));
    }
    mt_result_delete(r);
    six_end(&s);
}

/* An expression, and a mass, as the objective beside a continuous variable: k1 of a list, k2
 * free; mode 1 at least at f. The least k2 lies at the greatest k1, in closed form: lambda^2 -
 * (k1 + 2 k2) lambda + k1 k2 = 0 with m = 1 gives k2 = lambda (k1 - lambda) / (k1 - 2
 * lambda). */
static void discrete__the_best_of_an_expression_is_proven_within_one_per_cent(mt_test *t)
{
    study_case c;
    const double lambda = 4.0 * STUDY_PI * STUDY_PI * 0.1 * 0.1;
    if (study_solve(t, STUDY_TWO_MASSES("'k1': 2, 'k2': 1, 'm': 1", ""),
                    "'variables': [{'parameter': 'k1', 'catalogue': [1.2, 2, 3]},"
                    " {'parameter': 'k2', 'lower': 0.2, 'upper': 5}],"
                    "'objective': {'minimise': 'k2'},"
                    "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': 0.1}]",
                    &c)) {
        CHECK_NEAR(t, study_value(&c, 1, "k2"), lambda * (3.0 - lambda) / (3.0 - 2.0 * lambda),
                   1e-5);
        CHECK_NEAR_ABS(t, study_value(&c, 1, "k1"), 3.0, 0.0);
        CHECK(t, proves(c.result, "optimal"));
        CHECK(t, study_reasons(&c, 1, "none is better by more than 1 %"));
    }
    study_free(&c);
}

#define MANY                                                                                 \
    "'variables': [{'parameter': 'k1', 'catalogue': {'series': 'E24', 'lower': 1, 'upper': " \
    "9.5}}, {'parameter': 'm', 'catalogue': {'series': 'E24', 'lower': 0.5, 'upper': 5}}, "  \
    "{'parameter': 'k2', 'lower': 0.2, 'upper': 5}], 'search': {'starts': 2},"
#define MANY_LOADED                                                    \
    "{'format': 'modetune-model/1', 'name': 'loaded', 'dimension': 2," \
    "'parameters': {'k1': 2, 'k2': 1, 'm': 1}, "                       \
    "'gravity_m_per_s2': [-9.81, 0]," STUDY_TWO_MASSES_ROW "}"

static bool says(const study_case *c, const char *text)
{
    const mt_certificate *const e = enumeration(c->result);
    return e != NULL && strstr(e->text, text) != NULL;
}

/* 600 combinations beside a continuous variable. Gravity along the row changes no mode, but
 * forbids certificates: what the change alone excludes leaves the same best design. */
static void discrete__branch_and_bound_excludes_with_certificates_and_without(mt_test *t)
{
    static const char goal[] =
        MANY "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': 0.15}]";
    study_case c;
    study_case loaded;
    const bool solved =
        study_solve(t, STUDY_TWO_MASSES("'k1': 2, 'k2': 1, 'm': 1", ""), goal, &c);
    if (study_solve(t, MANY_LOADED, goal, &loaded) && solved) {
        CHECK(t, says(&c, "branch and bound excludes all others"));
        CHECK(t, says(&loaded, "branch and bound excludes all others"));
        CHECK_NEAR(t, loaded.result->recommendations[0].change,
                   c.result->recommendations[0].change, SAME_OPTIMUM);
        for (int i = 0; i < 3; i++) {
            const char *const name = c.result->recommendations[0].parameters[i].name;
            mt_test_row(t, "%s", name);
            CHECK_NEAR(t, study_value(&loaded, 1, name), study_value(&c, 1, name), 1e-4);
        }
    }
    study_free(&loaded);
    study_free(&c);
}

/* No design meets the goal: with certificates one look says so, without them (MT_EVERY=1) 400
 * combinations are searched, and the answer tells how many are left. */
static void discrete__branch_and_bound_says_how_far_it_came(mt_test *t)
{
    static const char goal[] =
        MANY "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': 2}]";
    study_case c;
    if (study_solve(t, STUDY_TWO_MASSES("'k1': 2, 'k2': 1, 'm': 1", ""), goal, &c)) {
        CHECK(t, proves(c.result, "infeasible"));
        CHECK(t,
              says(&c, "branch and bound excludes all others: none of them meets all goals."));
    }
    study_free(&c);
    if (getenv("MT_EVERY") == NULL) {
        return;
    }
    if (study_solve(t, MANY_LOADED, goal, &c)) {
        CHECK_INT(t, c.result->status, MT_RESULT_COMPROMISE);
        CHECK(t, !proves(c.result, "infeasible") && !proves(c.result, "enumeration"));
        CHECK(t, says(&c, "this settles ") && says(&c, "its effort ended before the other "));
    }
    study_free(&c);
}

/* Nothing is claimed where the modes cannot be enclosed, and it is said why. */
static void discrete__without_an_enclosure_nothing_is_proven(mt_test *t)
{
    study_case c;
    if (study_solve(t,
                    "{'format': 'modetune-model/1', 'name': 'loaded', 'dimension': 2,"
                    "'parameters': {'k1': 2, 'k2': 1, 'm': 1}, "
                    "'gravity_m_per_s2': [-9.81, 0]," STUDY_TWO_MASSES_ROW "}",
                    "'variables': [{'parameter': 'k1', 'catalogue': [1, 2, 3]},"
                    " {'parameter': 'k2', 'lower': 0.2, 'upper': 5}],"
                    "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': 1}],"
                    "'search': {'starts': 4}",
                    &c)) {
        CHECK_INT(t, c.result->status, MT_RESULT_COMPROMISE);
        const mt_certificate *const proof = certificate(c.result, "infeasible");
        CHECK(t, proof != NULL && !proof->proven);
        CHECK(t, proof != NULL && strstr(proof->text, "gravity loads the mechanism") != NULL);
    }
    study_free(&c);
}

static void discrete__of_too_many_combinations_the_best_is_proven(mt_test *t)
{
    double fine[27];
    six s;
    REQUIRE(t, six_begin(t, &s));
    for (int k = 0; k < 27; k++) {
        fine[k] = 0.05 * (k - 13);
    }
    for (int i = 0; i < SIX; i++) {
        six_catalogue(&s, i, MT_COUNT(fine), fine);
    }
    mt_result *const r = six_same_bytes(t, s.study);
    if (r != NULL && CHECK(t, r->n_recommendations > 0)) {
        const mt_certificate *const c = enumeration(r);
        const mt_recommendation *const best = &r->recommendations[0];
        double x[SIX];
        for (int i = 0; i < SIX; i++) {
            x[i] = best->parameters[i].recommended;
        }
        CHECK(t, c != NULL && !c->proven);
        CHECK(t, six_clear(&s, x, 0.0));
        check_members(t, &s, best);
        /* the only one of the 2.3 million combinations or so within this change that keeps
         * clear, by another program's enumeration of them: steps -4, 6, 0, 2, -2, -4 */
        CHECK_NEAR(t, best->change, 0.05 * sqrt(76.0), ROUNDING);
        CHECK(t, proves(r, "gap_assignments"));
        CHECK(t, proves(r, "optimal"));
    }
    mt_result_delete(r);
    six_end(&s);
}

/* What is made least or greatest follows from the objective's kind, not from its name. */
static void discrete__the_rank_says_least_of_what_begins_like_clearance(mt_test *t)
{
    study_case c;
    if (study_solve(t, STUDY_TWO_MASSES("'k1': 2, 'k2': 1, 'm': 1, 'clamp_mass': 'k1*0.1'", ""),
                    "'variables': [{'parameter': 'k1', 'catalogue': [1, 2, 3]}],"
                    "'objective': {'minimise': 'clamp_mass'},"
                    "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': 0.09}]",
                    &c)) {
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        CHECK(t, study_reasons(&c, 1, "ranks 1 by least clamp_mass"));
    }
    study_free(&c);
}

/* How many of three combinations meet a limit is told, whether all, some or none do. */
static void discrete__how_many_combinations_meet_the_goals_is_told(mt_test *t)
{
    static const char *const limits[] = {"0.5", "1.5", "2.5", "3.5"};
    static const char *const words[] = {
        ("all 3 combinations of catalogue values were judged, 3 of "
         "them meet all goals"),
        "2 of them meet all goals", "1 of them meets all goals",
        "None of the 3 combinations of catalogue values meets"};
    for (int i = 0; i < MT_COUNT(limits); i++) {
        char members[400];
        study_case c;
        (void)snprintf(members, sizeof members,
                       "'variables': [{'parameter': 'k1', 'catalogue': [1, 2, 3]}],"
                       "'goals': [{'type': 'limit', 'expression': 'k1', 'at_least': %s}],"
                       "'recommendations': 3",
                       limits[i]);
        mt_test_row(t, "at least %s", limits[i]);
        if (study_solve(t, STUDY_TWO_MASSES("'k1': 2, 'k2': 1, 'm': 1", ""), members, &c)) {
            const mt_certificate *const told = enumeration(c.result);
            CHECK(t, told != NULL && told->proven && strstr(told->text, words[i]) != NULL);
            CHECK_INT(t, c.result->status, i < 3 ? MT_RESULT_SOLVED : MT_RESULT_INFEASIBLE);
        }
        study_free(&c);
    }
}

static void discrete__a_budget_is_kept(mt_test *t)
{
    six s;
    REQUIRE(t, six_begin(t, &s));
    for (int i = 0; i < SIX; i++) {
        six_catalogue(&s, i, VALUES, LN);
    }
    s.study->search.max_evaluations = 1000;
    mt_result *const r = six_solve(t, s.study, 1);
    if (r != NULL) {
        const mt_certificate *const c = enumeration(r);
        CHECK(t, r->run.evaluations <= 1000);
        CHECK(t, c != NULL && !c->proven);
        CHECK(t, r->n_warnings > 0);
    }
    mt_result_delete(r);
    six_end(&s);
}

MT_TEST_MAIN(MT_TEST(discrete__enumeration_agrees_with_brute_force),
             MT_TEST(discrete__no_combination_is_listed_twice),
             MT_TEST(discrete__that_no_combination_works_is_proven),
             MT_TEST(discrete__mixed_agrees_with_every_value_on_its_own),
             MT_TEST(discrete__that_no_combination_with_others_beside_works_is_proven),
             MT_TEST(discrete__that_none_of_too_many_combinations_works_is_proven),
             MT_TEST(discrete__the_best_of_an_expression_is_proven_within_one_per_cent),
             MT_TEST(discrete__branch_and_bound_excludes_with_certificates_and_without),
             MT_TEST(discrete__branch_and_bound_says_how_far_it_came),
             MT_TEST(discrete__without_an_enclosure_nothing_is_proven),
             MT_TEST(discrete__of_too_many_combinations_the_best_is_proven),
             MT_TEST(discrete__the_rank_says_least_of_what_begins_like_clearance),
             MT_TEST(discrete__how_many_combinations_meet_the_goals_is_told),
             MT_TEST(discrete__a_budget_is_kept))
