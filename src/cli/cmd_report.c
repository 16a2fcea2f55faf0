/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune report: a result read back and told again, from itself alone. */
#include "cli/cli.h"
#include "cli/save.h"

int mt_cmd_report(const mt_args *args, mt_text *out)
{
    const mt_io_options opt = mt_cli_io(args);
    mt_diagnostics messages = {.count = 0};
    mt_err err = {.code = MT_OK};
    mt_result *result = NULL;
    const mt_status rc = mt_result_load(args->operands[0], &opt, &result, &messages, &err);
    int code = mt_cli_loaded(rc, &messages, &err);
    if (rc == MT_OK) {
        mt_json_writer w = mt_json_writer_default(out);
        mt_save_print(args, result, &w, out);
        code = args->format == MT_FORMAT_JSON ? mt_cli_json_done(&w) : MT_EXIT_DONE;
    }
    if (rc == MT_OK && args->given[MT_OPT_OUTPUT]) {
        code = mt_exit_worse(code, mt_save_again(args, args->operands[0], result));
    }
    mt_result_delete(result);
    return code;
}
