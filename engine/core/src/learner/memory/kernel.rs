//! How similar two actions are: a Gaussian over the difference of their twists.

use crate::geometry::Twist;

/// Difference in turning speed that makes one deviation, rad/s.
const TURN_RAD_PER_S: f64 = 0.3;
/// Difference in forward speed that makes one deviation, m/s.
const SPEED_M_PER_S: f64 = 0.1;
/// Less than this is nothing.
const LEAST: f64 = 0.05;

/// The similarity of every two actions.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TwistKernel {
    actions: usize,
    likeness: Vec<f64>,
}

impl TwistKernel {
    /// `exp(-((dw / 0.3)^2 + (dv / 0.1)^2) / 2)`; below 0.05 it is 0.
    #[must_use]
    pub(super) fn new(actions: &[Twist]) -> Self {
        let pairs = actions.iter().flat_map(|one| actions.iter().map(move |other| (one, other)));
        let likeness = pairs.map(|(one, other)| {
            let turn = (one.angular_rad_per_s - other.angular_rad_per_s) / TURN_RAD_PER_S;
            let speed = (one.linear_m_per_s - other.linear_m_per_s) / SPEED_M_PER_S;
            let like = libm::exp(-(turn * turn + speed * speed) / 2.0);
            if like < LEAST { 0.0 } else { like }
        });
        Self { actions: actions.len(), likeness: likeness.collect() }
    }

    /// How similar each action is to one of them.
    pub(super) fn row(&self, action: usize) -> &[f64] {
        &self.likeness[action * self.actions..(action + 1) * self.actions]
    }

    /// Spreads a state's tries over similar actions: `spread[b] = sum over a of kernel(a, b) * own[a]`, of sums and of tries.
    pub(super) fn spread(&self, own: [&[f64]; 2], spread: [&mut [f64]; 2]) {
        let ([sums, tries], [spread_sums, spread_tries]) = (own, spread);
        spread_sums.fill(0.0);
        spread_tries.fill(0.0);
        for (action, (sum, tried)) in sums.iter().zip(tries).enumerate() {
            if *tried == 0.0 {
                continue;
            }
            for (to, like) in spread_sums.iter_mut().zip(self.row(action)) {
                *to += like * sum;
            }
            for (to, like) in spread_tries.iter_mut().zip(self.row(action)) {
                *to += like * tried;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kernel() -> TwistKernel {
        TwistKernel::new(&[Twist::new(0.2, 0.0), Twist::new(0.2, 0.3), Twist::new(0.3, 0.3), Twist::new(0.2, 0.8)])
    }

    #[test]
    fn one_deviation_apart_is_0_61_and_two_of_them_0_37() {
        // exp(-1/2) = 0.6065, exp(-1) = 0.3679; 0.8 rad/s are exp(-3.56) = 0.029, which is nothing.
        let wanted = [1.0, 0.606_530_66, 0.367_879_44, 0.0];
        assert!(kernel().row(0).iter().zip(wanted).all(|(like, wanted)| (like - wanted).abs() < 1e-8));
    }

    #[test]
    fn what_one_action_met_counts_for_the_others_by_their_likeness() {
        let (mut sums, mut tries) = ([9.0; 4], [9.0; 4]);
        kernel().spread([&[-2.0, 0.0, 0.0, 1.0], &[4.0, 0.0, 0.0, 1.0]], [&mut sums, &mut tries]);
        // Action 1: 0.6065 of four tries that sum to -2, and 0.2494 (exp(-25/18)) of the one that brought 1.
        assert!((sums[1] - (-1.213_061_32 + 0.249_352_21)).abs() < 1e-7, "{sums:?}");
        assert!((tries[1] - (2.426_122_64 + 0.249_352_21)).abs() < 1e-7, "{tries:?}");
        assert_eq!((sums[3], tries[3]), (1.0, 1.0));
    }
}
