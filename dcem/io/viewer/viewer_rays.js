"use strict";
// Which rays are drawn, in which colours; and the one that is chosen.

const mostLinksAtFirst = 40;

class Rays {
  constructor(scene, moment) {
    Object.assign(this, { moment, data: moment.data, head: moment.head, byPower: false, perLink: undefined, chosen: undefined });
    this.shown = mechanisms.map(() => true);
    this.range = powerRange(this.data.power);
    this.most = this.data.link_rays.reduce((most, count) => Math.max(most, count), 1);
    // What a wall hides of a ray shines through faintly.
    this.lines = new Segments(scene, [{ depth: THREE.GreaterDepth, opacity: 0.28, order: 2 },
                                      { depth: THREE.LessEqualDepth, opacity: 1, order: 3 }]);
    this.halo = new Segments(scene, [{ depth: THREE.AlwaysDepth, opacity: 1, order: 4 }]);
    this.accent = new Segments(scene, [{ depth: THREE.AlwaysDepth, opacity: 1, order: 5 }]);
    this.pickable = [];
    this.findLinks();
  }

  // All links of the run. Of many at a time, the strongest of the first frame are shown at first.
  findLinks() {
    const { data, moment } = this, powers = new Map();
    for (let row = 0; row < data.link_tx.length; ++row) {
      const key = moment.linkKey(row), isFirst = row < data.linkStart[1] && Number.isFinite(data.link_power[row]);
      if (!powers.has(key)) powers.set(key, isFirst ? data.link_power[row] : -1e9);
    }
    this.linkKeys = [...powers.keys()].sort((a, b) => a - b);
    this.linksAtATime = data.frame_links.reduce((most, count) => Math.max(most, count), 0);
    const byPower = [...this.linkKeys].sort((a, b) => powers.get(b) - powers.get(a) || a - b);
    this.hiddenLinks = new Set(this.linksAtATime > mostLinksAtFirst ? byPower.slice(mostLinksAtFirst) : []);
  }

  showOnly(keys) {
    const wanted = new Set(keys);
    this.hiddenLinks = new Set(this.linkKeys.filter((key) => !wanted.has(key)));
  }

  // So many of the strongest paths of each link: few of many links, unless somebody has chosen a number. More would
  // hide each other.
  limit() {
    if (this.perLink !== undefined) return this.perLink;
    const links = Math.max(Math.min(this.linkKeys.length - this.hiddenLinks.size, this.linksAtATime), 1);
    return Math.min(this.most, Math.max(1, Math.min(12, Math.floor(24 / links))));
  }

  colourOf(ray) {
    if (!this.byPower) return rgb(mechanisms[this.data.mechanism[this.data.ray_path[ray]]].colour);
    const power = this.data.power[ray];
    return colourOn(this.head.viridis, this.range, Number.isNaN(power) ? -Infinity : power).map((value) => value / 255);
  }

  update() {
    const { data } = this, limit = this.limit();
    const rows = [...this.moment.rows()].filter((row) => !this.hiddenLinks.has(this.moment.linkKey(row)));
    this.lines.clear();
    Object.assign(this, { pickable: [], counts: mechanisms.map(() => 0), drawn: 0, kept: 0, listed: 0 });
    for (const row of rows) {
      this.kept += data.link_rays[row];
      this.listed += data.link_listed[row];
    }
    const most = rows.reduce((ranks, row) => Math.max(ranks, data.link_rays[row]), 0);
    // The strongest of every link last, so that they lie on top.
    for (let rank = Math.min(most, limit) - 1; rank >= 0; --rank) {
      for (const row of rows) if (rank < data.link_rays[row]) this.add(row, data.rayStart[row] + rank);
    }
    this.lines.show();
    this.showAccent();
  }

  add(row, ray) {
    const mechanism = this.data.mechanism[this.data.ray_path[ray]];
    ++this.counts[mechanism];
    if (!this.shown[mechanism]) return;
    ++this.drawn;
    const points = this.moment.rayPoints(row, ray), tint = this.colourOf(ray);
    for (let i = 1; i < points.length; ++i) {
      this.lines.add(points[i - 1], points[i], tint);
      this.pickable.push({ row, ray });
    }
  }

  // `chosen` has a row and a ray, or is undefined.
  choose(chosen) {
    this.chosen = chosen;
    this.showAccent();
  }

  showAccent() {
    this.halo.clear();
    this.accent.clear();
    if (this.chosen) {
      const points = this.moment.rayPoints(this.chosen.row, this.chosen.ray), tint = this.colourOf(this.chosen.ray);
      for (let i = 1; i < points.length; ++i) {
        this.halo.add(points[i - 1], points[i], [0, 0, 0]);
        this.accent.add(points[i - 1], points[i], tint);
      }
    }
    this.halo.show();
    this.accent.show();
  }

  setSize(width, height, nearest, lineWidth) {
    this.lines.uniforms(width, height, nearest, lineWidth);
    this.accent.uniforms(width, height, nearest, lineWidth + 2);
    this.halo.uniforms(width, height, nearest, lineWidth + 5);
  }

  // Pixels from a place of the view to a piece of a ray; `project` gives the pixels of a point.
  distance(index, x, y, project) {
    const [a, b] = this.lines.ends(index).map(project);
    if (!a || !b) return Infinity;
    const dx = b.x - a.x, dy = b.y - a.y, square = dx * dx + dy * dy;
    const share = square > 0 ? Math.min(Math.max(((x - a.x) * dx + (y - a.y) * dy) / square, 0), 1) : 0;
    return Math.hypot(a.x + share * dx - x, a.y + share * dy - y);
  }
}
