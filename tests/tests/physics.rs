//! Figures through the C ABI that have an exact value, directional derivatives, and field frames.
#![allow(missing_docs, clippy::unwrap_used, reason = "test")]

use components::{ACCELERATION, FluidComponent, Interface, LOAD, POSITION, StructureComponent, VELOCITY};
use fmi::Component;
use fmi2::ffi::Status;
use plimsoll_tests::{Library, Packed, Slave};

fn slave<'a, C: Component<Interface = Interface>>(library: &'a Library, scene: &str, overrides: &str) -> Slave<'a> {
    let packed = Packed::of(&[scene]);
    let slave =
        Slave::new(library, &packed.guid::<C>(), Some(&packed.location())).unwrap_or_else(|why| panic!("{why:?}"));
    assert_eq!(slave.set_text(1, scene), Status::OK);
    assert_eq!(slave.set_text(2, overrides), Status::OK);
    slave
}

/// One mode under a constant modal load: q = Q / w^2 (1 - cos w t).
#[test]
fn structure_under_a_constant_load_follows_the_exact_answer() {
    let library = Library::load("structure_fmu").unwrap();
    let slave = slave::<StructureComponent>(&library, "free_decay", "body.0.member.0.initial_modes = []");
    assert_eq!(slave.initialise(0.0), Status::OK);
    // 1.8751040687^2 sqrt(EJ / rho_l) / l^2 with EJ = 1e6 0.012^3 / 12, rho_l = 30, l = 0.08.
    let frequency = 1.875_104_068_711_961_f64.powi(2) * (1e6 * 0.012_f64.powi(3) / 12.0 / 30.0).sqrt() / 0.0064;
    let (load, step) = (0.05, 1e-4);
    assert_eq!(slave.set_reals(&[LOAD + 3], &[load]), Status::OK);
    let mut worst: f64 = 0.0;
    for n in 0..2000 {
        assert_eq!(slave.step(f64::from(n) * step, step), Status::OK);
        let time = f64::from(n + 1) * step;
        let exact = load / frequency.powi(2) * (1.0 - (frequency * time).cos());
        worst = worst.max((slave.reals(&[POSITION + 3])[0] - exact).abs());
    }
    let size = load / frequency.powi(2);
    // Newmark's period error is (w h)^2 / 12 = 1.2e-6; over 7.6 rad that is 1e-5 of the amplitude.
    assert!(worst < 2e-5 * size, "{worst} of {size}");
}

/// Column by column: the load of one coordinate is varied, the step repeated from the saved state.
#[test]
fn directional_derivatives_are_those_of_the_step() {
    let library = Library::load("structure_fmu").unwrap();
    let slave = slave::<StructureComponent>(&library, "dam_break_plate", "");
    assert_eq!(slave.initialise(0.0), Status::OK);
    let unknowns: Vec<u32> = [POSITION, VELOCITY, ACCELERATION].iter().flat_map(|&first| first..first + 6).collect();
    let mut result = vec![0.0; unknowns.len()];
    let derivative = |known: u32, result: &mut [f64]| {
        // SAFETY: a live handle, arrays of the lengths passed.
        unsafe {
            (library.get_directional_derivative)(
                slave.handle,
                unknowns.as_ptr(),
                unknowns.len(),
                &known,
                1,
                &1.0,
                result.as_mut_ptr(),
            )
        }
    };
    assert_eq!(derivative(LOAD + 3, &mut result), Status::ERROR, "there was no step yet");
    let (step, base) = (0.001, [0.0, 0.0, 0.0, 2.0, -1.0, 0.5]);
    let references: Vec<u32> = (LOAD..LOAD + 6).collect();
    let state = slave.save();
    for column in 0..6 {
        let run = |change: f64| {
            let mut load = base;
            load[column] += change;
            assert_eq!(slave.restore(&state), Status::OK);
            assert_eq!(slave.set_reals(&references, &load), Status::OK);
            assert_eq!(slave.step(0.0, step), Status::OK);
            slave.reals(&unknowns)
        };
        let (plus, minus) = (run(0.5), run(-0.5));
        run(0.0);
        assert_eq!(derivative(LOAD + column as u32, &mut result), Status::OK, "{:?}", slave.messages());
        for (row, &value) in result.iter().enumerate() {
            let difference = plus[row] - minus[row];
            assert!((value - difference).abs() <= 1e-9 * value.abs() + 1e-15, "{row} {column}: {value} {difference}");
        }
        assert_eq!(result.iter().any(|&value| value != 0.0), column >= 3, "a clamped cabin does not answer");
    }
    assert_eq!(slave.free(state), Status::OK);
}

#[test]
fn frames_are_written_for_accepted_states_and_at_the_end() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("new/frames");
    let (fluid, structure) = (Library::load("fluid_fmu").unwrap(), Library::load("structure_fmu").unwrap());
    let water = slave::<FluidComponent>(&fluid, "dam_break_plate", "fluid.spacing = 0.012");
    let plate = slave::<StructureComponent>(&structure, "dam_break_plate", "");
    for slave in [&water, &plate] {
        assert_eq!(slave.set_text(5, target.to_str().unwrap()), Status::OK);
        assert_eq!(slave.set_reals(&[6], &[0.002]), Status::OK);
        assert_eq!(slave.initialise(0.0), Status::OK, "{:?}", slave.messages());
        for n in 0..5 {
            let state = slave.save();
            for _iteration in 0..2 {
                assert_eq!(slave.restore(&state), Status::OK);
                assert_eq!(slave.step(0.001 * f64::from(n), 0.001), Status::OK, "{:?}", slave.messages());
            }
            assert_eq!(slave.free(state), Status::OK);
        }
        // SAFETY: a live handle.
        assert_eq!(unsafe { (slave.library.terminate)(slave.handle) }, Status::OK);
    }
    let mut names: Vec<String> =
        std::fs::read_dir(&target).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    let numbered = |field: &str| (0..4).map(move |number| format!("{field}_{number:06}.vtu")).collect::<Vec<_>>();
    let mut expected = ["particles.pvd", "structure.pvd", "walls.vtu"].map(str::to_string).to_vec();
    expected.extend(numbered("particles").into_iter().chain(numbered("structure")));
    expected.sort();
    assert_eq!(names, expected);
    let frame = frames::read_frame(&target.join("particles_000003.vtu")).unwrap();
    assert_eq!(frame.points.len(), water.integer(381) as usize);
    assert!(frame.scalar("pressure").unwrap().iter().all(|pressure| pressure.is_finite()));
    let text = std::fs::read_to_string(target.join("particles.pvd")).unwrap();
    assert!(text.contains(r#"timestep="0.005""#), "{text}");
    let outline = frames::read_frame(&target.join("structure_000000.vtu")).unwrap();
    let highest = outline.points.iter().map(|point| point[1]).fold(0.0, f32::max);
    assert_eq!(highest, 0.08, "the plate's tip");
}

/// The weight of the water rests on the floor, and the pressure of a column at rest is known.
#[test]
fn water_at_rest_weighs_what_it_weighs() {
    let library = Library::load("fluid_fmu").unwrap();
    let slave = slave::<FluidComponent>(&library, "hydrostatic", "fluid.spacing = 0.025");
    assert_eq!(slave.initialise(0.0), Status::OK);
    let (mut force, mut pressure, count) = (0.0, 0.0, 50);
    for n in 0..count {
        assert_eq!(slave.step(0.01 * f64::from(n), 0.01), Status::OK, "{:?}", slave.messages());
        let values = slave.reals(&[361, 6_000_000]);
        force += values[0] / f64::from(count);
        pressure += values[1] / f64::from(count);
    }
    let exact = 1000.0 * 9.81 * 0.5;
    assert!((force + exact).abs() < 0.05 * exact, "force {force}, expected {}", -exact);
    assert!((pressure - exact).abs() < 0.05 * exact, "pressure {pressure}, expected {exact}");
    assert_eq!(slave.integer(382), 0, "particles lost");
}
