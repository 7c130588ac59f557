//! Normally distributed numbers, the same on every platform.

use crate::math;

/// Maximum distance of a probability from 0.5 at which [`MIDDLE`] is valid.
const MIDDLE_HALF_WIDTH: f64 = 0.425;

/// Boundary between the rational functions of the tail, in sqrt(-ln(tail probability)).
const TAIL_BOUNDARY: f64 = 5.0;

/// Coefficients of the numerator and of the denominator of a rational function, the constant term first.
type Rational = [[f64; 8]; 2];

const MIDDLE: Rational = [
    [
        3.387_132_872_796_366_5,
        1.331_416_678_917_843_8e2,
        1.971_590_950_306_551_3e3,
        1.373_169_376_550_946e4,
        4.592_195_393_154_987e4,
        6.726_577_092_700_87e4,
        3.343_057_558_358_813e4,
        2.509_080_928_730_122_7e3,
    ],
    [
        1.0,
        4.231_333_070_160_091e1,
        6.871_870_074_920_579e2,
        5.394_196_021_424_751e3,
        2.121_379_430_158_659_7e4,
        3.930_789_580_009_271e4,
        2.872_908_573_572_194_3e4,
        5.226_495_278_852_854e3,
    ],
];

const NEAR_TAIL: Rational = [
    [
        1.423_437_110_749_683_5,
        4.630_337_846_156_546,
        5.769_497_221_460_691,
        3.647_848_324_763_204_5,
        1.270_458_252_452_368_4,
        2.417_807_251_774_506e-1,
        2.272_384_498_926_918_4e-2,
        7.745_450_142_783_414e-4,
    ],
    [
        1.0,
        2.053_191_626_637_759,
        1.676_384_830_183_803_8,
        6.897_673_349_851e-1,
        1.481_039_764_274_800_8e-1,
        1.519_866_656_361_645_7e-2,
        5.475_938_084_995_345e-4,
        1.050_750_071_644_416_9e-9,
    ],
];

const FAR_TAIL: Rational = [
    [
        6.657_904_643_501_103,
        5.463_784_911_164_114,
        1.784_826_539_917_291_3,
        2.965_605_718_285_048_7e-1,
        2.653_218_952_657_612_4e-2,
        1.242_660_947_388_078_4e-3,
        2.711_555_568_743_487_6e-5,
        2.010_334_399_292_288_1e-7,
    ],
    [
        1.0,
        5.998_322_065_558_88e-1,
        1.369_298_809_227_358e-1,
        1.487_536_129_085_061_5e-2,
        7.868_691_311_456_133e-4,
        1.846_318_317_510_054_8e-5,
        1.421_511_758_316_446e-7,
        2.044_263_103_389_939_7e-15,
    ],
];

fn evaluate([numerator, denominator]: &Rational, x: f64) -> f64 {
    let polynomial = |terms: &[f64; 8]| terms.iter().rev().fold(0.0, |sum, term| sum * x + term);
    polynomial(numerator) / polynomial(denominator)
}

/// Quantile of the standard normal distribution: the inverse of its distribution function.
///
/// The relative error is below 1e-15; the quantile is infinite at 0 and 1. Each normal number uses exactly one uniform
/// number, so the next numbers of a stream do not depend on its value. Source: Wichura, algorithm AS 241 (PPND16),
/// Applied Statistics 37 (1988).
pub fn normal_quantile(probability: f64) -> f64 {
    let from_middle = probability - 0.5;
    if from_middle.abs() <= MIDDLE_HALF_WIDTH {
        return from_middle * evaluate(&MIDDLE, MIDDLE_HALF_WIDTH * MIDDLE_HALF_WIDTH - from_middle * from_middle);
    }
    let tail = if from_middle < 0.0 { probability } else { 1.0 - probability };
    if tail <= 0.0 {
        return f64::INFINITY.copysign(from_middle);
    }
    let depth = (-math::ln(tail)).sqrt();
    let magnitude = if depth <= TAIL_BOUNDARY {
        evaluate(&NEAR_TAIL, depth - 1.6)
    } else {
        evaluate(&FAR_TAIL, depth - TAIL_BOUNDARY)
    };
    magnitude.copysign(from_middle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantile_inverts_the_distribution_function() {
        let probability_below = |z: f64| 0.5 * math::erfc(-z / 2.0_f64.sqrt());
        let mut probability = 1e-300;
        while probability < 0.5 {
            let z = normal_quantile(probability);
            // A relative error e of z changes the probability by a relative error of about z^2 e.
            let bound = 2e-15 * (1.0 + z * z);
            assert!(
                (probability_below(z) / probability - 1.0).abs() < bound,
                "{probability:e}: {z} gives {:e}",
                probability_below(z)
            );
            if probability > 1e-3 {
                assert!((normal_quantile(1.0 - probability) + z).abs() < 1e-12, "symmetry at {probability}");
            }
            probability *= 1.01;
        }
        assert_eq!(
            [0.0, 0.5, 1.0, -1.0, 2.0].map(normal_quantile),
            [f64::NEG_INFINITY, 0.0, f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY]
        );
        assert!(normal_quantile(f64::NAN).is_nan());
    }

    #[test]
    fn quantiles_match_golden_values() {
        let values = [1e-16, 1e-7, 0.01, 0.25, 0.9].map(normal_quantile);
        assert_eq!(values, GOLDEN, "{values:?}");
    }

    const GOLDEN: [f64; 5] =
        [-8.222082216130435, -5.199337582192817, -2.3263478740408408, -0.6744897501960817, 1.2815515655446006];
}
