/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Springs, dampers, and links as what is elastic, in the order of the system:
 * links, then springs of the model. */
#include "scene/scene_priv.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "model/joint.h"

static mt_scene_spring spring_default(mt_arena *mem, const char *name, const char *type)
{
    return (mt_scene_spring){
        .name = mt_arena_strdup(mem, name), .type = type, .stiffness = nan("")};
}

/* A spring between two bodies: at its points, or at their centres. */
static void between_bodies(const mt_scene_frame *f, const mt_spring *s, mt_scene_spring *out)
{
    for (int side = 0; side < 2; side++) {
        const mt_attach *const a = &s->bodies[side];
        const int body = mt_scene_body_of(f, a);
        double drawn[3];
        out->body[side] = body + 1;
        if (s->n_at > 0) {
            mt_scene_drawn(f, &s->at[s->n_at == 2 ? side : 0], drawn);
        } else if (a->kind == MT_ATTACH_LINK_NODE) {
            mt_scene_link_at(f, a->index, a->element, false, drawn);
        } else {
            mt_scene_centre(f, body, drawn);
        }
        mt_scene_place(f, body, drawn, out->end[side]);
    }
    /* between turns a spring without points is where the body is that moves */
    for (int side = 0; side < 2 && s->n_at == 0 && s->type == MT_SPRING_TORSION; side++) {
        if (out->body[side] == 0) {
            memcpy(out->end[side], out->end[1 - side], sizeof out->end[side]);
        }
    }
}

/* On a joint of the model. */
static void on_joint(const mt_scene_frame *f, int joint, mt_scene_spring *out)
{
    const mt_scene_joint *const j = &f->view->joints[f->joint_of[joint]];
    memcpy(out->body, j->body, sizeof out->body);
    memcpy(out->end, j->end, sizeof out->end);
    memcpy(out->axis, j->axis, sizeof out->axis);
    out->has_axis = j->has_axis;
}

/* On a hinge of a link, between its elements hinge and hinge + 1 (from 0). */
static void on_hinge(const mt_scene_frame *f, int link, int hinge, mt_scene_spring *out)
{
    double drawn[3];
    mt_scene_link_at(f, link, hinge + 1, false, drawn);
    for (int side = 0; side < 2; side++) {
        const int body = f->link_first[link] + hinge + side;
        out->body[side] = body + 1;
        mt_scene_place(f, body, drawn, out->end[side]);
    }
}

/* Springs of the system from `first` on that are those of this spring of the model: they stand
 * in its order (mechanics/build.c), each with its very name. They become `index` of the
 * view. Returns how many. */
static int assign_view_spring(mt_scene_frame *f, int first, const char *name, int index)
{
    int n = 0;
    for (; first + n < f->sys->n_springs && f->sys->springs[first + n].name == name; n++) {
        f->spring_of[first + n] = index;
    }
    return n;
}

/* Those of a link, which stand before all others (mechanics/build_links.c). */
static int springs_of_link(const mt_scene_frame *f, const mt_link *l)
{
    enum { STRAINS_2D = 3, STRAINS_3D = 6 };
    if (l->kind == MT_LINK_LUMPED) {
        return l->elements - 1;
    }
    return l->elements * (f->sys->dimension == 2 ? STRAINS_2D : STRAINS_3D);
}

static void fill_view_spring(const mt_scene_frame *f, const mt_spring *s, mt_scene_spring *out)
{
    *out = spring_default(f->mem, s->name.s, mt_spring_type_name(s->type));
    if (s->joint != MT_ABSENT) {
        on_joint(f, s->joint, out);
    } else if (s->joint_link != MT_ABSENT) {
        on_hinge(f, s->joint_link, s->joint_hinge, out);
    } else {
        between_bodies(f, s, out);
    }
    if (s->type == MT_SPRING_TORSION && f->sys->dimension == 2 && !out->has_axis) {
        out->axis[2] = 1.0;
        out->has_axis = true;
    }
}

static void fill_link(const mt_scene_frame *f, int i, mt_scene_spring *out)
{
    const mt_link *const l = &f->model->links[i];
    const int last = f->link_first[i] + l->elements - (l->kind == MT_LINK_BEAM ? 0 : 1);
    double drawn[3];
    *out = spring_default(f->mem, l->name.s, "link");
    out->body[0] = f->link_first[i] + 1;
    out->body[1] = last + 1;
    mt_scene_drawn(f, &l->from, drawn);
    mt_scene_place(f, f->link_first[i], drawn, out->end[0]);
    mt_scene_drawn(f, &l->to, drawn);
    mt_scene_place(f, last, drawn, out->end[1]);
}

mt_status mt_scene_springs(mt_scene_frame *f, mt_err *err)
{
    const mt_model *const m = f->model;
    mt_scene_view *const v = f->view;
    const size_t most = (size_t)m->n_springs + (size_t)m->n_links;
    int at = 0;
    v->springs = mt_arena_alloc(f->mem, most, sizeof *v->springs);
    v->dampers = mt_arena_alloc(f->mem, (size_t)m->n_springs, sizeof *v->dampers);
    f->spring_of = mt_arena_int(f->work, (size_t)f->sys->n_springs);
    MT_TRY(mt_arena_check(f->mem, err));
    MT_TRY(mt_arena_check(f->work, err));
    for (int i = 0; i < m->n_links; i++) {
        const int n = f->link_first[i] == MT_ABSENT ? 0 : springs_of_link(f, &m->links[i]);
        for (int k = 0; k < n; k++) {
            f->spring_of[at++] = v->n_springs;
        }
        if (f->link_first[i] != MT_ABSENT) {
            fill_link(f, i, &v->springs[v->n_springs++]);
        }
    }
    for (int i = 0; i < m->n_springs; i++) {
        const mt_spring *const s = &m->springs[i];
        if (!mt_model_present(&s->in, f->configuration)) {
            continue;
        }
        mt_scene_spring *const out =
            s->damper ? &v->dampers[v->n_dampers++] : &v->springs[v->n_springs++];
        const int n = assign_view_spring(f, at, s->name.s, s->damper ? -1 : v->n_springs - 1);
        fill_view_spring(f, s, out);
        out->stiffness = n == 1 ? f->value[f->sys->springs[at].stiffness] : nan("");
        at += n;
    }
    return mt_arena_check(f->mem, err);
}
