/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESULT_DIFF_H
#define RESULT_DIFF_H

#include "base/arena.h"
#include "base/diagnostics.h"
#include "io/json.h"

/*
 * The differences of two results, member by member of their JSON: results of other versions of
 * the program, with fewer or more members, can be compared, too. Items of lists are matched by
 * their identity (a parameter by its name, a frequency by its configuration and mode), not by
 * their positions; an item in one result only gives one difference. Not compared are sentences
 * (they repeat the members), measures of rounding (residuals) and the digests of the other
 * files of a result.
 */
typedef struct mt_reported {
    mt_json_type type; /* 0: missing */
    double number;     /* value of a number; 1 for true */
    const char *text;  /* of a string */
} mt_reported;

typedef struct mt_difference {
    const char *part;   /* "recommendation 1", "answer", "made by" */
    const char *what;   /* the item: "frequency upright mode 1"; "" for the part itself */
    const char *member; /* as in the result: "recommended_hz"; "" for a missing item */
    const char *unit;   /* NULL: none */
    mt_reported told[2];
    const char *pointer[2]; /* NULL: missing */
    bool provenance; /* of study, model or run: the origin of the answer, not a part of it */
    bool derived;    /* derived from others in the same part (an error, a change, a slope) */
} mt_difference;

typedef struct mt_result_diff {
    mt_json *doc[2]; /* owned; holds the texts of `told` */
    mt_arena mem;
    mt_difference *items;
    int n;
    int capacity;
    int of_answer; /* number of those that are not provenance */
} mt_result_diff;

/* Allowed differences of numbers; 0: none. */
typedef struct mt_diff_tolerance {
    double relative;
    double absolute; /* in the numbers of the results, of any size */
} mt_diff_tolerance;

/**
 * Compare the results at two paths. Numbers are equal where they differ by at most the relative
 * tolerance times the largest number of their unit in their object (percentages, shares and
 * MAC: times the whole), or by at most the absolute one. out is zeroed by the caller before and
 * needs mt_result_diff_free in any case. O(n log n) values. Fails: MT_E_INPUT (messages as for
 * mt_model_load), MT_E_SYSTEM, MT_E_MEMORY.
 */
mt_status mt_result_diff_find(const char *const paths[2], mt_diff_tolerance tol,
                              const char *root, mt_result_diff *out, mt_diagnostics *messages,
                              mt_err *err);
void mt_result_diff_free(mt_result_diff *diff);

#endif
