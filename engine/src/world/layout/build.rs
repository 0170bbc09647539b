//! From the checked tables of a world file to its parts.

use super::reader::{Row, read};
use super::schema::MOST_SOLIDS;
use super::{Layout, Obstruction};
use crate::diagnostic::{Diagnostic, Kind, Result, SourceText, nearest_name, printable};
use crate::geometry::{Point2, Point3, Pose, Vector3};
use crate::world::footprint::Obstacle;
use crate::world::mover::Mover;
use crate::world::route::{Route, rounded};
use crate::world::scene::{Light, Material, Scene, SceneParts, Shape, Solid, Texture};
use crate::world::terrain::Terrain;
use std::ops::Range;
use std::sync::Arc;

/// Thickness of paint on the floor, metres.
const PAINT_M: f64 = 0.001;
/// The material of everything that names none.
const PLAIN: &str = "plain";

pub(super) fn layout(source: SourceText) -> Result<Layout> {
    let file = read(&source)?;
    let mut builder = Builder::new(&source);
    builder.materials(&file)?;
    builder.solids(&file)?;
    let floor = builder.floor(&file)?;
    let light = builder.light(&file)?;
    let (routes, movers) = (builder.routes(&file)?, file.rows("mover"));
    let movers = builder.movers(movers, &routes)?;
    let scene = Scene::new(SceneParts { solids: builder.solids, materials: builder.materials, floor, light });
    let terrain = Terrain::new(&scene, builder.carries);
    let starts = file.rows("start").iter().map(pose).collect();
    let lap = routes.iter().position(|route| route.name == "lap");
    let name = source.path.file_stem().map_or_else(|| "world".to_owned(), |stem| stem.to_string_lossy().into_owned());
    let layout = Layout {
        name,
        source: source.clone(),
        scene: Arc::new(scene),
        starts,
        routes,
        lap,
        movers,
        terrain: Arc::new(terrain),
    };
    check_starts(&layout, &file, &builder.origins)?;
    Ok(layout)
}

fn pose(row: &Row) -> Pose {
    let place = row.numbers("position_m");
    Pose::new(place[0], place[1], yaw(row))
}

fn yaw(row: &Row) -> f64 {
    row.number("yaw_deg").unwrap_or(0.0).to_radians()
}

fn error(code: &'static str, message: impl Into<String>) -> Diagnostic {
    Diagnostic::new(Kind::Input, code, message)
}

/// Where a solid was written.
type Origin = (&'static str, Range<usize>);

struct Builder<'a> {
    source: &'a SourceText,
    materials: Vec<Material>,
    solids: Vec<Solid>,
    carries: Vec<bool>,
    origins: Vec<Origin>,
}

impl<'a> Builder<'a> {
    fn new(source: &'a SourceText) -> Self {
        Self { source, materials: Vec::new(), solids: Vec::new(), carries: Vec::new(), origins: Vec::new() }
    }

    fn materials(&mut self, file: &Row) -> Result<()> {
        for row in file.rows("material") {
            let name = row.text("name").unwrap_or_default().to_owned();
            if self.materials.iter().any(|material| material.name == name) {
                return self.twice("material", row).into();
            }
            let colour = row.numbers("colour");
            let texture = row.rows("texture").first().map_or(Texture::Plain, texture);
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
        Ok(())
    }

    fn twice(&self, what: &str, row: &Row) -> Diagnostic {
        let name = printable(row.text("name").unwrap_or_default());
        error("E-WORLD-NAME", format!("there are two {what}s with the name '{name}'"))
            .at(self.source, row.span_of("name"), "used before")
            .help("give each its own name")
    }

    fn material(&self, row: &Row) -> Result<usize> {
        let name = row.text("material").unwrap_or(PLAIN);
        self.materials.iter().position(|material| material.name == name).ok_or_else(|| {
            let names = self.materials.iter().map(|material| material.name.as_str());
            Box::new(self.no_such("material", name, row, names))
        })
    }

    fn no_such<'n>(
        &self,
        what: &str,
        name: &str,
        row: &Row,
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

    fn floor(&self, file: &Row) -> Result<usize> {
        match file.rows("floor").first() {
            Some(row) => self.material(row),
            None => Ok(self.materials.iter().position(|material| material.name == PLAIN).unwrap_or(0)),
        }
    }

    fn light(&self, file: &Row) -> Result<Light> {
        let row = file.rows("light").first();
        let mut towards = Vector3::new(0.3, 0.5, 0.8);
        if let Some(row) = row
            && let [x, y, z] = *row.numbers("towards")
        {
            towards = Vector3::new(x, y, z);
            if towards.norm() < 1e-3 {
                return error("E-WORLD-VALUE", "'towards' must have a direction")
                    .at(self.source, row.span_of("towards"), "its length is 0")
                    .help("[0, 0, 1] is a light straight above")
                    .into();
            }
        }
        let number = |key, default| row.and_then(|row| row.number(key)).unwrap_or(default);
        Ok(Light { towards: towards.normalize(), ambient: number("ambient", 0.4), gain: number("gain", 1.0) })
    }

    fn solids(&mut self, file: &Row) -> Result<()> {
        for row in file.rows("wall") {
            let height = row.number("height_m").unwrap_or(1.0);
            self.line("[[wall]]", row, row.number("thickness_m").unwrap_or(0.1), height)?;
        }
        for row in file.rows("box") {
            let size = row.numbers("size_m");
            let half_m = 0.5 * Vector3::new(size[0], size[1], size[2]);
            self.upright("[[box]]", row, Shape::Box { half_m })?;
        }
        for row in file.rows("cylinder") {
            let (radius_m, height) = (row.number("radius_m").unwrap_or(0.1), row.number("height_m").unwrap_or(1.0));
            self.upright("[[cylinder]]", row, Shape::Cylinder { radius_m, half_height_m: 0.5 * height })?;
        }
        for row in file.rows("platform") {
            if self.is_line("[[platform]]", row, &["points_m", "width_m", "height_m"], &["centre_m", "size_m"])? {
                let (width, height) = (row.number("width_m").unwrap_or(1.0), row.number("height_m").unwrap_or(1.0));
                self.line("[[platform]]", row, width, height)?;
            } else {
                let size = row.numbers("size_m");
                let half_m = 0.5 * Vector3::new(size[0], size[1], size[2]);
                self.upright("[[platform]]", row, Shape::Box { half_m })?;
            }
        }
        for row in file.rows("ramp") {
            let size = row.numbers("size_m");
            let half_m = 0.5 * Vector3::new(size[0], size[1], size[2]);
            self.upright("[[ramp]]", row, Shape::Ramp { half_m })?;
        }
        for row in file.rows("paint") {
            if self.is_line("[[paint]]", row, &["points_m", "width_m"], &["centre_m", "size_m"])? {
                self.line("[[paint]]", row, row.number("width_m").unwrap_or(0.1), PAINT_M)?;
            } else {
                let size = row.numbers("size_m");
                let half_m = 0.5 * Vector3::new(size[0], size[1], PAINT_M);
                self.upright("[[paint]]", row, Shape::Box { half_m })?;
            }
        }
        Ok(())
    }

    /// Whether a table describes a line or one solid; it must describe exactly one of them, and all of it.
    fn is_line(&self, section: &str, row: &Row, line: &[&str], solid: &[&str]) -> Result<bool> {
        let has = |key: &&&str| row.span_of(key) != row.span;
        let (line_keys, solid_keys) = (line.iter().filter(has).count(), solid.iter().filter(has).count());
        if (line_keys, solid_keys) == (line.len(), 0) || (line_keys, solid_keys) == (0, solid.len()) {
            return Ok(line_keys > 0);
        }
        error("E-WORLD-KEY", format!("{section} is neither a line nor one solid"))
            .at(self.source, row.span.clone(), "this one")
            .help(format!("a line has {}; one solid has {}", line.join(", "), solid.join(", ")))
            .into()
    }

    /// A box on every segment of a line, half of its width longer at both ends so that corners are square.
    fn line(&mut self, section: &'static str, row: &Row, width: f64, height: f64) -> Result<()> {
        let points = row.points("points_m");
        let closed = row.flag("closed").unwrap_or(false);
        self.check_closed(points, closed)?;
        let bottom = row.number("bottom_m").unwrap_or(0.0);
        let ends = points.iter().skip(1).chain(points.first().filter(|_| closed));
        for ((from, _), (to, _)) in points.iter().zip(ends) {
            let (x, y) = (to[0] - from[0], to[1] - from[1]);
            let half_m = 0.5 * Vector3::new((x * x + y * y).sqrt() + width, width, height);
            let centre = Point3::new(0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1]), bottom + half_m.z);
            self.add(section, row, Shape::Box { half_m }, centre, libm::atan2(y, x))?;
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
                .into();
        }
        Ok(())
    }

    fn upright(&mut self, section: &'static str, row: &Row, shape: Shape) -> Result<()> {
        let place = row.numbers("centre_m");
        let z = row.number("bottom_m").unwrap_or(0.0) + shape.half_extents().z;
        self.add(section, row, shape, Point3::new(place[0], place[1], z), yaw(row))
    }

    fn add(&mut self, section: &'static str, row: &Row, shape: Shape, centre: Point3, yaw_rad: f64) -> Result<()> {
        if self.solids.len() == MOST_SOLIDS {
            return error("E-WORLD-VALUE", format!("a world has at most {MOST_SOLIDS} solids"))
                .at(self.source, row.span.clone(), "one too many")
                .help("a line counts once for every segment")
                .into();
        }
        let material = self.material(row)?;
        self.solids.push(Solid { shape, centre, yaw_rad, material, collides: section != "[[paint]]" });
        self.carries.push(section == "[[platform]]" || section == "[[ramp]]");
        self.origins.push((section, row.span.clone()));
        Ok(())
    }

    fn routes(&self, file: &Row) -> Result<Vec<Route>> {
        let mut routes: Vec<Route> = Vec::new();
        for row in file.rows("route") {
            let name = row.text("name").unwrap_or_default();
            if routes.iter().any(|route| route.name == name) {
                return self.twice("route", row).into();
            }
            let closed = row.flag("closed").unwrap_or(false);
            if name == "lap" && !closed {
                return error("E-WORLD-VALUE", "the route 'lap' must be closed: laps are measured on it")
                    .at(self.source, row.span_of("closed"), "an open route")
                    .help("write 'closed = true', or give the route another name")
                    .into();
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
            routes.push(Route::new(name, points, closed));
        }
        Ok(routes)
    }

    fn movers(&self, rows: &[Row], routes: &[Route]) -> Result<Vec<Mover>> {
        let mut movers: Vec<Mover> = Vec::new();
        for row in rows {
            let name = row.text("name").unwrap_or_default();
            if movers.iter().any(|mover| mover.name == name) {
                return self.twice("mover", row).into();
            }
            let wanted = row.text("route").unwrap_or_default();
            let names = routes.iter().map(|route| route.name.as_str());
            let Some(route) = routes.iter().position(|route| route.name == wanted) else {
                return self.no_such("route", wanted, row, names).into();
            };
            let mut solids = Vec::new();
            for part in row.rows("boxes") {
                let (place, size) = (part.numbers("centre_m"), part.numbers("size_m"));
                solids.push(Solid {
                    shape: Shape::Box { half_m: 0.5 * Vector3::new(size[0], size[1], size[2]) },
                    centre: Point3::new(place[0], place[1], place[2]),
                    yaw_rad: yaw(part),
                    material: self.material(part)?,
                    collides: true,
                });
            }
            let (speed_m_per_s, offset_m) =
                (row.number("speed_m_per_s").unwrap_or(0.0), row.number("offset_m").unwrap_or(0.0));
            movers.push(Mover { name: name.to_owned(), route, speed_m_per_s, offset_m, solids });
        }
        Ok(movers)
    }
}

fn texture(row: &Row) -> Texture {
    let (amplitude, scale_m) = (row.number("amplitude").unwrap_or(10.0), row.number("scale_m").unwrap_or(0.2));
    match row.text("kind") {
        Some("checker") => Texture::Checker { amplitude, scale_m },
        Some("stripes") => Texture::Stripes { amplitude, scale_m },
        Some("noise") => Texture::Noise { amplitude, scale_m },
        _ => Texture::Plain,
    }
}

fn check_starts(layout: &Layout, file: &Row, origins: &[Origin]) -> Result<()> {
    let source = &layout.source;
    if layout.starts.is_empty() {
        return error("E-WORLD-START", "the world has no start")
            .at(source, source.text.len()..source.text.len(), "the file ends here")
            .help("add a table [[start]] with 'position_m = [x, y]' and 'yaw_deg = 0'")
            .into();
    }
    for (row, &start) in file.rows("start").iter().zip(&layout.starts) {
        let at = |message: String, label: String| {
            error("E-WORLD-START", message).at(source, row.span_of("position_m"), label)
        };
        let place = format!("the start at ({}, {})", start.x_m, start.y_m);
        match layout.obstruction(start) {
            Some(Obstruction::Solid(solid)) => {
                let (section, span) = &origins[solid];
                let line = source.position(span.start).0;
                return at(format!("{place} is inside a solid"), format!("overlaps the {section} of line {line}"))
                    .help("the robot needs 0.5 m by 0.48 m around this place, along its heading")
                    .into();
            }
            Some(Obstruction::NoGround) => {
                return at(format!("{place} has no ground under all of the robot"), "it would fall".to_owned())
                    .help("move it at least 0.35 m away from every edge")
                    .into();
            }
            None => {}
        }
        let stance = layout.terrain().put(&layout.scene, start).stance;
        for mover in &layout.movers {
            let mut solids = mover.solids.clone();
            mover.arrange(mover.pose_at(&layout.routes, 0.0), &mut solids);
            if solids.iter().any(|solid| Obstacle::new(solid).touches(&stance)) {
                let name = printable(&mover.name);
                return at(format!("{place} is inside a mover"), format!("overlaps '{name}' at time 0"))
                    .help("move the start, or change the mover's 'offset_m'")
                    .into();
            }
        }
    }
    Ok(())
}
