# SPDX-License-Identifier: Apache-2.0
"""What the tests of the Python module share. They run from the project's root."""

import json
import os
import pathlib
import subprocess

import pytest
import tagsmith

CORRIDOR = pathlib.Path("surveys/corridor")


@pytest.fixture(scope="session")
def survey():
    return tagsmith.Survey.load(CORRIDOR / "survey.yaml")


@pytest.fixture(scope="session")
def rig():
    return tagsmith.Rig.load(CORRIDOR / "rig.yaml")


@pytest.fixture(scope="session")
def photo():
    return CORRIDOR / "photos" / "corridor_01_left.jpg"


@pytest.fixture
def program():
    """Runs the program with these arguments: the objects of its JSON lines."""

    def run(*arguments, **options):
        output = subprocess.run(
            [os.environ["TAGSMITH_PROGRAM"], *map(str, arguments)],
            stdout=subprocess.PIPE, text=True, check=False, **options)
        return [json.loads(line) for line in output.stdout.splitlines()]

    return run
