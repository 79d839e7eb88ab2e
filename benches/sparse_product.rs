//! Cost of a product `y = K x` compared with one read of its bytes: `cargo bench --bench sparse_product`.
//!
//! The bound is the time of one pass over an array of as many bytes as the matrix stores, in the same run:
//! a sum (reads only), by turns with the product. Beside it: assembly, and the product with
//! the mass.
//!
//! The product needs some 56 instructions per 3x3 block (36 of them arithmetic, two numbers at once where the
//! compiler can): from the second-level cache these take longer than reading, from memory they hide behind it.

mod support;

use gearbench_models::Vec3;
use gearbench_models::stiffness::Material;
use gearbench_reference::assembly::{Assembly, assemble};
use gearbench_reference::deck::read;
use gearbench_reference::gear_deck::gears;
use gearbench_reference::mesh::{ElementKind, Mesh};
use std::hint::black_box;
use support::ratio::{Ratios, by_turns, median, ratios, seconds};

/// Returns a box of `cells` eight-node elements of 1 mm.
fn brick(cells: [u32; 3]) -> Mesh {
    let at = |x, y, z| (x * (cells[1] + 1) + y) * (cells[2] + 1) + z;
    let mut nodes = Vec::new();
    for x in 0..=cells[0] {
        for y in 0..=cells[1] {
            for z in 0..=cells[2] {
                nodes.push(1e-3 * Vec3::new(x.into(), y.into(), z.into()));
            }
        }
    }
    let mut connectivity = Vec::new();
    for x in 0..cells[0] {
        for y in 0..cells[1] {
            for z in 0..cells[2] {
                for z in [z, z + 1] {
                    connectivity.extend([
                        at(x, y, z),
                        at(x + 1, y, z),
                        at(x + 1, y + 1, z),
                        at(x, y + 1, z),
                    ]);
                }
            }
        }
    }
    Mesh::new(ElementKind::C3D8, nodes, connectivity)
}

/// Reads an array once and returns its sum.
fn sum(x: &[f64]) -> f64 {
    let (chunks, rest) = x.as_chunks::<32>();
    let mut lanes = [0.0; 32];
    for c in chunks {
        for (l, x) in lanes.iter_mut().zip(c) {
            *l += x;
        }
    }
    lanes.iter().sum::<f64>() + rest.iter().sum::<f64>()
}

/// Measures and formats a row of the table.
fn report(criterion: &mut Ratios, name: &str, mesh: &Mesh) -> String {
    let (mut times, mut last) = (Vec::new(), None);
    for _ in 0..5 {
        times.push(seconds(|| last = Some(assemble(mesh, &Material::STEEL))));
    }
    let assembling = median(times);
    let Some(Ok(a)) = last else {
        return format!("{name}: an element is turned inside out");
    };
    let Assembly {
        stiffness, mass, ..
    } = &a;
    let n = 3 * mesh.nodes.len();
    let x: Vec<f64> = (0..n).map(|i| (0.7 * i as f64).sin()).collect();
    let mut y = vec![0.0; n];
    let stream = vec![1.0; stiffness.bytes() / 8];
    let mut of_mass = f64::INFINITY;
    let [product, pass] = by_turns(criterion, "product / pass", name, || {
        let pass = seconds(|| sum(black_box(&stream)));
        let product = seconds(|| stiffness.apply(black_box(&x), black_box(&mut y)));
        of_mass = of_mass.min(seconds(|| mass.apply(black_box(&x), black_box(&mut y))));
        [product, pass]
    });
    format!(
        "{name:<20} {:>7} {:>8.1} {:>10.1} {:>10.1} {:>10.1} {:>6.2} {:>7.1} {:>10.1} {:>10.1}",
        n,
        stiffness.bytes() as f64 / 1e6,
        1e3 * assembling,
        1e6 * pass,
        1e6 * product,
        product / pass,
        stiffness.bytes() as f64 / product / 1e9,
        1e9 * product / stiffness.entries().len() as f64,
        1e6 * of_mass,
    )
}

#[allow(clippy::print_stdout)]
fn main() {
    let mut criterion = ratios(2.0);
    let mut rows = Vec::new();
    let deck = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../reference/calculix/case-a-fine/AF8_d05.inp.gz"
    );
    match read(deck).and_then(|deck| gears(&deck)) {
        Ok(found) => {
            for (i, gear) in found.iter().enumerate() {
                rows.push(report(
                    &mut criterion,
                    &format!("case A fine, gear {}", i + 1),
                    &gear.mesh.mesh,
                ));
            }
        }
        Err(error) => rows.push(error.to_string()),
    }
    rows.push(report(
        &mut criterion,
        "brick 30x30x22",
        &brick([30, 30, 22]),
    ));
    rows.push(report(
        &mut criterion,
        "brick 60x50x40",
        &brick([60, 50, 40]),
    ));
    println!(
        "{:<20} {:>7} {:>8} {:>10} {:>10} {:>10} {:>6} {:>7} {:>10} {:>10}",
        "mesh", "dof", "MB", "assemble", "pass", "K x", "ratio", "GB/s", "ns/block", "M x"
    );
    println!(
        "{:<20} {:>7} {:>8} {:>10} {:>10} {:>10} {:>6} {:>7} {:>10} {:>10}",
        "", "", "", "ms", "us", "us", "", "", "", "us"
    );
    println!("{}", rows.join("\n"));
}
