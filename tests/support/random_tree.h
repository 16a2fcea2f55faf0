/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random mechanisms of hinged bodies with springs: trees and such with loops, in the plane and
 * in space, held and free, hanging in gravity, with each kind of damping; as documents. */
#ifndef TESTS_RANDOM_TREE_H
#define TESTS_RANDOM_TREE_H

#include "mt_writer.h"
#include "support/mt_random.h"

enum { TREE_TEXT = 100000, TREE_BODIES = 50 };

typedef enum tree_damping {
    TREE_UNDAMPED,
    TREE_PROPORTIONAL,
    TREE_RATIOS,
    TREE_RATIO,
    TREE_DAMPERS,
    TREE_LOSS,
    TREE_LOSSES,
    TREE_DAMPERS_AND_LOSSES,
    TREE_KINDS
} tree_damping;

typedef struct random_tree {
    mt_random g;
    int axes;
    bool free;
    bool hung;
    bool looped;
    bool everywhere; /* dampers in all joints */
    tree_damping kind;
    double at[TREE_BODIES][3];
    int before[TREE_BODIES];
} random_tree;

static inline void add_point(mt_writer *w, const random_tree *r, const double *x)
{
    mt_write(w, "[%.17g, %.17g", x[0], x[1]);
    if (r->axes == 3) {
        mt_write(w, ", %.17g", x[2]);
    }
    mt_write(w, "]");
}

/* Body i and what it hangs on. */
static inline void place_body(random_tree *r, int i)
{
    const int back = i > 0 && !r->hung ? mt_random_int(&r->g, i < 4 ? i : 4) : 0;
    r->before[i] = i - 1 - back;
    for (int k = 0; k < 3; k++) {
        const double from = r->before[i] < 0 ? 0.0 : r->at[r->before[i]][k];
        const double step = r->hung ? (k == 1 ? -0.3 : 0.0) : mt_random_in(&r->g, -0.3, 0.3);
        r->at[i][k] = k < r->axes ? from + step : 0.0;
    }
}

static inline void add_bodies(mt_writer *w, random_tree *r)
{
    mt_write(w, "\"bodies\": [");
    for (int i = 0; i < TREE_BODIES; i++) {
        place_body(r, i);
        mt_write(w,
                 "%s{ \"name\": \"b%d\", \"mass_kg\": %.17g, \"centre\": ", i > 0 ? ", " : "",
                 i, mt_random_in(&r->g, 0.5, 2.0));
        add_point(w, r, r->at[i]);
        if (r->axes == 2) {
            mt_write(w, ", \"inertia_kg_m2\": %.17g }", mt_random_in(&r->g, 0.01, 0.02));
        } else {
            mt_write(w, ", \"inertia_kg_m2\": [%.17g, 0.014, 0.013, 0, 0, 0] }",
                     mt_random_in(&r->g, 0.01, 0.016));
        }
    }
    mt_write(w, "], ");
}

static inline void add_joints(mt_writer *w, random_tree *r)
{
    bool first = true;
    mt_write(w, "\"joints\": [");
    for (int i = r->free ? 1 : 0; i < TREE_BODIES; i++) {
        double middle[3] = {0.0};
        for (int k = 0; k < 3; k++) {
            const double from = r->before[i] < 0 ? 0.0 : r->at[r->before[i]][k];
            middle[k] = 0.5 * (from + r->at[i][k]);
        }
        mt_write(w, "%s{ \"name\": \"j%d\", \"type\": \"revolute\", \"bodies\": [",
                 first ? "" : ", ", i);
        if (r->before[i] < 0) {
            mt_write(w, "\"ground\"");
        } else {
            mt_write(w, "\"b%d\"", r->before[i]);
        }
        mt_write(w, ", \"b%d\"], \"at\": ", i);
        add_point(w, r, middle);
        if (r->axes == 3) {
            mt_write(w, ", \"axis\": [%.17g, %.17g, 1]", mt_random_in(&r->g, -1.0, 1.0),
                     mt_random_in(&r->g, -1.0, 1.0));
        }
        mt_write(w, " }");
        first = false;
    }
    if (r->looped && !r->hung) {
        mt_write(
            w, ", { \"name\": \"bar\", \"type\": \"distance\", \"bodies\": [\"b5\", \"b30\"], "
               "\"at\": [");
        add_point(w, r, r->at[5]);
        mt_write(w, ", ");
        add_point(w, r, r->at[30]);
        mt_write(w, "] }");
    }
    mt_write(w, "], ");
}

static inline bool random_tree_damped(const random_tree *r)
{
    return r->kind == TREE_DAMPERS || r->kind == TREE_DAMPERS_AND_LOSSES;
}

static inline void add_springs(mt_writer *w, random_tree *r)
{
    const bool some = r->kind == TREE_LOSSES || r->kind == TREE_DAMPERS_AND_LOSSES;
    const bool dampers = random_tree_damped(r);
    bool first = true;
    mt_write(w, "\"springs\": [");
    for (int i = r->free ? 1 : 0; i < TREE_BODIES; i++) {
        mt_write(w,
                 "%s{ \"name\": \"s%d\", \"type\": \"torsion\", \"joint\": \"j%d\", "
                 "\"stiffness_n_m_per_rad\": %.17g",
                 first ? "" : ", ", i, i, mt_random_in(&r->g, 500.0, 5000.0));
        if (r->kind == TREE_LOSS || (some && i % 9 == 2)) {
            mt_write(w, ", \"loss_factor\": %.17g", r->kind == TREE_LOSS ? 0.04 : 0.1);
        }
        mt_write(w, " }");
        first = false;
    }
    if (r->looped) {
        const double aside[] = {r->at[0][0] + 0.5, r->at[0][1], r->at[0][2]};
        mt_write(w,
                 ", { \"name\": \"tie\", \"type\": \"axial\", \"bodies\": [\"b0\", \"b%d\"], "
                 "\"stiffness_n_per_m\": 3000, \"at\": [",
                 TREE_BODIES - 1);
        add_point(w, r, aside);
        mt_write(w, ", ");
        add_point(w, r, r->at[TREE_BODIES - 1]);
        mt_write(w, "]%s }", r->kind == TREE_LOSS ? ", \"loss_factor\": 0.04" : "");
    }
    mt_write(w, "], ");
    first = true;
    for (int i = 1; i < TREE_BODIES && dampers; i += r->everywhere ? 1 : 8) {
        mt_write(w,
                 "%s{ \"name\": \"d%d\", \"type\": \"torsion\", \"joint\": \"j%d\", "
                 "\"damping_n_m_s_per_rad\": %.17g }",
                 first ? "\"dampers\": [" : ", ", i, i, mt_random_in(&r->g, 1.0, 20.0));
        first = false;
    }
    mt_write(w, "%s", dampers ? "], " : "");
}

static inline void random_tree_write(random_tree *r, mt_writer *w)
{
    static const char *const DAMPING[TREE_KINDS] = {
        [TREE_PROPORTIONAL] = "\"mass_per_s\": 0.3, \"stiffness_s\": 1e-4",
        [TREE_RATIOS] = "\"ratios\": [0.01, 0.03, 0.02]",
        [TREE_RATIO] = "\"ratio\": 0.02"};
    mt_write(w, "{ \"format\": \"modetune-model/1\", \"name\": \"t\", \"dimension\": %d, ",
             r->axes);
    add_bodies(w, r);
    add_joints(w, r);
    add_springs(w, r);
    if (r->hung) {
        mt_write(w, "\"gravity_m_per_s2\": [0, -9.81%s], ", r->axes == 3 ? ", 0" : "");
    }
    if (DAMPING[r->kind] != NULL) {
        mt_write(w, "\"damping\": { %s }, ", DAMPING[r->kind]);
    }
    mt_write(w, "\"sensors\": [");
    for (int k = 0; k < 2; k++) {
        const int on = k == 0 ? TREE_BODIES - 1 : TREE_BODIES / 2;
        mt_write(w, "%s{ \"name\": \"p%d\", \"on\": \"b%d\", \"at\": ", k > 0 ? ", " : "", k,
                 on);
        add_point(w, r, r->at[on]);
        mt_write(w, ", \"directions\": [\"x\", \"y\"] }");
    }
    mt_write(w, "], \"configurations\": { \"c\": {} } }");
}

#endif
