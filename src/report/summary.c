/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A result in words: its abstract, its statement of compliance, and all of it. */
#include "report/summary.h"

#include <math.h>
#include <string.h>
#include <strings.h>

#include "base/base.h"
#include "base/number.h"
#include "report/result_tables.h"
#include "report/ruler.h"
#include "report/table.h"

/* The abstract. */

enum { LISTED = 4, DIGITS = 3, VALUE_DIGITS = 4 };

/* "Solved: 2 designs ...": its first word is the status, and stands out. */
static void add_status(const mt_result *result, mt_text *out)
{
    const char *const status = mt_result_status_name(result->status);
    const char *const text = result->status_text == NULL ? "" : result->status_text;
    const size_t length = strlen(status);
    const bool led = strncasecmp(text, status, length) == 0;
    mt_text_addf(out, "<p class=\"status %s\"><b>", status);
    if (led) {
        mt_text_add_n(out, text, length);
    } else {
        mt_text_add(out, status);
    }
    mt_text_add(out, led ? "</b>" : "</b>: ");
    mt_html_escape(text + (led ? length : 0), out);
    mt_text_add(out, "</p>\n");
}

static void open_item(const char *word, mt_text *out)
{
    mt_text_addf(out, "<li><b>%s</b>: ", word);
}

static void close_item(mt_text *out)
{
    mt_text_add(out, "</li>\n");
}

/* Size of a change for sorting: a change from 0, which has no percentage, is the largest. */
static double change_size(const mt_result_parameter *p)
{
    const bool moved = p->recommended < p->original || p->recommended > p->original;
    return isfinite(p->change_percent) ? fabs(p->change_percent) : moved ? HUGE_VAL : 0.0;
}

/* "k +8.21 %", "k to 3.00 N/m" */
static void add_change(const mt_result_parameter *p, mt_text *out)
{
    char number[MT_NUMBER_TEXT];
    mt_html_escape(p->name, out);
    if (isfinite(p->change_percent)) {
        mt_text_addf(out, " %s %%", mt_report_change(p->change_percent, DIGITS, number));
        return;
    }
    mt_text_addf(out, " to %s", mt_report_number(p->recommended, DIGITS, number));
    if (p->unit != NULL && p->unit[0] != '\0') {
        mt_text_add(out, " ");
        mt_html_escape(p->unit, out);
    }
}

/* The parameter with the largest change among those that come behind `last`; -1: none. Equal
 * ones as they stand. */
static int next_largest(const mt_recommendation *r, int last)
{
    int found = -1;
    for (int i = 0; i < r->n_parameters; i++) {
        const double size = change_size(&r->parameters[i]);
        const double before = last < 0 ? HUGE_VAL : change_size(&r->parameters[last]);
        const bool behind = size < before || (size == before && i > last);
        if (size > 0.0 && behind && (found < 0 || size > change_size(&r->parameters[found]))) {
            found = i;
        }
    }
    return found;
}

static void add_changes(const mt_recommendation *r, mt_text *out)
{
    int changed = 0;
    for (int i = 0; i < r->n_parameters; i++) {
        changed += change_size(&r->parameters[i]) > 0.0 ? 1 : 0;
    }
    int told = 0;
    for (int i = next_largest(r, -1); i >= 0 && told < LISTED; i = next_largest(r, i)) {
        mt_text_add(out, told++ == 0 ? "" : ", ");
        add_change(&r->parameters[i], out);
    }
    if (changed > told) {
        mt_text_addf(out, " and %d other%s", changed - told, changed - told == 1 ? "" : "s");
    }
    mt_text_add(out, changed == 0 ? "no parameter changes" : "");
}

/* The first objective at this design: "mass 16.94 kg (was 11.92)"; false (and no text) where it
 * is the change. */
static bool report_headline(const mt_recommendation *r, mt_text *out)
{
    char now[MT_NUMBER_TEXT];
    const mt_design_objective *const o = r->n_objectives > 0 ? &r->objectives[0] : NULL;
    if (o == NULL || !isfinite(o->recommended) || o->recommended == r->change) {
        return false;
    }
    mt_text_addf(
        out, "%s %s%s%s", o->text,
        mt_report_number(mt_report_objective_value(o->unit, o->recommended), VALUE_DIGITS, now),
        o->unit != NULL && o->unit[0] != '\0' ? " " : "", o->unit != NULL ? o->unit : "");
    if (isfinite(o->original)) {
        char was[MT_NUMBER_TEXT];
        mt_text_addf(out, " (was %s)",
                     mt_report_number(mt_report_objective_value(o->unit, o->original),
                                      VALUE_DIGITS, was));
    }
    return true;
}

static void add_best(const mt_recommendation *r, mt_text *out)
{
    char change[MT_NUMBER_TEXT];
    mt_text headline = {.s = NULL};
    open_item("Best design", out);
    if (report_headline(r, &headline)) {
        mt_html_escape(headline.s == NULL ? "" : headline.s, out);
        mt_text_add(out, "; ");
    }
    out->failed = out->failed || headline.failed;
    mt_text_free(&headline);
    add_changes(r, out);
    mt_text_add(out, ". Graded ");
    mt_html_escape(r->grade == NULL ? "not at all" : r->grade, out);
    mt_text_addf(out, "; total change %s.", mt_report_number(r->change, DIGITS, change));
    close_item(out);
}

/* Add the goals that decide the status, those without weights. */
static void add_goals(const mt_recommendation *r, mt_text *out)
{
    char number[MT_NUMBER_TEXT];
    int n = 0;
    int met = 0;
    for (int i = 0; i < r->n_goals; i++) {
        n += r->goals[i].weighted ? 0 : 1;
        met += !r->goals[i].weighted && r->goals[i].met ? 1 : 0;
    }
    if (n == 0 && isnan(r->misfit)) {
        return;
    }
    open_item("Goals", out);
    if (n > 0 && met == n) {
        mt_text_addf(out, n == 1 ? "the goal is met" : "all %d are met", n);
    } else if (n > 0) {
        mt_report_number(r->violation_percent, DIGITS, number);
        if (n == 1) {
            mt_text_addf(out, "the goal is missed by %s %%", number);
        } else {
            mt_text_addf(out, "%d of %d are met, others missed by %s %% at most", met, n,
                         number);
        }
    }
    if (!isnan(r->clearance_percent)) {
        mt_text_addf(out, "%s the least clearance from a band is %s %%", n > 0 ? ";" : "",
                     mt_report_number(r->clearance_percent, DIGITS, number));
    }
    if (!isnan(r->misfit)) {
        mt_text_addf(
            out, "%s the misfit is %s", n > 0 ? ";" : "",
            mt_report_number(mt_without_noise(r->misfit, MT_RATIO_NOISE), DIGITS, number));
    }
    mt_text_add(out, ".");
    close_item(out);
}

/* Add what is proven, in full; the unproven statements are many, and follow below. */
static void add_proof(const mt_result *result, mt_text *out)
{
    int sampled = 0;
    int proven = 0;
    for (int i = 0; i < result->n_certificates; i++) {
        const mt_certificate *const c = &result->certificates[i];
        sampled += c->proven ? 0 : 1;
        if (c->proven && proven < LISTED) {
            if (proven++ == 0) {
                open_item("Proven", out);
            } else {
                mt_text_add(out, " ");
            }
            mt_html_escape(c->text, out);
        }
    }
    if (proven > 0) {
        close_item(out);
        return;
    }
    const char *const grade = result->recommendations[0].grade;
    const bool best = grade != NULL && strcmp(grade, "feasible and proven") == 0;
    open_item("Proven", out);
    mt_text_add(out, best                           ? "that the best design meets the goals."
                     : result->certificates == NULL ? "nothing: the run was stopped before."
                     : sampled > 0
                         ? "nothing; what was sampled is listed below."
                         : "nothing; designs were found by local searches from many starts.");
    close_item(out);
}

static void add_others(const mt_result *result, mt_text *out)
{
    const int others = result->n_recommendations - 1;
    if (others > 0) {
        open_item("Alternatives", out);
        mt_text_addf(out, "%d other recommendation%s.", others, others == 1 ? "" : "s");
        close_item(out);
    }
}

void mt_report_abstract(const mt_result *result, mt_text *out)
{
    add_status(result, out);
    if (result->n_recommendations == 0) {
        return;
    }
    mt_text_add(out, "<ul class=\"gist\">\n");
    add_best(&result->recommendations[0], out);
    add_goals(&result->recommendations[0], out);
    add_proof(result, out);
    add_others(result, out);
    mt_text_add(out, "</ul>\n");
}

/*
 * The requirements compared with a design, as a compliance table: one row per requirement, or
 * per band where they are few; margins in hertz where the result has percentages.
 */

enum {
    HZ_DIGITS = 6,
    LIMIT_DIGITS = 6,
    PERCENT_DIGITS = 3,
    ASKED_DIGITS = 10, /* of limits, that a person wrote */
    BANDS_TOLD = 12    /* of more, one row a configuration */
};
static const double PERCENT = 100.0;
static const double TOLD_PERCENT = 1e-3; /* a lesser tolerance is one of searches */

/* The cells of a row are made in the memory of the table. */
typedef struct sheet {
    mt_table t;
    const mt_recommendation *before; /* NULL: what is judged is the original design */
    const mt_recommendation *after;
    bool worst; /* a column of the worst over the tolerances */
} sheet;

typedef struct row {
    const char *requirement;
    const char *limit;
    const char *before;
    const char *after;
    const char *worst;
    const char *margin;
    const char *verdict;
    bool good;
} row;

static void add_requirement_row(sheet *s, const row *r)
{
    mt_table_text(&s->t, r->requirement);
    mt_table_text(&s->t, r->limit);
    if (s->before != NULL) {
        mt_table_text(&s->t, r->before);
    }
    mt_table_text(&s->t, r->after);
    if (s->worst) {
        mt_table_text(&s->t, r->worst);
    }
    mt_table_text(&s->t, r->margin);
    if (strcmp(r->verdict, "weighted") == 0) {
        mt_table_text(&s->t, r->verdict);
    } else {
        mt_table_verdict(&s->t, r->verdict, r->good);
    }
}

/* "10.6 %", with its sign */
static const char *margin_text(sheet *s, double percent)
{
    char number[MT_NUMBER_TEXT];
    return isfinite(percent)
               ? mt_arena_printf(&s->t.mem, "%s %%",
                                 mt_report_change(mt_without_noise(percent, MT_PERCENT_NOISE),
                                                  PERCENT_DIGITS, number))
               : NULL;
}

static bool is_good(const mt_result_goal *g)
{
    return g->weighted ? g->violation_percent <= 0.0 : g->met;
}

/* The verdict of a requirement. A limit that is the scale of an objective does not decide the
 * status, but is met or not. */
static const char *verdict_of(const mt_result_goal *g)
{
    if (!g->weighted) {
        return is_good(g) ? "met" : "not met";
    }
    return !isnan(g->target) || isnan(g->at_most) ? "weighted"
           : is_good(g)                           ? "kept"
                                                  : "exceeded";
}

/*
 * Bands
 */

/* The mode beside a band that is left the least room by its margin, or is deepest within it. */
typedef struct nearest {
    double room; /* of the frequency that is judged, as room_of has it; NaN: no mode */
    double hz;
    double worst_hz;
    int mode;
} nearest;

/* Distance of f from an interval relative to its nearer end; negative inside. */
static double room_of(const mt_result_mode_placement *band, double hz)
{
    const double below = hz > 0.0 ? band->margin_lower_hz / hz - 1.0 : HUGE_VAL;
    const double above = hz / band->margin_upper_hz - 1.0;
    return fmax(below, above);
}

/* Modes stand with their neighbouring bands; one with none beside it has further ones. */
static nearest nearest_to(const mt_recommendation *r, const mt_result_mode_placement *band)
{
    nearest n = {.room = nan(""), .hz = nan(""), .worst_hz = nan("")};
    bool beside = false;
    for (int pass = 0; pass < 2 && !beside; pass++) {
        for (int i = 0; i < r->n_clearances; i++) {
            const mt_result_clearance *const c = &r->clearances[i];
            const double hz = isnan(c->worst_hz) ? c->hz : c->worst_hz;
            const double room = mt_without_noise(room_of(band, hz), MT_RATIO_NOISE);
            const bool own = pass == 0 ? c->band_id == band->id
                                       : strcmp(c->configuration, band->configuration) == 0;
            beside = beside || own;
            if (own && (isnan(n.room) || isnan(room) || mt_exceeds(n.room, room))) {
                n = (nearest){room, c->hz, c->worst_hz, c->mode};
            }
        }
    }
    return n;
}

static const char *mode_text(sheet *s, double hz, int mode)
{
    char number[MT_NUMBER_TEXT];
    return isnan(hz) ? NULL
                     : mt_arena_printf(&s->t.mem, "%s Hz (mode %d)",
                                       mt_report_number(hz, HZ_DIGITS, number), mode);
}

static const char *outside_text(sheet *s, const mt_result_mode_placement *band, bool named)
{
    char low[MT_NUMBER_TEXT];
    char high[MT_NUMBER_TEXT];
    (void)mt_report_number(band->margin_lower_hz, HZ_DIGITS, low);
    (void)mt_report_number(band->margin_upper_hz, HZ_DIGITS, high);
    const char *const range = band->margin_lower_hz > 0.0
                                  ? mt_arena_printf(&s->t.mem, "outside %s to %s Hz", low, high)
                                  : mt_arena_printf(&s->t.mem, "above %s Hz", high);
    return range == NULL || !named ? range
                                   : mt_arena_printf(&s->t.mem, "%s (%s)", range, band->band);
}

/* " with 10 % margin"; nothing without one */
static const char *with_margin(sheet *s, const mt_result_mode_placement *band)
{
    const double percent = PERCENT * (band->margin_upper_hz / band->upper_hz - 1.0);
    return percent > MT_PERCENT_NOISE
               ? mt_arena_printf(&s->t.mem, " with %.*g %% margin", PERCENT_DIGITS, percent)
               : "";
}

static const mt_result_mode_placement *band_of(const mt_recommendation *r, int id)
{
    for (int i = 0; i < r->n_placements; i++) {
        if (r->placements[i].id == id) {
            return &r->placements[i];
        }
    }
    return NULL;
}

static bool avoids_bands(const mt_result_goal *g)
{
    return strcmp(g->type, "avoid") == 0;
}

/* True where the goal avoids bands in this configuration; all such goals are united. */
static bool avoidances(const mt_result_goal *g, const char *configuration)
{
    return avoids_bands(g) && g->configuration != NULL &&
           strcmp(g->configuration, configuration) == 0;
}

/* True where all goals that avoid bands in the configuration are met. */
static bool is_clear(const mt_recommendation *r, const char *configuration)
{
    for (int i = 0; i < r->n_goals; i++) {
        if (avoidances(&r->goals[i], configuration) && !r->goals[i].met) {
            return false;
        }
    }
    return true;
}

/* True where the mode is outside the band, or within the tolerance of its goals, which are
 * met. */
static bool is_kept(double room, bool clear)
{
    return clear || !(PERCENT * room < -MT_PERCENT_NOISE);
}

static void put_band(sheet *s, const mt_result_mode_placement *band, bool clear,
                     const char *requirement, bool named)
{
    const nearest was = s->before != NULL ? nearest_to(s->before, band) : (nearest){.mode = 0};
    const nearest is = nearest_to(s->after, band);
    const bool kept = is_kept(is.room, clear);
    const row r = {.requirement = requirement,
                   .limit = outside_text(s, band, named),
                   .before = was.mode > 0 ? mode_text(s, was.hz, was.mode) : NULL,
                   .after = mode_text(s, is.hz, is.mode),
                   .worst = mode_text(s, is.worst_hz, is.mode),
                   .margin = margin_text(s, PERCENT * is.room),
                   .verdict = kept ? "met" : "not met",
                   .good = kept};
    add_requirement_row(s, &r);
}

/* The shown band of a configuration with the least margin; NULL: none. */
static const mt_result_mode_placement *tightest_of(const mt_recommendation *r,
                                                   const char *configuration, double *room)
{
    const mt_result_mode_placement *tightest = NULL;
    *room = HUGE_VAL;
    for (int i = 0; i < r->n_placements; i++) {
        if (strcmp(r->placements[i].configuration, configuration) != 0) {
            continue;
        }
        const double own = nearest_to(r, &r->placements[i]).room;
        if (tightest == NULL || mt_exceeds(*room, own)) {
            tightest = &r->placements[i];
            *room = isnan(own) ? HUGE_VAL : own;
        }
    }
    return tightest;
}

/* Add all bands of the configuration of goal i, or, of many, that with the least margin, at the
 * first of its goals; false where no band explains an unmet goal. */
static bool put_bands(sheet *s, int i)
{
    const mt_recommendation *const d = s->after;
    const mt_result_goal *const g = &d->goals[i];
    if (g->configuration == NULL) {
        return false;
    }
    const bool clear = is_clear(d, g->configuration);
    double least = 0.0;
    const mt_result_mode_placement *const tightest = tightest_of(d, g->configuration, &least);
    if (tightest == NULL || is_kept(least, clear) != clear) {
        return false;
    }
    for (int k = 0; k < i; k++) {
        if (avoidances(&d->goals[k], g->configuration)) {
            return true;
        }
    }
    for (int k = 0; k < d->n_placements && d->n_placements <= BANDS_TOLD; k++) {
        const mt_result_mode_placement *const b = &d->placements[k];
        if (strcmp(b->configuration, g->configuration) == 0) {
            put_band(s, b, clear,
                     mt_arena_printf(&s->t.mem, "%s: no mode in %s%s", g->configuration,
                                     b->band, with_margin(s, b)),
                     false);
        }
    }
    if (d->n_placements > BANDS_TOLD) {
        put_band(s, tightest, clear, g->text, true);
    }
    return true;
}

/* Add the mode nearest to a band between positions of a drive. */
static bool put_motion(sheet *s, const mt_result_goal *g, int which)
{
    const mt_result_motion *const m =
        which < s->after->n_motions ? &s->after->motions[which] : NULL;
    const mt_result_mode_placement *const band =
        m == NULL ? NULL : band_of(s->after, m->band_id);
    char at[MT_NUMBER_TEXT];
    if (m == NULL || band == NULL || isnan(m->hz)) {
        return false;
    }
    const char *const unit = m->display_unit != NULL ? m->display_unit : m->unit;
    const row r = {
        .requirement = mt_arena_printf(&s->t.mem, "%s: no mode in a band", g->quantity),
        .limit = outside_text(s, band, true),
        .after = mt_arena_printf(
            &s->t.mem, "%s at %s %s", mode_text(s, m->hz, m->mode),
            mt_report_number(mt_result_shown(m->at, m->display_factor), PERCENT_DIGITS, at),
            unit),
        .margin = margin_text(s, PERCENT * room_of(band, m->hz)),
        .verdict = verdict_of(g),
        .good = is_good(g)};
    add_requirement_row(s, &r);
    return true;
}

/*
 * Numbers
 */

static const char *goal_unit(const mt_result_goal *g)
{
    return g->display_unit != NULL ? g->display_unit : g->unit != NULL ? g->unit : "";
}

static const char *value_text(sheet *s, const mt_result_goal *g, double value)
{
    char number[MT_NUMBER_TEXT];
    const char *const unit = goal_unit(g);
    return isnan(value)
               ? NULL
               : mt_arena_printf(&s->t.mem, "%s%s%s",
                                 mt_report_number(mt_result_shown(value, g->display_factor),
                                                  LIMIT_DIGITS, number),
                                 unit[0] != '\0' ? " " : "", unit);
}

/* A limit as a person wrote it: without the zeros that fill a column. */
static const char *limit_text(sheet *s, const mt_result_goal *g)
{
    mt_arena *const mem = &s->t.mem;
    const char *const unit = goal_unit(g);
    const char *const gap = unit[0] != '\0' ? " " : "";
    const double low = mt_result_shown(g->at_least, g->display_factor);
    const double high = mt_result_shown(g->at_most, g->display_factor);
    if (g->target == 0.0 && g->weighted) {
        return "least";
    }
    if (!isnan(g->target)) {
        const double target = mt_result_shown(g->target, g->display_factor);
        return g->weighted || !(g->tolerance_percent > TOLD_PERCENT)
                   ? mt_arena_printf(mem, "%.*g%s%s", ASKED_DIGITS, target, gap, unit)
                   : mt_arena_printf(mem, "%.*g%s%s within %.3g %%", ASKED_DIGITS, target, gap,
                                     unit, g->tolerance_percent);
    }
    if (!isnan(low) && !isnan(high)) {
        return mt_arena_printf(mem, "%.*g to %.*g%s%s", ASKED_DIGITS, low, ASKED_DIGITS, high,
                               gap, unit);
    }
    if (isnan(low) && isnan(high)) {
        return NULL;
    }
    return mt_arena_printf(mem, "at %s %.*g%s%s%s", isnan(low) ? "most" : "least", ASKED_DIGITS,
                           isnan(low) ? high : low, gap, unit,
                           avoids_bands(g) ? " clearance" : "");
}

/* A difference relative to a number; NaN for 0. */
static double relative_difference(double way, double of)
{
    return of < 0.0 || of > 0.0 ? way / fabs(of) : nan("");
}

/* The distance from a limit, or the deviation from a target. */
static const char *number_margin(sheet *s, const mt_result_goal *g, double value)
{
    if (!isnan(g->target)) {
        char number[MT_NUMBER_TEXT];
        const double off = PERCENT * fabs(relative_difference(value - g->target, g->target));
        (void)mt_report_number(mt_without_noise(off, MT_PERCENT_NOISE), PERCENT_DIGITS, number);
        return isnan(off) ? NULL : mt_arena_printf(&s->t.mem, "off by %s %%", number);
    }
    const double above = relative_difference(value - g->at_least, g->at_least);
    const double below = relative_difference(g->at_most - value, g->at_most);
    const double room = isnan(above) || below < above ? below : above;
    return margin_text(s, PERCENT * room);
}

static void put_number(sheet *s, const mt_result_goal *g, const mt_result_goal *was)
{
    const double judged = isnan(g->worst) ? g->value : g->worst;
    const row r = {.requirement = g->quantity,
                   .limit = limit_text(s, g),
                   .before = was == NULL ? NULL : value_text(s, was, was->value),
                   .after = value_text(s, g, g->value),
                   .worst = value_text(s, g, g->worst),
                   .margin = number_margin(s, g, judged),
                   .verdict = verdict_of(g),
                   .good = is_good(g)};
    add_requirement_row(s, &r);
}

/* The limited quantity of a goal without its configuration. */
static const char *anywhere(const mt_result_goal *g)
{
    const size_t n = g->configuration == NULL ? 0 : strlen(g->configuration);
    const bool led = n > 0 && strncmp(g->quantity, g->configuration, n) == 0;
    return led && g->quantity[n] == ' ' ? g->quantity + n + 1 : g->quantity;
}

/* Add a limit between the positions that the goal names, which is checked there, not
 * required. */
static void put_between(sheet *s, const mt_result_between *b)
{
    char number[MT_NUMBER_TEXT];
    const mt_recommendation *const d = s->after;
    for (int i = 0; i < d->n_goals; i++) {
        const mt_result_goal *const g = &d->goals[i];
        if (strcmp(g->pointer, b->pointer) == 0) {
            const row r = {
                .requirement = mt_arena_printf(&s->t.mem, "between the positions of %s: %s",
                                               b->drive, anywhere(g)),
                .limit = limit_text(s, g),
                .after = value_text(s, g, b->value),
                .margin = isfinite(b->violation_percent) && b->violation_percent > 0.0
                              ? mt_arena_printf(&s->t.mem, "-%s %%",
                                                mt_report_number(b->violation_percent,
                                                                 PERCENT_DIGITS, number))
                              : number_margin(s, g, b->value),
                .verdict = b->holds ? "kept (sampled)" : "exceeded",
                .good = b->holds};
            add_requirement_row(s, &r);
            return;
        }
    }
}

/* The value of goal i at the original design, NULL: none. Its goals are in the same order, but
 * that of a motion may be missing. */
static const mt_result_goal *goal_before(const sheet *s, int i)
{
    const mt_result_goal *const g = &s->after->goals[i];
    if (s->before == NULL || i >= s->before->n_goals ||
        strcmp(s->before->goals[i].quantity, g->quantity) != 0 ||
        strcmp(s->before->goals[i].pointer, g->pointer) != 0) {
        return NULL;
    }
    return &s->before->goals[i];
}

static sheet sheet_of(const mt_result *result, const mt_recommendation *r)
{
    sheet s = {.t = mt_table_default(), .after = r, .worst = r->worst_case != NULL};
    s.before = r->rank > 0 && r->n_parameters > 0 ? &result->baseline : NULL;
    mt_table_column(&s.t, "requirement", "requirement", MT_ALIGN_LEFT);
    mt_table_column(&s.t, "limit", "limit", MT_ALIGN_LEFT);
    if (s.before != NULL) {
        mt_table_column(&s.t, "before", "before", MT_ALIGN_LEFT);
    }
    mt_table_column(&s.t, s.before != NULL ? "after" : "value", "after", MT_ALIGN_LEFT);
    if (s.worst) {
        mt_table_column(&s.t, "at worst", "worst", MT_ALIGN_LEFT);
    }
    mt_table_column(&s.t, "margin", "margin", MT_ALIGN_RIGHT);
    mt_table_column(&s.t, "verdict", "verdict", MT_ALIGN_LEFT);
    return s;
}

/* requirement, limit, before, after (of the original design: value), at worst, margin, verdict.
 * Margin: distance of the value from its limit in per cent of the limit; negative beyond it.
 * The caller frees the table. */
static mt_table report_compliance(const mt_result *result, const mt_recommendation *r)
{
    sheet s = sheet_of(result, r);
    int motions = 0;
    for (int i = 0; i < r->n_goals && !s.t.failed; i++) {
        const mt_result_goal *const g = &r->goals[i];
        const bool avoid = avoids_bands(g);
        const bool motion = avoid && g->configuration == NULL;
        const bool put_as_bands = motion  ? put_motion(&s, g, motions++)
                                  : avoid ? put_bands(&s, i)
                                          : false;
        if (!put_as_bands) {
            put_number(&s, g, goal_before(&s, i));
        }
    }
    for (int i = 0; i < r->n_between && !s.t.failed; i++) {
        put_between(&s, &r->between[i]);
    }
    s.t.failed = s.t.failed || mt_arena_check(&s.t.mem, NULL) != MT_OK;
    return s.t;
}

/* The summary. */

enum {
    INDENT = 2,
    SUMMARY_DIGITS = 4,
    SHOWN = 20 /* of more designs a page draws figures only */
};

static void add_heading(const mt_summary_writer *to, const char *title)
{
    if (to->html) {
        mt_text_add(to->out, "<h2>");
        mt_html_escape(title, to->out);
        mt_text_add(to->out, "</h2>\n");
    } else {
        mt_text_addf(to->out, "\n%s\n", title);
    }
}

static void add_table(const mt_summary_writer *to, mt_table t, const char *title)
{
    if (mt_table_rows(&t) > 0 || t.failed) {
        add_heading(to, title);
        if (to->html) {
            mt_table_html(&t, to->out);
        } else {
            mt_table_print(&t, INDENT, to->width, to->out);
        }
    }
    mt_table_free(&t);
}

/* A paragraph, of which `line` is the text; freed. */
static void add_paragraph(const mt_summary_writer *to, const char *indent, mt_text *line)
{
    const char *const text = line->s == NULL ? "" : line->s;
    if (to->html) {
        mt_text_add(to->out, "<p>");
        mt_html_escape(text, to->out);
        mt_text_add(to->out, "</p>\n");
    } else {
        mt_text_addf(to->out, "%s%s\n", indent, text);
    }
    to->out->failed = to->out->failed || line->failed;
    mt_text_free(line);
}

static void add_indented_paragraph(const mt_summary_writer *to, mt_text *line)
{
    add_paragraph(to, "  ", line);
}

/* True where the section was computed. A section that a stopped run left out says so. */
static bool is_section_known(const mt_summary_writer *to, const char *title, const void *items)
{
    if (items == NULL) {
        mt_text line = {0};
        mt_text_add(&line, "not computed: the run was stopped before");
        add_heading(to, title);
        add_indented_paragraph(to, &line);
    }
    return items != NULL;
}

/* The head of a list of n items; false where there are none. */
static bool open_list(const mt_summary_writer *to, const char *title, int n)
{
    if (n > 0) {
        add_heading(to, title);
        mt_text_add(to->out, to->html ? "<ul>\n" : "");
    }
    return n > 0;
}

static void close_list(const mt_summary_writer *to)
{
    mt_text_add(to->out, to->html ? "</ul>\n" : "");
}

/* word: before the text, in bold; "": none */
static void add_item(const mt_summary_writer *to, const char *word, const char *text)
{
    const char *const colon = word[0] == '\0' ? "" : ": ";
    if (to->html) {
        mt_text_addf(to->out, word[0] == '\0' ? "<li>%s%s" : "<li><b>%s</b>%s", word, colon);
        mt_html_escape(text, to->out);
        mt_text_add(to->out, "</li>\n");
    } else {
        mt_text_addf(to->out, "  - %s%s%s\n", word, colon, text);
    }
}

static void write_ruler(const mt_summary_writer *to, const mt_recommendation *r)
{
    mt_text ruler = {.s = NULL};
    mt_report_ruler(r, to->width, &ruler);
    if (ruler.s != NULL) {
        add_heading(to, "Frequency ruler");
        mt_text_add(to->out, ruler.s);
    }
    to->out->failed = to->out->failed || ruler.failed;
    mt_text_free(&ruler);
}

/* Write the reasons of a design. */
static void write_reasons(const mt_summary_writer *to, const mt_recommendation *r)
{
    static const struct {
        const char *kind;
        const char *title;
    } parts[] = {{"change", "Why: what changes"},
                 {"hold", "Why: what holds it"},
                 {"cost", "Why: what it costs"},
                 {"rank", "Why: how it stands"}};
    mt_text_add(to->out, to->html && r->n_reasons > 0 ? "<div class=\"parts\">\n" : "");
    for (int k = 0; k < MT_COUNT(parts); k++) {
        bool open = false;
        for (int i = 0; i < r->n_reasons; i++) {
            if (strcmp(r->reasons[i].kind, parts[k].kind) == 0) {
                mt_text_add(to->out, to->html && !open ? "<div>" : "");
                open = open || open_list(to, parts[k].title, 1);
                add_item(to, "", r->reasons[i].text);
            }
        }
        if (open) {
            close_list(to);
            mt_text_add(to->out, to->html ? "</div>\n" : "");
        }
    }
    mt_text_add(to->out, to->html && r->n_reasons > 0 ? "</div>\n" : "");
}

/* Add an item of a text that is freed afterwards. */
static void add_made(const mt_summary_writer *to, mt_text *text)
{
    add_item(to, "", text->s == NULL ? "" : text->s);
    to->out->failed = to->out->failed || text->failed;
    mt_text_free(text);
}

static void add_sentences(const mt_summary_writer *to, const char *title, int n,
                          const char *const *items)
{
    if (open_list(to, title, n)) {
        for (int i = 0; i < n; i++) {
            add_item(to, "", items[i]);
        }
        close_list(to);
    }
}

void mt_report_warning(const mt_warning *d, bool with_place, mt_text *out)
{
    if (with_place && d->file != NULL) { /* "stick.json:12:9: " as far as it is known */
        mt_text_addf(out, "%s", d->file);
        if (d->line > 0) {
            mt_text_addf(out, ":%d:%d", d->line, d->column);
        }
        mt_text_add(out, ": ");
    }
    if (with_place && d->pointer != NULL && d->pointer[0] != '\0') {
        mt_text_addf(out, "%s: ", d->pointer);
    }
    if (d->configuration != NULL) {
        mt_text_addf(out, "%s: ", d->configuration);
    }
    mt_text_addf(out, "%s", d->text);
}

static void add_warnings(const mt_summary_writer *to, const char *title, int n,
                         const mt_warning *items)
{
    if (open_list(to, title, n)) {
        for (int i = 0; i < n; i++) {
            mt_text text = {.s = NULL};
            mt_report_warning(&items[i], true, &text);
            add_made(to, &text);
        }
        close_list(to);
    }
}

/* True where both notes have the same text, in any configuration. */
static bool is_same_fact(const mt_warning *a, const mt_warning *b)
{
    return a->configuration != NULL && b->configuration != NULL &&
           strcmp(a->text, b->text) == 0;
}

/* Write note i with all configurations that have it; nothing where an earlier one has listed
 * it. */
static void write_fact(int i, int n, const mt_warning *items, mt_text *text)
{
    for (int k = 0; k < i; k++) {
        if (is_same_fact(&items[k], &items[i])) {
            return;
        }
    }
    for (int k = i; k < n && items[i].configuration != NULL; k++) {
        if (k == i || is_same_fact(&items[i], &items[k])) {
            mt_text_addf(text, "%s%s", k == i ? "" : ", ", items[k].configuration);
        }
    }
    mt_text_addf(text, "%s%s", items[i].configuration == NULL ? "" : ": ", items[i].text);
}

static void write_facts(const mt_summary_writer *to, int n, const mt_warning *items)
{
    if (open_list(to, "Notes on the model", n)) {
        for (int i = 0; i < n; i++) {
            mt_text text = {.s = NULL};
            write_fact(i, n, items, &text);
            if (text.s != NULL || text.failed) {
                add_made(to, &text);
            }
        }
        close_list(to);
    }
}

void mt_tell_warnings(const mt_summary_writer *to, const mt_result *result)
{
    if (result->n_doubts > 0 && to->html) {
        mt_text_add(to->out, "<div class=\"doubts\">\n");
    }
    add_warnings(to, "Warnings of the model and the study", result->n_doubts, result->doubts);
    if (result->n_doubts > 0 && to->html) {
        mt_text_add(to->out, "</div>\n");
    }
    if (!to->html) { /* a page tells them with its warnings */
        write_facts(to, result->n_facts, result->facts);
    }
}

void mt_write_objectives(const mt_summary_writer *to, const mt_recommendation *r)
{
    add_table(to, mt_report_objectives(r), "Objectives");
}

static void write_parameters(const mt_summary_writer *to, const mt_recommendation *r)
{
    add_table(to, mt_report_parameters(r), "Parameters");
    for (int i = 0; i < r->n_parameters; i++) {
        mt_text line = {0};
        if (mt_report_measure(&r->parameters[i], &line)) {
            add_indented_paragraph(to, &line);
        }
    }
}

/* "Recommendation 1 (feasible): mass 16.94 kg (was 11.92), total change 0.0828" */
static void write_rank(const mt_summary_writer *to, const mt_recommendation *r)
{
    char change[MT_NUMBER_TEXT];
    mt_text title = {0};
    mt_text headline = {0};
    mt_text_addf(&title, "Recommendation %d (%s)", r->rank,
                 r->grade == NULL ? "not graded" : r->grade);
    mt_text_add(&title, report_headline(r, &headline) ? ": " : "");
    mt_text_add(&title, headline.s == NULL ? "" : headline.s);
    mt_text_addf(&title, ", total change %s%s",
                 mt_report_number(r->change, SUMMARY_DIGITS, change),
                 r->singular ? ", a double solution: its parameters are sensitive" : "");
    add_heading(to, title.s == NULL ? "" : title.s);
    to->out->failed = to->out->failed || title.failed || headline.failed;
    mt_text_free(&headline);
    mt_text_free(&title);
}

/* Its numbers; the original design has no parameters to tell. */
static void write_numbers(const mt_summary_writer *to, const mt_result *result,
                          const mt_recommendation *r)
{
    (void)result;
    const bool found = r->rank > 0;
    if (!(found && r->n_parameters > 0 && r->n_objectives == 1 &&
          r->objectives[0].recommended == r->change)) { /* else its heading has it */
        mt_write_objectives(to, r);
    }
    if (found) {
        write_parameters(to, r);
    }
    add_table(to, mt_report_frequencies(r),
              found ? "Frequencies" : "Frequencies of the original design");
    if (!to->html) {
        write_ruler(to, r);
    }
    if (to->html) {
        add_table(to, mt_report_placements(r), "Bands");
    }
    add_table(to, mt_report_clearances(r), "Clearances from bands");
    add_table(to, mt_report_motions(r), "Over the range of motion");
}

/* Write the requirements compared with this design. */
static void write_compliance(const mt_summary_writer *to, const mt_result *result,
                             const mt_recommendation *r)
{
    static const char title[] = "Requirements";
    if (!to->html) {
        add_table(to, report_compliance(result, r), title);
        return;
    }
    mt_text_add(to->out, "<div class=\"compliance\">\n");
    add_table(to, report_compliance(result, r), title);
    if (r->n_goals > 0) {
        mt_text_add(to->out, "<p class=\"lead\">Margin: what is left to the limit, in per "
                             "cent of it; below 0 the limit is exceeded.</p>\n");
    }
    mt_text_add(to->out, "</div>\n");
}

static void write_design(const mt_summary_writer *to, const mt_result *result,
                         const mt_recommendation *r)
{
    if (r->rank > 0 && r->n_parameters > 0) {
        write_rank(to, r);
    }
    write_compliance(to, result, r);
    write_numbers(to, result, r);
    write_reasons(to, r);
}

void mt_write_uncertainty(const mt_summary_writer *to, const mt_result *result)
{
    static const char unidentifiable[] =
        "Not identifiable: directions along which the goals hardly change";
    static const char weight_sensitivity[] =
        "Sensitivity to the weights (the scatter of repeated tests may be many times larger)";
    if (is_section_known(to, unidentifiable, result->unidentifiable) &&
        open_list(to, unidentifiable, result->n_unidentifiable)) {
        for (int i = 0; i < result->n_unidentifiable; i++) {
            const mt_unidentifiable_direction *const u = &result->unidentifiable[i];
            mt_text text = {0};
            mt_text_addf(&text, "%s", u->text);
            if (!isnan(u->effect_percent)) {
                char effect[MT_NUMBER_TEXT];
                mt_text_addf(&text, " (changes no goal by more than %s %% from bound to bound)",
                             mt_report_number(fmax(u->effect_percent, MT_PERCENT_NOISE),
                                              SUMMARY_DIGITS, effect));
            }
            add_made(to, &text);
        }
        close_list(to);
    }
    if (is_section_known(to, weight_sensitivity, result->weight_sensitivity)) {
        add_table(to, mt_report_weight_sensitivity(result), weight_sensitivity);
    }
}

static void write_certificates(const mt_summary_writer *to, const mt_result *result)
{
    static const char title[] = "What is proven";
    if (is_section_known(to, title, result->certificates) &&
        open_list(to, title, result->n_certificates)) {
        for (int i = 0; i < result->n_certificates; i++) {
            const mt_certificate *const c = &result->certificates[i];
            add_item(to, c->proven ? "proven" : "sampled", c->text);
        }
        close_list(to);
    }
}

static void write_trade(const mt_summary_writer *to, const mt_result *result)
{
    static const char title[] = "Trade study: the best design of each point";
    for (int i = 0; i < result->run.n_incomplete && result->trade == NULL; i++) {
        if (strcmp(result->run.incomplete[i], "trade") == 0) {
            (void)is_section_known(to, title, result->trade);
        }
    }
    if (result->trade != NULL) {
        mt_text line = {.s = NULL};
        add_table(to, mt_report_trade_selected(result), title);
        mt_report_trade_left(result, &line);
        if (line.length > 0 || line.failed) {
            add_paragraph(to, "  ", &line);
        }
    }
}

void mt_write_overrides(const mt_summary_writer *to, const mt_result_run *run)
{
    mt_text line = {.s = NULL};
    for (int i = 0; i < run->n_overrides; i++) {
        const mt_result_override *const o = &run->overrides[i];
        const bool parameter = strcmp(o->kind, "parameter") == 0;
        const char *const unit = o->display_unit != NULL ? o->display_unit : o->unit;
        mt_text_addf(&line, "%s%s%s = %.10g", i == 0 ? "Asked with " : ", ",
                     parameter ? "" : "search ", o->name,
                     mt_result_shown(o->value, o->display_factor));
        mt_text_addf(&line, parameter && unit != NULL ? " %s" : "%s",
                     parameter && unit != NULL ? unit : "");
        if (!isnan(o->original)) {
            mt_text_addf(&line, " (%s: %.10g)", parameter ? "model" : "study",
                         mt_result_shown(o->original, o->display_factor));
        }
    }
    if (run->n_overrides > 0) {
        mt_text_add(&line, ".");
        add_paragraph(to, "", &line);
    }
}

void mt_report_work_counters(const mt_result_run *run, mt_text *out)
{
    const mt_result_work_counters *const s = &run->spent;
    const struct {
        const char *name;
        long n;
    } parts[] = {{"search", s->search},
                 {"positions", s->positions},
                 {"descriptions", s->descriptions},
                 {"spread", s->weight_sensitivity},
                 {"relaxations", s->relaxations},
                 {"trade", s->trade}};
    int told = 0;
    mt_text_addf(out, "%ld evaluations", run->evaluations);
    for (int i = 0; i < MT_COUNT(parts); i++) {
        if (parts[i].n > 0) {
            mt_text_addf(out, "%s%s %ld", told++ == 0 ? " (" : ", ", parts[i].name, parts[i].n);
        }
    }
    mt_text_add(out, told > 0 ? ")" : "");
    mt_text_addf(out, ", %ld modal solutions", run->modal_solutions);
    if (s->multiplications > 0) {
        char work[MT_NUMBER_TEXT];
        mt_text_addf(out, ", %s multiplications of proofs",
                     mt_report_number((double)s->multiplications, 2, work));
    }
}

static void write_relaxations(const mt_summary_writer *to, const mt_result *result)
{
    static const char title[] = "What would make it feasible, one change at a time";
    if (is_section_known(to, title, result->relaxations) &&
        open_list(to, title, result->n_relaxations)) {
        for (int i = 0; i < result->n_relaxations; i++) {
            add_item(to, "", result->relaxations[i].text);
        }
        close_list(to);
    }
}

static void write_published(const mt_summary_writer *to, const mt_result *result)
{
    static const char title[] = "Published against computed";
    if (is_section_known(to, title, result->published)) {
        add_table(to, mt_report_published(result), title);
    }
}

static void write_responses(const mt_summary_writer *to, const mt_result *result,
                            const mt_recommendation *r)
{
    if (open_list(to, "Responses", result->n_curves)) {
        for (int k = 0; k < result->n_curves; k++) {
            mt_text text = {.s = NULL};
            mt_report_curve(result, k, r, &text);
            add_made(to, &text);
        }
        close_list(to);
    }
}

/* Write the values of unchecked designs, of which nothing else is known. */
static void write_unchecked(const mt_summary_writer *to, const mt_result *result)
{
    if (open_list(to, "Not re-checked before the end: values of the variables, unverified",
                  result->n_unchecked)) {
        for (int i = 0; i < result->n_unchecked; i++) {
            mt_text text = {0};
            mt_text_addf(&text, "%s", result->unchecked[i].text);
            add_made(to, &text);
        }
        close_list(to);
    }
}

/* The best design (goals, frequencies, parameters, reasons), or the original one where there is
 * none; alternatives, directions that are not identifiable, what is proven, relaxations,
 * unchecked designs, warnings. */
static void write_answer(const mt_summary_writer *to, const mt_result *result,
                         bool with_published)
{
    mt_write_overrides(to, &result->run);
    mt_tell_warnings(to, result);
    const mt_recommendation *const best =
        result->n_recommendations > 0 ? &result->recommendations[0] : &result->baseline;
    write_design(to, result, best);
    write_responses(to, result, best);
    if (result->n_recommendations > 1) {
        add_table(to, mt_report_alternatives(result), "Designs side by side");
    }
    mt_write_uncertainty(to, result);
    write_trade(to, result);
    write_certificates(to, result);
    write_relaxations(to, result);
    if (with_published) {
        write_published(to, result);
    }
    write_unchecked(to, result);
    add_sentences(to, "Warnings", result->n_warnings, result->warnings);
}

/* Add a place for a figure of the page's script. */
static void keep_place(const mt_summary_writer *to, const char *id)
{
    mt_text_addf(to->out, "<div id=\"%s\"></div>\n", id);
}

typedef void mt_write_statement(const mt_summary_writer *to, const mt_result *result,
                                const mt_recommendation *r);

/* A part of the page for each design, the first of which is shown until another is chosen; of
 * the original one where there is none. */
static void write_each(const mt_summary_writer *to, const mt_result *result,
                       mt_write_statement *tell)
{
    const int found = result->n_recommendations;
    const mt_recommendation *const first =
        found > 0 ? result->recommendations : &result->baseline;
    for (int i = 0; i < SHOWN && (i < found || i == 0); i++) {
        mt_text_addf(to->out, "<section data-rank=\"%d\"%s>\n", first[i].rank,
                     i == 0 ? "" : " hidden");
        tell(to, result, &first[i]);
        mt_text_add(to->out, "</section>\n");
    }
}

static void write_why(const mt_summary_writer *to, const mt_result *result,
                      const mt_recommendation *r)
{
    (void)result;
    if (r->rank > 0 && r->n_parameters > 0) {
        write_rank(to, r);
    }
    write_reasons(to, r);
}

void mt_write_page(mt_text *out, const mt_result *result)
{
    static const char *const first[] = {"place-choice", "place-alternatives",
                                        "place-frequencies", "place-parameters"};
    const mt_summary_writer to = {.out = out, .html = true};
    mt_write_overrides(&to, &result->run);
    mt_tell_warnings(&to, result);
    write_each(&to, result, write_compliance);
    for (int i = 0; i < MT_COUNT(first); i++) {
        keep_place(&to, first[i]);
    }
    write_each(&to, result, write_why);
    write_relaxations(&to, result);
    mt_write_uncertainty(&to, result);
    write_certificates(&to, result);
    write_unchecked(&to, result);
    add_sentences(&to, "Warnings", result->n_warnings, result->warnings);
    write_facts(&to, result->n_facts, result->facts);
    keep_place(&to, "place-mechanism");
    keep_place(&to, "figures");
    mt_text_add(out, "<details id=\"told\">\n<summary>All numbers as tables</summary>\n");
    write_each(&to, result, write_numbers);
    if (result->n_recommendations > 1) {
        mt_text_add(out, "<div class=\"drawn\">\n");
        add_table(&to, mt_report_alternatives(result), "Designs side by side");
        mt_text_add(out, "</div>\n");
    }
    add_table(&to, mt_report_extremes(result, SHOWN), "Peaks and antiresonances");
    write_trade(&to, result);
    write_published(&to, result);
    mt_text_add(out, "</details>\n");
    keep_place(&to, "place-origin");
}

void mt_report_summary(const mt_result *result, bool with_published, int width, mt_text *out)
{
    const char *const name =
        result->study.name == NULL ? result->study.file : result->study.name;
    mt_text_addf(out, "%s\n%s\n", name == NULL ? "study" : name,
                 result->status_text == NULL ? mt_result_status_name(result->status)
                                             : result->status_text);
    write_answer(&(mt_summary_writer){.out = out, .width = width}, result, with_published);
}
