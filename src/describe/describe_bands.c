/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bands in results: every avoid goal judged, the kind of the design, and how far each mode
 * stays from its neighbouring bands. */
#include <math.h>
#include <string.h>

#include "base/number.h"
#include "describe/describe.h"
#include "problem/avoidance.h"
#include "problem/configuration.h"
#include "problem/frequency.h"
#include "problem/tolerance.h"

static const double PERCENT = 100.0;

/* Nearer to an edge than this, in percent of it, is on it: frequencies carry relative rounding
 * of about 1e-14. */
static const double ON_EDGE_PERCENT = 1e-9;

/* Distances to both ends of a band with its margin, in percent of the edges without it. */
static double way_down(const mt_band *band, double hz)
{
    return band->lower_hz > 0.0 ? PERCENT * (hz - band->lower_hz) / band->base_lower_hz
                                : HUGE_VAL;
}

static double way_up(const mt_band *band, double hz)
{
    return PERCENT * (band->upper_hz - hz) / band->base_upper_hz;
}

/* The clearance of a mode at hz from one edge without margin; negative where that is crossed.
 */
static double beyond(const mt_band *band, bool lower, double hz)
{
    return mt_edge_clearance_percent(lower ? band->base_lower_hz : band->base_upper_hz, lower,
                                     hz);
}

/* The margin of an edge as a clearance: 10 % at the lower edge are 11.1 %. */
static double margin(const mt_band *band, bool lower)
{
    return beyond(band, lower, lower ? band->lower_hz : band->upper_hz);
}

/* True where the lower edge decides for a mode at hz: the nearer one; where a band is cut off
 * to a point, the one that needs the smaller move. */
static bool by_lower_edge(const mt_band *band, double hz)
{
    if (!(band->base_lower_hz > 0.0)) {
        return false;
    }
    const double below = beyond(band, true, hz);
    const double above = beyond(band, false, hz);
    return fabs(below - above) > ON_EDGE_PERCENT ? below >= above
                                                 : way_down(band, hz) <= way_up(band, hz);
}

/* The shortest distance of a mode at hz from the outside of the band with its margin, in
 * percent; 0 outside. */
static double missing_percent(const mt_band *band, double hz)
{
    return fmax(fmin(way_down(band, hz), way_up(band, hz)), 0.0);
}

/* As mt_band_clearance_percent, without rounding on the edges. */
static double clearance(const mt_band *band, double hz, mt_band_side *side)
{
    const double percent = mt_band_clearance_percent(band, hz, side);
    if (fabs(percent) <= ON_EDGE_PERCENT) {
        *side = by_lower_edge(band, hz) ? MT_BELOW_BAND : MT_ABOVE_BAND;
        return 0.0;
    }
    return percent;
}

/* The margin that the edge of the band nearest to hz has, as a clearance. */
static double margin_percent(const mt_band *band, double hz)
{
    return margin(band, by_lower_edge(band, hz));
}

/* Clearance of a mode at hz from the deciding edge: inside a band with its margin the one that
 * needs the smaller move, else the nearer one. Negative within the base. */
static double standing(const mt_band *band, double hz, double *asked)
{
    const bool inside = missing_percent(band, hz) > 0.0;
    const bool lower =
        inside ? way_down(band, hz) <= way_up(band, hz) : by_lower_edge(band, hz);
    const double has = beyond(band, lower, hz);
    *asked = margin(band, lower);
    return !isfinite(has) ? nan("") : fabs(has) <= ON_EDGE_PERCENT ? 0.0 : has;
}

int mt_describe_avoid_count(const mt_problem *p)
{
    int n = 0;
    for (int i = 0; i < p->study->n_goals; i++) {
        const mt_goal *const g = &p->study->goals[i];
        n += g->avoid != NULL ? g->n_configurations : 0;
    }
    return n;
}

/* "installed clear of 4 bands up to 200 Hz" */
static const char *avoid_text(const mt_goal *g, const char *configuration, mt_arena *mem)
{
    const mt_bands *const bands = &g->avoid->bands;
    if (bands->n == 1) {
        return mt_arena_printf(mem, "%s clear of %s", configuration, bands->items[0].label);
    }
    const double up_to =
        bands->n > 0 ? bands->items[bands->n - 1].base_upper_hz : g->avoid->source.up_to_hz;
    return mt_arena_printf(mem, "%s clear of %d bands up to %.6g Hz", configuration, bands->n,
                           MT_HAS(g->avoid->source.up_to_hz) ? g->avoid->source.up_to_hz
                                                             : up_to);
}

/* The frequency nearest to a band, or deepest inside it, that a mode at hz reaches over the
 * tolerances; *at: [n] the design there. NaN and NULL without tolerances. */
static double find_worst_hz(const mt_workspace *fresh, int view, int mode, const mt_band *band,
                            double hz, const double **at)
{
    const mt_tolerance_range *const r = mt_ranges_hz(mt_tolerance_known(fresh), view, mode);
    const double middle = sqrt(fmax(band->lower_hz, 0.0) * band->upper_hz);
    *at = NULL;
    if (r == NULL) {
        return nan("");
    }
    const mt_tolerance_side side = hz > middle ? MT_LOWEST : MT_HIGHEST;
    const double end = r->value[side];
    *at = r->at[side];
    /* one that crosses the band from one side to the other is in its middle on the way */
    return side == MT_LOWEST ? fmax(end, fmin(middle, hz)) : fmin(end, fmax(middle, hz));
}

/* Of all modes beside all bands the clearance that comes nearest to its margin, or falls short
 * of it most; the first of equal ones. */
typedef struct tightest {
    double has; /* NaN without bands or modes */
    double asked;
    double missing;   /* of any of them; 0: all are clear */
    const double *at; /* [n] where over the tolerances; NULL: at the design itself */
} tightest;

static tightest find_tightest(const mt_workspace *fresh, int view, const mt_bands *bands,
                              bool over_tolerances)
{
    const mt_modes *const modes = &fresh->views[view].analysis->modes;
    tightest t = {.has = nan(""), .asked = nan("")};
    mt_mode_band_pair p = mt_mode_band_pairs_all(modes, bands);
    double least = HUGE_VAL;
    while (mt_mode_band_pairs_next(&p)) {
        const double *at = NULL;
        double asked = 0.0;
        const double hz =
            over_tolerances ? find_worst_hz(fresh, view, p.mode, p.band, p.hz, &at) : p.hz;
        const double has = standing(p.band, hz, &asked);
        t.missing = fmax(t.missing, missing_percent(p.band, hz));
        const double room = mt_without_noise(has - asked, MT_PERCENT_NOISE);
        if (mt_exceeds(least, room)) {
            least = room;
            t.has = has;
            t.asked = asked;
            t.at = at;
        }
    }
    return t;
}

static mt_status describe_avoid_goal(mt_workspace *fresh, int goal, int configuration,
                                     mt_result *result, mt_result_goal *out, mt_err *err)
{
    const mt_goal *const g = &fresh->p->study->goals[goal];
    const int at = mt_problem_configuration(fresh->p, configuration);
    const mt_configuration_work *const view = &fresh->views[at];
    const mt_avoidance own = {.view = at, .bands = g->avoid->bands};
    mt_arena *const mem = &result->mem;
    tightest nominal = {.has = nan(""), .asked = nan(""), .missing = nan("")};
    tightest worst = {.has = nan("")};
    const double violation =
        mt_short_of(view->solved ? mt_avoidance_margin(fresh, &own) : nan(""));
    if (MT_HAS(violation)) {
        nominal = find_tightest(fresh, at, &own.bands, false);
        worst =
            fresh->tolerance_box != NULL ? find_tightest(fresh, at, &own.bands, true) : worst;
    }
    *out = mt_result_goal_default();
    out->type = mt_goal_kind_of(g->type)->name;
    out->configuration = mt_analysis_configuration(view->analysis);
    out->text = avoid_text(g, out->configuration, mem);
    out->quantity = out->configuration;
    out->pointer = mt_arena_printf(mem, "/goals/%d", goal);
    out->unit = "%";
    out->value = nominal.has;
    out->at_least = nominal.asked;
    out->tolerance_percent = g->tolerance_percent;
    /* 0, or NaN */
    out->violation_percent = violation > 0.0 ? fmax(nominal.missing, worst.missing) : violation;
    out->met = mt_is_met(violation, mt_goal_tolerance(g));
    out->worst = worst.has;
    if (worst.at != NULL) {
        out->worst_at = mt_arena_f64(mem, (size_t)fresh->p->n, 1);
        MT_TRY(mt_arena_check(mem, err));
        memcpy(out->worst_at, worst.at, (size_t)fresh->p->n * sizeof *worst.at);
    }
    return mt_arena_check(mem, err);
}

mt_status mt_describe_avoid_goals(mt_workspace *fresh, mt_result *result,
                                  mt_recommendation *rec, mt_err *err)
{
    for (int i = 0; i < fresh->p->study->n_goals; i++) {
        const mt_goal *const g = &fresh->p->study->goals[i];
        for (int k = 0; g->avoid != NULL && k < g->n_configurations; k++) {
            MT_TRY(describe_avoid_goal(fresh, i, g->configurations[k], result,
                                       &rec->goals[rec->n_goals], err));
            rec->n_goals++;
        }
    }
    return MT_OK;
}

typedef struct listing {
    const mt_workspace *fresh;
    int view;
    mt_result *result;
    mt_recommendation *rec;
    const char *configuration;
    const mt_bands *bands;
    int first; /* index of the first band among all of the study */
} listing;

static mt_status add_clearance(const listing *l, int band, int mode, double hz, mt_err *err)
{
    const mt_band *const b = &l->bands->items[band];
    mt_result_clearance *const c = &l->rec->clearances[l->rec->n_clearances];
    mt_band_side side = MT_INSIDE_BAND;
    const double *at = NULL;
    *c = (mt_result_clearance){.configuration = l->configuration,
                               .band_id = l->first + band + 1,
                               .mode = mode,
                               .hz = hz};
    c->worst_hz = find_worst_hz(l->fresh, l->view, mode, b, hz, &at);
    c->worst_percent = MT_HAS(c->worst_hz) ? clearance(b, c->worst_hz, &side) : nan("");
    c->worst_percent = isfinite(c->worst_percent) ? c->worst_percent : nan("");
    c->percent = clearance(b, hz, &side); /* infinite at 0 Hz, which no ratio reaches */
    c->percent = isfinite(c->percent) ? c->percent : nan("");
    c->margin_percent = margin_percent(b, hz);
    c->side = mt_band_side_name(side);
    c->band = mt_arena_strdup(&l->result->mem, b->label);
    l->rec->n_clearances++;
    if (isfinite(c->percent) && !(c->percent >= l->rec->clearance_percent)) {
        l->rec->clearance_percent = c->percent;
    }
    return mt_arena_check(&l->result->mem, err);
}

/* The band that the mode is in, or its neighbours on both sides. */
static mt_status list_mode(const listing *l, int mode, double hz, mt_err *err)
{
    mt_band_side side = MT_ABOVE_BAND;
    int next = 0; /* first band that the mode is not above */
    for (; next < l->bands->n; next++) {
        (void)clearance(&l->bands->items[next], hz, &side);
        if (side != MT_ABOVE_BAND) {
            break;
        }
    }
    if (next > 0 && side != MT_INSIDE_BAND) {
        MT_TRY(add_clearance(l, next - 1, mode, hz, err));
    }
    return next < l->bands->n ? add_clearance(l, next, mode, hz, err) : MT_OK;
}

static mt_status list_placements(const listing *l, const int *below, mt_err *err)
{
    for (int b = 0; b < l->bands->n; b++) {
        const mt_band *const band = &l->bands->items[b];
        l->rec->placements[l->rec->n_placements] = (mt_result_mode_placement){
            .id = l->first + b + 1,
            .configuration = l->configuration,
            .band = mt_arena_strdup(&l->result->mem, band->label),
            .lower_hz = band->base_lower_hz,
            .upper_hz = band->base_upper_hz,
            .margin_lower_hz = band->lower_hz,
            .margin_upper_hz = band->upper_hz,
            .modes_below = below[b],
        };
        l->rec->n_placements++;
    }
    return mt_arena_check(&l->result->mem, err);
}

static mt_status list_clear(mt_workspace *fresh, const mt_avoidance *c, int *below,
                            mt_result *result, mt_recommendation *rec, mt_err *err)
{
    const mt_configuration_work *const view = &fresh->views[c->view];
    const mt_modes *const modes = &view->analysis->modes;
    const int count = mt_avoidances_reach(fresh, c->view);
    const listing l = {.fresh = fresh,
                       .view = c->view,
                       .result = result,
                       .rec = rec,
                       .configuration = mt_analysis_configuration(view->analysis),
                       .bands = &c->bands,
                       .first = c->first};
    if (!view->solved || !MT_HAS(mt_avoidance_find_modes(c, modes, below))) {
        return MT_OK; /* unstable: no mode has an index here */
    }
    MT_TRY(list_placements(&l, below, err));
    for (int k = 1; k <= count; k++) {
        const int pos = mt_modal_flexible(modes, k);
        MT_TRY(list_mode(&l, k, mt_modal_hz(modes, pos), err));
    }
    return MT_OK;
}

mt_status mt_describe_clearances(mt_workspace *fresh, mt_result *result, mt_recommendation *rec,
                                 mt_err *err)
{
    size_t most = 0;
    size_t bands = 0;
    for (int i = 0; i < fresh->c->n_avoidances; i++) {
        most += 2 * (size_t)mt_avoidances_reach(fresh, fresh->c->avoidances[i].view);
        bands += (size_t)fresh->c->avoidances[i].bands.n;
    }
    int *const below = mt_arena_int(&fresh->mem, bands);
    rec->clearances = mt_arena_alloc(&result->mem, most, sizeof *rec->clearances);
    rec->placements = mt_arena_alloc(&result->mem, bands, sizeof *rec->placements);
    MT_TRY(mt_arena_check(&fresh->mem, err));
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int i = 0; i < fresh->c->n_avoidances; i++) {
        MT_TRY(list_clear(fresh, &fresh->c->avoidances[i], below, result, rec, err));
    }
    rec->placements = rec->n_placements > 0 ? rec->placements : NULL;
    for (int i = 0; i < rec->n_motions; i++) {
        rec->clearance_percent =
            fmin(rec->clearance_percent, rec->motions[i].least_clearance_percent);
    }
    return MT_OK;
}
