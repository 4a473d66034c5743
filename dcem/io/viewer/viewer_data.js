"use strict";
// The results as they stand in the page: the names in `head`, the numbers as arrays. docs/design/viewer.md has the list.

const speedOfLight = 299792458;

const mechanisms = [
  { name: "line of sight", colour: "#0072B2" },
  { name: "reflected", colour: "#E69F00" },
  { name: "transmitted", colour: "#009E73" },
  { name: "diffracted", colour: "#CC79A7" },
  { name: "diffuse", colour: "#56B4E9" },
];
const diffuse = 4;

// Which share of the power a path belongs to: the same rule as in links.csv.
function mechanismOf(kinds) {
  if (kinds.includes("S")) return diffuse;
  if (kinds.includes("D")) return 3;
  if (kinds.includes("R")) return 1;
  return kinds === "" ? 0 : 2;
}

// A typed array from the base64 text of a script element; the bytes are little-endian.
function readArray(id) {
  const element = document.getElementById(id);
  const kind = { f32: Float32Array, f64: Float64Array, u32: Uint32Array }[element.dataset.type];
  const text = atob(element.textContent.trim());
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  element.remove();
  return new kind(bytes.buffer);
}

// Running sums: entry i is the sum of the first i lengths.
function starts(count, lengthOf) {
  const result = new Uint32Array(count + 1);
  for (let i = 0; i < count; ++i) result[i + 1] = result[i] + lengthOf(i);
  return result;
}

function readResults() {
  const head = JSON.parse(document.getElementById("head").textContent);
  const data = { head };
  for (const element of document.querySelectorAll("script[data-type]")) data[element.id] = readArray(element.id);
  data.transmitterCount = head.transmitters.length;
  data.receiverCount = head.receivers.length;
  data.bodyCount = head.bodies.length;
  data.frameCount = data.frame_index.length;
  data.linkStart = starts(data.frameCount, (i) => data.frame_links[i]);
  data.rayStart = starts(data.link_tx.length, (i) => data.link_rays[i]);
  data.pointCount = Uint32Array.from(head.paths, (path) => path[0].length);
  data.mechanism = Uint8Array.from(head.paths, (path) => mechanismOf(path[0]));
  data.pointStart = starts(data.ray_path.length, (i) => data.pointCount[data.ray_path[i]]);
  data.touchStart = starts(head.paths.length, (i) => data.pointCount[i]);
  data.power = Float32Array.from(data.ray_gain);
  for (let link = 0; link < data.link_tx.length; ++link) {
    const fed = head.transmitters[data.link_tx[link]].power_dbm;
    for (let ray = data.rayStart[link]; ray < data.rayStart[link + 1]; ++ray) data.power[ray] += fed;
  }
  addTimeLines(data);
  return data;
}

// Things are bodies, then transmitters, then receivers. A pose stands where it changes, so each thing has a list of its
// own: which frames, which entries.
function addTimeLines(data) {
  const things = data.bodyCount + data.transmitterCount + data.receiverCount;
  const counts = new Uint32Array(things);
  for (const thing of data.pose_thing) ++counts[thing];
  data.timeStart = starts(things, (i) => counts[i]);
  data.timeFrame = new Uint32Array(data.pose_thing.length);
  data.timeEntry = new Uint32Array(data.pose_thing.length);
  const next = data.timeStart.slice(0, things);
  let entry = 0;
  for (let frame = 0; frame < data.frameCount; ++frame) {
    for (let i = 0; i < data.frame_poses[frame]; ++i, ++entry) {
      const place = next[data.pose_thing[entry]]++;
      data.timeFrame[place] = frame;
      data.timeEntry[place] = entry;
    }
  }
}

// The entry that holds for a thing in a frame; -1 before its first one.
function poseEntry(data, thing, frame) {
  let low = data.timeStart[thing], high = data.timeStart[thing + 1];
  const first = low;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (data.timeFrame[middle] <= frame) low = middle + 1; else high = middle;
  }
  return low === first ? -1 : data.timeEntry[low - 1];
}
