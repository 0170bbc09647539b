//! Pages of what can be wrong with runs, their files, and the machine.

use super::Kind;

/// Each code with its page, in the order of the alphabet.
pub(super) const PAGES: &[(&str, Kind, &str)] = &[
    (
        "E-BRANCH",
        Kind::State,
        "A run cannot be branched: there is no such step, or the script differs from that of the run in more than rules, the \
         learner's settings and numbers of steps.\n\
         Write for example: engine run mine.rhai --branch runs/wall/1@200.",
    ),
    (
        "E-CERTIFY",
        Kind::Usage,
        "engine certify does not know in which worlds to test the policy, or was asked for something that it cannot state.\n\
         Worlds that are made by rule are of a family: rooms, corridors, lines. A policy is tested in the family of the worlds \
         that it learned in, or that its world is named after; else --worlds says which, or names worlds.",
    ),
    (
        "E-CHECKPOINT",
        Kind::State,
        "A run cannot be gone on with: there is no checkpoint in its place, it is damaged, of another engine or of another run.\n\
         A damaged one is never believed, and never replaced by nothing: what stands in the folder stays. Start the run anew with \
         engine run SCRIPT --force; the same seed leaves the same bytes.",
    ),
    (
        "E-CODE",
        Kind::Usage,
        "The word that was to be explained looks like a code, but no message of this engine has it.\n\
         Codes stand in brackets at the beginning of a message: error[E-SCRIPT-FACT]. Copy it from there.",
    ),
    (
        "E-COMBINES",
        Kind::Usage,
        "The command was given a script that combines learned policies, and what it was asked to do needs a \
         behaviour that learns or sees by itself.\n\
         Give the script of one of the policies, or leave out the option that is about learning.",
    ),
    (
        "E-COMPARE",
        Kind::Input,
        "engine compare holds runs against the first of them, so it needs two at least: folders of one seed or of many, such as \
         runs/wall/1-30 runs/mine/1-30.",
    ),
    (
        "E-DOOR",
        Kind::Fault,
        "A part of somebody's own that the library was given does not keep to its door: a robot measured something that is no \
         number, a learner chose an action that the robot does not have, a state map gave a state that it does not have, or \
         says of its states what cannot be.\n\
         The documentation of the door (Robot, Learner, Chooser, StateMap) says what it may give; a beam that meets nothing \
         measures the greatest range. Nothing that ships with the engine does this.",
    ),
    (
        "E-EXPORT",
        Kind::Input,
        "What was learned cannot be written as source code for other programs.\n\
         A behaviour that combines or uses policies has no table of its own; a filter may have no port, of those that ship `where`, \
         `floor` and `relief`, of others none; of more than 65,536 states the table would be too large.",
    ),
    (
        "E-FROM",
        Kind::State,
        "A run cannot go on from another one: its states, actions or way of learning are others, its seed is not there, or it \
         does not come out as it was recorded.\n\
         What was learned is about states and actions, so these must be the same; world, rules and body may be others.",
    ),
    (
        "E-IO",
        Kind::Disk,
        "A file or folder could not be read or written; the message has the system's reason.\n\
         Look at the path, its permissions and the room on the disk. Old files are unchanged: a new one \
         replaces them only when it is whole.",
    ),
    (
        "E-LOCKED",
        Kind::Disk,
        "Another process is writing to that folder or file; the message names it, its command and since when.\n\
         Two that write to one place would mix what they write. Wait until the other has ended, or write to another place, such \
         as --out runs/mine/1. A process that was killed holds nothing.",
    ),
    (
        "E-LOG-DIFFERS",
        Kind::State,
        "A recorded run was done again, and a step, a figure or a picture came out otherwise than it stands in the folder.\n\
         The same seed gives the same bytes with the same engine, filters and files, so one of them has \
         changed: run.toml names the engine that recorded it.\n\
         Build that version to see the old run, or run the behaviour again with this one.",
    ),
    (
        "E-LOG-FILE",
        Kind::State,
        "The log of a run, log.bin, is missing, cut or damaged, or of another format.\n\
         Each chunk of steps has a checksum, so nothing of a damaged log is believed. Copy the folder again, \
         or run the behaviour again.\n\
         A run of many seeds keeps a log for each: give the folder of one, such as runs/wall/1-30/7.",
    ),
    (
        "E-LOG-RUN",
        Kind::State,
        "Files of a run's folder do not belong together: log.bin, policy.toml or summary.json is of another run.\n\
         A log is useless without the settings and the seed that it was recorded with, and figures say nothing of another \
         table: summary.json holds the digest of what was learned. Keep the files of one run together. A table that you \
         have changed yourself can be tested in a folder of its own, with run.toml and policy.toml alone.",
    ),
    (
        "E-LOG-STEP",
        Kind::Usage,
        "A step was asked for that the log does not have, or none was named.\n\
         Steps are counted from 0, learning and test each on its own. engine replay RUN says how many there \
         are and when each rule fired.",
    ),
    (
        "E-OUT",
        Kind::Usage,
        "The folder for the pictures is the one that the photographs come from, and pictures could replace \
         them.\n\
         Name another folder with --out.",
    ),
    (
        "E-PICTURE",
        Kind::Disk,
        "A picture could not be drawn or encoded.\n\
         The results in numbers are not touched by this. The message says which part failed.",
    ),
    (
        "E-POLICY",
        Kind::Input,
        "A learned policy cannot be used: its file is missing or damaged, or it was learned with another \
         grid, other filters or other actions.\n\
         Policies are combined by their states and actions, so these must be the same. Learn the policy again \
         with what this script has.",
    ),
    (
        "E-POLICY-FILE",
        Kind::State,
        "A stored policy is damaged, of another format, or was learned with another grid, other filters or other \
         actions than this run has.\n\
         Run the behaviour again, or give the run that learned with what this script has.",
    ),
    (
        "E-RECORD",
        Kind::Disk,
        "The recording could not be written, or an image of it could not be encoded.\n\
         The run itself is not lost: its folder is written before the recording. Look at the room on the disk.",
    ),
    (
        "E-RECORD-BUILD",
        Kind::Usage,
        "This engine was built without recording for Foxglove and Rerun, which few need and which takes time to build.\n\
         Build it with: cargo build --release --features mcap.",
    ),
    (
        "E-RECORD-SEEDS",
        Kind::Usage,
        "A recording for Foxglove and Rerun is of one seed, and the command asks for several.\n\
         Leave out --seeds and choose the seed with --seed; each further recording is a run of its own.",
    ),
    (
        "E-RESCORE",
        Kind::State,
        "A recorded run cannot be judged by this script, because the script sees or does something else: \
         another world, camera, laser, filter, grid, action or rhythm.\n\
         The record holds what happened under the old ones. Change rules and learner only, or learn anew with \
         engine run.",
    ),
    (
        "E-ROW",
        Kind::Usage,
        "The table of the paper's claims has no row of this name. engine reproduce --quick lists them all.",
    ),
    (
        "E-RUN-FILE",
        Kind::State,
        "The folder is not that of a finished run of this engine: run.toml, policy.toml or summary.json is \
         missing, changed or of another format.\n\
         Give the folder that engine run has written, such as runs/wall/1. A changed copy of script or world \
         in it is refused, since the run would no longer be what it says.",
    ),
    (
        "E-RUN-TAG",
        Kind::Usage,
        "A tag of a run is a word or a few on one line, at most 60 characters. Write for example: engine runs tag runs/wall/1 best.",
    ),
    (
        "E-RUN-TAKEN",
        Kind::Disk,
        "The folder that --out names holds another run, which would be lost.\n\
         A run of the same script, settings and seed leaves the same files, and may be written again. Name another folder, \
         or say --force to replace what is there. Without --out, another run goes to the next number: runs/wall/1.2.",
    ),
    (
        "E-RUN-UNFINISHED",
        Kind::Disk,
        "A run into the same folder was killed, and has left a checkpoint: it would be lost.\n\
         Go on with it, bit for bit as if nothing had happened: engine run --resume runs/wall/1. Or start anew, with --force.",
    ),
    (
        "E-SIGNAL",
        Kind::Fault,
        "The system does not let the engine listen for Ctrl-C. Nothing is learned, so that a stop cannot lose \
         it.",
    ),
    (
        "E-THREADS",
        Kind::Fault,
        "The system does not give the engine the threads that it asked for. Use fewer with --threads.",
    ),
];
