//! The structure's table of variables.

use super::StructureComponent;
use crate::interface::{ANSWER, DEFLECTION, LOADS, MODULUS, MOTIONS, added_masses, family};
use crate::parameters::{output_rows, scene_rows};
use crate::{Interface, quantities};
use fmi::{DefaultExperiment, Model, Reference, Variable};

type Row = Variable<StructureComponent>;

/// Description and table for an interface.
pub(super) fn model(interface: &Interface) -> Model<StructureComponent> {
    let mut variables = parameters(interface);
    let loads = family(interface, &LOADS, |this: &StructureComponent, index| this.state.load[index]);
    variables.extend(loads.into_iter().map(|row| row.input(|this, index, value| this.state.load[index] = value)));
    let answers = family(interface, &ANSWER, |this: &StructureComponent, index| this.state.load_acceleration[index]);
    let set_answer =
        |this: &mut StructureComponent, index: usize, value: f64| this.state.load_acceleration[index] = value;
    variables.extend(answers.into_iter().map(|row| row.input(set_answer)));
    let masses = added_masses(interface, |this: &StructureComponent, index| this.state.added_mass[index]);
    variables.extend(masses.into_iter().map(|row| row.input(StructureComponent::set_added_mass)));
    let [positions, velocities, accelerations] = &MOTIONS;
    variables.extend(family(interface, positions, |this: &StructureComponent, index| {
        this.state.outputs.motion.position[index]
    }));
    variables.extend(family(interface, velocities, |this: &StructureComponent, index| {
        this.state.outputs.motion.velocity[index]
    }));
    variables.extend(family(interface, accelerations, |this: &StructureComponent, index| {
        this.state.outputs.motion.acceleration[index]
    }));
    variables.extend(deflections(interface));
    variables.extend(outputs());
    Model {
        identifier: "structure",
        name: "Plimsoll.Structure",
        description: "Rigid bodies with elastic beams in modal form, per metre of width",
        units: quantities::units(),
        types: quantities::types(),
        variables,
        experiment: DefaultExperiment { stop: 1.0, step: 0.000_25 },
        directional_derivatives: true,
        annotations: annotations(),
    }
}

/// What a caller should know that the standard has no place for.
fn annotations() -> Vec<(&'static str, &'static str)> {
    vec![
        (
            "directionalDerivative",
            "fmi2GetDirectionalDerivative gives the sensitivity of the last step: the derivative of the motion at \
                 the end of the last fmi2DoStep by the load held over that step. It is the inverse tangent of the \
                 implicit step, made for Newton iterations between communication points.",
        ),
        (
            "load",
            "body.*.load.* is the mean over the communication step that follows (impulse divided by step), held during it.",
        ),
        (
            "added_mass",
            "With added_mass.* and load.a* connected the structure steps under the load \
                 load.* - added_mass (a - load.a*), a its own mean acceleration over the step: an exchange without \
                 iteration is then stable whatever the added mass. Unconnected they are zero and change nothing.",
        ),
    ]
}

fn parameters(interface: &Interface) -> Vec<Row> {
    let modulus = |(index, (body, member))| {
        let meaning = "Young's modulus; 0 takes the scene's";
        let name = Interface::youngs_modulus(body, member);
        Row::real(MODULUS + index as Reference, name, meaning, "Pressure", |this, index| {
            this.state.parameters.youngs_moduli[index]
        })
        .real_parameter(0.0, |this, index, value| this.state.parameters.youngs_moduli[index] = value)
        .within(0.0, f64::INFINITY)
        .at(index)
    };
    let own = interface.members().enumerate().map(modulus);
    scene_rows().into_iter().chain(output_rows("outline")).chain(own).collect()
}

fn deflections(interface: &Interface) -> Vec<Row> {
    let of_member = |(index, (body, member))| {
        let [middle, tip] = Interface::deflections(body, member);
        let reference = DEFLECTION + 2 * index as Reference;
        let of_middle = "deflection of the beam's middle along +x of the body";
        let of_tip = "deflection of the beam's end at +y along +x of the body";
        [
            Row::real(reference, middle, of_middle, "Displacement", |this, index| {
                this.state.outputs.deflections[index][0]
            })
            .at(index),
            Row::real(reference + 1, tip, of_tip, "Displacement", |this, index| {
                this.state.outputs.deflections[index][1]
            })
            .at(index),
        ]
    };
    interface.members().enumerate().flat_map(of_member).collect()
}

fn outputs() -> Vec<Row> {
    vec![
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
        Row::real(306, "momentum.x", "momentum of the bodies along X", "Momentum", |this, _| {
            this.state.outputs.momentum[0]
        }),
        Row::real(307, "momentum.y", "momentum of the bodies along Y", "Momentum", |this, _| {
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
