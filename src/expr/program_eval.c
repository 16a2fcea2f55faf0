/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Values and forward-mode derivatives. With v = op(a, b) and a prime for d/d(input i):
 *   v' = (dv/da) a' + (dv/db) b'
 * An operand that depends on no input has no term, so x^2 needs no ln x, and a derivative that
 * does not exist with respect to a constant operand does no harm.
 */
#include <math.h>
#include <string.h>

#include "expr/op.h"
#include "expr/program.h"

static double node_value(const mt_program_node *n, const double *inputs, const double *value)
{
    if (n->op == MT_OP_CONST) {
        return n->value;
    }
    if (n->op == MT_OP_PARAM) {
        return inputs[n->input];
    }
    return mt_op_value(n->op, value[n->a], n->b == MT_NO_NODE ? 0.0 : value[n->b]);
}

/* "sqrt(-3) has no finite value", "1 / 0 has no finite derivative" */
static mt_status fail_at(const mt_program *p, mt_node node, const double *value,
                         const char *what, mt_node *bad, mt_err *err)
{
    const mt_program_node *const n = &p->nodes[node];
    const char *const name = mt_op_name(n->op);
    if (bad != NULL) {
        *bad = node;
    }
    if (n->a == MT_NO_NODE) {
        return mt_fail(err, MT_E_DOMAIN, "a %s has no finite %s", name, what);
    }
    if (n->b == MT_NO_NODE) {
        return mt_fail(err, MT_E_DOMAIN, "%s(%.6g) has no finite %s", name, value[n->a], what);
    }
    if (n->op <= MT_OP_POW) {
        return mt_fail(err, MT_E_DOMAIN, "%.6g %s %.6g has no finite %s", value[n->a], name,
                       value[n->b], what);
    }
    return mt_fail(err, MT_E_DOMAIN, "%s(%.6g, %.6g) has no finite %s", name, value[n->a],
                   value[n->b], what);
}

mt_status mt_program_eval(const mt_program *p, const double *inputs, double *value,
                          mt_node *bad, mt_err *err)
{
    for (int i = 0; i < p->count; i++) {
        value[i] = node_value(&p->nodes[i], inputs, value);
        if (!isfinite(value[i])) {
            return fail_at(p, i, value, "value", bad, err);
        }
    }
    return MT_OK;
}

/* grad row of an active node from the rows of its operands; false: not finite. */
static bool node_gradient(const mt_program *p, int i, const double *value, double *grad)
{
    const mt_program_node *const n = &p->nodes[i];
    const size_t inputs = (size_t)p->n_inputs;
    double *const row = grad + (size_t)i * inputs;
    if (n->op == MT_OP_PARAM) {
        row[n->input] = 1.0;
        return true;
    }
    const double b = n->b == MT_NO_NODE ? 0.0 : value[n->b];
    const mt_partials d = mt_op_partials(n->op, value[n->a], b, value[i]);
    bool finite = true;
    if (p->active[n->a]) {
        const double *const from = grad + (size_t)n->a * inputs;
        for (size_t k = 0; k < inputs; k++) {
            row[k] = d.a * from[k];
            finite = finite && isfinite(row[k]);
        }
    }
    if (n->b != MT_NO_NODE && p->active[n->b]) {
        const double *const from = grad + (size_t)n->b * inputs;
        for (size_t k = 0; k < inputs; k++) {
            row[k] += d.b * from[k];
            finite = finite && isfinite(row[k]);
        }
    }
    return finite;
}

mt_status mt_program_gradient(const mt_program *p, const double *inputs, double *value,
                              double *grad, mt_node *bad, mt_err *err)
{
    MT_TRY(mt_program_eval(p, inputs, value, bad, err));
    memset(grad, 0, (size_t)p->count * (size_t)p->n_inputs * sizeof *grad);
    for (int k = 0; k < p->n_active; k++) {
        const int i = p->active_nodes[k];
        if (!node_gradient(p, i, value, grad)) {
            return fail_at(p, i, value, "derivative", bad, err);
        }
    }
    return MT_OK;
}
