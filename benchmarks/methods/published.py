"""The published implementation's steps, for comparison (Joshi and Sattar 2025).

Written anew from its behaviour, including its defects, which are part of the comparison: x and y
are divided by the frame's width and height and neither centred on the torso nor scaled; reference
and query are prepared differently; each moment vector is standardised by its own mean and
deviation; the Fourier descriptors keep position, size and starting point; the first contour is
taken, which may be any. The query is drawn, described and compared once for each gesture of the
language.

For the topic `speed` it also has the cost of the published implementation: coordinates are
gathered and lines drawn in plain loops over frames and keypoints, moments come from the same two
libraries (scikit-image and mahotas), and every voter finds the contours for itself.

It is faster in two respects: it writes no picture to the working directory for every gesture, and
prints nothing. It also differs in that one empty drawing does not crash the whole language; such a
gesture is the farthest for every voter.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import cv2
import mahotas  # type: ignore[import-untyped]
import numpy as np
import numpy.typing as npt
from skimage.measure import moments, moments_hu

from app.recognition import PoseSequence
from app.recognition.features.motion import parse_body_part
from app.recognition.poses.landmarks import HIPS, SHOULDERS
from app.recognition.poses.sequence import FloatArray
from benchmarks.methods.base import Demonstration, Method, Prediction

SIZE = 224
MIN_MOVEMENT = 0.1
"""Least x range plus y range of a salient keypoint, as fractions of the frame."""

MAX_SALIENT = 3
CORNER_TOLERANCE = 5.0
REFERENCE_EDGES = (50.0, 150.0)
QUERY_EDGES = (100.0, 200.0)
"""Thresholds of the edge detector that draws the outlines anew."""

FOURIER_COUNT = 12
ZERNIKE_RADIUS = 21
ZERNIKE_DEGREE = 8
NOT_HANDS = ("shoulder", "elbow", "hip", "knee", "ankle", "heel", "foot_index")

VOTERS = 7

Image = npt.NDArray[np.uint8]

Frames = list[dict[str, tuple[float, float]]]
"""Per frame the keypoints found in it: x and y as fractions of the frame."""


@dataclass(frozen=True)
class _Reference:
    label: str
    salient: tuple[str, ...]
    features: tuple[FloatArray, ...] | None


class PublishedCode(Method):
    """Majority vote of the seven shape voters, as the published implementation casts it."""

    def fit(self, demonstrations: Sequence[Demonstration]) -> None:
        """Draw and describe the demonstrations."""
        self._references = [_describe(each) for each in demonstrations]

    def predict(self, take: PoseSequence) -> Prediction:
        """Draw, describe and compare the take once for each gesture, and count the votes."""
        return Prediction(self.name(self.gather(take)))

    def gather(self, query: PoseSequence) -> Frames:
        """Convert a query to the published implementation's input, frame by frame.

        Only keypoints that some gesture needs are converted.
        """
        return frames_of(query, {name for each in self._references for name in each.salient})

    def name(self, frames: Frames) -> str | None:
        """Return the label of the frames of `gather`."""
        rows = []
        for reference in self._references:
            described = features(picture(frames, reference.salient, QUERY_EDGES))
            rows.append(_differences(described, reference.features))
        votes = np.argmin(rows, axis=0)
        (winner, _), *_ = Counter(votes.tolist()).most_common(1)
        return self._references[winner].label


def _describe(shown: Demonstration) -> _Reference:
    salient = salient_keypoints(shown.poses)
    image = picture(frames_of(shown.poses, salient), salient, REFERENCE_EDGES)
    return _Reference(shown.label, salient, features(image))


def salient_keypoints(poses: PoseSequence) -> tuple[str, ...]:
    """Choose at most one keypoint per group (right hand, left hand, the rest), the widest first."""
    movement = np.nansum(_range(poses.xy / poses.frame_size), axis=1)
    best: dict[str, tuple[float, str]] = {}
    for name, moved in zip(poses.landmarks, movement.tolist(), strict=True):
        part = parse_body_part(name)
        if part.endswith(NOT_HANDS) or part in (*SHOULDERS, *HIPS):
            continue
        group = next((side for side in ("right", "left") if part.startswith(side)), "face")
        best[group] = max(best.get(group, (0.0, "")), (moved, name))
    chosen = sorted((pair for pair in best.values() if pair[0] > MIN_MOVEMENT), reverse=True)
    return tuple(name for _, name in chosen[:MAX_SALIENT]) or poses.landmarks


def frames_of(poses: PoseSequence, names: Collection[str]) -> Frames:
    """Convert keypoints of a recording to the input of the published implementation."""
    columns = [(name, index) for index, name in enumerate(poses.landmarks) if name in names]
    shares, seen = (poses.xy / poses.frame_size).tolist(), poses.seen.tolist()
    return [
        {name: tuple(places[index]) for name, index in columns if found[index]}
        for places, found in zip(shares, seen, strict=True)
    ]


def picture(frames: Frames, salient: Sequence[str], edges: tuple[float, float]) -> Image:
    """Draw a gesture, then the simplified outer contours of the drawing's edges, thickened."""
    drawn = cv2.normalize(_paths(frames, salient), np.empty(0), 0, 255, cv2.NORM_MINMAX)
    grey = cv2.cvtColor(drawn.astype(np.uint8), cv2.COLOR_BGR2GRAY)
    found = cv2.Canny(_blur(np.asarray(grey, dtype=np.uint8), 5), *edges)
    contours = cv2.findContours(found, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)[0]
    outlines: Image = np.zeros_like(found, dtype=np.uint8)
    for contour in contours:
        corners = cv2.approxPolyDP(contour, CORNER_TOLERANCE, closed=True)
        cv2.drawContours(outlines, [corners], -1, 255, thickness=1)
    thick = cv2.threshold(_blur(outlines, 7), 0.1, 255, cv2.THRESH_BINARY)[1]
    return np.asarray(thick, dtype=np.uint8)


def _paths(frames: Frames, salient: Sequence[str]) -> Image:
    """Draw the keypoints' paths about their common mean, one pixel wide, red on white."""
    image: Image = np.full((SIZE, SIZE, 3), 255, dtype=np.uint8)
    found = [frame[name] for frame in frames for name in salient if name in frame]
    if not found:
        return image
    middle_x, middle_y = np.mean([x for x, _ in found]), np.mean([y for _, y in found])
    for before, after in pairwise(frames):
        for name in salient:
            if name in before and name in after:
                start, end = (
                    (int((x - middle_x + 0.5) * SIZE), int((y - middle_y + 0.5) * SIZE))
                    for x, y in (before[name], after[name])
                )
                cv2.line(image, start, end, (0, 0, 255))
    return image


def features(image: Image) -> tuple[FloatArray, ...] | None:
    """Describe a picture for the seven voters, Hu, Zernike and Fourier first; None: it is empty.

    As published, every voter finds the contours for itself, so that the cost is the same.
    """
    complete = cv2.findContours(image, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)[0]
    if not complete:
        return None
    small = cv2.resize(image, (2 * ZERNIKE_RADIUS, 2 * ZERNIKE_RADIUS))
    zernike = mahotas.features.zernike_moments(small, ZERNIKE_RADIUS, degree=ZERNIKE_DEGREE)
    proportions = (_circularity(image), _solidity(image), _aspect_ratio(image), _complexity(image))
    return (
        _standardise(_hu_of_raw_moments(image)),
        _standardise(np.asarray(zernike)),
        _fourier(complete[0][:, 0]),
        *(np.array([value]) for value in proportions),
    )


def _largest(image: Image) -> npt.NDArray[Any]:
    """Return the contour ``(P, 1, 2)`` with the largest area."""
    contours = cv2.findContours(image, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)[0]
    return np.asarray(max(contours, key=cv2.contourArea))


def _circularity(image: Image) -> float:
    contour = _largest(image)
    perimeter = cv2.arcLength(contour, closed=True)
    return 4 * np.pi * cv2.contourArea(contour) / perimeter**2 if perimeter else 0.0


def _solidity(image: Image) -> float:
    contour = _largest(image)
    hull = cv2.contourArea(cv2.convexHull(contour))
    return cv2.contourArea(contour) / hull if hull else 0.0


def _aspect_ratio(image: Image) -> float:
    width, height = cv2.boundingRect(_largest(image))[2:]
    return width / height


def _complexity(image: Image) -> float:
    """Open length of the contour over the perimeter of its box, side by side as published."""
    contour = _largest(_blur(image, 5))
    length = sum(float(np.linalg.norm(corner - before)) for before, corner in pairwise(contour))
    width, height = cv2.boundingRect(contour)[2:]
    return length / (2 * (width + height))


def _hu_of_raw_moments(image: Image) -> FloatArray:
    """Hu's seven polynomials, of raw moments as published instead of normalised central ones."""
    return np.asarray(moments_hu(moments(image)), dtype=np.float64)


def _standardise(values: FloatArray) -> FloatArray:
    return np.asarray((values - values.mean()) / (values.std() + 1e-7))


def _fourier(contour: npt.NDArray[Any]) -> FloatArray:
    """Low-frequency coefficients with position, size and starting point left in them."""
    spectrum = np.fft.fftshift(np.fft.fft(contour[:, 0] + 1j * contour[:, 1]))
    middle = len(spectrum) / 2
    low = spectrum[max(0, int(middle - FOURIER_COUNT / 2)) : int(middle + FOURIER_COUNT / 2)]
    return np.concatenate([low.real, low.imag])


def _differences(
    one: tuple[FloatArray, ...] | None, other: tuple[FloatArray, ...] | None
) -> list[float]:
    """Return each voter's Euclidean distance; infinite where the two cannot be compared."""
    if one is None or other is None:
        return [float("inf")] * VOTERS
    return [
        float(np.linalg.norm(mine - others)) if mine.shape == others.shape else float("inf")
        for mine, others in zip(one, other, strict=True)
    ]


def _range(paths: FloatArray) -> FloatArray:
    return np.asarray(np.nanmax(paths, axis=0) - np.nanmin(paths, axis=0))


def _blur(image: Image, size: int) -> Image:
    return np.asarray(cv2.GaussianBlur(image, (size, size), 0), dtype=np.uint8)
