/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TUNE_ROBUST_H
#define TUNE_ROBUST_H

#include "tune/problem.h"
#include "tune/result.h"

/*
 * Variables with a tolerance. Each of them may turn out anywhere within |x' - x| <= tolerance |x|, and the goals have to hold all the same. Where every such variable enters stiffness or mass alone,
 * and with one sign, all frequencies are least at one corner of the tolerances, the soft one, and greatest at another, the stiff one (enclosure.h, which checks that; else the study is refused by name). So
 *     at least, modes above a band:  judged at the soft corner,     at most, modes below a band:  at the stiff corner,
 * which is exact, not a sample. Limits of expressions are judged at the corner where the expression is least or greatest, where intervals show that it is monotone. Corners are
 * x_i (1 -+ tolerance_i): gradients are those of the corner times that factor. The misfit and the objectives are those of the design itself.
 */
typedef struct mt_corner {
    mt_analysis *analysis; /* owned; NULL: the tolerances do not matter here */
    double *factor;        /* [n] inputs of the corner are factor times the design's */
} mt_corner;

enum { MT_SOFT, MT_STIFF, MT_CORNERS };

typedef struct mt_robust {
    mt_corner (*views)[MT_CORNERS]; /* [n_views] */
    int n_views;
    double **limits
        [2]; /* [n_demands] factors [n] where the expression is least, greatest; NULL: the tolerances do not matter */
    double *x;     /* [n] work */
    double *slope; /* [n] work */
    double *value; /* [program.count] work */
    double *grad;  /* program.count rows of n: work */
} mt_robust;

/* Nothing (p->robust stays NULL) where no variable has a tolerance. Fails: MT_E_INPUT where a goal or a configuration has no worst corner, saying why; MT_E_MEMORY, numerical failures. */
mt_status mt_robust_init(mt_problem *p, mt_err *err);
/* Accepts NULL. */
void mt_robust_free(mt_robust *r);
/* robust_eval.c: modes of all corners of the design at p->x. Nothing where p has no tolerances, likewise below. */
mt_status mt_robust_solve(mt_problem *p, bool with_gradient, mt_err *err);
/* Replace the rows of one demand, and of all bands, by those of their worst corners. After mt_robust_solve. */
mt_status mt_robust_demand(mt_problem *p, const mt_demand *d, bool with_gradient,
                           mt_nlp_values *out, mt_err *err);
mt_status mt_robust_clears(mt_problem *p, const double *t, bool with_gradient,
                           mt_nlp_values *out, mt_err *err);
/* mt_clear_room at the corners: modes are paired by their index. */
double mt_robust_room(const mt_problem *p, const mt_clear *c);
/* Modes of a view at a corner after mt_robust_solve: the view's own where its tolerances do not matter. */
const mt_modes *mt_robust_modes(const mt_problem *p, int view, int corner);

#endif
