"use strict";
// What lies over the scene in pixels: symbols of devices, names, the scale.

const ink = "#1b2026", paper = "rgba(255, 255, 255, 0.82)";

class Overlay {
  // `project` gives the pixels of a place; undefined behind the camera.
  constructor(canvas, moment, project) {
    Object.assign(this, { canvas, moment, data: moment.data, project, symbols: [] });
  }

  resize(width, height, ratio) {
    Object.assign(this, { width, height, ratio });
    Object.assign(this.canvas, { width: width * ratio, height: height * ratio });
  }

  // `look`: the thing that is chosen, the metres of a pixel, whether objects have names.
  draw(look) {
    const pen = this.canvas.getContext("2d");
    pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    pen.clearRect(0, 0, this.width, this.height);
    this.symbols = [];
    for (let i = 0; i < this.data.transmitterCount + this.data.receiverCount; ++i) this.addSymbol(this.data.bodyCount + i);
    // Transmitters last: their symbols lie on top.
    for (const symbol of [...this.symbols].reverse()) this.drawSymbol(pen, symbol, look);
    this.drawLabels(pen, look);
    this.drawScale(pen, look.metresPerPixel);
  }

  addSymbol(thing) {
    const place = this.moment.place(thing), at = place && this.project(place);
    if (at) this.symbols.push({ thing, ...at, transmits: this.moment.isTransmitter(thing) });
  }

  drawSymbol(pen, { thing, x, y, transmits }, look) {
    const size = this.data.receiverCount > 200 && !transmits ? 2.5 : 6.5;
    pen.beginPath();
    if (transmits) {
      pen.moveTo(x, y - 1.3 * size);
      pen.lineTo(x + 1.15 * size, y + 0.8 * size);
      pen.lineTo(x - 1.15 * size, y + 0.8 * size);
      pen.closePath();
    } else {
      pen.arc(x, y, size, 0, 2 * Math.PI);
    }
    const chosen = look.chosenThing === thing;
    pen.fillStyle = transmits ? ink : "#ffffff";
    pen.strokeStyle = chosen ? "#D55E00" : transmits ? "#ffffff" : ink;
    pen.lineWidth = size < 4 ? 1 : chosen ? 3.5 : 2;
    pen.fill();
    pen.stroke();
  }

  // Each label takes the first free place around its symbol, or is left out.
  drawLabels(pen, look) {
    const taken = this.symbols.slice(0, 300).map(({ x, y }) => [x - 6, y - 6, x + 6, y + 6]);
    const order = [...this.symbols.slice(0, 300)];
    order.sort((a, b) => (b.thing === look.chosenThing) - (a.thing === look.chosenThing));
    for (const { thing, x, y } of order) this.drawLabel(pen, taken, this.moment.thingName(thing), x, y, "bold 14px");
    if (!look.objectNames) return;
    for (let body = 1; body < this.data.bodyCount; ++body) {
      const place = this.moment.place(body), at = place && this.project(place);
      if (at) this.drawLabel(pen, taken, this.moment.thingName(body), at.x, at.y, "13px");
    }
  }

  drawLabel(pen, taken, name, x, y, style) {
    pen.font = `${style} ${font}`;
    const text = name.length > 28 ? name.slice(0, 27) + "…" : name, width = pen.measureText(text).width;
    const places = [[x + 11, y - 9], [x - 11 - width, y - 9], [x - width / 2, y - 29], [x - width / 2, y + 11]];
    const meets = (a) => (b) => a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3];
    for (const [left, top] of places) {
      const box = [left - 3, top, left + width + 3, top + 18];
      const inside = box[0] >= 0 && box[1] >= 0 && box[2] <= this.width && box[3] <= this.height;
      if (!inside || taken.some(meets(box))) continue;
      taken.push(box);
      pen.fillStyle = paper;
      pen.fillRect(box[0], box[1], width + 6, 18);
      pen.fillStyle = ink;
      pen.textBaseline = "middle";
      pen.fillText(text, left, top + 9.5);
      return;
    }
  }

  // A length of 1, 2 or 5 · 10^n metres: at the distance of the point looked at, on the plan everywhere.
  drawScale(pen, metresPerPixel) {
    const metres = metresPerPixel * 140, power = 10 ** Math.floor(Math.log10(metres));
    const length = [5, 2, 1].map((factor) => factor * power).find((one) => one <= metres);
    const pixels = length / metresPerPixel, y = this.height - 14, x = 14;
    this.scale = { metres: length, pixels };
    pen.font = `14px ${font}`;
    const text = `${+length.toPrecision(1)} m`;
    pen.fillStyle = paper;
    pen.fillRect(x - 6, y - 24, Math.max(pixels, pen.measureText(text).width) + 12, 34);
    pen.strokeStyle = pen.fillStyle = ink;
    pen.lineWidth = 2;
    pen.beginPath();
    pen.moveTo(x, y - 4);
    pen.lineTo(x, y + 2);
    pen.lineTo(x + pixels, y + 2);
    pen.lineTo(x + pixels, y - 4);
    pen.stroke();
    pen.textBaseline = "alphabetic";
    pen.fillText(text, x + 2, y - 8);
  }
}
