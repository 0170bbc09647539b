//! `engine filter`: photographs seen as a behaviour's filters see them, and whether training met their states.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use engine::diagnostic::{Diagnostic, Result, printable};
use engine::experiment::{Decider, Overrides, SeenView, Sight};
use engine::filter::{Catalogue, Chain};
use engine::learner::Policy;
use engine::sensors::observation::Image;
use engine::sensors::{load_depth, load_photograph, photograph_files};
use engine::settings::Settings;
use engine::state::Grid;
use insight::disk::{Together, is_there, write_atomic};
use insight::folder::TEST_FILE;
use insight::page::mask_png;
use insight::report::{FrameData, FramePanel, Picture, frame};
use insight::store::{RUN_FILE, StoredRun};
use pack::Runnable;

use super::behaviour::open_to_look;
use super::sources::catalogue;
use crate::cli::{FilterArguments, FilterSources};
use crate::console::{Console, ConsoleError};

/// From so many images on it is told if most of them have one state.
const FEW_IMAGES: usize = 5;
/// A state that training met less often is hardly known.
const FEW_VISITS: u64 = 10;
/// Most of them: this share.
const ALIKE: f64 = 0.8;

/// What is told of one photograph.
#[derive(serde::Serialize)]
struct SeenImage {
    file: String,
    state: usize,
    /// Filled cells of each column, from the left.
    columns: Vec<usize>,
    /// Share of the image that the filters left.
    coverage: f64,
    /// Share of the pixels of each cell that the filters left, row by row from the top left.
    cells: Vec<f32>,
    /// Share of the image that the largest patch takes up.
    size: f64,
    /// Where it is, degrees, positive to the left; null if there is none.
    bearing_deg: Option<f64>,
    /// What the filters left, as a PNG file of the camera's size: 255 and 0.
    mask: String,
    picture: String,
    /// How often training met the state; only with `--run`.
    #[serde(skip_serializing_if = "Option::is_none")]
    visits: Option<u64>,
    /// That as a share of all steps of training, 0 to 1; only with `--run`.
    #[serde(skip_serializing_if = "Option::is_none")]
    share: Option<f64>,
    /// Whether training never met the state; only with `--run`.
    #[serde(skip_serializing_if = "Option::is_none")]
    new: Option<bool>,
}

pub(crate) fn run(arguments: &FilterArguments, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    let overrides = arguments.changes.overrides();
    // A pack's filters stand in a folder that lives as long as it does.
    let (plan, _unpacked) = sight(&arguments.behaviour, &overrides, &arguments.filters)?;
    if !plan.learns() {
        let message = format!("'{}' combines policies, and each sees with filters of its own", plan.behaviour.name());
        let error = Diagnostic::new("E-COMBINES", message).help("give the script of one of its policies");
        return Err(Box::new(error).into());
    }
    let plan = through(plan, arguments)?;
    let met = arguments.run.as_deref().map(|run| met(run, &plan)).transpose()?;
    let files = photograph_files(&arguments.image)?;
    let out = arguments.out.clone().unwrap_or_else(|| Path::new("runs").join(plan.behaviour.name()).join("filter"));
    check_no_run(&out)?;
    let together = Together::into(&out)?;
    keep_photographs(&files, &out)?;
    let (mut chain, mut grid) = (plan.chain()?, plan.grid()?);
    // Photographs are no drive: each is seen by filters that know what they knew when learning ended, or nothing.
    let kept = met.as_ref().map(|policy| policy.kept().to_vec()).filter(|kept| !kept.is_empty());
    let kept = kept.map_or_else(|| chain.save(), Ok)?;
    let mut names = Vec::with_capacity(files.len());
    let mut all = Vec::with_capacity(files.len());
    for file in &files {
        let camera = &plan.settings.camera;
        let load = if chain.reads_depth() { load_depth } else { load_photograph };
        let image = load(file, camera.width_px as usize, camera.height_px as usize)?;
        chain.load(&kept)?;
        let state = grid.encode(chain.apply(&image).map_err(|error| failed(file, &error.message))?);
        let name = unused(file, &names);
        draw_photograph(file, &image, &chain, &grid, state)?.write(together.folder(), &name)?;
        let visits = met.as_ref().map(|policy| visits(policy, state));
        let mask = format!("{name}-mask.png");
        write_atomic(&together.folder().join(&mask), &mask_png(chain.mask(), (image.width_px, image.height_px))?)?;
        let pixels = image.width_px * image.height_px;
        let patch = plan.patch(chain.mask());
        let seen = SeenImage {
            file: file.display().to_string(),
            state,
            columns: columns(&grid, state),
            coverage: f64::from(grid.counts().iter().sum::<u32>()) / pixels as f64,
            cells: shares(&grid),
            size: patch.map_or(0.0, |(size, _)| size),
            bearing_deg: patch.map(|(_, bearing_deg)| bearing_deg),
            mask: out.join(mask).display().to_string(),
            picture: out.join(format!("{name}.png")).display().to_string(),
            visits,
            share: visits.zip(met.as_ref()).map(|(visits, policy)| visits as f64 / all_visits(policy) as f64),
            new: visits.map(|visits| visits == 0),
        };
        print(console, &seen)?;
        names.push(name);
        all.push(seen);
    }
    together.commit()?;
    console.json(&all)?;
    console.line(&format!("pictures: {}", out.display()))?;
    let alike = told_apart(&all, &grid, met.as_ref(), console)?;
    let new = met.is_some() && told_new(&all, arguments.new_share, console)?;
    Ok(u8::from(alike || new))
}

/// Through one of several views, if one is named; what training met is known of states of one view alone.
fn through(plan: Sight, arguments: &FilterArguments) -> Result<Sight> {
    if plan.settings.has_parts() && arguments.run.is_some() {
        let message = "the states of this behaviour have several parts: those of one view alone were not counted";
        return Diagnostic::new("E-POLICY-FILE", message).help("leave --run out").fail();
    }
    match &arguments.view {
        Some(view) => plan.through(view),
        None => Ok(plan),
    }
}

/// Says how many images show states that training never met, or hardly; whether too many are new.
fn told_new(all: &[SeenImage], new_share: f64, console: &mut Console) -> std::result::Result<bool, ConsoleError> {
    let rare = all.iter().filter(|seen| seen.visits.is_some_and(|visits| (1..FEW_VISITS).contains(&visits))).count();
    if rare > 0 {
        console.line(&format!(
            "rare:     {rare} of {} images show a state met in fewer than {FEW_VISITS} steps",
            all.len()
        ))?;
    }
    let share = all.iter().filter(|seen| seen.new == Some(true)).count() as f64 / all.len() as f64;
    console.line(&format!("new:      {:.0} % of {} images show a state never met", 100.0 * share, all.len()))?;
    if share <= new_share {
        return Ok(false);
    }
    console.line(&format!(
        "warning:  more than {:.0} %: training did not see what these images show",
        100.0 * new_share
    ))?;
    Ok(true)
}

/// What a behaviour sees with. Of a script no world is needed: photographs have nothing to do with it.
fn sight(argument: &Path, overrides: &Overrides, filters: &FilterSources) -> Result<(Sight, Option<Runnable>)> {
    if argument.is_file() && argument.extension().is_some_and(|ending| ending == "rhai") {
        return Ok((Sight::load(argument, overrides, catalogue(filters)?)?, None));
    }
    let pack = open_to_look(argument, overrides, filters, false)?;
    Ok((Sight::from(&pack.plan), Some(pack)))
}

/// Says whether most of the images have one state: then the filters do not tell them apart, whatever training met.
fn told_apart(
    all: &[SeenImage],
    grid: &Grid,
    met: Option<&Policy>,
    console: &mut Console,
) -> std::result::Result<bool, ConsoleError> {
    let count = |state: usize| all.iter().filter(|seen| seen.state == state).count();
    let Some(state) = all.iter().map(|seen| seen.state).max_by_key(|state| (count(*state), *state)) else {
        return Ok(false);
    };
    let (images, most) = (all.len(), count(state));
    if images < FEW_IMAGES || (most as f64) < ALIKE * images as f64 {
        return Ok(false);
    }
    let cells = grid.cells(state);
    let why = match (cells.iter().all(|cell| *cell), cells.iter().any(|cell| *cell)) {
        (true, _) => ", with every cell full: raise the filter's threshold, or grid.occupied",
        (_, false) => ", with every cell empty: lower the filter's threshold, or grid.occupied",
        _ => "",
    };
    console.line(&format!("warning:  one state ({state}) for {most} of {images} images{why}"))?;
    if let Some(policy) = met {
        let share = 100.0 * visits(policy, state) as f64 / all_visits(policy) as f64;
        console.line(&format!("          training was in that state in {share:.1} % of its steps"))?;
    }
    console.line("          the filter does not tell these images apart")?;
    Ok(true)
}

/// What a stored run learned, if it sees as this behaviour does.
fn met(run: &Path, plan: &Sight) -> Result<Policy> {
    let stored = StoredRun::load_with(run, Arc::clone(&plan.filters))?;
    let (own, wanted) = (&stored.plan.settings, &plan.settings);
    let shown = printable(&run.display().to_string());
    let unfit = |message: String, help: &str| Diagnostic::new("E-POLICY-FILE", message).help(help).fail();
    let Decider::Learned(policy) = stored.decider else {
        return unfit(format!("'{shown}' combined policies and met no states itself"), "give the run of one of them");
    };
    let differs = if eyes(own, &plan.filters) != eyes(wanted, &plan.filters) {
        "other filters"
    } else if own.view.grid != wanted.view.grid {
        "another grid"
    } else if (own.camera.width_px, own.camera.height_px) != (wanted.camera.width_px, wanted.camera.height_px) {
        "another size of image"
    } else {
        return Ok(policy);
    };
    let message = format!("'{shown}' was learned with {differs} than '{}' has", plan.behaviour.name());
    unfit(message, "its states mean something else; give its own script, and --set as it was learned with")
}

/// Every filter with its condition and the value of each of its parameters, given or not.
fn eyes<'a>(settings: &'a Settings, filters: &Catalogue) -> Vec<(&'a str, Option<&'a str>, Vec<f64>)> {
    let value = |given: &[(String, f64)], name: &str, default: f64| {
        given.iter().find(|(key, _)| key == name).map_or(default, |(_, value)| *value)
    };
    let values = |name: &str, given: &[(String, f64)]| -> Vec<f64> {
        let parameters = filters.find(name).map_or(&[][..], |entry| entry.descriptor.parameters);
        parameters.iter().map(|parameter| value(given, parameter.name, parameter.default)).collect()
    };
    if settings.view.filters.is_empty() {
        return vec![("sobel", None, values("sobel", &[]))];
    }
    let filters = settings.view.filters.iter();
    filters
        .map(|filter| (filter.name.as_str(), filter.condition.as_deref(), values(&filter.name, &filter.parameters)))
        .collect()
}

/// All steps of training, 1 at least.
fn all_visits(policy: &Policy) -> u64 {
    policy.rows().map(|(_, row)| row.visits).sum::<u64>().max(1)
}

fn visits(policy: &Policy, state: usize) -> u64 {
    policy.row(state).map_or(0, |row| row.visits)
}

/// Refuses a folder for pictures from which a photograph was taken: it could be overwritten.
fn keep_photographs(files: &[PathBuf], out: &Path) -> Result<()> {
    let folder = |path: &Path| path.canonicalize().ok();
    let inside = |file: &PathBuf| folder(file).is_some_and(|file| file.parent() == folder(out).as_deref());
    if !files.iter().any(inside) {
        return Ok(());
    }
    let message = format!("the pictures could overwrite photographs in '{}'", printable(&out.display().to_string()));
    Diagnostic::new("E-OUT", message).help("choose another folder: --out DIR").fail()
}

/// A photograph may have the name of one of a run's pictures.
fn check_no_run(out: &Path) -> Result<()> {
    let shown = printable(&out.display().to_string());
    if !is_there(&out.join(RUN_FILE))? && !is_there(&out.join(TEST_FILE))? {
        return Ok(());
    }
    let message = format!("'{shown}' holds a run or a test, whose pictures these could replace");
    Diagnostic::new("E-RUN-TAKEN", message)
        .help(format!("choose a folder in it, or another one: --out {shown}/filter"))
        .fail()
}

/// The photograph's name without its ending, with a number behind it where another one has it.
fn unused(file: &Path, names: &[String]) -> String {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let free = |name: &String| !names.contains(name);
    if free(&stem) {
        return stem;
    }
    (2..).map(|number: usize| format!("{stem}-{number}")).find(free).unwrap_or(stem)
}

fn draw_photograph(file: &Path, image: &Image, chain: &Chain, grid: &Grid, state: usize) -> Result<Picture> {
    let mut panels = vec![FramePanel::image("photograph", image)];
    panels.extend(chain.stages().map(|(filter, pixels)| FramePanel {
        name: filter.name,
        format: filter.writes,
        pixels,
    }));
    let views = [SeenView::of(None, chain.mask(), grid)];
    let title = printable(&file.file_name().unwrap_or_default().to_string_lossy());
    frame(&FrameData {
        title: &title,
        width_px: image.width_px,
        height_px: image.height_px,
        panels: &panels,
        views: &views,
        state,
    })
}

/// Share of each cell that the filters left.
fn shares(grid: &Grid) -> Vec<f32> {
    grid.counts().iter().enumerate().map(|(cell, count)| *count as f32 / grid.area_px(cell) as f32).collect()
}

fn columns(grid: &Grid, state: usize) -> Vec<usize> {
    let (_, columns) = grid.size();
    let cells = grid.cells(state);
    (0..columns).map(|column| cells.iter().skip(column).step_by(columns).filter(|cell| **cell).count()).collect()
}

fn print(console: &mut Console, seen: &SeenImage) -> std::result::Result<(), ConsoleError> {
    let digits: Vec<String> = seen.columns.iter().map(ToString::to_string).collect();
    let met = match seen.visits {
        None => String::new(),
        Some(0) => ", new".to_owned(),
        Some(1) => ", met once".to_owned(),
        Some(visits) => format!(", met {visits} times"),
    };
    console.line(&format!("{}: state {}, columns {}{met}", printable(&seen.file), seen.state, digits.join(" ")))
}

fn failed(file: &Path, reason: &str) -> Box<Diagnostic> {
    let message = format!("a filter failed on '{}': {}", printable(&file.display().to_string()), printable(reason));
    Box::new(Diagnostic::new("E-FILTER", message))
}
