"""Finding the page and the samples, in a checkout and in an installed package."""

import runpy
import shutil
from pathlib import Path

from app import resources
from tests.conftest import ROOT


def test_in_a_checkout_they_lie_beside_the_package() -> None:
    assert resources.static_dir() == ROOT / "static"
    assert resources.samples_dir() == ROOT / "languages"


def test_in_an_installed_package_they_lie_inside_it(tmp_path: Path) -> None:
    package = tmp_path / "site-packages" / "app"
    (package / "static").mkdir(parents=True)
    (package / "samples").mkdir()
    shutil.copy(resources.__file__, package)
    installed = runpy.run_path(str(package / "resources.py"))
    assert installed["static_dir"]() == package / "static"
    assert installed["samples_dir"]() == package / "samples"
