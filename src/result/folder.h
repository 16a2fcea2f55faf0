/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESULT_FOLDER_H
#define RESULT_FOLDER_H

#include "base/sha256.h"
#include "base/text.h"
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
/* The text of the timing.json next to the result at `path`, where it names the result with this
 * digest; else empty. Fails: MT_E_SYSTEM, MT_E_MEMORY. */
mt_status mt_result_read_timing(const char *path, const char *sha256, mt_text *out,
                                mt_err *err);
/* True where the result was written as a folder and the path still has its file name. A renamed
 * copy belongs to no folder. */
bool mt_result_has_folder(const char *path, const mt_result *result);
/* Check that the other files in the folder of such a result, where they exist, match it.
 * sha256: of its own bytes. Fails: MT_E_INPUT where they do not, MT_E_SYSTEM, MT_E_MEMORY. */
mt_status mt_result_check_folder(const char *path, const char *sha256, const mt_result *result,
                                 mt_err *err);

#endif
