//! Settings that are one of a few words: each an enum, so that a word that is added must be dealt with everywhere.

/// An enum of words with their spelling in scripts and files.
macro_rules! words {
    ($(#[$about:meta])* $name:ident: $($(#[$word_about:meta])* $word:ident = $text:literal),+ $(,)?) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum $name {
            $($(#[$word_about])* $word),+
        }

        impl $name {
            /// Every word, in the order of the variants, as scripts and files spell it.
            pub(crate) const WORDS: &[&str] = &[$($text),+];
            /// Every variant, in the same order.
            pub const ALL: &[Self] = &[$(Self::$word),+];

            /// Its spelling in scripts and files.
            #[must_use]
            pub const fn word(self) -> &'static str {
                match self {
                    $(Self::$word => $text),+
                }
            }

            /// The variant of a spelling.
            #[must_use]
            pub fn of(word: &str) -> Option<Self> {
                match word {
                    $($text => Some(Self::$word),)+
                    _ => None,
                }
            }
        }
    };
}

words! {
    /// How the camera projects.
    Lens:
    /// Straight lines stay straight.
    Pinhole = "pinhole",
    /// Equidistant: the angle from the axis grows with the distance from the centre.
    Fisheye = "fisheye",
}

words! {
    /// The way of learning.
    LearnerKind:
    /// TTD(lambda) Q-learning as the paper prints it.
    Ttd = "ttd",
    /// Truncated temporal differences as Cichosz describes them.
    TtdCichosz = "ttd-cichosz",
    /// One-step Q-learning.
    Q = "q",
    /// Sarsa(lambda) with replacing traces.
    SarsaLambda = "sarsa-lambda",
    /// The steps are remembered, and valued by what followed them.
    Memory = "memory",
}

words! {
    /// Where recovery puts the robot.
    RecoverTo:
    /// On the lap route, at its point nearest to the robot.
    Nearest = "nearest",
    /// On the lap route, anywhere.
    Random = "random",
    /// At one of the world's starts.
    Start = "start",
    /// Behind the first mover.
    Behind = "behind",
}

words! {
    /// How several policies become one.
    CombineWay:
    /// The first policy that cares decides.
    Priority = "priority",
    /// The values are added up.
    Sum = "sum",
}
