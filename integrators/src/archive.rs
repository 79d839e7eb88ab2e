//! Internal data of a method as bytes, for copies of a run that outlive the process.
//!
//! A method lists its data once, in a traversal ([`OneStep::archive`](crate::method::OneStep::archive)). The same
//! traversal writes and reads them, so that both directions agree. Numbers are stored by their bits, little-endian: a
//! restored method continues bit for bit.

/// Reason why bytes are not the data of a method.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ArchiveError {
    /// The bytes end before the data.
    #[error("the stored state is incomplete")]
    Short,
    /// Bytes follow the data.
    #[error("the stored state has {0} bytes too many")]
    Long(usize),
    /// A value is outside of its range.
    #[error("the stored state is damaged: a {0} is out of range")]
    Value(&'static str),
}

/// Direction of a traversal.
#[derive(Debug)]
enum Direction<'a> {
    Write(Vec<u8>),
    Read(&'a [u8]),
}

/// A traversal of stored data: each function writes its argument, or replaces it by the stored value.
#[derive(Debug)]
pub struct Archive<'a>(Direction<'a>);

impl<'a> Archive<'a> {
    /// Starts a traversal that writes.
    pub fn writing() -> Self {
        Archive(Direction::Write(Vec::new()))
    }

    /// Starts a traversal that reads.
    pub fn reading(bytes: &'a [u8]) -> Self {
        Archive(Direction::Read(bytes))
    }

    /// Returns true if values are replaced by stored ones.
    pub fn reads(&self) -> bool {
        matches!(self.0, Direction::Read(_))
    }

    /// Ends a traversal that wrote; empty for one that read.
    #[must_use]
    pub fn into_bytes(self) -> Vec<u8> {
        match self.0 {
            Direction::Write(bytes) => bytes,
            Direction::Read(_) => Vec::new(),
        }
    }

    /// Ends a traversal that read.
    ///
    /// # Errors
    /// Bytes are left.
    pub fn finish(self) -> Result<(), ArchiveError> {
        match self.0 {
            Direction::Read(rest) if !rest.is_empty() => Err(ArchiveError::Long(rest.len())),
            _ => Ok(()),
        }
    }

    fn word(&mut self, x: &mut [u8; 8]) -> Result<(), ArchiveError> {
        match &mut self.0 {
            Direction::Write(bytes) => bytes.extend_from_slice(x),
            Direction::Read(rest) => {
                let (word, left) = rest.split_first_chunk().ok_or(ArchiveError::Short)?;
                (*x, *rest) = (*word, left);
            }
        }
        Ok(())
    }

    /// Traverses a whole number.
    ///
    /// # Errors
    /// The bytes end.
    pub fn whole(&mut self, x: &mut u64) -> Result<(), ArchiveError> {
        let mut word = x.to_le_bytes();
        self.word(&mut word)?;
        *x = u64::from_le_bytes(word);
        Ok(())
    }

    /// Traverses a number.
    ///
    /// # Errors
    /// The bytes end.
    pub fn number(&mut self, x: &mut f64) -> Result<(), ArchiveError> {
        let mut bits = x.to_bits();
        self.whole(&mut bits)?;
        *x = f64::from_bits(bits);
        Ok(())
    }

    /// Traverses a truth value.
    ///
    /// # Errors
    /// The bytes end, or the value is neither 0 nor 1.
    pub fn flag(&mut self, x: &mut bool) -> Result<(), ArchiveError> {
        let mut word = u64::from(*x);
        self.whole(&mut word)?;
        *x = match word {
            0 => false,
            1 => true,
            _ => return Err(ArchiveError::Value("truth value")),
        };
        Ok(())
    }

    /// Traverses a number of elements, at most `largest`.
    ///
    /// # Errors
    /// The bytes end, or the number is larger.
    pub fn count(&mut self, x: &mut usize, largest: usize) -> Result<(), ArchiveError> {
        let mut word = *x as u64;
        self.whole(&mut word)?;
        *x = usize::try_from(word)
            .ok()
            .filter(|n| *n <= largest)
            .ok_or(ArchiveError::Value("number of elements"))?;
        Ok(())
    }

    /// Traverses a list of numbers with its length.
    ///
    /// # Errors
    /// The bytes end.
    pub fn numbers(&mut self, x: &mut Vec<f64>) -> Result<(), ArchiveError> {
        let mut n = x.len();
        // A list cannot be longer than the bytes that are left, whatever its stored length.
        let largest = match &self.0 {
            Direction::Write(_) => n,
            Direction::Read(rest) => (rest.len() / 8).saturating_sub(1),
        };
        self.count(&mut n, largest)?;
        x.resize(n, 0.0);
        x.iter_mut().try_for_each(|x| self.number(x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_read_is_what_was_written() {
        let mut list = vec![1.5, f64::NEG_INFINITY, -0.0, f64::NAN];
        let (mut whole, mut flag) = (u64::MAX, true);
        let mut to = Archive::writing();
        to.numbers(&mut list).unwrap();
        to.whole(&mut whole).unwrap();
        to.flag(&mut flag).unwrap();
        let bytes = to.into_bytes();
        let (mut list2, mut whole2, mut flag2) = (vec![9.0; 7], 0, false);
        let mut from = Archive::reading(&bytes);
        from.numbers(&mut list2).unwrap();
        from.whole(&mut whole2).unwrap();
        from.flag(&mut flag2).unwrap();
        from.finish().unwrap();
        let bits = |x: &[f64]| x.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&list), bits(&list2));
        assert_eq!((whole, flag), (whole2, flag2));
    }

    #[test]
    fn damaged_bytes_are_refused() {
        let mut to = Archive::writing();
        to.numbers(&mut vec![1.0, 2.0]).unwrap();
        let mut bytes = to.into_bytes();
        let mut list = Vec::new();
        for n in 0..bytes.len() {
            assert!(Archive::reading(&bytes[..n]).numbers(&mut list).is_err());
        }
        assert_eq!(
            Archive::reading(&bytes).finish(),
            Err(ArchiveError::Long(24))
        );
        // A length beyond the bytes is no reason to allocate.
        bytes[..8].fill(0xff);
        let refused = Archive::reading(&bytes).numbers(&mut list);
        assert_eq!(refused, Err(ArchiveError::Value("number of elements")));
        let two = 2_u64.to_le_bytes();
        assert!(Archive::reading(&two).flag(&mut false).is_err());
    }
}
