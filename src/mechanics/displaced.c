/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mechanics/displaced.h"

#include "mechanics/linear_priv.h"

#include <string.h>

#include "mechanics/motion.h"

static mt_status evaluate_displaced(mt_linear *lin, const double *dq, mt_motion *o, mt_err *err)
{
    const mt_system *const sys = lin->sys;
    mt_placement at;
    double *const still = mt_arena_f64(&lin->scratch, (size_t)sys->nq, 1);
    MT_TRY(mt_placement_init(&at, sys, &lin->scratch, err));
    MT_TRY(mt_motion_init(o, lin, &lin->scratch, err));
    mt_placement_copy(sys, &lin->position.at, &at);
    if (dq != NULL) {
        mt_poses_move(sys, at.pose, dq);
    }
    mt_motion_eval(o, &at, still);
    return MT_OK;
}

mt_status mt_displaced_eval(mt_linear *lin, const double *dq, double *m, double *q, double *a,
                            double *c, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    mt_motion o;
    MT_TRY(evaluate_displaced(lin, dq, &o, err));
    const size_t nq = (size_t)o.nq;
    memcpy(m, o.mass, nq * nq * sizeof *m);
    memcpy(q, o.force, nq * sizeof *q);
    memcpy(a, o.a, (size_t)o.m * nq * sizeof *a);
    if (c != NULL) {
        memcpy(c, o.gap, (size_t)o.m * sizeof *c);
    }
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}
