//! Ridge regression, with a given ridge or with the ridge of maximum evidence; fast if there are fewer equations than
//! unknowns.
//!
//! Recursive least squares without forgetting has the same solution (`mapping::rls`). Here all n equations together
//! cost n^3 operations, for any number of unknowns.

use mapping::math;
use nalgebra::linalg::SymmetricTridiagonal;
use nalgebra::{DMatrix, DVector};

/// Linear equations whose unknowns are the parameters of rules; each rule has `N`. An equation states that the sum over
/// its terms of factor times parameter equals its value.
#[derive(Clone, Debug, Default)]
pub struct Equations<const N: usize> {
    /// Terms of each equation: the index of a rule, at most once per equation, and the factors of the rule's
    /// parameters.
    pub terms: Vec<Vec<(usize, [f64; N])>>,
    /// Value of each equation.
    pub values: Vec<f64>,
}

/// Exponents of the powers of two among which the evidence chooses the ridge.
const RIDGES: std::ops::RangeInclusive<i32> = -40..=40;

impl<const N: usize> Equations<N> {
    /// Parameters of all rules, rule by rule. They minimise the sum of the squared errors plus `ridge` times the sum of
    /// the squared parameters. `None` if the Gram matrix plus the ridge on its diagonal is not positive definite.
    pub fn solve(&self, rules: usize, ridge: f64) -> Option<Vec<f64>> {
        let mut gram = self.gram(rules);
        for index in 0..gram.nrows() {
            gram[(index, index)] += ridge;
        }
        let weights = gram.cholesky()?.solve(&DVector::from_column_slice(&self.values));
        let mut solution = vec![[0.0; N]; rules];
        for (terms, weight) in self.terms.iter().zip(weights.iter()) {
            for (rule, factors) in terms {
                solution[*rule].iter_mut().zip(factors).for_each(|(parameter, factor)| *parameter += weight * factor);
            }
        }
        Some(solution.into_flattened())
    }

    /// The ridge, a power of two, under which the values are most probable. Unknowns and errors are independent normal
    /// numbers with mean 0, and the ridge is the ratio of the errors' variance to the unknowns' variance. `None` if the
    /// best power is at an end of the range 2^-40 to 2^40, or no power has a finite evidence.
    ///
    /// Source: the evidence of MacKay 1992, *Bayesian interpolation*, with the common scale of both variances at its
    /// most probable value.
    pub fn likeliest_ridge(&self, rules: usize) -> Option<f64> {
        let count = self.values.len();
        let tridiagonal = SymmetricTridiagonal::new(self.gram(rules));
        let values = tridiagonal.q().tr_mul(&DVector::from_column_slice(&self.values));
        let (diagonal, beside) = (tridiagonal.diagonal(), tridiagonal.off_diagonal());
        let evidence = |ridge: f64| {
            // L D L^T of the tridiagonal matrix with the ridge on its diagonal.
            let (mut pivot, mut solved) = (diagonal[0] + ridge, values[0]);
            let (mut logarithms, mut square) = (math::ln(pivot), solved * solved / pivot);
            for index in 1..count {
                let below = beside[index - 1] / pivot;
                solved = values[index] - below * solved;
                pivot = diagonal[index] + ridge - below * beside[index - 1];
                logarithms += math::ln(pivot);
                square += solved * solved / pivot;
            }
            -0.5 * (logarithms + count as f64 * math::ln(square))
        };
        let all: Vec<(i32, f64)> = RIDGES.map(|power| (power, evidence(2.0_f64.powi(power)))).collect();
        let finite = all.into_iter().filter(|(_, evidence)| evidence.is_finite());
        let (power, _) = finite.max_by(|a, b| a.1.total_cmp(&b.1))?;
        (power > *RIDGES.start() && power < *RIDGES.end()).then(|| 2.0_f64.powi(power))
    }

    /// Gram matrix: the scalar products of the equations with each other.
    fn gram(&self, rules: usize) -> DMatrix<f64> {
        // Terms sorted by rule: those of a rule lie from its start to the next rule's start.
        let mut starts = vec![0_usize; rules + 1];
        self.terms.iter().flatten().for_each(|(rule, _)| starts[rule + 1] += 1);
        (0..rules).for_each(|rule| starts[rule + 1] += starts[rule]);
        let mut cursors = starts.clone();
        let mut by_rule = vec![(0, [0.0; N]); starts[rules]];
        for (equation, terms) in self.terms.iter().enumerate() {
            for (rule, factors) in terms {
                by_rule[cursors[*rule]] = (equation, *factors);
                cursors[*rule] += 1;
            }
        }
        let count = self.values.len();
        let mut gram = DMatrix::zeros(count, count);
        for rule in 0..rules {
            let own = &by_rule[starts[rule]..starts[rule + 1]];
            for (index, (i, first)) in own.iter().enumerate() {
                // The terms of a rule are in the order of the equations, so only one triangle is filled.
                let mut column = gram.column_mut(*i);
                for (j, second) in &own[index..] {
                    column[*j] += first.iter().zip(second).map(|(a, b)| a * b).sum::<f64>();
                }
            }
        }
        gram.fill_upper_triangle_with_lower_triangle();
        gram
    }
}

#[cfg(test)]
mod tests {
    use mapping::rls::Rls;

    use super::*;

    /// Pseudo-random numbers in [-1, 1), always the same sequence.
    fn numbers() -> impl FnMut() -> f64 {
        let mut state = 1_u64;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }
    }

    fn equations(count: usize, unknowns: usize, noise: f64) -> Equations<1> {
        let mut next = numbers();
        let truth: Vec<f64> = (0..unknowns).map(|_| next()).collect();
        let mut equations = Equations::default();
        for _ in 0..count {
            let terms: Vec<(usize, [f64; 1])> = (0..unknowns).map(|unknown| (unknown, [next()])).collect();
            let value: f64 = terms.iter().map(|(unknown, [factor])| factor * truth[*unknown]).sum();
            equations.values.push(value + noise * next());
            equations.terms.push(terms);
        }
        equations
    }

    #[test]
    fn the_solution_equals_that_of_recursive_least_squares() {
        let equations = equations(20, 30, 0.1);
        let mut rls = Rls::new(&[0.0; 30], &[4.0; 30], 1.0);
        for (terms, value) in equations.terms.iter().zip(&equations.values) {
            let terms: Vec<(usize, f64)> = terms.iter().map(|(unknown, [factor])| (*unknown, *factor)).collect();
            rls.update(&terms, *value, 0.36).expect("an equation");
        }
        let solution = equations.solve(30, 0.09).expect("a solution");
        for (ours, recursive) in solution.iter().zip(rls.parameters()) {
            assert!((ours - recursive).abs() < 1e-10, "{ours} {recursive}");
        }
    }

    /// Each rule has three parameters, so three unknowns.
    #[test]
    fn rules_with_several_parameters_have_the_same_solution() {
        let alone = equations(20, 30, 0.1);
        let together = Equations::<3> {
            terms: alone
                .terms
                .iter()
                .map(|terms| (0..10).map(|rule| (rule, [0, 1, 2].map(|own| terms[3 * rule + own].1[0]))).collect())
                .collect(),
            values: alone.values.clone(),
        };
        let (alone, together) =
            (alone.solve(30, 0.09).expect("a solution"), together.solve(10, 0.09).expect("a solution"));
        for (alone, together) in alone.iter().zip(&together) {
            assert!((alone - together).abs() < 1e-12, "{alone} {together}");
        }
    }

    /// The unknowns have the variance 1/3, the errors the variance `noise`^2 / 3.
    #[test]
    fn evidence_finds_the_ratio_of_the_variances() {
        for noise in [0.1, 1.0] {
            let ridge = equations(300, 100, noise).likeliest_ridge(100).expect("a ridge");
            let ratio = ridge / (noise * noise);
            assert!((0.4..2.5).contains(&ratio), "{ridge} at {noise}");
        }
    }
}
