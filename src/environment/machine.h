/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ENVIRONMENT_MACHINE_H
#define ENVIRONMENT_MACHINE_H

#include "base/document.h"
#include "io/reader.h"

/*
 * A machine that excites: an engine, a pump, a gearbox. Its shaft turns at f [1/s], anywhere
 * within f1 to f2, and each of its excitations occurs a fixed number of times per turn, its
 * order:
 *     order k of the shaft      k                       "0.5E", "1E", "1.5E": a four-stroke
 *                               cylinder fires every second turn
 *     mesh of a gear            k z r                   "1G", "2G": z teeth on a shaft that
 *                                                       turns r times as fast as the machine's
 *     its sidebands             (k z + s) r             "1G+1", "1G-2": modulated by the turns
 *                                                       of the gear's own shaft, s = -S .. S
 * Each order forbids the frequencies from order f1 to order f2 (bands.h). Rotors, with blades
 * and a tail, are in bands.h.
 */

/* An order as written, in thousandths, which are exact: a product with it is rounded once. */
typedef struct mt_order {
    const char *text;
    mt_addr addr;
    int thousandths;
} mt_order;

enum { MT_MAX_ORDER_THOUSANDTHS = 999999, MT_MAX_TEETH = 9999, MT_MAX_SIDEBANDS = 99 };

/**
 * Read a decimal number above 0 and below 1000 with at most three decimals and without leading
 * zeros, followed by the letter: "0.5E". Sets all but addr; text is not copied. Returns false
 * (out is zeroed) for anything else.
 */
bool mt_order_parse(const char *text, char letter, mt_order *out);

/* The correct form, with this letter, of a multiple per turn written otherwise ("4p", "4/rev",
 * "2"); NULL: not a multiple. */
const char *mt_read_multiple_meant(const mt_reader *r, const char *text, char letter);

typedef struct mt_gear {
    const char *name; /* NULL: the machine's */
    int teeth;
    double ratio; /* turns of its shaft per turn of the machine's; default 1 */
    int sidebands;
    int n_orders; /* multiples of the mesh; 0: the mesh itself */
    mt_order *orders;
    mt_addr addr;
} mt_gear;

/* Numbers are NaN where not given. */
typedef struct mt_machine {
    const char *name;   /* in labels; NULL: "machine" */
    double speed_hz;    /* nominal; its range is range_lower to range_upper times it; or */
    double range_lower; /* default 1 and 1 */
    double range_upper;
    double lower_hz; /* the lowest and highest speed themselves */
    double upper_hz;
    int n_orders;
    mt_order *orders;
    int n_gears;
    mt_gear *gears;
    double margin_percent; /* default: that of the list of bands */
    mt_addr addr;
} mt_machine;

mt_gear mt_gear_default(mt_addr addr);
/* The address of its range of speeds, in either form; its own where none is given. */
mt_addr mt_machine_range_addr(const mt_machine *machine, const mt_diags *diags);
mt_machine mt_machine_default(mt_addr addr);
/* Lowest (end 0) or highest (end 1) speed [1/s]; NaN where not known. */
double mt_machine_speed_hz(const mt_machine *machine, int end);

/* An excitation of `order` times per turn of the machine: `what` ("1.5E", "1G-1") of `of`
 * ("engine", "pinion"). */
typedef struct mt_order_line {
    double order;
    const char *what;
    const char *of;
} mt_order_line;

/* The number of lines of a machine. */
int mt_machine_line_count(const mt_machine *machine);
/* All lines of a machine, lines[mt_machine_line_count]. Texts are the machine's or in mem.
 * Fails: MT_E_MEMORY. */
mt_status mt_machine_lines(const mt_machine *machine, mt_arena *mem, mt_order_line *lines,
                           mt_err *err);

#endif
