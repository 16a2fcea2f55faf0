/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dead loads. */
#include "model/read_priv.h"

static bool is_list(const mt_reader *r, mt_addr value)
{
    return value != MT_NO_ADDR && mt_json_type_of(r->doc, value) == MT_JSON_ARRAY;
}

/* A vector, or one number. */
static void read_force(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_load *const l = item;
    l->one_number = value != MT_NO_ADDR && !is_list(r, value);
    mt_item_vector(r, key, l->one_number ? MT_NO_ADDR : value, item);
    if (l->one_number) {
        int n = 0;
        const mt_num *const force = mt_read_nums(mt_model_reader_of(r), key, value, &n);
        l->has_force = force != NULL;
        l->force[0] = force == NULL ? MT_ABSENT : force[0];
    }
}

static void read_moment(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_load *const l = item;
    int n = 0;
    const mt_num *const moment = mt_read_nums(mt_model_reader_of(r), key, value, &n);
    l->moment_vector = is_list(r, value);
    l->has_moment = moment != NULL;
    l->moment = moment == NULL ? MT_ABSENT : moment[0];
}

static void load_defaults(void *item, mt_addr addr, int which)
{
    (void)which;
    ((mt_load *)item)->addr = addr;
}

static void load_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    (void)which;
    ((mt_load *)item)->unread = mt_object_wrong(r, o);
}

#define THIS mt_load
static const mt_key LOAD[] = {
    MT_I_NAME("load"),
    MT_M_REF("on", false, on.name,
             "What it acts on: a body, or a part of a link: \"L.start\", \"L.end\", the rigid "
             "element \"L.3\", or the node \"L.node3\" (of beam elements, or where rigid "
             "elements meet; \"L.node0\" is the start)."),
    MT_M_REF("joint", false, joint_name,
             "Instead of on: the joint (or hinge of a link, \"L.h3\") whose coordinate it acts "
             "along or about: on the second body, with the reaction on the first."),
    MT_I_POSITION("at", false, at,
                  "Point of application, in the reference position [m]. Absent: the centre of "
                  "the body or element, the end of the link."),
    MT_M_JUST("force_n", NUMBER_OR_LIST, false, ANY,
              "Force along x, y (and z) [N], whatever the body does; on a joint that slides: "
              "one number, above 0 along the axis on the second body, against it on the first.",
              .examples = "[[0, -50]]",
              .schema = "\"anyOf\": [{\"$ref\": \"#/definitions/number\"}, {\"$ref\": "
                        "\"#/definitions/vector\"}]",
              .read = read_force, .at = MT_M_PLACE(mt_vector, force),
              .other = MT_M_PLACE(bool, has_force)),
    MT_M_JUST(
        "moment_n_m", NUMBER_OR_LIST, false, ANY,
        "Moment [N m]: on a body in two dimensions, above 0 counter-clockwise; on a joint that "
        "turns, above 0 it turns the second body about the axis, and the first the other way. "
        "A moment of constant direction in space has no potential and is refused.",
        .read = read_moment, .least = 1, .most = 3),
    MT_I_IN,
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_load_keys = {MT_I_TABLE("load", LOAD, mt_load), .defaults = load_defaults,
                                   .finish = load_finish,
                                   .says = "A dead load on a body, or on a joint."};
