/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Damping of a model and of its configurations. */
#include "model/read_priv.h"

#define DAMPING_KEYS(X)                                                                       \
    X(DAMPING_RATIO, "ratio", NUMBER, false, RATIO,                                           \
      "Damping ratio of every vibration mode that ratios and modes leave out; not negative.", \
      .examples = "[0.02]")                                                                   \
    X(DAMPING_RATIOS, "ratios", LIST, false, RATIO,                                           \
      "Damping ratios of vibration modes 1, 2, ...; not negative.",                           \
      .schema = "\"type\": \"array\", \"minItems\": 1, \"maxItems\": 100000, \"items\": "     \
                "{\"$ref\": \"#/definitions/number\"}")                                       \
    X(DAMPING_MODES, "modes", OBJECT, false, RATIO,                                           \
      "Damping ratios of modes that the model names; not negative.",                          \
      .schema = "\"type\": \"object\", \"additionalProperties\": {\"$ref\": "                 \
                "\"#/definitions/number\"}")                                                  \
    X(DAMPING_MASS, "mass_per_s", NUMBER, false, NOT_NEGATIVE,                                \
      "Proportional damping: C has so many times the mass matrix [1/s]; not negative.")       \
    X(DAMPING_STIFFNESS, "stiffness_s", NUMBER, false, NOT_NEGATIVE,                          \
      "Proportional damping: C has so many times the stiffness matrix [s], the tangent "      \
      "stiffness with all loads and preload; not negative.")                                  \
    X(DAMPING_DESCRIPTION, "description", TEXT, false, NONE, "Free text for people.")         \
    X(DAMPING_SOURCE, "source", TEXT, false, NONE,                                            \
      "Where it comes from: a table, a page, a test report.")
enum { DAMPING_KEYS(MT_READ_ENUM) DAMPING_COUNT };
MT_READ_TABLE(mt_damping_keys, "damping", DAMPING_KEYS,
              .says = "Damping besides dampers and loss factors: C = mass_per_s M + "
                      "stiffness_s K + M Phi diag(2 ratio_j omega_j) Phi^T M. That of a "
                      "configuration takes the place of all of the one that it would inherit.");

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
