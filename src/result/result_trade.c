/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which points of a large grid are shown whole. */
#include "result/result.h"

static bool counts(const mt_trade_selection *s, int k)
{
    const mt_trade_point *const p = &s->trade->points[k];
    return (!s->front || p->pareto) && (!s->found || p->best.n_parameters > 0);
}

static int count_points(const mt_trade_result *trade, bool front, bool found)
{
    const mt_trade_selection s = {.trade = trade, .front = front, .found = found};
    int n = 0;
    for (int k = 0; k < trade->n_points; k++) {
        n += counts(&s, k) ? 1 : 0;
    }
    return n;
}

mt_trade_selection mt_trade_select(const mt_trade_result *trade)
{
    mt_trade_selection s = {.trade = trade, .each = 1};
    if (trade->n_points <= MT_TRADE_WHOLE) {
        return s;
    }
    s.found = count_points(trade, false, true) > 0;
    s.front = count_points(trade, true, s.found) > 0;
    s.each = (count_points(trade, s.front, s.found) + MT_TRADE_WHOLE - 1) / MT_TRADE_WHOLE;
    return s;
}

bool mt_trade_is_selected(mt_trade_selection *s, int k)
{
    return counts(s, k) && s->met++ % s->each == 0;
}
