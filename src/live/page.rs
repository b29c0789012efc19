//! The page: one file, put together from its parts when it is first asked for.

use std::sync::LazyLock;

const HTML: &str = include_str!("page/page.html");
const STYLE: &str = include_str!("page/style.css");
/// In the order in which they are run.
const SCRIPTS: [&str; 21] = [
    include_str!("page/format.js"),
    include_str!("page/dom.js"),
    include_str!("page/series.js"),
    include_str!("page/store.js"),
    include_str!("page/view.js"),
    include_str!("page/axes.js"),
    include_str!("page/rotation.js"),
    include_str!("page/attitude.js"),
    include_str!("page/errors.js"),
    include_str!("page/strips.js"),
    include_str!("page/rates.js"),
    include_str!("page/lateness.js"),
    include_str!("page/links.js"),
    include_str!("page/timeline.js"),
    include_str!("page/notices.js"),
    include_str!("page/tables.js"),
    include_str!("page/charts.js"),
    include_str!("page/keys.js"),
    include_str!("page/header.js"),
    include_str!("page/main.js"),
    include_str!("page/socket.js"),
];

/// The page without anything in it: it asks for what it shows.
pub(super) static PAGE: LazyLock<String> =
    LazyLock::new(|| HTML.replace("/*style*/", STYLE).replace("/*script*/", &SCRIPTS.concat()));

/// The page with these messages in it: it asks for nothing.
pub(super) fn with(messages: &[String]) -> String {
    // Nothing in a script ends it, or begins another, without this.
    let messages = messages.join(",\n").replace('<', "\\u003c");
    let inside = format!("<script type=\"application/json\" id=\"messages\">[{messages}]</script>");
    PAGE.replace("<!--messages-->", &inside)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_is_one_small_file_that_asks_for_nothing_elsewhere() {
        assert!(PAGE.len() < 150_000, "{}", PAGE.len());
        assert!(!PAGE.contains("/*style*/") && !PAGE.contains("/*script*/"));
        for outside in ["http://", "https://", "src=", "@import", "url("] {
            let found =
                PAGE.match_indices(outside).map(|(i, _)| PAGE[i..].chars().take(60).collect::<String>());
            let found: Vec<_> = found.filter(|text| !text.starts_with("http://www.w3.org/")).collect();
            assert!(found.is_empty(), "{found:?}");
        }
    }

    #[test]
    fn what_is_put_in_cannot_end_its_script() {
        let page = with(&[r#"{"title":"</script><!--<script>"}"#.to_string()]);
        let (_, inside) = page.split_once("id=\"messages\">").unwrap();
        let (inside, _) = inside.split_once("</script>").unwrap();
        let messages: serde_json::Value = serde_json::from_str(inside).unwrap();
        assert_eq!(messages[0]["title"], "</script><!--<script>");
    }
}
