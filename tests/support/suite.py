# SPDX-License-Identifier: GPL-3.0-or-later
"""What the environment tells a test: the program, the tree, how much of a sample it takes, which random cases."""
import os
from pathlib import Path

SOURCE = Path(os.environ.get("SOURCE_DIR", Path(__file__).resolve().parents[2]))
PROGRAM = os.path.abspath(os.environ.get("MODETUNE", SOURCE / "build/release/modetune"))
EVERY = os.environ.get("MT_EVERY", "0") != "0"     # all of what else is a sample
INSTRUMENTED = "MT_INSTRUMENTED" in os.environ     # with sanitizers, or what counts lines: each run takes many times as long
LAUNCHED = "MT_TEST_LAUNCHED" in os.environ        # under valgrind
FEW = not EVERY and not INSTRUMENTED
SEED = os.environ.get("MT_SEED", "1")              # of a test's random cases


def count(few, every=None, instrumented=None):
    """How many random cases: MT_COUNT, or what is right for the build."""
    usual = every if EVERY else instrumented if INSTRUMENTED else few
    return int(os.environ.get("MT_COUNT", few if usual is None else usual))
