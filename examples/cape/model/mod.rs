//! The hero: writes `assets/models/hero.glb`, a person with a skeleton, animations and a painted cape, as a modelling program would.

mod body;
mod cape;
mod file;
mod moves;
mod skeleton;

use std::{fs, io, path::Path};

use serde_json::json;

use file::File;

/// Writes the file.
///
/// # Errors
/// What the file system says.
pub fn write(path: &Path) -> io::Result<()> {
    let mut file = File::default();
    let mut nodes = skeleton::nodes();
    body::add(&mut file, &mut nodes);
    let skin = skeleton::skin(&mut file);
    let cape = cape::mesh(&mut file);
    let cape_node = nodes.len();
    nodes.push(json!({ "name": "cape", "mesh": cape, "skin": 0 }));
    let hero = nodes.len();
    nodes.push(json!({ "name": "hero", "children": [0, cape_node] }));
    let animations = moves::all(&mut file);
    let rest = json!({
        "scene": 0,
        "scenes": [{ "nodes": [hero] }],
        "nodes": nodes,
        "skins": [skin],
        "animations": animations,
        "materials": body::materials(),
    });
    fs::write(path, file.finish(rest))
}
