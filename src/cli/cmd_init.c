/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune init: a model and a study to begin with, and the schemas that editors complete them
 * by. */
#include <string.h>

#include "base/format.h"
#include "cli/cli.h"
#include "cli/shipped.h"

/* What --kind takes: src/cli/init/KIND holds its model and its study. */
static const char *const kinds[] = {"stick", "mounts", "arm", "updating", "rotor"};

/* The folder of the kind that is asked for, with its slash. */
static mt_status find_kind(const mt_args *args, char *folder, size_t size, mt_err *err)
{
    const char *const asked = args->value[MT_OPT_KIND];
    if (asked == NULL) {
        (void)mt_snprintf(folder, size, "init/");
        return MT_OK;
    }
    for (int k = 0; k < MT_COUNT(kinds); k++) {
        if (strcmp(kinds[k], asked) == 0) {
            (void)mt_snprintf(folder, size, "init/%s/", kinds[k]);
            return MT_OK;
        }
    }
    return mt_fail(
        err, MT_E_USAGE,
        "no kind of model is called \"%s\"; --kind takes stick, mounts, arm, updating "
        "or rotor",
        asked);
}

int mt_cmd_init(const mt_args *args, mt_text *out)
{
    const char *const folder = args->n_operands > 0 ? args->operands[0] : ".";
    char begun[32];
    char model[64];
    char study[64];
    mt_err err = {.code = MT_OK};
    mt_status rc = find_kind(args, begun, sizeof begun, &err);
    if (rc != MT_OK) {
        return mt_cli_failed(rc, &err);
    }
    (void)mt_snprintf(model, sizeof model, "%smodel.json", begun);
    (void)mt_snprintf(study, sizeof study, "%sstudy.json", begun);
    const mt_shipped_copy copies[] = {
        {mt_shipped_find(model), "model.json"},
        {mt_shipped_find(study), "study.json"},
        {mt_shipped_find("schemas/model.schema.json"), "schemas/model.schema.json"},
        {mt_shipped_find("schemas/study.schema.json"), "schemas/study.schema.json"},
    };
    rc = mt_shipped_write(folder, copies, MT_COUNT(copies), &err);
    if (rc != MT_OK) {
        return mt_cli_failed(rc, &err);
    }
    for (int i = 0; i < MT_COUNT(copies); i++) {
        mt_text_addf(out, "%s/%s\n", folder, copies[i].name);
    }
    mt_terminal_talk(
        args->given[MT_OPT_QUIET],
        "%s: a model and a study to change into your own. \"modetune modes "
        "model.json\" prints its frequencies, \"modetune run study.json\" says what "
        "to change.",
        folder);
    return MT_EXIT_DONE;
}
