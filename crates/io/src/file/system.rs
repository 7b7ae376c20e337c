//! What differs between systems: opening without waiting, permissions and owners, descriptors.

use std::{
    fs::{File, Metadata, OpenOptions},
    io,
    path::Path,
};

#[cfg(unix)]
mod on_unix {
    use std::os::unix::fs::{MetadataExt, OpenOptionsExt, PermissionsExt, fchown};

    use rustix::{
        event::{PollFd, PollFlags, Timespec, poll},
        fd::AsFd,
        fs::{OFlags, fcntl_getfl, fcntl_setfl},
        io::Errno,
    };

    use super::{File, Metadata, OpenOptions, Path, io};

    /// Permissions of a file, without the bits that let it run as somebody else.
    const PERMISSIONS: u32 = 0o777;

    fn flags(flags: OFlags) -> i32 {
        flags.bits().cast_signed()
    }

    /// Opens for reading; never waits for somebody to write.
    pub(in super::super) fn open(path: &Path, follow: bool) -> io::Result<File> {
        let link = if follow { OFlags::empty() } else { OFlags::NOFOLLOW };
        OpenOptions::new().read(true).custom_flags(flags(OFlags::NONBLOCK | OFlags::NOCTTY | link)).open(path)
    }

    /// Opens a device or a pipe for writing; never waits for somebody to read.
    pub(in super::super) fn open_to_write(path: &Path) -> io::Result<File> {
        let wanted = OFlags::NONBLOCK | OFlags::NOCTTY;
        let file = OpenOptions::new().write(true).custom_flags(flags(wanted)).open(path)?;
        wait_again(&file)?;
        Ok(file)
    }

    /// From here on reading and writing wait again.
    pub(in super::super) fn wait_again(file: &File) -> io::Result<()> {
        let now = fcntl_getfl(file)?;
        Ok(fcntl_setfl(file, now - OFlags::NONBLOCK)?)
    }

    /// Waits a moment, and says whether there is something to read, or an end.
    pub(in super::super) fn wait_for_input(source: &impl AsFd) -> io::Result<bool> {
        const MOMENT: Timespec = Timespec { tv_sec: 0, tv_nsec: 20_000_000 };
        match poll(&mut [PollFd::new(source, PollFlags::IN)], Some(&MOMENT)) {
            Ok(ready) => Ok(ready > 0),
            Err(Errno::INTR) => Ok(false),
            Err(e) => Err(e.into()),
        }
    }

    /// Creates a file that did not exist: for its owner alone, or as the system does it for new files.
    pub(in super::super) fn create_new(path: &Path, private: bool) -> io::Result<File> {
        let mode = if private { 0o600 } else { 0o666 };
        OpenOptions::new().write(true).create_new(true).mode(mode).open(path)
    }

    /// Gives `file` the owner, where that is allowed, and the permissions of another.
    pub(in super::super) fn dress(file: &File, like: &Metadata) -> io::Result<()> {
        let own = file.metadata()?;
        let mut mode = like.mode() & PERMISSIONS;
        let is_same = (own.uid(), own.gid()) == (like.uid(), like.gid());
        if !is_same && fchown(file, Some(like.uid()), Some(like.gid())).is_err() {
            let has_group = own.gid() == like.gid() || fchown(file, None, Some(like.gid())).is_ok();
            if !has_group {
                // What another group was allowed is not meant for this one.
                mode = mode & !0o070 | (mode & 0o007) << 3;
            }
        }
        file.set_permissions(PermissionsExt::from_mode(mode))
    }

    /// Whether the file may be one that this user wrote.
    pub(in super::super) fn is_own(metadata: &Metadata) -> bool {
        let user = rustix::process::geteuid().as_raw();
        user == 0 || user == metadata.uid()
    }

    /// Whether `path` is still the name of the open `file`.
    pub(in super::super) fn is_name_of(path: &Path, file: &File) -> bool {
        let key = |m: &Metadata| (m.dev(), m.ino());
        match (path.symlink_metadata(), file.metadata()) {
            (Ok(named), Ok(open)) => key(&named) == key(&open),
            _ => false,
        }
    }

    /// What a thing that is not a regular file is called; `None` for a regular file.
    pub(in super::super) fn kind(metadata: &Metadata) -> Option<&'static str> {
        use std::os::unix::fs::FileTypeExt;
        let kind = metadata.file_type();
        match () {
            () if kind.is_file() => None,
            () if kind.is_dir() => Some("a folder"),
            () if kind.is_fifo() => Some("a named pipe"),
            () if kind.is_socket() => Some("a socket"),
            () if kind.is_block_device() => Some("a disk"),
            () => Some("a device"),
        }
    }
}

#[cfg(not(unix))]
mod elsewhere {
    use std::io::Stdout;

    use super::{File, Metadata, OpenOptions, Path, io};

    pub(in super::super) fn open(path: &Path, _follow: bool) -> io::Result<File> {
        File::open(path)
    }

    pub(in super::super) fn open_to_write(path: &Path) -> io::Result<File> {
        OpenOptions::new().write(true).open(path)
    }

    pub(in super::super) fn wait_again(_file: &File) -> io::Result<()> {
        Ok(())
    }

    pub(in super::super) fn wait_for_input<T>(_source: &T) -> io::Result<bool> {
        Ok(true)
    }

    pub(in super::super) fn create_new(path: &Path, _private: bool) -> io::Result<File> {
        OpenOptions::new().write(true).create_new(true).open(path)
    }

    pub(in super::super) fn dress(file: &File, like: &Metadata) -> io::Result<()> {
        file.set_permissions(like.permissions())
    }

    pub(in super::super) fn is_own(_metadata: &Metadata) -> bool {
        true
    }

    pub(in super::super) fn is_name_of(path: &Path, _file: &File) -> bool {
        path.exists()
    }

    pub(in super::super) fn kind(metadata: &Metadata) -> Option<&'static str> {
        match () {
            () if metadata.is_file() => None,
            () if metadata.is_dir() => Some("a folder"),
            () => Some("a device"),
        }
    }
}

#[cfg(not(unix))]
pub(super) use elsewhere::*;
#[cfg(unix)]
pub(super) use on_unix::*;
