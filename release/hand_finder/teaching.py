"""Teaching: the palm detector learns the boxes of whole hands from pictures with boxed hands.

Of the detector's 18 values per anchor four become the box of the hand (a square), and the first and
third keypoints stay the wrist and the middle finger's knuckle, as in the palm detector. The loss of
the scores is the focal loss (Lin et al. 2017).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
import torch
import torch.nn.functional as functional

from app.recognition.estimation.landmark_models.detector import PALM_LAYOUT
from release.hand_finder.network import TaughtNetwork
from release.hand_finder.pictures import Picture

SIDE = PALM_LAYOUT.input_size
FINE = 60.0
"""Pixels of the input: smaller hands are found by the fine grid of anchors, larger by the other."""
BOTH = (40.0, 90.0)
"""Hands of these sides are found by both."""
TEACHABLE = (7.0, 170.0)
"""Sides of hands, in pixels of the input, that teach; smaller and larger ones are ignored."""

AROUND_HANDS = 0.6
"""Share of the crops that are around a hand; the others are anywhere, so that heads, trunks and
whole divers of any size teach that they are no hands."""
ANYWHERE = (0.12, 2.0)
"""Sides of the others, over the picture's longer side."""

BATCH = 16
RATE = 3e-4
"""Largest rate of the optimiser (AdamW, Loshchilov and Hutter 2019)."""

KEPT = 27
"""Weights of the detector's first stage, which stay as they are: edges look the same under water,
and a third of the time goes into them."""

Array = npt.NDArray[np.float64]
Values = npt.NDArray[np.float32]
PLACES = (0, 1, 2, 3, 4, 5, 8, 9)
"""Columns of the output that are taught: box, wrist, middle finger's knuckle."""


@dataclass(frozen=True)
class Target:
    """What the network should say about a crop, by anchor.

    Attributes
    ----------
    score
        ``(N,)`` 1 where the anchor is to find a hand.
    weight
        ``(N,)`` 0 where it does not matter.
    places
        ``(N, 8)`` values of `PLACES`, NaN where unknown.

    """

    score: npt.NDArray[np.float32]
    weight: npt.NDArray[np.float32]
    places: npt.NDArray[np.float32]


_ANCHORS = PALM_LAYOUT.anchors() * SIDE
_IS_FINE = np.arange(len(_ANCHORS)) < 2 * (SIDE // 8) ** 2


def teach(
    detector: Path,
    pictures: Sequence[Picture],
    output: Path,
    *,
    steps: int,
    seed: int = 0,
    whole: bool = False,
) -> None:
    """Teach a finder, and write it as ONNX.

    Parameters
    ----------
    detector
        The palm detector, or a finder that is taught further.
    pictures
        What it learns from.
    output
        The file to write, every fifty steps and in the end.
    steps
        Number of steps of `BATCH` crops; the rate falls along half a cosine.
    seed
        Of the crops.
    whole
        Whether the first stage, `KEPT`, is taught too.

    """
    random = np.random.default_rng(seed)
    network = TaughtNetwork(detector)
    for name in [] if whole else list(network.weights)[:KEPT]:
        network.weights[name].requires_grad_(False)
    taught = [one for one in network.parameters() if one.requires_grad]
    optimiser = torch.optim.AdamW(taught, RATE, weight_decay=1e-4)
    losses = []
    for step in range(1, steps + 1):
        falling = max(0.03, 0.5 * (1 + np.cos(np.pi * step / steps)))
        for group in optimiser.param_groups:
            group["lr"] = RATE * min(1.0, step / 50) * falling
        losses.append(_step(network, optimiser, pictures, random))
        if step % 50 == 0 or step == steps:
            found, placed = np.mean(losses[-50:], axis=0)
            print(f"step {step} of {steps}: {found:.3f} {placed:.3f}", flush=True)
            network.write(output)


def _step(
    network: TaughtNetwork,
    optimiser: torch.optim.Optimizer,
    pictures: Sequence[Picture],
    random: np.random.Generator,
) -> tuple[float, float]:
    """Take one step, and return the losses of the scores and of the places."""
    crops, targets = zip(*(draw_crop(pictures, random) for _ in range(BATCH)), strict=True)
    outputs = sorted(network(torch.tensor(np.stack(crops))), key=lambda one: one.shape[-1])
    logits, raw = outputs[0][..., 0], outputs[1][..., PLACES]
    score, weight, places = (
        torch.tensor(np.stack([getattr(target, name) for target in targets]))
        for name in ("score", "weight", "places")
    )
    belief = torch.sigmoid(logits)
    wrong = (1 - torch.where(score > 0, belief, 1 - belief)) ** 2
    entropy = functional.binary_cross_entropy_with_logits(logits, score, reduction="none")
    found = (0.5 * wrong * entropy * weight).sum() / score.sum().clamp(min=8)
    known = (score > 0)[..., None] & torch.isfinite(places)
    size = places[..., 2:3].clamp(min=6).expand_as(places)
    off = functional.smooth_l1_loss(raw[known], places[known], reduction="none", beta=2.0)
    placed = (off / size[known]).mean() if known.any() else torch.zeros(())
    optimiser.zero_grad()
    (found + placed).backward()
    torch.nn.utils.clip_grad_norm_(network.parameters(), 5.0)
    optimiser.step()
    return float(found.detach()), float(placed.detach())


def draw_crop(
    pictures: Sequence[Picture], random: np.random.Generator
) -> tuple[npt.NDArray[np.float32], Target]:
    """Cut a random crop out of a random picture, mostly around a hand, in other colours."""
    picture = pictures[int(random.integers(len(pictures)))]
    height, width = picture.image.shape[:2]
    if len(picture.hands) and random.random() < AROUND_HANDS:
        box = picture.hands[random.integers(len(picture.hands)), :4]
        hand = max(box[2] - box[0], box[3] - box[1])
        side = hand * np.exp(random.uniform(np.log(1.5), np.log(9)))
        side = min(side, 1.1 * max(height, width))
        middle = (box[:2] + box[2:]) / 2 + random.uniform(-0.4, 0.4, 2) * side
    else:
        side = max(height, width) * np.exp(random.uniform(*np.log(ANYWHERE)))
        middle = random.uniform(0, [width, height])
    angle, scale = random.uniform(-0.4, 0.4), SIDE / side
    cosine, sine = np.cos(angle), np.sin(angle)
    turn = np.array([[cosine, -sine], [sine, cosine]]) * scale
    if random.random() < 0.5:
        turn = np.diag([-1.0, 1.0]) @ turn
    shift = SIDE / 2 - turn @ middle
    smooth = cv2.INTER_LINEAR if scale > 1 else cv2.INTER_AREA
    crop = cv2.warpAffine(picture.image, np.c_[turn, shift], (SIDE, SIDE), flags=smooth)
    coloured = recolour(crop.astype(np.float32), random)
    hands, unclear = (_move(rows, turn, shift) for rows in (picture.hands, picture.unclear))
    return coloured, _target(hands, unclear)


def _move(rows: Array, turn: Array, shift: Array) -> Array:
    """Carry hands ``(N, 8)`` into a crop: ``(N, 7)`` middle, side, wrist, knuckle."""
    scale = float(np.sqrt(abs(np.linalg.det(turn))))
    points = np.stack([(rows[:, :2] + rows[:, 2:4]) / 2, rows[:, 4:6], rows[:, 6:8]], axis=1)
    moved = points @ turn.T + shift
    side = scale * (rows[:, 2:4] - rows[:, :2]).max(axis=1, initial=0)
    return np.concatenate([moved[:, 0], side[:, None], moved[:, 1], moved[:, 2]], axis=1)


def recolour(crop: Values, random: np.random.Generator) -> Values:
    """Balance, stretch, brighten and roughen the colours, as corrections and cameras do."""
    if random.random() < 0.5:
        means = crop.mean(axis=(0, 1))
        share = random.uniform(0.3, 1)
        crop = crop * (1 - share + share * means.mean() / np.maximum(means, 8)).astype(np.float32)
    if random.random() < 0.5:
        low, high = np.percentile(crop[::4, ::4], [2, 98])
        crop = (crop - low) * np.float32(random.uniform(0.8, 1.1) * 230 / max(high - low, 20))
    crop = np.clip(crop * np.float32(random.uniform(0.7, 1.3)), 0, 255) / 255
    crop = crop ** np.float32(random.uniform(0.6, 1.5))
    noise = random.standard_normal(crop.shape, dtype=np.float32) * random.uniform(0, 6) / 255
    return np.clip(crop + noise, 0, 1).astype(np.float32)


def _target(hands: Array, unclear: Array) -> Target:
    score, weight = np.zeros(len(_ANCHORS), np.float32), np.ones(len(_ANCHORS), np.float32)
    places = np.full((len(_ANCHORS), len(PLACES)), np.nan, np.float32)
    for x, y, side, *_ in unclear:
        weight[_distance(x, y) < 0.7 * side + 6] = 0
    for x, y, side, *joints in hands:
        if not (-5 < x < SIDE + 5 and -5 < y < SIDE + 5):
            continue
        far = _distance(x, y)
        if not TEACHABLE[0] <= side <= TEACHABLE[1]:
            weight[far < 0.7 * side + 6] = 0
            continue
        weight[far < 0.6 * side] = 0
        level = _IS_FINE if side < FINE else ~_IS_FINE
        wide = level | (BOTH[0] < side < BOTH[1])
        near = (far < max(0.22 * side, 5)) & wide | (far == far[level].min()) & level
        score[near] = weight[near] = 1
        row = np.array([x, y, side, side, *joints])
        from_anchor = np.concatenate(
            [_ANCHORS[near]] + [0 * _ANCHORS[near]] + 2 * [_ANCHORS[near]], 1
        )
        places[near] = row - from_anchor
    return Target(score, weight, places)


def _distance(x: float, y: float) -> Values:
    """Return how far each anchor is from a place, the larger of both ways."""
    far: Values = np.abs(_ANCHORS - np.array([x, y], np.float32)).max(axis=1)
    return far
