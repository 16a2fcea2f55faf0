/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_PREPARE_H
#define NLP_PREPARE_H

/* Settings of the search libraries that belong to the whole process, so that only a program
 * makes them: GSL's error handler, which ends the process by default, is switched off (every
 * status is looked at). Call before any thread starts. */
void mt_tune_prepare_process(void);

#endif
