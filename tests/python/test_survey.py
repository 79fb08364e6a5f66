# SPDX-License-Identifier: Apache-2.0
"""Surveys, rigs, files, plans, and how values show themselves."""

import ast
import copy
import pathlib
import pickle

import numpy as np
import pytest
import tagsmith


def test_a_survey_has_its_tags(survey):
    assert survey.name == "corridor" and len(survey) == len(survey.tags) == 16
    tag = survey.find("000L")
    assert tag.side == "left" and tag.digits == survey.find(tag.digits).digits
    np.testing.assert_allclose(tag.corner_p, [1.9, 0, 0.4])
    assert survey.find("999L") is None


def test_a_rig_has_its_cameras(rig):
    assert [camera.name for camera in rig.cameras] == ["left", "right"]
    assert rig.ranges == ["d"]
    rotation = rig.cameras[0].rotation
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)


def test_errors_have_a_code_and_the_words_of_the_program(tmp_path):
    with pytest.raises(tagsmith.Error, match="no such file") as missing:
        tagsmith.Survey.load(tmp_path / "none.yaml")
    assert missing.value.code == "file_missing"
    with pytest.raises(tagsmith.Error, match="expected a survey") as wrong:
        tagsmith.Survey.load("surveys/corridor/rig.yaml")
    assert wrong.value.code == "invalid_file"
    assert issubclass(tagsmith.Error, RuntimeError)


def test_validate_names_places(tmp_path):
    assert tagsmith.validate("surveys/corridor/survey.yaml") == []
    text = pathlib.Path("surveys/corridor/survey.yaml").read_text(encoding="utf-8")
    broken = tmp_path / "survey.yaml"
    broken.write_text(text.replace("tags:", "tagz:"), encoding="utf-8")
    findings = tagsmith.validate(broken)
    assert {finding.severity for finding in findings} == {"error"}
    assert any(finding.line > 0 and "tagz" in finding.message for finding in findings)


def test_a_printed_tag_verifies(survey, photo, tmp_path):
    page = tmp_path / "000L.pdf"
    tagsmith.print_tag(survey, "000L", page)
    printed, taken, broken = tagsmith.verify(survey, [page, photo, tmp_path / "none.jpg"])
    assert printed.is_ok and [tag.tag for tag in printed.tags] == ["000L"]
    assert taken.is_ok and taken.tags[0].status == "ok"
    assert not broken.is_ok and not broken.readable
    with pytest.raises(tagsmith.Error, match="no tag"):
        tagsmith.print_tag(survey, "999L", page)


def test_a_plan_says_what_is_read(survey, rig):
    plan = tagsmith.plan(survey, rig, start=0, end=1)
    assert plan.covered_share == 1 and plan.gaps == []
    assert 0 < plan.plane_sigma.median < 0.01
    with pytest.raises(tagsmith.Error, match="step"):
        tagsmith.plan(survey, rig, step=0)


def test_values_show_what_they_are(survey):
    assert repr(survey) == "Survey(name='corridor', 16 tags)"
    shown = repr(survey.find("000L"))
    assert shown == ("SurveyTag(name='000L', digits='019000000404', side='left', "
                     "corner_p=[1.9, 0.0, 0.4])")
    assert tagsmith.Tag.__module__ == "tagsmith"


def stub_classes(tree):
    """The classes of the stub and the names in each, those of its own making apart."""
    return {
        node.name: {part.name for part in node.body if isinstance(part, ast.FunctionDef)}
        for node in tree.body
        if isinstance(node, ast.ClassDef) and node.name != "SeenLike"
    }


def test_the_stub_says_what_the_module_has():
    folder = pathlib.Path(tagsmith.__file__).parent
    assert (folder / "py.typed").exists()
    tree = ast.parse((folder / "__init__.pyi").read_text(encoding="utf-8"))
    classes = stub_classes(tree)
    functions = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
    assert set(classes) | functions == set(tagsmith.__all__)
    for name, members in classes.items():
        if name == "Error":
            continue
        public = {member for member in vars(getattr(tagsmith, name)) if not member.startswith("_")}
        assert public == {member for member in members if not member.startswith("_")}, name


def test_all_that_is_public_is_documented():
    for name in tagsmith.__all__:
        assert getattr(tagsmith, name).__doc__, name


def values(survey, rig, photo):
    result = tagsmith.read(photo, survey=survey)
    return [survey, survey.plate, survey.tags[0], rig, rig.cameras[0], result, result.tags[0],
            tagsmith.draw_tag("036000291452")]


def test_a_copy_of_a_value_is_the_value(survey, rig, photo):
    for value in values(survey, rig, photo):
        assert copy.copy(value) is value and copy.deepcopy(value) is value
        assert copy.deepcopy({"kept": [value]})["kept"][0] is value


def test_what_cannot_be_sent_to_other_processes_says_so(survey, rig, photo):
    for value in [*values(survey, rig, photo), tagsmith.Localizer(survey, rig)]:
        with pytest.raises(TypeError, match="cannot pickle .*" + type(value).__name__):
            pickle.dumps(value)
    with pytest.raises(TypeError, match="Localizer"):
        copy.copy(tagsmith.Localizer(survey, rig))


def test_objects_that_were_not_constructed_are_refused(photo):
    classes = [kind for kind in vars(tagsmith).values()
               if isinstance(kind, type) and kind is not tagsmith.Error]
    assert len(classes) > 20
    for kind in classes:
        attributes = [name for name, value in vars(kind).items() if isinstance(value, property)]
        for name in attributes or ["reset"]:
            with pytest.raises(TypeError, match="not constructed"):
                value = getattr(kind.__new__(kind), name)
                value()
    with pytest.raises(TypeError, match="not constructed"):
        tagsmith.read(photo, survey=tagsmith.Survey.__new__(tagsmith.Survey))
