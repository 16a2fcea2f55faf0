# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes a finding small: drops node after node of all files, as long as the same check fails with the same kind of sentence."""
import random
import re
import tempfile
from pathlib import Path

import document
from commands import Answer


def _sort(text):
    """What kind of finding a sentence tells of: its words without numbers and places."""
    text = text.rsplit(": ", 3)[-1] if "Sanitizer" not in text else "".join(re.findall(r"#\d+ 0x\w+ in (\w+)", text)[:6])
    return re.sub(r"[-\d.e+]+", "#", text)[:60]


def _fails(program, case, check, sort, seeds):
    """A finding of that check and sort; commands are drawn again, so that a few draws are tried."""
    for seed in seeds:
        with tempfile.TemporaryDirectory() as scratch:
            case.write(Path(scratch))
            for found, text in Answer(program, Path(scratch), case, {"commands": 0}).findings(random.Random(seed)):
                if found == check and (sort is None or _sort(text) == sort):
                    return text
    return None


def _smaller(tree):
    """Trees with a node less, the great ones first; or with shorter text."""
    places = sorted(((len(document.write(value)), path) for path, _, value in document.nodes(tree)), key=lambda p: (-p[0], p[1]))
    for _, path in places:
        less = document.copy(tree)
        del document.at(less, path[:-1])[path[-1]]
        yield less
    for _, path in places:
        value = document.at(tree, path)
        if isinstance(value, str) and not isinstance(value, document.Number) and len(value) > 20:
            less = document.copy(tree)
            document.put(less, path, value[:len(value) // 2])
            yield less


def shrink(program, case, check, text):
    sort = _sort(text)
    seeds = [s for s in range(12) if _fails(program, case, check, sort, [s])][:1]
    progress = bool(seeds)
    while progress:
        progress = False
        for place in sorted(case.files, key=lambda p: p != case.target):
            try:
                tree = document.read(case.files[place])
            except (ValueError, TypeError, RecursionError):
                continue  # harmed below the level of JSON
            for less in _smaller(tree):
                kept, case.files[place] = case.files[place], document.write(less, 1)
                if _fails(program, case, check, sort, seeds):
                    progress = True
                    break
                case.files[place] = kept
            if progress:
                break
    return case


def save(program, case, check, text, folder):
    case = shrink(program, case, check, text)
    case.write(folder)
    print(f"{sum(len(t) for t in case.files.values())} bytes in {folder}: {_fails(program, case, check, None, range(12)) or 'does not fail'}")
