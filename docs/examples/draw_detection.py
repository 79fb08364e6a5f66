# SPDX-License-Identifier: Apache-2.0
"""Draws what tagsmith reads in a photo: the frames with their names, and what was refused and why.

    python3 draw_detection.py surveys/corridor/survey.yaml photo.jpg detection.png

Needs matplotlib (Debian: python3-matplotlib).
"""

import sys

import matplotlib
import numpy as np
import tagsmith

matplotlib.use("Agg")  # draws into files, on machines without a screen too
from matplotlib import pyplot as plt  # noqa: E402


def outline(axes, corners, colour):
    """The closed outline of four corners."""
    closed = np.vstack([corners, corners[:1]])
    axes.plot(closed[:, 0], closed[:, 1], color=colour, linewidth=1.5)


def draw(image, result, path):
    """The picture with a green frame around each tag and an orange one around each refusal."""
    figure, axes = plt.subplots(figsize=(image.shape[1] / 100, image.shape[0] / 100))
    axes.imshow(image, cmap="gray", vmin=0, vmax=255)
    for tag in result.tags:
        outline(axes, tag.corners, "limegreen")
        x, y = tag.corners[0]
        axes.plot(x, y, "o", color="limegreen")  # P, from which positions are measured
        axes.annotate(f"{tag.name or tag.digits}  {tag.module_px:.1f} px/module", (x, y),
                      xytext=(0, 8), textcoords="offset points", color="limegreen")
    for refusal in result.refusals:
        outline(axes, refusal.corners, "orange")
        axes.annotate(refusal.text, refusal.corners[0], color="orange")
    axes.set_axis_off()
    figure.savefig(path, bbox_inches="tight", pad_inches=0)


def main(survey_path, image_path, output_path):
    survey = tagsmith.Survey.load(survey_path)
    image = tagsmith.load_image(image_path)
    result = tagsmith.read(image, survey=survey)
    draw(image, result, output_path)
    for tag in result.tags:
        print(f"{tag.name} {tag.digits} P at {tag.corners[0].round(1)}")


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    try:
        main(*sys.argv[1:])
    except tagsmith.Error as error:
        sys.exit(f"{error.code}: {error}")
