# SPDX-License-Identifier: GPL-3.0-or-later
"""
schemas/README.md is what schemas/reference.py makes of the schemas, and lists every member of each with its description.
MT_README_UPDATE=1 writes the page.
"""
import copy
import json
import os
import re
import sys
import unittest
from pathlib import Path

from common_document import links_to_nowhere

TREE = Path(os.environ["SOURCE_DIR"])
sys.path.append(str(TREE / "schemas"))
import reference  # noqa: E402: where it is, is known now


def members(schema):
    """(name, description) of every member in a schema, however deep."""
    if isinstance(schema, list):
        for item in schema:
            yield from members(item)
    elif isinstance(schema, dict):
        for name, value in schema.get("properties", {}).items():
            if isinstance(value, dict):
                yield name, value.get("description", "")
        for key, value in schema.items():
            yield from members(value) if key not in ("if", "enum", "default", "examples") else ()


def words(text):
    return " ".join(text.split())


class Reference(unittest.TestCase):
    def setUp(self):
        self.made = reference.Page().text()

    def test_the_page_is_what_the_schemas_say(self):
        if os.environ.get("MT_README_UPDATE"):
            reference.PAGE.write_text(self.made, encoding="utf-8")
        self.assertEqual(reference.PAGE.read_text(encoding="utf-8"), self.made, "MT_README_UPDATE=1 writes schemas/README.md")

    def test_every_schema_has_a_part_and_every_member_an_entry(self):
        self.assertEqual(set(reference.FORMATS), {p.name.removesuffix(".schema.json") for p in (TREE / "schemas").glob("*.schema.json")})
        page = words(self.made)
        found = 0
        for name in reference.FORMATS:
            for member, text in members(json.loads((TREE / f"schemas/{name}.schema.json").read_text(encoding="utf-8"))):
                found += 1
                self.assertIn(f"- `{member}` (", page, name)
                self.assertIn(words(text), page, f"{name}: {member}")
        self.assertGreater(found, 500)

    def test_links_lead_to_sections(self):
        self.assertGreater(len(re.findall(r"\]\(#", self.made)), 80)
        self.assertEqual(links_to_nowhere(self.made, TREE / "schemas"), [])
        self.assertEqual([line for line in self.made.splitlines() if len(line) > reference.WIDTH and "`" not in line], [])

    def test_a_changed_schema_changes_the_page(self):
        page = reference.Page()
        study = next(f for f in page.formats if f.name == "study")
        before = page.format(study)
        avoid = study.schema["definitions"]["goal_avoid"]
        for change in (lambda s: s["properties"]["cluster"].update(default=3),
                       lambda s: s["properties"]["cluster"].update(maximum=7),
                       lambda s: s["properties"]["margin_percent"].update(description="Otherwise."),
                       lambda s: s["required"].append("cluster"),
                       lambda s: s.update(anyOf=s["anyOf"][1:])):
            kept = copy.deepcopy(avoid)
            change(avoid)
            self.assertNotEqual(page.format(study), before)
            avoid.clear()
            avoid.update(kept)
        study.schema["properties"]["name"]["uniqueItems"] = True
        with self.assertRaises(ValueError):
            study.plain(study.schema["properties"]["name"], "name", "/name")


if __name__ == "__main__":
    sys.exit(unittest.main())
