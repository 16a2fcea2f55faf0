# SPDX-License-Identifier: GPL-3.0-or-later
"""An arena remembers that it failed: what is requested of one is not compared with NULL to report a shortage, it is asked once."""
import re

from common import ROOT, c_files, code_only, verdict

REQUEST = r"mt_arena_(?:alloc|f64|int|strdup|strndup|v?printf|grow)\("
FAILURE = re.compile(r"\bmt_fail_memory\(")
COMPARED = re.compile(r"([A-Za-z_][\w.\[\]]*(?:->[\w.\[\]]+)*) == NULL")
REACH = 400  # characters between a comparison and the failure that it leads to


def check(name, text):
    code = code_only(text)
    for failure in FAILURE.finditer(code):
        function = code.rfind("\n}\n", 0, failure.start()) + 1
        before = code[function:failure.start()]
        statement = max(before.rfind(";"), before.rfind("}"), len(before) - REACH)
        for compared in COMPARED.finditer(before[statement:]):
            pointer = re.escape(compared.group(1))
            if re.search(r"(?<![\w.>])" + pointer + r"\s*=\s*" + REQUEST, before):
                line = code.count("\n", 0, failure.start()) + 1
                yield f"{name}:{line}: {compared.group(1)} is an arena's: ask the arena (mt_arena_check)"


def self_test():
    ask = "static int f(void)\n{\n    int *const a = mt_arena_int(mem, n);\n    %s\n}\n"
    bad = ["if (a == NULL) {\n        return mt_fail_memory(err);\n    }",
           "if (b == NULL || a == NULL) {\n        rc = mt_fail_memory(err);\n    }",
           "return a == NULL ? mt_fail_memory(err) : MT_OK;"]
    good = ["MT_TRY(mt_arena_check(mem, err));", "if (a == NULL) {\n        return;\n    }",
            "char *const s = malloc(9);\n    if (s == NULL) {\n        return mt_fail_memory(err);\n    }"]
    problems = [f"self-test: {text} passed" for text in bad if not list(check("x", ask % text))]
    return problems + [f"self-test: {text} was refused" for text in good if list(check("x", ask % text))]


if __name__ == "__main__":
    files = c_files(ROOT / "src")
    verdict("arenas", len(files), self_test() + [fault for path in files for fault in check(path.relative_to(ROOT), path.read_text())])
