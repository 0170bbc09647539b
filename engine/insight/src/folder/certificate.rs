//! A certificate in a run's folder: the statement as data, and as a picture with the worst worlds.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use super::files::write_json;
use super::pages::PAGE_FILE;
use crate::disk::{Lock, is_there, write_atomic};
use crate::markup::{Escaped, base64};
use crate::report::{CertifiedData, MOST_PANELS, Picture, WorldPlan, certified};
use crate::store::read_stored;
use crate::words::{three_figures, whole};
use engine::diagnostic::{Diagnostic, Result, printable};
use engine::experiment::{Certificate, CertifiedRate, CertifiedShare, Decider, HardDraw, Overrides, Plan, TestRun};

/// The file of a certificate in a run's folder.
pub const CERTIFICATE_FILE: &str = "certificate.json";
/// The picture, without its ending.
pub(super) const CERTIFICATE_PICTURE: &str = "certificate";

/// The folder for a certificate.
pub struct CertificateFolder<'a> {
    path: &'a Path,
    /// Held as long as somebody may write there.
    _lock: Lock,
}

impl<'a> CertificateFolder<'a> {
    /// A folder that holds no other certificate, unless that is to be replaced.
    ///
    /// # Errors
    /// `E-RUN-TAKEN` if it holds one; if it cannot be made.
    pub fn create(path: &'a Path, force: bool) -> Result<Self> {
        if !force && is_there(&path.join(CERTIFICATE_FILE))? {
            let shown = printable(&path.display().to_string());
            let error = Diagnostic::new("E-RUN-TAKEN", format!("'{shown}' holds a certificate"));
            return error
                .help("draw it again with --again, replace it with --force, or name another folder with --out")
                .fail();
        }
        super::create_folder(path)?;
        Ok(Self { path, _lock: Lock::take(path)? })
    }

    /// Writes the statement, and draws it with the worst draws, which are tested again for it.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(&self, plan: &Plan, decider: &Decider, certificate: &Certificate) -> Result<()> {
        let worst = certificate.worst.iter().filter(|draw| draw.failures > 0 || !draw.success).take(MOST_PANELS);
        let again = |draw: &HardDraw| -> Result<(String, Plan, TestRun)> {
            let there = Overrides {
                world: Some(draw.world.clone()),
                test_steps: Some(certificate.steps),
                ..Overrides::default()
            };
            let plan = plan.clone().with_changes(&there)?;
            let tested = decider.test(&plan, draw.seed, &AtomicBool::new(false), &mut ())?;
            let name = format!("{}: {} failures", draw.world, whole(draw.failures));
            Ok((name, plan, tested))
        };
        let worst = worst.map(again).collect::<Result<Vec<_>>>()?;
        let panels: Vec<_> =
            worst.iter().map(|(name, plan, tested)| (name.clone(), WorldPlan::of(plan), &tested.trail)).collect();
        let title = format!("{}: in {} that it has not seen", certificate.behaviour, drawn_from(certificate));
        let lines = certificate_lines(certificate);
        let picture = certified(&CertifiedData { title: &title, lines: &lines, certificate, worst: &panels })?;
        picture.write(self.path, CERTIFICATE_PICTURE)?;
        add_to_page(self.path, &lines, &picture)?;
        write_json(&self.path.join(CERTIFICATE_FILE), certificate)
    }
}

/// Where the certificate stands in the page of a run, if it has one there.
const BEGINS: &str = "<section class=\"panel\" id=\"certificate\"";
const ENDS: &str = "</section><!--certificate-->\n";
const BEFORE: &str = "<footer>";

/// Puts the statement and its picture into the page of the folder, in the place of an older one; nothing without a page.
fn add_to_page(folder: &Path, lines: &[String], picture: &Picture) -> Result<()> {
    let path = folder.join(PAGE_FILE);
    let page = match std::fs::read_to_string(&path) {
        Ok(page) => without_certificate(&page),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(()),
        Err(error) => return Diagnostic::disk("read", &path, &error).fail(),
    };
    let Some((above, below)) = page.split_once(BEFORE) else { return Ok(()) };
    let said: String = lines.iter().map(|line| format!("<p>{}</p>\n", Escaped(line))).collect();
    let shown = base64(&picture.png);
    let section = format!(
        "{BEGINS} aria-label=\"In worlds that it has not seen\">\n<h2>In worlds that it has not seen</h2>\n{said}\
         <img width=\"100%\" alt=\"failures in each world, and the worst worlds\" src=\"data:image/png;base64,{shown}\">\n{ENDS}"
    );
    write_atomic(&path, [above, &section, BEFORE, below].concat().as_bytes())
}

/// A page as it was drawn before a certificate was put into it.
pub(super) fn without_certificate(page: &str) -> String {
    let section = page.split_once(BEGINS).and_then(|(above, rest)| Some((above, rest.split_once(ENDS)?.1)));
    section.map_or_else(|| page.to_owned(), |(above, below)| [above, below].concat())
}

/// Reads the certificate of a folder.
///
/// # Errors
/// If there is none, or it is none of this engine.
pub fn read_certificate(folder: &Path) -> Result<Certificate> {
    let text = read_stored(&folder.join(CERTIFICATE_FILE)).map_err(|mut error| {
        error.help = Some("make one first: engine certify RUN".to_owned());
        error
    })?;
    serde_json::from_str(&text.text).map_err(|error| {
        let message = format!("'{}' is no certificate of this engine: {error}", text.path.display());
        Box::new(Diagnostic::new("E-RUN-FILE", message).help("make it again: engine certify RUN --force"))
    })
}

/// What the draws are of: `1,000 rooms made by rule`.
fn drawn_from(certificate: &Certificate) -> String {
    let Certificate { worlds, each_its_own_world, draws, .. } = certificate;
    let worlds: Vec<String> = worlds.iter().map(|world| printable(world)).collect();
    match each_its_own_world {
        true => format!("{} {} made by rule", whole(*draws), worlds.join(" and ")),
        false => format!("{} draws in {}", whole(*draws), worlds.join(", ")),
    }
}

/// The statement in a few lines.
#[must_use]
pub fn certificate_lines(certificate: &Certificate) -> Vec<String> {
    let Certificate {
        success, failures, failing, untrained_success, untrained_failures, steps, seed, learned_in, ..
    } = certificate;
    let unit = if certificate.each_its_own_world { "worlds" } else { "draws" };
    let share = |of: &CertifiedShare| {
        format!("{} of {}, {} to {} % of all", of.draws, certificate.draws, percent(of.low), percent(of.high))
    };
    let rate = |of: &CertifiedRate| {
        format!("{} ({} to {})", three_figures(of.per_1000), three_figures(of.low), three_figures(of.high))
    };
    let mut lines = vec![
        format!(
            "{}, {} steps in each, drawn by seed {seed}; in brackets and as shares of all: 95 %.",
            drawn_from(certificate),
            whole(*steps)
        ),
        format!("Success: {} such {unit}; a robot that knows nothing: {}.", share(success), share(untrained_success)),
        format!(
            "Failures in 1,000 steps: {}; a robot that knows nothing: {}.",
            rate(failures),
            rate(untrained_failures)
        ),
        format!("At least one failure in {} steps: {} such {unit}.", whole(*steps), share(failing)),
    ];
    if *learned_in > 0 {
        lines.push(format!(
            "{learned_in} draws are in worlds in which it learned: there, only seeds and starts are unseen."
        ));
    }
    if let Some(aim) = certificate.aim {
        let reached = if aim.reached { "reached" } else { "not reached" };
        let pilot = aim.pilot_per_1000.map_or(String::new(), |rate| {
            format!(
                "; a pilot of {} other draws had {} and said how many to take",
                aim.pilot_draws,
                three_figures(rate)
            )
        });
        lines.push(format!(
            "Aim: below {} failures in 1,000 steps, upper end: {reached}{pilot}.",
            three_figures(aim.per_1000)
        ));
    }
    lines
}

fn percent(share: f64) -> String {
    format!("{:.1}", 100.0 * share)
}
