/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Prices. At an optimum the multiplier of an active constraint is the slope of the objective
 * over its limit; limits are relative (a ratio's logarithm), bounds are in t, which is chained
 * to the parameter here. The change enters the search as half its square: dc = df / c.
 */
#include <math.h>
#include <string.h>

#include "base/number.h"
#include "describe/describe_reasons_priv.h"
#include "problem/avoidance.h"
#include "problem/configuration.h"
#include "problem/objective.h"
#include "search/mode_placements.h"
#include "search/search.h"

static const double PERCENT = 100.0;

/* Parts of a requirement [-] that a price is told for: the largest one whose worth a slope
 * tells. */
static const double parts[] = {1e-2, 1e-3, 1e-4, 1e-5};
enum { N_PARTS = sizeof parts / sizeof *parts };

static mt_price price_of(const mt_sentences *s, double df)
{
    return (mt_price){.df = df * s->p->stages[s->design->stage].size,
                      .change = s->rec->change,
                      .score = s->rec->score,
                      .first = s->design->stage == 0};
}

/* True where the design has multipliers: slopes of an objective at its optimum. */
static bool has_prices(const mt_sentences *s)
{
    const mt_objective_ops *const ops = s->p->stages[s->design->stage].ops;
    return ops->price != NULL && s->rec->feasible && mt_describe_is_optimum(s->rec);
}

/* Text of a change df of the objective's value f: "the mass by 0.12 kg". NULL: only rounding,
 * beyond the validity of a slope, not known, or out of memory. */
static const char *worth(mt_sentences *s, double df)
{
    const mt_objective_ops *const ops = s->p->stages[s->design->stage].ops;
    const mt_price q = price_of(s, df);
    const bool noise =
        !(fabs(df) > 0.0) || (q.first && fabs(q.df) <= MT_RATIO_NOISE * fabs(q.score));
    return noise || !has_prices(s) ? NULL : ops->price(&q, &s->result->mem);
}

/* Text of the gain from a relaxation of a requirement, and of its size; slope: df by the
 * logarithm of the requirement. */
static const char *relaxation_gain_text(mt_sentences *s, double slope, const char **part)
{
    const char *text = NULL;
    for (int i = 0; i < N_PARTS && text == NULL; i++) {
        text = worth(s, slope * parts[i]);
        if (text != NULL) {
            *part = mt_arena_printf(&s->result->mem, "%g %%", PERCENT * parts[i]);
        }
    }
    return *part != NULL ? text : NULL;
}

static const char *win(const mt_sentences *s)
{
    const mt_objective_type type = s->p->stages[s->design->stage].type;
    return mt_objective_is(type, MT_MAXIMISED) ? "raise" : "reduce";
}

/* A requirement that the variables hardly move: at an optimum its slope by them, the other rows
 * held, is at most that of the objective over the multiplier. */
static void write_hardly(mt_sentences *s, const mt_requirement *d, const mt_result_goal *g,
                         double slope)
{
    const mt_objective_ops *const ops = s->p->stages[s->design->stage].ops;
    const mt_price q = price_of(s, fabs(slope) / PERCENT);
    const char *const why =
        has_prices(s) && ops->hardly != NULL ? ops->hardly(&q, &s->result->mem) : NULL;
    const char *const left = why != NULL ? worth(s, fabs(slope) * d->tolerance) : NULL;
    if (left != NULL) {
        mt_add_sentence(
            s,
            "Goal %s (%s) hardly depends on the variables here: %s; what its tolerance of "
            "%.3g %% leaves open may change %s.",
            g->pointer, g->text, why, PERCENT * d->tolerance, left);
    } else if (why != NULL) {
        mt_add_sentence(s, "Goal %s (%s) hardly depends on the variables here: %s.", g->pointer,
                        g->text, why);
    }
}

/* Write the gain from a small relaxation of each requirement. */
static void say_requirements(mt_sentences *s)
{
    const mt_nlp_solution *const found = s->design->found;
    for (int i = 0; i < s->p->n_requirements; i++) {
        const mt_requirement *const d = &s->p->requirements[i];
        const mt_result_goal *const g = &s->rec->goals[i];
        const int row = mt_requirement_row(&s->p->whole, d);
        const bool target = d->role == MT_ROLE_TARGET && found->mult_eq != NULL;
        const int n_limits = d->role == MT_ROLE_LIMIT ? d->n_rows : 0;
        const char *part = NULL;
        mt_sentence_of(s, "cost", g->pointer);
        for (int k = 0; k < n_limits && found->mult_in != NULL; k++) {
            const double mult = found->mult_in[row + k];
            const char *const saved = mult > 0.0 ? relaxation_gain_text(s, mult, &part) : NULL;
            if (saved != NULL) {
                mt_add_sentence(s, "Relaxing goal %s (%s) by %s would %s %s.", g->pointer,
                                g->text, part, win(s), saved);
            }
        }
        const double slope = target ? found->mult_eq[row] : nan("");
        const char *const cost = relaxation_gain_text(s, fabs(slope), &part);
        if (cost != NULL) {
            mt_add_sentence(s, "A target %s %s in goal %s (%s) would %s %s.", part,
                            slope > 0.0 ? "lower" : "higher", g->pointer, g->text, win(s),
                            cost);
        }
        write_hardly(s, d, g, slope);
    }
}

/* Write the edges of bands that are active. */
static void write_edges(mt_sentences *s)
{
    const mt_nlp_solution *const found = s->design->found;
    mt_row row;
    mt_sentence_of(s, "cost", NULL);
    for (int i = 0; s->design->below != NULL && found->mult_in != NULL &&
                    mt_avoidance_row_at(&s->p->whole, s->design->below, i, &row);
         i++) {
        const mt_avoidance *const c = &s->p->avoidances[row.avoidance];
        const double mult = found->mult_in[s->p->whole.rows.of_kind[MT_ROW_BAND].first + i];
        const char *part = NULL;
        const char *const saved = mult > 0.0 ? relaxation_gain_text(s, mult, &part) : NULL;
        if (saved != NULL) {
            mt_add_sentence(
                s, "Relaxing the %s edge of %s, which holds %s mode %d, by %s would %s %s.",
                row.sense == MT_AT_LEAST ? "upper" : "lower", c->bands.items[row.band].label,
                mt_configuration_name(s->p, &s->p->views[c->view]), row.mode, part, win(s),
                saved);
        }
    }
}

/* Write margins that are active between the named positions: rows of the search, too. */
static void write_between(mt_sentences *s)
{
    mt_sentence_of(s, "cost", NULL);
    for (int i = 0; i < s->design->n_held; i++) {
        const mt_mode_placement_held *const h = &s->design->held[i];
        const mt_drive_positions *const f = &s->p->families[h->drive_positions];
        const char *part = NULL;
        const char *const saved = relaxation_gain_text(s, h->multiplier, &part);
        const char *const where =
            saved == NULL ? NULL
                          : mt_describe_position(s->p->study, f, h->position, &s->result->mem);
        if (where != NULL) {
            mt_add_sentence(
                s,
                "Relaxing the %s edge of %s, which holds mode %d where %s is at %s, between "
                "the positions, by %s would %s %s.",
                h->above ? "upper" : "lower", h->band, h->mode, f->joint, where, part, win(s),
                saved);
        }
    }
}

/* Write limits that are active between the named positions. */
static void write_limits_between(mt_sentences *s)
{
    for (const mt_at_position_price *h = s->design->at_position; h != NULL; h = h->next) {
        const mt_requirement *const d = &s->p->requirements[h->requirement];
        const mt_drive_positions *const f =
            &s->p->families[mt_drive_positions_of(s->p, d->view)];
        const char *part = NULL;
        const char *const saved =
            h->t == s->design->found->t ? relaxation_gain_text(s, h->multiplier, &part) : NULL;
        const char *const where =
            saved == NULL ? NULL
                          : mt_describe_position(s->p->study, f, h->position, &s->result->mem);
        if (where != NULL) {
            mt_sentence_of(s, "cost", s->rec->goals[h->requirement].pointer);
            mt_add_sentence(
                s,
                "Relaxing the limit of goal %s where %s is at %s, between the positions, by %s "
                "would %s %s.",
                s->rec->goals[h->requirement].pointer, f->joint, where, part, win(s), saved);
        }
    }
}

/* "An upper bound of M_SAU that is 0.1 kg higher" */
static const char *margin_text(mt_sentences *s, const mt_result_parameter *p, double amount)
{
    const char *const unit = p->display_unit != NULL ? p->display_unit : p->unit;
    const bool upper = strcmp(p->at_bound, "upper") == 0;
    return mt_arena_printf(&s->result->mem, "%s bound of %s that is %.6g%s%s %s",
                           upper ? "An upper" : "A lower", p->name,
                           mt_result_shown(amount, p->display_factor), unit != NULL ? " " : "",
                           unit != NULL ? unit : "", upper ? "higher" : "lower");
}

/* Write the gain in the objective from moving a bound: the multiplier, converted to the
 * parameter, for the largest change for which a slope is valid. */
static void write_bound_price(mt_sentences *s, int i, double amount)
{
    const mt_nlp_solution *const found = s->design->found;
    const mt_result_parameter *const p = &s->rec->parameters[i];
    if (found->mult_bound == NULL || found->bound[i] == 0) {
        return;
    }
    const char *saved = NULL;
    for (int k = 0; k < N_PARTS && saved == NULL; k++) {
        const double less = amount * parts[k] / parts[0];
        const double dt = less / mt_problem_dx_dt_at(s->p, i, p->recommended);
        saved = worth(s, fabs(found->mult_bound[i]) * dt);
        if (saved != NULL) {
            mt_add_sentence(s, "%s would %s %s.", margin_text(s, p, less), win(s), saved);
        }
    }
}

/* Write the effect of moving a bound on a missed frequency. */
static void write_bound_frequency(mt_sentences *s, int i, double amount,
                                  const mt_result_frequency *f)
{
    const mt_result_parameter *const p = &s->rec->parameters[i];
    if (f->sensitivity == NULL || f->repeated) {
        return;
    }
    const double outwards = strcmp(p->at_bound, "upper") == 0 ? 1.0 : -1.0;
    const double hz = mt_without_noise(amount * outwards * f->sensitivity[i],
                                       MT_RATIO_NOISE * f->recommended_hz);
    const bool raise = f->recommended_hz < f->target_hz || f->recommended_hz < f->at_least_hz;
    const bool lower = f->recommended_hz > f->target_hz || f->recommended_hz > f->at_most_hz;
    if ((raise && hz > 0.0) || (lower && hz < 0.0)) {
        mt_add_sentence(s, "%s would bring %s mode %d nearer to its goal by %.3g Hz.",
                        margin_text(s, p, amount), f->configuration, f->mode, fabs(hz));
    }
}

static void write_bounds(mt_sentences *s)
{
    for (int i = 0; i < s->rec->n_parameters; i++) {
        const mt_result_parameter *const p = &s->rec->parameters[i];
        /* a round amount: the power of ten from 1 to 10 % of the value */
        const double amount = pow(10.0, floor(log10(0.1 * fabs(p->recommended))));
        if (p->at_bound == NULL || !(amount > 0.0) || !isfinite(amount)) {
            continue;
        }
        mt_sentence_of(s, "cost", p->name);
        write_bound_price(s, i, amount);
        for (int k = 0; k < s->rec->n_frequencies && !s->rec->feasible; k++) {
            write_bound_frequency(s, i, amount, &s->rec->frequencies[k]);
        }
    }
}

void mt_add_prices_sentences(mt_sentences *s)
{
    say_requirements(s);
    write_edges(s);
    write_between(s);
    write_limits_between(s);
    write_bounds(s);
}
