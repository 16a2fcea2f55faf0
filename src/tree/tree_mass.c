/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Masses of the bodies of a tree: a block of each, and one with the body before it where they
 * share some (beam elements, bars). */
#include "tree/tree_priv.h"

#include <string.h>

#include "base/format.h"
#include "mechanics/rows.h"

enum { MOST_ROWS = 16 };

/* block (s x s) += c a b^T, halves `u` and `v` of the local freedoms. */
static void add_block(const mt_tree *t, double c, const mt_cx *a, int u, const mt_cx *b, int v,
                      double *block)
{
    for (int col = 0; col < t->s; col++) {
        const double x = c * creal(b[(6 * v) + mt_tree_freedom(t, col)]);
        for (int row = 0; row < t->s; row++) {
            block[row + (t->s * col)] += x * creal(a[(6 * u) + mt_tree_freedom(t, row)]);
        }
    }
}

/* Set rotations of point masses to 0: they are not freedoms. */
static void clear_point_mass_rotations(const mt_system *sys, const mt_term *term, mt_cx *rows)
{
    for (int r = 0; r < term->count; r++) {
        for (int k = 0; k < MT_LOCAL; k++) {
            const int body = term->body[k / 6];
            if (body == MT_GROUND || sys->bodies[body].dof[k % 6] < 0) {
                rows[k + (MT_LOCAL * r)] = 0.0;
            }
        }
    }
}

static void add_mass_term(mt_tree_maker *m, const mt_term *term, double c, const mt_cx *rows)
{
    mt_tree *const t = m->t;
    const ptrdiff_t square = (ptrdiff_t)t->s * t->s;
    const bool same = term->body[0] == term->body[1];
    for (int r = 0; r < (term->pair ? 1 : term->count); r++) {
        const mt_cx *const a = rows + ((ptrdiff_t)MT_LOCAL * r);
        const mt_cx *const b = term->pair ? a + MT_LOCAL : a;
        for (int side = 0; side < (same ? 1 : 2); side++) {
            if (term->body[side] == MT_GROUND) {
                continue;
            }
            double *const own = t->mass + (square * t->place[term->body[side]]);
            add_block(t, 0.5 * c, a, side, b, side, own);
            add_block(t, 0.5 * c, b, side, a, side, own);
        }
        if (same || term->body[0] == MT_GROUND || term->body[1] == MT_GROUND) {
            continue;
        }
        const int first = t->place[term->body[0]];
        const int second = t->place[term->body[1]];
        const int before = t->before[second] == first ? 0 : 1; /* side of the body before */
        double *const shared = t->shared + (square * (before == 0 ? second : first));
        add_block(t, c, a, before, a, 1 - before, shared); /* no pair is of two bodies */
    }
}

mt_status mt_tree_masses(mt_tree_maker *m, mt_arena *mem, bool *is_tree, mt_err *err)
{
    mt_tree *const t = m->t;
    const mt_system *const sys = t->sys;
    mt_cx rows[MOST_ROWS * MT_LOCAL];
    for (int i = 0; i < sys->n_inertias && t->shared == NULL; i++) {
        if (sys->inertias[i].body[0] != sys->inertias[i].body[1]) {
            t->shared = mt_arena_f64(mem, (size_t)t->n * (size_t)t->s, (size_t)t->s);
            MT_TRY(mt_arena_check(mem, err));
        }
    }
    for (int i = 0; i < sys->n_inertias; i++) {
        const mt_term term = mt_term_of_inertia(sys, i);
        const double c = m->data.value[term.coefficient];
        if (c < 0.0 && !term.pair) {
            (void)mt_snprintf(m->why, MT_TREE_WHY, "a mass of \"%s\" is negative",
                              sys->bodies[term.body[0]].name);
            *is_tree = false;
            return MT_OK;
        }
        if (c != 0.0) {
            mt_term_rows(&m->data, MT_TERM_MASS, &term, m->pose, rows);
            clear_point_mass_rotations(sys, &term, rows);
            add_mass_term(m, &term, c, rows);
        }
    }
    return MT_OK;
}
