//! Pages of what `engine check` finds.

use super::Kind;

/// Each code with its page, in the order of the alphabet.
pub(super) const PAGES: &[(&str, Kind, &str)] = &[
    (
        "W-COST",
        Kind::Input,
        "A rule or `fn reward` takes a tenth or more of the operations that all rules of a step may take together.\n\
         Every loop counts, and an array or a map that is read or compared counts by its length.\n\
         Every step of learning is slow then, and a script that takes all of them is stopped. Do less in the loop, read arrays\n\
         outside of it, or measure with the facts: laser.sector(0, 90).nearest is worth some hundred operations.",
    ),
    (
        "W-EXPLOIT",
        Kind::Input,
        "A behaviour that gets nowhere earns more than driving on: spinning in place, standing, U-turns. The learner will find it.\n\
      Each line of the table was driven in the simulator. Reward progress, or punish what the robot does instead of it.\n\
      \"Easier\": a robot that never failed would earn more, but nothing that was learned in a few thousand steps does. Where the \
      state cannot tell what to do, look at camera, filter and grid before you change the reward.",
    ),
    (
        "W-FILTER-BLIND",
        Kind::Input,
        "The filters leave no pixel of what the robot sees all round from its starts and along its route; something came into sight \
         only while it drove about.\n\
         Until then every state is the empty one, and all that can be learned is to search. If that is not meant, lower the \
         filter's threshold, look at the colour it searches for, tilt the camera, or add a start from which it sees something.",
    ),
    (
        "W-GOAL-CONTACT",
        Kind::Input,
        "A rule ends the attempt with something good when the body touches something or falls, or most goals of the trial came \
         with a contact.\n\
         Rewards from elsewhere often pay a little for leaving the track; with 'then recover' that makes a goal of every crash. \
         If a crash is no goal, write 'then fail'.",
    ),
    (
        "W-GUARD-NEVER",
        Kind::Input,
        "What a guard asks for never held in some thousand steps, driven at random and by what was learned so far.\n\
         A guard that never holds forbids nothing. The label says what its facts were; accidents (contact, a fall) and time limits \
         may be rare and are not reported. Check the threshold, and that the world has what the guard is about.",
    ),
    (
        "W-LOOK-ALIKE",
        Kind::Input,
        "Something that the robot must see looks like the floor to the filter.\n\
         Told of `floor` with a memory where a face has a grey of the floor in the world's light, and of `chroma` where it has its \
         colour. Another light or colour helps, or a depth camera with `relief`.",
    ),
    (
        "W-LOOP",
        Kind::Input,
        "A function goes over the beams of the laser one by one, in every step.\n\
      The interpreter needs some 20 microseconds for that, as much as all the rest of a step; the engine's own call needs less than one.\n\
      Use facts.laser.sector(from, to) with .nearest, .farthest, .mean, .count_below(limit) or .excess(expected).",
    ),
    (
        "W-MOUNT",
        Kind::Input,
        "The camera or the laser stands inside the body and looks out through its walls, or stands so far outside of it that it \
         passes through walls before the body touches them, or the camera looks at the body and the image does not show it.\n\
         No such robot can be built. Mounts are measured from the point that the robot turns about; robots/README.md has outlines.",
    ),
    (
        "W-NO-CHOICE",
        Kind::Input,
        "The reward is the same whatever the robot does, so there is nothing to learn.\n\
      It reads nothing that actions lead to, or every step of the trial was rewarded alike, or all actions are the same.\n\
      Let a rule read the laser, the camera, the robot or the action.",
    ),
    (
        "W-PERSISTENCE",
        Kind::Input,
        "A rule waits for so long that it never comes to fire, or that a robot which spins in place escapes it.\n\
      Each turn interrupts the condition, and the time begins again: whoever spins is never punished.\n\
      Make the time after 'for' shorter than the message says.",
    ),
    (
        "W-RULE-ALWAYS",
        Kind::Input,
        "A rule fired in every step in which it was asked: it adds the same number each time, or never lets the robot drive.\n\
      A learner compares actions; what all of them earn teaches nothing. Tighten the condition, or let the value depend on a fact.",
    ),
    (
        "W-RULE-NEVER",
        Kind::Input,
        "A rule never fired in some thousand steps, driven at random, while learning and while trying to cheat.\n\
      The label says what its facts were. Goals, time limits and accidents (contact, a fall) may be rare and are not reported.\n\
      Check the threshold, and that the world has what the rule is about.",
    ),
    (
        "W-RULE-SHADOWED",
        Kind::Input,
        "Whenever this rule could fire, an earlier rule recovers first, and the later one is not asked.\n\
      Rules are asked from the top. Put the narrower condition first, or make the two exclude each other.",
    ),
    (
        "W-SCALE",
        Kind::Input,
        "A reward does not suit the softmax of a learner with a table; its temperature begins at 0.07 and ends at 0.009.\n\
      After one very large punishment an action is never tried again; a very small one cannot be told from nothing.\n\
      Keep rewards between -1 and 1, or change learner.temperature and learner.temperature_end with them. The learner\n\
      memory takes rewards of any size.",
    ),
    (
        "W-STAGE-DEAD",
        Kind::Input,
        "A stage is named and no rule enters it, so the robot is never about it and its rules are never judged.\n\
         The first stage is entered by itself; every other needs a rule that leads there: then stage \"dock\".",
    ),
    (
        "W-STAGE-END",
        Kind::Input,
        "No rule leaves a stage, and no rule ends it with a goal: once there, the robot stays in it until it fails.\n\
         Let a rule lead on, with then stage and a name, or end the attempt with then goal.",
    ),
    (
        "W-START-NEVER",
        Kind::Input,
        "A script widens its starts, and while three robots learned for as long as it says, one start never came into use.\n\
         What lies there is not learned, but tested. Put a start between it and the one before, ask for a lesser share, or learn \
         for longer.",
    ),
    (
        "W-STATE-LARGE",
        Kind::Input,
        "A state of several parts has more than 4096 values, and a table has a row for each.\n\
         Most of them are met once or never, and nothing is learned of them. Let the learner memory pool them, take a part \
         out, make a grid smaller, or tell a value apart by fewer ranges.",
    ),
    (
        "W-SUCCESS-IDLE",
        Kind::Input,
        "A robot that knows nothing, or one that does not look, meets every condition of success, the script's own or the default.\n\
         Such a success says nothing. Name what the robot must do: laps, goals, or so many times the metres for each failure \
         that an untrained robot makes.",
    ),
    (
        "W-UNIT",
        Kind::Input,
        "A fact is compared with a number that it never comes near: most often centimetres for metres or degrees for radians.\n\
      Ranges are in metres, speeds in m/s, turns in rad/s, shares from 0 to 1. The label says what this robot can give.",
    ),
    (
        "W-UNSEEN",
        Kind::Input,
        "A rule's value reads where something lies, and its condition does not ask whether it is seen.\n\
         What is not seen reads as the farthest value: a bearing of 180, an offset of 2, a distance of 100; such a step would \
         count for hundreds of others. Ask for view.seen, or bound the value with min or max.",
    ),
    (
        "W-UNUSED",
        Kind::Input,
        "Something is set, defined or written and has no effect with this script and this world.\n\
      Often a name is misspelt elsewhere, or a setting belongs to another way of learning. Use it or take it out.",
    ),
    (
        "W-VALUE-CONSTANT",
        Kind::Input,
        "A value that reads what is measured was the same in every step that was tried.\n\
         It teaches nothing. Often a min and a max are exchanged, or a limit is never passed; if the value is meant to be fixed, \
         write it as a number.",
    ),
];
