/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What bodies are drawn as: lines from the mass centre of a body to all that it holds, a link
 * along itself, and from there to what it holds beside it. Points with names stand where a body
 * holds them. The distance of a joint is that of its point to what is drawn of its body without
 * it: to the link's own line; or, from where the joint is farther outside the body's ellipsoid
 * than half of that one's greatest radius, to the ellipsoid and to the lines that lead
 * elsewhere. Of a body without an ellipsoid nobody knows the extent: there a joint is far off
 * where it is farther than all else in the drawing is wide.
 */
#include "scene/scene_priv.h"

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "scene/distance.h"

/* Places nearer than this part of what their coordinates are the difference of are one. */
static const double SAME = 1e-9;
/* So many greatest radii outside its ellipsoid is far from a body. */
static const double FAR_RADII = 0.5;
/* Lines of one body, and points that are compared for being the same. */
enum { MOST_LINES = 200 };
/* What is kept of a distance. */
enum { DISTANCE_BITS = 30 };

/* A place that a body holds. */
typedef struct hold {
    int body;  /* of the view */
    int joint; /* of the view; -1: of something else */
    int point; /* with a name, of the model; -1 */
    int next;  /* of the same body; -1 */
    double at[3];
} hold;

typedef struct holds {
    mt_scene_frame *f;
    int n;
    int capacity;
    hold *items;
    int *first; /* [bodies of the view] */
    int *last;
    double low[3]; /* box around bodies and places */
    double high[3];
} holds;

static void include_in_hold_box(holds *h, const double x[3])
{
    for (int k = 0; k < 3; k++) {
        h->low[k] = fmin(h->low[k], x[k]);
        h->high[k] = fmax(h->high[k], x[k]);
    }
}

static void add_hold(holds *h, int body, int joint, int point, const double at[3])
{
    hold *const grown = mt_arena_grow(h->f->work, h->items, h->n, &h->capacity, sizeof *grown);
    if (grown == NULL) {
        return;
    }
    h->items = grown;
    h->items[h->n] = (hold){body, joint, point, -1, {at[0], at[1], at[2]}};
    if (h->first[body] < 0) {
        h->first[body] = h->n;
    } else {
        h->items[h->last[body]].next = h->n;
    }
    h->last[body] = h->n++;
    include_in_hold_box(h, at);
}

/* A position of the model on a body of the system. */
static void add_position(holds *h, int body, int joint, const mt_position *p)
{
    double drawn[3];
    double at[3];
    mt_scene_drawn(h->f, p, drawn);
    mt_scene_place(h->f, body, drawn, at);
    add_hold(h, body + 1, joint, p->point, at);
}

static void add_pairs(holds *h)
{
    const mt_model *const m = h->f->model;
    int joint = 0;
    for (int i = 0; i < m->n_joints; i++) {
        const mt_joint *const j = &m->joints[i];
        if (!mt_model_present(&j->in, h->f->configuration)) {
            continue;
        }
        for (int side = 0; side < 2 && j->n_at > 0; side++) {
            add_position(h, mt_scene_body_of(h->f, &j->bodies[side]), joint,
                         &j->at[j->n_at == 2 ? side : 0]);
        }
        joint++;
    }
    for (int i = 0; i < m->n_springs; i++) {
        const mt_spring *const s = &m->springs[i];
        const bool there = mt_model_present(&s->in, h->f->configuration) && s->n_at > 0;
        for (int side = 0; side < 2 && there; side++) {
            add_position(h, mt_scene_body_of(h->f, &s->bodies[side]), -1,
                         &s->at[s->n_at == 2 ? side : 0]);
        }
    }
}

static void add_others(holds *h)
{
    const mt_scene_frame *const f = h->f;
    const mt_model *const m = f->model;
    for (int i = 0; i < m->n_bodies; i++) {
        if (f->body_of[i] != MT_ABSENT) {
            add_position(h, f->body_of[i], -1, &m->bodies[i].centre);
        }
    }
    for (int i = 0; i < m->n_links; i++) {
        const mt_link *const l = &m->links[i];
        if (f->link_first[i] != MT_ABSENT) {
            const int last = f->link_first[i] + l->elements - (l->kind == MT_LINK_BEAM ? 0 : 1);
            add_position(h, f->link_first[i], -1, &l->from);
            add_position(h, last, -1, &l->to);
        }
    }
    for (int i = 0; i < m->n_sensors; i++) {
        const mt_sensor *const s = &m->sensors[i];
        if (s->on_kind == MT_ATTACH_BODY && s->at.given && f->body_of[s->on] != MT_ABSENT) {
            add_position(h, f->body_of[s->on], -1, &s->at);
        }
    }
    for (int i = 0; i < m->n_loads; i++) {
        const mt_load *const o = &m->loads[i];
        if (o->on.name.s != NULL && o->at.given && mt_model_present(&o->in, f->configuration)) {
            add_position(h, mt_scene_body_of(f, &o->on), -1, &o->at);
        }
    }
}

/* Own line of a link's element or node of the view, in the pose. */
static void link_line(const mt_scene_frame *f, int body, double from[3], double to[3])
{
    const int b = body - 1;
    const int link = f->link_of[b];
    const int k = b - f->link_first[link];
    const mt_link *const l = &f->model->links[link];
    double drawn[2][3];
    if (l->kind == MT_LINK_BEAM) { /* half of the elements beside a node */
        mt_scene_link_at(f, link, k > 0 ? k - 1 : 0, k > 0, drawn[0]);
        mt_scene_link_at(f, link, k, k < l->elements, drawn[1]);
    } else {
        mt_scene_link_at(f, link, k, false, drawn[0]);
        mt_scene_link_at(f, link, k + 1, false, drawn[1]);
    }
    mt_scene_place(f, b, drawn[0], from);
    mt_scene_place(f, b, drawn[1], to);
}

static double hold_box_size(const holds *h)
{
    return mt_distance_points(h->low, h->high);
}

static void add_view_line(mt_scene_view *v, int *capacity, mt_arena *mem,
                          const mt_scene_line *line)
{
    mt_scene_line *const grown =
        mt_arena_grow(mem, v->lines, v->n_lines, capacity, sizeof *grown);
    if (grown != NULL) {
        v->lines = grown;
        v->lines[v->n_lines++] = *line;
    }
}

/* True where there is a line of the body to this place already. They begin at `first`. */
static bool has_line(const mt_scene_view *v, int first, const double to[3], double same)
{
    bool has = false;
    for (int i = first; i < v->n_lines && !has; i++) {
        has = mt_distance_points(v->lines[i].to, to) <= same;
    }
    return has;
}

static void lines_of(const holds *h, int body, int *capacity)
{
    mt_scene_view *const v = h->f->view;
    const bool link = v->bodies[body].kind == MT_SCENE_LINK;
    const double same = SAME * hold_box_size(h);
    const int first = v->n_lines;
    mt_scene_line own = {.body = body};
    if (link) {
        link_line(h->f, body, own.from, own.to);
        add_view_line(v, capacity, h->f->mem, &own);
    }
    for (int i = h->first[body]; i >= 0 && v->n_lines - first < MOST_LINES;
         i = h->items[i].next) {
        mt_scene_line line = {.body = body};
        double off = mt_distance_points(v->bodies[body].at, h->items[i].at);
        memcpy(line.from, v->bodies[body].at, sizeof line.from);
        memcpy(line.to, h->items[i].at, sizeof line.to);
        if (link) {
            off = mt_distance_segment(own.from, own.to, line.to, line.from);
        }
        if (off > same && !has_line(v, first, line.to, same)) {
            add_view_line(v, capacity, h->f->mem, &line);
        }
    }
}

/* Distance to the lines from the centre of a body to its other items, without this joint. */
static double distance_to_lines(const holds *h, int body, int joint, const double at[3])
{
    const double *const centre = h->f->view->bodies[body].at;
    double least = mt_distance_points(centre, at);
    int seen = 0;
    for (int i = h->first[body]; i >= 0 && seen < MOST_LINES; i = h->items[i].next, seen++) {
        if (h->items[i].joint != joint) {
            least = fmin(least, mt_distance_segment(centre, h->items[i].at, at, NULL));
        }
    }
    return least;
}

/* Size of the drawing without one joint. */
static double rest_of(const holds *h, int joint)
{
    const mt_scene_view *const v = h->f->view;
    holds rest = {.low = {HUGE_VAL, HUGE_VAL, HUGE_VAL},
                  .high = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
    for (int i = 1; i < v->n_bodies; i++) {
        include_in_hold_box(&rest, v->bodies[i].at);
    }
    for (int i = 0; i < h->n; i++) {
        if (h->items[i].joint != joint) {
            include_in_hold_box(&rest, h->items[i].at);
        }
    }
    return hold_box_size(&rest);
}

static double distance_to_body(const holds *h, int body, int joint, const double at[3])
{
    const mt_scene_body *const b = &h->f->view->bodies[body];
    const mt_scene_ellipsoid *const e = b->ellipsoid;
    const double lines = distance_to_lines(h, body, joint, at);
    if (e == NULL) {
        return lines > rest_of(h, joint) ? lines : 0.0;
    }
    double x[3];
    for (int i = 0; i < 3; i++) {
        x[i] = 0.0;
        for (int k = 0; k < 3; k++) {
            x[i] += e->axes[i][k] * (at[k] - b->at[k]);
        }
    }
    const double outside = mt_distance_ellipsoid(e->radii, x);
    const double greatest = fmax(fmax(e->radii[0], e->radii[1]), e->radii[2]);
    return outside > FAR_RADII * greatest ? fmin(outside, lines) : 0.0;
}

static void note_joint_distance(const holds *h, const hold *it)
{
    mt_scene_view *const v = h->f->view;
    mt_scene_joint *const joint = &v->joints[it->joint];
    double off = 0.0;
    switch (v->bodies[it->body].kind) {
    case MT_SCENE_GROUND:
        return;
    case MT_SCENE_LINK: {
        double from[3];
        double to[3];
        link_line(h->f, it->body, from, to);
        off = mt_distance_segment(from, to, it->at, NULL);
        break;
    }
    case MT_SCENE_BODY:
        off = distance_to_body(h, it->body, it->joint, it->at);
        break;
    }
    /* rounded, so that configurations of one shape have one distance */
    const double step = ldexp(1.0, ilogb(fmax(off, DBL_MIN)) - DISTANCE_BITS);
    off = step * rint(off / step);
    if (off > SAME * hold_box_size(h) && off > joint->distance) {
        joint->distance = off;
        joint->far = it->body;
    }
}

/* Each point with a name once where its bodies agree about its place. */
static void name_points(const holds *h)
{
    mt_scene_view *const v = h->f->view;
    const mt_model *const m = h->f->model;
    int *const seen = mt_arena_int(h->f->work, (size_t)m->n_points);
    int capacity = 0;
    if (mt_arena_failed(h->f->work)) {
        return;
    }
    for (int pass = 0; pass < 2; pass++) { /* bodies before the ground, which stands still */
        for (int i = 0; i < h->n; i++) {
            const hold *const it = &h->items[i];
            if (it->point < 0 || (it->body == 0) != (pass == 1)) {
                continue;
            }
            const int last = seen[it->point];
            if (last > 0 && (mt_distance_points(v->points[last - 1].at, it->at) <=
                                 SAME * hold_box_size(h) ||
                             v->points[last - 1].body == it->body)) {
                continue;
            }
            mt_scene_point *const grown =
                mt_arena_grow(h->f->mem, v->points, v->n_points, &capacity, sizeof *grown);
            if (grown == NULL) {
                return;
            }
            v->points = grown;
            mt_scene_point *const p = &v->points[v->n_points++];
            p->name = mt_arena_strdup(h->f->mem, m->points[it->point].name.s);
            p->body = it->body;
            memcpy(p->at, it->at, sizeof p->at);
            seen[it->point] = v->n_points;
        }
    }
}

mt_status mt_scene_lines(mt_scene_frame *f, mt_err *err)
{
    mt_scene_view *const v = f->view;
    holds h = {.f = f,
               .first = mt_arena_int(f->work, (size_t)v->n_bodies),
               .last = mt_arena_int(f->work, (size_t)v->n_bodies),
               .low = {HUGE_VAL, HUGE_VAL, HUGE_VAL},
               .high = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
    int capacity = 0;
    MT_TRY(mt_arena_check(f->work, err));
    for (int i = 0; i < v->n_bodies; i++) {
        h.first[i] = -1;
        if (i > 0) {
            include_in_hold_box(&h, v->bodies[i].at);
        }
    }
    add_pairs(&h);
    add_others(&h);
    MT_TRY(mt_arena_check(f->work, err));
    for (int i = 1; i < v->n_bodies; i++) {
        lines_of(&h, i, &capacity);
    }
    for (int i = 0; i < h.n; i++) {
        if (h.items[i].joint >= 0) {
            note_joint_distance(&h, &h.items[i]);
        }
    }
    name_points(&h);
    MT_TRY(mt_arena_check(f->work, err));
    return mt_arena_check(f->mem, err);
}
