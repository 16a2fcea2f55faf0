/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Goals of type "avoid": rotors looked up in the catalogue, numbers checked, bands made. */
#include "study/study_priv.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "environment/rotor.h"

static void check_intervals(mt_study_check *c, const mt_bands_source *source)
{
    for (int i = 0; i < source->n_intervals; i++) {
        const mt_band_hz *const band = &source->intervals[i];
        if (band->lower_hz >= band->upper_hz) {
            mt_diag_error(c->diags, band->addr, "the band's end (%g Hz) is not above %g Hz",
                          band->upper_hz, band->lower_hz);
        }
    }
}

/* Warn, also in the result, that an unconfirmed value is used. */
static void warn_unconfirmed(mt_study_check *c, const mt_rotor *rotor,
                             const mt_aircraft *aircraft)
{
    mt_rotor_warning warning_list[MT_ROTOR_WARNINGS];
    const int n = mt_rotor_warnings(rotor, aircraft, warning_list);
    for (int i = 0; i < n; i++) {
        const mt_rotor_warning *const d = &warning_list[i];
        mt_diag_warning(c->diags, rotor->aircraft.addr, "%s: the %s (%s) is unconfirmed",
                        rotor->aircraft.s, d->what, d->value->text);
        mt_check_warn_result(
            c, mt_arena_printf(&c->study->mem,
                               "%s: the %s (%s) is unconfirmed (source needed: %s)",
                               rotor->aircraft.s, d->what, d->value->text, d->value->source));
    }
}

static void check_rotor(mt_study_check *c, const mt_avoid *avoid, mt_rotor *rotor)
{
    const mt_aircraft *const aircraft = mt_check_aircraft(c, rotor->aircraft);
    if (aircraft != NULL) {
        mt_rotor_take(rotor, aircraft);
        warn_unconfirmed(c, rotor, aircraft);
    }
    if (aircraft != NULL || rotor->aircraft.addr == rotor->addr) {
        /* else the aircraft is wrong, which says enough */
        mt_rotor_check_harmonics(rotor, aircraft, c->diags);
    }
    mt_rotor_check_range(rotor, c->diags);
    const double margin =
        MT_HAS(rotor->margin_percent) ? rotor->margin_percent : avoid->source.margin_percent;
    if (rotor->range_lower == rotor->range_upper && !(margin > 0.0)) {
        mt_diag_error(c->diags, rotor->addr,
                      "the bands have no width: give \"speed_range\" or \"margin_percent\"");
    }
}

static void check_orders(mt_study_check *c, const mt_order *orders, int n)
{
    if (n > 0 && mt_rotor_too_many(c->diags, n, orders[0].addr, "orders")) {
        return;
    }
    for (int i = 1; i < n; i++) {
        for (int k = 0; k < i; k++) {
            if (orders[k].thousandths == orders[i].thousandths) {
                mt_diag_error(c->diags, orders[i].addr, "order \"%s\" is given twice",
                              orders[i].text);
                break;
            }
        }
    }
}

static void check_gear(mt_study_check *c, const mt_gear *gear)
{
    double least = 1.0;
    check_orders(c, gear->orders, gear->n_orders);
    for (int i = 0; i < gear->n_orders; i++) {
        const double times = (double)gear->orders[i].thousandths / 1000.0;
        least = i == 0 ? times : fmin(least, times);
    }
    if (gear->teeth > 0 && !(least * gear->teeth > gear->sidebands)) {
        mt_diag_error(c->diags, mt_diag_member(c->diags, gear->addr, "sidebands"),
                      "sideband %d of a mesh of %g per turn does not lie above 0 Hz",
                      gear->sidebands, least * gear->teeth);
    }
}

static void check_machine(mt_study_check *c, const mt_avoid *avoid, const mt_machine *machine)
{
    const double lower = mt_machine_speed_hz(machine, 0);
    const double upper = mt_machine_speed_hz(machine, 1);
    if (!(machine->speed_hz <= 0.0) && lower > upper) {
        mt_diag_error(c->diags, mt_machine_range_addr(machine, c->diags),
                      "the range of speeds (%g to %g Hz) must be ascending", lower, upper);
    }
    check_orders(c, machine->orders, machine->n_orders);
    for (int i = 0; i < machine->n_gears; i++) {
        check_gear(c, &machine->gears[i]);
    }
    if (lower == upper && !(mt_bands_margin(&avoid->source, machine->margin_percent) > 0.0)) {
        mt_diag_error(c->diags, machine->addr,
                      "the bands have no width: give a range of speeds or \"margin_percent\"");
    }
}

/* True where the rotor's speed is known. A catalogue that could not be read (noted) leaves
 * rotors without a speed. */
static bool has_rotor_speeds(const mt_bands_source *source)
{
    for (int i = 0; i < source->n_rotors; i++) {
        if (!MT_HAS(source->rotors[i].speed_hz)) {
            return false;
        }
    }
    return true;
}

static void make_bands(mt_study_check *c, const mt_goal *goal)
{
    mt_avoid *const avoid = goal->avoid;
    mt_study *const s = c->study;
    if (mt_bands_make(&avoid->source, nan(""), &s->mem, &avoid->bands, NULL) != MT_OK) {
        return; /* as the arena knows */
    }
    if (avoid->bands.n == 0) {
        mt_diag_error(c->diags, mt_diag_member(c->diags, goal->addr, "up_to_hz"),
                      "no band lies below up_to_hz (%g)", avoid->source.up_to_hz);
    }
    for (int i = 0; i < avoid->bands.n_notes; i++) {
        mt_check_warn_result(c, mt_arena_printf(&s->mem, "/goals/%d: %s",
                                                (int)(goal - s->goals), avoid->bands.notes[i]));
    }
}

/* Warn where the name is that of a body of the model: its modes are those of the mechanism at
 * rest. */
static void warn_spin(mt_study_check *c, const mt_goal *goal, const char *name)
{
    const mt_model *const model = c->study->model;
    for (int i = 0; name != NULL && i < model->n_bodies; i++) {
        if (strcmp(model->bodies[i].name.s, name) == 0) {
            mt_check_warn_result(
                c, mt_arena_printf(&c->study->mem,
                                   "/goals/%d: body \"%s\" turns, and the modes are those of "
                                   "the mechanism at rest: without the gyroscopic and "
                                   "centrifugal terms of what spins",
                                   (int)(goal - c->study->goals), model->bodies[i].name.s));
            return;
        }
    }
}

static void warn_spins(mt_study_check *c, const mt_goal *goal)
{
    const mt_bands_source *const source = &goal->avoid->source;
    for (int i = 0; i < source->n_rotors; i++) {
        warn_spin(c, goal, source->rotors[i].name);
    }
    for (int i = 0; i < source->n_machines; i++) {
        const mt_machine *const m = &source->machines[i];
        warn_spin(c, goal, m->name);
        for (int k = 0; k < m->n_gears; k++) {
            warn_spin(c, goal, m->gears[k].name);
        }
    }
}

void mt_study_check_avoid(mt_study_check *c, mt_goal *goal)
{
    mt_avoid *const avoid = goal->avoid;
    if (avoid == NULL) {
        mt_diag_error(c->diags, goal->addr, "the goal names no bands");
        return;
    }
    check_intervals(c, &avoid->source);
    /* several rotors or machines without a name are told apart by number */
    for (int i = 0; i < avoid->source.n_rotors; i++) {
        mt_rotor *const rotor = &avoid->source.rotors[i];
        if (avoid->source.n_rotors > 1 && rotor->name == NULL && rotor->aircraft.s == NULL) {
            rotor->name = mt_arena_printf(&c->study->mem, "rotor %d", i + 1);
        }
        check_rotor(c, avoid, rotor);
    }
    for (int i = 0; i < avoid->source.n_machines; i++) {
        mt_machine *const machine = &avoid->source.machines[i];
        if (avoid->source.n_machines > 1 && machine->name == NULL) {
            machine->name = mt_arena_printf(&c->study->mem, "machine %d", i + 1);
        }
        check_machine(c, avoid, machine);
    }
    if (c->diags->errors == 0 && has_rotor_speeds(&avoid->source)) {
        make_bands(c, goal);
        warn_spins(c, goal);
    }
}
