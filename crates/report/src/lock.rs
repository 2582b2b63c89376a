//! A lock that lets only one program at a time write into a folder.

use crate::destination::expect_room;
use lumiduct_base::error::{Error, Result};
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A folder that no other run or batch writes into while this value or a copy of it exists.
#[derive(Debug, Clone)]
pub struct FolderLock {
    path: PathBuf,
    /// The folder itself, which is never replaced; `None` where the system does not open folders as
    /// files.
    _file: Option<Arc<File>>,
}

impl FolderLock {
    /// Creates the folder if missing and locks it.
    ///
    /// # Errors
    ///
    /// [`Error::Usage`] if another program has the lock, or the path is a file or cannot be made a folder;
    /// [`Error::Io`] if no file can be created in it.
    pub fn take(path: &Path) -> Result<Self> {
        expect_room(path)?;
        let own = |file| Self { path: path.to_path_buf(), _file: file };
        let Ok(file) = File::open(path) else { return Ok(own(None)) };
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => Err(Error::Usage(format!(
                "another run or batch is using {}; wait until it ends, or use -o for another folder",
                path.display()
            ))),
            // Some file systems have no locks.
            Ok(()) | Err(TryLockError::Error(_)) => Ok(own(Some(Arc::new(file)))),
        }
    }

    /// The folder.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_free_again_when_the_last_copy_of_its_lock_is_gone() {
        let dir = tempfile::tempdir().unwrap();
        let lock = FolderLock::take(dir.path()).unwrap();
        let copy = lock.clone();
        drop(lock);
        let refused = FolderLock::take(dir.path()).unwrap_err().to_string();
        assert!(refused.contains("another run or batch is using"), "{refused}");
        drop(copy);
        FolderLock::take(dir.path()).unwrap();
    }
}
