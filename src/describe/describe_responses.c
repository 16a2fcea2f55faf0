/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What goals of forced vibration find at a design: how large, where, and how that is known. */
#include <math.h>
#include <string.h>

#include "describe/describe.h"
#include "problem/configuration.h"
#include "problem/forced_response.h"
#include "problem/goals.h"

static const double TWO_PI = 6.283185307179586476925;
static const double PERCENT = 100.0;

static const char RELATIVE[] = "relative_";
static const char BASE[] = "base.";

/* "the acceleration of grip.x", "the force of spring.mount". */
static const char *output_text(const char *port, mt_arena *mem)
{
    static const char *const forces[] = {"spring.", "damper.", "joint."};
    const char *const colon = strchr(port, ':');
    const int length = (int)strcspn(port, ":");
    for (int k = 0; k < MT_COUNT(forces); k++) {
        if (strncmp(port, forces[k], strlen(forces[k])) == 0) {
            return mt_arena_printf(mem, "the force of %s", port);
        }
    }
    if (colon == NULL) {
        return mt_arena_printf(mem, "the displacement of %s", port);
    }
    const bool relative = strncmp(colon + 1, RELATIVE, strlen(RELATIVE)) == 0;
    return mt_arena_printf(mem, "the %s of %.*s%s",
                           colon + 1 + (relative ? strlen(RELATIVE) : 0), length, port,
                           relative ? " as seen from the ground" : "");
}

const char *mt_describe_response_value(const mt_goal *g, double value, mt_arena *mem)
{
    const bool both = MT_HAS(g->at_most) && MT_HAS(g->at_least);
    const bool lower = both && log(g->at_least / value) > log(value / g->at_most);
    const double limit = lower                 ? g->at_least
                         : MT_HAS(g->at_most)  ? g->at_most
                         : MT_HAS(g->at_least) ? g->at_least
                                               : g->equals;
    const double off = PERCENT * (value / limit - 1.0);
    const char *const what = MT_HAS(g->at_most) || MT_HAS(g->at_least) ? "limit" : "target";
    if (fabs(off) <= MT_DEFAULT_TOLERANCE_PERCENT) {
        return mt_arena_printf(mem, ", at its %s", what);
    }
    return mt_arena_printf(mem, ", %.3g %% %s its %s", fabs(off), off > 0.0 ? "above" : "below",
                           what);
}

const char *mt_describe_response_kind(const mt_response_limit *s)
{
    static const char *const kinds[MT_RESPONSE_LIMIT_QUANTITIES] = {"", " rms", " of its tones",
                                                                    " at peak"};
    return kinds[s->quantity];
}

/* ", largest at 17.2 Hz (proven over 5 to 500 Hz)". */
static const char *where_text(const mt_response_limit *s, const mt_result_response *r,
                              mt_arena *mem)
{
    const bool single = r->lower_hz == r->upper_hz;
    if (single || !MT_HAS(r->frequency_hz)) {
        return "";
    }
    return mt_arena_printf(
        mem, "%s at %.4g Hz%s (%s over %.4g to %.4g Hz)",
        s->quantity == MT_RESPONSE_LIMIT_RESPONSE ? "," : ", the response being largest",
        r->frequency_hz, r->at_edge ? ", an end of its range" : "", r->grade, r->lower_hz,
        r->upper_hz);
}

const char *mt_describe_response_limit(const mt_response_limit *s, mt_arena *mem)
{
    const char *const what = output_text(s->output.s, mem);
    const char *const by = s->profile == NULL ? s->input.s : s->profile_name.s;
    const bool force = strncmp(by, BASE, strlen(BASE)) != 0;
    return what == NULL ? NULL
                        : mt_arena_printf(mem, "%s %s%s", what,
                                          s->profile != NULL ? "under "
                                          : force            ? "under a force at "
                                                             : "for ",
                                          by);
}

static const char *text_of(const mt_goal *g, const mt_result_response *r, mt_arena *mem)
{
    const mt_response_limit *const s = g->response_limit;
    const char *const about = mt_describe_response_limit(s, mem);
    const char *const subject =
        about == NULL ? NULL : mt_arena_printf(mem, "%s in \"%s\"", about, r->configuration);
    if (subject == NULL) {
        return NULL;
    }
    if (!MT_HAS(r->value)) {
        return strcmp(r->end, "infinite") == 0
                   ? mt_arena_printf(mem,
                                     "%s is unbounded: an undamped motion is excited at its "
                                     "natural frequency",
                                     subject)
                   : mt_arena_printf(mem, "%s has no value", subject);
    }
    const char *const beside = mt_describe_response_value(g, r->value, mem);
    const char *const where = where_text(s, r, mem);
    return beside == NULL || where == NULL
               ? NULL
               : mt_arena_printf(mem, "%s is %.4g%s%s%s%s%s", subject, r->value,
                                 r->unit[0] != '\0' ? " " : "", r->unit,
                                 mt_describe_response_kind(s), beside, where);
}

/* Fill a response. A failure leaves it without a value: the text of the goal has the reason. */
static mt_status describe_response(mt_workspace *fresh, const mt_requirement *d, mt_arena *mem,
                                   mt_result_response *out, mt_err *err)
{
    const mt_goal *const g = d->goal;
    mt_forced_response_value v = {.finite = false};
    mt_err own = {.code = MT_OK};
    const mt_status rc = mt_forced_response_find_peak(fresh, d, &v, &own);
    MT_TRY(mt_pass_final(rc, &own, err));
    const bool has = rc == MT_OK && v.finite;
    *out = (mt_result_response){
        .pointer = mt_arena_printf(mem, "/goals/%d", d->goal_index),
        .configuration = mt_configuration_name(fresh->p, &fresh->p->views[d->view]),
        .input = g->response_limit->input.s,
        .output = g->response_limit->output.s,
        .profile = g->response_limit->profile_name.s,
        .quantity = mt_response_limit_names[g->response_limit->quantity],
        .unit = mt_study_goal_unit(fresh->p->study, g),
        .value = has ? v.value : nan(""),
        .error = has ? v.error : nan(""),
        .frequency_hz = has ? v.omega / TWO_PI : nan(""),
        .at_edge = has && v.at_edge,
        .lower_hz = v.lower_hz,
        .upper_hz = v.upper_hz,
        .end = rc == MT_OK ? v.end_name : "none",
        .grade = v.proven ? "proven" : "sampled"};
    out->text = text_of(g, out, mem);
    return mt_arena_check(mem, err);
}

mt_status mt_describe_responses(mt_workspace *fresh, mt_result *result, mt_recommendation *rec,
                                mt_err *err)
{
    const mt_problem *const p = fresh->p;
    rec->responses =
        mt_arena_alloc(&result->mem, (size_t)p->n_requirements, sizeof *rec->responses);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int i = 0; i < p->n_requirements; i++) {
        if (p->requirements[i].ops->look != NULL) {
            MT_TRY(describe_response(fresh, &p->requirements[i], &result->mem,
                                     &rec->responses[rec->n_responses++], err));
        }
    }
    return MT_OK;
}
