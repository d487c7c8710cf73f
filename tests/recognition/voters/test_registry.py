"""The registry: every voter is in it, with all that decisions need to know of it."""

import importlib
import inspect
import pkgutil

import pytest

import app.recognition.voters.hand
import app.recognition.voters.motion
import app.recognition.voters.shape
from app.recognition.voters.registry import HAND_VOTERS, MOTION_VOTERS, PAPER_VOTERS
from app.recognition.voters.voter import Voter

EVERY_VOTER = (*PAPER_VOTERS, *MOTION_VOTERS, *HAND_VOTERS)


def written_voters() -> set[type[Voter]]:
    found = set()
    for room in (
        app.recognition.voters.shape,
        app.recognition.voters.motion,
        app.recognition.voters.hand,
    ):
        for info in pkgutil.iter_modules(room.__path__, f"{room.__name__}."):
            module = importlib.import_module(info.name)
            found |= {
                each
                for _, each in inspect.getmembers(module, inspect.isclass)
                if issubclass(each, Voter)
                and not inspect.isabstract(each)
                and hasattr(each, "name")
            }
    return found


def test_every_voter_that_is_written_is_registered_once() -> None:
    assert sorted(type(voter).__name__ for voter in EVERY_VOTER) == sorted(
        each.__name__ for each in written_voters()
    )
    assert len({voter.name for voter in EVERY_VOTER}) == len(EVERY_VOTER)


@pytest.mark.parametrize("voter", EVERY_VOTER, ids=lambda voter: voter.name)
def test_a_voter_knows_its_statistics(voter: Voter) -> None:
    assert voter.unit
    assert voter.prior >= 0
    # A voter whose typical distances are no larger between gestures would never get a weight.
    assert 0 <= voter.within < voter.between


def test_a_module_holds_one_voter() -> None:
    modules = [type(voter).__module__ for voter in EVERY_VOTER]
    assert len(set(modules)) == len(modules)
