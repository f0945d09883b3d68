//! Digits to whole numbers, eight bytes at a time: numbers are most of the bytes of a deck.

const TENS: [u64; 9] = [1, 10, 100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000];

/// The number of the digits that the text begins with, and how many they are. More than 19 overflow.
pub(crate) fn digits(text: &[u8]) -> (u64, usize) {
    let (mut value, mut end) = (0_u64, 0);
    while let Some(bytes) = text.get(end..).and_then(<[u8]>::first_chunk) {
        let word = u64::from_le_bytes(*bytes);
        let count = count(word);
        if count > 0 {
            // Earlier bytes are lower ones; those shifted in are zeros before the number.
            let digits = of_eight(word << (64 - 8 * count));
            value = value.wrapping_mul(TENS[count]).wrapping_add(digits);
            end += count;
        }
        if count < 8 {
            return (value, end);
        }
    }
    while let Some(digit) = text.get(end).map(|byte| byte.wrapping_sub(b'0')).filter(|digit| *digit < 10) {
        (value, end) = (value.wrapping_mul(10).wrapping_add(u64::from(digit)), end + 1);
    }
    (value, end)
}

/// The number of blanks that the text begins with.
pub(crate) fn blanks(text: &[u8]) -> usize {
    const BLANKS: u64 = u64::from_le_bytes([b' '; 8]);
    let mut count = 0;
    while let Some(bytes) = text[count..].first_chunk() {
        let these = (u64::from_le_bytes(*bytes) ^ BLANKS).trailing_zeros() as usize / 8;
        count += these;
        if these < 8 {
            return count;
        }
    }
    count + text[count..].iter().take_while(|byte| **byte == b' ').count()
}

/// How many of eight bytes, from the first on, are digits.
fn count(word: u64) -> usize {
    let off = word ^ u64::from_le_bytes([b'0'; 8]);
    // The top bit of a byte is set where it is no digit; what is carried on comes after such a byte.
    let others = (off.wrapping_add(u64::from_le_bytes([0x76; 8])) | off) & u64::from_le_bytes([0x80; 8]);
    others.trailing_zeros() as usize / 8
}

/// The number of eight digits: pairs of digits, then pairs of pairs, then both halves.
fn of_eight(word: u64) -> u64 {
    let ones = word & 0x0f0f_0f0f_0f0f_0f0f;
    let pairs = (ones * 10 + (ones >> 8)) & 0x00ff_00ff_00ff_00ff;
    let fours = (pairs * 100 + (pairs >> 16)) & 0x0000_ffff_0000_ffff;
    (fours * 10_000 + (fours >> 32)) & 0xffff_ffff
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_read_up_to_what_is_none() {
        for count in 0..=19 {
            let number = &"9182736450123456789"[..count];
            for other in 0..=u8::MAX {
                for rest in ["", "1", "12345678901234567890"] {
                    let mut text = number.as_bytes().to_vec();
                    if !other.is_ascii_digit() {
                        text.push(other);
                        text.extend_from_slice(rest.as_bytes());
                    }
                    assert_eq!(digits(&text), (number.parse().unwrap_or(0), count), "{text:?}");
                }
            }
        }
    }

    #[test]
    fn blanks_are_counted() {
        for count in 0..30 {
            for rest in ["", "x", "\t  ", "1          "] {
                assert_eq!(blanks(format!("{}{rest}", " ".repeat(count)).as_bytes()), count);
            }
        }
    }
}
