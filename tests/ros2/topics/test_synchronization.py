"""Messages about one picture find each other, whatever is lost on the way."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from osg_ros.topics.synchronization import MOST_WAITING, StampPairs

arrivals = st.lists(st.tuples(st.booleans(), st.integers(0, 40)), max_size=200)


def joined(arrivals: list[tuple[bool, int]]) -> tuple[list[tuple[str, str]], StampPairs[str, str]]:
    pairs: StampPairs[str, str] = StampPairs()
    found = [
        pairs.first(stamp, f"a{stamp}") if first else pairs.second(stamp, f"b{stamp}")
        for first, stamp in arrivals
    ]
    return [pair for pair in found if pair is not None], pairs


def test_the_order_of_the_two_topics_does_not_matter() -> None:
    found, _ = joined([(True, 1), (False, 1), (False, 2), (True, 2)])
    assert found == [("a1", "b1"), ("a2", "b2")]


def test_what_lost_its_partner_is_dropped_with_the_next_pair() -> None:
    found, pairs = joined([(True, 1), (True, 2), (False, 2), (False, 1)])
    assert found == [("a2", "b2")]
    assert pairs.dropped == 1


@given(arrivals)
def test_pairs_are_of_the_same_picture_and_memory_is_bounded(
    arrivals: list[tuple[bool, int]],
) -> None:
    found, pairs = joined(arrivals)
    assert all(first[1:] == second[1:] for first, second in found)
    assert len(pairs) <= 2 * MOST_WAITING


@given(st.lists(st.integers(0, 1000), unique=True, max_size=50))
def test_topics_in_step_lose_nothing(stamps: list[int]) -> None:
    found, pairs = joined([(first, stamp) for stamp in sorted(stamps) for first in (True, False)])
    assert len(found) == len(stamps)
    assert pairs.dropped == 0
