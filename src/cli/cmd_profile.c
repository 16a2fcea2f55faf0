/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune profile: what a profile of vibration says, and what it does to one mass. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/cli.h"
#include "cli/shipped.h"
#include "cli/vibrated.h"

static const double DEFAULT_DAMPING = 0.05;
static const double LEAST_HZ = 1e-9;
static const double MOST_HZ = 1e9;

enum { DIGITS = 5, HZ_DIGITS = 6, SLOPE_DIGITS = 3, MOST_MASSES = 10000 };

/* Masses on springs whose response is asked for: natural frequencies in equal quotients. */
typedef struct masses {
    int n; /* 0: not asked for */
    double from_hz;
    double to_hz;
    double damping_ratio;
} masses;

typedef struct view {
    const mt_vibration *v;
    masses of;
    mt_vibration_response *responses; /* [of.n] */
    double *hz;                       /* [of.n] */
} view;

static bool read_number(const char *s, const char *end, double *out)
{
    char *stop = NULL;
    const size_t length = (size_t)(end - s);
    *out = strtod(s, &stop);
    return length > 0 && strspn(s, "0123456789.eE+-") >= length && stop == end;
}

/* "FROM:TO:N". */
static mt_status read_masses(const mt_args *args, masses *out, mt_err *err)
{
    const char *const s = args->value[MT_OPT_SPECTRUM];
    const char *const zeta = args->value[MT_OPT_DAMPING_RATIO];
    const char *const first = s == NULL ? NULL : strchr(s, ':');
    const char *const second = first == NULL ? NULL : strchr(first + 1, ':');
    double n = 0.0;
    *out = (masses){.damping_ratio = DEFAULT_DAMPING};
    if (zeta != NULL && !(read_number(zeta, zeta + strlen(zeta), &out->damping_ratio) &&
                          out->damping_ratio > 0.0 && out->damping_ratio < 1.0)) {
        return mt_fail(err, MT_E_USAGE,
                       "--damping-ratio: \"%s\" is not a number between 0 and 1", zeta);
    }
    if (s == NULL) {
        return MT_OK;
    }
    const bool right = second != NULL && read_number(s, first, &out->from_hz) &&
                       read_number(first + 1, second, &out->to_hz) &&
                       read_number(second + 1, s + strlen(s), &n) && out->from_hz >= LEAST_HZ &&
                       out->to_hz >= out->from_hz && out->to_hz <= MOST_HZ && n >= 1.0 &&
                       n <= MOST_MASSES && n == floor(n);
    out->n = right ? (int)n : 0;
    return right ? MT_OK
                 : mt_fail(err, MT_E_USAGE,
                           "--spectrum: \"%s\" is not FROM:TO:N, two natural frequencies [Hz] "
                           "in ascending order and how many",
                           s);
}

static mt_status respond(view *w, mt_arena *mem, mt_err *err)
{
    const masses *const of = &w->of;
    w->responses = mt_arena_alloc(mem, (size_t)of->n, sizeof *w->responses);
    w->hz = mt_arena_f64(mem, (size_t)of->n, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < of->n; i++) {
        double complex s[2];
        double complex residue[2];
        const double part = of->n == 1 ? 0.0 : (double)i / (of->n - 1);
        w->hz[i] = i + 1 == of->n && of->n > 1
                       ? of->to_hz
                       : of->from_hz * pow(of->to_hz / of->from_hz, part);
        const mt_pole_sum h =
            mt_vibration_respond_one_mass(w->hz[i], of->damping_ratio, s, residue);
        MT_TRY(mt_vibration_respond(w->v, &h, mem, &w->responses[i], err));
    }
    return MT_OK;
}

static const char *origin_name(mt_origin origin)
{
    switch (origin) {
    case MT_ORIGIN_NONE:
        break;
    case MT_ORIGIN_PUBLISHED:
        return "published";
    case MT_ORIGIN_IDENTIFIED:
        return "identified";
    case MT_ORIGIN_ASSUMED:
        return "assumed";
    }
    return NULL;
}

static void put_random(mt_json_writer *w, const mt_vibration_random *r)
{
    mt_json_open(w, NULL, '{');
    mt_json_put_number(w, "rms_g", r->rms / MT_STANDARD_GRAVITY);
    mt_json_put_number(w, "rms_m_per_s2", r->rms);
    mt_json_put_number(w, "published_rms_g", r->published_rms / MT_STANDARD_GRAVITY);
    mt_json_put_string(w, "origin", origin_name(r->origin.origin));
    mt_json_put_string(w, "source", r->origin.source);
    mt_json_open(w, "breakpoints", '[');
    for (int i = 0; i < r->psd.n; i++) {
        const bool step = i + 1 < r->psd.n && r->psd.hz[i] == r->psd.hz[i + 1];
        mt_json_open_flat(w, NULL, '{');
        mt_json_put_number(w, "frequency_hz", r->psd.hz[i]);
        mt_json_put_number(w, "psd_g2_per_hz", r->level_g[i]);
        mt_json_put_number(w, "psd_m2_per_s3", r->psd.level[i]);
        mt_json_put_number(w, "slope_db_per_octave",
                           i + 1 < r->psd.n && !step ? mt_psd_slope_db(&r->psd, i) : nan(""));
        mt_json_close(w);
    }
    mt_json_close(w);
    mt_json_close(w);
}

static void put_tone(mt_json_writer *w, const mt_vibration *v, const mt_vibration_tone *tone)
{
    const mt_vibration_origin *const origin = &v->sources[tone->source].origin;
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "tone", tone->label);
    mt_json_put_number(w, "lower_hz", tone->lower_hz);
    mt_json_put_number(w, "upper_hz", tone->upper_hz);
    mt_json_put_number(w, "acceleration_g", tone->level_g);
    mt_json_put_number(w, "acceleration_m_per_s2", tone->level);
    mt_json_put_string(w, "origin", origin_name(origin->origin));
    mt_json_put_string(w, "source", origin->source);
    mt_json_close(w);
}

static void put_spectrum(mt_json_writer *w, const view *s)
{
    mt_json_open(w, "spectrum", '{');
    mt_json_put_number(w, "damping_ratio", s->of.damping_ratio);
    mt_json_open(w, "masses", '[');
    for (int i = 0; i < s->of.n; i++) {
        const mt_vibrated row = {
            .profile = s->v, .response = &s->responses[i], .is_acceleration = true};
        mt_json_open(w, NULL, '{');
        mt_json_put_number(w, "natural_frequency_hz", s->hz[i]);
        mt_vibrated_json(w, &row);
        mt_json_close(w);
    }
    mt_json_close(w);
    mt_json_close(w);
}

static int write_profile_json(const view *s, mt_text *out)
{
    const mt_vibration *const v = s->v;
    mt_json_writer w = mt_json_writer_default(out);
    mt_json_open(&w, NULL, '{');
    mt_json_put_string(&w, "file", v->path);
    mt_json_put_string(&w, "name", v->name);
    mt_json_put_string(&w, "source", v->source);
    mt_json_put_string(&w, "axis", mt_vibrated_axis(v));
    mt_json_put_number(&w, "rms_g", mt_vibration_rms(v) / MT_STANDARD_GRAVITY);
    mt_json_put_number(&w, "rms_m_per_s2", mt_vibration_rms(v));
    mt_json_open(&w, "random", '[');
    for (int i = 0; i < v->n_random; i++) {
        put_random(&w, &v->random[i]);
    }
    mt_json_close(&w);
    mt_json_open(&w, "tones", '[');
    for (int i = 0; i < v->n_tones; i++) {
        put_tone(&w, v, &v->tones[i]);
    }
    mt_json_close(&w);
    mt_vibrated_rule_json(&w, v);
    if (s->of.n > 0) {
        put_spectrum(&w, s);
    }
    mt_json_close(&w);
    return mt_cli_json_done(&w);
}

/* A row for each breakpoint; part: which of several random parts, 0: there is one. */
static void add_breakpoints(mt_table *t, const mt_vibration_random *r, int part)
{
    for (int i = 0; i < r->psd.n; i++) {
        const bool last = i + 1 == r->psd.n;
        mt_table_number(t, r->psd.hz[i], HZ_DIGITS);
        if (part > 0) {
            mt_table_integer(t, part);
        } else {
            mt_table_text(t, NULL);
        }
        mt_table_number(t, r->level_g[i], DIGITS);
        mt_table_number(t, r->psd.level[i], DIGITS);
        if (last || r->psd.hz[i] == r->psd.hz[i + 1]) {
            mt_table_text(t, last ? NULL : "step");
        } else {
            mt_table_change(t, mt_psd_slope_db(&r->psd, i), SLOPE_DIGITS);
        }
        mt_table_text(t, origin_name(r->origin.origin));
    }
}

static void print_random(const mt_vibration *v, mt_text *out)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, "frequency [Hz]", "frequency_hz", MT_ALIGN_POINT);
    mt_table_column(&t, "part", "part", MT_ALIGN_RIGHT);
    mt_table_column(&t, "density [g^2/Hz]", "psd_g2_per_hz", MT_ALIGN_POINT);
    mt_table_column(&t, "[(m/s^2)^2/Hz]", "psd_m2_per_s3", MT_ALIGN_POINT);
    mt_table_column(&t, "slope [dB/octave]", "slope_db_per_octave", MT_ALIGN_POINT);
    mt_table_column(&t, "origin", "origin", MT_ALIGN_LEFT);
    for (int i = 0; i < v->n_random; i++) {
        add_breakpoints(&t, &v->random[i], v->n_random > 1 ? i + 1 : 0);
    }
    mt_text_addf(out, "Random: %.5g g RMS (%.5g m/s^2) over all",
                 mt_vibration_rms(v) / MT_STANDARD_GRAVITY, mt_vibration_rms(v));
    for (int i = 0; i < v->n_random; i++) {
        const double printed = v->random[i].published_rms / MT_STANDARD_GRAVITY;
        if (printed == printed) {
            mt_text_addf(out, "; the source prints %.5g g", printed);
        }
    }
    mt_text_add(out, "\n");
    mt_table_print(&t, 2, mt_terminal_width(), out);
    for (int i = 0; i < v->n_random; i++) {
        if (v->random[i].origin.source != NULL) {
            mt_text_addf(out, "  Source: %s.\n", v->random[i].origin.source);
        }
    }
    mt_text_add(out, "\n");
    mt_table_free(&t);
}

static void print_tones(const mt_vibration *v, mt_text *out)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, "tone", "tone", MT_ALIGN_LEFT);
    mt_table_column(&t, "from [Hz]", "lower_hz", MT_ALIGN_POINT);
    mt_table_column(&t, "to [Hz]", "upper_hz", MT_ALIGN_POINT);
    mt_table_column(&t, "peak [g]", "acceleration_g", MT_ALIGN_POINT);
    mt_table_column(&t, "[m/s^2]", "acceleration_m_per_s2", MT_ALIGN_POINT);
    mt_table_column(&t, "origin", "origin", MT_ALIGN_LEFT);
    mt_table_column(&t, "source", "source", MT_ALIGN_LEFT);
    for (int i = 0; i < v->n_tones; i++) {
        const mt_vibration_tone *const tone = &v->tones[i];
        const mt_vibration_origin *const origin = &v->sources[tone->source].origin;
        mt_table_text(&t, tone->label);
        mt_table_number(&t, tone->lower_hz, HZ_DIGITS);
        mt_table_number(&t, tone->upper_hz, HZ_DIGITS);
        mt_table_number(&t, tone->level_g, DIGITS);
        mt_table_number(&t, tone->level, DIGITS);
        mt_table_text(&t, origin_name(origin->origin));
        mt_table_text(&t, origin->source);
    }
    mt_text_add(out, "Tones:\n");
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_text_add(out, "\n");
    mt_table_free(&t);
}

static mt_table spectrum_table(const view *s)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, "natural frequency [Hz]", "natural_frequency_hz", MT_ALIGN_POINT);
    mt_vibrated_columns(&t);
    for (int i = 0; i < s->of.n; i++) {
        const mt_vibrated row = {
            .profile = s->v, .response = &s->responses[i], .is_acceleration = true};
        mt_table_number(&t, s->hz[i], HZ_DIGITS);
        mt_vibrated_row(&t, &row);
    }
    return t;
}

/* Where the tones peak, of one mass. */
static void print_peaks(const view *s, mt_text *out)
{
    const mt_vibrated row = {
        .profile = s->v, .response = &s->responses[0], .is_acceleration = true};
    mt_table t = mt_table_default();
    mt_vibrated_tone_columns(&t);
    for (int i = 0; i < s->v->n_tones; i++) {
        mt_vibrated_tone_row(&t, &row, i);
    }
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_text_add(out, "\n");
    mt_table_free(&t);
}

static void write_profile_text(const view *s, mt_text *out)
{
    const mt_vibration *const v = s->v;
    mt_text_addf(out, "%s%s%s%s\n\n", mt_vibrated_name(v),
                 v->axis == MT_ABSENT ? "" : ", along ",
                 v->axis == MT_ABSENT ? "" : mt_vibrated_axis(v),
                 v->n_random > 0 && v->n_tones > 0 ? ": sine on random" : "");
    if (v->n_random > 0) {
        print_random(v, out);
    }
    if (v->n_tones > 0) {
        print_tones(v, out);
    }
    if (s->of.n > 0) {
        mt_table t = spectrum_table(s);
        mt_text_addf(out, "Absolute acceleration of one mass, damping ratio %.5g; ",
                     s->of.damping_ratio);
        mt_vibrated_rule(v, out);
        mt_text_add(out, ":\n");
        mt_table_print(&t, 2, mt_terminal_width(), out);
        mt_text_add(out, "\n");
        mt_table_free(&t);
        if (s->of.n == 1 && v->n_tones > 0) {
            print_peaks(s, out);
        }
    }
}

/* A row for each segment of the random parts and for each tone. */
static void write_csv(const view *s, mt_text *out)
{
    const mt_vibration *const v = s->v;
    if (s->of.n > 0) {
        mt_table t = spectrum_table(s);
        mt_table_csv(&t, out);
        mt_table_free(&t);
        return;
    }
    static const char *const columns[] = {"part",
                                          "name",
                                          "from_hz",
                                          "to_hz",
                                          "psd_from_g2_per_hz",
                                          "psd_to_g2_per_hz",
                                          "slope_db_per_octave",
                                          "acceleration_g",
                                          "origin",
                                          "source"};
    mt_table t = mt_table_default();
    for (int k = 0; k < MT_COUNT(columns); k++) {
        mt_table_column(&t, columns[k], columns[k], MT_ALIGN_LEFT);
    }
    for (int i = 0; i < v->n_random; i++) {
        const mt_vibration_random *const r = &v->random[i];
        for (int k = 0; k + 1 < r->psd.n; k++) {
            mt_table_text(&t, "random");
            mt_table_integer(&t, i + 1);
            mt_table_number(&t, r->psd.hz[k], HZ_DIGITS);
            mt_table_number(&t, r->psd.hz[k + 1], HZ_DIGITS);
            mt_table_number(&t, r->level_g[k], DIGITS);
            mt_table_number(&t, r->level_g[k + 1], DIGITS);
            mt_table_number(
                &t, r->psd.hz[k] < r->psd.hz[k + 1] ? mt_psd_slope_db(&r->psd, k) : nan(""),
                SLOPE_DIGITS);
            mt_table_text(&t, NULL);
            mt_table_text(&t, origin_name(r->origin.origin));
            mt_table_text(&t, r->origin.source);
        }
    }
    for (int i = 0; i < v->n_tones; i++) {
        const mt_vibration_tone *const tone = &v->tones[i];
        const mt_vibration_origin *const origin = &v->sources[tone->source].origin;
        mt_table_text(&t, "tone");
        mt_table_text(&t, tone->label);
        mt_table_number(&t, tone->lower_hz, HZ_DIGITS);
        mt_table_number(&t, tone->upper_hz, HZ_DIGITS);
        for (int k = 0; k < 3; k++) {
            mt_table_text(&t, NULL);
        }
        mt_table_number(&t, tone->level_g, DIGITS);
        mt_table_text(&t, origin_name(origin->origin));
        mt_table_text(&t, origin->source);
    }
    mt_table_csv(&t, out);
    mt_table_free(&t);
}

static int print(const mt_args *args, const view *s, mt_text *out)
{
    switch (args->format) {
    case MT_FORMAT_JSON:
        return write_profile_json(s, out);
    case MT_FORMAT_CSV:
        write_csv(s, out);
        break;
    case MT_FORMAT_HTML:  /* of report alone */
    case MT_FORMAT_SARIF: /* of check alone */
    case MT_FORMAT_TEXT:
        write_profile_text(s, out);
        break;
    }
    return MT_EXIT_DONE;
}

static int run_profile(const mt_args *args, mt_text *out)
{
    mt_diagnostics messages = {.count = 0};
    mt_err err = {.code = MT_OK};
    mt_arena mem = {.first = NULL};
    mt_vibration *v = NULL;
    view s = {.v = NULL};
    if (args->n_operands == 0) {
        return mt_shipped_list(args, &mt_shipped_profiles, out);
    }
    mt_status rc = read_masses(args, &s.of, &err);
    rc = rc == MT_OK ? mt_shipped_load_profile(args, args->operands[0], &v, &messages, &err)
                     : rc;
    int code = mt_cli_loaded(rc, &messages, &err);
    if (rc == MT_OK) {
        s.v = v;
        rc = respond(&s, &mem, &err);
        code = rc == MT_OK ? print(args, &s, out) : mt_cli_failed(rc, &err);
    }
    mt_vibration_delete(v);
    mt_arena_free(&mem);
    return code;
}

const mt_command mt_command_profile = {
    .name = "profile",
    .operands = "[PROFILE]",
    .least = 0,
    .most = 1,
    .summary = "what a vibration profile requires",
    .details =
        "Prints the breakpoints of the random parts of a profile with their slopes and "
        "overall RMS, and its tones, with the harmonics of rotors in Hz, each with origin "
        "and source. A message lists what is assumed, or unconfirmed by a public document. "
        "PROFILE is a file, or the name of a profile that is part of the program; without "
        "it, these are listed.\n"
        "--spectrum prints the response of one mass on a spring whose base follows the "
        "profile: the RMS of its absolute acceleration, with a bound of the error; the "
        "largest peaks of the tones over their ranges, proven; and both combined by the "
        "profile's rule (default: 3 times the RMS plus the sum of all tones). --format csv "
        "has one row for each segment and tone, or for each natural frequency.",
    .run = run_profile,
};
