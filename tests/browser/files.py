"""Dropping files on a page, as a person would."""

from __future__ import annotations

import base64
from pathlib import Path

from playwright.sync_api import Page

_DROP = """([files]) => {
  const transfer = new DataTransfer();
  for (const { name, type, data } of files) {
    const bytes = Uint8Array.from(atob(data), (letter) => letter.charCodeAt(0));
    transfer.items.add(new File([bytes], name, { type }));
  }
  const over = (kind) => document.body.dispatchEvent(
    new DragEvent(kind, { dataTransfer: transfer, bubbles: true, cancelable: true }));
  over("dragenter");
  window.droppedOn = document.getElementById("veil").hidden ? "nothing" : "veil";
  over("dragover");
  over("drop");
}"""


def drop(page: Page, *files: Path, names: tuple[str, ...] = ()) -> None:
    """Drop files in the middle of the window, under `names` where given."""
    shown = names or tuple(file.name for file in files)
    packed = [
        {
            "name": name,
            "type": "application/json" if name.endswith(".json") else "video/mp4",
            "data": base64.b64encode(file.read_bytes()).decode("ascii"),
        }
        for file, name in zip(files, shown, strict=True)
    ]
    page.evaluate(_DROP, [packed])
    assert page.evaluate("window.droppedOn") == "veil"
