//! Recursive least squares in UD form. The covariance is U D U^T with U unit upper triangular and D diagonal, so it
//! stays symmetric and positive, even after many updates and with poor regressors.
//!
//! A prior regularises the estimate, and the covariance never exceeds that of the prior. Forgetting acts only along
//! measured directions.

/// Estimates the parameters p of y = phi . p from one equation at a time.
///
/// Source: Bierman 1977, *Factorization methods for discrete sequential estimation* (update by a measurement), and Agee
/// and Turner 1972 (addition of a dyad). The forgetting rule is our choice.
#[derive(Clone, Debug)]
pub struct Rls {
    parameters: Vec<f64>,
    /// Columns of U above its diagonal, one after the other: element (i, j) at j (j - 1) / 2 + i.
    upper: Vec<f64>,
    diagonal: Vec<f64>,
    forgetting: f64,
    /// Buffer for U^T phi, reused between updates.
    projected: Vec<f64>,
    /// Buffer for P phi with the covariance P, reused between updates.
    gain: Vec<f64>,
}

/// Error of an equation that [`Rls::update`] cannot use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RlsError {
    /// A number of the equation is infinite or not a number.
    #[error("an equation has a number that is not finite")]
    NotFinite,
    /// The variance is not above 0.
    #[error("the variance of a measured value must be above 0")]
    Variance,
    /// A regressor has the index of a parameter that does not exist.
    #[error("parameter {index} of {parameters}")]
    Index {
        /// The index.
        index: usize,
        /// Number of parameters.
        parameters: usize,
    },
}

/// Index at which column `j` begins in the packed upper triangle.
fn column_start(j: usize) -> usize {
    j * j.saturating_sub(1) / 2
}

impl Rls {
    /// Parameters with the prior `mean` and `variance`, independent of each other.
    ///
    /// `forgetting` is in (0, 1]; 1 means no forgetting. Below 1, no update reduces the variance of the measured
    /// combination of parameters below (1 - forgetting) times the variance of the equation, so the memory is about
    /// 1 / (1 - forgetting) equations long.
    ///
    /// # Panics
    /// If the lists differ in length, a variance is not above 0 and finite, or `forgetting` is outside (0, 1].
    pub fn new(mean: &[f64], variance: &[f64], forgetting: f64) -> Self {
        assert_eq!(mean.len(), variance.len(), "a variance for each parameter");
        assert!(variance.iter().all(|variance| *variance > 0.0 && variance.is_finite()), "variances above 0");
        assert!(forgetting > 0.0 && forgetting <= 1.0, "forgetting in (0, 1]");
        let count = mean.len();
        Self {
            parameters: mean.to_vec(),
            upper: vec![0.0; column_start(count)],
            diagonal: variance.to_vec(),
            forgetting,
            projected: vec![0.0; count],
            gain: vec![0.0; count],
        }
    }

    /// The estimate.
    pub fn parameters(&self) -> &[f64] {
        &self.parameters
    }

    /// Variance of one parameter; 0 if there is no such parameter.
    pub fn variance(&self, index: usize) -> f64 {
        (index..self.parameters.len()).map(|j| self.u(index, j) * self.u(index, j) * self.diagonal[j]).sum()
    }

    /// Covariance of two parameters; 0 if one of them does not exist.
    pub fn covariance(&self, first: usize, second: usize) -> f64 {
        let from = first.max(second);
        (from..self.parameters.len()).map(|j| self.u(first, j) * self.u(second, j) * self.diagonal[j]).sum()
    }

    /// Updates the estimate with an equation: `value` is the sum of factor * parameter over `regressor`, except for an
    /// error with the variance `variance`. `regressor` has pairs of a parameter's index and its factor; parameters
    /// without a pair have the factor 0.
    ///
    /// The covariance never grows. A regressor of zeros changes nothing. An update takes of the order of n^2 operations
    /// for n parameters.
    ///
    /// # Errors
    /// [`RlsError`]; the estimate is then unchanged.
    pub fn update(&mut self, regressor: &[(usize, f64)], value: f64, variance: f64) -> Result<(), RlsError> {
        self.check(regressor, value, variance)?;
        let (Some(first), Some(last)) =
            (regressor.iter().map(|(index, _)| *index).min(), regressor.iter().map(|(index, _)| *index).max())
        else {
            return Ok(());
        };
        self.project(regressor, first, last);
        let predicted: f64 = self.projected.iter().zip(&self.diagonal).map(|(f, d)| f * f * d).sum();
        if predicted <= 0.0 || !predicted.is_finite() {
            return Ok(());
        }
        let error = value - regressor.iter().map(|(index, factor)| factor * self.parameters[*index]).sum::<f64>();
        // Forgetting acts only along the measured direction, limited so that the covariance does not grow.
        let inflated = predicted / self.forgetting;
        let posterior = (inflated * variance / (inflated + variance)).min(predicted);
        let scale = inflated / (predicted * (inflated + variance));
        // Bierman's update with this variance reduces the predicted variance to `posterior`.
        let effective = predicted * posterior / (predicted - posterior);
        match effective.is_finite() && effective > 0.0 {
            true => self.update_factors(effective),
            false => self.compute_gain(),
        }
        for (parameter, gain) in self.parameters.iter_mut().zip(&self.gain) {
            *parameter += gain * scale * error;
        }
        Ok(())
    }

    /// Resets one parameter to `mean` and `variance`, independent of the others; the estimate of the others does not
    /// change.
    ///
    /// # Panics
    /// If there is no such parameter or `variance` is not above 0 and finite.
    pub fn reset(&mut self, index: usize, mean: f64, variance: f64) {
        assert!(variance > 0.0 && variance.is_finite(), "a variance above 0");
        // Contribution of column `index` to the covariance of the parameters before it; it moves to the columns of
        // these parameters.
        let mut dyad = self.upper[column_start(index)..column_start(index) + index].to_vec();
        let weight = self.diagonal[index];
        self.add_dyad(&mut dyad, weight);
        self.upper[column_start(index)..column_start(index) + index].fill(0.0);
        for j in index + 1..self.parameters.len() {
            self.upper[column_start(j) + index] = 0.0;
        }
        self.diagonal[index] = variance;
        self.parameters[index] = mean;
    }

    fn check(&self, regressor: &[(usize, f64)], value: f64, variance: f64) -> Result<(), RlsError> {
        let parameters = self.parameters.len();
        if let Some((index, _)) = regressor.iter().find(|(index, _)| *index >= parameters) {
            return Err(RlsError::Index { index: *index, parameters });
        }
        if !value.is_finite() || regressor.iter().any(|(_, factor)| !factor.is_finite()) {
            return Err(RlsError::NotFinite);
        }
        match variance > 0.0 && variance.is_finite() {
            true => Ok(()),
            false => Err(RlsError::Variance),
        }
    }

    /// Element (i, j) of U, for i <= j.
    fn u(&self, i: usize, j: usize) -> f64 {
        if i == j { 1.0 } else { self.upper[column_start(j) + i] }
    }

    /// Computes U^T phi into `projected`; phi is 0 before `first` and after `last`.
    fn project(&mut self, regressor: &[(usize, f64)], first: usize, last: usize) {
        let mut dense = vec![0.0; last + 1 - first];
        for (index, factor) in regressor {
            dense[index - first] += factor;
        }
        self.projected[..first].fill(0.0);
        for j in first..self.parameters.len() {
            let column = &self.upper[column_start(j)..column_start(j) + j];
            let diagonal_term = if j <= last { dense[j - first] } else { 0.0 };
            let above = &column[first..j.min(last + 1)];
            self.projected[j] = diagonal_term + above.iter().zip(&dense).map(|(u, phi)| u * phi).sum::<f64>();
        }
    }

    /// Bierman's update of U and D by a measurement with `variance`. `gain` becomes P phi with the covariance P before
    /// the update.
    fn update_factors(&mut self, variance: f64) {
        let mut alpha = variance;
        self.gain.fill(0.0);
        for j in 0..self.parameters.len() {
            let f = self.projected[j];
            if f == 0.0 {
                continue;
            }
            let v = self.diagonal[j] * f;
            let beta = alpha;
            alpha += v * f;
            self.diagonal[j] *= beta / alpha;
            let lambda = -f / beta;
            for (u, gain) in self.upper[column_start(j)..column_start(j) + j].iter_mut().zip(&mut self.gain) {
                let before = *u;
                *u += lambda * *gain;
                *gain += v * before;
            }
            self.gain[j] = v;
        }
    }

    /// Computes P phi = U D U^T phi into `gain`.
    fn compute_gain(&mut self) {
        self.gain.fill(0.0);
        for j in 0..self.parameters.len() {
            let v = self.diagonal[j] * self.projected[j];
            for (u, gain) in self.upper[column_start(j)..column_start(j) + j].iter().zip(&mut self.gain) {
                *gain += v * u;
            }
            self.gain[j] = v;
        }
    }

    /// Adds `weight` * dyad dyad^T to the covariance of the first parameters; their number is the length of `dyad`.
    fn add_dyad(&mut self, dyad: &mut [f64], weight: f64) {
        let mut weight = weight;
        for j in (0..dyad.len()).rev() {
            let a = dyad[j];
            if a == 0.0 {
                continue;
            }
            let before = self.diagonal[j];
            let after = before + weight * a * a;
            let fraction = weight * a / after;
            for (u, entry) in self.upper[column_start(j)..column_start(j) + j].iter_mut().zip(&mut *dyad) {
                *entry -= a * *u;
                *u += fraction * *entry;
            }
            self.diagonal[j] = after;
            weight *= before / after;
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;

    /// Pseudo-random numbers in [-1, 1), determined by `seed`.
    fn numbers(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }
    }

    fn covariance(rls: &Rls) -> DMatrix<f64> {
        let count = rls.parameters().len();
        DMatrix::from_fn(count, count, |i, j| rls.covariance(i, j))
    }

    #[test]
    fn estimate_without_forgetting_is_the_least_squares_solution() {
        let (count, mut next) = (7, numbers(1));
        let (mean, prior): (Vec<f64>, Vec<f64>) = (0..count).map(|_| (next(), 2.0 + next())).unzip();
        let mut rls = Rls::new(&mean, &prior, 1.0);
        let mut information = DMatrix::from_diagonal(&DVector::from_iterator(count, prior.iter().map(|p| 1.0 / p)));
        let mut right = &information * DVector::from_vec(mean);
        for _ in 0..40 {
            let phi = DVector::from_fn(count, |_, _| next());
            let (value, variance) = (next(), 0.3 + 0.2 * next());
            let regressor: Vec<_> = phi.iter().copied().enumerate().collect();
            rls.update(&regressor, value, variance).unwrap();
            information += &phi * phi.transpose() / variance;
            right += phi * value / variance;
        }
        let inverse = information.try_inverse().unwrap();
        let expected = &inverse * right;
        for (ours, expected) in rls.parameters().iter().zip(expected.iter()) {
            assert!((ours - expected).abs() < 1e-12, "{ours} {expected}");
        }
        assert!((covariance(&rls) - inverse).amax() < 1e-12);
    }

    #[test]
    fn reset_does_not_change_the_other_parameters() {
        let (count, mut next) = (6, numbers(2));
        let mut rls = Rls::new(&[0.0; 6], &[1.0; 6], 0.99);
        for _ in 0..20 {
            let regressor: Vec<_> = (0..count).map(|index| (index, next())).collect();
            rls.update(&regressor, next(), 0.1).unwrap();
        }
        for index in [0, 3, 5] {
            let before = covariance(&rls);
            rls.reset(index, 7.0, 4.0);
            let after = covariance(&rls);
            for (i, j) in (0..count).flat_map(|i| (0..count).map(move |j| (i, j))) {
                let expected = match (i == index, j == index) {
                    (true, true) => 4.0,
                    (false, false) => before[(i, j)],
                    _ => 0.0,
                };
                assert!((after[(i, j)] - expected).abs() < 1e-12, "reset of {index}: ({i}, {j})");
            }
            assert_eq!(rls.parameters()[index], 7.0);
        }
    }

    #[test]
    fn covariance_stays_finite_symmetric_and_below_the_prior() {
        let mut next = numbers(3);
        for forgetting in [1.0, 0.999, 0.9] {
            let mut rls = Rls::new(&[0.0; 6], &[1e4; 6], forgetting);
            for step in 0..1_000_000u32 {
                // The regressors: a constant direction, its double, zero, and a tiny one. Parameter 5 is never
                // measured.
                let regressor: &[(usize, f64)] = match step % 4 {
                    0 => &[(0, 1.0), (1, 1.0), (2, -1.0)],
                    1 => &[(0, 2.0), (1, 2.0), (2, -2.0)],
                    2 => &[(3, 0.0)],
                    _ => &[(3, 1e-9), (4, 1e-9)],
                };
                let scale: f64 = regressor.iter().map(|(_, factor)| factor.abs()).sum::<f64>() / 3.0;
                rls.update(regressor, scale * (1.0 + 0.01 * next()), 1e-4).unwrap();
            }
            let covariance = covariance(&rls);
            assert!(rls.parameters().iter().chain(covariance.iter()).all(|number| number.is_finite()));
            assert_eq!(covariance, covariance.transpose());
            assert_eq!((rls.parameters()[5], rls.variance(5)), (0.0, 1e4), "nothing was said of it");
            let eigenvalues = covariance.symmetric_eigenvalues();
            assert!(eigenvalues.max() <= 1e4 * (1.0 + 1e-9), "no wind-up: {eigenvalues}");
            // Tolerance for rounding in the matrix product of the test.
            assert!(eigenvalues.min() > -1e-10 * 1e4, "positive: {eigenvalues}");
            let sum = rls.parameters()[0] + rls.parameters()[1] - rls.parameters()[2];
            assert!((sum - 1.0).abs() < 0.01, "the one thing that is measured: {sum}");
        }
    }

    #[test]
    fn forgetting_follows_a_change() {
        let after_a_change = |forgetting: f64| {
            let mut rls = Rls::new(&[0.0], &[1.0], forgetting);
            for step in 0..2000 {
                let value = if step < 1900 { 1.0 } else { 2.0 };
                rls.update(&[(0, 1.0)], value, 0.01).unwrap();
            }
            rls.parameters()[0]
        };
        // The last hundred equations are four times the memory of 25 equations, and a twentieth of all equations.
        assert!(after_a_change(0.96) > 1.95);
        assert!(after_a_change(1.0) < 1.1);
    }

    #[test]
    fn invalid_equations_change_nothing() {
        let mut rls = Rls::new(&[0.0; 2], &[1.0; 2], 1.0);
        assert_eq!(rls.update(&[(2, 1.0)], 0.0, 1.0), Err(RlsError::Index { index: 2, parameters: 2 }));
        assert_eq!(rls.update(&[(0, f64::NAN)], 0.0, 1.0), Err(RlsError::NotFinite));
        assert_eq!(rls.update(&[(0, 1.0)], f64::INFINITY, 1.0), Err(RlsError::NotFinite));
        assert_eq!(rls.update(&[(0, 1.0)], 0.0, 0.0), Err(RlsError::Variance));
        assert_eq!(rls.update(&[], 5.0, 1.0), Ok(()));
        assert_eq!((rls.parameters(), rls.variance(0)), (&[0.0, 0.0][..], 1.0));
    }
}
