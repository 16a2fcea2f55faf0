/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TUNE_SOLVE_H
#define TUNE_SOLVE_H

#include "tune/result.h"
#include "tune/study.h"

/*
 * Answering a study (solve.c): mt_study_solve and its options are public, see modetune/study.h. Baseline, search, ranked recommendations, each recomputed from scratch at its design, published
 * values judged.
 */

#endif
