"""What all voters share."""

import numpy as np
import pytest

from app.recognition.features.trajectory_image import Drawing
from app.recognition.voters.registry import PAPER_VOTERS
from app.recognition.voters.shape_voters import DESCRIPTOR_DIGITS, ShapeVoter, describe_drawing
from app.recognition.voters.voter import euclidean_distances
from tests.recognition.voters.figures import CIRCLE, FIGURES, SIX, drawing_of


@pytest.mark.parametrize("voter", PAPER_VOTERS, ids=lambda voter: voter.name)
@pytest.mark.parametrize("figure", FIGURES)
def test_a_voter_finds_a_figure_at_distance_zero_of_itself(voter: ShapeVoter, figure: str) -> None:
    descriptor = voter.describe(drawing_of(FIGURES[figure]))
    assert descriptor.shape == (voter.length(1),)
    assert np.isfinite(descriptor).all()
    references = np.stack([descriptor, descriptor + 1e-3])
    distances = voter.distances(descriptor, references)
    assert distances.shape == (2,)
    assert distances[0] == 0.0
    assert (distances >= 0).all()


@pytest.mark.parametrize("voter", PAPER_VOTERS, ids=lambda voter: voter.name)
@pytest.mark.parametrize("pixels", [1, 2, 30])
def test_a_voter_describes_strokes_a_pixel_wide(voter: ShapeVoter, pixels: int) -> None:
    image = np.zeros((224, 224), dtype=np.uint8)
    image[100, 50 : 50 + pixels] = 255
    assert np.isfinite(voter.describe(Drawing(image))).all()


def mirrored(drawing: Drawing) -> Drawing:
    return Drawing(np.ascontiguousarray(drawing.image[:, ::-1]))


def test_only_some_voters_see_the_difference_to_a_mirror_image() -> None:
    six = drawing_of(SIX)
    seen, mirror = (describe_drawing(drawing, PAPER_VOTERS) for drawing in (six, mirrored(six)))
    change = {
        voter.name: float(voter.distances(seen[voter.name], mirror[voter.name][None])[0])
        for voter in PAPER_VOTERS
    }
    for blind in ("zernike", "aspect_ratio", "solidity", "circularity", "path_complexity"):
        assert change[blind] == pytest.approx(0.0, abs=1e-5), blind
    assert change["fourier"] > 0.1


def test_voters_have_distinct_names_and_say_their_units() -> None:
    assert len({voter.name for voter in PAPER_VOTERS}) == len(PAPER_VOTERS) == 7
    assert all(voter.unit for voter in PAPER_VOTERS)


def test_a_drawing_is_described_once_for_each_voter_and_rounded() -> None:
    descriptors = describe_drawing(drawing_of(CIRCLE), PAPER_VOTERS)
    assert list(descriptors) == [voter.name for voter in PAPER_VOTERS]
    for values in descriptors.values():
        np.testing.assert_array_equal(values, np.round(values, DESCRIPTOR_DIGITS))


def test_an_empty_drawing_has_no_descriptors() -> None:
    assert describe_drawing(Drawing(np.zeros((224, 224), dtype=np.uint8)), PAPER_VOTERS) == {}


def test_euclidean_distances_of_known_vectors() -> None:
    references = np.array([[0.0, 0.0], [3.0, 4.0]])
    np.testing.assert_allclose(euclidean_distances(np.zeros(2), references), [0, 5])
