//! Where the resources of the FMU are: as the importer says, or beside the library.
#![allow(unsafe_code)]

use super::pointers::text;
use crate::fault::{Fault, Outcome};
use std::ffi::{c_char, c_void};
use std::path::{Path, PathBuf};

/// A path of the importer, as the operating system writes it.
pub fn native_path(bytes: &[u8]) -> Outcome<PathBuf> {
    #[cfg(unix)]
    {
        use std::os::unix::ffi::OsStrExt;
        Ok(Path::new(std::ffi::OsStr::from_bytes(bytes)).to_path_buf())
    }
    #[cfg(not(unix))]
    {
        let text = std::str::from_utf8(bytes);
        text.map(PathBuf::from)
            .map_err(|_| Fault::error("the path of the resources is not UTF-8"))
    }
}

/// A `file:` URI (or a path from the root) as a path, percent signs decoded.
pub fn uri_path(uri: &[u8]) -> Outcome<PathBuf> {
    let shown = || String::from_utf8_lossy(uri).into_owned();
    if uri.starts_with(b"/") {
        return native_path(uri);
    }
    let is_file = uri.len() >= 5 && uri[..5].eq_ignore_ascii_case(b"file:");
    let Some(rest) = uri.get(5..).filter(|_| is_file) else {
        return Err(Fault::error(format!(
            "the resource location {:?} is no file: URI",
            shown()
        )));
    };
    let path = match rest.strip_prefix(b"//") {
        Some(after) => {
            let start = after.iter().position(|b| *b == b'/').unwrap_or(after.len());
            if start > 0 && !after[..start].eq_ignore_ascii_case(b"localhost") {
                return Err(Fault::error(format!(
                    "the resource location {:?} is on another host",
                    shown()
                )));
            }
            &after[start..]
        }
        None => rest,
    };
    let mut out = Vec::with_capacity(path.len());
    let mut bytes = path.iter().copied();
    while let Some(byte) = bytes.next() {
        if byte != b'%' {
            out.push(byte);
            continue;
        }
        let mut digit = || bytes.next().and_then(|b| (b as char).to_digit(16));
        match (digit(), digit()) {
            (Some(high), Some(low)) => out.push((16 * high + low) as u8),
            _ => {
                return Err(Fault::error(format!(
                    "the resource location {:?} has a broken % escape",
                    shown()
                )));
            }
        }
    }
    // file:///C:/x names C:/x
    let is_drive = cfg!(windows) && out.len() > 2 && out[0] == b'/' && out[2] == b':';
    native_path(&out[usize::from(is_drive)..])
}

/// The resources of the FMU that this library was unpacked with: `../../resources` from the library.
pub fn resources_beside_library() -> Outcome<PathBuf> {
    let refuse = || {
        Fault::error("no path of the resources was given, and there are none beside the library")
    };
    let library = library_path().ok_or_else(refuse)?;
    let root = library
        .parent()
        .and_then(Path::parent)
        .and_then(Path::parent)
        .ok_or_else(refuse)?;
    let resources = root.join("resources");
    if resources.is_dir() {
        Ok(resources)
    } else {
        Err(refuse())
    }
}

#[cfg(unix)]
fn library_path() -> Option<PathBuf> {
    #[repr(C)]
    struct Info {
        file: *const c_char,
        base: *mut c_void,
        symbol: *const c_char,
        address: *mut c_void,
    }
    unsafe extern "C" {
        fn dladdr(address: *const c_void, info: *mut Info) -> i32;
    }
    let mut info = Info {
        file: std::ptr::null(),
        base: std::ptr::null_mut(),
        symbol: std::ptr::null(),
        address: std::ptr::null_mut(),
    };
    // SAFETY: the address is one of this library; `info` has the layout that POSIX gives Dl_info.
    if unsafe { dladdr(library_path as *const c_void, &raw mut info) } == 0 {
        return None;
    }
    let file = text(info.file, "the file").ok()?;
    native_path(file.to_bytes()).ok()?.canonicalize().ok()
}

#[cfg(not(unix))]
fn library_path() -> Option<PathBuf> {
    None
}

#[cfg(test)]
mod tests {
    use super::uri_path;
    use std::path::PathBuf;

    #[test]
    fn uris_are_decoded_or_refused() {
        for (uri, path) in [
            ("file:///a%20b/c", "/a b/c"),
            ("file:/a/c", "/a/c"),
            ("FILE://localhost/a", "/a"),
            ("/plain/path", "/plain/path"),
        ] {
            assert_eq!(uri_path(uri.as_bytes()), Ok(PathBuf::from(path)), "{uri}");
        }
        for uri in [
            "http://a/b",
            "file:///a%2",
            "file:///a%zz",
            "file://elsewhere/a",
            "",
            "relative",
        ] {
            assert!(uri_path(uri.as_bytes()).is_err(), "{uri}");
        }
    }
}
