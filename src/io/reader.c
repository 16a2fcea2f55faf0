/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/reader.h"

#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include "base/format.h"
#include "io/json.h"
#include "io/synonyms.h"

static const char *const KEY_TEXTS[] = {
#define MT_KEY_TYPE_TEXT(id, types, text) text,
    MT_KEY_TYPE_LIST(MT_KEY_TYPE_TEXT)
#undef MT_KEY_TYPE_TEXT
};
static const int KEY_JSON_TYPES[] = {
#define MT_KEY_TYPE_BITS(id, types, text) (types),
    MT_KEY_TYPE_LIST(MT_KEY_TYPE_BITS)
#undef MT_KEY_TYPE_BITS
};

bool mt_reader_type(mt_reader *r, mt_addr value, mt_key_type type)
{
    if (value == MT_NO_ADDR) {
        return false;
    }
    const mt_json_type is = mt_json_type_of(r->doc, value);
    if (((int)is & KEY_JSON_TYPES[type]) != 0) {
        return true;
    }
    mt_diag_structure(r->diags, value, "must be %s, not %s", KEY_TEXTS[type],
                      mt_json_type_text(is));
    return false;
}

enum { MEANT_MOST = 3 };

/* The unit that a member's name ends in, and a constant of expressions is ("rpm" of
 * "speed_range_rpm"), with *stem what is before it; NULL: none. */
static const char *foreign_unit(const char *name, size_t *stem)
{
    static const char *const units[][2] = {{"rpm", "rpm"}, {"deg", "deg"},    {"mm", "mm"},
                                           {"cm", "cm"},   {"in", "inch"},    {"inch", "inch"},
                                           {"ft", "ft"},   {"inches", "inch"}};
    const char *const last = strrchr(name, '_');
    for (int i = 0; i < MT_COUNT(units) && last != NULL; i++) {
        if (strcmp(last + 1, units[i][0]) == 0) {
            *stem = (size_t)(last - name);
            return units[i][1];
        }
    }
    return NULL;
}

/* The key that is the same but for its unit, which is of SI; NULL: there is none. */
static const char *key_in_si(const char *name, const char *const *names, int n,
                             const char **constant)
{
    size_t stem = 0;
    *constant = foreign_unit(name, &stem);
    for (int i = 0; i < n && *constant != NULL; i++) {
        const char *const rest = names[i] + stem;
        const bool same = strlen(names[i]) > stem && strncmp(names[i], name, stem) == 0 &&
                          *rest == '_' && strchr(rest + 1, '_') == NULL;
        const char *const si = strcmp(*constant, "rpm") == 0   ? "hz"
                               : strcmp(*constant, "deg") == 0 ? "rad"
                                                               : "m";
        if (same && strcmp(rest + 1, si) == 0) {
            return names[i];
        }
    }
    return NULL;
}

/* The keys that may be meant, most of them first: for which the name is another word ("joint"
 * for "bodies", "k" for either stiffness), or the nearest one, or those that only add a unit or
 * the like to the name ("mass" for "mass_kg"). Returns how many. */
static int keys_meant(const char *name, const char *const *names, int n,
                      const char *meant[MEANT_MOST])
{
    const size_t length = strlen(name);
    int count = 0;
    for (int i = 0; i < n && count < MEANT_MOST; i++) {
        if (mt_synonym(name, &names[i], 1) != NULL) {
            meant[count++] = names[i];
        }
    }
    if (count == 0) {
        meant[0] = mt_text_nearest(name, names, n);
        count = meant[0] != NULL ? 1 : 0;
    }
    for (int i = 0; i < n && count < MEANT_MOST && length > 0; i++) {
        const bool adds = strncmp(names[i], name, length) == 0 && names[i][length] == '_';
        bool said = false;
        for (int k = 0; k < count; k++) {
            said = said || meant[k] == names[i];
        }
        if (adds && !said) {
            meant[count++] = names[i];
        }
    }
    return count;
}

static void unknown_member(mt_reader *r, mt_addr member, const mt_key_table *table)
{
    const char *names[MT_MAX_KEYS];
    for (int i = 0; i < table->n; i++) {
        names[i] = table->keys[i].name;
    }
    const char *const name = mt_json_name(r->doc, member);
    const char *meant[MEANT_MOST] = {NULL};
    const char *constant = NULL;
    const char *const si = key_in_si(name, names, table->n, &constant);
    if (si != NULL) {
        mt_diag_structure(r->diags, mt_json_name_addr(r->doc, member),
                          "unknown member \"%s\"; did you mean \"%s\", with numbers as "
                          "\"...*%s\"?",
                          name, si, constant);
        return;
    }
    const int n = mt_diag_may_suggest(r->diags) ? keys_meant(name, names, table->n, meant) : 0;
    mt_diag_structure(r->diags, mt_json_name_addr(r->doc, member),
                      "unknown member \"%s\"%s%s%s%s%s%s%s", name,
                      n > 0 ? "; did you mean \"" : "", n > 0 ? meant[0] : "",
                      n > 1 ? "\" or \"" : "", n > 1 ? meant[1] : "", n > 2 ? "\" or \"" : "",
                      n > 2 ? meant[2] : "", n > 0 ? "\"?" : "");
}

static int find_key(const mt_key_table *table, const char *name)
{
    for (int i = 0; i < table->n; i++) {
        if (strcmp(table->keys[i].name, name) == 0) {
            return i;
        }
    }
    return MT_ABSENT;
}

/* What a file of another format is, and what to do with it; NULL: not known. */
static const char *what_it_is(const char *format)
{
    static const struct {
        const char *format;
        const char *text;
    } kinds[] = {{"modetune-model/1", "it is a model, of which a study asks something"},
                 {"modetune-study/1",
                  "it is a study, which \"modetune run\" answers; its \"model\" names "
                  "the model"},
                 {"modetune-result/1", "it is a result, which \"modetune report\" prints"},
                 {"modetune-aircraft/1", "it is a catalogue of aircraft, which a study names"},
                 {"modetune-profile/1",
                  "it is a profile of vibration, which \"modetune profile\" prints"}};
    for (int i = 0; i < MT_COUNT(kinds); i++) {
        if (strcmp(kinds[i].format, format) == 0) {
            return kinds[i].text;
        }
    }
    return NULL;
}

bool mt_reader_format(mt_reader *r, const char *format, const char *not_this)
{
    const mt_addr at = mt_json_member(r->doc, MT_JSON_ROOT, "format");
    if (at == MT_NO_ADDR || mt_json_type_of(r->doc, at) != MT_JSON_STRING ||
        strcmp(mt_json_string(r->doc, at), format) == 0) {
        return true;
    }
    const char *const other = what_it_is(mt_json_string(r->doc, at));
    mt_diag_structure(r->diags, at, "the format is not \"%s\": this is not a %s%s%s", format,
                      not_this, other == NULL ? "" : "; ", other == NULL ? "" : other);
    return false;
}

bool mt_reader_object(mt_reader *r, mt_addr value, const mt_key_table *table, mt_addr *found)
{
    bool seen[MT_MAX_KEYS] = {false};
    for (int i = 0; i < table->n; i++) {
        found[i] = MT_NO_ADDR;
    }
    if (!mt_reader_type(r, value, MT_KEY_OBJECT)) {
        return false;
    }
    for (mt_items m = mt_reader_items(r, value); mt_items_next(&m);) {
        const int k = find_key(table, mt_json_name(r->doc, m.at));
        if (k == MT_ABSENT) {
            unknown_member(r, m.at, table);
        } else if (!seen[k]) { /* a second one has been noted as given twice */
            seen[k] = true;
            found[k] = mt_reader_type(r, m.at, table->keys[k].type) ? m.at : MT_NO_ADDR;
            r->matched[r->n_matched++ % MT_MATCHED] =
                (mt_matched){.addr = m.at, .key = &table->keys[k]};
        }
    }
    for (int i = 0; i < table->n; i++) {
        if (table->keys[i].required && !seen[i]) {
            mt_diag_structure(r->diags, value, "member \"%s\" is missing", table->keys[i].name);
        }
    }
    return true;
}

/* The key that the member was matched with; NULL: none, or too long ago. */
static const mt_key *key_of(const mt_reader *r, mt_addr value)
{
    for (unsigned i = 0; i < MT_MATCHED && i < r->n_matched; i++) {
        const mt_matched *const m = &r->matched[(r->n_matched - 1 - i) % MT_MATCHED];
        if (m->addr == value) {
            return m->key;
        }
    }
    return NULL;
}

static bool is_accepted(const mt_reader *r, const char *name)
{
    bool accepted = false;
    for (int i = 0; i < r->accepted.n; i++) {
        accepted = accepted || strcmp(r->accepted.names[i], name) == 0;
    }
    return accepted;
}

void mt_reader_warning(mt_reader *r, mt_addr value, const char *name, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    const char *const text = mt_arena_vprintf(r->mem, fmt, args);
    va_end(args);
    if (text == NULL) {
        return; /* as the arena knows */
    }
    if (r->warning_list == NULL && !is_accepted(r, name)) {
        mt_diag_warning(r->diags, value, "%s", text);
    } else if (r->warning_list != NULL) {
        mt_warning *const d =
            mt_warning_add(r->warning_list, MT_LEVEL_WARNING, name, "%s", text);
        if (d != NULL) {
            d->addr = value;
        }
    }
}

void mt_reader_check_range_of(mt_reader *r, const char *name, mt_addr value, double number,
                              mt_possible_id row)
{
    const mt_possible *const p = &mt_possible_of[row];
    const char *const doubted = mt_possible_doubted(p, number);
    const bool possible = mt_possible_is(p, number);
    if (value == MT_NO_ADDR || (possible && doubted == NULL)) {
        return;
    }
    if (!possible) {
        mt_diag_error(r->diags, value, "%s (%g) %s", name, number, p->impossible);
    } else {
        mt_reader_warning(r, value, p->warning, "%s (%g) is %s", name, number, doubted);
    }
}

void mt_reader_check_range(mt_reader *r, mt_addr member, mt_addr value, double number)
{
    const mt_key *const key = key_of(r, member);
    if (key != NULL) {
        mt_reader_check_range_of(r, key->name, value, number, key->possible);
    }
}

mt_items mt_reader_items(const mt_reader *r, mt_addr value)
{
    return mt_json_items(r->doc, value);
}

mt_items mt_reader_one_or_items(const mt_reader *r, mt_addr value)
{
    if (value == MT_NO_ADDR || mt_json_type_of(r->doc, value) == MT_JSON_ARRAY) {
        return mt_reader_items(r, value);
    }
    mt_items items = mt_json_items(r->doc, MT_NO_ADDR);
    items.count = 1;
    items.left = 1;
    items.next = value;
    return items;
}

mt_items mt_reader_some_items(mt_reader *r, mt_addr value, const char *what)
{
    const mt_items items = mt_reader_items(r, value);
    if (value != MT_NO_ADDR && items.count == 0) {
        mt_diag_structure(r->diags, value, "%s is empty", what);
    }
    return items;
}

int mt_reader_pair(const mt_reader *r, mt_addr value, mt_addr *first, mt_addr *second)
{
    mt_items items = mt_reader_items(r, value);
    (void)mt_items_next(&items);
    *first = items.at;
    (void)mt_items_next(&items);
    *second = items.at;
    return items.count;
}

void *mt_reader_room(mt_reader *r, mt_items *items, size_t size)
{
    void *const room = mt_arena_alloc(r->mem, (size_t)items->count, size);
    if (room == NULL) {
        items->left = 0;
    }
    return room;
}

const char *mt_reader_text(mt_reader *r, mt_addr value)
{
    if (!mt_reader_type(r, value, MT_KEY_TEXT)) {
        return NULL;
    }
    return mt_arena_strdup(r->mem, mt_json_string(r->doc, value));
}

mt_name mt_reader_ref(mt_reader *r, mt_addr value)
{
    return (mt_name){.s = mt_reader_text(r, value), .addr = value};
}

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

static bool has_form(const char *s, mt_name_form form)
{
    if (form == MT_NAME_TITLE) {
        return *s != '\0';
    }
    if (!is_letter(*s)) {
        return false;
    }
    for (s++; *s != '\0'; s++) {
        const bool digit = *s >= '0' && *s <= '9';
        const bool sign = form == MT_NAME_ITEM && (*s == '+' || *s == '-');
        if (!is_letter(*s) && !digit && !sign) {
            return false;
        }
    }
    return true;
}

static void check_form(mt_reader *r, mt_addr at, const char *s, mt_name_form form)
{
    if (has_form(s, form)) {
        return;
    }
    if (form == MT_NAME_TITLE || *s == '\0') {
        mt_diag_structure(r->diags, at, "a name must not be empty");
    } else if (form == MT_NAME_PARAMETER) {
        mt_diag_structure(r->diags, at,
                          "\"%s\" is not a name: a letter or _, then letters, digits and _", s);
    } else {
        mt_diag_structure(
            r->diags, at,
            "\"%s\" is not a name: a letter or _, then letters, digits, _, + and -", s);
    }
}

mt_name mt_reader_name(mt_reader *r, mt_addr value)
{
    const mt_name name = mt_reader_ref(r, value);
    if (name.s != NULL) {
        check_form(r, value, name.s, MT_NAME_ITEM);
    }
    return name;
}

mt_name mt_reader_member_name(mt_reader *r, mt_addr value, mt_name_form form)
{
    const char *const s = mt_json_name(r->doc, value);
    const mt_addr at = mt_json_name_addr(r->doc, value);
    if (s == NULL) {
        return (mt_name){.s = NULL, .addr = value};
    }
    check_form(r, at, s, form);
    return (mt_name){.s = mt_arena_strdup(r->mem, s), .addr = at};
}

mt_name_list mt_reader_refs(mt_reader *r, mt_addr value)
{
    mt_name_list list = {0};
    if (!mt_reader_type(r, value, MT_KEY_LIST)) {
        return list;
    }
    mt_items walk = mt_reader_items(r, value);
    list.items = mt_reader_room(r, &walk, sizeof *list.items);
    while (mt_items_next(&walk)) {
        const mt_name name = mt_reader_ref(r, walk.at);
        if (name.s != NULL) {
            list.items[list.count++] = name;
        }
    }
    return list;
}

mt_name_list mt_reader_one_or_refs(mt_reader *r, const mt_key *key, mt_addr value)
{
    if (key->type == MT_KEY_LIST) {
        (void)mt_reader_some_items(r, value, key->what);
        return mt_reader_refs(r, value);
    }
    mt_name *const name = mt_arena_alloc(r->mem, 1, sizeof *name);
    if (name == NULL) {
        return (mt_name_list){0};
    }
    *name = mt_reader_ref(r, value);
    return (mt_name_list){name->s == NULL ? 0 : 1, name};
}

/* "a, b, c" in the reader's arena. */
static const char *joined(mt_reader *r, const char *const *names, int n)
{
    const char *text = "";
    for (int i = 0; i < n; i++) {
        text = mt_arena_printf(r->mem, "%s%s%s", text, i == 0 ? "" : ", ", names[i]);
    }
    return text == NULL ? "" : text;
}

int mt_reader_choice(mt_reader *r, mt_addr value, const char *what, const char *const *names,
                     int n)
{
    if (!mt_reader_type(r, value, MT_KEY_TEXT)) {
        return MT_ABSENT;
    }
    const char *const s = mt_json_string(r->doc, value);
    for (int i = 0; i < n; i++) {
        if (strcmp(names[i], s) == 0) {
            return i;
        }
    }
    const bool may = mt_diag_may_suggest(r->diags);
    const char *const other = may ? mt_synonym(s, names, n) : NULL;
    const char *const near = other == NULL && may ? mt_text_nearest(s, names, n) : other;
    if (near != NULL) {
        mt_diag_structure(r->diags, value, "unknown %s \"%s\"; did you mean \"%s\"?", what, s,
                          near);
    } else {
        mt_diag_structure(r->diags, value, "unknown %s \"%s\" (known: %s)", what, s,
                          joined(r, names, n));
    }
    return MT_ABSENT;
}

mt_accepted mt_reader_accepted(mt_reader *r, mt_addr value)
{
    mt_items items = mt_reader_items(r, value);
    mt_accepted out = {.names = mt_reader_room(r, &items, sizeof *out.names)};
    while (out.names != NULL && mt_items_next(&items)) {
        const int k = mt_reader_choice(r, items.at, "warning", mt_warning_names,
                                       MT_COUNT(mt_warning_names));
        if (k != MT_ABSENT) {
            out.names[out.n++] = mt_warning_names[k];
        }
    }
    return out;
}

int mt_reader_count(mt_reader *r, mt_addr value, int least, int most, int fallback)
{
    if (!mt_reader_type(r, value, MT_KEY_COUNT)) {
        return fallback;
    }
    const double number = mt_json_number(r->doc, value);
    if (number == floor(number) && number >= (double)least && number <= (double)most) {
        return (int)number;
    }
    if (most == least + 1) {
        mt_diag_structure(r->diags, value, "must be %d or %d", least, most);
    } else if (most == INT_MAX) {
        mt_diag_structure(r->diags, value, "must be a whole number, %d or more", least);
    } else {
        mt_diag_structure(r->diags, value, "must be a whole number from %d to %d", least, most);
    }
    return fallback;
}

bool mt_reader_flag(mt_reader *r, mt_addr value, bool fallback)
{
    return mt_reader_type(r, value, MT_KEY_BOOL) ? mt_json_bool(r->doc, value) : fallback;
}

/* Note "10 %" for a number in per cent: the value divided by 100 would be wrong. */
static bool says_percent(mt_reader *r, mt_addr value, const char *text)
{
    static const char PERCENT[] = "_percent";
    const mt_key *const key = strchr(text, '%') == NULL ? NULL : key_of(r, value);
    const size_t n = key == NULL ? 0 : strlen(key->name);
    const size_t end = sizeof PERCENT - 1;
    if (n < end || strcmp(key->name + n - end, PERCENT) != 0) {
        return false;
    }
    mt_diag_error(r->diags, value, "%s is in per cent already: leave out \"%%\"", key->name);
    return true;
}

bool mt_reader_expr_text(mt_reader *r, mt_addr addr, const char *text, mt_expr *out)
{
    mt_err err = {MT_OK, ""};
    const mt_expr_scope scope = {.lookup = r->lookup,
                                 .context = r->context,
                                 .names = r->names,
                                 .n_names = mt_diag_may_suggest(r->diags) ? r->n_names : 0,
                                 .curves = r->curves,
                                 .n_curves = r->n_curves};
    if (says_percent(r, addr, text)) {
        *out = (mt_expr){0};
        return false;
    }
    const mt_status rc = mt_expr_parse(text, &scope, r->mem, out, &err);
    if (rc == MT_OK) {
        return true;
    }
    *out = (mt_expr){0};
    if (rc != MT_E_MEMORY) {
        mt_diag_error(r->diags, addr, "%s", err.text);
    }
    return false;
}

bool mt_reader_expr(mt_reader *r, mt_addr value, mt_expr *out)
{
    *out = (mt_expr){0};
    if (!mt_reader_type(r, value, MT_KEY_NUMBER)) {
        return false;
    }
    if (mt_json_type_of(r->doc, value) == MT_JSON_STRING) {
        return mt_reader_expr_text(r, value, mt_json_string(r->doc, value), out);
    }
    if (mt_expr_number(mt_json_number(r->doc, value), r->mem, out, NULL) != MT_OK) {
        *out = (mt_expr){0};
        return false;
    }
    return true;
}

mt_status mt_reader_status(const mt_reader *r, const char *file, mt_err *err)
{
    MT_TRY(mt_arena_check(r->mem, err));
    return mt_json_status(r->doc, file, err);
}

/* Numbers in units other than SI. */

const char *const mt_length_names[MT_LENGTH_NAMES] = {"m", "mm", "cm", "in", "ft"};
const char *const mt_angle_names[MT_ANGLE_NAMES] = {"rad", "deg"};
const char *const mt_speed_names[MT_SPEED_NAMES] = {"Hz", "rpm"};

/* The unit of a dimension that the text names; NULL where absent or wrong (noted). */
static const mt_unit *read_unit(mt_reader *r, mt_addr value, mt_dimension dimension)
{
    int n = 0;
    const mt_unit *const all = mt_units(&n);
    const char *names[MT_MAX_KEYS] = {NULL};
    int n_names = 0;
    const char *const text = value == MT_NO_ADDR ? NULL : mt_json_string(r->doc, value);
    const mt_unit *const meant = text == NULL ? NULL : mt_unit_find(text);
    for (int i = 0; i < n; i++) {
        if (all[i].dimension == dimension && mt_unit_is_common(&all[i])) {
            names[n_names++] = all[i].name;
        }
    }
    if (meant != NULL && !mt_unit_is_common(meant)) {
        mt_diag_structure(
            r->diags, value,
            "\"%s\" is a unit of a parameter's number only: write \"%s\" or \"%s\"", text,
            names[0], names[1]);
        return NULL;
    }
    if (meant != NULL && meant->dimension != dimension) {
        mt_diag_structure(r->diags, value,
                          "\"%s\" is a unit of %s, not of %s: write \"%s\" or \"%s\"", text,
                          mt_dimension_text(meant->dimension), mt_dimension_text(dimension),
                          names[0], names[1]);
        return NULL;
    }
    char what[MT_KIND_TEXT];
    (void)mt_snprintf(what, sizeof what, "unit of %s", mt_dimension_text(dimension));
    const int which = mt_reader_choice(r, value, what, names, n_names);
    return which == MT_ABSENT ? NULL : mt_unit_find(names[which]);
}

void mt_read_units(mt_reader *r, mt_addr value, const mt_key_table *table,
                   const mt_unit *units[MT_DIMENSION_COUNT])
{
    mt_addr at[MT_DIMENSION_COUNT];
    for (int d = 0; d < MT_DIMENSION_COUNT; d++) {
        at[d] = MT_NO_ADDR;
    }
    (void)mt_reader_object(r, value, table, at);
    for (int d = 0; d < MT_DIMENSION_COUNT; d++) {
        units[d] = read_unit(r, at[d], (mt_dimension)d);
    }
}

bool mt_reader_expr_in(mt_reader *r, mt_addr value, const mt_unit *unit, mt_expr *out)
{
    if (unit == NULL || value == MT_NO_ADDR ||
        mt_json_type_of(r->doc, value) != MT_JSON_NUMBER) {
        return mt_reader_expr(r, value, out);
    }
    const double number = mt_unit_to_si(unit, mt_json_number(r->doc, value));
    if (mt_expr_number(number, r->mem, out, NULL) != MT_OK) {
        *out = (mt_expr){0};
        return false;
    }
    return true;
}

void mt_reader_check_kind(mt_reader *r, mt_addr value, const mt_expr *e, const mt_unit *unit)
{
    char text[MT_KIND_TEXT];
    if (value != MT_NO_ADDR && e->length > 0 && r->kinds != NULL &&
        mt_json_type_of(r->doc, value) == MT_JSON_STRING &&
        mt_kind_complaint(e, unit, r->kinds, r->context, text, sizeof text)) {
        mt_diag_error(r->diags, value, "%s", text);
    }
}
