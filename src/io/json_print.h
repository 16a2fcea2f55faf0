/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_JSON_PRINT_H
#define IO_JSON_PRINT_H

#include "io/json.h"

/* Addresses to places and JSON pointers, diagnostics to text. */

/* Where an address stands. */
void mt_json_place(const mt_json *doc, mt_addr addr, int *line, int *column);
/* The same for n addresses of values in ascending order, in one walk through the text. */
void mt_json_places(const mt_json *doc, int n, const mt_addr *addrs, int *lines, int *columns);
/* Append the JSON pointer of an address (RFC 6901: ~ is ~0, / is ~1; the root's is empty). */
void mt_json_pointer(const mt_json *doc, mt_addr addr, mt_text *out);
/**
 * Append all diagnostics as text, sorted by place (those of one place as found), one per line:
 *     file:line:column: error: /json/pointer: message
 * without "/json/pointer: " for the root and without ":line:column" for MT_NO_ADDR. Control
 * characters are made visible, lines are cut at a length. Beyond MT_DIAG_LIMIT a last line says
 * how many more there are.
 */
void mt_json_print(const mt_json *doc, const char *file, mt_text *out);
/* MT_E_MEMORY, MT_E_INPUT where there are errors, or MT_OK. err: the first error as it is
 * printed, and how many more there are. */
mt_status mt_json_status(const mt_json *doc, const char *file, mt_err *err);

#endif
