"""Panels of viser: the inspector, and the time cursor in its charts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
import numpy.typing as npt
import viser

from app.recognition import Recognition
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.text.wording import humanize
from app.recognition.triggers.trigger import SALUTE, Trigger
from app.ui import charts
from app.ui.panel_style import EMBEDDED, PANEL_STYLE

PANEL_WIDTH: Final = 500
"""Pixels; the scene is beside it. The distances to eight gestures fit."""


class TimeCursor:
    """Line in every chart at the moment on display.

    The page, not viser, has the controls for playing and seeking.
    """

    def __init__(self, gui: viser.GuiApi) -> None:
        gui.add_html(PANEL_STYLE)
        self._line = gui.add_html("")
        # A panel without widgets of ours would show viser's own scene tree.
        gui.main_panel.float(x=16, y=-16, width=600)

    def show(self, share: float) -> None:
        """Move the line to a share of the range on display, in [0, 1]."""
        self._line.content = charts.cursor(share)


class Inspector:
    """Panel beside the scene: the answer, what was compared, and the landmarks' paths over time.

    Only where viser has a tab of its own: in the page's frame the page shows these itself.
    """

    def __init__(self, gui: viser.GuiApi) -> None:
        gui.add_html(EMBEDDED)
        panel = gui.add_panel()
        with panel.add_tab("Take", viser.Icon.CHART_LINE):
            self._answer = gui.add_html("")
            self._tracks = gui.add_html("")
            self._trigger = gui.add_html("")
        panel.dock_right()
        panel.set_width(PANEL_WIDTH)

    def show_answer(
        self,
        recognition: Recognition | None,
        expected: str | None,
        images: Sequence[tuple[str, npt.NDArray[np.uint8]]],
    ) -> None:
        """Show a recognition with every voter's distances, and the images that were compared.

        Parameters
        ----------
        recognition
            None before the range is recognised.
        expected
            The expected label, if known.
        images
            Images with their captions, as `app.ui.charts.image_row` takes them.

        """
        self._answer.content = (
            charts.hint("Not recognised yet", "Recognise the take in the studio; this tab follows.")
            if recognition is None
            else charts.verdict(recognition, expected)
            + charts.image_row(images)
            + charts.vote_table(recognition, expected)
        )

    def show_tracks(
        self,
        trajectory: Trajectory | None,
        start: float,
        held: tuple[FloatArray, FloatArray],
        trigger: Trigger,
    ) -> None:
        """Plot the salient landmarks' paths and the confidence of the trigger.

        Parameters
        ----------
        trajectory
            Trajectory of the salient landmarks; None if nothing moves.
        start
            Seconds in the clip at which it begins.
        held
            Times in seconds and confidence in [0, 1] of the frames on display.
        trigger
            What begins and ends a take; without a held one there is nothing to plot.

        """
        self._tracks.content = (
            charts.hint("Nothing moves here", "No hand moves far enough to be a gesture.")
            if trajectory is None
            else "".join(_path_chart(trajectory, name, start) for name in trajectory.landmarks)
        )
        self._trigger.content = "" if trigger.spots else draw_trigger(*held, trigger)


def draw_trigger(time: FloatArray, held: FloatArray, trigger: Trigger) -> str:
    """Draw the score in [0, 1] of the trigger held before and after a gesture, as SVG.

    `time` is in seconds of the clip, `(T,)` like `held`.
    """
    return charts.line_chart(
        f"{'Vulcan salute' if trigger == SALUTE else trigger.noun.capitalize()}, confidence",
        time,
        [charts.Curve("above 0.5 opens or closes a take", held, "var(--osg-x)")],
        bounds=(0.0, 1.0),
        height=56,
    )


def _path_chart(trajectory: Trajectory, landmark: str, start: float) -> str:
    """Plot one landmark's x and y over the seconds of the clip."""
    path = trajectory.select([landmark]).xy[:, 0]
    unit = "torso lengths" if trajectory.unit == "torso_length" else "of the longest extent"
    return charts.line_chart(
        f"{humanize(landmark).capitalize()}, {unit}",
        trajectory.time + start,
        [
            charts.Curve("x, to the right", path[:, 0], "var(--osg-x)"),
            charts.Curve("y, upwards", -path[:, 1], "var(--osg-y)", dashed=True),
        ],
    )
