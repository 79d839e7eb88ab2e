// What pointer and keys do on the charts of a report: values at the cursor, zoom, legend, the row of a run, and one time
// cursor for the page.
//
// The script reads the drawing. A chart with panels is an <svg class="panels">; a panel has its area and its ranges in
// data- attributes, a curve is a path in thousandths of a unit of the page, a point has its place in data-at, and a
// number in data-entry joins curves, points and entries of the legend (drawing/panel.rs, drawing/scatter.rs). Without
// the script, and on paper, the page is complete. A library such as uPlot (50 kB) would draw on a canvas: it needs the
// data a second time, cannot be printed sharply or searched, and has other markers than the charts in the files.
//
// The time cursor of the page is the window event "gearbench:time" with the detail { seconds, source }. Charts over time
// have data-time, the seconds per unit of their abscissa.
(() => {
  "use strict";
  const NS = "http://www.w3.org/2000/svg";
  const UNIT = 10; // Units of the view box per unit of the page.
  const FINE = 1000; // Units of paths per unit of the page.
  const NEAR = 26; // Farthest point that a pointer chooses [units of the page].
  const ON_RAY = 5; // Farthest line that a place of a map is on [units of the page].
  const STEPS = 100; // Steps of keys over a map of values.
  const DRAG = 5; // Shortest way of a pointer that is a zoom [units of the page].
  const EVENT = "gearbench:time";
  const charts = [];

  const svgElement = (name, attributes, parent) => {
    const element = document.createElementNS(NS, name);
    for (const key in attributes) element.setAttribute(key, attributes[key]);
    if (parent) parent.append(element);
    return element;
  };
  const htmlElement = (name, className, parent) => {
    const element = document.createElement(name);
    element.className = className;
    if (parent) parent.append(element);
    return element;
  };
  const clamp = (x, low, high) => Math.min(Math.max(x, low), high);
  const numbers = (text) => (text || "").split(" ").map(Number);

  // ----- Numbers and axes, as numbers.rs and drawing/axis.rs write them -----

  const signed = (text) => text.replace("-", "\u2212");
  function significant(x, digits = 3) {
    if (!Number.isFinite(x)) return "\u2013";
    if (x === 0) return "0";
    const size = Math.abs(x);
    if (size >= 1e6 || size < 1e-4) return signed(x.toExponential(digits - 1).replace("e+", "e"));
    const [, exponent] = x.toExponential(digits - 1).split("e");
    return signed(x.toFixed(clamp(digits - 1 - Number(exponent), 0, 12)));
  }
  const raised = (n) => String(n).replace(/./g, (c) => (c === "-" ? "\u207b" : "\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079"[c]));
  function powerOfTen(x) {
    const [mantissa, exponent] = x.toExponential(3).split("e");
    const short = signed(String(Number(mantissa)));
    const power = "10" + raised(Number(exponent));
    return short === "1" ? power : short + "\u00b7" + power;
  }
  function niceStep(x) {
    const power = 10 ** Math.floor(Math.log10(x));
    return [1, 2, 5, 10].map((m) => m * power).find((step) => step >= x * (1 - 1e-9)) || 10 * power;
  }
  function ticksOf({ min, max, log }, most) {
    const ticks = [];
    if (log && max / min > 3) {
      const [low, high] = [Math.log10(min), Math.log10(max)];
      const mantissas = high - low < 2.2 ? [1, 2, 5] : [1];
      const every = Math.max(1, Math.ceil((high - low) / Math.max(1, most)));
      for (let e = Math.floor(low); e <= Math.ceil(high); e++) {
        if (e % every) continue;
        for (const m of mantissas) {
          const x = m * 10 ** e;
          if (x >= min * (1 - 1e-9) && x <= max * (1 + 1e-9)) ticks.push(x);
        }
      }
      return ticks;
    }
    let step = niceStep((max - min) / Math.max(1, most));
    if ((max - min) / step < 2.5) step = niceStep(0.4 * step);
    const last = Math.floor(max / step + 1e-6);
    for (let k = Math.ceil(min / step - 1e-6); k <= last && ticks.length < 100; k++) ticks.push(k * step);
    return ticks;
  }
  function tickLabel(x, ticks, log) {
    const step = Math.abs(ticks.length > 1 ? ticks[1] - ticks[0] : x);
    if (log && ticks.every((t) => t >= 0.999e-3 && t < 1.001e5)) return signed(String(Number(x.toPrecision(4))));
    if (log) return powerOfTen(x);
    if (Math.abs(x) < 1e-6 * step) return "0";
    if (Math.max(...ticks.map(Math.abs)) >= 1e6 || step < 1e-6) return powerOfTen(x);
    return signed(x.toFixed(clamp(-Math.floor(Math.log10(step)), 0, 9)));
  }
  const axisOf = (text) => {
    const [min, max, log] = text.split(" ");
    return { min: Number(min), max: Number(max), log: log === "log" };
  };
  // Value at a fraction of an axis.
  const valueAt = ({ min, max, log }, part) => (log ? min * (max / min) ** part : min + part * (max - min));
  const partOf = ({ min, max, log }, x) => (log ? Math.log(x / min) / Math.log(max / min) : (x - min) / (max - min));
  const nameAndUnit = (text) => {
    const found = /^(.*?)\s*\[([^\]]*)\]$/.exec(text || "");
    return found ? { name: found[1], unit: found[2] } : { name: text || "", unit: "" };
  };

  // ----- Reading of the drawing -----

  // The pieces of a path, in units of the page.
  function piecesOf(path) {
    const pieces = [];
    for (const [, x, y, steps] of path.getAttribute("d").matchAll(/M(-?\d+) (-?\d+)l([^M]*)/g)) {
      const xs = [x / FINE];
      const ys = [y / FINE];
      let [a, b] = [Number(x), Number(y)];
      const all = steps.match(/-?\d+/g) || [];
      for (let i = 0; i + 1 < all.length; i += 2) {
        a += Number(all[i]);
        b += Number(all[i + 1]);
        xs.push(a / FINE);
        ys.push(b / FINE);
      }
      pieces.push({ xs, ys });
    }
    return pieces;
  }
  // Ordinate of a curve at an abscissa, both in units of the page; undefined beside the curve.
  function ordinate(curve, x) {
    for (const { xs, ys } of curve.pieces) {
      const last = xs.length - 1;
      if (x < xs[0] - 1e-6 || x > xs[last] + 1e-6) continue;
      let [low, high] = [0, last];
      while (high - low > 1) {
        const middle = (low + high) >> 1;
        if (xs[middle] <= x) low = middle;
        else high = middle;
      }
      const span = xs[high] - xs[low];
      return span > 0 ? ys[low] + ((clamp(x, xs[low], xs[high]) - xs[low]) / span) * (ys[high] - ys[low]) : ys[low];
    }
    return undefined;
  }
  // Distance of a place from a line, both in units of the page.
  function distanceTo({ pieces }, x, y) {
    let least = Infinity;
    for (const { xs, ys } of pieces) {
      for (let i = 0; i + 1 < xs.length; i++) {
        const [dx, dy] = [xs[i + 1] - xs[i], ys[i + 1] - ys[i]];
        const square = dx * dx + dy * dy;
        const part = square > 0 ? clamp(((x - xs[i]) * dx + (y - ys[i]) * dy) / square, 0, 1) : 0;
        least = Math.min(least, Math.hypot(x - xs[i] - part * dx, y - ys[i] - part * dy));
      }
    }
    return least;
  }
  const place = (g) => {
    const [x, y] = numbers(g.dataset.at);
    return { g, x, y, run: g.dataset.run, text: g.querySelector("title") ? g.querySelector("title").textContent : "" };
  };

  class Panel {
    constructor(chart, g) {
      this.chart = chart;
      this.g = g;
      const [x0, y0, x1, y1] = numbers(g.dataset.area);
      Object.assign(this, { x0, y0, x1, y1, width: x1 - x0, height: y1 - y0 });
      this.x = axisOf(g.dataset.x);
      this.y = axisOf(g.dataset.y);
      this.title = g.dataset.title;
      this.xName = nameAndUnit(g.dataset.xName);
      this.yName = nameAndUnit(g.dataset.yName);
      this.isFixed = g.hasAttribute("data-fixed");
      this.axes = g.querySelector(":scope > .axes");
      this.notes = [...g.querySelectorAll(":scope > .notes")];
      this.labelled = [...this.axes.querySelectorAll("text")].some((t) => Number(t.getAttribute("y")) > y1 * UNIT);
      const lines = (name) => [...g.querySelectorAll(`:scope > .${name}`)].map((c) => {
        const path = c.querySelector(":scope > path");
        return {
          g: c,
          entry: c.dataset.entry,
          name: c.dataset.name,
          path,
          drawn: path && path.getAttribute("d"),
          pieces: path ? piecesOf(path) : [],
          along: [...c.querySelectorAll(":scope > .along")].map(place),
          points: [...c.querySelectorAll(":scope > .point")].map(place),
        };
      });
      this.curves = lines("curve");
      // Lines without values to be read: fronts, and limits, which are never out of sight.
      this.guides = lines("guide");
      this.limits = lines("limit");
      this.uprights = [...g.querySelectorAll(":scope > .upright")].map(place);
      this.bands = [...g.querySelectorAll(":scope > .band")];
      // Points without a line: each has a text of its own.
      this.points = [...g.querySelectorAll(":scope > .point")].map(place);
      for (const p of this.points) if (p.g.querySelector("title")) p.g.querySelector("title").remove();
      this.full = { x0: 0, x1: 1, y0: 0, y1: 1 };
      this.view = this.full;
      this.overlay = svgElement("g", { class: "overlay", transform: `scale(${UNIT})` }, g);
    }
    get isZoomed() {
      return this.view !== this.full;
    }
    // Range of an axis that is in view.
    visible(axis) {
      const v = this.view;
      const [a, b] = axis === this.x ? [v.x0, v.x1] : [v.y0, v.y1];
      return { min: valueAt(axis, a), max: valueAt(axis, b), log: axis.log };
    }
    // From the place in the whole drawing to the place in view, and back.
    seenX(x) {
      return this.x0 + (((x - this.x0) / this.width - this.view.x0) / (this.view.x1 - this.view.x0)) * this.width;
    }
    seenY(y) {
      return this.y1 - (((this.y1 - y) / this.height - this.view.y0) / (this.view.y1 - this.view.y0)) * this.height;
    }
    drawnX(x) {
      return this.x0 + (this.view.x0 + ((x - this.x0) / this.width) * (this.view.x1 - this.view.x0)) * this.width;
    }
    abscissa(drawn) {
      return valueAt(this.x, (drawn - this.x0) / this.width);
    }
    // What a drawing cannot distinguish from zero is zero.
    valueOf(drawn) {
      const value = valueAt(this.y, (this.y1 - drawn) / this.height);
      return Math.abs(value) < 1e-5 * Math.abs(this.y.max - this.y.min) && !this.y.log ? 0 : value;
    }
    holds(x, y) {
      return x >= this.x0 - 1 && x <= this.x1 + 1 && y >= this.y0 - 1 && y <= this.y1 + 1;
    }
    isHidden(entry) {
      return entry !== undefined && this.chart.hidden.has(entry);
    }
    shownCurves() {
      return this.curves.filter((c) => !this.isHidden(c.entry));
    }
    shownPoints() {
      return this.points.filter((p) => !this.isHidden(p.g.dataset.entry));
    }
    // Ordinates in view of all curves between two abscissae, as a range of fractions with a margin.
    fitted(a, b) {
      let [low, high] = [Infinity, -Infinity];
      const grow = (y) => {
        const part = (this.y1 - y) / this.height;
        low = Math.min(low, part);
        high = Math.max(high, part);
      };
      for (const curve of this.shownCurves()) {
        for (const { xs, ys } of curve.pieces) xs.forEach((x, i) => x >= a && x <= b && grow(ys[i]));
        for (const x of [a, b]) {
          const y = ordinate(curve, x);
          if (y !== undefined) grow(y);
        }
        for (const p of curve.points) if (p.x >= a && p.x <= b) grow(p.y);
      }
      if (!(high > low)) return [0, 1];
      const margin = 0.07 * (high - low);
      const fromZero = this.y.min === 0 && !this.y.log;
      return [fromZero ? 0 : Math.max(0, low - margin), Math.min(1, high + margin)];
    }
    // Shows a part of the abscissa, in fractions; of the ordinate what the curves have there, or a given part.
    zoom(a, b, y) {
      if (this.isFixed) return;
      a = clamp(a, 0, 1);
      b = clamp(b, 0, 1);
      if (b - a < 1e-4 || (a <= 0 && b >= 1 && !y)) {
        if (b - a >= 1e-4) this.reset();
        return;
      }
      const [y0, y1] = y || this.fitted(this.x0 + a * this.width, this.x0 + b * this.width);
      this.view = { x0: a, x1: b, y0, y1: Math.max(y1, y0 + 1e-4) };
      this.draw();
    }
    reset() {
      this.view = this.full;
      this.draw();
    }
    draw() {
      const zoomed = this.isZoomed;
      for (const note of this.notes) note.style.display = zoomed ? "none" : "";
      this.axes.style.display = zoomed ? "none" : "";
      if (this.zoomedAxes) this.zoomedAxes.remove();
      if (zoomed) this.drawAxes();
      const clip = zoomed ? `url(#${this.clip()})` : "";
      for (const mark of this.uprights) {
        const x = this.seenX(mark.x);
        this.move(mark, x - mark.x, x >= this.x0 - 0.5 && x <= this.x1 + 0.5 ? 0 : NaN);
      }
      for (const band of this.bands) {
        const scale = 1 / (this.view.x1 - this.view.x0);
        const shape = band.firstElementChild;
        if (zoomed) shape.setAttribute("transform", `translate(${UNIT * (this.seenX(0))} 0) scale(${scale} 1)`);
        else shape.removeAttribute("transform");
        if (clip) band.setAttribute("clip-path", clip);
        else band.removeAttribute("clip-path");
      }
      for (const limit of this.limits) this.drawLimit(limit);
      for (const curve of [...this.guides, ...this.curves]) {
        if (clip) curve.g.setAttribute("clip-path", clip);
        else curve.g.removeAttribute("clip-path");
        if (curve.path) curve.path.setAttribute("d", zoomed ? this.pathInView(curve) : curve.drawn);
        for (const mark of curve.along) {
          const y = ordinate(curve, this.drawnX(mark.x));
          this.move(mark, 0, y === undefined ? NaN : this.seenY(y) - mark.y);
        }
        for (const p of curve.points) this.move(p, this.seenX(p.x) - p.x, this.seenY(p.y) - p.y);
      }
      for (const p of this.points) {
        const [x, y] = [this.seenX(p.x), this.seenY(p.y)];
        this.move(p, x - p.x, this.holds(x, y) ? y - p.y : NaN);
      }
    }
    // A limit beyond the part in view stands at the edge, with an arrow in its name.
    drawLimit({ path, drawn, pieces, along }) {
      const y = pieces.length ? pieces[0].ys[0] : NaN;
      const seen = this.seenY(y);
      const at = clamp(seen, this.y0, this.y1);
      const arrow = seen < this.y0 - 0.5 ? "\u2191 " : seen > this.y1 + 0.5 ? "\u2193 " : "";
      if (path) {
        const [from, to, level] = [this.x0, this.x1, at].map((v) => Math.round(v * FINE));
        path.setAttribute("d", this.isZoomed ? `M${from} ${level}L${to} ${level}` : drawn);
      }
      for (const mark of along) {
        const text = mark.g.querySelector("text");
        if (!text) continue;
        if (mark.name === undefined) mark.name = text.textContent;
        text.textContent = arrow + mark.name;
        // Its name stays within the panel: below the line at the upper edge, above it elsewhere.
        const low = at - this.y0 < 20 ? 16 : 0;
        const own = Number(text.getAttribute("y")) / UNIT;
        this.move(mark, 0, at - mark.y + (own < mark.y ? low : at > this.y1 - 20 ? -16 : 0));
      }
    }
    move({ g }, dx, dy) {
      g.style.display = Number.isFinite(dy) ? "" : "none";
      if (!this.isZoomed) g.removeAttribute("transform");
      else if (Number.isFinite(dy)) g.setAttribute("transform", `translate(${(dx * UNIT).toFixed(1)} ${(dy * UNIT).toFixed(1)})`);
    }
    pathInView(curve) {
      const fine = (x) => Math.round(clamp(x, -1e5, 1e5) * FINE);
      const parts = [];
      for (const { xs, ys } of curve.pieces) {
        let open = false;
        xs.forEach((x, i) => {
          const before = i + 1 < xs.length && this.seenX(xs[i + 1]) < this.x0;
          const after = i > 0 && this.seenX(xs[i - 1]) > this.x1;
          if (before || after) return;
          parts.push(`${open ? "L" : "M"}${fine(this.seenX(x))} ${fine(this.seenY(ys[i]))}`);
          open = true;
        });
      }
      return parts.join("");
    }
    clip() {
      if (!this.clipId) {
        this.clipId = `${this.chart.id}-clip-${this.chart.panels.indexOf(this)}`;
        const clip = svgElement("clipPath", { id: this.clipId }, this.g);
        const [x, y, width, height] = [this.x0, this.y0, this.width, this.height].map((v) => v * UNIT);
        svgElement("rect", { x, y, width, height }, clip);
      }
      return this.clipId;
    }
    drawAxes() {
      const g = svgElement("g", { class: "axes", transform: `scale(${UNIT})` });
      this.axes.after(g);
      this.zoomedAxes = g;
      const [x, y] = [this.visible(this.x), this.visible(this.y)];
      const text = (x, y, anchor, label) => {
        svgElement("text", { x, y, dy: "0.5ex", "text-anchor": anchor, "font-size": 12.5, class: "tick" }, g).textContent = label;
      };
      const line = (x1, y1, x2, y2) => svgElement("line", { x1, y1, x2, y2, class: "grid" }, g);
      const across = ticksOf(x, Math.floor(this.width / 85));
      for (const t of across) {
        const at = this.x0 + partOf(x, t) * this.width;
        line(at, this.y0, at, this.y1);
        if (this.labelled) text(at, this.y1 + 12, "middle", tickLabel(t, across, x.log));
      }
      const up = ticksOf(y, Math.max(3, Math.floor(this.height / 38)));
      for (const t of up) {
        const at = this.y1 - partOf(y, t) * this.height;
        line(this.x0, at, this.x1, at);
        text(this.x0 - 7, at, "end", tickLabel(t, up, y.log));
      }
    }
    // Draws the cursor at an abscissa of the whole drawing and returns the values of all curves there.
    mark(drawn) {
      this.overlay.replaceChildren();
      const x = this.seenX(drawn);
      if (!(x >= this.x0 - 0.5 && x <= this.x1 + 0.5)) return [];
      svgElement("line", { x1: x, x2: x, y1: this.y0, y2: this.y1, class: "cursor" }, this.overlay);
      const read = [];
      for (const curve of this.shownCurves()) {
        let y = ordinate(curve, drawn);
        if (y === undefined && !curve.path) {
          const p = curve.points.find((p) => Math.abs(p.x - drawn) < 0.5);
          y = p && p.y;
        }
        if (y === undefined) continue;
        const shape = curve.path || curve.g.querySelector("[stroke],[fill]:not([fill=none])");
        const style = shape && getComputedStyle(shape);
        const colour = style ? (style.stroke !== "none" ? style.stroke : style.fill) : "currentColor";
        const seen = this.seenY(y);
        if (seen >= this.y0 - 1 && seen <= this.y1 + 1) {
          svgElement("circle", { cx: x, cy: seen, r: 3.6, fill: colour, class: "dot" }, this.overlay);
        }
        const entry = this.chart.labelOf(curve.entry) || this.title || this.yName.name;
        const label = [entry, curve.name].filter(Boolean).join(", ");
        const value = this.valueOf(y);
        // Points that stand on their curve, or coincide, are one value.
        const isKnown = (r) => r.label === label && Math.abs(r.value - value) <= 1e-3 * Math.abs(value);
        if (!read.some(isKnown)) read.push({ label, colour, value });
      }
      return read;
    }
  }

  class Chart {
    constructor(svg, number) {
      this.svg = svg;
      this.id = `chart-${number}`;
      this.seconds = svg.dataset.time ? Number(svg.dataset.time) : 0;
      this.figure = svg.closest("figure");
      this.hidden = new Set();
      this.panels = [...svg.querySelectorAll(".panel")].map((g) => new Panel(this, g));
      this.active = this.panels[0];
      this.at = undefined; // Abscissa of the cursor, in units of the axis.
      this.labels = {};
      this.prepare();
    }
    labelOf(entry) {
      return entry === undefined ? "" : this.labels[entry] || "";
    }
    prepare() {
      const { svg, figure } = this;
      const title = svg.querySelector(":scope > title");
      const name = title ? title.textContent : "";
      if (title) title.remove();
      svg.id = this.id;
      svg.setAttribute("role", "group");
      svg.setAttribute("aria-roledescription", "interactive chart");
      svg.setAttribute("aria-label", `${name}. Arrow keys move the cursor, plus and minus zoom, Home shows all.`);
      svg.setAttribute("tabindex", "0");
      for (const g of svg.querySelectorAll(".entry")) this.prepareEntry(g);
      this.readout = htmlElement("div", "readout", figure);
      this.readout.hidden = true;
      this.resetButton = htmlElement("button", "reset", figure);
      this.resetButton.type = "button";
      this.resetButton.textContent = "Show all";
      this.resetButton.hidden = true;
      this.resetButton.addEventListener("click", () => {
        this.reset();
        svg.focus({ preventScroll: true });
      });
      svg.addEventListener("pointermove", (e) => this.pointerMoved(e));
      svg.addEventListener("pointerdown", (e) => this.pointerPressed(e));
      svg.addEventListener("pointerup", (e) => this.pointerReleased(e));
      svg.addEventListener("pointercancel", () => this.endDrag());
      svg.addEventListener("pointerleave", () => this.drag || (this.readout.hidden = true));
      svg.addEventListener("dblclick", () => this.reset());
      svg.addEventListener("keydown", (e) => this.keyPressed(e));
      svg.addEventListener("blur", () => (this.readout.hidden = true));
    }
    prepareEntry(g) {
      const { entry } = g.dataset;
      const text = g.querySelector("text");
      this.labels[entry] = text ? text.textContent : "";
      const joined = [...this.svg.querySelectorAll(".curve, .point")].some((c) => c.dataset.entry === entry);
      if (!joined) return;
      const box = g.getBBox();
      const [x, y, width, height] = [box.x - 40, box.y - 20, box.width + 80, box.height + 40];
      g.prepend(svgElement("rect", { x, y, width, height, rx: 30, class: "hit" }));
      const set = { role: "button", tabindex: "0", "aria-pressed": "true", "aria-label": `${this.labels[entry]}: shown` };
      for (const key in set) g.setAttribute(key, set[key]);
      g.addEventListener("click", () => this.toggle(g));
      g.addEventListener("keydown", (e) => {
        if (e.key !== "Enter" && e.key !== " ") return;
        e.preventDefault();
        e.stopPropagation();
        this.toggle(g);
      });
    }
    toggle(g) {
      const { entry } = g.dataset;
      const hide = !this.hidden.has(entry);
      if (hide) this.hidden.add(entry);
      else this.hidden.delete(entry);
      g.setAttribute("aria-pressed", String(!hide));
      g.setAttribute("aria-label", `${this.labels[entry]}: ${hide ? "hidden" : "shown"}`);
      for (const c of this.svg.querySelectorAll(".curve, .guide, .panel > .point")) {
        if (c.dataset.entry === entry) c.classList.toggle("off", hide);
      }
      if (this.at !== undefined) this.show(this.at);
    }
    // Place of a pointer in units of the page.
    placeOf(event) {
      const m = this.svg.getScreenCTM();
      const p = new DOMPoint(event.clientX, event.clientY).matrixTransform(m.inverse());
      return { x: p.x / UNIT, y: p.y / UNIT };
    }
    panelAt({ x, y }) {
      return this.panels.find((p) => p.holds(x, y));
    }
    nearest(panel, { x, y }) {
      let best;
      for (const p of panel.shownPoints()) {
        const distance = Math.hypot(panel.seenX(p.x) - x, panel.seenY(p.y) - y);
        if (distance < NEAR && (!best || distance < best.distance)) best = { p, distance };
      }
      return best && best.p;
    }
    pointerMoved(event) {
      const at = this.placeOf(event);
      if (this.drag) {
        this.dragTo(at);
        return;
      }
      const panel = this.panelAt(at);
      if (!panel) {
        this.readout.hidden = true;
        return;
      }
      this.active = panel;
      if (panel.points.length) {
        const p = this.nearest(panel, at);
        if (p) this.choose(panel, p);
        else this.clear();
        return;
      }
      this.moveTo(this.snapped(panel, panel.drawnX(clamp(at.x, panel.x0, panel.x1))), true);
    }
    // Abscissa at a place of the whole drawing; curves with points of their own are read at these.
    snapped(panel, drawn) {
      const places = panel.shownCurves().flatMap((c) => c.points.map((p) => p.x));
      if (places.length) {
        drawn = places.reduce((best, x) => (Math.abs(x - drawn) < Math.abs(best - drawn) ? x : best));
      }
      return panel.abscissa(drawn);
    }
    // Moves the cursor, with the values next to it, and moves those of the other charts over time.
    moveTo(at, readout) {
      this.show(at, readout);
      if (this.seconds) {
        const detail = { seconds: at * this.seconds, source: this.id };
        window.dispatchEvent(new CustomEvent(EVENT, { detail }));
      }
    }
    show(at, readout = !this.readout.hidden) {
      this.at = at;
      let read = [];
      for (const panel of this.panels) {
        const drawn = panel.x0 + partOf(panel.x, at) * panel.width;
        const values = panel.points.length ? [] : panel.mark(drawn);
        if (panel === this.active) read = values;
      }
      if (readout) this.write(read);
    }
    // Writes the values of the active panel next to the cursor.
    write(read) {
      const panel = this.active;
      const { unit } = panel.yName;
      const axis = panel.visible(panel.x);
      const decimals = clamp(Math.ceil(-Math.log10((axis.max - axis.min) / 500)), 0, 12);
      const x = panel.x.log || panel.curves.some((c) => c.points.length) ? significant(this.at, 4) : signed(this.at.toFixed(decimals));
      const head = `${panel.xName.name || "x"} ${x}${panel.xName.unit ? "\u00a0" + panel.xName.unit : ""}`;
      const rows = read.map((r) => ({ ...r, text: `${significant(r.value)}${unit ? "\u00a0" + unit : ""}` }));
      this.fill(head, [panel.title, panel.yName.name].filter(Boolean).join(": "), rows);
      const drawn = panel.x0 + partOf(panel.x, this.at) * panel.width;
      this.put(panel.seenX(drawn), panel.y0 + 6);
    }
    fill(head, about, rows) {
      const { readout } = this;
      readout.replaceChildren();
      htmlElement("b", "", readout).textContent = head;
      if (about) htmlElement("span", "about", readout).textContent = about;
      for (const { label, colour, text } of rows) {
        const row = htmlElement("div", "value", readout);
        const swatch = htmlElement("i", "", row);
        swatch.style.background = colour;
        htmlElement("span", "", row).textContent = label;
        htmlElement("output", "", row).textContent = text;
      }
      readout.hidden = false;
      this.spoken = [head, ...rows.map((r) => `${r.label} ${r.text}`)].join(", ");
    }
    // Puts the values beside a place on the page, on the side with more room.
    put(x, y) {
      const box = this.svg.getBoundingClientRect();
      const frame = this.figure.getBoundingClientRect();
      const scale = box.width / (this.svg.viewBox.baseVal.width / UNIT);
      const left = box.left - frame.left + x * scale;
      const pan = this.svg.parentElement.getBoundingClientRect();
      const [from, to] = [pan.left - frame.left, pan.right - frame.left];
      const { offsetWidth } = this.readout;
      const side = left - from > to - left ? left - offsetWidth - 14 : left + 14;
      this.readout.style.left = `${clamp(side, from, Math.max(from, to - offsetWidth))}px`;
      this.readout.style.top = `${box.top - frame.top + y * scale}px`;
    }
    clear() {
      this.readout.hidden = true;
      for (const panel of this.panels) panel.overlay.replaceChildren();
    }
    // Marks a point and writes its text.
    choose(panel, p) {
      this.chosen = p;
      panel.overlay.replaceChildren();
      const [x, y] = [panel.seenX(p.x), panel.seenY(p.y)];
      svgElement("circle", { cx: x, cy: y, r: 9, class: "ring" }, panel.overlay);
      this.fill(p.text || this.labelOf(p.g.dataset.entry), p.run === undefined ? "" : "click or Enter: row of the run", []);
      this.put(x, y + 12);
    }
    showRow({ run }) {
      const row = run !== undefined && document.querySelector(`tr[data-run="${CSS.escape(run)}"]`);
      if (!row) return;
      for (const other of document.querySelectorAll("tr.chosen")) other.classList.remove("chosen");
      for (const same of document.querySelectorAll(`tr[data-run="${CSS.escape(run)}"]`)) same.classList.add("chosen");
      for (let d = row.closest("details"); d; d = d.parentElement.closest("details")) d.open = true;
      const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
      row.scrollIntoView({ block: "center", behavior: still ? "auto" : "smooth" });
    }

    // ----- Zoom -----

    pointerPressed(event) {
      const at = this.placeOf(event);
      const panel = this.panelAt(at);
      // A finger scrolls the page; it sets the cursor where it touches.
      if (event.button !== 0 || !panel || event.pointerType === "touch") return;
      this.drag = { panel, from: at, to: at };
      this.svg.setPointerCapture(event.pointerId);
    }
    dragTo(at) {
      const { panel, from } = this.drag;
      this.drag.to = { x: clamp(at.x, panel.x0, panel.x1), y: clamp(at.y, panel.y0, panel.y1) };
      this.readout.hidden = true;
      panel.overlay.replaceChildren();
      const { to } = this.drag;
      const both = panel.points.length > 0;
      const [x, width] = [Math.min(from.x, to.x), Math.abs(to.x - from.x)];
      const [y, height] = both ? [Math.min(from.y, to.y), Math.abs(to.y - from.y)] : [panel.y0, panel.height];
      svgElement("rect", { x, y, width, height, class: "range" }, panel.overlay);
    }
    endDrag() {
      const drag = this.drag;
      this.drag = undefined;
      if (drag) drag.panel.overlay.replaceChildren();
      return drag;
    }
    pointerReleased() {
      const drag = this.endDrag();
      if (!drag) return;
      const { panel, from, to } = drag;
      if (Math.abs(to.x - from.x) < DRAG) {
        const p = this.nearest(panel, from);
        if (p) {
          this.choose(panel, p);
          this.showRow(p);
        }
        return;
      }
      const part = (x) => (panel.drawnX(x) - panel.x0) / panel.width;
      const [a, b] = [part(from.x), part(to.x)].sort((p, q) => p - q);
      let y;
      if (panel.points.length && Math.abs(to.y - from.y) >= DRAG) {
        const { y0, y1 } = panel.view;
        const up = (y) => y0 + ((panel.y1 - y) / panel.height) * (y1 - y0);
        y = [up(from.y), up(to.y)].sort((p, q) => p - q);
      } else if (panel.points.length) {
        y = [panel.view.y0, panel.view.y1];
      }
      this.zoom(panel, a, b, y);
    }
    // Panels over one abscissa show one part of it.
    zoom(panel, a, b, y) {
      for (const p of this.panels) if (p.g.dataset.x === panel.g.dataset.x) p.zoom(a, b, p === panel ? y : undefined);
      this.zoomed();
    }
    reset() {
      for (const panel of this.panels) panel.reset();
      this.zoomed();
    }
    zoomed() {
      this.resetButton.hidden = !this.panels.some((p) => p.isZoomed);
      this.placeReset();
      if (this.active && this.active.points.length) this.clear();
      else if (this.at !== undefined) this.show(this.at);
    }
    // Puts the button where a chart has no text: next to the name of the abscissa, on narrow pages in the line above the chart.
    placeReset() {
      const { resetButton: button, svg } = this;
      const pan = svg.parentElement;
      const below = matchMedia("(max-width: 760px)").matches ? -2 - button.offsetHeight : pan.offsetHeight - button.offsetHeight - 2;
      button.style.top = `${pan.offsetTop + below}px`;
      button.style.left = `${pan.offsetLeft + pan.offsetWidth - button.offsetWidth}px`;
    }
    zoomBy(factor) {
      const panel = this.active;
      const { x0, x1, y0, y1 } = panel.view;
      const scaled = (from, to, centre) => {
        const half = 0.5 * factor * (to - from);
        const middle = half < 0.5 ? clamp(centre, half, 1 - half) : 0.5;
        return [middle - half, middle + half];
      };
      if (panel.points.length) {
        const p = this.chosen;
        const x = p ? (p.x - panel.x0) / panel.width : 0.5 * (x0 + x1);
        const y = p ? (panel.y1 - p.y) / panel.height : 0.5 * (y0 + y1);
        const [across, up] = [scaled(x0, x1, x), scaled(y0, y1, y)];
        if (across[1] - across[0] >= 1) this.reset();
        else this.zoom(panel, ...across, up);
        if (p && this.holdsFocus()) this.choose(panel, p);
        return;
      }
      const centre = this.at === undefined ? 0.5 * (x0 + x1) : partOf(panel.x, this.at);
      this.zoom(panel, ...scaled(x0, x1, centre));
    }
    holdsFocus() {
      return document.activeElement === this.svg;
    }

    // ----- Keys -----

    keyPressed(event) {
      if (event.target !== this.svg || event.ctrlKey || event.metaKey || event.altKey) return;
      const step = event.shiftKey ? 10 : 1;
      const acts = {
        ArrowRight: () => this.stepBy(step),
        ArrowLeft: () => this.stepBy(-step),
        ArrowDown: () => this.nextPanel(1),
        ArrowUp: () => this.nextPanel(-1),
        "+": () => this.zoomBy(0.5),
        "=": () => this.zoomBy(0.5),
        "-": () => this.zoomBy(2),
        Home: () => this.reset(),
        0: () => this.reset(),
        Escape: () => this.reset(),
        Enter: () => this.chosen && this.active.points.length && this.showRow(this.chosen),
      };
      const act = acts[event.key];
      if (!act) return;
      event.preventDefault();
      act();
      live.textContent = this.spoken || "";
    }
    stepBy(count) {
      const panel = this.active;
      if (panel.points.length) {
        const all = panel.shownPoints().sort((p, q) => p.x - q.x || p.y - q.y);
        if (!all.length) return;
        const now = all.indexOf(this.chosen);
        const next = now < 0 ? (count > 0 ? 0 : all.length - 1) : clamp(now + count, 0, all.length - 1);
        this.choose(panel, all[next]);
        return;
      }
      const { x0, x1 } = panel.view;
      let part = this.at === undefined ? NaN : partOf(panel.x, this.at);
      const places = panel.shownCurves().flatMap((c) => c.points.map((p) => p.x));
      if (places.length) {
        const all = [...new Set(places)].sort((a, b) => a - b);
        const drawn = panel.x0 + part * panel.width;
        let now = all.findIndex((x) => Math.abs(x - drawn) < 1e-3);
        if (now < 0) now = count > 0 ? -1 : all.length;
        this.moveTo(panel.abscissa(all[clamp(now + count, 0, all.length - 1)]), true);
        return;
      }
      if (!(part >= x0 && part <= x1)) part = count > 0 ? x0 - (x1 - x0) / 200 : x1 + (x1 - x0) / 200;
      part = clamp(part + (count * (x1 - x0)) / 200, x0, x1);
      this.moveTo(valueAt(panel.x, part), true);
    }
    nextPanel(count) {
      const now = this.panels.indexOf(this.active);
      this.active = this.panels[clamp(now + count, 0, this.panels.length - 1)];
      if (this.active.points.length) this.stepBy(1);
      else if (this.at !== undefined) this.show(this.at, true);
    }
  }

  // A map of cells: the text of the cell under the pointer, and the place between the axes of a map of values. Arrows
  // move over the cells of maps whose cells are elements in rows.
  class CellMap {
    constructor(svg, number) {
      this.svg = svg;
      this.figure = svg.closest("figure");
      this.texts = new Map();
      for (const title of svg.querySelectorAll(".cell > title, path > title")) {
        this.texts.set(title.parentElement, title.textContent);
        title.remove();
      }
      this.frames = [...svg.querySelectorAll(".map")].map((g) => {
        const [x0, y0, x1, y1] = numbers(g.dataset.area);
        const [x, y] = [axisOf(g.dataset.x), axisOf(g.dataset.y)];
        return { x0, y0, x1, y1, x, y, xName: nameAndUnit(g.dataset.xName), yName: nameAndUnit(g.dataset.yName) };
      });
      this.rows = [...svg.querySelectorAll(".row")].map((row) => [...row.querySelectorAll(".cell")]);
      // Lines over a map of values, such as orders and natural frequencies: the reasons for what is below them.
      this.rays = [...svg.querySelectorAll(".ray")].map((g) => {
        const path = g.querySelector("path");
        return { name: g.dataset.name, pieces: path ? piecesOf(path) : [] };
      });
      const title = svg.querySelector(":scope > title");
      const name = title ? title.textContent : "map";
      if (title) title.remove();
      svg.id = `map-${number}`;
      const moves = this.rows.length ? "over the cells" : "the cursor";
      svg.setAttribute("role", "group");
      svg.setAttribute("aria-roledescription", "interactive map");
      svg.setAttribute("aria-label", `${name}. Arrow keys move ${moves}.`);
      this.readout = htmlElement("div", "readout", this.figure);
      this.readout.hidden = true;
      this.overlay = svgElement("g", { class: "overlay" }, svg);
      svg.addEventListener("pointermove", (e) => this.pointerMoved(e));
      svg.addEventListener("pointerleave", () => this.clear());
      svg.addEventListener("blur", () => this.clear());
      if (!this.rows.length && !this.frames.length) return;
      svg.setAttribute("tabindex", "0");
      svg.addEventListener("keydown", (e) => this.keyPressed(e));
    }
    clear() {
      this.readout.hidden = true;
      this.overlay.replaceChildren();
    }
    pointerMoved(event) {
      // Lines, marks and names over the cells do not hide their texts.
      const below = document.elementsFromPoint(event.clientX, event.clientY).map((e) => e.closest(".cell") || e);
      const cell = below.find((e) => this.texts.has(e)) || event.target;
      const m = this.svg.getScreenCTM();
      const p = new DOMPoint(event.clientX, event.clientY).matrixTransform(m.inverse());
      const [x, y] = [p.x / UNIT, p.y / UNIT];
      const frame = this.frames.find((f) => x >= f.x0 && x <= f.x1 && y >= f.y0 && y <= f.y1);
      const text = this.texts.get(cell);
      if (frame) {
        if (text === undefined) this.clear();
        else this.point(frame, { x, y }, text, event.clientX, event.clientY);
        return;
      }
      if (text === undefined) this.clear();
      else this.show(cell, event.clientX, event.clientY);
    }
    // Marks a place between the axes of a map of values and writes value, place and the lines there.
    point(frame, { x, y }, text, clientX, clientY) {
      this.at = { frame, x, y };
      this.overlay.replaceChildren();
      const [x0, y0, x1, y1] = [frame.x0, frame.y0, frame.x1, frame.y1].map((v) => v * UNIT);
      svgElement("line", { x1: x * UNIT, x2: x * UNIT, y1: y0, y2: y1, class: "cross" }, this.overlay);
      svgElement("line", { x1: x0, x2: x1, y1: y * UNIT, y2: y * UNIT, class: "cross" }, this.overlay);
      const at = (axis, name, part) => `${name.name} ${significant(valueAt(axis, part))}${name.unit ? "\u00a0" + name.unit : ""}`;
      const place = [
        at(frame.x, frame.xName, (x - frame.x0) / (frame.x1 - frame.x0)),
        at(frame.y, frame.yName, (frame.y1 - y) / (frame.y1 - frame.y0)),
      ];
      const near = this.rays.filter((ray) => distanceTo(ray, x, y) < ON_RAY).map((ray) => ray.name);
      const why = near.length ? `; on ${near.join(" and ")}` : "";
      this.write(text, place.join(", ") + why, clientX, clientY);
    }
    // Text of the colour at a place, as the topmost cell there has it.
    textAt(x, y) {
      const p = new DOMPoint(x * UNIT, y * UNIT);
      for (const [path, text] of this.texts) if (path.isPointInFill && path.isPointInFill(p)) return text;
      return undefined;
    }
    // Moves the cursor of a map of values; beyond the edge of a map lies the one next to it.
    moveAt(step, size) {
      let { frame, x, y } = this.at || {};
      if (!frame) {
        frame = this.frames[0];
        [x, y] = [0.5 * (frame.x0 + frame.x1), 0.5 * (frame.y0 + frame.y1)];
      } else {
        x += (step[1] * size * (frame.x1 - frame.x0)) / STEPS;
        y -= (step[0] * size * (frame.y1 - frame.y0)) / STEPS;
        const next = this.frames[this.frames.indexOf(frame) + (y > frame.y1 ? 1 : y < frame.y0 ? -1 : 0)];
        if (next && next !== frame) {
          y = y > frame.y1 ? next.y0 : next.y1;
          frame = next;
        }
      }
      x = clamp(x, frame.x0 + 0.5, frame.x1 - 0.5);
      y = clamp(y, frame.y0 + 0.5, frame.y1 - 0.5);
      const text = this.textAt(x, y);
      const screen = new DOMPoint(x * UNIT, y * UNIT).matrixTransform(this.svg.getScreenCTM());
      this.point(frame, { x, y }, text === undefined ? "no value" : text, screen.x, screen.y);
    }
    // Marks a cell and writes its text: the values, then label and reason.
    show(cell, clientX, clientY) {
      const box = cell.getBBox();
      this.overlay.replaceChildren();
      svgElement("rect", { x: box.x, y: box.y, width: box.width, height: box.height, class: "frame" }, this.overlay);
      const screen = cell.getBoundingClientRect();
      const parts = (this.texts.get(cell) || "").split(": ");
      const head = parts.length > 2 ? parts.slice(2).join(": ") : parts.join(": ");
      const about = parts.length > 2 ? parts.slice(0, 2).join(": ") : "";
      this.cell = cell;
      this.write(head, about, clientX === undefined ? screen.right : clientX, clientY === undefined ? screen.bottom : clientY);
    }
    write(head, about, clientX, clientY) {
      const { readout } = this;
      readout.replaceChildren();
      htmlElement("b", "", readout).textContent = head;
      if (about) htmlElement("span", "about", readout).textContent = about;
      readout.hidden = false;
      const frame = this.figure.getBoundingClientRect();
      const pan = this.svg.parentElement.getBoundingClientRect();
      const left = clientX - frame.left;
      const side = clientX - pan.left > pan.right - clientX ? left - readout.offsetWidth - 14 : left + 14;
      const end = Math.max(pan.left - frame.left, pan.right - frame.left - readout.offsetWidth);
      readout.style.left = `${clamp(side, pan.left - frame.left, end)}px`;
      readout.style.top = `${clientY - frame.top + 16}px`;
      this.spoken = `${head}. ${about}`;
    }
    keyPressed(event) {
      const steps = { ArrowRight: [0, 1], ArrowLeft: [0, -1], ArrowUp: [1, 0], ArrowDown: [-1, 0] };
      const step = steps[event.key];
      if (event.key === "Escape") this.clear();
      if (!step || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      if (!this.rows.length) {
        this.moveAt(step, event.shiftKey ? 10 : 1);
        live.textContent = this.spoken;
        return;
      }
      let row = this.rows.findIndex((r) => r.includes(this.cell));
      let column = row < 0 ? -1 : this.rows[row].indexOf(this.cell);
      if (row < 0) [row, column] = [0, 0];
      else {
        // Rows are drawn from below; those of an overview from above.
        const upwards = this.rows.length > 1 && this.rows[0][0].getBBox().y > this.rows[1][0].getBBox().y;
        row = clamp(row + (upwards ? step[0] : -step[0]), 0, this.rows.length - 1);
        column = clamp(column + step[1], 0, this.rows[row].length - 1);
      }
      this.show(this.rows[row][column]);
      live.textContent = this.spoken;
    }
  }

  const live = htmlElement("div", "live", document.body);
  live.setAttribute("aria-live", "polite");
  document.querySelectorAll("svg.panels").forEach((svg) => {
    if (svg.querySelector(".panel") && svg.closest("figure")) charts.push(new Chart(svg, charts.length + 1));
  });
  let maps = 0;
  for (const svg of document.querySelectorAll("figure svg:not(.panels)")) {
    if (svg.querySelector(".cell, .map")) new CellMap(svg, (maps += 1));
  }
  window.addEventListener(EVENT, ({ detail }) => {
    for (const chart of charts) {
      if (chart.seconds && chart.id !== detail.source) chart.show(detail.seconds / chart.seconds, false);
    }
  });
  // Paper has every curve over its whole range.
  window.addEventListener("beforeprint", () => {
    for (const chart of charts) {
      chart.reset();
      chart.clear();
      for (const g of chart.svg.querySelectorAll('.entry[aria-pressed="false"]')) chart.toggle(g);
    }
  });
  // A box that scrolls takes the focus, so that keys move it.
  const setFocus = () => {
    for (const pan of document.querySelectorAll(".pan")) {
      const scrolls = pan.scrollWidth > pan.clientWidth + 1;
      const heading = pan.closest("section") && pan.closest("section").querySelector("h2");
      const name = heading ? heading.textContent : "table";
      for (const [key, value] of [["tabindex", "0"], ["role", "group"], ["aria-label", `${name}, moves sideways`]]) {
        if (scrolls) pan.setAttribute(key, value);
        else pan.removeAttribute(key);
      }
    }
  };
  setFocus();
  window.addEventListener("resize", () => {
    setFocus();
    for (const chart of charts) chart.placeReset();
  });
  document.addEventListener("toggle", setFocus, true);
  if (charts.length) {
    const hint = document.createElement("p");
    hint.className = "hint";
    hint.textContent =
      "Move the pointer over a chart for the values of its curves; drag to zoom, double-click to see all; click a name to hide its " +
      "curve, and a point for the row of its run. With keys: Tab to a chart, arrows, + and \u2212, Home.";
    charts[0].figure.append(hint);
  }
  document.documentElement.classList.add("live-charts");
})();
