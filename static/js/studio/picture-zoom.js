// Enlarging the flat picture: with two fingers, or with Ctrl and the wheel, as a touchpad's pinch
// arrives; one finger then moves it.

import { byId } from "../core/dom.js";
import { follow } from "../core/state.js";

const MOST = 6; // times

/** Bind the fingers and the wheel to the picture. */
export function enlargePicture() {
  const [area, box] = [byId("lab-area"), byId("lab-box")];
  let [scale, x, y] = [1, 0, 0];
  /** @type {{ x: number, y: number, apart: number } | null} */
  let last = null; // where the fingers were

  /** Move the picture so far as it covers its box. */
  function place() {
    x = Math.min(0, Math.max(box.offsetWidth * (1 - scale), x));
    y = Math.min(0, Math.max(box.offsetHeight * (1 - scale), y));
    box.style.transform = scale > 1 ? `translate(${x}px, ${y}px) scale(${scale})` : "";
  }
  /** @type {(factor: number, clientX: number, clientY: number) => void} */
  function zoom(factor, clientX, clientY) {
    const { left, top } = box.getBoundingClientRect();
    const next = Math.min(MOST, Math.max(1, scale * factor));
    x -= (clientX - left) * (next / scale - 1);
    y -= (clientY - top) * (next / scale - 1);
    scale = next;
    place();
  }
  const isFlat = () => area.classList.contains("is-flat");
  /** @param {TouchEvent} event */
  function moved(event) {
    const [one, other] = event.touches;
    if (!isFlat() || (!other && scale === 1)) return;
    event.preventDefault(); // Neither the page scrolls, nor does it grow as a whole.
    const end = other ?? one;
    const now = {
      x: (one.clientX + end.clientX) / 2,
      y: (one.clientY + end.clientY) / 2,
      apart: Math.hypot(one.clientX - end.clientX, one.clientY - end.clientY),
    };
    if (last) {
      x += now.x - last.x;
      y += now.y - last.y;
      if (last.apart) zoom(now.apart / last.apart, now.x, now.y);
      else place();
    }
    last = now;
  }
  const begin = () => {
    last = null;
  };
  box.addEventListener("touchstart", begin);
  box.addEventListener("touchend", begin);
  box.addEventListener("touchmove", moved, { passive: false });
  area.addEventListener("wheel", (/** @type {WheelEvent} */ event) => {
    if (!event.ctrlKey || !isFlat()) return;
    event.preventDefault();
    zoom(2 ** (-event.deltaY / 200), event.clientX, event.clientY);
  });
  follow(["clip"], () => {
    scale = 1;
    place();
  });
  byId("do-cube").addEventListener("click", () => {
    scale = 1;
    place();
  });
}
