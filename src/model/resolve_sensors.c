/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sensors: on a body, on a link at a fraction of its length, or at the centre of one rigid
 * element. */
#include "model/resolve_priv.h"

#include <string.h>

enum { ROTATIONS = 8 | 16 | 32, PLANAR = 1 | 2 | 32 };

/* A link without a part: the sensor sits on it at `fraction`. */
static bool on_whole_link(mt_resolve *f, mt_sensor *s)
{
    const int link = mt_model_find_link(f->m, s->on_name.s);
    if (link == MT_ABSENT) {
        return false;
    }
    s->on_kind = MT_ATTACH_LINK_START;
    s->on = link;
    s->element = MT_ABSENT;
    double value = 0.0;
    if (s->fraction == MT_ABSENT) {
        mt_diag_error(f->d, s->on_name.addr,
                      "sensor \"%s\" sits on a link and needs \"fraction\"", s->name.s);
    } else if (mt_expr_is_constant(&f->m->nums[s->fraction].expr, &value) &&
               !(value >= 0.0 && value <= 1.0)) {
        mt_diag_error(f->d, mt_resolve_addr(f->m, s->fraction),
                      "fraction %g is not within 0 and 1", value);
    }
    if (s->at.given) {
        mt_diag_error(f->d, s->at.addr,
                      "a sensor on a link has no \"at\": its place is \"fraction\"");
    }
    return true;
}

static void on_part(mt_resolve *f, mt_sensor *s)
{
    mt_attach a = {.name = s->on_name};
    const int before = f->d->errors;
    mt_resolve_attach(f, &a);
    s->on_kind = a.kind;
    s->on = a.index;
    s->element = a.element;
    if (f->d->errors > before) {
        return;
    }
    if (a.kind != MT_ATTACH_BODY && a.kind != MT_ATTACH_LINK_ELEMENT) {
        mt_diag_error(f->d, s->on_name.addr,
                      "a sensor sits on a body, a link (with \"fraction\") or an element of "
                      "one, not on \"%s\"",
                      s->on_name.s);
    } else if (s->fraction != MT_ABSENT) {
        mt_diag_error(f->d, mt_resolve_addr(f->m, s->fraction),
                      "\"fraction\" is for a sensor on a whole link");
    }
    if (!mt_resolve_is_point_mass(f, &a)) {
        return;
    }
    if ((s->directions & ROTATIONS) != 0) {
        mt_diag_error(f->d, mt_diag_member(f->d, s->addr, "directions"),
                      "\"%s\" is a point mass, which does not turn", s->on_name.s);
    }
    if (s->at.given && !mt_resolve_same_position(f->m, &s->at, &f->m->bodies[a.index].centre)) {
        mt_diag_error(f->d, s->at.addr,
                      "\"%s\" is a point mass: its motion is known at its centre only",
                      s->on_name.s);
    }
}

void mt_resolve_sensors(mt_resolve *f)
{
    for (int i = 0; i < f->m->n_sensors; i++) {
        mt_sensor *const s = &f->m->sensors[i];
        mt_resolve_position(f, &s->at);
        if (s->on_name.s == NULL) {
            continue; /* could not be read */
        }
        if (!on_whole_link(f, s)) {
            on_part(f, s);
        }
        if (f->m->dimension == 2 && (s->directions & ~(unsigned)PLANAR) != 0) {
            mt_diag_error(f->d, mt_diag_member(f->d, s->addr, "directions"),
                          "directions in two dimensions are x, y and r");
        }
    }
}
