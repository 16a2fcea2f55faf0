/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_SUMMARY_H
#define REPORT_SUMMARY_H

#include "base/text.h"
#include "result/result.h"

/*
 * What a result says, section by section in one order, as text for a terminal or as the body
 * of a page. A section that has nothing to tell is left out, one that an interrupt cut says so.
 * Memory running out shows in out->failed.
 */
typedef struct mt_summary_writer {
    mt_text *out;
    bool html; /* a page: with bands */
    int width; /* that tables of text fold to; 0: as wide as they are */
} mt_summary_writer;

/* Name of the study, status, all sections; published against computed where asked for;
 * width as in mt_summary_writer. */
void mt_report_summary(const mt_result *result, bool with_published, int width, mt_text *out);

/* The same as the body of a page that a script draws figures into: what is said first, tables
 * last, each recommendation in parts of its own. */
void mt_write_page(mt_text *out, const mt_result *result);
/* Of them: doubts with their places, then facts. */
void mt_tell_warnings(const mt_summary_writer *to, const mt_result *result);
/* The objectives of a design with their values. */
void mt_write_objectives(const mt_summary_writer *to, const mt_recommendation *r);
/* "147 evaluations (search 120, descriptions 27), 2.1e+06 multiplications of proofs": what the
 * answer cost. */
void mt_report_work_counters(const mt_result_run *run, mt_text *out);
/* What was asked for instead of what the files say, in one line; nothing where nothing was. */
void mt_write_overrides(const mt_summary_writer *to, const mt_result_run *run);
/* What the goals leave open: undetermined directions and the spread under other weights. */
void mt_write_uncertainty(const mt_summary_writer *to, const mt_result *result);

/* A doubt in one line without its end: "stick.json:12:9: /goals/0: installed: ..." */
void mt_report_warning(const mt_warning *d, bool with_place, mt_text *out);

#endif
