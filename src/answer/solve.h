/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANSWER_SOLVE_H
#define ANSWER_SOLVE_H

#include "result/result.h"
#include "study/study.h"

/*
 * Answering a study (solve.c): mt_study_solve and its options are public, see modetune/study.h.
 * Baseline, search, ranked recommendations, each recomputed from scratch at its design,
 * published values judged.
 */

#endif
