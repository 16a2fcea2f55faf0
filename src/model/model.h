/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_MODEL_H
#define MODEL_MODEL_H

#include <stdbool.h>

#include "base/arena.h"
#include "base/diagnostics.h"
#include "base/document.h"
#include "base/possible.h"
#include "base/sorted.h"
#include "expr/expr.h"
#include "expr/kind.h"
#include "expr/units.h"

/*
 * The description of one mechanism and its configurations. A reader fills the lists (names,
 * numbers, addresses of both), then mt_model_resolve resolves names, checks what needs no
 * numbers, and from then on the model is immutable and may be shared by threads. Numbers stay
 * expressions of parameters: values belong to a configuration (mechanics instantiates it).
 * Geometry: the reference position, global coordinates [m]; angles [rad].
 */
enum { MT_GROUND = -1 };
/* Greatest number of elements of a link, and of entries listed for them. */
enum { MT_MAX_ELEMENTS = 1000000 };
/* Greatest product of configurations and (numbers and items) of a model: every configuration is
 * checked with all its numbers. */
enum { MT_MAX_CONFIGURED = 10000000 };

/* Index into mt_model.nums; MT_ABSENT where the member was not given. */
typedef int mt_num;
typedef mt_num mt_vector[3];

typedef struct mt_number {
    mt_expr expr;
    mt_addr addr;
    mt_possible_id possible;  /* row of its member; set by the reader */
    const char *unit_warning; /* why its unit does not fit the member; NULL: it fits */
} mt_number;

/* `in`: which configurations contain an item. */
typedef struct mt_presence {
    bool given;         /* false: all configurations */
    mt_name_list names; /* as written */
    bool *present;      /* [n_configurations], resolved through `like`; NULL: all */
} mt_presence;

typedef struct mt_parameter {
    mt_name name;
    mt_num value;
    /* SI unit of its values: "m" where the file has "mm"; NULL: none */
    const char *unit;
    /* unit of its number in the file where that is not an SI unit ("mm"); NULL */
    const mt_unit *written;
    mt_kind kind; /* of its value; from its unit, else from its expression */
    const char *description;
    const char *source;
    mt_origin origin;
} mt_parameter;

/* A position: a named point, or coordinates of its own. */
typedef struct mt_position {
    mt_name point_name; /* set where a string was given */
    int point;          /* resolved: index of the point, MT_ABSENT: own coordinates */
    mt_vector x;        /* own coordinates; in two dimensions x[2] is MT_ABSENT */
    bool given;
    mt_addr addr;
} mt_position;

/*
 * Axes of an item's own, in the reference position: the drawing's where they are not given.
 * Two vectors, of any length: x, and y or z, of which only the part across x counts; in two
 * dimensions x alone. Or angles a, b, c: the drawing's axes turned about x by a, then about the
 * drawing's y by b, then about its z by c (about z, the new y and the new x: c, b, a),
 *     [x y z] = Rz(c) Ry(b) Rx(a);
 * in two dimensions one angle.
 */
typedef struct mt_axes {
    bool given;
    bool has_x;
    mt_vector x;
    bool has_y;
    mt_vector y;
    bool has_z;
    mt_vector z;
    int n_angles;
    mt_num *angles; /* rad */
    mt_addr addr;
} mt_axes;

typedef struct mt_point {
    mt_name name;
    mt_vector x;
} mt_point;

/* Attachment of a joint, spring or sensor. Written "ground", "crank", "beam.start", "beam.end",
 * "beam.3" (rigid element, 1-based), "beam.node3" (node, 0-based: of a beam, or between rigid
 * elements). */
typedef enum mt_attach_kind {
    MT_ATTACH_GROUND,
    MT_ATTACH_BODY,
    MT_ATTACH_LINK_START,
    MT_ATTACH_LINK_END,
    MT_ATTACH_LINK_ELEMENT,
    MT_ATTACH_LINK_NODE
} mt_attach_kind;
typedef struct mt_attach {
    mt_name name;
    mt_attach_kind kind;
    int index;   /* body or link */
    int element; /* MT_ATTACH_LINK_ELEMENT, MT_ATTACH_LINK_NODE: 0-based */
    int part;    /* of a link: number of its bodies before the attached one */
} mt_attach;

/* A rigid body; without `inertia_kg_m2` a point mass (no rotation of its own, 2 or 3
 * states). */
typedef struct mt_body {
    mt_name name;
    mt_num mass; /* kg; absent: 0 */
    bool point_mass;
    /* about the centre of mass, along `axes` in the reference position [kg m^2]. 2-D: [0]. 3-D:
     * xx yy zz xy xz yz (absent: 0) */
    mt_num inertia[6];
    mt_axes axes;
    mt_position centre;
    mt_presence in;
    mt_origin origin; /* of its numbers: for people */
} mt_body;

typedef enum mt_section_shape {
    MT_SECTION_NONE,
    MT_SECTION_RECTANGLE,
    MT_SECTION_CIRCLE,
    MT_SECTION_TUBE,
    MT_SECTION_GENERAL
} mt_section_shape;
/* rectangle: width (out of plane, 2-D; along hinge_axis, 3-D), height (in the plane of
 * bending); circle: diameter; tube: outer, inner diameter; general: area_m2, second_moment_m4
 * (bending about hinge axis / out of plane), in 3-D also second_moment_other_m4,
 * torsion_constant_m4. */
typedef struct mt_section {
    mt_section_shape shape;
    mt_num width;
    mt_num height;
    mt_num diameter;
    mt_num inner_diameter;
    mt_num area;
    mt_num second_moment;
    mt_num second_moment_other;
    mt_num torsion_constant;
    mt_addr addr;
} mt_section;

/* Timoshenko's beam: shear area = coefficient x area, for bending about the hinge axis and
 * about the other. */
typedef struct mt_shear {
    bool given;
    mt_num coefficient;
    mt_num coefficient_other; /* equal to `coefficient` if absent (3-D) */
    mt_num poissons_ratio;    /* instead of the link's shear_modulus: G = E/(2 (1 + nu)) */
    mt_addr addr;
} mt_shear;

typedef enum mt_link_kind { MT_LINK_LUMPED, MT_LINK_BEAM } mt_link_kind;

/* A flexible link from one point to another. Lumped (`"kind": "rigid_elements"`, default): n
 * rigid elements L.1..n, hinges L.h1..h(n-1), torsional springs L.k1..k(n-1). Beam: n
 * Euler-Bernoulli elements, or Timoshenko's with `shear`, n + 1 nodes. Lists have one entry
 * (uniform) or one per element (stiffness: one per hinge). */
typedef struct mt_link {
    mt_name name;
    mt_link_kind kind;
    mt_position from;
    mt_position to;
    int elements;
    mt_num mass;           /* kg, whole link; or density x section; or element_mass */
    mt_num density;        /* kg/m^3 */
    mt_num youngs_modulus; /* Pa */
    mt_num shear_modulus;  /* Pa, beams: torsion in 3-D, shear */
    mt_shear shear;        /* beams */
    bool rotary_inertia;   /* beams: of the section's rotation in bending */
    mt_section section;
    int n_stiffness;        /* 0, 1 or elements - 1 */
    mt_num *stiffness;      /* N m/rad */
    int n_element_length;   /* 0, 1 or elements */
    mt_num *element_length; /* m */
    int n_element_mass;
    mt_num *element_mass; /* kg */
    int n_element_inertia;
    mt_num *element_inertia; /* kg m^2 about the element's centre, hinge axis */
    bool has_hinge_axis;
    mt_vector hinge_axis;      /* 3-D */
    mt_num radius_of_gyration; /* m, 3-D lumped: about the element's own long axis; absent: 0 */
    mt_num loss_factor;        /* of its hinges or beam elements; absent: 0 */
    mt_presence in;
    mt_addr addr;
} mt_link;

/* type, JSON name; what they are stands in mt_joint_kind */
#define MT_JOINT_LIST(X)                         \
    X(MT_JOINT_FIXED, "fixed")                   \
    X(MT_JOINT_REVOLUTE, "revolute")             \
    X(MT_JOINT_PRISMATIC, "prismatic")           \
    X(MT_JOINT_PIN_IN_SLOT, "pin-in-slot")       \
    X(MT_JOINT_DISTANCE, "distance")             \
    X(MT_JOINT_CYLINDRICAL, "cylindrical")       \
    X(MT_JOINT_SPHERICAL, "spherical")           \
    X(MT_JOINT_UNIVERSAL, "universal")           \
    X(MT_JOINT_PLANAR, "planar")                 \
    X(MT_JOINT_POINT_ON_LINE, "point-on-line")   \
    X(MT_JOINT_POINT_ON_PLANE, "point-on-plane") \
    X(MT_JOINT_ORIENTATION, "orientation")       \
    X(MT_JOINT_GEAR, "gear")                     \
    X(MT_JOINT_RACK, "rack")
#define MT_JOINT_ENUM(id, name) id,
typedef enum mt_joint_type { MT_JOINT_LIST(MT_JOINT_ENUM) MT_JOINT_TYPE_COUNT } mt_joint_type;
#undef MT_JOINT_ENUM

/* Loss factor: one of all directions (absent: 0), or of a bushing n = 6 by direction, x y z rx
 * ry rz (in two dimensions 3: x y r). */
typedef struct mt_loss {
    mt_num all;
    int n;
    mt_num *each;
} mt_loss;

/*
 * What a joint yields: between the first body and a carrier without mass, on which the joint
 * stands, along the joint's axes: e2 along `axis` where it has one (in two dimensions e1), and
 * e0 as axes.x, where given, lies across it; otherwise `axes`. Absent: rigid.
 */
typedef struct mt_compliance {
    mt_axes axes;
    mt_vector translation;         /* N/m */
    mt_vector rotation;            /* N m/rad */
    mt_vector damping_translation; /* N s/m, beside a stiffness; absent: 0 */
    mt_vector damping_rotation;    /* N m s/rad */
    mt_loss loss;
    mt_addr addr;
} mt_compliance;

typedef struct mt_joint {
    mt_name name;
    mt_joint_type type;
    mt_attach bodies[2];
    int n_at;          /* 0, 1 or 2 */
    mt_position at[2]; /* one point, or the point on each body as drawn */
    bool has_axis;
    /* revolute, cylindrical, planar, plane: axis / normal; prismatic, slot, line: direction.
     * Fixed to bodies[0] (drawn on both). Not normalised */
    mt_vector axis;
    bool has_axis_b;
    mt_vector axis_b; /* universal: second axis, on bodies[1] */
    mt_num length;    /* distance: m; absent: as drawn */
    mt_num mass;      /* distance: kg of a uniform thin rod between the points; absent: none */
    mt_name gear_joints[2]; /* gear, rack: coordinate of [1] = ratio * angle of [0] */
    int gear_joint[2];
    mt_num ratio;              /* gear: 1 */
    mt_num ratio_m_per_rad;    /* rack */
    mt_compliance *compliance; /* NULL: rigid */
    mt_presence in;
} mt_joint;

#define MT_SPRING_LIST(X)           \
    X(MT_SPRING_TORSION, "torsion") \
    X(MT_SPRING_AXIAL, "axial")     \
    X(MT_SPRING_BAR, "bar")         \
    X(MT_SPRING_BUSHING, "bushing")
#define MT_SPRING_ENUM(id, name) id,
typedef enum mt_spring_type {
    MT_SPRING_LIST(MT_SPRING_ENUM) MT_SPRING_TYPE_COUNT
} mt_spring_type;
#undef MT_SPRING_ENUM

/* Also a damper (list `dampers`: torsion, axial, bushing; stiffness members become
 * damping_*). A torsion or axial one may act on the coordinate of a joint. */
typedef struct mt_spring {
    mt_name name;
    mt_spring_type type;
    bool damper;
    mt_attach bodies[2]; /* absent for a spring that names its joint */
    mt_name joint_name;
    int joint;      /* resolved joint, MT_ABSENT */
    int joint_link; /* or hinge joint_hinge (0-based) of this link ("beam.h3"), MT_ABSENT */
    int joint_hinge;
    int n_at; /* default: the centres of the bodies */
    mt_position at[2];
    mt_num stiffness;      /* axial N/m; torsion N m/rad; (damper N s/m, N m s/rad) */
    mt_num free_length;    /* m */
    mt_num free_angle;     /* rad, of the joint's coordinate / of the relative angle */
    mt_num preload;        /* N tension positive; N m; in the reference position */
    mt_num youngs_modulus; /* bar */
    mt_num area;
    mt_num density;
    mt_loss loss;          /* not for dampers */
    mt_axes axes;          /* bushing: of the reference position, attached to bodies[0] */
    mt_vector translation; /* bushing N/m */
    mt_vector rotation;    /* bushing N m/rad */
    mt_num *matrix;        /* bushing 6 x 6, row-major, lower triangle used, symmetric; NULL */
    mt_presence in;
} mt_spring;

/*
 * A dead load: constant in size and in direction. On a body: a force at one of its points, in
 * global directions however the body moves; in two dimensions also a moment. On a joint: a
 * force along its displacement or a moment about its angle, on the second body, with the
 * reaction on the first. Each has a potential. A moment of constant direction in space has none
 * where its body can turn about other axes (the work depends on the order of rotations):
 * mt_model_resolve refuses it.
 */
typedef struct mt_load {
    mt_name name;
    mt_attach on;
    mt_name joint_name;
    /* resolved: joint, or hinge joint_hinge (0-based) of link joint_link; MT_ABSENT */
    int joint;
    int joint_link;
    int joint_hinge;
    /* default: the centre of the body, the end of a link, the middle of its element */
    mt_position at;
    bool has_force;  /* a vector, or */
    bool one_number; /* a number */
    mt_vector force; /* N */
    bool has_moment;
    bool moment_vector;
    mt_num moment; /* N m */
    mt_addr addr;
    bool unread; /* its errors are in diags already */
    mt_presence in;
} mt_load;

/* Directions of a sensor: bits 0..5 = x y z rx ry rz; in 2-D x, y and rz ("r" for short). */
typedef struct mt_sensor {
    mt_name name;
    mt_name on_name;
    /* MT_ATTACH_BODY, MT_ATTACH_LINK_ELEMENT, or MT_ATTACH_LINK_START for a link at
     * `fraction` */
    mt_attach_kind on_kind;
    int on; /* body or link */
    int element;
    mt_num fraction; /* on a link: 0 at from, 1 at to */
    mt_position at;  /* on a body: default its centre */
    unsigned directions;
    mt_addr addr;
} mt_sensor;

typedef struct mt_named_mode {
    mt_name name;
    mt_name configuration_name;
    int configuration;
    int index; /* 1-based vibration mode at the original design */
} mt_named_mode;

typedef struct mt_override {
    mt_name parameter_name;
    int parameter;
    mt_num value;
} mt_override;

/* Most joints that a configuration drives. */
enum { MT_DRIVES_MOST = 32 };

typedef struct mt_drive {
    mt_name joint_name;
    int joint;
    mt_num position;        /* rad or m, relative to the reference position */
    bool position_is_angle; /* position_rad was given, not position_m */
    bool hold_given;        /* false: locked, the default */
    bool trim;              /* false: locked there */
    mt_name trim_name;
    int trim_spring;
    bool release; /* "free": true: the joint is not driven; gone after mt_model_resolve */
    int owner;    /* set by mt_model_resolve: the configuration where it stands */
    int item;     /* its index in the list where it stands; -1: it stands alone */
    mt_addr addr;
} mt_drive;

/* Damping ratio of a named mode of the model. */
typedef struct mt_mode_ratio {
    mt_name mode_name;
    int mode; /* of the model's named modes */
    mt_num ratio;
} mt_mode_ratio;

/*
 * Damping of a configuration in addition to its dampers and the loss factors of its springs:
 *     C = mass M + stiffness K + M Phi diag(2 ratio_j omega_j) Phi^T M,
 * K the tangent stiffness in equilibrium (loads and preload included), Phi its mass-normalised
 * modes. A vibration mode has the ratio given under its name, otherwise ratios[index - 1],
 * otherwise `ratio`, otherwise none; a rigid-body mode has none.
 */
typedef struct mt_damping {
    bool given;
    mt_num ratio;
    int n_ratios;
    mt_num *ratios; /* [n_ratios] of vibration modes 1 ... */
    int n_named;
    mt_mode_ratio *named; /* [n_named]; those of other configurations have no effect here */
    mt_num mass;          /* 1/s */
    mt_num stiffness;     /* s */
    bool inherited;       /* set by mt_model_resolve: from `like`, or from the model */
    mt_addr addr;
} mt_damping;

typedef struct mt_configuration {
    mt_name name;
    mt_name like_name;
    int like;        /* MT_ABSENT */
    int n_overrides; /* own ones as read; after mt_model_resolve with inherited ones */
    mt_override *overrides;
    bool has_gravity;
    mt_vector gravity; /* after mt_model_resolve: the one in force (inherited or the model's) */
    /* [n_drives] as read; after mt_model_resolve those in force, in the order of the model's
     * joints */
    mt_drive *drives;
    int n_drives;
    int n_own_drives;   /* as read */
    mt_damping damping; /* after mt_model_resolve: the one in force */
} mt_configuration;

/* Location of an address of the model's file, kept for messages about values: lines and columns
 * from 1. */
typedef struct mt_place {
    mt_addr addr;
    int line;
    int column;
    const char *file; /* an included one; NULL: the model's own */
} mt_place;

/* A file that was included. */
typedef struct mt_included {
    const char *name; /* as seen from the folder of the model */
    const char *sha256;
} mt_included;

/* A parameter whose value differs from that in the file (model/values.h). */
typedef struct mt_setting {
    int parameter;
    double value;
    double original; /* the file's */
} mt_setting;

typedef struct mt_model {
    mt_arena mem;     /* owns everything below; freed by mt_model_delete */
    const char *path; /* as given to the reader; NULL */
    const char *name;
    const char *description;
    /* units of coordinates, angles and speeds declared in its file; NULL: SI */
    const mt_unit *units[MT_DIMENSION_COUNT];
    int dimension; /* 2 or 3 */
    bool has_gravity;
    mt_vector gravity;
    mt_damping damping;                 /* of configurations that have none of their own */
    mt_accepted accepted;               /* warnings that the author of the model accepts */
    MT_LIST_OF(mt_interpolant, curves); /* of interp() in expressions */
    MT_LIST_OF(mt_number, nums);
    MT_LIST_OF(mt_parameter, parameters);
    MT_LIST_OF(mt_point, points);
    MT_LIST_OF(mt_body, bodies);
    MT_LIST_OF(mt_link, links);
    MT_LIST_OF(mt_joint, joints);
    MT_LIST_OF(mt_spring, springs); /* springs, then dampers */
    MT_LIST_OF(mt_load, loads);
    MT_LIST_OF(mt_sensor, sensors);
    MT_LIST_OF(mt_named_mode, modes);
    /* never empty after mt_model_resolve, which makes "default" where there is none */
    MT_LIST_OF(mt_configuration, configurations);
    /* by parameter; the model is as if its file had these values */
    MT_LIST_OF(mt_setting, settings);
    const char *sha256; /* of the file's bytes, hexadecimal; NULL: not read from a file */
    int n_included;     /* files that it is made of, too */
    const mt_included *included;
    /* of every number and of other items with a location, sorted by address; 0: not read from a
     * file */
    int n_places;
    mt_place *places;
    struct mt_model_names *tables; /* private: names to indices */
} mt_model;

/* What hinders axes: nothing; x has no length; y or z has none; they are parallel. */
typedef enum mt_axes_fault {
    MT_AXES_SOUND,
    MT_AXES_NO_X,
    MT_AXES_NO_OTHER,
    MT_AXES_PARALLEL
} mt_axes_fault;
/* e[i]: unit vector of axis i, by the values of the model's numbers. */
mt_axes_fault mt_axes_of(const mt_axes *axes, const double *value, double e[3][3]);

/* An empty model (dimension 0). Fails: MT_E_MEMORY. */
mt_status mt_model_new(mt_model **out, mt_err *err);
void mt_model_delete(mt_model *model);
/* Add a number; returns its index, MT_ABSENT when out of memory (mt_model_resolve then
 * fails). */
mt_num mt_model_add_num(mt_model *model, mt_expr expr, mt_addr addr);
/* Lookup function of mt_expr_scope over model->parameters (context: the model). */
int mt_model_lookup(const void *model, const char *name, size_t length);

/* Index by name; MT_ABSENT: none */
int mt_model_find_parameter(const mt_model *model, const char *name);
int mt_model_find_configuration(const mt_model *model, const char *name);
int mt_model_find_mode(const mt_model *model, const char *name);
int mt_model_find_joint(const mt_model *model, const char *name);
int mt_model_find_spring(const mt_model *model, const char *name);
int mt_model_find_sensor(const mt_model *model, const char *name);
/* Line and column in mt_model_file of an address (of a number, a position, a name, a drive);
 * false where it is not known. */
bool mt_model_locate(const mt_model *model, mt_addr addr, int *line, int *column);
/* The file of an address: model->path, or one that is included. */
const char *mt_model_file(const mt_model *model, mt_addr addr);
/* True where the item is present in the configuration. */
bool mt_model_present(const mt_presence *in, int configuration);
const char *mt_joint_type_name(mt_joint_type type);
const char *mt_spring_type_name(mt_spring_type type);

/* mt_kind_lookup of a model. */
mt_kind mt_model_kind(const void *model, int parameter);
/* The SI unit of the dimension of this parameter's unit (a length: m); NULL: none. */
const mt_unit *mt_parameter_si(const mt_parameter *parameter);
/* The unit in which values of this dimension are shown: the file's unit; NULL: SI. */
const mt_unit *mt_model_shown(const mt_model *model, mt_dimension dimension);
/* The unit of a bare number for this parameter, from its own unit or the file's, against which
 * its expressions are checked (mt_kind_complaint). NULL: SI. */
const mt_unit *mt_model_number_unit(const mt_model *model, int parameter);

/* For who reads and resolves a model: its names. */
typedef struct mt_named {
    const char *name; /* not copied */
    int value;
} mt_named;

/* Names to values. */
typedef struct mt_names {
    mt_named *items; /* [count] */
    int count;
    int room;
    mt_sorted order; /* of the names */
} mt_names;

/* One table per name space. Bodies and links share one: both may be given as a body. */
typedef struct mt_model_names {
    mt_names parameters;
    mt_names points;
    mt_names bodies; /* body i: i; link i: -1 - i */
    mt_names joints;
    mt_names springs;
    mt_names loads;
    mt_names sensors;
    mt_names modes;
    mt_names configurations;
} mt_model_names;

/* Add a name. *taken: it exists already and is unchanged. */
void mt_names_add(mt_names *t, mt_arena *mem, const char *name, int value, bool *taken);
/* Value of a name of `length` bytes; *found: it exists. */
int mt_names_find(const mt_names *t, const char *name, size_t length, bool *found);

/* The coordinate of a joint about or along its axis: moved by `drive`, and acted on by loads,
 * torsion springs, gears and racks. */
typedef enum mt_coordinate {
    MT_COORDINATE_NONE,
    MT_COORDINATE_ANGLE,
    MT_COORDINATE_DISPLACEMENT
} mt_coordinate;

/* The part of the vector between two points, one on each body, that the joint makes zero. */
typedef enum mt_closes {
    MT_CLOSES_NOTHING,
    MT_CLOSES_ALL,
    MT_CLOSES_ACROSS, /* the axis */
    MT_CLOSES_ALONG,  /* the axis */
    MT_CLOSES_LENGTH
} mt_closes;

/* Properties of a type of joint; its equations are in mechanics/build.c. */
typedef struct mt_joint_kind {
    bool in[2]; /* exists in two, in three dimensions */
    mt_coordinate coordinate;
    mt_closes closes;
    int least_at; /* number of points */
    int most_at;
    bool axis[2]; /* needed in two and in three dimensions */
    bool axis_b;  /* axis_b needed in three dimensions */
    /* [dimension - 2][body]: uses the body's orientation, which a point mass does not have */
    bool turns[2][2];
    /* [dimension - 2]: what it holds, bits 0 ... 5: along its axes, about them; the axis is the
     * last one (in two dimensions of x and y). Of a universal joint along them alone */
    unsigned holds[2];
    bool couples;        /* couples the coordinates of two joints and has no bodies */
    const char *article; /* before the name of the type; NULL: "a" */
} mt_joint_kind;

/* type: not MT_JOINT_TYPE_COUNT. */
const mt_joint_kind *mt_joint_kind_of(mt_joint_type type);
const char *mt_joint_article(mt_joint_type type);

#endif
