# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults that the checks must find: (what goes wrong in the model that the program reads, kinds, in how many of ten it must be seen at least)."""
from exact import number


def _first(model, list_name, member):
    return next((item for item in model.get(list_name, []) if isinstance(item.get(member), (int, float)) and item[member]), None)


def no_gravity(model):
    return model.pop("gravity_m_per_s2", None) is not None


def heavier(model):
    """A mass by one part in ten million."""
    model["bodies"][0]["mass_kg"] = f"({model['bodies'][0]['mass_kg']})*1.0000001"
    return True


def tension_reversed(model):
    spring = _first(model, "springs", "preload_n") or _first(model, "springs", "preload_n_m")
    for member in ("preload_n", "preload_n_m"):
        if spring and member in spring:
            spring[member] = float(-number(spring[member]))
    return spring is not None


def spring_lost(model):
    return model.get("springs") and model["springs"].pop() is not None


def joint_lost(model):
    return model.get("joints") and model["joints"].pop(0) is not None


def joint_moved(model):
    """By a micrometre."""
    joint = next((j for j in model.get("joints", []) if "at" in j and j["type"] != "fixed" and all(isinstance(x, float) for x in j["at"])), None)
    if joint:
        joint["at"][0] = float(number(joint["at"][0]) + number(1e-6))
    return joint is not None


def rest_forgotten(model):
    spring = _first(model, "springs", "free_length_m") or _first(model, "springs", "free_angle_rad")
    for member in ("free_length_m", "free_angle_rad"):
        if spring:
            spring.pop(member, None)
    return spring is not None


def axes_lost(model):
    item = next((s for s in model.get("springs", []) + model["bodies"] if "axes" in s), None)
    return item is not None and item.pop("axes") is not None


def damper_lost(model):
    return bool(model["dampers"]) and model["dampers"].pop() is not None


def loss_off(model):
    """By one part in ten thousand."""
    spring = _first(model, "springs", "loss_factor")
    if spring:
        spring["loss_factor"] *= 1.0001
    return spring is not None


def proportion_lost(model):
    return model["damping"].pop("mass_per_s", None) is not None


def _tones(motion):
    return [tone for reading in motion["readings"] for tone in reading["tones"]]


def rings_higher(motion):
    for tone in _tones(motion):
        tone["frequency_hz"] *= 1.0001


def rings_longer(motion):
    for tone in _tones(motion):
        tone["damping_ratio"] -= 1e-4


RINGING_FAULTS = [rings_higher, rings_longer]  # put into motions that are read; all are found
DAMPING_FAULTS = [(damper_lost, 8), (loss_off, 6), (proportion_lost, 8)]  # put into damped mechanisms: as below
FAULTS = [(no_gravity, ("loaded2", "loaded3", "hanging"), 6), (heavier, ("free2", "free3", "loaded2"), 4), (tension_reversed, ("loaded2", "loaded3"), 7),
          (spring_lost, ("loaded2", "loaded3"), 8), (joint_lost, ("loaded2", "loaded3"), 8), (joint_moved, ("loaded2", "driven3"), 5),
          (rest_forgotten, ("loaded2", "loaded3"), 7), (axes_lost, ("axes2", "axes3"), 7)]
