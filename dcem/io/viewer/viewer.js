"use strict";
// The page: time, choices, labels, the panel of numbers.

const $ = (id) => document.getElementById(id);

// Names are the user's text: they become text, never markup.
function make(tag, text, parent) {
  const element = document.createElement(tag);
  if (text !== undefined) element.textContent = text;
  if (parent) parent.append(element);
  return element;
}

function fixed(value, digits, unit) {
  return Number.isFinite(value) ? `${value.toFixed(digits)} ${unit}`.replace("-", "−") : "–";
}

function frequencyText(hz) {
  return hz >= 1e9 ? `${+(hz / 1e9).toPrecision(6)} GHz` : `${+(hz / 1e6).toPrecision(6)} MHz`;
}

const rgb = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255);

// Smooth edges take half of the time where no graphics card draws.
function drawnInSoftware() {
  const gl = document.createElement("canvas").getContext("webgl");
  const names = gl && gl.getExtension("WEBGL_debug_renderer_info");
  const name = names ? gl.getParameter(names.UNMASKED_RENDERER_WEBGL) : "";
  if (gl && gl.getExtension("WEBGL_lose_context")) gl.getExtension("WEBGL_lose_context").loseContext();
  return /swiftshader|llvmpipe|software/i.test(name);
}

class Viewer {
  constructor(data) {
    this.data = data;
    this.head = data.head;
    this.frame = 0;
    this.shown = mechanisms.map(() => true);
    this.hiddenLinks = new Set();
    this.byPower = false;
    this.most = data.link_rays.reduce((most, count) => Math.max(most, count), 1);
    const links = Math.max(data.frame_links[0] || 0, 1);
    this.strongest = Math.min(this.most, Math.max(3, Math.min(20, Math.floor(240 / links)))); // more hide each other
    this.chosen = null;
    this.rayRange = powerRange(data.power) || { low: -100, high: 0 };
    this.makeScene();
    this.makeControls();
    this.resize();
    this.viewDevices();
    this.showFrame(0);
    requestAnimationFrame((now) => this.tick(now));
  }

  // Scene ------------------------------------------------------------------------------------------------------------

  makeScene() {
    this.canvas = $("scene");
    this.isSlow = drawnInSoftware();
    this.renderer = new THREE.WebGLRenderer({ canvas: this.canvas, antialias: !this.isSlow });
    this.renderer.setClearColor(0xf2f4f6);
    this.renderer.localClippingEnabled = true;
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(40, 1, 0.1, 1000);
    this.orbit = new Orbit(this.camera, this.canvas, () => { this.dirty = true; });
    this.cut = new THREE.Plane(new THREE.Vector3(0, 0, -1), 1e9);
    this.surfaces = new Surfaces(this.data, this.scene);
    this.sceneBox = new THREE.Box3();
    for (const part of this.surfaces.meshes.slice(0, 1)) {
      part.faces.computeBoundingBox();
      this.sceneBox.union(part.faces.boundingBox);
    }
    this.deviceBox = this.boxOfThings();
    this.sceneBox.union(this.deviceBox);
    const reach = this.sceneBox.getSize(new THREE.Vector3()).length();
    Object.assign(this.orbit, { reach: 2 * reach + 100, farthest: 10 * reach + 100 });
    // What a wall hides of a ray shines through faintly.
    this.rays = new Segments(this.scene, [{ depth: THREE.GreaterDepth, opacity: 0.28, order: 2 },
                                          { depth: THREE.LessEqualDepth, opacity: 1, order: 3 }]);
    this.halo = new Segments(this.scene, [{ depth: THREE.AlwaysDepth, opacity: 1, order: 4 }]);
    this.accent = new Segments(this.scene, [{ depth: THREE.AlwaysDepth, opacity: 1, order: 5 }]);
    this.makeMap();
  }

  boxOfThings() {
    const box = new THREE.Box3(), data = this.data;
    for (let entry = 0; entry < data.pose_thing.length; ++entry) {
      if (data.pose_thing[entry] === 0 || data.pose_name[entry] === 0xffffffff) continue;
      box.expandByPoint(new THREE.Vector3().fromArray(data.pose, 6 * entry));
    }
    if (box.isEmpty()) box.copy(this.sceneBox);
    if (box.isEmpty()) box.expandByPoint(new THREE.Vector3());
    return box.expandByScalar(Math.max(0.06 * box.getSize(new THREE.Vector3()).length(), 2));
  }

  makeMap() {
    if (this.head.maps.length === 0) return;
    this.mapRange = powerRange(this.data.map_values) || { low: -100, high: 0 };
    this.mapMesh = new THREE.Mesh(new THREE.PlaneBufferGeometry(1, 1),
      new THREE.MeshBasicMaterial({ side: THREE.DoubleSide, transparent: true, depthWrite: false }));
    this.mapMesh.renderOrder = 1;
    this.scene.add(this.mapMesh);
    for (const map of this.head.maps) {
      const lower = new THREE.Vector3(...map.corner_m);
      const far = lower.clone().add(new THREE.Vector3(map.columns * map.spacing_m[0], map.rows * map.spacing_m[1], 0));
      this.deviceBox.expandByPoint(lower).expandByPoint(far);
    }
  }

  // The map that the choice names, in the frame that is shown.
  showMap() {
    if (!this.mapMesh) return;
    const name = $("map_choice").value;
    const map = this.head.maps.find((one) => one.frame === this.frame && JSON.stringify([one.grid, one.tx]) === name);
    this.mapMesh.visible = map !== undefined;
    if (!map || this.mapMesh.shown === map) return;
    this.mapMesh.shown = map;
    const pixels = new Uint8Array(4 * map.columns * map.rows), { low, high } = this.mapRange;
    for (let i = 0; i < map.columns * map.rows; ++i) {
      const value = this.data.map_values[map.first + i];
      const obstructed = (this.data.map_obstructed[(map.first + i) >> 5] >>> ((map.first + i) & 31)) & 1;
      if (obstructed) pixels.set([150, 156, 162, 255], 4 * i);
      else if (!Number.isNaN(value)) pixels.set([...viridis(this.head.viridis, (value - low) / (high - low)), 255], 4 * i);
    }
    if (this.mapMesh.material.map) this.mapMesh.material.map.dispose();
    const texture = new THREE.DataTexture(pixels, map.columns, map.rows, THREE.RGBAFormat);
    texture.needsUpdate = true;
    this.mapMesh.material.map = texture;
    this.mapMesh.material.needsUpdate = true;
    const width = map.columns * map.spacing_m[0], depth = map.rows * map.spacing_m[1];
    this.mapMesh.scale.set(width, depth, 1);
    this.mapMesh.position.set(map.corner_m[0] + width / 2, map.corner_m[1] + depth / 2, map.corner_m[2]);
    this.mapMesh.updateMatrixWorld();
  }

  thingName(thing) {
    const { bodyCount, transmitterCount } = this.data;
    if (thing >= bodyCount + transmitterCount) return this.head.receivers[thing - bodyCount - transmitterCount];
    if (thing >= bodyCount) return this.head.transmitters[thing - bodyCount].id;
    const entry = poseEntry(this.data, thing, this.frame);
    return entry < 0 ? "" : this.head.names[this.data.pose_name[entry]] || "";
  }

  // Where a device is in the frame; undefined where it is not there.
  place(thing) {
    const entry = poseEntry(this.data, thing, this.frame);
    if (entry < 0 || this.data.pose_name[entry] === 0xffffffff) return undefined;
    return Array.from(this.data.pose.subarray(6 * entry, 6 * entry + 3));
  }

  transmitterThing(index) { return this.data.bodyCount + index; }
  receiverThing(index) { return this.data.bodyCount + this.data.transmitterCount + index; }
  linkKey(row) { return this.data.link_tx[row] * this.data.receiverCount + this.data.link_rx[row]; }

  // All points of a ray, from transmitter to receiver.
  rayPoints(row, ray) {
    const { data } = this, points = [];
    const from = this.place(this.transmitterThing(data.link_tx[row])), to = this.place(this.receiverThing(data.link_rx[row]));
    if (!from || !to) return points;
    points.push(from);
    for (let i = data.pointStart[ray]; i < data.pointStart[ray + 1]; ++i) {
      points.push([data.ray_points[3 * i], data.ray_points[3 * i + 1], data.ray_points[3 * i + 2]]);
    }
    points.push(to);
    return points;
  }

  rayColour(ray) {
    if (!this.byPower) return rgb(mechanisms[this.data.mechanism[this.data.ray_path[ray]]].colour);
    const { low, high } = this.rayRange, power = this.data.power[ray];
    return viridis(this.head.viridis, Number.isNaN(power) ? 0 : (power - low) / (high - low)).map((value) => value / 255);
  }

  *rows() {
    for (let row = this.data.linkStart[this.frame]; row < this.data.linkStart[this.frame + 1]; ++row) yield row;
  }

  updateRays() {
    const { data } = this;
    this.rays.clear();
    this.pickable = [];
    const rows = [...this.rows()].filter((row) => !this.hiddenLinks.has(this.linkKey(row)));
    const most = rows.reduce((sum, row) => Math.max(sum, data.link_rays[row]), 0);
    this.counts = mechanisms.map(() => 0);
    // The strongest of every link last, so that they lie on top.
    for (let rank = Math.min(most, this.strongest) - 1; rank >= 0; --rank) {
      for (const row of rows) if (rank < data.link_rays[row]) this.addRay(row, data.rayStart[row] + rank);
    }
    this.rays.show();
    this.mechanismCounts.forEach((element, index) => { element.textContent = this.counts[index]; });
    this.updateAccent();
  }

  addRay(row, ray) {
    const mechanism = this.data.mechanism[this.data.ray_path[ray]];
    ++this.counts[mechanism];
    if (!this.shown[mechanism]) return;
    const points = this.rayPoints(row, ray), tint = this.rayColour(ray);
    for (let i = 1; i < points.length; ++i) {
      this.rays.add(points[i - 1], points[i], tint);
      this.pickable.push({ row, ray });
    }
  }

  updateAccent() {
    this.halo.clear();
    this.accent.clear();
    const found = this.chosenRay();
    if (found) {
      const points = this.rayPoints(found.row, found.ray);
      for (let i = 1; i < points.length; ++i) {
        this.halo.add(points[i - 1], points[i], [0, 0, 0]);
        this.accent.add(points[i - 1], points[i], this.rayColour(found.ray));
      }
    }
    this.halo.show();
    this.accent.show();
    this.dirty = true;
  }

  // Time -------------------------------------------------------------------------------------------------------------

  showFrame(frame) {
    const { data, head } = this;
    this.frame = Math.min(Math.max(frame, 0), data.frameCount - 1);
    for (let body = 1; body < data.bodyCount; ++body) this.surfaces.pose(body, poseEntry(data, body, this.frame));
    $("slider").value = this.frame;
    const number = data.frame_index[this.frame], time = data.frame_time[this.frame];
    const range = head.frames > 1 ? `frame ${number} of ${head.first_frame} to ${head.first_frame + head.frames - 1}, ` : "";
    $("instant").textContent = `${range}t = ${time.toFixed(3)} s`;
    this.updateRays();
    this.showMap();
    this.showChosen();
  }

  tick(now) {
    requestAnimationFrame((next) => this.tick(next));
    if (this.playing) this.advance(now);
    if (!this.dirty) return;
    this.dirty = false;
    this.draw();
  }

  advance(now) {
    const { frame_time: times, frameCount } = this.data, speed = Number($("speed").value);
    if (this.frame === frameCount - 1 && speed === 0) return this.showFrame(0);
    if (speed === 0) return this.showFrame(this.frame + 1);
    this.clock += (now - this.lastTick) / 1000 * speed;
    this.lastTick = now;
    if (this.clock > times[frameCount - 1] + 0.5 * speed) this.clock = times[0];
    let frame = this.frame;
    while (frame > 0 && times[frame] > this.clock) --frame;
    while (frame + 1 < frameCount && times[frame + 1] <= this.clock) ++frame;
    if (frame !== this.frame) this.showFrame(frame);
  }

  play(on) {
    this.playing = on && this.data.frameCount > 1;
    if (this.playing && this.frame === this.data.frameCount - 1) this.showFrame(0);
    this.lastTick = performance.now();
    this.clock = this.data.frame_time[this.frame];
    this.setSharpness();
    $("play").textContent = this.playing ? "❚❚" : "▶";
    $("play").setAttribute("aria-label", this.playing ? "Pause" : "Play");
  }

  seek(frame) {
    this.showFrame(frame);
    this.clock = this.data.frame_time[this.frame];
  }

  // Drawing ----------------------------------------------------------------------------------------------------------

  resize() {
    const view = $("view"), ratio = Math.min(window.devicePixelRatio || 1, 2);
    const width = Math.max(view.clientWidth, 1), height = Math.max(view.clientHeight, 1);
    Object.assign(this, { width, height, ratio });
    this.setSharpness();
    this.camera.aspect = width / height;
    Object.assign($("overlay"), { width: width * ratio, height: height * ratio });
    this.orbit.place();
  }

  // Without a graphics card, pixels are coarser while the picture moves.
  setSharpness() {
    this.renderer.setPixelRatio(this.isSlow && this.playing ? 0.5 : this.ratio);
    this.renderer.setSize(this.width, this.height, false);
    this.dirty = true;
  }

  draw() {
    const width = Number($("ray_width").value), nearest = this.camera.near;
    this.rays.uniforms(this.width, this.height, nearest, width);
    this.accent.uniforms(this.width, this.height, nearest, width + 2);
    this.halo.uniforms(this.width, this.height, nearest, width + 5);
    this.renderer.render(this.scene, this.camera);
    this.drawOverlay();
    this.drawn = (this.drawn || 0) + 1;
  }

  // Pixels of the view; undefined behind the camera.
  project(point) {
    const p = new THREE.Vector4(point[0], point[1], point[2], 1);
    p.applyMatrix4(this.camera.matrixWorldInverse).applyMatrix4(this.camera.projectionMatrix);
    if (p.w <= 0) return undefined;
    return { x: (p.x / p.w + 1) / 2 * this.width, y: (1 - p.y / p.w) / 2 * this.height };
  }

  drawOverlay() {
    const pen = $("overlay").getContext("2d");
    pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    pen.clearRect(0, 0, this.width, this.height);
    this.symbols = [];
    for (let i = 0; i < this.data.transmitterCount + this.data.receiverCount; ++i) this.addSymbol(this.data.bodyCount + i);
    // Transmitters last: their symbols lie on top.
    for (const symbol of [...this.symbols].reverse()) this.drawSymbol(pen, symbol);
    this.drawLabels(pen);
    this.drawScale(pen);
  }

  addSymbol(thing) {
    const place = this.place(thing), at = place && this.project(place);
    if (at) this.symbols.push({ thing, ...at, transmits: thing < this.receiverThing(0) });
  }

  drawSymbol(pen, { thing, x, y, transmits }) {
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
    const chosen = this.chosen && this.chosen.thing === thing;
    pen.fillStyle = transmits ? "#1b2026" : "#ffffff";
    pen.strokeStyle = chosen ? "#D55E00" : transmits ? "#ffffff" : "#1b2026";
    pen.lineWidth = size < 4 ? 1 : chosen ? 3.5 : 2;
    pen.fill();
    pen.stroke();
  }

  // Each label takes the first free place around its symbol, or is left out.
  drawLabels(pen) {
    const taken = this.symbols.slice(0, 300).map(({ x, y }) => [x - 6, y - 6, x + 6, y + 6]);
    const order = [...this.symbols.slice(0, 300)];
    if (this.chosen) order.sort((a, b) => (b.thing === this.chosen.thing) - (a.thing === this.chosen.thing));
    for (const { thing, x, y } of order) this.drawLabel(pen, taken, this.thingName(thing), x, y, "bold 14px");
    if (!$("vehicle_names").checked) return;
    for (let body = 1; body < this.data.bodyCount; ++body) {
      const place = this.place(body), at = place && this.project(place);
      if (at) this.drawLabel(pen, taken, this.thingName(body), at.x, at.y, "13px");
    }
  }

  drawLabel(pen, taken, name, x, y, font) {
    pen.font = `${font} "Helvetica Neue", Arial, "Liberation Sans", sans-serif`;
    const text = name.length > 28 ? name.slice(0, 27) + "…" : name, width = pen.measureText(text).width;
    const places = [[x + 11, y - 9], [x - 11 - width, y - 9], [x - width / 2, y - 29], [x - width / 2, y + 11]];
    const meets = (a) => (b) => a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3];
    for (const [left, top] of places) {
      const box = [left - 3, top, left + width + 3, top + 18];
      const inside = box[0] >= 0 && box[1] >= 0 && box[2] <= this.width && box[3] <= this.height;
      if (!inside || taken.some(meets(box))) continue;
      taken.push(box);
      pen.fillStyle = "rgba(255, 255, 255, 0.82)";
      pen.fillRect(box[0], box[1], width + 6, 18);
      pen.fillStyle = "#1b2026";
      pen.textBaseline = "middle";
      pen.fillText(text, left, top + 9.5);
      return;
    }
  }

  // A length of 1, 2 or 5 · 10^n metres at the distance of the point looked at.
  drawScale(pen) {
    const metres = this.orbit.metresPerPixel() * 140, power = 10 ** Math.floor(Math.log10(metres));
    const length = [5, 2, 1].map((factor) => factor * power).find((one) => one <= metres);
    const pixels = length / this.orbit.metresPerPixel(), y = this.height - 14, x = 14;
    pen.font = '14px "Helvetica Neue", Arial, "Liberation Sans", sans-serif';
    const text = `${+length.toPrecision(1)} m`;
    pen.fillStyle = "rgba(255, 255, 255, 0.82)";
    pen.fillRect(x - 6, y - 24, Math.max(pixels, pen.measureText(text).width) + 12, 34);
    pen.strokeStyle = pen.fillStyle = "#1b2026";
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

  // Choosing ---------------------------------------------------------------------------------------------------------

  click(event) {
    if (this.orbit.travelled > 5) return;
    const bounds = this.canvas.getBoundingClientRect();
    const x = event.clientX - bounds.left, y = event.clientY - bounds.top;
    const symbol = this.nearest(this.symbols, 11, (one) => Math.hypot(one.x - x, one.y - y));
    if (symbol) return this.choose({ thing: symbol.thing });
    const segment = this.nearest(this.pickable, 7, (one, index) => this.segmentDistance(index, x, y));
    this.choose(segment ? { link: this.linkKey(segment.row), path: this.data.ray_path[segment.ray] } : null);
  }

  nearest(list, limit, distance) {
    let best, least = limit;
    list.forEach((one, index) => {
      const value = distance(one, index);
      if (value <= least) [best, least] = [one, value];
    });
    return best;
  }

  segmentDistance(index, x, y) {
    const [a, b] = this.rays.ends(index).map((end) => this.project(end));
    if (!a || !b) return Infinity;
    const dx = b.x - a.x, dy = b.y - a.y, square = dx * dx + dy * dy;
    const share = square > 0 ? Math.min(Math.max(((x - a.x) * dx + (y - a.y) * dy) / square, 0), 1) : 0;
    return Math.hypot(a.x + share * dx - x, a.y + share * dy - y);
  }

  choose(chosen) {
    this.chosen = chosen;
    this.showChosen();
    if (chosen) $("chosen").scrollIntoView({ block: "nearest" });
  }

  rowOfLink(key) {
    for (const row of this.rows()) if (this.linkKey(row) === key) return row;
    return undefined;
  }

  // A path keeps its name from frame to frame.
  chosenRay() {
    if (!this.chosen || this.chosen.path === undefined) return undefined;
    const row = this.rowOfLink(this.chosen.link);
    if (row === undefined) return undefined;
    for (let ray = this.data.rayStart[row]; ray < this.data.rayStart[row + 1]; ++ray) {
      if (this.data.ray_path[ray] === this.chosen.path) return { row, ray };
    }
    return undefined;
  }

  linkName(key) {
    const receivers = this.data.receiverCount;
    return `${this.head.transmitters[Math.floor(key / receivers)].id} → ${this.head.receivers[key % receivers]}`;
  }

  // The panel --------------------------------------------------------------------------------------------------------

  showChosen() {
    $("chosen").hidden = !this.chosen;
    this.updateAccent();
    if (!this.chosen) return;
    $("chosen_facts").replaceChildren();
    $("chosen_links").replaceChildren();
    if (this.chosen.thing !== undefined) this.showDevice(); else this.showRay();
  }

  showFacts(facts) {
    const table = make("table", undefined, $("chosen_facts"));
    for (const [name, value] of facts) {
      const row = make("tr", undefined, table);
      make("td", name, row);
      make("td", value, row);
    }
  }

  showDevice() {
    const { thing } = this.chosen, transmits = thing < this.receiverThing(0), place = this.place(thing);
    const index = thing - (transmits ? this.transmitterThing(0) : this.receiverThing(0));
    $("chosen_title").textContent = `${transmits ? "Transmitter" : "Receiver"} ${this.thingName(thing)}`;
    const centre = this.head.centre_m;
    const facts = [["position", place ? place.map((value, i) => (value + centre[i]).toFixed(2)).join(", ") + " m" : "not there"]];
    if (transmits) facts.push(["power", fixed(this.head.transmitters[index].power_dbm, 2, "dBm")]);
    this.showFacts(facts);
    const rows = [...this.rows()].filter((row) => (transmits ? this.data.link_tx : this.data.link_rx)[row] === index);
    const strength = (row) => (Number.isFinite(this.data.link_power[row]) ? this.data.link_power[row] : -1e9);
    rows.sort((a, b) => strength(b) - strength(a));
    const current = rows.find((row) => this.linkKey(row) === this.chosen.link) ?? rows[0];
    this.showLinkTable(rows.slice(0, 200), current, transmits);
    this.showProfile(current);
  }

  showLinkTable(rows, current, transmits) {
    const table = $("chosen_links"), { data } = this, titles = make("tr", undefined, table);
    const columns = [transmits ? "to" : "from", "power\ndBm", "delay spread\nns", "K\ndB", "paths"];
    for (const text of columns) make("th", text, titles);
    for (const row of rows) {
      const line = make("tr", undefined, table);
      line.dataset.row = row;
      if (row === current) line.className = "current";
      const other = transmits ? this.head.receivers[data.link_rx[row]] : this.head.transmitters[data.link_tx[row]].id;
      make("td", other, line);
      make("td", fixed(data.link_power[row], 1, "").trim(), line);
      make("td", fixed(data.link_delay_spread[row], 1, "").trim(), line);
      make("td", fixed(data.link_k_factor[row], 1, "").trim(), line);
      make("td", String(data.link_paths[row]), line);
      line.addEventListener("click", () => { this.chosen.link = this.linkKey(row); this.showChosen(); });
    }
  }

  showRay() {
    const { data } = this, found = this.chosenRay(), [kinds, id] = this.head.paths[this.chosen.path];
    const words = { R: "reflected", T: "transmitted", D: "diffracted", S: "scattered" };
    $("chosen_title").textContent = `Ray ${this.linkName(this.chosen.link)}`;
    const facts = [["path", id], ["kinds", kinds === "" ? "line of sight" : [...kinds].map((kind) => words[kind]).join(", ")]];
    if (found) {
      const length = data.ray_length[found.ray];
      facts.push(["length", fixed(length, 2, "m")], ["delay", fixed(length / speedOfLight * 1e9, 2, "ns")],
        ["path gain", fixed(data.ray_gain[found.ray], 2, "dB")], ["received power", fixed(data.power[found.ray], 2, "dBm")],
        ["Doppler", fixed(data.ray_doppler[found.ray], 1, "Hz")]);
    } else {
      facts.push(["in this frame", "not there"]);
    }
    this.showFacts(facts);
    const row = this.rowOfLink(this.chosen.link);
    if (row !== undefined) {
      this.showFacts([["link power", fixed(data.link_power[row], 2, "dBm")],
        ["delay spread (rms)", fixed(data.link_delay_spread[row], 2, "ns")], ["K factor", fixed(data.link_k_factor[row], 2, "dB")]]);
    }
    this.showProfile(row, found && found.ray);
  }

  showProfile(row, accent) {
    const { data } = this;
    $("profile_part").hidden = row === undefined;
    if (row === undefined) return;
    const rays = [];
    for (let ray = data.rayStart[row]; ray < data.rayStart[row + 1]; ++ray) {
      if (Number.isFinite(data.power[ray])) rays.push(ray);
    }
    $("profile_title").textContent = `Power over delay, ${this.linkName(this.linkKey(row))}`;
    const total = data.link_listed[row], notes = [];
    if (data.link_rays[row] < total) notes.push(`The ${data.link_rays[row]} strongest of ${total} paths.`);
    if (Number.isFinite(data.link_diffuse[row])) notes.push(`Diffuse power in all: ${fixed(data.link_diffuse[row], 1, "dBm")}.`);
    $("profile_note").textContent = notes.join(" ");
    drawProfile($("profile"), rays.map((ray) => ({ delay: data.ray_length[ray] / speedOfLight * 1e9, power: data.power[ray],
      colour: mechanisms[data.mechanism[data.ray_path[ray]]].colour, accent: ray === accent,
      thin: data.mechanism[data.ray_path[ray]] === diffuse })));
  }

  // Controls ---------------------------------------------------------------------------------------------------------

  makeControls() {
    const { head, data } = this;
    document.title = `${head.scenario} – DCEM`;
    $("title").textContent = head.scenario;
    $("frequency").textContent = frequencyText(head.frequency_hz);
    for (const notice of head.notices) make("li", notice, $("notices"));
    this.makeMechanisms();
    this.makeLinks();
    this.makeMaterials();
    this.makeMapChoice();
    Object.assign($("slider"), { max: data.frameCount - 1, disabled: data.frameCount < 2 });
    $("play").disabled = data.frameCount < 2;
    $("slider").addEventListener("input", () => this.seek(Number($("slider").value)));
    $("play").addEventListener("click", () => this.play(!this.playing));
    $("speed").addEventListener("change", () => this.play(this.playing));
    $("close_chosen").addEventListener("click", () => this.choose(null));
    this.canvas.addEventListener("click", (event) => this.click(event));
    $("view_devices").addEventListener("click", () => this.viewDevices());
    $("view_scene").addEventListener("click", () => this.orbit.fit(this.sceneBox));
    $("view_above").addEventListener("click", () => {
      Object.assign(this.orbit, { azimuth: -Math.PI / 2, elevation: 1.5707 });
      this.orbit.place();
    });
    this.makeSliders();
    window.addEventListener("resize", () => this.resize());
    window.addEventListener("keydown", (event) => this.key(event));
  }

  makeSliders() {
    Object.assign($("strongest"), { max: this.most, value: this.strongest });
    const limit = () => {
      this.strongest = Number($("strongest").value);
      $("strongest_text").textContent = `${this.strongest} of ${this.most}`;
      this.updateRays();
    };
    $("strongest").addEventListener("input", limit);
    limit();
    const bottom = this.sceneBox.min.z, height = Math.max(this.sceneBox.max.z - bottom, 0.01);
    const roof = this.coverHeight();
    if (roof !== undefined) $("cut").value = Math.floor(1000 * (roof - bottom) / height) - 1;
    const update = () => {
      $("ray_width_text").textContent = `${$("ray_width").value} px`;
      $("opacity_text").textContent = `${$("opacity").value} %`;
      const share = Number($("cut").value) / 1000, z = bottom + share * height;
      this.cut.constant = z;
      this.surfaces.setCut(share === 1 ? [] : [this.cut]);
      $("cut_text").textContent = share === 1 ? "off" : `${(z + this.head.centre_m[2]).toFixed(2)} m`;
      this.surfaces.setOpacity(Number($("opacity").value) / 100);
      this.dirty = true;
    };
    for (const id of ["ray_width", "opacity", "cut", "vehicle_names"]) $(id).addEventListener("input", update);
    update();
  }

  // Where to cut so that what is under a roof can be seen: above a map, or below the lowest ceiling where every device
  // of the first frame has one.
  coverHeight() {
    if (this.head.maps.length > 0) return Math.max(...this.head.maps.map((map) => map.corner_m[2])) + 0.3;
    const places = [];
    for (let thing = this.data.bodyCount; thing < this.receiverThing(this.data.receiverCount) && places.length < 50; ++thing) {
      const place = this.place(thing);
      if (place) places.push(place);
    }
    const ceilings = places.map((place) => this.surfaces.lowestAbove(place));
    return places.length > 0 && ceilings.every(Number.isFinite) ? Math.min(...ceilings) : undefined;
  }

  makeMechanisms() {
    const used = new Set(this.data.mechanism);
    $("rays_part").hidden = used.size === 0;
    this.mechanismCounts = [];
    mechanisms.forEach(({ name, colour }, index) => {
      if (!used.has(index)) return;
      const label = make("label", undefined, $("mechanisms")), box = make("input", undefined, label);
      label.className = "row";
      Object.assign(box, { type: "checkbox", checked: true, id: `mechanism_${index}` });
      box.addEventListener("input", () => { this.shown[index] = box.checked; this.updateRays(); });
      const swatch = make("span", undefined, label);
      swatch.className = "swatch";
      swatch.style.background = colour;
      make("span", name, label);
      this.mechanismCounts[index] = make("span", "", label);
      this.mechanismCounts[index].className = "count";
    });
    for (const box of document.querySelectorAll("input[name=colour]")) {
      box.addEventListener("input", () => {
        this.byPower = box.value === "power" && box.checked;
        $("power_bar").hidden = !this.byPower;
        this.updateRays();
      });
    }
    this.makeBar("power", this.rayRange);
  }

  makeBar(name, range) {
    const pen = $(`${name}_colours`).getContext("2d");
    for (let x = 0; x < 256; ++x) {
      pen.fillStyle = `rgb(${viridis(this.head.viridis, x / 255).map(Math.round).join(",")})`;
      pen.fillRect(x, 0, 1, 14);
    }
    $(`${name}_low`).textContent = fixed(range.low, 0, "dBm");
    $(`${name}_high`).textContent = fixed(range.high, 0, "dBm");
  }

  makeLinks() {
    const keys = new Set();
    for (let row = 0; row < this.data.link_tx.length; ++row) keys.add(this.linkKey(row));
    this.linkKeys = [...keys].sort((a, b) => a - b);
    $("links_part").hidden = this.linkKeys.length === 0;
    const setAll = (hidden) => { this.hiddenLinks = new Set(hidden ? this.linkKeys : []); this.listLinks(); this.updateRays(); };
    $("links_all").addEventListener("click", () => setAll(false));
    $("links_none").addEventListener("click", () => setAll(true));
    $("link_filter").addEventListener("input", () => this.listLinks());
    this.listLinks();
  }

  listLinks() {
    const most = 200, wanted = $("link_filter").value.toLowerCase();
    const matching = this.linkKeys.filter((key) => this.linkName(key).toLowerCase().includes(wanted));
    $("links").replaceChildren();
    for (const key of matching.slice(0, most)) {
      const label = make("label", undefined, $("links")), box = make("input", undefined, label);
      label.className = "row";
      Object.assign(box, { type: "checkbox", checked: !this.hiddenLinks.has(key) });
      box.dataset.link = key;
      box.addEventListener("input", () => {
        if (box.checked) this.hiddenLinks.delete(key); else this.hiddenLinks.add(key);
        this.updateRays();
      });
      const name = make("span", this.linkName(key), label);
      name.className = "label";
      name.title = this.linkName(key);
    }
    const shown = Math.min(matching.length, most);
    $("link_count").textContent = shown < this.linkKeys.length ? `${shown} of ${this.linkKeys.length} listed` : `${shown}`;
  }

  makeMaterials() {
    for (const material of this.head.materials) {
      if (!material.used) continue;
      const row = make("div", undefined, $("materials")), swatch = make("span", undefined, row);
      row.className = "row";
      swatch.className = "swatch block";
      swatch.style.background = material.colour;
      make("span", material.name, row).className = "label";
    }
  }

  makeMapChoice() {
    $("map_part").hidden = this.head.maps.length === 0;
    if (this.head.maps.length === 0) return;
    for (const { grid, tx } of this.head.maps) {
      const value = JSON.stringify([grid, tx]);
      if ([...$("map_choice").options].some((option) => option.value === value)) continue;
      make("option", `${tx} over ${grid}`, $("map_choice")).value = value;
    }
    const none = make("option", "none", $("map_choice"));
    none.value = "";
    $("map_choice").addEventListener("change", () => { this.showMap(); this.dirty = true; });
    this.makeBar("map", this.mapRange);
  }

  viewDevices() { this.orbit.fit(this.deviceBox); }

  key(event) {
    const tag = event.target.tagName, type = event.target.type;
    if (tag === "SELECT" || (tag === "INPUT" && type === "search") || event.ctrlKey || event.altKey || event.metaKey) return;
    const ownArrows = tag === "INPUT" && type === "range" && event.target.id !== "slider";
    const step = event.shiftKey ? 10 : 1;
    const actions = { " ": () => this.play(!this.playing), Home: () => this.seek(0), End: () => this.seek(this.data.frameCount - 1),
      ArrowRight: () => this.seek(this.frame + step), ArrowLeft: () => this.seek(this.frame - step) };
    if (!actions[event.key] || (ownArrows && event.key !== " ")) return;
    if (event.key === " " && (tag === "BUTTON" || type === "checkbox")) return;
    event.preventDefault();
    actions[event.key]();
  }
}

// Bars of power over delay, with axes.
function drawProfile(canvas, bars) {
  const width = 300, height = 180, ratio = 2, left = 52, bottom = 38, top = 8, right = 8;
  Object.assign(canvas, { width: width * ratio, height: height * ratio });
  const pen = canvas.getContext("2d");
  pen.scale(ratio, ratio);
  pen.font = '12px "Helvetica Neue", Arial, "Liberation Sans", sans-serif';
  pen.fillStyle = "#1b2026";
  if (bars.length === 0) {
    pen.fillText("Nothing arrives.", left, height / 2);
    return;
  }
  const delays = axisTicks(Math.min(...bars.map((bar) => bar.delay)), Math.max(...bars.map((bar) => bar.delay)), 5);
  const powers = axisTicks(Math.min(...bars.map((bar) => bar.power)) - 5, Math.max(...bars.map((bar) => bar.power)), 5);
  const x = (delay) => left + 6 + (delay - delays.low) / (delays.high - delays.low) * (width - left - right - 12);
  const y = (power) => top + (powers.high - power) / (powers.high - powers.low) * (height - top - bottom);
  pen.lineWidth = 1;
  for (const tick of powers.ticks) {
    pen.strokeStyle = "#dde2e7";
    pen.beginPath();
    pen.moveTo(left, y(tick));
    pen.lineTo(width - right, y(tick));
    pen.stroke();
    pen.textAlign = "right";
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
  // The many of a rough surface behind the few paths, high ones behind low ones.
  for (const bar of [...bars].sort((a, b) => b.thin - a.thin || b.power - a.power)) {
    const size = bar.accent ? 7 : bar.thin ? 2 : 4;
    if (bar.accent) {
      pen.fillStyle = "#000000";
      pen.fillRect(x(bar.delay) - size / 2 - 1.5, y(bar.power) - 1.5, size + 3, y(powers.low) - y(bar.power) + 1.5);
    }
    pen.fillStyle = bar.colour;
    pen.fillRect(x(bar.delay) - size / 2, y(bar.power), size, y(powers.low) - y(bar.power));
  }
  pen.strokeStyle = "#1b2026";
  pen.strokeRect(left, top, width - left - right, height - top - bottom);
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

try {
  window.dcemViewer = new Viewer(readResults());
} catch (error) {
  $("message").hidden = false;
  $("message").textContent = `This page needs a browser with WebGL. (${error.message})`;
}
