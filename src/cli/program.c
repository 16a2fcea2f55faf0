/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "modetune/version.h"

#include "base/base.h"
#include "cli/help.h"
#include "cli/limits.h"
#include "cli/manual.h"
#include "io/result_folder.h"

typedef int (*command_function)(const mt_args *args, mt_text *out);

static const command_function functions[MT_CMD_IDS] = {
    [MT_CMD_RUN] = mt_cmd_run,           [MT_CMD_MERGE] = mt_cmd_merge,
    [MT_CMD_COMPARE] = mt_cmd_compare,   [MT_CMD_MODES] = mt_cmd_modes,
    [MT_CMD_MAC] = mt_cmd_mac,           [MT_CMD_SWEEP] = mt_cmd_sweep,
    [MT_CMD_SIMULATE] = mt_cmd_simulate, [MT_CMD_SENSITIVITY] = mt_cmd_sensitivity,
    [MT_CMD_RESPONSE] = mt_cmd_response, [MT_CMD_INFO] = mt_cmd_info,
    [MT_CMD_SHOW] = mt_cmd_show,         [MT_CMD_REPORT] = mt_cmd_report,
    [MT_CMD_EXPLAIN] = mt_cmd_explain,   [MT_CMD_APPLY] = mt_cmd_apply,
    [MT_CMD_DIFF] = mt_cmd_diff,         [MT_CMD_CHECK] = mt_cmd_check,
    [MT_CMD_INIT] = mt_cmd_init,         [MT_CMD_EXAMPLES] = mt_cmd_examples,
    [MT_CMD_SCHEMA] = mt_cmd_schema,     [MT_CMD_PROFILE] = mt_cmd_profile,
    [MT_CMD_HELP] = mt_cmd_help,
};

static int wrong_use(const mt_args *args, mt_status rc, const mt_err *err)
{
    mt_terminal_error("%s", err->text);
    if (rc == MT_E_USAGE) {
        mt_terminal_talk(false, "Try \"modetune%s%s --help\".",
                         args->command == MT_CMD_NONE ? "" : " ",
                         args->command == MT_CMD_NONE ? "" : mt_commands[args->command].name);
    }
    return mt_exit_of(rc);
}

/* Commands that read one result accept its folder, too. */
static mt_status find_result(mt_args *args, mt_err *err)
{
    static const unsigned READERS =
        1U << MT_CMD_REPORT | 1U << MT_CMD_EXPLAIN | 1U << MT_CMD_APPLY | 1U << MT_CMD_SHOW;
    if ((READERS >> (unsigned)args->command & 1U) == 0) {
        return MT_OK;
    }
    MT_TRY(mt_result_path(args->operands[0], &args->result_path, err));
    args->operands[0] = args->result_path;
    return MT_OK;
}

int mt_cli_main(int argc, char *const argv[])
{
    mt_args args;
    mt_err err = {.code = MT_OK};
    mt_text out = {.s = NULL};
    int code = MT_EXIT_DONE;
    const mt_status rc = mt_args_parse(argc, argv, &args, &err);
    if (rc != MT_OK) {
        code = wrong_use(&args, rc, &err);
    } else if (args.given[MT_OPT_VERSION]) {
        mt_text_addf(&out, "modetune %s (commit %s, compiled by %s)\n", mt_version(),
                     mt_build_commit(), mt_build_compiler());
    } else if (args.given[MT_OPT_MANUAL]) {
        mt_manual(args.command, &out);
    } else if (args.given[MT_OPT_COMPLETION]) {
        mt_completion(args.shell, &out);
    } else if (args.given[MT_OPT_HELP]) {
        mt_help(args.command, &out);
    } else {
        mt_status ready = mt_limits_set(&args, &err);
        ready = ready == MT_OK ? find_result(&args, &err) : ready;
        code =
            ready == MT_OK ? functions[args.command](&args, &out) : mt_cli_failed(ready, &err);
    }
    code = mt_exit_worse(code, mt_terminal_put(&out));
    if (mt_exit_without_memory()) {
        mt_limits_explain();
    }
    mt_args_free(&args);
    return code;
}
