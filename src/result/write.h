/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESULT_WRITE_H
#define RESULT_WRITE_H

#include "base/diagnostics.h"
#include "base/text.h"
#include "io/write_json.h"
#include "result/result.h"

/* Append a result as JSON (format "modetune-result/1"): the same result gives the same bytes.
 * Fails: MT_E_MEMORY. */
mt_status mt_result_write(const mt_result *result, mt_text *out, mt_err *err);
/* The same as embedded in a page, without the list of files written with it. Of a grid with
 * more than MT_TRADE_WHOLE points trade.points are those that are selected, and `grid` has the
 * numbers of all points in columns: at, the places of those that are whole; values, of what
 * varies, and the names of all statuses; has_design, feasible, pareto as 0 or 1; score, change,
 * misfit, clearance_percent, objectives, parameters of their best designs, none where no point
 * has one. */
mt_status mt_result_write_page(const mt_result *result, mt_text *out, mt_err *err);
/* What mt_result_write appends, in less time. page: what mt_result_write_page has written of
 * the same result, before or after the files written with it were noted; empty: nothing. */
mt_status mt_result_write_after_page(const mt_result *result, const mt_text *page, mt_text *out,
                                     mt_err *err);
/* Write the result as a value within a larger document (name NULL: in a list, or the whole). */
void mt_result_put(mt_json_writer *w, const char *name, const mt_result *result);
/* Write all members of a record, of which none is by variables, into an open object. */
void mt_record_put(mt_json_writer *w, const mt_record *record, const void *item);
/* Write a whole struct as an object. of [n]: names of its numbers by variable. */
void mt_record_put_object(mt_json_writer *w, const char *name, const mt_record *record,
                          const void *item, int n, const char *const *of);
/* Write the warnings of one level as a list of objects. */
void mt_json_put_warnings(mt_json_writer *w, const char *name, const mt_warning_list *list,
                          mt_warning_level level);
/* mt_result_put_member writes one member of the result into an open object; name NULL: all of
 * them. mt_design_put_member: the same for a design of the result. */
void mt_result_put_member(mt_json_writer *w, const char *name, const mt_result *result);
void mt_design_put_member(mt_json_writer *w, const char *name, const mt_result *result,
                          const mt_recommendation *design);

#endif
