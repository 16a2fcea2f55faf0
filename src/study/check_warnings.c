/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Numbers of a study that are allowed and hardly meant. What such a question has for an answer
 * may be right, even proven, and is not what the engineer wanted to know: "feasible and proven"
 * of bands at a hundred times the rotor's speed. Limits are wide: a good study is not warned
 * of.
 */
#include <math.h>
#include <string.h>

#include "model/values.h"
#include "study/check.h"

/* A machine turns at less than 30 000 per minute. */
static const double MOST_SPEED_HZ = 500.0;
static const double SECONDS = 60.0;
/* A separation margin is 5 to 20 per cent; 0.1 is the factor that 10 per cent are. */
static const double LEAST_MARGIN_PERCENT = 1.0;
/* A band narrower than a thousandth of its frequency forbids less than a model is exact to. */
static const double LEAST_WIDTH = 1e-3;
/* A micrometre is lapped; springs are sorted to a half of a per cent, made to 5. */
static const double LEAST_TOLERANCE_M = 1e-6;
static const double LEAST_STIFFNESS_PERCENT = 0.1;
/* Bounds that span more than eight decades, or lie three from the original, have a power of ten
 * wrong more often than not. */
static const double MOST_SPAN = 1e8;
static const double MOST_SHIFT = 1e3;
static const double PERCENT = 100.0;
/* Of one limit: a longer look than a search would take is not worth it. */
static const double MOST_WORK = 1e6;
/* Two modes that are asked to nearly the same frequency may change places within tolerances. */
static const double MOST_SLACK = 1.01;

static void at(mt_warning *warning, mt_addr addr)
{
    if (warning != NULL) {
        warning->addr = addr;
    }
}

/* Warn of implausible speeds: they are in turns per second, and a number meant per minute is
 * sixty times too high. */
static void warn_speed(const mt_study_check *c, mt_warning_list *out, const mt_machine *machine)
{
    const double lower = mt_machine_speed_hz(machine, 0);
    const double upper = mt_machine_speed_hz(machine, 1);
    if (upper > MOST_SPEED_HZ) {
        at(mt_warning_add(out, MT_LEVEL_WARNING, "speed",
                          "the machine turns at %g to %g Hz, which is %g to %g per minute: if "
                          "turns per minute are meant, write \"%g*rpm\"",
                          lower, upper, SECONDS * lower, SECONDS * upper, upper),
           MT_HAS(machine->lower_hz) ? mt_machine_range_addr(machine, c->diags)
                                     : mt_diag_member(c->diags, machine->addr, "speed_hz"));
    }
}

static void warn_margin(mt_warning_list *out, double margin, mt_addr addr)
{
    if (margin > 0.0 && margin < LEAST_MARGIN_PERCENT) {
        at(mt_warning_add(out, MT_LEVEL_WARNING, "margin",
                          "margin_percent %g is %g %%, next to nothing: is %g %% meant?",
                          margin, margin, PERCENT * margin),
           addr);
    }
}

static void warn_avoid(const mt_study_check *c, mt_warning_list *out, const mt_goal *goal)
{
    const mt_avoid *const avoid = goal->avoid;
    warn_margin(out, avoid->source.margin_percent,
                mt_diag_member(c->diags, goal->addr, "margin_percent"));
    for (int i = 0; i < avoid->source.n_rotors; i++) {
        const mt_rotor *const rotor = &avoid->source.rotors[i];
        warn_margin(out, rotor->margin_percent,
                    mt_diag_member(c->diags, rotor->addr, "margin_percent"));
    }
    for (int i = 0; i < avoid->source.n_machines; i++) {
        const mt_machine *const machine = &avoid->source.machines[i];
        warn_speed(c, out, machine);
        warn_margin(out, machine->margin_percent,
                    mt_diag_member(c->diags, machine->addr, "margin_percent"));
    }
    for (int i = 0; i < avoid->bands.n; i++) {
        const mt_band *const band = &avoid->bands.items[i];
        if (band->upper_hz - band->lower_hz < LEAST_WIDTH * band->upper_hz) {
            const bool cut = band->upper_hz == avoid->source.up_to_hz;
            at(mt_warning_add(out, MT_LEVEL_WARNING, "band",
                              "the band %s has almost no width, %.6g to %.6g Hz%s", band->label,
                              band->lower_hz, band->upper_hz,
                              cut ? ": up_to_hz cuts the rest off" : ""),
               mt_diag_member(c->diags, goal->addr, cut ? "up_to_hz" : "bands_hz"));
        }
    }
}

static bool is_stiffness(const char *unit)
{
    static const char *const units[] = {"N/m", "N m/rad", "N s/m", "N m s/rad"};
    bool is = false;
    for (int i = 0; i < MT_COUNT(units); i++) {
        is = is || strcmp(unit, units[i]) == 0;
    }
    return is;
}

static void warn_variable(const mt_study_check *c, mt_warning_list *out, const mt_variable *v)
{
    const mt_study *const s = c->study;
    const char *const name = v->parameter_name.s;
    const double ratio = v->lower > 0.0 ? v->upper / v->lower : 0.0;
    if (ratio > MOST_SPAN) {
        const double decades =
            isfinite(ratio) ? log10(ratio) : log10(v->upper) - log10(v->lower);
        at(mt_warning_add(
               out, MT_LEVEL_WARNING, "bounds",
               "the bounds of %s, %g to %g%s%s, span %.0f decades: is a power of ten wrong?",
               name, mt_unit_from_si(v->shown, v->lower), mt_unit_from_si(v->shown, v->upper),
               v->shown == NULL ? "" : " ", mt_unit_name(v->shown, ""), floor(decades)),
           v->addr);
    }
    const char *const unit =
        v->parameter == MT_ABSENT ? NULL : s->model->parameters[v->parameter].unit;
    if (v->lower < 0.0 && v->original > 0.0 && unit != NULL && is_stiffness(unit)) {
        at(mt_warning_add(out, MT_LEVEL_WARNING, "bounds",
                          "the bounds of %s reach below 0, to a spring or damper that gives "
                          "energy: its original value is above",
                          name),
           mt_diag_member(c->diags, v->addr, "lower"));
    }
    const bool below =
        v->original > 0.0 && v->upper > 0.0 && v->original / v->upper > MOST_SHIFT;
    const bool above =
        v->original > 0.0 && v->lower > 0.0 && v->lower / v->original > MOST_SHIFT;
    if (below || above) {
        at(mt_warning_add(
               out, MT_LEVEL_WARNING, "bounds",
               "the bounds of %s, %g to %g%s%s, lie far from its original value, %g: is the "
               "unit the model's?",
               name, mt_unit_from_si(v->shown, v->lower), mt_unit_from_si(v->shown, v->upper),
               v->shown == NULL ? "" : " ", mt_unit_name(v->shown, ""),
               mt_unit_from_si(v->shown, v->original)),
           v->addr);
    }
}

/* Warn of tolerances finer than parts are made: relative for stiffnesses, absolute in metres
 * for lengths. */
static void warn_fine(const mt_study_check *c, mt_warning_list *out, const mt_variable *v)
{
    const mt_study *const s = c->study;
    const char *const unit =
        v->parameter == MT_ABSENT ? NULL : s->model->parameters[v->parameter].unit;
    const double percent = v->tolerance_percent;
    const double size = fmax(fabs(v->lower), fabs(v->upper));
    if (unit == NULL || !(percent >= mt_possible_of[MT_POSSIBLE_TOLERANCE].low)) {
        return; /* by itself, its row says it */
    }
    if (strcmp(unit, "m") == 0) {
        if (percent / PERCENT * size < LEAST_TOLERANCE_M) {
            at(mt_warning_add(
                   out, MT_LEVEL_WARNING, "tolerance",
                   "tolerance_percent %g of %s is at most %.2g m: no part is made so "
                   "exactly; is %g %% meant?",
                   percent, v->parameter_name.s, percent / PERCENT * size, PERCENT * percent),
               mt_diag_member(c->diags, v->addr, "tolerance_percent"));
        }
    } else if (is_stiffness(unit) && percent < LEAST_STIFFNESS_PERCENT) {
        at(mt_warning_add(out, MT_LEVEL_WARNING, "tolerance",
                          "tolerance_percent %g of %s: no spring or damper is made so exactly; "
                          "is %g %% meant?",
                          percent, v->parameter_name.s, PERCENT * percent),
           mt_diag_member(c->diags, v->addr, "tolerance_percent"));
    }
}

static void warn_trade(const mt_study_check *c, mt_warning_list *out, const mt_trade *trade)
{
    /* a span from 0 to 10 per cent passes by all that is less */
    for (int i = 0; i < trade->n_vary; i++) {
        const mt_vary *const v = &trade->vary[i];
        double most = 0.0;
        for (int k = 0; k < v->n_values; k++) {
            most = fmax(most, v->values[k]);
        }
        if (v->kind == MT_VARY_GOAL && v->slot == MT_SLOT_MARGIN) {
            warn_margin(out, most, mt_diag_member(c->diags, v->addr, "values"));
        }
    }
}

/* True where the goal's kind has a target that a reference can give: a frequency of a mode. */
static bool asks_frequency(const mt_goal *goal)
{
    const mt_goal_kind *const kind = mt_goal_kind_of(goal->type);
    return mt_goal_member(kind, MT_SLOT_EQUALS) != NULL && mt_goal_has(kind, "reference");
}

/* A measured frequency that a goal is to meet exactly, where other goals with references make
 * a misfit: a weight was forgotten, unless a tolerance says that it is meant. */
static void warn_weights(mt_warning_list *out, const mt_study *s)
{
    const mt_goal *first = NULL;
    bool fitted = false;
    int n = 0;
    for (int i = 0; i < s->n_goals; i++) {
        const mt_goal *const goal = &s->goals[i];
        if (goal->reference == MT_ABSENT ||
            s->references[goal->reference].model_path.s != NULL) {
            continue;
        }
        fitted = fitted || MT_HAS(goal->weight);
        if (!MT_HAS(goal->weight) && asks_frequency(goal) && !goal->tolerance_given) {
            first = first == NULL ? goal : first;
            n++;
        }
    }
    if (fitted && first != NULL) {
        at(mt_warning_add(
               out, MT_LEVEL_WARNING, "weight",
               "%d goal%s of a measured frequency %s no weight: %s to be met exactly, "
               "and %s no part of the misfit, while others of reference \"%s\" are; if "
               "that is meant, say \"tolerance_percent\"",
               n, n == 1 ? "" : "s", n == 1 ? "has" : "have", n == 1 ? "it is" : "they are",
               n == 1 ? "is" : "are", s->references[first->reference].name.s),
           first->addr);
    }
}

/* Shapes are compared whatever their size: two of one number are always the same. */
static void warn_shape(mt_warning_list *out, const mt_study *s, const mt_goal *goal)
{
    const mt_goal_kind *const kind = mt_goal_kind_of(goal->type);
    const int index = goal->reference_mode > 0 ? goal->reference_mode : goal->mode.index;
    if (goal->reference == MT_ABSENT || mt_goal_member(kind, MT_SLOT_EQUALS) != NULL) {
        return;
    }
    const mt_reference *const r = &s->references[goal->reference];
    if (r->model_path.s == NULL && index >= 1 && index <= r->n_modes &&
        mt_count_common_channels(s->model, &r->modes[index - 1]) == 1) {
        at(mt_warning_add(
               out, MT_LEVEL_WARNING, "no_effect",
               "mode %d of reference \"%s\" has one number in common with the model: "
               "any shape is the same as that",
               index, r->name.s),
           goal->addr);
    }
}

/* The lowest frequency that a goal allows a mode, and the highest. */
static void limits_of(const mt_study *s, const mt_goal *goal, double *low, double *high)
{
    double equal = goal->number[MT_SLOT_EQUALS];
    if (goal->reference != MT_ABSENT && s->references[goal->reference].model_path.s == NULL) {
        const mt_reference *const r = &s->references[goal->reference];
        const int index = goal->reference_mode > 0 ? goal->reference_mode : goal->mode.index;
        equal = index >= 1 && index <= r->n_modes ? r->modes[index - 1].frequency_hz : equal;
    }
    *low = MT_HAS(equal) ? equal : goal->at_least;
    *high = MT_HAS(equal) ? equal : goal->at_most;
}

static bool share_configuration(const mt_goal *a, const mt_goal *b)
{
    for (int i = 0; i < a->n_configurations; i++) {
        for (int k = 0; k < b->n_configurations; k++) {
            if (a->configurations[i] == b->configurations[k]) {
                return true;
            }
        }
    }
    return false;
}

/* Warn of limits against the order of modes, which are counted by ascending frequency. */
static void warn_order(mt_warning_list *out, const mt_study *s, const mt_goal *goal)
{
    for (int i = 0; i < s->n_goals && asks_frequency(goal); i++) {
        const mt_goal *const other = &s->goals[i];
        double low = 0.0;
        double high = 0.0;
        double unused = 0.0;
        if (!asks_frequency(other) || other->mode.mode_name.s != NULL ||
            goal->mode.mode_name.s != NULL || other->mode.index >= goal->mode.index ||
            !share_configuration(goal, other)) {
            continue;
        }
        limits_of(s, other, &low, &unused);
        limits_of(s, goal, &unused, &high);
        if (low > high * MOST_SLACK) {
            at(mt_warning_add(
                   out, MT_LEVEL_WARNING, "target",
                   "mode %d is asked to at most %.6g Hz and mode %d to at least %.6g "
                   "Hz: modes are counted by ascending frequency",
                   goal->mode.index, high, other->mode.index, low),
               goal->addr);
            return;
        }
    }
}

/* True where the expression of a limit changes when a variable is at a bound, or where that is
 * not known. */
static bool follows_variables(const mt_study *s, const mt_goal *goal, mt_arena *mem)
{
    const size_t n = (size_t)s->n_variables;
    const mt_number number = {.expr = goal->expression, .addr = goal->addr};
    int *const inputs = mt_arena_int(mem, n);
    double *const x = mt_arena_f64(mem, n, 1);
    mt_numbers numbers;
    double original = 0.0;
    bool follows = false;
    if (mt_arena_failed(mem)) {
        return true;
    }
    for (int i = 0; i < s->n_variables; i++) {
        inputs[i] = s->variables[i].parameter;
        x[i] = s->variables[i].original;
    }
    if (mt_numbers_new(s->model, MT_ABSENT, s->n_variables, inputs, 1, &number, mem, &numbers,
                       NULL) != MT_OK) {
        return true;
    }
    mt_numbers_at(&numbers, x, &original, NULL);
    for (int i = 0; i < s->n_variables && !follows; i++) {
        const double ends[] = {s->variables[i].lower, s->variables[i].upper};
        for (int k = 0; k < 2 && !follows; k++) {
            double value = 0.0;
            x[i] = ends[k];
            mt_numbers_at(&numbers, x, &value, NULL);
            follows = !(value == original);
        }
        x[i] = s->variables[i].original;
    }
    return follows;
}

static void warn_limit(mt_warning_list *out, const mt_study *s, const mt_goal *goal)
{
    const double work = (double)s->n_variables * (double)s->model->n_parameters;
    mt_arena mem;
    if (goal->expression_text == NULL || s->n_variables == 0 || work > MOST_WORK ||
        mt_arena_init(&mem, 0, NULL) != MT_OK) {
        return;
    }
    if (!follows_variables(s, goal, &mem)) {
        at(mt_warning_add(out, MT_LEVEL_WARNING, "no_effect",
                          "no variable changes \"%s\": the limit has no effect",
                          goal->expression_text),
           goal->addr);
    }
    mt_arena_free(&mem);
}

static void warn_all(const mt_study_check *c, mt_warning_list *out)
{
    const mt_study *const s = c->study;
    for (int i = 0; i < s->n_variables; i++) {
        warn_variable(c, out, &s->variables[i]);
        warn_fine(c, out, &s->variables[i]);
    }
    for (int i = 0; i < s->n_goals; i++) {
        if (s->goals[i].avoid != NULL) {
            warn_avoid(c, out, &s->goals[i]);
        }
        warn_limit(out, s, &s->goals[i]);
        warn_shape(out, s, &s->goals[i]);
        warn_order(out, s, &s->goals[i]);
    }
    warn_weights(out, s);
    warn_trade(c, out, &s->trade);
}

void mt_study_check_warnings(mt_study_check *c)
{
    mt_study *const s = c->study;
    mt_warning_list *const out = &s->warning_list;
    if (c->diags->errors == 0) {
        warn_all(c, out);
    }
    mt_warning_accept(out, 0, &s->accepted);
    for (int i = 0; i < out->n; i++) {
        if (out->items[i].level == MT_LEVEL_WARNING) {
            mt_diag_warning(c->diags, out->items[i].addr, "%s", out->items[i].text);
        }
    }
}
