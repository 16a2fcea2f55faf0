/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What the goals do not settle, and what only looks so: through a corner of the bounds no
 * direction has room, and "nothing changes along it" is then no finding. Random problems with
 * originals on the bounds, against a search on nested grids. In closed form:
 * test_nlp_directions.c.
 */
#include "nlp_problem.h"

enum { SPRINGS = 3, PROBLEMS = 300, GRID = 21, ZOOMS = 8, BISECTIONS = 42 };

/* xorshift64* (Vigna 2016): a number in [0, 1). */
static double draw(uint64_t *state)
{
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return (double)((*state * UINT64_C(2685821657736338717)) >> 11) * 0x1p-53;
}

/* Masses m0, m1 between walls: springs exp(t0), exp(t1), exp(t2); one requirement on a mode. */
typedef enum requirement { TARGET, AT_LEAST, AT_MOST } requirement;

typedef struct springs_case {
    nlp_case c; /* first: the callback's context */
    double mass[2];
    double weight[SPRINGS];
    int sign; /* -1: the lower mode, +1: the higher one */
    requirement kind;
    double ln_lambda; /* what is demanded */
    bool least_sum;   /* the objective is the sum of the stiffnesses, not the change */
} springs_case;

/* ln of omega^2 and its slopes: lambda = (a + b)/2 +- sqrt(((a - b)/2)^2 + c^2), a = (k0 +
 * k1)/m0, b = (k1 + k2)/m1. */
static double ln_lambda(const springs_case *s, const double *t, double *slope)
{
    const double k[] = {exp(t[0]), exp(t[1]), exp(t[2])};
    const double a = (k[0] + k[1]) / s->mass[0];
    const double b = (k[1] + k[2]) / s->mass[1];
    const double c2 = k[1] * k[1] / (s->mass[0] * s->mass[1]);
    const double root = sqrt(0.25 * (a - b) * (a - b) + c2);
    const double lambda = 0.5 * (a + b) + s->sign * root;
    if (slope != NULL) {
        const double da[] = {k[0] / s->mass[0], k[1] / s->mass[0], 0};
        const double db[] = {0, k[1] / s->mass[1], k[2] / s->mass[1]};
        for (int j = 0; j < SPRINGS; j++) {
            const double dc2 = j == 1 ? 2 * c2 : 0;
            const double dr = (0.25 * (a - b) * (da[j] - db[j]) + 0.5 * dc2) / root;
            slope[j] = (0.5 * (da[j] + db[j]) + s->sign * dr) / lambda;
        }
    }
    return log(lambda);
}

static double objective(const springs_case *s, const double *t, double *slope)
{
    double f = 0;
    for (int j = 0; j < SPRINGS; j++) {
        const double d = t[j] - s->c.origin[j];
        f += s->least_sum ? s->weight[j] * exp(t[j]) : 0.5 * s->weight[j] * d * d;
        if (slope != NULL) {
            slope[j] = s->least_sum ? s->weight[j] * exp(t[j]) : s->weight[j] * d;
        }
    }
    return f;
}

static mt_status springs(void *context, const double *t, bool with_gradient, mt_nlp_values *out,
                         mt_err *err)
{
    const springs_case *const s = context;
    const double sign = s->kind == AT_MOST ? -1 : 1;
    double slope[SPRINGS];
    (void)with_gradient;
    (void)err;
    out->f = objective(s, t, out->df);
    double *const value = s->kind == TARGET ? out->eq : out->in;
    double *const row = s->kind == TARGET ? out->deq : out->din;
    value[0] = sign * (ln_lambda(s, t, slope) - s->ln_lambda);
    for (int j = 0; j < s->c.nlp.n; j++) {
        row[j] = j < SPRINGS ? sign * slope[j] : 0; /* a fourth variable does nothing */
        out->df[j] = j < SPRINGS ? out->df[j] : 0;
    }
    if (s->c.nlp.n > SPRINGS && !s->least_sum) {
        const double d = t[SPRINGS] - s->c.origin[SPRINGS];
        out->f += 0.5 * d * d;
        out->df[SPRINGS] = d;
    }
    return MT_OK;
}

/* Bounds of a factor of 1.5 to 6; the origin mostly on one of them, or outside, or within. */
static void make(springs_case *s, uint64_t *state)
{
    double inside[SPRINGS];
    case_begin(&s->c, draw(state) < 0.25 ? SPRINGS + 1 : SPRINGS, NULL, 0, 1);
    s->c.nlp.eval = springs;
    for (int j = 0; j <= SPRINGS; j++) {
        const double width = log(1.5 + 4.5 * draw(state));
        const double u = draw(state);
        s->c.origin[j] = log(100.0) + 2 * draw(state);
        const double at = u < 0.4 ? 0 : u < 0.8 ? 1 : u < 0.9 ? draw(state) : 1.1;
        s->c.lower[j] = s->c.origin[j] - at * width;
        s->c.upper[j] = s->c.lower[j] + width;
        if (j < SPRINGS) {
            inside[j] = s->c.lower[j] + width * draw(state);
            s->weight[j] = 0.2 + 3 * draw(state);
        }
    }
    s->mass[0] = 0.5 + draw(state);
    s->mass[1] = 0.5 + draw(state);
    s->sign = draw(state) < 0.5 ? -1 : 1;
    s->kind = (requirement)(3 * draw(state));
    s->least_sum = draw(state) < 0.4;
    s->ln_lambda = ln_lambda(s, inside, NULL);
    s->c.nlp.n_eq = s->kind == TARGET;
    s->c.nlp.n_in = s->kind != TARGET;
    s->c.nlp.context = s;
}

/* Least objective over t[2] with t[0], t[1] as they are; HUGE_VAL where the requirement cannot
 * be met. lambda rises with every spring: what meets the requirement is an interval. */
static double best_third(const springs_case *s, double *t)
{
    double low = s->c.lower[2];
    double high = s->c.upper[2];
    t[2] = low;
    const bool low_under = ln_lambda(s, t, NULL) < s->ln_lambda;
    t[2] = high;
    const bool high_over = ln_lambda(s, t, NULL) > s->ln_lambda;
    if ((s->kind != AT_MOST && !high_over) || (s->kind != AT_LEAST && !low_under)) {
        return HUGE_VAL;
    }
    double from = low;
    double to = high;
    for (int k = 0; k < BISECTIONS && low_under && high_over; k++) {
        t[2] = 0.5 * (from + to);
        if (ln_lambda(s, t, NULL) < s->ln_lambda) {
            from = t[2];
        } else {
            to = t[2];
        }
    }
    low = s->kind == AT_MOST || !low_under ? low : to;
    high = s->kind == AT_LEAST || !high_over ? high : s->kind == TARGET ? low : from;
    t[2] = s->least_sum ? low : fmin(fmax(s->c.origin[2], low), high);
    return objective(s, t, NULL);
}

/* An upper bound of the least objective, near it: a grid over two variables, then finer ones
 * around its best. */
static double on_grids(const springs_case *s)
{
    double low[2] = {s->c.lower[0], s->c.lower[1]};
    double high[2] = {s->c.upper[0], s->c.upper[1]};
    double best = HUGE_VAL;
    for (int zoom = 0; zoom < ZOOMS; zoom++) {
        double at[2] = {low[0], low[1]};
        for (int i = 0; i < GRID * GRID; i++) {
            const int row = i / GRID;
            const int column = i % GRID;
            double t[SPRINGS] = {low[0] + (high[0] - low[0]) * (double)column / (GRID - 1),
                                 low[1] + (high[1] - low[1]) * (double)row / (GRID - 1), 0};
            const double f = best_third(s, t);
            if (f <= best) {
                best = f;
                at[0] = t[0];
                at[1] = t[1];
            }
        }
        for (int j = 0; j < 2; j++) {
            const double reach = (high[j] - low[j]) / 8;
            low[j] = fmax(s->c.lower[j], at[j] - reach);
            high[j] = fmin(s->c.upper[j], at[j] + reach);
        }
    }
    return best;
}

static void nlp_undetermined__originals_on_bounds_do_not_spoil_optima(mt_test *t)
{
    /* of the objective: the tolerance of a requirement buys about so much */
    static const double REACHED = 1e-6;
    uint64_t state = 20260207;
    springs_case s = {.kind = TARGET};
    int judged = 0;
    for (int k = 0; k < PROBLEMS; k++) {
        make(&s, &state);
        mt_test_row(t, "problem %d", k);
        mt_nlp_options opt = mt_nlp_options_default();
        opt.least_change = !s.least_sum;
        REQUIRE(t, case_solve(&s.c, &opt) == MT_OK);
        const double reference = on_grids(&s);
        if (!(reference < HUGE_VAL)) {
            continue;
        }
        judged++;
        const mt_nlp_result *const r = &s.c.result;
        REQUIRE(t, r->n_solutions > 0 && r->solutions[0].feasible);
        const mt_nlp_solution *const best = &r->solutions[0];
        CHECK(t, objective(&s, best->t, NULL) <= reference + REACHED * (1 + fabs(reference)));
        CHECK(t, !(best->kkt > 1e-6));         /* NaN: a vertex */
        const bool idle = s.c.nlp.n > SPRINGS; /* the fourth variable, and nothing else */
        CHECK_INT(t, r->n_unidentifiable, idle);
        const double kept =
            fmin(fmax(s.c.origin[SPRINGS], s.c.lower[SPRINGS]), s.c.upper[SPRINGS]);
        CHECK(t, !idle || best->t[SPRINGS] == kept);
    }
    CHECK(t, judged > PROBLEMS / 2);
    mt_arena_free(&s.c.mem);
}

MT_TEST_MAIN(MT_TEST(nlp_undetermined__originals_on_bounds_do_not_spoil_optima))
