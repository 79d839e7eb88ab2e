// Shafts, bodies without teeth, carriers and bearings of a motion at an instant, for both views of the gears. Their shapes are in the
// data of the page: rings in the frames of members or of places on shafts (studies/solid/mechanism.rs).
"use strict";
window.gearbenchMechanism = (() => {
  const add = (a, b, k = 1) => a.map((x, n) => x + k * b[n]);
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const unit = (a) => { const l = Math.hypot(...a) || 1; return a.map((x) => x / l); };
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const within = ({ origin, axes }, p) => axes.reduce((at, axis, k) => add(at, axis, p[k]), origin);

  /** The mechanism of a motion. */
  return function mechanism(motion) {
    const { parts, signs, shafts, joints } = motion.mechanism;
    const start = motion.paths.map((_, m) => motion.pose(m, [0, 0, 0]));

    /** Direction that all members of a shaft have in common at the start. */
    const mark = ({ members, marks }, k, poses) => within({ ...poses[members[k]], origin: [0, 0, 0] }, [...marks[k], 0]);

    /** Frame of a place on a shaft: cubic between members. */
    function station(s, poses, place) {
      const { members, places_m: places } = s;
      const last = places.length - 1;
      const framed = (origin, side, axis) => ({ origin, axes: [side, cross(axis, side), axis] });
      if (last === 0 || place <= places[0] || place >= places[last]) {
        const n = place >= places[last] ? last : 0;
        const end = poses[members[n]];
        return framed(add(end.origin, end.axes[2], place - places[n]), mark(s, n, poses), end.axes[2]);
      }
      let k = 0;
      while (k < last - 1 && place > places[k + 1]) k += 1;
      const [a, b] = [poses[members[k]], poses[members[k + 1]]];
      const length = places[k + 1] - places[k];
      const t = (place - places[k]) / length;
      const h = [(1 + 2 * t) * (1 - t) ** 2, length * t * (1 - t) ** 2, t * t * (3 - 2 * t), length * t * t * (t - 1)];
      const origin = [0, 1, 2].map((n) => h[0] * a.origin[n] + h[1] * a.axes[2][n] + h[2] * b.origin[n] + h[3] * b.axes[2][n]);
      // The twist between members is even.
      const [from, to] = [mark(s, k, poses), mark(s, k + 1, poses)];
      const across = cross(a.axes[2], from);
      const twist = t * Math.atan2(dot(to, across), dot(to, from));
      const axis = unit(a.axes[2].map((x, n) => (1 - t) * x + t * b.axes[2][n]));
      const along = add(from.map((x) => Math.cos(twist) * x), across, Math.sin(twist));
      return framed(origin, unit(add(along, axis, -dot(along, axis))), axis);
    }

    /** Points of a ring in space at some poses of all members. */
    function points({ frame, circle, corners }, poses) {
      const pose = frame.shaft ? station(shafts[frame.shaft[0]], poses, frame.shaft[1])
        : frame.rest === undefined ? poses[frame.member] : start[frame.rest];
      if (corners) return corners.map((p) => within(pose, p));
      const { at, radius, sides } = circle;
      return Array.from({ length: sides }, (_, n) => {
        const angle = (2 * Math.PI * n) / sides;
        return within(pose, [at[0] + radius * Math.cos(angle), at[1] + radius * Math.sin(angle), at[2]]);
      });
    }

    /** Triangles in space at some poses of all members, by the kind of the parts. */
    function solid(poses) {
      const found = { turning: [], carrier: [], bearing: [] };
      parts.forEach(({ kind, is_hollow: isHollow, rings: all }) => {
        const out = found[kind];
        const rings = all.map((ring) => points(ring, poses));
        if (isHollow) rings.push(rings[0]);
        for (let k = 0; k + 1 < rings.length; k += 1) {
          rings[k].forEach((a, n) => {
            const m = (n + 1) % rings[k].length;
            const [b, c, d] = [rings[k][m], rings[k + 1][m], rings[k + 1][n]];
            out.push(...a, ...b, ...c, ...a, ...c, ...d);
          });
        }
        if (isHollow) return;
        [rings[0], rings[rings.length - 1]].forEach((end) => {
          for (let n = 1; n + 1 < end.length; n += 1) out.push(...end[0], ...end[n], ...end[n + 1]);
        });
      });
      return found;
    }

    /** Places in space at the first instant that the parts reach, each with a radius and a member. */
    const extent = () => parts.flatMap(({ rings }) => [rings[0], rings[rings.length - 1]].map((ring) => {
      const all = points(ring, start);
      const middle = [0, 1, 2].map((k) => all.reduce((a, p) => a + p[k] / all.length, 0));
      const { shaft, rest, member } = ring.frame;
      const own = shaft ? shafts[shaft[0]].members[0] : rest === undefined ? member : rest;
      return [middle, Math.max(...all.map((p) => Math.hypot(...add(p, middle, -1)))), own];
    }));

    const ofKind = (...kinds) => signs.filter((s) => kinds.includes(s.kind));

    /** Draws carriers below the gears of a section: arms from the centre to the pins. */
    function below(context, poses, toScreen, scale, ink) {
      context.strokeStyle = ink;
      context.lineCap = "round";
      ofKind("arm").forEach(({ member, at, radius }) => {
        context.lineWidth = radius * scale;
        context.beginPath();
        context.moveTo(...toScreen(poses[member].origin));
        context.lineTo(...toScreen(within(poses[member], at)));
        context.stroke();
      });
      context.lineCap = "butt";
    }

    /** Draws shafts, pins and bearings over the gears of a section, where they point to the reader. */
    function above(context, poses, toScreen, scale, [ink, edge], ratio, sight) {
      ofKind("disc", "bearing").forEach(({ kind, member, at, radius, mark: own }) => {
        const pose = kind === "disc" ? poses[member] : start[member];
        if (Math.abs(dot(pose.axes[2], sight)) < 0.99) return;
        const centre = within(pose, at);
        const [x, y] = toScreen(centre);
        const size = radius * scale;
        context.strokeStyle = edge;
        context.lineWidth = (kind === "disc" ? 1 : 1.2) * ratio;
        context.beginPath();
        if (kind === "disc") {
          context.arc(x, y, size, 0, 2 * Math.PI);
          context.globalAlpha = 0.45;
          context.fillStyle = ink;
          context.fill();
          context.globalAlpha = 1;
          // A radius shows the rotation.
          if (own) {
            context.moveTo(x, y);
            context.lineTo(...toScreen(within({ ...pose, origin: centre }, [radius * own[0], radius * own[1], 0])));
          }
        } else {
          [1, 3, 5, 7].forEach((k) => {
            const [cos, sin] = [Math.cos(0.25 * Math.PI * k), Math.sin(0.25 * Math.PI * k)];
            context.moveTo(x + 0.55 * size * cos, y + 0.55 * size * sin);
            context.lineTo(x + 1.25 * size * cos, y + 1.25 * size * sin);
          });
        }
        context.stroke();
      });
    }

    return { isEmpty: !parts.length, joints, solid, extent, below, above };
  };
})();
