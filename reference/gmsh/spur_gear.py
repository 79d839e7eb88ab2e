"""Meshes a gear of spur_impact by Gmsh: quadratic tetrahedra, mm, no groups but that of all tetrahedra, axis along x.

    python3 spur_gear.py 20 15 spur_z20.msh [fine] [coarse]      teeth, bore in mm; elements along a flank, 4 and 2
    python3 spur_gear.py 30 25 spur_z30.msh

Outline: involute, fillet that a rack with a rounded tip generates (F. L. Litvin, A. Fuentes, Gear Geometry and Applied
Theory, 2nd ed. 2004, ch. 6), root and tip arcs, bore. Tooth 0 points to -z; it is fine, its
neighbours nearly. Made with Gmsh 4.15.2.
"""

import math
import sys

import gmsh

MODULE, ALPHA, ADDENDUM, DEDENDUM, ROUND, WIDTH = 4.0, math.radians(20.0), 1.0, 1.25, 0.3, 10.0


def half_space(teeth):
    """From the middle of a tooth space to the middle of a tooth: (radius, angle) in pieces that join at their ends."""
    r = 0.5 * teeth * MODULE
    base, tip, root = r * math.cos(ALPHA), r + ADDENDUM * MODULE, r - DEDENDUM * MODULE
    depth = (DEDENDUM - ROUND) * MODULE
    middle = 0.25 * math.pi * MODULE - DEDENDUM * MODULE * math.tan(ALPHA)
    middle -= ROUND * MODULE * (1.0 - math.sin(ALPHA)) / math.cos(ALPHA)
    fillet = []
    for i in range(25):
        psi = 0.5 * math.pi + (ALPHA - 0.5 * math.pi) * i / 24
        pitch = middle - depth / math.tan(psi)
        x = middle + ROUND * MODULE * math.cos(psi) - pitch
        y = r - depth - ROUND * MODULE * math.sin(psi)
        fillet.append((math.hypot(x, y), math.atan2(x, y) + pitch / r))
    form = fillet[-1][0]
    flank = []
    for i in range(41):
        roll = [math.sqrt(a * a - base * base) for a in (form, tip)]
        roll = math.sqrt(roll[0] ** 2 + (roll[1] ** 2 - roll[0] ** 2) * i / 40)
        alpha, own = math.atan(roll / base), math.tan(ALPHA) - ALPHA
        half = 0.5 * math.pi / teeth + own - (math.tan(alpha) - alpha)
        flank.append((math.hypot(base, roll), math.pi / teeth - half))
    return root, tip, fillet, flank


def gear(teeth, bore, centre, fine, coarse):
    """A gear with its axis along x through `centre` (y, z)."""
    geo = gmsh.model.geo
    root, tip, fillet, flank = half_space(teeth)
    pitch = 2.0 * math.pi / teeth

    def point(radius, angle, size):
        # Own x is -z, own y is y.
        return geo.addPoint(0.0, centre[0] + radius * math.sin(angle), centre[1] - radius * math.cos(angle), size)

    axis = geo.addPoint(0.0, *centre)
    curves, first, last = [], None, None

    def counted(curve, elements):
        geo.mesh.setTransfiniteCurve(curve, elements + 1)
        curves.append(curve)

    for k in range(teeth):
        # Elements along a flank: the tooth that points to -z is fine, its neighbours nearly.
        near = min(k, teeth - k)
        along = fine if near == 0 else max(fine // 2, coarse) if near == 1 else coarse
        size = 8.0 / along if along > coarse else 12.0
        # Counter-clockwise from the space before tooth k: its right flank comes first.
        start = (k - 0.5) * pitch

        def placed(pieces, mirror):
            return [(a, start + (pitch - b if mirror else b)) for a, b in pieces]

        after = placed(fillet, False)
        before = [(a, 2.0 * start - b) for a, b in after]
        bottom = before[::-1] + [(root, start)] + after
        feet = last or point(*bottom[0], size)
        first = first or feet
        through = [feet] + [point(a, b, size) for a, b in bottom[1:]]
        counted(geo.addSpline(through), 2 * max(1, along // 2))
        up = [through[-1]] + [point(a, b, size) for a, b in placed(flank, False)[1:]]
        counted(geo.addSpline(up), along)
        down = [point(a, b, size) for a, b in placed(flank, True)[::-1][:-1]]
        counted(geo.addCircleArc(up[-1], axis, down[0]), max(1, along // 3))
        last = first if k == teeth - 1 else point(*placed(flank, True)[0], size)
        counted(geo.addSpline(down + [last]), along)
    outside = geo.addCurveLoop(curves)
    around = [point(bore, 0.5 * math.pi * k, 0.5 * bore) for k in range(4)]
    inside = [geo.addCircleArc(around[k], axis, around[(k + 1) % 4]) for k in range(4)]
    surface = geo.addPlaneSurface([outside, geo.addCurveLoop(inside)])
    return geo.extrude([(2, surface)], WIDTH, 0.0, 0.0)[1][1]


def main():
    teeth, bore, path = int(sys.argv[1]), float(sys.argv[2]), sys.argv[3]
    fine, coarse = (int(a) for a in (sys.argv[4:6] or ("4", "2")))
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 1)
    gmsh.option.setNumber("General.NumThreads", 1)
    volume = gear(teeth, bore, (30.0, -12.0), fine, coarse)
    gmsh.model.geo.synchronize()
    # Of a group of volumes only their own nodes are written, not those that splines go through.
    gmsh.model.addPhysicalGroup(3, [volume])
    gmsh.model.mesh.generate(3)
    # Straight sides: curved ones turn coarse tetrahedra at the fillets inside out.
    gmsh.option.setNumber("Mesh.SecondOrderLinear", 1)
    gmsh.model.mesh.setOrder(2)
    gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
    gmsh.write(path)
    if path.endswith(".msh"):
        digits(path)
    tets = gmsh.model.mesh.getElementsByType(11)[0]
    worst = min(gmsh.model.mesh.getElementQualities(tets, "minSJ"))
    print(len(tets), "tetrahedra, scaled Jacobian", worst, "or more")
    print(gmsh.option.getString("General.Version"), len(gmsh.model.mesh.getNodes()[0]), "nodes")
    gmsh.finalize()


def digits(path):
    """Seven digits of coordinates, ten nanometres, pack better than sixteen; points that only splines go through are left out."""
    with open(path) as file:
        lines = file.read().split("\n")
    nodes = range(lines.index("$Nodes") + 2, lines.index("$EndNodes"))
    with_nodes = {lines[i].split()[1] for i in nodes if lines[i].startswith("0 ") and len(lines[i].split()) == 4}
    for i in nodes:
        numbers = lines[i].split()
        if len(numbers) == 3:
            lines[i] = " ".join(f"{float(x):.7g}" for x in numbers)
    entities = lines.index("$Entities") + 1
    counts = lines[entities].split()
    points = lines[entities + 1 : entities + 1 + int(counts[0])]
    points = [p for p in points if p.split()[0] in with_nodes]
    lines[entities + 1 : entities + 1 + int(counts[0])] = points
    lines[entities] = " ".join([str(len(points))] + counts[1:])
    with open(path, "w") as file:
        file.write("\n".join(lines))


main()
