//! The crate's example ends well. `cargo test` has built it.

use std::process::Command;

#[test]
fn the_example_ends_well() {
    // This test lies in `deps`, beside `examples`.
    let built = std::env::current_exe().unwrap();
    let example = built.ancestors().nth(2).unwrap().join("examples/packets");
    let ran = Command::new(&example).output().unwrap_or_else(|error| panic!("{example:?}: {error}"));
    assert!(ran.status.success() && !ran.stdout.is_empty(), "{}", String::from_utf8_lossy(&ran.stderr));
}
