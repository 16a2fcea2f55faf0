/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What the numbers of a configuration can be, and what they hardly are. A fault is what no
 * mechanism has (a mass below 0); a doubt is what is allowed, but what a slip of units makes:
 * millimetres for metres, MPa for Pa, t/mm^3 for kg/m^3. Limits are wide on purpose: a good
 * model is not warned of.
 */
#include "model/lint.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "base/format.h"
#include "expr/kind.h"
#include "expr/op.h"
#include "model/lint_geometry.h"
#include "model/values.h"

/* Tensors of inertia: I = tr(S) E - S with S = int x x^T dm, so that S = tr(I) E / 2 - I has no
 * negative eigenvalue: of moments A, B, C none is more than the other two together. */

enum { AXES = 3 };
/* Of the trace: what three digits of each moment leave open. A plate's moments A + B = C that
 * were rounded one by one are no fault. */
static const double INERTIA_ROUNDING = 1e-3;

/* True where the symmetric 3 x 3 matrix xx yy zz xy xz yz has no eigenvalue below -noise, by
 * its principal minors, each with the effect of `noise` on the diagonal. */
static bool is_positive(const double v[6], double noise)
{
    const double a = v[0] + noise;
    const double b = v[1] + noise;
    const double c = v[2] + noise;
    const double ab = (a * b) - (v[3] * v[3]);
    const double ac = (a * c) - (v[4] * v[4]);
    const double bc = (b * c) - (v[5] * v[5]);
    const double det = (a * bc) - (v[3] * ((v[3] * c) - (v[5] * v[4]))) +
                       (v[4] * ((v[3] * v[5]) - (b * v[4])));
    return a >= 0.0 && b >= 0.0 && c >= 0.0 && ab >= 0.0 && ac >= 0.0 && bc >= 0.0 &&
           det >= 0.0;
}

/* Reason why no body has the tensor xx yy zz xy xz yz (moments not negative), and the index *at
 * of the moment in question; NULL: a body can have it. */
static const char *lint_tensor(mt_lint *j, const double v[6], int *at)
{
    static const double ROUNDING = 1e-12; /* of the trace */
    double largest = 0.0;
    double u[6]; /* in parts of the trace */
    *at = 0;
    for (int k = 0; k < 6; k++) {
        largest = fmax(largest, fabs(v[k]));
    }
    const double trace =
        largest > 0.0 ? (v[0] / largest) + (v[1] / largest) + (v[2] / largest) : 1.0;
    for (int k = 0; k < 6; k++) {
        u[k] = largest > 0.0 ? v[k] / largest / trace : 0.0;
    }
    if (!(trace > 0.0) || !is_positive(u, ROUNDING)) {
        return "belongs to a tensor with a negative principal moment: its products of inertia "
               "are too large";
    }
    for (int k = 0; k < 6; k++) {
        u[k] = k < AXES ? 0.5 - u[k] : -u[k];
    }
    if (largest == 0.0 || is_positive(u, INERTIA_ROUNDING)) {
        return NULL;
    }
    for (int k = 0; k < AXES; k++) {
        if (u[k] < -INERTIA_ROUNDING) {
            *at = k;
            return mt_arena_printf(
                j->out->mem,
                "is more than the other two moments together (%g + %g), which "
                "no body has",
                v[(k + 1) % AXES], v[(k + 2) % AXES]);
        }
    }
    return "belongs to a tensor that no body has: its largest principal moment is more than "
           "the "
           "other two together";
}

/* Damping: what takes energy out is not negative, and what a slip of units makes is doubted. */

/* Whose damping it is: NULL the model's, else the configuration that gives it. */
static const mt_configuration *owner_of(const mt_lint *j)
{
    int c = j->configuration;
    while (c != MT_ABSENT && j->model->configurations[c].damping.inherited) {
        c = j->model->configurations[c].like;
    }
    return c == MT_ABSENT ? NULL : &j->model->configurations[c];
}

/* A member of the damping, or an entry of it (a mode's name, an index). */
typedef struct place {
    const char *member;
    const char *entry; /* NULL: none */
} place;

/* The entry as a JSON pointer has it. NULL where memory is out. */
static const char *escaped(mt_arena *mem, const char *entry)
{
    char *const text = mt_arena_alloc(mem, (2 * strlen(entry)) + 1, 1);
    size_t n = 0;
    for (const char *c = entry; text != NULL && *c != '\0'; c++) {
        if (*c == '~' || *c == '/') {
            const char digit = *c == '~' ? '0' : '1';
            text[n++] = '~';
            text[n++] = digit;
        } else {
            text[n++] = *c;
        }
    }
    return text;
}

static void report_damping(mt_lint *j, mt_num num, const place *at, mt_warning_level level,
                           const char *why)
{
    mt_arena *const mem = j->out->mem;
    const mt_configuration *const owner = owner_of(j);
    const char *const slash = at->entry == NULL ? "" : "/";
    const char *const shown = at->entry == NULL ? "" : at->entry;
    mt_warning *const warning = mt_warning_add(
        j->out, level, level == MT_LEVEL_FAULT ? "value" : "damping",
        "damping%s%s%s: %s%s%s (%g) %s", owner == NULL ? "" : " of configuration \"",
        owner == NULL ? "" : owner->name.s, owner == NULL ? "" : "\"", at->member, slash, shown,
        j->value[num], why);
    const char *const entry = at->entry == NULL ? "" : escaped(mem, at->entry);
    if (entry == NULL) {
        return;
    }
    const char *const pointer =
        owner == NULL ? mt_arena_printf(mem, "/damping/%s%s%s", at->member, slash, entry)
                      : mt_arena_printf(mem, "/configurations/%s/damping/%s%s%s", owner->name.s,
                                        at->member, slash, entry);
    (void)mt_lint_addr(j, warning, j->model->nums[num].addr, pointer);
}

static void coefficient(mt_lint *j, mt_num num, const place *at)
{
    if (num == MT_ABSENT) {
        return;
    }
    const mt_possible *const p = &mt_possible_of[j->model->nums[num].possible];
    const double v = j->value[num];
    const char *const doubted = mt_possible_doubted(p, v);
    if (!mt_possible_is(p, v)) {
        report_damping(j, num, at, MT_LEVEL_FAULT, p->impossible);
    } else if (doubted != NULL) {
        report_damping(j, num, at, MT_LEVEL_WARNING,
                       mt_arena_printf(j->out->mem, "is %s", doubted));
    }
}

static void ratio(mt_lint *j, mt_num num, const char *member, const char *entry)
{
    const place at = {member, entry};
    coefficient(j, num, &at);
}

/* The damping in force. */
static void lint_damping_in_force(mt_lint *j)
{
    const mt_damping *const d = &j->model->configurations[j->configuration].damping;
    if (!d->given) {
        return;
    }
    ratio(j, d->ratio, "ratio", NULL);
    for (int i = 0; i < d->n_ratios; i++) {
        ratio(j, d->ratios[i], "ratios", mt_arena_printf(j->out->mem, "%d", i));
    }
    for (int i = 0; i < d->n_named; i++) {
        ratio(j, d->named[i].ratio, "modes", d->named[i].mode_name.s);
    }
    coefficient(j, d->mass, &(const place){"mass_per_s", NULL});
    coefficient(j, d->stiffness, &(const place){"stiffness_s", NULL});
}

/*
 * Units of expressions: whole ones, which their reader has looked at, and angles. What goes
 * into sin, cos or tan is in rad. A part of it that has no unit (no parameter with a unit of
 * angles, no "*deg", no pi) and is more than a whole turn is in degrees, most likely. Each
 * expression is walked once: b is the part without unit of v,
 *     number, parameter: b = v; with a unit of angles: b = 0;   a + b: both parts;
 *     a * b, one of them with a unit: its b times the other's v;   anything else of numbers: v.
 */

static const double WHOLE_TURN = 6.283185307179586;

typedef struct part {
    double value;
    double bare;   /* the part of it without a unit */
    bool unit;     /* some of it has a unit of angles */
    int parameter; /* what makes it large; MT_ABSENT: a number of the expression */
} part;

/* The number that gives a parameter its value here. */
static mt_num number_of_parameter(const mt_lint *j, int parameter)
{
    const mt_configuration *const c = &j->model->configurations[j->configuration];
    for (int i = 0; i < c->n_overrides; i++) {
        if (c->overrides[i].parameter == parameter) {
            return c->overrides[i].value;
        }
    }
    return j->model->parameters[parameter].value;
}

static part leaf(const mt_lint *j, const mt_code *c)
{
    if (c->op == MT_OP_PARAM) {
        const mt_kind kind = mt_model_kind(j->model, c->param);
        const mt_num num = number_of_parameter(j, c->param);
        const double v = num == MT_ABSENT ? nan("") : j->value[num];
        const bool unit = kind == MT_KIND_ANGLE || kind == MT_KIND_PI;
        return (part){v, unit ? 0.0 : v, unit, c->param};
    }
    const bool unit = c->param == MT_KIND_ANGLE || c->param == MT_KIND_PI;
    return (part){c->value, unit ? 0.0 : c->value, unit, MT_ABSENT};
}

static part unary(mt_op op, const part *a)
{
    const double v = mt_op_value(op, a->value, 0.0);
    switch ((int)op) {
    case MT_OP_NEG:
        return (part){v, -a->bare, a->unit, a->parameter};
    case MT_OP_ABS:
        return (part){v, fabs(a->bare), a->unit, a->parameter};
    case MT_OP_ASIN:
    case MT_OP_ACOS:
    case MT_OP_ATAN:
        return (part){v, 0.0, true, MT_ABSENT};
    case MT_OP_IF:
        return *a;
    default:
        return (part){v, v, false, a->parameter};
    }
}

static part binary(mt_op op, const part *a, const part *b)
{
    const double v = mt_op_value(op, a->value, b->value);
    const int larger = fabs(a->bare) >= fabs(b->bare) ? a->parameter : b->parameter;
    if (op == MT_OP_THEN) { /* a: the condition */
        return a->value != 0.0 ? *b : (part){.value = nan(""), .parameter = MT_ABSENT};
    }
    if (op == MT_OP_ELSE) {
        return isnan(a->value) ? *b : *a;
    }
    if (op == MT_OP_ADD || op == MT_OP_SUB) {
        const double bare = op == MT_OP_ADD ? a->bare + b->bare : a->bare - b->bare;
        return (part){v, bare, a->unit || b->unit, larger};
    }
    if (op == MT_OP_ATAN2) {
        return (part){v, 0.0, true, MT_ABSENT};
    }
    if (!a->unit && !b->unit) {
        const bool named = a->parameter != MT_ABSENT;
        return (part){v, v, false, named ? a->parameter : b->parameter};
    }
    if (op == MT_OP_MUL && a->unit != b->unit) {
        return (part){v, a->unit ? a->bare * b->value : b->bare * a->value, true, larger};
    }
    if (op == MT_OP_DIV && a->unit && !b->unit) {
        return (part){v, a->bare / b->value, true, larger};
    }
    return (part){v, 0.0, true, MT_ABSENT};
}

/* True where this number has been reported here. An argument of cos() is reported for sin() as
 * well. */
static bool is_said(const mt_lint *j, mt_addr addr)
{
    const char *const here = j->model->configurations[j->configuration].name.s;
    for (int i = 0; i < j->out->n; i++) {
        const mt_warning *const d = &j->out->items[i];
        if (d->addr == addr && strcmp(d->kind, "angle") == 0 && d->configuration == here) {
            return true;
        }
    }
    return false;
}

static void warn_of_degrees(mt_lint *j, mt_num num, const part *angle, const char *function)
{
    const bool named = angle->parameter != MT_ABSENT;
    const mt_num given = named ? number_of_parameter(j, angle->parameter) : num;
    const double own = named ? j->value[given] : nan("");
    const bool whole = fabs(own) > WHOLE_TURN && !(fabs(own - angle->bare) > 0.0);
    const mt_addr addr = j->model->nums[whole ? given : num].addr;
    if (is_said(j, addr)) {
        return;
    }
    mt_warning *const warning =
        whole
            ? mt_warning_add(
                  j->out, MT_LEVEL_WARNING, "angle",
                  "\"%s\" is %g, without a unit, and an angle of a trigonometric "
                  "function: %g rad are more than a turn; if degrees are meant, give "
                  "it \"unit\": \"deg\"",
                  j->model->parameters[angle->parameter].name.s, own, own)
            : mt_warning_add(j->out, MT_LEVEL_WARNING, "angle",
                             "%s() of %g, without a unit: %g rad are more than a turn; degrees "
                             "are written \"%g*deg\"",
                             function, angle->bare, angle->bare, angle->bare);
    (void)mt_lint_addr(j, warning, addr, NULL);
}

static const char *function_of(mt_op op)
{
    return op == MT_OP_SIN ? "sin" : op == MT_OP_COS ? "cos" : op == MT_OP_TAN ? "tan" : NULL;
}

static bool has_function(const mt_expr *e)
{
    for (int i = 0; i < e->length; i++) {
        if (function_of(e->code[i].op) != NULL) {
            return true;
        }
    }
    return false;
}

static void lint_number(mt_lint *j, mt_num num, part *stack)
{
    const mt_expr *const e = &j->model->nums[num].expr;
    int n = 0;
    if (!has_function(e)) {
        return;
    }
    for (int i = 0; i < e->length; i++) {
        const mt_code *const c = &e->code[i];
        const char *const function = function_of(c->op);
        const int operands = mt_op_operands(c->op);
        if (operands <= 0) {
            stack[n++] = leaf(j, c);
            continue;
        }
        if (n < operands) { /* no expression that was parsed */
            return;
        }
        if (function != NULL && fabs(stack[n - 1].bare) > WHOLE_TURN) {
            warn_of_degrees(j, num, &stack[n - 1], function);
            return;
        }
        if (operands == 1) {
            stack[n - 1] = unary(c->op, &stack[n - 1]);
        } else {
            stack[n - 2] = binary(c->op, &stack[n - 2], &stack[n - 1]);
            n--;
        }
    }
}

/* Angles without a unit beyond a turn. */
static void lint_angles(mt_lint *j)
{
    part stack[MT_EXPR_MAX_CODE];
    for (mt_num num = 0; num < j->model->n_nums; num++) {
        lint_number(j, num, stack);
    }
}

/* Numbers in other units than their members, as found by the reader. */
static void lint_units(mt_lint *j)
{
    for (mt_num num = 0; num < j->model->n_nums; num++) {
        const mt_number *const number = &j->model->nums[num];
        if (number->unit_warning != NULL) {
            (void)mt_lint_addr(
                j, mt_warning_add(j->out, MT_LEVEL_WARNING, "unit", "%s", number->unit_warning),
                number->addr, NULL);
        }
    }
}

/* What a configuration's own setting drops of the one that it would inherit: it takes the place
 * of the whole of the other. */

static void warn_of_dropped_member(mt_lint *j, mt_addr addr, const char *member,
                                   const char *text)
{
    (void)mt_lint_addr(
        j, mt_warning_add(j->out, MT_LEVEL_WARNING, "dropped", "%s", text == NULL ? "" : text),
        addr,
        mt_arena_printf(j->out->mem, "/configurations/%s/%s",
                        j->model->configurations[j->configuration].name.s, member));
}

/* The same joint, trimmed by the inherited drive and locked by the own one, which does not
 * mention the hold. */
static void lint_hold(mt_lint *j, const mt_drive *own, const mt_configuration *parent)
{
    const mt_drive *other = NULL;
    for (int i = 0; i < parent->n_drives; i++) {
        other = parent->drives[i].joint == own->joint ? &parent->drives[i] : other;
    }
    if (own->owner == j->configuration && other != NULL && other->trim && !own->hold_given) {
        warn_of_dropped_member(
            j, own->addr,
            own->item < 0 ? "drive" : mt_arena_printf(j->out->mem, "drive/%d", own->item),
            mt_arena_printf(j->out->mem,
                            "drops the inherited \"hold\", which trims \"%s\": this drive "
                            "locks \"%s\"; write \"hold\": \"lock\" if that is meant",
                            other->trim_name.s == NULL ? "" : other->trim_name.s,
                            own->joint_name.s == NULL ? "" : own->joint_name.s));
    }
}

static void lint_damping(mt_lint *j, const mt_damping *own, const mt_damping *other)
{
    const struct {
        bool dropped;
        const char *member;
    } members[] = {
        {other->ratio != MT_ABSENT && own->ratio == MT_ABSENT, "ratio"},
        {other->n_ratios > 0 && own->n_ratios == 0, "ratios"},
        {other->n_named > 0 && own->n_named == 0, "modes"},
        {other->mass != MT_ABSENT && own->mass == MT_ABSENT, "mass_per_s"},
        {other->stiffness != MT_ABSENT && own->stiffness == MT_ABSENT, "stiffness_s"},
    };
    const char *dropped = NULL;
    for (int i = 0; i < MT_COUNT(members) && own->given && !own->inherited; i++) {
        if (other->given && members[i].dropped) {
            dropped = mt_arena_printf(j->out->mem, "%s%s\"%s\"", dropped == NULL ? "" : dropped,
                                      dropped == NULL ? "" : ", ", members[i].member);
        }
    }
    if (dropped != NULL) {
        warn_of_dropped_member(
            j, own->addr, "damping",
            mt_arena_printf(j->out->mem,
                            "drops the inherited %s: a configuration's own damping takes the "
                            "place of all that it would inherit",
                            dropped));
    }
}

/* Inherited settings that its own drives and damping drop. */
static void lint_inherited(mt_lint *j)
{
    const mt_configuration *const c = &j->model->configurations[j->configuration];
    const mt_configuration *const parent =
        c->like == MT_ABSENT ? NULL : &j->model->configurations[c->like];
    for (int i = 0; i < c->n_drives && parent != NULL; i++) {
        lint_hold(j, &c->drives[i], parent);
    }
    lint_damping(j, &c->damping, parent == NULL ? &j->model->damping : &parent->damping);
}

/* rad: more than one turn from the reference position is degrees, or a motor's shaft. */
static const double ONE_TURN = 6.283185307179586;

static double value_of_number(const mt_lint *j, mt_num num)
{
    return num == MT_ABSENT ? nan("") : j->value[num];
}

static void locate_item_member(mt_lint *j, mt_warning *warning, const mt_item *item, mt_num num,
                               const char *member)
{
    const char *const pointer =
        mt_arena_printf(j->out->mem, "/%s/%d/%s", item->list, item->index, member);
    (void)mt_lint_addr(j, warning, j->model->nums[num].addr, pointer);
}

/* Why a number has no value, as "sqrt(-3) has no finite value", in the list's memory; NULL: it
 * has one, or a parameter in it has none, which is told there. */
static const char *why_no_value(const mt_lint *j, mt_num num)
{
    const mt_model *const m = j->model;
    mt_arena *const mem = j->out->mem;
    if (num == MT_ABSENT || !isnan(j->value[num])) {
        return NULL;
    }
    double *const values = mt_arena_f64(mem, (size_t)m->n_parameters, 1);
    if (values == NULL) {
        return NULL;
    }
    for (int i = 0; i < m->n_parameters; i++) {
        values[i] = value_of_number(j, number_of_parameter(j, i));
    }
    const mt_expr *const e = &m->nums[num].expr;
    for (int i = 0; i < e->length; i++) {
        if (e->code[i].op == MT_OP_PARAM && isnan(values[e->code[i].param])) {
            return NULL;
        }
    }
    double value = 0.0;
    mt_err err = {MT_OK, ""};
    return mt_model_expr_value(m, values, e, mem, &value, &err) == MT_E_DOMAIN
               ? mt_arena_printf(mem, "%s", err.text)
               : NULL;
}

static void fault(mt_lint *j, const mt_item *item, mt_num num, const char *member,
                  const char *why)
{
    locate_item_member(j,
                       mt_warning_add(j->out, MT_LEVEL_FAULT, "value", "%s \"%s\": %s (%g) %s",
                                      item->what, item->name, member, j->value[num],
                                      why == NULL ? "" : why),
                       item, num, member);
}

/* A gear that passes nothing on. */
static void nonzero(mt_lint *j, const mt_item *item, mt_num num, const char *member)
{
    if (num != MT_ABSENT && j->value[num] == 0.0) {
        fault(j, item, num, member,
              "must not be 0: the joints would have nothing to do with "
              "each other");
    }
}

/* By the row that the member's table names. Returns false where it is impossible. */
static bool lint_item_number(mt_lint *j, const mt_item *item, mt_num num, const char *member)
{
    if (num == MT_ABSENT) {
        return true;
    }
    const mt_possible *const p = &mt_possible_of[j->model->nums[num].possible];
    const double v = j->value[num];
    if (!mt_possible_is(p, v)) {
        fault(j, item, num, member, p->impossible);
        return false;
    }
    const char *const doubted = mt_possible_doubted(p, v);
    if (doubted != NULL) {
        locate_item_member(j,
                           mt_warning_add(j->out, MT_LEVEL_WARNING, p->warning,
                                          "%s \"%s\": %s (%g) is %s", item->what, item->name,
                                          member, v, doubted),
                           item, num, member);
    }
    return true;
}

static void inertia(mt_lint *j, const mt_item *item, const mt_body *b)
{
    static const char *const members[] = {"inertia_kg_m2/0", "inertia_kg_m2/1",
                                          "inertia_kg_m2/2"};
    const bool plane = j->model->dimension == 2;
    double v[6];
    bool possible = true;
    for (int k = 0; k < (plane ? 1 : 3); k++) {
        possible =
            lint_item_number(j, item, b->inertia[k], plane ? "inertia_kg_m2" : members[k]) &&
            possible;
    }
    for (int k = 0; k < 6 && !plane; k++) {
        v[k] = b->inertia[k] == MT_ABSENT ? 0.0 : j->value[b->inertia[k]];
    }
    if (plane || !possible) {
        return;
    }
    int at = 0;
    const char *const why = lint_tensor(j, v, &at);
    if (why != NULL) {
        fault(j, item, b->inertia[at], members[at], why);
    }
}

static void lint_bodies(mt_lint *j)
{
    for (int i = 0; i < j->model->n_bodies; i++) {
        const mt_body *const b = &j->model->bodies[i];
        const mt_item item = {"body", "bodies", i, b->name.s};
        if (mt_model_present(&b->in, j->configuration)) {
            (void)lint_item_number(j, &item, b->mass, "mass_kg");
            if (!b->point_mass) {
                inertia(j, &item, b);
            }
        }
    }
}

static void listed(mt_lint *j, const mt_item *item, int n, const mt_num *list,
                   const char *member)
{
    for (int k = 0; k < n; k++) {
        char entry[64]; /* a list of one may be written as a number */
        (void)mt_snprintf(entry, sizeof entry, n > 1 ? "%s/%d" : "%s", member, k);
        (void)lint_item_number(j, item, list[k], entry);
    }
}

static void lint_section(mt_lint *j, const mt_item *item, const mt_section *s)
{
    const bool tube = s->shape == MT_SECTION_TUBE;
    const char *const outer = tube ? "section/outer_diameter_m" : "section/diameter_m";
    (void)lint_item_number(j, item, s->width, "section/width_m");
    (void)lint_item_number(j, item, s->height, "section/height_m");
    (void)lint_item_number(j, item, s->diameter, outer);
    (void)lint_item_number(j, item, s->inner_diameter, "section/inner_diameter_m");
    if (tube && value_of_number(j, s->inner_diameter) >= value_of_number(j, s->diameter)) {
        fault(j, item, s->inner_diameter, "section/inner_diameter_m",
              mt_arena_printf(j->out->mem,
                              "must be below outer_diameter_m (%g): the wall has no thickness",
                              value_of_number(j, s->diameter)));
    }
    (void)lint_item_number(j, item, s->area, "section/area_m2");
    (void)lint_item_number(j, item, s->second_moment, "section/second_moment_m4");
    (void)lint_item_number(j, item, s->second_moment_other, "section/second_moment_other_m4");
    (void)lint_item_number(j, item, s->torsion_constant, "section/torsion_constant_m4");
}

static void lint_shear(mt_lint *j, const mt_item *item, const mt_shear *s)
{
    (void)lint_item_number(j, item, s->coefficient, "shear/coefficient");
    (void)lint_item_number(j, item, s->coefficient_other, "shear/coefficient_other");
    (void)lint_item_number(j, item, s->poissons_ratio, "shear/poissons_ratio");
}

static void lint_links(mt_lint *j)
{
    for (int i = 0; i < j->model->n_links; i++) {
        const mt_link *const l = &j->model->links[i];
        const mt_item item = {"link", "links", i, l->name.s};
        if (!mt_model_present(&l->in, j->configuration)) {
            continue;
        }
        (void)lint_item_number(j, &item, l->mass, "mass_kg");
        (void)lint_item_number(j, &item, l->density, "density_kg_per_m3");
        (void)lint_item_number(j, &item, l->youngs_modulus, "youngs_modulus_pa");
        (void)lint_item_number(j, &item, l->shear_modulus, "shear_modulus_pa");
        lint_section(j, &item, &l->section);
        lint_shear(j, &item, &l->shear);
        listed(j, &item, l->n_stiffness, l->stiffness, "stiffness_n_m_per_rad");
        listed(j, &item, l->n_element_length, l->element_length, "element_length_m");
        listed(j, &item, l->n_element_mass, l->element_mass, "element_mass_kg");
        listed(j, &item, l->n_element_inertia, l->element_inertia, "element_inertia_kg_m2");
        (void)lint_item_number(j, &item, l->radius_of_gyration, "radius_of_gyration_m");
        (void)lint_item_number(j, &item, l->loss_factor, "loss_factor");
    }
}

static void lint_loss(mt_lint *j, const mt_item *item, const mt_loss *loss, const char *member)
{
    (void)lint_item_number(j, item, loss->all, member);
    listed(j, item, loss->n, loss->each, member);
}

/* A constant of a spring may be negative (a spring over its dead centre, a magnet, a load that
 * buckles); a bar is a piece of material. */
static void lint_springs(mt_lint *j)
{
    int dampers = 0;
    for (int i = 0; i < j->model->n_springs; i++) {
        const mt_spring *const s = &j->model->springs[i];
        const mt_item item = {s->damper ? "damper" : "spring",
                              s->damper ? "dampers" : "springs", s->damper ? dampers++ : i,
                              s->name.s};
        if (!mt_model_present(&s->in, j->configuration)) {
            continue;
        }
        (void)lint_item_number(j, &item, s->youngs_modulus, "youngs_modulus_pa");
        (void)lint_item_number(j, &item, s->area, "area_m2"); /* 0: a bar that may be added */
        (void)lint_item_number(j, &item, s->density, "density_kg_per_m3");
        (void)lint_item_number(j, &item, s->free_length, "free_length_m");
        lint_loss(j, &item, &s->loss, "loss_factor");
    }
}

static void lint_sensors(mt_lint *j)
{
    for (int i = 0; i < j->model->n_sensors; i++) {
        const mt_sensor *const s = &j->model->sensors[i];
        const mt_item item = {"sensor", "sensors", i, s->name.s};
        (void)lint_item_number(j, &item, s->fraction, "fraction");
    }
}

static void lint_compliance(mt_lint *j, const mt_item *item, const mt_compliance *c)
{
    const bool two = j->model->dimension == 2;
    const int first = two ? 2 : 0; /* of what turns */
    listed(j, item, two ? 2 : 3, c->translation, "compliance/stiffness_n_per_m");
    listed(j, item, 3 - first, c->rotation + first, "compliance/stiffness_n_m_per_rad");
    listed(j, item, two ? 2 : 3, c->damping_translation, "compliance/damping_n_s_per_m");
    listed(j, item, 3 - first, c->damping_rotation + first, "compliance/damping_n_m_s_per_rad");
    lint_loss(j, item, &c->loss, "compliance/loss_factor");
}

static void lint_joints(mt_lint *j)
{
    for (int i = 0; i < j->model->n_joints; i++) {
        const mt_joint *const joint = &j->model->joints[i];
        const mt_item item = {"joint", "joints", i, joint->name.s};
        if (mt_model_present(&joint->in, j->configuration)) {
            (void)lint_item_number(j, &item, joint->length, "length_m");
            (void)lint_item_number(j, &item, joint->mass, "mass_kg");
            if (joint->compliance != NULL) {
                lint_compliance(j, &item, joint->compliance);
            }
            nonzero(j, &item, joint->ratio, "ratio");
            nonzero(j, &item, joint->ratio_m_per_rad, "ratio_m_per_rad");
        }
    }
}

static void lint_drive(mt_lint *j, const mt_drive *d)
{
    const double v = value_of_number(j, d->position);
    if (!d->position_is_angle || !(fabs(v) > ONE_TURN)) {
        return;
    }
    if (fabs(v) > MT_DRIVE_REACH) {
        (void)mt_lint_addr(j,
                           mt_warning_add(j->out, MT_LEVEL_FAULT, "drive",
                                          "\"%s\" is driven by %g rad: at most %d rad can be",
                                          d->joint_name.s == NULL ? "" : d->joint_name.s, v,
                                          (int)MT_DRIVE_REACH),
                           j->model->nums[d->position].addr,
                           mt_lint_drive_pointer(j, d, "position_rad"));
        return;
    }
    (void)mt_lint_addr(
        j,
        mt_warning_add(j->out, MT_LEVEL_WARNING, "drive",
                       "\"%s\" is driven by %g rad, more than a turn: degrees are written "
                       "\"%g*deg\"",
                       d->joint_name.s == NULL ? "" : d->joint_name.s, v, v),
        j->model->nums[d->position].addr, mt_lint_drive_pointer(j, d, "position_rad"));
}

static void lint_parameters(mt_lint *j)
{
    for (int i = 0; i < j->model->n_parameters; i++) {
        const mt_num num = number_of_parameter(j, i);
        const char *const why = why_no_value(j, num);
        if (why != NULL) {
            (void)mt_lint_addr(j,
                               mt_warning_add(j->out, MT_LEVEL_FAULT, "value",
                                              "parameter \"%s\": %s",
                                              j->model->parameters[i].name.s, why),
                               j->model->nums[num].addr, NULL);
        }
    }
}

void mt_model_lint(const mt_model *model, int configuration, const double *value, bool whole,
                   mt_warning_list *out)
{
    mt_lint j = {.model = model, .configuration = configuration, .value = value, .out = out};
    const int first = out->n;
    if (whole) {
        lint_parameters(&j);
    }
    lint_bodies(&j);
    lint_links(&j);
    lint_springs(&j);
    lint_joints(&j);
    lint_sensors(&j);
    const mt_configuration *const c = &model->configurations[j.configuration];
    for (int i = 0; i < c->n_drives; i++) {
        lint_drive(&j, &c->drives[i]);
    }
    lint_damping_in_force(&j);
    lint_inherited(&j);
    mt_lint_structure(&j);
    lint_angles(&j);
    lint_units(&j);
    mt_lint_geometry(&j);
    mt_warning_accept(out, first, &model->accepted);
}

mt_status mt_model_admit(const mt_model *model, int configuration, int n_inputs,
                         const int *inputs, const double *at, mt_arena *mem, mt_err *err)
{
    mt_numbers numbers;
    MT_TRY(mt_numbers_new(model, configuration, n_inputs, inputs, model->n_nums, model->nums,
                          mem, &numbers, err));
    return mt_model_admit_numbers(model, configuration, &numbers, at, mem, err);
}

mt_status mt_model_admit_numbers(const mt_model *model, int configuration,
                                 const mt_numbers *numbers, const double *at, mt_arena *mem,
                                 mt_err *err)
{
    double *const value = mt_arena_f64(mem, (size_t)model->n_nums, 1);
    mt_warning_list list = mt_warning_list_default(mem);
    MT_TRY(mt_arena_check(mem, err));
    mt_numbers_at(numbers, at, value, NULL);
    mt_model_lint(model, configuration, value, true, &list);
    for (int i = 0; i < list.n; i++) {
        if (list.items[i].level == MT_LEVEL_FAULT) {
            return mt_fail(err, MT_E_USAGE, "%s", list.items[i].text);
        }
    }
    return mt_arena_check(mem, err);
}
