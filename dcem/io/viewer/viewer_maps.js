"use strict";
// Maps over grids and lists of points: which one is shown, its values, its colours in the scene.

const obstructedColour = [150, 156, 162];
const sinrRange = { low: -10, high: 30 };  // as in the pictures, so that maps can be compared

const pointVertexShader = `
  attribute vec3 tint; uniform float size; varying vec3 colour;
  void main() {
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
    gl_PointSize = size;
    colour = tint;
  }`;
// Discs with a thin dark rim.
const pointFragmentShader = `
  uniform float size; uniform float opacity; varying vec3 colour;
  void main() {
    float rim = size * (0.5 - length(gl_PointCoord - 0.5));
    gl_FragColor = vec4(mix(vec3(0.11, 0.13, 0.15), colour, 0.45 + 0.55 * clamp(rim - 0.5, 0.0, 1.0)), opacity * clamp(rim, 0.0, 1.0));
  }`;

class Maps {
  constructor(scene, data) {
    Object.assign(this, { data, head: data.head, maps: data.head.maps, entry: undefined, layer: undefined });
    this.range = powerRange(this.powers());
    this.mesh = new THREE.Mesh(new THREE.PlaneBufferGeometry(1, 1),
      new THREE.MeshBasicMaterial({ side: THREE.DoubleSide, transparent: true, depthWrite: false,
                                    polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 2 }));
    this.mesh.renderOrder = 1;
    this.mesh.visible = false;
    scene.add(this.mesh);
    this.makePoints(scene);
  }

  // All powers of all frames have one scale.
  powers() {
    const parts = this.maps.flatMap((map) => map.layers.filter(({ shows }) => shows === "power")
      .map(({ first }) => this.data.map_values.subarray(first, first + this.size(map))));
    const all = new Float32Array(parts.reduce((sum, part) => sum + part.length, 0));
    let at = 0;
    for (const part of parts) {
      all.set(part, at);
      at += part.length;
    }
    return all;
  }

  // What hides a point of a list lets it shine through faintly.
  makePoints(scene) {
    this.geometry = new THREE.BufferGeometry();
    this.points = [[THREE.GreaterDepth, 0.28], [THREE.LessEqualDepth, 1]].map(([depthFunc, opacity]) => {
      const material = new THREE.ShaderMaterial({ uniforms: { size: { value: 9 }, opacity: { value: opacity } },
        vertexShader: pointVertexShader, fragmentShader: pointFragmentShader, depthFunc, depthWrite: false, transparent: true });
      const points = new THREE.Points(this.geometry, material);
      Object.assign(points, { frustumCulled: false, renderOrder: 2, visible: false });
      scene.add(points);
      return points;
    });
  }

  isList(map) { return map.points !== undefined; }
  size(map) { return this.isList(map) ? map.points : map.columns * map.rows; }
  value(layer, index) { return layer ? this.data.map_values[layer.first + index] : NaN; }
  isObstructed(map, index) {
    const bit = map.first_obstructed + index;
    return ((this.data.map_obstructed[bit >> 5] >>> (bit & 31)) & 1) === 1;
  }

  // The place of a point, as the page counts it.
  pointAt(map, index) {
    const at = 3 * (map.first_point + index);
    if (this.isList(map)) return Array.from(this.data.map_points.subarray(at, at + 3));
    const [x, y, z] = map.corner_m, column = index % map.columns, row = Math.floor(index / map.columns);
    return [x + (column + 0.5) * map.spacing_m[0], y + (row + 0.5) * map.spacing_m[1], z];
  }

  layerName({ shows, tx }) {
    return { power: () => `power of ${this.head.transmitters[tx].id}`, best_server: () => "best server", sinr: () => "SINR",
             sir: () => "SIR (no noise)" }[shows]();
  }

  // Where the maps lie.
  box() {
    const box = new THREE.Box3();
    for (const map of this.maps) {
      if (this.isList(map)) {
        for (let i = 0; i < map.points; ++i) box.expandByPoint(new THREE.Vector3(...this.pointAt(map, i)));
      } else {
        const lower = new THREE.Vector3(...map.corner_m);
        box.expandByPoint(lower).expandByPoint(
          lower.clone().add(new THREE.Vector3(map.columns * map.spacing_m[0], map.rows * map.spacing_m[1], 0)));
      }
    }
    return box;
  }

  // Shows a layer of a map; nothing where both are undefined.
  show(entry, layer) {
    if (this.entry === entry && this.layer === layer) return;
    Object.assign(this, { entry, layer });
    this.mesh.visible = entry !== undefined && !this.isList(entry);
    for (const points of this.points) points.visible = entry !== undefined && this.isList(entry);
    if (this.mesh.visible) this.showGrid();
    else if (entry) this.showList();
  }

  // Red, green, blue in 0 … 255; undefined where there is no value.
  colourAt(index) {
    const value = this.value(this.layer, index);
    if (this.isObstructed(this.entry, index)) return obstructedColour;
    if (Number.isNaN(value)) return undefined;
    if (this.layer.shows === "best_server") return rgb(this.head.transmitters[value].colour).map((part) => 255 * part);
    return colourOn(this.head.viridis, this.layer.shows === "power" ? this.range : sinrRange, value);
  }

  showGrid() {
    const map = this.entry, pixels = new Uint8Array(4 * this.size(map));
    for (let i = 0; i < this.size(map); ++i) {
      const colour = this.colourAt(i);
      if (colour) pixels.set([...colour, 255], 4 * i);
    }
    if (this.mesh.material.map) this.mesh.material.map.dispose();
    this.mesh.material.map = new THREE.DataTexture(pixels, map.columns, map.rows, THREE.RGBAFormat);
    this.mesh.material.map.needsUpdate = true;
    this.mesh.material.needsUpdate = true;
    const width = map.columns * map.spacing_m[0], depth = map.rows * map.spacing_m[1];
    this.mesh.scale.set(width, depth, 1);
    this.mesh.position.set(map.corner_m[0] + width / 2, map.corner_m[1] + depth / 2, map.corner_m[2]);
    this.mesh.updateMatrixWorld();
  }

  // A point at which nothing arrives is white.
  showList() {
    const map = this.entry, places = new Float32Array(3 * map.points), tints = new Float32Array(3 * map.points);
    for (let i = 0; i < map.points; ++i) {
      places.set(this.pointAt(map, i), 3 * i);
      tints.set((this.colourAt(i) || [255, 255, 255]).map((value) => value / 255), 3 * i);
    }
    this.geometry.setAttribute("position", new THREE.BufferAttribute(places, 3));
    this.geometry.setAttribute("tint", new THREE.BufferAttribute(tints, 3));
    this.geometry.setDrawRange(0, map.points);
  }

  setPointSize(pixels) {
    const size = this.entry && this.entry.points > 2000 ? 6 : 11;
    for (const { material } of this.points) material.uniforms.size.value = size * pixels;
  }

  // The point of the map that is seen at a pixel: on a grid the cell under it, of a list the nearest within ten pixels.
  find(x, y, viewpoint, width, height) {
    if (!this.entry) return undefined;
    return this.isList(this.entry) ? this.findOnList(x, y, viewpoint, width, height)
                                   : this.findOnGrid(viewpoint.sightLine(x, y, width, height));
  }

  findOnGrid({ from, to }) {
    const map = this.entry, share = (map.corner_m[2] - from.z) / (to.z - from.z);
    if (!(share >= 0 && share <= 1)) return undefined;
    const column = Math.floor((from.x + share * (to.x - from.x) - map.corner_m[0]) / map.spacing_m[0]);
    const row = Math.floor((from.y + share * (to.y - from.y) - map.corner_m[1]) / map.spacing_m[1]);
    const inside = column >= 0 && row >= 0 && column < map.columns && row < map.rows;
    return inside ? row * map.columns + column : undefined;
  }

  findOnList(x, y, viewpoint, width, height) {
    let best, least = 10;
    for (let i = 0; i < this.entry.points; ++i) {
      const at = viewpoint.project(this.pointAt(this.entry, i), width, height);
      const distance = at ? Math.hypot(at.x - x, at.y - y) : Infinity;
      if (distance < least) [best, least] = [i, distance];
    }
    return best;
  }

  // What is known of a point: its server and the power of it, or that of the transmitter whose map is shown.
  factsAt(index) {
    const { entry, layer } = this, shown = this.value(layer, index);
    const servers = entry.layers.find(({ shows }) => shows === "best_server");
    const tx = layer.shows === "power" ? layer.tx : servers ? this.value(servers, index) : 0;
    const power = entry.layers.find((one) => one.shows === "power" && one.tx === tx);
    return { point: this.pointAt(entry, index), obstructed: this.isObstructed(entry, index), shown, tx,
             power: this.value(power, index) };
  }
}
