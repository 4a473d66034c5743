"use strict";
// Straight pieces of rays.

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
