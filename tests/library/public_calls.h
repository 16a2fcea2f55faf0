/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every function of include/ called once, with one of its pointers NULL where asked for. */
#ifndef PUBLIC_CALLS_H
#define PUBLIC_CALLS_H

#include "modetune/answers.h"
#include "modetune/dynamics.h"
#include "modetune/mechanism.h"
#include "modetune/model.h"
#include "modetune/motion.h"
#include "modetune/profile.h"
#include "modetune/read.h"
#include "modetune/study.h"
#include "modetune/version.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/base.h"
#include "mt_test.h"

#define MODEL MT_TEST_SOURCE_DIR "/tests/models/pendulum.json"
#define PENDULUM_TEXT                                                                      \
    "{\"format\": \"modetune-model/1\", \"dimension\": 2, \"bodies\": [{\"name\": \"a\", " \
    "\"mass_kg\": 1, \"inertia_kg_m2\": 1, \"centre\": [0, 0]}]}"
#define PROFILE MT_TEST_SOURCE_DIR "/problems/profiles/gevs_qualification.json"
#define STUDY   MT_TEST_SOURCE_DIR "/tests/install/pendulum_study.json"

/* What the calls need, made once. */
static mt_model *model;
static mt_study *study;
static mt_result *result;
static const char configuration[] = "hanging";
static const char parameter[] = "L";
static mt_mechanism *mechanism;
static mt_diagnostics *list;
static mt_diagnostics *wrong; /* of a file that is */
static mt_err said;
static const double one[1] = {1.0};
static int finish = MT_STOP_REQUEST_FINISH;

/* Argument number k of a call where pointer number `null` is to be NULL. */
#define ARG(k, pointer) (null == (k) ? NULL : (pointer))
/* An answer, or nothing, as a status: what is not there is MT_E_USAGE. */
#define ANSWER(is) ((is) ? MT_OK : MT_E_USAGE)
#define GIVES(name, call)                  \
    static mt_status call_##name(int null) \
    {                                      \
        return call;                       \
    }
#define TELLS(name, is)                    \
    static mt_status call_##name(int null) \
    {                                      \
        return ANSWER(is);                 \
    }
/* The functions that take a format, as if they took any text: the compiler refuses NULL
 * there. */
static mt_status (*volatile any_fail)(mt_err *err, mt_status code, const char *fmt,
                                      ...) = mt_fail;
static mt_status (*volatile any_err_in)(mt_err *err, mt_status rc, const char *fmt,
                                        ...) = mt_err_in;

static mt_status call_status_text(int null)
{
    (void)null;
    return ANSWER(strcmp(mt_status_text(MT_E_MEMORY), "out of memory") == 0 &&
                  mt_status_text((mt_status)-1) != NULL);
}

static mt_status call_status_name(int null)
{
    (void)null;
    return ANSWER(strcmp(mt_status_name(MT_OK), "MT_OK") == 0 &&
                  mt_status_name(MT_STATUS_COUNT) != NULL);
}

TELLS(fail, any_fail(ARG(0, &said), MT_E_INPUT, ARG(1, "text")) == MT_E_INPUT)
static mt_status call_err_in(int null)
{
    said.text[0] = '\0';
    return ANSWER(any_err_in(ARG(0, &said), MT_E_INPUT, ARG(1, "text")) == MT_E_INPUT);
}

static mt_status call_version(int null)
{
    (void)null;
    return ANSWER(strcmp(mt_version(), MT_VERSION_STRING) == 0);
}

static mt_status call_diagnostics_new(int null)
{
    mt_diagnostics *out = null == 0 ? list : NULL;
    const mt_status rc = mt_diagnostics_new(ARG(0, &out), ARG(1, &said));
    mt_diagnostics_delete(null == 0 ? NULL : out);
    return rc;
}

static mt_status call_diagnostics_delete(int null)
{
    mt_diagnostics *own = NULL;
    const mt_status rc = mt_diagnostics_new(&own, &said);
    mt_diagnostics_delete(ARG(0, own));
    if (null == 0) {
        mt_diagnostics_delete(own);
    }
    return rc;
}

TELLS(diagnostics_count, mt_diagnostics_count(ARG(0, wrong)) > 0)
TELLS(diagnostics_left_out, mt_diagnostics_left_out(ARG(0, wrong)) == 0)
TELLS(diagnostics_severity, (int)mt_diagnostics_severity(ARG(0, wrong), 0) != MT_SEVERITY_COUNT)
TELLS(diagnostics_file, mt_diagnostics_file(ARG(0, wrong), 0) != NULL)
TELLS(diagnostics_line, mt_diagnostics_line(ARG(0, wrong), 0) > 0)
TELLS(diagnostics_column, mt_diagnostics_column(ARG(0, wrong), 0) > 0)
TELLS(diagnostics_pointer, mt_diagnostics_pointer(ARG(0, wrong), 0) != NULL)
TELLS(diagnostics_message, mt_diagnostics_message(ARG(0, wrong), 0) != NULL)
TELLS(diagnostics_text, mt_diagnostics_text(ARG(0, wrong)) != NULL)
static mt_status call_model_read(int null)
{
    mt_model *out = null == 0 ? model : NULL; /* must become NULL */
    const mt_read_options opt = {.size = sizeof opt, .diagnostics = list};
    const mt_status rc =
        mt_model_read(ARG(0, MODEL), ARG(1, &opt), ARG(2, &out), ARG(3, &said));
    const bool owned = out != NULL;
    mt_model_delete(out);
    return rc == MT_OK || !owned ? rc : MT_E_INTERNAL;
}

static mt_status call_model_delete(int null)
{
    mt_model *own = NULL;
    const mt_status rc = mt_model_read(MODEL, NULL, &own, &said);
    mt_model_delete(ARG(0, own));
    if (null == 0) {
        mt_model_delete(own);
    }
    return rc;
}

TELLS(model_title, mt_model_title(ARG(0, model)) != NULL)
TELLS(model_dimension, mt_model_dimension(ARG(0, model)) == 2)
TELLS(model_parameter_count, mt_model_parameter_count(ARG(0, model)) > 0)
TELLS(model_parameter_name, mt_model_parameter_name(ARG(0, model), 0) != NULL)
TELLS(model_parameter_unit, mt_model_parameter_unit(ARG(0, model), 0) != NULL)
TELLS(model_parameter_follows, mt_model_parameter_follows(ARG(0, model), 0) == 0)
TELLS(model_configuration_count, mt_model_configuration_count(ARG(0, model)) > 0)
TELLS(model_configuration_name, mt_model_configuration_name(ARG(0, model), 0) != NULL)
static mt_status call_mechanism_new(int null)
{
    mt_mechanism *out = null == 0 ? mechanism : NULL;
    const char *const names[] = {parameter};
    const mt_status rc = mt_mechanism_new(ARG(0, model), ARG(1, configuration), 1,
                                          ARG(2, names), ARG(3, &out), ARG(4, &said));
    const bool owned = out != NULL;
    mt_mechanism_delete(out);
    return rc == MT_OK || !owned ? rc : MT_E_INTERNAL;
}

static mt_status call_mechanism_delete(int null)
{
    mt_mechanism *own = NULL;
    const mt_status rc = mt_mechanism_new(model, configuration, 0, NULL, &own, &said);
    mt_mechanism_delete(ARG(0, own));
    if (null == 0) {
        mt_mechanism_delete(own);
    }
    return rc;
}

static mt_status call_mechanism_evaluate(int null)
{
    return mt_mechanism_evaluate(ARG(0, mechanism), ARG(1, one), ARG(2, &said));
}

TELLS(mechanism_value, isfinite(mt_mechanism_value(ARG(0, mechanism), ARG(1, parameter))))
TELLS(mechanism_vibration_modes, mt_mechanism_vibration_modes(ARG(0, mechanism)) == 1)
TELLS(mechanism_rigid_body_modes, mt_mechanism_rigid_body_modes(ARG(0, mechanism)) == 0)
TELLS(mechanism_unstable_modes, mt_mechanism_unstable_modes(ARG(0, mechanism)) == 0)
TELLS(mechanism_undecided_modes, mt_mechanism_undecided_modes(ARG(0, mechanism)) == 0)
TELLS(mechanism_hz, isfinite(mt_mechanism_hz(ARG(0, mechanism), 1)))
TELLS(mechanism_error_hz, isfinite(mt_mechanism_error_hz(ARG(0, mechanism), 1)))
TELLS(mechanism_multiplicity, mt_mechanism_multiplicity(ARG(0, mechanism), 1) == 1)
TELLS(mechanism_channels, mt_mechanism_channels(ARG(0, mechanism)) > 0)
TELLS(mechanism_channel, mt_mechanism_channel(ARG(0, mechanism), 0) != NULL)
static mt_status call_mechanism_shape(int null)
{
    double shape[8];
    return mt_mechanism_shape(ARG(0, mechanism), 1, ARG(1, shape), ARG(2, &said));
}

static mt_status call_mechanism_mac(int null)
{
    double mac[1];
    return mt_mechanism_mac(ARG(0, mechanism), 1, ARG(1, mechanism), 1, ARG(2, mac),
                            ARG(3, &said));
}

static double part[8];
GIVES(mechanism_sensitivities,
      mt_mechanism_sensitivities(ARG(0, mechanism), 1, ARG(1, part), ARG(2, &said)))
static const mt_ports ports = {.n_inputs = 1, .inputs = (const char *const[]){"base.x"}};
GIVES(mechanism_response,
      mt_mechanism_response(ARG(0, mechanism), ARG(1, &ports), 1, ARG(2, one), ARG(3, part),
                            ARG(4, part), ARG(5, part), ARG(6, &said)))
GIVES(mechanism_response_slopes,
      mt_mechanism_response_slopes(ARG(0, mechanism), ARG(1, &ports), 0.25, ARG(2, part),
                                   ARG(3, part), ARG(4, &said)))
static mt_vibration *profile;
static mt_status call_vibration_read(int null)
{
    mt_vibration *out = null == 0 ? profile : NULL; /* must become NULL */
    const mt_read_options opt = {.size = sizeof opt, .diagnostics = list};
    const mt_status rc =
        mt_vibration_read(ARG(0, PROFILE), ARG(1, &opt), ARG(2, &out), ARG(3, &said));
    const bool owned = out != NULL;
    mt_vibration_delete(out);
    return rc == MT_OK || !owned ? rc : MT_E_INTERNAL;
}

static mt_status call_vibration_delete(int null)
{
    mt_vibration *own = NULL;
    const mt_status rc = mt_vibration_read(PROFILE, NULL, &own, &said);
    mt_vibration_delete(ARG(0, own));
    if (null == 0) {
        mt_vibration_delete(own);
    }
    return rc;
}

TELLS(vibration_rms, isfinite(mt_vibration_rms(ARG(0, profile))))
static mt_vibration_answer forced_response[8];
GIVES(mechanism_vibration,
      mt_mechanism_vibration(ARG(0, mechanism), ARG(1, &ports), ARG(2, profile), 8,
                             ARG(3, forced_response), ARG(4, &said)))
static const mt_motion_options moves = {
    .size = sizeof moves, .duration_s = 0.01, .sample_s = 0.01};
static const char *const seen[] = {"pivot"};
static mt_motion_told told;
GIVES(mechanism_motion, mt_mechanism_motion(ARG(0, mechanism), ARG(1, &moves), 1, ARG(2, seen),
                                            8, ARG(3, part), ARG(4, &told), ARG(5, &said)))
/* A question of a model, whose text is given back. */
#define ASKS(name, options, call)                                   \
    static mt_status call_model_##name(int null)                    \
    {                                                               \
        const mt_##name##_options opt = options;                    \
        char *out = NULL;                                           \
        const mt_status rc = call;                                  \
        mt_string_delete(out);                                      \
        return (rc == MT_OK) == (out != NULL) ? rc : MT_E_INTERNAL; \
    }
#define OPTIONS(...)                    \
    {                                   \
        .size = sizeof opt, __VA_ARGS__ \
    }
static const char *const shaking[] = {"base.x"};
static const char *const drives[] = {"pivot=0:0.1:2"};
ASKS(modes, OPTIONS(.shapes = 1),
     mt_model_modes(ARG(0, model), ARG(1, &opt), ARG(2, &out), ARG(3, &said)))
ASKS(mac, OPTIONS(.configuration_a = configuration, .configuration_b = configuration),
     mt_model_mac(ARG(0, model), ARG(1, model), ARG(2, &opt), ARG(3, &out), ARG(4, &said)))
ASKS(sensitivity, OPTIONS(.parameters = parameter),
     mt_model_sensitivity(ARG(0, model), ARG(1, &opt), ARG(2, &out), ARG(3, &said)))
ASKS(response, OPTIONS(.n_inputs = 1, .inputs = shaking),
     mt_model_response(ARG(0, model), ARG(1, &opt), ARG(2, &out), ARG(3, &said)))
ASKS(sweep, OPTIONS(.drives = drives, .n_drives = 1),
     mt_model_sweep(ARG(0, model), ARG(1, &opt), ARG(2, &out), ARG(3, &said)))
static mt_status call_study_read(int null)
{
    mt_study *out = null == 0 ? study : NULL;
    const mt_read_options opt = {.size = sizeof opt, .diagnostics = list};
    const mt_status rc =
        mt_study_read(ARG(0, STUDY), ARG(1, &opt), ARG(2, &out), ARG(3, &said));
    const bool owned = out != NULL;
    mt_study_delete(out);
    return rc == MT_OK || !owned ? rc : MT_E_INTERNAL;
}

static mt_status call_study_delete(int null)
{
    mt_study *own = NULL;
    const mt_status rc = mt_study_read(STUDY, NULL, &own, &said);
    mt_study_delete(ARG(0, own));
    if (null == 0) {
        mt_study_delete(own);
    }
    return rc;
}

TELLS(study_title, mt_study_title(ARG(0, study)) != NULL)
TELLS(study_model, mt_study_model(ARG(0, study)) != NULL)
TELLS(study_variable_count, mt_study_variable_count(ARG(0, study)) == 1)
TELLS(study_variable_name, mt_study_variable_name(ARG(0, study), 0) != NULL)
TELLS(study_variable_original, isfinite(mt_study_variable_original(ARG(0, study), 0)))
TELLS(study_variable_lower, isfinite(mt_study_variable_lower(ARG(0, study), 0)))
TELLS(study_variable_upper, isfinite(mt_study_variable_upper(ARG(0, study), 0)))
TELLS(stop_request_at, mt_stop_request_at(ARG(0, &finish)) ==
                           (null == 0 ? MT_STOP_REQUEST_NONE : MT_STOP_REQUEST_FINISH))
static mt_status call_study_solve(int null)
{
    mt_result *out = null == 0 ? result : NULL;
    const mt_solve_options opt = {.size = sizeof opt};
    const mt_status rc =
        mt_study_solve(ARG(0, study), ARG(1, &opt), ARG(2, &out), ARG(3, &said));
    const bool owned = out != NULL;
    mt_result_delete(out);
    return rc == MT_OK || !owned ? rc : MT_E_INTERNAL;
}

static mt_status call_result_delete(int null)
{
    mt_result *own = NULL;
    const mt_status rc = mt_study_solve(study, NULL, &own, &said);
    mt_result_delete(ARG(0, own));
    if (null == 0) {
        mt_result_delete(own);
    }
    return rc;
}

static mt_status call_result_outcome(int null)
{
    const mt_result_status status = mt_result_outcome(ARG(0, result));
    return ANSWER(status != MT_RESULT_STATUS_COUNT);
}

static mt_status call_result_status_name(int null)
{
    (void)null;
    return ANSWER(strcmp(mt_result_status_name(MT_RESULT_SOLVED), "solved") == 0 &&
                  mt_result_status_name(MT_RESULT_STATUS_COUNT) != NULL);
}

TELLS(result_summary, mt_result_summary(ARG(0, result)) != NULL)
TELLS(result_recommendations, mt_result_recommendations(ARG(0, result)) > 0)
TELLS(result_feasible, mt_result_feasible(ARG(0, result), 1) != 0)
TELLS(result_value, isfinite(mt_result_value(ARG(0, result), 1, ARG(1, "L"))))
TELLS(result_hz, isfinite(mt_result_hz(ARG(0, result), 1, ARG(1, configuration), 1)))
TELLS(result_reasons, mt_result_reasons(ARG(0, result), 1) > 0)
TELLS(result_reason, mt_result_reason(ARG(0, result), 1, 0) != NULL)
static mt_status call_string_delete(int null)
{
    char *own = NULL;
    const mt_status rc = mt_result_json(result, &own, &said);
    mt_string_delete(ARG(0, own));
    if (null == 0) {
        mt_string_delete(own);
    }
    return rc;
}

static mt_status call_solve_json(int null)
{
    static const char text[] =
        "{\"format\": \"modetune-study/1\", \"model\": \"m.json\", \"goals\": []}";
    const mt_file_text file = {"m.json", PENDULUM_TEXT};
    const mt_read_options read = {.size = sizeof read, .files = &file, .n_files = 1};
    const mt_solve_options solve = {.size = sizeof solve};
    char *out = NULL;
    /* without options the model is looked for on the disk, where it is not */
    const mt_status rc =
        mt_solve_json(ARG(0, text), ARG(1, &read), ARG(2, &solve), ARG(3, &out), ARG(4, &said));
    const bool owned = out != NULL;
    mt_string_delete(out);
    return (rc == MT_OK) != owned ? MT_E_INTERNAL : null == 1 && rc == MT_E_INPUT ? MT_OK : rc;
}

static mt_status call_result_json(int null)
{
    char *out = NULL;
    const mt_status rc = mt_result_json(ARG(0, result), ARG(1, &out), ARG(2, &said));
    const bool owned = out != NULL;
    mt_string_delete(out);
    return null < 0 && !owned ? MT_E_INTERNAL : rc;
}

static mt_status call_result_read(int null)
{
    char *text = NULL;
    MT_TRY(mt_result_json(result, &text, &said));
    const mt_file_text file = {"r.json", text};
    const mt_read_options opt = {.size = sizeof opt, .files = &file, .n_files = 1};
    mt_result *out = null == 2 ? result : NULL;
    /* without options it is looked for on the disk, where it is not */
    const mt_status rc =
        mt_result_read(ARG(0, "r.json"), ARG(1, &opt), ARG(2, &out), ARG(3, &said));
    const bool owned = out != NULL && null != 2;
    if (null != 2) {
        mt_result_delete(out);
    }
    mt_string_delete(text);
    return (rc == MT_OK) != owned ? MT_E_INTERNAL : null == 1 && rc == MT_E_SYSTEM ? MT_OK : rc;
}

static mt_status call_result_html(int null)
{
    char *out = NULL;
    const mt_status rc = mt_result_html(ARG(0, result), ARG(1, &out), ARG(2, &said));
    const bool owned = out != NULL;
    mt_string_delete(out);
    return null < 0 && !owned ? MT_E_INTERNAL : rc;
}

static mt_status call_result_page(int null)
{
    char *out = NULL;
    const mt_status rc =
        mt_result_page(ARG(0, result), ARG(1, model), ARG(2, &out), ARG(3, &said));
    const bool owned = out != NULL;
    mt_string_delete(out);
    return null < 0 && !owned ? MT_E_INTERNAL : rc;
}

static mt_status call_result_model(int null)
{
    /* of a result that lies nowhere there is no model */
    mt_model *out = NULL;
    const mt_read_options opt = {.size = sizeof opt, .root = "/nowhere"};
    const mt_status rc = mt_result_model(ARG(0, result), ARG(1, "r.json"), ARG(2, &opt),
                                         ARG(3, &out), ARG(4, &said));
    const bool owned = out != NULL;
    mt_model_delete(out);
    return null < 0 && owned ? MT_E_INTERNAL : rc;
}

static mt_status call_udwadia_kalaba(int null)
{
    double xdd[1];
    return mt_udwadia_kalaba(1, 1, ARG(0, one), ARG(1, one), ARG(2, one), ARG(3, one),
                             ARG(4, xdd), ARG(5, &said));
}

static mt_status call_udwadia_phohomsiri(int null)
{
    double xdd[1];
    return mt_udwadia_phohomsiri(1, 1, ARG(0, one), ARG(1, one), ARG(2, one), ARG(3, one),
                                 ARG(4, xdd), ARG(5, &said));
}

#endif
