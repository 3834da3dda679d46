//! Couples a fluid and a structure, two FMI 2.0 FMUs; `plimsoll --help` says how.

fn main() -> std::process::ExitCode {
    plimsoll::command::main()
}
