/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What turns, and how often per turn it excites: the lines of a Campbell diagram, one per rotor
 * and machine of an avoid goal. */
#include <string.h>

#include "describe/describe.h"

static mt_status put_rotor(const mt_rotor *rotor, mt_arena *mem, mt_result_excitation *e,
                           mt_err *err)
{
    const char *const name = rotor->name != NULL         ? rotor->name
                             : rotor->aircraft.s != NULL ? rotor->aircraft.s
                                                         : "rotor";
    e->name = mt_arena_strdup(mem, name);
    e->speed_lower_hz = rotor->speed_hz * rotor->range_lower;
    e->speed_upper_hz = rotor->speed_hz * rotor->range_upper;
    e->orders = mt_arena_alloc(mem, (size_t)rotor->n_harmonics, sizeof *e->orders);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < rotor->n_harmonics; i++) {
        const double order =
            mt_rotor_harmonic_hz(rotor, &rotor->harmonics[i]) / rotor->speed_hz;
        if (order > 0.0) {
            e->orders[e->n_orders++] = (mt_result_order){
                .label = mt_arena_strdup(mem, rotor->harmonics[i].text), .order = order};
        }
    }
    return mt_arena_check(mem, err);
}

static mt_status put_machine(const mt_machine *machine, mt_arena *mem, mt_result_excitation *e,
                             mt_err *err)
{
    const int n = mt_machine_line_count(machine);
    const char *const name = machine->name != NULL ? machine->name : "machine";
    mt_order_line *const lines = mt_arena_alloc(mem, (size_t)n, sizeof *lines);
    e->name = mt_arena_strdup(mem, name);
    e->speed_lower_hz = mt_machine_speed_hz(machine, 0);
    e->speed_upper_hz = mt_machine_speed_hz(machine, 1);
    e->orders = mt_arena_alloc(mem, (size_t)n, sizeof *e->orders);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_machine_lines(machine, mem, lines, err));
    e->n_orders = n;
    for (int i = 0; i < n; i++) {
        const bool own = strcmp(lines[i].of, name) == 0;
        e->orders[i] = (mt_result_order){
            .label = own ? mt_arena_strdup(mem, lines[i].what)
                         : mt_arena_printf(mem, "%s of %s", lines[i].what, lines[i].of),
            .order = lines[i].order};
    }
    return mt_arena_check(mem, err);
}

static mt_status describe_goal(const mt_study *study, int goal, mt_result *result, mt_err *err)
{
    const mt_goal *const g = &study->goals[goal];
    const mt_bands_source *const source = &g->avoid->source;
    mt_arena *const mem = &result->mem;
    for (int i = 0; i < source->n_rotors + source->n_machines; i++) {
        const bool machine = i >= source->n_rotors;
        mt_result_excitation *const e = &result->excitations[result->n_excitations];
        const mt_rotor *const rotor = machine ? NULL : &source->rotors[i];
        const mt_machine *const m = machine ? &source->machines[i - source->n_rotors] : NULL;
        *e = (mt_result_excitation){
            .pointer = mt_arena_printf(mem, "/goals/%d", goal),
            .up_to_hz = source->up_to_hz,
            .configurations = mt_arena_alloc(mem, (size_t)g->n_configurations, sizeof(char *))};
        MT_TRY(mt_arena_check(mem, err));
        for (int k = 0; k < g->n_configurations; k++) {
            const char *const name = study->model->configurations[g->configurations[k]].name.s;
            e->configurations[e->n_configurations++] = mt_arena_strdup(mem, name);
        }
        e->margin_percent =
            mt_bands_margin(source, machine ? m->margin_percent : rotor->margin_percent);
        MT_TRY(machine ? put_machine(m, mem, e, err) : put_rotor(rotor, mem, e, err));
        result->n_excitations++;
    }
    return MT_OK;
}

mt_status mt_describe_excitations(const mt_study *study, mt_result *result, mt_err *err)
{
    size_t most = 0;
    for (int i = 0; i < study->n_goals; i++) {
        const mt_avoid *const avoid = study->goals[i].avoid;
        most += avoid == NULL ? 0 : (size_t)avoid->source.n_rotors;
        most += avoid == NULL ? 0 : (size_t)avoid->source.n_machines;
    }
    result->excitations = mt_arena_alloc(&result->mem, most, sizeof *result->excitations);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int i = 0; i < study->n_goals; i++) {
        if (study->goals[i].avoid != NULL) {
            MT_TRY(describe_goal(study, i, result, err));
        }
    }
    return MT_OK;
}
