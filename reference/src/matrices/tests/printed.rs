//! Own matrices and shapes printed as other programs print them.

use crate::assembly::Assembly;
use crate::matrices::Coordinate;
use crate::reduction::store::archive::Writer;
use std::collections::HashMap;
use std::fmt::Write;
use std::io;

/// Files by their names.
#[derive(Clone, Default)]
pub struct Files(pub HashMap<String, Vec<u8>>);

impl Files {
    pub fn with(mut self, name: &str, bytes: impl Into<Vec<u8>>) -> Self {
        self.0.insert(name.to_owned(), bytes.into());
        self
    }

    pub fn read(&self, name: &str) -> io::Result<Vec<u8>> {
        let found = self.0.get(name).cloned();
        found.ok_or_else(|| io::Error::other("no such file"))
    }
}

/// Entries of a matrix of a triangle, rows below or at columns.
type Entries = Vec<(usize, usize, f64)>;

/// Upper triangle of stiffness and mass over `3 node + axis`.
pub fn entries(a: &Assembly) -> [Entries; 2] {
    let [mut k, mut m] = [Vec::new(), Vec::new()];
    for (row, column, place) in a.stiffness.pattern().iter() {
        let block = a.stiffness.entries()[place];
        for i in 0..3 {
            for j in 0..3 {
                if row != column || i <= j {
                    k.push((3 * row + i, 3 * column + j, block[3 * i + j]));
                }
            }
        }
    }
    for (row, column, place) in a.mass.pattern().iter() {
        for i in 0..3 {
            m.push((3 * row + i, 3 * column + i, a.mass.entries()[place]));
        }
    }
    [k, m]
}

/// `.sti`, `.mas` and `.dof` of CalculiX.
pub fn calculix(a: &Assembly, stem: &str) -> Files {
    let [k, m] = entries(a).map(|entries| {
        let mut text = String::new();
        for (row, column, value) in entries {
            writeln!(
                text,
                "{} {} {:>20}",
                row + 1,
                column + 1,
                c_number(value, 13)
            )
            .unwrap();
        }
        text
    });
    Files::default()
        .with(&format!("{stem}.sti"), k)
        .with(&format!("{stem}.mas"), m)
        .with(&format!("{stem}.dof"), dof(&coordinates(a)))
}

pub fn coordinates(a: &Assembly) -> Vec<Coordinate> {
    let nodes = 1..=a.lumped.len() as u32;
    let three = |node| (1..=3).map(move |direction| Coordinate { node, direction });
    nodes.flat_map(three).collect()
}

pub fn dof(coordinates: &[Coordinate]) -> String {
    let line = |c: &Coordinate| format!("{}.{}\n", c.node, c.direction);
    coordinates.iter().map(line).collect()
}

/// A number with an exponent of two digits or more.
fn c_number(x: f64, digits: usize) -> String {
    let text = format!("{x:.digits$e}");
    let (number, exponent) = text.split_once('e').unwrap();
    let exponent: i32 = exponent.parse().unwrap();
    let sign = if exponent < 0 { '-' } else { '+' };
    format!("{number}e{sign}{:02}", exponent.abs())
}

/// `_STIF1.mtx` and `_MASS1.mtx` of Abaqus, whose rows follow its own order of the nodes.
pub fn abaqus(a: &Assembly, stem: &str) -> Files {
    let [k, m] = entries(a).map(|entries| {
        let mut text = String::new();
        for (i, (row, column, value)) in entries.into_iter().enumerate() {
            let (r, c) = if i % 3 == 0 {
                (row, column)
            } else {
                (column, row)
            };
            let at = |x: usize| format!("{},{}", x / 3 + 1, x % 3 + 1);
            writeln!(text, "{}, {},  {value:.15e}", at(r), at(c)).unwrap();
        }
        text
    });
    Files::default()
        .with(&format!("{stem}_STIF1.mtx"), k)
        .with(&format!("{stem}_MASS1.mtx"), m)
}

/// Lines of row, column and value of both triangles, with or without a head.
pub fn numbered(a: &Assembly, stem: &str, head: &str) -> Files {
    let size = 3 * a.lumped.len();
    let [k, m] = entries(a).map(|entries| {
        let both = entries.iter().flat_map(|&(r, c, v)| {
            let mirror = (r != c).then_some((c, r, v));
            std::iter::once((r, c, v)).chain(mirror)
        });
        let both: Entries = both.collect();
        let mut text = match head {
            "" => String::new(),
            head => format!("{head}\n% a comment\n{size} {size} {}\n", both.len()),
        };
        for (r, c, v) in both {
            writeln!(text, "{}  {}  {v:e}", r + 1, c + 1).unwrap();
        }
        text
    });
    Files::default()
        .with(&format!("{stem}_STIF2.mtx"), k)
        .with(&format!("{stem}_MASS2.mtx"), m)
}

/// Matrices of `HBMAT` with a mapping file; the rows are numbered from the last node.
pub fn ansys(a: &Assembly, stem: &str) -> Files {
    let size = 3 * a.lumped.len();
    let turned = |i: usize| 3 * (a.lumped.len() - 1 - i / 3) + i % 3;
    let [k, m] = entries(a).map(|entries| {
        let mut columns: Vec<Vec<(usize, f64)>> = vec![Vec::new(); size];
        for (r, c, v) in entries {
            let (r, c) = (turned(r), turned(c));
            columns[r.min(c)].push((r.max(c), v));
        }
        columns.iter_mut().for_each(|c| c.sort_by_key(|e| e.0));
        let count: usize = columns.iter().map(Vec::len).sum();
        let lines = |n: usize, per: usize| n.div_ceil(per);
        let mut text = format!("{:<72}{:<8}\n", "stiffness or mass", "STIF");
        let [p, i, v] = [lines(size + 1, 8), lines(count, 8), lines(count, 3)];
        writeln!(text, "{:14}{p:14}{i:14}{v:14}{:14}", p + i + v, 0).unwrap();
        writeln!(text, "{:<14}{size:14}{size:14}{count:14}{:14}", "RSA", 0).unwrap();
        writeln!(
            text,
            "{:<16}{:<16}{:<20}{:<20}",
            "(8I10)", "(8I10)", "(1P,3D25.16)", ""
        )
        .unwrap();
        let mut starts = vec![1];
        for column in &columns {
            starts.push(starts.last().unwrap() + column.len());
        }
        let mut whole = |numbers: Vec<usize>| {
            for line in numbers.chunks(8) {
                let words: String = line.iter().map(|n| format!("{n:10}")).collect();
                text.push_str(&words);
                text.push('\n');
            }
        };
        whole(starts);
        whole(columns.iter().flatten().map(|e| e.0 + 1).collect());
        let values: Vec<f64> = columns.iter().flatten().map(|e| e.1).collect();
        for line in values.chunks(3) {
            let words: String = (line.iter())
                .map(|v| format!("{:>25}", c_number(*v, 16).replace('e', "D")))
                .collect();
            text.push_str(&words);
            text.push('\n');
        }
        text
    });
    let mut map = String::from(" Matrix Eqn     Node      DOF\n");
    for row in 0..size {
        let node = a.lumped.len() - row / 3;
        let name = ["UX", "UY", "UZ"][row % 3];
        writeln!(map, "{:10}{node:10}    {name}", row + 1).unwrap();
    }
    Files::default()
        .with(&format!("{stem}_stiff.hb"), k)
        .with(&format!("{stem}_mass.hb"), m)
        .with(&format!("{stem}_stiff.mapping"), map)
}

/// Arrays of numpy: both matrices, and shapes if there are some.
pub fn arrays(a: &Assembly, shapes: Option<&[Vec<f64>]>) -> Vec<u8> {
    let mut w = Writer::new(Vec::new());
    let coordinates = coordinates(a);
    let n = coordinates.len();
    let of = |f: fn(&Coordinate) -> i64| coordinates.iter().map(f).collect::<Vec<_>>();
    w.i64s(
        "coordinate_node",
        &[n],
        of(|c| i64::from(c.node)).into_iter(),
    )
    .unwrap();
    let directions = of(|c| i64::from(c.direction));
    w.i64s("coordinate_direction", &[n], directions.into_iter())
        .unwrap();
    for (name, e) in ["stiffness", "mass"].into_iter().zip(entries(a)) {
        let count = [e.len()];
        let of = |part: &str| format!("{name}_{part}");
        w.i64s(&of("rows"), &count, e.iter().map(|e| e.0 as i64))
            .unwrap();
        w.i64s(&of("columns"), &count, e.iter().map(|e| e.1 as i64))
            .unwrap();
        w.f64s(&of("values"), &count, e.iter().map(|e| e.2))
            .unwrap();
    }
    if let Some(shapes) = shapes {
        let all = (0..n).flat_map(|i| shapes.iter().map(move |s| s[i]));
        w.f64s("shapes", &[n, shapes.len()], all).unwrap();
        let frequencies = (0..shapes.len()).map(|i| i as f64);
        w.f64s("frequencies_hz", &[shapes.len()], frequencies)
            .unwrap();
    }
    w.finish().unwrap()
}

/// Mode shapes as CalculiX writes them to an `.frd` file: six digits without blanks between.
pub fn frd(shapes: &[Vec<f64>], frequencies: &[f64]) -> String {
    let nodes = shapes[0].len() / 3;
    let mut text = String::from("    1C\n    1UPGM               CalculiX\n");
    writeln!(text, "    2C{nodes:30}{:38}", 1).unwrap();
    for node in 1..=nodes {
        writeln!(text, " -1{node:10}{0:>12}{0:>12}{0:>12}", c_number(0.0, 5)).unwrap();
    }
    writeln!(text, " -3").unwrap();
    for (mode, (shape, f)) in (1..).zip(shapes.iter().zip(frequencies)) {
        writeln!(text, "    1PMODE{mode:26}").unwrap();
        writeln!(
            text,
            "  100CL  {:3} {f:11.5E}{nodes:12}{:21}{mode:5}MODAL{:7}",
            100 + mode,
            2,
            1
        )
        .unwrap();
        writeln!(
            text,
            " -4  DISP        4    1\n -5  D1          1    2    1    0"
        )
        .unwrap();
        for (node, u) in (1..).zip(shape.chunks_exact(3)) {
            let words: String = u
                .iter()
                .map(|u| format!("{:>12}", c_number(*u, 5).to_uppercase()))
                .collect();
            writeln!(text, " -1{node:10}{words}").unwrap();
        }
        writeln!(text, " -3").unwrap();
        // Stresses beside them.
        writeln!(
            text,
            " -4  STRESS      6    1\n -1{:10}{:>12}\n -3",
            1, "1.0E+00"
        )
        .unwrap();
    }
    text.push_str(" 9999\n");
    text
}

/// Tables of displacements in a `.dat` file of CalculiX.
pub fn dat(shapes: &[Vec<f64>], frequencies: &[f64]) -> String {
    let mut text = String::from("\n     E I G E N V A L U E   O U T P U T\n\n");
    for (mode, f) in (1..).zip(frequencies) {
        writeln!(
            text,
            "{mode:7}  {0:14.7E} {0:14.7E} {f:14.7E} {1:14.7E}",
            1.0, 0.0
        )
        .unwrap();
    }
    text.push_str("\n     P A R T I C I P A T I O N   F A C T O R S\n\n      1  0.1E+00  0.1E+00  0.1E+00  0.1E+00\n");
    for (shape, f) in shapes.iter().zip(frequencies) {
        writeln!(
            text,
            "\n displacements (vx,vy,vz) for set NALL and time  {f:14.7E}\n"
        )
        .unwrap();
        for (node, u) in (1..).zip(shape.chunks_exact(3)) {
            writeln!(
                text,
                "{node:10} {:14.6E} {:14.6E} {:14.6E}",
                u[0], u[1], u[2]
            )
            .unwrap();
        }
    }
    text
}

/// Tables of Abaqus: two pages for each mode, five digits.
pub fn abaqus_dat(shapes: &[Vec<f64>], frequencies: &[f64]) -> String {
    let mut text =
        String::from("\n                              E I G E N V A L U E    O U T P U T\n\n");
    text.push_str(" MODE NO      EIGENVALUE              FREQUENCY         GENERALIZED MASS   COMPOSITE MODAL DAMPING\n");
    text.push_str("                             (RAD/TIME)   (CYCLES/TIME)\n\n");
    for (mode, f) in (1..).zip(frequencies) {
        writeln!(
            text,
            "{mode:8}  {:12.5} {:12.5} {f:12.5} {:12.5} {:12.5}",
            1.0, 1.0, 1.0, 0.0
        )
        .unwrap();
    }
    for (mode, shape) in (1..).zip(shapes) {
        writeln!(
            text,
            "\n                    E I G E N V A L U E    N U M B E R   {mode:4}\n"
        )
        .unwrap();
        let half = shape.len() / 6 * 3;
        for (first, part) in [(1, &shape[..half]), (1 + half / 3, &shape[half..])] {
            text.push_str(
                "   THE FOLLOWING TABLE IS PRINTED FOR NODES BELONGING TO NODE SET NALL\n\n",
            );
            text.push_str(
                "       NODE FOOT-   U1             U2             U3     \n            NOTE  \n\n",
            );
            for (node, u) in (first..).zip(part.chunks_exact(3)) {
                writeln!(
                    text,
                    "{node:11}      {:14.4E} {:14.4E} {:14.4E}",
                    u[0], u[1], u[2]
                )
                .unwrap();
            }
            text.push_str("\n MAXIMUM              1.0            1.0            1.0\n AT NODE             1              1              1\n");
        }
    }
    text
}
