//! All examples, one after the other: each in its window, or each without one, for all pictures and a sheet of them, or for a moving
//! picture.
//!
//! ```sh
//! cargo run --example gallery                              # a window each: close one to see the next
//! cargo run --example gallery -- curtain table             # these alone
//! cargo run --example gallery -- --headless --out DIR      # every report and picture, and a sheet of all, gallery.png
//! cargo run --example gallery -- --movie --out DIR         # a moving picture of some of them, cloth.png
//! ```
//!
//! Each runs by itself as well, by `cargo run --example NAME`; it says its keys in the panel beside it.

mod movie;
mod sheet;

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::{Command, ExitCode},
};

use clap::Parser;
use examples_shared::{pixels::Pixels, top};

use crate::movie::{FRAME_TICKS, FRAMES, SCENES, TICKS_A_SECOND};

/// An example, and what the pictures show that it makes.
struct Entry {
    name: &'static str,
    pictures: &'static [(&'static str, &'static str)],
}

const ENTRIES: &[Entry] = &[
    Entry {
        name: "flag",
        pictures: &[("flag.png", "a flag in the wind")],
    },
    Entry {
        name: "curtain",
        pictures: &[("curtain.png", "a walk through a curtain")],
    },
    Entry {
        name: "table",
        pictures: &[("table.png", "a tablecloth, to be pulled away")],
    },
    Entry {
        name: "cape",
        pictures: &[("cape.png", "a hero in a cape")],
    },
    Entry {
        name: "dress",
        pictures: &[("dress.png", "a skirt that twirls")],
    },
    Entry {
        name: "sleeve",
        pictures: &[("sleeve.png", "an arm in its sleeve")],
    },
    Entry {
        name: "tent",
        pictures: &[("tent.png", "a pavilion in the wind")],
    },
    Entry {
        name: "castle",
        pictures: &[("castle.png", "sixty flags")],
    },
    Entry {
        name: "balloon",
        pictures: &[("balloon.png", "pressure in closed meshes")],
    },
    Entry {
        name: "fold",
        pictures: &[("fold.png", "cloth on itself")],
    },
    Entry {
        name: "hammock",
        pictures: &[("hammock.png", "cloth that carries a body")],
    },
    Entry {
        name: "meshes",
        pictures: &[
            ("ridge_tent.png", "a tent from a glTF file"),
            ("poncho.png", "a mesh with a hole"),
            ("pennant.png", "a pennant of triangles"),
        ],
    },
    Entry {
        name: "shapes",
        pictures: &[("shapes.png", "every kind of collider")],
    },
    Entry {
        name: "ball",
        pictures: &[("ball.png", "how a touch is searched for")],
    },
    Entry {
        name: "volumes",
        pictures: &[("volumes.png", "six bounding volumes")],
    },
    Entry {
        name: "tear",
        pictures: &[("tear.png", "a banner, cut and torn")],
    },
    Entry {
        name: "laundry",
        pictures: &[("laundry.png", "a hand pulls at a sheet")],
    },
    Entry {
        name: "sewing",
        pictures: &[("sewing.png", "a shirt, sewn around a figure")],
    },
    Entry {
        name: "ropes",
        pictures: &[("ropes.png", "ropes hold a swing and a sail")],
    },
];

/// Runs all examples, or those that are named
#[derive(Parser)]
#[command(name = "gallery")]
struct Options {
    /// Which examples: all if none is named
    #[arg(value_name = "NAME", value_parser = names())]
    names: Vec<String>,
    /// Run without windows, as fast as possible, and make all pictures
    #[arg(long)]
    headless: bool,
    /// Run some of them without windows, and make a moving picture
    #[arg(long)]
    movie: bool,
    /// Headless: folder that the pictures are saved in, made if it is not there
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
}

fn names() -> Vec<&'static str> {
    ENTRIES.iter().map(|entry| entry.name).collect()
}

fn main() -> ExitCode {
    let options = Options::parse();
    let is_asked = |entry: &&Entry| {
        let mut names = options.names.iter();
        let is_shown = !options.movie || SCENES.iter().any(|(name, _)| *name == entry.name);
        is_shown && (options.names.is_empty() || names.any(|name| name == entry.name))
    };
    let entries: Vec<&Entry> = ENTRIES.iter().filter(is_asked).collect();
    let mut build = cargo("build");
    for entry in &entries {
        build.args(["--example", entry.name]);
    }
    if let Err(why) = succeed(&mut build) {
        eprintln!("The examples could not be built: {why}");
        return ExitCode::FAILURE;
    }
    if options.movie {
        return match save_movie(&entries, &options.out) {
            Ok(path) => {
                println!("\nThe moving picture: {}", path.display());
                ExitCode::SUCCESS
            }
            Err(why) => {
                eprintln!("No moving picture: {why}");
                ExitCode::FAILURE
            }
        };
    }
    let mut code = ExitCode::SUCCESS;
    for entry in &entries {
        println!("\n{}", entry.name);
        let mut run = run(entry);
        if options.headless {
            // None that an earlier run has left is to be shown.
            for (file, _) in entry.pictures {
                let _ = fs::remove_file(options.out.join(file));
            }
            run.arg("--headless").arg("--out").arg(&options.out);
        }
        if let Err(why) = succeed(&mut run) {
            eprintln!("{}: {why}", entry.name);
            code = ExitCode::FAILURE;
        }
    }
    if options.headless {
        match save_sheet(&entries, &options.out) {
            Ok(path) => println!("\nAll of them: {}", path.display()),
            // Where nothing can be drawn, the reports are what can be had.
            Err(why) => println!("\nNo sheet of all pictures: {why}"),
        }
    }
    code
}

/// The cargo that runs this, for the workspace: for `examples` alone it would build Bevy again, with fewer features.
fn cargo(what: &str) -> Command {
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let manifest = top().join("Cargo.toml");
    let mut command = Command::new(cargo);
    command.arg(what).arg("--manifest-path").arg(manifest);
    command
}

/// Runs an example that is built, by the arguments to come.
fn run(entry: &Entry) -> Command {
    let mut command = cargo("run");
    command.args(["--quiet", "--example", entry.name, "--"]);
    command
}

fn succeed(command: &mut Command) -> Result<(), String> {
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(status.to_string()),
        Err(error) => Err(error.to_string()),
    }
}

fn save_sheet(entries: &[&Entry], out: &Path) -> Result<PathBuf, String> {
    let pictures = entries.iter().flat_map(|entry| {
        let each = entry.pictures.iter();
        each.map(|&(file, what)| (entry.name, what, out.join(file)))
    });
    let path = out.join("gallery.png");
    sheet::of(pictures)?.save(&path, Some(256))?;
    Ok(path)
}

fn save_movie(entries: &[&Entry], out: &Path) -> Result<PathBuf, String> {
    let mut frames = Vec::new();
    for (name, from) in SCENES {
        for entry in entries.iter().filter(|entry| entry.name == name) {
            println!("\n{}", entry.name);
            let (_, what) = entry.pictures[0];
            for frame in film(entry, from, &out.join(name))? {
                frames.push(sheet::captioned(&frame, [entry.name, what]));
            }
        }
    }
    let path = out.join("cloth.png");
    movie::save(&frames, &path)?;
    Ok(path)
}

/// The frames of a scene from this time on (s), which its example saves in a folder of its own.
fn film(entry: &Entry, from: f64, folder: &Path) -> Result<Vec<Pixels>, String> {
    let files = (0..FRAMES).map(|number| folder.join(format!("frame-{number:03}.png")));
    let files: Vec<_> = files.collect();
    // None that an earlier run has left is to be shown.
    for file in &files {
        let _ = fs::remove_file(file);
    }
    let mut run = run(entry);
    run.arg("--headless").arg("--out").arg(folder);
    let seconds = f64::from(FRAMES * u32::from(FRAME_TICKS)) / f64::from(TICKS_A_SECOND);
    let to = (from + seconds).to_string();
    run.args(["--seconds", &to, "--to", &to]).args([
        "--from",
        &from.to_string(),
        "--frames",
        &FRAMES.to_string(),
    ]);
    succeed(&mut run).map_err(|why| format!("{}: {why}", entry.name))?;
    files.iter().map(|file| sheet::load(file)).collect()
}
