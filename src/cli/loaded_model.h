/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_LOADED_MODEL_H
#define CLI_LOADED_MODEL_H

#include "base/text.h"
#include "cli/args.h"
#include "inspect/loaded_model.h"
#include "inspect/response.h"
#include "io/file.h"
#include "io/write_json.h"
#include "report/table.h"
#include "result/result.h"

/**
 * Load the model, apply --set, choose configurations: the named one, or all where the name is
 * NULL. Returns MT_EXIT_DONE or the exit status, with all messages given. mt_loaded_model_free
 * in any case (out zeroed before).
 */
int mt_loaded_model_load(const mt_args *args, const char *path, const char *configuration,
                         mt_loaded_model *out);
/* Warn where overrides of the configuration take precedence over --set. */
void mt_loaded_model_warn_overridden(const mt_loaded_model *s, int c);
/* Append a note about each simplification of links of configuration c, after an answer in
 * text. */
void mt_loaded_model_note_links(const mt_loaded_model *s, int c, mt_text *out);
/* Warn where `option` drives joints of which the configuration does not drive one: its own
 * drives of other joints are then dropped (mechanics/system.h: mt_system_drive). */
void mt_loaded_model_warn_dropped(const mt_loaded_model *s, int c, const char *option, int n,
                                  const mt_system_drive *drives);
/* Close a JSON output. Returns MT_EXIT_DONE, or reports a failure and returns its exit
 * status. */
int mt_cli_json_done(mt_json_writer *w);
/* How it ended so far. */
typedef struct mt_cli_shown {
    int code; /* exit status */
} mt_cli_shown;
/* Shows one configuration; shown->code gets worse where there is more to tell than its
 * failure. */
typedef mt_status (*mt_cli_show)(void *context, mt_loaded_model *s, int c, mt_cli_shown *shown,
                                 mt_err *err);
/* Shows each configuration with the warnings that all commands have; the failure of one does
 * not hide the others. In JSON a list of what they write to w, without -c. Returns the exit
 * status. */
int mt_cli_each(const mt_args *args, mt_loaded_model *s, mt_json_writer *w, mt_cli_show show,
                void *context);
/* Warnings and notes of a configuration, one line each, before its table. */
void mt_cli_print_warnings(const mt_warning_list *list, mt_text *out);
/* The model of a result, the first operand: the file of --model, else a file found that holds
 * exactly the bytes that were solved. file: mt_file_free; path: heap. Fails: MT_E_INPUT (not
 * found), MT_E_SYSTEM, MT_E_MEMORY. */
mt_status mt_find_model(const mt_args *args, const mt_result *result, mt_file *file,
                        char **path, mt_err *err);

/* "the peak is 3 times the RMS and the sum of all tones" */
void mt_vibrated_rule(const mt_vibration *v, mt_text *out);
/* Append what is assumed or unconfirmed in the profile; nothing where all is confirmed. */
void mt_vibrated_marks(const mt_vibration *v, mt_text *out);

/* Columns and row: RMS, largest tones and combined peak, after the caller's own columns. */
void mt_vibrated_columns(mt_table *t);
void mt_vibrated_row(mt_table *t, const mt_vibrated *v);
/* Columns for each tone: frequency in its range of the largest response, and this response. */
void mt_vibrated_tone_columns(mt_table *t);
/* The cells of one tone. */
void mt_vibrated_tone_row(mt_table *t, const mt_vibrated *v, int tone);

#endif
