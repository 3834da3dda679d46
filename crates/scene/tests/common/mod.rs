//! A scene with everything, and changes of it.

use scene::Scene;

/// A scene in which every key that holds numbers is written out.
pub const SCENE: &str = r#"
title = "everything"
gravity = [0.0, -9.81]
[run]
end = 1.0
communication_step = 0.01
[output]
interval = 0.1
record_interval = 0.1
checkpoint_interval = 10.0
[fluid]
density = 1000.0
spacing = 0.01
threads = 1
attraction = 1.0
start = { velocity = [1.0, 0.0], gradient = [[1.0, 0.0], [0.0, -1.0]], jitter = 0.1, seed = 3 }
damping = [{ from = 0.8, to = 1.0, rate = 5.0 }]
shaking = { amplitude = [0.1, 0.0], period = 2.0 }
water = [{ polygon = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.5], [0.0, 0.5]] }]
wall = [{ points = [[0.0, 1.0], [0.0, 0.0], [1.0, 0.0], [1.0, 1.0]] }]
probe = [{ name = "p", point = [0.0, 0.1], size = 0.02, threshold = 0.0 }, { name = "l", from = [0.0, 0.1], to = [0.0, 0.4], count = 3, size = 0.0 }]
gauge = [{ name = "g", x = 0.5 }]
region = [{ name = "r", polygon = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.5]] }]
voronoi = { alpha = 0.01, courant = 0.4, shifting = 1.0, repulsion = 20.0, spreading = 30.0, smoothing = 1.0, enclosed_pressure = 0.0 }
mps = { influence_radius = 3.1, alpha = 0.01, courant = 0.2, shifting = 0.03, collision_distance = 0.8, restitution = 0.2, surface_deviation = 0.2 }
solve = { tolerance = 1e-3, maximum_iterations = 100 }
[gas]
exponent = 1.4
ambient = 1e5
density = 1.2
chamber = [{ name = "c", point = [0.5, 0.8], pressure = 1e5 }]
vent = [{ name = "v", point = [0.5, 0.8], to = [0.2, 0.8], area = 1e-3, discharge = 0.6 }]
[[body]]
name = "cabin"
origin = [0.5, 0.6]
angle = 0.1
free = ["x", "theta"]
mass = 1.0
inertia = 1.0
springs = [1.0, 2.0, 3.0]
wall = [{ points = [[-0.1, 0.0], [0.1, 0.0]] }]
constant_load = [1.0, 0.0]
contact = { depth = 1e-3, damping = 1.0 }
[[body.member]]
name = "bulkhead"
support = "clamped_free"
middle = [0.0, 0.1]
length = 0.1
thickness = 0.01
density = 1000.0
youngs_modulus = 1e6
poisson_ratio = 0.3
deflection_limit = 0.2
modes = 2
damping = [0.01]
constant_load = [0.5]
initial_modes = [0.1]
[integrator]
rho_infinity = 0.8
beta = 0.25
gamma = 0.5
[coupling]
relaxation = 0.2
tolerance_relative = 1e-6
tolerance_absolute = 1e-6
maximum_iterations = 30
smallest_step = 1e-4
predictor_order = 1
reused_steps = 4
[watch]
energy = 0.01
lost = 0.1
speed = 5.0
[[check]]
name = "c"
kind = "series_mean"
from = 0.1
to = 0.2
scale = 2.0
offset = 1.0
time_scale = 2.0
reference = 1.0
limit = 1.0
depth = 0.5
window = 0.05
level = 1.0
rest = 1.0
points = [[0.0, 1.0]]
quick = { limit = 0.1, reference = 1.0, from = 0.1, to = 0.2 }
"#;

/// The scene with another value of a key; the message where it is refused.
pub fn with(key: &str, value: &str) -> Result<Scene, String> {
    let overrides = [(key.to_string(), value.to_string())];
    Scene::with_overrides(SCENE, "all.toml", &overrides).map_err(|error| error.to_string())
}
