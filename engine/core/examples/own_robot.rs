//! A robot of one's own behind a socket: it learns, is recorded, tested, and its record is played again.
//! `cargo run --release -p engine --example own_robot`.
//!
//! The robot is a thread that listens on loopback: a point in a round room, whose camera sees a dark floor and a bright wall
//! that reaches down the farther the nearer it is. A real robot would be at the other end of the socket.

#![allow(clippy::print_stdout, reason = "an example shows what it found")]

use std::io::{Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use engine::diagnostic::{Diagnostic, Result, SourceText};
use engine::experiment::{
    Cycle, Learning, Ledger, Overrides, Phase, Plan, Playback, RunLog, TestRun, frozen, test_robot,
};
use engine::geometry::{Pose, Twist};
use engine::learner::{Policy, shipped_learner};
use engine::random::{Random, Stream};
use engine::robot::{Robot, Whereabouts};
use engine::script::Behaviour;
use engine::sensors::observation::Observation;
use engine::settings::ScanFan;

const SCRIPT: &str = "world(\"room\");\n\
                      run(#{ steps: 2000, test_steps: 400 });\n\
                      filter(\"threshold\", #{ threshold: 128 });\n\
                      grid(#{ occupied: 0.4 });\n\
                      rule \"too close\" when laser.nearest < 0.3 => -1 then recover;\n";
/// Radius of the round room, metres.
const ROOM_M: f64 = 2.5;
/// Time of one action, seconds.
const PERIOD_S: f64 = 0.5;
/// Bytes of a place: x, y, yaw.
const PLACE_BYTES: usize = 24;

/// The robot's own side of the socket.
struct Point {
    pose: Pose,
    random: Random,
}

impl Point {
    /// Carries out what it is told until the other side hangs up: `a` with two speeds, or `r` to recover; it answers with
    /// its place.
    fn serve(mut stream: TcpStream) -> std::io::Result<()> {
        let mut point = Self { pose: Pose::new(0.0, 0.0, 0.0), random: Random::new(1, Stream::Recovery) };
        let mut word = [0; 1];
        while stream.read_exact(&mut word).is_ok() {
            match word[0] {
                b'a' => {
                    let mut speeds = [0; 16];
                    stream.read_exact(&mut speeds)?;
                    let (linear, angular) = speeds.split_at(8);
                    let number = |bytes: &[u8]| bytes.try_into().map_or(0.0, f64::from_le_bytes);
                    let next = point.pose.moved(Twist::new(number(linear), number(angular)), PERIOD_S);
                    if next.distance_m(Pose::default()) < ROOM_M {
                        point.pose = next;
                    }
                }
                _ => point.pose = Pose::new(0.0, 0.0, point.random.between(-3.0, 3.0)),
            }
            let place = [point.pose.x_m, point.pose.y_m, point.pose.yaw_rad].map(f64::to_le_bytes);
            stream.write_all(place.as_flattened())?;
        }
        Ok(())
    }
}

/// The engine's side: asks the robot over the socket, and makes observations of what it answers.
struct Remote {
    stream: TcpStream,
    pose: Pose,
    odometry: Twist,
}

impl Remote {
    fn connect(address: SocketAddr) -> Result<Self> {
        let stream = TcpStream::connect(address).map_err(|error| lost(&error))?;
        stream.set_nodelay(true).map_err(|error| lost(&error))?;
        Ok(Self { stream, pose: Pose::default(), odometry: Twist::default() })
    }

    fn ask(&mut self, words: &[u8]) -> Result<()> {
        let mut place = [0; PLACE_BYTES];
        let asked = self.stream.write_all(words).and_then(|()| self.stream.read_exact(&mut place));
        asked.map_err(|error| lost(&error))?;
        let (numbers, _) = place.as_chunks();
        let [x_m, y_m, yaw_rad] = [0, 1, 2].map(|index| f64::from_le_bytes(numbers[index]));
        self.pose = Pose::new(x_m, y_m, yaw_rad);
        Ok(())
    }

    /// How far the wall is in a direction from straight ahead, metres.
    fn range_m(&self, bearing_rad: f64) -> f64 {
        let (sin, cos) = libm::sincos(self.pose.yaw_rad + bearing_rad);
        let along = self.pose.x_m * cos + self.pose.y_m * sin;
        let away = self.pose.distance_m(Pose::default());
        (along * along + ROOM_M * ROOM_M - away * away).max(0.0).sqrt() - along
    }
}

/// The link to the robot broke.
fn lost(error: &std::io::Error) -> Box<Diagnostic> {
    Box::new(Diagnostic::new("E-IO", format!("the robot does not answer: {error}")))
}

impl Robot for Remote {
    fn observe(&mut self, observation: &mut Observation) -> Result<()> {
        // Its laser looks over half a circle, as `laser.field_of_view_deg` says.
        let fan = ScanFan { beams: observation.scan.ranges_m.len(), view_deg: 180.0 };
        for beam in 0..fan.beams {
            observation.scan.ranges_m[beam] = self.range_m(fan.bearing_rad(beam)) as f32;
        }
        let image = &mut observation.image;
        let (width, height, channels) = (image.width_px, image.height_px, image.format.channels());
        for column in 0..width {
            let bearing = (0.5 - column as f64 / width as f64) * 1.2;
            let wall_px = (height as f64 * (0.5 / self.range_m(bearing)).min(1.0)) as usize;
            for row in 0..height {
                let pixel = &mut image.pixels[(row * width + column) * channels..][..channels];
                pixel.fill(if row < wall_px { 220 } else { 40 });
            }
        }
        // A camera that never changes is taken for a broken one only in the simulator; the bumper is the nearest range.
        observation.contact = self.range_m(0.0) < 0.05;
        observation.odometry = self.odometry;
        Ok(())
    }

    fn act(&mut self, twist: Twist) -> Result<()> {
        self.odometry = twist;
        let speeds = [twist.linear_m_per_s, twist.angular_rad_per_s].map(f64::to_le_bytes);
        self.ask(&[b"a", speeds.as_flattened()].concat())
    }

    fn recover(&mut self) -> Result<()> {
        self.ask(b"r")
    }

    fn whereabouts(&self) -> Option<Whereabouts> {
        Some(Whereabouts { pose: self.pose, z_m: 0.0 })
    }
}

/// A robot that listens; each connection begins with a robot in the middle of the room.
fn listening() -> std::io::Result<SocketAddr> {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?;
    let address = listener.local_addr()?;
    std::thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            std::thread::spawn(move || Point::serve(stream));
        }
    });
    Ok(address)
}

fn test(plan: &Plan, policy: &Policy, address: SocketAddr, ledger: &mut Ledger) -> Result<TestRun> {
    let mut cycle = Cycle::new(plan, Remote::connect(address)?)?;
    test_robot(plan, &mut cycle, &mut frozen(plan, policy, 1), &AtomicBool::new(false), ledger)
}

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    let address = listening()?;
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts/round.rhai");
    let behaviour = Behaviour::parse("round", SourceText::new(path, SCRIPT))?;
    let plan = Plan::new(Arc::new(behaviour), &Overrides::default())?;

    // Learn, with every step recorded.
    let mut log = RunLog::new(&plan);
    let cycle = Cycle::new(&plan, Remote::connect(address)?)?;
    let learner = shipped_learner(&plan.settings.learner, plan.task(cycle.state_map(), 1)?);
    let mut learning = Learning::with(&plan, 1, cycle, learner);
    learning.run(plan.settings.run.steps, &AtomicBool::new(false), &|_| (), &mut log.learning)?;
    let learned = learning.finish();

    // Test what was learned on the same robot.
    let tested = test(&plan, &learned.policy, address, &mut log.test)?;

    // Play the record again: the same actions bring the same steps, bit for bit.
    let mut playback = Playback::with_robots(&plan, Phase::Learning, &log.learning, move || Remote::connect(address))?;
    while playback.advance()?.is_some() {
        assert_eq!(playback.difference(), None, "step {}", playback.done());
    }
    println!(
        "{} steps learned and played again alike; {} failures while learning, {} in {} steps of the test",
        playback.done(),
        learned.tally.endings().failures,
        tested.figures.failures,
        tested.figures.steps
    );
    Ok(())
}
