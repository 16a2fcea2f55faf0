/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Damping: what takes energy out is not negative, and what a slip of units makes is doubted. */
#include "model/lint_priv.h"

#include <string.h>

/* Whose damping it is: NULL the model's, else the configuration that gives it. */
static const mt_configuration *owner_of(const mt_lint *j)
{
    int c = j->configuration;
    while (c != MT_ABSENT && j->model->configurations[c].damping.inherited) {
        c = j->model->configurations[c].like;
    }
    return c == MT_ABSENT ? NULL : &j->model->configurations[c];
}

/* A member of the damping, or an entry of it (a mode's name, an index). */
typedef struct place {
    const char *member;
    const char *entry; /* NULL: none */
} place;

/* The entry as a JSON pointer has it. NULL where memory is out. */
static const char *escaped(mt_arena *mem, const char *entry)
{
    char *const text = mt_arena_alloc(mem, (2 * strlen(entry)) + 1, 1);
    size_t n = 0;
    for (const char *c = entry; text != NULL && *c != '\0'; c++) {
        if (*c == '~' || *c == '/') {
            const char digit = *c == '~' ? '0' : '1';
            text[n++] = '~';
            text[n++] = digit;
        } else {
            text[n++] = *c;
        }
    }
    return text;
}

static void report_damping(mt_lint *j, mt_num num, const place *at, mt_warning_level level,
                           const char *why)
{
    mt_arena *const mem = j->out->mem;
    const mt_configuration *const owner = owner_of(j);
    const char *const slash = at->entry == NULL ? "" : "/";
    const char *const shown = at->entry == NULL ? "" : at->entry;
    mt_warning *const warning = mt_warning_add(
        j->out, level, level == MT_LEVEL_FAULT ? "value" : "damping",
        "damping%s%s%s: %s%s%s (%g) %s", owner == NULL ? "" : " of configuration \"",
        owner == NULL ? "" : owner->name.s, owner == NULL ? "" : "\"", at->member, slash, shown,
        j->value[num], why);
    const char *const entry = at->entry == NULL ? "" : escaped(mem, at->entry);
    if (entry == NULL) {
        return;
    }
    const char *const pointer =
        owner == NULL ? mt_arena_printf(mem, "/damping/%s%s%s", at->member, slash, entry)
                      : mt_arena_printf(mem, "/configurations/%s/damping/%s%s%s", owner->name.s,
                                        at->member, slash, entry);
    (void)mt_lint_addr(j, warning, j->model->nums[num].addr, pointer);
}

static void coefficient(mt_lint *j, mt_num num, const place *at)
{
    if (num == MT_ABSENT) {
        return;
    }
    const mt_possible *const p = &mt_possible_of[j->model->nums[num].possible];
    const double v = j->value[num];
    const char *const doubted = mt_possible_doubted(p, v);
    if (!mt_possible_is(p, v)) {
        report_damping(j, num, at, MT_LEVEL_FAULT, p->impossible);
    } else if (doubted != NULL) {
        report_damping(j, num, at, MT_LEVEL_WARNING,
                       mt_arena_printf(j->out->mem, "is %s", doubted));
    }
}

static void ratio(mt_lint *j, mt_num num, const char *member, const char *entry)
{
    const place at = {member, entry};
    coefficient(j, num, &at);
}

void mt_lint_damping(mt_lint *j)
{
    const mt_damping *const d = &j->model->configurations[j->configuration].damping;
    if (!d->given) {
        return;
    }
    ratio(j, d->ratio, "ratio", NULL);
    for (int i = 0; i < d->n_ratios; i++) {
        ratio(j, d->ratios[i], "ratios", mt_arena_printf(j->out->mem, "%d", i));
    }
    for (int i = 0; i < d->n_named; i++) {
        ratio(j, d->named[i].ratio, "modes", d->named[i].mode_name.s);
    }
    coefficient(j, d->mass, &(const place){"mass_per_s", NULL});
    coefficient(j, d->stiffness, &(const place){"stiffness_s", NULL});
}
