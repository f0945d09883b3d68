//! `out_e = sum_k x_(e,k)`: sums of given numbers, those of equally many together.
//!
//! Every entry has at least one number: these are copied in one sweep. What else an entry sums follows by the count of it, in loops of
//! known length. The numbers of an entry keep their order, so that the sum has the same bits whoever makes it.
//! Places are kept in 16 bits where that is enough, which it is but for rows of enormous length: they are most of what is read.

/// The x that 16 bits can name; so many are always there, and no place has to be checked.
pub const NUMBERS: usize = 1 << 16;

/// Where the numbers of each entry come from.
pub enum Sums {
    Short(Parts<u16>),
    Long(Parts<u32>),
}

/// Places in 16 or 32 bits.
#[derive(Default)]
pub struct Parts<I> {
    first: Vec<I>,
    more: Vec<More<I>>,
}

/// Entries with equally many numbers after the first.
struct More<I> {
    count: usize,
    entry: Vec<I>,
    /// `count` for each entry.
    from: Vec<I>,
}

impl Default for Sums {
    fn default() -> Self {
        Self::Short(Parts::default())
    }
}

impl Sums {
    /// From `(entry, number)`, ascending by entry; entries are `0..entries`, none is without a number, and numbers are below `numbers`.
    pub fn new(entries: usize, numbers: usize, parts: &[(u32, u32)]) -> Self {
        if entries.max(numbers) <= NUMBERS {
            Self::Short(Parts::new(entries, parts, |k| k as u16))
        } else {
            Self::Long(Parts::new(entries, parts, |k| k))
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

impl<I: Copy> Parts<I> {
    /// `parts` ascend by entry.
    fn new(entries: usize, parts: &[(u32, u32)], short: impl Fn(u32) -> I) -> Self {
        let mut sums = Self { first: Vec::with_capacity(entries), more: Vec::new() };
        for same in parts.chunk_by(|a, b| a.0 == b.0) {
            sums.first.push(short(same[0].1));
            if same.len() > 1 {
                let more = sums.more_of(same.len() - 1);
                more.entry.push(short(same[0].0));
                more.from.extend(same[1..].iter().map(|&(_, k)| short(k)));
            }
        }
        debug_assert_eq!(sums.first.len(), entries);
        sums
    }

    fn more_of(&mut self, count: usize) -> &mut More<I> {
        let known = self.more.iter().position(|more| more.count == count);
        let place = known.unwrap_or(self.more.len());
        if known.is_none() {
            self.more.push(More { count, entry: Vec::new(), from: Vec::new() });
        }
        &mut self.more[place]
    }

    #[inline]
    fn write(&self, out: &mut [f64], x: impl Fn(I) -> f64 + Copy, place: impl Fn(I) -> usize + Copy) {
        let (out_eight, out_rest) = out.as_chunks_mut::<8>();
        let (eight, rest) = self.first.as_chunks::<8>();
        for (out, from) in out_eight.iter_mut().zip(eight) {
            (0..8).for_each(|k| out[k] = x(from[k]));
        }
        out_rest.iter_mut().zip(rest).for_each(|(out, &k)| *out = x(k));
        for more in &self.more {
            match more.count {
                1 => more.fixed::<1>(out, x, place),
                2 => more.fixed::<2>(out, x, place),
                3 => more.fixed::<3>(out, x, place),
                4 => more.fixed::<4>(out, x, place),
                5 => more.fixed::<5>(out, x, place),
                6 => more.fixed::<6>(out, x, place),
                7 => more.fixed::<7>(out, x, place),
                _ => more.any(out, x, place),
            }
        }
    }
}

impl<I: Copy> More<I> {
    #[inline]
    fn fixed<const N: usize>(&self, out: &mut [f64], x: impl Fn(I) -> f64, place: impl Fn(I) -> usize) {
        let (from, _) = self.from.as_chunks::<N>();
        for (&entry, from) in self.entry.iter().zip(from) {
            let out = &mut out[place(entry)];
            let mut sum = *out;
            (0..N).for_each(|k| sum += x(from[k]));
            *out = sum;
        }
    }

    fn any(&self, out: &mut [f64], x: impl Fn(I) -> f64, place: impl Fn(I) -> usize) {
        for (&entry, from) in self.entry.iter().zip(self.from.chunks_exact(self.count)) {
            let out = &mut out[place(entry)];
            *out = from.iter().fold(*out, |sum, &k| sum + x(k));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counts from one number to more than any loop of known length has.
    #[test]
    fn sums_are_those_of_the_parts() {
        let entries: u32 = 40;
        let x: Vec<f64> = (0..200).map(|k| f64::from(k * k % 97) / 8.0).collect();
        let count = |entry: u32| 1 + entry % 13;
        let number = |entry: u32, k: u32| (entry * 31 + k * 17) % 200;
        let longest = (0..13).flat_map(|k| (0..entries).rev().map(move |entry| (entry, k)));
        let parts = longest.filter(|&(entry, k)| k < count(entry)).map(|(entry, k)| (entry, number(entry, k)));
        let mut parts: Vec<_> = parts.collect();
        parts.sort_by_key(|&(entry, _)| entry);
        for sums in [Sums::new(entries as usize, x.len(), &parts), Sums::new(entries as usize, NUMBERS + 1, &parts)] {
            let mut out = vec![f64::NAN; entries as usize];
            sums.write(&x, &mut out);
            for entry in 0..entries {
                let truth: f64 = (0..count(entry)).map(|k| x[number(entry, k) as usize]).sum();
                assert_eq!(out[entry as usize], truth, "entry {entry}");
            }
        }
    }
}
