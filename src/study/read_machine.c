/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Machines whose orders and gear meshes are to be avoided. */
#include "study/read_priv.h"

#include "environment/read_harmonics.h"
#include "environment/rotor.h"

#define MACHINE_KEYS(X)                                               \
    X(MACHINE_SPEED, "speed_hz", MT_KEY_NUMBER, false, MACHINE)       \
    X(MACHINE_SPEEDS, "speed_range_hz", MT_KEY_LIST, false, MACHINE)  \
    X(MACHINE_RANGE, "speed_range", MT_KEY_LIST, false, FACTORS)      \
    X(MACHINE_NAME, "name", MT_KEY_TEXT, false)                       \
    X(MACHINE_ORDERS, "orders", MT_KEY_LIST, false)                   \
    X(MACHINE_GEARS, "gears", MT_KEY_LIST, false)                     \
    X(MACHINE_MARGIN, "margin_percent", MT_KEY_NUMBER, false, MARGIN) \
    X(MACHINE_DESCRIPTION, "description", MT_KEY_TEXT, false)         \
    X(MACHINE_SOURCE, "source", MT_KEY_TEXT, false)
enum { MACHINE_KEYS(MT_STUDY_KEY_ENUM) MACHINE_KEY_COUNT };
static const mt_key MACHINE[] = {MACHINE_KEYS(MT_STUDY_KEY)};
const mt_key_table mt_study_machine_keys = {"machine", MACHINE, MACHINE_KEY_COUNT};

#define GEAR_KEYS(X)                                           \
    X(GEAR_TEETH, "teeth", MT_KEY_COUNT, true, WHOLE)          \
    X(GEAR_RATIO, "ratio", MT_KEY_NUMBER, false, POSITIVE)     \
    X(GEAR_ORDERS, "orders", MT_KEY_LIST, false)               \
    X(GEAR_SIDEBANDS, "sidebands", MT_KEY_COUNT, false, WHOLE) \
    X(GEAR_NAME, "name", MT_KEY_TEXT, false)                   \
    X(GEAR_DESCRIPTION, "description", MT_KEY_TEXT, false)     \
    X(GEAR_SOURCE, "source", MT_KEY_TEXT, false)
enum { GEAR_KEYS(MT_STUDY_KEY_ENUM) GEAR_KEY_COUNT };
static const mt_key GEAR[] = {GEAR_KEYS(MT_STUDY_KEY)};
const mt_key_table mt_study_gear_keys = {"gear", GEAR, GEAR_KEY_COUNT};

/* A bare number: times per turn, or of the mesh. */
static void refuse_number(mt_study_reader *s, mt_addr at, char letter)
{
    const char *const meant =
        mt_arena_printf(s->r.mem, "%.10g%c", mt_json_number(s->r.doc, at), letter);
    mt_order is;
    const bool good = meant != NULL && mt_order_parse(meant, letter, &is);
    mt_diag_structure(s->r.diags, at, "must be a string, not a number%s%s%s",
                      good ? ": orders are written \"" : "", good ? meant : "",
                      !good           ? ""
                      : letter == 'E' ? "\", times per turn"
                                      : "\", multiples of the gear mesh");
}

static mt_order *read_orders(mt_study_reader *s, mt_addr list, char letter, int *n)
{
    mt_items items = mt_reader_some_items(&s->r, list, "the list of orders");
    mt_order *const orders = mt_reader_room(&s->r, &items, sizeof *orders);
    while (mt_items_next(&items)) {
        if (mt_json_type_of(s->r.doc, items.at) == MT_JSON_NUMBER) {
            refuse_number(s, items.at, letter);
            continue;
        }
        const char *const text = mt_reader_text(&s->r, items.at);
        if (text != NULL && mt_order_parse(text, letter, &orders[*n])) {
            orders[(*n)++].addr = items.at;
        } else if (text != NULL) {
            const char *const meant = mt_read_multiple_meant(&s->r, text, letter);
            mt_order is;
            const bool good = meant != NULL && mt_order_parse(meant, letter, &is);
            mt_diag_structure(
                s->r.diags, items.at,
                "\"%s\" is not an order: a number above 0 and below 1000 with at most three "
                "decimals, then %c (%s)%s%s%s",
                text, letter, letter == 'E' ? "times per turn" : "multiples of the gear mesh",
                good ? "; did you mean \"" : "", good ? meant : "", good ? "\"?" : "");
        }
    }
    return orders;
}

static void read_gear(mt_study_reader *s, mt_addr value, mt_gear *gear)
{
    mt_study_object o;
    *gear = mt_gear_default(value);
    if (!mt_read_study_object(s, value, &mt_study_gear_keys, &o)) {
        return;
    }
    gear->name = mt_reader_text(&s->r, o.found[GEAR_NAME]);
    gear->teeth = mt_reader_count(&s->r, o.found[GEAR_TEETH], 1, MT_MAX_TEETH, 0);
    if (o.found[GEAR_RATIO] != MT_NO_ADDR) {
        gear->ratio = mt_read_study_number(s, o.found[GEAR_RATIO]);
    }
    gear->sidebands = mt_reader_count(&s->r, o.found[GEAR_SIDEBANDS], 0, MT_MAX_SIDEBANDS, 0);
    gear->orders = read_orders(s, o.found[GEAR_ORDERS], 'G', &gear->n_orders);
}

/* A nominal speed with factors, or the two speeds themselves. */
static void read_speeds(mt_study_reader *s, const mt_study_object *o, mt_machine *machine)
{
    double range[2];
    (void)mt_read_study_one_of(s, o, MACHINE_SPEED, 2);
    machine->speed_hz = mt_read_study_number(s, o->found[MACHINE_SPEED]);
    if (o->found[MACHINE_SPEEDS] != MT_NO_ADDR) {
        if (mt_read_study_pair(s, o->found[MACHINE_SPEEDS], o->found[MACHINE_SPEEDS], range)) {
            machine->lower_hz = range[0];
            machine->upper_hz = range[1];
        }
    }
    if (!mt_read_study_has(s, o, MACHINE_RANGE)) {
        return;
    }
    if (!mt_read_study_has(s, o, MACHINE_SPEED)) {
        mt_diag_structure(s->r.diags, mt_read_study_place(s, o, MACHINE_RANGE),
                          "\"speed_range\" multiplies \"speed_hz\", which is missing");
    }
    if (o->found[MACHINE_RANGE] != MT_NO_ADDR &&
        mt_read_study_pair(s, o->found[MACHINE_RANGE], o->found[MACHINE_RANGE], range)) {
        machine->range_lower = range[0];
        machine->range_upper = range[1];
        mt_read_warning_range(&s->r, range[0], range[1], MT_MACHINE_LEAST_SPEED, "machine's",
                              o->found[MACHINE_RANGE]);
    }
}

void mt_read_study_machine(mt_study_reader *s, mt_addr value, mt_machine *machine)
{
    mt_study_object o;
    *machine = mt_machine_default(value);
    if (!mt_read_study_object(s, value, &mt_study_machine_keys, &o)) {
        return;
    }
    machine->name = mt_reader_text(&s->r, o.found[MACHINE_NAME]);
    read_speeds(s, &o, machine);
    if (!mt_read_study_has(s, &o, MACHINE_ORDERS) && !mt_read_study_has(s, &o, MACHINE_GEARS)) {
        (void)mt_read_study_one_of(s, &o, MACHINE_ORDERS, 2);
    }
    machine->orders = read_orders(s, o.found[MACHINE_ORDERS], 'E', &machine->n_orders);
    mt_items gears = mt_reader_some_items(&s->r, o.found[MACHINE_GEARS], "the list of gears");
    machine->gears = mt_reader_room(&s->r, &gears, sizeof *machine->gears);
    while (mt_items_next(&gears)) {
        if (mt_reader_type(&s->r, gears.at, MT_KEY_OBJECT)) {
            read_gear(s, gears.at, &machine->gears[machine->n_gears++]);
        }
    }
    machine->margin_percent = mt_read_study_number(s, o.found[MACHINE_MARGIN]);
}
