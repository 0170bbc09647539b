//! From world to world: which comes next, and what is drawn for the attempt there.

use super::site::Site;
use super::variation::Variation;
use crate::outcome::Destination;
use crate::random::{Random, Stream};
use crate::saved::{Passed, Passing, Unfit};
use crate::settings::{RecoverTo, Settings};
use crate::world::WorldSet;

/// The worlds in which the robot is not, and what draws.
pub(super) struct Journey {
    worlds: WorldSet,
    /// By number; nothing for the world in which the robot is.
    sites: Vec<Option<Site>>,
    at: usize,
    random: Random,
    variation: Variation,
}

impl Journey {
    /// A journey that begins in the home world, which is made elsewhere.
    pub(super) fn new(worlds: &WorldSet, settings: &Settings, seed: u64) -> Self {
        let site = |(number, layout)| (number > 0).then(|| Site::new(layout, settings, seed, number));
        Self {
            sites: worlds.layouts().iter().enumerate().map(site).collect(),
            worlds: worlds.clone(),
            at: 0,
            random: Random::new(seed, Stream::Worlds),
            variation: Variation::new(settings, seed),
        }
    }

    /// The first attempt begins: its values are drawn. Returns the settings under which it does.
    pub(super) fn set_out(&mut self, here: &mut Site) -> &Settings {
        self.vary(here);
        &self.variation.settings
    }

    /// An attempt has ended: the next world and its values are drawn. Returns where the robot is to be put there.
    pub(super) fn go_on(&mut self, here: &mut Site, to: Option<Destination>) -> Option<Destination> {
        let last = self.at;
        if self.sites.len() > 1 {
            self.at = self.worlds.draw(&mut self.random);
        }
        if let Some(next) = self.sites[self.at].take() {
            let left = std::mem::replace(here, next);
            here.recovery.go_on_from(&left.recovery);
            self.sites[last] = Some(left);
        }
        self.vary(here);
        if self.at == last {
            return to;
        }
        let layouts = self.worlds.layouts();
        match to {
            // Nothing there is near to where the robot was.
            Some(Destination::Word(RecoverTo::Nearest)) => Some(Destination::Word(RecoverTo::Start)),
            None if here.recovery.is_nearest() => Some(Destination::Word(RecoverTo::Start)),
            Some(Destination::Start(start)) => {
                let name = layouts[last].starts.get(start).map(|start| &start.name);
                let same = layouts[self.at].starts.iter().position(|own| Some(&own.name) == name);
                same.map(Destination::Start)
            }
            to => to,
        }
    }

    /// In which world the robot is, and what is drawn; then every world.
    pub(super) fn pass(&mut self, here: &mut Site, by: &mut Passing<'_>) -> Passed {
        let last = self.at;
        by.size(&mut self.at)?;
        by.random(&mut self.random)?;
        self.variation.pass(by)?;
        if self.at >= self.sites.len() {
            return Err(Unfit);
        }
        if let Some(next) = self.sites[self.at].take() {
            self.sites[last] = Some(std::mem::replace(here, next));
        }
        // What a drawn value makes anew goes on from what is passed then.
        if matches!(by, Passing::In(_)) {
            here.change(&self.variation.settings, &self.variation.touched);
        }
        self.sites.iter_mut().flatten().try_for_each(|site| site.pass(by))
    }

    fn vary(&mut self, here: &mut Site) {
        self.variation.draw();
        here.change(&self.variation.settings, &self.variation.touched);
    }

    pub(super) fn at(&self) -> usize {
        self.at
    }

    pub(super) fn drawn(&self) -> &[f64] {
        self.variation.drawn()
    }

    pub(super) fn max_range_m(&self) -> Option<f64> {
        self.variation.max_range_m()
    }
}
