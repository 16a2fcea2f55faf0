/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_HTML_H
#define REPORT_HTML_H

#include "base/text.h"
#include "result/result.h"

/* A page up to its heading, and its end. */
void mt_html_begin(const char *title, mt_text *out);
void mt_html_end(mt_text *out);

/* What a result says as one self-contained HTML page (no scripts, nothing loaded from
 * elsewhere, figures as inline SVG), light and printable. Memory running out shows in
 * out->failed. */
void mt_report_html(const mt_result *result, mt_text *out);

#endif
