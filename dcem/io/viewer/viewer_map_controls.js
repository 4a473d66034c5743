"use strict";
// What the page lets one choose of maps, what their colours mean, and the value under the pointer.

class MapControls {
  // `moved()` is told when a map elsewhere is chosen.
  constructor(maps, moment, redraw, moved) {
    Object.assign(this, { maps, moment, redraw, head: moment.head });
    $("map_part").hidden = this.head.maps.length === 0;
    const places = [...new Set(this.head.maps.map((map) => map.places))];
    for (const name of places) make("option", name, $("map_places")).value = name;
    $("map_places_row").hidden = places.length < 2;
    $("map_places").addEventListener("change", () => {
      this.listLayers();
      this.show();
      moved();
    });
    $("map_choice").addEventListener("change", () => this.show());
    if (places.length > 0) this.listLayers();
  }

  // The choice stays what it was where the other map has the same.
  listLayers() {
    const before = $("map_choice").length > 0 ? $("map_choice").value : undefined, places = $("map_places").value;
    const map = this.head.maps.find((one) => one.places === places);
    $("map_choice").replaceChildren();
    for (const layer of map.layers) make("option", this.maps.layerName(layer), $("map_choice")).value = this.keyOf(layer);
    make("option", "none", $("map_choice")).value = "";
    const options = [...$("map_choice").options].map((option) => option.value);
    $("map_choice").value = options.includes(before) ? before : options[0];
  }

  keyOf({ shows, tx }) { return tx === undefined ? shows : `${shows} ${tx}`; }

  // The chosen layer in the frame that is shown.
  show() {
    if (this.head.maps.length === 0) return;
    const wanted = $("map_choice").value;
    const map = this.head.maps.find((one) => one.frame === this.moment.frame && one.places === $("map_places").value);
    const layer = map && map.layers.find((one) => this.keyOf(one) === wanted);
    this.maps.show(layer && map, layer);
    this.explain(layer, wanted);
    this.redraw();
  }

  // Only what has changed: frames of one map have one scale.
  explain(layer, wanted) {
    if (layer && layer.shows === "best_server") this.fillLegend();
    const choice = `${$("map_places").value} ${wanted}`;
    if (this.explained === choice) return;
    this.explained = choice;
    $("map_legend").hidden = wanted !== "best_server";
    $("map_scale").hidden = wanted === "" || wanted === "best_server";
    $("map_note").hidden = wanted === "";
    const isList = this.maps.entry !== undefined && this.maps.isList(this.maps.entry);
    setText($("map_note"), isList ? "White: nothing arrives. The pointer shows values."
                                  : "Grey: inside an object. Not coloured: nothing arrives. The pointer shows values.");
    if (!layer || $("map_scale").hidden) return;
    const isPower = layer.shows === "power", ratio = layer.shows === "sinr" ? "SINR" : "SIR";
    fillScale($("map_scale"), this.head.viridis, isPower ? this.maps.range : sinrRange,
      isPower ? "received power (incoherent), dBm" : `${ratio} of the best server, dB`);
  }

  // Names of the servers, and how much of what is served is theirs.
  fillLegend() {
    const { maps } = this, counts = this.head.transmitters.map(() => 0);
    let served = 0;
    for (let i = 0; i < maps.size(maps.entry); ++i) {
      const server = maps.value(maps.layer, i);
      if (Number.isNaN(server)) continue;
      ++counts[server];
      ++served;
    }
    $("map_legend").replaceChildren();
    this.head.transmitters.forEach(({ id, colour }, index) => {
      const row = make("div", undefined, $("map_legend"), "row");
      make("span", undefined, row, "swatch block").style.background = colour;
      make("span", id, row, "label").title = id;
      make("span", served > 0 ? fixed(100 * counts[index] / served, 1, "%") : "–", row, "count");
    });
  }

  // The lines of the box at the pointer.
  lines(index) {
    const { layer } = this.maps, facts = this.maps.factsAt(index), place = this.moment.coordinates(facts.point);
    if (facts.obstructed) return [place, "inside an object"];
    if (Number.isNaN(facts.power)) return [place, "nothing arrives"];
    const name = this.head.transmitters[facts.tx].id, power = fixed(facts.power, 2, "dBm");
    if (layer.shows === "power") return [place, `${name}: ${power}`];
    if (layer.shows === "best_server") return [place, `best server: ${name}`, power];
    return [place, `${layer.shows === "sinr" ? "SINR" : "SIR"}: ${fixed(facts.shown, 2, "dB")}`, `${name}: ${power}`];
  }
}
