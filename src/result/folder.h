/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESULT_FOLDER_H
#define RESULT_FOLDER_H

#include "base/sha256.h"
#include "io/file.h"
#include "result/result.h"

/* The files that hold a result in its folder. All are replaced atomically (io/folder.h);
 * result.json is decisive, and lists the others with their digests. */
#define MT_RESULT_FILE_LIST(X)                       \
    X(MT_RESULT_FILE_DESIGNS, "recommendations.csv") \
    X(MT_RESULT_FILE_TRADE, "trade.csv")             \
    X(MT_RESULT_FILE_CURVES, "curves.csv")           \
    X(MT_RESULT_FILE_REPORT, "report.html")          \
    X(MT_RESULT_FILE_TIMING, "timing.json")          \
    X(MT_RESULT_FILE_RESULT, "result.json")
#define MT_RESULT_FILE_ENUM(id, name) id,
typedef enum mt_result_file {
    MT_RESULT_FILE_LIST(MT_RESULT_FILE_ENUM) MT_RESULT_FILE_COUNT
} mt_result_file;
#undef MT_RESULT_FILE_ENUM
const char *mt_result_file_name(mt_result_file which);
/* The result file of a path: of a folder its result.json, else the path itself (also where
 * nothing is there). *out: heap, the caller's. Fails: MT_E_SYSTEM, MT_E_MEMORY. */
mt_status mt_result_path(const char *path, char **out, mt_err *err);
/* Record in result->run the n files to be written with it, with their digests. Fails:
 * MT_E_MEMORY. */
mt_status mt_result_note_outputs(mt_result *result, int n, const char *const *names,
                                 char (*sha256)[MT_SHA256_TEXT], mt_err *err);

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
