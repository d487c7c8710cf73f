"""Worker process that is confined from the beginning: ``python -m app.api.workers COMMAND ...``."""

from __future__ import annotations

import sys

from app.api.workers.rights import confine_worker


def main() -> None:
    """Confine this process, and only then load the libraries, which begin threads."""
    confine_worker(sys.argv[1:])
    from app.api.workers import worker

    worker.main()


if __name__ == "__main__":
    main()
