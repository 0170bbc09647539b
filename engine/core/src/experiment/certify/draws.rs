//! What a certificate draws: worlds and seeds, in a stream of their own.

use std::collections::BTreeSet;

use crate::diagnostic::{Diagnostic, Result, printable};
use crate::experiment::Plan;
use crate::random::{Random, Stream};
use crate::world::{FAMILIES, FamilyRange};

/// One test: in a world, under a seed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Draw {
    pub(super) world: String,
    pub(super) seed: u64,
}

/// Seeds of draws are below 2^53, so that every reader of JSON has them exactly.
const SEEDS: f64 = (1_u64 << 53) as f64;

/// Where worlds come from, one source as likely as another.
pub(super) struct Draws {
    sources: Vec<Source>,
    /// Worlds in which the run has learned.
    learned_in: BTreeSet<String>,
}

enum Source {
    /// A whole family of worlds made by rule: no world twice, and none that the run has learned in.
    Family(&'static str),
    /// Some worlds of a family, each as likely as another.
    Range(FamilyRange),
    /// A world file, by its name or path.
    File(String),
}

impl Draws {
    /// Worlds by name, path, family or rule; without any, the family that the run's own worlds are of.
    ///
    /// # Errors
    /// `E-CERTIFY` if there is no such family.
    pub(super) fn new(plan: &Plan, worlds: &[String]) -> Result<Self> {
        let names = if worlds.is_empty() { own_families(plan)? } else { worlds.to_vec() };
        let sources = names.iter().map(|name| Source::of(name)).collect::<Result<_>>()?;
        Ok(Self { sources, learned_in: learned_in(plan) })
    }

    /// What they are drawn from, as it can be asked for again.
    pub(super) fn names(&self) -> Vec<String> {
        self.sources.iter().map(Source::name).collect()
    }

    /// Whether each draw has a world of its own.
    pub(super) fn are_worlds(&self) -> bool {
        self.sources.iter().all(|source| matches!(source, Source::Family(_)))
    }

    pub(super) fn is_known(&self, world: &str) -> bool {
        self.learned_in.contains(world)
    }

    /// The first `count` draws of a seed; those of a `pilot` are others.
    pub(super) fn draw(&self, seed: u64, count: u64, pilot: bool) -> Vec<Draw> {
        let mut random = Random::of_body(seed, Stream::Certify, u32::from(pilot));
        let mut taken = self.learned_in.clone();
        let mut draw = |_| {
            let source = &self.sources[random.below(self.sources.len() as u32) as usize];
            let mut world = source.draw(&mut random);
            while matches!(source, Source::Family(_)) && !taken.insert(world.clone()) {
                world = source.draw(&mut random);
            }
            Draw { world, seed: (random.unit() * SEEDS) as u64 }
        };
        (0..count).map(&mut draw).collect()
    }
}

impl Source {
    fn of(name: &str) -> Result<Self> {
        if let Some(family) = FAMILIES.into_iter().find(|family| *family == name) {
            return Ok(Self::Family(family));
        }
        match FamilyRange::of(name) {
            Some(Ok(range)) => Ok(Self::Range(range)),
            Some(Err((message, help))) => Diagnostic::new("E-WORLD-FILE", message).help(help).fail(),
            None => Ok(Self::File(name.to_owned())),
        }
    }

    fn name(&self) -> String {
        match self {
            Self::Family(family) => (*family).to_owned(),
            Self::Range(range) => range.name(),
            Self::File(name) => name.clone(),
        }
    }

    /// One or two numbers.
    fn draw(&self, random: &mut Random) -> String {
        match self {
            Self::Family(family) => format!("{family}:{}", random.below(FamilyRange::NUMBERS)),
            Self::Range(range) => range.nth(random.below(range.count() as u32)),
            Self::File(name) => name.clone(),
        }
    }
}

/// The families of the run's own worlds: those that it learned in, else the one that its home world is named after.
fn own_families(plan: &Plan) -> Result<Vec<String>> {
    let family =
        |name: &str| name.split_once(':').and_then(|(family, _)| FAMILIES.into_iter().find(|own| *own == family));
    let names = || plan.worlds.layouts().iter().map(|layout| layout.name.as_str());
    let learned: BTreeSet<&str> = names().filter_map(family).collect();
    if !learned.is_empty() {
        return Ok(learned.into_iter().map(str::to_owned).collect());
    }
    let home = &plan.worlds.home().name;
    if let Some(family) = FAMILIES.into_iter().find(|family| home.starts_with(family.trim_end_matches('s'))) {
        return Ok(vec![family.to_owned()]);
    }
    let message =
        format!("there is no family of worlds like '{}': in which worlds is the policy to be tested?", printable(home));
    let families = FAMILIES.join(", ");
    Diagnostic::new("E-CERTIFY", message)
        .help(format!(
            "add --worlds: a family ({families}), or worlds by name; --worlds {} draws anew in its own world",
            printable(home)
        ))
        .fail()
}

/// The names of all worlds that a run has learned in, in those that it goes on from too.
fn learned_in(plan: &Plan) -> BTreeSet<String> {
    let own = plan.worlds.layouts().iter().map(|layout| layout.name.clone());
    let before = plan.origins.iter().flat_map(|origin| learned_in(&origin.plan));
    own.chain(before).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn draws(sources: Vec<Source>, learned_in: &[&str]) -> Draws {
        Draws { sources, learned_in: learned_in.iter().map(|name| (*name).to_owned()).collect() }
    }

    #[test]
    fn a_family_gives_each_world_once_and_none_that_was_learned_in() {
        // Of two seeds that learned in other worlds, all draws agree but those of worlds that one of them knows.
        let all = draws(vec![Source::Family("rooms")], &[]).draw(7, 2000, false);
        let mut names: Vec<_> = all.iter().map(|draw| draw.world.clone()).collect();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), 2000);
        let known = draws(vec![Source::Family("rooms")], &[&all[3].world]);
        let others = known.draw(7, 2000, false);
        assert!(others.iter().all(|draw| draw.world != all[3].world) && others[..3] == all[..3]);
    }

    #[test]
    fn fewer_draws_are_the_first_of_more_and_those_of_a_pilot_are_others() {
        let draws = draws(vec![Source::Family("lines"), Source::File("hallway".to_owned())], &[]);
        let (few, many) = (draws.draw(1, 10, false), draws.draw(1, 40, false));
        assert_eq!(few, many[..10]);
        assert!(few != draws.draw(1, 10, true) && few != draws.draw(2, 10, false));
        let files = many.iter().filter(|draw| draw.world == "hallway").count();
        // 20 within four deviations of 3.2.
        assert!((8..=32).contains(&files) && many.iter().all(|draw| draw.seed < 1 << 53), "{files}");
    }

    #[test]
    fn a_range_is_drawn_from_evenly() {
        let range = Source::of("corridors:3-5").unwrap();
        let drawn = draws(vec![range], &[]).draw(5, 3000, false);
        for number in 3..=5 {
            let count = drawn.iter().filter(|draw| draw.world == format!("corridors:{number}")).count();
            // 1,000 within four deviations of 25.8.
            assert!((897..=1103).contains(&count), "{number}: {count}");
        }
    }
}
