# SPDX-License-Identifier: Apache-2.0
"""Localization: the same as the program's, batch and live."""

import csv
import json
import os
import subprocess
import types

import numpy as np
import pytest
import tagsmith

FILES = ["surveys/corridor/survey.yaml", "--rig", "surveys/corridor/rig.yaml"]


def rows():
    with open("surveys/corridor/run.csv", encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def images_of(row):
    return {side: f"surveys/corridor/{row[side]}" for side in ("left", "right")}


def check_equal(fix, line):
    assert line["status"] == "ok" and fix.tags == line["tags"]
    np.testing.assert_allclose(fix.position, [line[axis] for axis in "xyz"], atol=1e-6)


def test_a_run_is_located_as_the_program_does(survey, rig, program):
    lines = program("localize", *FILES, "--run", "surveys/corridor/run.csv", "--json")
    localizer = tagsmith.Localizer(survey, rig)
    for row, line in zip(rows(), lines):
        fix = localizer.locate(images_of(row), ranges={"d": float(row["d"])}, id=row["id"])
        position = line.get("position") or [line[axis] for axis in "xyz"]
        assert fix.id == line["id"] and fix.tags == line["tags"]
        np.testing.assert_allclose(fix.position, position, atol=1e-5)
        truth = [float(row[f"truth_{axis}"]) for axis in "xyz"]
        assert np.linalg.norm(fix.position - truth) < 1e-3
        assert fix.covariance.shape == (3, 3) and fix.pose_covariance.shape == (6, 6)


def test_a_drive_is_followed_as_the_program_does(survey, rig):
    drive = [{"id": row["id"], "time": 0.5 * i, "d": float(row["d"]), **images_of(row)}
             for i, row in enumerate(rows()[:4])]
    output = subprocess.run(
        [os.environ["TAGSMITH_PROGRAM"], "localize", *FILES, "--follow", "--json"],
        input="\n".join(map(json.dumps, drive)) + "\n", stdout=subprocess.PIPE, text=True,
        check=False)
    lines = [json.loads(line) for line in output.stdout.splitlines()]
    localizer = tagsmith.Localizer(survey, rig)
    assert len(lines) == len(drive)
    for step, line in zip(drive, lines):
        images = {side: step[side] for side in ("left", "right")}
        fix = localizer.track(step["time"], images, ranges={"d": step["d"]})
        position = line.get("position") or [line[axis] for axis in "xyz"]
        np.testing.assert_allclose(fix.position, position, atol=1e-5)
        assert fix.confirmations == line["confirmations"]


def test_tags_that_were_read_before_need_no_image(survey, rig):
    row = rows()[0]
    tags = {}
    for camera in rig.cameras:
        tags[camera.name] = tagsmith.read(images_of(row)[camera.name], survey=survey,
                                          camera=camera).tags
    localizer = tagsmith.Localizer([survey], rig)
    by_tags = localizer.locate(tags=tags, ranges={"d": float(row["d"])})
    by_images = localizer.locate(images_of(row), ranges={"d": float(row["d"])})
    # The images show a part of one more tag.
    assert by_images.tags == by_tags.tags + ["001R"]
    np.testing.assert_allclose(by_tags.position, by_images.position, atol=2e-4)


def test_without_a_position_the_fix_says_why(survey, rig):
    dark = np.zeros((960, 1280), np.uint8)
    fix = tagsmith.Localizer(survey, rig).locate({"left": dark})
    assert fix.position is None and fix.covariance is None and fix.attitude is None
    assert fix.reason


def test_one_tag_alone_is_not_confirmed(survey, rig):
    images = {"left": images_of(rows()[0])["left"]}
    assert tagsmith.Localizer(survey, rig).locate(images).position is not None
    strict = tagsmith.Localizer(survey, rig, confirmed_only=True)
    assert "confirms" in strict.locate(images).reason


def test_names_that_the_rig_does_not_have_are_refused(survey, rig):
    localizer = tagsmith.Localizer(survey, rig)
    with pytest.raises(tagsmith.Error, match="no camera `front`"):
        localizer.locate({"front": images_of(rows()[0])["left"]})
    with pytest.raises(tagsmith.Error, match="no range `e`"):
        localizer.locate(ranges={"e": 1.0})
    with pytest.raises(tagsmith.Error, match="duplicate-survey"):
        tagsmith.Localizer([survey, survey], rig)


def test_what_nothing_measured_would_reveal_is_shown_in_words(survey, rig):
    row = rows()[0]
    fix = tagsmith.Localizer(survey, rig).locate({"left": images_of(row)["left"]})
    assert fix.unchecked
    for mistake in fix.unchecked:
        words = repr(mistake)
        assert "Unchecked" in words and mistake.kind in words and mistake.name in words
        assert " at 0x" not in words


def test_arguments_of_another_type_are_told_from_what_was_expected(survey, rig):
    with pytest.raises(TypeError, match="surveys is of type str, expected a Survey"):
        tagsmith.Localizer("surveys/corridor/survey.yaml", rig)
    seen = types.SimpleNamespace(digits=19000000404, corners=np.zeros((4, 2)))
    with pytest.raises(TypeError, match="digits is of type int, expected a str"):
        tagsmith.Localizer(survey, rig).locate(tags={"left": [seen]})
