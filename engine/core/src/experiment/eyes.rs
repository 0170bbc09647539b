//! One way of perceiving: filter chains, a grid over the mask of each, and a map from all of them to a state.

use super::SeenView;
use super::doors::no_state;
use crate::diagnostic::Result;
use crate::filter::Chain;
use crate::geometry::Twist;
use crate::judge::{LineFacts, Look, PatchFacts, ViewFacts};
use crate::saved::{Passed, Passing, Unfit};
use crate::sensors::CameraRays;
use crate::sensors::observation::Observation;
use crate::settings::{CameraSettings, Settings, UNNAMED_VIEW, ViewSettings};
use crate::state::{Grid, Patch, PatchFinder, Percept, StateMap, floor_line};
use filter_api::{Descriptor, Format, Moved};

/// What one filter made of an image.
#[derive(Debug, Clone, Copy)]
pub struct ViewStage<'a> {
    /// The view whose filter it is, if it has a name.
    pub view: Option<&'a str>,
    /// The filter.
    pub filter: &'static Descriptor,
    /// A byte for each pixel and channel, row-major.
    pub pixels: &'a [u8],
}

impl ViewStage<'_> {
    /// `sobel`, or `red: colour` of a view with a name.
    #[must_use]
    pub fn name(&self) -> String {
        self.view.map_or_else(|| self.filter.name.to_owned(), |view| format!("{view}: {}", self.filter.name))
    }
}

/// The earlier chain that shares most of its first stages with this one, and how many.
fn begins_alike(chains: &[Chain], index: usize) -> Option<(usize, usize)> {
    let shared = chains[..index].iter().map(|other| chains[index].shared_with(other)).enumerate();
    shared.filter(|(_, shared)| *shared > 0).max_by_key(|(other, shared)| (*shared, usize::MAX - other))
}

/// What turns an image into a state.
pub struct Eyes {
    /// The chain of each view, at least one.
    pub(super) chains: Vec<Chain>,
    /// By chain: an earlier one that begins alike, and in how many stages.
    alike: Vec<Option<(usize, usize)>>,
    /// The grid of each view.
    pub(super) grids: Vec<Grid>,
    pub(super) map: Box<dyn StateMap>,
    /// How many states it says that there are.
    states: usize,
    /// What the views are called; nothing for the view without a name.
    names: Vec<Option<String>>,
    /// What is looked for in the mask of each view besides, and the rays of the camera.
    looks: Vec<Look>,
    finder: PatchFinder,
    rays: CameraRays,
    width_px: usize,
    height_px: usize,
    /// Whether a filter keeps something.
    keep: bool,
    /// Nobody reads what they would see, so that they look at nothing.
    closed: bool,
}

/// How the robot moved in a step of so many seconds, as its wheels say; or it was put elsewhere.
pub(super) fn moved(observation: &Observation, period_s: f64, jumped: bool) -> Moved {
    let Twist { linear_m_per_s, angular_rad_per_s } = observation.odometry;
    match jumped {
        true => Moved { driven_m: 0.0, turned_rad: 0.0, jumped },
        false => Moved { driven_m: linear_m_per_s.abs() * period_s, turned_rad: angular_rad_per_s * period_s, jumped },
    }
}

impl Eyes {
    /// Eyes of some views, a chain and a grid for each, all for the same image, and of the map that makes states of what they see.
    #[must_use]
    pub(super) fn new(chains: Vec<Chain>, grids: Vec<Grid>, map: Box<dyn StateMap>, settings: &Settings) -> Self {
        let CameraSettings { width_px, height_px, .. } = settings.camera;
        let (width_px, height_px) = (width_px as usize, height_px as usize);
        let named = |view: &ViewSettings| (view.name != UNNAMED_VIEW).then(|| view.name.clone());
        let names = settings.views().map(named).take(chains.len()).collect();
        let (looks, rays) = (Vec::new(), CameraRays::new(&settings.camera));
        let keep = chains.iter().any(|chain| chain.keeps() > 0);
        let alike = (0..chains.len()).map(|index| begins_alike(&chains, index)).collect();
        Self {
            chains,
            alike,
            grids,
            states: map.states(),
            map,
            names,
            looks,
            finder: PatchFinder::default(),
            rays,
            width_px,
            height_px,
            keep,
            closed: false,
        }
    }

    /// These eyes, but they look at nothing: each view is as if its mask were empty.
    #[must_use]
    pub(super) fn closed(self) -> Self {
        Self { closed: true, ..self }
    }

    /// Opens them. Gives whether they were closed.
    pub(super) fn open(&mut self) -> bool {
        std::mem::take(&mut self.closed)
    }

    /// Whether they look at nothing.
    pub(super) fn are_closed(&self) -> bool {
        self.closed
    }

    /// The size of the images that they look at: pixels in a row, and rows.
    pub(super) fn size_px(&self) -> (usize, usize) {
        (self.width_px, self.height_px)
    }

    /// These eyes with another map from what is seen to states.
    #[must_use]
    pub(super) fn with_map(self, map: Box<dyn StateMap>) -> Self {
        // What the map reads, it alone knows.
        Self { states: map.states(), map, closed: false, ..self }
    }

    /// From now on these things are looked for in the masks.
    pub(super) fn look_for(&mut self, looks: &[Look]) {
        self.looks = looks.to_vec();
        if looks.iter().any(|look| look.patch) {
            self.finder = PatchFinder::new(self.width_px, self.height_px);
        }
    }

    /// What the chains read; nothing if they look at nothing.
    pub(super) fn likes(&self) -> impl Iterator<Item = Format> {
        self.chains.iter().filter(|_| !self.closed).map(Chain::likes)
    }

    /// Looks at what the robot observed.
    ///
    /// # Errors
    /// If a filter fails.
    pub(super) fn look(&mut self, observation: &Observation) -> Result<()> {
        if self.closed {
            return Ok(());
        }
        for (index, grid) in self.grids.iter_mut().enumerate() {
            let (before, rest) = self.chains.split_at_mut(index);
            let Some(chain) = rest.first_mut() else { break };
            let image = observation.read_as(chain.likes());
            let mask = match self.alike[index].and_then(|(other, shared)| Some((before.get(other)?, shared))) {
                Some((other, shared)) => chain.apply_after(image, other, shared)?,
                None => chain.apply(image)?,
            };
            grid.encode(mask);
        }
        Ok(())
    }

    /// Whether a filter keeps something from image to image.
    pub(super) fn keep(&self) -> bool {
        self.keep && !self.closed
    }

    /// Tells the filters that keep something how the robot moved since the last image.
    pub(super) fn moved(&mut self, moved: &Moved) -> Result<()> {
        self.chains.iter_mut().try_for_each(|chain| chain.moved(moved))
    }

    /// What the filters of all views keep, one after the other.
    pub(super) fn kept(&mut self) -> Result<Vec<u8>> {
        let all = self.chains.iter_mut().map(Chain::save).collect::<Result<Vec<_>>>()?;
        Ok(all.concat())
    }

    /// Goes on from what such eyes kept; from nothing if that is empty.
    pub(super) fn go_on_from(&mut self, kept: &[u8]) -> Result<()> {
        if kept.is_empty() {
            return Ok(());
        }
        let mut rest = kept;
        let last = self.chains.len().saturating_sub(1);
        for (index, chain) in self.chains.iter_mut().enumerate() {
            // The last one is given all that is left, so that it tells of bytes too many.
            let bytes = if index == last { rest.len() } else { chain.keeps().min(rest.len()) };
            let (own, others) = rest.split_at(bytes);
            chain.load(own)?;
            rest = others;
        }
        Ok(())
    }

    /// What goes on from image to image.
    pub(super) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        by.all(&mut self.grids, |by, grid| grid.pass(by))?;
        if !self.keep {
            return Ok(());
        }
        let mut kept = self.kept().map_err(|_| Unfit)?;
        by.bytes(&mut kept)?;
        if matches!(by, Passing::In(_)) { self.go_on_from(&kept).map_err(|_| Unfit) } else { Ok(()) }
    }

    /// What the filters keep, in words: `floor`, and what it says.
    pub(super) fn words(&self) -> impl Iterator<Item = (&'static str, String)> {
        self.chains.iter().flat_map(Chain::words)
    }

    /// The robot was put somewhere: what was seen before is forgotten.
    pub(super) fn forget(&mut self) {
        self.grids.iter_mut().for_each(Grid::forget);
    }

    /// The state of the image that was looked at last, with the other parts of a state.
    ///
    /// # Errors
    /// If the map gives one that it does not have.
    pub(super) fn state(&mut self, observation: &Observation, digits: &[usize]) -> Result<usize> {
        let image = observation.read_as(self.chains[0].likes());
        let (mask, grid) = (self.chains[0].mask(), &self.grids[0]);
        let state = self.map.encode(Percept { image, mask, grid, grids: &self.grids, digits });
        if state < self.states { Ok(state) } else { no_state(state, self.states).fail() }
    }

    /// What the image that was looked at last shows in each view. Allocates nothing after the first time.
    pub(super) fn tell(&mut self, views: &mut Vec<ViewFacts>) {
        views.resize_with(self.grids.len(), ViewFacts::default);
        let pixels = (self.width_px * self.height_px) as f64;
        for (index, (view, grid)) in views.iter_mut().zip(&self.grids).enumerate() {
            if view.areas_px.is_empty() {
                view.areas_px.extend((0..grid.counts().len()).map(|cell| grid.area_px(cell) as u32));
            }
            view.cells.clear();
            let shares = grid.counts().iter().zip(&view.areas_px);
            view.cells.extend(shares.map(|(count, area)| *count as f32 / *area as f32));
            (view.grid, view.index) = (grid.size(), grid.state());
            view.seen = grid.occupied().contains(&true);
            view.coverage = f64::from(grid.counts().iter().sum::<u32>()) / pixels;
            let look = self.looks.get(index).copied().unwrap_or_default();
            if look.patch {
                let mask = self.chains[index].mask();
                let patch = self.finder.find(mask, self.width_px);
                let seen = patch.is_seen();
                view.patch = if seen { self.patch(&patch, pixels) } else { PatchFacts::NOTHING };
                view.line = if seen && look.line { self.line(mask, &patch) } else { LineFacts::NOTHING };
            }
        }
    }

    fn patch(&self, patch: &Patch, pixels: f64) -> PatchFacts {
        let (x, y) = patch.centre();
        let (bearing_deg, elevation_deg) = self.rays.bearing_deg(x, y);
        let half = 0.5 * self.width_px as f64;
        let edge = |x: f64| self.rays.bearing_deg(x, y).0;
        let lowest = self.rays.floor_m(x, f64::from(patch.rows.1) + 1.0);
        PatchFacts {
            size: f64::from(patch.pixels) / pixels,
            bearing_deg,
            elevation_deg,
            offset: (half - x) / half,
            left_deg: edge(f64::from(patch.columns.0)),
            right_deg: edge(f64::from(patch.columns.1) + 1.0),
            floor_m: lowest.map_or(PatchFacts::NOTHING.floor_m, |at| {
                (at.x * at.x + at.y * at.y).sqrt().min(PatchFacts::NOTHING.floor_m)
            }),
        }
    }

    fn line(&self, mask: &[u8], patch: &Patch) -> LineFacts {
        floor_line(mask, self.width_px, patch, |x, y| self.rays.floor_m(x, y)).map_or(LineFacts::NOTHING, |line| {
            LineFacts {
                seen: true,
                offset_m: line.offset_m.clamp(-10.0, 10.0),
                heading_deg: libm::atan(line.slope).to_degrees(),
            }
        })
    }

    /// What each filter of each view made of the image that was looked at last; nothing of eyes that look at nothing.
    pub(super) fn stages(&self) -> impl Iterator<Item = ViewStage<'_>> {
        self.chains.iter().filter(|_| !self.closed).zip(&self.names).flat_map(|(chain, view)| {
            let stage = |(filter, pixels)| ViewStage { view: view.as_deref(), filter, pixels };
            chain.stages().map(stage)
        })
    }

    /// What each view made of the image that was looked at last; nothing of eyes that look at nothing.
    pub(super) fn views(&self) -> impl Iterator<Item = SeenView> {
        let views = self.names.iter().filter(|_| !self.closed).zip(&self.chains).zip(&self.grids);
        views.map(|((name, chain), grid)| SeenView::of(name.as_deref(), chain.mask(), grid))
    }

    /// The first view's chain.
    pub(super) fn chain(&self) -> &Chain {
        &self.chains[0]
    }

    /// The first view's grid.
    pub(super) fn grid(&self) -> &Grid {
        &self.grids[0]
    }
}
