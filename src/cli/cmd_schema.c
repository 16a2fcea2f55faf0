/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune schema: the JSON Schemas, which editors complete and check files by. */
#include "cli/cli.h"
#include "cli/shipped.h"

int mt_cmd_schema(const mt_args *args, mt_text *out)
{
    mt_err err = {.code = MT_OK};
    const mt_shipped *file = NULL;
    if (args->n_operands == 0) {
        return mt_shipped_list(args, &mt_shipped_schemas, out);
    }
    const mt_status rc = mt_shipped_named(&mt_shipped_schemas, args->operands[0], &file, &err);
    if (rc != MT_OK) {
        return mt_cli_failed(rc, &err);
    }
    mt_text_add_n(out, file->bytes, file->size);
    return MT_EXIT_DONE;
}
