/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_HTML_H
#define REPORT_HTML_H

#include "base/text.h"
#include "result/result.h"

/* What a result says as one self-contained HTML page: told in words and tables, and drawn by
 * its script from `json`, the same result as a file holds it, and from `scene`, its mechanism
 * (NULL: none). Memory running out shows in out->failed. */
void mt_report_html(const mt_result *result, const char *json, const char *scene, mt_text *out);
/* Of it what is told: words and tables, and the place of the figures. */
void mt_report_html_told(const mt_result *result, mt_text *out);

#endif
