/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef STUDY_READER_H
#define STUDY_READER_H

#include "io/members.h"
#include "io/options.h"
#include "model/read.h"
#include "study/study.h"

/* A model file that the study names. */
typedef struct mt_study_file {
    mt_name path;          /* as written */
    const mt_model *model; /* NULL: it could not be read, which has been noted */
} mt_study_file;

/* The state of reading a study. */
typedef struct mt_study_reader {
    mt_reader r;
    mt_study *study;
    mt_io_options files;            /* for the models; root is set */
    mt_diagnostics *model_messages; /* diagnostics of the model files */
    /* MT_OK, or the failure of reading a model; reading goes on only after MT_E_INPUT */
    mt_status failed;
    mt_err why; /* the first such failure */
    MT_LIST_OF(mt_study_file, read);
} mt_study_reader;

/* The reader of a study that this is the first part of. */
mt_study_reader *mt_study_reader_of(mt_reader *r);

/* Rows of tables (io/members.h). */
/* NOLINTBEGIN(bugprone-macro-parentheses): types are not put into parentheses */
/* double, at the original design */
#define MT_S_NUMBER(label, must, m, row, ...)                                      \
    {                                                                              \
        .name = (label), .type = MT_KEY_NUMBER, .required = (must), MT_M_ROW(row), \
        MT_M_TO(mt_study_number, double, m), .says = __VA_ARGS__                   \
    }
/* double, a value of the parameter that the member `by` (mt_name) names */
#define MT_S_VALUE(label, must, m, by, row, ...)                                   \
    {                                                                              \
        .name = (label), .type = MT_KEY_NUMBER, .required = (must), MT_M_ROW(row), \
        MT_M_TO(mt_study_value, double, m), .other = MT_M_PLACE(mt_name, by),      \
        .says = __VA_ARGS__                                                        \
    }
/* two doubles, lower and upper; NaN where they are no numbers */
#define MT_S_PAIR(label, must, m, upper, row, ...)                                  \
    {                                                                               \
        .name = (label), .type = MT_KEY_NUMBERS, .required = (must), MT_M_ROW(row), \
        MT_M_TO(mt_study_pair, double, m), .other = MT_M_PLACE(double, upper),      \
        .says = __VA_ARGS__                                                         \
    }
/* mt_expr, which follows the design, and its text */
#define MT_S_EXPR(label, must, m, text, ...)                                         \
    {                                                                                \
        .name = (label), .type = MT_KEY_TEXT, .required = (must),                    \
        MT_M_TO(mt_study_expr, mt_expr, m), .other = MT_M_PLACE(const char *, text), \
        .says = __VA_ARGS__                                                          \
    }
/* int, a mode by its index from 1 */
#define MT_S_INDEX(label, m, ...)                            \
    MT_M_COUNT(label, false, m, 1, MT_MAX_LIST, __VA_ARGS__, \
               .schema = "\"allOf\": [{\"$ref\": \"#/definitions/index\"}]")
/* mt_mode_ref, a mode by its index or name; required */
#define MT_S_MODE(label, m, ...)                                                          \
    {                                                                                     \
        .name = (label), .type = MT_KEY_TEXT_OR_COUNT, .required = true, MT_M_ROW(WHOLE), \
        MT_M_TO(mt_study_mode, mt_mode_ref, m), .says = __VA_ARGS__                       \
    }
/* NOLINTEND(bugprone-macro-parentheses) */
void mt_study_number(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_study_value(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_study_pair(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_study_expr(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_study_mode(mt_reader *r, const mt_key *key, mt_addr value, void *item);

/* A number; expressions are evaluated at the original design. NaN where absent or wrong
 * (noted). Values that are impossible or implausible by the row of its member are noted. */
double mt_read_study_number(mt_study_reader *s, mt_addr value);
/* A value of a parameter of the model (of any name): a bare number is in the study's unit of
 * its kind or in the parameter's own. Returned in SI, NaN as of mt_read_study_number. */
double mt_read_study_value(mt_study_reader *s, mt_addr value, const char *parameter);
/* Note a bare limit of an expression, which is in SI, that looks like a number in another
 * unit. */
void mt_read_study_check_requirement(mt_study_reader *s, const mt_expr *of, mt_addr value);
/* Load a model that the study names, once; NULL where it cannot be read (noted). */
const mt_model *mt_read_study_model(mt_study_reader *s, mt_name path);
/* Record a file that was read, with the digest of its bytes. */
void mt_read_study_note_input(mt_study_reader *s, const char *name, const char *sha256);
/* Note a refused file at the address of `path` in the study, unless its own diagnostics report
 * it (`told`); also where `file`, the joined path, leads to nothing. A file that exists and
 * cannot be read is not a problem of the study. */
void mt_read_study_note_failure(mt_study_reader *s, mt_name path, const char *file,
                                mt_status rc, const mt_err *why, bool told);

#endif
