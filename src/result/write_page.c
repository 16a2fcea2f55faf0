/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A result as its page holds it: of a large grid a table of numbers. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "result/write.h"

/* As many as a chart or its table shows. */
enum { DIGITS = 7 };

/* A number of each point's best design; NaN: it has none. */
typedef double (*column)(const mt_recommendation *best, int i);

static double score_of(const mt_recommendation *best, int i)
{
    (void)i;
    return best->score;
}

static double change_of(const mt_recommendation *best, int i)
{
    (void)i;
    return best->change;
}

static double misfit_of(const mt_recommendation *best, int i)
{
    (void)i;
    return best->misfit;
}

static double clearance_of(const mt_recommendation *best, int i)
{
    (void)i;
    return best->clearance_percent;
}

static double objective_of(const mt_recommendation *best, int i)
{
    return i < best->n_objectives ? best->objectives[i].recommended : nan("");
}

static double parameter_of(const mt_recommendation *best, int i)
{
    return i < best->n_parameters ? best->parameters[i].recommended : nan("");
}

static void put_column(mt_json_writer *w, const char *name, const mt_trade_result *trade,
                       column of, int i)
{
    bool any = false;
    for (int k = 0; k < trade->n_points && !any; k++) {
        any = !isnan(of(&trade->points[k].best, i));
    }
    mt_json_open_flat(w, name, '[');
    for (int k = 0; k < trade->n_points && any; k++) {
        mt_json_put_rounded(w, NULL, of(&trade->points[k].best, i), DIGITS);
    }
    mt_json_close(w);
}

static void put_columns(mt_json_writer *w, const char *name, const mt_trade_result *trade,
                        column of, int n)
{
    mt_json_open(w, name, '[');
    for (int i = 0; i < n; i++) {
        put_column(w, NULL, trade, of, i);
    }
    mt_json_close(w);
}

static void put_places(mt_json_writer *w, const mt_trade_result *trade)
{
    mt_trade_selection s = mt_trade_select(trade);
    mt_json_open_flat(w, "at", '[');
    for (int k = 0; k < trade->n_points; k++) {
        if (mt_trade_is_selected(&s, k)) {
            mt_json_put_integer(w, NULL, k);
        }
    }
    mt_json_close(w);
}

/* Write the varied values of all points, which identify them. */
static void put_values(mt_json_writer *w, const mt_trade_result *trade)
{
    mt_json_open(w, "values", '[');
    for (int i = 0; i < trade->n_vary; i++) {
        mt_json_open_flat(w, NULL, '[');
        for (int k = 0; k < trade->n_points; k++) {
            mt_json_put_number(w, NULL, trade->points[k].values[i]);
        }
        mt_json_close(w);
    }
    mt_json_close(w);
}

static void put_statuses(mt_json_writer *w, const mt_trade_result *trade)
{
    mt_json_open_flat(w, "statuses", '[');
    for (int i = 0; i < MT_RESULT_STATUS_COUNT; i++) {
        mt_json_put_string(w, NULL, mt_result_status_name((mt_result_status)i));
    }
    mt_json_close(w);
    mt_json_open_flat(w, "status", '[');
    for (int k = 0; k < trade->n_points; k++) {
        mt_json_put_integer(w, NULL, (int)trade->points[k].status);
    }
    mt_json_close(w);
    static const char *const flags[] = {"has_design", "feasible", "pareto"};
    for (int f = 0; f < MT_COUNT(flags); f++) {
        mt_json_open_flat(w, flags[f], '[');
        for (int k = 0; k < trade->n_points; k++) {
            const mt_trade_point *const p = &trade->points[k];
            const bool is[] = {p->best.n_parameters > 0, p->best.feasible, p->pareto};
            mt_json_put_integer(w, NULL, is[f] ? 1 : 0);
        }
        mt_json_close(w);
    }
}

static void put_grid(mt_json_writer *w, const mt_result *result)
{
    const mt_trade_result *const trade = result->trade;
    int objectives = 0;
    for (int k = 0; k < trade->n_points; k++) {
        const int n = trade->points[k].best.n_objectives;
        objectives = n > objectives ? n : objectives;
    }
    mt_json_open(w, "grid", '{');
    put_places(w, trade);
    put_values(w, trade);
    put_statuses(w, trade);
    put_column(w, "score", trade, score_of, 0);
    put_column(w, "change", trade, change_of, 0);
    put_column(w, "misfit", trade, misfit_of, 0);
    put_column(w, "clearance_percent", trade, clearance_of, 0);
    put_columns(w, "objectives", trade, objective_of, objectives);
    put_columns(w, "parameters", trade, parameter_of, result->n_variables);
    mt_json_close(w);
}

/* result without outputs, and with these points. */
static mt_status write(const mt_result *result, mt_trade_point *whole, mt_text *out,
                       mt_err *err)
{
    mt_result alone = *result;
    alone.run.n_outputs = 0;
    if (whole == NULL) {
        return mt_result_write(&alone, out, err);
    }
    mt_trade_result few = *result->trade;
    mt_trade_selection s = mt_trade_select(result->trade);
    few.points = whole;
    few.n_points = 0;
    for (int k = 0; k < result->trade->n_points; k++) {
        if (mt_trade_is_selected(&s, k)) {
            whole[few.n_points++] = result->trade->points[k];
        }
    }
    alone.trade = &few;
    mt_json_writer w = mt_json_writer_default(out);
    mt_json_open(&w, NULL, '{');
    mt_result_put_member(&w, NULL, &alone);
    put_grid(&w, result);
    mt_json_close(&w);
    return mt_json_done(&w) ? MT_OK : mt_fail_memory(err);
}

/* True where a page has all points, and differs from the result in its member `run` alone. */
static bool is_whole(const mt_result *result)
{
    return result->trade == NULL || result->trade->n_points <= MT_TRADE_WHOLE;
}

/* The lines of the member `run`, from the line feed before it to that before what follows it.
 * No text holds a line feed, so that indentation tells a member of the whole from others.
 * Returns their length; 0: there are none. */
static size_t find_run(const char *json, const char **start)
{
    static const char BEGIN[] = "\n  \"run\": {";
    static const char END[] = "\n  }";
    *start = strstr(json, BEGIN);
    const char *const end = *start == NULL ? NULL : strstr(*start + 1, END);
    return end == NULL ? 0 : (size_t)(end - *start) + sizeof END - 1;
}

mt_status mt_result_write_after_page(const mt_result *result, const mt_text *page, mt_text *out,
                                     mt_err *err)
{
    mt_text own = {.s = NULL};
    mt_json_writer w = mt_json_writer_default(&own);
    const char *from = NULL;
    const char *run = NULL;
    const size_t old = is_whole(result) && page->s != NULL ? find_run(page->s, &from) : 0;
    if (old == 0) {
        return mt_result_write(result, out, err);
    }
    mt_json_open(&w, NULL, '{');
    mt_result_put_member(&w, "run", result);
    mt_json_close(&w);
    const size_t new = mt_json_done(&w) ? find_run(own.s, &run) : 0;
    if (new > 0) {
        const size_t before = (size_t)(from - page->s);
        mt_text_reserve(out, page->length - old + new);
        mt_text_add_n(out, page->s, before);
        mt_text_add_n(out, run, new);
        mt_text_add_n(out, from + old, page->length - before - old);
    }
    mt_text_free(&own);
    return new > 0 && !out->failed ? MT_OK : mt_fail_memory(err);
}

mt_status mt_result_write_page(const mt_result *result, mt_text *out, mt_err *err)
{
    if (is_whole(result)) {
        return write(result, NULL, out, err);
    }
    mt_trade_point *const whole = calloc(MT_TRADE_WHOLE, sizeof *whole);
    if (whole == NULL) {
        return mt_fail_memory(err);
    }
    const mt_status rc = write(result, whole, out, err);
    free(whole);
    return rc;
}
