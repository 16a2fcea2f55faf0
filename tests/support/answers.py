# SPDX-License-Identifier: GPL-3.0-or-later
"""Answers of the shipped studies, for tests that look at them: each is made once, by the first that asks, and kept in the build's folder under a name that
tells the program and every shipped file. Who asks only reads. Builds that count or check what runs keep none: each process makes its own."""
import atexit
import fcntl
import functools
import hashlib
import json
import os
import shutil
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace

SOURCE = Path(os.environ.get("SOURCE_DIR", Path(__file__).resolve().parents[2]))
BUILD = Path(os.environ.get("BUILD_DIR", SOURCE / "build/release"))
PROGRAM = os.environ.get("MODETUNE", str(SOURCE / "build/release/modetune"))
KEPT = BUILD.is_dir() and not {"MT_INSTRUMENTED", "MT_TEST_LAUNCHED"} & set(os.environ)


def digest():
    """Of the program, of the names and bytes of all that a study may read, and of what chooses the processor's kernels."""
    told = hashlib.sha256()
    for name in ("OPENBLAS_CORETYPE", "GLIBC_TUNABLES"):
        told.update(f"{name}={os.environ.get(name, '')}\n".encode())
    for path in [Path(PROGRAM), *sorted(p for folder in ("problems", "studies") for p in (SOURCE / folder).rglob("*") if p.is_file())]:
        told.update(f"{path} {path.stat().st_size}\n".encode() + path.read_bytes())
    return told.hexdigest()[:32]


@functools.cache
def place():
    """Where they are kept. Answers of other programs go, unless somebody looks at any: who does holds the lock to the end."""
    if not KEPT:
        folder = tempfile.mkdtemp(prefix="modetune-answers-")
        atexit.register(shutil.rmtree, folder, ignore_errors=True)
        return Path(folder)
    root = BUILD / "tests/answers"
    mine = root / digest()
    root.mkdir(parents=True, exist_ok=True)
    lock = open(root / "lock", "w", encoding="utf-8")
    atexit.register(lock.close)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        for other in root.iterdir():
            if other.is_dir() and other != mine:
                shutil.rmtree(other)
    except BlockingIOError:
        pass
    fcntl.flock(lock, fcntl.LOCK_SH)
    mine.mkdir(exist_ok=True)
    return mine


def answer(study):
    """What `run --verify` of a study of `studies` leaves: its folder (with result.json, report.html and the rest), exit status, both outputs."""
    folder, told = place() / study.stem, place() / f"{study.stem}.told"
    with open(place() / f"{study.stem}.lock", "w", encoding="utf-8") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not told.exists():  # what a killed process has left of a folder is written over
            done = subprocess.run([PROGRAM, "run", study, "--verify", "--quiet", "-o", place()], capture_output=True, timeout=600)
            part = told.with_suffix(".part")
            part.write_text(json.dumps([done.returncode, done.stdout.decode(), done.stderr.decode()]), encoding="utf-8")
            part.replace(told)
    status, stdout, stderr = json.loads(told.read_text(encoding="utf-8"))
    return SimpleNamespace(folder=folder, returncode=status, stdout=stdout.encode(), stderr=stderr.encode())


def answers(studies):
    """Of many of them, two at a time."""
    with ThreadPoolExecutor(2) as pool:
        return list(pool.map(answer, studies))
