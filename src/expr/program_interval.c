/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Enclosures of a program over a box of inputs: by induction over the nodes, each holds every
 * value that its node takes in the box, exact or rounded (see interval.h). Constants are the
 * doubles they were folded to. Derivatives by the chain rule of program_eval.c in intervals;
 * where min or max may choose either operand, the derivative is one of the two.
 */
#include <math.h>
#include <string.h>

#include "expr/interval.h"
#include "expr/program.h"

static mt_interval node_interval(const mt_program *p, int i, const double *lower,
                                 const double *upper, const double *lo, const double *hi)
{
    const mt_program_node *const n = &p->nodes[i];
    if (n->op == MT_OP_CONST) {
        return mt_interval_of(n->value, n->value);
    }
    if (n->op == MT_OP_PARAM) {
        return mt_interval_of(lower[n->input], upper[n->input]);
    }
    const mt_interval a = {lo[n->a], hi[n->a]};
    if (n->op == MT_OP_MUL && n->a == n->b) {
        return mt_interval_square(a);
    }
    const mt_interval b = n->b == MT_NO_NODE ? a : (mt_interval){lo[n->b], hi[n->b]};
    return mt_interval_op(n->op, a, b);
}

void mt_program_interval(const mt_program *p, const double *lower, const double *upper,
                         double *lo, double *hi)
{
    for (int i = 0; i < p->count; i++) {
        const mt_interval v = node_interval(p, i, lower, upper, lo, hi);
        lo[i] = v.lo;
        hi[i] = v.hi;
    }
}

/* Which operand's derivative a min or max takes: partials 1 and 0 where that is certain. */
typedef enum choice { CHOICE_FIRST, CHOICE_SECOND, CHOICE_EITHER } choice;

static choice chosen(mt_op op, mt_interval a, mt_interval b)
{
    if (op == MT_OP_MIN ? a.hi <= b.lo : a.lo >= b.hi) {
        return CHOICE_FIRST;
    }
    if (op == MT_OP_MIN ? b.hi < a.lo : b.lo > a.hi) {
        return CHOICE_SECOND;
    }
    return CHOICE_EITHER;
}

static mt_interval choice_derivative(choice c, mt_interval da, mt_interval db)
{
    if (c == CHOICE_EITHER) {
        return mt_interval_hull(da, db);
    }
    return c == CHOICE_FIRST ? da : db;
}

/* Derivatives of one node with two operands (or one, doubled with a zero partial). */
static void node_derivatives(const mt_program *p, int i, const double *lo, const double *hi,
                             double *dlo, double *dhi)
{
    const mt_program_node *const n = &p->nodes[i];
    const mt_node second = n->b == MT_NO_NODE ? n->a : n->b;
    const mt_interval a = {lo[n->a], hi[n->a]};
    const mt_interval b = {lo[second], hi[second]};
    const mt_interval v = {lo[i], hi[i]};
    const bool chooses = n->op == MT_OP_MIN || n->op == MT_OP_MAX;
    const choice c = chooses ? chosen(n->op, a, b) : CHOICE_FIRST;
    const mt_interval_partials d = mt_interval_op_partials(n->op, a, b, v);
    const bool b_active = n->b != MT_NO_NODE && p->active[n->b];
    const size_t inputs = (size_t)p->n_inputs;
    const size_t row = (size_t)i * inputs;
    for (size_t k = 0; k < inputs; k++) {
        const size_t ka = (size_t)n->a * inputs + k;
        const size_t kb = (size_t)second * inputs + k;
        const mt_interval da = {dlo[ka], dhi[ka]};
        const mt_interval db = {dlo[kb], dhi[kb]};
        mt_interval sum = {0.0, 0.0};
        if (chooses) {
            sum = choice_derivative(c, da, db);
        } else {
            sum = p->active[n->a] ? mt_interval_mul(d.a, da) : sum;
            sum = b_active ? mt_interval_add(sum, mt_interval_mul(d.b, db)) : sum;
        }
        dlo[row + k] = sum.lo;
        dhi[row + k] = sum.hi;
    }
}

void mt_program_interval_gradient(const mt_program *p, const double *lower, const double *upper,
                                  double *lo, double *hi, double *dlo, double *dhi)
{
    mt_program_interval(p, lower, upper, lo, hi);
    const size_t size = (size_t)p->count * (size_t)p->n_inputs;
    memset(dlo, 0, size * sizeof *dlo);
    memset(dhi, 0, size * sizeof *dhi);
    for (int k = 0; k < p->n_active; k++) {
        const int i = p->active_nodes[k];
        if (p->nodes[i].op == MT_OP_PARAM) {
            const size_t own = (size_t)i * (size_t)p->n_inputs + (size_t)p->nodes[i].input;
            dlo[own] = 1.0;
            dhi[own] = 1.0;
        } else {
            node_derivatives(p, i, lo, hi, dlo, dhi);
        }
    }
}
