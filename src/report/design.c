/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A design in words and tables: its requirements, parameters, frequencies and bands. */
#include "report/design.h"

#include <math.h>
#include <string.h>

#include "base/base.h"
#include "base/format.h"
#include "base/number.h"
#include "report/table.h"

/* Parameters and frequencies to 6 digits, as a drawing would give them: that shows changes of
 * 1e-5. Percentages need no more than 3. */
enum {
    VALUE_DIGITS = 6,
    HZ_DIGITS = 6,
    PERCENT_DIGITS = 3,
    MAC_DIGITS = 5,
    SUMMARY_DIGITS = 4,
    REQUIREMENT_TEXT = 120
};

/* Parameters, which people see in the units that they gave them in. */

/* name, unit, original, recommended, change, bound; and the part that each comes from, where
 * some do. */
static mt_table parameters_table(const mt_recommendation *r)
{
    mt_table t = mt_table_default();
    bool parts = false;
    for (int i = 0; i < r->n_parameters; i++) {
        parts = parts || r->parameters[i].catalogue != NULL;
    }
    mt_table_column(&t, "parameter", "name", MT_ALIGN_LEFT);
    mt_table_column(&t, "unit", "unit", MT_ALIGN_LEFT);
    mt_table_column(&t, "before", "original", MT_ALIGN_POINT);
    mt_table_column(&t, "after", "recommended", MT_ALIGN_POINT);
    mt_table_column(&t, "change [%]", "change_percent", MT_ALIGN_POINT);
    mt_table_column(&t, "at bound", "at_bound", MT_ALIGN_LEFT);
    if (parts) {
        mt_table_column(&t, "catalogue", "catalogue", MT_ALIGN_LEFT);
        mt_table_column(&t, "part", "part", MT_ALIGN_LEFT);
    }
    for (int i = 0; i < r->n_parameters; i++) {
        const mt_result_parameter *const p = &r->parameters[i];
        mt_table_text(&t, p->name);
        mt_table_unit(&t, p->unit, p->display_unit);
        mt_table_shown(&t, p->original, p->display_factor, VALUE_DIGITS);
        mt_table_shown(&t, p->recommended, p->display_factor, VALUE_DIGITS);
        mt_table_percent(&t, p->change_percent, PERCENT_DIGITS);
        mt_table_text(&t, p->at_bound);
        if (parts) {
            mt_table_text(&t, p->catalogue);
            mt_table_text(&t, p->part);
        }
    }
    return t;
}

/* The measure of a parameter's change as a sentence; false (and no text) where it is the plain
 * logarithm. */
static bool measure_sentence(const mt_result_parameter *p, mt_text *out)
{
    char number[MT_NUMBER_TEXT];
    const char *const name = p->display_unit != NULL ? p->display_unit : p->unit;
    const char *const space = name == NULL ? "" : " ";
    const char *const unit = name == NULL ? "" : name;
    const double factor = p->display_factor;
    if (p->measure_floor > 0.0) {
        mt_text_addf(
            out, "The change of %s counts as ln(new/original), below %s%s%s linearly.", p->name,
            mt_report_number(mt_result_shown(p->measure_floor, factor), VALUE_DIGITS, number),
            space, unit);
        return true;
    }
    if (p->measure_scale > 0.0) {
        mt_text_addf(
            out, "The change of %s counts linearly, %s%s%s as 1.", p->name,
            mt_report_number(mt_result_shown(p->measure_scale, factor), VALUE_DIGITS, number),
            space, unit);
        return true;
    }
    return false;
}

/* Modes. */

/* "18.0000", "at least 7.00000", "7.00000 to 9.00000", NULL where nothing is asked */
static const char *requirement_of(const mt_result_frequency *f, char *s, size_t size)
{
    char a[MT_NUMBER_TEXT];
    char b[MT_NUMBER_TEXT];
    (void)mt_report_number(f->at_least_hz, HZ_DIGITS, a);
    (void)mt_report_number(f->at_most_hz, HZ_DIGITS, b);
    if (!isnan(f->target_hz)) {
        return mt_report_number(f->target_hz, HZ_DIGITS, s);
    }
    if (!isnan(f->at_least_hz) && !isnan(f->at_most_hz)) {
        (void)mt_snprintf(s, size, "%s to %s", a, b);
    } else if (!isnan(f->at_least_hz)) {
        (void)mt_snprintf(s, size, "at least %s", a);
    } else if (!isnan(f->at_most_hz)) {
        (void)mt_snprintf(s, size, "at most %s", b);
    } else {
        return NULL;
    }
    return s;
}

/* "stick bending", "stick bending (ambiguous)" */
static void name_cell(mt_table *t, const mt_result_frequency *f)
{
    char text[REQUIREMENT_TEXT];
    if (f->name == NULL || f->identity == NULL || strcmp(f->identity, "tracked") == 0) {
        mt_table_text(t, f->name);
        return;
    }
    (void)mt_snprintf(text, sizeof text, "%.90s (%s)", f->name, f->identity);
    mt_table_text(t, text);
}

/* configuration, mode, name, original, recommended, target or limits, error, MAC with the
 * reference. */
static mt_table frequencies_table(const mt_recommendation *r)
{
    mt_table t = mt_table_default();
    const bool ranges = r->worst_case != NULL;
    mt_table_column(&t, "configuration", "configuration", MT_ALIGN_LEFT);
    mt_table_column(&t, "mode", "mode", MT_ALIGN_RIGHT);
    mt_table_column(&t, "name", "name", MT_ALIGN_LEFT);
    mt_table_column(&t, "before [Hz]", "original_hz", MT_ALIGN_POINT);
    mt_table_column(&t, "after [Hz]", "recommended_hz", MT_ALIGN_POINT);
    if (ranges) {
        mt_table_column(&t, "lowest [Hz]", "lowest_hz", MT_ALIGN_POINT);
        mt_table_column(&t, "highest [Hz]", "highest_hz", MT_ALIGN_POINT);
    }
    mt_table_column(&t, "asked [Hz]", "asked_hz", MT_ALIGN_RIGHT);
    mt_table_column(&t, "error [%]", "error_percent", MT_ALIGN_POINT);
    mt_table_column(&t, "MAC", "mac", MT_ALIGN_POINT);
    for (int i = 0; i < r->n_frequencies; i++) {
        const mt_result_frequency *const f = &r->frequencies[i];
        char requirement[REQUIREMENT_TEXT];
        mt_table_text(&t, f->configuration);
        mt_table_integer(&t, f->mode);
        name_cell(&t, f);
        mt_table_number(&t, f->original_hz, HZ_DIGITS);
        mt_table_number(&t, f->recommended_hz, HZ_DIGITS);
        if (ranges) {
            mt_table_number(&t, f->lowest_hz, HZ_DIGITS);
            mt_table_number(&t, f->highest_hz, HZ_DIGITS);
        }
        mt_table_text(&t, requirement_of(f, requirement, sizeof requirement));
        mt_table_percent(&t, f->error_percent, PERCENT_DIGITS);
        mt_table_number(&t, f->mac, MAC_DIGITS);
    }
    return t;
}

/* Objectives. */

static bool is_ratio(const char *unit)
{
    return unit == NULL || unit[0] == '\0' || strcmp(unit, "%") == 0;
}

/* An objective's value with rounding noise set to 0 where its size is known: for objectives
 * without a unit, and percentages. */
static double objective_value(const char *unit, double value)
{
    return is_ratio(unit) ? mt_without_noise(value, MT_RATIO_NOISE) : value;
}

void mt_report_objective_cell(mt_table *t, const char *unit, double value)
{
    if (is_ratio(unit)) {
        mt_table_ratio(t, value, VALUE_DIGITS);
    } else {
        mt_table_number(t, value, VALUE_DIGITS);
    }
}

/* text, unit, original, recommended of every objective. */
static mt_table objectives_table(const mt_recommendation *r)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, "objective", "text", MT_ALIGN_LEFT);
    mt_table_column(&t, "unit", "unit", MT_ALIGN_LEFT);
    mt_table_column(&t, "before", "original", MT_ALIGN_POINT);
    mt_table_column(&t, "after", "recommended", MT_ALIGN_POINT);
    for (int k = 0; k < r->n_objectives; k++) {
        const mt_design_objective *const o = &r->objectives[k];
        mt_table_text(&t, o->text);
        mt_table_text(&t, o->unit == NULL || o->unit[0] == '\0' ? NULL : o->unit);
        mt_report_objective_cell(&t, o->unit, o->original);
        mt_report_objective_cell(&t, o->unit, o->recommended);
    }
    return t;
}

bool mt_report_headline(const mt_recommendation *r, mt_text *out)
{
    char now[MT_NUMBER_TEXT];
    const mt_design_objective *const o = r->n_objectives > 0 ? &r->objectives[0] : NULL;
    if (o == NULL || !isfinite(o->recommended) || o->recommended == r->change) {
        return false;
    }
    mt_text_addf(
        out, "%s %s%s%s", o->text,
        mt_report_number(objective_value(o->unit, o->recommended), SUMMARY_DIGITS, now),
        o->unit != NULL && o->unit[0] != '\0' ? " " : "", o->unit != NULL ? o->unit : "");
    if (isfinite(o->original)) {
        char was[MT_NUMBER_TEXT];
        mt_text_addf(
            out, " (was %s)",
            mt_report_number(objective_value(o->unit, o->original), SUMMARY_DIGITS, was));
    }
    return true;
}

/* Distances from what is asked. */

/* A goal is met up to this many percent of it, unless it says otherwise. */
static const double LEFT_OPEN = 1e-4;

void mt_table_clearance(mt_table *t, double percent, double margin, int digits)
{
    char text[MT_NUMBER_TEXT];
    char exact[MT_NUMBER_TEXT];
    const bool kept = fabs(percent - margin) <= LEFT_OPEN * (1.0 + (0.01 * margin));
    mt_table_cell(t, mt_report_number(kept ? margin : percent, digits, text),
                  mt_report_exact(percent, exact));
}

void mt_table_off_by(mt_table *t, double percent, bool met, int digits)
{
    char text[MT_NUMBER_TEXT];
    char exact[MT_NUMBER_TEXT];
    const double shown = mt_without_noise(percent, met ? LEFT_OPEN : MT_PERCENT_NOISE);
    mt_table_cell(t, mt_report_change(shown, digits, text), mt_report_exact(percent, exact));
}

static void percent_cells(mt_table *t, const mt_recommendation *r, const mt_result_clearance *c)
{
    mt_table_clearance(t, c != NULL ? c->percent : nan(""), c != NULL ? c->margin_percent : 0.0,
                       PERCENT_DIGITS);
    if (r->worst_case != NULL) {
        mt_table_number(t, c != NULL ? c->worst_percent : nan(""), PERCENT_DIGITS);
    }
}

/* One row per drive with several positions: the least distance from a band between them. */
static mt_table motions_table(const mt_recommendation *r)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, "drive", "drive", MT_ALIGN_LEFT);
    mt_table_column(&t, "unit", "unit", MT_ALIGN_LEFT);
    mt_table_column(&t, "from", "from", MT_ALIGN_POINT);
    mt_table_column(&t, "to", "to", MT_ALIGN_POINT);
    mt_table_column(&t, "positions", "positions", MT_ALIGN_RIGHT);
    mt_table_column(&t, "mode", "mode", MT_ALIGN_RIGHT);
    mt_table_column(&t, "band", "band", MT_ALIGN_LEFT);
    mt_table_column(&t, "at", "at", MT_ALIGN_POINT);
    mt_table_column(&t, "[Hz]", "hz", MT_ALIGN_POINT);
    mt_table_column(&t, "clearance [%]", "clearance_percent", MT_ALIGN_POINT);
    mt_table_column(&t, "grade", "grade", MT_ALIGN_LEFT);
    for (int i = 0; i < r->n_motions; i++) {
        const mt_result_motion *const m = &r->motions[i];
        mt_table_text(&t, m->drive);
        mt_table_unit(&t, m->unit, m->display_unit);
        mt_table_shown(&t, m->from, m->display_factor, VALUE_DIGITS);
        mt_table_shown(&t, m->to, m->display_factor, VALUE_DIGITS);
        mt_table_integer(&t, m->positions);
        if (m->mode > 0) {
            mt_table_integer(&t, m->mode);
        } else {
            mt_table_text(&t, NULL);
        }
        mt_table_text(&t, m->band);
        mt_table_shown(&t, m->at, m->display_factor, VALUE_DIGITS);
        mt_table_number(&t, m->hz, HZ_DIGITS);
        mt_table_clearance(&t, m->least_clearance_percent, m->margin_percent, PERCENT_DIGITS);
        mt_table_text(&t, m->crosses ? "crosses a band" : m->grade);
    }
    return t;
}

mt_table mt_report_clearances(const mt_recommendation *r)
{
    mt_table t = mt_table_default();
    const bool worst = r->worst_case != NULL;
    mt_table_column(&t, "configuration", "configuration", MT_ALIGN_LEFT);
    mt_table_column(&t, "mode", "mode", MT_ALIGN_RIGHT);
    mt_table_column(&t, "[Hz]", "hz", MT_ALIGN_POINT);
    mt_table_column(&t, "above band", "above_band", MT_ALIGN_LEFT);
    mt_table_column(&t, "by [%]", "above_percent", MT_ALIGN_POINT);
    if (worst) {
        mt_table_column(&t, "at worst [%]", "above_worst_percent", MT_ALIGN_POINT);
    }
    mt_table_column(&t, "below band", "below_band", MT_ALIGN_LEFT);
    mt_table_column(&t, "by [%]", "below_percent", MT_ALIGN_POINT);
    if (worst) {
        mt_table_column(&t, "at worst [%]", "below_worst_percent", MT_ALIGN_POINT);
    }
    for (int i = 0; i < r->n_clearances; i++) {
        const mt_result_clearance *const c = &r->clearances[i];
        const mt_result_clearance *above = strcmp(c->side, "above") == 0 ? c : NULL;
        const mt_result_clearance *below = strcmp(c->side, "below") == 0 ? c : NULL;
        const bool inside = above == NULL && below == NULL;
        /* that of the same mode on the other side: the lists have its lower band first */
        if (above != NULL && i + 1 < r->n_clearances && c->mode == c[1].mode &&
            strcmp(c->configuration, c[1].configuration) == 0 &&
            strcmp(c[1].side, "below") == 0) {
            below = c + 1;
            i++;
        }
        mt_table_text(&t, c->configuration);
        mt_table_integer(&t, c->mode);
        mt_table_number(&t, c->hz, HZ_DIGITS);
        if (inside) {
            char text[REQUIREMENT_TEXT];
            (void)mt_snprintf(text, sizeof text, "inside %.100s", c->band);
            mt_table_text(&t, text);
        } else {
            mt_table_text(&t, above != NULL ? above->band : NULL);
        }
        percent_cells(&t, r, inside ? c : above);
        mt_table_text(&t, below != NULL ? below->band : NULL);
        percent_cells(&t, r, below);
    }
    return t;
}

/* Bands and the number of modes below each. */
static mt_table placements_table(const mt_recommendation *r)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, "configuration", "configuration", MT_ALIGN_LEFT);
    mt_table_column(&t, "band", "band", MT_ALIGN_LEFT);
    mt_table_column(&t, "from [Hz]", "lower_hz", MT_ALIGN_POINT);
    mt_table_column(&t, "to [Hz]", "upper_hz", MT_ALIGN_POINT);
    mt_table_column(&t, "with margin from", "margin_lower_hz", MT_ALIGN_POINT);
    mt_table_column(&t, "to", "margin_upper_hz", MT_ALIGN_POINT);
    mt_table_column(&t, "modes below", "modes_below", MT_ALIGN_RIGHT);
    for (int i = 0; i < r->n_placements; i++) {
        const mt_result_mode_placement *const g = &r->placements[i];
        mt_table_text(&t, g->configuration);
        mt_table_text(&t, g->band);
        mt_table_number(&t, g->lower_hz, HZ_DIGITS);
        mt_table_number(&t, g->upper_hz, HZ_DIGITS);
        mt_table_number(&t, g->margin_lower_hz, HZ_DIGITS);
        mt_table_number(&t, g->margin_upper_hz, HZ_DIGITS);
        mt_table_integer(&t, g->modes_below);
    }
    return t;
}

/*
 * The requirements compared with a design, as a compliance table: one row per requirement, or
 * per band where they are few; margins in hertz where the result has percentages.
 */

enum {
    LIMIT_DIGITS = 6,
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

static void verdict_cell(mt_table *t, const char *text, bool good)
{
    mt_table_text(t, text);
    if (!t->failed) {
        t->cells[t->n_cells - 1].mark = good ? "good" : "bad";
    }
}

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
        verdict_cell(&s->t, r->verdict, r->good);
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
static mt_table compliance_table(const mt_result *result, const mt_recommendation *r)
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

/* Rulers. */

enum { INDENT = 2, LEAST = 30, USUAL = 64, MOST = 96, ROOM = MOST + 16, NUMBER = 24 };
static const double ABOVE = 1.12; /* what is shown above the last thing asked for */
static const double NEAR = 1.6;   /* a band that begins farther above the modes is not shown */

typedef struct ruler {
    double top;    /* Hz at its end */
    int length;    /* columns */
    int label;     /* of the longest name */
    bool has[256]; /* marks that were drawn */
    mt_text *out;
} ruler;

static void raise_top_frequency(double *top, double hz)
{
    *top = isfinite(hz) && hz > *top ? hz : *top;
}

/* The highest mode that no band lies wholly below; 0: none. */
static double highest_mode(const mt_recommendation *r)
{
    double bands = 0.0;
    double top = 0.0;
    for (int i = 0; i < r->n_placements; i++) {
        raise_top_frequency(&bands, r->placements[i].margin_upper_hz);
    }
    for (int i = 0; i < r->n_frequencies; i++) {
        const mt_result_frequency *const f = &r->frequencies[i];
        raise_top_frequency(&top, f->original_hz <= bands ? f->original_hz : 0.0);
        raise_top_frequency(&top, f->recommended_hz <= bands ? f->recommended_hz : 0.0);
    }
    return top;
}

/* Widen the range by the required modes, recommended and original, that are not far above all
 * requirements. */
static void widen_asked(double *top, const mt_recommendation *r)
{
    const double near = NEAR * *top;
    for (int i = 0; i < r->n_frequencies; i++) {
        const mt_result_frequency *const f = &r->frequencies[i];
        const bool asked =
            isfinite(f->target_hz) || isfinite(f->at_least_hz) || isfinite(f->at_most_hz);
        raise_top_frequency(top, asked && f->original_hz <= near ? f->original_hz : 0.0);
        raise_top_frequency(top, asked && f->recommended_hz <= near ? f->recommended_hz : 0.0);
    }
}

/* The highest frequency of interest: what is asked for, and the bands beside modes; 0: none. */
static double highest(const mt_recommendation *r)
{
    double top = highest_mode(r);
    for (int i = 0; i < r->n_frequencies; i++) {
        raise_top_frequency(&top, r->frequencies[i].target_hz);
        raise_top_frequency(&top, r->frequencies[i].at_least_hz);
        raise_top_frequency(&top, r->frequencies[i].at_most_hz);
    }
    widen_asked(&top, r);
    const double near = top > 0.0 ? NEAR * top : HUGE_VAL;
    for (int i = 0; i < r->n_placements; i++) {
        if (r->placements[i].margin_lower_hz <= near) {
            raise_top_frequency(&top, fmin(r->placements[i].margin_upper_hz, near));
        }
    }
    return top;
}

/* The column of a frequency; one in the middle of two columns, but for rounding, gets the right
 * one. */
static int frequency_column(const ruler *u, double hz)
{
    return (int)floor((hz / u->top * (u->length - 1)) + 0.5 + MT_TIE);
}

/* Put a mark on the line where it is in range and no mark of higher priority is there. */
static void mark_frequency(ruler *u, char *line, double hz, char sign, const char *over)
{
    if (!(hz >= 0.0) || hz > u->top) {
        return;
    }
    char *const at = &line[frequency_column(u, hz)];
    if (strchr(over, *at) != NULL) {
        *at = sign;
        u->has[(unsigned char)sign] = true;
    }
}

static void shade(ruler *u, char *line, double from, double to, char sign)
{
    if (!(from <= to) || to < 0.0 || from > u->top) {
        return;
    }
    const int last = frequency_column(u, fmin(to, u->top));
    for (int i = frequency_column(u, fmax(from, 0.0)); i <= last; i++) {
        line[i] = sign;
        u->has[(unsigned char)sign] = true;
    }
}

static bool is_same_name(const char *a, const char *b)
{
    return a == NULL || b == NULL ? a == b : strcmp(a, b) == 0;
}

static void draw_bands(ruler *u, const mt_recommendation *r, const char *of, char *line)
{
    for (int i = 0; i < r->n_placements; i++) {
        if (is_same_name(r->placements[i].configuration, of)) {
            shade(u, line, r->placements[i].margin_lower_hz, r->placements[i].margin_upper_hz,
                  '-');
        }
    }
    for (int i = 0; i < r->n_placements; i++) {
        if (is_same_name(r->placements[i].configuration, of)) {
            shade(u, line, r->placements[i].lower_hz, r->placements[i].upper_hz, '#');
        }
    }
}

/* Draw requirements, then the original modes, then the recommended ones over them. */
static int draw_modes(ruler *u, const mt_recommendation *r, const char *of, char *line)
{
    static const char digits[] = "0123456789";
    int beyond = 0;
    for (int i = 0; i < r->n_frequencies; i++) {
        const mt_result_frequency *const f = &r->frequencies[i];
        if (is_same_name(f->configuration, of)) {
            mark_frequency(u, line, f->at_least_hz, '[', " -#");
            mark_frequency(u, line, f->at_most_hz, ']', " -#");
            mark_frequency(u, line, f->target_hz, '|', " -#[]");
        }
    }
    for (int i = 0; i < r->n_frequencies; i++) {
        const mt_result_frequency *const f = &r->frequencies[i];
        if (is_same_name(f->configuration, of) && r->rank > 0) {
            mark_frequency(u, line, f->original_hz, 'o', " -#[]|");
        }
    }
    for (int i = 0; i < r->n_frequencies; i++) {
        const mt_result_frequency *const f = &r->frequencies[i];
        if (is_same_name(f->configuration, of)) {
            beyond += f->recommended_hz > u->top ? 1 : 0;
            const char sign = (char)(f->mode < 10 ? digits[f->mode] : '+');
            mark_frequency(u, line, f->recommended_hz, sign, " -#[]|o");
        }
    }
    return beyond;
}

static void add_ruler_line(ruler *u, const mt_recommendation *r, const char *of)
{
    char line[ROOM];
    const char *const name = of == NULL ? "" : of;
    memset(line, ' ', (size_t)u->length);
    line[u->length] = '\0';
    draw_bands(u, r, of, line);
    const int beyond = draw_modes(u, r, of, line);
    mt_text_addf(u->out, "  %s%*s  %s", name, u->label - mt_text_width(name), "", line);
    if (beyond > 0) {
        mt_text_addf(u->out, " >%d", beyond);
    }
    while (!u->out->failed && u->out->s[u->out->length - 1] == ' ') {
        u->out->s[--u->out->length] = '\0';
    }
    mt_text_add(u->out, "\n");
}

/* Distance of marks on a scale of this length: 1, 2 or 5 times a power of ten, about six. */
static double step_of(double length)
{
    const double raw = length / 6.0;
    const double power = pow(10.0, floor(log10(raw)));
    const double lead = raw / power;
    if (!(power > 0.0)) {
        return length; /* next to nothing: one mark */
    }
    return power * (lead <= 1.0 ? 1.0 : lead <= 2.0 ? 2.0 : lead <= 5.0 ? 5.0 : 10.0);
}

static void add_scale(const ruler *u)
{
    char line[ROOM];
    char number[NUMBER];
    const double step = step_of(u->top);
    int end = 0; /* of what stands there so far */
    memset(line, ' ', sizeof line);
    for (int k = 0; k * step <= u->top; k++) {
        (void)mt_snprintf(number, sizeof number, "%.6g", k * step);
        const int length = (int)strlen(number);
        const int at = frequency_column(u, k * step);
        if (at >= end && at + length < ROOM) {
            memcpy(line + at, number, (size_t)length);
            end = at + length + 1;
        }
    }
    line[end > 0 ? end - 1 : 0] = '\0';
    mt_text_addf(u->out, "  %*s  %s Hz\n", u->label, "", line);
}

static void add_legend(const ruler *u)
{
    static const struct {
        char sign;
        const char *text;
    } signs[] = {{'o', "o: before"},    {'#', "#: band"},        {'-', "-: its margin"},
                 {'|', "|: target"},    {'[', "[: lower limit"}, {']', "]: upper limit"},
                 {'+', "+: from 10 on"}};
    mt_text_add(u->out, "  digits: modes");
    for (int i = 0; i < MT_COUNT(signs); i++) {
        if (u->has[(unsigned char)signs[i].sign]) {
            mt_text_addf(u->out, ", %s", signs[i].text);
        }
    }
    mt_text_add(u->out, "\n");
}

/* True for the first row of its configuration. */
static bool is_first(const mt_recommendation *r, int i)
{
    for (int k = 0; k < i; k++) {
        if (is_same_name(r->frequencies[k].configuration, r->frequencies[i].configuration)) {
            return false;
        }
    }
    return true;
}

void mt_report_ruler(const mt_recommendation *r, int width, mt_text *out)
{
    ruler u = {.top = highest(r) * ABOVE, .length = USUAL, .out = out};
    if (!(u.top > 0.0) || !isfinite(u.top)) {
        return;
    }
    for (int i = 0; i < r->n_frequencies; i++) {
        const char *const name = r->frequencies[i].configuration;
        const int own = name == NULL ? 0 : mt_text_width(name);
        u.label = own > u.label ? own : u.label;
    }
    if (width > 0) {
        const int room = width - u.label - (2 * INDENT) - (int)sizeof " >99";
        u.length = room < LEAST ? LEAST : room > MOST ? MOST : room;
    }
    for (int i = 0; i < r->n_frequencies; i++) {
        if (is_first(r, i)) {
            add_ruler_line(&u, r, r->frequencies[i].configuration);
        }
    }
    add_scale(&u);
    add_legend(&u);
}

/* The sections of a design. */

static void write_ruler(const mt_summary_writer *to, const mt_recommendation *r)
{
    mt_text drawn = {.s = NULL};
    mt_report_ruler(r, to->width, &drawn);
    if (drawn.s != NULL) {
        mt_section_heading(to, "Frequency ruler");
        mt_text_add(to->out, drawn.s);
    }
    to->out->failed = to->out->failed || drawn.failed;
    mt_text_free(&drawn);
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
                 {"rank", "Why: how it stands"},
                 {NULL, "Why"}}; /* of an older program */
    mt_text_add(to->out, to->html && r->n_reasons > 0 ? "<div class=\"parts\">\n" : "");
    for (int k = 0; k < MT_COUNT(parts); k++) {
        bool open = false;
        for (int i = 0; i < r->n_reasons; i++) {
            const char *const own = r->reasons[i].kind;
            if (own == NULL ? parts[k].kind == NULL
                            : parts[k].kind != NULL && strcmp(own, parts[k].kind) == 0) {
                mt_text_add(to->out, to->html && !open ? "<div>" : "");
                open = open || mt_section_open(to, parts[k].title, 1);
                mt_section_item(to, "", r->reasons[i].text);
            }
        }
        if (open) {
            mt_section_close(to);
            mt_text_add(to->out, to->html ? "</div>\n" : "");
        }
    }
    mt_text_add(to->out, to->html && r->n_reasons > 0 ? "</div>\n" : "");
}

void mt_write_objectives(const mt_summary_writer *to, const mt_recommendation *r)
{
    mt_section_table(to, objectives_table(r), "Objectives");
}

static void write_parameters(const mt_summary_writer *to, const mt_recommendation *r)
{
    mt_section_table(to, parameters_table(r), "Parameters");
    for (int i = 0; i < r->n_parameters; i++) {
        mt_text line = {0};
        if (measure_sentence(&r->parameters[i], &line)) {
            mt_section_paragraph(to, "  ", &line);
        }
    }
}

/* "Recommendation 1 (feasible): mass 16.94 kg (was 11.92), total change 0.0828"; nothing of the
 * original design. */
static void write_rank(const mt_summary_writer *to, const mt_recommendation *r)
{
    char change[MT_NUMBER_TEXT];
    mt_text title = {0};
    mt_text headline = {0};
    if (r->rank == 0 || r->n_parameters == 0) {
        return;
    }
    mt_text_addf(&title, "Recommendation %d (%s)", r->rank,
                 r->grade == NULL ? "not graded" : r->grade);
    mt_text_add(&title, mt_report_headline(r, &headline) ? ": " : "");
    mt_text_add(&title, headline.s == NULL ? "" : headline.s);
    mt_text_addf(&title, ", total change %s%s",
                 mt_report_number(r->change, SUMMARY_DIGITS, change),
                 r->singular ? ", a double solution: its parameters are sensitive" : "");
    mt_section_heading(to, title.s == NULL ? "" : title.s);
    to->out->failed = to->out->failed || title.failed || headline.failed;
    mt_text_free(&headline);
    mt_text_free(&title);
}

/* Its numbers; the original design has no parameters to tell. */
static void write_numbers(const mt_summary_writer *to, const mt_recommendation *r)
{
    const bool found = r->rank > 0;
    if (!(found && r->n_parameters > 0 && r->n_objectives == 1 &&
          r->objectives[0].recommended == r->change)) { /* else its heading has it */
        mt_write_objectives(to, r);
    }
    if (found) {
        write_parameters(to, r);
    }
    mt_section_table(to, frequencies_table(r),
                     found ? "Frequencies" : "Frequencies of the original design");
    if (!to->html) {
        write_ruler(to, r);
    }
    if (to->html) {
        mt_section_table(to, placements_table(r), "Bands");
    }
    mt_section_table(to, mt_report_clearances(r), "Clearances from bands");
    mt_section_table(to, motions_table(r), "Over the range of motion");
}

/* Write the requirements compared with this design. */
static void write_compliance(const mt_summary_writer *to, const mt_result *result,
                             const mt_recommendation *r)
{
    static const char title[] = "Requirements";
    if (!to->html) {
        mt_section_table(to, compliance_table(result, r), title);
        return;
    }
    mt_text_add(to->out, "<div class=\"compliance\">\n");
    mt_section_table(to, compliance_table(result, r), title);
    if (r->n_goals > 0) {
        mt_text_add(to->out, "<p class=\"lead\">Margin: what is left to the limit, in per "
                             "cent of it; below 0 the limit is exceeded.</p>\n");
    }
    mt_text_add(to->out, "</div>\n");
}

void mt_write_design(const mt_summary_writer *to, const mt_result *result,
                     const mt_recommendation *r, mt_design_part part)
{
    switch (part) {
    case MT_DESIGN_REQUIREMENTS:
        write_compliance(to, result, r);
        break;
    case MT_DESIGN_REASONS:
        write_rank(to, r);
        write_reasons(to, r);
        break;
    case MT_DESIGN_NUMBERS:
        write_numbers(to, r);
        break;
    case MT_DESIGN_WHOLE:
        write_rank(to, r);
        write_compliance(to, result, r);
        write_numbers(to, r);
        write_reasons(to, r);
        break;
    }
}
