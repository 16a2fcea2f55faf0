/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Flexible links and their sections: which members a kind and a section need, and the lengths
 * of lists. */
#include "model/item.h"

static const char *const SHAPES[] = {"rectangle", "circle", "tube", "general"};

/* One place for the diameters of circles and of tubes: what does not belong to the shape is
 * refused. */
static void read_diameter(mt_reader *r, const mt_key *key, mt_addr value, mt_section *s,
                          bool tube)
{
    const mt_num num = mt_read_num(mt_model_reader_of(r), value, key->possible, NULL);
    if (tube == (s->shape == MT_SECTION_TUBE)) {
        s->diameter = num;
    } else if (num != MT_ABSENT && s->shape != MT_SECTION_NONE) {
        mt_diag_error(r->diags, value, "a section of shape \"%s\" has no \"%s\"",
                      SHAPES[s->shape - MT_SECTION_RECTANGLE], key->name);
    }
}

static void read_circle(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    read_diameter(r, key, value, item, false);
}

static void read_tube(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    read_diameter(r, key, value, item, true);
}

static void section_defaults(void *item, mt_addr addr, int which)
{
    (void)which;
    ((mt_section *)item)->addr = addr;
}

#define THIS mt_section
static const mt_key SECTION[] = {
    MT_M_CHOICE("shape", true, shape, mt_section_shape, "shape", SHAPES,
                "rectangle: width_m, height_m; circle: diameter_m; tube: outer_diameter_m, "
                "inner_diameter_m; general: area_m2, second_moment_m4.",
                .least = MT_SECTION_RECTANGLE),
    MT_I_NUM("width_m", false, width, THICKNESS,
             "Rectangle: across the plane of bending; in three dimensions along the hinge axis "
             "[m]."),
    MT_I_NUM("height_m", false, height, THICKNESS, "Rectangle: in the plane of bending [m]."),
    MT_M_JUST("diameter_m", NUMBER, false, THICKNESS, "Circle [m].", .read = read_circle),
    MT_M_JUST("outer_diameter_m", NUMBER, false, THICKNESS, "Tube [m].", .read = read_tube),
    MT_I_NUM("inner_diameter_m", false, inner_diameter, INNER, "Tube [m]."),
    MT_I_NUM("area_m2", false, area, POSITIVE, "General: area [m^2]."),
    MT_I_NUM("second_moment_m4", false, second_moment, POSITIVE,
             "General: second moment of area for bending about the hinge axis [m^4]."),
    MT_I_NUM("second_moment_other_m4", false, second_moment_other, POSITIVE,
             "General, three dimensions: for bending about the other axis [m^4]."),
    MT_I_NUM("torsion_constant_m4", false, torsion_constant, NOT_NEGATIVE,
             "General, three dimensions: torsion constant [m^4]."),
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_section_keys = {MT_I_TABLE("section", SECTION, mt_section),
                                      .defaults = section_defaults,
                                      .says = "Cross-section of a link."};

static void shear_defaults(void *item, mt_addr addr, int which)
{
    mt_shear *const s = item;
    (void)which;
    s->given = addr != MT_NO_ADDR;
    s->addr = addr;
}

#define THIS mt_shear
static const mt_key SHEAR[] = {
    MT_I_NUM("coefficient", true, coefficient, POSITIVE,
             "Shear area over area, above 0, for bending about the hinge axis: 5/6 for a "
             "rectangle, 9/10 for a circle, about 1/2 for a thin tube."),
    MT_I_NUM("coefficient_other", false, coefficient_other, POSITIVE,
             "Three dimensions: for bending about the other axis. Absent: the same."),
    MT_I_NUM("poissons_ratio", false, poissons_ratio, POISSON,
             "Instead of shear_modulus_pa: G = E / (2 (1 + nu)), in torsion too."),
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_shear_keys = {
    MT_I_TABLE("shear", SHEAR, mt_shear), .defaults = shear_defaults,
    .says = "Beams: Timoshenko's elements, which deform in shear. The shear modulus is the "
            "link's, or follows from Poisson's ratio."};

static void read_rotary(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_link *const l = item;
    (void)key;
    l->rotary_inertia = mt_reader_flag(r, value, l->shear.given);
}

static void link_defaults(void *item, mt_addr addr, int which)
{
    (void)which;
    ((mt_link *)item)->addr = addr;
}

/* A link that could not be read has no elements. */
static void link_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_link *const l = item;
    (void)which;
    l->elements = mt_object_wrong(r, o) ? 0 : l->elements;
}

static const char *const KINDS[] = {"rigid_elements", "beam"};

#define THIS mt_link
static const mt_key LINK[] = {
    MT_I_NAME("link"),
    MT_M_CHOICE(
        "kind", false, kind, mt_link_kind, "kind", KINDS,
        "\"rigid_elements\": elements L.1, L.2 ..., hinges L.h1 ..., springs L.k1 ...; "
        "\"beam\": beam elements with consistent mass and consistent geometric stiffness.",
        .otherwise = "\"rigid_elements\""),
    MT_I_POSITION("from", true, from, "Start [m]."),
    MT_I_POSITION("to", true, to, "End [m]."),
    MT_M_COUNT("elements", true, elements, 1, MT_MAX_ELEMENTS, "Number of elements."),
    MT_I_NUM("mass_kg", false, mass, NOT_NEGATIVE,
             "Mass of the whole link [kg], not negative; or density, or element masses."),
    MT_I_NUM("density_kg_per_m3", false, density, DENSITY,
             "Density [kg/m^3], above 0; needs a section."),
    MT_I_NUM("youngs_modulus_pa", false, youngs_modulus, MODULUS,
             "Young's modulus [Pa], above 0."),
    MT_I_NUM("shear_modulus_pa", false, shear_modulus, MODULUS,
             "Beams in three dimensions, and beams with `shear`: shear modulus [Pa], above 0."),
    MT_M_PART("shear", false, shear, mt_shear, mt_shear_keys, NULL),
    MT_M_JUST("rotary_inertia", BOOL, false, NONE,
              "Beams: whether the rotation of the sections in bending has inertia. Absent: "
              "true where `shear` is given.",
              .read = read_rotary),
    MT_M_PART("section", false, section, mt_section, mt_section_keys, NULL),
    MT_I_NUMS("stiffness_n_m_per_rad", NUMBER_OR_LIST, stiffness, n_stiffness, NOT_NEGATIVE, 1,
              MT_MAX_ELEMENTS,
              "Stiffness of the hinges [N m/rad], not negative: one for all, or a list with "
              "one each. Absent: E I / distance of the element centres."),
    MT_I_NUMS("element_length_m", NUMBER_OR_LIST, element_length, n_element_length, POSITIVE, 1,
              MT_MAX_ELEMENTS,
              "Lengths of the rigid elements [m]: one for all, or a list. Absent: equal."),
    MT_I_NUMS("element_mass_kg", NUMBER_OR_LIST, element_mass, n_element_mass, NOT_NEGATIVE, 1,
              MT_MAX_ELEMENTS, "Masses of the rigid elements [kg]: one for all, or a list."),
    MT_I_NUMS("element_inertia_kg_m2", NUMBER_OR_LIST, element_inertia, n_element_inertia,
              NOT_NEGATIVE, 1, MT_MAX_ELEMENTS,
              "Moments of inertia of the rigid elements about their centres and the hinge axis "
              "[kg m^2]. Absent: m l^2 / 12."),
    MT_I_VECTOR(
        "hinge_axis", hinge_axis, has_hinge_axis, AXIS,
        "Three dimensions: direction of the hinges, across the link. Rigid elements bend about "
        "it only; a beam has its section's axes by it, and bends about both."),
    MT_I_NUM("radius_of_gyration_m", false, radius_of_gyration, NOT_NEGATIVE,
             "Three dimensions, rigid elements: about the link's own axis [m]. Absent: 0."),
    MT_I_NUM("loss_factor", false, loss_factor, LOSS,
             "Structural damping of its hinges or beam elements, as of springs; not negative. "
             "Absent: 0."),
    MT_I_IN,
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_link_keys = {
    MT_I_TABLE("link", LINK, mt_link), .defaults = link_defaults, .finish = link_finish,
    .says = "A flexible link from one point to another: rigid elements with hinges and "
            "torsional springs, or beam elements, Euler-Bernoulli's or Timoshenko's."};

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
