/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reading and writing for users of the library: the same as for the program, without its
 * options. */
#include "io/io.h"

mt_status mt_study_read(const char *path, mt_study **out, mt_err *err)
{
    MT_NOT_NULL(out, err);
    *out = NULL;
    MT_NOT_NULL(path, err);
    return mt_study_load(path, NULL, out, NULL, err);
}

mt_status mt_result_json(const mt_result *result, char **text, mt_err *err)
{
    mt_text out = {0};
    MT_NOT_NULL(text, err);
    *text = NULL;
    MT_NOT_NULL(result, err);
    const mt_status rc = mt_result_write(result, &out, err);
    if (rc != MT_OK) {
        mt_text_free(&out);
        return rc;
    }
    *text = out.s; /* from malloc */
    return MT_OK;
}
