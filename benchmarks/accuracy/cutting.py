"""Cutting: where a stroke begins and ends, against the truth, and what that does to recognition.

Nine figures are shown by one posed body and by five others, who salute in three places and draw
without a pause between transit and stroke (`languages.render`, without its pictures: keypoints with
correlated noise). Closed figures have straight first and last sides, and hands end where they
began. Then the demonstrations, or the takes, keep a part of the true way from and to the salutes.

    python -m pip install --no-deps -r languages/render/requirements.txt
    python -m benchmarks.accuracy.cutting
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import product

import numpy as np

from app.evaluation.share import Share
from app.recognition import Gesture, Language, PoseSequence, Recognizer
from app.recognition.poses.sequence import FloatArray
from app.recognition.recording.segmentation import Bracket, Take, cut_take
from app.recognition.recording.trimming import Span
from languages.render.body import Body
from languages.render.cast import DIVERS, UPPER_BODY
from languages.render.gestures import DRAWINGS
from languages.render.performance import Manner, perform
from languages.render.posture import pose_body
from languages.render.scene import View

FIGURES = (
    "circle",
    "triangle",
    "square",
    "infinity",
    "wedge",
    "three",
    "corner",
    "zigzag",
    "line",
)
PLACES = ("salute", "salute aside", "salute before the chest")
"""Where the diver salutes, names in `languages.render.performance.OPENINGS`."""

TEACHER = "instructor"

BONES = {
    "nose": "head",
    "left_shoulder": "upperarm01.L",
    "right_shoulder": "upperarm01.R",
    "left_elbow": "lowerarm01.L",
    "right_elbow": "lowerarm01.R",
    "left_wrist": "wrist.L",
    "right_wrist": "wrist.R",
    "left_hip": "upperleg01.L",
    "right_hip": "upperleg01.R",
}
"""The bone at whose head each landmark is."""

RATE, FRAME_SIZE = 25, (640, 480)

NOISE, KEPT = 2.0, 0.7
"""Standard deviation of a keypoint's error in pixels, and its correlation from frame to frame."""

HOOKS = (0.0, 0.05, 0.1, 0.15)
"""Shares of the stroke's path that are kept of the ways from and to the salutes."""


@dataclass(frozen=True, eq=False)
class Shown:
    """One showing of a figure, with the truth.

    Attributes
    ----------
    figure, diver
        Names in `FIGURES` and `DIVERS`.
    poses, bracket
        The keypoints, and when the salutes are seen: some time longer than they are held.
    stroke
        When the figure is drawn.

    """

    figure: str
    diver: str
    poses: PoseSequence
    bracket: Bracket
    stroke: Span

    def measure_way(self, start: float, end: float) -> float:
        """Return the length of the wrist's path between two moments; negative if swapped."""
        first, last = np.interp([start, end], self.poses.time, self._way)
        return float(last - first)

    def cut(self) -> Take:
        """Cut the stroke as the product does."""
        return cut_take(self.poses, self.bracket)

    def with_hooks(self, share: float) -> Take:
        """Cut the true stroke with the ways before and after it, as long as a share of its path."""
        take = cut_take(self.poses, self.bracket, trim=False)
        kept = share * self.measure_way(self.stroke.start, self.stroke.end)
        ends = np.interp([self.stroke.start, self.stroke.end], self.poses.time, self._way)
        times = np.interp(ends + [-kept, kept], self._way, self.poses.time)
        start, end = max(float(times[0]), take.start), min(float(times[1]), take.end)
        poses = take.untrimmed.between(start, end)
        return replace(take, poses=poses, stroke_start=start, stroke_end=end)

    @cached_property
    def _way(self) -> FloatArray:
        """``(T,)``: the path of the drawing wrist up to each frame, in pixels."""
        steps = np.linalg.norm(np.diff(self.poses.column("right_wrist"), axis=0), axis=1)
        return np.concatenate([[0.0], np.cumsum(steps + 1e-9)])


def main() -> None:
    """Print the errors of the cut, then what is recognised of cut strokes and of hooked ones."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--seed", type=int, default=0)
    languages = list(show_figures(parser.parse_args().seed))
    every = [shown for language in languages for shown in language]
    print_errors("all", every)
    for figure in FIGURES:
        print_errors(figure, [shown for shown in every if shown.figure == figure])
    print(f"{'read':24}{'nearest':>18}{'right alone':>18}{'wrong alone':>18}")
    print_read("as cut", languages, Shown.cut, Shown.cut)
    for share in HOOKS:
        hooked = partial(Shown.with_hooks, share=share)
        print_read(f"{share:.0%} on demonstrations", languages, hooked, Shown.cut)
        print_read(f"{share:.0%} on takes", languages, Shown.cut, hooked)


def show_figures(seed: int) -> Iterator[list[Shown]]:
    """Yield a language by `TEACHER` and its takes by others for each place of the salute."""
    random = np.random.default_rng(seed)
    bodies = {name: Body(diver.shape) for name, diver in DIVERS.items()}
    for place in PLACES:
        shown = []
        for figure, diver in product(FIGURES, DIVERS):
            manner = Manner(wobble=0.01, hold=0.6, pause=0.0, opening=place, closing=place)
            view = UPPER_BODY
            if diver != TEACHER:
                manner, view = _vary(random, place)
            shown.append(_show(figure, diver, bodies[diver], view, manner, random))
        yield shown


def _vary(random: np.random.Generator, place: str) -> tuple[Manner, View]:
    manner = Manner(
        hold=0.6,
        pause=0.0,
        tempo=random.uniform(0.8, 1.3),
        size=random.uniform(0.8, 1.15),
        aspect=random.uniform(0.9, 1.1),
        tilt=random.uniform(-8, 8),
        wobble=random.uniform(0.01, 0.05),
        drift=random.uniform(0.01, 0.03),
        opening=place,
        closing=PLACES[random.integers(len(PLACES))],
    )
    aim = (random.uniform(-0.06, 0.06), -0.06)
    return manner, View(
        random.uniform(1.6, 1.9), random.uniform(-14, 14), random.uniform(-4, 4), aim
    )


def _show(
    figure: str, diver: str, body: Body, view: View, manner: Manner, random: np.random.Generator
) -> Shown:
    performance = perform(DRAWINGS[figure], manner, RATE, int(random.integers(2**31)))
    chest = (body.head_of("upperarm01.R") + body.head_of("upperarm01.L")) / 2
    camera = view.camera(chest, *FRAME_SIZE)
    at = [body.index[bone] for bone in BONES.values()]
    frames = zip(performance.body, performance.right, performance.left, strict=True)
    xy = np.array([camera.project(pose_body(body, *frame).position[at])[0] for frame in frames])
    error = np.zeros(xy.shape[1:])
    for place in xy:
        error = KEPT * error + np.sqrt(1 - KEPT**2) * NOISE * random.normal(size=error.shape)
        place += error
    first, last = (each for each in performance.phases if each.name == "salute")
    strokes = [each for each in performance.phases if each.name == "stroke"]
    # The hand keeps the shape while it leaves, and forms it before it arrives.
    late, early = random.uniform(0.0, 0.2, 2)
    closing = last.start - early
    return Shown(
        figure=figure,
        diver=diver,
        poses=PoseSequence(
            landmarks=tuple(BONES), xy=xy, time=np.arange(len(xy)) / RATE, frame_size=FRAME_SIZE
        ),
        bracket=Bracket(
            Span(first.start + 0.1, first.end - 1 / RATE + late),
            Span(closing, last.start + 0.4),
            closing,
        ),
        stroke=Span(strokes[0].start, strokes[-1].end),
    )


def print_errors(name: str, showings: list[Shown]) -> None:
    """Print how far begin and end lie from the truth, in shares of the path and in seconds."""
    found = []
    for shown in showings:
        take, true = shown.cut(), shown.stroke
        whole = shown.measure_way(true.start, true.end)
        found.append(
            (
                shown.measure_way(true.start, take.stroke_start) / whole,
                shown.measure_way(true.end, take.stroke_end) / whole,
                take.stroke_start - true.start,
                take.stroke_end - true.end,
            )
        )
    errors = np.abs(found)
    half, most = np.median(errors, axis=0), np.quantile(errors, 0.95, axis=0)
    print(
        f"{name:10} n {len(found):4}  begin {half[0]:5.1%} ({most[0]:5.1%}), {half[2]:.2f} s "
        f"({most[2]:.2f})  end {half[1]:5.1%} ({most[1]:5.1%}), {half[3]:.2f} s ({most[3]:.2f})"
    )


def print_read(
    name: str,
    languages: list[list[Shown]],
    demonstrate: Callable[[Shown], Take],
    take: Callable[[Shown], Take],
) -> None:
    """Print what of the others' takes is recognised with the teacher's demonstrations."""
    nearest, right, wrong, count = 0, 0, 0, 0
    for showings in languages:
        shown_by_teacher = [shown for shown in showings if shown.diver == TEACHER]
        gestures = tuple(
            Gesture.from_demonstration(shown.figure, demonstrate(shown).poses)
            for shown in shown_by_teacher
        )
        recognizer = Recognizer(Language(name="figures", gestures=gestures))
        for shown in showings:
            if shown.diver == TEACHER:
                continue
            result = recognizer.recognize(take(shown).poses)
            count += 1
            nearest += result.nearest == shown.figure
            right += result.label == shown.figure
            wrong += result.label not in (None, shown.figure)
    shares = (Share(part, count) for part in (nearest, right, wrong))
    print(f"{name:24}" + "".join(f"{share!s:>18}" for share in shares))


if __name__ == "__main__":
    main()
