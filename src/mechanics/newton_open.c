/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which joint cannot be closed: said in the words of the model. */
#include "mechanics/newton_priv.h"

#include <math.h>

enum { NAMES_SIZE = 400 };
/* Entries of a left null vector (largest 1) above this belong to the dependent set. */
static const double IN_THE_SET = 1e-6;

/* Which joints to name: those in the left null vectors of A that the gap lies along (they
 * contradict each other), else the one furthest open. */
mt_status mt_newton_open_loop(const mt_newton_problem *problem, const mt_pose *poses,
                              const mt_elimination *e, mt_arena *scratch, mt_err *err)
{
    mt_newton_work w;
    MT_TRY(mt_newton_work_init(&w, problem, scratch, err));
    mt_newton_evaluate(&w, poses, false);
    int worst = 0;
    double gap = 0.0;
    for (int i = 0; i < problem->m; i++) {
        if (!(fabs(w.c[i]) <= gap)) {
            gap = fabs(w.c[i]);
            worst = i;
        }
    }
    const mt_constraint_def *const c = &w.sys->constraints[worst];
    const mt_measure_kind kind = w.sys->measures[c->measure[0]].kind;
    const bool length = kind == MT_MEASURE_PLANE || kind == MT_MEASURE_DISTANCE;
    const char *const unit = length ? "m" : "(cosine or rad)";
    double *const null = mt_arena_f64(scratch, (size_t)problem->m, 1);
    char names[NAMES_SIZE];
    if (null == NULL) {
        return mt_fail_memory(err);
    }
    for (int k = 0; k < e->m - e->qr.rank; k++) {
        MT_TRY(mt_eliminate_left_null(e, k, null, scratch, err));
        if (fabs(null[worst]) > IN_THE_SET) {
            mt_joint_names(w.sys, problem->m, null, names, sizeof names);
            return mt_fail(err, MT_E_ASSEMBLY,
                           "joints %s contradict each other: a gap of %.6g %s is left", names,
                           gap, unit);
        }
    }
    return mt_fail(err, MT_E_ASSEMBLY,
                   "the mechanism cannot be assembled: joint \"%s\" stays open by %.6g %s",
                   w.sys->joints[c->joint].name, gap, unit);
}
