"""The DTW kernel's memory: not shared, and without remains of the last alignment."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np

from app.recognition.matching.dtw import dtw_distances
from app.recognition.matching.dtw_kernel import compute_alignment_costs, count_half_steps
from app.recognition.poses.sequence import FloatArray

BAND, STEPS = 4, 12


def distances(drawn: FloatArray) -> FloatArray:
    return dtw_distances(drawn[0], drawn[1:], BAND)


def test_threads_do_not_write_into_each_others_totals() -> None:
    generator = np.random.default_rng(1)
    drawn = generator.normal(size=(64, 40, STEPS, 2))
    alone = [distances(each) for each in drawn]
    with ThreadPoolExecutor(4) as threads:
        together = list(threads.map(distances, drawn))
    np.testing.assert_array_equal(together, alone)


def test_what_was_aligned_before_leaves_nothing_behind() -> None:
    generator = np.random.default_rng(2)
    near, far = generator.normal(size=(2, 3, STEPS, 2))
    alone = distances(near)
    distances(1e3 * far)
    np.testing.assert_array_equal(distances(near), alone)


def test_the_answer_is_in_memory_of_its_own() -> None:
    count = count_half_steps(STEPS, BAND)
    costs = np.random.default_rng(3).random((2, count, count, 5))
    first = compute_alignment_costs(costs, STEPS, BAND)
    expected = first.copy()
    compute_alignment_costs(costs + 1.0, STEPS, BAND)
    np.testing.assert_array_equal(first, expected)
