/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_IO_H
#define IO_IO_H

#include "base/text.h"
#include "model/model.h"

typedef struct mt_io_options {
    const char *root; /* folder that files named by other files must lie in; NULL: for a study the parent of its folder, for a
                         model no limit */
    size_t max_bytes; /* of one file; 0: MT_JSON_MAX_BYTES */
} mt_io_options;

/**
 * Read, resolve and check a model file (format "modetune-model/1").
 * @param[in]  opt       NULL: defaults
 * @param[out] out       the model, owned by the caller (mt_model_delete); NULL on failure
 * @param[out] messages  every diagnostic, warnings included, is appended as text (mt_json_print); may be NULL
 * Fails: MT_E_INPUT (err: the first diagnostic), MT_E_SYSTEM, MT_E_MEMORY.
 */
mt_status mt_model_load(const char *path, const mt_io_options *opt, mt_model **out, mt_text *messages,
                        mt_err *err);

#endif
