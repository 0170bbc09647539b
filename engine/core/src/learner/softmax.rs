//! Choosing by softmax, equation (3), at a temperature that falls with the visits of the state, equation (4).

use super::q_table::{best_among, best_of};
use crate::allowed::Allowed;
use crate::random::Random;
use crate::settings::LearnerSettings;

/// Chooses actions; keeps scratch memory so that choosing allocates nothing.
#[derive(Debug, Clone)]
pub(crate) struct Softmax {
    start: f64,
    end: f64,
    cooling_visits: u64,
    weights: Vec<f64>,
}

impl Softmax {
    /// A choice among `actions` with the settings' temperatures.
    #[must_use]
    pub(super) fn new(settings: &LearnerSettings, actions: usize) -> Self {
        Self {
            start: settings.temperature,
            end: settings.temperature_end,
            cooling_visits: settings.cooling_visits,
            weights: vec![0.0; actions],
        }
    }

    /// This softmax at one temperature, whatever the visits.
    #[must_use]
    pub(super) fn at_temperature(self, temperature: f64) -> Self {
        Self { start: temperature, end: temperature, ..self }
    }

    /// An index into `values`, drawn among those that are allowed with the probabilities of equation (3) in a state that had
    /// `visits` visits.
    pub(super) fn choose(&mut self, values: &[f64], allowed: Allowed, visits: u64, random: &mut Random) -> usize {
        let temperature = temperature(self.start, self.end, self.cooling_visits, visits);
        self.choose_at(values, allowed, temperature, random)
    }

    /// An index into `values`, drawn among those that are allowed at a temperature above 0.
    pub(super) fn choose_at(
        &mut self,
        values: &[f64],
        allowed: Allowed,
        temperature: f64,
        random: &mut Random,
    ) -> usize {
        let total = match allowed.is_all() {
            true => self.weigh(values, temperature),
            false => self.weigh_allowed(values, allowed, temperature),
        };
        let mut left = random.unit() * total;
        for (action, weight) in self.weights.iter().enumerate() {
            left -= weight;
            if left < 0.0 {
                return action;
            }
        }
        // Only rounding leads here: the last action of any weight.
        self.weights.iter().rposition(|weight| *weight > 0.0).unwrap_or(0)
    }

    /// Fills the weights exp((Q - max Q) / T) and returns their sum, which is at least 1.
    fn weigh(&mut self, values: &[f64], temperature: f64) -> f64 {
        let (_, greatest) = best_of(values);
        let mut total = 0.0;
        for (weight, value) in self.weights.iter_mut().zip(values) {
            let exponent = (value - greatest) / temperature;
            // exp(-40) is 4e-18: nothing beside the best action's 1.
            *weight = if exponent < -40.0 { 0.0 } else { libm::exp(exponent) };
            total += *weight;
        }
        total
    }
}

impl Softmax {
    /// As [`Softmax::weigh`], but what is not allowed weighs nothing.
    fn weigh_allowed(&mut self, values: &[f64], allowed: Allowed, temperature: f64) -> f64 {
        let (_, greatest) = best_among(values, allowed);
        let mut total = 0.0;
        for (action, (weight, value)) in self.weights.iter_mut().zip(values).enumerate() {
            let exponent = (value - greatest) / temperature;
            let counts = allowed.contains(action) && exponent >= -40.0;
            *weight = if counts { libm::exp(exponent) } else { 0.0 };
            total += *weight;
        }
        total
    }
}

/// Equation (4): `start * exp(-(visits / cooling_visits) * ln(start / end))`, and `end` from then on.
#[must_use]
pub(super) fn temperature(start: f64, end: f64, cooling_visits: u64, visits: u64) -> f64 {
    if visits >= cooling_visits {
        return end;
    }
    start * libm::exp(-(visits as f64 / cooling_visits as f64) * libm::log(start / end))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;
    use crate::settings::Settings;

    #[test]
    fn the_temperature_falls_as_equation_4_says() {
        let at = |visits| temperature(0.07, 0.009, 500, visits);
        assert_eq!(at(0), 0.07);
        assert!((at(100) - 0.046_444).abs() < 1e-6);
        assert!((at(250) - 0.0251).abs() < 1e-4);
        assert!((at(499) - 0.009_037).abs() < 1e-6);
        assert_eq!((at(500), at(1_000_000)), (0.009, 0.009));
    }

    #[test]
    fn a_gap_of_a_tenth_is_4_17_to_1_at_first() {
        let mut softmax = Softmax::new(&Settings::default().learner, 2);
        let total = softmax.weigh(&[-1.0, -0.9], 0.07);
        assert!((softmax.weights[1] / softmax.weights[0] - 4.1727).abs() < 1e-3);
        assert!((total - (1.0 + 1.0 / 4.1727)).abs() < 1e-4);
    }

    #[test]
    fn very_low_values_do_not_underflow() {
        let mut softmax = Softmax::new(&Settings::default().learner, 3);
        let mut random = Random::new(1, Stream::Learner);
        for _ in 0..100 {
            assert_eq!(softmax.choose(&[-90.0, -99.0, -98.0], Allowed::ALL, 500, &mut random), 0);
        }
    }

    #[test]
    fn choices_come_as_often_as_their_probability() {
        let mut softmax = Softmax::new(&Settings::default().learner, 2);
        let mut random = Random::new(5, Stream::Learner);
        let chosen = (0..20_000).filter(|_| softmax.choose(&[-1.0, -0.9], Allowed::ALL, 0, &mut random) == 1).count();
        // 4.1727 / 5.1727 = 0.8067; three deviations of 20,000 draws are 0.0084.
        assert!((chosen as f64 / 20_000.0 - 0.8067).abs() < 0.0084, "{chosen}");
    }

    #[test]
    fn what_is_not_allowed_is_never_chosen_and_the_rest_by_its_own_probabilities() {
        let mut softmax = Softmax::new(&Settings::default().learner, 3);
        let mut random = Random::new(5, Stream::Learner);
        let allowed = Allowed::NONE.with(1).with(2);
        let mut chosen = [0_u32; 3];
        for _ in 0..20_000 {
            chosen[softmax.choose(&[9.0, -1.0, -0.9], allowed, 0, &mut random)] += 1;
        }
        // As of the two alone: 0.8067, give or take 0.0084.
        assert!(chosen[0] == 0 && (f64::from(chosen[2]) / 20_000.0 - 0.8067).abs() < 0.0084, "{chosen:?}");
    }
}
