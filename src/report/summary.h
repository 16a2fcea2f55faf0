/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_SUMMARY_H
#define REPORT_SUMMARY_H

#include "base/text.h"
#include "result/result.h"

/* What a result says, as text for a terminal: status, goals, frequencies, parameters, reasons,
 * alternatives, what stays undetermined, certificates and, where asked for, published against
 * computed. Memory running out shows in out->failed. */
void mt_report_summary(const mt_result *result, bool with_published, mt_text *out);
/* Of it, the objectives of a design with their values; nothing where there are none. */
void mt_report_objectives_text(const mt_recommendation *r, mt_text *out);
/* Of it, what the goals leave open: undetermined directions and the spread under other weights.
 * Nothing where there is neither. */
void mt_report_uncertainty(const mt_result *result, mt_text *out);

/* Doubts with their places, then facts, each list under its title; nothing where there are
 * none. */
void mt_report_doubts(const mt_result *result, mt_text *out);
/* One of them, in one line without its end: "stick.json:12:9: /goals/0: installed: ..." */
void mt_report_doubt(const mt_doubt *d, bool with_place, mt_text *out);
/* Does a doubt stand about the question? Then nothing is called proven without saying so: the
 * word for a certificate. */
bool mt_report_doubtful(const mt_result *result);
const char *mt_report_surety(bool proven, bool doubtful);

#endif
