//! `engine watch`: learns again on every save, and shows the result on a page in the browser, or in the terminal.

use crate::cli::WatchArguments;
use crate::console::{Console, ConsoleError};

#[cfg(not(feature = "serve"))]
pub(crate) fn run(arguments: &WatchArguments, _: &mut Console) -> Result<u8, ConsoleError> {
    use engine::diagnostic::Diagnostic;
    let message = "this program was built without the live page";
    let error = Diagnostic::new("E-WATCH-FEATURE", message);
    let feature = if arguments.tui { "tui" } else { "serve" };
    Err(Box::new(error.help(format!("build it in: cargo build --release --features {feature}"))).into())
}

#[cfg(feature = "serve")]
pub(crate) fn run(arguments: &WatchArguments, console: &mut Console) -> Result<u8, ConsoleError> {
    use engine::experiment::Overrides;
    use std::sync::Arc;
    use watch::{Board, Relearner, WatchSettings, listen};

    #[cfg(feature = "tui")]
    if arguments.tui {
        watch::terminal::require()?;
    }
    #[cfg(not(feature = "tui"))]
    if arguments.tui {
        return Err(without_terminal());
    }
    let overrides = Overrides { steps: arguments.steps, ..arguments.changes.overrides() };
    // What is wrong from the start is said here; what is saved wrong later, on the page.
    let sources = arguments.filters.clone();
    let plan =
        engine::experiment::Plan::load(&arguments.behaviour, &overrides, || super::sources::catalogue(&sources))?;
    let stop = super::stop::on_ctrl_c()?;
    let board = Arc::new(Board::default());
    let keep = keep(arguments.keep.as_deref());
    let name = arguments.behaviour.file_stem().unwrap_or_default();
    let kept = || std::path::Path::new("runs").join(name).join("watch");
    let out = arguments.out.clone().or_else(|| keep.map(|_| kept()));
    let seeds: Vec<u64> = (0..arguments.seeds).map(|index| arguments.seed.wrapping_add(index)).collect();
    if let Some(out) = &out {
        place(out, &plan, &seeds, arguments.force)?;
    }
    let settings = WatchSettings {
        behaviour: arguments.behaviour.clone(),
        seeds,
        threads: arguments.threads.unwrap_or(0) as usize,
        keep,
        finished: out.clone().map(|out| finished(out, arguments.force)),
        overrides,
        filter_folders: sources.filter_dir.clone(),
        packed: {
            let sources = sources.clone();
            Box::new(move |path| super::behaviour::packed_policy(path, &sources, false))
        },
        filters: Box::new(move || super::sources::catalogue(&sources)),
    };
    let relearner = Relearner::new(settings, Arc::clone(&board));
    let address = listen(Arc::clone(&board), relearner.asker(), arguments.port)?;
    #[cfg(feature = "tui")]
    if arguments.tui {
        let status = in_terminal(relearner, &board, &address.url, &stop)?;
        if let Some(out) = &out {
            console.line(&format!("results:   {}", out.display()))?;
        }
        return Ok(status);
    }
    tell(arguments, &address, out.as_deref(), console)?;
    // The file is removed when watching ends.
    let _opened = if arguments.no_open { None } else { open(&address.url) };
    relearner.serve(&stop)?;
    Ok(0)
}

/// Where the page is, what is watched and where it is written.
#[cfg(feature = "serve")]
fn tell(
    arguments: &WatchArguments,
    address: &watch::Address,
    out: Option<&std::path::Path>,
    console: &mut Console,
) -> Result<(), ConsoleError> {
    console.json(&serde_json::json!({ "address": address.url, "port": address.port }))?;
    if address.port != arguments.port && arguments.port != 0 {
        console.note(&format!("port {} is taken: the page is on port {}", arguments.port, address.port));
    }
    console.line(&format!("page:      {}", address.url))?;
    console.line(&format!("watching:  {}; end with Ctrl-C", arguments.behaviour.display()))?;
    if let Some(out) = out {
        console.line(&format!("results:   {}", out.display()))?;
    }
    console.finish()
}

/// The command line allows no other words.
#[cfg(feature = "serve")]
fn keep(word: Option<&str>) -> Option<engine::learner::Carry> {
    let word = word?;
    engine::learner::Carry::ALL.into_iter().find(|(name, _)| *name == word).map(|(_, carry)| carry)
}

/// Refuses a folder that holds the run of somebody else before anything is learned; nothing is left there.
#[cfg(feature = "serve")]
fn place(
    out: &std::path::Path,
    plan: &engine::experiment::Plan,
    seeds: &[u64],
    force: bool,
) -> engine::diagnostic::Result<()> {
    insight::folder::RunFolder::create(out, plan, seeds, if_taken(force)).map(drop)
}

/// An older run of the same script is what is written anew after each save.
#[cfg(feature = "serve")]
fn if_taken(force: bool) -> insight::folder::IfTaken {
    use insight::folder::IfTaken;
    if force { IfTaken::Replace } else { IfTaken::ReplaceOwn }
}

/// Writes every finished run to a folder.
#[cfg(feature = "serve")]
fn finished(out: std::path::PathBuf, force: bool) -> watch::Finished {
    use engine::experiment::{RunLog, SeedRun};
    use insight::folder::{RunFolder, SeedResult};
    Box::new(move |run, tests, seconds| {
        let (plan, many) = (&run.plan, run.seeds.len() > 1);
        let seeds: Vec<u64> = run.seeds.iter().map(|seed| seed.seed).collect();
        let folder = RunFolder::create(&out, plan, &seeds, if_taken(force))?;
        let mut results = Vec::new();
        for (seed, tested) in run.seeds.iter().zip(tests) {
            // A finished run has it.
            let Some(lines) = &seed.lines else { continue };
            let log = RunLog { learning: (*seed.learning).clone(), test: seed.tested.clone() };
            let learned = seed.learned.as_deref().cloned();
            let mut one = SeedRun::new(plan, seed.seed, learned, tested, lines, &log);
            one.summary = one.summary.timed(seconds / seeds.len() as f64);
            folder.keep_log(plan, seed.seed, &log)?;
            results.push(SeedResult { run: one, log: (!many).then_some(log) });
        }
        folder.write(plan, &results, None)?;
        folder.commit()
    })
}

/// Learns on this thread and shows it on another; whichever ends, ends the other.
#[cfg(feature = "tui")]
fn in_terminal(
    relearner: watch::Relearner,
    board: &watch::Board,
    url: &str,
    stop: &std::sync::Arc<std::sync::atomic::AtomicBool>,
) -> Result<u8, ConsoleError> {
    use std::sync::atomic::{AtomicBool, Ordering};

    /// Learning may end by a panic: the terminal must not go on alone.
    struct Ended<'a>(&'a AtomicBool);
    impl Drop for Ended<'_> {
        fn drop(&mut self) {
            self.0.store(true, Ordering::Relaxed);
        }
    }
    let asker = relearner.asker();
    std::thread::scope(|scope| {
        let shown = scope.spawn(|| watch::terminal::show(board, &asker, url, stop));
        let ended = Ended(stop);
        let served = relearner.serve(stop);
        drop(ended);
        let shown = shown.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        served.and(shown).map(|()| 0).map_err(ConsoleError::from)
    })
}

#[cfg(all(feature = "serve", not(feature = "tui")))]
fn without_terminal() -> ConsoleError {
    use engine::diagnostic::Diagnostic;
    let error = Diagnostic::new("E-WATCH-TUI", "this program was built without the terminal's live view");
    ConsoleError::Failed(Box::new(error.help("build it in: cargo build --release --features tui")))
}

/// Opens the browser if there is one; the address is printed anyhow. It is told a file that only this user can read, and
/// that leads on to the page: all users see the arguments of all programs, and the token is none of their business.
#[cfg(feature = "serve")]
fn open(url: &str) -> Option<tempfile::TempDir> {
    use std::process::{Command, Stdio};
    let own = std::env::var_os("XDG_RUNTIME_DIR").map(std::path::PathBuf::from).filter(|folder| folder.is_dir());
    let folder =
        tempfile::Builder::new().prefix("engine-watch-").tempdir_in(own.unwrap_or_else(std::env::temp_dir)).ok()?;
    let file = folder.path().join("open.html");
    let page = format!(
        "<!doctype html><meta charset=utf-8><meta name=referrer content=no-referrer>\n\
         <meta http-equiv=refresh content=\"0; url={url}\"><title>engine watch</title>\n\
         <p><a href=\"{url}\">the live page</a>\n"
    );
    insight::disk::write_atomic(&file, page.as_bytes()).ok()?;
    let program = if cfg!(target_os = "macos") { "open" } else { "xdg-open" };
    let mut command = Command::new(program);
    command.arg(&file).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().ok().map(|_| folder)
}
