/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "environment/rotor.h"

#include <string.h>

enum { MOST_ORDERS = 1000 };

bool mt_rotor_too_many(mt_diags *diags, int n, mt_addr addr, const char *what)
{
    if (n > MOST_ORDERS) {
        mt_diag_error(diags, addr, "more than %d %s", (int)MOST_ORDERS, what);
    }
    return n > MOST_ORDERS;
}

void mt_rotor_take(mt_rotor *rotor, const mt_aircraft *aircraft)
{
    rotor->speed_hz = aircraft->main_rotor.speed.value;
    rotor->blades = (int)aircraft->main_rotor.blades.value;
    if (aircraft->has_tail) {
        rotor->tail_speed_hz = aircraft->tail_rotor.speed.value;
        rotor->tail_blades = (int)aircraft->tail_rotor.blades.value;
    }
}

static int add_warning(mt_rotor_warning *out, int n, bool used, const char *what,
                       const mt_aircraft_value *value)
{
    if (used && !value->confirmed) {
        out[n++] = (mt_rotor_warning){what, value};
    }
    return n;
}

int mt_rotor_warnings(const mt_rotor *rotor, const mt_aircraft *aircraft,
                      mt_rotor_warning out[MT_ROTOR_WARNINGS])
{
    bool speed[2] = {false, false}; /* of the main rotor, of the tail rotor */
    bool blades[2] = {false, false};
    int n = 0;
    for (int i = 0; i < rotor->n_harmonics; i++) {
        const mt_harmonic *const h = &rotor->harmonics[i];
        speed[h->tail] = true;
        blades[h->tail] = blades[h->tail] || h->blade_count;
    }
    n = add_warning(out, n, speed[0], "rotor speed", &aircraft->main_rotor.speed);
    n = add_warning(out, n, blades[0], "number of blades", &aircraft->main_rotor.blades);
    if (aircraft->has_tail) {
        n = add_warning(out, n, speed[1], "tail rotor's speed", &aircraft->tail_rotor.speed);
        n = add_warning(out, n, blades[1], "tail rotor's number of blades",
                        &aircraft->tail_rotor.blades);
    }
    return n;
}

void mt_rotor_check_harmonics(const mt_rotor *rotor, const mt_aircraft *aircraft,
                              mt_diags *diags)
{
    const bool has_tail = aircraft == NULL ? rotor->has_tail : aircraft->has_tail;
    if (mt_rotor_too_many(diags, rotor->n_harmonics, rotor->addr, "harmonics")) {
        return;
    }
    for (int i = 0; i < rotor->n_harmonics; i++) {
        const mt_harmonic *const h = &rotor->harmonics[i];
        for (int k = 0; k < i; k++) {
            if (strcmp(rotor->harmonics[k].text, h->text) == 0) {
                mt_diag_error(diags, h->addr, "\"%s\" is given twice", h->text);
                break;
            }
        }
        if (h->tail && !has_tail) {
            mt_diag_error(diags, h->addr, "\"%s\" needs a tail rotor, and none is known",
                          h->text);
        } else if (h->blade_count && (h->tail ? rotor->tail_blades : rotor->blades) < 1) {
            mt_diag_error(diags, h->addr, "\"%s\" needs the number of blades", h->text);
        }
    }
}

const char *mt_rotor_warning_range(double lower, double upper, double least, const char *whose,
                                   mt_arena *mem)
{
    static const double MOST_SPEED = 2.0;
    static const double PERCENT = 100.0;
    if (lower >= least && upper <= MOST_SPEED) {
        return NULL;
    }
    if (upper > MOST_SPEED && upper >= PERCENT * MT_ROTOR_LEAST_SPEED) {
        return mt_arena_printf(
            mem,
            "speed_range [%g, %g] says %g to %g times the %s speed: it takes "
            "factors, and these look like per cent; [%g, %g] is meant?",
            lower, upper, lower, upper, whose, lower / PERCENT, upper / PERCENT);
    }
    return mt_arena_printf(
        mem, "speed_range [%g, %g] says %g to %g times the %s speed: is such a range meant?",
        lower, upper, lower, upper, whose);
}

void mt_rotor_check_range(const mt_rotor *rotor, mt_diags *diags)
{
    if (rotor->range_lower > rotor->range_upper) {
        mt_diag_error(diags, mt_diag_member(diags, rotor->addr, "speed_range"),
                      "the range of speeds (%g to %g) must be ascending", rotor->range_lower,
                      rotor->range_upper);
    }
}
