/* SPDX-License-Identifier: GPL-3.0-or-later */
/* --model takes a file as it is, with a warning where it is not what was solved; without it the
 * model is looked for (io/result_model.h). */
#include "cli/find_model.h"

#include <string.h>

#include "cli/cli.h"
#include "io/result_model.h"

mt_status mt_find_model(const mt_args *args, const mt_result *result, mt_file *file,
                        char **path, mt_err *err)
{
    const char *const given = args->value[MT_OPT_MODEL];
    const char *const root = args->value[MT_OPT_ROOT];
    if (given == NULL) {
        return mt_result_find_model(args->operands[0], result, root, file, path, err);
    }
    MT_TRY(mt_file_read(given, root, MT_JSON_MAX_BYTES, file, err));
    const char *const hash = mt_result_model_sha256(result);
    if (hash == NULL || strcmp(hash, file->sha256) != 0) {
        mt_terminal_warning("%s is not what was solved: it has changed since", given);
    }
    *path = mt_file_join("x", given);
    return *path == NULL ? mt_fail_memory(err) : MT_OK;
}
