//! Stages: a set-up call whose argument is a list of names.

use super::setup::SetupReader;
use crate::diagnostic::{Result, printable};
use rhai::Dynamic;

/// Most stages.
const MAX_STAGES: usize = 16;

impl SetupReader<'_> {
    pub(super) fn stages(&self, stages: Dynamic) -> Result<Vec<String>> {
        let form = "stages([\"search\", \"approach\"]);";
        let list = stages.into_array().unwrap_or_default();
        if !(2..=MAX_STAGES).contains(&list.len()) {
            let message = format!("there must be 2 to {MAX_STAGES} stages, found {}", list.len());
            return self.wrong(self.call, message, "set here", form);
        }
        let mut names: Vec<String> = Vec::new();
        for stage in list {
            let name = self.word(stage, form)?;
            if names.contains(&name) {
                return self.wrong(
                    self.call,
                    format!("there are two stages \"{}\"", printable(&name)),
                    "set here",
                    form,
                );
            }
            names.push(name);
        }
        Ok(names)
    }
}
