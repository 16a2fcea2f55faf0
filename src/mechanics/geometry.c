/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mechanics/geometry.h"

#include "mechanics/linear_priv.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

/* Room for one more system and n more geometries. */
static bool grow_geometry_pool(mt_geometries *pool, int n)
{
    mt_linear **const systems =
        realloc((void *)pool->systems, ((size_t)pool->n + 1) * sizeof(mt_linear *));
    if (systems != NULL) {
        pool->systems = systems;
    }
    mt_geometry **const all =
        realloc((void *)pool->all, ((size_t)pool->n_all + (size_t)n) * sizeof(mt_geometry *));
    if (all != NULL) {
        pool->all = all;
    }
    return systems != NULL && all != NULL;
}

static void enter(mt_geometries *pool, mt_linear *lin)
{
    pool->systems[pool->n++] = lin;
    lin->pool = pool;
}

static void dissolve(mt_geometries *pool)
{
    for (int i = 0; i < pool->n_all; i++) {
        mt_arena_free(&pool->all[i]->mem);
        free(pool->all[i]);
    }
    free((void *)pool->all);
    free((void *)pool->systems);
    free(pool);
}

mt_status mt_geometry_open(mt_linear *lin, mt_err *err)
{
    const size_t n = (size_t)lin->sys->n_inputs;
    mt_geometries *const pool = calloc(1, sizeof *pool);
    mt_geometry *const g = calloc(1, sizeof *g + (n * sizeof g->at[0]));
    if (pool == NULL || g == NULL || !grow_geometry_pool(pool, 1) ||
        mt_arena_init(&g->mem, 0, err) != MT_OK) {
        if (pool != NULL) {
            dissolve(pool);
        }
        free(g);
        return mt_fail_memory(err);
    }
    g->users = 1;
    pool->all[pool->n_all++] = g;
    lin->geometry = g;
    enter(pool, lin);
    return MT_OK;
}

/* Invalidate geometries made by a system that is deleted: their closure's factors point into
 * it. */
static void forget_maker(const mt_geometries *pool, const mt_linear *maker)
{
    for (int i = 0; i < pool->n; i++) {
        mt_linear *const other = pool->systems[i];
        if (other->geometry->maker == maker) {
            other->stages.valid[MT_STAGE_GEOMETRY] = false;
        }
    }
    for (int i = 0; i < pool->n_all; i++) {
        if (pool->all[i]->maker == maker) {
            pool->all[i]->made = false;
        }
    }
}

void mt_geometry_leave(mt_linear *lin)
{
    mt_geometries *const pool = lin->pool;
    if (pool == NULL) {
        return;
    }
    forget_maker(pool, lin);
    lin->geometry->users--;
    for (int i = 0; i < pool->n; i++) {
        if (pool->systems[i] == lin) {
            pool->systems[i] = pool->systems[--pool->n];
            break;
        }
    }
    if (pool->n == 0) {
        dissolve(pool);
    }
    lin->pool = NULL;
}

static void stand_on(mt_linear *lin, mt_geometry *g)
{
    lin->geometry->users--;
    g->users++;
    lin->geometry = g;
}

void mt_geometry_renew(mt_linear *lin)
{
    const mt_geometries *const pool = lin->pool;
    for (int i = 0; i < pool->n_all && lin->geometry->users > 1; i++) {
        if (pool->all[i]->users == 0) {
            stand_on(lin, pool->all[i]);
        }
    }
    mt_geometry *const g = lin->geometry;
    assert(g->users == 1);
    g->made = false;
    g->sloped = false;
    mt_arena_clear(&g->mem);
}

void mt_geometry_made(mt_linear *lin, const double *inputs)
{
    mt_geometry *const g = lin->geometry;
    g->before_tangent = mt_arena_get_mark(&g->mem);
    g->maker = lin;
    g->position = lin->position;
    g->e = lin->e;
    g->a = lin->a;
    for (int kind = 0; kind < MT_TERM_KINDS; kind++) {
        g->rows[kind] = lin->rows[kind];
        g->full[kind] = lin->full[kind];
    }
    for (int i = 0; i < lin->sys->n_inputs; i++) {
        g->at[i] = inputs[i];
    }
    g->made = true;
}

static void adopt(mt_linear *lin)
{
    const mt_geometry *const g = lin->geometry;
    lin->position = g->position;
    lin->position.sys = lin->sys;
    lin->e = g->e;
    lin->a = g->a;
    for (int kind = 0; kind < MT_TERM_KINDS; kind++) {
        lin->rows[kind] = g->rows[kind];
        lin->full[kind] = g->full[kind];
    }
    mt_data_vecs(&lin->data);
    mt_data_targets(&lin->data);
    mt_data_rest(&lin->data, lin->position.reference.pose);
}

bool mt_geometry_take(mt_linear *lin, const uint64_t *moves, const double *inputs)
{
    const mt_geometries *const pool = lin->pool;
    for (int i = 0; i < pool->n_all && pool->n > 1; i++) {
        mt_geometry *const g = pool->all[i];
        if (g->made && mt_stages_same(&lin->stages, moves, g->at, inputs)) {
            stand_on(lin, g);
            adopt(lin);
            return true;
        }
    }
    return false;
}

mt_status mt_geometry_join(mt_linear *lin, mt_linear *with, mt_err *err)
{
    mt_geometries *const own = lin->pool;
    assert(own->n == 1);
    if (!grow_geometry_pool(with->pool, own->n_all)) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < own->n_all; i++) {
        with->pool->all[with->pool->n_all++] = own->all[i];
    }
    own->n_all = 0;
    enter(with->pool, lin);
    dissolve(own);
    return MT_OK;
}
