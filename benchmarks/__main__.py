"""Benchmark runner: prints every ratio in the documentation (``make bench``)."""

from __future__ import annotations

import argparse

from benchmarks.cost import (
    explanation,
    extraction,
    footage,
    library,
    memory,
    recognition,
    speed,
    studio_page,
)

PARTS = {
    "extraction": extraction.compare_bare,
    "footage": footage.main,
    "recognition": recognition.main,
    "speed": speed.main,
    "memory": memory.main,
    "explanation": explanation.main,
    "library": library.main,
    "studio_page": studio_page.main,
}


def main() -> None:
    """Run the named parts, by default all of them."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("parts", nargs="*", choices=[*PARTS, []], help="default: all")
    for part in parser.parse_args().parts or PARTS:
        PARTS[part]()


if __name__ == "__main__":
    main()
