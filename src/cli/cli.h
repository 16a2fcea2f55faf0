/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_CLI_H
#define CLI_CLI_H

#include "analysis/analysis.h"
#include "base/run.h"
#include "base/text.h"
#include "cli/args.h"
#include "cli/loaded_model.h"
#include "cli/terminal.h"
#include "environment/aircraft.h"
#include "environment/vibration.h"
#include "io/file.h"
#include "io/json.h"
#include "io/options.h"
#include "io/write_json.h"
#include "mechanics/singular.h"
#include "model/read.h"
#include "result/folder.h"
#include "result/read.h"
#include "result/result.h"
#include "result/write.h"
#include "study/read.h"
#include "study/study.h"

/*
 * The commands. Each appends its standard output to `out`, writes messages and problems to
 * standard error itself, and returns the exit status.
 */
int mt_cmd_run(const mt_args *args, mt_text *out);
int mt_cmd_merge(const mt_args *args, mt_text *out);
int mt_cmd_compare(const mt_args *args, mt_text *out);
int mt_cmd_modes(const mt_args *args, mt_text *out);
int mt_cmd_mac(const mt_args *args, mt_text *out);
int mt_cmd_sweep(const mt_args *args, mt_text *out);
int mt_cmd_simulate(const mt_args *args, mt_text *out);
int mt_cmd_sensitivity(const mt_args *args, mt_text *out);
int mt_cmd_response(const mt_args *args, mt_text *out);
int mt_cmd_info(const mt_args *args, mt_text *out);
int mt_cmd_show(const mt_args *args, mt_text *out);
int mt_cmd_report(const mt_args *args, mt_text *out);
int mt_cmd_explain(const mt_args *args, mt_text *out);
int mt_cmd_apply(const mt_args *args, mt_text *out);
int mt_cmd_diff(const mt_args *args, mt_text *out);
int mt_cmd_check(const mt_args *args, mt_text *out);
int mt_cmd_init(const mt_args *args, mt_text *out);
int mt_cmd_examples(const mt_args *args, mt_text *out);
int mt_cmd_schema(const mt_args *args, mt_text *out);
int mt_cmd_profile(const mt_args *args, mt_text *out);
int mt_cmd_help(const mt_args *args, mt_text *out);

/* The whole program except its process-wide settings: parse, run, print. */
int mt_cli_main(int argc, char *const argv[]);

/* Report the outcome of loading a file: its diagnostics, or the error where there are none.
 * Returns the exit status of rc; frees the messages. */
int mt_cli_loaded(mt_status rc, mt_diagnostics *messages, const mt_err *err);
/* Report an error found in a study with its model: in messages with its place where the study
 * knows it, else in err with the file first. Nothing where rc is MT_OK. */
void mt_cli_place(const mt_study *study, const char *path, mt_status rc, mt_err *err,
                  mt_diagnostics *messages);
/* Report err and return the exit status of rc. */
int mt_cli_failed(mt_status rc, const mt_err *err);
mt_io_options mt_cli_io(const mt_args *args);
/* The recommendation of --rank. Fails: MT_E_USAGE. */
mt_status mt_cli_recommendation(const mt_args *args, const mt_result *result,
                                const mt_recommendation **out, mt_err *err);
/* A configuration without an answer in a list of answers, with the reason. */
void mt_cli_json_failed(mt_json_writer *w, const char *configuration, const mt_err *err);
/* Close a JSON output. Returns MT_EXIT_DONE, or reports a failure and returns its exit
 * status. */
int mt_cli_json_done(mt_json_writer *w);
/* Warnings and notes of a configuration, one line each, before its table. */
void mt_cli_print_warnings(const mt_warning_list *list, mt_text *out);
/* mt_cli_json_joints: names of joints as a list; mt_cli_json_redundant: member
 * "redundant_constraints", a list of such lists. */
void mt_cli_json_joints(mt_json_writer *w, const char *member, const mt_joint_names *joints);
mt_status mt_cli_json_redundant(mt_json_writer *w, mt_linear *lin, mt_arena *mem, mt_err *err);
/* Member "dead_centre" of an open object: null, or the distance to one and the joints whose
 * equations become dependent there. */
void mt_cli_json_dead_centre(mt_json_writer *w, const mt_nearness *nearness);

/* The model of a result, the first operand: the file of --model, else a file found that holds
 * exactly the bytes that were solved. file: mt_file_free; path: heap. Fails: MT_E_INPUT (not
 * found), MT_E_SYSTEM, MT_E_MEMORY. */
mt_status mt_find_model(const mt_args *args, const mt_result *result, mt_file *file,
                        char **path, mt_err *err);

/* Counters of the evaluations of a model from here on, with --profile; else NULL. */
mt_profile *mt_cli_profile(const mt_args *args, mt_profile *own);
/* Print the stages as a table on standard error; NULL: nothing. Returns the exit status. */
int mt_cli_profile_print(mt_profile *p);

/* Append the text of --help: of the program (MT_CMD_NONE) or of one command. */
void mt_help(int command, mt_text *out);
/* Append paragraphs of words (one per line of s) in lines of up to 92 columns that begin at
 * `column`; the caller has already written up to there for the first line. */
void mt_help_fill(const char *s, int column, mt_text *out);

/* A size on the command line: a whole number of bytes, or with k, M, G, T (1024 each). Fails:
 * MT_E_USAGE. */
mt_status mt_limits_read_size(const char *text, uint64_t *bytes, mt_err *err);

#endif
