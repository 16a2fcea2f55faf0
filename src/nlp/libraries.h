/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_LIBRARIES_H
#define NLP_LIBRARIES_H

/* Versions of the search libraries, for `run` of a result. */
/* Writes the version, such as "2.7.1". */
void mt_nlopt_version(char text[16]);
/* A static text. */
const char *mt_gsl_version(void);

#endif
