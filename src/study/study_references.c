/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/study_priv.h"

#include <string.h>

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

void mt_study_check_references(mt_study_check *c)
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
