/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_SUMMARY_H
#define REPORT_SUMMARY_H

#include "base/text.h"
#include "tune/result.h"

/* What a result says, as text for a terminal: status, goals, frequencies, parameters, reasons, alternatives, what stays undetermined, certificates and,
 * where asked for, published against computed. Memory running out shows in out->failed. */
void mt_report_summary(const mt_result *result, bool with_published, mt_text *out);
/* Of it, what the goals leave open: undetermined directions and the spread under other weights. Nothing where there is neither. */
void mt_report_uncertainty(const mt_result *result, mt_text *out);

/* The same as one self-contained HTML page (no scripts, nothing loaded from elsewhere, figures as inline SVG), light and printable. */
void mt_report_html(const mt_result *result, mt_text *out);
/* Its figures; that of a trade study only where there is one and some point meets its goals. */
void mt_report_svg_trade(const mt_result *result, mt_text *out);
void mt_report_svg_frequencies(const mt_recommendation *r, mt_text *out);
void mt_report_svg_changes(const mt_recommendation *r, mt_text *out);

#endif
