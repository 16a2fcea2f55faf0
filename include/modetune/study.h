/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A study: a question asked of a model, read from a file and answered.
 *
 *     mt_study *study;
 *     mt_result *result;
 *     if (mt_study_read("studies/beam_identification.json", NULL, &study, &err) == MT_OK &&
 *         mt_study_solve(study, NULL, &result, &err) == MT_OK &&
 *         mt_result_outcome(result) == MT_RESULT_SOLVED) {
 *         k = mt_result_value(result, 1, "K_T1");
 *     }
 *
 * Studies and results are immutable: any number of threads may read and solve the same study.
 * The search uses BLAS: have it use one thread, or the bits of results may differ from run to
 * run. GSL's error handler, which belongs to the whole process, is neither set nor called.
 */
#ifndef MODETUNE_STUDY_H
#define MODETUNE_STUDY_H

#include "modetune/export.h"
#include "modetune/model.h"
#include "modetune/read.h"
#include "modetune/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct mt_study mt_study;
typedef struct mt_result mt_result;

/* How a search ended. Not to meet the goals is an answer, no failure. */
#define MT_RESULT_STATUS_LIST(X)                                               \
    X(MT_RESULT_SOLVED, "solved")                                              \
    X(MT_RESULT_COMPROMISE, "compromise")                                      \
    X(MT_RESULT_INFEASIBLE, "infeasible")                                      \
    X(MT_RESULT_FITTED, "fitted") /* all goals are weighted: a least misfit */ \
    X(MT_RESULT_INTERRUPTED, "interrupted")                                    \
    X(MT_RESULT_TIME_LIMIT, "time_limit")
#define MT_RESULT_STATUS_ENUM(id, name) id,
typedef enum mt_result_status {
    MT_RESULT_STATUS_LIST(MT_RESULT_STATUS_ENUM) MT_RESULT_STATUS_COUNT
} mt_result_status;
#undef MT_RESULT_STATUS_ENUM

typedef struct mt_solve_options {
    size_t size; /* sizeof(mt_solve_options); modetune/read.h tells how options grow */
    /* workers, fewer than 1 count as 1, at most 64 are used; the result does not depend on
     * it */
    int threads;
    /* [variables of the study] one more design to start from, finite; what lies outside of its
     * bounds is moved to them. NULL: none */
    const double *hint;
    /* NULL, or asked for an mt_stop_request before every small piece of work, by all workers at
     * once; what it said once it need not say again */
    int (*stop)(void *context);
    void *stop_context;
    /* NULL, or called from the caller's thread with one line of text, when a search begins and
     * now and then */
    void (*progress)(void *context, const char *text);
    void *progress_context;
    /* NULL, or asked, with stop_context, of an answer that was cut: an mt_stop_reason */
    int (*cause)(void *context);
} mt_solve_options;

/**
 * Read a study file (format "modetune-study/1") and the models and catalogues that it names,
 * each relative to the folder of the file that names it.
 * @param[in]  path  regular file of at most 16 MiB, or one that opt gives by its text
 * @param[in]  opt   NULL: defaults
 * @param[out] out   the study, owned by the caller; NULL on failure
 * Fails: MT_E_INPUT (err tells the first problem with file, line, column and JSON pointer, and
 * how many more there are, opt->diagnostics all of them), MT_E_SYSTEM, MT_E_USAGE (opt),
 * MT_E_MEMORY.
 */
MT_API mt_status mt_study_read(const char *path, const mt_read_options *opt, mt_study **out,
                               mt_err *err);
/* Accepts NULL. */
MT_API void mt_study_delete(mt_study *study);

/* What the study calls itself, else its file; lives as long as the study, like all names
 * here. */
MT_API const char *mt_study_title(const mt_study *study);
/* Its model, which is the study's and goes with it. */
MT_API const mt_model *mt_study_model(const mt_study *study);
/* Number of variables, and of each from 0: the parameter (NULL beyond the last), its value in
 * the model and its bounds, those of a catalogue its ends (NaN beyond the last), in its
 * unit. */
MT_API int mt_study_variable_count(const mt_study *study);
MT_API const char *mt_study_variable_name(const mt_study *study, int variable);
MT_API double mt_study_variable_original(const mt_study *study, int variable);
MT_API double mt_study_variable_lower(const mt_study *study, int variable);
MT_API double mt_study_variable_upper(const mt_study *study, int variable);

/* A `stop` whose stop_context is an int, an mt_stop_request that any thread, or a handler of a
 * signal, may set there meanwhile. For who has no C function to give, or a slow one: it is
 * asked often. NULL: MT_STOP_REQUEST_NONE. */
MT_API int mt_stop_request_at(void *request);

/**
 * Answer a study: the original design described, searched for better ones, each recommendation
 * analysed anew at its design, published values judged.
 * @param[in]  opt  NULL: defaults
 * @param[out] out the result, owned by the caller, valid without the study; NULL on failure
 *   Deterministic: the same study, binary and machine give the same result. The study is not
 *   changed and may be shared by threads. Fails: MT_E_INPUT (what only numbers can tell: a mode
 *   that does not exist at the original design, ...), numerical failures at the original
 *   design, MT_E_USAGE (a hint that is not finite), MT_E_INTERRUPTED (stopped before the
 *   original design was analysed: there is nothing to tell), MT_E_MEMORY. A solve that is
 *   stopped later has a result with status interrupted that says which of its parts are not
 *   complete; what it does tell holds.
 */
MT_API mt_status mt_study_solve(const mt_study *study, const mt_solve_options *opt,
                                mt_result **out, mt_err *err);

/* Accepts NULL. */
MT_API void mt_result_delete(mt_result *result);
/* MT_RESULT_STATUS_COUNT where there is no result. */
MT_API mt_result_status mt_result_outcome(const mt_result *result);
/* "solved" ...; "unknown" for what is no status; never NULL. */
MT_API const char *mt_result_status_name(mt_result_status status);
/* One sentence about the outcome; lives as long as the result, like all texts below. */
MT_API const char *mt_result_summary(const mt_result *result);
/* Designs that are recommended, best first: ranks 1 to this number. */
MT_API int mt_result_recommendations(const mt_result *result);

/*
 * Of the design with this rank (0: the original design). Ranks that do not exist have no values
 * (NaN) and no reasons (0, NULL).
 */
/* 1: all goals are met there, 0: not. */
MT_API int mt_result_feasible(const mt_result *result, int rank);
/* Value of a variable of the study; NaN where it has no variable of this name. */
MT_API double mt_result_value(const mt_result *result, int rank, const char *parameter);
/* Frequency of a vibration mode (from 1) of a configuration that a goal names [Hz]; NaN where
 * it is not listed. */
MT_API double mt_result_hz(const mt_result *result, int rank, const char *configuration,
                           int mode);
/* Sentences why it is what it is, and their number. */
MT_API int mt_result_reasons(const mt_result *result, int rank);
MT_API const char *mt_result_reason(const mt_result *result, int rank, int i);

/**
 * Everything, as a JSON text (format "modetune-result/1").
 * @param[out] text  NUL-terminated, to be given to mt_string_delete; NULL on failure
 * Fails: MT_E_MEMORY.
 */
MT_API mt_status mt_result_json(const mt_result *result, char **text, mt_err *err);
/**
 * A result that was written before, by mt_result_json or as result.json by the program: whole,
 * so that all functions say of it what they said then.
 * @param[in]  path  regular file, or one that opt gives by its text. One of the disk that is
 *   called result.json must belong to the files that were written beside it
 * @param[in]  opt   NULL: defaults; root, sets and seed are of no meaning here
 * @param[out] out   the result, owned by the caller; NULL on failure
 * Fails: MT_E_INPUT (as mt_study_read), MT_E_SYSTEM, MT_E_USAGE (opt), MT_E_MEMORY.
 */
MT_API mt_status mt_result_read(const char *path, const mt_read_options *opt, mt_result **out,
                                mt_err *err);
/**
 * The model that a result was solved from, where it lies near the result and has not changed:
 * found from the place of the study that timing.json beside the result names, the result's
 * folder and the two above it, the current folder, and folders "studies" in these.
 * @param[in]  path  the result's, as mt_result_read had it
 * @param[in]  opt   NULL: defaults. root: NULL is the parent of the folder from which the model
 *   is named, as of a study there
 * @param[out] out   the model, owned by the caller; NULL on failure, and where it is not found
 * Fails: MT_E_SYSTEM (what may be it cannot be read), MT_E_USAGE (opt), MT_E_MEMORY.
 */
MT_API mt_status mt_result_model(const mt_result *result, const char *path,
                                 const mt_read_options *opt, mt_model **out, mt_err *err);
/**
 * What people should see of it, as one HTML page: nothing is loaded from elsewhere, and no
 * text of a file becomes markup or a script.
 * @param[out] text  UTF-8, NUL-terminated, to be given to mt_string_delete; NULL on failure
 * Fails: MT_E_MEMORY.
 */
MT_API mt_status mt_result_html(const mt_result *result, char **text, mt_err *err);
/**
 * The same with the mechanism and its modes to look at, as `modetune report` has it.
 * @param[in]  model  the one that was solved; NULL: without. Of one that does not fit nothing
 *   is shown
 * @param[out] text   as of mt_result_html
 * Fails: MT_E_MEMORY.
 */
MT_API mt_status mt_result_page(const mt_result *result, const mt_model *model, char **text,
                                mt_err *err);
/* Accepts NULL. */
MT_API void mt_string_delete(char *text);

/**
 * A question as text in, its answer as text out: mt_study_read, mt_study_solve, mt_result_json.
 * @param[in]  study  a study file's text, NUL-terminated. It is called "study.json", in the
 *   present folder: files that it names are given by `read` or found from there
 * @param[in]  read   NULL: defaults
 * @param[in]  solve  NULL: defaults
 * @param[out] result as mt_result_json gives it, to be given to mt_string_delete; NULL on
 *   failure Fails: as these three.
 */
MT_API mt_status mt_solve_json(const char *study, const mt_read_options *read,
                               const mt_solve_options *solve, char **result, mt_err *err);

#ifdef __cplusplus
}
#endif

#endif
