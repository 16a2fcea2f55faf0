/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_SYNONYMS_H
#define IO_SYNONYMS_H

/* What engineers and other programs call it: the first of n names that `word` ("Hinge",
 * "ball-and-socket", "centre of mass", "k") stands for, in capital letters or small ones, with
 * blanks, - or _; NULL: none. */
const char *mt_synonym(const char *word, const char *const *names, int n);

#endif
