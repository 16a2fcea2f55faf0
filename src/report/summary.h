/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_SUMMARY_H
#define REPORT_SUMMARY_H

#include "base/text.h"
#include "result/result.h"

/*
 * The summary of a result, section by section in a fixed order, as text for a terminal or as
 * the body of a page. Empty sections are left out; a section that an interrupt cut says so.
 * out->failed remembers a shortage of memory.
 */
typedef struct mt_summary_writer {
    mt_text *out;
    bool html; /* a page, with figures of bands */
    int width; /* width to which text tables fold; 0: unlimited */
} mt_summary_writer;

/* Name of the study, status and all sections; published values compared where requested; width
 * as in mt_summary_writer. */
void mt_report_summary(const mt_result *result, bool with_published, int width, mt_text *out);

/* The summary as the body of a page in which a script draws figures: the main sections first,
 * tables last, each recommendation in its own parts. */
void mt_write_page(mt_text *out, const mt_result *result);
/* The section of warnings with their places, then notes. */
void mt_tell_warnings(const mt_summary_writer *to, const mt_result *result);
/* The objectives of a design with their values. */
void mt_write_objectives(const mt_summary_writer *to, const mt_recommendation *r);
/* The work done: "147 evaluations (search 120, descriptions 27), 2.1e+06 multiplications of
 * proofs". */
void mt_report_work_counters(const mt_result_run *run, mt_text *out);
/* The overrides of numbers of the files, in one line; no text without overrides. */
void mt_write_overrides(const mt_summary_writer *to, const mt_result_run *run);
/* The uncertainty left by the goals: directions that are not identifiable, and the sensitivity
 * to the weights. */
void mt_write_uncertainty(const mt_summary_writer *to, const mt_result *result);

/* A warning in one line without its end: "stick.json:12:9: /goals/0: installed: ..." */
void mt_report_warning(const mt_warning *d, bool with_place, mt_text *out);

/* The abstract of a page: the status, then in a few lines the changes of the best design, how
 * it meets the goals, what is proven, and alternatives. out->failed remembers a shortage of
 * memory. */
void mt_report_abstract(const mt_result *result, mt_text *out);

#endif
