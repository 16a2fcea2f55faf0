/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "environment/read_harmonics.h"

#include <string.h>

#include "environment/rotor.h"

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

void mt_read_warning_range(mt_reader *r, double lower, double upper, double least,
                           const char *whose, mt_addr addr)
{
    const char *const warning = lower > 0.0 && lower <= upper
                                    ? mt_rotor_warning_range(lower, upper, least, whose, r->mem)
                                    : NULL;
    if (warning != NULL) {
        mt_reader_warning(r, addr, "speed_range", "%s", warning);
    }
}
