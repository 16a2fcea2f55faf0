/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef EXPR_UNIT_TEXT_H
#define EXPR_UNIT_TEXT_H

#include <stdbool.h>
#include <stddef.h>

/* 1 of a unit is so many m^a kg^b s^c rad^d. */
enum { MT_BASE_M, MT_BASE_KG, MT_BASE_S, MT_BASE_RAD, MT_BASES };
typedef struct mt_unit_worth {
    double factor;
    int power[MT_BASES];
} mt_unit_worth;

/* What words mean that have two meanings: a gram or 9.80665 m/s^2, a pound or its weight. */
typedef enum mt_unit_reading {
    MT_READ_MASSES,
    MT_READ_ACCELERATIONS, /* g */
    MT_READ_FORCES,        /* lb */
    MT_READ_BOTH,          /* g an acceleration, lb a force */
    MT_READINGS
} mt_unit_reading;

/*
 * A unit as people and instruments write it: "N mm/rad", "(m/s^2)/N", "m/(N*s**2)", "m/s2",
 * "kg*mm²" (UTF-8 or Latin-1), "10^3 N", "lbf-in". Factors follow each other, or have a blank,
 * *, a dot or a hyphen between them; what a / stands before, alone, divides. Symbols are as of
 * SI, with its prefixes, and of inches and pounds. False: it is none.
 */
bool mt_unit_read(const char *text, mt_unit_reading reading, mt_unit_worth *out);
/* Whether they measure the same. A radian counts where `radians` says so. */
bool mt_unit_same_powers(const mt_unit_worth *a, const mt_unit_worth *b, bool radians);
/* Factors that are equal, but for their rounding. */
bool mt_unit_same_factor(double a, double b);

#endif
