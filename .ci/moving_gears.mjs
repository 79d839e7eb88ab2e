// Checks of the viewer of moving gears for .ci/pages.mjs: motions of runs, and natural modes that swing.
import { readFileSync, statSync } from "node:fs";
import { join } from "node:path";
import assert from "node:assert/strict";

const settle = (page) => page.evaluate(() => new Promise((r) => requestAnimationFrame(() => requestAnimationFrame(() => r(0)))));
const pause = (ms) => new Promise((r) => setTimeout(r, ms));
const state = (page, key) => page.evaluate((k) => document.querySelector(".gears").gearbenchState[k], key);
const data = (page) => page.evaluate(() => JSON.parse(document.querySelector(".gears script").textContent));
const frames = async (page) => {
  await settle(page);
  return page.evaluate(() => [...document.querySelectorAll(".gears canvas:not([hidden])")].map((c) => c.toDataURL()));
};
const differ = (a, b) => a.length === b.length && a.every((x, i) => x !== b[i]);

/** Focuses an element by a selector, and presses keys. */
async function press(page, selector, ...keys) {
  if (selector) await page.evaluate((s) => document.querySelector(s).focus(), selector);
  for (const key of keys) await page.keyboard.press(key);
  await settle(page);
}

/** Moves the range to a part of its length. */
async function move(page, part) {
  await page.evaluate((x) => {
    const range = document.querySelector(".gears input[type=range]");
    range.value = 1000 * x;
    range.dispatchEvent(new Event("input", { bubbles: true }));
  }, part);
  await settle(page);
}

/** Plays by the space key on the button until the time has changed, and pauses by it. */
async function plays(page, name) {
  const [start, first] = [await state(page, "time"), await frames(page)];
  await press(page, ".gears button", "Space");
  for (let i = 0; i < 60 && (await state(page, "time")) === start; i += 1) await pause(50);
  await pause(150);
  const second = await frames(page);
  assert.notEqual(await state(page, "time"), start, `${name}: the space key on the button does not play`);
  assert.ok(differ(first, second), `${name}: two frames of a model are alike`);
  if (await state(page, "playing")) await press(page, ".gears button", "Space");
  assert.equal(await state(page, "playing"), false, `${name}: the space key does not pause`);
}

/** The range follows Play, back and next in the order of keys, and arrows move it. */
async function byKeys(page, name) {
  const before = await state(page, "time");
  await press(page, ".gears button", "Tab", "Tab", "Tab", "ArrowRight");
  assert.equal(await page.evaluate(() => document.activeElement.type), "range", name);
  assert.notEqual(await state(page, "time"), before, `${name}: arrows do not move the range`);
  // On a picture, keys move the view.
  const first = await frames(page);
  await page.evaluate(() => document.querySelector(".gears canvas:not([hidden])").focus());
  await press(page, null, "ArrowLeft", "+");
  assert.ok(differ(first, await frames(page)), `${name}: keys on the picture do not move the view`);
}

/** Both views, where there are two: each has more than a few colours. */
async function views(page, name) {
  const press = () => page.evaluate(() => {
    const change = [...document.querySelectorAll(".gears button")].find((b) => ["3D", "Section"].includes(b.textContent));
    if (change) change.click();
    return Boolean(change);
  });
  if (!(await press())) return;
  await settle(page);
  const colours = await page.evaluate(() => [...document.querySelectorAll(".gears canvas:not([hidden])")].map((c) => {
    const small = document.createElement("canvas");
    small.width = small.height = 64;
    const x = small.getContext("2d");
    x.drawImage(c, 0, 0, 64, 64);
    return new Set(new Uint32Array(x.getImageData(0, 0, 64, 64).data.buffer)).size;
  }));
  assert.ok(colours.every((n) => n > 8), `${name}: the other view has ${colours} colours`);
  await press();
  await settle(page);
}

/** The range dispatches the time of the page; an event of another source moves the viewer, which does not answer. */
async function oneTime(page, name) {
  await page.evaluate(() => {
    window.told = [];
    window.addEventListener("gearbench:time", (e) => window.told.push([e.detail.seconds, e.detail.source]));
  });
  await move(page, 0);
  const start = await state(page, "time");
  assert.deepEqual((await page.evaluate(() => window.told)).at(-1), [start, "gears"], name);
  await move(page, 0.3);
  const end = await state(page, "time");
  const [asked, found, answers] = await page.evaluate((t) => {
    window.told.length = 0;
    window.dispatchEvent(new CustomEvent("gearbench:time", { detail: { seconds: t, source: "test" } }));
    return [t, document.querySelector(".gears").gearbenchState.time, window.told.length];
  }, 0.5 * (start + end));
  assert.ok(asked === found && answers === 1, `${name}: ${asked} ${found} ${answers}`);
  await move(page, 0);
}

const legends = (page) => page.$$eval(".gears .panel > .load:last-child", (all) => all.map((e) => e.textContent));
const drawn = async (page) => (await legends(page)).map((text) => {
  const found = /^largest displacement (\S+) (\S*)m, drawn \u00d7 (\S+)$/.exec(text);
  assert.ok(found, text);
  return { size: Number(found[1]) * { "": 1, m: 1e-3, "\u00b5": 1e-6, n: 1e-9 }[found[2]], by: Number(found[3]) };
});

/** Modes: the list has those of the record, another one has another picture, the factor is said, and phases repeat. */
async function modes(page, folder, name) {
  const { models } = await data(page);
  assert.equal(await state(page, "time"), 0.25, `${name}: the viewer does not begin at the amplitude`);
  const record = JSON.parse(readFileSync(join(folder, "results.json"), "utf8"));
  for (const [i, model] of models.entries()) {
    const found = (record.vibrations || []).find((v) => v.label === model.label);
    const frequencies = found ? found.modes.map((m) => m.frequency_hz) : [record.mesh_modes.find((m) => m.label === model.label).frequency_hz];
    model.modes.forEach((mode, k) => {
      if (mode.is_rigid) return;
      const [, number, prefix] = /([\d.]+)[\s\u00a0]([kM]?)Hz/u.exec(mode.name);
      const read = Number(number) * { "": 1, k: 1e3, M: 1e6 }[prefix];
      assert.ok(Math.abs(read - frequencies[k]) <= 1e-3 * frequencies[k], `${name}: ${mode.name} is ${frequencies[k]} Hz in the record`);
    });
    if (model.modes.length < 2) continue;
    const list = (await page.$$(".gears .panel"))[i];
    const select = await list.$("select");
    assert.equal(await select.evaluate((s) => s.options.length), model.modes.length, name);
    const before = await frames(page);
    await select.focus();
    const chosen = await select.evaluate((s) => s.selectedIndex);
    await page.keyboard.press(chosen > 0 ? "ArrowUp" : "ArrowDown");
    assert.notEqual(await select.evaluate((s) => s.selectedIndex), chosen, `${name}: keys do not choose a mode`);
    assert.notEqual((await frames(page))[i], before[i], `${name}: another mode has the same picture`);
    await page.keyboard.press(chosen > 0 ? "ArrowDown" : "ArrowUp");
    assert.equal((await frames(page))[i], before[i], name);
  }
  const chosen = await page.evaluate(() => [...document.querySelectorAll(".gears .panel")].map((p) => (p.querySelector("select") || { value: 1 }).value - 1));
  const once = await drawn(page);
  once.forEach((d, i) => {
    const { largest_m: most } = models[i].modes[chosen[i]];
    assert.ok(Math.abs(d.size - most) <= 6e-3 * most, `${name}: ${d.size} ${most}`);
  });
  await page.select(".gears select[aria-label^=Amplitude]", "2");
  await settle(page);
  assert.deepEqual((await drawn(page)).map((d) => d.by), once.map((d) => 2 * d.by), name);
  await page.select(".gears select[aria-label^=Amplitude]", "1");
  // Back and next are steps of phase; at 0 and 180 degrees gears are at rest, at 90 and 270 degrees at opposite amplitudes.
  const at = {};
  for (const part of [0, 0.25, 0.5, 0.75]) {
    await move(page, part);
    at[part] = await frames(page);
  }
  assert.deepEqual(at[0], at[0.5], `${name}: rest`);
  assert.ok(differ(at[0], at[0.25]) && differ(at[0.25], at[0.75]), `${name}: amplitudes`);
  await page.evaluate(() => document.querySelector(".gears button[aria-label='Phase before']").click());
  assert.equal(await page.$eval(".gears .clock", (e) => new Promise((r) => requestAnimationFrame(() => requestAnimationFrame(() => r(e.textContent))))), "phase 255\u00b0");
  // Time cursors of charts are about something else.
  const time = await state(page, "time");
  await page.evaluate(() => window.dispatchEvent(new CustomEvent("gearbench:time", { detail: { seconds: 1, source: "test" } })));
  assert.equal(await state(page, "time"), time);
  // With reduced motion a mode swings for one period, otherwise on and on.
  await page.select(".gears select[aria-label=Speed]", "0.5");
  for (const [value, goesOn] of [["reduce", false], ["no-preference", true]]) {
    await page.emulateMediaFeatures([{ name: "prefers-reduced-motion", value }]);
    await press(page, ".gears button", "Space");
    let playing = true;
    for (let i = 0; i < 160 && playing; i += 1) {
      await pause(50);
      playing = await state(page, "playing");
      if (playing && goesOn && i > 40) break;
    }
    assert.equal(playing, goesOn, `${name}: reduced motion: ${value}`);
    if (playing) await press(page, ".gears button", "Space");
  }
  await move(page, 0.25);
}

/** Checks the viewer of a page; returns a word for the table of checks, or nothing where the page has none. */
export async function movingGears(page, { name, folder, file, out }) {
  if (!(await page.$(".gears .panel"))) {
    assert.equal(await page.$(".gears"), null, `${name}: a viewer without panels`);
    return null;
  }
  const { models, spatial, start_s } = await data(page);
  const isSwinging = models[0].modes.length > 0;
  assert.equal((await page.$$(".gears .panel")).length, models.length, name);
  assert.equal(await state(page, "playing"), false, `${name}: gears start to move by themselves`);
  const nameless = await page.evaluate(() => [...document.querySelectorAll(".gears button, .gears input, .gears select, .gears canvas")]
    .filter((e) => !(e.labels && e.labels.length) && !e.getAttribute("aria-label") && !e.textContent.trim()).length);
  assert.equal(nameless, 0, `${name}: controls without a label`);
  await page.evaluate(() => document.querySelector(".gears").scrollIntoView());
  if (isSwinging) await modes(page, folder, name);
  else await oneTime(page, name);
  await plays(page, name);
  await byKeys(page, name);
  await views(page, name);
  await page.evaluate(() => [...document.querySelectorAll(".gears button")].find((b) => b.textContent === "Reset view").click());
  if (isSwinging) await move(page, 0.25);
  else await page.evaluate((t) => window.dispatchEvent(new CustomEvent("gearbench:time", { detail: { seconds: t, source: "test" } })), start_s);
  const light = await frames(page);
  const picture = async (theme) => (await page.$(".gears")).screenshot({ path: join(out, `${name}-gears-${theme}.png`) });
  await picture("light");
  await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: "dark" }]);
  assert.ok(differ(light, await frames(page)), `${name}: a dark page has light pictures`);
  await picture("dark");
  await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: "light" }, { name: "prefers-reduced-motion", value: "reduce" }]);
  await page.emulateMediaType("print");
  const printed = await page.evaluate(() => [".gears", "figure.moving .pan"].map((s) => getComputedStyle(document.querySelector(s)).display));
  assert.deepEqual(printed, ["none", "block"], `${name}: paper has no still picture`);
  await page.emulateMediaType(null);
  const [bytes, most] = [statSync(file).size, spatial ? 4e6 : 2e6];
  assert.ok(bytes < most, `${name}: the page has ${bytes / 1e6} MB, at most ${most / 1e6} MB`);
  return isSwinging ? "modes in motion" : "moving gears";
}
