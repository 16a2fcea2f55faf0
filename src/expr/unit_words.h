/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef EXPR_UNIT_WORDS_H
#define EXPR_UNIT_WORDS_H

#include <stdbool.h>
#include <stddef.h>

/* Suggestion for a number followed by a unit, "15 deg" or "2 mm": "15*deg", "2*1e3 (m)", in
 * out[size]. n_number, n_word: lengths in bytes. False: the word is not a unit. */
bool mt_unit_meant(const char *number, size_t n_number, const char *word, size_t n_word,
                   char *out, size_t size);

#endif
