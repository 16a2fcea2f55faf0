/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A state space with the names of its states and ports, and how well it follows the
 * mechanism. */
#include "inspect/state_space.h"

#include <math.h>
#include <stdlib.h>

#include "inspect/response.h"

static const double TWO_PI = 6.283185307179586477;
/* Frequencies at which it is compared, in equal ratios; the last one is `to`. */
enum { COMPARED = 200 };

#define THIS mt_matrix_row
static const mt_field matrix_fields[] = {
    MT_F_NUMBERS(NULL, value, n,
                 "A row of the matrix, in the units of its state, port or time.",
                 MT_F_EVERY(step)),
};
static const mt_record matrix_record = MT_F_BARE_RECORD_OF(matrix_fields);
#undef THIS

#define THIS mt_state_space_row
static const mt_field state_space_fields[] = {
    MT_F_COUNT("modes", modes, 0, "Modes that are kept, rigid-body modes included."),
    MT_F_COUNT("residual_shapes", residual_shapes, 0,
               "Shapes for what the other modes do at rest, each with a frequency of its own."),
    MT_F_TEXTS("states", states, n_states,
               "Names of the states: amplitude [m sqrt(kg)] and rate of each mode and residual "
               "shape, amplitudes of directions without mass, integrals of inputs."),
    MT_F_LIST("inputs", inputs, n_inputs, mt_port, mt_response_port_record,
              "Of the columns of B and D, one each.", .flat = true),
    MT_F_LIST("outputs", outputs, n_outputs, mt_port, mt_response_port_record,
              "Of the rows of C and D, one each.", .flat = true),
    MT_F_LIST("A", a, n_states, mt_matrix_row, matrix_record,
              "Rows of A in x' = A x + B u, time in seconds."),
    MT_F_LIST("B", b, n_states, mt_matrix_row, matrix_record, "Rows of B."),
    MT_F_LIST("C", c, n_outputs, mt_matrix_row, matrix_record, "Rows of C in y = C x + D u."),
    MT_F_LIST("D", d, n_outputs, mt_matrix_row, matrix_record, "Rows of D."),
    MT_F_FLAG("viscous_for_loss_factors", viscous_for_loss_factors,
              "Loss factors stand as the viscous damping that takes as much energy from each "
              "mode at its own frequency; a loss factor itself has no state space."),
    MT_F_NUMBER("from_hz", from_hz, "Lowest frequency at which it was compared."),
    MT_F_NUMBER("to_hz", to_hz, "Highest frequency at which it was compared."),
    MT_F_COUNT("compared", compared, 0,
               "Number of these frequencies, in equal ratios; where an undamped mode resonates "
               "there is nothing to compare."),
    MT_F_NUMBER_OR_NULL(
        "largest_difference_percent", largest_difference_percent,
        "Largest difference there from the response of all modes, in percent of the response's "
        "magnitude, or of its median over these frequencies where that is more; null: nothing "
        "was compared."),
};
const mt_record mt_state_space_record =
    MT_F_RECORD_OF(state_space_fields, "state_space",
                   "The mechanism between the ports as x' = A x + B u, y = C x + D u.");
#undef THIS

static const char **state_names(const mt_response *r, const mt_state_space *s, mt_arena *mem)
{
    const char **const name = mt_arena_alloc(mem, (size_t)s->n, sizeof *name);
    const int massive = s->modes + s->residual;
    for (int i = 0; name != NULL && i < s->n; i++) {
        const int k = i < massive ? i : i - massive;
        const char *const rate = i < massive ? "" : " rate";
        if (i < 2 * massive && k < s->modes) {
            name[i] = mt_arena_printf(mem, "mode %d%s", k + 1, rate);
        } else if (i < 2 * massive) {
            name[i] = mt_arena_printf(mem, "residual %d%s", k - s->modes + 1, rate);
        } else if (i < (2 * massive) + s->massless) {
            name[i] = mt_arena_printf(mem, "massless %d", i - (2 * massive) + 1);
        } else {
            const int of = i - (2 * massive) - s->massless;
            name[i] = mt_arena_printf(
                mem, "%s of %s", s->integral_order[of] == 1 ? "integral" : "second integral",
                r->ports.in[s->integral_of[of]].name);
        }
    }
    return name;
}

/* Rows of an m x n matrix, column-major. */
static mt_matrix_row *matrix_rows(double *values, int m, int n, mt_arena *mem)
{
    mt_matrix_row *const row = mt_arena_alloc(mem, (size_t)m, sizeof *row);
    for (int i = 0; row != NULL && i < m; i++) {
        row[i] = (mt_matrix_row){values + i, n, m};
    }
    return row;
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Largest difference of one pair over the frequencies compared, in parts of the response. */
static double difference_of(int n, const double *size, const double *off, double *work)
{
    int kept = 0;
    for (int i = 0; i < n; i++) {
        if (isfinite(size[i])) {
            work[kept++] = size[i];
        }
    }
    double most = kept == 0 ? nan("") : 0.0;
    if (kept > 0) {
        qsort(work, (size_t)kept, sizeof *work, by_size);
    }
    for (int i = 0; i < n && kept > 0; i++) {
        const double scale = fmax(size[i], work[kept / 2]);
        if (isfinite(size[i]) && scale > 0.0) {
            const double part = off[i] / scale;
            most = part <= most ? most : part; /* NaN stays */
        }
    }
    return most;
}

/* Against one factorisation of the matrices themselves at each frequency. */
static mt_status compare(mt_response *r, const mt_state_space *s, double from, double to,
                         mt_state_space_row *out, mt_err *err)
{
    const size_t pairs = (size_t)s->n_in * (size_t)s->n_out;
    const mt_arena_mark mark = mt_arena_get_mark(&r->mem);
    double complex *const want = mt_arena_alloc(&r->mem, pairs, sizeof *want);
    double complex *const have = mt_arena_alloc(&r->mem, pairs, sizeof *have);
    double *const size = mt_arena_f64(&r->mem, COMPARED, pairs);
    double *const off = mt_arena_f64(&r->mem, COMPARED, pairs);
    double *const work = mt_arena_f64(&r->mem, COMPARED, 1);
    MT_TRY(mt_arena_check(&r->mem, err));
    for (size_t i = 0; i < COMPARED; i++) {
        const double w = from * pow(to / from, (double)i / (COMPARED - 1));
        const mt_sample sample = {.h = want};
        MT_TRY(mt_transfer_at(&r->direct, w, &sample, &r->mem, err));
        MT_TRY(mt_state_space_at(s, w, have, &r->mem, err));
        for (size_t p = 0; p < pairs; p++) {
            size[i + (p * COMPARED)] = isfinite(creal(want[p])) ? cabs(want[p]) : HUGE_VAL;
            off[i + (p * COMPARED)] = cabs(want[p] - have[p]);
        }
    }
    out->compared = COMPARED;
    out->largest_difference_percent = 0.0;
    for (size_t p = 0; p < pairs; p++) {
        const double part =
            difference_of(COMPARED, size + (p * COMPARED), off + (p * COMPARED), work);
        if (!(100.0 * part <= out->largest_difference_percent)) {
            out->largest_difference_percent = 100.0 * part;
        }
    }
    mt_arena_rewind(&r->mem, mark);
    return MT_OK;
}

mt_status mt_state_space_row_of(mt_response *r, int modes, double from, double to,
                                mt_state_space_row *out, mt_err *err)
{
    mt_state_space s;
    MT_TRY(mt_response_state_space(r, modes, to, &s, err));
    *out = (mt_state_space_row){.modes = s.modes,
                                .residual_shapes = s.residual,
                                .states = state_names(r, &s, &r->mem),
                                .n_states = s.n,
                                .inputs = r->ports.in,
                                .n_inputs = s.n_in,
                                .outputs = r->ports.out,
                                .n_outputs = s.n_out,
                                .a = matrix_rows(s.a, s.n, s.n, &r->mem),
                                .b = matrix_rows(s.b, s.n, s.n_in, &r->mem),
                                .c = matrix_rows(s.c, s.n_out, s.n, &r->mem),
                                .d = matrix_rows(s.d, s.n_out, s.n_in, &r->mem),
                                .viscous_for_loss_factors = s.lossy,
                                .from_hz = from / TWO_PI,
                                .to_hz = to / TWO_PI};
    MT_TRY(mt_arena_check(&r->mem, err));
    return compare(r, &s, from, to, out, err);
}
