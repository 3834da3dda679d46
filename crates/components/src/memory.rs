//! What a scene needs of memory, compared with what is free before any is taken: an allocation that fails ends the process
//! without a word, and one that does not fail may end another.

use crate::Error;
use scene::Scene;

/// Memory of the program whatever its particles \[bytes\], as measured.
pub const PROGRAM: f64 = 5e7;
/// Memory by particle of water alone, and beside a structure, which takes steps again \[bytes\], as measured from 10^4 to
/// 10^5 particles.
const ALONE: f64 = 1050.0;
const COUPLED: f64 = 2200.0;
/// Memory by particle while the pictures of a report are drawn \[bytes\], as measured: a vector picture of several moments.
pub const PICTURES: f64 = 4300.0;

/// Memory of a run by particle \[bytes\]: water, its saved states, and, where frames are written, pictures of them.
pub fn by_particle(scene: &Scene) -> f64 {
    let water = if !scene.body.is_empty() { COUPLED } else { ALONE };
    water + if scene.output.interval > 0.0 { PICTURES } else { 0.0 }
}

/// Particles of a scene by its area of water and its spacing; 0 without water.
pub fn particles(scene: &Scene) -> f64 {
    let Some(fluid) = &scene.fluid else { return 0.0 };
    let area: f64 = fluid.water.iter().map(scene::Polygon::area).sum();
    area / fluid.spacing.powi(2)
}

/// Refuses a scene whose run needs more memory than is free, where the system tells it.
///
/// # Errors
/// The numbers, and the spacing for which the memory is enough.
pub fn check_run(scene: &Scene) -> Result<(), Error> {
    free().map_or(Ok(()), |free| check_against(scene, by_particle(scene), free))
}

/// The same for the water alone, without saved states and pictures: what an FMU knows of, and takes at once.
pub(crate) fn check_water(scene: &Scene) -> Result<(), Error> {
    free().map_or(Ok(()), |free| check_against(scene, ALONE, free))
}

fn check_against(scene: &Scene, by_particle: f64, free: f64) -> Result<(), Error> {
    let (count, Some(fluid)) = (particles(scene), &scene.fluid) else { return Ok(()) };
    let needed = count * by_particle;
    if needed <= free {
        return Ok(());
    }
    let enough = fluid.spacing * (needed / free.max(1.0)).sqrt();
    let (needed, free) = (needed / 1e9, free / 1e9);
    Err(Error::Value {
        key: "fluid.spacing".to_string(),
        got: fluid.spacing.to_string(),
        expected: format!(
            "at least {enough:.3e} on this machine: about {count:.3e} particles need {needed:.1} GB of memory, and {free:.1} GB \
             are free"
        ),
    })
}

/// Memory that this process can still take \[bytes\]: of the machine, of its control group, and within its own limit.
#[cfg(target_os = "linux")]
fn free() -> Option<f64> {
    let read = |path: &str| std::fs::read_to_string(path).ok();
    let number = |path: &str| read(path)?.trim().parse::<f64>().ok();
    let machine = read("/proc/meminfo").and_then(|text| kilobytes(&text, "MemAvailable:"));
    let group = |limit: &str, used: &str| Some(number(limit)? - number(used)?);
    let second = group("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current");
    let first = group("/sys/fs/cgroup/memory/memory.limit_in_bytes", "/sys/fs/cgroup/memory/memory.usage_in_bytes");
    let limit = read("/proc/self/limits").and_then(|text| address_space(&text));
    let taken = read("/proc/self/status").and_then(|text| kilobytes(&text, "VmSize:"));
    let own = limit.zip(taken).map(|(limit, taken)| limit - taken);
    [machine, second, first, own].into_iter().flatten().map(|bytes| bytes.max(0.0)).reduce(f64::min)
}

#[cfg(not(target_os = "linux"))]
fn free() -> Option<f64> {
    None
}

/// The number of a line `key NUMBER kB` \[bytes\].
#[cfg(any(target_os = "linux", test))]
fn kilobytes(text: &str, key: &str) -> Option<f64> {
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    line.split_whitespace().next()?.parse::<f64>().ok().map(|number| 1024.0 * number)
}

/// The soft limit of the address space \[bytes\]; none where there is none.
#[cfg(any(target_os = "linux", test))]
fn address_space(text: &str) -> Option<f64> {
    let line = text.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    line.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tank(spacing: f64) -> Scene {
        let text = format!(
            "title = 't'\n[run]\nend = 1.0\ncommunication_step = 0.01\n[fluid]\nspacing = {spacing}\n\
             water = [{{ polygon = [[0,0],[2,0],[2,1],[0,1]] }}]\nwall = [{{ points = [[0,2],[0,0],[2,0],[2,2]] }}]\n"
        );
        Scene::from_str(&text, "t.toml").unwrap()
    }

    #[test]
    fn a_scene_that_needs_more_than_is_free_is_refused_with_numbers() {
        // 2 m2 at 1 mm: 2e6 particles of 950 bytes.
        assert!(check_against(&tank(0.001), 950.0, 1.9e9).is_ok());
        let message = check_against(&tank(0.001), 950.0, 1.9e9 / 4.0).unwrap_err().to_string();
        let expected = "fluid.spacing = 0.001: expected at least 2.000e-3 on this machine: about 2.000e6 particles need 1.9 GB \
                        of memory, and 0.5 GB are free";
        assert_eq!(message, expected);
    }

    #[test]
    fn more_than_any_machine_has_is_refused_before_it_is_taken() {
        let vast = tank(0.001);
        let water = vec![scene::Polygon { polygon: vec![[0.0, 0.0], [1e6, 0.0], [1e6, 1e6], [0.0, 1e6]] }];
        let vast = Scene { fluid: vast.fluid.map(|fluid| scene::Fluid { water, ..fluid }), ..vast };
        let message = crate::fluid_set_up(&vast).unwrap_err().to_string();
        assert!(cfg!(not(target_os = "linux")) || message.contains("about 1.000e18 particles need"), "{message}");
    }

    #[test]
    fn a_coupled_run_with_pictures_needs_more() {
        let alone = Scene { output: scene::Output { interval: 0.0, ..tank(0.1).output }, ..tank(0.1) };
        assert_eq!((by_particle(&alone), by_particle(&tank(0.1))), (1050.0, 5350.0));
    }

    #[test]
    fn numbers_of_the_system_are_read() {
        assert_eq!(kilobytes("MemTotal: 9 kB\nMemAvailable:     12 kB\n", "MemAvailable:"), Some(12288.0));
        let limits = "Limit Soft Limit Hard Limit Units\nMax address space  4096000  unlimited  bytes\n";
        assert_eq!(address_space(limits), Some(4096000.0));
        assert_eq!(address_space(&limits.replace("4096000", "unlimited")), None);
    }
}
