#!/usr/bin/env python3
"""Turns the printed output of a CalculiX gear impact into the CSV that gearbench stores.

usage: dat_to_csv.py NAME [-o OUT.csv]

Reads NAME.inp (deck), NAME.dat (printed output) and NAME.frd (nodal velocities, ASCII) of a run whose
deck has the layout of the stored ones: element sets GEAR1 and GEAR2 of C3D8, bores as rigid bodies,
node sets REFS and ROTS, contact pairs between `sflank1_*` and `sflank2_*`. With one rigid body the second
is a rack held at its back: it has no columns of speed and angle. Needs Python 3.8 or newer and nothing else.

All columns but two are printed by CalculiX. The two are the momentum means

    omega_mean = L / I,    L = e . sum_ij M_ij (x_i x v_j),    I = sum_ij M_ij (x_i . x_j - (e . x_i)(e . x_j))

about the axis e of the hub (z, or what its *TRANSFORM says) with the consistent mass matrix M of the 8-node brick
(2x2x2 points) and x the positions of the deck from the hub's reference node. The gears turn by less than 2e-3 rad in the
stored runs; leaving this out changes the means by less than 1e-6 of the initial speed. Speeds and angles of a tilted hub
are those about its own axis.
"""
import argparse
import math
import re

# Natural coordinates of the nodes of a C3D8, in CalculiX's order.
CORNERS = [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1),
           (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)]
FLOAT = r"[-+0-9.EeNna]+"


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def read_deck(path):
    """Nodes, elements per gear, density, rigid bodies, contact pairs, initial hub velocities, axes of tilted hubs."""
    nodes, elements, pairs, hubs, speeds, sets, axes = {}, {}, [], [], {}, {}, {}
    density, keyword = None, ""
    with open(path) as deck:
        for line in deck:
            line = line.strip()
            if not line or line.startswith("**"):
                continue
            if line.startswith("*"):
                keyword = line.upper().replace(" ", "")
                if keyword.startswith("*RIGIDBODY"):
                    hubs.append((int(re.search(r"REFNODE=(\d+)", keyword).group(1)),
                                 int(re.search(r"ROTNODE=(\d+)", keyword).group(1))))
                continue
            cells = [c.strip() for c in line.split(",") if c.strip()]
            if keyword.startswith("*NODE,"):
                nodes[int(cells[0])] = tuple(float(c) for c in cells[1:4])
            elif keyword.startswith("*ELEMENT") and "TYPE=C3D8," in keyword:
                name = re.search(r"ELSET=(\w+)", keyword).group(1)
                elements.setdefault(name, []).append([int(c) for c in cells[1:9]])
            elif keyword.startswith("*DENSITY"):
                density = float(cells[0])
            elif keyword.startswith("*CONTACTPAIR"):
                pairs.append(cells[0].lower())
            elif keyword.startswith("*INITIALCONDITIONS"):
                speeds.setdefault(int(cells[0]), [0.0] * 3)[int(cells[1]) - 1] = float(cells[2])
            elif keyword.startswith("*NSET,NSET=TILTED"):
                sets[keyword.split("=")[1]] = int(cells[0])
            elif keyword.startswith("*TRANSFORM"):
                name = re.search(r"NSET=(\w+)", keyword).group(1)
                x = [float(c) for c in cells]
                axis = cross(x[:3], x[3:6])
                axes[sets[name]] = [c / math.sqrt(dot(axis, axis)) for c in axis]
    if sorted(elements) != ["GEAR1", "GEAR2"] or len(hubs) not in (1, 2) or density is None:
        raise SystemExit(f"{path}: expected C3D8 element sets GEAR1 and GEAR2, one or two rigid bodies, a density")
    return nodes, elements, density, hubs, pairs, speeds, axes


def element_mass(x, density):
    """Consistent 8x8 mass matrix of one brick, 2x2x2 Gauss points."""
    mass = [[0.0] * 8 for _ in range(8)]
    g = 1.0 / math.sqrt(3.0)
    for point in [(a * g, b * g, c * g) for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)]:
        shape, jacobian = [], [[0.0] * 3 for _ in range(3)]
        for corner, xi in zip(CORNERS, x):
            f = [1.0 + p * c for p, c in zip(point, corner)]
            shape.append(0.125 * f[0] * f[1] * f[2])
            gradient = (0.125 * corner[0] * f[1] * f[2], 0.125 * f[0] * corner[1] * f[2],
                        0.125 * f[0] * f[1] * corner[2])
            for i in range(3):
                for j in range(3):
                    jacobian[i][j] += gradient[i] * xi[j]
        a, b, c = jacobian
        det = (a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
               + a[2] * (b[0] * c[1] - b[1] * c[0]))
        for i in range(8):
            for j in range(8):
                mass[i][j] += density * det * shape[i] * shape[j]
    return mass


def momentum_rows(nodes, elements, density, centre, axis):
    """p_j = sum_i M_ij axis x (x_i - centre), so that L = sum_j p_j . v_j; and the inertia about the axis, in kg m^2."""
    rows, inertia = {}, 0.0
    around = {}
    for element in elements:
        mass = element_mass([nodes[n] for n in element], density)
        for n in element:
            if n not in around:
                around[n] = cross(axis, [x - c for x, c in zip(nodes[n], centre)])
        for j, node_j in enumerate(element):
            row = rows.setdefault(node_j, [0.0] * 3)
            for i, node_i in enumerate(element):
                for k in range(3):
                    part = mass[i][j] * around[node_i][k]
                    row[k] += part
                    inertia += part * around[node_j][k]
    return rows, inertia


def read_dat(path):
    """Printed output by time: the numbers that follow each heading."""
    heading = re.compile(rf"^\s*(\S.*\S)\s+and time\s+({FLOAT})\s*$")
    blocks, current, order = {}, None, []
    with open(path) as dat:
        for line in dat:
            match = heading.match(line)
            if match:
                time = float(match.group(2))
                if not order or order[-1] != time:
                    order.append(time)
                current = blocks.setdefault(time, {}).setdefault(match.group(1).lower(), [])
            elif current is not None and re.fullmatch(rf"(\s*{FLOAT})+\s*L?\s*", line):
                # The letter says that the values are in axes of the node's own.
                current.append([float(x) for x in line.replace("L", "").split()])
    return order, blocks


def read_velocities(path):
    """Yields (time, {node: (vx, vy, vz)}) of every result block, in order."""
    time, velocities = None, None
    with open(path) as frd:
        for line in frd:
            if line.startswith("  100C"):
                time = float(line[12:24])
            elif line.startswith(" -4"):
                velocities = {} if "VELO" in line else None
            elif velocities is not None and line.startswith(" -1"):
                velocities[int(line[3:13])] = tuple(float(line[k:k + 12]) for k in (13, 25, 37))
            elif velocities is not None and line.startswith(" -3"):
                yield time, velocities
                velocities = None


def main():
    parser = argparse.ArgumentParser(description="CalculiX gear impact to CSV")
    parser.add_argument("name", help="path of the run without extension")
    parser.add_argument("-o", "--out", help="output (default NAME.csv)")
    options = parser.parse_args()
    nodes, elements, density, hubs, pairs, speeds, axes = read_deck(options.name + ".inp")
    order, blocks = read_dat(options.name + ".dat")
    gears = []
    for (reference, rotation), name in zip(hubs, ("GEAR1", "GEAR2")):
        axis = axes.get(rotation, [0.0, 0.0, 1.0])
        rows, inertia = momentum_rows(nodes, elements[name], density, nodes[reference], axis)
        gears.append((name.lower(), rotation, rows, inertia))

    turning = range(1, len(gears) + 1)
    columns = (["time_s", "contact_force_n", "force_x_n", "force_y_n", "force_z_n"]
               + [f"moment_{k}_origin_nm" for k in "xyz"]
               + [f"omega{g}_hub_rad_s" for g in turning] + [f"omega{g}_mean_rad_s" for g in turning]
               + [f"phi{g}_hub_rad" for g in turning] + [f"strain_energy{g}_j" for g in (1, 2)]
               + [f"kinetic_energy{g}_j" for g in (1, 2)] + [f"f_{pair}_n" for pair in pairs])
    # The state at t = 0 is the deck's initial condition: rigid rotation, no contact, no strain.
    still = [0.0] * 3
    first = [dot(speeds.get(rotation, still), axes.get(rotation, [0.0, 0.0, 1.0])) for _, rotation, _, _ in gears]
    kinetic = [0.5 * inertia * w * w for w, (_, _, _, inertia) in zip(first, gears)]
    kinetic += [0.0] * (2 - len(kinetic))
    lines = [[0.0] * 8 + first + first + [0.0] * (len(gears) + 2) + kinetic + [0.0] * len(pairs)]

    for time, (frd_time, velocities) in zip(order, read_velocities(options.name + ".frd")):
        # The .frd prints five decimals, the .dat seven.
        if abs(frd_time - time) > 1e-5 * time:
            raise SystemExit(f"{options.name}: .dat has time {time}, .frd {frd_time}; the runs differ")
        block = blocks[time]
        angle = {int(r[0]): r[3] for r in block["displacements (vx,vy,vz) for set rots"]}
        speed = {int(r[0]): r[3] for r in block["velocities (vx,vy,vz) for set rots"]}
        forces = []
        for pair in pairs:
            key = next(k for k in block if k.startswith(f"statistics for slave set {pair},"))
            forces.append(block[key][0])
        total = [sum(f[i] for f in forces) for i in range(6)]
        means = []
        for _, _, rows, inertia in gears:
            momentum = 0.0
            for node, row in rows.items():
                momentum += dot(row, velocities[node])
            means.append(momentum / inertia)
        lines.append([time, math.sqrt(dot(total[:3], total[:3]))] + total
                     + [speed[g[1]] for g in gears] + means + [angle[g[1]] for g in gears]
                     + [block[f"total internal energy for set gear{g}"][0][0] for g in (1, 2)]
                     + [block[f"total kinetic energy for set gear{g}"][0][0] for g in (1, 2)]
                     + [math.sqrt(dot(f[:3], f[:3])) for f in forces])

    with open(options.out or options.name + ".csv", "w") as out:
        out.write(",".join(columns) + "\n")
        for line in lines:
            out.write(",".join(f"{x + 0.0:.8e}" for x in line) + "\n")
    for name, _, _, inertia in gears:
        print(f"{name}: inertia {inertia:.9e} kg m^2")
    print(f"{len(lines)} rows")


if __name__ == "__main__":
    main()
