/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measured frequency responses that a study names: which file, and what of it. */
#include "study/read_priv.h"

#include <limits.h>
#include <stdlib.h>

#include "measurement/read.h"

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

void mt_read_study_measured(mt_study_reader *s, const mt_object *o, mt_goal *goal)
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
