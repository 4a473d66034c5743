"use strict";
// What a ray meets, and under which angles (radians).

const vector = (array, at) => new THREE.Vector3().fromArray(array, at);

function legDirection(from, to) {
  return new THREE.Vector3().fromArray(to).sub(new THREE.Vector3().fromArray(from)).normalize();
}

const angleBetween = (a, b) => Math.acos(Math.min(Math.max(a.dot(b), -1), 1));

// Of a direction away from a device: azimuth from +x towards +y, 0 at the poles; zenith from +z.
function directionAngles(direction) {
  return { azimuth: Math.atan2(direction.y, direction.x), zenith: Math.acos(Math.min(Math.max(direction.z, -1), 1)) };
}

// Departure and arrival, both away from the device.
function endAngles(points) {
  const last = points.length - 1;
  return { departure: directionAngles(legDirection(points[0], points[1])),
           arrival: directionAngles(legDirection(points[last], points[last - 1])) };
}

// Azimuth about an edge of a direction away from it: 0 along face 0, counted through the exterior.
function aboutEdge(away, normal, edge) {
  const tangent = new THREE.Vector3().crossVectors(normal, edge);
  const angle = Math.atan2(away.dot(normal), away.dot(tangent));
  return angle < 0 ? angle + 2 * Math.PI : angle;
}

// Where a path meets a surface the angle from its normal, of a scattered one also the angle under which it leaves; at an
// edge the angle to it and the azimuths about it on both sides.
function touchAngles(kind, before, behind, normal, edge) {
  const slant = (direction) => angleBetween(direction, normal.dot(direction) < 0 ? normal.clone().negate() : normal);
  if (kind !== "D") return { incidence: slant(before), scattered: slant(behind) };
  const toEdge = angleBetween(before, edge);
  return { toEdge: Math.min(toEdge, Math.PI - toEdge), incident: aboutEdge(before.clone().negate(), normal, edge),
           diffracted: aboutEdge(behind, normal, edge) };
}

// The interactions of a ray, from transmitter to receiver.
function rayTouches(moment, row, ray) {
  const { data, head } = moment, points = moment.rayPoints(row, ray), path = data.ray_path[ray];
  if (points.length < 2) return [];
  return [...head.paths[path][0]].map((kind, i) => {
    const surface = data.path_surfaces[data.touchStart[path] + i], object = data.surface_object[surface];
    const turn = moment.turnOf(object);
    const normal = vector(data.surface_axes, 6 * surface).applyEuler(turn);
    const edge = vector(data.surface_axes, 6 * surface + 3).applyEuler(turn);
    const before = legDirection(points[i], points[i + 1]), behind = legDirection(points[i + 1], points[i + 2]);
    return { kind, object: head.names[object], material: head.materials[data.surface_material[surface]].name,
             point: points[i + 1], exterior: data.surface_exterior[surface] * Math.PI / 180,
             ...touchAngles(kind, before, behind, normal, edge) };
  });
}
