/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A variable that shapes the geometry may take joints out of the redundancy that the mechanism
 * lives on: a tilted hinge of a planar four-bar in space, one crank of a parallelogram with
 * three. At any other value the mechanism cannot be closed, or has lost a motion: its
 * frequencies are no function that a search could follow. Said where the study is read.
 */
#include "study/study_priv.h"

#include "mechanics/linear.h"
#include "mechanics/products.h"

/* Names configuration c's variables that break a redundancy; each variable once over all
 * configurations. */
static mt_status report_broken_redundancies(mt_study_check *c, mt_linear *lin, bool *told,
                                            mt_err *err)
{
    const mt_study *const s = c->study;
    for (int i = 0; i < s->n_variables; i++) {
        mt_independence what;
        if (told[i]) {
            continue;
        }
        MT_TRY(mt_linear_independence(lin, i, &c->study->mem, &what, err));
        told[i] = what.opens || what.blocks;
        if (told[i]) {
            mt_diag_error(
                c->diags, s->variables[i].addr,
                what.opens
                    ? "\"%s\" cannot vary alone: with any other value than %g, joints %s "
                      "do not close in configuration \"%s\", where equations of theirs "
                      "are redundant; make the other lengths depend on it, or give the "
                      "joints the freedom that they need"
                    : "\"%s\" cannot vary: only at %g are equations of joints %s "
                      "redundant in configuration \"%s\"; with any other value they "
                      "block a motion, and its frequency is gone at once; give the joints "
                      "the freedom that they need",
                c->model->parameters[s->variables[i].parameter].name.s,
                mt_unit_from_si(s->variables[i].shown, s->variables[i].original),
                what.joints.text,
                c->model->configurations[mt_linear_system(lin)->configuration].name.s);
        }
    }
    return MT_OK;
}

/* Check one configuration for redundancies. Failures are ignored: they occur again, with their
 * reason, when the study is solved. */
static mt_status check_configuration(mt_study_check *c, int configuration, const int *inputs,
                                     const double *at, bool *told, mt_err *err)
{
    mt_system *sys = NULL;
    mt_linear *lin = NULL;
    mt_status rc =
        mt_system_new(c->model, configuration, c->study->n_variables, inputs, at, &sys, err);
    if (rc == MT_OK && !sys->geometry_fixed) {
        rc = mt_linear_new(sys, &lin, err);
        rc = rc == MT_OK ? mt_linear_update(lin, at, false, err) : rc;
        if (rc == MT_OK && mt_linear_redundant(lin) > 0) {
            rc = mt_linear_update(lin, at, true, err);
            rc = rc == MT_OK ? report_broken_redundancies(c, lin, told, err) : rc;
        }
    }
    mt_linear_delete(lin);
    mt_system_delete(sys);
    return rc;
}

static mt_status check_redundancies(mt_study_check *c, mt_arena *mem)
{
    const mt_study *const s = c->study;
    const size_t n = (size_t)s->n_variables;
    MT_TRY(mt_arena_init(mem, 0, NULL));
    int *const inputs = mt_arena_int(mem, n);
    double *const at = mt_arena_f64(mem, n, 1);
    bool *const told = mt_arena_alloc(mem, n, sizeof *told);
    MT_TRY(mt_arena_check(mem, NULL));
    for (size_t i = 0; i < n; i++) {
        inputs[i] = s->variables[i].parameter;
        at[i] = s->variables[i].original;
    }
    for (int i = 0; i < c->model->n_configurations; i++) {
        if (mt_study_asks(s, i) &&
            check_configuration(c, i, inputs, at, told, NULL) == MT_E_MEMORY) {
            return MT_E_MEMORY;
        }
    }
    return MT_OK;
}

void mt_study_check_redundant(mt_study_check *c)
{
    mt_arena mem = {0};
    if (c->study->n_variables > 0 && check_redundancies(c, &mem) == MT_E_MEMORY) {
        mt_arena_fail(&c->study->mem);
    }
    mt_arena_free(&mem);
}
