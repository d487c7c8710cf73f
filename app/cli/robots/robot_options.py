"""Options of ``osg-studio robot``."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import typer

from app.cli.clip_argument import EstimatorOption, HandsOption, TurnOption, WaterOption
from app.recognition.errors import EstimatorError
from app.recognition.estimation.factory import MEDIAPIPE_HANDS, NO_HANDS
from app.recognition.gestures.profile import PROFILES
from app.robot import ActiveLanguage, LandmarkListener, create_listener
from app.robot.publishing.publisher import Network
from app.robot.sources.cameras import SCHEMES


@dataclass(frozen=True)
class RobotOptions:
    """Options of the command; typer reads them from the annotations."""

    language: Annotated[Path, typer.Option(help="Language file; read again when it changes.")]
    source: Annotated[
        str,
        typer.Option(
            help="Camera number or device; address of a stream "
            f"({', '.join(f'{scheme}://' for scheme in SCHEMES)}); .sdp file; clip, BAG or "
            "BAG@/TOPIC."
        ),
    ] = "0"
    profile: Annotated[
        str | None,
        typer.Option(help=f"Set of voters, {' or '.join(PROFILES)}; by default the language's."),
    ] = None
    without_salutes: Annotated[
        bool, typer.Option("--without-salutes", help="Recognise gestures without triggers.")
    ] = False
    turn: TurnOption = 0
    water: WaterOption = "auto"
    estimator: EstimatorOption = "onnx"
    hands: HandsOption = MEDIAPIPE_HANDS
    ros2: Annotated[
        bool,
        typer.Option(
            "--ros2",
            help="Also publish to ROS 2, which takes --ros-args; needs the packages in ros2/.",
        ),
    ] = False
    publish: Annotated[
        Network | None,
        typer.Option(help="Also publish to ROS 2 in the network, without ROS 2 on this machine."),
    ] = None
    mavlink: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="Also give confirmed commands to a vehicle, at udpout:HOST:PORT, "
            "udpin:HOST:PORT, tcp:HOST:PORT or mavlink2rest's http://HOST/PATH; needs --vehicle.",
        ),
    ] = None
    vehicle: Annotated[
        Path | None,
        typer.Option(help="Vehicle table for --mavlink: what gestures mean, in TOML or JSON."),
    ] = None
    page: Annotated[
        str | None,
        typer.Option(
            metavar="[HOST:]PORT",
            help="Also serve a page with the robot's state; on this machine alone without HOST.",
        ),
    ] = None
    upload: Annotated[
        bool,
        typer.Option(
            "--upload",
            help="The page also takes the language file and the vehicle table; the robot waits for "
            "the language if there is none. Everybody who reaches the page can replace them.",
        ),
    ] = False
    answers: Annotated[
        Literal["try"] | None,
        typer.Option(
            help="Only show each answer to the diver once, on the vehicle of --mavlink, as the "
            "table of --vehicle says."
        ),
    ] = None
    profile_stages: Annotated[
        bool,
        typer.Option("--profile-stages", hidden=True),
    ] = False

    def open_listener(self, first: ActiveLanguage) -> LandmarkListener:
        """Create the listener for the first language."""
        sees_hands = self.hands != NO_HANDS
        if first.trigger.kind == "salute" and not (self.without_salutes or sees_hands):
            raise EstimatorError(
                f"--hands {self.hands} finds no hand and so no salute: choose other hands, give "
                "the language another trigger, or add --without-salutes"
            )
        return create_listener(first, without_salutes=self.without_salutes, hands=sees_hands)

    def find_vehicle_table(self) -> Path | None:
        """Return the vehicle table; None where there is none, or none was uploaded yet."""
        missing = self.vehicle is None or (self.upload and not self.vehicle.exists())
        return None if missing else self.vehicle
