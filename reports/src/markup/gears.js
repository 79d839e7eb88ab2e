// The viewer of moving gears: reads the motions of the page, draws them in a plane (canvas) or in space (gears3d.js), with shafts and
// carriers (mechanism.js), and follows the time cursor of the page, the event "gearbench:time". Natural modes swing: the weight of
// the amplitude is the magnification times the sine of the phase, and their time is the phase in periods.
"use strict";
(() => {
  const SOURCE = "gears";
  const MAGNITUDES = [[1e9, "G"], [1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "\u00b5"], [1e-9, "n"]];

  /** Text of a quantity with three digits, of a round one without zeros at its end, and a prefix of its unit. */
  function quantity(x, unit, isRound = x === 0) {
    const size = Math.abs(x);
    const [factor, prefix] = size === 0 ? [1, ""]
      : MAGNITUDES.find(([f]) => size >= 0.9995 * f) || MAGNITUDES[MAGNITUDES.length - 1];
    const text = (x / factor).toPrecision(3);
    return `${isRound ? Number(text) : text} ${prefix}${unit}`;
  }

  /** Numbers of a quantised sequence: low + k step, k in little-endian integers in base64. */
  function numbers(q) {
    const text = atob(q.data);
    const bytes = Uint8Array.from(text, (c) => c.charCodeAt(0));
    const view = new DataView(bytes.buffer);
    const size = q.bits / 8;
    const out = new Float64Array(bytes.length / size);
    for (let i = 0; i < out.length; i += 1) {
      const k = size === 1 ? bytes[i] : size === 2 ? view.getUint16(2 * i, true) : view.getUint32(4 * i, true);
      out[i] = q.low + k * q.step;
    }
    return out;
  }

  const sums = (counts) => {
    const ends = [0];
    counts.forEach((n) => ends.push(ends[ends.length - 1] + n));
    return ends;
  };
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const mix = (a, b, w) => a + w * (b - a);

  /** One pitch of a toothed body: sections with their points. */
  function toothedBody(raw) {
    const all = numbers(raw.points_m);
    const stored = raw.is_prism ? 1 : raw.heights_m.length;
    const each = all.length / (2 * stored);
    const sections = raw.heights_m.map((z, i) => ({
      z,
      points: all.subarray(raw.is_prism ? 0 : 2 * each * i, raw.is_prism ? 2 * each : 2 * each * (i + 1)),
    }));
    let reach = 0;
    for (let i = 0; i < all.length; i += 2) reach = Math.max(reach, Math.hypot(all[i], all[i + 1]));
    return { ...raw, sections, each, reach, first_tooth: raw.first_tooth || 0 };
  }

  /** Weights of the displacements along both flanks at each point of a pitch: cubic between rows, held beyond them. */
  function flankWeights(body, rows) {
    const points = body.sections[0].points;
    const coordinate = (i) => (body.is_rack ? points[2 * i] : Math.hypot(points[2 * i], points[2 * i + 1]));
    const across = (i) => (body.is_rack ? points[2 * i + 1] : Math.atan2(points[2 * i + 1], points[2 * i]));
    const last = rows.length - 1;
    const sign = Math.sign(rows[last] - rows[0]);
    const middle = (body.each - 1) / 2;
    // Half width of the tip, over which the displacement passes from one flank to the other.
    let tip = 0;
    for (let i = 0; i < body.each; i += 1) {
      if (sign * (coordinate(i) - rows[last]) > -1e-7) tip = Math.max(tip, Math.abs(across(i)));
    }
    let foot = 0;
    for (let i = 0; i < body.each; i += 1) {
      if (sign * (coordinate(i) - rows[0]) > 1e-9) foot = Math.max(foot, Math.abs(across(i)));
    }
    const half = 0.5 * body.pitch;
    const out = [];
    for (let i = 0; i < body.each; i += 1) {
      const c = coordinate(i);
      let k = 0;
      while (k < last - 1 && sign * (c - rows[k + 1]) > 0) k += 1;
      const t = Math.min(1, Math.max(0, (c - rows[k]) / (rows[k + 1] - rows[k])));
      const at = [Math.max(0, k - 1), k, k + 1, Math.min(last, k + 2)];
      const w = [
        0.5 * t * (-1 + t * (2 - t)), 0.5 * (2 + t * t * (3 * t - 5)),
        0.5 * t * (1 + t * (4 - 3 * t)), 0.5 * t * t * (t - 1),
      ];
      const beyond = Math.abs(across(i));
      const held = sign * (c - rows[0]) > 1e-9 || foot >= half ? 1 : Math.max(0, (half - beyond) / (half - foot));
      // The order of the points of a rack is from +y to -y, that of a gear from -y to +y.
      const left = tip > 0 && beyond < tip ? 0.5 + 0.5 * (across(i) / tip) : across(i) > 0 ? 1 : 0;
      out.push({ at, w: w.map((x) => x * (i === middle || held > 0 ? held : 0)), left, free: 1 - held });
    }
    return out;
  }

  /** A motion with functions of time. */
  function motionOf(raw, bodies) {
    const time = raw.time_s;
    const frames = raw.contacts.counts.length;
    const modes = raw.modes || [];
    // The mode that swings, from 1, and the magnification of its amplitude.
    const swing = { mode: 1, by: 1 };
    const paths = raw.paths.map((p) => ({
      axes: p.axes,
      origin: p.origin_m,
      turn: numbers(p.turn_rad),
      shift: p.shift_m && numbers(p.shift_m),
      tilt: p.tilt && numbers(p.tilt),
    }));
    const teeth = bodies.map(() => null);
    let largest = 0;
    (raw.teeth || []).forEach((t) => {
      const values = numbers(t.displacements_m);
      const each = t.heights_m.length * 2 * t.rows_m.length * 2;
      values.forEach((x) => { largest = Math.max(largest, Math.abs(x)); });
      teeth[t.body] = {
        ...t, values, each, ends: sums(t.counts), weights: flankWeights(bodies[t.body], t.rows_m),
        // Where all teeth have displacements, so has the root between them.
        isWhole: t.counts.some((n) => n === bodies[t.body].teeth),
      };
    });
    const c = raw.contacts;
    const contacts = {
      ...c,
      ends: sums(c.counts),
      points: numbers(c.points_m),
      forces: numbers(c.forces_n),
      widths: numbers(c.widths_m),
      halves: numbers(c.half_widths_m),
      loads: numbers(c.values),
    };

    /** Frame before a time and the part of the way to the next one. */
    function place(t) {
      if (modes.length) return [0, swing.mode, swing.by * Math.sin(2 * Math.PI * t)];
      let low = 0;
      let high = frames - 1;
      while (high - low > 1) {
        const middle = (low + high) >> 1;
        if (time[middle] <= t) low = middle; else high = middle;
      }
      if (frames < 2) return [0, 0, 0];
      return [low, high, Math.min(1, Math.max(0, (t - time[low]) / (time[high] - time[low])))];
    }

    /** Axes and origin of a body. */
    function pose(body, [i, j, w]) {
      const p = paths[body];
      const turn = mix(p.turn[i], p.turn[j], w);
      const tilt = p.tilt ? [mix(p.tilt[2 * i], p.tilt[2 * j], w), mix(p.tilt[2 * i + 1], p.tilt[2 * j + 1], w)] : [0, 0];
      // A magnified tilt is less than a right angle.
      const [x, y] = tilt.map((a) => (a * 0.9) / Math.max(0.9, Math.hypot(...tilt)));
      const z = Math.sqrt(Math.max(0, 1 - x * x - y * y));
      const k = 1 / (1 + z);
      const base = [[1 - k * x * x, -k * x * y, -x], [-k * x * y, 1 - k * y * y, -y], [x, y, z]];
      const [s, o] = [Math.sin(turn), Math.cos(turn)];
      const own = [
        base[0].map((b, n) => o * b + s * base[1][n]),
        base[1].map((b, n) => o * b - s * base[0][n]),
        base[2],
      ];
      const axes = own.map((a) => [0, 1, 2].map((n) => a[0] * p.axes[0][n] + a[1] * p.axes[1][n] + a[2] * p.axes[2][n]));
      const origin = [0, 1, 2].map((n) => p.origin[n] + (p.shift ? mix(p.shift[3 * i + n], p.shift[3 * j + n], w) : 0));
      return { axes, origin };
    }

    /** Displaced teeth of a body: by number of the tooth the displacements of its rows, side by side and height by height. */
    function displaced(body, [i, j, w]) {
      const t = teeth[body];
      if (!t) return null;
      const found = new Map();
      [[i, 1 - w], [j, w]].forEach(([frame, weight]) => {
        if (weight === 0) return;
        for (let n = t.ends[frame]; n < t.ends[frame + 1]; n += 1) {
          let values = found.get(t.teeth[n]);
          if (!values) {
            values = new Float64Array(t.each);
            found.set(t.teeth[n], values);
          }
          for (let k = 0; k < t.each; k += 1) values[k] += weight * t.values[n * t.each + k];
        }
      });
      if (t.isWhole) roots(t, bodies[body], found);
      return found;
    }

    /** Adds the displacements in the middle of tooth spaces, means of the feet on both sides, to those of teeth. */
    function roots(t, body, found) {
      const rows = 2 * t.rows_m.length;
      const [s, o] = body.is_rack ? [0, 1] : [Math.sin(body.pitch), Math.cos(body.pitch)];
      found.forEach((values, number) => {
        values.root = new Float64Array(4 * t.heights_m.length);
        t.heights_m.forEach((_, h) => [1, -1].forEach((sign, side) => {
          const own = (2 * h + side) * rows;
          const there = (2 * h + 1 - side) * rows;
          const next = found.get((number + sign + body.teeth) % body.teeth) || values;
          const [x, y] = [next[there], next[there + 1]];
          values.root[4 * h + 2 * side] = 0.5 * (values[own] + o * x - sign * s * y);
          values.root[4 * h + 2 * side + 1] = 0.5 * (values[own + 1] + sign * s * x + o * y);
        }));
      });
    }

    /** Contacts of one frame by pair and place within it. */
    function listed(frame) {
      const found = new Map();
      const seen = new Map();
      for (let n = c.counts.length ? contacts.ends[frame] : 0; n < (contacts.ends[frame + 1] || 0); n += 1) {
        const pair = `${c.meshes[n]}:${c.teeth[n].join("-")}:${c.sides[n]}`;
        const order = seen.get(pair) || 0;
        seen.set(pair, order + 1);
        found.set(`${pair}:${order}`, n);
      }
      return found;
    }

    /** Contacts at a place in time: those of both frames between them, else those of the nearer frame. */
    function touching([i, j, w]) {
      const [a, b] = [listed(i), listed(j)];
      const all = [];
      const add = (m, n, v) => {
        const three = (from) => [0, 1, 2].map((k) => mix(from[3 * m + k], from[3 * n + k], v));
        all.push({
          mesh: c.meshes[m], teeth: c.teeth[m], side: c.sides[m],
          pair: `${c.meshes[m]}:${c.teeth[m].join("-")}:${c.sides[m]}`,
          point: three(contacts.points), force: three(contacts.forces),
          width: mix(contacts.widths[m], contacts.widths[n], v),
          half: mix(contacts.halves[m], contacts.halves[n], v),
          load: mix(contacts.loads[m], contacts.loads[n], v),
        });
      };
      a.forEach((m, key) => {
        const n = b.get(key);
        if (n !== undefined) add(m, n, w); else if (w < 0.5) add(m, m, 0);
      });
      b.forEach((n, key) => { if (!a.has(key) && w >= 0.5) add(n, n, 0); });
      return all;
    }

    let force = 0;
    time.forEach((_, i) => {
      byPair(touching([i, i, 0])).forEach((p) => { force = Math.max(force, Math.hypot(...p.force)); });
    });
    const load = contacts.loads.reduce((a, b) => Math.max(a, b), 0);
    const made = { ...raw, modes, swing, bodies, time, frames, place, pose, displaced, touching, teeth, contacts, largest, force, load };
    made.mechanism = window.gearbenchMechanism(made);
    return made;
  }

  /** Adds the displacement at a point of a pitch, `scale` times as large, to the place (x, y) of the point. */
  function shifted(t, values, section, i, scale, place) {
    const { at, w, left, free } = t.weights[i];
    const rows = t.rows_m.length;
    const base = section * 4 * rows;
    for (let side = 0; side < 2; side += 1) {
      const share = side === 0 ? left : 1 - left;
      if (share === 0) continue;
      for (let k = 0; k < 4; k += 1) {
        const n = base + side * 2 * rows + 2 * at[k];
        place[0] += scale * share * w[k] * values[n];
        place[1] += scale * share * w[k] * values[n + 1];
      }
      if (values.root && free > 0) {
        place[0] += scale * share * free * values.root[4 * section + 2 * side];
        place[1] += scale * share * free * values.root[4 * section + 2 * side + 1];
      }
    }
    return place;
  }

  const COLOURS = ["440154", "472d7b", "3b528b", "2c728e", "21918c", "28ae80", "5ec962", "addc30", "fde725"]
    .map((h) => [0, 2, 4].map((k) => parseInt(h.slice(k, k + 2), 16)));
  /** Colour of a part of the largest value, the scale of all maps of the page. */
  function colour(part) {
    const x = Math.min(1, Math.max(0, part || 0)) * (COLOURS.length - 1);
    const i = Math.min(COLOURS.length - 2, Math.floor(x));
    return COLOURS[i].map((a, k) => Math.round(mix(a, COLOURS[i + 1][k], x - i)));
  }
  const css = (rgb) => `rgb(${rgb.join(",")})`;

  /** Sums contacts of a tooth pair, for arrows. */
  function byPair(contacts) {
    const pairs = new Map();
    contacts.forEach((c) => {
      const size = Math.hypot(...c.force);
      const p = pairs.get(c.pair) || { ...c, force: [0, 0, 0], point: [0, 0, 0], size: 0, load: 0 };
      p.size += size;
      p.load = Math.max(p.load, c.load);
      for (let k = 0; k < 3; k += 1) {
        p.force[k] += c.force[k];
        p.point[k] += (size / p.size) * (c.point[k] - p.point[k]);
      }
      pairs.set(c.pair, p);
    });
    return [...pairs.values()];
  }

  /** Draws the section of a model in the plane of the picture. */
  function drawPlane(canvas, model, state, theme) {
    const context = canvas.getContext("2d");
    const [width, height] = [canvas.width, canvas.height];
    const ratio = canvas.width / canvas.clientWidth;
    const { motion } = model;
    const [right, up] = motion.view;
    const at = motion.place(state.time);
    const contacts = motion.touching(at);
    const scale = 0.5 * Math.min(width, height) / state.half;
    const centre = model.centre;
    const toScreen = (p) => [0.5 * width + (dot(p, right) - centre[0]) * scale, 0.5 * height - (dot(p, up) - centre[1]) * scale];
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.fillStyle = theme.paper;
    context.fillRect(0, 0, width, height);
    const poses = motion.paths.map((_, m) => motion.pose(m, at));
    motion.mechanism.below(context, poses, toScreen, scale, theme.carrier);
    const isSwinging = motion.modes.length > 0;
    motion.bodies.forEach((body, b) => {
      const pose = poses[b];
      const flat = [0, 1].map((k) => [dot(pose.axes[k], right), dot(pose.axes[k], up)]);
      const origin = toScreen(pose.origin);
      const screen = (x, y) => [
        origin[0] + (x * flat[0][0] + y * flat[1][0]) * scale,
        origin[1] - (x * flat[0][1] + y * flat[1][1]) * scale,
      ];
      const displaced = motion.displaced(b, at);
      const teeth = motion.teeth[b];
      const middle = teeth ? Math.floor((teeth.heights_m.length - 1) / 2) : 0;
      const points = body.sections[body.is_prism ? 0 : body.sections.length >> 1].points;
      const reach = 2 * body.pitch * (body.is_rack ? 1 : body.reach) * scale;
      /** Adds all teeth to the path, coarse ones outside the picture. */
      const trace = (factor, only, to = screen) => {
        let begun = false;
        for (let n = 0; n < body.teeth; n += 1) {
          const order = body.is_rack ? body.teeth - 1 - n : n;
          const number = body.first_tooth + order;
          const index = ((number % body.teeth) + body.teeth) % body.teeth;
          const values = displaced && displaced.get(index);
          if (only && !values) { begun = false; continue; }
          const [s, o] = body.is_rack ? [0, 1] : [Math.sin(order * body.pitch), Math.cos(order * body.pitch)];
          const by = body.is_rack ? number * body.pitch : 0;
          const tip = body.is_rack ? to(points[body.each - 1], by) : to(body.reach * o, body.reach * s);
          const near = tip[0] > -reach && tip[0] < width + reach && tip[1] > -reach && tip[1] < height + reach;
          const step = near ? 1 : body.each - 1;
          for (let i = 0; i < body.each; i += step) {
            const place = [points[2 * i], points[2 * i + 1]];
            if (values && factor > 0) shifted(teeth, values, middle, i, factor, place);
            const p = to(o * place[0] - s * place[1], s * place[0] + o * place[1] + by);
            if (begun) context.lineTo(p[0], p[1]); else context.moveTo(p[0], p[1]);
            begun = true;
          }
        }
      };
      context.beginPath();
      trace(state.factor, false);
      if (body.is_rack) {
        const end = [body.first_tooth - 0.5, body.first_tooth + body.teeth - 0.5].map((k) => k * body.pitch);
        end.forEach((y) => { const p = screen(body.back_m, y); context.lineTo(p[0], p[1]); });
      }
      context.closePath();
      if (!body.is_rack && body.back_m > 0) {
        context.moveTo(origin[0] + body.back_m * scale, origin[1]);
        context.arc(origin[0], origin[1], body.back_m * scale, 0, 2 * Math.PI);
      }
      context.fillStyle = theme.bodies[b % 2];
      context.fill("evenodd");
      context.lineWidth = 1.3 * ratio;
      context.lineJoin = "round";
      context.strokeStyle = theme.edge;
      context.stroke();
      if (isSwinging) {
        // The gear at rest.
        const rest = motion.pose(b, [0, 0, 0]);
        const there = toScreen(rest.origin);
        const across = [0, 1].map((k) => [dot(rest.axes[k], right), dot(rest.axes[k], up)]);
        const still = (x, y) => [
          there[0] + (x * across[0][0] + y * across[1][0]) * scale, there[1] - (x * across[0][1] + y * across[1][1]) * scale,
        ];
        context.setLineDash([4 * ratio, 3 * ratio]);
        context.lineWidth = ratio;
        context.strokeStyle = theme.grey;
        context.beginPath();
        trace(0, false, still);
        context.stroke();
        context.setLineDash([]);
      } else if (displaced && displaced.size && state.factor > 0) {
        context.setLineDash([4 * ratio, 3 * ratio]);
        context.lineWidth = ratio;
        context.strokeStyle = theme.grey;
        context.beginPath();
        trace(0, true);
        context.stroke();
        context.setLineDash([]);
      }
    });
    motion.mechanism.above(context, poses, toScreen, scale, [theme.shaft, theme.edge], ratio, motion.view[2]);
    contacts.forEach((c) => {
      const f = [dot(c.force, right), dot(c.force, up)];
      const size = Math.hypot(...f) || 1;
      const p = toScreen(c.point);
      const half = Math.max(c.half * scale, 4 * ratio);
      const along = [(-f[1] / size) * half, (-f[0] / size) * half];
      context.lineCap = "round";
      [[theme.paper, 9], [css(colour(c.load / state.load[motion.contacts.value])), 6]].forEach(([ink, line]) => {
        context.strokeStyle = ink;
        context.lineWidth = line * ratio;
        context.beginPath();
        context.moveTo(p[0] - along[0], p[1] - along[1]);
        context.lineTo(p[0] + along[0], p[1] + along[1]);
        context.stroke();
      });
    });
    arrows(context, byPair(contacts), toScreen, (f) => [dot(f, right), dot(f, up)], model, state, theme, ratio);
    bar(context, scale, height, theme, ratio);
  }

  /** Draws the force of each tooth pair on the second gear as an arrow with its magnitude. */
  function arrows(context, pairs, toScreen, toPlane, model, state, theme, ratio) {
    context.font = `600 ${12 * ratio}px sans-serif`;
    context.lineCap = "butt";
    const reach = 0.3 * Math.min(context.canvas.width, context.canvas.height);
    pairs.forEach((pair) => {
      const size = Math.hypot(...pair.force);
      const f = toPlane(pair.force);
      const flat = Math.hypot(...f);
      if (!(size > 0) || !(flat > 0)) return;
      const length = Math.max(10 * ratio, (reach * flat) / state.force);
      const [ux, uy] = [f[0] / flat, -f[1] / flat];
      const p = toScreen(pair.point);
      const tip = [p[0] + ux * length, p[1] + uy * length];
      const neck = [tip[0] - 10 * ratio * ux, tip[1] - 10 * ratio * uy];
      [[theme.paper, 6], [model.ink, 3]].forEach(([ink, line]) => {
        context.strokeStyle = ink;
        context.lineWidth = line * ratio;
        context.beginPath();
        context.moveTo(p[0], p[1]);
        context.lineTo(neck[0], neck[1]);
        context.stroke();
      });
      const barb = 5.5 * ratio;
      context.fillStyle = model.ink;
      context.beginPath();
      context.moveTo(tip[0], tip[1]);
      context.lineTo(neck[0] - barb * uy, neck[1] + barb * ux);
      context.lineTo(neck[0] + barb * uy, neck[1] - barb * ux);
      context.fill();
      // Out of the picture there is nothing to label.
      if (p[0] < 0 || p[1] < 0 || p[0] > context.canvas.width || p[1] > context.canvas.height) return;
      const text = `${quantity(size, "N")}, pair ${pair.teeth.join("-")}`;
      const wide = context.measureText(text).width;
      const x = Math.min(context.canvas.width - wide - 6 * ratio, Math.max(6 * ratio, tip[0] + 8 * ratio * (ux >= 0 ? 1 : -1) - (ux >= 0 ? 0 : wide)));
      const y = Math.min(context.canvas.height - 8 * ratio, Math.max(16 * ratio, tip[1] + (uy > 0 ? 14 : -6) * ratio));
      context.strokeStyle = theme.paper;
      context.lineWidth = 3 * ratio;
      context.strokeText(text, x, y);
      context.fillStyle = theme.ink;
      context.fillText(text, x, y);
    });
  }

  /** Draws the bar of a round length. */
  function bar(context, scale, height, theme, ratio) {
    const wish = (70 * ratio) / scale;
    const power = 10 ** Math.floor(Math.log10(wish));
    const length = [5, 2, 1].map((m) => m * power).find((x) => x <= wish) || power;
    const [x, y] = [14 * ratio, height - 14 * ratio];
    context.strokeStyle = theme.ink;
    context.lineWidth = 2 * ratio;
    context.beginPath();
    context.moveTo(x, y - 4 * ratio);
    context.lineTo(x, y);
    context.lineTo(x + length * scale, y);
    context.lineTo(x + length * scale, y - 4 * ratio);
    context.stroke();
    context.font = `${12 * ratio}px sans-serif`;
    context.fillStyle = theme.ink;
    context.fillText(quantity(length, "m", true), x, y - 8 * ratio);
  }

  function element(name, attributes, ...children) {
    const made = document.createElement(name);
    Object.entries(attributes || {}).forEach(([key, value]) => {
      if (value !== undefined && value !== false) made.setAttribute(key, value === true ? "" : value);
    });
    made.append(...children);
    return made;
  }

  /** Builds the viewer of one element of the page. */
  function viewer(root, number) {
    const data = JSON.parse(root.querySelector("script").textContent);
    const bodies = data.bodies.map((list) => list.map(toothedBody));
    const models = data.models.map((raw) => ({
      label: raw.label, integrator: raw.integrator, ink: raw.ink, motion: motionOf(raw, bodies[raw.bodies]),
    }));
    const isSwinging = models[0].motion.modes.length > 0;
    // The time of modes is the phase in periods.
    const first = isSwinging ? 0 : Math.min(...models.map((m) => m.motion.time[0]));
    const last = isSwinging ? 1 : Math.max(...models.map((m) => m.motion.time[m.motion.frames - 1]));
    const isCalm = window.matchMedia("(prefers-reduced-motion: reduce)");
    const span = last - first || 1;
    const pitch = models[0].motion.bodies[0];
    const state = {
      time: first + (data.start_s === undefined ? 0 : Math.min(span, Math.max(0, data.start_s - first))),
      playing: false,
      seconds: isSwinging ? 2 : 10,
      amplitude: 1,
      follow: false,
      mesh: 1,
      solid: data.spatial && window.gearbenchSolid !== undefined,
      half: 1.35 * pitch.pitch * (pitch.is_rack ? 1 : pitch.reach),
      force: Math.max(...models.map((m) => m.motion.force)) || 1,
      load: {},
      hidden: new Set(),
      turn: [-0.55, -0.5],
      zoom: 1,
    };
    models.forEach(({ motion }) => {
      const kind = motion.contacts.value;
      state.load[kind] = Math.max(state.load[kind] || 0, motion.load) || 1;
    });
    const largest = Math.max(...models.map((m) => m.motion.largest));
    const round = (x) => { const p = 10 ** Math.floor(Math.log10(x)); return [5, 2, 1].find((m) => m * p <= x) * p; };
    const suggested = largest > 0 ? Math.max(1, round((0.09 * state.half) / largest)) : 1;
    state.factor = isSwinging ? 1 : suggested;
    models.forEach(({ motion }) => {
      motion.swing.mode = 1 + Math.max(0, motion.modes.findIndex((m) => !m.is_rigid));
    });
    /** Middle and half width of all gears in the plane of the picture. */
    const whole = (motion) => {
      const [low, high] = [[Infinity, Infinity], [-Infinity, -Infinity]];
      motion.bodies.forEach((b, i) => {
        const { origin } = motion.pose(i, [0, 0, 0]);
        const reach = b.is_rack ? 0.5 * b.pitch * b.teeth : b.is_internal ? b.back_m : b.reach;
        [0, 1].forEach((k) => {
          const x = dot(origin, motion.view[k]);
          low[k] = Math.min(low[k], x - reach);
          high[k] = Math.max(high[k], x + reach);
        });
      });
      return { centre: [0, 1].map((k) => 0.5 * (low[k] + high[k])), half: 0.5 * Math.max(high[0] - low[0], high[1] - low[1]) };
    };
    const size0 = Math.max(...models.map((m) => whole(m.motion).half));
    if (isSwinging) state.half = 1.08 * size0;
    /** Magnification of the present mode of a model: its largest displacement is a part of the size of the scene. */
    const magnified = ({ motion }) => {
      const { largest_m: most } = motion.modes[motion.swing.mode - 1];
      return state.amplitude * (most > 0 ? round((0.08 * size0) / most) : 1);
    };
    const theme = {};
    const readTheme = () => {
      const style = getComputedStyle(root);
      const of = (name) => style.getPropertyValue(name).trim();
      Object.assign(theme, {
        paper: of("--paper"), ink: of("--ink"), grey: of("--grey"), edge: of("--gear-edge"),
        bodies: [of("--gear-a"), of("--gear-b")],
        solids: ["--solid-a", "--solid-b", "--solid-c"].map(of),
        shaft: of("--shaft"), carrier: of("--carrier"), bearing: of("--bearing"),
      });
    };

    /** Middle of the contacts of a model, in the plane of the picture: at one time, or of all frames. */
    function middle(motion, contacts) {
      const [right, up] = motion.view;
      let [x, y, sum] = [0, 0, 0];
      contacts.forEach((c) => {
        const w = Math.hypot(...c.force);
        x += w * dot(c.point, right);
        y += w * dot(c.point, up);
        sum += w;
      });
      return sum > 0 ? [x / sum, y / sum] : null;
    }
    const meshPoint = (motion) => {
      const all = [];
      const { points, forces, meshes } = motion.contacts;
      meshes.forEach((mesh, i) => {
        const own = [3 * i, 3 * i + 3];
        if (mesh === state.mesh) all.push({ point: points.subarray(...own), force: forces.subarray(...own) });
      });
      if (all.length) return middle(motion, all);
      const [a, b] = (motion.meshes[state.mesh - 1] || [0, 0]).map((g) => motion.paths[g].origin_m);
      const between = [0, 1, 2].map((k) => 0.5 * (a[k] + b[k]));
      return [dot(between, motion.view[0]), dot(between, motion.view[1])];
    };
    models.forEach((m) => { m.home = isSwinging ? whole(m.motion).centre : meshPoint(m.motion); m.centre = m.home; });

    const button = (text, label) => element("button", { type: "button", "aria-label": label }, text);
    const play = button("\u25b6 Play", "Play or pause the motion");
    const back = button("\u25c0", isSwinging ? "Phase before" : "Frame before");
    const next = button("\u25b6\u25b6", isSwinging ? "Next phase" : "Next frame");
    const scrub = element("input", { type: "range", min: 0, max: 1000, step: "any", "aria-label": isSwinging ? "Phase" : "Time" });
    const clock = element("output", { class: "clock" });
    const option = (value, text, chosen) => element("option", { value, selected: chosen }, text);
    const speed = element("select", { "aria-label": "Speed" },
      ...[[4, "\u00bc"], [2, "\u00bd"], [1, "1"], [0.5, "2"], [0.25, "4"]]
        .map(([part, t]) => option(part * state.seconds, `speed ${t}`, part === 1)));
    const amplitude = element("select", { "aria-label": "Amplitude of the drawn motion" },
      ...[[0.25, "\u00bc"], [0.5, "\u00bd"], [1, "1"], [2, "2"], [4, "4"]].map(([k, t]) => option(k, `amplitude ${t}`, k === 1)));
    const scales = [...new Set([0, 1, ...[0.1, 0.5, 1, 2, 5].map((k) => round(Math.max(1, k * suggested)))])].sort((a, b) => a - b);
    const factor = element("select", { "aria-label": "Magnification of tooth displacements" },
      ...scales.map((k) => option(k, k === 0 ? "teeth not displaced" : `displacements \u00d7 ${k}`, k === suggested)));
    const follow = element("input", { type: "checkbox" });
    const closer = button("+", "Closer");
    const wider = button("\u2212", "Wider");
    const home = element("button", { type: "button" }, "Reset view");
    const space = element("button", { type: "button", title: "Change between section and space" }, state.solid ? "Section" : "3D");
    const controls = element("div", { class: "controls", role: "group", "aria-label": "Motion of the gears" },
      play, back, next, scrub, clock, speed,
      ...(isSwinging ? [amplitude] : [...(largest > 0 ? [factor] : []), element("label", {}, follow, " follow the contact")]),
      wider, closer, home,
      ...(window.gearbenchSolid ? [space] : []));
    const { meshes, bodies: gears } = models[0].motion;
    const mesh = element("select", { "aria-label": "Mesh in the middle of the view" },
      ...meshes.map(([a, b], i) => option(i + 1, `mesh ${gears[a].gear} - ${gears[b].gear}`, i === 0)));
    if (meshes.length > 1 && !isSwinging) controls.append(mesh);
    const shown = element("div", { class: "controls bodies" });
    const hideable = models[0].motion.bodies.map((body, i) => [i, body.gear]);
    if (models.some((m) => !m.motion.mechanism.isEmpty)) hideable.push(["mechanism", "shafts, carriers and bearings"]);
    hideable.forEach(([key, name]) => {
      const box = element("input", { type: "checkbox", checked: true });
      box.addEventListener("change", () => {
        if (box.checked) state.hidden.delete(key); else state.hidden.add(key);
        draw();
      });
      shown.append(element("label", {}, box, ` ${name}`));
    });
    const panels = element("div", { class: "panels" });
    models.forEach((m, i) => {
      const canvas = element("canvas", {
        tabindex: 0, role: "img",
        "aria-label": `Moving gears of ${m.label}; arrow keys move the view, plus and minus change its size`,
      });
      const solid = element("canvas", { tabindex: 0, role: "img", "aria-label": `Moving gears of ${m.label} in space; arrow keys turn the view, plus and minus change its size` });
      const swatch = element("i", { style: `background:${m.ink}` });
      const title = element("b", {}, swatch, ` ${m.label}${m.integrator ? ` (${m.integrator})` : ""}`);
      const legend = element("span", { class: "load" });
      const { modes, swing } = m.motion;
      const choice = element("select", { "aria-label": `Mode of ${m.label}` },
        ...modes.map((mode, k) => option(k + 1, mode.name, k + 1 === swing.mode)));
      choice.addEventListener("change", () => { swing.mode = Number(choice.value); draw(); });
      const modeOf = modes.length > 1 ? [choice] : modes.map((mode) => element("span", { class: "load" }, mode.name));
      panels.append(element("div", { class: "panel" }, title, ...modeOf, canvas, solid, legend));
      Object.assign(m, { canvas, solidCanvas: solid, legend, index: i });
      handle(m, canvas, false);
      handle(m, solid, true);
    });
    root.append(controls, shown, panels);

    /** Connects pointer and keys of a picture: pan or turn, and size. */
    function handle(m, canvas, solid) {
      const move = (dx, dy) => {
        if (solid) {
          state.turn = [state.turn[0] + dx, Math.min(1.57, Math.max(-1.57, state.turn[1] + dy))];
        } else {
          state.follow = follow.checked = false;
          const by = (2 * state.half) / Math.min(canvas.clientWidth, canvas.clientHeight);
          models.forEach((o) => { o.centre = [o.centre[0] - 140 * dx * by, o.centre[1] + 140 * dy * by]; });
        }
        draw();
      };
      let from = null;
      canvas.addEventListener("pointerdown", (e) => { from = [e.clientX, e.clientY]; canvas.setPointerCapture(e.pointerId); });
      canvas.addEventListener("pointermove", (e) => {
        if (!from) return;
        move((e.clientX - from[0]) / 140, (e.clientY - from[1]) / 140);
        from = [e.clientX, e.clientY];
      });
      ["pointerup", "pointercancel"].forEach((name) => canvas.addEventListener(name, () => { from = null; }));
      canvas.addEventListener("wheel", (e) => {
        // Without a key the wheel moves the page.
        if (!e.ctrlKey && !e.metaKey && document.activeElement !== canvas) return;
        e.preventDefault();
        size(Math.exp(0.001 * e.deltaY));
      }, { passive: false });
      const keys = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] };
      canvas.addEventListener("keydown", (e) => {
        if (keys[e.key]) move(...keys[e.key]);
        else if (e.key === "+") size(0.8);
        else if (e.key === "-") size(1.25);
        else return;
        e.preventDefault();
      });
    }
    function size(by) {
      if (state.solid) state.zoom = Math.min(60, Math.max(0.3, state.zoom / by));
      else state.half = Math.min(10, Math.max(2e-6, state.half * by));
      draw();
    }

    let request = 0;
    function draw() {
      if (!request) request = requestAnimationFrame(() => { request = 0; paint(); });
    }
    function paint() {
      scrub.value = (1000 * (state.time - first)) / span;
      const text = isSwinging ? `phase ${Math.round(360 * state.time)}\u00b0` : quantity(state.time, "s");
      scrub.setAttribute("aria-valuetext", text);
      clock.textContent = text;
      shown.hidden = !state.solid;
      models.forEach((m) => {
        const { motion } = m;
        if (isSwinging) motion.swing.by = magnified(m);
        const at = motion.place(state.time);
        if (state.follow) m.centre = middle(motion, motion.touching(at).filter((c) => c.mesh === state.mesh)) || m.centre;
        let canvas = m.canvas;
        if (state.solid) {
          m.solid = m.solid || window.gearbenchSolid(m.solidCanvas, motion, { shifted, byPair, colour, numbers });
          canvas = m.solid ? m.solidCanvas : m.canvas;
        }
        m.canvas.hidden = canvas !== m.canvas;
        m.solidCanvas.hidden = canvas !== m.solidCanvas;
        const ratio = Math.min(2, window.devicePixelRatio || 1);
        const [w, h] = [Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio)];
        if (!w || !h) return;
        if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
        if (canvas === m.canvas) drawPlane(canvas, m, state, theme);
        else m.solid.draw(state, m, theme);
        if (isSwinging) {
          const { largest_m: most } = motion.modes[motion.swing.mode - 1];
          m.legend.textContent = `largest displacement ${quantity(most, "m")}, drawn \u00d7 ${motion.swing.by}`;
          return;
        }
        const contacts = motion.touching(at);
        const pressed = motion.contacts.value === "pressure";
        const now = contacts.reduce((a, c) => Math.max(a, c.load), 0);
        const unit = pressed ? "Pa" : "N/m";
        const name = pressed ? "pressure" : "force per width";
        m.legend.replaceChildren(`${name}, 0 `, element("i", { class: "scale", "aria-hidden": "true" }),
          ` ${quantity(state.load[motion.contacts.value], unit)}; ${contacts.length ? `now ${quantity(now, unit)}` : "no contact now"}; `,
          motion.largest > 0 ? `teeth displaced by up to ${quantity(motion.largest, "m")}, drawn \u00d7 ${state.factor}` : "rigid teeth");
      });
    }

    function show(seconds, announce) {
      state.time = isSwinging && seconds > last ? seconds - Math.floor(seconds) : Math.min(last, Math.max(first, seconds));
      draw();
      if (announce && !isSwinging) {
        window.dispatchEvent(new CustomEvent("gearbench:time", { detail: { seconds: state.time, source: SOURCE } }));
      }
    }
    let before = 0;
    let played = 0;
    function tick(now) {
      if (!state.playing) return;
      const by = before ? Math.min(0.1, (now - before) / 1000) : 0;
      before = now;
      played += by / state.seconds;
      show(state.time + (span * by) / state.seconds, true);
      // Modes swing on, but only for a period where the reader has asked for less motion.
      if (isSwinging ? isCalm.matches && played >= 1 : state.time >= last) setPlaying(false);
      else requestAnimationFrame(tick);
    }
    function setPlaying(on) {
      if (state.playing === on) return;
      state.playing = on;
      play.textContent = on ? "\u275a\u275a Pause" : "\u25b6 Play";
      play.setAttribute("aria-pressed", String(on));
      if (on) {
        if (state.time >= last) state.time = first;
        [before, played] = [0, 0];
        requestAnimationFrame(tick);
      }
    }
    /** Moves to the frame of the first model before or after the present time. */
    function step(by) {
      setPlaying(false);
      if (isSwinging) {
        // Steps of 15 degrees, from the end of the period to its start.
        const to = (Math.round(24 * state.time) + by + 24) % 24;
        show(to / 24, false);
        return;
      }
      const { time } = models[0].motion;
      const slack = 1e-9 * span;
      const found = by > 0 ? time.find((t) => t > state.time + slack) : [...time].reverse().find((t) => t < state.time - slack);
      if (found !== undefined) show(found, true);
    }
    play.addEventListener("click", () => setPlaying(!state.playing));
    back.addEventListener("click", () => step(-1));
    next.addEventListener("click", () => step(1));
    scrub.addEventListener("input", () => { setPlaying(false); show(first + (span * scrub.value) / 1000, true); });
    speed.addEventListener("change", () => { state.seconds = Number(speed.value); });
    amplitude.addEventListener("change", () => { state.amplitude = Number(amplitude.value); draw(); });
    factor.addEventListener("change", () => { state.factor = Number(factor.value); draw(); });
    follow.addEventListener("change", () => {
      state.follow = follow.checked;
      if (!state.follow) models.forEach((m) => { m.centre = m.home; });
      draw();
    });
    mesh.addEventListener("change", () => {
      state.mesh = Number(mesh.value);
      models.forEach((m) => { m.home = meshPoint(m.motion); m.centre = m.home; m.focus = undefined; });
      draw();
    });
    closer.addEventListener("click", () => size(1 / 1.4));
    wider.addEventListener("click", () => size(1.4));
    const start = { half: state.half, turn: state.turn };
    home.addEventListener("click", () => {
      Object.assign(state, { half: start.half, turn: start.turn, zoom: 1, follow: false });
      follow.checked = false;
      models.forEach((m) => { m.centre = m.home; });
      draw();
    });
    space.addEventListener("click", () => {
      state.solid = !state.solid;
      space.textContent = state.solid ? "Section" : "3D";
      draw();
    });
    window.addEventListener("gearbench:time", (e) => {
      if (isSwinging || !e.detail || e.detail.source === SOURCE || !Number.isFinite(e.detail.seconds)) return;
      setPlaying(false);
      show(e.detail.seconds, false);
    });
    const repaint = () => { readTheme(); draw(); };
    window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", repaint);
    new ResizeObserver(draw).observe(panels);
    readTheme();
    root.closest("figure").classList.add("moving");
    root.dataset.viewer = String(number);
    root.gearbenchState = state;
    draw();
  }

  document.querySelectorAll(".gears").forEach(viewer);
})();
