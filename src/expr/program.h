/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef EXPR_PROGRAM_H
#define EXPR_PROGRAM_H

#include <stdint.h>

#include "base/sorted.h"
#include "expr/expr.h"

/*
 * A program: many numbers that depend on few inputs, as one list of nodes in order of
 * evaluation (operands before results). While it is built, equal nodes are shared, constants
 * folded (where the result is finite) and neutral operations dropped. Then it is evaluated
 * often, without the heap: values; values with exact first derivatives (forward mode);
 * enclosures of both over a box. A node is evaluated even where nothing uses it, so no domain
 * error can hide behind a factor 0. Building: init, then const/input/unary/binary/expr in any
 * order, then finish. Once the arena has failed every node is MT_NO_NODE (accepted as an
 * operand), and finish says so. Building more after finish is possible; finish again then. A
 * finished program is only read by the evaluations: threads may share it.
 */
typedef int mt_node; /* index of a node; MT_NO_NODE: absent */
enum { MT_NO_NODE = -1 };

typedef struct mt_program_node {
    mt_op op;
    mt_node a; /* operands; MT_NO_NODE where there is none */
    mt_node b;
    int input;    /* MT_OP_PARAM */
    double value; /* MT_OP_CONST */
    mt_addr addr; /* the number in the input file that this belongs to, for messages */
} mt_program_node;

/* Inputs from `first` to before `end`. */
typedef struct mt_program_span {
    int first;
    int end;
} mt_program_span;

typedef struct mt_program {
    mt_arena *mem; /* not owned; holds everything below */
    mt_program_node *nodes;
    int count;
    int capacity;
    int n_inputs;
    mt_sorted order;     /* of the nodes, for sharing */
    bool *active;        /* [count] depends on some input; made by finish */
    uint64_t *inputs_of; /* [count * words] the inputs that each node depends on, as bits */
    int words;
    mt_program_span *span; /* [count] the shortest that has all inputs that a node depends on */
    int *active_nodes;     /* the active ones in order */
    int n_active;
} mt_program;

mt_status mt_program_init(mt_program *p, int n_inputs, mt_arena *mem, mt_err *err);
mt_node mt_program_const(mt_program *p, double value);
mt_node mt_program_input(mt_program *p, int input, mt_addr addr);
mt_node mt_program_unary(mt_program *p, mt_op op, mt_node a, mt_addr addr);
mt_node mt_program_binary(mt_program *p, mt_op op, mt_node a, mt_node b, mt_addr addr);
/* Emit a parsed expression; parameter i of it stands for node params[i]. */
mt_node mt_program_expr(mt_program *p, const mt_expr *e, const mt_node *params, mt_addr addr);
/* Shorthands without address for sums built by the mechanics. */
mt_node mt_program_add(mt_program *p, mt_node a, mt_node b);
mt_node mt_program_sub(mt_program *p, mt_node a, mt_node b);
mt_node mt_program_mul(mt_program *p, mt_node a, mt_node b);
mt_node mt_program_div(mt_program *p, mt_node a, mt_node b);
/* Close the program. Fails MT_E_MEMORY. */
mt_status mt_program_finish(mt_program *p, mt_err *err);

/* Whether the value of the node is fixed (no input in it). Only after finish. */
bool mt_program_is_constant(const mt_program *p, mt_node node);
/* depends[i] = whether the node depends on input i (structurally); [n_inputs]. */
void mt_program_depends(const mt_program *p, mt_node node, bool *depends);
/* The same added to a set of bits, set[p->words]. MT_NO_NODE adds nothing. */
void mt_program_include_inputs(const mt_program *p, mt_node node, uint64_t *set);
/* Whether the input is in such a set. */
bool mt_program_has_input(const uint64_t *set, int input);

/* value[count]: values of all nodes at inputs[n_inputs]. O(count). Fails MT_E_DOMAIN where a
 * value is not finite ("sqrt(-3) has no finite value"); *bad (may be NULL) is then that node,
 * its addr the place in the input file, and the values before it are valid. */
mt_status mt_program_eval(const mt_program *p, const double *inputs, double *value,
                          mt_node *bad, mt_err *err);
/* Values and gradient: grad[node * n_inputs + i] = d value[node] / d inputs[i], [count *
 * n_inputs]. At a kink the side of the first operand: abs'(0) = 1, min(x, x) and max(x, x) go
 * with the first. A constant exponent needs no logarithm: x^2 has a derivative for every x.
 * O(count * n_inputs), less where nodes depend on few inputs. Fails MT_E_DOMAIN also where a
 * derivative is not finite (sqrt at 0, hypot and atan2 at 0, 0): then all values are valid, and
 * the derivatives of the nodes before *bad. */
mt_status mt_program_gradient(const mt_program *p, const double *inputs, double *value,
                              double *grad, mt_node *bad, mt_err *err);
/* Either of them, to the same bits, where value is left from an evaluation of this program that
 * succeeded, and grad (NULL: values alone) from one with gradient, or is all 0: nodes that
 * depend on no input are not touched. Fails likewise; what depends on inputs is then void. */
mt_status mt_program_again(const mt_program *p, const double *inputs, double *value,
                           double *grad, mt_node *bad, mt_err *err);
/* Enclosures: for all inputs within [lower, upper] (each [n_inputs], lower <= upper, infinite
 * allowed), where value[node] exists, lo[node] <= value[node] <= hi[node], lo and hi [count].
 * That holds for the exact values and for the rounded ones that mt_program_eval gives; what it
 * rests on: interval.h. Where a divisor's enclosure holds zero or an operand may leave the
 * domain: -inf, +inf. */
void mt_program_interval(const mt_program *p, const double *lower, const double *upper,
                         double *lo, double *hi);
/* Enclosures of the derivatives of all nodes over the box as well: dlo, dhi [count * n_inputs],
 * as mt_program_gradient lays them out; exactly [0, 0] where a node does not depend on an
 * input. At a kink both sides are within. */
void mt_program_interval_gradient(const mt_program *p, const double *lower, const double *upper,
                                  double *lo, double *hi, double *dlo, double *dhi);

#endif
