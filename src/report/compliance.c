/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/compliance.h"

#include <math.h>
#include <string.h>

#include "base/base.h"
#include "base/number.h"
#include "report/number.h"

enum {
    HZ_DIGITS = 6,
    VALUE_DIGITS = 6,
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
                                                  VALUE_DIGITS, number),
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

mt_table mt_report_compliance(const mt_result *result, const mt_recommendation *r)
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
