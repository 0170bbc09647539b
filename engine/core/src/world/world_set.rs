//! The worlds of a run, and how often each is drawn.

use super::Layout;
use crate::random::Random;
use std::ops::Range;
use std::sync::Arc;

/// One world or several; a world is named by its index, and that of the home world is 0.
#[derive(Debug, Clone)]
pub struct WorldSet {
    layouts: Vec<Arc<Layout>>,
    /// Weights, and the worlds that share each.
    shares: Vec<(u32, Range<usize>)>,
}

impl WorldSet {
    /// One world alone.
    #[must_use]
    pub fn alone(layout: Arc<Layout>) -> Self {
        Self { layouts: vec![layout], shares: vec![(1, 0..1)] }
    }

    /// Worlds by shares: a weight, and the worlds that are equally likely within it. The home world is that which is drawn
    /// most often, the first of equals; its share comes first, the others keep their order. Nothing if there is no world, or
    /// a share without one or without weight.
    #[must_use]
    pub fn new(shares: Vec<(u32, Vec<Arc<Layout>>)>) -> Option<Self> {
        if shares.is_empty() || shares.iter().any(|(weight, layouts)| *weight == 0 || layouts.is_empty()) {
            return None;
        }
        let mut shares = shares;
        let counts: Vec<(u32, usize)> = shares.iter().map(|(weight, layouts)| (*weight, layouts.len())).collect();
        shares[..=home_of(&counts)].rotate_right(1);
        let mut set = Self { layouts: Vec::new(), shares: Vec::new() };
        for (weight, layouts) in shares {
            let from = set.layouts.len();
            set.layouts.extend(layouts);
            set.shares.push((weight, from..set.layouts.len()));
        }
        Some(set)
    }

    /// Worlds in the order of [`WorldSet::layouts`], with their [`WorldSet::shares`]. Nothing if they do not fit.
    #[must_use]
    pub fn stored(shares: &[(u32, usize)], layouts: Vec<Arc<Layout>>) -> Option<Self> {
        let (count, weights): (usize, u64) =
            shares.iter().fold((0, 0), |(count, sum), (weight, of)| (count + of, sum + u64::from(*weight)));
        let are_whole = shares.iter().all(|(weight, of)| *weight > 0 && *of > 0);
        if layouts.is_empty() || !are_whole || count != layouts.len() || weights > u64::from(u32::MAX) {
            return None;
        }
        let mut from = 0;
        let share = |(weight, count): (u32, usize)| {
            from += count;
            (weight, from - count..from)
        };
        Some(Self { shares: shares.iter().copied().map(share).collect(), layouts })
    }

    /// Weight and number of worlds of each share, in the order of the worlds.
    #[must_use]
    pub fn shares(&self) -> Vec<(u32, usize)> {
        self.shares.iter().map(|(weight, worlds)| (*weight, worlds.len())).collect()
    }

    /// All worlds, the home world first.
    #[must_use]
    pub fn layouts(&self) -> &[Arc<Layout>] {
        &self.layouts
    }

    /// The worlds other than the home world.
    #[must_use]
    pub fn further(&self) -> &[Arc<Layout>] {
        &self.layouts[1..]
    }

    /// The home world.
    #[must_use]
    pub fn home(&self) -> &Arc<Layout> {
        &self.layouts[0]
    }

    /// For whom the worlds are: `room`, or `room and 12 more`.
    #[must_use]
    pub fn title(&self) -> String {
        match self.further().len() {
            0 => self.home().name.clone(),
            more => format!("{} and {more} more", self.home().name),
        }
    }

    /// Whether every world has a route on which laps are measured.
    #[must_use]
    pub fn have_laps(&self) -> bool {
        self.layouts.iter().all(|layout| layout.lap.is_some())
    }

    /// Draws the next world: a share by its weight, then one of its worlds. Always two draws. Allocates nothing.
    #[must_use]
    pub fn draw(&self, random: &mut Random) -> usize {
        let sum: u32 = self.shares.iter().map(|(weight, _)| weight).sum();
        let (mut left, within) = (random.below(sum), random.unit());
        for (weight, worlds) in &self.shares {
            if left < *weight {
                return worlds.start + (within * worlds.len() as f64) as usize;
            }
            left -= weight;
        }
        0
    }
}

/// Of shares by weight and number of worlds, that whose worlds are drawn most often; the first of equals.
fn home_of(shares: &[(u32, usize)]) -> usize {
    let often = |(weight, count): (u32, usize)| f64::from(weight) / count as f64;
    (1..shares.len()).fold(0, |home, share| if often(shares[share]) > often(shares[home]) { share } else { home })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::SourceText;
    use crate::random::Stream;
    use crate::settings::BodyShape;

    fn layout(name: &str) -> Arc<Layout> {
        let source = SourceText::new(format!("{name}.toml"), "[[start]]\nposition_m = [0, 0]\n");
        Arc::new(Layout::parse(source, &BodyShape::pioneer2at()).unwrap())
    }

    fn set() -> WorldSet {
        let shares = vec![(1, vec![layout("a"), layout("b")]), (3, vec![layout("home")]), (2, vec![layout("c")])];
        WorldSet::new(shares).unwrap()
    }

    #[test]
    fn the_world_that_is_drawn_most_often_is_home_and_the_others_keep_their_order() {
        let names: Vec<_> = set().layouts().iter().map(|layout| layout.name.clone()).collect();
        assert_eq!((names.join(" "), set().title().as_str()), ("home a b c".to_owned(), "home and 3 more"));
        let equal = WorldSet::new(vec![(1, vec![layout("x")]), (1, vec![layout("y")])]).unwrap();
        assert_eq!(equal.home().name, "x");
        assert!(WorldSet::new(Vec::new()).is_none() && WorldSet::new(vec![(0, vec![layout("x")])]).is_none());
    }

    #[test]
    fn worlds_are_drawn_by_their_weights_and_evenly_within_a_share() {
        let (set, mut random, mut counts) = (set(), Random::new(1, Stream::Worlds), [0; 4]);
        (0..6000).for_each(|_| counts[set.draw(&mut random)] += 1);
        // 3000, 500, 500 and 2000 within four deviations: 39, 21, 21, 37.
        for (count, wanted) in counts.iter().zip([3000_i32, 500, 500, 2000]) {
            assert!((count - wanted).abs() < 160, "{counts:?}");
        }
    }
}
