/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANSWER_EXAMINE_H
#define ANSWER_EXAMINE_H

#include "base/diagnostics.h"
#include "base/run.h"
#include "study/study.h"

/**
 * Notes and warnings about a study at its original design, before it is answered: its own
 * numbers (study->warning_list), every configuration that a goal names, targets far from the
 * original frequencies, bands that no mode comes near. File names are those in the study (no
 * folders). One analysis per configuration, and 2 n + 3 where bands are to be avoided; none,
 * and a note, where that would take more than most_work (counted by mt_warnings_work). Fails:
 * as mt_analysis_new.
 */
mt_status mt_study_examine(const mt_study *study, const mt_run *run, double most_work,
                           mt_warning_list *out, mt_err *err);
/* True where these analyses take more than most_work. */
bool mt_study_takes_more(const mt_study *study, double most_work);

#endif
