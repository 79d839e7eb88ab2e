// Shafts, bodies without teeth, carriers and bearings of a motion: their places at an instant, for both views of the gears.
"use strict";
window.gearbenchMechanism = (() => {
  const add = (a, b, k = 1) => a.map((x, n) => x + k * b[n]);
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const size = (a) => Math.hypot(...a);
  const unit = (a) => { const l = size(a) || 1; return a.map((x) => x / l); };
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  // Parts of a span between two members, and sides of round bodies.
  const PARTS = 10;
  const SIDES = 12;

  /** The mechanism of a motion. A scene gives no shape for rigid shafts, bodies, carriers and bearings: theirs follow from the gears. */
  return function mechanism(motion) {
    const { bodies } = motion;
    const gears = bodies.length;
    const plain = motion.plain_bodies || [];
    const shafts = motion.shafts || [];
    const bearings = motion.bearings || [];
    const round = bodies.filter((b) => !b.is_rack && !b.is_internal);
    const reach = Math.min(...(round.length ? round : bodies).map((b) => b.reach || b.pitch));
    /** Radius of a pin or shaft that fits into a gear. */
    const bore = (b) => (b && !b.is_rack && !b.is_internal ? (b.back_m > 0 ? 0.96 * b.back_m : 0.2 * b.reach) : 0.2 * reach);
    const ends = (b) => [b.heights_m[0], b.heights_m[b.heights_m.length - 1]];
    const shaftOf = (member) => shafts.find((s) => s.members.includes(member));

    /** Radius of a shaft without a diameter: the least bore of its gears. */
    const drawn = (s) => Math.min(0.3 * reach, ...s.members.filter((m) => m < gears).map((m) => bore(bodies[m])));
    /** Sections of a shaft: from, to, radius, and whether it is a coupling. */
    const sections = (s) => {
      const ordinary = drawn(s);
      if (!s.sections || !s.sections.length) {
        return [{ from: s.places_m[0], to: s.places_m[s.places_m.length - 1], radius: ordinary, coupling: false }];
      }
      let from = 0;
      return s.sections.map((x) => {
        const found = { from, to: from + x.length_m, radius: x.diameter_m ? 0.5 * x.diameter_m : 1.5 * ordinary, coupling: !x.diameter_m };
        from = found.to;
        return found;
      });
    };
    const radiusAt = (s, place) => {
      const all = sections(s).filter((x) => !x.coupling);
      const own = all.find((x) => place >= x.from - 1e-9 && place <= x.to + 1e-9) || all[0];
      return own ? own.radius : drawn(s);
    };

    /** Direction of a member that is the same for all members of its shaft at the start: tooth 0 of gears is anywhere. */
    function mark(s, poses, member) {
      const [own, ref] = [atStart()[member], atStart()[s.members[0]].axes[0]];
      const { axes } = poses[member];
      return add(axes[0].map((x) => dot(ref, own.axes[0]) * x), axes[1], dot(ref, own.axes[1]));
    }

    /** Centre and direction of a shaft at a place along it, and a direction on its circumference: cubic between members. */
    function station(s, poses, place) {
      const { members, places_m: places } = s;
      const last = places.length - 1;
      let k = 0;
      while (k < last - 1 && place > places[k + 1]) k += 1;
      const a = poses[members[k]];
      if (last === 0 || place <= places[0] || place >= places[last]) {
        const n = last > 0 && place >= places[last] ? last : 0;
        const end = poses[members[n]];
        return { centre: add(end.origin, end.axes[2], place - places[n]), side: mark(s, poses, members[n]), axis: end.axes[2] };
      }
      const b = poses[members[k + 1]];
      const length = places[k + 1] - places[k];
      const t = (place - places[k]) / length;
      const h = [(1 + 2 * t) * (1 - t) ** 2, t * (1 - t) ** 2, t * t * (3 - 2 * t), t * t * (t - 1)];
      const centre = [0, 1, 2].map((n) => h[0] * a.origin[n] + h[1] * length * a.axes[2][n] + h[2] * b.origin[n] + h[3] * length * b.axes[2][n]);
      // The twist between members is even.
      const [from, to] = [members[k], members[k + 1]].map((m) => mark(s, poses, m));
      const across = cross(a.axes[2], from);
      const twist = Math.atan2(dot(to, across), dot(to, from));
      const axis = unit(a.axes[2].map((x, n) => (1 - t) * x + t * b.axes[2][n]));
      const along = add(from.map((x) => Math.cos(t * twist) * x), across, Math.sin(t * twist));
      return { centre, side: unit(add(along, axis, -dot(along, axis))), axis };
    }

    /** Place of the pin of a planet, which moves with its carrier. */
    function pin(carrier, planet, poses, start) {
      const [own, then] = [poses[gears + carrier], start[gears + carrier]];
      const off = add(start[planet].origin, then.origin, -1);
      return then.axes.reduce((at, axis, k) => add(at, own.axes[k], dot(off, axis)), own.origin);
    }

    const carriers = plain.map((b, i) => ({ ...b, i })).filter((b) => (b.planets || []).length);
    const start = () => motion.paths.map((_, m) => motion.pose(m, [0, 0, 0]));
    let first = null;
    const atStart = () => { first = first || start(); return first; };

    /** Ring of points around a centre. */
    const ring = ({ centre, side, axis }, radius, sides = SIDES) => {
      const other = cross(axis, side);
      return Array.from({ length: sides }, (_, n) => {
        const angle = (2 * Math.PI * n) / sides;
        return add(add(centre, side, radius * Math.cos(angle)), other, radius * Math.sin(angle));
      });
    };
    const quad = (out, a, b, c, d) => out.push(...a, ...b, ...c, ...a, ...c, ...d);
    /** Adds a tube through rings, with its ends. */
    const tube = (out, rings) => {
      for (let k = 0; k + 1 < rings.length; k += 1) {
        rings[k].forEach((p, n) => {
          const m = (n + 1) % rings[k].length;
          quad(out, p, rings[k][m], rings[k + 1][m], rings[k + 1][n]);
        });
      }
      [rings[0], rings[rings.length - 1]].forEach((end) => {
        for (let n = 1; n + 1 < end.length; n += 1) out.push(...end[0], ...end[n], ...end[n + 1]);
      });
    };
    /** Adds a hollow cylinder around an axis. */
    const collar = (out, { centre, side, axis }, [inner, outer], half) => {
      const at = [-half, half].map((z) => ({ centre: add(centre, axis, z), side, axis }));
      const [a, b] = at.map((x) => ring(x, outer, 24));
      const [c, d] = at.map((x) => ring(x, inner, 24));
      a.forEach((_, n) => {
        const m = (n + 1) % a.length;
        quad(out, a[n], a[m], b[m], b[n]);
        quad(out, c[n], c[m], d[m], d[n]);
        quad(out, a[n], a[m], c[m], c[n]);
        quad(out, b[n], b[m], d[m], d[n]);
      });
    };

    /** Triangles in space at some poses of all members: of shafts with bodies, of carriers, and of bearings. */
    function solid(poses) {
      const found = { turning: [], carriers: [], bearings: [] };
      shafts.forEach((s) => {
        sections(s).forEach((x) => {
          const inside = s.places_m.filter((z) => z > x.from && z < x.to);
          const cuts = [x.from, ...inside, x.to];
          const rings = [];
          for (let k = 0; k + 1 < cuts.length; k += 1) {
            for (let n = k ? 1 : 0; n <= PARTS; n += 1) {
              rings.push(ring(station(s, poses, cuts[k] + ((cuts[k + 1] - cuts[k]) * n) / PARTS), x.radius));
            }
          }
          if (x.to > x.from) tube(found.turning, rings);
        });
      });
      // A web between a shaft and the bore of its gear.
      shafts.forEach((s) => s.members.forEach((m, k) => {
        const b = bodies[m];
        if (!b || b.is_rack || b.is_internal) return;
        const radius = radiusAt(s, s.places_m[k]);
        if (b.back_m < 1.02 * radius) return;
        const { origin, axes } = poses[m];
        const [low, high] = ends(b);
        collar(found.turning, { centre: add(origin, axes[2], 0.5 * (low + high)), side: axes[0], axis: axes[2] }, [0.98 * radius, b.back_m], 0.2 * (high - low));
      }));
      plain.forEach((b, i) => {
        const s = shaftOf(gears + i);
        if (!(b.inertia_kgm2 > 0) || (b.planets || []).length || !s) return;
        const place = s.places_m[s.members.indexOf(gears + i)];
        const radius = Math.max(0.45 * reach, 1.6 * radiusAt(s, place));
        const { origin, axes } = poses[gears + i];
        const at = (z) => ({ centre: add(origin, axes[2], z), side: axes[0], axis: axes[2] });
        tube(found.turning, [ring(at(-0.3 * radius), radius, 8), ring(at(0.3 * radius), radius, 8)]);
      });
      carriers.forEach((c) => {
        const { origin, axes } = poses[gears + c.i];
        const planets = c.planets.map((p) => bodies[p]);
        const low = Math.min(...planets.map((b) => ends(b)[0]));
        const thick = 0.12 * Math.min(...planets.map((b) => b.reach));
        const wide = 0.5 * Math.max(...planets.map(bore));
        // Behind the planets, seen from the end of the axis.
        const [top, bottom] = [low - 0.4 * thick, low - 1.4 * thick];
        const at = (p, z) => ({ centre: add(p, axes[2], z), side: axes[0], axis: axes[2] });
        c.planets.forEach((p) => {
          const end = pin(c.i, p, poses, atStart());
          const along = unit(add(end, origin, -1));
          const off = cross(axes[2], along);
          const corners = (z) => [[origin, -1], [end, -1], [end, 1], [origin, 1]].map(([q, sign]) => add(add(q, off, sign * wide), axes[2], z));
          tube(found.carriers, [corners(top), corners(bottom)]);
          const shaft = bore(bodies[p]);
          tube(found.carriers, [ring(at(end, bottom), 1.25 * wide, 20), ring(at(end, top), 1.25 * wide, 20)]);
          tube(found.carriers, [ring(at(end, top), shaft, 20), ring(at(end, ends(bodies[p])[1] + 0.3 * thick), shaft, 20)]);
        });
        tube(found.carriers, [ring(at(origin, bottom), 1.8 * wide, 20), ring(at(origin, top), 1.8 * wide, 20)]);
      });
      bearings.forEach((m) => {
        if (carriers.some((c) => c.planets.includes(m))) return;
        const b = bodies[m];
        if (b && (b.is_rack || b.is_internal)) return;
        const s = shaftOf(m);
        const radius = s ? radiusAt(s, s.places_m[s.members.indexOf(m)]) : 0.96 * bore(b);
        const { origin, axes } = atStart()[m];
        const half = 0.35 * radius;
        // A bearing holds the axis at its place at the start; that of a gear is drawn on both sides of it.
        const places = b ? ends(b).map((z, k) => z + (k ? 1 : -1) * 1.6 * half) : [0];
        places.forEach((z) => collar(found.bearings, { centre: add(origin, axes[2], z), side: axes[0], axis: axes[2] }, [1.12 * radius, 1.6 * radius], half));
        if (b && !s) {
          const { origin: own, axes: now } = poses[m];
          const [from, to] = ends(b).map((z, k) => z + (k ? 1 : -1) * 3.4 * half);
          tube(found.turning, [from, to].map((z) => ring({ centre: add(own, now[2], z), side: now[0], axis: now[2] }, radius)));
        }
      });
      return found;
    }

    /** What is drawn beyond the gears: places at the ends of shafts, each with a radius and a member. */
    function extent(poses) {
      const found = [];
      shafts.forEach((s) => sections(s).forEach((x) => [x.from, x.to].forEach((z) => found.push([station(s, poses, z).centre, 2 * x.radius, s.members[0]]))));
      plain.forEach((b, i) => { if (b.inertia_kgm2 > 0) found.push([poses[gears + i].origin, 0.5 * reach, gears + i]); });
      return found;
    }

    /** Draws carriers below the gears of a section: arms from the centre to the pins. */
    function below(context, poses, toScreen, scale, ink) {
      carriers.forEach((c) => {
        const wide = Math.max(...c.planets.map((p) => bore(bodies[p])));
        context.strokeStyle = ink;
        context.lineCap = "round";
        context.lineWidth = wide * scale;
        const from = toScreen(poses[gears + c.i].origin);
        c.planets.forEach((p) => {
          const to = toScreen(pin(c.i, p, poses, atStart()));
          context.beginPath();
          context.moveTo(...from);
          context.lineTo(...to);
          context.stroke();
        });
      });
      context.lineCap = "butt";
    }

    /** Draws shafts, pins and bearings over the gears of a section, where they point to the reader. */
    function above(context, poses, toScreen, scale, [ink, edge], ratio, sight) {
      const disc = (origin, radius, side) => {
        const [x, y] = toScreen(origin);
        context.beginPath();
        context.arc(x, y, radius * scale, 0, 2 * Math.PI);
        context.globalAlpha = 0.45;
        context.fillStyle = ink;
        context.fill();
        context.globalAlpha = 1;
        context.lineWidth = ratio;
        context.strokeStyle = edge;
        // A diameter shows the rotation.
        if (side) {
          const to = toScreen(add(origin, side, radius));
          context.moveTo(x, y);
          context.lineTo(...to);
        }
        context.stroke();
      };
      const points = (axis) => Math.abs(dot(axis, sight)) > 0.99;
      shafts.forEach((s) => {
        const m = s.members.find((k) => k < gears);
        if (m === undefined || !points(poses[m].axes[2])) return;
        disc(poses[m].origin, radiusAt(s, s.places_m[s.members.indexOf(m)]), mark(s, poses, m));
      });
      carriers.forEach((c) => c.planets.forEach((p) => {
        if (points(poses[p].axes[2])) disc(pin(c.i, p, poses, atStart()), bore(bodies[p]), null);
      }));
      bearings.forEach((m) => {
        const { origin, axes } = atStart()[m];
        if (!points(axes[2]) || carriers.some((c) => c.planets.includes(m)) || (bodies[m] && bodies[m].is_rack)) return;
        const s = shaftOf(m);
        const radius = (s ? radiusAt(s, s.places_m[s.members.indexOf(m)]) : bore(bodies[m])) * scale;
        const [x, y] = toScreen(origin);
        context.strokeStyle = edge;
        context.lineWidth = 1.2 * ratio;
        context.beginPath();
        [0, 1, 2, 3].forEach((k) => {
          const [cos, sin] = [Math.cos(0.25 * Math.PI * (2 * k + 1)), Math.sin(0.25 * Math.PI * (2 * k + 1))];
          context.moveTo(x + 0.55 * radius * cos, y + 0.55 * radius * sin);
          context.lineTo(x + 1.25 * radius * cos, y + 1.25 * radius * sin);
        });
        context.stroke();
      });
    }

    const isEmpty = !shafts.length && !bearings.length && !carriers.length && !plain.some((b) => b.inertia_kgm2 > 0);
    // Members that move together, beyond those in mesh.
    const joints = [...shafts.map((s) => s.members), ...carriers.map((c) => [gears + c.i, ...c.planets])];
    return { isEmpty, joints, solid, extent, below, above };
  };
})();
