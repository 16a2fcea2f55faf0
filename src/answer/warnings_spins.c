/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A rod between ball joints may turn about the line through them, and nothing notices. Bodies
 * that are joined to each other otherwise than by ball joints are one part. With phi the
 * motions without strain, a part is such a rod where it hangs on others by two ball joints or
 * more and phi c is 0 outside of it for one c, in which all of its bodies turn alike:
 *     |phi c|^2 outside = c^T B c,   B summed over the rows outside: the vector of its least
 *                                    eigenvalue
 * What of the motions is orthogonal to all these is another matter: a joint may be missing.
 */
#include <math.h>
#include <string.h>

#include "answer/warnings.h"
#include "base/format.h"
#include "linalg/dense.h"

/* Of the largest entry of a motion: what is less is at rest, and turns that differ by less are
 * alike. Its square is far above the rounding of sums over some thousand rows. */
static const double AT_REST = 1e-5;
/* Spins of different rods move different bodies: of combinations only rounding is dependent. */
static const double DEPENDENT = 1e-6;

enum { DOFS = 6, TURNS = 3 };

typedef struct spins {
    const mt_system *sys;
    int n;          /* motions */
    double *phi;    /* nq x n, largest entry 1 */
    double *most;   /* [n] what it was before */
    double *all;    /* n x n: sum of all rows' products */
    double *beside; /* n x n: without those of a part; then its eigenvectors */
    double *value;  /* [n] */
    double *motion; /* [nq] */
    double *spin;   /* n x rods: in terms of the motions as they were given */
    int *part;      /* [bodies] the lowest body of the same part; MT_GROUND: of the ground's */
} spins;

static double entry(const spins *s, const double *q, int body, int k)
{
    const ptrdiff_t dof = s->sys->bodies[body].dof[k];
    return dof < 0 ? 0.0 : q[dof];
}

static void join_spin_parts(spins *s, int a, int b)
{
    const int one = a < 0 ? MT_GROUND : s->part[a];
    const int other = b < 0 ? MT_GROUND : s->part[b];
    const int least = one < other ? one : other;
    for (int i = 0; i < s->sys->n_bodies && one != other; i++) {
        if (s->part[i] == one || s->part[i] == other) {
            s->part[i] = least;
        }
    }
}

static void find_parts(spins *s)
{
    for (int b = 0; b < s->sys->n_bodies; b++) {
        s->part[b] = b;
    }
    for (int i = 0; i < s->sys->n_joints; i++) {
        const mt_system_joint *const joint = &s->sys->joints[i];
        if (joint->type != MT_JOINT_SPHERICAL && joint->type != MT_JOINT_DISTANCE) {
            join_spin_parts(s, joint->body[0], joint->body[1]);
        }
    }
    for (int i = 0; i < s->sys->n_measures; i++) {
        const mt_measure_def *const m = &s->sys->measures[i];
        if (m->kind == MT_MEASURE_BEAM) {
            join_spin_parts(s, m->body[0], m->body[1]);
        }
    }
}

static bool is_between_balls(const spins *s, int part)
{
    int balls = 0;
    for (int i = 0; i < s->sys->n_joints; i++) {
        const mt_system_joint *const joint = &s->sys->joints[i];
        const int one = joint->body[0] < 0 ? MT_GROUND : s->part[joint->body[0]];
        const int other = joint->body[1] < 0 ? MT_GROUND : s->part[joint->body[1]];
        balls += joint->type == MT_JOINT_SPHERICAL && (one == part) != (other == part) ? 1 : 0;
    }
    return balls >= 2;
}

/* sum += sign * (products of the rows of one body) */
static void add_rows(const spins *s, int body, double sign, double *sum)
{
    for (int k = 0; k < DOFS; k++) {
        for (int j = 0; j < s->n; j++) {
            const double own = entry(s, s->phi + ((ptrdiff_t)j * s->sys->nq), body, k);
            for (int i = 0; i < s->n && own != 0.0; i++) {
                sum[i + ((ptrdiff_t)j * s->n)] +=
                    sign * own * entry(s, s->phi + ((ptrdiff_t)i * s->sys->nq), body, k);
            }
        }
    }
}

static bool turns_as_one(const spins *s, int part)
{
    double turn = 0.0;
    double apart = 0.0;
    for (int b = 0; b < s->sys->n_bodies; b++) {
        for (int k = DOFS - TURNS; k < DOFS && s->part[b] == part; k++) {
            const double own = entry(s, s->motion, b, k);
            turn = fmax(turn, fabs(own));
            apart = fmax(apart, fabs(own - entry(s, s->motion, part, k)));
        }
    }
    return turn > 0.0 && apart <= AT_REST * turn;
}

/* *spin: there is one motion of this part alone, as of a rod; it is the next of s->spin. */
static mt_status look_at_part(spins *s, int part, int rods, bool *spin, mt_arena *mem,
                              mt_err *err)
{
    const int n = s->n;
    memcpy(s->beside, s->all, (size_t)n * (size_t)n * sizeof *s->beside);
    for (int b = 0; b < s->sys->n_bodies; b++) {
        if (s->part[b] == part) {
            add_rows(s, b, -1.0, s->beside);
        }
    }
    MT_TRY(mt_eig_sym(n, s->beside, s->value, true, mem, err));
    double moved = 0.0;
    for (int i = 0; i < s->sys->nq; i++) {
        s->motion[i] = 0.0;
        for (int j = 0; j < n; j++) {
            s->motion[i] += s->phi[i + ((ptrdiff_t)j * s->sys->nq)] * s->beside[j];
        }
        moved += s->motion[i] * s->motion[i];
    }
    const double rest = AT_REST * AT_REST;
    *spin = s->value[0] <= rest * moved && (n == 1 || s->value[1] > rest * moved) &&
            turns_as_one(s, part);
    for (int j = 0; j < n && *spin; j++) {
        s->spin[j + ((ptrdiff_t)rods * n)] = s->beside[j] / s->most[j];
    }
    return MT_OK;
}

static mt_status set_up(spins *s, const mt_analysis *a, mt_arena *mem, mt_err *err)
{
    const mt_modes *const modes = &a->modes;
    const size_t most = (size_t)modes->n_rigid;
    const ptrdiff_t nq = s->sys->nq;
    s->phi = mt_arena_f64(mem, (size_t)nq, most);
    s->most = mt_arena_f64(mem, most, 1);
    s->all = mt_arena_f64(mem, most, most);
    s->beside = mt_arena_f64(mem, most, most);
    s->spin = mt_arena_f64(mem, most, most);
    s->value = mt_arena_f64(mem, most, 1);
    s->motion = mt_arena_f64(mem, (size_t)nq, 1);
    s->part = mt_arena_int(mem, (size_t)s->sys->n_bodies);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < modes->shaped; i++) {
        if (modes->kind[i] == MT_MODE_RIGID_BODY) {
            double *const phi = s->phi + (s->n * nq);
            mt_linear_expand(a->lin, 1, mt_modal_shape(modes, i), phi);
            for (int j = 0; j < nq; j++) {
                s->most[s->n] = fmax(s->most[s->n], fabs(phi[j]));
            }
            for (int j = 0; j < nq; j++) {
                phi[j] /= s->most[s->n];
            }
            s->n++;
        }
    }
    for (int b = 0; b < s->sys->n_bodies; b++) {
        add_rows(s, b, 1.0, s->all);
    }
    find_parts(s);
    return MT_OK;
}

/* y of the first motion orthogonal to all spins, the columns of s->spin. Modes are orthonormal
 * in the mass metric, so orthogonality holds for their coefficients. */
static mt_status find_other(const spins *s, const mt_analysis *a, int rods, double *y,
                            mt_arena *mem, mt_err *err)
{
    const int n = s->n;
    mt_qr f;
    double *const q = mt_arena_f64(mem, (size_t)n, (size_t)n);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_qr_factor(n, rods, s->spin, n, DEPENDENT, mem, &f, err));
    MT_TRY(mt_qr_q(&f, rods, q, mem, err));
    memset(y, 0, (size_t)a->modes.n * sizeof *y);
    for (int i = 0, k = 0; i < a->modes.shaped; i++) {
        if (a->modes.kind[i] == MT_MODE_RIGID_BODY) {
            for (int j = 0; j < a->modes.n; j++) {
                y[j] += q[k] * mt_modal_shape(&a->modes, i)[j];
            }
            k++;
        }
    }
    return MT_OK;
}

mt_status mt_warnings_spins(const mt_analysis *a, mt_arena *mem, mt_warnings_rods *out,
                            mt_err *err)
{
    spins s = {.sys = a->sys};
    *out = (mt_warnings_rods){.names = ""};
    if (s.sys->dimension == 2 || a->modes.y == NULL || a->modes.n_rigid == 0) {
        return MT_OK;
    }
    MT_TRY(set_up(&s, a, mem, err));
    if (s.n < a->modes.n_rigid) {
        return MT_OK;
    }
    for (int b = 0; b < s.sys->n_bodies && out->n < s.n; b++) {
        bool spin = false;
        if (s.part[b] == b && is_between_balls(&s, b)) {
            MT_TRY(look_at_part(&s, b, out->n, &spin, mem, err));
        }
        if (spin) {
            out->names = mt_arena_printf(mem, "%s%s\"%s\"", out->names, out->n == 0 ? "" : ", ",
                                         s.sys->bodies[b].name);
            MT_TRY(mt_arena_check(mem, err));
            out->n++;
        }
    }
    if (out->n > 0 && out->n < s.n) {
        out->other = mt_arena_f64(mem, (size_t)a->modes.n, 1);
        MT_TRY(mt_arena_check(mem, err));
        MT_TRY(find_other(&s, a, out->n, out->other, mem, err));
    }
    return MT_OK;
}
