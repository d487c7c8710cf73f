"""Jobs: each moves along its states once, and survives the server."""

from datetime import timedelta
from pathlib import Path

import pytest

from app.store import Clip, ClipStore, Database, JobStatus, JobStore, NotFound, identity_of
from app.store.jobs import MAX_ATTEMPTS
from tests.store.conftest import add_clip


@pytest.fixture
def job_id(clips: ClipStore) -> str:
    return add_clip(clips).job.id


def test_a_job_that_completes_notes_frames_and_warnings(
    clips: ClipStore, jobs: JobStore, job_id: str
) -> None:
    assert jobs.start(job_id)
    assert jobs.complete(job_id, 42, ["no hand in any frame"])
    job = jobs.get(job_id)
    assert job.status == JobStatus.DONE
    assert job.warnings == ["no hand in any frame"]
    assert job.started is not None
    assert job.finished is not None
    assert clips.get(job.clip_id).clip.frames == 42


@pytest.mark.parametrize(
    ("measured", "kept"), [(None, 2.0), (2.3, 2.0), (6.7, 6.7), (1.2, 1.2), (0.0, 0.0)]
)
def test_a_stated_duration_that_is_wrong_is_replaced_by_the_measured_one(
    database: Database, jobs: JobStore, job_id: str, measured: float | None, kept: float
) -> None:
    clip_id = jobs.get(job_id).clip_id
    with database.writing() as session:
        session.get_one(Clip, clip_id).duration = 2.0
    assert jobs.start(job_id)
    jobs.complete(job_id, 42, [], seconds=measured)
    with database.reading() as session:
        assert session.get_one(Clip, clip_id).duration == kept


@pytest.mark.parametrize("status", [JobStatus.CANCELLED, JobStatus.FAILED])
def test_a_final_status_is_final(jobs: JobStore, job_id: str, status: JobStatus) -> None:
    assert jobs.finish(job_id, status, code="code", error="why")
    assert not jobs.finish(job_id, JobStatus.CANCELLED)
    assert not jobs.complete(job_id, 1, [])
    assert jobs.start(job_id) is None
    assert jobs.get(job_id).status == status


def test_only_waiting_jobs_start(jobs: JobStore, job_id: str) -> None:
    assert jobs.start(job_id) is not None
    assert jobs.start(job_id) is None
    assert jobs.start("no such job") is None


def test_a_job_runs_from_its_start_to_its_end(jobs: JobStore, job_id: str) -> None:
    assert not jobs.is_running(job_id)
    jobs.start(job_id)
    assert jobs.is_running(job_id)
    jobs.finish(job_id, JobStatus.CANCELLED)
    assert not jobs.is_running(job_id)
    assert not jobs.is_running("no such job")


def test_a_job_that_ran_when_the_server_died_waits_again(jobs: JobStore, job_id: str) -> None:
    jobs.start(job_id)
    assert [job.id for job in jobs.resume()] == [job_id]
    assert jobs.get(job_id).status == JobStatus.QUEUED


def test_a_job_that_ends_the_server_again_and_again_is_given_up(
    jobs: JobStore, job_id: str
) -> None:
    for _ in range(MAX_ATTEMPTS):
        jobs.resume()
        assert jobs.start(job_id)
    assert jobs.resume() == []
    job = jobs.get(job_id)
    assert (job.status, job.error_code) == (JobStatus.FAILED, "interrupted")
    assert job.error is not None
    assert "3 times" in job.error


def test_stopping_in_good_order_is_no_attempt(jobs: JobStore, job_id: str) -> None:
    for _ in range(MAX_ATTEMPTS + 1):
        assert jobs.start(job_id)
        jobs.requeue(job_id)
    assert jobs.get(job_id).status == JobStatus.QUEUED


def test_a_server_that_renews_keeps_its_job(
    database: Database, jobs: JobStore, job_id: str
) -> None:
    other = JobStore(database, "other")
    jobs.start(job_id)
    assert other.take_over() == []
    assert other.resume() == []
    assert jobs.renew([job_id, "no such job"]) == {job_id}
    assert other.renew([job_id]) == set()
    assert jobs.is_running(job_id)
    assert not other.is_running(job_id)


def test_the_job_of_a_server_that_vanished_is_run_by_another_and_has_its_effect_once(
    database: Database, jobs: JobStore, job_id: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    other = JobStore(database, "other")
    with monkeypatch.context() as vanishing:
        vanishing.setattr("app.store.jobs.LEASE", timedelta(seconds=-2))
        jobs.start(job_id)
    assert jobs.take_over() == []  # Its own: it runs, or it is resumed at the next start.
    assert [job.id for job in other.take_over()] == [job_id]
    assert other.start(job_id) is not None
    # The first one was only slow.
    assert jobs.renew([job_id]) == set()
    assert not jobs.complete(job_id, 7, [])
    assert not jobs.finish(job_id, JobStatus.FAILED, code="decoder", error="broke")
    jobs.requeue(job_id)
    assert jobs.resume() == []
    assert other.complete(job_id, 9, [])
    assert (jobs.get(job_id).frames, jobs.get(job_id).attempts) == (9, 2)


def test_anybody_may_cancel_a_job(database: Database, jobs: JobStore, job_id: str) -> None:
    jobs.start(job_id)
    assert JobStore(database, "other").finish(job_id, JobStatus.CANCELLED)
    assert jobs.renew([job_id]) == set()


def test_a_server_takes_up_its_jobs_at_once_after_a_restart(
    database: Database, jobs: JobStore, job_id: str, tmp_path: Path
) -> None:
    first = JobStore(database, identity_of(tmp_path))
    first.start(job_id)
    again = JobStore(database, identity_of(tmp_path))
    assert [job.id for job in again.resume()] == [job_id]


def test_open_jobs_count_per_client(clips: ClipStore, jobs: JobStore) -> None:
    mine = [add_clip(clips, client="me").job for _ in range(3)]
    add_clip(clips, client="you")
    jobs.start(mine[0].id)
    jobs.finish(mine[1].id, JobStatus.CANCELLED)
    assert jobs.count_open("me") == 2
    assert jobs.count_open("you") == 1
    assert jobs.count_open("nobody") == 0


def test_only_a_failed_or_cancelled_job_is_retried(clips: ClipStore, jobs: JobStore) -> None:
    added = add_clip(clips)
    assert jobs.retry(added.clip.id, "me") is None
    jobs.start(added.job.id)
    assert jobs.retry(added.clip.id, "me") is None
    jobs.finish(added.job.id, JobStatus.FAILED)
    again = jobs.retry(added.clip.id, "me")
    assert again is not None
    jobs.start(again.id)
    jobs.complete(again.id, 3, [])
    assert jobs.retry(added.clip.id, "me") is None


def test_the_job_of_a_deleted_clip_is_not_found(clips: ClipStore, jobs: JobStore) -> None:
    added = add_clip(clips)
    clips.delete(added.clip.id)
    with pytest.raises(NotFound):
        jobs.get(added.job.id)
