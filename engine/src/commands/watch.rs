//! `engine watch`: learns again on every save, and shows the result on a page in the browser.

use crate::cli::WatchArguments;
use crate::console::{Console, ConsoleError};

#[cfg(not(feature = "serve"))]
pub(crate) fn run(_: &WatchArguments, _: &mut Console) -> Result<u8, ConsoleError> {
    use engine::diagnostic::{Diagnostic, Kind};
    let message = "this program was built without the live page";
    let error = Diagnostic::new(Kind::Usage, "E-WATCH-FEATURE", message);
    Err(Box::new(error.help("build it in: cargo build --release --features serve")).into())
}

#[cfg(feature = "serve")]
pub(crate) fn run(arguments: &WatchArguments, console: &mut Console) -> Result<u8, ConsoleError> {
    use engine::experiment::Overrides;
    use engine::watch::{Board, Relearner, WatchSettings, listen};
    use std::sync::Arc;

    // What is wrong from the start is said here; what is saved wrong later, on the page.
    super::sources::catalogue(&arguments.filters)?;
    engine::reward::Behaviour::load(&arguments.behaviour)?;
    let stop = super::stop::on_ctrl_c()?;
    let sources = arguments.filters.clone();
    let (world, set) = (arguments.world.clone(), arguments.set.clone());
    let board = Arc::new(Board::default());
    let settings = WatchSettings {
        behaviour: arguments.behaviour.clone(),
        seeds: (0..arguments.seeds).map(|index| arguments.seed.wrapping_add(index)).collect(),
        threads: arguments.threads.unwrap_or(0) as usize,
        overrides: Overrides { world, steps: arguments.steps, test_steps: None, set },
        filter_folders: sources.filter_dir.clone(),
        filters: Box::new(move || super::sources::catalogue(&sources)),
    };
    let relearner = Relearner::new(settings, Arc::clone(&board));
    let address = listen(board, relearner.asker(), arguments.port)?;
    console.json(&serde_json::json!({ "address": address.url, "port": address.port }))?;
    if address.port != arguments.port && arguments.port != 0 {
        console.note(&format!("port {} is taken: the page is on port {}", arguments.port, address.port));
    }
    console.line(&format!("page:      {}", address.url))?;
    console.line(&format!("watching:  {}; end with Ctrl-C", arguments.behaviour.display()))?;
    console.finish()?;
    if !arguments.no_open {
        open(&address.url);
    }
    relearner.serve(&stop)?;
    Ok(0)
}

/// Opens the browser if there is one; the address is printed anyhow.
#[cfg(feature = "serve")]
fn open(url: &str) {
    use std::process::{Command, Stdio};
    let program = if cfg!(target_os = "macos") { "open" } else { "xdg-open" };
    let quiet = Command::new(program).arg(url).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn();
    drop(quiet);
}
