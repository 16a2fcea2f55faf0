/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measured frequency responses that a study names: which file, and what of it. */
#include "study/read_priv.h"

#include <limits.h>
#include <stdlib.h>

#include "measurement/read.h"

#define MEASUREMENT_KEYS(X)                                         \
    X(MEASUREMENT_FILE, "file", MT_KEY_TEXT, true)                  \
    X(MEASUREMENT_DATASET, "dataset", MT_KEY_COUNT, false, WHOLE)   \
    X(MEASUREMENT_RESPONSE, "response_node", MT_KEY_TEXT, false)    \
    X(MEASUREMENT_REFERENCE, "reference_node", MT_KEY_TEXT, false)  \
    X(MEASUREMENT_FACTOR, "factor", MT_KEY_NUMBER, false, POSITIVE) \
    X(MEASUREMENT_DESCRIPTION, "description", MT_KEY_TEXT, false)   \
    X(MEASUREMENT_SOURCE, "source", MT_KEY_TEXT, false)
enum { MEASUREMENT_KEYS(MT_STUDY_KEY_ENUM) MEASUREMENT_KEY_COUNT };
static const mt_key KEYS[] = {MEASUREMENT_KEYS(MT_STUDY_KEY)};
const mt_key_table mt_study_measurement_keys = {"measurement", KEYS, MEASUREMENT_KEY_COUNT};

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

/* Read a freedom of the test; noted where invalid. */
static mt_name read_freedom(mt_study_reader *s, mt_addr value)
{
    mt_measured_freedom f;
    mt_name name = mt_reader_ref(&s->r, value);
    if (name.s != NULL && !mt_measured_freedom_parse(name.s, &f)) {
        mt_diag_structure(s->r.diags, value,
                          "\"%s\" is not a node and direction (\"12+Z\", \"12-RX\")", name.s);
        name.s = NULL;
    }
    return name;
}

static void read_measurement(mt_study_reader *s, mt_addr value, mt_measurement *m)
{
    mt_study_object o;
    *m = mt_measurement_default(m->name, value);
    if (!mt_read_study_object(s, value, &mt_study_measurement_keys, &o)) {
        return;
    }
    m->path = mt_reader_ref(&s->r, o.found[MEASUREMENT_FILE]);
    m->dataset = mt_reader_count(&s->r, o.found[MEASUREMENT_DATASET], 1, INT_MAX, 0);
    m->response_name = read_freedom(s, o.found[MEASUREMENT_RESPONSE]);
    m->reference_name = read_freedom(s, o.found[MEASUREMENT_REFERENCE]);
    m->factor = mt_read_study_number(s, o.found[MEASUREMENT_FACTOR]);
    if (m->path.s != NULL) {
        load_measurement(s, m);
    }
}

void mt_read_study_measurements(mt_study_reader *s, mt_addr object)
{
    mt_study *const study = s->study;
    mt_items items = mt_reader_items(&s->r, object);
    study->measurements = mt_reader_room(&s->r, &items, sizeof *study->measurements);
    while (mt_items_next(&items)) {
        const mt_name name = mt_reader_member_name(&s->r, items.at, MT_NAME_ITEM);
        if (name.s != NULL) {
            mt_measurement *const m = &study->measurements[study->n_measurements++];
            m->name = name;
            read_measurement(s, items.at, m);
        }
    }
}

void mt_read_study_measured(mt_study_reader *s, const mt_study_object *o, mt_goal *goal)
{
    const mt_goal_kind *const kind = mt_goal_kind_of(goal->type);
    const int band = mt_goal_member_at(kind, MT_SLOT_BAND);
    const int named = mt_goal_member_at(kind, MT_SLOT_MEASUREMENT);
    const int coherence = mt_goal_member_at(kind, MT_SLOT_COHERENCE);
    mt_response_limit *const response_limit = goal->response_limit;
    double edges[2];
    response_limit->measurement_name = mt_reader_ref(&s->r, o->found[named]);
    response_limit->coherence = mt_reader_flag(&s->r, o->found[coherence], false);
    if (o->found[band] != MT_NO_ADDR &&
        mt_read_study_pair(s, o->found[band], o->found[band], edges)) {
        response_limit->lower_hz = edges[0];
        response_limit->upper_hz = edges[1];
    }
}
