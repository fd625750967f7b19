//! Broken files: cut off, changed byte by byte, spliced. No panic, and no more memory than a multiple of the file.

use crate::writer::{FORMATS, File};
use crate::{all, read};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

/// Counts the memory of a thread and its most.
struct Counting;

thread_local! {
    static NOW: Cell<isize> = const { Cell::new(0) };
    static MOST: Cell<isize> = const { Cell::new(0) };
}

fn count(bytes: isize) {
    NOW.with(|now| {
        now.set(now.get() + bytes);
        MOST.with(|most| most.set(most.get().max(now.get())));
    });
}

// SAFETY: forwards to the system allocator; only counts.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        // SAFETY: the caller's contract.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count(-(layout.size() as isize));
        // SAFETY: the caller's contract.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Bytes that a byte of a file may take: nodes, elements, sides of cells, each in two orders.
const PER_BYTE: usize = 60;
/// And what messages and names take.
const ASIDE: usize = 20_000;

/// Whether the file is read; it may take so much memory and no more.
fn is_read(bytes: &[u8]) -> bool {
    let start = NOW.with(Cell::get);
    MOST.with(|most| most.set(start));
    let outcome = read(bytes);
    let most = (MOST.with(Cell::get) - start) as usize;
    assert!(
        most < PER_BYTE * bytes.len() + ASIDE,
        "{most} bytes for {}",
        bytes.len()
    );
    match outcome {
        Ok(mesh) => {
            // whatever is accepted is a mesh
            assert!(
                mesh.cell_nodes
                    .iter()
                    .all(|n| (*n as usize) < mesh.nodes.len())
            );
            assert!(mesh.nodes.iter().flatten().all(|x| x.is_finite()));
            assert!(mesh.quality().regions.iter().all(|r| r.cells > 0));
            true
        }
        Err(error) => {
            let text = error.to_string();
            assert!(text.lines().count() == 1 && text.len() < 1000, "{text}");
            false
        }
    }
}

/// Numbers without pattern.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % n.max(1)
    }
}

#[test]
fn broken_files_are_refused_without_harm() {
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let rounds: usize = std::env::var("MESH_FUZZ").map_or(400, |n| n.parse().unwrap());
    let (mut refused, mut accepted) = (0, 0);
    let mut feed = |bytes: &[u8]| match is_read(bytes) {
        true => accepted += 1,
        false => refused += 1,
    };
    let files: Vec<Vec<u8>> = all()
        .iter()
        .flat_map(|mesh| FORMATS.map(|format| File::of(mesh).write(format)))
        .collect();
    for bytes in &files {
        let length = bytes.len();
        for _ in 0..rounds / 4 {
            feed(&bytes[..random.below(length)]);
        }
        for _ in 0..rounds {
            let mut changed = bytes.clone();
            for _ in 0..1 + random.below(3) {
                let at = random.below(length);
                changed[at] = match random.below(4) {
                    0 => changed[at] ^ (1 << random.below(8)),
                    1 => b"0123456789-.e\n $"[random.below(16)],
                    2 => [0, 0xff, 0x7f, 0x80][random.below(4)],
                    _ => random.below(256) as u8,
                };
            }
            feed(&changed);
        }
        for _ in 0..rounds / 4 {
            // a piece of it, or of another file, at another place
            let other = &files[random.below(files.len())];
            let from = random.below(other.len());
            let piece = &other[from..(from + random.below(60)).min(other.len())];
            let at = random.below(length);
            let end = (at + random.below(60)).min(length);
            feed(&[&bytes[..at], piece, &bytes[end..]].concat());
        }
    }
    // names of groups and last digits may change; most else may not
    assert!(
        refused > 2 * accepted && accepted > 100,
        "{refused} {accepted}"
    );
    println!("{} inputs, {accepted} accepted", refused + accepted);
}
