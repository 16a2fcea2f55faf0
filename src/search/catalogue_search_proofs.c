/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "search/catalogue_search_proofs.h"

#include <limits.h>
#include <string.h>

/* A box beside its factorisations, in multiplications, as in certify.c. */
static const double BOX = 500.0;

mt_status mt_catalogue_search_proofs_init(mt_catalogue_search_proofs *s, const mt_subproblem *c,
                                          mt_arena *mem, mt_err *err)
{
    bool *shapes = NULL;
    int n = 0;
    *s = (mt_catalogue_search_proofs){.c = c};
    s->shaping = mt_arena_int(mem, (size_t)c->p->n);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_proof_shaping(c, mem, &shapes, &n, err));
    for (int i = 0; i < c->p->n; i++) {
        if (shapes[i] && c->p->study->variables[i].n_catalogue > 0) {
            s->shaping[s->n_shaping++] = i;
        }
    }
    return MT_OK;
}

static void drop(mt_catalogue_search_proofs *s, int slot)
{
    mt_proof_free(&s->proof[slot]);
    mt_arena_free(&s->mem[slot]);
    s->proof[slot] = (mt_proof){.possible = false};
}

void mt_catalogue_search_proofs_free(mt_catalogue_search_proofs *s)
{
    for (int i = 0; i < MT_CATALOGUE_SEARCH_PROOFS_KEPT; i++) {
        drop(s, i);
    }
}

bool mt_catalogue_search_shapes(const mt_catalogue_search_proofs *s, int i)
{
    for (int k = 0; k < s->n_shaping; k++) {
        if (s->shaping[k] == i) {
            return true;
        }
    }
    return false;
}

double mt_catalogue_search_geometries(const mt_catalogue_search_proofs *s)
{
    double n = 1.0;
    for (int k = 0; k < s->n_shaping; k++) {
        n *= (double)s->c->p->study->variables[s->shaping[k]].n_catalogue;
    }
    return n;
}

void mt_catalogue_search_geometry(const mt_catalogue_search_proofs *s, int which, double *lower,
                                  double *upper)
{
    for (int i = 0; i < s->c->p->n; i++) {
        lower[i] = s->c->lower[i];
        upper[i] = s->c->upper[i];
    }
    for (int k = 0; k < s->n_shaping; k++) {
        const int i = s->shaping[k];
        const mt_variable *const v = &s->c->p->study->variables[i];
        lower[i] = v->catalogue[which % v->n_catalogue];
        upper[i] = lower[i];
        which /= v->n_catalogue;
    }
}

/* True where the proof in the slot is of the geometry of the box. */
static bool is_of(const mt_catalogue_search_proofs *s, int slot, const double *lower)
{
    for (int k = 0; k < s->n_shaping; k++) {
        if (s->proof[slot].lower[s->shaping[k]] != lower[s->shaping[k]]) {
            return false;
        }
    }
    return true;
}

static mt_status make_geometry_proof(mt_catalogue_search_proofs *s, int slot,
                                     const double *lower, mt_err *err)
{
    mt_subproblem held;
    mt_proof *const proof = &s->proof[slot];
    mt_arena *const mem = &s->mem[slot];
    drop(s, slot);
    MT_TRY(mt_arena_init(mem, 0, err));
    MT_TRY(mt_subproblem_copy(s->c, mem, &held, err));
    for (int k = 0; k < s->n_shaping; k++) {
        const int i = s->shaping[k];
        held.lower[i] = lower[i];
        held.upper[i] = lower[i];
    }
    MT_TRY(mt_proof_init(proof, &held, mem, err));
    return mt_proof_use_catalogues(proof, s->c->p, mem, err);
}

mt_status mt_catalogue_search_proof_of(mt_catalogue_search_proofs *s, const double *lower,
                                       const double *upper, mt_proof **out, mt_err *err)
{
    const size_t size = (size_t)s->c->p->n * sizeof *lower;
    const int kept =
        s->n < MT_CATALOGUE_SEARCH_PROOFS_KEPT ? s->n : MT_CATALOGUE_SEARCH_PROOFS_KEPT;
    bool one = true;
    int slot = 0;
    *out = NULL;
    for (int k = 0; k < s->n_shaping; k++) {
        one = one && lower[s->shaping[k]] == upper[s->shaping[k]];
    }
    if (!one) {
        return MT_OK;
    }
    while (slot < kept && !is_of(s, slot, lower)) {
        slot++;
    }
    if (slot == kept) {
        slot = s->n % MT_CATALOGUE_SEARCH_PROOFS_KEPT;
        MT_TRY(make_geometry_proof(s, slot, lower, err));
        s->n++;
    }
    if (s->proof[slot].possible) {
        *out = &s->proof[slot];
        memcpy((*out)->lower, lower, size);
        memcpy((*out)->upper, upper, size);
    }
    return MT_OK;
}

mt_status mt_catalogue_search_look_at(mt_catalogue_search_proofs *s, const double *lower,
                                      const double *upper, const mt_certify_cap *cap,
                                      double boxes, mt_arena *mem,
                                      mt_catalogue_search_look *out, mt_err *err)
{
    mt_proof *proof = NULL;
    mt_certify_search found = {0};
    MT_TRY(mt_catalogue_search_proof_of(s, lower, upper, &proof, err));
    if (proof == NULL) {
        return MT_OK;
    }
    double unit = BOX;
    for (int i = 0; i < proof->question.n_views; i++) {
        const double order = proof->views[i]->n;
        unit += order * order * order;
        proof->views[i]->operations = 0.0;
    }
    proof->spent = NULL; /* noted box by box */
    proof->question.progress = NULL;
    proof->question.any = true;
    proof->question.cap = cap;
    proof->question.max_work = unit * boxes;
    MT_TRY(mt_certify_assignments(&proof->question, 0, NULL, mem, &found, err));
    out->met = found.n_found > 0;
    out->excluded = !out->met && found.proven;
    if (out->met) {
        memcpy(out->x, found.at, (size_t)s->c->p->n * sizeof *out->x);
    }
    double multiplications = 0.0;
    for (int i = 0; i < proof->question.n_views; i++) {
        multiplications += proof->views[i]->operations;
    }
    out->multiplications = (long)multiplications;
    out->work = (long)found.work;
    return MT_OK;
}

void mt_catalogue_search_look_serialize(const mt_subproblem *c, mt_catalogue_search_look *look,
                                        mt_serializer *serializer)
{
    const int n = c->p->n;
    mt_serializer_flag(serializer, &look->excluded);
    mt_serializer_flag(serializer, &look->met);
    mt_serializer_long(serializer, &look->work, 0, LONG_MAX);
    mt_serializer_long(serializer, &look->multiplications, 0, LONG_MAX);
    mt_serializer_numbers(serializer, (size_t)n, look->x);
    serializer->failed = serializer->failed || (look->excluded && look->met);
    for (int i = 0; i < n && look->met; i++) {
        const bool within = look->x[i] >= c->lower[i] && look->x[i] <= c->upper[i];
        serializer->failed = serializer->failed || !within;
    }
    if (serializer->reads &&
        !mt_serializer_is_read(serializer)) { /* as if nothing had been read */
        memset(look->x, 0, (size_t)n * sizeof *look->x);
        *look = (mt_catalogue_search_look){.x = look->x};
    }
}
