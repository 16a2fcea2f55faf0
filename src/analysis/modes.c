/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "modetune/modes.h"

#include <math.h>

#include "analysis/analysis.h"
#include "base/text.h"

static mt_status unknown(const char *what, const char *name, int n, const char *const *names,
                         mt_err *err)
{
    const char *const nearest = mt_text_nearest(name, names, n);
    return nearest == NULL
               ? mt_fail(err, MT_E_USAGE, "no %s is called \"%s\"", what, name)
               : mt_fail(err, MT_E_USAGE, "no %s is called \"%s\"; did you mean \"%s\"?", what,
                         name, nearest);
}

static mt_status find_configuration(const mt_model *model, const char *name, mt_arena *mem,
                                    int *out, mt_err *err)
{
    const int n = mt_model_configuration_count(model);
    *out = name == NULL ? 0 : mt_model_find_configuration(model, name);
    if (*out != MT_ABSENT) {
        return MT_OK;
    }
    const char **const names = mt_arena_alloc(mem, (size_t)n, sizeof(const char *));
    if (names == NULL) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < n; i++) {
        names[i] = mt_model_configuration_name(model, i);
    }
    return unknown("configuration", name, n, names, err);
}

static mt_status find_parameter(const mt_model *model, const char *name, mt_arena *mem,
                                int *out, mt_err *err)
{
    const int n = mt_model_parameter_count(model);
    *out = mt_model_find_parameter(model, name);
    if (*out != MT_ABSENT) {
        return MT_OK;
    }
    const char **const names = mt_arena_alloc(mem, (size_t)n, sizeof(const char *));
    if (names == NULL) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < n; i++) {
        names[i] = mt_model_parameter_name(model, i);
    }
    return unknown("parameter", name, n, names, err);
}

static void copy_modes(const mt_modes *modes, int capacity, double *frequency_hz,
                       mt_mode_count *count)
{
    *count = (mt_mode_count){.rigid_body = modes->n_rigid,
                             .unstable = modes->n_unstable,
                             .undecided = modes->n_undecided};
    for (int i = 0; i < modes->count; i++) {
        if (modes->kind[i] != MT_MODE_FLEXIBLE) {
            continue;
        }
        if (mt_modal_indexed(modes) && count->vibration < capacity) {
            frequency_hz[count->vibration] = mt_modal_hz(modes, i);
        }
        count->vibration++;
    }
}

static mt_status analyse(const mt_model *model, const char *configuration, int n_settings,
                         const mt_setting *settings, mt_arena *mem, mt_analysis **out,
                         mt_err *err)
{
    int which = MT_ABSENT;
    int *const inputs = mt_arena_int(mem, (size_t)n_settings);
    double *const at = mt_arena_f64(mem, (size_t)n_settings, 1);
    if (inputs == NULL || at == NULL) {
        return mt_fail_memory(err);
    }
    MT_TRY(find_configuration(model, configuration, mem, &which, err));
    for (int i = 0; i < n_settings; i++) {
        at[i] = settings[i].value;
        MT_TRY(find_parameter(model, settings[i].parameter, mem, &inputs[i], err));
        for (int k = 0; k < i; k++) {
            if (inputs[k] == inputs[i]) {
                return mt_fail(err, MT_E_USAGE, "parameter \"%s\" is set twice",
                               settings[i].parameter);
            }
        }
    }
    return mt_analysis_new(model, which, n_settings, inputs, at, out, err);
}

mt_status mt_model_frequencies(const mt_model *model, const char *configuration, int n_settings,
                               const mt_setting *settings, int capacity, double *frequency_hz,
                               mt_mode_count *count, mt_err *err)
{
    mt_arena mem;
    mt_analysis *a = NULL;
    MT_NOT_NULL(count, err);
    *count = (mt_mode_count){0};
    MT_NOT_NULL(model, err);
    if (n_settings < 0 || capacity < 0) {
        return mt_fail(err, MT_E_USAGE, "mt_model_frequencies: %s is negative",
                       n_settings < 0 ? "n_settings" : "capacity");
    }
    if (n_settings > 0) {
        MT_NOT_NULL(settings, err);
    }
    if (capacity > 0) {
        MT_NOT_NULL(frequency_hz, err);
    }
    for (int i = 0; i < n_settings; i++) {
        if (settings[i].parameter == NULL || !isfinite(settings[i].value)) {
            return mt_fail(err, MT_E_USAGE, "mt_model_frequencies: settings[%d] has %s", i,
                           settings[i].parameter == NULL ? "no name" : "no finite value");
        }
    }
    MT_TRY(mt_arena_init(&mem, 0, err));
    const mt_status rc = analyse(model, configuration, n_settings, settings, &mem, &a, err);
    if (rc == MT_OK && a != NULL) {
        copy_modes(&a->modes, capacity, frequency_hz, count);
    }
    mt_analysis_delete(a);
    mt_arena_free(&mem);
    return rc;
}
