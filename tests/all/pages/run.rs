//! A page's blocks, run one after another in a folder of its own.

use super::block::{Block, Exit, Marks, Page};
use super::compare::compare;
use std::env;
use std::ffi::OsString;
use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// The longest that one block may take: what takes longer is no example for a page.
const LONGEST: Duration = Duration::from_secs(120);

/// What pages are run with.
pub struct Kit {
    /// Folders of the programs, before those of the machine.
    path: OsString,
    /// Python with what the tests of other readers need.
    python: Option<PathBuf>,
    root: PathBuf,
    _tools: tempfile::TempDir,
}

impl Kit {
    /// The programs of this build, and a `cargo` that stands for them: it runs what is built already.
    pub fn new() -> Kit {
        let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
        let tools = tempfile::tempdir().unwrap();
        let bin = assert_cmd::cargo::cargo_bin("ratetable");
        symlink(&bin, tools.path().join("ratetable")).unwrap();
        let cargo = "#!/bin/sh\ncase \"$1\" in\nrun) shift; while [ \"$1\" != -- ]; do shift; done; shift; exec ratetable \"$@\";;\nbuild|install) exit 0;;\n*) echo \"no cargo here\" >&2; exit 2;;\nesac\n";
        let shim = tools.path().join("cargo");
        fs::write(&shim, cargo).unwrap();
        fs::set_permissions(&shim, fs::Permissions::from_mode(0o755)).unwrap();
        if let Some(python) = env::var_os("RATETABLE_PYTHON") {
            let shim = tools.path().join("python3");
            fs::write(&shim, format!("#!/bin/sh\nexec {} \"$@\"\n", PathBuf::from(&python).display()))
                .unwrap();
            fs::set_permissions(&shim, fs::Permissions::from_mode(0o755)).unwrap();
        }
        let others = env::var_os("PATH").unwrap_or_default();
        let path = env::join_paths([tools.path().to_path_buf()].into_iter().chain(env::split_paths(&others)))
            .unwrap();
        let python = env::var_os("RATETABLE_PYTHON").map(PathBuf::from);
        assert!(
            python.is_some() || env::var_os("RATETABLE_REQUIRE_PYTHON").is_none(),
            "RATETABLE_PYTHON is not set"
        );
        Kit { path, python, root, _tools: tools }
    }

    /// A folder that looks like the root of the repository after a build.
    fn folder(&self) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for name in ["scenes", "docs", "benches", "firmware-host-tests", "protocols"] {
            symlink(self.root.join(name), folder.path().join(name)).unwrap();
        }
        let built = folder.path().join("target/debug");
        fs::create_dir_all(&built).unwrap();
        let program = assert_cmd::cargo::cargo_bin("ratetable");
        symlink(program.with_file_name("board"), built.join("board")).unwrap();
        symlink(&program, built.join("ratetable")).unwrap();
        symlink(built.join("board"), folder.path().join("firmware")).unwrap();
        folder
    }

    fn has_program(&self, program: &str) -> bool {
        env::split_paths(&self.path).any(|folder| folder.join(program).is_file())
    }

    fn has_module(&self, module: &str) -> bool {
        let Some(python) = &self.python else { return false };
        let status =
            Command::new(python).arg("-c").arg(format!("import {module}")).stderr(Stdio::null()).status();
        status.is_ok_and(|status| status.success())
    }
}

/// What became of a page.
#[derive(Debug, Default)]
pub struct Outcome {
    /// Each block that does not hold, with its place.
    pub faults: Vec<String>,
    /// How many blocks were run.
    pub run: usize,
    /// Those that were not, each with its place and why.
    pub left: Vec<String>,
}

/// The marks of each block alone: whether it is run, or says why not.
pub fn unmarked(page: &Page) -> Vec<String> {
    let known = ["sh", "bash", "console", "toml", "python", "c"];
    let fault = |block: &&Block| {
        let has_way = known.contains(&&*block.language) || (block.language == "text" && block.marks.output);
        !has_way && block.marks.skip.is_none()
    };
    let faults = page.blocks.iter().filter(fault);
    faults
        .map(|block| {
            format!(
                "{}:{}: a block of `{}` that no test runs: mark it `<!-- test: output -->` where it quotes the commands before it, or `<!-- test: skip, WHY -->`",
                page.path, block.line, block.language
            )
        })
        .collect()
}

/// Runs a page.
pub fn run(page: &Page, kit: &Kit) -> Outcome {
    let mut outcome = Outcome { faults: unmarked(page), ..Outcome::default() };
    let folder = kit.folder();
    let mut job = Job { page, kit, folder: folder.path(), said: String::new(), python: String::new() };
    for command in &page.setup {
        let (code, said) = job.shell(command);
        if code != Some(0) {
            outcome.faults.push(format!("{}: setup `{command}`: {said}", page.path));
        }
    }
    for block in &page.blocks {
        let place = format!("{}:{}", page.path, block.line);
        let leave = block.marks.leave.iter();
        outcome.left.extend(leave.map(|(line, why)| format!("{place}, the line with {line}: {why}")));
        if let Some(why) = &block.marks.skip {
            job.keep(block);
            outcome.left.push(format!("{place}: {why}"));
            continue;
        }
        match job.block(block) {
            Ok(None) => outcome.run += 1,
            Ok(Some(why)) => outcome.left.push(format!("{place}: {why}")),
            Err(why) => outcome.faults.push(format!("{place}: {why}")),
        }
    }
    outcome
}

struct Job<'a> {
    page: &'a Page,
    kit: &'a Kit,
    folder: &'a Path,
    /// What the last commands said.
    said: String,
    /// The Python of the page so far.
    python: String,
}

impl Job<'_> {
    /// Puts a block into the folder under the name that it is marked with.
    fn keep(&self, block: &Block) {
        if let Some(name) = &block.marks.file {
            fs::write(self.folder.join(name), whole(block)).unwrap();
        }
    }

    /// Runs a block: why it was not, or what is wrong with it.
    fn block(&mut self, block: &Block) -> Result<Option<String>, String> {
        self.keep(block);
        if let Some(module) = block.marks.needs.as_ref().filter(|module| !self.kit.has_module(module)) {
            return Ok(Some(format!("there is no Python with {module}")));
        }
        if let Some(program) = block.marks.programs.iter().find(|program| !self.kit.has_program(program)) {
            assert!(env::var_os("RATETABLE_REQUIRE_C").is_none(), "there is no `{program}`");
            return Ok(Some(format!("there is no `{program}`")));
        }
        match block.language.as_str() {
            "sh" | "bash" => self.commands(&block.text, &block.marks).map(|()| None),
            "console" => self.console(block).map(|()| None),
            "toml" => self.scene(block).map(|()| None),
            "python" => self.python(block),
            "c" => self.c(block),
            "text" if block.marks.output => compare(&block.text, &self.said, block.marks.numbers)
                .map_err(|why| self.with_said(&why))
                .map(|()| None),
            _ => Ok(None),
        }
    }

    fn with_said(&self, why: &str) -> String {
        format!("{why}\n    in all that was said:\n{}", self.said)
    }

    /// Runs commands as bash does a script, up to the first that fails.
    fn commands(&mut self, text: &str, marks: &Marks) -> Result<(), String> {
        let is_left = |line: &&str| marks.leave.iter().any(|(what, _)| line.contains(what.as_str()));
        let text: String =
            text.lines().filter(|line| !is_left(line)).map(|line| format!("{line}\n")).collect();
        let (code, said) = self.shell(&text);
        self.said = said;
        let right = match marks.exit {
            Exit::Code(expected) => code == Some(expected),
            Exit::DoneOrLost => matches!(code, Some(0 | 1)),
        };
        if right { Ok(()) } else { Err(self.with_said(&format!("`{}` ended with {code:?}", text.trim()))) }
    }

    /// Commands after `$ `, each followed by what it says.
    fn console(&mut self, block: &Block) -> Result<(), String> {
        let mut lines = block.text.lines().peekable();
        while let Some(line) = lines.next() {
            let mut command = line.strip_prefix("$ ").ok_or("a console begins with `$ COMMAND`")?.to_string();
            while command.ends_with('\\') {
                command = format!("{command}\n{}", lines.next().unwrap_or_default());
            }
            let mut quoted = String::new();
            while let Some(line) = lines.next_if(|line| !line.starts_with("$ ")) {
                quoted += &format!("{line}\n");
            }
            // `echo $?` tells of the command before: each is a script of its own, so it is looked at here.
            let asks = lines.peek().is_some_and(|line| *line == "$ echo $?");
            let exit = if asks { None } else { Some(block.marks.exit) };
            let (code, said) = self.shell(&command);
            self.said = said;
            if asks {
                lines.next();
                let told = lines.next().unwrap_or_default();
                if code.map(|code| code.to_string()).as_deref() != Some(told) {
                    return Err(self.with_said(&format!("`{command}` ended with {code:?}, not {told}")));
                }
            } else if let Some(Exit::Code(expected)) = exit
                && code != Some(expected)
            {
                return Err(self.with_said(&format!("`{command}` ended with {code:?}")));
            }
            compare(&quoted, &self.said, block.marks.numbers).map_err(|why| self.with_said(&why))?;
        }
        Ok(())
    }

    /// A scene, or what its fragment is part of, that `check` accepts.
    fn scene(&mut self, block: &Block) -> Result<(), String> {
        let name = block.marks.file.clone().unwrap_or_else(|| "block.toml".into());
        fs::write(self.folder.join(&name), whole(block)).map_err(|error| error.to_string())?;
        self.commands(&format!("ratetable check {name} > /dev/null"), &block.marks)
    }

    fn python(&mut self, block: &Block) -> Result<Option<String>, String> {
        let Some(python) = &self.kit.python else { return Ok(Some("no RATETABLE_PYTHON".into())) };
        let before = if block.marks.continues { std::mem::take(&mut self.python) } else { String::new() };
        self.python = before + &whole(block);
        fs::write(self.folder.join("block.py"), &self.python).map_err(|error| error.to_string())?;
        self.commands(&format!("{} block.py", python.display()), &block.marks).map(|()| None)
    }

    fn c(&mut self, block: &Block) -> Result<Option<String>, String> {
        if Command::new("cc").arg("--version").stdout(Stdio::null()).status().is_err() {
            return Ok(Some("no C compiler".into()));
        }
        fs::write(self.folder.join("block.c"), whole(block)).map_err(|error| error.to_string())?;
        self.commands("cc -std=c99 -Wall -Wextra -Werror -c block.c", &block.marks).map(|()| None)
    }

    /// Exit code, and both streams as they came.
    fn shell(&self, text: &str) -> (Option<i32>, String) {
        let said = self.folder.join(".said");
        let file = fs::File::create(&said).unwrap();
        let mut command = Command::new("timeout");
        command.arg(LONGEST.as_secs().to_string()).args(["bash", "-e", "-c", text]).current_dir(self.folder);
        command.env("PATH", &self.kit.path).stdin(Stdio::null());
        command.stdout(file.try_clone().unwrap()).stderr(file);
        let begun = Instant::now();
        let code = command.status().unwrap().code();
        let said = fs::read(&said).unwrap();
        // What this machine does not grant is of this machine.
        let said = String::from_utf8_lossy(&said)
            .lines()
            .filter(|line| !line.starts_with("notice: not granted"))
            .map(|line| format!("{line}\n"))
            .collect::<String>();
        if begun.elapsed() >= LONGEST {
            return (
                None,
                format!("{said}… it took longer than {} s ({})\n", LONGEST.as_secs(), self.page.path),
            );
        }
        (code, said)
    }
}

/// A block with the lines that it needs around it.
fn whole(block: &Block) -> String {
    format!("{}{}{}", block.marks.before, block.text, block.marks.after)
}
