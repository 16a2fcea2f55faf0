/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Values of a design in one configuration, who is who in its system, and where what is drawn
 * stands: x + R (p - c) for a point p of a body with its centre drawn at c. */
#include "scene/scene_priv.h"

/* Coordinates below this part of their vector, or of the model's length, are rounding. */
static const double ROUNDING = 1e-13;

#include <math.h>
#include <stddef.h>

#include "mechanics/data.h"
#include "model/values.h"

/* Bodies of the system come from bodies of the model, then from links, both in the order of the
 * file (mechanics/build.c). */
static void number_bodies(mt_scene_frame *f)
{
    const mt_model *const m = f->model;
    int next = 0;
    for (int i = 0; i < f->sys->n_bodies; i++) {
        f->link_of[i] = MT_ABSENT;
    }
    for (int i = 0; i < m->n_bodies; i++) {
        const bool there = mt_model_present(&m->bodies[i].in, f->configuration);
        f->body_of[i] = there ? next++ : MT_ABSENT;
    }
    for (int i = 0; i < m->n_links; i++) {
        const mt_link *const l = &m->links[i];
        const bool there = mt_model_present(&l->in, f->configuration);
        const int count = l->elements + (l->kind == MT_LINK_BEAM ? 1 : 0);
        f->link_first[i] = there ? next : MT_ABSENT;
        for (int k = 0; k < count && there; k++) {
            f->link_of[next++] = i;
        }
    }
}

bool mt_scene_same_inputs(const mt_scene_query *a, const mt_scene_query *b)
{
    bool same = a != NULL && a->n_inputs == b->n_inputs;
    for (int i = 0; i < b->n_inputs && same; i++) {
        same = a->inputs[i] == b->inputs[i];
    }
    return same;
}

/* number[numbers of the model] of the design. */
static mt_status find_numbers(const mt_scene_frame *f, double *number, mt_err *err)
{
    const mt_model *const m = f->model;
    const mt_scene_query *const a = f->ask;
    mt_scene_known *const k = f->known;
    if (!mt_scene_same_inputs(k->numbered, a)) {
        k->numbered = NULL;
        MT_TRY(mt_numbers_new(m, f->configuration, a->n_inputs, a->inputs, m->n_nums, m->nums,
                              f->kept, &k->numbers, err));
        k->numbered = a;
    }
    return mt_numbers_at(&k->numbers, a->at, number, NULL, err);
}

mt_status mt_scene_frame_new(mt_scene_frame *f, mt_err *err)
{
    const mt_model *const m = f->model;
    const mt_scene_query *const a = f->ask;
    double *const number = mt_arena_f64(f->work, (size_t)m->n_nums, 1);
    double *const value = mt_arena_f64(f->work, (size_t)f->sys->program.count, 1);
    mt_pose *const drawn = mt_arena_alloc(f->work, (size_t)f->sys->n_bodies, sizeof *drawn);
    f->body_of = mt_arena_int(f->work, (size_t)m->n_bodies);
    f->link_first = mt_arena_int(f->work, (size_t)m->n_links);
    f->link_of = mt_arena_int(f->work, (size_t)f->sys->n_bodies);
    MT_TRY(mt_arena_check(f->work, err));
    MT_TRY(find_numbers(f, number, err));
    MT_TRY(mt_program_eval(&f->sys->program, a->at, value, NULL, err));
    for (int b = 0; b < f->sys->n_bodies; b++) {
        const mt_vec_def *const centre = &f->sys->vecs[f->sys->bodies[b].centre];
        drawn[b] = mt_pose_ground();
        for (int k = 0; k < 3; k++) {
            drawn[b].x[k] = value[centre->node[k]];
        }
    }
    f->number = number;
    f->value = value;
    f->drawn = drawn;
    f->pose = drawn;
    number_bodies(f);
    return MT_OK;
}

void mt_scene_drawn(const mt_scene_frame *f, const mt_position *p, double out[3])
{
    const mt_num *const x = p->point >= 0 ? f->model->points[p->point].x : p->x;
    for (int k = 0; k < 3; k++) {
        out[k] = x[k] == MT_ABSENT ? 0.0 : f->number[x[k]];
    }
}

int mt_scene_body_of(const mt_scene_frame *f, const mt_attach *a)
{
    switch (a->kind) {
    case MT_ATTACH_GROUND:
        break;
    case MT_ATTACH_BODY:
        return f->body_of[a->index];
    case MT_ATTACH_LINK_START:
    case MT_ATTACH_LINK_END:
    case MT_ATTACH_LINK_ELEMENT:
    case MT_ATTACH_LINK_NODE:
        return f->link_first[a->index] + a->part;
    }
    return MT_GROUND;
}

/* Length of element i in parts of the link. */
static double element_part(const mt_scene_frame *f, const mt_link *l, int i, double whole)
{
    if (l->n_element_length == 0 || !(whole > 0.0)) {
        return 1.0 / (double)l->elements;
    }
    return f->number[l->element_length[l->n_element_length == 1 ? 0 : i]] / whole;
}

void mt_scene_link_at(const mt_scene_frame *f, int link, int count, bool half, double out[3])
{
    const mt_link *const l = &f->model->links[link];
    double from[3];
    double to[3];
    mt_scene_drawn(f, &l->from, from);
    mt_scene_drawn(f, &l->to, to);
    const double whole = hypot(hypot(to[0] - from[0], to[1] - from[1]), to[2] - from[2]);
    double part = l->n_element_length == 0 ? (double)count / (double)l->elements : 0.0;
    for (int i = 0; i < count && l->n_element_length > 0; i++) {
        part += element_part(f, l, i, whole);
    }
    part += half ? 0.5 * element_part(f, l, count, whole) : 0.0;
    for (int k = 0; k < 3; k++) {
        out[k] = from[k] + (part * (to[k] - from[k]));
    }
}

void mt_scene_centre(const mt_scene_frame *f, int body, double out[3])
{
    const mt_pose *const p = mt_pose_of(f->drawn, body);
    for (int k = 0; k < 3; k++) {
        out[k] = creal(p->x[k]);
    }
}

void mt_scene_clean(double size, double x[3])
{
    for (int k = 0; k < 3; k++) {
        x[k] = fabs(x[k]) > ROUNDING * size ? x[k] : 0.0;
    }
}

void mt_scene_turn(const mt_scene_frame *f, int body, const double drawn[3], double out[3])
{
    const mt_pose *const p = mt_pose_of(f->pose, body);
    for (int i = 0; i < 3; i++) {
        out[i] = 0.0;
        for (int k = 0; k < 3; k++) {
            out[i] += creal(p->r[i + (3 * k)]) * drawn[k];
        }
    }
    mt_scene_clean(hypot(hypot(drawn[0], drawn[1]), drawn[2]), out);
}

void mt_scene_place(const mt_scene_frame *f, int body, const double drawn[3], double out[3])
{
    const mt_pose *const p = mt_pose_of(f->pose, body);
    double arm[3];
    double turned[3];
    mt_scene_centre(f, body, arm);
    for (int k = 0; k < 3; k++) {
        arm[k] = drawn[k] - arm[k];
    }
    mt_scene_turn(f, body, arm, turned);
    for (int k = 0; k < 3; k++) {
        out[k] = creal(p->x[k]) + turned[k];
    }
    mt_scene_clean(f->sys->length_m, out);
}
