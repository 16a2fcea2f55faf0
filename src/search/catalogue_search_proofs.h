/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_CATALOGUE_SEARCH_PROOFS_H
#define SEARCH_CATALOGUE_SEARCH_PROOFS_H

#include "search/proof.h"

/*
 * What can be proven of boxes of combinations. Where a catalogue shapes the geometry nothing
 * encloses modes over several of its values, but over boxes with one of them: each geometry has
 * a proof of its own, made when it is first asked for, of which the last few are kept. One set,
 * one worker; what a box is told does not depend on those before it.
 */
enum { MT_CATALOGUE_SEARCH_PROOFS_KEPT = 16 };

typedef struct mt_catalogue_search_proofs {
    const mt_subproblem *c; /* the relaxed problem; must outlive this */
    int n_shaping;
    int *shaping; /* [n_shaping] variables with a catalogue that shape the geometry */
    mt_proof proof[MT_CATALOGUE_SEARCH_PROOFS_KEPT];
    mt_arena mem[MT_CATALOGUE_SEARCH_PROOFS_KEPT]; /* of these */
    int n; /* made so far; number i lies at i % MT_CATALOGUE_SEARCH_PROOFS_KEPT */
} mt_catalogue_search_proofs;

/* Arrays in mem. */
mt_status mt_catalogue_search_proofs_init(mt_catalogue_search_proofs *s, const mt_subproblem *c,
                                          mt_arena *mem, mt_err *err);
/* Accepts a zeroed set. */
void mt_catalogue_search_proofs_free(mt_catalogue_search_proofs *s);
/* Whether variable i is a catalogue that shapes the geometry. */
bool mt_catalogue_search_shapes(const mt_catalogue_search_proofs *s, int i);
/* How many geometries the catalogues have. The relaxed problem at number `which` of them:
 * lower[n], upper[n]. */
double mt_catalogue_search_geometries(const mt_catalogue_search_proofs *s);
void mt_catalogue_search_geometry(const mt_catalogue_search_proofs *s, int which, double *lower,
                                  double *upper);
/* The proof of the box lower <= x <= upper [n], its bounds set to it, until the next call;
 * NULL: there is none. Fails as mt_proof_init. */
mt_status mt_catalogue_search_proof_of(mt_catalogue_search_proofs *s, const double *lower,
                                       const double *upper, mt_proof **out, mt_err *err);

#endif
