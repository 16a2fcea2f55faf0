/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Resolving and checking a model, stage by stage; this file has the name spaces and what the
 * stages share. */
#include "model/resolve.h"

#include "model/resolve_priv.h"

#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "expr/kind.h"

mt_addr mt_resolve_addr(const mt_model *m, mt_num num)
{
    return num == MT_ABSENT ? MT_NO_ADDR : m->nums[num].addr;
}

void mt_resolve_unknown(mt_resolve *f, mt_name name, const mt_names *table, const char *what,
                        const char *const *more, int n_more)
{
    if (!mt_diag_may_suggest(f->d)) {
        mt_diag_error(f->d, name.addr, "unknown %s \"%s\"", what, name.s);
        return;
    }
    const mt_arena_mark mark = mt_arena_get_mark(&f->m->mem);
    const char **const names =
        mt_arena_alloc(&f->m->mem, (size_t)table->count + (size_t)n_more, sizeof *names);
    if (names == NULL) {
        return;
    }
    int n = 0;
    for (int i = 0; i < n_more; i++) {
        names[n++] = more[i];
    }
    for (int i = 0; i < table->count; i++) {
        names[n++] = table->items[i].name;
    }
    const char *const near = mt_text_nearest(name.s, names, n);
    mt_arena_rewind(&f->m->mem, mark);
    if (near != NULL) {
        mt_diag_error(f->d, name.addr, "unknown %s \"%s\"; did you mean \"%s\"?", what, name.s,
                      near);
    } else {
        mt_diag_error(f->d, name.addr, "unknown %s \"%s\"", what, name.s);
    }
}

int mt_resolve_find(mt_resolve *f, mt_name name, const mt_names *table, const char *what)
{
    if (name.s == NULL) {
        return MT_ABSENT;
    }
    bool found = false;
    const int i = mt_names_find(table, name.s, strlen(name.s), &found);
    if (!found) {
        mt_resolve_unknown(f, name, table, what, NULL, 0);
    }
    return i;
}

void mt_resolve_position(mt_resolve *f, mt_position *p)
{
    p->point = mt_resolve_find(f, p->point_name, &f->m->tables->points, "point");
}

static const mt_num *coordinates(const mt_model *m, const mt_position *p)
{
    return p->point == MT_ABSENT ? p->x : m->points[p->point].x;
}

static bool same_number(const mt_model *m, mt_num a, mt_num b)
{
    if (a == b || a == MT_ABSENT || b == MT_ABSENT) {
        return a == b;
    }
    const mt_expr *const x = &m->nums[a].expr;
    const mt_expr *const y = &m->nums[b].expr;
    bool same = x->length == y->length;
    for (int i = 0; i < x->length && same; i++) {
        const mt_code *const p = &x->code[i];
        const mt_code *const q = &y->code[i];
        same = p->op == q->op && (p->op != MT_OP_PARAM || p->param == q->param) &&
               (p->op != MT_OP_CONST || !(p->value < q->value || p->value > q->value));
    }
    return same;
}

bool mt_resolve_same_position(const mt_model *m, const mt_position *a, const mt_position *b)
{
    const mt_num *const x = coordinates(m, a);
    const mt_num *const y = coordinates(m, b);
    return same_number(m, x[0], y[0]) && same_number(m, x[1], y[1]) &&
           same_number(m, x[2], y[2]);
}

/* Enter one name; a second use is noted. */
static void enter(mt_resolve *f, mt_names *table, mt_name name, int value, const char *what)
{
    bool taken = false;
    if (name.s == NULL) {
        return;
    }
    mt_names_add(table, &f->m->mem, name.s, value, &taken);
    if (taken) {
        mt_diag_error(f->d, name.addr, "the name \"%s\" is taken by another %s", name.s, what);
    }
}

/* One name space: a list of items with a member `name`. */
#define ENTER_ALL(f, table, list, what)                                      \
    for (int i = 0; i < (f)->m->n_##list; i++) {                             \
        enter((f), &(f)->m->tables->table, (f)->m->list[i].name, i, (what)); \
    }

static void resolve_names(mt_resolve *f)
{
    mt_model *const m = f->m;
    *m->tables = (mt_model_names){0};
    for (int i = 0; i < m->n_parameters; i++) {
        const mt_name name = m->parameters[i].name;
        if (name.s != NULL && mt_expr_reserved(name.s)) {
            mt_diag_error(f->d, name.addr, "\"%s\" is a function or constant of expressions",
                          name.s);
        }
    }
    ENTER_ALL(f, parameters, parameters, "parameter")
    ENTER_ALL(f, points, points, "point")
    ENTER_ALL(f, bodies, bodies, "body or link")
    for (int i = 0; i < m->n_links; i++) {
        enter(f, &m->tables->bodies, m->links[i].name, -1 - i, "body or link");
    }
    ENTER_ALL(f, joints, joints, "joint")
    ENTER_ALL(f, springs, springs, "spring or damper")
    ENTER_ALL(f, loads, loads, "load")
    ENTER_ALL(f, sensors, sensors, "sensor")
    ENTER_ALL(f, modes, modes, "mode")
    ENTER_ALL(f, configurations, configurations, "configuration")
    bool found = false;
    const int i = mt_names_find(&m->tables->bodies, "ground", strlen("ground"), &found);
    if (found) {
        const mt_name name = i >= 0 ? m->bodies[i].name : m->links[-1 - i].name;
        mt_diag_error(f->d, name.addr, "\"ground\" is the fixed world and cannot be a name");
    }
}

static void resolve_bodies(mt_resolve *f)
{
    for (int i = 0; i < f->m->n_bodies; i++) {
        mt_resolve_position(f, &f->m->bodies[i].centre);
    }
}

/* A model without configurations has one, "default". */
static void ensure_configuration(mt_resolve *f)
{
    mt_model *const m = f->m;
    if (m->n_configurations > 0) {
        return;
    }
    m->configurations = mt_arena_alloc(&m->mem, 1, sizeof *m->configurations);
    if (m->configurations == NULL) {
        return;
    }
    m->n_configurations = 1;
    m->cap_configurations = 1;
    m->configurations[0] =
        (mt_configuration){.name = {.s = "default", .addr = MT_NO_ADDR}, .like = MT_ABSENT};
    m->configurations[0].like_name.addr = MT_NO_ADDR;
    for (int k = 0; k < 3; k++) {
        m->configurations[0].gravity[k] = MT_ABSENT;
    }
}

/* Check the cost of all configurations together. Beyond the limit, nothing else is checked. */
static bool fits(const mt_model *m, mt_diags *diags)
{
    const double parts = (double)m->n_nums + m->n_bodies + m->n_links + m->n_joints +
                         m->n_springs + m->n_loads + m->n_sensors;
    if (m->n_configurations < 2 || (double)m->n_configurations * parts <= MT_MAX_CONFIGURED) {
        return true;
    }
    mt_diag_error(diags, m->configurations[0].name.addr,
                  "%d configurations of %.0f numbers and items are too many: at most %d as the "
                  "product",
                  m->n_configurations, parts, (int)MT_MAX_CONFIGURED);
    return false;
}

mt_status mt_model_resolve(mt_model *model, mt_diags *diags, mt_err *err)
{
    static void (*const stages[])(mt_resolve *) = {
        ensure_configuration, resolve_names,      mt_resolve_configurations,
        mt_resolve_presence,  resolve_bodies,     mt_resolve_links,
        mt_resolve_joints,    mt_resolve_springs, mt_resolve_loads,
        mt_resolve_sensors,   mt_resolve_drives,  mt_resolve_cycles,
        mt_resolve_values,
    };
    mt_resolve f = {.m = model, .d = diags};
    const int n_stages = fits(model, diags) ? MT_COUNT(stages) : 0;
    for (int i = 0; i < n_stages && !mt_arena_failed(&model->mem); i++) {
        stages[i](&f);
    }
    MT_TRY(mt_arena_check(&model->mem, err));
    MT_TRY(mt_arena_check(diags->mem, err));
    if (diags->errors > 0) {
        return mt_fail(err, MT_E_INPUT, "%s%s", diags->count > 0 ? diags->items[0].text : "",
                       diags->errors > 1 ? " (and more)" : "");
    }
    return MT_OK;
}
