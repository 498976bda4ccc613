//! A solution file: the names and parts of the instances, and one array of radiosities.

use super::{Stored, check, finite_lights};
use crate::container::{Kind, Reader, Writer};
use crate::error::Result;
use crate::fingerprint::Manifest;
use crate::rgb::Rgb;
use crate::solution::{Solution, SolvedInstance};

impl Stored for Solution {
    const KIND: Kind = Kind::Solution;

    fn write(&self, manifest: &Manifest) -> Writer {
        let mut writer = Writer::new(Self::KIND, manifest, &self.instances);
        writer.array("radiosity", &Rgb::channels(&self.radiosity.concat()));
        writer
    }

    fn read(reader: &mut Reader) -> Result<Self> {
        let instances: Vec<SolvedInstance> = reader.meta()?;
        let all = finite_lights(reader, "radiosity")?;
        let total = instances.iter().try_fold(0usize, |sum, known| sum.checked_add(known.elements));
        check(reader, total == Some(all.len()), || {
            format!("{} radiosities of {total:?} elements", all.len())
        })?;
        let mut rest = all.as_slice();
        let mut own = |known: &SolvedInstance| -> Vec<Rgb> {
            let (own, others) = rest.split_at(known.elements);
            rest = others;
            own.to_vec()
        };
        let radiosity = instances.iter().map(&mut own).collect();
        Ok(Self { instances, radiosity })
    }
}
