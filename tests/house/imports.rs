//! Reads what the text of a file imports, names and implements.

/// A name that a `use` brings into a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Import {
    /// As the file calls it; `*` for all of a module, `_` for a trait without a name.
    pub name: String,
    /// Where it is from, segment by segment.
    pub path: Vec<String>,
    /// By a `pub use`: for other files, and for this one only if its code holds the name.
    pub is_public: bool,
}

/// What the `use` lines of some code import, and the code without them and without the modules it declares.
pub fn without_imports(code: &str) -> (Vec<Import>, String) {
    let (mut imports, mut rest) = (Vec::new(), Vec::new());
    let mut lines = code.lines();
    while let Some(line) = lines.next() {
        let Some((is_public, tree)) = import_begun(line) else {
            rest.push(line);
            continue;
        };
        let mut tree = tree.to_owned();
        while !tree.contains(';') {
            tree.push_str(lines.next().expect("a semicolon ends an import"));
        }
        let leaves = leaves(tree.split(';').next().unwrap_or_default());
        imports.extend(leaves.iter().map(|leaf| import(leaf, is_public)));
    }
    rest.retain(|line| !declares_module(line));
    // `use each;` hands a macro of the file itself on, and is from nowhere else.
    imports.retain(|import| import.path != [import.name.as_str()]);
    (imports, rest.join("\n"))
}

/// A module may be called as a name that is handed on from it, and does not make use of it by that.
fn declares_module(line: &str) -> bool {
    let mut words = line.trim_end().trim_end_matches(';').split(' ').rev();
    line.trim_end().ends_with(';') && words.nth(1) == Some("mod")
}

/// Whether a line begins a `use`, that being public, and what follows the word.
fn import_begun(line: &str) -> Option<(bool, &str)> {
    let line = line.trim_start();
    let Some(public) = line.strip_prefix("pub") else {
        return Some((false, line.strip_prefix("use ")?));
    };
    let visible = match public.strip_prefix('(') {
        Some(to) => to.split_once(')')?.1,
        None => public,
    };
    Some((true, visible.strip_prefix(" use ")?))
}

/// The single imports of a tree: `a::b` and `a::c as d` of `a::{b, c as d}`.
fn leaves(tree: &str) -> Vec<String> {
    let tree = tree.trim();
    let group = tree.strip_suffix('}').and_then(|tree| tree.split_once('{'));
    let Some((stem, group)) = group else {
        return vec![tree.to_owned()];
    };
    let below = parts(group).into_iter().flat_map(leaves);
    below.map(|leaf| format!("{stem}{leaf}")).collect()
}

/// The parts of a group, at the commas that are in no group within it.
fn parts(group: &str) -> Vec<&str> {
    let mut depth = 0;
    let parts = group.split(|each| {
        match each {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        each == ',' && depth == 0
    });
    parts.filter(|part| !part.trim().is_empty()).collect()
}

fn import(leaf: &str, is_public: bool) -> Import {
    let (path, alias) = match leaf.split_once(" as ") {
        Some((path, alias)) => (path, Some(alias)),
        None => (leaf, None),
    };
    let mut path = segments(path);
    // `a::{self}` is `a`.
    if path.len() > 1 && path.last().is_some_and(|last| last == "self") {
        path.pop();
    }
    let last = path.last().map_or("", String::as_str);
    Import {
        name: alias.unwrap_or(last).trim().to_owned(),
        path,
        is_public,
    }
}

fn segments(path: &str) -> Vec<String> {
    path.split("::")
        .map(|segment| segment.trim().to_owned())
        .collect()
}

/// `$` too: what a macro is given takes the place of a name.
fn is_of_name(each: char) -> bool {
    each.is_alphanumeric() || ['_', '$'].contains(&each)
}

pub fn holds_word(code: &str, word: &str) -> bool {
    code.split(|each| !is_of_name(each))
        .any(|each| each == word)
}

/// The paths of more than one segment that some code names, such as `super::kernel::$name`.
pub fn paths(code: &str) -> Vec<Vec<String>> {
    code.split(|each| each != ':' && !is_of_name(each))
        .map(|path| path.trim_end_matches(':'))
        .filter(|path| path.contains("::") && !path.starts_with(':'))
        .map(segments)
        .collect()
}

/// The types, as paths, that some code implements methods for, other than those of a trait.
pub fn implemented(code: &str) -> Vec<Vec<String>> {
    let code = format!("\n{code}");
    let heads = code.split("\nimpl").skip(1).map(|block| {
        let head = block.split('{').next().unwrap_or_default();
        after_generics(head.split("\nwhere").next().unwrap_or_default())
    });
    heads
        .filter(|head| !head.contains(" for "))
        .map(|head| {
            let path = head
                .trim_start()
                .split(|each| each != ':' && !is_of_name(each));
            segments(path.into_iter().next().unwrap_or_default())
        })
        .collect()
}

/// What follows the `<…>` that a head may begin with.
fn after_generics(head: &str) -> &str {
    let (mut depth, mut before) = (0, ' ');
    for (place, each) in head.char_indices() {
        match each {
            '<' => depth += 1,
            // Not of an arrow.
            '>' if before != '-' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return &head[place + each.len_utf8()..];
        }
        before = each;
    }
    ""
}

#[test]
fn trees_of_imports_are_read_leaf_by_leaf() {
    let (imports, rest) = without_imports(
        "use super::{\n    a::{self, B},\n    C as D,\n};\npub(crate) use each;\n\
        pub(in super::x) use e::*;\npub mod f;\nfn f() {}",
    );
    let read: Vec<_> = imports
        .iter()
        .map(|import| (import.name.as_str(), import.path.join("::")))
        .collect();
    let expected = [("a", "super::a"), ("B", "super::a::B"), ("D", "super::C")];
    assert_eq!(
        read[..3],
        expected.map(|(name, path)| (name, path.to_owned()))
    );
    assert_eq!(read[3..], [("*", "e::*".to_owned())]);
    assert_eq!(imports.iter().filter(|import| import.is_public).count(), 1);
    assert_eq!(rest, "fn f() {}");
}

#[test]
fn paths_within_code_are_read() {
    let code = "fn f(a: super::A<self::b::C>) { super::kernel::$name(a); super::D::<u8>::new(); <E>::f() }";
    let read: Vec<_> = paths(code).iter().map(|path| path.join("::")).collect();
    assert_eq!(
        read,
        ["super::A", "self::b::C", "super::kernel::$name", "super::D"]
    );
}

#[test]
fn blocks_of_inherent_methods_are_told_from_those_of_traits() {
    let code = "impl A {\n}\nimpl<F: Fn(u8) -> u8> B<F> {\n}\nimpl<T> super::C<T>\nwhere\n    T: D,\n{\n}\n\
        impl Default for E {\n}\nimpl<'a> PartialEq<F<'a>>\n    for G\n{\n}";
    let read: Vec<_> = implemented(code)
        .iter()
        .map(|path| path.join("::"))
        .collect();
    assert_eq!(read, ["A", "B", "super::C"]);
}
