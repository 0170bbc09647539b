//! Everything that a reward may read: measurements of one step, never the truth.

/// The measurements that rules and `fn reward(facts)` read, refilled in every step.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Facts {
    /// Laser ranges, metres, beam 0 rightmost.
    pub ranges_m: Vec<f32>,
    /// Share of foreground pixels of the filtered image for each grid cell, row by row from the top left, 0 to 1.
    pub cells: Vec<f32>,
    /// Rows and columns of the grid.
    pub grid: (usize, usize),
    /// Whether any cell of the grid is occupied.
    pub seen: bool,
    /// Share of foreground pixels of the whole filtered image, 0 to 1.
    pub coverage: f64,
    /// The state that the grid was coded into.
    pub state: usize,
    /// Index of the action that was carried out.
    pub action: usize,
    /// Commanded forward speed, m/s.
    pub action_linear: f64,
    /// Commanded turning speed, rad/s, anticlockwise positive.
    pub action_angular: f64,
    /// Whether the body touched something.
    pub contact: bool,
    /// Whether the robot fell off an edge.
    pub fallen: bool,
    /// Measured forward speed, m/s.
    pub linear: f64,
    /// Measured turning speed, rad/s.
    pub angular: f64,
    /// Steps since learning or the test began.
    pub step: u64,
    /// Steps since the last recovery or the start.
    pub since_recovery: u64,
}
