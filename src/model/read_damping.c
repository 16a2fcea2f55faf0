/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Damping of a model and of its configurations. */
#include "model/read_priv.h"

/* name -> ratio of the named modes. */
static void read_named(mt_reader *r, const mt_key *key, mt_addr object, void *item)
{
    mt_damping *const d = item;
    mt_items items = mt_reader_items(r, object);
    d->named = mt_reader_room(r, &items, sizeof *d->named);
    while (mt_items_next(&items)) {
        mt_mode_ratio *const m = &d->named[d->n_named++];
        m->mode_name = mt_reader_member_name(r, items.at, MT_NAME_TITLE);
        m->mode = MT_ABSENT;
        m->ratio = mt_read_num(mt_model_reader_of(r), items.at, key->possible, NULL);
    }
}

static void damping_defaults(void *item, mt_addr addr, int which)
{
    mt_damping *const d = item;
    (void)which;
    d->given = addr != MT_NO_ADDR;
    d->addr = addr;
}

#define THIS mt_damping
static const mt_key DAMPING[] = {
    MT_I_NUM(
        "ratio", false, ratio, RATIO,
        "Damping ratio of every vibration mode that ratios and modes leave out; not negative.",
        .examples = "[0.02]"),
    MT_I_NUMS("ratios", LIST, ratios, n_ratios, RATIO, 1, MT_MAX_LIST,
              "Damping ratios of vibration modes 1, 2, ...; not negative."),
    MT_M_JUST("modes", OBJECT, false, RATIO,
              "Damping ratios of modes that the model names; not negative.",
              .schema = MT_I_BY_NAME("", MT_I_OF("number")), .read = read_named),
    MT_I_NUM("mass_per_s", false, mass, NOT_NEGATIVE,
             "Proportional damping: C has so many times the mass matrix [1/s]; not negative."),
    MT_I_NUM("stiffness_s", false, stiffness, NOT_NEGATIVE,
             "Proportional damping: C has so many times the stiffness matrix [s], the tangent "
             "stiffness with all loads and preload; not negative."),
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_damping_keys = {
    MT_I_TABLE("damping", DAMPING, mt_damping), .defaults = damping_defaults,
    .says = "Damping besides dampers and loss factors: C = mass_per_s M + stiffness_s K + M "
            "Phi diag(2 ratio_j omega_j) Phi^T M. That of a configuration takes the place of "
            "all of the one that it would inherit."};
