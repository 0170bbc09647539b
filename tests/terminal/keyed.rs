use crossterm::event::{KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use watch::Board;
use watch::terminal::{Panel, View, Wish};

use super::{learn, save, screen, seen, view};
use crate::support::{SCRIPT, WORLD};

fn press(view: &mut View, key: KeyCode) -> Wish {
    view.key(KeyEvent::new(key, KeyModifiers::NONE))
}

/// The row of the shown step.
fn moment(view: &View) -> String {
    screen(view, 80, 24).lines().nth(22).unwrap().to_owned()
}

#[track_caller]
fn stands_at(view: &View, step: &str) {
    assert!(moment(view).contains(&format!("step {step} of ")), "{}", moment(view));
}

#[test]
fn arrows_go_through_the_steps() {
    let mut view = view();
    stands_at(&view, "799");
    press(&mut view, KeyCode::Left);
    stands_at(&view, "798");
    view.key(KeyEvent::new(KeyCode::Left, KeyModifiers::SHIFT));
    stands_at(&view, "698");
    press(&mut view, KeyCode::Char('['));
    stands_at(&view, "648");
    press(&mut view, KeyCode::Char(']'));
    press(&mut view, KeyCode::Right);
    stands_at(&view, "699");
    press(&mut view, KeyCode::Home);
    press(&mut view, KeyCode::Left);
    stands_at(&view, "0");
    view.key(KeyEvent::new(KeyCode::Right, KeyModifiers::SHIFT));
    stands_at(&view, "100");
    press(&mut view, KeyCode::End);
    press(&mut view, KeyCode::Right);
    stands_at(&view, "799");
}

#[test]
fn space_plays_as_fast_as_the_digit_says() {
    let mut view = view();
    press(&mut view, KeyCode::Home);
    press(&mut view, KeyCode::Char('4'));
    press(&mut view, KeyCode::Char(' '));
    assert!(view.is_playing() && moment(&view).ends_with("playing, 10×"));
    // Ten times as fast as steps of half a second.
    assert!(view.advance(1.0));
    stands_at(&view, "20");
    assert!(!view.advance(0.04));
    assert!(view.advance(0.02));
    stands_at(&view, "21");
    press(&mut view, KeyCode::Char(' '));
    assert!(!view.advance(1.0));
    press(&mut view, KeyCode::Char('9'));
    press(&mut view, KeyCode::Char(' '));
    view.advance(1.0);
    stands_at(&view, "799");
    assert!(!view.is_playing());
    press(&mut view, KeyCode::Char(' '));
    stands_at(&view, "0");
}

#[test]
fn marks_are_gone_to_and_their_rule_is_lit() {
    let mut view = view();
    press(&mut view, KeyCode::Home);
    press(&mut view, KeyCode::Char('.'));
    let (first, text) = (moment(&view), screen(&view, 140, 45));
    assert!(first.contains("reward −1 · ") && first.contains("recovers"), "{first}");
    assert!(text.contains("fired"), "{text}");
    press(&mut view, KeyCode::Char('.'));
    assert_ne!(moment(&view), first);
    press(&mut view, KeyCode::Char(','));
    assert_eq!(moment(&view), first);
}

#[test]
fn seeds_and_phases_are_chosen() {
    let mut view = view();
    assert!(screen(&view, 80, 24).contains("· seed 1: "));
    press(&mut view, KeyCode::Char('n'));
    assert!(screen(&view, 80, 24).contains("· seed 2: "));
    press(&mut view, KeyCode::Down);
    assert!(screen(&view, 80, 24).contains("· seed 1: "));
    press(&mut view, KeyCode::Up);
    assert!(screen(&view, 80, 24).contains("· seed 2: "));
    press(&mut view, KeyCode::Char('t'));
    assert!(moment(&view).starts_with("test, step 399 of 400"), "{}", moment(&view));
    press(&mut view, KeyCode::Char('t'));
    assert!(moment(&view).starts_with("learning, step "));
}

#[test]
fn a_panel_gets_the_whole_screen_and_gives_it_back() {
    let mut view = view();
    let whole = screen(&view, 80, 24);
    press(&mut view, KeyCode::Tab);
    let text = screen(&view, 80, 24);
    assert!(text.contains("World") && !text.contains("Learning curve"), "{text}");
    for title in ["Learning curve", "Rules", "This step", "Findings"] {
        press(&mut view, KeyCode::Tab);
        assert!(screen(&view, 80, 24).lines().nth(2).unwrap().starts_with(title));
    }
    press(&mut view, KeyCode::Tab);
    assert_eq!(screen(&view, 80, 24), whole);
    press(&mut view, KeyCode::BackTab);
    press(&mut view, KeyCode::Esc);
    assert_eq!(screen(&view, 80, 24), whole);
    press(&mut view, KeyCode::Char('?'));
    insta::assert_snapshot!(screen(&view, 80, 24));
    press(&mut view, KeyCode::Char('?'));
    assert_eq!(screen(&view, 80, 24), whole);
}

#[test]
fn what_concerns_the_program_is_handed_on() {
    let mut view = view();
    assert_eq!(press(&mut view, KeyCode::Char('q')), Wish::Quit);
    assert_eq!(press(&mut view, KeyCode::Char('r')), Wish::Again);
    let control = |key| KeyEvent::new(KeyCode::Char(key), KeyModifiers::CONTROL);
    assert_eq!(view.key(control('c')), Wish::Quit);
    assert_eq!(view.key(control('l')), Wish::Clear);
    let released = KeyEvent { kind: KeyEventKind::Release, ..KeyEvent::from(KeyCode::Char('q')) };
    assert_eq!(view.key(released), Wish::Nothing);
}

#[test]
fn a_new_save_keeps_seed_and_step() {
    let board = Board::default();
    save(&board, 1, SCRIPT, WORLD);
    let mut view = seen(&board);
    press(&mut view, KeyCode::Char('n'));
    press(&mut view, KeyCode::Left);
    save(&board, 2, &SCRIPT.replace("<= 0.25", "<= 0.4"), WORLD);
    view.show(board.shown(0).unwrap());
    assert!(screen(&view, 80, 24).contains("· seed 2: "));
    stands_at(&view, "798");
    view.enlarge(Some(Panel::World));
    stands_at(&view, "798");
}

#[test]
fn a_new_save_comes_back_to_the_test_once_there_is_one() {
    let board = Board::default();
    save(&board, 1, SCRIPT, WORLD);
    let mut view = seen(&board);
    press(&mut view, KeyCode::Char('t'));
    learn(&board, 2, SCRIPT, WORLD, false);
    view.show(board.shown(0).unwrap());
    assert!(moment(&view).starts_with("learning, "));
    save(&board, 2, SCRIPT, WORLD);
    view.show(board.shown(0).unwrap());
    assert!(moment(&view).starts_with("test, "));
}

#[test]
fn keys_do_no_harm_before_the_first_run() {
    let mut view = View::new("", super::INK);
    let keys =
        [KeyCode::Char(' '), KeyCode::Left, KeyCode::Right, KeyCode::End, KeyCode::Char('n'), KeyCode::Char('p')];
    for key in keys.into_iter().chain([KeyCode::Char('t'), KeyCode::Char('.'), KeyCode::Char(','), KeyCode::PageDown]) {
        press(&mut view, key);
        view.advance(1.0);
        assert!(view.question().is_none() && !view.is_playing());
        screen(&view, 80, 24);
    }
}
