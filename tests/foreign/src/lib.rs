//! A mass on a spring by another exporter, which gives no states and no derivatives: a stranger to couple with.

use fmu_from_struct::prelude::*;

/// m a = load - added_mass (a - load_acceleration) - k y - m g, semi-implicit Euler.
#[derive(Fmu, Default)]
#[fmu_from_struct(fmi_version = 2)]
pub struct SpringMass {
    #[fmu_from_struct(parameter)]
    #[fmu_from_struct(start_value = 20.0)]
    pub mass: f64,
    #[fmu_from_struct(start_value = 8685.251873)]
    pub stiffness: f64,
    #[fmu_from_struct(start_value = 9.81)]
    pub gravity: f64,
    #[fmu_from_struct(input)]
    pub load: f64,
    pub load_acceleration: f64,
    pub added_mass: f64,
    #[fmu_from_struct(output)]
    pub place: f64,
    pub velocity: f64,
    pub acceleration: f64,
}

impl FmuFunctions for SpringMass {
    fn do_step(&mut self, _current_time: f64, time_step: f64) {
        let force = self.load + self.added_mass * self.load_acceleration
            - self.stiffness * self.place
            - self.mass * self.gravity;
        let inertia = self.mass + self.added_mass + 0.25 * self.stiffness * time_step * time_step;
        // Trapezoidal in the spring: the place at the middle of the step is y + h v / 2 + h^2 a / 4.
        self.acceleration = (force - 0.5 * self.stiffness * time_step * self.velocity) / inertia;
        self.place += time_step * self.velocity + 0.5 * time_step * time_step * self.acceleration;
        self.velocity += time_step * self.acceleration;
    }
}
