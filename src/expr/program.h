/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef EXPR_PROGRAM_H
#define EXPR_PROGRAM_H

#include <stdint.h>

#include "base/sorted.h"
#include "expr/expr.h"

/*
 * A program: many numbers that depend on few inputs, as one list of nodes in order of
 * evaluation (operands before results). Building shares equal nodes, folds constants (where the
 * result is finite) and drops neutral operations. Evaluation does not use the heap and gives
 * values; values with exact first derivatives (forward mode); or enclosures of both over a box.
 * Unused nodes are evaluated as well, so a factor 0 hides no domain error.
 *
 * Building: init, then const/input/unary/binary/expr in any order, then finish. Once the arena
 * has failed every node is MT_NO_NODE (accepted as an operand), and finish returns the failure.
 * Nodes may be added after finish, followed by another finish. Evaluations only read a finished
 * program: threads may share it.
 */
typedef int mt_node; /* index of a node; MT_NO_NODE: absent */
enum { MT_NO_NODE = -1 };

typedef struct mt_program_node {
    mt_op op;
    mt_node a; /* operands; MT_NO_NODE: none */
    mt_node b;
    int input;   /* MT_OP_PARAM */
    bool varies; /* it depends on an input; set by the program */
    union {
        double value;                /* MT_OP_CONST */
        const mt_interpolant *curve; /* MT_OP_INTERP */
    };
    mt_addr addr; /* address of its number in the input file, for messages */
} mt_program_node;

/* Inputs first .. end - 1. */
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
    mt_sorted order;     /* of the nodes, to find equal ones */
    bool *active;        /* [count] depends on some input; set by finish */
    uint64_t *inputs_of; /* [count * words] bit set of the inputs that each node depends on */
    int words;
    mt_program_span *span; /* [count] shortest span with all inputs that a node depends on */
    int *active_nodes;     /* [n_active] active nodes in order */
    int n_active;
    /* an if() whose condition depends on an input, which it must not: the first one's address
     * and one of the inputs */
    bool undecided;
    mt_addr undecided_addr;
    int undecided_input;
} mt_program;

mt_status mt_program_init(mt_program *p, int n_inputs, mt_arena *mem, mt_err *err);
mt_node mt_program_const(mt_program *p, double value);
mt_node mt_program_input(mt_program *p, int input, mt_addr addr);
mt_node mt_program_unary(mt_program *p, mt_op op, mt_node a, mt_addr addr);
mt_node mt_program_binary(mt_program *p, mt_op op, mt_node a, mt_node b, mt_addr addr);
mt_node mt_program_interp(mt_program *p, const mt_interpolant *curve, mt_node a, mt_addr addr);
/* A copy of a node of another program, with operands a and b (MT_NO_NODE: it has none) here. */
mt_node mt_program_copy(mt_program *p, const mt_program_node *of, mt_node a, mt_node b);
/* Add a parsed expression; its parameter i is node params[i]. Of an if() only the chosen branch
 * is added; where its condition depends on an input `undecided` is set, and finish fails. */
mt_node mt_program_expr(mt_program *p, const mt_expr *e, const mt_node *params, mt_addr addr);
/* Shorthands without address, for sums made by the mechanics. */
mt_node mt_program_add(mt_program *p, mt_node a, mt_node b);
mt_node mt_program_sub(mt_program *p, mt_node a, mt_node b);
mt_node mt_program_mul(mt_program *p, mt_node a, mt_node b);
mt_node mt_program_div(mt_program *p, mt_node a, mt_node b);
/* Finish the program. Fails MT_E_MEMORY; MT_E_INPUT where it is undecided. */
mt_status mt_program_finish(mt_program *p, mt_err *err);

/* Value of a node at inputs, from those of the nodes before it. */
double mt_program_node_value(const mt_program_node *n, const double *inputs,
                             const double *value);
/* True where the node depends on no input. Only after finish. */
bool mt_program_is_constant(const mt_program *p, mt_node node);
/* depends[i]: the node depends on input i (structurally); [n_inputs]. */
void mt_program_depends(const mt_program *p, mt_node node, bool *depends);
/* Add the inputs that the node depends on to a bit set, set[p->words]. MT_NO_NODE adds
 * nothing. */
void mt_program_include_inputs(const mt_program *p, mt_node node, uint64_t *set);
/* True where the input is in such a set. */
bool mt_program_has_input(const uint64_t *set, int input);

/* value[count]: values of all nodes at inputs[n_inputs]. O(count). Fails MT_E_DOMAIN where a
 * value is not finite ("sqrt(-3) has no finite value"); *bad (may be NULL) is then that node,
 * its addr the location in the input file, and the values before it are valid. */
mt_status mt_program_eval(const mt_program *p, const double *inputs, double *value,
                          mt_node *bad, mt_err *err);
/* As mt_program_eval, but goes on behind a node without a finite value: it, and what depends on
 * it, is NaN. True where all are finite. */
bool mt_program_values(const mt_program *p, const double *inputs, double *value);
/* Values and gradient: grad[node * n_inputs + i] = d value[node] / d inputs[i], [count *
 * n_inputs]. Kinks as in mt_op_partials: abs'(0) = 1, min(x, x) and max(x, x) follow the first
 * operand. A constant exponent needs no logarithm: x^2 has a derivative for every x. O(count *
 * n_inputs), less where nodes depend on few inputs. Fails MT_E_DOMAIN also where a derivative
 * is not finite (sqrt at 0, hypot and atan2 at 0, 0): all values are then valid, and the
 * derivatives of the nodes before *bad. */
mt_status mt_program_gradient(const mt_program *p, const double *inputs, double *value,
                              double *grad, mt_node *bad, mt_err *err);
/* Evaluation again, with the same bits as mt_program_eval (grad NULL) or mt_program_gradient,
 * that skips nodes without inputs. value must hold an earlier successful evaluation of this
 * program; grad one with gradient, or zeros. Fails as those; the nodes that depend on inputs
 * are then void. */
mt_status mt_program_again(const mt_program *p, const double *inputs, double *value,
                           double *grad, mt_node *bad, mt_err *err);
/* Enclosures: for all inputs within [lower, upper] (each [n_inputs], lower <= upper, infinite
 * allowed), lo[node] <= value[node] <= hi[node] wherever value[node] exists, lo and hi [count].
 * This holds for exact values and for the rounded ones of mt_program_eval; for the assumptions
 * see interval.h. Where a divisor's enclosure contains zero or an operand may leave the domain:
 * -inf, +inf. */
void mt_program_interval(const mt_program *p, const double *lower, const double *upper,
                         double *lo, double *hi);
/* Values as mt_program_interval, and enclosures of all derivatives over the box: dlo, dhi
 * [count * n_inputs], in the order of mt_program_gradient; exactly [0, 0] where a node does not
 * depend on an input. At a kink both sides are enclosed. */
void mt_program_interval_gradient(const mt_program *p, const double *lower, const double *upper,
                                  double *lo, double *hi, double *dlo, double *dhi);

/* node[count] = value, first and second derivative by the input at t, for a program with one
 * input. O(count). Fails: MT_E_DOMAIN where one of them is not finite. */
mt_status mt_program_second(const mt_program *p, double t, double (*node)[3], mt_err *err);

#endif
