/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/question.h"

#include <string.h>

#include "base/base.h"

enum { NAMED = 4 }; /* of variables, requirements and configurations: more are counted */

/* Before item i of n: nothing, ", " or " and ". */
static const char *joint(int i, int n)
{
    return i == 0 ? "" : i + 1 < n ? ", " : " and ";
}

static void add_variables(const mt_result *result, mt_text *out)
{
    const int n = result->n_variables;
    if (n > NAMED) {
        mt_text_addf(out, "the %d variables", n);
    }
    for (int i = 0; i < n && n <= NAMED; i++) {
        mt_text_addf(out, "%s%s", joint(i, n), result->variables[i]);
    }
}

/* The requirement in words: "at 18 Hz", "clear of 2 bands". */
static const char *requirement_of(const mt_result_goal *g)
{
    const size_t n = strlen(g->quantity);
    return strncmp(g->text, g->quantity, n) == 0 ? g->text + n : "";
}

/* True where both rows belong to one goal of the study in several configurations: bands between
 * positions of a drive have the requirement of the positions. */
static bool asks_the_same(const mt_result_goal *a, const mt_result_goal *b)
{
    const bool motion = strcmp(b->type, "avoid") == 0 && b->configuration == NULL;
    return strcmp(a->pointer, b->pointer) == 0 &&
           (motion || strcmp(requirement_of(a), requirement_of(b)) == 0);
}

static bool is_first(const mt_recommendation *r, int i)
{
    for (int k = 0; k < i; k++) {
        if (asks_the_same(&r->goals[k], &r->goals[i])) {
            return false;
        }
    }
    return true;
}

/* "fwd mode 1 and aft mode 1 at least 20 Hz" */
static void add_requirement(const mt_recommendation *r, int first, mt_text *out)
{
    int n = 0;
    int told = 0;
    for (int i = first; i < r->n_goals; i++) {
        n += asks_the_same(&r->goals[first], &r->goals[i]) ? 1 : 0;
    }
    for (int i = first; i < r->n_goals && told < n && told < NAMED; i++) {
        if (asks_the_same(&r->goals[first], &r->goals[i])) {
            const int listed = n > NAMED ? NAMED + 1 : n;
            mt_text_addf(out, "%s%s", joint(told, listed), r->goals[i].quantity);
            told++;
        }
    }
    if (n > told) {
        mt_text_addf(out, " and %d others", n - told);
    }
    mt_text_add(out, requirement_of(&r->goals[first]));
}

static void add_requirements(const mt_recommendation *r, mt_text *out)
{
    int n = 0;
    int told = 0;
    for (int i = 0; i < r->n_goals; i++) {
        n += is_first(r, i) ? 1 : 0;
    }
    if (n > NAMED) {
        mt_text_addf(out, "all %d goals", n);
    }
    for (int i = 0; i < r->n_goals && n <= NAMED; i++) {
        if (is_first(r, i)) {
            mt_text_add(out, told == 0 ? "" : told + 1 < n ? "; " : "; and ");
            add_requirement(r, i, out);
            told++;
        }
    }
}

/* ", with the least mass of bar_*" */
static void add_objectives(const mt_result *result, mt_text *out)
{
    for (int i = 0; i < result->n_objectives; i++) {
        const mt_result_objective *const o = &result->objectives[i];
        const bool change = strcmp(o->type, "change") == 0;
        const bool clearance = strcmp(o->type, "clearance") == 0;
        mt_text_addf(out, "%s the %s %s", i == 0 ? ", with" : ", then",
                     clearance ? "greatest" : "least", change ? "total change" : o->text);
    }
}

static bool is_fit(const mt_recommendation *r)
{
    for (int i = 0; i < r->n_goals; i++) {
        if (!r->goals[i].weighted) {
            return false;
        }
    }
    return r->n_goals > 0;
}

/* The verb for the goals: a design fits data, keeps clear of bands, or holds numbers. */
static const char *verb_of(const mt_recommendation *r)
{
    bool bands = true;
    for (int i = 0; i < r->n_goals; i++) {
        bands = bands && strcmp(r->goals[i].type, "avoid") == 0;
    }
    return is_fit(r) ? "fit" : bands ? "keep" : "hold";
}

void mt_report_question(const mt_result *result, mt_text *out)
{
    const mt_recommendation *const r = result->baseline.n_goals > 0 ? &result->baseline
                                       : result->n_recommendations > 0
                                           ? &result->recommendations[0]
                                           : &result->baseline;
    if (r->n_goals == 0 && result->n_variables == 0) {
        mt_text_add(out, "What are the natural frequencies of the design as it is?");
        return;
    }
    if (result->n_variables == 0) {
        mt_text_addf(out, "%s the design as it is %s ", is_fit(r) ? "How well does" : "Does",
                     verb_of(r));
    } else {
        mt_text_add(out, "Which values of ");
        add_variables(result, out);
        mt_text_addf(out, " %s", r->n_goals == 0 ? "are best" : verb_of(r));
        mt_text_add(out, r->n_goals == 0 ? "" : " ");
    }
    add_requirements(r, out);
    if (result->n_variables > 0) {
        add_objectives(result, out);
    }
    mt_text_add(out, result->n_variables > 0 && is_fit(r) && result->n_objectives == 0
                         ? " best?"
                         : "?");
}
