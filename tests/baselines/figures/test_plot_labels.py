"""Labels of plots overlap no other label and stay inside, as matplotlib itself measures them."""

import itertools

import numpy as np
import pytest
from matplotlib.text import Text

from baselines.figures.plot_labels import Label, label_panels
from baselines.figures.trajectory_plot import draw_trajectory, new_figure
from tests.support.recorded import driven_into_wall
from train.comparison_plots import draw_side_by_side


def boxes_of(figure) -> list:
    """Return the boxes [pixels] of the texts of annotations, by axes."""
    figure.draw_without_rendering()
    # without the line that leads to the position
    return [[Text.get_window_extent(text) for text in axes.texts] for axes in figure.axes]


def assert_apart(boxes) -> None:
    for one, other in itertools.combinations(boxes, 2):
        shared = np.minimum(one.max, other.max) - np.maximum(one.min, other.min)
        assert min(shared) <= 1.0, (one, other)


@pytest.mark.parametrize("aspect", ["auto", "equal"])
def test_labels_of_one_position_spread(aspect):
    figure = new_figure(4.0)
    axes = figure.subplots()
    axes.plot([0.0, 100.0], [0.0, 60.0])
    axes.set_aspect(aspect, adjustable="datalim")
    names = ["start", "goal 1", "goal 2", "4000 s", "start", "goal 1"]
    aside = np.array([0.0, 14.0])
    label_panels({axes: [Label(np.array([0.0, 0.0]), name, "black", aside) for name in names]})
    (boxes,) = boxes_of(figure)
    assert len(boxes) == len(names)
    assert_apart(boxes)
    frame = axes.get_window_extent()
    for box in boxes:
        assert (box.min >= frame.min - 3.0).all()
        assert (box.max <= frame.max + 3.0).all()


def test_a_label_with_space_keeps_its_offset():
    figure = new_figure(4.0)
    axes = figure.subplots()
    axes.plot([0.0, 1.0], [0.0, 1.0])
    label_panels({axes: [Label(np.array([0.5, 0.5]), "goal 1", "black", np.array([5.0, 9.0]))]})
    (text,) = axes.texts
    assert text.xyann == pytest.approx((5.0, 9.0))


def test_episodes_beside_each_other_have_labels_apart_and_one_legend():
    walls = driven_into_wall()
    near = walls._replace(goals=walls.goals * [1.0, 0.0, 1.0])  # both goals at one pose
    figure = draw_side_by_side([walls, near, near], ["avoid_jack", "reserve", "random"])
    panels = boxes_of(figure)
    assert len(panels) == 3
    for boxes in panels:
        assert len(boxes) >= 6
        assert_apart(boxes)
    (legend,) = figure.legends
    box, whole = legend.get_window_extent(), figure.bbox
    assert box.height < 0.2 * whole.height
    assert box.y1 < min(axes.get_window_extent().y0 for axes in figure.axes)


def test_the_legend_of_a_trajectory_is_a_small_part_below_it():
    figure = draw_trajectory(driven_into_wall(), "walls")
    (boxes,) = boxes_of(figure)
    assert_apart(boxes)
    (legend,) = figure.legends
    assert legend.get_window_extent().height < 0.25 * figure.bbox.height
    assert figure.axes[0].get_window_extent().width > 0.85 * figure.bbox.width
