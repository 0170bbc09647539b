//! The MCAP file itself, written beside its place and moved there when it is whole.

use std::fs::File;
use std::io::Cursor;
use std::path::Path;

use foxglove::messages::{
    CameraCalibration, CompressedImage, FrameTransform, LaserScan, PoseInFrame, SceneUpdate, Timestamp, Vector3,
};
use foxglove::{Channel, ChannelBuilder, Context, FoxgloveError, McapCompression, McapWriteOptions, PartialMetadata};
use foxglove::{RawChannel, Schema};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use serde_json::json;

use super::camera::{CAMERA, calibration, drawn_camera, mount};
use super::recording::Recording;
use super::scene::{WORLD, pose, turned, update};
use engine::diagnostic::{Diagnostic, Result};
use engine::experiment::{Ledger, Phase, Plan, Playback, Snapshot, Step};
use engine::robot::Robot;

/// The names of the coordinate frames of the robot and of its laser.
const ROBOT: &str = "robot";
const LASER: &str = "laser";
/// What `/step` holds.
const STEP_SCHEMA: &str = r#"{"type":"object","title":"engine.Step","properties":{
"phase":{"type":"string"},"step":{"type":"integer"},"state":{"type":"integer"},"next_state":{"type":"integer"},
"action":{"type":"integer"},"linear_m_per_s":{"type":"number"},"angular_rad_per_s":{"type":"number"},
"reward":{"type":"number"},"rules":{"type":"object","additionalProperties":{"type":"number"}},
"recover":{"type":"boolean"},"contact":{"type":"boolean"}}}"#;

pub(super) fn record(
    plan: &Plan,
    seed: u64,
    phases: &[(Phase, &Ledger)],
    image_every: u64,
    path: &Path,
) -> Result<Recording> {
    let disk = |error| Box::new(Diagnostic::disk("record into", path, &error));
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let staged = staging().tempfile_in(folder).map_err(disk)?;
    let context = Context::new();
    let options = McapWriteOptions::new().compression(Some(McapCompression::Lz4));
    let writer = context.mcap_writer_with_options(options).create(staged.reopen().map_err(disk)?).map_err(wrong)?;
    let mut tape = Tape::new(&context, plan)?;
    for (phase, ledger) in phases {
        tape.phase(plan, seed, *phase, ledger, image_every.max(1))?;
    }
    let file: File = writer.close().map_err(wrong)?;
    file.sync_all().map_err(disk)?;
    let bytes = file.metadata().map_err(disk)?.len();
    staged.persist(path).map_err(|error| disk(error.error))?;
    Ok(Recording { steps: tape.step, images: tape.images, bytes })
}

/// Temporary files are private; a recording is as readable as any file that the user makes.
fn staging() -> tempfile::Builder<'static, 'static> {
    let mut staging = tempfile::Builder::new();
    #[cfg(unix)]
    staging.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    staging
}

fn wrong(error: FoxgloveError) -> Box<Diagnostic> {
    Box::new(Diagnostic::new("E-RECORD", format!("the recording cannot be written: {error}")))
}

/// The channels of one recording.
struct Tape {
    transform: Channel<FrameTransform>,
    world: Channel<SceneUpdate>,
    scan: Channel<LaserScan>,
    camera: Channel<CompressedImage>,
    calibration: Channel<CameraCalibration>,
    mask: Channel<CompressedImage>,
    prey: Channel<PoseInFrame>,
    steps: std::sync::Arc<RawChannel>,
    /// Steps so far, over all phases.
    step: u64,
    images: u64,
    period_s: f64,
}

impl Tape {
    fn new(context: &std::sync::Arc<Context>, plan: &Plan) -> Result<Self> {
        let channel = |topic: &str| ChannelBuilder::new(topic).context(context);
        let schema = Schema::new("engine.Step", "jsonschema", STEP_SCHEMA.as_bytes());
        let steps = channel("/step").schema(schema).message_encoding("json").build_raw().map_err(wrong)?;
        Ok(Self {
            transform: channel("/tf").build(),
            world: channel("/world").build(),
            scan: channel("/scan").build(),
            camera: channel("/camera").build(),
            calibration: channel("/calibration").build(),
            mask: channel("/mask").build(),
            prey: channel("/prey").build(),
            steps,
            step: 0,
            images: 0,
            period_s: plan.settings.run.period_s,
        })
    }

    fn phase(&mut self, plan: &Plan, seed: u64, phase: Phase, ledger: &Ledger, image_every: u64) -> Result<()> {
        let mut playback = Playback::new(plan, seed, phase, ledger)?;
        let (at, timestamp) = self.now();
        self.world.log_with_meta(&update(plan.layout.scene.parts(), timestamp), at);
        let mut world = 0;
        let laser = &plan.settings.laser;
        self.transform.log_with_meta(
            &FrameTransform {
                timestamp: Some(timestamp),
                parent_frame_id: ROBOT.to_owned(),
                child_frame_id: LASER.to_owned(),
                translation: Some(Vector3 { x: laser.forward_m, y: 0.0, z: laser.height_m }),
                rotation: Some(turned(0.0)),
            },
            at,
        );
        while let Some(step) = playback.advance()? {
            self.step += 1;
            let now = playback.cycle().robot().world_index();
            if std::mem::replace(&mut world, now) != now {
                let (at, timestamp) = self.now();
                self.world.log_with_meta(&update(plan.worlds.layouts()[now].scene.parts(), timestamp), at);
            }
            self.robot(&playback);
            self.scan(plan, &playback);
            self.judged(plan, phase, &playback, &step)?;
            if step.index % image_every == 0 {
                self.images(plan, &playback)?;
            }
        }
        Ok(())
    }

    /// The robot's time at this step.
    fn now(&self) -> (PartialMetadata, Timestamp) {
        let time_ns = (self.step as f64 * self.period_s * 1e9).round() as u64;
        let timestamp = Timestamp::new((time_ns / 1_000_000_000) as u32, (time_ns % 1_000_000_000) as u32);
        (PartialMetadata { log_time: Some(time_ns) }, timestamp)
    }

    fn robot(&self, playback: &Playback<'_>) {
        let (at, timestamp) = self.now();
        let world = playback.cycle().robot().world();
        let body = world.body(0);
        let message = FrameTransform {
            timestamp: Some(timestamp),
            parent_frame_id: WORLD.to_owned(),
            child_frame_id: ROBOT.to_owned(),
            translation: Some(Vector3 { x: body.pose.x_m, y: body.pose.y_m, z: body.z_m }),
            rotation: Some(turned(body.pose.yaw_rad)),
        };
        self.transform.log_with_meta(&message, at);
        if let Some(prey) = world.prey() {
            let pose = Some(pose([prey.x_m, prey.y_m, 0.0], prey.yaw_rad));
            let message = PoseInFrame { timestamp: Some(timestamp), frame_id: WORLD.to_owned(), pose };
            self.prey.log_with_meta(&message, at);
        }
    }

    fn scan(&self, plan: &Plan, playback: &Playback<'_>) {
        let (at, timestamp) = self.now();
        let fan = plan.settings.laser.fan();
        let ranges = playback.cycle().observation().scan.ranges_m.iter().map(|range| f64::from(*range)).collect();
        let message = LaserScan {
            timestamp: Some(timestamp),
            frame_id: LASER.to_owned(),
            pose: Some(pose([0.0; 3], 0.0)),
            start_angle: fan.bearing_rad(0),
            end_angle: fan.bearing_rad(fan.beams.saturating_sub(1)),
            ranges,
            intensities: Vec::new(),
        };
        self.scan.log_with_meta(&message, at);
    }

    fn judged(&self, plan: &Plan, phase: Phase, playback: &Playback<'_>, step: &Step) -> Result<()> {
        let (rules, fired) = (plan.behaviour.rules(), playback.cycle().fired());
        let by_rule: serde_json::Map<_, _> = (rules.iter().zip(fired))
            .filter_map(|(rule, value)| value.map(|value| (rule.name.clone(), json!(value))))
            .collect();
        let twist = plan.motions()[step.action];
        let message = json!({
            "phase": if phase == Phase::Learning { "learning" } else { "test" },
            "step": step.index,
            "state": step.state,
            "next_state": step.next_state,
            "action": step.action,
            "linear_m_per_s": twist.linear_m_per_s,
            "angular_rad_per_s": twist.angular_rad_per_s,
            "reward": step.reward,
            "rules": by_rule,
            "recover": step.then.is_some(),
            "contact": step.contact,
        });
        self.steps.log_with_meta(message.to_string().as_bytes(), self.now().0);
        Ok(())
    }

    fn images(&mut self, plan: &Plan, playback: &Playback<'_>) -> Result<()> {
        let (at, timestamp) = self.now();
        let camera = drawn_camera(plan, playback.cycle().robot().drawn());
        self.transform.log_with_meta(&mount(&camera, ROBOT, timestamp), at);
        self.calibration.log_with_meta(&calibration(&camera, timestamp), at);
        let seen = Snapshot::of(playback.cycle());
        let size = (seen.image.width_px as u32, seen.image.height_px as u32);
        let message = |data: Vec<u8>| CompressedImage {
            timestamp: Some(timestamp),
            frame_id: CAMERA.to_owned(),
            data: data.into(),
            format: "png".to_owned(),
        };
        self.camera.log_with_meta(&message(png(&seen.image.pixels, size, ExtendedColorType::Rgb8)?), at);
        if let Some(view) = seen.views.first() {
            self.mask.log_with_meta(&message(png(&view.mask, size, ExtendedColorType::L8)?), at);
        }
        self.images += 1;
        Ok(())
    }
}

fn png(pixels: &[u8], (width, height): (u32, u32), colour: ExtendedColorType) -> Result<Vec<u8>> {
    let mut bytes = Cursor::new(Vec::new());
    let encoder = PngEncoder::new_with_quality(&mut bytes, CompressionType::Fast, FilterType::Up);
    encoder
        .write_image(pixels, width, height, colour)
        .map_err(|error| Box::new(Diagnostic::new("E-RECORD", format!("an image cannot be written: {error}"))))?;
    Ok(bytes.into_inner())
}
