//! The page: one file, put together from its parts when it is first asked for.

use std::sync::LazyLock;

const HTML: &str = include_str!("page/page.html");
const STYLE: &str = include_str!("page/style.css");
/// In the order in which they are run.
const SCRIPTS: [&str; 0] = [];

/// The page without anything in it: it asks for what it shows.
pub(super) static PAGE: LazyLock<String> =
    LazyLock::new(|| HTML.replace("/*style*/", STYLE).replace("/*script*/", &SCRIPTS.concat()));

/// The page with these messages in it: it asks for nothing.
pub(super) fn with(messages: &[String]) -> String {
    // In a script, only this would end it.
    let messages = messages.join(",\n").replace("</", "<\\/").replace("<!--", "<\\u0021--");
    let inside = format!("<script type=\"application/json\" id=\"messages\">[{messages}]</script>");
    PAGE.replace("<!--messages-->", &inside)
}
