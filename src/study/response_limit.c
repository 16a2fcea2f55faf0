/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Goals about ports: forced vibration between them, what there is at rest, and the responses
 * that results show. The profile is a file beside the study or one that is part of the program.
 * Names of ports are looked up where the mechanism is known (response/ports.h); their units
 * follow from the names alone.
 */
#include "study/response_limit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "environment/aircraft.h"
#include "io/file.h"
#include "study/check.h"
#include "study/reader.h"

const char *const mt_response_limit_names[MT_RESPONSE_LIMIT_QUANTITIES] = {"response", "rms",
                                                                           "sine", "peak"};

static mt_response_limit new_limit(mt_response_limit_quantity quantity)
{
    return (mt_response_limit){.lower_hz = nan(""),
                               .upper_hz = nan(""),
                               .quantity = quantity,
                               .unit = "",
                               .measurement = MT_ABSENT};
}

/* Profiles */

static const char SHIPPED[] = "problems/profiles/";
static const char ENDING[] = ".json";
static const char AIRCRAFT[] = "problems/aircraft.json";

/* True where the text is a name, not a path, of a profile built into the program, and no such
 * file exists. */
static bool is_shipped(const mt_study_reader *s, const char *name, const char *file)
{
    return strpbrk(name, "/.") == NULL && mt_files_lack(&s->files.files, file);
}

/* The built-in profile of that name; NULL: none (noted, with the nearest). */
static const mt_shipped *shipped(mt_study_reader *s, mt_name name)
{
    const char *const path = mt_arena_printf(s->r.mem, "%s%s%s", SHIPPED, name.s, ENDING);
    const mt_shipped *const own = path == NULL ? NULL : mt_shipped_find(path);
    int n = 0;
    int n_names = 0;
    const mt_shipped *const all = mt_shipped_all(&n);
    const char **const names = mt_arena_alloc(s->r.mem, (size_t)n, sizeof *names);
    if (own != NULL) {
        return own;
    }
    for (int i = 0; i < n && names != NULL; i++) {
        if (strncmp(all[i].path, SHIPPED, strlen(SHIPPED)) == 0) {
            const char *const file = all[i].path + strlen(SHIPPED);
            names[n_names++] = mt_arena_strndup(s->r.mem, file, strlen(file) - strlen(ENDING));
        }
    }
    if (names == NULL || mt_arena_failed(s->r.mem)) {
        return NULL;
    }
    const char *const near = mt_text_nearest(name.s, names, n_names);
    if (near == NULL) {
        mt_diag_error(s->r.diags, name.addr,
                      "there is no file \"%s\", and no profile of the program is called so: "
                      "\"modetune profile\" lists them",
                      name.s);
    } else {
        mt_diag_error(
            s->r.diags, name.addr,
            "there is no file \"%s\", and no profile of the program is called so; did "
            "you mean \"%s\"?",
            name.s, near);
    }
    return NULL;
}

static void note_input(mt_study_reader *s, const char *name, const char *sha256)
{
    for (int i = 0; i < s->study->n_inputs; i++) {
        if (strcmp(s->study->inputs[i].name, name) == 0) {
            return; /* the catalogue of several profiles */
        }
    }
    mt_read_study_note_input(s, name, sha256);
}

/* The profile, and the catalogue of aircraft that its rotors are in; `own`: both are part of
 * the program. */
static void note_inputs(mt_study_reader *s, const char *profile, bool own,
                        const mt_vibration *v)
{
    const char *const catalogue = own ? mt_aircraft_own_name : v->aircraft_name;
    char *const file = own ? mt_arena_printf(s->r.mem, "profile %s of modetune", profile)
                           : mt_arena_strdup(s->r.mem, profile);
    if (file == NULL) {
        return;
    }
    note_input(s, file, v->sha256);
    if (v->aircraft_name == NULL) {
        return;
    }
    if (catalogue == mt_aircraft_own_name) {
        note_input(s, catalogue, v->aircraft.sha256);
        return;
    }
    char *const joined = mt_file_join(profile, catalogue);
    if (joined == NULL) {
        mt_arena_fail(s->r.mem);
        return;
    }
    note_input(s, joined, v->aircraft.sha256);
    free(joined);
}

/* From a file, or from the texts that are given in opt. */
static mt_vibration *load_from(mt_study_reader *s, mt_name name, const char *path, bool own,
                               const mt_io_options *opt)
{
    const int told = s->model_messages->count;
    mt_vibration *v = NULL;
    mt_err why = {.code = MT_OK};
    const mt_status rc = mt_vibration_load_within(path, opt, &v, s->model_messages, &why);
    if (rc == MT_OK) {
        note_inputs(s, name.s, own, v);
    } else {
        mt_read_study_note_failure(s, name, path, rc, &why, s->model_messages->count > told);
    }
    return v;
}

static mt_vibration *load_limit_profile(mt_study_reader *s, mt_name name)
{
    char *const joined = mt_file_join(s->study->path, name.s);
    mt_vibration *v = NULL;
    if (joined == NULL) {
        mt_arena_fail(s->r.mem);
        return NULL;
    }
    if (!is_shipped(s, name.s, joined)) {
        v = load_from(s, name, joined, false, &s->files);
    } else {
        const mt_shipped *const own = shipped(s, name);
        const mt_shipped *const aircraft = mt_shipped_find(AIRCRAFT);
        mt_io_options opt = s->files;
        if (own != NULL) {
            const mt_file_text texts[] = {{.path = own->path, .text = own->bytes},
                                          {.path = aircraft->path, .text = aircraft->bytes}};
            opt.files = (mt_files){.given = texts, .n = MT_COUNT(texts), .only = true};
            v = load_from(s, name, own->path, true, &opt);
        }
    }
    free(joined);
    return v;
}

/* A profile of vibration that the study names, each read once; NULL: no name, or it could not
 * be read (noted). */
static const mt_vibration *limit_profile(mt_study_reader *s, mt_name name)
{
    mt_study *const study = s->study;
    if (name.s == NULL) {
        return NULL;
    }
    for (int i = 0; i < study->n_profiles; i++) {
        if (strcmp(study->profiles[i].name.s, name.s) == 0) {
            return study->profiles[i].profile;
        }
    }
    mt_study_profile *const all = mt_arena_grow(&study->mem, study->profiles, study->n_profiles,
                                                &study->cap_profiles, sizeof *all);
    if (all == NULL) {
        return NULL;
    }
    study->profiles = all;
    all[study->n_profiles] =
        (mt_study_profile){.name = name, .profile = load_limit_profile(s, name)};
    return all[study->n_profiles++].profile;
}

/* Goals */

static void ports_defaults(void *item, mt_addr addr, int which)
{
    (void)addr;
    (void)which;
    ((mt_goal_parts *)item)->response_limit = new_limit(MT_RESPONSE_LIMIT_RESPONSE);
}

/* Keep what the rows have filled. */
static void ports_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_goal_parts *const parts = item;
    mt_goal_finish(r, o, which, item);
    parts->goal.response_limit = mt_arena_alloc(r->mem, 1, sizeof parts->response_limit);
    if (parts->goal.response_limit != NULL) {
        *parts->goal.response_limit = parts->response_limit;
    }
}

#define THIS mt_goal_parts
#define OUTPUT_ROW                                                                          \
    MT_M_REF("output", true, response_limit.output,                                         \
             "The output: a sensor's motion (\"grip.x\", \"grip.x:acceleration\", "         \
             "\"grip.x:relative_displacement\"; displacement where it does not say), or a " \
             "force (\"spring.NAME\", \"damper.NAME\", of a bushing a component, "          \
             "\"spring.NAME.x\", \"spring.NAME.rx\"; \"joint.NAME.x\").")
#define WEIGHT_OF_TARGET                                                             \
    MT_S_NUMBER("weight", false, goal.weight, POSITIVE,                              \
                "With a weight the goal is a residual of the objective \"misfit\", " \
                "ln(value/target), instead of a constraint.")

/* "response" */

static const mt_key RESPONSE_GOAL[] = {
    MT_GOAL_ROWS(MT_GOAL_TOLERANCE),
    MT_GOAL_CONFIGURATION_ROWS,
    MT_M_REF("input", true, response_limit.input,
             "The excitation: the ground along an axis (\"base.z\"; its acceleration, or "
             "\"base.z:displacement\", \"base.z:velocity\"), or a force at a sensor "
             "(\"grip.x\"; \"grip.rx\" is a moment)."),
    OUTPUT_ROW,
    MT_S_NUMBER("target", false, goal.equals, POSITIVE,
                "Wanted value, above 0, at one frequency; excludes the limits."),
    MT_S_NUMBER("at_least", false, goal.at_least, POSITIVE,
                "Least value, above 0, at one frequency."),
    MT_S_NUMBER("at_most", false, goal.at_most, POSITIVE,
                "Greatest value, above 0 [SI: m/s^2 per N]."),
    WEIGHT_OF_TARGET,
    MT_S_PAIR("band_hz", false, response_limit.lower_hz, response_limit.upper_hz, RANGE,
              "Lower and upper frequency [Hz], above 0: the largest value between them, which "
              "is found and proven, not sampled."),
    MT_S_NUMBER("at_hz", false, response_limit.lower_hz, POSITIVE,
                "One frequency [Hz], above 0."),
};

/* A band, or one frequency. */
static void response_goal_check(mt_reader *r, mt_object *o)
{
    mt_goal_check(r, o);
    (void)mt_object_one_of(r, o, "band_hz", 2);
    if (mt_object_value(o, "at_hz") != MT_NO_ADDR) {
        mt_object_leave_out(o, "band_hz", 1);
    }
}

static void response_goal_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_response_limit *const limit = &((mt_goal_parts *)item)->response_limit;
    if (mt_object_value(o, "at_hz") != MT_NO_ADDR) {
        limit->upper_hz = limit->lower_hz;
    }
    ports_finish(r, o, which, item);
}

const mt_key_table mt_goal_response_keys = {
    .what = "goal_response",
    .keys = RESPONSE_GOAL,
    .n = MT_COUNT(RESPONSE_GOAL),
    .defaults = ports_defaults,
    .check = response_goal_check,
    .finish = response_goal_finish,
    .says = "A limit on a frequency response: the amplitude of an output for an input of 1, at "
            "one frequency or the largest over a band.",
    .rules = MT_GOAL_ONE_OR_SEVERAL
    ", \"oneOf\": [{\"required\": [\"band_hz\"]}, {\"required\": [\"at_hz\"]}]"};

/* "vibration" */

static void vibration_defaults(void *item, mt_addr addr, int which)
{
    (void)addr;
    (void)which;
    ((mt_goal_parts *)item)->response_limit = new_limit(MT_RESPONSE_LIMIT_RMS);
}

static void vibration_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_response_limit *const limit = &((mt_goal_parts *)item)->response_limit;
    limit->profile = limit_profile(mt_study_reader_of(r), limit->profile_name);
    ports_finish(r, o, which, item);
}

/* One of the quantities of a profile, which begin with the RMS. */
static void read_quantity(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    const int choice = mt_reader_choice(r, value, key->what, key->choices, key->n_choices);
    if (choice != MT_ABSENT) {
        ((mt_goal_parts *)item)->response_limit.quantity =
            (mt_response_limit_quantity)(MT_RESPONSE_LIMIT_RMS + choice);
    }
}

static const mt_key VIBRATION[] = {
    MT_GOAL_ROWS(MT_GOAL_TOLERANCE),
    MT_GOAL_CONFIGURATION_ROWS,
    MT_M_REF("input", false, response_limit.input,
             "Axis along which the ground accelerates: \"base.x\", \"base.y\" or \"base.z\". "
             "Absent: that of the profile."),
    OUTPUT_ROW,
    MT_S_NUMBER("target", false, goal.equals, POSITIVE,
                "Wanted value, above 0, of the RMS; excludes the limits."),
    MT_S_NUMBER("at_least", false, goal.at_least, POSITIVE,
                "Least value, above 0, of the RMS."),
    MT_S_NUMBER("at_most", false, goal.at_most, POSITIVE,
                "Greatest value, above 0 [SI: m/s^2]."),
    WEIGHT_OF_TARGET,
    MT_M_REF("profile", true, response_limit.profile_name,
             "File of the profile, relative to this one; or the name of one that is part of "
             "the program (`modetune profile` lists them).",
             .examples =
                 "[\"helicopter_uh60_panel\", \"../problems/profiles/truck_vertical.json\"]"),
    {.name = "quantity",
     .type = MT_KEY_TEXT,
     .read = read_quantity,
     .what = "quantity",
     .choices = mt_response_limit_names + MT_RESPONSE_LIMIT_RMS,
     .n_choices = MT_RESPONSE_LIMIT_QUANTITIES - MT_RESPONSE_LIMIT_RMS,
     .says = "What of it counts: \"rms\" of the random parts; \"sine\", the peaks of the tones "
             "by the rule of the profile, each the largest over its range; \"peak\": sigma "
             "times the RMS and the tones.",
     .otherwise = "\"rms\""},
};
const mt_key_table mt_goal_vibration_keys = {
    .what = "goal_vibration",
    .keys = VIBRATION,
    .n = MT_COUNT(VIBRATION),
    .defaults = vibration_defaults,
    .check = mt_goal_check,
    .finish = vibration_finish,
    .says = "A limit on the vibration of an output under a vibration profile.",
    .rules = MT_GOAL_ONE_OR_SEVERAL};

/* "frequency_response" */

static const mt_key FREQUENCY_RESPONSE[] = {
    MT_GOAL_ROWS(MT_GOAL_TOLERANCE),
    MT_GOAL_CONFIGURATION_ROWS,
    MT_M_REF("input", true, response_limit.input, "The input, as for response --input.",
             .examples = "[\"grip.x\"]"),
    MT_M_REF("output", true, response_limit.output, "The output, as for response --measure.",
             .examples = "[\"grip.x:acceleration\"]"),
    MT_M_REF("measurement", true, response_limit.measurement_name,
             "Name of one of the study's measurements."),
    MT_S_PAIR("band_hz", false, response_limit.lower_hz, response_limit.upper_hz, BAND,
              "The range of measured frequencies that is used [Hz]. Absent: all of them."),
    MT_M_FLAG("coherence", false, response_limit.coherence,
              "Let lines weigh by their coherence g2, as g2/(1 - g2), 1 - g2 being 0.01 at "
              "least.",
              .otherwise = "false"),
    MT_S_NUMBER("weight", true, goal.weight, POSITIVE,
                "Weight of the residuals (no unit), above 0."),
};
#undef THIS
const mt_key_table mt_goal_frequency_response_keys = {
    .what = "goal_frequency_response",
    .keys = FREQUENCY_RESPONSE,
    .n = MT_COUNT(FREQUENCY_RESPONSE),
    .defaults = ports_defaults,
    .check = mt_goal_check,
    .finish = ports_finish,
    .says = "A frequency response close to a measured one: residuals of the objective "
            "\"misfit\", ln(response/measured) at each of the measured frequencies, each with "
            "1/N of the weight.",
    .rules = MT_GOAL_ONE_OR_SEVERAL};

/* "static" */

static const char *const STATIC_QUANTITIES[] = {"compliance", "stiffness"};

#define THIS mt_goal_parts
static const mt_key STATIC[] = {
    MT_GOAL_ROWS("The goal is met within this, in percent of the demand; of a demand of 0 in "
                 "percent of the value at the original design."),
    MT_GOAL_CONFIGURATION_ROWS,
    MT_M_REF("output", true, static_limit.output,
             "What is limited at rest: the displacement of a sensor along its direction from "
             "the reference position, where nothing is loaded or driven (\"grip.z\" [m]; a "
             "rotation \"grip.rz\" [rad]); the force of a spring, above 0 where it pulls "
             "(\"spring.NAME\", of a bushing a component, \"spring.NAME.x\", "
             "\"spring.NAME.rx\"); what a joint's first body does to its second, along global "
             "axes: its force (\"joint.NAME.x\" [N]) and its moment about the joint's point "
             "on the second body (\"joint.NAME.rx\" [N m]); what holds a driven joint that is "
             "locked (\"joint.NAME.hold\").",
             .examples = "[\"grip.z\", \"spring.front.z\", \"joint.pivot.rx\"]"),
    MT_M_REF("input", false, static_limit.input,
             "A force along the direction of a sensor (\"grip.z\"; \"grip.rz\" is a moment): "
             "the goal is about what a small one of 1 changes at the equilibrium, by the "
             "tangent stiffness, and the output is a displacement.",
             .examples = "[\"grip.z\"]"),
    MT_M_CHOICE("quantity", false, static_limit.quantity, mt_static_quantity, "quantity",
                STATIC_QUANTITIES,
                "With \"input\": \"compliance\", the displacement per force; \"stiffness\", "
                "its reciprocal.",
                .otherwise = "\"compliance\""),
    MT_M_REF("against", false, static_limit.against_name,
             "Another configuration of the model, whose value is subtracted: the goal is about "
             "the difference."),
    MT_S_NUMBER("target", false, goal.equals, ANY,
                "Wanted value, in SI units; excludes the limits."),
    MT_S_NUMBER("at_least", false, goal.at_least, LIMIT, "Lower limit, in SI units."),
    MT_S_NUMBER("at_most", false, goal.at_most, LIMIT, "Upper limit, in SI units."),
    MT_S_NUMBER("weight", false, goal.weight, POSITIVE,
                "With a weight the goal is a residual of the objective \"misfit\", (value - "
                "target)/|target|, instead of a constraint."),
};
#undef THIS

static void static_defaults(void *item, mt_addr addr, int which)
{
    (void)addr;
    (void)which;
    ((mt_goal_parts *)item)->static_limit = (mt_static_limit){.against = MT_ABSENT, .unit = ""};
}

static void static_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_goal_parts *const parts = item;
    mt_goal_finish(r, o, which, item);
    if (mt_object_has(r, o, "quantity") && !mt_object_has(r, o, "input")) {
        mt_diag_structure(r->diags, mt_object_place(r, o, "quantity"),
                          "\"quantity\" goes with \"input\"");
    }
    parts->goal.static_limit = mt_arena_alloc(r->mem, 1, sizeof parts->static_limit);
    if (parts->goal.static_limit != NULL) {
        *parts->goal.static_limit = parts->static_limit;
    }
}

const mt_key_table mt_goal_static_keys = {
    .what = "goal_static",
    .keys = STATIC,
    .n = MT_COUNT(STATIC),
    .defaults = static_defaults,
    .check = mt_goal_check,
    .finish = static_finish,
    .says = "A displacement or a force of the mechanism at rest, under gravity, preload and "
            "loads: at a target, or within limits. No proof covers it.",
    .rules = "\"dependencies\": {\"quantity\": [\"input\"]}, " MT_GOAL_ONE_OR_SEVERAL};

/* Responses that results show */

static void response_defaults(void *item, mt_addr addr, int which)
{
    (void)which;
    *(mt_study_response *)item =
        (mt_study_response){.configuration = MT_ABSENT,
                            .response_limit = new_limit(MT_RESPONSE_LIMIT_RESPONSE),
                            .addr = addr};
}

static void response_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_response_limit *const limit = &((mt_study_response *)item)->response_limit;
    (void)o;
    (void)which;
    limit->profile = limit_profile(mt_study_reader_of(r), limit->profile_name);
}

#define THIS mt_study_response
static const mt_key RESPONSE[] = {
    MT_M_REF("configuration", false, configuration_name,
             "Name of a configuration of the model. Absent: its only one."),
    MT_M_REF("input", true, response_limit.input,
             "A port as `modetune response` has it: \"grip.y\", the force along a sensor's "
             "direction; \"base.y\", the ground's acceleration, or \"base.y:displacement\".",
             .examples = "[\"base.y\"]"),
    MT_M_REF("output", true, response_limit.output,
             "A port as `modetune response` has it: a sensor's motion (\"grip.y\", its "
             "displacement, or \"grip.y:acceleration\"), a force (\"spring.NAME\", "
             "\"damper.NAME\", \"joint.NAME.x\").",
             .examples = "[\"grip.y:acceleration\"]"),
    MT_S_PAIR("band_hz", true, response_limit.lower_hz, response_limit.upper_hz, RANGE,
              "From where to where it is shown.", .examples = "[[5, 500]]"),
    MT_M_REF("profile", false, response_limit.profile_name,
             "The vibration profile that the ground follows: a file, relative to this one, or "
             "the name of one that is part of the program (`modetune profile`). The input is "
             "an acceleration of the ground."),
    MT_M_TEXT("description", description, "Free text for people."),
    MT_M_TEXT("source", source, "Where it comes from: a table, a page, a test report."),
};
#undef THIS
const mt_key_table mt_study_response_keys = {
    .what = "response",
    .keys = RESPONSE,
    .n = MT_COUNT(RESPONSE),
    .size = sizeof(mt_study_response),
    .defaults = response_defaults,
    .finish = response_finish,
    .says = "What a forced vibration is caused by, and what it is seen in."};

/* Checks */

static const char BASE[] = "base.";
static const char AXES[] = "xyz";

/* The derivative in a port's name, "grip.x:relative_velocity": 1; without a colon: `none`. */
static int motion_of(const char *port, int none)
{
    static const char *const motions[] = {"displacement", "velocity", "acceleration"};
    const char *const colon = strchr(port, ':');
    for (int k = 0; k < MT_COUNT(motions) && colon != NULL; k++) {
        if (strstr(colon, motions[k]) != NULL) {
            return k;
        }
    }
    return none;
}

/* True where the last part of the name, before the colon, is a rotation: "grip.rx". */
static bool turns(const char *port)
{
    const size_t length = strcspn(port, ":");
    size_t at = length;
    while (at > 0 && port[at - 1] != '.') {
        at--;
    }
    return length > at && port[at] == 'r';
}

static const char *motion_unit(const char *port, int none)
{
    static const char *const units[2][3] = {{"m", "m/s", "m/s^2"}, {"rad", "rad/s", "rad/s^2"}};
    return units[turns(port) ? 1 : 0][motion_of(port, none)];
}

static bool begins(const char *text, const char *with)
{
    return strncmp(text, with, strlen(with)) == 0;
}

/* True where the port is `name`, or a component of it: "NAME.rx". */
static bool is_of(const char *port, const char *name, bool component)
{
    const size_t length = strlen(name);
    return strncmp(port, name, length) == 0 &&
           (component ? port[length] == '.' && strchr(port + length + 1, '.') == NULL
                      : port[length] == '\0');
}

/* Unit of the force of "spring.NAME" or a damper, by its type, of a bushing by its component;
 * otherwise: NULL. */
static const char *force_unit(const mt_model *m, const char *port, bool damper)
{
    for (int i = 0; i < m->n_springs; i++) {
        const mt_spring *const s = &m->springs[i];
        const bool bushing = s->type == MT_SPRING_BUSHING;
        if (s->damper == damper && s->name.s != NULL && is_of(port, s->name.s, bushing)) {
            const bool moment = bushing ? turns(port) : s->type == MT_SPRING_TORSION;
            return moment ? "N m" : "N";
        }
    }
    return NULL;
}

static const char *output_unit(const mt_model *m, const char *port)
{
    static const char *const springs[] = {"spring.", "damper."};
    for (int k = 0; k < MT_COUNT(springs); k++) {
        if (begins(port, springs[k])) {
            return force_unit(m, port + strlen(springs[k]), k == 1);
        }
    }
    return begins(port, "joint.") ? (turns(port) ? "N m" : "N") : motion_unit(port, 0);
}

static const char *input_unit(const char *port)
{
    return begins(port, BASE) ? motion_unit(port, 2) : turns(port) ? "N m" : "N";
}

static void find_unit(mt_study_check *c, mt_response_limit *s)
{
    const char *const out = output_unit(c->model, s->output.s);
    if (out != NULL && s->profile_name.s != NULL) {
        s->unit = out;
    } else if (out != NULL) {
        s->unit = mt_arena_printf(&c->study->mem, "%s per %s", out, input_unit(s->input.s));
    }
}

/* Check that the two frequencies of the range, "band_hz" of its owner, ascend. */
static void check_range(mt_study_check *c, const mt_response_limit *s, mt_addr owner)
{
    if (s->lower_hz >= s->upper_hz) {
        mt_diag_error(c->diags, mt_diag_member(c->diags, owner, "band_hz"),
                      "band_hz (%g to %g) must be two frequencies in ascending order",
                      s->lower_hz, s->upper_hz);
    }
}

/* Note what is demanded but a limit from above. */
static void refuse_demands(mt_study_check *c, const mt_goal *goal, const char *why)
{
    static const char *const names[] = {
        [MT_SLOT_EQUALS] = "target", [MT_SLOT_AT_LEAST] = "at_least"};
    for (int k = 0; k < MT_COUNT(names); k++) {
        if (MT_HAS(goal->number[k])) {
            mt_diag_error(c->diags, mt_diag_member(c->diags, goal->addr, names[k]), "%s", why);
        }
    }
}

static void check_frequencies(mt_study_check *c, const mt_goal *goal,
                              const mt_response_limit *s)
{
    const bool single = mt_diag_member(c->diags, goal->addr, "at_hz") != goal->addr;
    if (!MT_HAS(s->lower_hz) || !MT_HAS(s->upper_hz)) {
        return; /* noted by the reader */
    }
    if (single) {
        return;
    }
    check_range(c, s, goal->addr);
    refuse_demands(c, goal,
                   "the largest response over a band is only limited from above: give "
                   "\"at_most\", or one frequency, \"at_hz\"");
}

/* A profile says how the ground accelerates along one axis. */
static void check_input(mt_study_check *c, const mt_goal *goal, mt_response_limit *s)
{
    const mt_vibration *const v = s->profile;
    const bool absent =
        s->input.s == NULL && mt_diag_member(c->diags, goal->addr, "input") == goal->addr;
    if (absent && v->axis == MT_ABSENT) {
        mt_diag_error(c->diags, s->profile_name.addr,
                      "the profile \"%s\" names no axis: give \"input\", such as \"base.z\"",
                      s->profile_name.s);
    } else if (absent) {
        s->input.s = mt_arena_printf(&c->study->mem, "%s%c", BASE, AXES[v->axis]);
    } else if (s->input.s != NULL && !begins(s->input.s, BASE)) {
        mt_diag_error(c->diags, s->input.addr,
                      "\"%s\" is a force, and a profile says how the ground accelerates: the "
                      "input is \"base.x\", \"base.y\" or \"base.z\"",
                      s->input.s);
    } else if (s->input.s != NULL && motion_of(s->input.s, 2) != 2) {
        mt_diag_error(
            c->diags, s->input.addr,
            "\"%s\" is not an acceleration, and a profile says how the ground accelerates",
            s->input.s);
    }
}

static void check_profile(mt_study_check *c, const mt_goal *goal, mt_response_limit *s)
{
    const mt_vibration *const v = s->profile;
    const char *const lacks =
        s->quantity == MT_RESPONSE_LIMIT_RMS && v->n_random == 0   ? "random part"
        : s->quantity == MT_RESPONSE_LIMIT_SINE && v->n_tones == 0 ? "tone"
                                                                   : NULL;
    check_input(c, goal, s);
    if (lacks != NULL) {
        const mt_addr quantity = mt_diag_member(c->diags, goal->addr, "quantity");
        mt_diag_error(c->diags, quantity != goal->addr ? quantity : s->profile_name.addr,
                      "the profile \"%s\" has no %s: \"quantity\": \"%s\" is always 0",
                      s->profile_name.s, lacks, mt_response_limit_names[s->quantity]);
    }
    if (s->quantity != MT_RESPONSE_LIMIT_RMS) {
        refuse_demands(c, goal,
                       "the largest response to tones is only limited from above: give "
                       "\"at_most\", or \"quantity\": \"rms\"");
    }
}

/* Unit of what "joint.NAME.COMPONENT" has at rest; NULL: not known. */
static const char *joint_unit(const mt_model *m, const char *port)
{
    static const char hold[] = ".hold";
    const char *const dot = strrchr(port, '.');
    if (dot == NULL) {
        return NULL;
    }
    if (strcmp(dot, hold) != 0) {
        return turns(port) ? "N m" : "N";
    }
    for (int i = 0; i < m->n_joints; i++) {
        const char *const name = m->joints[i].name.s;
        if (strlen(name) == (size_t)(dot - port) && strncmp(name, port, strlen(name)) == 0) {
            return mt_joint_kind_of(m->joints[i].type)->coordinate == MT_COORDINATE_DISPLACEMENT
                       ? "N"
                       : "N m";
        }
    }
    return "N m"; /* the hinge of a link */
}

static const char *static_unit(const mt_model *m, const char *port)
{
    static const char joint[] = "joint.";
    return begins(port, joint) ? joint_unit(m, port + strlen(joint)) : output_unit(m, port);
}

/* Check the other configuration of a goal about rest, and find its unit. */
static void check_static(mt_study_check *c, const mt_goal *goal)
{
    mt_static_limit *const s = goal->static_limit;
    if (s->against_name.s != NULL) {
        s->against = mt_check_configuration(c, c->model, s->against_name);
    }
    for (int i = 0; i < goal->n_configurations && s->against != MT_ABSENT; i++) {
        if (goal->configurations[i] == s->against) {
            mt_diag_error(c->diags, s->against_name.addr,
                          "\"%s\" is the goal's own configuration: the difference is always 0",
                          s->against_name.s);
        }
    }
    const char *const out = s->output.s == NULL ? NULL : static_unit(c->model, s->output.s);
    if (out != NULL && s->input.s != NULL) {
        const char *const in = input_unit(s->input.s);
        s->unit = s->quantity == MT_STATIC_STIFFNESS
                      ? mt_arena_printf(&c->study->mem, "%s per %s", in, out)
                      : mt_arena_printf(&c->study->mem, "%s per %s", out, in);
    } else if (out != NULL) {
        s->unit = out;
    }
}

void mt_study_check_response_limit(mt_study_check *c, mt_goal *goal)
{
    mt_response_limit *const s = goal->response_limit;
    if (goal->static_limit != NULL) {
        check_static(c, goal);
    }
    if (s == NULL) {
        return; /* about rest, or memory is out */
    }
    if (s->measurement_name.s != NULL) {
        s->measurement = mt_check_measurement(c, s->measurement_name);
        check_range(c, s, goal->addr);
        return; /* its number is a distance, without a unit */
    }
    if (s->quantity == MT_RESPONSE_LIMIT_RESPONSE) {
        check_frequencies(c, goal, s);
    } else if (s->profile != NULL) {
        check_profile(c, goal, s);
    }
    if (s->input.s != NULL && s->output.s != NULL) {
        find_unit(c, s);
    }
}

void mt_study_check_responses(mt_study_check *c)
{
    for (int i = 0; i < c->study->n_responses; i++) {
        mt_study_response *const r = &c->study->responses[i];
        r->configuration = r->configuration_name.s == NULL
                               ? mt_check_only_configuration(c, c->model, r->addr)
                               : mt_check_configuration(c, c->model, r->configuration_name);
        check_range(c, &r->response_limit, r->addr);
    }
}
