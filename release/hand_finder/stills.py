"""Random stills: divers who show their hands in any water, and where the hands are.

Everything is drawn anew for each still, since variety teaches more than number: who, in which suit,
gloves and light, at which place in the frame, with both arms anywhere. The bodies are MakeHuman's
(CC0), as in the sample clips; no photograph is used.
"""

from __future__ import annotations

import copy
from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
import numpy.typing as npt

from languages.render.body import Array, Body, unit
from languages.render.cast import DIVERS
from languages.render.gear import Kit
from languages.render.performance import REST
from languages.render.posture import HAND_SHAPES, ArmTarget, BodyMotion, hand_points, pose_body
from languages.render.raster import vertex_normals
from languages.render.scene import HEIGHT, WIDTH, Diver, Scene, View
from languages.render.suit import SkinMap, Suit
from languages.render.water import Colour, Water, breath

SEEN = 0.4
"""Least share of a hand that is seen for it to teach; others are neither taught nor denied."""

POSES = 2
"""Stills of one diver at one place: half the time of a still is the place's."""

REACH = (0.2, 0.57)
"""Metres from the shoulder to a wrist, for an arm of `posture.REFERENCE_ARM`."""

DISTANCE, NEAR_DISTANCE, FAR_DISTANCE = (0.65, 3.4), (0.4, 0.8), (3.0, 11.0)
"""Metres from the camera to a diver, to one of whom it shows little but an arm, and to one who as a
whole looks like a hand: seen from any side."""

NEAR, FAR = 0.2, 0.2
"""Shares of the stills that show such an arm, and such a diver."""

AT_FACE = (np.array([0.12, -0.22, 0.1]), np.array([0.1, 0.05, 0.08]))
"""Place of a wrist whose hand is beside the face or at the regulator, and its spread, metres."""

WRIST, MIDDLE_KNUCKLE = 0, 9
"""Of MediaPipe's 21 points."""

FINGERTIPS = 0.17
"""Margin around the joints of a hand, over their extent: flesh, and the glove."""


@dataclass(frozen=True)
class Still:
    """A picture with the hands in it.

    Attributes
    ----------
    image
        ``(480, 640, 3)`` RGB.
    hands
        ``(N, 8)`` of the hands that can be seen, pixels: left, top, right, bottom, and x and y of
        the wrist and of the middle finger's knuckle.
    unclear
        ``(M, 8)`` of the hands of which too little is seen.
    joints
        ``(2, 21, 2)`` pixels, in MediaPipe's order, of the diver's left and right hand, also where
        they are hidden or beside the picture.
    seen
        ``(2,)`` which share of each is seen, 0 to 1.

    """

    image: npt.NDArray[np.uint8]
    hands: Array
    unclear: Array
    joints: Array
    seen: Array


def draw_stills(seed: int, salutes: float = 0.0) -> list[Still]:
    """Draw the stills of one diver at one place; the same numbers give the same stills.

    Parameters
    ----------
    seed
        Of the diver.
    salutes
        Share of hands that salute, or nearly so; the fingers of the others are anyhow.

    """
    random = np.random.default_rng(seed)
    water = _water(random)
    diver = Diver({}, _suit(random), _kit(random))
    body = _dress(_bodies()[random.integers(len(DIVERS))], random, gloved=bool(diver.suit.gloves))
    near, far = random.random() < NEAR, random.random() < FAR
    metres = FAR_DISTANCE if far else NEAR_DISTANCE if near else DISTANCE
    distance = float(np.exp(random.uniform(*np.log(metres))))
    beside = 0.62 if near else 0.42
    turn = 180 if far else 50
    view = View(
        distance,
        random.uniform(-turn, turn),
        random.uniform(-25, 25),
        (random.uniform(-beside, beside) * distance, random.uniform(-0.42, 0.3) * distance),
    )
    light = float(random.choice([random.uniform(0.12, 0.45), random.uniform(0.45, 1.2)]))
    bubbles = breath(random, random.uniform(-2, 0), int(random.integers(0, 60)))
    scene = Scene(diver, water, view, bubbles, seed, body=body, fineness=1, light=light)
    if diver.suit.gloves and random.random() < 0.4:
        _paint_palms(scene, random)
    return [_draw(scene, random, salutes) for _ in range(POSES)]


def _draw(scene: Scene, random: np.random.Generator, salutes: float) -> Still:
    body = scene.body
    joints = pose_body(body, _stance(random), *(_arm(random, salutes) for _ in "LR"))
    points = np.array([scene.pixels(hand_points(body, joints, side)) for side in "LR"])
    shares = np.zeros(2)
    boxes: dict[bool, list[Array]] = {True: [], False: []}
    for number, side in enumerate("LR"):
        box, inside = _box_of(points[number])
        if inside:
            shares[number] = inside * scene.measure_seen(joints, side)
            boxes[bool(shares[number] >= SEEN)].append(box)
    clear = scene.render(joints, random.uniform(0, 2)).astype(np.float32)
    image = _spoil(clear, scene.water, random)
    found, unclear = (np.array(boxes[seen]).reshape(-1, 8) for seen in (True, False))
    return Still(image, found, unclear, points, shares)


@lru_cache(maxsize=1)
def _bodies() -> list[Body]:
    return [Body(diver.shape) for diver in DIVERS.values()]


def _dress(body: Body, random: np.random.Generator, *, gloved: bool) -> Body:
    """Return a body whose suit, and whose gloves, are thin or thick."""
    dressed = copy.copy(body)
    normals = vertex_normals(body.vertices, body.triangles)
    middle = body.vertices.mean(axis=0)
    if (normals * (body.vertices - middle)).sum() < 0:
        normals = -normals
    place = dict(zip(SkinMap.COLUMNS, SkinMap(body).values.T, strict=True))
    hand, head = place["along_arm"] > 0.97, place["head"] > 0.5
    suit = float(random.choice([0.0, random.uniform(0.0, 0.02)]))
    glove = float(random.choice([0.0, random.uniform(0.0, 0.007)])) if gloved else 0.0
    thickness = np.where(hand, glove, np.where(head, 0.0, suit))
    dressed.vertices = body.vertices + thickness[:, None] * normals
    return dressed


def _paint_palms(scene: Scene, random: np.random.Generator) -> None:
    """Give the palms, or the fingers, of the gloves another colour than the rest of them."""
    body = scene.body
    normals = vertex_normals(body.vertices, body.triangles)
    along = scene.skin.values[:, SkinMap.COLUMNS.index("along_arm")]
    colour, fingers = _glove(random), random.random() < 0.3
    for side in "LR":
        beside = np.sign(body.vertices[:, 0]) == (1 if side == "L" else -1)
        if fingers:
            chosen = beside & (along > 1.3)
        else:
            chosen = beside & (along > 0.97) & (normals @ body.hands[side].palm > 0.1)
        scene.skin.eyeballs[chosen] = colour
    scene.refresh()


def _suit(random: np.random.Generator) -> Suit:
    dark = random.random() < 0.6
    black = _grey(random, 8, 60)
    skin = np.array([232, 188, 164]) * random.uniform(0.3, 1.05)
    return Suit(
        main=black if dark else _any_colour(random),
        panel=_grey(random, 8, 60) if dark and random.random() < 0.7 else _any_colour(random),
        trim=_grey(random, 8, 60) if random.random() < 0.5 else _any_colour(random),
        hood=_grey(random, 8, 60) if random.random() < 0.7 else _any_colour(random),
        skin=_rgb(skin),
        gloves=_glove(random) if random.random() < 0.75 else None,
        webbing=_grey(random, 8, 60) if random.random() < 0.7 else _any_colour(random),
    )


def _glove(random: np.random.Generator) -> Colour:
    """Choose the colour of gloves: mostly black or grey, often blue, sometimes any."""
    kind = random.random()
    if kind < 0.55:
        return _grey(random, 5, 60)
    if kind < 0.7:
        return _grey(random, 60, 230)
    if kind < 0.85:
        return _rgb(np.array([0.3, 0.6, 1.0]) * random.uniform(50, 240))
    return _any_colour(random)


def _kit(random: np.random.Generator) -> Kit:
    colours = [
        _grey(random, 8, 60) if random.random() < 0.6 else _any_colour(random) for _ in range(3)
    ]
    return Kit(colours[0], colours[1], None if random.random() < 0.1 else colours[2])


def _grey(random: np.random.Generator, darkest: float, lightest: float) -> Colour:
    return _rgb(random.uniform(darkest, lightest) + random.uniform(-6, 6, 3))


def _any_colour(random: np.random.Generator) -> Colour:
    return _rgb(random.uniform(5, 250, 3))


def _rgb(values: Array) -> Colour:
    red, green, blue = np.clip(values, 0, 255)
    return float(red), float(green), float(blue)


def _water(random: np.random.Generator) -> Water:
    """Choose a blue, turquoise, green, brown or grey water, bright or dark."""
    hues = [(0.25, 0.6, 1), (0.25, 0.85, 0.9), (0.55, 0.9, 0.5), (0.9, 0.75, 0.4), (0.7, 0.8, 0.8)]
    hue = np.array(hues[random.integers(len(hues))]) * random.uniform(0.75, 1.25, 3)
    surface = hue * random.uniform(50, 235)
    return Water(
        _rgb(surface),
        _rgb(surface * random.uniform(0.15, 0.95) * random.uniform(0.85, 1.15, 3)),
        _rgb(random.uniform(40, 200) * random.uniform(0.8, 1.1, 3)),
        visibility=float(np.exp(random.uniform(np.log(1.3), np.log(12)))),
        shafts=random.uniform(0, 1) * float(random.random() < 0.5),
        floor_depth=random.uniform(1.0, 6.0),
        grain=random.uniform(0.5, 4.0),
    )


def _stance(random: np.random.Generator) -> BodyMotion:
    return BodyMotion(
        np.zeros(3),
        np.radians(random.uniform(-35, 35)),
        np.radians(random.uniform(-20, 20)),
        random.uniform(0, 6.3),
        np.radians(random.uniform(-40, 40)),
    )


def _arm(random: np.random.Generator, salutes: float) -> ArmTarget:
    """Choose where one arm is: a quarter hang, some are at the face, the others anywhere."""
    shapes = list(HAND_SHAPES.values())
    one, other = (shapes[random.integers(len(shapes))] for _ in range(2))
    share = random.uniform()
    fingers = share * one + (1 - share) * other
    place = random.random()
    if place < 0.25:
        wrist = REST.wrist + random.normal(0, 0.06, 3)
    elif place < 0.4:
        wrist = random.normal(*AT_FACE)
    else:
        while True:
            wrist = random.uniform([-0.5, -0.55, -0.5], [0.3, 0.02, 0.5])
            if REACH[0] < np.linalg.norm(wrist) < REACH[1]:
                break
    pointing = unit(unit(wrist - [-0.1, 0.05, -0.25]) + unit(random.normal(size=3)) * 0.95)
    palm = unit(random.normal(size=3))
    if salutes and random.random() < salutes:
        share = random.uniform(0.8, 1.0)
        fingers = share * HAND_SHAPES["salute"] + (1 - share) * fingers
    return ArmTarget(wrist, pointing, palm, fingers)


def _box_of(points: Array) -> tuple[Array, float]:
    """Return a row of `Still.hands`, the box cut at the frame, and which share is in the frame."""
    end = np.array([WIDTH, HEIGHT])
    inside = float(((points >= 0) & (points < end)).all(axis=1).mean())
    low, high = points.min(axis=0), points.max(axis=0)
    margin = FINGERTIPS * (high - low).max()
    box = np.concatenate([np.clip(low - margin, 0, end), np.clip(high + margin, 0, end)])
    return np.concatenate([box, points[WRIST], points[MIDDLE_KNUCKLE]]), inside


def _spoil(image: Array, water: Water, random: np.random.Generator) -> npt.NDArray[np.uint8]:
    """Add what is between diver and camera, and what a camera adds."""
    murk = random.uniform(0, 0.75) * float(random.random() < 0.7)
    image = (1 - murk) * image + murk * np.array(water.surface) * random.uniform(0.7, 1.1)
    if random.random() < 0.4:
        image = image + _particles(random)[..., None]
    if random.random() < 0.2:
        ends = random.uniform(0, [WIDTH, HEIGHT], (2, 2)).astype(int).tolist()
        image = np.ascontiguousarray(image)
        cv2.line(image, ends[0], ends[1], _any_colour(random), int(random.integers(1, 4)))
    if random.random() < 0.5:
        image = np.asarray(cv2.GaussianBlur(image, (0, 0), random.uniform(0.4, 2.0)), np.float64)
    image = image * random.uniform(0.5, 1.15) + random.normal(
        0, random.uniform(0.5, 6), image.shape
    )
    frame = np.clip(image, 0, 255).astype(np.uint8)
    quality = int(random.integers(35, 95))
    packed = cv2.imencode(".jpg", frame, [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
    return np.asarray(cv2.imdecode(packed, cv2.IMREAD_COLOR), np.uint8)


def _particles(random: np.random.Generator) -> Array:
    """Draw drifting matter: light specks, some of them near and blurred, ``(480, 640)``."""
    total = np.zeros((HEIGHT, WIDTH), np.float32)
    for blur, count in ((0.7, random.integers(0, 500)), (4.0, random.integers(0, 40))):
        specks = np.zeros_like(total)
        row, column = random.integers(0, HEIGHT, count), random.integers(0, WIDTH, count)
        specks[row, column] = random.uniform(0, 160, count) * blur**2 * 3
        total += cv2.GaussianBlur(specks, (0, 0), blur)
    return total
