# SPDX-License-Identifier: GPL-3.0-or-later
"""Below src/cli nothing prints, exits, reads the clock or the environment, or keeps global state; text has one door."""
import os
import re
import subprocess
import tempfile
from pathlib import Path

from common import ROOT, c_files, code_only, verdict

CALLS = """printf vprintf puts putchar perror scanf getchar gets
    exit _exit _Exit quick_exit abort atexit system
    getenv secure_getenv setenv putenv time clock clock_gettime gettimeofday localtime gmtime
    rand srand random srandom drand48 setlocale strtok alloca longjmp signal sleep usleep
    gsl_set_error_handler gsl_set_error_handler_off gsl_qrng_alloc""".split()
FORBIDDEN = re.compile(r"(?<![\w.>])(?:(" + "|".join(CALLS) + r")\s*\(|(stdout|stderr|stdin)\b)")
WALKS = re.compile(r"\bmt_json_(?:count|first|next)\s*\(")  # whoever counts one way and fills another way writes past the end
WALKERS = ("json.h", "json.c")
MUTABLE = re.compile(r" O (\.data(?!\.rel\.ro)|\.bss|\.tdata|\.tbss|\*COM\*)\S*\s+\S+\s+(?:\.hidden )?(\S+)$")
# Formatted text is made by base/format.c, which knows words for what is not finite, makes arguments visible and has a decimal point that no locale moves. The
# terminal has its door in cli/terminal.c.
FORMATS = re.compile(r"(?<![\w.>])(v?sn?printf)\s*\(")
FORMATTERS = {"base/format.c", "base/text.c"}
STREAMS = re.compile(r"(?<![\w.>])(v?f?printf|f?puts|f?putc|putchar|fwrite|perror|stdout|stderr)\b")
TERMINAL = {"cli/terminal.c"}
# Files are opened by io/file.c, once for reading and once for writing, which follows no link at the last part of a name and waits for no pipe; io/folder.c and
# io/journal.c rename and remove. main's standard streams are no files.
OPENS = re.compile(r"(?<![\w.>])(open(?:at)?(?:64)?|creat(?:64)?|f(?:re)?open(?:64)?|fdopen(?:dir)?|mkd?s?o?temp|tmp(?:file|nam)|opendir|scandir|n?ftw|mkfifo(?:at)?|mknod(?:at)?|popen|mmap)\s*\(")
OPENERS = {"io/file.c", "cli/terminal.c"}
MOVES = re.compile(r"(?<![\w.>])(rename(?:at)?|(?:un|sym)?link(?:at)?|remove|rmdir|mkdir(?:at)?|f?truncate|f?chmod(?:at)?|f?chown(?:at)?)\s*\(")
MOVERS = {"io/folder.c", "io/journal.c"}
LOADS = re.compile(r"(?<![\w.>])(dl(?:m?open|v?sym|close))\s*\(")  # a library that only some need, by its own door
LOADERS = {"linalg/sparse.c"}
CONVERSION = re.compile(r"%(?:%|[-+#0]*(?:\*|\d+)?(?:\.(?:\*|\d+))?(hh?|ll?|[jztLq])?([a-zA-Z]))")
LITERAL = re.compile(r'"(?:[^"\\\n]|\\.)*"')


def check_doors(name, text):
    """name: relative to src."""
    code = code_only(text)
    for pattern, doors in ((FORMATS, FORMATTERS), (STREAMS, TERMINAL), (OPENS, OPENERS), (MOVES, MOVERS), (LOADS, LOADERS)):
        for match in pattern.finditer(code) if name not in doors else []:
            yield f"{name}:{code.count(chr(10), 0, match.start()) + 1}: {match.group(1)} is for {', '.join(sorted(doors))} alone"
    for literal in LITERAL.findall(text) if name not in FORMATTERS else []:
        for length, conversion in CONVERSION.findall(literal):
            if conversion and (conversion not in "diuxXcsefg" or length not in ("", "l", "ll", "z")):
                yield f"{name}: base/format.h does not know %{length}{conversion} of {literal}"


def check_text(name, text):
    code = code_only(text)
    for match in FORBIDDEN.finditer(code):
        line = code.count("\n", 0, match.start()) + 1
        yield f"{name}:{line}: {match.group(1) or match.group(2)} is for src/cli alone"
    if Path(name).name not in WALKERS and WALKS.search(code):
        yield f"{name}: items are counted and walked by mt_reader_items (io/reader.h)"


def check_object(path):
    """Variables of an object or archive that stand in writable memory."""
    table = subprocess.run(["objdump", "-t", path], check=True, capture_output=True, text=True).stdout
    member = Path(path).name
    for line in table.splitlines():
        if ":     file format" in line:
            member = line.partition(":")[0]
        found = MUTABLE.search(line)
        if found:
            yield f"{member}: {found.group(2)} is a mutable global ({found.group(1)})"


def self_test():
    """Faults are found; names that only look like them, comments and literals are not."""
    bad = ['printf("x");', "exit(1);", "x = getenv(name);", 'fprintf(stderr, "x");', "t = time(NULL);",
           "r = rand ();", "strtok(s, d);",
           "n = mt_json_count(doc, list);"]
    good = ["snprintf(b, n, f);", "/* printf(x) */", 's = "exit(1)";', "f->time(x);", "my_exit(1);",
            "fprintf(f, x);", "double time;"]
    problems = [f"self-test: {line} passed" for line in bad if not list(check_text("x", line))]
    problems += [f"self-test: {line} was refused" for line in good if list(check_text("x", line))]
    for line in ("(void)snprintf(b, n, f);", "fputs(s, stderr);", "fd = open(path, O_RDONLY);", 'f = fopen(path, "re");', "fd = openat (at, s, how);",
                 "(void)unlinkat(at, path, 0);", "remove(path);", "fd = mkstemp(s);", "p = dlopen(name, RTLD_NOW);", 'mt_text_addf(t, "%5hd", x);', 'mt_text_addf(t, "%p", x);'):
        if not list(check_doors("search/x.c", line)):
            problems.append(f"self-test: {line} passed the doors")
    for line in ('mt_text_addf(t, "100 %% of %ld, %-3.*s", x);', "mt_snprintf(b, n, f);", "fd = mt_file_open(at, s);", "rc = open_file(j);",
                 "mt_json_open(w, NULL, c);", "j->remove(x);"):
        problems += [f"self-test: {fault}" for fault in check_doors("search/x.c", line)]
    source = """static int counter; int next(void); int next(void) { return ++counter; }
        const char *const names[]; const char *const names[] = {"a"};
        int filled[2] = {1, 2}; int once(void); int once(void) { static int seen = 3; return seen++; }"""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "x.c")
        path.write_text(source)
        subprocess.run([os.environ.get("CC", "cc"), "-fPIC", "-fvisibility=hidden", "-c", path, "-o",
                        f"{path}.o"], check=True)
        found = " ".join(check_object(f"{path}.o"))
        for name in ("counter", "filled", "seen"):
            if name not in found:
                problems.append(f"self-test: mutable {name} was not found")
        if "names" in found:
            problems.append("self-test: constant names counted as mutable")
    return problems


if __name__ == "__main__":
    sources = [p for p in c_files(ROOT / "src") if p.relative_to(ROOT / "src").parts[0] != "cli"]
    faults = [f for p in sources for f in check_text(p, p.read_text(encoding="utf-8"))]
    for path in c_files(ROOT / "src"):
        faults += check_doors(str(path.relative_to(ROOT / "src")), path.read_text(encoding="utf-8"))
    library = Path(os.environ.get("BUILD_DIR", ROOT / "build/release"), "libmodetune.a")
    if os.environ.get("MT_INSTRUMENTED", "0") != "1":  # sanitizers and counters add their own data
        faults += check_object(library)
    verdict("calls", len(sources), faults + self_test())
