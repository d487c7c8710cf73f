"""Landmarks: the hand landmark model learns gloved hands from stills whose joints are known.

Crops are around hands, as the recognition cuts them, in nearly any turn of a search; others are
beside hands, on divers and water, or where a hand is hidden: there the model is to see none.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
import torch
import torch.nn.functional as functional

from app.recognition.estimation.landmark_models.hand_model import INPUT_SIZE
from app.recognition.estimation.landmark_models.region import Region, palm_size, region_of_hand
from release.hand_finder.network import TaughtNetwork
from release.hand_finder.pictures import Hands
from release.hand_finder.teaching import recolour

Array = npt.NDArray[np.float64]
Crop = npt.NDArray[np.float32]

SEEN, HIDDEN = 0.6, 0.1
"""Least share of a hand that is seen for its joints to teach, and share below which it is none."""
SMALLEST = 14.0
"""Least side of a hand's region, pixels."""
HANDS, OTHERS = 10, 6
"""Crops of a step: with a hand, and without."""
KEPT = 24
"""Weights of the first layers, which stay as they are."""
RATE = 2e-4
"""Largest rate of the optimiser (AdamW, Loshchilov and Hutter 2019)."""
TOLERANCE = 0.05
"""Distance, in palms, beyond which an error of a joint counts as itself, not as its square."""
PLACES, SIDE = 4.0, 0.15
"""Weights of the losses of joints, and of left or right, beside that of the hand's presence."""
TIPS = (8, 12, 16, 20)
"""Finger tips, which tell hand shapes apart; they and the joints before count more."""


def teach_landmarks(
    model: Path, stills: Sequence[Hands], output: Path, *, steps: int, seed: int, tips: float
) -> None:
    """Teach a hand landmark model, and write it as ONNX.

    Parameters
    ----------
    model
        The hand landmark model, or a taught one.
    stills
        What it learns from.
    output
        The file to write, every hundred steps and in the end.
    steps
        Number of steps of `HANDS` and `OTHERS` crops; the rate falls along half a cosine.
    seed
        Of the crops.
    tips
        How much more the `TIPS` count, at least 1.

    """
    random = np.random.default_rng(seed)
    network = TaughtNetwork(model)
    for name in list(network.weights)[:KEPT]:
        network.weights[name].requires_grad_(False)
    taught = [one for one in network.parameters() if one.requires_grad]
    optimiser = torch.optim.AdamW(taught, RATE, weight_decay=1e-4)
    weights = _weigh_joints(tips)
    losses = []
    for step in range(1, steps + 1):
        falling = max(0.03, 0.5 * (1 + np.cos(np.pi * step / steps)))
        for group in optimiser.param_groups:
            group["lr"] = RATE * min(1.0, step / 40) * falling
        losses.append(_step(network, optimiser, stills, weights, random))
        if step % 100 == 0 or step == steps:
            present, off = np.mean(losses[-100:], axis=0)
            print(f"step {step} of {steps}: {present:.3f} {off:.3f}", flush=True)
            network.write(output)


def _weigh_joints(tips: float) -> torch.Tensor:
    weights = np.ones(21, np.float32)
    weights[list(TIPS)] = tips
    weights[[tip - 1 for tip in TIPS]] = 1 + (tips - 1) / 3
    return torch.tensor(weights / weights.mean())[None, :, None]


def _step(
    network: TaughtNetwork,
    optimiser: torch.optim.Optimizer,
    stills: Sequence[Hands],
    weights: torch.Tensor,
    random: np.random.Generator,
) -> tuple[float, float]:
    """Take one step, and return the losses of presence and joints."""
    hands = [draw_hand(stills, random) for _ in range(HANDS)]
    crops = [crop for crop, _, _ in hands] + [draw_other(stills, random) for _ in range(OTHERS)]
    joints = torch.tensor(np.array([points for _, points, _ in hands], np.float32))
    sizes = torch.tensor([palm_size(points) for _, points, _ in hands])[:, None, None].float()
    rights = torch.tensor([right for _, _, right in hands])
    raw, presence, right, _ = network(torch.tensor(np.stack(crops)))
    found = raw[:HANDS].reshape(HANDS, 21, 3)[..., :2]
    off = functional.smooth_l1_loss(found / sizes, joints / sizes, reduction="none", beta=TOLERANCE)
    off = (off * weights).mean()
    there = torch.tensor([1.0] * HANDS + [0.0] * OTHERS)
    present = _entropy(presence[:, 0], there)
    loss = present + PLACES * off + SIDE * _entropy(right[:HANDS, 0], rights)
    optimiser.zero_grad()
    loss.backward()
    torch.nn.utils.clip_grad_norm_(network.parameters(), 2.0)
    optimiser.step()
    return float(present.detach()), float(off.detach())


def _entropy(said: torch.Tensor, meant: torch.Tensor) -> torch.Tensor:
    return functional.binary_cross_entropy(said.clamp(1e-6, 1 - 1e-6), meant)


def draw_hand(stills: Sequence[Hands], random: np.random.Generator) -> tuple[Crop, Array, float]:
    """Cut a crop around a random hand, in other colours.

    Returns
    -------
    The crop, the joints ``(21, 2)`` in its pixels, and 1.0 where it shows a right hand.

    """
    while True:
        still = stills[int(random.integers(len(stills)))]
        number = int(random.integers(2))
        points = still.joints[number]
        around = region_of_hand(points)
        if still.seen[number] < SEEN or around.side < SMALLEST:
            continue
        turn = float(np.clip(random.normal(0, 0.3), -0.7, 0.7))
        size = float(np.exp(random.uniform(-0.3, 0.4)))
        shift = random.uniform(-0.12, 0.12, 2) * around.side
        region = Region(
            around.x + shift[0], around.y + shift[1], around.side * size, around.rotation + turn
        )
        matrix = region.matrix(INPUT_SIZE)
        moved = (points - matrix[:, 2]) @ np.linalg.inv(matrix[:, :2]).T
        mirrored = random.random() < 0.5
        if mirrored:
            moved = np.c_[INPUT_SIZE - 1 - moved[:, 0], moved[:, 1]]
        crop = _cut(still, region)[:, ::-1] if mirrored else _cut(still, region)
        coloured = recolour(crop.astype(np.float32), random)
        return coloured, moved, float((number == 1) != mirrored)


def draw_other(stills: Sequence[Hands], random: np.random.Generator) -> Crop:
    """Cut a crop in which no hand is to be seen, in other colours."""
    while True:
        still = stills[int(random.integers(len(stills)))]
        height, width = still.image.shape[:2]
        number = int(random.integers(2))
        around = region_of_hand(still.joints[number])
        inside = 0 < around.x < width and 0 < around.y < height
        hidden = still.seen[number] < HIDDEN and inside and around.usable
        if hidden and around.side > SMALLEST and random.random() < 0.8:
            side = around.side * float(np.exp(random.uniform(-0.2, 0.3)))
            turned = around.rotation + float(random.normal(0, 0.4))
            region = Region(around.x, around.y, side, turned)
            return recolour(_cut(still, region).astype(np.float32), random)
        if random.random() < 0.6 and around.usable:
            side = around.side * float(np.exp(random.uniform(-0.5, 0.5)))
            angle = random.uniform(0, 6.3)
            far = around.side * random.uniform(0.7, 3)
            x, y = around.x + far * np.cos(angle), around.y + far * np.sin(angle)
        else:
            side = max(height, width) * float(np.exp(random.uniform(np.log(0.06), np.log(0.7))))
            x, y = random.uniform(0, width), random.uniform(0, height)
        if 0 < x < width and 0 < y < height and side > 12 and _shows_none(still, x, y, side):
            region = Region(float(x), float(y), side, random.uniform(-3.14, 3.14))
            return recolour(_cut(still, region).astype(np.float32), random)


def _shows_none(still: Hands, x: float, y: float, side: float) -> bool:
    """Return whether a region is away from both hands, or shows too little of them."""
    for points in still.joints:
        hand = region_of_hand(points)
        far = np.hypot(hand.x - x, hand.y - y)
        within = (np.abs(points - (x, y)) < side / 2).all(axis=1).mean()
        if far < 0.3 * side or (within > 0.25 and far < 0.56 * max(hand.side, side)):
            return False
    return True


def _cut(still: Hands, region: Region) -> npt.NDArray[np.uint8]:
    crop = cv2.warpAffine(
        still.image,
        region.matrix(INPUT_SIZE),
        (INPUT_SIZE, INPUT_SIZE),
        flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
        borderMode=cv2.BORDER_REPLICATE,
    )
    return np.asarray(crop, np.uint8)
