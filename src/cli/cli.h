/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_CLI_H
#define CLI_CLI_H

#include "analysis/analysis.h"
#include "cli/args.h"
#include "cli/loaded_model.h"
#include "cli/terminal.h"
#include "io/io.h"
#include "io/write_json.h"
#include "mechanics/singular.h"
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

#endif
