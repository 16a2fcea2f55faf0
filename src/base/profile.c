/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/profile.h"

#include <stddef.h>

static const double NANOSECONDS = 1e9;

void mt_profile_init(mt_profile *p, double (*clock_s)(void))
{
    p->clock_s = clock_s;
    for (int i = 0; i < MT_STAGES; i++) {
        atomic_init(&p->done[i], 0);
        atomic_init(&p->shared[i], 0);
        atomic_init(&p->skipped[i], 0);
        atomic_init(&p->nanoseconds[i], 0);
    }
}

void mt_profile_add(mt_profile *p, const mt_stage_counts *counts)
{
    for (int i = 0; i < MT_STAGES && p != NULL; i++) {
        (void)atomic_fetch_add(&p->done[i], counts->done[i]);
        (void)atomic_fetch_add(&p->shared[i], counts->shared[i]);
        (void)atomic_fetch_add(&p->skipped[i], counts->skipped[i]);
        (void)atomic_fetch_add(&p->nanoseconds[i],
                               (long long)(NANOSECONDS * counts->seconds[i]));
    }
}

double mt_profile_now(const mt_profile *p)
{
    return p == NULL ? 0.0 : p->clock_s();
}

#define STAGE_NAME(id, name, text) name,
#define STAGE_TEXT(id, name, text) text,

const char *mt_stage_name(mt_stage_id stage)
{
    static const char *const names[] = {MT_STAGE_LIST(STAGE_NAME)};
    return names[stage];
}

const char *mt_stage_text(mt_stage_id stage)
{
    static const char *const texts[] = {MT_STAGE_LIST(STAGE_TEXT)};
    return texts[stage];
}
