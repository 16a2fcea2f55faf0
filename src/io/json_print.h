/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_JSON_PRINT_H
#define IO_JSON_PRINT_H

#include "base/diagnostics.h"
#include "io/json.h"

/* Conversion of addresses to places and JSON pointers, and diagnostics with these. */

/* The line and column of an address. */
void mt_json_locate(const mt_json *doc, mt_addr addr, int *line, int *column);
/* The same for n addresses of values in ascending order, in one walk through the text. */
void mt_json_locates(const mt_json *doc, int n, const mt_addr *addrs, int *lines, int *columns);
/* The value that a JSON pointer of so many bytes leads to; MT_NO_ADDR where there is none. */
mt_addr mt_json_find(const mt_json *doc, const char *pointer, size_t length);
/* Append the JSON pointer of an address (RFC 6901: ~ is ~0, / is ~1; the root's is empty). */
void mt_json_pointer(const mt_json *doc, mt_addr addr, mt_text *out);
/* Add all diagnostics with their places, sorted by place (those of one place in the order
 * found), and the number of those beyond MT_DIAG_LIMIT. */
void mt_json_report(const mt_json *doc, const char *file, mt_diagnostics *out);
/* MT_E_MEMORY, MT_E_INPUT where there are errors, or MT_OK. err: the first error as printed,
 * and the number of others. */
mt_status mt_json_status(const mt_json *doc, const char *file, mt_err *err);

#endif
