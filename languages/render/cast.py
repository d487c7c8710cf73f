"""Cast: the people, places and twenty-five clips of the samples."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from languages.render.gear import Kit
from languages.render.performance import Manner
from languages.render.scene import Diver, View
from languages.render.signs import SIGNS, name_clip
from languages.render.suit import Suit
from languages.render.water import Water


def _shape(
    sex: str, origin: str, muscle: str = "average", weight: str = "average", tall: float = 0
) -> dict[str, float]:
    """Name the MakeHuman targets of a young adult; `tall` from -1 to 1 moves the height."""
    build = f"young-{muscle}muscle-{weight}weight"
    shape = {
        f"macrodetails/{origin}-{sex}-young": 1.0,
        f"macrodetails/universal-{sex}-{build}": 1.0,
    }
    if tall:
        end = "maxheight" if tall > 0 else "minheight"
        shape[f"macrodetails/height/{sex}-{build}-{end}"] = abs(tall)
    return shape


DIVERS = {
    "instructor": Diver(
        _shape("male", "caucasian"),
        Suit(main=(40, 66, 118), panel=(24, 28, 38), trim=(244, 142, 44)),
        Kit(regulator=(228, 190, 40)),
    ),
    "biologist": Diver(
        _shape("female", "asian", tall=-0.2),
        Suit(
            main=(44, 46, 54),
            panel=(196, 52, 110),
            trim=(244, 214, 228),
            hood=(48, 44, 52),
            skin=(222, 178, 144),
            brows=(40, 32, 30),
        ),
        Kit(mask=(196, 52, 110), regulator=(200, 60, 116), cylinder=(210, 212, 214)),
    ),
    "surveyor": Diver(
        _shape("male", "african", muscle="max", tall=0.25),
        Suit(
            main=(34, 38, 42),
            panel=(196, 44, 40),
            trim=(230, 230, 226),
            hood=(30, 31, 34),
            skin=(122, 82, 60),
            brows=(24, 20, 18),
        ),
        Kit(mask=(190, 40, 38), regulator=(190, 44, 40), cylinder=(60, 108, 176)),
    ),
    "student": Diver(
        _shape("female", "caucasian", weight="max", tall=0.1),
        Suit(
            main=(22, 116, 122),
            panel=(20, 50, 62),
            trim=(250, 226, 92),
            hood=(26, 74, 82),
            skin=(232, 188, 164),
            brows=(120, 84, 52),
        ),
        Kit(mask=(240, 240, 236), regulator=(250, 226, 92), cylinder=(196, 60, 44)),
    ),
    "archaeologist": Diver(
        _shape("male", "asian", weight="max"),
        Suit(
            main=(96, 98, 104),
            panel=(36, 38, 42),
            trim=(120, 214, 90),
            hood=(52, 54, 58),
            skin=(206, 158, 122),
            brows=(30, 26, 24),
        ),
        Kit(mask=(60, 160, 70), regulator=(120, 214, 90), cylinder=(236, 236, 230)),
    ),
    "engineer": Diver(
        _shape("female", "african", muscle="max", tall=0.3),
        Suit(
            main=(92, 58, 140),
            panel=(40, 30, 62),
            trim=(120, 224, 236),
            hood=(36, 30, 48),
            skin=(148, 100, 74),
            brows=(28, 22, 20),
        ),
        Kit(mask=(120, 200, 226), regulator=(120, 224, 236), cylinder=(240, 150, 50)),
    ),
}
"""Six people of different sex, build and height, each with equipment of their own."""

WATERS = {
    "lagoon": Water((78, 168, 196), (12, 58, 104), (164, 160, 128)),
    "reef": Water((64, 176, 188), (6, 74, 110), (196, 186, 150), visibility=11, shafts=0.8),
    "lake": Water((116, 158, 108), (28, 62, 46), (112, 104, 76), visibility=4.5, shafts=0.35),
    "harbour": Water((108, 140, 122), (30, 52, 52), (96, 96, 80), visibility=3.2, shafts=0.15),
    "open sea": Water((46, 118, 190), (6, 26, 78), (60, 80, 100), visibility=9, floor_depth=5.0),
    "pool": Water((150, 210, 222), (58, 146, 178), (190, 214, 214), visibility=14, shafts=0.5),
}
"""Places; the harbour is the murkiest."""


Route = tuple[tuple[float, float], ...]
"""Seconds, and how far to the right of the place in the view a diver is then, in image widths."""


@dataclass(frozen=True)
class Buddy:
    """Another diver in a clip.

    Parameters
    ----------
    diver, view, manner
        As in `Clip`.
    gesture
        A label of `DRAWINGS`; None: the buddy stands by.
    begins
        Seconds from the clip's beginning at which the gesture, or the one salute of a buddy who
        stands by, begins; None: no salute.
    path
        Where the buddy is.

    """

    diver: str
    view: View
    manner: Manner = field(default_factory=Manner)
    gesture: str | None = None
    begins: float | None = None
    path: Route = ((0.0, 0.0),)


@dataclass(frozen=True)
class Clip:
    """One clip to render.

    Parameters
    ----------
    name
        File name without suffix.
    gesture
        A label of `DRAWINGS` or, of a sign, of `SIGNS`; None for ordinary movement.
    diver, water
        Names in `DIVERS` and `WATERS`.
    view, manner
        Where the camera is, and how the gesture is performed.
    seed
        Of everything left to chance.
    is_sign
        Whether the gesture is a divers' sign.
    mittens
        Whether mittens hide the fingers.
    begins
        Seconds at rest before the performance begins.
    path
        Where the diver is.
    buddies
        Other divers; those nearer to the camera hide the others.

    """

    name: str
    gesture: str | None
    diver: str
    water: str
    view: View
    manner: Manner
    seed: int
    is_sign: bool = False
    mittens: bool = False
    begins: float = 0.0
    path: Route = ((0.0, 0.0),)
    buddies: tuple[Buddy, ...] = ()


UPPER_BODY = View(1.72, aim=(0, -0.06))
NEAR = View(1.5, aim=(-0.02, 0.0))
"""Near enough to tell fingers."""
WIDE = View(1.8)
"""Room for both arms stretched out."""


def _demonstration(gesture: str, seed: int, view: View = UPPER_BODY) -> Clip:
    """All demonstrations: one person, clear water, straight before the camera, unhurried."""
    name = f"{gesture}-demonstration"
    return Clip(name, gesture, "instructor", "lagoon", view, Manner(wobble=0.01), seed)


def _test(gesture: str, take: int, who: str, where: str, view: View, manner: Manner) -> Clip:
    seed = 100 * take + len(gesture)
    return Clip(f"{gesture}-test-{take}", gesture, who, where, view, manner, seed)


def _sign(label: str, number: int) -> Clip:
    """Return a divers' sign, shown by the one who shows all demonstrations."""
    return Clip(
        name_clip(label), label, "instructor", "lagoon", NEAR, Manner(), 200 + number, is_sign=True
    )


def _sign_test(label: str, number: int) -> Clip:
    """Return a sign by another diver elsewhere; who and where goes round by the number."""
    who = ("biologist", "surveyor", "student", "archaeologist", "engineer")[number % 5]
    where = ("reef", "pool", "open sea", "lagoon")[number % 4]
    yaw = (-12, -6, 6, 12)[number // 5 % 4]
    manner = Manner(tempo=(0.9, 1.0, 1.15)[number % 3], lean=(-8, 0, 8)[number // 3 % 3])
    name = f"{name_clip(label)}-test"
    view = View(1.6, yaw=yaw, aim=(0, -0.02))
    return Clip(name, label, who, where, view, manner, 300 + number, is_sign=True)


CLIPS = (
    _demonstration("circle", 1),
    _demonstration("wedge", 2),
    _demonstration("three", 3),
    _demonstration("infinity", 4),
    _demonstration("sweep", 5, WIDE),
    _demonstration("triangle", 6),
    _demonstration("square", 7),
    _demonstration("line", 8),
    _test(
        "circle",
        1,
        "biologist",
        "reef",
        View(1.62, yaw=10, aim=(0.05, -0.05)),
        Manner(tempo=1.15, size=0.85, aspect=1.08, tilt=-6, wobble=0.03, hand="pointing"),
    ),
    _test(
        "circle",
        2,
        "archaeologist",
        "lake",
        View(1.9, yaw=-12, pitch=4, aim=(-0.05, -0.1)),
        Manner(tempo=0.85, size=1.12, aspect=0.93, wobble=0.04, drift=0.03),
    ),
    _test(
        "wedge",
        1,
        "surveyor",
        "open sea",
        View(1.85, yaw=-8, pitch=-3, aim=(-0.1, -0.08)),
        Manner(tempo=1.2, size=1.1, aspect=1.1, tilt=4, wobble=0.03),
    ),
    _test(
        "wedge",
        2,
        "engineer",
        "harbour",
        View(1.68, yaw=14, aim=(0.08, -0.06)),
        Manner(
            tempo=0.9, size=0.88, aspect=0.92, tilt=-5, wobble=0.02, hand="pointing", drift=0.03
        ),
    ),
    _test(
        "three",
        1,
        "student",
        "pool",
        View(1.7, yaw=-6, pitch=5, aim=(0.0, -0.05)),
        Manner(tempo=0.95, size=0.92, aspect=1.08, tilt=5, wobble=0.03, hand="pointing"),
    ),
    _test(
        "three",
        2,
        "surveyor",
        "lake",
        View(1.8, yaw=12, aim=(-0.08, -0.1)),
        Manner(tempo=1.2, size=1.08, aspect=0.95, tilt=-4, wobble=0.03, drift=0.025),
    ),
    _test(
        "infinity",
        1,
        "engineer",
        "reef",
        View(1.75, yaw=-10, aim=(0.05, -0.04)),
        Manner(tempo=1.1, size=0.9, aspect=1.1, tilt=-4, wobble=0.03),
    ),
    _test(
        "infinity",
        2,
        "biologist",
        "open sea",
        View(1.66, yaw=8, pitch=-4, aim=(-0.06, -0.08)),
        Manner(tempo=0.9, size=1.05, aspect=0.92, tilt=5, wobble=0.03, hand="pointing", drift=0.03),
    ),
    _test(
        "sweep",
        1,
        "student",
        "lagoon",
        View(1.86, yaw=-6, aim=(0.02, 0.02)),
        Manner(tempo=1.15, size=0.95, wobble=0.015),
    ),
    _test(
        "sweep",
        2,
        "archaeologist",
        "open sea",
        View(1.95, yaw=8, pitch=3, aim=(-0.04, 0.0)),
        Manner(tempo=0.9, size=1.02, wobble=0.02, hand="relaxed", drift=0.03),
    ),
    _test(
        "triangle",
        1,
        "biologist",
        "harbour",
        View(1.6, yaw=-10, aim=(0.03, -0.05)),
        Manner(tempo=1.05, size=0.9, aspect=1.06, tilt=-5, wobble=0.02),
    ),
    _test(
        "triangle",
        2,
        "student",
        "lake",
        View(1.82, yaw=10, pitch=-3, aim=(-0.08, -0.06)),
        Manner(
            tempo=0.9, size=1.12, aspect=0.94, tilt=4, wobble=0.03, hand="pointing", drift=0.025
        ),
    ),
    _test(
        "square",
        1,
        "surveyor",
        "reef",
        View(1.78, yaw=6, pitch=3, aim=(0.0, -0.08)),
        Manner(tempo=1.2, size=1.08, aspect=1.06, tilt=4, wobble=0.02, hand="pointing"),
    ),
    _test(
        "square",
        2,
        "engineer",
        "pool",
        View(1.72, yaw=-12, aim=(0.06, -0.04)),
        Manner(tempo=0.95, size=0.9, aspect=0.95, tilt=-4, wobble=0.03, drift=0.03),
    ),
    _test(
        "line",
        1,
        "archaeologist",
        "harbour",
        View(1.7, yaw=-8, aim=(0.0, -0.06)),
        Manner(tempo=0.9, size=0.9, tilt=4, wobble=0.02, hand="pointing"),
    ),
    _test(
        "line",
        2,
        "biologist",
        "lagoon",
        View(1.75, yaw=12, pitch=4, aim=(-0.06, -0.1)),
        Manner(tempo=1.25, size=1.12, tilt=-5, wobble=0.03, drift=0.03),
    ),
    Clip(
        "unfinished-triangle",
        "unfinished triangle",
        "engineer",
        "lagoon",
        View(1.75, yaw=6, aim=(0.0, -0.06)),
        Manner(tempo=1.1, size=1.05, wobble=0.02),
        32,
    ),
    Clip(
        "ordinary-movement",
        None,
        "student",
        "reef",
        View(1.75, yaw=5, aim=(0, -0.06)),
        Manner(),
        31,
    ),
)
"""Table 2 of the paper, its first three gestures being Table 1, and one clip without a gesture."""

SIGN_CLIPS = tuple(_sign(label, number) for number, label in enumerate(SIGNS))
"""Divers' signs, the demonstrations of the starter language."""

TESTS_OF_SIGNS = tuple(_sign_test(label, number) for number, label in enumerate(SIGNS))
"""Each sign by another diver. What is found in these clips is kept for the tests, not the clips."""


def _posed(name: str, gesture: str, who: str, where: str, view: View, closing: str) -> Clip:
    manner = Manner(tempo=1.2, wobble=0.01, opening="belly", closing=closing)
    return Clip(name, gesture, who, where, view, manner, len(name), mittens=True)


POSED_CLIPS = (
    _posed("circle-by-belly", "circle", "instructor", "lagoon", UPPER_BODY, "belly"),
    _posed("circle-by-belly-2", "circle", "biologist", "reef", View(1.7, yaw=8), "belly"),
    _posed("wedge-by-belly", "wedge", "surveyor", "open sea", View(1.8, yaw=-6), "belly"),
    _posed("wedge-by-belly-and-head", "wedge", "instructor", "lagoon", UPPER_BODY, "head"),
)
"""Divers in mittens who hold the left forearm across the belly instead of a salute, for the tests
of triggers; in the last one, the left hand on the head ends the take."""


def _shaped(hand: str, take: int, who: str, where: str, view: View, manner: Manner) -> Clip:
    name = f"circle-by-{hand}-{take}"
    return Clip(name, "circle", who, where, view, replace(manner, hand=hand), 400 + take)


_BESIDE = View(1.62, yaw=10, aim=(0.05, -0.05))
_OBLIQUE = View(1.72, yaw=-12, aim=(0.06, -0.04))
_QUICK = Manner(tempo=1.15, size=0.85, aspect=1.08, tilt=-6, wobble=0.03)
_SMALL = Manner(size=0.9)

SHAPED_CLIPS = (
    _shaped("fist", 1, "instructor", "lagoon", UPPER_BODY, Manner(wobble=0.01)),
    _shaped("flat", 1, "instructor", "lagoon", UPPER_BODY, Manner(wobble=0.01)),
    _shaped("fist", 2, "biologist", "reef", _BESIDE, _QUICK),
    _shaped("flat", 2, "biologist", "reef", _BESIDE, _QUICK),
    _shaped("two", 2, "biologist", "reef", _BESIDE, _QUICK),
    _shaped("fist", 3, "engineer", "pool", _OBLIQUE, _SMALL),
    _shaped("flat", 3, "engineer", "pool", _OBLIQUE, _SMALL),
)
"""One movement with several hand shapes, for tests alone; the first two demonstrate it."""

_LEFT, _RIGHT = View(2.2, aim=(0.45, -0.1)), View(2.2, aim=(-0.45, -0.1))
"""Places beside each other for two divers."""

PAIR_CLIPS = (
    Clip(
        "square-with-buddy-first",
        "square",
        "engineer",
        "lagoon",
        View(1.8, aim=(0.2, -0.06)),
        Manner(tempo=1.1),
        501,
        begins=1.6,
        path=((0.0, -0.9), (0.6, -0.9), (1.6, 0.0)),
        buddies=(Buddy("surveyor", View(3.6, aim=(-0.95, -0.1))),),
    ),
    Clip(
        "circle-with-buddy-between",
        "circle",
        "biologist",
        "reef",
        View(2.1, aim=(0.0, -0.06)),
        Manner(tempo=0.9),
        502,
        buddies=(
            Buddy(
                "surveyor",
                View(1.7, aim=(0.0, 0.0)),
                path=((0.0, 1.0), (2.6, 1.0), (5.0, -1.0), (9.0, -1.0)),
            ),
        ),
    ),
    Clip(
        "infinity-with-buddy-nearer",
        "infinity",
        "student",
        "pool",
        View(2.6, aim=(0.6, -0.1)),
        Manner(),
        503,
        buddies=(Buddy("archaeologist", View(1.6, aim=(-0.4, -0.15))),),
    ),
    Clip(
        "wedge-with-buddy-answering",
        "wedge",
        "instructor",
        "lagoon",
        _LEFT,
        Manner(),
        504,
        buddies=(Buddy("biologist", _RIGHT, begins=2.4),),
    ),
    Clip(
        "square-with-buddy-saluting-first",
        "square",
        "surveyor",
        "pool",
        _RIGHT,
        Manner(tempo=1.1),
        505,
        begins=2.6,
        buddies=(Buddy("student", _LEFT, begins=0.3),),
    ),
    Clip(
        "circle-then-line-by-buddy",
        "circle",
        "biologist",
        "reef",
        _LEFT,
        Manner(tempo=1.2),
        506,
        buddies=(Buddy("engineer", _RIGHT, Manner(tempo=1.2), gesture="line", begins=6.0),),
    ),
)
"""Two divers in view, for the tests of whose body counts: a buddy who is there first, who passes
between, who is nearer, who salutes in between or before, and who gestures afterwards."""
