"""``osg-studio robot --profile-stages``: what the stages cost, as JSON and as a table."""

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
from app.robot import Hearing, Source
from app.robot.energy import energy_meter
from app.robot.stage_profile import STAGES, StageProfile, StageProfiler


def show_stages(
    source: Source,
    body: PoseEstimator,
    whole: PoseEstimator,
    listener: Hearing,
    *,
    water: WaterCorrection,
    is_over: Callable[[], bool],
) -> None:
    """Profile a source until it ends or `is_over`; see `StageProfiler`."""
    with ExitStack() as opened:
        if meter := energy_meter():
            opened.enter_context(closing(meter))
        profiler = StageProfiler(body, whole, listener, water=water, meter=meter)
        profile = profiler.run(source, is_over)
    typer.echo(json.dumps(profile.to_dict(), allow_nan=False))
    people.print(profile_table(profile))


def profile_table(profile: StageProfile) -> Table:
    """Lay out what each stage leaves of the rate, a stage a row."""
    takes = "1 take" if profile.takes == 1 else f"{profile.takes} takes"
    caption = (
        f"{profile.frames} frames, {takes}; recognition lowers the rate of pose and "
        f"hands by {profile.share:.1%} and takes {profile.processor_share:.1%} of the processor's "
        f"time; energy: {profile.energy or 'this machine does not tell'}"
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
