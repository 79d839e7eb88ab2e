//! Stamps the commit into the extension module.

#[path = "../benchmarks/src/experiment/checkout.rs"]
mod checkout;

fn main() {
    let commit = checkout::commit_of_checkout();
    println!("cargo:rustc-env=GEARBENCH_COMMIT={commit}");
    println!("cargo:rerun-if-env-changed={}", checkout::COMMIT_VARIABLE);
    for path in [
        "../.git/HEAD",
        "../.git/index",
        "../benchmarks/src/experiment/checkout.rs",
    ] {
        if std::path::Path::new(path).exists() {
            println!("cargo:rerun-if-changed={path}");
        }
    }
}
