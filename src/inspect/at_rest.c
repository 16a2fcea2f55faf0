/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "inspect/at_rest.h"

#include <math.h>
#include <string.h>

#include "base/format.h"
#include "base/number.h"
#include "base/text.h"
#include "mechanics/statics.h"
#include "response/ports.h"

/* So many numbers are read. */
enum { MOST = 2000 };
/* Where joints are redundant, each number of one takes a solution of all equations, nq^2: so
 * many multiplications together. */
static const double WORK = 2e9;
/* Of the largest number of its unit: below it there is rounding alone. */
static const double NOISE = 1e-12;

#define THIS mt_rest_row
static const mt_field rest_fields[] = {
    MT_F_TEXT("output", output, "What it is, as goals of type \"static\" name it."),
    MT_F_NUMBER_OR_NULL("value", value, "Its number; null: it is not determined."),
    MT_F_TEXT("unit", unit, "Its unit."),
    MT_F_TEXT_OR_NULL("why", why, "Why it is not determined; null: it is."),
};
const mt_record mt_rest_record =
    MT_F_RECORD_OF(rest_fields, "at_rest", "A displacement or a force at rest.");
#undef THIS

typedef struct listing {
    mt_analysis *a;
    mt_arena *mem;
    mt_rest_rows *out;
    int room;
    int most;
} listing;

/* One more, by its name (NULL: memory is out). */
static mt_status add(listing *l, const char *name, mt_err *err)
{
    mt_rest_rows *const out = l->out;
    mt_port port;
    mt_err own = {.code = MT_OK};
    double value = nan("");
    if (out->n >= l->most) {
        out->left_out++;
        return MT_OK;
    }
    mt_rest_row *const rows = mt_arena_grow(l->mem, out->rows, out->n, &l->room, sizeof *rows);
    MT_TRY(mt_arena_check(l->mem, err));
    out->rows = rows;
    mt_status rc = mt_port_at_rest(l->a->sys, name, l->mem, &port, &own);
    if (rc == MT_E_USAGE) {
        return MT_OK; /* elements of one name without a single force */
    }
    if (rc != MT_OK) {
        return mt_fail(err, rc, "%s", own.text);
    }
    const mt_static q = mt_port_static(&port);
    rc = mt_static_value(l->a->lin, &q, &value, &own);
    if (rc != MT_OK && rc != MT_E_USAGE) {
        return mt_fail(err, rc, "%s", own.text);
    }
    rows[out->n++] = (mt_rest_row){
        .output = name,
        .value = rc == MT_OK ? value : nan(""),
        .unit = q.kind == MT_STATIC_SENSOR ? (port.turns ? "rad" : "m") : port.unit,
        .why = rc == MT_OK ? NULL : mt_arena_strdup(l->mem, own.text)};
    return mt_arena_check(l->mem, err);
}

static const char *const COMPONENTS[2][6] = {{"x", "y", "rz", NULL, NULL, NULL},
                                             {"x", "y", "z", "rx", "ry", "rz"}};

static mt_status add_components(listing *l, const char *of, const char *name, bool bushing,
                                mt_err *err)
{
    const bool plane = l->a->sys->dimension == 2;
    for (int k = 0; k < (plane ? 3 : 6); k++) {
        const char *const last =
            bushing && plane && k == 2 ? "r" : COMPONENTS[plane ? 0 : 1][k];
        MT_TRY(add(l, mt_arena_printf(l->mem, "%s.%s.%s", of, name, last), err));
    }
    return MT_OK;
}

/* Springs and equations of a joint's compliance have their force in common with the joint,
 * which tells it. */
static bool is_bearing(const char *name)
{
    const char *const last = name == NULL ? NULL : strrchr(name, '.');
    return last != NULL && strcmp(last, ".bearing") == 0;
}

/* Forces of the springs that have a name: of the elements of a bushing its components; beams
 * have none by themselves. */
static mt_status list_springs(listing *l, mt_err *err)
{
    const mt_system *const sys = l->a->sys;
    for (int i = 0; i < sys->n_springs;) {
        const mt_spring_def *const s = &sys->springs[i];
        const mt_measure_kind kind = sys->measures[s->measure[0]].kind;
        int end = i + 1;
        while (end < sys->n_springs && s->name != NULL && sys->springs[end].name != NULL &&
               strcmp(s->name, sys->springs[end].name) == 0) {
            end++;
        }
        const bool bushing = kind == MT_MEASURE_PLANE || kind == MT_MEASURE_ROTATION;
        if (s->name != NULL && !s->damper && kind != MT_MEASURE_BEAM && !is_bearing(s->name)) {
            MT_TRY(bushing && end > i + 1
                       ? add_components(l, "spring", s->name, true, err)
                       : add(l, mt_arena_printf(l->mem, "spring.%s", s->name), err));
        }
        i = end;
    }
    return MT_OK;
}

mt_status mt_rest_rows_of(mt_analysis *a, mt_arena *mem, mt_rest_rows *out, mt_err *err)
{
    const mt_system *const sys = a->sys;
    listing l = {.a = a, .mem = mem, .out = out, .most = MOST};
    *out = (mt_rest_rows){.n = 0};
    if (!mt_linear_position(a->lin)->equilibrium.active) {
        return MT_OK;
    }
    for (int i = 0; i < sys->n_channels; i++) {
        MT_TRY(add(&l, sys->channels[i].name, err));
    }
    MT_TRY(list_springs(&l, err));
    if (mt_linear_redundant(a->lin) > 0) {
        const double more = WORK / ((double)sys->nq * sys->nq);
        l.most = (int)fmin(MOST, out->n + more);
    }
    for (int i = 0; i < sys->n_joints; i++) {
        const mt_system_joint *const j = &sys->joints[i];
        if (!mt_joint_kind_of(j->type)->couples && !is_bearing(j->name)) {
            MT_TRY(add_components(&l, "joint", j->name, false, err));
        }
        const int drive = mt_system_drive_of(sys, i);
        if (drive >= 0 && sys->drives[drive].spring < 0) {
            MT_TRY(add(&l, mt_arena_printf(mem, "joint.%s.hold", j->name), err));
        }
    }
    return MT_OK;
}

int mt_rest_owner(const mt_rest_row *row)
{
    const char *const dot = strrchr(row->output, '.');
    const bool spring = strncmp(row->output, "spring.", strlen("spring.")) == 0;
    const bool whole = spring && dot == strchr(row->output, '.');
    return whole ? (int)strlen(row->output) : (int)(dot - row->output);
}

/* The noise of numbers of this unit. */
static double noise_of(const mt_rest_rows *rows, const char *unit)
{
    double largest = 0.0;
    for (int i = 0; i < rows->n; i++) {
        const bool same = strcmp(rows->rows[i].unit, unit) == 0;
        largest = same ? fmax(largest, fabs(rows->rows[i].value)) : largest;
    }
    return NOISE * largest;
}

const char *mt_rest_text(const mt_rest_rows *rows, int from, int end, int digits, mt_arena *mem)
{
    mt_text text = {.s = NULL};
    for (int i = from; i < end; i++) {
        const mt_rest_row *const row = &rows->rows[i];
        const char *const name = row->output + mt_rest_owner(row);
        const bool other = i > from && strcmp(row->unit, row[-1].unit) != 0;
        const double shown = mt_without_noise(row->value, noise_of(rows, row->unit));
        mt_text_addf(&text, "%s%s%s%s%s", other ? " " : "", other ? row[-1].unit : "",
                     i == from ? ""
                     : other   ? "; "
                               : ", ",
                     name[0] == '.' ? name + 1 : "", name[0] == '.' ? " " : "");
        if (row->why != NULL) {
            mt_text_add(&text, "not determined");
        } else {
            mt_text_addf(&text, "%.*g", digits, shown);
        }
    }
    mt_text_addf(&text, " %s", end > from ? rows->rows[end - 1].unit : "");
    const char *const out = text.failed || text.s == NULL ? NULL : mt_arena_strdup(mem, text.s);
    if (text.failed) {
        mt_arena_fail(mem);
    }
    mt_text_free(&text);
    return out;
}
