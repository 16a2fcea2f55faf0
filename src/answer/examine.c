/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A study held against its model: whether what it asks for is anywhere near what it does.
 * Frequencies f_k(x) are looked at where x is the original design and where one variable, or
 * all, stand at a bound; a band that no f_k comes within a factor of there has no part in the
 * answer. Where two of these designs differ in how many modes lie above a band, one comes
 * through it in between: frequencies are continuous. Above, since modes that rest at 0 Hz at
 * one design (a spring that may be 0) are no vibrations there.
 */
#include "answer/examine.h"

#include <math.h>
#include <string.h>

#include "analysis/count.h"
#include "answer/warnings.h"
#include "base/format.h"
#include "base/text.h"
#include "model/lint.h"
#include "model/values.h"
#include "problem/frequency.h"

enum { TIMES_SIZE = 32 };

/* A target a hundred times away from where the mode is, is in another unit (rad/s, rpm and kHz
 * are 6, 60 and 1000 away), or of another mode. */
static const double FAR_TARGET = 100.0;
/* No mode comes within this factor of any band: rpm for Hz makes 60. */
static const double FAR_BAND = 10.0;

typedef struct reach {
    const mt_goal *goal;
    int *above; /* [2 bands] modes above each, at the first design looked at (-1: none yet) */
    /* least of a mode beside a band (problem/frequency.h); 0 or less: one is inside */
    double room;
} reach;

static void count_modes_around_bands(reach *r, const mt_modes *modes)
{
    const mt_bands *const bands = &r->goal->avoid->bands;
    int *const below = r->above + bands->n;
    int vibrations = 0;
    for (int i = 0; i < modes->count; i++) {
        vibrations += modes->kind[i] == MT_MODE_FLEXIBLE ? 1 : 0;
    }
    r->room = fmin(r->room, mt_bands_find(bands, modes, below));
    for (int b = 0; b < bands->n; b++) {
        const int above = vibrations - below[b];
        if (r->above[b] >= 0 && above != r->above[b]) {
            r->room = fmin(r->room, 0.0);
        }
        r->above[b] = above;
    }
}

/* Design `which` of the 2 n + 3: the original, each variable at a bound, all at their lower and
 * their upper ones. */
static void set_design(const mt_study *s, int which, double *x)
{
    const int n = s->n_variables;
    for (int i = 0; i < n; i++) {
        const mt_variable *const v = &s->variables[i];
        x[i] = v->original;
        if (which == (2 * i) + 1 || which == (2 * n) + 1) {
            x[i] = v->lower;
        } else if (which == (2 * i) + 2 || which == (2 * n) + 2) {
            x[i] = v->upper;
        }
    }
}

static mt_status look_around(const mt_study *s, const mt_run *run, int c, reach *r,
                             mt_arena *mem, mt_err *err)
{
    const int n = s->n_variables;
    int *const inputs = mt_arena_int(mem, (size_t)n);
    const size_t n_bands = (size_t)r->goal->avoid->bands.n;
    r->above = mt_arena_int(mem, 2 * n_bands);
    double *const x = mt_arena_f64(mem, (size_t)n, 1);
    mt_analysis_options opt = mt_analysis_options_default();
    mt_analysis *a = NULL;
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < n; i++) {
        inputs[i] = s->variables[i].parameter;
    }
    opt.vectors = false;
    opt.check = false;
    for (size_t k = 0; k < n_bands; k++) {
        r->above[k] = -1;
    }
    set_design(s, 0, x);
    const mt_system_def def = {.model = s->model,
                               .run = run,
                               .configuration = c,
                               .n_inputs = n,
                               .inputs = inputs,
                               .at = x};
    mt_status rc = mt_analysis_new_of(&def, 0, &a, err);
    if (rc == MT_OK) {
        a->recount = true; /* a spring that is 0 in the original has modes elsewhere */
    }
    for (int k = 0; rc == MT_OK && k < (2 * n) + 3 && r->room > log(FAR_BAND); k++) {
        mt_err ignored = {.code = MT_OK}; /* a design that has no modes has none in a band */
        set_design(s, k, x);
        const mt_status solved = mt_analysis_solve(a, x, &opt, &ignored);
        if (solved == MT_OK) {
            count_modes_around_bands(r, &a->modes);
        }
        rc = mt_pass_final(solved, &ignored, err);
    }
    mt_analysis_delete(a);
    return rc;
}

static mt_status examine_bands(const mt_study *s, const mt_run *run, int g,
                               mt_warning_list *out, mt_err *err)
{
    const mt_goal *const goal = &s->goals[g];
    reach r = {.goal = goal, .room = HUGE_VAL};
    mt_arena mem;
    MT_TRY(mt_arena_init(&mem, 0, err));
    mt_status rc = MT_OK;
    for (int i = 0; rc == MT_OK && i < goal->n_configurations; i++) {
        rc = look_around(s, run, goal->configurations[i], &r, &mem, err);
    }
    mt_arena_free(&mem);
    const mt_bands *const bands = &goal->avoid->bands;
    if (rc == MT_OK && r.room > log(FAR_BAND) && bands->n > 0) {
        const char *const which =
            mt_arena_printf(out->mem, "its bands, %.4g to %.4g Hz, have no effect",
                            bands->items[0].lower_hz, bands->items[bands->n - 1].upper_hz);
        mt_warning *const d =
            isfinite(r.room)
                ? mt_warning_add(out, MT_LEVEL_WARNING, "no_effect",
                                 "%s: within the bounds no mode comes nearer than a factor of "
                                 "%.3g (sampled); are they in Hz?",
                                 which == NULL ? "" : which, exp(r.room))
                : mt_warning_add(out, MT_LEVEL_WARNING, "no_effect",
                                 "%s: within the bounds there is no vibration mode at all "
                                 "(sampled)",
                                 which == NULL ? "" : which);
        if (d != NULL) {
            d->addr = goal->addr;
        }
    }
    return rc;
}

/* Frequency of the mode that a goal names, in a solved configuration; NaN where there is
 * none. */
static double original_hz(const mt_study *s, const mt_goal *goal, const mt_analysis *a)
{
    int pos = -1;
    if (goal->mode.named == MT_ABSENT) {
        pos = mt_modal_flexible(&a->modes, goal->mode.index);
    } else {
        const mt_named_mode *const m = &s->model->modes[goal->mode.named];
        const bool here = m->configuration == a->sys->configuration;
        pos = here ? mt_analysis_named(a, m->index) : -1;
    }
    return pos < 0 ? nan("") : mt_modal_hz(&a->modes, pos);
}

static void warn_target(const mt_study *s, mt_warning_list *out, const mt_goal *goal,
                        mt_goal_slot slot, double hz)
{
    const char *const name = mt_goal_member_name(mt_goal_kind_of(goal->type), slot);
    const double asked = goal->number[slot];
    const bool above = slot != MT_SLOT_AT_MOST;
    const bool below = slot != MT_SLOT_AT_LEAST;
    const double ratio = hz > 0.0 ? asked / hz : nan("");
    if (!((above && ratio >= FAR_TARGET) || (below && ratio <= 1.0 / FAR_TARGET))) {
        return;
    }
    char times[TIMES_SIZE] = "far";
    const double factor = ratio >= 1.0 ? ratio : hz / asked;
    if (isfinite(factor)) {
        (void)mt_snprintf(times, sizeof times, "%.3g times", factor);
    }
    mt_warning *const d =
        mt_warning_add(out, MT_LEVEL_WARNING, "target",
                       "%s %.6g Hz is %s %s the original frequency, %.6g Hz: is the unit Hz?",
                       name, asked, times, ratio >= 1.0 ? "above" : "below", hz);
    if (d != NULL) {
        d->addr = mt_study_member(s, goal->addr, name);
    }
}

/* Adds to the warning of an unstable position that goals name it. */
static void add_goals(const mt_study *s, int c, mt_warning_list *of_model, int first)
{
    const char *const name = s->model->configurations[c].name.s;
    for (int i = first; i < of_model->n; i++) {
        mt_warning *const d = &of_model->items[i];
        if (strcmp(d->kind, "unstable") == 0 && d->configuration != NULL &&
            strcmp(d->configuration, name) == 0) {
            d->text = mt_arena_printf(of_model->mem,
                                      "%s; goals name it, and none of them is met by a design "
                                      "that does so",
                                      d->text);
        }
    }
}

/* Warnings about a reference's own model: a target taken from it is as uncertain as its
 * numbers. */
static mt_status examine_reference(const mt_study *s, const mt_reference *r,
                                   mt_warning_list *out, mt_err *err)
{
    if (r->model == NULL || r->model == s->model || r->configuration < 0) {
        return MT_OK;
    }
    mt_arena mem;
    MT_TRY(mt_arena_init(&mem, 0, err));
    mt_warning_list list = mt_warning_list_default(&mem);
    double *const value = mt_arena_f64(&mem, (size_t)r->model->n_nums, 1);
    mt_status rc =
        mt_model_numbers(r->model, r->configuration, 0, NULL, NULL, &mem, value, err);
    if (rc == MT_OK) {
        mt_model_lint(r->model, r->configuration, value, false, &list);
    }
    for (int i = 0; rc == MT_OK && i < list.n; i++) {
        if (list.items[i].level == MT_LEVEL_WARNING) {
            list.items[i].file = r->model_path.s;
            mt_warning_copy(out, &list.items[i]);
        }
    }
    rc = rc == MT_OK ? mt_arena_check(&mem, err) : rc;
    mt_arena_free(&mem);
    return rc;
}

/* Frequency of a measured reference for a goal's mode [Hz]; NaN: none. */
static double measured_hz(const mt_study *s, const mt_goal *goal)
{
    const mt_reference *const r =
        goal->reference == MT_ABSENT ? NULL : &s->references[goal->reference];
    const int mode = goal->reference_mode > 0 ? goal->reference_mode : goal->mode.index;
    const bool there = r != NULL && r->model == NULL && mode >= 1 && mode <= r->n_modes;
    return there ? r->modes[mode - 1].frequency_hz : nan("");
}

/* Frequencies of a reference in parts of the model's: 2 pi says rad/s, 60 turns per minute.
 * Models are not wrong by as much in all modes alike. */
static void warn_reference(const mt_study *s, int reference, const double *ratio,
                           mt_warning_list *out)
{
    static const struct {
        double factor;
        const char *what;
    } units[] = {{6.283185307179586, "rad/s"}, {60.0, "turns per minute"}};
    enum { LEAST_MODES = 2 };
    static const double ALIKE = 0.15; /* of the logarithm */
    for (int u = 0; u < MT_COUNT(units); u++) {
        const double factor = units[u].factor;
        int above = 0;
        int below = 0;
        int n = 0;
        for (int g = 0; g < s->n_goals; g++) {
            if (s->goals[g].reference == reference && ratio[g] > 0.0) {
                n++;
                above += fabs(log(ratio[g] / factor)) < ALIKE ? 1 : 0;
                below += fabs(log(ratio[g] * factor)) < ALIKE ? 1 : 0;
            }
        }
        if (n < LEAST_MODES || (above < n && below < n)) {
            continue;
        }
        mt_warning *const d = mt_warning_add(
            out, MT_LEVEL_WARNING, "reference",
            "the %d frequencies of reference \"%s\" that goals ask for are all about %.3g "
            "times "
            "%s the model's: %s",
            n, s->references[reference].name.s, factor, above == n ? "above" : "below",
            above == n
                ? mt_arena_printf(out->mem, "are they in %s instead of Hz?", units[u].what)
                : mt_arena_printf(out->mem,
                                  "is the model in units of which a frequency "
                                  "comes out in %s?",
                                  units[u].what));
        if (d != NULL) {
            d->addr = s->references[reference].addr;
        }
    }
}

/* ratio[n_goals]: reference frequency over the model's, where known. */
static mt_status examine_configuration(const mt_study *s, const mt_run *run, int c,
                                       double *ratio, mt_warning_list *of_study,
                                       mt_warning_list *of_model, mt_err *err)
{
    mt_analysis *a = NULL;
    const int first = of_model->n;
    const mt_system_def def = {.model = s->model, .run = run, .configuration = c};
    mt_status rc = mt_analysis_new_of(&def, 0, &a, err);
    rc = rc == MT_OK ? mt_warnings_of_analysis(a, 0, NULL, NULL, of_model, err) : rc;
    /* modes are counted as the study does */
    rc = rc == MT_OK ? mt_analysis_count(a, &s->counted, NULL, 0.0, err) : rc;
    if (rc == MT_OK && a->n_rigid != a->n_null) {
        const mt_analysis_options opt = mt_analysis_options_default();
        rc = mt_analysis_solve(a, NULL, &opt, err);
    }
    if (rc == MT_OK) {
        add_goals(s, c, of_model, first);
    }
    for (int g = 0; rc == MT_OK && g < s->n_goals; g++) {
        const mt_goal *const goal = &s->goals[g];
        const bool in_hz = strcmp(mt_goal_kind_of(goal->type)->unit, "Hz") == 0;
        for (int k = 0; k < goal->n_configurations && in_hz; k++) {
            if (goal->configurations[k] != c) {
                continue;
            }
            const double hz = original_hz(s, goal, a);
            ratio[g] = hz > 0.0 ? measured_hz(s, goal) / hz : nan("");
            for (int slot = MT_SLOT_EQUALS; slot <= MT_SLOT_AT_MOST; slot++) {
                warn_target(s, of_study, goal, (mt_goal_slot)slot, hz);
            }
        }
    }
    mt_analysis_delete(a);
    return rc;
}

/* Number of configurations that the study names, and the work of analysing them, with bands
 * once more for every bound. */
static int count_asked(const mt_study *study, double *work)
{
    int asked = 0;
    double around = 0.0; /* the analyses of bands, of all goals in all their configurations */
    double most = 0.0;
    for (int g = 0; g < study->n_goals; g++) {
        const mt_goal *const goal = &study->goals[g];
        around += goal->avoid != NULL ? (double)goal->n_configurations : 0.0;
    }
    around *= (2.0 * study->n_variables) + 3.0;
    for (int c = 0; c < study->model->n_configurations; c++) {
        if (mt_study_asks(study, c)) {
            const double takes = mt_warnings_work(study->model, c);
            *work += takes;
            most = fmax(most, takes);
            asked++;
        }
    }
    *work += around * most;
    return asked;
}

bool mt_study_takes_more(const mt_study *study, double most_work)
{
    double work = 0.0;
    (void)count_asked(study, &work);
    return work > most_work;
}

mt_status mt_study_examine(const mt_study *study, const mt_run *run, double most_work,
                           mt_warning_list *out, mt_err *err)
{
    const int first = out->n;
    double work = 0.0;
    const int asked = count_asked(study, &work);
    const bool look = work <= most_work;
    for (int i = 0; i < study->warning_list.n; i++) {
        mt_warning_copy(out, &study->warning_list.items[i]);
    }
    mt_warning_list of_model = mt_warning_list_default(out->mem);
    double *const ratio = mt_arena_f64(out->mem, (size_t)study->n_goals, 1);
    MT_TRY(mt_arena_check(out->mem, err));
    for (int c = 0; c < study->model->n_configurations && look; c++) {
        if (mt_study_asks(study, c)) {
            MT_TRY(examine_configuration(study, run, c, ratio, out, &of_model, err));
        }
    }
    for (int g = 0; g < study->n_goals && look; g++) {
        if (study->goals[g].avoid != NULL) {
            MT_TRY(examine_bands(study, run, g, out, err));
        }
    }
    for (int i = 0; i < study->n_references; i++) {
        warn_reference(study, i, ratio, out);
    }
    for (int i = first; i < out->n; i++) {
        mt_warning *const d = &out->items[i];
        d->file = mt_text_base_name(study->path);
        mt_study_place_warning(study, out->mem, d);
    }
    for (int i = 0; i < of_model.n; i++) {
        of_model.items[i].file = study->model_path.s;
        mt_warning_copy(out, &of_model.items[i]);
    }
    if (!look) {
        mt_warnings_left_out(asked, out);
    }
    for (int i = 0; i < study->n_references; i++) {
        MT_TRY(examine_reference(study, &study->references[i], out, err));
    }
    mt_warning_accept(out, first, &study->accepted);
    return mt_arena_check(out->mem, err);
}
