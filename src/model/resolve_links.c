/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Flexible links: which members a kind and a section need, and the lengths of lists. */
#include "model/resolve_priv.h"

/* Check that a member was given where it is required, and absent where it is forbidden. */
static void wants(mt_resolve *f, const mt_link *l, bool given, bool wanted, const char *member,
                  const char *why)
{
    if (given == wanted) {
        return;
    }
    mt_diag_error(f->d, l->name.addr, "link \"%s\": %s %s \"%s\"", l->name.s, why,
                  wanted ? "needs" : "has no", member);
}

static void check_section(mt_resolve *f, const mt_link *l)
{
    const mt_section *const s = &l->section;
    const struct {
        const char *member;
        mt_num num;
        unsigned shapes; /* that need it: bits of mt_section_shape */
    } members[] = {
        {"width_m", s->width, 1U << MT_SECTION_RECTANGLE},
        {"height_m", s->height, 1U << MT_SECTION_RECTANGLE},
        {"diameter_m", s->shape == MT_SECTION_TUBE ? MT_ABSENT : s->diameter,
         1U << MT_SECTION_CIRCLE},
        {"outer_diameter_m", s->shape == MT_SECTION_TUBE ? s->diameter : MT_ABSENT,
         1U << MT_SECTION_TUBE},
        {"inner_diameter_m", s->inner_diameter, 1U << MT_SECTION_TUBE},
        {"area_m2", s->area, 1U << MT_SECTION_GENERAL},
        {"second_moment_m4", s->second_moment, 1U << MT_SECTION_GENERAL},
    };
    static const char *const shapes[] = {"none", "rectangle", "circle", "tube", "general"};
    if (s->shape == MT_SECTION_NONE) {
        return;
    }
    for (int i = 0; i < MT_COUNT(members); i++) {
        const bool wanted = ((members[i].shapes >> s->shape) & 1U) != 0;
        if (wanted != (members[i].num != MT_ABSENT)) {
            mt_diag_error(f->d, s->addr, "a section of shape \"%s\" %s \"%s\"",
                          shapes[s->shape], wanted ? "needs" : "has no", members[i].member);
        }
    }
    const bool general = s->shape == MT_SECTION_GENERAL;
    const bool spatial_beam = general && f->m->dimension == 3 && l->kind == MT_LINK_BEAM;
    const mt_num spatial[] = {s->second_moment_other, s->torsion_constant};
    static const char *const names[] = {"second_moment_other_m4", "torsion_constant_m4"};
    for (int i = 0; i < MT_COUNT(spatial); i++) {
        if (!general && spatial[i] != MT_ABSENT) {
            mt_diag_error(f->d, s->addr, "a section of shape \"%s\" has no \"%s\"",
                          shapes[s->shape], names[i]);
        } else if (spatial_beam && spatial[i] == MT_ABSENT) {
            mt_diag_error(f->d, s->addr,
                          "the general section of a beam in three dimensions needs \"%s\"",
                          names[i]);
        }
    }
}

static void check_list(mt_resolve *f, const mt_link *l, int count, int wanted,
                       const mt_num *list, const char *member, const char *one_per)
{
    if (count > 1 && count != wanted) {
        const mt_addr addr = mt_resolve_addr(f->m, list[0]);
        mt_diag_error(f->d, addr == MT_NO_ADDR ? l->name.addr : addr,
                      "link \"%s\": \"%s\" has %d entries; one per %s are %d", l->name.s,
                      member, count, one_per, wanted);
    }
}

/* Exactly one source of the mass: the whole link's, the elements', or density with a
 * section. */
static void check_mass(mt_resolve *f, const mt_link *l)
{
    const int ways =
        (l->mass != MT_ABSENT) + (l->density != MT_ABSENT) + (l->n_element_mass > 0);
    if (ways != 1) {
        mt_diag_error(f->d, l->name.addr,
                      "link \"%s\": give its mass in one way: \"mass_kg\", "
                      "%s\"density_kg_per_m3\" with a section%s",
                      l->name.s, l->kind == MT_LINK_BEAM ? "or " : "",
                      l->kind == MT_LINK_BEAM ? "" : ", or \"element_mass_kg\"");
    } else if (l->density != MT_ABSENT && l->section.shape == MT_SECTION_NONE) {
        wants(f, l, false, true, "section", "a mass by density");
    }
}

/* The shear modulus is required of every beam in space, and in the plane with shear; it is
 * given in one way only. */
static void check_shear(mt_resolve *f, const mt_link *l)
{
    const bool ratio = l->shear.poissons_ratio != MT_ABSENT;
    const bool modulus = l->shear_modulus != MT_ABSENT;
    if (l->shear.given && ratio == modulus) {
        mt_diag_error(
            f->d, l->shear.addr,
            "link \"%s\": give its shear modulus in one way: \"shear_modulus_pa\", or "
            "\"poissons_ratio\" in \"shear\"",
            l->name.s);
    } else if (!l->shear.given && f->m->dimension == 3) {
        wants(f, l, modulus, true, "shear_modulus_pa", "a beam in three dimensions");
    } else if (!l->shear.given) {
        wants(f, l, modulus, false, "shear_modulus_pa",
              "a link in two dimensions without \"shear\"");
    }
    if (f->m->dimension == 2) {
        wants(f, l, l->shear.coefficient_other != MT_ABSENT, false, "shear/coefficient_other",
              "a link in two dimensions");
    }
}

static void check_beam(mt_resolve *f, const mt_link *l)
{
    static const char beam[] = "a link of kind \"beam\"";
    wants(f, l, l->youngs_modulus != MT_ABSENT, true, "youngs_modulus_pa", beam);
    wants(f, l, l->section.shape != MT_SECTION_NONE, true, "section", beam);
    wants(f, l, l->n_stiffness > 0, false, "stiffness_n_m_per_rad", beam);
    wants(f, l, l->n_element_length > 0, false, "element_length_m", beam);
    wants(f, l, l->n_element_mass > 0, false, "element_mass_kg", beam);
    wants(f, l, l->n_element_inertia > 0, false, "element_inertia_kg_m2", beam);
    wants(f, l, l->radius_of_gyration != MT_ABSENT, false, "radius_of_gyration_m", beam);
    check_shear(f, l);
    if (f->m->dimension == 3) {
        const bool round =
            l->section.shape == MT_SECTION_CIRCLE || l->section.shape == MT_SECTION_TUBE;
        if (!round) {
            wants(f, l, l->has_hinge_axis, true, "hinge_axis",
                  "a beam in three dimensions whose section is not round");
        }
    }
}

static void check_lumped(mt_resolve *f, const mt_link *l)
{
    static const char rigid[] = "a link of rigid elements";
    const int n = l->elements;
    wants(f, l, l->shear.given, false, "shear", rigid);
    wants(f, l, mt_diag_member(f->d, l->addr, "rotary_inertia") != l->addr, false,
          "rotary_inertia", rigid);
    if (f->m->dimension == 2) {
        wants(f, l, l->shear_modulus != MT_ABSENT, false, "shear_modulus_pa",
              "a link in two dimensions");
    }
    check_list(f, l, l->n_stiffness, n - 1, l->stiffness, "stiffness_n_m_per_rad", "hinge");
    check_list(f, l, l->n_element_length, n, l->element_length, "element_length_m", "element");
    check_list(f, l, l->n_element_mass, n, l->element_mass, "element_mass_kg", "element");
    check_list(f, l, l->n_element_inertia, n, l->element_inertia, "element_inertia_kg_m2",
               "element");
    if (n == 1) {
        wants(f, l, l->n_stiffness > 0, false, "stiffness_n_m_per_rad",
              "a link of one element");
    } else if (l->n_stiffness == 0 &&
               (l->youngs_modulus == MT_ABSENT || l->section.shape == MT_SECTION_NONE)) {
        mt_diag_error(f->d, l->name.addr,
                      "link \"%s\": its hinges need \"stiffness_n_m_per_rad\", or "
                      "\"youngs_modulus_pa\" with a section",
                      l->name.s);
    }
    if (f->m->dimension == 3) {
        wants(f, l, l->has_hinge_axis, true, "hinge_axis",
              "a link of rigid elements in three dimensions");
    }
}

void mt_resolve_links(mt_resolve *f)
{
    for (int i = 0; i < f->m->n_links; i++) {
        mt_link *const l = &f->m->links[i];
        mt_resolve_position(f, &l->from);
        mt_resolve_position(f, &l->to);
        if (l->elements == 0) {
            continue; /* could not be read */
        }
        if (mt_resolve_same_position(f->m, &l->from, &l->to)) {
            mt_diag_error(f->d, l->name.addr, "link \"%s\" begins and ends at the same point",
                          l->name.s);
        }
        check_mass(f, l);
        check_section(f, l);
        if (l->kind == MT_LINK_BEAM) {
            check_beam(f, l);
        } else {
            check_lumped(f, l);
        }
        if (f->m->dimension == 2) {
            static const char plane[] = "a link in two dimensions";
            wants(f, l, l->has_hinge_axis, false, "hinge_axis", plane);
            wants(f, l, l->radius_of_gyration != MT_ABSENT && l->kind == MT_LINK_LUMPED, false,
                  "radius_of_gyration_m", plane);
        }
    }
}
