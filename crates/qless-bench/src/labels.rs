//! Labels of plots that do not overlap, and numbers with commas.

/// The positions of the labels placed so far, in pixels: left, right and height of each.
#[derive(Default)]
pub struct PlotLabels(Vec<(i32, i32, i32)>);

impl PlotLabels {
    /// The vertical offset at which a label of `letters` letters overlaps no other.
    pub fn place(&mut self, (x, y): (i32, i32), letters: usize) -> i32 {
        const HEIGHT: i32 = 13;
        let (left, right) = (x, x + 8 + 6 * letters as i32);
        let is_free = |lift: &i32| {
            let meets = |&(l, r, h): &(i32, i32, i32)| left < r && l < right && (y + lift - h).abs() < HEIGHT;
            !self.0.iter().any(meets)
        };
        let lifts = (0..40).map(|k| -6 + HEIGHT * if k % 2 == 0 { k / 2 } else { -(k + 1) / 2 });
        let lift = lifts.into_iter().find(is_free).unwrap_or(-6);
        self.0.push((left, right, y + lift));
        lift
    }
}

/// `31,832`.
pub fn thousands(number: usize) -> String {
    let digits = number.to_string();
    let mut out = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::PlotLabels;

    #[test]
    fn labels_do_not_meet() {
        let mut labels = PlotLabels::default();
        let lifts: Vec<i32> = (0..5).map(|k| labels.place((100 + k, 100), 10)).collect();
        assert_eq!(lifts, [-6, -19, 7, -32, 20]);
        assert_eq!((labels.place((300, 100), 10), labels.place((100, 300), 10)), (-6, -6));
    }
}
