/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What is proven of one design: an inertia count at its own matrices confirms that every band
 * is empty (no eigenvalue is involved), and, where the modes can be enclosed, the tolerance box
 * says how far its variables may stray with the bands, without their margin, and the frequency
 * limits still kept.
 */
#include "describe/describe.h"
#include "problem/configuration.h"
#include "problem/requirement.h"
#include "problem/tolerance.h"
#include "prove/band_count.h"
#include "prove/certify.h"
#include "prove/tolerance.h"
#include "search/proof.h"

/* Tolerances beyond this are not asked about. */
static const double MOST_PERCENT = 100.0;
/* Sub-boxes of one test where an input enters both matrices: fewer for many variables, whose
 * boxes cost more and gain less. */
enum { BOXES_FEW_VARIABLES = 64, BOXES_MANY_VARIABLES = 8, FEW_VARIABLES = 8 };

/* Confirm every band of an avoid goal by inertia, at the last solved design of its analysis. */
static mt_status confirm_here(mt_workspace *fresh, const mt_avoidance *c, mt_result *result,
                              bool *confirmed, mt_err *err)
{
    const mt_analysis *const a = fresh->views[c->view].analysis;
    for (int b = 0; b < c->bands.n; b++) {
        const mt_band *const band = &c->bands.items[b];
        mt_band_count count = {0};
        MT_TRY(mt_certify_count(a->lin, a->modes.n_rigid, band->lower_hz, band->upper_hz,
                                c->tolerance, &fresh->mem, &count, err));
        *confirmed = *confirmed && count.sure && count.inside == 0;
        if (count.inside != 0) {
            MT_TRY(mt_describe_warn(result, err,
                                    "%s: an inertia count finds %d mode%s inside the band %s "
                                    "of a recommended design",
                                    mt_analysis_configuration(a), count.inside,
                                    count.inside == 1 ? "" : "s", band->label));
        }
    }
    return MT_OK;
}

/* At the two corners of the tolerances between which all modes stay: the same counts there are
 * those of every design between. */
static mt_status confirm_corners(mt_workspace *fresh, const mt_avoidance *c, mt_result *result,
                                 bool *confirmed, mt_err *err)
{
    mt_analysis *const a = fresh->views[c->view].analysis;
    const mt_analysis_options opt = mt_analysis_options_default();
    const mt_tolerance_range *const range = mt_ranges_hz(mt_tolerance_known(fresh), c->view, 1);
    *confirmed = *confirmed && range != NULL && mt_ranges_proven(mt_tolerance_known(fresh));
    for (int side = 0; side < MT_TOLERANCE_SIDES && *confirmed; side++) {
        MT_TRY(mt_analysis_solve(a, range->at[side], &opt, err));
        MT_TRY(confirm_here(fresh, c, result, confirmed, err));
    }
    return mt_analysis_solve(a, fresh->x, &opt, err);
}

/* Confirm every band of every avoid goal. */
static mt_status confirm(mt_workspace *fresh, mt_result *result, bool *confirmed, mt_err *err)
{
    *confirmed = fresh->c->n_bands > 0;
    for (int i = 0; i < fresh->c->n_avoidances; i++) {
        const mt_avoidance *const c = &fresh->c->avoidances[i];
        MT_TRY(confirm_here(fresh, c, result, confirmed, err));
        if (fresh->c->tolerance_box != NULL) {
            MT_TRY(confirm_corners(fresh, c, result, confirmed, err));
        }
    }
    return MT_OK;
}

static mt_status edge_text(const mt_problem *p, const mt_recommendation *rec,
                           const mt_tolerance *t, mt_arena *mem, const char **text, mt_err *err)
{
    *text = t->end == MT_TOLERANCE_DOMAIN ? "a stiffness or a mass would no longer be positive"
            : t->end == MT_TOLERANCE_BUDGET ? "the budget of the proof ended"
                                            : NULL;
    if (t->end != MT_TOLERANCE_EDGE) {
        return MT_OK;
    }
    const mt_certify_edge *const e = &t->edge;
    const char *const configuration = mt_configuration_name(p, &p->views[e->view]);
    *text = e->band >= 0
                ? mt_arena_printf(mem, "mode %d of \"%s\" at the %s edge of %s, %.6g Hz",
                                  e->mode, configuration, e->above ? "upper" : "lower",
                                  rec->placements[e->band].band, e->hz)
                : mt_arena_printf(mem, "mode %d of \"%s\" at its limit of %.6g Hz", e->mode,
                                  configuration, e->hz);
    return mt_arena_check(mem, err);
}

static mt_status fill_box(mt_workspace *fresh, mt_proof *proof, const mt_recommendation *rec,
                          mt_result *result, mt_tolerance_box *box, mt_err *err)
{
    mt_certify q = proof->question;
    mt_tolerance all = {0};
    mt_tolerance *const each = mt_arena_alloc(&fresh->mem, (size_t)fresh->p->n, sizeof *each);
    int *const assignment = mt_arena_int(&fresh->mem, (size_t)fresh->c->n_bands);
    box->variables = mt_arena_alloc(&result->mem, (size_t)fresh->p->n, sizeof *box->variables);
    MT_TRY(mt_arena_check(&fresh->mem, err));
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int i = 0; i < fresh->c->n_bands; i++) {
        assignment[i] = rec->placements[i].modes_below;
    }
    q.bands = proof->bases;
    const mt_tolerance_question question = {.x = fresh->x,
                                            .assignment = assignment,
                                            .most_percent = MOST_PERCENT,
                                            .boxes_per_test = fresh->p->n <= FEW_VARIABLES
                                                                  ? BOXES_FEW_VARIABLES
                                                                  : BOXES_MANY_VARIABLES};
    MT_TRY(mt_certify_tolerance(&q, &question, &fresh->mem, &all, each, err));
    box->proven = true;
    box->all_percent = all.percent;
    MT_TRY(edge_text(fresh->p, rec, &all, &result->mem, &box->edge, err));
    box->n_variables = fresh->p->n;
    for (int i = 0; i < fresh->p->n; i++) {
        mt_result_tolerance *const own = &box->variables[i];
        *own =
            (mt_result_tolerance){.name = rec->parameters[i].name, .percent = each[i].percent};
        MT_TRY(edge_text(fresh->p, rec, &each[i], &result->mem, &own->edge, err));
    }
    return MT_OK;
}

/* True where a tolerance box makes sense: there are bands or limits; exact targets have
 * none. */
static bool worth_a_box(const mt_problem *p)
{
    bool limits = false;
    for (int i = 0; i < p->n_requirements; i++) {
        const mt_requirement *const d = &p->requirements[i];
        limits = limits || (mt_requirement_is_frequency(d) && d->role == MT_ROLE_LIMIT);
    }
    return p->n > 0 && p->whole.rows.eq.n == 0 && (p->n_bands > 0 || limits);
}

mt_status mt_describe_tolerance(mt_workspace *fresh, mt_result *result, mt_recommendation *rec,
                                mt_err *err)
{
    mt_proof proof;
    bool confirmed = false;
    if (!rec->feasible) {
        return MT_OK;
    }
    MT_TRY(confirm(fresh, result, &confirmed, err));
    /* between the positions of a drive there are samples and no proof */
    const bool sampled = rec->n_motions + rec->n_between > 0;
    rec->grade = confirmed && !sampled ? "feasible and proven" : rec->grade;
    if (!worth_a_box(fresh->p) || rec->n_placements != fresh->c->n_bands) {
        return MT_OK;
    }
    mt_status rc = mt_proof_init(&proof, fresh->c, &fresh->mem, err);
    if (rc == MT_OK && proof.possible) {
        mt_tolerance_box *const box = mt_arena_alloc(&result->mem, 1, sizeof *box);
        rc = mt_arena_check(&result->mem, err);
        if (rc == MT_OK) {
            *box = mt_tolerance_box_default();
            rc = fill_box(fresh, &proof, rec, result, box, err);
            rec->tolerance_box = box;
        }
    }
    mt_proof_free(&proof);
    return rc;
}
