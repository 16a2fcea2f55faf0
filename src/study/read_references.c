/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/read_priv.h"

#include <math.h>
#include <string.h>

#define REFERENCE_KEYS(X)                                           \
    X(REFERENCE_MODEL, "model", MT_KEY_TEXT, false)                 \
    X(REFERENCE_MODES, "modes", MT_KEY_LIST, false)                 \
    X(REFERENCE_CONFIGURATION, "configuration", MT_KEY_TEXT, false) \
    X(REFERENCE_DESCRIPTION, "description", MT_KEY_TEXT, false)     \
    X(REFERENCE_SOURCE, "source", MT_KEY_TEXT, false)
enum { REFERENCE_KEYS(MT_STUDY_KEY_ENUM) REFERENCE_KEY_COUNT };
static const mt_key KEYS[] = {REFERENCE_KEYS(MT_STUDY_KEY)};
const mt_key_table mt_study_reference_keys = {"reference", KEYS, REFERENCE_KEY_COUNT};

#define MEASURED_KEYS(X)                                                  \
    X(MEASURED_FREQUENCY, "frequency_hz", MT_KEY_NUMBER, false, MEASURED) \
    X(MEASURED_SHAPE, "shape", MT_KEY_OBJECT, false, ANY)                 \
    X(MEASURED_DESCRIPTION, "description", MT_KEY_TEXT, false)            \
    X(MEASURED_SOURCE, "source", MT_KEY_TEXT, false)
enum { MEASURED_KEYS(MT_STUDY_KEY_ENUM) MEASURED_KEY_COUNT };
static const mt_key MODE_KEYS[] = {MEASURED_KEYS(MT_STUDY_KEY)};
const mt_key_table mt_study_measured_keys = {"measured_mode", MODE_KEYS, MEASURED_KEY_COUNT};

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

static void read_shape(mt_study_reader *s, mt_addr object, mt_measured_mode *mode)
{
    if (object == MT_NO_ADDR) {
        return;
    }
    mt_items items = mt_reader_some_items(&s->r, object, "the shape");
    mode->channels = mt_reader_room(&s->r, &items, sizeof *mode->channels);
    mode->values = mt_reader_room(&s->r, &items, sizeof *mode->values);
    bool zero = true;
    while (mt_items_next(&items)) {
        const mt_name channel = mt_reader_member_name(&s->r, items.at, MT_NAME_TITLE);
        const double value = mt_read_study_number(s, items.at);
        if (channel.s != NULL && *channel.s != '\0' && !is_channel(channel.s)) {
            mt_diag_structure(s->r.diags, channel.addr,
                              "\"%s\" is not a sensor and direction (\"c1.y\")", channel.s);
        } else if (channel.s != NULL) {
            zero = zero && value == 0.0;
            mode->channels[mode->n_values] = channel;
            mode->values[mode->n_values++] = value;
        }
    }
    if (zero && mode->n_values > 0) {
        mt_diag_error(s->r.diags, object, "every value of the shape is 0");
    }
}

static void read_measured(mt_study_reader *s, mt_addr value, mt_measured_mode *mode)
{
    mt_study_object o;
    *mode = (mt_measured_mode){
        .frequency_hz = nan(""),
        .addr = value,
    };
    if (!mt_read_study_object(s, value, &mt_study_measured_keys, &o)) {
        return;
    }
    if (!mt_read_study_has(s, &o, MEASURED_FREQUENCY) &&
        !mt_read_study_has(s, &o, MEASURED_SHAPE)) {
        mt_diag_structure(s->r.diags, value,
                          "a measured mode needs \"frequency_hz\" or \"shape\"");
    }
    mode->frequency_hz = mt_read_study_number(s, o.found[MEASURED_FREQUENCY]);
    read_shape(s, o.found[MEASURED_SHAPE], mode);
}

static void read_reference(mt_study_reader *s, mt_addr value, mt_reference *r)
{
    mt_study_object o;
    r->addr = value;
    r->configuration = MT_ABSENT;
    if (!mt_read_study_object(s, value, &mt_study_reference_keys, &o)) {
        return;
    }
    (void)mt_read_study_one_of(s, &o, REFERENCE_MODEL, 2);
    if (mt_read_study_has(s, &o, REFERENCE_CONFIGURATION) &&
        !mt_read_study_has(s, &o, REFERENCE_MODEL)) {
        mt_diag_structure(s->r.diags, mt_read_study_place(s, &o, REFERENCE_CONFIGURATION),
                          "\"configuration\" goes with \"model\"");
    }
    r->source = mt_reader_text(&s->r, o.found[REFERENCE_SOURCE]);
    r->configuration_name = mt_reader_ref(&s->r, o.found[REFERENCE_CONFIGURATION]);
    r->model_path = mt_reader_ref(&s->r, o.found[REFERENCE_MODEL]);
    r->model = mt_read_study_model(s, r->model_path);
    mt_items modes = mt_reader_some_items(&s->r, o.found[REFERENCE_MODES], "the list of modes");
    r->modes = mt_reader_room(&s->r, &modes, sizeof *r->modes);
    while (mt_items_next(&modes)) { /* a wrong one still counts: modes are numbered */
        read_measured(s, modes.at, &r->modes[r->n_modes++]);
    }
}

void mt_read_study_references(mt_study_reader *s, mt_addr object)
{
    mt_study *const study = s->study;
    mt_items items = mt_reader_items(&s->r, object);
    study->references = mt_reader_room(&s->r, &items, sizeof *study->references);
    while (mt_items_next(&items)) {
        const mt_name name = mt_reader_member_name(&s->r, items.at, MT_NAME_ITEM);
        if (name.s != NULL) {
            mt_reference *const r = &study->references[study->n_references++];
            r->name = name;
            read_reference(s, items.at, r);
        }
    }
}
