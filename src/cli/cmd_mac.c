/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune mac: two sets of modes, paired and correlated at the sensors of both models. */
#include <math.h>
#include <string.h>

#include "base/format.h"
#include "cli/cli.h"
#include "cli/terminal.h"
#include "inspect/mac.h"
#include "report/table.h"

enum { MAC_DIGITS = 5, DIGITS = 6, PAIR_TEXT = 32 };

static const char *side_configuration(const mt_mac_side *x)
{
    return mt_loaded_model_configuration(&x->s, x->s.configurations[0]);
}

/* "MODEL:CONFIGURATION", split at the last colon that is not part of a folder's name. */
static int load_compared_side(const mt_args *args, const char *text, mt_arena *mem,
                              mt_mac_side *x)
{
    const char *const colon = strrchr(text, ':');
    const bool split = colon != NULL && strchr(colon, '/') == NULL;
    const char *path = text;
    const char *configuration = NULL;
    if (split) {
        path = mt_arena_strndup(mem, text, (size_t)(colon - text));
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

#define THIS mt_mac_pair_row
static const mt_record_column pair_columns[] = {
    MT_R_COLUMN(a, "A", 0, MT_IN_TABLES),
    MT_R_COLUMN(b, "B", 0, MT_IN_TABLES),
    MT_R_COLUMN(mac, "MAC", MAC_DIGITS, MT_IN_TABLES),
    MT_R_COLUMN(a_hz, "A [Hz]", DIGITS, MT_IN_TABLES),
    MT_R_COLUMN(b_hz, "B [Hz]", DIGITS, MT_IN_TABLES),
    MT_R_CHANGE(difference_percent, "B - A [%]", "difference_percent", 3, MT_IN_TABLES),
};
static const mt_record_table pair_rows = MT_R_TABLE_OF(mt_mac_pair_record, pair_columns);
#undef THIS

static mt_table pairs_table(const mt_mac_row *answer, unsigned in)
{
    mt_table t = mt_table_default();
    mt_table_record_columns(&t, &pair_rows, in);
    for (int i = 0; i < answer->n_pairs; i++) {
        mt_table_record_row(&t, &pair_rows, in, &answer->pairs[i]);
    }
    return t;
}

static void text_matrix(const mt_mac_row *row, mt_text *out)
{
    const int n = row->n_matrix > 0 ? row->matrix[0].n : 0;
    mt_table t = mt_table_default();
    char heading[PAIR_TEXT];
    mt_table_column(&t, "A \\ B", "a", MT_ALIGN_RIGHT);
    for (int j = 0; j < n; j++) {
        (void)mt_snprintf(heading, sizeof heading, "%d", j + 1);
        mt_table_column(&t, heading, heading, MT_ALIGN_RIGHT);
    }
    for (int i = 0; i < row->n_matrix; i++) {
        mt_table_integer(&t, i + 1);
        for (int j = 0; j < n; j++) {
            const double mac = row->matrix[i].mac[j];
            (void)mt_snprintf(heading, sizeof heading, "%.3f", mac);
            mt_table_text(&t, isfinite(mac) ? heading : NULL);
        }
    }
    mt_text_add(out, "\nMAC matrix\n");
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_table_free(&t);
}

/* Write which modes of one side are compared. */
static void write_side(const mt_mac_side *x, mt_text *out)
{
    const int all = mt_modal_vibrations(&x->a->modes);
    mt_text_addf(out, "%s: %s, %s, ", x->letter, x->s.path, side_configuration(x));
    if (x->n < all) {
        mt_text_addf(out, "the lowest %d of %d vibration modes\n", x->n, all);
    } else {
        mt_text_addf(out, "all %d vibration modes\n", x->n);
    }
}

static void write_mac_text(const mt_mac_view *c, mt_text *out)
{
    const mt_mac_row *const row = &c->row;
    write_side(&c->a, out);
    write_side(&c->b, out);
    mt_text_addf(out, "%d common sensor channels\n\n", c->ns);
    mt_table t = pairs_table(row, MT_IN_TEXT);
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_table_free(&t);
    text_matrix(row, out);
    for (int i = 0; i < row->n_subspaces; i++) {
        const mt_mac_subspace_row *const s = &row->subspaces[i];
        mt_text_addf(out, "  Repeated modes %d to %d of A as a space: MAC", s->first_a,
                     s->first_a + s->modes - 1);
        for (int k = 0; k < s->n; k++) {
            mt_text_addf(out, " %.5f", s->cos2[k]);
        }
        mt_text_add(out, "\n");
    }
    for (int i = 0; i < row->n_notes; i++) {
        mt_text_addf(out, "  Note: %s.\n", row->notes[i]);
    }
}

static mt_status write_out(const mt_mac_view *c, mt_format format, mt_text *out, mt_err *err)
{
    mt_json_writer w = mt_json_writer_default(out);
    mt_table t;
    switch (format) {
    case MT_FORMAT_JSON:
        mt_mac_put(c, &w);
        return mt_json_done(&w) ? MT_OK : mt_fail_memory(err);
    case MT_FORMAT_CSV:
        t = pairs_table(&c->row, MT_IN_CSV);
        mt_table_csv(&t, out);
        mt_table_free(&t);
        return MT_OK;
    case MT_FORMAT_HTML:  /* of report alone */
    case MT_FORMAT_SARIF: /* of check alone */
    case MT_FORMAT_TEXT:
        break;
    }
    write_mac_text(c, out);
    return MT_OK;
}

static int run_mac(const mt_args *args, mt_text *out)
{
    mt_mac_view c = {.ns = 0};
    mt_arena paths = {.first = NULL};
    mt_err err = {.code = MT_OK};
    mt_status rc = mt_arena_init(&paths, 0, &err);
    int code = MT_EXIT_DONE;
    if (rc == MT_OK) {
        code = load_compared_side(args, args->operands[0], &paths, &c.a);
        code = code == MT_EXIT_DONE ? load_compared_side(args, args->operands[1], &paths, &c.b)
                                    : code;
    }
    if (rc == MT_OK && code == MT_EXIT_DONE) {
        rc = mt_mac_view_take(&c, args->count, &err);
        rc = rc == MT_OK ? write_out(&c, args->format, out, &err) : rc;
    }
    code = rc == MT_OK ? code : mt_cli_failed(rc, &err);
    mt_mac_view_free(&c);
    mt_loaded_model_free(&c.a.s);
    mt_loaded_model_free(&c.b.s);
    mt_arena_free(&paths);
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
    .answer = {&mt_mac_record, MT_ANSWER_ONE},
    .run = run_mac,
};
