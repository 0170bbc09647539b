/// The screen as text: sizes, states, hostile texts.
mod drawn;
/// The program in a real pseudo terminal.
mod held;
/// What each key does.
mod keyed;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use engine::diagnostic::SourceText;
use engine::experiment::{Ledger, Overrides, Plan, learn_into, test_and_watch};
use engine::script::Behaviour;
use engine::world::Layout;
use insight::page::{Document, Moments};
use ratatui_core::buffer::Buffer;
use ratatui_core::layout::Rect;
use watch::terminal::{TerminalInk, View, draw_screen};
use watch::{Board, SavedRun, WatchedSeed};

use crate::support::{SCRIPT, WORLD};

const INK: TerminalInk = TerminalInk { colour: true, fine: true };
const ADDRESS: &str = "http://127.0.0.1:8400/?token=00112233445566778899aabbccddeeff";

/// Learns and tests two seeds, and puts them on the board as a save.
fn save(board: &Board, number: u64, script: &str, world: &str) {
    learn(board, number, script, world, true);
}

fn learn(board: &Board, number: u64, script: &str, world: &str, tests: bool) {
    put(board, number, plan(script, world), tests);
}

fn plan(script: &str, world: &str) -> Plan {
    let behaviour = Behaviour::parse("short", SourceText::new("short.rhai", script)).unwrap();
    let settings = behaviour.settings().clone();
    let layout = Layout::parse(SourceText::new("small.toml", world), &settings.robot.body).unwrap();
    let filters = Arc::new(engine::filter::Catalogue::linked_in());
    let plan = Plan::with_layout(Arc::new(behaviour), settings, Arc::new(layout), filters).unwrap();
    plan.with_changes(&Overrides::default()).unwrap()
}

fn put(board: &Board, number: u64, plan: Plan, tests: bool) {
    let never = AtomicBool::new(false);
    let seed = |seed| {
        let mut learning = Ledger::new(plan.first_leg(), plan.first_steps());
        let learned = learn_into(&plan, seed, &never, &|_| (), &mut learning).unwrap();
        if !tests {
            let (learned, learning) = (Some(Arc::new(learned)), Arc::new(learning));
            return WatchedSeed { seed, learned, learning, test: None, lines: None, tested: Ledger::off() };
        }
        let mut tested = Ledger::new(&plan, plan.settings.run.test_steps);
        let test = test_and_watch(&plan, &learned.policy, seed, &never, &mut tested).unwrap();
        let (learned, learning) = (Some(Arc::new(learned)), Arc::new(learning));
        WatchedSeed { seed, learned, learning, test: Some(test.figures), lines: None, tested }
    };
    let seeds = vec![seed(1), seed(2)];
    let data: Vec<_> = seeds.iter().map(WatchedSeed::data).collect();
    let document = Document::new(&plan, &data, Moments { shots: 0, scans: false, seeds: Some(0) }).unwrap();
    let run = Arc::new(SavedRun { save: number, plan, seeds });
    board.run(&run, tests, &format!("save {number}: learned in 0.12 s, tested"), &document).unwrap();
}

/// A view of one save.
fn view() -> View {
    let board = Board::default();
    save(&board, 1, SCRIPT, WORLD);
    seen(&board)
}

fn seen(board: &Board) -> View {
    let mut view = View::new(ADDRESS, INK);
    view.show(board.shown(0).unwrap());
    view
}

fn buffer(view: &View, width: u16, height: u16) -> Buffer {
    let area = Rect::new(0, 0, width, height);
    let mut buffer = Buffer::empty(area);
    draw_screen(view, area, &mut buffer);
    buffer
}

/// The screen's lines.
fn screen(view: &View, width: u16, height: u16) -> String {
    let buffer = buffer(view, width, height);
    let line = |y| (0..width).map(|x| buffer[(x, y)].symbol()).collect::<String>().trim_end().to_owned();
    (0..height).map(line).collect::<Vec<_>>().join("\n")
}
