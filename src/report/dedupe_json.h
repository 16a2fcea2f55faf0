/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_DEDUPE_JSON_H
#define REPORT_DEDUPE_JSON_H

#include "base/text.h"

/*
 * Compact JSON that stores repeated parts once: [keys, shared, value], where in value and in
 * shared
 *     {"#": i}            is shared[i],
 *     {"~": [k, a, ...]}  is the object with the names keys[k] and the values a, ...
 * (src/report/page/base.js reads it). Numbers are not rounded. The packing depends on the
 * structure of the document only, not on its texts. json: valid, no deeper than a reader
 * allows; spaces and line feeds between its tokens, a third of a large result, are left out.
 * "<", which could end the element of the page that holds the document, is escaped. A document
 * with a member "#" or "~" is kept otherwise as it is, in [[], [], value]. out->failed
 * remembers a shortage of memory.
 */
void mt_dedupe_json(const char *json, mt_text *out);

#endif
