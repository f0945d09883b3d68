//! Two other users of CHOLMOD in this process, with their own allocation functions. Each compares its results with its first result.

use std::ffi::{CStr, c_char, c_int, c_void};
use std::mem::zeroed;
use std::ptr::{from_mut, null_mut};
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU64, Ordering::SeqCst};

use qless::backend::spqr::sys::{self, cholmod_common, cholmod_dense, cholmod_sparse};

type Factor = c_void;
type Common = *mut cholmod_common;

unsafe extern "C" {
    fn cholmod_l_analyze(a: *mut cholmod_sparse, common: Common) -> *mut Factor;
    fn cholmod_l_factorize(a: *mut cholmod_sparse, factor: *mut Factor, common: Common) -> c_int;
    fn cholmod_l_solve(system: c_int, factor: *mut Factor, b: *mut cholmod_dense, common: Common)
    -> *mut cholmod_dense;
    fn cholmod_l_free_factor(factor: *mut *mut Factor, common: Common) -> c_int;
    fn malloc(size: usize) -> *mut c_void;
    fn calloc(count: usize, size: usize) -> *mut c_void;
    fn realloc(block: *mut c_void, size: usize) -> *mut c_void;
    fn free(block: *mut c_void);
    fn dlsym(handle: *mut c_void, name: *const c_char) -> *mut c_void;
}

/// The leading members of the struct that SuiteSparse 5 declares.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(unpredictable_function_pointer_comparisons, reason = "copies of one struct")]
struct Hooks {
    malloc: unsafe extern "C" fn(usize) -> *mut c_void,
    calloc: unsafe extern "C" fn(usize, usize) -> *mut c_void,
    realloc: unsafe extern "C" fn(*mut c_void, usize) -> *mut c_void,
    free: unsafe extern "C" fn(*mut c_void),
}

/// Number of blocks that the hooks below allocated and that are not freed.
static HELD: AtomicI64 = AtomicI64::new(0);
static HOOKS: Hooks = Hooks { malloc: my_malloc, calloc: my_calloc, realloc: my_realloc, free: my_free };

unsafe extern "C" fn my_malloc(size: usize) -> *mut c_void {
    HELD.fetch_add(1, SeqCst);
    // SAFETY: forwards its arguments unchanged; so do the functions below.
    unsafe { malloc(size) }
}

unsafe extern "C" fn my_calloc(count: usize, size: usize) -> *mut c_void {
    HELD.fetch_add(1, SeqCst);
    unsafe { calloc(count, size) }
}

unsafe extern "C" fn my_realloc(block: *mut c_void, size: usize) -> *mut c_void {
    HELD.fetch_add(i64::from(block.is_null()), SeqCst);
    unsafe { realloc(block, size) }
}

unsafe extern "C" fn my_free(block: *mut c_void) {
    HELD.fetch_sub(i64::from(!block.is_null()), SeqCst);
    unsafe { free(block) }
}

/// Address of the hooks of SuiteSparse 5; None for later releases, which do not export them.
fn hooks() -> Option<*mut Hooks> {
    let name: &CStr = c"SuiteSparse_config";
    // SAFETY: the name is a C string; nothing is loaded or called.
    let found = unsafe { dlsym(null_mut(), name.as_ptr()) };
    assert!(!found.is_null() || sys::HEADERS.major > 5, "SuiteSparse 5 has hooks");
    (!found.is_null() && sys::HEADERS.major <= 5).then_some(found.cast())
}

/// Runs `work` while the neighbours run. Checks that their results and hooks do not change, and that all blocks are freed.
pub fn undisturbed(work: impl FnOnce()) {
    if let Some(hooks) = hooks() {
        // SAFETY: no threads exist yet, as SuiteSparse requires; the struct lives as long as the process.
        unsafe { *hooks = HOOKS };
    }
    let (stop, rounds) = (AtomicBool::new(false), [AtomicU64::new(0), AtomicU64::new(0)]);
    std::thread::scope(|scope| {
        for (users, rounds) in [least_squares as fn() -> Vec<u64>, cholesky].into_iter().zip(&rounds) {
            let expected = users();
            assert!(expected.len() > 100);
            let stop = &stop;
            scope.spawn(move || {
                while !stop.load(SeqCst) {
                    assert!(users() == expected, "another answer");
                    rounds.fetch_add(1, SeqCst);
                    std::thread::yield_now();
                }
            });
        }
        let stopped = Stop(&stop);
        work();
        drop(stopped);
    });
    let rounds = rounds.map(|rounds| rounds.load(SeqCst));
    println!("the neighbours worked {rounds:?} times");
    assert!(rounds.iter().all(|&rounds| rounds > 2), "{rounds:?}");
    if let Some(hooks) = hooks() {
        // SAFETY: as above.
        assert_eq!(unsafe { *hooks }, HOOKS, "somebody wrote to the hooks");
        assert_eq!(HELD.load(SeqCst), 0, "blocks not freed");
    }
}

/// Stops the threads, also if `work` panics.
struct Stop<'a>(&'a AtomicBool);

impl Drop for Stop<'_> {
    fn drop(&mut self) {
        self.0.store(true, SeqCst);
    }
}

const SIDE: usize = 12;

/// Runs `work` with its own `cholmod_common`; checks that no memory and no error remains.
fn with_common<T>(work: impl FnOnce(Common) -> T) -> T {
    // SAFETY: started and finished in this function.
    unsafe {
        let mut common: Box<cholmod_common> = Box::new(zeroed());
        sys::cholmod_l_start(&raw mut *common);
        let result = work(&raw mut *common);
        assert_eq!(common.status, sys::CHOLMOD_OK);
        sys::cholmod_l_finish(&raw mut *common);
        assert_eq!(common.malloc_count, 0);
        result
    }
}

/// The values of R of a sparse QR of the incidence matrix of a grid.
fn least_squares() -> Vec<u64> {
    let nodes = SIDE * SIDE;
    let edges: Vec<(usize, usize)> = (0..nodes)
        .flat_map(|node| [(node % SIDE + 1 < SIDE).then_some((node, node + 1)), Some((node, node + SIDE))])
        .flatten()
        .filter(|edge| edge.1 < nodes)
        .collect();
    let columns = (0..nodes).map(|node| {
        let of = |(row, edge): (usize, &(usize, usize))| match node {
            node if node == edge.0 => Some((row, 1.0)),
            node if node == edge.1 => Some((row, -1.5)),
            _ => None,
        };
        edges.iter().enumerate().filter_map(of).collect()
    });
    let mut matrix = Matrix::new(edges.len(), columns, 0);
    // SAFETY: the matrix outlives the call; the last start of R is its number of entries.
    with_common(|common| unsafe {
        let (mut r, mut order) = (null_mut(), null_mut());
        let rank = sys::SuiteSparseQR_C(
            sys::SPQR_ORDERING_DEFAULT,
            1e-10,
            edges.len() as i64,
            0,
            &raw mut matrix.view,
            null_mut(),
            null_mut(),
            null_mut(),
            null_mut(),
            &raw mut r,
            &raw mut order,
            null_mut(),
            null_mut(),
            null_mut(),
            common,
        );
        assert_eq!(rank, nodes as i64 - 1, "1.5 times the node before is in the null space");
        let values = bits((*r).x, *(*r).p.cast::<i64>().add(nodes) as usize);
        sys::cholmod_l_free_sparse(&raw mut r, common);
        sys::cholmod_l_free(nodes, size_of::<i64>(), order.cast(), common);
        values
    })
}

/// The solution of a system with the Laplacian of a grid, by CHOLMOD's Cholesky factorization.
fn cholesky() -> Vec<u64> {
    let nodes = SIDE * SIDE;
    let columns = (0..nodes).map(|node| {
        let right = (node % SIDE + 1 < SIDE).then_some((node + 1, -1.0));
        let below = (node + SIDE < nodes).then_some((node + SIDE, -1.0));
        [Some((node, 4.1)), right, below].into_iter().flatten().collect()
    });
    let mut matrix = Matrix::new(nodes, columns, -1);
    let mut ones = vec![1.0; nodes];
    // SAFETY: the matrix and B outlive the calls; the solution is as long as B.
    with_common(|common| unsafe {
        let mut b: cholmod_dense = zeroed();
        (b.nrow, b.ncol, b.nzmax, b.d, b.xtype) = (nodes, 1, nodes, nodes, sys::CHOLMOD_REAL);
        b.x = ones.as_mut_ptr().cast();
        let mut factor = cholmod_l_analyze(&raw mut matrix.view, common);
        assert_eq!(cholmod_l_factorize(&raw mut matrix.view, factor, common), 1);
        let mut x = cholmod_l_solve(0, factor, from_mut(&mut b), common);
        let values = bits((*x).x, nodes);
        sys::cholmod_l_free_dense(&raw mut x, common);
        cholmod_l_free_factor(&raw mut factor, common);
        values
    })
}

/// # Safety
/// `values` points to `count` numbers.
unsafe fn bits(values: *const c_void, count: usize) -> Vec<u64> {
    // SAFETY: the caller's promise.
    unsafe { std::slice::from_raw_parts(values.cast::<u64>(), count) }.to_vec()
}

struct Matrix {
    view: cholmod_sparse,
    _start: Vec<i64>,
    _row: Vec<i64>,
    _value: Vec<f64>,
}

impl Matrix {
    fn new(rows: usize, columns: impl Iterator<Item = Vec<(usize, f64)>>, symmetry: c_int) -> Self {
        let (mut start, mut row, mut value) = (vec![0], Vec::new(), Vec::new());
        for column in columns {
            row.extend(column.iter().map(|entry| entry.0 as i64));
            value.extend(column.iter().map(|entry| entry.1));
            start.push(row.len() as i64);
        }
        // SAFETY: the struct has numbers and nullable pointers, for which zero is valid.
        let mut view: cholmod_sparse = unsafe { zeroed() };
        (view.nrow, view.ncol, view.nzmax, view.stype) = (rows, start.len() - 1, row.len(), symmetry);
        (view.itype, view.xtype, view.sorted, view.packed) = (sys::CHOLMOD_LONG, sys::CHOLMOD_REAL, 1, 1);
        (view.p, view.i) = (start.as_mut_ptr().cast(), row.as_mut_ptr().cast());
        view.x = value.as_mut_ptr().cast();
        Self { view, _start: start, _row: row, _value: value }
    }
}
