/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_RESULT_FOLDER_H
#define IO_RESULT_FOLDER_H

#include "base/sha256.h"
#include "base/text.h"
#include "result/result.h"

/* The files that hold a result in its folder. All are replaced as one (io/folder.h);
 * result.json decides, and names the others with their digests. */
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
/* The result that a path leads to: of a folder its result.json, else itself (also where it
 * leads nowhere). *out: heap, the caller's. Fails: MT_E_SYSTEM, MT_E_MEMORY. */
mt_status mt_result_path(const char *path, char **out, mt_err *err);
/* Note in result->run the n files that are to stand beside it, with their digests.
 * Fails: MT_E_MEMORY. */
mt_status mt_result_note_outputs(mt_result *result, int n, const char *const *names,
                                 char (*sha256)[MT_SHA256_TEXT], mt_err *err);
/* The text of timing.json beside the result at `path`, where it names the result with this
 * digest; else nothing. Fails: MT_E_SYSTEM, MT_E_MEMORY. */
mt_status mt_result_read_timing(const char *path, const char *sha256, mt_text *out,
                                mt_err *err);
/* True where this is a result that was written as a folder, and still called so. A copy under
 * another name belongs to nothing. */
bool mt_result_has_folder(const char *path, const mt_result *result);
/* Whether the files beside such a result, as far as they are there, belong to it. sha256: of
 * its own bytes. Fails: MT_E_INPUT where they do not, MT_E_SYSTEM, MT_E_MEMORY. */
mt_status mt_result_check_folder(const char *path, const char *sha256, const mt_result *result,
                                 mt_err *err);

#endif
