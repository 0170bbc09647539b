//! The world as a viewer draws it.

use foxglove::messages::{
    Color, CubePrimitive, CylinderPrimitive, Point3, Pose, Quaternion, SceneEntity, SceneUpdate, Timestamp,
    TriangleListPrimitive, Vector3,
};

use engine::world::scene::{SceneParts, Shape, Solid};

/// The name of the world's coordinate frame.
pub(super) const WORLD: &str = "world";

/// All solids of a scene as one entity of the frame `world`.
pub(super) fn update(parts: &SceneParts, timestamp: Timestamp) -> SceneUpdate {
    let mut entity = SceneEntity {
        timestamp: Some(timestamp),
        frame_id: WORLD.to_owned(),
        id: "world".to_owned(),
        ..SceneEntity::default()
    };
    for solid in &parts.solids {
        let [red, green, blue] = parts.materials[solid.material].colour.map(|level| f64::from(level) / 255.0);
        let color = Some(Color { r: red, g: green, b: blue, a: 1.0 });
        let pose = Some(pose([solid.centre.x, solid.centre.y, solid.centre.z], solid.yaw_rad));
        match solid.shape {
            Shape::Box { half_m } => {
                let size = Some(Vector3 { x: 2.0 * half_m.x, y: 2.0 * half_m.y, z: 2.0 * half_m.z });
                entity.cubes.push(CubePrimitive { pose, size, color });
            }
            Shape::Cylinder { radius_m, half_height_m } => {
                let size = Some(Vector3 { x: 2.0 * radius_m, y: 2.0 * radius_m, z: 2.0 * half_height_m });
                entity.cylinders.push(CylinderPrimitive { pose, size, bottom_scale: 1.0, top_scale: 1.0, color });
            }
            Shape::Ramp { .. } => entity.triangles.push(ramp(solid, pose, color)),
        }
    }
    SceneUpdate { entities: vec![entity], ..SceneUpdate::default() }
}

/// A wedge: its top falls from full height at +x to nothing at -x.
fn ramp(solid: &Solid, pose: Option<Pose>, color: Option<Color>) -> TriangleListPrimitive {
    let Shape::Ramp { half_m } = solid.shape else { return TriangleListPrimitive::default() };
    let corner = |x: f64, y: f64, z: f64| Point3 { x: x * half_m.x, y: y * half_m.y, z: z * half_m.z };
    let points = vec![
        corner(-1.0, -1.0, -1.0),
        corner(-1.0, 1.0, -1.0),
        corner(1.0, -1.0, -1.0),
        corner(1.0, 1.0, -1.0),
        corner(1.0, -1.0, 1.0),
        corner(1.0, 1.0, 1.0),
    ];
    // Bottom, slope, the high side, and the two triangles beside them.
    let indices = vec![0, 1, 3, 0, 3, 2, 0, 4, 5, 0, 5, 1, 2, 3, 5, 2, 5, 4, 0, 2, 4, 1, 5, 3];
    TriangleListPrimitive { pose, points, color, colors: Vec::new(), indices }
}

/// A pose turned about the vertical.
pub(super) fn pose([x, y, z]: [f64; 3], yaw_rad: f64) -> Pose {
    Pose { position: Some(Vector3 { x, y, z }), orientation: Some(turned(yaw_rad)) }
}

/// A turn about the vertical.
pub(super) fn turned(yaw_rad: f64) -> Quaternion {
    Quaternion { x: 0.0, y: 0.0, z: libm::sin(yaw_rad / 2.0), w: libm::cos(yaw_rad / 2.0) }
}
