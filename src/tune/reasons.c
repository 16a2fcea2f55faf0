/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sentences an engineer can paste into a report: what changes, what that does, what is missed, what a demand costs, and how sure the answer is. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "tune/describe.h"
#include "tune/discrete.h"

/* Changes of a parameter below this many percent, and errors of a frequency, are not worth a number. */
static const double WORTH_SAYING_PERCENT = 1e-4;
enum { NUMBER_SIZE = 32 };

typedef struct sentences {
    const mt_problem *p;
    const mt_design *design;
    mt_result *result;
    mt_recommendation *rec;
    int capacity;
    bool failed;
} sentences;

static void say(sentences *s, const char *fmt, ...) MT_PRINTF(2, 3);

static void say(sentences *s, const char *fmt, ...)
{
    va_list args;
    const char **const grown = mt_arena_grow(&s->result->mem, s->rec->reasons,
                                             s->rec->n_reasons, &s->capacity, sizeof *grown);
    va_start(args, fmt);
    const char *const text = mt_arena_vprintf(&s->result->mem, fmt, args);
    va_end(args);
    if (grown == NULL || text == NULL) {
        s->failed = true;
        return;
    }
    s->rec->reasons = grown;
    s->rec->reasons[s->rec->n_reasons++] = text;
}

static bool unchanged(const mt_result_parameter *p)
{
    return fabs(p->change_percent) <= WORTH_SAYING_PERCENT || p->recommended == p->original;
}

static void say_change(sentences *s, const mt_result_parameter *p)
{
    const char *const unit = p->unit != NULL ? p->unit : "";
    const char *const space = p->unit != NULL ? " " : "";
    if (MT_HAS(p->change_percent)) {
        say(s, "%s %s by %.3g %%, from %.6g to %.6g%s%s.", p->name,
            p->recommended > p->original ? "rises" : "falls", fabs(p->change_percent),
            p->original, p->recommended, space, unit);
    } else {
        say(s, "%s goes from %.6g to %.6g%s%s.", p->name, p->original, p->recommended, space,
            unit);
    }
    if (p->at_bound != NULL) {
        say(s, "%s stands at its %s bound: a wider bound may give a better design.", p->name,
            p->at_bound);
    }
}

/* Parameters that stay, in one sentence: "a, b and c keep their original values." */
static void say_kept(sentences *s, int kept)
{
    const char *text = "";
    int left = kept;
    for (int i = 0; i < s->rec->n_parameters && text != NULL; i++) {
        const mt_result_parameter *const p = &s->rec->parameters[i];
        if (!unchanged(p)) {
            continue;
        }
        const char *const after = left == 2 ? " and " : ", ";
        text =
            mt_arena_printf(&s->result->mem, "%s%s%s", text, p->name, left == 1 ? "" : after);
        left--;
    }
    if (text == NULL) {
        s->failed = true;
    } else if (kept > 0 && kept == s->rec->n_parameters) {
        say(s, "The original design stays as it is.");
    } else if (kept > 0) {
        say(s, "%s keep%s original value%s.", text, kept == 1 ? "s its" : " their",
            kept == 1 ? "" : "s");
    }
}

static void say_changes(sentences *s)
{
    int kept = 0;
    for (int i = 0; i < s->rec->n_parameters; i++) {
        if (unchanged(&s->rec->parameters[i])) {
            kept++;
        } else {
            say_change(s, &s->rec->parameters[i]);
        }
    }
    say_kept(s, kept);
    for (int i = 0; i < s->result->n_undetermined; i++) {
        say(s,
            "The goals do not settle %s: they change by at most %.2g %% across its bounds, so "
            "the "
            "design keeps what it had there.",
            s->result->undetermined[i].text, s->result->undetermined[i].effect_percent);
    }
}

/* "18 Hz", with as many digits as tell it from its target. */
static const char *hz_text(double hz, char text[NUMBER_SIZE])
{
    (void)snprintf(text, NUMBER_SIZE, "%.6g", hz);
    return text;
}

/* The variable that moves this frequency most, per percent of its value. */
static void say_lever(sentences *s, const mt_result_frequency *f)
{
    double most = 0.0;
    int lever = -1;
    for (int i = 0; i < s->rec->n_parameters && f->sensitivity != NULL; i++) {
        const double one = 0.01 * f->sensitivity[i] * s->rec->parameters[i].recommended;
        if (fabs(one) > fabs(most)) {
            most = one;
            lever = i;
        }
    }
    if (lever >= 0) {
        say(s, "Its strongest lever is %s: 1 %% more of it moves it by %+.3g Hz.",
            s->rec->parameters[lever].name, most);
    }
}

/* Where a goal's frequency goes, and what becomes of the demand. */
static void say_frequency(sentences *s, const mt_result_frequency *f)
{
    char from[NUMBER_SIZE];
    char to[NUMBER_SIZE];
    char demand[3 * NUMBER_SIZE];
    const char *const name = f->name != NULL ? f->name : "";
    const char *const open = f->name != NULL ? " (" : "";
    const char *const close = f->name != NULL ? ")" : "";
    if (MT_HAS(f->target_hz) && fabs(f->error_percent) <= WORTH_SAYING_PERCENT) {
        (void)snprintf(demand, sizeof demand, "its target");
    } else if (MT_HAS(f->target_hz)) {
        (void)snprintf(demand, sizeof demand, "%+.3g %% off its target of %.6g Hz",
                       f->error_percent, f->target_hz);
    } else if (MT_HAS(f->at_least_hz) && MT_HAS(f->at_most_hz)) {
        (void)snprintf(demand, sizeof demand, "allowed from %.6g to %.6g Hz", f->at_least_hz,
                       f->at_most_hz);
    } else {
        const bool least = MT_HAS(f->at_least_hz);
        (void)snprintf(demand, sizeof demand, "at %s %.6g Hz allowed", least ? "least" : "most",
                       least ? f->at_least_hz : f->at_most_hz);
    }
    (void)hz_text(f->original_hz, from);
    (void)hz_text(f->recommended_hz, to);
    if (!MT_HAS(f->recommended_hz)) {
        say(s, "%s mode %d%s%s%s has no frequency here.", f->configuration, f->mode, open, name,
            close);
    } else if (!MT_HAS(f->original_hz)) {
        say(s, "%s mode %d%s%s%s comes to %s Hz, %s.", f->configuration, f->mode, open, name,
            close, to, demand);
    } else if (strcmp(from, to) == 0) {
        say(s, "%s mode %d%s%s%s stays at %s Hz, %s.", f->configuration, f->mode, open, name,
            close, to, demand);
    } else {
        say(s, "%s mode %d%s%s%s moves from %s to %s Hz, %s.", f->configuration, f->mode, open,
            name, close, from, to, demand);
    }
}

static void say_frequencies(sentences *s)
{
    for (int i = 0; i < s->rec->n_frequencies; i++) {
        const mt_result_frequency *const f = &s->rec->frequencies[i];
        const bool goal =
            MT_HAS(f->target_hz) || MT_HAS(f->at_least_hz) || MT_HAS(f->at_most_hz);
        if (!goal) {
            continue;
        }
        say_frequency(s, f);
        if (f->repeated) {
            say(s, "It is a repeated mode and has no sensitivity of its own.");
        } else {
            say_lever(s, f);
        }
    }
}

static void say_violations(sentences *s)
{
    for (int i = 0; i < s->rec->n_goals; i++) {
        const mt_result_goal *const g = &s->rec->goals[i];
        if (!g->weighted && !g->met) {
            say(s, "Goal %s (%s) is missed by %.3g %%.", g->pointer, g->text,
                g->violation_percent);
        }
    }
}

/* The first objective has a unit in which prices make sense. */
static bool has_prices(const sentences *s)
{
    const mt_objective_type type = s->p->aims[s->design->stage].type;
    return s->rec->feasible && (type == MT_OBJECTIVE_MASS || type == MT_OBJECTIVE_EXPRESSION);
}

static const char *price_unit(const sentences *s)
{
    return s->p->aims[s->design->stage].type == MT_OBJECTIVE_MASS ? " kg" : "";
}

/* What one percent less of each demand would save: its multiplier. */
static void say_prices(sentences *s)
{
    const mt_nlp_solution *const found = s->design->found;
    for (int i = 0; i < s->p->n_demands && has_prices(s); i++) {
        const mt_demand *const d = &s->p->demands[i];
        for (int k = 0; k < d->n_in; k++) {
            const double saved = 0.01 * found->mult_in[d->row_in + k];
            if (saved > 0.0) {
                say(s, "Goal %s (%s) has a price: giving way by 1 %% would save %.3g%s.",
                    s->rec->goals[i].pointer, s->rec->goals[i].text, saved, price_unit(s));
            }
        }
        const double price = d->row_eq >= 0 ? 0.01 * found->mult_eq[d->row_eq] : nan("");
        if (fabs(price) > 0.0) {
            say(s,
                "Goal %s (%s) has a price: raising what it asks for by 1 %% would cost %.3g%s.",
                s->rec->goals[i].pointer, s->rec->goals[i].text, price, price_unit(s));
        }
    }
}

/* What one percent more room at an active bound is worth: the multiplier, chained to the parameter. */
static void say_bounds(sentences *s)
{
    const mt_nlp_solution *const found = s->design->found;
    for (int i = 0; i < s->p->n && has_prices(s); i++) {
        const double scale = s->p->scale[i];
        const double dt =
            MT_HAS(scale) ? 0.01 * fabs(s->rec->parameters[i].recommended) / scale : 0.01;
        const double saved = fabs(found->mult_bound[i]) * dt;
        if (found->bound[i] != 0 && saved > 0.0) {
            say(s, "Moving the %s bound of %s outwards by 1 %% would save %.3g%s.",
                found->bound[i] < 0 ? "lower" : "upper", s->rec->parameters[i].name, saved,
                price_unit(s));
        }
    }
}

/* Root mean square of the weighted goals' errors, each weighted as in the study: |r| / sqrt(sum w), in percent. */
static void say_misfit(sentences *s)
{
    int weighted = 0;
    for (int i = 0; i < s->rec->n_goals; i++) {
        weighted += s->rec->goals[i].weighted ? 1 : 0;
    }
    if (weighted > 0 && MT_HAS(s->rec->misfit)) {
        say(s, "The misfit is %.3g %% rms over %d weighted goal%s.",
            100.0 * s->rec->misfit / sqrt(s->p->weights), weighted, weighted == 1 ? "" : "s");
    }
}

static const char *aim_text(const mt_aim *a)
{
    switch (a->type) {
    case MT_OBJECTIVE_CHANGE:
        return "change";
    case MT_OBJECTIVE_MASS:
        return "mass";
    case MT_OBJECTIVE_EXPRESSION:
        return a->objective->expression_text;
    case MT_OBJECTIVE_MISFIT:
        return "misfit";
    case MT_OBJECTIVE_NONE:
    case MT_OBJECTIVE_CLEARANCE:
        break;
    }
    return "objective";
}

static void say_rank(sentences *s, const mt_nlp_result *search)
{
    const char *const first = aim_text(&s->p->aims[0]);
    if (s->design->discrete != NULL) {
        const char *const text = mt_discrete_rank_text(s->design->discrete, search,
                                                       s->rec->rank, first, &s->result->mem);
        say(s, "%s", text == NULL ? "" : text);
        return;
    }
    if (search->compromise) {
        say(s,
            "No design within the bounds meets all goals exactly (%d starts, sampled, not "
            "proven); this one %s.",
            search->starts,
            s->rec->rank == 1 ? "comes nearest"
                              : "is a place from which only worse ones are near");
    } else if (search->n_solutions == 1) {
        say(s, "It is the only design that %d start%s found (sampled, not proven).",
            search->starts, search->starts == 1 ? "" : "s");
    } else {
        say(s, "It ranks %d of %d distinct designs found from %d starts, by least %s.",
            s->rec->rank, search->n_solutions, search->starts, first);
    }
    for (int k = 1; k <= s->design->stage; k++) {
        say(s, "With the least %s held, it has the least %s near it.", first,
            aim_text(&s->p->aims[k]));
    }
    if (s->rec->singular) {
        say(s, "It is a double solution: two designs that meet the goals coincide here, so "
               "small errors in the targets move it far.");
    }
}

mt_status mt_describe_reasons(const mt_problem *p, const mt_design *design,
                              const mt_nlp_result *search, mt_result *result,
                              mt_recommendation *rec, mt_err *err)
{
    sentences s = {.p = p, .design = design, .result = result, .rec = rec};
    say_changes(&s);
    say_frequencies(&s);
    say_violations(&s);
    say_prices(&s);
    say_bounds(&s);
    say_misfit(&s);
    say_rank(&s, search);
    return s.failed ? mt_fail_memory(err) : MT_OK;
}
