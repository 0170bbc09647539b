//! Pages of what can be wrong in a world, and of what the robot meets there.

use super::Kind;

/// Each code with its page, in the order of the alphabet.
pub(super) const PAGES: &[(&str, Kind, &str)] = &[
    (
        "E-CAMERA-BLANK",
        Kind::Fault,
        "The camera shows one single colour: nothing in the image differs from anything else.\n\
         A robot that sees nothing would learn nothing, and its curve would not say why.\n\
         Check camera.tilt_deg and camera.height_m, and that the world has walls, obstacles or a textured \
         floor in view.",
    ),
    (
        "E-CAMERA-FROZEN",
        Kind::Fault,
        "The robot moves, but its camera keeps showing the same image.\n\
         Either the robot is inside a solid, or every place of the world looks alike: no state could tell \
         them apart.\n\
         Move the start into the open, or give the floor and the walls something to see.",
    ),
    (
        "E-RECOVERY-BLOCKED",
        Kind::Input,
        "The robot is to be put back, but every place that it may be put to touches something or has no \
         ground.\n\
         Move the starts or the route of the world away from walls, boxes and edges; for \
         recovery(\"behind\"), give the mover a longer route.",
    ),
    (
        "E-RECOVERY-MOVER",
        Kind::Input,
        "The script puts the robot back behind a mover, and the world has none.\n\
         Add a [[mover]] with its [[route]] to the world, or choose another recovery, such as \
         recovery(\"start\").",
    ),
    (
        "E-RECOVERY-ROUTE",
        Kind::Input,
        "The script puts the robot back onto the route, and the world has no route called lap.\n\
         Add a closed [[route]] with name = \"lap\", or write recovery(\"start\").",
    ),
    (
        "E-ROBOT-FILE",
        Kind::Input,
        "The script names a robot whose body file is not there, or cannot be read.\n\
         A body is named without its ending: robots/NAME.toml beside the script, or one of those that ship. \
         robots/README.md lists them.",
    ),
    (
        "E-ROBOT-KEY",
        Kind::Input,
        "A table of the body file has a key that does not exist there, or lacks one that it needs.\n\
         robots/README.md lists the keys of every table.",
    ),
    (
        "E-ROBOT-SYNTAX",
        Kind::Input,
        "The body file is not written in TOML, so that nothing in it can be understood.\n\
         Values stand after '=', text in quotes, lists in [ ]. robots/README.md has a whole file to copy.",
    ),
    (
        "E-ROBOT-VALUE",
        Kind::Input,
        "A value of the body file is not what its key may hold, or an action is more than the drive can do.\n\
         robots/README.md lists what each key may hold; a bicycle turns only while it drives.",
    ),
    (
        "E-WORLD-FILE",
        Kind::Input,
        "The world is not there, or its file cannot be read.\n\
         A world is named without its ending and looked for in the folder worlds, or given as the path of a \
         .toml file.",
    ),
    (
        "E-WORLD-KEY",
        Kind::Input,
        "A table of the world file has a key that does not exist there, or lacks one that it needs.\n\
         worlds/README.md lists the keys of every table.",
    ),
    (
        "E-WORLD-NAME",
        Kind::Input,
        "Something in the world file is called by a name that nothing has, or that two things have.",
    ),
    (
        "E-WORLD-SHADOWS",
        Kind::Input,
        "Shadows are computed for every lit face of a world, and this world has too many solids for that, or solids so large that\n\
         each shades all the others. The work is counted: the answer is the same on every machine.\n\
         Join solids, take some out, or leave light.shadows off.",
    ),
    (
        "E-WORLD-START",
        Kind::Input,
        "The world has no place for the robot to start, or the robot would touch something or fall there.\n\
         Add a [[start]] with position_m and yaw_deg, or move it into the open: the robot is about half a \
         metre long.",
    ),
    (
        "E-WORLD-SYNTAX",
        Kind::Input,
        "The world file is not TOML. Values stand after '=', text in quotes, lists in [ ].",
    ),
    (
        "E-WORLD-VALUE",
        Kind::Input,
        "A number in the world file is outside of what can be built or simulated.\n\
         Lengths are in metres and angles in degrees: a room of 600 is usually one of 6, written in \
         centimetres.",
    ),
    (
        "E-WORLD-WORK",
        Kind::Input,
        "One image and one scan of this world would take too long: the faces in sight cover too many rows of the image, one behind\n\
         the other, or too many beams meet solids. The work is counted, not timed, so that a world is refused on every machine or\n\
         on none. It is looked for at the starts before anybody learns, and in every step.\n\
         Take out solids that stand within one another or are hidden behind others; a smaller image takes less, too.",
    ),
];
