/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Modes as small motions of all bodies: a point p moves by t + r x (p - c). */
#include "scene/scene_priv.h"

#include <math.h>
#include <stddef.h>

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
                           const mt_scene_energy *energy, mt_err *err)
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
    mt_scene_energy_of(energy, modes->lambda[i], phi, out->spring_share, out->body_share);
    for (int k = 0; k < v->n_springs && modes->kind[i] == MT_MODE_RIGID_BODY; k++) {
        out->spring_share[k] = 0.0; /* what is left is rounding */
    }
    v->n_modes++;
    return MT_OK;
}

mt_status mt_scene_modes(mt_scene_frame *f, const mt_modes *modes, int shown, const double *phi,
                         mt_err *err)
{
    mt_scene_energy *energy = NULL;
    MT_TRY(mt_scene_energy_new(f, &energy, err));
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
