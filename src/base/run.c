/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a long computation shares with its caller. */
#include "base/run.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

/* Requests to stop. */

void mt_interrupt_init(mt_interrupt *i, int (*request)(void *context), void *context,
                       mt_interrupt *whole)
{
    i->request = request;
    i->cause = NULL;
    i->context = context;
    i->whole = whole;
    i->phase = 0;
    i->makes_ready = false;
    atomic_init(&i->needed, false);
    atomic_init(&i->level, MT_STOP_REQUEST_NONE);
    atomic_init(&i->cut, 0U);
}

void mt_interrupt_enter(mt_interrupt *i, int phase, bool makes_ready)
{
    i->phase = phase;
    i->makes_ready = makes_ready;
}

/* The strongest request so far, asked again until it cannot become stronger. Parts have no
 * request of their own: that of the outermost computation applies. */
static int request_of(mt_interrupt *i)
{
    while (i->whole != NULL) {
        i = i->whole;
    }
    int had = atomic_load(&i->level);
    if (i->request != NULL && had < MT_STOP_REQUEST_END) {
        const int now = i->request(i->context);
        while (had < now && !atomic_compare_exchange_weak(&i->level, &had, now)) {
        }
    }
    return atomic_load(&i->level);
}

bool mt_interrupted(mt_interrupt *i)
{
    if (i == NULL ||
        request_of(i) < (i->makes_ready ? MT_STOP_REQUEST_END : MT_STOP_REQUEST_FINISH) ||
        (atomic_load(&i->needed) && mt_interrupt_reason(i) == MT_STOP_REASON_TIME_LIMIT)) {
        return false;
    }
    mt_interrupt_cut(i, i->phase);
    return true;
}

mt_status mt_interrupt_check(mt_interrupt *i, mt_err *err)
{
    return mt_interrupted(i) ? mt_fail(err, MT_E_INTERRUPTED, "interrupted") : MT_OK;
}

void mt_interrupt_cut(mt_interrupt *i, int phase)
{
    (void)atomic_fetch_or(&i->cut, 1U << (unsigned)phase);
    if (i->whole != NULL) {
        mt_interrupt_cut(i->whole, i->whole->phase);
    }
}

bool mt_interrupt_is_cut(const mt_interrupt *i, int phase)
{
    return (atomic_load(&i->cut) & (1U << (unsigned)phase)) != 0U;
}

int mt_interrupt_reason(const mt_interrupt *i)
{
    while (i != NULL && i->whole != NULL) {
        i = i->whole;
    }
    return i != NULL && i->cause != NULL ? i->cause(i->context) : MT_STOP_REASON_INTERRUPT;
}

bool mt_interrupt_any(const mt_interrupt *i)
{
    return atomic_load(&i->cut) != 0U;
}

/* Progress. */

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

/* Stages of evaluations. */

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

/* Counts of the work done. */

void mt_work_counters_init(mt_work_counters *s)
{
    s->phase = 0;
    for (int i = 0; i < MT_INTERRUPT_PHASES; i++) {
        for (int k = 0; k < MT_WORK_KINDS; k++) {
            atomic_init(&s->count[i][k], 0);
        }
    }
}

void mt_work_counters_copy(const mt_work_counters *from, mt_work_counters *to)
{
    to->phase = from->phase;
    for (int i = 0; i < MT_INTERRUPT_PHASES; i++) {
        for (int k = 0; k < MT_WORK_KINDS; k++) {
            atomic_init(&to->count[i][k], mt_work_counters_in(from, i, (mt_work_kind)k));
        }
    }
}

void mt_work_counters_note(mt_work_counters *s, mt_work_kind kind, long n)
{
    if (s != NULL) {
        (void)atomic_fetch_add_explicit(&s->count[s->phase][kind], n, memory_order_relaxed);
    }
}

long mt_work_counters_in(const mt_work_counters *s, int phase, mt_work_kind kind)
{
    return atomic_load_explicit(&s->count[phase][kind], memory_order_relaxed);
}

long mt_work_counters_of(const mt_work_counters *s, mt_work_kind kind)
{
    long sum = 0;
    for (int i = 0; i < MT_INTERRUPT_PHASES; i++) {
        sum += mt_work_counters_in(s, i, kind);
    }
    return sum;
}

/* A thread in the background. */

enum { STACK = 1 << 20 };

static void *run_ticker(void *argument)
{
    const mt_ticker *const t = argument;
    while (t->turn(t->context)) {
    }
    return NULL;
}

bool mt_ticker_start(mt_ticker *t, bool (*turn)(void *context), void *context)
{
    pthread_attr_t how;
    *t = (mt_ticker){.turn = turn, .context = context};
    if (pthread_attr_init(&how) != 0) {
        return false;
    }
    (void)pthread_attr_setstacksize(&how, STACK);
    const bool made = pthread_create(&t->thread, &how, run_ticker, t) == 0;
    (void)pthread_attr_destroy(&how);
    return made;
}

void mt_ticker_join(mt_ticker *t)
{
    (void)pthread_join(t->thread, NULL);
}

/* The run without any of them. */

const mt_run mt_run_none = {.interrupt = NULL};
