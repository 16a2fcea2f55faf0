/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESULT_MODEL_H
#define RESULT_MODEL_H

#include "io/file.h"
#include "result/result.h"

/* The SHA-256 of the model that a result was solved from; NULL where the result has none. */
const char *mt_result_model_sha256(const mt_result *result);

/**
 * Find the model that a result was solved from by its digest: from the place of the study that
 * timing.json next to the result names, the result's folder and the two above it, the current
 * folder, and folders "studies" in these.
 * @param[in]  root folder that must contain it; NULL: the parent of the place from which it is
 *   named, as of a study there
 * @param[out] file, path  mt_file_free; heap. Empty and NULL on failure
 * Fails: MT_E_INPUT (it is not found), MT_E_SYSTEM (a candidate cannot be read), MT_E_MEMORY.
 */
mt_status mt_result_find_model(const char *result_path, const mt_result *result,
                               const char *root, mt_file *file, char **path, mt_err *err);

#endif
