/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_IO_H
#define IO_IO_H

#include "base/diagnostics.h"
#include "base/text.h"
#include "io/files.h"
#include "io/json.h"
#include "io/write_json.h"
#include "model/model.h"
#include "result/result.h"
#include "study/aircraft.h"
#include "study/study.h"

typedef struct mt_io_options {
    /* folder that files named by other files must lie in; NULL: for a study the parent of its
     * folder, for a model no limit */
    const char *root;
    mt_files files;   /* where models, studies and catalogues come from; zeroed: the disk */
    size_t max_bytes; /* of one file; 0: MT_JSON_MAX_BYTES */
    /* [out] number of errors that a JSON Schema of the file sees as well; NULL: not wanted */
    int *structural;
} mt_io_options;

/**
 * Read, resolve and check a model file (format "modetune-model/1").
 * @param[in]  opt       NULL: defaults
 * @param[out] out       the model, owned by the caller (mt_model_delete); NULL on failure
 * @param[out] messages  every diagnostic, warnings included, is added; may be NULL
 * Fails: MT_E_INPUT (err: the first diagnostic), MT_E_SYSTEM, MT_E_MEMORY.
 */
mt_status mt_model_load(const char *path, const mt_io_options *opt, mt_model **out,
                        mt_diagnostics *messages, mt_err *err);
/* The same from a document that is parsed already; problems go to its diagnostics. `file` names
 * it in err. */
mt_status mt_model_from_json(mt_json *doc, const char *file, mt_model **out, mt_err *err);

/**
 * Read, resolve and check a study file (format "modetune-study/1") with the models that it
 * names.
 * @param[in]  opt       NULL: defaults; the models must lie beneath root
 * @param[out] out the study, owned by the caller (mt_study_delete), models included; NULL on
 *   failure
 * @param[out] messages the diagnostics of the study, then those of the models, are added; may
 *   be NULL Every problem is reported, whichever file it is in. Fails: MT_E_INPUT (err: the
 *   first; a model that is not there counts as one of the study's problems), MT_E_SYSTEM (a
 *   file cannot be read, or the study itself is not there), MT_E_MEMORY.
 */
mt_status mt_study_load(const char *path, const mt_io_options *opt, mt_study **out,
                        mt_diagnostics *messages, mt_err *err);

/**
 * Read and check a catalogue of aircraft (format "modetune-aircraft/1").
 * @param[in]  mem  owns the records; not freed on failure
 * Fails and messages as for mt_model_load.
 */
mt_status mt_aircraft_load(const char *path, const mt_io_options *opt, mt_arena *mem,
                           mt_aircraft_list *out, mt_diagnostics *messages, mt_err *err);

/* Append a result as JSON (format "modetune-result/1"): the same result gives the same bytes.
 * Fails: MT_E_MEMORY. */
mt_status mt_result_write(const mt_result *result, mt_text *out, mt_err *err);
/* The same as a value within a larger document (name NULL: in a list, or the whole). */
void mt_result_put(mt_json_writer *w, const char *name, const mt_result *result);
/* The items of one level as a list of objects. */
void mt_json_put_doubts(mt_json_writer *w, const char *name, const mt_doubt_list *list,
                        mt_doubt_level level);
/* One of its members, into an object that is open; name NULL: all of them. */
void mt_result_put_member(mt_json_writer *w, const char *name, const mt_result *result);

/* The files that hold a result in its folder. All are replaced as one (io/folder.h);
 * result.json decides, and names the others with their digests. */
#define MT_RESULT_FILE_LIST(X)                       \
    X(MT_RESULT_FILE_DESIGNS, "recommendations.csv") \
    X(MT_RESULT_FILE_TRADE, "trade.csv")             \
    X(MT_RESULT_FILE_REPORT, "report.html")          \
    X(MT_RESULT_FILE_TIMING, "timing.json")          \
    X(MT_RESULT_FILE_RESULT, "result.json")
#define MT_RESULT_FILE_ENUM(id, name) id,
typedef enum mt_result_file {
    MT_RESULT_FILE_LIST(MT_RESULT_FILE_ENUM) MT_RESULT_FILE_COUNT
} mt_result_file;
#undef MT_RESULT_FILE_ENUM
const char *mt_result_file_name(mt_result_file which);
/* Note in result->run the n files that are to stand beside it, with the digests of their texts.
 * Fails: MT_E_MEMORY. */
mt_status mt_result_note_outputs(mt_result *result, int n, const char *const *names,
                                 const mt_text *texts, mt_err *err);
/* The text of timing.json beside the result at `path`, where it names the result with this
 * digest; else nothing. Fails: MT_E_SYSTEM, MT_E_MEMORY. */
mt_status mt_result_read_timing(const char *path, const char *sha256, mt_text *out,
                                mt_err *err);
/* Is this a result that was written as a folder, and still called so? A copy under another name
 * belongs to nothing. */
bool mt_result_has_folder(const char *path, const mt_result *result);
/* Do the files beside such a result, as far as they are there, belong to it? sha256: of its own
 * bytes. Fails: MT_E_INPUT where they do not, MT_E_SYSTEM, MT_E_MEMORY. */
mt_status mt_result_check_folder(const char *path, const char *sha256, const mt_result *result,
                                 mt_err *err);

/**
 * Read a result file back, whole: writing it again gives the same bytes. A result.json in its
 * folder is read only where the files beside it belong to it; a run that is just replacing them
 * is waited for. Owned by the caller (mt_result_delete). Fails: MT_E_INPUT, MT_E_SYSTEM,
 * MT_E_MEMORY; messages as for mt_study_load.
 */
mt_status mt_result_load(const char *path, const mt_io_options *opt, mt_result **out,
                         mt_diagnostics *messages, mt_err *err);

#endif
