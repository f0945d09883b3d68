//! OpenBLAS with more callers than memory for buffers: every admitted caller has a buffer, and none waits for ever.
//!
//! It is a test program of its own because it limits the address space.
#![cfg(target_os = "linux")]
#![allow(unsafe_code, reason = "calls OpenBLAS without a wrapper")]

use std::ffi::{CStr, c_int, c_void};
use std::mem::transmute;
use std::sync::mpsc::channel;
use std::time::Duration;

use spqr_sys::blas;

const CALLERS: usize = 12;
/// Memory for six and a half buffers.
const ROOM: u64 = 830 << 20;
/// Number of times that each caller is admitted.
const ROUNDS: usize = 20;
/// Calls each time; enough to overlap with other callers.
const CALLS: usize = 10_000;

fn find(name: &CStr) -> Option<*mut c_void> {
    // SAFETY: the name is a C string, and the lookup calls nothing.
    let found = unsafe { libc::dlsym(libc::RTLD_DEFAULT, name.as_ptr()) };
    (!found.is_null()).then_some(found)
}

/// Takes and returns a buffer, as a BLAS function does; `None` with another BLAS.
fn call() -> Option<impl Fn() + Copy + Send> {
    let (take, give_back) = (find(c"blas_memory_alloc")?, find(c"blas_memory_free")?);
    // SAFETY: only OpenBLAS has these names, and these are the functions' types there.
    let (take, give_back) = unsafe {
        (
            transmute::<*mut c_void, extern "C" fn(c_int) -> *mut c_void>(take),
            transmute::<*mut c_void, extern "C" fn(*mut c_void)>(give_back),
        )
    };
    Some(move || give_back(take(0)))
}

/// Limits the address space to the present use and `bytes` more.
fn limit(bytes: u64) {
    let text = std::fs::read_to_string("/proc/self/statm").expect("Linux has it");
    let pages: u64 = text.split_whitespace().next().and_then(|word| word.parse().ok()).expect("a number");
    let limit = libc::rlimit { rlim_cur: pages * 4096 + bytes, rlim_max: libc::RLIM_INFINITY };
    // SAFETY: the struct is initialized and alive.
    assert_eq!(unsafe { libc::setrlimit(libc::RLIMIT_AS, &raw const limit) }, 0);
}

/// Another BLAS gets no request for buffers, so no caller waits. An OpenBLAS without these functions fails the test.
fn another_blas_has_room_for_all() {
    assert_eq!(blas::threads(), None, "an OpenBLAS that does not export its buffer functions");
    let held: Vec<_> = (1..=CALLERS).map(|callers| blas::hold(callers).expect("no limit").callers()).collect();
    assert!(held.into_iter().eq(1..=CALLERS));
    let (one, other) = (blas::hold(CALLERS), blas::hold(CALLERS));
    assert_eq!([&one, &other].map(|held| held.as_ref().map(blas::Held::callers)), [Some(CALLERS); 2]);
}

#[test]
fn nobody_asks_for_ever_where_there_is_no_room() {
    // A call of the library makes the linker keep it and its BLAS.
    drop(spqr_sys::memory::Common::start().expect("memory"));
    let Some(call) = call() else {
        return another_blas_has_room_for_all();
    };
    // Threads get their stacks and heaps before the limit is set.
    let (ended, end) = channel();
    let (starts, threads): (Vec<_>, Vec<_>) = (0..CALLERS)
        .map(|_| {
            let (start, wait) = channel::<()>();
            let ended = ended.clone();
            let thread = std::thread::spawn(move || {
                let begun = std::hint::black_box(vec![0_u8; 1 << 10]);
                wait.recv().expect("told to start");
                for _ in 0..ROUNDS {
                    let held = blas::hold(1).expect("room for one");
                    (0..CALLS).for_each(|_| call());
                    drop(held);
                }
                drop(begun);
                ended.send(()).expect("somebody waits");
            });
            (start, thread)
        })
        .unzip();
    std::thread::sleep(Duration::from_millis(100));
    limit(ROOM);
    starts.iter().for_each(|start| start.send(()).expect("it waits"));
    for _ in 0..CALLERS {
        end.recv_timeout(Duration::from_secs(30)).expect("a caller asks OpenBLAS for ever");
    }
    for thread in threads {
        thread.join().expect("no panic");
    }
}
