//! `out_e = sum_k x_(e,k)`: sums of selected numbers, in loops of known length over entries with equally many terms.
//!
//! If most entries have one term, the first term of every entry is copied in one sweep, and further terms are added. If most entries
//! have several terms, each sum is written directly. The terms of an entry keep their order, so the result has the same bits either way.
//! Indices are most of the memory that is read, so they are stored in 16 bits if possible.

/// Number of x that 16 bits can address. Callers pass at least as many, so that the compiler can remove bounds checks.
pub const NUMBERS: usize = 1 << 16;

/// The terms of each entry.
pub enum EntrySums {
    Short(SumTables<u16>),
    Long(SumTables<u32>),
}

/// Indices in 16 or 32 bits.
#[derive(Default)]
pub struct SumTables<I> {
    /// The first term of every entry, if these are copied in one sweep.
    first: Vec<I>,
    more: Vec<SumGroup<I>>,
}

/// Entries with equally many terms, not counting a first term that was copied.
struct SumGroup<I> {
    count: usize,
    entry: Vec<I>,
    /// `count` indices for each entry.
    from: Vec<I>,
}

impl Default for EntrySums {
    fn default() -> Self {
        Self::Short(SumTables::default())
    }
}

impl EntrySums {
    /// `counts`: number of terms of each entry, at least one. `keys`: the indices of all terms, entry by entry, in the lower halves; all of
    /// them are below `numbers`.
    pub fn new(numbers: usize, counts: &[u32], keys: &[u64]) -> Self {
        if counts.len().max(numbers) <= NUMBERS {
            Self::Short(SumTables::new(counts, keys, |k| k as u16))
        } else {
            Self::Long(SumTables::new(counts, keys, |k| k))
        }
    }

    /// Writes every entry; x has at least [`NUMBERS`] numbers.
    pub fn write(&self, x: &[f64], out: &mut [f64]) {
        match (self, x.first_chunk::<NUMBERS>()) {
            (Self::Short(parts), Some(x)) => parts.write(out, |k| x[usize::from(k)], usize::from),
            (Self::Short(parts), None) => parts.write(out, |k| x[usize::from(k)], usize::from),
            (Self::Long(parts), _) => parts.write(out, |k| x[k as usize], |entry| entry as usize),
        }
    }
}

impl<I: Copy> SumTables<I> {
    fn new(counts: &[u32], keys: &[u64], short: impl Fn(u32) -> I) -> Self {
        let single = counts.iter().filter(|&&count| count == 1).count();
        let sweep = 2 * single >= counts.len();
        let ((mut sums, place), mut rest) = (Self::with_room(counts, sweep), keys);
        for (entry, &count) in (0..).zip(counts) {
            let mut own;
            (own, rest) = rest.split_at(count as usize);
            if sweep {
                sums.first.push(short(own[0] as u32));
                own = &own[1..];
            }
            if let Some(more) = sums.more.get_mut(place[own.len()]) {
                more.entry.push(short(entry));
                more.from.extend(own.iter().map(|&key| short(key as u32)));
            }
        }
        sums
    }

    /// Allocates the groups; also returns the index of the group for each count.
    fn with_room(counts: &[u32], sweep: bool) -> (Self, Vec<usize>) {
        let most = counts.iter().max().map_or(0, |&most| most as usize);
        let mut entries = vec![0; most + 1];
        counts.iter().for_each(|&count| entries[count as usize - usize::from(sweep)] += 1);
        let first = Vec::with_capacity(if sweep { counts.len() } else { 0 });
        let (mut more, mut place) = (Vec::new(), vec![usize::MAX; most + 1]);
        for (count, entries) in entries.into_iter().enumerate().filter(|&(count, entries)| count > 0 && entries > 0) {
            place[count] = more.len();
            let from = Vec::with_capacity(entries * count);
            more.push(SumGroup { count, entry: Vec::with_capacity(entries), from });
        }
        (Self { first, more }, place)
    }

    #[inline]
    fn write(&self, out: &mut [f64], x: impl Fn(I) -> f64 + Copy, place: impl Fn(I) -> usize + Copy) {
        if self.first.is_empty() {
            return self.more.iter().for_each(|more| more.write::<false>(out, x, place));
        }
        let (out_eight, out_rest) = out.as_chunks_mut::<8>();
        let (eight, rest) = self.first.as_chunks::<8>();
        for (out, from) in out_eight.iter_mut().zip(eight) {
            (0..8).for_each(|k| out[k] = x(from[k]));
        }
        out_rest.iter_mut().zip(rest).for_each(|(out, &k)| *out = x(k));
        self.more.iter().for_each(|more| more.write::<true>(out, x, place));
    }
}

impl<I: Copy> SumGroup<I> {
    /// Writes the sums, or adds them to the present values.
    #[inline]
    fn write<const ADD: bool>(&self, out: &mut [f64], x: impl Fn(I) -> f64 + Copy, place: impl Fn(I) -> usize + Copy) {
        match self.count {
            1 => self.fixed::<1, ADD>(out, x, place),
            2 => self.fixed::<2, ADD>(out, x, place),
            3 => self.fixed::<3, ADD>(out, x, place),
            4 => self.fixed::<4, ADD>(out, x, place),
            5 => self.fixed::<5, ADD>(out, x, place),
            6 => self.fixed::<6, ADD>(out, x, place),
            7 => self.fixed::<7, ADD>(out, x, place),
            8 => self.fixed::<8, ADD>(out, x, place),
            _ => self.any::<ADD>(out, x, place),
        }
    }

    #[inline]
    fn fixed<const N: usize, const ADD: bool>(
        &self,
        out: &mut [f64],
        x: impl Fn(I) -> f64,
        place: impl Fn(I) -> usize,
    ) {
        let (from, _) = self.from.as_chunks::<N>();
        for (&entry, from) in self.entry.iter().zip(from) {
            let out = &mut out[place(entry)];
            let mut sum = if ADD { *out + x(from[0]) } else { x(from[0]) };
            (1..N).for_each(|k| sum += x(from[k]));
            *out = sum;
        }
    }

    fn any<const ADD: bool>(&self, out: &mut [f64], x: impl Fn(I) -> f64, place: impl Fn(I) -> usize) {
        for (&entry, from) in self.entry.iter().zip(self.from.chunks_exact(self.count)) {
            let out = &mut out[place(entry)];
            let first = if ADD { *out + x(from[0]) } else { x(from[0]) };
            *out = from[1..].iter().fold(first, |sum, &k| sum + x(k));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counts from one term to more than any loop of fixed length has; in the second half, most entries have one term.
    #[test]
    fn sums_are_those_of_the_parts() {
        let x: Vec<f64> = (0..200).map(|k| f64::from(k * k % 97) / 8.0).collect();
        let number = |entry: usize, k: u32| (entry as u32 * 31 + k * 17) % 200;
        for most in [13, 1] {
            let counts: Vec<u32> =
                (0..80).map(|entry| if entry < 40 { 1 + entry % 13 } else { 1 + entry % most }).collect();
            let of = |(entry, &count): (usize, &u32)| (0..count).map(move |k| number(entry, k));
            let keys: Vec<u64> = counts.iter().enumerate().flat_map(of).map(|k| 7 << 32 | u64::from(k)).collect();
            for sums in [EntrySums::new(x.len(), &counts, &keys), EntrySums::new(NUMBERS + 1, &counts, &keys)] {
                let mut out = vec![f64::NAN; counts.len()];
                sums.write(&x, &mut out);
                for (entry, out) in out.iter().enumerate() {
                    let truth: f64 = of((entry, &counts[entry])).map(|k| x[k as usize]).sum();
                    assert_eq!(*out, truth, "entry {entry}, at most {most}");
                }
            }
        }
    }
}
