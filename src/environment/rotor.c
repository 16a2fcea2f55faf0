/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "environment/rotor.h"

#include <math.h>
#include <string.h>

#include "environment/machine.h"

enum { MOST_ORDERS = 1000 };

bool mt_harmonic_parse(const char *text, mt_harmonic *out)
{
    const char *s = text;
    mt_harmonic h = {.text = text, .addr = MT_NO_ADDR};
    *out = (mt_harmonic){.addr = MT_NO_ADDR};
    if (*s == '0') {
        return false;
    }
    for (; *s >= '0' && *s <= '9'; s++) {
        h.multiple = 10 * h.multiple + (*s - '0');
        if (h.multiple > MT_MAX_MULTIPLE) {
            return false;
        }
    }
    if (*s == 'n' || *s == 'N') {
        h.blade_count = true;
        s++;
    }
    if ((h.multiple == 0 && !h.blade_count) || (*s != 'P' && *s != 'T') || s[1] != '\0') {
        return false;
    }
    h.multiple = h.multiple == 0 ? 1 : h.multiple;
    h.tail = *s == 'T';
    *out = h;
    return true;
}

mt_rotor mt_rotor_default(mt_addr addr)
{
    return (mt_rotor){
        .speed_hz = nan(""),
        .tail_speed_hz = nan(""),
        .range_lower = 1.0,
        .range_upper = 1.0,
        .margin_percent = nan(""),
        .addr = addr,
    };
}

double mt_rotor_harmonic_hz(const mt_rotor *rotor, const mt_harmonic *harmonic)
{
    const double speed = harmonic->tail ? rotor->tail_speed_hz : rotor->speed_hz;
    const int blades = harmonic->tail ? rotor->tail_blades : rotor->blades;
    if (harmonic->blade_count && blades < 1) {
        return nan("");
    }
    return speed * (double)(harmonic->multiple * (harmonic->blade_count ? blades : 1));
}

/* Refuse a bare number: its rotor is not known. */
static void refuse_number(mt_reader *r, mt_addr at)
{
    const char *const main_rotor =
        mt_arena_printf(r->mem, "%.10gP", mt_json_number(r->doc, at));
    mt_harmonic is;
    if (main_rotor != NULL && mt_harmonic_parse(main_rotor, &is)) {
        mt_diag_structure(r->diags, at,
                          "must be a string, not a number: harmonics are written \"%s\" (main "
                          "rotor) or \"%.*sT\" (tail rotor)",
                          main_rotor, (int)strlen(main_rotor) - 1, main_rotor);
    } else {
        mt_diag_structure(r->diags, at, "must be a string, not a number");
    }
}

void mt_read_harmonics(mt_reader *r, mt_addr list, mt_rotor *rotor)
{
    mt_items items = mt_reader_some_items(r, list, "the list of harmonics");
    rotor->harmonics = mt_reader_room(r, &items, sizeof *rotor->harmonics);
    while (mt_items_next(&items)) {
        mt_harmonic *const h = &rotor->harmonics[rotor->n_harmonics];
        if (mt_json_type_of(r->doc, items.at) == MT_JSON_NUMBER) {
            refuse_number(r, items.at);
            continue;
        }
        const char *const text = mt_reader_text(r, items.at);
        if (text != NULL && mt_harmonic_parse(text, h)) {
            h->addr = items.at;
            rotor->n_harmonics++;
        } else if (text != NULL) {
            const size_t length = strlen(text);
            const bool tail = length > 0 && text[length - 1] == 't';
            const char *const meant = mt_read_multiple_meant(r, text, tail ? 'T' : 'P');
            mt_harmonic is;
            const bool good = meant != NULL && mt_harmonic_parse(meant, &is);
            mt_diag_structure(r->diags, items.at,
                              "\"%s\" is not a harmonic: a number from 1 to 999, n (the number "
                              "of blades) or both, then P (main rotor) or T (tail rotor)%s%s%s",
                              text, good ? "; did you mean \"" : "", good ? meant : "",
                              good ? "\"?" : "");
        }
    }
}

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

/* The warning of factors of the nominal speed; in mem. NULL: none. */
static const char *range_warning(double lower, double upper, double least, const char *whose,
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

void mt_read_warning_range(mt_reader *r, double lower, double upper, double least,
                           const char *whose, mt_addr addr)
{
    const char *const warning = lower > 0.0 && lower <= upper
                                    ? range_warning(lower, upper, least, whose, r->mem)
                                    : NULL;
    if (warning != NULL) {
        mt_reader_warning(r, addr, "speed_range", "%s", warning);
    }
}

void mt_rotor_check_range(const mt_rotor *rotor, mt_diags *diags)
{
    if (rotor->range_lower > rotor->range_upper) {
        mt_diag_error(diags, mt_diag_member(diags, rotor->addr, "speed_range"),
                      "the range of speeds (%g to %g) must be ascending", rotor->range_lower,
                      rotor->range_upper);
    }
}
