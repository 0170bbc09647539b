//! A page for every code: what it means, why it is refused, what to do. `engine explain CODE` prints it.

mod filters;
mod watch;

/// A table of pages for each subject; the codes of none of them stand in another.
const TABLES: &[&[(&str, &str)]] = &[PAGES, filters::PAGES, watch::PAGES];

/// Each code with its page, in the order of the alphabet.
const PAGES: &[(&str, &str)] = &[
    (
        "E-CAMERA-BLANK",
        "The camera shows one single colour: nothing in the image differs from anything else.\n\
      A robot that sees nothing would learn nothing, and its curve would not say why.\n\
      Check camera.tilt_deg and camera.height_m, and that the world has walls, obstacles or a textured floor in view.",
    ),
    (
        "E-CAMERA-FROZEN",
        "The robot moves, but its camera keeps showing the same image.\n\
      Either the robot is inside a solid, or every place of the world looks alike: no state could tell them apart.\n\
      Move the start into the open, or give the floor and the walls something to see.",
    ),
    (
        "E-CODE",
        "The word that was to be explained looks like a code, but no message of this engine has it.\n\
      Codes stand in brackets at the beginning of a message: error[E-SCRIPT-FACT]. Copy it from there.",
    ),
    (
        "E-GRID",
        "The grid would have more states than a table can hold, or cells without a single pixel.\n\
      Each cell doubles the number of states: 3x3 cells make 64 with the column rule, 512 without. Use fewer rows or columns.",
    ),
    (
        "E-IMAGE-FILE",
        "A photograph, or a folder of them, is missing or cannot be read.\n\
      Give PNG or JPEG files, or a folder that holds them directly; folders within it are not searched.",
    ),
    (
        "E-IMAGE-FORMAT",
        "A file is called an image but is neither PNG nor JPEG inside.\n\
      Its name does not matter, its content does. Save the photograph as PNG or JPEG.",
    ),
    (
        "E-IMAGE-LIMIT",
        "An image has more bytes or more pixels than are read: 64 MiB and 50 megapixels.\n\
      A small file can unpack into a huge picture, so the limit is checked first. Make the image smaller.",
    ),
    (
        "E-IO",
        "A file or folder could not be read or written; the message has the system's reason.\n\
      Look at the path, its permissions and the room on the disk. Old files are unchanged: a new one replaces them only when it is whole.",
    ),
    (
        "E-LOG-DIFFERS",
        "A recorded run was done again, and a step came out otherwise than it was recorded.\n\
      The same seed gives the same bytes with the same engine, filters and files, so one of them has changed: run.toml names the engine that recorded it.\n\
      Build that version to see the old run, or run the behaviour again with this one.",
    ),
    (
        "E-LOG-FILE",
        "The log of a run, log.bin, is missing, cut or damaged, or of another format.\n\
      Each chunk of steps has a checksum, so nothing of a damaged log is believed. Copy the folder again, or run the behaviour again.\n\
      A run of many seeds keeps a log for each: give the folder of one, such as runs/wall/1-30/7.",
    ),
    (
        "E-LOG-RUN",
        "The log beside this run.toml or summary.json was written for another run.\n\
      A log is useless without the settings and the seed that it was recorded with. Keep the files of one run together.",
    ),
    (
        "E-LOG-STEP",
        "A step was asked for that the log does not have, or none was named.\n\
      Steps are counted from 0, learning and test each on its own. engine replay RUN says how many there are and when each rule fired.",
    ),
    (
        "E-MIRROR",
        "The script asks to learn left for right, but one of its actions has no counterpart that turns the other way.\n\
      Add the action with the opposite turning speed, or leave 'mirror' out.",
    ),
    (
        "E-OUT",
        "The folder for the pictures is the one that the photographs come from, and pictures could replace them.\n\
      Name another folder with --out.",
    ),
    (
        "E-PICTURE",
        "A picture could not be drawn or encoded.\n\
      The results in numbers are not touched by this. The message says which part failed.",
    ),
    (
        "E-POLICY",
        "A learned policy cannot be used: its file is missing or damaged, or it was learned with another grid, other filters or other actions.\n\
      Policies are combined by their states and actions, so these must be the same. Learn the policy again with what this script has.",
    ),
    (
        "E-RECOVERY-BLOCKED",
        "The robot is to be put back, but every place that it may be put to touches something or has no ground.\n\
      Move the starts or the route of the world away from walls, boxes and edges; for recovery(\"behind\"), give the mover a longer route.",
    ),
    (
        "E-RECOVERY-MOVER",
        "The script puts the robot back behind a mover, and the world has none.\n\
      Add a [[mover]] with its [[route]] to the world, or choose another recovery, such as recovery(\"start\").",
    ),
    (
        "E-RECOVERY-ROUTE",
        "The script puts the robot back onto the route, and the world has no route called lap.\n\
      Add a closed [[route]] with name = \"lap\", or write recovery(\"start\").",
    ),
    (
        "E-RESCORE",
        "A recorded run cannot be judged by this script, because the script sees or does something else: another world, camera, laser, filter, grid, action or rhythm.\n\
      The record holds what happened under the old ones. Change rules and learner only, or learn anew with engine run.",
    ),
    (
        "E-REWARD-FACTS",
        "A script was asked to judge facts that do not suit it: before its calibration, or of another laser.\n\
      This is a mistake in a program that uses the engine as a library, not in the script.",
    ),
    (
        "E-REWARD-VALUE",
        "A rule or fn reward gave something that is no finite number: the learned values would be spoilt for ever.\n\
      Look for a division by zero, a root or logarithm of a negative number, or a map without 'value'.",
    ),
    ("E-ROW", "The table of the paper's claims has no row of this name. engine reproduce --quick lists them all."),
    (
        "E-RUN-FILE",
        "The folder is not that of a finished run of this engine: run.toml, policy.toml or summary.json is missing, changed or of another format.\n\
      Give the folder that engine run has written, such as runs/wall/1. A changed copy of script or world in it is refused, since the run would no longer be what it says.",
    ),
    (
        "E-SCRIPT-EMPTY",
        "The script has neither a rule nor fn reward: every step would be worth nothing.\n\
      Write a rule, for example: rule \"too close\" when laser.nearest < 0.25 => -1 then recover;",
    ),
    (
        "E-SCRIPT-FACT",
        "The script reads a fact, a beam or a grid cell that does not exist.\n\
      Facts are named in scripts/README.md; beams are counted from 0 on the right, cells from 0 at the top left.",
    ),
    ("E-SCRIPT-FILE", "The script cannot be read from this path. Check the name; scripts end in .rhai."),
    (
        "E-SCRIPT-LIMIT",
        "The script used more than it may: operations, memory, depth or text.\n\
      A judgement takes a handful of operations; look for a loop that does not end or that grows something.",
    ),
    (
        "E-SCRIPT-NAME",
        "The script uses a name or a function that is not there, or with the wrong kind of value.\n\
      The message has the nearest name that is; all of them are in scripts/README.md.",
    ),
    (
        "E-SCRIPT-REWARD",
        "fn reward or fn calibrate is not as it must be: each takes one argument, the facts; calibrate returns what the rules need.\n\
      Write fn reward(facts) { ... } and return a number, or #{ value: -1, recover: true }.",
    ),
    (
        "E-SCRIPT-RULE",
        "A rule is not complete, can never fire, or says something that cannot be.\n\
      The form is: rule \"name\" when CONDITION for 5 seconds => VALUE then recover; where the time and the recovery may be left out.",
    ),
    (
        "E-SCRIPT-RUN",
        "The script failed while it judged a step: an array without that number, a map without that key, a division.\n\
      What it reads depends on what is measured, so this came up only now. The message names the step.",
    ),
    (
        "E-SCRIPT-SETTING",
        "A set-up call has a key or a value that does not exist, is given twice, or stands where nothing can be set up any more.\n\
      Set-up calls stand at the top of the script; their keys, units and ranges are in scripts/README.md.",
    ),
    (
        "E-SCRIPT-SOURCE",
        "The file is not the text of a script: it is too long, not UTF-8, or another kind of file.\n\
      A script is a short text file that ends in .rhai.",
    ),
    (
        "E-SCRIPT-SYNTAX",
        "The script cannot be read as a program: something is missing, or stands where it has no meaning.\n\
      The caret shows where the reader gave up; the cause is there or just before, often a bracket or a ';'.",
    ),
    (
        "E-SET",
        "A --set on the command line names no setting, or gives it a value that it cannot have.\n\
      Write --set GROUP.KEY=VALUE, such as --set camera.tilt_deg=40.",
    ),
    (
        "E-SIGNAL",
        "The system does not let the engine listen for Ctrl-C. Nothing is learned, so that a stop cannot lose it.",
    ),
    ("E-THREADS", "The system does not give the engine the threads that it asked for. Use fewer with --threads."),
    (
        "E-WORLD-FILE",
        "The world is not there, or its file cannot be read.\n\
      A world is named without its ending and looked for in the folder worlds, or given as the path of a .toml file.",
    ),
    (
        "E-WORLD-KEY",
        "A table of the world file has a key that does not exist there, or lacks one that it needs.\n\
      worlds/README.md lists the keys of every table.",
    ),
    ("E-WORLD-NAME", "Something in the world file is called by a name that nothing has, or that two things have."),
    (
        "E-WORLD-START",
        "The world has no place for the robot to start, or the robot would touch something or fall there.\n\
      Add a [[start]] with position_m and yaw_deg, or move it into the open: the robot is about half a metre long.",
    ),
    ("E-WORLD-SYNTAX", "The world file is not TOML. Values stand after '=', text in quotes, lists in [ ]."),
    (
        "E-WORLD-VALUE",
        "A number in the world file is outside of what can be built or simulated.\n\
      Lengths are in metres and angles in degrees: a room of 600 is usually one of 6, written in centimetres.",
    ),
];

/// The page of a code.
#[must_use]
pub fn code_page(code: &str) -> Option<&'static str> {
    TABLES.iter().flat_map(|table| table.iter()).find(|(known, _)| *known == code).map(|(_, page)| *page)
}

/// Every code that has a page.
pub fn all_codes() -> impl Iterator<Item = &'static str> {
    TABLES.iter().flat_map(|table| table.iter()).map(|(code, _)| *code)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_stand_in_the_order_of_the_alphabet_and_once() {
        for table in TABLES {
            assert!(table.windows(2).all(|pair| pair[0].0 < pair[1].0));
        }
        let mut all: Vec<_> = all_codes().collect();
        all.sort_unstable();
        assert!(all.windows(2).all(|pair| pair[0] < pair[1]));
    }

    #[test]
    fn a_page_has_sentences_and_short_lines_of_thought() {
        for (code, page) in TABLES.iter().flat_map(|table| table.iter()) {
            assert!(page.ends_with('.') || page.ends_with(';'), "{code}");
            assert!(page.len() > 60 && page.lines().count() <= 4, "{code}");
        }
    }
}
