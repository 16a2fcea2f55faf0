/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/setting.h"

#include <string.h>

#include "base/text.h"
#include "model/values.h"

static mt_status refuse_unknown_parameter(const mt_typing *r, const char *name, mt_err *err)
{
    const char *const nearest = mt_text_nearest(name, r->names, r->model->n_parameters);
    return nearest == NULL
               ? mt_fail(err, MT_E_USAGE, "unknown parameter \"%s\"", name)
               : mt_fail(err, MT_E_USAGE, "unknown parameter \"%s\"; did you mean \"%s\"?",
                         name, nearest);
}

/* Alone, signed perhaps. */
static bool is_bare(const mt_expr *e)
{
    return e->code[0].op == MT_OP_CONST && e->code[0].param == (int)MT_KIND_NUMBER &&
           (e->length == 1 || (e->length == 2 && e->code[1].op == MT_OP_NEG));
}

mt_status mt_model_read_typed(const mt_typing *with, const char *text, const mt_unit *unit,
                              const mt_unit *judged, double *out, mt_err *err)
{
    const mt_model *const m = with->model;
    char complaint[MT_KIND_TEXT];
    mt_expr e;
    MT_TRY(mt_expr_parse(text, mt_model_lookup, m, with->names, m->n_parameters, with->mem, &e,
                         err));
    if (!is_bare(&e) &&
        mt_kind_complaint(&e, judged, mt_model_kind, m, complaint, sizeof complaint)) {
        return mt_fail(err, MT_E_USAGE, "%s", complaint);
    }
    MT_TRY(mt_model_expr_value(m, with->values, &e, with->mem, out, err));
    *out = is_bare(&e) ? mt_unit_to_si(unit, *out) : *out;
    return MT_OK;
}

mt_status mt_typing_new(const mt_model *model, const double *values, mt_arena *mem,
                        mt_typing *out, mt_err *err)
{
    const size_t n = (size_t)model->n_parameters;
    const char **const names = mt_arena_alloc(mem, n, sizeof *names);
    *out = (mt_typing){model, values, names, mem};
    MT_TRY(mt_arena_check(mem, err));
    for (size_t i = 0; i < n; i++) {
        names[i] = model->parameters[i].name.s;
    }
    return MT_OK;
}

/* The n settings before this one are read. */
static mt_status read_setting(const mt_typing *r, const char *text, int n, mt_setting *all,
                              mt_err *err)
{
    const char *const equals = strchr(text, '=');
    if (equals == NULL || equals == text) {
        return mt_fail(err, MT_E_USAGE, "\"%s\" is not NAME=VALUE", text);
    }
    const char *const name = mt_arena_strndup(r->mem, text, (size_t)(equals - text));
    MT_TRY(mt_arena_check(r->mem, err));
    const int parameter = mt_model_find_parameter(r->model, name);
    if (parameter == MT_ABSENT) {
        return refuse_unknown_parameter(r, name, err);
    }
    for (int i = 0; i < n; i++) {
        if (all[i].parameter == parameter) {
            return mt_fail(err, MT_E_USAGE, "parameter \"%s\" is set twice", name);
        }
    }
    double value = 0.0;
    const mt_status rc =
        mt_model_read_typed(r, equals + 1, r->model->parameters[parameter].written,
                            mt_model_number_unit(r->model, parameter), &value, err);
    if (rc != MT_OK) {
        return mt_err_in(err, rc == MT_E_MEMORY ? rc : MT_E_USAGE, "%s", text);
    }
    all[n] = (mt_setting){parameter, value, r->values[parameter]};
    return MT_OK;
}

mt_status mt_model_read_settings(const mt_model *model, const double *original, int n,
                                 const char *const *texts, mt_arena *mem, mt_setting **out,
                                 mt_err *err)
{
    mt_typing r;
    *out = mt_arena_alloc(mem, (size_t)n, sizeof **out);
    MT_TRY(mt_typing_new(model, original, mem, &r, err));
    for (int i = 0; i < n; i++) {
        MT_TRY(read_setting(&r, texts[i], i, *out, err));
    }
    return MT_OK;
}
