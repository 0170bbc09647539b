//! What a script says of its robot: the body that it names, and actions that this body can do.

use super::actions;
use super::named_body::{BodyFiles, named_body};
use super::setup::SetupReader;
use crate::diagnostic::{Diagnostic, Result};
use crate::geometry::Twist;
use crate::judge::explain;
use crate::settings::Settings;
use rhai::Dynamic;

impl SetupReader<'_> {
    pub(super) fn actions(&mut self, actions: Dynamic) -> Result<()> {
        let pairs = match actions::listed(actions) {
            Ok(pairs) => pairs,
            Err(message) => return self.wrong(self.call, message, "set here", actions::FORM),
        };
        self.mark("actions".to_owned(), self.call)?;
        let start = self.places.get("actions").map_or(0, |call| call.start);
        for (index, _) in pairs.iter().enumerate().filter(|(_, pair)| pair.is_none()) {
            let message = format!("action {index} is not a pair of numbers");
            let mut wrong =
                explain::mistake(&self.code.source, "E-SCRIPT-SETTING", self.call, message, "not two numbers");
            if let (Some(place), Some(span)) = (&mut wrong.place, actions::place(self.code, start, index)) {
                place.span = span;
            }
            self.mistakes.add(wrong.help(format!("write {}", actions::FORM)));
            self.unread.all_of("actions");
        }
        // What is none stands still, which every robot can do, so that the others keep their numbers.
        self.settings.actions = pairs.into_iter().map(|pair| pair.unwrap_or(Twist::new(0.0, 0.0))).collect();
        Ok(())
    }

    /// The defaults of the body that is named.
    pub(super) fn body(&mut self, name: Dynamic, form: &str, files: &BodyFiles<'_>) -> Result<()> {
        let name = self.word(name, form)?;
        self.mark("robot".to_owned(), self.call)?;
        self.body = Some(named_body(&name, files, &mut self.settings).map_err(|mut wrong| {
            let at_script = explain::mistake(&self.code.source, wrong.code, self.call, "", "not found");
            wrong.place = wrong.place.or(at_script.place);
            wrong
        })?);
        Ok(())
    }

    /// That the robot can do its actions; those that every script has are cut to what it can.
    pub(super) fn check_actions(&mut self) {
        let Settings { actions, robot, .. } = &mut self.settings;
        let listed = self.body.as_ref().is_some_and(|body| body.lists_actions);
        if let Some(call) = self.places.get("actions") {
            let source = &self.code.source;
            for (index, why, help) in actions::refused(actions, robot) {
                let span = actions::place(self.code, call.start, index).unwrap_or(call.clone());
                let wrong = Diagnostic::new("E-SCRIPT-SETTING", format!("action {index} is {why}"));
                self.mistakes.add(wrong.at(source, span, "this robot cannot do that").help(help));
                self.unread.all_of("actions");
            }
        } else if !listed && self.body.is_some() {
            actions.retain(|action| robot.drive.refuses(*action).is_none());
            if actions.is_empty()
                && let Some(span) = self.places.get("robot")
            {
                let message = "this robot can do none of the actions that every script has";
                let wrong = Diagnostic::new("E-SCRIPT-SETTING", message).help(format!("write {}", actions::FORM));
                self.mistakes.add(wrong.at(&self.code.source, span.clone(), "this robot"));
                self.unread.all_of("actions");
            }
        }
    }
}
