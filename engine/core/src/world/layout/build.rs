//! From the checked tables of a world file to its parts.

use super::Layout;
use super::reader::{FileRow, read};
use super::schema::MOST_SOLIDS;
use crate::diagnostic::{Diagnostic, Mistakes, Result, SourceText, nearest_name, printable};
use crate::geometry::{Point2, Point3, Vector3};
use crate::world::route::{Route, rounded};
use crate::world::scene::{Light, Material, Scene, SceneParts, Shape, Solid, Texture};
use crate::world::terrain::Terrain;
use std::ops::Range;
use std::sync::Arc;

/// Thickness of paint on the floor, metres.
const PAINT_M: f64 = 0.001;
/// The material of everything that names none; every layout has it.
pub(in crate::world) const PLAIN: &str = "plain";

/// A world as its file says it, and where the file says it.
pub(super) struct Built {
    pub(super) layout: Layout,
    pub(super) file: FileRow,
    /// Where each solid of the scene was written.
    pub(super) origins: Vec<Origin>,
}

/// Reads a world and builds it; whether anything can stand at its starts is not looked at.
///
/// # Errors
/// Every mistake in the file's keys, values and names, as one error.
pub(super) fn build(source: SourceText) -> Result<Built> {
    let mut mistakes = Mistakes::new(&source);
    let file = match read(&source, &mut mistakes) {
        Ok(file) => file,
        Err(error) => return Err(mistakes.ended_by(*error)),
    };
    let mut builder = Builder::new(&source, &mut mistakes);
    builder.materials(&file);
    builder.solids(&file);
    let floor = builder.floor(&file);
    let light = builder.light(&file);
    let routes = builder.routes(&file);
    let movers = builder.movers(&file, &routes);
    let gates = builder.gates(&file);
    let (starts, places) = (builder.starts(&file, &gates), builder.places(&file));
    builder.has_start(&file);
    let Builder { materials, solids, carries, origins, .. } = builder;
    mistakes.end()?;
    let ways = movers.iter().filter_map(|mover| routes.get(mover.route));
    let scene =
        Scene::new(SceneParts { solids, materials, floor, light }).driven_over(ways.flat_map(|way| way.points()));
    let terrain = Terrain::new(&scene, carries);
    let lap = routes.iter().position(|route| route.name == "lap");
    let name = source.path.file_stem().map_or_else(|| "world".to_owned(), |stem| stem.to_string_lossy().into_owned());
    let layout = Layout {
        name,
        source: source.clone(),
        scene: Arc::new(scene),
        starts,
        places,
        gates,
        routes,
        lap,
        movers,
        terrain: Arc::new(terrain),
    };
    Ok(Built { layout, file, origins })
}

pub(super) fn yaw(row: &FileRow) -> f64 {
    row.number("yaw_deg").unwrap_or(0.0).to_radians()
}

pub(super) fn error(code: &'static str, message: impl Into<String>) -> Diagnostic {
    Diagnostic::new(code, message)
}

/// Where a solid was written.
pub(super) type Origin = (&'static str, Range<usize>);

pub(super) struct Builder<'a> {
    pub(super) source: &'a SourceText,
    pub(super) mistakes: &'a mut Mistakes,
    materials: Vec<Material>,
    solids: Vec<Solid>,
    carries: Vec<bool>,
    origins: Vec<Origin>,
}

/// Whether a name may be one that a mistake in its own table, or in the name of a section, has kept from being read.
pub(super) fn is_lost(file: &FileRow, section: &str, name: &str) -> bool {
    let may_be = |row: &FileRow| row.text("name").is_none_or(|known| known == name);
    file.misspelt || file.rows(section).iter().any(|row| !row.sound && may_be(row)) || file.lacks(section)
}

impl<'a> Builder<'a> {
    fn new(source: &'a SourceText, mistakes: &'a mut Mistakes) -> Self {
        let (materials, solids) = (Vec::new(), Vec::new());
        Self { source, mistakes, materials, solids, carries: Vec::new(), origins: Vec::new() }
    }

    fn materials(&mut self, file: &FileRow) {
        for row in file.sound_rows("material") {
            let name = row.text("name").unwrap_or_default().to_owned();
            if self.materials.iter().any(|material| material.name == name) {
                self.mistakes.add(self.twice("material", row));
                continue;
            }
            let colour = row.numbers("colour");
            let texture = row.rows("texture").first().map_or(Texture::Plain, |row| self.texture(row));
            self.materials.push(Material {
                name,
                colour: [0, 1, 2].map(|channel| colour[channel].round() as u8),
                texture,
                laser: row.flag("laser").unwrap_or(true),
            });
        }
        if !self.materials.iter().any(|material| material.name == PLAIN) {
            let (name, colour) = (PLAIN.to_owned(), [200; 3]);
            self.materials.push(Material { name, colour, texture: Texture::Plain, laser: true });
        }
    }

    pub(super) fn twice(&self, what: &str, row: &FileRow) -> Diagnostic {
        self.twice_named(what, row, row.text("name").unwrap_or_default())
    }

    pub(super) fn twice_named(&self, what: &str, row: &FileRow, name: &str) -> Diagnostic {
        error("E-WORLD-NAME", format!("there are two {what}s with the name '{}'", printable(name)))
            .at(self.source, row.span_of("name"), "used before")
            .help("give each its own name")
    }

    /// The material that a table names; 0 if there is none, which is then a mistake.
    pub(super) fn material(&mut self, file: &FileRow, row: &FileRow) -> usize {
        let name = row.text("material").unwrap_or(PLAIN);
        self.materials.iter().position(|material| material.name == name).unwrap_or_else(|| {
            if !is_lost(file, "material", name) && self.mistakes.wants(self.source, row.span_of("material").start) {
                let names = self.materials.iter().map(|material| material.name.as_str());
                self.mistakes.add(self.no_such("material", name, row, names));
            }
            0
        })
    }

    pub(super) fn no_such<'n>(
        &self,
        what: &str,
        name: &str,
        row: &FileRow,
        names: impl Iterator<Item = &'n str> + Clone,
    ) -> Diagnostic {
        let help = match nearest_name(name, names.clone()) {
            Some(near) => format!("did you mean \"{}\"?", printable(near)),
            None => format!("there are: {}", printable(&names.collect::<Vec<_>>().join(", "))),
        };
        error("E-WORLD-NAME", format!("there is no {what} named '{}'", printable(name)))
            .at(self.source, row.span_of(what), "not defined in this file")
            .help(help)
    }

    fn floor(&mut self, file: &FileRow) -> usize {
        match file.sound_rows("floor").next() {
            Some(row) => self.material(file, row),
            None => self.materials.iter().position(|material| material.name == PLAIN).unwrap_or(0),
        }
    }

    fn light(&mut self, file: &FileRow) -> Light {
        let row = file.sound_rows("light").next();
        let mut towards = Vector3::new(0.3, 0.5, 0.8);
        if let Some(row) = row
            && let [x, y, z] = *row.numbers("towards")
        {
            towards = Vector3::new(x, y, z);
            if towards.norm() < 1e-3 {
                let wrong = error("E-WORLD-VALUE", "'towards' must have a direction")
                    .at(self.source, row.span_of("towards"), "its length is 0")
                    .help("[0, 0, 1] is a light straight above");
                self.mistakes.add(wrong);
            }
        }
        let number = |key, default| row.and_then(|row| row.number(key)).unwrap_or(default);
        Light {
            towards: towards.normalize(),
            ambient: number("ambient", 0.4),
            gain: number("gain", 1.0),
            shadows: row.and_then(|row| row.flag("shadows")).unwrap_or(false),
            softness_deg: number("softness_deg", 0.0),
        }
    }

    fn solids(&mut self, file: &FileRow) {
        for section in ["wall", "box", "cylinder", "platform", "ramp", "paint"] {
            for row in file.sound_rows(section) {
                let added = self.solid(file, section, row);
                if self.mistakes.take(added).is_none() && self.solids.len() == MOST_SOLIDS {
                    return;
                }
            }
        }
    }

    fn solid(&mut self, file: &FileRow, section: &str, row: &FileRow) -> Result<()> {
        let number = |key: &str, default: f64| row.number(key).unwrap_or(default);
        let size = row.numbers("size_m");
        let half_m = |height| 0.5 * Vector3::new(size[0], size[1], height);
        let one = ["centre_m", "size_m"];
        match section {
            "wall" => self.line(file, "[[wall]]", row, number("thickness_m", 0.1), number("height_m", 1.0)),
            "box" => self.upright(file, "[[box]]", row, Shape::Box { half_m: half_m(size[2]) }),
            "cylinder" => {
                let (radius_m, half_height_m) = (number("radius_m", 0.1), 0.5 * number("height_m", 1.0));
                self.upright(file, "[[cylinder]]", row, Shape::Cylinder { radius_m, half_height_m })
            }
            "platform" if self.is_line("[[platform]]", row, &["points_m", "width_m", "height_m"], &one)? => {
                self.line(file, "[[platform]]", row, number("width_m", 1.0), number("height_m", 1.0))
            }
            "platform" => self.upright(file, "[[platform]]", row, Shape::Box { half_m: half_m(size[2]) }),
            "ramp" => self.upright(file, "[[ramp]]", row, Shape::Ramp { half_m: half_m(size[2]) }),
            _ if self.is_line("[[paint]]", row, &["points_m", "width_m"], &one)? => {
                self.line(file, "[[paint]]", row, number("width_m", 0.1), PAINT_M)
            }
            _ => self.upright(file, "[[paint]]", row, Shape::Box { half_m: half_m(PAINT_M) }),
        }
    }

    /// Whether a table describes a line or one solid; it must describe exactly one of them, and all of it.
    fn is_line(&self, section: &str, row: &FileRow, line: &[&str], solid: &[&str]) -> Result<bool> {
        let has = |key: &&&str| row.span_of(key) != row.span;
        let (line_keys, solid_keys) = (line.iter().filter(has).count(), solid.iter().filter(has).count());
        if (line_keys, solid_keys) == (line.len(), 0) || (line_keys, solid_keys) == (0, solid.len()) {
            return Ok(line_keys > 0);
        }
        error("E-WORLD-KEY", format!("{section} is neither a line nor one solid"))
            .at(self.source, row.span.clone(), "this one")
            .help(format!("a line has {}; one solid has {}", line.join(", "), solid.join(", ")))
            .fail()
    }

    /// A box on every segment of a line, half of its width longer at both ends so that corners are square.
    fn line(&mut self, file: &FileRow, section: &'static str, row: &FileRow, width: f64, height: f64) -> Result<()> {
        let points = row.points("points_m");
        let closed = row.flag("closed").unwrap_or(false);
        self.check_closed(points, closed)?;
        let bottom = row.number("bottom_m").unwrap_or(0.0);
        let ends = points.iter().skip(1).chain(points.first().filter(|_| closed));
        for ((from, _), (to, _)) in points.iter().zip(ends) {
            let (x, y) = (to[0] - from[0], to[1] - from[1]);
            let half_m = 0.5 * Vector3::new((x * x + y * y).sqrt() + width, width, height);
            let centre = Point3::new(0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1]), bottom + half_m.z);
            self.add(file, section, row, Shape::Box { half_m }, (centre, libm::atan2(y, x)))?;
        }
        Ok(())
    }

    fn check_closed(&self, points: &[([f64; 2], Range<usize>)], closed: bool) -> Result<()> {
        if let (Some((first, _)), Some((last, span))) = (points.first(), points.last())
            && closed
            && (points.len() < 3 || (first[0] - last[0]).abs().max((first[1] - last[1]).abs()) < 1e-6)
        {
            return error("E-WORLD-VALUE", "a closed line needs three points, the last not on the first")
                .at(self.source, span.clone(), "the last point")
                .help("leave the repeated point out: 'closed = true' joins the end to the beginning")
                .fail();
        }
        Ok(())
    }

    fn upright(&mut self, file: &FileRow, section: &'static str, row: &FileRow, shape: Shape) -> Result<()> {
        let place = row.numbers("centre_m");
        let z = row.number("bottom_m").unwrap_or(0.0) + shape.half_extents().z;
        self.add(file, section, row, shape, (Point3::new(place[0], place[1], z), yaw(row)))
    }

    fn add(
        &mut self,
        file: &FileRow,
        section: &'static str,
        row: &FileRow,
        shape: Shape,
        (centre, yaw_rad): (Point3, f64),
    ) -> Result<()> {
        if self.solids.len() == MOST_SOLIDS {
            return error("E-WORLD-VALUE", format!("a world has at most {MOST_SOLIDS} solids"))
                .at(self.source, row.span.clone(), "one too many")
                .help("a line counts once for every segment")
                .fail();
        }
        let material = self.material(file, row);
        self.solids.push(Solid { shape, centre, yaw_rad, material, collides: section != "[[paint]]" });
        self.carries.push(section == "[[platform]]" || section == "[[ramp]]");
        self.origins.push((section, row.span.clone()));
        Ok(())
    }

    fn routes(&mut self, file: &FileRow) -> Vec<Route> {
        let mut routes: Vec<Route> = Vec::new();
        for row in file.sound_rows("route") {
            let route = self.route(row, &routes);
            routes.extend(self.mistakes.take(route));
        }
        routes
    }

    fn route(&self, row: &FileRow, before: &[Route]) -> Result<Route> {
        let name = row.text("name").unwrap_or_default();
        if before.iter().any(|route| route.name == name) {
            return self.twice("route", row).fail();
        }
        let closed = row.flag("closed").unwrap_or(false);
        if name == "lap" && !closed {
            return error("E-WORLD-VALUE", "the route 'lap' must be closed: laps are measured on it")
                .at(self.source, row.span_of("closed"), "an open route")
                .help("write 'closed = true', or give the route another name")
                .fail();
        }
        let written = row.points("points_m");
        self.check_closed(written, closed)?;
        let points: Vec<Point2> = written.iter().map(|([x, y], _)| Point2::new(*x, *y)).collect();
        let radius = row.number("corner_radius_m").unwrap_or(0.0);
        let points = rounded(&points, closed, radius).map_err(|(corner, greatest)| {
            error(
                "E-WORLD-VALUE",
                format!("a corner radius of {radius} m does not fit the route '{}'", printable(name)),
            )
            .at(self.source, written[corner].1.clone(), "at this corner")
            .help(format!("there is room for {:.3} m", (greatest * 1000.0).floor() / 1000.0))
        })?;
        let mut route = Route::new(name, points, closed);
        route.half_width_m = row.number("half_width_m").unwrap_or(route.half_width_m);
        Ok(route)
    }

    fn has_start(&mut self, file: &FileRow) {
        if !file.rows("start").is_empty() || file.misspelt || file.lacks("start") {
            return;
        }
        let end = self.source.text.len();
        let wrong = error("E-WORLD-START", "the world has no start")
            .at(self.source, end..end, "the file ends here")
            .help("add a table [[start]] with 'position_m = [x, y]' and 'yaw_deg = 0'");
        self.mistakes.add(wrong);
    }
}
