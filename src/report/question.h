/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_QUESTION_H
#define REPORT_QUESTION_H

#include "base/text.h"
#include "result/result.h"

/* The study as a question in one sentence: "Which values of k and m hold installed mode 1 at 18
 * Hz, with the least total change?" out->failed remembers a shortage of memory. */
void mt_report_question(const mt_result *result, mt_text *out);

#endif
