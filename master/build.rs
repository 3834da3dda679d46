//! Compiles the logger shim: a C-variadic callback cannot be defined in stable Rust.

fn main() {
    println!("cargo::rerun-if-changed=source/logger.c");
    cc::Build::new().file("source/logger.c").warnings(true).compile("plimsoll_logger");
}
