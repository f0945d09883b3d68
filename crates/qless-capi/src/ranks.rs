//! The ranks of a job, by functions of the caller that pass messages. The library links no MPI, so that it serves every MPI.
//!
//! The methods of [`Ranks`] cannot fail. If a function of the caller does, the call ends at once: [`end_call`] unwinds from here to `guard`
//! after the function has returned, so that no function of C is on the way.

use std::ffi::{c_int, c_void};

use qless_mpi::{Message, Ranks};

use crate::status::{CallFailure, end_call};

type Exchange = unsafe extern "C" fn(*mut c_void, *const u64, *const i64, *mut u64, *const i64) -> c_int;
type Reduce = unsafe extern "C" fn(*mut c_void, *mut u64, i64, c_int) -> c_int;
type Gather = unsafe extern "C" fn(*mut c_void, *const u64, i64, *mut u64) -> c_int;

/// Sends to each rank its words, and receives those of each rank: `MPI_Alltoallv` of 64-bit words in the order of the ranks.
#[expect(non_camel_case_types, reason = "a name of C")]
pub type qless_exchange = Option<Exchange>;
/// Replaces numbers by their sums over all ranks, or by their maxima: `MPI_Allreduce`.
#[expect(non_camel_case_types, reason = "a name of C")]
pub type qless_reduce = Option<Reduce>;
/// Collects the numbers of all ranks in the order of the ranks: `MPI_Allgather`.
#[expect(non_camel_case_types, reason = "a name of C")]
pub type qless_gather = Option<Gather>;

/// The ranks of a job, from the view of one rank.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct qless_ranks {
    /// Passed to each function.
    pub context: *mut c_void,
    /// The number of this rank, from 0.
    pub rank: i32,
    /// The number of ranks.
    pub size: i32,
    /// Passes messages.
    pub exchange: qless_exchange,
    /// Sums or maxima.
    pub reduce: qless_reduce,
    /// Collects numbers.
    pub gather: qless_gather,
}

/// [`qless_ranks`] after a check that every function is there.
pub(crate) struct CallerRanks {
    context: *mut c_void,
    rank: usize,
    size: usize,
    exchange: Exchange,
    reduce: Reduce,
    gather: Gather,
}

impl CallerRanks {
    /// # Safety
    /// `ranks` is null or points to a structure whose functions do what the header states, while the result lives.
    pub(crate) unsafe fn new(ranks: *const qless_ranks) -> Result<Self, CallFailure> {
        if ranks.is_null() || !ranks.is_aligned() {
            return Err(CallFailure::input(
                "ranks is no address of a qless_ranks; qless_mpi_ranks of qless_mpi.h sets one",
            ));
        }
        // SAFETY: not null and aligned, and the caller upholds the contract.
        let qless_ranks { context, rank, size, exchange, reduce, gather } = unsafe { ranks.read() };
        let (Some(exchange), Some(reduce), Some(gather)) = (exchange, reduce, gather) else {
            return Err(CallFailure::input("a function of ranks is null; give exchange, reduce and gather"));
        };
        if rank < 0 || rank >= size {
            return Err(CallFailure::input(format!("rank {rank} of {size} ranks; ranks count from 0")));
        }
        Ok(Self { context, rank: rank as usize, size: size as usize, exchange, reduce, gather })
    }

    /// Sends `sent`, cut into pieces of these lengths, and receives pieces of the other lengths.
    fn transfer(&self, sent: &[u64], sent_counts: &[i64], received_counts: &[i64]) -> Vec<u64> {
        let mut received =
            zeros(received_counts.iter().try_fold(0, |sum: usize, &count| sum.checked_add(count as usize)));
        // SAFETY: the arrays have the lengths that the header states.
        let status = unsafe {
            let (counts, expected) = (sent_counts.as_ptr(), received_counts.as_ptr());
            (self.exchange)(self.context, sent.as_ptr(), counts, received.as_mut_ptr(), expected)
        };
        need("exchange", status);
        received
    }

    fn combine(&self, numbers: &mut [u64], is_max: c_int) {
        // SAFETY: the array has this length.
        let status = unsafe { (self.reduce)(self.context, numbers.as_mut_ptr(), numbers.len() as i64, is_max) };
        need("reduce", status);
    }
}

/// Ends the call if a function of the caller failed.
fn need(function: &str, status: c_int) {
    if status != 0 {
        end_call(CallFailure::ranks(format!(
            "the function {function} of ranks returned {status}; the ranks are no longer at the same place, so end the job"
        )));
    }
}

/// Room for received words. A function that does not pass lengths as they are would ask for any number.
fn zeros(count: Option<usize>) -> Vec<u64> {
    let mut words = Vec::new();
    match count {
        Some(count) if words.try_reserve_exact(count).is_ok() => words.resize(count, 0),
        _ => end_call(CallFailure::ranks("other ranks send more words than this rank has memory for".to_owned())),
    }
    words
}

impl Ranks for CallerRanks {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.size
    }

    /// The first transfer announces the lengths, plus 1 for a message, since a message may have no words.
    fn exchange(&self, mut messages: Vec<Message>) -> Vec<Message> {
        messages.sort_by_key(|message| message.rank);
        let (mut announced, mut counts, ones) = (vec![0; self.size], vec![0; self.size], vec![1; self.size]);
        for message in &messages {
            announced[message.rank] = 1 + message.words.len() as u64;
            counts[message.rank] = message.words.len() as i64;
        }
        let expected = self.transfer(&announced, &ones, &ones);
        let lengths: Vec<i64> =
            expected.iter().map(|words| words.saturating_sub(1).min(i64::MAX as u64) as i64).collect();
        let sent: Vec<u64> = messages.into_iter().flat_map(|message| message.words).collect();
        let received = self.transfer(&sent, &counts, &lengths);
        let mut rest = &received[..];
        let mut cut = |length: i64| rest.split_off(..length as usize).unwrap_or_default().to_vec();
        let pieces: Vec<Vec<u64>> = lengths.into_iter().map(&mut cut).collect();
        let came = pieces.into_iter().zip(expected).enumerate().filter(|(_, (_, words))| *words > 0);
        came.map(|(rank, (words, _))| Message { rank, words }).collect()
    }

    /// Nothing overlaps: a function of the caller returns when its messages have arrived.
    fn overlap(&self, messages: Vec<Message>, from: &[usize], work: &mut dyn FnMut()) -> Vec<Message> {
        work();
        let mut came = self.exchange(messages);
        came.retain(|message| from.contains(&message.rank));
        came
    }

    fn sum(&self, numbers: &mut [u64]) {
        self.combine(numbers, 0);
    }

    fn max(&self, numbers: &mut [u64]) {
        self.combine(numbers, 1);
    }

    fn gather(&self, numbers: &[u64]) -> Vec<u64> {
        let mut all = zeros(numbers.len().checked_mul(self.size));
        // SAFETY: the arrays have the lengths that the header states.
        let status = unsafe { (self.gather)(self.context, numbers.as_ptr(), numbers.len() as i64, all.as_mut_ptr()) };
        need("gather", status);
        all
    }
}
