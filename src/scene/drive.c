/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The range of a driven joint: from the lowest to the highest position that any configuration
 * of the model drives it to; where there is one alone, from the reference position to that. A
 * configuration that drives nothing, but has the joint that others drive, shows their range.
 * Configurations that are the same but for where they hold the joint share their positions.
 * Each position is found from the one before it. Modes cost many times what a position does
 * and are found where somebody asks for them.
 */
#include "scene/scene_priv.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "mechanics/geometry.h"
#include "mechanics/position.h"
#include "mechanics/sweep.h"
#include "model/values.h"

/* A drive of the model that concerns this configuration. */
typedef struct range {
    const mt_drive *drive; /* how it is held; NULL: none */
    double low;
    double high;
    double own; /* NaN: the configuration drives nothing */
} range;

static mt_scene_travel travel_of(const mt_scene_frame *f, const mt_drive *drive)
{
    const mt_scene_travel *const travel = f->extent->travel;
    return travel == NULL ? MT_TRAVEL_MODES : travel[drive->joint];
}

/* The drive to follow: the configuration's own, else the first drive of another configuration
 * whose joint and spring this one has. */
static const mt_drive *drive_of(const mt_scene_frame *f)
{
    const mt_model *const m = f->model;
    const mt_drive *const own = &m->configurations[f->configuration].drive;
    const mt_drive *found = own->given ? own : NULL;
    for (int c = 0; c < m->n_configurations && found == NULL; c++) {
        const mt_drive *const d = &m->configurations[c].drive;
        if (d->given && mt_model_present(&m->joints[d->joint].in, f->configuration) &&
            (!d->trim || mt_model_present(&m->springs[d->trim_spring].in, f->configuration))) {
            found = d;
        }
    }
    return found;
}

static mt_status find_range(const mt_scene_frame *f, range *r, mt_err *err)
{
    const mt_model *const m = f->model;
    int n = 0;
    *r = (range){.drive = drive_of(f), .low = HUGE_VAL, .high = -HUGE_VAL, .own = nan("")};
    for (int c = 0; c < m->n_configurations && r->drive != NULL; c++) {
        const mt_drive *const d = &m->configurations[c].drive;
        double at = 0.0;
        if (!d->given || d->joint != r->drive->joint) {
            continue;
        }
        MT_TRY(mt_model_number(m, c, f->ask->n_inputs, f->ask->inputs, f->ask->at, d->position,
                               f->work, &at, err));
        r->own = c == f->configuration ? at : r->own;
        if (isfinite(at)) {
            r->low = fmin(r->low, at);
            r->high = fmax(r->high, at);
            n++;
        }
    }
    if (n > 0 && r->low == r->high) {
        r->low = fmin(r->low, 0.0);
        r->high = fmax(r->high, 0.0);
    }
    r->drive = n > 0 ? r->drive : NULL;
    return MT_OK;
}

/* At work on one range. */
typedef struct walk {
    mt_scene_frame *f;
    double length;
    mt_analysis *a; /* where modes are asked for; else a system and its positions */
    mt_system *sys; /* driven from outside */
    mt_linear *lin;
    mt_scene_drive *out;
} walk;

/* pose := the poses of all bodies, turned against those of the frame: R R0^T. */
static void fill_pose(const walk *w, double *pose)
{
    const mt_scene_frame *const f = w->f;
    const mt_pose *const now = mt_linear_position(w->a != NULL ? w->a->lin : w->lin)->at.pose;
    for (int b = 0; b < f->view->n_bodies; b++) {
        const mt_pose *const p = mt_pose_of(now, b - 1);
        const mt_pose *const rest = mt_pose_of(f->pose, b - 1);
        double *const out = pose + ((ptrdiff_t)12 * b);
        for (int i = 0; i < 3; i++) {
            out[i] = creal(p->x[i]);
            for (int k = 0; k < 3; k++) {
                double sum = 0.0;
                for (int c = 0; c < 3; c++) {
                    sum += creal(p->r[i + (3 * c)]) * creal(rest->r[k + (3 * c)]);
                }
                out[3 + (3 * i) + k] = sum;
            }
            mt_scene_clean(1.0, out + 3 + ((ptrdiff_t)3 * i));
        }
        mt_scene_clean(w->length, out);
    }
}

static mt_status put_pose(const walk *w, int point, mt_err *err)
{
    mt_scene_position *const p = &w->out->positions[point];
    p->pose = mt_arena_f64(w->f->mem, 12, (size_t)w->f->view->n_bodies);
    MT_TRY(mt_arena_check(w->f->mem, err));
    fill_pose(w, p->pose);
    return MT_OK;
}

static mt_status visit_place(void *context, int point, const double *inputs, mt_err *err)
{
    const walk *const w = context;
    MT_TRY(mt_linear_set_inputs(w->lin, inputs, err));
    return put_pose(w, point, err);
}

static mt_status visit_modes(void *context, int point, const double *inputs, mt_err *err)
{
    const walk *const w = context;
    mt_scene_position *const p = &w->out->positions[point];
    mt_analysis_options opt = mt_analysis_options_default();
    opt.vectors = false;
    opt.check = false;
    opt.bounds = false;
    MT_TRY(mt_analysis_solve(w->a, inputs, &opt, err));
    MT_TRY(put_pose(w, point, err));
    p->hz = mt_arena_f64(w->f->mem, MT_SCENE_MODES, 1);
    MT_TRY(mt_arena_check(w->f->mem, err));
    for (int i = 0; i < MT_SCENE_MODES; i++) {
        const int at = mt_modal_flexible(&w->a->modes, i + 1);
        if (at >= 0) {
            p->hz[p->n_hz++] = mt_modal_hz(&w->a->modes, at);
        }
    }
    return MT_OK;
}

/* Index of the position nearest to the reference: every system is made there. */
static double nearest_of(int n, const double *positions)
{
    double least = positions[0];
    for (int i = 1; i < n; i++) {
        least = fabs(positions[i]) < fabs(least) ? positions[i] : least;
    }
    return least;
}

/* positions[n], those of w->out, and the system that is driven through them.
 * at[n_inputs + 1]. */
static mt_status prepare_positions(walk *w, const range *r, const mt_system_drive *drive,
                                   double *positions, double *at, mt_err *err)
{
    const mt_scene_frame *const f = w->f;
    const mt_scene_query *const ask = f->ask;
    const int n = w->out->n_positions;
    mt_sweep_range(r->low, r->high, n, positions);
    for (int i = 0; i < ask->n_inputs; i++) {
        at[i] = ask->at[i];
    }
    for (int i = 0; i < n; i++) {
        w->out->positions[i].at = positions[i];
    }
    at[ask->n_inputs] = nearest_of(n, positions);
    const mt_system_def def = mt_scene_system(f, drive, at);
    return mt_system_new_of(&def, &w->sys, err);
}

/* Convert a pose R R0^T of the body `from` to that of the body `to`. */
static void turn_back(const mt_scene_body *from, const mt_scene_body *to,
                      const double *rotation, double *out)
{
    double now[3][3]; /* R */
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            now[i][k] = 0.0;
            for (int c = 0; c < 3; c++) {
                now[i][k] += rotation[(3 * i) + c] * from->rotation[c + (3 * k)];
            }
        }
    }
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            double sum = 0.0;
            for (int c = 0; c < 3; c++) {
                sum += now[i][c] * to->rotation[k + (3 * c)];
            }
            out[(3 * i) + k] = sum;
        }
        mt_scene_clean(1.0, out + ((ptrdiff_t)3 * i));
    }
}

/* *shared: the positions are those of the configuration that was followed last. */
static mt_status share(walk *w, bool *shared, mt_err *err)
{
    const mt_scene_frame *const f = w->f;
    const mt_scene_view *const other = f->followed->view;
    const int bodies = f->view->n_bodies;
    const int n = w->out->n_positions;
    bool same = false;
    *shared = false;
    if (f->followed->sys != NULL && other->n_bodies == bodies &&
        other->drive->n_positions == n) {
        MT_TRY(mt_system_same_drive(f->followed->sys, w->sys, &same, err));
    }
    for (int i = 0; i < n && same; i++) {
        same = other->drive->positions[i].at == w->out->positions[i].at;
    }
    for (int i = 0; i < n && same; i++) {
        const mt_scene_position *const from = &other->drive->positions[i];
        mt_scene_position *const to = &w->out->positions[i];
        *to = *from;
        if (from->pose == NULL) {
            continue;
        }
        to->pose = mt_arena_f64(f->mem, 12, (size_t)bodies);
        MT_TRY(mt_arena_check(f->mem, err));
        memcpy(to->pose, from->pose, (size_t)12 * (size_t)bodies * sizeof *to->pose);
        for (int b = 0; b < bodies; b++) {
            const ptrdiff_t at = ((ptrdiff_t)12 * b) + 3;
            turn_back(&other->bodies[b], &f->view->bodies[b], from->pose + at, to->pose + at);
        }
    }
    *shared = same;
    return MT_OK;
}

static mt_status sweep(walk *w, const range *r, mt_err *err)
{
    mt_scene_frame *const f = w->f;
    const mt_model *const m = f->model;
    const mt_scene_query *const ask = f->ask;
    const int n = w->out->n_positions;
    const mt_system_drive drive = {
        .joint = m->joints[r->drive->joint].name.s,
        .spring = r->drive->trim ? m->springs[r->drive->trim_spring].name.s : NULL};
    const bool modes = travel_of(f, r->drive) == MT_TRAVEL_MODES;
    const mt_sweep_visitor visitor = {
        .visit = modes ? visit_modes : visit_place, .context = w, .alone = true};
    double *const at = mt_arena_f64(f->work, (size_t)ask->n_inputs + 1, 1);
    double *const positions = mt_arena_f64(f->work, (size_t)n, 1);
    bool shared = false;
    mt_sweep found;
    MT_TRY(mt_arena_check(f->work, err));
    MT_TRY(prepare_positions(w, r, &drive, positions, at, err));
    MT_TRY(share(w, &shared, err));
    if (shared) {
        return MT_OK;
    }
    if (modes) {
        const mt_system_def def = mt_scene_system(f, &drive, at);
        MT_TRY(mt_analysis_new_of(&def, 0, &w->a, err));
        w->a->recount = true; /* a spring may get hold of a direction on the way */
    } else {
        MT_TRY(mt_linear_new(w->sys, &w->lin, err));
    }
    MT_TRY(mt_sweep_run(modes ? w->a->lin : w->lin, at, n, positions, &visitor, f->work, &found,
                        err));
    for (int i = 0; i < n; i++) {
        mt_scene_position *const p = &w->out->positions[i];
        if (found.points[i].status != MT_OK) {
            p->why = mt_arena_strdup(f->mem, found.points[i].why);
            p->pose = NULL;
            p->n_hz = 0;
        }
    }
    return mt_arena_check(f->mem, err);
}

/* Keep the positions that the next configuration may share. */
static void keep_followed_positions(walk *w)
{
    mt_scene_followed *const followed = w->f->followed;
    mt_system_delete(followed->sys);
    *followed = (mt_scene_followed){.sys = w->sys, .view = w->f->view};
    w->sys = NULL;
}

mt_status mt_scene_plan(mt_scene_frame *f, mt_scene_room *left, mt_err *err)
{
    range r;
    mt_scene_view *const v = f->view;
    MT_TRY(find_range(f, &r, err));
    if (r.drive == NULL || travel_of(f, r.drive) == MT_TRAVEL_NONE) {
        return MT_OK;
    }
    mt_scene_drive *const out = mt_arena_alloc(f->mem, 1, sizeof *out);
    MT_TRY(mt_arena_check(f->mem, err));
    v->drive = out;
    out->joint = mt_arena_strdup(f->mem, f->model->joints[r.drive->joint].name.s);
    out->angle = r.drive->position_is_angle;
    out->at = r.own;
    const int n = r.low < r.high ? MT_SCENE_POSITIONS : 1;
    const double poses = (double)n * v->n_bodies;
    const double work = n * mt_scene_work(f->sys->nq);
    if (poses > left->poses || work > left->work) {
        out->why = "too many bodies to show all of them in every position";
        return MT_OK;
    }
    left->poses -= poses;
    left->work -= work;
    out->positions = mt_arena_alloc(f->mem, (size_t)n, sizeof *out->positions);
    mt_pose *const rest = mt_arena_alloc(f->kept, (size_t)f->sys->n_bodies, sizeof *rest);
    MT_TRY(mt_arena_check(f->mem, err));
    MT_TRY(mt_arena_check(f->kept, err));
    out->n_positions = n;
    memcpy(rest, f->pose, (size_t)f->sys->n_bodies * sizeof *rest);
    mt_scene_way *const way = f->way;
    *way = (mt_scene_way){
        .f = *f, .drive = r.drive, .low = r.low, .high = r.high, .length = f->sys->length_m};
    way->f.pose = rest;
    way->f.sys = NULL;
    return MT_OK;
}

mt_status mt_scene_follow(mt_scene_way *way, mt_err *err)
{
    mt_scene_frame *const f = &way->f;
    mt_scene_drive *const out = f->view->drive;
    const range r = {.drive = way->drive, .low = way->low, .high = way->high};
    walk w = {.f = f, .length = way->length, .out = out};
    mt_err why = {.code = MT_OK};
    mt_arena_clear(f->work);
    const mt_status rc = sweep(&w, &r, &why);
    mt_analysis_delete(w.a);
    mt_linear_delete(w.lin);
    if (rc == MT_OK) {
        keep_followed_positions(&w);
    }
    mt_system_delete(w.sys);
    if (rc == MT_OK) {
        return MT_OK;
    }
    out->n_positions = 0;
    out->why = mt_arena_strdup(f->mem, why.text);
    return rc == MT_E_INTERRUPTED ? mt_fail(err, rc, "%s", why.text)
                                  : mt_pass_final(rc, &why, err);
}
