//! CSV files with a header of their own: where, with what and how they were measured.

use std::{
    fs::{self, File},
    io::Write,
    path::Path,
    process::Command,
};

use serde::{Serialize, de::DeserializeOwned};
use sysinfo::System;

use crate::experiment::Run;

/// Writes rows, with lines that begin with # before them.
///
/// # Errors
/// Which file could not be written.
pub fn write<R: Serialize>(path: &Path, run: &Run, rows: &[R]) -> Result<(), String> {
    let fail = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(|error| fail(&error))?;
    }
    let mut file = File::create(path).map_err(|error| fail(&error))?;
    for (name, value) in machine().iter().chain(&run.settings) {
        writeln!(file, "# {name}: {value}").map_err(|error| fail(&error))?;
    }
    let length = if run.quick { "quick" } else { "whole" };
    writeln!(file, "# run: {length}").map_err(|error| fail(&error))?;
    let mut writer = csv::Writer::from_writer(file);
    for row in rows {
        writer.serialize(row).map_err(|error| fail(&error))?;
    }
    writer.flush().map_err(|error| fail(&error))
}

/// Reads rows that were written before.
///
/// # Errors
/// Which file could not be read, and why.
pub fn read<R: DeserializeOwned>(path: &Path) -> Result<Vec<R>, String> {
    let fail = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_path(path)
        .map_err(|error| fail(&error))?
        .deserialize()
        .collect::<Result<_, _>>()
        .map_err(|error| fail(&error))
}

/// The machine, the versions, and how all was built.
fn machine() -> Vec<(String, String)> {
    let hardware = System::new().map(|mut system| {
        system.refresh_cpu_all();
        system.refresh_memory();
        let brand = system
            .cpus()
            .first()
            .map(|cpu| cpu.brand().trim().to_owned());
        format!(
            "{}, {} threads, {:.0} GiB, {}",
            brand.unwrap_or_default(),
            system.cpus().len(),
            system.total_memory() as f64 / f64::from(1 << 30),
            std::env::consts::ARCH
        )
    });
    let hardware = hardware.unwrap_or_else(|_| std::env::consts::ARCH.into());
    let os = System::long_os_version().unwrap_or_else(|_| std::env::consts::OS.into());
    let profile = if cfg!(debug_assertions) {
        "dev, optimised"
    } else {
        "release"
    };
    [
        ("machine", hardware),
        ("system", os),
        ("versions", versions()),
        ("profile", profile.into()),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .to_vec()
}

/// Of what takes part, as it was locked; of the compiler and the commit, where these can be asked.
fn versions() -> String {
    let lock = include_str!("../../Cargo.lock");
    let mut versions: Vec<String> = ["bevy_drape", "bevy", "faer", "parry3d"]
        .into_iter()
        .filter_map(|name| {
            let (_, after) = lock.split_once(&format!("name = \"{name}\"\nversion = \""))?;
            Some(format!("{name} {}", after.split_once('"')?.0))
        })
        .collect();
    let asked = [
        ("rustc", &["--version"][..]),
        ("git", &["rev-parse", "--short", "HEAD"]),
    ];
    for (program, arguments) in asked {
        let output = Command::new(program).args(arguments).output();
        if let Some(output) = output.ok().filter(|output| output.status.success()) {
            let said = String::from_utf8_lossy(&output.stdout);
            let commit = if program == "git" { "commit " } else { "" };
            versions.push(format!("{commit}{}", said.trim()));
        }
    }
    versions.join(", ")
}
