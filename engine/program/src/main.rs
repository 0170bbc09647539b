//! The `engine` program: arguments to a command, a command to an exit status, an error to one clear text.

mod cli;
mod commands;
mod console;

use std::io::IsTerminal;
use std::process::ExitCode;

use clap::Parser;

use cli::{Cli, Command};
use console::{Console, ConsoleError};

fn main() -> ExitCode {
    let cli = Cli::parse();
    let mut console = Console::new(cli.command.wants_json());
    let status = run(&cli.command, &mut console).and_then(|status| console.finish().map(|()| status));
    match status {
        Ok(status) => ExitCode::from(status),
        // The reader of a pipe went away: it has what it wanted.
        Err(ConsoleError::Closed) => ExitCode::SUCCESS,
        Err(ConsoleError::Failed(error)) => {
            console.error(&error, std::io::stderr().is_terminal());
            ExitCode::from(error.kind().exit_status())
        }
    }
}

fn run(command: &Command, console: &mut Console) -> Result<u8, ConsoleError> {
    match command {
        Command::Run(arguments) => commands::run::run(arguments, console),
        Command::Check(arguments) => commands::check::run(arguments, console),
        Command::Test(arguments) => commands::test::run(arguments, console),
        Command::Certify(arguments) => commands::certify::run(arguments, console),
        Command::Replay(arguments) => commands::replay::run(arguments, console),
        Command::Explain(arguments) => commands::explain::run(arguments, console),
        Command::Compare(arguments) => commands::compare::run(arguments, console),
        Command::Export(arguments) => commands::export::run(arguments, console),
        Command::Runs(arguments) => commands::runs::run(arguments, console),
        Command::Rescore(arguments) => commands::rescore::run(arguments, console),
        Command::Watch(arguments) => commands::watch::run(arguments, console),
        Command::Bench(arguments) => commands::bench::run(arguments, console),
        Command::Reproduce(arguments) => commands::reproduce::run(arguments, console),
        Command::Filter(arguments) => commands::filter::run(arguments, console),
        Command::Plugins(arguments) => commands::plugins::run(arguments, console),
        Command::FilterWorker(arguments) => commands::sources::work(arguments),
        Command::New(arguments) => commands::new::run(arguments, console),
        Command::World(arguments) => commands::world::run(arguments, console),
        Command::Pack(arguments) => commands::pack::run(arguments, console),
        Command::Reference(arguments) => commands::reference::run(arguments, console),
        Command::Upgrade(arguments) => commands::upgrade::run(arguments, console),
    }
}
