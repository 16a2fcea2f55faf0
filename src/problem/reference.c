/* SPDX-License-Identifier: GPL-3.0-or-later */

#include "problem/reference.h"

#include <math.h>

#include "analysis/analysis.h"

static mt_status no_common(const mt_reference *r, mt_err *err)
{
    return mt_fail(err, MT_E_INPUT,
                   "reference \"%s\": no sensor channel is common to it and the model",
                   r->name.s);
}

void mt_reference_scale(const mt_reference_shape *ref, int n, double *shape)
{
    mt_channels_weigh(ref->ns, ref->scale, n, shape);
}

static mt_status normalise(const mt_reference *r, const mt_system *sys, double length,
                           mt_arena *mem, mt_reference_shape *out, mt_err *err)
{
    out->length = MT_HAS(length) ? length : sys->length_m;
    MT_TRY(mt_channels_scale(sys, out->ns, out->channel, out->length, mem, &out->scale, err));
    mt_reference_scale(out, 1, out->shape);
    const double norm = mt_norm2(out->ns, out->shape);
    if (!(norm > 0.0)) {
        return mt_fail(err, MT_E_INPUT,
                       "reference \"%s\": mode %d does not move at the common sensors",
                       r->name.s, out->mode);
    }
    for (int i = 0; i < out->ns; i++) {
        out->shape[i] /= norm;
    }
    return MT_OK;
}

/* Returns NULL, with the error set, where the list has no such mode. */
static const mt_measured_mode *measured_mode(const mt_reference *r, int mode, mt_err *err)
{
    if (mode > r->n_modes) {
        (void)mt_fail(err, MT_E_INPUT, "reference \"%s\" has no mode %d (it lists %d)",
                      r->name.s, mode, r->n_modes);
        return NULL;
    }
    return &r->modes[mode - 1];
}

static mt_status measured(const mt_reference *r, const mt_system *sys, double length,
                          mt_arena *mem, mt_reference_shape *out, mt_err *err)
{
    const mt_measured_mode *const m = measured_mode(r, out->mode, err);
    if (m == NULL) {
        return MT_E_INPUT;
    }
    out->channel = mt_arena_int(mem, (size_t)m->n_values);
    out->shape = mt_arena_f64(mem, (size_t)m->n_values, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < m->n_values; i++) {
        const int c = mt_system_find_channel(sys, m->channels[i].s);
        if (c >= 0) {
            out->channel[out->ns] = c;
            out->shape[out->ns++] = m->values[i];
        }
    }
    out->frequency_hz = m->frequency_hz;
    return out->ns == 0 ? no_common(r, err) : normalise(r, sys, length, mem, out, err);
}

mt_status mt_reference_cache_init(mt_reference_cache *cache, const mt_study *study,
                                  const mt_run *run, mt_arena *mem, mt_err *err)
{
    cache->run = run;
    cache->analysis = mt_arena_alloc(mem, (size_t)study->n_references, sizeof(mt_analysis *));
    cache->study = study;
    MT_TRY(mt_arena_check(mem, err));
    return mt_lock_init(&cache->lock, err);
}

void mt_reference_cache_free(mt_reference_cache *cache)
{
    for (int i = 0; cache->analysis != NULL && i < cache->study->n_references; i++) {
        mt_analysis_delete(cache->analysis[i]);
    }
    mt_lock_free(&cache->lock);
    *cache = (mt_reference_cache){0};
}

/* The reference's own analysis, made on first use, and the position of its mode. */
static mt_status computed_mode(mt_reference_cache *cache, int reference, int mode,
                               mt_analysis **out, int *pos, mt_err *err)
{
    const mt_reference *const r = &cache->study->references[reference];
    mt_analysis **const cached = &cache->analysis[reference];
    if (*cached == NULL) {
        const mt_system_def def = {
            .model = r->model, .run = cache->run, .configuration = r->configuration};
        MT_TRY(mt_err_in(err, mt_analysis_new_of(&def, 0, cached, err), "reference \"%s\"",
                         r->name.s));
    }
    *out = *cached;
    *pos = mt_modal_flexible(&(*cached)->modes, mode);
    if (*pos < 0) {
        return mt_fail(err, MT_E_INPUT, "reference \"%s\" has no vibration mode %d", r->name.s,
                       mode);
    }
    return MT_OK;
}

static mt_status computed(mt_analysis *a, int pos, const mt_reference *r, const mt_system *sys,
                          double length, mt_arena *mem, mt_reference_shape *out, mt_err *err)
{
    const size_t most = (size_t)sys->n_channels;
    int *const theirs = mt_arena_int(mem, most);
    out->channel = mt_arena_int(mem, most);
    out->shape = mt_arena_f64(mem, most, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < sys->n_channels; i++) {
        const int c = mt_system_find_channel(a->sys, sys->channels[i].name);
        if (c >= 0) {
            out->channel[out->ns] = i;
            theirs[out->ns++] = c;
        }
    }
    if (out->ns == 0) {
        return no_common(r, err);
    }
    out->frequency_hz = mt_modal_hz(&a->modes, pos);
    MT_TRY(mt_analysis_shape(a, pos, out->ns, theirs, out->shape, NULL, err));
    return normalise(r, sys, length, mem, out, err);
}

mt_status mt_reference_shape_init(mt_reference_cache *cache, int reference, int mode,
                                  const mt_system *sys, double length, mt_arena *mem,
                                  mt_reference_shape *out, mt_err *err)
{
    const mt_reference *const r = &cache->study->references[reference];
    mt_analysis *a = NULL;
    int pos = -1;
    *out = (mt_reference_shape){.reference = r->name.s, .mode = mode, .frequency_hz = nan("")};
    if (r->model == NULL) {
        return measured(r, sys, length, mem, out, err);
    }
    mt_lock_take(&cache->lock);
    mt_status rc = computed_mode(cache, reference, mode, &a, &pos, err);
    rc = rc == MT_OK ? computed(a, pos, r, sys, length, mem, out, err) : rc;
    mt_lock_release(&cache->lock);
    return rc;
}

mt_status mt_reference_frequency_init(mt_reference_cache *cache, int reference, int mode,
                                      mt_reference_shape *out, mt_err *err)
{
    const mt_reference *const r = &cache->study->references[reference];
    mt_analysis *a = NULL;
    int pos = -1;
    *out = (mt_reference_shape){.reference = r->name.s, .mode = mode, .frequency_hz = nan("")};
    if (r->model != NULL) {
        mt_lock_take(&cache->lock);
        const mt_status rc = computed_mode(cache, reference, mode, &a, &pos, err);
        out->frequency_hz = rc == MT_OK ? mt_modal_hz(&a->modes, pos) : out->frequency_hz;
        mt_lock_release(&cache->lock);
        return rc;
    }
    const mt_measured_mode *const m = measured_mode(r, mode, err);
    if (m == NULL) {
        return MT_E_INPUT;
    }
    out->frequency_hz = m->frequency_hz;
    if (!(m->frequency_hz > 0.0)) {
        return mt_fail(err, MT_E_INPUT, "reference \"%s\": mode %d has no frequency", r->name.s,
                       mode);
    }
    return MT_OK;
}

mt_status mt_reference_mac(mt_analysis *a, int pos, const mt_reference_shape *ref, double *mac,
                           mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(&a->mem);
    double *const s = mt_arena_f64(&a->mem, (size_t)ref->ns, 1);
    MT_TRY(mt_arena_check(&a->mem, err));
    const mt_status rc = mt_analysis_shape(a, pos, ref->ns, ref->channel, s, NULL, err);
    if (rc == MT_OK) {
        mt_reference_scale(ref, 1, s);
        mt_mac_matrix(ref->ns, 1, s, 1, ref->shape, mac);
    }
    mt_arena_rewind(&a->mem, mark);
    return rc;
}
