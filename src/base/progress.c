/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/progress.h"

#include <math.h>

static const double MILLION = 1e6;
/* A better design that improves the best one by a smaller share changes only its last digits,
 * which later starts still do. */
static const double LAST_DIGITS = 1e-6;

mt_status mt_progress_init(mt_progress *p, mt_err *err)
{
    const mt_progress_mark never = {nan(""), 0};
    *p = (mt_progress){.best_f = HUGE_VAL};
    p->now.first = never;
    p->now.best_at = never;
    p->now.proof = never;
    atomic_init(&p->done, 0);
    atomic_init(&p->evaluations, 0);
    atomic_init(&p->solutions, 0);
    atomic_init(&p->boxes, 0);
    atomic_init(&p->ppm, -1);
    atomic_init(&p->designs, false);
    return pthread_mutex_init(&p->lock, NULL) == 0
               ? MT_OK
               : mt_fail(err, MT_E_SYSTEM, "a lock cannot be made");
}

void mt_progress_free(mt_progress *p)
{
    (void)pthread_mutex_destroy(&p->lock);
}

/* Begin a phase or step with nothing done. */
static void start(mt_progress *p, const char *unit, long total)
{
    p->now.step++;
    p->now.unit = unit;
    p->now.total = total;
    p->now.ended = false;
    atomic_store(&p->done, 0);
    atomic_store(&p->ppm, -1);
}

void mt_progress_phase(mt_progress *p, const char *name, bool designs)
{
    if (p == NULL) {
        return;
    }
    (void)pthread_mutex_lock(&p->lock);
    if (!p->open) {
        p->now.phase = name;
        atomic_store(&p->designs, designs);
        start(p, NULL, 0);
    }
    (void)pthread_mutex_unlock(&p->lock);
}

bool mt_progress_begin(mt_progress *p, const char *unit, long total)
{
    if (p == NULL) {
        return false;
    }
    (void)pthread_mutex_lock(&p->lock);
    const bool outermost = !p->open;
    if (outermost) {
        p->open = true;
        start(p, unit, total);
    }
    (void)pthread_mutex_unlock(&p->lock);
    return outermost;
}

void mt_progress_done(mt_progress *p, bool outermost)
{
    if (p != NULL && outermost) {
        (void)atomic_fetch_add(&p->done, 1);
    }
}

void mt_progress_share(mt_progress *p, bool outermost, double share)
{
    if (p == NULL || !outermost) {
        return;
    }
    const int now = (int)(MILLION * fmin(fmax(share, 0.0), 1.0));
    int had = atomic_load(&p->ppm);
    while (had < now && !atomic_compare_exchange_weak(&p->ppm, &had, now)) {
    }
}

void mt_progress_end(mt_progress *p, bool outermost)
{
    if (p != NULL && outermost) {
        (void)pthread_mutex_lock(&p->lock);
        p->open = false;
        p->now.ended = true;
        (void)pthread_mutex_unlock(&p->lock);
    }
}

void mt_progress_evaluated(mt_progress *p)
{
    if (p != NULL) {
        (void)atomic_fetch_add_explicit(&p->evaluations, 1, memory_order_relaxed);
    }
}

void mt_progress_solved(mt_progress *p, long n)
{
    if (p != NULL) {
        (void)atomic_fetch_add_explicit(&p->solutions, n, memory_order_relaxed);
    }
}

void mt_progress_boxed(mt_progress *p)
{
    if (p != NULL) {
        (void)atomic_fetch_add_explicit(&p->boxes, 1, memory_order_relaxed);
    }
}

bool mt_progress_seeks(mt_progress *p)
{
    return p != NULL && atomic_load_explicit(&p->designs, memory_order_relaxed);
}

static mt_progress_mark mark_of_now(const mt_progress *p)
{
    return (mt_progress_mark){p->clock == NULL ? nan("") : p->clock(),
                              atomic_load_explicit(&p->evaluations, memory_order_relaxed)};
}

void mt_progress_found(mt_progress *p, const char *what, double f, double value)
{
    if (p == NULL) {
        return;
    }
    (void)pthread_mutex_lock(&p->lock);
    if (f < p->best_f) {
        const bool first = p->now.what == NULL;
        p->best_f = f;
        p->now.what = what;
        p->now.best = value;
        if (first || fabs(value - p->marked) > LAST_DIGITS * fabs(value)) {
            p->marked = value;
            p->now.best_at = mark_of_now(p);
        }
        p->now.first = first ? p->now.best_at : p->now.first;
    }
    (void)pthread_mutex_unlock(&p->lock);
}

void mt_progress_proved(mt_progress *p)
{
    if (p != NULL) {
        (void)pthread_mutex_lock(&p->lock);
        p->now.proof = mark_of_now(p);
        (void)pthread_mutex_unlock(&p->lock);
    }
}

void mt_progress_impossible(mt_progress *p)
{
    if (p != NULL) {
        (void)pthread_mutex_lock(&p->lock);
        p->now.impossible = true;
        (void)pthread_mutex_unlock(&p->lock);
    }
}

/* 1 where the step has ended; else never 1 before it has. */
static double share_of(const mt_progress_view *v, int ppm)
{
    if (v->ended) {
        return 1.0;
    }
    if (v->total > 0) {
        return v->done < v->total ? (double)v->done / (double)v->total : 1.0;
    }
    return ppm >= 0 ? (double)ppm / MILLION : nan("");
}

mt_progress_view mt_progress_read(mt_progress *p)
{
    (void)pthread_mutex_lock(&p->lock);
    mt_progress_view v = p->now;
    v.done = atomic_load(&p->done);
    v.share = share_of(&v, atomic_load(&p->ppm));
    (void)pthread_mutex_unlock(&p->lock);
    v.evaluations = atomic_load(&p->evaluations);
    v.solutions = atomic_load(&p->solutions);
    v.boxes = atomic_load(&p->boxes);
    return v;
}
