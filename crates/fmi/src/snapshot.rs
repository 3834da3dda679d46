//! Saved states and their form as bytes.

use crate::{Failure, Mode};
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use uuid::Uuid;

const MAGIC: &[u8; 8] = b"PLIMSOLL";
const VERSION: u32 = 3;
const HEADER: usize = 8 + 4 + 16 + 8 + 4;

/// Everything that decides what an instance does next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Snapshot<S> {
    pub(crate) mode: Mode,
    pub(crate) start: f64,
    pub(crate) stop: Option<f64>,
    pub(crate) tolerance: Option<f64>,
    /// Time of the communication point \[s\].
    pub(crate) time: f64,
    pub(crate) component: S,
}

impl<S: Serialize + DeserializeOwned> Snapshot<S> {
    /// Number of bytes of [`Self::to_bytes`].
    pub fn size(&self) -> Result<usize, Failure> {
        let payload = postcard::experimental::serialized_size(self).map_err(|error| unwritable(&error))?;
        Ok(HEADER + payload)
    }

    /// Magic word, version, model, length, checksum, values; little-endian, no addresses.
    pub fn to_bytes(&self, model: Uuid) -> Result<Vec<u8>, Failure> {
        let payload = postcard::to_stdvec(self).map_err(|error| unwritable(&error))?;
        let mut bytes = Vec::with_capacity(HEADER + payload.len());
        bytes.extend_from_slice(MAGIC);
        bytes.extend_from_slice(&VERSION.to_le_bytes());
        bytes.extend_from_slice(model.as_bytes());
        bytes.extend_from_slice(&(payload.len() as u64).to_le_bytes());
        bytes.extend_from_slice(&crc32fast::hash(&payload).to_le_bytes());
        bytes.extend_from_slice(&payload);
        Ok(bytes)
    }

    /// Reads bytes written by the same model in any process.
    pub fn from_bytes(bytes: &[u8], model: Uuid) -> Result<Self, Failure> {
        let refuse = |reason: String| Failure::refused(format!("serialised state: {reason}"));
        let short = || refuse(format!("{} bytes, expected at least the header of {HEADER}", bytes.len()));
        let (magic, rest) = bytes.split_first_chunk::<8>().ok_or_else(short)?;
        let (version, rest) = rest.split_first_chunk::<4>().ok_or_else(short)?;
        let (guid, rest) = rest.split_first_chunk::<16>().ok_or_else(short)?;
        let (length, rest) = rest.split_first_chunk::<8>().ok_or_else(short)?;
        let (checksum, payload) = rest.split_first_chunk::<4>().ok_or_else(short)?;
        if magic != MAGIC {
            return Err(refuse(format!("starts with {magic:?}, expected {MAGIC:?}: not a state of this program")));
        }
        let version = u32::from_le_bytes(*version);
        if version != VERSION {
            return Err(refuse(format!("version {version}, expected {VERSION}")));
        }
        let guid = Uuid::from_bytes(*guid);
        if guid != model {
            return Err(refuse(format!("belongs to the model with GUID {guid}, this one has {model}")));
        }
        let length = u64::from_le_bytes(*length);
        if length != payload.len() as u64 {
            return Err(refuse(format!("{} bytes of values, expected {length}", payload.len())));
        }
        let (expected, got) = (u32::from_le_bytes(*checksum), crc32fast::hash(payload));
        if expected != got {
            return Err(refuse(format!("checksum {got:08x}, expected {expected:08x}: the bytes were changed")));
        }
        let (snapshot, rest) = postcard::take_from_bytes::<Self>(payload)
            .map_err(|error| refuse(format!("values cannot be read: {error}")))?;
        match rest.len() {
            0 => Ok(snapshot),
            left => Err(refuse(format!("{left} of {length} bytes of values are left over"))),
        }
    }

    /// Refuses times that no experiment can have.
    pub(crate) fn check_times(&self) -> Result<(), Failure> {
        let Self { start, stop, time, .. } = *self;
        if start.is_finite() && time.is_finite() && stop.is_none_or(|stop| stop >= start) {
            return Ok(());
        }
        let stop = stop.map_or("none".to_string(), |stop| stop.to_string());
        Err(Failure::refused(format!(
            "serialised state: start {start}, time {time}, stop {stop}: expected finite times, the stop not before the start"
        )))
    }
}

fn unwritable(error: &postcard::Error) -> Failure {
    Failure::refused(format!("the state cannot be serialised: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn snapshot() -> Snapshot<Vec<f64>> {
        let component = vec![0.1 + 0.2, -0.0, f64::MIN_POSITIVE, 1e300];
        Snapshot { mode: Mode::StepComplete, start: 0.0, stop: Some(1.0), tolerance: None, time: 0.3, component }
    }

    #[test]
    fn bytes_give_the_same_bits_and_the_announced_size() {
        let model = Uuid::from_u128(7);
        let bytes = snapshot().to_bytes(model).unwrap();
        assert_eq!(bytes.len(), snapshot().size().unwrap());
        let back = Snapshot::<Vec<f64>>::from_bytes(&bytes, model).unwrap();
        let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&back.component), bits(&snapshot().component));
        assert_eq!(back.time.to_bits(), 0.3_f64.to_bits());
    }

    #[test]
    fn every_changed_byte_is_noticed() {
        let model = Uuid::from_u128(7);
        let bytes = snapshot().to_bytes(model).unwrap();
        for index in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[index] ^= 1;
            assert!(Snapshot::<Vec<f64>>::from_bytes(&changed, model).is_err(), "byte {index}");
        }
        for length in 0..bytes.len() {
            assert!(Snapshot::<Vec<f64>>::from_bytes(&bytes[..length], model).is_err(), "length {length}");
        }
    }
}
