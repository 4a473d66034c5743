"use strict";
// Time: the bar below the scene, and the keys. A run of a single frame has none.

class Player {
  // `show(frame)` shows a frame; `changed()` is told when playing begins or ends.
  constructor(times, show, changed) {
    Object.assign(this, { times, show, changed, frame: 0, playing: false, clock: times[0] });
    $("time_bar").hidden = this.isStill;
    $("time_keys").hidden = this.isStill;
    $("slider").max = times.length - 1;
    $("slider").addEventListener("input", () => this.seek(Number($("slider").value)));
    $("play").addEventListener("click", () => this.play(!this.playing));
    $("speed").addEventListener("change", () => this.play(this.playing));
    window.addEventListener("keydown", (event) => this.key(event));
  }

  get isStill() { return this.times.length < 2; }
  get last() { return this.times.length - 1; }

  go(frame) {
    this.frame = Math.min(Math.max(frame, 0), this.last);
    $("slider").value = this.frame;
    this.show(this.frame);
  }

  seek(frame) {
    this.go(frame);
    this.clock = this.times[this.frame];
  }

  play(on) {
    this.playing = on && !this.isStill;
    if (this.playing && this.frame === this.last) this.go(0);
    this.lastTick = performance.now();
    this.clock = this.times[this.frame];
    $("play").textContent = this.playing ? "❚❚" : "▶";
    $("play").setAttribute("aria-label", this.playing ? "Pause" : "Play");
    this.changed();
  }

  tick(now) {
    if (!this.playing) return;
    const { times } = this, speed = Number($("speed").value);
    if (speed === 0) return this.go(this.frame === this.last ? 0 : this.frame + 1);
    this.clock += (now - this.lastTick) / 1000 * speed;
    this.lastTick = now;
    if (this.clock > times[this.last] + 0.5 * speed) this.clock = times[0];
    let frame = this.frame;
    while (frame > 0 && times[frame] > this.clock) --frame;
    while (frame < this.last && times[frame + 1] <= this.clock) ++frame;
    if (frame !== this.frame) this.go(frame);
  }

  key(event) {
    const tag = event.target.tagName, type = event.target.type;
    if (this.isStill || tag === "SELECT" || (tag === "INPUT" && type === "search")) return;
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const ownArrows = tag === "INPUT" && type === "range" && event.target.id !== "slider";
    const step = event.shiftKey ? 10 : 1;
    const actions = { " ": () => this.play(!this.playing), Home: () => this.seek(0), End: () => this.seek(this.last),
      ArrowRight: () => this.seek(this.frame + step), ArrowLeft: () => this.seek(this.frame - step) };
    if (!actions[event.key] || (ownArrows && event.key !== " ")) return;
    if (event.key === " " && (tag === "BUTTON" || type === "checkbox")) return;
    event.preventDefault();
    actions[event.key]();
  }
}
