/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESULT_POINTS_H
#define RESULT_POINTS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/base.h"

/*
 * The points of a trade study as mt_result_write writes them: nearly all of a large
 * result.json, and each a JSON text of its own that can be read alone. JSON as a whole takes
 * nine times its text while it is read.
 */
typedef struct mt_result_points {
    int n;
    const char *at; /* the next one */
    char *rest;     /* the text with an empty list instead of the points; from malloc */
    size_t rest_length;
} mt_result_points;

/**
 * Find the points, by lines and their indentation: no line feed stands within a valid string.
 * If `rest` and every point are JSON, and `rest` has no list of points elsewhere, these are the
 * points of /trade/points.
 * @param[out] out  n 0 and rest NULL where the text has fewer than `least` points or is laid
 *   out otherwise; else owned by the caller (mt_result_points_free), and `text` outlives it
 * Fails: MT_E_MEMORY.
 */
mt_status mt_result_points_find(const char *text, size_t length, int least,
                                mt_result_points *out, mt_err *err);
/* The text of the next of the n points; returns its length. */
size_t mt_result_points_next(mt_result_points *p, const char **text);
void mt_result_points_free(mt_result_points *p);

#endif
