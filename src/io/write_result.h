/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_WRITE_RESULT_H
#define IO_WRITE_RESULT_H

#include "base/text.h"
#include "base/warning.h"
#include "io/write_json.h"
#include "result/result.h"

/* Append a result as JSON (format "modetune-result/1"): the same result gives the same bytes.
 * Fails: MT_E_MEMORY. */
mt_status mt_result_write(const mt_result *result, mt_text *out, mt_err *err);
/* The same but for the files beside it, as a page holds it. Of a grid with more than
 * MT_TRADE_WHOLE points trade.points are those that are selected, and `grid` has the numbers of
 * all points in columns: at, the places of those that are whole; values, of what varies, and
 * the names of all statuses; has_design, feasible, pareto as 0 or 1; score, change, misfit,
 * clearance_percent, objectives, parameters of their best designs, none where no point has one.
 */
mt_status mt_result_write_page(const mt_result *result, mt_text *out, mt_err *err);
/* The same as a value within a larger document (name NULL: in a list, or the whole). */
void mt_result_put(mt_json_writer *w, const char *name, const mt_result *result);
/* The items of one level as a list of objects. */
void mt_json_put_warnings(mt_json_writer *w, const char *name, const mt_warning_list *list,
                          mt_warning_level level);
/* One of its members, into an object that is open; name NULL: all of them. One of a design of
 * it likewise. */
void mt_result_put_member(mt_json_writer *w, const char *name, const mt_result *result);
void mt_design_put_member(mt_json_writer *w, const char *name, const mt_result *result,
                          const mt_recommendation *design);

#endif
