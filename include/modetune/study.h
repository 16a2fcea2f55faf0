/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A study: variables, goals and an objective for a model, read from a file and solved.
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
 * The search uses BLAS, which must use one thread: otherwise the bits of results may differ
 * from run to run. GSL's error handler, which belongs to the whole process, is neither set nor
 * called.
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

/* The outcome of a search. Unmet goals are an outcome, not a failure. */
#define MT_RESULT_STATUS_LIST(X)                                                 \
    X(MT_RESULT_SOLVED, "solved")                                                \
    X(MT_RESULT_COMPROMISE, "compromise")                                        \
    X(MT_RESULT_INFEASIBLE, "infeasible")                                        \
    X(MT_RESULT_FITTED, "fitted") /* all goals are weighted: the least misfit */ \
    X(MT_RESULT_INTERRUPTED, "interrupted")                                      \
    X(MT_RESULT_TIME_LIMIT, "time_limit")
#define MT_RESULT_STATUS_ENUM(id, name) id,
typedef enum mt_result_status {
    MT_RESULT_STATUS_LIST(MT_RESULT_STATUS_ENUM) MT_RESULT_STATUS_COUNT
} mt_result_status;
#undef MT_RESULT_STATUS_ENUM

typedef struct mt_solve_options {
    size_t size; /* sizeof(mt_solve_options), see modetune/read.h */
    /* worker threads, fewer than 1 count as 1, at most 64 are used; the result does not depend
     * on them */
    int threads;
    /* [variables of the study] an additional start of the search, finite, moved into its
     * bounds. NULL: none */
    const double *hint;
    /* NULL, or called by all workers, also at the same time, before every small piece of work;
     * returns an mt_stop_request. A request need not be repeated */
    int (*stop)(void *context);
    void *stop_context;
    /* NULL, or called from the caller's thread with one line of text, at the beginning of a
     * search and occasionally during it */
    void (*progress)(void *context, const char *text);
    void *progress_context;
    /* NULL, or called with stop_context when an answer was cut; returns an mt_stop_reason */
    int (*cause)(void *context);
} mt_solve_options;

/**
 * Read a study file (format "modetune-study/1") and the models and catalogues that it names,
 * each relative to the folder of the file that names it.
 * @param[in]  path  regular file of at most 16 MiB, or one that opt gives by its text
 * @param[in]  opt   NULL: defaults
 * @param[out] out   the study, owned by the caller; NULL on failure
 * Fails: MT_E_INPUT (err gives the first problem with file, line, column and JSON pointer, and
 * the number of others; opt->diagnostics lists all), MT_E_SYSTEM, MT_E_USAGE (opt),
 * MT_E_MEMORY.
 */
MT_API mt_status mt_study_read(const char *path, const mt_read_options *opt, mt_study **out,
                               mt_err *err);
/* Accepts NULL. */
MT_API void mt_study_delete(mt_study *study);

/* Name of the study, or of its file where it has none; lives as long as the study, like all
 * names here. */
MT_API const char *mt_study_title(const mt_study *study);
/* The study's model, owned by the study. */
MT_API const mt_model *mt_study_model(const mt_study *study);
/* Number of variables; of each, from 0, its parameter (NULL beyond the last), its value in the
 * model and its bounds, of a catalogue the least and greatest value (NaN beyond the last), in
 * its unit. */
MT_API int mt_study_variable_count(const mt_study *study);
MT_API const char *mt_study_variable_name(const mt_study *study, int variable);
MT_API double mt_study_variable_original(const mt_study *study, int variable);
MT_API double mt_study_variable_lower(const mt_study *study, int variable);
MT_API double mt_study_variable_upper(const mt_study *study, int variable);

/* A `stop` function for a stop_context that points to an int, an mt_stop_request that any
 * thread or signal handler may set at any time. For callers without a (fast) C function of
 * their own, as `stop` is called often. NULL: MT_STOP_REQUEST_NONE. */
MT_API int mt_stop_request_at(void *request);

/**
 * Solve a study: describe the original design, search for better ones, analyse each
 * recommendation again at its design, and compare published values.
 * @param[in]  opt  NULL: defaults
 * @param[out] out the result, owned by the caller, valid without the study; NULL on failure
 * Deterministic: the same study, binary and machine give the same result. The study is not
 * changed and may be shared by threads. Fails: MT_E_INPUT (problems visible in numbers only: a
 * mode that does not exist at the original design, ...), numerical failures at the original
 * design, MT_E_USAGE (a hint that is not finite), MT_E_INTERRUPTED (stopped before the original
 * design was analysed), MT_E_MEMORY. A solve stopped later gives a result of status interrupted
 * that lists its incomplete parts; the rest is valid.
 */
MT_API mt_status mt_study_solve(const mt_study *study, const mt_solve_options *opt,
                                mt_result **out, mt_err *err);

/* Accepts NULL. */
MT_API void mt_result_delete(mt_result *result);
/* The status of a result; MT_RESULT_STATUS_COUNT where there is no result. */
MT_API mt_result_status mt_result_outcome(const mt_result *result);
/* "solved" ...; "unknown" for an invalid status; never NULL. */
MT_API const char *mt_result_status_name(mt_result_status status);
/* One sentence about the outcome; lives as long as the result, like all texts below. */
MT_API const char *mt_result_summary(const mt_result *result);
/* Number of recommended designs, best first: ranks 1 to this number. */
MT_API int mt_result_recommendations(const mt_result *result);

/*
 * Values of the design of this rank (0: the original design). Ranks that do not exist have no
 * values (NaN) and no reasons (0, NULL).
 */
/* 1: the design meets all goals, 0: it does not. */
MT_API int mt_result_feasible(const mt_result *result, int rank);
/* Value of a variable of the study; NaN where there is no variable of this name. */
MT_API double mt_result_value(const mt_result *result, int rank, const char *parameter);
/* Frequency of a vibration mode (from 1) of a configuration that a goal names [Hz]; NaN where
 * it is not listed. */
MT_API double mt_result_hz(const mt_result *result, int rank, const char *configuration,
                           int mode);
/* Number of sentences that explain the design, and sentence i, from 0. */
MT_API int mt_result_reasons(const mt_result *result, int rank);
MT_API const char *mt_result_reason(const mt_result *result, int rank, int i);

/**
 * The whole result as a JSON text (format "modetune-result/1").
 * @param[out] text  NUL-terminated, to be given to mt_string_delete; NULL on failure
 * Fails: MT_E_MEMORY.
 */
MT_API mt_status mt_result_json(const mt_result *result, char **text, mt_err *err);
/**
 * Read a result written by mt_result_json, or as result.json by the program. It is complete:
 * all functions return for it what they returned when it was solved.
 * @param[in]  path regular file, or one that opt gives by its text. A file result.json on the
 *   disk must match the files that were written with it
 * @param[in]  opt NULL: defaults; root, sets and seed are ignored
 * @param[out] out   the result, owned by the caller; NULL on failure
 * Fails: MT_E_INPUT (as mt_study_read), MT_E_SYSTEM, MT_E_USAGE (opt), MT_E_MEMORY.
 */
MT_API mt_status mt_result_read(const char *path, const mt_read_options *opt, mt_result **out,
                                mt_err *err);
/**
 * The unchanged model that a result was solved from. It is searched for from the place of the
 * study that timing.json next to the result names, the result's folder and the two above it,
 * the current folder, and folders "studies" in these.
 * @param[in]  path path of the result, as given to mt_result_read
 * @param[in]  opt   NULL: defaults. root: NULL is the parent of the folder from which the model
 *   is named, as of a study there
 * @param[out] out   the model, owned by the caller; NULL on failure, and where it is not found
 * Fails: MT_E_SYSTEM (a candidate cannot be read), MT_E_USAGE (opt), MT_E_MEMORY.
 */
MT_API mt_status mt_result_model(const mt_result *result, const char *path,
                                 const mt_read_options *opt, mt_model **out, mt_err *err);
/**
 * The result as one HTML page: it loads nothing, and no text of a file becomes markup or a
 * script.
 * @param[out] text  UTF-8, NUL-terminated, to be given to mt_string_delete; NULL on failure
 * Fails: MT_E_MEMORY.
 */
MT_API mt_status mt_result_html(const mt_result *result, char **text, mt_err *err);
/**
 * The page of mt_result_html with drawings of the mechanism and its modes, as of `modetune
 * report`.
 * @param[in]  model the one that was solved; NULL: no drawings. A model that does not fit is
 *   not shown
 * @param[out] text   as of mt_result_html
 * Fails: MT_E_MEMORY.
 */
MT_API mt_status mt_result_page(const mt_result *result, const mt_model *model, char **text,
                                mt_err *err);
/* Accepts NULL. */
MT_API void mt_string_delete(char *text);

/**
 * Solve a study given as text and return the result as text: mt_study_read, mt_study_solve,
 * mt_result_json.
 * @param[in]  study a study file's text, NUL-terminated. It is named "study.json" in the
 *   current folder: files that it names are given by `read` or found from there
 * @param[in]  read   NULL: defaults
 * @param[in]  solve  NULL: defaults
 * @param[out] result as of mt_result_json, to be given to mt_string_delete; NULL on failure
 * Fails: as these three.
 */
MT_API mt_status mt_solve_json(const char *study, const mt_read_options *read,
                               const mt_solve_options *solve, char **result, mt_err *err);

#ifdef __cplusplus
}
#endif

#endif
