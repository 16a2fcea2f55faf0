/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_CAMPBELL_H
#define REPORT_CAMPBELL_H

#include "base/text.h"
#include "result/result.h"

/* A Campbell diagram with its heading for each rotor and machine that the study avoids. */
void mt_report_svg_campbell(const mt_result *result, mt_text *out);

#endif
