"use strict";
// Elements of the page, and numbers as text.

const $ = (id) => document.getElementById(id);

// Names are the user's text: they become text, never markup.
function make(tag, text, parent, className) {
  const element = document.createElement(tag);
  if (text !== undefined) element.textContent = text;
  if (className) element.className = className;
  if (parent) parent.append(element);
  return element;
}

// What says the same already is left alone: a browser would lay it out anew.
function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

// A finite number with a true minus sign, and none before zero.
function numberText(value, digits) {
  const text = value.toFixed(digits);
  return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "−");
}

function fixed(value, digits, unit) {
  return Number.isFinite(value) ? `${numberText(value, digits)} ${unit}`.trim() : "–";
}

const degrees = (radians) => fixed(radians * 180 / Math.PI, 2, "°").replace(" °", "°");

const counted = (count) => count.toLocaleString("en-US");

function frequencyText(hz) {
  return hz >= 1e9 ? `${+(hz / 1e9).toPrecision(6)} GHz` : `${+(hz / 1e6).toPrecision(6)} MHz`;
}

const font = '"Helvetica Neue", Arial, "Liberation Sans", sans-serif';

// Rows of a name and a value.
function makeFacts(facts, parent) {
  const table = make("table", undefined, parent, "facts");
  for (const [name, value] of facts) {
    const row = make("tr", undefined, table);
    make("td", name, row);
    make("td", value, row);
  }
}

// Round numbers over a range, at most `most` of them.
function axisTicks(low, high, most) {
  const span = Math.max(high - low, 1);
  const power = 10 ** Math.floor(Math.log10(span / most));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((one) => span / one <= most);
  const first = Math.floor(low / step), last = Math.max(Math.ceil(high / step), first + 1), ticks = [];
  for (let i = first; i <= last; ++i) ticks.push(+(i * step).toPrecision(12));
  return { low: first * step, high: last * step, ticks };
}
