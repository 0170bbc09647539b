//! `manifest.toml`: what a pack is, what it asks for, and every file that it holds.

use semver::{Version, VersionReq};
use serde::{Deserialize, Serialize};

use super::certified::check_worlds;
use super::entry_path::{EntryPath, kind};
use super::evidence::Evidence;
use super::{Digest, MAX_MANIFEST_BYTES, MAX_SEEDS, PackName, malformed};
use engine::diagnostic::{Diagnostic, Result, SourceText, nearest_name, printable};
use engine::settings::Edition;

/// The manifest's name in a pack.
pub(super) const FILE: &str = "manifest.toml";
/// The format that this engine writes.
pub(super) const FORMAT: u32 = 1;
/// That of a pack with a certificate.
pub(super) const FORMAT_OF_CERTIFICATE: u32 = 2;
/// The longest description and licence, bytes.
const MAX_TEXT_BYTES: usize = 300;

/// All that a pack says of itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// The number of the format: 1, or 2 with a certificate.
    pub format: u32,
    /// Its name.
    pub name: PackName,
    /// Its version.
    pub version: Version,
    /// The engines that it runs on.
    pub engine: VersionReq,
    /// The licence, as an SPDX expression.
    pub license: String,
    /// One sentence.
    pub description: String,
    /// The edition of the language that its scripts are of; without it the first, which packs of version 0.1 are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub edition: Option<u32>,
    /// The files that a run starts from.
    pub entry: PackEntry,
    /// What it asks for; nothing unless said.
    #[serde(default, skip_serializing_if = "Capabilities::is_none")]
    pub capabilities: Capabilities,
    /// The packs that it builds on.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub depends: Vec<Dependency>,
    /// Every other file of the pack, in the order of their names.
    #[serde(rename = "file", default)]
    pub files: Vec<FileLine>,
    /// What the author claims; absent from a draft.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub evidence: Option<Evidence>,
}

/// The files that a run starts from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PackEntry {
    /// The behaviour.
    pub script: EntryPath,
    /// The world; without it, the one that the script names.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub world: Option<EntryPath>,
    /// The learned policy; behaviours that combine policies have none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub policy: Option<EntryPath>,
}

/// What a pack asks for, from a closed list.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Capabilities {
    /// WebAssembly filters, by their files.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub filters_wasm: Vec<EntryPath>,
    /// Native filters, by their files; they run with all rights of the user.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub native: Vec<EntryPath>,
    /// The bridge to a robot.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub bridge: bool,
}

/// A pack that this one builds on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Dependency {
    /// Its name.
    pub name: PackName,
    /// The versions that fit.
    pub version: VersionReq,
}

/// One file of the pack.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FileLine {
    /// Its name.
    pub path: EntryPath,
    /// Its size, bytes.
    pub size: u64,
    /// The digest of its bytes.
    pub sha256: Digest,
}

impl Capabilities {
    /// Whether nothing is asked for.
    #[must_use]
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// One line for each thing that is asked for, as it is shown, granted and locked.
    #[must_use]
    pub fn lines(&self) -> Vec<String> {
        let wasm = self.filters_wasm.iter().map(|path| format!("filters_wasm:{path}"));
        let native = self.native.iter().map(|path| format!("native:{path}"));
        let mut lines: Vec<String> = wasm.chain(native).collect();
        lines.extend(self.bridge.then(|| "bridge".to_owned()));
        lines
    }
}

#[derive(Deserialize)]
struct ManifestFormat {
    format: u32,
}

impl Manifest {
    /// Reads a manifest and checks all that can be checked without the files.
    ///
    /// # Errors
    /// `E-PACK-MANIFEST`, `E-PACK-FORMAT` or `E-PACK-CAPABILITY`, at the place in the manifest.
    pub fn parse(source: &SourceText) -> Result<Self> {
        if source.text.len() > MAX_MANIFEST_BYTES {
            let message =
                format!("the manifest has {} bytes, at most {MAX_MANIFEST_BYTES} are read", source.text.len());
            return malformed("E-PACK-LIMIT", message).fail();
        }
        let ManifestFormat { format } = toml::from_str(&source.text).map_err(|error| toml_error(source, &error))?;
        if ![FORMAT, FORMAT_OF_CERTIFICATE].contains(&format) {
            let message =
                format!("the pack has format {format}, this engine reads formats {FORMAT} and {FORMAT_OF_CERTIFICATE}");
            return malformed("E-PACK-FORMAT", message).help("use a newer engine").fail();
        }
        let manifest: Self = toml::from_str(&source.text).map_err(|error| toml_error(source, &error))?;
        manifest.check()?;
        Ok(manifest)
    }

    /// The text of the manifest.
    ///
    /// # Errors
    /// Never in practice: only if it cannot be written as TOML.
    pub fn to_toml(&self) -> Result<String> {
        toml::to_string(self)
            .map_err(|error| Box::new(malformed("E-PACK-MANIFEST", format!("the manifest cannot be written: {error}"))))
    }

    /// The name of the pack's file: `ada-wall-1.2.0.pack`.
    #[must_use]
    pub fn file_name(&self) -> String {
        format!("{}-{}.{}", self.name.file_stem(), self.version, super::PACK_ENDING)
    }

    /// Checks that this engine can run the pack.
    ///
    /// # Errors
    /// `E-PACK-ENGINE` if the pack is for other engines.
    pub fn check_engine(&self) -> Result<()> {
        let own = env!("CARGO_PKG_VERSION");
        if Version::parse(own).is_ok_and(|own| self.engine.matches(&own)) {
            return Ok(());
        }
        let message = format!("{} {} runs on engines {}, this is {own}", self.name, self.version, self.engine);
        malformed("E-PACK-ENGINE", message).help("get another version of the pack or of the engine").fail()
    }

    /// The edition that its scripts are of.
    ///
    /// # Errors
    /// `E-PACK-ENGINE` if this engine does not know it.
    pub fn edition(&self) -> Result<Edition> {
        let number = self.edition.unwrap_or(Edition::FIRST.number());
        let newest = Edition::NEWEST.number();
        Edition::of(number).ok_or_else(|| {
            let message =
                format!("{} {} is of edition {number}, this engine knows 1 to {newest}", self.name, self.version);
            Box::new(malformed("E-PACK-ENGINE", message).help("get another version of the pack or of the engine"))
        })
    }

    fn check(&self) -> Result<()> {
        let wrong = |message: String| -> Result<()> { malformed("E-PACK-MANIFEST", message).fail() };
        for (what, text) in [("license", &self.license), ("description", &self.description)] {
            let plain = !text.trim().is_empty() && text.len() <= MAX_TEXT_BYTES && !text.chars().any(char::is_control);
            if !plain || printable(text) != *text {
                return wrong(format!("'{what}' must be one line of 1 to 200 characters"));
            }
        }
        for pair in self.files.windows(2) {
            if pair[0].path >= pair[1].path {
                return wrong(format!("the files are not in order, each once: '{}', '{}'", pair[0].path, pair[1].path));
            }
        }
        if self.files.iter().any(|line| line.path.as_str() == FILE) {
            return wrong("the manifest lists itself".to_owned());
        }
        for (index, dependency) in self.depends.iter().enumerate() {
            let twice = self.depends[..index].iter().any(|before| before.name == dependency.name);
            if twice || dependency.name == self.name {
                return wrong(format!("'{}' cannot be a dependency twice, nor of itself", dependency.name));
            }
        }
        if self.evidence.as_ref().is_some_and(|evidence| evidence.seeds.len() > MAX_SEEDS) {
            return malformed("E-PACK-LIMIT", format!("the evidence has more than {MAX_SEEDS} seeds, the limit"))
                .fail();
        }
        let certificate = self.evidence.as_ref().and_then(|evidence| evidence.certificate.as_ref());
        certificate.map_or(Ok(()), |certificate| check_worlds(&certificate.worlds))?;
        self.check_entry()?;
        self.check_capabilities()
    }

    fn check_entry(&self) -> Result<()> {
        let PackEntry { script, world, policy } = &self.entry;
        let files =
            [("script", "rhai", Some(script)), ("world", "toml", world.as_ref()), ("policy", "toml", policy.as_ref())];
        for (what, ending, path) in files {
            let Some(path) = path else { continue };
            if kind(path.as_str()) != Some(ending) {
                let message = format!("the {what} of a pack is a .{ending} file, not '{path}'");
                return malformed("E-PACK-MANIFEST", message).fail();
            }
            if !self.files.iter().any(|line| line.path == *path) {
                let message = format!("the {what} '{path}' is not among the pack's files");
                return malformed("E-PACK-LIST", message).fail();
            }
        }
        Ok(())
    }

    /// Every file that can run is asked for, and everything asked for is there.
    fn check_capabilities(&self) -> Result<()> {
        let Capabilities { filters_wasm, native, .. } = &self.capabilities;
        for (asked, name, endings) in
            [(filters_wasm, "filters_wasm", &["wasm"][..]), (native, "native", &["so", "dylib", "dll"])]
        {
            let runs = |path: &EntryPath| kind(path.as_str()).is_some_and(|kind| endings.contains(&kind));
            let held: Vec<_> = self.files.iter().map(|line| &line.path).filter(|path| runs(path)).collect();
            if let Some(hidden) = held.iter().find(|path| !asked.contains(path)) {
                let message = format!("the pack holds '{hidden}' without asking for it under [capabilities]");
                let help = format!("the author writes: {name} = [\"{hidden}\"]");
                return malformed("E-PACK-CAPABILITY", message).help(help).fail();
            }
            if let Some(missing) = asked.iter().find(|path| !held.contains(path)) {
                let message = format!("the pack asks for '{name}' with '{missing}', which it does not hold");
                return malformed("E-PACK-CAPABILITY", message).fail();
            }
        }
        Ok(())
    }
}

/// A TOML error in the user's own line.
pub(super) fn toml_error(source: &SourceText, error: &toml::de::Error) -> Box<Diagnostic> {
    let span = error.span().unwrap_or(0..0);
    let name = source.path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let label = printable(error.message().lines().next().unwrap_or_default());
    let diagnostic = malformed("E-PACK-MANIFEST", format!("'{}' is not as it should be", printable(&name)));
    let diagnostic = diagnostic.at(source, span, label.clone());
    // The library's text quotes the unknown name first and then every name that it knows.
    let names: Vec<&str> = error.message().split('`').skip(1).step_by(2).collect();
    Box::new(match names.split_first() {
        Some((wrong, known)) if error.message().starts_with("unknown field") => {
            match nearest_name(wrong, known.iter().copied()) {
                Some(near) => diagnostic.help(format!("did you mean '{near}'?")),
                None => diagnostic.help(format!("there are: {}", known.join(", "))),
            }
        }
        _ => diagnostic,
    })
}
