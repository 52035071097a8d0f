//! Reads the crate's source files.

use std::{
    fs,
    path::{Path, PathBuf},
};

pub fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path());
    let (folders, files): (Vec<_>, Vec<_>) = entries.partition(|path| path.is_dir());
    let below = folders.iter().flat_map(|folder| sources(folder));
    below
        .chain(files)
        .filter(|path| path.extension().is_some_and(|end| end == "rs"))
        .collect()
}

/// The code of a file, without comments and without what follows `#[cfg(test)]`.
pub fn code(path: &Path) -> String {
    code_of(&fs::read_to_string(path).expect("a source file"))
}

/// As [`code`], of a text.
pub fn code_of(text: &str) -> String {
    let code = text
        .split("#[cfg(test)]\nmod tests {")
        .next()
        .unwrap_or_default();
    code.lines()
        .filter(|line| !line.trim_start().starts_with("//"))
        .map(|line| line.split(" // ").next().unwrap_or_default())
        .collect::<Vec<_>>()
        .join("\n")
}

pub fn source_folder() -> PathBuf {
    // Asked as the test runs: checkouts that share a target folder may share the compiled test.
    let folder = std::env::var("CARGO_MANIFEST_DIR").expect("cargo says where the crate is");
    Path::new(&folder).join("src")
}

/// Tests may look at all floors.
pub fn is_of_tests(file: &Path) -> bool {
    let mut parts = file.components();
    parts.any(|part| ["tests", "tests.rs"].contains(&part.as_os_str().to_str().unwrap_or_default()))
}
