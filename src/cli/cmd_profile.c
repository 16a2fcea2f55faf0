/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune profile: what a profile of vibration says, and what it does to one mass. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/format.h"
#include "cli/cli.h"
#include "cli/shipped.h"
#include "report/table.h"
#include "result/write.h"

static const double DEFAULT_DAMPING = 0.05;
static const double LEAST_HZ = 1e-9;
static const double MOST_HZ = 1e9;

enum { DIGITS = 5, HZ_DIGITS = 6, SLOPE_DIGITS = 3, PART_TEXT = 16, MOST_MASSES = 10000 };

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

/* What is told of a profile: JSON is written from these records, tables show them. */

static const char *const origins[] = {"published", "identified", "assumed"};

static const char *origin_name(mt_origin origin)
{
    switch (origin) {
    case MT_ORIGIN_NONE:
        break;
    case MT_ORIGIN_PUBLISHED:
        return origins[0];
    case MT_ORIGIN_IDENTIFIED:
        return origins[1];
    case MT_ORIGIN_ASSUMED:
        return origins[2];
    }
    return NULL;
}

/* A breakpoint of a random part. */
typedef struct breakpoint_row {
    double hz;
    int part; /* of several random parts, from 1; 0: there is one */
    double psd_g2_per_hz;
    double psd_m2_per_s3;
    double slope_db;    /* to the next breakpoint; NaN: there is none, or it is a step */
    double slope_shown; /* the same for people, or */
    const char *step;   /* the word for it */
    const char *origin;
} breakpoint_row;

#define THIS breakpoint_row
static const mt_field breakpoint_fields[] = {
    MT_F_NUMBER("frequency_hz", hz, "Its frequency."),
    MT_F_COUNT_OR_NULL(NULL, part, 1, NULL), /* JSON has a list of each part's */
    MT_F_NUMBER("psd_g2_per_hz", psd_g2_per_hz, "Spectral density of the acceleration in g."),
    MT_F_NUMBER("psd_m2_per_s3", psd_m2_per_s3,
                "Spectral density of the acceleration in m/s^2."),
    MT_F_NUMBER_OR_NULL("slope_db_per_octave", slope_db,
                        "Slope to the next breakpoint; null: there is none, or it has the "
                        "same frequency."),
    MT_F_VALUE_OR_NULL(NULL, slope_shown, step, NULL),
    MT_F_UNWRITTEN_TEXT(origin), /* JSON has it beside the list */
};
static const mt_record breakpoint_record =
    MT_F_RECORD_OF(breakpoint_fields, "breakpoint", "A breakpoint of a spectral density.");
static const mt_record_column breakpoint_columns[] = {
    MT_R_COLUMN(hz, "frequency [Hz]", HZ_DIGITS, MT_IN_TEXT),
    MT_R_COLUMN(part, "part", 0, MT_IN_TEXT),
    MT_R_COLUMN(psd_g2_per_hz, "density [g^2/Hz]", DIGITS, MT_IN_TEXT),
    MT_R_COLUMN(psd_m2_per_s3, "[(m/s^2)^2/Hz]", DIGITS, MT_IN_TEXT),
    MT_R_CHANGE(slope_shown, "slope [dB/octave]", NULL, SLOPE_DIGITS, MT_IN_TEXT),
    MT_R_COLUMN(origin, "origin", 0, MT_IN_TEXT),
};
static const mt_record_table breakpoint_rows =
    MT_R_TABLE_OF(breakpoint_record, breakpoint_columns);
#undef THIS

/* A random part. */
typedef struct random_row {
    double rms_g;
    double rms_m_per_s2;
    double published_rms_g;
    const char *origin;
    const char *source;
    int n;
    breakpoint_row *breakpoints;
} random_row;

#define THIS random_row
static const mt_field random_fields[] = {
    MT_F_NUMBER("rms_g", rms_g, "RMS of its acceleration, in g."),
    MT_F_NUMBER("rms_m_per_s2", rms_m_per_s2, "RMS of its acceleration."),
    MT_F_NUMBER_OR_NULL("published_rms_g", published_rms_g,
                        "RMS that its source prints; null: none."),
    MT_F_CHOICE_OR_NULL("origin", origin, origins, "Where it is from; null: it does not say."),
    MT_F_TEXT_OR_NULL("source", source, "Document that it is from."),
    MT_F_LIST("breakpoints", breakpoints, n, breakpoint_row, breakpoint_record,
              "Its spectral density.", .flat = true),
};
static const mt_record random_record =
    MT_F_RECORD_OF(random_fields, "random", "A random part of a profile.");
#undef THIS

/* A tone. */
typedef struct tone_row {
    const char *label;
    double lower_hz;
    double upper_hz;
    double acceleration_g;
    double acceleration_m_per_s2;
    const char *origin;
    const char *source;
} tone_row;

#define THIS tone_row
static const mt_field tone_fields[] = {
    MT_F_TEXT("tone", label, "What it is called."),
    MT_F_NUMBER("lower_hz", lower_hz, "Beginning of the range of its frequency."),
    MT_F_NUMBER("upper_hz", upper_hz, "End of that range."),
    MT_F_NUMBER("acceleration_g", acceleration_g, "Peak of its acceleration, in g."),
    MT_F_NUMBER("acceleration_m_per_s2", acceleration_m_per_s2, "Peak of its acceleration."),
    MT_F_CHOICE_OR_NULL("origin", origin, origins, "Where it is from; null: it does not say."),
    MT_F_TEXT_OR_NULL("source", source, "Document that it is from."),
};
static const mt_record tone_record =
    MT_F_RECORD_OF(tone_fields, "tone", "A tone of a profile.");
static const mt_record_column tone_columns[] = {
    MT_R_COLUMN(label, "tone", 0, MT_IN_TEXT),
    MT_R_COLUMN(lower_hz, "from [Hz]", HZ_DIGITS, MT_IN_TEXT),
    MT_R_COLUMN(upper_hz, "to [Hz]", HZ_DIGITS, MT_IN_TEXT),
    MT_R_COLUMN(acceleration_g, "peak [g]", DIGITS, MT_IN_TEXT),
    MT_R_COLUMN(acceleration_m_per_s2, "[m/s^2]", DIGITS, MT_IN_TEXT),
    MT_R_COLUMN(origin, "origin", 0, MT_IN_TEXT),
    MT_R_COLUMN(source, "source", 0, MT_IN_TEXT),
};
static const mt_record_table tone_rows = MT_R_TABLE_OF(tone_record, tone_columns);
#undef THIS

/* A mass on a spring whose base follows the profile. */
typedef struct mass_row {
    double hz;
    mt_vibrated_values vibrated;
} mass_row;

#define THIS mass_row
static const mt_field mass_fields[] = {
    MT_F_NUMBER("natural_frequency_hz", hz, "Its natural frequency."),
    MT_VIBRATED_FIELDS(vibrated),
};
static const mt_record mass_record =
    MT_F_RECORD_OF(mass_fields, "mass", "The absolute acceleration of one mass on a spring.");
static const mt_record_column mass_columns[] = {
    MT_R_COLUMN(hz, "natural frequency [Hz]", HZ_DIGITS, MT_IN_TABLES),
};
static const mt_record_table mass_rows = MT_R_TABLE_OF(mass_record, mass_columns);
#undef THIS

/* What --spectrum asks for. */
typedef struct spectrum_row {
    double damping_ratio;
    int n;
    mass_row *masses;
} spectrum_row;

#define THIS spectrum_row
static const mt_field spectrum_fields[] = {
    MT_F_NUMBER("damping_ratio", damping_ratio, "Damping ratio of every mass."),
    MT_F_LIST("masses", masses, n, mass_row, mass_record, "The masses, by natural frequency."),
};
static const mt_record spectrum_record =
    MT_F_RECORD_OF(spectrum_fields, NULL, "Masses on springs whose base follows the profile.");
#undef THIS

/* A profile. */
typedef struct profile_row {
    const char *file;
    const char *name;
    const char *source;
    const char *axis;
    double rms_g;
    double rms_m_per_s2;
    int n_random;
    random_row *random;
    int n_tones;
    tone_row *tones;
    mt_rule_row rule;
    bool with_spectrum;
    spectrum_row spectrum;
} profile_row;

#define THIS profile_row
static const mt_field profile_fields[] = {
    MT_F_TEXT("file", file, "The profile's file."),
    MT_F_TEXT_OR_NULL("name", name, "Its name."),
    MT_F_TEXT_OR_NULL("source", source, "Document that it is from."),
    MT_F_TEXT_OR_NULL("axis", axis,
                      "Axis of the base that it shakes: \"x\", \"y\" or \"z\"; null: any."),
    MT_F_NUMBER("rms_g", rms_g, "RMS of all random parts together, in g."),
    MT_F_NUMBER("rms_m_per_s2", rms_m_per_s2, "RMS of all random parts together."),
    MT_F_LIST("random", random, n_random, random_row, random_record, "Its random parts."),
    MT_F_LIST("tones", tones, n_tones, tone_row, tone_record,
              "Its tones, with the harmonics of rotors."),
    MT_RULE_FIELDS(rule),
    MT_F_RECORD("spectrum", spectrum, spectrum_row, spectrum_record,
                "With --spectrum: what it does to one mass.", MT_F_WHEN(with_spectrum)),
};
static const mt_record profile_record =
    MT_F_RECORD_OF(profile_fields, "profile", "What a profile of vibration requires.");
#undef THIS

/* Breakpoint i of a random part; part: which of several, 0: there is one. */
static breakpoint_row breakpoint_row_of(const mt_vibration_random *r, int part, int i)
{
    const bool last = i + 1 == r->psd.n;
    const bool step = !last && r->psd.hz[i] == r->psd.hz[i + 1];
    const double slope = last || step ? nan("") : mt_psd_slope_db(&r->psd, i);
    return (breakpoint_row){
        .hz = r->psd.hz[i],
        .part = part,
        .psd_g2_per_hz = r->level_g[i],
        .psd_m2_per_s3 = r->psd.level[i],
        .slope_db = slope,
        .slope_shown = slope,
        .step = step ? "step" : NULL,
        .origin = origin_name(r->origin.origin),
    };
}

static mt_status random_row_of(const mt_vibration_random *r, int part, mt_arena *mem,
                               random_row *out, mt_err *err)
{
    *out = (random_row){
        .rms_g = r->rms / MT_STANDARD_GRAVITY,
        .rms_m_per_s2 = r->rms,
        .published_rms_g = r->published_rms / MT_STANDARD_GRAVITY,
        .origin = origin_name(r->origin.origin),
        .source = r->origin.source,
        .n = r->psd.n,
        .breakpoints = mt_arena_alloc(mem, (size_t)r->psd.n, sizeof *out->breakpoints),
    };
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < r->psd.n; i++) {
        out->breakpoints[i] = breakpoint_row_of(r, part, i);
    }
    return MT_OK;
}

static tone_row tone_row_of(const mt_vibration *v, int i)
{
    const mt_vibration_tone *const tone = &v->tones[i];
    const mt_vibration_origin *const origin = &v->sources[tone->source].origin;
    return (tone_row){
        .label = tone->label,
        .lower_hz = tone->lower_hz,
        .upper_hz = tone->upper_hz,
        .acceleration_g = tone->level_g,
        .acceleration_m_per_s2 = tone->level,
        .origin = origin_name(origin->origin),
        .source = origin->source,
    };
}

/* The vibration of mass i. */
static mt_vibrated vibrated_of(const view *s, int i)
{
    return (mt_vibrated){
        .profile = s->v, .response = &s->responses[i], .is_acceleration = true};
}

/* Lists lie in mem. */
static mt_status profile_row_of(const view *s, mt_arena *mem, profile_row *out, mt_err *err)
{
    const mt_vibration *const v = s->v;
    spectrum_row *const spectrum = &out->spectrum;
    *out = (profile_row){
        .file = v->path,
        .name = v->name,
        .source = v->source,
        .axis = mt_vibrated_axis(v),
        .rms_g = mt_vibration_rms(v) / MT_STANDARD_GRAVITY,
        .rms_m_per_s2 = mt_vibration_rms(v),
        .n_random = v->n_random,
        .random = mt_arena_alloc(mem, (size_t)v->n_random, sizeof *out->random),
        .n_tones = v->n_tones,
        .tones = mt_arena_alloc(mem, (size_t)v->n_tones, sizeof *out->tones),
        .rule = mt_rule_row_of(v),
        .with_spectrum = s->of.n > 0,
        .spectrum = {.damping_ratio = s->of.damping_ratio,
                     .n = s->of.n,
                     .masses = mt_arena_alloc(mem, (size_t)s->of.n, sizeof(mass_row))},
    };
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < v->n_random; i++) {
        MT_TRY(random_row_of(&v->random[i], v->n_random > 1 ? i + 1 : 0, mem, &out->random[i],
                             err));
    }
    for (int i = 0; i < v->n_tones; i++) {
        out->tones[i] = tone_row_of(v, i);
    }
    for (int i = 0; i < spectrum->n; i++) {
        const mt_vibrated row = vibrated_of(s, i);
        spectrum->masses[i].hz = s->hz[i];
        MT_TRY(mt_vibrated_values_of(&row, mem, &spectrum->masses[i].vibrated, err));
    }
    return MT_OK;
}

/* CSV has a row for each segment of the random parts and for each tone. */
typedef struct segment_row {
    const char *part;
    const char *name;
    double from_hz;
    double to_hz;
    double psd_from_g2_per_hz;
    double psd_to_g2_per_hz;
    double slope_db;
    double acceleration_g;
    const char *origin;
    const char *source;
} segment_row;

#define THIS segment_row
static const mt_field segment_fields[] = {
    MT_F_TEXT("part", part, "\"random\" or \"tone\"."),
    MT_F_TEXT("name", name, "Number of the random part, from 1, or what the tone is called."),
    MT_F_NUMBER("from_hz", from_hz, "Where it begins."),
    MT_F_NUMBER("to_hz", to_hz, "Where it ends."),
    MT_F_NUMBER_OR_NULL("psd_from_g2_per_hz", psd_from_g2_per_hz,
                        "Spectral density of the acceleration in g where it begins."),
    MT_F_NUMBER_OR_NULL("psd_to_g2_per_hz", psd_to_g2_per_hz, "The same where it ends."),
    MT_F_NUMBER_OR_NULL("slope_db_per_octave", slope_db, "Slope of the density."),
    MT_F_NUMBER_OR_NULL("acceleration_g", acceleration_g, "Peak of a tone, in g."),
    MT_F_TEXT_OR_NULL("origin", origin, "Where it is from."),
    MT_F_TEXT_OR_NULL("source", source, "Document that it is from."),
};
static const mt_record segment_record = MT_F_RECORD_OF(segment_fields, NULL, NULL);
static const mt_record_column segment_columns[] = {
    MT_R_COLUMN(part, "part", 0, MT_IN_CSV),
    MT_R_COLUMN(name, "name", 0, MT_IN_CSV),
    MT_R_COLUMN(from_hz, "from [Hz]", HZ_DIGITS, MT_IN_CSV),
    MT_R_COLUMN(to_hz, "to [Hz]", HZ_DIGITS, MT_IN_CSV),
    MT_R_COLUMN(psd_from_g2_per_hz, "density from [g^2/Hz]", DIGITS, MT_IN_CSV),
    MT_R_COLUMN(psd_to_g2_per_hz, "to [g^2/Hz]", DIGITS, MT_IN_CSV),
    MT_R_COLUMN(slope_db, "slope [dB/octave]", SLOPE_DIGITS, MT_IN_CSV),
    MT_R_COLUMN(acceleration_g, "peak [g]", DIGITS, MT_IN_CSV),
    MT_R_COLUMN(origin, "origin", 0, MT_IN_CSV),
    MT_R_COLUMN(source, "source", 0, MT_IN_CSV),
};
static const mt_record_table segment_rows = MT_R_TABLE_OF(segment_record, segment_columns);
#undef THIS

static void add_segments(mt_table *t, const random_row *r, int part)
{
    char name[PART_TEXT];
    (void)mt_snprintf(name, sizeof name, "%d", part);
    for (int k = 0; k + 1 < r->n; k++) {
        const breakpoint_row *const from = &r->breakpoints[k];
        const segment_row row = {
            .part = "random",
            .name = name,
            .from_hz = from->hz,
            .to_hz = from[1].hz,
            .psd_from_g2_per_hz = from->psd_g2_per_hz,
            .psd_to_g2_per_hz = from[1].psd_g2_per_hz,
            .slope_db = from->slope_db,
            .acceleration_g = nan(""),
            .origin = r->origin,
            .source = r->source,
        };
        mt_table_record_row(t, &segment_rows, MT_IN_CSV, &row);
    }
}

static void add_tone(mt_table *t, const tone_row *tone)
{
    const segment_row row = {
        .part = "tone",
        .name = tone->label,
        .from_hz = tone->lower_hz,
        .to_hz = tone->upper_hz,
        .psd_from_g2_per_hz = nan(""),
        .psd_to_g2_per_hz = nan(""),
        .slope_db = nan(""),
        .acceleration_g = tone->acceleration_g,
        .origin = tone->origin,
        .source = tone->source,
    };
    mt_table_record_row(t, &segment_rows, MT_IN_CSV, &row);
}

static int write_profile_json(const profile_row *row, mt_text *out)
{
    mt_json_writer w = mt_json_writer_default(out);
    mt_record_put_object(&w, NULL, &profile_record, row, 0, NULL);
    return mt_cli_json_done(&w);
}

static void print_random(const profile_row *p, mt_text *out)
{
    mt_table t = mt_table_default();
    mt_table_record_columns(&t, &breakpoint_rows, MT_IN_TEXT);
    mt_text_addf(out, "Random: %.5g g RMS (%.5g m/s^2) over all", p->rms_g, p->rms_m_per_s2);
    for (int i = 0; i < p->n_random; i++) {
        const random_row *const r = &p->random[i];
        for (int k = 0; k < r->n; k++) {
            mt_table_record_row(&t, &breakpoint_rows, MT_IN_TEXT, &r->breakpoints[k]);
        }
        if (!isnan(r->published_rms_g)) {
            mt_text_addf(out, "; the source prints %.5g g", r->published_rms_g);
        }
    }
    mt_text_add(out, "\n");
    mt_table_print(&t, 2, mt_terminal_width(), out);
    for (int i = 0; i < p->n_random; i++) {
        if (p->random[i].source != NULL) {
            mt_text_addf(out, "  Source: %s.\n", p->random[i].source);
        }
    }
    mt_text_add(out, "\n");
    mt_table_free(&t);
}

static void print_tones(const profile_row *p, mt_text *out)
{
    mt_table t = mt_table_default();
    mt_table_record_columns(&t, &tone_rows, MT_IN_TEXT);
    for (int i = 0; i < p->n_tones; i++) {
        mt_table_record_row(&t, &tone_rows, MT_IN_TEXT, &p->tones[i]);
    }
    mt_text_add(out, "Tones:\n");
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_text_add(out, "\n");
    mt_table_free(&t);
}

static mt_table spectrum_table(const view *s, const spectrum_row *spectrum)
{
    mt_table t = mt_table_default();
    mt_table_record_columns(&t, &mass_rows, MT_IN_TABLES);
    mt_vibrated_columns(&t);
    for (int i = 0; i < spectrum->n; i++) {
        const mt_vibrated row = vibrated_of(s, i);
        mt_table_record_row(&t, &mass_rows, MT_IN_TABLES, &spectrum->masses[i]);
        mt_vibrated_row(&t, &row);
    }
    return t;
}

/* Where the tones peak, of one mass. */
static void print_peaks(const view *s, mt_text *out)
{
    const mt_vibrated row = vibrated_of(s, 0);
    mt_table t = mt_table_default();
    mt_vibrated_tone_columns(&t);
    for (int i = 0; i < s->v->n_tones; i++) {
        mt_vibrated_tone_row(&t, &row, i);
    }
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_text_add(out, "\n");
    mt_table_free(&t);
}

static void write_profile_text(const view *s, const profile_row *p, mt_text *out)
{
    mt_text_addf(out, "%s%s%s%s\n\n", mt_vibrated_name(s->v), p->axis == NULL ? "" : ", along ",
                 p->axis == NULL ? "" : p->axis,
                 p->n_random > 0 && p->n_tones > 0 ? ": sine on random" : "");
    if (p->n_random > 0) {
        print_random(p, out);
    }
    if (p->n_tones > 0) {
        print_tones(p, out);
    }
    if (s->of.n > 0) {
        mt_table t = spectrum_table(s, &p->spectrum);
        mt_text_addf(out, "Absolute acceleration of one mass, damping ratio %.5g; ",
                     s->of.damping_ratio);
        mt_vibrated_rule(s->v, out);
        mt_text_add(out, ":\n");
        mt_table_print(&t, 2, mt_terminal_width(), out);
        mt_text_add(out, "\n");
        mt_table_free(&t);
        if (s->of.n == 1 && p->n_tones > 0) {
            print_peaks(s, out);
        }
    }
}

static mt_table segments_table(const profile_row *p)
{
    mt_table t = mt_table_default();
    mt_table_record_columns(&t, &segment_rows, MT_IN_CSV);
    for (int i = 0; i < p->n_random; i++) {
        add_segments(&t, &p->random[i], i + 1);
    }
    for (int i = 0; i < p->n_tones; i++) {
        add_tone(&t, &p->tones[i]);
    }
    return t;
}

static int print(const mt_args *args, const view *s, const profile_row *p, mt_text *out)
{
    mt_table t;
    switch (args->format) {
    case MT_FORMAT_JSON:
        return write_profile_json(p, out);
    case MT_FORMAT_CSV:
        t = s->of.n > 0 ? spectrum_table(s, &p->spectrum) : segments_table(p);
        mt_table_csv(&t, out);
        mt_table_free(&t);
        break;
    case MT_FORMAT_HTML:  /* of report alone */
    case MT_FORMAT_SARIF: /* of check alone */
    case MT_FORMAT_TEXT:
        write_profile_text(s, p, out);
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
    profile_row row;
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
        rc = rc == MT_OK ? profile_row_of(&s, &mem, &row, &err) : rc;
        code = rc == MT_OK ? print(args, &s, &row, out) : mt_cli_failed(rc, &err);
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
    .answer = {&profile_record, MT_ANSWER_FILES},
    .run = run_profile,
};
