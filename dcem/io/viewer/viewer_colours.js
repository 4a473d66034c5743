"use strict";
// Colours of values: the scale, its ends, and the bar that explains it.

const rgb = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255);

// The ends of a colour bar: the 2nd percentile and the maximum, rounded outwards to 5 dB, as in the pictures of maps.
function powerRange(values) {
  const sorted = values.filter((value) => !Number.isNaN(value)).sort();
  if (sorted.length === 0) return { low: -100, high: 0 };
  const low = 5 * Math.floor(sorted[Math.floor(0.02 * (sorted.length - 1))] / 5);
  const high = 5 * Math.ceil(sorted[sorted.length - 1] / 5);
  return { low, high: high > low ? high : low + 5 };
}

// Red, green, blue in 0 … 255.
function viridis(points, share) {
  const position = Math.min(Math.max(share, 0), 1) * (points.length - 1);
  const lower = Math.min(Math.floor(position), points.length - 2);
  return points[lower].map((value, i) => value + (position - lower) * (points[lower + 1][i] - value));
}

// The colour of a value on a scale; what lies beyond an end has the colour of the end.
function colourOn(points, range, value) {
  return viridis(points, (value - range.low) / (range.high - range.low));
}

// A bar of colours with ticks below it, and what they are of.
function fillScale(element, points, range, title) {
  element.replaceChildren();
  const bar = make("canvas", undefined, element), pen = bar.getContext("2d");
  Object.assign(bar, { width: 256, height: 1 });
  for (let x = 0; x < 256; ++x) {
    pen.fillStyle = `rgb(${viridis(points, x / 255).map(Math.round).join(",")})`;
    pen.fillRect(x, 0, 1, 1);
  }
  const row = make("div", undefined, element, "ticks");
  for (const tick of axisTicks(range.low, range.high, 6).ticks) {
    if (tick < range.low || tick > range.high) continue;
    make("span", String(tick).replace("-", "−"), row).style.left = `${100 * (tick - range.low) / (range.high - range.low)}%`;
  }
  make("div", title, element, "scale_title");
}
