//! The runs that stand under a folder: found, told in a line, tagged, removed.

use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use crate::disk::{Lock, RESUMABLE, is_there, read_file, wanted_name, write_atomic};
use crate::store::{RUN_FILE, SUMMARY_FILE, TAG_FILE, read_stored};
use engine::diagnostic::{Diagnostic, Result, printable};
use engine::experiment::{Spread, Summary};
use serde::{Serialize, Serializer};

/// A tag is a word or a few.
const MOST_TAG: usize = 60;
/// The longest file of a tag that is read, bytes.
const MOST_TAG_BYTES: u64 = 1000;
/// A part of a run stands in it or one folder below.
const MOST_ABOVE: usize = 2;
/// Runs stand in `runs/NAME/SEED`; deeper than this nobody looks.
const MOST_DEPTH: usize = 4;

/// A run that stands in its folder.
#[derive(Debug, Clone, Serialize)]
pub struct ShelvedRun {
    /// Where.
    pub folder: PathBuf,
    /// When its `run.toml` was written, seconds since 1970.
    #[serde(serialize_with = "unix_s", rename = "written_unix_s")]
    pub written: SystemTime,
    /// All its files, bytes.
    pub bytes: u64,
    /// How far it is, of a run that is not done; null else.
    pub unfinished: Option<NotDone>,
    /// The tag that was put on it.
    pub tag: Option<String>,
    /// Name of the behaviour; null if the run was not finished.
    pub behaviour: Option<String>,
    /// Name of its world; null likewise.
    pub world: Option<String>,
    /// How many seeds.
    pub seeds: usize,
    /// How many of them succeed.
    pub successes: usize,
    /// Whether most succeed; null if it was not finished or cannot be told.
    pub success: Option<bool>,
    /// Failures in 1,000 steps of the test: of many seeds the upper median.
    pub failures_per_1000: Option<f64>,
}

/// What has become of a run that is not done.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum NotDone {
    /// It is running; who runs it.
    Running(String),
    /// It was killed, and waits beside its place for `engine run --resume`.
    Killed,
    /// It was stopped, and stands in its place with what was learned until then.
    Stopped,
}

fn unix_s<S: Serializer>(time: &SystemTime, serializer: S) -> std::result::Result<S::Ok, S::Error> {
    let since = time.duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    serializer.serialize_u64(since.as_secs())
}

/// What stands under a folder.
#[derive(Debug, Default)]
pub struct Shelf {
    /// Every run, in the order of their paths; seeds of one run are not runs of their own.
    pub runs: Vec<ShelvedRun>,
    /// Why a folder below could not be looked into.
    pub unread: Vec<Diagnostic>,
}

/// The runs under a folder.
///
/// # Errors
/// If the folder itself cannot be read.
pub fn runs_under(folder: &Path) -> Result<Shelf> {
    let mut shelf = Shelf::default();
    look(folder, 0, &mut shelf)?;
    shelf.runs.sort_by_key(|run| natural(&run.folder));
    Ok(shelf)
}

fn look(folder: &Path, depth: usize, shelf: &mut Shelf) -> Result<()> {
    let name = folder.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    if let Some(wanted) = wanted_name(&name) {
        shelf.runs.extend(ShelvedRun::not_done(folder, &folder.with_file_name(wanted))?);
        return Ok(());
    }
    if is_there(&folder.join(RUN_FILE))? {
        shelf.runs.push(ShelvedRun::read(folder)?);
        return Ok(());
    }
    let entries = std::fs::read_dir(folder).map_err(|error| Box::new(Diagnostic::disk("read", folder, &error)))?;
    for entry in entries.flatten() {
        // A link may lead anywhere, also in circles.
        if depth < MOST_DEPTH && entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            // Somebody else's folder among them is no reason to see none.
            if let Err(error) = look(&entry.path(), depth + 1, shelf) {
                shelf.unread.push(*error);
            }
        }
    }
    Ok(())
}

/// A path as a key that puts 2 before 10.
fn natural(path: &Path) -> Vec<(u64, String)> {
    let part = |part: std::path::Component<'_>| {
        let text = part.as_os_str().to_string_lossy().into_owned();
        let digits: String = text.chars().take_while(char::is_ascii_digit).collect();
        (digits.parse().unwrap_or(u64::MAX), text)
    };
    path.components().map(part).collect()
}

impl ShelvedRun {
    /// A run that is written beside its place, or waits there; nothing if it is what a killed command left.
    fn not_done(part: &Path, place: &Path) -> Result<Option<Self>> {
        let unfinished = match Lock::holder(place) {
            Some(holder) => NotDone::Running(holder),
            None if is_there(&part.join(RESUMABLE))? => NotDone::Killed,
            None => return Ok(None),
        };
        // It may have been put into its place meanwhile.
        if !is_there(&part.join(RUN_FILE))? {
            return Ok(None);
        }
        Ok(Some(Self { folder: place.to_owned(), unfinished: Some(unfinished), ..Self::read(part)? }))
    }

    fn read(folder: &Path) -> Result<Self> {
        let at = folder.join(RUN_FILE);
        let written = std::fs::metadata(&at).and_then(|meta| meta.modified());
        let written = written.map_err(|error| Box::new(Diagnostic::disk("read", &at, &error)))?;
        let tag = read_file(&folder.join(TAG_FILE), MOST_TAG_BYTES).ok();
        let tag = tag.map(|tag| String::from_utf8_lossy(&tag).trim().to_owned());
        let run = Self {
            folder: folder.to_owned(),
            written,
            bytes: bytes_under(folder),
            unfinished: is_there(&folder.join(RESUMABLE))?.then_some(NotDone::Stopped),
            tag: tag.filter(|tag| !tag.is_empty()),
            behaviour: None,
            world: None,
            seeds: 0,
            successes: 0,
            success: None,
            failures_per_1000: None,
        };
        // A run that was broken off has no figures, and is a run all the same.
        let Ok(summary) = read_stored(&folder.join(SUMMARY_FILE)) else { return Ok(run) };
        if let Ok(one) = serde_json::from_str::<Summary>(&summary.text) {
            return Ok(Self {
                behaviour: Some(one.behaviour),
                world: Some(one.world),
                seeds: 1,
                successes: usize::from(one.verdict.is_success()),
                success: one.verdict.success,
                failures_per_1000: Some(one.test.failures_per_1000),
                ..run
            });
        }
        let Ok(many) = serde_json::from_str::<Spread>(&summary.text) else { return Ok(run) };
        // As the seeds say, whatever stands above them.
        let successes = many.seeds.iter().filter(|seed| seed.verdict.is_success()).count();
        let told = many.seeds.iter().any(|seed| seed.verdict.success.is_some());
        Ok(Self {
            seeds: many.seeds.len(),
            successes,
            success: told.then_some(2 * successes > many.seeds.len()),
            failures_per_1000: Some(many.median.failures_per_1000),
            behaviour: Some(many.behaviour),
            world: Some(many.world),
            ..run
        })
    }

    /// What it came to, in a few words.
    #[must_use]
    pub fn words(&self) -> String {
        let go_on = format!("engine run --resume {}", printable(&self.folder.display().to_string()));
        match &self.unfinished {
            Some(NotDone::Running(holder)) => format!("is running: {holder}"),
            Some(NotDone::Killed) => format!("was killed: {go_on}"),
            Some(NotDone::Stopped) => format!("{}; was stopped: {go_on}", self.figures_in_words()),
            None => self.figures_in_words(),
        }
    }

    fn figures_in_words(&self) -> String {
        let (Some(behaviour), Some(world)) = (&self.behaviour, &self.world) else { return "not finished".to_owned() };
        let success = match (self.seeds, self.success) {
            (1, Some(true)) => "success".to_owned(),
            (1, Some(false)) => "no success".to_owned(),
            (_, None) => "success cannot be told".to_owned(),
            (seeds, _) => format!("{} of {seeds} succeed", self.successes),
        };
        let failures =
            self.failures_per_1000.map_or(String::new(), |failures| format!(", {failures:.1} failures in 1000"));
        format!("{} in {}: {success}{failures}", printable(behaviour), printable(world))
    }

    /// How long before `now` it was written, in words of equal width.
    #[must_use]
    pub fn age(&self, now: SystemTime) -> String {
        let minutes = now.duration_since(self.written).unwrap_or(Duration::ZERO).as_secs() / 60;
        let (count, unit) = match minutes {
            minutes if minutes < 60 => (minutes, "min"),
            minutes if minutes < 48 * 60 => (minutes / 60, "h"),
            minutes => (minutes / (24 * 60), "days"),
        };
        format!("{count:>3} {unit:4} ago")
    }
}

fn bytes_under(folder: &Path) -> u64 {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let size = |entry: std::fs::DirEntry| match entry.metadata() {
        Ok(meta) if meta.is_dir() => bytes_under(&entry.path()),
        Ok(meta) => meta.len(),
        Err(_) => 0,
    };
    entries.map(size).sum()
}

/// Puts a tag on a run, or takes it off.
///
/// # Errors
/// `E-RUN-FILE` if the folder is no run; `E-RUN-TAG` if the tag is empty, longer than 60 characters or of more than one line, or
/// if the folder stands in another run, which would go with all that is in it.
pub fn tag_run(folder: &Path, tag: Option<&str>) -> Result<()> {
    read_stored(&folder.join(RUN_FILE))?;
    let whole = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    if let Some(above) = whole.ancestors().skip(1).take(MOST_ABOVE).find(|above| above.join(RUN_FILE).is_file()) {
        let shown = |path: &Path| printable(&path.display().to_string());
        let message = format!("'{}' is a part of the run '{}'", shown(folder), shown(above));
        return Diagnostic::new("E-RUN-TAG", message).help(format!("tag that run: {}", shown(above))).fail();
    }
    let path = folder.join(TAG_FILE);
    let Some(tag) = tag else {
        return match std::fs::remove_file(&path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                Diagnostic::disk("remove", &path, &error).fail()
            }
            _ => Ok(()),
        };
    };
    let tag = tag.trim();
    if tag.is_empty() || tag.chars().count() > MOST_TAG || tag.chars().any(char::is_control) {
        let message = format!("'{}' cannot be a tag", printable(tag));
        return Diagnostic::new("E-RUN-TAG", message).help("write a word or a few, at most 60 characters").fail();
    }
    write_atomic(&path, format!("{tag}\n").as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shelf() -> tempfile::TempDir {
        let place = tempfile::tempdir().unwrap();
        for run in ["wall/10", "wall/2", "line/1-30", "line/1-30/1"] {
            std::fs::create_dir_all(place.path().join(run)).unwrap();
            std::fs::write(place.path().join(run).join(RUN_FILE), "").unwrap();
        }
        place
    }

    #[test]
    fn runs_are_found_in_their_order_and_the_seeds_of_one_are_not_runs() {
        let place = shelf();
        let found = runs_under(place.path()).unwrap().runs;
        let names: Vec<_> = found.iter().map(|run| run.folder.strip_prefix(place.path()).unwrap().to_owned()).collect();
        assert_eq!(names, [Path::new("line/1-30"), Path::new("wall/2"), Path::new("wall/10")]);
        assert_eq!((found[0].words().as_str(), found[0].success), ("not finished", None));
    }

    #[test]
    fn a_tag_stays_until_it_is_taken_off() {
        let place = shelf();
        let run = place.path().join("wall/2");
        tag_run(&run, Some(" best so far ")).unwrap();
        assert_eq!(runs_under(&run).unwrap().runs[0].tag.as_deref(), Some("best so far"));
        tag_run(&run, None).unwrap();
        assert_eq!(runs_under(&run).unwrap().runs[0].tag, None);
        for bad in ["", "two\nlines", &"x".repeat(61)] {
            assert_eq!(tag_run(&run, Some(bad)).unwrap_err().code, "E-RUN-TAG");
        }
        assert_eq!(tag_run(place.path(), Some("x")).unwrap_err().code, "E-RUN-FILE");
        // It would be removed with the run that it is a part of.
        let wrong = tag_run(&place.path().join("line/1-30/1"), Some("best")).unwrap_err();
        assert!(wrong.code == "E-RUN-TAG" && wrong.message.contains("1-30"), "{wrong:?}");
    }
}
