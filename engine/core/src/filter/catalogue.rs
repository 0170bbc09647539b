//! Which filters there are, by name: those linked in, and those in folders of libraries and WebAssembly modules.
//!
//! A file is opened only when the filter that it is named after is asked for, so that a folder may hold more than a run
//! needs, and nothing that a run does not name is ever loaded.

use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use filter_api::{Descriptor, FilterError, Plugin};

use super::condition;
use super::entry::{Create, Entry, Form};
use super::running::{Linked, Running, refused};
use super::trust::Trust;
use super::{native, wasm};
use crate::diagnostic::{Diagnostic, Result, nearest_name, printable};

/// The filters that are linked in, by name; the engine's own `where` comes after them.
pub const LINKED_IN: &[Plugin] = &[
    blur::PLUGIN,
    chroma::PLUGIN,
    colour::PLUGIN,
    floor::PLUGIN,
    horizon::PLUGIN,
    relief::PLUGIN,
    scharr::PLUGIN,
    sobel::PLUGIN,
    threshold::PLUGIN,
];

/// Where filters come from, besides the program itself.
#[derive(Debug, Clone, Default)]
pub struct Sources {
    /// Folders of libraries and modules, in order; a name may occur once.
    pub folders: Vec<PathBuf>,
    /// Which native libraries may be loaded.
    pub trust: Trust,
    /// The program to run native filters in, one process for each; without it they run inside this process.
    pub worker: Option<PathBuf>,
    /// Leaves the linked-in filters out, so that a folder may hold the same names: for comparing forms.
    pub without_linked_in: bool,
}

/// A file of a folder, opened when it is first asked for.
struct File {
    name: String,
    path: PathBuf,
    form: Form,
    entry: OnceLock<Result<Arc<Entry>>>,
}

/// All filters of a run.
#[derive(Default)]
pub struct Catalogue {
    linked_in: Vec<Arc<Entry>>,
    files: Vec<File>,
    sources: Sources,
}

impl Catalogue {
    /// The filters that are linked in, and nothing else.
    #[must_use]
    pub fn linked_in() -> Self {
        let linked_in = LINKED_IN.iter().map(linked).chain([by_condition()]).collect();
        Self { linked_in, ..Self::default() }
    }

    /// Whether these are the filters that are linked in, and nothing else.
    #[must_use]
    pub(crate) fn is_linked_in(&self) -> bool {
        self.files.is_empty()
    }

    /// Those, and the files of folders; no file is opened yet.
    ///
    /// # Errors
    /// If a folder cannot be read, or two filters have the same name.
    pub fn new(sources: Sources) -> Result<Self> {
        let mut catalogue = if sources.without_linked_in { Self::default() } else { Self::linked_in() };
        for folder in &sources.folders {
            for path in files(folder)? {
                let Some((name, form)) = name_and_form(&path) else { continue };
                catalogue.check_free(&name, &path)?;
                catalogue.files.push(File { name, path, form, entry: OnceLock::new() });
            }
        }
        catalogue.files.sort_by(|a, b| a.name.cmp(&b.name));
        catalogue.sources = sources;
        Ok(catalogue)
    }

    fn check_free(&self, name: &str, path: &Path) -> Result<()> {
        let file = self.files.iter().find(|file| file.name == name).map(|file| file.path.display().to_string());
        let own = self.is_own(name).then(|| "the engine".to_owned());
        let Some(other) = own.or(file) else { return Ok(()) };
        let (name, path) = (printable(name), printable(&path.display().to_string()));
        let message = format!("there are two filters '{name}': in {other} and in '{path}'");
        let help = "give one of them another name, in its descriptor and as the name of its file";
        Diagnostic::new("E-FILTER-TWICE", message).help(help).fail()
    }

    /// Whether a filter of this name is the program's own.
    #[must_use]
    pub fn is_own(&self, name: &str) -> bool {
        self.linked_in.iter().any(|entry| entry.descriptor.name == name)
    }

    /// The filter called `name`, loaded if it was not before.
    ///
    /// # Errors
    /// If there is none: what to write instead. If its file may not or cannot be loaded.
    pub fn find(&self, name: &str) -> Result<Arc<Entry>> {
        if let Some(entry) = self.linked_in.iter().find(|entry| entry.descriptor.name == name) {
            return Ok(Arc::clone(entry));
        }
        if let Some(file) = self.files.iter().find(|file| file.name == name) {
            return file.entry.get_or_init(|| self.open(file)).clone();
        }
        let message = format!("there is no filter '{}'", printable(name));
        let help = match nearest_name(name, self.names()) {
            Some(near) => format!("did you mean \"{near}\"?"),
            None => format!("there are: {}", self.names().collect::<Vec<_>>().join(", ")),
        };
        Diagnostic::new("E-FILTER-SETTING", message).help(help).fail()
    }

    /// The name, form and path of every filter, sorted by name, without opening any.
    pub fn list(&self) -> impl Iterator<Item = (&str, Form, Option<&Path>)> {
        let linked_in = self.linked_in.iter().map(|entry| (entry.descriptor.name, Form::LinkedIn, None));
        let files = self.files.iter().map(|file| (file.name.as_str(), file.form, Some(file.path.as_path())));
        let mut all: Vec<_> = linked_in.chain(files).collect();
        all.sort_by(|a, b| a.0.cmp(b.0));
        all.into_iter()
    }

    /// The filters of the program, sorted by name.
    pub(super) fn own(&self) -> impl Iterator<Item = &Arc<Entry>> {
        self.linked_in.iter()
    }

    fn names(&self) -> impl Iterator<Item = &str> + Clone {
        let linked_in = self.linked_in.iter().map(|entry| entry.descriptor.name);
        linked_in.chain(self.files.iter().map(|file| file.name.as_str()))
    }

    fn open(&self, file: &File) -> Result<Arc<Entry>> {
        let Sources { trust, worker, .. } = &self.sources;
        let entry = match file.form {
            Form::Native => native::open(&file.path, trust, worker.as_deref())?,
            _ => wasm::open(&file.path)?,
        };
        let own = entry.descriptor.name;
        if own == file.name {
            return Ok(Arc::new(entry));
        }
        let path = printable(&file.path.display().to_string());
        let message = format!("the filter in '{path}' calls itself '{}'", printable(own));
        let help = "name the file after the filter, so that a host knows which file to open";
        Diagnostic::new("E-FILTER-NAME", message).help(help).fail()
    }
}

fn linked(plugin: &Plugin) -> Arc<Entry> {
    let Plugin { descriptor, create } = *plugin;
    let create = move |values: &[f64]| -> Result<Box<dyn Running>> {
        let filter = create(values).map_err(|FilterError(words)| refused(&words))?;
        Ok(Box::new(Linked { name: descriptor.name, filter }))
    };
    own(descriptor, false, Box::new(create))
}

/// The filter `where`, with a condition to begin with: its chain creates it with the script's own.
fn by_condition() -> Arc<Entry> {
    let create = |_: &[f64]| condition::create(condition::EXAMPLE).map_err(|error| refused(&error.message));
    own(&condition::DESCRIPTOR, true, Box::new(create))
}

fn own(descriptor: &'static Descriptor, by_condition: bool, create: Create) -> Arc<Entry> {
    Arc::new(Entry { descriptor, form: Form::LinkedIn, path: None, sha256: None, by_condition, create })
}

/// The files of a folder, sorted.
fn files(folder: &Path) -> Result<Vec<PathBuf>> {
    let unreadable = |error| Box::new(Diagnostic::disk("read the folder of filters", folder, &error));
    let entries = std::fs::read_dir(folder).map_err(unreadable)?;
    let mut paths = entries.map(|entry| Ok(entry.map_err(unreadable)?.path())).collect::<Result<Vec<_>>>()?;
    paths.sort();
    Ok(paths)
}

/// Whether a file of a folder of filters is one, by its name.
#[must_use]
pub fn is_filter_file(path: &Path) -> bool {
    name_and_form(path).is_some()
}

/// `libsobel.so` and `sobel.so` are the native filter `sobel`, `sobel.wasm` is the same in a sandbox; other files are none.
fn name_and_form(path: &Path) -> Option<(String, Form)> {
    let stem = path.file_stem()?.to_str()?;
    let ending = path.extension()?.to_str()?;
    let form = match ending {
        "wasm" => Form::Wasm,
        "so" | "dylib" | "dll" => Form::Native,
        _ => return None,
    };
    let name = if form == Form::Native { stem.strip_prefix("lib").unwrap_or(stem) } else { stem };
    Some((name.to_owned(), form))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_sorted_and_unique_and_every_default_is_in_range() {
        for (index, plugin) in LINKED_IN.iter().enumerate() {
            let descriptor = plugin.descriptor;
            assert!(LINKED_IN[index + 1..].iter().all(|other| other.descriptor.name > descriptor.name));
            for parameter in descriptor.parameters {
                assert!((parameter.min..=parameter.max).contains(&parameter.default), "{}", parameter.name);
            }
        }
    }

    #[test]
    fn a_misspelt_name_is_answered_with_the_nearest() {
        let help = |name: &str| Catalogue::linked_in().find(name).err().unwrap().help.unwrap();
        assert_eq!(help("sobol"), "did you mean \"sobel\"?");
        assert_eq!(
            help("x"),
            "there are: blur, chroma, colour, floor, horizon, relief, scharr, sobel, threshold, where"
        );
    }

    #[test]
    fn a_file_is_named_after_its_filter() {
        let name = |path: &str| name_and_form(Path::new(path));
        assert_eq!(name("a/libink.so"), Some(("ink".to_owned(), Form::Native)));
        assert_eq!(name("ink.dll"), Some(("ink".to_owned(), Form::Native)));
        assert_eq!(name("ink.wasm"), Some(("ink".to_owned(), Form::Wasm)));
        assert_eq!(name("README.md"), None);
    }

    #[test]
    fn two_filters_of_one_name_are_an_error() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("sobel.wasm"), "").unwrap();
        let sources = Sources { folders: vec![folder.path().to_owned()], ..Sources::default() };
        let error = Catalogue::new(sources.clone()).err().unwrap();
        assert_eq!(error.code, "E-FILTER-TWICE");
        assert!(Catalogue::new(Sources { without_linked_in: true, ..sources }).is_ok());
    }
}
