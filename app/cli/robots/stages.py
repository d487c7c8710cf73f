"""Output of ``osg-studio robot --profile-stages``: the stages' costs as JSON and as a table."""

from __future__ import annotations

import json
from collections.abc import Callable
from contextlib import ExitStack, closing

import typer
from rich import box
from rich.table import Table

from app.cli.terminal import people
from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.water import WaterCorrection
from app.robot import LandmarkListener, Source
from app.robot.energy import open_energy_meter
from app.robot.stage_profile import STAGES, StageProfile, StageProfiler


def show_stages(
    source: Source,
    body: PoseEstimator,
    whole: PoseEstimator,
    listener: LandmarkListener,
    *,
    water: WaterCorrection,
    is_over: Callable[[], bool],
) -> None:
    """Profile a source and print the result; see `StageProfiler.run`."""
    with ExitStack() as opened:
        if meter := open_energy_meter():
            opened.enter_context(closing(meter))
        profiler = StageProfiler(body, whole, listener, water=water, meter=meter)
        profile = profiler.run(source, is_over)
    typer.echo(json.dumps(profile.to_dict(), allow_nan=False))
    people.print(build_profile_table(profile))


def build_profile_table(profile: StageProfile) -> Table:
    """Build a table with one row per stage: frame rate and energy up to this stage."""
    takes = "1 take" if profile.takes == 1 else f"{profile.takes} takes"
    caption = (
        f"{profile.frames} frames, {takes}; recognition lowers the rate of pose and "
        f"hands by {profile.share:.1%} and takes {profile.processor_share:.1%} of the processor's "
        f"time; energy: {profile.energy or 'not measured on this machine'}"
    )
    table = Table("with", caption=caption, caption_justify="left", box=box.SIMPLE_HEAD)
    table.add_column("frames a second", justify="right")
    table.add_column("joules a frame", justify="right")
    for stage in STAGES:
        joules = profile.joules_per_frame(stage)
        rate = profile.frames_per_second(stage)
        row = "" if joules is None else f"{joules:.2f}"
        table.add_row(stage if stage == STAGES[0] else f"+ {stage}", f"{rate:.1f}", row)
    return table
