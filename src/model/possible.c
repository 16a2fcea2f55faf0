/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Limits are wide on purpose: a good model is not warned of. Moduli [Pa]: silicone rubber has
 * some 1e6, steel 2e11, diamond 1.2e12; steel in MPa is 2.1e5, in GPa 210. Densities [kg/m^3]:
 * foams have 20 and more, osmium 22 590; steel in g/cm^3 is 7.85, in t/mm^3 7.85e-9, in
 * kg/mm^3 7.85e-6. Thicknesses [m]: no section is wider than the trunk of a giant tree, none
 * thinner than the finest wire. Loss factors: constrained layers of rubber reach 2, steel has
 * 1e-3; per cent are far above. A mode with a damping ratio of 1 does not vibrate; 2 % that
 * were written as 2 are far above.
 */
#include "model/possible.h"

#include <math.h>
#include <stddef.h>

#include "model/model.h" /* MT_DRIVE_REACH */

#define FROM_ZERO    .least = 0.0, .most = HUGE_VAL
#define MEANT        .low = -HUGE_VAL, .high = HUGE_VAL
#define FREELY       .least = -HUGE_VAL, .most = HUGE_VAL, MEANT
#define NOT_NEGATIVE FROM_ZERO, .impossible = "must not be negative"
#define POSITIVE     FROM_ZERO, .above = true, .impossible = "must be above 0"

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
                               .with = "judge_stout"},
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
                           .with = "judge_drive"},
    [MT_POSSIBLE_STROKE] = {FREELY, .with = "judge_stroke"},
    [MT_POSSIBLE_INNER] = {NOT_NEGATIVE, MEANT, .with = "judge_section"},
    [MT_POSSIBLE_INERTIA] = {NOT_NEGATIVE, MEANT, .with = "mt_judge_tensor"},
    [MT_POSSIBLE_MATRIX] = {FREELY, .with = "judge_matrix"},
    [MT_POSSIBLE_POINT] = {FREELY, .with = "judge_line"},
    [MT_POSSIBLE_AXIS] = {FREELY, .with = "judge_axes"},
    [MT_POSSIBLE_GRAVITY] = {FREELY, .with = "judge_gravity"},
    [MT_POSSIBLE_WHOLE] = {FREELY, .with = "mt_reader_count"},
    [MT_POSSIBLE_STUDY] = {FREELY, .with = "mt_study_finish"},
    [MT_POSSIBLE_PROFILE] = {FREELY, .with = "mt_vibration_finish"},
};
