/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From a point to the record of a solution: bounds met, multipliers, KKT residual. No
 * evaluation. */
#include "nlp/report.h"

#include <math.h>
#include <string.h>

#include "nlp/kkt.h"

/* A variable this near to its bound, relative to the width, is on it. */
static const double ON_BOUND = 1e-8;
/* A multiplier takes part in a dependence of the gradients where its coefficient exceeds
 * this. */
static const double DEPENDENT = 1e-6;

/* Multipliers of linearly dependent gradients are not unique: NaN. */
static mt_status mark_dependent(mt_nlp_engine *e, const mt_nlp_point *p, mt_nlp_active *a,
                                mt_arena *mem)
{
    double *const col = mt_arena_f64(mem, (size_t)a->n_free, 1);
    double *const x = mt_arena_f64(mem, (size_t)a->k, 1);
    MT_TRY(mt_arena_check(mem, e->err));
    for (int d = a->qr.rank; d < a->k; d++) {
        const int i = a->qr.perm[d];
        for (int j = 0; j < a->n_free; j++) {
            col[j] = mt_nlp_row_slope(e, p, a->row[i], a->free[j]) / a->scale[i];
        }
        MT_TRY(mt_qr_solve(&a->qr, 1, col, x, mem, e->err));
        a->lambda[i] = nan("");
        for (int c = 0; c < a->k; c++) {
            if (fabs(x[c]) > DEPENDENT) {
                a->lambda[c] = nan("");
            }
        }
    }
    return MT_OK;
}

static void put_multipliers(const mt_nlp_engine *e, const mt_nlp_active *a,
                            mt_nlp_solution *out)
{
    const mt_nlp *const q = e->nlp;
    for (int i = 0; i < a->k; i++) {
        const int in = a->row[i] - q->n_eq;
        if (in < 0) {
            out->mult_eq[a->row[i]] = a->lambda[i];
        } else {
            out->mult_in[in < q->n_in ? in : q->next_of[in - q->n_in]] += a->lambda[i];
        }
    }
    for (int j = 0; j < e->n; j++) {
        out->mult_bound[j] = out->bound[j] != 0 ? a->z[j] : 0;
    }
}

static void no_multipliers(const mt_nlp_engine *e, mt_nlp_solution *out)
{
    for (int i = 0; i < e->nlp->n_eq; i++) {
        out->mult_eq[i] = nan("");
    }
    for (int i = 0; i < e->nlp->n_in; i++) {
        out->mult_in[i] = nan("");
    }
    for (int j = 0; j < e->n; j++) {
        out->mult_bound[j] = nan("");
    }
}

/* Part of the residual z orthogonal to the unidentifiable directions; z is overwritten. */
static double determined_part(const mt_nlp_engine *e, const mt_nlp_result *all,
                              mt_nlp_active *a)
{
    double whole = 0;
    double rest = 0;
    for (int i = 0; i < a->n_free; i++) {
        whole += a->z[a->free[i]] * a->z[a->free[i]];
    }
    for (int k = 0; k < all->n_unidentifiable; k++) {
        const double *const u = all->unidentifiable + ((ptrdiff_t)k * e->n);
        double along = 0;
        for (int i = 0; i < a->n_free; i++) {
            along += u[a->free[i]] * a->z[a->free[i]];
        }
        for (int i = 0; i < a->n_free; i++) {
            a->z[a->free[i]] -= along * u[a->free[i]];
        }
    }
    for (int i = 0; i < a->n_free; i++) {
        rest += a->z[a->free[i]] * a->z[a->free[i]];
    }
    return whole > 0 ? sqrt(rest / whole) : 1;
}

bool mt_nlp_report(mt_nlp_engine *e, const mt_nlp_point *p, const mt_nlp_result *all,
                   mt_arena *mem, mt_nlp_solution *out)
{
    const mt_nlp *const q = e->nlp;
    *out = (mt_nlp_solution){.f = p->f,
                             .violation = p->violation,
                             .squares = p->squares,
                             .feasible = mt_nlp_feasible(p)};
    out->t = mt_arena_f64(mem, (size_t)e->n, 1);
    out->bound = mt_arena_int(mem, (size_t)e->n);
    out->mult_bound = mt_arena_f64(mem, (size_t)e->n, 1);
    out->mult_eq = mt_arena_f64(mem, (size_t)q->n_eq, 1);
    out->mult_in = mt_arena_f64(mem, (size_t)q->n_in, 1);
    if (!mt_nlp_has_room(e, mem)) {
        return false;
    }
    memcpy(out->t, p->t, (size_t)e->n * sizeof *out->t);
    for (int j = 0; j < e->n; j++) {
        const double near = ON_BOUND * (q->upper[j] - q->lower[j]);
        out->bound[j] = p->t[j] <= q->lower[j] + near ? -1 : p->t[j] >= q->upper[j] - near;
    }
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    mt_nlp_active a;
    const mt_nlp_stage stage = out->feasible ? MT_NLP_OBJECTIVE : MT_NLP_SQUARES;
    bool ok = mt_nlp_active_set(e, p, stage, &e->scratch, &a);
    if (ok && out->feasible) {
        ok = mt_nlp_ok(e, mark_dependent(e, p, &a, &e->scratch));
        put_multipliers(e, &a, out);
    } else {
        no_multipliers(e, out);
    }
    if (ok) {
        const bool isolated = out->feasible && a.n_free > 0 && q->n_eq >= a.n_free;
        out->kkt =
            isolated && a.qr.rank == a.n_free ? nan("") : a.kkt * determined_part(e, all, &a);
    }
    mt_arena_rewind(&e->scratch, mark);
    return ok;
}
