/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "expr/unit_words.h"

#include <string.h>

#include "base/base.h"
#include "base/format.h"

typedef struct unit_word {
    const char *word;
    const char *factor; /* "": 1 */
    const char *si;     /* NULL: the factor is a constant of the language */
} unit_word;

static const unit_word words[] = {{"deg", "deg", NULL},     {"degree", "deg", NULL},
                                  {"degrees", "deg", NULL}, {"rpm", "rpm", NULL},
                                  {"mm", "1e-3", "m"},      {"cm", "1e-2", "m"},
                                  {"um", "1e-6", "m"},      {"km", "1e3", "m"},
                                  {"in", "0.0254", "m"},    {"inch", "0.0254", "m"},
                                  {"ft", "0.3048", "m"},    {"m", "", "m"},
                                  {"g", "1e-3", "kg"},      {"kg", "", "kg"},
                                  {"t", "1e3", "kg"},       {"lb", "0.45359237", "kg"},
                                  {"N", "", "N"},           {"kN", "1e3", "N"},
                                  {"Nm", "", "N m"},        {"Nmm", "1e-3", "N m"},
                                  {"Pa", "", "Pa"},         {"MPa", "1e6", "Pa"},
                                  {"GPa", "1e9", "Pa"},     {"Hz", "", "Hz"},
                                  {"kHz", "1e3", "Hz"},     {"rad", "", "rad"},
                                  {"mrad", "1e-3", "rad"},  {"s", "", "s"},
                                  {"ms", "1e-3", "s"}};

bool mt_unit_meant(const char *number, size_t n_number, const char *word, size_t n_word,
                   char *out, size_t size)
{
    for (int i = 0; i < MT_COUNT(words); i++) {
        const unit_word *const w = &words[i];
        if (strlen(w->word) == n_word && memcmp(w->word, word, n_word) == 0) {
            (void)mt_snprintf(out, size, "\"%.*s%s%s\"%s%s%s", (int)n_number, number,
                              w->factor[0] == '\0' ? "" : "*", w->factor,
                              w->si == NULL ? "" : " (numbers are in SI units, here ",
                              w->si == NULL ? "" : w->si, w->si == NULL ? "" : ")");
            return true;
        }
    }
    return false;
}
