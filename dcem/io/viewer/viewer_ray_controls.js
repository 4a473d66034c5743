"use strict";
// What the page lets one choose of rays: mechanisms, colours, how many, of which links.

class RayControls {
  constructor(rays, redraw) {
    Object.assign(this, { rays, redraw, data: rays.data, moment: rays.moment });
    this.makeMechanisms();
    this.makeColours();
    this.makeAmount();
    this.makeLinks();
  }

  update() {
    this.rays.update();
    this.showCounts();
    this.redraw();
  }

  makeMechanisms() {
    const used = new Set(this.data.mechanism);
    $("rays_part").hidden = used.size === 0;
    this.counts = [];
    mechanisms.forEach(({ name, colour }, index) => {
      if (!used.has(index)) return;
      const label = make("label", undefined, $("mechanisms"), "row"), box = make("input", undefined, label);
      Object.assign(box, { type: "checkbox", checked: true, id: `mechanism_${index}` });
      box.addEventListener("input", () => { this.rays.shown[index] = box.checked; this.update(); });
      make("span", undefined, label, "swatch").style.background = colour;
      make("span", name, label);
      this.counts[index] = make("span", "", label, "count");
    });
  }

  makeColours() {
    for (const box of document.querySelectorAll("input[name=colour]")) {
      box.addEventListener("input", () => {
        this.rays.byPower = box.value === "power" && box.checked;
        $("power_scale").hidden = !this.rays.byPower;
        this.update();
      });
    }
    fillScale($("power_scale"), this.rays.head.viridis, this.rays.range, "received power of a path, dBm");
  }

  // 1, 2, 3, 4, 6, 8, 12 … and all.
  makeAmount() {
    this.steps = [1, 2];
    for (let step = 3; step < this.rays.most; step *= 2) this.steps.push(step, step / 3 * 4);
    this.steps = [...new Set([...this.steps, this.rays.most])].filter((step) => step <= this.rays.most).sort((a, b) => a - b);
    $("strongest").max = this.steps.length - 1;
    const choose = (index) => { this.rays.perLink = this.steps[index]; this.update(); };
    $("strongest").addEventListener("input", () => choose(Number($("strongest").value)));
    $("strongest_all").addEventListener("click", () => choose(this.steps.length - 1));
  }

  showCounts() {
    const { rays } = this, limit = rays.limit();
    this.counts.forEach((element, index) => setText(element, counted(rays.counts[index])));
    $("strongest").value = this.steps.filter((step) => step <= limit).length - 1;
    setText($("strongest_text"), `${limit} of ${rays.most}`);
    const more = rays.listed > rays.kept ? `; ${counted(rays.listed)} in the results` : "";
    setText($("ray_count"), `${counted(rays.drawn)} of ${counted(rays.kept)} paths${more}`);
  }

  makeLinks() {
    $("links_part").hidden = this.rays.linkKeys.length === 0;
    const show = (keys) => { this.rays.showOnly(keys); this.listLinks(); this.update(); };
    this.showOnly = show;
    $("links_all").addEventListener("click", () => show(this.rays.linkKeys));
    $("links_none").addEventListener("click", () => show([]));
    $("link_filter").addEventListener("input", () => this.listLinks());
    this.listLinks();
  }

  listLinks() {
    const most = 200, { rays, moment } = this, wanted = $("link_filter").value.toLowerCase();
    const matching = rays.linkKeys.filter((key) => moment.linkName(key).toLowerCase().includes(wanted));
    $("links").replaceChildren();
    for (const key of matching.slice(0, most)) this.listLink(key);
    this.showLinkCount(Math.min(matching.length, most));
  }

  listLink(key) {
    const { rays } = this, name = this.moment.linkName(key);
    const label = make("label", undefined, $("links"), "row"), box = make("input", undefined, label);
    Object.assign(box, { type: "checkbox", checked: !rays.hiddenLinks.has(key) });
    box.dataset.link = key;
    box.addEventListener("input", () => {
      if (box.checked) rays.hiddenLinks.delete(key); else rays.hiddenLinks.add(key);
      this.showLinkCount();
      this.update();
    });
    make("span", name, label, "label").title = name;
  }

  showLinkCount(listed = this.listed) {
    this.listed = listed;
    const all = this.rays.linkKeys.length, shown = all - this.rays.hiddenLinks.size;
    const list = listed < all ? `, ${counted(listed)} listed` : "";
    setText($("link_count"), `${counted(shown)} of ${counted(all)} shown${list}`);
  }
}
