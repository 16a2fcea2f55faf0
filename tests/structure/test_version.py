# SPDX-License-Identifier: GPL-3.0-or-later
"""The version is one: of the build, the header, the Python package, the packages' names in README.md and the newest section of
CHANGELOG.md, which has a section for each version, newest first, with its date, and of at most 150 lines."""
import datetime
import re

from common import ROOT, verdict

MOST = 150
HEADING = re.compile(r"^## \[(\d+)\.(\d+)\.(\d+)\] - (\S+)$")


def sections(changelog):
    """Version, date and lines of each section, as they follow; what is not a version has None."""
    found = []
    for line in changelog.splitlines():
        if line.startswith("## "):
            match = HEADING.match(line)
            found.append([tuple(int(n) for n in match.groups()[:3]) if match else None, match and match.group(4), 0, line])
        if found:
            found[-1][2] += 1
    return found


def changelog_problems(changelog, version):
    parts = sections(changelog)
    if not parts:
        return ["CHANGELOG.md: no section of a version"]
    faults = [f"CHANGELOG.md: {line!r} is not '## [MAJOR.MINOR.PATCH] - DATE'" for number, _, _, line in parts if number is None]
    faults += [f"CHANGELOG.md: {line!r} has {count} lines, more than {MOST}" for _, _, count, line in parts if count > MOST]
    known = [part for part in parts if part[0]]
    for newer, older in zip(known, known[1:]):
        if not newer[0] > older[0]:
            faults.append(f"CHANGELOG.md: {newer[3]!r} stands above {older[3]!r}")
    for _, date, _, line in known:
        try:
            datetime.date.fromisoformat(date)
        except ValueError:
            faults.append(f"CHANGELOG.md: {line!r} has no date")
    newest = ".".join(str(n) for n in known[0][0]) if known else "none"
    if newest != version:
        faults.append(f"CHANGELOG.md: its newest version is {newest}, the build's {version}")
    return faults


def self_test():
    good = "# Changelog\n\n## [1.1.0] - 2026-12-01\n\n- a\n\n## [1.0.0] - 2026-11-28\n\n- b\n"
    wrong = {
        good: 0,
        good.replace("2026-12-01", "today"): 1,
        good.replace("## [1.1.0] - 2026-12-01", "## [Unreleased]"): 2,
        good.replace("1.1.0", "0.9.0"): 2,
        good + "- c\n" * MOST: 1,
    }
    return [f"self-test: {len(changelog_problems(text, '1.1.0'))} problems instead of {count} of {text[:60]!r}"
            for text, count in wrong.items() if len(changelog_problems(text, "1.1.0")) != count]


def main():
    read = {name: (ROOT / name).read_text(encoding="utf-8")
            for name in ("CMakeLists.txt", "CHANGELOG.md", "README.md", "include/modetune/version.h", "src/library/python/modetune/_library.py")}
    version = re.search(r"project\(modetune VERSION (\d+\.\d+\.\d+)", read["CMakeLists.txt"]).group(1)
    major, minor, patch = version.split(".")
    wanted = {
        "include/modetune/version.h": [f"#define MT_VERSION_MAJOR  {major}\n", f"#define MT_VERSION_MINOR  {minor}\n",
                                       f"#define MT_VERSION_PATCH  {patch}\n", f'#define MT_VERSION_STRING "{version}"\n'],
        "src/library/python/modetune/_library.py": [f'SONAME = "libmodetune.so.{major}"'],
        "README.md": [f"modetune_{version}_amd64.deb", f"modetune-{version}-py3-none-linux_x86_64.whl"],
    }
    faults = [f"{name}: no {text!r}" for name, texts in wanted.items() for text in texts if text not in read[name]]
    faults += changelog_problems(read["CHANGELOG.md"], version)
    verdict("version", len(read), faults + self_test())


if __name__ == "__main__":
    main()
