/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What the numbers of a configuration can be, and what they hardly are. A fault is what no
 * mechanism has (a mass below 0); a doubt is what is allowed, but what a slip of units makes:
 * millimetres for metres, MPa for Pa, t/mm^3 for kg/m^3. Limits are wide on purpose: a good
 * model is not warned of.
 */
#include "model/lint.h"

#include "model/lint_priv.h"

#include <math.h>
#include <stddef.h>

#include "base/format.h"
#include "model/values.h"

/* rad: more than one turn from the reference position is degrees, or a motor's shaft. */
static const double ONE_TURN = 6.283185307179586;

static double value_of_number(const mt_lint *j, mt_num num)
{
    return num == MT_ABSENT ? nan("") : j->value[num];
}

mt_warning *mt_lint_addr(mt_lint *j, mt_warning *warning, mt_addr addr, const char *pointer)
{
    if (warning == NULL) {
        return NULL;
    }
    warning->addr = addr;
    warning->pointer = pointer;
    warning->file = j->model->path;
    warning->configuration = j->model->configurations[j->configuration].name.s;
    if (!mt_model_locate(j->model, addr, &warning->line, &warning->column)) {
        warning->line = 0;
        warning->column = 0;
    }
    return warning;
}

static void locate_item_member(mt_lint *j, mt_warning *warning, const mt_item *item, mt_num num,
                               const char *member)
{
    const char *const pointer =
        mt_arena_printf(j->out->mem, "/%s/%d/%s", item->list, item->index, member);
    (void)mt_lint_addr(j, warning, j->model->nums[num].addr, pointer);
}

static void fault(mt_lint *j, const mt_item *item, mt_num num, const char *member,
                  const char *why)
{
    locate_item_member(j,
                       mt_warning_add(j->out, MT_LEVEL_FAULT, "value", "%s \"%s\": %s (%g) %s",
                                      item->what, item->name, member, j->value[num],
                                      why == NULL ? "" : why),
                       item, num, member);
}

/* A gear that passes nothing on. */
static void nonzero(mt_lint *j, const mt_item *item, mt_num num, const char *member)
{
    if (num != MT_ABSENT && j->value[num] == 0.0) {
        fault(j, item, num, member,
              "must not be 0: the joints would have nothing to do with "
              "each other");
    }
}

/* By the row that the member's table names. Returns false where it is impossible. */
static bool lint_item_number(mt_lint *j, const mt_item *item, mt_num num, const char *member)
{
    if (num == MT_ABSENT) {
        return true;
    }
    const mt_possible *const p = &mt_possible_of[j->model->nums[num].possible];
    const double v = j->value[num];
    if (!mt_possible_is(p, v)) {
        fault(j, item, num, member, p->impossible);
        return false;
    }
    const char *const doubted = mt_possible_doubted(p, v);
    if (doubted != NULL) {
        locate_item_member(j,
                           mt_warning_add(j->out, MT_LEVEL_WARNING, p->warning,
                                          "%s \"%s\": %s (%g) is %s", item->what, item->name,
                                          member, v, doubted),
                           item, num, member);
    }
    return true;
}

static void inertia(mt_lint *j, const mt_item *item, const mt_body *b)
{
    static const char *const members[] = {"inertia_kg_m2/0", "inertia_kg_m2/1",
                                          "inertia_kg_m2/2"};
    const bool plane = j->model->dimension == 2;
    double v[6];
    bool possible = true;
    for (int k = 0; k < (plane ? 1 : 3); k++) {
        possible =
            lint_item_number(j, item, b->inertia[k], plane ? "inertia_kg_m2" : members[k]) &&
            possible;
    }
    for (int k = 0; k < 6 && !plane; k++) {
        v[k] = b->inertia[k] == MT_ABSENT ? 0.0 : j->value[b->inertia[k]];
    }
    if (plane || !possible) {
        return;
    }
    int at = 0;
    const char *const why = mt_lint_tensor(j, v, &at);
    if (why != NULL) {
        fault(j, item, b->inertia[at], members[at], why);
    }
}

static void lint_bodies(mt_lint *j)
{
    for (int i = 0; i < j->model->n_bodies; i++) {
        const mt_body *const b = &j->model->bodies[i];
        const mt_item item = {"body", "bodies", i, b->name.s};
        if (mt_model_present(&b->in, j->configuration)) {
            (void)lint_item_number(j, &item, b->mass, "mass_kg");
            if (!b->point_mass) {
                inertia(j, &item, b);
            }
        }
    }
}

static void listed(mt_lint *j, const mt_item *item, int n, const mt_num *list,
                   const char *member)
{
    for (int k = 0; k < n; k++) {
        char entry[64]; /* a list of one may be written as a number */
        (void)mt_snprintf(entry, sizeof entry, n > 1 ? "%s/%d" : "%s", member, k);
        (void)lint_item_number(j, item, list[k], entry);
    }
}

static void lint_section(mt_lint *j, const mt_item *item, const mt_section *s)
{
    const bool tube = s->shape == MT_SECTION_TUBE;
    const char *const outer = tube ? "section/outer_diameter_m" : "section/diameter_m";
    (void)lint_item_number(j, item, s->width, "section/width_m");
    (void)lint_item_number(j, item, s->height, "section/height_m");
    (void)lint_item_number(j, item, s->diameter, outer);
    (void)lint_item_number(j, item, s->inner_diameter, "section/inner_diameter_m");
    if (tube && value_of_number(j, s->inner_diameter) >= value_of_number(j, s->diameter)) {
        fault(j, item, s->inner_diameter, "section/inner_diameter_m",
              mt_arena_printf(j->out->mem,
                              "must be below outer_diameter_m (%g): the wall has no thickness",
                              value_of_number(j, s->diameter)));
    }
    (void)lint_item_number(j, item, s->area, "section/area_m2");
    (void)lint_item_number(j, item, s->second_moment, "section/second_moment_m4");
    (void)lint_item_number(j, item, s->second_moment_other, "section/second_moment_other_m4");
    (void)lint_item_number(j, item, s->torsion_constant, "section/torsion_constant_m4");
}

static void lint_shear(mt_lint *j, const mt_item *item, const mt_shear *s)
{
    (void)lint_item_number(j, item, s->coefficient, "shear/coefficient");
    (void)lint_item_number(j, item, s->coefficient_other, "shear/coefficient_other");
    (void)lint_item_number(j, item, s->poissons_ratio, "shear/poissons_ratio");
}

static void lint_links(mt_lint *j)
{
    for (int i = 0; i < j->model->n_links; i++) {
        const mt_link *const l = &j->model->links[i];
        const mt_item item = {"link", "links", i, l->name.s};
        if (!mt_model_present(&l->in, j->configuration)) {
            continue;
        }
        (void)lint_item_number(j, &item, l->mass, "mass_kg");
        (void)lint_item_number(j, &item, l->density, "density_kg_per_m3");
        (void)lint_item_number(j, &item, l->youngs_modulus, "youngs_modulus_pa");
        (void)lint_item_number(j, &item, l->shear_modulus, "shear_modulus_pa");
        lint_section(j, &item, &l->section);
        lint_shear(j, &item, &l->shear);
        listed(j, &item, l->n_stiffness, l->stiffness, "stiffness_n_m_per_rad");
        listed(j, &item, l->n_element_length, l->element_length, "element_length_m");
        listed(j, &item, l->n_element_mass, l->element_mass, "element_mass_kg");
        listed(j, &item, l->n_element_inertia, l->element_inertia, "element_inertia_kg_m2");
        (void)lint_item_number(j, &item, l->radius_of_gyration, "radius_of_gyration_m");
        (void)lint_item_number(j, &item, l->loss_factor, "loss_factor");
    }
}

/* A constant of a spring may be negative (a spring over its dead centre, a magnet, a load that
 * buckles); a bar is a piece of material. */
static void lint_springs(mt_lint *j)
{
    int dampers = 0;
    for (int i = 0; i < j->model->n_springs; i++) {
        const mt_spring *const s = &j->model->springs[i];
        const mt_item item = {s->damper ? "damper" : "spring",
                              s->damper ? "dampers" : "springs", s->damper ? dampers++ : i,
                              s->name.s};
        if (!mt_model_present(&s->in, j->configuration)) {
            continue;
        }
        (void)lint_item_number(j, &item, s->youngs_modulus, "youngs_modulus_pa");
        (void)lint_item_number(j, &item, s->area, "area_m2"); /* 0: a bar that may be added */
        (void)lint_item_number(j, &item, s->density, "density_kg_per_m3");
        (void)lint_item_number(j, &item, s->free_length, "free_length_m");
        (void)lint_item_number(j, &item, s->loss_factor, "loss_factor");
    }
}

static void lint_sensors(mt_lint *j)
{
    for (int i = 0; i < j->model->n_sensors; i++) {
        const mt_sensor *const s = &j->model->sensors[i];
        const mt_item item = {"sensor", "sensors", i, s->name.s};
        (void)lint_item_number(j, &item, s->fraction, "fraction");
    }
}

static void lint_joints(mt_lint *j)
{
    for (int i = 0; i < j->model->n_joints; i++) {
        const mt_joint *const joint = &j->model->joints[i];
        const mt_item item = {"joint", "joints", i, joint->name.s};
        if (mt_model_present(&joint->in, j->configuration)) {
            (void)lint_item_number(j, &item, joint->length, "length_m");
            (void)lint_item_number(j, &item, joint->mass, "mass_kg");
            nonzero(j, &item, joint->ratio, "ratio");
            nonzero(j, &item, joint->ratio_m_per_rad, "ratio_m_per_rad");
        }
    }
}

const char *mt_lint_drive_pointer(const mt_lint *j, const char *member)
{
    const mt_configuration *c = &j->model->configurations[j->configuration];
    while (c->drive.inherited && c->like != MT_ABSENT) {
        c = &j->model->configurations[c->like];
    }
    return mt_arena_printf(j->out->mem, "/configurations/%s/drive/%s", c->name.s, member);
}

static void lint_drive(mt_lint *j)
{
    const mt_configuration *const c = &j->model->configurations[j->configuration];
    const double v = c->drive.given ? value_of_number(j, c->drive.position) : 0.0;
    if (!c->drive.position_is_angle || !(fabs(v) > ONE_TURN)) {
        return;
    }
    if (fabs(v) > MT_DRIVE_REACH) {
        (void)mt_lint_addr(
            j,
            mt_warning_add(j->out, MT_LEVEL_FAULT, "drive",
                           "\"%s\" is driven by %g rad: at most %d rad can be",
                           c->drive.joint_name.s == NULL ? "" : c->drive.joint_name.s, v,
                           (int)MT_DRIVE_REACH),
            j->model->nums[c->drive.position].addr, mt_lint_drive_pointer(j, "position_rad"));
        return;
    }
    (void)mt_lint_addr(
        j,
        mt_warning_add(j->out, MT_LEVEL_WARNING, "drive",
                       "\"%s\" is driven by %g rad, more than a turn: degrees are written "
                       "\"%g*deg\"",
                       c->drive.joint_name.s == NULL ? "" : c->drive.joint_name.s, v, v),
        j->model->nums[c->drive.position].addr, mt_lint_drive_pointer(j, "position_rad"));
}

void mt_model_lint(const mt_model *model, int configuration, const double *value,
                   mt_warning_list *out)
{
    mt_lint j = {.model = model, .configuration = configuration, .value = value, .out = out};
    const int first = out->n;
    lint_bodies(&j);
    lint_links(&j);
    lint_springs(&j);
    lint_joints(&j);
    lint_sensors(&j);
    lint_drive(&j);
    mt_lint_damping(&j);
    mt_lint_inherited(&j);
    mt_lint_structure(&j);
    mt_lint_angles(&j);
    mt_lint_units(&j);
    mt_lint_geometry(&j);
    mt_warning_accept(out, first, &model->accepted);
}

mt_status mt_model_admit(const mt_model *model, int configuration, int n_inputs,
                         const int *inputs, const double *at, mt_arena *mem, mt_err *err)
{
    mt_numbers numbers;
    MT_TRY(mt_numbers_new(model, configuration, n_inputs, inputs, model->n_nums, model->nums,
                          mem, &numbers, err));
    return mt_model_admit_numbers(model, configuration, &numbers, at, mem, err);
}

mt_status mt_model_admit_numbers(const mt_model *model, int configuration,
                                 const mt_numbers *numbers, const double *at, mt_arena *mem,
                                 mt_err *err)
{
    double *const value = mt_arena_f64(mem, (size_t)model->n_nums, 1);
    mt_warning_list list = mt_warning_list_default(mem);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_numbers_at(numbers, at, value, NULL, err));
    mt_model_lint(model, configuration, value, &list);
    for (int i = 0; i < list.n; i++) {
        if (list.items[i].level == MT_LEVEL_FAULT) {
            return mt_fail(err, MT_E_USAGE, "%s", list.items[i].text);
        }
    }
    return mt_arena_check(mem, err);
}
