"""Licences: what runs with the studio may be passed on with it."""

import re

from release.licences import list_licences

WORDS = {
    *("0BSD", "Apache", "BSD", "CC0", "ISC", "MIT", "MPL", "PSF", "Zlib", "any-OSI"),
    *("Mozilla", "LGPL", "Python Software Foundation"),
}
"""First words of the licences accepted. The Mozilla licence and the LGPL bind changes to the
package itself, of which we make none; licences that bind whatever uses it are not among them."""


def test_every_package_that_runs_names_a_licence_that_is_accepted() -> None:
    licences = list_licences()
    assert len(licences) > 40
    refused = {
        each.name: each.licence
        for each in licences
        if not each.licence
        or not all(
            any(word in part for word in WORDS)
            for part in re.split(r"\bAND\b|\bOR\b|;", each.licence)
        )
        or re.search(r"(?<!L)GPL", each.licence)
    }
    assert refused == {}
