//! Calls of the operating system about memory. Nothing here allocates.

#![allow(unsafe_code, reason = "calls of libc")]

use std::fs::File;
use std::io::Read;

/// Bytes of resident pages; 0 if unknown.
pub fn resident() -> usize {
    pages(1) * page()
}

/// Bytes of address space; 0 if unknown.
pub fn address_space() -> usize {
    pages(0) * page()
}

/// The number at the index `place` of `/proc/self/statm`, which counts pages; 0 if it cannot be read.
fn pages(place: usize) -> usize {
    let mut text = [0; 128];
    let count = File::open("/proc/self/statm").and_then(|mut file| file.read(&mut text)).unwrap_or(0);
    let text = str::from_utf8(&text[..count]).unwrap_or("");
    text.split_ascii_whitespace().nth(place).and_then(|number| number.parse().ok()).unwrap_or(0)
}

/// Bytes of address space that `ulimit -v` allows; `None` without a limit.
pub fn address_space_allowed() -> Option<usize> {
    let mut limit = libc::rlimit { rlim_cur: 0, rlim_max: 0 };
    // SAFETY: the call writes to a struct of the right type.
    let got = unsafe { libc::getrlimit(libc::RLIMIT_AS, &raw mut limit) };
    (got == 0 && limit.rlim_cur != libc::RLIM_INFINITY).then_some(limit.rlim_cur as usize)
}

/// Whether the system has this many bytes of address space in one piece.
pub fn is_room_for(bytes: usize) -> bool {
    // SAFETY: maps pages at an address that the system chooses, and unmaps the same pages. No code uses them.
    unsafe {
        let (private, nobody) = (libc::MAP_PRIVATE | libc::MAP_ANONYMOUS, libc::PROT_NONE);
        let pages = libc::mmap(std::ptr::null_mut(), bytes, nobody, private, -1, 0);
        pages != libc::MAP_FAILED && libc::munmap(pages, bytes) == 0
    }
}

/// Bytes of memory of the machine.
pub fn physical() -> usize {
    system_number(libc::_SC_PHYS_PAGES) * page()
}

fn page() -> usize {
    system_number(libc::_SC_PAGESIZE)
}

fn system_number(name: libc::c_int) -> usize {
    // SAFETY: only reads a number.
    usize::try_from(unsafe { libc::sysconf(name) }).unwrap_or(0)
}

/// Blocks of at least this size get their own pages.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const OWN_PAGES: libc::c_int = 256 << 10;

/// Makes the allocator return freed memory to the system at once: a run with a limit counts resident pages.
pub fn give_back_early() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: only sets parameters of the allocator.
    unsafe {
        libc::mallopt(libc::M_MMAP_THRESHOLD, OWN_PAGES);
        libc::mallopt(libc::M_TRIM_THRESHOLD, OWN_PAGES);
    }
}

/// Makes all threads share one heap: each further heap takes 64 MiB of address space even if it is empty.
pub fn share_heap() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: only sets a parameter of the allocator.
    unsafe {
        libc::mallopt(libc::M_ARENA_MAX, 1);
    }
}

/// Returns free memory of the heap to the system.
pub fn give_back() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: may be called at any time from any thread.
    unsafe {
        libc::malloc_trim(0);
    }
}

/// Writes to standard error even if it is locked; errors are ignored.
pub fn tell(mut text: &[u8]) {
    while !text.is_empty() {
        // SAFETY: pointer and length are those of a slice.
        let written = unsafe { libc::write(libc::STDERR_FILENO, text.as_ptr().cast(), text.len()) };
        match usize::try_from(written) {
            Ok(written) => text = &text[written.min(text.len())..],
            // A signal came before anything was written, so try again.
            Err(_) if std::io::Error::last_os_error().kind() == std::io::ErrorKind::Interrupted => {}
            Err(_) => return,
        }
    }
}

/// Ends the process now.
pub fn exit(code: i32) -> ! {
    // SAFETY: no further code of the program runs.
    unsafe { libc::_exit(code) }
}

/// Calls `handle` when the process aborts; if it returns, the process aborts as usual.
pub fn on_abort(handle: extern "C" fn(libc::c_int)) {
    // SAFETY: the handler has the right type, and no other code sets one for this signal.
    unsafe { libc::signal(libc::SIGABRT, handle as *const () as libc::sighandler_t) };
}

/// Removes the handler of [`on_abort`].
pub fn restore_abort() {
    // SAFETY: as in `on_abort`; this sets the default action.
    unsafe { libc::signal(libc::SIGABRT, libc::SIG_DFL) };
}
