/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_UNIVERSAL_H
#define IO_UNIVERSAL_H

#include <stdbool.h>
#include <stddef.h>

#include "base/text.h"

/* True where the text begins as a universal file, with a line "-1" and the number of a
 * dataset. */
bool mt_universal_begins(const char *text, size_t length);
/* Append the contents of a universal file: "5 mode shapes (dataset 55), 12 nodes (dataset 15);
 * no frequency response". Lines may end with NUL, as readers of records leave them;
 * O(length). */
void mt_universal_contents(const char *text, size_t length, mt_text *out);

#endif
