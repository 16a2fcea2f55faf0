/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TESTS_IO_RESULT_CURVES_SAMPLE_H
#define TESTS_IO_RESULT_CURVES_SAMPLE_H

/* Curves for the sample of test_result_file.c. */
#include "base/base.h"
#include "result/curves.h"

static double HZ[] = {5.0, 22.101234567, 500.0};
static double MAGNITUDES[] = {1.0 / 3.0, 48.123456789, 2e-7};
static double DENSITY_THERE[] = {1e-30, 2.0 / 3.0, 3.0};
static double PHASES[] = {0.0, -90.0 - (1.0 / 3.0), 180.0};
static mt_result_extreme EXTREMES[] = {
    {"resonance", 22.1012345678901, 0.0, 0.0, 22.0, 0.0},
    {"antiresonance", 30.0, 0.1 + 0.2, -12.5, 0.0, 0.0},
};
static mt_result_forced_response_tone FORCED_RESPONSE_TONES[] = {
    {"4P", 17.2, 3.25, 1e-12, true}};
static mt_result_forced_response FORCED_RESPONSE = {"finite", true, 1.5, 1e-13,
                                                    3.25,     7.75, 1,   FORCED_RESPONSE_TONES};
static mt_design_curve DESIGN_CURVES[] = {
    {.pointer = "/responses/0",
     .configuration = "installed",
     .drawn = {MT_COUNT(HZ), HZ, MT_COUNT(HZ), MAGNITUDES, MT_COUNT(HZ), PHASES, MT_COUNT(HZ),
               DENSITY_THERE},
     .n_extremes = MT_COUNT(EXTREMES),
     .extremes = EXTREMES,
     .vibration = &FORCED_RESPONSE},
    {.pointer = "/responses/1", .configuration = "installed", .trouble = "nothing settles"}};
static double LEVELS[] = {0.5, 0.25, 0.125};
static mt_result_density DENSITIES[] = {{MT_COUNT(HZ), HZ, MT_COUNT(LEVELS), LEVELS}};
static mt_result_tone TONES[] = {{"4P", 17.0, 17.5, 0.5}};
static mt_result_profile PROFILE = {"floor.json", "floor", 2.5,  3.0, "sum", 1,
                                    DENSITIES,    1,       TONES};
static mt_result_limit LIMITS[] = {{"/goals/1", 10.0, 60.0, 0.0, 0.0, 2.5}};
static mt_result_curve CURVES[] = {
    {.pointer = "/responses/0",
     .configuration = "installed",
     .input = "base.y:acceleration",
     .output = "grip.y:acceleration",
     .unit = "m/s^2 per m/s^2",
     .output_unit = "m/s^2",
     .lower_hz = 5.0,
     .upper_hz = 500.0,
     .description = "the hand",
     .n_limits = 1,
     .limits = LIMITS,
     .profile = &PROFILE,
     .measured = {MT_COUNT(HZ), HZ, MT_COUNT(HZ), MAGNITUDES, MT_COUNT(HZ), PHASES, 0, NULL}},
    {.pointer = "/responses/1",
     .configuration = "installed",
     .input = "grip.y",
     .output = "grip.y:displacement",
     .unit = "m per N",
     .output_unit = "m",
     .lower_hz = 5.0,
     .upper_hz = 50.0,
     .source = "a test"}};

#endif
