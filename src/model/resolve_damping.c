/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Damping: the modes that it names. */
#include "model/resolve_priv.h"

/* True where configuration c inherits the damping of `owner` through `like`. */
static bool takes_over(const mt_model *m, int c, int owner)
{
    while (c != owner && c != MT_ABSENT && !m->configurations[c].damping.given) {
        c = m->configurations[c].like;
    }
    return c == owner;
}

/* owner: the configuration; MT_ABSENT: the model. */
static void check_named(mt_resolve *f, mt_damping *d, int owner)
{
    const mt_model *const m = f->m;
    for (int i = 0; i < d->n_named; i++) {
        mt_mode_ratio *const own = &d->named[i];
        own->mode = mt_resolve_find(f, own->mode_name, &m->tables->modes, "mode");
        if (own->mode == MT_ABSENT) {
            continue;
        }
        const mt_named_mode *const mode = &m->modes[own->mode];
        if (mode->configuration == MT_ABSENT) {
            continue; /* noted where the mode stands */
        }
        if (!takes_over(m, mode->configuration, owner)) {
            mt_diag_error(f->d, own->mode_name.addr,
                          "mode \"%s\" is named in configuration \"%s\", which has another "
                          "damping",
                          mode->name.s, m->configurations[mode->configuration].name.s);
        }
        for (int k = 0; k < i; k++) {
            const mt_named_mode *const other =
                d->named[k].mode == MT_ABSENT ? NULL : &m->modes[d->named[k].mode];
            if (other != NULL && other->configuration == mode->configuration &&
                other->index == mode->index) {
                mt_diag_error(f->d, own->mode_name.addr, "\"%s\" and \"%s\" name the same mode",
                              other->name.s, mode->name.s);
            }
        }
    }
}

void mt_resolve_damping(mt_resolve *f)
{
    check_named(f, &f->m->damping, MT_ABSENT);
    for (int c = 0; c < f->m->n_configurations; c++) {
        check_named(f, &f->m->configurations[c].damping, c);
    }
}
