/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune init: a model and a study to begin with, and the schemas that editors complete them
 * by. */
#include "cli/cli.h"
#include "cli/shipped.h"

static const char *const files[][2] = {
    {"init/model.json", "model.json"},
    {"init/study.json", "study.json"},
    {"schemas/model.schema.json", "schemas/model.schema.json"},
    {"schemas/study.schema.json", "schemas/study.schema.json"}};

int mt_cmd_init(const mt_args *args, mt_text *out)
{
    const char *const folder = args->n_operands > 0 ? args->operands[0] : ".";
    mt_shipped_copy copies[MT_COUNT(files)];
    mt_err err = {.code = MT_OK};
    for (int i = 0; i < MT_COUNT(files); i++) {
        copies[i] = (mt_shipped_copy){mt_shipped_find(files[i][0]), files[i][1]};
    }
    const mt_status rc = mt_shipped_write(folder, copies, MT_COUNT(copies), &err);
    if (rc != MT_OK) {
        return mt_cli_failed(rc, &err);
    }
    for (int i = 0; i < MT_COUNT(copies); i++) {
        mt_text_addf(out, "%s/%s\n", folder, copies[i].name);
    }
    mt_terminal_talk(args->given[MT_OPT_QUIET],
                     "%s: a model and a study to be changed into your own. \"modetune modes "
                     "model.json\" tells its frequencies, \"modetune run study.json\" what to "
                     "change.",
                     folder);
    return MT_EXIT_DONE;
}
