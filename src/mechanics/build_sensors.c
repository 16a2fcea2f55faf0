/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sensors: which freedoms each channel reads. The element that a fraction of a link falls into
 * is chosen once, at the original design. */
#include <math.h>

#include "expr/op.h"
#include "mechanics/build.h"

static const char *const CHANNEL_NAMES[6] = {"x", "y", "z", "rx", "ry", "rz"};

static void add_channels(mt_builder *b, const mt_sensor *sensor, mt_channel_def def, bool beam)
{
    mt_system *const sys = b->sys;
    for (int k = 0; k < 6; k++) {
        if ((sensor->directions & (1U << k)) == 0U) {
            continue;
        }
        mt_channel_def *const grown = mt_arena_grow(&sys->mem, sys->channels, sys->n_channels,
                                                    &sys->cap_channels, sizeof *grown);
        if (grown == NULL) {
            return;
        }
        sys->channels = grown;
        const char *const direction = sys->dimension == 2 && k == 5 ? "r" : CHANNEL_NAMES[k];
        def.name = mt_build_name(b, "%s.%s", sensor->name.s, direction);
        def.axis = k % 3;
        def.kind = k < 3 ? (beam ? MT_CHANNEL_BEAM_POINT : MT_CHANNEL_POINT)
                         : (beam ? MT_CHANNEL_BEAM_ROTATION : MT_CHANNEL_ROTATION);
        sys->channels[sys->n_channels++] = def;
    }
}

/* Values of nodes at the original design, of those that were asked for so far. */
typedef struct known {
    const double *at;
    double *value;
    int count;
    int capacity;
    mt_arena mem;
} known;

/* ... and of all that were made since; NULL: no memory. */
static const double *values_so_far(const mt_program *p, known *k)
{
    for (; k->count < p->count; k->count++) {
        const mt_program_node *const n = &p->nodes[k->count];
        double *const v = mt_arena_grow(&k->mem, k->value, k->count, &k->capacity, sizeof *v);
        if (v == NULL) {
            return NULL;
        }
        k->value = v;
        if (n->op == MT_OP_CONST) {
            v[k->count] = n->value;
        } else if (n->op == MT_OP_PARAM) {
            v[k->count] = k->at[n->input];
        } else {
            v[k->count] = mt_op_value(n->op, v[n->a], n->b == MT_NO_NODE ? 0.0 : v[n->b]);
        }
    }
    return k->value;
}

/* Point of the link at `fraction`: from + fraction (to - from). */
static void link_point(mt_builder *b, const mt_link *link, mt_node fraction, mt_node out[3])
{
    mt_program *const p = &b->sys->program;
    mt_node from[3];
    mt_node to[3];
    mt_build_position(b, &link->from, from);
    mt_build_position(b, &link->to, to);
    for (int i = 0; i < 3; i++) {
        out[i] = mt_program_add(p, from[i],
                                mt_program_mul(p, fraction, mt_program_sub(p, to[i], from[i])));
    }
}

/* Rigid element whose centre is the nearest to the point among those that contain it: the
 * nearest centre measured in half lengths. */
static int element_at(mt_builder *b, int first, int n, const mt_node at[3], const double *v)
{
    int best = 0;
    double least = HUGE_VAL;
    for (int i = 0; i < n; i++) {
        const mt_vec_def *const c = &b->sys->vecs[b->sys->bodies[first + i].centre];
        double d2 = 0.0;
        for (int k = 0; k < 3; k++) {
            const double d = v[c->node[k]] - v[at[k]];
            d2 += d * d;
        }
        if (d2 < least) {
            least = d2;
            best = i;
        }
    }
    return first + best;
}

static mt_status sensor_on_link(mt_builder *b, const mt_sensor *sensor, known *original)
{
    mt_program *const p = &b->sys->program;
    const mt_link *const link = &b->model->links[sensor->on];
    const int first = b->link_first[sensor->on];
    const mt_node fraction = mt_build_num_or(b, sensor->fraction, b->zero);
    mt_node at[3];
    link_point(b, link, fraction, at);
    MT_TRY(mt_arena_check(&b->sys->mem, b->err));
    const double *const v = values_so_far(p, original);
    MT_TRY(mt_arena_check(&original->mem, b->err));
    const double f = v[fraction];
    const bool inside = f >= 0.0 && f <= 1.0;
    const int rigid =
        link->kind == MT_LINK_LUMPED ? element_at(b, first, link->elements, at, v) : -1;
    if (!inside) {
        return mt_fail(b->err, MT_E_INPUT, "sensor \"%s\": fraction %g is not between 0 and 1",
                       sensor->name.s, f);
    }
    mt_channel_def def = {.body = {rigid, MT_GROUND},
                          .point = -1,
                          .dir = {-1, -1, -1},
                          .shape = {MT_NO_NODE, MT_NO_NODE},
                          .fraction = MT_NO_NODE};
    if (rigid >= 0) {
        def.point = mt_build_arm(b, rigid, at, sensor->name.s);
        add_channels(b, sensor, def, false);
        return MT_OK;
    }
    const double along = f * (double)link->elements;
    int element = (int)along;
    element = element >= link->elements ? link->elements - 1 : element;
    def.body[0] = first + element;
    def.body[1] = first + element + 1;
    const mt_node scaled =
        mt_program_mul(p, fraction, mt_program_const(p, (double)link->elements));
    def.fraction = mt_program_sub(p, scaled, mt_program_const(p, (double)element));
    for (int i = 0; i < b->sys->n_measures && def.dir[0] < 0; i++) {
        const mt_measure_def *const m = &b->sys->measures[i];
        if (m->kind == MT_MEASURE_BEAM && m->body[0] == def.body[0] &&
            m->body[1] == def.body[1]) {
            for (int k = 0; k < 3; k++) {
                def.dir[k] = m->dir[k];
            }
            def.shape[0] = m->beam[MT_BEAM_SHAPE_2];
            def.shape[1] = m->beam[MT_BEAM_SHAPE_3];
        }
    }
    add_channels(b, sensor, def, true);
    return MT_OK;
}

static void sensor_on_body(mt_builder *b, const mt_sensor *sensor, int body)
{
    mt_channel_def def = {.body = {body, MT_GROUND},
                          .point = -1,
                          .dir = {-1, -1, -1},
                          .shape = {MT_NO_NODE, MT_NO_NODE},
                          .fraction = MT_NO_NODE};
    if (sensor->at.given) {
        mt_node at[3];
        mt_build_position(b, &sensor->at, at);
        def.point = mt_build_arm(b, body, at, sensor->name.s);
    }
    add_channels(b, sensor, def, false);
}

static mt_status build_sensors(mt_builder *b, known *original)
{
    for (int i = 0; i < b->model->n_sensors; i++) {
        const mt_sensor *const s = &b->model->sensors[i];
        if (s->on_kind == MT_ATTACH_BODY) {
            if (b->body_of[s->on] >= 0) {
                sensor_on_body(b, s, b->body_of[s->on]);
            }
            continue;
        }
        if (b->link_first[s->on] < 0) {
            continue;
        }
        if (s->on_kind == MT_ATTACH_LINK_ELEMENT) {
            sensor_on_body(b, s, b->link_first[s->on] + s->element);
            continue;
        }
        MT_TRY(sensor_on_link(b, s, original));
    }
    return MT_OK;
}

mt_status mt_build_sensors(mt_builder *b, const double *original)
{
    known k = {.at = original};
    MT_TRY(mt_arena_init(&k.mem, 0, b->err));
    const mt_status rc = build_sensors(b, &k);
    mt_arena_free(&k.mem);
    return rc;
}
