/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scene.h"

#include "scene/scene_priv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/workers.h"
#include "model/values.h"
#include "scene/distance.h"

double mt_scene_work(double coordinates)
{
    /* of a reduction to tridiagonal form and back, and of what comes before */
    return 20.0 * coordinates * coordinates * coordinates;
}

/* About how much there is to show in a configuration. */
static double items_of(const mt_model *m, int configuration)
{
    const double others = (double)m->n_joints + (double)m->n_springs + (double)m->n_sensors +
                          (double)m->n_loads + (double)m->n_points;
    return mt_lowest_bodies(m, configuration) + (others / 4.0);
}

/* Positions of modes to show: those before the vibration mode that is one too many. */
static int shown_of(const mt_modes *modes)
{
    int flexible = 0;
    for (int i = 0; i < modes->count; i++) {
        if (modes->kind[i] == MT_MODE_FLEXIBLE && ++flexible > MT_SCENE_MODES) {
            return i;
        }
    }
    return modes->count;
}

/* Add all items at rest. */
static mt_status draw(mt_scene_frame *f, mt_err *err)
{
    MT_TRY(mt_scene_bodies(f, err));
    MT_TRY(mt_scene_items(f, err));
    MT_TRY(mt_scene_springs(f, err));
    return mt_scene_lines(f, err);
}

/* Position at rest and modes by full matrices. */
static mt_status by_analysis(mt_scene_frame *f, mt_analysis *a, mt_err *err)
{
    f->sys = a->sys;
    MT_TRY(mt_scene_frame_new(f, err));
    f->pose = mt_linear_position(a->lin)->at.pose;
    MT_TRY(draw(f, err));
    int shown = shown_of(&a->modes);
    shown = shown < a->modes.shaped ? shown : a->modes.shaped;
    double *const phi = mt_arena_f64(f->work, (size_t)f->sys->nq, (size_t)shown);
    MT_TRY(mt_arena_check(f->work, err));
    mt_linear_expand(a->lin, shown, a->modes.y, phi);
    return mt_scene_modes(f, &a->modes, shown, phi, err);
}

/* The lowest modes of a large mechanism, which is at rest as drawn. */
static mt_status by_lowest(mt_scene_frame *f, mt_lowest *l, mt_err *err)
{
    const mt_modes *const m = &l->found.modes;
    f->sys = l->sys;
    MT_TRY(mt_scene_frame_new(f, err));
    MT_TRY(draw(f, err));
    const int shown = shown_of(m);
    double *const phi = mt_arena_f64(f->work, (size_t)f->sys->nq, (size_t)shown);
    MT_TRY(mt_arena_check(f->work, err));
    MT_TRY(mt_lowest_shapes(l, shown, phi, err));
    return mt_scene_modes(f, m, shown, phi, err);
}

/* The drawing alone, of what cannot be analysed. Failing that, nothing. */
static mt_status as_drawn(mt_scene_frame *f, mt_err *err)
{
    const mt_system_def def = mt_scene_system(f, NULL, f->ask->at);
    mt_system *sys = NULL;
    mt_status rc = mt_system_new_of(&def, &sys, err);
    f->sys = sys;
    rc = rc == MT_OK ? mt_scene_frame_new(f, err) : rc;
    rc = rc == MT_OK ? draw(f, err) : rc;
    mt_system_delete(sys);
    return rc;
}

/* The analysis of the configuration at this design. That of the previous design is reused for
 * all that designs do not change, and its position is computed as if it were new. It remains
 * owned by its keeper. */
static mt_status analyse(const mt_scene_frame *f, mt_err *err)
{
    const mt_scene_query *const a = f->ask;
    mt_scene_known *const known = f->known;
    if (known->by != NULL && mt_scene_same_inputs(known->ask, a)) {
        mt_analysis_options opt = mt_analysis_options_default();
        mt_err why = {.code = MT_OK};
        opt.modes.first = MT_SCENE_MODES;
        known->by->n_rigid = -1; /* each design is counted by itself */
        const mt_status rc = mt_analysis_solve(known->by, a->at, &opt, &why);
        if (rc == MT_OK || mt_is_final(rc) || rc == MT_E_INTERRUPTED) {
            return rc == MT_OK ? rc : mt_fail(err, rc, "%s", why.text);
        }
    }
    mt_analysis_delete(known->by);
    known->by = NULL;
    known->ask = a;
    const mt_system_def def = mt_scene_system(f, NULL, a->at);
    return mt_analysis_new_of(&def, MT_SCENE_MODES, &known->by, err);
}

static mt_status analyse_frame(mt_scene_frame *f, mt_scene_room *left, mt_err *err)
{
    const mt_scene_query *const a = f->ask;
    const double bodies = mt_lowest_bodies(f->model, f->configuration);
    const double work = mt_scene_work(bodies * (f->model->dimension == 2 ? 3.0 : 6.0));
    const mt_lowest_want want = {.count = MT_SCENE_MODES, .shapes = true, .drawn = true};
    mt_lowest *l = NULL;
    mt_status rc = MT_OK;
    if (bodies >= MT_LOWEST_BODIES) {
        const mt_system_def def = mt_scene_system(f, NULL, a->at);
        rc = mt_lowest_new(&def, want, &l, err);
    }
    if (rc == MT_OK && l != NULL && l->way != MT_LOWEST_NONE) {
        rc = by_lowest(f, l, err);
    } else if (rc == MT_OK && work > left->work) {
        rc = mt_fail(err, MT_E_INPUT, "%.0f bodies are too many for all modes%s%s", bodies,
                     l == NULL ? "" : ": ", l == NULL ? "" : l->why);
    } else if (rc == MT_OK) {
        left->work -= work;
        rc = analyse(f, err);
        rc = rc == MT_OK ? by_analysis(f, f->known->by, err) : rc;
    }
    rc = rc == MT_OK ? mt_scene_plan(f, left, err) : rc;
    mt_lowest_delete(l);
    return rc;
}

/* Fill one configuration of a design; a failure is stored in it. */
static mt_status view_new(mt_scene_frame *f, mt_scene_room *left, mt_err *err)
{
    const char *const name = f->model->configurations[f->configuration].name.s;
    const double items = items_of(f->model, f->configuration);
    mt_err why = {.code = MT_OK};
    *f->view = (mt_scene_view){.name = mt_arena_strdup(f->mem, name)};
    if (items > MT_SCENE_ITEMS || items > left->items) {
        f->view->error = items > MT_SCENE_ITEMS
                             ? mt_arena_printf(f->mem,
                                               "%.0f bodies, with all that they hold, are more "
                                               "than can be shown",
                                               mt_lowest_bodies(f->model, f->configuration))
                             : "left out, as others fill the page";
        return mt_arena_check(f->mem, err);
    }
    left->items -= items;
    mt_status rc = analyse_frame(f, left, &why);
    if (rc == MT_OK) {
        return mt_arena_check(f->mem, err);
    }
    if (mt_is_final(rc) || rc == MT_E_INTERRUPTED) {
        return mt_fail(err, rc, "%s", why.text);
    }
    *f->view =
        (mt_scene_view){.name = f->view->name, .error = mt_arena_strdup(f->mem, why.text)};
    f->way->drive = NULL;
    mt_arena_clear(f->work);
    mt_err other = {.code = MT_OK};
    rc = as_drawn(f, &other);
    if (rc != MT_OK) { /* the first reason says it all */
        *f->view = (mt_scene_view){.name = f->view->name, .error = f->view->error};
    }
    return rc == MT_E_INTERRUPTED ? mt_fail(err, rc, "%s", other.text)
                                  : mt_pass_final(rc, &other, err);
}

/* True where a parameter's value in the file is a plain number. */
static bool is_plain(const mt_model *model, int parameter)
{
    double value = 0.0;
    return mt_expr_is_constant(&model->nums[model->parameters[parameter].value].expr, &value);
}

static mt_status list_parameters(const mt_model *model, const mt_scene_query *ask,
                                 mt_arena *mem, mt_scene_design *out, mt_err *err)
{
    const size_t most = (size_t)(ask->n_shown < 0 ? model->n_parameters : ask->n_shown);
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    double *const value = mt_arena_f64(mem, (size_t)model->n_parameters, 1);
    out->parameters = mt_arena_alloc(mem, most, sizeof *out->parameters);
    MT_TRY(mt_arena_check(mem, err));
    const mt_status rc = mt_model_parameters(model, MT_ABSENT, ask->n_inputs, ask->inputs,
                                             ask->at, mem, value, err);
    if (rc == MT_E_DOMAIN) { /* every configuration says so itself */
        mt_arena_rewind(mem, mark);
        out->parameters = NULL;
        return MT_OK;
    }
    MT_TRY(rc);
    for (size_t i = 0; i < most; i++) {
        const int p = ask->n_shown < 0 ? (int)i : ask->shown[i];
        if (ask->n_shown < 0 && !is_plain(model, p)) {
            continue;
        }
        const mt_parameter *const from = &model->parameters[p];
        out->parameters[out->n_parameters++] = (mt_scene_parameter){
            .name = mt_arena_strdup(mem, from->name.s),
            .unit = from->unit == NULL ? NULL : mt_arena_strdup(mem, from->unit),
            .display_unit = mt_unit_name(from->written, NULL),
            .display_factor = mt_unit_display(from->written),
            .value = value[p]};
    }
    return mt_arena_check(mem, err);
}

/* What mt_scene_new was asked. */
typedef struct question {
    const mt_model *model;
    const mt_scene_extent *extent;
    mt_scene_room left;
    mt_arena work;
    mt_scene_known *known; /* [configurations of the extent] */
    mt_scene_way *ways;    /* [designs][configurations of the extent] */
    mt_arena *ways_mem;    /* [designs] of the scene: what following them finds */
    mt_arena kept;
} question;

static mt_status design_new(question *q, const mt_scene_query *ask, mt_arena *mem,
                            mt_scene_design *out, mt_scene_way *ways, mt_err *err)
{
    *out = (mt_scene_design){.label = mt_arena_strdup(mem, ask->label), .rank = ask->rank};
    MT_TRY(list_parameters(q->model, ask, mem, out, err));
    out->views = mt_arena_alloc(mem, (size_t)q->extent->n_configurations, sizeof *out->views);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < q->extent->n_configurations; i++) {
        mt_scene_frame f = {.model = q->model,
                            .configuration = q->extent->configurations[i],
                            .ask = ask,
                            .extent = q->extent,
                            .mem = mem,
                            .work = &q->work,
                            .kept = &q->kept,
                            .view = &out->views[i],
                            .known = &q->known[i],
                            .way = &ways[i]};
        mt_arena_clear(&q->work);
        MT_TRY(view_new(&f, &q->left, err));
        out->n_views++;
    }
    return MT_OK;
}

/* All ranges of one design, in the order of its configurations: one may share what another
 * has found. A task. */
static mt_status follow_design(void *context, int worker, int task, mt_task_path *own,
                               mt_err *err)
{
    const question *const q = context;
    const int n = q->extent->n_configurations;
    mt_scene_way *const ways = q->ways + ((ptrdiff_t)task * n);
    mt_scene_followed followed = {.sys = NULL};
    mt_arena work = {.first = NULL};
    mt_status rc = MT_OK;
    (void)worker;
    (void)own;
    for (int i = 0; i < n && rc == MT_OK; i++) {
        mt_scene_way *const way = &ways[i];
        if (way->drive == NULL) {
            continue;
        }
        rc = work.first == NULL ? mt_arena_init(&work, 0, err) : rc;
        way->f.mem = &q->ways_mem[task];
        way->f.work = &work;
        way->f.followed = &followed;
        rc = rc == MT_OK ? mt_scene_follow(way, err) : rc;
    }
    mt_system_delete(followed.sys);
    mt_arena_free(&work);
    return rc == MT_OK ? mt_arena_check(&q->ways_mem[task], err) : rc;
}

static void include_in_scene_box(double low[3], double high[3], const double x[3])
{
    for (int k = 0; k < 3; k++) {
        low[k] = fmin(low[k], x[k]);
        high[k] = fmax(high[k], x[k]);
    }
}

static void include_view(const mt_scene_view *v, double low[3], double high[3])
{
    for (int i = 1; i < v->n_bodies; i++) {
        include_in_scene_box(low, high, v->bodies[i].at);
    }
    for (int i = 0; i < v->n_lines; i++) {
        include_in_scene_box(low, high, v->lines[i].from);
        include_in_scene_box(low, high, v->lines[i].to);
    }
    for (int i = 0; i < v->n_joints; i++) {
        include_in_scene_box(low, high, v->joints[i].at);
    }
    for (int i = 0; i < v->n_sensors; i++) {
        include_in_scene_box(low, high, v->sensors[i].at);
    }
    for (int side = 0; side < 2; side++) {
        for (int i = 0; i < v->n_springs; i++) {
            include_in_scene_box(low, high, v->springs[i].end[side]);
        }
        for (int i = 0; i < v->n_dampers; i++) {
            include_in_scene_box(low, high, v->dampers[i].end[side]);
        }
    }
}

static double scene_size(const mt_scene *scene)
{
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
    double high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (int d = 0; d < scene->n_designs; d++) {
        for (int i = 0; i < scene->designs[d].n_views; i++) {
            include_view(&scene->designs[d].views[i], low, high);
        }
    }
    const double size = mt_distance_points(low, high);
    return isfinite(size) ? size : 0.0;
}

static int by_distance(const void *a, const void *b)
{
    const mt_scene_off *const x = a;
    const mt_scene_off *const y = b;
    const double dx = x->joint->distance;
    const double dy = y->joint->distance;
    return dx != dy ? (dx < dy ? 1 : -1) : x->order - y->order;
}

/* List the joints of the first design; equal distances in the order of configurations and
 * joints. */
static mt_status list_joints(mt_scene *scene, mt_err *err)
{
    const mt_scene_design *const d = scene->n_designs > 0 ? &scene->designs[0] : NULL;
    size_t n = 0;
    for (int i = 0; d != NULL && i < d->n_views; i++) {
        n += (size_t)d->views[i].n_joints;
    }
    scene->joints = mt_arena_alloc(&scene->mem, n, sizeof *scene->joints);
    MT_TRY(mt_arena_check(&scene->mem, err));
    for (int i = 0; d != NULL && i < d->n_views; i++) {
        const mt_scene_view *const v = &d->views[i];
        for (int k = 0; k < v->n_joints; k++) {
            const mt_scene_joint *const j = &v->joints[k];
            const char *const body = j->far == MT_ABSENT ? NULL : v->bodies[j->far].name;
            scene->joints[scene->n_joints] = (mt_scene_off){v->name, body, j, scene->n_joints};
            scene->n_joints++;
        }
    }
    if (scene->n_joints > 0) {
        qsort(scene->joints, (size_t)scene->n_joints, sizeof *scene->joints, by_distance);
    }
    return MT_OK;
}

/* Gravity of one configuration at a design. */
static mt_status gravity_in(const mt_model *model, int configuration, const mt_scene_query *ask,
                            mt_scene *scene, mt_arena *work, mt_err *err)
{
    const mt_configuration *const c = &model->configurations[configuration];
    for (int k = 0; k < 3 && c->has_gravity; k++) {
        MT_TRY(mt_model_number(model, configuration, ask->n_inputs, ask->inputs, ask->at,
                               c->gravity[k], work, &scene->gravity[k], err));
        scene->has_gravity = scene->has_gravity || fabs(scene->gravity[k]) > 0.0;
    }
    return MT_OK;
}

/* Gravity of the first configuration with gravity, at the first design: among those shown, else
 * among all, so that the up direction does not depend on what is shown. */
static mt_status find_gravity(const question *q, const mt_scene_query *ask, mt_scene *scene,
                              mt_arena *work, mt_err *err)
{
    const int all = q->model->n_configurations;
    const int shown = q->extent->n_configurations;
    for (int i = 0; i < shown + all && !scene->has_gravity; i++) {
        const int c = i < shown ? q->extent->configurations[i] : i - shown;
        mt_arena_clear(work);
        MT_TRY(gravity_in(q->model, c, ask, scene, work, err));
    }
    return MT_OK;
}

static mt_status fill_scene(mt_scene *scene, question *q, int n_designs,
                            const mt_scene_query *designs, mt_err *err)
{
    MT_TRY(mt_arena_init(&scene->mem, 0, err));
    MT_TRY(mt_arena_init(&q->work, 0, err));
    MT_TRY(mt_arena_init(&q->kept, 0, err));
    scene->dimension = q->model->dimension;
    scene->name = q->model->name == NULL ? "" : mt_arena_strdup(&scene->mem, q->model->name);
    scene->designs = mt_arena_alloc(&scene->mem, (size_t)n_designs, sizeof *scene->designs);
    const size_t n = (size_t)q->extent->n_configurations;
    q->known = mt_arena_alloc(&q->kept, n, sizeof *q->known);
    q->ways = mt_arena_alloc(&q->kept, n * (size_t)n_designs, sizeof *q->ways);
    scene->found = mt_arena_alloc(&scene->mem, (size_t)n_designs, sizeof *scene->found);
    MT_TRY(mt_arena_check(&q->kept, err));
    MT_TRY(mt_arena_check(&scene->mem, err));
    q->ways_mem = scene->found;
    for (int i = 0; i < n_designs; i++) {
        MT_TRY(design_new(q, &designs[i], &scene->mem, &scene->designs[i],
                          q->ways + ((size_t)i * n), err));
        scene->n_designs++;
    }
    const mt_tasks tasks = {n_designs, follow_design, NULL, q, "designs"};
    MT_TRY(mt_workers_run(q->extent->threads > 1 ? q->extent->threads : 1, NULL, &tasks, err));
    scene->size = scene_size(scene);
    mt_arena_clear(&q->work);
    if (n_designs > 0) {
        MT_TRY(find_gravity(q, &designs[0], scene, &q->work, err));
    }
    return list_joints(scene, err);
}

mt_status mt_scene_new(const mt_model *model, int n_designs, const mt_scene_query *designs,
                       const mt_scene_extent *extent, mt_scene **out, mt_err *err)
{
    question q = {.model = model,
                  .extent = extent,
                  .left = {MT_SCENE_ALL_ITEMS, MT_SCENE_POSES, extent->work}};
    mt_scene *const scene = calloc(1, sizeof *scene);
    *out = NULL;
    if (scene == NULL) {
        return mt_fail_memory(err);
    }
    const mt_status rc = fill_scene(scene, &q, n_designs, designs, err);
    for (int i = 0; i < extent->n_configurations && q.known != NULL; i++) {
        mt_analysis_delete(q.known[i].by);
    }
    mt_arena_free(&q.work);
    mt_arena_free(&q.kept);
    if (rc != MT_OK) {
        mt_scene_delete(scene);
        return rc;
    }
    *out = scene;
    return MT_OK;
}

void mt_scene_delete(mt_scene *scene)
{
    if (scene != NULL) {
        for (int i = 0; i < scene->n_designs && scene->found != NULL; i++) {
            mt_arena_free(&scene->found[i]);
        }
        mt_arena_free(&scene->mem);
        free(scene);
    }
}
