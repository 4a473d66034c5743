"use strict";
// What is drawn in three dimensions: surfaces, vehicles, rays and maps; and the camera.

const vehicleTint = 0.72; // vehicles are darker than the walls of the same material

// Surfaces have no front, so the shade depends on the direction of a face and not on its winding.
function shadeOf(normal) {
  const square = normal.x * normal.x * 0.74 + normal.y * normal.y * 0.86 + normal.z * normal.z * 1.0;
  return Number.isFinite(square) ? square : 1;
}

class Surfaces {
  constructor(data, scene) {
    this.data = data;
    this.materials = data.head.materials.map((material) => new THREE.Color(material.colour));
    const offset = { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 };
    this.faceMaterial = new THREE.MeshBasicMaterial(
      { vertexColors: THREE.VertexColors, side: THREE.DoubleSide, ...offset });
    this.edgeMaterial = new THREE.LineBasicMaterial({ color: 0x59636d, transparent: true });
    this.meshes = data.head.meshes.map((mesh) => this.build(mesh, 1));
    this.objects = data.head.bodies.map((body, index) => {
      const parts = index === 0 ? this.meshes[body.mesh] : this.vehicleMesh(body.mesh);
      const object = new THREE.Group();
      object.add(new THREE.Mesh(parts.faces, this.faceMaterial), new THREE.LineSegments(parts.edges, this.edgeMaterial));
      object.rotation.order = "ZYX";
      object.visible = index === 0;
      scene.add(object);
      return object;
    });
  }

  vehicleMesh(mesh) {
    this.vehicles = this.vehicles || new Map();
    if (!this.vehicles.has(mesh)) this.vehicles.set(mesh, this.build(this.data.head.meshes[mesh], vehicleTint));
    return this.vehicles.get(mesh);
  }

  corner(mesh, triangle, i) {
    const vertex = mesh.first_vertex + this.data.triangles[3 * (mesh.first_triangle + triangle) + i];
    return new THREE.Vector3().fromArray(this.data.vertices, 3 * vertex);
  }

  build(mesh, tint) {
    const count = mesh.triangles, positions = new Float32Array(9 * count), colours = new Float32Array(9 * count);
    const edges = new Map(), normals = [];
    for (let triangle = 0; triangle < count; ++triangle) {
      const corners = [0, 1, 2].map((i) => this.corner(mesh, triangle, i));
      const normal = corners[1].clone().sub(corners[0]).cross(corners[2].clone().sub(corners[0])).normalize();
      const colour = this.materials[this.data.triangle_material[mesh.first_triangle + triangle]];
      const shade = tint * shadeOf(normal);
      normals.push(normal);
      corners.forEach((corner, i) => {
        corner.toArray(positions, 9 * triangle + 3 * i);
        colours.set([colour.r * shade, colour.g * shade, colour.b * shade], 9 * triangle + 3 * i);
        this.addEdge(edges, mesh, triangle, i);
      });
    }
    const faces = new THREE.BufferGeometry();
    faces.setAttribute("position", new THREE.BufferAttribute(positions, 3));
    faces.setAttribute("color", new THREE.BufferAttribute(colours, 3));
    return { faces, edges: this.edgeGeometry(edges, normals, mesh) };
  }

  addEdge(edges, mesh, triangle, i) {
    const at = 3 * (mesh.first_triangle + triangle);
    const a = this.data.triangles[at + i], b = this.data.triangles[at + (i + 1) % 3];
    const key = Math.min(a, b) * mesh.vertices + Math.max(a, b);
    const entry = edges.get(key);
    if (entry) entry.triangles.push(triangle); else edges.set(key, { a, b, triangles: [triangle] });
  }

  // Lines where a surface ends or bends by more than 10 degrees.
  edgeGeometry(edges, normals, mesh) {
    const points = [];
    for (const edge of edges.values()) {
      const [first, second] = edge.triangles;
      const flat = edge.triangles.length === 2 && Math.abs(normals[first].dot(normals[second])) > 0.985;
      if (flat) continue;
      for (const vertex of [edge.a, edge.b]) {
        const at = 3 * (mesh.first_vertex + vertex);
        points.push(this.data.vertices[at], this.data.vertices[at + 1], this.data.vertices[at + 2]);
      }
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(points), 3));
    return geometry;
  }

  setOpacity(opacity) {
    Object.assign(this.faceMaterial, { opacity, transparent: opacity < 1, depthWrite: opacity === 1 });
    this.faceMaterial.needsUpdate = true;
    this.edgeMaterial.opacity = Math.max(opacity, 0.35);
  }

  // Height at which a line upwards from a point first meets the scenery; Infinity where it does not.
  lowestAbove([x, y, z]) {
    const corners = this.meshes[0].faces.attributes.position.array;
    let lowest = Infinity;
    for (let at = 0; at < corners.length; at += 9) {
      const [ax, ay, az, bx, by, bz, cx, cy, cz] = corners.subarray(at, at + 9);
      const area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
      if (Math.abs(area) < 1e-9) continue;
      const b = ((x - ax) * (cy - ay) - (cx - ax) * (y - ay)) / area, c = ((bx - ax) * (y - ay) - (x - ax) * (by - ay)) / area;
      const height = az + b * (bz - az) + c * (cz - az);
      if (b >= 0 && c >= 0 && b + c <= 1 && height > z + 0.01) lowest = Math.min(lowest, height);
    }
    return lowest;
  }

  // Shows what lies below the planes alone.
  setCut(planes) {
    for (const material of [this.faceMaterial, this.edgeMaterial]) {
      material.clippingPlanes = planes;
      material.needsUpdate = true;
    }
  }

  pose(body, entry) {
    const object = this.objects[body];
    object.visible = entry >= 0 && this.data.pose_name[entry] !== 0xffffffff;
    if (!object.visible) return;
    const at = 6 * entry;
    object.position.fromArray(this.data.pose, at);
    object.rotation.set(this.data.pose[at + 5], this.data.pose[at + 4], this.data.pose[at + 3], "ZYX");
  }
}

// Lines of a width in pixels: each segment is a quad that the vertex shader lays out on the screen. Its four vertices are
// written out, since a browser that draws in software takes every instance for a picture of its own.
const rayVertexShader = `
  attribute vec3 start; attribute vec3 stop; attribute vec3 tint;
  uniform vec2 size; uniform float width; uniform float nearest;
  varying vec3 colour; varying float across;
  void main() {
    vec4 a = modelViewMatrix * vec4(start, 1.0), b = modelViewMatrix * vec4(stop, 1.0);
    if (a.z > -nearest && b.z < -nearest) a = mix(a, b, (a.z + nearest) / (a.z - b.z));
    if (b.z > -nearest && a.z < -nearest) b = mix(b, a, (b.z + nearest) / (b.z - a.z));
    vec4 p = projectionMatrix * a, q = projectionMatrix * b;
    vec2 along = (q.xy / q.w - p.xy / p.w) * size;
    along = length(along) > 0.0 ? normalize(along) : vec2(1.0, 0.0);
    gl_Position = position.x < 0.5 ? p : q;
    gl_Position.xy += vec2(-along.y, along.x) * position.y * (width + 1.0) / size * gl_Position.w;
    colour = tint;
    across = position.y * (width + 1.0) / 2.0;
  }`;
const rayFragmentShader = `
  uniform float opacity; uniform float width; varying vec3 colour; varying float across;
  void main() { gl_FragColor = vec4(colour, opacity * clamp(width / 2.0 + 0.5 - abs(across), 0.0, 1.0)); }`;

class Segments {
  constructor(scene, layers) {
    this.geometry = new THREE.BufferGeometry();
    this.layers = layers.map((layer) => {
      const material = new THREE.ShaderMaterial({
        uniforms: { size: { value: new THREE.Vector2(1, 1) }, width: { value: 2.5 }, nearest: { value: 0.1 },
                    opacity: { value: layer.opacity } },
        vertexShader: rayVertexShader, fragmentShader: rayFragmentShader, side: THREE.DoubleSide,
        depthFunc: layer.depth, depthTest: layer.depth !== THREE.AlwaysDepth, depthWrite: false, transparent: true });
      const mesh = new THREE.Mesh(this.geometry, material);
      mesh.frustumCulled = false;
      mesh.renderOrder = layer.order;
      scene.add(mesh);
      return material;
    });
    this.reserve(256);
    this.count = 0;
  }

  reserve(capacity) {
    const old = this.values, corners = new Float32Array(12 * capacity), index = new Uint32Array(6 * capacity);
    for (let i = 0; i < capacity; ++i) {
      corners.set([0, -1, 0, 1, -1, 0, 1, 1, 0, 0, 1, 0], 12 * i);
      index.set([0, 1, 2, 0, 2, 3].map((corner) => 4 * i + corner), 6 * i);
    }
    this.capacity = capacity;
    this.geometry.setAttribute("position", new THREE.BufferAttribute(corners, 3));
    this.geometry.setIndex(new THREE.BufferAttribute(index, 1));
    this.values = {};
    for (const name of ["start", "stop", "tint"]) {
      this.values[name] = new Float32Array(12 * capacity);
      if (old) this.values[name].set(old[name]);
      const attribute = new THREE.BufferAttribute(this.values[name], 3);
      attribute.setUsage ? attribute.setUsage(THREE.DynamicDrawUsage) : (attribute.dynamic = true);
      this.geometry.setAttribute(name, attribute);
    }
  }

  clear() { this.count = 0; }

  add(from, to, tint) {
    if (this.count === this.capacity) this.reserve(2 * this.capacity);
    const { start, stop, tint: colours } = this.values, first = 12 * this.count++;
    for (let at = first; at < first + 12; at += 3) {
      for (let i = 0; i < 3; ++i) {
        start[at + i] = from[i];
        stop[at + i] = to[i];
        colours[at + i] = tint[i];
      }
    }
  }

  ends(index) { return [this.values.start, this.values.stop].map((array) => array.subarray(12 * index, 12 * index + 3)); }

  show() {
    this.geometry.setDrawRange(0, 6 * this.count);
    for (const name of ["start", "stop", "tint"]) {
      const attribute = this.geometry.attributes[name];
      attribute.updateRange = { offset: 0, count: Math.max(12 * this.count, 3) };
      attribute.needsUpdate = true;
    }
  }

  uniforms(width, height, nearest, rayWidth) {
    for (const material of this.layers) {
      material.uniforms.size.value.set(width, height);
      material.uniforms.nearest.value = nearest;
      material.uniforms.width.value = rayWidth;
    }
  }
}

// A turntable with z up.
class Orbit {
  constructor(camera, element, changed) {
    Object.assign(this, { camera, element, changed, target: new THREE.Vector3(), azimuth: -1.9, elevation: 0.85, distance: 100 });
    this.pointers = new Map();
    this.travelled = 0;
    element.addEventListener("pointerdown", (event) => this.down(event));
    element.addEventListener("pointermove", (event) => this.move(event));
    for (const name of ["pointerup", "pointercancel"]) element.addEventListener(name, (event) => this.up(event));
    element.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    element.addEventListener("contextmenu", (event) => event.preventDefault());
  }

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
    } else if (event.shiftKey || (event.buttons & 6) !== 0) {
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

  metresPerPixel() {
    const height = this.element.clientHeight || 1;
    return 2 * this.distance * Math.tan(this.camera.fov * Math.PI / 360) / height;
  }

  pan(dx, dy) {
    const step = this.metresPerPixel(), right = new THREE.Vector3(), up = new THREE.Vector3();
    this.camera.matrix.extractBasis(right, up, new THREE.Vector3());
    this.target.addScaledVector(right, -dx * step).addScaledVector(up, dy * step);
  }

  wheel(event) {
    event.preventDefault();
    this.distance *= Math.exp(0.0012 * event.deltaY * (event.deltaMode === 1 ? 20 : 1));
    this.place();
  }

  place() {
    this.distance = Math.min(Math.max(this.distance, 0.5), this.farthest || 1e6);
    const c = Math.cos(this.elevation);
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(c * Math.cos(this.azimuth), c * Math.sin(this.azimuth), Math.sin(this.elevation))
      .multiplyScalar(this.distance).add(this.target);
    this.camera.lookAt(this.target);
    this.camera.near = this.distance / 500;
    this.camera.far = this.distance + (this.reach || 1e4) + this.target.length();
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    this.camera.matrixWorldInverse.getInverse(this.camera.matrixWorld);
    this.changed();
  }

  fit(box) {
    const size = box.getSize(new THREE.Vector3());
    box.getCenter(this.target);
    const narrow = Math.min(1, this.camera.aspect);
    this.distance = Math.max(0.42 * size.length() / Math.tan(this.camera.fov * Math.PI / 360) / narrow, 3);
    this.place();
  }
}
