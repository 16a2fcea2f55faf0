/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A rod between ball joints may turn about the line through them, and nothing notices. With
 * phi the motions without strain: bodies that move, joined to each other, are such a rod where
 * they turn alike in every phi and hang on bodies at rest by ball joints alone, by two or more.
 */
#include <math.h>
#include <string.h>

#include "answer/doubts.h"
#include "base/format.h"

/* Of the largest entry of a motion: what is less is at rest, and turns that differ by less are
 * alike. */
static const double AT_REST = 1e-6;

typedef struct spins {
    const mt_system *sys;
    int n;       /* motions */
    double *phi; /* nq x n, largest entry 1 */
    bool *moves; /* [bodies] */
    int *rod;    /* [bodies] the lowest body that it is joined to by moving ones */
} spins;

static double entry(const spins *s, int mode, int body, int k)
{
    const ptrdiff_t dof = s->sys->bodies[body].dof[k];
    return dof < 0 ? 0.0 : s->phi[dof + ((ptrdiff_t)mode * s->sys->nq)];
}

static bool is_moving(const spins *s, int body)
{
    return body >= 0 && s->moves[body];
}

static void find_moving(spins *s)
{
    for (int i = 0; i < s->n; i++) {
        double *const phi = s->phi + ((ptrdiff_t)i * s->sys->nq);
        double most = 0.0;
        for (int j = 0; j < s->sys->nq; j++) {
            most = fmax(most, fabs(phi[j]));
        }
        for (int j = 0; j < s->sys->nq && most > 0.0; j++) {
            phi[j] /= most;
        }
        for (int b = 0; b < s->sys->n_bodies; b++) {
            for (int k = 0; k < 6; k++) {
                s->moves[b] = s->moves[b] || fabs(entry(s, i, b, k)) > AT_REST;
            }
        }
    }
}

static void find_rods(spins *s)
{
    for (int b = 0; b < s->sys->n_bodies; b++) {
        s->rod[b] = b;
    }
    for (bool changed = true; changed;) {
        changed = false;
        for (int j = 0; j < s->sys->n_joints; j++) {
            const int *const body = s->sys->joints[j].body;
            if (is_moving(s, body[0]) && is_moving(s, body[1]) &&
                s->rod[body[0]] != s->rod[body[1]]) {
                const int least = s->rod[body[0]] < s->rod[body[1]] ? 0 : 1;
                s->rod[body[1 - least]] = s->rod[body[least]];
                changed = true;
            }
        }
    }
}

static bool turn_alike(const spins *s, int a, int b)
{
    for (int i = 0; i < s->n; i++) {
        for (int k = 3; k < 6; k++) {
            if (!(fabs(entry(s, i, a, k) - entry(s, i, b, k)) <= AT_REST)) {
                return false;
            }
        }
    }
    return true;
}

static bool is_spin(const spins *s, int rod)
{
    int balls = 0;
    for (int b = 0; b < s->sys->n_bodies; b++) {
        if (s->moves[b] && s->rod[b] == rod && !turn_alike(s, rod, b)) {
            return false;
        }
    }
    for (int j = 0; j < s->sys->n_joints; j++) {
        const mt_system_joint *const joint = &s->sys->joints[j];
        const int moving = is_moving(s, joint->body[0]) ? 0 : 1;
        if (!is_moving(s, joint->body[moving]) || is_moving(s, joint->body[1 - moving]) ||
            s->rod[joint->body[moving]] != rod) {
            continue;
        }
        if (joint->type != MT_JOINT_SPHERICAL) {
            return false;
        }
        balls++;
    }
    return balls >= 2;
}

mt_status mt_doubts_spins(const mt_analysis *a, char *text, size_t size, int *rods, mt_err *err)
{
    const mt_modes *const modes = &a->modes;
    mt_arena mem = {0};
    spins s = {.sys = a->sys};
    const size_t bodies = (size_t)s.sys->n_bodies;
    *rods = 0;
    text[0] = '\0';
    if (s.sys->dimension == 2 || modes->y == NULL) {
        return MT_OK;
    }
    MT_TRY(mt_arena_init(&mem, 0, err));
    s.phi = mt_arena_f64(&mem, (size_t)s.sys->nq, (size_t)modes->n_rigid);
    s.moves = mt_arena_alloc(&mem, bodies, sizeof *s.moves);
    s.rod = mt_arena_int(&mem, bodies);
    const mt_status rc = mt_arena_check(&mem, err);
    bool all = rc == MT_OK;
    for (int i = 0; i < modes->shaped && all; i++) {
        if (modes->kind[i] == MT_MODE_RIGID_BODY) {
            mt_linear_expand(a->lin, 1, mt_modal_shape(modes, i),
                             s.phi + ((ptrdiff_t)s.n++ * s.sys->nq));
        }
    }
    if (all) {
        find_moving(&s);
        find_rods(&s);
    }
    for (int b = 0; all && b < s.sys->n_bodies; b++) {
        if (s.moves[b] && s.rod[b] == b) {
            const size_t at = strlen(text);
            all = is_spin(&s, b);
            (void)mt_snprintf(text + at, size - at, "%s\"%s\"", *rods == 0 ? "" : ", ",
                              s.sys->bodies[b].name);
            ++*rods;
        }
    }
    *rods = all && *rods == modes->n_rigid ? *rods : 0;
    mt_arena_free(&mem);
    return rc;
}
