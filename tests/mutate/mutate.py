#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Changes one token of the product at a time, and asks the tests of its module whether they notice.

Usage: mutate.py N [MODULE] [SEED]

N changes that compile are tried, in a copy of the committed sources in build/mutate, which lasts
between runs. MODULE is a folder such as decoder/localize, or files of it with commas between them.
What tests/mutate/equivalent.txt lists as the same program in other words is passed over. The exit
code is 1 when a change went unnoticed.
"""

import io
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tarfile
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
WORK = ROOT / "build" / "mutate"
SOURCE = WORK / "source"
BUILD = WORK / "build"
TEST_SECONDS = 120  # the longest takes 30: a change that makes a loop endless is noticed then

# The tests that speak of a module, where they have not its name.
TESTS = {
    "tagsmith/base": ["base", "survey", "files"],
    "tagsmith/survey": ["survey", "exchange"],
    "tagsmith/draft": ["draft", "exchange"],
    "tagsmith/cli": ["survey", "plan_command", "plan_page", "board_command", "files", "commands",
                     "exchange", "print"],
    "tagsmith/paper_plan": ["paper", "placement", "plan_command"],
    "tagsmith/placement": ["placement", "simulate", "plan_command"],
    "tagsmith/render": ["render", "print"],
    "decoder/api": ["interface", "library"],
    "decoder/cli": ["read", "demo", "ledger", "simulate_command", "adjust", "files", "report",
                    "schemas", "calibrate_command", "verify_command", "localize", "printer",
                    "commands"],
    "decoder/feature_frame": ["feature_frame", "reader"],
    "decoder/image": ["image", "files"],
    "decoder/ledger": ["ledger"],
    "decoder/localize": ["localize", "adjust"],
    "decoder/plates": ["plates", "adjust"],
    "decoder/python": ["python"],
    "decoder/scan": ["scan", "reader"],
    "decoder/simulate": ["simulate", "simulate_command"],
    "decoder/verify": ["verify", "adjust", "verify_command"],
    "decoder/calibrate": ["calibrate", "board", "printer", "calibrate_command"],
}
# The folders of tests that are called otherwise.
FOLDERS = {"board_command": "board", "interface": "library", "plan_command": "placement",
           "plan_page": "placement", "print": "render", "report": "verify",
           "simulate_command": "simulate", "verify_command": "verify", "verify_scan": "verify"}

# Binary operators stand between blanks, template brackets do not: clang-format sees to it.
SWAPS = {
    " < ": [" <= ", " >= "], " <= ": [" < ", " > "], " > ": [" >= ", " <= "],
    " >= ": [" > ", " < "], " == ": [" != "], " != ": [" == "], " && ": [" || "],
    " || ": [" && "], " + ": [" - "], " - ": [" + "], " * ": [" / "], " / ": [" * "],
    " += ": [" -= "], " -= ": [" += "], "return true;": ["return false;"],
    "return false;": ["return true;"], "(!": ["("], "std::min(": ["std::max("],
    "std::max(": ["std::min("],
}
NUMBER = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)(?![\w.'])")
STATEMENT = re.compile(r"^  +(?!return|break|continue|using|throw|case)[\w.>:\[\]-]+"
                       r"(\(.*\)| [-+*/|&]?= .*|\+\+);$")


@dataclass(frozen=True)
class Mutation:
    file: str
    line: int
    before: str
    after: str


def without_text(line: str) -> str:
    """The line with strings and comments blanked out, at the same length."""
    line = re.sub(r'"(?:[^"\\]|\\.)*"', lambda found: "~" * len(found.group()), line)
    line = re.sub(r"'(?:[^'\\]|\\.)'", lambda found: "~" * len(found.group()), line)
    return re.sub(r"//.*", lambda found: "~" * len(found.group()), line)


def mutations_of_line(line: str) -> list[str]:
    code = without_text(line)
    if not code.startswith(" ") and not code.startswith("constexpr"):
        return []
    if "static_assert" in code or "TAGSMITH_" in code or "template" in code:
        return []
    results = []
    for old, news in SWAPS.items():
        for found in re.finditer(re.escape(old), code):
            results += [line[:found.start()] + new + line[found.end():] for new in news]
    for found in NUMBER.finditer(code):
        number = found.group()
        new = f"{float(number) * 1.3 + 0.1:g}" if "." in number else str(int(number) + 1)
        results.append(line[:found.start()] + new + line[found.end():])
    if STATEMENT.match(code):
        results.append(re.match(r" *", line).group() + ";")
    return results


def mutations_of(place: str) -> list[Mutation]:
    result = []
    path = SOURCE / place
    for path in [path] if path.is_file() else sorted(path.rglob("*.cpp")):
        file = str(path.relative_to(SOURCE))
        for number, line in enumerate(path.read_text().split("\n"), 1):
            result += [Mutation(file, number, line, after) for after in mutations_of_line(line)]
    return result


def read_equivalent() -> set[tuple[str, str, str]]:
    """FILE | line before | line after | reason."""
    listed = set()
    for line in (ROOT / "tests/mutate/equivalent.txt").read_text().splitlines():
        fields = [field.strip() for field in line.split(" | ")]
        if len(fields) == 4 and not line.startswith("#"):
            listed.add((fields[0], fields[1], fields[2]))
    return listed


def run(*command: str, seconds: int | None = None) -> bool:
    environment = dict(os.environ, TAGSMITH_PROGRAM=str(BUILD / "tagsmith"))
    quiet = subprocess.DEVNULL
    with subprocess.Popen(command, cwd=SOURCE, env=environment, stdout=quiet, stderr=quiet,
                          start_new_session=True) as process:
        try:
            return process.wait(seconds) == 0
        except subprocess.TimeoutExpired:
            return False
        finally:
            if process.poll() is None:  # with what it started, which may be in an endless loop
                os.killpg(process.pid, signal.SIGKILL)


def write_changed(archive: bytes) -> None:
    """What is as it was keeps its time, so that it is not compiled again after each commit."""
    with tarfile.open(fileobj=io.BytesIO(archive)) as tar:
        for entry in tar:
            path = SOURCE / entry.name
            if entry.isfile() and path.exists():
                if path.read_bytes() == tar.extractfile(entry).read():
                    continue
                entry.mtime = time.time()
            tar.extract(entry, SOURCE)


def prepare() -> None:
    SOURCE.mkdir(parents=True, exist_ok=True)
    archive = subprocess.run(["git", "archive", "HEAD"], cwd=ROOT, stdout=subprocess.PIPE, check=True)
    write_changed(archive.stdout)
    if (BUILD / "CMakeCache.txt").exists():
        return
    launcher = []
    if shutil.which("ccache"):
        launcher = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache", "-DTAGSMITH_PRECOMPILED_HEADERS=OFF"]
    subprocess.run(["cmake", "-G", "Ninja", "-S", str(SOURCE), "-B", str(BUILD),
                    "-DCMAKE_BUILD_TYPE=Release", "-DTAGSMITH_UNITY=OFF",
                    "-DCMAKE_CXX_FLAGS_RELEASE=-O1 -finline-small-functions -DNDEBUG",
                    "--log-level=WARNING", *launcher], check=True)


def folder_of(test: str) -> Path:
    return Path("tests") / FOLDERS.get(test, test)


def tests_of(place: str) -> list[str]:
    module = "/".join(place.split("/")[:2])
    names = TESTS.get(module, [Path(module).name])
    return [name for name in names if (SOURCE / folder_of(name) / "CMakeLists.txt").exists()]


def needs_program(tests: list[str]) -> bool:
    return any("run_tagsmith" in path.read_text()
               for name in tests for path in (SOURCE / folder_of(name)).glob("*.cpp"))


def build(tests: list[str]) -> bool:
    program = ["tagsmith"] if needs_program(tests) or tests == ["python"] else []
    return run("cmake", "--build", str(BUILD), "--target", *program,
               *["tagsmith_python" if name == "python" else f"test_{name}" for name in tests])


def command_of(test: str) -> list[str]:
    if test == "python":
        return ["ctest", "--test-dir", str(BUILD), "-R", "^python$"]
    return [str(BUILD / folder_of(test) / f"test_{test}"), "--abort-after=1"]


def is_noticed(tests: list[str]) -> bool:
    return not all(run(*command_of(test), seconds=TEST_SECONDS) for test in tests)


def objects_of(file: str) -> dict[Path, bytes]:
    folder, name = os.path.split(file)
    return {path: path.read_bytes()
            for path in (BUILD / "modules" / folder).glob(f"CMakeFiles/*/{name}.o")}


def try_one(mutation: Mutation, tests: list[str]) -> bool | None:
    """Whether the tests notice; nothing where it does not compile."""
    path = SOURCE / mutation.file
    text = path.read_text()
    time_of_text = path.stat().st_mtime
    objects = objects_of(mutation.file)
    lines = text.split("\n")
    lines[mutation.line - 1] = mutation.after
    try:
        path.write_text("\n".join(lines))
        return is_noticed(tests) if build(tests) else None
    finally:
        path.write_text(text)
        os.utime(path, (time_of_text, time_of_text))
        for made, code in objects.items():  # newer than the source: not compiled again
            made.write_bytes(code)


def places(only: str | None) -> list[str]:
    if only:
        return sorted(place.rstrip("/") for place in only.split(","))
    folders = [str(path.parent.relative_to(SOURCE)) for top in ("tagsmith", "decoder")
               for path in (SOURCE / top).glob("*/CMakeLists.txt")]
    return sorted(name for name in folders if tests_of(name))


def report(mutation: Mutation, noticed: bool) -> None:
    print(f"{'noticed ' if noticed else 'SURVIVED'} {mutation.file}:{mutation.line}: "
          f"{mutation.before.strip()}  ->  {mutation.after.strip()}", flush=True)


def main() -> int:
    if len(sys.argv) < 2 or not sys.argv[1].isdigit():
        print(__doc__.strip(), file=sys.stderr)
        return 2
    count = int(sys.argv[1])
    module = sys.argv[2] if len(sys.argv) > 2 and not sys.argv[2].isdigit() else None
    seed = int(sys.argv[-1]) if len(sys.argv) > (3 if module else 2) else 1
    prepare()
    candidates = [mutation for place in places(module) for mutation in mutations_of(place)]
    random.Random(seed).shuffle(candidates)
    equivalent = read_equivalent()
    for tests in {tuple(tests_of(place)) for place in places(module)}:
        if not build(list(tests)) or is_noticed(list(tests)):
            print(f"the tests {' '.join(tests)} do not pass as they are", file=sys.stderr)
            return 2
    tried = survived = 0
    for mutation in candidates:
        if tried == count:
            break
        if (mutation.file, mutation.before.strip(), mutation.after.strip()) in equivalent:
            continue
        noticed = try_one(mutation, tests_of(mutation.file))
        if noticed is None:
            continue
        tried += 1
        survived += not noticed
        report(mutation, noticed)
    print(f"{tried - survived} of {tried} changes noticed")
    return 1 if survived else 0


if __name__ == "__main__":
    sys.exit(main())
