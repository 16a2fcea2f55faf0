/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dead loads. */
#include "model/read_priv.h"

#define LOAD_KEYS(X)                                         \
    X(LOAD_NAME, "name", TEXT, true)                         \
    X(LOAD_ON, "on", TEXT, false)                            \
    X(LOAD_JOINT, "joint", TEXT, false)                      \
    X(LOAD_AT, "at", TEXT_OR_LIST, false, POINT)             \
    X(LOAD_FORCE, "force_n", NUMBER_OR_LIST, false, ANY)     \
    X(LOAD_MOMENT, "moment_n_m", NUMBER_OR_LIST, false, ANY) \
    X(LOAD_IN, "in", LIST, false)                            \
    X(LOAD_DESCRIPTION, "description", TEXT, false)          \
    X(LOAD_SOURCE, "source", TEXT, false)
enum { LOAD_KEYS(MT_READ_ENUM) LOAD_COUNT };
MT_READ_TABLE(mt_load_keys, "load", LOAD_KEYS);

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
