//! The variables of the gas.

use super::FluidComponent;
use crate::Interface;
use crate::interface::{CHAMBER, VENT};
use fluid::{Gas, Reading};
use fmi::{Reference, Variable};

type Row = Variable<FluidComponent>;

impl FluidComponent {
    /// A figure of the gas; 0 before initialisation.
    fn gas(&self, read: impl Fn(&Gas) -> f64) -> f64 {
        self.state.progress.as_ref().map_or(0.0, |progress| read(&progress.state.gas))
    }

    /// What is read at a chamber that the scene has; zeros for others and before initialisation.
    fn chamber(&self, index: usize) -> Reading {
        let index = self.runtime.as_ref().and_then(|runtime| runtime.matching.chambers[index]);
        let readings = self.state.progress.as_ref().map(|progress| &progress.state.gas.chambers);
        index.zip(readings).and_then(|(index, readings)| readings.get(index)).copied().unwrap_or_default()
    }

    /// The flow through a vent that the scene has.
    fn flow(&self, index: usize) -> f64 {
        let index = self.runtime.as_ref().and_then(|runtime| runtime.matching.vents[index]);
        self.gas(|gas| index.and_then(|index| gas.vents.get(index)).copied().unwrap_or(0.0))
    }
}

/// Figures of the gas at chambers, at vents and of all of it; none for a scene without.
pub(super) fn rows(interface: &Interface) -> Vec<Row> {
    let chamber = |(index, name): (usize, &String)| {
        let [pressure, volume, mass] = Interface::chamber(name);
        let first = CHAMBER + 3 * index as Reference;
        let meaning = "pressure of the gas at a place beyond that of the open air, mean over the last step";
        let pressure = Row::real(first, pressure, meaning, "Pressure", |this, index| this.chamber(index).pressure);
        let meaning = "volume per width of the pocket of gas at a place";
        let volume = Row::real(first + 1, volume, meaning, "Area", |this, index| this.chamber(index).volume);
        let meaning = "mass of the gas in the pocket at a place";
        let mass = Row::real(first + 2, mass, meaning, "Mass", |this, index| this.chamber(index).mass);
        [pressure.at(index), volume.at(index), mass.at(index)]
    };
    let vent = |(index, name): (usize, &String)| {
        let meaning = "gas that leaves its pocket through a vent, mean over the last step";
        let reference = VENT + index as Reference;
        Row::real(reference, Interface::flow(name), meaning, "MassFlow", |this, index| this.flow(index)).at(index)
    };
    let chambers = interface.chambers.iter().enumerate().flat_map(chamber);
    let all = interface.gas.then(totals).into_iter().flatten();
    chambers.chain(interface.vents.iter().enumerate().map(vent)).chain(all).collect()
}

/// Figures of all pockets.
fn totals() -> Vec<Row> {
    let row = |reference, name: &str, meaning: &str, kind, get| Row::real(reference, name, meaning, kind, get);
    vec![
        Row::integer(480, "gas.pockets", "pockets of gas that are closed off from the open air", |this, _| {
            let count = this.state.progress.as_ref().map_or(0, |progress| progress.state.gas.pockets.len());
            i32::try_from(count).unwrap_or(i32::MAX)
        }),
        row(481, "gas.volume", "volume per width of all pockets", "Area", |this, _| {
            this.gas(|gas| gas.pockets.iter().map(|pocket| pocket.volume).sum())
        }),
        row(482, "gas.mass", "gas in all pockets", "Mass", |this, _| this.gas(Gas::mass)),
        row(483, "gas.enclosed", "gas that was closed off since the start", "Mass", |this, _| {
            this.gas(|gas| gas.account.enclosed)
        }),
        row(484, "gas.released", "gas of pockets that opened since the start", "Mass", |this, _| {
            this.gas(|gas| gas.account.released)
        }),
        row(485, "gas.vented", "gas that left through vents since the start", "Mass", |this, _| {
            this.gas(|gas| gas.account.vented)
        }),
        row(487, "gas.work", "work of the gas beyond that of the open air since the start", "Energy", |this, _| {
            this.gas(|gas| gas.account.work)
        }),
        row(486, "gas.lost", "gas of pockets that became too small to be seen since the start", "Mass", |this, _| {
            this.gas(|gas| gas.account.lost)
        }),
    ]
}
