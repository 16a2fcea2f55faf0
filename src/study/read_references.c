/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a study compares with: modes of models, measured modes, measured frequency responses. */
#include "study/read_priv.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "measurement/read.h"

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

void mt_read_study_references(mt_study_reader *s, mt_addr object)
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

void mt_read_study_measurements(mt_study_reader *s, mt_addr object)
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
