//! The edition of a script: what it says, or what is said of it.

use super::setup::{Call, SetupReader};
use crate::diagnostic::Result;
use crate::settings::Edition;

impl SetupReader<'_> {
    /// The edition that the script says by `edition(2);`, before any other call is read.
    ///
    /// # Errors
    /// If there is no such edition.
    pub(super) fn edition(&mut self, call: &Call) -> Result<Edition> {
        self.call = call.position;
        let form = format!("edition({});", Edition::NEWEST.number());
        let [number] = call.arguments.as_slice() else {
            return self.wrong(call.position, "'edition' is written otherwise".to_owned(), "found this", &form);
        };
        let known = number.as_int().ok().and_then(|number| u32::try_from(number).ok());
        if let Some(edition) = known.and_then(Edition::of) {
            return self.mark("edition".to_owned(), call.position).map(|()| edition);
        }
        let numbers: Vec<String> = Edition::all().map(|edition| edition.number().to_string()).collect();
        let message = format!("there is no such edition: there are {}", numbers.join(" and "));
        self.wrong(call.position, message, "not known", &form)
    }
}
