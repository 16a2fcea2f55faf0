# SPDX-License-Identifier: GPL-3.0-or-later
"""A mechanism whose positions are driven, and a study of it."""

# A pedal that is driven and held, a pushrod to a bellcrank, and an actuator on the crank's other arm, whose length is free.
PEDAL = {
    "format": "modetune-model/1", "name": "Pedal", "dimension": 2,
    "parameters": {"arm": 0.1, "k_rod": 2e4, "k_act": 3e4, "m": 0.8},
    "points": {"pedal": [0, 0], "crank": [0.5, 0]},
    "bodies": [{"name": "pedal", "mass_kg": 2, "inertia_kg_m2": 0.05, "centre": [0, 0.2]},
               {"name": "crank", "mass_kg": "m", "inertia_kg_m2": 0.004, "centre": [0.5, 0.05]}],
    "joints": [{"name": "pedal", "type": "revolute", "bodies": ["ground", "pedal"], "at": "pedal"},
               {"name": "crank", "type": "revolute", "bodies": ["ground", "crank"], "at": "crank"}],
    "springs": [{"name": "pushrod", "type": "axial", "bodies": ["pedal", "crank"], "at": [[0, 0.25], [0.5, 0.15]], "stiffness_n_per_m": "k_rod"},
                {"name": "actuator", "type": "axial", "bodies": ["ground", "crank"], "at": [[0.9, "-arm"], [0.5, "-arm"]], "stiffness_n_per_m": "k_act"}],
    "configurations": {name: {"drive": {"joint": "pedal", "position_rad": angle, "hold": "lock"}}
                       for name, angle in (("left", -0.3), ("mid", 0), ("right", 0.3))},
}
FREE = [{"parameter": "arm", "lower": 0.05, "upper": 0.2}, {"parameter": "m", "lower": 0.4, "upper": 1.6}]


def study(variables, **more):
    return {"format": "modetune-study/1", "name": "Pedal", "model": "../problems/pedal.json", "variables": variables,
            "goals": [{"type": "avoid", "configurations": ["left", "mid", "right"], "bands_hz": [[52, 58], [100, 110]], "margin_percent": 2}],
            "objective": {"minimise": "change"}, **more}
