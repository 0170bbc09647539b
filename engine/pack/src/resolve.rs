//! Which versions of the packs that a pack builds on: the highest that fit all ranges, the same choice every time.

use std::collections::BTreeMap;

use semver::Version;

use super::{Dependency, Digest, Pack, PackName, malformed};
use engine::diagnostic::{Diagnostic, Result};

/// The most choices that are tried before giving up.
const MAX_TRIES: usize = 10_000;

/// A version of a pack that is at hand.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Offer {
    /// Its name.
    pub name: PackName,
    /// Its version.
    pub version: Version,
    /// What it builds on.
    pub depends: Vec<Dependency>,
    /// Its identity.
    pub content: Digest,
}

impl Offer {
    /// The offer of a pack.
    #[must_use]
    pub fn of(pack: &Pack) -> Self {
        let manifest = pack.manifest();
        Self {
            name: manifest.name.clone(),
            version: manifest.version.clone(),
            depends: manifest.depends.clone(),
            content: pack.content(),
        }
    }
}

/// Chooses one version of every pack that `root` builds on, in the order of the names.
///
/// # Errors
/// `E-PACK-CYCLE` if a pack builds on itself in the end, `E-PACK-DEPENDS` if no choice fits.
pub fn resolve(root: &Offer, offers: &[Offer]) -> Result<Vec<Offer>> {
    let mut sorted: Vec<&Offer> = offers.iter().collect();
    // The digest decides between two builds of one version, so that the order of the offers never does.
    sorted.sort_by(|a, b| a.name.cmp(&b.name).then(b.version.cmp(&a.version)).then(a.content.cmp(&b.content)));
    // The root is chosen from the start: who builds on it in turn closes a circle.
    let chosen = BTreeMap::from([(root.name.clone(), root)]);
    let mut search = Search { offers: sorted, chosen, tries: 0, failure: None };
    let pending: Vec<Wanted<'_>> = wanted(root).rev().collect();
    if search.solve(pending)? {
        let chosen: Vec<&Offer> = search.chosen.values().copied().collect();
        check_cycles(root, &chosen)?;
        return Ok(chosen.into_iter().filter(|offer| offer.name != root.name).cloned().collect());
    }
    match search.failure {
        Some(failure) => Err(failure),
        None => malformed("E-PACK-DEPENDS", format!("no versions fit what {} builds on", root.name)).fail(),
    }
}

/// A dependency and who has it.
type Wanted<'a> = (&'a PackName, &'a Dependency);

fn wanted(offer: &Offer) -> impl DoubleEndedIterator<Item = Wanted<'_>> {
    offer.depends.iter().map(move |dependency| (&offer.name, dependency))
}

struct Search<'a> {
    offers: Vec<&'a Offer>,
    chosen: BTreeMap<PackName, &'a Offer>,
    tries: usize,
    failure: Option<Box<Diagnostic>>,
}

impl<'a> Search<'a> {
    /// Satisfies the last wanted dependency, then the others; false if a choice before it must change.
    fn solve(&mut self, mut pending: Vec<Wanted<'a>>) -> Result<bool> {
        let Some((who, dependency)) = pending.pop() else { return Ok(true) };
        self.tries += 1;
        if self.tries > MAX_TRIES {
            return malformed("E-PACK-DEPENDS", "the dependencies are too tangled to resolve").fail();
        }
        if let Some(chosen) = self.chosen.get(&dependency.name) {
            let fits = dependency.version.matches(&chosen.version);
            if fits {
                return self.solve(pending);
            }
            self.fail(who, dependency);
            return Ok(false);
        }
        let fitting: Vec<&'a Offer> = self.offers.iter().copied().filter(|offer| fits(dependency, offer)).collect();
        for offer in fitting {
            self.chosen.insert(offer.name.clone(), offer);
            let mut next = pending.clone();
            next.extend(wanted(offer).rev());
            if self.solve(next)? {
                return Ok(true);
            }
            self.chosen.remove(&offer.name);
        }
        self.fail(who, dependency);
        Ok(false)
    }

    fn fail(&mut self, who: &PackName, dependency: &Dependency) {
        let known: Vec<String> = self
            .offers
            .iter()
            .filter(|offer| offer.name == dependency.name)
            .map(|offer| offer.version.to_string())
            .collect();
        let known = if known.is_empty() { "no version of it".to_owned() } else { known.join(", ") };
        let message = format!("{who} builds on {} {}, and {known} is at hand", dependency.name, dependency.version);
        let help = "put its .pack and .minisig beside this pack, or name their folder with --from FOLDER";
        self.failure.get_or_insert(Box::new(malformed("E-PACK-DEPENDS", message).help(help)));
    }
}

fn fits(dependency: &Dependency, offer: &Offer) -> bool {
    offer.name == dependency.name && dependency.version.matches(&offer.version)
}

fn check_cycles(root: &Offer, chosen: &[&Offer]) -> Result<()> {
    let mut done: Vec<&PackName> = Vec::new();
    visit(root, chosen, &mut Vec::new(), &mut done)
}

fn visit<'a>(
    offer: &'a Offer,
    chosen: &[&'a Offer],
    chain: &mut Vec<&'a PackName>,
    done: &mut Vec<&'a PackName>,
) -> Result<()> {
    if let Some(start) = chain.iter().position(|name| **name == offer.name) {
        let names: Vec<String> = chain[start..].iter().chain([&&offer.name]).map(|name| name.to_string()).collect();
        let message = format!("packs build on one another in a circle: {}", names.join(" -> "));
        return malformed("E-PACK-CYCLE", message).help("one of them must do without the other").fail();
    }
    if done.contains(&&offer.name) {
        return Ok(());
    }
    chain.push(&offer.name);
    for dependency in &offer.depends {
        if let Some(next) = chosen.iter().find(|next| next.name == dependency.name) {
            visit(next, chosen, chain, done)?;
        }
    }
    chain.pop();
    done.push(&offer.name);
    Ok(())
}
