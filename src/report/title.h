/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_TITLE_H
#define REPORT_TITLE_H

#include "base/text.h"
#include "result/result.h"

/* The title block of a page: study, author, revision, date, model with its digest, the study's
 * question and the model's assumptions. out->failed remembers a shortage of memory. */
void mt_report_title(const mt_result *result, mt_text *out);

#endif
