/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sentences about bands: the kind of the design, modes on edges and inside, and the least of
 * the other clearances. */
#include "describe/describe_reasons_priv.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/number.h"

/* A clearance that equals its margin within this, in percent of the edge, is active: ten times
 * the tolerance that a goal has by default. */
static const double ACTIVE_PERCENT = 1e-3;

static const mt_result_mode_placement *gap_of(const mt_recommendation *rec,
                                              const mt_result_clearance *c)
{
    for (int i = 0; i < rec->n_placements; i++) {
        if (strcmp(rec->placements[i].configuration, c->configuration) == 0 &&
            strcmp(rec->placements[i].band, c->band) == 0) {
            return &rec->placements[i];
        }
    }
    return NULL;
}

/* "15.5 to 18.9 Hz (4P of UH-60)"; the numbers alone where they are the band's label. */
static const char *band_text(mt_sentences *s, const mt_result_clearance *c)
{
    const mt_result_mode_placement *const g = gap_of(s->rec, c);
    if (g == NULL) {
        return c->band;
    }
    const char *const numbers =
        mt_arena_printf(&s->result->mem, "%.6g to %.6g Hz", g->lower_hz, g->upper_hz);
    return numbers == NULL || strcmp(numbers, c->band) == 0
               ? c->band
               : mt_arena_printf(&s->result->mem, "%s (%s)", numbers, c->band);
}

/* "no mode lies below ", "2 modes lie below "; behind others without a verb. */
static const char *count_text(mt_arena *mem, int modes, bool first)
{
    if (modes == 0) {
        return first ? "no mode lies below " : ", no mode lies below ";
    }
    const char *const before = first ? "" : ", ";
    if (modes == 1) {
        return mt_arena_printf(mem, "%s1 mode%s below ", before, first ? " lies" : "");
    }
    return mt_arena_printf(mem, "%s%d modes%s below ", before, modes, first ? " lie" : "");
}

/* "In installed, no mode lies below 1P and 4P, 1 mode below 8P." Bands with one number of modes
 * stand together. */
static void write_kind(mt_sentences *s, int first, int n)
{
    const mt_result_mode_placement *const g = &s->rec->placements[first];
    mt_arena *const mem = &s->result->mem;
    const char *text = "";
    int same = 1;
    for (int i = 0; i < n; i += same) {
        same = 1;
        while (i + same < n && g[i + same].modes_below == g[i].modes_below) {
            same++;
        }
        text = mt_arena_printf(mem, "%s%s", text, count_text(mem, g[i].modes_below, i == 0));
        for (int k = 0; k < same; k++) {
            text = mt_add_listed_sentences(s, text, g[i + k].band, same - 1 - k);
        }
    }
    mt_add_sentence(s, "In %s, %s.", g->configuration, text);
}

static void write_kinds(mt_sentences *s)
{
    for (int first = 0, n = 0; first < s->rec->n_placements; first += n) {
        const char *const configuration = s->rec->placements[first].configuration;
        n = 1;
        while (first + n < s->rec->n_placements &&
               strcmp(s->rec->placements[first + n].configuration, configuration) == 0) {
            n++;
        }
        write_kind(s, first, n);
    }
}

static void write_active(mt_sentences *s, const mt_result_clearance *c)
{
    const char *const edge = strcmp(c->side, "above") == 0 ? "upper" : "lower";
    if (c->margin_percent > 0.0) {
        mt_add_sentence(
            s, "%s mode %d (%.6g Hz) keeps just the margin asked for, %.3g %% %s band %s.",
            c->configuration, c->mode, c->hz, c->margin_percent, c->side, band_text(s, c));
    } else {
        mt_add_sentence(s, "%s mode %d stands on the %s edge (%.6g Hz) of band %s.",
                        c->configuration, c->mode, edge, c->hz, band_text(s, c));
    }
}

static void write_short(mt_sentences *s, const mt_result_clearance *c)
{
    if (c->percent < 0.0) {
        mt_add_sentence(
            s, "%s mode %d (%.6g Hz) lies inside band %s, %.3g %% from its nearest edge.",
            c->configuration, c->mode, c->hz, band_text(s, c), -c->percent);
    } else {
        mt_add_sentence(s,
                        "%s mode %d (%.6g Hz) keeps only %.3g %% %s band %s, of %.3g %% asked.",
                        c->configuration, c->mode, c->hz, c->percent, c->side, band_text(s, c),
                        c->margin_percent);
    }
}

/* Write each active or missed clearance, and the least of the others, the first of equal
 * ones. */
static void write_clearances(mt_sentences *s)
{
    const mt_result_clearance *least = NULL;
    for (int i = 0; i < s->rec->n_clearances; i++) {
        const mt_result_clearance *const c = &s->rec->clearances[i];
        if (!MT_HAS(c->percent)) {
            continue; /* at 0 Hz, infinitely far from every band */
        }
        if (fabs(c->percent - c->margin_percent) <= ACTIVE_PERCENT) {
            write_active(s, c);
        } else if (c->percent < c->margin_percent) {
            write_short(s, c);
        } else if (least == NULL || mt_exceeds(least->percent, c->percent)) {
            least = c;
        }
    }
    if (least != NULL) {
        const bool others = s->rec->n_clearances > 1;
        mt_add_sentence(s, "%s mode %d (%.6g Hz) keeps %.3g %% %s band %s%s.",
                        least->configuration, least->mode, least->hz, least->percent,
                        least->side, band_text(s, least),
                        others ? "; nothing else comes nearer" : "");
    }
}

void mt_add_bands_sentences(mt_sentences *s)
{
    mt_sentence_of(s, "hold", NULL);
    write_kinds(s);
    write_clearances(s);
    for (int i = 0; i < s->rec->n_motions; i++) {
        mt_add_sentence(s, "Over the motion: %s.", s->rec->motions[i].text);
    }
}
