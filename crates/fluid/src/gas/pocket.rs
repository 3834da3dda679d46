//! The account of the gas in pockets.

use super::space::{Labels, NOTHING, OPEN, Space};
use keys::keys;
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

keys! {
    /// Gas in what walls, bodies and water close off from the open air.
    pub struct GasParameters {
        /// Exponent of p V^gamma = constant: 1.4 for air that is squeezed fast, 1 for gas that keeps its temperature.
        exponent: f64 = 1.4, in 1.0 to 3.0;
        /// Pressure of the open air, in which the pressures of the water are 0 \[Pa\].
        ambient: f64 = 101_325.0, in 1.0 to 1e9;
        /// Density of the gas at that pressure \[kg/m3\].
        density: f64 = 1.2, above 0;
    }
}

/// A pocket at one instant.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Pocket {
    /// Volume per width \[m2\].
    pub volume: f64,
    /// Its rate in the last step \[m2/s\].
    pub rate: f64,
    /// Absolute pressure at this volume \[Pa\].
    pub pressure: f64,
    /// Pressure on water and walls over the last step, less that of the open air \[Pa\].
    pub push: f64,
    /// Mass \[kg/m\].
    pub mass: f64,
    /// Mass that left through vents per time in the last step \[kg/(m s)\].
    pub flow: f64,
    /// Middle of its nodes \[m\].
    pub centre: Vector2<f64>,
}

impl Pocket {
    /// The same gas at another volume \[m2\].
    #[must_use]
    pub fn at(&self, volume: f64, exponent: f64) -> Self {
        Self { volume, pressure: self.pressure * (self.volume / volume).powf(exponent), ..*self }
    }

    /// The same after `duration` \[s\] at its rate and its flow. One that would vanish on the way keeps a part.
    #[must_use]
    pub fn after(&self, duration: f64, exponent: f64) -> Self {
        let volume = (self.volume + duration * self.rate).max(LEAST_LEFT * self.volume);
        let mass = (self.mass - duration * self.flow).max(LEAST_LEFT * self.mass);
        let squeezed = mass * self.volume / (self.mass * volume);
        Self { volume, mass, pressure: self.pressure * squeezed.powf(exponent), ..*self }
    }
}

/// Least share of its volume and its mass that half a step leaves of a pocket.
const LEAST_LEFT: f64 = 0.25;
/// Share of its own nodes, or of those of the other, from which on a pocket continues an earlier one: a thin wall that moves
/// leaves a few nodes on its other side.
const CONTINUED: f64 = 0.5;

/// Gas that came and went \[kg/m\], what pockets hold is what was enclosed less what was released, vented and lost; and its work.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Account {
    /// Closed off from the open air, or from nothing where water parted.
    pub enclosed: f64,
    /// Of pockets that opened.
    pub released: f64,
    /// Through vents.
    pub vented: f64,
    /// Work of the pressure beyond that of the open air on water and walls \[J/m\].
    pub work: f64,
    /// Of pockets that became too small to be seen.
    pub lost: f64,
}

/// The gas of a state.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Gas {
    /// Where the pockets were in the last step; that with the label k stands at k - 1.
    pub labels: Labels,
    /// Pockets.
    pub pockets: Vec<Pocket>,
    /// What came and went.
    pub account: Account,
    /// What there is at the places where gas is read.
    pub chambers: Vec<Reading>,
    /// Flow through the vents, out of their pockets, means over the last communication step \[kg/(m s)\].
    pub vents: Vec<f64>,
}

/// Gas at a place: nothing where there is water or the open air.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Reading {
    /// Pressure less that of the open air, mean over the last communication step \[Pa\].
    pub pressure: f64,
    /// Volume at its end \[m2\].
    pub volume: f64,
    /// Mass at its end \[kg/m\].
    pub mass: f64,
}

impl Reading {
    /// Takes in a step that is a `share` of the communication step.
    pub fn add(&mut self, pocket: Option<&Pocket>, share: f64) {
        let Pocket { push, volume, mass, .. } = pocket.copied().unwrap_or_default();
        (self.volume, self.mass) = (volume, mass);
        self.pressure += push * share;
    }
}

impl Gas {
    /// Begins a communication step.
    pub fn begin(&mut self) {
        self.chambers.iter_mut().for_each(|chamber| chamber.pressure = 0.0);
        self.vents.fill(0.0);
    }

    /// Mass in all pockets \[kg/m\].
    pub fn mass(&self) -> f64 {
        self.pockets.iter().map(|pocket| pocket.mass).sum()
    }

    /// Gas of the pockets of `space`, half a step of `half` \[s\] later: it goes with the nodes. Where a pocket was open before or
    /// not there at all, `measured` has its volume \[m2\].
    pub fn carried(
        &self,
        space: &Space,
        half: f64,
        parameters: &GasParameters,
        measured: &[f64],
    ) -> (Vec<Pocket>, Account) {
        let before: Vec<_> = self.pockets.iter().map(|pocket| pocket.after(half, parameters.exponent)).collect();
        let links = self.links(space);
        let mut kept = vec![0.0; before.len()];
        links.iter().filter(|link| link.old != OPEN).for_each(|link| kept[link.old as usize - 1] += link.nodes);
        let mut account = self.account;
        account.vented +=
            self.pockets.iter().zip(&before).map(|(pocket, before)| pocket.mass - before.mass).sum::<f64>();
        let found = space.found();
        let mut pockets: Vec<_> = found.map(|(_, centre)| Pocket { centre, ..Pocket::default() }).collect();
        for link in links.iter().filter(|link| link.old != OPEN) {
            let old = &before[link.old as usize - 1];
            let share = link.nodes / kept[link.old as usize - 1];
            match link.new {
                OPEN => account.released += share * old.mass,
                new => pockets[new as usize - 1].take(old, share),
            }
        }
        account.lost +=
            before.iter().zip(&kept).filter(|(_, kept)| **kept == 0.0).map(|(old, _)| old.mass).sum::<f64>();
        for (pocket, &volume) in pockets.iter_mut().zip(measured) {
            if pocket.volume > 0.0 {
                // What was added up is pressure times volume.
                pocket.pressure /= pocket.volume;
                pocket.push /= pocket.volume;
            } else {
                let (ambient, mass) = (parameters.ambient, parameters.density * volume);
                *pocket = Pocket { volume, pressure: ambient, mass, ..*pocket };
                account.enclosed += mass;
            }
        }
        (pockets, account)
    }

    /// Which pockets of `space` continue which earlier ones.
    fn links(&self, space: &Space) -> Vec<Link> {
        let mut links: Vec<Link> = Vec::new();
        for (new, old) in space.labels().pairs(&self.labels).filter(|&(new, old)| old != NOTHING && new.max(old) > 0) {
            match links.last_mut() {
                Some(last) if (last.new, last.old) == (new, old) => last.nodes += 1.0,
                _ => links.push(Link { new, old, nodes: 1.0 }),
            }
        }
        links.sort_by_key(|link| (link.new, link.old));
        links.dedup_by(|next, link| {
            let same = (next.new, next.old) == (link.new, link.old);
            if same {
                link.nodes += next.nodes;
            }
            same
        });
        let (mut of_new, mut of_old) = (vec![0.0; space.found().count() + 1], vec![0.0; self.pockets.len() + 1]);
        for link in &links {
            of_new[link.new as usize] += link.nodes;
            of_old[link.old as usize] += link.nodes;
        }
        // The open air has room for everything.
        (of_new[OPEN as usize], of_old[OPEN as usize]) = (f64::INFINITY, f64::INFINITY);
        let least = |link: &Link| CONTINUED * of_new[link.new as usize].min(of_old[link.old as usize]);
        links.retain(|link| link.nodes >= least(link));
        links
    }
}

impl Pocket {
    /// Takes a share of the gas of another; pressures as sums of pressure times volume.
    fn take(&mut self, other: &Self, share: f64) {
        let volume = share * other.volume;
        self.volume += volume;
        self.rate += share * other.rate;
        self.pressure += volume * other.pressure;
        self.push += volume * other.push;
        self.mass += share * other.mass;
        self.flow += share * other.flow;
    }
}

/// Nodes that a pocket, or the open air, has of an earlier one.
#[derive(Debug, Clone, Copy)]
struct Link {
    new: u32,
    old: u32,
    nodes: f64,
}
