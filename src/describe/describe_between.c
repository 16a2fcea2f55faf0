/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Goals that limit a number between the positions of one drive that they name: the worst of
 * the positions that were looked at, and whether all of these keep the limit. */
#include <math.h>

#include "describe/describe.h"
#include "problem/forced_response.h"
#include "problem/goals.h"
#include "search/drive_path_limit.h"

static const double TWO_PI = 6.283185307179586476925;
static const double PERCENT = 100.0;

/* "the acceleration of grip.x for base.z", "the frequency of mode 1". */
static const char *about_text(const mt_requirement *d, mt_arena *mem)
{
    return d->goal->response_limit != NULL
               ? mt_describe_response_limit(d->goal->response_limit, mem)
               : mt_arena_printf(mem, "the %s of mode %d", d->ops->number, d->mode);
}

/* Text of the worst value and its position. */
static const char *worst_text(const mt_study *study, const mt_drive_positions *f,
                              const mt_requirement *d, const mt_result_between *r,
                              mt_arena *mem)
{
    const mt_goal *const g = d->goal;
    const char *const about = about_text(d, mem);
    const mt_unit *const shown = mt_study_shown(study, f->angle ? MT_ANGLE : MT_LENGTH);
    const char *const to = mt_describe_position(study, f, r->to, mem);
    const char *const at = mt_describe_position(study, f, r->at, mem);
    if (about == NULL || to == NULL || at == NULL) {
        return NULL;
    }
    const char *const subject =
        mt_arena_printf(mem, "%s over %s from %.6g to %s (%d positions sampled)", about,
                        r->drive, mt_unit_from_si(shown, r->from), to, r->positions);
    if (subject == NULL || !MT_HAS(r->at)) {
        return subject == NULL ? NULL : mt_arena_printf(mem, "%s has no value", subject);
    }
    if (!MT_HAS(r->value) && g->response_limit == NULL) {
        return mt_arena_printf(mem, "%s is not finite at %s", subject, at);
    }
    if (!MT_HAS(r->value)) {
        return mt_arena_printf(
            mem,
            "%s is unbounded at %s: an undamped motion is excited at its natural frequency",
            subject, at);
    }
    const char *const beside = mt_describe_response_value(g, r->value, mem);
    return beside == NULL ? NULL
                          : mt_arena_printf(mem, "%s is worst at %s%s: %.4g%s%s%s%s", subject,
                                            at, r->named ? ", a named position" : "", r->value,
                                            r->value_unit[0] != '\0' ? " " : "", r->value_unit,
                                            g->response_limit != NULL
                                                ? mt_describe_response_kind(g->response_limit)
                                                : "",
                                            beside);
}

/* Text of the verdict of samples: a limit is missed where one sample misses it; where all keep
 * it, it may still be missed between them. */
static const char *verdict_text(const mt_limit_drive_path *m, const mt_result_between *r)
{
    const bool capped = m->end == MT_MOTION_CAPPED;
    if (!r->holds) {
        return "the limit does not hold over the range";
    }
    return capped ? "all of them keep the limit, as many as the evaluations allow (sampled "
                    "coarsely, not proven)"
                  : "all of them keep the limit (sampled, not proven)";
}

static const char *text_of(const mt_study *study, const mt_drive_positions *f,
                           const mt_requirement *d, const mt_limit_drive_path *m,
                           const mt_result_between *r, mt_arena *mem)
{
    const char *const worst = worst_text(study, f, d, r, mem);
    if (worst == NULL) {
        return NULL;
    }
    if (m->why != NULL) {
        const char *const where = mt_describe_position(study, f, m->broken_at, mem);
        return where == NULL
                   ? NULL
                   : mt_arena_printf(mem, "%s; not known at %s: %s", worst, where, m->why);
    }
    return mt_arena_printf(mem, "%s; %s", worst, verdict_text(m, r));
}

static mt_status describe_limit_between(const mt_workspace *fresh, const mt_requirement *d,
                                        const mt_limit_drive_path *m, mt_arena *mem,
                                        mt_result_between *out, mt_err *err)
{
    const mt_goal *const g = d->goal;
    const mt_drive_positions *const f =
        &fresh->p->families[mt_drive_positions_of(fresh->p, d->view)];
    const bool finite = m->worst.finite;
    *out = (mt_result_between){
        .pointer = mt_arena_printf(mem, "/goals/%d", d->goal_index),
        .drive = f->joint,
        .unit = f->angle ? "rad" : "m",
        .from = m->from,
        .to = m->to,
        .positions = m->positions,
        .at = m->at,
        .named = m->given,
        .value = finite ? m->worst.value : nan(""),
        .value_unit = mt_study_goal_unit(fresh->p->study, g),
        .error = finite ? m->worst.error : nan(""),
        .frequency_hz = finite ? m->worst.omega / TWO_PI : nan(""),
        .end = MT_HAS(m->at) ? m->worst.end_name : "none",
        .violation_percent =
            finite ? PERCENT * mt_describe_off_by(d, m->worst.value, fmax(m->off, 0.0))
                   : nan(""),
        .holds = mt_is_met(m->off, d->tolerance) && m->why == NULL,
        .grade = mt_drive_path_grade(m->end)};
    out->text = text_of(fresh->p->study, f, d, m, out, mem);
    return mt_arena_check(mem, err);
}

/* Warn of a limit that is met at the named positions and missed between them. Limits that are
 * only a scale are left out. */
static mt_status warn(const mt_design *design, const mt_result_between *r, mt_result *result,
                      const mt_recommendation *rec, mt_err *err)
{
    if (design->found == NULL || r->holds || !rec->feasible) {
        return MT_OK;
    }
    return mt_describe_warn(
        result, err, "recommendation %d keeps the limit of %s only at the named positions: %s",
        design->rank, r->pointer, r->text);
}

mt_status mt_describe_between(mt_workspace *fresh, const mt_design *design, mt_result *result,
                              mt_recommendation *rec, mt_err *err)
{
    const mt_problem *const p = fresh->p;
    rec->between =
        mt_arena_alloc(&result->mem, (size_t)p->n_requirements, sizeof *rec->between);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int i = 0; i < p->n_requirements; i++) {
        const mt_requirement *const d = &p->requirements[i];
        mt_limit_drive_path m = {.end = MT_MOTION_NONE};
        MT_TRY(mt_drive_positions_limits_first(p, d)
                   ? mt_drive_path_limit(fresh, d, &fresh->mem, &m, err)
                   : MT_OK);
        if (m.end != MT_MOTION_NONE) {
            mt_result_between *const row = &rec->between[rec->n_between++];
            MT_TRY(describe_limit_between(fresh, d, &m, &result->mem, row, err));
            MT_TRY(d->role == MT_ROLE_LIMIT ? warn(design, row, result, rec, err) : MT_OK);
        }
    }
    return MT_OK;
}

bool mt_describe_keeps_between(const mt_recommendation *rec)
{
    bool kept = true;
    for (int i = 0; i < rec->n_between; i++) {
        kept = kept && rec->between[i].holds;
    }
    return kept;
}
