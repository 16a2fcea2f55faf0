/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DESCRIBE_CERTIFICATES_H
#define DESCRIBE_CERTIFICATES_H

#include "search/mode_placements.h"

/* One more certificate; text is in result->mem, NULL where memory is out. */
mt_status mt_describe_certificate(mt_result *result, const char *kind, bool proven,
                                  const char *text, mt_err *err);
/* What the answer may claim as proven. infeasible: it is a proof that no design exists. */
mt_status mt_describe_placement_certificate(const mt_mode_placement_result *placements,
                                            mt_result *result, bool *infeasible, mt_err *err);
/* The search ended before all assignments that may have a design were searched: those that are
 * left change too much. */
bool mt_describe_placements_unsearched(const mt_mode_placement_result *placements);
/* What is known of the assignments that no solution has, to stand in brackets; NULL: no
 * memory. */
const char *mt_describe_placements_left(const mt_mode_placement_result *placements,
                                        mt_arena *mem);
/* After a search without bands that met no goal fully: what each limit can reach, and whether
 * that is a proof. boxes: of the search's own proof that all of them together have no design;
 * 0: it has none. */
mt_status mt_describe_limit_certificates(const mt_problem *p, long boxes, mt_arena *mem,
                                         mt_result *result, bool *infeasible, mt_err *err);

#endif
