//! Sets of components of a grid point.

/// A set of components 1 to 6 of a grid point. The empty set stands for component 0 of a scalar point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Components(u8);

impl Components {
    pub const ALL: Self = Self(0b111_1110);
    pub const TRANSLATIONS: Self = Self(0b000_1110);

    /// The set that holds one component, 1 to 6.
    pub fn one(component: u8) -> Self {
        Self(1 << component)
    }

    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    pub fn len(self) -> usize {
        self.0.count_ones() as usize
    }

    pub fn contains(self, component: u8) -> bool {
        self.0 >> component & 1 == 1
    }

    /// The components of `self` without those of `other`.
    pub fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// The set with this component added.
    pub fn with(self, component: u8) -> Self {
        Self(self.0 | 1 << component)
    }

    pub fn or(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    pub fn and(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    /// The components, ascending.
    pub fn iter(self) -> impl Iterator<Item = u8> {
        (1..=6).filter(move |&component| self.contains(component))
    }

    /// Parses digits such as `246`. `0` and an empty text give the empty set.
    pub fn parse(word: &[u8]) -> Option<Self> {
        if word == b"0" {
            return Some(Self(0));
        }
        word.iter()
            .try_fold(Self(0), |set, &digit| matches!(digit, b'1'..=b'6').then(|| Self(set.0 | 1 << (digit - b'0'))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn components_are_digits() {
        let set = Components::parse(b"2461").expect("components");
        assert_eq!(set.iter().collect::<Vec<_>>(), [1, 2, 4, 6]);
        assert_eq!((set.len(), set.contains(3), set.contains(6)), (4, false, true));
        assert_eq!(Components::ALL.without(set).iter().collect::<Vec<_>>(), [3, 5]);
        assert_eq!(Components::parse(b"0"), Some(Components::default()));
        assert!(Components::parse(b"7").is_none() && Components::parse(b"1.").is_none());
        assert!(Components::parse(b"10").is_none());
    }
}
