/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Damping of a model and of its configurations. */
#include "model/read_priv.h"

#define DAMPING_KEYS(X)                                              \
    X(DAMPING_RATIO, "ratio", NUMBER, false, RATIO)                  \
    X(DAMPING_RATIOS, "ratios", LIST, false, RATIO)                  \
    X(DAMPING_MODES, "modes", OBJECT, false, RATIO)                  \
    X(DAMPING_MASS, "mass_per_s", NUMBER, false, NOT_NEGATIVE)       \
    X(DAMPING_STIFFNESS, "stiffness_s", NUMBER, false, NOT_NEGATIVE) \
    X(DAMPING_DESCRIPTION, "description", TEXT, false)               \
    X(DAMPING_SOURCE, "source", TEXT, false)
enum { DAMPING_KEYS(MT_READ_ENUM) DAMPING_COUNT };
MT_READ_TABLE(mt_damping_keys, "damping", DAMPING_KEYS);

/* name -> ratio of the named modes. */
static void read_named(mt_model_reader *mr, mt_addr object, mt_damping *d)
{
    mt_items items = mt_reader_items(&mr->r, object);
    d->named = mt_reader_room(&mr->r, &items, sizeof *d->named);
    while (mt_items_next(&items)) {
        mt_mode_ratio *const m = &d->named[d->n_named++];
        m->mode_name = mt_reader_member_name(&mr->r, items.at, MT_NAME_TITLE);
        m->mode = MT_ABSENT;
        m->ratio = mt_read_num(mr, items.at);
        if (m->ratio != MT_ABSENT) {
            mr->m->nums[m->ratio].possible = mt_reader_possible(&mr->r, object);
        }
    }
}

mt_damping mt_read_damping(mt_model_reader *mr, mt_addr object)
{
    mt_damping d = {.addr = object};
    mt_addr at[DAMPING_COUNT];
    d.given = mt_reader_object(&mr->r, object, &mt_damping_keys, at);
    d.ratio = mt_read_num(mr, at[DAMPING_RATIO]);
    d.ratios_addr = at[DAMPING_RATIOS];
    d.ratios = mt_read_nums(mr, at[DAMPING_RATIOS], false, 1, MT_MAX_LIST, &d.n_ratios);
    read_named(mr, at[DAMPING_MODES], &d);
    d.mass = mt_read_num(mr, at[DAMPING_MASS]);
    d.stiffness = mt_read_num(mr, at[DAMPING_STIFFNESS]);
    return d;
}
