/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What pushes, what is seen and what damps locally, each as a force in the coordinates of the
 * search for modes. */
#include "response/large_priv.h"

#include <string.h>

#include "base/format.h"

/* What damps locally is a force of its own: with more of them a dense way costs less. */
enum { MOST_SIDES = 24 };
/* Rows of a term. */
enum { MOST_ROWS = 16 };

typedef mt_large_force force;
typedef mt_large_side side;
typedef mt_large_work work;

bool mt_large_refuse(mt_large_work *k, const char *why)
{
    (void)mt_snprintf(k->why, MT_LARGE_WHY, "%s", why);
    return false;
}

double mt_large_value(const mt_large_work *k, mt_node node)
{
    return creal(mt_data_scalar(&k->d, node, 0.0));
}

static mt_status new_force(const work *k, force *f, mt_err *err)
{
    mt_lowest_push_init(k->l, k->scratch, &f->push);
    return mt_arena_check(k->scratch, err);
}

/* k->states += factor times a row over the freedoms of a term's bodies. */
static void add_term_row(work *k, const mt_term *t, const mt_cx *row, double factor)
{
    for (int i = 0; i < MT_LOCAL; i++) {
        const int q = mt_local_dof(k->l->sys, t->body, i);
        if (q >= 0) {
            k->states[q] += factor * creal(row[i]);
        }
    }
}

static void clear(work *k)
{
    memset(k->states, 0, (size_t)k->l->sys->nq * sizeof *k->states);
}

void mt_large_sensor_row(mt_large_work *k, int channel)
{
    const mt_term *const t = &k->list[MT_TERM_CHANNEL].terms[channel];
    mt_cx row[MT_LOCAL];
    mt_term_rows(&k->d, MT_TERM_CHANNEL, t, k->at.pose, row);
    clear(k);
    add_term_row(k, t, row, 1.0);
}

static mt_status open_inputs(work *k, mt_err *err)
{
    k->in = mt_arena_alloc(k->scratch, (size_t)k->ports->n_in, sizeof *k->in);
    MT_TRY(mt_arena_check(k->scratch, err));
    for (int i = 0; i < k->ports->n_in; i++) {
        const mt_port *const port = &k->ports->in[i];
        MT_TRY(new_force(k, &k->in[i], err));
        if (port->kind == MT_PORT_BASE) {
            MT_TRY(mt_lowest_base(k->l, port->index, &k->in[i].push, err));
        } else {
            mt_large_sensor_row(k, port->index);
            MT_TRY(mt_lowest_force(k->l, k->states, &k->in[i].push, err));
        }
    }
    return MT_OK;
}

int mt_large_power(const mt_port *out)
{
    return out->kind == MT_PORT_SENSOR ? out->motion : out->kind == MT_PORT_DAMPER ? 1 : 0;
}

/* The force in a spring or damper, in k->states; *one: all of it has one loss factor, *loss. */
static void force_row(work *k, const mt_port *port, bool *one, double *loss)
{
    const mt_term_kind kind =
        port->kind == MT_PORT_DAMPER ? MT_TERM_DAMPING : MT_TERM_STIFFNESS;
    mt_cx rows[MOST_ROWS * MT_LOCAL];
    mt_force_part part[MT_FORCE_PARTS];
    const int n = mt_response_force_among(k->l->sys, &k->list[kind], port, part);
    *one = true;
    clear(k);
    for (int i = 0; i < n; i++) {
        const mt_term *const t = part[i].term;
        const double lost = kind == MT_TERM_DAMPING ? 0.0 : mt_large_value(k, t->loss);
        *one = *one && t->count <= MOST_ROWS && (i == 0 || lost == *loss);
        if (*one) {
            *loss = lost;
            mt_term_rows(&k->d, kind, t, k->at.pose, rows);
            add_term_row(k, t, rows + ((ptrdiff_t)(part[i].row - t->first) * MT_LOCAL),
                         part[i].share * mt_large_value(k, t->coefficient));
        }
    }
}

static mt_status open_outputs(work *k, bool *is, mt_err *err)
{
    k->outs = mt_arena_alloc(k->scratch, (size_t)k->ports->n_out, sizeof *k->outs);
    MT_TRY(mt_arena_check(k->scratch, err));
    for (int o = 0; o < k->ports->n_out; o++) {
        const mt_port *const port = &k->ports->out[o];
        bool one = true;
        MT_TRY(new_force(k, &k->outs[o], err));
        if (port->kind == MT_PORT_JOINT) {
            *is = mt_large_refuse(k, "forces in joints need all modes");
            return MT_OK;
        }
        if (port->kind == MT_PORT_SENSOR) {
            mt_large_sensor_row(k, port->index);
        } else {
            force_row(k, port, &one, &k->outs[o].loss);
        }
        if (!one) {
            *is = mt_large_refuse(k, "the force of a spring with several loss factors needs "
                                     "all modes");
            return MT_OK;
        }
        MT_TRY(mt_lowest_force(k->l, k->states, &k->outs[o].push, err));
    }
    return MT_OK;
}

/* Adds one damping row. */
static mt_status add_side(work *k, const mt_term *t, const mt_cx *row, double damping,
                          double structural, int partner, mt_err *err)
{
    side *const s = &k->sides[k->n_sides];
    *s = (side){.damping = damping, .structural = structural, .partner = k->n_sides + partner};
    MT_TRY(new_force(k, &s->f, err));
    clear(k);
    add_term_row(k, t, row, 1.0);
    MT_TRY(mt_lowest_force(k->l, k->states, &s->f.push, err));
    k->n_sides++;
    return MT_OK;
}

/* Rows of all terms of a kind that damp more than all springs alike. */
static mt_status add_terms(work *k, mt_term_kind kind, bool *is, mt_err *err)
{
    mt_cx rows[MOST_ROWS * MT_LOCAL];
    for (int i = 0; i < k->list[kind].n_terms && *is; i++) {
        const mt_term *const t = &k->list[kind].terms[i];
        const double c = mt_large_value(k, t->coefficient);
        const double by =
            kind == MT_TERM_DAMPING ? c : c * (mt_large_value(k, t->loss) - k->loss);
        if (by == 0.0) {
            continue;
        }
        if (k->n_sides + t->count > MOST_SIDES || t->count > MOST_ROWS) {
            *is = mt_large_refuse(
                k, "so many springs and dampers that damp each in its own way need "
                   "all modes");
            return MT_OK;
        }
        mt_term_rows(&k->d, kind, t, k->at.pose, rows);
        for (int r = 0; r < t->count; r++) {
            const double part = t->pair ? 0.5 * by : by;
            MT_TRY(add_side(
                k, t, rows + ((ptrdiff_t)r * MT_LOCAL), kind == MT_TERM_DAMPING ? part : 0.0,
                kind == MT_TERM_DAMPING ? 0.0 : part, t->pair ? 1 - (2 * r) : 0, err));
        }
    }
    return MT_OK;
}

/* The loss factor that most springs have. */
static double common_loss(const work *k)
{
    const mt_term_list *const list = &k->list[MT_TERM_STIFFNESS];
    double most = 0.0;
    int votes = 0;
    for (int i = 0; i < list->n_terms; i++) { /* Boyer and Moore's vote */
        const double own = mt_large_value(k, list->terms[i].loss);
        most = votes == 0 ? own : most;
        votes += own == most ? 1 : -1;
    }
    return most;
}

static mt_status open_sides(work *k, bool *is, mt_err *err)
{
    const mt_damping_def *const d = &k->l->sys->damping;
    k->alpha = mt_large_value(k, d->mass);
    k->beta = mt_large_value(k, d->stiffness);
    k->loss = common_loss(k);
    k->sides = mt_arena_alloc(k->scratch, MOST_SIDES, sizeof *k->sides);
    MT_TRY(mt_arena_check(k->scratch, err));
    if (k->loss != 0.0 && k->l->sys->loaded) {
        *is = mt_large_refuse(k, "loss factors under a load need all modes");
    } else if (d->n_named > 0) {
        *is = mt_large_refuse(k, "damping ratios of named modes need all modes");
    }
    if (*is) {
        MT_TRY(add_terms(k, MT_TERM_DAMPING, is, err));
    }
    return *is ? add_terms(k, MT_TERM_STIFFNESS, is, err) : MT_OK;
}

mt_status mt_large_forces(mt_large_work *k, bool *is, mt_err *err)
{
    MT_TRY(mt_terms_new(k->l->sys, k->scratch, k->list, err));
    MT_TRY(mt_absolute_stand(k->l->sys, mt_lowest_settled(k->l), k->l->at, &k->d, &k->at,
                             k->scratch, err));
    MT_TRY(open_inputs(k, err));
    MT_TRY(open_outputs(k, is, err));
    return *is ? open_sides(k, is, err) : MT_OK;
}
