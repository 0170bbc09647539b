//! What a filter is told besides its frames: where the camera is, and how the robot moved.

/// How the camera is mounted, and its lens; the same for all of a filter's life.
///
/// A point of the image `x` pixels right of its middle and `y` below it looks along `ahead + (x / focal_px) right + (y / focal_px)
/// down`. On flat ground its nearness, one over the distance ahead of the lens, is therefore `(tilt_sin + (y / focal_px)
/// tilt_cos) / height_m`, where that is positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mount {
    /// The focal length of a pinhole, pixels; of a fisheye, pixels for each radian.
    pub focal_px: f64,
    /// Whether the lens is an equidistant fisheye.
    pub fisheye: bool,
    /// The camera's place ahead of the robot's centre, metres.
    pub forward_m: f64,
    /// Its height above the ground, metres; positive.
    pub height_m: f64,
    /// The sine of the angle by which it looks down.
    pub tilt_sin: f64,
    /// The cosine of that angle.
    pub tilt_cos: f64,
}

/// How the robot moved since the last frame, as its wheels say.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Moved {
    /// How far it drove, metres; backwards counts as forwards.
    pub driven_m: f64,
    /// How far it turned, radians, positive to the left.
    pub turned_rad: f64,
    /// It was put elsewhere; then the other two are 0. So it is with the first frame of all.
    pub jumped: bool,
}
