/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune mac: two sets of modes, paired and correlated at the sensors of both models. */
#include <math.h>
#include <string.h>

#include "analysis/analysis.h"
#include "base/format.h"
#include "cli/cli.h"
#include "cli/terminal.h"
#include "report/table.h"

/* Two different modes of one model whose MAC at the sensors is above this look the same there:
 * a correlation with either says little about which. Common practice in modal testing calls 0.9
 * a correlation (Ewins, Modal Testing, section on MAC). */
static const double LOOKS_THE_SAME = 0.9;

enum { MAC_DIGITS = 5, DIGITS = 6, PAIR_TEXT = 32, NOTE_TEXT = 160 };

/* One of the two sides. */
typedef struct side {
    const char *letter;
    mt_loaded_model s;
    mt_analysis *a;
    int *channels; /* [ns] the common ones, in this system */
    int n;         /* vibration modes compared */
    int *position; /* [n] */
    double *shape; /* ns x n */
} side;

typedef struct comparison {
    side a;
    side b;
    int ns;
    double *scale; /* [ns] of displacements and angles together; NULL: of one kind */
    double *mac;   /* a.n x b.n */
    int *pair;     /* [a.n] */
    mt_arena mem;
} comparison;

static const char *side_configuration(const side *x)
{
    return mt_loaded_model_configuration(&x->s, x->s.configurations[0]);
}

/* "MODEL:CONFIGURATION", split at the last colon that is not part of a folder's name. */
static int load_compared_side(const mt_args *args, const char *text, comparison *c, side *x)
{
    const char *const colon = strrchr(text, ':');
    const bool split = colon != NULL && strchr(colon, '/') == NULL;
    const char *path = text;
    const char *configuration = NULL;
    if (split) {
        path = mt_arena_strndup(&c->mem, text, (size_t)(colon - text));
        configuration = colon + 1;
    }
    if (path == NULL) {
        mt_terminal_error("out of memory");
        return MT_EXIT_SYSTEM;
    }
    const int code = mt_loaded_model_load(args, path, configuration, &x->s);
    if (code == MT_EXIT_DONE && x->s.n_configurations != 1) {
        mt_terminal_error("\"%s\" has %d configurations: name one, as %s:%s", path,
                          x->s.n_configurations, path, side_configuration(x));
        return MT_EXIT_INPUT;
    }
    return code;
}

static mt_status choose_modes(comparison *c, side *x, int wanted, mt_err *err)
{
    const mt_modes *const m = &x->a->modes;
    x->position = mt_arena_int(&c->mem, (size_t)m->count);
    MT_TRY(mt_arena_check(&c->mem, err));
    for (int i = 0; i < m->count && x->n < wanted; i++) {
        if (m->kind[i] == MT_MODE_FLEXIBLE) {
            x->position[x->n++] = i;
        }
    }
    x->shape = mt_arena_f64(&c->mem, (size_t)c->ns, (size_t)x->n);
    MT_TRY(mt_arena_check(&c->mem, err));
    for (int i = 0; i < x->n; i++) {
        MT_TRY(mt_analysis_shape(x->a, x->position[i], c->ns, x->channels,
                                 x->shape + ((ptrdiff_t)i * c->ns), NULL, err));
    }
    mt_channels_weigh(c->ns, c->scale, x->n, x->shape);
    return MT_OK;
}

static mt_status correlate(comparison *c, int count, mt_err *err)
{
    MT_TRY(mt_loaded_model_analyse(&c->a.s, c->a.s.configurations[0], count, &c->a.a, err));
    MT_TRY(mt_loaded_model_analyse(&c->b.s, c->b.s.configurations[0], count, &c->b.a, err));
    mt_common_channels common;
    MT_TRY(mt_analysis_common_channels(c->a.a, c->b.a, &c->mem, &common, err));
    if (common.n == 0) {
        return mt_fail(err, MT_E_INPUT,
                       "the two have no sensor and direction in common (%d channels in A, %d "
                       "in B)",
                       c->a.a->sys->n_channels, c->b.a->sys->n_channels);
    }
    c->ns = common.n;
    c->a.channels = common.a;
    c->b.channels = common.b;
    const mt_system *const sys = c->a.a->sys;
    MT_TRY(mt_channels_scale(sys, c->ns, common.a, sys->length_m, &c->mem, &c->scale, err));
    const int wanted = count > 0 ? count : c->ns;
    MT_TRY(choose_modes(c, &c->a, wanted, err));
    MT_TRY(choose_modes(c, &c->b, wanted, err));
    c->mac = mt_arena_f64(&c->mem, (size_t)c->a.n, (size_t)c->b.n);
    c->pair = mt_arena_int(&c->mem, (size_t)c->a.n);
    MT_TRY(mt_arena_check(&c->mem, err));
    mt_mac_matrix(c->ns, c->a.n, c->a.shape, c->b.n, c->b.shape, c->mac);
    return mt_mac_pair(c->a.n, c->b.n, c->mac, c->pair, &c->mem, err);
}

/* Modes of one side that the sensors cannot tell apart, and other doubts, as sentences; emit
 * writes one. */
typedef void (*emit_note)(void *context, const char *text);

static mt_status note_alike(comparison *c, const side *x, emit_note emit, void *context,
                            mt_err *err)
{
    const int n = x->n;
    double *const own = mt_arena_f64(&c->mem, (size_t)n, (size_t)n);
    MT_TRY(mt_arena_check(&c->mem, err));
    mt_mac_matrix(c->ns, n, x->shape, n, x->shape, own);
    for (int j = 0; j < n; j++) {
        for (int i = 0; i < j; i++) {
            const double mac = own[i + ((ptrdiff_t)j * n)];
            if (mac > LOOKS_THE_SAME) {
                char text[NOTE_TEXT];
                (void)mt_snprintf(
                    text, sizeof text,
                    "modes %d and %d of %s look the same at the sensors (MAC %.4f)", i + 1,
                    j + 1, x->letter, mac);
                emit(context, text);
            }
        }
    }
    return MT_OK;
}

static mt_status notes(comparison *c, emit_note emit, void *context, mt_err *err)
{
    const int most = c->a.n > c->b.n ? c->a.n : c->b.n;
    if (most > c->ns) {
        char text[NOTE_TEXT];
        (void)mt_snprintf(
            text, sizeof text,
            "%d sensor channels cannot tell %d modes apart: shapes beyond %d depend "
            "on each other there",
            c->ns, most, c->ns);
        emit(context, text);
    }
    if (c->scale != NULL) {
        char text[NOTE_TEXT];
        (void)mt_snprintf(text, sizeof text,
                          "the sensors mix displacements and rotations: a rotation counts as "
                          "its arc at %.4g m, the length of A's model",
                          c->a.a->sys->length_m);
        emit(context, text);
    }
    MT_TRY(note_alike(c, &c->a, emit, context, err));
    return note_alike(c, &c->b, emit, context, err);
}

/* A cluster of repeated modes of A, and the modes of B that its members are paired with. */
typedef struct subspace {
    int first; /* 0-based mode of A */
    int size;
    int n_b;
    double *cos2; /* [min(size, n_b)] */
} subspace;

/* The cluster of A that begins at mode i; size 1 where it does not. */
static mt_status subspace_at(comparison *c, int i, subspace *out, mt_err *err)
{
    const mt_modes *const m = &c->a.a->modes;
    int size = 1;
    const int first = mt_modal_cluster(m, c->a.position[i], &size);
    *out = (subspace){.first = i, .size = 1};
    if (size < 2 || first != c->a.position[i]) {
        return MT_OK;
    }
    out->size = size < c->a.n - i ? size : c->a.n - i;
    const size_t ns = (size_t)c->ns;
    double *const b = mt_arena_f64(&c->mem, ns, (size_t)out->size);
    out->cos2 = mt_arena_f64(&c->mem, (size_t)out->size, 1);
    MT_TRY(mt_arena_check(&c->mem, err));
    for (int k = 0; k < out->size; k++) {
        const int j = c->pair[i + k];
        if (j >= 0) {
            memcpy(b + ((size_t)out->n_b * ns), c->b.shape + ((size_t)j * ns), ns * sizeof *b);
            out->n_b++;
        }
    }
    return mt_mac_subspace(c->ns, out->size, c->a.shape + ((size_t)i * ns), out->n_b, b,
                           out->cos2, &c->mem, err);
}

static double hz(const side *x, int mode)
{
    return mt_modal_hz(&x->a->modes, x->position[mode]);
}

/* A mode of A and the mode of B that it is paired with. */
typedef struct pair_row {
    int a;
    int b;
    double mac;
    double a_hz;
    double b_hz;
    double difference_percent;
} pair_row;

#define THIS pair_row
static const mt_field pair_fields[] = {
    MT_F_COUNT("a", a, 1, "Mode of A, from 1."),
    MT_F_COUNT("b", b, 1, "Mode of B, from 1."),
    MT_F_NUMBER("mac", mac, "Modal assurance criterion of both."),
    MT_F_NUMBER("frequency_a_hz", a_hz, "Natural frequency of A."),
    MT_F_NUMBER("frequency_b_hz", b_hz, "Natural frequency of B."),
    MT_F_NUMBER_OR_NULL(NULL, difference_percent, "Difference of B from A."),
};
static const mt_record pair_record = MT_F_RECORD_OF(
    pair_fields, "pair", "A mode of A and the mode of B that it is paired with.");
static const mt_record_column pair_columns[] = {
    MT_R_COLUMN(a, "A", 0, MT_IN_TABLES),
    MT_R_COLUMN(b, "B", 0, MT_IN_TABLES),
    MT_R_COLUMN(mac, "MAC", MAC_DIGITS, MT_IN_TABLES),
    MT_R_COLUMN(a_hz, "A [Hz]", DIGITS, MT_IN_TABLES),
    MT_R_COLUMN(b_hz, "B [Hz]", DIGITS, MT_IN_TABLES),
    MT_R_CHANGE(difference_percent, "B - A [%]", "difference_percent", 3, MT_IN_TABLES),
};
static const mt_record_table pair_rows = MT_R_TABLE_OF(pair_record, pair_columns);
#undef THIS

/* The pair of mode i of A; false where it has none. */
static bool pair_row_of(const comparison *c, int i, pair_row *out)
{
    const int j = c->pair[i];
    if (j >= 0) {
        *out = (pair_row){
            .a = i + 1,
            .b = j + 1,
            .mac = c->mac[i + ((ptrdiff_t)j * c->a.n)],
            .a_hz = hz(&c->a, i),
            .b_hz = hz(&c->b, j),
            .difference_percent = 100.0 * (hz(&c->b, j) / hz(&c->a, i) - 1.0),
        };
    }
    return j >= 0;
}

static mt_table pairs_table(const comparison *c, unsigned in)
{
    mt_table t = mt_table_default();
    pair_row row;
    mt_table_record_columns(&t, &pair_rows, in);
    for (int i = 0; i < c->a.n; i++) {
        if (pair_row_of(c, i, &row)) {
            mt_table_record_row(&t, &pair_rows, in, &row);
        }
    }
    return t;
}

/* A row of the matrix: a mode of A with each of B. */
typedef struct matrix_row {
    double *mac;
    int n;
} matrix_row;

#define THIS matrix_row
static const mt_field matrix_fields[] = {
    MT_F_NUMBERS(NULL, mac, n,
                 "Of a mode of A with each of B; null: one of them moves no sensor."),
};
static const mt_record matrix_record = MT_F_BARE_RECORD_OF(matrix_fields);
#undef THIS

/* Repeated modes of A against the modes of B that they are paired with. */
typedef struct subspace_row {
    int first_a;
    int modes;
    double *cos2;
    int n;
} subspace_row;

#define THIS subspace_row
static const mt_field subspace_fields[] = {
    MT_F_COUNT("first_a", first_a, 1, "First of them in A, from 1."),
    MT_F_COUNT("modes", modes, 2, "How many they are."),
    MT_F_NUMBERS("mac", cos2, n,
                 "Squared cosines of the angles between both spaces, largest first."),
};
static const mt_record subspace_record =
    MT_F_RECORD_OF(subspace_fields, "subspace", "Repeated modes, compared as a space.");
#undef THIS

/* The answer. */
typedef struct mac_row {
    pair_row *pairs;
    int n_pairs;
    matrix_row *matrix;
    int n_matrix;
    subspace_row *subspaces;
    int n_subspaces;
    double *vibration_modes;
    int n_sides;
    const char **channels;
    int n_channels;
    const char **notes;
    int n_notes;
} mac_row;

#define THIS mac_row
static const mt_field mac_fields[] = {
    MT_F_LIST("pairs", pairs, n_pairs, pair_row, pair_record,
              "Modes of A with the mode of B that each is paired with, one to one."),
    MT_F_LIST("matrix", matrix, n_matrix, matrix_row, matrix_record,
              "The criterion of each mode of A with each of B."),
    MT_F_LIST("subspaces", subspaces, n_subspaces, subspace_row, subspace_record,
              "Repeated modes of A."),
    MT_F_NUMBERS("vibration_modes", vibration_modes, n_sides,
                 "Number of vibration modes of A and of B."),
    MT_F_TEXTS("channels", channels, n_channels,
               "The sensors and directions that both have: there shapes are compared.",
               .flat = true),
    MT_F_TEXTS("notes", notes, n_notes, "What limits the comparison, in sentences."),
};
static const mt_record mac_record = MT_F_RECORD_OF(mac_fields, NULL, "Two sets of modes.");
#undef THIS

/* Notes are kept as texts. */
typedef struct kept_notes {
    mt_arena *mem;
    mac_row *row;
    int capacity;
} kept_notes;

static void keep_note(void *context, const char *text)
{
    kept_notes *const k = context;
    const char **const grown =
        mt_arena_grow(k->mem, k->row->notes, k->row->n_notes, &k->capacity, sizeof *grown);
    const char *const own = mt_arena_strdup(k->mem, text);
    if (grown != NULL && own != NULL) {
        k->row->notes = grown;
        grown[k->row->n_notes++] = own;
    }
}

static mt_status subspace_rows_of(comparison *c, mac_row *out, mt_err *err)
{
    subspace s = {.size = 1};
    for (int i = 0; i < c->a.n; i += s.size) {
        MT_TRY(subspace_at(c, i, &s, err));
        if (s.size > 1) {
            out->subspaces[out->n_subspaces++] =
                (subspace_row){.first_a = i + 1, .modes = s.size, .cos2 = s.cos2, .n = s.n_b};
        }
    }
    return MT_OK;
}

static void matrix_row_of(comparison *c, int i, matrix_row *out)
{
    out->mac = mt_arena_f64(&c->mem, (size_t)c->b.n, 1);
    for (; out->mac != NULL && out->n < c->b.n; out->n++) {
        out->mac[out->n] = c->mac[i + ((ptrdiff_t)out->n * c->a.n)];
    }
}

static mt_status mac_row_of(comparison *c, mac_row *out, mt_err *err)
{
    kept_notes kept = {.mem = &c->mem, .row = out};
    const size_t n = (size_t)c->a.n;
    *out = (mac_row){
        .pairs = mt_arena_alloc(&c->mem, n, sizeof *out->pairs),
        .matrix = mt_arena_alloc(&c->mem, n, sizeof *out->matrix),
        .subspaces = mt_arena_alloc(&c->mem, n, sizeof *out->subspaces),
        .vibration_modes = mt_arena_f64(&c->mem, 2, 1),
        .n_sides = 2,
        .channels = mt_arena_alloc(&c->mem, (size_t)c->ns, sizeof *out->channels),
        .n_channels = c->ns,
    };
    MT_TRY(mt_arena_check(&c->mem, err));
    for (int i = 0; i < c->a.n; i++) {
        out->n_pairs += pair_row_of(c, i, &out->pairs[out->n_pairs]) ? 1 : 0;
        matrix_row_of(c, i, &out->matrix[out->n_matrix++]);
    }
    out->vibration_modes[0] = mt_modal_vibrations(&c->a.a->modes);
    out->vibration_modes[1] = mt_modal_vibrations(&c->b.a->modes);
    for (int k = 0; k < c->ns; k++) {
        out->channels[k] = c->a.a->sys->channels[c->a.channels[k]].name;
    }
    MT_TRY(subspace_rows_of(c, out, err));
    MT_TRY(notes(c, keep_note, &kept, err));
    return mt_arena_check(&c->mem, err);
}

static mt_status write_mac_json(comparison *c, mt_json_writer *w, mt_err *err)
{
    mac_row row;
    MT_TRY(mac_row_of(c, &row, err));
    mt_record_put_object(w, NULL, &mac_record, &row, 0, NULL);
    return MT_OK;
}

static void text_note(void *context, const char *text)
{
    mt_text_addf(context, "  Note: %s.\n", text);
}

static void text_matrix(const comparison *c, mt_text *out)
{
    mt_table t = mt_table_default();
    char heading[PAIR_TEXT];
    mt_table_column(&t, "A \\ B", "a", MT_ALIGN_RIGHT);
    for (int j = 0; j < c->b.n; j++) {
        (void)mt_snprintf(heading, sizeof heading, "%d", j + 1);
        mt_table_column(&t, heading, heading, MT_ALIGN_RIGHT);
    }
    for (int i = 0; i < c->a.n; i++) {
        mt_table_integer(&t, i + 1);
        for (int j = 0; j < c->b.n; j++) {
            const double mac = c->mac[i + ((ptrdiff_t)j * c->a.n)];
            (void)mt_snprintf(heading, sizeof heading, "%.3f", mac);
            mt_table_text(&t, isfinite(mac) ? heading : NULL);
        }
    }
    mt_text_add(out, "\nMAC matrix\n");
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_table_free(&t);
}

/* Write which modes of one side are compared. */
static void write_side(const side *x, mt_text *out)
{
    const int all = mt_modal_vibrations(&x->a->modes);
    mt_text_addf(out, "%s: %s, %s, ", x->letter, x->s.path, side_configuration(x));
    if (x->n < all) {
        mt_text_addf(out, "the lowest %d of %d vibration modes\n", x->n, all);
    } else {
        mt_text_addf(out, "all %d vibration modes\n", x->n);
    }
}

static mt_status write_mac_text(comparison *c, mt_text *out, mt_err *err)
{
    write_side(&c->a, out);
    write_side(&c->b, out);
    mt_text_addf(out, "%d common sensor channels\n\n", c->ns);
    mt_table t = pairs_table(c, MT_IN_TEXT);
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_table_free(&t);
    text_matrix(c, out);
    subspace s = {.size = 1};
    for (int i = 0; i < c->a.n; i += s.size) {
        MT_TRY(subspace_at(c, i, &s, err));
        if (s.size > 1) {
            mt_text_addf(out, "  Repeated modes %d to %d of A as a space: MAC", i + 1,
                         i + s.size);
            for (int k = 0; k < s.n_b; k++) {
                mt_text_addf(out, " %.5f", s.cos2[k]);
            }
            mt_text_add(out, "\n");
        }
    }
    return notes(c, text_note, out, err);
}

static mt_status write_out(comparison *c, mt_format format, mt_text *out, mt_err *err)
{
    mt_json_writer w = mt_json_writer_default(out);
    mt_table t;
    switch (format) {
    case MT_FORMAT_JSON:
        MT_TRY(write_mac_json(c, &w, err));
        return mt_json_done(&w) ? MT_OK : mt_fail_memory(err);
    case MT_FORMAT_CSV:
        t = pairs_table(c, MT_IN_CSV);
        mt_table_csv(&t, out);
        mt_table_free(&t);
        return MT_OK;
    case MT_FORMAT_HTML:  /* of report alone */
    case MT_FORMAT_SARIF: /* of check alone */
    case MT_FORMAT_TEXT:
        break;
    }
    return write_mac_text(c, out, err);
}

static int run_mac(const mt_args *args, mt_text *out)
{
    comparison c = {.a = {.letter = "A"}, .b = {.letter = "B"}};
    mt_err err = {.code = MT_OK};
    int code = MT_EXIT_DONE;
    mt_status rc = mt_arena_init(&c.mem, 0, &err);
    if (rc == MT_OK) {
        code = load_compared_side(args, args->operands[0], &c, &c.a);
        code =
            code == MT_EXIT_DONE ? load_compared_side(args, args->operands[1], &c, &c.b) : code;
    }
    if (rc == MT_OK && code == MT_EXIT_DONE) {
        rc = correlate(&c, args->count, &err);
        rc = rc == MT_OK ? write_out(&c, args->format, out, &err) : rc;
    }
    code = rc == MT_OK ? code : mt_cli_failed(rc, &err);
    mt_analysis_delete(c.a.a);
    mt_analysis_delete(c.b.a);
    mt_loaded_model_free(&c.a.s);
    mt_loaded_model_free(&c.b.s);
    mt_arena_free(&c.mem);
    return code;
}

const mt_command mt_command_mac = {
    .name = "mac",
    .operands = "MODEL:CONFIGURATION MODEL:CONFIGURATION",
    .least = 2,
    .most = 2,
    .summary = "pair and correlate two sets of modes",
    .details =
        "Compares shapes at the sensors that both models have, pairs the modes one to one, and "
        "compares repeated modes as subspaces. Beside displacements, a rotation counts as its "
        "arc at the length of the first model. The configuration may be omitted if a model has "
        "only one. The default number of modes is that of the common sensor channels.",
    .answer = {&mac_record, MT_ANSWER_ONE},
    .run = run_mac,
};
