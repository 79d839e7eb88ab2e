//! Real and complex numbers under one trait.

/// Numbers a matrix may consist of: `f64`, or [`faer::c64`] for Hermitian matrices.
pub trait Scalar:
    faer::traits::ComplexField<Real = f64>
    + Copy
    + Send
    + Sync
    + std::ops::Add<Output = Self>
    + std::ops::Sub<Output = Self>
    + std::ops::Mul<Output = Self>
    + std::ops::AddAssign
    + std::ops::SubAssign
    + std::ops::MulAssign
{
    /// Converts a real number.
    fn real(x: f64) -> Self;
    /// A complex number; a real type takes its real part.
    fn complex(re: f64, im: f64) -> Self;
    /// Real and imaginary part.
    fn parts(self) -> [f64; 2];
    /// Returns the complex conjugate.
    fn conjugate(self) -> Self;
    /// Square of the modulus.
    fn modulus2(self) -> f64;
}

impl Scalar for f64 {
    fn real(x: f64) -> Self {
        x
    }
    fn complex(re: f64, _: f64) -> Self {
        re
    }
    fn parts(self) -> [f64; 2] {
        [self, 0.0]
    }
    fn conjugate(self) -> Self {
        self
    }
    fn modulus2(self) -> f64 {
        self * self
    }
}

impl Scalar for faer::c64 {
    fn real(x: f64) -> Self {
        Self::new(x, 0.0)
    }
    fn complex(re: f64, im: f64) -> Self {
        Self::new(re, im)
    }
    fn parts(self) -> [f64; 2] {
        [self.re, self.im]
    }
    fn conjugate(self) -> Self {
        self.conj()
    }
    fn modulus2(self) -> f64 {
        self.norm_sqr()
    }
}
