//! What the robot measures in one step, and nothing else.

use super::GroundColours;
use crate::geometry::Twist;
use filter_api::{FilterError, Format, Frame};

/// A camera image that owns its pixels: row-major, top row first.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    /// Pixels in a row.
    pub width_px: usize,
    /// Rows.
    pub height_px: usize,
    /// What one pixel holds: colour, or brightness alone where nothing else is looked at.
    pub format: Format,
    /// `width_px * height_px * format.channels()` bytes.
    pub pixels: Vec<u8>,
}

impl Image {
    /// A black colour image.
    #[must_use]
    pub fn new(width_px: usize, height_px: usize) -> Self {
        Self::of(Format::Rgb, width_px, height_px)
    }

    /// A black image of a format. A camera that fills it gives colour, or the luma of that very colour
    /// ([`Frame::write_luma`]).
    #[must_use]
    pub fn of(format: Format, width_px: usize, height_px: usize) -> Self {
        Self { width_px, height_px, format, pixels: vec![0; width_px * height_px * format.channels()] }
    }

    /// The image as filters read it.
    ///
    /// # Errors
    /// If the pixels do not fit the size.
    pub fn frame(&self) -> Result<Frame<'_>, FilterError> {
        Frame::new(self.width_px, self.height_px, self.format, &self.pixels)
    }
}

/// One sweep of the laser: a range for each beam, beam 0 rightmost, anticlockwise; [`ScanFan`](crate::settings::ScanFan) says
/// where each looks.
///
/// ```text
///            beam 90 (front)
///                 |
///   beam 180 -----+----- beam 0     seen from above, 181 beams over 180 degrees
///    (left)     robot     (right)
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Scan {
    /// Metres, each within the laser's minimum and maximum range; nothing seen is the maximum. Never NaN.
    pub ranges_m: Vec<f32>,
}

/// All that one step measures.
#[derive(Debug, Clone, PartialEq)]
pub struct Observation {
    /// The camera's image; of no pixels where nobody asks for colours or brightness, or for any image at all.
    pub image: Image,
    /// The depth image of the same moment ([`Format::Depth`]); nothing where nobody asks for one.
    pub depth: Option<Image>,
    /// The laser's scan.
    pub scan: Scan,
    /// The bumper: the body touched something during the last step.
    pub contact: bool,
    /// The robot has lost its footing (tilt switch).
    pub fallen: bool,
    /// Speeds from the wheel encoders.
    pub odometry: Twist,
    /// The colours of the ground under the robot; nothing where nobody asks for them.
    pub ground: Option<GroundColours>,
}

impl Observation {
    /// An empty observation that asks for an image of a format and a size, and for so many beams.
    #[must_use]
    pub fn asking_for(format: Format, width_px: usize, height_px: usize, beams: usize) -> Self {
        Self {
            image: Image::of(format, width_px, height_px),
            depth: None,
            scan: Scan { ranges_m: vec![0.0; beams] },
            contact: false,
            fallen: false,
            odometry: Twist::default(),
            ground: None,
        }
    }

    /// From now on asks for the images that another observation asks for.
    pub(crate) fn ask_anew(&mut self, other: &Self) {
        self.image.clone_from(&other.image);
        self.depth.clone_from(&other.depth);
    }

    /// Asks for depth too, or for depth alone.
    #[must_use]
    pub fn with_depth(mut self, alone: bool) -> Self {
        let Image { width_px, height_px, format, .. } = self.image;
        self.depth = Some(Image::of(Format::Depth, width_px, height_px));
        if alone {
            self.image = Image::of(format, 0, 0);
        }
        self
    }

    /// The image for who reads this format.
    #[must_use]
    pub fn read_as(&self, format: Format) -> &Image {
        match &self.depth {
            Some(depth) if format == Format::Depth => depth,
            _ => &self.image,
        }
    }

    /// The image of what there is to see: in colour or grey if somebody asks for that, else the depth image.
    #[must_use]
    pub fn sight(&self) -> &Image {
        match &self.depth {
            Some(depth) if self.image.pixels.is_empty() => depth,
            _ => &self.image,
        }
    }
}
