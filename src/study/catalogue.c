/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * IEC 60063: the values of E48, E96 and E192 are 10^(i/N) rounded to three digits, but for 9.20
 * in E192, where the rule says 9.19. E24 and below are older and have two digits that no rule
 * gives; E12, E6 and E3 are every second, fourth and eighth of E24.
 */
#include "study/catalogue.h"

#include <math.h>
#include <stddef.h>

static const int E24[] = {100, 110, 120, 130, 150, 160, 180, 200, 220, 240, 270, 300,
                          330, 360, 390, 430, 470, 510, 560, 620, 680, 750, 820, 910};
enum {
    E24_SIZE = MT_COUNT(E24),
    E192_SIZE = 192,
    E192_EXCEPTION = 185,
    E192_EXCEPTIONAL = 920
};

/* Bounds are often expressions: 3 * 1.1 is a rounding above 3.3. */
static const double BOUND_SLACK = 1e-12;
/* The same, in steps: differences of two rounded numbers, divided. */
static const double STEP_SLACK = 1e-9;

#define SERIES_NAME(n) "E" #n,
const char *const mt_series_names[] = {MT_SERIES_LIST(SERIES_NAME)};
#define SERIES_SIZE(n) n,
static const int SIZES[] = {MT_SERIES_LIST(SERIES_SIZE)};

/* The i-th value of a decade, in hundredths: 100 to 999. */
static int digits(int per_decade, int i)
{
    if (per_decade <= E24_SIZE) {
        const int position = i * (E24_SIZE / per_decade);
        return E24[position];
    }
    if (i * (E192_SIZE / per_decade) == E192_EXCEPTION) {
        return E192_EXCEPTIONAL;
    }
    return (int)lround(100.0 * pow(10.0, (double)i / (double)per_decade));
}

/* digits * 10^(decade - 2): one rounding, as powers of ten up to 22 are exact. */
static double decimal_value(int hundredths, int decade)
{
    const int exponent = decade - 2;
    return exponent >= 0 ? (double)hundredths * pow(10.0, (double)exponent)
                         : (double)hundredths / pow(10.0, (double)-exponent);
}

int mt_catalogue_series(int which, double lower, double upper, int most, double *values)
{
    const int per_decade = SIZES[which];
    int n = 0;
    if (!(lower > 0.0) || !isfinite(lower) || !isfinite(upper)) {
        return 0;
    }
    const double least = lower * (1.0 - BOUND_SLACK);
    const double greatest = upper * (1.0 + BOUND_SLACK);
    for (int decade = (int)floor(log10(lower)) - 1; n <= MT_MAX_CATALOGUE; decade++) {
        if (decimal_value(digits(per_decade, 0), decade) > greatest) {
            break;
        }
        for (int i = 0; i < per_decade && n <= MT_MAX_CATALOGUE; i++) {
            const double value = decimal_value(digits(per_decade, i), decade);
            if (value < least || value > greatest) {
                continue;
            }
            if (values != NULL && n < most) {
                values[n] = value;
            }
            n++;
        }
    }
    return n;
}

int mt_catalogue_steps(double step, double lower, double upper, int most, double *values)
{
    if (!(step > 0.0) || !(lower <= upper) || !isfinite(lower) || !isfinite(upper)) {
        return 0;
    }
    const double steps = floor((upper - lower) / step + STEP_SLACK);
    if (!(steps < (double)MT_MAX_CATALOGUE)) {
        return MT_MAX_CATALOGUE + 1;
    }
    const int n = (int)steps + 1;
    for (int i = 0; values != NULL && i < n && i < most; i++) {
        const double value = lower + (double)i * step;
        values[i] = value < upper ? value : upper;
    }
    return n;
}
