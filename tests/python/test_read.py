# SPDX-License-Identifier: Apache-2.0
"""Reading: the same as the program reads, from arrays that are not copied."""

import threading
import time

import numpy as np
import pytest
import tagsmith


def test_a_photo_is_read_as_the_program_reads_it(survey, photo, program):
    [line] = program("read", photo, "--survey", "surveys/corridor/survey.yaml", "--json")
    result = tagsmith.read(photo, survey=survey)
    [tag], [expected] = result.tags, line["tags"]
    assert tag.digits == expected["digits"] == "019000000404"
    assert (tag.name, tag.survey, tag.method) == ("000L", "corridor", expected["method"])
    assert tag.sum10_holds
    np.testing.assert_allclose(tag.corners, expected["corners"], atol=5e-4)
    np.testing.assert_allclose(tag.position, expected["position"], atol=1e-6)
    assert tag.module_px == pytest.approx(expected["module_px"], abs=1e-3)


def test_corners_have_a_covariance(survey, photo):
    [tag] = tagsmith.read(photo, survey=survey).tags
    assert tag.corners.shape == (4, 2)
    assert tag.corner_covariance.shape == (8, 8)
    np.testing.assert_allclose(tag.corner_covariance, tag.corner_covariance.T)
    assert (np.linalg.eigvalsh(tag.corner_covariance) > 0).all()


def test_rows_may_stand_apart_and_upside_down_in_memory(survey, photo):
    image = tagsmith.load_image(photo)
    [whole] = tagsmith.read(image, survey=survey).tags
    wide = np.full((image.shape[0], image.shape[1] + 64), 77, np.uint8)
    wide[:, 13:13 + image.shape[1]] = image
    flipped = np.ascontiguousarray(image[::-1])[::-1]
    for view in (wide[:, 13:13 + image.shape[1]], flipped):
        assert view.strides[0] != image.shape[1]
        [tag] = tagsmith.read(view, survey=survey).tags
        np.testing.assert_array_equal(tag.corners, whole.corners)


def test_rows_that_are_one_row_are_refused(photo):
    image = tagsmith.load_image(photo)
    with pytest.raises(ValueError, match="ascontiguousarray"):
        tagsmith.read(np.broadcast_to(image[:1], image.shape))
    assert tagsmith.read(np.broadcast_to(image[:1], (1, image.shape[1]))).tags == []


def test_a_loaded_picture_outlives_its_path_and_is_no_copy(photo):
    image = tagsmith.load_image(str(photo))
    assert image.dtype == np.uint8 and image.shape == (960, 1280)
    assert not image.flags.owndata


@pytest.mark.parametrize("image, error", [
    (np.zeros((4, 4, 3), np.uint8), "dimensions"),
    (np.zeros((4, 4)), "float64"),
    (np.zeros((4, 8), np.uint8)[:, ::2], "neighbours"),
])
def test_other_arrays_are_refused_with_what_to_do(image, error):
    with pytest.raises(ValueError, match=error):
        tagsmith.read(image)


def test_what_is_no_picture_is_refused():
    with pytest.raises(TypeError):
        tagsmith.read(5)
    with pytest.raises(tagsmith.Error) as caught:
        tagsmith.read(np.zeros((0, 5), np.uint8))
    assert caught.value.code == "invalid_argument"


def test_a_picture_without_a_tag_is_no_error():
    result = tagsmith.read(np.full((200, 300), 128, np.uint8), frameless="always")
    assert (result.tags, result.frameless, result.refusals) == ([], [], [])


def test_options_have_their_words(photo):
    assert tagsmith.read(photo, check_digit="sum10").tags
    with pytest.raises(ValueError, match="sum11"):
        tagsmith.read(photo, check_digit="sum11")
    with pytest.raises(ValueError, match="sometimes"):
        tagsmith.read(photo, frameless="sometimes")


def test_a_drawn_tag_is_read_and_graded():
    drawing = tagsmith.draw_tag("036000291452")
    scale, margin = 2000, 80
    height, width = (int(side * scale) + 2 * margin for side in drawing.plate[[3, 2]])
    image = np.full((height, width), 90, np.uint8)

    def paint(rectangle, shade):
        x, y, w, h = rectangle - np.append(drawing.plate[:2], [0, 0])
        rows = [margin + round(edge * scale) for edge in (y, y + h)]
        columns = [margin + round(edge * scale) for edge in (x, x + w)]
        image[slice(*rows), slice(*columns)] = shade

    paint(drawing.plate, 230)
    paint(drawing.frame_outer, 20)
    paint(drawing.frame_inner, 230)
    for bar in drawing.bars:
        paint(bar, 20)
    [tag] = tagsmith.read(image).tags
    assert tag.digits == "036000291452" and tag.gs1_holds and tag.name == ""
    grade = tagsmith.grade(image, tag.corners)
    assert grade.grade > 3.5 and {"decode", "modulation"} <= {p.name for p in grade.parameters}


def test_other_threads_run_while_a_picture_is_read(survey, photo):
    image = np.tile(tagsmith.load_image(photo), (3, 3))
    done = threading.Event()
    reader = threading.Thread(target=lambda: (tagsmith.read(image, survey=survey), done.set()))
    reader.start()
    turns = 0
    while not done.is_set():
        turns += 1
        time.sleep(0)
    reader.join()
    assert turns > 10


def test_pixels_of_one_column_have_no_neighbours_to_stand_apart_from():
    column = np.zeros((60, 4), np.uint8)[:, ::2][:, :1]
    assert column.strides[1] != 1
    assert tagsmith.read(column).tags == []


@pytest.mark.parametrize("option, words", [
    ({"survey": "surveys/corridor/survey.yaml"}, "survey is of type str, expected a Survey"),
    ({"survey": ["surveys/corridor/survey.yaml"]}, "an element of survey is of type str"),
    ({"survey": 5}, "survey is of type int, expected a Survey"),
    ({"camera": "left"}, "camera is of type str, expected a CameraModel"),
])
def test_options_of_another_type_are_told_from_what_was_expected(photo, option, words):
    with pytest.raises(TypeError, match=words):
        tagsmith.read(photo, **option)


def test_a_rig_is_no_camera_and_a_name_no_plate(photo, rig):
    with pytest.raises(TypeError, match="camera is of type Rig, expected a CameraModel"):
        tagsmith.read(photo, camera=rig)
    with pytest.raises(TypeError, match="plate is of type str, expected a PlateTemplate"):
        tagsmith.draw_tag("036000291452", "tag-400x300")


def test_a_path_that_no_file_can_have_is_refused():
    with pytest.raises(ValueError, match="no file can have the path"):
        tagsmith.read("photo\0.jpg")
