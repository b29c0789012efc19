//! The blocks of a page and what is said of each.

/// A page: where it is and what stands in it.
#[derive(Debug)]
pub struct Page {
    /// From the root of the repository.
    pub path: String,
    pub blocks: Vec<Block>,
    /// Commands that prepare its folder.
    pub setup: Vec<String>,
}

/// A block of code, fenced or, where it holds commands, indented.
#[derive(Debug)]
pub struct Block {
    /// The line of its first line of text.
    pub line: usize,
    /// `sh`, `text`, …; empty where none is given.
    pub language: String,
    pub text: String,
    pub marks: Marks,
}

/// What the comment before a block says: `<!-- test: exit 2; tolerance 5 % -->`.
#[derive(Debug, Default, PartialEq)]
pub struct Marks {
    /// Why it is not run.
    pub skip: Option<String>,
    /// Lines with this in them are not run, and why.
    pub leave: Vec<(String, String)>,
    /// The block quotes what the last commands before it printed.
    pub output: bool,
    pub numbers: Numbers,
    /// The exit code that the commands end with.
    pub exit: Exit,
    /// What the page's folder calls it.
    pub file: Option<String>,
    /// Lines that a fragment needs before and after it.
    pub before: String,
    pub after: String,
    /// It goes on where the page's block of the same language before it ends.
    pub continues: bool,
    /// A module of Python that not every machine has.
    pub needs: Option<String>,
    /// Programs that not every machine has.
    pub programs: Vec<String>,
}

/// How numbers are compared.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Numbers {
    #[default]
    Exact,
    /// Parts of the larger one.
    Within(f64),
    /// Measured on some machine, and other on others.
    Vary,
}

/// An exit code.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exit {
    Code(i32),
    /// Whatever the machine makes of it: a run in real time may lose samples on a busy one.
    DoneOrLost,
}

impl Default for Exit {
    fn default() -> Exit {
        Exit::Code(0)
    }
}

const BEGIN: &str = "<!-- test:";

impl Marks {
    /// Adds what a comment says.
    fn add(&mut self, text: &str) -> Result<(), String> {
        if let Some(reason) = text.trim().strip_prefix("skip") {
            let reason = reason.trim_start_matches(',').trim();
            if reason.len() < 5 {
                return Err("a block that is skipped says why: `skip, needs a port`".into());
            }
            self.skip = Some(reason.to_string());
            return Ok(());
        }
        // What a fragment needs may have semicolons in it.
        if ["before ", "after "].iter().any(|word| text.trim().starts_with(word)) {
            return self.add_one(text.trim());
        }
        text.split(';').try_for_each(|mark| self.add_one(mark.trim()))
    }

    fn add_one(&mut self, mark: &str) -> Result<(), String> {
        let (word, rest) = mark.split_once(' ').unwrap_or((mark, ""));
        let lines = |rest: &str| rest.split(" | ").map(|line| format!("{line}\n")).collect::<String>();
        match (word, rest.trim()) {
            ("output", "") => self.output = true,
            ("leave", line) => {
                let (line, why) =
                    line.split_once(", ").ok_or("write `leave WHAT STANDS IN THE LINE, WHY`")?;
                self.leave.push((line.to_string(), why.to_string()));
            }
            ("numbers", "vary") => self.numbers = Numbers::Vary,
            ("tolerance", share) => {
                let share = share.strip_suffix('%').and_then(|share| share.trim().parse::<f64>().ok());
                let share = share.filter(|share| *share > 0.0 && *share < 100.0);
                self.numbers = Numbers::Within(share.ok_or("write `tolerance 5 %`")? / 100.0);
            }
            ("exit", "0 or 1") => self.exit = Exit::DoneOrLost,
            ("exit", code) => {
                self.exit = Exit::Code(code.parse().map_err(|_| "write `exit 2` or `exit 0 or 1`")?)
            }
            ("file", name) if !name.is_empty() => self.file = Some(name.to_string()),
            ("before", text) if !text.is_empty() => self.before = lines(text),
            ("after", text) if !text.is_empty() => self.after = lines(text),
            ("continues", "") => self.continues = true,
            ("needs", module) if !module.is_empty() => self.needs = Some(module.to_string()),
            ("programs", names) if !names.is_empty() => {
                self.programs = names.split_whitespace().map(String::from).collect();
            }
            _ => return Err(format!("`{mark}` is no mark of a block")),
        }
        Ok(())
    }
}

/// Begins a command in an indented block; others there are no commands.
const COMMANDS: [&str; 6] = ["$ ", "ratetable ", "cargo ", "target/", "python", "sudo "];

impl Page {
    /// Reads a page's text.
    ///
    /// # Errors
    /// Every mark that says nothing, each with its line.
    pub fn parse(path: &str, text: &str) -> Result<Page, Vec<String>> {
        let lines: Vec<&str> = text.lines().collect();
        let mut page = Page { path: path.to_string(), blocks: Vec::new(), setup: Vec::new() };
        let (mut mistakes, mut marks) = (Vec::new(), Marks::default());
        let mut i = 0;
        while i < lines.len() {
            let line = lines[i];
            if let Some(mark) = line.trim().strip_prefix(BEGIN).and_then(|rest| rest.strip_suffix("-->")) {
                match mark.trim().strip_prefix("setup ") {
                    Some(command) => page.setup.push(command.to_string()),
                    None => {
                        mistakes.extend(marks.add(mark).err().map(|why| format!("{path}:{}: {why}", i + 1)))
                    }
                }
                i += 1;
            } else if let Some(language) = line.trim_start().strip_prefix("```") {
                let from = i + 1;
                let indent = line.len() - line.trim_start().len();
                let length = lines[from..].iter().take_while(|line| line.trim() != "```").count();
                let text = lines[from..from + length].iter();
                let text = text.map(|line| format!("{}\n", line.get(indent..).unwrap_or_default())).collect();
                let language = language.trim().to_string();
                page.blocks.push(Block { line: from + 1, language, text, marks: std::mem::take(&mut marks) });
                i = from + length + 1;
            } else if let Some(length) =
                indented(&lines[i..]).filter(|_| i == 0 || lines[i - 1].trim().is_empty())
            {
                let text: String = lines[i..i + length]
                    .iter()
                    .map(|line| format!("{}\n", line.get(4..).unwrap_or_default()))
                    .collect();
                if COMMANDS.iter().any(|begin| text.starts_with(begin)) {
                    let language = if text.starts_with("$ ") { "console" } else { "sh" }.to_string();
                    page.blocks.push(Block {
                        line: i + 1,
                        language,
                        text,
                        marks: std::mem::take(&mut marks),
                    });
                }
                i += length;
            } else {
                if !line.trim().is_empty() && marks != Marks::default() {
                    mistakes.push(format!("{path}:{}: a mark stands before no block", i + 1));
                    marks = Marks::default();
                }
                i += 1;
            }
        }
        if mistakes.is_empty() { Ok(page) } else { Err(mistakes) }
    }
}

/// How many of these lines are an indented block, blank ones between included.
fn indented(lines: &[&str]) -> Option<usize> {
    let is_code = |line: &str| line.starts_with("    ");
    let within = lines.iter().take_while(|line| is_code(line) || line.trim().is_empty()).count();
    let length = lines[..within].iter().rposition(|line| is_code(line))? + 1;
    is_code(lines[0]).then_some(length)
}
