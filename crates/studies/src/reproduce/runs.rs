//! The runs themselves, and the reports made of them.

use super::{
    CabinArguments, Common, Model, PaperArguments, Reproduce, StudyArguments, cabin, notes, page, plate, study,
};
use crate::{FinishedRun, Program, Request};
use maud::html;
use report::html::{self, Failure};
use report::record::{Recipe, Series, Status, Summary};
use report::{Band, prepare_font};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

const CABIN: &str = "damaged_cabin";
const PLATE: &str = "dam_break_plate";
/// Published band of the plate's tip beside the scene.
const BAND: &str = "reference/dam_break_plate_band.csv";

/// Runs what is asked for and writes its report; gives the page and whether every run reached its end.
///
/// # Errors
/// A run that cannot start, or a page that cannot be written.
pub fn run(what: &Reproduce, program: &dyn Program, interrupted: &AtomicBool) -> Result<(PathBuf, bool), Failure> {
    prepare_font();
    match what {
        Reproduce::Cabin(arguments) => cabins(arguments, program, interrupted),
        Reproduce::Paper(arguments) => paper(arguments, program, interrupted),
        Reproduce::Stiffness(arguments) => stiffness(arguments, program, interrupted),
    }
}

fn folder(common: &Common, name: &str) -> PathBuf {
    common.out.clone().unwrap_or_else(|| Path::new("results").join(format!("reproduce_{name}")))
}

fn cabins(
    arguments: &CabinArguments,
    program: &dyn Program,
    interrupted: &AtomicBool,
) -> Result<(PathBuf, bool), Failure> {
    let folder = folder(&arguments.common, "cabin");
    let mut set = vec![format!("fluid.spacing={}", arguments.spacing), format!("run.end={}", arguments.end)];
    set.extend(arguments.variant.changes());
    let models = models(&set, &folder, &arguments.common, program, interrupted)?;
    let others = arguments.against.iter().map(|folder| earlier(folder)).collect::<Result<Vec<_>, _>>()?;
    let section = page::section(&models, &others, &folder)?;
    let text = html::page("The damaged cabin, models I to IV", &html! { (section) (notes::section()) });
    Ok((html::write(&folder, &text)?, models.iter().all(|model| complete(&model.done))))
}

fn paper(
    arguments: &PaperArguments,
    program: &dyn Program,
    interrupted: &AtomicBool,
) -> Result<(PathBuf, bool), Failure> {
    let folder = folder(&arguments.common, "paper");
    let end = |set: &mut Vec<String>| set.extend(arguments.end.map(|end| format!("run.end={end}")));
    let mut plates = Vec::new();
    for spacing in &arguments.plate {
        let mut set = vec![format!("fluid.spacing={spacing}")];
        end(&mut set);
        let out = folder.join(format!("plate-{:.0}um", 1e6 * spacing));
        plates.extend(once(PLATE, set, out, &arguments.common, program, interrupted)?);
    }
    let mut set = vec![format!("fluid.spacing={}", arguments.spacing)];
    end(&mut set);
    let models = models(&set, &folder, &arguments.common, program, interrupted)?;
    let (first, second) = (
        plate::section(&plates, Some(band(&scenes(program)?.join(BAND))?), &folder)?,
        page::section(&models, &[], &folder)?,
    );
    let body = html! { (first) h2 { "The damaged cabin" } (second) (notes::section()) };
    let title = "Flooding of a damaged cabin with a flexible bulkhead: the paper's results, reproduced";
    let all = plates.iter().chain(models.iter().map(|model| &model.done)).all(complete);
    Ok((html::write(&folder, &html::page(title, &body))?, all))
}

fn stiffness(
    arguments: &StudyArguments,
    program: &dyn Program,
    interrupted: &AtomicBool,
) -> Result<(PathBuf, bool), Failure> {
    let folder = folder(&arguments.common, "stiffness");
    let parts = if arguments.parts.is_empty() { study::Part::ALL.to_vec() } else { arguments.parts.clone() };
    let mut all = Vec::new();
    for point in parts.into_iter().flat_map(study::Part::points) {
        let mut runs = Vec::new();
        for repeat in 1..=arguments.repeats {
            let mut set = vec![format!("fluid.spacing={}", arguments.spacing), format!("run.end={}", arguments.end)];
            set.push("output.interval=0".to_string());
            set.extend(study::changes(&point, repeat));
            let out = folder.join(format!("{:?}-{}-{repeat}", point.part, point.label).to_lowercase());
            runs.extend(once(CABIN, set, out, &arguments.common, program, interrupted)?);
        }
        all.push((point, runs));
    }
    let text = html::page("Load of the bulkhead against its stiffness", &study::section(&all)?);
    let complete = all.iter().flat_map(|(_, runs)| runs).all(complete);
    Ok((html::write(&folder, &text)?, complete))
}

fn complete(done: &FinishedRun) -> bool {
    done.summary.status == Status::Complete
}

/// The four models; fewer when the user ended them.
fn models(
    set: &[String],
    folder: &Path,
    common: &Common,
    program: &dyn Program,
    interrupted: &AtomicBool,
) -> Result<Vec<Model>, Failure> {
    let mut models = Vec::new();
    for (name, youngs_modulus, change) in cabin::MODELS {
        let mut set = set.to_vec();
        set.push(change.to_string());
        let done = once(CABIN, set, folder.join(format!("model-{name}")), common, program, interrupted)?;
        models.extend(done.map(|done| Model { name, youngs_modulus, done }));
    }
    Ok(models)
}

/// The models that an earlier run left in a folder, with their spacing.
fn earlier(folder: &Path) -> Result<(f64, Vec<Model>), Failure> {
    let mut models = Vec::new();
    for (name, youngs_modulus, _) in cabin::MODELS {
        let done = load(&folder.join(format!("model-{name}")))?;
        models.push(Model { name, youngs_modulus, done });
    }
    let spacing = models.first().and_then(|model| model.done.summary.spacing).unwrap_or(f64::NAN);
    Ok((spacing, models))
}

/// One run; nothing once the user has ended them. With `keep` a complete one in the folder stays as it is.
fn once(
    scene: &str,
    set: Vec<String>,
    out: PathBuf,
    common: &Common,
    program: &dyn Program,
    interrupted: &AtomicBool,
) -> Result<Option<FinishedRun>, Failure> {
    if common.keep
        && Recipe::read(&out)?.is_some_and(|recipe| recipe.is_whole())
        && let Ok(done) = load(&out)
        && complete(&done)
    {
        return Ok(Some(done));
    }
    if interrupted.load(Ordering::Relaxed) {
        return Ok(None);
    }
    program.tell(&out.display().to_string());
    let request = Request {
        scene: scene.to_string(),
        set,
        out,
        threads: common.threads,
        resume: common.keep,
        overwrite: common.overwrite,
        ..Request::default()
    };
    let done = program.run(&request, interrupted)?;
    if let Some(error) = &done.summary.error {
        program.tell(&format!("error: {}: {error}", done.folder.display()));
    }
    Ok(Some(done))
}

fn load(folder: &Path) -> Result<FinishedRun, Failure> {
    let summary = Summary::read(&folder.join("summary.json"))?;
    let series = Series::read(&folder.join("results.csv"))?;
    Ok(FinishedRun { folder: folder.to_path_buf(), summary, series })
}

/// What is read of the published band: names as in the file.
#[derive(serde::Deserialize)]
struct BandRow {
    t_s: f64,
    min_m: f64,
    max_m: f64,
}

/// Smallest and largest published displacement of the tip \[mm\].
fn band(path: &Path) -> Result<Band, Failure> {
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(path)?;
    let mut points = Vec::new();
    for row in reader.deserialize() {
        let row: BandRow = row?;
        points.push((row.t_s, 1e3 * row.min_m, 1e3 * row.max_m));
    }
    Ok(Band { label: "published".to_string(), points })
}

/// The folder of the scenes.
fn scenes(program: &dyn Program) -> Result<PathBuf, Failure> {
    let files = program.scenes()?;
    let folder = files.first().and_then(|file| file.parent());
    Ok(folder.ok_or("there are no scenes")?.to_path_buf())
}
