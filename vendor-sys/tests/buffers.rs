//! OpenBLAS with more callers than there is room for buffers: each has one when it is let in, and nobody asks for ever.
//!
//! A process of its own, because its address space is limited.
#![cfg(target_os = "linux")]
#![allow(unsafe_code, reason = "calls OpenBLAS without a wrapper")]

use std::ffi::{CStr, c_int, c_void};
use std::mem::transmute;
use std::sync::mpsc::channel;
use std::time::Duration;

use spqr_sys::blas;

const CALLERS: usize = 12;
/// For six buffers and a half.
const ROOM: u64 = 830 << 20;
/// How often each caller is let in, ...
const ROUNDS: usize = 20;
/// ... and how often it calls then: enough to meet others that come.
const CALLS: usize = 10_000;

fn find(name: &CStr) -> Option<*mut c_void> {
    // SAFETY: the name is a C string; nothing is loaded or called.
    let found = unsafe { libc::dlsym(libc::RTLD_DEFAULT, name.as_ptr()) };
    (!found.is_null()).then_some(found)
}

/// What a BLAS function does with its buffer; none with another BLAS.
fn call() -> Option<impl Fn() + Copy + Send> {
    let (take, give_back) = (find(c"blas_memory_alloc")?, find(c"blas_memory_free")?);
    // SAFETY: these are the functions' types in OpenBLAS, which alone has these names.
    let (take, give_back) = unsafe {
        (
            transmute::<*mut c_void, extern "C" fn(c_int) -> *mut c_void>(take),
            transmute::<*mut c_void, extern "C" fn(*mut c_void)>(give_back),
        )
    };
    Some(move || give_back(take(0)))
}

/// Leaves room for so many bytes of address space.
fn limit(bytes: u64) {
    let text = std::fs::read_to_string("/proc/self/statm").expect("Linux has it");
    let pages: u64 = text.split_whitespace().next().and_then(|word| word.parse().ok()).expect("a number");
    let limit = libc::rlimit { rlim_cur: pages * 4096 + bytes, rlim_max: libc::RLIM_INFINITY };
    // SAFETY: the struct is ours and as the call wants it.
    assert_eq!(unsafe { libc::setrlimit(libc::RLIMIT_AS, &raw const limit) }, 0);
}

/// It is never asked for buffers, so that nobody waits for one. An OpenBLAS without the functions that make them is a defect.
fn another_blas_has_room_for_all() {
    assert_eq!(blas::threads(), None, "an OpenBLAS that does not tell of its buffers");
    let held: Vec<_> = (1..=CALLERS).map(|callers| blas::hold(callers).expect("no limit").callers()).collect();
    assert!(held.into_iter().eq(1..=CALLERS));
    let (one, other) = (blas::hold(CALLERS), blas::hold(CALLERS));
    assert_eq!([&one, &other].map(|held| held.as_ref().map(blas::Held::callers)), [Some(CALLERS); 2]);
}

#[test]
fn nobody_asks_for_ever_where_there_is_no_room() {
    // Has the library linked, and with it its BLAS.
    drop(spqr_sys::memory::Common::start().expect("memory"));
    let Some(call) = call() else {
        return another_blas_has_room_for_all();
    };
    // Threads, their stacks and heaps are there before the limit is.
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
