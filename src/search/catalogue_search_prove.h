/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_CATALOGUE_SEARCH_PROVE_H
#define SEARCH_CATALOGUE_SEARCH_PROVE_H

#include "base/workers.h"
#include "search/proof.h"

/*
 * Proofs over boxes of combinations. Where a catalogue shapes the geometry, modes cannot be
 * enclosed over several of its values, only over boxes with a single one: each geometry has its
 * own proof, made on first use; the last MT_CATALOGUE_SEARCH_PROOFS_KEPT are kept. One set
 * serves one worker; results for a box do not depend on earlier ones.
 */
enum { MT_CATALOGUE_SEARCH_PROOFS_KEPT = 16 };

typedef struct mt_catalogue_search_proofs {
    const mt_subproblem *c; /* the relaxed problem; must outlive this */
    int n_shaping;
    int *shaping; /* [n_shaping] variables with a catalogue that shape the geometry */
    mt_proof proof[MT_CATALOGUE_SEARCH_PROOFS_KEPT];
    mt_arena mem[MT_CATALOGUE_SEARCH_PROOFS_KEPT]; /* of the proofs */
    int n; /* made so far; proof i is at i % MT_CATALOGUE_SEARCH_PROOFS_KEPT */
} mt_catalogue_search_proofs;

/* Sets up an empty set; arrays in mem. */
mt_status mt_catalogue_search_proofs_init(mt_catalogue_search_proofs *s, const mt_subproblem *c,
                                          mt_arena *mem, mt_err *err);
/* Accepts a zeroed set. */
void mt_catalogue_search_proofs_free(mt_catalogue_search_proofs *s);

/* What a short certificate says of a box of combinations. */
typedef struct mt_catalogue_search_look {
    bool excluded; /* no design of it meets the goals and has an objective below the cap */
    bool met;      /* a design does */
    double *x;     /* [n] that one */
    long work;     /* as certificates count it */
    long multiplications;
} mt_catalogue_search_look;
/* Looks at lower <= x <= upper [n] with the work of `boxes` boxes at most; cap NULL: any
 * objective. Of the look x is the caller's. Without a proof nothing is known. Fails: as
 * mt_catalogue_search_proof_of. */
mt_status mt_catalogue_search_look_at(mt_catalogue_search_proofs *s, const double *lower,
                                      const double *upper, const mt_certify_cap *cap,
                                      double boxes, mt_arena *mem,
                                      mt_catalogue_search_look *out, mt_err *err);
/* Writes or reads a look within the bounds of c. */
void mt_catalogue_search_look_serialize(const mt_subproblem *c, mt_catalogue_search_look *look,
                                        mt_serializer *serializer);

#endif
