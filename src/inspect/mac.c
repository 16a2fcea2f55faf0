/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Two sets of modes, paired and correlated at the sensors of both models, as records. */
#include "inspect/mac.h"

#include <math.h>
#include <string.h>

#include "analysis/analysis.h"
#include "base/format.h"
#include "modal/modal.h"
#include "result/write.h"

/* Two different modes of one model whose MAC at the sensors is above this look the same there:
 * a correlation with either says little about which. Common practice in modal testing calls 0.9
 * a correlation (Ewins, Modal Testing, section on MAC). */
static const double LOOKS_THE_SAME = 0.9;

enum { NOTE_TEXT = 160 };

static mt_status choose_modes(mt_mac_view *c, mt_mac_side *x, int wanted, mt_err *err)
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

static mt_status correlate(mt_mac_view *c, int count, mt_err *err)
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

/* Modes of one side that the sensors cannot tell apart, and other doubts, as sentences;
 * emit writes one. */
typedef void (*emit_note)(void *context, const char *text);

static mt_status note_alike(mt_mac_view *c, const mt_mac_side *x, emit_note emit, void *context,
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

static mt_status notes(mt_mac_view *c, emit_note emit, void *context, mt_err *err)
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
static mt_status subspace_at(mt_mac_view *c, int i, subspace *out, mt_err *err)
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

static double hz(const mt_mac_side *x, int mode)
{
    return mt_modal_hz(&x->a->modes, x->position[mode]);
}

#define THIS mt_mac_pair_row
static const mt_field pair_fields[] = {
    MT_F_COUNT("a", a, 1, "Mode of A, from 1."),
    MT_F_COUNT("b", b, 1, "Mode of B, from 1."),
    MT_F_NUMBER("mac", mac, "Modal assurance criterion of both."),
    MT_F_NUMBER("frequency_a_hz", a_hz, "Natural frequency of A."),
    MT_F_NUMBER("frequency_b_hz", b_hz, "Natural frequency of B."),
    MT_F_NUMBER_OR_NULL(NULL, difference_percent, "Difference of B from A."),
};
const mt_record mt_mac_pair_record = MT_F_RECORD_OF(
    pair_fields, "pair", "A mode of A and the mode of B that it is paired with.");
#undef THIS

/* The pair of mode i of A; false where it has none. */
static bool pair_row_of(const mt_mac_view *c, int i, mt_mac_pair_row *out)
{
    const int j = c->pair[i];
    if (j >= 0) {
        *out = (mt_mac_pair_row){
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

#define THIS mt_mac_matrix_row
static const mt_field matrix_fields[] = {
    MT_F_NUMBERS(NULL, mac, n,
                 "Of a mode of A with each of B; null: one of them moves no sensor."),
};
static const mt_record matrix_record = MT_F_BARE_RECORD_OF(matrix_fields);
#undef THIS

#define THIS mt_mac_subspace_row
static const mt_field subspace_fields[] = {
    MT_F_COUNT("first_a", first_a, 1, "First of them in A, from 1."),
    MT_F_COUNT("modes", modes, 2, "How many they are."),
    MT_F_NUMBERS("mac", cos2, n,
                 "Squared cosines of the angles between both spaces, largest first."),
};
static const mt_record subspace_record =
    MT_F_RECORD_OF(subspace_fields, "subspace", "Repeated modes, compared as a space.");
#undef THIS

#define THIS mt_mac_row
static const mt_field mac_fields[] = {
    MT_F_LIST("pairs", pairs, n_pairs, mt_mac_pair_row, mt_mac_pair_record,
              "Modes of A with the mode of B that each is paired with, one to one."),
    MT_F_LIST("matrix", matrix, n_matrix, mt_mac_matrix_row, matrix_record,
              "The criterion of each mode of A with each of B."),
    MT_F_LIST("subspaces", subspaces, n_subspaces, mt_mac_subspace_row, subspace_record,
              "Repeated modes of A."),
    MT_F_NUMBERS("vibration_modes", vibration_modes, n_sides,
                 "Number of vibration modes of A and of B."),
    MT_F_TEXTS("channels", channels, n_channels,
               "The sensors and directions that both have: there shapes are compared.",
               .flat = true),
    MT_F_TEXTS("notes", notes, n_notes, "What limits the comparison, in sentences."),
};
const mt_record mt_mac_record = MT_F_RECORD_OF(mac_fields, NULL, "Two sets of modes.");
#undef THIS

/* Notes are kept as texts. */
typedef struct kept_notes {
    mt_arena *mem;
    mt_mac_row *row;
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

static mt_status subspace_rows_of(mt_mac_view *c, mt_mac_row *out, mt_err *err)
{
    subspace s = {.size = 1};
    for (int i = 0; i < c->a.n; i += s.size) {
        MT_TRY(subspace_at(c, i, &s, err));
        if (s.size > 1) {
            out->subspaces[out->n_subspaces++] = (mt_mac_subspace_row){
                .first_a = i + 1, .modes = s.size, .cos2 = s.cos2, .n = s.n_b};
        }
    }
    return MT_OK;
}

static void matrix_row_of(mt_mac_view *c, int i, mt_mac_matrix_row *out)
{
    out->mac = mt_arena_f64(&c->mem, (size_t)c->b.n, 1);
    for (; out->mac != NULL && out->n < c->b.n; out->n++) {
        out->mac[out->n] = c->mac[i + ((ptrdiff_t)out->n * c->a.n)];
    }
}

static mt_status mac_row_of(mt_mac_view *c, mt_mac_row *out, mt_err *err)
{
    kept_notes kept = {.mem = &c->mem, .row = out};
    const size_t n = (size_t)c->a.n;
    *out = (mt_mac_row){
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

mt_status mt_mac_view_take(mt_mac_view *v, int count, mt_err *err)
{
    v->a.letter = "A";
    v->b.letter = "B";
    MT_TRY(mt_arena_init(&v->mem, 0, err));
    MT_TRY(correlate(v, count, err));
    return mac_row_of(v, &v->row, err);
}

void mt_mac_view_free(mt_mac_view *v)
{
    mt_analysis_delete(v->a.a);
    mt_analysis_delete(v->b.a);
    mt_arena_free(&v->mem);
}

void mt_mac_put(const mt_mac_view *v, mt_json_writer *w)
{
    mt_record_put_object(w, NULL, &mt_mac_record, &v->row, 0, NULL);
}
