/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DESCRIBE_CERTIFICATES_H
#define DESCRIBE_CERTIFICATES_H

#include "search/mode_placements.h"

/* Add a certificate; text is in result->mem, NULL where memory is out. */
mt_status mt_describe_certificate(mt_result *result, const char *kind, bool proven,
                                  const char *text, mt_err *err);
/* Add what is proven about mode placements. *infeasible: it is proven that no design exists. */
mt_status mt_describe_placement_certificate(const mt_mode_placement_result *placements,
                                            mt_result *result, bool *infeasible, mt_err *err);
/* True where the search ended before all placements that may have a design were searched; the
 * remaining ones need too large a change. */
bool mt_describe_placements_unsearched(const mt_mode_placement_result *placements);
/* The knowledge about the placements without a solution, as text in brackets; NULL: no
 * memory. */
const char *mt_describe_placements_left(const mt_mode_placement_result *placements,
                                        mt_arena *mem);
/* Add the reachable range of each limit, after a search without bands that did not meet all
 * goals. boxes: of the search's own proof that no design meets all of them; 0: there is none.
 * *infeasible: it is proven that no design exists. Of a point of a trade study, whose
 * certificates are not told, only that, and without a further proof where boxes > 0. */
mt_status mt_describe_limit_certificates(const mt_problem *p, long boxes, mt_arena *mem,
                                         mt_result *result, bool *infeasible, mt_err *err);

#endif
