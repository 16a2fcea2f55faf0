#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""
A wheel of the Python package with libmodetune.so in it, by the standard library alone.

    make_wheel.py --library LIBMODETUNE.SO --out DIR

It is linked to the libraries of the distribution that it was built on and belongs there: the
tag is linux_<machine>, not manylinux. The same files give the same bytes. Prints its path.
"""
from __future__ import annotations

import argparse
import base64
import hashlib
import re
import sysconfig
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
EPOCH = (1980, 1, 1, 0, 0, 0)  # the least that a zip file knows
FILE_MODE = 0o100644 << 16
SUMMARY = "What to change so that a mechanism's natural frequencies land where they must"


def version() -> str:
    """That of the header."""
    text = (ROOT / "include/modetune/version.h").read_text(encoding="utf-8")
    found = re.search(r'#define MT_VERSION_STRING "([^"]+)"', text)
    if found is None:
        raise SystemExit("make_wheel.py: include/modetune/version.h has no version")
    return found.group(1)


def record(name: str, content: bytes) -> str:
    """A line of RECORD."""
    digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
    return f"{name},sha256={digest},{len(content)}\n"


def metadata(number: str) -> str:
    return (f"Metadata-Version: 2.1\nName: modetune\nVersion: {number}\nSummary: {SUMMARY}\n"
            "License: GPL-3.0-or-later\nRequires-Python: >=3.9\nProvides-Extra: arrays\n"
            "Requires-Dist: numpy; extra == 'arrays'\n")


def contents(library: Path, number: str, tag: str) -> dict[str, bytes]:
    """{name in the wheel: content}, RECORD last."""
    info = f"modetune-{number}.dist-info"
    files = {f"modetune/{path.name}": path.read_bytes()
             for path in sorted((HERE / "modetune").glob("*.py*")) if path.is_file()}
    files["modetune/libmodetune.so"] = library.read_bytes()
    files[f"{info}/LICENSE"] = (ROOT / "LICENSE").read_bytes()
    files[f"{info}/METADATA"] = metadata(number).encode()
    files[f"{info}/WHEEL"] = ("Wheel-Version: 1.0\nGenerator: make_wheel.py\n"
                              f"Root-Is-Purelib: false\nTag: {tag}\n").encode()
    lines = [record(name, content) for name, content in files.items()]
    files[f"{info}/RECORD"] = ("".join(lines) + f"{info}/RECORD,,\n").encode()
    return files


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").strip().partition("\n")[0])
    parser.add_argument("--library", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    args = parser.parse_args()
    number = version()
    tag = "py3-none-" + re.sub(r"\W", "_", sysconfig.get_platform())
    path = args.out / f"modetune-{number}-{tag}.whl"
    args.out.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as wheel:
        for name, content in contents(args.library, number, tag).items():
            entry = zipfile.ZipInfo(name, EPOCH)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = FILE_MODE
            wheel.writestr(entry, content)
    print(path)


if __name__ == "__main__":
    main()
