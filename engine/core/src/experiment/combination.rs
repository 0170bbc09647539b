//! The policies that a script combines: each with the eyes that it learned with.

use super::{Eyes, Plan};
use crate::diagnostic::{Diagnostic, Result, SourceText, printable};
use crate::filter::Chain;
use crate::learner::Policy;
use crate::script::Behaviour;
use crate::settings::{FilterSettings, GridSettings, Settings};
use crate::state::{Grid, GridMap};

/// One policy of a combination.
#[derive(Debug, Clone)]
pub struct Member {
    /// What the script calls it.
    pub name: String,
    /// The behaviour that it learned.
    pub behaviour: String,
    /// The filters that it learned with.
    pub filters: Vec<FilterSettings>,
    /// The grid that it learned with.
    pub grid: GridSettings,
    /// What it learned.
    pub policy: Policy,
    /// The file that it was read from.
    pub source: SourceText,
}

impl Member {
    /// Its eyes, on the plan's camera.
    ///
    /// # Errors
    /// If the filters or the grid cannot be built for this camera.
    pub fn eyes(&self, plan: &Plan) -> Result<Eyes> {
        let (width_px, height_px) = (plan.settings.camera.width_px as usize, plan.settings.camera.height_px as usize);
        let wrong = |message: &str| {
            let message = format!("policy \"{}\" cannot see here: {message}", printable(&self.name));
            Box::new(Diagnostic::new("E-POLICY", message))
        };
        let chain = Chain::new(&self.filters, width_px, height_px, &plan.filters)
            .map_err(|error| wrong(&error.error.message))?
            .mounted(&plan.settings.camera)
            .map_err(|error| wrong(&error.message))?;
        if chain.reads_depth() && !plan.settings.camera.depth {
            return Err(wrong("it reads depth, and the camera measures none"));
        }
        let grid = Grid::new(&self.grid, width_px, height_px).map_err(|error| wrong(&error.0))?;
        let grid = grid.with_period(plan.settings.run.period_s);
        let map = Box::new(GridMap::new(&self.grid, grid.clone()));
        let mut eyes = Eyes::new(vec![chain], vec![grid], map, &plan.settings);
        eyes.go_on_from(self.policy.kept())?;
        Ok(eyes)
    }
}

/// Checks what a script says about policies: two or more, each with a name of its own, and `combine` only with them.
///
/// # Errors
/// For the first mistake, at its call.
pub(super) fn check_policies(behaviour: &Behaviour, settings: &Settings) -> Result<()> {
    let at = |place: &str, message: String, label: &str, help: &str| -> Result<()> {
        let error = Diagnostic::new("E-POLICY", message).help(help);
        match behaviour.place_of(place) {
            Some(span) => error.at(behaviour.source(), span, label).fail(),
            None => error.fail(),
        }
    };
    let second = "add a second one: policy(\"avoid\", \"runs/avoid/1\");";
    for (index, policy) in settings.policies.iter().enumerate() {
        if settings.policies[..index].iter().any(|before| before.name == policy.name) {
            let message = format!("there are two policies called \"{}\"", printable(&policy.name));
            return at(&format!("policy:{index}"), message, "the second one", "choose another name");
        }
    }
    let combine = ["combine.way", "combine.margin", "combine.scaled"];
    if behaviour.hands_over() {
        for (index, policy) in settings.policies.iter().enumerate() {
            if behaviour.knows_its_uses() && !behaviour.uses().any(|(_, used)| used == index) {
                let name = printable(&policy.name);
                let help = format!("write use \"{name}\" when ...; or take it out");
                let message = format!("policy \"{name}\" is named and never used");
                return at(&format!("policy:{index}"), message, "no use of it", &help);
            }
        }
        return match combine.iter().find(|place| behaviour.place_of(place).is_some()) {
            Some(place) => {
                let message = "a script uses its policies one at a time or combines them, not both".to_owned();
                at(place, message, "set here", "take this out, or the uses")
            }
            None => Ok(()),
        };
    }
    match (settings.policies.len(), combine.iter().find(|place| behaviour.place_of(place).is_some())) {
        (1, _) => at("policy:0", "one policy alone cannot be combined".to_owned(), "the only one", second),
        (0, Some(place)) => {
            let help = "name two or more before it: policy(\"avoid\", \"runs/avoid/1\");";
            at(place, "there is nothing to combine: the script names no policy".to_owned(), "set here", help)
        }
        _ => Ok(()),
    }
}
