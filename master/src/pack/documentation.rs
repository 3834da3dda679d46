//! documentation/index.html of an FMU: what it solves, and the table of its variables.

use fmi::{Access, Causality, Model, Variable};

/// Equations of the fluid.
pub const FLUID: &str = include_str!("../../documentation/fluid.html");
/// Equations of the structure.
pub const STRUCTURE: &str = include_str!("../../documentation/structure.html");

const STYLE: &str = "body { font-family: sans-serif; max-width: 60em; margin: 2em auto; line-height: 1.4 } \
    table { border-collapse: collapse } td, th { border: 1px solid #ccc; padding: 0.2em 0.5em; text-align: left }";

/// The whole page.
pub fn page<C>(model: &Model<C>, equations: &str) -> String {
    let (name, about) = (escaped(model.name), escaped(model.description));
    let rows = model.variables.iter().map(|variable| row(model, variable)).collect::<String>();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{name}</title>\n\
         <style>{STYLE}</style>\n</head>\n<body>\n<h1>{name}</h1>\n<p>{about}</p>\n{equations}\n\
         <h2>Variables</h2>\n<table>\n<tr><th>name</th><th>role</th><th>type</th><th>unit</th><th>start</th>\
         <th>meaning</th></tr>\n{rows}</table>\n</body>\n</html>\n"
    )
}

fn row<C>(model: &Model<C>, variable: &Variable<C>) -> String {
    let unit = |simple_type: Option<&str>| {
        let known = model.types.iter().find(|simple| Some(simple.name) == simple_type);
        known.map_or("1", |simple| simple.unit).to_string()
    };
    let text = |start: Option<String>| start.unwrap_or_else(|| "-".to_string());
    let (kind, unit, start) = match &variable.access {
        Access::Real { simple_type, start, .. } => ("Real", unit(*simple_type), text(start.map(|x| x.to_string()))),
        Access::Integer { start, .. } => ("Integer", "1".to_string(), text(start.map(|x| x.to_string()))),
        Access::Text { start, .. } => ("String", "-".to_string(), text(start.map(|x| format!("\"{x}\"")))),
    };
    let role = match variable.causality {
        Causality::Parameter => "parameter",
        Causality::Input => "input",
        Causality::Output => "output",
    };
    let cells = [&variable.name, role, kind, &unit, &start, &variable.description];
    format!("<tr>{}</tr>\n", cells.map(|cell| format!("<td>{}</td>", escaped(cell))).concat())
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
