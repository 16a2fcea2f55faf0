/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parameters and their units, what the names of units say and what their uses do; circles of
 * parameters; and curves that expressions read. */
#include <math.h>
#include <string.h>

#include "base/format.h"
#include "expr/interpolant.h"
#include "expr/kind.h"
#include "expr/units.h"
#include "io/reader.h"
#include "io/synonyms.h"
#include "model/item.h"
#include "model/model.h"

#define UNIT_NAME(name, si, dimension, up, down) name,

/* What the `unit` of a parameter may be. */
static const char *const UNITS[] = {"1",         "m",
                                    "m^2",       "m^3",
                                    "m^4",       "kg",
                                    "kg/m",      "kg/m^2",
                                    "kg/m^3",    "kg m",
                                    "kg m^2",    "s",
                                    "1/s",       "Hz",
                                    "rad",       "rad/s",
                                    "m/s",       "m/s^2",
                                    "N",         "N/m",
                                    "N/m^2",     "Pa",
                                    "N m",       "N m^2",
                                    "N m/rad",   "N s/m",
                                    "N m s/rad", "m/rad",
                                    "rad/m",     "J",
                                    "W",         "mm",
                                    "cm",        "in",
                                    "ft",        "deg",
                                    "rpm",       MT_UNIT_LIST(UNIT_NAME)};

enum { HINT_TEXT = 256, KIN_TEXT = 160, MEMBER_UNIT = 48 };

/* Names of what measures the same as `said`, in kin[KIN_TEXT]; the one that is worth the same;
 * NULL: none is. */
static const char *find_kin(const mt_unit_worth *said, char kin[KIN_TEXT])
{
    size_t used = 0;
    mt_unit_worth has;
    kin[0] = '\0';
    for (int i = 0; i < MT_COUNT(UNITS); i++) {
        const size_t length = strlen(UNITS[i]) + strlen(", \"\"");
        if (!mt_unit_read(UNITS[i], MT_READ_MASSES, &has) ||
            !mt_unit_same_powers(said, &has, true)) {
            continue;
        }
        if (mt_unit_same_factor(said->factor, has.factor)) {
            return UNITS[i];
        }
        if (used + length < KIN_TEXT) {
            (void)mt_snprintf(kin + used, KIN_TEXT - used, "%s\"%s\"", used == 0 ? "" : ", ",
                              UNITS[i]);
            used += strlen(kin + used);
        }
    }
    return NULL;
}

/* The correct form of a unit with an unknown notation, in out[HINT_TEXT]. False: it cannot be
 * interpreted. */
static bool name_of_unit(const char *text, char out[HINT_TEXT])
{
    char kin[KIN_TEXT];
    mt_unit_worth said;
    for (int reading = 0; reading < MT_READINGS; reading++) {
        if (!mt_unit_read(text, (mt_unit_reading)reading, &said)) {
            return false;
        }
        const char *const same = find_kin(&said, kin);
        if (same != NULL) {
            (void)mt_snprintf(out, HINT_TEXT, "; did you mean \"%s\"?", same);
            return true;
        }
        if (kin[0] != '\0') {
            (void)mt_snprintf(out, HINT_TEXT, " (of its kind: %s)", kin);
            return true;
        }
    }
    (void)mt_snprintf(out, HINT_TEXT, ": leave it out, and write the number in units of SI");
    return true;
}

static void set_unit(mt_parameter *p, const mt_unit *unit, const char *name)
{
    const bool other = unit != NULL && !mt_unit_is_si(unit);
    p->written = other ? unit : NULL;
    p->unit = other ? unit->si : name;
}

/* The unit of the list that the text at a value names; NULL: none (noted). */
static const char *known_unit(mt_reader *r, mt_addr value)
{
    char hint[HINT_TEXT];
    const char *const text = mt_json_string(r->doc, value);
    for (int i = 0; i < MT_COUNT(UNITS); i++) {
        if (strcmp(UNITS[i], text) == 0) {
            return UNITS[i];
        }
    }
    if (name_of_unit(text, hint)) {
        mt_diag_structure(r->diags, value, "unknown unit \"%s\"%s", text, hint);
    } else {
        const bool may = mt_diag_may_suggest(r->diags);
        const char *const other = may ? mt_synonym(text, UNITS, MT_COUNT(UNITS)) : NULL;
        const char *const near =
            may && other == NULL ? mt_text_nearest(text, UNITS, MT_COUNT(UNITS)) : other;
        mt_diag_structure(r->diags, value, "unknown unit \"%s\"%s%s%s", text,
                          near == NULL ? " (\"modetune schema model\" has all)"
                                       : "; did you mean \"",
                          near == NULL ? "" : near, near == NULL ? "" : "\"?");
    }
    return NULL;
}

static void read_unit(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    const char *const name = known_unit(r, value);
    (void)key;
    if (name != NULL) {
        set_unit(item, mt_unit_find(name), name);
    }
}

#define THIS mt_parameter
static const mt_key PARAMETER[] = {
    MT_M_JUST("value", NUMBER, true, ANY,
              "Its value: a number in its unit, or an expression, which is in SI units and may "
              "depend on other parameters."),
    MT_M_JUST("unit", TEXT, false, NONE,
              "Unit of the number, which wins over the file's; of SI, for people and tables, "
              "or one that is converted: mm, N/mm, GPa, g, lb, ... Numbers that override it "
              "(in configurations, --set) are in it, too. \"g\" is a gram, or 9.80665 m/s^2 of "
              "a parameter that gravity is made of.",
              .read = read_unit, .choices = UNITS, .n_choices = MT_COUNT(UNITS)),
    MT_M_TEXT("description", description, "Free text for people."),
    MT_M_TEXT("source", source, MT_M_ORIGIN),
    MT_I_ORIGIN,
};
#undef THIS

/* The number is in the unit, which stands behind it. */
static void parameter_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_parameter *const p = item;
    (void)which;
    p->value = mt_read_num(mt_model_reader_of(r), mt_object_value(o, "value"), MT_POSSIBLE_ANY,
                           p->written);
}

const mt_key_table mt_parameter_keys = {.what = "parameter",
                                        .keys = PARAMETER,
                                        .n = MT_COUNT(PARAMETER),
                                        .finish = parameter_finish,
                                        .says = "A parameter with its documentation."};

static void read_parameter(mt_reader *r, mt_addr value, mt_parameter *p)
{
    if (!mt_reader_type(r, value, MT_KEY_NUMBER_OR_OBJECT)) {
        return;
    }
    if (mt_json_type_of(r->doc, value) == MT_JSON_OBJECT) {
        (void)mt_members_read(r, value, &mt_parameter_keys, p);
    } else {
        p->value = mt_read_num(mt_model_reader_of(r), value, MT_POSSIBLE_NONE, NULL);
    }
}

/* Curves: points as they stand in the file, and their units (NULL: of SI). */
typedef struct curve_points {
    double *x;
    double *y;
    int n_x;
    int n_y;
    const mt_unit *x_unit;
    const mt_unit *y_unit;
} curve_points;

static void read_curve_numbers(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    int *const n = (int *)(void *)((char *)item + key->other);
    mt_items items = mt_reader_items(r, value);
    double *const room = mt_reader_room(r, &items, sizeof *room);
    if (items.count < 2 || items.count > MT_INTERPOLANT_MOST) {
        mt_diag_structure(r->diags, value, "a curve has 2 to %d points, not %d",
                          (int)MT_INTERPOLANT_MOST, items.count);
        return;
    }
    while (mt_items_next(&items)) {
        const bool number = mt_reader_type(r, items.at, MT_KEY_VALUE);
        room[(*n)++] = number ? mt_json_number(r->doc, items.at) : nan("");
    }
    *(double **)(void *)((char *)item + key->at) = room;
}

static void read_curve_unit(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    const char *const name = known_unit(r, value);
    *(const mt_unit **)(void *)((char *)item + key->at) =
        name == NULL ? NULL : mt_unit_find(name);
}

/* NOLINTBEGIN(bugprone-macro-parentheses): types are not put into parentheses */
#define CURVE_UNIT(label, m, ...)                                                           \
    {                                                                                       \
        .name = (label), .type = MT_KEY_TEXT, MT_M_TO(read_curve_unit, const mt_unit *, m), \
        .choices = UNITS, .n_choices = MT_COUNT(UNITS), .says = __VA_ARGS__                 \
    }
#define CURVE_NUMBERS(label, m, ...)                                               \
    {                                                                              \
        .name = (label), .type = MT_KEY_NUMBERS, .required = true, MT_M_ROW(ANY),  \
        MT_M_TO(read_curve_numbers, double *, m), .other = MT_M_PLACE(int, n_##m), \
        .says = __VA_ARGS__, .schema = MT_CURVE_SCHEMA                             \
    }
/* NOLINTEND(bugprone-macro-parentheses) */
#define MT_CURVE_SCHEMA                                           \
    "\"type\": \"array\", \"minItems\": 2, \"maxItems\": 10000, " \
    "\"items\": {\"type\": \"number\"}"

#define THIS curve_points
static const mt_key CURVE[] = {
    CURVE_NUMBERS("x", x, "Where its points are, ascending.", .examples = "[[0, 0.01, 0.02]]"),
    CURVE_NUMBERS("y", y, "Its values there, as many.", .examples = "[[0, 120, 310]]"),
    CURVE_UNIT("x_unit", x_unit,
               "Unit of its x, which are converted to SI, as expressions are. Absent: SI."),
    CURVE_UNIT("y_unit", y_unit, "Unit of its y. Absent: SI."),
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_curve_keys = {
    .what = "curve",
    .keys = CURVE,
    .n = MT_COUNT(CURVE),
    .says = "A measured curve, which expressions read as interp(name, x): smooth through its "
            "points, without rises or falls that they do not have (Steffen's monotone cubics). "
            "Outside of its points it has no value."};

/* Its numbers in SI; false: they are no curve (noted). */
static bool settle_curve(mt_reader *r, mt_addr value, curve_points *points)
{
    if (points->n_x == 0 || points->n_y == 0) {
        return false;
    }
    if (points->n_x != points->n_y) {
        mt_diag_error(r->diags, mt_json_member(r->doc, value, "y"),
                      "a curve has as many x as y, not %d and %d", points->n_x, points->n_y);
        return false;
    }
    for (int i = 0; i < points->n_x; i++) {
        if (isnan(points->x[i]) || isnan(points->y[i])) {
            return false; /* noted */
        }
        points->x[i] = mt_unit_to_si(points->x_unit, points->x[i]);
        points->y[i] = mt_unit_to_si(points->y_unit, points->y[i]);
        if (i > 0 && !(points->x[i] > points->x[i - 1])) {
            mt_diag_error(r->diags, mt_json_member(r->doc, value, "x"),
                          "the x of a curve ascend: number %d is not above number %d", i + 1,
                          i);
            return false;
        }
    }
    return true;
}

void mt_read_curves(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_model *const m = item;
    mt_items items = mt_reader_items(r, value);
    (void)key;
    m->curves = mt_reader_room(r, &items, sizeof *m->curves);
    while (mt_items_next(&items)) {
        curve_points points = {0};
        mt_err err = {MT_OK, ""};
        mt_interpolant *const curve = &m->curves[m->n_curves++];
        curve->name = mt_reader_member_name(r, items.at, MT_NAME_PARAMETER).s;
        if (mt_members_read(r, items.at, &mt_curve_keys, &points) &&
            settle_curve(r, items.at, &points) &&
            mt_interpolant_init(curve, curve->name, points.n_x, points.x, points.y, &m->mem,
                                &err) == MT_E_INPUT) {
            mt_diag_error(r->diags, items.at, "%s", err.text);
        }
    }
    m->cap_curves = m->n_curves;
    r->curves = m->curves;
    r->n_curves = m->n_curves;
}

static mt_kind kind_of_parameter(const mt_model *m, const mt_parameter *p)
{
    const mt_unit *const si = mt_parameter_si(p);
    if (si != NULL) {
        return mt_kind_of_dimension(si->dimension);
    }
    if (p->unit != NULL) {
        return strcmp(p->unit, "1") == 0 ? MT_KIND_NUMBER : MT_KIND_UNKNOWN;
    }
    if (p->value == MT_ABSENT) {
        return MT_KIND_UNKNOWN;
    }
    /* a 0 that somebody may change is a number */
    const mt_kind kind = mt_expr_kind(&m->nums[p->value].expr, mt_model_kind, m).kind;
    return kind == MT_KIND_ZERO ? MT_KIND_NUMBER : kind;
}

/* Expressions may refer to later and earlier parameters: passes forwards and backwards in turn
 * while something changes. A chain of parameters without units that needs more passes stays
 * unknown, which is not reported. */
static void find_kinds(mt_model *model)
{
    enum { MOST_PASSES = 8 };
    bool changed = true;
    for (int i = 0; i < model->n_parameters; i++) {
        model->parameters[i].kind = MT_KIND_UNKNOWN;
    }
    for (int pass = 0; changed && pass < MOST_PASSES; pass++) {
        changed = false;
        for (int k = 0; k < model->n_parameters; k++) {
            const int i = pass % 2 == 0 ? k : model->n_parameters - 1 - k;
            const mt_kind kind = kind_of_parameter(model, &model->parameters[i]);
            changed = changed || kind != model->parameters[i].kind;
            model->parameters[i].kind = kind;
        }
    }
}

/* Expressions of lengths, angles and speeds, when all parameters are known: a parameter without
 * a unit is what its expression makes it. */
static void check_kinds(mt_model_reader *mr)
{
    const mt_model *const m = mr->m;
    for (int i = 0; i < m->n_parameters; i++) {
        if (m->parameters[i].value != MT_ABSENT) {
            const mt_number *const number = &m->nums[m->parameters[i].value];
            mt_reader_check_kind(&mr->r, number->addr, &number->expr,
                                 mt_model_number_unit(m, i));
        }
    }
}

/* The table of parameters before the others, so that mt_model_lookup is fast while expressions
 * are read. Duplicates are left to mt_model_resolve. */
static void index_parameters(mt_model *model)
{
    mt_names *const table = &model->tables->parameters;
    bool taken = false;
    *table = (mt_names){0};
    for (int i = 0; i < model->n_parameters; i++) {
        const char *const name = model->parameters[i].name.s;
        if (name != NULL) {
            mt_names_add(table, &model->mem, name, i, &taken);
        }
    }
}

/* Parameters are entered by name first: expressions may look ahead. */
void mt_read_parameters(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_model *const m = item;
    mt_items items = mt_reader_items(r, value);
    (void)key;
    const int n = items.count;
    int n_more = 0;
    const char *const *const more = mt_expr_names(&n_more);
    const char **const names =
        mt_arena_alloc(&m->mem, (size_t)n + (size_t)n_more, sizeof *names);
    m->parameters = mt_reader_room(r, &items, sizeof *m->parameters);
    if (mt_arena_failed(&m->mem)) {
        return;
    }
    m->cap_parameters = n;
    int n_names = 0;
    while (mt_items_next(&items)) {
        mt_parameter *const p = &m->parameters[m->n_parameters++];
        p->name = mt_reader_member_name(r, items.at, MT_NAME_PARAMETER);
        p->value = MT_ABSENT;
        if (p->name.s != NULL) {
            names[n_names++] = p->name.s;
        }
    }
    for (int i = 0; i < n_more; i++) {
        names[n_names++] = more[i];
    }
    r->names = names;
    r->n_names = n_names;
    index_parameters(m);
    items = mt_reader_items(r, value);
    for (int k = 0; !mt_arena_failed(&m->mem) && mt_items_next(&items); k++) {
        read_parameter(r, items.at, &m->parameters[k]);
    }
    find_kinds(m);
    r->kinds = mt_model_kind;
    check_kinds(mt_model_reader_of(r));
}

/* A word of a member's name that is a unit, or "/"; NULL: another. */
static const char *unit_word(const char *word, size_t length)
{
    static const char *const words[][2] = {
        {"n", "N"},   {"m", "m"},   {"kg", "kg"}, {"s", "s"},   {"pa", "Pa"},   {"hz", "Hz"},
        {"m2", "m2"}, {"m3", "m3"}, {"m4", "m4"}, {"s2", "s2"}, {"rad", "rad"}, {"per", "/"}};
    for (int i = 0; i < MT_COUNT(words); i++) {
        if (strlen(words[i][0]) == length && memcmp(words[i][0], word, length) == 0) {
            return words[i][1];
        }
    }
    return NULL;
}

/* The unit that a member's name ends in, "N m / rad" of "stiffness_n_m_per_rad"; in text. */
static const char *unit_of_member(const char *name, char text[MEMBER_UNIT])
{
    size_t at = MEMBER_UNIT - 1;
    size_t end = strlen(name);
    text[at] = '\0';
    while (end > 0) {
        size_t begin = end;
        while (begin > 0 && name[begin - 1] != '_') {
            begin--;
        }
        const char *const word = begin == 0 ? NULL : unit_word(name + begin, end - begin);
        if (word == NULL || at < strlen(word) + 1) {
            break;
        }
        if (at < MEMBER_UNIT - 1) {
            text[--at] = ' ';
        }
        at -= strlen(word);
        /* NOLINTNEXTLINE(bugprone-not-null-terminated-result): what follows is there */
        memcpy(text + at, word, strlen(word));
        end = begin - 1;
    }
    return text + at;
}

/* The member that a number is the value of, or stands in a list of; NULL: none. */
static const char *member_of(const mt_model_reader *mr, mt_addr value)
{
    while (value > MT_JSON_ROOT && mt_json_name(mr->r.doc, value) == NULL) {
        value--;
    }
    return mt_json_name(mr->r.doc, value);
}

/* The unit that a number must have: that of its member, or, as the value of a parameter
 * (MT_ABSENT: of none), that of the parameter; perhaps in text. NULL: not known. */
static const char *unit_of_number(const mt_model_reader *mr, const mt_number *number,
                                  int parameter, char text[MEMBER_UNIT])
{
    if (parameter != MT_ABSENT) {
        return mr->m->parameters[parameter].unit;
    }
    if (number->possible == MT_POSSIBLE_POINT) {
        return "m";
    }
    const char *const member = member_of(mr, number->addr);
    return member == NULL ? NULL : unit_of_member(member, text);
}

static bool measured(const mt_model_reader *mr, const mt_number *number, int parameter,
                     mt_unit_worth *out)
{
    char text[MEMBER_UNIT];
    const char *const unit = unit_of_number(mr, number, parameter, text);
    return unit != NULL && mt_unit_read(unit, MT_READ_MASSES, out);
}

/* The parameter that an expression is, with whatever sign; MT_ABSENT: it is something else. */
static int parameter_alone(const mt_expr *e)
{
    if (e->length == 0 || e->code[0].op != MT_OP_PARAM) {
        return MT_ABSENT;
    }
    const bool alone = e->length == 1 || (e->length == 2 && e->code[1].op == MT_OP_NEG);
    return alone ? e->code[0].param : MT_ABSENT;
}

static bool is_other(const mt_parameter *p)
{
    return p->written != NULL && p->written->dimension == MT_OTHER;
}

static bool is_gram(const mt_parameter *p)
{
    return is_other(p) && p->value != MT_ABSENT && strcmp(p->written->name, "g") == 0;
}

/* How many numbers that are masses, accelerations, or neither a parameter is part of. */
enum { USES_MASS, USES_ACCELERATION, USES_OTHER, USES };

/* Count the uses of parameters in "g": uses of masses have no time in their dimension,
 * accelerations no mass; forces and unknown uses fit both. */
static void count_uses(const mt_model_reader *mr, const mt_number *number, int owner,
                       int (*uses)[USES])
{
    const mt_model *const m = mr->m;
    for (int i = 0; i < number->expr.length; i++) {
        const mt_code *const c = &number->expr.code[i];
        mt_unit_worth of = {0};
        if (c->op != MT_OP_PARAM || !is_gram(&m->parameters[c->param])) {
            continue;
        }
        const bool known = measured(mr, number, owner, &of);
        const int kg = of.power[MT_BASE_KG];
        const int s = of.power[MT_BASE_S];
        uses[c->param][known && kg == 1 && s == 0    ? USES_MASS
                       : known && kg == 0 && s == -2 ? USES_ACCELERATION
                                                     : USES_OTHER]++;
    }
}

static void settle_gram(mt_model_reader *mr, int parameter, const int uses[USES])
{
    mt_model *const m = mr->m;
    mt_parameter *const p = &m->parameters[parameter];
    mt_number *const number = &m->nums[p->value];
    const int known = uses[USES_MASS] + uses[USES_ACCELERATION];
    if ((uses[USES_MASS] > 0 && uses[USES_ACCELERATION] > 0) ||
        (uses[USES_OTHER] > 0 && known == 0)) {
        mt_diag_error(mr->r.diags, number->addr,
                      "\"g\" is a gram or 9.80665 m/s^2, and what uses \"%s\" does not say "
                      "which: write the number in \"kg\" or in \"m/s^2\"",
                      p->name.s);
    } else if (uses[USES_ACCELERATION] > 0) {
        set_unit(p, mt_unit_find_of("g", "m/s^2"), NULL);
        if (mt_json_type_of(mr->r.doc, number->addr) == MT_JSON_NUMBER) {
            const double written = mt_json_number(mr->r.doc, number->addr);
            (void)mt_expr_number(mt_unit_to_si(p->written, written), mr->r.mem, &number->expr,
                                 NULL);
        }
    }
}

/* A parameter whose unit is converted is the value of a member: both measure the same. */
static void check_use(mt_model_reader *mr, const mt_number *number, int owner)
{
    const int parameter = parameter_alone(&number->expr);
    mt_unit_worth is;
    mt_unit_worth wanted;
    if (parameter == MT_ABSENT || !is_other(&mr->m->parameters[parameter])) {
        return;
    }
    const mt_parameter *const p = &mr->m->parameters[parameter];
    if (!measured(mr, number, owner, &wanted) || !mt_unit_read(p->unit, MT_READ_MASSES, &is) ||
        mt_unit_same_powers(&is, &wanted, false)) {
        return;
    }
    mt_diag_error(mr->r.diags, number->addr,
                  "\"%s\" is in %s, of which 1 is %g %s: that is not what is wanted here",
                  p->name.s, p->written->name, mt_unit_factor(p->written), p->unit);
}

/* [n_nums] the parameter that a number is the value of, MT_ABSENT: of none; NULL where memory
 * is out. */
static int *find_owners(mt_model *m)
{
    int *const owner = mt_arena_int(&m->mem, (size_t)m->n_nums);
    if (mt_arena_failed(&m->mem)) {
        return NULL;
    }
    for (int k = 0; k < m->n_nums; k++) {
        owner[k] = MT_ABSENT;
    }
    for (int i = 0; i < m->n_parameters; i++) {
        if (m->parameters[i].value != MT_ABSENT) {
            owner[m->parameters[i].value] = i;
        }
    }
    return owner;
}

void mt_read_settle_units(mt_model_reader *mr)
{
    mt_model *const m = mr->m;
    const int *const owner = find_owners(m);
    int(*const uses)[USES] = mt_arena_alloc(&m->mem, (size_t)m->n_parameters, sizeof *uses);
    if (owner == NULL || mt_arena_failed(&m->mem)) {
        return;
    }
    bool any = false;
    for (int i = 0; i < m->n_parameters; i++) {
        any = any || is_other(&m->parameters[i]);
    }
    for (int k = 0; k < m->n_nums && any; k++) {
        count_uses(mr, &m->nums[k], owner[k], uses);
    }
    for (int i = 0; i < m->n_parameters; i++) {
        if (is_gram(&m->parameters[i])) {
            settle_gram(mr, i, uses[i]);
        }
    }
    for (int k = 0; k < m->n_nums && any; k++) {
        check_use(mr, &m->nums[k], owner[k]);
    }
}

/* True where the expression contains a parameter or a constant with a dimension. */
static bool has_unit(const mt_expr *e)
{
    for (int i = 0; i < e->length; i++) {
        const mt_code *const c = &e->code[i];
        if (c->op == MT_OP_PARAM || (c->op == MT_OP_CONST && c->param >= (int)MT_KIND_LENGTH)) {
            return true;
        }
    }
    return false;
}

static bool unit_of_parameter(const void *context, int parameter, mt_unit_worth *out)
{
    const mt_model *const m = context;
    const char *const unit = m->parameters[parameter].unit;
    return unit != NULL && mt_unit_read(unit, MT_READ_MASSES, out);
}

/* The name of what measures this, of SI; its powers, in text, where it has none. */
static const char *name_of_powers(const mt_unit_worth *is, char text[MEMBER_UNIT])
{
    static const char *const bases[] = {"m", "kg", "s"};
    size_t used = 0;
    mt_unit_worth has;
    for (int i = 0; i < MT_COUNT(UNITS); i++) {
        if (mt_unit_read(UNITS[i], MT_READ_MASSES, &has) && has.factor == 1.0 &&
            mt_unit_same_powers(is, &has, true)) {
            return UNITS[i];
        }
    }
    text[0] = '\0';
    for (int k = 0; k < MT_BASE_RAD; k++) {
        if (is->power[k] != 0) {
            (void)mt_snprintf(text + used, MEMBER_UNIT - used, "%s%s^%d", used == 0 ? "" : " ",
                              bases[k], is->power[k]);
            used = strlen(text);
        }
    }
    return text;
}

/* True where the units are rad/s and Hz: an expression may contain their factor 2 pi. */
static bool is_turned(const char *a, const char *b)
{
    return strcmp(a, "rad/s") == 0 && (strcmp(b, "Hz") == 0 || strcmp(b, "1/s") == 0);
}

/* [n_nums] moments of inertia of bodies whose mass is written as a number: the mass may be a
 * factor of the expression, or an omitted 1, as in a^2/12. NULL where memory is out. */
static bool *find_numbered_masses(mt_model *m)
{
    bool *const numbered = mt_arena_alloc(&m->mem, (size_t)m->n_nums, sizeof *numbered);
    for (int i = 0; i < m->n_bodies && numbered != NULL; i++) {
        const mt_body *const b = &m->bodies[i];
        const mt_expr *const mass = b->mass == MT_ABSENT ? NULL : &m->nums[b->mass].expr;
        const bool number =
            mass != NULL && mass->length == 1 && mass->code[0].op == MT_OP_CONST;
        for (int k = 0; k < MT_COUNT(b->inertia) && number; k++) {
            if (b->inertia[k] != MT_ABSENT) {
                numbered[b->inertia[k]] = true;
            }
        }
    }
    return numbered;
}

/* numbered: a number in it, or none, may be a mass. */
static void warn_unit(mt_model_reader *mr, mt_number *number, int owner, bool numbered)
{
    const mt_model *const m = mr->m;
    const int alone = parameter_alone(&number->expr);
    char text[MEMBER_UNIT];
    char is_text[MEMBER_UNIT];
    char wanted_text[MEMBER_UNIT];
    mt_unit_worth is;
    mt_unit_worth wanted;
    const char *const unit = unit_of_number(mr, number, owner, text);
    if (unit == NULL || !mt_unit_read(unit, MT_READ_MASSES, &wanted) ||
        !mt_expr_measures(&number->expr, unit_of_parameter, m, &is)) {
        return;
    }
    const char *const has =
        alone == MT_ABSENT ? name_of_powers(&is, is_text) : m->parameters[alone].unit;
    const bool turned = alone != MT_ABSENT && (is_turned(has, unit) || is_turned(unit, has));
    if (mt_unit_same_powers(&is, &wanted, false) && !turned) {
        return;
    }
    mt_unit_worth times_kg = is;
    times_kg.power[MT_BASE_KG]++;
    if (numbered && mt_unit_same_powers(&times_kg, &wanted, false)) {
        return;
    }
    const char *const member =
        owner == MT_ABSENT ? member_of(mr, number->addr) : m->parameters[owner].name.s;
    number->unit_warning = mt_arena_printf(
        &mr->m->mem, "%s%s%s is in %s, and \"%s\" in %s", alone == MT_ABSENT ? "" : "\"",
        alone == MT_ABSENT ? "this expression" : m->parameters[alone].name.s,
        alone == MT_ABSENT ? "" : "\"", has, member == NULL ? "" : member,
        owner == MT_ABSENT ? name_of_powers(&wanted, wanted_text) : unit);
}

void mt_read_warning_units(mt_model_reader *mr)
{
    mt_model *const m = mr->m;
    int *const owner = find_owners(m);
    const bool *const numbered = find_numbered_masses(m);
    if (owner == NULL || numbered == NULL) {
        return;
    }
    for (int c = 0; c < m->n_configurations; c++) {
        for (int i = 0; i < m->configurations[c].n_overrides; i++) {
            const mt_override *const o = &m->configurations[c].overrides[i];
            const char *const name = o->parameter_name.s;
            const int parameter = name == NULL ? -1 : mt_model_find_parameter(m, name);
            if (o->value != MT_ABSENT && parameter >= 0) {
                owner[o->value] = parameter;
            }
        }
    }
    for (int k = 0; k < m->n_nums; k++) {
        if (has_unit(&m->nums[k].expr)) {
            warn_unit(mr, &m->nums[k], owner[k], numbered[k]);
        }
    }
}

/*
 * Parameters that refer to each other in a circle. In a configuration an override stands in
 * place of the parameter's own expression, so circles are searched in every configuration with
 * overrides. Depth-first with an explicit stack: a chain of parameters may be as long as the
 * file allows.
 */

enum { UNSEEN, ON_PATH, DONE };

typedef struct search {
    mt_resolve *f;
    mt_num *value; /* [n_parameters] the expression in force */
    int *state;    /* [n_parameters] */
    int *stack;    /* [n_parameters] parameters on the path */
    int *next; /* [n_parameters] where the reading of the expression at that depth goes on */
    int depth;
    const char *configuration; /* NULL: the model as it stands */
} search;

static void note_cycle(const search *s, int again)
{
    const mt_model *const m = s->f->m;
    int from = s->depth - 1;
    while (s->stack[from] != again) {
        from--;
    }
    mt_resolve_ring ring = {.first = m->parameters[again].name.s};
    for (int i = from + 1; i < s->depth; i++) {
        mt_resolve_ring_add(&ring, m->parameters[s->stack[i]].name.s);
    }
    mt_resolve_ring_end(&ring);
    const mt_addr addr = mt_resolve_addr(m, s->value[again]);
    if (s->configuration == NULL) {
        mt_diag_error(s->f->d, addr, "parameters refer to each other in a circle: %s",
                      ring.text);
    } else {
        mt_diag_error(s->f->d, addr,
                      "in configuration \"%s\" parameters refer to each other in a circle: %s",
                      s->configuration, ring.text);
    }
}

/* Next parameter that the expression on top of the stack refers to; MT_ABSENT at its end. */
static int next_operand(const search *s)
{
    const int top = s->depth - 1;
    const mt_num num = s->value[s->stack[top]];
    if (num == MT_ABSENT) {
        return MT_ABSENT;
    }
    const mt_expr *const e = &s->f->m->nums[num].expr;
    while (s->next[top] < e->length) {
        const mt_code *const code = &e->code[s->next[top]++];
        if (code->op == MT_OP_PARAM) {
            return code->param;
        }
    }
    return MT_ABSENT;
}

static void push_parameter(search *s, int parameter)
{
    s->state[parameter] = ON_PATH;
    s->stack[s->depth] = parameter;
    s->next[s->depth] = 0;
    s->depth++;
}

/* Search from one parameter; true when a circle was found. */
static bool circle_from(search *s, int parameter)
{
    s->depth = 0;
    push_parameter(s, parameter);
    while (s->depth > 0) {
        const int operand = next_operand(s);
        if (operand == MT_ABSENT) {
            s->state[s->stack[--s->depth]] = DONE;
        } else if (s->state[operand] == ON_PATH) {
            note_cycle(s, operand);
            return true;
        } else if (s->state[operand] == UNSEEN) {
            push_parameter(s, operand);
        }
    }
    return false;
}

/* Every circle that is reached; the parameters of one are not entered again. */
static bool circles(search *s)
{
    const int n = s->f->m->n_parameters;
    bool any = false;
    for (int i = 0; i < n; i++) {
        s->state[i] = UNSEEN;
    }
    for (int i = 0; i < n; i++) {
        if (s->state[i] == UNSEEN && circle_from(s, i)) {
            any = true;
            for (int k = 0; k < s->depth; k++) {
                s->state[s->stack[k]] = DONE;
            }
        }
    }
    return any;
}

static void values_with_overrides(const mt_model *m, const mt_configuration *c, mt_num *value)
{
    for (int i = 0; i < m->n_parameters; i++) {
        value[i] = m->parameters[i].value;
    }
    for (int i = 0; c != NULL && i < c->n_overrides; i++) {
        if (c->overrides[i].parameter != MT_ABSENT) {
            value[c->overrides[i].parameter] = c->overrides[i].value;
        }
    }
}

void mt_resolve_cycles(mt_resolve *f)
{
    mt_model *const m = f->m;
    const size_t n = (size_t)m->n_parameters;
    search s = {.f = f,
                .value = mt_arena_int(&m->mem, n),
                .state = mt_arena_int(&m->mem, n),
                .stack = mt_arena_int(&m->mem, n),
                .next = mt_arena_int(&m->mem, n)};
    if (mt_arena_failed(&m->mem)) {
        return;
    }
    values_with_overrides(m, NULL, s.value);
    if (circles(&s)) {
        return; /* configurations would repeat it */
    }
    for (int c = 0; c < m->n_configurations; c++) {
        if (m->configurations[c].n_overrides > 0) {
            s.configuration = m->configurations[c].name.s;
            values_with_overrides(m, &m->configurations[c], s.value);
            (void)circles(&s);
        }
    }
}
