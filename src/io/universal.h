/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_UNIVERSAL_H
#define IO_UNIVERSAL_H

#include <stdbool.h>
#include <stddef.h>

#include "base/text.h"

/* The text begins as a universal file, with a line "-1" and the number of a dataset. */
bool mt_universal_begins(const char *text, size_t length);
/* What it holds, appended: "5 mode shapes (dataset 55), 12 nodes (dataset 15); no frequency
 * response". A line may end with NUL, as whoever reads records leaves them; O(length). */
void mt_universal_contents(const char *text, size_t length, mt_text *out);

#endif
