//! The pages about the live page.

use super::Kind;

/// Each code with its page, in the order of the alphabet.
pub(super) const PAGES: &[(&str, Kind, &str)] = &[
    (
        "E-WATCH-FEATURE",
        Kind::Usage,
        "This program was built without the live page, which needs a web server inside.\n\
      Build it in: cargo build --release, without --no-default-features. A run's report.html is the same page and needs none.",
    ),
    (
        "E-WATCH-FILES",
        Kind::Disk,
        "The system cannot tell when the files of the behaviour are saved.\n\
      Mostly too many files are watched already by other programs: close one, or raise fs.inotify.max_user_watches.",
    ),
    (
        "E-WATCH-POLICIES",
        Kind::Input,
        "The script combines learned policies, so nothing is learned that could be kept or written.\n\
      Watch it without --keep and --out: each save tests the combination. engine run SCRIPT writes the folder of such a test.",
    ),
    (
        "E-WATCH-PORT",
        Kind::Fault,
        "Twenty ports in a row are taken, so the page cannot be served.\n\
      End other programs that watch behaviours, or name a port that is free: --port 9000.",
    ),
    (
        "E-WATCH-ROOM",
        Kind::Limit,
        "With --keep or --out every step of every seed is kept, so that the run can be written and driven again; these\n\
      steps find no room in memory. Watch fewer seeds (--seeds 3), or learn fewer steps on each save (--steps 2000).",
    ),
    (
        "E-WATCH-SCREEN",
        Kind::Disk,
        "The terminal cannot be drawn on or read from any more; the message has the system's reason.\n\
      Leave --tui out: the page in a browser shows the same.",
    ),
    (
        "E-WATCH-SERVER",
        Kind::Fault,
        "The server of the page cannot start: the system gives it no thread, no socket or no randomness for its token.\n\
      The message has the system's reason.",
    ),
    (
        "E-WATCH-TERMINAL",
        Kind::Usage,
        "--tui draws on the terminal, so standard input and standard output must be one: no pipe, no file.\n\
      Start it in a terminal, or leave --tui out and open the page in a browser.",
    ),
    (
        "E-WATCH-TUI",
        Kind::Usage,
        "This program was built with the live page but without its view in the terminal.\n\
      Build it in: cargo build --release, without --no-default-features. The page in a browser shows the same.",
    ),
];
