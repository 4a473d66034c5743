"use strict";
// The box at the pointer: what the map shows there.

class PointerBox {
  // `read(x, y)` gives the lines for a pixel of the view, or undefined.
  constructor(element, viewpoint, read) {
    Object.assign(this, { element, viewpoint, read, at: undefined });
    element.addEventListener("pointermove", (event) => this.move(event));
    element.addEventListener("pointerdown", (event) => this.move(event));
    element.addEventListener("pointerleave", () => { this.at = undefined; this.show(); });
  }

  move(event) {
    const bounds = this.element.getBoundingClientRect();
    this.at = { x: event.clientX - bounds.left, y: event.clientY - bounds.top };
    this.show();
  }

  // Also where the pointer rests while the picture changes.
  show() {
    const { at } = this, lines = at && !this.viewpoint.isDragged ? this.read(at.x, at.y) : undefined;
    const box = $("pointer_box");
    box.hidden = !lines;
    if (!lines) return;
    box.replaceChildren(...lines.map((line) => make("div", line)));
    const { clientWidth: width, clientHeight: height } = this.element;
    const right = at.x + 16 + box.offsetWidth <= width, below = at.y + 16 + box.offsetHeight <= height;
    box.style.left = `${Math.max(right ? at.x + 16 : at.x - 12 - box.offsetWidth, 0)}px`;
    box.style.top = `${Math.max(below ? at.y + 16 : at.y - 12 - box.offsetHeight, 0)}px`;
  }
}
