/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sentences an engineer can paste into a report. */
#include <math.h>
#include <stdarg.h>
#include <string.h>

#include "tune/describe.h"

typedef struct sentences {
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

/* Changes below this many percent are not worth a sentence. */
static const double WORTH_SAYING_PERCENT = 1e-4;

static void say_changes(sentences *s)
{
    int unchanged = 0;
    for (int i = 0; i < s->rec->n_parameters; i++) {
        const mt_result_parameter *const p = &s->rec->parameters[i];
        const char *const unit = p->unit != NULL ? p->unit : "";
        const char *const space = p->unit != NULL ? " " : "";
        if (fabs(p->change_percent) <= WORTH_SAYING_PERCENT) {
            unchanged++;
        } else if (p->change_percent == p->change_percent) {
            say(s, "%s %s by %.2f %%, from %.6g to %.6g%s%s.", p->name,
                p->change_percent > 0.0 ? "rises" : "falls", fabs(p->change_percent),
                p->original, p->recommended, space, unit);
        } else {
            say(s, "%s goes from %.6g to %.6g%s%s.", p->name, p->original, p->recommended,
                space, unit);
        }
        if (p->at_bound != NULL) {
            say(s, "%s stands at its %s bound: a wider bound may give a better design.",
                p->name, p->at_bound);
        }
    }
    if (unchanged > 0 && unchanged == s->rec->n_parameters) {
        say(s, "The original design stays as it is.");
    }
}

static void say_frequencies(sentences *s)
{
    for (int i = 0; i < s->rec->n_frequencies; i++) {
        const mt_result_frequency *const f = &s->rec->frequencies[i];
        const char *const name = f->name != NULL ? f->name : "";
        const char *const open = f->name != NULL ? " (" : "";
        const char *const close = f->name != NULL ? ")" : "";
        if (f->target_hz == f->target_hz) {
            say(s,
                "%s mode %d%s%s%s moves from %.5g to %.5g Hz (target %.5g Hz, error %+.2g %%).",
                f->configuration, f->mode, open, name, close, f->original_hz, f->recommended_hz,
                f->target_hz, f->error_percent);
        } else if (f->at_least_hz == f->at_least_hz || f->at_most_hz == f->at_most_hz) {
            const bool least = f->at_least_hz == f->at_least_hz;
            say(s, "%s mode %d%s%s%s moves from %.5g to %.5g Hz (at %s %.5g Hz).",
                f->configuration, f->mode, open, name, close, f->original_hz, f->recommended_hz,
                least ? "least" : "most", least ? f->at_least_hz : f->at_most_hz);
        }
        if (f->repeated) {
            say(s, "%s mode %d is a repeated mode: it has no sensitivity of its own.",
                f->configuration, f->mode);
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

/* What one unit more on an active bound is worth: the multiplier, in the units of objective and parameter. */
static void say_bounds(sentences *s, const mt_problem *p, const mt_nlp_solution *found)
{
    for (int i = 0; i < p->n && s->rec->feasible; i++) {
        const double m = found->mult_bound[i];
        if (found->bound[i] == 0 || !(fabs(m) > 0.0) ||
            (p->objective != MT_OBJECTIVE_MASS && p->objective != MT_OBJECTIVE_EXPRESSION)) {
            continue;
        }
        const double dx = MT_HAS(p->scale[i]) ? p->scale[i] : s->rec->parameters[i].recommended;
        say(s,
            "Moving the %s bound of %s outwards by 1 %% of its value changes the objective by "
            "%.3g%s%s.",
            found->bound[i] < 0 ? "lower" : "upper", s->rec->parameters[i].name,
            -fabs(m) * 0.01 *
                (MT_HAS(p->scale[i]) ? s->rec->parameters[i].recommended / dx : 1.0),
            s->rec->score_unit[0] != '\0' ? " " : "", s->rec->score_unit);
    }
}

static void say_rank(sentences *s, const mt_problem *p, const mt_nlp_result *search)
{
    const char *const what = p->objective == MT_OBJECTIVE_CHANGE   ? "smallest change"
                             : p->objective == MT_OBJECTIVE_MASS   ? "smallest mass"
                             : p->objective == MT_OBJECTIVE_MISFIT ? "smallest misfit"
                                                                   : "smallest objective";
    if (search->compromise) {
        say(s,
            "No design within the bounds meets all goals exactly (%d starts, sampled, not "
            "proven); this one comes nearest.",
            search->starts);
    } else if (s->rec->rank == 1 && search->n_solutions == 1) {
        say(s,
            "It is the only design that %d starts found to meet the goals (sampled, not "
            "proven).",
            search->starts);
    } else {
        say(s, "It ranks %d of %d distinct designs found from %d starts, by %s.", s->rec->rank,
            search->n_solutions, search->starts, what);
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
    sentences s = {.result = result, .rec = rec};
    say_changes(&s);
    say_frequencies(&s);
    say_violations(&s);
    say_bounds(&s, p, design->found);
    say_rank(&s, p, search);
    return s.failed ? mt_fail_memory(err) : MT_OK;
}
