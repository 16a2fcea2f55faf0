/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_SECTION_H
#define REPORT_SECTION_H

#include "base/text.h"
#include "report/table.h"
#include "result/result.h"

/* Sections of a summary: headings, tables, lists and paragraphs, as text for a terminal or as
 * the body of a page. out->failed remembers a shortage of memory. */
typedef struct mt_summary_writer {
    mt_text *out;
    bool html; /* a page, with figures of bands */
    int width; /* width to which text tables fold; 0: unlimited */
} mt_summary_writer;

void mt_section_heading(const mt_summary_writer *to, const char *title);
/* A table below its title, freed; nothing where it has no rows. */
void mt_section_table(const mt_summary_writer *to, mt_table t, const char *title);
/* A paragraph, of which `line` is the text; freed. */
void mt_section_paragraph(const mt_summary_writer *to, const char *indent, mt_text *line);
/* The head of a list of n items; false where there are none. */
bool mt_section_open(const mt_summary_writer *to, const char *title, int n);
void mt_section_close(const mt_summary_writer *to);
/* word: before the text, in bold; "": none */
void mt_section_item(const mt_summary_writer *to, const char *word, const char *text);
/* Add an item of a text that is freed afterwards. */
void mt_section_made(const mt_summary_writer *to, mt_text *text);

/* The section of warnings with their places, then notes. */
void mt_tell_warnings(const mt_summary_writer *to, const mt_result *result);
/* The notes on the model, each once with all configurations that have it. */
void mt_write_facts(const mt_summary_writer *to, int n, const mt_warning *items);
/* A warning in one line without its end: "stick.json:12:9: /goals/0: installed: ..." */
void mt_report_warning(const mt_warning *d, bool with_place, mt_text *out);

/* The overrides of numbers of the files, in one line; no text without overrides. */
void mt_write_overrides(const mt_summary_writer *to, const mt_result_run *run);
/* The work done: "147 evaluations (search 120, descriptions 27), 2.1e+06 multiplications of
 * proofs". */
void mt_report_work_counters(const mt_result_run *run, mt_text *out);

#endif
