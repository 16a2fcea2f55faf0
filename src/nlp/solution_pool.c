/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The ends of local searches as a list. Many starts end at few designs, and the approach
 * (local.c) tells them apart already: Newton, most of the cost of a search, need be done
 * once for each. The most stationary end of a neighbourhood stands for it; where Newton did not
 * come to rest from there, the next one has its turn.
 */
#include "nlp/solution_pool.h"

#include <math.h>

#include "nlp/merit.h"

/* Ends are one that are nearer than the root of the tolerance, which a double root smears; that
 * is capped where tolerances are wide. */
static const double SAME_MOST = 1e-2;
/* Polished ends with a KKT residual below this came to rest. */
static const double STATIONARY = 1e-6;
/* An end lower than another by more, relatively, is not the same: more than tolerances buy. */
static const double LOWER = 1e-5;
/* So many ends of a neighbourhood are polished before it is given up. */
enum { TRIES = 2 };

void mt_nlp_solution_pool_grow(mt_nlp_engine *e, mt_nlp_solution_pool *all, int n)
{
    const size_t wanted = (size_t)all->count + (size_t)n;
    mt_nlp_local *const at = mt_arena_alloc(&e->scratch, wanted, sizeof *at);
    for (int i = 0; i < all->count && at != NULL; i++) {
        at[i] = all->at[i];
    }
    all->at = at != NULL ? at : all->at;
}

double mt_nlp_same_distance(const mt_nlp_engine *e)
{
    return fmax(MT_SAME_DESIGN, fmin(sqrt(e->eq_tol), SAME_MOST));
}

bool mt_nlp_seeks_roots(const mt_nlp_engine *e)
{
    return e->nlp->n_eq >= e->n_free && e->n_free > 0;
}

int mt_nlp_roots(mt_nlp_engine *e, const mt_nlp_solution_pool *all, int *once)
{
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    /* a later end is the same */
    int *const twin = mt_arena_int(&e->scratch, (size_t)all->count);
    int roots = 0;
    *once = 0;
    if (!mt_nlp_has_room(e, &e->scratch)) {
        return 0;
    }
    for (int i = 0; i < all->count && mt_nlp_seeks_roots(e); i++) {
        const mt_nlp_point *const p = all->at[i].p;
        if (mt_nlp_feasible(p) && all->at[i].curve) {
            roots = 0;
            *once = 0;
            break;
        }
        if (!mt_nlp_feasible(p) || twin[i] != 0) {
            continue;
        }
        int hits = 1;
        for (int k = i + 1; k < all->count; k++) {
            if (mt_nlp_feasible(all->at[k].p) &&
                mt_nlp_distance(e, p, all->at[k].p) <= mt_nlp_same_distance(e)) {
                twin[k] = 1;
                hits++;
            }
        }
        roots++;
        *once += hits == 1;
    }
    mt_arena_rewind(&e->scratch, mark);
    return roots;
}

/* Largest difference of two designs orthogonal to the directions; d[n] is work. */
static double apart(int n, const double *a, const double *b, const mt_nlp_result *directions,
                    double *d)
{
    for (int j = 0; j < n; j++) {
        d[j] = a[j] - b[j];
    }
    for (int k = 0; k < directions->n_unidentifiable; k++) {
        const double *const u = directions->unidentifiable + (ptrdiff_t)k * n;
        mt_axpy(n, -mt_dot(n, u, d), u, d);
    }
    return mt_max_abs(n, d);
}

/* True where Newton from b, which is not polished, is expected to end at the same point as from
 * a. */
static bool alike(const mt_nlp_engine *e, const mt_nlp_local *a, const mt_nlp_local *b,
                  const mt_nlp_result *directions, double *d)
{
    const mt_nlp_point *const pa = mt_nlp_local_stand(a);
    const mt_nlp_point *const pb = mt_nlp_local_stand(b);
    if (mt_nlp_feasible(pb) &&
        (!mt_nlp_nearly_feasible(pa) || pb->f < pa->f - LOWER * fabs(pa->f))) {
        return false;
    }
    return apart(e->n, a->from, b->from, directions, d) <= MT_SAME_DESIGN ||
           (a->polished && apart(e->n, pa->t, b->from, directions, d) <= MT_SAME_DESIGN);
}

/* Number of feasible ends; *places: number of distinct ones. */
static int count_places(mt_nlp_engine *e, const mt_nlp_solution_pool *all, int *places)
{
    static const mt_nlp_result none = {.n_unidentifiable = 0};
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    double *const d = mt_arena_f64(&e->scratch, (size_t)e->n, 1);
    int n = 0;
    *places = 0;
    if (!mt_nlp_has_room(e, &e->scratch)) {
        return 0;
    }
    for (int i = 0; i < all->count; i++) {
        const bool met = mt_nlp_feasible(mt_nlp_local_stand(&all->at[i]));
        bool known = false;
        for (int k = 0; k < i && met && !known; k++) {
            known = alike(e, &all->at[k], &all->at[i], &none, d) &&
                    alike(e, &all->at[i], &all->at[k], &none, d);
        }
        n += met ? 1 : 0;
        *places += met && !known ? 1 : 0;
    }
    mt_arena_rewind(&e->scratch, mark);
    return n;
}

bool mt_nlp_solution_pool_settled(mt_nlp_engine *e, const mt_nlp_solution_pool *all)
{
    int w = 0;
    const int n = count_places(e, all, &w);
    return w > 0 && n > w + 2 && 2.0 * w * (n - 1) < ((2.0 * w) + 1.0) * (n - w - 2);
}

bool mt_nlp_solution_pool_agree(mt_nlp_engine *e, const mt_nlp_solution_pool *all)
{
    int places = 0;
    return count_places(e, all, &places) == all->starts && places == 1;
}

bool mt_nlp_came_to_rest(const mt_nlp_local *s)
{
    return s->polished && s->p->kkt <= STATIONARY;
}

/* True where the end is at one that converged, or where Newton failed repeatedly: it does not
 * count as another end. */
static bool is_known_end(const mt_nlp_engine *e, mt_nlp_solution_pool *all, mt_nlp_local *one,
                         const mt_nlp_result *directions, double *d)
{
    int tries = 0;
    for (int k = 0; k < all->count && !one->polished; k++) {
        mt_nlp_local *const known = &all->at[k];
        if (known->polished && alike(e, known, one, directions, d)) {
            tries++;
            if (mt_nlp_came_to_rest(known) || tries == TRIES) {
                known->hits += one->hits;
                known->start = one->start < known->start ? one->start : known->start;
                return true;
            }
        }
    }
    return false;
}

int mt_nlp_solution_pool_choose(mt_nlp_engine *e, mt_nlp_solution_pool *all,
                                const mt_nlp_result *directions, mt_nlp_local **chosen)
{
    double *const d = mt_arena_f64(&e->scratch, (size_t)e->n, 1);
    int left = 0;
    int n = 0;
    if (!mt_nlp_has_room(e, &e->scratch)) {
        return 0;
    }
    for (int i = 0; i < all->count; i++) {
        all->at[i].hits =
            is_known_end(e, all, &all->at[i], directions, d) ? 0 : all->at[i].hits;
    }
    for (int i = 0; i < all->count; i++) {
        if (all->at[i].hits > 0) {
            all->at[left++] = all->at[i];
        }
    }
    all->count = left;
    for (int i = 0; i < all->count; i++) { /* by insertion, the most stationary first */
        mt_nlp_local *const one = &all->at[i];
        int at = one->polished ? -1 : n++;
        for (; at > 0 && one->kkt < chosen[at - 1]->kkt; at--) {
            chosen[at] = chosen[at - 1];
        }
        if (at >= 0) {
            chosen[at] = one;
        }
    }
    int kept = 0;
    for (int i = 0; i < n; i++) {
        bool near = false;
        for (int k = 0; k < kept && !near; k++) {
            near = alike(e, chosen[k], chosen[i], directions, d);
        }
        if (!near) {
            chosen[kept++] = chosen[i];
        }
    }
    return kept;
}
