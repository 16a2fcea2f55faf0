/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Bodies with their ellipsoids of inertia. A uniform ellipsoid of mass m with radii a, b, c has
 *     J_a = m (b^2 + c^2)/5, ...      whence      a^2 = 5 (J_b + J_c - J_a)/(2 m);
 * a uniform disc J = m r^2/2. Inertias that no body has (J_a > J_b + J_c, as where a gear
 * multiplies one) have no extent along that axis.
 */
#include "scene/scene_priv.h"

#include <math.h>
#include <stddef.h>

#include "linalg/dense.h"

/* Parts of the largest moment below which a difference of moments is their rounding. */
static const double ROUNDING = 1e-14;

/* Mass of every body of the view; bars and beams share theirs out to both ends. */
static void add_masses(const mt_scene_frame *f, mt_scene_body *bodies)
{
    for (int i = 0; i < f->sys->n_inertias; i++) {
        const mt_inertia_def *const d = &f->sys->inertias[i];
        const double m = f->value[d->coefficient];
        if (d->kind == MT_INERTIA_TRANSLATION) {
            bodies[d->body[0] + 1].mass += m;
        }
        for (int side = 0; side < 2; side++) {
            if ((d->kind == MT_INERTIA_BAR || d->kind == MT_INERTIA_BEAM) &&
                d->body[side] != MT_GROUND) {
                bodies[d->body[side] + 1].mass += 0.5 * m;
            }
        }
    }
}

static double number_or_zero(const mt_scene_frame *f, mt_num num)
{
    return num == MT_ABSENT ? 0.0 : f->number[num];
}

/* In two dimensions. */
static void disc(double mass, double inertia, mt_scene_ellipsoid *out)
{
    const double r = sqrt(2.0 * inertia / mass);
    *out = (mt_scene_ellipsoid){.radii = {r, r, 0.0},
                                .axes = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};
}

/* Of tensor j (lower triangle, column-major), as drawn. Principal moments ascend, so radii
 * descend. */
static mt_status solid(double mass, double j[9], mt_arena *work, mt_scene_ellipsoid *out,
                       mt_err *err)
{
    double w[3];
    MT_TRY(mt_eig_sym(3, j, w, true, work, err));
    for (int i = 0; i < 3; i++) {
        const double square = 2.5 * (w[(i + 1) % 3] + w[(i + 2) % 3] - w[i]) / mass;
        const double least = ROUNDING * 2.5 * w[2] / mass;
        out->radii[i] = square > least ? sqrt(square) : 0.0;
        for (int k = 0; k < 3; k++) {
            out->axes[i][k] = j[k + (3 * i)];
        }
    }
    return MT_OK;
}

static mt_status ellipsoid(const mt_scene_frame *f, const mt_body *b, mt_scene_body *out,
                           mt_err *err)
{
    double inertia[6];
    double most = 0.0;
    const bool plane = f->sys->dimension == 2;
    for (int k = 0; k < 6; k++) {
        inertia[k] = plane && k > 0 ? 0.0 : number_or_zero(f, b->inertia[k]);
        most = fmax(most, k < 3 ? inertia[k] : 0.0);
    }
    if (b->point_mass || !(out->mass > 0.0) || !(most > 0.0)) {
        return MT_OK;
    }
    mt_scene_ellipsoid e;
    if (plane) {
        disc(out->mass, inertia[0], &e);
    } else {
        double j[9] = {inertia[0], inertia[3], inertia[4], inertia[3], inertia[1],
                       inertia[5], inertia[4], inertia[5], inertia[2]};
        MT_TRY(solid(out->mass, j, f->work, &e, err));
    }
    bool finite = isfinite(out->mass) != 0;
    for (int i = 0; i < 3; i++) {
        const double drawn[3] = {e.axes[i][0], e.axes[i][1], e.axes[i][2]};
        mt_scene_turn(f, f->body_of[b - f->model->bodies], drawn, e.axes[i]);
        finite = finite && isfinite(e.radii[i]);
    }
    if (finite) {
        out->ellipsoid = mt_arena_alloc(f->mem, 1, sizeof *out->ellipsoid);
        MT_TRY(mt_arena_check(f->mem, err));
        *out->ellipsoid = e;
    }
    return MT_OK;
}

mt_status mt_scene_bodies(mt_scene_frame *f, mt_err *err)
{
    const mt_system *const sys = f->sys;
    mt_scene_view *const v = f->view;
    const int n = sys->n_bodies + 1;
    mt_scene_body *const bodies = mt_arena_alloc(f->mem, (size_t)n, sizeof *bodies);
    MT_TRY(mt_arena_check(f->mem, err));
    for (int i = 0; i < n; i++) {
        mt_scene_body *const b = &bodies[i];
        const mt_pose *const p = mt_pose_of(f->pose, i - 1);
        b->kind = i == 0                           ? MT_SCENE_GROUND
                  : f->link_of[i - 1] == MT_ABSENT ? MT_SCENE_BODY
                                                   : MT_SCENE_LINK;
        b->name = mt_arena_strdup(f->mem, i == 0 ? "ground" : sys->bodies[i - 1].name);
        for (int k = 0; k < 9; k++) {
            b->rotation[k] = creal(p->r[k]);
        }
        for (int k = 0; k < 3; k++) {
            b->at[k] = creal(p->x[k]);
        }
        mt_scene_clean(sys->length_m, b->at);
    }
    add_masses(f, bodies);
    for (int i = 0; i < f->model->n_bodies; i++) {
        if (f->body_of[i] != MT_ABSENT) {
            MT_TRY(ellipsoid(f, &f->model->bodies[i], &bodies[f->body_of[i] + 1], err));
        }
    }
    v->bodies = bodies;
    v->n_bodies = n;
    return mt_arena_check(f->mem, err);
}
