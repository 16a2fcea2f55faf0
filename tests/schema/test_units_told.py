# SPDX-License-Identifier: GPL-3.0-or-later
"""
Every number that a command prints says its unit. A column of CSV does by the ending of its name (schemas/reference.py), or by a column
beside it; a member of JSON by its ending, by the unit in brackets of its sentence, which agree, or by a sentence that names the member
that has it. All others are in BARE: numbers without dimension, each with its reason; what is there is printed somewhere.
"""
import csv
import io
import json
import re
import subprocess
import sys
import unittest
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
sys.path += [str(TESTS / "support"), str(TESTS.parent / "schemas")]
import reference  # noqa: E402
from suite import PROGRAM, SOURCE  # noqa: E402

WRITTEN = "tests/result/written_by"
HARTOG = ["problems/den_hartog.json", "--input", "base.x"]
LINES = (
    ["modes", "problems/inceptor.json", "--shapes"],
    ["modes", "problems/stick.json", "--shapes"],
    ["modes", "tests/models/damped_linkage.json", "--damped"],
    ["mac", "problems/inceptor.json:installed", "problems/inceptor.json:table_8"],
    ["sensitivity", "problems/stick.json"],
    ["response", *HARTOG, "--points", "4"],
    ["response", *HARTOG, "--points", "4", "--vibration", "gevs_qualification"],
    ["sweep", "tests/models/driven_rod.json", "--drive", "pivot=0:30*deg:3", "--frequencies", "--hold", "servo"],
    ["sweep", "tests/models/couplings.json", "--drive", "guide=0:0.001:2"],
    ["simulate", "tests/models/pendulum.json", "-c", "hanging", "--start", "pivot=0.5", "--duration", "0.01", "--dt-out", "0.005"],
    ["profile", "helicopter_sine_on_random"],
    ["profile", "gevs_qualification", "--spectrum", "5:500:3"],
    ["profile", "helicopter_sine_on_random", "--spectrum", "5:500:3"],
    ["diff", f"{WRITTEN}/2026-11-20/inceptor_tuning_1.json", f"{WRITTEN}/2026-11-25/inceptor_catalogue.json"],
)
# Endings that CSV alone has: a mass-normalised shape, an eigenvalue; a slope of joints of different kinds.
IN_CSV = (("_rad_per_m_sqrt_kg", "rad/(m sqrt(kg))"), ("_per_sqrt_kg", "1/sqrt(kg)"), ("_rad2_per_s2", "rad^2/s^2"), ("_rad_per_m", "rad/m"))
# The column with the unit of others, by command.
BESIDE = {
    "response": {"re": "unit", "im": "unit", "magnitude": "unit", "error": "unit", "psd": "psd_unit"},
    "sensitivity": {"value": "unit"},
    "profile": {"rms": "unit", "rms_error_at_most": "unit", "sine": "unit", "peak": "unit"},
    "diff": {"a": "unit", "b": "unit"},
}
COUNT, PART, RATIO = "a number of things", "a part of something", "of two of one kind"
BARE_COLUMNS = {
    "modes": {"index": COUNT, "residual": PART, "orthogonality": PART},
    "mac": {"a": COUNT, "b": COUNT, "mac": "a squared cosine"},
    "sensitivity": {"index": COUNT},
    "sweep": {"axle_ratio": RATIO, "equilibrium_residual": PART},
}
BARE_MEMBERS = {
    "diff": {"rel_tol": PART},
    "mac": {"vibration_modes": COUNT, "matrix": "squared cosines", "pair/mac": "a squared cosine", "subspace/mac": "squared cosines"},
    "modes": {"configuration/equilibrium/residual": PART, "mode/residual": PART, "mode/orthogonality": PART, "damped_mode/residual": PART},
    "profile": {"profile/combine/sigma": "a multiple of an RMS", "profile/spectrum/damping_ratio": RATIO, "vibrated_tone/excess_at_most": PART},
    "response": {"configuration/profile/combine/sigma": "a multiple of an RMS", "vibrated_tone/excess_at_most": PART},
    "simulate": {
        "tolerance": PART, "equations_residual": PART, "input_error": PART, "vibration/combine/sigma": "a multiple of an RMS",
        "reading/tones_residual": PART, "reading/turnings/spread": PART, "reading/turnings/damping_ratio": RATIO,
        "reading/steady/residual": PART, "tone/damping_ratio": RATIO,
    },
    "sweep": {"point/equilibrium_residual": PART, "dead_centre/independence": PART},
}
UNIT = re.compile(r"\[([^\]]*)\]")


def ending(name, table=reference.UNITS):
    return next((unit for end, unit in table if unit is not None and name.endswith(end)), None)


def is_number(text):
    try:
        float(text)
    except ValueError:
        return False
    return True


def numeric(rows, name):
    cells = [row[name] for row in rows if row[name] != ""]
    return cells != [] and all(map(is_number, cells))


def has_numbers(part):
    """The type itself or of the items of its list, and theirs; counts are not asked for their unit."""
    kinds, by_name = part.get("type", []), part.get("additionalProperties", False)
    return "number" in ([kinds] if isinstance(kinds, str) else kinds) or ("items" in part and has_numbers(part["items"])) or (isinstance(by_name, dict) and has_numbers(by_name))


def members(part, place=""):
    """Members with numbers: place, sentence."""
    for name, inner in part.get("properties", {}).items():
        below = f"{place}/{name}" if place else name
        if has_numbers(inner):
            yield below, inner["description"]
        for deeper in (inner, inner.get("items", {})):
            yield from members(deeper, below)
    for name, definition in part.get("definitions", {}).items():
        yield from members(definition, name)


class Units(unittest.TestCase):
    def test_columns_of_csv_say_their_unit(self):
        seen = set()
        for line in LINES:
            done = subprocess.run([PROGRAM, *line, "--format", "csv"], cwd=SOURCE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, encoding="utf-8", check=False)
            rows = list(csv.DictReader(io.StringIO(done.stdout)))
            self.assertNotEqual(rows, [], line)
            beside, bare = BESIDE.get(line[0], {}), BARE_COLUMNS.get(line[0], {})
            for name in (n for n in rows[0] if numeric(rows, n)):
                if name in bare:
                    self.assertIsNone(ending(name, IN_CSV + reference.UNITS), f"{line}: {name}")
                    seen.add((line[0], name))
                elif name in beside:
                    self.assertEqual([row for row in rows if row[name] != "" and row[beside[name]] == ""], [], f"{line}: {name} without unit")
                    seen.add((line[0], name))
                else:
                    self.assertIsNotNone(ending(name, IN_CSV + reference.UNITS), f"{line}: {name} says no unit")
        # of both sides of a difference, some are texts
        known = {(command, name) for table in (BARE_COLUMNS, BESIDE) for command, names in table.items() for name in names if command != "diff"}
        self.assertEqual(known - seen, set(), "printed nowhere")

    def test_numbers_of_a_difference_have_their_unit_beside(self):
        line = next(line for line in LINES if line[0] == "diff")
        done = subprocess.run([PROGRAM, *line, "--format", "csv"], cwd=SOURCE, stdout=subprocess.PIPE, encoding="utf-8", check=False)
        units = {row["unit"] for row in csv.DictReader(io.StringIO(done.stdout)) if is_number(row["a"])}
        self.assertLessEqual({"Hz"}, units)

    def test_members_of_json_say_their_unit(self):
        for path in sorted((SOURCE / "schemas").glob("command_*.schema.json")):
            command = path.name[len("command_"):-len(".schema.json")]
            found = dict(members(json.loads(path.read_text(encoding="utf-8"))))
            bare = BARE_MEMBERS.get(command, {})
            self.assertEqual(set(bare) - set(found), set(), command)
            for place, text in found.items():
                name, told = place.rsplit("/", 1)[-1], UNIT.search(text)
                by_name = ending(name)
                with self.subTest(command=command, member=place, sentence=text):
                    if told is not None:
                        self.assertNotIn("unit", re.sub(r"Hz per unit", "", told[1]), "words, not a unit, in brackets")
                    if told is not None and by_name is not None:
                        self.assertEqual(told[1], by_name, "the ending and the brackets differ")
                    if place in bare:
                        self.assertEqual((told, by_name), (None, None), "it has a unit")
                    else:
                        self.assertTrue(told or by_name or re.search(r"\bunit\b|\bin SI\b|in rad or m", text), "says no unit")


if __name__ == "__main__":
    unittest.main()
