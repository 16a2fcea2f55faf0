/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Questions about a model for users of the library: the records of the commands as JSON. */
#include "modetune/answers.h"

#include <stdbool.h>
#include <stdlib.h>

#include "base/base.h"
#include "base/text.h"
#include "inspect/mac.h"
#include "inspect/modes.h"
#include "inspect/response.h"
#include "inspect/sensitivity.h"
#include "inspect/sweep.h"
#include "result/write.h"

/* Texts of options, whose numbers and pointers have to agree. */
static mt_status check_texts(const char *what, int n, const char *const *texts, mt_err *err)
{
    if (n < 0) {
        return mt_fail(err, MT_E_USAGE, "n_%s of the options is negative", what);
    }
    for (int i = 0; i < n; i++) {
        if (texts == NULL || texts[i] == NULL) {
            return mt_fail(err, MT_E_USAGE, "%s[%d] of the options is NULL", what, i);
        }
    }
    return MT_OK;
}

static mt_status check_count(const char *what, int count, mt_err *err)
{
    return count < 0 ? mt_fail(err, MT_E_USAGE, "%s of the options is negative", what) : MT_OK;
}

/* s zeroed before; mt_loaded_model_free in any case. */
static mt_status open_model(const mt_model *model, const char *configuration, int n_sets,
                            const char *const *sets, mt_loaded_model *s, mt_err *err)
{
    MT_TRY(check_texts("sets", n_sets, sets, err));
    MT_TRY(mt_arena_init(&s->mem, 0, err));
    s->model = model;
    s->path = model->path == NULL ? "model" : model->path;
    return mt_loaded_model_choose(s, configuration, n_sets, sets, err);
}

/* What is written, as a text of its own. */
static mt_status give_json(mt_status rc, mt_json_writer *w, mt_text *out, char **json,
                           mt_err *err)
{
    if (rc == MT_OK && !mt_json_done(w)) {
        rc = w->misused ? mt_fail(err, MT_E_INTERNAL, "the answer cannot be written as JSON")
                        : mt_fail_memory(err);
    }
    rc = rc == MT_OK && out->failed ? mt_fail_memory(err) : rc;
    if (rc != MT_OK) {
        mt_text_free(out);
        return rc;
    }
    *json = out->s; /* from malloc */
    return MT_OK;
}

/* Answers for one configuration. */
typedef mt_status (*put_one)(const void *question, mt_loaded_model *s, int c, mt_json_writer *w,
                             mt_err *err);

/* The answer of the named configuration, or a list of all. */
static mt_status put_each(const void *question, put_one put, const char *configuration,
                          mt_loaded_model *s, mt_json_writer *w, mt_err *err)
{
    if (configuration != NULL) {
        return put(question, s, s->configurations[0], w, err);
    }
    mt_json_open(w, NULL, '[');
    for (int i = 0; i < s->n_configurations; i++) {
        mt_err own = {.code = MT_OK};
        const mt_status rc = put(question, s, s->configurations[i], w, &own);
        if (rc == MT_E_MEMORY || rc == MT_E_INTERNAL) {
            return mt_fail(err, rc, "%s", own.text);
        }
        if (rc != MT_OK) {
            const mt_failed_row row = {mt_loaded_model_configuration(s, s->configurations[i]),
                                       own.text};
            mt_record_put_object(w, NULL, &mt_failed_record, &row, 0, NULL);
        }
    }
    mt_json_close(w);
    return MT_OK;
}

/* Modes. */

static mt_status put_modes(const void *question, mt_loaded_model *s, int c, mt_json_writer *w,
                           mt_err *err)
{
    mt_modes_view v = {.s = NULL};
    mt_status rc = mt_modes_view_take(s, c, question, &v, err);
    rc = rc == MT_OK ? mt_modes_put(&v, w, err) : rc;
    mt_modes_view_free(&v);
    return rc;
}

mt_status mt_model_modes(const mt_model *model, const mt_modes_options *options, char **json,
                         mt_err *err)
{
    mt_modes_options own;
    mt_loaded_model s = {.model = NULL};
    mt_text out = {.s = NULL};
    mt_json_writer w = mt_json_writer_default(&out);
    MT_NOT_NULL(json, err);
    *json = NULL;
    MT_NOT_NULL(model, err);
    MT_TRY(MT_OPTIONS_TAKE(options, &own, err));
    MT_TRY(mt_err_in(err, check_count("count", own.count, err), "%s", __func__));
    mt_modes_question question = {.count = own.count > 0 ? own.count : MT_MODES_DEFAULT,
                                  .shapes = own.shapes != 0,
                                  .damped = own.damped != 0,
                                  .effective_mass = own.effective_mass != 0,
                                  .energy = own.energy != 0,
                                  .energies = {own.energy_about, own.energy_axes}};
    for (int k = 0; own.about_m != NULL && k < MT_COUNT(question.about_m); k++) {
        question.about_m[k] = own.about_m[k];
    }
    mt_status rc = open_model(model, own.configuration, own.n_sets, own.sets, &s, err);
    rc = rc == MT_OK ? put_each(&question, put_modes, own.configuration, &s, &w, err) : rc;
    mt_loaded_model_free(&s);
    return give_json(rc, &w, &out, json, err);
}

/* Correlation. */

/* One side, of one configuration. */
static mt_status open_side(const mt_model *model, const char *configuration,
                           const mt_mac_options *opt, mt_loaded_model *s, mt_err *err)
{
    MT_TRY(open_model(model, configuration, opt->n_sets, opt->sets, s, err));
    return s->n_configurations == 1
               ? MT_OK
               : mt_fail(err, MT_E_USAGE, "\"%s\" has %d configurations: name one", s->path,
                         s->n_configurations);
}

mt_status mt_model_mac(const mt_model *a, const mt_model *b, const mt_mac_options *options,
                       char **json, mt_err *err)
{
    mt_mac_options own;
    mt_mac_view v = {.ns = 0};
    mt_text out = {.s = NULL};
    mt_json_writer w = mt_json_writer_default(&out);
    MT_NOT_NULL(json, err);
    *json = NULL;
    MT_NOT_NULL(a, err);
    MT_NOT_NULL(b, err);
    MT_TRY(MT_OPTIONS_TAKE(options, &own, err));
    MT_TRY(mt_err_in(err, check_count("count", own.count, err), "%s", __func__));
    mt_status rc = open_side(a, own.configuration_a, &own, &v.a.s, err);
    rc = rc == MT_OK ? open_side(b, own.configuration_b, &own, &v.b.s, err) : rc;
    rc = rc == MT_OK ? mt_mac_view_take(&v, own.count, err) : rc;
    if (rc == MT_OK) {
        mt_mac_put(&v, &w);
    }
    mt_mac_view_free(&v);
    mt_loaded_model_free(&v.a.s);
    mt_loaded_model_free(&v.b.s);
    return give_json(rc, &w, &out, json, err);
}

/* Sensitivities. */

static mt_status put_sensitivity(const void *question, mt_loaded_model *s, int c,
                                 mt_json_writer *w, mt_err *err)
{
    mt_sensitivity_view v = {.s = NULL};
    mt_status rc = mt_sensitivity_view_take(s, c, question, &v, err);
    rc = rc == MT_OK ? mt_sensitivity_put(&v, w, err) : rc;
    mt_sensitivity_view_free(&v);
    return rc;
}

mt_status mt_model_sensitivity(const mt_model *model, const mt_sensitivity_options *options,
                               char **json, mt_err *err)
{
    mt_sensitivity_options own;
    mt_loaded_model s = {.model = NULL};
    mt_text out = {.s = NULL};
    mt_json_writer w = mt_json_writer_default(&out);
    MT_NOT_NULL(json, err);
    *json = NULL;
    MT_NOT_NULL(model, err);
    MT_TRY(MT_OPTIONS_TAKE(options, &own, err));
    MT_TRY(mt_err_in(err, check_count("count", own.count, err), "%s", __func__));
    const mt_sensitivity_question question = {.parameters = own.parameters,
                                              .modes = own.count > 0 ? own.count
                                                                     : MT_SENSITIVITY_MODES};
    mt_status rc = open_model(model, own.configuration, own.n_sets, own.sets, &s, err);
    rc = rc == MT_OK ? mt_sensitivity_question_admit(&s, &question, err) : rc;
    rc =
        rc == MT_OK ? put_each(&question, put_sensitivity, own.configuration, &s, &w, err) : rc;
    mt_loaded_model_free(&s);
    return give_json(rc, &w, &out, json, err);
}

/* Responses. */

static mt_status put_response(const void *question, mt_loaded_model *s, int c,
                              mt_json_writer *w, mt_err *err)
{
    mt_response_view v = {.question = NULL};
    mt_status rc = mt_response_view_take(s, c, question, &v, err);
    rc = rc == MT_OK ? mt_response_put(&v, w, err) : rc;
    mt_response_view_free(&v);
    return rc;
}

static mt_status check_response(const mt_response_options *opt, mt_err *err)
{
    MT_TRY(check_texts("inputs", opt->n_inputs, opt->inputs, err));
    MT_TRY(check_texts("outputs", opt->n_outputs, opt->outputs, err));
    MT_TRY(check_count("points", opt->points, err));
    return check_count("keep", opt->keep, err);
}

mt_status mt_model_response(const mt_model *model, const mt_response_options *options,
                            char **json, mt_err *err)
{
    mt_response_options own;
    mt_loaded_model s = {.model = NULL};
    mt_text out = {.s = NULL};
    mt_json_writer w = mt_json_writer_default(&out);
    MT_NOT_NULL(json, err);
    *json = NULL;
    MT_NOT_NULL(model, err);
    MT_TRY(MT_OPTIONS_TAKE(options, &own, err));
    MT_TRY(mt_err_in(err, check_response(&own, err), "%s", __func__));
    const mt_response_question question = {.n_inputs = own.n_inputs,
                                           .inputs = own.inputs,
                                           .n_outputs = own.n_outputs,
                                           .outputs = own.outputs,
                                           .from = own.from,
                                           .to = own.to,
                                           .points = own.points,
                                           .log = own.log != 0,
                                           .keep = own.keep,
                                           .direct = own.direct != 0,
                                           .poles = own.poles != 0,
                                           .state_space = own.state_space != 0,
                                           .parameters = own.parameters,
                                           .profile = own.vibration};
    MT_TRY(mt_response_question_admit(&question, err));
    mt_status rc = open_model(model, own.configuration, own.n_sets, own.sets, &s, err);
    rc = rc == MT_OK ? put_each(&question, put_response, own.configuration, &s, &w, err) : rc;
    mt_loaded_model_free(&s);
    return give_json(rc, &w, &out, json, err);
}

/* Positions. */

static mt_status put_sweep(const void *question, mt_loaded_model *s, int c, mt_json_writer *w,
                           mt_err *err)
{
    mt_sweep_view v = {.question = NULL};
    mt_status rc = mt_sweep_view_take(s, c, question, &v, err);
    if (rc != MT_OK && rc != MT_E_USAGE) {
        (void)mt_err_in(err, rc, "%s", s->path);
    }
    rc = rc == MT_OK ? mt_sweep_put(&v, w, err) : rc;
    mt_sweep_view_free(&v);
    return rc;
}

static mt_status check_sweep(const mt_sweep_options *opt, mt_err *err)
{
    MT_TRY(check_texts("drives", opt->n_drives, opt->drives, err));
    MT_TRY(check_texts("holds", opt->n_holds, opt->holds, err));
    return check_count("count", opt->count, err);
}

mt_status mt_model_sweep(const mt_model *model, const mt_sweep_options *options, char **json,
                         mt_err *err)
{
    mt_sweep_options own;
    mt_loaded_model s = {.model = NULL};
    mt_text out = {.s = NULL};
    mt_json_writer w = mt_json_writer_default(&out);
    mt_sweep_question question = {.n = 0};
    MT_NOT_NULL(json, err);
    *json = NULL;
    MT_NOT_NULL(model, err);
    MT_TRY(MT_OPTIONS_TAKE(options, &own, err));
    MT_TRY(mt_err_in(err, check_sweep(&own, err), "%s", __func__));
    mt_status rc = open_model(model, own.configuration, own.n_sets, own.sets, &s, err);
    const mt_sweep_texts texts = {.n_drives = own.n_drives,
                                  .drives = own.drives,
                                  .n_holds = own.n_holds,
                                  .holds = own.holds,
                                  .grid = own.grid != 0};
    rc = rc == MT_OK ? mt_sweep_question_read(&s, &texts, &question, err) : rc;
    if (own.frequencies != 0) {
        question.modes = own.count > 0 ? own.count : MT_SWEEP_MODES;
    }
    rc = rc == MT_OK ? put_each(&question, put_sweep, own.configuration, &s, &w, err) : rc;
    mt_loaded_model_free(&s);
    return give_json(rc, &w, &out, json, err);
}
