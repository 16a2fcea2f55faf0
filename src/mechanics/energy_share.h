/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_ENERGY_SHARE_H
#define MECHANICS_ENERGY_SHARE_H

#include "mechanics/linear.h"
#include "model/values.h"

/*
 * Who has the energy of a mode phi (over the states, of mass 1 and eigenvalue lambda).
 *
 * Kinetic, by body and direction. A body moves by v (its centre) and turns by omega, and w = M
 * phi holds its momentum p and its angular momentum L about the centre. About a point at the
 * arm r from the centre, along the axes e_1 e_2 e_3,
 *     v_P = v + omega x r,   L_P = L - r x p,
 *     share along e_i = (e_i . v_P) (e_i . p),   about e_i = (e_i . omega) (e_i . L_P),
 * which is phi_k (M phi)_k of these coordinates. The six of a body sum to v . p + omega . L
 * whatever point and axes, all bodies to phi^T M phi = 1. One of them is below 0 where the axes
 * couple: products of inertia, a point off the centre, rods with mass between two bodies. Such
 * a mass counts at the bodies that it joins; a flexible link's is that of its own bodies, each
 * about its own centre.
 *
 * Strain, by spring: sum over its terms of c (f . phi)^2 / lambda; by component k of a bushing
 * u_k (K u)_k / lambda, below 0 where its matrix couples; and the geometric part of K (gravity,
 * loads, preload), which belongs to no spring: phi^T Kg phi / lambda, of either sign. They sum
 * to one together.
 */

/* A body or link that moves, a spring or link that is strained. */
typedef struct mt_energy_owner {
    const char *name;
    int first; /* bodies or springs first .. first + count - 1 of the system */
    int count;
    bool link;
    bool bushing; /* its energy is that of its six components */
} mt_energy_owner;

typedef struct mt_energy_owners {
    int n_bodies;
    mt_energy_owner *bodies;
    int n_springs;
    mt_energy_owner *springs;
} mt_energy_owners;

/* In the order of the model, bodies and springs before links. Fails: MT_E_MEMORY. */
mt_status mt_energy_owners_find(const mt_system *sys, mt_arena *mem, mt_energy_owners *out,
                                mt_err *err);
/* Index in a list of owners; MT_ABSENT. */
int mt_energy_owner_named(int n, const mt_energy_owner *owners, const char *name);

/* X(id, name): axes along which energies are told. Those of TORQUE_ROLL: the axis about which
 * the free body begins to turn under a torque about global x, y or z, J^-1 e, in the place of
 * that one, and two across it. */
#define MT_ENERGY_AXES_LIST(X)        \
    X(GLOBAL, "global")               \
    X(PRINCIPAL, "principal")         \
    X(TORQUE_ROLL_X, "torque_roll_x") \
    X(TORQUE_ROLL_Y, "torque_roll_y") \
    X(TORQUE_ROLL_Z, "torque_roll_z")
#define MT_ENERGY_AXES_ENUM(id, name) MT_ENERGY_AXES_##id,
typedef enum mt_energy_axes {
    MT_ENERGY_AXES_LIST(MT_ENERGY_AXES_ENUM) MT_ENERGY_AXES_COUNT
} mt_energy_axes;
#undef MT_ENERGY_AXES_ENUM
/* Their names in files. */
extern const char *const mt_energy_axes_names[MT_ENERGY_AXES_COUNT];
/* "x", "y", "z", "rx", "ry", "rz". */
enum { MT_ENERGY_DIRECTIONS = 6 };
extern const char *const mt_energy_directions[MT_ENERGY_DIRECTIONS];

/* The point, which each body carries, and the axes. Those of inertia are carried, too;
 * principal ones are named after that of x, y, z next to each as drawn. Links, bodies without
 * moments of inertia, and all in the plane have the global axes, links their own centres. */
typedef struct mt_energy_about {
    int point; /* of the model's points; MT_ABSENT: each body's centre */
    mt_energy_axes axes;
} mt_energy_about;

typedef enum mt_energy_kind {
    MT_ENERGY_MOTION, /* kinetic, of a body */
    MT_ENERGY_STRAIN, /* of a spring */
    MT_ENERGY_LOADS   /* of the geometric part of K */
} mt_energy_kind;

/* A part of the energies: a quadratic form q(phi). Immutable, for all systems of one
 * configuration. */
typedef struct mt_energy_part {
    mt_energy_kind kind;
    int first; /* bodies or springs */
    int count;
    int direction; /* of a body, or component of a bushing; MT_ABSENT: all */
    mt_energy_axes axes;
    bool pointed;     /* about a point of the model, otherwise about the centre */
    mt_numbers point; /* where pointed: its coordinates, of all parameters */
} mt_energy_part;

/* The part of an owner's energies. In mem. owner NULL: MT_ENERGY_LOADS. about NULL: the centre,
 * global axes. Fails: MT_E_MEMORY, MT_E_INTERNAL. */
mt_status mt_energy_part_init(const mt_system *sys, mt_energy_kind kind,
                              const mt_energy_owner *owner, int direction,
                              const mt_energy_about *about, mt_arena *mem, mt_energy_part *out,
                              mt_err *err);
/* *q of phi[nq] with w = M phi; gradient[nq] := its gradient by phi unless NULL. After an
 * update. O(rows). Fails: MT_E_DOMAIN (the point has no place), MT_E_MEMORY. */
mt_status mt_energy_part_value(mt_linear *lin, const mt_energy_part *part, const double *phi,
                               const double *w, double *q, double *gradient, mt_err *err);
/* *slope: derivative of q by input p at fixed phi, after an update with gradients. O(rows).
 * Fails: MT_E_DOMAIN, also where two principal moments are equal and their axes have no
 * derivative; MT_E_MEMORY. */
mt_status mt_energy_part_slope(mt_linear *lin, const mt_energy_part *part, int p,
                               const double *phi, const double *w, double *slope, mt_err *err);

#endif
