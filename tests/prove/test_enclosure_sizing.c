/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Sizing: sections, areas, masses and moduli enter stiffness and mass, not positions, so their
 * certificates are held against brute force: frames of beams in the plane and in space, trusses
 * in space, links of rigid elements, random sections. No fresh analysis of a sampled design may
 * lie outside what is proven for its box.
 */
#include <stdlib.h>

#include "mechanics/mech.h"
#include "mt_writer.h"
#include "prove/certify.h"
#include "prove/tolerance.h"
#include "support/mt_random.h"

enum { TEXT = 16384, SYSTEMS = 40, SAMPLES = 30, MODES = 96, FAMILIES = 5 };

typedef struct writer {
    mt_writer out;
    int n; /* parameters p0, p1, ... */
    double value[MECH_INPUTS];
    mt_random r;
} writer;

#define put(w, ...) mt_write(&(w)->out, __VA_ARGS__)

/* A number of the model: now and then a new parameter, else as it is. */
static void number(writer *w, const char *member, double value)
{
    if (w->n < 6 && mt_random_int(&w->r, 3) > 0) {
        w->value[w->n] = value;
        put(w, "\"%s\": \"p%d\"", member, w->n++);
    } else {
        put(w, "\"%s\": %.6g", member, value);
    }
}

static void section(writer *w, bool space)
{
    const double d = mt_random_in(&w->r, 0.03, 0.06);
    put(w, "\"section\": {");
    switch (mt_random_int(&w->r, 4)) {
    case 0:
        put(w, "\"shape\": \"rectangle\", ");
        number(w, "width_m", mt_random_in(&w->r, 0.02, 0.05));
        put(w, ", ");
        number(w, "height_m", d);
        break;
    case 1:
        put(w, "\"shape\": \"circle\", ");
        number(w, "diameter_m", d);
        break;
    case 2: /* a tube by its wall */
        if (w->n < 6) {
            w->value[w->n] = d;
            w->value[w->n + 1] = 0.05 * d;
            put(w,
                "\"shape\": \"tube\", \"outer_diameter_m\": \"p%d\", \"inner_diameter_m\": "
                "\"p%d - 2*p%d\"",
                w->n, w->n, w->n + 1);
            w->n += 2;
            break;
        }
        put(w, "\"shape\": \"tube\", \"outer_diameter_m\": %.6g, \"inner_diameter_m\": %.6g", d,
            0.8 * d);
        break;
    default:
        put(w, "\"shape\": \"general\", ");
        number(w, "area_m2", 0.5 * d * d);
        put(w, ", ");
        number(w, "second_moment_m4", 0.05 * d * d * d * d);
        if (space) {
            put(w, ", ");
            number(w, "second_moment_other_m4", 0.03 * d * d * d * d);
            put(w, ", \"torsion_constant_m4\": %.6g", 0.04 * d * d * d * d);
        }
        break;
    }
    put(w, "}");
}

/* axis: of the hinges, perpendicular to the beam; in the plane not used. */
static void beam(writer *w, const char *name, const char *from, const char *to,
                 const char *axis, bool space)
{
    put(w,
        "{\"name\": \"%s\", \"kind\": \"beam\", \"from\": \"%s\", \"to\": \"%s\", "
        "\"elements\": %d, ",
        name, from, to, 1 + mt_random_int(&w->r, 2));
    number(w, "youngs_modulus_pa", 7e10);
    put(w, ", ");
    if (space) {
        put(w, "\"hinge_axis\": [%s], ", axis);
        number(w, "shear_modulus_pa", 2.6e10);
        put(w, ", ");
    }
    if (mt_random_int(&w->r, 4) == 0) {
        number(w, "mass_kg", mt_random_in(&w->r, 0.5, 4.0));
    } else {
        number(w, "density_kg_per_m3", 2700.0);
    }
    put(w, ", ");
    section(w, space);
    put(w, "}");
}

/* A portal or an angle: beams clamped at a and d, rigidly joined at b and c. */
static void frame(writer *w, bool space)
{
    const double z = space ? 1.0 : 0.0;
    const int beams = 2 + mt_random_int(&w->r, 2);
    put(w, "{\"format\": \"modetune-model/1\", \"name\": \"frame\", \"dimension\": %d, ",
        space ? 3 : 2);
    put(w, space ? "\"points\": {\"a\": [0, 0, 0], \"b\": [0.1, 1, 0.1], "
                   "\"c\": [1.2, 0.9, -0.2], \"d\": [1.2, 0, 0.3]}, "
                 : "\"points\": {\"a\": [0, 0], \"b\": [0.1, 1], \"c\": [1.2, 0.9], "
                   "\"d\": [1.2, 0]}, ");
    put(w, "\"bodies\": [{\"name\": \"load\", ");
    number(w, "mass_kg", mt_random_in(&w->r, 0.5, 3.0));
    put(w, ", \"centre\": \"b\"}], \"links\": [");
    beam(w, "u", "a", "b", "1, -0.1, 0", space);
    put(w, ", ");
    beam(w, "v", "b", "c", "0.1, 1.1, 0", space);
    if (beams == 3) {
        put(w, ", ");
        beam(w, "w", "d", "c", "1, 0, 0", space);
    }
    put(w,
        "], \"joints\": [{\"name\": \"ja\", \"type\": \"fixed\", \"bodies\": [\"ground\", "
        "\"u.start\"], \"at\": \"a\"}, {\"name\": \"jb\", \"type\": \"fixed\", \"bodies\": "
        "[\"u.end\", \"v.start\"], \"at\": \"b\"}, {\"name\": \"jl\", \"type\": \"%s\", "
        "\"bodies\": [\"v.start\", \"load\"], \"at\": \"b\"}",
        z > 0.0 ? "spherical" : "revolute");
    if (beams == 3) {
        put(w,
            ", {\"name\": \"jc\", \"type\": \"%s\", \"bodies\": [\"v.end\", \"w.end\"], "
            "\"at\": \"c\"}, {\"name\": \"jd\", \"type\": \"fixed\", \"bodies\": [\"ground\", "
            "\"w.start\"], \"at\": \"d\"}",
            mt_random_int(&w->r, 2) == 0 ? "fixed" : (space ? "spherical" : "revolute"));
    }
    put(w, "], ");
}

static void frame_2(writer *w)
{
    frame(w, false);
}

static void frame_3(writer *w)
{
    frame(w, true);
}

/* Two free points in space, each held by bars from the ground, with one between them. */
static void truss_3(writer *w)
{
    static const char *const HELD[7][2] = {{"g0", "u"}, {"g1", "u"}, {"g2", "u"}, {"g1", "v"},
                                           {"g2", "v"}, {"g3", "v"}, {"u", "v"}};
    put(w, "{\"format\": \"modetune-model/1\", \"name\": \"truss\", \"dimension\": 3, "
           "\"points\": {\"g0\": [0, 0, 0], \"g1\": [1, 0, 0.1], \"g2\": [0.5, 1, 0], "
           "\"g3\": [2, 0.5, 0], \"nu\": [0.4, 0.4, 0.9], \"nv\": [1.3, 0.4, 1.1]}, "
           "\"bodies\": [{\"name\": \"u\", \"centre\": \"nu\", ");
    number(w, "mass_kg", mt_random_in(&w->r, 0.5, 3.0));
    put(w, "}, {\"name\": \"v\", \"centre\": \"nv\", ");
    number(w, "mass_kg", mt_random_in(&w->r, 0.5, 3.0));
    put(w, "}], \"springs\": [");
    for (int i = 0; i < 7; i++) {
        const bool ground = i < 6;
        put(w, "%s{\"name\": \"b%d\", \"type\": \"bar\", \"bodies\": [\"%s\", \"%s\"], ",
            i == 0 ? "" : ", ", i, ground ? "ground" : HELD[i][0], HELD[i][1]);
        if (ground) {
            put(w, "\"at\": [\"%s\", \"n%s\"], ", HELD[i][0], HELD[i][1]);
        }
        number(w, "youngs_modulus_pa", 7e10);
        put(w, ", ");
        number(w, "density_kg_per_m3", 2700.0);
        put(w, ", ");
        number(w, "area_m2", mt_random_in(&w->r, 1e-4, 1e-3));
        put(w, "}");
    }
    put(w, "], ");
}

static void links(writer *w, bool space)
{
    put(w,
        "{\"format\": \"modetune-model/1\", \"name\": \"links\", \"dimension\": %d, "
        "\"links\": [{\"name\": \"l\", \"from\": [0, 0%s], \"to\": [1, 0.2%s], "
        "\"elements\": 5, ",
        space ? 3 : 2, space ? ", 0" : "", space ? ", 0.1" : "");
    if (space) {
        put(w, "\"hinge_axis\": [0.2, -1, 0], ");
        number(w, "radius_of_gyration_m", 0.02);
        put(w, ", ");
    }
    number(w, "youngs_modulus_pa", 7e10);
    put(w, ", ");
    number(w, "density_kg_per_m3", 2700.0);
    put(w, ", ");
    section(w, space);
    put(w,
        "}], \"joints\": [{\"name\": \"root\", \"type\": \"fixed\", \"bodies\": "
        "[\"ground\", \"l.start\"], \"at\": [0, 0%s]}], ",
        space ? ", 0" : "");
}

/* A semidefinite n x n matrix, times a parameter each (`common`), or with a parameter in each
 * coupling: those are small against the diagonal. Lower entries as texts. */
static void matrix(writer *w, int n, double scale, bool common, char entry[6][6][64])
{
    double a[6][6];
    const int rank = n - mt_random_int(&w->r, 2);
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < n; k++) {
            a[i][k] = k < rank ? mt_random_in(&w->r, -1.0, 1.0) : 0.0;
        }
    }
    const int factor = w->n;
    const double value = mt_random_in(&w->r, 0.5, 2.0);
    w->value[w->n] = value;
    w->n += common ? 1 : 0;
    for (int i = 0; i < n; i++) {
        for (int j = 0; j <= i; j++) {
            double b = 0.0;
            for (int k = 0; k < n; k++) {
                b += scale * a[i][k] * a[j][k];
            }
            if (common) {
                (void)snprintf(entry[i][j], sizeof entry[i][j], "%.17g*p%d", b / value, factor);
            } else if (i == j) {
                (void)snprintf(entry[i][j], sizeof entry[i][j], "%.17g", b + (0.5 * scale));
            } else if (w->n < 5 && mt_random_int(&w->r, 2) == 0) {
                w->value[w->n] = 0.1 * scale * mt_random_in(&w->r, 0.2, 1.0);
                (void)snprintf(entry[i][j], sizeof entry[i][j], "%sp%d", b < 0.0 ? "-" : "",
                               w->n);
                w->n++;
            } else {
                (void)snprintf(entry[i][j], sizeof entry[i][j], "0.2*%.17g", b);
            }
        }
    }
}

static void put_bushing(writer *w, const char *name, const char *from, const char *to,
                        double scale, bool common)
{
    char entry[6][6][64];
    matrix(w, 6, scale, common, entry);
    put(w,
        "{\"name\": \"%s\", \"type\": \"bushing\", \"bodies\": [\"%s\", \"%s\"], "
        "\"at\": [0.1, 0, 0.2], \"stiffness_matrix\": [",
        name, from, to);
    for (int i = 0; i < 6; i++) {
        put(w, "%s[", i == 0 ? "" : ", ");
        for (int j = 0; j < 6; j++) {
            put(w, "%s\"%s\"", j == 0 ? "" : ", ", i > j ? entry[i][j] : entry[j][i]);
        }
        put(w, "]");
    }
    put(w, "]}");
}

static void put_body(writer *w, const char *name, double x, bool common)
{
    char entry[6][6][64];
    matrix(w, 3, 0.02, common, entry);
    put(w, "{\"name\": \"%s\", \"centre\": [%.6g, 0, 0.1], ", name, x);
    number(w, "mass_kg", mt_random_in(&w->r, 0.5, 2.0));
    /* tr(S) E - S of the second moments S */
    put(w, ", \"inertia_kg_m2\": [\"%s + %s + 1e-3\", \"%s + %s + 1e-3\", ", entry[1][1],
        entry[2][2], entry[0][0], entry[2][2]);
    put(w, "\"%s + %s + 1e-3\", \"-(%s)\", \"-(%s)\", \"-(%s)\"]}", entry[0][0], entry[1][1],
        entry[1][0], entry[2][0], entry[2][1]);
}

/* Two bodies in space whose inertia tensors and bushings couple directions. */
static void bodies(writer *w)
{
    put(w, "{\"format\": \"modetune-model/1\", \"name\": \"bodies\", \"dimension\": 3, "
           "\"bodies\": [");
    put_body(w, "u", 0.0, mt_random_int(&w->r, 2) == 0);
    put(w, ", ");
    put_body(w, "v", 0.3, mt_random_int(&w->r, 2) == 0);
    put(w, "], \"springs\": [");
    put_bushing(w, "s", "ground", "u", 1e4, mt_random_int(&w->r, 2) == 0);
    put(w, ", ");
    put_bushing(w, "t", "u", "v", 1e4, mt_random_int(&w->r, 2) == 0);
    put(w, "], ");
}

static void links_2(writer *w)
{
    links(w, false);
}

typedef struct rig {
    writer w;
    mt_model *model;
    mt_analysis *a;
    mt_enclosure *e;
    mt_arena mem;
    double lower[MECH_INPUTS];
    double upper[MECH_INPUTS];
} rig;

static void end(rig *g)
{
    mt_enclosure_delete(g->e);
    mt_analysis_delete(g->a);
    mt_arena_free(&g->mem);
    mt_model_delete(g->model);
}

static bool begin(mt_test *t, int seed, rig *g)
{
    static char text[TEXT];
    static void (*const families[FAMILIES])(writer *) = {frame_2, frame_3, truss_3, links_2,
                                                         bodies};
    int inputs[MECH_INPUTS];
    mt_err err = {.text = ""};
    char reason[MT_REASON_SIZE] = "";
    *g = (rig){.w = {.out = {text, sizeof text, 0}, .r = mt_random_seed((uint64_t)seed + 77)}};
    families[seed % FAMILIES](&g->w);
    put(&g->w, "\"parameters\": {");
    for (int i = 0; i < g->w.n; i++) {
        put(&g->w, "%s\"p%d\": %.17g", i == 0 ? "" : ", ", i, g->w.value[i]);
    }
    put(&g->w, "}, \"configurations\": {\"a\": {}}}");
    g->model = mech_parse(t, g->w.out.text);
    if (g->model == NULL || !CHECK(t, mt_arena_init(&g->mem, 0, &err) == MT_OK)) {
        return false;
    }
    const double most = seed % 2 == 0 ? 1.1 : 1.8;
    const bool coupled = families[seed % FAMILIES] == bodies;
    for (int i = 0; i < g->w.n; i++) {
        const double reach = mt_random_in(&g->w.r, 1.02, most);
        char name[16];
        (void)snprintf(name, sizeof name, "p%d", i);
        inputs[i] = mt_model_find_parameter(g->model, name);
        g->lower[i] = g->w.value[i] / reach;
        g->upper[i] = g->w.value[i] * reach;
    }
    const bool ok =
        mt_analysis_new(g->model, 0, g->w.n, inputs, g->w.value, &g->a, &err) == MT_OK &&
        mt_enclosure_new(g->a, g->lower, g->upper, &g->e, reason, &err) == MT_OK;
    if (ok && coupled && g->e == NULL) { /* couplings may be too loose, but only they */
        CHECK(t, strstr(reason, "couples two") != NULL || strstr(reason, "product of") != NULL);
        return false;
    }
    if (!CHECK(t, ok && g->e != NULL)) { /* sizing never voids a certificate */
        (void)fprintf(stderr, "%s %s\n%s\n", err.text, reason, g->w.out.text);
        return false;
    }
    return CHECK(t, g->e->n_modes > 0 && g->e->n_modes <= MODES);
}

static double hz(const rig *g, int mode)
{
    const int at = mt_modal_flexible(&g->a->modes, mode);
    return at < 0 ? nan("") : mt_modal_hz(&g->a->modes, at);
}

static bool analyse(mt_test *t, rig *g, const double *x)
{
    const mt_analysis_options opt = mt_analysis_options_default();
    mt_err err;
    return CHECK(t, mt_analysis_solve(g->a, x, &opt, &err) == MT_OK);
}

/* Under valgrind a few systems are enough: what counts there is memory, not statistics. */
static int systems(void)
{
    return getenv("MT_TEST_LAUNCHED") != NULL ? FAMILIES : SYSTEMS;
}

/* A box within the bounds; every third is one design: there rounding decides. */
static void choose_box(rig *g, int seed, double *lo, double *hi)
{
    for (int i = 0; i < g->w.n; i++) {
        const double a = mt_random_in(&g->w.r, g->lower[i], g->upper[i]);
        const double b = mt_random_in(&g->w.r, g->lower[i], g->upper[i]);
        lo[i] = fmin(a, b);
        hi[i] = seed % 3 == 0 ? lo[i] : fmax(a, b);
    }
}

static void sizing__every_sample_lies_in_the_ranges(mt_test *t)
{
    for (int seed = 0; seed < systems(); seed++) {
        rig g;
        double lo[MECH_INPUTS];
        double hi[MECH_INPUTS];
        double x[MECH_INPUTS];
        double low[MODES];
        double high[MODES];
        mt_err err = {.text = ""};
        mt_test_row(t, "system %d", seed);
        if (begin(t, seed, &g)) {
            choose_box(&g, seed, lo, hi);
            CHECK(t, mt_enclosure_set(g.e, lo, hi));
            CHECK(t, mt_enclosure_ranges(g.e, low, high, &err) == MT_OK);
            for (int i = 0; i < SAMPLES; i++) {
                mt_random_in_box(&g.w.r, 3, g.w.n, lo, hi, x);
                const bool solved = analyse(t, &g, x);
                for (int k = 0; solved && k < g.e->n_modes; k++) {
                    const double f = hz(&g, k + 1);
                    const double lambda = mt_enclosure_lambda(f);
                    CHECK(t, low[k] <= f && f <= high[k]);
                    CHECK(t, mt_enclosure_most_below(g.e, lambda) >= k + 1);
                    CHECK(t, mt_enclosure_least_below(g.e, lambda) <= k);
                }
            }
        }
        end(&g);
    }
}

/* How many modes lie below the band; -1 where one lies in it. */
static int modes_below(const rig *g, const mt_certify_band *band)
{
    int below = 0;
    for (int k = 1; k <= g->e->n_modes; k++) {
        const double f = hz(g, k);
        if (f > band->lower_hz && f < band->upper_hz) {
            return -1;
        }
        below += f <= band->lower_hz ? 1 : 0;
    }
    return below;
}

typedef struct tally {
    int proven;
    int infeasible;
    int boxes;
    long feasible;
} tally;

static bool among(const int *list, int n, int one)
{
    for (int i = 0; i < n; i++) {
        if (list[i] == one) {
            return true;
        }
    }
    return false;
}

/* No sample has an assignment that is excluded, and none in the tolerance box of a design
 * leaves its own. */
static void check_band(mt_test *t, rig *g, tally *n)
{
    const int mode = 1 + mt_random_int(&g->w.r, g->e->n_modes < 4 ? g->e->n_modes : 4);
    if (!analyse(t, g, g->w.value)) {
        return;
    }
    const double f = hz(g, mode) * mt_random_in(&g->w.r, 0.9, 1.1);
    const mt_certify_band band = {0, f, f * mt_random_in(&g->w.r, 1.01, 1.6), 1e-6};
    const mt_certify c = {.n_views = 1,
                          .views = &g->e,
                          .n_bands = 1,
                          .bands = &band,
                          .n = g->w.n,
                          .lower = g->lower,
                          .upper = g->upper,
                          .max_work = 3e6};
    mt_certify_search out;
    mt_err err = {.text = ""};
    double x[MECH_INPUTS];
    double design[MECH_INPUTS];
    int assignment = -1;
    CHECK(t, mt_certify_assignments(&c, 0, NULL, &g->mem, &out, &err) == MT_OK);
    n->proven += out.proven ? 1 : 0;
    n->infeasible += out.proven && out.n_found == 0 ? 1 : 0;
    for (int i = 0; i < SAMPLES; i++) {
        mt_random_in_box(&g->w.r, 3, g->w.n, g->lower, g->upper, x);
        const int below = analyse(t, g, x) ? modes_below(g, &band) : -1;
        if (below >= 0) {
            n->feasible++;
            CHECK(t,
                  among(out.found, out.n_found, below) || among(out.open, out.n_open, below));
            assignment = below;
            memcpy(design, x, sizeof x);
        }
    }
    if (assignment < 0) {
        return;
    }
    mt_tolerance all;
    const mt_tolerance_question q = {design, NULL, &assignment, 50.0, 0};
    CHECK(t, mt_certify_tolerance(&c, &q, &g->mem, &all, NULL, &err) == MT_OK);
    n->boxes += all.percent > 0.01 ? 1 : 0;
    for (int i = 0; i < SAMPLES; i++) {
        double lo[MECH_INPUTS];
        double hi[MECH_INPUTS];
        for (int k = 0; k < g->w.n; k++) {
            lo[k] = design[k] * (1.0 - all.percent / 100.0);
            hi[k] = design[k] * (1.0 + all.percent / 100.0);
        }
        mt_random_in_box(&g->w.r, 3, g->w.n, lo, hi, x);
        CHECK(t, analyse(t, g, x) && modes_below(g, &band) == assignment);
    }
}

static void sizing__no_sample_has_what_is_excluded(mt_test *t)
{
    tally n = {0};
    for (int seed = 0; seed < systems(); seed++) {
        rig g;
        mt_test_row(t, "system %d", seed);
        if (begin(t, seed, &g)) {
            check_band(t, &g, &n);
        }
        end(&g);
    }
    (void)printf("%d of %d proven, %d of them infeasible; %ld feasible samples, %d boxes\n",
                 n.proven, systems(), n.infeasible, n.feasible, n.boxes);
    const bool launched = systems() < SYSTEMS;
    CHECK(t, launched || n.proven > SYSTEMS / 3); /* or the test shows nothing */
    CHECK(t, launched || n.infeasible > 0);
    CHECK(t, launched || n.feasible > SYSTEMS);
    CHECK(t, launched || n.boxes > SYSTEMS / 4);
}

/* A tube given by its wall, pi/4 (d^2 - (d - 2 t)^2), is one by its diameters; and it is
 * enclosed where the wall is thin. */
static void sizing__a_tube_by_its_wall_is_a_tube(mt_test *t)
{
    static const char *const text =
        "{\"format\": \"modetune-model/1\", \"name\": \"tube\", \"dimension\": 3, "
        "\"parameters\": {\"d\": 0.05, \"w\": 0.001}, \"links\": [{\"name\": \"l\", \"kind\": "
        "\"beam\", \"from\": [0, 0, 0], \"to\": [1, 0, 0], \"elements\": 4, "
        "\"hinge_axis\": [0, 1, 0], "
        "\"youngs_modulus_pa\": 7e10, \"shear_modulus_pa\": 2.6e10, "
        "\"density_kg_per_m3\": 2700, \"section\": {%s}}], \"joints\": [{\"name\": \"r\", "
        "\"type\": \"fixed\", \"bodies\": [\"ground\", \"l.start\"], \"at\": [0, 0, 0]}], "
        "\"configurations\": {\"a\": {}}}";
    static const char *const sections[3] = {
        "\"shape\": \"tube\", \"outer_diameter_m\": \"d\", \"inner_diameter_m\": \"d - 2*w\"",
        "\"shape\": \"tube\", \"outer_diameter_m\": \"d\", \"inner_diameter_m\": \"0.048 + "
        "0*w\"",
        "\"shape\": \"general\", \"area_m2\": \"pi/4*(d^2 - (d - 2*w)^2)\", "
        "\"second_moment_m4\": \"pi/64*(d^4 - (d - 2*w)^4)\", "
        "\"second_moment_other_m4\": \"pi/64*(d^4 - (d - 2*w)^4)\", "
        "\"torsion_constant_m4\": \"pi/32*(d^4 - (d - 2*w)^4)\""};
    mech s[3];
    for (int i = 0; i < 3; i++) {
        char model[TEXT];
        char reason[MT_REASON_SIZE] = "";
        mt_enclosure *e = NULL;
        mt_err err;
        static const double lower[2] = {0.03, 0.0005};
        static const double upper[2] = {0.09, 0.004};
        (void)snprintf(model, sizeof model, text, sections[i]);
        mt_test_row(t, "section %d", i);
        if (!mech_must(t, mech_parse(t, model), NULL, "d w", &s[i])) {
            continue;
        }
        for (int k = 1; k <= 6; k++) {
            CHECK_NEAR(t, mech_hz(&s[i], k), mech_hz(&s[0], k), 1e-9);
        }
        if (i != 1) { /* a fixed inner diameter of 48 mm is wider than a tube of 30 mm */
            CHECK(t, mt_enclosure_new(s[i].a, lower, upper, &e, reason, &err) == MT_OK);
            CHECK(t, e != NULL);
            CHECK_STR(t, reason, "");
        }
        mt_enclosure_delete(e);
    }
    for (int i = 0; i < 3; i++) {
        mech_free(&s[i]);
    }
}

MT_TEST_MAIN(MT_TEST(sizing__every_sample_lies_in_the_ranges),
             MT_TEST(sizing__no_sample_has_what_is_excluded),
             MT_TEST(sizing__a_tube_by_its_wall_is_a_tube))
