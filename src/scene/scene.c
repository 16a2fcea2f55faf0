/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Designs and configurations in order, with their modes, energies and the range of a driven
 * joint. */
#include "scene/scene.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/lowest.h"
#include "base/workers.h"
#include "mechanics/data.h"
#include "mechanics/geometry.h"
#include "mechanics/lagrangian.h"
#include "mechanics/position.h"
#include "mechanics/rows.h"
#include "mechanics/sweep.h"
#include "model/values.h"
#include "scene/items.h"

/* Capacity of a page: items (bodies, and four joints, springs, sensors or the like as one) of
 * one configuration; items of all configurations and designs; bodies times the positions of
 * their drives. What exceeds it is left out with a message. */
enum { SCENE_ITEMS = 3000, SCENE_ALL_ITEMS = 9000, SCENE_POSES = 40000 };

/* The remaining capacity of a page. */
typedef struct scene_room {
    double items;
    double poses;
    double work;
} scene_room;

/* The system of the frame's configuration with a drive (NULL: none) at inputs
 * at[n_inputs of ask], and with a drive one more. */
static mt_system_def system_of(const mt_scene_frame *f, const mt_system_drive *drive,
                               const double *at)
{
    return (mt_system_def){.model = f->model,
                           .configuration = f->configuration,
                           .drive = drive,
                           .n_inputs = f->ask->n_inputs,
                           .inputs = f->ask->inputs,
                           .at = at};
}

/* Shares of one mode of eigenvalue lambda. spring[springs of the view],
 * body[bodies of the view]. */
typedef struct scene_energy scene_energy;

static double scene_work(double coordinates);

/*
 * Shares of the energies of a mode phi, term by term over the rows f of stiffness and mass:
 *     spring s   sum_t c_t (f_t . phi)^2 over its terms,
 *     body b     sum_t m_t (f_t . phi) sum_(i of b) f_ti phi_i,
 * the second being what the body's own momentum does, which adds up to phi^T M phi = 1. What is
 * left of lambda besides the springs is done by loads (geometric stiffness) and counts by its
 * magnitude: so shares never add up to more than 1, and stay what they are where a load takes
 * stiffness away.
 */

struct scene_energy {
    const mt_scene_frame *f;
    mt_term_list list[MT_TERM_KINDS];
    double *rows[MT_TERM_KINDS]; /* 12 x n_rows, of stiffness and mass */
};

static mt_status scene_energy_new(const mt_scene_frame *f, scene_energy **out, mt_err *err)
{
    static const mt_term_kind kinds[] = {MT_TERM_STIFFNESS, MT_TERM_MASS};
    scene_energy *const e = mt_arena_alloc(f->work, 1, sizeof *e);
    mt_data data;
    MT_TRY(mt_arena_check(f->work, err));
    e->f = f;
    MT_TRY(mt_terms_new(f->sys, f->work, e->list, err));
    for (int i = 0; i < MT_COUNT(kinds); i++) {
        const size_t size = (size_t)e->list[kinds[i]].n_rows * MT_LOCAL;
        e->rows[kinds[i]] = mt_arena_f64(f->work, size, 1);
    }
    const mt_arena_mark mark = mt_arena_get_mark(f->work);
    MT_TRY(mt_data_init(&data, f->sys, f->work, err));
    data.value = f->value;
    mt_data_vecs(&data);
    for (int i = 0; i < MT_COUNT(kinds); i++) {
        const size_t size = (size_t)e->list[kinds[i]].n_rows * MT_LOCAL;
        mt_cx *const rows = mt_arena_alloc(f->work, size, sizeof *rows);
        MT_TRY(mt_arena_check(f->work, err));
        mt_rows_eval(&data, kinds[i], &e->list[kinds[i]], f->pose, rows);
        for (size_t k = 0; k < size; k++) {
            e->rows[kinds[i]][k] = creal(rows[k]);
        }
    }
    mt_arena_rewind(f->work, mark);
    *out = e;
    return MT_OK;
}

/* f . phi by the freedoms of either body of a term: part[2]; returns their sum. */
static double row_mode_product(const mt_system *sys, const mt_term *t, const double *row,
                               const double *phi, double part[2])
{
    part[0] = 0.0;
    part[1] = 0.0;
    for (int k = 0; k < MT_LOCAL; k++) {
        const int dof = mt_local_dof(sys, t->body, k);
        part[k / 6] += dof >= 0 ? row[k] * phi[dof] : 0.0;
    }
    return part[0] + part[1];
}

/* What a term adds to the energy, by the bodies that it acts on. */
static double term_energy(const scene_energy *e, mt_term_kind kind, const mt_term *t,
                          const double *phi, double of[2])
{
    const mt_system *const sys = e->f->sys;
    const double *const rows = e->rows[kind] + ((ptrdiff_t)t->first * MT_LOCAL);
    const double c = e->f->value[t->coefficient];
    double a[2];
    double b[2];
    of[0] = 0.0;
    of[1] = 0.0;
    if (t->pair) {
        const double sa = row_mode_product(sys, t, rows, phi, a);
        const double sb = row_mode_product(sys, t, rows + MT_LOCAL, phi, b);
        for (int side = 0; side < 2; side++) {
            of[side] = 0.5 * c * ((sa * b[side]) + (sb * a[side]));
        }
        return c * sa * sb;
    }
    double sum = 0.0;
    for (int r = 0; r < t->count; r++) {
        const double s = row_mode_product(sys, t, rows + ((ptrdiff_t)r * MT_LOCAL), phi, a);
        sum += c * s * s;
        of[0] += c * s * a[0];
        of[1] += c * s * a[1];
    }
    return sum;
}

/* Normalise energies by their sum and |rest|; negative ones, which are rounding, become 0. */
static void share_out(int n, double *energy, double rest)
{
    double sum = fabs(rest);
    for (int i = 0; i < n; i++) {
        energy[i] = fmax(energy[i], 0.0);
        sum += energy[i];
    }
    for (int i = 0; i < n; i++) {
        energy[i] = sum > 0.0 && isfinite(sum) ? energy[i] / sum : 0.0;
    }
}

static void scene_energy_of(const scene_energy *e, double lambda, const double *phi,
                            double *spring, double *body)
{
    const mt_scene_view *const v = e->f->view;
    const mt_term_list *const stiffness = &e->list[MT_TERM_STIFFNESS];
    const mt_term_list *const mass = &e->list[MT_TERM_MASS];
    double elastic = 0.0;
    double of[2];
    for (int i = 0; i < stiffness->n_terms; i++) {
        const mt_term *const t = &stiffness->terms[i];
        const double energy = term_energy(e, MT_TERM_STIFFNESS, t, phi, of);
        const int at = e->f->spring_of[t->source];
        if (at >= 0) {
            spring[at] += energy;
        }
        elastic += energy;
    }
    for (int i = 0; i < mass->n_terms; i++) {
        const mt_term *const t = &mass->terms[i];
        (void)term_energy(e, MT_TERM_MASS, t, phi, of);
        body[t->body[0] + 1] += of[0];
        body[t->body[1] + 1] += of[1];
    }
    share_out(v->n_springs, spring,
              e->f->sys->loaded || e->f->sys->driven ? lambda - elastic : 0.0);
    share_out(v->n_bodies, body, 0.0);
}

/* Modes as small motions of all bodies: a point p moves by t + r x (p - c). */

/* Components of a motion below this part of its largest displacement are rounding. */
static const double ROUNDING = 1e-10;

/* How far a point of a body moves. */
static double moved(const mt_scene_body *b, const double *motion, const double p[3])
{
    const double d[3] = {p[0] - b->at[0], p[1] - b->at[1], p[2] - b->at[2]};
    const double *const r = motion + 3;
    return hypot(hypot(motion[0] + (r[1] * d[2]) - (r[2] * d[1]),
                       motion[1] + (r[2] * d[0]) - (r[0] * d[2])),
                 motion[2] + (r[0] * d[1]) - (r[1] * d[0]));
}

/* Largest displacement of the two ends of a spring or a joint. */
static double ends_moved(const mt_scene_view *v, const double *motion, const int body[2],
                         const double end[2][3])
{
    double most = 0.0;
    for (int side = 0; side < 2; side++) {
        const double *const own = motion + ((ptrdiff_t)6 * body[side]);
        most = fmax(most, moved(&v->bodies[body[side]], own, end[side]));
    }
    return most;
}

/* The largest displacement of what is drawn; where none moves, a turn counts by the size of
 * its ellipsoid, or by itself. */
static double largest_drawn_motion(const mt_scene_view *v, const double *motion)
{
    double most = 0.0;
    double turn = 0.0;
    for (int i = 0; i < v->n_bodies; i++) {
        const mt_scene_body *const b = &v->bodies[i];
        const double *const m = motion + ((ptrdiff_t)6 * i);
        const double rate = hypot(hypot(m[3], m[4]), m[5]);
        most = fmax(most, moved(b, m, b->at));
        most = fmax(most, b->ellipsoid == NULL ? 0.0 : rate * b->ellipsoid->radii[0]);
        turn = fmax(turn, rate);
    }
    for (int i = 0; i < v->n_lines; i++) {
        const mt_scene_line *const l = &v->lines[i];
        const double *const own = motion + ((ptrdiff_t)6 * l->body);
        most = fmax(most, moved(&v->bodies[l->body], own, l->from));
        most = fmax(most, moved(&v->bodies[l->body], own, l->to));
    }
    for (int i = 0; i < v->n_springs; i++) {
        const mt_scene_spring *const s = &v->springs[i];
        most = fmax(most, ends_moved(v, motion, s->body, (const double(*)[3])s->end));
    }
    for (int i = 0; i < v->n_joints; i++) {
        const mt_scene_joint *const j = &v->joints[i];
        most = fmax(most, ends_moved(v, motion, j->body, (const double(*)[3])j->end));
    }
    return most > 0.0 ? most : turn;
}

static void fill_motion(const mt_scene_frame *f, const double *phi, double *motion)
{
    mt_scene_view *const v = f->view;
    const ptrdiff_t n = (ptrdiff_t)6 * v->n_bodies;
    for (int b = 0; b < f->sys->n_bodies; b++) {
        for (int k = 0; k < 6; k++) {
            const int dof = f->sys->bodies[b].dof[k];
            motion[(6 * ((ptrdiff_t)b + 1)) + k] = dof >= 0 ? phi[dof] : 0.0;
        }
    }
    const double most = largest_drawn_motion(v, motion);
    for (ptrdiff_t i = 0; i < n; i++) {
        motion[i] = most > 0.0 && isfinite(most) ? motion[i] / most : 0.0;
    }
    double turns = 0.0; /* entries are cleaned in their own unit */
    for (ptrdiff_t i = 0; i < n; i++) {
        turns = i % 6 >= 3 ? fmax(turns, fabs(motion[i])) : turns;
    }
    for (ptrdiff_t i = 0; i < n; i++) {
        const double least = ROUNDING * (i % 6 >= 3 ? turns : 1.0);
        motion[i] = fabs(motion[i]) > least ? motion[i] : 0.0;
    }
}

static const char *note_of(mt_mode_kind kind)
{
    switch (kind) {
    case MT_MODE_FLEXIBLE:
        return NULL;
    case MT_MODE_RIGID_BODY:
        return "rigid-body";
    case MT_MODE_UNDECIDED:
        return "undecided";
    case MT_MODE_UNSTABLE:
        break;
    }
    return "unstable";
}

static const char *find_mode_name(const mt_scene_frame *f, int index)
{
    for (int i = 0; i < f->ask->n_names; i++) {
        const mt_scene_name *const n = &f->ask->names[i];
        if (n->configuration == f->configuration && n->index == index && index > 0) {
            return mt_arena_strdup(f->mem, n->name);
        }
    }
    return NULL;
}

static mt_status fill_mode(mt_scene_frame *f, const mt_modes *modes, int i, const double *phi,
                           const scene_energy *energy, mt_err *err)
{
    mt_scene_view *const v = f->view;
    mt_scene_mode *const out = &v->modes[v->n_modes];
    const bool indexed = modes->kind[i] == MT_MODE_FLEXIBLE && modes->n_undecided == 0;
    out->motion = mt_arena_f64(f->mem, 6, (size_t)v->n_bodies);
    out->spring_share = mt_arena_f64(f->mem, (size_t)v->n_springs, 1);
    out->body_share = mt_arena_f64(f->mem, (size_t)v->n_bodies, 1);
    MT_TRY(mt_arena_check(f->mem, err));
    out->index = indexed ? mt_modal_index(modes, i) : 0;
    out->hz = mt_modal_hz(modes, i);
    out->note = note_of(modes->kind[i]);
    out->name = find_mode_name(f, out->index);
    fill_motion(f, phi, out->motion);
    scene_energy_of(energy, modes->lambda[i], phi, out->spring_share, out->body_share);
    for (int k = 0; k < v->n_springs && modes->kind[i] == MT_MODE_RIGID_BODY; k++) {
        out->spring_share[k] = 0.0; /* what is left is rounding */
    }
    v->n_modes++;
    return MT_OK;
}

/* Of the first `shown` modes, with shapes phi over the states of the system. */
static mt_status scene_modes(mt_scene_frame *f, const mt_modes *modes, int shown,
                             const double *phi, mt_err *err)
{
    scene_energy *energy = NULL;
    MT_TRY(scene_energy_new(f, &energy, err));
    f->view->modes = mt_arena_alloc(f->mem, (size_t)shown, sizeof *f->view->modes);
    MT_TRY(mt_arena_check(f->mem, err));
    for (int i = 0, others = 0; i < shown; i++) {
        others += modes->kind[i] == MT_MODE_FLEXIBLE ? 0 : 1;
        if (modes->kind[i] == MT_MODE_FLEXIBLE || others <= MT_SCENE_MODES) {
            MT_TRY(fill_mode(f, modes, i, phi + ((ptrdiff_t)i * f->sys->nq), energy, err));
        }
    }
    return mt_arena_check(f->mem, err);
}

/*
 * The range of a driven joint: from the lowest to the highest position that any configuration
 * of the model drives it to; where there is one alone, from the reference position to that. A
 * configuration that drives nothing, but has the joint that others drive, shows their range. Of
 * several driven joints one is followed, and the others stay where the configuration has them.
 * Configurations that are the same but for where they hold the joint share their positions.
 * Each position is found from the one before it. Modes cost many times what a position does
 * and are found where somebody asks for them.
 */

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

/* How a configuration drives a joint; NULL: not at all. */
static const mt_drive *drive_of_joint(const mt_configuration *c, int joint)
{
    for (int i = 0; i < c->n_drives; i++) {
        if (c->drives[i].joint == joint) {
            return &c->drives[i];
        }
    }
    return NULL;
}

static const mt_drive *first_followable(const mt_scene_frame *f, const mt_configuration *c)
{
    const mt_model *const m = f->model;
    for (int i = 0; i < c->n_drives; i++) {
        const mt_drive *const d = &c->drives[i];
        if (mt_model_present(&m->joints[d->joint].in, f->configuration) &&
            (!d->trim || mt_model_present(&m->springs[d->trim_spring].in, f->configuration))) {
            return d;
        }
    }
    return NULL;
}

/* Positions of a joint in all configurations that drive it. */
static mt_status range_of_drive(const mt_scene_frame *f, const mt_drive *drive, range *r,
                                mt_err *err)
{
    const mt_model *const m = f->model;
    int n = 0;
    *r = (range){.low = HUGE_VAL, .high = -HUGE_VAL, .own = nan("")};
    for (int c = 0; c < m->n_configurations; c++) {
        const mt_drive *const d = drive_of_joint(&m->configurations[c], drive->joint);
        double at = 0.0;
        if (d == NULL) {
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
    r->drive = n > 0 ? drive : NULL;
    return MT_OK;
}

/* The drive to follow: the first of the configuration's own whose positions differ between
 * configurations, else its first; without any, the first drive of another configuration whose
 * joint and spring this one has. */
static mt_status find_range(const mt_scene_frame *f, range *r, mt_err *err)
{
    const mt_model *const m = f->model;
    const mt_configuration *const own = &m->configurations[f->configuration];
    const mt_drive *other = NULL;
    *r = (range){.drive = NULL, .own = nan("")};
    for (int i = 0; i < own->n_drives; i++) {
        range next;
        MT_TRY(range_of_drive(f, &own->drives[i], &next, err));
        const bool first = r->drive == NULL && next.drive != NULL;
        const bool wider = r->drive != NULL && r->low == r->high && next.low < next.high;
        *r = first || wider ? next : *r;
    }
    for (int c = 0; c < m->n_configurations && own->n_drives == 0 && other == NULL; c++) {
        other = first_followable(f, &m->configurations[c]);
    }
    if (other != NULL) {
        MT_TRY(range_of_drive(f, other, r, err));
    }
    if (r->drive != NULL && r->low == r->high) {
        r->low = fmin(r->low, 0.0);
        r->high = fmax(r->high, 0.0);
    }
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
    const mt_system_def def = system_of(f, drive, at);
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
        int joint = -1;
        MT_TRY(mt_system_same_drive(f->followed->sys, w->sys, &same, &joint, err));
        same = same && joint < 0; /* in all drives, of which one is followed */
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
        const mt_system_def def = system_of(f, &drive, at);
        MT_TRY(mt_analysis_new_of(&def, 0, &w->a, err));
        w->a->recount = true; /* a spring may get hold of a direction on the way */
    } else {
        MT_TRY(mt_linear_new(w->sys, &w->lin, err));
    }
    const mt_sweep_plan plan = {.n = n, .positions = positions};
    MT_TRY(mt_sweep_run(modes ? w->a->lin : w->lin, at, &plan, &visitor, f->work, &found, err));
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

/* Plan the range of the driven joint, where there is one and capacity for it, in
 * f->way. */
static mt_status scene_plan(mt_scene_frame *f, scene_room *left, mt_err *err)
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
    const double work = n * scene_work(f->sys->nq);
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

/* Follow the planned range: way->f has a mem, a work and a followed of the caller's own. Fails:
 * MT_E_MEMORY, MT_E_INTERRUPTED, MT_E_INTERNAL. */
static mt_status scene_follow(mt_scene_way *way, mt_err *err)
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

/* The scene. */

/* Approximate operations for the modes of a configuration of so many coordinates. */
static double scene_work(double coordinates)
{
    /* of a reduction to tridiagonal form and back, and of what comes before */
    return 20.0 * coordinates * coordinates * coordinates;
}

/* About how much there is to show in a configuration. */
static double items_of(const mt_model *m, int configuration)
{
    const double others = (double)m->n_joints + (double)m->n_springs + (double)m->n_sensors +
                          (double)m->n_loads + (double)m->n_points;
    return mt_lowest_bodies(m, configuration) + (others / 4.0);
}

/* Positions of modes to show: those before the vibration mode that is one too many. */
static int shown_of(const mt_modes *modes)
{
    int flexible = 0;
    for (int i = 0; i < modes->count; i++) {
        if (modes->kind[i] == MT_MODE_FLEXIBLE && ++flexible > MT_SCENE_MODES) {
            return i;
        }
    }
    return modes->count;
}

/* Add all items at rest. */
static mt_status draw(mt_scene_frame *f, mt_err *err)
{
    MT_TRY(mt_scene_bodies(f, err));
    MT_TRY(mt_scene_items(f, err));
    MT_TRY(mt_scene_springs(f, err));
    return mt_scene_lines(f, err);
}

/* Values of a design in one configuration, and who is who in its system. */

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

/* True where both queries have the same inputs; false where a is NULL. */
static bool same_inputs(const mt_scene_query *a, const mt_scene_query *b)
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
    if (!same_inputs(k->numbered, a)) {
        k->numbered = NULL;
        MT_TRY(mt_numbers_new(m, f->configuration, a->n_inputs, a->inputs, m->n_nums, m->nums,
                              f->kept, &k->numbers, err));
        k->numbered = a;
    }
    mt_numbers_at(&k->numbers, a->at, number, NULL);
    return MT_OK;
}

/* Set the values of the design and the index maps; sys, ask, model, configuration, mem, work
 * and view are given. Fails: MT_E_DOMAIN, MT_E_MEMORY, MT_E_INTERNAL. */
static mt_status set_frame(mt_scene_frame *f, mt_err *err)
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

/* Position at rest and modes by full matrices. */
static mt_status by_analysis(mt_scene_frame *f, mt_analysis *a, mt_err *err)
{
    f->sys = a->sys;
    MT_TRY(set_frame(f, err));
    f->pose = mt_linear_position(a->lin)->at.pose;
    MT_TRY(draw(f, err));
    int shown = shown_of(&a->modes);
    shown = shown < a->modes.shaped ? shown : a->modes.shaped;
    double *const phi = mt_arena_f64(f->work, (size_t)f->sys->nq, (size_t)shown);
    MT_TRY(mt_arena_check(f->work, err));
    mt_linear_expand(a->lin, shown, a->modes.y, phi);
    return scene_modes(f, &a->modes, shown, phi, err);
}

/* The lowest modes of a large mechanism, which is at rest as drawn. */
static mt_status by_lowest(mt_scene_frame *f, mt_lowest *l, mt_err *err)
{
    const mt_modes *const m = &l->found.modes;
    f->sys = l->sys;
    MT_TRY(set_frame(f, err));
    MT_TRY(draw(f, err));
    const int shown = shown_of(m);
    double *const phi = mt_arena_f64(f->work, (size_t)f->sys->nq, (size_t)shown);
    MT_TRY(mt_arena_check(f->work, err));
    MT_TRY(mt_lowest_shapes(l, shown, phi, err));
    return scene_modes(f, m, shown, phi, err);
}

/* The drawing alone, of what cannot be analysed. Failing that, nothing. */
static mt_status as_drawn(mt_scene_frame *f, mt_err *err)
{
    const mt_system_def def = system_of(f, NULL, f->ask->at);
    mt_system *sys = NULL;
    mt_status rc = mt_system_new_of(&def, &sys, err);
    f->sys = sys;
    rc = rc == MT_OK ? set_frame(f, err) : rc;
    rc = rc == MT_OK ? draw(f, err) : rc;
    mt_system_delete(sys);
    return rc;
}

/* The analysis of the configuration at this design. That of the previous design is reused for
 * all that designs do not change, and its position is computed as if it were new. It remains
 * owned by its keeper. */
static mt_status analyse(const mt_scene_frame *f, mt_err *err)
{
    const mt_scene_query *const a = f->ask;
    mt_scene_known *const known = f->known;
    if (known->by != NULL && same_inputs(known->ask, a)) {
        mt_analysis_options opt = mt_analysis_options_default();
        mt_err why = {.code = MT_OK};
        opt.modes.first = MT_SCENE_MODES;
        known->by->n_rigid = -1; /* each design is counted by itself */
        const mt_status rc = mt_analysis_solve(known->by, a->at, &opt, &why);
        if (rc == MT_OK || mt_is_final(rc) || rc == MT_E_INTERRUPTED) {
            return rc == MT_OK ? rc : mt_fail(err, rc, "%s", why.text);
        }
    }
    mt_analysis_delete(known->by);
    known->by = NULL;
    known->ask = a;
    const mt_system_def def = system_of(f, NULL, a->at);
    return mt_analysis_new_of(&def, MT_SCENE_MODES, &known->by, err);
}

static mt_status analyse_frame(mt_scene_frame *f, scene_room *left, mt_err *err)
{
    const mt_scene_query *const a = f->ask;
    const double bodies = mt_lowest_bodies(f->model, f->configuration);
    const double work = scene_work(bodies * (f->model->dimension == 2 ? 3.0 : 6.0));
    const mt_lowest_want want = {.count = MT_SCENE_MODES, .shapes = true, .drawn = true};
    mt_lowest *l = NULL;
    mt_status rc = MT_OK;
    if (bodies >= MT_LOWEST_BODIES) {
        const mt_system_def def = system_of(f, NULL, a->at);
        rc = mt_lowest_new(&def, want, &l, err);
    }
    if (rc == MT_OK && l != NULL && l->way != MT_LOWEST_NONE) {
        rc = by_lowest(f, l, err);
    } else if (rc == MT_OK && work > left->work) {
        rc = mt_fail(err, MT_E_INPUT, "%.0f bodies are too many for all modes%s%s", bodies,
                     l == NULL ? "" : ": ", l == NULL ? "" : l->why);
    } else if (rc == MT_OK) {
        left->work -= work;
        rc = analyse(f, err);
        rc = rc == MT_OK ? by_analysis(f, f->known->by, err) : rc;
    }
    rc = rc == MT_OK ? scene_plan(f, left, err) : rc;
    mt_lowest_delete(l);
    return rc;
}

/* Fill one configuration of a design; a failure is stored in it. */
static mt_status view_new(mt_scene_frame *f, scene_room *left, mt_err *err)
{
    const char *const name = f->model->configurations[f->configuration].name.s;
    const double items = items_of(f->model, f->configuration);
    mt_err why = {.code = MT_OK};
    *f->view = (mt_scene_view){.name = mt_arena_strdup(f->mem, name)};
    if (items > SCENE_ITEMS || items > left->items) {
        f->view->error = items > SCENE_ITEMS
                             ? mt_arena_printf(f->mem,
                                               "%.0f bodies, with all that they hold, are more "
                                               "than can be shown",
                                               mt_lowest_bodies(f->model, f->configuration))
                             : "left out, as others fill the page";
        return mt_arena_check(f->mem, err);
    }
    left->items -= items;
    mt_status rc = analyse_frame(f, left, &why);
    if (rc == MT_OK) {
        return mt_arena_check(f->mem, err);
    }
    if (mt_is_final(rc) || rc == MT_E_INTERRUPTED) {
        return mt_fail(err, rc, "%s", why.text);
    }
    *f->view =
        (mt_scene_view){.name = f->view->name, .error = mt_arena_strdup(f->mem, why.text)};
    f->way->drive = NULL;
    mt_arena_clear(f->work);
    mt_err other = {.code = MT_OK};
    rc = as_drawn(f, &other);
    if (rc != MT_OK) { /* the first reason says it all */
        *f->view = (mt_scene_view){.name = f->view->name, .error = f->view->error};
    }
    return rc == MT_E_INTERRUPTED ? mt_fail(err, rc, "%s", other.text)
                                  : mt_pass_final(rc, &other, err);
}

/* True where a parameter's value in the file is a plain number. */
static bool is_plain(const mt_model *model, int parameter)
{
    double value = 0.0;
    return mt_expr_is_constant(&model->nums[model->parameters[parameter].value].expr, &value);
}

static mt_status list_parameters(const mt_model *model, const mt_scene_query *ask,
                                 mt_arena *mem, mt_scene_design *out, mt_err *err)
{
    const size_t most = (size_t)(ask->n_shown < 0 ? model->n_parameters : ask->n_shown);
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    double *const value = mt_arena_f64(mem, (size_t)model->n_parameters, 1);
    out->parameters = mt_arena_alloc(mem, most, sizeof *out->parameters);
    MT_TRY(mt_arena_check(mem, err));
    const mt_status rc = mt_model_parameters(model, MT_ABSENT, ask->n_inputs, ask->inputs,
                                             ask->at, mem, value, err);
    if (rc == MT_E_DOMAIN) { /* every configuration says so itself */
        mt_arena_rewind(mem, mark);
        out->parameters = NULL;
        return MT_OK;
    }
    MT_TRY(rc);
    for (size_t i = 0; i < most; i++) {
        const int p = ask->n_shown < 0 ? (int)i : ask->shown[i];
        if (ask->n_shown < 0 && !is_plain(model, p)) {
            continue;
        }
        const mt_parameter *const from = &model->parameters[p];
        out->parameters[out->n_parameters++] = (mt_scene_parameter){
            .name = mt_arena_strdup(mem, from->name.s),
            .unit = from->unit == NULL ? NULL : mt_arena_strdup(mem, from->unit),
            .display_unit = mt_unit_name(from->written, NULL),
            .display_factor = mt_unit_display(from->written),
            .value = value[p]};
    }
    return mt_arena_check(mem, err);
}

/* What mt_scene_new was asked. */
typedef struct question {
    const mt_model *model;
    const mt_scene_extent *extent;
    scene_room left;
    mt_arena work;
    mt_scene_known *known; /* [configurations of the extent] */
    mt_scene_way *ways;    /* [designs][configurations of the extent] */
    mt_arena *ways_mem;    /* [designs] of the scene: what following them finds */
    mt_arena kept;
} question;

static mt_status design_new(question *q, const mt_scene_query *ask, mt_arena *mem,
                            mt_scene_design *out, mt_scene_way *ways, mt_err *err)
{
    *out = (mt_scene_design){.label = mt_arena_strdup(mem, ask->label), .rank = ask->rank};
    MT_TRY(list_parameters(q->model, ask, mem, out, err));
    out->views = mt_arena_alloc(mem, (size_t)q->extent->n_configurations, sizeof *out->views);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < q->extent->n_configurations; i++) {
        mt_scene_frame f = {.model = q->model,
                            .configuration = q->extent->configurations[i],
                            .ask = ask,
                            .extent = q->extent,
                            .mem = mem,
                            .work = &q->work,
                            .kept = &q->kept,
                            .view = &out->views[i],
                            .known = &q->known[i],
                            .way = &ways[i]};
        mt_arena_clear(&q->work);
        MT_TRY(view_new(&f, &q->left, err));
        out->n_views++;
    }
    return MT_OK;
}

/* All ranges of one design, in the order of its configurations: one may share what another
 * has found. A task. */
static mt_status follow_design(void *context, int worker, int task, mt_task_path *own,
                               mt_err *err)
{
    const question *const q = context;
    const int n = q->extent->n_configurations;
    mt_scene_way *const ways = q->ways + ((ptrdiff_t)task * n);
    mt_scene_followed followed = {.sys = NULL};
    mt_arena work = {.first = NULL};
    mt_status rc = MT_OK;
    (void)worker;
    (void)own;
    for (int i = 0; i < n && rc == MT_OK; i++) {
        mt_scene_way *const way = &ways[i];
        if (way->drive == NULL) {
            continue;
        }
        rc = work.first == NULL ? mt_arena_init(&work, 0, err) : rc;
        way->f.mem = &q->ways_mem[task];
        way->f.work = &work;
        way->f.followed = &followed;
        rc = rc == MT_OK ? scene_follow(way, err) : rc;
    }
    mt_system_delete(followed.sys);
    mt_arena_free(&work);
    return rc == MT_OK ? mt_arena_check(&q->ways_mem[task], err) : rc;
}

static void include_in_scene_box(double low[3], double high[3], const double x[3])
{
    for (int k = 0; k < 3; k++) {
        low[k] = fmin(low[k], x[k]);
        high[k] = fmax(high[k], x[k]);
    }
}

static void include_view(const mt_scene_view *v, double low[3], double high[3])
{
    for (int i = 1; i < v->n_bodies; i++) {
        include_in_scene_box(low, high, v->bodies[i].at);
    }
    for (int i = 0; i < v->n_lines; i++) {
        include_in_scene_box(low, high, v->lines[i].from);
        include_in_scene_box(low, high, v->lines[i].to);
    }
    for (int i = 0; i < v->n_joints; i++) {
        include_in_scene_box(low, high, v->joints[i].at);
    }
    for (int i = 0; i < v->n_sensors; i++) {
        include_in_scene_box(low, high, v->sensors[i].at);
    }
    for (int side = 0; side < 2; side++) {
        for (int i = 0; i < v->n_springs; i++) {
            include_in_scene_box(low, high, v->springs[i].end[side]);
        }
        for (int i = 0; i < v->n_dampers; i++) {
            include_in_scene_box(low, high, v->dampers[i].end[side]);
        }
    }
}

static double scene_size(const mt_scene *scene)
{
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
    double high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (int d = 0; d < scene->n_designs; d++) {
        for (int i = 0; i < scene->designs[d].n_views; i++) {
            include_view(&scene->designs[d].views[i], low, high);
        }
    }
    const double size = mt_distance_points(low, high);
    return isfinite(size) ? size : 0.0;
}

static int by_distance(const void *a, const void *b)
{
    const mt_scene_off *const x = a;
    const mt_scene_off *const y = b;
    const double dx = x->joint->distance;
    const double dy = y->joint->distance;
    return dx != dy ? (dx < dy ? 1 : -1) : x->order - y->order;
}

/* List the joints of the first design; equal distances in the order of configurations and
 * joints. */
static mt_status list_joints(mt_scene *scene, mt_err *err)
{
    const mt_scene_design *const d = scene->n_designs > 0 ? &scene->designs[0] : NULL;
    size_t n = 0;
    for (int i = 0; d != NULL && i < d->n_views; i++) {
        n += (size_t)d->views[i].n_joints;
    }
    scene->joints = mt_arena_alloc(&scene->mem, n, sizeof *scene->joints);
    MT_TRY(mt_arena_check(&scene->mem, err));
    for (int i = 0; d != NULL && i < d->n_views; i++) {
        const mt_scene_view *const v = &d->views[i];
        for (int k = 0; k < v->n_joints; k++) {
            const mt_scene_joint *const j = &v->joints[k];
            const char *const body = j->far == MT_ABSENT ? NULL : v->bodies[j->far].name;
            scene->joints[scene->n_joints] = (mt_scene_off){v->name, body, j, scene->n_joints};
            scene->n_joints++;
        }
    }
    if (scene->n_joints > 0) {
        qsort(scene->joints, (size_t)scene->n_joints, sizeof *scene->joints, by_distance);
    }
    return MT_OK;
}

/* Gravity of one configuration at a design. */
static mt_status gravity_in(const mt_model *model, int configuration, const mt_scene_query *ask,
                            mt_scene *scene, mt_arena *work, mt_err *err)
{
    const mt_configuration *const c = &model->configurations[configuration];
    for (int k = 0; k < 3 && c->has_gravity; k++) {
        MT_TRY(mt_model_number(model, configuration, ask->n_inputs, ask->inputs, ask->at,
                               c->gravity[k], work, &scene->gravity[k], err));
        scene->has_gravity = scene->has_gravity || fabs(scene->gravity[k]) > 0.0;
    }
    return MT_OK;
}

/* Gravity of the first configuration with gravity, at the first design: among those shown, else
 * among all, so that the up direction does not depend on what is shown. */
static mt_status find_gravity(const question *q, const mt_scene_query *ask, mt_scene *scene,
                              mt_arena *work, mt_err *err)
{
    const int all = q->model->n_configurations;
    const int shown = q->extent->n_configurations;
    for (int i = 0; i < shown + all && !scene->has_gravity; i++) {
        const int c = i < shown ? q->extent->configurations[i] : i - shown;
        mt_arena_clear(work);
        MT_TRY(gravity_in(q->model, c, ask, scene, work, err));
    }
    return MT_OK;
}

static mt_status fill_scene(mt_scene *scene, question *q, int n_designs,
                            const mt_scene_query *designs, mt_err *err)
{
    MT_TRY(mt_arena_init(&scene->mem, 0, err));
    MT_TRY(mt_arena_init(&q->work, 0, err));
    MT_TRY(mt_arena_init(&q->kept, 0, err));
    scene->dimension = q->model->dimension;
    scene->name = q->model->name == NULL ? "" : mt_arena_strdup(&scene->mem, q->model->name);
    scene->designs = mt_arena_alloc(&scene->mem, (size_t)n_designs, sizeof *scene->designs);
    const size_t n = (size_t)q->extent->n_configurations;
    q->known = mt_arena_alloc(&q->kept, n, sizeof *q->known);
    q->ways = mt_arena_alloc(&q->kept, n * (size_t)n_designs, sizeof *q->ways);
    scene->found = mt_arena_alloc(&scene->mem, (size_t)n_designs, sizeof *scene->found);
    MT_TRY(mt_arena_check(&q->kept, err));
    MT_TRY(mt_arena_check(&scene->mem, err));
    q->ways_mem = scene->found;
    for (int i = 0; i < n_designs; i++) {
        MT_TRY(design_new(q, &designs[i], &scene->mem, &scene->designs[i],
                          q->ways + ((size_t)i * n), err));
        scene->n_designs++;
    }
    const mt_tasks tasks = {n_designs, follow_design, NULL, q, "designs"};
    MT_TRY(mt_workers_run(q->extent->threads > 1 ? q->extent->threads : 1, NULL, &tasks, err));
    scene->size = scene_size(scene);
    mt_arena_clear(&q->work);
    if (n_designs > 0) {
        MT_TRY(find_gravity(q, &designs[0], scene, &q->work, err));
    }
    return list_joints(scene, err);
}

mt_status mt_scene_new(const mt_model *model, int n_designs, const mt_scene_query *designs,
                       const mt_scene_extent *extent, mt_scene **out, mt_err *err)
{
    question q = {
        .model = model, .extent = extent, .left = {SCENE_ALL_ITEMS, SCENE_POSES, extent->work}};
    mt_scene *const scene = calloc(1, sizeof *scene);
    *out = NULL;
    if (scene == NULL) {
        return mt_fail_memory(err);
    }
    const mt_status rc = fill_scene(scene, &q, n_designs, designs, err);
    for (int i = 0; i < extent->n_configurations && q.known != NULL; i++) {
        mt_analysis_delete(q.known[i].by);
    }
    mt_arena_free(&q.work);
    mt_arena_free(&q.kept);
    if (rc != MT_OK) {
        mt_scene_delete(scene);
        return rc;
    }
    *out = scene;
    return MT_OK;
}

void mt_scene_delete(mt_scene *scene)
{
    if (scene != NULL) {
        for (int i = 0; i < scene->n_designs && scene->found != NULL; i++) {
            mt_arena_free(&scene->found[i]);
        }
        mt_arena_free(&scene->mem);
        free(scene);
    }
}
