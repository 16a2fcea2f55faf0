/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Flexible links and their sections. */
#include "model/read_priv.h"

#include <limits.h>

#define LINK_KEYS(X)                                                                           \
    X(LINK_NAME, "name", TEXT, true, NONE,                                                     \
      "Name of the link: a letter or _, then letters, digits, _, + and -.",                    \
      .pattern = "^[A-Za-z_][A-Za-z0-9_+-]*$")                                                 \
    X(LINK_KIND, "kind", TEXT, false, NONE,                                                    \
      "\"rigid_elements\": elements L.1, L.2 ..., hinges L.h1 ..., springs L.k1 ...; "         \
      "\"beam\": beam elements with consistent mass and consistent geometric stiffness.",      \
      .otherwise = "\"rigid_elements\"",                                                       \
      .schema = "\"type\": \"string\", \"enum\": [\"rigid_elements\", \"beam\"]")              \
    X(LINK_FROM, "from", TEXT_OR_LIST, true, POINT, "Start [m].",                              \
      .schema = "\"allOf\": [{\"$ref\": \"#/definitions/position\"}]")                         \
    X(LINK_TO, "to", TEXT_OR_LIST, true, POINT, "End [m].",                                    \
      .schema = "\"allOf\": [{\"$ref\": \"#/definitions/position\"}]")                         \
    X(LINK_ELEMENTS, "elements", COUNT, true, WHOLE, "Number of elements.", .least = 1,        \
      .most = 1000000)                                                                         \
    X(LINK_MASS, "mass_kg", NUMBER, false, NOT_NEGATIVE,                                       \
      "Mass of the whole link [kg], not negative; or density, or element masses.")             \
    X(LINK_DENSITY, "density_kg_per_m3", NUMBER, false, DENSITY,                               \
      "Density [kg/m^3], above 0; needs a section.")                                           \
    X(LINK_YOUNG, "youngs_modulus_pa", NUMBER, false, MODULUS,                                 \
      "Young's modulus [Pa], above 0.")                                                        \
    X(LINK_SHEAR, "shear_modulus_pa", NUMBER, false, MODULUS,                                  \
      "Beams in three dimensions, and beams with `shear`: shear modulus [Pa], above 0.")       \
    X(LINK_SHEAR_DATA, "shear", OBJECT, false, NONE, NULL,                                     \
      .schema = "\"$ref\": \"#/definitions/shear\"")                                           \
    X(LINK_ROTARY, "rotary_inertia", BOOL, false, NONE,                                        \
      "Beams: whether the rotation of the sections in bending has inertia. Absent: true "      \
      "where `shear` is given.")                                                               \
    X(LINK_SECTION, "section", OBJECT, false, NONE, NULL,                                      \
      .schema = "\"$ref\": \"#/definitions/section\"")                                         \
    X(LINK_STIFFNESS, "stiffness_n_m_per_rad", NUMBER_OR_LIST, false, NOT_NEGATIVE,            \
      "Stiffness of the hinges [N m/rad], not negative: one for all, or a list with one "      \
      "each. Absent: E I / distance of the element centres.",                                  \
      .schema = "\"anyOf\": [{\"$ref\": \"#/definitions/number\"}, {\"type\": \"array\", "     \
                "\"minItems\": 1, \"maxItems\": 1000000, \"items\": {\"$ref\": "               \
                "\"#/definitions/number\"}}]")                                                 \
    X(LINK_LENGTH, "element_length_m", NUMBER_OR_LIST, false, POSITIVE,                        \
      "Lengths of the rigid elements [m]: one for all, or a list. Absent: equal.",             \
      .schema = "\"anyOf\": [{\"$ref\": \"#/definitions/number\"}, {\"type\": \"array\", "     \
                "\"minItems\": 1, \"maxItems\": 1000000, \"items\": {\"$ref\": "               \
                "\"#/definitions/number\"}}]")                                                 \
    X(LINK_ELEMENT_MASS, "element_mass_kg", NUMBER_OR_LIST, false, NOT_NEGATIVE,               \
      "Masses of the rigid elements [kg]: one for all, or a list.",                            \
      .schema = "\"anyOf\": [{\"$ref\": \"#/definitions/number\"}, {\"type\": \"array\", "     \
                "\"minItems\": 1, \"maxItems\": 1000000, \"items\": {\"$ref\": "               \
                "\"#/definitions/number\"}}]")                                                 \
    X(LINK_INERTIA, "element_inertia_kg_m2", NUMBER_OR_LIST, false, NOT_NEGATIVE,              \
      "Moments of inertia of the rigid elements about their centres and the hinge axis [kg "   \
      "m^2]. Absent: m l^2 / 12.",                                                             \
      .schema = "\"anyOf\": [{\"$ref\": \"#/definitions/number\"}, {\"type\": \"array\", "     \
                "\"minItems\": 1, \"maxItems\": 1000000, \"items\": {\"$ref\": "               \
                "\"#/definitions/number\"}}]")                                                 \
    X(LINK_HINGE_AXIS, "hinge_axis", LIST, false, AXIS,                                        \
      "Three dimensions: direction of the hinges, across the link. Rigid elements bend about " \
      "it only; a beam has its section's axes by it, and bends about both.",                   \
      .schema = "\"allOf\": [{\"$ref\": \"#/definitions/vector\"}]")                           \
    X(LINK_GYRATION, "radius_of_gyration_m", NUMBER, false, NOT_NEGATIVE,                      \
      "Three dimensions, rigid elements: about the link's own axis [m]. Absent: 0.")           \
    X(LINK_LOSS, "loss_factor", NUMBER, false, LOSS,                                           \
      "Structural damping of its hinges or beam elements, as of springs; not negative. "       \
      "Absent: 0.")                                                                            \
    X(LINK_IN, "in", LIST, false, NONE,                                                        \
      "Names of the configurations that contain this item; absent: all of them. "              \
      "Configurations that are `like` one of them contain it as well.",                        \
      .schema = "\"type\": \"array\", \"items\": {\"type\": \"string\"}")                      \
    X(LINK_DESCRIPTION, "description", TEXT, false, NONE, "Free text for people.")             \
    X(LINK_SOURCE, "source", TEXT, false, NONE,                                                \
      "Where it comes from: a table, a page, a test report.")
enum { LINK_KEYS(MT_READ_ENUM) LINK_COUNT };
MT_READ_TABLE(mt_link_keys, "link", LINK_KEYS,
              .says =
                  "A flexible link from one point to another: rigid elements with hinges and "
                  "torsional springs, or beam elements, Euler-Bernoulli's or Timoshenko's.");

#define SECTION_KEYS(X)                                                                        \
    X(SECTION_SHAPE, "shape", TEXT, true, NONE,                                                \
      "rectangle: width_m, height_m; circle: diameter_m; tube: outer_diameter_m, "             \
      "inner_diameter_m; general: area_m2, second_moment_m4.",                                 \
      .schema = "\"type\": \"string\", \"enum\": [\"rectangle\", \"circle\", \"tube\", "       \
                "\"general\"]")                                                                \
    X(SECTION_WIDTH, "width_m", NUMBER, false, THICKNESS,                                      \
      "Rectangle: across the plane of bending; in three dimensions along the hinge axis [m].") \
    X(SECTION_HEIGHT, "height_m", NUMBER, false, THICKNESS,                                    \
      "Rectangle: in the plane of bending [m].")                                               \
    X(SECTION_DIAMETER, "diameter_m", NUMBER, false, THICKNESS, "Circle [m].")                 \
    X(SECTION_OUTER, "outer_diameter_m", NUMBER, false, THICKNESS, "Tube [m].")                \
    X(SECTION_INNER, "inner_diameter_m", NUMBER, false, INNER, "Tube [m].")                    \
    X(SECTION_AREA, "area_m2", NUMBER, false, POSITIVE, "General: area [m^2].")                \
    X(SECTION_MOMENT, "second_moment_m4", NUMBER, false, POSITIVE,                             \
      "General: second moment of area for bending about the hinge axis [m^4].")                \
    X(SECTION_MOMENT_OTHER, "second_moment_other_m4", NUMBER, false, POSITIVE,                 \
      "General, three dimensions: for bending about the other axis [m^4].")                    \
    X(SECTION_TORSION, "torsion_constant_m4", NUMBER, false, NOT_NEGATIVE,                     \
      "General, three dimensions: torsion constant [m^4].")                                    \
    X(SECTION_DESCRIPTION, "description", TEXT, false, NONE, "Free text for people.")          \
    X(SECTION_SOURCE, "source", TEXT, false, NONE,                                             \
      "Where it comes from: a table, a page, a test report.")
enum { SECTION_KEYS(MT_READ_ENUM) SECTION_COUNT };
MT_READ_TABLE(mt_section_keys, "section", SECTION_KEYS, .says = "Cross-section of a link.");

#define SHEAR_KEYS(X)                                                                          \
    X(SHEAR_COEFFICIENT, "coefficient", NUMBER, true, POSITIVE,                                \
      "Shear area over area, above 0, for bending about the hinge axis: 5/6 for a rectangle, " \
      "9/10 for a circle, about 1/2 for a thin tube.")                                         \
    X(SHEAR_OTHER, "coefficient_other", NUMBER, false, POSITIVE,                               \
      "Three dimensions: for bending about the other axis. Absent: the same.")                 \
    X(SHEAR_POISSON, "poissons_ratio", NUMBER, false, POISSON,                                 \
      "Instead of shear_modulus_pa: G = E / (2 (1 + nu)), in torsion too.")                    \
    X(SHEAR_DESCRIPTION, "description", TEXT, false, NONE, "Free text for people.")            \
    X(SHEAR_SOURCE, "source", TEXT, false, NONE,                                               \
      "Where it comes from: a table, a page, a test report.")
enum { SHEAR_KEYS(MT_READ_ENUM) SHEAR_COUNT };
MT_READ_TABLE(mt_shear_keys, "shear", SHEAR_KEYS,
              .says = "Beams: Timoshenko's elements, which deform in shear. The shear modulus "
                      "is the link's, or follows from Poisson's ratio.");

static mt_shear read_shear(mt_model_reader *mr, mt_addr value)
{
    mt_addr at[SHEAR_COUNT];
    (void)mt_reader_object(&mr->r, value, &mt_shear_keys, at);
    return (mt_shear){.given = value != MT_NO_ADDR,
                      .coefficient = mt_read_num(mr, at[SHEAR_COEFFICIENT]),
                      .coefficient_other = mt_read_num(mr, at[SHEAR_OTHER]),
                      .poissons_ratio = mt_read_num(mr, at[SHEAR_POISSON]),
                      .addr = value};
}

static mt_section read_section(mt_model_reader *mr, mt_addr value)
{
    static const char *const shapes[] = {"rectangle", "circle", "tube", "general"};
    mt_addr at[SECTION_COUNT];
    (void)mt_reader_object(&mr->r, value, &mt_section_keys, at);
    /* the list lacks the first shape, "none" */
    const int shape =
        mt_reader_choice(&mr->r, at[SECTION_SHAPE], "shape", shapes, MT_COUNT(shapes));
    mt_section s = {.shape = (mt_section_shape)(shape + 1), .addr = value};
    s.width = mt_read_num(mr, at[SECTION_WIDTH]);
    s.height = mt_read_num(mr, at[SECTION_HEIGHT]);
    s.diameter = mt_read_num(mr, at[SECTION_DIAMETER]);
    const mt_num outer = mt_read_num(mr, at[SECTION_OUTER]);
    s.inner_diameter = mt_read_num(mr, at[SECTION_INNER]);
    s.area = mt_read_num(mr, at[SECTION_AREA]);
    s.second_moment = mt_read_num(mr, at[SECTION_MOMENT]);
    s.second_moment_other = mt_read_num(mr, at[SECTION_MOMENT_OTHER]);
    s.torsion_constant = mt_read_num(mr, at[SECTION_TORSION]);
    /* one place for both diameters: what does not belong to the shape is refused here */
    const bool tube = s.shape == MT_SECTION_TUBE;
    const mt_num misplaced = tube ? s.diameter : outer;
    if (misplaced != MT_ABSENT && s.shape != MT_SECTION_NONE) {
        mt_diag_error(mr->r.diags, at[tube ? SECTION_DIAMETER : SECTION_OUTER],
                      "a section of shape \"%s\" has no \"%s\"", shapes[shape],
                      tube ? "diameter_m" : "outer_diameter_m");
    }
    if (tube) {
        s.diameter = outer;
    }
    return s;
}

static void read_link(mt_model_reader *mr, mt_addr value, mt_link *l)
{
    static const char *const kinds[] = {"rigid_elements", "beam"};
    const int before = mr->r.diags->errors;
    mt_addr at[LINK_COUNT];
    (void)mt_reader_object(&mr->r, value, &mt_link_keys, at);
    *l = (mt_link){.elements_addr = at[LINK_ELEMENTS], .stiffness_addr = at[LINK_STIFFNESS]};
    l->name = mt_reader_name(&mr->r, at[LINK_NAME]);
    const int kind = mt_reader_choice(&mr->r, at[LINK_KIND], "kind", kinds, MT_COUNT(kinds));
    l->kind = kind == 1 ? MT_LINK_BEAM : MT_LINK_LUMPED;
    l->from = mt_read_position(mr, at[LINK_FROM]);
    l->to = mt_read_position(mr, at[LINK_TO]);
    l->elements = mt_reader_count(&mr->r, at[LINK_ELEMENTS], 1, MT_MAX_ELEMENTS, 0);
    l->mass = mt_read_num(mr, at[LINK_MASS]);
    l->density = mt_read_num(mr, at[LINK_DENSITY]);
    l->youngs_modulus = mt_read_num(mr, at[LINK_YOUNG]);
    l->shear_modulus = mt_read_num(mr, at[LINK_SHEAR]);
    l->section = read_section(mr, at[LINK_SECTION]);
    l->shear = read_shear(mr, at[LINK_SHEAR_DATA]);
    l->rotary_addr = at[LINK_ROTARY];
    l->rotary_inertia = at[LINK_ROTARY] == MT_NO_ADDR
                            ? l->shear.given
                            : mt_reader_flag(&mr->r, at[LINK_ROTARY], false);
    l->stiffness =
        mt_read_nums(mr, at[LINK_STIFFNESS], true, 1, MT_MAX_ELEMENTS, &l->n_stiffness);
    l->element_length =
        mt_read_nums(mr, at[LINK_LENGTH], true, 1, MT_MAX_ELEMENTS, &l->n_element_length);
    l->element_mass =
        mt_read_nums(mr, at[LINK_ELEMENT_MASS], true, 1, MT_MAX_ELEMENTS, &l->n_element_mass);
    l->element_inertia =
        mt_read_nums(mr, at[LINK_INERTIA], true, 1, MT_MAX_ELEMENTS, &l->n_element_inertia);
    l->has_hinge_axis = mt_read_vector(mr, at[LINK_HINGE_AXIS], l->hinge_axis);
    l->radius_of_gyration = mt_read_num(mr, at[LINK_GYRATION]);
    l->loss_factor = mt_read_num(mr, at[LINK_LOSS]);
    l->in = mt_read_presence(mr, at[LINK_IN]);
    if (mr->r.diags->errors > before) {
        l->elements = 0;
    }
}

void mt_read_links(mt_model_reader *mr, mt_addr list)
{
    mt_model *const m = mr->m;
    mt_items i = mt_reader_items(&mr->r, list);
    m->links = mt_reader_room(&mr->r, &i, sizeof *m->links);
    while (mt_items_next(&i)) {
        read_link(mr, i.at, &m->links[m->n_links++]);
    }
}
