"use strict";
(() => {
  const LEAST = 8, PAN = 0.5, PATIENCE = 20000;
  const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
  const SHADES = { "manual": ["--check", "M"], "at a limit": ["--outside", "L"], "missing": ["--failure", "X"] };
  const COLOURS = { sp: "--sp", pv: "--pv", op: "--op", position: "--soft" };

  const fresh = async (address) => {
    const answer = await fetch(address, { signal: AbortSignal.timeout(PATIENCE) });
    if (!answer.ok) throw new Error((await answer.text()).slice(0, 200) || answer.statusText);
    return answer;
  };

  class Drawn {  // by uPlot
    constructor(place) { this.place = place; this.plots = []; }
    draw(data) {
      const across = data.t.map((one) => (one - data.axis.from) / data.axis.scale);
      const wide = this.place.clientWidth;
      const groups = [["sp", "pv"], ["position", "op"]].map((names) => names.filter((name) => name in data));
      if (this.wide !== wide || this.dark !== css("--back")) { this.clear(); this.wide = wide; this.dark = css("--back"); }
      this.data = data;
      groups.forEach((names, place) => {
        const values = [across, ...names.map((name) => data[name])];
        if (this.plots[place]) this.update(this.plots[place], values, data);
        else this.plots[place] = this.make(names, values, data, wide, place);
      });
    }
    update(plot, values, data) {
      plot.batch(() => { plot.setData(values, false); this.ranges(plot, values, data); });
      plot.redraw(false, true);
    }
    title(plot, data) { if (plot.axes[0].label) plot.axes[0].label = data.axis.name; }
    ranges(plot, values, data) {
      this.title(plot, data);
      plot.setScale("x", { min: 0, max: this.length(data) });
      plot.setScale("y", this.extent(values));
    }
    length(data) { return (data.stop - data.start) * data.dt / data.axis.scale; }
    extent(values) {
      let low = Infinity, high = -Infinity;
      for (const series of values.slice(1)) for (const one of series) if (one !== null) { if (one < low) low = one; if (one > high) high = one; }
      if (!(low <= high)) [low, high] = [0, 1];
      const spare = 0.05 * (high - low) || 0.05 * Math.max(Math.abs(low), 1);
      return { min: low - spare, max: high + spare };
    }
    make(names, values, data, width, place) {
      const text = css("--soft"), grid = { stroke: css("--grid"), width: 1 }, font = "12px system-ui, sans-serif";
      const axis = { stroke: text, grid, ticks: grid, font, labelFont: font, labelSize: 20 };
      const plot = new uPlot({
        width, height: place ? 190 : 230, legend: { show: false }, cursor: { show: false }, select: { show: false },
        scales: { x: { time: false, auto: false }, y: { auto: false } },
        axes: [{ ...axis, size: place ? 50 : 26, ...(place ? { label: data.axis.name, labelSize: 18 } : {}) }, { ...axis, size: 62, label: names.map((name) => data.names[name]).reverse().join(", ") }],
        series: [{}, ...names.map((name) => ({ stroke: css(COLOURS[name]), width: 1.4, dash: name === "sp" ? [6, 4] : undefined, points: { show: false }, spanGaps: false }))],
        hooks: { drawAxes: [(made) => this.shade(made)] },
      }, values, this.place);
      plot.batch(() => this.ranges(plot, values, data));
      plot.root.setAttribute("aria-hidden", "true");
      return plot;
    }
    shade(plot) {
      const { axis, shaded, gaps } = this.data, ink = plot.ctx, { top, height } = plot.bbox;
      const at = (seconds) => clamp(plot.valToPos((seconds - axis.from) / axis.scale, "x", true), plot.bbox.left, plot.bbox.left + plot.bbox.width);
      ink.save();
      ink.textAlign = "center"; ink.textBaseline = "top"; ink.font = `bold ${12 * devicePixelRatio}px system-ui, sans-serif`;
      for (const [low, high, what] of shaded) {
        const [colour, letter] = SHADES[what], left = at(low), width = Math.max(at(high) - left, devicePixelRatio);
        ink.globalAlpha = 0.8; ink.fillStyle = css(colour); ink.fillRect(left, top, width, height);
        ink.globalAlpha = 1; ink.fillStyle = css("--text");
        if (width > 12 * devicePixelRatio) ink.fillText(letter, left + width / 2, top + 2);
      }
      ink.strokeStyle = css("--soft"); ink.setLineDash([1, 3]);
      for (const [where] of gaps) { ink.beginPath(); ink.moveTo(at(where), top); ink.lineTo(at(where), top + height); ink.stroke(); }
      ink.restore();
    }
    clear() { for (const plot of this.plots) plot.destroy(); this.plots = []; }
    ends() {
      const over = this.plots[0]?.over.getBoundingClientRect();
      return over ? [over.left, over.right] : null;
    }
  }

  class Fetched {  // SVG of the server
    constructor(place) { this.place = place; }
    draw() {}
    ends() {
      const svg = this.place.querySelector("svg.chart");
      if (!svg) return null;
      const box = svg.getBoundingClientRect(), style = getComputedStyle(svg);
      return [box.left + parseFloat(style.paddingLeft), box.right - parseFloat(style.paddingRight)];
    }
  }

  class Trend {
    constructor(root) {
      this.root = root;
      const kept = root.dataset;
      [this.start, this.stop, this.rows, this.dt] = [kept.start, kept.stop, kept.rows, kept.dt].map(Number);
      this.surface = root.querySelector("[data-surface]");
      this.said = root.querySelector("[data-cursor]");
      this.asked = 0;
      this.cursor = null;
      this.prepare();
      this.go(this.start, this.stop, { keep: true });
    }
    get charts() { return this.root.querySelector("[data-piece=charts]"); }
    prepare() {
      const { surface } = this;
      surface.classList.add("live");
      surface.tabIndex = 0;
      surface.setAttribute("role", "application");
      surface.setAttribute("aria-roledescription", "zoomable chart");
      surface.setAttribute("aria-label", "Trend. Left and right arrow move the cursor, plus and minus zoom, Page Up and Page Down move in time, Home shows all.");
      this.hair = this.layer("hair");
      this.box = this.layer("drag");
      const drawn = typeof uPlot === "function";
      if (drawn) {
        const plot = document.createElement("div");
        plot.className = "plot";
        surface.prepend(plot);
        this.picture = new Drawn(plot);
      } else this.picture = new Fetched(surface);
      this.byCanvas = drawn;
      surface.addEventListener("keydown", (event) => this.key(event));
      surface.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
      surface.addEventListener("pointerdown", (event) => this.down(event));
      surface.addEventListener("pointermove", (event) => this.move(event));
      surface.addEventListener("pointerup", (event) => this.up(event));
      surface.addEventListener("pointercancel", () => this.drop());
      for (const link of this.root.querySelectorAll("[data-step]")) {
        link.tabIndex = 0;
        link.addEventListener("click", (event) => { if (!event.ctrlKey && !event.metaKey && !event.shiftKey) { event.preventDefault(); this.step(link.dataset.step); } });
        link.addEventListener("keydown", (event) => { if (event.key === " ") { event.preventDefault(); this.step(link.dataset.step); } });
      }
      let timer;
      addEventListener("resize", () => { clearTimeout(timer); timer = setTimeout(() => this.again(), 150); });
      matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.again());
      addEventListener("popstate", () => location.reload());
    }
    layer(kind) {
      const made = document.createElement("div");
      made.className = kind;
      made.hidden = true;
      made.setAttribute("aria-hidden", "true");
      this.surface.append(made);
      return made;
    }
    again() { this.go(this.start, this.stop, { keep: true }); }

    row(event) {  // under the pointer
      const ends = this.picture.ends();
      return ends ? this.start + clamp((event.clientX - ends[0]) / (ends[1] - ends[0]), 0, 1) * (this.stop - this.start) : null;
    }
    pixel(row) {
      const ends = this.picture.ends();
      return ends ? ends[0] + (row - this.start) / (this.stop - this.start) * (ends[1] - ends[0]) - this.surface.getBoundingClientRect().left : 0;
    }
    step(name) {
      const length = this.stop - this.start, half = Math.floor(length / 2), at = this.cursor ?? this.start + half;
      if (name === "in") this.zoom(0.5, at);
      else if (name === "out") this.zoom(2, at);
      else if (name === "earlier") this.pan(-PAN);
      else if (name === "later") this.pan(PAN);
      else this.go(0, this.rows);
    }
    zoom(factor, about) {
      const length = this.stop - this.start, wide = clamp(Math.round(length * factor), Math.min(LEAST, this.rows), this.rows);
      const start = clamp(Math.round(about - (about - this.start) * wide / length), 0, this.rows - wide);
      this.go(start, start + wide);
    }
    pan(share) {
      const length = this.stop - this.start;
      const start = clamp(this.start + Math.round(share * length), 0, this.rows - length);
      this.go(start, start + length);
    }
    key(event) {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const acts = {
        "+": () => this.step("in"), "=": () => this.step("in"), "-": () => this.step("out"), Home: () => this.step("all"),
        PageUp: () => this.pan(-PAN), PageDown: () => this.pan(PAN), Escape: () => this.drop(),
        ArrowLeft: () => event.shiftKey ? this.pan(-PAN) : this.walk(-1), ArrowRight: () => event.shiftKey ? this.pan(PAN) : this.walk(1),
      };
      if (!(event.key in acts)) return;
      event.preventDefault();
      acts[event.key]();
    }
    wheel(event) {
      if (event.deltaX && Math.abs(event.deltaX) > Math.abs(event.deltaY)) { event.preventDefault(); this.pan(Math.sign(event.deltaX) * 0.1); return; }
      if (!event.ctrlKey && document.activeElement !== this.surface) return;  // the page scrolls until the chart is chosen
      event.preventDefault();
      const row = this.row(event);
      if (row !== null) this.zoom(event.deltaY > 0 ? 1.25 : 0.8, row);
    }
    down(event) {
      if (event.button !== 0 || event.pointerType === "touch") { this.show(this.row(event)); return; }
      this.surface.focus({ preventScroll: true });
      this.surface.setPointerCapture(event.pointerId);
      this.from = this.row(event);
    }
    move(event) {
      const row = this.row(event);
      if (row === null) return;
      this.show(row, false);
      if (this.from === undefined) return;
      const [left, right] = [this.from, row].sort((one, other) => one - other).map((one) => this.pixel(one));
      this.box.hidden = right - left < 4;
      this.box.style.left = `${left}px`;
      this.box.style.width = `${right - left}px`;
    }
    up(event) {
      const row = this.row(event), from = this.from, zooms = !this.box.hidden;
      this.drop();
      if (!zooms || row === null || from === undefined) return;
      const [low, high] = [from, row].sort((one, other) => one - other);
      const start = clamp(Math.floor(low), 0, this.rows - 1), wide = Math.max(Math.ceil(high) - start, Math.min(LEAST, this.rows));
      this.go(Math.min(start, this.rows - wide), Math.min(start, this.rows - wide) + wide);
    }
    drop() { this.from = undefined; this.box.hidden = true; }

    points() { return this.data ? this.data.t.length : 0; }
    place(row) {  // of the value drawn at a row
      const count = this.points();
      return clamp(Math.floor((row - this.start) / (this.stop - this.start) * count), 0, count - 1);
    }
    walk(way) {
      const count = this.points();
      if (!count) return;
      const place = this.cursor === null ? (way > 0 ? 0 : count - 1) : this.place(this.cursor) + way;
      if (place < 0 || place >= count) { this.pan(way * PAN); return; }
      this.show(this.start + (place + 0.5) / count * (this.stop - this.start));
    }
    show(row, loud = true) {
      if (row === null || !this.data) return;
      this.cursor = row;
      this.hair.hidden = false;
      this.hair.style.left = `${this.pixel(row)}px`;
      this.said.setAttribute("aria-live", loud ? "polite" : "off");
      this.said.replaceChildren(...this.words(this.place(row)));
    }
    words(place) {
      const { data } = this, seconds = data.t[place], digits = new Intl.NumberFormat(undefined, { maximumSignificantDigits: 5 });
      const parts = [document.createElement("b"), " "];
      parts[0].textContent = this.when(seconds);
      const pair = data.finest ? [place] : [place - place % 2, place - place % 2 + 1];
      for (const name of ["pv", "sp", "op", "position"]) {
        if (!(name in data)) continue;
        const known = pair.map((one) => data[name][one]).filter((one) => one !== null && one !== undefined);
        const low = Math.min(...known), high = Math.max(...known);
        const text = !known.length ? "missing" : low === high ? digits.format(low) : `${digits.format(low)} to ${digits.format(high)}`;
        parts.push(`${data.names[name]} ${text}; `);
      }
      const inside = [...new Set(data.shaded.filter(([low, high]) => low <= seconds && seconds < high).map(([, , what]) => what))];
      if (inside.length) parts.push(inside.join(", "));
      return parts;
    }
    when(seconds) {
      const { data } = this;
      if (!data.from) return `${new Intl.NumberFormat(undefined, { maximumFractionDigits: 3 }).format(seconds)} s`;
      let lost = 0;
      for (const [where, gone] of data.gaps) if (where <= seconds && gone !== null) lost += gone;
      const zoned = /(Z|[+-]\d\d:\d\d)$/.test(data.from);
      const moment = new Date(Date.parse(zoned ? data.from : `${data.from}Z`) + 1000 * (seconds - data.start * data.dt + lost));
      return `${moment.toISOString().slice(0, data.dt < 1 ? 23 : 19).replace("T", " ")}${zoned ? " UTC" : ""}`;
    }

    query(width) {
      return new URLSearchParams({ source: this.root.dataset.source, start: this.start, stop: this.stop, width });
    }
    async go(start, stop, { keep = false } = {}) {
      const began = performance.now(), number = ++this.asked;
      [this.start, this.stop] = [start, stop];
      const width = clamp(Math.round(this.surface.clientWidth - 80), 100, 2000);
      const query = this.query(width);
      try {
        const pieces = this.byCanvas ? null : this.pieces(query, number);
        pieces?.catch(() => {});  // told below, or with the failure of the other answer
        const answer = await fresh(`/api/v1/trend?${query}`);
        if (answer.status === 202) { setTimeout(() => this.again(), 1000); return; }
        const data = await answer.json();
        if (number !== this.asked) return;
        if (pieces) await pieces;
        if (number !== this.asked) return;
        this.data = data;
        this.picture.draw(data);
        if (this.byCanvas) this.charts.hidden = true;
        if (!keep) this.remember();
        this.mark();
        if (this.cursor !== null) this.cursor = clamp(this.cursor, start, stop);
        if (this.cursor !== null) this.show(this.cursor, false);
        this.root.dataset.start = start;
        this.root.dataset.stop = stop;
        this.root.dataset.milliseconds = Math.round(performance.now() - began);
        this.tell("");
        if (!pieces && !keep) this.later(query, number);
      } catch (error) {
        if (number === this.asked) this.tell(`The trend could not be fetched: ${error.name === "TypeError" ? "the page does not answer; start it again" : error.message}`);
      }
    }
    later(query, number) {
      clearTimeout(this.timer);
      this.timer = setTimeout(() => this.pieces(query, number).catch(() => {}), 120);
    }
    async pieces(query, number) {
      const text = await (await fresh(`/trend?part=1&${query}`)).text();
      if (number !== this.asked) return;
      const made = new DOMParser().parseFromString(text, "text/html");
      for (const piece of made.querySelectorAll("[data-piece]")) {
        const old = this.root.querySelector(`[data-piece=${piece.dataset.piece}]`);
        piece.hidden = piece.dataset.piece === "charts" && this.byCanvas;
        const opened = old.querySelector("details")?.open;
        if (opened) piece.querySelector("details").open = true;
        old.replaceWith(piece);
      }
    }
    remember() {
      const address = new URL(location.href);
      if (this.start === 0 && this.stop === this.rows) { address.searchParams.delete("start"); address.searchParams.delete("stop"); }
      else { address.searchParams.set("start", this.start); address.searchParams.set("stop", this.stop); }
      history.replaceState(null, "", address);
    }
    mark() {
      const all = this.start === 0 && this.stop === this.rows;
      const off = { in: this.stop - this.start <= LEAST, out: all, all, earlier: this.start === 0, later: this.stop === this.rows };
      for (const link of this.root.querySelectorAll("[data-step]")) {
        if (off[link.dataset.step]) link.setAttribute("aria-disabled", "true");
        else link.removeAttribute("aria-disabled");
      }
    }
    tell(text) {
      if (!this.told) {
        this.told = document.createElement("p");
        this.told.className = "warning said";
        this.told.setAttribute("role", "alert");
        this.surface.before(this.told);
      }
      this.told.textContent = text;
      this.told.hidden = !text;
    }
  }

  const wait = async (root) => {  // until the data of a loop are read
    try {
      const answer = await fetch(`/api/v1/trend/state?${new URLSearchParams({ source: root.dataset.source })}`);
      if (answer.ok && (await answer.json()).state === "reading") setTimeout(() => wait(root), 1000);
      else location.reload();
    } catch { root.querySelector("[role=status]").textContent = "The page does not answer; start it again."; }
  };
  const begin = () => {
    for (const root of document.querySelectorAll("[data-trend]")) {
      if (root.dataset.state === "ready") new Trend(root);
      else if (root.dataset.state === "reading") setTimeout(() => wait(root), 700);
    }
  };
  if (document.readyState === "loading") addEventListener("DOMContentLoaded", begin);
  else begin();
})();
