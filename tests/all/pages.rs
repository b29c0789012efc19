//! The pages of the project: every block of README, TESTING and `docs/` is run, or says why it is not, and what a page
//! quotes is what the program says. `CONTRIBUTING.md` has how to mark a block.

mod block;
mod compare;
mod mistakes;
mod run;

use block::Page;
use run::{Kit, Outcome, unmarked};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Every page, from the root of the repository.
fn pages() -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = vec!["README.md".to_string(), "TESTING.md".into(), "CONTRIBUTING.md".into()];
    let mut folders = vec![PathBuf::from("docs")];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(root.join(&folder)).unwrap() {
            let path = folder.join(entry.unwrap().file_name());
            if root.join(&path).is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|end| end == "md") {
                found.push(path.display().to_string());
            }
        }
    }
    found.sort();
    found
}

fn read(path: &str) -> Result<Page, Vec<String>> {
    Page::parse(path, &fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap())
}

#[test]
fn every_block_of_a_page_is_run_or_says_why_not() {
    let faults: Vec<String> = pages()
        .iter()
        .flat_map(|path| match read(path) {
            Ok(page) => unmarked(&page),
            Err(mistakes) => mistakes,
        })
        .collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn what_a_page_shows_is_what_the_program_does() {
    let kit = Kit::new();
    let only = std::env::var("RATETABLE_PAGE").ok();
    let pages: Vec<_> =
        pages().into_iter().filter(|path| only.as_ref().is_none_or(|only| path.contains(only))).collect();
    let queue = Mutex::new(pages.iter());
    let total = Mutex::new(Outcome::default());
    std::thread::scope(|scope| {
        for _ in 0..3 {
            scope.spawn(|| {
                while let Some(path) = { queue.lock().unwrap().next() } {
                    let Ok(page) = read(path) else { continue };
                    let begun = std::time::Instant::now();
                    let outcome = run::run(&page, &kit);
                    eprintln!("{path}: {} run in {:.1} s", outcome.run, begun.elapsed().as_secs_f64());
                    let mut total = total.lock().unwrap();
                    total.run += outcome.run;
                    total.faults.extend(outcome.faults);
                    total.left.extend(outcome.left);
                }
            });
        }
    });
    let total = total.into_inner().unwrap();
    eprintln!("{} blocks run; left out:\n{}", total.run, total.left.join("\n"));
    assert!(
        total.faults.is_empty(),
        "{} blocks do not hold:\n\n{}",
        total.faults.len(),
        total.faults.join("\n\n")
    );
    assert!(only.is_some() || total.run >= 35, "{} blocks were run", total.run);
}

/// What is wrong with a page of this text.
fn faults(text: &str) -> Vec<String> {
    match Page::parse("page.md", text) {
        Ok(page) => run::run(&page, &Kit::new()).faults,
        Err(mistakes) => mistakes,
    }
}

const RIGHT: &str = "# A page

    $ ratetable check still --set gyro.rate='1 m'
    --set gyro.rate=1 m: `rate`: `1 m` is a length, but a rate is required, such as \"100 Hz\"

<!-- test: exit 2 -->
```sh
ratetable run nowhere
```

<!-- test: output -->
```text
nowhere: this is neither a scene file …
```

```sh
ratetable generate still --set 'duration=1 s' --out flight
```

<!-- test: output; tolerance 5 % -->
```text
flight: 1 s of scene, 3150 rows …
```

<!-- test: before duration = \"1 s\" -->
```toml
[gyro]
rate = \"1 kHz\"
```

<!-- test: skip, of another program -->
```
save
```
";

#[test]
fn a_page_that_is_right_passes_and_one_that_is_wrong_in_anything_does_not() {
    let marked = RIGHT.replacen("# A page\n", "# A page\n\n<!-- test: exit 2 -->\n", 1);
    assert_eq!(faults(&marked), Vec::<String>::new());
    for (right, wrong, what) in [
        ("`1 m` is a length", "`1 m` is a width", "a wrong output"),
        ("3150 rows", "3500 rows", "a wrong number"),
        ("<!-- test: skip, of another program -->\n", "", "a block without a mark"),
        ("skip, of another program", "skip", "a skip without a reason"),
        ("rate = \"1 kHz\"", "rate = 1", "a scene that cannot be"),
        ("still --set 'duration", "stil --set 'duration", "a command that fails"),
        ("<!-- test: exit 2 -->\n```sh", "```sh", "an exit code that is not expected"),
        ("output; tolerance", "output; tolerence", "a mark that is none"),
    ] {
        let page = marked.replacen(right, wrong, 1);
        assert_ne!(page, marked, "{what}");
        assert!(!faults(&page).is_empty(), "{what} is not found");
    }
}
