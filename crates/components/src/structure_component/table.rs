//! The structure's table of variables.

use super::StructureComponent;
use crate::parameters::{output_rows, scene_rows};
use crate::{LOAD, interface, quantities};
use fmi2::{DefaultExperiment, Model, Variable};

type Row = Variable<StructureComponent>;

/// Description and table for an interface with this number of modes.
pub(super) fn model(modes: usize) -> Model<StructureComponent> {
    let mut variables = parameters();
    let getters = [
        |this: &StructureComponent, index: usize| this.state.outputs.motion.position[index],
        |this: &StructureComponent, index: usize| this.state.outputs.motion.velocity[index],
        |this: &StructureComponent, index: usize| this.state.outputs.motion.acceleration[index],
        |this: &StructureComponent, index: usize| this.state.load[index],
    ];
    let set_load = |this: &mut StructureComponent, index: usize, value: f64| this.state.load[index] = value;
    let meeting = interface::variables(modes, getters);
    let (loads, motions): (Vec<_>, Vec<_>) = meeting.into_iter().partition(|(family, _)| *family == LOAD);
    variables.extend(loads.into_iter().map(|(_, variable)| variable.input(set_load)));
    let [accelerations, masses] = interface::answer_variables(
        modes,
        |this: &StructureComponent, index| this.state.load_acceleration[index],
        |this: &StructureComponent, index| this.state.added_mass[index],
    );
    let set_acceleration =
        |this: &mut StructureComponent, index: usize, value: f64| this.state.load_acceleration[index] = value;
    let set_mass = |this: &mut StructureComponent, index: usize, value: f64| this.state.added_mass[index] = value;
    variables.extend(accelerations.into_iter().map(|variable| variable.input(set_acceleration)));
    variables.extend(masses.into_iter().map(|variable| variable.input(set_mass)));
    variables.extend(motions.into_iter().map(|(_, variable)| variable));
    variables.extend(outputs());
    Model {
        identifier: "structure",
        name: "Plimsoll.Structure",
        description: "Rigid cabin with an elastic beam in modal form, per metre of width",
        units: quantities::units(),
        types: quantities::types(),
        variables,
        experiment: DefaultExperiment { stop: 1.0, step: 0.000_25 },
        directional_derivatives: true,
        annotations: vec![
            (
                "directionalDerivative",
                "fmi2GetDirectionalDerivative gives the sensitivity of the last step: the derivative of the motion at \
                 the end of the last fmi2DoStep by the load held over that step. It is the inverse tangent of the \
                 implicit step, made for Newton iterations between communication points.",
            ),
            (
                "load",
                "load.* is the mean over the communication step that follows (impulse divided by step), held during it.",
            ),
            (
                "added_mass",
                "With added_mass[i,j] and load.a* connected the structure steps under the load \
                 load.* - added_mass (a - load.a*), a its own mean acceleration over the step: an exchange without \
                 iteration is then stable whatever the added mass. Unconnected they are zero and change nothing.",
            ),
        ],
    }
}

fn parameters() -> Vec<Row> {
    let own =
        [Row::real(7, "youngs_modulus", "Young's modulus of the beam; 0 takes the scene's", "Pressure", |this, _| {
            this.state.parameters.youngs_modulus
        })
        .real_parameter(0.0, |this, _, value| this.state.parameters.youngs_modulus = value)
        .within(0.0, f64::INFINITY)];
    scene_rows().into_iter().chain(output_rows("outline")).chain(own).collect()
}

fn outputs() -> Vec<Row> {
    vec![
        Row::real(
            300,
            "deflection.middle",
            "deflection of the beam's middle along +x of the body",
            "Displacement",
            |this, _| this.state.outputs.middle,
        ),
        Row::real(
            301,
            "deflection.tip",
            "deflection of the beam's end at +y along +x of the body",
            "Displacement",
            |this, _| this.state.outputs.tip,
        ),
        Row::real(302, "energy.kinetic", "kinetic energy", "Energy", |this, _| this.state.outputs.kinetic),
        Row::real(303, "energy.potential", "energy of weight and bending", "Energy", |this, _| {
            this.state.outputs.potential
        }),
        Row::integer(304, "solver.iterations", "Newton-Raphson iterations of the last step", |this, _| {
            this.state.outputs.iterations
        }),
        Row::integer(
            305,
            "solver.unknowns",
            "coordinates solved for in the last step: free ones and modes",
            |this, _| this.state.outputs.unknowns,
        ),
        Row::real(306, "momentum.x", "momentum of cabin and beam along X", "Momentum", |this, _| {
            this.state.outputs.momentum[0]
        }),
        Row::real(307, "momentum.y", "momentum of cabin and beam along Y", "Momentum", |this, _| {
            this.state.outputs.momentum[1]
        }),
        Row::real(
            320,
            "stage.step",
            "wall-clock time spent in steps by this instance, repeated steps included; not part of the state",
            "Duration",
            |this, _| this.seconds,
        )
        .discrete(),
    ]
}
