"""Hard clips: divers whose hands or keypoints cannot be followed, for the bench of misreadings.

What is wrong is known because it was made: mittens hide the fingers, the diver is far away, in
silt, cut off by the edge, turned away, behind a buddy, or ends without a salute.
"""

from __future__ import annotations

from dataclasses import replace

from languages.render.cast import NEAR, WATERS, Buddy, Clip
from languages.render.performance import Manner
from languages.render.scene import View

WATERS["silt"] = replace(WATERS["harbour"], visibility=1.3)

_ACROSS = ((0.0, 1.0), (2.2, 1.0), (5.2, -1.0), (12.0, -1.0))
"""The way of a buddy who passes before the diver during the stroke."""

_STAYS = ((0.0, 1.0), (2.4, 1.0), (3.4, 0.0), (12.0, 0.0))
"""The way of a buddy who comes between and stays."""


def _hard(number: int, fault: str, gesture: str, who: str, where: str, clip: Clip) -> Clip:
    name = f"{gesture}-{fault}-{number}"
    return replace(clip, name=name, gesture=gesture, diver=who, water=where, seed=600 + number)


def _seen(view: View, manner: Manner | None = None) -> Clip:
    return Clip("", None, "", "", view, manner or Manner(tempo=1.1, wobble=0.03), 0)


def _behind(buddy: str, path: tuple[tuple[float, float], ...]) -> Clip:
    passing = Buddy(buddy, View(1.5, aim=(0.0, -0.05)), path=path)
    return replace(_seen(View(2.2, aim=(0.0, -0.06))), buddies=(passing,))


HARD_CLIPS = (
    _hard(1, "gloved", "circle", "biologist", "lake", replace(_seen(View(1.8)), mittens=True)),
    _hard(2, "gloved", "wedge", "surveyor", "harbour", replace(_seen(View(1.7)), mittens=True)),
    _hard(3, "gloved", "square", "engineer", "open sea", replace(_seen(View(2.0)), mittens=True)),
    _hard(4, "gloved", "three", "student", "reef", replace(_seen(View(1.7)), mittens=True)),
    _hard(5, "far", "triangle", "archaeologist", "lake", _seen(View(4.2))),
    _hard(6, "far", "circle", "surveyor", "reef", _seen(View(5.5))),
    _hard(7, "far", "infinity", "engineer", "harbour", _seen(View(3.4))),
    _hard(8, "silt", "square", "surveyor", "silt", _seen(View(1.9))),
    _hard(9, "silt", "three", "engineer", "silt", _seen(View(1.7))),
    _hard(10, "silt", "wedge", "biologist", "silt", _seen(View(2.2))),
    _hard(11, "buddy", "circle", "student", "lagoon", _behind("engineer", _ACROSS)),
    _hard(12, "buddy", "square", "biologist", "reef", _behind("surveyor", _ACROSS)),
    _hard(13, "buddy", "infinity", "archaeologist", "pool", _behind("student", _STAYS)),
    _hard(14, "edge", "circle", "engineer", "lagoon", _seen(View(1.6, aim=(0.55, -0.06)))),
    _hard(15, "edge", "triangle", "student", "pool", _seen(View(1.5, aim=(-0.5, 0.25)))),
    _hard(16, "turned", "square", "archaeologist", "lagoon", _seen(View(1.8, yaw=68))),
    _hard(17, "turned", "three", "biologist", "open sea", _seen(View(1.8, yaw=-72))),
    _hard(18, "turned", "wedge", "student", "pool", _seen(View(1.8, yaw=60))),
    _hard(19, "unclosed", "circle", "surveyor", "pool", _seen(View(1.8), Manner(closing="belly"))),
    _hard(20, "unopened", "wedge", "engineer", "reef", _seen(View(1.8), Manner(opening="belly"))),
    _hard(21, "small", "square", "student", "lake", _seen(View(1.9), Manner(size=0.4))),
    _hard(22, "small", "infinity", "biologist", "reef", _seen(View(2.4), Manner(size=0.45))),
    _hard(23, "gloved", "infinity", "archaeologist", "pool", replace(_seen(NEAR), mittens=True)),
    _hard(24, "gloved", "triangle", "engineer", "lagoon", replace(_seen(NEAR), mittens=True)),
    _hard(25, "gloved", "line", "surveyor", "reef", replace(_seen(NEAR), mittens=True)),
    _hard(26, "turned", "circle", "engineer", "lagoon", _seen(View(1.8, yaw=75))),
)
