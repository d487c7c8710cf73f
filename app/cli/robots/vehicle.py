"""Vehicle of ``osg-studio robot --mavlink``: opens the bridge, once its table fits the language."""

from __future__ import annotations

from pathlib import Path

from app.cli.terminal import people
from app.recognition.errors import VehicleError
from app.robot import LandmarkListener, Source
from app.robot.publishing.publisher import Publisher
from app.robot.sources.live import LiveSource


def open_bridge(
    address: str, table_file: Path, listener: LandmarkListener, source: Source
) -> Publisher:
    """Open the bridge to a vehicle.

    Raises
    ------
    VehicleError
        When its library is missing, the table is invalid or names a label or phrase that the
        language lacks, or the vehicle's address cannot be used.
    OSError
        When the table cannot be read.

    """
    try:
        from app.robot.mavlink.bridge import MavlinkBridge
        from app.robot.mavlink.links import open_link
        from app.robot.mavlink.table import read_vehicle_table
    except ModuleNotFoundError as error:
        raise VehicleError(
            f"--mavlink needs {error.name}, which is not installed; install it with: "
            'pip install "osg-studio[mavlink]"'
        ) from error
    table = read_vehicle_table(table_file)
    language = listener.language.recognizer.language
    if unknown := list(table.list_unknown(language)):
        raise VehicleError(
            f"{table_file}: {', '.join(unknown)} is not in the language {language.name!r}, which "
            f"has {', '.join(language.labels)}; correct the table or choose its language"
        )
    link = open_link(address, table.vehicle.system, table.vehicle.component)
    now = source.now if isinstance(source, LiveSource) else None
    return MavlinkBridge(table, link, lambda: listener.language, tell, now)


def tell(text: str) -> None:
    """Print a line about the vehicle."""
    people.print(f"vehicle: {text}", markup=False, highlight=False, soft_wrap=True)
