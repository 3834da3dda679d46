//! The fluid's table of variables.

use super::{FluidComponent, gas};
use crate::interface::{ANSWER, GAUGE, IMPULSE, LARGEST, LOADS, MOTIONS, PROBE, REGION, added_masses, family};
use crate::parameters::{output_rows, scene_rows};
use crate::{Interface, quantities};
use fluid::{Gains, Observables};
use fmi::{DefaultExperiment, Model, Reference, Variable};

type Row = Variable<FluidComponent>;

/// Description and table for an interface.
pub(super) fn model(interface: &Interface) -> Model<FluidComponent> {
    let mut variables = parameters();
    variables.extend(motions(interface));
    variables.extend(family(interface, &LOADS, FluidComponent::load));
    variables.extend(family(interface, &ANSWER, FluidComponent::load_acceleration));
    variables.extend(added_masses(interface, |this: &FluidComponent, entry| {
        let size = this.state.motion.size();
        this.added_mass(entry / size, entry % size)
    }));
    variables.extend(places(interface));
    variables.extend(gas::rows(interface));
    variables.extend(figures());
    variables.extend(shape());
    variables.extend(gains());
    variables.extend(numbers());
    variables.extend(stages());
    Model {
        identifier: "fluid",
        name: "Plimsoll.Fluid",
        description: "Free-surface flow in two dimensions by the moving particle semi-implicit method, per metre of width",
        units: quantities::units(),
        types: quantities::types(),
        variables,
        experiment: DefaultExperiment { stop: 1.0, step: 0.000_25 },
        directional_derivatives: true,
        annotations: vec![
            (
                "directionalDerivative",
                "fmi2GetDirectionalDerivative gives the sensitivity of the last step: the derivative of the mean load \
                 over the last fmi2DoStep by the motion at its end, which is minus added_mass over the length of the \
                 step for the rates and zero for positions and accelerations. Made for Newton iterations between \
                 communication points.",
            ),
            (
                "motion",
                "body.*.motion.* is the motion of a body at the end of the step that follows; unconnected it holds the body at \
                 its place in the scene.",
            ),
            ("load", "body.*.load.* is the mean over the communication step that ended (impulse divided by step)."),
        ],
    }
}

fn motions(interface: &Interface) -> Vec<Row> {
    let [positions, velocities, accelerations] = &MOTIONS;
    let position = family(interface, positions, |this: &FluidComponent, index| this.state.motion.position[index]);
    let velocity = family(interface, velocities, |this: &FluidComponent, index| this.state.motion.velocity[index]);
    let acceleration =
        family(interface, accelerations, |this: &FluidComponent, index| this.state.motion.acceleration[index]);
    let position =
        position.into_iter().map(|row| row.input(|this, index, value| this.state.motion.position[index] = value));
    let velocity =
        velocity.into_iter().map(|row| row.input(|this, index, value| this.state.motion.velocity[index] = value));
    let acceleration = acceleration
        .into_iter()
        .map(|row| row.input(|this, index, value| this.state.motion.acceleration[index] = value));
    position.chain(velocity).chain(acceleration).collect()
}

fn parameters() -> Vec<Row> {
    let own = [
        Row::real(3, "particle_spacing", "particle spacing; 0 takes the scene's", "Length", |this, _| {
            this.state.parameters.particle_spacing
        })
        .real_parameter(0.0, |this, _, value| this.state.parameters.particle_spacing = value)
        .within(0.0, f64::INFINITY),
        Row::integer(4, "threads", "threads of this instance's own pool; 0 takes the scene's number", |this, _| {
            this.state.parameters.threads
        })
        .integer_parameter(0, |this, _, value| this.state.parameters.threads = value)
        .within(0.0, 1024.0),
    ];
    scene_rows().into_iter().chain(own).chain(output_rows("particles")).collect()
}

/// A figure of the present state; 0 before initialisation.
fn figure(this: &FluidComponent, read: impl Fn(&Observables) -> f64) -> f64 {
    this.observables().map_or(0.0, read)
}

/// Figures at the scene's probes and gauges and in its regions, computed from the state when they are read.
fn places(interface: &Interface) -> Vec<Row> {
    let probe = |(index, name): (usize, &String)| {
        let reference = PROBE + index as Reference;
        let meaning = "pressure at a probe, mean over its patch and the last step";
        Row::real(reference, Interface::pressure(name), meaning, "Pressure", |this, index| {
            this.sensor(|matching| &matching.probes, index).mean
        })
        .at(index)
    };
    let largest = |(index, name): (usize, &String)| {
        let meaning = "largest pressure at a probe within the last step, mean over its patch";
        Row::real(LARGEST + index as Reference, Interface::largest(name), meaning, "Pressure", |this, index| {
            this.sensor(|matching| &matching.largest, index).largest
        })
        .at(index)
    };
    let impulse = |(index, name): (usize, &String)| {
        let meaning = "impulse per area of the pressure at a probe beyond its threshold, since the start";
        Row::real(IMPULSE + index as Reference, Interface::impulse(name), meaning, "PressureImpulse", |this, index| {
            this.sensor(|matching| &matching.impulses, index).impulse
        })
        .at(index)
    };
    let region = |(index, name): (usize, &String)| {
        let reference = REGION + index as Reference;
        Row::real(reference, Interface::mass(name), "water in a region", "Mass", |this, index| {
            this.figure_at(|matching| &matching.regions, |seen| &seen.region_masses, index)
        })
        .at(index)
    };
    let gauge = |(index, name): (usize, &String)| {
        let reference = GAUGE + index as Reference;
        Row::real(reference, Interface::level(name), "Y of the highest water at a gauge", "Length", |this, index| {
            this.figure_at(|matching| &matching.gauges, |seen| &seen.levels, index)
        })
        .at(index)
    };
    let probes = interface.probes.iter().enumerate().map(probe);
    let regions = interface.regions.iter().enumerate().map(region);
    let probes = probes.chain(interface.largest.iter().enumerate().map(largest));
    let probes = probes.chain(interface.impulses.iter().enumerate().map(impulse));
    probes.chain(regions).chain(interface.gauges.iter().enumerate().map(gauge)).collect()
}

/// Figures of the whole water, computed from the state when they are read.
fn figures() -> Vec<Row> {
    let row = |reference, name: &str, meaning: &str, kind, get| Row::real(reference, name, meaning, kind, get);
    vec![
        row(
            360,
            "wall.force_x",
            "force of the water on the fixed walls along X, mean over the last step",
            "Force",
            |this, _| figure(this, |seen| seen.wall_force.x),
        ),
        row(
            361,
            "wall.force_y",
            "force of the water on the fixed walls along Y, mean over the last step",
            "Force",
            |this, _| figure(this, |seen| seen.wall_force.y),
        ),
        row(362, "front.x", "largest X that coherent water reaches", "Length", |this, _| {
            figure(this, |seen| seen.front)
        }),
        row(363, "energy.kinetic", "kinetic energy of the water", "Energy", |this, _| {
            figure(this, |seen| seen.kinetic_energy)
        }),
        row(
            364,
            "energy.potential",
            "potential energy of the water above the origin, and in an attraction to it",
            "Energy",
            |this, _| figure(this, |seen| seen.potential_energy),
        ),
        row(365, "momentum.x", "momentum of the water along X", "Momentum", |this, _| {
            figure(this, |seen| seen.momentum.x)
        }),
        row(366, "momentum.y", "momentum of the water along Y", "Momentum", |this, _| {
            figure(this, |seen| seen.momentum.y)
        }),
        row(367, "centre.x", "X of the water's centre of mass", "Length", |this, _| figure(this, |seen| seen.centre.x)),
        row(368, "centre.y", "Y of the water's centre of mass", "Length", |this, _| figure(this, |seen| seen.centre.y)),
        row(369, "maximum_speed", "largest speed of a particle", "Velocity", |this, _| {
            figure(this, |seen| seen.maximum_speed)
        }),
    ]
}

/// How far the water reaches, and what of it is kept where nothing acts on it.
fn shape() -> Vec<Row> {
    let row = |reference, name: &str, meaning: &str, kind, get| Row::real(reference, name, meaning, kind, get);
    vec![
        row(370, "extent.left", "smallest X of all water", "Length", |this, _| figure(this, |seen| seen.extent[0].x)),
        row(371, "extent.bottom", "smallest Y of all water", "Length", |this, _| figure(this, |seen| seen.extent[0].y)),
        row(372, "extent.right", "largest X of all water", "Length", |this, _| figure(this, |seen| seen.extent[1].x)),
        row(373, "extent.top", "largest Y of all water", "Length", |this, _| figure(this, |seen| seen.extent[1].y)),
        row(374, "farthest", "largest distance of water from the origin", "Length", |this, _| {
            figure(this, |seen| seen.farthest)
        }),
        row(375, "angular_momentum", "angular momentum of the water about the origin", "AngularMomentum", |this, _| {
            figure(this, |seen| seen.angular_momentum)
        }),
        row(376, "area", "area of the water", "Area", |this, _| figure(this, |seen| seen.area)),
        row(377, "energy.total", "kinetic and potential energy of the water", "Energy", |this, _| {
            figure(this, |seen| seen.kinetic_energy + seen.potential_energy)
        }),
    ]
}

/// What changed momentum, angular momentum and energy of the water since the start: together all of it.
fn gains() -> Vec<Row> {
    let rows = |(index, (name, what)): (usize, &(&str, &str))| {
        let number = index as Reference;
        let reference = 420 + 2 * number;
        let meaning = |axis: &str| format!("impulse that the water was given along {axis} since the start: {what}");
        let x = Row::real(reference, format!("impulse.{name}.x"), meaning("X"), "Momentum", |this, index| {
            this.gain(index).impulse.x
        });
        let y = Row::real(reference + 1, format!("impulse.{name}.y"), meaning("Y"), "Momentum", |this, index| {
            this.gain(index).impulse.y
        });
        let meaning = format!("angular momentum about the origin that the water was given since the start: {what}");
        let name_angular = format!("impulse.{name}.angular");
        let angular =
            Row::real(440 + number, name_angular, meaning, "AngularMomentum", |this, index| this.gain(index).angular);
        let meaning = format!("energy that the water was given since the start: {what}");
        let work =
            Row::real(460 + number, format!("work.{name}"), meaning, "Energy", |this, index| this.gain(index).energy);
        [x.at(index), y.at(index), angular.at(index), work.at(index)]
    };
    Gains::NAMES.iter().enumerate().flat_map(rows).collect()
}

/// Counts and what the solver said of the last step.
fn numbers() -> Vec<Row> {
    fn count(number: usize) -> i32 {
        i32::try_from(number).unwrap_or(i32::MAX)
    }
    vec![
        Row::real(
            380,
            "time_step.suggested",
            "time step that the stability limits of the scheme would allow next",
            "Duration",
            |this, _| this.state.progress.as_ref().map_or(0.0, |progress| progress.report.suggested_step),
        ),
        Row::integer(381, "particles.count", "particles in the domain", |this, _| {
            this.state.progress.as_ref().map_or(0, |progress| count(progress.state.positions.len()))
        }),
        Row::integer(382, "particles.lost", "particles that left the domain and were removed", |this, _| {
            this.state.progress.as_ref().map_or(0, |progress| count(progress.state.lost))
        }),
        Row::integer(383, "solver.iterations", "iterations of the pressure solver in the last step", |this, _| {
            this.state.progress.as_ref().map_or(0, |progress| progress.report.iterations)
        }),
        Row::integer(384, "solver.substeps", "internal time steps in the last step", |this, _| {
            this.state.progress.as_ref().map_or(0, |progress| progress.report.substeps)
        }),
        Row::integer(
            385,
            "solver.responses",
            "unit responses that the last step rests on, one per coordinate that answers to the load",
            |this, _| this.state.progress.as_ref().map_or(0, |progress| progress.report.responses),
        ),
        Row::integer(
            386,
            "cells.jumps",
            "cells so far that changed faster than a step can follow, as where voids close in a splash (scheme voronoi)",
            |this, _| {
                let jumps = this.state.progress.as_ref().map_or(0, |progress| progress.state.jumps);
                i32::try_from(jumps).unwrap_or(i32::MAX)
            },
        ),
    ]
}

/// Wall-clock times. They are the only outputs that differ from run to run.
fn stages() -> Vec<Row> {
    let row = |reference, name: &str, stage: &str, get| {
        let meaning = format!(
            "wall-clock time spent on {stage} by this instance, repeated steps included; not part of the state"
        );
        Row::real(reference, name, meaning, "Duration", get).discrete()
    };
    vec![
        row(400, "stage.neighbours", "prediction, walls and neighbour search", |this, _| {
            this.seconds.stages.neighbours
        }),
        row(401, "stage.assembly", "density, surface and the pressure system", |this, _| this.seconds.stages.assembly),
        row(402, "stage.solve", "the pressure solve", |this, _| this.seconds.stages.solve),
        row(403, "stage.gradient", "pressure gradient, correction and shifting", |this, _| {
            this.seconds.stages.gradient
        }),
        row(404, "stage.other", "loads and checks", |this, _| this.seconds.stages.other),
        row(405, "stage.output", "field frames", |this, _| this.seconds.output),
    ]
}
