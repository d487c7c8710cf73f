"""viser's panels: the playback bar and the inspector. Callbacks call the workspace, no more."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt
import viser

from app.recognition import Recognition
from app.recognition.poses import FloatArray
from app.recognition.trajectory import Trajectory
from app.ui import charts
from app.ui.style import PANEL_STYLE

SPEEDS: Final = ("0.25x", "0.5x", "1x", "2x")

HIDDEN_BAR: Final = '<style>[data-testid="floating-panel"] { display: none !important }</style>'
"""In the place of the charts' cursor while there is nothing to play."""


@dataclass(frozen=True)
class PlaybackControls:
    """What the playback bar asks of its workspace."""

    seek: Callable[[int], None]
    toggle: Callable[[], bool]
    set_speed: Callable[[float], None]


class PlaybackBar:
    """Slider, play button, steps, speed and clock, floating under the video."""

    def __init__(self, gui: viser.GuiApi, controls: PlaybackControls) -> None:
        self._controls = controls
        self._times: FloatArray = np.zeros(1)
        gui.set_panel_label("Playback")
        gui.add_html(PANEL_STYLE)
        self._cursor = gui.add_html(HIDDEN_BAR)
        self.slider = gui.add_slider("Frame", 0, 1, 1, 0)
        self._clock = gui.add_html("")
        self.play = gui.add_button("Play", icon=viser.Icon.PLAYER_PLAY)
        self.step = gui.add_button_group(
            "Step", ("\N{MINUS SIGN}10", "\N{MINUS SIGN}1", "+1", "+10")
        )
        self.speed = gui.add_button_group("Speed", SPEEDS)
        # A panel without widgets of ours would show viser's own scene tree.
        gui.main_panel.float(x=16, y=-16, width=600)
        self.slider.on_update(self._slid)
        self.play.on_click(lambda _: self.set_playing(controls.toggle()))
        self.step.on_click(lambda _: self._step(self.step.value))
        self.speed.on_click(lambda _: controls.set_speed(float(self.speed.value.rstrip("x"))))

    def load(self, times: FloatArray) -> None:
        """Take over the timestamps ``(T,)`` of another recording; `show` must follow."""
        self._times = times
        self._move_slider(0)
        self.slider.max = max(1, len(times) - 1)
        self.set_playing(False)

    def show(self, frame: int) -> None:
        """Show where playback stands."""
        times = self._times
        self._move_slider(frame)
        self._clock.content = charts.clock(frame, len(times), float(times[frame]))
        span = float(times[-1] - times[0])
        self._cursor.content = charts.cursor(float(times[frame] - times[0]) / span if span else 0.0)

    def _move_slider(self, frame: int) -> None:
        self.slider.value = frame  # type: ignore[misc]  # mypy takes viser's setter for none

    def set_playing(self, playing: bool) -> None:
        """Let the button say what it does next."""
        self.play.label = "Pause" if playing else "Play"
        self.play.icon = viser.Icon.PLAYER_PAUSE if playing else viser.Icon.PLAYER_PLAY

    def _slid(self, event: viser.GuiEvent[viser.GuiSliderHandle[int]]) -> None:
        # Setting the value from here fires this too; only a client's move is a wish to seek.
        if event.client is not None:
            self._controls.seek(int(self.slider.value))

    def _step(self, label: str) -> None:
        self._controls.seek(int(self.slider.value) + int(label.replace("\N{MINUS SIGN}", "-")))


class Inspector:
    """What was decided and why, and how the landmarks moved; docked at the right."""

    def __init__(self, gui: viser.GuiApi) -> None:
        self._panel = gui.add_panel()
        with self._panel.add_tab("Decision", viser.Icon.SCALE):
            self._verdict = gui.add_html("")
            self._table = gui.add_html("")
            self._images = gui.add_html("")
            self._sentence = gui.add_html("")
        with self._panel.add_tab("Tracks", viser.Icon.CHART_LINE):
            self._tracks = gui.add_html("")
            self._salute = gui.add_html("")
        self._panel.dock_right()
        self._panel.set_width(392)
        self.show_nothing()

    def show_nothing(self) -> None:
        """Say what to do first."""
        self._verdict.content = charts.hint(
            "Nothing selected yet",
            "Drop a clip of a diver anywhere in this window, or try a sample clip on the left.",
        )
        for part in (self._table, self._images, self._sentence, self._tracks, self._salute):
            part.content = ""

    def show_undecided(self) -> None:
        """Say how to get a decision for the take on display."""
        self._verdict.content = charts.hint(
            "No decision yet",
            "Press Recognise above to see what every voter thinks of this take, "
            "or Save as gesture to add it to the language.",
        )
        for part in (self._table, self._images, self._sentence):
            part.content = ""

    def show_decision(
        self,
        recognition: Recognition,
        expected: str | None,
        images: list[tuple[str, npt.NDArray[np.uint8]]],
    ) -> None:
        """Show a recognition, with the trajectory images to compare."""
        self._verdict.content = charts.verdict(recognition, expected)
        self._table.content = charts.vote_table(recognition, expected)
        self._images.content = charts.image_row(images)
        self._sentence.content = charts.vote_sentence(recognition.counted)

    def show_tracks(
        self, trajectory: Trajectory | None, start: float, salute: tuple[FloatArray, FloatArray]
    ) -> None:
        """Plot the salient landmarks' paths and the salute's confidence.

        Parameters
        ----------
        trajectory
            Of the salient landmarks; None when nothing moves.
        start
            Seconds in the clip at which it begins.
        salute
            Times in seconds and confidence in [0, 1] of the frames on display.

        """
        self._tracks.content = (
            charts.hint("Nothing moves here", "No hand moves far enough to be a gesture.")
            if trajectory is None
            else "".join(_path_chart(trajectory, name, start) for name in trajectory.landmarks)
        )
        self._salute.content = charts.line_chart(
            "Vulcan salute, confidence",
            salute[0],
            [charts.Curve("above 0.5 opens or closes a take", salute[1], "var(--osg-x)")],
            bounds=(0.0, 1.0),
            height=56,
        )


def _path_chart(trajectory: Trajectory, landmark: str, start: float) -> str:
    """Plot one landmark's x and y over the seconds of the clip."""
    path = trajectory.select([landmark]).xy[:, 0]
    unit = "torso lengths" if trajectory.unit == "torso_length" else "of the longest extent"
    return charts.line_chart(
        f"{charts.readable(landmark).capitalize()}, {unit}",
        trajectory.time + start,
        [
            charts.Curve("x, to the right", path[:, 0], "var(--osg-x)"),
            charts.Curve("y, upwards", -path[:, 1], "var(--osg-y)", dashed=True),
        ],
    )
