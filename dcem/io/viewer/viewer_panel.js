"use strict";
// The panel of what is chosen: a device and its links, or a ray and what it meets.

const kindWords = { R: "reflected", T: "transmitted", D: "diffracted", S: "scattered" };

class Panel {
  // `showLinks(keys)` shows the rays of these links alone; `mark(ray)` marks one, or none.
  constructor(moment, showLinks, mark) {
    Object.assign(this, { moment, data: moment.data, head: moment.head, showLinks, mark, chosen: null });
    $("close_chosen").addEventListener("click", () => this.choose(null));
    $("only_chosen").addEventListener("click", () => this.showLinks(this.chosenLinks()));
  }

  // { thing }, perhaps with the link that is looked at, or { link, path }, or null.
  choose(chosen) {
    this.chosen = chosen;
    this.show();
    if (chosen) $("chosen").scrollIntoView({ block: "nearest" });
  }

  get thing() { return this.chosen ? this.chosen.thing : undefined; }

  // A chosen path in the frame that is shown.
  ray() {
    if (!this.chosen || this.chosen.path === undefined) return undefined;
    const row = this.moment.rowOfLink(this.chosen.link);
    const ray = row === undefined ? undefined : this.moment.rayOfPath(row, this.chosen.path);
    return ray === undefined ? undefined : { row, ray };
  }

  chosenLinks() {
    if (this.thing === undefined) return [this.chosen.link];
    return this.rowsOfThing().map((row) => this.moment.linkKey(row));
  }

  show() {
    $("chosen").hidden = !this.chosen;
    const ray = this.ray();
    this.mark(ray);
    if (!this.chosen) return;
    for (const id of ["chosen_facts", "chosen_links", "chosen_touches"]) $(id).replaceChildren();
    if (this.thing !== undefined) this.showDevice(); else this.showRay(ray);
  }

  rowsOfThing() {
    const transmits = this.moment.isTransmitter(this.thing), ends = transmits ? this.data.link_tx : this.data.link_rx;
    const index = this.thing - (transmits ? this.moment.transmitterThing(0) : this.moment.receiverThing(0));
    return [...this.moment.rows()].filter((row) => ends[row] === index);
  }

  showDevice() {
    const { thing, moment, data } = this, transmits = moment.isTransmitter(thing), place = moment.place(thing);
    $("chosen_title").textContent = `${transmits ? "Transmitter" : "Receiver"} ${moment.thingName(thing)}`;
    const facts = [["position", place ? moment.coordinates(place) : "not there"]];
    if (transmits) facts.push(["power", fixed(this.head.transmitters[thing - data.bodyCount].power_dbm, 2, "dBm")]);
    makeFacts(facts, $("chosen_facts"));
    const strength = (row) => (Number.isFinite(data.link_power[row]) ? data.link_power[row] : -1e9);
    const rows = this.rowsOfThing().sort((a, b) => strength(b) - strength(a));
    setText($("only_chosen"), "Only its links");
    $("only_chosen").hidden = rows.length === 0;
    const current = rows.find((row) => moment.linkKey(row) === this.chosen.link) ?? rows[0];
    this.showLinkTable(rows.slice(0, 200), current, transmits);
    this.showProfile(current);
  }

  showLinkTable(rows, current, transmits) {
    if (rows.length === 0) return;
    const table = make("table", undefined, $("chosen_links")), { data } = this;
    const titles = make("tr", undefined, table);
    const columns = [transmits ? "to" : "from", "power\ndBm", "delay spread\nns", "K\ndB", "paths"];
    for (const text of columns) make("th", text, titles);
    for (const row of rows) {
      const line = make("tr", undefined, table);
      line.dataset.row = row;
      if (row === current) line.className = "current";
      const other = transmits ? this.head.receivers[data.link_rx[row]] : this.head.transmitters[data.link_tx[row]].id;
      const values = [data.link_power[row], data.link_delay_spread[row], data.link_k_factor[row]];
      for (const text of [other, ...values.map((value) => fixed(value, 1, "")), String(data.link_paths[row])]) make("td", text, line);
      line.addEventListener("click", () => { this.chosen.link = this.moment.linkKey(row); this.show(); });
    }
  }

  showRay(found) {
    const { data, moment } = this, row = moment.rowOfLink(this.chosen.link);
    const [kinds, id] = this.head.paths[this.chosen.path];
    $("chosen_title").textContent = `Ray ${moment.linkName(this.chosen.link)}`;
    const words = kinds === "" ? "line of sight" : [...kinds].map((kind) => kindWords[kind]).join(", ");
    const more = found ? this.rayFacts(found) : [["in this frame", "not there"]];
    makeFacts([["path", id], ["kinds", words], ...more], $("chosen_facts"));
    if (found) this.showTouches(rayTouches(moment, found.row, found.ray));
    if (row !== undefined) {
      make("h3", "The link", $("chosen_links"));
      makeFacts([["power", fixed(data.link_power[row], 2, "dBm")],
        ["delay spread (rms)", fixed(data.link_delay_spread[row], 2, "ns")], ["K factor", fixed(data.link_k_factor[row], 2, "dB")]],
      $("chosen_links"));
    }
    setText($("only_chosen"), "Only this link");
    $("only_chosen").hidden = false;
    this.showProfile(row, found && found.ray);
  }

  rayFacts({ row, ray }) {
    const { data } = this, length = data.ray_length[ray], points = this.moment.rayPoints(row, ray);
    const facts = [["length", fixed(length, 2, "m")], ["delay", fixed(length / speedOfLight * 1e9, 2, "ns")],
      ["path gain", fixed(data.ray_gain[ray], 2, "dB")], ["received power", fixed(data.power[ray], 2, "dBm")],
      ["Doppler", fixed(data.ray_doppler[ray], 1, "Hz")]];
    if (points.length < 2) return facts;
    for (const [name, { azimuth, zenith }] of Object.entries(endAngles(points))) {
      facts.push([`${name} azimuth`, degrees(azimuth)], [`${name} zenith`, degrees(zenith)]);
    }
    return facts;
  }

  // One after the other, from the transmitter on.
  showTouches(touches) {
    touches.forEach((touch, index) => {
      const part = $("chosen_touches");
      make("h3", `${index + 1}. ${kindWords[touch.kind]} ${this.surfaceText(touch)}`, part);
      const facts = [["point", this.moment.coordinates(touch.point)]];
      if (touch.kind === "D") {
        facts.push(["angle to the edge", degrees(touch.toEdge)], ["about the edge, in", degrees(touch.incident)],
          ["about the edge, out", degrees(touch.diffracted)], ["open about the edge", degrees(touch.exterior)]);
      } else {
        facts.push(["incidence", degrees(touch.incidence)]);
        if (touch.kind === "S") facts.push(["scattered", degrees(touch.scattered)]);
      }
      makeFacts(facts, part);
    });
  }

  surfaceText({ kind, object, material }) {
    const where = object === "" ? "" : ` of ${object}`;
    return kind === "T" ? `through ${material}${where}` : `at ${kind === "D" ? "an edge of " : ""}${material}${where}`;
  }

  showProfile(row, accent) {
    const { data } = this;
    $("profile_part").hidden = row === undefined;
    if (row === undefined) return;
    const rays = [];
    for (let ray = data.rayStart[row]; ray < data.rayStart[row + 1]; ++ray) {
      if (Number.isFinite(data.power[ray])) rays.push(ray);
    }
    $("profile_title").textContent = `Power over delay, ${this.moment.linkName(this.moment.linkKey(row))}`;
    const total = data.link_listed[row], notes = [];
    if (data.link_rays[row] < total) notes.push(`The ${data.link_rays[row]} strongest of ${total} paths.`);
    if (Number.isFinite(data.link_diffuse[row])) notes.push(`Diffuse power in all: ${fixed(data.link_diffuse[row], 1, "dBm")}.`);
    $("profile_note").textContent = notes.join(" ");
    drawProfile($("profile"), rays.map((ray) => ({ delay: data.ray_length[ray] / speedOfLight * 1e9, power: data.power[ray],
      colour: mechanisms[data.mechanism[data.ray_path[ray]]].colour, accent: ray === accent,
      thin: data.mechanism[data.ray_path[ray]] === diffuse })));
  }
}
