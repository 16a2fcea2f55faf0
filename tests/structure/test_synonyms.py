# SPDX-License-Identifier: GPL-3.0-or-later
"""What io/synonyms.c offers in place of another word is a member or a choice that the schemas know, and no word is one already."""
import json
import re

from common import ROOT, verdict


def words_of(value, found):
    """Members and choices of a schema, wherever they stand."""
    if isinstance(value, dict):
        found |= set(value.get("properties", {})) | {v for v in value.get("enum", []) if isinstance(v, str)}
        found |= {value["const"]} if isinstance(value.get("const"), str) else set()
        for item in value.values():
            words_of(item, found)
    elif isinstance(value, list):
        for item in value:
            words_of(item, found)
    return found


def main():
    known = set()
    for name in ("model", "study"):
        words_of(json.loads((ROOT / f"schemas/{name}.schema.json").read_text(encoding="utf-8")), known)
    text = (ROOT / "src/io/synonyms.c").read_text(encoding="utf-8")
    table = re.findall(r'\{"([^"]+)",\s*((?:"[^"]*"\s*)+)\}', text)
    problems = [f"src/io/synonyms.c: the schemas know no {name}" for name, _ in table if name not in known]
    for name, strings in table:
        joined = "".join(re.findall(r'"([^"]*)"', strings))
        if not (joined.startswith(" ") and joined.endswith(" ")):
            problems.append(f"src/io/synonyms.c: the words of {name} do not begin and end with a blank")
        problems += [f"src/io/synonyms.c: {word} stands twice for {name}" for word in set(joined.split()) if joined.split().count(word) > 1]
        problems += [f"src/io/synonyms.c: {word} of {name} is in no plain form" for word in joined.split() if not re.fullmatch(r"[a-z0-9_]+", word)]
    assert len(table) > 30
    verdict("synonyms", len(table), problems)


if __name__ == "__main__":
    main()
