/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/setting.h"

#include <string.h>

#include "base/text.h"
#include "model/values.h"

/* What texts are read with. */
typedef struct reading {
    const mt_model *model;
    const double *original;
    const char **names; /* [n_parameters] */
    mt_arena *mem;
} reading;

static mt_status unknown(const reading *r, const char *name, mt_err *err)
{
    const char *const nearest = mt_text_nearest(name, r->names, r->model->n_parameters);
    return nearest == NULL
               ? mt_fail(err, MT_E_USAGE, "unknown parameter \"%s\"", name)
               : mt_fail(err, MT_E_USAGE, "unknown parameter \"%s\"; did you mean \"%s\"?",
                         name, nearest);
}

static mt_status read_value(const reading *r, const char *text, double *out, mt_err *err)
{
    mt_expr e;
    MT_TRY(mt_expr_parse(text, mt_model_lookup, r->model, r->names, r->model->n_parameters,
                         r->mem, &e, err));
    return mt_model_expr_value(r->model, r->original, &e, r->mem, out, err);
}

/* The n settings before this one are read. */
static mt_status read_one(const reading *r, const char *text, int n, mt_setting *all,
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
        return unknown(r, name, err);
    }
    for (int i = 0; i < n; i++) {
        if (all[i].parameter == parameter) {
            return mt_fail(err, MT_E_USAGE, "parameter \"%s\" is set twice", name);
        }
    }
    double value = 0.0;
    const mt_status rc = read_value(r, equals + 1, &value, err);
    if (rc != MT_OK) {
        return mt_err_in(err, rc == MT_E_MEMORY ? rc : MT_E_USAGE, "%s", text);
    }
    all[n] = (mt_setting){parameter, value, r->original[parameter]};
    return MT_OK;
}

mt_status mt_model_read_settings(const mt_model *model, const double *original, int n,
                                 const char *const *texts, mt_arena *mem, mt_setting **out,
                                 mt_err *err)
{
    const size_t n_names = (size_t)model->n_parameters;
    const reading r = {model, original, mt_arena_alloc(mem, n_names, sizeof *r.names), mem};
    *out = mt_arena_alloc(mem, (size_t)n, sizeof **out);
    MT_TRY(mt_arena_check(mem, err));
    for (size_t i = 0; i < n_names; i++) {
        r.names[i] = model->parameters[i].name.s;
    }
    for (int i = 0; i < n; i++) {
        MT_TRY(read_one(&r, texts[i], i, *out, err));
    }
    return MT_OK;
}
