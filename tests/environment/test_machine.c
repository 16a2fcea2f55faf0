/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Orders of machines: read exactly, multiplied once, spread over the range of speeds. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "environment/bands.h"
#include "mt_test.h"

static const double TOL = 1e-15;

static void orders__are_read_as_written(mt_test *t)
{
    static const struct {
        const char *text;
        char letter;
        int thousandths; /* 0: no order */
    } rows[] = {
        {"0.5E", 'E', 500},
        {"1E", 'E', 1000},
        {"1.5E", 'E', 1500},
        {"2.50E", 'E', 2500},
        {"0.001E", 'E', 1},
        {"999.999E", 'E', 999999},
        {"12.125E", 'E', 12125},
        {"10E", 'E', 10000},
        {"1G", 'G', 1000},
        {"0.5G", 'G', 500},
        {"1E", 'G', 0},
        {"1G", 'E', 0},
        {"", 'E', 0},
        {"E", 'E', 0},
        {"1", 'E', 0},
        {"0E", 'E', 0},
        {"0.0E", 'E', 0},
        {"0.000E", 'E', 0},
        {"00E", 'E', 0},
        {"01E", 'E', 0},
        {"00.5E", 'E', 0},
        {".5E", 'E', 0},
        {"1.E", 'E', 0},
        {"1.2345E", 'E', 0},
        {"1000E", 'E', 0},
        {"9999999999E", 'E', 0},
        {"1e", 'E', 0},
        {"1EE", 'E', 0},
        {"1E ", 'E', 0},
        {" 1E", 'E', 0},
        {"+1E", 'E', 0},
        {"-1E", 'E', 0},
        {"1,5E", 'E', 0},
        {"1/2E", 'E', 0},
        {"nE", 'E', 0},
        {"1e1E", 'E', 0},
        {"1.5.5E", 'E', 0},
        {"\xC2\xBD"
         "E",
         'E', 0},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_order o;
        const bool ok = rows[i].thousandths > 0;
        mt_test_row(t, "\"%s\" as %c", rows[i].text, rows[i].letter);
        CHECK(t, mt_order_parse(rows[i].text, rows[i].letter, &o) == ok);
        CHECK_INT(t, o.thousandths, rows[i].thousandths);
        CHECK_STR(t, o.text, ok ? rows[i].text : NULL);
    }
}

/* Every order that can be written is the double nearest to its decimal number. */
static void orders__are_rounded_once(mt_test *t)
{
    int wrong = 0;
    mt_arena none = {0}; /* orders without sidebands ask for nothing */
    for (int i = 1; i <= MT_MAX_ORDER_THOUSANDTHS; i++) {
        char text[16];
        mt_order o;
        mt_order_line line = {0.0, NULL, NULL};
        (void)snprintf(text, sizeof text, "%d.%03dE", i / 1000, i % 1000);
        mt_machine m = mt_machine_default(MT_NO_ADDR);
        m.n_orders = 1;
        m.orders = &o;
        const bool ok = mt_order_parse(text, 'E', &o) && o.thousandths == i &&
                        mt_machine_lines(&m, &none, &line, NULL) == MT_OK;
        text[strlen(text) - 1] = '\0';
        wrong += ok && line.order == strtod(text, NULL) ? 0 : 1;
    }
    CHECK_INT(t, wrong, 0);
}

static void lines__of_gears_have_teeth_ratio_and_sidebands(mt_test *t)
{
    static const struct {
        double order;
        const char *what;
        const char *of;
    } want[] = {
        {0.5, "0.5E", "engine"},          {(23.0 - 2.0) * 0.8, "1G-2", "pinion"},
        {22.0 * 0.8, "1G-1", "pinion"},   {23.0 * 0.8, "1G", "pinion"},
        {24.0 * 0.8, "1G+1", "pinion"},   {25.0 * 0.8, "1G+2", "pinion"},
        {32.5 * 0.8, "1.5G-2", "pinion"}, {33.5 * 0.8, "1.5G-1", "pinion"},
        {34.5 * 0.8, "1.5G", "pinion"},   {35.5 * 0.8, "1.5G+1", "pinion"},
        {36.5 * 0.8, "1.5G+2", "pinion"}, {17.0, "1G", "engine"},
    };
    mt_order e;
    mt_order g[2];
    mt_gear gears[2] = {mt_gear_default(MT_NO_ADDR), mt_gear_default(MT_NO_ADDR)};
    mt_machine m = mt_machine_default(MT_NO_ADDR);
    mt_order_line lines[MT_COUNT(want)];
    mt_arena mem;
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    CHECK(t, mt_order_parse("0.5E", 'E', &e) && mt_order_parse("1G", 'G', &g[0]) &&
                 mt_order_parse("1.5G", 'G', &g[1]));
    gears[0].name = "pinion";
    gears[0].teeth = 23;
    gears[0].ratio = 0.8;
    gears[0].sidebands = 2;
    gears[0].n_orders = 2;
    gears[0].orders = g;
    gears[1].teeth = 17;
    m.name = "engine";
    m.n_orders = 1;
    m.orders = &e;
    m.n_gears = 2;
    m.gears = gears;
    if (CHECK_INT(t, mt_machine_line_count(&m), MT_COUNT(want)) &&
        CHECK_INT(t, mt_machine_lines(&m, &mem, lines, NULL), MT_OK)) {
        for (int i = 0; i < MT_COUNT(want); i++) {
            mt_test_row(t, "%s of %s", want[i].what, want[i].of);
            CHECK_NEAR(t, lines[i].order, want[i].order, TOL);
            CHECK_STR(t, lines[i].what, want[i].what);
            CHECK_STR(t, lines[i].of, want[i].of);
        }
    }
    mt_arena_free(&mem);
}

enum { ORDERS = 8 };

/* Bands of orders 0.5 to 4 over a range of speeds: disjoint where it is narrow, one where it is
 * wide, and every frequency order x speed is inside. */
static void bands__cover_every_order_at_every_speed(mt_test *t)
{
    static const struct {
        double lower;
        double upper;
        double margin;
        int bands;
        const char *label; /* of the last */
    } rows[] = {
        {49.0, 50.0, 0.0, 8, "4E of engine"},
        {30.0, 31.0, 10.0, 4, "2E + 2.5E + 3E + 3.5E + 4E of engine"},
        {700.0 / 60.0, 50.0, 5.0, 1, "0.5E to 4E of engine (8 bands)"},
        {25.0, 25.0, 1.0, 8, "4E of engine"},
    };
    static const char *const texts[ORDERS] = {"0.5E", "1E", "1.5E", "2E",
                                              "2.5E", "3E", "3.5E", "4E"};
    mt_order orders[ORDERS];
    for (int i = 0; i < ORDERS; i++) {
        CHECK(t, mt_order_parse(texts[i], 'E', &orders[i]));
    }
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_machine m = mt_machine_default(MT_NO_ADDR);
        mt_bands_source source = {
            .n_machines = 1, .machines = &m, .margin_percent = nan(""), .up_to_hz = nan("")};
        mt_bands bands;
        mt_arena mem;
        mt_test_row(t, "%g to %g, %g %%", rows[i].lower, rows[i].upper, rows[i].margin);
        REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
        m.name = "engine";
        m.lower_hz = rows[i].lower;
        m.upper_hz = rows[i].upper;
        m.margin_percent = rows[i].margin;
        m.n_orders = ORDERS;
        m.orders = orders;
        CHECK_INT(t, mt_bands_make(&source, nan(""), &mem, &bands, NULL), MT_OK);
        if (CHECK_INT(t, bands.n, rows[i].bands)) {
            CHECK_STR(t, bands.items[bands.n - 1].label, rows[i].label);
        }
        CHECK_NEAR(t, bands.items[0].lower_hz,
                   0.5 * rows[i].lower * (1.0 - rows[i].margin / 100.0), TOL);
        CHECK_NEAR(t, bands.items[bands.n - 1].upper_hz,
                   4.0 * rows[i].upper * (1.0 + rows[i].margin / 100.0), TOL);
        int outside = 0;
        for (int k = 0; k <= 100; k++) {
            const double speed =
                rows[i].lower + ((rows[i].upper - rows[i].lower) * (double)k / 100.0);
            for (int o = 0; o < ORDERS; o++) {
                const double hz = 0.5 * (double)(o + 1) * speed;
                int in = 0;
                for (int b = 0; b < bands.n; b++) {
                    in += hz >= bands.items[b].base_lower_hz * (1.0 - TOL) &&
                                  hz <= bands.items[b].base_upper_hz * (1.0 + TOL)
                              ? 1
                              : 0;
                }
                outside += in == 1 ? 0 : 1;
            }
        }
        CHECK_INT(t, outside, 0);
        CHECK(t, bands.n == ORDERS || bands.n_notes > 0);
        mt_arena_free(&mem);
    }
}

MT_TEST_MAIN(MT_TEST(orders__are_read_as_written), MT_TEST(orders__are_rounded_once),
             MT_TEST(lines__of_gears_have_teeth_ratio_and_sidebands),
             MT_TEST(bands__cover_every_order_at_every_speed))
