//! README, guide and docs stay plain: short sentences with a noun for their subject, and a README of three minutes.

use std::{
    fs,
    path::{Path, PathBuf},
};

/// Words that a sentence may have at most.
const LONGEST: usize = 30;
/// Lines and words that README may have.
const README: [usize; 2] = [200, 1_800];
/// Clauses that make a reader read twice, as the subject of a statement or anywhere.
const SUBJECTS: [&str; 3] = ["What ", "Who ", "As much as "];
const PHRASES: [&str; 4] = ["so many", "is told", "in parts of", "is had"];

fn root() -> PathBuf {
    PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR").expect("cargo says where the crate is"))
}

fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder");
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let mut found = Vec::new();
    for path in paths {
        if path.is_dir() {
            found.extend(files(&path, extension));
        } else if path.extension().is_some_and(|its| its == extension) {
            found.push(path);
        }
    }
    found
}

/// Paragraphs, cells of tables and items of lists, without programs. Code in a sentence counts as a word.
fn paragraphs(text: &str) -> Vec<String> {
    let mut all = vec![String::new()];
    let mut is_code = false;
    for line in text.lines().map(str::trim) {
        if line.starts_with("```") {
            is_code = !is_code;
        }
        let is_item =
            line.starts_with("- ") || line.starts_with(|first: char| first.is_ascii_digit());
        let begins = line.is_empty() || is_item || line.starts_with(['#', '|', '<', '[']);
        if begins || is_code || line.starts_with("```") {
            all.push(String::new());
        }
        if is_code || line.starts_with("```") || line.starts_with('<') {
            continue;
        }
        let cells = line.split('|').filter(|_| line.starts_with('|'));
        all.extend(cells.map(str::to_string));
        if !line.starts_with('|') {
            let last = all.last_mut().expect("at least one");
            last.push(' ');
            last.push_str(line.trim_start_matches(['#', '-', ' ']));
        }
    }
    all.iter()
        .map(|paragraph| without_code(paragraph))
        .collect()
}

/// With each `code` as one word, and links as their texts.
fn without_code(paragraph: &str) -> String {
    let mut words = String::new();
    for (number, part) in paragraph.split('`').enumerate() {
        words.push_str(if number % 2 == 0 { part } else { "code" });
    }
    let mut text = String::new();
    let mut rest = words.as_str();
    while let Some((before, link)) = rest.split_once("](") {
        text.push_str(before);
        rest = link.split_once(')').map_or("", |(_, after)| after);
    }
    text + rest
}

/// Where a sentence ends: at a full stop, or at a colon or semicolon, after which another begins.
fn sentences(paragraph: &str) -> Vec<&str> {
    let mut all = Vec::new();
    let mut rest = paragraph.trim();
    while let Some(end) = [". ", "! ", "? ", ": ", "; "]
        .iter()
        .filter_map(|end| rest.find(end))
        .min()
    {
        all.push(&rest[..=end]);
        rest = rest[end + 1..].trim_start();
    }
    all.push(rest);
    all
}

/// Each sentence of a text that is too long or reads twice, with the place that it is from.
fn faults(place: &str, text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for paragraph in paragraphs(text) {
        for sentence in sentences(&paragraph) {
            let is_word = |word: &&str| word.contains(char::is_alphanumeric);
            let words = sentence.split_whitespace().filter(is_word).count();
            let is_asked = sentence.ends_with('?');
            if words > LONGEST
                || !is_asked && SUBJECTS.iter().any(|start| sentence.starts_with(start))
                || PHRASES.iter().any(|phrase| sentence.contains(phrase))
            {
                found.push(format!("{place}: {words} words: {sentence}"));
            }
        }
    }
    found
}

/// The docs of a module and of its public items, and the texts of its errors and log messages.
fn docs(code: &str) -> Vec<String> {
    let (mut all, mut module, mut item) = (Vec::new(), String::new(), String::new());
    for line in code.lines().map(str::trim) {
        if let Some(text) = line.strip_prefix("//!") {
            module += &format!("{text}\n");
        } else if let Some(text) = line.strip_prefix("///") {
            item += &format!("{text}\n");
        } else if !line.starts_with("#[") {
            if line.starts_with("pub ") {
                all.push(item);
            }
            item = String::new();
        }
    }
    all.push(module);
    for start in ["#[error(", "warn!(", "error!(", "info!("] {
        let calls = code.split(start).skip(1);
        all.extend(calls.filter_map(|call| call.split('"').nth(1).map(str::to_string)));
    }
    all
}

#[test]
fn readme_takes_three_minutes() {
    let readme = fs::read_to_string(root().join("README.md")).expect("a README");
    let size = [readme.lines().count(), readme.split_whitespace().count()];
    assert!(size[0] <= README[0] && size[1] <= README[1], "{size:?}");
}

#[test]
fn texts_are_plain() {
    let mut texts = [
        "README.md",
        "ARCHITECTURE.md",
        "CHANGELOG.md",
        "lab/README.md",
    ]
    .map(|name| root().join(name))
    .to_vec();
    texts.extend(files(&root().join("src/guide"), "md"));
    let mut found = Vec::new();
    for path in texts {
        let text = fs::read_to_string(&path).expect("a text");
        found.extend(faults(&path.display().to_string(), &text));
    }
    let is_of_tests = |path: &PathBuf| {
        let inside = path.strip_prefix(root()).unwrap_or(path);
        inside.to_string_lossy().contains("tests")
    };
    let mut sources = files(&root().join("src"), "rs");
    // Programs' own docs are read by whoever runs them.
    for folder in ["examples", "lab/src"] {
        let programs = files(&root().join(folder), "rs");
        sources.extend(
            programs
                .into_iter()
                .filter(|path| path.ends_with("main.rs")),
        );
    }
    for path in sources.iter().filter(|path| !is_of_tests(path)) {
        let code = fs::read_to_string(path).expect("a source");
        for text in docs(&code) {
            found.extend(faults(&path.display().to_string(), &text));
        }
    }
    assert!(
        found.is_empty(),
        "{} sentences:\n{}",
        found.len(),
        found.join("\n")
    );
}

#[test]
fn a_text_that_reads_twice_is_found() {
    let long = "word ".repeat(31);
    for bad in ["What is set is kept.", "It takes so many steps.", &long] {
        assert_eq!(faults("here", bad).len(), 1, "{bad}");
    }
    let good = "It takes `a b c` steps: [see](what.md).\n\n```\nWhat so many\n```\n| What? | a |";
    assert_eq!(faults("here", good), [""; 0]);
}
