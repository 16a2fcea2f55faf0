/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Copies of items, and sub-assemblies, written out. A copy stands at x' = R x + t, R a rotation
 * or, mirrored, a reflection; the same R turns what has a direction:
 *
 *     vector (force, direction of sliding)   a' = R a
 *     axis of turning                        a' = det(R) R a   (angles keep their signs)
 *     tensors (inertia, stiffness)           as they are, in axes that are turned by R
 *
 * Where all that goes in are numbers, numbers come out; else expressions, whose slopes are
 * exact like those of any other. In the plane an axis of turning cannot be reversed: there
 * angles and moments of a mirrored item change their signs.
 */
#include "model/copy.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const mt_copied_lists[MT_COPIED_LISTS] = {"points",  "bodies",  "links", "joints",
                                                      "springs", "dampers", "loads", "sensors"};

/* What a member of an item is to a copy of it. */
typedef enum role {
    KEEP,
    NUMBER,
    OWN_NAME,
    PART,
    JOINT,
    AT,
    POSITION,
    AXIS,
    FORCE,
    INERTIA,
    AXES,
    COMPLIANCE,
    MATRIX,
    SENSE, /* an angle or a moment */
    SLIDE, /* a force along a line or a joint */
    RATIO,
    NOT_KNOWN
} role;

/* Members that are more than numbers or words; the others go by their types. */
static const struct {
    const char *name;
    role is;
} ROLES[] = {
    {"name", OWN_NAME},
    {"bodies", PART},
    {"on", PART},
    {"joint", JOINT},
    {"joints", JOINT},
    {"at", AT},
    {"centre", POSITION},
    {"from", POSITION},
    {"to", POSITION},
    {"axis", AXIS},
    {"axis_b", AXIS},
    {"hinge_axis", AXIS},
    {"force_n", FORCE},
    {"inertia_kg_m2", INERTIA},
    {"axes", AXES},
    {"compliance", COMPLIANCE},
    {"stiffness_n_per_m", NUMBER},
    {"damping_n_s_per_m", NUMBER},
    {"stiffness_matrix", MATRIX},
    {"free_angle_rad", SENSE},
    {"preload_n_m", SENSE},
    {"moment_n_m", SENSE},
    {"preload_n", SLIDE},
    {"ratio", RATIO},
    {"ratio_m_per_rad", RATIO},
    {"in", KEEP},
    {"directions", KEEP},
};

static const mt_key_table *const TABLES[MT_COPIED_LISTS] = {
    NULL,           &mt_body_keys,   &mt_link_keys,
    &mt_joint_keys, &mt_spring_keys, &mt_damper_keys,
    &mt_load_keys,  &mt_sensor_keys,
};

const mt_space mt_space_of[MT_COPIED_LISTS] = {MT_OF_POINTS, MT_OF_PARTS,   MT_OF_PARTS,
                                               MT_OF_JOINTS, MT_OF_SPRINGS, MT_OF_SPRINGS,
                                               MT_OF_LOADS,  MT_OF_SENSORS};

static const mt_key *find_key(const mt_key_table *table, const char *name)
{
    for (int i = 0; i < table->n; i++) {
        if (strcmp(table->keys[i].name, name) == 0) {
            return &table->keys[i];
        }
    }
    return NULL;
}

static role role_of(const mt_key *key)
{
    if (key == NULL) {
        return KEEP; /* unknown: its reader says so */
    }
    for (int i = 0; i < MT_COUNT(ROLES); i++) {
        if (strcmp(ROLES[i].name, key->name) == 0) {
            return ROLES[i].is;
        }
    }
    if (key->type == MT_KEY_NUMBER || key->type == MT_KEY_NUMBERS ||
        key->type == MT_KEY_NUMBER_OR_LIST || key->type == MT_KEY_OBJECT) {
        return NUMBER;
    }
    return key->type == MT_KEY_TEXT || key->type == MT_KEY_COUNT || key->type == MT_KEY_VALUE ||
                   key->type == MT_KEY_BOOL
               ? KEEP
               : NOT_KNOWN;
}

/* Writing a document made of others. */

bool mt_maker_is_full(const mt_maker *m)
{
    return m->all->values > MT_EXPAND_VALUES || mt_arena_failed(&m->mem) || m->text.failed;
}

static void add_origin(mt_maker *m, mt_json_origin at)
{
    mt_json_origin *const origins =
        mt_arena_grow(&m->mem, m->origins, m->n_origins, &m->cap_origins, sizeof *origins);
    m->all->values++;
    if (origins != NULL) {
        m->origins = origins;
        origins[m->n_origins++] = at;
    }
}

int mt_maker_note(mt_maker *m, const char *text)
{
    const char **const notes =
        mt_arena_grow(&m->mem, m->notes, m->n_notes, &m->cap_notes, sizeof *notes);
    if (notes == NULL || text == NULL) {
        return -1;
    }
    m->notes = notes;
    notes[m->n_notes] = text;
    return m->n_notes++;
}

int mt_maker_line(const mt_json *doc, mt_addr addr)
{
    int line = 0;
    int column = 0;
    mt_json_locate(doc, addr, &line, &column);
    return line;
}

static mt_json_origin origin(const mt_copy *c, mt_addr addr)
{
    return (mt_json_origin){.doc = c->doc_index, .addr = addr, .note = c->note};
}

static void put_string(const mt_copy *c, const char *name, mt_addr addr, const char *text)
{
    add_origin(c->m, origin(c, addr));
    mt_json_put_string(&c->m->w, name, text == NULL ? "" : text);
}

static void put_num(const mt_copy *c, const char *name, mt_addr addr, mt_term x)
{
    if (x.s != NULL) {
        put_string(c, name, addr, x.s);
        return;
    }
    add_origin(c->m, origin(c, addr));
    mt_json_put_number(&c->m->w, name, x.v);
}

static bool is_container(const mt_json *doc, mt_addr addr)
{
    return ((int)mt_json_type_of(doc, addr) & (MT_JSON_ARRAY | MT_JSON_OBJECT)) != 0;
}

static bool is_flat(const mt_json *doc, mt_addr addr)
{
    bool flat = mt_json_type_of(doc, addr) == MT_JSON_ARRAY;
    for (mt_items i = mt_json_items(doc, addr); flat && mt_items_next(&i);) {
        flat = !is_container(doc, i.at);
    }
    return flat;
}

static void open_value(const mt_copy *c, const char *name, mt_addr addr, bool flat)
{
    const char bracket = mt_json_type_of(c->doc, addr) == MT_JSON_ARRAY ? '[' : '{';
    add_origin(c->m, origin(c, addr));
    if (flat) {
        mt_json_open_flat(&c->m->w, name, bracket);
    } else {
        mt_json_open(&c->m->w, name, bracket);
    }
}

static void put_same(const mt_copy *c, const char *name, mt_addr addr);

/* The members or items of a value, each by f. */
static void put_each(const mt_copy *c, const char *name, mt_addr addr,
                     void (*f)(const mt_copy *c, const char *name, mt_addr addr))
{
    enum { ROOM = 2 }; /* levels that the writer has besides */
    if (c->m->w.depth >= MT_JSON_WRITER_DEPTH - ROOM) {
        add_origin(c->m, origin(c, addr));
        mt_json_put_null(&c->m->w, name); /* no model is as deep */
        return;
    }
    open_value(c, name, addr, is_flat(c->doc, addr));
    for (mt_items i = mt_json_items(c->doc, addr);
         mt_items_next(&i) && !mt_maker_is_full(c->m);) {
        f(c, mt_json_name(c->doc, i.at), i.at);
    }
    mt_json_close(&c->m->w);
}

/* A value as it is. */
static void put_same(const mt_copy *c, const char *name, mt_addr addr)
{
    switch (mt_json_type_of(c->doc, addr)) {
    case MT_JSON_ARRAY:
    case MT_JSON_OBJECT:
        put_each(c, name, addr, put_same);
        break;
    case MT_JSON_STRING:
        put_string(c, name, addr, mt_json_string(c->doc, addr));
        break;
    case MT_JSON_NUMBER:
        put_num(c, name, addr, (mt_term){.v = mt_json_number(c->doc, addr)});
        break;
    case MT_JSON_BOOL:
        add_origin(c->m, origin(c, addr));
        mt_json_put_bool(&c->m->w, name, mt_json_bool(c->doc, addr));
        break;
    case MT_JSON_NULL:
        add_origin(c->m, origin(c, addr));
        mt_json_put_null(&c->m->w, name);
        break;
    }
}

/* Names and expressions. */

static bool has_name(const mt_names *names, const char *s, size_t length)
{
    bool found = false;
    (void)mt_names_find(names, s, length, &found);
    return found;
}

static const char *glued(const mt_copy *c, const char *a, const char *b)
{
    mt_text t = {0};
    mt_text_add(&t, a);
    mt_text_add(&t, b);
    const char *const s = t.s == NULL ? "" : mt_arena_strdup(&c->m->mem, t.s);
    mt_text_free(&t);
    return s;
}

/* What the copy calls an item, or the item that a part ("beam.end") belongs to. */
static const char *named(const mt_copy *c, mt_space of, const char *name)
{
    const size_t head = strcspn(name, ".");
    const mt_space in = name[head] == '.' ? MT_OF_PARTS : of;
    if (c->own == NULL) {
        return glued(c, c->prefix, name);
    }
    if (!has_name(&c->own[in], name, head)) {
        return name;
    }
    const char *const first = mt_arena_strndup(&c->m->mem, name, head);
    return first == NULL ? name : glued(c, glued(c, first, c->suffix), name + head);
}

static bool is_word(char x)
{
    return (x >= 'a' && x <= 'z') || (x >= 'A' && x <= 'Z') || (x >= '0' && x <= '9') ||
           x == '_';
}

/* An expression with the copy's names of parameters and curves. */
static const char *expression(const mt_copy *c, const char *s)
{
    if (c->symbols == NULL) {
        return s;
    }
    mt_text t = {0};
    while (*s != '\0') {
        size_t n = 0;
        const bool number = (*s >= '0' && *s <= '9') || *s == '.';
        while (is_word(s[n]) || (number && (s[n] == '.' || ((s[n] == '+' || s[n] == '-') &&
                                                            (s[n - 1] | 0x20) == 'e')))) {
            n++;
        }
        if (n > 0 && !number && has_name(c->symbols, s, n)) {
            mt_text_add(&t, c->prefix);
        }
        n = n == 0 ? 1 : n;
        mt_text_add_n(&t, s, n);
        s += n;
    }
    const char *const out = t.s == NULL ? "" : mt_arena_strdup(&c->m->mem, t.s);
    if (t.failed) {
        mt_arena_fail(&c->m->mem);
    }
    mt_text_free(&t);
    return out;
}

/* Numbers, expressions among them. */
static void put_numbers(const mt_copy *c, const char *name, mt_addr addr)
{
    if (mt_json_type_of(c->doc, addr) == MT_JSON_STRING) {
        put_string(c, name, addr, expression(c, mt_json_string(c->doc, addr)));
    } else if (is_container(c->doc, addr)) {
        put_each(c, name, addr, put_numbers);
    } else {
        put_same(c, name, addr);
    }
}

/* Sums of products of numbers and expressions. */

/* As part of an expression; unit: of a length, NULL: SI. */
static const char *term_text(mt_maker *m, mt_term x, const mt_unit *unit)
{
    char buffer[MT_JSON_NUMBER_SIZE];
    if (x.s != NULL) {
        return x.s;
    }
    (void)mt_json_format_shortest(x.v, buffer);
    if (unit == NULL || unit->constant == NULL) {
        return mt_arena_strdup(&m->mem, buffer);
    }
    return mt_arena_printf(&m->mem, "%s*%s", buffer, unit->constant);
}

static mt_term product(mt_maker *m, mt_term a, mt_term b)
{
    if (a.s == NULL && b.s == NULL) {
        return (mt_term){.v = a.v * b.v};
    }
    const mt_term other = a.s == NULL ? b : a;
    const double v = a.s == NULL ? a.v : b.v;
    const bool one = a.s == NULL || b.s == NULL;
    if (one && v == 0.0) {
        return (mt_term){.v = 0.0};
    }
    if (one && v == 1.0) {
        return other;
    }
    return (mt_term){.s = mt_arena_printf(&m->mem, "(%s)*(%s)", term_text(m, a, NULL),
                                          term_text(m, b, NULL))};
}

static bool is_no_term(mt_term x)
{
    return x.s == NULL && x.v == 0.0;
}

/* The sum below where it is a number. */
static bool plain_sum(int n, const mt_term *factor, const mt_term *x, double *v)
{
    *v = 0.0;
    for (int i = 0; i < n; i++) {
        if (is_no_term(factor[i]) || is_no_term(x[i])) {
            continue;
        }
        if (factor[i].s != NULL || x[i].s != NULL) {
            return false;
        }
        *v += factor[i].v * x[i].v;
    }
    return true;
}

/* A text in parentheses; NULL: memory is out, which its arena knows. */
static void add_bracketed(mt_text *t, const char *s)
{
    mt_text_add(t, "(");
    mt_text_add(t, s == NULL ? "" : s);
    mt_text_add(t, ")");
}

/* factor[0] x[0] + factor[1] x[1] ..., numbers among x in this unit. */
static mt_term sum_of(mt_maker *m, int n, const mt_term *factor, const mt_term *x,
                      const mt_unit *unit)
{
    double v = 0.0;
    if (plain_sum(n, factor, x, &v)) {
        return (mt_term){.v = v};
    }
    mt_text t = {0};
    for (int i = 0; i < n; i++) {
        if (is_no_term(factor[i]) || is_no_term(x[i])) {
            continue;
        }
        const bool number = factor[i].s == NULL;
        const bool minus = number && factor[i].v == -1.0;
        const char *const plus = t.length > 0 ? "+" : "";
        mt_text_add(&t, minus ? "-" : plus);
        if (!minus && !(number && factor[i].v == 1.0)) {
            add_bracketed(&t, term_text(m, factor[i], NULL));
            mt_text_add(&t, "*");
        }
        add_bracketed(&t, term_text(m, x[i], unit));
    }
    const mt_term out = {.s = t.s == NULL ? "0" : mt_arena_strdup(&m->mem, t.s)};
    if (t.failed || out.s == NULL) {
        mt_arena_fail(&m->mem);
    }
    mt_text_free(&t);
    return out;
}

/* Turned and mirrored values. */

enum { SPACE_OF_THREE = 3, ORDER = 6 };

/* A number of the document; a length in the unit of the new document. */
static mt_term num_of(const mt_copy *c, mt_addr addr, bool length)
{
    if (mt_json_type_of(c->doc, addr) == MT_JSON_STRING) {
        return (mt_term){.s = expression(c, mt_json_string(c->doc, addr))};
    }
    const double v = mt_json_number(c->doc, addr);
    return (mt_term){.v = !length || c->length == c->m->length
                              ? v
                              : mt_unit_from_si(c->m->length, mt_unit_to_si(c->length, v))};
}

static bool may_be_number(const mt_json *doc, mt_addr addr)
{
    return ((int)mt_json_type_of(doc, addr) & (MT_JSON_NUMBER | MT_JSON_STRING)) != 0;
}

/* The numbers of a list of `least` to `most` numbers, their addresses in at; 0: it is none. */
static int nums_of(const mt_copy *c, mt_addr list, int least, int most, bool length, mt_term *x,
                   mt_addr *at)
{
    mt_items items = mt_json_items(c->doc, list);
    bool ok = mt_json_type_of(c->doc, list) == MT_JSON_ARRAY && items.count >= least &&
              items.count <= most;
    for (int i = 0; ok && mt_items_next(&items); i++) {
        ok = may_be_number(c->doc, items.at);
        at[i] = items.at;
        x[i] = ok ? num_of(c, items.at, length) : (mt_term){.v = 0.0};
    }
    return ok ? items.count : 0;
}

/* R x, or R x + t of a position. */
static void turn_vector(const mt_copy *c, int n, const mt_term *x, bool position, mt_term *out)
{
    for (int i = 0; i < n; i++) {
        mt_term factor[SPACE_OF_THREE + 1];
        mt_term of[SPACE_OF_THREE + 1];
        for (int k = 0; k < n; k++) {
            factor[k] = c->R[(3 * i) + k];
            of[k] = x[k];
        }
        factor[n] = (mt_term){.v = position ? 1.0 : 0.0};
        of[n] = c->t[i];
        out[i] = sum_of(c->m, n + 1, factor, of, position ? c->m->length : NULL);
    }
}

static void put_list(const mt_copy *c, const char *name, mt_addr list, int n, const mt_term *x,
                     const mt_addr *at)
{
    open_value(c, name, list, true);
    for (int i = 0; i < n; i++) {
        put_num(c, NULL, at[i], x[i]);
    }
    mt_json_close(&c->m->w);
}

/* A list of coordinates, or of components of a vector. */
static void put_vector(const mt_copy *c, const char *name, mt_addr list, bool position,
                       bool back)
{
    mt_term x[SPACE_OF_THREE];
    mt_term out[SPACE_OF_THREE];
    mt_addr at[SPACE_OF_THREE];
    const int n = nums_of(c, list, 2, SPACE_OF_THREE, position, x, at);
    if (n != c->m->dimension) {
        put_numbers(c, name, list); /* its reader says what is wrong */
        return;
    }
    turn_vector(c, n, x, position, out);
    for (int i = 0; i < n && back; i++) {
        const mt_term minus = {.v = -1.0};
        out[i] = sum_of(c->m, 1, &minus, &out[i], NULL);
    }
    put_list(c, name, list, n, out, at);
}

static void put_coordinates(const mt_copy *c, const char *name, mt_addr list)
{
    put_vector(c, name, list, true, false);
}

static mt_addr point_of(const mt_copy *c, const char *name)
{
    const mt_addr points = mt_json_member(c->doc, MT_JSON_ROOT, "points");
    return points == MT_NO_ADDR ? MT_NO_ADDR : mt_json_member(c->doc, points, name);
}

/* The name of a point or coordinates. A point that is not copied is elsewhere for a copy. */
static void put_position(const mt_copy *c, const char *name, mt_addr addr)
{
    if (mt_json_type_of(c->doc, addr) != MT_JSON_STRING) {
        put_coordinates(c, name, addr);
        return;
    }
    const char *const s = mt_json_string(c->doc, addr);
    const bool own =
        c->own == NULL || c->still || has_name(&c->own[MT_OF_POINTS], s, strlen(s));
    mt_term x[SPACE_OF_THREE];
    mt_term out[SPACE_OF_THREE];
    mt_addr at[SPACE_OF_THREE];
    const mt_addr point = own ? MT_NO_ADDR : point_of(c, s);
    const int n = point == MT_NO_ADDR ? 0 : nums_of(c, point, 2, SPACE_OF_THREE, true, x, at);
    if (n == 0 || n != c->m->dimension) {
        put_string(c, name, addr, named(c, MT_OF_POINTS, s));
        return;
    }
    turn_vector(c, n, x, true, out);
    add_origin(c->m, origin(c, addr));
    mt_json_open_flat(&c->m->w, name, '[');
    for (int i = 0; i < n; i++) {
        put_num(c, NULL, addr, out[i]);
    }
    mt_json_close(&c->m->w);
}

/* One position, or a pair: a list with a list in it, or of two names of points. */
static void put_at(const mt_copy *c, const char *name, mt_addr addr)
{
    mt_items items = mt_json_items(c->doc, addr);
    const bool list = mt_json_type_of(c->doc, addr) == MT_JSON_ARRAY;
    const int count = items.count;
    bool lists = false;
    bool points = list && count == 2;
    while (list && mt_items_next(&items)) {
        const bool string = mt_json_type_of(c->doc, items.at) == MT_JSON_STRING;
        lists = lists || mt_json_type_of(c->doc, items.at) == MT_JSON_ARRAY;
        points = points && string &&
                 (c->m->dimension == 3 ||
                  point_of(c, mt_json_string(c->doc, items.at)) != MT_NO_ADDR);
    }
    if (lists || points) {
        put_each(c, name, addr, put_position);
    } else {
        put_position(c, name, addr);
    }
}

/* The sign of a component in the axes of a mirrored copy. Axes are right-handed, so that of the
 * images of three of them the last is taken the other way: displacements along the third and
 * rotations about the first two change their signs. */
static double mirrored_sign(const mt_copy *c, int component)
{
    static const double signs[ORDER] = {1.0, 1.0, -1.0, -1.0, -1.0, 1.0};
    return c->mirrored ? signs[component] : 1.0;
}

static void put_with_sign(const mt_copy *c, mt_addr addr, double sign)
{
    const mt_term x = num_of(c, addr, false);
    const mt_term factor = {.v = sign};
    put_num(c, NULL, addr, sum_of(c->m, 1, &factor, &x, NULL));
}

/* [xx, yy, zz] or [xx, yy, zz, xy, xz, yz] in the body's axes. */
static void put_inertia(const mt_copy *c, const char *name, mt_addr addr)
{
    static const int row[ORDER] = {0, 1, 2, 0, 0, 1};
    static const int column[ORDER] = {0, 1, 2, 1, 2, 2};
    mt_term x[ORDER];
    mt_addr at[ORDER];
    const int n = nums_of(c, addr, 3, ORDER, false, x, at);
    if (n == 0) {
        put_numbers(c, name, addr);
        return;
    }
    open_value(c, name, addr, true);
    for (int k = 0; k < n; k++) {
        put_with_sign(c, at[k], mirrored_sign(c, row[k]) * mirrored_sign(c, column[k]));
    }
    mt_json_close(&c->m->w);
}

/* A stiffness matrix in the bushing's axes. */
static void put_matrix(const mt_copy *c, const char *name, mt_addr addr)
{
    mt_term K[ORDER * ORDER];
    mt_addr at[ORDER * ORDER];
    mt_addr row[ORDER];
    mt_items rows = mt_json_items(c->doc, addr);
    bool ok = rows.count == ORDER;
    for (ptrdiff_t i = 0; ok && mt_items_next(&rows); i++) {
        row[i] = rows.at;
        ok = nums_of(c, rows.at, ORDER, ORDER, false, &K[ORDER * i], &at[ORDER * i]) == ORDER;
    }
    if (!ok) {
        put_numbers(c, name, addr);
        return;
    }
    open_value(c, name, addr, false);
    for (int i = 0; i < ORDER; i++) {
        open_value(c, NULL, row[i], true);
        for (int j = 0; j < ORDER; j++) {
            put_with_sign(c, at[(ORDER * i) + j], mirrored_sign(c, i) * mirrored_sign(c, j));
        }
        mt_json_close(&c->m->w);
    }
    mt_json_close(&c->m->w);
}

/* Cosine or sine of a number or an expression. */
static mt_term wave(mt_maker *m, bool sine, mt_term angle)
{
    if (angle.s == NULL) {
        return (mt_term){.v = sine ? sin(angle.v) : cos(angle.v)};
    }
    return (mt_term){.s = mt_arena_printf(&m->mem, "%s(%s)", sine ? "sin" : "cos", angle.s)};
}

/* The first two axes of those that are turned by a about x, then by b about y, by c about z. */
static void axes_by_angles(const mt_copy *c, int n, const mt_term *angles, mt_term *x,
                           mt_term *y)
{
    mt_maker *const m = c->m;
    mt_term C[SPACE_OF_THREE];
    mt_term S[SPACE_OF_THREE];
    for (int k = 0; k < 3; k++) { /* in the plane the only angle is that about z */
        const mt_term angle = n == 3 ? angles[k] : k == 2 ? angles[0] : (mt_term){.v = 0.0};
        C[k] = wave(m, false, angle);
        S[k] = wave(m, true, angle);
    }
    const mt_term minus = {.v = -1.0};
    const mt_term signs[2] = {{.v = 1.0}, minus};
    const mt_term ab = product(m, S[0], S[1]);
    const mt_term first[2] = {product(m, ab, C[2]), product(m, C[0], S[2])};
    const mt_term second[2] = {product(m, ab, S[2]), product(m, C[0], C[2])};
    const mt_term plus[2] = {{.v = 1.0}, {.v = 1.0}};
    x[0] = product(m, C[1], C[2]);
    x[1] = product(m, C[1], S[2]);
    x[2] = sum_of(m, 1, &minus, &S[1], NULL);
    y[0] = sum_of(m, 2, signs, first, NULL);
    y[1] = sum_of(m, 2, plus, second, NULL);
    y[2] = product(m, S[0], C[1]);
}

static void put_direction(const mt_copy *c, const char *name, mt_addr from, const mt_term *x)
{
    mt_term out[SPACE_OF_THREE];
    const int n = c->m->dimension;
    turn_vector(c, n, x, false, out);
    add_origin(c->m, origin(c, from));
    mt_json_open_flat(&c->m->w, name, '[');
    for (int k = 0; k < n; k++) {
        put_num(c, NULL, from, out[k]);
    }
    mt_json_close(&c->m->w);
}

/* "axes" by two vectors; object: those of what is copied, MT_NO_ADDR: the drawing's; from: what
 * messages are about. */
static void put_axes(const mt_copy *c, mt_addr object, mt_addr from)
{
    mt_term x[SPACE_OF_THREE] = {{.v = 1.0}, {.v = 0.0}, {.v = 0.0}};
    mt_term y[SPACE_OF_THREE] = {{.v = 0.0}, {.v = 1.0}, {.v = 0.0}};
    mt_term angles[SPACE_OF_THREE];
    mt_addr at[SPACE_OF_THREE];
    const mt_addr given =
        object == MT_NO_ADDR ? MT_NO_ADDR : mt_json_member(c->doc, object, "angles_rad");
    if (object != MT_NO_ADDR && given == MT_NO_ADDR) {
        open_value(c, "axes", object, false);
        for (mt_items i = mt_json_items(c->doc, object); mt_items_next(&i);) {
            if (mt_json_type_of(c->doc, i.at) == MT_JSON_ARRAY) {
                put_vector(c, mt_json_name(c->doc, i.at), i.at, false, false);
            } else {
                put_same(c, mt_json_name(c->doc, i.at), i.at);
            }
        }
        mt_json_close(&c->m->w);
        return;
    }
    if (given != MT_NO_ADDR && may_be_number(c->doc, given)) {
        angles[0] = num_of(c, given, false);
        axes_by_angles(c, 1, angles, x, y);
    } else if (given != MT_NO_ADDR) {
        const int n = nums_of(c, given, 1, SPACE_OF_THREE, false, angles, at);
        if (n != (c->m->dimension == 2 ? 1 : 3)) {
            put_same(c, "axes", object); /* its reader says what is wrong */
            return;
        }
        axes_by_angles(c, n, angles, x, y);
    }
    add_origin(c->m, origin(c, from));
    mt_json_open(&c->m->w, "axes", '{');
    put_direction(c, "x", from, x);
    if (c->m->dimension == 3) {
        put_direction(c, "y", from, y);
    }
    mt_json_close(&c->m->w);
}

static bool is_bushing(const mt_copy *c)
{
    const mt_addr type = mt_json_member(c->doc, c->item, "type");
    return type != MT_NO_ADDR && mt_json_type_of(c->doc, type) == MT_JSON_STRING &&
           strcmp(mt_json_string(c->doc, type), "bushing") == 0;
}

/* Which sign angles have in a copy. */

static const char *word_of(const mt_copy *c, mt_addr object, const char *member)
{
    const mt_addr at = mt_json_member(c->doc, object, member);
    return at != MT_NO_ADDR && mt_json_type_of(c->doc, at) == MT_JSON_STRING
               ? mt_json_string(c->doc, at)
               : "";
}

static const char *type_of_joint(const mt_copy *c, const char *name)
{
    const mt_addr list = mt_json_member(c->doc, MT_JSON_ROOT, "joints");
    for (mt_items i = mt_json_items(c->doc, list); mt_items_next(&i);) {
        if (strcmp(word_of(c, i.at, "name"), name) == 0) {
            return word_of(c, i.at, "type");
        }
    }
    return "";
}

static bool turns_by_angle(const char *type)
{
    return strcmp(type, mt_joint_type_name(MT_JOINT_REVOLUTE)) == 0 ||
           strcmp(type, mt_joint_type_name(MT_JOINT_CYLINDRICAL)) == 0;
}

/* True where this joint (or hinge) is a mirrored copy. */
static bool is_mirrored(const mt_copy *c, const char *joint)
{
    const size_t head = strcspn(joint, ".");
    const mt_space in = joint[head] == '.' ? MT_OF_PARTS : MT_OF_JOINTS;
    return c->mirrored && (c->own == NULL || has_name(&c->own[in], joint, head));
}

/* True where the number of an item changes its sign in the copy. */
static bool changes_sign(const mt_copy *c, role is)
{
    const bool plane = c->m->dimension == 2;
    const char *const joint = word_of(c, c->item, "joint");
    if (!c->mirrored || is == NUMBER) {
        return false;
    }
    if (is == SENSE) {
        return plane && (*joint == '\0' || is_mirrored(c, joint));
    }
    if (is == SLIDE) { /* what slides along an axis whose angle keeps its sign */
        return !plane && is_mirrored(c, joint) &&
               strcmp(type_of_joint(c, joint), mt_joint_type_name(MT_JOINT_CYLINDRICAL)) == 0;
    }
    bool odd = false; /* a ratio of coordinates of which one changes its sign */
    const mt_addr joints = mt_json_member(c->doc, c->item, "joints");
    for (mt_items i = mt_json_items(c->doc, joints); mt_items_next(&i);) {
        const char *const name = mt_json_string(c->doc, i.at);
        const bool angle = turns_by_angle(type_of_joint(c, name)) || strchr(name, '.') != NULL;
        odd = odd != (plane && angle && is_mirrored(c, name));
    }
    return odd;
}

static void put_signed(const mt_copy *c, const char *name, mt_addr addr, role is)
{
    if (!may_be_number(c->doc, addr) || !changes_sign(c, is)) {
        put_numbers(c, name, addr);
        return;
    }
    const mt_term minus = {.v = -1.0};
    const mt_term x = num_of(c, addr, false);
    put_num(c, name, addr, sum_of(c->m, 1, &minus, &x, NULL));
}

/* Items. */

static void put_part(const mt_copy *c, const char *name, mt_addr addr)
{
    if (mt_json_type_of(c->doc, addr) != MT_JSON_STRING) {
        if (is_container(c->doc, addr)) {
            put_each(c, name, addr, put_part);
        } else {
            put_same(c, name, addr);
        }
        return;
    }
    const char *const s = mt_json_string(c->doc, addr);
    if (strcmp(s, "ground") != 0) {
        put_string(c, name, addr, named(c, MT_OF_PARTS, s));
    } else if (c->ground == NULL) {
        put_string(c, name, addr, s);
    } else {
        add_origin(c->m, (mt_json_origin){.addr = c->ground_addr, .note = -1});
        mt_json_put_string(&c->m->w, name, c->ground);
    }
}

static void put_joint(const mt_copy *c, const char *name, mt_addr addr)
{
    if (mt_json_type_of(c->doc, addr) == MT_JSON_STRING) {
        put_string(c, name, addr, named(c, MT_OF_JOINTS, mt_json_string(c->doc, addr)));
    } else if (is_container(c->doc, addr)) {
        put_each(c, name, addr, put_joint);
    } else {
        put_same(c, name, addr);
    }
}

static void put_members(const mt_copy *c, mt_addr object, const mt_key_table *table,
                        mt_space of);

/* A member by its role; numbers and objects of numbers. */
static void put_plain(const mt_copy *c, const char *name, mt_addr addr, const mt_key *key)
{
    if (key != NULL && key->of != NULL && mt_json_type_of(c->doc, addr) == MT_JSON_OBJECT) {
        open_value(c, name, addr, false);
        put_members(c, addr, key->of, MT_SPACES);
        mt_json_close(&c->m->w);
    } else {
        put_numbers(c, name, addr);
    }
}

/* What a joint yields: along the axis of the joint, or along axes of its own. */
static void put_compliance(const mt_copy *c, const char *name, mt_addr addr, const mt_key *key)
{
    if (key == NULL || mt_json_type_of(c->doc, addr) != MT_JSON_OBJECT) {
        put_same(c, name, addr);
        return;
    }
    open_value(c, name, addr, false);
    put_members(c, addr, key->of, MT_SPACES);
    if (!c->parallel && mt_json_member(c->doc, addr, "axes") == MT_NO_ADDR &&
        mt_json_member(c->doc, c->item, "axis") == MT_NO_ADDR) {
        put_axes(c, MT_NO_ADDR, addr);
    }
    mt_json_close(&c->m->w);
}

static void put_member(const mt_copy *c, mt_addr addr, const mt_key *key, mt_space of)
{
    const char *const name = mt_json_name(c->doc, addr);
    const role is = role_of(key);
    const bool list = mt_json_type_of(c->doc, addr) == MT_JSON_ARRAY;
    switch (is) {
    case OWN_NAME:
        put_string(c, name, addr, named(c, of, mt_json_string(c->doc, addr)));
        break;
    case PART:
        put_part(c, name, addr);
        break;
    case JOINT:
        put_joint(c, name, addr);
        break;
    case AT:
        if (of == MT_OF_LOADS || of == MT_OF_SENSORS) {
            put_position(c, name, addr);
        } else {
            put_at(c, name, addr);
        }
        break;
    case POSITION:
        put_position(c, name, addr);
        break;
    case AXIS:
        put_vector(c, name, addr, false,
                   c->mirrored && (strcmp(name, "hinge_axis") == 0 ||
                                   turns_by_angle(word_of(c, c->item, "type"))));
        break;
    case FORCE:
        if (list) {
            put_vector(c, name, addr, false, false);
        } else {
            put_signed(c, name, addr, SLIDE);
        }
        break;
    case INERTIA:
        put_inertia(c, name, addr);
        break;
    case AXES:
        if (c->parallel) {
            put_plain(c, name, addr, key);
        } else {
            put_axes(c, addr, addr);
        }
        break;
    case COMPLIANCE:
        put_compliance(c, name, addr, key);
        break;
    case MATRIX:
        put_matrix(c, name, addr);
        break;
    case SENSE:
    case SLIDE:
    case RATIO:
        put_signed(c, name, addr, is);
        break;
    case NUMBER:
        put_plain(c, name, addr, key);
        break;
    case NOT_KNOWN:
        if (!c->parallel) {
            mt_diag_error(mt_json_diags(c->m->docs[c->doc_index]), addr,
                          "\"%s\" cannot be copied turned or mirrored", name);
        }
        put_numbers(c, name, addr);
        break;
    case KEEP:
        put_same(c, name, addr);
        break;
    }
}

static void put_members(const mt_copy *c, mt_addr object, const mt_key_table *table,
                        mt_space of)
{
    for (mt_items i = mt_json_items(c->doc, object);
         mt_items_next(&i) && !mt_maker_is_full(c->m);) {
        put_member(c, i.at, find_key(table, mt_json_name(c->doc, i.at)), of);
    }
}

/* A parameter with another value. */
static void put_bound(const mt_copy *c, const char *name, mt_addr addr, mt_addr value)
{
    const mt_copy own = {.m = c->m, .doc = c->m->r.doc, .note = -1};
    if (mt_json_type_of(c->doc, addr) != MT_JSON_OBJECT) {
        put_same(&own, name, value);
        return;
    }
    open_value(c, name, addr, false);
    for (mt_items i = mt_json_items(c->doc, addr); mt_items_next(&i);) {
        const char *const member = mt_json_name(c->doc, i.at);
        if (strcmp(member, "value") == 0) {
            put_same(&own, member, value);
        } else {
            put_same(c, member, i.at);
        }
    }
    mt_json_close(&c->m->w);
}

static void put_parameter(const mt_copy *c, mt_addr addr)
{
    const char *const own = mt_json_name(c->doc, addr);
    const char *const name = glued(c, c->prefix, own);
    const mt_addr value =
        c->bound == MT_NO_ADDR ? MT_NO_ADDR : mt_json_member(c->m->r.doc, c->bound, own);
    if (value != MT_NO_ADDR) {
        put_bound(c, name, addr, value);
    } else if (mt_json_type_of(c->doc, addr) != MT_JSON_OBJECT) {
        put_numbers(c, name, addr);
    } else {
        open_value(c, name, addr, false);
        for (mt_items i = mt_json_items(c->doc, addr); mt_items_next(&i);) {
            const char *const member = mt_json_name(c->doc, i.at);
            if (strcmp(member, "value") == 0) {
                put_numbers(c, member, i.at);
            } else {
                put_same(c, member, i.at);
            }
        }
        mt_json_close(&c->m->w);
    }
}

/* True where the item has numbers along axes: a bushing, a tensor of inertia. */
static bool has_axes(const mt_copy *c, const mt_key_table *table)
{
    const mt_addr inertia = mt_json_member(c->doc, c->item, "inertia_kg_m2");
    return table == &mt_body_keys
               ? inertia != MT_NO_ADDR && mt_json_type_of(c->doc, inertia) == MT_JSON_ARRAY
               : is_bushing(c);
}

static void put_object(mt_copy *c, int list, mt_addr item)
{
    const mt_key_table *const table = TABLES[list];
    if (mt_json_type_of(c->doc, item) != MT_JSON_OBJECT) {
        put_same(c, NULL, item);
        return;
    }
    c->item = item;
    open_value(c, NULL, item, false);
    put_members(c, item, table, mt_space_of[list]);
    if (!c->parallel && mt_json_member(c->doc, item, "axes") == MT_NO_ADDR &&
        has_axes(c, table)) {
        put_axes(c, MT_NO_ADDR, item);
    }
    mt_json_close(&c->m->w);
}

void mt_copy_item(mt_copy *c, const char *list, mt_addr item)
{
    const char *const name = mt_json_name(c->doc, item);
    int k = 0;
    while (k < MT_COPIED_LISTS && strcmp(mt_copied_lists[k], list) != 0) {
        k++;
    }
    if (strcmp(list, "parameters") == 0) {
        put_parameter(c, item);
    } else if (k == MT_COPIED_LISTS) { /* a curve */
        put_same(c, glued(c, c->prefix, name), item);
    } else if (TABLES[k] == NULL) {
        put_coordinates(c, named(c, MT_OF_POINTS, name), item);
    } else {
        put_object(c, k, item);
    }
}

/* R and t. */

static void stand_still(mt_copy *c)
{
    for (int k = 0; k < 9; k++) {
        c->R[k] = (mt_term){.v = k % 4 == 0 ? 1.0 : 0.0};
    }
    for (int k = 0; k < 3; k++) {
        c->t[k] = (mt_term){.v = 0.0};
    }
    c->still = true;
    c->parallel = true;
}

/* A cosine or sine without the last digits of pi: 0, 1/2 and 1 are meant where they are almost
 * met. */
static double clean(double x)
{
    static const double exact[] = {0.0, 0.5, 1.0};
    for (int i = 0; i < MT_COUNT(exact); i++) {
        if (fabs(fabs(x) - exact[i]) < 4.0 * DBL_EPSILON) {
            return x < 0.0 ? -exact[i] : exact[i];
        }
    }
    return x;
}

/* R = u u^T + cos(a) (1 - u u^T) + sin(a) [u]x, a = times * angle, u a unit vector. */
static void turn_about(mt_copy *c, const double *u, int times, mt_term angle)
{
    const double across[] = {0.0, -u[2], u[1], u[2], 0.0, -u[0], -u[1], u[0], 0.0}; /* [u]x */
    const mt_term k = {.v = times};
    const mt_term a = product(c->m, k, angle);
    const double cosine = a.s == NULL ? clean(cos(a.v)) : 0.0;
    const double sine = a.s == NULL ? clean(sin(a.v)) : 0.0;
    const mt_term one = {.v = 1.0};
    mt_term f[2] = {{.v = cosine}, {.v = sine}};
    if (a.s != NULL) {
        f[0] = (mt_term){.s = mt_arena_printf(&c->m->mem, "cos(%s)", a.s)};
        f[1] = (mt_term){.s = mt_arena_printf(&c->m->mem, "sin(%s)", a.s)};
    }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            const double along = u[i] * u[j];
            const mt_term factor[] = {
                {.v = along}, {.v = (i == j ? 1.0 : 0.0) - along}, {.v = across[(3 * i) + j]}};
            const mt_term x[] = {one, f[0], f[1]};
            c->R[(3 * i) + j] = sum_of(c->m, 3, factor, x, NULL);
        }
    }
    c->still = false;
    c->parallel = false;
}

/* t of what leaves a position p in its place: p - R p. */
static void about(mt_copy *c, const mt_term *p)
{
    const int n = c->m->dimension;
    mt_term image[SPACE_OF_THREE];
    const bool parallel = c->parallel;
    c->parallel = false;
    turn_vector(c, n, p, false, image);
    c->parallel = parallel;
    for (int i = 0; i < n; i++) {
        mt_term factor[SPACE_OF_THREE + 1];
        mt_term x[SPACE_OF_THREE + 1];
        for (int k = 0; k < n; k++) {
            const mt_term minus = {.v = -1.0};
            factor[k] = product(c->m, minus, c->R[(3 * i) + k]);
            x[k] = p[k];
        }
        factor[n] = (mt_term){.v = 1.0};
        x[n] = p[i];
        c->t[i] = sum_of(c->m, n + 1, factor, x, c->m->length);
    }
}

/* R = 1 - 2 n n^T. */
static void mirror_in(mt_copy *c, const double *u)
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            c->R[(3 * i) + j] = (mt_term){.v = (i == j ? 1.0 : 0.0) - (2.0 * u[i] * u[j])};
        }
    }
    c->still = false;
    c->parallel = false;
    c->mirrored = true;
}

void mt_copy_move(mt_copy *c, const mt_motion *motion, int times)
{
    const mt_term factor[2] = {{.v = 1.0}, {.v = times}};
    stand_still(c);
    if (motion->mirrors) {
        mirror_in(c, motion->axis);
        about(c, motion->about);
    } else if (motion->turns) {
        turn_about(c, motion->axis, times, motion->angle);
        about(c, motion->about);
    }
    for (int i = 0; i < c->m->dimension; i++) {
        const mt_term x[2] = {c->t[i], motion->step[i]};
        c->t[i] = sum_of(c->m, 2, factor, x, c->m->length);
        c->still = c->still && c->t[i].s == NULL && c->t[i].v == 0.0;
    }
}

/* What a repeat or an include says. */

/* A plain direction, made a unit vector; false (noted) where it is none. */
static bool read_direction(mt_maker *m, mt_addr list, double *u)
{
    mt_items items = mt_reader_items(&m->r, list);
    bool ok = items.count == 3;
    if (!ok) {
        mt_diag_structure(m->r.diags, list, "must have 3 entries, not %d", items.count);
    }
    for (int i = 0; mt_items_next(&items); i++) {
        const bool number = mt_reader_type(&m->r, items.at, MT_KEY_VALUE);
        ok = ok && number;
        if (ok) {
            u[i] = mt_json_number(m->r.doc, items.at);
        }
    }
    const double size = ok ? hypot(hypot(u[0], u[1]), u[2]) : 1.0;
    if (ok && !(size > 0.0 && size <= DBL_MAX)) {
        mt_diag_error(m->r.diags, list, "has no direction: all entries are 0");
        return false;
    }
    for (int i = 0; ok && i < 3; i++) {
        u[i] /= size;
    }
    return ok;
}

/* The axis of a polar repeat or of a rotation, an object; in two dimensions that of the
 * plane. */
bool mt_read_axis(mt_maker *m, const mt_object *o, const char *member, double *u)
{
    const mt_addr axis = mt_object_value(o, member);
    if (strcmp(member, "axis") != 0) {
        return axis != MT_NO_ADDR && read_direction(m, axis, u);
    }
    memcpy(u, (const double[]){0.0, 0.0, 1.0}, 3 * sizeof *u);
    if (mt_object_has(&m->r, o, "axis") && m->dimension == 2) {
        mt_diag_error(m->r.diags, mt_object_place(&m->r, o, "axis"),
                      "in two dimensions the axis is out of the plane: leave it out");
        return false;
    }
    if (axis != MT_NO_ADDR) {
        return read_direction(m, axis, u);
    }
    if (m->dimension == 3 && !mt_object_has(&m->r, o, "axis")) {
        mt_diag_error(m->r.diags, o->addr, "member \"axis\" is missing");
        return false;
    }
    return m->dimension == 2;
}

/* A number or an expression of a list in the document itself, in the unit of its lengths or
 * SI. */
/* Places and angles of copies are made of these numbers, whose sums must be some, too. */
static const double MOST_OWN = 1e100;

bool mt_read_own(mt_maker *m, mt_addr value, const mt_unit *unit, mt_term *out)
{
    mt_expr e;
    double v = 0.0;
    if (mt_json_type_of(m->r.doc, value) == MT_JSON_NUMBER) {
        *out = (mt_term){.v = mt_json_number(m->r.doc, value)};
        if (!(fabs(out->v) <= MOST_OWN)) {
            mt_diag_error(m->r.diags, value, "must be from -1e100 to 1e100");
            return false;
        }
        return true;
    }
    if (!mt_reader_expr_in(&m->r, value, unit, &e)) {
        return false;
    }
    const char *const s = mt_json_string(m->r.doc, value);
    *out = (mt_term){.s = s};
    if (mt_expr_is_constant(&e, &v) && fabs(v) <= MOST_OWN) {
        *out = (mt_term){.v = mt_unit_from_si(unit, v)};
    }
    return true;
}

static bool read_coordinates(mt_maker *m, mt_addr list, mt_term *out)
{
    mt_items items = mt_reader_items(&m->r, list);
    bool ok = items.count == m->dimension;
    if (items.count < 2 || items.count > 3) {
        mt_diag_structure(m->r.diags, list, "must have 2 to 3 entries, not %d", items.count);
    } else if (!ok) {
        mt_diag_error(m->r.diags, list, "must have %d entries: the model has %d dimensions",
                      m->dimension, m->dimension);
    }
    for (int i = 0; mt_items_next(&items); i++) {
        const bool number = mt_reader_type(&m->r, items.at, MT_KEY_NUMBER);
        ok = ok && number;
        ok = ok && mt_read_own(m, items.at, m->length, &out[i]);
    }
    return ok;
}

/* A position; an absent one is the origin. */
bool mt_read_place(mt_maker *m, mt_addr value, mt_term *out)
{
    for (int k = 0; k < 3; k++) {
        out[k] = (mt_term){.v = 0.0};
    }
    if (value == MT_NO_ADDR) {
        return true;
    }
    if (mt_json_type_of(m->r.doc, value) == MT_JSON_ARRAY) {
        return read_coordinates(m, value, out);
    }
    const char *const name = mt_json_string(m->r.doc, value);
    const mt_addr points = mt_json_member(m->r.doc, MT_JSON_ROOT, "points");
    const mt_addr point =
        points == MT_NO_ADDR ? MT_NO_ADDR : mt_json_member(m->r.doc, points, name);
    if (point == MT_NO_ADDR) {
        mt_diag_error(m->r.diags, value, "unknown point \"%s\"", name);
        return false;
    }
    return mt_json_type_of(m->r.doc, point) == MT_JSON_ARRAY && read_coordinates(m, point, out);
}

/* Members that something may be added to: objects, then lists. */
static const char *const ADDED[] = {"curves", "parameters", "points",  "bodies", "links",
                                    "joints", "springs",    "dampers", "loads",  "sensors"};
enum { ADDED_OBJECTS = 3 };

static int added_index(const char *name)
{
    for (int i = 0; i < MT_COUNT(ADDED); i++) {
        if (strcmp(ADDED[i], name) == 0) {
            return i;
        }
    }
    return -1;
}

/* The document with what is added to its lists. */
static void put_document(mt_maker *m, const mt_addition *what)
{
    const mt_copy same = {.m = m, .doc = m->r.doc, .note = -1};
    bool there[MT_COUNT(ADDED)] = {false};
    open_value(&same, NULL, MT_JSON_ROOT, false);
    for (mt_items i = mt_json_items(m->r.doc, MT_JSON_ROOT); mt_items_next(&i);) {
        const char *const name = mt_json_name(m->r.doc, i.at);
        const int k = added_index(name);
        if (what->drop != NULL && strcmp(name, what->drop) == 0) {
            continue;
        }
        if (k < 0 || !what->any(what->context, name) ||
            mt_json_type_of(m->r.doc, i.at) !=
                (k < ADDED_OBJECTS ? MT_JSON_OBJECT : MT_JSON_ARRAY)) {
            put_same(&same, name, i.at);
            continue;
        }
        there[k] = true;
        open_value(&same, name, i.at, false);
        for (mt_items v = mt_json_items(m->r.doc, i.at);
             mt_items_next(&v) && !mt_maker_is_full(m);) {
            put_same(&same, mt_json_name(m->r.doc, v.at), v.at);
        }
        what->put(m, what->context, name);
        mt_json_close(&m->w);
    }
    for (int k = 0; k < MT_COUNT(ADDED); k++) {
        if (!there[k] && mt_json_member(m->r.doc, MT_JSON_ROOT, ADDED[k]) == MT_NO_ADDR &&
            what->any(what->context, ADDED[k])) {
            add_origin(m, (mt_json_origin){.addr = what->from, .note = -1});
            mt_json_open(&m->w, ADDED[k], k < ADDED_OBJECTS ? '{' : '[');
            what->put(m, what->context, ADDED[k]);
            mt_json_close(&m->w);
        }
    }
    mt_json_close(&m->w);
}

static int find_parameter(const void *names, const char *name, size_t length)
{
    bool found = false;
    const int i = mt_names_find(names, name, length, &found);
    return found ? i : MT_ABSENT;
}

/* Names of the members of an object of the document. */
static void add_members(mt_json *doc, const char *object, mt_names *names, mt_arena *mem)
{
    const mt_addr at = mt_json_member(doc, MT_JSON_ROOT, object);
    int n = 0;
    if (at == MT_NO_ADDR || mt_json_type_of(doc, at) != MT_JSON_OBJECT) {
        return;
    }
    for (mt_items i = mt_json_items(doc, at); mt_items_next(&i);) {
        bool taken = false;
        mt_names_add(names, mem, mt_json_name(doc, i.at), n++, &taken);
    }
}

static const mt_unit *length_unit(const mt_json *doc)
{
    const mt_addr units = mt_json_member(doc, MT_JSON_ROOT, "units");
    const mt_addr length =
        units == MT_NO_ADDR ? MT_NO_ADDR : mt_json_member(doc, units, "length");
    const mt_unit *const unit =
        length == MT_NO_ADDR || mt_json_type_of(doc, length) != MT_JSON_STRING
            ? NULL
            : mt_unit_find(mt_json_string(doc, length));
    return unit == NULL || mt_unit_is_si(unit) ? NULL : unit;
}

/* room: number of documents besides the first. names: for the parameters of the document. */
mt_status mt_maker_begin(mt_maker *m, mt_json *doc, const char *path, mt_expansion *all,
                         int room, mt_names *names, mt_err *err)
{
    *m = (mt_maker){
        .all = all, .path = path, .dimension = all->dimension, .length = length_unit(doc)};
    MT_TRY(mt_arena_init(&m->mem, 0, err));
    /* NOLINTBEGIN(bugprone-sizeof-expression): pointers are what is meant */
    m->docs = mt_arena_alloc(&m->mem, (size_t)room + 1, sizeof *m->docs);
    m->files = mt_arena_alloc(&m->mem, (size_t)room + 1, sizeof *m->files);
    /* NOLINTEND(bugprone-sizeof-expression) */
    m->by = mt_arena_int(&m->mem, (size_t)room + 1);
    if (m->docs == NULL || m->files == NULL || m->by == NULL) {
        return mt_arena_check(&m->mem, err);
    }
    m->docs[0] = doc;
    m->by[0] = -1;
    m->n_docs = 1;
    add_members(doc, "parameters", names, &m->mem);
    m->r = (mt_reader){.doc = doc,
                       .diags = mt_json_diags(doc),
                       .mem = &m->mem,
                       .lookup = find_parameter,
                       .context = names};
    return mt_arena_check(&m->mem, err);
}

/* Write the document and turn the old one into it. */
mt_status mt_maker_end(mt_maker *m, const mt_addition *what, mt_err *err)
{
    const bool full = m->all->values > MT_EXPAND_VALUES;
    m->w = mt_json_writer_default(&m->text);
    if (!full) {
        put_document(m, what);
    }
    if (m->all->values > MT_EXPAND_VALUES) {
        if (!full) {
            mt_diag_error(m->r.diags, what->from,
                          "written out the model has more than %d values",
                          (int)MT_EXPAND_VALUES);
        }
        m->n_docs = m->n_docs > 1 ? m->n_docs : 1;
        for (int i = 1; i < m->n_docs; i++) {
            mt_json_delete(m->docs[i]);
        }
        return mt_fail(err, MT_E_INPUT, "written out the model is too large");
    }
    const bool ok = mt_json_done(&m->w);
    const mt_json_parts parts = {.n_docs = m->n_docs,
                                 .docs = m->docs,
                                 .files = m->files,
                                 .by = m->by,
                                 .n_origins = m->n_origins,
                                 .origins = m->origins,
                                 .n_notes = m->n_notes,
                                 .notes = m->notes};
    if (!ok || mt_arena_failed(&m->mem)) {
        for (int i = 1; i < m->n_docs; i++) {
            mt_json_delete(m->docs[i]);
        }
        return mt_fail_memory(err);
    }
    MT_TRY(mt_json_become(m->docs[0], m->text.s, m->text.length, &parts, err));
    return mt_json_diags(m->docs[0])->errors > m->errors
               ? mt_fail(err, MT_E_INPUT, "what is repeated or included is wrong")
               : MT_OK;
}

void mt_maker_finish(mt_maker *m)
{
    mt_text_free(&m->text);
    mt_arena_free(&m->mem);
}

mt_copy mt_copy_begin(mt_maker *m, int doc_index, const char *prefix)
{
    mt_json *const doc = m->docs[doc_index];
    mt_copy c = {.m = m,
                 .doc = doc,
                 .doc_index = doc_index,
                 .note = -1,
                 .prefix = prefix,
                 .ground_addr = MT_NO_ADDR,
                 .bound = MT_NO_ADDR,
                 .length = length_unit(doc)};
    mt_names *const symbols =
        prefix == NULL ? NULL : mt_arena_alloc(&m->mem, 1, sizeof *symbols);
    if (symbols != NULL) {
        add_members(doc, "parameters", symbols, &m->mem);
        add_members(doc, "curves", symbols, &m->mem);
    }
    c.symbols = symbols;
    stand_still(&c);
    return c;
}
