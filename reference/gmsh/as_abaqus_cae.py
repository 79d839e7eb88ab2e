"""Writes a mesh of Gmsh (4.1 ASCII, quadratic tetrahedra, mm) in the form of Abaqus/CAE: a part, an instance that is moved
and turned, an assembly, a material in tonnes and millimetres, a step; without sets that gearbench could ask for.

    python3 as_abaqus_cae.py spur_z20.msh.gz pinion.inp.gz
"""

import gzip
import sys

STEEL = """** MATERIALS
*Material, name=Steel
*Density
7.85e-09,
*Elastic
206000., 0.3
"""
STEP = """** STEP: Press
*Step, name=Press, nlgeom=NO
*Static
1., 1., 1e-05, 1.
*Restart, write, frequency=0
*Output, field, variable=PRESELECT
*Output, history, variable=PRESELECT
*End Step
"""


def text_of(path):
    with (gzip.open if path.endswith(".gz") else open)(path, "rt") as file:
        return file.read()


def section(lines, name):
    return lines[lines.index("$" + name) + 1 : lines.index("$End" + name)]


def nodes(lines):
    rows = section(lines, "Nodes")
    found, at = {}, 1
    while at < len(rows):
        count = int(rows[at].split()[3])
        tags = rows[at + 1 : at + 1 + count]
        places = rows[at + 1 + count : at + 1 + 2 * count]
        found.update((int(t), tuple(map(float, p.split()[:3]))) for t, p in zip(tags, places))
        at += 1 + 2 * count
    return found


def tetrahedra(lines):
    rows = section(lines, "Elements")
    found, at = [], 1
    while at < len(rows):
        kind, count = map(int, rows[at].split()[2:4])
        if kind == 11:
            for row in rows[at + 1 : at + 1 + count]:
                n = [int(x) for x in row.split()[1:]]
                # The last two mid-side nodes stand the other way round.
                found.append(n[:8] + [n[9], n[8]])
        at += 1 + count
    return found


def main(source, target):
    lines = text_of(source).split("\n")
    places, elements = nodes(lines), tetrahedra(lines)
    used = sorted({n for e in elements for n in e})
    number = {tag: i + 1 for i, tag in enumerate(used)}
    out = ["*Heading", "** Job name: press Model name: Model-1", "** PARTS", "*Part, name=Gear", "*Node"]
    out += ["%7d, %13.7g, %13.7g, %13.7g" % (number[t], *places[t]) for t in used]
    out.append("*Element, type=C3D10")
    out += [", ".join(str(x) for x in [i + 1] + [number[n] for n in e]) for i, e in enumerate(elements)]
    out += ["*Elset, elset=Set-1, generate", " 1, %d, 1" % len(elements), "** Section: Section-1"]
    out += ["*Solid Section, elset=Set-1, material=Steel", ",", "*End Part", "**", "** ASSEMBLY"]
    out += ["*Assembly, name=Assembly", "*Instance, name=Gear-1, part=Gear", "12., -7., 30."]
    out += ["12., -7., 30., 12., -6., 30., 35.", "*End Instance", "*End Assembly"]
    text = "\n".join(out) + "\n" + STEEL + STEP
    with (gzip.open if target.endswith(".gz") else open)(target, "wt") as file:
        file.write(text)


main(*sys.argv[1:3])
