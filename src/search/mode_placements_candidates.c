/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Which gap assignments are worth a search, first and in all. Where the modes can be
 * enclosed (proof.h), branch and bound over the bounds finds every assignment that some
 * design has, with such a design, and proves that there is no other. Elsewhere, sampled:
 * designs spread over the bounds; each says how many modes lie below the middle of each
 * band, and its assignment becomes a candidate. A design clear of all bands has the same
 * assignment as the samples around it, so a kind of design is only missed where it is
 * smaller than the samples are apart. That is labelled as sampled. What stands in the way of
 * an enclosure may be held at samples, each proven in the other variables (sampled_bounds.h).
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/run.h"
#include "nlp/merit.h"
#include "nlp/starts.h"
#include "problem/avoidance.h"
#include "problem/configuration.h"
#include "problem/drive_positions.h"
#include "problem/evaluate.h"
#include "search/mode_placements.h"
#include "search/proof.h"
#include "search/sampled_bounds.h"

enum {
    SAMPLES_PER_VARIABLE = 256,
    SAMPLES_MOST = 4096,
    /* after a part of them, when each assignment that was met has been met so often: one that
     * was not is much rarer than the rarest that was */
    SAMPLES_PART = 5,
    MET_OFTEN = 8,
    CANDIDATES_MOST = 256,
    SAMPLES_FIRST = 32,
    EVALUATIONS_LEAST = 30 /* of a candidate's search, or it is not worth one */
};
/* Of a proof before the first search: tens of milliseconds. Most are settled by then, and what
 * is hopeless is told at once. A quarter of it, where candidates come best first. */
static const double FIRST_WORK = 2e8;
static const double BEST_FIRST_WORK = 5e7;
/* Of a smaller budget, so that the proof after it has more. */
static const double FIRST_SHARE = 0.04;
/* The rest of it is spent later, where no more than this share of the designs is undecided. */
static const double NEARLY_SETTLED = 0.5;

/* Of what a proof has a design for: less than of any sample. */
static const double KNOWN = -HUGE_VAL;

typedef struct sampled {
    int *below;
    double violation;
    int met;          /* so many samples have it */
    const double *at; /* [n] a design of a slice; NULL */
} sampled;

static int compare_below(const int *a, const int *b, int n)
{
    for (int i = 0; i < n; i++) {
        if (a[i] != b[i]) {
            return a[i] < b[i] ? -1 : 1;
        }
    }
    return 0;
}

mt_status mt_mode_placement_assignment(mt_workspace *w, const double *t, int *below,
                                       double *violation, mt_err *err)
{
    mt_subproblem_x(w->c, t, w->x);
    *violation = 0.0;
    for (int i = 0; i < w->c->n_avoidances; i++) {
        const mt_avoidance *const c = &w->c->avoidances[i];
        mt_analysis *const a = w->views[c->view].analysis;
        mt_analysis_options opt = {.accuracy = 0.0};
        mt_err own = {0};
        mt_avoidances_query(&w->p->whole, c->view, &opt.shapes);
        const mt_status rc = mt_analysis_solve(a, w->x, &opt, &own);
        if (rc != MT_OK) {
            *violation = nan("");
            return mt_pass_final(rc, &own, err);
        }
        const double v = mt_short_of(mt_avoidance_find_modes(c, &a->modes, below + c->first));
        *violation = !(v <= *violation) ? v : *violation;
    }
    return MT_OK;
}

/* Insert into the sorted list, keeping the least violation of equal ones. at: a design t[n] to
 * start from, which stays; NULL: none. */
static void insert(const mt_problem *p, sampled *list, int *n, const int *below,
                   double violation, const double *at_t)
{
    int at = 0;
    while (at < *n && compare_below(list[at].below, below, p->n_bands) < 0) {
        at++;
    }
    if (at < *n && compare_below(list[at].below, below, p->n_bands) == 0) {
        list[at].violation = fmin(list[at].violation, violation);
        list[at].met++;
        return;
    }
    int victim = *n; /* where the list is full, the least promising makes room */
    if (*n == CANDIDATES_MOST) {
        victim = 0;
        for (int i = 1; i < *n; i++) {
            victim = list[i].violation > list[victim].violation ? i : victim;
        }
        if (list[victim].violation <= violation) {
            return;
        }
    } else {
        (*n)++;
    }
    const sampled fresh = {list[victim].below, violation, 1, at_t};
    if (victim < at) {
        at--;
        memmove(&list[victim], &list[victim + 1], (size_t)(at - victim) * sizeof *list);
    } else {
        memmove(&list[at + 1], &list[at], (size_t)(victim - at) * sizeof *list);
    }
    list[at] = fresh;
    memcpy(list[at].below, below, (size_t)p->n_bands * sizeof *below);
}

/* True where avoidance goal i is tied to an earlier one. */
static bool tied_before(const mt_problem *p, int i)
{
    for (int b = 0; b < p->avoidances[i].bands.n; b++) {
        if (p->tie[p->avoidances[i].first + b] < p->avoidances[i].first) {
            return true;
        }
    }
    return false;
}

/* Bands of avoidance goal i and of those tied to it, each set of tied bands once. */
static int count_ties(const mt_problem *p, int i)
{
    const int drive_positions = mt_drive_positions_of(p, p->avoidances[i].view);
    int m = 0;
    for (int c = i; c < p->n_avoidances; c++) {
        const bool own =
            c == i || (drive_positions >= 0 && tied_before(p, c) &&
                       mt_drive_positions_of(p, p->avoidances[c].view) == drive_positions);
        for (int b = 0; own && b < p->avoidances[c].bands.n; b++) {
            const int band = p->avoidances[c].first + b;
            m += p->tie[band] == band ? 1 : 0;
        }
    }
    return m;
}

double mt_mode_placement_count_possible(const mt_problem *p)
{
    double all = 1.0;
    for (int i = 0; i < p->n_avoidances; i++) {
        const int n = mt_configuration_vibrations(&p->views[p->avoidances[i].view]);
        const int m = tied_before(p, i) ? 0 : count_ties(p, i);
        for (int k = 1; k <= m; k++) {
            all *= (double)(n + k) / (double)k;
        }
    }
    return round(all);
}

/* Keeps the `most` placements of least violation, in order; the others are not needed again. */
static int keep_nearest(const sampled *list, int n, int most, bool *kept)
{
    int count = 0;
    for (int i = 0; i < n; i++) {
        int ahead = 0;
        for (int k = 0; k < n; k++) {
            const bool less = list[k].violation < list[i].violation;
            ahead += less || (k < i && list[k].violation == list[i].violation) ? 1 : 0;
        }
        kept[i] = ahead < most;
        count += kept[i] ? 1 : 0;
    }
    return count;
}

/* A sample whose counts differ between two positions of one drive is no placement; the
 * neighbouring placements have the least and the greatest of these counts throughout. */
static void insert_agreeing(const mt_workspace *w, sampled *list, int *n, const int *below,
                            double violation, int *work)
{
    const mt_problem *const p = w->p;
    const size_t size = (size_t)p->n_bands * sizeof *below;
    if (mt_ties_agree(p, below)) {
        insert(p, list, n, below, violation, NULL);
        return;
    }
    for (int most = 0; most < 2; most++) {
        memcpy(work, below, size);
        mt_ties_settle(p, most == 1, work);
        insert(p, list, n, work, mt_ties_violation(w, work), NULL);
    }
}

static int least_of(int a, long b)
{
    return b < a ? (int)b : a;
}

/* Rows of the placements kept, and the starts of their searches. */
static mt_status keep_placements(const mt_problem *p, const sampled *list, const bool *kept,
                                 mt_arena *mem, mt_mode_placement_candidates *out, mt_err *err)
{
    const size_t row = (size_t)p->n_bands;
    const size_t n = (size_t)p->n;
    out->below = mt_arena_int(mem, (size_t)out->n * row);
    out->at = mt_arena_f64(mem, n, (size_t)out->n);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0, k = 0; k < out->n; i++) {
        if (!kept[i]) {
            continue;
        }
        memcpy(out->below + ((size_t)k * row), list[i].below, row * sizeof *out->below);
        for (size_t j = 0; j < n; j++) {
            out->at[((size_t)k * n) + j] = list[i].at == NULL ? nan("") : list[i].at[j];
        }
        k++;
    }
    return MT_OK;
}

/* True where every placement met, except those of sampled geometries, was met often. */
static bool all_met_often(const sampled *list, int n)
{
    bool often = n > 0;
    for (int i = 0; i < n; i++) {
        often = often && (list[i].met >= MET_OFTEN || list[i].violation == KNOWN);
    }
    return often;
}

/* Placements of n designs spread over the bounds, and those of sampled geometries, at most
 * `most`. Under a budget of evaluations half of it is for samples and half for the searches of
 * the nearest. */
static mt_status sample_placements(mt_workspace *w, int n, int most, long spent,
                                   const mt_sampled_bounds *sampled_bounds, mt_arena *mem,
                                   mt_mode_placement_candidates *out, mt_err *err)
{
    const mt_problem *const p = w->p;
    const long most_evals = w->c->search.max_evaluations;
    const long left = (most_evals - spent) / 2;
    const long half = most_evals <= 0 ? 0 : left > 1 ? left : 1;
    mt_nlp nlp = mt_workspace_nlp(w);
    nlp.n = p->n;
    n = half > 0 ? least_of(n, half) : n;
    most = half > 0 ? least_of(most, 1 + (half / EVALUATIONS_LEAST)) : most;
    sampled *const list = mt_arena_alloc(mem, CANDIDATES_MOST, sizeof *list);
    int *const below = mt_arena_int(mem, (size_t)p->n_bands);
    int *const work = mt_arena_int(mem, (size_t)p->n_bands);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < CANDIDATES_MOST; i++) {
        list[i].below = mt_arena_int(mem, (size_t)p->n_bands);
        MT_TRY(mt_arena_check(mem, err));
    }
    for (int k = 0; k < sampled_bounds->n_found; k++) {
        insert(p, list, &out->n, sampled_bounds->found + ((ptrdiff_t)k * p->n_bands), KNOWN,
               sampled_bounds->at + ((ptrdiff_t)k * p->n));
    }
    const double *const t = mt_nlp_starts(&nlp, w->c->search.seed, n, mem);
    mt_status rc = mt_arena_check(mem, err);
    bool enough = false; /* nothing comes nearer than a design that is clear */
    for (int k = 0; rc == MT_OK && k < n && !enough; k++) {
        double violation = 0.0;
        if (mt_interrupted(p->run->interrupt)) {
            break;
        }
        rc = mt_mode_placement_assignment(w, t + ((ptrdiff_t)k * p->n), below, &violation, err);
        if (rc == MT_OK && MT_HAS(violation)) {
            insert_agreeing(w, list, &out->n, below, violation, work);
            enough = most == 1 && violation <= 0.0 && mt_ties_agree(p, below);
        }
        enough = enough || (k + 1 >= n / SAMPLES_PART && k + 1 >= SAMPLES_PER_VARIABLE &&
                            all_met_often(list, out->n));
        out->evals++;
        mt_work_counters_note(p->run->work, MT_WORK_DESIGNS, 1);
        mt_problem_note_modal(p, w->c->n_avoidances);
    }
    MT_TRY(rc);
    bool kept[CANDIDATES_MOST] = {false};
    const int n_found = out->n;
    out->n = keep_nearest(list, n_found, most, kept);
    return keep_placements(p, list, kept, mem, out, err);
}

/* Placements that branch and bound found feasible, each with a design, and those left open when
 * its budget ended. */
static mt_status keep_proven(const mt_problem *p, const mt_certify_search *found, mt_arena *mem,
                             mt_mode_placement_candidates *out, mt_err *err)
{
    const size_t row = (size_t)p->n_bands;
    const int n = found->n_found + found->n_open;
    out->below = mt_arena_int(mem, (size_t)n * row);
    out->at = mt_arena_f64(mem, (size_t)p->n, (size_t)n);
    MT_TRY(mt_arena_check(mem, err));
    if (found->n_found > 0) {
        memcpy(out->below, found->found, (size_t)found->n_found * row * sizeof *out->below);
    }
    if (found->n_open > 0) {
        memcpy(out->below + ((ptrdiff_t)found->n_found * p->n_bands), found->open,
               (size_t)found->n_open * row * sizeof *out->below);
    }
    for (int k = 0; k < n; k++) {
        for (int i = 0; i < p->n; i++) {
            const double x =
                k < found->n_found ? found->at[i + ((ptrdiff_t)k * p->n)] : p->original[i];
            out->at[i + ((ptrdiff_t)k * p->n)] = mt_problem_t(p, i, x);
        }
    }
    out->n = n;
    out->n_proven = found->n_found;
    out->proven = found->proven;
    out->boxes = found->boxes;
    out->undecided = found->undecided;
    out->all = !found->more && !found->stopped;
    out->reason =
        found->proven
            ? NULL
            : mt_arena_printf(mem,
                              "the budget of the proof ended after %ld boxes, with %.3g %% "
                              "of the designs within the bounds undecided",
                              found->boxes, 100.0 * found->undecided);
    return mt_arena_check(mem, err);
}

/* Result of the proof with this much work. */
static mt_status prove(const mt_workspace *w, mt_proof *proof, double work, mt_arena *mem,
                       mt_mode_placement_candidates *out, mt_err *err)
{
    mt_certify_search found = {0};
    MT_TRY(mt_proof_query(proof, work, mem, &found, err));
    return keep_proven(w->p, &found, mem, out, err);
}

static const mt_sampled_bounds no_sampled_bounds = {.n = 0};

mt_status mt_mode_placement_candidates_first(mt_workspace *w, mt_proof *proof, bool best_first,
                                             mt_arena *mem, mt_mode_placement_candidates *all,
                                             mt_mode_placement_candidates *first, mt_err *err)
{
    *all = (mt_mode_placement_candidates){.possible = mt_mode_placement_count_possible(w->p)};
    *first = (mt_mode_placement_candidates){.possible = all->possible};
    if (proof->possible) {
        const double first_work = best_first ? BEST_FIRST_WORK : FIRST_WORK;
        const double most = fmin(first_work, FIRST_SHARE * w->c->proof_work);
        MT_TRY(prove(w, proof, most, mem, all, err));
    }
    if (all->proven) {
        return MT_OK;
    }
    *first = *all;
    first->n = all->n_proven;
    return first->n > 0
               ? MT_OK
               : sample_placements(w, SAMPLES_FIRST, 1, 0, &no_sampled_bounds, mem, first, err);
}

mt_status mt_mode_placement_candidates_settle(mt_workspace *w, mt_proof *proof, mt_arena *mem,
                                              mt_mode_placement_candidates *all, mt_err *err)
{
    return all->undecided <= NEARLY_SETTLED
               ? prove(w, proof, FIRST_WORK - BEST_FIRST_WORK, mem, all, err)
               : MT_OK;
}

void mt_mode_placement_candidates_start(const mt_mode_placement_candidates *met,
                                        const mt_problem *p, mt_mode_placement_candidates *c)
{
    for (int k = 0; k < met->n && met->at != NULL; k++) {
        const int *const own = met->below + ((ptrdiff_t)k * p->n_bands);
        const int at = mt_certify_index_of(c->below, c->n, own, p->n_bands);
        if (at < c->n) {
            memcpy(c->at + ((ptrdiff_t)at * p->n), met->at + ((ptrdiff_t)k * p->n),
                   (size_t)p->n * sizeof *c->at);
        }
    }
}

mt_status mt_mode_placement_candidates_find(mt_workspace *w, mt_proof *proof, long spent,
                                            mt_arena *mem, mt_mode_placement_candidates *out,
                                            mt_err *err)
{
    *out = (mt_mode_placement_candidates){.possible = mt_mode_placement_count_possible(w->p)};
    if (proof->possible) {
        MT_TRY(prove(w, proof, w->c->proof_work, mem, out, err)); /* all that is left */
    }
    if (proof->possible && (out->proven || out->n > 0)) {
        return MT_OK;
    }
    const int wanted = SAMPLES_PER_VARIABLE * (w->p->n + 1);
    mt_sampled_bounds sampled_bounds = no_sampled_bounds;
    MT_TRY(proof->possible ? MT_OK : mt_sampled_bounds_search(w, mem, &sampled_bounds, err));
    out->reason =
        sampled_bounds.n == 0
            ? mt_arena_strdup(mem, proof->reason)
            : mt_arena_printf(mem,
                              "%s; at %d of %d samples of the geometry, held fixed, "
                              "all other placements are proven infeasible",
                              proof->reason, sampled_bounds.n_settled, sampled_bounds.n);
    return sample_placements(w, wanted < SAMPLES_MOST ? wanted : SAMPLES_MOST, CANDIDATES_MOST,
                             spent, &sampled_bounds, mem, out, err);
}

mt_status mt_mode_placement_candidates_near(mt_workspace *w, int most, long spent,
                                            mt_arena *mem, mt_mode_placement_candidates *out,
                                            mt_err *err)
{
    *out = (mt_mode_placement_candidates){.possible = mt_mode_placement_count_possible(w->p)};
    return sample_placements(w, MT_GAP_SAMPLES_NEAR, most, spent, &no_sampled_bounds, mem, out,
                             err);
}
