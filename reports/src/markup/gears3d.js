// Gears in space: teeth as strips between sections, drawn tooth by tooth with WebGL2; contacts and forces over them.
"use strict";
window.gearbenchSolid = (() => {
  const VERTEX = `#version 300 es
    in vec3 place;
    uniform mat4 toView;
    uniform mat4 toClip;
    out vec3 seen;
    void main() { vec4 p = toView * vec4(place, 1.0); seen = p.xyz; gl_Position = toClip * p; }`;
  // The normal of a face is that of the surface through neighbouring pixels.
  const FRAGMENT = `#version 300 es
    precision highp float;
    in vec3 seen;
    uniform vec4 ink;
    uniform float shaded;
    out vec4 result;
    void main() {
      vec3 n = normalize(cross(dFdx(seen), dFdy(seen)));
      float light = mix(1.0, 0.42 + 0.58 * max(0.0, dot(n, normalize(vec3(0.35, 0.5, 0.8)))), shaded);
      result = vec4(ink.rgb * light, ink.a);
    }`;

  function program(gl) {
    const made = gl.createProgram();
    [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]].forEach(([kind, text]) => {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(made, shader);
    });
    gl.linkProgram(made);
    return gl.getProgramParameter(made, gl.LINK_STATUS) ? made : null;
  }

  /** Points of one pitch in all sections: those of a fine outline thinned, ends and edges kept. */
  function thinned(body) {
    const step = Math.max(1, Math.floor(body.each / 64));
    const kept = [];
    const p = body.sections[0].points;
    const turn = (i) => {
      const a = [p[2 * i] - p[2 * i - 2], p[2 * i + 1] - p[2 * i - 1]];
      const b = [p[2 * i + 2] - p[2 * i], p[2 * i + 3] - p[2 * i + 1]];
      return Math.abs(Math.atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]));
    };
    for (let i = 0; i < body.each; i += 1) {
      if (i % step === 0 || i === body.each - 1 || turn(i) > 0.1) kept.push(i);
    }
    return kept;
  }

  /** Place on the bore, the rim or the back at the side of an outline point. */
  function backOf(body, x, y) {
    if (body.is_rack) return [body.back_m, y];
    const r = Math.hypot(x, y) || 1;
    return [(x / r) * body.back_m, (y / r) * body.back_m];
  }

  const hex = (text) => {
    const full = text.replace(/^#(.)(.)(.)$/, "#$1$1$2$2$3$3");
    const c = /^#(..)(..)(..)/.exec(full);
    if (c) return c.slice(1).map((h) => parseInt(h, 16) / 255);
    const n = (text.match(/[\d.]+/g) || [0, 0, 0]).map(Number);
    return n.slice(0, 3).map((x) => x / 255);
  };

  /** Product of two matrices by columns. */
  function product(a, b) {
    const out = new Float32Array(16);
    for (let c = 0; c < 4; c += 1) {
      for (let r = 0; r < 4; r += 1) {
        let sum = 0;
        for (let k = 0; k < 4; k += 1) sum += a[4 * k + r] * b[4 * c + k];
        out[4 * c + r] = sum;
      }
    }
    return out;
  }

  return function solid(canvas, motion, { shifted, byPair, colour }) {
    const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
    if (!gl) return null;
    const made = program(gl);
    if (!made) return null;
    const at = {};
    ["toView", "toClip", "ink", "shaded"].forEach((name) => { at[name] = gl.getUniformLocation(made, name); });
    gl.useProgram(made);
    const slot = gl.getAttribLocation(made, "place");
    gl.enableVertexAttribArray(slot);

    /** Vertices of a tooth: outline and back, section by section. */
    function vertices(body, kept, teeth, values, factor) {
      const n = kept.length;
      const out = new Float32Array(body.sections.length * n * 6);
      body.sections.forEach((section, s) => {
        kept.forEach((i, k) => {
          const place = [section.points[2 * i], section.points[2 * i + 1]];
          const rim = backOf(body, place[0], place[1]);
          if (values) {
            const heights = teeth.heights_m;
            const part = heights.length > 1 ? (section.z - heights[0]) / (heights[heights.length - 1] - heights[0]) : 0;
            const x = Math.min(heights.length - 1, Math.max(0, part * (heights.length - 1)));
            const low = Math.min(Math.max(0, heights.length - 2), Math.floor(x));
            shifted(teeth, values, low, i, factor * (1 - (x - low)), place);
            if (x > low) shifted(teeth, values, low + 1, i, factor * (x - low), place);
          }
          out.set([place[0], place[1], section.z], 3 * (s * 2 * n + k));
          out.set([rim[0], rim[1], section.z], 3 * (s * 2 * n + n + k));
        });
      });
      return out;
    }

    function faces(body, n) {
      const out = [];
      const quad = (a, b, c, d) => out.push(a, b, c, a, c, d);
      const last = body.sections.length - 1;
      for (let k = 0; k + 1 < n; k += 1) {
        for (let s = 0; s < last; s += 1) {
          const [a, b] = [s * 2 * n + k, (s + 1) * 2 * n + k];
          quad(a, a + 1, b + 1, b);
          quad(a + n, b + n, b + n + 1, a + n + 1);
        }
        [0, last].forEach((s) => {
          const a = s * 2 * n + k;
          quad(a, a + n, a + n + 1, a + 1);
        });
      }
      return new Uint16Array(out);
    }

    const shapes = motion.bodies.map((body) => {
      const kept = thinned(body);
      const index = faces(body, kept.length);
      const shape = { kept, count: index.length, vertices: gl.createBuffer(), moved: gl.createBuffer(), index: gl.createBuffer() };
      gl.bindBuffer(gl.ARRAY_BUFFER, shape.vertices);
      gl.bufferData(gl.ARRAY_BUFFER, vertices(body, kept), gl.STATIC_DRAW);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, shape.index);
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, index, gl.STATIC_DRAW);
      return shape;
    });
    const loose = gl.createBuffer();

    // Places with a radius at the first frame, each with a member: gears, and what shafts have beyond them.
    const start = motion.paths.map((_, m) => motion.pose(m, [0, 0, 0]));
    const places = [
      ...motion.bodies.map((b, m) => [start[m].origin, b.is_rack ? 0.5 * b.teeth * b.pitch : b.is_internal ? b.back_m : b.reach, m]),
      ...motion.mechanism.extent(),
    ];
    /** First member of those that meshes, shafts and carriers join with each member. */
    const joined = start.map((_, m) => m);
    [...motion.meshes, ...motion.mechanism.joints].forEach((members) => members.forEach((m) => {
      const [from, to] = [joined[m], joined[members[0]]];
      joined.forEach((k, n) => { if (k === from) joined[n] = to; });
    }));
    const framings = new Map();
    /** Middle and radius of the gears that are joined with those of a mesh, or of all for mesh 0. */
    function framing(mesh) {
      const key = mesh ? joined[motion.meshes[mesh - 1][0]] : -1;
      if (!framings.has(key)) {
        const own = places.filter(([, , m]) => !mesh || joined[m] === key);
        const middle = [0, 1, 2].map((k) => 0.5 * (Math.min(...own.map(([o, r]) => o[k] - r)) + Math.max(...own.map(([o, r]) => o[k] + r))));
        framings.set(key, { own, middle });
      }
      return framings.get(key);
    }
    const everything = framing(0);
    const radius = Math.max(...places.map(([o, r]) => Math.hypot(...[0, 1, 2].map((k) => o[k] - everything.middle[k])) + r));

    function draw(state, model, theme) {
      const place = motion.place(state.time);
      const contacts = motion.touching(place);
      const [right, up, towards] = motion.view;
      const [yaw, pitch] = state.turn;
      const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
      // First about the vertical of the picture, then about its horizontal.
      const turned = (v) => {
        const p = [0, 1, 2].map((k) => [right, up, towards][k].reduce((a, x, n) => a + x * v[n], 0));
        const [x, z] = [cy * p[0] + sy * p[2], cy * p[2] - sy * p[0]];
        return [x, cp * p[1] + sp * -z, sp * p[1] + cp * z];
      };
      const { own: framed, middle } = framing(motion.modes.length ? 0 : state.mesh);
      let focus = middle;
      if (state.follow) {
        const own = contacts.filter((c) => c.mesh === state.mesh);
        const sizes = own.map((c) => Math.hypot(...c.force));
        const sum = sizes.reduce((a, b) => a + b, 0);
        if (sum > 0) model.focus = [0, 1, 2].map((k) => own.reduce((a, c, n) => a + (sizes[n] / sum) * c.point[k], 0));
        focus = model.focus || middle;
      }
      const [ex, ey, ez] = [turned([1, 0, 0]), turned([0, 1, 0]), turned([0, 0, 1])];
      const centre = turned(focus);
      const scene = new Float32Array([...ex, 0, ...ey, 0, ...ez, 0, -centre[0], -centre[1], -centre[2], 1]);
      const aspect = canvas.width / canvas.height;
      // All gears that are joined fit into the picture; with the contact in the middle it shows some teeth.
      const fit = [0, 1].map((k) => 1.03 * Math.max(...framed.map(([o, r]) => Math.abs(turned(o)[k] - turned(middle)[k]) + r)));
      const whole = aspect >= 1 ? Math.max(fit[1], fit[0] / aspect) : Math.max(fit[0], fit[1] * aspect);
      const half = (state.follow ? 1.9 * state.half : whole) / state.zoom;
      const toClip = new Float32Array([1 / (half * Math.max(1, aspect)), 0, 0, 0, 0, 1 / (half / Math.min(1, aspect)), 0, 0, 0, 0, -0.2 / radius, 0, 0, 0, 0, 1]);
      gl.viewport(0, 0, canvas.width, canvas.height);
      const paper = hex(theme.paper);
      gl.clearColor(...paper, 1);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      gl.enable(gl.DEPTH_TEST);
      gl.uniformMatrix4fv(at.toClip, false, toClip);
      gl.uniform1f(at.shaded, 1);
      motion.bodies.forEach((body, b) => {
        if (state.hidden.has(b)) return;
        const shape = shapes[b];
        const pose = motion.pose(b, place);
        const toSpace = new Float32Array([...pose.axes[0], 0, ...pose.axes[1], 0, ...pose.axes[2], 0, ...pose.origin, 1]);
        const toView = product(scene, toSpace);
        const own = hex(theme.solids[b % theme.solids.length]);
        gl.uniform4f(at.ink, ...own, 1);
        gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, shape.index);
        const displaced = state.factor > 0 ? motion.displaced(b, place) : null;
        for (let n = 0; n < body.teeth; n += 1) {
          const number = body.first_tooth + n;
          const angle = body.is_rack ? 0 : n * body.pitch;
          const [s, c] = [Math.sin(angle), Math.cos(angle)];
          const by = body.is_rack ? number * body.pitch : 0;
          const tooth = new Float32Array([c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, 0, by, 0, 1]);
          gl.uniformMatrix4fv(at.toView, false, product(toView, tooth));
          const values = displaced && displaced.get(((number % body.teeth) + body.teeth) % body.teeth);
          gl.bindBuffer(gl.ARRAY_BUFFER, values ? shape.moved : shape.vertices);
          if (values) {
            const moved = vertices(body, shape.kept, motion.teeth[b], values, state.factor);
            gl.bufferData(gl.ARRAY_BUFFER, moved, gl.DYNAMIC_DRAW);
          }
          gl.vertexAttribPointer(slot, 3, gl.FLOAT, false, 0, 0);
          gl.drawElements(gl.TRIANGLES, shape.count, gl.UNSIGNED_SHORT, 0);
        }
      });
      gl.uniformMatrix4fv(at.toView, false, scene);
      const fill = (points, ink) => {
        gl.bindBuffer(gl.ARRAY_BUFFER, loose);
        gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(points), gl.DYNAMIC_DRAW);
        gl.vertexAttribPointer(slot, 3, gl.FLOAT, false, 0, 0);
        gl.uniform4f(at.ink, ...ink, 1);
        gl.drawArrays(gl.TRIANGLES, 0, points.length / 3);
      };
      if (!state.hidden.has("mechanism") && !motion.mechanism.isEmpty) {
        const parts = motion.mechanism.solid(motion.paths.map((_, m) => motion.pose(m, place)));
        fill(parts.turning, hex(theme.shaft));
        fill(parts.carrier, hex(theme.carrier));
        fill(parts.bearing, hex(theme.bearing));
      }
      // Contacts lie between two flanks: they are drawn over the gears.
      gl.disable(gl.DEPTH_TEST);
      gl.uniform1f(at.shaded, 0);
      const pixel = (2 * half) / Math.min(canvas.width, canvas.height) * Math.min(2, window.devicePixelRatio || 1);
      // The direction to the reader, in space.
      const sight = [ex[2], ey[2], ez[2]];
      const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
      const unit = (a) => { const l = Math.hypot(...a) || 1; return a.map((x) => x / l); };
      /** Two triangles between two places, with a width in the plane of the screen. */
      const ribbon = (a, b, width) => {
        const off = unit(cross(b.map((x, k) => x - a[k]), sight)).map((x) => 0.5 * width * x);
        const [p, q, r, s] = [a.map((x, k) => x + off[k]), a.map((x, k) => x - off[k]), b.map((x, k) => x - off[k]), b.map((x, k) => x + off[k])];
        return [...p, ...q, ...r, ...p, ...r, ...s];
      };
      const lines = new Map();
      contacts.forEach((c) => { if (!lines.has(c.pair)) lines.set(c.pair, []); lines.get(c.pair).push(c); });
      lines.forEach((slices) => {
        const gear = motion.pose(motion.meshes[slices[0].mesh - 1][0], place);
        slices.forEach((c, i) => {
          const [before, behind] = [slices[Math.max(0, i - 1)], slices[Math.min(slices.length - 1, i + 1)]];
          const d = before === behind ? gear.axes[2] : behind.point.map((x, k) => x - before.point[k]);
          // Ends of the slice: its part of the width along the line of contact.
          const along = unit(d);
          const rise = Math.abs(along[0] * gear.axes[2][0] + along[1] * gear.axes[2][1] + along[2] * gear.axes[2][2]);
          const length = 0.5 * c.width / Math.max(0.2, rise);
          const ends = [-1, 1].map((sign) => c.point.map((x, k) => x + sign * length * along[k]));
          const thick = Math.max(2 * c.half, 5 * pixel);
          if (i === 0 || i === slices.length - 1) fill(ribbon(ends[0], ends[1], thick + 3 * pixel), paper);
          fill(ribbon(ends[0], ends[1], thick), colour(c.load / state.load[motion.contacts.value]).map((x) => x / 255));
        });
      });
      byPair(contacts).forEach((pair) => {
        const size = Math.hypot(...pair.force);
        if (!(size > 0)) return;
        const length = Math.max(8 * pixel, 0.45 * half * size / state.force);
        const along = pair.force.map((x) => x / size);
        const tip = pair.point.map((x, k) => x + length * along[k]);
        const neck = tip.map((x, k) => x - Math.min(0.4 * length, 12 * pixel) * along[k]);
        const ink = hex(model.ink);
        fill(ribbon(pair.point, neck, 6 * pixel), paper);
        fill(ribbon(pair.point, neck, 3 * pixel), ink);
        const off = unit(cross(along, sight)).map((x) => 6 * pixel * x);
        fill([...tip, ...neck.map((x, k) => x + off[k]), ...neck.map((x, k) => x - off[k])], ink);
      });
    }
    return { draw };
  };
})();
