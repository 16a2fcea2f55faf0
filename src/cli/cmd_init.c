/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune init: a model and a study to begin with, and the schemas that editors complete them
 * by. */
#include "base/format.h"
#include "cli/cli.h"
#include "cli/shipped.h"

/* A file of the kind of model that is asked for (src/cli/init/KIND/; NULL: of the lever in the
 * plane). NULL: there is no such kind. */
static const mt_shipped *find_file(const char *kind, const char *name)
{
    char path[64];
    (void)mt_snprintf(path, sizeof path, "init/%s%s%s", kind == NULL ? "" : kind,
                      kind == NULL ? "" : "/", name);
    return mt_shipped_find(path);
}

int mt_cmd_init(const mt_args *args, mt_text *out)
{
    const char *const folder = args->n_operands > 0 ? args->operands[0] : ".";
    const char *const kind = args->value[MT_OPT_KIND];
    mt_err err = {.code = MT_OK};
    const mt_shipped_copy copies[] = {
        {find_file(kind, "model.json"), "model.json"},
        {find_file(kind, "study.json"), "study.json"},
        {mt_shipped_find("schemas/model.schema.json"), "schemas/model.schema.json"},
        {mt_shipped_find("schemas/study.schema.json"), "schemas/study.schema.json"},
    };
    if (copies[0].file == NULL) {
        return mt_cli_failed(mt_fail(&err, MT_E_USAGE,
                                     "no kind of model is called \"%s\"; --kind takes stick, "
                                     "mounts, arm, updating or rotor",
                                     kind),
                             &err);
    }
    const mt_status rc = mt_shipped_write(folder, copies, MT_COUNT(copies), &err);
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
