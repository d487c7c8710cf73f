"""The registry: every voter is in it, with all that decisions need to know of it."""

import importlib
import inspect
import pkgutil

import pytest

import app.recognition.voters
from app.recognition.voters.registry import HAND_VOTERS, MOTION_VOTERS, PAPER_VOTERS
from app.recognition.voters.voter import Voter, WeightedVoter

EVERY_VOTER = (*PAPER_VOTERS, *MOTION_VOTERS, *HAND_VOTERS)


def written_voters() -> set[type[Voter]]:
    found = set()
    for info in pkgutil.iter_modules(app.recognition.voters.__path__, "app.recognition.voters."):
        module = importlib.import_module(info.name)
        found |= {
            each
            for _, each in inspect.getmembers(module, inspect.isclass)
            if issubclass(each, Voter) and not inspect.isabstract(each) and hasattr(each, "name")
        }
    return found


def test_every_voter_that_is_written_is_registered_once() -> None:
    assert sorted(type(voter).__name__ for voter in EVERY_VOTER) == sorted(
        each.__name__ for each in written_voters()
    )
    assert len({voter.name for voter in EVERY_VOTER}) == len(EVERY_VOTER)
    assert all(voter.unit for voter in EVERY_VOTER)


@pytest.mark.parametrize("voter", [*MOTION_VOTERS, *HAND_VOTERS], ids=lambda voter: voter.name)
def test_a_voter_knows_its_statistics(voter: WeightedVoter) -> None:
    assert voter.prior >= 0
    # A voter whose typical distances are no larger between gestures would never get a weight.
    assert 0 <= voter.within < voter.between
