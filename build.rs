//! Computes the identifier of the exact build, the version with a digest of all sources, for `src/pipeline/version.rs`. Only files that
//! no other build may read contain it; a report never does.

use std::env;
use std::fs;
use std::hash::{DefaultHasher, Hasher};
use std::io;
use std::path::{Path, PathBuf};

fn main() -> io::Result<()> {
    let mut files = vec![PathBuf::from("Cargo.lock")];
    collect(Path::new("src"), &mut files)?;
    // A package in somebody's registry has the other crates as dependencies of exactly its own version.
    if Path::new("crates").is_dir() {
        collect(Path::new("crates"), &mut files)?;
    }
    files.sort();
    let mut hasher = DefaultHasher::new();
    for file in files {
        // A package in somebody's registry has no lock file.
        let bytes = fs::read(&file).unwrap_or_default();
        hasher.write(file.to_string_lossy().replace('\\', "/").as_bytes());
        hasher.write_u64(bytes.len() as u64);
        hasher.write(&bytes);
    }
    let version = env::var("CARGO_PKG_VERSION").unwrap_or_default();
    println!("cargo::rerun-if-changed=src");
    println!("cargo::rerun-if-changed=crates");
    println!("cargo::rerun-if-changed=Cargo.lock");
    println!("cargo::rustc-env=LUMIDUCT_BUILD={version}+{:016x}", hasher.finish());
    Ok(())
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            collect(&path, files)?;
        } else {
            files.push(path);
        }
    }
    Ok(())
}
