//! Pages of what can be wrong in a script or a setting.

use super::Kind;

/// Each code with its page, in the order of the alphabet.
pub(super) const PAGES: &[(&str, Kind, &str)] = &[
    (
        "E-GRID",
        Kind::Input,
        "The grid would have more states than a table can hold, or cells without a single pixel.\n\
         Each cell doubles the number of states: 3x3 cells make 64 with the column rule, 512 without. Use \
         fewer rows or columns.",
    ),
    (
        "E-MIRROR",
        Kind::Input,
        "The script asks to learn left for right, but one of its actions has no counterpart that turns the \
         other way.\n\
         Add the action with the opposite turning speed, or leave 'mirror' out.",
    ),
    (
        "E-REWARD-FACTS",
        Kind::State,
        "A script was asked to judge facts that do not suit it: before its calibration, or of another laser.\n\
         This is a mistake in a program that uses the engine as a library, not in the script.",
    ),
    (
        "E-REWARD-VALUE",
        Kind::Input,
        "A rule or fn reward gave something that is no finite number: the learned values would be spoilt for \
         ever.\n\
         Look for a division by zero, a root or logarithm of a negative number, or a map without 'value'.",
    ),
    (
        "E-SCRIPT-EMPTY",
        Kind::Input,
        "The script has neither a rule nor fn reward: every step would be worth nothing.\n\
         Write a rule, for example: rule \"too close\" when laser.nearest < 0.25 => -1 then recover;",
    ),
    (
        "E-SCRIPT-FACT",
        Kind::Input,
        "The script reads a fact, a beam or a grid cell that does not exist.\n\
         Facts are named in scripts/README.md; beams are counted from 0 on the right, cells from 0 at the top \
         left.",
    ),
    ("E-SCRIPT-FILE", Kind::Input, "The script cannot be read from this path. Check the name; scripts end in .rhai."),
    (
        "E-SCRIPT-GUARD",
        Kind::Input,
        "A guard says something that it cannot: forbid \"ahead\" when laser.front < 0.4 => action.linear > 0.0;\n\
         Before => stands a condition over facts; behind it what no action may be, said of action.linear, \
         action.angular and numbers alone. It must be true of some of the actions, and not of all.",
    ),
    (
        "E-SCRIPT-LIMIT",
        Kind::Limit,
        "The script used more than it may: operations, memory, depth or text.\n\
         A judgement takes a handful of operations; look for a loop that does not end or that grows \
         something.",
    ),
    (
        "E-SCRIPT-MEMORY",
        Kind::Input,
        "A function changes a variable that stands outside of it, or writes to 'this'. Such a variable is the same in every step: \
         variables remember nothing, so that each step can be judged again by itself.\n\
         What must outlast a step is said by a time (for 6 seconds), by fired(\"rule\") and since(\"rule\"), by change(x, 10) and \
         average(x, 2), by a measure with a name, or by stages. What is needed within one step only, define in the function with \
         'let'.",
    ),
    (
        "E-SCRIPT-NAME",
        Kind::Input,
        "The script uses a name or a function that is not there, or with the wrong kind of value.\n\
         The message has the nearest name that is; all of them are in scripts/README.md.",
    ),
    (
        "E-SCRIPT-PLACE",
        Kind::Input,
        "The script names a place that the world does not have, behind 'to', in recovery(...) or in starts([...]); or it lists \
         starts at which no attempt begins.\n\
         A place is the name of a [[start]] of the world file, or one of \"nearest\", \"random\", \"start\", \"behind\".",
    ),
    (
        "E-SCRIPT-REWARD",
        Kind::Input,
        "fn reward or fn calibrate is not as it must be: each takes one argument, the facts; calibrate \
         returns what the rules need.\n\
         Write fn reward(facts) { ... } and return a number, or #{ value: -1, recover: true }.",
    ),
    (
        "E-SCRIPT-RULE",
        Kind::Input,
        "A rule is not complete, can never fire, or says something that cannot be.\n\
         The form is: rule \"name\" when CONDITION for 5 seconds => VALUE then recover; where the time and \
         the recovery may be left out.",
    ),
    (
        "E-SCRIPT-RUN",
        Kind::Input,
        "The script failed while it judged a step: an array without that number, a map without that key, a \
         division.\n\
         What it reads depends on what is measured, so this came up only now. The message names the step.",
    ),
    (
        "E-SCRIPT-SETTING",
        Kind::Input,
        "A set-up call has a key or a value that does not exist, is given twice, or stands where nothing can \
         be set up any more.\n\
         Set-up calls stand at the top of the script; their keys, units and ranges are in scripts/README.md.",
    ),
    (
        "E-SCRIPT-SOURCE",
        Kind::Input,
        "The file is not the text of a script: it is too long, not UTF-8, or another kind of file.\n\
         A script is a short text file that ends in .rhai.",
    ),
    (
        "E-SCRIPT-STAGE",
        Kind::Input,
        "A rule names a stage that the script does not have.\n\
         The stages are named once, at the top: stages([\"search\", \"approach\"]); the robot begins with the first, and is in the \
         first again after every recovery. Rules enter another with then stage \"approach\", and are judged in some only with \
         in \"search\".",
    ),
    (
        "E-SCRIPT-SUCCESS",
        Kind::Input,
        "A condition of success cannot be understood, or asks for a figure that the world does not have.\n\
         It compares figures of the frozen policy's test: success \"drives round\" when test.laps >= 5; figures of a robot \
         that knows nothing stand behind untrained. What a step measures, such as laser.front, is not known there. \
         scripts/README.md lists every figure; laps and other figures of the route need a [[route]] named \"lap\" in the \
         world file.",
    ),
    (
        "E-SCRIPT-SYNTAX",
        Kind::Input,
        "The script cannot be read as a program: something is missing, or stands where it has no meaning.\n\
         The caret shows where the reader gave up; the cause is there or just before, often a bracket or a \
         ';'.",
    ),
    (
        "E-SCRIPT-TRUTH",
        Kind::Input,
        "The script asks for what only the simulator knows: where the robot is, how far along its route, where its goal lies.\n\
         A robot does not have that, and a reward that reads it cannot be learned on one. Scripts see what the robot measures \
         (scripts/README.md, Facts); laps and places are judged by the test: success \"drives round\" when test.laps > 3;",
    ),
    (
        "E-SCRIPT-TYPE",
        Kind::Input,
        "A truth value stands where a number belongs, or a number where something true or false belongs.\n\
         Facts such as robot.contact are true or false already: write robot.contact, not robot.contact == 1, which is never \
         true. Two limits are two comparisons: 0.3 < laser.front && laser.front < 0.6.\n\
         Constants that come to no number (NaN), or that lose a fraction in a division of whole numbers, are told too.",
    ),
    (
        "E-SCRIPT-USE",
        Kind::Input,
        "A use says something that it cannot: use \"dock\" in \"approach\" when blue.size > 0.1;\n\
         The name is that of a policy(...) of the script; then come stages after 'in', a condition after 'when', or both. Without \
         either the policy always drives, and nothing below it is asked. The condition is true or false and reads facts, measures, \
         numbers and the functions of the table.",
    ),
    (
        "E-SCRIPT-VIEW",
        Kind::Input,
        "A view has a name that cannot be one, or a view is named that the script does not have.\n\
         The name is a word in small letters, in quotes: view(\"red\", filter(\"colour\")). Its facts are then red.seen, \
         red.bearing_deg and so on; a bare filter or grid makes the view without a name, whose facts are camera.seen and so on.",
    ),
    (
        "E-SCRIPT-WINDOW",
        Kind::Input,
        "Something cannot be remembered from step to step as it is written.\n\
         change, average, fired and since stand in rules and measures, over facts, numbers and the functions of the table; in a \
         function they have no memory. Name what you need outside of it: measure progress = change(odometry.forward_m, 10); and \
         read facts.progress in the function.",
    ),
    (
        "E-SCRIPT-WORD",
        Kind::Input,
        "A word of another language stands where it means nothing: 'and' is written &&, 'or' ||, 'not' !; numbers have no units, \
         0.25 is metres; how an attempt ends stands at the end of a rule, after 'then'.",
    ),
    (
        "E-SET",
        Kind::Usage,
        "A --set on the command line names no setting, or one that the learner does not read, or gives it a value that it cannot have.\n\
         Write --set GROUP.KEY=VALUE, such as --set camera.tilt_deg=40; a parameter of the script by its name alone, --set near=0.3.",
    ),
];
