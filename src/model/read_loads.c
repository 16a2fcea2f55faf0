/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dead loads. */
#include "model/read_priv.h"

#define LOAD_KEYS(X)                                                                           \
    X(LOAD_NAME, "name", TEXT, true, NONE,                                                     \
      "Name of the load: a letter or _, then letters, digits, _, + and -.",                    \
      .pattern = "^[A-Za-z_][A-Za-z0-9_+-]*$")                                                 \
    X(LOAD_ON, "on", TEXT, false, NONE,                                                        \
      "What it acts on: a body, or a part of a link: \"L.start\", \"L.end\", the rigid "       \
      "element \"L.3\", or the node \"L.node3\" (of beam elements, or where rigid elements "   \
      "meet; \"L.node0\" is the start).")                                                      \
    X(LOAD_JOINT, "joint", TEXT, false, NONE,                                                  \
      "Instead of on: the joint (or hinge of a link, \"L.h3\") whose coordinate it acts "      \
      "along or about: on the second body, with the reaction on the first.")                   \
    X(LOAD_AT, "at", TEXT_OR_LIST, false, POINT,                                               \
      "Point of application, in the reference position [m]. Absent: the centre of the body "   \
      "or element, the end of the link.",                                                      \
      .schema = "\"allOf\": [{\"$ref\": \"#/definitions/position\"}]")                         \
    X(LOAD_FORCE, "force_n", NUMBER_OR_LIST, false, ANY,                                       \
      "Force along x, y (and z) [N], whatever the body does; on a joint that slides: one "     \
      "number, above 0 along the axis on the second body, against it on the first.",           \
      .examples = "[[0, -50]]",                                                                \
      .schema = "\"anyOf\": [{\"$ref\": \"#/definitions/number\"}, {\"$ref\": "                \
                "\"#/definitions/vector\"}]")                                                  \
    X(LOAD_MOMENT, "moment_n_m", NUMBER_OR_LIST, false, ANY,                                   \
      "Moment [N m]: on a body in two dimensions, above 0 counter-clockwise; on a joint that " \
      "turns, above 0 it turns the second body about the axis, and the first the other way. "  \
      "A moment of constant direction in space has no potential and is refused.",              \
      .schema = "\"anyOf\": [{\"$ref\": \"#/definitions/number\"}, {\"type\": \"array\", "     \
                "\"minItems\": 1, \"maxItems\": 3, \"items\": {\"$ref\": "                     \
                "\"#/definitions/number\"}}]")                                                 \
    X(LOAD_IN, "in", LIST, false, NONE,                                                        \
      "Names of the configurations that contain this item; absent: all of them. "              \
      "Configurations that are `like` one of them contain it as well.",                        \
      .schema = "\"type\": \"array\", \"items\": {\"type\": \"string\"}")                      \
    X(LOAD_DESCRIPTION, "description", TEXT, false, NONE, "Free text for people.")             \
    X(LOAD_SOURCE, "source", TEXT, false, NONE,                                                \
      "Where it comes from: a table, a page, a test report.")
enum { LOAD_KEYS(MT_READ_ENUM) LOAD_COUNT };
MT_READ_TABLE(mt_load_keys, "load", LOAD_KEYS, .says = "A dead load on a body, or on a joint.");

static bool is_list(const mt_model_reader *mr, mt_addr value)
{
    return value != MT_NO_ADDR && mt_json_type_of(mr->r.doc, value) == MT_JSON_ARRAY;
}

static void read_sizes(mt_model_reader *mr, const mt_addr *at, mt_load *l)
{
    int n = 0;
    l->force_addr = at[LOAD_FORCE];
    l->moment_addr = at[LOAD_MOMENT];
    l->one_number = at[LOAD_FORCE] != MT_NO_ADDR && !is_list(mr, at[LOAD_FORCE]);
    l->moment_vector = is_list(mr, at[LOAD_MOMENT]);
    if (l->one_number) {
        const mt_num *const force = mt_read_nums(mr, at[LOAD_FORCE], true, 1, 1, &n);
        l->has_force = force != NULL;
        l->force[0] = force == NULL ? MT_ABSENT : force[0];
        l->force[1] = MT_ABSENT;
        l->force[2] = MT_ABSENT;
    } else {
        l->has_force = mt_read_vector(mr, at[LOAD_FORCE], l->force);
    }
    const mt_num *const moment = mt_read_nums(mr, at[LOAD_MOMENT], true, 1, 3, &n);
    l->has_moment = moment != NULL;
    l->moment = moment == NULL ? MT_ABSENT : moment[0];
}

static void read_load(mt_model_reader *mr, mt_addr value, mt_load *l)
{
    const int before = mr->r.diags->errors;
    mt_addr at[LOAD_COUNT];
    (void)mt_reader_object(&mr->r, value, &mt_load_keys, at);
    *l = (mt_load){.joint = MT_ABSENT, .joint_link = MT_ABSENT, .joint_hinge = MT_ABSENT};
    l->name = mt_reader_name(&mr->r, at[LOAD_NAME]);
    l->on.name = mt_reader_ref(&mr->r, at[LOAD_ON]);
    l->joint_name = mt_reader_ref(&mr->r, at[LOAD_JOINT]);
    l->at = mt_read_position(mr, at[LOAD_AT]);
    read_sizes(mr, at, l);
    l->in = mt_read_presence(mr, at[LOAD_IN]);
    l->unread = mr->r.diags->errors > before;
}

void mt_read_loads(mt_model_reader *mr, mt_addr list)
{
    mt_model *const m = mr->m;
    mt_items i = mt_reader_items(&mr->r, list);
    m->loads = mt_reader_room(&mr->r, &i, sizeof *m->loads);
    while (mt_items_next(&i)) {
        read_load(mr, i.at, &m->loads[m->n_loads++]);
    }
}
