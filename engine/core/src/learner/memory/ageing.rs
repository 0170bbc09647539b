//! How much a step counts by its age: a half-life of 500 steps at first, of 0.3 of the learner's age later.
//!
//! Weights are given once, at birth, and grow with the age of the learner: `2^(t / 500)` up to the knee at `500 / 0.3`
//! steps, from there on `t^(ln 2 / 0.3)`, which has that half-life everywhere. So sums of weighted returns need no decay.

/// Steps after which an early step counts half.
const FIRST_HALF_LIFE: f64 = 500.0;
/// Later on: the same as a share of the learner's age.
const HALF_LIFE_SHARE: f64 = 0.3;
const KNEE: f64 = FIRST_HALF_LIFE / HALF_LIFE_SHARE;

/// The weight of a step at an age of the learner, steps; steps from before the learner's age was forgotten have negative ages.
#[must_use]
pub(super) fn weight_at(age: f64) -> f64 {
    if age <= KNEE {
        return libm::exp2(age / FIRST_HALF_LIFE);
    }
    libm::exp2(1.0 / HALF_LIFE_SHARE) * libm::pow(age / KNEE, std::f64::consts::LN_2 / HALF_LIFE_SHARE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_early_step_counts_half_after_500_steps() {
        assert_eq!(weight_at(0.0), 1.0);
        assert_eq!(weight_at(1_000.0) / weight_at(500.0), 2.0);
        assert_eq!(weight_at(-500.0), 0.5);
    }

    #[test]
    fn weights_join_smoothly_at_the_knee() {
        // 2^(1666.67 / 500) = 2^3.3333 = 10.079, from either side.
        assert!((weight_at(KNEE) - 10.079_368).abs() < 1e-5);
        assert!((weight_at(KNEE + 1e-6) / weight_at(KNEE) - 1.0).abs() < 1e-8);
    }

    #[test]
    fn a_late_step_counts_half_when_0_3_of_the_age_has_passed() {
        // At an age of 10,000 the slope is that of a half-life of 3,000: ln w grows by ln 2 / 3000 in a step.
        let slope = libm::log(weight_at(10_001.0) / weight_at(10_000.0));
        assert!((slope * 3_000.0 / std::f64::consts::LN_2 - 1.0).abs() < 1e-4, "{slope}");
    }
}
