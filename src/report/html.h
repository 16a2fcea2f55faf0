/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_HTML_H
#define REPORT_HTML_H

#include "base/text.h"
#include "result/result.h"

/* A result as one self-contained HTML page: sentences and tables, and figures that its script
 * draws from `json`, the same result as in a file, and from `scene`, its mechanism (NULL:
 * none). out->failed remembers a shortage of memory. */
void mt_report_html(const mt_result *result, const char *json, const char *scene, mt_text *out);
/* The part without script and data: sentences and tables, and the places of the figures. */
void mt_report_html_told(const mt_result *result, mt_text *out);

#endif
