//! The library's examples end well. `cargo test` has built them.

use std::process::Command;

#[test]
fn each_example_ends_well() {
    for name in ["dataset_in_memory", "stream_own_sensor"] {
        // This test lies in `deps`, beside `examples`.
        let built = std::env::current_exe().unwrap();
        let example = built.ancestors().nth(2).unwrap().join("examples").join(name);
        let ran = Command::new(&example).output().unwrap_or_else(|error| panic!("{example:?}: {error}"));
        assert!(ran.status.success(), "{name}: {}", String::from_utf8_lossy(&ran.stderr));
        assert!(!ran.stdout.is_empty() || !ran.stderr.is_empty(), "{name} says something");
    }
}
