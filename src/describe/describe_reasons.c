/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sentences about bands: the kind of the design, modes on edges and inside, and the least of
 * the other clearances. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/format.h"
#include "base/number.h"
#include "describe/certificates.h"
#include "describe/describe.h"
#include "describe/describe_search.h"
#include "problem/avoidance.h"
#include "problem/configuration.h"
#include "problem/objective.h"
#include "problem/tolerance.h"
#include "search/mode_placements.h"
#include "search/search.h"

/* The reasons of one recommendation, while they are written. */
typedef struct sentences {
    const mt_problem *p;
    const mt_design *design;
    mt_result *result;
    mt_recommendation *rec;
    int capacity;
    mt_reason of; /* kind and subject of the next sentences */
} sentences;

static void sentence_of(sentences *s, const char *kind, const char *about);
static void add_sentence(sentences *s, const char *fmt, ...) MT_PRINTF(2, 3);
static const char *add_listed_sentences(sentences *s, const char *list, const char *name,
                                        int left);

/* A clearance that equals its margin within this, in percent of the edge, is active: ten times
 * the tolerance that a goal has by default. */
static const double ACTIVE_PERCENT = 1e-3;
static const double PERCENT = 100.0;

static const mt_result_mode_placement *gap_of(const mt_recommendation *rec,
                                              const mt_result_clearance *c)
{
    for (int i = 0; i < rec->n_placements; i++) {
        if (strcmp(rec->placements[i].configuration, c->configuration) == 0 &&
            strcmp(rec->placements[i].band, c->band) == 0) {
            return &rec->placements[i];
        }
    }
    return NULL;
}

/* "15.5 to 18.9 Hz (4P of UH-60)"; the numbers alone where they are the band's label. */
static const char *band_text(sentences *s, const mt_result_clearance *c)
{
    const mt_result_mode_placement *const g = gap_of(s->rec, c);
    if (g == NULL) {
        return c->band;
    }
    const char *const numbers =
        mt_arena_printf(&s->result->mem, "%.6g to %.6g Hz", g->lower_hz, g->upper_hz);
    return numbers == NULL || strcmp(numbers, c->band) == 0
               ? c->band
               : mt_arena_printf(&s->result->mem, "%s (%s)", numbers, c->band);
}

/* "no mode lies below ", "2 modes lie below "; behind others without a verb. */
static const char *count_text(mt_arena *mem, int modes, bool first)
{
    if (modes == 0) {
        return first ? "no mode lies below " : ", no mode lies below ";
    }
    const char *const before = first ? "" : ", ";
    if (modes == 1) {
        return mt_arena_printf(mem, "%s1 mode%s below ", before, first ? " lies" : "");
    }
    return mt_arena_printf(mem, "%s%d modes%s below ", before, modes, first ? " lie" : "");
}

/* "In installed, no mode lies below 1P and 4P, 1 mode below 8P." Bands with one number of modes
 * stand together. */
static void write_kind(sentences *s, int first, int n)
{
    const mt_result_mode_placement *const g = &s->rec->placements[first];
    mt_arena *const mem = &s->result->mem;
    const char *text = "";
    int same = 1;
    for (int i = 0; i < n; i += same) {
        same = 1;
        while (i + same < n && g[i + same].modes_below == g[i].modes_below) {
            same++;
        }
        text = mt_arena_printf(mem, "%s%s", text, count_text(mem, g[i].modes_below, i == 0));
        for (int k = 0; k < same; k++) {
            text = add_listed_sentences(s, text, g[i + k].band, same - 1 - k);
        }
    }
    add_sentence(s, "In %s, %s.", g->configuration, text);
}

static void write_kinds(sentences *s)
{
    for (int first = 0, n = 0; first < s->rec->n_placements; first += n) {
        const char *const configuration = s->rec->placements[first].configuration;
        n = 1;
        while (first + n < s->rec->n_placements &&
               strcmp(s->rec->placements[first + n].configuration, configuration) == 0) {
            n++;
        }
        write_kind(s, first, n);
    }
}

static void write_active(sentences *s, const mt_result_clearance *c)
{
    const char *const edge = strcmp(c->side, "above") == 0 ? "upper" : "lower";
    if (c->margin_percent > 0.0) {
        add_sentence(
            s, "%s mode %d (%.6g Hz) keeps just the margin asked for, %.3g %% %s band %s.",
            c->configuration, c->mode, c->hz, c->margin_percent, c->side, band_text(s, c));
    } else {
        add_sentence(s, "%s mode %d stands on the %s edge (%.6g Hz) of band %s.",
                     c->configuration, c->mode, edge, c->hz, band_text(s, c));
    }
}

static void write_short(sentences *s, const mt_result_clearance *c)
{
    if (c->percent < 0.0) {
        add_sentence(s,
                     "%s mode %d (%.6g Hz) lies inside band %s, %.3g %% from its nearest edge.",
                     c->configuration, c->mode, c->hz, band_text(s, c), -c->percent);
    } else {
        add_sentence(s, "%s mode %d (%.6g Hz) keeps only %.3g %% %s band %s, of %.3g %% asked.",
                     c->configuration, c->mode, c->hz, c->percent, c->side, band_text(s, c),
                     c->margin_percent);
    }
}

/* Write each active or missed clearance, and the least of the others, the first of equal
 * ones. */
static void write_clearances(sentences *s)
{
    const mt_result_clearance *least = NULL;
    for (int i = 0; i < s->rec->n_clearances; i++) {
        const mt_result_clearance *const c = &s->rec->clearances[i];
        if (!MT_HAS(c->percent)) {
            continue; /* at 0 Hz, infinitely far from every band */
        }
        if (fabs(c->percent - c->margin_percent) <= ACTIVE_PERCENT) {
            write_active(s, c);
        } else if (c->percent < c->margin_percent) {
            write_short(s, c);
        } else if (least == NULL || mt_exceeds(least->percent, c->percent)) {
            least = c;
        }
    }
    if (least != NULL) {
        const bool others = s->rec->n_clearances > 1;
        add_sentence(s, "%s mode %d (%.6g Hz) keeps %.3g %% %s band %s%s.",
                     least->configuration, least->mode, least->hz, least->percent, least->side,
                     band_text(s, least), others ? "; nothing else comes nearer" : "");
    }
}

/* Add sentences about the positions of modes between the bands and about modes on an edge.
 * Nothing without bands. */
static void add_bands_sentences(sentences *s)
{
    sentence_of(s, "hold", NULL);
    write_kinds(s);
    write_clearances(s);
    for (int i = 0; i < s->rec->n_motions; i++) {
        add_sentence(s, "Over the motion: %s.", s->rec->motions[i].text);
    }
}

/* Sentences about the tolerances of the variables: how surely goals hold over them. */

/* Add sentences about the margins of goals over the tolerances of the variables. Nothing
 * without tolerances. */
static void add_worst_sentences(sentences *s)
{
    const char *text = ""; /* "k1 2 %, k2 5 %" */
    int n = 0;
    if (s->rec->worst_case == NULL) {
        return;
    }
    for (int i = 0; i < s->p->n; i++) {
        const double percent = PERCENT * mt_tolerance_of_variable(s->p, i);
        if (percent > 0.0) {
            text =
                mt_arena_printf(&s->result->mem, "%s%s%s %.6g %%", text, n++ == 0 ? "" : ", ",
                                s->p->study->variables[i].parameter_name.s, percent);
        }
    }
    sentence_of(s, "hold", NULL);
    if (strcmp(s->rec->worst_case, "proven") == 0) {
        add_sentence(
            s,
            "Goals are judged at the worst corner of the tolerances (%s), which is proven "
            "to be the worst case.",
            text);
    } else {
        add_sentence(
            s,
            "Goals are judged by the worst of the corners of the tolerances (%s) and of "
            "samples within them: sampled, not proven.",
            text);
    }
}

/*
 * Prices. At an optimum the multiplier of an active constraint is the slope of the objective
 * over its limit; limits are relative (a ratio's logarithm), bounds are in t, which is chained
 * to the parameter here. The change enters the search as half its square: dc = df / c.
 */

/* Parts of a requirement [-] that a price is told for: the largest one whose worth a slope
 * tells. */
static const double parts[] = {1e-2, 1e-3, 1e-4, 1e-5};
enum { N_PARTS = sizeof parts / sizeof *parts };

static mt_price price_of(const sentences *s, double df)
{
    return (mt_price){.df = df * s->p->stages[s->design->stage].size,
                      .change = s->rec->change,
                      .score = s->rec->score,
                      .first = s->design->stage == 0};
}

/* True where the design has multipliers: slopes of an objective at its optimum. */
static bool has_prices(const sentences *s)
{
    const mt_objective_ops *const ops = s->p->stages[s->design->stage].ops;
    return ops->price != NULL && s->rec->feasible && mt_describe_is_optimum(s->rec);
}

/* Text of a change df of the objective's value f: "the mass by 0.12 kg". NULL: only rounding,
 * beyond the validity of a slope, not known, or out of memory. */
static const char *worth(sentences *s, double df)
{
    const mt_objective_ops *const ops = s->p->stages[s->design->stage].ops;
    const mt_price q = price_of(s, df);
    const bool noise =
        !(fabs(df) > 0.0) || (q.first && fabs(q.df) <= MT_RATIO_NOISE * fabs(q.score));
    return noise || !has_prices(s) ? NULL : ops->price(&q, &s->result->mem);
}

/* Text of the gain from a relaxation of a requirement, and of its size; slope: df by the
 * logarithm of the requirement. */
static const char *relaxation_gain_text(sentences *s, double slope, const char **part)
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

static const char *win(const sentences *s)
{
    const mt_objective_type type = s->p->stages[s->design->stage].type;
    return mt_objective_is(type, MT_MAXIMISED) ? "raise" : "reduce";
}

/* A requirement that the variables hardly move: at an optimum its slope by them, the other rows
 * held, is at most that of the objective over the multiplier. */
static void write_hardly(sentences *s, const mt_requirement *d, const mt_result_goal *g,
                         double slope)
{
    const mt_objective_ops *const ops = s->p->stages[s->design->stage].ops;
    const mt_price q = price_of(s, fabs(slope) / PERCENT);
    const char *const why =
        has_prices(s) && ops->hardly != NULL ? ops->hardly(&q, &s->result->mem) : NULL;
    const char *const left = why != NULL ? worth(s, fabs(slope) * d->tolerance) : NULL;
    if (left != NULL) {
        add_sentence(
            s,
            "Goal %s (%s) hardly depends on the variables here: %s; what its tolerance of "
            "%.3g %% leaves open may change %s.",
            g->pointer, g->text, why, PERCENT * d->tolerance, left);
    } else if (why != NULL) {
        add_sentence(s, "Goal %s (%s) hardly depends on the variables here: %s.", g->pointer,
                     g->text, why);
    }
}

/* Write the gain from a small relaxation of each requirement. */
static void say_requirements(sentences *s)
{
    const mt_nlp_solution *const found = s->design->found;
    for (int i = 0; i < s->p->n_requirements; i++) {
        const mt_requirement *const d = &s->p->requirements[i];
        const mt_result_goal *const g = &s->rec->goals[i];
        const int row = mt_requirement_row(&s->p->whole, d);
        const bool target = d->role == MT_ROLE_TARGET && found->mult_eq != NULL;
        const int n_limits = d->role == MT_ROLE_LIMIT ? d->n_rows : 0;
        const char *part = NULL;
        sentence_of(s, "cost", g->pointer);
        for (int k = 0; k < n_limits && found->mult_in != NULL; k++) {
            const double mult = found->mult_in[row + k];
            const char *const saved = mult > 0.0 ? relaxation_gain_text(s, mult, &part) : NULL;
            if (saved != NULL) {
                add_sentence(s, "Relaxing goal %s (%s) by %s would %s %s.", g->pointer, g->text,
                             part, win(s), saved);
            }
        }
        const double slope = target ? found->mult_eq[row] : nan("");
        const char *const cost = relaxation_gain_text(s, fabs(slope), &part);
        if (cost != NULL) {
            add_sentence(s, "A target %s %s in goal %s (%s) would %s %s.", part,
                         slope > 0.0 ? "lower" : "higher", g->pointer, g->text, win(s), cost);
        }
        write_hardly(s, d, g, slope);
    }
}

/* Write the edges of bands that are active. */
static void write_edges(sentences *s)
{
    const mt_nlp_solution *const found = s->design->found;
    const bool known = s->design->below != NULL && found->mult_in != NULL;
    mt_avoidance_rows rows = {.c = &s->p->whole, .below = s->design->below};
    int at = s->p->whole.rows.of_kind[MT_ROW_BAND].first;
    mt_row row;
    sentence_of(s, "cost", NULL);
    while (known && mt_avoidance_next_row(&rows, &row)) {
        const mt_avoidance *const c = &s->p->avoidances[row.avoidance];
        const double mult = found->mult_in[at++];
        const char *part = NULL;
        const char *const saved = mult > 0.0 ? relaxation_gain_text(s, mult, &part) : NULL;
        if (saved != NULL) {
            add_sentence(
                s, "Relaxing the %s edge of %s, which holds %s mode %d, by %s would %s %s.",
                row.sense == MT_AT_LEAST ? "upper" : "lower", c->bands.items[row.band].label,
                mt_configuration_name(s->p, &s->p->views[c->view]), row.mode, part, win(s),
                saved);
        }
    }
}

/* Write margins that are active between the named positions: rows of the search, too. */
static void write_between(sentences *s)
{
    sentence_of(s, "cost", NULL);
    for (int i = 0; i < s->design->n_held; i++) {
        const mt_mode_placement_held *const h = &s->design->held[i];
        const mt_drive_positions *const f = &s->p->families[h->drive_positions];
        const char *part = NULL;
        const char *const saved = relaxation_gain_text(s, h->multiplier, &part);
        const char *const where =
            saved == NULL ? NULL
                          : mt_describe_position(s->p->study, f, h->position, &s->result->mem);
        if (where != NULL) {
            add_sentence(
                s,
                "Relaxing the %s edge of %s, which holds mode %d where %s is at %s, between "
                "the positions, by %s would %s %s.",
                h->above ? "upper" : "lower", h->band, h->mode, f->joint, where, part, win(s),
                saved);
        }
    }
}

/* Write limits that are active between the named positions. */
static void write_limits_between(sentences *s)
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
            sentence_of(s, "cost", s->rec->goals[h->requirement].pointer);
            add_sentence(
                s,
                "Relaxing the limit of goal %s where %s is at %s, between the positions, by %s "
                "would %s %s.",
                s->rec->goals[h->requirement].pointer, f->joint, where, part, win(s), saved);
        }
    }
}

/* "An upper bound of M_SAU that is 0.1 kg higher" */
static const char *margin_text(sentences *s, const mt_result_parameter *p, double amount)
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
static void write_bound_price(sentences *s, int i, double amount)
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
            add_sentence(s, "%s would %s %s.", margin_text(s, p, less), win(s), saved);
        }
    }
}

/* Write the effect of moving a bound on a missed frequency. */
static void write_bound_frequency(sentences *s, int i, double amount,
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
        add_sentence(s, "%s would bring %s mode %d nearer to its goal by %.3g Hz.",
                     margin_text(s, p, amount), f->configuration, f->mode, fabs(hz));
    }
}

static void write_bounds(sentences *s)
{
    for (int i = 0; i < s->rec->n_parameters; i++) {
        const mt_result_parameter *const p = &s->rec->parameters[i];
        /* a round amount: the power of ten from 1 to 10 % of the value */
        const double amount = pow(10.0, floor(log10(0.1 * fabs(p->recommended))));
        if (p->at_bound == NULL || !(amount > 0.0) || !isfinite(amount)) {
            continue;
        }
        sentence_of(s, "cost", p->name);
        write_bound_price(s, i, amount);
        for (int k = 0; k < s->rec->n_frequencies && !s->rec->feasible; k++) {
            write_bound_frequency(s, i, amount, &s->rec->frequencies[k]);
        }
    }
}

/* Add sentences about the gain from relaxing requirements, edges of bands and active bounds:
 * their multipliers in the objective's unit, or, where a frequency is missed, the effect of
 * moving a bound. */
static void add_prices_sentences(sentences *s)
{
    say_requirements(s);
    write_edges(s);
    write_between(s);
    write_limits_between(s);
    write_bounds(s);
}

/* Sentences an engineer can paste into a report: what changes, what that does, what is missed,
 * what a requirement costs, and how sure the answer is. */

/* Changes of a parameter below this many percent, and errors of a frequency, are not worth a
 * number. */
static const double WORTH_SAYING_PERCENT = 1e-4;
enum { NUMBER_SIZE = 32, REQUIREMENT_SIZE = 128 };

/* Set the kind and the subject of the next sentences: a parameter, a goal (its pointer) or
 * NULL. */
static void sentence_of(sentences *s, const char *kind, const char *about)
{
    s->of = (mt_reason){.kind = kind, .about = about};
}

/* Add a sentence. */
static void add_sentence(sentences *s, const char *fmt, ...)
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

static void write_change(sentences *s, const mt_result_parameter *p)
{
    const char *const name = p->display_unit != NULL ? p->display_unit : p->unit;
    const char *const unit = name != NULL ? name : "";
    const char *const space = name != NULL ? " " : "";
    const double original = mt_result_shown(p->original, p->display_factor);
    const double recommended = mt_result_shown(p->recommended, p->display_factor);
    sentence_of(s, "change", p->name);
    if (isfinite(p->change_percent)) { /* not of what was 0, or next to it */
        add_sentence(s, "%s %s by %.3g %%, from %.6g to %.6g%s%s.", p->name,
                     p->recommended > p->original ? "rises" : "falls", fabs(p->change_percent),
                     original, recommended, space, unit);
    } else {
        add_sentence(s, "%s goes from %.6g to %.6g%s%s.", p->name, original, recommended, space,
                     unit);
    }
    if (p->at_bound != NULL) {
        sentence_of(s, "hold", p->name);
        add_sentence(s, "%s stands at its %s bound: a wider bound may give a better design.",
                     p->name, p->at_bound);
    }
}

/* Append a name to a list, "a, b and c"; left: the number of names still to come. Returns NULL,
 * or the list so far, when out of memory. */
static const char *add_listed_sentences(sentences *s, const char *list, const char *name,
                                        int left)
{
    const char *const behind = left == 0 ? "" : left == 1 ? " and " : ", ";
    return mt_arena_printf(&s->result->mem, "%s%s%s", list, name, behind);
}

/* Parameters that stay, in one sentence: "a, b and c keep their original values." */
static void write_kept(sentences *s, int kept)
{
    const char *text = "";
    int left = kept;
    for (int i = 0; i < s->rec->n_parameters; i++) {
        const mt_result_parameter *const p = &s->rec->parameters[i];
        if (!unchanged(p)) {
            continue;
        }
        text = add_listed_sentences(s, text, p->name, --left);
    }
    sentence_of(s, "change", NULL);
    if (kept > 0 && kept == s->rec->n_parameters) {
        add_sentence(s, "The original design stays as it is.");
    } else if (kept > 0) {
        add_sentence(s, "%s keep%s original value%s.", text, kept == 1 ? "s its" : " their",
                     kept == 1 ? "" : "s");
    }
}

static void write_changes(sentences *s)
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
        add_sentence(
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
static const char *lever_text(sentences *s, const mt_result_frequency *f)
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
static void write_frequency(sentences *s, const mt_result_frequency *f)
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
        add_sentence(s, "%s mode %d%s%s%s comes to %s Hz%s, %s%s.", f->configuration, f->mode,
                     open, name, close, to, range, requirement, lever);
    } else if (strcmp(from, to) == 0) {
        add_sentence(s, "%s mode %d%s%s%s stays at %s Hz%s, %s%s.", f->configuration, f->mode,
                     open, name, close, to, range, requirement, lever);
    } else {
        add_sentence(s, "%s mode %d%s%s%s moves from %s to %s Hz%s, %s%s.", f->configuration,
                     f->mode, open, name, close, from, to, range, requirement, lever);
    }
    if (f->repeated) {
        add_sentence(s, "It is a repeated mode and has no sensitivity of its own.");
    }
}

static void say_warning(sentences *s)
{
    if (s->rec->disagreement != NULL) {
        sentence_of(s, "change", NULL);
        add_sentence(s, "NOT VERIFIED, do not use: %s.", s->rec->disagreement);
    }
}

/* Vibrations of 0 Hz. */
static void write_slack(sentences *s)
{
    sentence_of(s, "hold", NULL);
    for (int i = 0; i < s->rec->n_frequencies; i++) {
        const mt_result_frequency *const f = &s->rec->frequencies[i];
        const bool some = f->slack != NULL && f->slack[0] != '\0';
        if (f->slack != NULL) {
            add_sentence(s, "%s mode %d is at 0 Hz: nothing holds it at this design%s%s%s.",
                         f->configuration, f->mode, some ? " (the stiffness of " : "",
                         some ? f->slack : "", some ? " is 0)" : "");
        }
    }
}

static void write_frequencies(sentences *s)
{
    sentence_of(s, "change", NULL);
    for (int i = 0; i < s->rec->n_frequencies; i++) {
        const mt_result_frequency *const f = &s->rec->frequencies[i];
        const bool asked =
            MT_HAS(f->target_hz) || MT_HAS(f->at_least_hz) || MT_HAS(f->at_most_hz);
        if (asked && MT_HAS(f->recommended_hz)) { /* else its goal has no value */
            write_frequency(s, f);
        }
    }
}

static void write_violations(sentences *s)
{
    for (int i = 0; i < s->rec->n_goals; i++) {
        const mt_result_goal *const g = &s->rec->goals[i];
        sentence_of(s, "hold", g->pointer);
        if (g->doubtful && !g->weighted) {
            add_sentence(
                s, "Goal %s (%s) does not count as met: it is not certain which mode it is.",
                g->pointer, g->text);
        } else if (!g->weighted && !g->met && !MT_HAS(g->violation_percent)) {
            add_sentence(s, "Goal %s (%s) has no value here and does not count as met.",
                         g->pointer, g->text);
        } else if (!g->weighted && !g->met && isfinite(g->violation_percent)) {
            add_sentence(s, "Goal %s (%s) is missed by %.3g %%.", g->pointer, g->text,
                         g->violation_percent);
        } else if (!g->weighted && !g->met) {
            add_sentence(s, "Goal %s (%s) is missed by far.", g->pointer, g->text);
        }
    }
}

/* Write where responses deviate most from their measurements. */
static void write_lines(sentences *s)
{
    for (int i = 0; i < s->rec->n_goals; i++) {
        const mt_result_goal *const g = &s->rec->goals[i];
        if (isfinite(g->off_most_hz) && isfinite(g->off_most_ratio)) {
            sentence_of(s, "rank", g->pointer);
            add_sentence(
                s,
                "%s: deviation %.3g %% rms, most at %.6g Hz, where the response is %.4g times "
                "what was measured and its phase %+.3g deg from it.",
                g->text, 100.0 * g->value, g->off_most_hz, g->off_most_ratio,
                g->off_most_phase_deg);
        }
    }
}

/* Write the forced responses; texts begin with "the". */
static void write_responses(sentences *s)
{
    for (int i = 0; i < s->rec->n_responses; i++) {
        const mt_result_response *const r = &s->rec->responses[i];
        sentence_of(s, "hold", r->pointer);
        add_sentence(s, "T%s.", r->text + 1);
    }
    for (int i = 0; i < s->rec->n_between; i++) {
        const mt_result_between *const r = &s->rec->between[i];
        sentence_of(s, "hold", r->pointer);
        add_sentence(s, "Between the named positions %s.", r->text);
    }
}

/* Write the root mean square deviation of the weighted goals in percent, each weighted as in
 * the study. */
static void write_misfit(sentences *s)
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
    sentence_of(s, "rank", NULL);
    if (weighted > 0 && MT_HAS(s->rec->misfit) && isfinite(sum)) {
        add_sentence(s, "The %d weighted goal%s deviate%s by %.3g %% rms.", weighted,
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
static void write_kind_rank(sentences *s, const char *first)
{
    const mt_mode_placement_result *const g = s->design->placements;
    const char *const sure = mt_describe_placements_left(g, &s->result->mem);
    if (mt_describe_placements_unsearched(g)) {
        add_sentence(
            s,
            "It ranks %d of the %d mode placements that were found to meet all goals, of "
            "%.0f in all, by %s %s (%s).",
            s->rec->rank, g->n_solutions, g->n_possible, optimum_word(&s->p->stages[0]), first,
            sure);
    } else if (g->n_solutions == 1) {
        add_sentence(s, "It is the only one of %.0f mode placements that meets all goals (%s).",
                     g->n_possible, sure);
    } else {
        add_sentence(
            s,
            "It ranks %d of the %d mode placements that meet all goals, of %.0f in all, by "
            "%s %s (%s).",
            s->rec->rank, g->n_solutions, g->n_possible, optimum_word(&s->p->stages[0]), first,
            sure);
    }
}

/* Write that one design was found: where it is isolated, the only one; else nearby designs meet
 * the goals, too, and it is the best of them. */
static void write_only(sentences *s, const mt_nlp_result *search, const char *first)
{
    const char *const many = search->starts == 1 ? "" : "s";
    if (MT_HAS(s->rec->kkt_residual) && mt_describe_is_optimum(s->rec)) {
        add_sentence(
            s,
            "It is the only local optimum, by %s %s, that %d start%s found (sampled, not "
            "proven).",
            optimum_word(&s->p->stages[0]), first, search->starts, many);
    } else {
        add_sentence(s, "It is the only design that %d start%s found (sampled, not proven).",
                     search->starts, many);
    }
}

static void write_optimality(sentences *s)
{
    sentence_of(s, "rank", NULL);
    if (s->rec->feasible && !mt_describe_is_optimum(s->rec)) {
        add_sentence(
            s,
            "It is not shown to be a local optimum: its KKT residual is %.2g, where an optimum "
            "has 0; a design near it may be better.",
            s->rec->kkt_residual);
    }
}

/* One of several local minima of a misfit. */
static void write_minimum(sentences *s, const mt_nlp_result *search)
{
    const double least = mt_without_noise(sqrt(2.0 * search->solutions[0].f), MT_RATIO_NOISE);
    const double own = mt_without_noise(s->rec->misfit, MT_RATIO_NOISE);
    const double ratio = least > 0.0 ? own / least : HUGE_VAL;
    if (s->rec->rank > 1 && !(own > 0.0)) {
        add_sentence(s, "It fits exactly, as recommendation 1 does.");
    } else if (s->rec->rank == 1) {
        add_sentence(s, "Its misfit is the least of %d local minima found from %d starts.",
                     search->n_solutions, search->starts);
    } else if (isfinite(ratio)) {
        add_sentence(
            s, "It is a local minimum of the misfit, %.3g times that of recommendation 1.",
            ratio);
    } else {
        add_sentence(s,
                     "It is a local minimum of the misfit, where recommendation 1 has none.");
    }
}

static void write_rank(sentences *s, const mt_nlp_result *search)
{
    const char *const first = stage_text(&s->p->stages[0]);
    sentence_of(s, "rank", NULL);
    if (s->design->unsearched) {
        add_sentence(
            s, "The original design meets all goals, so no design changes less. Others were "
               "not searched, as the study asks for none.");
        return;
    }
    if (s->design->discrete != NULL) {
        mt_arena *const mem = &s->result->mem;
        const char *const by =
            mt_arena_printf(mem, "%s %s", optimum_word(&s->p->stages[0]), first);
        add_sentence(s, "%s",
                     mt_describe_rank_text(s->design->discrete, search, s->rec->rank, by, mem));
        return;
    }
    if (search->compromise) {
        add_sentence(s,
                     "None of the designs that %d start%s found meets all goals; this one %s.",
                     search->starts, search->starts == 1 ? "" : "s",
                     s->rec->rank == 1 ? "comes nearest"
                                       : "has the least deviation of all designs near it");
    } else if (s->design->placements != NULL) {
        write_kind_rank(s, first);
    } else if (search->n_solutions == 1 && s->design->found->continuum) {
        add_sentence(s,
                     "It is one of a continuum of equally good designs that %d start%s found.",
                     search->starts, search->starts == 1 ? "" : "s");
    } else if (search->n_solutions == 1) {
        write_only(s, search, first);
    } else if (mt_study_is_fit(s->p->study)) {
        write_minimum(s, search);
    } else {
        add_sentence(s, "It ranks %d of %d distinct designs found from %d starts, by %s %s.",
                     s->rec->rank, search->n_solutions, search->starts,
                     optimum_word(&s->p->stages[0]), first);
    }
    if (s->design->found->continuum && !search->compromise) {
        add_sentence(
            s,
            "A continuum of designs is as good as this one: those between it and others "
            "that were found meet all goals, too, and have the same %s.",
            first);
    }
    for (int k = 1; k <= s->design->stage; k++) {
        add_sentence(s, "With the %s %s held, it has the %s %s near it.",
                     optimum_word(&s->p->stages[0]), first, optimum_word(&s->p->stages[k]),
                     stage_text(&s->p->stages[k]));
    }
    if (s->rec->singular) {
        add_sentence(
            s, "It is a double solution: two designs that meet the goals coincide here, so "
               "small errors in the targets move it far.");
    }
}

mt_status mt_describe_baseline_reasons(const mt_problem *p, mt_result *result, mt_err *err)
{
    const mt_design original = {.t = p->whole.origin_t};
    sentences s = {.p = p, .design = &original, .result = result, .rec = &result->baseline};
    say_warning(&s);
    write_slack(&s);
    write_violations(&s);
    write_responses(&s);
    add_bands_sentences(&s);
    return mt_arena_check(&result->mem, err);
}

mt_status mt_describe_reasons(const mt_problem *p, const mt_design *design,
                              const mt_nlp_result *search, mt_result *result,
                              mt_recommendation *rec, mt_err *err)
{
    sentences s = {.p = p, .design = design, .result = result, .rec = rec};
    say_warning(&s);
    write_changes(&s);
    write_slack(&s);
    write_frequencies(&s);
    add_worst_sentences(&s);
    write_violations(&s);
    write_responses(&s);
    add_bands_sentences(&s);
    if (design->cut) {
        sentence_of(&s, "rank", NULL);
        add_sentence(&s, "The search was interrupted: better designs may exist.");
        return mt_arena_check(&result->mem, err);
    }
    add_prices_sentences(&s);
    write_misfit(&s);
    write_rank(&s, search);
    write_optimality(&s);
    return mt_arena_check(&result->mem, err);
}
