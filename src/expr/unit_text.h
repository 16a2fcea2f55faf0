/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef EXPR_UNIT_TEXT_H
#define EXPR_UNIT_TEXT_H

#include <stdbool.h>
#include <stddef.h>

/* 1 of a unit is factor m^a kg^b s^c rad^d, powers in this order. */
enum { MT_BASE_M, MT_BASE_KG, MT_BASE_S, MT_BASE_RAD, MT_BASES };
typedef struct mt_unit_worth {
    double factor;
    int power[MT_BASES];
} mt_unit_worth;

/* Reading of symbols with two meanings: g is a gram or 9.80665 m/s^2, lb a mass or a force. */
typedef enum mt_unit_reading {
    MT_READ_MASSES,
    MT_READ_ACCELERATIONS, /* g */
    MT_READ_FORCES,        /* lb */
    MT_READ_BOTH,          /* g an acceleration, lb a force */
    MT_READINGS
} mt_unit_reading;

/*
 * Parse a unit as people and instruments write it: "N mm/rad", "(m/s^2)/N", "m/(N*s**2)",
 * "m/s2", "kg*mm²" (UTF-8 or Latin-1), "10^3 N", "lbf-in". Factors are adjacent, or separated
 * by a blank, *, a dot or a hyphen; a / divides by the one factor after it. Symbols of SI with
 * prefixes, and of inches and pounds. False: not a unit.
 */
bool mt_unit_read(const char *text, mt_unit_reading reading, mt_unit_worth *out);
/* True where both have the same powers; that of rad is compared where `radians` is set. */
bool mt_unit_same_powers(const mt_unit_worth *a, const mt_unit_worth *b, bool radians);
/* True where the factors are equal up to rounding. */
bool mt_unit_same_factor(double a, double b);

#endif
