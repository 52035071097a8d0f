//! Writes the CSV file, with where and how all was measured in its header.

use std::{fs::File, io::Write, path::Path, process::Command};

use serde::Serialize;
use sysinfo::System;

/// Names and values that stand before the rows.
pub type Header = Vec<(&'static str, String)>;

/// Adds what could not be measured, once each.
pub fn push_left_out(header: &mut Header, mut left_out: Vec<String>) {
    left_out.dedup();
    if !left_out.is_empty() {
        header.push(("left out", left_out.join("; ")));
    }
}

/// Writes rows, with lines that begin with # before them.
///
/// # Errors
/// If the file can't be written.
pub fn write<R: Serialize>(path: &Path, settings: &Header, rows: &[R]) -> Result<(), String> {
    let fail = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let mut file = File::create(path).map_err(|error| fail(&error))?;
    for (name, value) in settings {
        writeln!(file, "# {name}: {value}").map_err(|error| fail(&error))?;
    }
    let mut writer = csv::Writer::from_writer(file);
    for row in rows {
        writer.serialize(row).map_err(|error| fail(&error))?;
    }
    writer.flush().map_err(|error| fail(&error))
}

pub fn machine() -> String {
    let Ok(mut system) = System::new() else {
        return std::env::consts::ARCH.into();
    };
    system.refresh_cpu_all();
    let brand = system
        .cpus()
        .first()
        .map(|cpu| cpu.brand().trim().to_owned());
    format!(
        "{}, {} threads, {}",
        brand.unwrap_or_default(),
        system.cpus().len(),
        std::env::consts::ARCH
    )
}

/// Of what is compiled in, as it was locked; of the compiler and the commit, where these can be asked.
pub fn versions() -> String {
    let lock = include_str!("../Cargo.lock");
    let locked = |name: &str| {
        let (_, after) = lock.split_once(&format!("name = \"{name}\"\nversion = \""))?;
        Some(format!("{name} {}", after.split_once('"')?.0))
    };
    let mut versions: Vec<String> = ["bevy_drape", "bevy", "oxijolt", "rapier-cloth"]
        .into_iter()
        .filter_map(locked)
        .collect();
    let asked = [
        ("rustc", &["--version"][..], ""),
        ("c++", &["--version"], ""),
        ("git", &["rev-parse", "--short", "HEAD"], "commit "),
    ];
    for (program, arguments, before) in asked {
        let output = Command::new(program).args(arguments).output();
        if let Some(output) = output.ok().filter(|output| output.status.success()) {
            let said = String::from_utf8_lossy(&output.stdout);
            versions.push(format!(
                "{before}{}",
                said.lines().next().unwrap_or_default()
            ));
        }
    }
    versions.join(", ")
}
