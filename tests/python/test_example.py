# SPDX-License-Identifier: Apache-2.0
"""The example does what it says, and the installed package is found where it was installed."""

import os
import pathlib
import re
import subprocess
import sys

import pytest


def test_the_example_draws_the_detection(photo, tmp_path):
    pytest.importorskip("matplotlib")
    picture = tmp_path / "detection.png"
    output = subprocess.run(
        [sys.executable, "docs/examples/draw_detection.py", "surveys/corridor/survey.yaml",
         str(photo), str(picture)],
        stdout=subprocess.PIPE, text=True, check=True)
    assert output.stdout.startswith("000L 019000000404 P at [472.9 229.5]")
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_the_program_in_the_library_page_runs(capsys):
    page = pathlib.Path("docs/library.md").read_text(encoding="utf-8")
    [program] = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    exec(compile(program, "docs/library.md", "exec"), {})  # pylint: disable=exec-used
    reading, position, file = capsys.readouterr().out.splitlines()
    assert reading.startswith("000L [472.8") and reading.endswith("(8, 8)")
    assert position.startswith("[ 0.99") or position.startswith("[ 1.00")
    assert file.endswith("corridor_01_left.jpg True ['']")


def test_the_installed_package_finds_its_libraries_and_templates(tmp_path):
    for component in ("runtime", "python"):
        subprocess.run(
            [os.environ["CMAKE_PROGRAM"], "--install", os.environ["BUILD_FOLDER"], "--prefix",
             str(tmp_path), "--component", component],
            stdout=subprocess.PIPE, check=True)
    share = tmp_path / "share" / "tagsmith"
    script = (
        "import tagsmith, sys\n"
        f"survey = tagsmith.Survey.load('{share}/surveys/corridor/survey.yaml')\n"
        f"print(tagsmith.__file__, tagsmith.read('{share}/surveys/corridor/photos/"
        "corridor_01_left.jpg', survey=survey).tags[0].name)\n")
    environment = {"PYTHONPATH": str(tmp_path / "lib" / "python3" / "dist-packages")}
    output = subprocess.run([sys.executable, "-c", script], cwd="/", env=environment,
                            stdout=subprocess.PIPE, text=True, check=True)
    assert output.stdout.startswith(str(tmp_path)) and output.stdout.endswith("000L\n")
