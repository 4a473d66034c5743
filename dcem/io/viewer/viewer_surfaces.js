"use strict";
// Scenery and vehicles: their faces and edges, what is cut away, what hides a place.

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
    this.section = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color: 0x1b2026 }));
    this.section.renderOrder = 1.5; // on top of a map at the same place
    scene.add(this.section);
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

  // Shows what lies below a height alone; everything where it is undefined.
  setCut(height) {
    this.cutHeight = height;
    this.drawSection(height);
    const planes = height === undefined ? [] : [new THREE.Plane(new THREE.Vector3(0, 0, -1), height)];
    for (const material of [this.faceMaterial, this.edgeMaterial]) {
      material.clippingPlanes = planes;
      material.needsUpdate = true;
    }
  }

  // The lines along which walls of the scenery are cut: seen from above a thin wall is nothing else.
  drawSection(height) {
    const corners = this.meshes[0].faces.attributes.position.array, lines = [];
    this.section.visible = height !== undefined;
    for (let at = 0; height !== undefined && at < corners.length; at += 9) {
      for (let i = 0; i < 3; ++i) {
        const a = at + 3 * i, b = at + 3 * ((i + 1) % 3), share = (height - corners[a + 2]) / (corners[b + 2] - corners[a + 2]);
        if ((corners[a + 2] < height) === (corners[b + 2] < height)) continue;
        for (const axis of [0, 1]) lines.push(corners[a + axis] + share * (corners[b + axis] - corners[a + axis]));
        lines.push(height);
      }
    }
    this.section.geometry.dispose();
    this.section.geometry = new THREE.BufferGeometry();
    this.section.geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(lines), 3));
  }

  // Whether something opaque lies on a line of sight before it reaches a height.
  hides({ from, to }, height) {
    if (this.faceMaterial.opacity < 1) return false;
    const way = to.clone().sub(from), share = (height - from.z) / way.z, length = share * way.length();
    const caster = new THREE.Raycaster(from, way.normalize(), 0, length - 0.01);
    const faces = this.objects.filter((object) => object.visible).map((object) => object.children[0]);
    return caster.intersectObjects(faces).some((hit) => this.cutHeight === undefined || hit.point.z <= this.cutHeight);
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
