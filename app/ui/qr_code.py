"""QR code of a link, as a picture for the page."""

from __future__ import annotations

from typing import Final

import cv2

QUIET: Final = 4
"""Modules of white around the code, as ISO/IEC 18004 asks for."""


def draw_qr_code(text: str) -> str:
    """Return the QR code of a text as SVG, one unit a module, with its quiet zone.

    Its error correction is of level M, which bears a seventh of the code being covered.
    """
    settings = cv2.QRCodeEncoder.Params()
    settings.correction_level = cv2.QRCODE_ENCODER_CORRECT_LEVEL_M
    dark = cv2.QRCodeEncoder.create(settings).encode(text) == 0
    rows, columns = dark.any(axis=1).nonzero()[0], dark.any(axis=0).nonzero()[0]
    code = dark[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    side = len(code) + 2 * QUIET
    path = "".join(
        f"M{x + QUIET} {y + QUIET}h1v1h-1z" for y, x in zip(*code.nonzero(), strict=True)
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {side} {side}" '
        f'shape-rendering="crispEdges"><path fill="#fff" d="M0 0h{side}v{side}H0z"/>'
        f'<path fill="#000" d="{path}"/></svg>'
    )
