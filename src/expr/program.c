/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Building a program. A node is known by (op, operands, input, value): the sorted nodes give
 * the one that is already there. Operations on constants are carried out at once where the
 * result is finite; where it is not, the node stays, so that evaluation reports it with its
 * address.
 *
 * Simplifications keep every value of the program (up to the sign of zero), and since a node
 * that is no longer used is still evaluated, they hide no domain error either:
 *   x + 0 = x - 0 = x * 1 = x / 1 = x ^ 1 = x,   x * 0 = x - x = 0,   x ^ 0 = 1,   -(-x) = x
 * Operands of + and * are put in order, so that a + b and b + a are one node.
 */
#include "expr/program.h"

#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "expr/interpolant.h"
#include "expr/interval.h"
#include "expr/op.h"

enum { BITS = 64 };

mt_status mt_program_init(mt_program *p, int n_inputs, mt_arena *mem, mt_err *err)
{
    *p = (mt_program){.mem = mem, .n_inputs = n_inputs};
    return mt_arena_check(mem, err);
}

static uint64_t value_bits(double value)
{
    uint64_t bits = 0;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static int compare_nodes(const void *context, const void *key, int i)
{
    const mt_program *const p = context;
    const mt_program_node *const m = key;
    const mt_program_node *const n = &p->nodes[i];
    if (m->b != n->b) {
        return m->b < n->b ? -1 : 1;
    }
    if (m->a != n->a) {
        return m->a < n->a ? -1 : 1;
    }
    if (m->op != n->op) {
        return m->op < n->op ? -1 : 1;
    }
    if (m->input != n->input) {
        return m->input < n->input ? -1 : 1;
    }
    const uint64_t v = value_bits(m->value);
    const uint64_t w = value_bits(n->value);
    return (v > w) - (v < w);
}

static mt_node intern(mt_program *p, const mt_program_node *n)
{
    if (mt_arena_failed(p->mem)) {
        return MT_NO_NODE; /* the order may be without the last node */
    }
    mt_program_node *const nodes =
        mt_arena_grow(p->mem, p->nodes, p->count, &p->capacity, sizeof *nodes);
    if (nodes == NULL) {
        return MT_NO_NODE;
    }
    p->nodes = nodes;
    const int known = mt_sorted_put(&p->order, p->mem, compare_nodes, p, n);
    if (known != MT_SORTED_NEW) {
        return known >= 0 ? known : MT_NO_NODE;
    }
    p->nodes[p->count] = *n;
    p->nodes[p->count].varies = n->op == MT_OP_PARAM ||
                                (n->a != MT_NO_NODE && nodes[n->a].varies) ||
                                (n->b != MT_NO_NODE && nodes[n->b].varies);
    return p->count++;
}

mt_node mt_program_const(mt_program *p, double value)
{
    const mt_program_node n = {.op = MT_OP_CONST,
                               .a = MT_NO_NODE,
                               .b = MT_NO_NODE,
                               .input = -1,
                               .value = value,
                               .addr = MT_NO_ADDR};
    return intern(p, &n);
}

mt_node mt_program_input(mt_program *p, int input, mt_addr addr)
{
    const mt_program_node n = {
        .op = MT_OP_PARAM, .a = MT_NO_NODE, .b = MT_NO_NODE, .input = input, .addr = addr};
    return intern(p, &n);
}

/* True where the node is the constant `value`. */
static bool is_value(const mt_program *p, mt_node node, double value)
{
    return p->nodes[node].op == MT_OP_CONST && p->nodes[node].value == value;
}

/* Value of an operation with operands of these values (b is ignored where it has one). */
static double operate(const mt_program_node *n, double a, double b)
{
    if (n->op == MT_OP_INTERP) {
        double at[3];
        mt_interpolant_at(n->curve, a, at);
        return at[0];
    }
    return mt_op_value(n->op, a, b);
}

/* n: a new node with its operands. */
static mt_node operation(mt_program *p, const mt_program_node *n)
{
    const mt_program_node *const na = &p->nodes[n->a];
    const mt_program_node *const nb = n->b == MT_NO_NODE ? na : &p->nodes[n->b];
    if (na->op == MT_OP_CONST && nb->op == MT_OP_CONST) {
        const double value = operate(n, na->value, nb->value);
        if (isfinite(value)) {
            return mt_program_const(p, value);
        }
    }
    return intern(p, n);
}

mt_node mt_program_unary(mt_program *p, mt_op op, mt_node a, mt_addr addr)
{
    if (a == MT_NO_NODE) {
        return MT_NO_NODE;
    }
    if (op == MT_OP_NEG && p->nodes[a].op == MT_OP_NEG) {
        return p->nodes[a].a;
    }
    const mt_program_node n = {.op = op, .a = a, .b = MT_NO_NODE, .input = -1, .addr = addr};
    return operation(p, &n);
}

mt_node mt_program_interp(mt_program *p, const mt_interpolant *curve, mt_node a, mt_addr addr)
{
    if (a == MT_NO_NODE) {
        return MT_NO_NODE;
    }
    const mt_program_node n = {
        .op = MT_OP_INTERP, .a = a, .b = MT_NO_NODE, .input = -1, .curve = curve, .addr = addr};
    return operation(p, &n);
}

/* The node that op(a, b) simplifies to; MT_NO_NODE: it does not. */
static mt_node simplified(mt_program *p, mt_op op, mt_node a, mt_node b)
{
    const bool b_zero = is_value(p, b, 0.0);
    const bool b_one = is_value(p, b, 1.0);
    if ((op == MT_OP_ADD || op == MT_OP_SUB) && b_zero) {
        return a;
    }
    if ((op == MT_OP_MUL || op == MT_OP_DIV || op == MT_OP_POW) && b_one) {
        return a;
    }
    if (op == MT_OP_MUL && b_zero) {
        return b;
    }
    if (op == MT_OP_SUB && a == b) {
        return mt_program_const(p, 0.0);
    }
    if (op == MT_OP_POW && b_zero) {
        return mt_program_const(p, 1.0);
    }
    return MT_NO_NODE;
}

mt_node mt_program_binary(mt_program *p, mt_op op, mt_node a, mt_node b, mt_addr addr)
{
    if (a == MT_NO_NODE || b == MT_NO_NODE) {
        return MT_NO_NODE;
    }
    if (op == MT_OP_ADD || op == MT_OP_MUL) {
        /* constants last, where `simplified` looks for them */
        const bool a_const = p->nodes[a].op == MT_OP_CONST;
        const bool b_const = p->nodes[b].op == MT_OP_CONST;
        if (a_const != b_const ? a_const : a > b) {
            const mt_node swap = a;
            a = b;
            b = swap;
        }
    }
    const mt_node simple = simplified(p, op, a, b);
    if (simple != MT_NO_NODE) {
        return simple;
    }
    const mt_program_node n = {.op = op, .a = a, .b = b, .input = -1, .addr = addr};
    return operation(p, &n);
}

mt_node mt_program_copy(mt_program *p, const mt_program_node *of, mt_node a, mt_node b)
{
    switch ((int)of->op) {
    case MT_OP_CONST:
        return mt_program_const(p, of->value);
    case MT_OP_PARAM:
        return mt_program_input(p, of->input, of->addr);
    case MT_OP_INTERP:
        return mt_program_interp(p, of->curve, a, of->addr);
    default:
        return of->b == MT_NO_NODE ? mt_program_unary(p, of->op, a, of->addr)
                                   : mt_program_binary(p, of->op, a, b, of->addr);
    }
}

/* An input that the node depends on. */
static int input_of(const mt_program *p, mt_node node)
{
    while (p->nodes[node].op != MT_OP_PARAM) {
        const mt_program_node *const n = &p->nodes[node];
        node = p->nodes[n->a].varies ? n->a : n->b;
    }
    return p->nodes[node].input;
}

/* True where a condition holds. One without a finite value (1/0 > 2) counts as one that does:
 * its operand's node stays and fails the evaluation. */
static bool holds(mt_program *p, mt_node condition, mt_addr addr)
{
    if (condition == MT_NO_NODE) {
        return true;
    }
    const mt_program_node *const n = &p->nodes[condition];
    if (n->varies && !p->undecided) {
        p->undecided = true;
        p->undecided_addr = addr;
        p->undecided_input = input_of(p, condition);
    }
    return n->op != MT_OP_CONST || n->value != 0.0;
}

mt_node mt_program_expr(mt_program *p, const mt_expr *e, const mt_node *params, mt_addr addr)
{
    mt_node stack[MT_EXPR_MAX_CODE];
    int top = 0;
    memset(stack, 0, (size_t)e->length * sizeof *stack); /* which is as deep as it gets */
    for (int i = 0; i < e->length; i++) {
        const mt_code c = e->code[i];
        const int operands = mt_op_operands(c.op);
        mt_node node = MT_NO_NODE;
        if (c.op == MT_OP_IF) {
            node = stack[top - 1];
            i += holds(p, node, addr) ? 0 : c.param;
        } else if (c.op == MT_OP_THEN || c.op == MT_OP_ELSE) {
            node = stack[top - 1];
            i += c.op == MT_OP_THEN ? c.param : 0;
        } else if (operands == 2) {
            node = mt_program_binary(p, c.op, stack[top - 2], stack[top - 1], addr);
        } else if (c.op == MT_OP_INTERP) {
            node = mt_program_interp(p, c.curve, stack[top - 1], addr);
        } else if (operands == 1) {
            node = mt_program_unary(p, c.op, stack[top - 1], addr);
        } else {
            node = c.op == MT_OP_PARAM ? params[c.param] : mt_program_const(p, c.value);
        }
        top -= operands;
        stack[top++] = node;
    }
    return top == 1 ? stack[0] : MT_NO_NODE;
}

mt_node mt_program_add(mt_program *p, mt_node a, mt_node b)
{
    return mt_program_binary(p, MT_OP_ADD, a, b, MT_NO_ADDR);
}

mt_node mt_program_sub(mt_program *p, mt_node a, mt_node b)
{
    return mt_program_binary(p, MT_OP_SUB, a, b, MT_NO_ADDR);
}

mt_node mt_program_mul(mt_program *p, mt_node a, mt_node b)
{
    return mt_program_binary(p, MT_OP_MUL, a, b, MT_NO_ADDR);
}

mt_node mt_program_div(mt_program *p, mt_node a, mt_node b)
{
    return mt_program_binary(p, MT_OP_DIV, a, b, MT_NO_ADDR);
}

/* The least span that holds both. */
static mt_program_span span_of_both(mt_program_span a, mt_program_span b)
{
    if (a.first == a.end || b.first == b.end) {
        return a.first == a.end ? b : a;
    }
    return (mt_program_span){a.first < b.first ? a.first : b.first,
                             a.end > b.end ? a.end : b.end};
}

/* Set of inputs of node i: its own, or the union of those of its operands. */
static void collect_inputs(mt_program *p, int i)
{
    const mt_program_node *const n = &p->nodes[i];
    uint64_t *const set = p->inputs_of + (size_t)i * (size_t)p->words;
    if (n->op == MT_OP_PARAM) {
        set[n->input / BITS] |= UINT64_C(1) << (n->input % BITS);
        p->span[i] = (mt_program_span){n->input, n->input + 1};
        p->active[i] = true;
        return;
    }
    const mt_node operands[2] = {n->a, n->b};
    for (int k = 0; k < 2; k++) {
        if (operands[k] == MT_NO_NODE) {
            continue;
        }
        const uint64_t *const from = p->inputs_of + (size_t)operands[k] * (size_t)p->words;
        for (int w = 0; w < p->words; w++) {
            set[w] |= from[w];
        }
        p->span[i] = span_of_both(p->span[i], p->span[operands[k]]);
        p->active[i] = p->active[i] || p->active[operands[k]];
    }
}

mt_status mt_program_finish(mt_program *p, mt_err *err)
{
    const size_t count = (size_t)p->count;
    if (p->undecided) {
        return mt_fail(err, MT_E_INPUT,
                       "the condition of an if() depends on what varies here; it can hold "
                       "numbers and parameters that keep their values");
    }
    p->words = p->n_inputs / BITS + 1;
    p->active = mt_arena_alloc(p->mem, count, sizeof *p->active);
    p->active_nodes = mt_arena_int(p->mem, count);
    p->inputs_of = mt_arena_alloc(p->mem, count, (size_t)p->words * sizeof *p->inputs_of);
    p->span = mt_arena_alloc(p->mem, count, sizeof *p->span);
    MT_TRY(mt_arena_check(p->mem, err));
    p->n_active = 0;
    for (int i = 0; i < p->count; i++) {
        collect_inputs(p, i);
        if (p->active[i]) {
            p->active_nodes[p->n_active++] = i;
        }
    }
    return MT_OK;
}

bool mt_program_is_constant(const mt_program *p, mt_node node)
{
    return !p->active[node];
}

bool mt_program_has_input(const uint64_t *set, int input)
{
    return ((set[input / BITS] >> (input % BITS)) & 1U) != 0;
}

void mt_program_depends(const mt_program *p, mt_node node, bool *depends)
{
    const uint64_t *const set = p->inputs_of + (size_t)node * (size_t)p->words;
    for (int i = 0; i < p->n_inputs; i++) {
        depends[i] = mt_program_has_input(set, i);
    }
}

void mt_program_include_inputs(const mt_program *p, mt_node node, uint64_t *set)
{
    for (int w = 0; node != MT_NO_NODE && w < p->words; w++) {
        set[w] |= p->inputs_of[((ptrdiff_t)node * p->words) + w];
    }
}

/*
 * Values and forward-mode derivatives. With v = op(a, b) and a prime for d/d(input i):
 *   v' = (dv/da) a' + (dv/db) b'
 * An operand that depends on no input has no term, so x^2 needs no ln x, and a derivative that
 * does not exist with respect to a constant operand does no harm.
 */

double mt_program_node_value(const mt_program_node *n, const double *inputs,
                             const double *value)
{
    if (n->op == MT_OP_CONST) {
        return n->value;
    }
    if (n->op == MT_OP_PARAM) {
        return inputs[n->input];
    }
    return operate(n, value[n->a], n->b == MT_NO_NODE ? 0.0 : value[n->b]);
}

/* Partial derivatives of an operation at (a, b), where its value is v. */
static mt_partials node_partials(const mt_program_node *n, double a, double b, double v)
{
    if (n->op == MT_OP_INTERP) {
        double at[3];
        mt_interpolant_at(n->curve, a, at);
        return (mt_partials){at[1], 0.0};
    }
    return mt_op_partials(n->op, a, b, v);
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
    if (n->op == MT_OP_INTERP) {
        const mt_interpolant *const curve = n->curve;
        return mt_fail(err, MT_E_DOMAIN,
                       "%.6g is outside of the curve \"%s\", whose x goes from %.6g to %.6g",
                       value[n->a], curve->name, curve->x[0], curve->x[curve->n - 1]);
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
        value[i] = mt_program_node_value(&p->nodes[i], inputs, value);
        if (!isfinite(value[i])) {
            return fail_at(p, i, value, "value", bad, err);
        }
    }
    return MT_OK;
}

bool mt_program_values(const mt_program *p, const double *inputs, double *value)
{
    bool whole = true;
    for (int i = 0; i < p->count; i++) {
        const mt_program_node *const n = &p->nodes[i];
        const bool known = (n->a == MT_NO_NODE || isfinite(value[n->a])) &&
                           (n->b == MT_NO_NODE || isfinite(value[n->b]));
        const double v = known ? mt_program_node_value(n, inputs, value) : nan("");
        value[i] = isfinite(v) ? v : nan("");
        whole = whole && isfinite(v);
    }
    return whole;
}

/* row += d * the gradient of an operand, within its span; false: not finite. */
static bool add_operand(const mt_program *p, mt_node operand, double d, const double *grad,
                        double *row)
{
    const mt_program_span span = p->span[operand];
    const double *const from = grad + (size_t)operand * (size_t)p->n_inputs;
    bool finite = true;
    for (int k = span.first; k < span.end; k++) {
        row[k] += d * from[k];
        finite = finite && isfinite(row[k]);
    }
    return finite;
}

/* grad row of an active node within its span, beyond which it is 0, from the rows of its
 * operands; false: not finite. */
static bool node_gradient(const mt_program *p, int i, const double *value, double *grad)
{
    const mt_program_node *const n = &p->nodes[i];
    double *const row = grad + (size_t)i * (size_t)p->n_inputs;
    for (int k = p->span[i].first; k < p->span[i].end; k++) {
        row[k] = 0.0;
    }
    if (n->op == MT_OP_PARAM) {
        row[n->input] = 1.0;
        return true;
    }
    const double b = n->b == MT_NO_NODE ? 0.0 : value[n->b];
    const mt_partials d = node_partials(n, value[n->a], b, value[i]);
    const bool first = !p->active[n->a] || add_operand(p, n->a, d.a, grad, row);
    const bool second =
        n->b == MT_NO_NODE || !p->active[n->b] || add_operand(p, n->b, d.b, grad, row);
    return first && second;
}

static mt_status active_gradients(const mt_program *p, const double *value, double *grad,
                                  mt_node *bad, mt_err *err)
{
    for (int k = 0; k < p->n_active; k++) {
        const int i = p->active_nodes[k];
        if (!node_gradient(p, i, value, grad)) {
            return fail_at(p, i, value, "derivative", bad, err);
        }
    }
    return MT_OK;
}

mt_status mt_program_gradient(const mt_program *p, const double *inputs, double *value,
                              double *grad, mt_node *bad, mt_err *err)
{
    MT_TRY(mt_program_eval(p, inputs, value, bad, err));
    memset(grad, 0, (size_t)p->count * (size_t)p->n_inputs * sizeof *grad);
    return active_gradients(p, value, grad, bad, err);
}

mt_status mt_program_again(const mt_program *p, const double *inputs, double *value,
                           double *grad, mt_node *bad, mt_err *err)
{
    for (int k = 0; k < p->n_active; k++) {
        const int i = p->active_nodes[k];
        value[i] = mt_program_node_value(&p->nodes[i], inputs, value);
        if (!isfinite(value[i])) {
            return fail_at(p, i, value, "value", bad, err);
        }
    }
    return grad == NULL ? MT_OK : active_gradients(p, value, grad, bad, err);
}

/*
 * Enclosures of a program over a box of inputs: by induction over the nodes, each holds every
 * value that its node takes in the box, exact or rounded (see interval.h). Constants are the
 * doubles they were folded to. Derivatives by the chain rule (above) in intervals;
 * where min or max may choose either operand, the derivative is one of the two.
 */

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
    if (n->op == MT_OP_INTERP) {
        mt_interval values;
        mt_interpolant_enclose(n->curve, a, &values, NULL);
        return values;
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

static bool is_zero(mt_interval a)
{
    return a.lo == 0.0 && a.hi == 0.0;
}

static mt_interval_partials interval_partials(const mt_program_node *n, mt_interval a,
                                              mt_interval b, mt_interval v)
{
    if (n->op == MT_OP_INTERP) {
        mt_interval_partials d = {.b = {0.0, 0.0}};
        mt_interpolant_enclose(n->curve, a, NULL, &d.a);
        return d;
    }
    return mt_interval_op_partials(n->op, a, b, v);
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
    const mt_interval_partials d = interval_partials(n, a, b, v);
    const bool b_active = n->b != MT_NO_NODE && p->active[n->b];
    const size_t inputs = (size_t)p->n_inputs;
    const size_t row = (size_t)i * inputs;
    for (size_t k = 0; k < inputs; k++) {
        const size_t ka = (size_t)n->a * inputs + k;
        const size_t kb = (size_t)second * inputs + k;
        const mt_interval da = {dlo[ka], dhi[ka]};
        const mt_interval db = {dlo[kb], dhi[kb]};
        mt_interval sum = {0.0, 0.0};
        if (is_zero(da) && is_zero(db)) {
            continue; /* as the rows stand */
        }
        if (chooses) {
            sum = c == CHOICE_EITHER ? mt_interval_hull(da, db) : c == CHOICE_FIRST ? da : db;
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

/* Along a line, v = f(a, b) has v'' = f_a a'' + f_b b'' + f_aa a'^2 + 2 f_ab a' b' + f_bb
 * b'^2. */

/* Second derivatives of one operation at (a, b), where its value is v: not finite where there
 * is none, 0 at kinks. */
typedef struct curvatures {
    double aa;
    double ab;
    double bb;
} curvatures;

/* Of two operands. */
MT_DIVIDES_BY_ZERO
static curvatures of_two(mt_op op, double a, double b, double v)
{
    const double r4 = ((a * a) + (b * b)) * ((a * a) + (b * b));
    switch ((int)op) {
    case MT_OP_MUL:
        return (curvatures){0.0, 1.0, 0.0};
    case MT_OP_DIV:
        return (curvatures){0.0, -1.0 / (b * b), 2.0 * v / (b * b)};
    case MT_OP_POW:
        return (curvatures){b == 0.0 || b == 1.0 ? 0.0 : b * (b - 1.0) * pow(a, b - 2.0),
                            pow(a, b - 1.0) * (1.0 + (b * log(a))), v * log(a) * log(a)};
    case MT_OP_ATAN2:
        return (curvatures){-2.0 * a * b / r4, ((a * a) - (b * b)) / r4, 2.0 * a * b / r4};
    case MT_OP_HYPOT:
        return (curvatures){b * b / (v * v * v), -a * b / (v * v * v), a * a / (v * v * v)};
    default:
        return (curvatures){0.0, 0.0, 0.0};
    }
}

/* Of one operand. */
MT_DIVIDES_BY_ZERO
static double of_one(mt_op op, double a, double v)
{
    switch ((int)op) {
    case MT_OP_SQRT:
        return -0.25 / (a * v);
    case MT_OP_CBRT:
        return -2.0 / 9.0 * v / (a * a);
    case MT_OP_EXP:
    case MT_OP_SINH:
    case MT_OP_COSH:
        return v;
    case MT_OP_LN:
        return -1.0 / (a * a);
    case MT_OP_LOG10:
        return -1.0 / (a * a * MT_LN_10);
    case MT_OP_SIN:
    case MT_OP_COS:
        return -v;
    case MT_OP_TAN:
        return 2.0 * v * (1.0 + (v * v));
    case MT_OP_ASIN:
        return a / pow((1.0 - a) * (1.0 + a), 1.5);
    case MT_OP_ACOS:
        return -a / pow((1.0 - a) * (1.0 + a), 1.5);
    case MT_OP_ATAN:
        return -2.0 * a / ((1.0 + (a * a)) * (1.0 + (a * a)));
    case MT_OP_TANH:
        return -2.0 * v * (1.0 - v) * (1.0 + v);
    default:
        return 0.0;
    }
}

static curvatures curvatures_of(const mt_program_node *n, double a, double b, double v)
{
    if (n->op == MT_OP_INTERP) {
        double at[3];
        mt_interpolant_at(n->curve, a, at);
        return (curvatures){at[2], 0.0, 0.0};
    }
    return mt_op_operands(n->op) == 2 ? of_two(n->op, a, b, v)
                                      : (curvatures){of_one(n->op, a, v), 0.0, 0.0};
}

/* Product in which 0 times a value that is not finite is 0: a constant operand needs no
 * derivative. */
static double times(double slope, double by)
{
    return by == 0.0 ? 0.0 : slope * by;
}

static void node_second(const mt_program_node *n, const double *a, const double *b,
                        double out[3])
{
    const double v = operate(n, a[0], b[0]);
    const mt_partials d = node_partials(n, a[0], b[0], v);
    const curvatures c = curvatures_of(n, a[0], b[0], v);
    out[0] = v;
    out[1] = times(d.a, a[1]) + times(d.b, b[1]);
    out[2] = times(d.a, a[2]) + times(d.b, b[2]) + times(c.aa, a[1] * a[1]) +
             times(2.0 * c.ab, a[1] * b[1]) + times(c.bb, b[1] * b[1]);
}

mt_status mt_program_second(const mt_program *p, double t, double (*node)[3], mt_err *err)
{
    static const double none[3] = {0.0, 0.0, 0.0};
    for (int i = 0; i < p->count; i++) {
        const mt_program_node *const n = &p->nodes[i];
        double *const out = node[i];
        if (n->op == MT_OP_CONST || n->op == MT_OP_PARAM) {
            out[0] = n->op == MT_OP_CONST ? n->value : t;
            out[1] = n->op == MT_OP_CONST ? 0.0 : 1.0;
            out[2] = 0.0;
            continue;
        }
        node_second(n, node[n->a], n->b == MT_NO_NODE ? none : node[n->b], out);
        if (!isfinite(out[0]) || !isfinite(out[1]) || !isfinite(out[2])) {
            return mt_fail(err, MT_E_DOMAIN,
                           "at %.6g \"%s\" has no finite value or no finite derivatives", t,
                           mt_op_name(n->op));
        }
    }
    return MT_OK;
}
