/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bands from lists and rotors: harmonics, edges, mergers, limits, clearances. */
#include <math.h>

#include "environment/bands.h"
#include "mt_refusals.h"

/* edges are products of three or four numbers */
static const double TOL = 1e-14;

static void bands__harmonics_are_read_as_written(mt_test *t)
{
    static const struct {
        const char *text;
        int multiple; /* 0: no harmonic */
        bool blade_count;
        bool tail;
    } rows[] = {
        {"1P", 1, false, false},     {"12P", 12, false, false},
        {"999P", 999, false, false}, {"nP", 1, true, false},
        {"NP", 1, true, false},      {"2nP", 2, true, false},
        {"2NP", 2, true, false},     {"1T", 1, false, true},
        {"nT", 1, true, true},       {"3nT", 3, true, true},
        {"", 0, false, false},       {"P", 0, false, false},
        {"1", 0, false, false},      {"n", 0, false, false},
        {"0P", 0, false, false},     {"04P", 0, false, false},
        {"0nP", 0, false, false},    {"1p", 0, false, false},
        {"1PP", 0, false, false},    {"nnP", 0, false, false},
        {"n2P", 0, false, false},    {"1000P", 0, false, false},
        {"-1P", 0, false, false},    {" 1P", 0, false, false},
        {"1.5P", 0, false, false},   {"99999999999999999999P", 0, false, false},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_harmonic h;
        mt_test_row(t, "\"%s\"", rows[i].text);
        const bool ok = rows[i].multiple > 0;
        CHECK(t, mt_harmonic_parse(rows[i].text, &h) == ok);
        CHECK_INT(t, h.multiple, rows[i].multiple);
        CHECK(t, h.blade_count == rows[i].blade_count);
        CHECK(t, h.tail == rows[i].tail);
        CHECK_STR(t, h.text, ok ? rows[i].text : NULL);
    }
}

enum { MOST_HARMONICS = 8 };

typedef struct sample {
    mt_arena mem;
    mt_harmonic harmonics[2][MOST_HARMONICS];
    mt_rotor rotors[2];
    mt_band_hz intervals[4];
    mt_bands_source source;
    mt_bands bands;
} sample;

static bool begin(mt_test *t, sample *s)
{
    *s = (sample){.source = {.margin_percent = nan(""), .up_to_hz = nan("")}};
    s->source.rotors = s->rotors;
    s->source.intervals = s->intervals;
    return CHECK_INT(t, mt_arena_init(&s->mem, 0, NULL), MT_OK);
}

/* A rotor of 258 rpm with four blades, its tail rotor of 1190 rpm with four. */
static mt_rotor *add_rotor(sample *s, const char *name, int n, const char *const *harmonics)
{
    const int which = s->source.n_rotors++;
    mt_rotor *const rotor = &s->rotors[which];
    *rotor = mt_rotor_default(MT_NO_ADDR);
    rotor->name = name;
    rotor->speed_hz = 258.0 / 60.0;
    rotor->blades = 4;
    rotor->tail_speed_hz = 1190.0 / 60.0;
    rotor->tail_blades = 4;
    rotor->harmonics = s->harmonics[which];
    for (int i = 0; i < n; i++) {
        (void)mt_harmonic_parse(harmonics[i], &rotor->harmonics[rotor->n_harmonics++]);
    }
    return rotor;
}

static void make(mt_test *t, sample *s, double margin)
{
    CHECK_INT(t, mt_bands_make(&s->source, margin, &s->mem, &s->bands, NULL), MT_OK);
}

static void check_band(mt_test *t, const mt_band *band, const double edges[4],
                       const char *label)
{
    CHECK_NEAR(t, band->lower_hz, edges[0], TOL);
    CHECK_NEAR(t, band->base_lower_hz, edges[1], TOL);
    CHECK_NEAR(t, band->base_upper_hz, edges[2], TOL);
    CHECK_NEAR(t, band->upper_hz, edges[3], TOL);
    CHECK_STR(t, band->label, label);
}

static void bands__of_a_rotor_have_range_and_margin(mt_test *t)
{
    static const char *const harmonics[] = {"nP", "1P"};
    sample s;
    if (!begin(t, &s)) {
        return;
    }
    mt_rotor *const rotor = add_rotor(&s, "UH-60", MT_COUNT(harmonics), harmonics);
    rotor->range_lower = 0.95;
    rotor->range_upper = 1.05;
    rotor->margin_percent = 10.0;
    make(t, &s, nan(""));
    if (CHECK_INT(t, s.bands.n, 2)) { /* 4.3 and 17.2 Hz, ascending */
        check_band(t, &s.bands.items[0], (const double[]){3.6765, 4.085, 4.515, 4.9665},
                   "1P of UH-60");
        check_band(t, &s.bands.items[1], (const double[]){14.706, 16.34, 18.06, 19.866},
                   "nP of UH-60");
    }
    CHECK_INT(t, s.bands.n_notes, 0);
    mt_arena_free(&s.mem);
}

static void bands__that_overlap_are_merged_and_said_so(mt_test *t)
{
    static const char *const harmonics[] = {"1T", "8P", "9P", "1P"};
    sample s;
    if (!begin(t, &s)) {
        return;
    }
    mt_rotor *const rotor = add_rotor(&s, "UH-60", MT_COUNT(harmonics), harmonics);
    rotor->range_lower = 0.98;
    rotor->range_upper = 1.02;
    s.source.margin_percent = 5.0; /* the rotor gives none of its own */
    /* 1P 4.3, 1T 19.83; 8P 34.4 and 9P 38.7 meet: 34.4 * 1.02 * 1.05 = 36.84, 38.7 * 0.98 *
     * 0.95 = 36.03 */
    make(t, &s, nan(""));
    if (CHECK_INT(t, s.bands.n, 3)) {
        check_band(
            t, &s.bands.items[2],
            (const double[]){34.4 * 0.98 * 0.95, 34.4 * 0.98, 38.7 * 1.02, 38.7 * 1.02 * 1.05},
            "8P + 9P of UH-60");
    }
    if (CHECK_INT(t, s.bands.n_notes, 1)) {
        CHECK_STR(
            t, s.bands.notes[0],
            "8P + 9P of UH-60 overlap: merged into one band, 33.712 to 39.474 Hz, with its "
            "margin 32.0264 to 41.4477 Hz");
    }
    mt_arena_free(&s.mem);
}

static void bands__of_several_rotors_and_lists_keep_their_names(mt_test *t)
{
    static const char *const first[] = {"4P", "5P"};
    static const char *const second[] = {"4P"};
    sample s;
    if (!begin(t, &s)) {
        return;
    }
    add_rotor(&s, "one", MT_COUNT(first), first)->margin_percent = 12.0;
    mt_rotor *const other = add_rotor(&s, "two", MT_COUNT(second), second);
    other->speed_hz = 4.5;
    other->margin_percent = 1.0;
    s.intervals[0] = (mt_band_hz){60.0, 70.0, MT_NO_ADDR};
    s.intervals[1] = (mt_band_hz){70.0, 80.0, MT_NO_ADDR}; /* touches */
    s.source.n_intervals = 2;
    make(t, &s, nan(""));
    if (CHECK_INT(t, s.bands.n, 2)) {
        CHECK_STR(t, s.bands.items[0].label, "4P of one + 4P of two + 5P of one");
        check_band(t, &s.bands.items[1], (const double[]){60.0, 60.0, 80.0, 80.0},
                   "60 to 70 Hz + 70 to 80 Hz");
    }
    CHECK_INT(t, s.bands.n_notes, 2);
    mt_arena_free(&s.mem);
}

static void bands__are_cut_off_at_the_limit(mt_test *t)
{
    sample s;
    if (!begin(t, &s)) {
        return;
    }
    s.intervals[0] = (mt_band_hz){10.0, 20.0, MT_NO_ADDR};
    s.intervals[1] = (mt_band_hz){90.0, 110.0, MT_NO_ADDR};
    s.intervals[2] = (mt_band_hz){200.0, 210.0, MT_NO_ADDR};
    s.source.n_intervals = 3;
    s.source.margin_percent = 10.0;
    static const struct {
        const char *name;
        double up_to;
        int n;
        double edges[4];
    } rows[] = {
        {"above all", 1000.0, 3, {180.0, 200.0, 210.0, 231.0}},
        {"inside a margin", 190.0, 3, {180.0, 190.0, 190.0, 190.0}},
        {"inside a base", 100.0, 2, {81.0, 90.0, 100.0, 100.0}},
        {"on a low edge", 81.0, 1, {9.0, 10.0, 20.0, 22.0}},
        {"below all", 9.0, 0, {0.0, 0.0, 0.0, 0.0}},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s", rows[i].name);
        s.source.up_to_hz = rows[i].up_to;
        make(t, &s, nan(""));
        if (CHECK_INT(t, s.bands.n, rows[i].n) && s.bands.n > 0) {
            const mt_band *const last = &s.bands.items[s.bands.n - 1];
            check_band(t, last, rows[i].edges, last->label);
        }
    }
    mt_arena_free(&s.mem);
}

/* A band that begins above the limit is not avoided: one that it overlaps above is itself. */
static void bands__above_the_limit_change_none_below(mt_test *t)
{
    sample s;
    if (!begin(t, &s)) {
        return;
    }
    s.intervals[0] = (mt_band_hz){118.0, 130.0, MT_NO_ADDR};
    s.intervals[1] = (mt_band_hz){95.0, 100.0, MT_NO_ADDR};
    s.source.n_intervals = 2;
    s.source.margin_percent = 10.0;
    s.source.up_to_hz = 105.0;
    make(t, &s, nan(""));
    if (CHECK_INT(t, s.bands.n, 1)) {
        check_band(t, &s.bands.items[0], (const double[]){85.5, 95.0, 100.0, 105.0},
                   "95 to 100 Hz");
    }
    CHECK_INT(t, s.bands.n_notes, 0);
    s.source.up_to_hz = 107.0;
    make(t, &s, nan(""));
    if (CHECK_INT(t, s.bands.n, 1)) {
        check_band(t, &s.bands.items[0], (const double[]){85.5, 95.0, 107.0, 107.0},
                   "95 to 100 Hz + 118 to 130 Hz");
    }
    mt_arena_free(&s.mem);
}

static void bands__margins_can_be_replaced(mt_test *t)
{
    static const char *const harmonics[] = {"1P"};
    sample s;
    if (!begin(t, &s)) {
        return;
    }
    add_rotor(&s, "UH-60", MT_COUNT(harmonics), harmonics)->margin_percent = 3.0;
    s.intervals[0] = (mt_band_hz){10.0, 20.0, MT_NO_ADDR};
    s.source.n_intervals = 1;
    make(t, &s, 30.0);
    if (CHECK_INT(t, s.bands.n, 2)) {
        CHECK_NEAR(t, s.bands.items[0].lower_hz, 3.01, TOL);
        CHECK_NEAR(t, s.bands.items[1].lower_hz, 7.0, TOL);
        CHECK_NEAR(t, s.bands.items[0].base_lower_hz, 4.3, TOL);
    }
    make(t, &s, 0.0);
    CHECK_NEAR(t, s.bands.items[0].lower_hz, 4.3, TOL);
    mt_arena_free(&s.mem);
}

static void bands__what_is_not_known_is_left_out(mt_test *t)
{
    static const char *const harmonics[] = {"nP", "1T", "1P"};
    sample s;
    if (!begin(t, &s)) {
        return;
    }
    mt_rotor *const rotor = add_rotor(&s, NULL, MT_COUNT(harmonics), harmonics);
    rotor->blades = 0;
    rotor->tail_speed_hz = nan("");
    s.intervals[0] = (mt_band_hz){nan(""), 20.0, MT_NO_ADDR};
    s.source.n_intervals = 1;
    make(t, &s, nan(""));
    if (CHECK_INT(t, s.bands.n, 1)) {
        CHECK_STR(t, s.bands.items[0].label, "1P of rotor");
    }
    mt_arena_free(&s.mem);
}

static void bands__of_several_goals_are_united(mt_test *t)
{
    sample s;
    mt_bands a;
    mt_bands all;
    if (!begin(t, &s)) {
        return;
    }
    s.intervals[0] = (mt_band_hz){10.0, 20.0, MT_NO_ADDR};
    s.intervals[1] = (mt_band_hz){15.0, 30.0, MT_NO_ADDR};
    s.source.n_intervals = 2;
    make(t, &s, nan(""));
    a = s.bands;
    s.intervals[0] = (mt_band_hz){25.0, 40.0, MT_NO_ADDR};
    s.intervals[1] = (mt_band_hz){50.0, 60.0, MT_NO_ADDR};
    make(t, &s, nan(""));
    const mt_bands *const lists[] = {&s.bands, &a};
    CHECK_INT(t, mt_bands_unite(2, lists, &s.mem, &all, NULL), MT_OK);
    if (CHECK_INT(t, all.n, 2)) {
        check_band(t, &all.items[0], (const double[]){10.0, 10.0, 40.0, 40.0},
                   "10 to 20 Hz + 15 to 30 Hz + 25 to 40 Hz");
        CHECK_STR(t, all.items[1].label, "50 to 60 Hz");
    }
    CHECK_INT(t, all.n_notes, 1);
    CHECK_INT(t, mt_bands_unite(0, NULL, &s.mem, &all, NULL), MT_OK);
    CHECK_INT(t, all.n, 0);
    mt_arena_free(&s.mem);
}

static void bands__clearance_is_a_ratio_on_both_sides(mt_test *t)
{
    static const mt_band band = {10.0, 20.0, 9.0, 22.0, "test"};
    static const mt_band low = {0.0, 20.0, 0.0, 22.0, "from zero"};
    static const struct {
        const mt_band *band;
        double hz;
        double percent;
        mt_band_side side;
    } rows[] = {
        {&band, 9.0, 100.0 / 9.0, MT_BELOW_BAND},
        {&band, 22.0, 10.0, MT_ABOVE_BAND},
        {&band, 5.0, 100.0, MT_BELOW_BAND},
        {&band, 40.0, 100.0, MT_ABOVE_BAND},
        {&band, 10.0, 0.0, MT_INSIDE_BAND},
        {&band, 20.0, 0.0, MT_INSIDE_BAND},
        {&band, 11.0, -10.0, MT_INSIDE_BAND},
        {&band, 19.0, -100.0 / 19.0, MT_INSIDE_BAND},
        {&low, 19.0, -100.0 / 19.0, MT_INSIDE_BAND},
        {&low, 10.0, -100.0, MT_INSIDE_BAND},
        {&low, 30.0, 50.0, MT_ABOVE_BAND},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_band_side side = MT_INSIDE_BAND;
        mt_test_row(t, "%s, %g Hz", rows[i].band->label, rows[i].hz);
        const double percent = mt_band_clearance_percent(rows[i].band, rows[i].hz, &side);
        CHECK_NEAR_ABS(t, percent, rows[i].percent, 100.0 * TOL);
        CHECK_STR(t, mt_band_side_name(side), mt_band_side_name(rows[i].side));
        CHECK(t, mt_band_clearance_percent(rows[i].band, rows[i].hz, NULL) == percent);
    }
}

static mt_status make_once(mt_test *t, const void *context)
{
    static const char *const harmonics[] = {"4P", "5P", "1T"};
    sample s = {.source = {.margin_percent = 20.0, .up_to_hz = nan("")}};
    (void)t;
    (void)context;
    s.source.rotors = s.rotors;
    (void)add_rotor(&s, "UH-60", MT_COUNT(harmonics), harmonics);
    mt_status rc = mt_arena_init(&s.mem, 64, NULL);
    rc = rc == MT_OK ? mt_bands_make(&s.source, nan(""), &s.mem, &s.bands, NULL) : rc;
    mt_arena_free(&s.mem);
    return rc;
}

static void bands__every_failing_allocation_is_survived(mt_test *t)
{
    mt_refuse_each(t, "make_once", make_once, NULL, MT_OK);
}

MT_TEST_MAIN(MT_TEST(bands__harmonics_are_read_as_written),
             MT_TEST(bands__of_a_rotor_have_range_and_margin),
             MT_TEST(bands__that_overlap_are_merged_and_said_so),
             MT_TEST(bands__of_several_rotors_and_lists_keep_their_names),
             MT_TEST(bands__are_cut_off_at_the_limit),
             MT_TEST(bands__above_the_limit_change_none_below),
             MT_TEST(bands__margins_can_be_replaced),
             MT_TEST(bands__what_is_not_known_is_left_out),
             MT_TEST(bands__of_several_goals_are_united),
             MT_TEST(bands__clearance_is_a_ratio_on_both_sides),
             MT_TEST(bands__every_failing_allocation_is_survived))
