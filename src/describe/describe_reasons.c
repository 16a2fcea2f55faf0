/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sentences an engineer can paste into a report: what changes, what that does, what is missed,
 * what a requirement costs, and how sure the answer is. */
#include "describe/describe_reasons_priv.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

#include "base/format.h"
#include "base/number.h"
#include "describe/certificates.h"
#include "describe/describe_catalogue_search.h"

/* Changes of a parameter below this many percent, and errors of a frequency, are not worth a
 * number. */
static const double WORTH_SAYING_PERCENT = 1e-4;
enum { NUMBER_SIZE = 32, REQUIREMENT_SIZE = 128 };

void mt_sentence_of(mt_sentences *s, const char *kind, const char *about)
{
    s->of = (mt_reason){.kind = kind, .about = about};
}

void mt_add_sentence(mt_sentences *s, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    const char *const text = mt_arena_vprintf(&s->result->mem, fmt, args);
    va_end(args);
    mt_reason *const grown = mt_arena_grow(&s->result->mem, s->rec->reasons, s->rec->n_reasons,
                                           &s->capacity, sizeof *grown);
    if (grown != NULL) {
        s->rec->reasons = grown;
        grown[s->rec->n_reasons] = s->of;
        grown[s->rec->n_reasons++].text = text;
    }
}

static bool unchanged(const mt_result_parameter *p)
{
    return fabs(p->change_percent) <= WORTH_SAYING_PERCENT || p->recommended == p->original;
}

static void write_change(mt_sentences *s, const mt_result_parameter *p)
{
    const char *const name = p->display_unit != NULL ? p->display_unit : p->unit;
    const char *const unit = name != NULL ? name : "";
    const char *const space = name != NULL ? " " : "";
    const double original = mt_result_shown(p->original, p->display_factor);
    const double recommended = mt_result_shown(p->recommended, p->display_factor);
    mt_sentence_of(s, "change", p->name);
    if (isfinite(p->change_percent)) { /* not of what was 0, or next to it */
        mt_add_sentence(s, "%s %s by %.3g %%, from %.6g to %.6g%s%s.", p->name,
                        p->recommended > p->original ? "rises" : "falls",
                        fabs(p->change_percent), original, recommended, space, unit);
    } else {
        mt_add_sentence(s, "%s goes from %.6g to %.6g%s%s.", p->name, original, recommended,
                        space, unit);
    }
    if (p->at_bound != NULL) {
        mt_sentence_of(s, "hold", p->name);
        mt_add_sentence(s, "%s stands at its %s bound: a wider bound may give a better design.",
                        p->name, p->at_bound);
    }
}

const char *mt_add_listed_sentences(mt_sentences *s, const char *list, const char *name,
                                    int left)
{
    const char *const behind = left == 0 ? "" : left == 1 ? " and " : ", ";
    return mt_arena_printf(&s->result->mem, "%s%s%s", list, name, behind);
}

/* Parameters that stay, in one sentence: "a, b and c keep their original values." */
static void write_kept(mt_sentences *s, int kept)
{
    const char *text = "";
    int left = kept;
    for (int i = 0; i < s->rec->n_parameters; i++) {
        const mt_result_parameter *const p = &s->rec->parameters[i];
        if (!unchanged(p)) {
            continue;
        }
        text = mt_add_listed_sentences(s, text, p->name, --left);
    }
    mt_sentence_of(s, "change", NULL);
    if (kept > 0 && kept == s->rec->n_parameters) {
        mt_add_sentence(s, "The original design stays as it is.");
    } else if (kept > 0) {
        mt_add_sentence(s, "%s keep%s original value%s.", text, kept == 1 ? "s its" : " their",
                        kept == 1 ? "" : "s");
    }
}

static void write_changes(mt_sentences *s)
{
    int kept = 0;
    for (int i = 0; i < s->rec->n_parameters; i++) {
        if (unchanged(&s->rec->parameters[i])) {
            kept++;
        } else {
            write_change(s, &s->rec->parameters[i]);
        }
    }
    write_kept(s, kept);
    for (int i = 0; i < s->result->n_unidentifiable; i++) {
        mt_add_sentence(
            s,
            "Not identifiable: %s changes no goal by more than %.3g %% across its bounds "
            "and keeps its original value.",
            s->result->unidentifiable[i].text,
            fmax(s->result->unidentifiable[i].effect_percent, MT_PERCENT_NOISE));
    }
}

/* A little more of a variable: 1 % of its value; of a coordinate, whose zero means nothing,
 * 1 mm or 1 degree, as changes of it are measured on a linear scale. */
static double little_more(const mt_result_parameter *p, const char **text)
{
    static const double DEGREE = 3.14159265358979323846 / 180.0;
    const bool linear = strcmp(p->measure, "linear") == 0;
    if (linear && p->unit != NULL && strcmp(p->unit, "m") == 0) {
        *text = "1 mm";
        return 1e-3;
    }
    if (linear && p->unit != NULL && strcmp(p->unit, "rad") == 0) {
        *text = "1 degree";
        return DEGREE;
    }
    *text = "1 %";
    return 0.01 * fabs(p->recommended);
}

/* The variable that moves this frequency most, the first of equal ones, by a little more of it:
 * "; M_SAU moves it most, -0.0494 Hz for 1 % more". "": none does by more than rounding, or the
 * frequency has no derivative. */
static const char *lever_text(mt_sentences *s, const mt_result_frequency *f)
{
    double most = 0.0;
    int lever = -1;
    const char *by = "";
    for (int i = 0; i < s->rec->n_parameters && f->sensitivity != NULL && !f->repeated; i++) {
        const char *text = NULL;
        const double one = f->sensitivity[i] * little_more(&s->rec->parameters[i], &text);
        const bool noise = fabs(one) <= MT_SLOPE_NOISE * f->recommended_hz;
        if (isfinite(one) && !noise && mt_exceeds(fabs(one), fabs(most))) {
            most = one;
            lever = i;
            by = text;
        }
    }
    if (lever < 0) {
        return "";
    }
    return mt_arena_printf(&s->result->mem, "; %s moves it most, %+.3g Hz for %s more",
                           s->rec->parameters[lever].name, most, by);
}

/* Text of the position of the frequency (over the tolerances: its worst) relative to the nearer
 * limit, the lower one in the middle: "at its lower limit", "2 % below its lower limit of 7
 * Hz". */
static void limit_text(const mt_result_frequency *f, char *text)
{
    const bool both = MT_HAS(f->at_least_hz) && MT_HAS(f->at_most_hz);
    const bool range = MT_HAS(f->lowest_hz) && MT_HAS(f->highest_hz);
    const double lowest = range ? f->lowest_hz : f->recommended_hz;
    const double highest = range ? f->highest_hz : f->recommended_hz;
    const double low = MT_HAS(f->at_least_hz) ? log(lowest / f->at_least_hz) : HUGE_VAL;
    const double high = MT_HAS(f->at_most_hz) ? mt_log_ratio(f->at_most_hz, highest) : HUGE_VAL;
    const bool lower = MT_HAS(f->at_least_hz) && !mt_exceeds(low, high);
    const double error = 100.0 * (lower ? -expm1(low) : expm1(-high));
    const char *const side = lower ? "lower" : "upper";
    const double limit = lower ? f->at_least_hz : f->at_most_hz;
    if (!(f->recommended_hz > 0.0) && MT_HAS(f->at_least_hz)) {
        (void)mt_snprintf(text, REQUIREMENT_SIZE, "far below its lower limit of %.6g Hz",
                          f->at_least_hz);
    } else if (fabs(fmin(low, high)) <= 0.01 * WORTH_SAYING_PERCENT) {
        (void)mt_snprintf(text, REQUIREMENT_SIZE, "at its %s limit", side);
    } else if (isinf(error)) {
        (void)mt_snprintf(text, REQUIREMENT_SIZE, "far %s its %s limit of %.6g Hz",
                          lower ? "below" : "above", side, limit);
    } else if (error > WORTH_SAYING_PERCENT) {
        (void)mt_snprintf(text, REQUIREMENT_SIZE, "%.3g %% %s its %s limit of %.6g Hz", error,
                          lower ? "below" : "above", side, limit);
    } else if (both) {
        (void)mt_snprintf(text, REQUIREMENT_SIZE, "between its limits of %.6g and %.6g Hz",
                          f->at_least_hz, f->at_most_hz);
    } else {
        (void)mt_snprintf(text, REQUIREMENT_SIZE, "clear of its %s limit of %.6g Hz", side,
                          limit);
    }
}

static void requirement_text(const mt_result_frequency *f, char *text)
{
    if (!MT_HAS(f->target_hz)) {
        limit_text(f, text);
    } else if (fabs(f->error_percent) <= WORTH_SAYING_PERCENT) {
        (void)mt_snprintf(text, REQUIREMENT_SIZE, "its target");
    } else if (!isfinite(f->error_percent)) {
        (void)mt_snprintf(text, REQUIREMENT_SIZE, "far %s its target of %.6g Hz",
                          f->error_percent > 0.0 ? "above" : "below", f->target_hz);
    } else {
        (void)mt_snprintf(text, REQUIREMENT_SIZE, "%.3g %% %s its target of %.6g Hz",
                          fabs(f->error_percent), f->error_percent > 0.0 ? "above" : "below",
                          f->target_hz);
    }
}

/* Write the change of a goal's frequency, how it meets the requirement, and the most
 * influential variable. */
static void write_frequency(mt_sentences *s, const mt_result_frequency *f)
{
    char from[NUMBER_SIZE];
    char to[NUMBER_SIZE];
    char requirement[REQUIREMENT_SIZE];
    const char *const name = f->name != NULL ? f->name : "";
    const char *const open = f->name != NULL ? " (" : "";
    const char *const close = f->name != NULL ? ")" : "";
    requirement_text(f, requirement);
    const char *const range =
        MT_HAS(f->lowest_hz) && MT_HAS(f->highest_hz)
            ? mt_arena_printf(&s->result->mem, ", over the tolerances %.6g to %.6g Hz",
                              f->lowest_hz, f->highest_hz)
            : "";
    (void)mt_snprintf(from, sizeof from, "%.6g", f->original_hz);
    (void)mt_snprintf(to, sizeof to, "%.6g", f->recommended_hz);
    const char *const lever = lever_text(s, f);
    if (!MT_HAS(f->original_hz)) {
        mt_add_sentence(s, "%s mode %d%s%s%s comes to %s Hz%s, %s%s.", f->configuration,
                        f->mode, open, name, close, to, range, requirement, lever);
    } else if (strcmp(from, to) == 0) {
        mt_add_sentence(s, "%s mode %d%s%s%s stays at %s Hz%s, %s%s.", f->configuration,
                        f->mode, open, name, close, to, range, requirement, lever);
    } else {
        mt_add_sentence(s, "%s mode %d%s%s%s moves from %s to %s Hz%s, %s%s.", f->configuration,
                        f->mode, open, name, close, from, to, range, requirement, lever);
    }
    if (f->repeated) {
        mt_add_sentence(s, "It is a repeated mode and has no sensitivity of its own.");
    }
}

static void say_warning(mt_sentences *s)
{
    if (s->rec->disagreement != NULL) {
        mt_sentence_of(s, "change", NULL);
        mt_add_sentence(s, "NOT VERIFIED, do not use: %s.", s->rec->disagreement);
    }
}

/* Vibrations of 0 Hz. */
static void write_slack(mt_sentences *s)
{
    mt_sentence_of(s, "hold", NULL);
    for (int i = 0; i < s->rec->n_frequencies; i++) {
        const mt_result_frequency *const f = &s->rec->frequencies[i];
        const bool some = f->slack != NULL && f->slack[0] != '\0';
        if (f->slack != NULL) {
            mt_add_sentence(s, "%s mode %d is at 0 Hz: nothing holds it at this design%s%s%s.",
                            f->configuration, f->mode, some ? " (the stiffness of " : "",
                            some ? f->slack : "", some ? " is 0)" : "");
        }
    }
}

static void write_frequencies(mt_sentences *s)
{
    mt_sentence_of(s, "change", NULL);
    for (int i = 0; i < s->rec->n_frequencies; i++) {
        const mt_result_frequency *const f = &s->rec->frequencies[i];
        const bool asked =
            MT_HAS(f->target_hz) || MT_HAS(f->at_least_hz) || MT_HAS(f->at_most_hz);
        if (asked && MT_HAS(f->recommended_hz)) { /* else its goal has no value */
            write_frequency(s, f);
        }
    }
}

static void write_violations(mt_sentences *s)
{
    for (int i = 0; i < s->rec->n_goals; i++) {
        const mt_result_goal *const g = &s->rec->goals[i];
        mt_sentence_of(s, "hold", g->pointer);
        if (g->doubtful && !g->weighted) {
            mt_add_sentence(
                s, "Goal %s (%s) does not count as met: it is not certain which mode it is.",
                g->pointer, g->text);
        } else if (!g->weighted && !g->met && !MT_HAS(g->violation_percent)) {
            mt_add_sentence(s, "Goal %s (%s) has no value here and does not count as met.",
                            g->pointer, g->text);
        } else if (!g->weighted && !g->met && isfinite(g->violation_percent)) {
            mt_add_sentence(s, "Goal %s (%s) is missed by %.3g %%.", g->pointer, g->text,
                            g->violation_percent);
        } else if (!g->weighted && !g->met) {
            mt_add_sentence(s, "Goal %s (%s) is missed by far.", g->pointer, g->text);
        }
    }
}

/* Write where responses deviate most from their measurements. */
static void write_lines(mt_sentences *s)
{
    for (int i = 0; i < s->rec->n_goals; i++) {
        const mt_result_goal *const g = &s->rec->goals[i];
        if (isfinite(g->off_most_hz) && isfinite(g->off_most_ratio)) {
            mt_sentence_of(s, "rank", g->pointer);
            mt_add_sentence(
                s,
                "%s: deviation %.3g %% rms, most at %.6g Hz, where the response is %.4g times "
                "what was measured and its phase %+.3g deg from it.",
                g->text, 100.0 * g->value, g->off_most_hz, g->off_most_ratio,
                g->off_most_phase_deg);
        }
    }
}

/* Write the forced responses; texts begin with "the". */
static void write_responses(mt_sentences *s)
{
    for (int i = 0; i < s->rec->n_responses; i++) {
        const mt_result_response *const r = &s->rec->responses[i];
        mt_sentence_of(s, "hold", r->pointer);
        mt_add_sentence(s, "T%s.", r->text + 1);
    }
    for (int i = 0; i < s->rec->n_between; i++) {
        const mt_result_between *const r = &s->rec->between[i];
        mt_sentence_of(s, "hold", r->pointer);
        mt_add_sentence(s, "Between the named positions %s.", r->text);
    }
}

/* Write the root mean square deviation of the weighted goals in percent, each weighted as in
 * the study. */
static void write_misfit(mt_sentences *s)
{
    int weighted = 0;
    double sum = 0.0;
    for (int i = 0; i < s->p->n_requirements; i++) {
        const mt_result_goal *const g = &s->rec->goals[i];
        if (s->p->requirements[i].role == MT_ROLE_RESIDUAL) {
            weighted++;
            sum += s->p->requirements[i].goal->weight * g->violation_percent *
                   g->violation_percent;
        }
    }
    write_lines(s);
    mt_sentence_of(s, "rank", NULL);
    if (weighted > 0 && MT_HAS(s->rec->misfit) && isfinite(sum)) {
        mt_add_sentence(s, "The %d weighted goal%s deviate%s by %.3g %% rms.", weighted,
                        weighted == 1 ? "" : "s", weighted == 1 ? "s" : "",
                        mt_without_noise(sqrt(sum / s->p->weights), MT_PERCENT_NOISE));
    }
}

static const char *stage_text(const mt_objective_stage *a)
{
    return mt_objective_is(a->type, MT_WORD) ? mt_objective_kind_of(a->type)->name
           : a->objective != NULL            ? a->objective->expression_text
                                             : "objective";
}

static const char *optimum_word(const mt_objective_stage *a)
{
    return mt_objective_is(a->type, MT_MAXIMISED) ? "greatest" : "least";
}

/* Write the rank among mode placements that avoid the bands. */
static void write_kind_rank(mt_sentences *s, const char *first)
{
    const mt_mode_placement_result *const g = s->design->placements;
    const char *const sure = mt_describe_placements_left(g, &s->result->mem);
    if (mt_describe_placements_unsearched(g)) {
        mt_add_sentence(
            s,
            "It ranks %d of the %d mode placements that were found to meet all goals, of "
            "%.0f in all, by %s %s (%s).",
            s->rec->rank, g->n_solutions, g->n_possible, optimum_word(&s->p->stages[0]), first,
            sure);
    } else if (g->n_solutions == 1) {
        mt_add_sentence(s,
                        "It is the only one of %.0f mode placements that meets all goals (%s).",
                        g->n_possible, sure);
    } else {
        mt_add_sentence(
            s,
            "It ranks %d of the %d mode placements that meet all goals, of %.0f in all, by "
            "%s %s (%s).",
            s->rec->rank, g->n_solutions, g->n_possible, optimum_word(&s->p->stages[0]), first,
            sure);
    }
}

/* Write that one design was found: where it is isolated, the only one; else nearby designs meet
 * the goals, too, and it is the best of them. */
static void write_only(mt_sentences *s, const mt_nlp_result *search, const char *first)
{
    const char *const many = search->starts == 1 ? "" : "s";
    if (MT_HAS(s->rec->kkt_residual) && mt_describe_is_optimum(s->rec)) {
        mt_add_sentence(
            s,
            "It is the only local optimum, by %s %s, that %d start%s found (sampled, not "
            "proven).",
            optimum_word(&s->p->stages[0]), first, search->starts, many);
    } else {
        mt_add_sentence(s, "It is the only design that %d start%s found (sampled, not proven).",
                        search->starts, many);
    }
}

static void write_optimality(mt_sentences *s)
{
    mt_sentence_of(s, "rank", NULL);
    if (s->rec->feasible && !mt_describe_is_optimum(s->rec)) {
        mt_add_sentence(
            s,
            "It is not shown to be a local optimum: its KKT residual is %.2g, where an optimum "
            "has 0; a design near it may be better.",
            s->rec->kkt_residual);
    }
}

/* One of several local minima of a misfit. */
static void write_minimum(mt_sentences *s, const mt_nlp_result *search)
{
    const double least = mt_without_noise(sqrt(2.0 * search->solutions[0].f), MT_RATIO_NOISE);
    const double own = mt_without_noise(s->rec->misfit, MT_RATIO_NOISE);
    const double ratio = least > 0.0 ? own / least : HUGE_VAL;
    if (s->rec->rank > 1 && !(own > 0.0)) {
        mt_add_sentence(s, "It fits exactly, as recommendation 1 does.");
    } else if (s->rec->rank == 1) {
        mt_add_sentence(s, "Its misfit is the least of %d local minima found from %d starts.",
                        search->n_solutions, search->starts);
    } else if (isfinite(ratio)) {
        mt_add_sentence(
            s, "It is a local minimum of the misfit, %.3g times that of recommendation 1.",
            ratio);
    } else {
        mt_add_sentence(
            s, "It is a local minimum of the misfit, where recommendation 1 has none.");
    }
}

static void write_rank(mt_sentences *s, const mt_nlp_result *search)
{
    const char *const first = stage_text(&s->p->stages[0]);
    mt_sentence_of(s, "rank", NULL);
    if (s->design->unsearched) {
        mt_add_sentence(
            s, "The original design meets all goals, so no design changes less. Others were "
               "not searched, as the study asks for none.");
        return;
    }
    if (s->design->discrete != NULL) {
        mt_arena *const mem = &s->result->mem;
        const char *const by =
            mt_arena_printf(mem, "%s %s", optimum_word(&s->p->stages[0]), first);
        mt_add_sentence(
            s, "%s", mt_describe_rank_text(s->design->discrete, search, s->rec->rank, by, mem));
        return;
    }
    if (search->compromise) {
        mt_add_sentence(
            s, "None of the designs that %d start%s found meets all goals; this one %s.",
            search->starts, search->starts == 1 ? "" : "s",
            s->rec->rank == 1 ? "comes nearest"
                              : "has the least deviation of all designs near it");
    } else if (s->design->placements != NULL) {
        write_kind_rank(s, first);
    } else if (search->n_solutions == 1 && s->design->found->continuum) {
        mt_add_sentence(
            s, "It is one of a continuum of equally good designs that %d start%s found.",
            search->starts, search->starts == 1 ? "" : "s");
    } else if (search->n_solutions == 1) {
        write_only(s, search, first);
    } else if (mt_study_is_fit(s->p->study)) {
        write_minimum(s, search);
    } else {
        mt_add_sentence(s, "It ranks %d of %d distinct designs found from %d starts, by %s %s.",
                        s->rec->rank, search->n_solutions, search->starts,
                        optimum_word(&s->p->stages[0]), first);
    }
    if (s->design->found->continuum && !search->compromise) {
        mt_add_sentence(
            s,
            "A continuum of designs is as good as this one: those between it and others "
            "that were found meet all goals, too, and have the same %s.",
            first);
    }
    for (int k = 1; k <= s->design->stage; k++) {
        mt_add_sentence(s, "With the %s %s held, it has the %s %s near it.",
                        optimum_word(&s->p->stages[0]), first, optimum_word(&s->p->stages[k]),
                        stage_text(&s->p->stages[k]));
    }
    if (s->rec->singular) {
        mt_add_sentence(
            s, "It is a double solution: two designs that meet the goals coincide here, so "
               "small errors in the targets move it far.");
    }
}

mt_status mt_describe_baseline_reasons(const mt_problem *p, mt_result *result, mt_err *err)
{
    const mt_design original = {.t = p->whole.origin_t};
    mt_sentences s = {.p = p, .design = &original, .result = result, .rec = &result->baseline};
    say_warning(&s);
    write_slack(&s);
    write_violations(&s);
    write_responses(&s);
    mt_add_bands_sentences(&s);
    return mt_arena_check(&result->mem, err);
}

mt_status mt_describe_reasons(const mt_problem *p, const mt_design *design,
                              const mt_nlp_result *search, mt_result *result,
                              mt_recommendation *rec, mt_err *err)
{
    mt_sentences s = {.p = p, .design = design, .result = result, .rec = rec};
    say_warning(&s);
    write_changes(&s);
    write_slack(&s);
    write_frequencies(&s);
    mt_add_worst_sentences(&s);
    write_violations(&s);
    write_responses(&s);
    mt_add_bands_sentences(&s);
    if (design->cut) {
        mt_sentence_of(&s, "rank", NULL);
        mt_add_sentence(&s, "The search was interrupted: better designs may exist.");
        return mt_arena_check(&result->mem, err);
    }
    mt_add_prices_sentences(&s);
    write_misfit(&s);
    write_rank(&s, search);
    write_optimality(&s);
    return mt_arena_check(&result->mem, err);
}
