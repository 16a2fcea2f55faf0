/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Machines whose orders and gear meshes are to be avoided. */
#include "study/read_priv.h"

#include "environment/read_harmonics.h"
#include "environment/rotor.h"

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

static void gear_defaults(void *item, mt_addr addr, int which)
{
    (void)which;
    *(mt_gear *)item = mt_gear_default(addr);
}

static void gear_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_gear *const gear = item;
    (void)which;
    gear->orders =
        read_orders(mt_study_reader_of(r), mt_object_value(o, "orders"), 'G', &gear->n_orders);
}

#define THIS mt_gear
static const mt_key GEAR[] = {
    MT_M_COUNT("teeth", true, teeth, 1, MT_MAX_TEETH, "Number of teeth."),
    MT_S_NUMBER("ratio", false, ratio, POSITIVE,
                "Turns of its shaft per turn of the machine's.", .otherwise = "1"),
    {.name = "orders",
     .type = MT_KEY_LIST,
     .says = "Multiples of the mesh, up to three decimals: \"1G\", \"2G\".",
     .otherwise = "[\"1G\"]",
     .schema =
         "\"type\": \"array\", \"minItems\": 1, \"items\": {\"type\": \"string\", \"pattern\": "
         "\"^(?!0(\\\\.0{1,3})?G)(0|[1-9][0-9]{0,2})(\\\\.[0-9]{1,3})?G$\"}"},
    MT_M_COUNT("sidebands", false, sidebands, 0, MT_MAX_SIDEBANDS,
               "Number of sidebands on each side of every multiple, spaced by the speed of its "
               "own shaft.",
               .otherwise = "0"),
    MT_M_TEXT("name", name, "Its name in reports. Absent: the machine."),
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_study_gear_keys = {
    .what = "gear",
    .keys = GEAR,
    .n = MT_COUNT(GEAR),
    .size = sizeof(mt_gear),
    .defaults = gear_defaults,
    .finish = gear_finish,
    .says = "A gear of a machine: it meshes teeth times ratio times per turn of the machine.",
    .examples = "[{\"name\": \"pinion\", \"teeth\": 23, \"ratio\": 1.5, \"orders\": [\"1G\", "
                "\"2G\"], \"sidebands\": 1}]"};

static void machine_defaults(void *item, mt_addr addr, int which)
{
    (void)which;
    *(mt_machine *)item = mt_machine_default(addr);
}

/* A nominal speed with factors, or the two speeds themselves; orders, or gears. */
static void machine_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_machine *const machine = item;
    const mt_addr range = mt_object_value(o, "speed_range");
    (void)which;
    if (mt_object_has(r, o, "speed_range") && !mt_object_has(r, o, "speed_hz")) {
        mt_diag_structure(r->diags, mt_object_place(r, o, "speed_range"),
                          "\"speed_range\" multiplies \"speed_hz\", which is missing");
    }
    if (range != MT_NO_ADDR && MT_HAS(machine->range_lower)) {
        mt_read_warning_range(r, machine->range_lower, machine->range_upper,
                              MT_MACHINE_LEAST_SPEED, "machine's", range);
    }
    if (!mt_object_has(r, o, "orders") && !mt_object_has(r, o, "gears")) {
        (void)mt_object_one_of(r, o, "orders", 2);
    }
    machine->orders = read_orders(mt_study_reader_of(r), mt_object_value(o, "orders"), 'E',
                                  &machine->n_orders);
}

#define THIS mt_machine
static const mt_key MACHINE[] = {
    MT_S_NUMBER("speed_hz", false, speed_hz, MACHINE,
                "Nominal speed [1/s]; \"1500*rpm\" is 25."),
    MT_S_PAIR("speed_range_hz", false, lower_hz, upper_hz, MACHINE,
              "Least and greatest speed [1/s]."),
    MT_S_PAIR("speed_range", false, range_lower, range_upper, FACTORS,
              "Least and greatest speed, as multiples of the nominal one.",
              .otherwise = "[1, 1]", .examples = "[[0.95, 1.05]]"),
    MT_M_TEXT("name", name, "Its name in reports. Absent: \"machine\"."),
    {.name = "orders",
     .type = MT_KEY_LIST,
     .says = "Events per turn of its shaft, up to three decimals: \"1E\"; half orders of a "
             "four-stroke engine \"0.5E\", \"1.5E\".",
     .schema =
         "\"type\": \"array\", \"minItems\": 1, \"items\": {\"type\": \"string\", \"pattern\": "
         "\"^(?!0(\\\\.0{1,3})?E)(0|[1-9][0-9]{0,2})(\\\\.[0-9]{1,3})?E$\"}"},
    MT_M_ITEMS("gears", false, gears, n_gears, mt_gear, "the list of gears", mt_study_gear_keys,
               "Gears whose meshes are forbidden too."),
    MT_S_NUMBER("margin_percent", false, margin_percent, MARGIN,
                "Separation margin on both sides of its bands, in percent of their edges. "
                "Absent: the goal's."),
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_study_machine_keys = {
    .what = "machine",
    .keys = MACHINE,
    .n = MT_COUNT(MACHINE),
    .one_of = 2,
    .size = sizeof(mt_machine),
    .defaults = machine_defaults,
    .finish = machine_finish,
    .says = "A machine (engine, pump, gearbox) whose orders are forbidden over its range of "
            "speeds: events per turn of its shaft, and gear meshes.",
    .examples = "[{\"name\": \"engine\", \"speed_range_hz\": [\"700*rpm\", \"3000*rpm\"], "
                "\"orders\": [\"0.5E\", \"1E\", \"2E\"], \"margin_percent\": 10}]",
    .rules = "\"anyOf\": [{\"required\": [\"orders\"]}, {\"required\": [\"gears\"]}], "
             "\"dependencies\": {\"speed_range\": [\"speed_hz\"]}"};
