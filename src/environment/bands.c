/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "environment/bands.h"

#include <math.h>
#include <stdlib.h>

static const double PERCENT = 100.0;
/* A merged band lists so many names. */
enum { LISTED_MOST = 6 };

/* A band before it is merged with others: `what` happens at the rotor `of` (NULL: nobody's). */
typedef struct part {
    mt_band band;
    const char *what;
    const char *of;
    int order; /* as given: the last word when bands are sorted */
} part;

typedef struct parts {
    mt_arena *mem;
    int n;
    part *items;
} parts;

static void add_part(parts *p, double lower, double upper, double margin_percent,
                     const char *what, const char *of)
{
    part *const added = &p->items[p->n];
    if (!(lower <= upper)) {
        return; /* not known */
    }
    *added = (part){.what = what, .of = of, .order = p->n++};
    added->band.base_lower_hz = lower;
    added->band.base_upper_hz = upper;
    added->band.lower_hz = lower * (1.0 - margin_percent / PERCENT);
    added->band.upper_hz = upper * (1.0 + margin_percent / PERCENT);
}

static double first_given(double a, double b, double c)
{
    return a == a ? a : (b == b ? b : c);
}

static void add_rotor(parts *p, const mt_rotor *rotor, double margin_percent)
{
    const char *const of = rotor->name != NULL         ? rotor->name
                           : rotor->aircraft.s != NULL ? rotor->aircraft.s
                                                       : "rotor";
    for (int i = 0; i < rotor->n_harmonics; i++) {
        const double hz = mt_rotor_harmonic_hz(rotor, &rotor->harmonics[i]);
        add_part(p, hz * rotor->range_lower, hz * rotor->range_upper, margin_percent,
                 rotor->harmonics[i].text, of);
    }
}

double mt_bands_margin(const mt_bands_source *source, double own)
{
    return first_given(own, source->margin_percent, 0.0);
}

/* Each order over the range of speeds. */
static mt_status add_machine(parts *p, const mt_machine *machine, double margin_percent,
                             mt_err *err)
{
    const int n = mt_machine_line_count(machine);
    mt_order_line *const lines = mt_arena_alloc(p->mem, (size_t)n, sizeof *lines);
    MT_TRY(mt_arena_check(p->mem, err));
    MT_TRY(mt_machine_lines(machine, p->mem, lines, err));
    for (int i = 0; i < n; i++) {
        add_part(p, lines[i].order * mt_machine_speed_hz(machine, 0),
                 lines[i].order * mt_machine_speed_hz(machine, 1), margin_percent,
                 lines[i].what, lines[i].of);
    }
    return MT_OK;
}

static int by_frequency(const void *a, const void *b)
{
    const part *const x = a;
    const part *const y = b;
    if (x->band.lower_hz != y->band.lower_hz) {
        return x->band.lower_hz < y->band.lower_hz ? -1 : 1;
    }
    if (x->band.upper_hz != y->band.upper_hz) {
        return x->band.upper_hz < y->band.upper_hz ? -1 : 1;
    }
    return x->order - y->order;
}

/* A label "8P + 1T of UH-60 + 1P of Lynx": an owner is named after the last of its consecutive
 * harmonics. */
static const char *label_of(parts *p, int first, int last)
{
    const char *label = "";
    if (last - first >= LISTED_MOST) {
        /* "0.5E of engine to 1G of pinion (12 bands)" */
        const part *const a = &p->items[first];
        const part *const b = &p->items[last];
        const bool named = a->of != NULL && a->of != b->of;
        return mt_arena_printf(p->mem, "%s%s%s to %s%s%s (%d bands)", a->what,
                               named ? " of " : "", named ? a->of : "", b->what,
                               b->of != NULL ? " of " : "", b->of != NULL ? b->of : "",
                               last - first + 1);
    }
    for (int i = first; i <= last; i++) {
        const part *const a = &p->items[i];
        const bool named = a->of != NULL && (i == last || p->items[i + 1].of != a->of);
        label = mt_arena_printf(p->mem, "%s%s%s%s%s", label, i == first ? "" : " + ", a->what,
                                named ? " of " : "", named ? a->of : "");
    }
    return label;
}

/* One band from the parts first..last. */
static mt_band merge_parts(parts *p, int first, int last)
{
    mt_band band = p->items[first].band;
    for (int i = first + 1; i <= last; i++) {
        const mt_band *const next = &p->items[i].band;
        band.base_lower_hz = fmin(band.base_lower_hz, next->base_lower_hz);
        band.base_upper_hz = fmax(band.base_upper_hz, next->base_upper_hz);
        band.upper_hz = fmax(band.upper_hz, next->upper_hz);
    }
    band.label = label_of(p, first, last);
    return band;
}

/* Cut a band off at the limit. */
static void cut_off(mt_band *band, double up_to_hz)
{
    if (band->upper_hz > up_to_hz) {
        band->upper_hz = up_to_hz;
        band->base_upper_hz = fmin(band->base_upper_hz, up_to_hz);
        band->base_lower_hz = fmin(band->base_lower_hz, up_to_hz);
    }
}

static void note_merger(parts *p, const mt_band *band, mt_bands *out)
{
    const bool margin =
        band->lower_hz < band->base_lower_hz || band->upper_hz > band->base_upper_hz;
    const char *note =
        mt_arena_printf(p->mem, "%s overlap: merged into one band, %.6g to %.6g Hz",
                        band->label, band->base_lower_hz, band->base_upper_hz);
    if (margin) {
        note = mt_arena_printf(p->mem, "%s, with its margin %.6g to %.6g Hz", note,
                               band->lower_hz, band->upper_hz);
    }
    out->notes[out->n_notes++] = note;
}

static mt_status merge_all(parts *p, double up_to_hz, mt_bands *out, mt_err *err)
{
    *out = (mt_bands){0};
    out->items = mt_arena_alloc(p->mem, (size_t)p->n, sizeof *out->items);
    out->notes = mt_arena_alloc(p->mem, (size_t)p->n, sizeof *out->notes);
    MT_TRY(mt_arena_check(p->mem, err));
    qsort(p->items, (size_t)p->n, sizeof *p->items, by_frequency);
    /* what begins above the limit is not avoided, and no part of what it overlaps */
    while (p->n > 0 && p->items[p->n - 1].band.lower_hz >= up_to_hz) {
        p->n--;
    }
    for (int first = 0, last = 0; first < p->n; first = ++last) {
        double upper = p->items[first].band.upper_hz;
        while (last + 1 < p->n && p->items[last + 1].band.lower_hz <= upper) {
            upper = fmax(upper, p->items[++last].band.upper_hz);
        }
        mt_band band = merge_parts(p, first, last);
        cut_off(&band, up_to_hz);
        out->items[out->n++] = band;
        if (last > first) {
            note_merger(p, &band, out);
        }
    }
    return mt_arena_check(p->mem, err);
}

mt_status mt_bands_make(const mt_bands_source *source, double margin_percent, mt_arena *mem,
                        mt_bands *out, mt_err *err)
{
    size_t most = (size_t)source->n_intervals;
    for (int i = 0; i < source->n_rotors; i++) {
        most += (size_t)source->rotors[i].n_harmonics;
    }
    for (int i = 0; i < source->n_machines; i++) {
        most += (size_t)mt_machine_line_count(&source->machines[i]);
    }
    parts p = {.mem = mem, .items = mt_arena_alloc(mem, most, sizeof *p.items)};
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < source->n_intervals; i++) {
        const mt_band_hz *const band = &source->intervals[i];
        add_part(&p, band->lower_hz, band->upper_hz,
                 first_given(margin_percent, source->margin_percent, 0.0),
                 mt_arena_printf(mem, "%.6g to %.6g Hz", band->lower_hz, band->upper_hz), NULL);
    }
    for (int i = 0; i < source->n_rotors; i++) {
        const mt_rotor *const rotor = &source->rotors[i];
        add_rotor(
            &p, rotor,
            first_given(margin_percent, mt_bands_margin(source, rotor->margin_percent), 0.0));
    }
    for (int i = 0; i < source->n_machines; i++) {
        const mt_machine *const machine = &source->machines[i];
        MT_TRY(add_machine(
            &p, machine,
            first_given(margin_percent, mt_bands_margin(source, machine->margin_percent), 0.0),
            err));
    }
    return merge_all(&p, first_given(source->up_to_hz, HUGE_VAL, HUGE_VAL), out, err);
}

mt_status mt_bands_unite(int n, const mt_bands *const *lists, mt_arena *mem, mt_bands *out,
                         mt_err *err)
{
    size_t most = 0;
    for (int i = 0; i < n; i++) {
        most += (size_t)lists[i]->n;
    }
    parts p = {.mem = mem, .items = mt_arena_alloc(mem, most, sizeof *p.items)};
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < lists[i]->n; k++) {
            const mt_band *const band = &lists[i]->items[k];
            p.items[p.n] = (part){.band = *band, .what = band->label, .order = p.n};
            p.n++;
        }
    }
    return merge_all(&p, HUGE_VAL, out, err);
}

const char *mt_band_side_name(mt_band_side side)
{
    switch (side) {
    case MT_BELOW_BAND:
        return "below";
    case MT_INSIDE_BAND:
        return "inside";
    case MT_ABOVE_BAND:
        break;
    }
    return "above";
}

double mt_log_ratio(double a_hz, double b_hz)
{
    return b_hz <= 0.0 ? HUGE_VAL : log(a_hz / b_hz);
}

double mt_edge_clearance_percent(double edge_hz, bool below, double hz)
{
    const double ahead = below ? edge_hz - hz : hz - edge_hz;
    const double smaller = fmin(edge_hz, hz);
    return smaller > 0.0 ? PERCENT * ahead / smaller : ahead > 0.0 ? HUGE_VAL : -HUGE_VAL;
}

double mt_band_clearance_percent(const mt_band *band, double hz, mt_band_side *side)
{
    const double below = mt_edge_clearance_percent(band->base_lower_hz, true, hz);
    const double above = mt_edge_clearance_percent(band->base_upper_hz, false, hz);
    const bool is_below = hz < band->base_lower_hz;
    const bool is_above = hz > band->base_upper_hz;
    if (side != NULL) {
        *side = is_below ? MT_BELOW_BAND : (is_above ? MT_ABOVE_BAND : MT_INSIDE_BAND);
    }
    if (is_below || is_above) {
        return is_below ? below : above;
    }
    return fmax(below, above); /* inside: no edge at 0 Hz can be crossed */
}
