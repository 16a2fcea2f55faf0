/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which parameter moves a goal, by how much, and how much of it is left. */
#include "report/explain.h"

#include <math.h>
#include <string.h>

#include "base/number.h"
#include "report/table.h"

enum { VALUE_DIGITS = 6, SHORT_DIGITS = 3, INDENT = 2 };
static const double PERCENT = 0.01;

/* A number that variables move: a goal's value, or the frequency nearest to a band. */
typedef struct moved {
    const char *text;
    const char *unit;         /* NULL, "": none */
    const char *display_unit; /* as in mt_result_goal */
    double display_factor;
    double value; /* NaN: not known */
    const double *slopes;
} moved;

/* Change of the value for 1 % more of variable k. */
static double value_change_per_percent(const mt_recommendation *r, const moved *m, int k)
{
    return m->slopes[k] * PERCENT * fabs(r->parameters[k].recommended);
}

/* The most influential variable among those not taken yet, the first of equal ones; -1:
 * none. */
static int next_mover(const mt_recommendation *r, const moved *g, const bool *taken)
{
    int best = -1;
    for (int k = 0; k < r->n_parameters; k++) {
        const double own = fabs(value_change_per_percent(r, g, k));
        if (!taken[k] && own > 0.0 && !(own <= MT_SLOPE_NOISE * fabs(g->value)) &&
            isfinite(own) &&
            (best < 0 || mt_exceeds(own, fabs(value_change_per_percent(r, g, best))))) {
            best = k;
        }
    }
    return best;
}

/* "7.1 % down, 40 % up": how far the variable is from its bounds. */
static void add_room(const mt_result_parameter *p, mt_text *out)
{
    char number[MT_NUMBER_TEXT];
    const double size = PERCENT * fabs(p->recommended);
    if (!isfinite(p->lower) || !isfinite(p->upper) || !(size > 0.0)) {
        mt_text_add(out, "-");
        return;
    }
    mt_text_addf(
        out, "%s %% down, ",
        mt_report_number(fmax(p->recommended - p->lower, 0.0) / size, SHORT_DIGITS, number));
    mt_text_addf(
        out, "%s %% up",
        mt_report_number(fmax(p->upper - p->recommended, 0.0) / size, SHORT_DIGITS, number));
}

/* A change, displayed as by mt_table_shown. */
static void add_change(mt_table *t, double value, double factor, int digits)
{
    char text[MT_NUMBER_TEXT];
    char exact[MT_NUMBER_TEXT];
    mt_table_cell(t, mt_report_change(mt_result_shown(value, factor), digits, text),
                  mt_report_exact(value, exact));
}

static void add_slope_row(mt_table *t, const mt_recommendation *r, const moved *g, int k)
{
    const mt_result_parameter *const p = &r->parameters[k];
    mt_text room = {.s = NULL};
    add_room(p, &room);
    mt_table_text(t, g->text);
    mt_table_text(t, p->name);
    add_change(t, value_change_per_percent(r, g, k), g->display_factor, SHORT_DIGITS);
    mt_table_unit(t, g->unit != NULL && g->unit[0] != '\0' ? g->unit : NULL, g->display_unit);
    mt_table_shown(t, p->recommended, p->display_factor, VALUE_DIGITS);
    mt_table_unit(t, p->unit, p->display_unit);
    mt_table_text(t, p->at_bound);
    mt_table_text(t, room.s);
    t->failed = t->failed || room.failed;
    mt_text_free(&room);
}

static void add_moved(mt_table *t, const mt_recommendation *r, const moved *g)
{
    bool *const taken = mt_arena_alloc(&t->mem, (size_t)r->n_parameters, sizeof *taken);
    if (taken == NULL) {
        t->failed = true;
        return;
    }
    for (int k = 0; k < r->n_parameters; k++) {
        taken[k] = false;
    }
    for (int k = next_mover(r, g, taken); k >= 0; k = next_mover(r, g, taken)) {
        taken[k] = true;
        add_slope_row(t, r, g, k);
    }
}

static bool is_same_name(const char *a, const char *b)
{
    return a == NULL || b == NULL ? a == b : strcmp(a, b) == 0;
}

/* The mode of the least clearance relative to its margin, the first of equal ones. NULL:
 * none. */
static const mt_result_clearance *find_tightest_clearance(const mt_recommendation *r,
                                                          const char *configuration)
{
    const mt_result_clearance *best = NULL;
    double least = HUGE_VAL;
    for (int i = 0; i < r->n_clearances; i++) {
        const mt_result_clearance *const c = &r->clearances[i];
        const double room = mt_without_noise(c->percent - c->margin_percent, MT_PERCENT_NOISE);
        if (is_same_name(c->configuration, configuration) && isfinite(room) &&
            mt_exceeds(least, room)) {
            best = c;
            least = room;
        }
    }
    return best;
}

static void add_nearest(mt_table *t, const mt_recommendation *r, const mt_result_goal *g)
{
    const mt_result_clearance *const c = find_tightest_clearance(r, g->configuration);
    for (int i = 0; c != NULL && i < r->n_frequencies; i++) {
        const mt_result_frequency *const f = &r->frequencies[i];
        if (f->mode == c->mode && is_same_name(f->configuration, c->configuration) &&
            !f->repeated && f->sensitivity != NULL) {
            const char *const text = mt_arena_printf(
                &t->mem, "%s mode %d, %s %s", c->configuration, c->mode, c->side, c->band);
            const moved m = {text, "Hz", NULL, nan(""), f->recommended_hz, f->sensitivity};
            t->failed = t->failed || text == NULL;
            if (!t->failed) {
                add_moved(t, r, &m);
            }
            return;
        }
    }
}

mt_table mt_report_movers(const mt_recommendation *r)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, "goal", "goal", MT_ALIGN_LEFT);
    mt_table_column(&t, "parameter", "parameter", MT_ALIGN_LEFT);
    mt_table_column(&t, "1 % more moves it by", "change_per_percent", MT_ALIGN_POINT);
    mt_table_column(&t, "in", "unit", MT_ALIGN_LEFT);
    mt_table_column(&t, "value", "value", MT_ALIGN_POINT);
    mt_table_column(&t, "unit", "parameter_unit", MT_ALIGN_LEFT);
    mt_table_column(&t, "at bound", "at_bound", MT_ALIGN_LEFT);
    mt_table_column(&t, "room to its bounds", "room", MT_ALIGN_LEFT);
    for (int i = 0; !t.failed && i < r->n_goals; i++) {
        const mt_result_goal *const g = &r->goals[i];
        if (g->sensitivity != NULL) {
            add_moved(&t, r,
                      &(moved){g->text, g->unit, g->display_unit, g->display_factor, g->value,
                               g->sensitivity});
        } else if (strcmp(g->type, "avoid") == 0) {
            add_nearest(&t, r, g);
        }
    }
    return t;
}

/* True of a design that an older program wrote, whose reasons are of no kind and whose goals
 * tell no slopes. */
static bool is_older(const mt_recommendation *r)
{
    return r->n_reasons > 0 && r->reasons[0].kind == NULL;
}

/* Add "met" or "missed by 2.1 %", and that sensitivities are not available. */
static void add_goal_line(const mt_result_goal *g, bool older, mt_text *out)
{
    char number[MT_NUMBER_TEXT];
    const char *const unit = g->display_unit != NULL ? g->display_unit : g->unit;
    mt_text_addf(out, "  - %s: ", g->text);
    if (isfinite(g->value)) {
        const double shown = mt_result_shown(g->value, g->display_factor);
        mt_text_addf(out, "%s%s%s, ", mt_report_number(shown, VALUE_DIGITS, number),
                     unit != NULL && unit[0] != '\0' ? " " : "", unit != NULL ? unit : "");
    }
    if (g->met) {
        mt_text_add(out, "met");
    } else if (isfinite(g->violation_percent)) {
        mt_text_addf(out, "missed by %s %%",
                     mt_report_number(g->violation_percent, SHORT_DIGITS, number));
    } else {
        mt_text_add(out, "not met");
    }
    if (g->sensitivity == NULL && !older && strcmp(g->type, "avoid") != 0) {
        mt_text_add(out, "; no sensitivity (the mode is repeated, or the value is a distance)");
    }
    mt_text_add(out, "\n");
}

/* kind NULL: those without. */
static void add_reasons(const mt_recommendation *r, const char *kind, const char *title,
                        const char *none, mt_text *out)
{
    int n = 0;
    mt_text_addf(out, "\n%s\n", title);
    for (int i = 0; i < r->n_reasons; i++) {
        const char *const own = r->reasons[i].kind;
        if (own == NULL ? kind == NULL : kind != NULL && strcmp(own, kind) == 0) {
            mt_text_addf(out, "  - %s\n", r->reasons[i].text);
            n++;
        }
    }
    if (n == 0) {
        mt_text_addf(out, "  %s\n", none);
    }
}

/* The reason for no multiplier: there is none, or it is not known. */
static const char *no_price(const mt_result *result, const mt_recommendation *r)
{
    const bool misfit =
        result->n_objectives > 0 && strcmp(result->objectives[0].type, "misfit") == 0;
    if (r->rank == 0) {
        return "not available: what relaxing a limit gains is known at an optimum, which the "
               "original design is not";
    }
    if (!r->feasible) {
        return "not available: this design does not meet all goals";
    }
    if (isnan(r->kkt_residual)) {
        return "not available: the goals or the catalogues leave single designs, so no "
               "variable can move";
    }
    if (r->kkt_residual > MT_KKT_TOLD) {
        return "not available: what relaxing a limit gains is known at an optimum, which this "
               "design is not shown to be";
    }
    return misfit ? "not available: all goals have a weight, so no limit can be relaxed"
                  : "nothing: relaxing a goal, a band or a bound a little would not improve "
                    "the design";
}

void mt_report_explain(const mt_result *result, const mt_recommendation *r, int width,
                       mt_text *out)
{
    mt_table t = mt_report_movers(r);
    const char *const name =
        result->study.name != NULL ? result->study.name : result->study.file;
    mt_text_addf(out, "%s\n", name != NULL ? name : "");
    if (r->rank == 0) {
        mt_text_add(out, "The original design: nothing is recommended\n");
    } else {
        mt_text_addf(out, "Recommendation %d (%s)\n", r->rank, r->grade);
    }
    mt_text_add(out, "\nGoals\n");
    for (int i = 0; i < r->n_goals; i++) {
        add_goal_line(&r->goals[i], is_older(r), out);
    }
    if (mt_table_rows(&t) > 0 || t.failed) {
        mt_text_add(out, "\nWhat moves each goal, the most first\n");
        mt_table_print(&t, INDENT, width, out);
    }
    if (is_older(r)) {
        add_reasons(r, NULL, "Why", "", out);
    } else {
        add_reasons(r, "hold", "What holds it", "nothing: no bound, band or limit is active",
                    out);
        add_reasons(r, "cost", "What it costs", no_price(result, r), out);
    }
    mt_table_free(&t);
}
