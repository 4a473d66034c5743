"use strict";
// The page: its parts, and what happens when something is chosen, moved or drawn.

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
    Object.assign(this, { data, head: data.head, moment: new Moment(data), drawn: 0 });
    this.makeScene();
    this.makeParts();
    this.makeControls();
    this.resize();
    this.viewDevices();
    this.seek(0);
    requestAnimationFrame((now) => this.tick(now));
  }

  get frame() { return this.moment.frame; }
  get playing() { return this.player.playing; }
  seek(frame) { this.player.seek(frame); }
  play(on) { this.player.play(on); }
  choose(chosen) { this.panel.choose(chosen); }
  redraw() { this.dirty = true; }
  project(point) { return this.viewpoint.project(point, this.width, this.height); }

  // Parts ------------------------------------------------------------------------------------------------------------

  makeScene() {
    this.canvas = $("scene");
    this.isSlow = drawnInSoftware();
    this.renderer = new THREE.WebGLRenderer({ canvas: this.canvas, antialias: !this.isSlow });
    this.renderer.setClearColor(0xf2f4f6);
    this.renderer.localClippingEnabled = true;
    this.scene = new THREE.Scene();
    this.surfaces = new Surfaces(this.data, this.scene);
    this.maps = new Maps(this.scene, this.data);
    this.viewpoint = new Viewpoint(this.canvas, () => this.redraw());
    this.measure();
  }

  // What there is to look at: everything, and where devices and maps are.
  measure() {
    const { faces } = this.surfaces.meshes[0];
    faces.computeBoundingBox();
    this.sceneBox = faces.boundingBox.clone();
    this.deviceBox = this.boxOfDevices().union(this.maps.box());
    this.sceneBox.union(this.deviceBox);
    const reach = this.sceneBox.getSize(new THREE.Vector3()).length();
    Object.assign(this.viewpoint, { reach: 2 * reach + 100, farthest: 10 * reach + 100 });
  }

  // In all frames.
  boxOfDevices() {
    const box = new THREE.Box3(), { data } = this;
    for (let entry = 0; entry < data.pose_thing.length; ++entry) {
      if (data.pose_thing[entry] < data.bodyCount || data.pose_name[entry] === notThere) continue;
      box.expandByPoint(vector(data.pose, 6 * entry));
    }
    if (box.isEmpty()) box.copy(this.sceneBox);
    if (box.isEmpty()) box.expandByPoint(new THREE.Vector3());
    return box.expandByScalar(Math.max(0.06 * box.getSize(new THREE.Vector3()).length(), 2));
  }

  makeParts() {
    const redraw = () => this.redraw();
    this.rays = new Rays(this.scene, this.moment);
    this.rayControls = new RayControls(this.rays, redraw);
    this.mapControls = new MapControls(this.maps, this.moment, redraw, () => this.cutAt(this.coverHeight()));
    this.overlay = new Overlay($("overlay"), this.moment, (place) => this.project(place));
    this.panel = new Panel(this.moment, (keys) => this.rayControls.showOnly(keys), (ray) => {
      this.rays.choose(ray);
      this.redraw();
    });
    this.pointerBox = new PointerBox(this.canvas, this.viewpoint, (x, y) => this.mapLines(x, y));
    this.player = new Player(this.data.frame_time, (frame) => this.showFrame(frame), () => this.setSharpness());
  }

  makeControls() {
    const { head } = this;
    document.title = `${head.scenario} – DCEM`;
    $("title").textContent = head.scenario;
    $("frequency").textContent = frequencyText(head.frequency_hz);
    for (const note of head.notes) make("li", note, $("notes"));
    $("notes_section").hidden = head.notes.length === 0;
    for (const notice of head.notices) make("li", notice, $("notices"));
    this.makeMaterials();
    this.canvas.addEventListener("click", (event) => this.click(event));
    $("view_devices").addEventListener("click", () => this.viewDevices());
    $("view_scene").addEventListener("click", () => this.viewpoint.fit(this.sceneBox));
    $("view_plan").addEventListener("click", () => this.showPlan(!this.viewpoint.isPlan));
    $("north").addEventListener("click", () => this.viewpoint.turnNorthUp());
    this.makeSurfaceSliders();
    window.addEventListener("resize", () => this.resize());
  }

  makeMaterials() {
    for (const material of this.head.materials) {
      if (!material.used) continue;
      const row = make("div", undefined, $("materials"), "row");
      make("span", undefined, row, "swatch block").style.background = material.colour;
      make("span", material.name, row, "label");
    }
  }

  makeSurfaceSliders() {
    for (const id of ["ray_width", "opacity", "cut", "vehicle_names"]) $(id).addEventListener("input", () => this.applySliders());
    this.cutAt(this.coverHeight());
  }

  applySliders() {
    const bottom = this.sceneBox.min.z, share = Number($("cut").value) / 1000;
    const z = share === 1 ? undefined : bottom + share * Math.max(this.sceneBox.max.z - bottom, 0.01);
    $("ray_width_text").textContent = `${$("ray_width").value} px`;
    $("opacity_text").textContent = `${$("opacity").value} %`;
    $("cut_text").textContent = z === undefined ? "off" : fixed(z + this.head.centre_m[2], 2, "m");
    this.surfaces.setCut(z);
    this.surfaces.setOpacity(Number($("opacity").value) / 100);
    this.redraw();
  }

  cutAt(height) {
    const bottom = this.sceneBox.min.z, share = (height - bottom) / Math.max(this.sceneBox.max.z - bottom, 0.01);
    $("cut").value = height === undefined ? 1000 : Math.floor(1000 * share) - 1;
    this.applySliders();
  }

  // Where to cut so that what is under a roof can be seen: above the map of a grid, or below the lowest ceiling where
  // every device or point of the first frame has one.
  coverHeight() {
    const map = this.head.maps.find((one) => one.places === $("map_places").value);
    if (map && !this.maps.isList(map)) return map.corner_m[2] + 0.3;
    const places = this.covered(50);
    const ceilings = places.map((place) => this.surfaces.lowestAbove(place));
    return places.length > 0 && ceilings.every(Number.isFinite) ? Math.min(...ceilings) : undefined;
  }

  // Places of the first frame that one wants to see, at most so many.
  covered(most) {
    const places = [];
    for (let thing = this.data.bodyCount; thing < this.moment.receiverThing(this.data.receiverCount); ++thing) {
      const place = places.length < most ? this.moment.place(thing) : undefined;
      if (place) places.push(place);
    }
    for (const map of this.head.maps) {
      for (let i = 0; this.maps.isList(map) && i < map.points && places.length < most; ++i) places.push(this.maps.pointAt(map, i));
    }
    return places;
  }

  // Looking -----------------------------------------------------------------------------------------------------------

  viewDevices() { this.viewpoint.fit(this.deviceBox); }

  showPlan(on) {
    this.viewpoint.setPlan(on);
    $("view_plan").setAttribute("aria-pressed", String(on));
  }

  resize() {
    const view = $("view");
    Object.assign(this, { width: Math.max(view.clientWidth, 1), height: Math.max(view.clientHeight, 1),
                          ratio: Math.min(window.devicePixelRatio || 1, 2) });
    this.setSharpness();
    this.overlay.resize(this.width, this.height, this.ratio);
    this.viewpoint.resize(this.width, this.height);
  }

  // Without a graphics card, pixels are coarser while the picture moves.
  setSharpness() {
    this.pixels = this.isSlow && this.playing ? 0.5 : this.ratio;
    this.renderer.setPixelRatio(this.pixels);
    this.renderer.setSize(this.width, this.height, false);
    this.redraw();
  }

  showFrame(frame) {
    const { data, head, moment } = this;
    moment.frame = frame;
    for (let body = 1; body < data.bodyCount; ++body) this.surfaces.pose(body, poseEntry(data, body, frame));
    const last = head.first_frame + head.frames - 1;
    const range = head.frames > 1 ? `frame ${data.frame_index[frame]} of ${head.first_frame} to ${last}, ` : "";
    setText($("instant"), `${range}t = ${data.frame_time[frame].toFixed(3)} s`);
    this.panel.show();
    this.rayControls.update();
    this.mapControls.show();
  }

  tick(now) {
    requestAnimationFrame((next) => this.tick(next));
    this.player.tick(now);
    if (!this.dirty) return;
    this.dirty = false;
    this.draw();
  }

  draw() {
    const { viewpoint } = this;
    this.rays.setSize(this.width, this.height, viewpoint.camera.near, Number($("ray_width").value));
    this.maps.setPointSize(this.pixels);
    this.renderer.render(this.scene, viewpoint.camera);
    this.overlay.draw({ chosenThing: this.panel.thing, metresPerPixel: viewpoint.metresPerPixel(),
                        objectNames: $("vehicle_names").checked });
    this.turnNeedle(viewpoint.northOnScreen());
    this.pointerBox.show();
    ++this.drawn;
  }

  turnNeedle(north) {
    if (this.north === north) return;
    this.north = north;
    $("needle").setAttribute("transform", `rotate(${(north * 180 / Math.PI).toFixed(1)})`);
    $("north_letter").setAttribute("x", (17 * Math.sin(north)).toFixed(1));
    $("north_letter").setAttribute("y", (-17 * Math.cos(north)).toFixed(1));
  }

  // Pointing ----------------------------------------------------------------------------------------------------------

  // What the map says at a pixel, unless a surface hides it there.
  mapLines(x, y) {
    const index = this.maps.find(x, y, this.viewpoint, this.width, this.height);
    if (index === undefined) return undefined;
    const line = this.viewpoint.sightLine(x, y, this.width, this.height);
    const isGrid = !this.maps.isList(this.maps.entry);
    return isGrid && this.surfaces.hides(line, this.maps.entry.corner_m[2]) ? undefined : this.mapControls.lines(index);
  }

  click(event) {
    if (this.viewpoint.travelled > 5) return;
    const bounds = this.canvas.getBoundingClientRect();
    const x = event.clientX - bounds.left, y = event.clientY - bounds.top;
    const symbol = this.nearest(this.overlay.symbols, 11, (one) => Math.hypot(one.x - x, one.y - y));
    if (symbol) return this.choose({ thing: symbol.thing });
    // Of several under the pointer the one on top, which is the strongest.
    const project = (place) => this.project(place), distance = (one, index) => Math.max(this.rays.distance(index, x, y, project), 2);
    const piece = this.nearest(this.rays.pickable, 7, distance);
    this.choose(piece ? { link: this.moment.linkKey(piece.row), path: this.data.ray_path[piece.ray] } : null);
  }

  // The last of those that are equally near.
  nearest(list, limit, distance) {
    let best, least = limit;
    list.forEach((one, index) => {
      const value = distance(one, index);
      if (value <= least) [best, least] = [one, value];
    });
    return best;
  }
}

try {
  window.dcemViewer = new Viewer(readResults());
} catch (error) {
  $("message").hidden = false;
  $("message").textContent = `This page needs a browser with WebGL. (${error.message})`;
}
