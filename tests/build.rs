//! Compiles the logger: a variadic function cannot be defined in Rust.

fn main() {
    println!("cargo::rerun-if-changed=source/logger.c");
    cc::Build::new().file("source/logger.c").compile("plimsoll_test_logger");
}
