# SPDX-License-Identifier: GPL-3.0-or-later
# Written from the schemas by the target schemas (schemas/python_types.py): do not edit.
"""Types of what the files hold, and of what commands print as JSON (CommandModes, ...), for
editors and checkers of types: Study, Model, Result, ...

    from modetune.types import Study
    study: Study = {"format": "modetune-study/1", "model": "stick.json", "goals": []}

What each member is stands in schemas/README.md. Numbers of models and studies may be texts,
expressions of parameters.
"""
from typing import Dict, List, Literal, Optional, TypedDict, Union

__all__ = [
    "Model", "Study", "Aircraft", "Profile", "Result", "Index", "Progress", "Scene",
    "CommandCheck", "CommandDiff", "CommandExamples", "CommandInfo", "CommandMac",
    "CommandModes", "CommandProfile", "CommandResponse", "CommandSchema", "CommandSensitivity",
    "CommandSimulate", "CommandSweep",
]


class _ModelCurveAlways(TypedDict):
    x: List[float]
    y: List[float]


class ModelCurve(_ModelCurveAlways, total=False):
    """A measured curve, which expressions read as interp(name, x): smooth through its points,
    without rises or falls that they do not have (Steffen's monotone cubics). Outside of its
    points it has no value.
    """

    x_unit: Literal[
        "1", "m", "m^2", "m^3", "m^4", "kg", "kg/m", "kg/m^2", "kg/m^3", "kg m", "kg m^2", "s",
        "1/s", "Hz", "rad", "rad/s", "m/s", "m/s^2", "N", "N/m", "N/m^2", "Pa", "N m", "N m^2",
        "N m/rad", "N s/m", "N m s/rad", "m/rad", "rad/m", "J", "W", "mm", "cm", "in", "ft",
        "deg", "rpm", "mg", "g", "t", "oz", "lb", "slug", "lbf s^2/in", "g/mm", "g/m", "kg/mm",
        "lb/in", "lb/ft", "g/m^2", "g/cm^2", "kg/mm^2", "lb/ft^2", "g/cm^3", "kg/dm^3", "t/m^3",
        "g/mm^3", "kg/cm^3", "kg/mm^3", "t/mm^3", "lb/in^3", "lb/ft^3", "slug/ft^3", "g mm",
        "g cm", "g m", "kg mm", "kg cm", "lb in", "lb ft", "g mm^2", "g cm^2", "kg mm^2",
        "kg cm^2", "t mm^2", "t m^2", "lb in^2", "lb ft^2", "slug ft^2", "lbf in s^2", "um",
        "km", "mm^2", "cm^2", "in^2", "ft^2", "mm^3", "cm^3", "in^3", "ft^3", "mm^4", "cm^4",
        "in^4", "ft^4", "ms", "min", "kHz", "mrad", "mm/s", "in/s", "ft/s", "km/h", "mm/s^2",
        "in/s^2", "ft/s^2", "mN", "daN", "kN", "MN", "lbf", "kip", "kgf", "N/cm", "N/mm",
        "N/um", "kN/m", "kN/mm", "MN/m", "lbf/in", "lbf/ft", "kip/in", "kip/ft", "kPa", "MPa",
        "GPa", "bar", "psi", "ksi", "Msi", "N/mm^2", "kN/mm^2", "kN/m^2", "lbf/in^2",
        "lbf/ft^2", "N mm", "N cm", "kN m", "kN mm", "lbf in", "lbf ft", "N mm^2", "kN m^2",
        "kN mm^2", "N mm/rad", "N cm/rad", "kN m/rad", "kN mm/rad", "MN m/rad", "N m/mrad",
        "lbf in/rad", "lbf ft/rad", "N m/deg", "N mm/deg", "kN m/deg", "lbf in/deg",
        "lbf ft/deg", "N s/mm", "kN s/m", "kN s/mm", "lbf s/in", "lbf s/ft", "N mm s/rad",
        "kN m s/rad", "lbf in s/rad", "lbf ft s/rad", "N m s/deg", "N mm s/deg", "deg/s",
        "mm/rad", "cm/rad", "in/rad", "mm/deg", "rad/mm", "deg/m", "deg/mm", "mJ", "kJ", "kW",
        "%"
    ]
    y_unit: Literal[
        "1", "m", "m^2", "m^3", "m^4", "kg", "kg/m", "kg/m^2", "kg/m^3", "kg m", "kg m^2", "s",
        "1/s", "Hz", "rad", "rad/s", "m/s", "m/s^2", "N", "N/m", "N/m^2", "Pa", "N m", "N m^2",
        "N m/rad", "N s/m", "N m s/rad", "m/rad", "rad/m", "J", "W", "mm", "cm", "in", "ft",
        "deg", "rpm", "mg", "g", "t", "oz", "lb", "slug", "lbf s^2/in", "g/mm", "g/m", "kg/mm",
        "lb/in", "lb/ft", "g/m^2", "g/cm^2", "kg/mm^2", "lb/ft^2", "g/cm^3", "kg/dm^3", "t/m^3",
        "g/mm^3", "kg/cm^3", "kg/mm^3", "t/mm^3", "lb/in^3", "lb/ft^3", "slug/ft^3", "g mm",
        "g cm", "g m", "kg mm", "kg cm", "lb in", "lb ft", "g mm^2", "g cm^2", "kg mm^2",
        "kg cm^2", "t mm^2", "t m^2", "lb in^2", "lb ft^2", "slug ft^2", "lbf in s^2", "um",
        "km", "mm^2", "cm^2", "in^2", "ft^2", "mm^3", "cm^3", "in^3", "ft^3", "mm^4", "cm^4",
        "in^4", "ft^4", "ms", "min", "kHz", "mrad", "mm/s", "in/s", "ft/s", "km/h", "mm/s^2",
        "in/s^2", "ft/s^2", "mN", "daN", "kN", "MN", "lbf", "kip", "kgf", "N/cm", "N/mm",
        "N/um", "kN/m", "kN/mm", "MN/m", "lbf/in", "lbf/ft", "kip/in", "kip/ft", "kPa", "MPa",
        "GPa", "bar", "psi", "ksi", "Msi", "N/mm^2", "kN/mm^2", "kN/m^2", "lbf/in^2",
        "lbf/ft^2", "N mm", "N cm", "kN m", "kN mm", "lbf in", "lbf ft", "N mm^2", "kN m^2",
        "kN mm^2", "N mm/rad", "N cm/rad", "kN m/rad", "kN mm/rad", "MN m/rad", "N m/mrad",
        "lbf in/rad", "lbf ft/rad", "N m/deg", "N mm/deg", "kN m/deg", "lbf in/deg",
        "lbf ft/deg", "N s/mm", "kN s/m", "kN s/mm", "lbf s/in", "lbf s/ft", "N mm s/rad",
        "kN m s/rad", "lbf in s/rad", "lbf ft s/rad", "N m s/deg", "N mm s/deg", "deg/s",
        "mm/rad", "cm/rad", "in/rad", "mm/deg", "rad/mm", "deg/m", "deg/mm", "mJ", "kJ", "kW",
        "%"
    ]
    description: str
    source: str


class _ModelParameterAlways(TypedDict):
    value: "ModelNumber"


class ModelParameter(_ModelParameterAlways, total=False):
    """A parameter with its documentation."""

    unit: Literal[
        "1", "m", "m^2", "m^3", "m^4", "kg", "kg/m", "kg/m^2", "kg/m^3", "kg m", "kg m^2", "s",
        "1/s", "Hz", "rad", "rad/s", "m/s", "m/s^2", "N", "N/m", "N/m^2", "Pa", "N m", "N m^2",
        "N m/rad", "N s/m", "N m s/rad", "m/rad", "rad/m", "J", "W", "mm", "cm", "in", "ft",
        "deg", "rpm", "mg", "g", "t", "oz", "lb", "slug", "lbf s^2/in", "g/mm", "g/m", "kg/mm",
        "lb/in", "lb/ft", "g/m^2", "g/cm^2", "kg/mm^2", "lb/ft^2", "g/cm^3", "kg/dm^3", "t/m^3",
        "g/mm^3", "kg/cm^3", "kg/mm^3", "t/mm^3", "lb/in^3", "lb/ft^3", "slug/ft^3", "g mm",
        "g cm", "g m", "kg mm", "kg cm", "lb in", "lb ft", "g mm^2", "g cm^2", "kg mm^2",
        "kg cm^2", "t mm^2", "t m^2", "lb in^2", "lb ft^2", "slug ft^2", "lbf in s^2", "um",
        "km", "mm^2", "cm^2", "in^2", "ft^2", "mm^3", "cm^3", "in^3", "ft^3", "mm^4", "cm^4",
        "in^4", "ft^4", "ms", "min", "kHz", "mrad", "mm/s", "in/s", "ft/s", "km/h", "mm/s^2",
        "in/s^2", "ft/s^2", "mN", "daN", "kN", "MN", "lbf", "kip", "kgf", "N/cm", "N/mm",
        "N/um", "kN/m", "kN/mm", "MN/m", "lbf/in", "lbf/ft", "kip/in", "kip/ft", "kPa", "MPa",
        "GPa", "bar", "psi", "ksi", "Msi", "N/mm^2", "kN/mm^2", "kN/m^2", "lbf/in^2",
        "lbf/ft^2", "N mm", "N cm", "kN m", "kN mm", "lbf in", "lbf ft", "N mm^2", "kN m^2",
        "kN mm^2", "N mm/rad", "N cm/rad", "kN m/rad", "kN mm/rad", "MN m/rad", "N m/mrad",
        "lbf in/rad", "lbf ft/rad", "N m/deg", "N mm/deg", "kN m/deg", "lbf in/deg",
        "lbf ft/deg", "N s/mm", "kN s/m", "kN s/mm", "lbf s/in", "lbf s/ft", "N mm s/rad",
        "kN m s/rad", "lbf in s/rad", "lbf ft s/rad", "N m s/deg", "N mm s/deg", "deg/s",
        "mm/rad", "cm/rad", "in/rad", "mm/deg", "rad/mm", "deg/m", "deg/mm", "mJ", "kJ", "kW",
        "%"
    ]
    description: str
    source: str
    origin: "ModelOrigin"


class _ModelBodyAlways(TypedDict):
    name: str
    centre: "ModelPosition"


_ModelBodySometimes = TypedDict("_ModelBodySometimes", {
    "mass_kg": "ModelNumber",
    "inertia_kg_m2": Union["ModelNumber", List["ModelNumber"]],
    "axes": "ModelAxes",
    "in": List[str],
    "description": str,
    "source": str,
    "origin": "ModelOrigin",
}, total=False)


class ModelBody(_ModelBodyAlways, _ModelBodySometimes):
    """A rigid body, or without inertia_kg_m2 a point mass."""


class ModelAxes(TypedDict, total=False):
    """Axes of its own, right-handed and at right angles, in the reference position: two
    vectors, x with y or z, or angles; in two dimensions x alone, or one angle. Absent: the
    drawing's.
    """

    x: "ModelVector"
    y: "ModelVector"
    z: "ModelVector"
    angles_rad: Union["ModelNumber", List["ModelNumber"]]
    description: str
    source: str


_ModelLinkAlways = TypedDict("_ModelLinkAlways", {
    "name": str,
    "from": "ModelPosition",
    "to": "ModelPosition",
    "elements": int,
})


_ModelLinkSometimes = TypedDict("_ModelLinkSometimes", {
    "kind": Literal["rigid_elements", "beam"],
    "mass_kg": "ModelNumber",
    "density_kg_per_m3": "ModelNumber",
    "youngs_modulus_pa": "ModelNumber",
    "shear_modulus_pa": "ModelNumber",
    "shear": "ModelShear",
    "rotary_inertia": bool,
    "section": "ModelSection",
    "stiffness_n_m_per_rad": Union["ModelNumber", List["ModelNumber"]],
    "element_length_m": Union["ModelNumber", List["ModelNumber"]],
    "element_mass_kg": Union["ModelNumber", List["ModelNumber"]],
    "element_inertia_kg_m2": Union["ModelNumber", List["ModelNumber"]],
    "hinge_axis": "ModelVector",
    "radius_of_gyration_m": "ModelNumber",
    "loss_factor": "ModelNumber",
    "in": List[str],
    "description": str,
    "source": str,
}, total=False)


class ModelLink(_ModelLinkAlways, _ModelLinkSometimes):
    """A flexible link from one point to another: rigid elements with hinges and torsional
    springs, or beam elements, Euler-Bernoulli's or Timoshenko's.
    """


class _ModelSectionAlways(TypedDict):
    shape: Literal["rectangle", "circle", "tube", "general"]


class ModelSection(_ModelSectionAlways, total=False):
    """Cross-section of a link."""

    width_m: "ModelNumber"
    height_m: "ModelNumber"
    diameter_m: "ModelNumber"
    outer_diameter_m: "ModelNumber"
    inner_diameter_m: "ModelNumber"
    area_m2: "ModelNumber"
    second_moment_m4: "ModelNumber"
    second_moment_other_m4: "ModelNumber"
    torsion_constant_m4: "ModelNumber"
    description: str
    source: str


class _ModelShearAlways(TypedDict):
    coefficient: "ModelNumber"


class ModelShear(_ModelShearAlways, total=False):
    """Beams: Timoshenko's elements, which deform in shear. The shear modulus is the link's, or
    follows from Poisson's ratio.
    """

    coefficient_other: "ModelNumber"
    poissons_ratio: "ModelNumber"
    description: str
    source: str


class ModelCompliance(TypedDict, total=False):
    """What a joint yields: its first body holds, by springs at the joint's point, a carrier
    without mass, on which the joint stands. What the joint holds yields where a stiffness is
    given; what it leaves free stays free. The axes are carried by the first body: the joint's
    `axis` is the last one (in two dimensions the second), and axes.x, across it, the first; a
    joint without `axis` has `axes` as a bushing has (absent: the drawing's).
    """

    axes: "ModelAxes"
    stiffness_n_per_m: List["ModelNumber"]
    stiffness_n_m_per_rad: Union["ModelNumber", List["ModelNumber"]]
    damping_n_s_per_m: List["ModelNumber"]
    damping_n_m_s_per_rad: Union["ModelNumber", List["ModelNumber"]]
    loss_factor: Union["ModelNumber", List["ModelNumber"]]
    description: str
    source: str


class _ModelJointAlways(TypedDict):
    name: str
    type: Literal[
        "fixed", "revolute", "prismatic", "pin-in-slot", "distance", "cylindrical", "spherical",
        "universal", "planar", "point-on-line", "point-on-plane", "orientation", "gear", "rack"
    ]


_ModelJointSometimes = TypedDict("_ModelJointSometimes", {
    "bodies": List[str],
    "at": "ModelAt",
    "axis": "ModelVector",
    "axis_b": "ModelVector",
    "length_m": "ModelNumber",
    "mass_kg": "ModelNumber",
    "joints": List[str],
    "ratio": "ModelNumber",
    "ratio_m_per_rad": "ModelNumber",
    "compliance": "ModelCompliance",
    "in": List[str],
    "description": str,
    "source": str,
}, total=False)


class ModelJoint(_ModelJointAlways, _ModelJointSometimes):
    """A joint between two bodies."""


class _ModelSpringAlways(TypedDict):
    name: str
    type: Literal["torsion", "axial", "bar", "bushing"]


_ModelSpringSometimes = TypedDict("_ModelSpringSometimes", {
    "bodies": List[str],
    "joint": str,
    "at": "ModelAt",
    "axes": "ModelAxes",
    "stiffness_n_per_m": Union["ModelNumber", List["ModelNumber"]],
    "stiffness_n_m_per_rad": Union["ModelNumber", List["ModelNumber"]],
    "in": List[str],
    "description": str,
    "source": str,
    "free_length_m": "ModelNumber",
    "free_angle_rad": "ModelNumber",
    "preload_n": "ModelNumber",
    "preload_n_m": "ModelNumber",
    "youngs_modulus_pa": "ModelNumber",
    "area_m2": "ModelNumber",
    "density_kg_per_m3": "ModelNumber",
    "loss_factor": Union["ModelNumber", List["ModelNumber"]],
    "stiffness_matrix": List[List["ModelNumber"]],
}, total=False)


class ModelSpring(_ModelSpringAlways, _ModelSpringSometimes):
    """A spring."""


class _ModelDamperAlways(TypedDict):
    name: str
    type: Literal["torsion", "axial", "bushing"]


_ModelDamperSometimes = TypedDict("_ModelDamperSometimes", {
    "bodies": List[str],
    "joint": str,
    "at": "ModelAt",
    "axes": "ModelAxes",
    "damping_n_s_per_m": Union["ModelNumber", List["ModelNumber"]],
    "damping_n_m_s_per_rad": Union["ModelNumber", List["ModelNumber"]],
    "in": List[str],
    "description": str,
    "source": str,
}, total=False)


class ModelDamper(_ModelDamperAlways, _ModelDamperSometimes):
    """A viscous damper."""


class _ModelSensorAlways(TypedDict):
    name: str
    on: str


class ModelSensor(_ModelSensorAlways, total=False):
    """A sensor."""

    at: "ModelPosition"
    fraction: "ModelNumber"
    directions: List[Literal["x", "y", "z", "rx", "ry", "rz", "r"]]
    description: str
    source: str


class _ModelModeAlways(TypedDict):
    configuration: str
    index: int


class ModelMode(_ModelModeAlways, total=False):
    """A vibration mode of the original design."""

    description: str
    source: str


class ModelConfiguration(TypedDict, total=False):
    """A state of the mechanism."""

    like: str
    parameters: Dict[str, "ModelNumber"]
    gravity_m_per_s2: "ModelVector"
    drive: Union["ModelDrive", List["ModelDrive"]]
    damping: "ModelDamping"
    description: str
    source: str


class _ModelDriveAlways(TypedDict):
    joint: str


class ModelDrive(_ModelDriveAlways, total=False):
    """A joint that is put to a position."""

    position_rad: "ModelNumber"
    position_m: "ModelNumber"
    hold: Union[Literal["lock"], "ModelHold"]
    free: bool
    description: str
    source: str


class _ModelHoldAlways(TypedDict):
    trim: str


class ModelHold(_ModelHoldAlways, total=False):
    """A spring holds the position."""

    description: str
    source: str


class _ModelLoadAlways(TypedDict):
    name: str


_ModelLoadSometimes = TypedDict("_ModelLoadSometimes", {
    "on": str,
    "joint": str,
    "at": "ModelPosition",
    "force_n": Union["ModelNumber", "ModelVector"],
    "moment_n_m": Union["ModelNumber", List["ModelNumber"]],
    "in": List[str],
    "description": str,
    "source": str,
}, total=False)


class ModelLoad(_ModelLoadAlways, _ModelLoadSometimes):
    """A dead load on a body, or on a joint."""


class ModelUnits(TypedDict, total=False):
    """Units of numbers whose member names none. Members that end in a unit (_m, _rad, _hz) and
    parameters that have one stay in that. Expressions (strings) are always in SI units:
    "150*mm", "10*deg" say otherwise.
    """

    length: Literal["m", "mm", "cm", "in", "ft"]
    angle: Literal["rad", "deg"]
    speed: Literal["Hz", "rpm"]


class ModelDamping(TypedDict, total=False):
    """Damping besides dampers and loss factors: C = mass_per_s M + stiffness_s K + M Phi diag(2
    ratio_j omega_j) Phi^T M. That of a configuration takes the place of all of the one that it
    would inherit.
    """

    ratio: "ModelNumber"
    ratios: List["ModelNumber"]
    modes: Dict[str, "ModelNumber"]
    mass_per_s: "ModelNumber"
    stiffness_s: "ModelNumber"
    description: str
    source: str


class _ModelIncludeAlways(TypedDict):
    file: str
    prefix: str


class ModelInclude(_ModelIncludeAlways, total=False):
    """A sub-assembly: the parameters, curves, points, bodies, links, joints, springs, dampers,
    loads and sensors of another model file, in that file's units. Its gravity, damping, modes
    and configurations are for itself alone.
    """

    at: "ModelPosition"
    rotate: "ModelRotate"
    parameters: Dict[str, "ModelNumber"]
    ground: str
    description: str


class _ModelRotateAlways(TypedDict):
    angle_rad: "ModelNumber"


class ModelRotate(_ModelRotateAlways, total=False):
    """Turned about an axis through its origin."""

    axis: List[float]


class _ModelRepeatAlways(TypedDict):
    of: List[str]


class ModelRepeat(_ModelRepeatAlways, total=False):
    """Copies of items, numbered from 2, since the first is the item itself: mount, mount_2,
    mount_3; mirrored: mount, mount_m.
    """

    polar: "ModelPolar"
    linear: "ModelLinear"
    mirror: "ModelMirror"
    kinds: List[
        Literal["points", "bodies", "links", "joints", "springs", "dampers", "loads", "sensors"]
    ]
    count: int
    suffix: str
    description: str


class ModelPolar(TypedDict, total=False):
    """Copies around an axis."""

    axis: List[float]
    about: "ModelPosition"
    angle_rad: "ModelNumber"


class ModelLinear(TypedDict):
    """Copies along a line."""

    step: "ModelVector"


class ModelMirror(TypedDict, total=False):
    """A copy on the other side of a plane."""

    plane: Literal["xy", "xz", "yz"]
    normal: List[float]
    about: "ModelPosition"


class _ModelAlways(TypedDict):
    format: Literal["modetune-model/1"]
    dimension: Literal[2, 3]


_ModelSometimes = TypedDict("_ModelSometimes", {
    "$schema": str,
    "name": str,
    "description": str,
    "source": str,
    "accepted": List[
        Literal["angle", "band", "bounds", "bushing", "damping", "density", "drive", "dropped",
        "frequency", "gap", "gravity", "inertia", "level", "margin", "mass", "modulus",
        "no_effect", "off", "reference", "section", "size", "speed", "speed_range", "spread",
        "spring", "target", "tolerance", "unit", "weight"]
    ],
    "units": "ModelUnits",
    "include": List["ModelInclude"],
    "repeat": List["ModelRepeat"],
    "gravity_m_per_s2": "ModelVector",
    "curves": Dict[str, "ModelCurve"],
    "parameters": Dict[str, Union["ModelNumber", "ModelParameter"]],
    "points": Dict[str, "ModelVector"],
    "bodies": List["ModelBody"],
    "links": List["ModelLink"],
    "joints": List["ModelJoint"],
    "springs": List["ModelSpring"],
    "dampers": List["ModelDamper"],
    "loads": List["ModelLoad"],
    "damping": "ModelDamping",
    "sensors": List["ModelSensor"],
    "modes": Dict[str, "ModelMode"],
    "configurations": Dict[str, "ModelConfiguration"],
}, total=False)


class Model(_ModelAlways, _ModelSometimes):
    """One mechanism: bodies, flexible links, joints and springs in their reference position,
    and its configurations. SI units, global coordinates.
    """


class StudyUnits(TypedDict, total=False):
    """Units of numbers that are values of parameters (bounds, catalogues, scales, values of a
    trade study, published values) and that people are shown them in. Absent: of each
    parameter's own unit in the model. Members that end in a unit stay in that. Expressions
    (strings) are always in SI units: "150*mm", "10*deg" say otherwise.
    """

    length: Literal["m", "mm", "cm", "in", "ft"]
    angle: Literal["rad", "deg"]
    speed: Literal["Hz", "rpm"]


class StudySearch(TypedDict, total=False):
    """How the search runs."""

    seed: int
    starts: int
    max_evaluations: int
    max_modal_solutions: int
    proof_s: "StudyNumber"
    description: str
    source: str


class _StudySpreadAlways(TypedDict):
    factor: "StudyNumber"


class StudySpread(_StudySpreadAlways, total=False):
    """How far the best design of a misfit moves under other weights: each weighted goal's
    weight is multiplied and divided by the factor in turn and the misfit minimised again. It is
    a sensitivity to the weights, not an uncertainty: repeated noisy tests may scatter many
    times more.
    """

    description: str
    source: str


class StudyVariable(TypedDict, total=False):
    """A parameter that the study may change: within two bounds, or to an entry of a catalogue;
    or several that a row of a catalogue of parts sets together.
    """

    parameter: str
    parameters: Union[List[str], Dict[str, Union[str, List[str]]]]
    lower: "StudyNumber"
    upper: "StudyNumber"
    catalogue: Union[List["StudyNumber"], "StudyCatalogue", str]
    weight: "StudyNumber"
    scale: "StudyNumber"
    tolerance_percent: "StudyNumber"
    description: str
    source: str


class StudyReference(TypedDict, total=False):
    """Modes to compare with: those of a configuration of another model, or measured ones."""

    model: str
    modes: List["StudyMeasuredMode"]
    configuration: str
    description: str
    source: str


class StudyMeasuredMode(TypedDict, total=False):
    """A measured mode: its frequency, its shape at sensors, or both."""

    frequency_hz: "StudyNumber"
    shape: Dict[str, "StudyNumber"]
    description: str
    source: str


class _StudyMeasurementAlways(TypedDict):
    file: str


class StudyMeasurement(_StudyMeasurementAlways, total=False):
    """A file of measured frequency responses: a table (CSV), or a universal file with datasets
    58.
    """

    dataset: int
    response_node: str
    reference_node: str
    factor: "StudyNumber"
    description: str
    source: str


class _StudyRotorAlways(TypedDict):
    harmonics: List[str]


class StudyRotor(_StudyRotorAlways, total=False):
    """A rotor whose harmonics are forbidden: an aircraft of the catalogue, or a speed."""

    aircraft: str
    speed_hz: "StudyNumber"
    speed_rpm: "StudyNumber"
    blades: int
    tail: "StudyTailRotor"
    name: str
    speed_range: "StudyPair"
    margin_percent: "StudyNumber"
    description: str
    source: str


class StudyTailRotor(TypedDict, total=False):
    """The tail rotor."""

    speed_hz: "StudyNumber"
    speed_rpm: "StudyNumber"
    blades: int
    description: str
    source: str


class StudyMachine(TypedDict, total=False):
    """A machine (engine, pump, gearbox) whose orders are forbidden over its range of speeds:
    events per turn of its shaft, and gear meshes.
    """

    speed_hz: "StudyNumber"
    speed_range_hz: "StudyPair"
    speed_range: "StudyPair"
    name: str
    orders: List[str]
    gears: List["StudyGear"]
    margin_percent: "StudyNumber"
    description: str
    source: str


class _StudyGearAlways(TypedDict):
    teeth: int


class StudyGear(_StudyGearAlways, total=False):
    """A gear of a machine: it meshes teeth times ratio times per turn of the machine."""

    ratio: "StudyNumber"
    orders: List[str]
    sidebands: int
    name: str
    description: str
    source: str


class _StudyCatalogueAlways(TypedDict):
    lower: "StudyNumber"
    upper: "StudyNumber"


class StudyCatalogue(_StudyCatalogueAlways, total=False):
    """The values of an E series of IEC 60063, or steps from the lower bound, between two bounds
    (included); at most 10000.
    """

    series: Literal["E3", "E6", "E12", "E24", "E48", "E96", "E192"]
    step: "StudyNumber"
    description: str
    source: str


class StudyParts(TypedDict, total=False):
    """Parts that come with several numbers at once: a row is chosen whole."""

    file: str
    columns: List[str]
    units: List[str]
    rows: List[List[float]]
    names: List[str]
    tolerance_percent: List[Optional["StudyNumber"]]
    description: str
    source: str


class _StudyTradeAlways(TypedDict):
    vary: List["StudyVary"]


class StudyTrade(_StudyTradeAlways, total=False):
    """A trade study: one or two quantities take each of their values, and every such study is
    answered by its best design.
    """

    objectives: List[Literal["change", "mass", "misfit", "clearance", "vibration"]]
    description: str
    source: str


class _StudyVaryAlways(TypedDict):
    values: Union[List["StudyNumber"], "StudySpan"]


class StudyVary(_StudyVaryAlways, total=False):
    """A quantity that varies: a bound of a variable, a number of a goal, or a parameter."""

    variable: str
    goal: int
    parameter: str
    bound: Literal["lower", "upper"]
    member: Literal[
        "target_hz", "at_least_hz", "at_most_hz", "at_least", "target", "at_most", "equals",
        "margin_percent", "at_least_percent", "at_most_percent"
    ]
    description: str
    source: str


_StudySpanAlways = TypedDict("_StudySpanAlways", {
    "from": "StudyNumber",
    "to": "StudyNumber",
    "count": int,
})


class StudySpan(_StudySpanAlways):
    """Values at equal distances."""


class StudyObjective(TypedDict, total=False):
    """What decides between designs that meet the goals."""

    minimise: str
    maximise: Literal["clearance"]
    of: List[str]
    description: str
    source: str


class _StudyResponseAlways(TypedDict):
    input: str
    output: str
    band_hz: "StudyPair"


class StudyResponse(_StudyResponseAlways, total=False):
    """What a forced vibration is caused by, and what it is seen in."""

    configuration: str
    profile: str
    description: str
    source: str


class StudyPublished(TypedDict, total=False):
    """A published number to compare with: a parameter, a quantity, a frequency, a MAC, or the
    study's status.
    """

    parameter: str
    quantity: str
    frequency: "StudyPublishedFrequency"
    mac: "StudyPublishedMac"
    status: Literal["solved", "compromise", "infeasible", "fitted"]
    value: "StudyNumber"
    at_least: "StudyNumber"
    at_most: "StudyNumber"
    tolerance: "StudyNumber"
    tolerance_percent: "StudyNumber"
    design: Literal["recommended", "original"]
    role: Literal["verifies", "calibrates", "not_comparable"]
    label: str
    description: str
    source: str


class _StudyPublishedFrequencyAlways(TypedDict):
    mode: "StudyMode"


class StudyPublishedFrequency(_StudyPublishedFrequencyAlways, total=False):
    """Which natural frequency was published."""

    configuration: str


class _StudyPublishedMacAlways(TypedDict):
    mode: "StudyMode"
    reference: str


class StudyPublishedMac(_StudyPublishedMacAlways, total=False):
    """Which MAC was published."""

    configuration: str
    reference_mode: "StudyIndex"


class _StudyGoalOfAlways(TypedDict):
    mode: "StudyMode"


class StudyGoalOf(_StudyGoalOfAlways, total=False):
    """The mode whose frequency a ratio is divided by."""

    configuration: str


class _StudyGoalFrequencyAlways(TypedDict):
    type: Literal["frequency"]
    mode: "StudyMode"


class StudyGoalFrequency(_StudyGoalFrequencyAlways, total=False):
    """A natural frequency: equal to a target or to that of a reference, or within limits."""

    description: str
    source: str
    tolerance_percent: "StudyNumber"
    configuration: str
    configurations: List[str]
    target_hz: "StudyNumber"
    reference: str
    reference_mode: "StudyIndex"
    at_least_hz: "StudyNumber"
    at_most_hz: "StudyNumber"
    weight: "StudyNumber"


class _StudyGoalShapeAlways(TypedDict):
    type: Literal["shape"]
    mode: "StudyMode"
    reference: str
    weight: "StudyNumber"


class StudyGoalShape(_StudyGoalShapeAlways, total=False):
    """A mode shape close to a reference's: a residual of the objective "misfit" (difference of
    unit vectors at the common sensors).
    """

    description: str
    source: str
    tolerance_percent: "StudyNumber"
    configuration: str
    configurations: List[str]
    reference_mode: "StudyIndex"
    length_m: "StudyNumber"


class _StudyGoalMacAlways(TypedDict):
    type: Literal["mac"]
    mode: "StudyMode"
    reference: str
    at_least: "StudyNumber"


class StudyGoalMac(_StudyGoalMacAlways, total=False):
    """A modal assurance criterion with a reference's shape."""

    description: str
    source: str
    tolerance_percent: "StudyNumber"
    configuration: str
    configurations: List[str]
    reference_mode: "StudyIndex"
    length_m: "StudyNumber"


class _StudyGoalDampingAlways(TypedDict):
    type: Literal["damping"]
    mode: "StudyMode"


class StudyGoalDamping(_StudyGoalDampingAlways, total=False):
    """The damping ratio of a complex mode: at a target, or within limits. No proof covers it.
    """

    description: str
    source: str
    tolerance_percent: "StudyNumber"
    configuration: str
    configurations: List[str]
    target: "StudyNumber"
    at_least: "StudyNumber"
    at_most: "StudyNumber"
    weight: "StudyNumber"


class _StudyGoalEnergyAlways(TypedDict):
    type: Literal["energy"]
    mode: "StudyMode"


class StudyGoalEnergy(_StudyGoalEnergyAlways, total=False):
    """The share of a mode's energy that a body has in a direction, or a spring: how far modes
    are decoupled. No proof covers it.
    """

    description: str
    source: str
    tolerance_percent: "StudyNumber"
    configuration: str
    configurations: List[str]
    body: str
    spring: str
    direction: Literal["x", "y", "z", "rx", "ry", "rz"]
    directions: List[str]
    component: Literal["x", "y", "z", "rx", "ry", "rz"]
    about: str
    axes: Literal["global", "principal", "torque_roll_x", "torque_roll_y", "torque_roll_z"]
    at_least_percent: "StudyNumber"
    at_most_percent: "StudyNumber"


class _StudyGoalResponseAlways(TypedDict):
    type: Literal["response"]
    input: str
    output: str


class StudyGoalResponse(_StudyGoalResponseAlways, total=False):
    """A limit on a frequency response: the amplitude of an output for an input of 1, at one
    frequency or the largest over a band.
    """

    description: str
    source: str
    tolerance_percent: "StudyNumber"
    configuration: str
    configurations: List[str]
    target: "StudyNumber"
    at_least: "StudyNumber"
    at_most: "StudyNumber"
    weight: "StudyNumber"
    band_hz: "StudyPair"
    at_hz: "StudyNumber"


class _StudyGoalVibrationAlways(TypedDict):
    type: Literal["vibration"]
    output: str
    profile: str


class StudyGoalVibration(_StudyGoalVibrationAlways, total=False):
    """A limit on the vibration of an output under a vibration profile."""

    description: str
    source: str
    tolerance_percent: "StudyNumber"
    configuration: str
    configurations: List[str]
    input: str
    target: "StudyNumber"
    at_least: "StudyNumber"
    at_most: "StudyNumber"
    weight: "StudyNumber"
    quantity: Literal["rms", "sine", "peak"]


class _StudyGoalFrequencyResponseAlways(TypedDict):
    type: Literal["frequency_response"]
    input: str
    output: str
    measurement: str
    weight: "StudyNumber"


class StudyGoalFrequencyResponse(_StudyGoalFrequencyResponseAlways, total=False):
    """A frequency response close to a measured one: residuals of the objective "misfit",
    ln(response/measured) at each of the measured frequencies, each with 1/N of the weight.
    """

    description: str
    source: str
    tolerance_percent: "StudyNumber"
    configuration: str
    configurations: List[str]
    band_hz: "StudyPair"
    coherence: bool


class _StudyGoalStaticAlways(TypedDict):
    type: Literal["static"]
    output: str


class StudyGoalStatic(_StudyGoalStaticAlways, total=False):
    """A displacement or a force of the mechanism at rest, under gravity, preload and loads: at
    a target, or within limits. No proof covers it.
    """

    description: str
    source: str
    tolerance_percent: "StudyNumber"
    configuration: str
    configurations: List[str]
    input: str
    quantity: Literal["compliance", "stiffness"]
    against: str
    target: "StudyNumber"
    at_least: "StudyNumber"
    at_most: "StudyNumber"
    weight: "StudyNumber"


class _StudyGoalLimitAlways(TypedDict):
    type: Literal["limit"]
    expression: str


class StudyGoalLimit(_StudyGoalLimitAlways, total=False):
    """A limit on an expression of the parameters."""

    description: str
    source: str
    tolerance_percent: "StudyNumber"
    at_least: "StudyNumber"
    at_most: "StudyNumber"
    equals: "StudyNumber"


class _StudyGoalAvoidAlways(TypedDict):
    type: Literal["avoid"]


class StudyGoalAvoid(_StudyGoalAvoidAlways, total=False):
    """Forbidden frequency bands: every mode keeps clear of them. Bands that overlap are merged.
    """

    description: str
    source: str
    tolerance_percent: "StudyNumber"
    configuration: str
    configurations: List[str]
    bands_hz: List["StudyPair"]
    rotor: "StudyRotor"
    rotors: List["StudyRotor"]
    machine: "StudyMachine"
    machines: List["StudyMachine"]
    margin_percent: "StudyNumber"
    up_to_hz: "StudyNumber"
    cluster: int


class _StudyGoalRatioAlways(TypedDict):
    type: Literal["ratio"]
    mode: "StudyMode"
    of: "StudyGoalOf"


class StudyGoalRatio(_StudyGoalRatioAlways, total=False):
    """The frequency of a mode divided by that of another mode, or of a mode in another
    configuration: at a target, or within limits.
    """

    description: str
    source: str
    tolerance_percent: "StudyNumber"
    configuration: str
    configurations: List[str]
    target: "StudyNumber"
    at_least: "StudyNumber"
    at_most: "StudyNumber"
    weight: "StudyNumber"


class _StudyGoalApartAlways(TypedDict):
    type: Literal["apart"]


class StudyGoalApart(_StudyGoalApartAlways, total=False):
    """Modes of one configuration whose frequencies are apart."""

    description: str
    source: str
    tolerance_percent: "StudyNumber"
    configuration: str
    configurations: List[str]
    modes: List["StudyMode"]
    up_to_mode: int
    at_least_percent: "StudyNumber"
    at_least_hz: "StudyNumber"


class _StudyAlways(TypedDict):
    format: Literal["modetune-study/1"]
    model: str


_StudySometimes = TypedDict("_StudySometimes", {
    "$schema": str,
    "name": str,
    "description": str,
    "source": str,
    "author": str,
    "revision": str,
    "date": str,
    "accepted": List[
        Literal["angle", "band", "bounds", "bushing", "damping", "density", "drive", "dropped",
        "frequency", "gap", "gravity", "inertia", "level", "margin", "mass", "modulus",
        "no_effect", "off", "reference", "section", "size", "speed", "speed_range", "spread",
        "spring", "target", "tolerance", "unit", "weight"]
    ],
    "units": "StudyUnits",
    "catalogues": Dict[str, "StudyParts"],
    "variables": List["StudyVariable"],
    "goals": List["StudyGoal"],
    "objective": Union[List["StudyObjective"], "StudyObjective"],
    "references": Dict[str, "StudyReference"],
    "measurements": Dict[str, "StudyMeasurement"],
    "recommendations": int,
    "search": "StudySearch",
    "spread": "StudySpread",
    "aircraft": str,
    "trade": "StudyTrade",
    "responses": List["StudyResponse"],
    "published": List["StudyPublished"],
}, total=False)


class Study(_StudyAlways, _StudySometimes):
    """A question asked of a mechanism: which parameters may change, which natural frequencies
    and shapes are wanted, what is known already.
    """


class _AircraftAircraftAlways(TypedDict):
    name: str
    main: "AircraftRotor"


class AircraftAircraft(_AircraftAircraftAlways, total=False):
    """An aircraft: its main rotor (rotors, where several turn alike) and its tail rotor."""

    description: str
    source: str
    tail: "AircraftRotor"


class _AircraftRotorAlways(TypedDict):
    blades: "AircraftBlades"


class AircraftRotor(_AircraftRotorAlways, total=False):
    """A rotor: its nominal speed and its blades."""

    speed_hz: "AircraftSpeed"
    speed_rpm: "AircraftSpeed"
    description: str


class _AircraftSpeedAlways(TypedDict):
    value: float
    source: str
    confirmed: bool


class AircraftSpeed(_AircraftSpeedAlways, total=False):
    """A speed, and who says so."""

    description: str


class _AircraftBladesAlways(TypedDict):
    value: int
    source: str
    confirmed: bool


class AircraftBlades(_AircraftBladesAlways, total=False):
    """A number of blades, and who says so."""

    description: str


class _AircraftAlways(TypedDict):
    format: Literal["modetune-aircraft/1"]
    aircraft: List["AircraftAircraft"]


_AircraftSometimes = TypedDict("_AircraftSometimes", {
    "$schema": str,
    "description": str,
    "source": str,
    "accepted": List[
        Literal["angle", "band", "bounds", "bushing", "damping", "density", "drive", "dropped",
        "frequency", "gap", "gravity", "inertia", "level", "margin", "mass", "modulus",
        "no_effect", "off", "reference", "section", "size", "speed", "speed_range", "spread",
        "spring", "target", "tolerance", "unit", "weight"]
    ],
}, total=False)


class Aircraft(_AircraftAlways, _AircraftSometimes):
    """A catalogue of aircraft for studies that avoid the harmonics of rotors: speeds and
    numbers of blades, each with its source.
    """


class ProfileRandom(TypedDict, total=False):
    """Stationary random acceleration by the breakpoints of its one-sided density: straight
    lines in log-log scales, 0 outside.
    """

    psd_g2_per_hz: "ProfileBreakpoints"
    psd_m2_per_s3: "ProfileBreakpoints"
    published_rms_g: float
    origin: "ProfileOrigin"
    source: str
    description: str


class ProfileSlope(TypedDict):
    """A breakpoint whose density follows from a slope: from the breakpoint before it or, in
    front of the first density, from the one after it.
    """

    frequency_hz: float
    slope_db_per_octave: float


class ProfileTone(TypedDict, total=False):
    """A sine whose frequency may lie anywhere within a range, or one for each harmonic of a
    rotor.
    """

    frequency_hz: "ProfilePair"
    rotor: "ProfileRotor"
    acceleration_g: float
    acceleration_m_per_s2: float
    origin: "ProfileOrigin"
    source: str
    description: str


class ProfileCombine(TypedDict, total=False):
    """The combined peak is sigma times the RMS of the random response, and the peaks of the
    tones by a rule.
    """

    tones: Literal["sum", "largest", "root_sum_square"]
    sigma: float
    description: str


class _ProfileRotorAlways(TypedDict):
    harmonics: List[str]


class ProfileRotor(_ProfileRotorAlways, total=False):
    """A rotor that excites at its harmonics: an aircraft of the catalogue, or a speed."""

    aircraft: str
    speed_hz: float
    speed_rpm: float
    blades: int
    tail: "ProfileTailRotor"
    name: str
    speed_range: "ProfilePair"
    description: str
    source: str


class ProfileTailRotor(TypedDict, total=False):
    """The tail rotor."""

    speed_hz: float
    speed_rpm: float
    blades: int
    description: str
    source: str


class _ProfileAlways(TypedDict):
    format: Literal["modetune-profile/1"]


_ProfileSometimes = TypedDict("_ProfileSometimes", {
    "$schema": str,
    "name": str,
    "description": str,
    "source": str,
    "accepted": List[
        Literal["angle", "band", "bounds", "bushing", "damping", "density", "drive", "dropped",
        "frequency", "gap", "gravity", "inertia", "level", "margin", "mass", "modulus",
        "no_effect", "off", "reference", "section", "size", "speed", "speed_range", "spread",
        "spring", "target", "tolerance", "unit", "weight"]
    ],
    "aircraft": str,
    "axis": Literal["x", "y", "z"],
    "random": Union["ProfileRandom", List["ProfileRandom"]],
    "tones": List["ProfileTone"],
    "combine": "ProfileCombine",
}, total=False)


class Profile(_ProfileAlways, _ProfileSometimes):
    """A vibration profile: the acceleration of a base, as random parts, tones, or both (sine on
    random). Numbers are plain; expressions are not allowed.
    """


class ResultFile(TypedDict):
    """A file that was read."""

    name: Optional[str]
    file: str


class ResultDoubt(TypedDict):
    """A fact or a doubt, with its place in a file where that is known."""

    kind: str
    text: str
    configuration: Optional[str]
    file: Optional[str]
    line: Optional[int]
    column: Optional[int]
    pointer: Optional[str]


class ResultDesignObjective(TypedDict):
    """An objective's values. A clearance is the least distance from a band with its margin, as
    a ratio of frequencies less 1; "clearance_percent" is that from the edges without it.
    """

    text: str
    unit: Optional[str]
    original: Optional[float]
    recommended: Optional[float]


class ResultRow(TypedDict):
    """A mode of the configuration."""

    mode: int
    values: List[Optional[float]]


class ResultMacMatrice(TypedDict):
    """A configuration beside a reference."""

    configuration: str
    reference: str
    reference_modes: List[Optional[float]]
    rows: List["ResultRow"]


class _ResultDesignAlways(TypedDict):
    rank: int
    feasible: bool
    grade: Optional[str]
    score: Optional[float]
    objectives: List["ResultDesignObjective"]
    change: Optional[float]
    misfit: Optional[float]
    violation_percent: Optional[float]
    clearance_percent: Optional[float]
    kkt_residual: Optional[float]
    worst_case: Optional[Literal["proven", "sampled"]]
    singular: bool
    parameters: List["ResultParameter"]
    frequencies: List["ResultFrequency"]
    clearances: List["ResultClearance"]
    gap_assignment: Optional[List["ResultGap"]]
    motion: List["ResultMotion"]
    tolerance_box: Optional["ResultToleranceBox"]
    goals: List["ResultGoal"]
    reasons: List["ResultReason"]


class ResultDesign(_ResultDesignAlways, total=False):
    """A design, judged."""

    mac_matrices: List["ResultMacMatrice"]
    responses: List["ResultResponse"]
    responses_between: List["ResultResponseBetween"]
    curves: List["ResultDesignCurve"]


class _ResultParameterAlways(TypedDict):
    name: str
    unit: Optional[str]
    original: Optional[float]
    recommended: Optional[float]
    change_percent: Optional[float]
    at_bound: Optional[Literal["lower", "upper"]]
    measure: Literal["logarithmic", "logarithmic with floor", "linear"]
    measure_floor: Optional[float]
    measure_scale: Optional[float]


class ResultParameter(_ResultParameterAlways, total=False):
    """A parameter that the study may change."""

    display_unit: Optional[str]
    display_factor: Optional[float]
    lower: Optional[float]
    upper: Optional[float]
    catalogue: str
    part: str


class ResultFrequency(TypedDict):
    """A natural frequency that the goals ask about."""

    configuration: str
    mode: int
    name: Optional[str]
    identity: Optional[Literal["tracked", "ambiguous", "lost"]]
    share: Optional[float]
    rival_mode: Optional[int]
    rival_share: Optional[float]
    original_hz: Optional[float]
    recommended_hz: Optional[float]
    target_hz: Optional[float]
    at_least_hz: Optional[float]
    at_most_hz: Optional[float]
    error_percent: Optional[float]
    lowest_hz: Optional[float]
    highest_hz: Optional[float]
    reference: Optional[str]
    mac: Optional[float]
    repeated: bool
    sensitivity: Optional[Dict[str, Optional[float]]]
    residual: Optional[float]
    orthogonality: Optional[float]


class ResultClearance(TypedDict):
    """A mode beside a band."""

    configuration: str
    band: str
    band_id: int
    mode: int
    hz: Optional[float]
    percent: Optional[float]
    margin_percent: Optional[float]
    worst_hz: Optional[float]
    worst_percent: Optional[float]
    side: Literal["below", "inside", "above"]


class ResultGap(TypedDict):
    """How many modes lie below a band."""

    id: int
    configuration: str
    band: str
    lower_hz: Optional[float]
    upper_hz: Optional[float]
    margin_lower_hz: Optional[float]
    margin_upper_hz: Optional[float]
    modes_below: int


_ResultMotionAlways = TypedDict("_ResultMotionAlways", {
    "goal": str,
    "drive": str,
    "unit": Literal["rad", "m"],
    "from": Optional[float],
    "to": Optional[float],
    "positions": int,
    "least_clearance_percent": Optional[float],
    "margin_percent": Optional[float],
    "at": Optional[float],
    "hz": Optional[float],
    "mode": Optional[int],
    "band": Optional[str],
    "band_id": Optional[int],
    "crosses": bool,
    "grade": Literal["sampled", "sampled coarsely", "incomplete", "unstable", "not followed"],
    "text": str,
})


class ResultMotion(_ResultMotionAlways, total=False):
    """A design between the named positions of one drive."""

    display_unit: Optional[str]
    display_factor: Optional[float]


class ResultPerVariable(TypedDict):
    """One variable."""

    name: str
    percent: Optional[float]
    edge: Optional[str]


class ResultToleranceBox(TypedDict):
    """How much the variables may change with every band, without its margin, still kept."""

    all_percent: Optional[float]
    edge: Optional[str]
    proven: bool
    per_variable: List["ResultPerVariable"]


class _ResultGoalAlways(TypedDict):
    goal: str
    pointer: str
    type: Literal[
        "frequency", "shape", "mac", "damping", "energy", "response", "vibration",
        "frequency_response", "static", "limit", "avoid", "ratio", "apart"
    ]
    configuration: Optional[str]
    mode: Optional[int]
    name: Optional[str]
    reference: Optional[str]
    expression: Optional[str]
    unit: Optional[str]
    value: Optional[float]
    target: Optional[float]
    at_least: Optional[float]
    at_most: Optional[float]
    tolerance_percent: Optional[float]
    worst: Optional[float]
    worst_at: Optional[Dict[str, Optional[float]]]
    violation_percent: Optional[float]
    met: bool
    weighted: bool
    doubtful: bool


class ResultGoal(_ResultGoalAlways, total=False):
    """A goal, judged at this design."""

    quantity: str
    of_configuration: str
    of_mode: int
    of_name: str
    display_unit: Optional[str]
    display_factor: Optional[float]
    sensitivity: Optional[Dict[str, Optional[float]]]
    off_most_hz: Optional[float]
    off_most_ratio: Optional[float]
    off_most_phase_deg: Optional[float]


class ResultResponse(TypedDict):
    """How large a forced vibration is."""

    goal: str
    configuration: str
    input: str
    output: str
    profile: Optional[str]
    quantity: Literal["response", "rms", "sine", "peak"]
    unit: str
    value: Optional[float]
    error_at_most: Optional[float]
    frequency_hz: Optional[float]
    at_edge: bool
    lower_hz: Optional[float]
    upper_hz: Optional[float]
    end: Literal["finite", "infinite", "unstable", "none"]
    grade: Literal["proven", "sampled"]
    text: str


_ResultResponseBetweenAlways = TypedDict("_ResultResponseBetweenAlways", {
    "goal": str,
    "drive": str,
    "unit": Literal["rad", "m"],
    "from": Optional[float],
    "to": Optional[float],
    "positions": int,
    "at": Optional[float],
    "named": bool,
    "value": Optional[float],
    "value_unit": str,
    "error_at_most": Optional[float],
    "frequency_hz": Optional[float],
    "end": Literal["finite", "infinite", "unstable", "none"],
    "violation_percent": Optional[float],
    "holds": bool,
    "grade": Literal["sampled", "sampled coarsely", "incomplete", "unstable"],
    "text": str,
})


class ResultResponseBetween(_ResultResponseBetweenAlways):
    """The number of a goal over the positions of a drive."""


class ResultExtreme(TypedDict):
    """A maximum or a minimum."""

    kind: Literal["peak", "resonance", "antiresonance", "minimum"]
    frequency_hz: float
    magnitude: Optional[float]
    phase_deg: Optional[float]
    natural_hz: Optional[float]
    damping_ratio: Optional[float]


class ResultDesignCurve(TypedDict):
    """A response of one design."""

    pointer: str
    configuration: str
    trouble: Optional[str]
    extremes: List["ResultExtreme"]
    vibration: Optional["ResultShaken"]
    drawn: "ResultDrawn"


class ResultTone(TypedDict):
    """A tone."""

    tone: str
    frequency_hz: Optional[float]
    peak: Optional[float]
    excess_at_most: Optional[float]
    at_edge: bool


class ResultShaken(TypedDict):
    """What a profile does to an output."""

    end: Literal["finite", "infinite", "unstable"]
    proven: bool
    rms: Optional[float]
    rms_error_at_most: Optional[float]
    sine: Optional[float]
    peak: Optional[float]
    tones: List["ResultTone"]


class ResultDrawn(TypedDict):
    """The response at as many frequencies as a picture needs, extremes among them, where it is
    finite and not 0. Between them the logarithm of the magnitude, and the phase, are straight
    over the logarithm of the frequency, to about 2 % of the magnitude. The density of the
    output under a profile is the square of the magnitude times the sum of the profile's
    densities. Rounded to six digits, frequencies to eight.
    """

    frequency_hz: List[Optional[float]]
    magnitude: List[Optional[float]]
    phase_deg: List[Optional[float]]
    psd: List[Optional[float]]


class _ResultReasonAlways(TypedDict):
    text: str


class ResultReason(_ResultReasonAlways, total=False):
    """One sentence of why."""

    kind: Literal["change", "hold", "cost", "rank"]
    about: Optional[str]


class ResultUnchecked(TypedDict):
    """A design that was not analysed again."""

    text: str
    values: Dict[str, float]


class ResultUndetermined(TypedDict):
    """A direction in which the variables may move without any goal noticing."""

    direction: str
    effect_percent: Optional[float]
    components: Dict[str, Optional[float]]


class _ResultSpreadAlways(TypedDict):
    parameter: str
    unit: Optional[str]
    value: Optional[float]
    low: Optional[float]
    low_percent: Optional[float]
    low_goal: Optional[str]
    low_weight_factor: Optional[float]
    high: Optional[float]
    high_percent: Optional[float]
    high_goal: Optional[str]
    high_weight_factor: Optional[float]


class ResultSpread(_ResultSpreadAlways, total=False):
    """Where a variable of the best design moves when the weight of one goal at a time is
    changed.
    """

    display_unit: Optional[str]
    display_factor: Optional[float]


class ResultCertificate(TypedDict):
    """A statement about all designs within the bounds."""

    kind: str
    text: str
    proven: bool
    pointer: Optional[str]
    reachable_lower_hz: Optional[float]
    reachable_upper_hz: Optional[float]


_ResultRelaxationAlways = TypedDict("_ResultRelaxationAlways", {
    "kind": Literal["bound", "band", "goal"],
    "pointer": str,
    "what": str,
    "unit": Optional[str],
    "from": float,
    "to": float,
    "change_percent": Optional[float],
    "design": Dict[str, float],
    "text": str,
})


class ResultRelaxation(_ResultRelaxationAlways, total=False):
    """One number of the question whose change, with everything else as it is, lets a design
    meet all goals. That it suffices is verified; that a smaller change would not is sampled.
    """

    display_unit: Optional[str]
    display_factor: Optional[float]


class ResultOrder(TypedDict):
    """Frequency over speed."""

    label: str
    order: float


class _ResultExcitationAlways(TypedDict):
    name: str
    pointer: str
    speed_lower_hz: float
    speed_upper_hz: float
    margin_percent: float
    configurations: List[str]
    orders: List["ResultOrder"]


class ResultExcitation(_ResultExcitationAlways, total=False):
    """Something that turns and excites at multiples of its speed."""

    up_to_hz: Optional[float]


class ResultLimit(TypedDict):
    """A limit of a goal."""

    pointer: str
    lower_hz: float
    upper_hz: float
    target: Optional[float]
    at_least: Optional[float]
    at_most: Optional[float]


class ResultCurve(TypedDict):
    """A frequency response that is shown."""

    pointer: str
    configuration: str
    input: str
    output: str
    unit: str
    output_unit: str
    lower_hz: float
    upper_hz: float
    description: Optional[str]
    source: Optional[str]
    limits: List["ResultLimit"]
    profile: Optional["ResultProfile"]
    measured: "ResultDrawn"


class ResultDensity(TypedDict):
    """A density."""

    frequency_hz: List[Optional[float]]
    level: List[Optional[float]]


class ResultProfileTone(TypedDict):
    """A sine."""

    tone: str
    lower_hz: float
    upper_hz: float
    level: float


class ResultProfile(TypedDict):
    """A profile of vibration."""

    file: str
    name: Optional[str]
    rms: Optional[float]
    sigma: float
    rule: str
    densities: List["ResultDensity"]
    tones: List["ResultProfileTone"]


class _ResultVaryAlways(TypedDict):
    quantity: str
    pointer: str
    unit: Optional[str]


class ResultVary(_ResultVaryAlways, total=False):
    """A quantity."""

    display_unit: Optional[str]
    display_factor: Optional[float]


class ResultPoint(TypedDict):
    """A point."""

    values: List[Optional[float]]
    status: Literal["solved", "compromise", "infeasible", "fitted", "interrupted", "time_limit"]
    status_text: Optional[str]
    pareto: bool
    best: "ResultDesign"


class ResultTrade(TypedDict):
    """A trade study: the best design of every point."""

    vary: List["ResultVary"]
    objectives: List[str]
    points: List["ResultPoint"]


class _ResultPublishedAlways(TypedDict):
    label: Optional[str]
    kind: Literal["parameter", "quantity", "frequency", "mac", "status"]
    pointer: str
    role: Literal["verifies", "calibrates", "not_comparable"]
    published: Optional[Union[float, str]]
    computed: Optional[Union[float, str]]
    difference: Optional[float]
    difference_percent: Optional[float]
    demand: Optional[str]
    holds: bool
    source: Optional[str]


class ResultPublished(_ResultPublishedAlways, total=False):
    """A published value against the computed one."""

    display_unit: Optional[str]
    display_factor: Optional[float]


class ResultHistory(TypedDict):
    """A design that was better than all before it."""

    objective: int
    round: int
    evaluations: int
    value: Optional[float]
    violation: Optional[float]
    feasible: bool


class ResultSpent(TypedDict, total=False):
    """What evaluations were for; all but the last add up to "evaluations". The same for any
    number of workers, and for a run that was resumed.
    """

    search: int
    positions: int
    descriptions: int
    spread: int
    relaxations: int
    trade: int
    multiplications: int


class _ResultOverrideAlways(TypedDict):
    kind: Literal["parameter", "search"]
    name: str
    unit: Optional[str]
    value: float
    original: Optional[float]


class ResultOverride(_ResultOverrideAlways, total=False):
    """One of them."""

    display_unit: Optional[str]
    display_factor: Optional[float]


class ResultInput(TypedDict):
    """A file and the digest of its bytes."""

    file: str
    sha256: str


class ResultOutput(TypedDict):
    """A file and the digest of its bytes."""

    file: str
    sha256: str


class _ResultRunAlways(TypedDict):
    modetune: Optional[str]
    build: "ResultBuild"
    blas: Optional[str]
    nlopt: Optional[str]
    gsl: Optional[str]
    seed: int
    starts: int
    distinct_designs: Optional[int]
    found_once: Optional[int]
    estimated_missing: Optional[float]
    evaluations: int
    incomplete: List[
        Literal["search", "recommendations", "spread", "certificates", "relaxations",
        "published", "trade"]
    ]
    inputs: List["ResultInput"]
    outputs: List["ResultOutput"]


class ResultRun(_ResultRunAlways, total=False):
    """What ran: no time, path or number of workers."""

    history: List["ResultHistory"]
    modal_solutions: int
    spent: "ResultSpent"
    cut_by: Optional[Literal["interrupt", "time limit"]]
    overrides: List["ResultOverride"]


class ResultBuild(TypedDict):
    """Sources and compiler of the program."""

    commit: str
    compiler: str


class _ResultStudyAlways(TypedDict):
    name: Optional[str]
    file: str


class ResultStudy(_ResultStudyAlways, total=False):
    """The question."""

    author: Optional[str]
    revision: Optional[str]
    date: Optional[str]


class _ResultAssumptionAlways(TypedDict):
    parameter: str
    unit: Optional[str]
    value: float
    source: Optional[str]
    variable: bool


class ResultAssumption(_ResultAssumptionAlways, total=False):
    """An assumed value."""

    display_unit: Optional[str]
    display_factor: Optional[float]


class ResultObjective(TypedDict):
    """An objective of the study."""

    type: Literal["none", "change", "mass", "expression", "misfit", "clearance", "vibration"]
    text: str
    unit: Optional[str]


class _ResultAlways(TypedDict):
    format: Literal["modetune-result/1"]
    study: "ResultStudy"
    model: "ResultFile"
    status: Literal["solved", "compromise", "infeasible", "fitted", "interrupted", "time_limit"]
    status_text: Optional[str]
    doubts: List["ResultDoubt"]
    facts: List["ResultDoubt"]
    variables: List[str]
    objectives: List["ResultObjective"]
    baseline: "ResultDesign"
    recommendations: List["ResultDesign"]
    undetermined: Optional[List["ResultUndetermined"]]
    spread: Optional[List["ResultSpread"]]
    certificates: Optional[List["ResultCertificate"]]
    relaxations: Optional[List["ResultRelaxation"]]
    excitations: List["ResultExcitation"]
    trade: Optional["ResultTrade"]
    published: Optional[List["ResultPublished"]]
    warnings: List[str]
    run: "ResultRun"


class Result(_ResultAlways, total=False):
    """What a study answers. SI units; frequencies in Hz; null stands for "not applicable"."""

    assumptions: List["ResultAssumption"]
    unchecked: List["ResultUnchecked"]
    curves: List["ResultCurve"]


class IndexStudy(TypedDict):
    """One of the studies."""

    file: str
    folder: str
    state: Literal["answered", "not answered", "not run"]
    name: Optional[str]
    status: Optional[
        Literal["solved", "compromise", "infeasible", "fitted", "interrupted", "time_limit"]
    ]
    grade: Optional[str]
    change: Optional[float]
    exit_status: Optional[Literal[0, 1, 2, 3, 4, 130]]
    message: Optional[str]
    result_sha256: Optional[str]


class Index(TypedDict):
    """What became of several studies that were run together: `modetune run` writes it beside
    the folders of their results. Every member is always there; null is what there is not.
    """

    format: Literal["modetune-index/1"]
    modetune: str
    studies: List["IndexStudy"]


class Progress(TypedDict):
    """How far a command is: one object a line on standard error with `--progress json`, as
    every phase and step begins that lasts long enough to be seen, twice a second besides, and
    once at the end of reading and of answering a file. Other lines of standard error do not
    begin with a brace. Every member is always there; null is what there is not, or what is not
    known.
    """

    format: Literal["modetune-progress/1"]
    file: str
    number: int
    files: int
    state: Literal["running", "done", "ended"]
    phase: Literal[
        "reading", "baseline", "search", "recommendations", "spread", "certificates",
        "relaxations", "published", "trade", "modes"
    ]
    step: int
    unit: Optional[str]
    done: int
    total: Optional[int]
    share: Optional[float]
    evaluations: int
    modal_solutions: int
    boxes: int
    objective: Optional[str]
    best: Optional[float]
    impossible: bool
    first_cpu_s: Optional[float]
    first_evaluations: Optional[int]
    best_cpu_s: Optional[float]
    best_evaluations: Optional[int]
    proof_cpu_s: Optional[float]
    cpu_s: float
    elapsed_s: float
    left_s: Optional[float]


class SceneParameter(TypedDict):
    """A parameter."""

    name: str
    value: float
    unit: Optional[str]
    display_unit: Optional[str]
    display_factor: Optional[float]


class SceneEllipsoid(TypedDict):
    """Uniform, of the same mass and inertia, at the mass centre; in two dimensions a disc.
    null: it has none.
    """

    radii: List[float]
    axes: List[List[float]]


class SceneBody(TypedDict):
    """A body."""

    name: str
    kind: Literal["ground", "body", "link"]
    mass: float
    at: List[float]
    ellipsoid: Optional["SceneEllipsoid"]


class ScenePoint(TypedDict):
    """A point."""

    name: str
    body: int
    at: List[float]


_SceneLineAlways = TypedDict("_SceneLineAlways", {
    "body": int,
    "from": List[float],
    "to": List[float],
})


class SceneLine(_SceneLineAlways):
    """A line."""


_SceneConfigurationJointAlways = TypedDict("_SceneConfigurationJointAlways", {
    "name": str,
    "type": str,
    "bodies": List[int],
    "from": Optional[List[float]],
    "at": List[float],
    "axis": Optional[List[float]],
    "distance": float,
    "far": Optional[str],
})


class SceneConfigurationJoint(_SceneConfigurationJointAlways):
    """A joint."""


_SceneSpringAlways = TypedDict("_SceneSpringAlways", {
    "name": str,
    "type": Literal["torsion", "axial", "bar", "bushing", "link"],
    "bodies": List[int],
    "from": List[float],
    "to": List[float],
    "axis": Optional[List[float]],
    "stiffness": Optional[float],
})


class SceneSpring(_SceneSpringAlways):
    """A spring."""


_SceneDamperAlways = TypedDict("_SceneDamperAlways", {
    "name": str,
    "type": Literal["torsion", "axial", "bar", "bushing"],
    "bodies": List[int],
    "from": List[float],
    "to": List[float],
    "axis": Optional[List[float]],
    "damping": Optional[float],
})


class SceneDamper(_SceneDamperAlways):
    """A damper."""


class SceneSensor(TypedDict):
    """A sensor."""

    name: str
    body: int
    at: List[float]
    axis: List[float]


class SceneLoad(TypedDict):
    """A load."""

    name: str
    body: int
    at: List[float]
    axis: List[float]


class SceneRotor(TypedDict):
    """A rotor."""

    name: str
    body: int
    at: List[float]
    axis: List[float]


class SceneEnergy(TypedDict):
    """Shares of its energy, rounded down: they never add up to more than 1."""

    springs: List[float]
    bodies: List[float]


class SceneMode(TypedDict):
    """A mode as a small motion."""

    mode: int
    hz: Optional[float]
    name: Optional[str]
    note: Optional[Literal["rigid-body", "unstable", "undecided"]]
    motion: List[List[float]]
    energy: "SceneEnergy"


class ScenePosition(TypedDict):
    """One position of the driven joint."""

    at: float
    poses: Optional[List[List[float]]]
    hz: List[Optional[float]]
    error: Optional[str]


class SceneDrive(TypedDict):
    """The range of a driven joint: from the lowest to the highest position that a configuration
    of the model drives it to.
    """

    joint: str
    unit: Literal["rad", "m"]
    at: Optional[float]
    error: Optional[str]
    positions: List["ScenePosition"]


class SceneConfiguration(TypedDict):
    """One configuration at one design, where it comes to rest."""

    name: str
    error: Optional[str]
    bodies: List["SceneBody"]
    points: List["ScenePoint"]
    lines: List["SceneLine"]
    joints: List["SceneConfigurationJoint"]
    springs: List["SceneSpring"]
    dampers: List["SceneDamper"]
    sensors: List["SceneSensor"]
    loads: List["SceneLoad"]
    rotors: List["SceneRotor"]
    modes: List["SceneMode"]
    drive: Optional["SceneDrive"]


class SceneDesign(TypedDict):
    """A design."""

    label: str
    rank: int
    parameters: List["SceneParameter"]
    configurations: List["SceneConfiguration"]


class SceneJoint(TypedDict):
    """A joint."""

    configuration: str
    joint: str
    type: str
    body: Optional[str]
    distance: float


class Scene(TypedDict):
    """What there is to see of a mechanism, as `modetune show --format json` prints it and its
    page draws it: for pictures, so that places have six significant digits and frequencies
    nine. SI units, ground coordinates, z = 0 in two dimensions. Bodies are numbered from the
    ground, 0.
    """

    format: Literal["modetune-scene/1"]
    model: str
    dimension: Literal[2, 3]
    size: float
    gravity: Optional[List[float]]
    designs: List["SceneDesign"]
    joints: List["SceneJoint"]


class CommandCheckProblem(TypedDict):
    """A problem of a file."""

    file: str
    line: Optional[int]
    column: Optional[int]
    pointer: Optional[str]
    severity: Literal["error", "warning", "note"]
    message: str


class CommandCheckFile(TypedDict):
    """A file that was checked."""

    file: str
    kind: Optional[Literal["model", "study", "result", "aircraft", "profile"]]
    ok: bool
    problems: List["CommandCheckProblem"]
    left_out: int
    doubts: List["CommandCheckDoubt"]
    facts: List["CommandCheckDoubt"]


class CommandCheckDoubt(TypedDict):
    """A fact or a doubt, with its place in a file where that is known."""

    kind: str
    text: str
    configuration: Optional[str]
    file: Optional[str]
    line: Optional[int]
    column: Optional[int]
    pointer: Optional[str]


class CommandDiffDifference(TypedDict):
    """A member that two results tell otherwise."""

    part: str
    what: str
    member: Optional[str]
    unit: Optional[str]
    a: Optional[Union[float, str, bool]]
    b: Optional[Union[float, str, bool]]
    change_percent: Optional[float]
    pointer_a: Optional[str]
    pointer_b: Optional[str]
    derived: bool


class CommandDiff(TypedDict):
    """What `modetune diff --format json` prints."""

    a: str
    b: str
    rel_tol: float
    abs_tol: float
    same: bool
    made_by: List["CommandDiffDifference"]
    differences: List["CommandDiffDifference"]


class CommandExamplesListed(TypedDict):
    """A file that is part of the program."""

    name: str
    text: str


class CommandInfoHeldFile(TypedDict):
    """What a file holds that does not describe a model."""

    file: str
    kind: str
    format: str
    bytes: int
    sha256: str
    name: Optional[str]
    description: Optional[str]
    author: Optional[str]
    revision: Optional[str]
    date: Optional[str]
    source: Optional[str]
    modetune: Optional[str]
    commit: Optional[str]
    status: Optional[str]
    items: List["CommandInfoItem"]
    refers_to: List["CommandInfoNamedFile"]
    doubts: List[str]


class CommandInfoConfiguration(TypedDict):
    """A configuration of a model. It has many more members, which are not described here."""

    configuration: str


class CommandInfoItem(TypedDict):
    """Something that the file holds."""

    part: str
    name: Optional[str]
    value: Optional[float]
    lower: Optional[float]
    upper: Optional[float]
    unit: Optional[str]
    lower_hz: Optional[float]
    upper_hz: Optional[float]
    count: Optional[int]
    text: Optional[str]


class CommandInfoNamedFile(TypedDict):
    """A file that this one names."""

    what: str
    file: str
    state: Literal["found", "changed", "not found", "part of the program"]


class CommandMacPair(TypedDict):
    """A mode of A and the mode of B that it is paired with."""

    a: int
    b: int
    mac: float
    frequency_a_hz: float
    frequency_b_hz: float


class CommandMacSubspace(TypedDict):
    """Repeated modes, compared as a space."""

    first_a: int
    modes: int
    mac: List[Optional[float]]


class CommandMac(TypedDict):
    """What `modetune mac --format json` prints."""

    pairs: List["CommandMacPair"]
    matrix: List[List[Optional[float]]]
    subspaces: List["CommandMacSubspace"]
    vibration_modes: List[Optional[float]]
    channels: List[str]
    notes: List[str]


class CommandModesEquilibrium(TypedDict):
    """Where the modes are: at rest under the loads."""

    solved: bool
    iterations: int
    residual: float
    gap_m: float
    largest_motion_m: float
    largest_turn_rad: float


class _CommandModesConfigurationAlways(TypedDict):
    configuration: str
    doubts: List["CommandModesDoubt"]
    facts: List["CommandModesDoubt"]
    method: Literal["dense", "tree", "sparse"]
    complete_below_hz: Optional[float]
    freedoms: int
    vibration_modes: Optional[int]
    rigid_body_modes: int
    unstable_modes: int
    undecided_modes: int
    massless_directions: Optional[int]
    modes: List["CommandModesMode"]
    redundant_constraints: Optional[List[List[str]]]
    equilibrium: "CommandModesEquilibrium"


class CommandModesConfiguration(_CommandModesConfigurationAlways, total=False):
    """A configuration, answered."""

    damped_modes: List["CommandModesDampedMode"]
    about_m: List[Optional[float]]
    effective_mass: List["CommandModesEffectiveMass"]


class CommandModesFailed(TypedDict):
    """A configuration without an answer."""

    configuration: str
    error: str


class CommandModesDoubt(TypedDict):
    """A fact or a doubt, with its place in a file where that is known."""

    kind: str
    text: str
    configuration: Optional[str]
    file: Optional[str]
    line: Optional[int]
    column: Optional[int]
    pointer: Optional[str]


class _CommandModesModeAlways(TypedDict):
    index: Optional[int]
    name: Optional[str]
    frequency_hz: Optional[float]
    frequency_error_hz: Optional[float]
    kind: Literal["flexible", "rigid_body", "unstable", "undecided"]
    omega_squared: float
    omega_squared_error: float
    repeated: int
    residual: float
    orthogonality: float


class CommandModesMode(_CommandModesModeAlways, total=False):
    """A mode."""

    shape: Dict[str, float]
    energy: "CommandModesModeEnergy"


class CommandModesModeEnergy(TypedDict):
    """Who has the energy of a mode."""

    modes: int
    kinetic: List["CommandModesKineticEnergy"]
    kinetic_sum_percent: float
    strain: Optional[List["CommandModesStrainEnergy"]]
    loads_percent: Optional[float]
    strain_sum_percent: Optional[float]


class CommandModesKineticEnergy(TypedDict):
    """Shares of a mode's kinetic energy [%]; below 0 where axes couple."""

    body: str
    axes: Literal["global", "principal", "torque_roll_x", "torque_roll_y", "torque_roll_z"]
    percent: float
    x_percent: float
    y_percent: float
    z_percent: Optional[float]
    rx_percent: Optional[float]
    ry_percent: Optional[float]
    rz_percent: Optional[float]


class CommandModesStrainEnergy(TypedDict):
    """Shares of a mode's strain energy [%]; of a component below 0 where the bushing's matrix
    couples.
    """

    spring: str
    percent: float
    x_percent: Optional[float]
    y_percent: Optional[float]
    z_percent: Optional[float]
    rx_percent: Optional[float]
    ry_percent: Optional[float]
    rz_percent: Optional[float]


class CommandModesDampedMode(TypedDict):
    """A mode with damping, a root of the equations of motion."""

    index: Optional[int]
    kind: Literal["oscillating", "overdamped", "rigid_body", "unstable", "undecided"]
    natural_frequency_hz: Optional[float]
    natural_frequency_error_hz: Optional[float]
    damped_frequency_hz: Optional[float]
    damping_ratio_percent: Optional[float]
    decay_per_s: Optional[float]
    residual: float


class CommandModesEffectiveMass(TypedDict):
    """What modes have of a ground that moves one way."""

    direction: str
    unit: str
    total: float
    sum: float
    sum_percent: Optional[float]
    participation: List[Optional[float]]
    effective_mass: List[Optional[float]]


class CommandProfileListed(TypedDict):
    """A file that is part of the program."""

    name: str
    text: str


class CommandProfileCombine(TypedDict):
    """How the peak follows from the parts."""

    sigma: float
    tones: Literal["sum", "largest", "root_sum_square"]


class CommandProfileSpectrum(TypedDict):
    """With --spectrum: what it does to one mass."""

    damping_ratio: float
    masses: List["CommandProfileMass"]


class _CommandProfileProfileAlways(TypedDict):
    file: str
    name: Optional[str]
    source: Optional[str]
    axis: Optional[str]
    rms_g: float
    rms_m_per_s2: float
    random: List["CommandProfileRandom"]
    tones: List["CommandProfileTone"]
    combine: "CommandProfileCombine"
    marks: List[str]


class CommandProfileProfile(_CommandProfileProfileAlways, total=False):
    """What a profile of vibration requires."""

    spectrum: "CommandProfileSpectrum"


class CommandProfileRandom(TypedDict):
    """A random part of a profile."""

    rms_g: float
    rms_m_per_s2: float
    published_rms_g: Optional[float]
    origin: Optional[Literal["published", "identified", "assumed"]]
    source: Optional[str]
    breakpoints: List["CommandProfileBreakpoint"]


class CommandProfileBreakpoint(TypedDict):
    """A breakpoint of a spectral density."""

    frequency_hz: float
    psd_g2_per_hz: float
    psd_m2_per_s3: float
    slope_db_per_octave: Optional[float]


class CommandProfileTone(TypedDict):
    """A tone of a profile."""

    tone: str
    lower_hz: float
    upper_hz: float
    acceleration_g: float
    acceleration_m_per_s2: float
    origin: Optional[Literal["published", "identified", "assumed"]]
    source: Optional[str]


class _CommandProfileMassAlways(TypedDict):
    natural_frequency_hz: float
    end: Literal["finite", "infinite", "unstable"]
    unit: str
    rms: Optional[float]
    rms_error_at_most: Optional[float]
    sine: Optional[float]
    peak: Optional[float]
    tones: List["CommandProfileVibratedTone"]


class CommandProfileMass(_CommandProfileMassAlways, total=False):
    """The absolute acceleration of one mass on a spring."""

    rms_g: Optional[float]
    sine_g: Optional[float]
    peak_g: Optional[float]


class CommandProfileVibratedTone(TypedDict):
    """The response to one tone."""

    tone: str
    end: Literal["finite", "infinite", "unstable"]
    frequency_hz: Optional[float]
    peak: Optional[float]
    excess_at_most: Optional[float]
    at_edge: bool


class CommandResponseCombine(TypedDict):
    """How the peak follows from the parts."""

    sigma: float
    tones: Literal["sum", "largest", "root_sum_square"]


class CommandResponseProfile(TypedDict):
    """With --vibration: the profile."""

    file: str
    name: Optional[str]
    axis: Optional[Literal["x", "y", "z"]]
    rms_m_per_s2: float
    combine: "CommandResponseCombine"
    marks: List[str]


class _CommandResponseConfigurationAlways(TypedDict):
    configuration: str
    method: Literal["direct", "modes"]
    modes: int
    modes_left_out: int
    coupled: bool
    complete: bool
    inputs: List["CommandResponsePort"]
    outputs: List["CommandResponsePort"]
    frequencies_hz: List[Optional[float]]
    responses: List["CommandResponseResponse"]


class CommandResponseConfiguration(_CommandResponseConfigurationAlways, total=False):
    """A configuration, answered."""

    shapes_of_others: int
    profile: "CommandResponseProfile"
    vibration_method: Literal["poles", "quadrature"]
    state_space: "CommandResponseStateSpace"


class CommandResponseFailed(TypedDict):
    """A configuration without an answer."""

    configuration: str
    error: str


class CommandResponsePort(TypedDict):
    """An input or output."""

    name: str
    unit: str


class _CommandResponseVibrationAlways(TypedDict):
    end: Literal["finite", "infinite", "unstable"]
    unit: str
    rms: Optional[float]
    rms_error_at_most: Optional[float]
    sine: Optional[float]
    peak: Optional[float]
    tones: List["CommandResponseVibratedTone"]


class CommandResponseVibration(_CommandResponseVibrationAlways, total=False):
    """With --vibration: what the profile does to the output."""

    rms_g: Optional[float]
    sine_g: Optional[float]
    peak_g: Optional[float]
    by_mode: int


class _CommandResponseResponseAlways(TypedDict):
    input: str
    output: str
    unit: str
    extremes: List["CommandResponseExtreme"]
    re: List[Optional[float]]
    im: List[Optional[float]]
    error: List[Optional[float]]


class CommandResponseResponse(_CommandResponseResponseAlways, total=False):
    """The response of one output to one input."""

    poles: Optional[List["CommandResponsePole"]]
    no_poles: str
    polynomial: List["CommandResponseCoefficient"]
    vibration: "CommandResponseVibration"
    psd_unit: str
    psd: List[Optional[float]]


class _CommandResponseExtremeAlways(TypedDict):
    kind: Literal["peak", "resonance", "antiresonance", "minimum"]
    frequency_hz: float
    magnitude: Optional[float]
    phase_deg: Optional[float]


class CommandResponseExtreme(_CommandResponseExtremeAlways, total=False):
    """A peak, or a minimum."""

    sensitivities: List["CommandResponseSensitivity"]


class CommandResponseSensitivity(TypedDict):
    """What one parameter does to the magnitude."""

    parameter: str
    value: float
    magnitude_per_percent: Optional[float]


class CommandResponsePole(TypedDict):
    """A pole of the response with its residue."""

    re: float
    im: float
    residue_re: float
    residue_im: float


class CommandResponseCoefficient(TypedDict):
    """A complex coefficient."""

    re: float
    im: float


class CommandResponseVibratedTone(TypedDict):
    """The response to one tone."""

    tone: str
    end: Literal["finite", "infinite", "unstable"]
    frequency_hz: Optional[float]
    peak: Optional[float]
    excess_at_most: Optional[float]
    at_edge: bool


class CommandResponseStateSpace(TypedDict):
    """The mechanism between the ports as x' = A x + B u, y = C x + D u."""

    modes: int
    residual_shapes: int
    states: List[str]
    inputs: List["CommandResponsePort"]
    outputs: List["CommandResponsePort"]
    A: List[List[Optional[float]]]
    B: List[List[Optional[float]]]
    C: List[List[Optional[float]]]
    D: List[List[Optional[float]]]
    viscous_for_loss_factors: bool
    from_hz: float
    to_hz: float
    compared: int
    largest_difference_percent: float


class CommandSchemaListed(TypedDict):
    """A file that is part of the program."""

    name: str
    text: str


class CommandSensitivityConfiguration(TypedDict):
    """A configuration, answered."""

    configuration: str
    method: Literal["dense", "tree", "sparse"]
    modes: List["CommandSensitivityMode"]
    no_derivatives: List["CommandSensitivityNoDerivative"]


class CommandSensitivityFailed(TypedDict):
    """A configuration without an answer."""

    configuration: str
    error: str


class CommandSensitivityMode(TypedDict):
    """A vibration mode."""

    index: int
    frequency_hz: float
    repeated: bool
    sensitivities: List["CommandSensitivitySlope"]


class CommandSensitivitySlope(TypedDict):
    """What one parameter does to one mode."""

    parameter: str
    unit: Optional[str]
    value: float
    hz_per_percent: Optional[float]
    hz_per_unit: Optional[float]


class CommandSensitivityNoDerivative(TypedDict):
    """A parameter without derivative."""

    parameter: str
    reason: Literal["opens_joints", "blocks_motion"]
    joints: List[str]


class CommandSimulateOutput(TypedDict):
    """A quantity over time."""

    port: str
    unit: Literal["m", "m/s", "m/s^2", "rad", "rad/s", "rad/s^2"]
    values: List[Optional[float]]


class CommandSimulateTurnings(TypedDict):
    """Of a free motion: what its turns show."""

    periods: int
    frequency_hz: Optional[float]
    spread: Optional[float]
    amplitude: Optional[float]
    damping_ratio: Optional[float]


class CommandSimulateSteady(TypedDict):
    """Under one --sine: its steady motion."""

    periods: int
    frequency_hz: float
    mean: float
    amplitudes: List[Optional[float]]
    phases_rad: List[Optional[float]]
    residual: float


class _CommandSimulateReadingAlways(TypedDict):
    port: str
    unit: Literal["m", "rad"]


class CommandSimulateReading(_CommandSimulateReadingAlways, total=False):
    """What the motion of a port shows."""

    turnings: "CommandSimulateTurnings"
    tones: List["CommandSimulateTone"]
    tones_residual: Optional[float]
    steady: "CommandSimulateSteady"


class CommandSimulateTone(TypedDict):
    """A decaying oscillation in a free motion."""

    frequency_hz: float
    damping_ratio: float
    amplitude: float
    phase_rad: float


class CommandSimulateCombine(TypedDict):
    """How the peak follows from the parts."""

    sigma: float
    tones: Literal["sum", "largest", "root_sum_square"]


class CommandSimulateVibration(TypedDict):
    """With --vibration: the profile that shakes the ground."""

    file: str
    name: Optional[str]
    port: Literal["base.x", "base.y", "base.z"]
    seed: int
    rms_m_per_s2: float
    realised_rms_m_per_s2: float
    combine: "CommandSimulateCombine"
    marks: List[str]


class _CommandSimulateAlways(TypedDict):
    configuration: str
    complete: bool
    method: Literal["integrated", "exact", "fitted"]
    tolerance: float
    time_s: List[Optional[float]]
    outputs: List["CommandSimulateOutput"]
    kinetic_j: List[Optional[float]]
    potential_j: List[Optional[float]]
    work_j: List[Optional[float]]
    energy_scale_j: float
    energy_error_j: float
    joint_drift_m: float
    joint_gap_m: float
    steps: int
    stiff_steps: int
    rejected_steps: int
    evaluations: int
    readings: List["CommandSimulateReading"]


class CommandSimulate(_CommandSimulateAlways, total=False):
    """What `modetune simulate --format json` prints."""

    vibration: "CommandSimulateVibration"
    equations_residual: float
    input_error: float


class _CommandSweepConfigurationAlways(TypedDict):
    configuration: str
    joint: str
    hold: Literal["lock", "trim"]
    spring: Optional[str]
    points: List["CommandSweepPoint"]


class CommandSweepConfiguration(_CommandSweepConfigurationAlways, total=False):
    """A configuration, swept."""

    drives: List["CommandSweepDrive"]


class CommandSweepFailed(TypedDict):
    """A configuration without an answer."""

    configuration: str
    error: str


class CommandSweepDrive(TypedDict):
    """One of several driven joints and what holds it."""

    joint: str
    hold: Literal["lock", "trim"]
    spring: Optional[str]


class CommandSweepPoint(TypedDict, total=False):
    """A position of the driven joint."""

    position_rad: float
    position_m: float
    drives: List["CommandSweepDriven"]
    error: str
    joints: List["CommandSweepJoint"]
    hold_n_m: float
    hold_n: float
    equilibrium_residual: float
    gap_m: float
    dead_centre: Optional["CommandSweepDeadCentre"]
    frequencies_hz: List[Optional[float]]
    rigid_body_modes: int
    unstable_modes: int
    undecided_modes: int


class CommandSweepDriven(TypedDict, total=False):
    """One of several driven joints."""

    position_rad: float
    position_m: float
    hold_n_m: float
    hold_n: float


class _CommandSweepJointAlways(TypedDict):
    name: str
    ratio: float


class CommandSweepJoint(_CommandSweepJointAlways, total=False):
    """A joint with a coordinate at a position."""

    coordinate_rad: float
    coordinate_m: float
    ratios: List[Optional[float]]


class CommandSweepDeadCentre(TypedDict):
    """A dead centre near a position."""

    distance: float
    independence: float
    joints: List[str]


ModelNumber = Union[float, str]
ModelVector = List["ModelNumber"]
ModelPosition = Union[str, "ModelVector"]
ModelAt = Union["ModelPosition", List["ModelPosition"]]
ModelOrigin = Literal["published", "identified", "assumed"]
StudyNumber = Union[float, str]
StudyIndex = int
StudyMode = Union[int, str]
StudyPair = List["StudyNumber"]
StudyGoal = Union[
    "StudyGoalOf", "StudyGoalFrequency", "StudyGoalShape", "StudyGoalMac", "StudyGoalDamping",
    "StudyGoalEnergy", "StudyGoalResponse", "StudyGoalVibration", "StudyGoalFrequencyResponse",
    "StudyGoalStatic", "StudyGoalLimit", "StudyGoalAvoid", "StudyGoalRatio", "StudyGoalApart"
]
ProfilePair = List[float]
ProfileBreakpoints = List[Union["ProfilePair", "ProfileSlope"]]
ProfileOrigin = Literal["published", "identified", "assumed"]
CommandCheck = List["CommandCheckFile"]
CommandExamples = List["CommandExamplesListed"]
CommandInfo = Union[
    "CommandInfoHeldFile", List["CommandInfoConfiguration"], "CommandInfoConfiguration"
]
CommandModes = Union[
    List[Union["CommandModesConfiguration", "CommandModesFailed"]], "CommandModesConfiguration",
    "CommandModesFailed"
]
CommandProfile = Union[List["CommandProfileListed"], "CommandProfileProfile"]
CommandResponse = Union[
    List[Union["CommandResponseConfiguration", "CommandResponseFailed"]],
    "CommandResponseConfiguration", "CommandResponseFailed"
]
CommandSchema = List["CommandSchemaListed"]
CommandSensitivity = Union[
    List[Union["CommandSensitivityConfiguration", "CommandSensitivityFailed"]],
    "CommandSensitivityConfiguration", "CommandSensitivityFailed"
]
CommandSweep = Union[
    List[Union["CommandSweepConfiguration", "CommandSweepFailed"]], "CommandSweepConfiguration",
    "CommandSweepFailed"
]
