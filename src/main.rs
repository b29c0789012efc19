//! Arguments to one call; what went wrong to standard error.

fn main() -> std::process::ExitCode {
    ratetable::cli::main()
}
