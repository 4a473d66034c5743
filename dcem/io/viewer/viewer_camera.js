"use strict";
// Where one looks from: a turntable with z up, or a plan from above, north up and without perspective.

class Viewpoint {
  constructor(element, changed) {
    Object.assign(this, { element, changed, target: new THREE.Vector3(), azimuth: -1.9, elevation: 0.85, distance: 100 });
    this.isPlan = false;
    this.perspective = new THREE.PerspectiveCamera(40, 1, 0.1, 1000);
    this.plan = new THREE.OrthographicCamera(-1, 1, 1, -1, 1, 1000);
    this.pointers = new Map();
    this.travelled = 0;
    element.addEventListener("pointerdown", (event) => this.down(event));
    element.addEventListener("pointermove", (event) => this.move(event));
    for (const name of ["pointerup", "pointercancel"]) element.addEventListener(name, (event) => this.up(event));
    element.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    element.addEventListener("contextmenu", (event) => event.preventDefault());
  }

  get camera() { return this.isPlan ? this.plan : this.perspective; }
  get aspect() { return this.perspective.aspect; }
  get isDragged() { return this.pointers.size > 0 && this.travelled > 5; }

  // Half of what a picture shows from its lower to its upper edge, at the place looked at.
  halfHeight() { return this.distance * Math.tan(this.perspective.fov * Math.PI / 360); }
  metresPerPixel() { return 2 * this.halfHeight() / (this.element.clientHeight || 1); }

  down(event) {
    try { this.element.setPointerCapture(event.pointerId); } catch (error) { /* a pointer that is gone already */ }
    if (this.pointers.size === 0) this.travelled = 0;
    this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  }

  up(event) { this.pointers.delete(event.pointerId); }

  move(event) {
    const pointer = this.pointers.get(event.pointerId);
    if (!pointer) return;
    const dx = event.clientX - pointer.x, dy = event.clientY - pointer.y;
    this.travelled += Math.abs(dx) + Math.abs(dy);
    const before = this.spread();
    pointer.x = event.clientX;
    pointer.y = event.clientY;
    if (this.pointers.size >= 2) {
      if (before > 0) this.distance *= before / Math.max(this.spread(), 1);
      this.pan(dx / 2, dy / 2);
    } else if (this.isPlan || event.shiftKey || (event.buttons & 6) !== 0) {
      this.pan(dx, dy);
    } else {
      this.azimuth -= 0.006 * dx;
      this.elevation = Math.min(Math.max(this.elevation + 0.006 * dy, -1.5), 1.5707);
    }
    this.place();
  }

  spread() {
    const [a, b] = [...this.pointers.values()];
    return a && b ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
  }

  pan(dx, dy) {
    const step = this.metresPerPixel(), right = new THREE.Vector3(), up = new THREE.Vector3();
    this.camera.matrix.extractBasis(right, up, new THREE.Vector3());
    this.target.addScaledVector(right, -dx * step).addScaledVector(up, dy * step);
  }

  // On the plan the place under the pointer stays there.
  wheel(event) {
    event.preventDefault();
    const before = this.metresPerPixel();
    this.distance *= Math.exp(0.0012 * event.deltaY * (event.deltaMode === 1 ? 20 : 1));
    this.limit();
    if (this.isPlan) {
      const bounds = this.element.getBoundingClientRect(), shift = before - this.metresPerPixel();
      this.target.x += shift * (event.clientX - bounds.left - bounds.width / 2);
      this.target.y -= shift * (event.clientY - bounds.top - bounds.height / 2);
    }
    this.place();
  }

  limit() { this.distance = Math.min(Math.max(this.distance, 0.5), this.farthest || 1e6); }

  place() {
    this.limit();
    if (this.isPlan) this.placePlan(); else this.placePerspective();
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    this.camera.matrixWorldInverse.getInverse(this.camera.matrixWorld);
    this.changed();
  }

  placePerspective() {
    const c = Math.cos(this.elevation), camera = this.perspective;
    camera.up.set(0, 0, 1);
    camera.position.set(c * Math.cos(this.azimuth), c * Math.sin(this.azimuth), Math.sin(this.elevation))
      .multiplyScalar(this.distance).add(this.target);
    camera.lookAt(this.target);
    camera.near = this.distance / 500;
    camera.far = this.distance + (this.reach || 1e4) + this.target.length();
  }

  placePlan() {
    const reach = this.reach || 1e4, half = this.halfHeight(), camera = this.plan;
    camera.position.copy(this.target).setZ(this.target.z + reach);
    camera.rotation.set(0, 0, 0);  // straight down, x to the right, y upwards
    Object.assign(camera, { left: -half * this.aspect, right: half * this.aspect, top: half, bottom: -half, near: 1, far: 2 * reach });
  }

  resize(width, height) {
    this.perspective.aspect = width / height;
    this.place();
  }

  setPlan(on) {
    this.isPlan = on;
    this.place();
  }

  turnNorthUp() {
    this.azimuth = -Math.PI / 2;
    this.place();
  }

  // Clockwise from upwards on the screen, radians.
  northOnScreen() {
    const right = new THREE.Vector3(), up = new THREE.Vector3();
    this.camera.matrixWorld.extractBasis(right, up, new THREE.Vector3());
    return Math.atan2(right.y, up.y);
  }

  // Comes as near as the whole box allows.
  fit(box) {
    const slope = Math.tan(this.perspective.fov * Math.PI / 360), corner = new THREE.Vector3();
    const [right, up, back] = [0, 1, 2].map(() => new THREE.Vector3());
    box.getCenter(this.target);
    this.place();
    this.camera.matrixWorld.extractBasis(right, up, back);
    this.distance = 3;
    for (let i = 0; i < 8; ++i) {
      corner.set(i & 1 ? box.min.x : box.max.x, i & 2 ? box.min.y : box.max.y, i & 4 ? box.min.z : box.max.z).sub(this.target);
      const half = Math.max(Math.abs(corner.dot(up)), Math.abs(corner.dot(right)) / this.aspect);
      this.distance = Math.max(this.distance, 1.04 * half / slope + (this.isPlan ? 0 : corner.dot(back)));
    }
    this.place();
  }

  // Pixels of the view; undefined behind the camera.
  project(point, width, height) {
    const p = new THREE.Vector4(point[0], point[1], point[2], 1);
    p.applyMatrix4(this.camera.matrixWorldInverse).applyMatrix4(this.camera.projectionMatrix);
    if (p.w <= 0) return undefined;
    return { x: (p.x / p.w + 1) / 2 * width, y: (1 - p.y / p.w) / 2 * height };
  }

  // The line of sight through a pixel of the view: from the nearest to the farthest place that is drawn.
  sightLine(x, y, width, height) {
    const at = (depth) => new THREE.Vector3(2 * x / width - 1, 1 - 2 * y / height, depth).unproject(this.camera);
    return { from: at(-1), to: at(1) };
  }
}
