// Opens reports in a browser from file:// and checks what a reader does with them: values at the cursor against the
// record, zoom, legend, keys, one cursor for all histories, the row of a run, moving gears, narrow and dark pages, print, and
// the rules of axe. Usage: node pages.mjs TOOLS BROWSER OUT NAME=FOLDER ...; TOOLS has node_modules, OUT takes pictures.
import { createRequire } from "node:module";
import { readFileSync, writeFileSync, statSync, existsSync } from "node:fs";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import assert from "node:assert/strict";
import { movingGears } from "./moving_gears.mjs";

const [tools, executablePath, out, ...reports] = process.argv.slice(2);
const require = createRequire(join(resolve(tools), "package.json"));
const puppeteer = require("puppeteer-core");
const axe = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");

const browser = await puppeteer.launch({ executablePath, headless: true, args: ["--no-sandbox", "--hide-scrollbars", "--enable-unsafe-swiftshader"] });

// Opens a page and asserts that it writes no message and makes no request but for itself; a gallery shows charts of the
// reports below its folder.
async function open(file, { width, height, dark = false, gallery = false }) {
  const page = await browser.newPage();
  const noise = [];
  // The test reads pixels, which WebGL calls slow.
  page.on("console", (m) => m.text().includes("ReadPixels") || noise.push(`console: ${m.text()}`));
  page.on("pageerror", (e) => noise.push(`error: ${e}`));
  const address = pathToFileURL(file).href;
  const isChart = (url) => url.startsWith(new URL(".", address).href) && url.endsWith(".svg");
  page.on("request", (r) => r.url() === address || (gallery && isChart(r.url())) || noise.push(`request: ${r.url()}`));
  await page.setViewport({ width, height });
  await page.emulateMediaFeatures([
    { name: "prefers-color-scheme", value: dark ? "dark" : "light" },
    { name: "prefers-reduced-motion", value: "reduce" },
  ]);
  await page.goto(address, { waitUntil: "load" });
  return { page, quiet: () => assert.deepEqual(noise, [], file) };
}

// Elements that are wider than the page and in no box that scrolls.
const tooWide = (page) =>
  page.evaluate(() => {
    const wide = [];
    const width = document.documentElement.clientWidth;
    if (document.documentElement.scrollWidth > width) wide.push(`page ${document.documentElement.scrollWidth}`);
    for (const e of document.querySelectorAll("main *")) {
      if (e.closest("svg") && e.tagName !== "svg") continue;
      const box = e.getBoundingClientRect();
      if (box.width > 0 && box.right > width + 1 && !e.closest(".pan")) wide.push(`${e.tagName}.${e.className} ${box.right}`);
    }
    return wide;
  });

// The number of a text such as "−1.23 kN", in SI units, and half a unit of its last digit.
const PREFIXES = { G: 1e9, M: 1e6, k: 1e3, m: 1e-3, "µ": 1e-6, n: 1e-9, p: 1e-12 };
function measured(text) {
  const [, number, unit = ""] = /^(\S+)\s*(.*)$/u.exec(text.replaceAll("\u2212", "-").replaceAll("\u00a0", " "));
  const factor = unit.length > 1 && PREFIXES[unit[0]] && !unit.startsWith("rad") ? PREFIXES[unit[0]] : 1;
  const decimals = (number.split("e")[0].split(".")[1] || "").length - Number(number.split("e")[1] || 0);
  return { value: Number(number) * factor, half: 0.5 * 10 ** -decimals * factor };
}

// Value of a column of a series at a time.
function interpolated({ time_s }, values, t) {
  let k = time_s.findIndex((x) => x >= t);
  if (k < 0) k = time_s.length - 1;
  if (k === 0) return values[0];
  const part = (t - time_s[k - 1]) / (time_s[k] - time_s[k - 1]);
  return values[k - 1] + part * (values[k] - values[k - 1]);
}

// What is next to the cursor of a chart: its abscissa and the values of the curves by label.
const readout = (page, chart) =>
  page.evaluate((id) => {
    const box = document.getElementById(id).closest("figure").querySelector(".readout");
    if (box.hidden) return null;
    return {
      head: box.querySelector("b").textContent,
      values: Object.fromEntries([...box.querySelectorAll(".value")].map((v) => [v.querySelector("span").textContent, v.querySelector("output").textContent])),
    };
  }, chart);

// Place on the screen of a fraction of a panel.
const placeIn = (page, chart, panel, x, y) =>
  page.evaluate(
    (id, n, x, y) => {
      const svg = document.getElementById(id);
      svg.scrollIntoView({ block: "center" });
      const [x0, y0, x1, y1] = svg.querySelectorAll(".panel")[n].dataset.area.split(" ").map(Number);
      const seen = () => new DOMPoint(10 * (x0 + x * (x1 - x0)), 10 * (y0 + y * (y1 - y0))).matrixTransform(svg.getScreenCTM());
      // A chart of several meshes is higher than the screen.
      if (seen().y < 40 || seen().y > innerHeight - 40) scrollBy({ top: seen().y - 0.5 * innerHeight, behavior: "instant" });
      const at = seen();
      return { x: at.x, y: at.y };
    },
    chart, panel, x, y,
  );

// Texts of the ticks of the first panel of a chart that are in view.
const ticks = (page, chart) =>
  page.evaluate(
    (id) => [...document.getElementById(id).querySelectorAll(".panel .axes")]
      .filter((g) => g.style.display !== "none").flatMap((g) => [...g.querySelectorAll("text")].map((t) => t.textContent)),
    chart,
  );

const charts = (page) =>
  page.evaluate(() => [...document.querySelectorAll("svg.panels")].map((s) => ({
    id: s.id, time: s.dataset.time, name: s.getAttribute("aria-label"), curves: s.querySelectorAll(".curve").length,
    points: s.querySelectorAll(".panel > .point").length, entries: s.querySelectorAll(".entry[role=button]").length,
  })));

// Values of the charts of histories at some times against the histories of the record.
async function valuesAgainstRecord(page, folder) {
  const record = JSON.parse(readFileSync(join(folder, "results.json"), "utf8"));
  const all = [record, ...(record.further || [])].flatMap((r) => [...(r.references || []), ...r.runs]).flatMap((r) => [r.series, ...(r.further || [])]).filter((s) => s && s.time_s);
  const columns = { "contact force": /^contact_force.*_n$/ };
  let checked = 0;
  for (const chart of (await charts(page)).filter((c) => c.time && /^Contact force|^Angular/.test(c.name))) {
    for (const part of [0.13, 0.37, 0.5, 0.71]) {
      const at = await placeIn(page, chart.id, 0, part, 0.5);
      await page.mouse.move(at.x, at.y);
      const read = await readout(page, chart.id);
      assert.ok(read, `${chart.name}: no values at the cursor`);
      const place = await page.evaluate((id, part) => {
        const panel = document.getElementById(id).querySelector(".panel");
        const line = panel.querySelector(".cursor");
        const [x0, , x1] = panel.dataset.area.split(" ").map(Number);
        const [min, max] = panel.dataset.x.split(" ").map(Number);
        const [low, high] = panel.dataset.y.split(" ").map(Number);
        return { x: min + ((Number(line.getAttribute("x1")) - x0) / (x1 - x0)) * (max - min), range: high - low, unit: panel.dataset.yName };
      }, chart.id, part);
      const t = place.x * Number(chart.time);
      // A drawing has a resolution of a thousandth of a unit of the page.
      const drawn = 2e-5 * place.range * measured(`1 ${/\[([^\]]*)\]/.exec(place.unit)[1]}`).value;
      assert.ok(Math.abs(measured(read.head.replace(/^time /, "")).value - t) <= 0.01 * Math.abs(t) + 1e-9, `${read.head} ${t}`);
      const wanted = all.flatMap((s) => s.columns
        .filter((c) => (chart.name.startsWith("Contact") ? columns["contact force"].test(c.name) : /^speed_.*_rad_s$/.test(c.name)))
        .map((c) => interpolated(s, c.values, t)));
      for (const [label, text] of Object.entries(read.values)) {
        const { value, half } = measured(text);
        const scale = Math.max(...wanted.map(Math.abs));
        const nearest = wanted.reduce((a, b) => (Math.abs(b - value) < Math.abs(a - value) ? b : a));
        assert.ok(Math.abs(nearest - value) <= half + Math.max(1e-4 * scale, drawn), `${chart.name}, ${label} at ${t} s: ${text}, in the record ${nearest}`);
        checked += 1;
      }
    }
  }
  return checked;
}

async function histories(page, folder) {
  const checked = await valuesAgainstRecord(page, folder);
  assert.ok(checked >= 8, `${folder}: only ${checked} values were checked`);
  const all = await charts(page);
  const first = all.find((c) => c.time);
  // The cursor of every history is at the same time.
  const at = await placeIn(page, first.id, 0, 0.4, 0.5);
  await page.mouse.move(at.x, at.y);
  const times = await page.evaluate(() => [...document.querySelectorAll("svg.panels[data-time]")].flatMap((svg) =>
    [...svg.querySelectorAll(".panel")].flatMap((panel) => {
      const line = panel.querySelector(".cursor");
      if (!line) return [];
      const [x0, , x1] = panel.dataset.area.split(" ").map(Number);
      const [min, max] = panel.dataset.x.split(" ").map(Number);
      return (min + ((Number(line.getAttribute("x1")) - x0) / (x1 - x0)) * (max - min)) * Number(svg.dataset.time);
    })));
  assert.ok(times.length >= all.filter((c) => c.time).length, `${times.length} cursors`);
  assert.ok(times.every((t) => Math.abs(t - times[0]) < 1e-9 * Math.max(...times.map(Math.abs)) + 1e-15), String(times));
  // A time from elsewhere, such as a view of the gears, moves it; the charts do not answer.
  await page.evaluate((t) => {
    window.heard = 0;
    window.addEventListener("gearbench:time", () => (window.heard += 1));
    window.dispatchEvent(new CustomEvent("gearbench:time", { detail: { seconds: t, source: "test" } }));
  }, 0.5 * times[0]);
  const moved = await page.evaluate(() => {
    const svg = document.querySelector("svg.panels[data-time]");
    const panel = svg.querySelector(".panel");
    const [x0, , x1] = panel.dataset.area.split(" ").map(Number);
    const [min, max] = panel.dataset.x.split(" ").map(Number);
    return { t: (min + ((Number(panel.querySelector(".cursor").getAttribute("x1")) - x0) / (x1 - x0)) * (max - min)) * Number(svg.dataset.time), heard: window.heard };
  });
  assert.ok(Math.abs(moved.t - 0.5 * times[0]) < 1e-6 * times[0] && moved.heard === 1, JSON.stringify(moved));
  await zoom(page, first);
  await legend(page, first);
  await keys(page, first);
}

const curveData = (page, chart) =>
  page.evaluate((id) => [...document.getElementById(id).querySelectorAll(".curve > path")].map((p) => p.getAttribute("d")).join(), chart);

async function drag(page, chart, from, to) {
  const [a, b] = [await placeIn(page, chart, 0, ...from), await placeIn(page, chart, 0, ...to)];
  await page.mouse.move(a.x, a.y);
  await page.mouse.down();
  await page.mouse.move(0.5 * (a.x + b.x), b.y);
  await page.mouse.move(b.x, b.y);
  await page.mouse.up();
  return b;
}

// Texts of a chart and its heading below the button that shows all.
const underReset = (page, chart) =>
  page.evaluate((id) => {
    const figure = document.getElementById(id).closest("figure");
    const button = figure.querySelector(".reset").getBoundingClientRect();
    const texts = [...figure.querySelectorAll("svg text, figcaption"), ...figure.parentElement.querySelectorAll("h2")];
    const isBelow = (b) => b.width > 0 && b.left < button.right && b.right > button.left && b.top < button.bottom - 1 && b.bottom > button.top + 1;
    return button.width > 0 ? texts.filter((t) => isBelow(t.getBoundingClientRect())).map((t) => t.textContent) : ["no button"];
  }, chart);

async function zoom(page, chart) {
  const whole = { ticks: await ticks(page, chart.id), data: await curveData(page, chart.id) };
  const end = await drag(page, chart.id, [0.3, 0.5], [0.4, 0.6]);
  const part = { ticks: await ticks(page, chart.id), data: await curveData(page, chart.id) };
  assert.notDeepEqual(part.ticks, whole.ticks, chart.name);
  assert.notEqual(part.data, whole.data, chart.name);
  assert.deepEqual(await underReset(page, chart.id), [], `${chart.name}: the button covers a text`);
  assert.ok(part.ticks.length >= 4 && part.ticks.length < 80 && part.ticks.every((t) => t.length < 10), String(part.ticks));
  assert.ok(!/NaN|Infinity/.test(part.data));
  await page.mouse.click(end.x, end.y, { count: 2 });
  assert.deepEqual({ ticks: await ticks(page, chart.id), data: await curveData(page, chart.id) }, whole, `${chart.name}: double click`);
}

async function legend(page, chart) {
  if (!chart.entries) return;
  const count = () => page.evaluate((id) => [...document.getElementById(id).querySelectorAll(".curve")].filter((c) => getComputedStyle(c).display !== "none").length, chart.id);
  const before = await count();
  const entry = await page.$(`#${chart.id} .entry[role=button]`);
  await page.evaluate((e) => e.focus(), entry);
  await page.keyboard.press("Enter");
  assert.ok((await count()) < before, `${chart.name}: the entry of the legend hides nothing`);
  assert.equal(await page.evaluate((e) => e.getAttribute("aria-pressed"), entry), "false");
  await page.keyboard.press(" ");
  assert.equal(await count(), before);
}

// Cursor, zoom and reset with keys alone.
async function keys(page, chart) {
  await page.evaluate((id) => document.getElementById(id).focus(), chart.id);
  const read = [];
  for (const key of ["ArrowRight", "ArrowRight", "ArrowLeft"]) {
    await page.keyboard.press(key);
    read.push((await readout(page, chart.id)).head);
  }
  assert.notEqual(read[0], read[1]);
  assert.equal(read[0], read[2]);
  const spoken = await page.evaluate(() => document.querySelector(".live").textContent);
  assert.ok(spoken.startsWith(read[2]), spoken);
  const whole = await ticks(page, chart.id);
  await page.keyboard.press("+");
  assert.notDeepEqual(await ticks(page, chart.id), whole);
  await page.keyboard.press("Home");
  assert.deepEqual(await ticks(page, chart.id), whole);
  await page.keyboard.press("+");
  await page.keyboard.press("-");
  assert.deepEqual(await ticks(page, chart.id), whole);
}

// A click on a point of error over cost, and Enter, show the row of the run.
async function rows(page) {
  const chart = (await charts(page)).find((c) => c.points > 0);
  assert.ok(chart, "no chart of points");
  const point = await page.evaluate((id) => {
    const svg = document.getElementById(id);
    const panel = svg.querySelector(".panel");
    const p = panel.querySelector(":scope > .point");
    const [x, y] = p.dataset.at.split(" ").map(Number);
    const [x0, y0, x1, y1] = panel.dataset.area.split(" ").map(Number);
    return { run: p.dataset.run, x: (x - x0) / (x1 - x0), y: (y - y0) / (y1 - y0) };
  }, chart.id);
  const at = await placeIn(page, chart.id, 0, point.x, point.y);
  await page.mouse.move(at.x, at.y);
  assert.match((await readout(page, chart.id)).head, / under .* in /);
  await page.mouse.click(at.x, at.y);
  const chosen = () => page.evaluate(() => {
    const row = document.querySelector("tr.chosen");
    if (!row) return null;
    const box = row.getBoundingClientRect();
    return { run: row.dataset.run, seen: box.top >= 0 && box.bottom <= innerHeight };
  });
  const clicked = await chosen();
  assert.ok(clicked && clicked.seen, JSON.stringify(clicked));
  await page.evaluate((id) => document.getElementById(id).focus({ preventScroll: true }), chart.id);
  await page.keyboard.press("ArrowLeft");
  await page.keyboard.press("Enter");
  assert.ok((await chosen()).seen);
}

// Cells of maps: label and reason of a stability map are those of the record, a map of values shows a range; arrows move.
async function maps(page, folder) {
  const all = await page.$$("svg[id^=map-]");
  const text = (svg) => svg.evaluate((s) => {
    const box = s.closest("figure").querySelector(".readout");
    return box.hidden ? null : { head: box.querySelector("b").textContent, about: (box.querySelector(".about") || {}).textContent || "" };
  });
  for (const svg of all) {
    const places = await svg.evaluate((s) => {
      s.scrollIntoView({ block: "center" });
      const cells = [...s.querySelectorAll(".row .cell")];
      if (cells.length) {
        return [0, Math.floor(cells.length / 2), cells.length - 1].map((i) => cells[i].getBoundingClientRect()).map((b) => [b.x + b.width / 2, b.y + b.height / 2]);
      }
      const [x0, y0, x1, y1] = s.querySelector(".map").dataset.area.split(" ").map(Number);
      const at = new DOMPoint(10 * (0.6 * x0 + 0.4 * x1), 10 * (0.3 * y0 + 0.7 * y1)).matrixTransform(s.getScreenCTM());
      return [[at.x, at.y]];
    });
    const isRows = places.length > 1;
    for (const [x, y] of places.filter(([, y]) => y > 0 && y < 900)) {
      await page.mouse.move(x, y);
      const shown = await text(svg);
      assert.ok(shown, `a map shows nothing at ${x}, ${y}`);
      if (!isRows) {
        assert.match(shown.head, /^(below|above|\S+ to) /);
        assert.match(shown.about, /^speed.*, (frequency|order)/);
        continue;
      }
      const record = JSON.parse(readFileSync(join(folder, "results.json"), "utf8"));
      const cells = record.maps.flatMap((m) => m.cells);
      const step = /(step|relative tolerance) (\S+(?:\s\S+)?)$/u.exec(shown.about.replaceAll("\u00a0", " "));
      assert.ok(step, shown.about);
      const { value } = measured(step[2]);
      const there = cells.filter((c) => Math.abs(c.at - value) < 0.006 * value);
      assert.ok(there.length, `${shown.about} is no column of the record`);
      assert.ok(there.some((c) => shown.head.startsWith(c.status) && (!c.message || shown.head.includes(c.message.replaceAll("`", "").slice(0, 20)))), shown.head);
    }
    if (!isRows) continue;
    await svg.evaluate((s) => s.focus());
    const read = [];
    for (const key of ["ArrowLeft", "ArrowLeft", "ArrowRight", "Escape"]) {
      await page.keyboard.press(key);
      read.push(JSON.stringify(await text(svg)));
    }
    assert.notEqual(read[0], read[1]);
    assert.equal(read[0], read[2]);
    assert.equal(read[3], "null");
  }
  return all.length;
}

// The finding, the chart of the force and the chart of the errors are on the first screen.
async function firstScreen(page) {
  const ends = await page.evaluate(() => {
    scrollTo(0, 0);
    const bottom = (e) => e.getBoundingClientRect().bottom;
    const plots = [...document.querySelectorAll(".first svg.panels")].slice(0, 2).map((svg) => {
      const panel = svg.querySelector(".panel");
      const y = Number(panel.dataset.area.split(" ")[3]);
      return new DOMPoint(0, 10 * y).matrixTransform(svg.getScreenCTM()).y;
    });
    return [bottom(document.querySelector(".answer")), ...plots];
  });
  assert.equal(ends.length, 3);
  assert.ok(ends.every((y) => y < 900), String(ends));
}

async function accessible(page, name) {
  // A function of the test, not a script of the page.
  const found = await page.evaluate(async (source) => {
    (0, eval)(source);
    const { violations } = await axe.run(document, { resultTypes: ["violations"] });
    return violations.filter((v) => ["serious", "critical"].includes(v.impact)).map((v) => `${v.id}: ${v.nodes.slice(0, 3).map((n) => `${n.target} ${n.failureSummary}`).join("; ")}`);
  }, axe);
  assert.deepEqual(found, [], name);
}

// On paper every curve is there over its whole range, whatever was zoomed and hidden.
async function printed(page, name) {
  const first = (await charts(page)).find((c) => c.curves > 0);
  if (first) {
    const whole = await curveData(page, first.id);
    await page.evaluate((id) => document.getElementById(id).focus(), first.id);
    await page.keyboard.press("+");
    const pdf = await page.pdf({ format: "A4" });
    writeFileSync(join(out, `${name}.pdf`), pdf);
    assert.ok(pdf.length > 10000 && Buffer.from(pdf.slice(0, 5)).toString() === "%PDF-");
    assert.equal(await curveData(page, first.id), whole, `${name}: print`);
    await page.emulateMediaType("print");
    const hidden = await page.evaluate(() => [...document.querySelectorAll(".curve")].filter((c) => getComputedStyle(c).display === "none").length);
    assert.equal(hidden, 0, name);
    await page.emulateMediaType(null);
  }
}

try {
  console.log("| report | page | first paint | script and style | curves | checks |\n|---|---|---|---|---|---|");
  for (const given of reports) {
    const [name, folder] = given.split("=");
    const file = existsSync(join(folder, "index.html")) ? join(folder, "index.html") : folder;
    const done = [];
    const gallery = name === "gallery";
    for (const [width, dark] of [[1300, false], [1300, true], [400, false], [400, true]]) {
      const { page, quiet } = await open(resolve(file), { width, height: 900, dark, gallery });
      await page.screenshot({ path: join(out, `${name}-${width}-${dark ? "dark" : "light"}.png`) });
      for (const chart of (await charts(page)).filter((c) => c.curves || c.points)) {
        await page.evaluate((id) => document.getElementById(id).focus({ preventScroll: true }), chart.id);
        for (const key of ["ArrowRight", "+"]) await page.keyboard.press(key);
        const isZoomed = await page.evaluate((id) => !document.getElementById(id).closest("figure").querySelector(".reset").hidden, chart.id);
        if (isZoomed) assert.deepEqual(await underReset(page, chart.id), [], `${name}, ${chart.name} at ${width} px: the button covers a text`);
        await page.keyboard.press("Home");
      }
      assert.deepEqual(await tooWide(page), [], `${name} at ${width} px`);
      await accessible(page, `${name} at ${width} px, ${dark ? "dark" : "light"}`);
      quiet();
      await page.close();
    }
    const { page, quiet } = await open(resolve(file), { width: 1300, height: 900, gallery });
    const paint = await page.evaluate(async () => {
      for (let i = 0; i < 40; i += 1) {
        const [entry] = performance.getEntriesByName("first-contentful-paint");
        if (entry) return entry.startTime;
        await new Promise((r) => setTimeout(r, 25));
      }
      return NaN;
    });
    const all = await charts(page);
    const mapped = await maps(page, folder);
    assert.ok(all.length + mapped > 0 || gallery || (await page.$(".gears .panel")), `${name} has nothing to touch`);
    if (mapped) done.push(`${mapped} maps`);
    for (const chart of all.filter((c) => c.curves && !c.time)) {
      await page.evaluate((id) => document.getElementById(id).focus(), chart.id);
      await page.keyboard.press("ArrowRight");
      assert.ok(await readout(page, chart.id), `${name}: ${chart.name} shows no values`);
      // Two curves of a panel never have one name.
      const labels = await page.$$eval(`figure:has(#${chart.id}) .readout .value > span`, (all) => all.map((s) => s.textContent));
      assert.equal(new Set(labels).size, labels.length, `${name}: ${chart.name}: ${labels}`);
    }
    if (name.startsWith("compare")) {
      await firstScreen(page);
      await histories(page, folder);
      await rows(page);
      done.push("values, zoom, legend, keys, cursor, rows");
    }
    const moving = await movingGears(page, { name, folder, file, out });
    if (moving) done.push(moving);
    done.push(...(await touched(page, folder)));
    await printed(page, name);
    quiet();
    await page.close();
    const size = statSync(file).size;
    const own = readFileSync(file, "utf8").match(/<(style|script)>[^]*?<\/\1>/g).reduce((n, t) => n + t.length, 0);
    const curves = all.reduce((n, c) => n + c.curves, 0);
    console.log(`| ${name} | ${Math.round(size / 1000)} kB | ${Math.round(paint)} ms | ${Math.round(own / 1000)} kB | ${curves} | ${["width, dark, axe, print", ...done].join(", ")} |`);
  }
} finally {
  await browser.close();
}

// What is left of a chart under pointer and keys: limits stay in sight while it is zoomed, points are read, maps of values
// move by keys and name the lines at their cursor, and scenes over each other have names and rows of their own. Returns
// the names of the checks that the page had something for.
async function touched(page, folder) {
  const done = [];
  const box = (id) => page.evaluate((id) => {
    const readout = document.getElementById(id).closest("figure").querySelector(".readout");
    if (readout.hidden) return null;
    return { head: readout.querySelector("b").textContent, about: (readout.querySelector(".about") || {}).textContent || "" };
  }, id);
  const focus = (id) => page.evaluate((id) => document.getElementById(id).focus(), id);

  // Limits: a line within each zoomed panel, with its name, at its value or at the edge next to it.
  const limited = await page.$$eval("svg.panels:has(.limit path)", (all) => all.map((s) => s.id));
  for (const id of limited) {
    const limits = () => page.evaluate((id) => [...document.getElementById(id).querySelectorAll(".panel")].flatMap((panel) => {
      const [, y0, , y1] = panel.dataset.area.split(" ").map(Number);
      return [...panel.querySelectorAll(":scope > .limit")].map((limit) => {
        const path = limit.querySelector("path");
        const at = Number(/^M-?\d+ (-?\d+)/.exec(path.getAttribute("d"))[1]) / 1000;
        const text = limit.querySelector("text");
        return { seen: getComputedStyle(path).display !== "none" && at >= y0 - 0.5 && at <= y1 + 0.5, at, text: text ? text.textContent : "" };
      });
    }), id);
    const before = await limits();
    await focus(id);
    for (const key of ["ArrowRight", "+", "+"]) await page.keyboard.press(key);
    const zoomed = await limits();
    assert.ok(zoomed.length > 0 && zoomed.every((l) => l.seen), `${folder}, ${id}: ${JSON.stringify(zoomed)}`);
    assert.ok(zoomed.every((l, i) => l.text.endsWith(before[i].text)), JSON.stringify(zoomed));
    await page.keyboard.press("Home");
    assert.deepEqual(await limits(), before);
  }
  if (limited.length) done.push(`${limited.length} charts with limits`);

  // Points: keys and pointer read the same text, and the zoom keeps the lines between them.
  const scattered = await page.$$eval("svg.panels:has(.panel > .point)", (all) => all.map((s) => s.id));
  for (const id of scattered) {
    await focus(id);
    await page.keyboard.press("ArrowRight");
    const first = await box(id);
    assert.match(first.head, /\d.* in \d|\d.*: .*\d/, `${id}: ${first.head}`);
    await page.keyboard.press("ArrowRight");
    const place = await page.evaluate((id) => {
      const svg = document.getElementById(id);
      svg.scrollIntoView({ block: "center" });
      const ring = svg.querySelector(".ring");
      const at = new DOMPoint(10 * ring.getAttribute("cx"), 10 * ring.getAttribute("cy")).matrixTransform(svg.getScreenCTM());
      return [at.x, at.y];
    }, id);
    const second = await box(id);
    await page.mouse.move(...place);
    assert.equal((await box(id)).head, second.head, `${folder}, ${id}`);
    const guides = () => page.$$eval(`#${id} .guide > path`, (all) => all.map((p) => p.getAttribute("d")).join());
    const whole = await guides();
    await focus(id);
    await page.keyboard.press("+");
    assert.ok(!whole || (await guides()) !== whole, `${id}: lines between points do not zoom`);
    await page.keyboard.press("Home");
    assert.equal(await guides(), whole);
  }
  if (scattered.length) done.push(`${scattered.length} charts of points`);

  // Maps of values: keys move a cursor, which names the order or the natural frequency that it is on.
  const valued = await page.$$eval("svg[id^=map-]:has(.map):not(:has(.row))", (all) => all.map((s) => s.id));
  let rays = 0;
  for (const id of valued) {
    await focus(id);
    await page.keyboard.press("ArrowRight");
    const first = await box(id);
    await page.keyboard.press("ArrowUp");
    const second = await box(id);
    assert.match(first.head, /^(below|above|\S+ to) /, first.head);
    assert.match(first.about, /^speed.*, (frequency|order)/);
    assert.notEqual(first.about, second.about);
    const spoken = await page.evaluate(() => document.querySelector(".live").textContent);
    assert.ok(spoken.startsWith(second.head), spoken);
    const named = await page.evaluate((id) => {
      const svg = document.getElementById(id);
      svg.scrollIntoView({ block: "center" });
      const [x0, y0, x1, y1] = svg.querySelector(".map").dataset.area.split(" ").map(Number);
      for (const ray of svg.querySelectorAll(".ray")) {
        const path = ray.querySelector("path");
        if (!path) continue;
        const p = path.getPointAtLength(0.5 * path.getTotalLength());
        const [x, y] = [p.x / 1000, p.y / 1000];
        if (x < x0 + 2 || x > x1 - 2 || y < y0 + 2 || y > y1 - 2) continue;
        const at = new DOMPoint(10 * x, 10 * y).matrixTransform(svg.getScreenCTM());
        return { name: ray.dataset.name, x: at.x, y: at.y };
      }
      return null;
    }, id);
    if (!named) continue;
    await page.mouse.move(named.x, named.y);
    const read = await box(id);
    assert.ok(read.about.includes("; on ") && read.about.includes(named.name), `${read.about}: ${named.name}`);
    rays += 1;
  }
  if (valued.length) {
    assert.ok(rays > 0, `${folder}: no line of a map was named`);
    done.push(`${valued.length} maps by keys`);
  }

  // Several scenes: names at all curves, values of each, rows of runs of the last scene.
  const record = existsSync(join(folder, "results.json")) ? JSON.parse(readFileSync(join(folder, "results.json"), "utf8")) : {};
  if (record.further) {
    const scenes = [record, ...record.further];
    const chart = (await charts(page)).find((c) => c.time);
    const panels = await page.$$eval(`#${chart.id} .panel`, (all) => all.length);
    let labels = [];
    for (let n = 0; n < panels; n += 1) {
      const at = await placeIn(page, chart.id, n, 0.5, 0.5);
      await page.mouse.move(at.x, at.y);
      const read = await readout(page, chart.id);
      if (read && Object.keys(read.values).length > labels.length) labels = Object.keys(read.values);
    }
    for (const { scene } of scenes) assert.ok(labels.some((l) => l.startsWith(`${scene}: `)), `${scene}: ${labels}`);
    const points = await page.$$eval(".panel > .point[data-run]", (all) => all.map((p) => Number(p.dataset.run)));
    const found = points.filter((run) => run >= record.runs.length);
    const rowed = await page.evaluate((run) => document.querySelectorAll(`tr[data-run="${run}"]`).length, found[0]);
    assert.ok(found.length > 0 && rowed > 0, `${points}`);
    done.push(`${scenes.length} scenes`);
  }
  return done;
}
