/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "environment/machine.h"

#include <math.h>
#include <string.h>

enum { WHOLE_DIGITS = 3, DECIMALS = 3, TEN = 10, THOUSAND = 1000 };

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

bool mt_order_parse(const char *text, char letter, mt_order *out)
{
    const char *s = text;
    int value = 0;
    int scale = THOUSAND;
    *out = (mt_order){.addr = MT_NO_ADDR};
    if (!is_digit(*s) || (*s == '0' && is_digit(s[1]))) {
        return false;
    }
    for (int i = 0; is_digit(*s); s++, i++) {
        if (i == WHOLE_DIGITS) {
            return false;
        }
        value = (TEN * value) + (THOUSAND * (*s - '0'));
    }
    if (*s == '.') {
        s++;
        if (!is_digit(*s)) {
            return false;
        }
        for (int i = 0; is_digit(*s); s++, i++) {
            if (i == DECIMALS) {
                return false;
            }
            scale /= TEN;
            value += scale * (*s - '0');
        }
    }
    if (value == 0 || *s != letter || s[1] != '\0') {
        return false;
    }
    *out = (mt_order){.thousandths = value, .text = text, .addr = MT_NO_ADDR};
    return true;
}

const char *mt_read_multiple_meant(const mt_reader *r, const char *text, char letter)
{
    static const char *const ways[] = {"",        "p",     "/rev", "/turn",   "perrev",
                                       "perturn", "omega", "x",    "\xC3\x97"};
    char plain[16] = "";
    size_t digits = 0;
    size_t n = 0;
    for (const char *s = text; *s != '\0'; s++) { /* without blanks, small letters */
        const bool capital = *s >= 'A' && *s <= 'Z';
        if (n + 1 >= sizeof plain) {
            return NULL;
        }
        if (*s != ' ') {
            plain[n++] = (char)(capital ? *s - 'A' + 'a' : *s);
        }
    }
    plain[n] = '\0';
    digits = strspn(plain, letter == 'P' || letter == 'T' ? "0123456789" : "0123456789.");
    const bool blades = plain[digits] == 'n' && letter == 'P';
    const char *const way = plain + digits + (blades ? 1 : 0);
    bool known = way[0] != '\0' && way[1] == '\0' && way[0] == (char)(letter - 'A' + 'a');
    for (int i = 0; i < MT_COUNT(ways); i++) {
        known = known || strcmp(way, ways[i]) == 0;
    }
    return known && (digits > 0 || blades) ? mt_arena_printf(r->mem, "%.*s%s%c", (int)digits,
                                                             plain, blades ? "n" : "", letter)
                                           : NULL;
}

mt_gear mt_gear_default(mt_addr addr)
{
    return (mt_gear){.ratio = 1.0, .addr = addr};
}

mt_addr mt_machine_range_addr(const mt_machine *machine, const mt_diags *diags)
{
    const mt_addr factors = mt_diag_member(diags, machine->addr, "speed_range");
    return factors != machine->addr ? factors
                                    : mt_diag_member(diags, machine->addr, "speed_range_hz");
}

mt_machine mt_machine_default(mt_addr addr)
{
    return (mt_machine){.speed_hz = nan(""),
                        .range_lower = 1.0,
                        .range_upper = 1.0,
                        .lower_hz = nan(""),
                        .upper_hz = nan(""),
                        .margin_percent = nan(""),
                        .addr = addr};
}

double mt_machine_speed_hz(const mt_machine *machine, int end)
{
    const double itself = end == 0 ? machine->lower_hz : machine->upper_hz;
    const double factor = end == 0 ? machine->range_lower : machine->range_upper;
    return itself == itself ? itself : machine->speed_hz * factor;
}

static int gear_orders(const mt_gear *gear)
{
    return gear->n_orders > 0 ? gear->n_orders : 1;
}

int mt_machine_line_count(const mt_machine *machine)
{
    int n = machine->n_orders;
    for (int i = 0; i < machine->n_gears; i++) {
        n += gear_orders(&machine->gears[i]) * ((2 * machine->gears[i].sidebands) + 1);
    }
    return n;
}

/* The lines of one multiple of a mesh, from the lowest sideband up. */
static void mesh_lines(const mt_gear *gear, const mt_order *order, const char *of,
                       mt_arena *mem, mt_order_line *lines)
{
    const double teeth = (double)order->thousandths * (double)gear->teeth;
    for (int s = -gear->sidebands; s <= gear->sidebands; s++) {
        /* thousandths of turns are whole numbers: rounded by the division and by the ratio
         * only */
        const double turns = (teeth + (double)(THOUSAND * s)) / (double)THOUSAND;
        const char *const what =
            s == 0 ? order->text : mt_arena_printf(mem, "%s%+d", order->text, s);
        *lines++ = (mt_order_line){.order = turns * gear->ratio, .what = what, .of = of};
    }
}

mt_status mt_machine_lines(const mt_machine *machine, mt_arena *mem, mt_order_line *lines,
                           mt_err *err)
{
    static const mt_order mesh = {.thousandths = THOUSAND, .text = "1G", .addr = MT_NO_ADDR};
    const char *const of = machine->name == NULL ? "machine" : machine->name;
    for (int i = 0; i < machine->n_orders; i++) {
        *lines++ = (mt_order_line){.order = (double)machine->orders[i].thousandths / THOUSAND,
                                   .what = machine->orders[i].text,
                                   .of = of};
    }
    for (int i = 0; i < machine->n_gears; i++) {
        const mt_gear *const gear = &machine->gears[i];
        for (int k = 0; k < gear_orders(gear); k++) {
            const mt_order *const order = gear->n_orders > 0 ? &gear->orders[k] : &mesh;
            mesh_lines(gear, order, gear->name == NULL ? of : gear->name, mem, lines);
            lines += (2 * gear->sidebands) + 1;
        }
    }
    return mt_arena_check(mem, err);
}
