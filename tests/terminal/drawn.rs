use crossterm::event::KeyCode;
use engine::diagnostic::SourceText;
use engine::experiment::Leg;
use engine::learner::Carry;
use engine::script::Behaviour;
use ratatui_core::style::{Color, Modifier};
use watch::Board;
use watch::terminal::{Panel, TerminalInk, View};

use super::{ADDRESS, INK, buffer, plan, put, save, screen, seen, view};
use crate::support::{SCRIPT, WORLD};

fn wrong(board: &Board) {
    let script = SCRIPT.replace("laser.nearest", "laser.nearst");
    board.failed(&Behaviour::parse("short", SourceText::new("short.rhai", script)).unwrap_err());
}

#[test]
fn a_run_at_80_by_24() {
    insta::assert_snapshot!(screen(&view(), 80, 24));
}

#[test]
fn a_run_at_140_by_45() {
    insta::assert_snapshot!(screen(&view(), 140, 45));
}

#[test]
fn a_bad_save_shows_its_line_and_the_last_run_stays() {
    let board = Board::default();
    save(&board, 1, SCRIPT, WORLD);
    wrong(&board);
    let text = screen(&seen(&board), 80, 24);
    for words in
        ["^^^^^^", "did you mean 'nearest'?", "the last good run stays on screen", "Learning curve", "median  "]
    {
        assert!(text.contains(words), "{words}\n{text}");
    }
    insta::assert_snapshot!(text);
}

#[test]
fn a_bad_save_is_seen_beside_a_large_panel_too() {
    let board = Board::default();
    save(&board, 1, SCRIPT, WORLD);
    wrong(&board);
    let mut view = seen(&board);
    view.enlarge(Some(Panel::Curve));
    assert!(screen(&view, 80, 24).contains("This save cannot be learned"));
}

#[test]
fn a_good_save_takes_the_mistake_away_and_stands_over_the_curve_before() {
    let board = Board::default();
    save(&board, 1, SCRIPT, WORLD);
    assert!(!screen(&seen(&board), 80, 24).contains("before"));
    wrong(&board);
    save(&board, 2, &SCRIPT.replace("<= 0.25", "<= 0.4"), WORLD);
    let text = screen(&seen(&board), 80, 24);
    assert!(text.contains("╌ before") && text.contains("save 2") && !text.contains("cannot be learned"), "{text}");
}

#[test]
fn before_the_first_run_it_says_what_is_done() {
    let board = Board::default();
    assert!(screen(&View::new(ADDRESS, INK), 80, 24).contains("reading the behaviour"));
    board.working("learning 30 seeds, 2000 steps each");
    let view = seen(&board);
    insta::assert_snapshot!(screen(&view, 60, 12));
    // Without room for the whole address, its keys stay.
    assert!(screen(&view, 80, 24).contains(ADDRESS) && screen(&view, 60, 12).ends_with("? help  q quit"));
    wrong(&board);
    let text = screen(&seen(&board), 80, 24);
    assert!(text.contains("nothing is learned yet") && text.contains("^^^^^^"), "{text}");
}

#[test]
fn too_small_a_window_gets_words() {
    let text = screen(&view(), 20, 5);
    assert_eq!(text, "20 x 5 is too small:\nmake the window 40 x\n12 or larger; q\nquits\n");
}

#[test]
fn every_size_can_be_drawn_in_every_state() {
    let board = Board::default();
    save(&board, 1, SCRIPT, WORLD);
    let mut good = seen(&board);
    wrong(&board);
    let mut bad = seen(&board);
    for view in [&mut good, &mut bad] {
        for panel in
            [None, Some(Panel::World), Some(Panel::Curve), Some(Panel::Rules), Some(Panel::Step), Some(Panel::Findings)]
        {
            view.enlarge(panel);
            for (width, height) in (0..130).step_by(9).flat_map(|width| (0..50).map(move |height| (width, height))) {
                buffer(view, width, height);
            }
        }
    }
}

#[test]
fn the_lint_s_findings_stand_with_line_and_way_out() {
    let board = Board::default();
    save(&board, 1, &SCRIPT.replace("<= 0.25", "<= 25"), WORLD);
    let text = screen(&seen(&board), 100, 30);
    assert!(text.contains("Findings  ") && text.contains(" line 3: "), "{text}");
    let mut view = seen(&board);
    view.enlarge(Some(Panel::Findings));
    insta::assert_snapshot!(screen(&view, 80, 24));
}

#[test]
fn hostile_and_long_names_cannot_leave_their_place() {
    let evil = "\\u001b[2J\\u0007\\u202e走廊a very long name that goes on and on without any end in sight for a while";
    let script = SCRIPT.replace("\"too close\"", &format!("\"{evil}\""));
    let world = WORLD.replace("a small room", "a \\u001b]0;room\\u0007");
    let board = Board::default();
    match Behaviour::parse("\u{1b}[31mshort", SourceText::new("short\u{1b}[31m.rhai", &*script)) {
        // A language that refuses such names is as good.
        Err(error) => board.failed(&error),
        Ok(_) => save(&board, 1, &script, &world),
    }
    let mut view = seen(&board);
    for panel in [None, Some(Panel::Rules), Some(Panel::Step), Some(Panel::Findings)] {
        view.enlarge(panel);
        for (width, height) in [(80, 24), (140, 45)] {
            let drawn = buffer(&view, width, height);
            for cell in drawn.content() {
                let raw = |c: char| c.is_control() || ('\u{202a}'..='\u{202e}').contains(&c);
                assert!(!cell.symbol().chars().any(raw), "{:?}", cell.symbol());
            }
        }
    }
    view.enlarge(None);
    let text = screen(&view, 140, 45);
    assert!(text.contains(ADDRESS) && text.contains("\\u{1b}[2J"), "{text}");
}

#[test]
fn rules_of_a_reward_that_was_swapped_keep_their_names() {
    let first = SCRIPT.replace("rule \"too close\" when laser.nearest <= 0.25 => -1 then recover;\n", "");
    let leg = Leg { plan: plan(&first, WORLD), steps: 400, then: Carry::Keep };
    let board = Board::default();
    put(&board, 1, plan(SCRIPT, WORLD).after(vec![leg]), true);
    let mut view = seen(&board);
    assert!(screen(&view, 140, 45).contains("┊ reward swapped"));
    // The first rule of the first script is the second one now.
    view.key(KeyCode::Home.into());
    view.key(KeyCode::Char('.').into());
    let drawn = buffer(&view, 80, 24);
    let lit = |row: u16| drawn[(2, row)].modifier.contains(Modifier::REVERSED);
    let rows: Vec<u16> = (0..24).filter(|row| drawn[(0, *row)].symbol() == "■").collect();
    assert_eq!(rows.iter().map(|row| lit(*row)).collect::<Vec<_>>(), [false, true], "{}", screen(&view, 80, 24));
}

#[test]
fn without_colours_rules_have_letters() {
    let board = Board::default();
    save(&board, 1, SCRIPT, WORLD);
    let mut plain = View::new(ADDRESS, TerminalInk { colour: false, fine: true });
    plain.show(board.shown(0).unwrap());
    let drawn = buffer(&plain, 80, 24);
    assert!(drawn.content().iter().all(|cell| cell.fg == Color::Reset && cell.bg == Color::Reset));
    assert!(screen(&plain, 80, 24).contains("\na too close") && screen(&plain, 80, 24).contains("\nb contact"));
}

#[test]
fn a_console_without_fine_dots_gets_half_blocks() {
    let board = Board::default();
    save(&board, 1, SCRIPT, WORLD);
    let mut coarse = View::new(ADDRESS, TerminalInk { colour: true, fine: false });
    coarse.show(board.shown(0).unwrap());
    let text = screen(&coarse, 80, 24);
    assert!(text.contains('▀') && !text.chars().any(|c| ('\u{2800}'..='\u{28ff}').contains(&c)), "{text}");
}

#[test]
fn the_board_tells_only_news() {
    let board = Board::default();
    assert!(board.shown(0).is_none());
    board.working("learning");
    let first = board.shown(0).unwrap();
    assert!(first.busy && board.shown(first.number).is_none());
    wrong(&board);
    let second = board.shown(first.number).unwrap();
    assert!(!second.busy && second.error.is_some() && second.run.is_none());
}
