/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_SYNONYMS_H
#define IO_SYNONYMS_H

/* The first of n names that has `word` as a synonym of engineers or other programs ("Hinge",
 * "ball-and-socket", "centre of mass", "k"), in any case, with blanks, - or _; NULL: none. */
const char *mt_synonym(const char *word, const char *const *names, int n);

#endif
