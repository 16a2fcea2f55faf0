/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Limits are wide on purpose: a good model is not warned of. Moduli [Pa]: silicone rubber has
 * some 1e6, steel 2e11, diamond 1.2e12; steel in MPa is 2.1e5, in GPa 210. Densities [kg/m^3]:
 * foams have 20 and more, osmium 22 590; steel in g/cm^3 is 7.85, in t/mm^3 7.85e-9, in
 * kg/mm^3 7.85e-6. Thicknesses [m]: no section is wider than the trunk of a giant tree, none
 * thinner than the finest wire. Loss factors: constrained layers of rubber reach 2, steel has
 * 1e-3; per cent are far above. A mode with a damping ratio of 1 does not vibrate; 2 % that
 * were written as 2 are far above. Speeds [1/min]: the largest wind turbines turn at 6, the
 * propellers of the smallest aircraft below 30 000. Accelerations [g]: a pyrotechnic shock has
 * some 1e4, the floor of the quietest laboratory 1e-8; densities [g^2/Hz] are at most some 100
 * of these squared over a bandwidth of 100 Hz. Slopes [dB/octave]: standards have up to 25, and
 * a notch some 100. A peak of a random vibration is 3 to 6 times its RMS.
 */
#include "base/possible.h"

#include <math.h>
#include <stddef.h>

#define FROM_ZERO    .least = 0.0, .most = HUGE_VAL
#define MEANT        .low = -HUGE_VAL, .high = HUGE_VAL
#define ANY          .least = -HUGE_VAL, .most = HUGE_VAL
#define FREELY       ANY, MEANT
#define NOT_NEGATIVE FROM_ZERO, .impossible = "must not be negative"
#define POSITIVE     FROM_ZERO, .above = true, .impossible = "must be above 0"
/* Of vibration: what no mechanism meets, and no square over- or underflows. */
#define LEVELS .least = 1e-30, .most = 1e30, .impossible = "must be within 1e-30 and 1e+30"

/* rad: more than one turn from the reference position is degrees, or a motor's shaft. */
#define WHOLE_TURN 6.283185307179586

const mt_possible mt_possible_of[MT_POSSIBLE_COUNT] = {
    [MT_POSSIBLE_NONE] = {FREELY},
    [MT_POSSIBLE_ANY] = {FREELY},
    [MT_POSSIBLE_NOT_NEGATIVE] = {NOT_NEGATIVE, MEANT},
    [MT_POSSIBLE_POSITIVE] = {POSITIVE, MEANT},
    [MT_POSSIBLE_NONZERO] = {FREELY, .with = "nonzero"},
    [MT_POSSIBLE_PART] =
        {.least = 0.0, .most = 1.0, .impossible = "is not within 0 and 1", MEANT, .with = NULL},
    [MT_POSSIBLE_MODULUS] = {POSITIVE, .low = 1e6, .high = 1e13, .warning = "modulus",
                             .below = "below 1e+06 Pa, less than any solid has: is it meant in "
                                      "MPa or GPa?",
                             .beyond = "above 1e+13 Pa, more than any solid has: is the unit "
                                       "Pa?"},
    [MT_POSSIBLE_DENSITY] = {POSITIVE, .low = 10.0, .high = 23000.0, .warning = "density",
                             .below =
                                 "below 10 kg/m^3, less than any solid has: is it meant in "
                                 "g/cm^3, t/mm^3 or kg/mm^3?",
                             .beyond = "above 23000 kg/m^3, more than any solid has: is the "
                                       "unit kg/m^3?"},
    [MT_POSSIBLE_THICKNESS] = {POSITIVE, .low = 1e-6, .high = 10.0, .warning = "section",
                               .below = "thinner than a micrometre: is the unit m?",
                               .beyond = "thicker than 10 m: is it meant in millimetres?",
                               .with = "lint_stout"},
    [MT_POSSIBLE_POISSON] = {.least = -1.0,
                             .above = true,
                             .most = 0.5,
                             .impossible = "must be above -1 and not above 0.5",
                             MEANT},
    [MT_POSSIBLE_LOSS] = {NOT_NEGATIVE, .low = -HUGE_VAL, .high = 2.0, .warning = "damping",
                          .beyond = "above 2, more than any material has: is it in percent?"},
    [MT_POSSIBLE_RATIO] = {NOT_NEGATIVE, .low = -HUGE_VAL, .high = 1.0, .at_high = true,
                           .warning = "damping",
                           .beyond = "critical or more, so that the mode does not vibrate: is "
                                     "it in percent?"},
    [MT_POSSIBLE_ANGLE] = {.least = -MT_DRIVE_REACH,
                           .most = MT_DRIVE_REACH,
                           .impossible = "at most 1000 rad",
                           .low = -WHOLE_TURN,
                           .high = WHOLE_TURN,
                           .warning = "drive",
                           .below = "more than a turn",
                           .beyond = "more than a turn",
                           .with = "lint_drive"},
    [MT_POSSIBLE_STROKE] = {FREELY, .with = "lint_stroke"},
    [MT_POSSIBLE_INNER] = {NOT_NEGATIVE, MEANT, .with = "lint_section"},
    [MT_POSSIBLE_INERTIA] = {NOT_NEGATIVE, MEANT, .with = "lint_tensor"},
    [MT_POSSIBLE_MATRIX] = {FREELY, .with = "lint_matrix"},
    [MT_POSSIBLE_POINT] = {FREELY, .with = "lint_line"},
    [MT_POSSIBLE_AXIS] = {FREELY, .with = "lint_axes"},
    [MT_POSSIBLE_GRAVITY] = {FREELY, .with = "lint_gravity"},
    [MT_POSSIBLE_WHOLE] = {FREELY, .with = "mt_reader_count"},
    [MT_POSSIBLE_SHARE] = {.least = 0.0,
                           .above = true,
                           .most = 1.0,
                           .impossible = "must be above 0 and at most 1",
                           MEANT},
    [MT_POSSIBLE_ENERGY_SHARE] = {.least = 0.0,
                                  .most = 100.0,
                                  .impossible = "must be from 0 to 100",
                                  MEANT},
    [MT_POSSIBLE_PROOF] = {.least = 0.0,
                           .most = 1e6,
                           .impossible = "must be from 0 to 1e+06",
                           MEANT},
    [MT_POSSIBLE_WEIGHT_SENSITIVITY] =
        {.least = 1.0,
         .above = true,
         .most = HUGE_VAL,
         .impossible = "must be above 1",
         .low = -HUGE_VAL,
         .high = 1e3,
         .warning = "spread",
         .beyond = "above 1000, so that one goal alone decides: is it a "
                   "factor?"},
    [MT_POSSIBLE_MET] = {POSITIVE, .low = -HUGE_VAL, .high = 50.0, .at_high = true,
                         .warning = "tolerance",
                         .beyond = "so wide that almost anything meets the goal"},
    [MT_POSSIBLE_TOLERANCE] = {.least = 0.0,
                               .above = true,
                               .most = 100.0,
                               .under = true,
                               .impossible = "must be above 0 and below 100",
                               .low = 0.01,
                               .high = HUGE_VAL,
                               .warning = "tolerance",
                               .below = "in percent, and next to nothing: is a hundred times "
                                        "as much meant?",
                               .with = "warn_fine"},
    [MT_POSSIBLE_MARGIN] = {.least = 0.0,
                            .most = 100.0,
                            .under = true,
                            .impossible = "must be at least 0 and below 100",
                            MEANT,
                            .with = "warn_margin"},
    [MT_POSSIBLE_ASKED] = {POSITIVE, MEANT, .with = "warn_target"},
    [MT_POSSIBLE_MEASURED] = {POSITIVE, MEANT, .with = "warn_reference"},
    [MT_POSSIBLE_BAND] = {NOT_NEGATIVE, MEANT, .with = "check_intervals"},
    [MT_POSSIBLE_RANGE] = {POSITIVE, MEANT, .with = "check_frequencies"},
    [MT_POSSIBLE_LIMIT] = {FREELY, .with = "check_requirements"},
    [MT_POSSIBLE_BOUND] = {FREELY, .with = "check_range"},
    [MT_POSSIBLE_VALUES] = {FREELY, .with = "check_catalogue"},
    [MT_POSSIBLE_RULE] = {FREELY, .with = "expand_rule"},
    [MT_POSSIBLE_VARIED] = {FREELY, .with = "check_vary"},
    [MT_POSSIBLE_SPEED] = {POSITIVE, .low = 0.01, .high = 500.0, .warning = "speed",
                           .below = "less than one turn in 100 s: is the unit 1/s?",
                           .beyond = "more than 30000 turns per minute: are turns per minute "
                                     "meant?"},
    [MT_POSSIBLE_RPM] = {POSITIVE, .low = 0.6, .high = 30000.0, .warning = "speed",
                         .below = "less than one turn in 100 s: are turns per second meant?",
                         .beyond = "more than 500 turns per second: is the unit rpm?"},
    [MT_POSSIBLE_MACHINE] = {POSITIVE, MEANT, .with = "warn_speed"},
    [MT_POSSIBLE_FACTORS] = {POSITIVE, MEANT, .with = "mt_read_warning_range"},
    [MT_POSSIBLE_HZ] = {.least = 1e-9,
                        .most = 1e9,
                        .impossible = "must be within 1e-09 and 1e+09 Hz",
                        .low = 1e-4,
                        .high = 1e6,
                        .warning = "frequency",
                        .below = "less than one period in three hours: is the unit Hz?",
                        .beyond = "above 1 MHz: is the unit Hz?",
                        .with = "check_order"},
    [MT_POSSIBLE_PSD_G] = {LEVELS, .low = 1e-18, .high = 1e6, .warning = "level",
                           .below = "next to nothing: is the unit g^2/Hz?",
                           .beyond = "beyond any vibration: is the unit g^2/Hz?",
                           .with = "follow_slopes"},
    [MT_POSSIBLE_PSD] = {LEVELS, .low = 1e-16, .high = 1e8, .warning = "level",
                         .below = "next to nothing: is the unit m^2/s^3?",
                         .beyond = "beyond any vibration: is the unit m^2/s^3?",
                         .with = "follow_slopes"},
    [MT_POSSIBLE_LEVEL_G] = {LEVELS, .low = 1e-9, .high = 1e4, .warning = "level",
                             .below = "next to nothing: is the unit g?",
                             .beyond = "beyond any vibration: is it meant in m/s^2?",
                             .with = "compare_with_print"},
    [MT_POSSIBLE_LEVEL] = {LEVELS, .low = 1e-8, .high = 1e5, .warning = "level",
                           .below = "next to nothing: is the unit m/s^2?",
                           .beyond = "beyond any vibration: is the unit m/s^2?"},
    [MT_POSSIBLE_SLOPE] = {ANY, .low = -300.0, .high = 300.0, .warning = "level",
                           .below = "steeper than any filter",
                           .beyond = "steeper than any filter", .with = "follow_slopes"},
    [MT_POSSIBLE_SIGMA] = {.least = 0.0,
                           .most = 100.0,
                           .impossible = "must be within 0 and 100",
                           .low = -HUGE_VAL,
                           .high = 10.0,
                           .warning = "level",
                           .beyond = "far above the 3 to 6 times the RMS that peaks have"},
};

bool mt_possible_is(const mt_possible *p, double value)
{
    return !(value < p->least || value > p->most || (p->above && value == p->least) ||
             (p->under && value == p->most));
}

const char *mt_possible_doubted(const mt_possible *p, double value)
{
    if (value < p->low) {
        return p->below;
    }
    return value > p->high || (p->at_high && value == p->high) ? p->beyond : NULL;
}
