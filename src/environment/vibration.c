/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "environment/vibration.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/possible.h"
#include "environment/rotor.h"

static const double DEFAULT_SIGMA = 3.0;
static const double DB_PER_DECADE = 10.0;
/* An RMS that is printed has some digits; one that is further off is a typing error. */
static const double PUBLISHED_TOL = 0.01;
/* So many harmonics are named one by one, and so many sentences looked back. */
enum { LISTED_MOST = 6, LAST_MARKS = 16 };

const char *const mt_vibration_sum_names[MT_TONES_RULES] = {"sum", "largest",
                                                            "root_sum_square"};

mt_status mt_vibration_new(mt_vibration **out, mt_err *err)
{
    mt_vibration *const v = calloc(1, sizeof *v);
    *out = NULL;
    if (v == NULL) {
        return mt_fail_memory(err);
    }
    *v = (mt_vibration){.axis = MT_ABSENT, .sigma = DEFAULT_SIGMA};
    const mt_status rc = mt_arena_init(&v->mem, 0, err);
    if (rc != MT_OK) {
        free(v);
        return rc;
    }
    *out = v;
    return MT_OK;
}

void mt_vibration_delete(mt_vibration *v)
{
    if (v != NULL) {
        mt_arena_free(&v->mem);
        free(v);
    }
}

/* True where the number is given and possible; otherwise the reader has noted it. */
static bool is_good(mt_possible_id row, double value)
{
    return value == value && mt_possible_is(&mt_possible_of[row], value);
}

static bool check_order(mt_diags *d, const mt_vibration_random *r)
{
    bool right = true;
    for (int i = 1; i < r->n_points; i++) {
        const double hz = r->points[i].hz;
        if (hz < r->points[i - 1].hz) {
            mt_diag_error(d, r->points[i].hz_addr, "%g Hz is below the breakpoint before it",
                          hz);
            right = false;
        } else if (hz == r->points[i - 1].hz &&
                   (i == 1 || i == r->n_points - 1 || hz == r->points[i - 2].hz)) {
            mt_diag_error(d, r->points[i].hz_addr,
                          i > 1 && hz == r->points[i - 2].hz
                              ? "a third breakpoint at %g Hz: a step has two"
                              : "two breakpoints at %g Hz, where the density begins or ends",
                          hz);
            right = false;
        }
    }
    return right;
}

/* The level at the other end of a segment with a slope. */
static double level_at_segment_end(double level, double from_hz, double to_hz, double slope_db)
{
    return level *
           pow(10.0, slope_db * mt_psd_log_ratio(from_hz, to_hz) / (log(2.0) * DB_PER_DECADE));
}

/* Points without a level take it from the one before them, those before the first level from
 * the one after them. */
static bool follow_slopes(mt_diags *d, mt_vibration_random *r)
{
    int first = 0;
    while (first < r->n_points && r->points[first].slope_db == r->points[first].slope_db) {
        first++;
    }
    if (first == r->n_points) {
        mt_diag_error(d,
                      mt_diag_member(d, r->addr, r->in_g ? "psd_g2_per_hz" : "psd_m2_per_s3"),
                      "no breakpoint has a level");
        return false;
    }
    for (int i = first - 1; i >= 0; i--) {
        mt_vibration_point *const p = &r->points[i];
        p->level = level_at_segment_end(p[1].level, p[1].hz, p->hz, p->slope_db);
    }
    for (int i = first + 1; i < r->n_points; i++) {
        mt_vibration_point *const p = &r->points[i];
        if (p->slope_db == p->slope_db) {
            p->level = level_at_segment_end(p[-1].level, p[-1].hz, p->hz, p->slope_db);
        }
    }
    for (int i = 0; i < r->n_points; i++) {
        const mt_vibration_point *const p = &r->points[i];
        if (!is_good(MT_POSSIBLE_PSD, p->level)) {
            mt_diag_error(d, p->addr, "the level that follows (%g) %s", p->level,
                          mt_possible_of[MT_POSSIBLE_PSD].impossible);
            return false;
        }
    }
    return true;
}

static void compare_with_print(mt_diags *d, const mt_vibration_random *r)
{
    const double off = (r->rms / r->published_rms) - 1.0;
    if (fabs(off) > PUBLISHED_TOL) {
        mt_diag_warning(d, mt_diag_member(d, r->addr, "published_rms_g"),
                        "the breakpoints have an RMS of %.4g g, which is %.2g %% off the "
                        "published one",
                        r->rms / MT_STANDARD_GRAVITY, 100.0 * off);
    }
}

static void finish_random(mt_vibration *v, mt_vibration_random *r, mt_diags *d)
{
    bool right = r->n_points >= 2;
    for (int i = 0; i < r->n_points; i++) {
        const mt_vibration_point *const p = &r->points[i];
        right = right && is_good(MT_POSSIBLE_HZ, p->hz);
        right = right && (p->slope_db == p->slope_db || is_good(MT_POSSIBLE_PSD, p->level));
    }
    const bool printed = is_good(MT_POSSIBLE_LEVEL, r->published_rms);
    if (!right || !check_order(d, r) || !follow_slopes(d, r)) {
        return;
    }
    const double square = MT_STANDARD_GRAVITY * MT_STANDARD_GRAVITY;
    const size_t n = (size_t)r->n_points;
    r->psd.hz = mt_arena_f64(&v->mem, n, 1);
    r->psd.level = mt_arena_f64(&v->mem, n, 1);
    r->level_g = mt_arena_f64(&v->mem, n, 1);
    if (mt_arena_failed(&v->mem)) {
        return;
    }
    for (int i = 0; i < r->n_points; i++) {
        r->psd.hz[i] = r->points[i].hz;
        r->psd.level[i] = r->in_g ? square * r->points[i].level : r->points[i].level;
        r->level_g[i] = r->in_g ? r->points[i].level : r->points[i].level / square;
    }
    r->psd.n = r->n_points;
    r->rms = sqrt(mt_psd_mean_square(&r->psd));
    if (printed) {
        compare_with_print(d, r);
    }
}

typedef struct marking {
    mt_vibration *v;
    mt_diags *diags;
    int room; /* for marks */
} marking;

/* True where one of the last marks has the same text: consecutive sources of one aircraft have
 * the same marks. */
static bool is_said(const mt_vibration *v, const char *text)
{
    bool said = false;
    for (int i = v->n_marks; i > 0 && i > v->n_marks - LAST_MARKS && !said; i--) {
        said = strcmp(v->marks[i - 1], text) == 0;
    }
    return said;
}

/* Add a mark to the profile, and a warning. */
static void add_profile_mark(marking *m, mt_addr addr, const char *text)
{
    mt_vibration *const v = m->v;
    if (text == NULL || is_said(v, text)) {
        return;
    }
    mt_diag_warning(m->diags, addr, "%s", text);
    const char **const list =
        mt_arena_grow(&v->mem, (void *)v->marks, v->n_marks, &m->room, sizeof *list);
    if (list != NULL) {
        list[v->n_marks++] = text;
        v->marks = list;
    }
}

static const mt_aircraft *find_aircraft(mt_vibration *v, mt_name name, mt_diags *d)
{
    const mt_aircraft *const found =
        name.s == NULL ? NULL : mt_aircraft_find(&v->aircraft, name.s);
    if (name.s != NULL && found == NULL && v->aircraft.n > 0) {
        const char *const guess =
            mt_diag_may_suggest(d) ? mt_aircraft_nearest(&v->aircraft, name.s, &v->mem) : NULL;
        mt_diag_error(d, name.addr, "unknown aircraft \"%s\"%s%s%s", name.s,
                      guess == NULL ? "" : "; did you mean \"", guess == NULL ? "" : guess,
                      guess == NULL ? "" : "\"?");
    }
    return found;
}

static void check_rotor(mt_vibration *v, mt_rotor *rotor, mt_diags *d)
{
    const mt_aircraft *const aircraft = find_aircraft(v, rotor->aircraft, d);
    if (aircraft != NULL) {
        mt_rotor_take(rotor, aircraft);
    }
    if (aircraft != NULL || rotor->aircraft.addr == rotor->addr) {
        mt_rotor_check_harmonics(rotor, aircraft, d); /* else the aircraft is wrong */
    }
    mt_rotor_check_range(rotor, d);
}

static void check_source(mt_vibration *v, mt_vibration_source *s, mt_diags *d)
{
    if (s->has_rotor) {
        check_rotor(v, &s->rotor, d);
        return;
    }
    if (s->lower_hz > s->upper_hz) {
        mt_diag_error(d, mt_diag_member(d, s->addr, "frequency_hz"),
                      "the range (%g to %g Hz) must be ascending", s->lower_hz, s->upper_hz);
    }
}

static const char *rotor_name(const mt_rotor *rotor)
{
    return rotor->name != NULL         ? rotor->name
           : rotor->aircraft.s != NULL ? rotor->aircraft.s
                                       : "rotor";
}

static void add_tone(mt_vibration *v, int source, double lower, double upper, const char *label,
                     mt_diags *d)
{
    const mt_vibration_source *const s = &v->sources[source];
    if (!is_good(MT_POSSIBLE_HZ, lower) || !is_good(MT_POSSIBLE_HZ, upper)) {
        if (s->has_rotor) { /* else the reader has noted it */
            mt_diag_error(d, s->addr, "%s: its frequency (%g to %g Hz) %s", label, lower, upper,
                          mt_possible_of[MT_POSSIBLE_HZ].impossible);
        }
        return;
    }
    v->tones[v->n_tones++] = (mt_vibration_tone){
        .label = label,
        .lower_hz = lower,
        .upper_hz = upper,
        .level = s->in_g ? MT_STANDARD_GRAVITY * s->level : s->level,
        .level_g = s->in_g ? s->level : s->level / MT_STANDARD_GRAVITY,
        .source = source,
    };
}

static void add_harmonics(mt_vibration *v, int source, mt_diags *d)
{
    const mt_rotor *const rotor = &v->sources[source].rotor;
    for (int i = 0; i < rotor->n_harmonics; i++) {
        const double hz = mt_rotor_harmonic_hz(rotor, &rotor->harmonics[i]);
        const char *const label =
            mt_arena_printf(&v->mem, "%s of %s", rotor->harmonics[i].text, rotor_name(rotor));
        if (hz == hz && label != NULL) { /* else its aircraft could not be read */
            add_tone(v, source, hz * rotor->range_lower, hz * rotor->range_upper, label, d);
        }
    }
}

static void make_tones(mt_vibration *v, mt_diags *d)
{
    size_t most = 0;
    for (int i = 0; i < v->n_sources; i++) {
        most += v->sources[i].has_rotor ? (size_t)v->sources[i].rotor.n_harmonics : 1;
    }
    v->tones = mt_arena_alloc(&v->mem, most, sizeof *v->tones);
    if (v->tones == NULL) {
        return;
    }
    for (int i = 0; i < v->n_sources; i++) {
        const mt_vibration_source *const s = &v->sources[i];
        if (s->has_rotor) {
            add_harmonics(v, i, d);
            continue;
        }
        const char *const label =
            s->lower_hz == s->upper_hz
                ? mt_arena_printf(&v->mem, "%.6g Hz", s->lower_hz)
                : mt_arena_printf(&v->mem, "%.6g to %.6g Hz", s->lower_hz, s->upper_hz);
        if (label != NULL) {
            add_tone(v, i, s->lower_hz, s->upper_hz, label, d);
        }
    }
}

/* "4P, 8P of UH-60", "16.3 to 18.1 Hz" */
static const char *name_source(mt_vibration *v, const mt_vibration_source *s)
{
    const mt_rotor *const rotor = &s->rotor;
    const char *text = "";
    if (!s->has_rotor) {
        return mt_arena_printf(&v->mem, "%.6g to %.6g Hz", s->lower_hz, s->upper_hz);
    }
    if (rotor->n_harmonics > LISTED_MOST) {
        return mt_arena_printf(&v->mem, "%d harmonics of %s", rotor->n_harmonics,
                               rotor_name(rotor));
    }
    for (int i = 0; i < rotor->n_harmonics && text != NULL; i++) {
        text = mt_arena_printf(&v->mem, "%s%s%s", text, i == 0 ? "" : ", ",
                               rotor->harmonics[i].text);
    }
    return text == NULL ? NULL : mt_arena_printf(&v->mem, "%s of %s", text, rotor_name(rotor));
}

static void mark_source(marking *m, const mt_vibration_source *s)
{
    mt_vibration *const v = m->v;
    mt_rotor_warning warning_list[MT_ROTOR_WARNINGS];
    const mt_aircraft *const a = s->has_rotor && s->rotor.aircraft.s != NULL
                                     ? mt_aircraft_find(&v->aircraft, s->rotor.aircraft.s)
                                     : NULL;
    const int n = a == NULL ? 0 : mt_rotor_warnings(&s->rotor, a, warning_list);
    for (int i = 0; i < n; i++) {
        add_profile_mark(
            m, s->rotor.aircraft.addr,
            mt_arena_printf(&v->mem, "%s: the %s (%s) is unconfirmed (source needed: %s)",
                            s->rotor.aircraft.s, warning_list[i].what,
                            warning_list[i].value->text, warning_list[i].value->source));
    }
    const char *const name = name_source(v, s);
    if (s->origin.origin == MT_ORIGIN_ASSUMED && name != NULL) {
        add_profile_mark(
            m, s->addr,
            mt_arena_printf(&v->mem, "the level of %s is assumed (%s)", name,
                            s->origin.source == NULL ? "no source" : s->origin.source));
    }
}

static void make_marks(mt_vibration *v, mt_diags *diags)
{
    marking m = {.v = v, .diags = diags};
    for (int i = 0; i < v->n_random; i++) {
        const mt_vibration_random *const r = &v->random[i];
        if (r->origin.origin == MT_ORIGIN_ASSUMED) {
            add_profile_mark(
                &m, r->addr,
                mt_arena_printf(&v->mem, "the density from %.6g to %.6g Hz is assumed (%s)",
                                r->psd.hz[0], r->psd.hz[r->psd.n - 1],
                                r->origin.source == NULL ? "no source" : r->origin.source));
        }
    }
    for (int i = 0; i < v->n_sources; i++) {
        mark_source(&m, &v->sources[i]);
    }
}

void mt_vibration_finish(mt_vibration *v, mt_diags *diags)
{
    for (int i = 0; i < v->n_random; i++) {
        finish_random(v, &v->random[i], diags);
    }
    for (int i = 0; i < v->n_sources; i++) {
        check_source(v, &v->sources[i], diags);
    }
    if (diags->errors == 0) {
        make_tones(v, diags);
    }
    if (diags->errors == 0 && !mt_arena_failed(&v->mem)) {
        make_marks(v, diags);
    }
}

double mt_vibration_rms(const mt_vibration *v)
{
    double sum = v == NULL ? nan("") : 0.0;
    for (int i = 0; v != NULL && i < v->n_random; i++) {
        sum += v->random[i].rms * v->random[i].rms;
    }
    return sqrt(sum);
}

double mt_vibration_density(const mt_vibration *v, double hz)
{
    double sum = 0.0;
    for (int i = 0; i < v->n_random; i++) {
        sum += mt_psd_at(&v->random[i].psd, hz);
    }
    return sum;
}

void mt_vibration_range(const mt_vibration *v, bool random, bool tones, double hz[2])
{
    hz[0] = HUGE_VAL;
    hz[1] = 0.0;
    for (int i = 0; random && i < v->n_random; i++) {
        const mt_psd *const psd = &v->random[i].psd;
        hz[0] = fmin(hz[0], psd->hz[0]);
        hz[1] = fmax(hz[1], psd->hz[psd->n - 1]);
    }
    for (int i = 0; tones && i < v->n_tones; i++) {
        hz[0] = fmin(hz[0], v->tones[i].lower_hz);
        hz[1] = fmax(hz[1], v->tones[i].upper_hz);
    }
}
