"use strict";
// Bars of power over delay, with axes.

const profileSize = { width: 300, height: 180, left: 52, bottom: 38, top: 8, right: 8 };

function drawProfile(canvas, bars) {
  const { width, height, left } = profileSize, ratio = 2;
  Object.assign(canvas, { width: width * ratio, height: height * ratio });
  const pen = canvas.getContext("2d");
  pen.scale(ratio, ratio);
  pen.font = `12px ${font}`;
  pen.fillStyle = ink;
  if (bars.length === 0) pen.fillText("Nothing arrives.", left, height / 2);
  else drawBars(pen, bars, drawProfileAxes(pen, bars));
}

// Returns where a delay, a power and the foot of the bars lie.
function drawProfileAxes(pen, bars) {
  const { width, height, left, bottom, top, right } = profileSize;
  const ends = (values) => [Math.min(...values), Math.max(...values)];
  const [weakest, strongest] = ends(bars.map((bar) => bar.power));
  const delays = axisTicks(...ends(bars.map((bar) => bar.delay)), 5), powers = axisTicks(weakest - 5, strongest, 5);
  const x = (delay) => left + 6 + (delay - delays.low) / (delays.high - delays.low) * (width - left - right - 12);
  const y = (power) => top + (powers.high - power) / (powers.high - powers.low) * (height - top - bottom);
  pen.lineWidth = 1;
  pen.strokeStyle = "#dde2e7";
  pen.textAlign = "right";
  for (const tick of powers.ticks) {
    pen.beginPath();
    pen.moveTo(left, y(tick));
    pen.lineTo(width - right, y(tick));
    pen.stroke();
    pen.fillText(String(tick).replace("-", "−"), left - 5, y(tick) + 4);
  }
  pen.textAlign = "center";
  for (const tick of delays.ticks) pen.fillText(String(tick), x(tick), height - bottom + 15);
  pen.fillText("delay / ns", (left + width - right) / 2, height - 6);
  pen.save();
  pen.translate(11, (top + height - bottom) / 2);
  pen.rotate(-Math.PI / 2);
  pen.fillText("power / dBm", 0, 0);
  pen.restore();
  return { x, y, foot: y(powers.low) };
}

function drawBars(pen, bars, { x, y, foot }) {
  const { width, height, left, bottom, top, right } = profileSize;
  // The many of a rough surface behind the few paths, high ones behind low ones.
  for (const bar of [...bars].sort((a, b) => b.thin - a.thin || b.power - a.power)) {
    const size = bar.accent ? 7 : bar.thin ? 2 : 4, upper = y(bar.power);
    if (bar.accent) {
      pen.fillStyle = "#000000";
      pen.fillRect(x(bar.delay) - size / 2 - 1.5, upper - 1.5, size + 3, foot - upper + 1.5);
    }
    pen.fillStyle = bar.colour;
    pen.fillRect(x(bar.delay) - size / 2, upper, size, foot - upper);
  }
  pen.strokeStyle = ink;
  pen.strokeRect(left, top, width - left - right, height - top - bottom);
}
