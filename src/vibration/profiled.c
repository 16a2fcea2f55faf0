/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vibration/profiled_priv.h"

#include <math.h>

static mt_status name_input(const mt_vibration *v, const mt_system *sys, mt_arena *mem,
                            mt_response_request *request, mt_err *err)
{
    static const char *const names[] = {"x", "y", "z"};
    const char *const axis = v->axis == MT_ABSENT ? NULL : names[v->axis];
    const char **const input = mt_arena_alloc(mem, 1, sizeof *input);
    MT_TRY(mt_arena_check(mem, err));
    if (axis == NULL) {
        return mt_fail(
            err, MT_E_USAGE,
            "%s names no axis: name an input, base.x, base.y or base.z, along which it "
            "shakes",
            v->name == NULL ? v->path : v->name);
    }
    if (v->axis >= sys->dimension) {
        return mt_fail(err, MT_E_USAGE,
                       "%s is along %s, and the mechanism is plane: name an input, base.x or "
                       "base.y, along "
                       "which it shakes",
                       v->name == NULL ? v->path : v->name, axis);
    }
    input[0] = mt_arena_printf(mem, "base.%s", axis);
    request->n_in = 1;
    request->inputs = input;
    return mt_arena_check(mem, err);
}

mt_status mt_profiled_ports(const mt_vibration *v, const mt_system *sys, mt_arena *mem,
                            mt_response_request *request, mt_err *err)
{
    if (request->n_in == 0) {
        MT_TRY(name_input(v, sys, mem, request, err));
    }
    if (request->n_out == 0) {
        const char **const names = mt_arena_alloc(mem, (size_t)sys->n_channels, sizeof *names);
        MT_TRY(mt_arena_check(mem, err));
        for (int i = 0; i < sys->n_channels; i++) {
            names[i] = mt_arena_printf(mem, "%s:acceleration", sys->channels[i].name);
        }
        request->n_out = sys->n_channels;
        request->outputs = names;
    }
    return mt_arena_check(mem, err);
}

mt_status mt_profiled_input(const mt_port *port, mt_err *err)
{
    return port->kind == MT_PORT_BASE && port->motion == 2
               ? MT_OK
               : mt_fail(err, MT_E_USAGE,
                         "a profile of vibration is an acceleration of the ground, and \"%s\" "
                         "is none: \"base.x\", \"base.y\" and \"base.z\" are",
                         port->name);
}

static mt_status by_poles(mt_response *r, const mt_pole_sum *sums, mt_profiled *out,
                          mt_err *err)
{
    out->n_poles = sums[0].n;
    out->poles = sums[0].s;
    out->of = mt_arena_alloc(&r->mem, (size_t)out->n_pairs, sizeof *out->of);
    MT_TRY(mt_arena_check(&r->mem, err));
    for (int p = 0; p < out->n_pairs; p++) {
        MT_TRY(mt_vibration_respond(out->v, &sums[p], &r->mem, &out->answers[p], err));
        MT_TRY(mt_spectral_init(&out->of[p], &sums[p], &r->mem, err));
    }
    return MT_OK;
}

mt_status mt_profiled_find(mt_response *r, const mt_vibration *v, mt_profiled *out, mt_err *err)
{
    mt_err own = {.code = MT_OK};
    *out = (mt_profiled){.v = v, .n_pairs = r->ports.n_in * r->ports.n_out};
    for (int i = 0; i < r->ports.n_in; i++) {
        MT_TRY(mt_profiled_input(&r->ports.in[i], err));
    }
    const size_t pairs = (size_t)out->n_pairs;
    mt_pole_sum *const sums = mt_arena_alloc(&r->mem, pairs, sizeof *sums);
    out->answers = mt_arena_alloc(&r->mem, pairs, sizeof *out->answers);
    MT_TRY(mt_arena_check(&r->mem, err));
    const mt_status rc = mt_response_sums(r, sums, &own);
    if (rc == MT_OK) {
        return by_poles(r, sums, out, err);
    }
    if (rc != MT_E_SINGULAR) {
        return mt_fail(err, rc, "%s", own.text);
    }
    out->no_sums = mt_arena_strdup(&r->mem, own.text);
    MT_TRY(mt_arena_check(&r->mem, err));
    return mt_profiled_quadrature(r, out, err);
}

double mt_profiled_psd(const mt_profiled *s, int pair, double hz, double complex h)
{
    if (s->of != NULL) {
        return mt_vibration_respond_psd(s->v, &s->of[pair], hz);
    }
    const double size = cabs(h);
    return mt_vibration_density(s->v, hz) * size * size;
}
