/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_DEDUPE_JSON_H
#define REPORT_DEDUPE_JSON_H

#include "base/text.h"

/*
 * JSON in which what is said again and again stands once: [keys, shared, value], where in value
 * and in shared
 *     {"#": i}            is shared[i],
 *     {"~": [k, a, ...]}  is the object with the names keys[k] and the values a, ...
 * (src/report/page/base.js reads it). Nothing is rounded. What is packed depends on the form of
 * the document alone, not on what its texts say. json: valid, without white space between its
 * tokens, no deeper than a reader allows. One with a member "#" or "~" stays as it is, in
 * [[], [], value]. Memory running out shows in out->failed.
 */
void mt_dedupe_json(const char *json, mt_text *out);

#endif
