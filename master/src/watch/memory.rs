//! What a watch finds in the figures of one communication point after the other.

use super::Reference;
use report::Short;
use serde::{Deserialize, Serialize};

/// Figures of a system at a communication point; 0 where nobody gives them.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Seen {
    /// Time \[s\].
    pub time: f64,
    /// Particles in the domain.
    pub count: f64,
    /// Particles that left it.
    pub lost: f64,
    /// Kinetic and potential energy of the water \[J/m\].
    pub water: [f64; 2],
    /// Those of the structure, constant loads included \[J/m\].
    pub body: [f64; 2],
    /// Momentum of the water \[N s/m\].
    pub momentum: [f64; 2],
    /// Largest speed of a particle \[m/s\].
    pub speed: f64,
}

/// What a watch carries from point to point.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Memory {
    /// Time \[s\] and power of the shaking \[W/m\] at the last point, and its work so far \[J/m\].
    last: Option<(f64, f64)>,
    work: f64,
    /// Least energy so far; water's potential energy at the start, above the lowest point \[J/m\].
    least: Option<f64>,
    start: f64,
    /// Largest kinetic energy so far, of all and of the structure alone \[J/m\].
    kinetic: f64,
    body_kinetic: f64,
    /// Least and largest potential energy of the structure so far \[J/m\].
    body_potential: Option<(f64, f64)>,
    /// Largest rise of the energy over the energy of the run.
    gain: f64,
    /// What was found and told: each kind once.
    findings: Vec<(Kind, String)>,
}

/// Kinds of findings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
enum Kind {
    Energy,
    Lost,
    Speed,
}

impl Memory {
    /// What was found so far.
    pub fn findings(&self) -> Vec<String> {
        self.findings.iter().map(|(_, text)| text.clone()).collect()
    }

    /// Largest rise of the energy over the energy of the run.
    pub(super) fn gain(&self) -> f64 {
        self.gain
    }

    /// Takes the figures of the next point; gives what was not found before.
    pub(super) fn take(&mut self, seen: &Seen, limits: &scene::Watch, reference: Option<&Reference>) -> Vec<String> {
        let before = self.findings.len();
        self.take_lost(seen, limits.lost);
        if let Some(reference) = reference {
            self.take_energy(seen, limits.energy, reference);
            self.take_speed(seen, limits.speed, reference);
        }
        self.findings[before..].iter().map(|(_, text)| text.clone()).collect()
    }

    fn tell(&mut self, kind: Kind, text: impl FnOnce() -> String) {
        if self.findings.iter().all(|(known, _)| *known != kind) {
            self.findings.push((kind, text()));
        }
    }

    fn take_lost(&mut self, seen: &Seen, share: f64) {
        let Seen { time, count, lost, .. } = *seen;
        if lost > share * (count + lost) {
            self.tell(Kind::Lost, || {
                format!(
                    "at t = {time} s {lost} of {} particles had left the scene and were lost, expected at most {} % \
                     (watch.lost): raise the walls, or look for a gap in them",
                    count + lost,
                    100.0 * share
                )
            });
        }
    }

    fn take_energy(&mut self, seen: &Seen, share: f64, reference: &Reference) {
        let (rise, scale) = self.rise(seen, reference);
        if scale <= 0.5 * (reference.water + reference.body) * reference.still.powi(2) {
            return;
        }
        self.gain = self.gain.max(rise / scale);
        if share > 0.0 && rise > share * scale {
            self.tell(Kind::Energy, || {
                format!(
                    "at t = {} s water and structure had gained {} J/m that nothing supplied, {:.1} % of the energy of the run \
                     ({} J/m), expected at most {} % (watch.energy): what follows does not hold; look at walls that cross, \
                     double back or leave less than a spacing between them, and try a smaller run.communication_step",
                    seen.time,
                    Short(rise),
                    100.0 * rise / scale,
                    Short(scale),
                    100.0 * share
                )
            });
        }
    }

    /// Rise of the energy above its least value so far, and the energy of the run \[J/m\].
    fn rise(&mut self, seen: &Seen, reference: &Reference) -> (f64, f64) {
        let all = seen.count + seen.lost;
        let water = if all > 0.0 { reference.water * seen.count / all } else { 0.0 };
        let potential = seen.water[1] - reference.gravity * water * reference.lowest;
        self.add_work(seen, reference);
        let kinetic = seen.water[0] + seen.body[0];
        let energy = kinetic + potential + seen.body[1] - self.work;
        if self.least.is_none() {
            self.start = potential.max(0.0);
        }
        let (low, high) = self.body_potential.unwrap_or((seen.body[1], seen.body[1]));
        let (low, high) = (low.min(seen.body[1]), high.max(seen.body[1]));
        self.body_potential = Some((low, high));
        self.kinetic = self.kinetic.max(kinetic);
        self.body_kinetic = self.body_kinetic.max(seen.body[0]);
        let least = self.least.map_or(energy, |least| least.min(energy));
        self.least = Some(least);
        (energy - least, self.kinetic + self.start + high - low)
    }

    /// Adds the work of the shaking since the last point, by the trapezoidal rule.
    fn add_work(&mut self, seen: &Seen, reference: &Reference) {
        let (acceleration, omega) = reference.shaking;
        let along = acceleration[0] * seen.momentum[0] + acceleration[1] * seen.momentum[1];
        let power = along * (omega * seen.time).cos();
        if let Some((before, last)) = self.last {
            self.work += 0.5 * (last + power) * (seen.time - before);
        }
        self.last = Some((seen.time, power));
    }

    fn take_speed(&mut self, seen: &Seen, factor: f64, reference: &Reference) {
        let share = |energy: f64, mass: f64| if mass > 0.0 { 2.0 * energy.max(0.0) / mass } else { 0.0 };
        let supplied = share(self.work, reference.water) + share(self.body_kinetic, reference.body);
        let allowed = (reference.squared_speed + supplied).sqrt().max(reference.still);
        if factor > 0.0 && allowed > 0.0 && seen.speed > factor * allowed {
            self.tell(Kind::Speed, || {
                format!(
                    "at t = {} s a particle moved at {} m/s, expected at most {} m/s: {factor} times (watch.speed) the {} m/s \
                     that its start, a fall through the scene and the body give",
                    seen.time,
                    Short(seen.speed),
                    Short(factor * allowed),
                    Short(allowed)
                )
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1000 kg/m of water that can fall by 1 m above a floor at -2 m: 4905 J/m with its centre half a metre up.
    fn reference() -> Reference {
        Reference { gravity: 9.81, lowest: -2.0, water: 1000.0, squared_speed: 19.62, ..Reference::default() }
    }

    fn seen(time: f64, kinetic: f64, height: f64) -> Seen {
        Seen { time, count: 100.0, water: [kinetic, 9810.0 * (height - 2.0)], speed: 1.0, ..Seen::default() }
    }

    fn take(memory: &mut Memory, seen: Seen) -> Vec<String> {
        memory.take(&seen, &scene::Watch::default(), Some(&reference()))
    }

    #[test]
    fn energy_may_change_its_form_and_be_lost_but_not_rise() {
        let mut memory = Memory::default();
        // Falls by 0.2 m, 1962 J/m, of which 62 are lost on the way, and swings back.
        assert!(take(&mut memory, seen(0.0, 0.0, 0.5)).is_empty());
        assert!(take(&mut memory, seen(0.1, 1900.0, 0.3)).is_empty());
        assert!(take(&mut memory, seen(0.2, 0.0, 0.3 + 1900.0 / 9810.0)).is_empty());
        assert!(memory.gain() < 1e-12, "{}", memory.gain());
        // The energy of the run is 4905 + 1900 J/m: 1 % of it is 68 J/m.
        assert!(take(&mut memory, seen(0.3, 1967.0, 0.3)).is_empty());
        let found = take(&mut memory, seen(0.4, 1970.0, 0.3));
        assert!(found[0].contains("at t = 0.4 s") && found[0].contains("gained 70.00 J/m"), "{found:?}");
        assert!((memory.gain() - 70.0 / (4905.0 + 1970.0)).abs() < 1e-9, "{}", memory.gain());
        assert!(take(&mut memory, seen(0.5, 1e6, 0.3)).is_empty(), "each kind is told once");
        assert_eq!(memory.findings(), found);
    }

    #[test]
    fn the_structure_takes_part_and_what_shakes_the_tank_supplies() {
        let mut memory = Memory::default();
        let with_body = |time: f64, kinetic: f64, body: [f64; 2]| Seen { body, ..seen(time, kinetic, 0.5) };
        assert!(take(&mut memory, with_body(0.0, 0.0, [0.0, 500.0])).is_empty());
        assert!(take(&mut memory, with_body(0.1, 300.0, [100.0, 100.0])).is_empty(), "a spring drives the water");
        assert_eq!(take(&mut memory, with_body(0.2, 400.0, [100.0, 100.0])).len(), 1);
        // A constant acceleration of 2 m/s2 on a momentum that grows to 1000 N s/m within 1 s supplies 1000 J/m.
        let shaken = Reference { shaking: ([2.0, 0.0], 0.0), ..reference() };
        let mut memory = Memory::default();
        for step in 0..=10 {
            let time = 0.1 * f64::from(step);
            let here = Seen { momentum: [1000.0 * time, 0.0], ..seen(time, 1000.0 * time * time, 0.5) };
            assert!(memory.take(&here, &scene::Watch::default(), Some(&shaken)).is_empty(), "{memory:?}");
        }
        assert!(memory.gain() < 1e-12, "{}", memory.gain());
    }

    #[test]
    fn lost_water_takes_its_energy_with_it_and_is_told() {
        let mut memory = Memory::default();
        assert!(take(&mut memory, seen(0.0, 0.0, 0.5)).is_empty());
        // Half of the water is gone; what is left lies as high as before, and the origin is above it.
        let half = Seen { count: 50.0, lost: 50.0, water: [0.0, -0.5 * 9810.0 * 1.5], ..seen(0.1, 0.0, 0.5) };
        let found = take(&mut memory, half);
        assert!(found.len() == 1 && found[0].contains("50 of 100 particles"), "{found:?}");
        assert_eq!(memory.gain(), 0.0);
        let limits = scene::Watch { lost: 1.0, ..scene::Watch::default() };
        assert!(Memory::default().take(&half, &limits, Some(&reference())).is_empty(), "meant to run out");
        assert_eq!(Memory::default().take(&half, &scene::Watch::default(), None).len(), 1, "in a case of FMUs too");
    }

    /// Without gravity and motion there is nothing but rounding to measure by.
    #[test]
    fn rounding_is_no_motion() {
        let reference = Reference { water: 1000.0, still: 1e-10, ..Reference::default() };
        let found = |speed: f64| {
            let mut memory = Memory::default();
            let at =
                |time: f64, speed: f64| Seen { speed, water: [500.0 * speed * speed, 0.0], ..seen(time, 0.0, 0.0) };
            memory.take(&at(0.0, 1e-24), &scene::Watch::default(), Some(&reference));
            memory.take(&at(1.0, speed), &scene::Watch::default(), Some(&reference)).len()
        };
        assert_eq!((found(1e-21), found(1e-9)), (0, 2));
    }

    #[test]
    fn speeds_are_measured_by_the_fall() {
        let speed = |speed: f64, body: f64| {
            let reference = Reference { body: 10.0, ..reference() };
            let here = Seen { speed, body: [body, 0.0], ..seen(0.0, 0.0, 0.5) };
            Memory::default().take(&here, &scene::Watch::default(), Some(&reference))
        };
        // sqrt(2 g 1 m) = 4.43 m/s, five times that 22.1 m/s.
        assert!(speed(22.0, 0.0).is_empty());
        let found = speed(22.3, 0.0);
        assert!(found[0].contains("22.30 m/s, expected at most 22.15 m/s"), "{found:?}");
        assert!(speed(22.3, 10.0).is_empty(), "a body that moves throws water");
        assert!(Memory::default().take(&seen(0.0, 0.0, 0.5), &scene::Watch::default(), None).is_empty());
    }
}
