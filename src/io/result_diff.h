/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_RESULT_DIFF_H
#define IO_RESULT_DIFF_H

#include "base/arena.h"
#include "base/diagnostics.h"
#include "io/json.h"

/*
 * What two results say differently, member by member of their JSON: so results of other
 * versions of the program, which lack members or have more of them, can be compared as well.
 * Items of lists are matched by what they are about (a parameter by its name, a frequency by
 * its configuration and mode), not by their places; of items that are in one result alone only
 * that is told. Not compared are sentences (they say what the members say), measures of
 * rounding (residuals) and the digests of the files beside a result.
 */
typedef struct mt_reported {
    mt_json_type type; /* 0: not there */
    double number;     /* of a number; of true 1 */
    const char *text;  /* of a string */
} mt_reported;

typedef struct mt_difference {
    const char *part;   /* "recommendation 1", "answer", "made by" */
    const char *what;   /* the item: "frequency upright mode 1"; "" of the part itself */
    const char *member; /* as in the result: "recommended_hz"; "" of an item that is missing */
    const char *unit;   /* NULL: none */
    mt_reported told[2];
    const char *pointer[2]; /* NULL: not there */
    bool provenance;        /* of study, model or run: how the answer was made, no part of it */
    bool derived; /* follows from others in the same part (an error, a change, a slope) */
} mt_difference;

typedef struct mt_result_diff {
    mt_json *doc[2]; /* owned; texts of told live here */
    mt_arena mem;
    mt_difference *items;
    int n;
    int capacity;
    int of_answer; /* how many are not of provenance */
} mt_result_diff;

/* What numbers may differ by; 0: not at all. */
typedef struct mt_diff_tolerance {
    double relative;
    double absolute; /* whatever their size, as they stand in the results */
} mt_diff_tolerance;

/**
 * Compare the results at two paths. Numbers are the same where they differ by no more than the
 * relative tolerance of the largest number of their unit in the object that they are in
 * (percentages, shares and MAC: of the whole), or by no more than the absolute one.
 * mt_result_diff_free in any case (out zeroed before). O(n log n) values. Fails: MT_E_INPUT
 * (messages as for mt_model_load), MT_E_SYSTEM, MT_E_MEMORY.
 */
mt_status mt_result_diff_find(const char *const paths[2], mt_diff_tolerance tol,
                              const char *root, mt_result_diff *out, mt_diagnostics *messages,
                              mt_err *err);
void mt_result_diff_free(mt_result_diff *diff);

#endif
