/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What a study compares with: modes of models, measured modes, measured frequency responses.
 * Of the responses of a file those that are meant stay, in SI. A table says by names of ports
 * what it has, which is held against the goals where the mechanism is known; a universal file
 * by numbers of datasets, nodes and directions.
 */
#include "study/references.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "measurement/read.h"
#include "study/check.h"
#include "study/reader.h"

/* "sensor.direction" */
static bool is_channel(const char *s)
{
    static const char *const directions[] = {".x", ".y", ".z", ".rx", ".ry", ".rz", ".r"};
    const char *const dot = strrchr(s, '.');
    if (dot == NULL || dot == s || memchr(s, '.', (size_t)(dot - s)) != NULL) {
        return false;
    }
    for (int i = 0; i < MT_COUNT(directions); i++) {
        if (strcmp(dot, directions[i]) == 0) {
            return true;
        }
    }
    return false;
}

static void read_shape(mt_reader *r, const mt_key *key, mt_addr object, void *item)
{
    mt_measured_mode *const mode = item;
    (void)key;
    mt_items items = mt_reader_some_items(r, object, "the shape");
    mode->channels = mt_reader_room(r, &items, sizeof *mode->channels);
    mode->values = mt_reader_room(r, &items, sizeof *mode->values);
    bool zero = true;
    while (mt_items_next(&items)) {
        const mt_name channel = mt_reader_member_name(r, items.at, MT_NAME_TITLE);
        const double value = mt_read_study_number(mt_study_reader_of(r), items.at);
        if (channel.s != NULL && *channel.s != '\0' && !is_channel(channel.s)) {
            mt_diag_structure(r->diags, channel.addr,
                              "\"%s\" is not a sensor and direction (\"c1.y\")", channel.s);
        } else if (channel.s != NULL) {
            zero = zero && value == 0.0;
            mode->channels[mode->n_values] = channel;
            mode->values[mode->n_values++] = value;
        }
    }
    if (zero && mode->n_values > 0) {
        mt_diag_error(r->diags, object, "every value of the shape is 0");
    }
}

static void measured_defaults(void *item, mt_addr addr, int which)
{
    (void)which;
    *(mt_measured_mode *)item = (mt_measured_mode){.frequency_hz = nan(""), .addr = addr};
}

static void measured_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    (void)which;
    (void)item;
    if (!mt_object_has(r, o, "frequency_hz") && !mt_object_has(r, o, "shape")) {
        mt_diag_structure(r->diags, o->addr,
                          "a measured mode needs \"frequency_hz\" or \"shape\"");
    }
}

#define THIS mt_measured_mode
static const mt_key MEASURED[] = {
    MT_S_NUMBER("frequency_hz", false, frequency_hz, MEASURED, "Natural frequency [Hz]."),
    {.name = "shape",
     .type = MT_KEY_OBJECT,
     .possible = MT_POSSIBLE_ANY,
     .read = read_shape,
     .says = "Values at \"sensor.direction\" in any common scale; directions x y z rx ry rz, "
             "in the plane x y r.",
     .examples = "[{\"c1.y\": 0.3, \"c2.y\": 0.1}]",
     .schema = "\"type\": \"object\", \"minProperties\": 1, \"propertyNames\": {\"pattern\": "
               "\"^[^.]+\\\\.(x|y|z|rx|ry|rz|r)$\"}, \"additionalProperties\": {\"$ref\": "
               "\"#/definitions/number\"}"},
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_study_measured_keys = {
    .what = "measured_mode",
    .keys = MEASURED,
    .n = MT_COUNT(MEASURED),
    .size = sizeof(mt_measured_mode),
    .defaults = measured_defaults,
    .finish = measured_finish,
    .says = "A measured mode: its frequency, its shape at sensors, or both.",
    .rules = "\"anyOf\": [{\"required\": [\"frequency_hz\"]}, {\"required\": [\"shape\"]}]"};

/* A wrong mode still counts: modes are numbered. */
static void read_measured_modes(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_reference *const reference = item;
    mt_items modes = mt_reader_some_items(r, value, "the list of modes");
    reference->modes = mt_reader_room(r, &modes, sizeof *reference->modes);
    while (mt_items_next(&modes)) {
        mt_measured_mode *const mode = &reference->modes[reference->n_modes++];
        measured_defaults(mode, modes.at, 0);
        (void)mt_members_read(r, modes.at, key->of, mode);
    }
}

static void reference_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_reference *const reference = item;
    (void)which;
    if (mt_object_has(r, o, "configuration") && !mt_object_has(r, o, "model")) {
        mt_diag_structure(r->diags, mt_object_place(r, o, "configuration"),
                          "\"configuration\" goes with \"model\"");
    }
    reference->model = mt_read_study_model(mt_study_reader_of(r), reference->model_path);
}

#define THIS mt_reference
static const mt_key REFERENCE[] = {
    MT_M_REF("model", false, model_path, "Model file, relative to this file."),
    {.name = "modes",
     .type = MT_KEY_LIST,
     .read = read_measured_modes,
     .what = "the list of modes",
     .of = &mt_study_measured_keys,
     .says = "Measured modes, in the order of their index, from 1."},
    MT_M_REF("configuration", false, configuration_name,
             "Configuration of that model. Absent: its only one."),
    MT_M_DESCRIPTION,
    MT_M_TEXT("source", source, "Where it comes from: a table, a page, a test report."),
};
#undef THIS
const mt_key_table mt_study_reference_keys = {
    .what = "reference",
    .keys = REFERENCE,
    .n = MT_COUNT(REFERENCE),
    .one_of = 2,
    .size = sizeof(mt_reference),
    .finish = reference_finish,
    .says =
        "Modes to compare with: those of a configuration of another model, or measured ones.",
    .rules = "\"dependencies\": {\"configuration\": [\"model\"]}"};

static void read_references(mt_study_reader *s, mt_addr object)
{
    mt_study *const study = s->study;
    mt_items items = mt_reader_items(&s->r, object);
    study->references = mt_reader_room(&s->r, &items, sizeof *study->references);
    while (mt_items_next(&items)) {
        const mt_name name = mt_reader_member_name(&s->r, items.at, MT_NAME_ITEM);
        if (name.s != NULL) {
            mt_reference *const r = &study->references[study->n_references++];
            *r = (mt_reference){.name = name, .configuration = MT_ABSENT, .addr = items.at};
            (void)mt_members_read(&s->r, items.at, &mt_study_reference_keys, r);
        }
    }
}

/* Measurements */

static void load_measurement(mt_study_reader *s, mt_measurement *m)
{
    char sha256[MT_SHA256_TEXT];
    mt_err why = {.code = MT_OK};
    const int told = s->model_messages->count;
    char *const joined = mt_file_join(s->study->path, m->path.s);
    if (joined == NULL) {
        mt_arena_fail(s->r.mem);
        return;
    }
    const mt_status rc =
        mt_measurement_load(joined, &s->files, s->r.mem, m, sha256, s->model_messages, &why);
    if (rc == MT_OK) {
        mt_read_study_note_input(s, m->path.s, sha256);
    } else {
        mt_read_study_note_failure(s, m->path, joined, rc, &why,
                                   s->model_messages->count > told);
    }
    free(joined);
}

/* A freedom of the test; noted where invalid. */
static void read_freedom(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_measured_freedom f;
    mt_name *const name = (mt_name *)(void *)((char *)item + key->at);
    *name = mt_reader_ref(r, value);
    if (name->s != NULL && !mt_measured_freedom_parse(name->s, &f)) {
        mt_diag_structure(r->diags, value,
                          "\"%s\" is not a node and direction (\"12+Z\", \"12-RX\")", name->s);
        name->s = NULL;
    }
}

static void measurement_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_measurement *const m = item;
    (void)o;
    (void)which;
    if (m->path.s != NULL) {
        load_measurement(mt_study_reader_of(r), m);
    }
}

#define THIS mt_measurement
#define FREEDOM(label, m, ...)                                                   \
    {                                                                            \
        .name = (label), .type = MT_KEY_TEXT, MT_M_TO(read_freedom, mt_name, m), \
        .says = __VA_ARGS__                                                      \
    }
static const mt_key MEASUREMENT[] = {
    MT_M_REF("file", true, path,
             "The file, relative to this one. A table has columns frequency_hz, real and imag "
             "or magnitude and phase_deg, and if need be coherence, configuration, input, "
             "output and unit, as response --format csv writes it."),
    MT_M_COUNT("dataset", false, dataset, 1, INT_MAX,
               "Which of the datasets 58 of a universal file, from 1."),
    FREEDOM("response_node", response_name,
            "Node and direction of the response in a universal file: 12+Z, 12-RX; a node alone "
            "means any direction. Directions' signs are taken into the values.",
            .examples = "[\"12+Z\"]",
            .pattern = "^[0-9]{1,9}([+-]?[Rr]?[XYZxyz]|[Rr]?[XYZxyz][+-])?$"),
    FREEDOM("reference_node", reference_name,
            "Node and direction of the excitation in a universal file: 1+Z.",
            .examples = "[\"1+Z\"]",
            .pattern = "^[0-9]{1,9}([+-]?[Rr]?[XYZxyz]|[Rr]?[XYZxyz][+-])?$"),
    MT_S_NUMBER("factor", false, factor, POSITIVE,
                "What the values of the file are multiplied by to be in SI, above 0. Absent: "
                "the file says its units, or is in SI."),
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_study_measurement_keys = {
    .what = "measurement",
    .keys = MEASUREMENT,
    .n = MT_COUNT(MEASUREMENT),
    .size = sizeof(mt_measurement),
    .finish = measurement_finish,
    .says = "A file of measured frequency responses: a table (CSV), or a universal file with "
            "datasets 58."};

static void read_measurements(mt_study_reader *s, mt_addr object)
{
    mt_study *const study = s->study;
    mt_items items = mt_reader_items(&s->r, object);
    study->measurements = mt_reader_room(&s->r, &items, sizeof *study->measurements);
    while (mt_items_next(&items)) {
        const mt_name name = mt_reader_member_name(&s->r, items.at, MT_NAME_ITEM);
        if (name.s != NULL) {
            mt_measurement *const m = &study->measurements[study->n_measurements++];
            *m = mt_measurement_default(name, items.at);
            (void)mt_members_read(&s->r, items.at, &mt_study_measurement_keys, m);
        }
    }
}

void mt_read_study_references(mt_study_reader *s, mt_addr references, mt_addr measurements)
{
    read_references(s, references);
    read_measurements(s, measurements);
}

/* Checks of references */

/* Directions by bit, as model.h defines them; in the plane "r" is the rotation. */
static const char *const DIRECTIONS[] = {"x", "y", "z", "rx", "ry", "rz"};

static bool measures(const mt_model *m, const mt_sensor *sensor, const char *direction)
{
    for (int bit = 0; bit < MT_COUNT(DIRECTIONS); bit++) {
        const bool has = (sensor->directions >> bit & 1U) != 0;
        const bool plane_rotation = m->dimension == 2 && bit == MT_COUNT(DIRECTIONS) - 1;
        if (has && (strcmp(direction, DIRECTIONS[bit]) == 0 ||
                    (plane_rotation && strcmp(direction, "r") == 0))) {
            return true;
        }
    }
    return false;
}

/* True where "sensor.direction" is a channel of the model. */
static bool has_channel(const mt_model *m, const char *channel)
{
    const char *const dot = strrchr(channel, '.');
    for (int i = 0; dot != NULL && i < m->n_sensors; i++) {
        const char *const name = m->sensors[i].name.s;
        const size_t length = strlen(name);
        if (length == (size_t)(dot - channel) && strncmp(name, channel, length) == 0) {
            return measures(m, &m->sensors[i], dot + 1);
        }
    }
    return false;
}

/* One sensor and one direction that both models have are enough. */
static bool share_channel(const mt_model *a, const mt_model *b)
{
    for (int i = 0; i < a->n_sensors; i++) {
        const int other = mt_model_find_sensor(b, a->sensors[i].name.s);
        if (other != MT_ABSENT &&
            (a->sensors[i].directions & b->sensors[other].directions) != 0) {
            return true;
        }
    }
    return false;
}

int mt_count_common_channels(const mt_model *model, const mt_measured_mode *mode)
{
    int n = 0;
    for (int k = 0; k < mode->n_values; k++) {
        n += has_channel(model, mode->channels[k].s) ? 1 : 0;
    }
    return n;
}

static void check_measured(mt_study_check *c, mt_reference *r)
{
    for (int i = 0; i < r->n_modes; i++) {
        mt_measured_mode *const mode = &r->modes[i];
        int matched = 0;
        for (int k = 0; k < mode->n_values; k++) {
            const mt_name channel = mode->channels[k];
            if (has_channel(c->model, channel.s)) {
                matched++;
            } else {
                mt_diag_warning(c->diags, channel.addr,
                                "the model has no sensor and direction \"%s\": ignored",
                                channel.s);
            }
        }
        if (mode->n_values > 0 && matched == 0) {
            mt_diag_error(c->diags, mode->addr,
                          "no sensor of this shape is in the model: nothing can be compared");
        }
    }
}

static void check_references(mt_study_check *c)
{
    mt_study *const s = c->study;
    for (int i = 0; i < s->n_references; i++) {
        mt_reference *const r = &s->references[i];
        const int first = mt_study_find_reference(s, r->name.s);
        if (first < i) {
            mt_diag_error(c->diags, r->name.addr, "reference \"%s\" is given twice", r->name.s);
        }
        r->configuration = MT_ABSENT;
        if (r->model_path.s == NULL) {
            check_measured(c, r);
        }
        if (r->model == NULL) {
            continue;
        }
        r->configuration = r->configuration_name.s != NULL
                               ? mt_check_configuration(c, r->model, r->configuration_name)
                               : mt_check_only_configuration(c, r->model, r->addr);
    }
}

void mt_check_common_sensors(mt_study_check *c, int reference, mt_addr addr)
{
    if (reference == MT_ABSENT) {
        return;
    }
    const mt_reference *const r = &c->study->references[reference];
    if (r->model != NULL && !share_channel(c->model, r->model)) {
        mt_diag_error(c->diags, addr,
                      "the model and reference \"%s\" have no sensor and direction in common",
                      r->name.s);
    }
}

/* Checks of measurements */

static int find_measurement(const mt_study *study, const char *name)
{
    for (int i = 0; i < study->n_measurements; i++) {
        if (strcmp(study->measurements[i].name.s, name) == 0) {
            return i;
        }
    }
    return MT_ABSENT;
}

int mt_check_measurement(mt_study_check *c, mt_name name)
{
    const mt_study *const s = c->study;
    if (name.s == NULL) {
        return MT_ABSENT;
    }
    const int found = find_measurement(s, name.s);
    if (found == MT_ABSENT) {
        mt_check_unknown_name(c, name, "measurement", s->measurements, s->n_measurements,
                              sizeof *s->measurements);
    }
    return found;
}

/* True where the freedom of the file is the requested one. A node alone means any direction;
 * the opposite direction is the same freedom, as the sign is in the values. */
static bool is_freedom(mt_name asked, const mt_measured_freedom *has)
{
    mt_measured_freedom f;
    if (asked.s == NULL || !mt_measured_freedom_parse(asked.s, &f)) {
        return true;
    }
    return f.node == has->node && (f.direction == 0 || f.direction == has->direction ||
                                   f.direction == -has->direction);
}

static bool is_meant(const mt_measurement *m, const mt_measured_response *r)
{
    return mt_measured_is_response(r) && (m->dataset == 0 || m->dataset == r->dataset) &&
           is_freedom(m->response_name, &r->response) &&
           is_freedom(m->reference_name, &r->reference);
}

/* The address of the member that selects one of several responses. */
static mt_addr choice_of(const mt_study_check *c, const mt_measurement *m)
{
    return m->dataset > 0                ? mt_diag_member(c->diags, m->addr, "dataset")
           : m->response_name.s != NULL  ? m->response_name.addr
           : m->reference_name.s != NULL ? m->reference_name.addr
                                         : m->addr;
}

/* Keep only the selected response of a measurement. */
static void keep_selected_response(mt_study_check *c, mt_measurement *m)
{
    const bool table = m->n_responses > 0 && m->responses[0].dataset == 0;
    const bool asked =
        m->dataset > 0 || m->response_name.s != NULL || m->reference_name.s != NULL;
    if (table && asked) {
        mt_diag_error(c->diags, choice_of(c, m),
                      "datasets and nodes go with a universal file, and \"%s\" is a table",
                      m->path.s);
        return;
    }
    mt_measured_response kept = {.dataset = 0};
    int n = 0;
    for (int i = 0; i < m->n_responses && !table; i++) {
        if (is_meant(m, &m->responses[i])) {
            kept = n++ == 0 ? m->responses[i] : kept;
        }
    }
    if (table) {
        return;
    }
    if (n == 1) {
        m->responses[0] = kept;
        m->n_responses = 1;
        return;
    }
    const char *const list = mt_measured_list_text(m, &c->study->mem);
    mt_diag_error(c->diags, choice_of(c, m),
                  n > 1 ? "%d frequency responses of \"%s\" can be meant: say which by "
                          "\"dataset\", or by \"response_node\" and \"reference_node\" (%s)"
                        : "%d frequency responses of \"%s\" are meant by this; it has: %s",
                  n, m->path.s, *list == '\0' ? "none" : list);
}

static bool scale(mt_study_check *c, const mt_measurement *m, mt_measured_response *r)
{
    const double by = MT_HAS(m->factor) ? m->factor : r->si;
    if (!MT_HAS(by)) {
        if (r->foreign != NULL && r->against != NULL) {
            mt_diag_error(c->diags, m->path.addr,
                          "\"%s\" says that it has %s, and \"%s\" for its unit: give "
                          "\"factor\", by which its values are multiplied to be in SI",
                          m->path.s, r->against, r->foreign);
            return false;
        }
        mt_diag_error(c->diags, m->path.addr,
                      r->foreign != NULL
                          ? "the unit \"%s\" of \"%s\" is not known: give \"factor\", by which "
                            "its values are multiplied to be in SI"
                          : "\"%s%s\" does not say what it measures, so that its units say "
                            "nothing: give \"factor\", by which its values are multiplied to "
                            "be in SI",
                      r->foreign != NULL ? r->foreign : "", m->path.s);
        return false;
    }
    r->scale = by;
    r->unit = MT_HAS(m->factor) ? NULL : r->unit;
    return true;
}

static void check_measurements(mt_study_check *c)
{
    mt_study *const s = c->study;
    for (int i = 0; i < s->n_measurements; i++) {
        mt_measurement *const m = &s->measurements[i];
        if (find_measurement(s, m->name.s) < i) {
            mt_diag_error(c->diags, m->name.addr, "measurement \"%s\" is given twice",
                          m->name.s);
        }
        if (!m->read) {
            continue;
        }
        const int before = c->diags->errors;
        keep_selected_response(c, m);
        bool known = c->diags->errors == before;
        for (int k = 0; k < m->n_responses && known; k++) {
            known = scale(c, m, &m->responses[k]);
        }
    }
}

void mt_study_check_references(mt_study_check *c)
{
    check_references(c);
    check_measurements(c);
}
