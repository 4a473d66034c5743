"use strict";
// The results in the frame that is shown. Things are bodies, then transmitters, then receivers; a row is a link in a frame.

const notThere = 0xffffffff;

class Moment {
  constructor(data) {
    Object.assign(this, { data, head: data.head, frame: 0 });
  }

  transmitterThing(index) { return this.data.bodyCount + index; }
  receiverThing(index) { return this.data.bodyCount + this.data.transmitterCount + index; }
  isTransmitter(thing) { return thing < this.receiverThing(0); }

  thingName(thing) {
    if (thing >= this.receiverThing(0)) return this.head.receivers[thing - this.receiverThing(0)];
    if (thing >= this.transmitterThing(0)) return this.head.transmitters[thing - this.transmitterThing(0)].id;
    const entry = poseEntry(this.data, thing, this.frame);
    return entry < 0 ? "" : this.head.names[this.data.pose_name[entry]] || "";
  }

  // Where a thing is; undefined where it is not there.
  place(thing) {
    const entry = poseEntry(this.data, thing, this.frame);
    if (entry < 0 || this.data.pose_name[entry] === notThere) return undefined;
    return Array.from(this.data.pose.subarray(6 * entry, 6 * entry + 3));
  }

  // How the object of a name (its number in `head.names`) is turned.
  turnOf(name) {
    const { data } = this;
    for (let body = 1; body < data.bodyCount; ++body) {
      const entry = poseEntry(data, body, this.frame);
      if (entry < 0 || data.pose_name[entry] !== name) continue;
      return new THREE.Euler(data.pose[6 * entry + 5], data.pose[6 * entry + 4], data.pose[6 * entry + 3], "ZYX");
    }
    return new THREE.Euler();
  }

  // Coordinates as the scenario has them.
  coordinates(place) {
    return `${place.map((value, i) => numberText(value + this.head.centre_m[i], 2)).join(", ")} m`;
  }

  *rows() {
    for (let row = this.data.linkStart[this.frame]; row < this.data.linkStart[this.frame + 1]; ++row) yield row;
  }

  linkKey(row) { return this.data.link_tx[row] * this.data.receiverCount + this.data.link_rx[row]; }

  linkName(key) {
    const receivers = this.data.receiverCount;
    return `${this.head.transmitters[Math.floor(key / receivers)].id} → ${this.head.receivers[key % receivers]}`;
  }

  rowOfLink(key) {
    for (const row of this.rows()) if (this.linkKey(row) === key) return row;
    return undefined;
  }

  // A path keeps its name from frame to frame.
  rayOfPath(row, path) {
    for (let ray = this.data.rayStart[row]; ray < this.data.rayStart[row + 1]; ++ray) {
      if (this.data.ray_path[ray] === path) return ray;
    }
    return undefined;
  }

  // All points of a ray, from transmitter to receiver; none where an end is not there.
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
}
