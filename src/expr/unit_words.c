/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "expr/unit_words.h"

#include <string.h>

#include "base/base.h"
#include "base/format.h"
#include "expr/units.h"

/* Units that no constant of the language is (expr/units.h has those). */
typedef struct unit_word {
    const char *word;
    const char *factor; /* "": 1 */
    const char *si;
} unit_word;

static const unit_word words[] = {{"um", "1e-6", "m"},
                                  {"km", "1e3", "m"},
                                  {"m", "", "m"},
                                  {"g", "1e-3", "kg"},
                                  {"kg", "", "kg"},
                                  {"t", "1e3", "kg"},
                                  {"lb", "0.45359237", "kg"},
                                  {"N", "", "N"},
                                  {"kN", "1e3", "N"},
                                  {"Nm", "", "N m"},
                                  {"Nmm", "1e-3", "N m"},
                                  {"Pa", "", "Pa"},
                                  {"MPa", "1e6", "Pa"},
                                  {"GPa", "1e9", "Pa"},
                                  {"Hz", "", "Hz"},
                                  {"kHz", "1e3", "Hz"},
                                  {"rad", "", "rad"},
                                  {"mrad", "1e-3", "rad"},
                                  {"s", "", "s"},
                                  {"ms", "1e-3", "s"}};

/* Other words for the constants. */
static const char *const other_words[][2] = {
    {"degree", "deg"}, {"degrees", "deg"},   {"\xC2\xB0", "deg"},
    {"in", "inch"},    {"inches", "inch"},   {"feet", "ft"},
    {"foot", "ft"},    {"millimetre", "mm"}, {"RPM", "rpm"}};

static bool is_unit_word(const char *word, size_t n_word, const char *s)
{
    return strlen(s) == n_word && memcmp(s, word, n_word) == 0;
}

/* The constant with this name or synonym; NULL: none. */
static const char *constant_of(const char *word, size_t n_word)
{
    int n = 0;
    const mt_unit *const units = mt_units(&n);
    for (int i = 0; i < n; i++) {
        if (units[i].constant != NULL && is_unit_word(word, n_word, units[i].constant)) {
            return units[i].constant;
        }
    }
    for (int i = 0; i < MT_COUNT(other_words); i++) {
        if (is_unit_word(word, n_word, other_words[i][0])) {
            return other_words[i][1];
        }
    }
    return NULL;
}

bool mt_unit_meant(const char *number, size_t n_number, const char *word, size_t n_word,
                   char *out, size_t size)
{
    const char *const constant = constant_of(word, n_word);
    if (constant != NULL) {
        (void)mt_snprintf(out, size, "\"%.*s*%s\"", (int)n_number, number, constant);
        return true;
    }
    if (is_unit_word(word, n_word, "%") || is_unit_word(word, n_word, "percent")) {
        (void)mt_snprintf(out, size, "\"%.*s/100\"", (int)n_number, number);
        return true;
    }
    for (int i = 0; i < MT_COUNT(words); i++) {
        const unit_word *const w = &words[i];
        if (is_unit_word(word, n_word, w->word)) {
            (void)mt_snprintf(out, size, "\"%.*s%s%s\" (expressions are in SI units, here %s)",
                              (int)n_number, number, w->factor[0] == '\0' ? "" : "*", w->factor,
                              w->si);
            return true;
        }
    }
    return false;
}
