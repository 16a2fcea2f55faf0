# SPDX-License-Identifier: GPL-3.0-or-later
"""The shipped files, as cases: a few files that lie together, one of which will be changed."""
import json
import os
import random
import subprocess
import tempfile
from pathlib import Path

import document

SOURCE = Path(os.environ.get("SOURCE_DIR", Path(__file__).resolve().parents[2]))
BUDGET = (("starts", "2"), ("max_evaluations", "150"))  # the question is kept, its search is short
MANY = 4  # goals
FORMATS = {"modetune-model/1": "model", "modetune-study/1": "study", "modetune-result/1": "result", "modetune-aircraft/1": "aircraft",
           "modetune-profile/1": "profile"}
PLACES = {"model": "problems/changed.json", "aircraft": "problems/changed_aircraft.json", "profile": "problems/profiles/changed.json", "study": "studies/changed.json",
          "result": "results/changed/result.json"}


class Case:
    """Files by their places, of which `target`, a `kind`, was or will be changed; `original` is its tree as shipped."""

    def __init__(self, kind, name, tree, others):
        self.kind, self.name, self.target, self.original = kind, name, PLACES[kind], tree
        self.files = {**others, self.target: document.write(tree, 2)}

    def write(self, folder):
        for place, text in self.files.items():
            path = folder / place
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(text if isinstance(text, bytes) else text.encode("utf-8", "surrogateescape"))


def _read(path):
    return document.read(path.read_text(encoding="utf-8"))


def cheap(tree):
    """A study with a small budget."""
    search = tree.get("search") if isinstance(tree.get("search"), document.Object) else document.Object()
    for name, value in BUDGET:
        search.put(name, document.Number(value))
    tree.put("search", search)
    if len(tree.get("goals", [])) > MANY:
        tree.drop("spread")  # which searches twice more for every goal
    return tree


def _question(model):
    """A study of a model that none of the shipped studies asks about."""
    parameters = [key for key, value in model.get("parameters", document.Object()) if not isinstance(value, str)][:2]
    study = {"format": "modetune-study/1", "model": "../problems/changed.json", "goals": [{"type": "frequency", "mode": 1, "at_least_hz": 0.5}]}
    configurations = model.get("configurations")
    if configurations:
        study["goals"][0]["configuration"] = configurations[0][0]
    if parameters:
        study["variables"] = [{"parameter": p, "lower": f"0.8*{p}", "upper": f"1.3*{p}"} for p in parameters]
    return cheap(document.read(json.dumps(study)))


class Corpus:
    """What is shipped, read once."""

    def __init__(self, program):
        self.program, self._results = program, {}
        self.trees, self.studies = {kind: {} for kind in PLACES}, {}
        places = ["problems", "problems/profiles", "studies", "tests/models", "tests/documents/good"]
        for path in sorted(p for place in places for p in (SOURCE / place).glob("*.json")):
            tree = _read(path)
            kind = FORMATS.get(tree.get("format"))
            if kind:
                self.trees[kind][str(path.relative_to(SOURCE))] = tree
        for path in sorted((SOURCE / "tests/hunt/cases").glob("*.json")) + sorted((SOURCE / "tests/mechanisms/cases").glob("*.json")):
            tree = _read(path)
            for kind in ("model", "study"):
                if tree.get(kind) is not None:
                    self.trees[kind][f"{path.relative_to(SOURCE)}#{kind}"] = tree.get(kind)
        self.values = {}  # of each member name, values that shipped files give it
        for kind in ("model", "study", "aircraft", "profile"):
            for tree in self.trees[kind].values():
                for _, key, value in document.nodes(tree):
                    self.values.setdefault(key, []).append(value)
        self.names = sorted(key for key in self.values if key)

    def _near(self, name, path):
        """The file that another one names, and its place among the case's files."""
        return os.path.normpath(os.path.join(os.path.dirname(name), path))

    def _models_of(self, name, study):
        """The files that a study names, with places in problems/; the study is made to name them there."""
        files = {}
        if "#" in name:
            files["problems/changed.json"] = document.write(self.trees["model"][name.replace("#study", "#model")], 1)
            study.put("model", "../problems/changed.json")
            return files
        named = [(study, "model")] + [(r, "model") for _, _, r in document.nodes(study.get("references", document.Object()))
                                      if isinstance(r, document.Object) and isinstance(r.get("model"), str)]
        named += [(m, "file") for _, _, m in document.nodes(study.get("measurements", document.Object()))
                  if isinstance(m, document.Object) and isinstance(m.get("file"), str)]
        named += [(study, "aircraft")] if study.get("aircraft") else []
        for where, member in named:
            path = SOURCE / self._near(name, where.get(member))
            if path.exists():
                files[f"problems/{path.name}"] = path.read_text(encoding="utf-8")
                where.put(member, f"../problems/{path.name}")
        files["problems/aircraft.json"] = (SOURCE / "problems/aircraft.json").read_text(encoding="utf-8")
        return files

    def study(self, name):
        tree = cheap(document.copy(self.trees["study"][name]))
        return Case("study", name, tree, self._models_of(name, tree))

    def model(self, name, rng=None):
        asking = [s for s, tree in self.trees["study"].items()
                  if (s == name.replace("#model", "#study") if "#" in name else self._near(s, tree.get("model")) == name)]
        study, files = _question(self.trees["model"][name]), {}
        if asking and rng is not None and rng.random() < 0.8:
            asked = rng.choice(asking)
            study = cheap(document.copy(self.trees["study"][asked]))
            files = self._models_of(asked, study)
            study.put("model", "../problems/changed.json")
        files[PLACES["study"]] = document.write(study, 1)
        return Case("model", name, document.copy(self.trees["model"][name]), files)

    def aircraft(self, name):
        study = cheap(document.copy(self.trees["study"]["studies/inceptor_catalogue.json"]))
        files = self._models_of("studies/inceptor_catalogue.json", study)
        study.put("aircraft", "../problems/changed_aircraft.json")
        files[PLACES["study"]] = document.write(study, 1)
        return Case("aircraft", name, document.copy(self.trees["aircraft"][name]), files)

    def profile(self, name):
        tree = document.copy(self.trees["profile"][name])
        files = {}
        if tree.get("aircraft"):
            files["problems/aircraft.json"] = (SOURCE / self._near(name, tree.get("aircraft"))).read_text(encoding="utf-8")
            tree.put("aircraft", "../aircraft.json")
        return Case("profile", name, tree, files)

    def result(self, name):
        """What the program itself makes of a shipped study."""
        if name not in self._results:
            with tempfile.TemporaryDirectory() as scratch:
                case = self.study(name)
                case.write(Path(scratch))
                done = subprocess.run([self.program, "run", case.target, "-o", "results", "--quiet"], cwd=scratch, capture_output=True,
                                      encoding="utf-8", timeout=600)
                path = Path(scratch) / PLACES["result"]
                self._results[name] = document.read(path.read_text(encoding="utf-8")) if done.returncode in (0, 1) and path.exists() else None
        if self._results[name] is None:
            return None
        study = self.study(name)
        return Case("result", name, document.copy(self._results[name]), study.files)

    def pick(self, rng, kind):
        """A case of that kind. Most cases stay what they are when a file is added to those shipped: each file draws, the least wins."""
        key = rng.random()
        names = [s for s in self.trees["study"] if s.startswith("studies/")] if kind == "result" else list(self.trees[kind])
        for name in sorted(names, key=lambda n: random.Random(f"{key}:{n}").random()):
            made = self.model(name, rng) if kind == "model" else getattr(self, kind)(name)
            if made is not None:
                return made
        raise ValueError(f"no case of kind {kind}")
