//! The ranges of the values of bodies and members.

use crate::validate::Checker;
use crate::{Body, Error, Freedom, Member, identifier};
use digits::six;
use keys::ABOVE_ZERO;

/// Checks every number of the bodies, and that their names differ.
pub(crate) fn validate_bodies(check: &Checker, bodies: &[Body]) -> Result<(), Error> {
    check.names("body", bodies.iter().map(|body| body.name.as_str()).enumerate())?;
    bodies.iter().enumerate().try_for_each(|(index, body)| validate_body(check, body, &format!("body[{index}]")))
}

/// `table` is the key path of the body.
fn validate_body(check: &Checker, body: &Body, table: &str) -> Result<(), Error> {
    let key = |field: &str| format!("{table}.{field}");
    check.keys(table, body.check())?;
    for (field, value, freedom, coordinate) in [
        ("mass", body.mass, Freedom::X, "x"),
        ("mass", body.mass, Freedom::Y, "y"),
        ("inertia", body.inertia, Freedom::Theta, "theta"),
    ] {
        if body.free.contains(&freedom) && value < ABOVE_ZERO[0] {
            let expected = format!("a number of at least {:e}, since {table}.free has {coordinate}", ABOVE_ZERO[0]);
            check.fail(&key(field), value, &expected)?;
        }
    }
    for (i, wall) in body.wall.iter().enumerate() {
        check.points(&key(&format!("wall[{i}].points")), &wall.points, 2)?;
    }
    if let Some(contact) = &body.contact {
        check.keys(&key("contact"), contact.check())?;
        check.positive(&key("mass"), body.mass)?;
    }
    if body.member.is_empty() && body.wall.is_empty() && body.free.is_empty() {
        check.fail(table, "empty", "a member, a wall or a free degree of freedom")?;
    }
    check.names(&key("member"), body.member.iter().map(|member| member.name.as_str()).enumerate())?;
    for (i, member) in body.member.iter().enumerate() {
        // `added_mass.NAME.x` is that of the body itself.
        if ["x", "y", "theta"].contains(&identifier(&member.name).as_str()) {
            let expected = "a name other than x, y and theta, which are those of a body's coordinates";
            check.fail(&key(&format!("member[{i}].name")), format!("'{}'", member.name), expected)?;
        }
        validate_member(check, member, &key(&format!("member[{i}]")))?;
    }
    check.within(&format!("length of {}", key("constant_load")), body.constant_load.len() as f64, 0.0, 3.0)
}

/// `table` is the key path of the member.
fn validate_member(check: &Checker, member: &Member, table: &str) -> Result<(), Error> {
    let key = |field: &str| format!("{table}.{field}");
    check.keys(table, member.check())?;
    if member.thickness >= member.length {
        let expected = format!("less than the length, {} m: a beam is long and thin", six(member.length));
        check.fail(&key("thickness"), six(member.thickness), &expected)?;
    }
    let lists = [
        ("damping", member.damping.len()),
        ("constant_load", member.constant_load.len()),
        ("initial_modes", member.initial_modes.len()),
    ];
    for (field, count) in lists {
        check.within(&format!("length of {}", key(field)), count as f64, 0.0, member.modes as f64)?;
    }
    Ok(())
}
