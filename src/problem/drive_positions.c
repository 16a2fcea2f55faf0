/* SPDX-License-Identifier: GPL-3.0-or-later */

#include "problem/drive_positions.h"

#include <math.h>
#include <string.h>

#include "mechanics/geometry.h"
#include "problem/configuration.h"
#include "problem/frequency.h"
#include "problem/goals.h"

static const mt_system *system_of(const mt_problem *p, int view)
{
    return p->views[view].original->sys;
}

double mt_drive_positions_position(const mt_drive_positions *f, const mt_analysis *a)
{
    const mt_system *const sys = a->sys;
    for (int i = 0; i < sys->n_drives; i++) {
        if (strcmp(sys->joints[sys->drives[i].joint].name, f->joint) == 0) {
            return mt_linear_value(a->lin, sys->drives[i].position);
        }
    }
    return 0.0;
}

bool mt_drive_positions_any(const mt_problem *p)
{
    for (int i = 0; i < p->n_families; i++) {
        if (p->families[i].banded) {
            return true;
        }
    }
    return false;
}

int mt_drive_positions_of(const mt_problem *p, int view)
{
    for (int i = 0; i < p->n_families; i++) {
        for (int k = 0; k < p->families[i].n; k++) {
            if (p->families[i].view[k] == view) {
                return i;
            }
        }
    }
    return -1;
}

static bool is_equal(double a, double b)
{
    return a == b || (!MT_HAS(a) && !MT_HAS(b));
}

static bool is_text(const char *a, const char *b)
{
    return a == b || (a != NULL && b != NULL && strcmp(a, b) == 0);
}

/* True where both have the same input and the same output. */
static bool same_response_limit(const mt_response_limit *a, const mt_response_limit *b)
{
    if (a == NULL || b == NULL) {
        return a == b;
    }
    return is_text(a->input.s, b->input.s) && is_text(a->output.s, b->output.s) &&
           is_equal(a->lower_hz, b->lower_hz) && is_equal(a->upper_hz, b->upper_hz) &&
           a->profile == b->profile && a->quantity == b->quantity;
}

/* True where both are of the same energy of the same body or spring. */
static bool same_energy(const mt_requirement *a, const mt_requirement *b)
{
    const mt_energy_part *const x = a->energy;
    const mt_energy_part *const y = b->energy;
    if (x == NULL || y == NULL) {
        return x == y;
    }
    return x->kind == y->kind && x->first == y->first && x->count == y->count &&
           x->direction == y->direction && x->axes == y->axes &&
           a->goal->energy->about.point == b->goal->energy->about.point;
}

bool mt_drive_positions_same_limit(const mt_requirement *a, const mt_requirement *b)
{
    const bool own =
        a->goal_index == b->goal_index && a->asked == b->asked && a->direction == b->direction;
    return own ||
           (a->ops == b->ops && a->mode == b->mode && a->named < 0 && b->named < 0 &&
            a->of.mode == b->of.mode && a->of.named < 0 && b->of.named < 0 &&
            is_equal(a->goal->at_least_hz, b->goal->at_least_hz) &&
            a->role != MT_ROLE_RESIDUAL && b->role != MT_ROLE_RESIDUAL &&
            is_equal(a->equals, b->equals) && is_equal(a->goal->at_least, b->goal->at_least) &&
            is_equal(a->goal->at_most, b->goal->at_most) &&
            same_response_limit(a->goal->response_limit, b->goal->response_limit) &&
            same_energy(a, b) && is_text(a->shape.reference, b->shape.reference) &&
            a->shape.mode == b->shape.mode);
}

/* True where a value is limited in at least two positions of one drive, so that the limit also
 * applies between them. A target, a weighted goal and one about rest apply at the named
 * positions only. */
static bool can_be_followed(const mt_requirement *d)
{
    const bool here = d->of.view < 0 || d->of.view == d->view; /* all of it moves */
    return d->ops->value != NULL && d->role != MT_ROLE_RESIDUAL && !MT_HAS(d->equals) &&
           d->rest == NULL && here && d->view >= 0;
}

static bool is_limited(const mt_problem *p, const mt_requirement *d)
{
    const int drive_positions = can_be_followed(d) ? mt_drive_positions_of(p, d->view) : -1;
    for (int i = 0; i < p->n_requirements && drive_positions >= 0; i++) {
        const mt_requirement *const other = &p->requirements[i];
        if (mt_drive_positions_same_limit(other, d) && other->view != d->view &&
            mt_drive_positions_of(p, other->view) == drive_positions) {
            return true;
        }
    }
    return false;
}

bool mt_drive_positions_limits_first(const mt_problem *p, const mt_requirement *d)
{
    for (const mt_requirement *other = p->requirements; other < d; other++) {
        if (mt_drive_positions_same_limit(other, d) &&
            mt_drive_positions_of(p, other->view) == mt_drive_positions_of(p, d->view)) {
            return false;
        }
    }
    return is_limited(p, d);
}

/* True where both are postures of several joints, and not positions of one of them. */
static bool is_unfollowed(const mt_problem *p, int a, int b)
{
    const int own = mt_drive_positions_of(p, a);
    return system_of(p, a)->n_drives > 1 && system_of(p, b)->n_drives > 1 && a != b &&
           (own < 0 || own != mt_drive_positions_of(p, b));
}

bool mt_drive_positions_unfollowed(const mt_problem *p, int *a, int *b)
{
    for (int i = 0; i < p->n_requirements; i++) {
        for (int k = 0; k < i && can_be_followed(&p->requirements[i]); k++) {
            *a = p->requirements[k].view;
            *b = p->requirements[i].view;
            if (*a >= 0 && is_unfollowed(p, *a, *b) &&
                mt_drive_positions_same_limit(&p->requirements[k], &p->requirements[i])) {
                return true;
            }
        }
    }
    for (int i = 0; i < p->n_avoidances; i++) {
        for (int k = 0; k < i; k++) {
            *a = p->avoidances[k].view;
            *b = p->avoidances[i].view;
            if (p->avoidances[k].goal_index == p->avoidances[i].goal_index &&
                is_unfollowed(p, *a, *b)) {
                return true;
            }
        }
    }
    return false;
}

static void find_limited(mt_problem *p)
{
    for (int i = 0; i < p->n_requirements; i++) {
        if (is_limited(p, &p->requirements[i])) {
            p->families[mt_drive_positions_of(p, p->requirements[i].view)].limited = true;
        }
    }
}

/* Sets the drive's joint and spring from a configuration that has the drive. joint: of the
 * system's joints. */
static void name_drive(const mt_problem *p, int joint, mt_drive_positions *f)
{
    f->fixed = true;
    for (int k = 0; k < f->n; k++) {
        const mt_system *const sys = system_of(p, f->view[k]);
        const int at = mt_system_drive_of(sys, joint);
        if (at >= 0) {
            const mt_drive_def *const drive = &sys->drives[at];
            f->configuration = p->views[f->view[k]].configuration;
            f->joint = sys->joints[joint].name;
            f->spring = drive->spring >= 0 ? sys->springs[drive->spring].name : NULL;
            f->angle = sys->joints[joint].angle;
            f->fixed = f->fixed && mt_program_is_constant(&sys->program, drive->position);
        }
    }
}

/* Collects the configurations that are the same mechanism as `first`, which has no drive yet,
 * in another position of one joint, *joint: that of the first one that is found. A
 * configuration without a drive joins the first driven one that it equals. */
static mt_status collect_same_mechanisms(mt_problem *p, int first, mt_drive_positions *f,
                                         int *joint, mt_err *err)
{
    *joint = -1;
    f->view = mt_arena_int(&p->mem, (size_t)p->n_views);
    MT_TRY(mt_arena_check(&p->mem, err));
    for (int i = 0; i < p->n_views; i++) {
        bool same = i == first;
        if (mt_drive_positions_of(p, i) < 0 && !same) {
            int other = -1;
            MT_TRY(
                mt_system_same_drive(system_of(p, first), system_of(p, i), &same, &other, err));
            same = same && (*joint < 0 || other < 0 || other == *joint);
            *joint = same && other >= 0 ? other : *joint;
        }
        if (same) {
            f->view[f->n++] = i;
        }
    }
    return MT_OK;
}

static mt_status tie(mt_problem *p, mt_err *err);

/* An analysis of the drive's mechanism with the mode count of its positions. */
static mt_configuration_problem view_of(const mt_problem *p, const mt_drive_positions *f)
{
    const mt_configuration_problem *const like = &p->views[f->view[0]];
    return (mt_configuration_problem){
        .configuration = f->configuration, .n_rigid = like->n_rigid, .n_most = like->n_most};
}

/* Makes the mechanism that is followed between positions; where that fails, the reason is kept
 * in `why` and reported on use. */
static mt_status set_moving(mt_problem *p, mt_drive_positions *f, mt_err *err)
{
    const mt_system_drive drive = {.joint = f->joint, .spring = f->spring};
    const size_t n = (size_t)p->n;
    mt_err own = {.code = MT_OK};
    f->moving = view_of(p, f);
    f->moving_at = mt_arena_f64(&p->mem, n + 1, 1);
    MT_TRY(mt_arena_check(&p->mem, err));
    memcpy(f->moving_at, p->original, n * sizeof *f->moving_at);
    f->moving_at[n] = mt_drive_positions_position(f, p->views[f->view[0]].original);
    const mt_status rc =
        mt_configuration_drive(p, &f->moving, &drive, f->moving_at, &f->moving.original, &own);
    if (mt_is_final(rc) || rc == MT_E_INTERRUPTED) {
        return mt_fail(err, rc, "%s", own.text);
    }
    f->why = rc != MT_OK ? mt_arena_strdup(&p->mem, own.text) : NULL;
    return mt_arena_check(&p->mem, err);
}

mt_status mt_cut_init(const mt_problem *p, int drive_positions, double position, mt_cut *out,
                      mt_err *err)
{
    const mt_drive_positions *const f = &p->families[drive_positions];
    const mt_configuration_problem view = view_of(p, f);
    const mt_system_drive drive = {
        .joint = f->joint, .spring = f->spring, .fixed = true, .position = position};
    *out =
        (mt_cut){.drive_positions = drive_positions, .requirement = -1, .position = position};
    return mt_configuration_drive(p, &view, &drive, p->original, &out->original, err);
}

void mt_cut_free(mt_cut *cut)
{
    mt_analysis_delete(cut->original);
    *cut = (mt_cut){.original = NULL};
}

void mt_families_free(mt_problem *p)
{
    for (int i = 0; i < p->n_families; i++) {
        mt_analysis_delete(p->families[i].moving.original);
    }
}

mt_status mt_families_init(mt_problem *p, mt_err *err)
{
    p->families = mt_arena_alloc(&p->mem, (size_t)p->n_views, sizeof *p->families);
    MT_TRY(mt_arena_check(&p->mem, err));
    for (int i = 0; i < p->n_views; i++) {
        mt_drive_positions f = {.n = 0};
        if (!system_of(p, i)->driven || mt_drive_positions_of(p, i) >= 0) {
            continue;
        }
        int joint = -1;
        MT_TRY(collect_same_mechanisms(p, i, &f, &joint, err));
        if (f.n > 1) {
            name_drive(p, joint < 0 ? system_of(p, i)->drives[0].joint : joint, &f);
            p->families[p->n_families++] = f;
        }
    }
    MT_TRY(tie(p, err));
    find_limited(p);
    for (int i = 0; i < p->n_families; i++) {
        const bool followed = p->families[i].banded || p->families[i].limited;
        MT_TRY(followed ? set_moving(p, &p->families[i], err) : MT_OK);
    }
    return MT_OK;
}

/* Common frequencies, of the bases and, over more than a point, with the margins. */
static bool overlap(const mt_band *a, const mt_band *b)
{
    return fmax(a->base_lower_hz, b->base_lower_hz) <=
               fmin(a->base_upper_hz, b->base_upper_hz) &&
           fmax(a->lower_hz, b->lower_hz) < fmin(a->upper_hz, b->upper_hz);
}

static void join_tied_bands(mt_problem *p, int a, int b)
{
    const int low = p->tie[a] < p->tie[b] ? p->tie[a] : p->tie[b];
    const int high = p->tie[a] < p->tie[b] ? p->tie[b] : p->tie[a];
    for (int i = 0; i < p->n_bands; i++) {
        p->tie[i] = p->tie[i] == high ? low : p->tie[i];
    }
}

static void tie_avoidances(mt_problem *p, const mt_avoidance *a, const mt_avoidance *b)
{
    for (int i = 0; i < a->bands.n; i++) {
        for (int k = 0; k < b->bands.n; k++) {
            if (overlap(&a->bands.items[i], &b->bands.items[k])) {
                join_tied_bands(p, a->first + i, b->first + k);
            }
        }
    }
}

static mt_status tie(mt_problem *p, mt_err *err)
{
    p->tie = mt_arena_int(&p->mem, (size_t)p->n_bands);
    MT_TRY(mt_arena_check(&p->mem, err));
    for (int i = 0; i < p->n_bands; i++) {
        p->tie[i] = i;
    }
    for (int i = 0; i < p->n_avoidances; i++) {
        const int drive_positions = mt_drive_positions_of(p, p->avoidances[i].view);
        for (int k = 0; k < i && drive_positions >= 0; k++) {
            if (mt_drive_positions_of(p, p->avoidances[k].view) == drive_positions) {
                p->families[drive_positions].banded = true;
                tie_avoidances(p, &p->avoidances[k], &p->avoidances[i]);
            }
        }
    }
    return MT_OK;
}

bool mt_ties_agree(const mt_problem *p, const int *below)
{
    for (int i = 0; i < p->n_bands; i++) {
        if (below[i] != below[p->tie[i]]) {
            return false;
        }
    }
    return true;
}

void mt_ties_settle(const mt_problem *p, bool most, int *below)
{
    for (int i = 0; i < p->n_bands; i++) {
        const int first = p->tie[i];
        const bool better = most ? below[i] > below[first] : below[i] < below[first];
        below[first] = better ? below[i] : below[first];
    }
    for (int i = 0; i < p->n_bands; i++) {
        below[i] = below[p->tie[i]];
    }
}

static const mt_modes *modes_of(const mt_workspace *w, const mt_avoidance *c)
{
    return &w->views[c->view].analysis->modes;
}

/* Least margin of all bands tied to `tie` with k modes below. */
static double tie_margin_with(const mt_workspace *w, int tie, int k, bool *stable, int *most)
{
    const mt_problem *const p = w->p;
    double room = HUGE_VAL;
    for (int i = 0; i < p->n_avoidances; i++) {
        const mt_avoidance *const c = &p->avoidances[i];
        const mt_modes *const modes = modes_of(w, c);
        for (int b = 0; b < c->bands.n; b++) {
            if (p->tie[c->first + b] != tie) {
                continue;
            }
            const int flexible = mt_modal_vibrations(modes);
            *stable = *stable && mt_modal_indexed(modes);
            *most = flexible > *most ? flexible : *most;
            room = fmin(room, mt_band_margin_with(modes, &c->bands.items[b], k));
        }
    }
    return room;
}

double mt_tie_margin(const mt_workspace *w, int tie, int *below)
{
    bool stable = true;
    int most = 0;
    double best = tie_margin_with(w, tie, 0, &stable, &most);
    *below = 0;
    for (int k = 1; k <= most; k++) {
        const double room = tie_margin_with(w, tie, k, &stable, &most);
        if (room > best) {
            best = room;
            *below = k;
        }
    }
    return stable ? best : nan("");
}

double mt_ties_violation(const mt_workspace *w, const int *below)
{
    const mt_problem *const p = w->p;
    double worst = 0.0;
    for (int i = 0; i < p->n_avoidances; i++) {
        const mt_avoidance *const c = &p->avoidances[i];
        const mt_modes *const modes = modes_of(w, c);
        for (int b = 0; b < c->bands.n; b++) {
            const double room =
                mt_band_margin_with(modes, &c->bands.items[b], below[c->first + b]);
            worst = fmax(worst, mt_modal_indexed(modes) ? -room : nan(""));
        }
    }
    return worst;
}

double mt_ties_margin(const mt_workspace *w, int *below)
{
    const mt_problem *const p = w->p;
    double least = HUGE_VAL;
    for (int i = 0; i < p->n_bands; i++) {
        int k = 0;
        if (p->tie[i] == i) {
            const double room = mt_tie_margin(w, i, &k);
            least = !(room >= least) ? room : least;
        }
        if (below != NULL) {
            below[i] = p->tie[i] == i ? k : below[p->tie[i]];
        }
    }
    return least;
}

/* Adds a band unless a listed one contains it; listed ones that it contains are removed. */
static void add_band_unless_contained(mt_band_along_path *list, int *n,
                                      const mt_band_along_path *fresh)
{
    int kept = 0;
    for (int i = 0; i < *n; i++) {
        const mt_band *const has = &list[i].band;
        if (has->lower_hz <= fresh->band.lower_hz && has->upper_hz >= fresh->band.upper_hz) {
            return; /* nothing has been dropped: what it holds would be held by that too */
        }
    }
    for (int i = 0; i < *n; i++) {
        const mt_band *const has = &list[i].band;
        if (!(has->lower_hz >= fresh->band.lower_hz && has->upper_hz <= fresh->band.upper_hz)) {
            list[kept++] = list[i];
        }
    }
    int at = kept;
    for (; at > 0 && list[at - 1].band.lower_hz > fresh->band.lower_hz; at--) {
        list[at] = list[at - 1];
    }
    list[at] = *fresh;
    *n = kept + 1;
}

static void intersect(const mt_problem *p, const mt_avoidance *a, const mt_avoidance *b,
                      mt_band_along_path *list, int *n)
{
    for (int i = 0; i < a->bands.n; i++) {
        for (int k = 0; k < b->bands.n; k++) {
            const mt_band *const x = &a->bands.items[i];
            const mt_band *const y = &b->bands.items[k];
            if (p->tie[a->first + i] != p->tie[b->first + k] || !overlap(x, y)) {
                continue;
            }
            const mt_band_along_path fresh = {
                .tie = p->tie[a->first + i],
                .band = {.base_lower_hz = fmax(x->base_lower_hz, y->base_lower_hz),
                         .base_upper_hz = fmin(x->base_upper_hz, y->base_upper_hz),
                         .lower_hz = fmax(x->lower_hz, y->lower_hz),
                         .upper_hz = fmin(x->upper_hz, y->upper_hz),
                         .label = x->label},
                .tolerance = fmin(a->tolerance, b->tolerance)};
            add_band_unless_contained(list, n, &fresh);
        }
    }
}

static const mt_avoidance *clear_of(const mt_problem *p, int view)
{
    for (int i = 0; i < p->n_avoidances; i++) {
        if (p->avoidances[i].view == view) {
            return &p->avoidances[i];
        }
    }
    return NULL;
}

/* Number of pairs of tied bands: the largest number that intersect writes. */
static size_t count_tied(const mt_problem *p)
{
    size_t n = 0;
    for (int i = 0; i < p->n_bands; i++) {
        for (int k = 0; k < p->n_bands; k++) {
            n += p->tie[i] == p->tie[k] ? 1 : 0;
        }
    }
    return n;
}

mt_status mt_drive_positions_bands(const mt_problem *p, const mt_drive_positions *f,
                                   const double *at, double left, double right, mt_arena *mem,
                                   mt_band_along_paths *out, mt_err *err)
{
    *out =
        (mt_band_along_paths){.items = mt_arena_alloc(mem, count_tied(p), sizeof *out->items)};
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < f->n; i++) {
        const mt_avoidance *const a = clear_of(p, f->view[i]);
        for (int k = 0; k < f->n && a != NULL; k++) {
            const mt_avoidance *const b = k == i ? NULL : clear_of(p, f->view[k]);
            if (b != NULL && at[i] <= left && at[k] >= right) {
                intersect(p, a, b, out->items, &out->n);
            }
        }
    }
    return MT_OK;
}
