/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DESCRIBE_DESCRIBE_RELAXATION_H
#define DESCRIBE_DESCRIBE_RELAXATION_H

#include "search/relaxation.h"

/* Fill result->relaxations, and add a sentence to the status where a relaxation exists. */
mt_status mt_describe_relaxations(const mt_problem *p, const mt_moves *moves, mt_result *result,
                                  mt_err *err);

#endif
